"""A brake with widths solved to a tolerance: a level of the section and a degree across the width.

The error has two parts, which are chosen and stated one by one and then added up.

- The section's part is that of a low degree across the width, which is solved on finer and finer
  levels until SECTION_SHARE of the tolerance is met. For shoes of one width the degree is 0, plane
  stress; for shoes of several widths it is SECTION_DEGREE, and the error is multiplied by the
  factors of SOLID_FACTORS for a section. The coarsest level is taken whose answer is within the
  share, by its distance from the answer of the last level plus the error stated for this last
  answer.
- The width's part may take what the section's part leaves of the tolerance. It comes from one
  section for all degrees: a coarse one, on which degrees cost little, or the first level of a solve
  where a shoe has parts of several widths. The larger of the distances from the degree q to the
  degrees q + 1 and q + 2 there is extrapolated to all degrees. The smallest degree that meets the
  rest of the tolerance is taken. The next degree alone would not tell the error, since even and odd
  degrees fall at different rates.

The error e falls as a power of the degree where a side of the shoe is free or a part overhangs
another part. From e(q) = C q^-k follows e(q) = d / (1 - (q/(q + 2))^k) with the distance
d = e(q) - e(q + 2). The estimate is this e(q) times a factor of SOLID_FACTORS: that of pressures,
or the larger one of forces, whose distances cancel by accident. Its power k is SLOWEST_FALL and not
the power that the degrees show, because the distances of few degrees scatter. With k = 1 the
distance is multiplied by (q + 2)/2.

A finer section asks for higher degrees beside a web, where the pressure changes fast across the
width and along it. With distances from the coarse section the estimate without its safety factor
would be below the true error in 8 % of 106 cases, at worst 0.44 of it (17 brakes, "free" from 2000
and "built" of `drumlin_studies.solid_error`).

The contact of a shoe with widths ends elsewhere than that of plane stress. So each level is divided
anew with small elements at the ends that the model with the widths has found, until they no longer
move. With elements for the ends of plane stress, the first two levels of one random brake ("free"
2000 of `drumlin_studies.solid_error`) differ by 3.7 % of the pressure, and else by 0.23 %.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import NamedTuple

from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake
from drumlin.fem.error_control.adapt import Tolerance, solve_brake_to_tolerance
from drumlin.fem.error_control.estimate import QUANTITIES, Errors, read_safety_factors
from drumlin.fem.error_control.levels import (
    LEVELS,
    ResponseFunction,
    SolvedLevel,
    solve_on_finer_and_finer_levels,
)
from drumlin.fem.hp.division import Level, ShoeDivision
from drumlin.fem.model import PENALTY, solve_prepared_model
from drumlin.fem.preparation.cache import Cache
from drumlin.fem.preparation.columns import PointsByShape
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.fem.width.error import (
    WIDTH_DEGREE,
    plane_stress_solution_on_coarse_division,
    relative_distances_of_shoe_responses,
)
from drumlin.fem.width.functions import has_several_widths
from drumlin.fem.width.prepare import (
    LARGEST_WIDTH_DEGREE,
    MakeFunctions,
    prepare_brake_with_widths,
    prepare_divided_brake_with_widths,
)
from drumlin.response.response import Response

SLOWEST_FALL = 1.0
"""Power k of the degree by which the width's part of the error is assumed to fall, as q^-k.

Polynomials of degree q up to a singularity r^a of the displacements leave an error of q^-2a in the
energy norm (Babuska, Szabo & Katz 1981, SIAM J. Numer. Anal. 18, 515). The strongest singularity at
a corner has a = 1/2, and so k = 1. A larger k states errors smaller, a smaller k larger. On 17
random brakes of several widths the smallest stated over true error without a safety factor is 1.6
with k = 1, and 1.2 with k = 1.5.
"""
SECTION_DEGREE = 1
"""Degree across the width with which the section's error is estimated for several widths.

