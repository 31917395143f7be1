"""Which rows a sweep keeps or tries again, meshes by content, workers that die."""

import os
import shutil
import threading
from concurrent.futures import BrokenExecutor, Executor, Future
from types import SimpleNamespace

import pytest

from conftest import ROOT, STUDY
from drumlin.base.errors import BadInput, NoAnswer
from drumlin.base.journal import JournalOfCaseResults
from drumlin.base.threads import THREAD_NUMBER_VARIABLES_OF_BLAS
from drumlin.brake.file import read_brake
from drumlin.fem.preparation.cache import CacheOfCondensedBodies
from drumlin.sweeps import cases as sweeps
from drumlin.sweeps import workers
from drumlin.sweeps.cases import (
    SweepCase,
    journal_keys_of_cases,
    solve_all_cases_of_sweep,
    solve_case_without_raising,
    solve_chunk_of_cases,
)
from drumlin.sweeps.file import read_sweep_from_toml_file
from drumlin.sweeps.table import table_lines_of_cases
from picking import picked
from shared_parts import friction_cases

MESHED = """
brake = "brake.toml"
combine = "zip"
model = { fem = { elements = 20 } }
[vary]
"shoe[0].mesh" = ["mesh.msh", "other/mesh.msh"]
"shoe[0].mesh_unit" = ["mm", "mm"]
"""


def workers_of(pool, count):
    """The process numbers of the workers that answer `count` calls one after the other."""
    return {pool.submit(os.getpid).result(60) for _ in range(count)}


def failing(monkeypatch, error, times):
    """Let the case with friction 0.3 fail so many times; returns the list of attempts."""
    respond, tried = sweeps.solve_case_and_return_brake_and_response, []

    def at_times(case, *given):
        tried.append(case.changes["friction"])
        if case.changes["friction"] == 0.3 and tried.count(0.3) <= times:
            raise error
        return respond(case, *given)

    monkeypatch.setattr(sweeps, "solve_case_and_return_brake_and_response", at_times)
    return tried


def caused(kind, cause):
    error = kind("no such luck")
    error.__cause__ = cause
    return error


@pytest.mark.parametrize(
    ("error", "tries", "kept"),
    [
        (MemoryError(), 3, False),
        (OSError(24, "too many open files"), 3, False),
        (caused(BadInput, OSError(5, "input/output error")), 3, False),
        (caused(NoAnswer, MemoryError()), 3, False),
        (ZeroDivisionError("division by zero"), 1, False),
        (NoAnswer("self-locking"), 1, True),
        (BadInput("out of range"), 1, True),
    ],
)
def test_only_answers_and_refusals_of_the_case_itself_are_kept(
    brake, tmp_path, monkeypatch, error, tries, kept
):
    cases = friction_cases(brake, (0.2, 0.3, 0.4))
    with monkeypatch.context() as patched, JournalOfCaseResults(tmp_path / "j", "a") as journal:
        tried = failing(patched, error, 9)
        told = []
        rows = solve_all_cases_of_sweep(cases, journal=journal, done=lambda *at: told.append(at))
        assert (
            tried.count(0.3) == tries
            and tried.count(0.2) == 1
            and told == [(n, 3) for n in range(4)]
        )
        assert (
            rows[1]["status"].startswith("failed: ")
            and rows[0]["status"] == rows[2]["status"] == "solved"
        )
    with JournalOfCaseResults(tmp_path / "j", "a") as journal:
        assert len(journal) == 2 + kept
        again = solve_all_cases_of_sweep(cases, journal=journal)
    assert (again[1] == rows[1]) if kept else (again == solve_all_cases_of_sweep(cases))


def test_a_passing_failure_is_tried_again(brake, monkeypatch):
    cases = friction_cases(brake, (0.2, 0.3, 0.4))
    expected = solve_all_cases_of_sweep(cases)
    failing(monkeypatch, MemoryError(), 2)
    assert solve_all_cases_of_sweep(cases) == expected


