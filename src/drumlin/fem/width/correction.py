"""The correction of an answer of plane stress for the widths of the shoes, off by default.

A brake is solved twice on the same coarse hp elements of the section: with degree 2 across the
width, and in plane stress. The two answers differ by the effect of the widths. The differences of
their torques, forces and pressures are added to the answer of plane stress on fine elements. The
error that remains after the correction is stated as a fraction of the correction.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import BadInput, NoAnswer
from drumlin.base.texts import error_text_in_percent, number_as_text
from drumlin.brake.brake import Brake
from drumlin.fem.model import DEFAULT_PENALTY_FACTOR
from drumlin.fem.preparation.cache import CacheOfCondensedBodies
from drumlin.fem.width.error import (
    CoarseSolutionsWithAndWithoutWidth,
    coarse_solutions_with_and_without_shoe_width,
    relative_distance_of_plane_stress_from_width_solution,
)
from drumlin.fem.width.prepare import reason_why_effect_of_widths_is_not_estimated
from drumlin.response.balance import (
    brake_with_forces_of_response,
    largest_imbalance_among_shoes,
    relative_imbalance_of_shoe,
)
from drumlin.response.response import (
    EstimatedErrorOfPlaneStress,
    Response,
    ShoeResponse,
    length_of_edge_zone_left_out_of_peak_search,
)
from drumlin.response.resultants import LiningWithoutEndZones, contact_arcs_from_nodal_pressures

REMAINING_ERROR_OVER_WIDTH_CORRECTION: Mapping[str, float] = {
    "torque": 0.4,
    "pressure": 0.8,
    "reaction": 0.5,
}
"""Error that remains after the correction for the widths, as a fraction of the correction.

The true remaining error is at most this fraction on 95 % of the brakes for the torque, on 93 % for
the pressure averaged over the width (L2 norm) and on 95 % for the reactions. The brakes were 95
random brakes; the parts of some shoes had one width, and the parts of other shoes several widths.
The command was `python -m drumlin_studies.width_error 1000 1099`. The reference has degree 5 across
the width. Only brakes on which the error of plane stress exceeded 0.1 % were counted. The median
fractions for torque, pressure and reactions are 0.07, 0.21 and 0.08; the largest are 1.6, 1.9 and
1.4. Where the effects of lateral contraction and of the bending of a table on the torque cancel,
the correction of the torque is small, and the remaining error may exceed the fraction. Larger
values state larger errors than most brakes have, and smaller values are exceeded more often.
"""
WIDTH_CORRECTED_ATTRIBUTES = (
    "torque",
    "normal_force",
    "hinge_reaction",
    "pivot_reaction",
    "reaction_moment",
    "force",
)
"""Attributes of a shoe's response to which the difference of the two coarse answers is added."""


def correct_response_for_shoe_widths(
    brake: Brake,
    response: Response,
    *,
    penalty: float = DEFAULT_PENALTY_FACTOR,
    cache: CacheOfCondensedBodies | None = None,
) -> Response:
    """The answer of plane stress, corrected for the widths of the shoes.

    The corrected response contains the estimate of the error that remains, a note on the
    correction, and the imbalance between its pressures p(theta) and its reactions.

    Parameters
    ----------
    brake : the brake
    response : answer of plane stress; the coarse elements are small at the ends of its contact
    penalty : factor alpha of the contact stiffness alpha E/t (lining modulus E, thickness t)
    cache : substructures of earlier solves

    Raises
    ------
    BadInput
        if the model of the width does not apply to the brake
    NoAnswer
        if the brake has no answer on the coarse elements, or if a shoe with its width has no
        contact
    """
    require_that_width_model_applies_to_brake(brake)
    try:
        answers = coarse_solutions_with_and_without_shoe_width(
            brake, response, penalty=penalty, cache=cache
        )
    except NoAnswer as error:
        raise NoAnswer(f"--finite-width: the correction is not known: {error}") from error
    change = relative_distance_of_plane_stress_from_width_solution(brake, *answers)
    if change.unknown:
        raise NoAnswer(f"--finite-width: the correction is not known: {change.unknown}")
    shoes = []
    for i in range(len(response.shoes)):
        shoes.append(shoe_response_corrected_for_widths(brake, i, response.shoes[i], answers))
    corrected = replace(
        response,
        shoes=tuple(shoes),
        plane_stress_error=estimated_error_after_width_correction(change),
    )
    under_forces = brake_with_forces_of_response(brake, corrected)
    balance = largest_imbalance_among_shoes(
        [relative_imbalance_of_shoe(under_forces, i, shoe) for i, shoe in enumerate(shoes)]
    )
    corrected = replace(corrected, balance=balance)
    return replace(
        corrected, notes=(*response.notes, note_on_correction_for_shoe_widths(change, corrected))
    )


