"""Solve a brake with widths to a tolerance: choose hp elements and a degree across the width.

The section of a shoe is divided into hp elements on one of the levels of a solve; across the width
the displacements are polynomials of z of some degree. The error has two parts, which are estimated
one by one and then added up: the section's error, due to the hp elements, and the width's error,
due to the degree across the width.

- For the section's error the brake is solved with a low degree across the width on finer and finer
  levels, until the error is at most SECTION_SHARE of the tolerance. If all parts of each shoe have
  one width, the degree is 0, plane stress. Else the degree is SECTION_DEGREE, and the error is
  multiplied by the safety factors `section_pressure` and `section_force`. The error of a coarser
  level is the distance of its answer from the answer of the last level, plus the stated error of
  the last answer. The coarsest level whose error is within the share is chosen.
- The width's error may be as large as the rest of the tolerance. Degrees are compared on the same
  hp elements: coarse ones, on which degrees cost little, or the first level of a solve if a shoe
  has parts of several widths. There the distances of the answer with the degree q from the answers
  with the degrees q + 1 and q + 2 are computed. The next degree alone would not show the error,
  since the errors of even and of odd degrees fall at different rates. The larger distance is
  extrapolated to an infinite degree. The smallest degree whose error is within the rest of the
  tolerance is chosen.

The width's error e falls as a power of the degree where a side of the shoe is free or a part
overhangs another part. From e(q) = C q^-k follows e(q) = d / (1 - (q/(q + 2))^k) with the distance
d = e(q) - e(q + 2). The estimate is this e(q) times a safety factor of SOLID_FACTORS. The factor of
forces is larger than the factor of pressures, because the distances of forces may cancel by
accident. The power k is SLOWEST_FALL. It is not fitted to the distances of a brake, because the
distances of few degrees scatter. With k = 1 the distance is multiplied by (q + 2)/2.

Beside a web the pressure changes fast across the width and along it, so that smaller elements need
higher degrees there. Had the distances been computed on coarse elements, the estimate without its
safety factor would be smaller than the true error in 8 % of 106 cases, and in the worst case 0.44
of the true error (17 brakes, "free" from 2000 and "built" of `drumlin_studies.solid_error`).

With widths the contact of a shoe ends at other angles than in plane stress. So each level is
divided anew with small elements at the ends of the contact of the model with widths, until these
ends no longer move. On one random brake ("free" 2000 of `drumlin_studies.solid_error`) the
pressures of the first two levels differ by 0.23 %. They differ by 3.7 % if the small elements lie
at the ends of the contact in plane stress.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import NamedTuple

from drumlin.base.errors import NoAnswer
from drumlin.base.texts import error_text_in_percent
from drumlin.brake.brake import Brake
from drumlin.fem.error_control.adapt import Tolerance, solve_brake_to_tolerance
from drumlin.fem.error_control.estimate import QUANTITIES, Errors, read_safety_factors
from drumlin.fem.error_control.levels import (
    LEVELS,
    ResponseFunction,
    SolvedLevel,
    solve_brake_on_finer_and_finer_mesh_levels,
)
from drumlin.fem.hp.division import Level, ShoeDivision
from drumlin.fem.model import PENALTY, solve_prepared_model
from drumlin.fem.preparation.cache import Cache
from drumlin.fem.preparation.scene import PointsByShape, PreparedModel
from drumlin.fem.width.error import (
    WIDTH_DEGREE,
    plane_stress_solution_on_coarse_hp_elements,
    relative_distances_of_shoe_responses,
)
from drumlin.fem.width.functions import has_parts_of_different_widths
from drumlin.fem.width.prepare import (
    LARGEST_WIDTH_DEGREE,
    MakeFunctions,
    prepare_model_with_shoe_widths,
    prepare_model_with_widths_on_given_elements,
)
from drumlin.response.response import Response

SLOWEST_FALL = 1.0
"""Assumed power k with which the error due to the degree q across the width falls, as q^-k.

