"""The singular points of a lining's pressure, found in the response of an earlier level.

At a singular point the pressure p(theta) is not smooth. Singular points are the ends of the
contact, the kinks of the gap, and the steps between blocks of the lining. If a table gives the
friction coefficient as a function of pressure, the places where the pressure has the value of a row
are singular points too. The next division of the lining has small elements at all these points.

A node without contact between two nodes in contact shows an opening, a stretch without contact,
which the elements are too wide to resolve. The ends of the opening may lie anywhere between the two
neighbouring nodes, and the error that they cause does not fall until the elements there are
smaller. The open node is therefore a singular point, too. An opening that is far shorter than its
contact is ignored: where p is nearly 0, round-off opens single nodes, and with small elements at
these nodes it would open more nodes.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake import clearance
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.components import Lining
from drumlin.brake.friction import FrictionOverPressureCurve
from drumlin.fem.error_control.short_contact import (
    SHORTEST_CONTACT_WITH_KNOWN_PRESSURE,
    TooShortContact,
    contacts_too_short_by_formula,
)
from drumlin.fem.hp.corner import logarithmic_pressures_at_pointed_gap_kinks
from drumlin.fem.hp.division import (
    UNRESOLVED_LENGTH_OVER_CONTACT_LENGTH,
    KindOfSingularPoint,
    SingularPoint,
)
from drumlin.fem.preparation.cache import indices_of_first_shoes_of_equal_shape as equal_shapes
from drumlin.response.response import Response, ShoeResponse
from drumlin.response.resultants import (
    contact_arcs_from_nodal_pressures,
    polynomial_values_at_gauss_points,
)

NEGLIGIBLE_PRESSURE_ERROR_DUE_TO_GAP_KINKS = 0.1
"""Error of the pressure p that all neglected kinks of a gap together may cause.

It is the error in the L2 norm, divided by the error of p for which the level is planned (called e
in `RuleOfDegreeAndGradingByLevel`). The weakest kinks are neglected first. The actual error of p on
a level is about a tenth of the planned one, so that the neglected kinks cause less error than the
elements. The gap of a worn lining, for example, is a table of many rows, between which it varies
linearly. It is treated as a smooth curve until a level is fine enough to resolve the straight
lines. If every kink were a singular point, such a table would take hundreds of hp elements. If no
kink were a singular point, a table with a real kink would miss the tolerance on all levels.
"""
BINARY_DIGITS_OF_ROUNDED_CONTACT_END = 20
"""Number of binary digits to which the position of an end of the contact is rounded.

The digits count relative to the length of the contact: twenty binary digits are a millionth of it.
With 36 digits all stored reference values are the same. With 10 digits the error of p rises from
1e-4 to as much as 6e-4, because the elements then end beside the end of the contact.
"""
SHORTEST_PATH_OF_CONTACT_END = 0.15
"""Shortest path of a moving contact end that gets element columns of equal width.

