"""How often Python searches the memory of a process of drumlin for garbage, and not at its end.

Python frees most objects as soon as nothing refers to them. Objects that refer to each other in a
circle are garbage that only a search finds.
"""

import gc

NEW_OBJECTS_BETWEEN_GARBAGE_SEARCHES = 200_000
"""Number of new objects after which Python searches memory for garbage; Python's default is 700.

The search also visits all imported modules, which stay in memory until the end. With 20 000 it
takes 5 % of the time of `drumlin solve`, since the imports make more objects than this number. With
200 000 there is no such search in a solve. Solves leave so little garbage that without any search
60 of them in one process take no more memory than one.
"""


def search_memory_for_garbage_seldom() -> None:
    """Let Python search the memory of this process for garbage seldom.

    It does so after NEW_OBJECTS_BETWEEN_GARBAGE_SEARCHES new objects.
    """
    gc.set_threshold(NEW_OBJECTS_BETWEEN_GARBAGE_SEARCHES)


def leave_memory_to_operating_system_at_end() -> None:
    """Exempt all present objects from searches for garbage, so that this process ends sooner.

    At the end of a process Python searches the memory several times. These searches take 170 of
    600 ms of processor time of `drumlin solve`, and free what the operating system frees anyway.
    What is to happen at the end, such as the deletion of temporary folders, happens nevertheless.
    """
    gc.freeze()
