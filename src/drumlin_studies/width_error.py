"""The estimated error of the plane-stress model compared with its true error, on random brakes.

The command

    python -m drumlin_studies.width_error FIRST LAST [DEGREE]

prints a line for each random brake on a rigid drum with a seed from FIRST to LAST - 1, and two
tables. The first table has the ratios of estimated to true error. The second table has the true
error that remains after the correction for the widths, divided by the estimated error. The first
table separates brakes whose parts have one width from brakes whose parts have several. Both tables
leave out brakes on which the error of plane stress is less than LEAST_JUDGED_PLANE_STRESS_ERROR.

The true error is the difference from a model whose displacements vary across the width as
polynomials of the degree DEGREE (by default 5). Both models use the first level of hp elements in
the plane of the drum. Therefore the error of this mesh cancels in the difference.
"""

import sys
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake
from drumlin.fem.error_control.levels import REFINEMENT_LEVELS_FROM_COARSE_TO_FINE
from drumlin.fem.error_control.singular_points import singular_points_of_each_shoe_shape
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.solve import solve
from drumlin.fem.width.correction import (
    REMAINING_ERROR_OVER_WIDTH_CORRECTION,
    correct_response_for_shoe_widths,
)
from drumlin.fem.width.error import relative_distance_of_plane_stress_from_width_solution
from drumlin.fem.width.functions import piece_ends_across_half_width_of_shoe
from drumlin.fem.width.prepare import (
    prepare_model_with_shoe_widths,
    reason_why_width_model_does_not_apply,
)
from drumlin_studies.random_brake import (
    FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SHAPE_KIND,
    draw_random_brake,
)

LEAST_JUDGED_PLANE_STRESS_ERROR = 1e-3
"""Smallest true relative error of plane stress for which the estimate of this error is judged.
Smaller errors are of no interest.
"""
DEFAULT_DEGREE_ACROSS_WIDTH_OF_TRUTH = 5
"""Default degree of the polynomials across the width in the model that serves as the truth."""
KINDS_OF_RANDOM_BRAKES_ON_RIGID_DRUM = tuple(
    kind for kind in FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SHAPE_KIND if not kind.endswith("on ring")
)
"""Kinds of random brakes for which drumlin estimates the error of plane stress: all with a rigid
drum.
"""
NAMES_OF_JUDGED_PLANE_STRESS_ERRORS = ("torque", "pressure", "reaction")
"""The errors of plane stress that are judged, by their names in `EstimatedErrorOfPlaneStress`."""


class TrueAndEstimatedPlaneStressErrorRow(NamedTuple):
    """The true and the estimated error of plane stress on a brake.

    Attributes
    ----------
    title : title of the brake
    widths : number of intervals across half the width of a shoe, the largest over the shoes. The
        sides of narrower parts, for example of a web, separate the intervals.
    true, estimated : relative errors by the names of NAMES_OF_JUDGED_PLANE_STRESS_ERRORS
    remaining : true relative errors after the correction for the widths
    """

    title: str
    widths: int
    true: dict[str, float]
    estimated: dict[str, float]
    remaining: dict[str, float]

    def estimated_over_true_error(self, name: str) -> float:
        """The estimated error `name` divided by the true error."""
        return self.estimated[name] / self.true[name]

    def error_share_remaining_after_width_correction(self, name: str) -> float:
        """The error that remains after the correction, divided by the estimated error."""
        return self.remaining[name] / self.estimated[name]


def true_and_estimated_plane_stress_errors_or_reason(
    brake: Brake, degree: int = DEFAULT_DEGREE_ACROSS_WIDTH_OF_TRUTH
) -> TrueAndEstimatedPlaneStressErrorRow | str:
    """The true and the estimated error of plane stress on a brake, or why they are not known.

    degree : degree of the polynomials across the width in the model that serves as the truth.
    """
    reason = reason_why_width_model_does_not_apply(brake)
    if reason is not None:
        return reason
    try:
        # The default solve gives the estimate of the error. Two further solves give the true error.
        # They start from the contact of the default solve, and their meshes are graded to its
        # singular points.
        response = solve(brake, model_error=True)
        points = singular_points_of_each_shoe_shape(
            brake,
            response,
            error=REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0].pressure_error_due_to_column_size_ratio,
        )
        plane = solve_prepared_model(
            make_prepared_model(brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0], points),
            brake,
            start=response,
        )
        scene = prepare_model_with_shoe_widths(
            brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0], degree, points
        )
        wide = solve_prepared_model(scene, brake, start=response)
        corrected = correct_response_for_shoe_widths(brake, plane)
    except NoAnswer as error:
        return str(error)
    true, remaining = (
        relative_distance_of_plane_stress_from_width_solution(brake, plane, wide),
        relative_distance_of_plane_stress_from_width_solution(brake, corrected, wide),
    )
    found = response.plane_stress_error
    assert found is not None
    if found.unknown or true.unknown:
        return f"estimate: {found.unknown or 'known'}; truth: {true.unknown or 'known'}"
    widths = max(len(piece_ends_across_half_width_of_shoe(shoe)) - 1 for shoe in brake.shoes)
    return TrueAndEstimatedPlaneStressErrorRow(
        brake.title, widths, dict(true.brake), dict(found.brake), dict(remaining.brake)
    )


