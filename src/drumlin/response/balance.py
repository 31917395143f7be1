"""Equilibrium of what a model returns: sums of forces and moments, relative to their largest
members.
"""

import math
from typing import TypeVar

from drumlin.arrays import Floats
from drumlin.brake.brake import Brake
from drumlin.response.response import Balance, Response, ShoeResponse
from drumlin.response.resultants import Resultant, cross, resultant

BrakeType = TypeVar("BrakeType", bound=Brake)


def contact_resultant(brake: Brake, index: int, response: ShoeResponse) -> Resultant:
    """What the surface does to shoe `index`: the integrals of the response's own p, or what its law
    lumps.
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
    """The brake under the forces that its shoes share in a response."""
    forces = [shoe.force for shoe in response.shoes]
    if all(force is None for force in forces):
        return brake
    shoes = tuple(
        shoe if force is None else shoe.under(force)
        for shoe, force in zip(brake.shoes, forces, strict=True)
    )
    return brake.model_copy(update={"shoes": shoes})


def shoe_balance(brake: Brake, index: int, response: ShoeResponse) -> Balance:
    """Equilibrium of shoe `index` under actuation, hinge reaction and its own p, about the hinge.

    A shoe that does not touch is held by stops that no model has: nothing is claimed, both are 0.
    """
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
        moments += borne(
            shoe.actuation.force, brake.scale_factor * (shoe.lining.end - shoe.lining.start)
        )
    return relative_balance(forces, moments)


def borne(force: float, length: float) -> list[float]:
    """Two moments [N m] that say what is a small one where a guide may bear none at all: the
    force's in the middle of a lining of this length [m], of either half.
    """
    return [0.5 * force * length, -0.5 * force * length]


def relative_balance(forces: list[Floats], moments: list[float]) -> Balance:
    """Sums of forces (2,) [N] and of moments [N m], each relative to its largest member; 0 where
    all are 0.
    """
    both = [force.tolist() for force in forces]
    largest_force = max((math.hypot(*force) for force in both), default=0.0)
    largest_moment = max((abs(m) for m in moments), default=0.0)
    force = math.hypot(*map(math.fsum, zip(*both, strict=True)))
    return Balance(
        force=force / largest_force if largest_force else 0.0,
        moment=abs(math.fsum(moments)) / largest_moment if largest_moment else 0.0,
    )


def worst(balances: list[Balance]) -> Balance:
    """The largest of each entry."""
    return Balance(max(b.force for b in balances), max(b.moment for b in balances))
