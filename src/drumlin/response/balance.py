"""Check the equilibrium of a response: sums of forces and moments, relative to their largest."""

import math
from dataclasses import astuple
from typing import TypeVar

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake.brake import Brake
from drumlin.response.response import Balance, Response, ShoeResponse
from drumlin.response.resultants import Resultant, cross, resultant

BrakeType = TypeVar("BrakeType", bound=Brake)


def contact_resultant(brake: Brake, index: int, response: ShoeResponse) -> Resultant:
    """The resultant of pressure and friction on shoe `index`.

    The resultant is the integral of the response's pressure, unless the model lumps the contact's
    forces at one point or in sectors.
    """
    if response.lumped is not None:
        return response.lumped
    shoe = brake.shoes[index]
    return resultant(
        brake.surface,
        response.theta,
        response.pressure,
        order=response.order,
        size=brake.size,
        per_place=brake.scale_factor * shoe.lining.width,
        sign=shoe.sign,
        drag=brake.drag,
    )


def loaded(brake: BrakeType, response: Response) -> BrakeType:
    """The brake with the actuation forces of a response, in which shoes may share forces."""
    shoes = list(brake.shoes)
    for i, answer in enumerate(response.shoes):
        # The force is None for a shoe that keeps the force of the brake file.
        if answer.force is not None:
            shoes[i] = shoes[i].under(answer.force)
    unchanged = all(answer.force is None for answer in response.shoes)
    return brake if unchanged else brake.model_copy(update={"shoes": tuple(shoes)})


def shoe_balance(brake: Brake, index: int, response: ShoeResponse) -> Balance:
    """The imbalance of shoe `index` under actuation, support reaction and contact, about its hinge.

    The imbalance of a shoe that does not touch is 0.
    """
    # Stops that no model has hold a shoe that does not touch.
    if not response.contact_arcs:
        return Balance(0.0, 0.0)
    shoe = brake.shoes[index]
    contact = contact_resultant(brake, index, response)
    forces = [contact.force, response.hinge_reaction, shoe.actuation.vector]
    hinge = shoe.pin.xy
    moments = [
        contact.moment - float(cross(hinge, contact.force)),
        shoe.actuation.moment_about(shoe.pin),
        response.reaction_moment,
    ]
    if shoe.guide is not None:
        length = brake.scale_factor * (shoe.lining.end - shoe.lining.start)
        moments += guide_moments(shoe.actuation.force, length)
    return relative_balance(forces, moments)


def guide_moments(force: float, length: float) -> list[float]:
    """Two opposite moments [N m] that set the scale of the moments on a guided shoe.

    All other moments on the shoe may vanish. The scale is the moment about the middle of a lining
    of this length [m] of the actuation force [N], if the force acted at an end of the lining.
    """
    return [0.5 * force * length, -0.5 * force * length]


def relative_balance(forces: list[Floats], moments: list[float]) -> Balance:
    """The sums of forces (2,) [N] and of moments [N m], each relative to its largest member.

    A relative sum is 0 if all its members are 0.
    """
    vectors = np.array(forces).reshape(-1, 2).tolist()
    largest_force = max((math.hypot(*vector) for vector in vectors), default=0.0)
    largest_moment = max(map(abs, moments), default=0.0)
    force = math.hypot(*map(math.fsum, zip(*vectors, strict=True)))
    moment = abs(math.fsum(moments))
    return Balance(
        force=force / largest_force if largest_force else 0.0,
        moment=moment / largest_moment if largest_moment else 0.0,
    )


def worst(balances: list[Balance]) -> Balance:
    """The largest imbalance of forces and the largest imbalance of moments of several shoes."""
    forces, moments = zip(*map(astuple, balances), strict=True)
    return Balance(max(forces), max(moments))
