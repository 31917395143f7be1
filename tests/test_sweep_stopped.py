"""Killed sweeps and killed workers: the table equals an undisturbed run's byte for byte."""

import importlib.util
import json
import os
import random
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext, suppress
from functools import partial
from pathlib import Path

import pytest

from conftest import STUDY
from drumlin.sweeps.cases import solve_all_cases_of_sweep
from drumlin.sweeps.file import read_sweep_from_toml_file
from drumlin.sweeps.table import table_lines_of_cases, write_table_file
from picking import picked, saying

pytestmark = pytest.mark.slow

# Seconds that a busy machine may take. A hang takes for ever.
LIMIT = 300
MAIN = "from drumlin.cli import main; main()"
PYTHON = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
SWEEP = """
brake = "{brake}"
cases = 300
[model.fem]
elements = 24
[vary]
# Some cases lock; they fail, with their reason.
friction = {{ distribution = "uniform", from = 0.2, to = 1.3 }}
[vary."shoe.lining.clearance"]
distribution = "uniform"
from = "0 mm"
to = "0.2 mm"
each_shoe = true
"""


@pytest.fixture(scope="module")
def sweep_file(tmp_path_factory):
    path = tmp_path_factory.mktemp("sweep") / "sweep.toml"
    path.write_text(SWEEP.format(brake=STUDY / "brake.toml"))
    return path


@pytest.fixture(scope="module")
def undisturbed(sweep_file):
    sweep = read_sweep_from_toml_file(sweep_file)
    rows = solve_all_cases_of_sweep(sweep.cases)
    assert 0 < len(saying(picked(rows, "status"), "self-locking")) < 100
    path = sweep_file.with_name("undisturbed.csv")
    write_table_file(table_lines_of_cases(sweep.cases, rows), path)
    return path.read_bytes()


def start(
    *arguments: object, program: str = MAIN, stderr: int | None = None
) -> subprocess.Popen[str]:
    # The journal of the finished sweep tells which cases were solved.
    words = [*map(str, arguments), "--keep-journal"]
    command = [sys.executable, "-c", program, "sweep", *words]
    return subprocess.Popen(command, env=PYTHON, stdout=subprocess.PIPE, stderr=stderr, text=True)


def rows_in(journal: Path) -> int:
    return max(journal.read_bytes().count(b"\n") - 1, 0) if journal.exists() else 0


def wait_for(rows: int, journal: Path, process: subprocess.Popen[str]) -> None:
    end = time.monotonic() + LIMIT
    while rows_in(journal) < rows:
        assert process.poll() is None and time.monotonic() < end, "ended before it could be stopped"
        time.sleep(0.002)


def keys_in(journal: Path) -> list[str]:
    return [json.loads(line)["key"] for line in journal.read_text().splitlines()[1:]]


def finished(output: Path, *how: object) -> list[str]:
    """Let a sweep finish; the keys of all cases that its runs solved."""
    process = start(*how, "--output", output)
    said, _ = process.communicate(timeout=LIMIT)
    assert process.returncode == 0 and said.startswith("300 cases: ")
    return keys_in(output.with_name("out.csv.journal"))


def killed_at(moments: list[int], sweep_file: Path, folder: Path, jobs: list[int]) -> bytes:
    """The table of a sweep that was killed at given row counts of its journal, then finished.

    No case may be solved twice.
    """
    output, journal = folder / "out.csv", folder / "out.csv.journal"
    for moment, number in zip(moments, jobs, strict=True):
        process = start(sweep_file, "--output", output, "--jobs", number)
        wait_for(moment, journal, process)
        process.kill()
        # The run ends when no process holds its output, so that the workers have ended, too.
        process.communicate(timeout=LIMIT)
        assert not output.exists()
    keys = finished(output, sweep_file, "--jobs", 2)
    assert len(keys) == len(set(keys)) == 300
    return output.read_bytes()


def test_killed_at_five_random_moments(sweep_file, undisturbed, tmp_path):
    moments = sorted(random.Random(8).sample(range(10, 260), 5))
    assert killed_at(moments, sweep_file, tmp_path, [1, 1, 2, 1, 1]) == undisturbed


