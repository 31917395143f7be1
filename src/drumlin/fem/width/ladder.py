"""Solve a brake with widths to a tolerance: choose hp elements and a degree across the width.

The section of a shoe is divided into hp elements. A level is one such division, with a degree and
sizes of the elements; the levels go from coarse to fine. Across the width the displacements are
polynomials of the distance z from the mid-plane, up to some degree. The error has two parts, which
are estimated separately and then added: the section's error, due to the hp elements, and the
width's error, due to the degree across the width. Round-off and the finite contact stiffness add to
the sum. The distance of two answers is their relative difference.

- For the section's error the brake is solved with a low degree across the width on finer and finer
  levels, until the error is at most SECTION_ERROR_SHARE_OF_TOLERANCE of the tolerance. If all parts
  of each shoe have one width, the degree is 0, which is plane stress. If parts have several widths,
  the levels are those of `levels`, the degree is WIDTH_DEGREE_FOR_HP_ELEMENT_ERROR_ESTIMATE, and
  the error is multiplied by the safety factors of `section_error_factors`. The error of a coarser
  level is the distance of its answer from the answer on the last level, plus the stated error of
  this last answer.
- For the width's error answers with different functions across the width are compared on the same
  hp elements. If all parts of each shoe have one width, the functions are polynomials of higher and
  higher degree over the whole width, and the elements are coarse, which takes little time. If parts
  have several widths, they are polynomials on finer and finer pieces of the width (`pieces`), and
  the elements are those of the first level of a solve. With the degree q the answer is compared
  with the answers of the degrees q + 1 and q + 2. The next degree alone would not show the error,
  since the errors of even and of odd degrees fall at different rates. The answer on some pieces is
  compared with the answers of the next two steps, which have a higher degree on the same pieces and
  finer pieces. The larger distance is extrapolated to the exact answer.

The degrees are tried from low to high, and the pieces from coarse to fine. For each of them all
solved levels are tried from coarse to fine, until the sum of both errors meets the tolerance. A
coarse level with an error above SECTION_ERROR_SHARE_OF_TOLERANCE of the tolerance can thus be
combined with functions whose error is small, and the answer that was compared is often the answer
that is returned. No further functions are tried once the error of the pressure p no longer falls,
or if the elements alone miss the tolerance.

If most of a lining overhangs its web, a provisional error of the lowest degree is computed first,
from the distance to the next degree alone. The distance is extrapolated to an infinite degree and
multiplied by the safety factors NEXT_DEGREE_FACTORS. If the provisional error meets the tolerance,
no answer on finer pieces is computed.

The width's error e falls as a power of the degree where a side of the shoe is free or a part
overhangs another part. From e(q) = C q^-k follows e(q) = d / (1 - (q/(q + 2))^k) with the distance
d = e(q) - e(q + 2). The estimate is this e(q) times a safety factor of
SAFETY_FACTORS_OF_SOLID_ERRORS. The factor for forces is larger than the factor for pressures,
because the distances of forces may cancel by accident. The power k is ASSUMED_WIDTH_ERROR_EXPONENT.
It is not fitted to the distances of a brake, because the distances of few degrees scatter. With k =
1 the distance is multiplied by (q + 2)/2.

Beside a web the pressure changes fast across the width and along the arc. On smaller elements a
higher degree is then needed for the same width's error. If the distances were computed on coarse
elements, the estimate without its safety factor would be smaller than the true error in 8 % of 106
cases, and in the worst case 0.44 of the true error (17 brakes, "free" from 2000 and "built" of
`drumlin_studies.solid_error`).

With widths the contact of a shoe ends at other angles than in plane stress. So on each level the
shoe is divided again, with small elements at the ends of the contact of the model with widths,
until these ends no longer move. On one random brake ("free" 2000 of `drumlin_studies.solid_error`)
the pressures of the first two levels differ by 0.23 %. They differ by 3.7 % if the small elements
lie at the ends of the contact in plane stress.

Far beside a web the contact may reach farther along the arc than under the web, with hardly any
pressure. So there are also small elements at the ends of the contact in the mid-plane. On "built"
3104, with an overhang of 9.8 lining thicknesses, the pressures of the first two levels then differ
by 0.4 % with the degrees 1, 2 and 3. Without small elements at these ends the pressures differ by
1.6, 4.9 and 4.3 %.

Where a lining lifts off beside the web, the end of its contact may lie at another angle at each
distance from the mid-plane. The curve on which the lining lifts off then crosses the elements of
the contact face, and no element can have its end there. If an end moves by more than
`SHORTEST_PATH_OF_CONTACT_END`, the columns over its path have equal widths
(`hp.division.COLUMNS_PER_DEGREE_OVER_MOVING_CONTACT_END`). Such brakes need many pieces across the
width as well, and some of them do not reach an error of 1 %, because the next finer pieces would
take more memory than MOST_BYTES_OF_SOLID allows. Columns that were open over the whole width in
earlier answers keep few contact nodes (`open_columns`), which takes less memory and time.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np

from drumlin.base.errors import NoAnswer
from drumlin.base.texts import error_text_in_percent
from drumlin.brake.brake import Brake, Shoe
from drumlin.fem.error_control.adapt import TolerancesOfPressureAndTorque, solve_brake_to_tolerance
from drumlin.fem.error_control.estimate import (
    QUANTITIES_WITH_STATED_ERROR,
    EstimatedErrors,
    read_safety_factors,
    sum_of_penalty_and_round_off_errors,
)
from drumlin.fem.error_control.levels import (
    REFINEMENT_LEVELS_FROM_COARSE_TO_FINE,
    FunctionThatComputesResponse,
    SolvedLevel,
    has_any_lining_new_singular_points,
    solve_brake_on_finer_and_finer_mesh_levels,
)
from drumlin.fem.error_control.singular_points import singular_points_of_each_shoe_shape
from drumlin.fem.hp.division import RefinementLevel, ShoeElementDivision
from drumlin.fem.model import DEFAULT_PENALTY_FACTOR, solve_prepared_model
from drumlin.fem.preparation.cache import CacheOfCondensedBodies
from drumlin.fem.preparation.scene import PreparedModel, SingularPointsByShoeShape
from drumlin.fem.width.error import (
    WIDTH_DEGREE_COMPARED_WITH_PLANE_STRESS,
    plane_stress_solution_on_coarse_hp_elements,
    relative_torque_pressure_and_reaction_differences,
)
from drumlin.fem.width.functions import (
    FunctionsAcrossWidth,
    functions_across_width_of_shoe,
    has_parts_of_different_widths,
    piece_ends_across_half_width_of_shoe,
)
from drumlin.fem.width.levels import REFINEMENT_LEVELS_OF_SHOES_WITH_SEVERAL_WIDTHS
from drumlin.fem.width.open_columns import (
    divisions_with_open_columns,
    solve_until_open_columns_stay_open,
)
from drumlin.fem.width.pieces import (
    PiecesAcrossWidthsOfShoes,
    coarsest_pieces_across_widths,
    pieces_of_next_step,
)
from drumlin.fem.width.prepare import (
    LARGEST_WIDTH_DEGREE,
    MOST_NODES_OF_CONTACT_FACE,
    MakeWidthFunctionsOfShoe,
    memory_bytes_of_condensation_on_divisions,
    memory_bytes_of_condensed_solid_shoe,
    prepare_model_with_shoe_widths,
    prepare_model_with_widths_on_given_elements,
)
from drumlin.response.response import Response

ASSUMED_WIDTH_ERROR_EXPONENT = 1.0
"""Assumed power k with which the error due to the degree q across the width falls, as q^-k.

