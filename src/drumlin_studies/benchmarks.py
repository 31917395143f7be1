"""Figures of speed and size over the commits, kept as one line of JSON a measurement.

`make benchmarks` measures the figures and appends a line to HISTORY. Every time is divided by the
time of a fixed workload or of fixed imports in the same run. Such a ratio hardly depends on the
machine, so that lines from different machines can be compared.
"""

import json
import resource
import subprocess
import sys
import time
from collections.abc import Callable, Mapping
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from statistics import median
from typing import NamedTuple

import numpy as np

import drumlin
from drumlin.brake.brake import Brake
from drumlin.fem.solve import prepare_finest_division
from drumlin.studies import REPOSITORY, examples

HISTORY = REPOSITORY / "reports" / "reference" / "benchmarks" / "history.jsonl"
"""The kept file: one line a measurement, the oldest first."""

TIMED_SOLVES = (
    "double_shoe",
    "double_shoe_flexible",
    "post_brake",
    "duo_servo",
    "band",
    "rail_clamp",
)
"""Example brakes whose default solve is timed.

They stand for stiff and flexible shoes, an elastic ring, shoes that share a strut, a band of
blocks, and a plane.
"""

COUNTED = ("double_shoe", "post_brake")
"""Example brakes whose unknowns and active-set iterations are counted: without and with a ring."""

USUAL_REPEATS = 9
"""Repeats of each time by default. The median of nine is steady to some 2 % on a busy machine."""

SYSTEM_SIZE = 60
"""Equations of each dense system of the workload, as many as a shoe has contact nodes."""

SYSTEMS = 80
"""Number of dense systems in the workload, which takes some 5 ms in all."""

ADDITIONS = 100_000
"""Additions by the interpreter in the workload, because a solve spends much time in Python."""

IMPORTS = "import numpy, scipy.linalg, pydantic"
"""Program with the imports that every command needs. Start-up is measured relative to its time."""

COMMAND = "from drumlin.cli import main; main()"
"""Program that runs drumlin's command line, whether or not the command is installed."""


class Benchmark(NamedTuple):
    """A measurement: the commit, its day (YYYY-MM-DD), and the figures by name."""

    commit: str
    date: str
    figures: Mapping[str, float]


def run_reference_workload() -> float:
    """Do the fixed work that times are divided by; returns a number, so that all of it is needed.

    A change of this function makes the earlier lines of the history incomparable.
    """
    matrix = np.eye(SYSTEM_SIZE) + 1 / (1 + np.arange(SYSTEM_SIZE**2).reshape(SYSTEM_SIZE, -1))
    right = np.ones(SYSTEM_SIZE)
    total = 0.0
    for _ in range(SYSTEMS):
        total += float(np.linalg.solve(matrix, right).sum())
    for number in range(ADDITIONS):
        total += number
    return total


def measure_processor_time(call: Callable[[], object]) -> float:
    """Processor time that this process spends in a call [s]."""
    start = time.process_time()
    call()
    return time.process_time() - start


