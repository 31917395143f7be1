"""Who solves the cases of a sweep: processes of this machine, or the workers of a Dask cluster.

The module loads no numpy, because a worker limits its threads before it loads numpy. Workers that
die, stop or never answer are replaced, or the sweep ends with one line within the limits below.
"""

import importlib
import logging
import multiprocessing
import os
import pickle
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import BrokenExecutor, CancelledError, Executor, Future, ThreadPoolExecutor
from contextlib import contextmanager, suppress
from typing import Any, NamedTuple

from drumlin.base.errors import BadInput, NoAnswer

OLDEST_DASK = "2025.4"
"""The oldest Dask whose scheduler names all its workers when it is asked for them."""

CONNECT_SECONDS = 5.0
"""Seconds within which a scheduler must take a connection. A scheduler that is just starting is
tried again until then."""

ANSWER_SECONDS = 30.0
"""Seconds within which a scheduler must answer and a new process must start. Later they count as
lost. A judgement: both take far less on a machine that is not overloaded."""

HEARTBEAT_SECONDS = 300.0
"""Seconds within which some Dask worker must be heard of. A long factorisation can silence a worker
for minutes; after this limit all workers count as lost."""

FIRST_WORKER_SECONDS = 60.0
"""Seconds that a scheduler without workers has to find the first one."""

MAX_PROCESS_STARTS = 3
"""How often a process is started before the sweep gives up."""

MAX_JOBS = 1000
"""Largest number of processes that a user may ask for."""

DASK_LOGGERS = ("distributed", "tornado", "asyncio")
"""Loggers whose messages about a lost cluster would fill the screen; they are silenced."""

WORKER_THREADS = {"OPENBLAS_NUM_THREADS": "1"}
"""Environment of each worker. The dense systems are many and small, so that more BLAS threads make
them slower, above all where processes share the cores."""

SayLine = Callable[[str], None]
"""A function that shows a line to the user."""


class Workers(NamedTuple):
    """An executor (None: this process itself) and how many cases it solves at a time."""

    executor: Executor | None
    workers: int


@contextmanager
def provide_workers(
    jobs: int | None = None, scheduler: str | None = None, say: SayLine = lambda _: None
) -> Iterator[Workers]:
    """Provide workers while a block runs.

    Parameters
    ----------
    jobs : number of processes; None: one a core
    scheduler : address of a Dask scheduler whose workers solve the cases; None: processes do
    say : told in a line when the block waits for workers

    Raises
    ------
    BadInput
        where the workers cannot be had
    NoAnswer
        where the workers are lost
    """
    if scheduler is not None:
        if jobs is not None:
            raise BadInput(
                f"--jobs = {jobs}: "
                "the scheduler has its own workers; leave out --jobs or --scheduler"
            )
        with _dask_workers(scheduler, say) as workers:
            yield workers
        return
    jobs = min(_usable_cores(), MAX_JOBS) if jobs is None else jobs
    if not 1 <= jobs <= MAX_JOBS:
        raise BadInput(f"--jobs = {jobs}: must be from 1 to {MAX_JOBS}")
    if jobs == 1:
        yield Workers(None, 1)
        return
    pool = _ProcessPool(jobs)
    try:
        yield Workers(pool, jobs)
    except BaseException:
        pool.shutdown(wait=False, cancel_futures=True)
        raise
    pool.shutdown()


def waiting_line(start: float) -> str:
    """The line that says since when [time.time()] the sweep waits for workers."""
    return f"waiting for workers since {time.strftime('%H:%M:%S', time.localtime(start))}"