Where the displacements have a singularity r^a, polynomials of degree q leave an error of q^-2a in
the energy norm (Babuska, Szabo & Katz 1981, SIAM J. Numer. Anal. 18, 515). The strongest
singularity at a corner has a = 1/2, and so k = 1. A larger k makes stated errors smaller, a smaller
k makes them larger. On 17 random brakes with parts of several widths the smallest ratio of the
stated error, without a safety factor, to the true error is 1.6 with k = 1, and 1.2 with k = 1.5.
On coarse elements of 21 random brakes with the breaks of
`functions.WIDTH_BREAKPOINT_DISTANCES_BESIDE_WEB` the smallest ratio with k = 1 is 1.6 for the
pressure and 1.3 for forces, with the degrees 2 and 3.
"""
WIDTH_DEGREE_FOR_HP_ELEMENT_ERROR_ESTIMATE = 1
"""Degree across the width in the estimate of the hp elements' error, if parts differ in width.

Degree 1 represents the bending of a table over its web by straight lines. The error is estimated
from the distance of the pressures on two levels. On ten random brakes ("built" 3100 to 3117 of
`drumlin_studies.solid_error`) the distance of the first two levels with degree 1 is 0.2 to 2.3
times the distance with degree 2 (median 0.9). In plane stress the distance may be 9.5 times smaller
than with degree 2, and would not show the error. With degree 2 the second level takes 5 times as
long as with degree 1.
"""
MOST_LEVELS_FOR_SECTION_ERROR_ESTIMATE = 3
"""Largest number of levels that give the estimate of the hp elements' error, if widths differ.

The third level shows the error of the second one. With two levels this error is only taken as a
fraction of their distance. On nine random brakes that missed 1 % ("built" 510042, 510061 and
510073, "free" 510030, 510039, 510061, 510062, 510064 and 510078 of `drumlin_studies.solid_error`)
the third level lowers the stated error of p on the second level on six, by 1.3 to 5.5 times, and
raises it on three, by at most 1.2 times. With the degree 1 across the width it takes 0.3 to 5 s and
at most 260 MB on these brakes. The figures are from levels with the interface layers of plane
stress. The answer itself needs a higher degree, and is computed on the third level only if
MOST_BYTES_OF_SOLID allows it.
"""
LEAST_LEVELS_FOR_SECTION_ERROR_ESTIMATE = 2
"""Smallest number of levels that give the estimate of the hp elements' error."""
MOST_UNKNOWNS_FOR_FURTHER_SECTION_LEVEL = 60_000
"""Largest number of unknowns of a shoe on the last level for which one more level is allowed.

The unknowns are counted with the degree WIDTH_DEGREE_FOR_HP_ELEMENT_ERROR_ESTIMATE across the
width. From the second level to the third they grow by 2.3 to 3.3 times, so that the third level has
at most some 200 000 unknowns. With a larger limit solves take more memory; with a smaller limit the
stated errors of long shoes are larger. If the tolerance must be met, there is no limit.
"""
MOST_BYTES_OF_SOLID = 800_000_000
"""Largest memory [bytes] of the matrices of solid shoes if a tolerance may be missed.

The memory is that of `prepare.memory_bytes_of_condensation_on_divisions`. The number of unknowns
does not tell it, because unknowns on the contact face take more memory than unknowns inside a shoe.
Other data of a solve take 0.15 to 0.3 GB. The value is a judgement: a solve is meant to take about
1 GB. The largest of ten random brakes took 1.01 GB in all ("built" 510123 of
`drumlin_studies.solid_error`). If the tolerance must be met, there is no limit.
"""
MOST_BYTES_OF_KEPT_MODEL = 20_000_000
"""Largest memory [bytes] of the shoes of an answer whose prepared model is kept for later use.

The memory is that of `prepare.memory_bytes_of_condensed_solid_shoe`. The answer may be the one
that is returned, which needs the model. A larger model is made anew in this case. Up to three
models of earlier steps exist while the next step is solved. With a larger number solves take more
memory: with 40 MB "built" 510037 of `drumlin_studies.solid_error` took 0.05 GB more than with 10
MB. With a smaller number solves take more time: with 10 MB a brake with two T-shaped shoes took 1.2
times as long as with 20 MB.
"""
LEAST_FALL = 0.8
"""Ratio of errors of p below which a higher degree across the width counts as an improvement.

The ratio is the error of p with the degree divided by the smallest error with a lower degree. With
larger values the degree is raised although the error hardly falls, until memory runs out. With
smaller values solves end before the tolerance is reached. By the power ASSUMED_WIDTH_ERROR_EXPONENT
the ratio is 0.67 from degree 2 to degree 3. Where a lining lifts off beside a web, the ends of the
contact move from node to node of the face, and change p by 0.3 to 0.5 % whatever the degree.
"""
MOST_FUNCTIONS_WITHOUT_FALL = 4
"""Largest number of degrees or steps of finer pieces in a row whose error of p does not fall.

A fall is an error of less than LEAST_FALL times the smallest one before. Four steps belong to two
sets of pieces. For degrees two would be enough, because one of two degrees is even and the other
odd; the limit is the same for simplicity. With fewer steps some brakes end before the pieces that
lower the error: on "free" 510030 of `drumlin_studies.solid_error` the errors of the first five
steps are 1.5, 0.8, 0.9, 0.7 and 0.2 %.
"""
SECTION_ERROR_SHARE_OF_TOLERANCE = 0.5
"""Fraction of the tolerance for the error of the section's hp elements.

The error due to the degree across the width may take the rest of the tolerance.
"""
WIDTH_ERROR_SHARE_OF_TOLERANCE = 1 - SECTION_ERROR_SHARE_OF_TOLERANCE
"""Fraction of the tolerance for the error of the functions across the width.

Pieces are split if their error exceeds an equal share of it.
"""
NUMBER_OF_COMPARED_STEPS = 2
"""Number of later steps of finer pieces with which a step is compared to estimate its error.

One of the two next steps has another degree on the same pieces, and one of them has other pieces.
"""
ASSUMED_FALL_OF_ERROR_IN_TWO_STEPS = 0.5
"""Assumed error of a step of finer pieces, relative to the error two steps before.

A piece is split into two. On pieces half as long the error of polynomials is at most half as large
where their gradient is bounded. On four random brakes ("free" 510030, 510032, 510038 and 510048 of
`drumlin_studies.solid_error`) the ratio is 0.1 to 0.9, with a median of 0.4. With another value the
fitted factors `pieces_pressure` and `pieces_force` change such that stated errors stay the same.
"""
NUMBER_OF_COMPARED_HIGHER_WIDTH_DEGREES = 2
"""Number of higher degrees across the width with which a degree is compared to estimate its error.

Of the two next higher degrees one is even and the other odd.
"""
LARGEST_WIDTH_DEGREE_WITH_STATED_ERROR = (
    LARGEST_WIDTH_DEGREE - NUMBER_OF_COMPARED_HIGHER_WIDTH_DEGREES
)
"""Largest degree across the width whose error can be stated.

The error follows from answers with the NUMBER_OF_COMPARED_HIGHER_WIDTH_DEGREES next higher degrees.
These degrees must not exceed LARGEST_WIDTH_DEGREE.
"""


