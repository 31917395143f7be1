"""Solves from Python have one BLAS thread, unless the user has set another number of threads."""

import json
import os
import pickle
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from threading import Barrier

import pytest
import threadpoolctl

import drumlin
from drumlin.base import threads
from drumlin.sweeps.workers import call_pickled_function

DOORS_THAT_SOLVE = (
    "check",
    "compare",
    "fields",
    "hold",
    "reference",
    "self_locking",
    "sensitivity",
    "size",
    "solve",
    "sweep",
    "wear",
)
"""The public functions that solve brakes."""

SOLVES_BY_A_LAW = """
import json, sys, numpy, scipy.linalg, threadpoolctl, drumlin

def numbers():
    return [found["num_threads"] for found in threadpoolctl.threadpool_info()]

threadpoolctl.threadpool_limits(2, user_api="blas")
before, seen = numbers(), {}
solving = "none"

@drumlin.law("spy")
def shape(phi, layout):
    "A law that notes the number of threads while a brake is solved."
    seen.setdefault(solving, []).extend(numbers())
    return numpy.sin(phi)

brake = drumlin.example("double_shoe")
for solving, call in {
    "solve": lambda: drumlin.solve(brake, "spy"),
    "compare": lambda: drumlin.compare(brake, models=["spy"]),
    "size": lambda: drumlin.size(brake, "friction", torque=400.0, model="spy"),
    "sweep": lambda: drumlin.sweep(brake, {"friction": [0.2, 0.3]}, model="spy"),
}.items():
    call()
print(json.dumps({"before": before, "seen": seen, "after": numbers()}))
"""


FORKS_WHILE_ANOTHER_THREAD_HOLDS_THE_LOCK = """
import os, signal, threading, time
from types import SimpleNamespace
from drumlin.base import threads

holds = threading.Event()

class Slow:
    def limit(self, **given):
        holds.set()
        time.sleep(0.3)
        return SimpleNamespace(restore_original_limits=lambda: None)

threads._controller_of_loaded_blas = Slow

def block():
    with threads.one_blas_thread_unless_user_set_number():
        pass

other = threading.Thread(target=block)
other.start()
holds.wait()
child = os.fork()
if child == 0:
    signal.alarm(3)
    block()
    os._exit(0)
other.join()
block()
print(os.waitpid(child, 0)[1])
"""


def blas_numbers():
    """The numbers of threads of each BLAS of this process."""
    found = threadpoolctl.threadpool_info()
    return {library["num_threads"] for library in found if library["user_api"] == "blas"}