def _usable_cores() -> int:
    """The number of cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


class _ProcessPool(Executor):
    """Processes, each with a thread of this process that gives the process its work.

    A process that dies takes only its own work with it, even where it dies while it sends its
    answer. Another process replaces it.

    Three pools of others were tried (pebble 5.2.3, loky 3.7.0, concurrent.futures of Python 3.11).
    The processes of each pool share a pipe. In all three a process that died while it sent its
    answer was not noticed within 40 s, and in pebble and concurrent.futures work that was given
    afterwards had no answer within 20 s. In loky a process that died at its work took the work of
    its neighbour with it, and the pool; the pool of concurrent.futures was unusable after a death.
    """

    def __init__(self, number: int) -> None:
        self._threads = ThreadPoolExecutor(number)
        self._of_thread = threading.local()
        self._all: list[_Process] = []
        self._ended = False

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Give work to the process that is free next.

        The future raises NoAnswer where processes die as they start, BrokenExecutor where a process
        dies at its work.
        """
        return self._threads.submit(self._ask, fn, args, kwargs)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End the processes: when they have finished their work, or at once without `wait`."""
        self._ended = not wait
        self._threads.shutdown(wait, cancel_futures=cancel_futures)
        for process in self._all:
            process.kill()

    def _ask(self, *work: Any) -> Any:
        """What a function returns in the process of this thread."""
        process = getattr(self._of_thread, "process", None) or self._start_process()
        self._of_thread.process = process
        try:
            outcome = process.ask(work)
        except Exception as error:
            process.kill()
            # The next work of this thread goes to a new process.
            self._of_thread.process = None
            raise BrokenExecutor(f"its process died ({type(error).__name__})") from error
        if not outcome.returned:
            raise outcome.value
        return outcome.value

    def _start_process(self) -> "_Process":
        """A new process that has answered once. Raises NoAnswer where none starts."""
        reason = "stopped"
        for _ in range(0 if self._ended else MAX_PROCESS_STARTS):
            try:
                process = _Process()
                self._all.append(process)
                process.ask((os.getpid, (), {}), ANSWER_SECONDS)
                return process
            # A TimeoutError is an OSError.
            except (EOFError, OSError, MemoryError, RuntimeError) as error:
                reason = " ".join(f"{type(error).__name__}: {error}".split())
        raise NoAnswer(f"sweep: worker processes cannot be started ({reason})")


class _Outcome(NamedTuple):
    """The outcome of a call in a process: whether the function returned, and its value or error."""

    returned: bool
    value: Any


class _Process:
    """A process that does one piece of work after the other, through a pipe of its own."""

    def __init__(self) -> None:
        spawn = multiprocessing.get_context("spawn")
        self._pipe, far_end = spawn.Pipe()
        self._process = spawn.Process(target=_serve_calls, args=(far_end,), daemon=True)
        with _limit_threads():
            self._process.start()
        # The process has its own copy of the far end. With this copy closed the pipe ends when the
        # process dies.
        far_end.close()

    def ask(self, work: Any, limit: float | None = None) -> _Outcome:
        """Call a function in the process; `limit` [s] bounds the time that it takes.

        Any exception that this method raises says that the process died.
        """
        self._pipe.send(work)
        if not self._pipe.poll(limit):
            raise TimeoutError(f"no answer within {limit:g} s")
        return _Outcome(*self._pipe.recv())

    def kill(self) -> None:
        """End the process, whatever it does."""
        self._process.kill()
        self._process.join()


def _serve_calls(pipe: Any) -> None:
    """Call the functions that come through the pipe and send their answers, in a worker process."""
    _follow_parent()
    with suppress(EOFError):
        while True:
            fn, args, kwargs = pipe.recv()
            try:
                answer = True, fn(*args, **kwargs)
            except Exception as error:
                answer = False, error
            pipe.send(answer)


_environment_lock = threading.Lock()


@contextmanager
def _limit_threads() -> Iterator[None]:
    """Limit the threads of the processes that a block starts, one block at a time."""
    with _environment_lock:
        added = {name: value for name, value in WORKER_THREADS.items() if name not in os.environ}
        os.environ.update(added)
        try:
            yield
        finally:
            for name in added:
                os.environ.pop(name, None)


def _follow_parent() -> None:
    """Leave Ctrl-C to the parent process, and end this worker process when the parent ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()

    def follow() -> None:
        """Wait for the end of the parent, then end this process."""
        if parent is not None:
            parent.join()
            os._exit(1)

    threading.Thread(target=follow, daemon=True).start()


