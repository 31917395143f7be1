"""Let Python search the memory of a drumlin process for garbage seldom, and not at its end.

Python frees most objects as soon as nothing refers to them. Objects that refer to each other in a
circle are garbage that only a search finds.
"""

import gc

NEW_OBJECTS_BETWEEN_GARBAGE_SEARCHES = 200_000
"""Number of new objects after which Python searches memory for garbage; Python's default is 700.

A search also visits all imported modules, which stay in memory until the end. With a threshold of
20 000 objects the searches take 5 % of the time of `drumlin solve`, since the imports make more
objects than 20 000. With 200 000 there is no search in a solve. Solves leave little garbage:
without any search, 60 solves in one process take no more memory than one solve.
"""


def search_memory_for_garbage_seldom() -> None:
    """Let Python search the memory of this process for garbage seldom.

    A search then follows after NEW_OBJECTS_BETWEEN_GARBAGE_SEARCHES new objects.
    """
    gc.set_threshold(NEW_OBJECTS_BETWEEN_GARBAGE_SEARCHES)


def leave_memory_to_operating_system_at_end() -> None:
    """Exempt all present objects from searches for garbage, so that this process ends sooner.

    At the end of a process Python searches the memory several times. These searches take 170 of
    the 600 ms of processor time of `drumlin solve`, and free memory that the operating system frees
    anyway. Python still does all other work at the end, such as deleting temporary folders.
    """
    gc.freeze()
