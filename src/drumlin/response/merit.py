"""Figures of merit of a brake, such as its shoe factors, from the pressure p(theta) of any model.

Pressure and friction on an arc have the same resultant force and torque as a short shoe. This short
shoe stands at the angle of the resultant, on a drum of the apparent friction radius psi R (Barecki
& Scieszka 1987, eq. 22-26). The formulas of the short shoe therefore hold for any pressure (UWA
notes, eq. 8): the ratio of torque T to actuation moment M is eta = T/M = 1/(m - dD n), and the
sensitivity to the friction coefficient is S = m eta. Here m T is the moment of the normal pressure
about the hinge, n T the moment of the friction about the hinge, and dD the sign
`sign_of_friction_moment_about_hinge`.
"""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import TypeVar

import numpy as np

from drumlin.base.arrays import Floats, NumberOrArray
from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.file import vary
from drumlin.response.balance import brake_with_forces_of_response, resultant_of_contact_on_shoe
from drumlin.response.limits import warnings_on_large_strains_and_lining_overlap
from drumlin.response.response import (
    FiguresOfMeritOnDrum,
    FiguresOfMeritOnPlane,
    Response,
    ShoeResponse,
)
from drumlin.response.resultants import (
    PressureAndFrictionResultant,
    integral_of_piecewise_polynomial,
    planar_cross_product,
)

BrakeTypeVariableInMerit = TypeVar("BrakeTypeVariableInMerit", bound=Brake)


def sign_of_friction_moment_about_hinge(brake: Brake, shoe: Shoe) -> int:
    """The sign dD (double delta) of the friction's moment in the UWA notes, eq. 6: +1 or -1.

    The sign is +1 for an external shoe whose lining the drum drags away from the hinge, and for an
    internal shoe whose lining the drum drags towards the hinge. Otherwise the sign is -1. A
    lining that lies more than half a turn from its hinge is pressed by an actuation moment of the
    opposite sense. Its dD then has the opposite sign, too.
    """
    # A lining that reaches beyond half a turn from the hinge is pressed either before or beyond
    # this angle. The sense of the actuation moment tells on which side of this angle.
    M = shoe.moment_of_all_loads_about_point(shoe.pin)
    beyond = (
        shoe.arc[1] > math.pi and M * -shoe.sign_internal_plus_external_minus * shoe.frame.sense < 0
    )
    return (
        shoe.sign_internal_plus_external_minus
        * brake.sign_of_motion
        * shoe.frame.sense
        * (1 if beyond else -1)
    )


def figures_of_merit_of_shoe_on_drum(
    brake: Brake, index: int, response: ShoeResponse, contact: PressureAndFrictionResultant
) -> FiguresOfMeritOnDrum:
    """The figures of merit of one shoe on a drum.

    Parameters
    ----------
    brake : the brake with the actuation forces of the response
    index : position of the shoe in the brake
    response : the response of the shoe
    contact : resultant of pressure and friction on the shoe's lining
    """
    shoe = brake.shoes[index]
    R, b = brake.size, shoe.lining.width
    # M, M_N and M_F are the moments of the loads, the normal pressure and the friction about the
    # hinge.
    to_centre = -shoe.pin.xy
    M = shoe.moment_of_all_loads_about_point(shoe.pin)
    M_N = float(planar_cross_product(to_centre, contact.normal))
    M_F = contact.moment + float(planar_cross_product(to_centre, contact.friction))
    N, T = float(np.linalg.norm(contact.normal)), response.torque
    # With the sign, `outwards` points from the drum's centre to the lining, for internal and for
    # external shoes.
    outwards = -shoe.sign_internal_plus_external_minus * contact.normal
    angle = math.atan2(outwards[1], outwards[0])
    sum_of_forces = (
        b * R * integral_of_piecewise_polynomial(response.theta, response.pressure, response.order)
    )
    return FiguresOfMeritOnDrum(
        resultant_angle=_angle_in_same_turn_as_lining(angle, shoe) if N else None,
        friction_radius=_quotient_or_none(sum_of_forces, N),
        shoe_factor=_quotient_or_none(T, abs(shoe.actuation.force) * R),
        mechanical_advantage=_quotient_or_none(T, abs(M)),
        m=_quotient_or_none(-math.copysign(1, M) * M_N, T),
        n=_quotient_or_none(M_F, contact.moment),
        double_delta=sign_of_friction_moment_about_hinge(brake, shoe),
        sensitivity_at_fixed_shape=_quotient_or_none(-M_N, M) if N else None,
    )


