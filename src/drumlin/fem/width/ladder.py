"""A brake with widths solved to a tolerance: a level of the section and a degree across the width.

The error has two parts, which are chosen and stated one by one and then added up.

- The section's part is that of plane stress, which is solved on finer and finer levels until half
  of the tolerance is met. With a width the pressure has the same singular points in the section.
  The coarsest level is taken whose answer is within that half, by its distance from the answer of
  the last level plus the error stated for this last answer.
- The width's part comes from one section for all degrees: a coarse one, on which degrees cost
  little, or the first level of a solve where a shoe has parts of several widths. The larger of the
  distances from the degree q to the degrees q + 1 and q + 2 there is extrapolated to all degrees.
  The smallest degree that meets the other half of the tolerance is taken. The next degree alone
  would not tell the error, since even and odd degrees fall at different rates.

The error e falls as a power of the degree where a side of the shoe is free or a part overhangs
another part. From e(q) = C q^-k follows e(q) = d / (1 - (q/(q + 2))^k) with the distance
d = e(q) - e(q + 2). The estimate is this e(q) times WIDTH_SAFETY. Its power k is SLOWEST_FALL and
not the power that the degrees show, because the distances of few degrees scatter. With k = 1 the
distance is multiplied by (q + 2)/2.

A finer section asks for higher degrees beside a web, where the pressure changes fast across the
width and along it. With distances from the coarse section the estimate without its safety factor
would be below the true error in 8 % of 106 cases, at worst 0.44 of it (17 brakes, see
WIDTH_SAFETY).

For shoes of several widths the width's part holds and the section's part does not: beside a web the
section converges more slowly than in plane stress. On one random brake ("free" 2000 of
`drumlin_studies.solid_error`) the first two levels differ by 3.6 % of the pressure with degree 2
across the width, and by 0.24 % in plane stress. The sum was stated at 0.3 of the true error of the
pressure and at 0.07 of that of the torque. `drumlin solve --model solid`
refuses a tolerance for these shoes.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import NamedTuple

from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake
from drumlin.fem.error_control.adapt import Tolerance, solve_brake_to_tolerance
from drumlin.fem.error_control.estimate import QUANTITIES, Errors
from drumlin.fem.error_control.levels import LEVELS, SolvedLevel, solve_on_finer_and_finer_levels
from drumlin.fem.error_control.singular_points import singular_points_of_all_linings
from drumlin.fem.hp.division import Level
from drumlin.fem.model import PENALTY, solve_prepared_model
from drumlin.fem.preparation.cache import Cache
from drumlin.fem.width.error import (
    WIDTH_DEGREE,
    CoarseSection,
    plane_stress_solution_on_coarse_division,
    plane_stress_solution_on_given_hp_elements,
    relative_distances_of_shoe_responses,
)
from drumlin.fem.width.functions import has_several_widths
from drumlin.fem.width.prepare import LARGEST_WIDTH_DEGREE, prepare_brake_with_widths
from drumlin.response.response import Response

SLOWEST_FALL = 1.0
"""Power k of the degree by which the width's part of the error is assumed to fall, as q^-k.

Polynomials of degree q up to a singularity r^a of the displacements leave an error of q^-2a in the
energy norm (Babuska, Szabo & Katz 1981, SIAM J. Numer. Anal. 18, 515). The strongest singularity at
a corner has a = 1/2, and so k = 1. A larger k states errors smaller, a smaller k larger. On the
random brakes of WIDTH_SAFETY the smallest stated over true error without a safety factor is 1.6
with k = 1, and 1.2 with k = 1.5.
"""
WIDTH_SAFETY = 1.5
"""Safety factor of the width's part of the error, relative to the extrapolated distance.

