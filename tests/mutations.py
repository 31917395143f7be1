"""Changes each number of drumlin that was found by trial, and runs the tests that should fail.

    make noticed [ARGS="MODULE or CONSTANT ..."], or python tests/mutations.py [MODULE or CONSTANT
    ...]

If no test fails after the change, the number is useless or its tests are too weak. For each number
of TUNED, once for a larger and once for a smaller value, this module copies src/, changes the
number in the copy, and runs the named tests there until one fails. The tests judge answers, error
messages, balances and counts of steps that a user would see, and never the number itself.

The function `moved` changes a number x as follows:
- a whole number below 50 goes one up or one down;
- a number between 0 and 1, a ratio or a power, is doubled, but goes at most half of its way to one,
  or is halved;
- any other number is doubled or halved.
If a constant is a single number, its value is changed, even if an expression computes it. The
numbers of a table are changed one by one.

A number is guarded if a test fails when the number is changed to its unsafe side, on which answers
become wrong. The command prints a line for each change: module, constant, side, new value, and the
test that failed. Its exit status is 1 if no test fails for an unsafe side, or if a test fails
without a change.
"""

import ast
import importlib
import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "src" / "drumlin"
PATIENCE = 300
"""Seconds after which a run of tests counts as red. The slowest named tests take one minute on two
idle cores, so that a change which makes them five times slower is one that a user would see."""


class Guard(NamedTuple):
    """The `tests` that notice a constant, and its `unsafe` side: up, down, both, or either of them.

    For `either` it is enough that a test fails for one of the sides. `slow` tells that the tests
    have the mark `slow`.
    """

    unsafe: str = "either"
    tests: tuple[str, ...] = ("tests/test_stored_truths.py",)
    slow: bool = False

    def unsafe_at(self, side: str) -> bool:
        """Whether a change to this side asks to be noticed, by itself or in place of the other."""
        return self.unsafe in {side, "both", "either"}


TRUTHS = "tests/test_stored_truths.py"
CORNER = "tests/test_corner.py"
POWER_OF_CORNER = f"{CORNER}::test_the_power_of_a_corner_makes_p_many_times_more_exact"
ON_COLUMNS = "tests/test_hp.py"
STATED = "tests/test_stated_true.py"
BREAKS = "tests/test_width_breaks.py"
MOVING_ENDS = (
    "tests/test_width_ladder.py"
    "::test_the_first_level_resolves_contact_ends_that_move_across_the_width"
)
FITTED_WIDTHS = "tests/test_width_calibration.py::test_the_errors_that_were_observed_are_stated"