def _angle_in_same_turn_as_lining(angle: float, shoe: Shoe) -> float:
    """An angle [rad] plus the full turns that bring it nearest to the middle of a shoe's lining."""
    middle = 0.5 * (shoe.lining.start + shoe.lining.end)
    return middle + math.remainder(angle - middle, 2 * math.pi)


def _quotient_or_none(a: float, b: float) -> float | None:
    """The quotient a / b; None if b is 0 or the quotient is not a finite number."""
    return a / b if b and math.isfinite(a / b) else None


def barecki_shoe_factor(
    mu: NumberOrArray,
    angle: NumberOrArray,
    psi: NumberOrArray,
    delta: NumberOrArray,
    gamma: NumberOrArray,
    sense: int,
) -> Floats:
    """The shoe factor T/(P R) of Barecki & Scieszka: torque / (actuation force * drum radius).

    The formula is eq. 26 of their paper of 1987.

    Parameters
    ----------
    mu : friction coefficient
    angle : angle [rad] from the line between drum centre and hinge to the resultant of the pressure
    psi : apparent friction radius, divided by the drum's radius R
    delta : distance of the hinge from the drum's centre, divided by R
    gamma : arm of the actuation force P about the hinge, divided by R
    sense : +1 for a leading shoe of the paper, -1 for a trailing shoe; it is the sign that
        `sign_of_friction_moment_about_hinge` returns. On a leading external shoe the friction
        points from the hinge to the loaded end.
    """
    resisting = delta * (np.sin(angle) / mu + sense * np.cos(angle))
    return np.asarray(gamma * psi / (resisting - sense * psi))


def mean_friction_of_shoe(brake: Brake, shoe: Shoe, response: ShoeResponse) -> float:
    """The friction coefficient of a shoe; its mean weighted with the pressure if it varies."""
    if response.friction_stress is None:
        return brake.friction_coefficient_of_shoe_at_zero_pressure(shoe)
    values = (response.friction_stress, response.pressure)
    stress, pressure = (
        integral_of_piecewise_polynomial(response.theta, each, response.order) for each in values
    )
    return (
        stress / pressure if pressure else brake.friction_coefficient_of_shoe_at_zero_pressure(shoe)
    )


def figures_of_merit_of_shoe_on_plane(
    brake: Brake, index: int, response: ShoeResponse
) -> FiguresOfMeritOnPlane:
    """The figures of merit of shoe `index` of a brake on a plane."""
    shoe, N = brake.shoes[index], response.normal_force
    M = shoe.moment_of_all_loads_about_point(shoe.pin)
    friction = mean_friction_of_shoe(brake, shoe, response)
    force = friction * N
    # `helping` is the moment of the friction about the hinge, positive if it helps the actuation.
    helping = -math.copysign(1, M) * friction * brake.sign_of_motion * shoe.pin.y * N
    return FiguresOfMeritOnPlane(
        braking_force=force,
        braking_force_over_moment=_quotient_or_none(force, abs(M)),
        sensitivity_at_fixed_shape=_quotient_or_none(abs(M) - helping, abs(M)) if N else None,
    )


