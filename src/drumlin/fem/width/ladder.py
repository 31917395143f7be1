"""A brake with widths solved to a tolerance: a level of the section and a degree across the width.

The error has two parts, which are chosen and stated one by one and then added up.

- The section's part is that of plane stress, which is solved on finer and finer levels until half
  of the tolerance is met. With a width the pressure has the same singular points in the section.
  The coarsest level is taken whose answer is within that half, by its distance from the answer of
  the last level plus the error stated for this last answer.
- The width's part comes from a coarse section, on which further degrees cost little. It is the
  larger of the distances from the degree q to the degrees q + 1 and q + 2 there, times
  WIDTH_SAFETY. The smallest degree that meets the other half of the tolerance is taken. The next
  degree alone would not tell the error, since even and odd degrees fall at different rates.

The estimate holds for parts of one width. Where a part overhangs another part, a finer section asks
for higher degrees beside the web: on three of seven such brakes the stated error was 0.3 to 0.9 of
the true error.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import NamedTuple

from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake
from drumlin.fem.error_control.adapt import Tolerance, solve_to_tolerance
from drumlin.fem.error_control.estimate import QUANTITIES, Errors
from drumlin.fem.error_control.levels import LEVELS, SolvedLevel, solved_levels
from drumlin.fem.error_control.singular_points import singular_points_of
from drumlin.fem.hp.division import Level
from drumlin.fem.model import PENALTY, solve_prepared_model
from drumlin.fem.preparation.cache import Cache
from drumlin.fem.width.error import (
    WIDTH_DEGREE,
    CoarseSection,
    coarse_section,
    shoe_distance,
)
from drumlin.fem.width.prepare import LARGEST_WIDTH_DEGREE, prepare_width
from drumlin.response.response import Response

WIDTH_SAFETY = 3.0
"""Safety factor of the width's part of the error.

It multiplies the distance of a degree from the next two degrees on a coarse section. The error
falls as a power of the degree, about q^-1.5 where a side is free, so that degrees 3 and 5 differ by
half of the error of degree 3. With a factor of 2 the error of the torque of the main brake is
stated a tenth too small.
"""
LOOKED_AHEAD = 2
"""Number of further degrees across the width that give the error of a degree: one even, one odd."""


class SolidErrors(NamedTuple):
    """Relative errors of the `torque` of a brake, and of each of its shoes.

    `shoes` has the errors of each shoe by the names in QUANTITIES.
    """

    torque: float
    shoes: tuple[dict[str, float], ...]

    def meets(self, tolerance: Tolerance) -> bool:
        """Whether the errors of all mean pressures and of the torque are within a tolerance."""
        pressure = max(shoe["pressure"] for shoe in self.shoes)
        return pressure <= tolerance.pressure and self.torque <= tolerance.torque

    def plus(self, other: "SolidErrors") -> "SolidErrors":
        """The sum of these errors and of `other` errors.

        The error of a peak pressure is at most 1, which means that it is unknown.
        """
        shoes = []
        for one, two in zip(self.shoes, other.shoes, strict=True):
            both = {name: one[name] + two[name] for name in QUANTITIES}
            shoes.append(both | {"peak": min(both["peak"], 1.0)})
        return SolidErrors(self.torque + other.torque, tuple(shoes))

    def times(self, factor: float) -> "SolidErrors":
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


def solve_with_widths(
    brake: Brake,
    tolerance: Tolerance,
    *,
    must: bool = True,
    penalty: float = PENALTY,
    cache: Cache | None = None,
) -> Response:
    """The response of a brake with widths, whose estimated errors meet a tolerance.

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

    def recorded() -> Iterator[SolvedLevel]:
        """Yield the levels of a solve by plane stress, and append each one to `climbed`."""
        for step in solved_levels(brake, answer, cache):
            climbed.append(step)
            yield step

    plane = solve_to_tolerance(
        brake, half, answer, must=False, cache=cache, levels=recorded()
    ).response
    coarse = coarse_section(brake, plane, penalty=penalty, cache=cache)
    sections = _sections(brake, coarse, climbed, plane)
    width = chosen_degree(brake, plane, coarse, half, penalty=penalty, cache=cache)
    if must and not (width.error.meets(half) and sections[-1].error.meets(half)):
        raise NoAnswer(_reached_text(tolerance, sections[-1].error.plus(width.error), width.degree))
    section = next((each for each in sections if each.error.meets(half)), sections[-1])
    points = singular_points_of(brake, plane, error=section.level.error)
    scene = prepare_width(brake, section.level, width.degree, points, cache=cache)
    response = answer(scene, brake, start=plane)
    warnings = [line for line in plane.notes if line.startswith("warning: tolerance")]
    unknowns = max(body.unknowns for body in scene.bodies)
    how = (
        f"degree {width.degree} across the width on a section of degree {section.level.degree}, "
        f"with {unknowns} unknowns a shoe"
    )
    found = section.error.plus(width.error)
    return replace(
        response,
        shoes=tuple(
            replace(shoe, error=own) for shoe, own in zip(response.shoes, found.shoes, strict=True)
        ),
        error=Errors.worst(found.torque, found.shoes).brake,
        notes=(*response.notes, *warnings, how),
    )