Where the displacements have a singularity r^a, polynomials of degree q leave an error of q^-2a in
the energy norm (Babuska, Szabo & Katz 1981, SIAM J. Numer. Anal. 18, 515). The strongest
singularity at a corner has a = 1/2, and so k = 1. A larger k makes stated errors smaller, a smaller
k makes them larger. On 17 random brakes with parts of several widths the smallest ratio of the
stated error, without a safety factor, to the true error is 1.6 with k = 1, and 1.2 with k = 1.5.
On coarse elements of 21 random brakes with the breaks of `functions.BESIDE_WEB` the smallest ratio
with k = 1 is 1.6 for the pressure and 1.3 for forces, with the degrees 2 and 3.
"""
SECTION_DEGREE = 1
"""Degree across the width for the estimate of the hp elements' error if parts have several widths.

Degree 1 represents the bending of a table over its web by straight lines. The error is estimated
from the distance of the pressures on two levels. On ten random brakes ("built" 3100 to 3117 of
`drumlin_studies.solid_error`) the distance of the first two levels with degree 1 is 0.2 to 2.3
times the distance with degree 2 (median 0.9). In plane stress it may be 9.5 times smaller than with
degree 2, and would not show the error. With degree 2 the second level takes 5 times as long as with
degree 1.
"""
MOST_SECTION_LEVELS = 2
"""Number of levels on which the hp elements' error is estimated if parts have several widths.

Where a lining lifts off beside a web, its contact ends at another angle at each distance from the
mid-plane, and no level has small elements at all of these ends. On such a brake ("built" 3201 of
`drumlin_studies.solid_error`) the error of the pressure falls only from 0.5 % on the first level to
0.3 % on the third level. If a tolerance must be reached, one more level is allowed; with degree 5
across the width it has some 300 000 unknowns. The level is allowed as well if the last one has at
most LARGEST_SECTION unknowns.
"""
LARGEST_SECTION = 9_000
"""Unknowns of a shoe, with SECTION_DEGREE across the width, up to which one more level is allowed.

Short contacts have few columns of elements. On one random brake with 8900 unknowns ("free" 510007
of `drumlin_studies.solid_error`) the stated error of p falls from 3.2 to 0.84 %. With degree 4
across the width the third level then has 101 000 unknowns, and the process takes 1.1 GB. With a
larger limit solves take more memory, with a smaller limit the error of short contacts stays larger.
"""
MOST_DEGREE = 5
"""Largest degree across the width for parts of several widths, if a tolerance may be missed.

If the tolerance must be met, LARGEST_STATED_DEGREE is the limit. With degree 7 the brake "built"
3201 of `drumlin_studies.solid_error` takes 2 GB on the first level.
"""
SECTION_SHARE = 0.5
"""Fraction of the tolerance for the error of the section's hp elements.

The error due to the degree across the width may take the rest of the tolerance.
"""
LEAST_WIDTH_SHARE = 0.2
"""Smallest fraction of the tolerance to which the error of the width is brought.

An error of the section above SECTION_SHARE is made up for by a higher degree, as long as the
section leaves this fraction to the width. With a smaller fraction degrees are raised in vain where
the error of the width falls slowly.
"""
LOOKED_AHEAD = 2
"""Number of higher degrees across the width whose answers give the error of a degree.

Of the two next higher degrees one is even and the other odd.
"""
LARGEST_STATED_DEGREE = LARGEST_WIDTH_DEGREE - LOOKED_AHEAD
"""Largest degree across the width whose error can be stated.

The error follows from answers with the LOOKED_AHEAD next higher degrees, which must be allowed.
"""


class SolidFactors(NamedTuple):
    """Safety factors of the errors stated for shoes with widths.

    The factors `force` hold for torques and reactions, the factors `pressure` for pressures.

    Attributes
    ----------
    pressure, force : of the error due to the degree across the width, relative to the extrapolated
        distance between degrees
    section_pressure, section_force : of the error of the section's hp elements if parts have
        several widths, relative to the error estimated with SECTION_DEGREE across the width
    """

    pressure: float
    force: float
    section_pressure: float
    section_force: float


SOLID_FACTORS = SolidFactors(**read_safety_factors(Path(__file__).with_name("factors.json")))
"""Safety factors of the errors stated for shoes with widths, fitted by `make calibrate`.

