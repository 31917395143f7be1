"""Who solves the cases of a sweep: processes of this machine, or the workers of a Dask cluster."""

import importlib
import multiprocessing
import os
import signal
import threading
from collections.abc import Iterator
from concurrent.futures import CancelledError, Executor, ProcessPoolExecutor
from contextlib import contextmanager
from typing import Any, NamedTuple

from drumlin.errors import BadInput, NoAnswer

PATIENCE = 30.0  # s to wait for a scheduler, and for its first worker


class Crew(NamedTuple):
    """An executor (None: this process itself) and how many cases it solves at a time."""

    executor: Executor | None
    workers: int


@contextmanager
def crew(jobs: int | None = None, scheduler: str | None = None) -> Iterator[Crew]:
    """Workers while a block runs: `jobs` processes, by default one a core, or those of a Dask `scheduler`.

    Raises BadInput where they cannot be had, NoAnswer where the cluster is lost.
    """
    if scheduler is not None:
        if jobs is not None:
            raise BadInput(f"--jobs = {jobs}: the scheduler has its own workers; leave out --jobs or --scheduler")
        with _dask(scheduler) as found:
            yield found
        return
    jobs = _cores() if jobs is None else jobs
    if jobs < 1:
        raise BadInput(f"--jobs = {jobs}: must be at least 1")
    if jobs == 1:
        yield Crew(None, 1)
        return
    spawn = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(jobs, spawn, initializer=_attach) as pool:
        try:
            yield Crew(pool, jobs)
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise


def _cores() -> int:
    """The cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _attach() -> None:
    """In a worker: Ctrl-C is its parent's to answer, and without a parent it ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()

    def follow() -> None:
        if parent is not None:
            parent.join()
            os._exit(1)

    threading.Thread(target=follow, daemon=True).start()


@contextmanager
def _dask(address: str) -> Iterator[Crew]:
    try:
        distributed: Any = importlib.import_module("distributed")
    except ImportError as error:
        raise BadInput("--scheduler: Dask needs the extra drumlin[distributed]") from error
    try:
        client = distributed.Client(address, timeout=PATIENCE, set_as_default=False)
    except (OSError, ValueError, TypeError) as error:  # a TimeoutError is an OSError
        raise BadInput(f"--scheduler = {address!r}: no Dask scheduler answers there") from error
    try:
        try:
            client.wait_for_workers(1, timeout=PATIENCE)
        except TimeoutError as error:
            raise NoAnswer(f"--scheduler = {address!r}: it has no workers") from error
        threads = sum(worker["nthreads"] for worker in client.scheduler_info(n_workers=-1)["workers"].values())
        with client.get_executor(pure=False) as executor:
            yield Crew(executor, threads)
    except (distributed.KilledWorker, CancelledError) as error:
        raise NoAnswer(f"--scheduler = {address!r}: workers died again and again, or the scheduler was lost") from error
    finally:
        client.close()
