"""Who solves the cases of a sweep: processes of this machine, or the workers of a Dask cluster.

Loads no numpy: a worker limits its threads before it does. Workers that die, stop or never answer
are replaced, or become one line within the limits below.
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
CONNECT = 5.0
"""Seconds within which a scheduler must take a connection. One that is just starting is tried again
until then.
"""
ANSWER = 30.0  # s within which a scheduler answers, and a process starts
HEARD = 300.0  # s within which a Dask worker is heard of: a long factorisation can silence one for minutes
FIRST = 60.0  # s to wait for a worker where there is none
STARTS = 3  # times that a process is started anew before it is given up
MAX_JOBS = 1000
LOGGERS = ("distributed", "tornado", "asyncio")  # what they say of a lost cluster fills the screen

# The dense systems are many and small: more BLAS threads make them slower, by far where processes
# share the cores.
THREADS = {"OPENBLAS_NUM_THREADS": "1"}

Say = Callable[[str], None]


class Workers(NamedTuple):
    """An executor (None: this process itself) and how many cases it solves at a time."""

    executor: Executor | None
    workers: int


@contextmanager
def executor(
    jobs: int | None = None, scheduler: str | None = None, say: Say = lambda _: None
) -> Iterator[Workers]:
    """Workers while a block runs: `jobs` processes, by default one a core, or those of a Dask
    `scheduler`.

    say: told in a line where workers are waited for. Raises BadInput where they cannot be had,
    NoAnswer where they are lost.
    """
    if scheduler is not None:
        if jobs is not None:
            raise BadInput(
                f"--jobs = {jobs}: the scheduler has its own workers; leave out --jobs or --scheduler"
            )
        with _dask(scheduler, say) as found:
            yield found
        return
    jobs = min(_cores(), MAX_JOBS) if jobs is None else jobs
    if not 1 <= jobs <= MAX_JOBS:
        raise BadInput(f"--jobs = {jobs}: must be from 1 to {MAX_JOBS}")
    if jobs == 1:
        yield Workers(None, 1)
        return
    pool = _Processes(jobs)
    try:
        yield Workers(pool, jobs)
    except BaseException:
        pool.shutdown(wait=False, cancel_futures=True)
        raise
    pool.shutdown()


def waiting_since(start: float) -> str:
    """The line that says since when [time.time()] workers are waited for."""
    return f"waiting for workers since {time.strftime('%H:%M:%S', time.localtime(start))}"


def _cores() -> int:
    """The cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


class _Processes(Executor):
    """Processes, each asked by a thread of its own.

    A process that dies takes its own work with it alone, also where it dies while it sends its
    answer, and is replaced.
    """

    def __init__(self, number: int) -> None:
        self._threads = ThreadPoolExecutor(number)
        self._of_thread = threading.local()
        self._all: list[_Process] = []
        self._ended = False

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Give work to the process that is free next.

        The future raises NoAnswer where processes die as they start, BrokenExecutor where one dies
        at its work.
        """
        return self._threads.submit(self._ask, fn, args, kwargs)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End the processes: once they are done, or at once."""
        self._ended = not wait
        self._threads.shutdown(wait, cancel_futures=cancel_futures)
        for process in self._all:
            process.kill()

    def _ask(self, *work: Any) -> Any:
        """What a function returns in the process of this thread."""
        process = getattr(self._of_thread, "process", None) or self._started()
        try:
            good, answer = process.ask(work)
        except Exception as error:
            process.kill()
            process = None
            raise BrokenExecutor(f"its process died ({type(error).__name__})") from error
        finally:
            self._of_thread.process = process
        if not good:
            raise answer
        return answer

    def _started(self) -> "_Process":
        """A process that has answered. Raises NoAnswer."""
        reason = "stopped"
        for _ in range(0 if self._ended else STARTS):
            try:
                process = _Process()
                self._all.append(process)
                process.ask((os.getpid, (), {}), ANSWER)
                return process
            # A TimeoutError is an OSError.
            except (EOFError, OSError, MemoryError, RuntimeError) as error:
                reason = " ".join(f"{type(error).__name__}: {error}".split())
        raise NoAnswer(f"sweep: worker processes cannot be started ({reason})")