It has the bending of a table over its web as straight lines. On ten random brakes ("built" 3100 to
3117 of `drumlin_studies.solid_error`) the first two levels differ by 0.2 to 2.3 times as much of
the pressure with degree 1 as with degree 2, and in the median by 0.9 times. In plane stress they
differ by up to 9.5 times less. With degree 2 the second level takes 5 times as long.
"""
MOST_SECTION_LEVELS = 2
"""Number of levels on which the section's error is estimated for shoes of several widths.

Where a lining lifts off beside a web, its contact ends at another angle at each distance from the
mid-plane, and no level has small elements at all of these ends. On such a brake ("built" 3201 of
`drumlin_studies.solid_error`) the error of the pressure falls from 0.5 % on the first level to
0.3 % on the third. A tolerance that must be reached may take one level more, on which a degree of
5 has some 300 000 unknowns.
"""
MOST_DEGREE = 5
"""Largest degree across several widths, if the tolerance need not be reached.

With degree 7 the shoe of MOST_SECTION_LEVELS takes 2 GB on the first level of the section.
"""
SECTION_SHARE = 0.5
"""Largest part of the tolerance for the section's error; the width's error may take the rest."""
LOOKED_AHEAD = 2
"""Number of further degrees across the width that give the error of a degree: one even, one odd."""
LARGEST_STATED_DEGREE = LARGEST_WIDTH_DEGREE - LOOKED_AHEAD
"""Largest degree across the width whose error can be stated."""


class SolidFactors(NamedTuple):
    """The safety factors of the stated errors of solid shoes; a force is a torque or a reaction.

    Attributes
    ----------
    pressure, force : of the width's part, relative to the extrapolated distance of degrees across
        the width
    section_pressure, section_force : of the section's part of shoes with several widths, relative
        to that of SECTION_DEGREE
    """

    pressure: float
    force: float
    section_pressure: float
    section_force: float


SOLID_FACTORS = SolidFactors(**read_safety_factors(Path(__file__).with_name("factors.json")))
"""The factors of the stated errors of solid shoes, which `make calibrate` fits.

The file factors.json says on which brakes they are fitted, and what each factor does.
"""


class ErrorFactors(NamedTuple):
    """Factors of the errors of pressures, and of forces: torques and reactions."""

    pressure: float
    force: float


class SolidErrors(NamedTuple):
    """Relative errors of the `torque` of a brake, and of each of its shoes.

    `shoes` has the errors of each shoe by the names in QUANTITIES.
    """

    torque: float
    shoes: tuple[dict[str, float], ...]

    @property
    def largest_pressure_error(self) -> float:
        """The largest error of the mean pressure of a shoe."""
        return max(shoe["pressure"] for shoe in self.shoes)

    @property
    def as_tolerance(self) -> Tolerance:
        """The tolerance that these errors just meet."""
        return Tolerance(self.largest_pressure_error, self.torque)

    def is_within_error_tolerance(self, tolerance: Tolerance) -> bool:
        """Whether the errors of all mean pressures and of the torque are within a tolerance."""
        return self.largest_pressure_error <= tolerance.pressure and self.torque <= tolerance.torque

    def sum_with_other_errors(self, other: "SolidErrors") -> "SolidErrors":
        """The sum of these errors and of `other` errors.

        The error of a peak pressure is at most 1, which means that it is unknown.
        """
        shoes = []
        for one, two in zip(self.shoes, other.shoes, strict=True):
            both = {name: one[name] + two[name] for name in QUANTITIES}
            shoes.append(both | {"peak": min(both["peak"], 1.0)})
        return SolidErrors(self.torque + other.torque, tuple(shoes))

    def errors_times_factors(self, factors: ErrorFactors) -> "SolidErrors":
        """The errors of pressures and those of torques and reactions, each times its factor."""
        by_name = dict.fromkeys(QUANTITIES, factors.force)
        by_name |= {"pressure": factors.pressure, "peak": factors.pressure}
        shoes = [{name: by_name[name] * own for name, own in shoe.items()} for shoe in self.shoes]
        return SolidErrors(factors.force * self.torque, tuple(shoes))


class SectionError(NamedTuple):
    """A level of the section, and the section's part of the error on this level."""

    level: Level
    error: SolidErrors


