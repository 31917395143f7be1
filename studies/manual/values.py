"""Values that pages of the manual quote, read off the code and the kept reports.

A page writes `{{ penalty }}`, and the build puts the value there. A page with an unknown name is
not built. A value that no page quotes fails a test.
"""

import csv
import math
import re
from collections.abc import Mapping
from functools import cache

from studies.manual import history
from studies.manual.solve_path import solve_path_picture

import drumlin
from drumlin.base.errors import NoAnswer
from drumlin.brake.fields import NUMBER_OF_ROWS_OF_TABULATED_CLEARANCE
from drumlin.brake.friction import PRESSURES_OF_TABULATED_FRICTION
from drumlin.contact.equations import MAX_NODES_OF_CONTACT_PROBLEM
from drumlin.fem.analysis.prepared import DEGREE_ACROSS_WIDTH_FOR_ANALYSES
from drumlin.fem.error_control.adapt import DEFAULT_TOLERANCES_OF_PRESSURE_AND_TORQUE
from drumlin.fem.error_control.degrees import (
    FEWEST_VERTICES_OF_FINE_MESH_FILE,
    REFINEMENT_LEVELS_ON_MESH_FILES,
)
from drumlin.fem.error_control.levels import REFINEMENT_LEVELS_FROM_COARSE_TO_FINE
from drumlin.fem.mesh.smooth_outline import LARGEST_TURN_BETWEEN_CHORDS_OF_CURVE
from drumlin.fem.model import (
    DEFAULT_PENALTY_FACTOR,
    LARGEST_ACCEPTED_FORCE_IMBALANCE_OF_SHOE,
    LARGEST_ACCEPTED_PRESSURE_ROUND_OFF,
    LARGEST_PRESSURE_ROUND_OFF_LEFT_UNREFINED,
)
from drumlin.fem.preparation.meshes import (
    MOST_NODES_AT_RAISED_DEGREE,
    MOST_NODES_WITHOUT_KEPT_FACTORS,
)
from drumlin.fem.solid import DEFAULT_ERROR_TOLERANCE_OF_SOLID_MODEL
from drumlin.fem.width.correction import REMAINING_ERROR_OVER_WIDTH_CORRECTION
from drumlin.fem.width.ladder import (
    LARGEST_WIDTH_DEGREE_WITH_STATED_ERROR,
    SAFETY_FACTORS_OF_SOLID_ERRORS,
)
from drumlin.fem.width.prepare import LARGEST_POISSON_RATIO_OF_WIDTH_MODEL
from drumlin.lining_wear.run_in import (
    DEFAULT_WEAR_COEFFICIENT,
    END_OF_WEAR_TOLERANCE,
    WORN_OUT_FRACTION_OF_LINING_THICKNESS,
)
from drumlin.response.response import UNCOMPARED_EDGE_ZONE_IN_RADIANS
from drumlin.studies import FOLDER_OF_INSTALLED_OR_SOURCE_STUDIES_AND_MESHES
from drumlin_studies.benchmarks import (
    EQUATIONS_PER_SYSTEM_OF_FIXED_CALCULATION,
    read_benchmark_history,
)

QUOTED = re.compile(r"\{\{ ([a-z_]+) \}\}")
"""A quoted value. Double braces of f-strings in examples hold more than one word."""

WORK = (
    FOLDER_OF_INSTALLED_OR_SOURCE_STUDIES_AND_MESHES
    / "reports"
    / "reference"
    / "error_vs_runtime"
    / "results.csv"
)
"""Kept table of errors against run times, which `drumlin study error_vs_runtime` makes anew."""

LEAST_WHOLE = 10
"""Milliseconds from which on a time is quoted without decimals."""


