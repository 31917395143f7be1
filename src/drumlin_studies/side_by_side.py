"""Work on cases in several processes, with a journal of what is finished."""

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import nullcontext
from multiprocessing import get_context
from typing import Any

from drumlin.base.journal import Journal

PROCESSES = 2
"""Processes of a study. Studies are made for machines with two cores."""

Case = Mapping[str, Any]


def compute_and_keep_cases(
    cases: Sequence[Case],
    work: Callable[[Case], dict[str, Any]],
    journal: Journal,
    say: Callable[[str], None] = lambda _: None,
    processes: int = PROCESSES,
    what: str = "cases",
) -> list[dict[str, Any]]:
    """The results of all cases, in their order.

    Parameters
    ----------
    cases : sequence of mappings
        The cases; each is the key of its result in the journal.
    work : function
        Returns the result of a case. It must be a function of a module, so that other processes
        can import it.
    journal : Journal
        Cases with a result in the journal are skipped.
    say : function
        Is told how far the work is.
    processes : int
        Number of processes besides this one; 0 works in this one.
    what : str
        What `say` calls the cases.
    """
    left = [case for case in cases if case not in journal]
    with (
        ProcessPoolExecutor(processes, mp_context=get_context("spawn"))
        if processes
        else nullcontext() as pool
    ):
        results = pool.map(work, left) if pool else map(work, left)
        for done, (case, found) in enumerate(zip(left, results, strict=True), 1):
            journal.add(case, found)
            say(f"{done} of {len(left)} {what}")
    return [journal[case] for case in cases]