The file factors.json says to which brakes they are fitted, and what each factor does.
"""


class ErrorFactors(NamedTuple):
    """Two factors by which errors are multiplied.

    `pressure` multiplies errors of pressures, and `force` multiplies errors of torques and
    reactions.
    """

    pressure: float
    force: float


class SolidErrors(NamedTuple):
    """Relative errors of a brake's `torque`, and relative errors of each of its shoes.

    `shoes` has the errors of each shoe by the names in QUANTITIES.
    """

    torque: float
    shoes: tuple[dict[str, float], ...]

    @property
    def largest_pressure_error(self) -> float:
        """The largest error of a shoe's pressure, which is averaged over the width."""
        return max(shoe["pressure"] for shoe in self.shoes)

    @property
    def smallest_tolerance_that_errors_meet(self) -> Tolerance:
        """The smallest tolerance that these errors meet: largest pressure error, torque error."""
        return Tolerance(self.largest_pressure_error, self.torque)

    def is_within_error_tolerance(self, tolerance: Tolerance) -> bool:
        """Whether the errors of the torque and of each shoe's pressure are within a tolerance."""
        return self.largest_pressure_error <= tolerance.pressure and self.torque <= tolerance.torque

    def sum_of_these_and_other_errors(self, other: "SolidErrors") -> "SolidErrors":
        """The sum of these errors and of `other` errors.

        The error of a peak pressure is limited to 1, which means that the error is unknown.
        """
        shoes = []
        for one, two in zip(self.shoes, other.shoes, strict=True):
            both = {name: one[name] + two[name] for name in QUANTITIES}
            shoes.append(both | {"peak": min(both["peak"], 1.0)})
        return SolidErrors(self.torque + other.torque, tuple(shoes))

    def errors_times_factors(self, factors: ErrorFactors) -> "SolidErrors":
        """These errors times factors: one factor for pressures, one for torques and reactions."""
        by_name = dict.fromkeys(QUANTITIES, factors.force)
        by_name |= {"pressure": factors.pressure, "peak": factors.pressure}
        shoes = [{name: by_name[name] * own for name, own in shoe.items()} for shoe in self.shoes]
        return SolidErrors(factors.force * self.torque, tuple(shoes))


class SectionError(NamedTuple):
    """A level of the section's hp elements, and the error that these elements make.

    The error due to the degree across the width is not contained.
    """

    level: Level
    error: SolidErrors


class ComparedSection(NamedTuple):
    """The hp elements of a brake's shoes on which degrees across the width are compared.

    `divisions` are the divisions of the shoes' sections into hp elements, by the index of the first
    shoe of each shape. `answers` are the answers that are already computed on these elements, by
    the degree across the width.
    """

    divisions: Mapping[int, ShoeDivision]
    answers: Mapping[int, Response]


class LevelClimb(NamedTuple):
    """The solved levels of a brake, from coarse to fine, and the answer with its stated errors.

    `response` is the answer on the last level.
    """

    levels: list[SolvedLevel]
    response: Response


