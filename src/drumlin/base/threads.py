"""One thread for linear algebra while drumlin solves, unless the user has set another number.

A solve factorises many small dense matrices. The BLAS of numpy and scipy shares each of them among
all cores of the machine, and its threads then wait for each other. A solve of a mesh of 10 000
nodes takes 4.3 s of processor time with two threads, and 0.3 s with one thread.
"""

import os
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from threadpoolctl import ThreadpoolController

THREAD_NUMBER_VARIABLES_OF_BLAS = (
    "OPENBLAS_NUM_THREADS",
    "GOTO_NUM_THREADS",
    "OMP_NUM_THREADS",
    "MKL_NUM_THREADS",
    "BLIS_NUM_THREADS",
)
"""Environment variables by which users set the number of threads of OpenBLAS, MKL or BLIS."""
THREAD_NUMBER_VARIABLES_SET_BY_COMMANDS = (
    "OPENBLAS_NUM_THREADS",
    "MKL_NUM_THREADS",
    "BLIS_NUM_THREADS",
)
"""Environment variables that commands and new processes set to one thread: one for each library."""


def has_user_set_number_of_blas_threads() -> bool:
    """Whether an environment variable of this process sets the number of threads of the BLAS.

    The libraries ignore empty variables, and those that are no positive whole number.
    """
    given = (os.environ.get(name, "").strip() for name in THREAD_NUMBER_VARIABLES_OF_BLAS)
    return any(text.isdecimal() and int(text) > 0 for text in given)


def variables_for_one_blas_thread_unless_user_set_number() -> dict[str, str]:
    """The environment variables with which numpy is loaded with one thread for linear algebra.

    A library reads its variable when it is loaded. The wheels of numpy and scipy contain OpenBLAS;
    other builds use MKL or BLIS. The dictionary is empty if the user has set a number of threads.
    """
    if has_user_set_number_of_blas_threads():
        return {}
    return dict.fromkeys(THREAD_NUMBER_VARIABLES_SET_BY_COMMANDS, "1")


@contextmanager
def one_blas_thread_unless_user_set_number() -> Iterator[None]:
    """Limit the BLAS of this process to one thread while the block of the `with` statement runs.

    Nothing is limited if the user has set a number of threads by an environment variable. Blocks
    may contain each other, and may run in several threads of Python at the same time. The numbers
    from before the first of these blocks return at the end of the last one.
    """
    if has_user_set_number_of_blas_threads():
        yield
        return
    _RUNNING_BLOCKS.begin_block()
    try:
        yield
    finally:
        _RUNNING_BLOCKS.end_block()


class _RunningBlocksWithOneBlasThread:
    """The number of blocks that now run with one BLAS thread, and the limit that they share.

    The number of BLAS threads belongs to the process, not to a thread of Python. If each block set
    and restored this number alone, two overlapping blocks would leave the process with one thread.
    """

    def __init__(self) -> None:
        """No block runs yet."""
        self._lock = threading.Lock()
        self._count = 0
        self._limit: Any = None

    def begin_block(self) -> None:
        """Count one more block; the first one limits the BLAS to one thread."""
        # The first call imports libraries. No other thread of Python waits for this with the lock.
        controller = _controller_of_loaded_blas()
        with self._lock:
            if self._count == 0:
                self._limit = controller.limit(limits=1, user_api="blas")
            self._count += 1

    def end_block(self) -> None:
        """Count one block less; the last one restores the numbers of threads."""
        with self._lock:
            self._count -= 1
            if self._count == 0:
                # The first and the last block may belong to different threads of Python.
                _let_every_python_thread_set_number_of_blas_threads()
                self._limit.restore_original_limits()
                _let_every_python_thread_set_number_of_blas_threads()

    def keep_lock_usable_in_forked_processes(self) -> None:
        """Let each later fork of this process wait until no thread counts a block.

        A fork copies the lock and only the thread that forks. If another thread held the lock at
        this moment, nobody would release the copy. Forks that wait copy a lock that is free, and a
        count that fits the limit. Blocks of other threads do not end in the new process, so that it
        keeps one thread if another thread's block runs during the fork.
        """
        if sys.platform != "win32":
            os.register_at_fork(
                before=self._lock.acquire,
                after_in_parent=self._lock.release,
                after_in_child=self._lock.release,
            )


_RUNNING_BLOCKS = _RunningBlocksWithOneBlasThread()
"""The blocks of this process that now run with one BLAS thread."""
_RUNNING_BLOCKS.keep_lock_usable_in_forked_processes()


@cache
def _controller_of_loaded_blas() -> "ThreadpoolController":
    """The controller of the BLAS of numpy and of the BLAS of scipy, which are loaded first.

    The controller finds only libraries that are loaded. It takes some 3 ms and is therefore kept.
    """
    import scipy.linalg  # noqa: F401, PLC0415
    from threadpoolctl import ThreadpoolController  # noqa: PLC0415

    return ThreadpoolController()


def _let_every_python_thread_set_number_of_blas_threads() -> None:
    """Let every thread of Python set the number of threads of OpenBLAS.

    From version 3.8 on threadpoolctl ignores all threads but the first one that sets the number.
    """
    from threadpoolctl import OpenBLASController  # noqa: PLC0415

    if hasattr(OpenBLASController, "clear_controlling_thread"):
        OpenBLASController.clear_controlling_thread(force=True)
