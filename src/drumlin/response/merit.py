"""Figures of merit of a brake, from the pressure p(theta) of any model.

Every pressure on an arc acts like a short shoe. The short shoe stands at the angle of the
resultant, on a drum of the apparent friction radius psi R (Barecki & Scieszka 1987, eq. 22-26). The
figures of the short shoe therefore hold for any pressure: eta = T/M = 1/(m - dD n) and S = m eta
(UWA notes, eq. 8). Here m and n are the moments of the normal pressure and of the friction about
the hinge, each over the torque T.
"""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import TypeVar

import numpy as np

from drumlin.base.arrays import Floats, Values
from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.file import vary
from drumlin.response.balance import contact_resultant, loaded
from drumlin.response.limits import warnings
from drumlin.response.response import FlatMerit, Merit, Response, ShoeResponse
from drumlin.response.resultants import Resultant, cross, integrate

BrakeVar = TypeVar("BrakeVar", bound=Brake)


def double_delta(brake: Brake, shoe: Shoe) -> int:
    """Sign dD of the UWA notes, eq. 6: +1 if the moments that drag and that press have one sense.

    It is +1 for an external shoe whose lining the drum drags away from the hinge, and for an
    internal shoe whose lining the drum drags towards the hinge; otherwise it is -1. A lining that
    begins beyond half a turn from its hinge is pressed by the other sense. The actuation's moment
    tells which sense presses.
    """
    M = shoe.actuation.moment_about(shoe.pin)
    beyond = shoe.arc[1] > math.pi and M * -shoe.sign * shoe.frame.sense < 0
    return shoe.sign * brake.spin * shoe.frame.sense * (1 if beyond else -1)


def merit(brake: Brake, index: int, response: ShoeResponse, contact: Resultant) -> Merit:
    """Figures of merit of a shoe on a drum.

    Parameters
    ----------
    brake : the brake under the forces of the response
    index : of the shoe in the brake
    response : what the shoe does
    contact : its `contact_resultant`
    """
    shoe = brake.shoes[index]
    R, b = brake.size, shoe.lining.width
    # Moments about the hinge: of the actuation, of the normal pressure and of the friction.
    to_centre = -shoe.pin.xy
    M = shoe.actuation.moment_about(shoe.pin)
    M_N = float(cross(to_centre, contact.normal))
    M_F = contact.moment + float(cross(to_centre, contact.friction))
    N, T = float(np.linalg.norm(contact.normal)), response.torque
    # The resultant pressure along e_r, on whichever side of the drum the shoe is.
    outwards = -shoe.sign * contact.normal
    angle = math.atan2(outwards[1], outwards[0])
    sum_of_forces = b * R * integrate(response.theta, response.pressure, response.order)
    return Merit(
        resultant_angle=_near(angle, shoe) if N else None,
        friction_radius=_over(sum_of_forces, N),
        shoe_factor=_over(T, abs(shoe.actuation.force) * R),
        mechanical_advantage=_over(T, abs(M)),
        m=_over(-math.copysign(1, M) * M_N, T),
        n=_over(M_F, contact.moment),
        double_delta=double_delta(brake, shoe),
        sensitivity_at_fixed_shape=_over(-M_N, M) if N else None,
    )


def _near(angle: float, shoe: Shoe) -> float:
    """The angle [rad], moved by full turns, that is nearest to the lining's middle."""
    middle = 0.5 * (shoe.lining.start + shoe.lining.end)
    return middle + math.remainder(angle - middle, 2 * math.pi)


def _over(a: float, b: float) -> float | None:
    """Quotient a / b; None if it is undefined or too large for a number."""
    return a / b if b and math.isfinite(a / b) else None


def barecki_shoe_factor(
    mu: Values, angle: Values, psi: Values, delta: Values, gamma: Values, sense: int
) -> Floats:
    """Shoe factor S = T/(P R) by Barecki & Scieszka (1987), eq. 26.

    Parameters
    ----------
    mu : friction coefficient
    angle : of the resultant, from the hinge's radius [rad]
    psi : apparent friction radius over R
    delta : radius of the hinge over R
    gamma : arm of the force P about the hinge over R
    sense : +1 for a leading shoe of the paper, -1 for a trailing shoe; it is the double delta. On a
        leading external shoe the friction points from the hinge to the loaded end.
    """
    resisting = delta * (np.sin(angle) / mu + sense * np.cos(angle))
    return np.asarray(gamma * psi / (resisting - sense * psi))