@pytest.fixture
def meshed(tmp_path):
    (tmp_path / "sweep" / "other").mkdir(parents=True)
    shutil.copy(STUDY / "brake.toml", tmp_path / "sweep" / "brake.toml")
    for place, name in (("", "left"), ("other", "right")):
        shutil.copy(
            ROOT / "meshes" / f"double_shoe_{name}.msh", tmp_path / "sweep" / place / "mesh.msh"
        )
    path = tmp_path / "sweep" / "sweep.toml"
    path.write_text(MESHED)
    return path


def test_mesh_paths_count_from_the_sweep_file(meshed, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    made = read_sweep_from_toml_file(meshed.relative_to(tmp_path))
    monkeypatch.chdir("/")
    rows = solve_all_cases_of_sweep(made.cases)
    for row in rows:
        assert "no such file" not in row["status"]
    lines = table_lines_of_cases(made.cases, rows, meshed.parent)
    assert picked(lines, "shoe[0].mesh") == ["mesh.msh", "other/mesh.msh"]


def test_what_is_in_a_mesh_file_tells_cases_apart_not_its_name(meshed):
    cases = read_sweep_from_toml_file(meshed).cases
    first, second = journal_keys_of_cases(cases)
    assert first != second
    mesh = meshed.parent / "mesh.msh"
    shutil.copy(meshed.parent / "other" / "mesh.msh", mesh)
    again, _ = journal_keys_of_cases(cases)
    assert again["changes"] == second["changes"] != first["changes"]
    brake = read_brake(STUDY / "brake.toml")
    shoes = (brake.shoes[0].model_copy(update={"mesh": mesh}), brake.shoes[1])
    based = [SweepCase(brake.model_copy(update={"shoes": shoes}), {})]
    before = list(journal_keys_of_cases(based))
    mesh.write_text(mesh.read_text() + "\n")
    assert list(journal_keys_of_cases(based)) != before


@pytest.mark.slow
def test_bodies_in_the_cache_follow_their_mesh_file(tmp_path):
    brake = read_brake(ROOT / "meshes" / "double_shoe.toml")
    mesh = tmp_path / "left.msh"
    left = next(i for i, shoe in enumerate(brake.shoes) if shoe.name == "left")
    shutil.copy(brake.shoes[left].mesh, mesh)
    case = SweepCase(brake, {f"shoe[{left}].mesh": str(mesh)})
    cache = CacheOfCondensedBodies()
    assert solve_case_without_raising(case, cache).row["status"] == "solved"
    mesh.write_text("no mesh")
    assert "is not a mesh that can be read" in solve_case_without_raising(case, cache).row["status"]


def test_a_mesh_file_that_is_gone_is_no_answer_of_the_brake(meshed, tmp_path):
    made = read_sweep_from_toml_file(meshed)
    mesh = meshed.parent / "mesh.msh"
    data = mesh.read_bytes()
    mesh.unlink()
    with pytest.raises(BadInput, match=r"mesh = .*mesh\.msh'*: cannot be read"):
        read_sweep_from_toml_file(meshed)
    with JournalOfCaseResults(tmp_path / "j", "a") as journal:
        assert (
            "no such file" in solve_all_cases_of_sweep(made.cases[:1], journal=journal)[0]["status"]
            and len(journal) == 0
        )
        mesh.write_bytes(data)
        assert solve_all_cases_of_sweep(
            made.cases[:1], journal=journal
        ) == solve_all_cases_of_sweep(made.cases[:1])


class Deadly(Executor):
    """An executor whose worker dies of the case with friction 0.3."""

    def __init__(self):
        self.sent = []

    def submit(self, fn, /, cases, **_):
        future = Future()
        self.sent.append([case.changes["friction"] for case in cases])
        if 0.3 in self.sent[-1]:
            future.set_exception(BrokenExecutor("its process died"))
        else:
            future.set_result(solve_chunk_of_cases(cases))
        return future


def test_a_case_that_kills_its_workers_is_a_failed_row_and_the_rest_goes_on(brake, tmp_path):
    cases = friction_cases(brake, (0.1, 0.2, 0.3, 0.4, 0.5))
    expected = solve_all_cases_of_sweep(cases)
    deadly = Deadly()
    with JournalOfCaseResults(tmp_path / "j", "a") as journal:
        rows = solve_all_cases_of_sweep(cases, executor=deadly, workers=2, journal=journal)
        assert len(journal) == 4
    assert rows[:2] + rows[3:] == expected[:2] + expected[3:]
    assert rows[2] == {"status": "failed: its worker was lost (BrokenExecutor: its process died)"}
    # The deadly case is tried alone, and once more.
    assert deadly.sent[-2:] == [[0.3], [0.3]]


@pytest.mark.slow
def test_a_process_that_dies_takes_its_own_work_alone_and_threads_are_one(monkeypatch):
    for name in THREAD_NUMBER_VARIABLES_OF_BLAS:
        monkeypatch.delenv(name, raising=False)
    with workers.provide_workers_for_cases_of_sweep(2) as (pool, _):
        # A function of the standard library imports no module of drumlin in the new process, which
        # could set the variable itself.
        assert pool.submit(os.getenv, "OPENBLAS_NUM_THREADS").result(60) == "1"
        ids = workers_of(pool, 2)
        with pytest.raises(BrokenExecutor):
            pool.submit(os._exit, 3).result(60)
        ids |= workers_of(pool, 4)
        assert len(ids) >= 2 and os.getpid() not in ids
    assert "OPENBLAS_NUM_THREADS" not in os.environ


def test_processes_that_die_as_they_start_are_one_line(monkeypatch):
    def never(*_, **__):
        raise OSError(11, "Resource temporarily unavailable")

    monkeypatch.setattr("multiprocessing.context.SpawnProcess.start", never)
    with (
        workers.provide_workers_for_cases_of_sweep(2) as (pool, _),
        pytest.raises(NoAnswer, match=r"cannot be started .*; a script .* needs `if __name__ == "),
    ):
        pool.submit(os.getpid).result(60)


def die_while_answering():
    """Bytes that kill the process once half of them may have been sent."""
    threading.Timer(0.2, os._exit, [3]).start()
    return bytes(10**9)


@pytest.mark.slow
def test_a_process_that_dies_while_it_sends_its_answer_costs_that_answer_alone():
    with workers.provide_workers_for_cases_of_sweep(2) as (pool, _):
        with pytest.raises(BrokenExecutor):
            pool.submit(die_while_answering).result(60)
        assert workers_of(pool, 4)


@pytest.mark.parametrize("jobs", [0, -1, 10**20, 1001])
def test_jobs_have_bounds(jobs):
    with (
        pytest.raises(BadInput, match=f"--jobs = {jobs}: must be from 1 to 1000"),
        workers.provide_workers_for_cases_of_sweep(jobs),
    ):
        pass


def test_waiting_is_said_once(brake, monkeypatch):
    monkeypatch.setattr(sweeps, "SECONDS_BEFORE_WAITING_MESSAGE", 0.05)

    class Slow(Executor):
        def submit(self, fn, /, cases, **_):
            future = Future()
            import threading

            threading.Timer(0.4, lambda: future.set_result(fn(cases))).start()
            return future

    said = []
    solve_all_cases_of_sweep(
        [SweepCase(brake, {"friction": 0.3}, "sine")], executor=Slow(), say=said.append
    )
    assert len(said) == 1 and said[0].startswith("waiting for workers since ")


class Old:
    """A client of a scheduler that does not know what it is asked."""

    scheduler = SimpleNamespace(identity=None)

    def sync(self, *asked, **more):
        raise TypeError("Scheduler.identity() got an unexpected keyword argument 'n_workers'")


def test_a_scheduler_of_an_older_dask_is_not_called_lost():
    with pytest.raises(
        NoAnswer,
        match=rf"is of a Dask older than {workers.OLDEST_ALLOWED_DASK_VERSION} \(.*'n_workers'\)",
    ):
        workers._workers_of_dask_scheduler(Old(), "tcp://127.0.0.1:1")
    assert (
        f'"distributed>={workers.OLDEST_ALLOWED_DASK_VERSION}"'
        in (ROOT / "pyproject.toml").read_text()
    )