TUNED: dict[str, dict[str, Guard]] = {
    "fem/error_control/levels.py": {
        "RULE_OF_DEGREE_AND_GRADING": Guard("both", (TRUTHS,)),
        "ALLOWED_END_MOTION_ON_FIRST_LEVEL": Guard(
            "either",
            ("tests/test_hp.py::test_the_first_level_only_finds_where_the_contact_of_a_post_ends",),
        ),
    },
    "fem/width/functions.py": {
        # With a smaller first distance these errors are smaller, others are larger.
        "WIDTH_BREAKPOINT_DISTANCES_BESIDE_WEB": Guard("up", (BREAKS,), slow=True),
        "LEAST_LENGTH_FROM_WIDTH_BREAKPOINT_TO_SIDE": Guard("both", (BREAKS,), slow=True),
        "WIDTH_BREAKPOINT_DISTANCE_IN_SHORT_OVERHANG": Guard("both", (BREAKS,), slow=True),
        # With a smaller length there are more unknowns.
        "LARGEST_OVERHANG_WITHOUT_WIDTH_BREAKPOINT": Guard("up", (BREAKS,), slow=True),
    },
    "fem/width/factors.json": {
        "two_levels_pressure": Guard("down", (FITTED_WIDTHS,)),
        "two_levels_force": Guard("down", (FITTED_WIDTHS,)),
        "section_pressure": Guard("down", (FITTED_WIDTHS,)),
        "section_force": Guard("down", (FITTED_WIDTHS,)),
        "pressure": Guard("down", (FITTED_WIDTHS,)),
        "force": Guard("down", (FITTED_WIDTHS,)),
        "pieces_pressure": Guard("down", (FITTED_WIDTHS,)),
        "pieces_force": Guard("down", (FITTED_WIDTHS,)),
    },
    "fem/error_control/adapt.py": {
        "LARGEST_PRESSURE_AT_LINING_END_OVER_PEAK": Guard(
            "up",
            (f"{STATED}::test_a_peak_that_finer_columns_may_find_at_an_end_is_unknown_before",),
        ),
    },
    "fem/error_control/degrees.py": dict.fromkeys(
        ("SAFETY_FACTORS_OF_MESH_FILES", "FACTORS_FROM_SHAPE_CHANGE_TO_MESH_SHAPE_ERROR"),
        Guard(
            "down",
            (
                "tests/test_mesh_degrees.py::test_stated_errors_of_meshes_by_gmsh_are_above_the_true_ones",
            ),
            slow=True,
        ),
    )
    | {
        "ERROR_PER_ROUNDING_OVER_LINING_THICKNESS": Guard(
            "down",
            (
                "tests/test_mesh_degrees.py::test_rounded_coordinates_change_a_response_by_less_than_stated",
            ),
            slow=True,
        ),
    },
    "fem/error_control/estimate.py": {
        "SAFETY_FACTOR_OF_PENALTY_ERROR": Guard(
            "down", (f"{STATED}::test_what_a_soft_contact_changes_of_a_post_is_stated_too",)
        ),
    },
    "fem/error_control/first_level.py": {
        "SAFETY_FACTOR_OF_LARGEST_ERROR_IN_SAMPLE": Guard(
            "down",
            (
                "tests/test_sweep_sample.py"
                "::test_no_case_is_further_from_its_own_last_level_than_its_sample_says",
            ),
            slow=True,
        ),
    },
    "fem/error_control/factors.json": dict.fromkeys(
        ("pressure", "force", "peak"), Guard("down", (TRUTHS,))
    )
    | {
        "cancelled": Guard(
            "down",
            (f"{STATED}::test_a_reaction_that_two_levels_share_by_accident_is_not_stated_as_sure",),
            slow=True,
        )
    },
    "fem/hp/division.py": {
        "UNRESOLVED_LENGTH_OVER_CONTACT_LENGTH": Guard(
            "up",
            (
                "tests/test_hp.py"
                "::test_a_level_that_is_solved_alone_finds_the_ends_of_a_short_contact_for_its_pressure",
            ),
        ),
        "COLUMNS_PER_DEGREE_OVER_MOVING_CONTACT_END": Guard("down", (MOVING_ENDS,), slow=True),
        "BEAM_ERROR_OVER_BLOCK_ERROR": Guard(
            "up",
            ("tests/test_hp.py::test_thick_layers_of_a_beam_change_p_and_torque_less_than_errors",),
        ),
        "ELEMENT_SIZE_AT_UNBOUNDED_CORNER": Guard("both", (POWER_OF_CORNER,)),
    },
    "fem/hp/ring.py": {
        "RING_ERROR_OVER_LINING_ERROR": Guard(
            "up",
            ("tests/test_ring.py::test_the_wide_columns_of_a_ring_change_p_less_than_its_error",),
        )
    },
    "fem/hp/corner.py": {
        "POWER_LAW_FRACTION_OF_CONTACT": Guard("down", (POWER_OF_CORNER,)),
        "RATIO_OF_NEIGHBOURING_PRESSURE_PIECES": Guard(
            "down",
            (f"{CORNER}::test_p_between_the_nodes_near_a_corner_is_its_power_to_a_ten_thousandth",),
        ),
    },
    "fem/error_control/short_contact.py": dict.fromkeys(
        ("GAP_RISE_AT_CONTACT_END_INSIDE_LINING", "GAP_RISE_AT_CONTACT_END_FROM_CORNER"),
        Guard(
            "both",
            (
                "tests/test_short_contact.py"
                "::test_the_formula_gives_the_length_that_elements_resolve",
            ),
        ),
    ),
    "fem/error_control/singular_points.py": {
        "NEGLIGIBLE_PRESSURE_ERROR_DUE_TO_GAP_KINKS": Guard(
            "down", (f"{ON_COLUMNS}::test_a_table_of_many_clearances_is_a_curve",)
        ),
        # With a shorter path more brakes get columns that they do not need.
        "SHORTEST_PATH_OF_CONTACT_END": Guard("up", (MOVING_ENDS,), slow=True),
    },
    "fem/preparation/load_places.py": {
        "FORCE_SPREAD_RELATIVE_TO_BODY_THICKNESS": Guard(
            "either",
            (
                "tests/test_further_loads.py::test_elastic_shoes_stretch_their_spring_by_their_motion",
            ),
            slow=True,
        ),
    },
    "fem/preparation/meshes.py": {
        "DEFAULT_ELEMENTS_ALONG_LINING": Guard(
            "down", ("tests/test_mesh.py::test_a_mesh_is_as_exact_as_is_said",)
        ),
    },
    "fem/analysis/holding.py": {
        "MAX_HALVINGS_OF_ROTATION_INCREMENT": Guard(
            "down", ("tests/test_holding.py::test_an_increment_that_does_not_settle_is_halved",)
        ),
        "MARGIN_OF_FULL_SLIP_ROTATION": Guard(
            "down", ("tests/test_holding.py::test_at_the_rotation_of_full_slip_no_path_sticks",)
        ),
    },
    "fem/mesh/grading.py": {
        "RELATIVE_SIZE_OF_LINING_END_ELEMENT": Guard(
            "up", ("tests/test_mesh.py::test_a_mesh_is_as_exact_as_is_said",)
        ),
    },
}
"""Constants that were found by trying, by their module in src/drumlin. The objects of a .json file,
each with its `value`, count as constants of that file."""


