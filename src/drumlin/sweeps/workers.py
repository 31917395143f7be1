"""The workers that solve the cases of a sweep: processes of this machine or of a cluster.

The workers of a cluster are started by Dask, a Python library that distributes work to machines.

This module does not import numpy, because a worker must limit its threads before it loads numpy. A
worker process that dies is replaced. If no worker answers within the time limits below, the sweep
ends with a message of one line.
"""

import importlib
import logging
import multiprocessing
import os
import pickle
import signal
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import BrokenExecutor, CancelledError, Executor, Future, ThreadPoolExecutor
from contextlib import contextmanager, suppress
from typing import Any, NamedTuple

from drumlin.base.errors import BadInput, NoAnswer
from drumlin.base.garbage import search_memory_for_garbage_seldom
from drumlin.base.threads import (
    one_blas_thread_unless_user_set_number,
    variables_for_one_blas_thread_unless_user_set_number,
)

OLDEST_ALLOWED_DASK_VERSION = "2025.4"
"""The oldest version of Dask whose scheduler can list all its workers."""

SECONDS_TO_CONNECT_TO_DASK_SCHEDULER = 5.0
"""Seconds within which a Dask scheduler must accept a connection.

Until then the connection is tried again, since the scheduler may still be starting.
"""

SECONDS_TO_ANSWER_OF_SCHEDULER_OR_NEW_PROCESS = 30.0
"""Seconds within which a Dask scheduler must answer a question, and a new process must start.

A scheduler or process that takes longer counts as lost. The limit is a judgement: both take far
less on a machine that is not overloaded.
"""

SILENT_SECONDS_UNTIL_DASK_WORKERS_COUNT_AS_LOST = 300.0
"""Seconds without a sign of life from any Dask worker after which all workers count as lost.

The factorisation of a large matrix can silence a worker for minutes.
"""

SECONDS_TO_WAIT_FOR_FIRST_DASK_WORKER = 60.0
"""Seconds that a sweep waits for the first worker of a Dask scheduler without workers."""

MOST_ATTEMPTS_TO_START_WORKER_PROCESS = 3
"""Number of attempts to start a worker process before the sweep gives up."""

MOST_WORKER_PROCESSES_OF_JOBS_OPTION = 1000
"""Largest number of worker processes that --jobs may ask for."""

DASK_LOGGERS = ("distributed", "tornado", "asyncio")
"""Names of the loggers of Dask and its libraries, which are silenced.

If a cluster is lost, their messages would fill the screen.
"""

ShowLineToUser = Callable[[str], None]
"""A function that shows a line of text to the user."""


class WorkersOfSweep(NamedTuple):
    """The workers that solve the cases of a sweep.

    Attributes
    ----------
    executor : executor that runs functions in the workers; None: this process solves the cases
    workers : number of cases that the workers solve at the same time
    """

    executor: Executor | None
    workers: int


@contextmanager
def provide_workers_for_cases_of_sweep(
    jobs: int | None = None, scheduler: str | None = None, say: ShowLineToUser = lambda _: None
) -> Iterator[WorkersOfSweep]:
    """Provide workers for the cases of a sweep while the block of the `with` statement runs.

    Parameters
    ----------
    jobs : number of processes of this machine; None: one for each core
    scheduler : address of a Dask scheduler whose workers solve the cases; None: processes of this
        machine solve them
    say : called with a message when the sweep waits for workers

    Raises
    ------
    BadInput
        if the options are wrong, or the scheduler cannot be reached
    NoAnswer
        if all workers are lost
    """
    if scheduler is not None:
        if jobs is not None:
            raise BadInput(
                f"--jobs = {jobs}: "
                "the scheduler has its own workers; leave out --jobs or --scheduler"
            )
        with _provide_dask_workers(scheduler, say) as workers:
            yield workers
        return
    jobs = (
        min(_number_of_usable_cores(), MOST_WORKER_PROCESSES_OF_JOBS_OPTION)
        if jobs is None
        else jobs
    )
    if not 1 <= jobs <= MOST_WORKER_PROCESSES_OF_JOBS_OPTION:
        raise BadInput(f"--jobs = {jobs}: must be from 1 to {MOST_WORKER_PROCESSES_OF_JOBS_OPTION}")
    if jobs == 1:
        yield WorkersOfSweep(None, 1)
        return
    # After an error in the `with` block the processes are ended at once, otherwise after their
    # work.
    pool = _ProcessPool(jobs)
    try:
        yield WorkersOfSweep(pool, jobs)
    except BaseException:
        pool.shutdown(wait=False, cancel_futures=True)
        raise
    pool.shutdown()


