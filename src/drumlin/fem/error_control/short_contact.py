"""The place and length of a contact that is too short for elements, by the half-plane formula.

A shoe that touches the drum at one place presses there with a force F per width. If the gap beside
the place rises steeply, the contact is so short that no division resolves its pressure. A pass of a
solve leaves one pressed node on such a shoe, and does not show how short the contact is: the
contact would become shorter with each finer division. The force F and the shape of the gap tell
the length at once. If the force is small, the rigid shoe gives place and force before the first
pass, so that already the first division has columns that end at the place.

The contact ends where the gap of the rigid shoe, which just touches the drum, is F/(k E'). Here E'
is the modulus of the half-plane with the compliance of the lining's surface, and k depends on the
shape of the gap: pi/2 for a parabola (Hertz) and 1 for a wedge, see Johnson, Contact Mechanics,
sections 4.2 and 5.2. The bending of the shoe is neglected. If the contact is a length L of a gap of
the slope s, then F/E' is about s L. The force bends a shoe of length l, thickness t and modulus E_s
by a slope of up to some 6 F l^2/(E_s t^3). This slope is the part 6 (E'/E_s) (l/t)^2 L/t of s: some
per cent of a soft lining on a thin shoe, since L/t is below SHORTEST_CONTACT_WITH_KNOWN_PRESSURE.
Springs, levers, weights and speeds bend a shoe by forces that may be far larger than F, and an
elastic ring of the drum yields to F and to the forces of other shoes. For brakes with these loads,
or with a ring, the formula is not used.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake import clearance
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.friction import first_key_of_pressure_dependent_friction
from drumlin.brake.further_loads import first_key_of_loads_besides_actuation
from drumlin.brake.heat import is_any_shoe_heated
from drumlin.brake.support import rigid_body_motion_of_turn_about_point
from drumlin.fem.hp.division import SMALLEST_ELEMENT_SIZE_OVER_LINING_THICKNESS
from drumlin.laws.face import friction_surface_of_shoe
from drumlin.response.response import Response, ShoeResponse
from drumlin.response.resultants import planar_cross_product

SHORTEST_CONTACT_WITH_KNOWN_PRESSURE = 1000 * SMALLEST_ELEMENT_SIZE_OVER_LINING_THICKNESS
"""Length of a contact, in lining thicknesses, below which its pressure counts as unknown.

An error of 1e-4 needs elements at the ends of the contact whose size is a thousandth of the
contact's length, but round-off limits the size to about
SMALLEST_ELEMENT_SIZE_OVER_LINING_THICKNESS. For a shorter contact the response states the error 1
for the pressure.
"""
MARGIN_OF_FORMULA_FOR_SHORT_CONTACTS = 3.0
"""Factor by which the formula may be wrong without a contact being taken as too short that is not.

A contact counts as too short by the formula if its length is below
SHORTEST_CONTACT_WITH_KNOWN_PRESSURE divided by this factor. Of 620 random brakes with contacts near
this length the formula tells 74, and none of these had a known pressure without the formula. Where
elements resolve the contact (25 of them), the formula gives 0.80 to 1.14 times its length, and once
9 times, which is the safe side. The bodies are 6 to 30 mm thick, with moduli from 3 GPa.
"""
GAP_RISE_AT_CONTACT_END_INSIDE_LINING = 1.0
"""Rise of the gap up to an end of a contact inside the lining, relative to F/E' (1/k).

It is the value of a wedge. A parabola has 2/pi, so that the length of its contact is stated 1.25
times too large.
"""
GAP_RISE_AT_CONTACT_END_FROM_CORNER = 3.6
"""Rise of the gap up to the end of a contact at the lining's corner, relative to F/E' (1/k).

A corner yields more than a half-plane. The value is the one of the finite elements on corners of 90
degrees with gaps of four slopes, friction 0.3 and contacts of 2 nm to 20 um, of which they take
3.5 to 3.6.
"""
STEEPEST_GAP_AT_SHORT_CONTACT = 1.0
"""Slope of the gap up to which a contact is sought before the first pass, in metres per metre.

