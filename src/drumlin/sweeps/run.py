"""Solving of a sweep, from its file to the rows of its table.

The command line keeps each finished case in a journal file, so that a stopped sweep can go on.
"""

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path

from drumlin.base.errors import NoAnswer, Stopped
from drumlin.base.journal import Journal, checksum_of_source_and_libraries
from drumlin.sweeps.cases import Row
from drumlin.sweeps.file import Sweep, read_sweep_from_toml_file
from drumlin.sweeps.sample import solve_all_cases_with_sample
from drumlin.sweeps.table import table_lines_of_cases
from drumlin.sweeps.workers import provide_workers_for_cases_of_sweep

Say = Callable[[str], None]
"""A function that shows a line of text to the user."""

Progress = Callable[[str], AbstractContextManager[Callable[[int, int], None]]]
"""A function that makes a context manager, which shows a progress bar with the given title.

The `with` statement gives a function, to be called with the number of finished cases and the number
of all cases.
"""


def solve_sweep_file(path: Path | str, *, jobs: int | None = 1) -> list[Row]:
    """Solve the sweep of a sweep file and return the rows of its table, as `drumlin.sweep` does.

    Parameters
    ----------
    path : path of the TOML file that names the brake, the varied keys and their values
    jobs : number of processes that solve cases at the same time; None: one for each core

    Raises
    ------
    BadInput
        for a file that cannot be read or is no sweep file; the message is one line
    """
    prepared = read_sweep_from_toml_file(Path(path))
    with provide_workers_for_cases_of_sweep(jobs) as (pool, workers):
        rows = solve_all_cases_with_sample(
            prepared.cases, prepared.sample, executor=pool, workers=workers
        )
    return rows_of_sweep_table(prepared, rows, Path(path))


def rows_of_sweep_table(prepared: Sweep, rows: list[Row], sweep_file: Path) -> list[Row]:
    """The rows of a sweep's table, with the changed keys and the results of each case.

    `rows` holds the results of the cases. Paths of mesh files are relative to the sweep file.
    """
    return table_lines_of_cases(
        prepared.cases, rows, sweep_file.parent.resolve(), prepared.pressure
    )


def _progress_bar_that_shows_nothing(_: str) -> AbstractContextManager[Callable[[int, int], None]]:
    """A progress bar that shows nothing, for callers that give no progress bar."""
    return nullcontext(lambda finished, of: None)


def solve_sweep_with_journal(
    prepared: Sweep,
    table_file: Path,
    *,
    jobs: int | None = None,
    scheduler: str | None = None,
    progress: Progress = _progress_bar_that_shows_nothing,
    say: Say = lambda line: None,
) -> list[Row]:
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
    list with the results of each case

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
                return solve_all_cases_with_sample(
                    prepared.cases,
                    prepared.sample,
                    executor=pool,
                    workers=workers,
                    journal=journal,
                    done=done,
                    say=say,
                )
        # However the sweep is stopped, the message says where the finished cases are.
        except NoAnswer as error:
            raise NoAnswer(f"{error}; {len(journal)} {kept}") from error
        except (KeyboardInterrupt, Stopped) as stop:
            stop.add_note(f"{len(journal)} {kept}")
            raise