def message_on_waiting_for_workers(start: float) -> str:
    """The message that the sweep has been waiting for workers since `start` [s, as time.time()]."""
    return f"waiting for workers since {time.strftime('%H:%M:%S', time.localtime(start))}"


def _number_of_usable_cores() -> int:
    """The number of processor cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


class _ProcessPool(Executor):
    """An executor that runs functions in worker processes, each with a pipe of its own.

    For each worker process, a thread of this process sends work and waits for the answer. If a
    worker process dies, even while it sends its answer, only its own work is lost. A new process
    replaces the dead one.

    Three existing pools were tried (pebble 5.2.3, loky 3.7.0, concurrent.futures of Python 3.11).
    In each of them the processes share one pipe. In all three pools the death of a process that was
    sending its answer was not noticed within 40 s. In pebble and concurrent.futures, work submitted
    afterwards had no answer within 20 s. In loky the death of a working process also ended the work
    of another process and made the whole pool unusable. The pool of concurrent.futures was unusable
    after the death of a process.
    """

    def __init__(self, number: int) -> None:
        self._threads = ThreadPoolExecutor(number)
        self._of_thread = threading.local()
        self._all: list[_WorkerProcess] = []
        self._ended = False

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Have the next free worker process call a function; returns the future of its result.

        The future raises NoAnswer if no process can be started, and BrokenExecutor if the process
        dies during the call.
        """
        return self._threads.submit(self._call_function_in_worker_of_this_thread, fn, args, kwargs)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End all worker processes: after their work if `wait`, otherwise at once."""
        self._ended = not wait
        self._threads.shutdown(wait, cancel_futures=cancel_futures)
        for process in self._all:
            process.kill()

    def _call_function_in_worker_of_this_thread(self, *work: Any) -> Any:
        """Call a function in the worker process of this thread and return its result.

        `work` is the function, its arguments and its keyword arguments.
        """
        process = getattr(self._of_thread, "process", None) or self._start_worker_process()
        self._of_thread.process = process
        try:
            outcome = process.call_function_in_process(work)
        except Exception as error:
            process.kill()
            # The process is lost: this thread starts a new process for its next work.
            self._of_thread.process = None
            raise BrokenExecutor(f"its process died ({type(error).__name__})") from error
        if not outcome.returned:
            raise outcome.value
        return outcome.value

    def _start_worker_process(self) -> "_WorkerProcess":
        """Start a new worker process and wait for its first answer.

        Raises NoAnswer after MOST_ATTEMPTS_TO_START_WORKER_PROCESS failed attempts, or if the pool
        has been ended.
        """
        reason = "stopped"
        for _ in range(0 if self._ended else MOST_ATTEMPTS_TO_START_WORKER_PROCESS):
            try:
                process = _WorkerProcess()
                self._all.append(process)
                process.call_function_in_process(
                    (os.getpid, (), {}), SECONDS_TO_ANSWER_OF_SCHEDULER_OR_NEW_PROCESS
                )
                return process
            # If the process does not answer in time, TimeoutError is raised, which is an OSError.
            except (EOFError, OSError, MemoryError, RuntimeError) as error:
                reason = " ".join(f"{type(error).__name__}: {error}".split())
        raise NoAnswer(
            f"sweep: worker processes cannot be started ({reason}); a script that calls "
            'drumlin.sweep with jobs needs `if __name__ == "__main__":`'
        )


class _OutcomeOfWorkerProcessCall(NamedTuple):
    """The outcome of a function call in a worker process.

    Attributes
    ----------
    returned : whether the function returned a value; else it raised an error
    value : the returned value or the raised error
    """

    returned: bool
    value: Any


class _WorkerProcess:
    """A worker process, which gets function calls through a pipe and returns their outcomes."""

    def __init__(self) -> None:
        spawn = multiprocessing.get_context("spawn")
        self._pipe, far_end = spawn.Pipe()
        self._process = spawn.Process(
            target=_call_functions_from_pipe, args=(far_end,), daemon=True
        )
        with _limit_threads_of_new_processes():
            self._process.start()
        # The worker process has its own copy of the pipe's far end. Once the copy here is closed,
        # the pipe ends when the process dies.
        far_end.close()

    def call_function_in_process(
        self, work: Any, limit: float | None = None
    ) -> _OutcomeOfWorkerProcessCall:
        """Call a function in the worker process and return the outcome, within `limit` [s].

        `work` is the function, its arguments and its keyword arguments. Any exception that this
        method raises means that the process has died or does not answer.
        """
        self._pipe.send(work)
        if not self._pipe.poll(limit):
            raise TimeoutError(f"no answer within {limit:g} s")
        return _OutcomeOfWorkerProcessCall(*self._pipe.recv())

    def kill(self) -> None:
        """End the worker process at once, even during a call."""
        self._process.kill()
        self._process.join()


def _call_functions_from_pipe(pipe: Any) -> None:
    """Call functions that come through the pipe and send back outcomes, until the pipe closes.

    This is the main function of a worker process.
    """
    _end_process_when_parent_ends()
    search_memory_for_garbage_seldom()
    with suppress(EOFError):
        while True:
            fn, args, kwargs = pipe.recv()
            try:
                answer = True, fn(*args, **kwargs)
            except Exception as error:
                answer = False, error
            pipe.send(answer)


_lock_for_changing_environment_variables = threading.Lock()
"""A lock held by the thread that changes the environment variables of this process."""


@contextmanager
def _limit_threads_of_new_processes() -> Iterator[None]:
    """Limit the threads of processes that are started while the block of the `with` statement runs.

    A new process inherits the environment variables of this process, which are changed meanwhile.
    """
    with _lock_for_changing_environment_variables:
        added = variables_for_one_blas_thread_unless_user_set_number()
        os.environ.update(added)
        try:
            yield
        finally:
            for name in added:
                os.environ.pop(name, None)


def _end_process_when_parent_ends() -> None:
    """Ignore Ctrl-C in this worker process, and end the process as soon as its parent ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()

    def end_this_process_after_end_of_parent() -> None:
        """Wait for the end of the parent process, then end this worker process."""
        if parent is not None:
            parent.join()
            os._exit(1)

    threading.Thread(target=end_this_process_after_end_of_parent, daemon=True).start()