class SafetyFactorsOfSolidErrors(NamedTuple):
    """Safety factors of the errors stated for shoes with widths.

    The factors `force` hold for torques and reactions, the factors `pressure` for pressures.

    Attributes
    ----------
    pressure, force : factors on the extrapolated distance between degrees, which give the stated
        error due to the degree across the width
    pieces_pressure, pieces_force : factors on the extrapolated distance between steps of finer
        pieces, which give the stated error due to the pieces of the width
    two_levels_pressure, two_levels_force : factors on the error of the section's hp elements that
        is estimated from two levels with WIDTH_DEGREE_FOR_HP_ELEMENT_ERROR_ESTIMATE across the
        width, if parts have several widths
    section_pressure, section_force : factors on the same error if it is estimated from three levels
    """

    pressure: float
    force: float
    pieces_pressure: float
    pieces_force: float
    two_levels_pressure: float
    two_levels_force: float
    section_pressure: float
    section_force: float


SAFETY_FACTORS_OF_SOLID_ERRORS = SafetyFactorsOfSolidErrors(
    **read_safety_factors(Path(__file__).with_name("factors.json"))
)
"""Safety factors of the errors stated for shoes with widths, fitted by `make calibrate`.

The file factors.json says to which brakes they are fitted, and what each factor does.
"""


class PressureAndForceErrorFactors(NamedTuple):
    """Two factors by which errors are multiplied.

    `pressure` multiplies errors of pressures, and `force` multiplies errors of torques and
    reactions.
    """

    pressure: float
    force: float


NEXT_DEGREE_FACTORS = PressureAndForceErrorFactors(pressure=1.5, force=1.5)
"""Safety factors of a provisional error, which follows from the next degree across the width alone.

They multiply the distance from the next degree, extrapolated to an infinite degree with the power
ASSUMED_WIDTH_ERROR_EXPONENT. On 17 random brakes with at most LARGEST_FIRST_PIECE of the lining in
the first piece (of "free" 1000 to 1019, and nine "free" and "built" from 510000) the ratio of the
true error of degree 2 to the extrapolated distance is at most 0.68. The factors are twice as large
as these brakes need.
"""
LARGEST_FIRST_PIECE = 0.5
"""Largest fraction of the lining's width in the first piece for which a provisional error is used.

A provisional error follows from the next degree across the width alone. The first piece of the
width contains the mid-plane. On the first piece an even degree adds functions of u_x and u_y only,
and an odd degree adds functions of u_z only, so that one distance may be small by accident. On the
other pieces every degree adds functions of all displacements. The ratio of the true error of p to
the extrapolated distance is 0.85 where the first piece has two thirds of the lining's width ("free"
1000), 1.75 and 2.03 where it has 87 and 95 % ("free" 1016 and 1007), and more than 2.3 where it has
the whole width ("free" 510023). The value one half is a judgement: on most of the lining every
degree then adds functions of all displacements.
"""


class RelativeErrorsOfSolidModel(NamedTuple):
    """Relative errors of a brake's `torque`, and relative errors of each of its shoes.

    `shoes` has the errors of each shoe by the names in QUANTITIES_WITH_STATED_ERROR.
    """

    torque: float
    shoes: tuple[dict[str, float], ...]

    @property
    def largest_pressure_error(self) -> float:
        """The largest error of a shoe's pressure, which is averaged over the width."""
        return self.largest_error_by_name("pressure")

    def largest_error_by_name(self, name: str) -> float:
        """The brake's torque error for the name "torque", else the largest error of its shoes."""
        return self.torque if name == "torque" else max(shoe[name] for shoe in self.shoes)

    @property
    def smallest_tolerance_that_errors_meet(self) -> TolerancesOfPressureAndTorque:
        """The smallest tolerance that these errors meet: largest pressure error, torque error."""
        return TolerancesOfPressureAndTorque(self.largest_pressure_error, self.torque)

    def largest_error_over_tolerance(self, tolerance: TolerancesOfPressureAndTorque) -> float:
        """The larger one of the errors of p and of the torque, each relative to its tolerance."""
        return max(self.largest_pressure_error / tolerance.pressure, self.torque / tolerance.torque)

    def is_within_error_tolerance(self, tolerance: TolerancesOfPressureAndTorque) -> bool:
        """Whether the errors of the torque and of each shoe's pressure are within a tolerance."""
        return self.largest_pressure_error <= tolerance.pressure and self.torque <= tolerance.torque

    def sum_of_these_and_other_errors(
        self, other: "RelativeErrorsOfSolidModel"
    ) -> "RelativeErrorsOfSolidModel":
        """The sum of these errors and of `other` errors.

        The error of a peak pressure is limited to 1, which means that the error is unknown.
        """
        shoes = []
        for one, two in zip(self.shoes, other.shoes, strict=True):
            both = {name: one[name] + two[name] for name in QUANTITIES_WITH_STATED_ERROR}
            shoes.append(both | {"peak": min(both["peak"], 1.0)})
        return RelativeErrorsOfSolidModel(self.torque + other.torque, tuple(shoes))

    def errors_times_factors(
        self, factors: PressureAndForceErrorFactors
    ) -> "RelativeErrorsOfSolidModel":
        """These errors times two factors: one for pressures, and one for torques and reactions."""
        by_name = dict.fromkeys(QUANTITIES_WITH_STATED_ERROR, factors.force)
        by_name |= {"pressure": factors.pressure, "peak": factors.pressure}
        shoes = [{name: by_name[name] * own for name, own in shoe.items()} for shoe in self.shoes]
        return RelativeErrorsOfSolidModel(factors.force * self.torque, tuple(shoes))


class SectionLevelWithItsError(NamedTuple):
    """A level of the section's hp elements, and the error due to these elements.

    The error due to the degree across the width is not included.

    Attributes
    ----------
    level : the level
    error : the relative errors
    size : number of unknowns of the largest shoe on the level, relative to its number on the first
        level with the same functions across the width
    divisions : divisions of the shoes' sections into the level's elements, by the index of the
        first shoe of each shape
    """

    level: RefinementLevel
    error: RelativeErrorsOfSolidModel
    size: float = 1.0
    divisions: Mapping[int, ShoeElementDivision] = {}


class SolvedLevelsWithLastResponse(NamedTuple):
    """The solved levels of a brake, from coarse to fine, and the answer with its stated errors.

    `response` is the answer on the last level. `family` has the levels from which the solved ones
    were taken.
    """

    levels: list[SolvedLevel]
    response: Response
    family: Sequence[RefinementLevel]


class HpElementsForComparingWidthDegrees(NamedTuple):
    """The hp elements of a brake's shoes on which degrees across the width are compared.

    `divisions` are the divisions of the shoes' sections into hp elements, by the index of the first
    shoe of each shape. `level` is the level of these elements; it is None for coarse elements.
    `solved` has the models that are already solved on these elements, by their degree across the
    width.
    """

    divisions: Mapping[int, ShoeElementDivision]
    level: RefinementLevel | None
    solved: Mapping[int, SolvedLevel]


class SolvedFunctionsAcrossWidth(NamedTuple):
    """The answer with some functions of z, on the hp elements on which functions are compared.

    Attributes
    ----------
    response : the answer
    unknowns : the largest number of unknowns of a shoe
    model : the prepared model; None for a large model, which takes much memory and is dropped
    """

    response: Response
    unknowns: int
    model: PreparedModel | None

    @classmethod
    def answer_of_solved_level(cls, solved: SolvedLevel) -> "SolvedFunctionsAcrossWidth":
        """The answer of a solved level, with its model unless this is large."""
        memory = sum(map(memory_bytes_of_condensed_solid_shoe, solved.prepared_model.bodies))
        model = solved.prepared_model if memory <= MOST_BYTES_OF_KEPT_MODEL else None
        return cls(solved.response, largest_number_of_unknowns(solved), model)