class ComparedSection(NamedTuple):
    """The section on which degrees across the width are compared.

    `divisions` are its divisions into hp elements by the position of the first shoe of each shape,
    and `answers` are answers on them that are known already, by degree.
    """

    divisions: Mapping[int, ShoeDivision]
    answers: Mapping[int, Response]


class LevelClimb(NamedTuple):
    """The levels of a solve, and the answer of the last one with its stated errors."""

    levels: list[SolvedLevel]
    response: Response


class DegreeError(NamedTuple):
    """A degree across the width, the width's part of its error, and the answer on the section.

    The section is the one on which degrees are compared.
    """

    degree: int
    error: SolidErrors
    response: Response


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
    across: int | None = None,
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
    across : degree across the width; None: the smallest one that meets the tolerance
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
    share = Tolerance(SECTION_SHARE * tolerance.pressure, SECTION_SHARE * tolerance.torque)
    cache = cache or Cache()
    answer = partial(solve_prepared_model, penalty=penalty)
    climb = climb_levels_to_tolerance(brake, share, answer, cache)
    plane, factors = climb.response, ErrorFactors(1.0, 1.0)
    largest_degree = LARGEST_STATED_DEGREE
    if has_several_widths_on_any_shoe(brake):
        factors = ErrorFactors(SOLID_FACTORS.section_pressure, SOLID_FACTORS.section_force)
        asked = Tolerance(share.pressure / factors.pressure, share.torque / factors.force)
        levels = LEVELS[: MOST_SECTION_LEVELS + 1] if must else LEVELS[:MOST_SECTION_LEVELS]
        climb = climb_levels_to_tolerance(brake, asked, answer, cache, levels, plane)
        if not must:
            largest_degree = MOST_DEGREE
    section = coarsest_level_within_tolerance(brake, climb, share, factors)
    compared = section_to_compare_width_degrees(brake, plane, penalty=penalty, cache=cache)
    left = Tolerance(
        max(tolerance.pressure - section.error.largest_pressure_error, share.pressure),
        max(tolerance.torque - section.error.torque, share.torque),
    )
    degrees = range(WIDTH_DEGREE, largest_degree + 1) if across is None else (across,)
    width = smallest_width_degree_within_tolerance(
        brake, plane, compared, left, degrees, penalty=penalty, cache=cache
    )
    if not width.error.is_within_error_tolerance(left):
        # A section that is finer than the degree across the width deserves would be lost work.
        section = coarsest_level_within_tolerance(brake, climb, width.error.as_tolerance, factors)
    found = section.error.sum_with_other_errors(width.error)
    warning = ""
    if not found.is_within_error_tolerance(tolerance):
        warning = _message_on_unreached_error_tolerance(tolerance, found, width.degree)
        if must:
            raise NoAnswer(warning)
    solved = solve_level_of_section_with_width_degree(
        brake, section.level, width.degree, width.response, penalty=penalty, cache=cache
    )
    return _solved_level_with_errors_and_notes(solved, section.level, width.degree, found, warning)


def solve_level_of_section_with_width_degree(
    brake: Brake,
    level: Level,
    degree: int | MakeFunctions,
    start: Response,
    *,
    penalty: float = PENALTY,
    cache: Cache | None = None,
) -> SolvedLevel:
    """The answer of a brake with widths on one level of the section, whose contact it has found.

    The level is divided anew until the ends of the contact no longer move.

    Parameters
    ----------
    brake : the brake
    level : degree and grading of the hp elements of the section
    degree : degree across the width, or a function from a shoe to its functions across the width
    start : an earlier answer, whose contact the first division is made for
    penalty : factor alpha of the contact stiffness alpha E/t (lining modulus E, thickness t)
    cache : substructures of earlier solves

    Raises
    ------
    NoAnswer
        where the level has no answer
    """

    def prepare(divided: Level, points: PointsByShape) -> PreparedModel:
        """The prepared model of a division with elements for these singular points."""
        return prepare_brake_with_widths(brake, divided, degree, points, cache=cache)

    answer = partial(solve_prepared_model, penalty=penalty)
    steps = solve_on_finer_and_finer_levels(
        brake, answer, cache, [level], prepare=prepare, start=start
    )
    for solved in steps:
        return solved
    raise NoAnswer(f"no equilibrium on a section of degree {level.degree} with its width")


