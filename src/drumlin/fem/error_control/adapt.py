"""Solve a brake to a tolerance, on finer and finer levels.

A level is a division of the brake into hp elements. The solve ends on the first level whose
estimated errors are below the tolerance.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from drumlin.base.errors import BadInput, NoAnswer
from drumlin.base.texts import error_text_in_percent
from drumlin.brake import clearance
from drumlin.brake.brake import Brake, Shoe
from drumlin.fem.error_control.estimate import (
    SAFETY_FACTOR_OF_PENALTY_ERROR,
    EstimatedErrors,
    estimate_errors_from_two_mesh_levels,
)
from drumlin.fem.error_control.levels import (
    FunctionThatComputesResponse,
    SolvedLevel,
    solve_brake_on_finer_and_finer_mesh_levels,
)
from drumlin.fem.error_control.short_contact import force_error_due_to_place_in_too_short_contact
from drumlin.fem.error_control.singular_points import reason_if_contact_is_too_short
from drumlin.fem.hp.corner import (
    TOLERANCE_OF_COLUMN_END_AT_GAP_KINK,
    remaining_pressure_error_at_lining_corners,
    remaining_pressure_error_at_pointed_gap_kinks,
    response_with_power_laws_at_corners,
)
from drumlin.fem.hp.division import SMALLEST_ELEMENT_SIZE_OVER_LINING_THICKNESS
from drumlin.fem.preparation.cache import CacheOfCondensedBodies
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.response.response import (
    Response,
    ShoeResponse,
    length_of_edge_zone_left_out_of_peak_search,
)
from drumlin.response.resultants import (
    largest_value_of_piecewise_polynomial,
    length_of_edge_zone_left_out_of_pressure_errors,
)

LARGEST_PRESSURE_AT_LINING_END_OVER_PEAK = 0.5
"""Fraction of the peak pressure that p may reach in the hp element at a lining's end.

If the largest p in this element exceeds this fraction of the peak, the peak pressure is stated as
unknown. The exact p grows without bound at the lining's end, and on finer elements the largest
pressure would lie there. The value is a judgement.
"""


class TolerancesOfPressureAndTorque(NamedTuple):
    """The relative errors of pressure and torque below which a solve ends.

    `pressure` is the error of the pressure p on the worst shoe, in the L2 norm outside the zones at
    the lining's ends. `torque` is the error of the torque of the brake.
    """

    pressure: float
    torque: float


DEFAULT_TOLERANCES_OF_PRESSURE_AND_TORQUE = TolerancesOfPressureAndTorque(5e-3, 1e-4)
"""Tolerances of a solve without the option `--tolerance`: 0.5 % of p and 0.01 % of the torque.