class DegreeError(NamedTuple):
    """A degree across the width, the error due to this degree, and the answer with it.

    The answer is found on the hp elements on which degrees are compared.
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
    """Solve a brake with widths so that its estimated errors meet a tolerance.

    The parameters and the raised exceptions are those of `solve_brake_with_widths_and_keep_model`.
    """
    return solve_brake_with_widths_and_keep_model(
        brake, tolerance, must=must, penalty=penalty, cache=cache
    ).response


def solve_brake_with_widths_and_keep_model(
    brake: Brake,
    tolerance: Tolerance,
    *,
    must: bool = True,
    across: int | None = None,
    penalty: float = PENALTY,
    cache: Cache | None = None,
) -> SolvedLevel:
    """Solve a brake with widths to a tolerance; return the response with its prepared model.

    Parameters
    ----------
    brake : the brake
    tolerance : allowed relative errors of the pressure, averaged over the width, and of the torque
    must : whether NoAnswer is raised if the tolerance is not reached; otherwise the best answer is
        returned
    across : degree across the width; None for the smallest degree that meets the tolerance
    penalty : factor alpha of the contact stiffness alpha E/t (lining modulus E, thickness t)
    cache : substructures of earlier solves

    Raises
    ------
    NoAnswer
        if the brake has no answer in plane stress or none with widths, or if the tolerance must be
        reached and is not
    BadInput
        if the model of the width does not apply to the brake
    """
    share = Tolerance(SECTION_SHARE * tolerance.pressure, SECTION_SHARE * tolerance.torque)
    cache = cache or Cache()
    answer = partial(solve_prepared_model, penalty=penalty)
    climb = refine_cross_section_mesh_until_tolerance_is_met(brake, share, answer, cache)
    plane, factors = climb.response, ErrorFactors(1.0, 1.0)
    largest_degree = LARGEST_STATED_DEGREE
    if has_shoe_with_parts_of_different_widths(brake):
        factors = ErrorFactors(SOLID_FACTORS.section_pressure, SOLID_FACTORS.section_force)
        asked = Tolerance(share.pressure / factors.pressure, share.torque / factors.force)
        climb = refine_cross_section_mesh_until_tolerance_is_met(
            brake, asked, answer, cache, LEVELS[: MOST_SECTION_LEVELS + 1], plane, must=must
        )
        if not must:
            largest_degree = MOST_DEGREE
    section = coarsest_cross_section_mesh_within_tolerance(brake, climb, share, factors)
    compared = hp_elements_to_compare_width_degrees(brake, plane, penalty=penalty, cache=cache)
    left = Tolerance(
        _tolerance_left_for_width(tolerance.pressure, section.error.largest_pressure_error),
        _tolerance_left_for_width(tolerance.torque, section.error.torque),
    )
    degrees = range(WIDTH_DEGREE, largest_degree + 1) if across is None else (across,)
    width = smallest_width_degree_within_tolerance(
        brake, plane, compared, left, degrees, penalty=penalty, cache=cache
    )
    if not width.error.is_within_error_tolerance(left):
        # The hp elements need not be more exact than the degree across the width allows.
        section = coarsest_cross_section_mesh_within_tolerance(
            brake, climb, width.error.smallest_tolerance_that_errors_meet, factors
        )
    found = section.error.sum_of_these_and_other_errors(width.error)
    warning = ""
    if not found.is_within_error_tolerance(tolerance):
        warning = _message_on_unreached_error_tolerance(tolerance, found, width.degree)
        if must:
            raise NoAnswer(warning)
    solved = solve_cross_section_mesh_with_width_degree(
        brake, section.level, width.degree, width.response, penalty=penalty, cache=cache
    )
    return _solved_level_with_errors_and_notes(solved, section.level, width.degree, found, warning)


def _tolerance_left_for_width(tolerance: float, section_error: float) -> float:
    """The relative error that the degree across the width may make, beside the section's error.

    It is the rest of the tolerance. If the section leaves less than LEAST_WIDTH_SHARE of the
    tolerance, higher degrees would be tried for an error that is hardly reachable. The width then
    keeps its share of a solve within the tolerance, and the tolerance is mostly missed.
    """
    rest = tolerance - section_error
    return rest if rest >= LEAST_WIDTH_SHARE * tolerance else (1 - SECTION_SHARE) * tolerance


def solve_cross_section_mesh_with_width_degree(
    brake: Brake,
    level: Level,
    degree: int | MakeFunctions,
    start: Response,
    *,
    penalty: float = PENALTY,
    cache: Cache | None = None,
) -> SolvedLevel:
    """Solve a brake with widths on one level of hp elements, with a degree across the width.

    The shoes are divided anew until the ends of the contact no longer move.

    Parameters
    ----------
    brake : the brake
    level : degree of the section's hp elements, and their sizes at singular points
    degree : degree across the width, or a function from a shoe to its functions across the width
    start : an earlier answer; the first division has small elements at the ends of its contact
    penalty : factor alpha of the contact stiffness alpha E/t (lining modulus E, thickness t)
    cache : substructures of earlier solves

    Raises
    ------
    NoAnswer
        where the level has no answer
    """

    def prepare_model_with_width_degree(divided: Level, points: PointsByShape) -> PreparedModel:
        """The prepared model of the brake, with small elements at the singular points."""
        return prepare_model_with_shoe_widths(brake, divided, degree, points, cache=cache)

    answer = partial(solve_prepared_model, penalty=penalty)
    steps = solve_brake_on_finer_and_finer_mesh_levels(
        brake, answer, cache, [level], prepare=prepare_model_with_width_degree, start=start
    )
    for solved in steps:
        return solved
    raise NoAnswer(f"no equilibrium on a section of degree {level.degree} with its width")


def _solved_level_with_errors_and_notes(
    solved: SolvedLevel, level: Level, degree: int, found: SolidErrors, warning: str
) -> SolvedLevel:
    """Add to a solved level's answer its errors, a note on the degrees, and a warning if any.

    Parameters
    ----------
    solved : the answer with widths, and its prepared model
    level : level of the section's hp elements
    degree : degree across the width
    found : stated errors of the answer
    warning : text which says that the tolerance is not reached; empty if it is reached
    """
    response = solved.response
    warnings = [f"warning: {warning}"] if warning else []
    unknowns = max(body.unknowns for body in solved.prepared_model.bodies)
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
    return SolvedLevel(solved.prepared_model, stated)


def refine_cross_section_mesh_until_tolerance_is_met(
    brake: Brake,
    tolerance: Tolerance,
    answer: ResponseFunction,
    cache: Cache,
    levels: Sequence[Level] = (),
    start: Response | None = None,
    *,
    must: bool = True,
) -> LevelClimb:
    """Solve a brake on finer and finer levels, with a low degree across the width, to a tolerance.

    Parameters
    ----------
    brake : the brake
    tolerance : relative errors that are allowed
    answer : function that computes the response on a prepared model
    cache : substructures of earlier solves
    levels : levels of a solve with SECTION_DEGREE across the width; if empty, the brake is solved
        in plane stress on the levels LEVELS
    start : an earlier answer; the first division has small elements at the ends of its contact
    must : whether all `levels` are solved if the tolerance needs them; otherwise the climb ends on
        level MOST_SECTION_LEVELS if it has more than LARGEST_SECTION unknowns

    Raises
    ------
    NoAnswer
        if no two levels have answers
    """

    def prepare_model_with_width_degree(level: Level, points: PointsByShape) -> PreparedModel:
        """The prepared model of the brake on a level, with SECTION_DEGREE across the width."""
        return prepare_model_with_shoe_widths(brake, level, SECTION_DEGREE, points, cache=cache)

    climbed: list[SolvedLevel] = []

    def solve_levels_and_keep_each() -> Iterator[SolvedLevel]:
        """Yield the levels of the solve, and append each one to `climbed`."""
        steps = solve_brake_on_finer_and_finer_mesh_levels(
            brake,
            answer,
            cache,
            levels,
            prepare=prepare_model_with_width_degree if levels else None,
            start=start,
        )
        for step in steps:
            climbed.append(step)
            yield step
            unknowns = max(body.unknowns for body in step.prepared_model.bodies)
            is_large = len(climbed) >= MOST_SECTION_LEVELS and unknowns > LARGEST_SECTION
            if levels and is_large and not must:
                return

    last = solve_brake_to_tolerance(
        brake, tolerance, answer, must=False, levels=solve_levels_and_keep_each()
    )
    return LevelClimb(climbed, last.response)


def coarsest_cross_section_mesh_within_tolerance(
    brake: Brake,
    climb: LevelClimb,
    tolerance: Tolerance,
    factors: ErrorFactors,
) -> SectionError:
    """The coarsest solved level whose error is within a tolerance, or else the last level.

    Parameters
    ----------
    brake : the brake
    climb : the solved levels, from coarse to fine, and the answer of the last level
    tolerance : relative errors that the section's hp elements may make
    factors : safety factors by which the errors are multiplied
    """
    last = climb.response
    stated = SolidErrors(
        (last.error or {})["torque"], tuple(dict(shoe.error or {}) for shoe in last.shoes)
    )
    by_degree = {level.degree: level for level in LEVELS}
    sections = []
    for step in climb.levels:
        moved = _relative_differences_from_better_response(brake, step.response, last)
        error = moved.sum_of_these_and_other_errors(stated).errors_times_factors(factors)
        sections.append(SectionError(by_degree[step.response.shoes[0].order], error))
    within = (each for each in sections if each.error.is_within_error_tolerance(tolerance))
    return next(within, sections[-1])


def has_shoe_with_parts_of_different_widths(brake: Brake) -> bool:
    """Whether any shoe of the brake has parts that are wider than others."""
    return any(has_parts_of_different_widths(shoe) for shoe in brake.shoes)


def _message_on_unreached_error_tolerance(
    tolerance: Tolerance, error: SolidErrors, degree: int
) -> str:
    """The text which says that the finest elements and highest degree miss a tolerance."""
    pressure = error.largest_pressure_error
    return (
        f"tolerance {tolerance.pressure:g} not reached with degree {degree} across the width: "
        f"estimated error of p {error_text_in_percent(pressure)}, "
        f"of the torque {error_text_in_percent(error.torque)}"
    )


def hp_elements_to_compare_width_degrees(
    brake: Brake, plane: Response, *, penalty: float = PENALTY, cache: Cache | None = None
) -> ComparedSection:
    """The hp elements of the shoes on which degrees across the width are compared.

    If all parts of each shoe have one width, the elements are coarse. Otherwise the elements of the
    first level of a solve are taken, as coarse elements show too little of the error beside a web.
    This level is solved with degree WIDTH_DEGREE across the width, so that it has small elements at
    the ends of the contact with widths.

    Parameters
    ----------
    brake : the brake
    plane : answer of plane stress; the elements are small at the ends of its contact
    penalty : factor alpha of the contact stiffness alpha E/t (lining modulus E, thickness t)
    cache : substructures of earlier solves

    Raises
    ------
    NoAnswer
        if the brake has no answer on the first level: in plane stress for shoes of one width,
        otherwise with widths
    """
    if not has_shoe_with_parts_of_different_widths(brake):
        coarse = plane_stress_solution_on_coarse_hp_elements(
            brake, plane, penalty=penalty, cache=cache
        )
        return ComparedSection(coarse.divisions, {})
    wide = solve_cross_section_mesh_with_width_degree(
        brake, LEVELS[0], WIDTH_DEGREE, plane, penalty=penalty, cache=cache
    )
    return ComparedSection(wide.prepared_model.divisions, {WIDTH_DEGREE: wide.response})


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
    """The smallest degree across the width whose error meets a tolerance, with error and answer.

    If no degree meets the tolerance, the last degree whose error can be estimated is returned.

    Parameters
    ----------
    brake : the brake
    plane : answer of plane stress
    section : hp elements of the shoes on which degrees are compared, see
        `hp_elements_to_compare_width_degrees`
    tolerance : relative errors that the degree across the width may make
    degrees : degrees that are tried, in this order
    penalty : factor alpha of the contact stiffness alpha E/t (lining modulus E, thickness t)
    cache : substructures of earlier solves
    """
    answers = dict(section.answers)

    def solve_with_degree_across_width(degree: int) -> Response:
        """The answer of the brake with a degree across the width, on the given hp elements."""
        if degree not in answers:
            scene = prepare_model_with_widths_on_given_elements(
                brake, section.divisions, degree, cache=cache
            )
            answers[degree] = solve_prepared_model(scene, brake, penalty=penalty, start=plane)
        return answers[degree]

    found: DegreeError | None = None
    for degree in degrees:
        try:
            ahead = range(degree + 1, degree + LOOKED_AHEAD + 1)
            further = [solve_with_degree_across_width(each) for each in ahead]
            response = solve_with_degree_across_width(degree)
        except NoAnswer:
            # With a higher degree the brake may have too many contact nodes, or no equilibrium.
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
    """The error due to a degree across the width, from answers with this and with higher degrees.

    `response` is the answer with the degree, and `further` are answers with higher degrees.
    """
    moved = [
        _relative_differences_from_better_response(brake, response, other) for other in further
    ]
    shoes = []
    for own in zip(*(each.shoes for each in moved), strict=True):
        shoes.append({name: max(each[name] for each in own) for name in QUANTITIES})
    largest = SolidErrors(max(each.torque for each in moved), tuple(shoes))
    falls = error_divided_by_distance_to_next_degrees(degree)
    factors = ErrorFactors(falls * SOLID_FACTORS.pressure, falls * SOLID_FACTORS.force)
    error = largest.errors_times_factors(factors)
    return DegreeError(degree, error, response)


def error_divided_by_distance_to_next_degrees(degree: int) -> float:
    """The error of a degree across the width, divided by its distance from higher degrees.

    The distance is the larger of the distances between the answer with `degree` and the answers
    with the LOOKED_AHEAD next higher degrees. The error is assumed to fall as the degree to the
    power -SLOWEST_FALL.
    """
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
            {
                **relative_distances_of_shoe_responses(
                    brake.surface_coordinate_per_phi, shoe, better
                ),
                "peak": apart,
            }
        )
    total = true.torque or response.torque or 1.0
    return SolidErrors(abs(response.torque - true.torque) / total, tuple(shoes))
