"""Cost of sweeps: cases a second by processes and by Dask workers, and runs that are killed."""

import importlib
import multiprocessing
import os
import random
import signal
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import NoAnswer
from drumlin.base.journal import Journal
from drumlin.sweeps.cases import Row, SweepCase, solve_cases
from drumlin.sweeps.workers import Workers, provide_workers

KEEP = {"MALLOC_TRIM_THRESHOLD_": str(2**28), "MALLOC_MMAP_THRESHOLD_": str(2**25)}
"""Environment by which glibc keeps freed memory below these sizes [bytes].

Dask sets the first of them. This turns off the automatic choice of the second, so that both are
given.
"""


class Throughput(NamedTuple):
    """The time of a sweep by some workers.

    Attributes
    ----------
    by : str
        What kind of workers.
    workers, cases : int
        Their number, and the number of cases.
    started : float
        Time until all workers are ready [s].
    seconds : float
        Time of the cases from then on [s].
    rows : list of mappings
        Rows of the cases.
    processor : float
        Processor time of all processes from start to end [s]. Other programs do not lengthen it.
    """

    by: str
    workers: int
    cases: int
    started: float
    seconds: float
    rows: list[Row]
    processor: float = 0.0

    @property
    def rate(self) -> float:
        """Cases a second, once the workers are ready."""
        return self.cases / self.seconds


def time_with_processes(cases: Sequence[SweepCase], workers: int) -> Throughput:
    """The time of the cases by processes of this machine."""
    start, before = time.perf_counter(), _processor_time()
    with provide_workers(workers) as found:
        made = _time_sweep("processes", cases, found, start)
    return made._replace(processor=_processor_time() - before)


def time_with_dask(cases: Sequence[SweepCase], workers: int) -> Throughput:
    """The time of the cases by Dask workers, processes of one thread on the loopback interface."""
    return _time_with_dask_workers("Dask workers", cases, workers, {})


def time_with_dask_keeping_memory(cases: Sequence[SweepCase], workers: int) -> Throughput:
    """The time of the cases by Dask workers that keep freed memory.

    By default a Dask worker returns freed memory to the system at once.
    """
    return _time_with_dask_workers("Dask workers that keep memory", cases, workers, KEEP)


def _time_with_dask_workers(
    by: str, cases: Sequence[SweepCase], workers: int, environment: dict[str, str]
) -> Throughput:
    """The time of the cases by Dask workers that start in an environment."""
    distributed: Any = importlib.import_module("distributed")
    start, before = time.perf_counter(), _processor_time()
    with (
        _set_environment(environment),
        distributed.LocalCluster(
            n_workers=workers,
            threads_per_worker=1,
            host="127.0.0.1",
            dashboard_address=None,
            silence_logs=50,
        ) as cluster,
        provide_workers(scheduler=cluster.scheduler_address) as found,
    ):
        made = _time_sweep(by, cases, found, start)
    return made._replace(processor=_processor_time() - before)


@contextmanager
def _set_environment(more: dict[str, str]) -> Iterator[None]:
    """Set environment variables for a block, and restore the environment afterwards.

    Dask sets further variables for its workers and does not remove them. They would slow down what
    is measured afterwards.
    """
    before = dict(os.environ)
    os.environ.update(more)
    try:
        yield
    finally:
        os.environ.clear()
        os.environ.update(before)


def _processor_time() -> float:
    """Processor time [s] of this process and of its child processes that have ended."""
    return sum(os.times()[:4])


def _time_sweep(by: str, cases: Sequence[SweepCase], found: Workers, start: float) -> Throughput:
    """The time of the cases by workers that are started already.

    The sine law solves some cases first, so that all workers are awake. The condensation of shared
    bodies belongs to the measured time.

    Parameters
    ----------
    by : str
        What kind of workers.
    cases : sequence of SweepCase
        The cases.
    found : Workers
        The workers.
    start : float
        Time at which the workers were started [s].
    """
    warm = [case._replace(model="sine", options={}) for case in cases[: 20 * found.workers]]
    solve_cases(warm, executor=found.executor, workers=found.workers)
    ready = time.perf_counter()
    rows = solve_cases(cases, executor=found.executor, workers=found.workers)
    spent = time.perf_counter() - ready
    return Throughput(by, found.workers, len(cases), ready - start, spent, rows)


