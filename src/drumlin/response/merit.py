"""Figures of merit of a brake, for the pressure p(theta) of whatever model.

Every pressure on an arc acts like a short shoe: at the angle of its resultant, on a drum of the
apparent friction radius psi R (Barecki & Scieszka 1987, eq. 22-26). With that the figures of the
short shoe hold for all: eta = T/M = 1/(m - dD n) and S = m eta (UWA notes, eq. 8), where m and n
are the moments about the hinge of the normal pressure and of the friction, each over the torque T.
"""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import TypeVar

import numpy as np

from drumlin.arrays import Floats, Values
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.file import vary
from drumlin.errors import NoAnswer
from drumlin.response.balance import contact_resultant, loaded
from drumlin.response.limits import warnings
from drumlin.response.response import FlatMerit, Merit, Response, ShoeResponse
from drumlin.response.resultants import Resultant, cross, integrate

BrakeVar = TypeVar("BrakeVar", bound=Brake)


def double_delta(brake: Brake, shoe: Shoe) -> int:
    """dD of the UWA notes, eq. 6: +1 where a moment that drags as the drum turns and one that
    presses have one sense.

    That is an external shoe whose lining the drum drags away from the hinge, an internal one whose
    lining it drags towards the hinge; else it is -1. A lining that begins beyond half a turn from
    its hinge is pressed by the other sense, which the actuation's moment tells.
    """
    M = shoe.actuation.moment_about(shoe.pin)
    beyond = shoe.arc[1] > math.pi and M * -shoe.sign * shoe.frame.sense < 0
    return shoe.sign * brake.spin * shoe.frame.sense * (1 if beyond else -1)


def merit(brake: Brake, index: int, response: ShoeResponse, contact: Resultant) -> Merit:
    """Figures of merit of shoe `index` of a brake on a drum, from its `contact_resultant`."""
    shoe = brake.shoes[index]
    R, b = brake.size, shoe.lining.width
    to_centre = -shoe.pin.xy
    M = shoe.actuation.moment_about(shoe.pin)
    M_N = float(cross(to_centre, contact.normal))
    M_F = contact.moment + float(cross(to_centre, contact.friction))
    N, T = float(np.linalg.norm(contact.normal)), response.torque
    outwards = -shoe.sign * contact.normal  # along e_r, whichever side the shoe is on
    return Merit(
        resultant_angle=_near(math.atan2(outwards[1], outwards[0]), shoe) if N else None,
        friction_radius=_over(
            b * R * integrate(response.theta, response.pressure, response.order), N
        ),
        shoe_factor=_over(T, abs(shoe.actuation.force) * R),
        mechanical_advantage=_over(T, abs(M)),
        m=_over(-math.copysign(1, M) * M_N, T),
        n=_over(M_F, contact.moment),
        double_delta=double_delta(brake, shoe),
        sensitivity_at_fixed_shape=_over(-M_N, M) if N else None,
    )


def _near(angle: float, shoe: Shoe) -> float:
    """The angle [rad], full turns away at most, that is nearest to the lining's middle."""
    middle = 0.5 * (shoe.lining.start + shoe.lining.end)
    return middle + math.remainder(angle - middle, 2 * math.pi)


def _over(a: float, b: float) -> float | None:
    """a / b; None where that is no number, or too large for one."""
    return a / b if b and math.isfinite(a / b) else None


def barecki_shoe_factor(
    mu: Values, angle: Values, psi: Values, delta: Values, gamma: Values, sense: int
) -> Floats:
    """Shoe factor S = T/(P R) by Barecki & Scieszka (1987), eq. 26, from the position of the
    resultant.

    `angle` [rad] of the resultant from the hinge's radius, `psi` apparent friction radius over R,
    `delta` hinge radius over R, `gamma` arm of the force P about the hinge over R; `sense` +1 for
    what the paper calls leading (the friction on an external shoe points from the hinge to the
    loaded end), -1 trailing: it is the double delta.
    """
    return np.asarray(
        gamma * psi / (delta * (np.sin(angle) / mu + sense * np.cos(angle)) - sense * psi)
    )


def flat_merit(brake: Brake, index: int, response: ShoeResponse) -> FlatMerit:
    """Figures of merit of shoe `index` of a brake on a plane."""
    shoe = brake.shoes[index]
    M = shoe.actuation.moment_about(shoe.pin)
    force = brake.friction * response.normal_force
    resisting = (
        -math.copysign(1, M) * brake.friction * brake.spin * shoe.pin.y * response.normal_force
    )
    return FlatMerit(
        braking_force=force,
        braking_force_over_moment=_over(force, abs(M)),
        sensitivity_at_fixed_shape=_over(abs(M) - resisting, abs(M))
        if response.normal_force
        else None,
    )


def brake_factor(brake: Brake, response: Response) -> float | None:
    """T/(F R) of the whole brake, F the mean force of its actuation; on a plane braking force / F;
    None without force.

    Of shoes with equal forces it is the sum of their shoe factors. What a strut passes on is no
    actuation.
    """
    pushed = {link.to for link in brake.links}
    forces = [
        abs(shoe.actuation.force)
        for shoe in loaded(brake, response).shoes
        if shoe.name not in pushed
    ]
    force = math.fsum(forces) / len(forces)
    return _over(response.effect, force * brake.scale_factor)


def with_merits(brake: Brake, response: Response) -> Response:
    """The response with the figures of merit of its shoes, the load of a drum's bearings, and
    warnings as notes.
    """
    shoes, brake = enumerate(response.shoes), loaded(brake, response)
    notes = (
        *warnings(brake, {shoe.name: shoe.peak_pressure for shoe in response.shoes}),
        *response.notes,
    )
    if (
        brake.surface.straight
    ):  # a shoe on a plane has a braking force, in its figures of merit, and no torque
        merits = tuple(flat_merit(brake, i, shoe) for i, shoe in shoes)
        return replace(
            response,
            shoes=tuple(replace(shoe, torque=0.0) for shoe in response.shoes),
            merits=merits,
            notes=notes,
            surface=brake.surface,
        )
    contacts = [contact_resultant(brake, i, shoe) for i, shoe in enumerate(response.shoes)]
    return replace(
        response,
        merits=tuple(merit(brake, i, shoe, contacts[i]) for i, shoe in shoes),
        notes=notes,
        bearing_load=-np.sum([contact.force for contact in contacts], axis=0),
    )


def sensitivity(brake: Brake, solve: Callable[[Brake], Response], step: float = 1e-4) -> float:
    """S = (mu/T) dT/dmu of the whole brake at fixed actuation, by central differences over mu (1 +-
    step).

    Solves twice with any model, so that a change of the pressure's shape counts too (UWA notes, eq.
    viii). Raises NoAnswer for a brake that does not brake.
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
    """The brake with all actuation forces scaled alike, so that its largest peak pressure is the
    given one [Pa].

    For models in which everything is proportional to the force. Raises NoAnswer where nothing
    presses.
    """
    largest = max(shoe.peak_pressure for shoe in solve(brake).shoes)
    if largest == 0:
        raise NoAnswer("rated: no shoe presses on the drum, so no force gives that pressure")
    forces = [shoe.actuation.force * peak_pressure / largest for shoe in brake.shoes]
    return vary(brake, {f"shoe[{i}].actuation.force": force for i, force in enumerate(forces)})