@contextmanager
def _provide_dask_workers(address: str, say: ShowLineToUser) -> Iterator[WorkersOfSweep]:
    """Provide the workers of the Dask scheduler at an address while the `with` block runs."""
    try:
        distributed: Any = importlib.import_module("distributed")
    except ImportError as error:
        raise BadInput("--scheduler: Dask needs the extra drumlin[distributed]") from error
    with _silence_dask_loggers():
        client = _connected_dask_client(distributed, address)
        try:
            threads = _wait_for_first_dask_workers(client, address, say)
            pool = _DaskPool(client, address, distributed)
            try:
                yield WorkersOfSweep(pool, threads)
            finally:
                pool.shutdown()
        finally:
            # If the cluster is lost, closing the client may raise any exception.
            with suppress(Exception):
                client.close(timeout=2)


def _connected_dask_client(distributed: Any, address: str) -> Any:
    """Connect to the Dask scheduler at an address and return the client.

    Raises BadInput if no scheduler answers within SECONDS_TO_CONNECT_TO_DASK_SCHEDULER.
    """
    connected: Future[Any] = Future()

    class ExplicitlyClosedDaskClient(distributed.Client):  # type: ignore[misc]
        """A Dask client that is closed explicitly, not when Python deletes it."""

        def __del__(self) -> None:
            """Do nothing. Dask's own method would wait for a client that was never connected."""

    def connect_client_to_scheduler() -> None:
        """Connect the client, and put the client or the error into the future `connected`."""
        try:
            client = ExplicitlyClosedDaskClient(
                address, timeout=SECONDS_TO_CONNECT_TO_DASK_SCHEDULER, set_as_default=False
            )
            connected.set_result(client)
        except BaseException as error:
            connected.set_exception(error)

    start = time.monotonic()
    # The client connects in a thread of its own: if a port accepts the connection but stays silent,
    # only this thread is blocked for ever.
    threading.Thread(target=connect_client_to_scheduler, daemon=True).start()
    try:
        return connected.result(SECONDS_TO_CONNECT_TO_DASK_SCHEDULER)
    except Exception as error:
        connected.add_done_callback(_close_client_connected_too_late)
        reason = ""
        if time.monotonic() - start > 0.9 * SECONDS_TO_CONNECT_TO_DASK_SCHEDULER:
            reason = f" (tried for {SECONDS_TO_CONNECT_TO_DASK_SCHEDULER:g} s)"
        elif isinstance(error, ValueError):
            reason = f" ({error})"
        raise BadInput(
            f"--scheduler = {address!r}: no Dask scheduler answers there{reason}"
        ) from error