def quoted_values() -> dict[str, str]:
    """All values by name, as texts for pages."""
    return {
        "version": drumlin.__version__,
        "penalty": _power_of_ten_text(DEFAULT_PENALTY_FACTOR),
        "penalty_tex": f"10^{{{round(math.log10(DEFAULT_PENALTY_FACTOR))}}}",
        "penalty_compression": _power_of_ten_text(1 / DEFAULT_PENALTY_FACTOR),
        "default_pressure": f"{100 * DEFAULT_TOLERANCES_OF_PRESSURE_AND_TORQUE.pressure:g} %",
        "default_torque": f"{100 * DEFAULT_TOLERANCES_OF_PRESSURE_AND_TORQUE.torque:g} %",
        "edge_zone": f"{math.degrees(UNCOMPARED_EDGE_ZONE_IN_RADIANS):g} deg",
        "lowest_degree": str(min(level.degree for level in REFINEMENT_LEVELS_FROM_COARSE_TO_FINE)),
        "highest_degree": str(max(level.degree for level in REFINEMENT_LEVELS_FROM_COARSE_TO_FINE)),
        "largest_imbalance": _power_of_ten_text(LARGEST_ACCEPTED_FORCE_IMBALANCE_OF_SHOE),
        "largest_loss": _power_of_ten_text(LARGEST_PRESSURE_ROUND_OFF_LEFT_UNREFINED),
        "most_loss": _power_of_ten_text(LARGEST_ACCEPTED_PRESSURE_ROUND_OFF),
        **_width_shares(),
        "largest_smooth_turn": f"{math.degrees(LARGEST_TURN_BETWEEN_CHORDS_OF_CURVE):g} deg",
        "mesh_degree": str(
            REFINEMENT_LEVELS_ON_MESH_FILES.levels[-1].degree
            - REFINEMENT_LEVELS_ON_MESH_FILES.degrees_below_level
        ),
        "fine_mesh": str(FEWEST_VERTICES_OF_FINE_MESH_FILE),
        "most_contact_nodes": f"{MAX_NODES_OF_CONTACT_PROBLEM:,}".replace(",", " "),
        "most_raised_nodes": f"{MOST_NODES_AT_RAISED_DEGREE:,}".replace(",", " "),
        "most_nodes_with_arcs": f"{MOST_NODES_WITHOUT_KEPT_FACTORS:,}".replace(",", " "),
        "solid_poisson": f"{LARGEST_POISSON_RATIO_OF_WIDTH_MODEL:g}",
        "solid_tolerance": f"{100 * DEFAULT_ERROR_TOLERANCE_OF_SOLID_MODEL:g} %",
        "solid_degree": str(LARGEST_WIDTH_DEGREE_WITH_STATED_ERROR),
        "two_levels_safety": f"{SAFETY_FACTORS_OF_SOLID_ERRORS.two_levels_pressure:g}",
        "two_levels_force_safety": f"{SAFETY_FACTORS_OF_SOLID_ERRORS.two_levels_force:g}",
        "section_safety": f"{SAFETY_FACTORS_OF_SOLID_ERRORS.section_pressure:g}",
        "section_force_safety": f"{SAFETY_FACTORS_OF_SOLID_ERRORS.section_force:g}",
        "analysis_degree": str(DEGREE_ACROSS_WIDTH_FOR_ANALYSES),
        "function_rows": str(NUMBER_OF_ROWS_OF_TABULATED_CLEARANCE),
        "function_pressures": str(len(PRESSURES_OF_TABULATED_FRICTION)),
        "wear_coefficient": f"{1e9 * DEFAULT_WEAR_COEFFICIENT:g} mm³/(N m)",
        "wear_settled": f"{100 * END_OF_WEAR_TOLERANCE:g} %",
        "worn_out": f"{100 * WORN_OUT_FRACTION_OF_LINING_THICKNESS:g} %",
        "solve_path": solve_path_picture(),
        "benchmark_equations": str(EQUATIONS_PER_SYSTEM_OF_FIXED_CALCULATION),
        "benchmark_table": history.history_table(read_benchmark_history()),
        **_error_and_time_values(),
    }


def fill_in_values(text: str, known: Mapping[str, str]) -> str:
    """A page with its values in place. Raises NoAnswer for a name that is not known."""

    def value_of_quote(found: re.Match[str]) -> str:
        """The value for a quoted name. Raises NoAnswer for an unknown name."""
        if found[1] not in known:
            raise NoAnswer(f"the manual is not built: no value is called {found[1]!r}")
        return known[found[1]]

    return QUOTED.sub(value_of_quote, text)


def _width_shares() -> dict[str, str]:
    """The shares of the correction for the widths that remain as its error, in percent."""
    shares = {}
    for name, share in REMAINING_ERROR_OVER_WIDTH_CORRECTION.items():
        shares[f"width_share_{name}"] = f"{100 * share:g} %"
    return shares


def _power_of_ten_text(number: float) -> str:
    """A power of ten as drumlin's options and messages spell it: 1e8, 1e-5."""
    return f"1e{round(math.log10(number))}"


@cache
def _kept_rows() -> list[dict[str, str]]:
    """The rows of the kept table."""
    with WORK.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def _row_of_method(family: str, method: str) -> dict[str, str]:
    """The row of a way to solve the double-shoe brake."""
    sought = ("double_shoe/brake", family, method)
    return next(
        row for row in _kept_rows() if (row["brake"], row["family"], row["method"]) == sought
    )


def _error_and_time_values() -> dict[str, str]:
    """Errors and times of ways to solve the double-shoe brake."""
    hp_elements = _row_of_method("columns", "level 1")
    mesh = _row_of_method("graded mesh", "quad2, 80 elements")
    fine_mesh = _row_of_method("graded mesh", "quad2, 160 elements")
    fine_hp = _row_of_method("columns", "level 2")
    pointwise = _row_of_method("pointwise penalty", "1e+06 E/t, 80 elements")
    return {
        "hp_error": _percent_text(hp_elements["pressure_error"]),
        "hp_time": _milliseconds_text(hp_elements["seconds"]),
        "fine_hp_error": _percent_text(fine_hp["pressure_error"]),
        "fine_hp_time": _milliseconds_text(fine_hp["seconds"]),
        "mesh_error": _percent_text(mesh["pressure_error"]),
        "mesh_time": _milliseconds_text(mesh["seconds"]),
        "mesh_further": _milliseconds_text(mesh["further"]),
        "mesh_unknowns": mesh["unknowns"],
        "fine_mesh_error": _percent_text(fine_mesh["pressure_error"]),
        "fine_mesh_time": _milliseconds_text(fine_mesh["seconds"]),
        "pointwise_error": _percent_text(pointwise["pressure_error"]),
        "pointwise_time": _milliseconds_text(pointwise["seconds"]),
        "pointwise_further": _milliseconds_text(pointwise["further"]),
    }


def _percent_text(fraction: str) -> str:
    """A relative error in per cent, to two digits."""
    return f"{100 * float(fraction):.2g} %"


def _milliseconds_text(seconds: str) -> str:
    """A time in milliseconds, to two digits at least."""
    value = 1e3 * float(seconds)
    return f"{value:.0f} ms" if value >= LEAST_WHOLE else f"{value:.2g} ms"
