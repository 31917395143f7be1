"""Where the pressure of a lining is not smooth: the ends of its contact and the kinks of its gap.

One open node between two that press is an opening that the columns there are too wide to show: its ends are anywhere
between, and the error that it makes does not fall from level to level until it is seen. Its node is a place as ends
are. But an opening that is nothing beside its contact is none: where p is all but 0, round-off opens nodes, and places
there would only make more of them.
"""

import math
from collections.abc import Sequence

import numpy as np

from drumlin.brake import clearance
from drumlin.brake.drum_brake import Brake, Shoe
from drumlin.fem import assembly
from drumlin.fem.hp.division import Kind, Place
from drumlin.response.response import Response, ShoeResponse

MOST_KINKS = 12  # a table of clearances with more rows, such as that of a worn lining, is a curve
SEEN = 1e-3  # of the length of its contact that an opening must be to be one
FEW = 4  # nodes that a contact must have more of
SHORTER = 0.15  # part of where one of so few nodes presses that its contact likely is
DIGITS = 20  # binary ones of an end of the contact


def places_of(brake: Brake, response: Response | None, alike: Sequence[int] = ()) -> dict[int, list[Place]]:
    """The places of each shape of shoe, growing, those of all shoes that have it, by the first of these.

    alike: as of `assembly.alike`, where it is known.
    """
    found: dict[int, list[Place]] = {}
    for i, (shoe, first) in enumerate(zip(brake.shoes, alike or assembly.alike(brake), strict=True)):
        own = _places(shoe, None if response is None else response.shoes[i])
        found.setdefault(first, []).extend(own)
    return {key: sorted(places) for key, places in found.items()}


def _places(shoe: Shoe, response: ShoeResponse | None) -> list[Place]:
    (start, end), frame = shoe.arc, shoe.frame
    arcs = [] if response is None else _likely(shoe, response)
    table, steps = (
        [x for x in frame.phis(of(shoe.lining)) if start < x < end]
        for of in (clearance.table_kinks, clearance.step_kinks)
    )

    def presses(x: float) -> bool:
        return response is None or any(2 * a - b < x < 2 * b - a for a, b in arcs)

    # Where nothing presses, or nearly, a kink is nothing; but within a column a block's step would swing beyond itself.
    found: list[Place] = [(x, shoe.lining.step, Kind.STEP if presses(x) else Kind.OPEN_STEP) for x in steps]
    if len(table) <= MOST_KINKS:
        found += [(x, end - start, Kind.KINK) for x in table if presses(x)]
    for one, other in arcs:
        first, last = (min(max(_rounded(x, other - one), start), end) for x in (one, other))
        found += [(first, last - first, Kind.END), (last, last - first, Kind.END)]
    if response is not None:
        found += [(_rounded(x, length), length, Kind.END) for x, length in _hidden(shoe, response, arcs)]
    return found


def pressed_arcs(shoe: Shoe, response: ShoeResponse) -> list[list[float]]:
    """Where the lining is pressed [rad], growing, without openings that are nothing beside their contact."""
    found: list[list[float]] = []
    for a, b in sorted(sorted(shoe.frame.phis(arc)) for arc in response.contact_arcs):
        if found and a - found[-1][1] < SEEN * (b - found[-1][0]):
            found[-1][1] = b
        else:
            found.append([a, b])
    return found


def _likely(shoe: Shoe, response: ShoeResponse) -> list[list[float]]:
    """The arcs that are pressed [rad]. One end is beside the last node that presses, so what FEW nodes press is likely
    shorter: SHORTER of that for each, about these."""
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


def _hidden(shoe: Shoe, response: ShoeResponse, arcs: list[list[float]]) -> list[tuple[float, float]]:
    """Open nodes between two that press, and how far apart these are [rad]; not at the ends of the contact, which are
    known, and not where columns are so narrow that an opening is nothing, as where p wavers from node to node."""
    press = response.pressure > 0
    at = 1 + np.flatnonzero(press[:-2] & ~press[1:-1] & press[2:])
    if not len(at):
        return []
    phi = shoe.frame.phi(response.theta)
    found = [(float(phi[i]), abs(float(phi[i + 1] - phi[i - 1]))) for i in at]
    return [(x, size) for x, size in found if any(a + size < x < b - size and size > SEEN * (b - a) for a, b in arcs)]


def _rounded(x: float, length: float) -> float:
    """An end of the contact to a millionth of its length: round-off, as between numbers of threads, moves no mesh."""
    digits = DIGITS - math.frexp(length)[1]
    return math.ldexp(round(math.ldexp(x, digits)), -digits)
