"""Fit the safety factors of the stated errors of solid shoes on random brakes.

`width_error_rows_of_random_brake` solves a brake by several degrees, or by several steps of pieces
across the width, on one mesh of the section, or by low degrees on two or three meshes of the
section. Each row that it returns has an estimated error without its safety factor, and the true
error. `fit_safety_factors_of_width_errors` finds the smallest factors with which the estimates are
large enough. The command

    make calibrate

runs the study `calibration`, which calls these functions and writes the file of the factors and the
table of the rows.
"""

import csv
import math
from collections.abc import Mapping, Sequence
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np

from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.brake import Brake, Shoe
from drumlin.fem.error_control.adapt import TolerancesOfPressureAndTorque
from drumlin.fem.error_control.levels import REFINEMENT_LEVELS_FROM_COARSE_TO_FINE
from drumlin.fem.hp.division import ShoeElementDivision
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.cache import CacheOfCondensedBodies
from drumlin.fem.solve import solve
from drumlin.fem.width.error import relative_distance_of_plane_stress_from_width_solution
from drumlin.fem.width.functions import (
    SAME_HALF_WIDTH_TOLERANCE,
    FunctionsAcrossWidth,
    functions_across_width_of_shoe,
    half_widths_of_parts,
    has_parts_of_different_widths,
    piece_ends_across_half_width_of_shoe,
)
from drumlin.fem.width.ladder import (
    ASSUMED_FALL_OF_ERROR_IN_TWO_STEPS,
    MOST_LEVELS_FOR_SECTION_ERROR_ESTIMATE,
    NUMBER_OF_COMPARED_HIGHER_WIDTH_DEGREES,
    PressureAndForceErrorFactors,
    SafetyFactorsOfSolidErrors,
    SectionLevelWithItsError,
    error_divided_by_distance_to_next_degrees,
    error_factors_of_steps,
    errors_of_finer_pieces_across_width,
    errors_of_solved_cross_section_meshes,
    hp_elements_to_compare_width_degrees,
    refine_cross_section_mesh_until_tolerance_is_met,
    solve_cross_section_mesh_with_width_degree,
)
from drumlin.fem.width.levels import REFINEMENT_LEVELS_OF_SHOES_WITH_SEVERAL_WIDTHS
from drumlin.fem.width.prepare import (
    MakeWidthFunctionsOfShoe,
    number_of_displacement_unknowns_of_shoe,
    prepare_model_with_widths_on_given_elements,
    reason_why_width_model_does_not_apply,
)
from drumlin.response.response import Response
from drumlin_studies.calibration import (
    round_up_to_significant_digits,
    safety_factors_as_json_text,
)
from drumlin_studies.solid_error import (
    DEGREE_OF_POLYNOMIAL_PIECES_ACROSS_TRUTH_WIDTH,
    FUNCTIONS_THAT_DRAW_BRAKES_BY_SOLID_KIND,
    MOST_CONTACT_NODES_OF_TRUTH,
    functions_across_width_on_fine_pieces,
)

