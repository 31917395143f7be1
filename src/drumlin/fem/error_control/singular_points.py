"""The singular points of a lining's pressure, found in the response of an earlier level.

At a singular point the pressure p(theta) is not smooth: at an end of the contact, at a kink of the
gap, or at a step between blocks of the lining. The next division grades its columns to these
points.

An open node between two pressed nodes shows an opening that the hp elements there are too wide to
resolve. The ends of such an opening may lie anywhere between the neighbouring nodes. The error that
they cause does not fall until a level resolves the opening. Therefore the open node is a singular
point too. An opening that is far shorter than its contact is ignored: where p is nearly 0,
round-off opens single nodes, and singular points at these nodes would only open more of them.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake import clearance
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.components import Lining
from drumlin.fem.hp.corner import logarithmic_pressures_at_tips
from drumlin.fem.hp.division import UNRESOLVED_LENGTH, Singularity, SingularPoint
from drumlin.fem.preparation.cache import first_shoes_of_equal_shape as equal_shapes
from drumlin.response.response import Response, ShoeResponse
from drumlin.response.resultants import gauss_points

NEGLIGIBLE_KINKS = 0.1
"""Error of p in L2, relative to the error of the level (`Level.error`), below which the kinks of a
gap are neglected together.

The weakest kinks are neglected first. The error of p on a level is about a tenth of `Level.error`,
so the neglected kinks cause less than the level itself, on finer levels too. A table of many rows,
such as the gap of a worn lining, is thus treated as a curve until a level is fine enough to resolve
its chords. If every kink were a singular point, such a table would take hundreds of hp elements. If
no kink were a singular point, a table with a real kink would miss the tolerance on all levels.
"""
CONTACT_END_BITS = 20
"""Number of binary digits of an end of the contact, relative to the length of the contact.