class _Process:
    """A process that does one piece of work after the other, through a pipe of its own."""

    def __init__(self) -> None:
        spawn = multiprocessing.get_context("spawn")
        self._pipe, far_end = spawn.Pipe()
        self._process = spawn.Process(target=_serve, args=(far_end,), daemon=True)
        with _environment():
            self._process.start()
        # The process has a copy of its own. With this one closed the pipe ends when the process
        # dies.
        far_end.close()

    def ask(self, work: Any, limit: float | None = None) -> tuple[bool, Any]:
        """Whether a function has returned, and what it has returned or raised.

        Any exception here says that the process died. `limit` is how long the function may take
        [s].
        """
        self._pipe.send(work)
        if not self._pipe.poll(limit):
            raise TimeoutError(f"no answer within {limit:g} s")
        answer: tuple[bool, Any] = self._pipe.recv()
        return answer

    def kill(self) -> None:
        """End the process whatever it does."""
        self._process.kill()
        self._process.join()


def _serve(pipe: Any) -> None:
    """In a process: answer until the pipe ends."""
    _attach()
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
def _environment() -> Iterator[None]:
    """The environment that processes are started in, for one thread at a time."""
    with _environment_lock:
        added = {name: value for name, value in THREADS.items() if name not in os.environ}
        os.environ.update(added)
        try:
            yield
        finally:
            for name in added:
                os.environ.pop(name, None)


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
def _dask(address: str, say: Say) -> Iterator[Workers]:
    try:
        distributed: Any = importlib.import_module("distributed")
    except ImportError as error:
        raise BadInput("--scheduler: Dask needs the extra drumlin[distributed]") from error
    with _silent():
        client = _client(distributed, address)
        try:
            threads = _first_workers(client, address, say)
            pool = _Dask(client, address, distributed)
            try:
                yield Workers(pool, threads)
            finally:
                pool.shutdown()
        finally:
            with suppress(Exception):  # of a cluster that is lost there is nothing to close
                client.close(timeout=2)


def _client(distributed: Any, address: str) -> Any:
    """A client of the scheduler at an address. Raises BadInput where none answers within CONNECT
    seconds.
    """
    found: Future[Any] = Future()

    class Client(distributed.Client):  # type: ignore[misc]
        def __del__(self) -> None:
            """Nothing: whoever has the client closes it. One that was never connected would be
            waited for here.
            """

    def connect() -> None:
        try:
            found.set_result(Client(address, timeout=CONNECT, set_as_default=False))
        except BaseException as error:
            found.set_exception(error)

    start = time.monotonic()
    threading.Thread(
        target=connect, daemon=True
    ).start()  # a port that accepts and is silent may hold it for ever
    try:
        return found.result(CONNECT)
    except Exception as error:
        found.add_done_callback(_close)
        tried = time.monotonic() - start > 0.9 * CONNECT
        why = (
            f" (tried for {CONNECT:g} s)"
            if tried
            else f" ({error})"
            if isinstance(error, ValueError)
            else ""
        )
        raise BadInput(
            f"--scheduler = {address!r}: no Dask scheduler answers there{why}"
        ) from error


def _close(found: "Future[Any]") -> None:
    """Close a client, also one that is connected too late. One that is lost has nothing to close."""
    with suppress(Exception):
        found.result().close(timeout=2)


def _first_workers(client: Any, address: str, say: Say) -> int:
    """How many cases the workers solve at a time, once there are any. Raises NoAnswer."""
    start, said = time.time(), False
    while True:
        threads = sum(worker["nthreads"] for worker in _ask(client, address).values())
        if threads:
            return threads
        if time.time() - start > FIRST:
            raise NoAnswer(f"--scheduler = {address!r}: it has had no workers for {FIRST:g} s")
        if not said:
            say(waiting_since(start))
            said = True
        time.sleep(min(1.0, FIRST / 4))


