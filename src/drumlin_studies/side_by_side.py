"""Computation of the cases of a study in several processes at the same time.

A journal keeps the finished results, so that an interrupted study continues where it stopped.
"""

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import nullcontext
from multiprocessing import get_context
from typing import Any

from drumlin.base.journal import JournalOfCaseResults

NUMBER_OF_PROCESSES_OF_STUDY = 2
"""Number of processes of a study. Studies are made for machines with two cores."""

ComputationInput = Mapping[str, Any]
"""The input of one computation: plain data by name."""


def compute_cases_in_parallel_with_journal(
    cases: Sequence[ComputationInput],
    work: Callable[[ComputationInput], dict[str, Any]],
    journal: JournalOfCaseResults,
    say: Callable[[str], None] = lambda _: None,
    processes: int = NUMBER_OF_PROCESSES_OF_STUDY,
    what: str = "cases",
) -> list[dict[str, Any]]:
    """The results of all cases, in the order of the cases.

    Parameters
    ----------
    cases : sequence of mappings
        The cases; each is the key of its result in the journal.
    work : function
        Returns the result of a case. It must be a function of a module, so that other processes
        can import it.
    journal : JournalOfCaseResults
        Journal of finished results. Cases in the journal are not computed again. New results are
        added to it.
    say : function
        Is called with a line of text on the progress.
    processes : int
        Number of worker processes; with 0 the cases are computed in this process.
    what : str
        Word for "cases" in the text on the progress.
    """
    # Only cases that the journal lacks are computed; their results are added to the journal.
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