def _close_client_connected_too_late(connected: "Future[Any]") -> None:
    """Close a client that connected after the time limit; ignore errors of a lost connection."""
    with suppress(Exception):
        connected.result().close(timeout=2)


def _wait_for_first_dask_workers(client: Any, address: str, say: ShowLineToUser) -> int:
    """Wait for the first workers of a scheduler; returns the number of all their threads.

    Each thread solves one case at a time. Raises NoAnswer if no worker comes within
    SECONDS_TO_WAIT_FOR_FIRST_DASK_WORKER.
    """
    start, told = time.time(), False
    while True:
        threads = sum(
            worker["nthreads"] for worker in _workers_of_dask_scheduler(client, address).values()
        )
        if threads:
            return threads
        if time.time() - start > SECONDS_TO_WAIT_FOR_FIRST_DASK_WORKER:
            raise NoAnswer(
                f"--scheduler = {address!r}: it has had no workers for "
                f"{SECONDS_TO_WAIT_FOR_FIRST_DASK_WORKER:g} s"
            )
        if not told:
            say(message_on_waiting_for_workers(start))
            told = True
        time.sleep(min(1.0, SECONDS_TO_WAIT_FOR_FIRST_DASK_WORKER / 4))


def _workers_of_dask_scheduler(client: Any, address: str) -> dict[str, Any]:
    """The data of all workers of a Dask scheduler, by the name of the worker.

    Raises NoAnswer if the scheduler does not answer or is too old.
    """
    try:
        identity = client.sync(
            client.scheduler.identity,
            n_workers=-1,
            callback_timeout=SECONDS_TO_ANSWER_OF_SCHEDULER_OR_NEW_PROCESS,
        )
        workers: dict[str, Any] = identity["workers"]
    # A scheduler of an older Dask does not know the argument n_workers and raises TypeError.
    except TypeError as error:
        raise NoAnswer(
            f"--scheduler = {address!r}: is of a Dask older than "
            f"{OLDEST_ALLOWED_DASK_VERSION} ({error})"
        ) from error
    except Exception as error:
        raise _no_answer_error_on_lost_dask_scheduler(address) from error
    return workers


def _no_answer_error_on_lost_dask_scheduler(address: str) -> NoAnswer:
    """The exception to raise for a Dask scheduler that is lost."""
    return NoAnswer(f"--scheduler = {address!r}: the scheduler was lost, or does not answer")