On 17 random brakes of several widths the estimate without this factor is at least 1.6 times the
true error on the first level of the section, and 2.3 times in the median (71 errors of torque and
pressure of the degrees 2 to 5). `python -m drumlin_studies.solid_error` draws brakes in the same
way: "free" from the seeds 2000 to 2013, and "built". The factor 1.5 is a reserve for finer
sections: on one brake the true error of degree 3 grew by 1.17 from the first to the second level.
With a factor of 0.75 the error of the torque of the main brake is stated an eighth too small. A
larger factor asks for higher degrees than are needed.
"""
LOOKED_AHEAD = 2
"""Number of further degrees across the width that give the error of a degree: one even, one odd."""


class SolidErrors(NamedTuple):
    """Relative errors of the `torque` of a brake, and of each of its shoes.

    `shoes` has the errors of each shoe by the names in QUANTITIES.
    """

    torque: float
    shoes: tuple[dict[str, float], ...]

    def is_within_error_tolerance(self, tolerance: Tolerance) -> bool:
        """Whether the errors of all mean pressures and of the torque are within a tolerance."""
        pressure = max(shoe["pressure"] for shoe in self.shoes)
        return pressure <= tolerance.pressure and self.torque <= tolerance.torque

    def sum_with_other_errors(self, other: "SolidErrors") -> "SolidErrors":
        """The sum of these errors and of `other` errors.

        The error of a peak pressure is at most 1, which means that it is unknown.
        """
        shoes = []
        for one, two in zip(self.shoes, other.shoes, strict=True):
            both = {name: one[name] + two[name] for name in QUANTITIES}
            shoes.append(both | {"peak": min(both["peak"], 1.0)})
        return SolidErrors(self.torque + other.torque, tuple(shoes))

    def errors_times_factor(self, factor: float) -> "SolidErrors":
        """All errors multiplied by a factor."""
        shoes = [{name: factor * own for name, own in shoe.items()} for shoe in self.shoes]
        return SolidErrors(factor * self.torque, tuple(shoes))


class _Section(NamedTuple):
    """A level of the section, the answer of plane stress on it, and the error of this answer."""

    level: Level
    response: Response
    error: SolidErrors


class DegreeError(NamedTuple):
    """A degree across the width, and the width's part of the error with this degree."""

    degree: int
    error: SolidErrors


def solve_brake_with_widths_to_tolerance(
    brake: Brake,
    tolerance: Tolerance,
    *,
    must: bool = True,
    penalty: float = PENALTY,
    cache: Cache | None = None,
) -> Response:
    """The response of a brake with widths, whose estimated errors meet a tolerance.

    The parameters and errors are those of `solve_and_keep_brake_with_widths`.
    """
    return solve_and_keep_brake_with_widths(
        brake, tolerance, must=must, penalty=penalty, cache=cache
    ).response


