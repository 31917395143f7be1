"""Solve drum brakes with hinged rigid shoes by laws that assume the shape of the pressure.

A block that is fixed to a lever counts as a hinged shoe: its hinge is the lever's pin, and the
actuation acts on the lever. Angles phi and signs are measured in the shoe's own frame, in which the
lining lies at positive angles from the hinge. One formula therefore serves internal and external
shoes, both rotations, and linings on either side of their hinge. Whether a shoe is self-energising
follows from the moments about the hinge.
"""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import NoAnswer
from drumlin.base.texts import number_as_text
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.support import MOTION_TEXTS_BY_KIND_OF_SUPPORT
from drumlin.brake.surface import FRICTION_SURFACE_OF_DRUM
from drumlin.brake.units import angle_as_text_in_degrees
from drumlin.laws.rigid import (
    NEGLECTED_BY_RIGID_LAWS,
    NUMBER_OF_PRESSURE_NODES_ON_DRUM_LINING,
    note_on_shoe_without_contact,
)
from drumlin.laws.shapes import (
    SINE_PRESSURE_LAW,
    PressureIntegrals,
    PressureLawOfHingedShoe,
    ShoeAnglesAndRadii,
    ratio_of_equivalent_to_lining_friction,
)
from drumlin.response.balance import (
    largest_imbalance_among_shoes,
    relative_imbalance_of_shoe,
    resultant_of_contact_on_shoe,
)
from drumlin.response.merit import (
    response_with_figures_of_merit,
    sign_of_friction_moment_about_hinge,
)
from drumlin.response.response import Response, ShoeResponse, response_of_shoe_without_contact
from drumlin.response.resultants import (
    PressureAndFrictionResultant,
    planar_cross_product,
    polynomial_nodes_on_linings_and_slots,
    slots_from_nodes_and_lining_mask,
)

ROUND_OFF_BEYOND_ALLOWED_LINING_ANGLE = 1e-9
"""Largest angle [rad], due to round-off, by which a lining may exceed the angles a law allows."""


def angles_and_radii_of_hinged_shoe(brake: Brake, shoe: Shoe) -> ShoeAnglesAndRadii:
    """The angles, radii and the sign dD of a shoe on a drum, which the formulas of a law need."""
    return ShoeAnglesAndRadii(
        *shoe.arc,
        R=brake.size,
        a=shoe.pin.radius,
        dD=sign_of_friction_moment_about_hinge(brake, shoe),
        slots=shoe.slots,
    )


def self_locking_friction_of_hinged_shoe(
    brake: Brake, shoe: Shoe, law: PressureLawOfHingedShoe = SINE_PRESSURE_LAW
) -> float:
    """Friction coefficient mu_lock at which the torque of a shoe becomes infinite by a law.

    It is inf if friction does not help the actuation.
    """
    return float(law.self_locking_friction(angles_and_radii_of_hinged_shoe(brake, shoe)))


def reason_against_hinged_shoe_law(law: PressureLawOfHingedShoe, brake: Brake) -> str | None:
    """The reason why a law of hinged shoes does not apply to a brake; None if it applies."""
    refusal = (
        brake.reason_why_cam_or_strut_sets_forces
        or brake.surface.reason_why_surface_is_not_required_one(FRICTION_SURFACE_OF_DRUM)
    )
    if refusal is None and law.pressure_integrals_on_arc_part is None:
        refusal = brake.reason_if_several_linings_are_not_allowed(
            "a force lumped at the lining's middle"
        )
    if refusal is not None:
        return refusal
    for shoe in brake.shoes:
        reason = _reason_against_law_for_shoe(law, shoe)
        if reason is not None:
            return f"shoe {shoe.name!r}: {reason}"
    return None


def _reason_against_law_for_shoe(law: PressureLawOfHingedShoe, shoe: Shoe) -> str | None:
    """The reason why a law of hinged shoes does not apply to a shoe; None if it applies."""
    phi_1, phi_2 = shoe.arc
    if shoe.kind_of_support != "hinge":
        return MOTION_TEXTS_BY_KIND_OF_SUPPORT[shoe.kind_of_support]
    # The pressure of the sine law is positive only from 0 to 180 degrees from the hinge.
    if law is SINE_PRESSURE_LAW:
        if (
            phi_1 < -ROUND_OFF_BEYOND_ALLOWED_LINING_ANGLE
            or phi_2 > math.pi + ROUND_OFF_BEYOND_ALLOWED_LINING_ANGLE
        ):
            return (
                "the lining must lie within 0 to 180 deg of the hinge, "
                f"not {angle_as_text_in_degrees(phi_1)} to {angle_as_text_in_degrees(phi_2)}"
            )
        return None
    if phi_2 - phi_1 > math.pi + ROUND_OFF_BEYOND_ALLOWED_LINING_ANGLE:
        return (
            f"the lining's arc {angle_as_text_in_degrees(phi_2 - phi_1)} must not be more "
            f"than 180 deg"
        )
    middle = 0.5 * (phi_1 + phi_2)
    if (
        not ROUND_OFF_BEYOND_ALLOWED_LINING_ANGLE
        < middle
        < math.pi - ROUND_OFF_BEYOND_ALLOWED_LINING_ANGLE
    ):
        return "the normal force passes through the hinge, so that no moment can press the lining"
    return None


