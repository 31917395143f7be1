"""Singular points of a lining's pressure: the ends of its contact and the kinks of its gap.

An open node between two pressed nodes is an opening that the hp elements there are too wide to
resolve. Its ends are anywhere between the neighbours, and its error does not fall from level to
level until a level resolves it. The open node is therefore a singular point, as ends are. An
opening that is far shorter than its contact is ignored: where p is nearly 0 round-off opens nodes,
and singular points there would only make more of them.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake import clearance
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.components import Lining
from drumlin.fem.hp.corner import tip_rises
from drumlin.fem.hp.division import SETTLED, Singularity, SingularPoint
from drumlin.fem.preparation.cache import first_shoes_of_equal_shape as equal_shapes
from drumlin.response.response import Response, ShoeResponse
from drumlin.response.resultants import gauss_points

UNFELT = 0.1
"""Error of p in L2, relative to `Level.error`, by which kinks of a gap may be left out.

Kinks that change p by less together are no singular points.

A level has an error of p of about a tenth of its `error`. The kinks that are left out, the weakest,
therefore stay below the error of the level itself, on finer levels too. A table of many rows, such
as that of a worn lining, is a curve until a level is fine enough to resolve its chords. With all
kinks as singular points such a table takes hp elements by the hundred. With none, a table with a
real kink is short of the tolerance on all levels.
"""
KEPT_BITS = 20
"""Binary digits of an end of the contact, relative to the length of the contact: a millionth.

With 36 digits all answers of the stored truths are the same. With 10 digits p is up to six times
less exact at 1e-4, since columns then end beside the contact.
"""


class _Opening(NamedTuple):
    """An open node at the coordinate `x` [rad] between two pressed nodes, `width` [rad] apart."""

    x: float
    width: float


def places_of(
    brake: Brake, response: Response | None, alike: Sequence[int] = (), error: float = 0.0
) -> dict[int, list[SingularPoint]]:
    """The singular points of each shape of shoe, growing, by the position of its first shoe.

    Shoes of one shape share a division, so that their singular points are put together.

    Parameters
    ----------
    brake : the brake
    response : an earlier response, or None; without it kinks of a table are not singular yet, since
        their strength depends on the pressure
    alike : the first shoe of the same shape of each shoe, as of `cache.alike`, if it is known
    error : of the level; with 0 all kinks of a table are singular where the lining presses
    """
    points: dict[int, list[SingularPoint]] = {}
    first_alike = alike or equal_shapes(brake)
    for i, (shoe, first) in enumerate(zip(brake.shoes, first_alike, strict=True)):
        answer = None if response is None else response.shoes[i]
        own = _places(shoe, answer, brake.scale_factor, error)
        points.setdefault(first, []).extend(own)
    return {first: sorted(own) for first, own in points.items()}


def _places(
    shoe: Shoe, answer: ShoeResponse | None, scale_factor: float, level_error: float
) -> list[SingularPoint]:
    """The singular points of one lining, in no order."""
    arcs = [] if answer is None else pressed_arcs(shoe, answer)
    points = _steps(shoe, answer, arcs)
    if answer is not None:
        points += _table_kinks(shoe, answer, arcs, scale_factor, level_error)
    start, end = shoe.arc
    for arc_start, arc_end in arcs:
        length = arc_end - arc_start
        first = min(max(_rounded(arc_start, length), start), end)
        last = min(max(_rounded(arc_end, length), start), end)
        points += [(first, last - first, Singularity.END), (last, last - first, Singularity.END)]
    if answer is not None:
        for opening in _openings(shoe, answer, arcs):
            points.append((_rounded(opening.x, opening.width), opening.width, Singularity.END))
    return points


def _near_contact(x: float, arcs: list[list[float]]) -> bool:
    """Whether x [rad] is within a contact, or as near to it as the contact is long."""
    return any(2 * start - end < x < 2 * end - start for start, end in arcs)


def _steps(shoe: Shoe, answer: ShoeResponse | None, arcs: list[list[float]]) -> list[SingularPoint]:
    """The steps of a lining in blocks.

    A step where the lining does not press, or hardly, is not singular. Yet within an hp element it
    would make the polynomials oscillate.
    """
    start, end = shoe.arc
    length = shoe.lining.step / shoe.frame.unit
    points: list[SingularPoint] = []
    for x in shoe.frame.phis(clearance.step_kinks(shoe.lining)):
        if start < x < end:
            presses = answer is None or _near_contact(x, arcs)
            points.append((x, length, Singularity.STEP if presses else Singularity.OPEN_STEP))
    return points


def _table_kinks(
    shoe: Shoe,
    answer: ShoeResponse,
    arcs: list[list[float]],
    scale_factor: float,
    level_error: float,
) -> list[SingularPoint]:
    """The kinks of a table of clearances that p feels on a level of this error, and its tips."""
    (start, end), frame = shoe.arc, shoe.frame
    angle = np.array(clearance.table_kinks(shoe.lining))
    strength = strengths(shoe.lining, scale_factor)
    near = [start < x < end and _near_contact(x, arcs) for x in frame.phis(angle)]
    inside = np.array(near, dtype=bool)
    _, p, weight = gauss_points(answer.theta, answer.pressure, answer.order)
    norm = math.sqrt(float(np.sum(weight * p**2)))
    kinks = _strongest(angle[inside], strength[inside], UNFELT * level_error * norm)
    points: list[SingularPoint] = [(x, end - start, Singularity.KINK) for x in frame.phis(kinks)]
    return points + _tips(shoe, scale_factor, norm, kinks)


def _tips(shoe: Shoe, scale_factor: float, norm: float, kinks: Floats) -> list[SingularPoint]:
    """The tips of the gap among the kinks (k,): kinks that point to the drum.

    `norm` is that of the pressure, in Pa times the root of the surface's coordinate.
    """
    points: list[SingularPoint] = []
    for angle, rise in tip_rises(shoe, scale_factor):
        if angle in kinks:
            (tip,) = shoe.frame.phis([angle])
            points.append((tip, (norm / rise) ** 2 / shoe.frame.unit, Singularity.TIP))
    return points


def strengths(lining: Lining, scale_factor: float) -> Floats:
    """The change of p in L2 (k,) [Pa rad^0.5] that each row of a table of clearances causes.

    The change is that against a smooth curve in place of the table. Where the slope changes by s at
    rows at a distance h, the chords stray from a smooth curve by the parabola s x (1 - x/h)/2, a
    series of cosines of the amplitudes s h/(2 pi^2 n^2). A half-plane answers a cosine of the wave
    number k = 2 pi n/h with E k/2 times its amplitude, a thin layer with E/t times it. In the root
    mean square p is off by E s/sqrt(48) and E s h/(sqrt(720) t). A layer on its support is at most
    as stiff as both together.
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