LENGTH_OF_POLYNOMIAL_PIECES_BESIDE_PART_SIDES = 0.2
"""Length across the width of the short pieces beside the side of a part. On each piece the
reference solution's functions across the width are polynomials.

The length is relative to the lining's thickness, or to the distance of the next break (end of a
piece) if this distance is less. Pieces much shorter than the elements of the section only add
unknowns.
"""
SEEDS_FOR_FIT_TO_ERRORS_OF_WIDTH_DEGREE: dict[str, Sequence[int]] = {
    "free": range(1000, 1021),
    "built": range(3100, 3107),
}
"""Seeds of the brakes to which the safety factors for errors of the degree across the width are
fitted.

The keys are kinds in `solid_error.FUNCTIONS_THAT_DRAW_BRAKES_BY_SOLID_KIND`.
"""
SEEDS_FOR_FIT_TO_ERRORS_OF_STEPS: dict[str, Sequence[int]] = {
    "free": (*range(1000, 1021), 1403, 1405, 1406, 1408, 1409, *range(1411, 1415), 1417),
    "built": (*range(3100, 3107), 1403, 1414, 1417, 1419, 1420, 1421),
}
"""Seeds of the brakes to which the safety factors for errors of the steps of finer pieces are
fitted.

The keys are kinds in `solid_error.FUNCTIONS_THAT_DRAW_BRAKES_BY_SOLID_KIND`. Of the seeds from 1400
to 1421 those are listed whose brakes have rows. The other 28 brakes have no rows, for instance
because they have one width, or a truth that is too large. The listed seeds were added to test the
factors. Some of them need larger factors than all other brakes: "free" 1406 needs 1.41 for
pressures, and "free" 1403 needs 1.66 for forces.
"""
TOLERANCE_OF_SOLVES_IN_FIT_TO_STEPS = 0.01
"""Relative error of p up to which pieces are split in the fit to the errors of steps.

It is the tolerance of a solve with `--model solid` if no other is asked for.
"""
MOST_BYTES_IN_FIT_TO_STEPS = 160_000_000
"""Largest memory [bytes] of the matrices of the shoes in a step of the fit.

The memory is that of `prepare.memory_bytes_of_condensation_on_divisions`. With larger values the
fit takes more time and memory; with smaller values it has fewer steps.
"""
MOST_UNKNOWNS_OF_TRUTH_IN_FIT_TO_STEPS = 100_000
"""Largest number of unknowns of a shoe in the truth of the fit to the errors of steps.

A truth with 100 000 unknowns takes 30 s and 2 GB.
"""
SEEDS_FOR_FIT_TO_ERRORS_OF_SECTION_MESH: dict[str, Sequence[int]] = {
    "free": (1000, 1001, *range(1003, 1010), *range(1011, 1015), 1016, 1017, 1019, 1020),
    "built": (3100, 3102, 3104, 3105, 3106, 3108, 3109, 3110, 3111, 3117),
}
"""Seeds of the brakes to which the safety factors for errors of the mesh in the section (the plane
of the drum) are fitted.

The keys are kinds in `solid_error.FUNCTIONS_THAT_DRAW_BRAKES_BY_SOLID_KIND`. The four "free" brakes
between 1000 and 1020 that are not listed have one width, or no answer. The "built" brakes are few,
because such a brake takes up to 22 s.
"""
DEGREES_ACROSS_WIDTH_IN_FIT = (2, 3, 4, 5)
"""Degrees across the width to whose errors the safety factors are fitted."""
DEGREE_ACROSS_WIDTH_FOR_TRUE_SECTION_ERROR = 2
"""Degree across the width with which the true errors of the section's mesh are measured.

With degree 3 the meshes have up to half a million unknowns. On a brake with a wide overhang
("built" 3104) the distance of the first two meshes of plane stress was 0.40 % of the pressure with
degree 2 and with degree 3.
"""
MOST_UNKNOWNS_OF_TRUTH_IN_FIT_TO_SECTION = 100_000
"""Largest number of unknowns of a shoe on the third level with which this level gives the truth.

The unknowns are those of REFINEMENT_LEVELS_OF_SHOES_WITH_SEVERAL_WIDTHS. The truth has the third
level of plane stress, with 1.2 to 1.3 times as many unknowns. With larger values the fit has more
rows of the second level, and takes more time.
"""
FRACTION_COVERED_BY_STATED_WIDTH_ERROR = 0.99
"""Fraction of the solves in the fit whose stated errors must be at least as large as the true
errors.
"""
LARGEST_TRUE_OVER_STATED_ERROR_ALLOWED_IN_FIT = 2.0
"""Largest ratio of a true error to its stated error that the fit allows on any solve."""
LEAST_TRUE_ERROR_IN_FIT_BY_QUANTITY = {"pressure": 1e-3, "torque": 1e-5, "reaction": 1e-5}
"""Smallest true relative error with which a row enters the fit, by quantity.

Smaller errors are no larger than the effect of round-off, and of the contact's ends, which can only
lie at nodes.
"""
LEAST_TRUE_ERROR_IN_FIT_OVER_ITS_UNCERTAINTY = 2.0
"""Smallest true error with which a row enters the fit, relative to the uncertainty of the true
error.

True errors are measured against a reference solution, which has an error of its own. For degrees
its uncertainty is its distance from the solution with the highest degree across the width, and for
steps its distance from a reference of one degree less. On one brake with a wide overhang ("free"
1009) the torque of the reference is off by 1.5e-3, while the torque with degree 5 is off by only
3e-4. With a value of 2 to 2.5 the fitted safety factor of forces is 1.2. With 1.5 it is 2.6 and
with 0 it is 5.7, because errors of the reference are then taken for true errors. With 4 the fit
loses all brakes whose errors fall slowly with the degree, by a factor of 3.5 from degree 2 to
degree 7.
"""
MEANINGS_OF_SOLID_SAFETY_FACTORS = {
    "pressure": "Multiplies the estimated error of p (L2 norm) that is due to the finite degree "
    "across the width. The estimate is the distance of an answer from the answers with the next "
    "two degrees, extrapolated to an infinite degree with the power "
    "ASSUMED_WIDTH_ERROR_EXPONENT. If the factor is "
    "too small, stated errors of p are too small. If it is too large, solves take a higher degree "
    "than they need.",
    "force": "Multiplies the estimated error of a torque or a reaction that is due to the finite "
    "degree across the width. The distances of a force cancel by accident where those of p do not, "
    "and so this factor is larger. If the factor is too small, stated errors of forces are too "
    "small. If it is too large, they are needlessly large.",
    "pieces_pressure": "Multiplies the estimated error of p (L2 norm) that is due to the pieces "
    "across the width and the degree on them, if parts of a shoe have several widths. The estimate "
    "is the distance of an answer from the answers of the next two steps of finer pieces, divided "
    "by 1 - ASSUMED_FALL_OF_ERROR_IN_TWO_STEPS. If the factor is too small, stated errors of p are "
    "too small. If it is too large, solves take finer pieces than they need.",
    "pieces_force": "Multiplies the estimated error of a torque or a reaction that is due to the "
    "pieces across the width. If the factor is too small, stated errors of forces are too small. "
    "If it is too large, they are needlessly large.",
    "two_levels_pressure": "Multiplies the estimated error of p (L2 norm) that is due to the hp "
    "elements in the section, the x-y plane of the brake, if parts of a shoe have several widths, "
    "and if the estimate follows from two levels of these elements. The estimate is made with the "
    "low degree WIDTH_DEGREE_FOR_HP_ELEMENT_ERROR_ESTIMATE across the width. If the factor is too "
    "small, stated errors of p are too small. If it is too large, solves take a third level that "
    "they do not need.",
    "two_levels_force": "Multiplies the estimated error of a torque or a reaction that is due to "
    "the hp elements in the section, if parts of a shoe have several widths, and if the estimate "
    "follows from two levels of these elements. If the factor is too small, stated errors of "
    "forces are too small. If it is too large, they are needlessly large.",
    "section_pressure": "Multiplies the estimated error of p (L2 norm) that is due to the hp "
    "elements in the section, if parts of a shoe have several widths, and if the estimate follows "
    "from three levels of these elements. If the factor is too small, stated errors of p are too "
    "small. If it is too large, solves take a finer section than they need.",
    "section_force": "Multiplies the estimated error of a torque or a reaction that is due to the "
    "hp elements in the section, if parts of a shoe have several widths, and if the estimate "
    "follows from three levels of these elements. If the factor is too small, stated errors of "
    "forces are too small. If it is too large, they are needlessly large.",
}
"""The meaning of each safety factor, as the file of the factors states it."""


