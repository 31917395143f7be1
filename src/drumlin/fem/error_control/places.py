"""Where the pressure of a lining is not smooth: the ends of its contact and the kinks of its gap.

One open node between two that press is an opening that the columns there are too wide to show: its
ends are anywhere between, and the error that it makes does not fall from level to level until it is
seen. Its node is a place as ends are. But an opening that is nothing beside its contact is none:
where p is all but 0, round-off opens nodes, and places there would only make more of them.
"""

import math
from collections.abc import Sequence

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake import clearance
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.components import Lining
from drumlin.fem.hp.corner import tip_rises
from drumlin.fem.hp.division import Singularity, SingularPoint
from drumlin.fem.preparation.cache import alike as equal_shapes
from drumlin.response.response import Response, ShoeResponse
from drumlin.response.resultants import gauss_points

UNFELT = 0.1
"""Error in L2 of p over `Level.error`, up to which the kinks of a table of clearances may be
left out of its places.

A level has an error of p of about a tenth of its `error`. So what all those kinks do that
are left out, the weakest, stays below the error of the level itself, on finer levels too: a table
of many rows, such as that of a worn lining, is a curve until a level is fine enough to see its
chords. With all kinks as places such a table takes columns by the hundred; with none a table with a
real kink is short of the tolerance on all levels.
"""
SEEN = 1e-3
"""Length of an opening, in parts of its contact, below which it is round-off and is ignored.
Larger, real openings go unseen; smaller, nodes where p is all but 0 become singular points by the
dozen.
"""
FEW = 4
"""Number of pressed nodes up to which a contact is taken to be shorter than they span. With fewer
nodes of its own a short contact needs more passes until its ends are found.
"""
SHORTER = 0.15
"""Part of the arc of FEW pressed nodes or fewer that each of them stands for: a contact with n of
them is first looked for on 0.15 n of their arc, about the resultant. The passes after that find its
ends.
"""
DIGITS = 20
"""Binary digits of an end of the contact, relative to its length. Fewer move the ends by more than
a column there; with more, round-off would change the division from machine to machine.
"""


def places_of(
    brake: Brake, response: Response | None, alike: Sequence[int] = (), error: float = 0.0
) -> dict[int, list[SingularPoint]]:
    """The places of each shape of shoe, growing, those of all shoes that have it, by the first of
    these.

    Without a response, kinks of a table are no places yet: how much one matters depends on how hard
    the lining bears. alike: as of `cache.alike`, where it is known; error: that of the level,
    with 0 all kinks of a table are places where the lining presses.
    """
    found: dict[int, list[SingularPoint]] = {}
    for i, (shoe, first) in enumerate(zip(brake.shoes, alike or equal_shapes(brake), strict=True)):
        own = _places(
            shoe, None if response is None else response.shoes[i], brake.scale_factor, error
        )
        found.setdefault(first, []).extend(own)
    return {key: sorted(places) for key, places in found.items()}


def _places(
    shoe: Shoe, response: ShoeResponse | None, scale_factor: float, level_error: float
) -> list[SingularPoint]:
    (start, end), frame = shoe.arc, shoe.frame
    arcs = [] if response is None else _likely(shoe, response)

    def presses(x: float) -> bool:
        return response is None or any(2 * a - b < x < 2 * b - a for a, b in arcs)

    # Where nothing presses, or nearly, a kink is nothing; but within a column a block's step would
    # swing beyond itself.
    steps = [x for x in frame.phis(clearance.step_kinks(shoe.lining)) if start < x < end]
    found: list[SingularPoint] = [
        (
            x,
            shoe.lining.step / frame.unit,
            Singularity.STEP if presses(x) else Singularity.OPEN_STEP,
        )
        for x in steps
    ]
    if response is not None:
        angle, felt = (
            np.array(clearance.table_kinks(shoe.lining)),
            strengths(shoe.lining, scale_factor),
        )
        inside = np.array([start < x < end and presses(x) for x in frame.phis(angle)], dtype=bool)
        _, p, weight = gauss_points(response.theta, response.pressure, response.order)
        size = math.sqrt(float(np.sum(weight * p**2)))
        kinks = _strongest(angle[inside], felt[inside], UNFELT * level_error * size)
        found += [(x, end - start, Singularity.KINK) for x in frame.phis(kinks)]
        found += _tips(shoe, scale_factor, size, kinks)
    for one, other in arcs:
        first, last = (min(max(_rounded(x, other - one), start), end) for x in (one, other))
        found += [(first, last - first, Singularity.END), (last, last - first, Singularity.END)]
    if response is not None:
        found += [
            (_rounded(x, length), length, Singularity.END)
            for x, length in _hidden(shoe, response, arcs)
        ]
    return found