class WidthError(NamedTuple):
    """A degree across the width, the error due to this degree, and the answer with it.

    The answer `solved` has the hp elements on which degrees are compared. If the error is
    `provisional`, it follows from the answer with the next functions of z alone, with larger safety
    factors. `pieces` are the pieces of the width on which the polynomials have the degree; None if
    degrees are compared, on the first pieces.
    """

    degree: int
    error: RelativeErrorsOfSolidModel
    solved: SolvedFunctionsAcrossWidth
    provisional: bool = False
    pieces: PiecesAcrossWidthsOfShoes | None = None

    @property
    def functions(self) -> int | PiecesAcrossWidthsOfShoes:
        """The functions of z: a degree on the first pieces, or pieces with their degree."""
        return self.pieces or self.degree

    def functions_of_shoe(self, shoe: Shoe) -> FunctionsAcrossWidth:
        """The functions of z across the width of a shoe."""
        if self.pieces is not None:
            return self.pieces(shoe)
        return functions_across_width_of_shoe(shoe, self.degree)

    @property
    def functions_as_text(self) -> str:
        """The functions of z in words."""
        text = f"degree {self.degree} across the width"
        if self.pieces is not None:
            text += f" in {self.pieces.largest_number_of_pieces} pieces of half the width"
        return text

    @property
    def unknowns(self) -> int:
        """The largest number of unknowns of a shoe."""
        return self.solved.unknowns


def largest_number_of_unknowns(solved: SolvedLevel) -> int:
    """The largest number of unknowns of a shoe in a solved model."""
    return max(body.unknowns for body in solved.prepared_model.bodies)


class SolidChoice(NamedTuple):
    """Hp elements of the section and a degree across the width, with the sum of their errors.

    `round_off` are the errors by round-off and by the finite contact stiffness, which are known
    when the choice is solved; None before.
    """

    section: SectionLevelWithItsError
    width: WidthError
    round_off: RelativeErrorsOfSolidModel | None = None

    @property
    def error(self) -> RelativeErrorsOfSolidModel:
        """The errors due to the section's elements, due to the degree, and by round-off."""
        error = self.section.error.sum_of_these_and_other_errors(self.width.error)
        if self.round_off is None:
            return error
        return error.sum_of_these_and_other_errors(self.round_off)

    @property
    def unknowns(self) -> float:
        """Approximate number of unknowns of the largest shoe with these elements and this degree.

        The number holds if degrees are compared on the first level.
        """
        return self.section.size * self.width.unknowns


def solve_brake_with_widths_to_tolerance(
    brake: Brake,
    tolerance: TolerancesOfPressureAndTorque,
    *,
    must: bool = True,
    penalty: float = DEFAULT_PENALTY_FACTOR,
    cache: CacheOfCondensedBodies | None = None,
) -> Response:
    """Solve a brake with widths so that its estimated errors meet a tolerance.

    The parameters and the raised exceptions are those of `solve_brake_with_widths_and_keep_model`.
    """
    return solve_brake_with_widths_and_keep_model(
        brake, tolerance, must=must, penalty=penalty, cache=cache
    ).response


def solve_brake_with_widths_and_keep_model(
    brake: Brake,
    tolerance: TolerancesOfPressureAndTorque,
    *,
    must: bool = True,
    across: int | None = None,
    penalty: float = DEFAULT_PENALTY_FACTOR,
    cache: CacheOfCondensedBodies | None = None,
) -> SolvedLevel:
    """Solve a brake with widths to a tolerance; return the response and its prepared model.

    Parameters
    ----------
    brake : the brake
    tolerance : allowed relative errors of the pressure, averaged over the width, and of the torque
    must : whether NoAnswer is raised if the tolerance is not reached; if False, the answer of
        `cheapest_choice_within_tolerance` is returned, with a warning in its notes
    across : degree across the width. If it is None, the smallest degree that meets the tolerance is
        found, or finer pieces of the width if parts have several widths.
    penalty : factor alpha of the contact stiffness alpha E/t (lining modulus E, thickness t)
    cache : substructures of earlier solves

    Raises
    ------
    NoAnswer
        if the brake has no answer in plane stress or no answer with widths, or if the tolerance
        must be reached and is not reached
    BadInput
        if the model of the width does not apply to the brake
    """
    cache = cache or CacheOfCondensedBodies(room=0)
    sections = _cross_section_meshes_with_errors(
        brake, tolerance, must=must, penalty=penalty, cache=cache
    )
    compared = hp_elements_to_compare_width_degrees(
        brake, sections.plane, penalty=penalty, cache=cache
    )
    adaptive = across is None and has_shoe_with_parts_of_different_widths(brake)
    most_bytes = MOST_BYTES_OF_SOLID if adaptive and not must else math.inf
    if adaptive:
        errors = errors_of_finer_pieces_across_width(
            brake,
            sections.plane,
            compared,
            tolerance.pressure,
            most_bytes=most_bytes,
            penalty=penalty,
            cache=cache,
        )
    else:
        degrees = (
            range(
                WIDTH_DEGREE_COMPARED_WITH_PLANE_STRESS, LARGEST_WIDTH_DEGREE_WITH_STATED_ERROR + 1
            )
            if across is None
            else (across,)
        )
        errors = errors_of_degrees_across_width(
            brake, sections.plane, compared, degrees, penalty=penalty, cache=cache
        )
    choice = cheapest_choice_within_tolerance(
        sections.errors,
        errors,
        tolerance,
        partial(_does_choice_fit_into_memory, brake, most_bytes),
    )
    if must and not choice.error.is_within_error_tolerance(tolerance):
        raise NoAnswer(_message_on_unreached_error_tolerance(tolerance, choice))
    try:
        solved = _solved_level_of_choice(brake, choice, compared, penalty=penalty, cache=cache)
    except NoAnswer:
        # On a finer level the contact may have more nodes than are allowed.
        if must or compared.level is None:
            raise
        choice = SolidChoice(sections.errors[0], choice.width)
        solved = _solved_level_on_compared_elements(brake, choice.width, compared, cache)
    round_off = _penalty_and_round_off_errors(solved.response, choice.error)
    choice = choice._replace(round_off=round_off)
    warning = ""
    if not choice.error.is_within_error_tolerance(tolerance):
        warning = _message_on_unreached_error_tolerance(tolerance, choice)
        if must:
            raise NoAnswer(warning)
    return _solved_level_with_errors_and_notes(solved, choice, warning)


def _penalty_and_round_off_errors(
    response: Response, other: RelativeErrorsOfSolidModel
) -> RelativeErrorsOfSolidModel:
    """The errors of a response by round-off and by the finite contact stiffness.

    The imbalance of the forces on a shoe, which round-off causes too, adds to all errors. A
    quantity without `other` errors, such as the torque without friction, has the error 0.
    """
    imbalance = max(response.balance.force, response.balance.moment)
    torque, *errors = (sum_of_penalty_and_round_off_errors(response.shoes) + imbalance).tolist()
    shoes = []
    rows = np.reshape(errors, (len(other.shoes), -1)).tolist()
    for known, row in zip(other.shoes, rows, strict=True):
        own = zip(QUANTITIES_WITH_STATED_ERROR, row, strict=True)
        shoes.append({name: value if known[name] > 0 else 0.0 for name, value in own})
    return RelativeErrorsOfSolidModel(torque if other.torque > 0 else 0.0, tuple(shoes))


