"""Check the equilibrium of a response: sums of forces and moments, relative to their largest."""

import math
from typing import TypeVar

from drumlin.base.arrays import Floats
from drumlin.brake.brake import Brake
from drumlin.response.response import Balance, Response, ShoeResponse
from drumlin.response.resultants import Resultant, cross, resultant

BrakeType = TypeVar("BrakeType", bound=Brake)


def contact_resultant(brake: Brake, index: int, response: ShoeResponse) -> Resultant:
    """Resultant of the contact on shoe `index`.

    It is the integral of the response's own pressure, unless the model lumps the contact's forces.
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
    """The brake under the actuation forces that its shoes share in a response."""
    forces = [shoe.force for shoe in response.shoes]
    if all(force is None for force in forces):
        return brake
    shoes = tuple(
        shoe if force is None else shoe.under(force)
        for shoe, force in zip(brake.shoes, forces, strict=True)
    )
    return brake.model_copy(update={"shoes": shoes})


def shoe_balance(brake: Brake, index: int, response: ShoeResponse) -> Balance:
    """Balance of shoe `index` under actuation, support reaction and its own p, about the hinge.

    Stops that no model has hold a shoe that does not touch. Its balance is therefore 0.
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
        length = brake.scale_factor * (shoe.lining.end - shoe.lining.start)
        moments += borne(shoe.actuation.force, length)
    return relative_balance(forces, moments)


def borne(force: float, length: float) -> list[float]:
    """Two opposite moments [N m] that set the scale of the moments on a guided shoe.

    The moments on a guide may all vanish. The force [N] on half of a lining of this length [m]
    then tells which moment is small.
    """
    return [0.5 * force * length, -0.5 * force * length]


def relative_balance(forces: list[Floats], moments: list[float]) -> Balance:
    """Sums of forces (2,) [N] and of moments [N m], each relative to its largest member.

    A sum is 0 if all its members are 0.
    """
    vectors = [force.tolist() for force in forces]
    largest_force = max((math.hypot(*vector) for vector in vectors), default=0.0)
    largest_moment = max((abs(moment) for moment in moments), default=0.0)
    force = math.hypot(*map(math.fsum, zip(*vectors, strict=True)))
    moment = abs(math.fsum(moments))
    return Balance(
        force=force / largest_force if largest_force else 0.0,
        moment=moment / largest_moment if largest_moment else 0.0,
    )


def worst(balances: list[Balance]) -> Balance:
    """The largest imbalance of forces and the largest of moments."""
    return Balance(
        max(balance.force for balance in balances), max(balance.moment for balance in balances)
    )