def _tips(shoe: Shoe, scale_factor: float, size: float, kinks: Floats) -> list[SingularPoint]:
    """Those of the kinks (k,) that point to the drum, in a lining whose pressure has the norm
    `size`, in Pa times the root of the surface's coordinate."""
    found: list[SingularPoint] = []
    for angle, rise in tip_rises(shoe, scale_factor):
        if angle in kinks:
            (tip,) = shoe.frame.phis([angle])
            found.append((tip, (size / rise) ** 2 / shoe.frame.unit, Singularity.TIP))
    return found


def strengths(lining: Lining, scale_factor: float) -> Floats:
    """What each row of a table of clearances changes in p (k,) [Pa rad^0.5], in L2, if the table
    were a smooth curve.

    Where the slope changes by s at rows at a distance h, the chords stray from a smooth curve by
    the parabola s x (1 - x/h)/2, a series of cosines of the amplitudes s h/(2 pi^2 n^2). A
    half-plane answers to one of the wave number k = 2 pi n/h with E k/2 times its amplitude, a thin
    layer with E/t times it: in the root mean square p is off by E s/sqrt(48) and E s h/(sqrt(720)
    t). A layer on what bears it is at most as stiff as both together.
    """
    angle = np.array(clearance.table_kinks(lining))
    if len(angle) == 0:
        return angle
    ends = np.concatenate([[lining.start], 0.5 * (angle[1:] + angle[:-1]), [lining.end]])
    spacing = np.maximum(np.diff(ends), 0.0)
    slope = np.abs(clearance.slope_changes(lining)) / scale_factor
    material = lining.material
    half_plane = material.E_half_plane / material.E_through
    stiffness = half_plane / math.sqrt(48) + scale_factor * spacing / (
        math.sqrt(720) * lining.thickness
    )
    return np.asarray(material.E_through * slope * stiffness * np.sqrt(spacing))


def _strongest(angle: Floats, strength: Floats, least: float) -> Floats:
    """The angles without the weakest ones, whose strengths together, squared, are at most `least`
    squared."""
    order = np.argsort(strength, kind="stable")
    left_out = np.cumsum(strength[order] ** 2) <= least**2
    return np.sort(angle[order[~left_out]])


def pressed_arcs(shoe: Shoe, response: ShoeResponse) -> list[list[float]]:
    """Where the lining is pressed [rad], growing, without openings that are nothing beside their
    contact.
    """
    found: list[list[float]] = []
    for a, b in sorted(sorted(shoe.frame.phis(arc)) for arc in response.contact_arcs):
        if found and a - found[-1][1] < SEEN * (b - found[-1][0]):
            found[-1][1] = b
        else:
            found.append([a, b])
    return found


def _likely(shoe: Shoe, response: ShoeResponse) -> list[list[float]]:
    """The arcs that are pressed [rad]. One end is beside the last node that presses, so what FEW
    nodes press is likely shorter: SHORTER of that for each, about these.
    """
    phi, p = shoe.frame.phi(response.theta), response.pressure
    found: list[list[float]] = []
    for arc in pressed_arcs(shoe, response):
        on = (p > 0) & (phi >= arc[0]) & (phi <= arc[1])
        pressing = np.count_nonzero(on)
        if pressing <= FEW:
            middle, part = float(phi[on] @ p[on] / p[on].sum()), SHORTER * pressing
            found.append([middle + part * (end - middle) for end in arc])
        else:
            found.append(arc)
    return found


def _hidden(
    shoe: Shoe, response: ShoeResponse, arcs: list[list[float]]
) -> list[tuple[float, float]]:
    """Open nodes between two that press, and how far apart these are [rad]; not at the ends of the
    contact, which are known, and not where columns are so narrow that an opening is nothing, as
    where p wavers from node to node.
    """
    press = response.pressure > 0
    at = 1 + np.flatnonzero(press[:-2] & ~press[1:-1] & press[2:])
    if not len(at):
        return []
    phi = shoe.frame.phi(response.theta)
    found = [(float(phi[i]), abs(float(phi[i + 1] - phi[i - 1]))) for i in at]
    return [
        (x, size)
        for x, size in found
        if any(a + size < x < b - size and size > SEEN * (b - a) for a, b in arcs)
    ]


def _rounded(x: float, length: float) -> float:
    """An end of the contact to a millionth of its length: round-off, as between numbers of threads,
    moves no mesh.
    """
    digits = DIGITS - math.frexp(length)[1]
    return math.ldexp(round(math.ldexp(x, digits)), -digits)