def _sections(
    brake: Brake, coarse: CoarseSection, climbed: Sequence[SolvedLevel], last: Response
) -> list[_Section]:
    """The levels of the section by plane stress, from the coarsest on, each with its error.

    Parameters
    ----------
    brake : the brake
    coarse : coarse section of the brake
    climbed : the levels of the solve by plane stress
    last : the answer of this solve, with its stated errors
    """
    stated = SolidErrors(
        (last.error or {})["torque"], tuple(dict(s.error or {}) for s in last.shoes)
    )
    degrees = {level.degree: level for level in LEVELS}
    error = _errors_from(brake, coarse.plane, last).plus(stated)
    found = [_Section(coarse.level, coarse.plane, error)]
    for step in climbed[:-1]:
        level = degrees[step.scene.bodies[0].line.order]
        error = _errors_from(brake, step.response, last).plus(stated)
        found.append(_Section(level, step.response, error))
    final = degrees[last.shoes[0].order]
    return [*found, _Section(final, last, stated)]


def _reached_text(tolerance: Tolerance, error: SolidErrors, degree: int) -> str:
    """The text on a tolerance that the finest section and the largest degree do not reach."""
    pressure = max(shoe["pressure"] for shoe in error.shoes)
    return (
        f"tolerance {tolerance.pressure:g} not reached with degree {degree} across the width: "
        f"estimated error of p {pressure:.1e}, of the torque {error.torque:.1e}"
    )


def chosen_degree(
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
    section : coarse section of the brake
    tolerance : relative errors that are allowed for the width's part
    penalty : factor alpha of the contact stiffness alpha E/t (lining modulus E, thickness t)
    cache : substructures of earlier solves
    """
    answers: dict[int, Response] = {}

    def coarse(degree: int) -> Response:
        """The answer of a degree across the width on the coarse section."""
        if degree not in answers:
            scene = prepare_width(brake, section.level, degree, section.points, cache=cache)
            answers[degree] = solve_prepared_model(scene, brake, penalty=penalty, start=plane)
        return answers[degree]

    last = LARGEST_WIDTH_DEGREE - LOOKED_AHEAD
    for degree in range(WIDTH_DEGREE, last + 1):
        further = [coarse(degree + k) for k in range(1, LOOKED_AHEAD + 1)]
        found = _degree_error(brake, degree, coarse(degree), further)
        if found.error.meets(tolerance):
            return found
    return found


def _degree_error(
    brake: Brake, degree: int, response: Response, further: list[Response]
) -> DegreeError:
    """The width's part of the error of a degree, from its answer and those of further degrees."""
    moved = [_errors_from(brake, response, other) for other in further]
    shoes = []
    for own in zip(*(each.shoes for each in moved), strict=True):
        shoes.append({name: max(each[name] for each in own) for name in QUANTITIES})
    largest = SolidErrors(max(each.torque for each in moved), tuple(shoes))
    return DegreeError(degree, largest.times(WIDTH_SAFETY))


def _errors_from(brake: Brake, response: Response, true: Response) -> SolidErrors:
    """The relative distances of a response from a more exact response `true`."""
    shoes = []
    for shoe, better in zip(response.shoes, true.shoes, strict=True):
        peak = better.peak_pressure or shoe.peak_pressure or 1.0
        apart = abs(shoe.peak_pressure - better.peak_pressure) / peak
        shoes.append({**shoe_distance(brake.unit, shoe, better), "peak": apart})
    total = true.torque or response.torque or 1.0
    return SolidErrors(abs(response.torque - true.torque) / total, tuple(shoes))
