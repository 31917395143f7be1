"""Sweeps killed with -9 at random moments and resumed: the table of an undisturbed run, and no case
solved twice.
"""

import json
import os
import random
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

from drumlin.base.journal import Journal
from drumlin_studies.fuzzing.inputs import SOUND_BRAKES, brake_text

KILLED_CASES = 150
RUN_LIMIT = 900.0  # s that a run may take on a busy machine
RUN_WAYS = ("one job", "two jobs", "Dask")
DRUMLIN_PROGRAM = "from drumlin.cli import main; main()"
KILLED_SWEEP = f"""
brake = "b.toml"
cases = {KILLED_CASES}
[model.fem]
elements = 24
[vary]
friction = {{ distribution = "uniform", from = 0.2, to = 1.3 }}
"shoe.lining.clearance" = {{ distribution = "uniform", from = "0 mm", to = "0.2 mm", each_shoe = true }}
"""


def killed(case: dict[str, Any]) -> dict[str, Any]:
    """A sweep killed `kills` times in a way of RUN_WAYS, at moments of the random numbers of `seed`,
    then let finish.

    The row says how many kills met a run at work, and what is wrong at the end (nothing: empty).
    """
    rng = random.Random(f"kills {case['seed']} {case['way']}")
    moments = sorted(rng.sample(range(1, KILLED_CASES - 10), case["kills"]))
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "b.toml").write_bytes(brake_text(SOUND_BRAKES[0]))
        (folder / "s.toml").write_text(KILLED_SWEEP, encoding="utf-8")
        whole = _finished(folder, "whole.csv", ["--jobs", "1"])
        with _way(case["way"], folder) as words:
            met = sum(_killed_at(moment, folder, words) for moment in moments)
            table = _finished(folder, "t.csv", words)
        keys = _keys(folder / "t.csv.journal")
    wrong = [
        said
        for said, bad in (
            ("another table", table != whole),
            (f"{len(keys) - len(set(keys))} cases twice", len(keys) != len(set(keys))),
            (f"{len(set(keys))} cases kept", len(set(keys)) != KILLED_CASES),
        )
        if bad
    ]
    return {**case, "met": met, "fault": ", ".join(wrong)}


@contextmanager
def _way(way: str, folder: Path) -> Iterator[list[str]]:
    """The options that a sweep is run with; for Dask a scheduler and a worker on this machine
    alone.
    """
    if way != "Dask":
        yield ["--jobs", "1" if way == "one job" else "2"]
        return
    known = folder / "scheduler.json"
    here = ["--scheduler-file", str(known), "--host", "127.0.0.1", "--no-dashboard"]
    scheduler = _child(
        ["-m", "distributed.cli.dask_scheduler", *here, "--port", "0", "--no-show"], folder
    )
    started = [scheduler]
    try:
        end = time.monotonic() + RUN_LIMIT
        while not known.exists():
            if scheduler.poll() is not None or time.monotonic() > end:
                raise RuntimeError("the scheduler has not started")
            time.sleep(0.05)
        started.append(
            _child(
                ["-m", "distributed.cli.dask_worker", *here, "--nthreads", "1", "--no-nanny"],
                folder,
            )
        )
        yield ["--scheduler", json.loads(known.read_text(encoding="utf-8"))["address"]]
    finally:
        for process in started:
            process.kill()
            process.wait()


def _child(words: list[str], folder: Path) -> subprocess.Popen[bytes]:
    env = os.environ | {
        "PYTHONPATH": os.pathsep.join(filter(None, sys.path)),
        "OMP_NUM_THREADS": "1",
    }
    return subprocess.Popen(
        [sys.executable, *words],
        cwd=folder,
        env=env,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )


def _sweeping(folder: Path, output: str, words: list[str]) -> subprocess.Popen[bytes]:
    return _child(["-c", DRUMLIN_PROGRAM, "sweep", "s.toml", "--output", output, *words], folder)


def _finished(folder: Path, output: str, words: list[str]) -> bytes:
    status = _sweeping(folder, output, words).wait(RUN_LIMIT)
    return (folder / output).read_bytes() if status == 0 else f"status {status}".encode()


def _killed_at(moment: int, folder: Path, words: list[str]) -> bool:
    """Kill a run as soon as its journal has `moment` rows; whether it was still at work."""
    process, journal = _sweeping(folder, "t.csv", words), folder / "t.csv.journal"
    end = time.monotonic() + RUN_LIMIT
    while process.poll() is None and time.monotonic() < end:
        if journal.exists() and journal.read_bytes().count(b"\n") > moment:
            break
        time.sleep(0.01)
    met = process.poll() is None
    process.kill()
    process.wait()
    _unlocked(journal)
    return met


def _unlocked(journal: Path) -> None:
    """Wait until the workers of a killed run have ended, too: they hold its journal."""
    end = time.monotonic() + RUN_LIMIT
    while time.monotonic() < end:
        try:
            with journal.open("ab") as file:
                _lock(file.fileno())
            return
        except OSError:
            time.sleep(0.02)


def _lock(handle: int) -> None:
    import fcntl  # noqa: PLC0415

    fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)


def _keys(journal: Path) -> list[str]:
    return [
        json.loads(line)["key"] for line in journal.read_text(encoding="utf-8").splitlines()[1:]
    ]


def kill_all(
    chains: dict[str, int], kills: int, journal: Journal, say: Callable[[str], None]
) -> list[dict[str, Any]]:
    """So many sweeps in each way, each killed `kills` times; those that the journal has not yet."""
    cases = [
        {"way": way, "seed": seed, "kills": kills}
        for way, count in chains.items()
        for seed in range(count)
    ]
    rows: list[dict[str, Any]] = []
    for case in cases:
        say(f"killing a sweep: {case['way']}, {len(rows) + 1} of {len(cases)}")
        rows.append(journal.once({"of": "kills", **case}, partial(killed, case)))
    return rows


def table(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """A row a way: how many sweeps and kills, how many of them met a run at work, how many sweeps
    are wrong.
    """
    return [
        {
            "way": way,
            "sweeps": len(of),
            "kills": sum(row["kills"] for row in of),
            "met": sum(row["met"] for row in of),
            "faults": sum(bool(row["fault"]) for row in of),
        }
        for way in RUN_WAYS
        if (of := [row for row in rows if row["way"] == way])
    ]