def flat_merit(brake: Brake, index: int, response: ShoeResponse) -> FlatMerit:
    """Figures of merit of shoe `index` of a brake on a plane."""
    shoe = brake.shoes[index]
    M = shoe.actuation.moment_about(shoe.pin)
    force = brake.friction * response.normal_force
    resisting = (
        -math.copysign(1, M) * brake.friction * brake.spin * shoe.pin.y * response.normal_force
    )
    sensitivity = _over(abs(M) - resisting, abs(M)) if response.normal_force else None
    return FlatMerit(
        braking_force=force,
        braking_force_over_moment=_over(force, abs(M)),
        sensitivity_at_fixed_shape=sensitivity,
    )


def brake_factor(brake: Brake, response: Response) -> float | None:
    """Brake factor T/(F R) of the whole brake, F the mean force of its actuation.

    On a plane it is the braking force over F. Of shoes with equal forces it is the sum of their
    shoe factors. The force that a strut passes on is no actuation. Without force it is None.
    """
    pushed = {link.to for link in brake.links}
    shoes = loaded(brake, response).shoes
    forces = [abs(shoe.actuation.force) for shoe in shoes if shoe.name not in pushed]
    force = math.fsum(forces) / len(forces)
    return _over(response.effect, force * brake.scale_factor)


def with_merits(brake: Brake, response: Response) -> Response:
    """Complete a response by figures of merit, the load of the bearings, and warnings as notes."""
    shoes, brake = response.shoes, loaded(brake, response)
    peaks = {shoe.name: shoe.peak_pressure for shoe in shoes}
    notes = (*warnings(brake, peaks), *response.notes)
    if brake.surface.straight:
        # A shoe on a plane has a braking force, in its figures of merit, and no torque.
        return replace(
            response,
            shoes=tuple(replace(shoe, torque=0.0) for shoe in shoes),
            merits=tuple(flat_merit(brake, i, shoe) for i, shoe in enumerate(shoes)),
            notes=notes,
            surface=brake.surface,
        )
    contacts = [contact_resultant(brake, i, shoe) for i, shoe in enumerate(shoes)]
    return replace(
        response,
        merits=tuple(merit(brake, i, shoe, contacts[i]) for i, shoe in enumerate(shoes)),
        notes=notes,
        bearing_load=-np.sum([contact.force for contact in contacts], axis=0),
    )


def sensitivity(brake: Brake, solve: Callable[[Brake], Response], step: float = 1e-4) -> float:
    """Sensitivity S = (mu/T) dT/dmu of the whole brake at fixed actuation, by central differences.

    It solves with any model at mu (1 +- step), so that a change of the pressure's shape counts too
    (UWA notes, eq. viii). Raises NoAnswer for a brake that does not brake.
    """

    def at(friction: float) -> float:
        varied = vary(brake, {"friction": friction})
        return with_merits(varied, solve(varied)).effect

    high, low = at(brake.friction * (1 + step)), at(brake.friction * (1 - step))
    if high + low == 0:
        raise NoAnswer(
            "sensitivity: the brake does not brake, so its torque has no relative change"
        )
    return (high - low) / (high + low) / step


def rated(brake: BrakeVar, solve: Callable[[BrakeVar], Response], peak_pressure: float) -> BrakeVar:
    """Scale all actuation forces of a brake alike, for a given largest peak pressure [Pa].

    It suits models whose answer is proportional to the force. Raises NoAnswer if nothing presses.
    """
    largest = max(shoe.peak_pressure for shoe in solve(brake).shoes)
    if largest == 0:
        raise NoAnswer("rated: no shoe presses on the drum, so no force gives that pressure")
    forces = [shoe.actuation.force * peak_pressure / largest for shoe in brake.shoes]
    return vary(brake, {f"shoe[{i}].actuation.force": force for i, force in enumerate(forces)})