def worker_of(process: subprocess.Popen[str]) -> int:
    """A worker process of a sweep."""
    threads = Path(f"/proc/{process.pid}/task").iterdir()
    children = [child for thread in threads for child in (thread / "children").read_text().split()]
    return next(
        int(child)
        for child in children
        if "spawn_main" in Path(f"/proc/{child}/cmdline").read_text(errors="replace")
    )


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="needs /proc to find a worker")
def test_killed_worker_processes_cost_nothing(sweep_file, undisturbed, tmp_path):
    output, journal = tmp_path / "out.csv", tmp_path / "out.csv.journal"
    process = start(sweep_file, "--output", output, "--jobs", 2)
    for moment in (20, 90, 200):
        wait_for(moment, journal, process)
        os.kill(worker_of(process), signal.SIGKILL)
    said, _ = process.communicate(timeout=LIMIT)
    assert process.returncode == 0 and said.startswith("300 cases: ")
    keys = keys_in(journal)
    assert len(keys) == len(set(keys)) == 300
    assert output.read_bytes() == undisturbed


def test_one_and_two_jobs_and_a_damaged_journal_give_the_same_bytes(
    sweep_file, undisturbed, tmp_path
):
    output, journal = tmp_path / "out.csv", tmp_path / "out.csv.journal"
    finished(output, sweep_file, "--jobs", 1)
    assert output.read_bytes() == undisturbed
    data = bytearray(journal.read_bytes())
    for at in random.Random(3).sample(range(len(data)), 20):
        data[at] ^= 1
    journal.write_bytes(data)
    process = start(sweep_file, "--output", output, "--jobs", 2, stderr=subprocess.PIPE)
    _, noted = process.communicate(timeout=LIMIT)
    assert (
        process.returncode == 0 and "damaged lines are skipped" in noted and noted.count("\n") == 1
    )
    assert output.read_bytes() == undisturbed


needs_dask = pytest.mark.skipif(
    importlib.util.find_spec("distributed") is None, reason="needs drumlin[distributed]"
)


class Cluster:
    """A Dask scheduler and its workers on the loopback interface."""

    def __init__(self, folder: Path) -> None:
        self.known, self.folder, self.started = folder / "scheduler.json", folder, []
        self.scheduler = self.start("scheduler", "--port", "0", "--no-show")
        while not self.known.exists():
            assert self.scheduler.poll() is None
            time.sleep(0.05)
        self.address = json.loads(self.known.read_text())["address"]

    def start(self, name: str, *more: str) -> subprocess.Popen[bytes]:
        here = ("--scheduler-file", str(self.known), "--host", "127.0.0.1", "--no-dashboard")
        command = [sys.executable, "-m", f"distributed.cli.dask_{name}", *here, *more]
        with (self.folder / f"{name}{len(self.started)}.log").open("wb") as log:
            self.started.append(
                subprocess.Popen(command, env=PYTHON, stdout=log, stderr=log, cwd=self.folder)
            )
        return self.started[-1]

    def worker(self) -> subprocess.Popen[bytes]:
        return self.start("worker", "--nthreads", "1", "--no-nanny")


@pytest.fixture
def cluster(tmp_path):
    made = Cluster(tmp_path)
    yield made
    for process in made.started:
        process.send_signal(signal.SIGCONT)
        process.kill()
        process.wait()


@needs_dask
def test_a_dask_worker_is_killed(sweep_file, undisturbed, tmp_path, cluster):
    output, journal = tmp_path / "out.csv", tmp_path / "out.csv.journal"
    doomed = cluster.worker()
    cluster.worker()
    process = start(sweep_file, "--output", output, "--scheduler", cluster.address)
    wait_for(60, journal, process)
    doomed.kill()
    said, _ = process.communicate(timeout=LIMIT)
    assert process.returncode == 0 and said.startswith("300 cases: ")
    assert output.read_bytes() == undisturbed


IMPATIENT = """
import drumlin.sweeps.cases, drumlin.sweeps.workers as workers
workers.SECONDS_TO_ANSWER_OF_SCHEDULER_OR_NEW_PROCESS = 4.0
workers.SILENT_SECONDS_UNTIL_DASK_WORKERS_COUNT_AS_LOST = 6.0
workers.SECONDS_TO_WAIT_FOR_FIRST_DASK_WORKER = 4.0
drumlin.sweeps.cases.SECONDS_BEFORE_WAITING_MESSAGE = 1.0
from drumlin.cli import main
main()
"""