Twenty binary digits are a millionth of the length. With 36 digits all answers of the stored
reference values are the same. With 10 digits p is up to six times less exact at an error of 1e-4,
because columns then end beside the contact.
"""


class _Opening(NamedTuple):
    """An open node between two pressed nodes.

    Attributes
    ----------
    at : coordinate phi of the open node [rad]
    width : distance of the two pressed nodes [rad]
    """

    at: float
    width: float


def singular_points_of(
    brake: Brake, response: Response | None, alike: Sequence[int] = (), error: float = 0.0
) -> dict[int, list[SingularPoint]]:
    """The singular points of all linings, by the index of the first shoe of each shape.

    The points of each shape grow with their position. Shoes of one shape share a division, so the
    points of all shoes of a shape are collected in one list.

    Parameters
    ----------
    brake : the brake
    response : an earlier response, or None. Without a response the kinks of a table of clearances
        are not singular yet, because their strength depends on the pressure.
    alike : for each shoe the index of the first shoe of the same shape, see
        `cache.first_shoes_of_equal_shape`; found here if it is empty
    error : error of p that the next level leaves, see `Level.error`; with 0 every kink of a table
        is singular where the lining presses
    """
    points: dict[int, list[SingularPoint]] = {}
    first_alike = alike or equal_shapes(brake)
    for i, (shoe, first) in enumerate(zip(brake.shoes, first_alike, strict=True)):
        answer = None if response is None else response.shoes[i]
        points_of_shoe = _singular_points_of_lining(shoe, answer, brake.scale_factor, error)
        points.setdefault(first, []).extend(points_of_shoe)
    return {first: sorted(points_of_shape) for first, points_of_shape in points.items()}


def _singular_points_of_lining(
    shoe: Shoe, answer: ShoeResponse | None, scale_factor: float, level_error: float
) -> list[SingularPoint]:
    """The singular points of one lining, in no order.

    Parameters
    ----------
    shoe : the shoe
    answer : its earlier response, or None
    scale_factor : length [m] of the surface's coordinate 1, see `Brake.scale_factor`
    level_error : error of p that the next level leaves
    """
    arcs = [] if answer is None else contact_arcs_without_narrow_gaps(shoe, answer)
    points = _points_at_steps(shoe, answer, arcs)
    if answer is None:
        return points
    points += _points_at_kinks(shoe, answer, arcs, scale_factor, level_error)
    start, end = shoe.arc
    for arc_start, arc_end in arcs:
        length = arc_end - arc_start
        first = min(max(_round_contact_end(arc_start, length), start), end)
        last = min(max(_round_contact_end(arc_end, length), start), end)
        points.append(SingularPoint(first, last - first, Singularity.END))
        points.append(SingularPoint(last, last - first, Singularity.END))
    for opening in _openings_within_contacts(shoe, answer, arcs):
        at = _round_contact_end(opening.at, opening.width)
        points.append(SingularPoint(at, opening.width, Singularity.END))
    return points


def _is_near_contact(phi: float, arcs: list[list[float]]) -> bool:
    """Whether phi [rad] lies within a contact, or beside it by less than its length."""
    return any(2 * start - end < phi < 2 * end - start for start, end in arcs)


def _points_at_steps(
    shoe: Shoe, answer: ShoeResponse | None, arcs: list[list[float]]
) -> list[SingularPoint]:
    """The singular points at the ends of the steps between the blocks of a lining.

    Where the lining does not press near a step, the pressure is smooth there. The step still is a
    point of the kind OPEN_STEP, because the gap's polynomial in an hp element would oscillate over
    the step.
    """
    start, end = shoe.arc
    length = shoe.lining.step / shoe.frame.unit
    points: list[SingularPoint] = []
    for phi in shoe.frame.phis(clearance.step_kinks(shoe.lining)):
        if start < phi < end:
            presses = answer is None or _is_near_contact(phi, arcs)
            kind = Singularity.STEP if presses else Singularity.OPEN_STEP
            points.append(SingularPoint(phi, length, kind))
    return points


def _points_at_kinks(
    shoe: Shoe,
    answer: ShoeResponse,
    arcs: list[list[float]],
    scale_factor: float,
    level_error: float,
) -> list[SingularPoint]:
    """The singular points at the kinks of a table of clearances, and at the tips among them.

    The weakest kinks near the contact are left out, see NEGLIGIBLE_KINKS.

    Parameters
    ----------
    shoe, answer, scale_factor, level_error : as of `_singular_points_of_lining`
    arcs : contacts of the lining [rad]
    """
    (start, end), frame = shoe.arc, shoe.frame
    angle = np.array(clearance.table_kinks(shoe.lining))
    change = pressure_changes_by_kinks(shoe.lining, scale_factor)
    near = [start < phi < end and _is_near_contact(phi, arcs) for phi in frame.phis(angle)]
    inside = np.array(near, dtype=bool)
    _, p, weight = gauss_points(answer.theta, answer.pressure, answer.order)
    norm = math.sqrt(float(np.sum(weight * p**2)))
    negligible = NEGLIGIBLE_KINKS * level_error * norm
    kinks = _kinks_that_matter(angle[inside], change[inside], negligible)
    points = [SingularPoint(phi, end - start, Singularity.KINK) for phi in frame.phis(kinks)]
    return points + _points_at_tips(shoe, scale_factor, norm, kinks)


def _points_at_tips(
    shoe: Shoe, scale_factor: float, norm: float, kinks: Floats
) -> list[SingularPoint]:
    """The singular points at the tips of the gap: those kinks that point to the drum.

    Parameters
    ----------
    shoe : the shoe
    scale_factor : length [m] of the surface's coordinate 1
    norm : norm of the pressure in L2 [Pa rad^0.5]; on a plane [Pa m^0.5]
    kinks : (k,) angles theta [rad] of the kinks that are singular points
    """
    points: list[SingularPoint] = []
    for tip in logarithmic_pressures_at_tips(shoe, scale_factor):
        if tip.theta in kinks:
            (phi,) = shoe.frame.phis([tip.theta])
            length = (norm / tip.factor) ** 2 / shoe.frame.unit
            points.append(SingularPoint(phi, length, Singularity.TIP))
    return points


def pressure_changes_by_kinks(lining: Lining, scale_factor: float) -> Floats:
    """The change of p in L2 (k,) [Pa rad^0.5] that each row of a table of clearances causes.

    The change is measured against a smooth curve in place of the table's chords. Where the slope
    changes by s at rows at a distance h, the chords stray from a smooth curve by the parabola
    s x (1 - x/h)/2, a series of cosines of the amplitudes s h/(2 pi^2 n^2). A half-plane of the
    modulus E answers a cosine of the wave number k = 2 pi n/h with the pressure E k/2 times its
    amplitude. A layer of the thickness t << h answers with E/t times it. In the root mean square p
    is thus off by E s/sqrt(48) and E s h/(sqrt(720) t). A layer on its support is at most as stiff
    as both together.
    """
    angle = np.array(clearance.table_kinks(lining))
    if len(angle) == 0:
        return angle
    middles = 0.5 * (angle[1:] + angle[:-1])
    ends = np.concatenate([[lining.start], middles, [lining.end]])
    spacing = np.maximum(np.diff(ends), 0.0)
    slope = np.abs(clearance.slope_changes(lining)) / scale_factor
    material = lining.material
    half_plane = material.E_half_plane / material.E_through / math.sqrt(48)
    layer = scale_factor * spacing / (math.sqrt(720) * lining.thickness)
    stiffness = half_plane + layer
    return np.asarray(material.E_through * slope * stiffness * np.sqrt(spacing))


def _kinks_that_matter(angle: Floats, change: Floats, negligible: float) -> Floats:
    """The growing angles (m,) of the kinks without the weakest ones.

    Parameters
    ----------
    angle : (k,) angles of all kinks [rad]
    change : (k,) change of p in L2 that each kink causes [Pa rad^0.5]
    negligible : limit of the root sum of squares of the changes by the kinks that are left out
        [Pa rad^0.5]
    """
    order = np.argsort(change, kind="stable")
    neglected = np.cumsum(change[order] ** 2) <= negligible**2
    return np.sort(angle[order[~neglected]])


def contact_arcs_without_narrow_gaps(shoe: Shoe, response: ShoeResponse) -> list[list[float]]:
    """The contacts of a lining in growing order, each as its start and its end phi [rad].

    Two contacts count as one if the gap between them is far shorter than they are together, see
    `division.UNRESOLVED_LENGTH`.
    """
    arcs: list[list[float]] = []
    for start, end in sorted(sorted(shoe.frame.phis(arc)) for arc in response.contact_arcs):
        if arcs and start - arcs[-1][1] < UNRESOLVED_LENGTH * (end - arcs[-1][0]):
            arcs[-1][1] = end
        else:
            arcs.append([start, end])
    return arcs


def _openings_within_contacts(
    shoe: Shoe, answer: ShoeResponse, arcs: list[list[float]]
) -> list[_Opening]:
    """The open nodes between two pressed nodes, without those that are no opening of their own.

    An open node at an end of a contact belongs to the end. An opening that is far shorter than its
    contact is left out: where hp elements are so narrow, p oscillates around 0 from node to node.
    """
    press = answer.pressure > 0
    open_nodes = 1 + np.flatnonzero(press[:-2] & ~press[1:-1] & press[2:])
    if not len(open_nodes):
        return []
    phi = shoe.frame.phi(answer.theta)
    candidates = [_Opening(float(phi[i]), abs(float(phi[i + 1] - phi[i - 1]))) for i in open_nodes]
    return [opening for opening in candidates if _is_inside_contact(opening, arcs)]


def _is_inside_contact(opening: _Opening, arcs: list[list[float]]) -> bool:
    """Whether an opening lies inside a contact, away from its ends, and is not far shorter."""
    for start, end in arcs:
        away_from_ends = start + opening.width < opening.at < end - opening.width
        if away_from_ends and opening.width > UNRESOLVED_LENGTH * (end - start):
            return True
    return False


def _round_contact_end(phi: float, length: float) -> float:
    """An end of the contact [rad], rounded to a millionth of the contact's length [rad].

    Round-off, such as that between different numbers of threads, then does not change a division.
    """
    digits = CONTACT_END_BITS - math.frexp(length)[1]
    return math.ldexp(round(math.ldexp(phi, digits)), -digits)
