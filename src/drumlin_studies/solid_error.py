"""Compare the stated errors of solid shoes with their true errors, on random brakes.

    python -m drumlin_studies.solid_error KIND FIRST LAST [TOLERANCE [LEVEL]]

solves the brakes of the seeds FIRST to LAST - 1 to TOLERANCE (by default 0.01) by
`solve_brake_with_widths_to_tolerance`. It prints a line for each brake, a table of the ratios of
stated to true errors, and the same ratios for the errors that a solve by plane stress states for
its neglect of the widths. KIND is a name in DRAWN:

- "free": brakes of draw_random_brake whose shoes have parts of several widths
- "built": steel shoes with a table under the lining and a web, as they are built. The table is as
  wide as the lining and 1/30 to 1/8 of this width thick. The web is 1/12 to 1/4 as wide.
- "one": brakes of draw_random_brake whose bodies are made as wide as the linings

The true errors are distances from a reference solution, the truth. Its functions across the width
are graded to the sides of all parts, on the mesh of level LEVEL (by default 2) in the section. Its
uncertainty is its distance from the same functions of one degree less. An error is judged if it is
at least TRUTH_FACTOR times this uncertainty. A solve on a section of level LEVEL has the same error
of the section as the truth, so that its true errors come out too small. To judge such a solve, use
a truth on the next level.
"""

import math
import sys
import time
from collections.abc import Callable, Iterator
from functools import partial
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.file import vary
from drumlin.fem.error_control.adapt import Tolerance
from drumlin.fem.error_control.levels import LEVELS
from drumlin.fem.hp.division import Level
from drumlin.fem.solve import solve
from drumlin.fem.width.error import distance_of_plane_stress_from_widths
from drumlin.fem.width.functions import (
    SAME_SIDE,
    WidthFunctions,
    breaks_across_half_width_of_shoe,
    half_widths_of_parts,
    has_parts_of_different_widths,
)
from drumlin.fem.width.ladder import (
    solve_brake_with_widths_to_tolerance,
    solve_level_of_section_with_width_degree,
)
from drumlin.fem.width.prepare import reason_against_width_model
from drumlin.response.response import Response
from drumlin_studies.random_brake import draw_random_brake
from drumlin_studies.width_error import KINDS_WITH_WIDTHS

GRADED_DEGREE = 3
"""Degree of the reference solution's functions across the width, in each of their pieces."""
GRADED_LENGTH = 0.2
"""Length across the width of the reference solution's pieces beside the side of a part.

It is relative to the lining's thickness or, if the next break between pieces is nearer than this
thickness, to the distance of the break. Pieces much shorter than the elements of the section add
unknowns without use.
"""
STEEL = {"E": 210e9, "nu": 0.3}
"""Material of the tables and webs of the "built" shoes: Young's modulus [Pa], Poisson's ratio."""
TABLE = (1 / 30, 1 / 8)
"""Smallest and largest thickness of a "built" shoe's table, relative to the lining's width."""
WEB = (1 / 12, 1 / 4)
"""Smallest and largest width of a "built" shoe's web, relative to the lining's width."""
BOUNDED_ERRORS = ("torque", "pressure")
"""Names, in the `error` of a response, of the errors that a tolerance bounds."""
JUDGED_ERRORS = (*BOUNDED_ERRORS, "reaction")
"""Names of the stated errors that are compared with true errors."""
LEAST_MODEL_ERROR = 0.01
"""True relative error of plane stress from which on the estimate of this error is judged."""
GOOD_FACTOR, POOR_FACTOR = 1.5, 3.0
"""Factors that tell whether an estimate of the error of plane stress is good or poor.

An estimate within a factor GOOD_FACTOR of the true error tells an engineer whether plane stress is
good enough. An estimate below the true error divided by POOR_FACTOR would mislead.
"""
TRUTH_FACTOR = 4.0
"""True error above which a stated error is judged, relative to the uncertainty of the truth."""
LEAST_TRUE_ERROR = 1e-5
"""True relative error above which a stated error is judged; the truth itself is no more exact."""


class SolidErrorRow(NamedTuple):
    """The true and the stated errors of a brake that was solved to a tolerance.

    Attributes
    ----------
    title : title of the brake
    true, stated : relative errors by the names of JUDGED_ERRORS
    unsure : uncertainties of the true errors, by the same names
    cost : processor time of the solve, divided by the time of a default solve by plane stress
    reached : whether the stated errors meet the tolerance
    how : text on the degrees of the solve, across the width and in the section
    plane_true, plane_stated : true and stated errors of plane stress, by the same names;
        `plane_stated` is empty if the solve by plane stress states no errors
    """

    title: str
    true: dict[str, float]
    stated: dict[str, float]
    unsure: dict[str, float]
    cost: float
    reached: bool
    how: str
    plane_true: dict[str, float]
    plane_stated: dict[str, float]

    def is_judged(self, name: str) -> bool:
        """Whether a true error is certain and large enough to judge the stated error.

        `name` is one of JUDGED_ERRORS.
        """
        return self.true[name] > max(LEAST_TRUE_ERROR, TRUTH_FACTOR * self.unsure[name])

    def ratio(self, name: str) -> float:
        """The ratio of stated to true error; inf if the true error is 0.

        `name` is one of JUDGED_ERRORS.
        """
        return self.stated[name] / self.true[name] if self.true[name] else math.inf


