"""Rigid-shoe laws: drum rigid, shoe rigid, pressure proportional to the lining's normal approach.

A shoe that turns about its hinge presses with p = p_a sin(phi) / sin(phi_a), phi measured at O from
the hinge towards the lining (UWA notes, long rotational shoe; NPTEL lesson 12.1; Simscape double-shoe
brake). The signs below are derived in the shoe's own frame, so that internal and external shoes,
both rotations and both hands are one formula, and self-energising follows from moments.
"""

import math
from typing import NamedTuple

import numpy as np

from drumlin.brake import Brake, Shoe
from drumlin.errors import NoAnswer
from drumlin.response import Response, ShoeResponse, shoe_balance, untouched, worst
from drumlin.units import deg

NODES = 257  # of p(theta) over the lining; quadratic pieces: integrals are right to 1e-10


class SineIntegrals(NamedTuple):
    """Integrals over the arc: Is of sin, Iss of sin^2, Isc of sin cos."""

    Is: float
    Iss: float
    Isc: float


def sine_integrals(phi_1: float, phi_2: float) -> SineIntegrals:
    """The integrals of sin, sin^2 and sin cos from phi_1 to phi_2 [rad]."""
    return SineIntegrals(
        Is=math.cos(phi_1) - math.cos(phi_2),
        Iss=(phi_2 - phi_1) / 2 - (math.sin(2 * phi_2) - math.sin(2 * phi_1)) / 4,
        Isc=(math.cos(2 * phi_1) - math.cos(2 * phi_2)) / 4,
    )


def sine_moments(brake: Brake, shoe: Shoe) -> tuple[float, float]:
    """Moments about the hinge of normal pressure and of friction at mu = 1 [N m], for p = sin(phi) [Pa].

    In the shoe's frame, counter-clockwise positive:  sign b R a Iss  and  s b R (R Is - a Isc).
    """
    R, b, a = brake.drum.radius, shoe.lining.width, shoe.hinge.radius
    integral = sine_integrals(*shoe.arc)
    spin = brake.spin * shoe.frame.sense
    return shoe.sign * b * R * a * integral.Iss, spin * b * R * (R * integral.Is - a * integral.Isc)


def locking_friction(brake: Brake, shoe: Shoe) -> float:
    """mu_lock of the sine law: the friction at which M_F reaches M_N; infinite where friction opposes."""
    normal, friction = sine_moments(brake, shoe)
    return -normal / friction if normal * friction < 0 else math.inf


def sine_why_not(brake: Brake) -> str | None:
    """Why the sine law does not apply: a lining that does not lie within 0..180 deg of its hinge."""
    for shoe in brake.shoes:
        phi_1, phi_2 = shoe.arc
        if phi_1 < -1e-9 or phi_2 > math.pi + 1e-9:
            return (
                f"shoe {shoe.name!r}: the lining must lie within 0 to 180 deg of the hinge, "
                f"not {deg(phi_1)} to {deg(phi_2)}"
            )
    return None


def sine(brake: Brake) -> Response:
    """The sine law p = p_a sin(phi)/sin(phi_a) for every shoe, from its actuation.

    Raises NoAnswer for a self-locking shoe.
    """
    shoes = tuple(_sine_shoe(brake, i) for i in range(len(brake.shoes)))
    notes = tuple(
        f"shoe {shoe.name!r}: no contact, the force does not turn it towards the drum"
        for shoe in shoes
        if not shoe.contact_arcs
    )
    return Response(
        model="sine",
        shoes=shoes,
        balance=worst([shoe_balance(brake, i, shoe) for i, shoe in enumerate(shoes)]),
        left_out=(
            "elasticity of shoe, backing and drum: rigid by assumption",
            "clearance: the law is that of a lining that fits",
        ),
        notes=notes,
    )


def _sine_shoe(brake: Brake, index: int) -> ShoeResponse:
    shoe = brake.shoes[index]
    phi_1, phi_2 = shoe.arc
    normal, friction = sine_moments(brake, shoe)
    actuation = shoe.frame.sense * shoe.actuation.moment_about(shoe.hinge)
    if actuation * normal >= 0:  # no moment, or one that turns the lining away from the drum
        return untouched(shoe, -shoe.actuation.vector)
    resistance = normal + brake.friction * friction
    if resistance * normal <= 0:
        raise NoAnswer(
            f"shoe {shoe.name!r}: self-locking, friction {brake.friction:g} is not below "
            f"mu_lock = {locking_friction(brake, shoe):.6g} of the sine law"
        )
    amplitude = -actuation / resistance  # p_a / sin(phi_a)
    load = amplitude * shoe.lining.width * brake.drum.radius
    integral = sine_integrals(phi_1, phi_2)
    drag = brake.friction * brake.spin * shoe.frame.sense
    contact = load * (
        -shoe.sign * np.array([integral.Isc, integral.Iss]) + drag * np.array([-integral.Iss, integral.Isc])
    )
    phi = np.linspace(phi_1, phi_2, NODES)[:: shoe.frame.sense]
    return ShoeResponse(
        name=shoe.name,
        torque=brake.friction * load * brake.drum.radius * integral.Is,
        normal_force=load * math.hypot(integral.Isc, integral.Iss),
        self_energising=brake.friction * friction * actuation > 0,
        peak_pressure=amplitude * (1.0 if phi_1 <= math.pi / 2 <= phi_2 else max(math.sin(phi_1), math.sin(phi_2))),
        hinge_reaction=-shoe.actuation.vector - shoe.frame.to_brake(contact),
        contact_arcs=((shoe.lining.start, shoe.lining.end),),
        theta=shoe.frame.theta(phi),
        pressure=np.maximum(amplitude * np.sin(phi), 0.0),  # sin(pi) is 1e-16 off
    )