def _does_choice_fit_into_memory(brake: Brake, most_bytes: float, choice: SolidChoice) -> bool:
    """Whether the matrices of a choice take at most `most_bytes`, which may be inf."""
    if math.isinf(most_bytes):
        return True
    divisions = divisions_with_open_columns(
        brake, choice.section.divisions, [choice.width.solved.response]
    )
    return most_bytes >= memory_bytes_of_condensation_on_divisions(
        brake, divisions, choice.width.functions_of_shoe
    )


def _solved_level_of_choice(
    brake: Brake,
    choice: SolidChoice,
    compared: HpElementsForComparingWidthDegrees,
    *,
    penalty: float,
    cache: CacheOfCondensedBodies,
) -> SolvedLevel:
    """The solved model of a choice, which is solved now unless this was done before.

    Raises
    ------
    NoAnswer
        where the chosen level has no answer with the chosen functions of z
    """
    model, response = choice.width.solved.model, choice.width.solved.response
    if model is not None and _is_choice_solved(brake, choice, compared):
        return SolvedLevel(model, response)
    return solve_cross_section_mesh_with_width_degree(
        brake,
        choice.section.level,
        choice.width.functions,
        response,
        penalty=penalty,
        cache=cache,
    )


def _solved_level_on_compared_elements(
    brake: Brake,
    width: WidthError,
    compared: HpElementsForComparingWidthDegrees,
    cache: CacheOfCondensedBodies,
) -> SolvedLevel:
    """The answer with some functions of z on the elements on which functions were compared.

    A model that was dropped is made anew.
    """
    model = width.solved.model
    if model is None:
        divisions = divisions_with_open_columns(brake, compared.divisions, [width.solved.response])
        model = prepare_model_with_widths_on_given_elements(
            brake, divisions, width.functions, cache=cache
        )
    return SolvedLevel(model, width.solved.response)


class SectionErrors(NamedTuple):
    """The solved levels of the section's hp elements from coarse to fine, with their errors.

    `plane` is an answer of plane stress. It is the answer on the last level if all parts of each
    shoe have one width, and on the first level if parts have several widths.
    """

    errors: list[SectionLevelWithItsError]
    plane: Response


def _cross_section_meshes_with_errors(
    brake: Brake,
    tolerance: TolerancesOfPressureAndTorque,
    *,
    must: bool,
    penalty: float,
    cache: CacheOfCondensedBodies,
) -> SectionErrors:
    """The levels of the section's hp elements that a solve to a tolerance needs, with their errors.

    The last level has an error of at most SECTION_ERROR_SHARE_OF_TOLERANCE of the tolerance, unless
    it is the finest one that is allowed. The parameters are those of
    `solve_brake_with_widths_and_keep_model`.
    """
    part = SECTION_ERROR_SHARE_OF_TOLERANCE
    share = TolerancesOfPressureAndTorque(part * tolerance.pressure, part * tolerance.torque)
    answer = partial(solve_prepared_model, penalty=penalty)
    if not has_shoe_with_parts_of_different_widths(brake):
        climb = refine_cross_section_mesh_until_tolerance_is_met(brake, share, answer, cache)
        return SectionErrors(
            errors_of_solved_cross_section_meshes(
                brake, climb, PressureAndForceErrorFactors(1.0, 1.0)
            ),
            climb.response,
        )
    # Plane stress only has to show where the first elements of the shoes with widths are small.
    first = solve_brake_on_finer_and_finer_mesh_levels(
        brake, answer, cache, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[:1]
    )
    plane = next(iter(first)).response
    # The solve ends after two levels if their estimate meets the share, or if no third level is
    # allowed.
    factors = section_error_factors(LEAST_LEVELS_FOR_SECTION_ERROR_ESTIMATE)
    asked = TolerancesOfPressureAndTorque(
        share.pressure / factors.pressure, share.torque / factors.force
    )
    climb = refine_cross_section_mesh_until_tolerance_is_met(
        brake,
        asked,
        answer,
        cache,
        REFINEMENT_LEVELS_OF_SHOES_WITH_SEVERAL_WIDTHS[:MOST_LEVELS_FOR_SECTION_ERROR_ESTIMATE],
        plane,
        must=must,
    )
    factors = section_error_factors(len(climb.levels))
    return SectionErrors(errors_of_solved_cross_section_meshes(brake, climb, factors), plane)


def section_error_factors(levels: int) -> PressureAndForceErrorFactors:
    """The safety factors of the section's errors that are estimated from a number of solved levels.

    The layers at interfaces become smaller from the second level to the third only, so that the
    estimate from two levels does not show the effect of these layers.
    """
    fitted = SAFETY_FACTORS_OF_SOLID_ERRORS
    if levels <= LEAST_LEVELS_FOR_SECTION_ERROR_ESTIMATE:
        return PressureAndForceErrorFactors(fitted.two_levels_pressure, fitted.two_levels_force)
    return PressureAndForceErrorFactors(fitted.section_pressure, fitted.section_force)


def cheapest_choice_within_tolerance(
    sections: Sequence[SectionLevelWithItsError],
    widths: Iterator[WidthError],
    tolerance: TolerancesOfPressureAndTorque,
    may_be_solved: Callable[[SolidChoice], bool] = lambda choice: True,
) -> SolidChoice:
    """The first functions of z, and the coarsest elements for them, whose errors meet a tolerance.

    If no functions meet the tolerance, the larger one of the errors of p and of the torque, each
    relative to its tolerance, is made small. Of all choices for which it is at most 1/LEAST_FALL
    times the smallest one, the result has the fewest unknowns.

    Parameters
    ----------
    sections : levels of the section's hp elements with their errors, from coarse to fine
    widths : errors due to the functions of z, from coarse to fine. No more functions are taken
        after MOST_FUNCTIONS_WITHOUT_FALL in a row whose error of p does not fall.
    tolerance : relative errors that are allowed
    may_be_solved : function that tells whether a choice on any level but the first is allowed
    """
    finest = sections[-1].error
    can_sections_meet_tolerance = finest.is_within_error_tolerance(tolerance)
    best: WidthError | None = None
    functions_without_fall = 0
    choices: list[SolidChoice] = []
    for width in widths:
        of_width = [SolidChoice(section, width) for section in sections]
        allowed = [of_width[0], *filter(may_be_solved, of_width[1:])]
        for choice in allowed:
            if choice.error.is_within_error_tolerance(tolerance):
                return choice
        if width.provisional:
            continue
        choices += allowed
        falls = best is None or (
            width.error.largest_pressure_error < LEAST_FALL * best.error.largest_pressure_error
        )
        functions_without_fall = 0 if falls else functions_without_fall + 1
        best = width if falls or best is None else best
        # If the elements alone miss the tolerance, a degree is good enough if its error is not
        # larger than the error of the finest elements.
        enough = finest.smallest_tolerance_that_errors_meet
        is_enough = not can_sections_meet_tolerance and best.error.is_within_error_tolerance(enough)
        if is_enough or functions_without_fall == MOST_FUNCTIONS_WITHOUT_FALL:
            break
    smallest = min(choice.error.largest_error_over_tolerance(tolerance) for choice in choices)
    good = [
        choice
        for choice in choices
        if LEAST_FALL * choice.error.largest_error_over_tolerance(tolerance) <= smallest
    ]
    return min(good, key=lambda choice: choice.unknowns)