def random_brake_on_rigid_drum(seed: int) -> Brake:
    """Draw the random brake of a seed, of a kind with a rigid drum."""
    return draw_random_brake(seed, KINDS_WITH_WIDTHS[seed % len(KINDS_WITH_WIDTHS)])


def random_brake_with_steel_table_and_web(seed: int) -> Brake:
    """Draw the brake of a seed whose shoe is built as usual, of a steel table and a steel web."""
    brake = draw_random_brake(seed, "backed")
    rng = np.random.default_rng([seed, len(KINDS_WITH_WIDTHS)])
    table, web = (math.exp(rng.uniform(*np.log(part))) for part in (TABLE, WEB))
    width = brake.shoes[0].lining.width
    changes = {
        "shoe.backing.thickness": table * width,
        "shoe.backing.material": STEEL,
        "shoe.body.width": web * width,
        "shoe.body.material": STEEL,
    }
    return vary(brake, changes)


def random_brake_with_bodies_as_wide_as_linings(seed: int) -> Brake:
    """Draw the random brake of a seed, and make its bodies as wide as the linings."""
    brake = random_brake_on_rigid_drum(seed)
    if any(shoe.body is None for shoe in brake.shoes):
        return brake
    return vary(brake, {"shoe.body.width": brake.shoes[0].lining.width})


DRAWN: dict[str, Callable[[int], Brake]] = {
    "free": random_brake_on_rigid_drum,
    "built": random_brake_with_steel_table_and_web,
    "one": random_brake_with_bodies_as_wide_as_linings,
}
"""The function that draws a brake from a seed, for each KIND on the command line."""


def functions_across_width_graded_to_sides(
    shoe: Shoe, degree: int = GRADED_DEGREE
) -> WidthFunctions:
    """Functions across the width of a shoe, with short pieces beside the sides of all its parts.

    `degree` is the degree of the functions in each piece.
    """
    halves, breaks = half_widths_of_parts(shoe).values(), breaks_across_half_width_of_shoe(shoe)

    def is_place_a_side_of_shoe_part(place: float) -> bool:
        """Whether the side of a part of the shoe is at this distance [m] from the mid-plane."""
        return any(abs(place - half) <= SAME_SIDE * half for half in halves)

    found = set(breaks)
    for inner, outer in pairwise(breaks):
        size = GRADED_LENGTH * min(outer - inner, shoe.lining.thickness)
        if is_place_a_side_of_shoe_part(inner):
            found.add(inner + size)
        if is_place_a_side_of_shoe_part(outer):
            found.add(outer - size)
    return WidthFunctions(tuple(sorted(found)), degree)


def response_with_graded_width_functions(
    brake: Brake, level: Level, degree: int = GRADED_DEGREE
) -> Response:
    """The response of a brake with functions across the width graded to the sides of its parts.

    Parameters
    ----------
    brake : the brake
    level : degree and grading of the hp elements of the shoes' sections
    degree : degree of the functions across the width, in each of their pieces
    """
    graded = partial(functions_across_width_graded_to_sides, degree=degree)
    return solve_level_of_section_with_width_degree(brake, level, graded, solve(brake)).response


def stated_and_true_width_errors_or_why_none(
    brake: Brake, tolerance: float, level: Level
) -> SolidErrorRow | str:
    """The stated and the true errors of a brake with solid shoes, or the reason why it has none.

    Parameters
    ----------
    brake : the brake
    tolerance : allowed relative error of the pressure, averaged over the width, and of the torque
    level : level of the mesh in the section with which the truth is solved
    """
    reason = reason_against_width_model(brake)
    if reason is not None:
        return reason
    try:
        started = time.process_time()
        solve(brake, model_error=False)
        plane_done = time.process_time()
        found = solve_brake_with_widths_to_tolerance(
            brake, Tolerance(tolerance, tolerance), must=False
        )
        done = time.process_time()
        plane = solve(brake, model_error=True)
        truth, lower = (
            response_with_graded_width_functions(brake, level, degree)
            for degree in (GRADED_DEGREE, GRADED_DEGREE - 1)
        )
        true = distance_of_plane_stress_from_widths(brake, found, truth)
        unsure = distance_of_plane_stress_from_widths(brake, lower, truth)
        plane_true = distance_of_plane_stress_from_widths(brake, plane, truth)
    except (NoAnswer, np.linalg.LinAlgError) as error:
        return str(error)
    stated = {name: (found.error or {})[name] for name in JUDGED_ERRORS}
    return SolidErrorRow(
        title=brake.title,
        true={name: true.brake[name] for name in JUDGED_ERRORS},
        stated=stated,
        unsure={name: unsure.brake[name] for name in JUDGED_ERRORS},
        cost=(done - plane_done) / (plane_done - started),
        reached=max(stated[name] for name in BOUNDED_ERRORS) <= tolerance,
        how=found.notes[-1],
        plane_true={name: plane_true.brake[name] for name in JUDGED_ERRORS},
        plane_stated=dict(plane.plane_stress_error.brake) if plane.plane_stress_error else {},
    )


