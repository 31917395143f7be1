"""Solving of a sweep, from its file to the rows of its table.

The command line keeps each finished case in a journal file, so that a stopped sweep can go on.
"""

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import NamedTuple

from drumlin.base.errors import NoAnswer, Stopped
from drumlin.base.journal import Journal, checksum_of_source_and_libraries
from drumlin.sweeps.cases import Row, journal_keys_of_cases
from drumlin.sweeps.file import Sweep
from drumlin.sweeps.sample import solve_all_cases_with_sample
from drumlin.sweeps.sweep_table import SweepTable
from drumlin.sweeps.table import table_lines_of_cases
from drumlin.sweeps.workers import provide_workers_for_cases_of_sweep

Say = Callable[[str], None]
"""A function that shows a line of text to the user."""

Progress = Callable[[str], AbstractContextManager[Callable[[int, int], None]]]
"""A function that makes a context manager, which shows a progress bar with the given title.

The `with` statement gives a function, to be called with the number of finished cases and the number
of all cases.
"""


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
    """
    with provide_workers_for_cases_of_sweep(jobs) as (pool, workers):
        solved = solve_all_cases_with_sample(
            prepared.cases, prepared.sample, executor=pool, workers=workers, done=done
        )
    return table_of_solved_sweep(prepared, solved.rows, folder)


def table_of_solved_sweep(prepared: Sweep, rows: list[Row], folder: Path) -> SweepTable:
    """The table of a sweep, with the changed keys and the results of each case.

    `rows` holds the results of the cases. Paths of mesh files are relative to the folder.
    """
    lines = table_lines_of_cases(prepared.cases, rows, folder.resolve(), prepared.pressure)
    return SweepTable(prepared.title, lines, list(prepared.units))


def _progress_bar_that_shows_nothing(_: str) -> AbstractContextManager[Callable[[int, int], None]]:
    """A progress bar that shows nothing, for callers that give no progress bar."""
    return nullcontext(lambda finished, of: None)


class FinishedSweep(NamedTuple):
    """The results of a sweep with a journal.

    Attributes
    ----------
    rows : results of each case
    journal : path of the journal file
    complete : whether all cases are in the journal, so that another run would solve none
    """

    rows: list[Row]
    journal: Path | None
    complete: bool

    def delete_journal_if_complete(self) -> None:
        """Delete the journal of a complete sweep, whose table has been written."""
        if self.complete and self.journal is not None:
            self.journal.unlink(missing_ok=True)


def solve_sweep_with_journal(
    prepared: Sweep,
    table_file: Path,
    *,
    jobs: int | None = None,
    scheduler: str | None = None,
    progress: Progress = _progress_bar_that_shows_nothing,
    say: Say = lambda line: None,
) -> FinishedSweep:
    """Solve a sweep, and keep each finished case in a journal file beside the table.

    If the sweep was stopped, the next call of this function solves the missing cases only.

    Parameters
    ----------
    prepared : the sweep, as `read_sweep_from_toml_file` returns it
    table_file : path of the table; the journal has this path with ".journal" added
    jobs : number of processes that solve cases; None: one for each core
    scheduler : address of a Dask scheduler whose workers solve the cases; None: processes of this
        machine solve them
    progress : makes a progress bar from the sweep's title
    say : called with each message about the journal or the workers

    Returns
    -------
    the results of each case, and the journal file

    Raises
    ------
    BadInput
        if the options are wrong, or the scheduler cannot be reached
    NoAnswer
        if no worker can be started, or all are lost; the message names the journal
    """
    with Journal(
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
                solved = solve_all_cases_with_sample(
                    prepared.cases,
                    prepared.sample,
                    executor=pool,
                    workers=workers,
                    journal=journal,
                    done=done,
                    say=say,
                )
            # A case whose failure may pass is not in the journal.
            keys = journal_keys_of_cases(solved.cases)
            return FinishedSweep(solved.rows, journal.path, all(key in journal for key in keys))
        # However the sweep is stopped, the message says where the finished cases are.
        except NoAnswer as error:
            raise NoAnswer(f"{error}; {len(journal)} {kept}") from error
        except (KeyboardInterrupt, Stopped) as stop:
            stop.add_note(f"{len(journal)} {kept}")
            raise