The path is the distance by which the end moves across the width, relative to the length of the
contact. Shorter paths are bounded by small columns at both of their ends, which leave no wide
columns between them. With a smaller value brakes with long contacts get more columns, which they
do not need; with a larger value wide columns remain where the contact ends.
"""


class _OpeningInsideContact(NamedTuple):
    """A stretch without contact within a contact: an open node between two pressed nodes.

    Attributes
    ----------
    phi : coordinate phi of the open node [rad]
    width : distance of the two pressed nodes [rad]
    """

    phi: float
    width: float


def singular_points_of_each_shoe_shape(
    brake: Brake,
    response: Response | None,
    alike: Sequence[int] = (),
    error: float = 0.0,
    *,
    too_short: Sequence[TooShortContact | None] | None = None,
) -> dict[int, list[SingularPoint]]:
    """The singular points of the pressure on all linings, collected for each shape of shoe.

    The key of a shape is the index of its first shoe. Shoes of one shape share a division. The
    points of all shoes of a shape are therefore collected in one list, in the order of their
    position.

    Parameters
    ----------
    brake : the brake
    response : an earlier response, or None. Without a response the kinks of a table of clearances
        are missing in the result, because their strength depends on the pressure.
    alike : for each shoe the index of the first shoe of the same shape, see
        `cache.indices_of_first_shoes_of_equal_shape`; if it is empty, this function finds the
        indices
    error : planned relative error of p on the next level (e in `RuleOfDegreeAndGradingByLevel`);
        with 0 every kink of a table near the contact is a singular point
    too_short : for each shoe its contact that is too short for elements, or None; by default it
        follows from the response by `contacts_too_short_by_formula`
    """
    if too_short is None and response is not None:
        too_short = contacts_too_short_by_formula(brake, response)
    points: dict[int, list[SingularPoint]] = {}
    first_alike = alike or equal_shapes(brake)
    for i, (shoe, first) in enumerate(zip(brake.shoes, first_alike, strict=True)):
        answer = None if response is None else response.shoes[i]
        contact = None if too_short is None else too_short[i]
        points_of_shoe = _singular_points_of_lining(brake, shoe, answer, error, contact)
        curve = brake.friction_coefficient_curve_of_shoe(shoe)
        if answer is not None and answer.contact_arcs and len(curve.mu) > 1:
            points_of_shoe += _singular_points_at_kinks_of_friction(
                shoe, answer, curve, brake.length_per_surface_coordinate, error
            )
        points.setdefault(first, []).extend(points_of_shoe)
    return {first: sorted(points_of_shape) for first, points_of_shape in points.items()}


def _singular_points_of_lining(
    brake: Brake,
    shoe: Shoe,
    answer: ShoeResponse | None,
    level_error: float,
    too_short: TooShortContact | None,
) -> list[SingularPoint]:
    """The singular points of the pressure on the lining of one shoe, in any order.

    Parameters
    ----------
    brake, shoe : the brake and the shoe
    answer : the earlier response of the shoe, or None
    level_error : planned error of p on the next level
    too_short : the contact of the shoe if it is too short for elements, else None
    """
    arcs = [] if answer is None else contact_arcs_merged_over_narrow_gaps(shoe, answer)
    points = _singular_points_at_steps_of_lining(shoe, answer, arcs)
    if too_short is not None:
        return points + _singular_points_at_too_short_contact(brake, shoe, too_short)
    if answer is None:
        return points
    points += _singular_points_at_kinks_of_gap(
        shoe, answer, arcs, brake.length_per_surface_coordinate, level_error
    )
    # The ends of each contact arc are singular points. In a shoe with a width an end may move
    # across the width. If all ends hardly move, the ends in the mid-plane are singular points, too.
    for arc_start, arc_end in arcs:
        inner = _smallest_extent_of_contact_across_width(shoe, answer, (arc_start, arc_end))
        points += _singular_points_at_ends_of_contact(shoe, (arc_start, arc_end), inner)
    if not any(point.path for point in points):
        for arc in _contact_arcs_in_mid_plane(shoe, answer):
            points += _singular_points_at_ends_of_contact(shoe, arc, arc)
    for opening in _openings_within_contact_arcs_of_lining(shoe, answer, arcs):
        at = _rounded_angle_of_contact_end(opening.phi, opening.width)
        points.append(SingularPoint(at, opening.width, KindOfSingularPoint.END))
    return points


def _singular_points_at_too_short_contact(
    brake: Brake, shoe: Shoe, contact: TooShortContact
) -> list[SingularPoint]:
    """The singular points at a contact that is too short for elements: the place of its force.

    Torque and forces need this place, at which columns end, but no pressure. The columns there are
    as wide as at a kink of the gap. At a corner of the lining the list is empty, because columns
    end there on every division.
    """
    column = SHORTEST_CONTACT_WITH_KNOWN_PRESSURE * shoe.lining.thickness / brake.size
    if min(abs(contact.place - corner) for corner in shoe.arc) < column:
        return []
    start, end = shoe.arc
    return [SingularPoint(contact.place, end - start, KindOfSingularPoint.KINK)]


def _singular_points_at_ends_of_contact(
    shoe: Shoe, arc: Sequence[float], inner: Sequence[float]
) -> list[SingularPoint]:
    """The singular points at both ends of a contact arc of a shoe.

    An end that moves across the width by more than SHORTEST_PATH_OF_CONTACT_END has a point at each
    end of its path. The angles of points are rounded, and moved into the lining if rounding has put
    them outside.

    Parameters
    ----------
    shoe : the shoe
    arc : start and end phi [rad] of the contact
    inner : the angles [rad] between which the contact lies at every distance from the mid-plane
    """
    start, end = _ends_of_lining_with_contact(shoe, arc[0], arc[1])
    first, last, inner_first, inner_last = (
        min(max(_rounded_angle_of_contact_end(phi, arc[1] - arc[0]), start), end)
        for phi in (*arc, *inner)
    )
    length, points = last - first, []
    for outer, other in ((first, inner_first), (last, inner_last)):
        path = other - outer
        if abs(path) <= SHORTEST_PATH_OF_CONTACT_END * length:
            points.append(SingularPoint(outer, length, KindOfSingularPoint.END))
            continue
        points.append(SingularPoint(outer, length, KindOfSingularPoint.END, path))
        points.append(SingularPoint(other, length, KindOfSingularPoint.END, -path))
    return points


def _smallest_extent_of_contact_across_width(
    shoe: Shoe, answer: ShoeResponse, arc: Sequence[float]
) -> tuple[float, float]:
    """The angles [rad] between which the shoe presses at every distance from the mid-plane.

    The result is `arc` for a response without pressures over the width. If the lining lifts off
    over the whole arc at some distance from the mid-plane, both angles are the arc's middle.

    Parameters
    ----------
    shoe : the shoe
    answer : the response of the shoe
    arc : start and end phi [rad] of the contact of the pressure averaged over the width
    """
    if answer.surface is None:
        return arc[0], arc[1]
    z, pressures, _ = answer.surface
    middle = 0.5 * (arc[0] + arc[1])
    first, last = arc[0], arc[1]
    for pressure in pressures[:, len(z) // 2 :].T:
        arcs = contact_arcs_from_nodal_pressures(answer.theta, pressure, answer.order)
        own = [sorted(shoe.frame.phi_coordinates_as_list(each)) for each in arcs]
        own = [each for each in own if each[0] < arc[1] and each[1] > arc[0]]
        first = max(first, min((each[0] for each in own), default=middle))
        last = min(last, max((each[1] for each in own), default=middle))
    return (first, last) if first < last else (middle, middle)


def _contact_arcs_in_mid_plane(shoe: Shoe, answer: ShoeResponse) -> list[list[float]]:
    """The start and end phi [rad] of each contact in the mid-plane of a shoe with a width.

    Where a lining overhangs its web, the contact beside the web may reach farther along the arc
    than the contact under the web, with far smaller pressures. The list is empty for a response
    without pressures over the width.
    """
    if answer.surface is None:
        return []
    middle = answer.surface.pressure[:, len(answer.surface.z) // 2]
    arcs = contact_arcs_from_nodal_pressures(answer.theta, middle, answer.order)
    return contact_arcs_merged_over_narrow_gaps(shoe, replace(answer, contact_arcs=arcs))


def _ends_of_lining_with_contact(shoe: Shoe, first: float, last: float) -> tuple[float, float]:
    """The ends (phi_1, phi_2) [rad] of the lining that has the contact from `first` to `last`."""
    middle = 0.5 * (first + last)
    return min(shoe.arcs, key=lambda arc: max(arc[0] - middle, middle - arc[1]))


def _is_angle_near_contact(phi: float, arcs: list[list[float]]) -> bool:
    """Whether the angle phi [rad] lies in a contact, or within one contact length of it.

    `arcs` are the start and the end [rad] of each contact.
    """
    return any(2 * start - end < phi < 2 * end - start for start, end in arcs)


def _singular_points_at_steps_of_lining(
    shoe: Shoe, answer: ShoeResponse | None, arcs: list[list[float]]
) -> list[SingularPoint]:
    """The singular points at the steps of the gap between the blocks of a lining.

    The gap changes over a short length, the step, with a singular point at each end. A step far
    from every contact does not influence the pressure, but an element must end there nevertheless
    (kind OPEN_STEP): a polynomial for the gap across the step would oscillate.
    """
    start, end = shoe.arc
    length = shoe.lining.length_of_step_between_blocks / shoe.frame.surface_coordinate_per_phi
    points: list[SingularPoint] = []
    for phi in shoe.frame.phi_coordinates_as_list(
        clearance.coordinates_of_step_ends_between_blocks(shoe.lining)
    ):
        if start < phi < end:
            presses = answer is None or _is_angle_near_contact(phi, arcs)
            kind = KindOfSingularPoint.STEP if presses else KindOfSingularPoint.OPEN_STEP
            points.append(SingularPoint(phi, length, kind))
    return points


def _singular_points_at_kinks_of_gap(
    shoe: Shoe,
    answer: ShoeResponse,
    arcs: list[list[float]],
    length_per_surface_coordinate: float,
    level_error: float,
) -> list[SingularPoint]:
    """The singular points at the kinks of a lining's table of clearances.

    A kink is a row of the table, where the slope of the gap changes. Kinks that point to the drum
    are added once more, with the kind TIP. The weakest kinks are neglected, see
    NEGLIGIBLE_PRESSURE_ERROR_DUE_TO_GAP_KINKS.

    Parameters
    ----------
    shoe, answer : the shoe and its earlier response
    length_per_surface_coordinate : length per unit of the surface's coordinate [m/rad; 1 on a
        plane]
    level_error : planned error of p on the next level
    arcs : contacts of the lining [rad]
    """
    (start, end), frame = shoe.arc, shoe.frame
    angle = np.array(clearance.coordinates_of_clearance_table_rows(shoe.lining))
    # Most linings have no table.
    if not len(angle):
        return []
    change = pressure_change_norms_due_to_kinks_of_gap(shoe.lining, length_per_surface_coordinate)
    near = [
        start < phi < end and _is_angle_near_contact(phi, arcs)
        for phi in frame.phi_coordinates_as_list(angle)
    ]
    inside = np.array(near, dtype=bool)
    _, p, weight = polynomial_values_at_gauss_points(answer.theta, answer.pressure, answer.order)
    # `norm` is the L2 norm of p. The neglected kinks together may change p by at most `negligible`
    # in this norm.
    norm = math.sqrt(float(np.sum(weight * p**2)))
    negligible = NEGLIGIBLE_PRESSURE_ERROR_DUE_TO_GAP_KINKS * level_error * norm
    kinks = _angles_of_strongest_gap_or_friction_kinks(angle[inside], change[inside], negligible)
    points = [
        SingularPoint(phi, end - start, KindOfSingularPoint.KINK)
        for phi in frame.phi_coordinates_as_list(kinks)
    ]
    return points + _singular_points_at_pointed_gap_kinks(
        shoe, length_per_surface_coordinate, norm, kinks
    )


def _singular_points_at_kinks_of_friction(
    shoe: Shoe,
    answer: ShoeResponse,
    curve: FrictionOverPressureCurve,
    length_per_surface_coordinate: float,
    level_error: float,
) -> list[SingularPoint]:
    """The singular points where the pressure has the value of a row of a friction table.

    The table gives the friction coefficient mu(p). At such a place the slope of the friction stress
    mu(p) p along the lining changes by s. Between two such places at a distance h the stress
    deviates from a smooth curve by the parabola s x (1 - x/h)/2, whose root mean square is s
    h/sqrt(120). The weakest kinks are neglected, see NEGLIGIBLE_PRESSURE_ERROR_DUE_TO_GAP_KINKS.

    Parameters
    ----------
    shoe, answer : the shoe and its earlier response
    curve : friction coefficient of the shoe as a function of pressure
    length_per_surface_coordinate : length per unit of the surface's coordinate [m/rad; 1 on a
        plane]
    level_error : planned error of p on the next level
    """
    theta, p = answer.curve()
    kinks_of_curve = np.diff(curve.friction_slopes_between_table_rows).tolist()
    places, changes = [], []
    for row, pressure in zip(kinks_of_curve, curve.pressure.tolist(), strict=True):
        crossed = np.flatnonzero((p[:-1] < pressure) != (p[1:] < pressure))
        rise = p[crossed + 1] - p[crossed]
        step = theta[crossed + 1] - theta[crossed]
        places.append(theta[crossed] + (pressure - p[crossed]) / rise * step)
        changes.append(np.abs(row * pressure * rise / step))
    order = np.argsort(np.concatenate(places))
    angle, change = np.concatenate(places)[order], np.concatenate(changes)[order]
    ends = np.concatenate([theta[:1], 0.5 * (angle[1:] + angle[:-1]), theta[-1:]])
    spacing = np.diff(ends) if len(angle) else angle
    _, stress, weight = polynomial_values_at_gauss_points(
        answer.theta, answer.pressure, answer.order
    )
    norm = math.sqrt(float(np.sum(weight * stress**2)))
    kinks = _angles_of_strongest_gap_or_friction_kinks(
        angle,
        change * spacing**1.5 / math.sqrt(120),
        NEGLIGIBLE_PRESSURE_ERROR_DUE_TO_GAP_KINKS * level_error * norm,
    )
    # The elements at such a point get the sizes of elements at a step between blocks. The thickness
    # of the lining takes the place of the step's length.
    length = shoe.lining.thickness / length_per_surface_coordinate
    length /= shoe.frame.surface_coordinate_per_phi
    (start, end), points = shoe.arc, []
    for phi in shoe.frame.phi_coordinates_as_list(kinks):
        if start < phi < end:
            at = _rounded_angle_of_contact_end(phi, end - start)
            points.append(SingularPoint(at, length, KindOfSingularPoint.STEP))
    return points


def _singular_points_at_pointed_gap_kinks(
    shoe: Shoe, length_per_surface_coordinate: float, norm: float, kinks: Floats
) -> list[SingularPoint]:
    """The singular points at kinks of a lining's gap that point to the drum (kind TIP).

    Parameters
    ----------
    shoe : the shoe
    length_per_surface_coordinate : length per unit of the surface's coordinate [m/rad; 1 on a
        plane]
    norm : L2 norm of the pressure over the surface's coordinate [Pa rad^0.5; Pa m^0.5 on a plane]
    kinks : (k,) angles theta [rad] of the kinks that are singular points
    """
    points: list[SingularPoint] = []
    for tip in logarithmic_pressures_at_pointed_gap_kinks(shoe, length_per_surface_coordinate):
        if tip.theta in kinks:
            (phi,) = shoe.frame.phi_coordinates_as_list([tip.theta])
            length = (norm / tip.factor) ** 2 / shoe.frame.surface_coordinate_per_phi
            points.append(SingularPoint(phi, length, KindOfSingularPoint.TIP))
    return points


def pressure_change_norms_due_to_kinks_of_gap(
    lining: Lining, length_per_surface_coordinate: float
) -> Floats:
    """The change of p in L2 (k,) [Pa rad^0.5] by the kink at each row of a clearance table.

    Between the rows of the table the gap varies linearly, along chords. The change of p is the
    difference between these chords and a smooth curve through the rows. If the slope changes by s
    at each of two rows at a distance h, the chord deviates from a smooth curve by the parabola s x
    (1 - x/h)/2. The parabola is a series of cosines of the amplitudes s h/(2 pi^2 n^2). Under a
    cosine of the wave number k = 2 pi n/h, a half-plane of the modulus E has the pressure E k/2
    times the amplitude, and a layer of the thickness t << h has E/t times the amplitude. The root
    mean square of the change of p is thus E s/sqrt(48) on a half-plane, and E s h/(sqrt(720) t) on
    a layer. The sum of both is an upper bound for a layer on a support.
    """
    if len(lining.linings_with_touching_ones_joined) > 1:
        # For each lining, `coordinates_of_clearance_table_rows` gives the rows of the table that
        # lie on it.
        changes = []
        for part in lining.linings_with_touching_ones_joined:
            rows = np.array(clearance.coordinates_of_clearance_table_rows(part))
            on_part = (part.start < rows) & (rows < part.end)
            changes.append(
                pressure_change_norms_due_to_kinks_of_gap(part, length_per_surface_coordinate)[
                    on_part
                ]
            )
        return np.concatenate(changes)
    angle = np.array(clearance.coordinates_of_clearance_table_rows(lining))
    if len(angle) == 0:
        return angle
    middles = 0.5 * (angle[1:] + angle[:-1])
    ends = np.concatenate([[lining.start], middles, [lining.end]])
    spacing = np.maximum(np.diff(ends), 0.0)
    slope = (
        np.abs(clearance.clearance_slope_change_at_each_table_row(lining))
        / length_per_surface_coordinate
    )
    material = lining.material
    half_plane = (
        material.young_modulus_of_equivalent_half_plane / material.E_through / math.sqrt(48)
    )
    layer = length_per_surface_coordinate * spacing / (math.sqrt(720) * lining.thickness)
    stiffness = half_plane + layer
    return np.asarray(material.E_through * slope * stiffness * np.sqrt(spacing))


def _angles_of_strongest_gap_or_friction_kinks(
    angle: Floats, change: Floats, negligible: float
) -> Floats:
    """The sorted angles (m,) [rad] of kinks of gap or friction, without the weakest kinks.

    Parameters
    ----------
    angle : (k,) angles of all kinks [rad]
    change : (k,) change of p in L2 that each kink causes [Pa rad^0.5]
    negligible : largest allowed change of p in L2 by all neglected kinks together [Pa rad^0.5]
    """
    order = np.argsort(change, kind="stable")
    neglected = np.cumsum(change[order] ** 2) <= negligible**2
    return np.sort(angle[order[~neglected]])


def contact_arcs_merged_over_narrow_gaps(shoe: Shoe, response: ShoeResponse) -> list[list[float]]:
    """The contacts on the linings of a shoe by increasing angle: start and end phi [rad] of each.

    Two contacts count as one if the gap between them is far shorter than both contacts together,
    see `division.UNRESOLVED_LENGTH_OVER_CONTACT_LENGTH`. Contacts on different linings of a shoe
    never count as one.
    """
    arcs: list[list[float]] = []
    for start, end in sorted(
        sorted(shoe.frame.phi_coordinates_as_list(arc)) for arc in response.contact_arcs
    ):
        close = arcs and start - arcs[-1][1] < UNRESOLVED_LENGTH_OVER_CONTACT_LENGTH * (
            end - arcs[-1][0]
        )
        if close and not any(arcs[-1][0] < slot[0] < end for slot in shoe.slots):
            arcs[-1][1] = end
        else:
            arcs.append([start, end])
    return arcs


def reason_if_contact_is_too_short(brake: Brake, shoe: Shoe, answer: ShoeResponse) -> str | None:
    """The reason why the pressure of a shoe cannot be known, because its contact is too short.

    The result is None if no contact of the shoe is shorter than
    SHORTEST_CONTACT_WITH_KNOWN_PRESSURE.
    """
    arcs = contact_arcs_merged_over_narrow_gaps(shoe, answer)
    length = min((end - start for start, end in arcs), default=math.inf) * brake.size
    if length >= SHORTEST_CONTACT_WITH_KNOWN_PRESSURE * shoe.lining.thickness:
        return None
    return (
        f"shoe {shoe.name!r}: its contact is {1e6 * length:.1g} um long, too short to know its "
        "pressure"
    )


def reason_if_any_contact_is_too_short(brake: Brake, response: Response) -> str | None:
    """The reason why the pressure of any shoe of a brake cannot be known; None without a reason.

    See `reason_if_contact_is_too_short`.
    """
    for shoe, answer in zip(brake.shoes, response.shoes, strict=True):
        reason = reason_if_contact_is_too_short(brake, shoe, answer)
        if reason is not None:
            return reason
    return None


def _openings_within_contact_arcs_of_lining(
    shoe: Shoe, answer: ShoeResponse, arcs: list[list[float]]
) -> list[_OpeningInsideContact]:
    """The openings inside the contacts of a lining: open nodes between two pressed nodes.

    An open node at an end of a contact does not count. An opening that is far shorter than its
    contact does not count either: p then oscillates around 0 from node to node of narrow elements.
    """
    press = answer.pressure > 0
    open_nodes = 1 + np.flatnonzero(press[:-2] & ~press[1:-1] & press[2:])
    if not len(open_nodes):
        return []
    phi = shoe.frame.phi_of_surface_coordinates(answer.theta)
    openings = []
    for i in open_nodes:
        opening = _OpeningInsideContact(float(phi[i]), abs(float(phi[i + 1] - phi[i - 1])))
        if _is_opening_inside_contact(opening, arcs):
            openings.append(opening)
    return openings


def _is_opening_inside_contact(opening: _OpeningInsideContact, arcs: list[list[float]]) -> bool:
    """Whether an opening lies inside a contact, away from its ends, and is not too short to count.

    `arcs` are the start and the end phi [rad] of each contact. The shortest opening that counts is
    UNRESOLVED_LENGTH_OVER_CONTACT_LENGTH of its contact.
    """
    for start, end in arcs:
        away_from_ends = start + opening.width < opening.phi < end - opening.width
        if away_from_ends and opening.width > UNRESOLVED_LENGTH_OVER_CONTACT_LENGTH * (end - start):
            return True
    return False


def _rounded_angle_of_contact_end(phi: float, length: float) -> float:
    """The angle phi [rad] of an end of a contact, rounded to a millionth of the contact's length.

    Two computations that differ by round-off, for example with different numbers of threads, then
    lead to the same division. `length` [rad] is the length of the contact.
    """
    digits = BINARY_DIGITS_OF_ROUNDED_CONTACT_END - math.frexp(length)[1]
    return math.ldexp(round(math.ldexp(phi, digits)), -digits)
