"""Benchmarks of drumlin's speed and model sizes, stored by commit in a file of JSON lines.

`make benchmarks` measures the figures and adds a line to PATH_OF_BENCHMARK_HISTORY. Every time is
divided by the time of a fixed calculation or of fixed imports in the same run. This ratio hardly
depends on the machine, so that lines from different machines can be compared.
"""

import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Mapping
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from statistics import median
from typing import NamedTuple

import numpy as np

import drumlin
from drumlin.base.resource_use import processor_time_of_ended_child_processes
from drumlin.brake.brake import Brake
from drumlin.brake.file import make_drum_brake_from_data
from drumlin.fem.solve import prepared_model_with_finest_elements
from drumlin.studies import (
    FOLDER_OF_INSTALLED_OR_SOURCE_STUDIES_AND_MESHES,
    paths_of_example_brakes,
    paths_of_example_sweeps,
)
from drumlin.sweeps.file import read_sweep_from_toml_file
from drumlin.sweeps.sample import (
    CERTIFY_VALUE_FOR_OWN_ERRORS_OF_EACH_CASE,
    positions_of_sample_cases,
    solve_sample_cases_and_then_all_others,
)

PATH_OF_BENCHMARK_HISTORY = (
    FOLDER_OF_INSTALLED_OR_SOURCE_STUDIES_AND_MESHES
    / "reports"
    / "reference"
    / "benchmarks"
    / "history.jsonl"
)
"""Path of the file with the history of benchmarks: one line for each measurement, oldest first."""

EXAMPLES_WITH_TIMED_DEFAULT_SOLVE = (
    "double_shoe",
    "double_shoe_flexible",
    "post_brake",
    "uni_servo",
    "band",
    "rail_clamp",
)
"""Example brakes whose default solve is timed.

They cover stiff and flexible shoes, an elastic ring, shoes with a strut between them, a band of
blocks, and shoes on a plane.
"""

EXAMPLES_WITH_COUNTED_UNKNOWNS_AND_ITERATIONS = ("double_shoe", "post_brake")
"""Example brakes whose unknowns and iterations are counted: one with a rigid drum, and one with an
elastic drum ring.
"""

DEFAULT_TIMINGS_OF_EACH_CALCULATION = 9
"""Number of times that each calculation is timed by default.

The median of nine measurements varies by some 2 % on a busy machine.
"""

EQUATIONS_PER_SYSTEM_OF_FIXED_CALCULATION = 60
"""Number of equations of each linear system in the fixed calculation.

A shoe has about as many contact nodes."""

LINEAR_SYSTEMS_IN_FIXED_CALCULATION = 80
"""Number of linear systems in the fixed calculation. The whole calculation takes some 5 ms."""

NUMBER_OF_ADDITIONS_IN_FIXED_CALCULATION = 100_000
"""Number of additions in the fixed calculation.

They stand for the work of the Python interpreter, which takes a large part of a solve's time.
"""

PROGRAM_THAT_IMPORTS_REQUIRED_PACKAGES = "import numpy, scipy.linalg, pydantic"
"""Program that only imports the other packages that every command of drumlin needs.

The times of drumlin's commands are divided by the time of this program.
"""

PROGRAM_THAT_RUNS_COMMAND_LINE_OF_DRUMLIN = "from drumlin.cli import main; main()"
"""Program that runs drumlin's command line, whether or not the command is installed."""


BRAKE_OF_DEFAULT_SOLVE_AS_UNIT = "double_shoe"
"""Example brake whose default solve is the unit of `times_over_default_solve_of_main_brake`."""

CASES_OF_TIMED_SWEEP = 120
"""Number of cases of the sweep of tolerances that are timed with and without a sample."""

CASES_DRAWN_FOR_SAMPLE_OF_TIMED_SWEEP = 4
"""Number of cases drawn for the sample, besides the cases with extreme values.

The sample then has a ninth of the cases, as the sample "every 10th" of the whole sweep has.
"""

TIMINGS_OF_LONG_CALCULATION = 5
"""Largest number of times that a calculation of many default solves is timed."""


class BenchmarkFiguresOfCommit(NamedTuple):
    """A measurement: the commit, its date (YYYY-MM-DD), and the measured figures by name."""

    commit: str
    date: str
    figures: Mapping[str, float]