class EstimatedAndTrueErrorOfSolidShoe(NamedTuple):
    """The estimated error of a solid shoe, before its safety factor, and the true error.

    Attributes
    ----------
    kind, seed : kind in `solid_error.FUNCTIONS_THAT_DRAW_BRAKES_BY_SOLID_KIND` and seed of the
        random brake
    part : "width" for the error of the degree across the width, "pieces" for the error of a step of
        finer pieces across the width, "two levels" and "section" for the error of the mesh in the
        section that is estimated from two and from three levels
    degree : degree across the width; for "pieces" the number of the step, and for the mesh in the
        section the number of the level, both counted from 0
    quantity : "pressure", "torque" or "reaction"
    estimate : the estimated relative error without its safety factor
    true : the true relative error
    unsure : uncertainty of the true error; 0 for the mesh in the section
    """

    kind: str
    seed: int
    part: str
    degree: int
    quantity: str
    estimate: float
    true: float
    unsure: float

    @property
    def is_row_usable_for_fit(self) -> bool:
        """Whether the row enters the fit: its true error must be large and certain enough."""
        least = max(
            LEAST_TRUE_ERROR_IN_FIT_BY_QUANTITY[self.quantity],
            LEAST_TRUE_ERROR_IN_FIT_OVER_ITS_UNCERTAINTY * self.unsure,
        )
        return self.true > least