@contextmanager
def _dask_workers(address: str, say: SayLine) -> Iterator[Workers]:
    """Provide the workers of the Dask scheduler at an address while a block runs."""
    try:
        distributed: Any = importlib.import_module("distributed")
    except ImportError as error:
        raise BadInput("--scheduler: Dask needs the extra drumlin[distributed]") from error
    with _silence_dask():
        client = _connected_client(distributed, address)
        try:
            threads = _await_first_workers(client, address, say)
            pool = _DaskPool(client, address, distributed)
            try:
                yield Workers(pool, threads)
            finally:
                pool.shutdown()
        finally:
            # A client of a lost cluster has nothing to close and may raise anything.
            with suppress(Exception):
                client.close(timeout=2)


def _connected_client(distributed: Any, address: str) -> Any:
    """A client of the scheduler at an address.

    Raises BadInput where no scheduler answers within CONNECT_SECONDS.
    """
    connected: Future[Any] = Future()

    class Client(distributed.Client):  # type: ignore[misc]
        """A client that its user closes."""

        def __del__(self) -> None:
            """Do nothing: Dask would wait here for a client that was never connected."""

    def connect() -> None:
        """Make the client, or keep the reason why there is none."""
        try:
            client = Client(address, timeout=CONNECT_SECONDS, set_as_default=False)
            connected.set_result(client)
        except BaseException as error:
            connected.set_exception(error)

    start = time.monotonic()
    # A port that accepts a connection and stays silent may hold this thread for ever.
    threading.Thread(target=connect, daemon=True).start()
    try:
        return connected.result(CONNECT_SECONDS)
    except Exception as error:
        connected.add_done_callback(_close_late_client)
        reason = ""
        if time.monotonic() - start > 0.9 * CONNECT_SECONDS:
            reason = f" (tried for {CONNECT_SECONDS:g} s)"
        elif isinstance(error, ValueError):
            reason = f" ({error})"
        raise BadInput(
            f"--scheduler = {address!r}: no Dask scheduler answers there{reason}"
        ) from error


def _close_late_client(connected: "Future[Any]") -> None:
    """Close a client that was connected too late. A lost client has nothing to close."""
    with suppress(Exception):
        connected.result().close(timeout=2)


def _await_first_workers(client: Any, address: str, say: SayLine) -> int:
    """Wait for the first workers; returns how many cases the workers solve at a time.

    Raises NoAnswer where no worker comes within FIRST_WORKER_SECONDS.
    """
    start, told = time.time(), False
    while True:
        threads = sum(worker["nthreads"] for worker in _scheduler_workers(client, address).values())
        if threads:
            return threads
        if time.time() - start > FIRST_WORKER_SECONDS:
            raise NoAnswer(
                f"--scheduler = {address!r}: it has had no workers for {FIRST_WORKER_SECONDS:g} s"
            )
        if not told:
            say(waiting_line(start))
            told = True
        time.sleep(min(1.0, FIRST_WORKER_SECONDS / 4))


def _scheduler_workers(client: Any, address: str) -> dict[str, Any]:
    """The scheduler's workers by name. Raises NoAnswer where the scheduler does not answer."""
    try:
        identity = client.sync(
            client.scheduler.identity, n_workers=-1, callback_timeout=ANSWER_SECONDS
        )
        workers: dict[str, Any] = identity["workers"]
    # An older scheduler does not know the argument n_workers and answers with a TypeError.
    except TypeError as error:
        raise NoAnswer(
            f"--scheduler = {address!r}: is of a Dask older than {OLDEST_DASK} ({error})"
        ) from error
    except Exception as error:
        raise _lost_scheduler_error(address) from error
    return workers


def _lost_scheduler_error(address: str) -> NoAnswer:
    """The exception for a scheduler that was lost."""
    return NoAnswer(f"--scheduler = {address!r}: the scheduler was lost, or does not answer")