def solve_and_keep_brake_with_widths(
    brake: Brake,
    tolerance: Tolerance,
    *,
    must: bool = True,
    penalty: float = PENALTY,
    cache: Cache | None = None,
) -> SolvedLevel:
    """The response of a brake with widths to a tolerance, and the prepared model that it is of.

    Parameters
    ----------
    brake : the brake
    tolerance : relative errors that are allowed, of the mean pressure over the width and of the
        torque
    must : whether a tolerance that is not reached is an error; otherwise the best answer is
        returned
    penalty : factor alpha of the contact stiffness alpha E/t (lining modulus E, thickness t)
    cache : substructures of earlier solves

    Raises
    ------
    NoAnswer
        where plane stress or the brake with widths has no answer, and for a tolerance that must be
        reached and is not
    BadInput
        where the model does not apply
    """
    half = Tolerance(0.5 * tolerance.pressure, 0.5 * tolerance.torque)
    answer, cache = partial(solve_prepared_model, penalty=penalty), cache or Cache()
    climbed: list[SolvedLevel] = []

    def yield_and_record_refinement_levels() -> Iterator[SolvedLevel]:
        """Yield the levels of a solve by plane stress, and append each one to `climbed`."""
        for step in solve_on_finer_and_finer_levels(brake, answer, cache):
            climbed.append(step)
            yield step

    plane = solve_brake_to_tolerance(
        brake, half, answer, must=False, cache=cache, levels=yield_and_record_refinement_levels()
    ).response
    compared = plane_stress_solution_to_compare_width_degrees(
        brake, plane, penalty=penalty, cache=cache
    )
    sections = _refinement_levels_of_section_with_errors(brake, compared, climbed, plane)
    width = smallest_width_degree_within_tolerance(
        brake, plane, compared, half, penalty=penalty, cache=cache
    )
    if must and not (
        width.error.is_within_error_tolerance(half)
        and sections[-1].error.is_within_error_tolerance(half)
    ):
        raise NoAnswer(
            _message_on_unreached_error_tolerance(
                tolerance, sections[-1].error.sum_with_other_errors(width.error), width.degree
            )
        )
    section = next(
        (each for each in sections if each.error.is_within_error_tolerance(half)), sections[-1]
    )
    points = singular_points_of_all_linings(
        brake, plane, error=section.level.pressure_error_by_column_ratio
    )
    scene = prepare_brake_with_widths(brake, section.level, width.degree, points, cache=cache)
    response = answer(scene, brake, start=plane)
    warnings = [line for line in plane.notes if line.startswith("warning: tolerance")]
    unknowns = max(body.unknowns for body in scene.bodies)
    how = (
        f"degree {width.degree} across the width on a section of degree {section.level.degree}, "
        f"with {unknowns} unknowns a shoe"
    )
    found = section.error.sum_with_other_errors(width.error)
    stated = replace(
        response,
        shoes=tuple(
            replace(shoe, error=own) for shoe, own in zip(response.shoes, found.shoes, strict=True)
        ),
        error=Errors.brake_errors_from_torque_and_shoe_errors(found.torque, found.shoes).brake,
        notes=(*response.notes, *warnings, how),
    )
    return SolvedLevel(scene, stated)


def _refinement_levels_of_section_with_errors(
    brake: Brake, compared: CoarseSection, climbed: Sequence[SolvedLevel], last: Response
) -> list[_Section]:
    """The levels of the section by plane stress, from the coarsest on, each with its error.

    Parameters
    ----------
    brake : the brake
    compared : the section of the brake on which degrees across the width are compared
    climbed : the levels of the solve by plane stress
    last : the answer of this solve, with its stated errors
    """
    stated = SolidErrors(
        (last.error or {})["torque"], tuple(dict(s.error or {}) for s in last.shoes)
    )
    degrees = {level.degree: level for level in LEVELS}
    error = _relative_differences_from_better_response(
        brake, compared.plane, last
    ).sum_with_other_errors(stated)
    found = [_Section(compared.level, compared.plane, error)]
    for step in climbed[:-1]:
        level = degrees[step.scene.bodies[0].line.interpolation_degree_along_contact_line]
        error = _relative_differences_from_better_response(
            brake, step.response, last
        ).sum_with_other_errors(stated)
        found.append(_Section(level, step.response, error))
    final = degrees[last.shoes[0].order]
    return [*found, _Section(final, last, stated)]


def _message_on_unreached_error_tolerance(
    tolerance: Tolerance, error: SolidErrors, degree: int
) -> str:
    """The text on a tolerance that the finest section and the largest degree do not reach."""
    pressure = max(shoe["pressure"] for shoe in error.shoes)
    return (
        f"tolerance {tolerance.pressure:g} not reached with degree {degree} across the width: "
        f"estimated error of p {pressure:.1e}, of the torque {error.torque:.1e}"
    )


