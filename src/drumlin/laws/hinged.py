"""Solve drum brakes with rigid shoes on hinges by laws that assume the shape of the pressure.

A block that is fixed to a lever counts as a hinged shoe: its hinge is the lever's pin, and the
actuation acts on the lever. All signs are those of the shoe's own frame. One formula therefore
serves internal and external shoes, both rotations, and shoes on either side of their hinge. Whether
a shoe is self-energising follows from the moments about the hinge.
"""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import NoAnswer
from drumlin.base.texts import formatted
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.support import MOVES
from drumlin.brake.surface import DRUM
from drumlin.brake.units import deg
from drumlin.laws.rigid import LEFT_OUT, PRESSURE_NODES, no_contact
from drumlin.laws.shapes import SINE, Law, Layout, Load, equivalent_friction
from drumlin.response.balance import contact_resultant, shoe_balance, worst
from drumlin.response.merit import double_delta, with_merits
from drumlin.response.response import Response, ShoeResponse, untouched
from drumlin.response.resultants import Resultant, cross

ANGLE_ROUND_OFF = 1e-9
"""Angle [rad] by which round-off may let a lining exceed the range of angles that a law allows."""


def layout(brake: Brake, shoe: Shoe) -> Layout:
    """The angles and radii of a shoe on a drum that the formulas of a law need."""
    return Layout(*shoe.arc, R=brake.size, a=shoe.pin.radius, dD=double_delta(brake, shoe))


def locking_friction(brake: Brake, shoe: Shoe, law: Law = SINE) -> float:
    """Friction coefficient mu_lock at which, by a law, the torque of a shoe becomes infinite.

    It is inf if friction does not help the actuation.
    """
    return float(law.locking_friction(layout(brake, shoe)))


def why_not(law: Law, brake: Brake) -> str | None:
    """The reason why a law of hinged shoes does not apply to a brake; None if it applies."""
    refusal = brake.shares or brake.surface.unlike(DRUM)
    if refusal is not None:
        return refusal
    for shoe in brake.shoes:
        reason = _why_not_shoe(law, shoe)
        if reason is not None:
            return f"shoe {shoe.name!r}: {reason}"
    return None


def _why_not_shoe(law: Law, shoe: Shoe) -> str | None:
    """The reason why a law of hinged shoes does not apply to a shoe; None if it applies."""
    phi_1, phi_2 = shoe.arc
    if shoe.held_by != "hinge":
        return MOVES[shoe.held_by]
    # The pressure of the sine law is positive only from 0 to 180 degrees from the hinge.
    if law is SINE:
        if phi_1 < -ANGLE_ROUND_OFF or phi_2 > math.pi + ANGLE_ROUND_OFF:
            return (
                "the lining must lie within 0 to 180 deg of the hinge, "
                f"not {deg(phi_1)} to {deg(phi_2)}"
            )
        return None
    if phi_2 - phi_1 > math.pi + ANGLE_ROUND_OFF:
        return f"the lining's arc {deg(phi_2 - phi_1)} must not be more than 180 deg"
    middle = 0.5 * (phi_1 + phi_2)
    if not ANGLE_ROUND_OFF < middle < math.pi - ANGLE_ROUND_OFF:
        return "the normal force passes through the hinge, so that no moment can press the lining"
    return None


def solve(law: Law, brake: Brake) -> Response:
    """Solve a drum brake with hinged shoes by a law. Raises NoAnswer for a self-locking shoe."""
    shoes = tuple(_solve_shoe(law, brake, i) for i in range(len(brake.shoes)))
    notes: list[str] = []
    for i, shoe in enumerate(shoes):
        notes += _notes_on_shoe(law, brake, i, shoe)
    balances = [shoe_balance(brake, i, shoe) for i, shoe in enumerate(shoes)]
    response = Response(
        model=law.name,
        shoes=shoes,
        balance=worst(balances),
        left_out=LEFT_OUT[brake.surface.word],
        notes=tuple(notes),
    )
    return with_merits(brake, response)


def sine(brake: Brake) -> Response:
    """Solve a brake by the sine law. Raises NoAnswer for a self-locking shoe."""
    return solve(SINE, brake)


def _notes_on_shoe(law: Law, brake: Brake, index: int, response: ShoeResponse) -> list[str]:
    """Notes for the reader on the response of shoe `index` by a law.

    They say that the shoe does not touch, repeat the law's remark, or compare the force lumped at
    the lining's middle with the resultant of the same pressure spread over the arc.
    """
    said = f"shoe {response.name!r}:"
    if not response.contact_arcs:
        return [no_contact(response.name)]
    if response.lumped is None:
        return [f"{said} {law.remark}"] if law.remark else []
    # Without lumping, the resultant is that of the pressure spread over the arc.
    spread = contact_resultant(brake, index, replace(response, lumped=None))
    share = float(np.linalg.norm(spread.normal) / np.linalg.norm(response.lumped.normal))
    ratio = float(law.friction(layout(brake, brake.shoes[index])))
    return [
        f"{said} contact lumped at the lining's middle; spread over its arc, the same pressure has "
        f"{formatted(share, '.1%')} of that normal force "
        f"and {formatted(share / ratio, '.1%')} of that friction force"
    ]


