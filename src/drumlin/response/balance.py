"""Compute the imbalance of a response: sums of forces and of moments on each shoe.

In equilibrium each sum is zero. Each sum is made relative to the largest force or moment in it.
"""

import math
from dataclasses import astuple
from typing import TypeVar

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake.brake import Brake
from drumlin.brake.further_loads import brake_with_loads_assigned_to_shoes
from drumlin.response.response import ForceAndMomentImbalance, Response, ShoeResponse
from drumlin.response.resultants import (
    PressureAndFrictionResultant,
    planar_cross_product,
    resultant_of_pressure_and_friction,
)

BrakeTypeVariableInBalance = TypeVar("BrakeTypeVariableInBalance", bound=Brake)


def resultant_of_contact_on_shoe(
    brake: Brake, index: int, response: ShoeResponse
) -> PressureAndFrictionResultant:
    """The resultant of pressure and friction on the lining of shoe `index`.

    The resultant is the integral of the pressure in the shoe's response. A model that lumps the
    contact forces at one point or in sectors states the resultant itself.
    """
    if response.lumped is not None:
        return response.lumped
    shoe = brake.shoes[index]
    return resultant_of_pressure_and_friction(
        brake.surface,
        response.theta,
        response.pressure,
        order=response.order,
        size=brake.size,
        per_place=brake.length_per_surface_coordinate * shoe.lining.width,
        sign=shoe.sign_internal_plus_external_minus,
        drag=brake.signed_friction_stress_over_pressure(shoe)
        if response.friction_stress is None
        else brake.sign_of_motion,
        dragging=response.friction_stress,
    )


def brake_with_forces_of_response(
    brake: BrakeTypeVariableInBalance, response: Response
) -> BrakeTypeVariableInBalance:
    """The brake with the actuation forces and spring pulls that a model has found for its shoes.

    If a cam or a strut determines the forces on the shoes, the response states the force on each
    shoe.
    """
    if response.spring_pulls:
        brake = brake_with_loads_assigned_to_shoes(brake, response.spring_pulls)
    shoes = list(brake.shoes)
    for i, answer in enumerate(response.shoes):
        # The force is None for a shoe that keeps the force of the brake file.
        if answer.force is not None:
            shoes[i] = shoes[i].shoe_with_changed_actuation_force(answer.force)
    unchanged = all(answer.force is None for answer in response.shoes)
    return brake if unchanged else brake.model_copy(update={"shoes": tuple(shoes)})


def relative_imbalance_of_shoe(
    brake: Brake, index: int, response: ShoeResponse
) -> ForceAndMomentImbalance:
    """The imbalance of shoe `index` under actuation, support reaction, pressure and friction.

    Moments are about the shoe's hinge. The imbalance of a shoe that does not touch is 0.
    """
    # A shoe that does not touch rests on stops, whose forces no model computes.
    if not response.contact_arcs:
        return ForceAndMomentImbalance(0.0, 0.0)
    shoe = brake.shoes[index]
    contact = resultant_of_contact_on_shoe(brake, index, response)
    forces = [contact.force, response.hinge_reaction, shoe.sum_of_forces_of_all_loads]
    hinge = shoe.pin.xy
    moments = [
        contact.moment - float(planar_cross_product(hinge, contact.force)),
        shoe.moment_of_all_loads_about_point(shoe.pin),
        response.reaction_moment,
    ]
    if shoe.guide is not None:
        length = brake.length_per_surface_coordinate * (shoe.lining.end - shoe.lining.start)
        moments += moments_that_scale_imbalance_on_guide(shoe.largest_force_of_any_load, length)
    return relative_magnitudes_of_force_and_moment_sums(forces, moments)


def moments_that_scale_imbalance_on_guide(force: float, length: float) -> list[float]:
    """Two opposite moments [N m] that give the moments on a guided shoe a scale.

    The real moments on a guided shoe may all vanish but for round-off, and the imbalance would then
    be relative to round-off. The two added moments, plus and minus half of force times length,
    prevent this.

    Parameters
    ----------
    force : largest force of any load on the shoe [N]
    length : length of the lining [m]
    """
    return [0.5 * force * length, -0.5 * force * length]


def relative_magnitudes_of_force_and_moment_sums(
    forces: list[Floats], moments: list[float]
) -> ForceAndMomentImbalance:
    """The relative magnitudes of the sum of forces and of the sum of moments.

    Each magnitude is relative to the largest single force or moment of its sum. If all forces or
    all moments are 0, their relative sum is 0. `forces` are vectors (2,) [N], and `moments` are in
    N m.
    """
    vectors = np.array(forces).reshape(-1, 2).tolist()
    largest_force = max((math.hypot(*vector) for vector in vectors), default=0.0)
    largest_moment = max(map(abs, moments), default=0.0)
    force = math.hypot(*map(math.fsum, zip(*vectors, strict=True)))
    moment = abs(math.fsum(moments))
    return ForceAndMomentImbalance(
        force=force / largest_force if largest_force else 0.0,
        moment=moment / largest_moment if largest_moment else 0.0,
    )


def largest_imbalance_among_shoes(
    balances: list[ForceAndMomentImbalance],
) -> ForceAndMomentImbalance:
    """The largest imbalance of forces, and the largest of moments, among the shoes of a brake."""
    forces, moments = zip(*map(astuple, balances), strict=True)
    return ForceAndMomentImbalance(max(forces), max(moments))
