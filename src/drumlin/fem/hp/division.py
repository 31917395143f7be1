"""How a shoe is divided into columns along its lining and layers through its thickness.

Sizes grow geometrically away from the places where the stress is not smooth: the lining's ends, the
ends of the contact and kinks of its gap, the interfaces of layers where these end, and the corners
at the face that the hinge holds. With the degree that makes the error fall exponentially (Babuska &
Guo 1986; Schwab, p- and hp-Finite Element Methods, ch.
4).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake.beam_axis import axis_of
from drumlin.brake.brake import Shoe
from drumlin.brake.components import Beam
from drumlin.fem.hp.corner import tip_size
from drumlin.response.response import EDGE_ZONE

FINEST = 1e-5
"""Smallest column or layer, in parts of the lining's thickness. The stiffness of smaller ones loses
more digits to round-off than they resolve of p; larger ones leave the ends of the shortest contacts
unresolved, see `adapt.SHORTEST`."""
SAME = 1e-3
"""Distance of an end of the contact from the lining's end up to which it counts as reaching the
lining's end, in parts of the contact's length. An open gap that is longer has columns of its own.
"""
SHARPEST = 1e-7
"""Smallest columns and layers at a tip of the gap, in parts of the lining's thickness.

Columns of a size w through layers of the thickness t lose about 1e-16 (t/w)^2 of p in the column
itself, and so some 1e-6 of p in L2 at 2e-7 of t. FINEST, which holds for all other places, would
leave 1e-3 of p under a tip, whose error in L2 falls as the root of w.
"""
CORNER_SIZE = 1e-4
"""Size of columns and layers at a pressed corner where p has no bound, in parts of its contact.