def run_fixed_calculation() -> float:
    """Do the fixed calculation by whose time drumlin's times are divided.

    The calculation solves linear systems and adds numbers. The returned number depends on every
    step, so that no step can be optimised away. If this function changes, earlier lines of the
    history cannot be compared with later ones.
    """
    matrix = np.eye(EQUATIONS_PER_SYSTEM_OF_FIXED_CALCULATION) + 1 / (
        1
        + np.arange(EQUATIONS_PER_SYSTEM_OF_FIXED_CALCULATION**2).reshape(
            EQUATIONS_PER_SYSTEM_OF_FIXED_CALCULATION, -1
        )
    )
    right = np.ones(EQUATIONS_PER_SYSTEM_OF_FIXED_CALCULATION)
    total = 0.0
    for _ in range(LINEAR_SYSTEMS_IN_FIXED_CALCULATION):
        total += float(np.linalg.solve(matrix, right).sum())
    for number in range(NUMBER_OF_ADDITIONS_IN_FIXED_CALCULATION):
        total += number
    return total


def measure_processor_time(call: Callable[[], object]) -> float:
    """Processor time [s] that this process spends in `call`."""
    start = time.process_time()
    call()
    return time.process_time() - start


def measure_python_process_time(*arguments: str) -> float:
    """Run Python with these arguments in a new process; returns its processor time [s]."""
    before = processor_time_of_ended_child_processes()
    subprocess.run([sys.executable, *arguments], stdout=subprocess.DEVNULL, check=True)
    return processor_time_of_ended_child_processes() - before


def median_ratio_of_times_returned_by_two_functions(
    timed: Callable[[], float],
    compared: Callable[[], float],
    repeats: int = DEFAULT_TIMINGS_OF_EACH_CALCULATION,
) -> float:
    """Median of the ratio of two times: the time of `timed` divided by the time of `compared`.

    Both arguments are functions that measure and return a time [s]. They are called one after the
    other in each repeat, so that a slow phase of the machine changes both times.
    """
    ratios = []
    for _ in range(repeats):
        reference = compared()
        ratios.append(timed() / reference)
    return median(ratios)


def solve_times_over_fixed_calculation(
    repeats: int = DEFAULT_TIMINGS_OF_EACH_CALCULATION,
) -> dict[str, float]:
    """Times of drumlin's functions by name, each divided by the time of the fixed calculation.

    The default solve is timed on all EXAMPLES_WITH_TIMED_DEFAULT_SOLVE. The sine law, `sensitivity`
    and `hold` are timed on the first of these brakes.
    """
    calls: dict[str, Callable[[], object]] = {}
    for name in EXAMPLES_WITH_TIMED_DEFAULT_SOLVE:
        calls[f"solve {name}"] = partial(
            drumlin.solve, drumlin.read_brake(paths_of_example_brakes()[name])
        )
    first = drumlin.read_brake(paths_of_example_brakes()[EXAMPLES_WITH_TIMED_DEFAULT_SOLVE[0]])
    # The sine law, `sensitivity` and `hold` are timed on the first brake.
    calls |= {
        "sine law": partial(drumlin.solve, first, "sine"),
        "sensitivity": partial(drumlin.sensitivity, first),
        "hold": partial(drumlin.hold, first),
    }
    compared = partial(measure_processor_time, run_fixed_calculation)
    ratios = {}
    for name, call in calls.items():
        # The first call loads modules and is not timed.
        call()
        ratios[name] = median_ratio_of_times_returned_by_two_functions(
            partial(measure_processor_time, call), compared, repeats
        )
    return ratios


def _ring_with_shoes(count: int) -> Brake:
    """A brake of `count` equal hinged shoes at equal angles inside an elastic drum ring."""
    step = 360.0 / count
    lining = {"E": "300 MPa", "nu": 0.25}
    shoe = {
        "name": "shoe",
        "side": "internal",
        "hinge": {"radius": "125 mm", "angle": "0 deg"},
        "actuation": {
            "force": "2 kN",
            "direction": f"{0.7 * step} deg",
            "point": {"radius": "120 mm", "angle": f"{0.7 * step} deg"},
        },
        "lining": {
            "start": f"{0.15 * step} deg",
            "end": f"{0.65 * step} deg",
            "thickness": "8 mm",
            "width": "40 mm",
            "material": lining,
        },
        "pattern": {"count": count, "step": f"{step} deg"},
    }
    ring = {"thickness": "15 mm", "width": "40 mm", "material": {"E": "110 GPa", "nu": 0.25}}
    return make_drum_brake_from_data(
        {
            "title": f"ring with {count} shoes",
            "rotation": "counter-clockwise",
            "friction": 0.3,
            "drum": {"radius": "150 mm", "ring": ring | {"support": "free"}},
            "shoe": [shoe],
        }
    )