def width_error_rows_of_random_brake(
    part: str, kind: str, seed: int
) -> list[EstimatedAndTrueErrorOfSolidShoe]:
    """The estimated and true errors of a random brake, as rows for the fit.

    The list is empty if the model with widths does not apply or a solve has no answer.

    Parameters
    ----------
    part : "width" for errors of the degree across the width, "pieces" for errors of the steps of
        finer pieces across the width, "section" for errors of the mesh in the section
    kind : how the brake is drawn, a name in `solid_error.FUNCTIONS_THAT_DRAW_BRAKES_BY_SOLID_KIND`
    seed : seed of the brake
    """
    observe = {
        "width": error_rows_of_degrees_across_width,
        "pieces": error_rows_of_steps_of_finer_pieces,
        "section": error_rows_of_cross_section_levels,
    }[part]
    try:
        brake = FUNCTIONS_THAT_DRAW_BRAKES_BY_SOLID_KIND[kind](seed)
        if reason_why_width_model_does_not_apply(brake) is not None:
            return []
        rows = observe(brake, solve(brake))
    except (BadInput, NoAnswer, np.linalg.LinAlgError):
        return []
    return [row._replace(kind=kind, seed=seed) for row in rows]


def functions_across_width_graded_to_sides(
    shoe: Shoe, degree: int = DEGREE_OF_POLYNOMIAL_PIECES_ACROSS_TRUTH_WIDTH
) -> FunctionsAcrossWidth:
    """Functions across the width of a shoe, with short pieces beside the sides of all its parts.

    `degree` is the degree of the functions in each piece.
    """
    halves, breaks = half_widths_of_parts(shoe).values(), piece_ends_across_half_width_of_shoe(shoe)

    def is_side_of_shoe_part_at_distance_from_mid_plane(place: float) -> bool:
        """Whether a part of the shoe ends at the distance `place` [m] from the mid-plane."""
        return any(abs(place - half) <= SAME_HALF_WIDTH_TOLERANCE * half for half in halves)

    found = set(breaks)
    for inner, outer in pairwise(breaks):
        size = LENGTH_OF_POLYNOMIAL_PIECES_BESIDE_PART_SIDES * min(
            outer - inner, shoe.lining.thickness
        )
        if is_side_of_shoe_part_at_distance_from_mid_plane(inner):
            found.add(inner + size)
        if is_side_of_shoe_part_at_distance_from_mid_plane(outer):
            found.add(outer - size)
    return FunctionsAcrossWidth(tuple(sorted(found)), degree)


def error_rows_of_degrees_across_width(
    brake: Brake, plane: Response
) -> list[EstimatedAndTrueErrorOfSolidShoe]:
    """Rows with estimated and true errors of several degrees across the width, on one mesh.

    The true error of a degree is the distance of its answer from the truth, whose functions across
    the width are graded to the sides of all parts. The answer of the highest degree has other
    errors than the truth. Its distance from the truth therefore serves as the uncertainty of the
    true errors. `plane` is the response by plane stress.
    """
    cache = CacheOfCondensedBodies()
    section = hp_elements_to_compare_width_degrees(brake, plane, cache=cache)

    def solve_with_degree_across_width(across: int | MakeWidthFunctionsOfShoe) -> Response:
        """The response with a degree across the width or with the width functions from `across`."""
        scene = prepare_model_with_widths_on_given_elements(
            brake, section.divisions, across, cache=cache
        )
        return solve_prepared_model(scene, brake, start=plane)

    truth = solve_with_degree_across_width(functions_across_width_graded_to_sides)
    last = DEGREES_ACROSS_WIDTH_IN_FIT[-1] + NUMBER_OF_COMPARED_HIGHER_WIDTH_DEGREES
    answers = {
        degree: solve_with_degree_across_width(degree)
        for degree in range(DEGREES_ACROSS_WIDTH_IN_FIT[0], last + 1)
    }
    distance_of = partial(relative_distance_of_plane_stress_from_width_solution, brake)
    unsure = distance_of(answers[last], truth).brake
    rows = []
    for degree in DEGREES_ACROSS_WIDTH_IN_FIT:
        ahead = [
            distance_of(answers[degree], answers[further]).brake
            for further in range(degree + 1, degree + NUMBER_OF_COMPARED_HIGHER_WIDTH_DEGREES + 1)
        ]
        true = distance_of(answers[degree], truth).brake
        factor = error_divided_by_distance_to_next_degrees(degree)
        for name in LEAST_TRUE_ERROR_IN_FIT_BY_QUANTITY:
            estimate = factor * max(distance[name] for distance in ahead)
            rows.append(
                EstimatedAndTrueErrorOfSolidShoe(
                    "", 0, "width", degree, name, estimate, true[name], unsure[name]
                )
            )
    return rows