def solve_brake_with_hinged_shoes_by_law(law: PressureLawOfHingedShoe, brake: Brake) -> Response:
    """Solve a drum brake with hinged shoes by a law. Raises NoAnswer for a self-locking shoe."""
    shoes = tuple(_hinged_shoe_response_by_law(law, brake, i) for i in range(len(brake.shoes)))
    notes: list[str] = []
    for i, shoe in enumerate(shoes):
        notes += _notes_on_shoe_response(law, brake, i, shoe)
    balances = [relative_imbalance_of_shoe(brake, i, shoe) for i, shoe in enumerate(shoes)]
    response = Response(
        model=law.name,
        shoes=shoes,
        balance=largest_imbalance_among_shoes(balances),
        left_out=NEGLECTED_BY_RIGID_LAWS[brake.surface.name],
        notes=tuple(notes),
    )
    return response_with_figures_of_merit(brake, response)


def solve_brake_by_sine_law(brake: Brake) -> Response:
    """Solve a brake by the sine law. Raises NoAnswer for a self-locking shoe."""
    return solve_brake_with_hinged_shoes_by_law(SINE_PRESSURE_LAW, brake)


def _notes_on_shoe_response(
    law: PressureLawOfHingedShoe, brake: Brake, index: int, response: ShoeResponse
) -> list[str]:
    """Notes for the user on the response of shoe `index` by a law.

    A note says that the shoe does not touch, or repeats the law's remark. Some laws let the whole
    contact force act at the lining's middle. For these laws a note compares the force with the
    resultant of the same pressure, distributed over the arc.
    """
    said = f"shoe {response.name!r}:"
    if not response.contact_arcs:
        return [note_on_shoe_without_contact(response.name)]
    if response.lumped is None:
        return [f"{said} {law.remark}"] if law.remark else []
    # If `lumped` is None, `resultant_of_contact_on_shoe` integrates the pressure over the arc.
    spread = resultant_of_contact_on_shoe(brake, index, replace(response, lumped=None))
    share = float(np.linalg.norm(spread.normal) / np.linalg.norm(response.lumped.normal))
    ratio = float(law.friction(angles_and_radii_of_hinged_shoe(brake, brake.shoes[index])))
    return [
        f"{said} the law has the contact as one force at the lining's middle; its pressure, if it "
        f"acted along the whole arc, would add up to {number_as_text(share, '.1%')} of the normal "
        f"force that the law takes, and to {number_as_text(share / ratio, '.1%')} of the friction "
        "force"
    ]


def _hinged_shoe_response_by_law(
    law: PressureLawOfHingedShoe, brake: Brake, index: int
) -> ShoeResponse:
    """The response of shoe `index` by a law. Raises NoAnswer if the shoe locks itself."""
    shoe = brake.shoes[index]
    arc, mu = (
        angles_and_radii_of_hinged_shoe(brake, shoe),
        brake.friction_coefficient_of_shoe_at_zero_pressure(shoe),
    )
    moment = actuation_moment_towards_drum(shoe)
    # Without a force, or under a force that turns the shoe away from the drum, the shoe is not in
    # contact.
    if moment <= 0:
        return response_of_shoe_without_contact(shoe, -shoe.sum_of_forces_of_all_loads)
    if law.actuation_moment_over_pressure_amplitude(mu, arc) <= 0:
        raise NoAnswer(
            f"shoe {shoe.name!r}: self-locking, friction {mu:g} is not below "
            f"mu_lock = {self_locking_friction_of_hinged_shoe(brake, shoe, law):.6g} "
            f"of the {law.name} law"
        )
    amplitude = float(law.pressure_amplitude(moment, shoe.lining.width, mu, arc))
    # The integrals of the pressure are its amplitude [Pa] times the integrals of f.
    load = PressureIntegrals(
        *(amplitude * integral for integral in law.pressure_integrals_over_all_linings(arc))
    )
    return response_of_hinged_shoe_in_contact(
        brake,
        shoe,
        resultant_of_hinged_shoe_pressure_and_friction(brake, shoe, load, float(law.friction(arc))),
        lambda phi: amplitude * law.pressure(phi, arc),
        law.angle_of_peak_pressure(arc),
        lumped=law.lumped,
    )