No brake is manufactured so precisely that smaller errors would matter.
"""


class _LevelsSolvedSoFar(NamedTuple):
    """The levels on which a brake has been solved so far.

    Attributes
    ----------
    prepared_model : prepared model of the last level
    responses : responses of all levels
    error : estimated errors of the last response; empty on the first level
    unknowns : largest number of unknowns of a shoe
    text_on_missed_tolerance : text that says why the tolerance is not reached; empty if it is
        reached
    """

    prepared_model: PreparedModel
    responses: list[Response]
    error: EstimatedErrors
    unknowns: int
    text_on_missed_tolerance: str


def solve_brake_to_tolerance(
    brake: Brake,
    tolerance: TolerancesOfPressureAndTorque,
    respond: FunctionThatComputesResponse,
    *,
    must: bool = True,
    cache: CacheOfCondensedBodies | None = None,
    levels: Iterable[SolvedLevel] | None = None,
) -> SolvedLevel:
    """Solve a brake on finer and finer levels until its estimated errors meet a tolerance.

    Returns the prepared model of the last level, and the response on it with its errors.

    Parameters
    ----------
    brake : the brake
    tolerance : relative errors that are allowed
    respond : function that computes the response on a prepared model
    must : whether an error is raised if the tolerance is not reached; if False, the last level is
        returned with a warning
    cache : keeps the condensed bodies of earlier solves
    levels : solved levels from coarse to fine, as an iterable that may solve them one by one; by
        default `solve_brake_on_finer_and_finer_mesh_levels`

    Raises
    ------
    NoAnswer
        if fewer than two levels have a solution, or if the tolerance must be reached and is not;
        the message then states the errors that were reached
    BadInput
        for a brake with a mesh file
    """
    levels = levels or solve_brake_on_finer_and_finer_mesh_levels(brake, respond, cache)
    progress = _refine_mesh_levels_until_tolerance(brake, tolerance, levels)
    if not progress.text_on_missed_tolerance:
        return SolvedLevel(progress.prepared_model, _last_response_with_estimated_errors(progress))
    why = _shoes_with_unbounded_pressure_as_text(brake, progress.responses[-1])
    if must:
        reached = _reached_errors_as_text(progress, tolerance)
        raise NoAnswer(
            f"{progress.text_on_missed_tolerance} on {len(progress.responses)} meshes of "
            f"up to {progress.unknowns} unknowns a shoe: {reached}{why}"
        )
    progress = progress._replace(text_on_missed_tolerance=progress.text_on_missed_tolerance + why)
    return SolvedLevel(progress.prepared_model, _last_response_with_estimated_errors(progress))


def _refine_mesh_levels_until_tolerance(
    brake: Brake, tolerance: TolerancesOfPressureAndTorque, levels: Iterable[SolvedLevel]
) -> _LevelsSolvedSoFar:
    """Solve a brake up to the first level that meets the tolerance, or to the last level.

    The solve also ends if a finer level has no solution, or if a contact is too short to know its
    pressure. Raises NoAnswer if fewer than two levels have solutions, because the errors are then
    unknown.
    """
    responses: list[Response] = []
    error = EstimatedErrors({}, ())
    unknowns = 0
    missed = f"tolerance {tolerance.pressure:g} not reached"
    try:
        for scene, response in levels:
            responses.append(response_with_power_laws_at_corners(brake, response))
            unknowns = max(body.unknowns for body in scene.bodies)
            # Errors are estimated from the difference between two levels, so that the first level
            # alone has no estimate.
            if len(responses) == 1:
                continue
            before, last = responses[-2:]
            of_levels = estimate_errors_from_two_mesh_levels(brake, before, last)
            error, unknown = errors_with_singular_points_and_text_on_short_contacts(
                of_levels, brake, last
            )
            if is_tolerance_met(error, tolerance):
                return _LevelsSolvedSoFar(
                    scene, responses, error, unknowns, text_on_missed_tolerance=""
                )
            if unknown:
                missed += f": {unknown}"
                break
    except NoAnswer as refusal:
        # A finer level may have no solution although the earlier levels have one. Two solved levels
        # suffice to state errors.
        if not error.brake:
            raise
        missed += f", the next level: {refusal}"
    return _LevelsSolvedSoFar(scene, responses, error, unknowns, missed)


def is_tolerance_met(error: EstimatedErrors, tolerance: TolerancesOfPressureAndTorque) -> bool:
    """Whether the estimated errors of a brake meet a tolerance."""
    pressure, torque = error.brake["pressure"], error.brake["torque"]
    return pressure <= tolerance.pressure and torque <= tolerance.torque


def _shoes_with_unbounded_pressure_as_text(brake: Brake, response: Response) -> str:
    """The text that names the shoes whose pressure grows without bound at a point of the lining.

    The text is empty if there is no such shoe.
    """
    unbounded = []
    for shoe, answer in zip(brake.shoes, response.shoes, strict=True):
        if (
            _missing_fraction_of_peak_pressure(shoe, brake.length_per_surface_coordinate, answer)
            == 1.0
        ):
            unbounded.append(repr(shoe.name))
    if not unbounded:
        return ""
    return f"; p is unbounded at an end of the lining or a tip of the gap of {', '.join(unbounded)}"


def _reached_errors_as_text(
    progress: _LevelsSolvedSoFar, tolerance: TolerancesOfPressureAndTorque
) -> str:
    """The text that states the errors which were reached.

    If the finite contact stiffness (penalty) causes more than half of the allowed error of p, the
    text says so.
    """
    error = progress.error.brake
    pressure, torque = (
        error_text_in_percent(error["pressure"]),
        error_text_in_percent(error["torque"]),
    )
    text = f"estimated error of p {pressure}, of the torque {torque}"
    shoes = progress.responses[-1].shoes
    by_penalty = SAFETY_FACTOR_OF_PENALTY_ERROR * max(shoe.softness.pressure for shoe in shoes)
    if by_penalty > 0.5 * tolerance.pressure:
        text += (
            f"; the penalty makes {error_text_in_percent(by_penalty)} of it; a larger --penalty "
            "makes less"
        )
    return text


def _last_response_with_estimated_errors(progress: _LevelsSolvedSoFar) -> Response:
    """The last level's response with its errors, the time of all levels and a note on them.

    If the errors miss the tolerance, the notes end with a warning.
    """
    notes = [
        f"solved on {len(progress.responses)} meshes, each adapted to the answer before; "
        f"the last has {progress.unknowns} unknowns for each shoe"
    ]
    if progress.text_on_missed_tolerance:
        notes.append(f"warning: {progress.text_on_missed_tolerance}")
    return response_with_estimated_errors(progress.responses, progress.error, notes)


def response_with_estimated_errors(
    responses: Sequence[Response], error: EstimatedErrors, notes: Sequence[str]
) -> Response:
    """The last of several responses, with its errors, the time of all responses, and added notes.

    The number of iterations is the largest of any response.

    Parameters
    ----------
    responses : responses of one brake on finer and finer elements
    error : estimated errors of the last response
    notes : lines of text that follow the notes of the last response
    """
    last = responses[-1]
    seconds: dict[str, float] = {}
    for response in responses:
        for phase, spent in response.seconds.items():
            seconds[phase] = seconds.get(phase, 0.0) + spent
    pairs = zip(last.shoes, error.shoes, strict=True)
    return replace(
        last,
        error=error.brake,
        shoes=tuple(replace(shoe, error=errors_of_shoe) for shoe, errors_of_shoe in pairs),
        seconds=seconds,
        iterations=max(response.iterations for response in responses),
        notes=(*last.notes, *notes),
    )


# The following functions add errors that cannot be seen in the difference between two levels:
# errors where the pressure is unbounded, and in a contact that is too short for any division.


def errors_with_singular_points_and_text_on_short_contacts(
    error: EstimatedErrors, brake: Brake, response: Response
) -> tuple[EstimatedErrors, str]:
    """The estimated errors with the errors at singular points added, and a text on short contacts.

    Near corners of the lining, and under kinks of the gap that point to the drum (tips), the
    pressure p grows without bound. Elements of finite size cannot show this growth, and the
    difference between two levels does not reveal the error. An error of 1 means that the value is
    unknown. It is stated for a peak at an end of the lining or under a tip, and for the pressure of
    a contact that is too short. The text names the shoe of such a contact, and is empty without
    such a contact.

    Parameters
    ----------
    error : errors estimated from two levels
    brake : the brake
    response : response of the finer level
    """
    shoes, text = [], ""
    torque_error = error.brake["torque"]
    for i, (shoe, answer) in enumerate(zip(brake.shoes, response.shoes, strict=True)):
        missing_peak = _missing_fraction_of_peak_pressure(
            shoe, brake.length_per_surface_coordinate, answer
        )
        at_corners = remaining_pressure_error_at_lining_corners(brake, i, answer)
        under_tips = remaining_pressure_error_at_pointed_gap_kinks(
            shoe, brake.length_per_surface_coordinate, answer
        )
        at_singular_points = at_corners + under_tips
        errors = {
            **error.shoes[i],
            "pressure": error.shoes[i]["pressure"] + at_singular_points,
            "peak": 1.0 if missing_peak == 1.0 else error.shoes[i]["peak"] + missing_peak,
        }
        reason = reason_if_contact_is_too_short(brake, shoe, answer)
        if reason is not None:
            text = f"{reason}; torque and forces do not need it"
            by_place = force_error_due_to_place_in_too_short_contact(brake, shoe, answer)
            errors = _errors_of_shoe_with_unknown_pressure(errors, by_place)
            # The torque of a shoe is at most the torque of the brake.
            torque_error += by_place
        shoes.append(errors)
    return EstimatedErrors.brake_errors_from_torque_and_shoe_errors(torque_error, shoes), text


def _errors_of_shoe_with_unknown_pressure(
    errors: Mapping[str, float], by_place: float
) -> dict[str, float]:
    """The errors of a shoe, with 1 (unknown) as the error of its pressure and of its peak.

    The unknown place of the force within the contact adds the relative error `by_place` to the
    errors of torque and reaction.
    """
    return {
        "pressure": 1.0,
        "torque": errors["torque"] + by_place,
        "peak": 1.0,
        "reaction": errors["reaction"] + by_place,
    }


def _missing_fraction_of_peak_pressure(
    shoe: Shoe, length_per_surface_coordinate: float, answer: ShoeResponse
) -> float:
    """The fraction by which the computed peak pressure of a shoe may be too small.

    A computed peak is too small if the exact pressure p grows without bound nearby: at an end of
    the lining, or under a kink of the gap that points to the drum (a tip). The fraction is then 1,
    which means that the peak is unknown. `length_per_surface_coordinate` is the length per unit of
    the surface's coordinate [m/rad; 1 on a plane].
    """
    zone = length_of_edge_zone_left_out_of_peak_search(shoe, length_per_surface_coordinate)
    if _is_peak_pressure_at_lining_end(answer, zone):
        return 1.0
    return _missing_fraction_of_peak_at_pointed_gap_kinks(
        shoe, length_per_surface_coordinate, answer, zone
    )


def _is_peak_pressure_at_lining_end(answer: ShoeResponse, zone: float) -> bool:
    """Whether the pressure p peaks in the hp element at an end of the lining, where p is unbounded.

    `zone` is the length of the zone at each end of the lining in which the peak is usually not
    sought. If the peak was sought there nevertheless, the result is also true if the pressure in an
    end element exceeds LARGEST_PRESSURE_AT_LINING_END_OVER_PEAK times the peak: on finer elements
    the largest pressure would lie there.
    """
    theta, p, order = answer.theta, answer.pressure, answer.order
    # `heights` are the largest pressures in the elements at pressed ends of linings, relative to
    # the peak pressure of the shoe.
    heights = []
    for end, element in _elements_at_ends_of_linings(answer):
        if p[end] > 0:
            height = largest_value_of_piecewise_polynomial(theta[element], p[element], order)
            heights.append(height / answer.peak_pressure)
    if any(math.isclose(height, 1.0) for height in heights):
        return True
    is_high = max(heights, default=0.0) > LARGEST_PRESSURE_AT_LINING_END_OVER_PEAK
    return (
        is_high
        and length_of_edge_zone_left_out_of_pressure_errors(theta, p, order, zone, answer.slots)
        == 0
    )


def _elements_at_ends_of_linings(answer: ShoeResponse) -> list[tuple[int, slice]]:
    """The node at each end of a lining, and the nodes of the hp element that ends there.

    Each item is the index of the end's node and the slice of the element's nodes. A shoe with slots
    between its linings has two more ends at each slot.
    """
    order, last = answer.order, len(answer.theta) - 1
    before, behind = np.searchsorted(answer.theta, np.reshape(answer.slots, (-1, 2))).T.tolist()
    starts, ends = [0, *behind], [*before, last]
    at_starts = [(node, slice(node, node + order + 1)) for node in starts]
    return at_starts + [(node, slice(node - order, node + 1)) for node in ends]


def _missing_fraction_of_peak_at_pointed_gap_kinks(
    shoe: Shoe, length_per_surface_coordinate: float, answer: ShoeResponse, zone: float
) -> float:
    """The fraction by which the computed pressure peak may be too small because of tips of the gap.

    A tip is a kink of the gap that points to the drum: the slope of the gap jumps there. The exact
    pressure p is unbounded at a tip. A wedge whose slope changes by s has the pressure E s/(2 pi)
    ln(1/x) on a half-plane of modulus E, at the distance x (Johnson, Contact Mechanics, ch. 5). The
    computed p at the tip is extrapolated by this law to elements as small as
    SMALLEST_ELEMENT_SIZE_OVER_LINING_THICKNESS.

    If the extrapolated pressure exceeds the computed peak, the peak is too small. If two elements
    meet at the tip, the peak counts as unknown, and the fraction is 1. No elements meet at a tip
    that hardly changes p; the fraction is then the relative excess of the extrapolated pressure
    over the peak. Tips in the zone at the lining's ends are treated by
    `_is_peak_pressure_at_lining_end`.

    Parameters
    ----------
    shoe, answer : the shoe and its response
    length_per_surface_coordinate : length per unit of the surface's coordinate [m/rad; 1 on a
        plane]
    zone : length of the zone at each end of the lining in which the peak is usually not sought
    """
    order = answer.order
    theta, p = answer.theta, answer.pressure
    tips = clearance.gap_kinks_that_point_to_drum(shoe.lining)
    if not tips:
        return 0.0
    zone = length_of_edge_zone_left_out_of_pressure_errors(theta, p, order, zone, answer.slots)
    modulus = shoe.lining.material.young_modulus_of_equivalent_half_plane
    missing = 0.0
    # Under each tip outside the end zones the exact pressure may be higher than the computed peak.
    for tip, slope in tips:
        if not any(start + zone < tip < end - zone for start, end in shoe.lining.arcs):
            continue
        # `around` selects the nodes of the two neighbouring elements whose common end is nearest to
        # the tip.
        nearest = int(np.abs(theta[::order] - tip).argmin()) * order
        around = slice(max(nearest - order, 0), nearest + order + 1)
        width = length_per_surface_coordinate * float(theta[around][-1] - theta[around][0])
        size_ratio = max(
            width / (SMALLEST_ELEMENT_SIZE_OVER_LINING_THICKNESS * shoe.lining.thickness), 1.0
        )
        growth = (
            modulus * slope / length_per_surface_coordinate * math.log(size_ratio) / (2 * math.pi)
        )
        possible_peak = (
            largest_value_of_piecewise_polynomial(theta[around], p[around], order) + growth
        )
        elements_end_at_tip = (
            abs(theta[nearest] - tip)
            < TOLERANCE_OF_COLUMN_END_AT_GAP_KINK * shoe.frame.surface_coordinate_per_phi
        )
        if possible_peak > answer.peak_pressure:
            excess = possible_peak / answer.peak_pressure - 1.0
            missing = max(missing, 1.0 if elements_end_at_tip else excess)
    return min(missing, 1.0)


def require_tolerance_between_zero_and_one(tolerance: float) -> None:
    """Raise BadInput for a tolerance that is not between 0 and 1."""
    if not 0 < tolerance < 1:
        raise BadInput(f"--tolerance = {tolerance:g}: must be greater than 0 and less than 1")
