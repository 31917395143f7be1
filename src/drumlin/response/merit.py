"""Figures of merit of a brake, from the pressure p(theta) of any model.

Every pressure on an arc acts like a short shoe. The short shoe stands at the angle of the
resultant, on a drum of the apparent friction radius psi R (Barecki & Scieszka 1987, eq. 22-26). The
figures of the short shoe therefore hold for any pressure: eta = T/M = 1/(m - dD n) and S = m eta
(UWA notes, eq. 8). Here m is the moment of the normal pressure about the hinge over the torque T,
and n the moment of the friction about the hinge over T.
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
    """The sign dD of the UWA notes, eq. 6: +1 or -1.

    The sign is +1 for an external shoe whose lining the drum drags away from the hinge, and for an
    internal shoe whose lining the drum drags towards the hinge. Otherwise the sign is -1. A lining
    that begins beyond half a turn from its hinge is pressed by the opposite moment, and its sign is
    the opposite one.
    """
    # The moment of the actuation tells which sense presses the lining.
    M = shoe.actuation.moment_about(shoe.pin)
    beyond = shoe.arc[1] > math.pi and M * -shoe.sign * shoe.frame.sense < 0
    return shoe.sign * brake.spin * shoe.frame.sense * (1 if beyond else -1)


def merit(brake: Brake, index: int, response: ShoeResponse, contact: Resultant) -> Merit:
    """The figures of merit of a shoe on a drum.

    Parameters
    ----------
    brake : the brake with the actuation forces of the response
    index : position of the shoe in the brake
    response : the response of the shoe
    contact : the `contact_resultant` of the shoe
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
        resultant_angle=_turned_to_lining(angle, shoe) if N else None,
        friction_radius=_quotient(sum_of_forces, N),
        shoe_factor=_quotient(T, abs(shoe.actuation.force) * R),
        mechanical_advantage=_quotient(T, abs(M)),
        m=_quotient(-math.copysign(1, M) * M_N, T),
        n=_quotient(M_F, contact.moment),
        double_delta=double_delta(brake, shoe),
        sensitivity_at_fixed_shape=_quotient(-M_N, M) if N else None,
    )


def _turned_to_lining(angle: float, shoe: Shoe) -> float:
    """The angle [rad] plus the full turns that bring it nearest to the middle of the lining."""
    middle = 0.5 * (shoe.lining.start + shoe.lining.end)
    return middle + math.remainder(angle - middle, 2 * math.pi)


def _quotient(a: float, b: float) -> float | None:
    """The quotient a / b; None if the quotient is undefined or too large for a number."""
    return a / b if b and math.isfinite(a / b) else None


def barecki_shoe_factor(
    mu: Values, angle: Values, psi: Values, delta: Values, gamma: Values, sense: int
) -> Floats:
    """The shoe factor S = T/(P R) by Barecki & Scieszka (1987), eq. 26.

    Parameters
    ----------
    mu : friction coefficient
    angle : angle of the resultant from the hinge's radius [rad]
    psi : apparent friction radius over R
    delta : radius of the hinge over R
    gamma : arm of the force P about the hinge over R
    sense : +1 for a leading shoe of the paper, -1 for a trailing shoe, as `double_delta`. On a
        leading external shoe the friction points from the hinge to the loaded end.
    """
    resisting = delta * (np.sin(angle) / mu + sense * np.cos(angle))
    return np.asarray(gamma * psi / (resisting - sense * psi))


def flat_merit(brake: Brake, index: int, response: ShoeResponse) -> FlatMerit:
    """The figures of merit of shoe `index` of a brake on a plane."""
    shoe, N = brake.shoes[index], response.normal_force
    M = shoe.actuation.moment_about(shoe.pin)
    force = brake.friction * N
    # The moment of the friction about the hinge, positive if it helps the actuation.
    helping = -math.copysign(1, M) * brake.friction * brake.spin * shoe.pin.y * N
    return FlatMerit(
        braking_force=force,
        braking_force_over_moment=_quotient(force, abs(M)),
        sensitivity_at_fixed_shape=_quotient(abs(M) - helping, abs(M)) if N else None,
    )


def brake_factor(brake: Brake, response: Response) -> float | None:
    """The brake factor T/(F R) of the whole brake, with the mean force F of its actuation.

    On a plane the brake factor is the braking force over F. For shoes with equal forces the brake
    factor is the sum of the shoe factors. A force that a strut passes on is no actuation. Without
    actuation the brake factor is None.
    """
    pushed = {link.to for link in brake.links}
    shoes = loaded(brake, response).shoes
    forces = [abs(shoe.actuation.force) for shoe in shoes if shoe.name not in pushed]
    force = math.fsum(forces) / len(forces)
    return _quotient(response.effect, force * brake.scale_factor)


def with_merits(brake: Brake, response: Response) -> Response:
    """Add figures of merit, the load of the drum's bearings, and warnings to a response."""
    shoes, brake = response.shoes, loaded(brake, response)
    peaks = {shoe.name: shoe.peak_pressure for shoe in shoes}
    notes = (*warnings(brake, peaks), *response.notes)
    if brake.surface.straight:
        # A shoe on a plane has no torque. Its braking force is one of the figures of merit.
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
    """The sensitivity S = (mu/T) dT/dmu of the whole brake at fixed actuation, by differences.

    `solve` is any model. The two solves at mu (1 +- step) include the change of the pressure's
    shape (UWA notes, eq. viii). Raises NoAnswer for a brake that does not brake.
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
    """Scale all actuation forces of a brake by one factor, for a given largest peak pressure [Pa].

    The model `solve` must be one whose answer is proportional to the force. Raises NoAnswer if no
    shoe presses on the drum.
    """
    largest = max(shoe.peak_pressure for shoe in solve(brake).shoes)
    if largest == 0:
        raise NoAnswer("rated: no shoe presses on the drum, so no force gives that pressure")
    changes = {}
    for i, shoe in enumerate(brake.shoes):
        changes[f"shoe[{i}].actuation.force"] = shoe.actuation.force * peak_pressure / largest
    return vary(brake, changes)
