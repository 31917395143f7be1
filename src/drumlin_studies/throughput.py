"""The speed of sweeps, and sweeps that are killed. A sweep solves a brake for many inputs.

The speed is the number of cases per second. It is measured for processes of this machine and for
Dask workers. A killed sweep must continue from its journal without loss.
"""

import importlib
import multiprocessing
import os
import random
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import NoAnswer
from drumlin.base.journal import JournalOfCaseResults
from drumlin.sweeps.cases import CaseResultsByName, SweepCase, solve_all_cases_of_sweep
from drumlin.sweeps.sample import solve_sample_cases_and_then_all_others
from drumlin.sweeps.workers import WorkersOfSweep, provide_workers_for_cases_of_sweep

ENVIRONMENT_THAT_KEEPS_FREED_MEMORY = {
    "MALLOC_TRIM_THRESHOLD_": str(2**28),
    "MALLOC_MMAP_THRESHOLD_": str(2**25),
}
"""Environment variables that make the C library glibc keep freed memory for later use.

The values are sizes [bytes] up to which freed memory is kept. Dask sets the first variable to a
small value. This setting also turns off glibc's automatic choice of the second variable. Therefore
both variables are set here.
"""


class MeasuredTimeOfSweep(NamedTuple):
    """The measured time of a sweep.

    Attributes
    ----------
    by : str
        Kind of the workers, in words.
    workers, cases : int
        Number of workers, and number of solved cases.
    started : float
        Wall time until all workers are ready [s].
    seconds : float
        Wall time from the end of `started` until all cases are solved [s].
    rows : list of mappings
        The result of each case.
    processor : float
        Processor time of all processes from start to end [s], on which other programs of the
        machine have little influence.
    """

    by: str
    workers: int
    cases: int
    started: float
    seconds: float
    rows: list[CaseResultsByName]
    processor: float = 0.0

    @property
    def solved_sweep_cases_per_second(self) -> float:
        """Number of cases per second, without the time to start the workers."""
        return self.cases / self.seconds


def measure_time_of_sweep_by_processes(
    cases: Sequence[SweepCase], workers: int, sample: Sequence[int] = ()
) -> MeasuredTimeOfSweep:
    """The measured time of a sweep by processes of this machine.

    `sample` has the numbers of the cases that are solved on all refinement levels. The stated
    errors of the other cases follow from these cases. Without a sample each case states its own
    errors.
    """
    start, before = time.perf_counter(), _processor_time_with_ended_child_processes()
    with provide_workers_for_cases_of_sweep(workers) as found:
        made = _measure_time_of_sweep_by_started_workers("processes", cases, found, start, sample)
    return made._replace(processor=_processor_time_with_ended_child_processes() - before)


def measure_time_of_sweep_by_dask_workers(
    cases: Sequence[SweepCase], workers: int
) -> MeasuredTimeOfSweep:
    """The measured time of a sweep by Dask workers.

    Each worker is a process of one thread on this machine.
    """
    return _measure_time_of_dask_sweep_with_environment("Dask workers", cases, workers, {})


def measure_time_of_sweep_by_dask_keeping_memory(
    cases: Sequence[SweepCase], workers: int
) -> MeasuredTimeOfSweep:
    """The measured time of a sweep by Dask workers that keep freed memory for later use.

    By default a Dask worker returns freed memory to the system at once.
    """
    return _measure_time_of_dask_sweep_with_environment(
        "Dask workers that keep memory", cases, workers, ENVIRONMENT_THAT_KEEPS_FREED_MEMORY
    )


def _measure_time_of_dask_sweep_with_environment(
    by: str, cases: Sequence[SweepCase], workers: int, environment: dict[str, str]
) -> MeasuredTimeOfSweep:
    """The measured time of a sweep by Dask workers.

    Parameters
    ----------
    by : str
        Kind of the workers, in words.
    cases : sequence of SweepCase
        The cases of the sweep.
    workers : int
        Number of workers.
    environment : dict
        Environment variables that are set while the workers start.
    """
    distributed: Any = importlib.import_module("distributed")
    start, before = time.perf_counter(), _processor_time_with_ended_child_processes()
    with (
        _set_environment_variables(environment),
        distributed.LocalCluster(
            n_workers=workers,
            threads_per_worker=1,
            host="127.0.0.1",
            dashboard_address=None,
            silence_logs=50,
        ) as cluster,
        provide_workers_for_cases_of_sweep(scheduler=cluster.scheduler_address) as found,
    ):
        made = _measure_time_of_sweep_by_started_workers(by, cases, found, start)
    return made._replace(processor=_processor_time_with_ended_child_processes() - before)