def rows_of_width_errors_of_random_brakes(
    kind: str, seeds: range, tolerance: float, level: Level
) -> Iterator[SolidErrorRow | str]:
    """Yield the errors of each brake of a kind in DRAWN, or the reason why a brake has none.

    The kind "one" skips brakes whose shoes have parts of several widths. The other kinds skip
    brakes whose shoes have parts of one width.

    Parameters
    ----------
    kind : how the brakes are drawn
    seeds : seeds of the brakes
    tolerance : allowed relative error of the pressure, averaged over the width, and of the torque
    level : level of the mesh in the section with which the truth is solved
    """
    for seed in seeds:
        try:
            brake = DRAWN[kind](seed)
        except (BadInput, NoAnswer) as error:
            yield str(error)
            continue
        if any(map(has_parts_of_different_widths, brake.shoes)) == (kind == "one"):
            continue
        found = stated_and_true_width_errors_or_why_none(brake, tolerance, level)
        yield found if isinstance(found, SolidErrorRow) else f"{brake.title}: {found}"


def table_lines_of_stated_over_true_quantiles(rows: list[SolidErrorRow]) -> list[str]:
    """Table lines on the ratios of stated to true errors: their number, share below 1, quantiles.

    Two more lines say how many brakes reach the tolerance, and how much time the solves take.
    """
    lines = ["error     brakes  too small  least   5 %   half  95 %"]
    for name in JUDGED_ERRORS:
        ratios = [row.ratio(name) for row in rows if row.is_judged(name)]
        if ratios:
            small = np.mean([ratio < 1 for ratio in ratios])
            at = np.quantile(ratios, [0.0, 0.05, 0.5, 0.95])
            numbers = "  ".join(f"{value:5.2f}" for value in at)
            lines.append(f"{name:9} {len(ratios):5}  {small:9.0%}  {numbers}")
    if rows:
        share, cost = np.mean([row.reached for row in rows]), np.median([row.cost for row in rows])
        lines.append(f"{share:.0%} of {len(rows)} brakes reach the tolerance")
        lines.append(f"{cost:.0f} times the time of a default solve by plane stress (median)")
    return lines


def table_lines_of_stated_plane_stress_errors(rows: list[SolidErrorRow]) -> list[str]:
    """Table lines on the stated errors of plane stress: how many are good, and how many are poor.

    Only brakes on which plane stress has a true error of at least LEAST_MODEL_ERROR are judged.
    GOOD_FACTOR and POOR_FACTOR say what good and poor mean.
    """
    lines = ["plane stress: error  brakes  within 1.5  below 1/3  least   half   most"]
    for name in JUDGED_ERRORS:
        ratios = [
            row.plane_stated[name] / row.plane_true[name]
            for row in rows
            if row.plane_stated and row.plane_true[name] >= LEAST_MODEL_ERROR
        ]
        if ratios:
            good = np.mean([1 / GOOD_FACTOR <= ratio <= GOOD_FACTOR for ratio in ratios])
            poor = np.mean([ratio < 1 / POOR_FACTOR for ratio in ratios])
            numbers = "  ".join(f"{v:5.2f}" for v in np.quantile(ratios, [0.0, 0.5, 1.0]))
            lines.append(f"{name:19} {len(ratios):7}  {good:10.0%}  {poor:9.0%}  {numbers}")
    return lines


def main() -> None:
    """Print a line of errors for each brake of a kind, and the two tables of all brakes."""
    kind, first, last = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    tolerance, level = [*map(float, sys.argv[4:]), *(1e-2, 2.0)[len(sys.argv) - 4 :]]
    rows = []
    for row in rows_of_width_errors_of_random_brakes(
        kind, range(first, last), tolerance, LEVELS[int(level) - 1]
    ):
        if isinstance(row, str):
            sys.stdout.write(f"{row}\n")
            continue
        rows.append(row)
        errors = ", ".join(
            f"{name} {row.true[name]:.1e} x {row.ratio(name):.2f}"
            f"{'' if row.is_judged(name) else ' (not judged)'}"
            for name in JUDGED_ERRORS
        )
        sys.stdout.write(f"{row.title}: {errors}, cost {row.cost:.0f}, {row.how}\n")
        sys.stdout.flush()
    lines = table_lines_of_stated_over_true_quantiles(rows)
    lines += table_lines_of_stated_plane_stress_errors(rows)
    sys.stdout.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