def torque_of_brake_with_guided_shoes(brake: Brake) -> float:
    """Torque [N m] of a brake whose guided shoes move only along their linings' middle radii.

    The pressure of such a shoe is p_0 cos(theta - middle). Its torque is mu' N R, with the
    equivalent friction coefficient mu' (`ratio_of_equivalent_to_lining_friction`), the drum's
    radius R, and the component N of the actuation force along the middle radius (NPTEL lesson
    12.1). The guides bear all other forces.
    """
    total = 0.0
    for shoe in brake.shoes:
        middle = 0.5 * (shoe.lining.start + shoe.lining.end)
        force = shoe.sign_internal_plus_external_minus * float(
            shoe.sum_of_forces_of_all_loads @ [math.cos(middle), math.sin(middle)]
        )
        lumped = brake.friction_coefficient_of_shoe_at_zero_pressure(shoe) * float(
            ratio_of_equivalent_to_lining_friction(
                angles_and_radii_of_hinged_shoe(brake, shoe).half_of_lining_arc
            )
        )
        total += lumped * max(force, 0.0) * brake.size
    return total


def actuation_moment_towards_drum(shoe: Shoe) -> float:
    """Moment [N m] of all loads on a shoe about its hinge, positive if it presses on the drum."""
    return (
        -shoe.sign_internal_plus_external_minus
        * shoe.frame.sense
        * shoe.moment_of_all_loads_about_point(shoe.pin)
    )


def resultant_of_hinged_shoe_pressure_and_friction(
    brake: Brake, shoe: Shoe, load: PressureIntegrals, factor: float = 1.0
) -> PressureAndFrictionResultant:
    """Resultant of pressure and friction on a hinged shoe.

    Parameters
    ----------
    brake, shoe : the brake and the shoe
    load : integrals [Pa] over the angle phi of the pressure, of the pressure times cos phi, and of
        the pressure times sin phi
    factor : factor by which the lining's friction coefficient is multiplied
    """
    # The integrals over an angle [rad], times width and radius, are integrals over the area.
    force = shoe.lining.width * brake.size
    along: Floats = force * np.array([load.cos, load.sin])
    across = np.array([-along[1], along[0]])
    drag = factor * brake.signed_friction_stress_over_pressure(shoe)
    return PressureAndFrictionResultant(
        normal=shoe.frame.convert_vectors_from_shoe_to_brake_frame(
            -shoe.sign_internal_plus_external_minus * along
        ),
        friction=shoe.frame.convert_vectors_from_shoe_to_brake_frame(
            drag * shoe.frame.sense * across
        ),
        moment=drag * force * float(load.total) * brake.size,
    )


def response_of_hinged_shoe_in_contact(
    brake: Brake,
    shoe: Shoe,
    contact: PressureAndFrictionResultant,
    pressure: Callable[[Floats], Floats],
    angle_of_largest_pressure: float,
    *,
    lumped: bool = False,
) -> ShoeResponse:
    """The response of a hinged rigid shoe whose lining is in contact over its whole length.

    Parameters
    ----------
    brake, shoe : the brake and the shoe
    contact : resultant of pressure and friction on the shoe
    pressure : function that returns the pressure [Pa] at angles phi [rad] from the hinge
    angle_of_largest_pressure : angle phi [rad] of the largest pressure
    lumped : whether the law lets the resultant act as one force at the lining's middle
    """
    sense = shoe.frame.sense
    nodes = [
        np.linspace(*arc, NUMBER_OF_PRESSURE_NODES_ON_DRUM_LINING)[::sense] for arc in shoe.arcs
    ][::sense]
    theta, on_lining = polynomial_nodes_on_linings_and_slots(
        [shoe.frame.surface_coordinates_of_phi(phi) for phi in nodes], 2
    )
    # Round-off of the angle may make the pressure negative at an end where it is zero.
    pressures = np.zeros(len(theta))
    pressures[on_lining] = np.maximum(pressure(np.concatenate(nodes)), 0.0)
    # A shoe is self-energising if friction and actuation turn it about the hinge in the same sense.
    helping = contact.moment + float(planar_cross_product(-shoe.pin.xy, contact.friction))
    return ShoeResponse(
        name=shoe.name,
        torque=abs(contact.moment),
        normal_force=float(np.linalg.norm(contact.normal)),
        self_energising=helping * shoe.moment_of_all_loads_about_point(shoe.pin) > 0,
        peak_pressure=float(pressure(np.array(angle_of_largest_pressure))),
        hinge_reaction=-shoe.sum_of_forces_of_all_loads - contact.force,
        contact_arcs=shoe.lining.arcs,
        theta=theta,
        pressure=pressures,
        slots=slots_from_nodes_and_lining_mask(theta, on_lining),
        lumped=contact if lumped else None,
    )
