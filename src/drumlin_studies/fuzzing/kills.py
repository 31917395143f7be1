"""Sweeps of brakes that are killed at random moments and resumed.

After the last resumption a sweep must write the table of an undisturbed run. No case may be solved
twice.
"""

import json
import os
import random
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path
from typing import Any

from drumlin.base.journal import JournalOfCaseResults
from drumlin_studies.fuzzing.inputs import (
    NAMES_OF_VALID_BRAKE_FILES_TO_BREAK,
    content_of_brake_file,
)

CASES_OF_KILLED_SWEEP = 150
"""Number of cases of a sweep that is killed."""
WALL_SECONDS_AFTER_WHICH_SWEEP_IS_STOPPED = 900.0
"""Wall-clock time [s] after which a run is stopped. The time is long because the machine may be
busy.
"""
WAYS_TO_RUN_A_SWEEP = ("one job", "two jobs", "Dask")
"""The ways to run a sweep: with one or two processes, or on a Dask cluster."""
PYTHON_PROGRAM_THAT_RUNS_COMMAND_LINE = "from drumlin.cli import main; main()"
"""Python program that runs drumlin's command line."""
TEXT_OF_SWEEP_FILE_TO_KILL = f"""
brake = "b.toml"
cases = {CASES_OF_KILLED_SWEEP}
[model.fem]
elements = 24
[vary]
friction = {{ distribution = "uniform", from = 0.2, to = 1.3 }}
"shoe.lining.clearance" = {{ distribution = "uniform", from = "0 mm", \
to = "0.2 mm", each_shoe = true }}
"""
"""Text of the sweep file of the sweeps that are killed."""


def kill_and_finish_one_sweep(case: dict[str, Any]) -> dict[str, Any]:
    """Kill a sweep several times, let it finish, and return a row of a table on how it ended.

    `case` holds `way`, how the sweep is run (one of WAYS_TO_RUN_A_SWEEP), the number of `kills`,
    and the `seed` of the random moments of the kills. The row adds `met`, the number of kills that
    hit a running sweep, and `fault`, the faults at the end as text, or "" without faults.
    """
    # Each kill comes when the journal has reached a random number of cases.
    rng = random.Random(f"kills {case['seed']} {case['way']}")
    moments = sorted(rng.sample(range(1, CASES_OF_KILLED_SWEEP - 10), case["kills"]))
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "b.toml").write_bytes(
            content_of_brake_file(NAMES_OF_VALID_BRAKE_FILES_TO_BREAK[0])
        )
        (folder / "s.toml").write_text(TEXT_OF_SWEEP_FILE_TO_KILL, encoding="utf-8")
        whole = _run_sweep_to_its_end(folder, "whole.csv", ["--jobs", "1"])
        with _sweep_command_options_for_way_of_running(case["way"], folder) as words:
            met = sum(
                _kill_sweep_at_case_count_and_say_if_it_was_running(moment, folder, words)
                for moment in moments
            )
            table = _run_sweep_to_its_end(folder, "t.csv", words)
        keys = _keys_of_cases_in_sweep_journal(folder / "t.csv.journal")
    # The final table must equal the table of the undisturbed run, and each case must stand once in
    # the journal.
    wrong, different = [], len(set(keys))
    if table != whole:
        wrong.append("another table")
    if len(keys) != different:
        wrong.append(f"{len(keys) - different} cases twice")
    if different != CASES_OF_KILLED_SWEEP:
        wrong.append(f"{different} cases kept")
    return {**case, "met": met, "fault": ", ".join(wrong)}


@contextmanager
def _sweep_command_options_for_way_of_running(way: str, folder: Path) -> Iterator[list[str]]:
    """The options of `drumlin sweep` for a way to run it, during a `with` block.

    For the way "Dask" a scheduler and a worker run on this machine during the block.
    """
    if way != "Dask":
        yield ["--jobs", "1" if way == "one job" else "2"]
        return
    known = folder / "scheduler.json"
    here = ["--scheduler-file", str(known), "--host", "127.0.0.1", "--no-dashboard"]
    scheduler = _start_python_process(
        ["-m", "distributed.cli.dask_scheduler", *here, "--port", "0", "--no-show"], folder
    )
    started = [scheduler]
    try:
        # The scheduler writes its address into a file as soon as it is ready.
        end = time.monotonic() + WALL_SECONDS_AFTER_WHICH_SWEEP_IS_STOPPED
        while not known.exists():
            if scheduler.poll() is not None or time.monotonic() > end:
                raise RuntimeError("the scheduler has not started")
            time.sleep(0.05)
        started.append(
            _start_python_process(
                ["-m", "distributed.cli.dask_worker", *here, "--nthreads", "1", "--no-nanny"],
                folder,
            )
        )
        yield ["--scheduler", json.loads(known.read_text(encoding="utf-8"))["address"]]
    finally:
        for process in started:
            process.kill()
            process.wait()


