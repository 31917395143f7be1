"""Stated and true errors of brakes that press on the drum only by a corner or a tip of the lining.

A corner is an end of the lining's surface; a tip is a kink of this surface that points to the drum.
These brakes have a table of their own, because their pressure p grows without bound towards the
corner or the tip. With much friction p grows so fast that no solution has a small error.
"""

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.brake import Brake
from drumlin.fem.hp.corner import corners_with_unbounded_pressure
from drumlin.fem.solve import solve
from drumlin_studies.random_corners import draw_random_brake_pressing_with_corner_or_kink
from drumlin_studies.stated_true import row_of_stated_and_true_errors, stated_over_true_error_of_row
from drumlin_studies.stored_truth import solve_brake_on_corner_or_kink_by_fine_triangles
from drumlin_studies.tables import rows_with_given_values, values_of_key_in_rows

TOLERANCES_OF_CORNER_BRAKE_SOLVES = (5e-3, 1e-3, 1e-4)
"""Relative tolerances to which each brake is solved."""
SEED_OF_FIRST_CORNER_BRAKE = 420_000
"""Seed of the first brake with a corner on which stated errors are tested.

Other brakes were used for development: the seeds 400000 to 400099 for the rules at corners, and
those from `calibration.FIRST_CORNER` on for the safety factors."""
SMALLEST_JUDGED_PRESSURE_EXPONENT = -0.3
"""Exponent a of the pressure p ~ x^a at a corner. Below this value no solution reaches an error of
0.1 % of p.

The limit exists because angles are floating-point numbers. The smallest element has 1e-12 rad
(`corner.LENGTH_OF_PRESSURE_PIECE_AT_CORNER`), which is 1e-10 of a contact of half a degree. In this
element p has an error of about (1e-10)^(a + 1/2) (`polynomial_error_of_power_function`): with
degree 7 the error is 0.13 % for a = -0.3, 0.8 % for -0.38 and 5 % for -0.45. For -0.5 p is not
square-integrable. On a rigid drum these three exponents (-0.3, -0.38, -0.45) belong to friction
coefficients of 0.31, 0.42 and 0.52, with friction that drags the lining away from the corner.
"""


def rows_of_stated_and_true_errors_of_corner_brake(seed: int) -> list[dict[str, Any]]:
    """Rows of stated and true errors of the random brake of a seed, one for each tolerance.

    A row has the stated and the true error of each quantity, the `kind` of the brake, and `power`:
    the smallest exponent a of the pressure p ~ x^a at its corners in contact, or 0 without such a
    corner.
    """
    base: dict[str, Any] = {"seed": seed, "kind": "none", "power": 0.0}
    try:
        brake = draw_random_brake_pressing_with_corner_or_kink(seed)
    except NoAnswer as error:
        return [base | {"outcome": "failed", "reason": str(error)}]
    kind = brake.title.removeprefix("random ").removesuffix(f" {seed}")
    # True errors are taken from drumlin's second solver, with triangles graded to the corners.
    failure, true = "", None
    try:
        true = solve_brake_on_corner_or_kink_by_fine_triangles(brake)
    except (NoAnswer, BadInput, AssertionError) as error:
        failure = str(error)
    base |= {"kind": kind, "power": smallest_pressure_exponent_at_corners(brake)}
    return [
        base | row_of_stated_and_true_errors(brake, tolerance, solve, true, failure)
        for tolerance in TOLERANCES_OF_CORNER_BRAKE_SOLVES
    ]


def smallest_pressure_exponent_at_corners(brake: Brake) -> float:
    """The smallest exponent a of p ~ x^a at the corners of linings that press on the drum.

    x is the distance from the corner. The result is 0 if no corner presses on the drum.
    """
    smallest = math.inf
    for i, shoe in enumerate(solve(brake).shoes):
        for corner in corners_with_unbounded_pressure(brake, i, shoe):
            smallest = min(smallest, corner.exponent)
    return smallest if smallest < math.inf else 0.0


def error_summary_rows_by_kind(rows: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Summarise rows of errors in a table with a row for each kind of brake and each tolerance.

    A row has the number of brakes, the fraction that reaches the tolerance, and the smallest and
    the median ratio of stated to true error of p. Below the kinds follow rows for all brakes, and
    for the brakes whose exponent is at least SMALLEST_JUDGED_PRESSURE_EXPONENT.
    """
    kinds: dict[str, list[Mapping[str, Any]]] = {}
    for kind in sorted(set(values_of_key_in_rows(rows, "kind"))):
        kinds[kind] = rows_with_given_values(rows, kind=kind)
    gentle = [one for one in rows if one["power"] >= SMALLEST_JUDGED_PRESSURE_EXPONENT]
    table = []
    for kind, mine in {**kinds, "all": list(rows), "all but the steepest corners": gentle}.items():
        for tolerance in TOLERANCES_OF_CORNER_BRAKE_SOLVES:
            own = rows_with_given_values(mine, tolerance=tolerance)
            # A brake without a solution, or without a true error, has no finite ratio.
            ratios = np.array([stated_over_true_error_of_row(one, "pressure") for one in own])
            known = ratios[np.isfinite(ratios)]
            outcomes = Counter(values_of_key_in_rows(own, "outcome"))
            reached = outcomes["reached"] + outcomes["no truth"]
            table.append(
                {
                    "kind": kind,
                    "tolerance": tolerance,
                    "brakes": len(own),
                    "reached": reached / max(1, len(own)),
                    "judged": len(known),
                    "smallest": float(known.min()) if len(known) else None,
                    "median": float(np.median(known)) if len(known) else None,
                }
            )
    return table
