"""Cases of a study in several processes, each kept in a journal as it is finished."""

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import Any

from drumlin.journal import Journal

PROCESSES = 2
"""Processes of a study: the machines that it is made for have two cores."""

Case = Mapping[str, Any]


def kept(
    cases: Sequence[Case],
    work: Callable[[Case], dict[str, Any]],
    journal: Journal,
    say: Callable[[str], None] = lambda _: None,
    processes: int = PROCESSES,
) -> list[dict[str, Any]]:
    """The results of all cases, in their order.

    Parameters
    ----------
    cases : sequence of mappings
        What tells the cases apart.
    work : function
        From a case to its result; a function of a module, since it goes to other processes.
    journal : Journal
        Cases that it has are not worked on again.
    say : function
        Told how far the work is.
    processes : int
        Number of processes; 1 works in this one.
    """
    left = [case for case in cases if case not in journal]
    if processes == 1:
        for case in left:
            journal.add(case, work(case))
    else:
        with ProcessPoolExecutor(processes, mp_context=get_context("spawn")) as pool:
            for done, (case, found) in enumerate(zip(left, pool.map(work, left), strict=True), 1):
                journal.add(case, found)
                say(f"{done} of {len(left)} cases")
    return [journal[case] for case in cases]