def require_that_width_model_applies_to_brake(brake: Brake) -> None:
    """Raise BadInput where the model of the width does not apply to a brake."""
    reason = reason_why_effect_of_widths_is_not_estimated(brake)
    if reason is not None:
        raise BadInput(f"--finite-width: does not apply to this brake: {reason}")


def shoe_response_corrected_for_widths(
    brake: Brake, index: int, fine: ShoeResponse, answers: CoarseSolutionsWithAndWithoutWidth
) -> ShoeResponse:
    """The response of a shoe in plane stress, plus the difference of the two coarse answers.

    The peak pressure and the arcs in contact follow from the corrected pressure.

    Parameters
    ----------
    brake : the brake
    index : position of the shoe in the brake
    fine : response of the shoe in plane stress on fine elements
    answers : answers of the brake on coarse elements, in plane stress and with degree 2 across the
        width
    """
    plane, wide = answers.plane.shoes[index], answers.wide.shoes[index]
    values: dict[str, Any] = {}
    for name in WIDTH_CORRECTED_ATTRIBUTES:
        terms = getattr(fine, name), getattr(plane, name), getattr(wide, name)
        if all(term is not None for term in terms):
            own, without, with_widths = terms
            values[name] = own + (with_widths - without)
    # Round-off may put the first or the last angle slightly outside the angles of the coarse
    # answers.
    theta = np.clip(fine.theta, plane.theta[0], plane.theta[-1])
    difference = pressure_of_shoe_zero_outside_contact(
        wide, theta
    ) - pressure_of_shoe_zero_outside_contact(plane, theta)
    # Where only one of the coarse answers is in contact, the sum may be slightly negative.
    pressure = np.maximum(fine.pressure + difference, 0.0)
    zone = length_of_edge_zone_left_out_of_peak_search(
        brake.shoes[index], brake.length_per_surface_coordinate
    )
    return replace(
        fine,
        pressure=pressure,
        peak_pressure=LiningWithoutEndZones(
            fine.theta, fine.order, zone
        ).peak_pressure_outside_end_zones(pressure),
        contact_arcs=contact_arcs_from_nodal_pressures(fine.theta, pressure, fine.order),
        **values,
    )


def pressure_of_shoe_zero_outside_contact(shoe: ShoeResponse, theta: Floats) -> Floats:
    """The pressure [Pa] of a shoe at angles theta (n,) [rad]; 0 outside its arcs in contact.

    In an element in which the contact ends, the pressure is a polynomial that oscillates about zero
    beyond the end; these values are replaced by 0.
    """
    in_contact = np.zeros(theta.shape, dtype=bool)
    for start, end in shoe.contact_arcs:
        in_contact |= (theta >= start) & (theta <= end)
    return np.where(in_contact, np.maximum(shoe.pressure_at(theta), 0.0), 0.0)


def estimated_error_after_width_correction(
    change: EstimatedErrorOfPlaneStress,
) -> EstimatedErrorOfPlaneStress:
    """The estimated error that remains after the correction for the widths.

    It is the relative correction `change` times REMAINING_ERROR_OVER_WIDTH_CORRECTION.
    """
    shoes = []
    for shoe in change.shoes:
        shoes.append(
            {
                name: REMAINING_ERROR_OVER_WIDTH_CORRECTION[name] * size
                for name, size in shoe.items()
            }
        )
    brake = {
        name: REMAINING_ERROR_OVER_WIDTH_CORRECTION[name] * size
        for name, size in change.brake.items()
    }
    return EstimatedErrorOfPlaneStress(brake, tuple(shoes), corrected=True)


def note_on_correction_for_shoe_widths(
    change: EstimatedErrorOfPlaneStress, corrected: Response
) -> str:
    """The note of a corrected response: how large the correction and the imbalance are."""
    torque, pressure, reaction = (
        number_as_text(change.brake[name], ".2%") for name in ("torque", "pressure", "reaction")
    )
    balance = corrected.balance
    return (
        f"corrected for the widths of the shoes: torque by {torque}, p by {pressure} (L2, worst "
        f"shoe), reaction by {reaction}; each is corrected by itself, so that p(theta) balances "
        f"to {error_text_in_percent(balance.force)} (force) and "
        f"{error_text_in_percent(balance.moment)} (moment) only"
    )