def brake_factor(brake: Brake, response: Response) -> float | None:
    """The brake factor T/(F R), with the torque T of the whole brake and the drum's radius R.

    F is the mean actuation force of the shoes that no strut pushes. For shoes with equal forces the
    brake factor is the sum of the shoe factors. On a plane it is the braking force divided by F.
    Without actuation it is None.
    """
    pushed = brake.names_of_shoes_pushed_by_struts
    shoes = brake_with_forces_of_response(brake, response).shoes
    forces = [abs(shoe.actuation.force) for shoe in shoes if shoe.name not in pushed]
    force = math.fsum(forces) / len(forces)
    return _quotient_or_none(response.effect, force * brake.length_per_surface_coordinate)


def response_with_figures_of_merit(brake: Brake, response: Response) -> Response:
    """Add figures of merit, the load on the drum's bearings, and warnings to a response."""
    shoes, brake = response.shoes, brake_with_forces_of_response(brake, response)
    peaks = {shoe.name: shoe.peak_pressure for shoe in shoes}
    notes = (*warnings_on_large_strains_and_lining_overlap(brake, peaks), *response.notes)
    if brake.surface.is_plane_and_not_drum:
        # A shoe on a plane has no torque. Its figures of merit hold its braking force.
        return replace(
            response,
            shoes=tuple(replace(shoe, torque=0.0) for shoe in shoes),
            merits=tuple(
                figures_of_merit_of_shoe_on_plane(brake, i, shoe) for i, shoe in enumerate(shoes)
            ),
            notes=notes,
            surface=brake.surface,
        )
    contacts = [resultant_of_contact_on_shoe(brake, i, shoe) for i, shoe in enumerate(shoes)]
    return replace(
        response,
        merits=tuple(
            figures_of_merit_of_shoe_on_drum(brake, i, shoe, contacts[i])
            for i, shoe in enumerate(shoes)
        ),
        notes=notes,
        bearing_load=-np.sum([contact.force for contact in contacts], axis=0),
    )


def torque_sensitivity_to_friction_by_differences(
    brake: Brake, solve: Callable[[Brake], Response], step: float = 1e-4
) -> float:
    """The sensitivity S = (mu/T) dT/dmu of a brake's torque to friction, at fixed actuation.

    S is the central difference of two solves at mu (1 - step) and mu (1 + step). It therefore
    includes the change of the pressure's shape with mu (UWA notes, eq. viii).

    Parameters
    ----------
    brake : the brake
    solve : function that solves a brake by some model
    step : relative change of the friction coefficient

    Raises
    ------
    NoAnswer
        if the brake has no torque
    """

    def torque_or_force_at_friction(friction: float) -> float:
        """The torque [N m], or on a plane the braking force [N], at a friction coefficient."""
        varied = brake.brake_with_new_friction_coefficient(friction)
        return response_with_figures_of_merit(varied, solve(varied)).effect

    high, low = (
        torque_or_force_at_friction(brake.friction * (1 + step)),
        torque_or_force_at_friction(brake.friction * (1 - step)),
    )
    if high + low == 0:
        raise NoAnswer(
            "sensitivity: the brake does not brake, so its torque has no relative change"
        )
    return (high - low) / (high + low) / step


def brake_scaled_to_peak_pressure(
    brake: BrakeTypeVariableInMerit,
    solve: Callable[[BrakeTypeVariableInMerit], Response],
    peak_pressure: float,
) -> BrakeTypeVariableInMerit:
    """The brake with its actuation forces scaled by one factor to reach a given peak pressure.

    Parameters
    ----------
    brake : the brake
    solve : function that solves a brake by a model whose pressures are proportional to the forces
    peak_pressure : largest peak pressure [Pa] among the shoes of the scaled brake

    Raises
    ------
    NoAnswer
        if no shoe presses on the drum
    """
    largest = max(shoe.peak_pressure for shoe in solve(brake).shoes)
    if largest == 0:
        raise NoAnswer("rated: no shoe presses on the drum, so no force gives that pressure")
    changes = {}
    for i, shoe in enumerate(brake.shoes):
        changes[f"shoe[{i}].actuation.force"] = shoe.actuation.force * peak_pressure / largest
    return vary(brake, changes)
