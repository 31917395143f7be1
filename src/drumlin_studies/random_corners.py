"""Random brakes that press with a lining's corner alone or under a tip of the gap, from a seed.

At a corner of a lining and under a kink of its clearance table that points to the drum (a tip) the
pressure is singular. In most brakes the corner lies in the zone that no comparison looks at, or the
tip bears a small part of the force. Here nearly all of the force is there: a taper, a table of
clearances or an unlike radius keeps the rest of the lining off the drum.

The linear problem feels only the force over the size of the gap. So the load is an ordinary one,
and the gap is scaled until the contact has the length that was drawn for it.
"""

import math
from collections.abc import Callable, Mapping
from itertools import islice
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake import clearance
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.file import brake_from, vary
from drumlin.fem.error_control.levels import steps
from drumlin.fem.model import respond
from drumlin.fem.solve import solve
from drumlin.response.response import Response, ShoeResponse
from drumlin_studies.random_brake import KINDS as OF_SHAPE
from drumlin_studies.random_kinds import KINDS as OF_HOLDING

MOST_ATTEMPTS = 200
"""Draws for a seed before it counts as one that has no brake."""
MORE_FRICTION = 1.2
"""Factor on a brake's friction up to which it must have an answer: it is not about to lock."""
MOST_SCALINGS = 8
"""Solves in which the gap is scaled to the length of contact that was drawn."""
FACTOR_DIGITS = 2
"""Significant digits of the factor on a gap. A seed gives the same brake after a change of the
solver that moves the length of contact by less than some percent.
"""
WITHIN = 1.25
"""Factor by which the length of contact may miss the one that was drawn."""
FEW_LEVELS = 2
"""Levels of a solve that find the length of a contact well enough: within some percent."""
SHORT_CONTACT = math.radians(0.1), math.radians(0.8)
LONG_CONTACT = math.radians(0.8), math.radians(8.0)
"""Lengths of contact [rad]: short ones, of which more than half is in the zones that are left out
of the errors of other brakes, and long ones.
"""
SHORT_SHARE = 0.7
"""Share of the brakes whose contact is short."""
AT_END = 1e-9
"""Angle [rad] up to which a contact reaches the lining's end."""

Rng = np.random.Generator
Gap = dict[str, Any]
"""Keys of a lining that make its gap: `clearance` and `misfit`."""


class CornerKind(NamedTuple):
    """How a kind is drawn: which random brakes it may be, and what of the lining presses."""

    shapes: tuple[str, ...]
    presses: str


RIGID, ARCS = ("rigid",), ("arc", "backed")
RINGS = ("arc on ring", "linings on ring", "post on ring")
FREE = ("guide", "abutment", "rough abutment", "pivot")
KINDS: dict[str, CornerKind] = {
    "corner": CornerKind(ARCS, "corner"),
    "corner of a rigid shoe": CornerKind(RIGID, "corner"),
    "corner of a post": CornerKind(("post",), "corner"),
    "corner on a ring": CornerKind(RINGS, "corner"),
    "corner of a shoe without hinge": CornerKind(FREE, "corner"),
    "tip": CornerKind(ARCS, "tip"),
    "tip of a rigid shoe": CornerKind(RIGID, "tip"),
    "tip on a ring": CornerKind(RINGS, "tip"),
    "tip of a shoe without hinge": CornerKind(FREE, "tip"),
    "table": CornerKind((*ARCS, *RIGID, "post", *FREE), "table"),
}


def random_corner(seed: int, kind: str | None = None) -> Brake:
    """The brake of a seed; `kind`: one of KINDS, by default seed modulo their number.

    Every shoe is pressed, with its friction and with MORE_FRICTION times as much. One of them
    presses with a corner or under a tip, as its kind says and the first FEW_LEVELS levels see it:
    friction that drags towards the corner may lift the corner itself a little, which only finer
    levels see. Raises NoAnswer for a seed without such a brake.
    """
    names = list(KINDS)
    kind = names[seed % len(names)] if kind is None else kind
    for attempt in range(MOST_ATTEMPTS):
        rng = np.random.default_rng([seed, names.index(kind), attempt])
        try:
            brake = _scaled_to_length(rng, _drawn(rng, kind, seed), KINDS[kind].presses)
        except (BadInput, NoAnswer):
            continue
        if brake is not None:
            return brake
    raise NoAnswer(f"no brake of kind {kind} from seed {seed} in {MOST_ATTEMPTS} attempts")


def _drawn(rng: Rng, kind: str, seed: int) -> Callable[[float], Brake]:
    """The brake by a factor on its gap, with a force line anywhere and gaps that are drawn."""
    shape = str(rng.choice(KINDS[kind].shapes))
    data = (OF_SHAPE | OF_HOLDING)[shape](rng)
    rotation = str(rng.choice(["clockwise", "counter-clockwise"]))
    friction = 0.0 if rng.random() < 0.12 else float(f"{rng.uniform(0.01, 0.6):.4g}")
    data |= {"title": f"random {kind} {seed}", "rotation": rotation, "friction": friction}
    data["shoe"] = [_pushed_anywhere(rng, shoe) for shoe in data["shoe"]]
    gaps = [_gap(rng, shoe, data["drum"]["radius"], KINDS[kind].presses) for shoe in data["shoe"]]

    def scaled(factor: float) -> Brake:
        shoes = [
            shoe | {"lining": shoe["lining"] | gap(factor)}
            for shoe, gap in zip(data["shoe"], gaps, strict=True)
        ]
        return brake_from(data | {"shoe": shoes})

    return scaled


