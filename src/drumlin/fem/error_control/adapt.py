"""A brake solved to a tolerance: finer levels until the a posteriori error estimate meets it."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake import clearance
from drumlin.brake.brake import Brake, Shoe
from drumlin.fem.error_control.estimate import SOFTER, Errors, estimate
from drumlin.fem.error_control.levels import ResponseFunction, SolvedLevel, solved_levels
from drumlin.fem.error_control.singular_points import contact_arcs_without_narrow_gaps
from drumlin.fem.hp.corner import (
    TIP_TOLERANCE,
    pressure_error_at_corners,
    pressure_error_under_tips,
    response_with_power_laws,
)
from drumlin.fem.hp.division import SMALLEST_COLUMN
from drumlin.fem.preparation.cache import Cache
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.response.response import Response, ShoeResponse, edge_zone
from drumlin.response.resultants import edge_left_out, largest

SHORTEST_KNOWN_CONTACT = 1000 * SMALLEST_COLUMN
"""Length of a contact, relative to the lining's thickness, below which the response says that its
pressure is not known. No hp element is smaller than SMALLEST_COLUMN. On a level that states an
error of 1e-4 the elements at the ends of a contact are a thousandth of the contact's length.
"""
PEAK_NEAR_END = 0.5
"""Fraction of the peak pressure up to which p may rise in the hp element at an end of the lining.