def largest_number_of_unknowns_on_divisions(
    brake: Brake, divisions: Mapping[int, ShoeElementDivision], make: MakeWidthFunctionsOfShoe
) -> int:
    """The largest number of unknowns of a shoe, before any model of it is made.

    Parameters
    ----------
    brake : the brake
    divisions : divisions of the sections into hp elements, by the index of the first shoe of each
        shape
    make : function from a shoe to its functions across the width
    """
    return max(
        number_of_displacement_unknowns_of_shoe(brake.shoes[i], division, make(brake.shoes[i]))
        for i, division in divisions.items()
    )


def error_rows_of_steps_of_finer_pieces(
    brake: Brake, plane: Response
) -> list[EstimatedAndTrueErrorOfSolidShoe]:
    """Rows with estimated and true errors of the steps of finer pieces across the width.

    All steps have the same mesh in the section. The true error of a step is the distance of its
    answer from the truth, which has fine pieces across the width. The distance between this truth
    and the one of the next lower degree serves as the uncertainty of the true errors. The steps end
    before their memory exceeds MOST_BYTES_IN_FIT_TO_STEPS. A distance of the last step from the
    truth would be a larger uncertainty where errors fall slowly. The fit would then leave out the
    brakes that need the largest factors of forces.

    The list is empty if all shoes have one width, or if the truth has more unknowns than
    MOST_UNKNOWNS_OF_TRUTH_IN_FIT_TO_STEPS. `plane` is the response by plane stress.
    """
    if not any(map(has_parts_of_different_widths, brake.shoes)):
        return []
    cache = CacheOfCondensedBodies()
    section = hp_elements_to_compare_width_degrees(brake, plane, cache=cache)
    unknowns = largest_number_of_unknowns_on_divisions(
        brake, section.divisions, functions_across_width_on_fine_pieces
    )
    if unknowns > MOST_UNKNOWNS_OF_TRUTH_IN_FIT_TO_STEPS:
        return []
    steps = errors_of_finer_pieces_across_width(
        brake,
        plane,
        section,
        TOLERANCE_OF_SOLVES_IN_FIT_TO_STEPS,
        most_bytes=MOST_BYTES_IN_FIT_TO_STEPS,
        cache=cache,
    )
    known = [step for step in steps if not step.provisional]

    def truth_of_degree(degree: int) -> Response:
        """The response with polynomials of a degree on fine pieces across the width."""
        scene = prepare_model_with_widths_on_given_elements(
            brake,
            section.divisions,
            partial(functions_across_width_on_fine_pieces, degree=degree),
            cache=cache,
            most_contact_nodes=MOST_CONTACT_NODES_OF_TRUTH,
        )
        return solve_prepared_model(scene, brake, start=plane)

    truth = truth_of_degree(DEGREE_OF_POLYNOMIAL_PIECES_ACROSS_TRUTH_WIDTH)
    truth_of_lower_degree = truth_of_degree(DEGREE_OF_POLYNOMIAL_PIECES_ACROSS_TRUTH_WIDTH - 1)
    distance_of = partial(relative_distance_of_plane_stress_from_width_solution, brake)
    unsure = distance_of(truth_of_lower_degree, truth).brake
    factors, rows = error_factors_of_steps(), []
    ratio = 1 / (1 - ASSUMED_FALL_OF_ERROR_IN_TWO_STEPS)
    for number, step in enumerate(known):
        true = distance_of(step.solved.response, truth).brake
        for name in LEAST_TRUE_ERROR_IN_FIT_BY_QUANTITY:
            factor = factors.pressure if name == "pressure" else factors.force
            estimate = step.error.largest_error_by_name(name) * ratio / factor
            rows.append(
                EstimatedAndTrueErrorOfSolidShoe(
                    "", 0, "pieces", number, name, estimate, true[name], unsure[name]
                )
            )
    return rows


