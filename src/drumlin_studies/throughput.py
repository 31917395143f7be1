"""What sweeps cost: cases a second by processes and by Dask workers, and a sweep that is killed
again and again.
"""

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
from drumlin.sweeps.cases import Row, SweepCase, run
from drumlin.sweeps.workers import Workers, executor

# glibc: freed memory below these sizes [bytes] is kept; the one that Dask sets turns off that the
# other adapts.
KEEP = {"MALLOC_TRIM_THRESHOLD_": str(2**28), "MALLOC_MMAP_THRESHOLD_": str(2**25)}


class Throughput(NamedTuple):
    """A sweep by some workers: seconds until all are there (`started`), and then for the cases
    (`seconds`).

    `processor`: seconds of all processes from start to end, which neighbours on the machine do not
    lengthen.
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
        """Cases a second, once the workers are there."""
        return self.cases / self.seconds


def processes(cases: Sequence[SweepCase], workers: int) -> Throughput:
    """The cases by processes of this machine."""
    start, before = time.perf_counter(), _processor()
    with executor(workers) as found:
        made = _timed("processes", cases, found, start)
    return made._replace(processor=_processor() - before)


def dask(cases: Sequence[SweepCase], workers: int) -> Throughput:
    """The cases by a Dask scheduler and its workers, processes on the loopback interface, one
    thread each.
    """
    return _dask("Dask workers", cases, workers, {})


def dask_keeping(cases: Sequence[SweepCase], workers: int) -> Throughput:
    """The same, by workers that keep the memory that they free: Dask has it returned to the system
    at once.
    """
    return _dask("Dask workers that keep memory", cases, workers, KEEP)


def _dask(
    by: str, cases: Sequence[SweepCase], workers: int, environment: dict[str, str]
) -> Throughput:
    distributed: Any = importlib.import_module("distributed")
    start, before = time.perf_counter(), _processor()
    with (
        _environment(environment),
        distributed.LocalCluster(
            n_workers=workers,
            threads_per_worker=1,
            host="127.0.0.1",
            dashboard_address=None,
            silence_logs=50,
        ) as cluster,
        executor(scheduler=cluster.scheduler_address) as found,
    ):
        made = _timed(by, cases, found, start)
    return made._replace(processor=_processor() - before)


@contextmanager
def _environment(more: dict[str, str]) -> Iterator[None]:
    """Environment variables of a block. Dask adds some of its own for its workers and leaves them:
    what is measured after it would be slower by them.
    """
    before = dict(os.environ)
    os.environ.update(more)
    try:
        yield
    finally:
        os.environ.clear()
        os.environ.update(before)


def _processor() -> float:
    """Processor time of this process and of those that it started and that have ended [s]."""
    return sum(os.times()[:4])


def _timed(by: str, cases: Sequence[SweepCase], found: Workers, start: float) -> Throughput:
    """The first cases are solved by the sine law before, to wake the workers; condensing shared
    bodies counts.
    """
    warm = [case._replace(model="sine", options={}) for case in cases[: 20 * found.workers]]
    run(warm, executor=found.executor, workers=found.workers)
    ready = time.perf_counter()
    rows = run(cases, executor=found.executor, workers=found.workers)
    return Throughput(
        by, found.workers, len(cases), ready - start, time.perf_counter() - ready, rows
    )


def rates(measured: Sequence[Throughput]) -> list[Row]:
    """A row a measurement: all of it but the rows of its cases, cases a second (`rate`), `gain`
    over one worker.
    """
    found = []
    for one in measured:
        alone = next(other for other in measured if other.by == one.by)
        row = {key: value for key, value in one._asdict().items() if key != "rows"}
        found.append(row | {"rate": one.rate, "gain": one.rate / alone.rate})
    return found


def torques(rows: Sequence[Row]) -> Floats:
    """Torques of the rows that have one [N m]."""
    return np.array([row["torque"] for row in rows if row["status"] == "solved"])


def coarser(cases: Sequence[SweepCase], elements: Sequence[int | None], fine: int) -> list[Row]:
    """Time a case, and the largest error of the torque against `fine`, by so many elements along
    each lining; None: by the division that `solve` ends on.
    """
    true = torques(run([case._replace(options={"elements": fine}) for case in cases]))
    rows = []
    for n in elements:
        start = time.process_time()
        found = torques(
            run([case._replace(options={} if n is None else {"elements": n}) for case in cases])
        )
        spent = time.process_time() - start
        error = float(np.abs(found / true - 1).max())
        nodes = None if n is None else 2 * n + 1
        rows.append({"elements": n, "nodes": nodes, "seconds": spent / len(cases), "error": error})
    return rows


def torque_spread(rows: Sequence[Row]) -> Row:
    """Mean [N m] and relative standard deviation of the torque, and what 2.5 % and 97.5 % of it are
    below [N m].
    """
    torque = torques(rows)
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
    """A run that was killed: how many rows it found in the journal, and how many there were when it
    was killed.
    """

    found: int
    left: int


def killed(
    cases: Sequence[SweepCase],
    path: Path,
    kills: int,
    seed: int,
    say: Callable[[str], None] = lambda _: None,
) -> tuple[list[Kill], list[Row]]:
    """Run cases in a process of its own with a journal at `path`, kill -9 it at random moments;
    then let it finish.

    Returns what each killed run did, and the rows at the end. Raises NoAnswer where a run ends
    before its kill.
    """
    at = sorted(random.Random(seed).sample(range(len(cases) // 20, 9 * len(cases) // 10), kills))
    spawn = multiprocessing.get_context("spawn")
    done = []
    path.unlink(missing_ok=True)
    for number, moment in enumerate(at):
        say(f"kill {number + 1} of {kills}")
        found = _rows_in(path)
        with _process(spawn.Process(target=_run, args=(cases, path))) as process:
            while _rows_in(path) < moment:
                if process.exitcode is not None:
                    raise NoAnswer(
                        "killed: the run ended before it could be killed; take more cases"
                    )
                time.sleep(0.001)
            process.kill()
            process.join()
            if process.exitcode != -signal.SIGKILL:
                raise NoAnswer("killed: the run ended before it could be killed; take more cases")
        done.append(Kill(found, _rows_in(path)))
    with Journal(path) as journal:
        return done, run(cases, journal=journal)


@contextmanager
def _process(process: Any) -> Iterator[Any]:
    process.start()
    try:
        yield process
    finally:
        process.kill()
        process.join()


def _run(cases: Sequence[SweepCase], path: Path) -> None:
    with Journal(path) as journal:
        run(cases, journal=journal)


def _rows_in(journal: Path) -> int:
    """Whole lines of a journal, but for its stamp."""
    return max(journal.read_bytes().count(b"\n") - 1, 0) if journal.exists() else 0