class Change(NamedTuple):
    """A changed constant: its `name`, the `side`, the new numbers in words, and the new source."""

    name: str
    side: str
    now: str
    source: str


def moved(number: float, side: str) -> float:
    """The changed number, larger or smaller, by the rule in the module's docstring."""
    if isinstance(number, int) and abs(number) < 50:
        return number + 1 if side == "up" else number - 1
    if side == "down":
        return number // 2 if isinstance(number, int) else number / 2
    if 0 < number < 1:
        return min(2 * number, (1 + number) / 2)
    return 2 * number


def changes(module: str, name: str) -> Iterator[Change]:
    """All changes of a constant of a module of src/drumlin, both sides of each of its numbers.

    Raises LookupError for a constant whose assignment does not start a line.
    """
    text = (PACKAGE / module).read_text(encoding="utf-8")
    if module.endswith(".json"):
        yield from in_table(text, name)
    else:
        yield from in_source(text, name, getattr(imported(module), name, None))


def in_source(text: str, name: str, value: object = None) -> Iterator[Change]:
    """All changes of a constant in a source text. `value` is the constant's value, if known."""
    expression = _expression(ast.parse(text), name)
    if isinstance(value, int | float):
        groups: list[list[tuple[ast.expr, float]]] = [[(expression, value)]]
    else:
        groups = [[number] for number in _numbers(expression)]
    for place, group in enumerate(groups):
        label = name if len(groups) == 1 else f"{name}[{place}]"
        for side in ("up", "down"):
            new = [(node, repr(moved(number, side))) for node, number in group]
            yield Change(label, side, ", ".join(now for _, now in new), _replaced(text, new))


def in_table(text: str, name: str) -> Iterator[Change]:
    """The changes of the `value` of an object of a .json file."""
    for side in ("up", "down"):
        data = json.loads(text)
        data[name]["value"] = moved(data[name]["value"], side)
        yield Change(name, side, repr(data[name]["value"]), json.dumps(data, indent=1))


def imported(module: str) -> object:
    """The imported module of a file in src/drumlin."""
    path = module.removesuffix(".py").removesuffix("/__init__").replace("/", ".")
    return importlib.import_module(f"drumlin.{path}")


def constants(module: str) -> list[str]:
    """The module-level constants of a file in src/drumlin in whose expression or value is a number."""
    found = []
    for node in ast.parse((PACKAGE / module).read_text(encoding="utf-8")).body:
        if not isinstance(node, ast.Assign | ast.AnnAssign) or node.value is None:
            continue
        targets = node.targets if isinstance(node, ast.Assign) else [node.target]
        names = [
            each.id for target in targets for each in ast.walk(target) if isinstance(each, ast.Name)
        ]
        for name in names:
            if name.isupper() and (
                _numbers(node.value) or type(getattr(imported(module), name)) in {int, float}
            ):
                found.append(name)
    return found


def _numbers(node: ast.AST) -> list[tuple[ast.expr, float]]:
    """The numbers written in an expression, in their order."""
    found: list[tuple[ast.expr, float]] = []
    for each in ast.walk(node):
        if isinstance(each, ast.Constant) and type(each.value) in {int, float}:
            found.append((each, each.value))
    return sorted(found, key=lambda pair: (pair[0].lineno, pair[0].col_offset))


def _expression(tree: ast.Module, name: str) -> ast.expr:
    for node in tree.body:
        if (
            isinstance(node, ast.Assign)
            and isinstance(node.targets[0], ast.Name)
            and node.targets[0].id == name
        ):
            return node.value
    raise LookupError(f"no module constant {name} on a line of its own")


