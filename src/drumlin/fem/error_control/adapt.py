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
from drumlin.fem.error_control.levels import Respond, Step, steps
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

SHORTEST = 1000 * SMALLEST_COLUMN
"""Length of a contact, relative to the lining's thickness, below which the response says that its
pressure is not known. No hp element is smaller than SMALLEST_COLUMN, and the elements at the ends
of a contact are a thousandth of it on a level that states an error of 1e-4.
"""
NEAR = 0.5
"""Fraction of the peak up to which p may rise in the hp element at an end of the lining. Above it
the peak counts as unknown: p grows there without bound, and on a finer level it would be the peak.
The value is a judgement.
"""


class Tolerance(NamedTuple):
    """The relative errors that are allowed: of p in L2, outside the edge zones, and of the torque.

    The pressure counts on the shoe where its error is largest.
    """

    pressure: float
    torque: float


DEFAULT = Tolerance(5e-3, 1e-4)
"""The tolerance of a solve without `--tolerance`: 0.5 % of p and 0.01 % of the torque. No brake is
manufactured as precisely.
"""


class _Progress(NamedTuple):
    """The levels that a solve has answered.

    Attributes
    ----------
    scene : the prepared model of the last level
    responses : the responses of all levels
    error : the estimated errors of the last response; empty on the first level
    unknowns : the most unknowns of a shoe
    missed : why the tolerance is not reached; empty where it is
    """

    scene: PreparedModel
    responses: list[Response]
    error: Errors
    unknowns: int
    missed: str


def adapt(
    brake: Brake,
    tolerance: Tolerance,
    respond: Respond,
    *,
    must: bool = True,
    cache: Cache | None = None,
    along: Iterable[Step] | None = None,
) -> Step:
    """The response whose estimated errors meet the tolerance, with its prepared model.

    Parameters
    ----------
    brake : the brake
    tolerance : relative errors that are allowed
    respond : answers a prepared model
    must : whether a tolerance that is not reached is refused; otherwise the last level is returned
    cache : substructures of earlier solves, see `prepare`
    along : the levels with their responses, where they are known already

    Raises
    ------
    NoAnswer
        where no level has an answer, or where the tolerance must be reached and is not; the line
        says what was reached
    BadInput
        for a brake with a mesh file
    """
    progress = _climbed(brake, tolerance, along or steps(brake, respond, cache))
    if not progress.missed:
        return Step(progress.scene, _final(progress))
    why = _unbounded_text(brake, progress.responses[-1])
    if must:
        reached = _reached_text(progress, tolerance)
        raise NoAnswer(
            f"{progress.missed} on {len(progress.responses)} meshes of up to {progress.unknowns} "
            f"unknowns a shoe: {reached}{why}"
        )
    return Step(progress.scene, _final(progress._replace(missed=progress.missed + why)))


def _climbed(brake: Brake, tolerance: Tolerance, along: Iterable[Step]) -> _Progress:
    """The levels up to the first that meets the tolerance, or up to the last that has an answer.

    Raises NoAnswer where not even two levels have answers.
    """
    responses: list[Response] = []
    error = Errors({}, ())
    unknowns = 0
    missed = f"tolerance {tolerance.pressure:g} not reached"
    try:
        for scene, response in along:
            responses.append(response_with_power_laws(brake, response))
            unknowns = max(body.unknowns for body in scene.bodies)
            if len(responses) == 1:
                continue
            before, last = responses[-2:]
            error, unknown = errors_with_singularities(estimate(brake, before, last), brake, last)
            if _within(error, tolerance):
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


def _within(error: Errors, tolerance: Tolerance) -> bool:
    """Whether estimated errors meet a tolerance."""
    pressure, torque = error.brake["pressure"], error.brake["torque"]
    return pressure <= tolerance.pressure and torque <= tolerance.torque


def _unbounded_text(brake: Brake, response: Response) -> str:
    """The words on shoes whose peak of p is unbounded; empty where there are none."""
    unbounded = []
    for shoe, answer in zip(brake.shoes, response.shoes, strict=True):
        if _lacking(shoe, brake.scale_factor, answer) == 1.0:
            unbounded.append(repr(shoe.name))
    if not unbounded:
        return ""
    return f"; p is unbounded at an end of the lining or a tip of the gap of {', '.join(unbounded)}"


def _reached_text(progress: _Progress, tolerance: Tolerance) -> str:
    """The words on the errors that were reached, and on the penalty where it is half of them."""
    error = progress.error.brake
    text = f"estimated error of p {error['pressure']:.1e}, of the torque {error['torque']:.1e}"
    shoes = progress.responses[-1].shoes
    by_penalty = SOFTER * max(shoe.softness.pressure for shoe in shoes)
    if by_penalty > 0.5 * tolerance.pressure:
        text += f"; the penalty makes {by_penalty:.1e} of it; a larger --penalty makes less"
    return text