def _brake_with_contact_at_lining_end_alone() -> Brake:
    """The main brake with a shoe whose contact at the lining's end is 4 nm long."""
    table = [["-70 deg", "1 mm"], ["54.8 deg", "10 mm"], ["55 deg", "0 mm"]]
    return drumlin.vary(
        drumlin.example(BRAKE_OF_DEFAULT_SOLVE_AS_UNIT),
        {"shoe[0].lining.clearance": table, "shoe[0].actuation.force": "0.2 N"},
    )


def _solve_cases_of_tolerance_sweep(certify: str | int) -> None:
    """Solve the first CASES_OF_TIMED_SWEEP cases of the sweep of tolerances in this process.

    `certify` is the value of the key with this name in a sweep file.
    """
    sweep = read_sweep_from_toml_file(paths_of_example_sweeps()["sweep_tolerances"])
    cases = sweep.cases[:CASES_OF_TIMED_SWEEP]
    sample = positions_of_sample_cases(cases, certify, seed=1)
    solve_sample_cases_and_then_all_others(cases, sample)


def times_over_default_solve_of_main_brake(
    repeats: int = TIMINGS_OF_LONG_CALCULATION,
) -> dict[str, float]:
    """Times of tasks for which a user waits, by name, in default solves of the main brake.

    The main brake is BRAKE_OF_DEFAULT_SOLVE_AS_UNIT. All times are processor times in this process,
    after a first call that loads modules. Solves do not state the error of plane stress. The times
    of sweeps are those of a case.
    """
    solve = partial(drumlin.solve, model_error=False)
    post, tee = drumlin.example("post_brake"), drumlin.example("plane_stress")
    main = drumlin.example(BRAKE_OF_DEFAULT_SOLVE_AS_UNIT)
    calls: dict[str, Callable[[], object]] = {
        "post on a ring": partial(solve, post),
        "post on a ring to 0.01 %": partial(solve, post, tolerance=1e-4),
        "ring with 8 shoes": partial(solve, _ring_with_shoes(8)),
        "ring with 12 shoes": partial(solve, _ring_with_shoes(12)),
        "contact of 4 nm": partial(solve, _brake_with_contact_at_lining_end_alone()),
        "solid T-section": partial(drumlin.solve, tee, "solid"),
        "wear": partial(drumlin.wear, main),
        "sweep in full": partial(
            _solve_cases_of_tolerance_sweep, CERTIFY_VALUE_FOR_OWN_ERRORS_OF_EACH_CASE
        ),
        "sweep by sample": partial(
            _solve_cases_of_tolerance_sweep, CASES_DRAWN_FOR_SAMPLE_OF_TIMED_SWEEP
        ),
    }
    compared = partial(measure_processor_time, partial(solve, main))
    ratios = {}
    for name, call in calls.items():
        call()
        compared()
        ratio = median_ratio_of_times_returned_by_two_functions(
            partial(measure_processor_time, call),
            compared,
            min(repeats, TIMINGS_OF_LONG_CALCULATION),
        )
        cases = CASES_OF_TIMED_SWEEP if name.startswith("sweep") else 1
        ratios[f"default solves: {name}"] = ratio / cases
    return ratios


def count_unknowns_of_default_solve(brake: Brake) -> int:
    """Number of degrees of freedom of the shoes on the finest mesh of a brake's default solve."""
    counted: dict[int, int] = {}
    # Shoes of equal shape share one model, which counts once.
    for body in prepared_model_with_finest_elements(brake).bodies:
        counted[id(body)] = body.unknowns
    return sum(counted.values())