def _start_python_process(words: list[str], folder: Path) -> subprocess.Popen[bytes]:
    """Start Python in a folder with arguments `words`; it finds modules as this process does."""
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


def _start_sweep_process(folder: Path, output: str, words: list[str]) -> subprocess.Popen[bytes]:
    """Start the sweep of a folder with further options `words`; returns the process."""
    return _start_python_process(
        [
            "-c",
            PYTHON_PROGRAM_THAT_RUNS_COMMAND_LINE,
            "sweep",
            "s.toml",
            "--output",
            output,
            "--keep-journal",
            *words,
        ],
        folder,
    )


def _run_sweep_to_its_end(folder: Path, output: str, words: list[str]) -> bytes:
    """Run the sweep of a folder to its end; returns the table, or the exit status as text."""
    status = _start_sweep_process(folder, output, words).wait(
        WALL_SECONDS_AFTER_WHICH_SWEEP_IS_STOPPED
    )
    return (folder / output).read_bytes() if status == 0 else f"status {status}".encode()


def _kill_sweep_at_case_count_and_say_if_it_was_running(
    moment: int, folder: Path, words: list[str]
) -> bool:
    """Start the sweep of a folder and kill it as soon as its journal has `moment` cases.

    Returns whether the sweep was still running when it was killed.
    """
    process, journal = _start_sweep_process(folder, "t.csv", words), folder / "t.csv.journal"
    end = time.monotonic() + WALL_SECONDS_AFTER_WHICH_SWEEP_IS_STOPPED
    while process.poll() is None and time.monotonic() < end:
        if journal.exists() and journal.read_bytes().count(b"\n") > moment:
            break
        time.sleep(0.01)
    met = process.poll() is None
    process.kill()
    process.wait()
    _wait_until_sweep_journal_is_unlocked(journal)
    return met


def _wait_until_sweep_journal_is_unlocked(journal: Path) -> None:
    """Wait until no process locks the journal: the workers of a killed sweep may still run."""
    end = time.monotonic() + WALL_SECONDS_AFTER_WHICH_SWEEP_IS_STOPPED
    while time.monotonic() < end:
        try:
            with journal.open("ab") as file:
                _lock_open_file(file.fileno())
            return
        except OSError:
            time.sleep(0.02)


def _lock_open_file(handle: int) -> None:
    """Lock an open file, on systems that have such locks.

    Raises BlockingIOError if another process has locked it.
    """
    with suppress(ImportError):
        import fcntl  # noqa: PLC0415

        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)


def _keys_of_cases_in_sweep_journal(journal: Path) -> list[str]:
    """The keys of the solved cases in the journal of a sweep. Each line below the first has one."""
    return [
        json.loads(line)["key"] for line in journal.read_text(encoding="utf-8").splitlines()[1:]
    ]


def kill_and_finish_many_sweeps(
    chains: dict[str, int], kills: int, journal: JournalOfCaseResults, say: Callable[[str], None]
) -> list[dict[str, Any]]:
    """Kill many sweeps and let them finish; returns a row for each sweep on how it ended.

    Parameters
    ----------
    chains : dict
        Number of sweeps for each way to run them.
    kills : int
        Number of times that each sweep is killed.
    journal : JournalOfCaseResults
        Journal of this experiment; sweeps with a row in it are not run again.
    say : function
        Function that gets a line of text on the progress.
    """
    cases: list[dict[str, Any]] = []
    for way, count in chains.items():
        cases += [{"way": way, "seed": seed, "kills": kills} for seed in range(count)]
    rows: list[dict[str, Any]] = []
    for case in cases:
        say(f"killing a sweep: {case['way']}, {len(rows) + 1} of {len(cases)}")
        rows.append(
            journal.get_or_compute_case_result(
                {"of": "kills", **case}, partial(kill_and_finish_one_sweep, case)
            )
        )
    return rows


def killed_sweeps_summary_rows(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Summarise killed sweeps in a table with a row for each way to run a sweep.

    A row counts the sweeps, the kills, the kills that hit a running sweep, and the faults.
    """
    lines: list[dict[str, Any]] = []
    for way in WAYS_TO_RUN_A_SWEEP:
        own = [row for row in rows if row["way"] == way]
        if not own:
            continue
        line = {
            "way": way,
            "sweeps": len(own),
            "kills": sum(row["kills"] for row in own),
            "met": sum(row["met"] for row in own),
            "faults": sum(bool(row["fault"]) for row in own),
        }
        lines.append(line)
    return lines