def rate_rows(measured: Sequence[Throughput]) -> list[Row]:
    """A row for each measurement, with its `rate` and its `gain` over one worker."""
    found = []
    for one in measured:
        alone = next(other for other in measured if other.by == one.by)
        row = {key: value for key, value in one._asdict().items() if key != "rows"}
        found.append(row | {"rate": one.rate, "gain": one.rate / alone.rate})
    return found


def solved_torques(rows: Sequence[Row]) -> Floats:
    """Torques of the rows that are solved (n,) [N m]."""
    return np.array([row["torque"] for row in rows if row["status"] == "solved"])


def coarser_mesh_rows(
    cases: Sequence[SweepCase], elements: Sequence[int | None], fine: int
) -> list[Row]:
    """Time and error of coarser meshes, a row for each number of elements.

    Parameters
    ----------
    cases : sequence of SweepCase
        The cases, whose largest error counts.
    elements : sequence of int or None
        Elements along each lining; None for the default solve.
    fine : int
        Elements of the mesh against which errors of the torque are taken.
    """
    true = solved_torques(
        solve_cases([case._replace(options={"elements": fine}) for case in cases])
    )
    rows = []
    for n in elements:
        start = time.process_time()
        options = {} if n is None else {"elements": n}
        found = solved_torques(solve_cases([case._replace(options=options) for case in cases]))
        spent = time.process_time() - start
        error = float(np.abs(found / true - 1).max())
        nodes = None if n is None else 2 * n + 1
        rows.append({"elements": n, "nodes": nodes, "seconds": spent / len(cases), "error": error})
    return rows


def torque_spread(rows: Sequence[Row]) -> Row:
    """Mean, relative standard deviation, and 2.5 and 97.5 percentiles of the torque [N m]."""
    torque = solved_torques(rows)
    low, high = np.percentile(torque, [2.5, 97.5])
    return {
        "cases": len(rows),
        "failed": len(rows) - len(torque),
        "mean": torque.mean(),
        "spread": torque.std(ddof=1) / torque.mean(),
        "low": low,
        "high": high,
    }


class Kill(NamedTuple):
    """A run that was killed.

    Attributes
    ----------
    found : int
        Rows in the journal when it began.
    left : int
        Rows in the journal when it was killed.
    """

    found: int
    left: int


def kill_and_finish_sweep(
    cases: Sequence[SweepCase],
    path: Path,
    kills: int,
    seed: int,
    say: Callable[[str], None] = lambda _: None,
) -> tuple[list[Kill], list[Row]]:
    """Kill runs of a sweep at random moments, then let it finish: the kills, and the final rows.

    Each run is a process of its own, which is ended by SIGKILL.

    Parameters
    ----------
    cases : sequence of SweepCase
        The cases of the sweep.
    path : Path
        The journal that all runs share.
    kills : int
        Number of runs that are killed.
    seed : int
        Seed of the moments.
    say : function
        Is told how far the work is.

    Raises
    ------
    NoAnswer
        A run ends before it is killed.
    """
    at = sorted(random.Random(seed).sample(range(len(cases) // 20, 9 * len(cases) // 10), kills))
    spawn = multiprocessing.get_context("spawn")
    done = []
    path.unlink(missing_ok=True)
    for number, moment in enumerate(at):
        say(f"kill {number + 1} of {kills}")
        found = _count_journal_rows(path)
        with _start_process(spawn.Process(target=_run_sweep, args=(cases, path))) as process:
            while _count_journal_rows(path) < moment:
                if process.exitcode is not None:
                    raise NoAnswer(
                        "killed: the run ended before it could be killed; take more cases"
                    )
                time.sleep(0.001)
            process.kill()
            process.join()
            if process.exitcode != -signal.SIGKILL:
                raise NoAnswer("killed: the run ended before it could be killed; take more cases")
        done.append(Kill(found, _count_journal_rows(path)))
    with Journal(path) as journal:
        return done, solve_cases(cases, journal=journal)


@contextmanager
def _start_process(process: Any) -> Iterator[Any]:
    """Provide a started process while a block runs, then kill the process."""
    process.start()
    try:
        yield process
    finally:
        process.kill()
        process.join()


def _run_sweep(cases: Sequence[SweepCase], path: Path) -> None:
    """Solve the cases with the journal at `path`."""
    with Journal(path) as journal:
        solve_cases(cases, journal=journal)


def _count_journal_rows(journal: Path) -> int:
    """Number of complete rows of a journal. Its first line is a stamp."""
    return max(journal.read_bytes().count(b"\n") - 1, 0) if journal.exists() else 0
