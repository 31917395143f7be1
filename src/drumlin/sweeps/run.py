"""A sweep from its file to the rows of its table, in one call; or kept in a journal on the way."""

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path

from drumlin.base.errors import NoAnswer, Stopped
from drumlin.base.journal import Journal, source_stamp
from drumlin.sweeps.cases import Row, solve_cases
from drumlin.sweeps.file import Sweep, read_sweep
from drumlin.sweeps.table import make_case_table
from drumlin.sweeps.workers import provide_workers

Say = Callable[[str], None]
Progress = Callable[[str], AbstractContextManager[Callable[[int, int], None]]]


def solve_sweep_file(path: Path | str, *, jobs: int | None = 1) -> list[Row]:
    """The rows of a sweep file, as `drumlin.sweep` gives them.

    Parameters
    ----------
    path : of the TOML file that names the brake, the keys that vary and how
    jobs : processes that solve side by side; None: one a core

    Raises
    ------
    BadInput
        for a file that cannot be read or is no sweep, in one line
    """
    prepared = read_sweep(Path(path))
    with provide_workers(jobs) as (pool, workers):
        rows = solve_cases(prepared.cases, executor=pool, workers=workers)
    return table_rows(prepared, rows, Path(path))


def table_rows(prepared: Sweep, rows: list[Row], sweep_file: Path) -> list[Row]:
    """The rows of a sweep's table: changed keys and numbers, paths as seen from the sweep file."""
    return make_case_table(prepared.cases, rows, sweep_file.parent.resolve(), prepared.pressure)


def _ignore_progress(_: str) -> AbstractContextManager[Callable[[int, int], None]]:
    """A progress that nobody watches."""
    return nullcontext(lambda finished, of: None)


def solve_and_keep_rows(
    prepared: Sweep,
    table_file: Path,
    *,
    jobs: int | None = None,
    scheduler: str | None = None,
    progress: Progress = _ignore_progress,
    say: Say = lambda line: None,
) -> list[Row]:
    """Solve a sweep and keep each finished case in a journal beside its table.

    Called again after a stop, it goes on with the missing cases.

    Parameters
    ----------
    prepared : the sweep, as `read_sweep` gives it
    table_file : path of the table; the journal's name is this name and ".journal"
    jobs : processes; None: one a core
    scheduler : address of a Dask scheduler, in place of processes of this machine
    progress : makes a context from the sweep's title, which is told how many cases have finished
    say : told a line where the journal or the workers have something to say

    Returns
    -------
    list of rows, one a case

    Raises
    ------
    BadInput
        for workers that cannot be had
    NoAnswer
        where no workers are left; its line names the journal
    """
    with Journal(table_file.with_name(table_file.name + ".journal"), source_stamp()) as journal:
        kept = f"finished cases are kept in {journal.path}; the same command goes on"
        for line in journal.notes:
            say(line)
        try:
            with (
                provide_workers(jobs, scheduler, say) as (pool, workers),
                progress(prepared.title) as done,
            ):
                return solve_cases(
                    prepared.cases,
                    executor=pool,
                    workers=workers,
                    journal=journal,
                    done=done,
                    say=say,
                )
        except NoAnswer as error:
            raise NoAnswer(f"{error}; {len(journal)} {kept}") from error
        except (KeyboardInterrupt, Stopped) as stop:
            stop.add_note(f"{len(journal)} {kept}")
            raise
