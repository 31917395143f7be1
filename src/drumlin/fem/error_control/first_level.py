"""Errors of the first level of a solve, known from a sample of similar brakes.

A sweep solves many brakes that differ little. The first level of a solve takes a third of the time,
and the finer levels serve to state its errors. If some brakes of the sweep, the sample, are solved
on all levels, the distances of their first levels from their last levels show how wrong the first
level is. The other brakes are then solved on the first level only, and take their errors from the
sample. The errors of the sample hold as long as the contact is of the same kind: near an end of the
contact that has lifted off, or at a new opening, the pressure has a singular point that the sample
has not.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace

import numpy as np

from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake, Shoe
from drumlin.fem.error_control.adapt import (
    errors_with_singular_points_and_text_on_short_contacts,
    response_with_estimated_errors,
)
from drumlin.fem.error_control.estimate import (
    QUANTITIES_WITH_STATED_ERROR,
    SAFETY_FACTORS_OF_ERROR_ESTIMATE,
    EstimatedErrors,
    SafetyFactorsOfErrorEstimate,
    relative_differences_of_responses_on_two_levels,
    sum_of_penalty_and_round_off_errors,
)
from drumlin.fem.error_control.levels import (
    REFINEMENT_LEVELS_FROM_COARSE_TO_FINE,
    FunctionThatComputesResponse,
    SolvedLevel,
    solve_brake_on_finer_and_finer_mesh_levels,
)
from drumlin.fem.error_control.singular_points import (
    BINARY_DIGITS_OF_ROUNDED_CONTACT_END,
    singular_points_of_each_shoe_shape,
)
from drumlin.fem.hp.corner import response_with_power_laws_at_corners
from drumlin.fem.hp.division import KindOfSingularPoint, SingularPoint
from drumlin.fem.preparation.cache import CacheOfCondensedBodies
from drumlin.response.response import Response

SAFETY_FACTOR_OF_LARGEST_ERROR_IN_SAMPLE = 2.0
"""Safety factor on the largest error of the first level in a sample, for brakes outside the sample.

The stated error of a brake that is not in the sample is this factor times the largest error of the
sample. On eleven sweeps with 100 samples each, no distance of a first level from its last level was
larger than 1.9 times the largest error of the sample. The sweeps vary clearance, radius, hinge,
arc, modulus, friction and thickness of drum brakes, shoes of T-section, a duo-servo brake, a block
and manufacturing tolerances. With a smaller factor some stated errors are too small. With a larger
factor stated errors are larger than they need be.
"""

FACTORS_FROM_DISTANCE_TO_FIRST_LEVEL_ERROR = SafetyFactorsOfErrorEstimate(
    pressure=1.0 + SAFETY_FACTORS_OF_ERROR_ESTIMATE.pressure,
    force=1.0 + SAFETY_FACTORS_OF_ERROR_ESTIMATE.force,
    cancelled=SAFETY_FACTORS_OF_ERROR_ESTIMATE.cancelled,
    peak=1.0 + SAFETY_FACTORS_OF_ERROR_ESTIMATE.peak,
)
"""Largest ratio of the error of the first level to its distance from the last level.