def _final(progress: _Progress) -> Response:
    """The last response with its errors, the time of all levels and a line on them.

    Its steps are those of the level that took the most. A warning says where the errors missed the
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
        shoes=tuple(replace(shoe, error=own) for shoe, own in pairs),
        seconds=seconds,
        iterations=max(response.iterations for response in responses),
        notes=(*last.notes, *notes),
    )


# What two levels cannot estimate: singular pressure, and contacts too short for the division


def errors_with_singularities(
    error: Errors, brake: Brake, response: Response
) -> tuple[Errors, str]:
    """The errors with those at singular points added, and the words on an unknown pressure.

    The difference of two levels does not contain what p and its peak lack at corners of the lining
    and under tips of the gap. An error of 1 means unknown: a peak that is at an end of the lining
    or under a tip, and the pressure of a contact that is too short, which the words name.
    """
    shoes, words = [], ""
    for i, (shoe, answer) in enumerate(zip(brake.shoes, response.shoes, strict=True)):
        lacking = _lacking(shoe, brake.scale_factor, answer)
        at_corners = pressure_error_at_corners(brake, i, answer)
        left = at_corners + pressure_error_under_tips(shoe, brake.scale_factor, answer)
        errors = {
            **error.shoes[i],
            "pressure": error.shoes[i]["pressure"] + left,
            "peak": 1.0 if lacking == 1.0 else error.shoes[i]["peak"] + lacking,
        }
        length = _shortest_contact(brake, shoe, answer)
        if length < SHORTEST * shoe.lining.thickness:
            words = (
                f"shoe {shoe.name!r}: its contact is {1e6 * length:.1g} um long, too short to know "
                "its pressure; torque and forces do not need it"
            )
            errors = _pressure_unknown(errors)
        shoes.append(errors)
    return Errors.worst(error.brake["torque"], shoes), words


def _shortest_contact(brake: Brake, shoe: Shoe, answer: ShoeResponse) -> float:
    """The length [m] of the shortest contact of a shoe; inf for a shoe that does not touch."""
    lengths = (end - start for start, end in contact_arcs_without_narrow_gaps(shoe, answer))
    return min(lengths, default=math.inf) * brake.size


def _pressure_unknown(errors: Mapping[str, float]) -> dict[str, float]:
    """The errors of a shoe with 1 for its pressure and its peak."""
    unknown = {"pressure", "peak"}
    return {name: max(error, float(name in unknown)) for name, error in errors.items()}


def _lacking(shoe: Shoe, scale_factor: float, answer: ShoeResponse) -> float:
    """The fraction that the peak of p may lack.

    It is 1 where the peak is at, or near, a pressure that grows without bound: at a lining's end,
    or under a tip of its gap.
    """
    zone = edge_zone(shoe, scale_factor)
    if _peak_at_corner(answer, zone):
        return 1.0
    return _lacking_under_tips(shoe, scale_factor, answer, zone)


def _peak_at_corner(answer: ShoeResponse, zone: float) -> bool:
    """Whether p is largest in an hp element at a pressed end of the lining, where it is unbounded.

    zone: of the lining's ends, see `edge_zone`. Where the ends count for the peak, p near the peak
    suffices: on a finer level it will be the peak.
    """
    theta, p, order = answer.theta, answer.pressure, answer.order
    heights = []
    for end, element in ((0, slice(order + 1)), (-1, slice(-order - 1, None))):
        if p[end] > 0:
            height = largest(theta[element], p[element], order)
            heights.append(height / answer.peak_pressure)
    if any(math.isclose(height, 1.0) for height in heights):
        return True
    return max(heights, default=0.0) > NEAR and edge_left_out(theta, p, order, zone) == 0


def _lacking_under_tips(
    shoe: Shoe, scale_factor: float, answer: ShoeResponse, zone: float
) -> float:
    """The fraction that the peak of p may lack because p grows without bound under tips of the gap.

    A wedge whose slope changes by s has the pressure E s/(2 pi) ln(1/x) on a half-plane of modulus
    E (Johnson, Contact Mechanics, ch. 5). As the elements beside a tip become smaller, down to
    SMALLEST_COLUMN, p at the tip grows by this law. The growth matters where p at the tip would
    then be above the peak. If hp elements end at the tip, the peak is unknown: the fraction is 1.
    At a tip that p hardly feels no elements end, see `singular_points_of`; the peak lacks at most
    the part by which p at the tip could exceed it. In the zone at the lining's ends
    `_peak_at_corner` judges.
    """
    start, end, order = shoe.lining.start, shoe.lining.end, answer.order
    theta, p = answer.theta, answer.pressure
    zone = edge_left_out(theta, p, order, zone)
    modulus = shoe.lining.material.E_half_plane
    lacking = 0.0
    for tip, slope in clearance.tips(shoe.lining):
        if not start + zone < tip < end - zone:
            continue
        nearest = int(np.abs(theta[::order] - tip).argmin()) * order
        around = slice(max(nearest - order, 0), nearest + order + 1)
        width = scale_factor * float(theta[around][-1] - theta[around][0])
        smaller = max(width / (SMALLEST_COLUMN * shoe.lining.thickness), 1.0)
        growth = modulus * slope / scale_factor * math.log(smaller) / (2 * math.pi)
        most = largest(theta[around], p[around], order) + growth
        divided = abs(theta[nearest] - tip) < TIP_TOLERANCE * shoe.frame.unit
        if most > answer.peak_pressure:
            lacking = max(lacking, 1.0 if divided else most / answer.peak_pressure - 1.0)
    return min(lacking, 1.0)


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