def _line_starts(source: str) -> list[int]:
    """Where lines start, in bytes: ast counts columns in bytes of UTF-8."""
    starts = [0]
    for line in source.encode().splitlines(keepends=True):
        starts.append(starts[-1] + len(line))
    return starts


def _replaced(source: str, new: list[tuple[ast.expr, str]]) -> str:
    """The source with some expressions replaced by other texts."""
    text, starts = source.encode(), _line_starts(source)
    for node, now in sorted(
        new, key=lambda pair: (pair[0].lineno, pair[0].col_offset), reverse=True
    ):
        assert node.end_lineno is not None
        assert node.end_col_offset is not None
        first = starts[node.lineno - 1] + node.col_offset
        last = starts[node.end_lineno - 1] + node.end_col_offset
        text = text[:first] + now.encode() + text[last:]
    return text.decode()


def red(guard: Guard, module: str = "", source: str = "") -> str:
    """The first test of a guard that fails with another source of a module, or with none; else an
    empty text.
    """
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / "src"
        shutil.copytree(ROOT / "src", copy)
        if module:
            (copy / "drumlin" / module).write_text(source, encoding="utf-8")
        options = ["-x", "-q", "--no-header", "-p", "no:cacheprovider"]
        # The stored truths of all brakes are judged by slow tests.
        options += ["--no-skips"] if guard.slow or TRUTHS in guard.tests else []
        command = [sys.executable, "-m", "pytest", *options, *guard.tests]
        environment = os.environ | {
            "PYTHONPATH": str(copy),
            "OMP_NUM_THREADS": "1",
            "OPENBLAS_NUM_THREADS": "1",
        }
        try:
            run = subprocess.run(
                command,
                cwd=ROOT,
                env=environment,
                capture_output=True,
                text=True,
                timeout=PATIENCE,
                check=False,
            )
        except subprocess.TimeoutExpired:
            return f"took more than {PATIENCE} s"
    if run.returncode == 0:
        return ""
    failed = [line for line in run.stdout.splitlines() if line.startswith(("FAILED", "ERROR"))]
    return failed[0].split(" - ")[0] if failed else f"pytest ended with status {run.returncode}"


@cache
def red_unchanged(guard: Guard) -> str:
    """The first test of a guard that fails with no change; else an empty text."""
    return red(guard._replace(unsafe="either"))


def unguarded(guard: Guard, noticed: dict[tuple[str, str], str]) -> list[str]:
    """The unsafe sides of constants for which no test failed.

    `noticed` holds the test that failed for each pair of constant and side, or an empty text.
    """
    found = []
    for name in dict.fromkeys(name for name, _ in noticed):
        green = [side for side in ("up", "down") if not noticed.get((name, side), "not tried")]
        if guard.unsafe == "either":
            found += [f"{name}: neither side is noticed"] if len(green) == 2 else []
        else:
            found += [
                f"{name}: {side} is not noticed" for side in green if guard.unsafe in {side, "both"}
            ]
    return found


def tried(module: str, name: str, *, safe: bool = True) -> Iterator[tuple[Change, str]]:
    """The changes of a constant of TUNED, and the test that failed for each.

    `safe` tells whether the safe side is tried as well.
    """
    guard = TUNED[module][name]
    for change in changes(module, name):
        if safe or guard.unsafe_at(change.side):
            yield change, red(guard, module, change.source)


def main(*wanted: str) -> int:
    """Try the changes of some modules or constants of TUNED, by default of all.

    Returns 1 if a constant is not guarded.
    """
    open_ = []
    for module, guards in TUNED.items():
        for name, guard in guards.items():
            if wanted and module not in wanted and name not in wanted:
                continue
            broken = red_unchanged(guard)
            if broken:
                open_.append(f"{module} {name}: red without a change: {broken}")
                continue
            noticed = {}
            for change, by in tried(module, name):
                noticed[change.name, change.side] = by
                unsafe = "unsafe" if guard.unsafe_at(change.side) else "safe"
                said = (
                    f"{module}  {change.name}  {change.side} ({unsafe}): {change.now}  "
                    f"{by or 'NOT NOTICED'}"
                )
                sys.stdout.write(f"{said}\n")
                sys.stdout.flush()
            open_ += [f"{module} {line}" for line in unguarded(guard, noticed)]
    sys.stdout.write("\n".join(["Not guarded:", *open_] if open_ else ["All are guarded."]) + "\n")
    return int(bool(open_))


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