class _DaskPool(Executor):
    """An executor that runs functions in the workers of a Dask scheduler.

    A thread watches the scheduler. Once the scheduler or all its workers are lost, all unfinished
    work fails with the same message of one line.
    """

    def __init__(self, client: Any, address: str, distributed: Any) -> None:
        self._client, self._address, self._dask = client, address, distributed
        self._inner: Executor = client.get_executor(pure=False)
        self._waiting: set[Future[Any]] = set()
        self._lost: NoAnswer | None = None
        # The lock guards the attributes `_waiting` and `_lost`. The event ends the watching thread.
        self._lock = threading.Lock()
        self._end = threading.Event()
        threading.Thread(target=self._watch_dask_cluster, daemon=True).start()

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Have a Dask worker call a function; returns the future of its result.

        Raises NoAnswer if the cluster is lost.
        """
        future: Future[Any] = Future()
        # The future is marked as running, so that it cannot be cancelled. Unfinished work is
        # dropped when the client is closed.
        future.set_running_or_notify_cancel()
        with self._lock:
            if self._lost is not None:
                raise self._lost
            self._waiting.add(future)
        try:
            inner = self._inner.submit(call_pickled_function, pickle.dumps((fn, args, kwargs)))
        except Exception as error:
            raise _no_answer_error_on_lost_dask_scheduler(self._address) from error
        inner.add_done_callback(
            lambda done: self._copy_dask_result_or_error_to_future(future, done)
        )
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Stop watching the cluster, and drop all unfinished work."""
        self._end.set()
        with self._lock:
            self._waiting.clear()

    def _copy_dask_result_or_error_to_future(
        self, future: "Future[Any]", inner: "Future[Any]"
    ) -> None:
        """Copy result or error of Dask's future `inner` to `future`, which the sweep waits for."""
        with self._lock:
            if future not in self._waiting:
                return
            self._waiting.discard(future)
            try:
                future.set_result(inner.result())
            except CancelledError:
                future.set_exception(_no_answer_error_on_lost_dask_scheduler(self._address))
            except self._dask.KilledWorker as error:
                future.set_exception(
                    BrokenExecutor(f"its workers died again and again ({type(error).__name__})")
                )
            except BaseException as error:
                future.set_exception(error)

    def _watch_dask_cluster(self) -> None:
        """Ask the scheduler for its workers once a second; fail all work once the cluster is lost.

        This is the main function of the watching thread.
        """
        last_seen: dict[str, Any] = {}
        last_sign = time.monotonic()
        while not self._end.wait(min(1.0, SECONDS_TO_ANSWER_OF_SCHEDULER_OR_NEW_PROCESS / 4)):
            try:
                workers = _workers_of_dask_scheduler(self._client, self._address)
                # A worker is alive if it has sent the scheduler a sign of life since the last
                # question.
                seen = {name: worker.get("last_seen") for name, worker in workers.items()}
                if any(last_seen.get(name) != moment for name, moment in seen.items()):
                    last_sign = time.monotonic()
                last_seen = seen
                limit = (
                    SILENT_SECONDS_UNTIL_DASK_WORKERS_COUNT_AS_LOST
                    if workers
                    else SECONDS_TO_WAIT_FOR_FIRST_DASK_WORKER
                )
                if time.monotonic() - last_sign > limit:
                    raise NoAnswer(
                        f"--scheduler = {self._address!r}: "
                        f"none of its workers is heard of for {limit:g} s"
                    )
            except NoAnswer as error:
                self._fail_all_unfinished_work(error)
                return

    def _fail_all_unfinished_work(self, error: NoAnswer) -> None:
        """Make all unfinished work, and all work submitted later, fail with the given error."""
        with self._lock:
            self._lost = error
            for future in self._waiting:
                future.set_exception(error)
            self._waiting.clear()


def call_pickled_function(work: bytes) -> Any:
    """Unpack a pickled function with its arguments, call it, and return its result.

    Dask workers run this function. The worker's BLAS has one thread meanwhile.
    """
    with one_blas_thread_unless_user_set_number():
        fn, args, kwargs = pickle.loads(work)
        return fn(*args, **kwargs)


@contextmanager
def _silence_dask_loggers() -> Iterator[None]:
    """Silence Dask's log while the block of the `with` statement runs.

    This module itself reports a lost cluster in one line. If the block fails, the log stays silent
    afterwards, too, since Dask continues to write about the loss.
    """
    # Remember the level of each logger of Dask, to restore it at the end.
    levels = {}
    for name in (*DASK_LOGGERS, *logging.root.manager.loggerDict):
        logger = logging.getLogger(name)
        if logger.name.split(".")[0] in DASK_LOGGERS:
            levels[logger] = logger.level
    for logger in levels:
        logger.setLevel(logging.CRITICAL + 1)
    yield
    for logger, level in levels.items():
        logger.setLevel(level)