def counts_of_unknowns_and_iterations_of_default_solves() -> dict[str, float]:
    """Counts of unknowns and of active-set iterations of default solves, by the name of the figure.

    These numbers do not depend on the machine.
    """
    found: dict[str, float] = {}
    for name in EXAMPLES_WITH_COUNTED_UNKNOWNS_AND_ITERATIONS:
        brake = drumlin.read_brake(paths_of_example_brakes()[name])
        found[f"unknowns {name}"] = count_unknowns_of_default_solve(brake)
        found[f"iterations {name}"] = drumlin.solve(brake).iterations
    return found


def command_times_over_import_time(
    repeats: int = DEFAULT_TIMINGS_OF_EACH_CALCULATION,
) -> dict[str, float]:
    """Times of drumlin's commands and of `import drumlin`, by name.

    Each time is divided by the time of a process that only imports numpy, scipy.linalg and
    pydantic.
    """
    brake = str(paths_of_example_brakes()[EXAMPLES_WITH_TIMED_DEFAULT_SOLVE[0]])
    compared = partial(measure_python_process_time, "-c", PROGRAM_THAT_IMPORTS_REQUIRED_PACKAGES)
    run = partial(measure_python_process_time, "-c", PROGRAM_THAT_RUNS_COMMAND_LINE_OF_DRUMLIN)
    with tempfile.TemporaryDirectory() as folder:
        commands = {
            "command init": partial(run, "init"),
            "command solve": partial(run, "solve", brake),
            "command wear": partial(run, "wear", brake),
            "command compare": partial(run, "compare", brake, "--output", folder),
            "import drumlin": partial(measure_python_process_time, "-c", "import drumlin"),
        }
        found = {}
        for name, timed in commands.items():
            found[name] = median_ratio_of_times_returned_by_two_functions(timed, compared, repeats)
    return found


def output_of_git_command(*arguments: str) -> str:
    """The output of a git command on drumlin's repository, without surrounding spaces."""
    command = ["git", "-C", str(FOLDER_OF_INSTALLED_OR_SOURCE_STUDIES_AND_MESHES), *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()


def short_commit_hash() -> str:
    """Short hash of the checked-out commit, with a "+" if a source file has been changed."""
    # git lists the changed files; without changes the list is empty.
    changed = output_of_git_command("status", "--porcelain", "--", "src")
    return output_of_git_command("rev-parse", "--short=7", "HEAD") + ("+" if changed else "")


def measure_all_benchmarks(
    repeats: int = DEFAULT_TIMINGS_OF_EACH_CALCULATION,
) -> BenchmarkFiguresOfCommit:
    """Measure all figures of drumlin at the checked-out commit.

    Raises subprocess.CalledProcessError outside of a git repository.
    """
    figures = {
        **solve_times_over_fixed_calculation(repeats),
        **times_over_default_solve_of_main_brake(repeats),
        **counts_of_unknowns_and_iterations_of_default_solves(),
        **command_times_over_import_time(repeats),
    }
    # Times are rounded to four digits, because further digits would be random.
    rounded = {name: float(f"{value:.4g}") for name, value in figures.items()}
    return BenchmarkFiguresOfCommit(short_commit_hash(), f"{datetime.now(UTC):%Y-%m-%d}", rounded)


def append_benchmark_to_history(path: Path, benchmark: BenchmarkFiguresOfCommit) -> None:
    """Append a measurement as a line to the history file `path`, which is created if missing."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("a", encoding="utf-8") as file:
        file.write(json.dumps(benchmark._asdict()) + "\n")


def read_benchmark_history(
    path: Path = PATH_OF_BENCHMARK_HISTORY,
) -> list[BenchmarkFiguresOfCommit]:
    """The measurements in a history file, from the oldest to the newest."""
    lines = path.read_text(encoding="utf-8").splitlines()
    return [BenchmarkFiguresOfCommit(**json.loads(line)) for line in lines]


def main(
    path: str = str(PATH_OF_BENCHMARK_HISTORY),
    repeats: str = str(DEFAULT_TIMINGS_OF_EACH_CALCULATION),
) -> None:
    """Measure all figures, append them to the history file `path`, and print the new line."""
    benchmark = measure_all_benchmarks(int(repeats))
    append_benchmark_to_history(Path(path), benchmark)
    sys.stdout.write(json.dumps(benchmark._asdict()) + "\n")


if __name__ == "__main__":
    main(*sys.argv[1:])
