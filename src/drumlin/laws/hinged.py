"""Solve brakes with rigid shoes that turn about their hinge on a drum, by a law.

A block on a lever is such a shoe: its hinge is the lever's pin, and the actuation acts on the
lever. Signs are those of the shoe's own frame. Internal and external shoes, both rotations and
both hands are therefore one formula, and self-energising follows from moments.
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
"""Angle [rad] by which a lining may exceed the limits of a law: round-off."""


def layout(brake: Brake, shoe: Shoe) -> Layout:
    """The angles and radii of a shoe on a drum that the formulas of a law take."""
    return Layout(*shoe.arc, R=brake.size, a=shoe.pin.radius, dD=double_delta(brake, shoe))


def locking_friction(brake: Brake, shoe: Shoe, law: Law = SINE) -> float:
    """Friction mu_lock at which a shoe's torque becomes infinite by a law.

    It is inf if friction does not help the actuation.
    """
    return float(law.locking_friction(layout(brake, shoe)))


def why_not(law: Law, brake: Brake) -> str | None:
    """Reason why a law of hinged shoes does not apply to a brake, or None."""
    refusal = brake.shares or brake.surface.unlike(DRUM)
    if refusal is not None:
        return refusal
    for shoe in brake.shoes:
        reason = _why_not_shoe(law, shoe)
        if reason is not None:
            return f"shoe {shoe.name!r}: {reason}"
    return None


def _why_not_shoe(law: Law, shoe: Shoe) -> str | None:
    """Reason why a law of hinged shoes does not apply to a shoe, or None."""
    phi_1, phi_2 = shoe.arc
    if shoe.held_by != "hinge":
        return MOVES[shoe.held_by]
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
    """Solve a brake of hinged shoes by a law. Raises NoAnswer for a self-locking shoe."""
    shoes = tuple(_solve_shoe(law, brake, i) for i in range(len(brake.shoes)))
    notes: list[str] = []
    for i, shoe in enumerate(shoes):
        notes += _notes_on_shoe(law, brake, i, shoe)
    response = Response(
        model=law.name,
        shoes=shoes,
        balance=worst([shoe_balance(brake, i, shoe) for i, shoe in enumerate(shoes)]),
        left_out=LEFT_OUT[brake.surface.word],
        notes=tuple(notes),
    )
    return with_merits(brake, response)


def sine(brake: Brake) -> Response:
    """Solve a brake by the sine law; raises NoAnswer for a self-locking shoe."""
    return solve(SINE, brake)


def _notes_on_shoe(law: Law, brake: Brake, index: int, response: ShoeResponse) -> list[str]:
    """Notes on a shoe: missing contact, the law's remark, and the effect of lumping its forces."""
    said = f"shoe {response.name!r}:"
    if not response.contact_arcs:
        return [no_contact(response.name)]
    if response.lumped is None:
        return [f"{said} {law.remark}"] if law.remark else []
    # The resultant of the same pressure without lumping is what the lumped force stands for.
    spread = contact_resultant(brake, index, replace(response, lumped=None))
    share = float(np.linalg.norm(spread.normal) / np.linalg.norm(response.lumped.normal))
    ratio = float(law.friction(layout(brake, brake.shoes[index])))
    return [
        f"{said} contact lumped at the lining's middle; spread over its arc, the same pressure has "
        f"{formatted(share, '.1%')} of that normal force "
        f"and {formatted(share / ratio, '.1%')} of that friction force"
    ]


def _solve_shoe(law: Law, brake: Brake, index: int) -> ShoeResponse:
    """The response of shoe `index` by a law. Raises NoAnswer where the shoe locks itself."""
    shoe = brake.shoes[index]
    arc, mu = layout(brake, shoe), brake.friction
    moment = pressing_moment(shoe)
    # No force, or a force that turns the shoe away from the drum.
    if moment <= 0:
        return untouched(shoe, -shoe.actuation.vector)
    if law.resistance(mu, arc) <= 0:
        raise NoAnswer(
            f"shoe {shoe.name!r}: self-locking, friction {mu:g} is not below "
            f"mu_lock = {locking_friction(brake, shoe, law):.6g} of the {law.name} law"
        )
    amplitude = float(law.amplitude(moment, shoe.lining.width, mu, arc))
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
    """Torque [N m] of shoes that move along the middle radius of their linings on guides.

    The pressure is p_0 cos about the middle. The lumped friction is mu' N, with N the actuation's
    force along the middle radius (NPTEL lesson 12.1). The guides bear all other forces.
    """
    total = 0.0
    for shoe in brake.shoes:
        middle = 0.5 * (shoe.lining.start + shoe.lining.end)
        force = shoe.sign * float(shoe.actuation.vector @ [math.cos(middle), math.sin(middle)])
        lumped = brake.friction * float(equivalent_friction(layout(brake, shoe).half))
        total += lumped * max(force, 0.0) * brake.size
    return total


def pressing_moment(shoe: Shoe) -> float:
    """Moment of the actuation about the hinge [N m], positive towards the drum."""
    return -shoe.sign * shoe.frame.sense * shoe.actuation.moment_about(shoe.pin)


def contact(brake: Brake, shoe: Shoe, load: Load, factor: float = 1.0) -> Resultant:
    """Resultant on a shoe under this load [Pa], at `factor` times the brake's friction."""
    # The load is a pressure in radians of arc: width and radius make it a force.
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
    """The response of a rigid shoe that touches all along its lining.

    Parameters
    ----------
    brake, shoe : the shoe and its brake
    contact : resultant on the shoe
    pressure : function phi [rad] -> pressure [Pa]
    peak_at : phi of the largest pressure [rad]
    lumped : whether the law lumps the resultant at the lining's middle
    """
    phi = np.linspace(*shoe.arc, PRESSURE_NODES)[:: shoe.frame.sense]
    # The moment of friction about the hinge helps if it has the sense of the actuation's.
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