def _solved_level_with_errors_and_notes(
    solved: SolvedLevel, level: Level, degree: int, found: SolidErrors, warning: str
) -> SolvedLevel:
    """A solved level whose answer has its errors, a warning if need be, and a note on the degrees.

    Parameters
    ----------
    solved : the answer with widths, and its prepared model
    level : level of the section
    degree : degree across the width
    found : stated errors of the answer
    warning : text on a tolerance that is not reached; empty if it is reached
    """
    response = solved.response
    warnings = [f"warning: {warning}"] if warning else []
    unknowns = max(body.unknowns for body in solved.scene.bodies)
    how = (
        f"degree {degree} across the width on a section of degree {level.degree}, "
        f"with {unknowns} unknowns a shoe"
    )
    shoes = zip(response.shoes, found.shoes, strict=True)
    stated = replace(
        response,
        shoes=tuple(replace(shoe, error=own) for shoe, own in shoes),
        error=Errors.brake_errors_from_torque_and_shoe_errors(found.torque, found.shoes).brake,
        notes=(*response.notes, *warnings, how),
    )
    return SolvedLevel(solved.scene, stated)


def climb_levels_to_tolerance(
    brake: Brake,
    tolerance: Tolerance,
    answer: ResponseFunction,
    cache: Cache,
    levels: Sequence[Level] = (),
    start: Response | None = None,
) -> LevelClimb:
    """The levels of a solve by plane stress, or with SECTION_DEGREE, up to a tolerance.

    Parameters
    ----------
    brake : the brake
    tolerance : relative errors that are allowed
    answer : function that computes the response on a prepared model
    cache : substructures of earlier solves
    levels : levels of a solve with SECTION_DEGREE across the width; none for plane stress
    start : an earlier answer, whose contact the first division is made for

    Raises
    ------
    NoAnswer
        if no two levels have answers
    """

    def prepare(level: Level, points: PointsByShape) -> PreparedModel:
        """The prepared model of a division with SECTION_DEGREE across the width."""
        return prepare_brake_with_widths(brake, level, SECTION_DEGREE, points, cache=cache)

    climbed: list[SolvedLevel] = []

    def solved_levels_that_are_kept() -> Iterator[SolvedLevel]:
        """Yield the levels of the solve, and append each one to `climbed`."""
        steps = solve_on_finer_and_finer_levels(
            brake, answer, cache, levels, prepare=prepare if levels else None, start=start
        )
        for step in steps:
            climbed.append(step)
            yield step

    last = solve_brake_to_tolerance(
        brake, tolerance, answer, must=False, levels=solved_levels_that_are_kept()
    )
    return LevelClimb(climbed, last.response)


def coarsest_level_within_tolerance(
    brake: Brake,
    climb: LevelClimb,
    tolerance: Tolerance,
    factors: ErrorFactors,
) -> SectionError:
    """The coarsest level of a climb whose error is within a tolerance, else the last level.

    Parameters
    ----------
    brake : the brake
    climb : the levels
    tolerance : relative errors that are allowed for the section's part
    factors : safety factors of the errors
    """
    last = climb.response
    stated = SolidErrors(
        (last.error or {})["torque"], tuple(dict(shoe.error or {}) for shoe in last.shoes)
    )
    by_degree = {level.degree: level for level in LEVELS}
    sections = []
    for step in climb.levels:
        moved = _relative_differences_from_better_response(brake, step.response, last)
        error = moved.sum_with_other_errors(stated).errors_times_factors(factors)
        sections.append(SectionError(by_degree[step.response.shoes[0].order], error))
    within = (each for each in sections if each.error.is_within_error_tolerance(tolerance))
    return next(within, sections[-1])


def has_several_widths_on_any_shoe(brake: Brake) -> bool:
    """Whether a shoe of the brake has parts of several widths."""
    return any(has_several_widths(shoe) for shoe in brake.shoes)


