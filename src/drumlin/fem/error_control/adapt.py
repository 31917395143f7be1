"""A brake to a tolerance: finer levels until the estimated errors are below it."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake import clearance
from drumlin.brake.brake import Brake, Shoe
from drumlin.fem.error_control.estimate import SOFTER, Errors, estimate
from drumlin.fem.error_control.levels import Respond, Step, steps
from drumlin.fem.error_control.places import pressed_arcs
from drumlin.fem.hp.corner import AT_TIP, left_at_corners, left_under_tips, with_powers
from drumlin.fem.hp.division import FINEST
from drumlin.fem.preparation.cache import Cache
from drumlin.response.response import NEAR_PEAK, Response, ShoeResponse, edge_zone
from drumlin.response.resultants import edge_left_out, largest

SHORTEST = 10 * FINEST
"""Length of a contact, in parts of the lining's thickness, below which its pressure is said not to
be known: FINEST leaves it ten columns.
"""
UNDER_TIP = math.log(1 / FINEST) / (2 * math.pi)
"""Growth of p over E s under a tip of the gap, from the lining's thickness from it down to FINEST
of that.

On a half-plane of modulus E a wedge whose slope changes by s has the pressure E s/(2 pi) ln(1/x)
(Johnson, Contact Mechanics, ch. 5). It is what the peak may lack where no columns end at the tip.
"""
NEAR = 0.5
"""Part of the peak that p may reach in the column at an end of the lining before the peak is called
unknown: p grows there without bound, and on a finer level it would be the peak."""


class Tolerance(NamedTuple):
    """Relative errors of p (L2 outside the edge zones, worst shoe) and of the torque that are
    allowed.
    """

    pressure: float
    torque: float


DEFAULT = Tolerance(5e-3, 1e-4)
"""What a solve without `--tolerance` aims at: 0.5 % of p and 0.01 % of the torque, which is more
than any brake is made to.
"""


def adapt(
    brake: Brake,
    tolerance: Tolerance,
    respond: Respond,
    *,
    must: bool = True,
    cache: Cache | None = None,
    along: Iterable[Step] | None = None,
) -> Step:
    """The response whose estimated errors are within the tolerance, on its scene.

    cache: see `scene`; along: the steps, where some are there already. Raises NoAnswer, saying what
    was reached, where the levels do not suffice, unless it need not be; BadInput for a brake with a
    mesh file.
    """
    responses: list[Response] = []
    error = Errors({}, ())
    unknowns = 0
    missed = f"tolerance {tolerance.pressure:g} not reached"
    try:
        for scene, found in along or steps(brake, respond, cache):
            responses.append(with_powers(brake, found))
            unknowns = max(body.unknowns for body in scene.bodies)
            if len(responses) > 1:
                error, unseen = seen(
                    estimate(brake, responses[-2], responses[-1]), brake, responses[-1]
                )
                if (
                    error.brake["pressure"] <= tolerance.pressure
                    and error.brake["torque"] <= tolerance.torque
                ):
                    return Step(scene, _final(responses, error, unknowns, ""))
                if unseen:
                    missed += f": {unseen}"
                    break
    except NoAnswer as refusal:  # of finer levels
        if not error.brake:
            raise
        missed += f", the next level: {refusal}"
    last = zip(brake.shoes, responses[-1].shoes, strict=True)
    unbounded = [
        repr(shoe.name) for shoe, found in last if _lacking(shoe, brake.scale_factor, found) == 1.0
    ]
    why = (
        f"; p is unbounded at an end of the lining or a tip of the gap of {', '.join(unbounded)}"
        if unbounded
        else ""
    )
    if must:
        said = f"estimated error of p {error.brake['pressure']:.1e}, of the torque {error.brake['torque']:.1e}"
        soft = SOFTER * max(shoe.softness.pressure for shoe in responses[-1].shoes)
        if soft > 0.5 * tolerance.pressure:
            said += f"; the penalty makes {soft:.1e} of it; a larger --penalty makes less"
        raise NoAnswer(
            f"{missed} on {len(responses)} meshes of up to {unknowns} unknowns a shoe: {said}{why}"
        )
    return Step(scene, _final(responses, error, unknowns, missed + why))


def _cornered(shoe: ShoeResponse, zone: float) -> bool:
    """Whether p is largest in a column at an end of the lining that is pressed: there it is
    unbounded.

    zone [rad]: see `edge_zone`. Where the ends count, p near its peak there will be so on a finer
    level.
    """
    theta, p, order = shoe.theta, shoe.pressure, shoe.order
    ends = [
        part for end, part in ((0, slice(order + 1)), (-1, slice(-order - 1, None))) if p[end] > 0
    ]
    heights = [largest(theta[part], p[part], order) / shoe.peak_pressure for part in ends]
    if any(math.isclose(height, 1.0) for height in heights):
        return True
    return max(heights, default=0.0) > NEAR and edge_left_out(theta, p, order, zone) == 0


def _under_tips(shoe: Shoe, scale_factor: float, found: ShoeResponse, zone: float) -> float:
    """What the peak of p may lack, relative, as p is near its peak in a column beside a tip of the
    gap: 1 where columns end at the tip, as p is unbounded there, as under a wedge, and on a finer
    level would be higher.

    No columns end at a tip that p hardly feels, see `places`. zone [rad]: see `edge_zone`; in it
    `_cornered` tells.
    """
    start, end, order = shoe.lining.start, shoe.lining.end, found.order
    zone = edge_left_out(found.theta, found.pressure, order, zone)
    lacking = 0.0
    for tip, slope in clearance.tips(shoe.lining):
        if not start + zone < tip < end - zone:
            continue
        k = int(np.abs(found.theta[::order] - tip).argmin()) * order
        part = slice(max(k - order, 0), k + order + 1)
        if (
            largest(found.theta[part], found.pressure[part], order)
            > NEAR_PEAK * found.peak_pressure
        ):
            growth = (
                UNDER_TIP
                * shoe.lining.material.E_half_plane
                * slope
                / scale_factor
                / found.peak_pressure
            )
            lacking = max(
                lacking, 1.0 if abs(found.theta[k] - tip) < AT_TIP * shoe.frame.unit else growth
            )
    return min(lacking, 1.0)


def _lacking(shoe: Shoe, scale_factor: float, found: ShoeResponse) -> float:
    """What the peak of p may lack, relative: 1 where it is, or is near, what grows without end at a
    lining's end or under a tip of its gap."""
    zone = edge_zone(shoe, scale_factor)
    return 1.0 if _cornered(found, zone) else _under_tips(shoe, scale_factor, found, zone)