Nearer to the corner p is the power of the corner, see `corner.with_powers`. At 1e-3 the second
level of two brakes had 2.5 times the error of p; at 1e-5 it had the same on a sixth more unknowns.
Columns that are 0.03 of the contact or more feel the rest of it, not the power alone.
"""
CORNER_COUNTS = 6 * EDGE_ZONE
"""Length of a contact [rad] up to which the corner that it reaches is divided for its own sake.
Half the force of a longer one is beyond EDGE_ZONE from the corner, and p is judged there alone.
"""


class Singularity(IntEnum):
    """What is not smooth at a place: the pressure at an end of the contact; the slope of the gap;
    its curvature, at the ends of a step between blocks; that too, but where nothing presses; the
    slope of the gap where it points to the drum, and p rises without end."""

    END = 0
    KINK = 1
    STEP = 2
    OPEN_STEP = 3
    TIP = 4


SingularPoint = tuple[float, float, int]
"""Its phi [rad], the length over which the pressure changes there [rad], its Kind. The length of a
tip is that of `corner.tip_size`."""


class GradingPoint(NamedTuple):
    """Where columns end, at phi, their size there [rad] and the ratio by which they grow."""

    at: float
    size: float
    ratio: float


@dataclass(frozen=True)
class Level:
    """How finely a body is divided. Sizes next to singular places, as parts of the length that
    rules there:

    `zone`: columns and layers at the lining's ends at its face, of EDGE_ZONE, columns where this is
    less than `edge`, `edge`: columns at the lining's ends, of its thickness or half its length, and
    of half the length of a contact that reaches one; `end`: columns at ends of the contact and
    kinks, of the contact's length, or of its geometric mean with the thickness where this is less:
    p rises from an end over the thickness, and the longer the contact, the less of p is there;
    `back`: layers at the ends of layers, of the thinner layer; `hinge`: columns and layers at the
    face that the hinge holds, of the body's thickness. Sizes grow along by 1/`ratio`, from ends of
    a contact shorter than the lining is thick by 1/`opening`, and through the layers by
    1/`through`; `largest` [rad]: of a column.
    """

    degree: int
    zone: float
    edge: float
    end: float
    ratio: float
    opening: float
    largest: float
    back: float
    hinge: float
    through: float

    @property
    def error(self) -> float:
        """What the growth of sizes by 1/`ratio` leaves of p in L2, relative: see
        `levels.LevelRule`.
        """
        root = math.sqrt(self.ratio)
        return ((1 - root) / (1 + root)) ** self.degree


@dataclass(frozen=True)
class ShoeLayer:
    """A layer: the part it belongs to and its thickness [m]."""

    part: str
    thickness: float


@dataclass(frozen=True)
class ShoeDivision:
    """Columns and layers of a shoe.

    `angles` (m + 1,) phi [rad]: ends of the columns under the lining; `before`, `after`: of those
    of the body beyond it, starting at the lining; `depths` (l + 1,): ends of the layers, from the
    contact inwards, of an arc [m], of a beam in layers; `part` (l,): what each layer belongs to;
    `sharp` [m]: size of the layer at the face where p has no bound at a corner or under a tip and
    asks for a thin one, inf elsewhere.
    """

    degree: int
    angles: Floats
    before: Floats
    after: Floats
    depths: Floats
    part: tuple[str, ...]
    sharp: float = math.inf

    @property
    def key(self) -> tuple[int, bytes, bytes, bytes, bytes]:
        """Equal for equal divisions of a shoe."""
        ends = self.angles, self.before, self.after, self.depths
        return self.degree, *(each.tobytes() for each in ends)  # type: ignore[return-value]

    @property
    def layers(self) -> int:
        """Number of layers under the lining."""
        return len(self.part)

    @property
    def first(self) -> int:
        """The first layer that goes on beyond the lining, that of the body; `layers` of a rigid
        shoe.
        """
        return next(
            (i for i, part in enumerate(self.part) if part in {"table", "shoe"}), len(self.part)
        )

    @property
    def contact_nodes(self) -> int:
        """Number of nodes on the contact."""
        return (len(self.angles) - 1) * self.degree + 1

    @property
    def unknowns(self) -> int:
        """Number of displacement unknowns."""
        p, beyond = self.degree, self.layers - self.first
        under = (self.layers * p + 1) * self.contact_nodes
        over = (beyond * p + 1) * p * (len(self.before) + len(self.after) - 2) if beyond else 0
        return 2 * (under + over)


def graded(
    length: float,
    left: float,
    right: float,
    ratio: float,
    largest: float,
    beyond: float | None = None,
) -> list[float]:
    """Sizes over `length` that grow by 1/ratio from `left` and by 1/beyond, where given, from
    `right` at its ends; even ones up to `largest` between.
    """
    beyond = beyond or ratio
    first: list[float] = []
    last: list[float] = []
    while True:
        rest = length - math.fsum(first) - math.fsum(last)
        least = min(left, right)
        if least >= largest or rest <= 1.6 * least:
            break
        if left <= right:
            first.append(left)
            left /= ratio
        else:
            last.append(right)
            right /= beyond
    count = max(1, math.ceil(rest / min(largest, 1.6 * least) - 1e-9))
    return [*first, *[rest / count] * count, *last[::-1]]


def faded(part: float, distance: float, *, fades: bool) -> float:
    """The part of a length to which a corner is divided, at a distance from the contact in lengths
    of the contact.

    Stresses fall at least as the inverse distance beyond a short contact. A corner may be so much
    coarser there, up to a whole length, if it `fades`. In powers of two, as the columns at the ends
    of the contact: see `_mark`.
    """
    if not fades:
        return part
    return max(part, min(1.0, part * 2.0 ** math.floor(math.log2(max(distance, 1.0)))))


def ends_of(sizes: Sequence[float], start: float, end: float) -> Floats:
    """Where pieces of these sizes from start on end; the last one at `end`."""
    return np.append(start + np.concatenate([[0.0], np.cumsum(sizes[:-1])]), end)


def layers_of(shoe: Shoe, radius: float) -> list[ShoeLayer]:
    """The layers of a shoe from the contact inwards; the block of a straight beam with its least
    thickness.
    """
    found = [ShoeLayer("lining", shoe.lining.thickness)]
    if isinstance(shoe.body, Beam):
        assert shoe.body.section is not None and shoe.backing is not None  # why_not
        axis = axis_of(shoe.pin.xy, shoe.actuation.point.xy)
        ends = axis.angle(np.array([shoe.lining.start, shoe.lining.end]))
        nearest = 1.0 if ends.min() < 0 < ends.max() else float(np.cos(ends).max())
        room = (
            axis.distance
            - shoe.body.section.thickness / 2
            - (radius + shoe.lining.thickness) * nearest
        )
        return [*found, ShoeLayer("backing", room), ShoeLayer("shoe", shoe.body.section.thickness)]
    if shoe.backing is not None:
        found.append(ShoeLayer("backing", shoe.backing.thickness))
    if shoe.body is not None:
        found += [ShoeLayer(name, plate.thickness) for name, plate in shoe.body.plates.items()]
    return found


def divide(
    shoe: Shoe,
    radius: float,
    level: Level,
    places: Sequence[SingularPoint] = (),
    *,
    tip: bool = False,
    powers: tuple[float, float] = (0.0, 0.0),
) -> ShoeDivision:
    """The division of a shoe. `places`, growing: where the pressure is not smooth; it may be
    unbounded at a kink of the gap. An end of the lining that is known to bear nothing is graded as
    the ends of other layers, all of them more coarsely beyond a contact that is short, see `faded`.
    `tip`: whether it matters how far its loaded end goes, which then is graded too: the contact
    feels only what force is there. `powers`: those of p at the lining's ends where they press, see
    `corner.powers_of`.
    """
    start, end = shoe.arc
    layers = layers_of(shoe, radius)
    t = layers[0].thickness / radius
    scale = min(level.edge * min(t, 0.5 * (end - start)), level.zone * EDGE_ZONE)
    contact = [x for x, _, kind in places if kind == Singularity.END] or [start, end]
    lengths = [length for _, length, kind in places if kind == Singularity.END]
    least, reached = FINEST * t, _reached(start, end, places)
    pressed = max(*lengths, least) if lengths else end - start
    # A column deeper than long bears a force down to its foot: corners there feel it.
    deep = 2 * sum(layer.thickness for layer in layers) > radius * (end - start)
    # The force of one short contact follows from balance. Where there are more on an elastic shoe,
    # it depends on how the shoe bends, and far corners feel that too.
    fades = not deep and (shoe.body is None or (len(lengths) == 2 and pressed < t))
    beyond = contact[0] - start, end - contact[-1]
    apart = [
        max(0.5 * x, least) if x > 0 and math.isinf(length) else math.inf
        for x, length in zip(beyond, reached, strict=True)
    ]
    left, right = (
        min(
            max(min(scale, away), faded(level.back, x / pressed, fades=fades) * min(t, x)),
            max(level.edge * 0.5 * length, least),
        )
        for x, away, length in zip(beyond, apart, reached, strict=True)
    )
    corners = [
        max(_corner(length, power), least) for length, power in zip(reached, powers, strict=True)
    ]
    left, right = min(left, corners[0]), min(right, corners[1])
    marks = _marks(
        GradingPoint(start, left, level.ratio),
        GradingPoint(end, right, level.ratio),
        [_mark(level, t, place, min(place[0] - start, end - place[0])) for place in places],
    )
    grip = shoe.grip(radius)
    if grip is not None:
        size = level.hinge * layers[-1].thickness / radius
        kept = [
            mark
            for mark in marks[1:-1]
            if min(abs(mark.at - x) for x in grip) > max(mark.size, size)
        ]
        marks = [
            marks[0],
            *sorted([*kept, *(GradingPoint(x, size, level.ratio) for x in grip)]),
            marks[-1],
        ]
    angles = [
        ends_of(graded(b.at - a.at, a.size, b.size, a.ratio, level.largest, b.ratio), a.at, b.at)[
            :-1
        ]
        for a, b in pairwise(marks)
    ]
    near, far = _beyond(shoe, radius, start, end)
    before, after = np.array([start]), np.array([end])
    if layers[-1].part == "shoe":
        body = layers[-1].thickness / radius
        held = level.hinge * body
        if start - near > 1e-9:
            sizes = graded(start - near, left, held, level.ratio, max(body, level.largest))
            before = start - ends_of(sizes, 0.0, start - near)
        if far - end > 1e-9:
            last = min(held, far - end) if tip else far - end
            sizes = graded(far - end, right, last, level.ratio, max(body, level.largest))
            after = end + ends_of(sizes, 0.0, far - end)
    # Under a short contact the layer at the face is as thick as the columns at its ends are wide.
    face = min(
        level.zone * min(EDGE_ZONE, t, end - start, *reached),
        *(level.end * x for x in lengths),
        math.inf,
    )
    face = max(face, least)
    tips = [_tip(level, t, length) for _, length, kind in places if kind == Singularity.TIP]
    sharp = min(*tips, *corners)
    depths, part = _depths(
        layers,
        level,
        radius * min(face, sharp),
        radius * pressed,
        fades=fades,
        straight=isinstance(shoe.body, Beam),
    )
    ends = np.array([*np.concatenate(angles), end])
    return ShoeDivision(
        level.degree,
        ends,
        before,
        after,
        depths,
        part,
        radius * sharp if sharp < face else math.inf,
    )


def _mark(level: Level, t: float, place: SingularPoint, gap: float) -> GradingPoint:
    """The mark of a place under a lining of thickness t [rad], so far from the lining's end [rad]
    that this gap is columns of its own: an end of the contact to half a column, so that bodies of
    brakes that differ by less are one and the same. Where nothing presses, columns of half a step
    follow the cubic of its gap exactly.

    At an end of the contact p rises as the root of the distance x, at the end of a step it goes as
    x ln x, so that columns of size w leave errors in L2 that go as w and as w^1.5. Columns at a
    step, in parts of the step, need to shrink less from level to level, therefore: as the root of
    `end`. On 10 and 12 steps that is as accurate on the second level as the power 2/3, of which
    both errors would fall alike, with an eighth fewer unknowns.
    """
    x, length, kind = place
    if kind == Singularity.OPEN_STEP:
        return GradingPoint(x, 0.5 * length, level.ratio)
    if kind == Singularity.STEP:
        return GradingPoint(x, length * math.sqrt(level.end), level.ratio)
    size = min(level.end * min(length, math.sqrt(t * length)), max(0.5 * gap, SAME * length))
    size = 2.0 ** math.floor(math.log2(max(size, FINEST * t)))
    if kind == Singularity.KINK:
        return GradingPoint(x, size, level.ratio)
    if kind == Singularity.TIP:
        return GradingPoint(x, _tip(level, t, length), level.ratio)
    return GradingPoint(
        round(2 * x / size) * size / 2, size, level.opening if length <= t else level.ratio
    )


def _tip(level: Level, t: float, length: float) -> float:
    """Size of columns and layers at a tip of the gap [rad], under a lining of thickness t [rad]."""
    return 2.0 ** math.floor(
        math.log2(max(tip_size(length, level.degree, level.end), SHARPEST * t))
    )


def _corner(length: float, power: float) -> float:
    """Size of columns and layers at a corner [rad] that a contact of this length [rad] reaches; inf
    where p is bounded there or does not count."""
    return CORNER_SIZE * length if power < 0 and length <= CORNER_COUNTS else math.inf


def _reached(start: float, end: float, places: Sequence[SingularPoint]) -> tuple[float, float]:
    """The length of the contact that reaches either end of the lining; inf where none does."""
    contact = [(x, size) for x, size, kind in places if kind == Singularity.END]
    near = [size for x, size in contact if x - start < SAME * size]
    far = [size for x, size in contact if end - x < SAME * size]
    return min(near, default=math.inf), min(far, default=math.inf)


def _marks(
    start: GradingPoint, end: GradingPoint, places: Sequence[GradingPoint]
) -> list[GradingPoint]:
    """Ends and places without those that lie in the column at an end, or in the smaller one at a
    place and the place before: an end of the contact stays that is nearer to a step than the
    columns there are wide."""
    marks = [start]
    for mark in places:
        last = marks[-1]
        if end.at - mark.at <= max(end.size, mark.size):
            break
        nearest = max if len(marks) == 1 else min
        if mark.at - last.at > nearest(last.size, mark.size):
            marks.append(mark)
        elif len(marks) > 1 and mark.size < last.size:
            marks[-1] = GradingPoint(last.at, mark.size, max(last.ratio, mark.ratio))
    return [*marks, end]


def _beyond(shoe: Shoe, radius: float, start: float, end: float) -> tuple[float, float]:
    """Where the body begins and ends [rad]; beyond the lining of a straight beam distances along it
    over R + t.
    """
    if isinstance(shoe.body, Beam):
        axis, back = axis_of(shoe.pin.xy, shoe.actuation.point.xy), radius + shoe.lining.thickness
        a = np.sort(axis.angle(shoe.frame.theta(np.array([start, end]))))
        foot = axis.foot + back * np.sin(a)
        return start - float(foot[0]) / back, end + (axis.length - float(foot[1])) / back
    if shoe.body is None:
        return start, end
    near, far = sorted(shoe.frame.phis((shoe.body.start, shoe.body.end)), key=abs)
    return near, far


def _depths(
    layers: list[ShoeLayer],
    level: Level,
    face: float,
    pressed: float,
    *,
    fades: bool,
    straight: bool,
) -> tuple[Floats, tuple[str, ...]]:
    depths, part, at = [np.zeros(1)], [], 0.0
    deep = np.cumsum([layer.thickness for layer in layers]) / pressed
    for k, layer in enumerate(layers):
        t = layer.thickness
        outer = (
            face
            if k == 0
            else faded(level.back, deep[k - 1], fades=fades) * min(t, layers[k - 1].thickness)
        )
        inner = faded(level.back, deep[k], fades=fades) * (
            min(t, layers[k + 1].thickness) if k + 1 < len(layers) else t
        )
        if layer.part == "shoe":  # the last layer is held
            inner = level.hinge * t
        sizes = graded(t, outer, inner, level.through, t)
        ends = ends_of(sizes, 0.0, t)[1:]
        depths.append(at + (ends / t if straight else ends))
        part += [layer.part] * len(sizes)
        at = float(depths[-1][-1])
    return np.concatenate(depths), tuple(part)