def _strongest(angle: Floats, strength: Floats, least: float) -> Floats:
    """The angles (k,) without the weakest, whose root sum of squares is at most `least`."""
    order = np.argsort(strength, kind="stable")
    neglected = np.cumsum(strength[order] ** 2) <= least**2
    return np.sort(angle[order[~neglected]])


def pressed_arcs(shoe: Shoe, response: ShoeResponse) -> list[list[float]]:
    """The contacts of a lining [rad], growing, each with its start and its end.

    Openings that are far shorter than their contact are ignored, see `division.SETTLED`.
    """
    arcs: list[list[float]] = []
    for start, end in sorted(sorted(shoe.frame.phis(arc)) for arc in response.contact_arcs):
        if arcs and start - arcs[-1][1] < SETTLED * (end - arcs[-1][0]):
            arcs[-1][1] = end
        else:
            arcs.append([start, end])
    return arcs


def _openings(shoe: Shoe, answer: ShoeResponse, arcs: list[list[float]]) -> list[_Opening]:
    """The open nodes between two pressed nodes, as far as they are openings of their own.

    An open node at an end of a contact belongs to the end. Where hp elements are so narrow that an
    opening is far shorter than the contact, p wavers around 0 from node to node.
    """
    press = answer.pressure > 0
    at = 1 + np.flatnonzero(press[:-2] & ~press[1:-1] & press[2:])
    if not len(at):
        return []
    phi = shoe.frame.phi(answer.theta)
    candidates = [_Opening(float(phi[i]), abs(float(phi[i + 1] - phi[i - 1]))) for i in at]
    return [opening for opening in candidates if _within_contact(opening, arcs)]


def _within_contact(opening: _Opening, arcs: list[list[float]]) -> bool:
    """Whether an opening is inside a contact, off its ends, and not far shorter than it."""
    x, width = opening
    return any(
        start + width < x < end - width and width > SETTLED * (end - start) for start, end in arcs
    )


def _rounded(x: float, length: float) -> float:
    """An end of the contact to a millionth of its length.

    Round-off, as between numbers of threads, then moves no mesh.
    """
    digits = KEPT_BITS - math.frexp(length)[1]
    return math.ldexp(round(math.ldexp(x, digits)), -digits)