def seen(error: Errors, brake: Brake, response: Response) -> tuple[Errors, str]:
    """The errors with what p and its peak lack at corners and under tips of the gap; of 1 what is
    not known at all: a peak at a lining's end or under a tip of its gap, and the pressure of a
    contact so short that this is said in words.
    """
    shoes, said = list(error.shoes), ""
    for i, (shoe, found) in enumerate(zip(brake.shoes, response.shoes, strict=True)):
        lacking = _lacking(shoe, brake.scale_factor, found)
        left = left_at_corners(brake, i, found) + left_under_tips(shoe, brake.scale_factor, found)
        shoes[i] = {
            **shoes[i],
            "pressure": shoes[i]["pressure"] + left,
            "peak": 1.0 if lacking == 1.0 else shoes[i]["peak"] + lacking,
        }
        length = (
            min((end - start for start, end in pressed_arcs(shoe, found)), default=math.inf)
            * brake.size
        )
        if length < SHORTEST * shoe.lining.thickness:
            said = (
                f"shoe {shoe.name!r}: its contact is {1e6 * length:.1g} um long, too short to know its pressure; "
                "torque and forces do not need it"
            )
            shoes[i] = {
                name: max(e, float(name in {"pressure", "peak"})) for name, e in shoes[i].items()
            }
    return Errors.worst(error.brake["torque"], shoes), said


def check_tolerance(brake: Brake, tolerance: float) -> None:
    """Raise BadInput for a tolerance out of range, and for a brake with a mesh file, which is not
    refined.
    """
    if not 0 < tolerance < 1:
        raise BadInput(f"--tolerance = {tolerance:g}: must be greater than 0 and less than 1")
    for shoe in brake.shoes:
        if shoe.mesh is not None:
            raise BadInput(
                f"--tolerance = {tolerance:g}: shoe {shoe.name!r} has a mesh file, which is not refined"
            )


def _final(responses: Sequence[Response], error: Errors, unknowns: int, missed: str) -> Response:
    """The last response with its errors, the time of all and the steps of the longest, and with a
    warning where the errors missed the tolerance.
    """
    last = responses[-1]
    seconds: dict[str, float] = {}
    for response in responses:
        for phase, spent in response.seconds.items():
            seconds[phase] = seconds.get(phase, 0.0) + spent
    notes = [f"adapted on {len(responses)} meshes, the last with {unknowns} unknowns a shoe"]
    return replace(
        last,
        error=error.brake,
        shoes=tuple(
            replace(shoe, error=own) for shoe, own in zip(last.shoes, error.shoes, strict=True)
        ),
        seconds=seconds,
        iterations=max(response.iterations for response in responses),
        notes=(*last.notes, *notes, *([f"warning: {missed}"] if missed else [])),
    )