@needs_dask
@pytest.mark.parametrize("fault", ["last worker killed", "scheduler stopped"])
def test_a_lost_cluster_is_one_line_and_the_finished_cases_stay(
    sweep_file, undisturbed, tmp_path, cluster, fault
):
    output, journal = tmp_path / "out.csv", tmp_path / "out.csv.journal"
    worker = cluster.worker()
    how = [sweep_file, "--output", output, "--scheduler", cluster.address]
    process = start(*how, program=IMPATIENT, stderr=subprocess.PIPE)
    wait_for(30, journal, process)
    of = cluster.scheduler if "scheduler" in fault else worker
    of.send_signal(signal.SIGKILL if "killed" in fault else signal.SIGSTOP)
    _, said = process.communicate(timeout=LIMIT)
    *waiting, last = said.splitlines()
    assert (
        process.returncode == 3 and "finished cases are kept in" in last and cluster.address in last
    )
    for line in waiting:
        assert "waiting for workers since" in line
    keys = finished(output, sweep_file, "--jobs", 1)
    assert len(keys) == len(set(keys)) == 300
    assert output.read_bytes() == undisturbed


@contextmanager
def silent_port(greeting: bytes = b"") -> Iterator[str]:
    """The address of a port that takes every connection, sends a greeting and no more."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        taken = []

        def serve() -> None:
            with suppress(OSError):
                while True:
                    taken.append(server.accept()[0])
                    taken[-1].sendall(greeting)

        threading.Thread(target=serve, daemon=True).start()
        yield f"tcp://127.0.0.1:{server.getsockname()[1]}"
    for one in taken:
        one.close()


@contextmanager
def closed_port() -> Iterator[str]:
    """The address of a port that nothing listens on."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        address = f"tcp://127.0.0.1:{server.getsockname()[1]}"
    yield address


NO_SCHEDULERS = {
    "silent": (silent_port, " (tried for 5 s)"),
    "mail": (partial(silent_port, b"220 mail.example ready\r\n"), ""),
    "closed": (closed_port, " (tried for 5 s)"),
    "no port": (lambda: nullcontext("nonsense"), " (missing port number in address 'nonsense')"),
}


@needs_dask
@pytest.mark.parametrize("kind", NO_SCHEDULERS)
def test_what_is_no_scheduler_is_refused_in_one_line(sweep_file, tmp_path, kind):
    """An address that is no Dask scheduler is refused in one line.

    Within five seconds: the start of Python and its libraries on a busy machine.
    """
    port, tried = NO_SCHEDULERS[kind]
    with port() as address:
        start_time = time.monotonic()
        how = [sweep_file, "--output", tmp_path / "out.csv", "--scheduler", address]
        process = start(*how, stderr=subprocess.PIPE)
        _, said = process.communicate(timeout=LIMIT)
    assert process.returncode == 2
    assert said == f"drumlin: --scheduler = '{address}': no Dask scheduler answers there{tried}\n"
    assert time.monotonic() - start_time < 15


@needs_dask
def test_a_scheduler_that_listens_a_little_later_is_found(cluster, tmp_path):
    """Through a port that is opened two seconds after it is asked for."""
    host, port = cluster.address.removeprefix("tcp://").split(":")
    with closed_port() as address:
        here = int(address.rpartition(":")[2])

    opened: list[socket.socket] = []

    def forward(source: socket.socket, target: socket.socket) -> None:
        with suppress(OSError):
            while data := source.recv(2**16):
                target.sendall(data)
            target.shutdown(socket.SHUT_WR)

    def listen() -> None:
        time.sleep(2.0)
        server = socket.create_server(("127.0.0.1", here))
        opened.append(server)
        with suppress(OSError):
            while True:
                near, far = server.accept()[0], socket.create_connection((host, int(port)))
                opened.extend((near, far))
                for ends in ((near, far), (far, near)):
                    threading.Thread(target=forward, args=ends, daemon=True).start()

    threading.Thread(target=listen, daemon=True).start()
    cluster.worker()
    sweep = tmp_path / "s.toml"
    sweep.write_text(
        f'brake = "{STUDY / "brake.toml"}"\n[model.sine]\n[vary]\nfriction = [0.1, 0.2]\n'
    )
    how = [sweep, "--output", tmp_path / "out.csv", "--scheduler", address]
    process = start(*how, stderr=subprocess.PIPE)
    told, said = process.communicate(timeout=LIMIT)
    for one in opened:
        with suppress(OSError):
            one.shutdown(socket.SHUT_RDWR)
        one.close()
    assert process.returncode == 0 and told.startswith("2 cases: 2 solved"), said