def error_rows_of_cross_section_levels(
    brake: Brake, plane: Response
) -> list[EstimatedAndTrueErrorOfSolidShoe]:
    """Rows with the estimated and true errors due to the first two levels of the section's mesh.

    A solve estimates the errors from two or from three levels, with the degree
    `ladder.WIDTH_DEGREE_FOR_HP_ELEMENT_ERROR_ESTIMATE` across the width. There are rows of both
    estimates. A true error is the distance of the answer on a level from the truth, both with the
    degree DEGREE_ACROSS_WIDTH_FOR_TRUE_SECTION_ERROR. The truth has the third level of plane
    stress, with its small layers of elements at the interfaces of parts. If the third level of the
    solve has more than MOST_UNKNOWNS_OF_TRUTH_IN_FIT_TO_SECTION unknowns, the truth has the second
    level of plane stress, and there are rows of the first level only. The list is empty if all
    shoes have one width. `plane` is the response by plane stress.
    """
    if not any(map(has_parts_of_different_widths, brake.shoes)):
        return []
    levels = REFINEMENT_LEVELS_OF_SHOES_WITH_SEVERAL_WIDTHS[:MOST_LEVELS_FOR_SECTION_ERROR_ESTIMATE]
    cache = CacheOfCondensedBodies(room=0)

    def estimated_errors_of_levels(tolerance: float) -> list[SectionLevelWithItsError]:
        """The estimates from as many levels as a solve to the relative `tolerance` needs."""
        climb = refine_cross_section_mesh_until_tolerance_is_met(
            brake,
            TolerancesOfPressureAndTorque(tolerance, tolerance),
            solve_prepared_model,
            cache,
            levels,
            plane,
        )
        return errors_of_solved_cross_section_meshes(
            brake, climb, PressureAndForceErrorFactors(1.0, 1.0)
        )

    # A loose tolerance is met on the second level, and a tight one on no level.
    loose, tight = (estimated_errors_of_levels(tolerance) for tolerance in (1.0, 1e-9))
    unknowns = largest_number_of_unknowns_on_divisions(
        brake,
        tight[-1].divisions,
        partial(functions_across_width_of_shoe, degree=DEGREE_ACROSS_WIDTH_FOR_TRUE_SECTION_ERROR),
    )
    judged_levels = 2 if unknowns <= MOST_UNKNOWNS_OF_TRUTH_IN_FIT_TO_SECTION else 1
    answers = [
        solve_cross_section_mesh_with_width_degree(
            brake, level, DEGREE_ACROSS_WIDTH_FOR_TRUE_SECTION_ERROR, plane, cache=cache
        ).response
        for level in (*levels[:judged_levels], REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[judged_levels])
    ]
    rows = []
    for number in range(judged_levels):
        true = relative_distance_of_plane_stress_from_width_solution(
            brake, answers[number], answers[-1]
        ).brake
        for part, solved, count in (("two levels", loose, 2), ("section", tight, 3)):
            # An estimate is used only if all its levels have answers.
            if [own.level for own in solved] != list(levels[:count]):
                continue
            error = solved[number].error
            for name in LEAST_TRUE_ERROR_IN_FIT_BY_QUANTITY:
                stated = error.largest_error_by_name(name)
                rows.append(
                    EstimatedAndTrueErrorOfSolidShoe(
                        "", 0, part, number, name, stated, true[name], 0.0
                    )
                )
    return rows