def plane_stress_error_rows_of_seeds(
    first: int, last: int, degree: int
) -> Iterator[TrueAndEstimatedPlaneStressErrorRow | str]:
    """For each seed from `first` to `last` - 1 the row of its brake, or a text why there is none.

    degree : degree of the polynomials across the width in the model that serves as the truth.
    """
    for seed in range(first, last):
        try:
            brake = draw_random_brake(
                seed,
                KINDS_OF_RANDOM_BRAKES_ON_RIGID_DRUM[
                    seed % len(KINDS_OF_RANDOM_BRAKES_ON_RIGID_DRUM)
                ],
            )
        except NoAnswer as error:
            yield str(error)
            continue
        found = true_and_estimated_plane_stress_errors_or_reason(brake, degree)
        yield (
            found
            if isinstance(found, TrueAndEstimatedPlaneStressErrorRow)
            else f"{brake.title}: {found}"
        )


def table_lines_of_estimated_over_true_errors(
    rows: list[TrueAndEstimatedPlaneStressErrorRow],
) -> list[str]:
    """The lines of the table on the ratios of estimated to true error.

    A line has the number of ratios, their quantiles, and the share of ratios between 1/1.5 and 1.5.
    """
    lines = ["widths  error      brakes  least  5 %   half  95 %  most  within 1.5"]
    for name in NAMES_OF_JUDGED_PLANE_STRESS_ERRORS:
        for several in (False, True):
            own = [row for row in rows if (row.widths > 1) == several]
            ratios = [
                row.estimated_over_true_error(name)
                for row in own
                if row.true[name] > LEAST_JUDGED_PLANE_STRESS_ERROR
            ]
            if not ratios:
                continue
            at = np.quantile(ratios, [0.0, 0.05, 0.5, 0.95, 1.0])
            within = np.mean([1 / 1.5 <= ratio <= 1.5 for ratio in ratios])
            numbers = "  ".join(f"{value:4.2f}" for value in at)
            word = "several" if several else "one"
            lines.append(f"{word:7} {name:10} {len(ratios):6}  {numbers}  {within:6.0%}")
    return lines


def table_lines_of_remaining_error_after_correction(
    rows: list[TrueAndEstimatedPlaneStressErrorRow],
) -> list[str]:
    """Lines of the table on the error that remains after the correction for the widths.

    Each remaining error is divided by the estimated error. The last two columns are the fraction of
    brakes whose ratio is within `REMAINING_ERROR_OVER_WIDTH_CORRECTION`, and the fraction of brakes
    whose error the correction more than halves.
    """
    lines = ["error      brakes  share  half  90 %  95 %  most  within share  halved"]
    for name in NAMES_OF_JUDGED_PLANE_STRESS_ERRORS:
        own = [row for row in rows if row.true[name] > LEAST_JUDGED_PLANE_STRESS_ERROR]
        if not own:
            continue
        shares = [row.error_share_remaining_after_width_correction(name) for row in own]
        numbers = "  ".join(f"{value:4.2f}" for value in np.quantile(shares, [0.5, 0.9, 0.95, 1.0]))
        within = np.mean([share <= REMAINING_ERROR_OVER_WIDTH_CORRECTION[name] for share in shares])
        halved = np.mean([row.remaining[name] < 0.5 * row.true[name] for row in own])
        remaining = REMAINING_ERROR_OVER_WIDTH_CORRECTION[name]
        line = f"{name:10} {len(own):6}   {remaining:4.2f}  {numbers}"
        lines.append(f"{line}  {within:12.0%}  {halved:6.0%}")
    return lines


def main() -> None:
    """Print the lines and the two tables for the seeds and the degree on the command line."""
    first, last, *degree = map(int, sys.argv[1:])
    rows = []
    for row in plane_stress_error_rows_of_seeds(
        first, last, *degree or [DEFAULT_DEGREE_ACROSS_WIDTH_OF_TRUTH]
    ):
        if isinstance(row, str):
            sys.stdout.write(f"{row}\n")
            continue
        rows.append(row)
        errors = ", ".join(
            f"{name} {row.true[name]:.1e} x {row.estimated[name] / (row.true[name] or 1):.2f}, "
            f"corrected {row.remaining[name]:.1e}"
            for name in NAMES_OF_JUDGED_PLANE_STRESS_ERRORS
        )
        sys.stdout.write(f"{row.title} ({row.widths}): {errors}\n")
        sys.stdout.flush()
    lines = [
        *table_lines_of_estimated_over_true_errors(rows),
        "",
        *table_lines_of_remaining_error_after_correction(rows),
    ]
    sys.stdout.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