The gap of a rigid shoe rises by less than a tenth of its length. The value bounds the force from
above and spares all other brakes the search; it changes the time alone.
"""
ROUND_OFF_OF_GAP = 4 * float(np.finfo(float).eps)
"""Round-off in a gap, relative to the size of the brake. Gaps below it count as contact."""
ROUND_OFF_OF_ANGLE = 1e-12
"""Largest difference [rad] of two equal angles by round-off."""
MOST_PRESSED_NODES_OF_SHORT_CONTACT = 2
"""Number of neighbouring pressed nodes up to which elements count as too wide for a contact."""
NUMBER_OF_SAMPLED_GAPS = 1000
"""Number of places at which the search for the first touching place samples the gap."""
ZOOMS_TO_TOUCHING_PLACE = 5
"""Number of times that the search samples the gap again between the neighbours of the best place.

Each time the distance of the places falls to a five-hundredth, in all to that of round-off.
"""


class TooShortContact(NamedTuple):
    """A contact that is too short for elements: the place of its force, and its ends.

    All values are coordinates phi [rad]. The place is where the rigid shoe touches first.
    """

    place: float
    start: float
    end: float


def contact_too_short_by_formula(
    brake: Brake, shoe: Shoe, answer: ShoeResponse
) -> TooShortContact | None:
    """The contact of a shoe, if the half-plane formula says that its pressure cannot be known.

    The result is None if the formula does not apply, or if the contact is not shorter than
    SHORTEST_CONTACT_WITH_KNOWN_PRESSURE divided by MARGIN_OF_FORMULA_FOR_SHORT_CONTACTS. The
    formula applies to shoes on hinges under the known forces of their actuation alone, on a rigid
    drum or a plane, with constant friction and without heat, if the shoe has one lining and no mesh
    of a file, and presses at one place. The rigid shoe must touch first in the contact of the
    response, or within one length of it. On the mesh of a file no column ends at this place, and
    the torque would be off by more than its stated error.

    Parameters
    ----------
    brake, shoe : the brake and the shoe
    answer : response of the shoe on any division
    """
    if len(answer.contact_arcs) != 1 or len(shoe.arcs) > 1 or shoe.mesh is not None:
        return None
    if np.count_nonzero(answer.pressure > 0) > MOST_PRESSED_NODES_OF_SHORT_CONTACT:
        return None
    if not _are_shoes_hinged_on_rigid_surface_under_actuation_alone(brake):
        return None
    pressed = sorted(shoe.frame.phi_coordinates_as_list(answer.contact_arcs[0]))
    closing = _gap_closed_by_turn_about_hinge(brake, shoe)
    sense = math.copysign(1.0, closing(np.array([0.5 * (pressed[0] + pressed[1])]))[0])
    gap = _gap_of_first_touching_rigid_shoe(brake, shoe, sense)
    if not 2 * pressed[0] - pressed[1] < gap.place < 2 * pressed[1] - pressed[0]:
        return None
    return _contact_if_too_short(brake, shoe, gap, answer.normal_force)


def contacts_too_short_by_formula(
    brake: Brake, response: Response
) -> tuple[TooShortContact | None, ...]:
    """For each shoe of a response its contact that is too short, or None.

    See `contact_too_short_by_formula`.
    """
    return tuple(
        contact_too_short_by_formula(brake, shoe, answer)
        for shoe, answer in zip(brake.shoes, response.shoes, strict=True)
    )


def too_short_contacts_expected_of_rigid_shoes(brake: Brake) -> tuple[TooShortContact | None, ...]:
    """For each shoe the contact that is too short if the shoe is rigid, or None.

    The contacts are known before the first pass of a solve. They are sought where
    `contact_too_short_by_formula` applies, and under forces that are small enough.
    """
    if not _are_shoes_hinged_on_rigid_surface_under_actuation_alone(brake):
        return (None,) * len(brake.shoes)
    return tuple(_too_short_contact_expected_of_rigid_shoe(brake, shoe) for shoe in brake.shoes)


def _too_short_contact_expected_of_rigid_shoe(brake: Brake, shoe: Shoe) -> TooShortContact | None:
    """The contact of a hinged shoe that is too short if the shoe is rigid, or None."""
    # A lining without material is rigid, which the finite elements refuse by themselves.
    if len(shoe.arcs) > 1 or shoe.mesh is not None or shoe.lining.material is None:
        return None
    moment = shoe.moment_of_all_loads_about_point(shoe.pin)
    # No lever of the contact force about the pin is longer than the diameter of the drum.
    approach = _approach_of_lining_under_force(shoe, abs(moment) / (2 * brake.size))
    if moment == 0 or approach > STEEPEST_GAP_AT_SHORT_CONTACT * _length_of_too_short_contact(shoe):
        return None
    gap = _gap_of_first_touching_rigid_shoe(brake, shoe, math.copysign(1.0, moment))
    theta = shoe.frame.surface_coordinates_of_phi(np.array([gap.place]))[0]
    lever = _moment_about_pin_of_unit_contact_force(brake, shoe, theta)
    return _contact_if_too_short(brake, shoe, gap, abs(moment / lever)) if lever else None


def _contact_if_too_short(
    brake: Brake, shoe: Shoe, gap: "_GapOfRigidShoe", normal_force: float
) -> TooShortContact | None:
    """The contact by the formula under a normal force [N], or None if it is not too short."""
    contact = _contact_around_touching_place(
        gap, shoe.arc, _approach_of_lining_under_force(shoe, normal_force), brake.size
    )
    length = (contact.end - contact.start) * brake.size
    return contact if length < _length_of_too_short_contact(shoe) else None


def _length_of_too_short_contact(shoe: Shoe) -> float:
    """Length [m] below which a contact of a shoe counts as too short by the formula."""
    longest = SHORTEST_CONTACT_WITH_KNOWN_PRESSURE / MARGIN_OF_FORMULA_FOR_SHORT_CONTACTS
    return longest * shoe.lining.thickness


def _approach_of_lining_under_force(shoe: Shoe, normal_force: float) -> float:
    """The normal force [N] per width of the lining, divided by its modulus as a half-plane [m]."""
    modulus = shoe.lining.material.young_modulus_of_equivalent_half_plane
    return normal_force / (shoe.lining.width * modulus)


def _are_shoes_hinged_on_rigid_surface_under_actuation_alone(brake: Brake) -> bool:
    """Whether the shoes turn about hinges against a rigid surface, under their actuation alone.

    Heat and friction that depends on the pressure must be absent, too.
    """
    return (
        brake.reason_why_not_all_shoes_are_hinged() is None
        and brake.ring is None
        and first_key_of_loads_besides_actuation(brake) is None
        and first_key_of_pressure_dependent_friction(brake) is None
        and not is_any_shoe_heated(brake)
    )


def response_with_ends_of_too_short_contacts(
    brake: Brake, response: Response, contacts: Sequence[TooShortContact | None]
) -> Response:
    """The response, in which contacts that are too short for the elements end as the formula says.

    `contacts` are those of `contacts_too_short_by_formula`.
    """
    shoes = list(response.shoes)
    for i, (shoe, contact) in enumerate(zip(brake.shoes, contacts, strict=True)):
        if contact is not None:
            ends = np.array([contact.start, contact.end])
            first, last = sorted(shoe.frame.surface_coordinates_of_phi(ends).tolist())
            shoes[i] = replace(shoes[i], contact_arcs=((first, last),))
    return replace(response, shoes=tuple(shoes))


def force_error_due_to_place_in_too_short_contact(
    brake: Brake, shoe: Shoe, answer: ShoeResponse
) -> float:
    """The relative error of a shoe's force because its place within a short contact is not known.

    The force of a hinged shoe is inversely proportional to its moment about the pin per unit of
    force. The error is the difference of this moment between both ends of the contact. It is 0 if
    `contact_too_short_by_formula` does not apply: the place then differs from level to level, and
    the error is part of their difference.
    """
    if contact_too_short_by_formula(brake, shoe, answer) is None:
        return 0.0
    ends = answer.contact_arcs[0][0], answer.contact_arcs[-1][1]
    moments = [_moment_about_pin_of_unit_contact_force(brake, shoe, theta) for theta in ends]
    return abs(moments[1] - moments[0]) / min(map(abs, moments))


def _moment_about_pin_of_unit_contact_force(brake: Brake, shoe: Shoe, theta: float) -> float:
    """Moment [m] about the pin of a unit normal force at theta, with the friction that it causes.

    `theta` is the coordinate along the surface [rad, on a plane m].
    """
    surface = friction_surface_of_shoe(brake, shoe)
    drag = brake.signed_friction_stress_over_pressure(shoe)
    unit = surface.force(surface.shape_function_values(np.array(theta)), drag)
    return unit.moment - float(planar_cross_product(shoe.pin.xy, unit.force))


class _GapOfRigidShoe(NamedTuple):
    """The gap of a rigid shoe that touches its drum at one place.

    Attributes
    ----------
    place : coordinate phi [rad] at which the shoe touches
    at : function that computes the gaps [m] at coordinates phi [rad]
    """

    place: float
    at: Callable[[Floats], Floats]


def _gap_closed_by_turn_about_hinge(brake: Brake, shoe: Shoe) -> Callable[[Floats], Floats]:
    """The function that gives the closing of the gap [m] at phi [rad] by a counter-clockwise turn.

    The shoe turns by 1 rad about its hinge, at small angles.
    """
    surface = friction_surface_of_shoe(brake, shoe)
    turn = rigid_body_motion_of_turn_about_point(shoe.pin)
    (factors,) = surface.gap_closing_factors_of_rigid_body_motions(turn[None])

    def closing(phi: Floats) -> Floats:
        """The closing of the gap [m] at phi [rad], of the same shape."""
        theta = shoe.frame.surface_coordinates_of_phi(phi)
        return np.asarray(factors @ surface.shape_function_values(theta)[:2])

    return closing


def _gap_of_first_touching_rigid_shoe(brake: Brake, shoe: Shoe, sense: float) -> _GapOfRigidShoe:
    """The gap of a hinged rigid shoe that has turned until it touches the drum.

    The shoe turns counter-clockwise if `sense` is 1, and clockwise if it is -1.
    """
    closing = _gap_closed_by_turn_about_hinge(brake, shoe)

    def unloaded(phi: Floats) -> Floats:
        theta = shoe.frame.surface_coordinates_of_phi(phi)
        return clearance.gaps_between_unloaded_lining_and_surface(brake, shoe, theta)

    start, end = shoe.arc
    kinks = shoe.frame.phi_coordinates_as_list(
        clearance.coordinates_of_clearance_table_rows(shoe.lining)
    )
    inside = [kink for kink in kinks if start < kink < end]
    places = np.union1d(np.linspace(start, end, NUMBER_OF_SAMPLED_GAPS), inside)
    # The shoe first touches where the turn that closes the gap is smallest.
    for _ in range(ZOOMS_TO_TOUCHING_PLACE):
        closed = sense * closing(places)
        turns = np.full(len(places), np.inf)
        np.divide(unloaded(places), closed, out=turns, where=closed > 0)
        first = int(np.argmin(turns))
        needed, place = float(turns[first]), float(places[first])
        before, behind = places[max(first - 1, 0)], places[min(first + 1, len(places) - 1)]
        places = np.union1d(np.linspace(before, behind, NUMBER_OF_SAMPLED_GAPS), place)
    return _GapOfRigidShoe(place, lambda phi: unloaded(phi) - needed * sense * closing(phi))


def _contact_around_touching_place(
    gap: _GapOfRigidShoe, arc: tuple[float, float], approach: float, size: float
) -> TooShortContact:
    """The contact of a shoe that touches at one place, by the half-plane formula.

    Parameters
    ----------
    gap : gap of the rigid shoe
    arc : begin and end phi [rad] of the lining
    approach : force per width on the shoe, divided by the modulus of the half-plane [m]
    size : size of the brake, such as the radius of its drum [m]
    """
    at_corner = min(abs(gap.place - corner) for corner in arc) < ROUND_OFF_OF_ANGLE
    rise = (
        GAP_RISE_AT_CONTACT_END_FROM_CORNER if at_corner else GAP_RISE_AT_CONTACT_END_INSIDE_LINING
    )
    height = rise * approach + ROUND_OFF_OF_GAP * size
    ends = []
    for side, corner in zip((-1.0, 1.0), arc, strict=True):
        room = abs(corner - gap.place)
        # The places grow geometrically away from the touching place.
        distances = np.geomspace(1e-13, max(room, 1e-12), NUMBER_OF_SAMPLED_GAPS)
        open_places = distances[gap.at(gap.place + side * distances) > height]
        ends.append(gap.place + side * min(float(min(open_places, default=room)), room))
    return TooShortContact(gap.place, *ends)