@contextmanager
def _set_environment_variables(more: dict[str, str]) -> Iterator[None]:
    """Set environment variables for a block of code, and restore the environment afterwards.

    Dask sets further environment variables for its workers and does not remove these variables.
    They would slow down the sweeps that are measured afterwards.
    """
    before = dict(os.environ)
    os.environ.update(more)
    try:
        yield
    finally:
        os.environ.clear()
        os.environ.update(before)


def _processor_time_with_ended_child_processes() -> float:
    """Processor time [s] of this process and of its child processes that have ended."""
    return sum(os.times()[:4])


def _measure_time_of_sweep_by_started_workers(
    by: str,
    cases: Sequence[SweepCase],
    found: WorkersOfSweep,
    start: float,
    sample: Sequence[int] = (),
) -> MeasuredTimeOfSweep:
    """The measured time of a sweep by workers that have been started.

    First the workers solve some cases by the sine law, until all workers are ready. Then the
    measured time begins. It includes the time to condense the shoes that several cases share.

    Parameters
    ----------
    by : str
        Kind of the workers, in words.
    cases : sequence of SweepCase
        The cases of the sweep.
    found : WorkersOfSweep
        The started workers.
    start : float
        Clock reading [s] just before the start of the workers.
    sample : sequence of int
        Numbers of the cases that are solved on all refinement levels. The stated errors of the
        other cases follow from these cases.
    """
    # Twenty quick cases for each worker make all workers load the modules before the measurement.
    warm = [case._replace(model="sine", options={}) for case in cases[: 20 * found.workers]]
    solve_all_cases_of_sweep(warm, executor=found.executor, workers=found.workers)
    ready = time.perf_counter()
    solved = solve_sample_cases_and_then_all_others(
        cases, sample, executor=found.executor, workers=found.workers
    )
    spent = time.perf_counter() - ready
    return MeasuredTimeOfSweep(by, found.workers, len(cases), ready - start, spent, solved.rows)


def rows_of_cases_per_second(measured: Sequence[MeasuredTimeOfSweep]) -> list[CaseResultsByName]:
    """A table row for each measured sweep, with the speed of its workers.

    `rate` is the number of cases per second. `gain` is this rate divided by the rate of the first
    measurement with the same kind of workers.
    """
    found = []
    for one in measured:
        # The first measurement with the same kind of workers; it has one worker.
        alone = next(other for other in measured if other.by == one.by)
        row = {key: value for key, value in one._asdict().items() if key != "rows"}
        found.append(
            row
            | {
                "rate": one.solved_sweep_cases_per_second,
                "gain": one.solved_sweep_cases_per_second / alone.solved_sweep_cases_per_second,
            }
        )
    return found


def rows_of_sweep_times_with_and_without_sample(
    full: Sequence[MeasuredTimeOfSweep], sampled: Sequence[MeasuredTimeOfSweep]
) -> list[CaseResultsByName]:
    """A table row for each number of workers: the time of a sweep with and without a sample.

    `gain` is the time without a sample divided by the time with it. `itself` is the number of cases
    that state their own errors in the sweep with a sample. `distance` belongs to the other cases:
    it is the largest relative difference between the torques with and without a sample, divided by
    the stated error of the torque.
    """
    found = []
    for one in sampled:
        alone = next(other for other in full if (other.by, other.workers) == (one.by, one.workers))
        by_itself = 0
        distances = [0.0]
        for row, own in zip(one.rows, alone.rows, strict=True):
            by_itself += row.get("certified") != "sample"
            if row.get("certified") == "sample":
                distances.append(abs(row["torque"] / own["torque"] - 1) / row["error_torque"])
        found.append(
            {
                "workers": one.workers,
                "cases": one.cases,
                "itself": by_itself,
                "full": alone.seconds,
                "sampled": one.seconds,
                "gain": alone.seconds / one.seconds,
                "distance": max(distances),
            }
        )
    return found


def torques_of_solved_sweep_cases(rows: Sequence[CaseResultsByName]) -> Floats:
    """The torques (n,) [N m] of the n cases that were solved."""
    return np.array([row["torque"] for row in rows if row["status"] == "solved"])