def _pushed_anywhere(rng: Rng, shoe: dict[str, Any]) -> dict[str, Any]:
    """The shoe with its force turned by up to 60 degrees, nearer to the heel or the toe."""
    push = shoe["actuation"]
    return shoe | {"actuation": push | {"direction": push["direction"] + rng.uniform(-1.0, 1.0)}}


def _gap(rng: Rng, shoe: Mapping[str, Any], radius: float, presses: str) -> Callable[[float], Gap]:
    """The gap of a lining by a factor on its size, which is about the lining's compression."""
    lining = shoe["lining"]
    area = radius * (lining["end"] - lining["start"]) * lining["width"]
    size = shoe["actuation"]["force"] / area * lining["thickness"] / lining["material"]["E"]
    if presses == "corner":
        return _gap_to_corner(rng, lining, radius, size)
    return _gap_to_tip(rng, lining, size) if presses == "tip" else _gap_of_rows(rng, lining, size)


def _gap_to_corner(
    rng: Rng, lining: Mapping[str, Any], radius: float, size: float
) -> Callable[[float], Gap]:
    """A gap that is closed, or nearly, at one corner of the lining, or at both."""
    way, sign = rng.random(), float(rng.choice([-1, 1]))
    if way < 0.4:
        return lambda factor: {"misfit": {"taper": sign * factor * size}}
    if way < 0.5:
        return lambda factor: {"misfit": {"radius": radius + sign * factor * size}}
    if way < 0.6:
        return lambda factor: {"clearance": factor * size}
    rises = np.cumsum([0.0, *rng.uniform(0.2, 1.0, int(rng.integers(1, 4)))])
    rises = rises[:: int(sign)] / rises.max()
    return lambda factor: {"clearance": _rows(lining, factor * size * rises)}


def _gap_to_tip(rng: Rng, lining: Mapping[str, Any], size: float) -> Callable[[float], Gap]:
    """A gap that opens to both sides of one place."""
    start, end = lining["start"], lining["end"]
    at, (left, right) = start + rng.uniform(0.1, 0.9) * (end - start), rng.uniform(0.2, 1.0, 2)
    return lambda factor: {
        "clearance": [[start, factor * size * left], [at, 0.0], [end, factor * size * right]]
    }


def _gap_of_rows(rng: Rng, lining: Mapping[str, Any], size: float) -> Callable[[float], Gap]:
    """A gap by a table of rows that are drawn one by one."""
    rows = rng.uniform(0.0, 1.0, int(rng.integers(3, 8)))
    return lambda factor: {"clearance": _rows(lining, factor * size * rows)}


def _rows(lining: Mapping[str, Any], gaps: Floats) -> list[list[float]]:
    """A table of clearances [m] at even distances along the lining."""
    angles = np.linspace(lining["start"], lining["end"], len(gaps))
    return np.stack([angles, gaps], axis=1).tolist()


def _scaled_to_length(rng: Rng, drawn: Callable[[float], Brake], presses: str) -> Brake | None:
    """The brake whose shortest contact has a length that is drawn here; None where no factor gives
    it.

    In a lining that is pressed on a wedge the length goes about as the inverse of the gap, and
    under a curved one as its inverse root.
    """
    low, high = SHORT_CONTACT if rng.random() < SHORT_SHARE else LONG_CONTACT
    wanted, factor = math.exp(rng.uniform(math.log(low), math.log(high))), 3.0
    for _ in range(MOST_SCALINGS):
        factor = float(f"{factor:.{FACTOR_DIGITS}g}")
        brake = drawn(factor)
        found = _answer(brake)
        length = min((_length(shoe) for shoe in found.shoes), default=0.0)
        if not length > 0:
            return None
        if 1 / WITHIN < length / wanted < WITHIN:
            return brake if _as_drawn(brake, found, presses) else None
        factor *= min(max(length / wanted, 0.1), 10.0) ** 0.8
    return None


def _answer(brake: Brake) -> Response:
    """The response on the first FEW_LEVELS levels of a solve. Raises NoAnswer."""
    *_, last = islice(steps(brake, respond), FEW_LEVELS)
    return last.response


def _length(shoe: ShoeResponse) -> float:
    """Length of all contact of a shoe [rad]."""
    return math.fsum(end - start for start, end in shoe.contact_arcs)


def _as_drawn(brake: Brake, found: Response, presses: str) -> bool:
    """Whether all shoes press, also with more friction, and one with its corner or under a tip."""
    more = solve(vary(brake, {"friction": MORE_FRICTION * brake.friction}), elements=16)
    if not all(shoe.contact_arcs for shoe in (*found.shoes, *more.shoes)):
        return False
    pairs = list(zip(brake.shoes, found.shoes, strict=True))
    corner, tip = any(at_corner(*pair) for pair in pairs), any(at_tip(*pair) for pair in pairs)
    return {"corner": corner, "tip": tip, "table": corner or tip}[presses]


def at_corner(shoe: Shoe, found: ShoeResponse) -> bool:
    """Whether the contact of a shoe reaches an end of its lining."""
    ends = [end for arc in found.contact_arcs for end in arc]
    corners = shoe.lining.start, shoe.lining.end
    return any(abs(end - corner) < AT_END for end in ends for corner in corners)


def at_tip(shoe: Shoe, found: ShoeResponse) -> bool:
    """Whether the contact of a shoe holds a tip of its gap."""
    return any(
        start < angle < end
        for angle, _ in clearance.tips(shoe.lining)
        for start, end in found.contact_arcs
    )