def _solve_shoe(law: Law, brake: Brake, index: int) -> ShoeResponse:
    """The response of shoe `index` by a law. Raises NoAnswer if the shoe locks itself."""
    shoe = brake.shoes[index]
    arc, mu = layout(brake, shoe), brake.friction
    moment = pressing_moment(shoe)
    # Without a force, or under a force that turns the shoe away from the drum, nothing touches.
    if moment <= 0:
        return untouched(shoe, -shoe.actuation.vector)
    if law.resistance(mu, arc) <= 0:
        raise NoAnswer(
            f"shoe {shoe.name!r}: self-locking, friction {mu:g} is not below "
            f"mu_lock = {locking_friction(brake, shoe, law):.6g} of the {law.name} law"
        )
    amplitude = float(law.amplitude(moment, shoe.lining.width, mu, arc))
    # The integrals of the pressure [Pa] are the amplitude times those of f.
    load = Load(*(amplitude * integral for integral in law.load(arc)))
    return pressed(
        brake,
        shoe,
        contact(brake, shoe, load, float(law.friction(arc))),
        lambda phi: amplitude * law.pressure(phi, arc),
        float(law.peak_at(arc)),
        lumped=law.lumped,
    )


def guided_torque(brake: Brake) -> float:
    """Torque [N m] of a brake if guides let each shoe move only along its lining's middle radius.

    The pressure of such a shoe is p_0 cos(theta - middle). Its torque is that of the lumped
    friction mu' N at the drum's radius. N is the component of the actuation force along the middle
    radius (NPTEL lesson 12.1). The guides bear all other forces.
    """
    total = 0.0
    for shoe in brake.shoes:
        middle = 0.5 * (shoe.lining.start + shoe.lining.end)
        force = shoe.sign * float(shoe.actuation.vector @ [math.cos(middle), math.sin(middle)])
        lumped = brake.friction * float(equivalent_friction(layout(brake, shoe).half))
        total += lumped * max(force, 0.0) * brake.size
    return total


def pressing_moment(shoe: Shoe) -> float:
    """Moment of the actuation about the hinge [N m], positive if it turns the shoe to the drum."""
    return -shoe.sign * shoe.frame.sense * shoe.actuation.moment_about(shoe.pin)


def contact(brake: Brake, shoe: Shoe, load: Load, factor: float = 1.0) -> Resultant:
    """Resultant of pressure and friction on a hinged shoe.

    Parameters
    ----------
    brake, shoe : the brake and the shoe
    load : integrals [Pa] over the arc of the pressure, and of the pressure times cos and sin
    factor : factor on the brake's friction coefficient
    """
    # The integrals are over radians of arc: width times radius turns them into forces.
    force = shoe.lining.width * brake.size
    along: Floats = force * np.array([load.cos, load.sin])
    across = np.array([-along[1], along[0]])
    drag = factor * brake.drag
    return Resultant(
        normal=shoe.frame.to_brake(-shoe.sign * along),
        friction=shoe.frame.to_brake(drag * shoe.frame.sense * across),
        moment=drag * force * float(load.total) * brake.size,
    )


def pressed(
    brake: Brake,
    shoe: Shoe,
    contact: Resultant,
    pressure: Callable[[Floats], Floats],
    peak_at: float,
    *,
    lumped: bool = False,
) -> ShoeResponse:
    """The response of a hinged rigid shoe whose lining is in contact over its whole length.

    Parameters
    ----------
    brake, shoe : the brake and the shoe
    contact : resultant of pressure and friction on the shoe
    pressure : function that returns the pressure [Pa] at angles phi [rad] from the hinge
    peak_at : angle phi [rad] of the largest pressure
    lumped : whether the law lumps the resultant at the lining's middle
    """
    phi = np.linspace(*shoe.arc, PRESSURE_NODES)[:: shoe.frame.sense]
    # Friction is self-energising if its moment about the hinge has the actuation moment's sense.
    helping = contact.moment + float(cross(-shoe.pin.xy, contact.friction))
    return ShoeResponse(
        name=shoe.name,
        torque=abs(contact.moment),
        normal_force=float(np.linalg.norm(contact.normal)),
        self_energising=helping * shoe.actuation.moment_about(shoe.pin) > 0,
        peak_pressure=float(pressure(np.array(peak_at))),
        hinge_reaction=-shoe.actuation.vector - contact.force,
        contact_arcs=((shoe.lining.start, shoe.lining.end),),
        theta=shoe.frame.theta(phi),
        # Round-off may make the pressure negative at an end, as sin(pi) is 1e-16.
        pressure=np.maximum(pressure(phi), 0.0),
        lumped=contact if lumped else None,
    )