def _is_choice_solved(
    brake: Brake, choice: SolidChoice, compared: HpElementsForComparingWidthDegrees
) -> bool:
    """Whether the chosen model was already solved when degrees across the width were compared.

    The compared model must have the chosen level of elements, and small elements at the ends of its
    own contact. The parameter `compared` has the elements on which degrees were compared.
    """
    if compared.level != choice.section.level:
        return False
    first = next(iter(compared.solved.values())).response
    before, now = (
        singular_points_of_each_shoe_shape(brake, response)
        for response in (first, choice.width.solved.response)
    )
    return not has_any_lining_new_singular_points(brake, before, now)


def solve_cross_section_mesh_with_width_degree(
    brake: Brake,
    level: RefinementLevel,
    degree: int | MakeWidthFunctionsOfShoe,
    start: Response,
    *,
    penalty: float = DEFAULT_PENALTY_FACTOR,
    cache: CacheOfCondensedBodies | None = None,
    most_contact_nodes: int = MOST_NODES_OF_CONTACT_FACE,
) -> SolvedLevel:
    """Solve a brake with widths on one level of hp elements, with a degree across the width.

    The shoes are divided anew until the ends of the contact no longer move.

    Parameters
    ----------
    brake : the brake
    level : degree of the section's hp elements, and their sizes at singular points
    degree : degree across the width, or a function from a shoe to its functions across the width
    start : an earlier answer; the first division has small elements at the ends of its contact. If
        it is an answer with widths, columns that are open in it keep few contact nodes
        (`open_columns`).
    penalty : factor alpha of the contact stiffness alpha E/t (lining modulus E, thickness t)
    cache : substructures of earlier solves
    most_contact_nodes : largest number of nodes of a shoe's contact face

    Raises
    ------
    NoAnswer
        where the level has no answer
    """
    answer = partial(solve_prepared_model, penalty=penalty)

    def solve_with_open_columns(expected: Sequence[Response]) -> SolvedLevel:
        """Solve the level with the columns that are open in all expected answers."""

        def prepare(divided: RefinementLevel, points: SingularPointsByShoeShape) -> PreparedModel:
            """The prepared model of the brake, with small elements at the singular points."""
            return prepare_model_with_shoe_widths(
                brake,
                divided,
                degree,
                points,
                answers=expected,
                cache=cache,
                most_contact_nodes=most_contact_nodes,
            )

        steps = solve_brake_on_finer_and_finer_mesh_levels(
            brake, answer, cache, [level], prepare=prepare, start=expected[-1]
        )
        for solved in steps:
            return solved
        raise NoAnswer(f"no equilibrium on a section of degree {level.degree} with its width")

    return solve_until_open_columns_stay_open(brake, [start], solve_with_open_columns)


def _solved_level_with_errors_and_notes(
    solved: SolvedLevel, choice: SolidChoice, warning: str
) -> SolvedLevel:
    """Add to a solved level's answer its errors, a note on the degrees, and a warning if any.

    Parameters
    ----------
    solved : the answer with widths, and its prepared model
    choice : the level of the section's elements, the degree across the width, and their errors
    warning : text which says that the tolerance is not reached; empty if it is reached
    """
    response, found = solved.response, choice.error
    warnings = [f"warning: {warning}"] if warning else []
    unknowns = largest_number_of_unknowns(solved)
    how = (
        f"{choice.width.functions_as_text} "
        f"on a section of degree {choice.section.level.degree}, with {unknowns} unknowns a shoe"
    )
    shoes = zip(response.shoes, found.shoes, strict=True)
    stated = replace(
        response,
        shoes=tuple(replace(shoe, error=own) for shoe, own in shoes),
        error=EstimatedErrors.brake_errors_from_torque_and_shoe_errors(
            found.torque, found.shoes
        ).brake,
        notes=(*response.notes, *warnings, how),
    )
    return SolvedLevel(solved.prepared_model, stated)


def refine_cross_section_mesh_until_tolerance_is_met(
    brake: Brake,
    tolerance: TolerancesOfPressureAndTorque,
    answer: FunctionThatComputesResponse,
    cache: CacheOfCondensedBodies,
    levels: Sequence[RefinementLevel] = (),
    start: Response | None = None,
    *,
    must: bool = True,
) -> SolvedLevelsWithLastResponse:
    """Solve a brake on finer and finer levels, with a low degree across the width, to a tolerance.

    Parameters
    ----------
    brake : the brake
    tolerance : relative errors that are allowed
    answer : function that computes the response on a prepared model
    cache : substructures of earlier solves
    levels : levels of a solve with WIDTH_DEGREE_FOR_HP_ELEMENT_ERROR_ESTIMATE across the width; if
        empty, the brake is solved in plane stress on the levels
        REFINEMENT_LEVELS_FROM_COARSE_TO_FINE
    start : an earlier answer; the first division has small elements at the ends of its contact
    must : whether all `levels` are solved if the tolerance needs them; if False, the solve ends
        after LEAST_LEVELS_FOR_SECTION_ERROR_ESTIMATE levels or more if a shoe has more than
        MOST_UNKNOWNS_FOR_FURTHER_SECTION_LEVEL unknowns on the last one

    Raises
    ------
    NoAnswer
        if no two levels have answers
    """

    def prepare_model_with_width_degree(
        level: RefinementLevel, points: SingularPointsByShoeShape
    ) -> PreparedModel:
        """The prepared model of the brake on a level, with the low degree of section estimates."""
        return prepare_model_with_shoe_widths(
            brake, level, WIDTH_DEGREE_FOR_HP_ELEMENT_ERROR_ESTIMATE, points, cache=cache
        )

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
            is_large = largest_number_of_unknowns(step) > MOST_UNKNOWNS_FOR_FURTHER_SECTION_LEVEL
            is_large = is_large and len(climbed) >= LEAST_LEVELS_FOR_SECTION_ERROR_ESTIMATE
            if levels and is_large and not must:
                return

    last = solve_brake_to_tolerance(
        brake, tolerance, answer, must=False, levels=solve_levels_and_keep_each()
    )
    family = levels or REFINEMENT_LEVELS_FROM_COARSE_TO_FINE
    return SolvedLevelsWithLastResponse(climbed, last.response, family)


def errors_of_solved_cross_section_meshes(
    brake: Brake, climb: SolvedLevelsWithLastResponse, factors: PressureAndForceErrorFactors
) -> list[SectionLevelWithItsError]:
    """The solved levels of the section's hp elements with their errors, from coarse to fine.

    Parameters
    ----------
    brake : the brake
    climb : the solved levels, from coarse to fine, and the answer of the last level
    factors : safety factors by which the errors are multiplied
    """
    last = climb.response
    stated = RelativeErrorsOfSolidModel(
        (last.error or {})["torque"], tuple(dict(shoe.error or {}) for shoe in last.shoes)
    )
    by_degree = {level.degree: level for level in climb.family}
    sections = []
    for step in climb.levels:
        moved = _relative_differences_from_better_response(brake, step.response, last)
        error = moved.sum_of_these_and_other_errors(stated).errors_times_factors(factors)
        size = largest_number_of_unknowns(step) / largest_number_of_unknowns(climb.levels[0])
        # A shoe without contact has a response without elements, but always a division.
        division = next(iter(step.prepared_model.divisions.values()))
        level = by_degree[division.degree]
        sections.append(SectionLevelWithItsError(level, error, size, step.prepared_model.divisions))
    return sections