def _message_on_unreached_error_tolerance(
    tolerance: Tolerance, error: SolidErrors, degree: int
) -> str:
    """The text on a tolerance that the finest section and the largest degree do not reach."""
    pressure = error.largest_pressure_error
    return (
        f"tolerance {tolerance.pressure:g} not reached with degree {degree} across the width: "
        f"estimated error of p {pressure:.1e}, of the torque {error.torque:.1e}"
    )


def section_to_compare_width_degrees(
    brake: Brake, plane: Response, *, penalty: float = PENALTY, cache: Cache | None = None
) -> ComparedSection:
    """The section on which degrees across the width are compared, by the widths of the shoes.

    Shoes of one width have the coarse section. A brake with a shoe of several widths has the first
    level of a solve, because the coarse section shows too little of the error beside a web. This
    level has small elements at the ends of the contact with degree WIDTH_DEGREE across the width.

    Parameters
    ----------
    brake : the brake
    plane : answer of plane stress, whose contact grades the section
    penalty : factor alpha of the contact stiffness alpha E/t (lining modulus E, thickness t)
    cache : substructures of earlier solves

    Raises
    ------
    NoAnswer
        on the first level, where plane stress (shoes of one width) or the brake with its widths has
        no answer
    """
    if not has_several_widths_on_any_shoe(brake):
        coarse = plane_stress_solution_on_coarse_division(
            brake, plane, penalty=penalty, cache=cache
        )
        return ComparedSection(coarse.divisions, {})
    wide = solve_level_of_section_with_width_degree(
        brake, LEVELS[0], WIDTH_DEGREE, plane, penalty=penalty, cache=cache
    )
    return ComparedSection(wide.scene.divisions, {WIDTH_DEGREE: wide.response})


def smallest_width_degree_within_tolerance(
    brake: Brake,
    plane: Response,
    section: ComparedSection,
    tolerance: Tolerance,
    degrees: Sequence[int] = range(WIDTH_DEGREE, LARGEST_STATED_DEGREE + 1),
    *,
    penalty: float = PENALTY,
    cache: Cache | None = None,
) -> DegreeError:
    """The smallest degree across the width that meets a tolerance, with its error.

    If no degree meets the tolerance, the last degree whose error can be estimated is returned.

    Parameters
    ----------
    brake : the brake
    plane : answer of plane stress
    section : the section of the brake on which degrees are compared, see
        `section_to_compare_width_degrees`
    tolerance : relative errors that are allowed for the width's part
    degrees : degrees that are tried, in this order
    penalty : factor alpha of the contact stiffness alpha E/t (lining modulus E, thickness t)
    cache : substructures of earlier solves
    """
    answers = dict(section.answers)

    def solve_with_degree_across_width(degree: int) -> Response:
        """The answer of a degree across the width on the section."""
        if degree not in answers:
            scene = prepare_divided_brake_with_widths(brake, section.divisions, degree, cache=cache)
            answers[degree] = solve_prepared_model(scene, brake, penalty=penalty, start=plane)
        return answers[degree]

    found: DegreeError | None = None
    for degree in degrees:
        try:
            ahead = range(degree + 1, degree + LOOKED_AHEAD + 1)
            further = [solve_with_degree_across_width(each) for each in ahead]
            response = solve_with_degree_across_width(degree)
        except NoAnswer:
            # A further degree may have too many contact nodes or no equilibrium.
            if found is None:
                raise
            break
        found = _error_of_degree_across_width(brake, degree, response, further)
        if found.error.is_within_error_tolerance(tolerance):
            break
    assert found is not None
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
    falls = extrapolated_over_largest_distance(degree)
    factors = ErrorFactors(falls * SOLID_FACTORS.pressure, falls * SOLID_FACTORS.force)
    error = largest.errors_times_factors(factors)
    return DegreeError(degree, error, response)


def extrapolated_over_largest_distance(degree: int) -> float:
    """The extrapolated error of a degree, over its distance from the next LOOKED_AHEAD degrees."""
    left = (degree / (degree + LOOKED_AHEAD)) ** SLOWEST_FALL
    return 1 / (1 - left)


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
