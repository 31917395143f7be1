"""Sweeps that are killed, and sweeps whose workers are: the table equals that of an undisturbed run byte for byte."""

import importlib.util
import json
import os
import random
import subprocess
import sys
import time
from pathlib import Path

import pytest

from conftest import STUDY
from drumlin.sweeps.cases import run, table, write_table
from drumlin.sweeps.file import read_sweep

DRUMLIN = [sys.executable, "-c", "from drumlin.cli.main import main; main()", "sweep"]
PYTHON = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
SWEEP = """
brake = "{brake}"
cases = 300
[model.fem]
elements = 24
[vary]
friction = {{ distribution = "uniform", from = 0.2, to = 1.3 }}   # some lock: failed cases, with their reason
"shoe.lining.clearance" = {{ distribution = "uniform", from = "0 mm", to = "0.2 mm", each_shoe = true }}
"""


@pytest.fixture(scope="module")
def sweep_file(tmp_path_factory):
    path = tmp_path_factory.mktemp("sweep") / "sweep.toml"
    path.write_text(SWEEP.format(brake=STUDY / "brake.toml"))
    return path


@pytest.fixture(scope="module")
def undisturbed(sweep_file):
    sweep = read_sweep(sweep_file)
    rows = run(sweep.cases)
    assert 0 < sum("self-locking" in row["status"] for row in rows) < 100
    path = sweep_file.with_name("undisturbed.csv")
    write_table(table(sweep.cases, rows), path)
    return path.read_bytes()


def start(*arguments: object) -> subprocess.Popen[str]:
    return subprocess.Popen([*DRUMLIN, *map(str, arguments)], env=PYTHON, stdout=subprocess.PIPE, text=True)


def rows_in(journal: Path) -> int:
    return max(journal.read_bytes().count(b"\n") - 1, 0) if journal.exists() else 0


def wait_for(rows: int, journal: Path, process: subprocess.Popen[str]) -> None:
    end = time.monotonic() + 60
    while rows_in(journal) < rows:
        assert process.poll() is None and time.monotonic() < end, "ended before it could be stopped"
        time.sleep(0.002)


def test_killed_at_five_random_moments(sweep_file, undisturbed, tmp_path):
    output, journal = tmp_path / "out.csv", tmp_path / "out.csv.journal"
    moments = sorted(random.Random(8).sample(range(10, 260), 5))
    for k, moment in enumerate(moments):
        process = start(sweep_file, "--output", output, "--jobs", 2 if k == 2 else 1)
        wait_for(moment, journal, process)
        process.kill()
        process.communicate(timeout=20)  # ends when no process holds its output: the workers end, too
        assert not output.exists()
    process = start(sweep_file, "--output", output, "--jobs", 2)
    said, _ = process.communicate(timeout=60)
    assert process.returncode == 0 and said.startswith("300 cases: ")
    keys = [json.loads(line)["key"] for line in journal.read_text().splitlines()[1:]]
    assert len(keys) == len(set(keys)) == 300  # what had finished was not solved again
    assert output.read_bytes() == undisturbed


@pytest.mark.skipif(importlib.util.find_spec("distributed") is None, reason="needs the extra drumlin[distributed]")
def test_a_dask_worker_is_killed(sweep_file, undisturbed, tmp_path):
    known = tmp_path / "scheduler.json"
    started = []

    def dask(name: str, *arguments: str) -> subprocess.Popen[bytes]:
        command = [sys.executable, "-m", f"distributed.cli.dask_{name}", "--scheduler-file", str(known), *arguments]
        with (tmp_path / f"{name}{len(started)}.log").open("wb") as log:
            started.append(subprocess.Popen(command, env=PYTHON, stdout=log, stderr=log, cwd=tmp_path))
        return started[-1]

    output, journal = tmp_path / "out.csv", tmp_path / "out.csv.journal"
    try:
        dask("scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--no-show")
        while not known.exists():
            assert started[0].poll() is None
            time.sleep(0.05)
        address = json.loads(known.read_text())["address"]
        worker = ("--nthreads", "1", "--no-nanny", "--no-dashboard", "--host", "127.0.0.1")
        doomed = dask("worker", *worker)
        dask("worker", *worker)
        process = start(sweep_file, "--output", output, "--scheduler", address)
        wait_for(60, journal, process)
        doomed.kill()
        said, _ = process.communicate(timeout=90)
        assert process.returncode == 0 and said.startswith("300 cases: ")
    finally:
        for process_ in started:
            process_.kill()
            process_.wait()
    assert output.read_bytes() == undisturbed
