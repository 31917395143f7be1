"""Solving of a sweep, from its file to the rows of its table.

The command line keeps each finished case in a journal file, so that a stopped sweep can go on.
"""

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import TypeVar

from drumlin.base.errors import BadInput, NoAnswer, StoppedBySignal
from drumlin.base.journal import (
    JournalOfCaseResults,
    case_data_as_json_line,
    checksum_of_source_and_libraries,
)
from drumlin.models import NAMES_OF_BUILT_IN_MODELS
from drumlin.sweeps.cases import CaseResultsByName, SweepCase, journal_keys_of_cases
from drumlin.sweeps.file import Sweep
from drumlin.sweeps.keys_without_effect import notes_on_keys_without_effect
from drumlin.sweeps.sample import solve_sample_cases_and_then_all_others
from drumlin.sweeps.sweep_table import SweepTable
from drumlin.sweeps.table import table_lines_of_cases
from drumlin.sweeps.workers import provide_workers_for_cases_of_sweep

ShowSweepMessage = Callable[[str], None]
"""A function that shows a line of text to the user."""

MakeProgressBar = Callable[[str], AbstractContextManager[Callable[[int, int], None]]]
"""A function that makes a context manager, which shows a progress bar with the given title.

The `with` statement gives a function, to be called with the number of finished cases and the number
of all cases.
"""

TableWriterReturnType = TypeVar("TableWriterReturnType")
"""The type of the value that the function returns which writes the table of a sweep."""


def solve_sweep_in_memory(
    prepared: Sweep,
    folder: Path,
    *,
    jobs: int | None = 1,
    done: Callable[[int, int], None] = lambda finished, of: None,
) -> SweepTable:
    """Solve a sweep without a journal and return its table, as `drumlin.sweep` does.

    Parameters
    ----------
    prepared : the sweep
    folder : folder to which paths of mesh files in the table are relative
    jobs : number of processes that solve cases at the same time; None: one for each core
    done : called with the number of finished cases and the number of all cases

    Raises
    ------
    BadInput
        if `jobs` is out of range, or is not 1 although a case needs a law of the user
    NoAnswer
        if no worker can be started, or all are lost
    """
    # A worker process imports drumlin anew, without the laws that the user has registered here.
    own_laws = sorted({case.model for case in prepared.cases} - NAMES_OF_BUILT_IN_MODELS)
    if own_laws and jobs != 1:
        raise BadInput(
            f"--jobs = {jobs}: a law of your own ({', '.join(own_laws)}) is solved with jobs=1"
        )
    with provide_workers_for_cases_of_sweep(jobs) as (pool, workers):
        solved = solve_sample_cases_and_then_all_others(
            prepared.cases, prepared.sample, executor=pool, workers=workers, done=done
        )
    return table_of_solved_sweep(prepared, solved.rows, folder)


def table_of_solved_sweep(
    prepared: Sweep, rows: list[CaseResultsByName], folder: Path
) -> SweepTable:
    """The table of a sweep, with the changed keys and the results of each case.

    `rows` holds the results of the cases. Paths of mesh files are relative to the folder.
    """
    lines = table_lines_of_cases(prepared.cases, rows, folder.resolve(), prepared.pressure)
    notes = notes_on_keys_without_effect(prepared.cases, rows)
    return SweepTable(prepared.title, lines, list(prepared.units), notes)


def _progress_bar_that_shows_nothing(_: str) -> AbstractContextManager[Callable[[int, int], None]]:
    """A progress bar that shows nothing, for callers that give no progress bar."""
    return nullcontext(lambda finished, of: None)


def solve_sweep_with_journal(
    prepared: Sweep,
    table_file: Path,
    write_table: Callable[[list[CaseResultsByName]], TableWriterReturnType],
    *,
    jobs: int | None = None,
    scheduler: str | None = None,
    keep_journal: bool = False,
    progress: MakeProgressBar = _progress_bar_that_shows_nothing,
    say: ShowSweepMessage = lambda line: None,
) -> TableWriterReturnType:
    """Solve a sweep and write its table; a journal beside the table keeps each finished case.

    If the sweep was stopped, the next call of this function solves the missing cases only. The
    journal is deleted once the table is written, if all cases have lasting results, and if the
    journal has no other cases. No other run can write the journal or the table meanwhile.

    Parameters
    ----------
    prepared : the sweep, as `read_sweep_from_toml_file` returns it
    table_file : path of the table; the journal has this path with ".journal" added
    write_table : called with the results of each case; writes the table
    jobs : number of processes that solve cases; None: one for each core
    scheduler : address of a Dask scheduler whose workers solve the cases; None: processes of this
        machine solve them
    keep_journal : whether the journal of a complete sweep is kept
    progress : makes a progress bar from the sweep's title
    say : called with each message about the journal or the workers

    Returns
    -------
    what `write_table` returns

    Raises
    ------
    BadInput
        if the options are wrong, or the scheduler cannot be reached
    NoAnswer
        if no worker can be started, or all are lost; the message names the journal
    """
    with JournalOfCaseResults(
        table_file.with_name(table_file.name + ".journal"), checksum_of_source_and_libraries()
    ) as journal:
        kept = f"finished cases are kept in {journal.path}; the same command goes on"
        for line in journal.notes:
            say(line)
        try:
            with (
                provide_workers_for_cases_of_sweep(jobs, scheduler, say) as (pool, workers),
                progress(prepared.title) as done,
            ):
                solved = solve_sample_cases_and_then_all_others(
                    prepared.cases,
                    prepared.sample,
                    executor=pool,
                    workers=workers,
                    journal=journal,
                    done=done,
                    say=say,
                )
            written = write_table(solved.rows)
        # Each message about a stopped sweep says in which file the finished cases are.
        except NoAnswer as error:
            raise NoAnswer(f"{error}; {len(journal)} {kept}") from error
        except (KeyboardInterrupt, StoppedBySignal) as stop:
            stop.add_note(f"{len(journal)} {kept}")
            raise
        _say_why_journal_stays_or_delete_it(journal, solved.cases, keep_journal, say)
        return written


def _say_why_journal_stays_or_delete_it(
    journal: JournalOfCaseResults, cases: list[SweepCase], keep: bool, say: ShowSweepMessage
) -> None:
    """Delete the journal of a complete sweep, or say why it stays.

    Parameters
    ----------
    journal : the journal, still locked
    cases : all cases of the sweep, with their certificates
    keep : whether the user wants to keep the journal
    say : called with a line on why the journal stays
    """
    keys = list(journal_keys_of_cases(cases))
    # The journal lacks the cases that failed but may succeed in a later attempt.
    lost = sum(key not in journal for key in keys)
    if lost:
        say(
            f"{lost} of {len(keys)} cases failed for want of memory, a file or a worker, or by a "
            "fault of drumlin; the same command tries them again"
        )
        return
    if keep:
        return
    # The journal belongs to the name of the table. It may have cases of another sweep file with
    # this name, or of an earlier state of the sweep file.
    others = len(journal) - len({case_data_as_json_line(key) for key in keys})
    if others:
        say(
            f"{journal.path}: is kept, since it has {others} finished cases that are not of this "
            "sweep; delete it if you do not need them"
        )
        return
    journal.close_and_delete_complete_journal()