def plane_stress_solution_to_compare_width_degrees(
    brake: Brake, plane: Response, *, penalty: float = PENALTY, cache: Cache | None = None
) -> CoarseSection:
    """The section on which degrees across the width are compared, by the widths of the shoes.

    Shoes of one width have the coarse section. A brake with a shoe of several widths has the first
    level of a solve, because the coarse section shows too little of the error beside a web.

    Parameters
    ----------
    brake : the brake
    plane : answer of plane stress, whose contact grades the section
    penalty : factor alpha of the contact stiffness alpha E/t (lining modulus E, thickness t)
    cache : substructures of earlier solves

    Raises
    ------
    NoAnswer
        where plane stress has no answer on the first level
    """
    if any(has_several_widths(shoe) for shoe in brake.shoes):
        return plane_stress_solution_on_given_hp_elements(
            brake, plane, LEVELS[0], penalty=penalty, cache=cache
        )
    return plane_stress_solution_on_coarse_division(brake, plane, penalty=penalty, cache=cache)


def smallest_width_degree_within_tolerance(
    brake: Brake,
    plane: Response,
    section: CoarseSection,
    tolerance: Tolerance,
    *,
    penalty: float = PENALTY,
    cache: Cache | None = None,
) -> DegreeError:
    """The smallest degree across the width that meets a tolerance, with its error.

    If no degree meets the tolerance, the largest degree whose error can be estimated is returned.

    Parameters
    ----------
    brake : the brake
    plane : answer of plane stress
    section : the section of the brake on which degrees are compared, see
        `plane_stress_solution_to_compare_width_degrees`
    tolerance : relative errors that are allowed for the width's part
    penalty : factor alpha of the contact stiffness alpha E/t (lining modulus E, thickness t)
    cache : substructures of earlier solves
    """
    answers: dict[int, Response] = {}

    def solve_with_degree_across_width(degree: int) -> Response:
        """The answer of a degree across the width on the section."""
        if degree not in answers:
            scene = prepare_brake_with_widths(
                brake, section.level, degree, section.points, cache=cache
            )
            answers[degree] = solve_prepared_model(scene, brake, penalty=penalty, start=plane)
        return answers[degree]

    last = LARGEST_WIDTH_DEGREE - LOOKED_AHEAD
    for degree in range(WIDTH_DEGREE, last + 1):
        further = [solve_with_degree_across_width(degree + k) for k in range(1, LOOKED_AHEAD + 1)]
        found = _error_of_degree_across_width(
            brake, degree, solve_with_degree_across_width(degree), further
        )
        if found.error.is_within_error_tolerance(tolerance):
            return found
    return found


def _error_of_degree_across_width(
    brake: Brake, degree: int, response: Response, further: list[Response]
) -> DegreeError:
    """The width's part of the error of a degree, from its answer and those of further degrees."""
    moved = [
        _relative_differences_from_better_response(brake, response, other) for other in further
    ]
    shoes = []
    for own in zip(*(each.shoes for each in moved), strict=True):
        shoes.append({name: max(each[name] for each in own) for name in QUANTITIES})
    largest = SolidErrors(max(each.torque for each in moved), tuple(shoes))
    return DegreeError(
        degree, largest.errors_times_factor(_error_over_difference_from_next_degrees(degree))
    )


def _error_over_difference_from_next_degrees(degree: int) -> float:
    """The stated error of a degree, over its distance from the next LOOKED_AHEAD degrees."""
    left = (degree / (degree + LOOKED_AHEAD)) ** SLOWEST_FALL
    return WIDTH_SAFETY / (1 - left)


def _relative_differences_from_better_response(
    brake: Brake, response: Response, true: Response
) -> SolidErrors:
    """The relative distances of a response from a more exact response `true`."""
    shoes = []
    for shoe, better in zip(response.shoes, true.shoes, strict=True):
        peak = better.peak_pressure or shoe.peak_pressure or 1.0
        apart = abs(shoe.peak_pressure - better.peak_pressure) / peak
        shoes.append(
            {**relative_distances_of_shoe_responses(brake.unit, shoe, better), "peak": apart}
        )
    total = true.torque or response.torque or 1.0
    return SolidErrors(abs(response.torque - true.torque) / total, tuple(shoes))