def has_shoe_with_parts_of_different_widths(brake: Brake) -> bool:
    """Whether any shoe of the brake has parts that are wider than others."""
    return any(has_parts_of_different_widths(shoe) for shoe in brake.shoes)


def _message_on_unreached_error_tolerance(
    tolerance: TolerancesOfPressureAndTorque, choice: SolidChoice
) -> str:
    """The text which says that the chosen elements and functions of z miss a tolerance.

    The text also says whether the elements or the functions have the larger error of p.
    """
    error, parts = choice.error, (choice.section.error, choice.width.error)
    section, width = (part.largest_pressure_error for part in parts)
    of_width = "degree" if choice.width.pieces is None else "pieces"
    larger = "elements of the section" if section > width else f"{of_width} across the width"
    return (
        f"tolerance {tolerance.pressure:g} not reached "
        f"with {choice.width.functions_as_text}: "
        f"estimated error of p {error_text_in_percent(error.largest_pressure_error)}, "
        f"of the torque {error_text_in_percent(error.torque)}, most of it due to the {larger}"
    )


def hp_elements_to_compare_width_degrees(
    brake: Brake,
    plane: Response,
    *,
    penalty: float = DEFAULT_PENALTY_FACTOR,
    cache: CacheOfCondensedBodies | None = None,
) -> HpElementsForComparingWidthDegrees:
    """The hp elements of the shoes on which degrees across the width are compared.

    If all parts of each shoe have one width, the elements are coarse. If parts have several widths,
    the elements of the first level of a solve are taken, since coarse elements show too little of
    the error beside a web. This level is solved with degree
    WIDTH_DEGREE_COMPARED_WITH_PLANE_STRESS across the width, so that it has small elements at the
    ends of the contact with widths.

    Parameters
    ----------
    brake : the brake
    plane : answer of plane stress; the elements are small at the ends of its contact
    penalty : factor alpha of the contact stiffness alpha E/t (lining modulus E, thickness t)
    cache : substructures of earlier solves

    Raises
    ------
    NoAnswer
        if the brake has no answer on the first level: in plane stress if all parts of each shoe
        have one width, with widths if parts have several widths
    """
    if not has_shoe_with_parts_of_different_widths(brake):
        coarse = plane_stress_solution_on_coarse_hp_elements(
            brake, plane, penalty=penalty, cache=cache
        )
        return HpElementsForComparingWidthDegrees(coarse.divisions, None, {})
    wide = solve_cross_section_mesh_with_width_degree(
        brake,
        REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0],
        WIDTH_DEGREE_COMPARED_WITH_PLANE_STRESS,
        plane,
        penalty=penalty,
        cache=cache,
    )
    divisions = wide.prepared_model.divisions
    return HpElementsForComparingWidthDegrees(
        divisions,
        REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0],
        {WIDTH_DEGREE_COMPARED_WITH_PLANE_STRESS: wide},
    )


def errors_of_degrees_across_width(
    brake: Brake,
    plane: Response,
    section: HpElementsForComparingWidthDegrees,
    degrees: Sequence[int] = range(
        WIDTH_DEGREE_COMPARED_WITH_PLANE_STRESS, LARGEST_WIDTH_DEGREE_WITH_STATED_ERROR + 1
    ),
    *,
    penalty: float = DEFAULT_PENALTY_FACTOR,
    cache: CacheOfCondensedBodies | None = None,
) -> Iterator[WidthError]:
    """Yield the errors due to degrees across the width, one degree after the other.

    Where most of each lining overhangs its web, a provisional error comes before the error of the
    degree WIDTH_DEGREE_COMPARED_WITH_PLANE_STRESS. The errors end before a degree whose error needs
    an answer that the brake does not have.

    Parameters
    ----------
    brake : the brake
    plane : answer of plane stress
    section : hp elements of the shoes on which degrees are compared, see
        `hp_elements_to_compare_width_degrees`
    degrees : the degrees, in this order
    penalty : factor alpha of the contact stiffness alpha E/t (lining modulus E, thickness t)
    cache : substructures of earlier solves

    Raises
    ------
    NoAnswer
        if the error of the first degree cannot be estimated
    """
    known = dict(section.solved)

    def solve_with_degree_across_width(degree: int) -> SolvedLevel:
        """The solved model with a degree across the width, on the given hp elements."""
        if degree not in known:
            scene = prepare_model_with_widths_on_given_elements(
                brake, section.divisions, degree, cache=cache
            )
            response = solve_prepared_model(scene, brake, penalty=penalty, start=plane)
            known[degree] = SolvedLevel(scene, response)
        return known[degree]

    overhangs = all(map(_has_narrow_first_piece, brake.shoes))
    for degree in degrees:
        try:
            solved = solve_with_degree_across_width(degree)
            if overhangs and degree == WIDTH_DEGREE_COMPARED_WITH_PLANE_STRESS:
                following = solve_with_degree_across_width(degree + 1).response
                moved = largest_relative_differences(brake, solved.response, [following])
                error = moved.errors_times_factors(error_factors_of_distance(degree, 1))
                own = SolvedFunctionsAcrossWidth.answer_of_solved_level(solved)
                yield WidthError(degree, error, own, provisional=True)
            ahead = range(degree + 1, degree + NUMBER_OF_COMPARED_HIGHER_WIDTH_DEGREES + 1)
            further = [solve_with_degree_across_width(each).response for each in ahead]
        except NoAnswer:
            # With a higher degree the brake may have too many contact nodes, or no equilibrium.
            if degree == degrees[0]:
                raise
            return
        largest = largest_relative_differences(brake, solved.response, further)
        error = largest.errors_times_factors(
            error_factors_of_distance(degree, NUMBER_OF_COMPARED_HIGHER_WIDTH_DEGREES)
        )
        yield WidthError(degree, error, SolvedFunctionsAcrossWidth.answer_of_solved_level(solved))