The error of the first level is at most its distance from the last level plus the error of the last
level. The error of the last level is at most SAFETY_FACTORS_OF_ERROR_ESTIMATE times this distance.
"""


def solve_brake_on_first_refinement_level(
    brake: Brake, respond: FunctionThatComputesResponse, cache: CacheOfCondensedBodies | None = None
) -> Response:
    """The response of a brake on the first level of a solve, without errors.

    `respond` computes the response on a prepared model, and `cache` keeps the condensed bodies.
    Raises NoAnswer if the first level has no solution.
    """
    levels = solve_brake_on_finer_and_finer_mesh_levels(
        brake, respond, cache, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[:1]
    )
    solved = next(levels, None)
    if solved is None:
        raise NoAnswer("the first level has no solution")
    return response_with_power_laws_at_corners(brake, solved.response)


def solve_on_levels_and_hand_out_first(
    brake: Brake,
    respond: FunctionThatComputesResponse,
    cache: CacheOfCondensedBodies | None,
    use: Callable[[Response], None],
) -> Iterator[SolvedLevel]:
    """Solve a brake on finer and finer levels, and hand out the response on the first level.

    Parameters
    ----------
    brake : the brake
    respond : function that computes the response on a prepared model
    cache : keeps the condensed bodies of earlier solves
    use : called with the response that `solve_brake_on_first_refinement_level` would return; not
        called if the first level has no solution

    Raises
    ------
    NoAnswer
        as `solve_brake_on_finer_and_finer_mesh_levels` does
    """
    levels = solve_brake_on_finer_and_finer_mesh_levels(
        brake, respond, cache, first_level_is_an_answer=True
    )
    for solved in levels:
        # Only the first level has elements of its degree.
        division = next(iter(solved.prepared_model.divisions.values()))
        if division.degree == REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0].degree:
            use(response_with_power_laws_at_corners(brake, solved.response))
        yield solved


def errors_of_first_refinement_level(
    brake: Brake, first: Response, last: Response
) -> dict[str, float]:
    """The errors of the response on the first level, from its distance to the last level.

    The errors are relative and have the names of QUANTITIES_WITH_STATED_ERROR. Errors at singular
    points, by the penalty and by round-off are not included. On a plane the errors of the torque
    are those of the braking force.
    """
    first, last = map(_response_with_braking_forces_as_torques, (first, last))
    moved = relative_differences_of_responses_on_two_levels(brake, first, last)
    factors = FACTORS_FROM_DISTANCE_TO_FIRST_LEVEL_ERROR.safety_factors_of_level_differences(
        len(last.shoes)
    )
    found = (
        factors * moved.differences
        + FACTORS_FROM_DISTANCE_TO_FIRST_LEVEL_ERROR.cancelled * moved.changes_with_random_signs
    )
    worst = np.reshape(found[1:], (-1, len(QUANTITIES_WITH_STATED_ERROR))).max(axis=0).tolist()
    return dict(zip(QUANTITIES_WITH_STATED_ERROR, worst, strict=True)) | {"torque": float(found[0])}


def _response_with_braking_forces_as_torques(response: Response) -> Response:
    """A copy of a response in which shoes on a plane have their braking force [N] as `torque`.

    The response on a level of a solve has the braking force as `torque` already. A finished solve
    adds figures of merit: the braking force is then one of them, and `torque` is 0.
    """
    shoes = zip(response.shoes, response.effects, strict=True)
    return replace(response, shoes=tuple(replace(shoe, torque=effect) for shoe, effect in shoes))


def first_level_response_with_errors_of_sample(
    brake: Brake, first: Response, largest: Mapping[str, float]
) -> Response:
    """A copy of a response on the first level, with stated errors from a sample of similar brakes.

    `largest` are the largest errors of the first level in the sample, as
    `errors_of_first_refinement_level` returns them. The stated errors are
    SAFETY_FACTOR_OF_LARGEST_ERROR_IN_SAMPLE times these errors, plus the errors of the brake itself
    at singular points, by the penalty and by round-off.
    """
    of_sample = {
        name: SAFETY_FACTOR_OF_LARGEST_ERROR_IN_SAMPLE * error for name, error in largest.items()
    }
    own = sum_of_penalty_and_round_off_errors(first.shoes)
    shoes = []
    for row in np.reshape(own[1:], (-1, len(QUANTITIES_WITH_STATED_ERROR))).tolist():
        by_name = zip(QUANTITIES_WITH_STATED_ERROR, row, strict=True)
        shoes.append({name: of_sample[name] + more for name, more in by_name})
    errors = EstimatedErrors.brake_errors_from_torque_and_shoe_errors(
        of_sample["torque"] + float(own[0]), shoes
    )
    errors, _ = errors_with_singular_points_and_text_on_short_contacts(errors, brake, first)
    return response_with_estimated_errors([first], errors, ())


def text_that_identifies_kind_of_contact(brake: Brake, response: Response) -> str:
    """A text that is equal for contacts of one kind.

    It names, for each shoe, the singular points of the pressure in their order along the lining:
    ends of the contact and of openings, steps, kinks and tips. An end of the contact at the end of
    a lining is a corner. The text also says whether friction helps the actuation and which anchors,
    abutments and struts bear.
    """
    every_shoe_by_itself = tuple(range(len(brake.shoes)))
    error = REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0].pressure_error_due_to_column_size_ratio
    points = singular_points_of_each_shoe_shape(brake, response, every_shoe_by_itself, error)
    words = []
    for i, (shoe, answer) in enumerate(zip(brake.shoes, response.shoes, strict=True)):
        words += [_kind_of_singular_point(shoe, point) for point in points[i]]
        words.append("helped" if answer.self_energising else "not helped")
        words += ["bears" if force.push.force else "clear" for force in answer.supports]
    return ", ".join(words)


def _kind_of_singular_point(shoe: Shoe, point: SingularPoint) -> str:
    """The kind of a singular point of the pressure on a shoe; "corner" at an end of a lining."""
    # The position of the point may be rounded, see BINARY_DIGITS_OF_ROUNDED_CONTACT_END. A point
    # this near to a lining's end therefore lies at the end.
    near = 2.0 ** (1 - BINARY_DIGITS_OF_ROUNDED_CONTACT_END) * point.length
    at_end_of_lining = any(abs(point.position - end) <= near for arc in shoe.arcs for end in arc)
    if point.kind == KindOfSingularPoint.END and at_end_of_lining:
        return "corner"
    return str(point.kind.name)