class _DaskPool(Executor):
    """An executor on the workers of a Dask client.

    Once the scheduler or all workers are lost, all waiting work fails with one line.
    """

    def __init__(self, client: Any, address: str, distributed: Any) -> None:
        self._client, self._address, self._dask = client, address, distributed
        self._inner: Executor = client.get_executor(pure=False)
        self._waiting: set[Future[Any]] = set()
        self._lost: NoAnswer | None = None
        self._lock, self._end = threading.Lock(), threading.Event()
        threading.Thread(target=self._watch, daemon=True).start()

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Give work to a worker. Raises NoAnswer where the cluster is lost."""
        future: Future[Any] = Future()
        # Nobody can cancel the work any more. Closing the client forgets what waits.
        future.set_running_or_notify_cancel()
        with self._lock:
            if self._lost is not None:
                raise self._lost
            self._waiting.add(future)
        try:
            inner = self._inner.submit(call_packed_function, pickle.dumps((fn, args, kwargs)))
        except Exception as error:
            raise _lost_scheduler_error(self._address) from error
        inner.add_done_callback(lambda done: self._pass_answer(future, done))
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Watch the cluster no longer, and forget what waits."""
        self._end.set()
        with self._lock:
            self._waiting.clear()

    def _pass_answer(self, future: "Future[Any]", inner: "Future[Any]") -> None:
        """Pass the result of Dask's future on to the future that the sweep waits for."""
        with self._lock:
            if future not in self._waiting:
                return
            self._waiting.discard(future)
            try:
                future.set_result(inner.result())
            except CancelledError:
                future.set_exception(_lost_scheduler_error(self._address))
            except self._dask.KilledWorker as error:
                future.set_exception(
                    BrokenExecutor(f"its workers died again and again ({type(error).__name__})")
                )
            except BaseException as error:
                future.set_exception(error)

    def _watch(self) -> None:
        """Ask the scheduler about once a second; fail all work once the cluster is lost."""
        last_seen: dict[str, Any] = {}
        last_sign = time.monotonic()
        while not self._end.wait(min(1.0, ANSWER_SECONDS / 4)):
            try:
                workers = _scheduler_workers(self._client, self._address)
                seen = {name: worker.get("last_seen") for name, worker in workers.items()}
                if any(last_seen.get(name) != moment for name, moment in seen.items()):
                    last_sign = time.monotonic()
                last_seen = seen
                limit = HEARTBEAT_SECONDS if workers else FIRST_WORKER_SECONDS
                if time.monotonic() - last_sign > limit:
                    raise NoAnswer(
                        f"--scheduler = {self._address!r}: "
                        f"none of its workers is heard of for {limit:g} s"
                    )
            except NoAnswer as error:
                self._fail_all(error)
                return

    def _fail_all(self, error: NoAnswer) -> None:
        """Fail all waiting work, and all work to come, with an error."""
        with self._lock:
            self._lost = error
            for future in self._waiting:
                future.set_exception(error)
            self._waiting.clear()


def call_packed_function(work: bytes) -> Any:
    """The result of a function packed with its arguments, called in a Dask worker of one thread.

    Unpacking loads numpy, which reads the limit as it is loaded.
    """
    if "numpy" not in sys.modules:
        for name, value in WORKER_THREADS.items():
            os.environ.setdefault(name, value)
    fn, args, kwargs = pickle.loads(work)
    return fn(*args, **kwargs)


@contextmanager
def _silence_dask() -> Iterator[None]:
    """Silence Dask's log while a block runs.

    A lost cluster is told in one line by this module. The log stays silent where the block fails,
    since Dask goes on writing about the loss.
    """
    loggers = [
        logging.getLogger(name) for name in (*DASK_LOGGERS, *logging.root.manager.loggerDict)
    ]
    levels = {
        logger: logger.level for logger in loggers if logger.name.split(".")[0] in DASK_LOGGERS
    }
    for logger in levels:
        logger.setLevel(logging.CRITICAL + 1)
    yield
    for logger, level in levels.items():
        logger.setLevel(level)