def errors_of_finer_pieces_across_width(
    brake: Brake,
    plane: Response,
    section: HpElementsForComparingWidthDegrees,
    tolerance: float,
    *,
    most_bytes: float = math.inf,
    penalty: float = DEFAULT_PENALTY_FACTOR,
    cache: CacheOfCondensedBodies | None = None,
) -> Iterator[WidthError]:
    """Yield the errors of finer and finer pieces across the width, one step after the other.

    The steps are those of `pieces`. The error of a step follows from its distances from the next
    NUMBER_OF_COMPARED_STEPS steps. Where most of each lining overhangs its web, a provisional error
    of the first step comes first, which follows from the second step alone. The errors end where
    the next step has no answer, or takes more memory than is allowed.

    Parameters
    ----------
    brake : the brake; the parts of a shoe have several widths
    plane : answer of plane stress
    section : hp elements of the shoes on which the steps are compared, see
        `hp_elements_to_compare_width_degrees`
    tolerance : relative error of p that is allowed
    most_bytes : largest memory [bytes] of the matrices of the shoes, see
        `prepare.memory_bytes_of_condensation_on_divisions`
    penalty : factor alpha of the contact stiffness alpha E/t (lining modulus E, thickness t)
    cache : substructures of earlier solves

    Raises
    ------
    NoAnswer
        if the error of the first step cannot be estimated
    """
    allowed = WIDTH_ERROR_SHARE_OF_TOLERANCE * tolerance / error_factors_of_steps().pressure

    def solve_next_step(
        steps: list[tuple[PiecesAcrossWidthsOfShoes, SolvedFunctionsAcrossWidth]],
    ) -> None:
        """Solve the step after the last one of `steps`, and append it.

        Raises
        ------
        NoAnswer
            if the step has no answer, or takes too much memory
        """
        pieces = pieces_of_next_step(
            brake, steps[-1][0], [solved.response for _, solved in steps[-2:]], allowed
        )
        solved = _solve_pieces_with_open_columns(
            brake,
            plane,
            section.divisions,
            pieces,
            [earlier.response for _, earlier in steps],
            # The steps that give the error of the first step are always allowed.
            most_bytes=most_bytes if are_limited else math.inf,
            penalty=penalty,
            cache=cache,
        )
        steps.append((pieces, SolvedFunctionsAcrossWidth.answer_of_solved_level(solved)))

    first = coarsest_pieces_across_widths(brake)
    steps = [
        (
            first,
            SolvedFunctionsAcrossWidth.answer_of_solved_level(section.solved[first.degree]),
        )
    ]
    overhangs, are_limited = all(map(_has_narrow_first_piece, brake.shoes)), False
    while True:
        try:
            while len(steps) <= NUMBER_OF_COMPARED_STEPS:
                solve_next_step(steps)
                if overhangs and len(steps) == 2 and steps[0][0] is first:
                    yield _width_error_of_first_step(brake, steps, provisional=True)
        except NoAnswer:
            if steps[0][0] is first:
                raise
            return
        yield _width_error_of_first_step(brake, steps)
        steps, are_limited = steps[1:], True


def _solve_pieces_with_open_columns(
    brake: Brake,
    plane: Response,
    divisions: Mapping[int, ShoeElementDivision],
    pieces: PiecesAcrossWidthsOfShoes,
    earlier: Sequence[Response],
    *,
    most_bytes: float,
    penalty: float,
    cache: CacheOfCondensedBodies | None,
) -> SolvedLevel:
    """Solve a brake on some pieces across the width, with the columns open that were open before.

    Parameters
    ----------
    brake : the brake; the parts of a shoe have several widths
    plane : answer of plane stress
    divisions : divisions of the sections into hp elements
    pieces : the pieces
    earlier : answers with widths, in all of which the open columns are open
    most_bytes, penalty, cache : as in `errors_of_finer_pieces_across_width`

    Raises
    ------
    NoAnswer
        if the pieces have no answer, or take too much memory
    """

    def solve_with_open_columns(expected: Sequence[Response]) -> SolvedLevel:
        """Solve the brake with the columns that are open in all expected answers."""
        opened = divisions_with_open_columns(brake, divisions, expected)
        if most_bytes < memory_bytes_of_condensation_on_divisions(brake, opened, pieces):
            raise NoAnswer("the next pieces across the width take too much memory")
        scene = prepare_model_with_widths_on_given_elements(brake, opened, pieces, cache=cache)
        return SolvedLevel(scene, solve_prepared_model(scene, brake, penalty=penalty, start=plane))

    return solve_until_open_columns_stay_open(brake, earlier, solve_with_open_columns)


def _width_error_of_first_step(
    brake: Brake,
    steps: Sequence[tuple[PiecesAcrossWidthsOfShoes, SolvedFunctionsAcrossWidth]],
    *,
    provisional: bool = False,
) -> WidthError:
    """The error of the first one of several steps, from its distances from the other steps."""
    (pieces, solved), *further = steps
    moved = largest_relative_differences(
        brake, solved.response, [other.response for _, other in further]
    )
    factors = (
        error_factors_of_distance(pieces.degree, 1) if provisional else error_factors_of_steps()
    )
    error = moved.errors_times_factors(factors)
    return WidthError(pieces.degree, error, solved, provisional=provisional, pieces=pieces)


def _has_narrow_first_piece(shoe: Shoe) -> bool:
    """Whether at most LARGEST_FIRST_PIECE of a lining lies in the first piece across the width."""
    first = piece_ends_across_half_width_of_shoe(shoe)[1]
    return first <= LARGEST_FIRST_PIECE * shoe.lining.width / 2


def error_factors_of_distance(degree: int, ahead: int) -> PressureAndForceErrorFactors:
    """The stated errors of a degree across the width, divided by its distance from higher degrees.

    The distance is the largest of the relative differences between the answer with `degree` and the
    answers with the `ahead` next higher degrees.
    """
    ratio = error_divided_by_distance_to_next_degrees(degree, ahead)
    factors = NEXT_DEGREE_FACTORS
    if ahead == NUMBER_OF_COMPARED_HIGHER_WIDTH_DEGREES:
        factors = PressureAndForceErrorFactors(
            SAFETY_FACTORS_OF_SOLID_ERRORS.pressure, SAFETY_FACTORS_OF_SOLID_ERRORS.force
        )
    return PressureAndForceErrorFactors(ratio * factors.pressure, ratio * factors.force)


def error_factors_of_steps() -> PressureAndForceErrorFactors:
    """The stated errors of a step of finer pieces, divided by its distance from later steps.

    The distance is the largest of the relative differences between the answer of the step and the
    answers of the NUMBER_OF_COMPARED_STEPS next steps.
    """
    ratio = 1 / (1 - ASSUMED_FALL_OF_ERROR_IN_TWO_STEPS)
    fitted = SAFETY_FACTORS_OF_SOLID_ERRORS
    return PressureAndForceErrorFactors(ratio * fitted.pieces_pressure, ratio * fitted.pieces_force)


def largest_relative_differences(
    brake: Brake, response: Response, others: Sequence[Response]
) -> RelativeErrorsOfSolidModel:
    """For each quantity, the largest relative difference of a response from several others."""
    moved = [_relative_differences_from_better_response(brake, response, each) for each in others]
    shoes = []
    for own in zip(*(each.shoes for each in moved), strict=True):
        shoes.append(
            {name: max(each[name] for each in own) for name in QUANTITIES_WITH_STATED_ERROR}
        )
    return RelativeErrorsOfSolidModel(max(each.torque for each in moved), tuple(shoes))


def error_divided_by_distance_to_next_degrees(
    degree: int, ahead: int = NUMBER_OF_COMPARED_HIGHER_WIDTH_DEGREES
) -> float:
    """The error of a degree across the width, divided by its distance from higher degrees.

    The distance is the largest of the distances between the answer with `degree` and the answers
    with the `ahead` next higher degrees. The error is assumed to fall as the degree to the power
    -ASSUMED_WIDTH_ERROR_EXPONENT.
    """
    left = (degree / (degree + ahead)) ** ASSUMED_WIDTH_ERROR_EXPONENT
    return 1 / (1 - left)


def _relative_differences_from_better_response(
    brake: Brake, response: Response, true: Response
) -> RelativeErrorsOfSolidModel:
    """The relative differences of a response from a more accurate response `true`."""
    shoes = []
    for shoe, better in zip(response.shoes, true.shoes, strict=True):
        peak = better.peak_pressure or shoe.peak_pressure or 1.0
        apart = abs(shoe.peak_pressure - better.peak_pressure) / peak
        shoes.append(
            {
                **relative_torque_pressure_and_reaction_differences(
                    brake.surface_coordinate_per_phi, shoe, better
                ),
                "peak": apart,
            }
        )
    total = true.torque or response.torque or 1.0
    return RelativeErrorsOfSolidModel(abs(response.torque - true.torque) / total, tuple(shoes))