def smallest_safety_factor_of_width_errors(
    rows: Sequence[EstimatedAndTrueErrorOfSolidShoe],
) -> float:
    """The smallest safety factor that makes the estimates large enough, rounded up to two digits.

    A stated error is an estimate times the factor. For the fraction
    FRACTION_COVERED_BY_STATED_WIDTH_ERROR of all solves the stated errors are at least as large as
    the true errors, or for about all solves but one if there are few. No true error is more than
    LARGEST_TRUE_OVER_STATED_ERROR_ALLOWED_IN_FIT times its stated error. A solve is one brake with
    one degree. The factor that a solve needs is the largest that one of its quantities needs. The
    result is nan without usable rows.
    """
    by_solve: dict[tuple[str, int, int], float] = {}
    for row in rows:
        if row.is_row_usable_for_fit:
            solve_key = (row.kind, row.seed, row.degree)
            by_solve[solve_key] = max(row.true / row.estimate, by_solve.get(solve_key, 0.0))
    if not by_solve:
        return math.nan
    needed = list(by_solve.values())
    share = min(FRACTION_COVERED_BY_STATED_WIDTH_ERROR, 1 - 1 / len(needed))
    covering = float(np.quantile(needed, share))
    return round_up_to_significant_digits(
        max(covering, max(needed) / LARGEST_TRUE_OVER_STATED_ERROR_ALLOWED_IN_FIT)
    )


def fit_safety_factors_of_width_errors(
    rows: Sequence[EstimatedAndTrueErrorOfSolidShoe],
) -> SafetyFactorsOfSolidErrors:
    """Fit the safety factors of the stated errors of solid shoes to rows of observed errors."""
    factors = []
    for part in ("width", "pieces", "two levels", "section"):
        for of_pressure in (True, False):
            own = [
                row
                for row in rows
                if row.part == part and (row.quantity == "pressure") == of_pressure
            ]
            factors.append(smallest_safety_factor_of_width_errors(own))
    return SafetyFactorsOfSolidErrors(*factors)


def width_safety_factors_as_json_text(
    factors: SafetyFactorsOfSolidErrors,
    rows: Sequence[EstimatedAndTrueErrorOfSolidShoe],
    commit: str,
    date: str,
) -> str:
    """The JSON text of the file of safety factors: each factor with its meaning, and its origin.

    Parameters
    ----------
    factors : the fitted factors
    rows : the rows to which the factors are fitted
    commit, date : commit of the source code, and its date
    """
    brakes = {(row.kind, row.seed) for row in rows}
    provenance = {
        "brakes": len(brakes),
        "rows": sum(row.is_row_usable_for_fit for row in rows),
        "commit": commit,
        "date": date,
        "quantile": FRACTION_COVERED_BY_STATED_WIDTH_ERROR,
    }
    return safety_factors_as_json_text(
        factors._asdict(), MEANINGS_OF_SOLID_SAFETY_FACTORS, provenance, "drumlin.fem.width.ladder"
    )


def width_error_rows_as_csv_text(rows: Sequence[EstimatedAndTrueErrorOfSolidShoe]) -> str:
    """The rows as the text of a CSV table, with errors of four digits."""
    lines = [",".join(EstimatedAndTrueErrorOfSolidShoe._fields)]
    for row in rows:
        errors = [f"{value:.4g}" for value in (row.estimate, row.true, row.unsure)]
        lines.append(",".join([*map(str, row[: -len(errors)]), *errors]))
    return "\n".join(lines) + "\n"


def read_width_error_rows_from_csv(path: Path) -> list[EstimatedAndTrueErrorOfSolidShoe]:
    """Read the rows from a CSV table that `width_error_rows_as_csv_text` has made."""
    rows = []
    with path.open(encoding="utf-8", newline="") as file:
        for one in csv.DictReader(file):
            rows.append(
                EstimatedAndTrueErrorOfSolidShoe(
                    kind=one["kind"],
                    seed=int(one["seed"]),
                    part=one["part"],
                    degree=int(one["degree"]),
                    quantity=one["quantity"],
                    estimate=float(one["estimate"]),
                    true=float(one["true"]),
                    unsure=float(one["unsure"]),
                )
            )
    return rows