def _ask(client: Any, address: str) -> dict[str, Any]:
    """The scheduler's workers. Raises NoAnswer where it does not answer."""
    try:
        known: dict[str, Any] = client.sync(
            client.scheduler.identity, n_workers=-1, callback_timeout=ANSWER
        )["workers"]
    # An older scheduler answers that it does not know what it is asked.
    except TypeError as error:
        raise NoAnswer(
            f"--scheduler = {address!r}: is of a Dask older than {OLDEST_DASK} ({error})"
        ) from error
    except Exception as error:
        raise NoAnswer(
            f"--scheduler = {address!r}: the scheduler was lost, or does not answer"
        ) from error
    return known


class _Dask(Executor):
    """Work for a client's workers. What waits fails in one line once the scheduler or all workers
    are lost.
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
        future.set_running_or_notify_cancel()  # closing the client forgets what waits
        with self._lock:
            if self._lost is not None:
                raise self._lost
            self._waiting.add(future)
        try:
            inner = self._inner.submit(call, pickle.dumps((fn, args, kwargs)))
        except Exception as error:
            raise self._loss() from error
        inner.add_done_callback(lambda done: self._answer(future, done))
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Watch no longer, and forget what waits."""
        self._end.set()
        with self._lock:
            self._waiting.clear()

    def _loss(self) -> NoAnswer:
        return NoAnswer(
            f"--scheduler = {self._address!r}: the scheduler was lost, or does not answer"
        )

    def _answer(self, future: "Future[Any]", inner: "Future[Any]") -> None:
        """Pass on what came of some work."""
        with self._lock:
            if future not in self._waiting:
                return
            self._waiting.discard(future)
            try:
                future.set_result(inner.result())
            except CancelledError:
                future.set_exception(self._loss())
            except self._dask.KilledWorker as error:
                future.set_exception(
                    BrokenExecutor(f"its workers died again and again ({type(error).__name__})")
                )
            except BaseException as error:
                future.set_exception(error)

    def _watch(self) -> None:
        """Once a second: is there a scheduler, and a worker that it has heard of lately?"""
        seen: dict[str, Any] = {}
        heard = time.monotonic()
        while not self._end.wait(min(1.0, ANSWER / 4)):
            try:
                workers = _ask(self._client, self._address)
                now = {name: worker.get("last_seen") for name, worker in workers.items()}
                if any(seen.get(name) != last for name, last in now.items()):
                    heard = time.monotonic()
                seen = now
                limit = HEARD if workers else FIRST
                if time.monotonic() - heard > limit:
                    raise NoAnswer(
                        f"--scheduler = {self._address!r}: none of its workers is heard of for {limit:g} s"
                    )
            except NoAnswer as error:
                with self._lock:
                    self._lost = error
                    for future in self._waiting:
                        future.set_exception(error)
                    self._waiting.clear()
                return


def call(work: bytes) -> Any:
    """In a Dask worker: unpack a function and its arguments, which load numpy, once the threads are
    limited.
    """
    if "numpy" not in sys.modules:
        for name, value in THREADS.items():
            os.environ.setdefault(name, value)
    fn, args, kwargs = pickle.loads(work)
    return fn(*args, **kwargs)


@contextmanager
def _silent() -> Iterator[None]:
    """Without what Dask logs: a lost cluster is said in a line here, and its log ends where the
    block ends well.
    """
    loggers = [logging.getLogger(name) for name in (*LOGGERS, *logging.root.manager.loggerDict)]
    before = {logger: logger.level for logger in loggers if logger.name.split(".")[0] in LOGGERS}
    for logger in before:
        logger.setLevel(logging.CRITICAL + 1)
    yield
    for logger, level in before.items():
        logger.setLevel(level)