def measure_child_process_time(*arguments: str) -> float:
    """Processor time of a Python process with these arguments [s]."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([sys.executable, *arguments], stdout=subprocess.DEVNULL, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def median_time_ratio(
    timed: Callable[[], float], compared: Callable[[], float], repeats: int = USUAL_REPEATS
) -> float:
    """Median of `timed` over `compared`, two functions that measure a time [s].

    Both are measured one after the other in each repeat. A slower phase of the machine then
    changes both.
    """
    ratios = []
    for _ in range(repeats):
        reference = compared()
        ratios.append(timed() / reference)
    return median(ratios)


def solve_time_ratios(repeats: int = USUAL_REPEATS) -> dict[str, float]:
    """Times of solves and of questions about a solved brake, over the time of the workload."""
    calls: dict[str, Callable[[], object]] = {}
    for name in TIMED_SOLVES:
        calls[f"solve {name}"] = partial(drumlin.solve, drumlin.read_brake(examples()[name]))
    first = drumlin.read_brake(examples()[TIMED_SOLVES[0]])
    # Further questions about the first brake.
    calls |= {
        "sine law": partial(drumlin.solve, first, "sine"),
        "sensitivity": partial(drumlin.sensitivity, first),
        "hold": partial(drumlin.hold, first),
    }
    compared = partial(measure_processor_time, run_reference_workload)
    ratios = {}
    for name, call in calls.items():
        # The first call loads modules and is not timed.
        call()
        ratios[name] = median_time_ratio(partial(measure_processor_time, call), compared, repeats)
    return ratios


def count_unknowns(brake: Brake) -> int:
    """Degrees of freedom of the shoes in the prepared model that a default solve ends on."""
    counted: dict[int, int] = {}
    # Equal shoes share one body, which is condensed once and counted once.
    for body in prepare_finest_division(brake).bodies:
        counted[id(body)] = body.unknowns
    return sum(counted.values())


def count_unknowns_and_iterations() -> dict[str, float]:
    """Unknowns and active-set iterations of default solves. They do not depend on the machine."""
    found: dict[str, float] = {}
    for name in COUNTED:
        brake = drumlin.read_brake(examples()[name])
        found[f"unknowns {name}"] = count_unknowns(brake)
        found[f"iterations {name}"] = drumlin.solve(brake).iterations
    return found


def start_time_ratios(repeats: int = USUAL_REPEATS) -> dict[str, float]:
    """Times of whole commands, over the time that a process needs for the imports alone."""
    brake = str(examples()[TIMED_SOLVES[0]])
    compared = partial(measure_child_process_time, "-c", IMPORTS)
    commands = {
        "command init": partial(measure_child_process_time, "-c", COMMAND, "init"),
        "command solve": partial(measure_child_process_time, "-c", COMMAND, "solve", brake),
        "import drumlin": partial(measure_child_process_time, "-c", "import drumlin"),
    }
    return {name: median_time_ratio(timed, compared, repeats) for name, timed in commands.items()}


def git_output(*arguments: str) -> str:
    """The output of a git command on the repository of this checkout, without spaces around it."""
    command = ["git", "-C", str(REPOSITORY), *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()


def commit_name() -> str:
    """Short name of the commit that is checked out, with a + if a source file differs from it."""
    # The list is empty where every source file is as committed.
    changed = git_output("status", "--porcelain", "--", "src")
    return git_output("rev-parse", "--short=7", "HEAD") + ("+" if changed else "")


def measure_figures(repeats: int = USUAL_REPEATS) -> Benchmark:
    """Measure all figures on the commit that is checked out.

    Raises subprocess.CalledProcessError outside of a git repository.
    """
    figures = {
        **solve_time_ratios(repeats),
        **count_unknowns_and_iterations(),
        **start_time_ratios(repeats),
    }
    # Digits beyond the fourth are noise of the timing.
    rounded = {name: float(f"{value:.4g}") for name, value in figures.items()}
    return Benchmark(commit_name(), f"{datetime.now(UTC):%Y-%m-%d}", rounded)


def append_to_history(path: Path, benchmark: Benchmark) -> None:
    """Add a line to a history, which is created where it does not exist."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("a", encoding="utf-8") as file:
        file.write(json.dumps(benchmark._asdict()) + "\n")


def read_history(path: Path = HISTORY) -> list[Benchmark]:
    """The measurements of a history, the oldest first."""
    lines = path.read_text(encoding="utf-8").splitlines()
    return [Benchmark(**json.loads(line)) for line in lines]


def main(path: str = str(HISTORY), repeats: str = str(USUAL_REPEATS)) -> None:
    """Measure, append a line to the history at `path`, and print the line."""
    benchmark = measure_figures(int(repeats))
    append_to_history(Path(path), benchmark)
    sys.stdout.write(json.dumps(benchmark._asdict()) + "\n")


if __name__ == "__main__":
    main(*sys.argv[1:])