def seen_numbers_of_threads(**variables):
    """The numbers of threads before, during and after solves in a process with these variables."""
    mine = {k: v for k, v in os.environ.items() if k not in threads.THREAD_NUMBER_VARIABLES_OF_BLAS}
    done = subprocess.run(
        [sys.executable, "-c", SOLVES_BY_A_LAW],
        env=mine | variables,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_each_solve_from_python_has_one_blas_thread_and_restores_the_number():
    found = seen_numbers_of_threads()
    assert len(found["before"]) >= 1 and set(found["before"]) == {2}
    assert found["after"] == found["before"]
    assert set(found["seen"]) == {"solve", "compare", "size", "sweep"}
    for door, numbers in found["seen"].items():
        assert set(numbers) == {1}, door


@pytest.mark.parametrize("name", ["OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"])
def test_a_number_of_threads_that_the_user_set_stays(name):
    found = seen_numbers_of_threads(**{name: "2"})
    assert found["after"] == found["before"]
    for door, numbers in found["seen"].items():
        assert set(numbers) == {2}, door


class Reached(Exception):
    """The limit of threads was asked for."""


@pytest.mark.parametrize("name", DOORS_THAT_SOLVE)
def test_every_door_that_solves_limits_the_threads_first(name, monkeypatch):
    def limit():
        raise Reached

    monkeypatch.setattr(threads, "one_blas_thread_unless_user_set_number", limit)
    with pytest.raises(Reached):
        getattr(drumlin, name)()


def test_every_other_public_function_is_known_to_solve_nothing():
    functions = {name for name in drumlin.__all__ if callable(getattr(drumlin, name))}
    classes = {"BadInput", "Brake", "NoAnswer", "Response"}
    assert functions - classes - set(DOORS_THAT_SOLVE) == {
        "example",
        "law",
        "read_brake",
        "remove_law",
        "vary",
        "write_brake",
    }


def test_overlapping_blocks_of_several_threads_restore_the_number(monkeypatch):
    """The first block ends while the second one runs, as solves of two threads may."""
    for name in threads.THREAD_NUMBER_VARIABLES_OF_BLAS:
        monkeypatch.delenv(name, raising=False)
    first, second = (threads.one_blas_thread_unless_user_set_number() for _ in range(2))
    with threadpoolctl.threadpool_limits(2, user_api="blas"):
        first.__enter__()
        second.__enter__()
        first.__exit__(None, None, None)
        assert blas_numbers() == {1}
        second.__exit__(None, None, None)
        assert blas_numbers() == {2}


@pytest.mark.skipif(not hasattr(os, "fork"), reason="processes are not forked here")
def test_a_process_forked_while_another_thread_holds_the_lock_does_not_hang():
    """The signal SIGALRM ends a process that waits for the lock, and the status is then 14."""
    mine = {k: v for k, v in os.environ.items() if k not in threads.THREAD_NUMBER_VARIABLES_OF_BLAS}
    done = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", FORKS_WHILE_ANOTHER_THREAD_HOLDS_THE_LOCK],
        env=mine,
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.split() == ["0"]


BOTH_WORK = Barrier(2)


def blas_numbers_while_both_threads_work(waits_before_its_end):
    """The numbers of threads while two blocks run; the block that waits ends last."""
    BOTH_WORK.wait(10)
    found = blas_numbers()
    BOTH_WORK.wait(10)
    time.sleep(0.05 * waits_before_its_end)
    return found


@pytest.mark.parametrize("last", [0, 1])
def test_threads_of_a_dask_worker_have_one_blas_thread_each(monkeypatch, last):
    """A Dask worker calls its function in several threads of one process at the same time.

    The thread that began first may end first. The numbers of threads then return as well.
    """
    for name in threads.THREAD_NUMBER_VARIABLES_OF_BLAS:
        monkeypatch.delenv(name, raising=False)
    works = [
        pickle.dumps((blas_numbers_while_both_threads_work, (index == last,), {}))
        for index in range(2)
    ]
    # A thread that ends leaves its limit, and no claim to be the only one that may set numbers.
    with ThreadPoolExecutor(1) as pool:
        before = pool.submit(threadpoolctl.threadpool_limits, 2, "blas").result()
    try:
        with ThreadPoolExecutor(2) as pool:
            found = list(pool.map(call_pickled_function, works))
            assert found == [{1}, {1}]
            assert blas_numbers() == {2}
    finally:
        with ThreadPoolExecutor(1) as pool:
            pool.submit(before.restore_original_limits).result()


def test_new_processes_get_one_thread_unless_the_user_has_set_a_number(monkeypatch):
    for name in threads.THREAD_NUMBER_VARIABLES_OF_BLAS:
        monkeypatch.delenv(name, raising=False)
    wanted = dict.fromkeys(("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "BLIS_NUM_THREADS"), "1")
    assert threads.variables_for_one_blas_thread_unless_user_set_number() == wanted
    monkeypatch.setenv("OMP_NUM_THREADS", "3")
    assert threads.variables_for_one_blas_thread_unless_user_set_number() == {}
    for ignored in ("", "0", "many", "-2"):
        monkeypatch.setenv("OMP_NUM_THREADS", ignored)
        assert threads.variables_for_one_blas_thread_unless_user_set_number() == wanted


def test_a_solve_that_fails_restores_the_number(monkeypatch):
    for name in threads.THREAD_NUMBER_VARIABLES_OF_BLAS:
        monkeypatch.delenv(name, raising=False)
    with threadpoolctl.threadpool_limits(2, user_api="blas"):
        with pytest.raises(drumlin.BadInput):
            drumlin.solve(drumlin.example("double_shoe"), "no such model")
        with pytest.raises(KeyError), threads.one_blas_thread_unless_user_set_number():
            raise KeyError
        assert blas_numbers() == {2}


def test_commands_have_one_blas_thread():
    """On a machine with one core the BLAS has one thread anyway."""
    mine = {k: v for k, v in os.environ.items() if k not in threads.THREAD_NUMBER_VARIABLES_OF_BLAS}
    script = (
        "import drumlin.cli, numpy, scipy.linalg, threadpoolctl as t\n"
        "print({found['num_threads'] for found in t.threadpool_info()})"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], env=mine, capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "{1}"