def time_and_error_rows_of_coarser_meshes(
    cases: Sequence[SweepCase], elements: Sequence[int | None], fine: int
) -> list[CaseResultsByName]:
    """A row for each mesh: processor time per case, and largest torque error among the cases.

    Parameters
    ----------
    cases : sequence of SweepCase
        The cases that are solved on each mesh.
    elements : sequence of int or None
        Elements along each lining of each mesh; None for the default solve.
    fine : int
        Elements along each lining of the mesh against which errors are taken.
    """
    # Torques on the fine mesh. The errors of the other meshes are relative to these torques.
    true = torques_of_solved_sweep_cases(
        solve_all_cases_of_sweep([case._replace(options={"elements": fine}) for case in cases])
    )
    rows = []
    for n in elements:
        start = time.process_time()
        options = {} if n is None else {"elements": n}
        found = torques_of_solved_sweep_cases(
            solve_all_cases_of_sweep([case._replace(options=options) for case in cases])
        )
        spent = time.process_time() - start
        error = float(np.abs(found / true - 1).max())
        nodes = None if n is None else 2 * n + 1
        rows.append({"elements": n, "nodes": nodes, "seconds": spent / len(cases), "error": error})
    return rows


def row_of_torque_distribution(rows: Sequence[CaseResultsByName]) -> CaseResultsByName:
    """A row with mean, relative standard deviation, 2.5 and 97.5 percentile of the torque [N m].

    The row also has the number of cases and the number of cases without an answer.
    """
    torque = torques_of_solved_sweep_cases(rows)
    low, high = np.percentile(torque, [2.5, 97.5])
    return {
        "cases": len(rows),
        "failed": len(rows) - len(torque),
        "mean": torque.mean(),
        "spread": torque.std(ddof=1) / torque.mean(),
        "low": low,
        "high": high,
    }


class KilledSweepRun(NamedTuple):
    """A run of a sweep that was killed.

    Attributes
    ----------
    found : int
        Number of finished cases in the journal when the run began.
    left : int
        Number of finished cases in the journal when the run was killed.
    """

    found: int
    left: int


def kill_and_finish_sweep(
    cases: Sequence[SweepCase],
    path: Path,
    kills: int,
    seed: int,
    say: Callable[[str], None] = lambda _: None,
) -> tuple[list[KilledSweepRun], list[CaseResultsByName]]:
    """Kill several runs of a sweep at random times, then let the sweep finish.

    Each run is a separate process, which SIGKILL ends. The results are the killed runs, and the
    rows of the finished sweep.

    Parameters
    ----------
    cases : sequence of SweepCase
        The cases of the sweep.
    path : Path
        The journal that all runs share.
    kills : int
        Number of runs that are killed.
    seed : int
        Seed of the random times.
    say : function
        Is called with a line of text on the progress.

    Raises
    ------
    NoAnswer
        A run ends before it is killed.
    """
    # Numbers of finished cases at which a run is killed, between 5 % and 90 % of the cases.
    at = sorted(random.Random(seed).sample(range(len(cases) // 20, 9 * len(cases) // 10), kills))
    spawn = multiprocessing.get_context("spawn")
    done = []
    path.unlink(missing_ok=True)
    for number, moment in enumerate(at):
        say(f"kill {number + 1} of {kills}")
        found = _count_finished_cases_in_journal(path)
        with _run_process_during_block(
            spawn.Process(target=_solve_remaining_sweep_cases_with_journal, args=(cases, path))
        ) as process:
            while _count_finished_cases_in_journal(path) < moment:
                if process.exitcode is not None:
                    raise NoAnswer(
                        "killed: the run ended before it could be killed; take more cases"
                    )
                time.sleep(0.001)
            process.kill()
            process.join()
            # Only a process that was killed from outside has a negative exit status. The status
            # depends on the system, so that only its sign is checked.
            if process.exitcode >= 0:
                raise NoAnswer("killed: the run ended before it could be killed; take more cases")
        done.append(KilledSweepRun(found, _count_finished_cases_in_journal(path)))
    # The last run is not killed and finishes the sweep from the journal.
    with JournalOfCaseResults(path) as journal:
        return done, solve_all_cases_of_sweep(cases, journal=journal)


@contextmanager
def _run_process_during_block(process: Any) -> Iterator[Any]:
    """Start a process, provide it to a block of code, and kill it at the end of the block."""
    process.start()
    try:
        yield process
    finally:
        process.kill()
        process.join()


def _solve_remaining_sweep_cases_with_journal(cases: Sequence[SweepCase], path: Path) -> None:
    """Solve the cases of a sweep that are not yet in the journal at `path`, and add them to it."""
    with JournalOfCaseResults(path) as journal:
        solve_all_cases_of_sweep(cases, journal=journal)


def _count_finished_cases_in_journal(journal: Path) -> int:
    """The number of finished cases in a journal: all lines but the first, which has no case."""
    return max(journal.read_bytes().count(b"\n") - 1, 0) if journal.exists() else 0