If p is higher there, the peak counts as unknown: p grows without bound at the lining's end, and on
a finer level it would be the peak. The value is a judgement.
"""


class Tolerance(NamedTuple):
    """The relative errors that are allowed: of p in L2, outside the edge zones, and of the torque.

    The pressure counts on the shoe where its error is largest.
    """

    pressure: float
    torque: float


DEFAULT_TOLERANCE = Tolerance(5e-3, 1e-4)
"""The tolerance of a solve without `--tolerance`: 0.5 % of p and 0.01 % of the torque. No brake is
manufactured as precisely.
"""


class _Progress(NamedTuple):
    """The levels that a solve has answered.

    Attributes
    ----------
    scene : prepared model of the last level
    responses : responses of all levels
    error : estimated errors of the last response; empty on the first level
    unknowns : largest number of unknowns of a shoe
    missed : reason why the tolerance is not reached; empty if it is reached
    """

    scene: PreparedModel
    responses: list[Response]
    error: Errors
    unknowns: int
    missed: str


def solve_to_tolerance(
    brake: Brake,
    tolerance: Tolerance,
    respond: ResponseFunction,
    *,
    must: bool = True,
    cache: Cache | None = None,
    levels: Iterable[SolvedLevel] | None = None,
) -> SolvedLevel:
    """The response whose estimated errors meet the tolerance, with its prepared model.

    Parameters
    ----------
    brake : the brake
    tolerance : relative errors that are allowed
    respond : computes the response on a prepared model
    must : whether a tolerance that is not reached is refused; otherwise the last level is returned
    cache : keeps condensed bodies of earlier solves, see `prepare`
    levels : levels that are solved already; solved here if it is None

    Raises
    ------
    NoAnswer
        where no level has an answer, or where the tolerance must be reached and is not; the message
        states the errors that were reached
    BadInput
        for a brake with a mesh file
    """
    levels = levels or solved_levels(brake, respond, cache)
    progress = _solve_until_tolerance(brake, tolerance, levels)
    if not progress.missed:
        return SolvedLevel(progress.scene, _response_with_errors(progress))
    why = _unbounded_text(brake, progress.responses[-1])
    if must:
        reached = _reached_text(progress, tolerance)
        raise NoAnswer(
            f"{progress.missed} on {len(progress.responses)} meshes of up to {progress.unknowns} "
            f"unknowns a shoe: {reached}{why}"
        )
    progress = progress._replace(missed=progress.missed + why)
    return SolvedLevel(progress.scene, _response_with_errors(progress))


def _solve_until_tolerance(
    brake: Brake, tolerance: Tolerance, levels: Iterable[SolvedLevel]
) -> _Progress:
    """The levels up to the first that meets the tolerance, or up to the last that has an answer.

    Raises NoAnswer where not even two levels have answers.
    """
    responses: list[Response] = []
    error = Errors({}, ())
    unknowns = 0
    missed = f"tolerance {tolerance.pressure:g} not reached"
    try:
        for scene, response in levels:
            responses.append(response_with_power_laws(brake, response))
            unknowns = max(body.unknowns for body in scene.bodies)
            if len(responses) == 1:
                continue
            before, last = responses[-2:]
            of_levels = estimate(brake, before, last)
            error, unknown = errors_with_singularities(of_levels, brake, last)
            if _meets_tolerance(error, tolerance):
                return _Progress(scene, responses, error, unknowns, missed="")
            if unknown:
                missed += f": {unknown}"
                break
    except NoAnswer as refusal:
        # A finer level may have no answer although the levels before have.
        if not error.brake:
            raise
        missed += f", the next level: {refusal}"
    return _Progress(scene, responses, error, unknowns, missed)


def _meets_tolerance(error: Errors, tolerance: Tolerance) -> bool:
    """Whether the estimated errors of a brake meet a tolerance."""
    pressure, torque = error.brake["pressure"], error.brake["torque"]
    return pressure <= tolerance.pressure and torque <= tolerance.torque


def _unbounded_text(brake: Brake, response: Response) -> str:
    """The text that names the shoes whose pressure is unbounded; empty without such a shoe."""
    unbounded = []
    for shoe, answer in zip(brake.shoes, response.shoes, strict=True):
        if _missing_part_of_peak(shoe, brake.scale_factor, answer) == 1.0:
            unbounded.append(repr(shoe.name))
    if not unbounded:
        return ""
    return f"; p is unbounded at an end of the lining or a tip of the gap of {', '.join(unbounded)}"


def _reached_text(progress: _Progress, tolerance: Tolerance) -> str:
    """The text on the errors that were reached, and on the penalty if it causes half of them."""
    error = progress.error.brake
    text = f"estimated error of p {error['pressure']:.1e}, of the torque {error['torque']:.1e}"
    shoes = progress.responses[-1].shoes
    by_penalty = SOFTER * max(shoe.softness.pressure for shoe in shoes)
    if by_penalty > 0.5 * tolerance.pressure:
        text += f"; the penalty makes {by_penalty:.1e} of it; a larger --penalty makes less"
    return text


def _response_with_errors(progress: _Progress) -> Response:
    """The last response with its errors, the time of all levels, and a note on the levels.

    Its number of iterations is the largest of any level. A warning follows if the errors miss the
    tolerance.
    """
    responses, error = progress.responses, progress.error
    last = responses[-1]
    seconds: dict[str, float] = {}
    for response in responses:
        for phase, spent in response.seconds.items():
            seconds[phase] = seconds.get(phase, 0.0) + spent
    notes = [
        f"adapted on {len(responses)} meshes, the last with {progress.unknowns} unknowns a shoe"
    ]
    if progress.missed:
        notes.append(f"warning: {progress.missed}")
    pairs = zip(last.shoes, error.shoes, strict=True)
    return replace(
        last,
        error=error.brake,
        shoes=tuple(replace(shoe, error=errors_of_shoe) for shoe, errors_of_shoe in pairs),
        seconds=seconds,
        iterations=max(response.iterations for response in responses),
        notes=(*last.notes, *notes),
    )


# Errors that the difference of two levels does not show: those of singular pressures, and of
# contacts that are too short for any division.


def errors_with_singularities(
    error: Errors, brake: Brake, response: Response
) -> tuple[Errors, str]:
    """The errors with those at singular points added, and a text on any unknown pressure.

    Near corners of the lining and under tips of the gap, p and its peak lack a part that the
    difference of two levels does not show. An error of 1 means unknown. It is stated for a peak at
    an end of the lining or under a tip, and for the pressure of a contact that is too short. The
    text names such a contact, and is empty otherwise.

    Parameters
    ----------
    error : errors estimated from two levels
    brake : the brake
    response : response of the finer level
    """
    shoes, text = [], ""
    for i, (shoe, answer) in enumerate(zip(brake.shoes, response.shoes, strict=True)):
        missing_peak = _missing_part_of_peak(shoe, brake.scale_factor, answer)
        at_corners = pressure_error_at_corners(brake, i, answer)
        under_tips = pressure_error_under_tips(shoe, brake.scale_factor, answer)
        at_singular_points = at_corners + under_tips
        errors = {
            **error.shoes[i],
            "pressure": error.shoes[i]["pressure"] + at_singular_points,
            "peak": 1.0 if missing_peak == 1.0 else error.shoes[i]["peak"] + missing_peak,
        }
        length = _shortest_contact_length(brake, shoe, answer)
        if length < SHORTEST_KNOWN_CONTACT * shoe.lining.thickness:
            text = (
                f"shoe {shoe.name!r}: its contact is {1e6 * length:.1g} um long, too short to know "
                "its pressure; torque and forces do not need it"
            )
            errors = _errors_with_unknown_pressure(errors)
        shoes.append(errors)
    return Errors.worst(error.brake["torque"], shoes), text


def _shortest_contact_length(brake: Brake, shoe: Shoe, answer: ShoeResponse) -> float:
    """The length [m] of the shortest contact of a shoe; inf for a shoe that does not touch."""
    arcs = contact_arcs_without_narrow_gaps(shoe, answer)
    return min((end - start for start, end in arcs), default=math.inf) * brake.size


def _errors_with_unknown_pressure(errors: Mapping[str, float]) -> dict[str, float]:
    """The errors of a shoe with an error of 1 for its pressure and its peak."""
    unknown = {"pressure", "peak"}
    return {name: max(error, float(name in unknown)) for name, error in errors.items()}


def _missing_part_of_peak(shoe: Shoe, scale_factor: float, answer: ShoeResponse) -> float:
    """The fraction of the peak of p by which the peak may be too small because p is singular.

    The fraction is 1, for unknown, where the peak is at or near a pressure that grows without
    bound: at a lining's end, or under a tip of its gap. `scale_factor` is the length [m] of the
    surface's coordinate 1.
    """
    zone = edge_zone(shoe, scale_factor)
    if _is_peak_at_lining_end(answer, zone):
        return 1.0
    return _missing_part_of_peak_under_tips(shoe, scale_factor, answer, zone)


def _is_peak_at_lining_end(answer: ShoeResponse, zone: float) -> bool:
    """Whether p peaks in an hp element at a pressed end of the lining, where p is unbounded.

    `zone` is the length of the zone at the lining's ends, see `edge_zone`. If the peak is looked
    for in this zone too, a pressure of PEAK_NEAR_END of the peak suffices, because on a finer level
    it would be the peak.
    """
    theta, p, order = answer.theta, answer.pressure, answer.order
    heights = []
    for end, element in ((0, slice(order + 1)), (-1, slice(-order - 1, None))):
        if p[end] > 0:
            height = largest(theta[element], p[element], order)
            heights.append(height / answer.peak_pressure)
    if any(math.isclose(height, 1.0) for height in heights):
        return True
    is_high = max(heights, default=0.0) > PEAK_NEAR_END
    return is_high and edge_left_out(theta, p, order, zone) == 0


def _missing_part_of_peak_under_tips(
    shoe: Shoe, scale_factor: float, answer: ShoeResponse, zone: float
) -> float:
    """The fraction by which the peak of p may be too small because p is unbounded under tips.

    A wedge whose slope changes by s has the pressure E s/(2 pi) ln(1/x) on a half-plane of modulus
    E (Johnson, Contact Mechanics, ch. 5). As the elements beside a tip of the gap become smaller,
    down to SMALLEST_COLUMN, p at the tip grows by this law. The growth matters where p at the tip
    would then exceed the peak. If hp elements end at the tip, the peak is unknown, and the fraction
    is 1. At a tip that p hardly feels no elements end, see `singular_points_of`. The peak then
    lacks at most the part by which p at the tip could exceed it. Tips in the zone at the lining's
    ends are left to `_is_peak_at_lining_end`.

    Parameters
    ----------
    shoe, answer : the shoe and its response
    scale_factor : length [m] of the surface's coordinate 1
    zone : length of the zone at the lining's ends, see `edge_zone`
    """
    start, end, order = shoe.lining.start, shoe.lining.end, answer.order
    theta, p = answer.theta, answer.pressure
    zone = edge_left_out(theta, p, order, zone)
    modulus = shoe.lining.material.E_half_plane
    missing = 0.0
    for tip, slope in clearance.tips(shoe.lining):
        if not start + zone < tip < end - zone:
            continue
        nearest = int(np.abs(theta[::order] - tip).argmin()) * order
        around = slice(max(nearest - order, 0), nearest + order + 1)
        width = scale_factor * float(theta[around][-1] - theta[around][0])
        size_ratio = max(width / (SMALLEST_COLUMN * shoe.lining.thickness), 1.0)
        growth = modulus * slope / scale_factor * math.log(size_ratio) / (2 * math.pi)
        possible_peak = largest(theta[around], p[around], order) + growth
        elements_end_at_tip = abs(theta[nearest] - tip) < TIP_TOLERANCE * shoe.frame.unit
        if possible_peak > answer.peak_pressure:
            excess = possible_peak / answer.peak_pressure - 1.0
            missing = max(missing, 1.0 if elements_end_at_tip else excess)
    return min(missing, 1.0)


def check_tolerance(brake: Brake, tolerance: float) -> None:
    """Raise BadInput for a tolerance out of range, or for a brake with a mesh file.

    A mesh file is not refined.
    """
    if not 0 < tolerance < 1:
        raise BadInput(f"--tolerance = {tolerance:g}: must be greater than 0 and less than 1")
    for shoe in brake.shoes:
        if shoe.mesh is not None:
            raise BadInput(
                f"--tolerance = {tolerance:g}: shoe {shoe.name!r} has a mesh file, "
                "which is not refined"
            )
