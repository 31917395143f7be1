"""The division of a shoe into columns along its lining and layers through its thickness.

Sizes grow geometrically away from singular points, where the stress is not smooth: the lining's
ends, the ends of the contact and kinks of its gap, the interfaces of layers where these end, and
the corners at the face that the hinge holds. Together with the degree the grading makes the error
fall exponentially (Babuska & Guo 1986; Schwab, p- and hp-Finite Element Methods, ch. 4).
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

FINEST = 1e-7
"""Smallest size of a column or layer, relative to the lining's thickness: set by arithmetic.

Columns of a size w through layers of the thickness t lose about 1e-16 (t/w)^2 of p in the column
itself, and so some 1e-6 of p in L2 at w = 2e-7 t. Smaller columns would lose all digits of p.
Columns a hundred times larger would leave an error of 1e-3 of p under a tip of the gap, whose error
in L2 falls as the root of w.
"""
SETTLED = 0.02
"""Length along the contact, relative to the contact's length, that columns do not resolve.

An end of the contact that moved by less is where it was, and an opening that is shorter counts as
closed. With a larger value columns end where p does not, and the error of p is that of a coarser
level. With a smaller value a level takes more passes for an end that it knows.
"""
CORNER_SIZE = 1e-4
"""Size of columns and layers at a pressed corner where p is unbounded, relative to the contact.

Nearer to the corner p is given by the power of the corner, see `corner.with_powers`. With 1e-3 the
error of p on the second level of two brakes was 2.5 times as large; with 1e-5 it was the same, on a
sixth more unknowns. Columns of 0.03 of the contact or more feel the rest of the contact, not the
power alone.
"""
HALF_THE_FORCE = 0.1632
"""Part of a contact, from a corner on, that bears half of its force where p goes as x^(-1/2) at the
corner and as a root at the other end: the median of the beta distribution of 1/2 and 3/2. No p that
is square-integrable is more concentrated at the corner.
"""
CORNER_COUNTS = EDGE_ZONE / HALF_THE_FORCE
"""Length of a contact [rad] up to which the corner that it reaches is graded for its own sake. Half
the force of a longer contact is farther than EDGE_ZONE from the corner, and only p there is judged.
"""


class Singularity(IntEnum):
    """The kind of a singular point: which function is not smooth there.

    END: the pressure, at an end of the contact. KINK: the slope of the gap. STEP: the curvature of
    the gap at an end of a step between blocks. OPEN_STEP: the same where no pressure acts. TIP: the
    slope of the gap where the gap points to the drum, and p is unbounded.
    """

    END = 0
    KINK = 1
    STEP = 2
    OPEN_STEP = 3
    TIP = 4


SingularPoint = tuple[float, float, int]
"""A singular point: its phi [rad], the length over which the pressure changes there [rad], and its
`Singularity`. The length of a tip is that of `corner.tip_size`."""


class GradingPoint(NamedTuple):
    """A grading point: an end of columns at phi [rad].

    `size` is the size of the columns next to the point [rad], and `ratio` that of neighbouring
    columns, which grow away from it by 1/ratio.
    """

    at: float
    size: float
    ratio: float


@dataclass(frozen=True)
class Level:
    """How finely a body is divided into columns and layers.

    Attributes
    ----------
    degree : of the hp elements
    zone : size of columns and layers at the lining's ends at its face, as a part of EDGE_ZONE;
        of columns where this is less than by `edge`
    edge : size of columns at the lining's ends, as a part of its thickness or of half its length,
        and of half the length of a contact that reaches the lining's end
    end : size of columns at ends of the contact and at kinks, as a part of the contact's length, or
        of the geometric mean of length and thickness where this is less: p rises from an end over
        the thickness, and the longer the contact, the less of p is there
    ratio : sizes grow by 1/ratio from column to column
    opening : the same from ends of a contact that is shorter than the lining is thick
    largest : size of a column that is not exceeded [rad]
    back : size of layers at the ends of layers, as a part of the thinner layer
    hinge : size of columns and layers at the face that the hinge holds, as a part of the body's
        thickness
    through : sizes grow by 1/through from layer to layer
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
        """The relative error of p in L2 that growth by 1/`ratio` leaves, see `levels.LevelRule`."""
        root = math.sqrt(self.ratio)
        return ((1 - root) / (1 + root)) ** self.degree


@dataclass(frozen=True)
class ShoeLayer:
    """A layer of a shoe: the `part` that it belongs to and its `thickness` [m]."""

    part: str
    thickness: float


@dataclass(frozen=True)
class ShoeDivision:
    """The columns and layers of a shoe.

    Attributes
    ----------
    degree : of the elements
    angles : (m + 1,) phi of the ends of the columns under the lining [rad]
    before, after : the same of the columns of the body beyond the lining, starting at the lining
    depths : (l + 1,) ends of the layers from the contact inwards; of an arc [m],
        of a beam in layers
    part : (l,) the part that each layer belongs to
    sharp : size [m] of the layer at the face where an unbounded p, at a corner or under a tip, asks
        for a thin one; inf elsewhere
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
        """A key that is equal for equal divisions of a shoe."""
        return (
            self.degree,
            self.angles.tobytes(),
            self.before.tobytes(),
            self.after.tobytes(),
            self.depths.tobytes(),
        )

    @property
    def layers(self) -> int:
        """Number of layers under the lining."""
        return len(self.part)

    @property
    def first(self) -> int:
        """The first layer that continues beyond the lining, that of the body.

        It is the number of layers for a rigid shoe, none of whose layers continues.
        """
        for i, part in enumerate(self.part):
            if part in {"table", "shoe"}:
                return i
        return len(self.part)

    @property
    def contact_nodes(self) -> int:
        """Number of nodes on the contact."""
        return (len(self.angles) - 1) * self.degree + 1

    @property
    def unknowns(self) -> int:
        """Number of degrees of freedom."""
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
    """Sizes of pieces of a `length` that grow from both of its ends, with equal ones between.

    Parameters
    ----------
    length : the length
    left, right : sizes at both ends
    ratio : sizes grow by 1/ratio from the left end, and from the right without `beyond`
    largest : size of the equal pieces that is not exceeded
    beyond : sizes grow by 1/beyond from the right end
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
    """The relative size at a corner, at a distance from the contact in lengths of the contact.

    Beyond a short contact stresses fall at least as the inverse distance. If it `fades`, a corner
    may be coarser by the distance, up to a whole length. The size grows in powers of two, so that
    the bodies of nearly equal contacts are the same.
    """
    if not fades:
        return part
    return max(part, min(1.0, part * 2.0 ** math.floor(math.log2(max(distance, 1.0)))))


def ends_of(sizes: Sequence[float], start: float, end: float) -> Floats:
    """The ends (m + 1,) of pieces of these sizes from `start` on; the last one is `end`."""
    return np.append(start + np.concatenate([[0.0], np.cumsum(sizes[:-1])]), end)


def layers_of(shoe: Shoe, radius: float) -> list[ShoeLayer]:
    """The layers of a shoe from the contact inwards.

    The block between the lining and a straight beam has its least thickness.
    """
    layers = [ShoeLayer("lining", shoe.lining.thickness)]
    if isinstance(shoe.body, Beam):
        assert shoe.body.section is not None and shoe.backing is not None  # why_not
        beam_thickness = shoe.body.section.thickness
        axis = axis_of(shoe.pin.xy, shoe.actuation.point.xy)
        ends = axis.angle(np.array([shoe.lining.start, shoe.lining.end]))
        nearest = 1.0 if ends.min() < 0 < ends.max() else float(np.cos(ends).max())
        back = radius + shoe.lining.thickness
        block = axis.distance - beam_thickness / 2 - back * nearest
        return [*layers, ShoeLayer("backing", block), ShoeLayer("shoe", beam_thickness)]
    if shoe.backing is not None:
        layers.append(ShoeLayer("backing", shoe.backing.thickness))
    if shoe.body is not None:
        layers += [ShoeLayer(name, plate.thickness) for name, plate in shoe.body.plates.items()]
    return layers


def divide(
    shoe: Shoe,
    radius: float,
    level: Level,
    places: Sequence[SingularPoint] = (),
    *,
    tip: bool = False,
    powers: tuple[float, float] = (0.0, 0.0),
) -> ShoeDivision:
    """The division of a shoe.

    An end of the lining that is known to bear nothing is graded like the ends of other layers. All
    of these are coarser beyond a short contact, see `faded`.

    Parameters
    ----------
    shoe : the shoe
    radius : of the drum [m]
    level : degree and grading
    places : singular points of the pressure, growing; p may be unbounded at a kink of the gap
    tip : whether the position of the loaded end matters, which then is graded too; otherwise the
        contact feels only the force there
    powers : powers of p at the lining's ends where they press, see `corner.powers_of`
    """
    layers = layers_of(shoe, radius)
    contact = _contact_of(shoe, radius, level, layers, places)
    corners = _corners(contact, powers)
    left, right = _end_sizes(shoe, level, contact, corners)
    marks = _grading_points(shoe, radius, level, places, contact, (left, right))
    angles = []
    for a, b in pairwise(marks):
        sizes = graded(b.at - a.at, a.size, b.size, a.ratio, level.largest, b.ratio)
        angles.append(ends_of(sizes, a.at, b.at)[:-1])
    before, after = _overhangs(shoe, radius, level, layers, (left, right), tip=tip)

    # Under a short contact the layer at the face is as thick as the columns at its ends are wide.
    start, end = shoe.arc
    t = contact.thickness
    face = min(
        level.zone * min(EDGE_ZONE, t, end - start, *contact.reached),
        *(level.end * length for length in contact.lengths),
        math.inf,
    )
    face = max(face, contact.least)
    tips = [_tip(level, t, length) for _, length, kind in places if kind == Singularity.TIP]
    sharp = min(*tips, *corners)
    depths, part = _depths(
        layers,
        level,
        radius * min(face, sharp),
        radius * contact.pressed,
        fades=contact.fades,
        straight=isinstance(shoe.body, Beam),
    )
    return ShoeDivision(
        level.degree,
        np.array([*np.concatenate(angles), end]),
        before,
        after,
        depths,
        part,
        radius * sharp if sharp < face else math.inf,
    )


class _PressedArc(NamedTuple):
    """The contact of a lining as far as a division depends on it; lengths and sizes in rad.

    `thickness` is the lining's, `least` the smallest size of a column. `lengths` are those at the
    ends of contacts, `pressed` the length that rules the grading far from the contact. `beyond` are
    the distances of the outermost contacts from the lining's ends, and `reached` the lengths of
    contacts that reach them, inf where none does. `fades` says whether corners far from the contact
    may be coarser.
    """

    thickness: float
    least: float
    lengths: list[float]
    pressed: float
    beyond: tuple[float, float]
    reached: tuple[float, float]
    fades: bool


def _contact_of(
    shoe: Shoe,
    radius: float,
    level: Level,
    layers: list[ShoeLayer],
    places: Sequence[SingularPoint],
) -> _PressedArc:
    """The contact that the singular points describe; the whole lining where they have no ends.

    The level says which contacts reach an end of the lining, see `_reached`.
    """
    start, end = shoe.arc
    t = layers[0].thickness / radius
    ends = [x for x, _, kind in places if kind == Singularity.END] or [start, end]
    lengths = [length for _, length, kind in places if kind == Singularity.END]
    least = FINEST * t
    pressed = max(*lengths, least) if lengths else end - start
    # A column that is deeper than long bears a force down to its foot, and corners there feel it.
    deep = 2 * sum(layer.thickness for layer in layers) > radius * (end - start)
    # The force of one short contact follows from balance. The forces of several on an elastic shoe
    # depend on how the shoe bends, and far corners feel the bending too.
    one_short = len(lengths) == 2 and pressed < t
    fades = not deep and (shoe.body is None or one_short)
    beyond = ends[0] - start, end - ends[-1]
    reached = _reached(shoe, t, level, places)
    return _PressedArc(t, least, lengths, pressed, beyond, reached, fades)


def _corners(contact: _PressedArc, powers: tuple[float, float]) -> list[float]:
    """The sizes of columns that the corners at both ends of the lining ask for [rad]."""
    return [
        max(_corner(length, power), contact.least)
        for length, power in zip(contact.reached, powers, strict=True)
    ]


def _end_sizes(
    shoe: Shoe, level: Level, contact: _PressedArc, corners: list[float]
) -> tuple[float, float]:
    """The sizes of columns at both ends of the lining [rad]."""
    start, end = shoe.arc
    t, least = contact.thickness, contact.least
    scale = min(level.edge * min(t, 0.5 * (end - start)), level.zone * EDGE_ZONE)
    sizes = []
    for x, length, corner in zip(contact.beyond, contact.reached, corners, strict=True):
        # An open gap before the contact is two columns long at least.
        gap = max(0.5 * x, least) if x > 0 and math.isinf(length) else math.inf
        layer_end = faded(level.back, x / contact.pressed, fades=contact.fades) * min(t, x)
        without_contact = max(min(scale, gap), layer_end)
        with_contact = max(level.edge * 0.5 * length, least)
        sizes.append(min(without_contact, with_contact, corner))
    return sizes[0], sizes[1]


def _grading_points(
    shoe: Shoe,
    radius: float,
    level: Level,
    places: Sequence[SingularPoint],
    contact: _PressedArc,
    end_sizes: tuple[float, float],
) -> list[GradingPoint]:
    """The grading points along the lining: its ends, singular points, and ends of a grip."""
    start, end = shoe.arc
    first = GradingPoint(start, end_sizes[0], level.ratio)
    last = GradingPoint(end, end_sizes[1], level.ratio)
    inner = [
        _mark(level, contact.thickness, place, min(place[0] - start, end - place[0]))
        for place in places
    ]
    marks = _marks(first, last, inner)
    grip = shoe.grip(radius)
    if grip is None:
        return marks
    size = level.hinge * layers_of(shoe, radius)[-1].thickness / radius
    kept = []
    for mark in marks[1:-1]:
        if min(abs(mark.at - x) for x in grip) > max(mark.size, size):
            kept.append(mark)
    held = [GradingPoint(x, size, level.ratio) for x in grip]
    return [marks[0], *sorted([*kept, *held]), marks[-1]]


def _overhangs(
    shoe: Shoe,
    radius: float,
    level: Level,
    layers: list[ShoeLayer],
    end_sizes: tuple[float, float],
    *,
    tip: bool,
) -> tuple[Floats, Floats]:
    """Ends of the columns of the body before and behind the lining [rad], from the lining on."""
    start, end = shoe.arc
    near, far = _beyond(shoe, radius, start, end)
    before, after = np.array([start]), np.array([end])
    if layers[-1].part != "shoe":
        return before, after
    left, right = end_sizes
    body = layers[-1].thickness / radius
    held = level.hinge * body
    largest = max(body, level.largest)
    if start - near > 1e-9:
        sizes = graded(start - near, left, held, level.ratio, largest)
        before = start - ends_of(sizes, 0.0, start - near)
    if far - end > 1e-9:
        last = min(held, far - end) if tip else far - end
        sizes = graded(far - end, right, last, level.ratio, largest)
        after = end + ends_of(sizes, 0.0, far - end)
    return before, after


def _mark(level: Level, t: float, place: SingularPoint, gap: float) -> GradingPoint:
    """The grading point of a singular point.

    `t` [rad] is the lining's thickness. `gap` [rad] is the distance from the lining's end, which
    two columns at least fill. An end of the contact is rounded to half a column, so that the bodies
    of brakes that differ by less are the same. Where nothing presses, columns of half a step follow
    the cubic of the gap exactly.

    At an end of the contact p rises as the root of the distance x, and at the end of a step it goes
    as x ln x. So columns of size w leave errors in L2 that go as w and as w^1.5. Columns at a step,
    relative to the step, therefore shrink less from level to level: as the root of `end`. On brakes
    with 10 and 12 steps the root is as accurate on the second level as the power 2/3, with which
    both errors would fall alike, and takes an eighth fewer unknowns.
    """
    x, length, kind = place
    if kind == Singularity.OPEN_STEP:
        return GradingPoint(x, 0.5 * length, level.ratio)
    if kind == Singularity.STEP:
        return GradingPoint(x, length * math.sqrt(level.end), level.ratio)
    size = _column_at_end(level, t, length)
    if gap > size:
        size = min(size, 0.5 * gap)
    size = 2.0 ** math.floor(math.log2(max(size, FINEST * t)))
    if kind == Singularity.KINK:
        return GradingPoint(x, size, level.ratio)
    if kind == Singularity.TIP:
        return GradingPoint(x, _tip(level, t, length), level.ratio)
    return GradingPoint(
        round(2 * x / size) * size / 2, size, level.opening if length <= t else level.ratio
    )


def _column_at_end(level: Level, t: float, length: float) -> float:
    """Size of the columns at an end of a contact of this length [rad]; t: the lining's thickness.

    An open gap beside the contact that is shorter than such a column is not resolved on this level.
    """
    return level.end * min(length, math.sqrt(t * length))


def _tip(level: Level, t: float, length: float) -> float:
    """Size of columns and layers at a tip of the gap [rad], under a lining of thickness t [rad]."""
    size = max(tip_size(length, level.degree, level.end), FINEST * t)
    return 2.0 ** math.floor(math.log2(size))


def _corner(length: float, power: float) -> float:
    """Size of columns and layers at a corner that a contact of this length reaches [rad].

    It is inf where p is bounded at the corner or where the corner does not count.
    """
    return CORNER_SIZE * length if power < 0 and length <= CORNER_COUNTS else math.inf


def _reached(
    shoe: Shoe, t: float, level: Level, places: Sequence[SingularPoint]
) -> tuple[float, float]:
    """Lengths of the contacts that reach the lining's ends [rad]; inf where no contact does.

    A contact reaches an end of the lining if no column of the level fits into the gap between them.
    """
    start, end = shoe.arc
    near, far = [], []
    for x, length, kind in places:
        if kind == Singularity.END:
            column = _column_at_end(level, t, length)
            near += [length] * (x - start < column)
            far += [length] * (end - x < column)
    return min(near, default=math.inf), min(far, default=math.inf)


def _marks(
    start: GradingPoint, end: GradingPoint, places: Sequence[GradingPoint]
) -> list[GradingPoint]:
    """All grading points without those that stand too near to another one.

    A point is left out if it lies in the column at a lining's end, or in the smaller of the columns
    at the point and the point before. An end of the contact stays that is nearer to a step than the
    columns there are wide.
    """
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
    """Where the body begins and ends [rad].

    Beyond the lining of a straight beam the values are distances along the beam over R + t.
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
    """Ends (l + 1,) of the layers from the contact inwards, and the part of each.

    Parameters
    ----------
    layers : of the shoe
    level : its grading through the layers
    face : size of the layer at the contact [m]
    pressed : length of the contact [m]
    fades : see `faded`
    straight : whether depths count in layers, as those of a beam
    """
    depths, part, at = [np.zeros(1)], [], 0.0
    relative_depth = np.cumsum([layer.thickness for layer in layers]) / pressed
    for k, layer in enumerate(layers):
        t = layer.thickness
        outer = face
        if k > 0:
            thinner = min(t, layers[k - 1].thickness)
            outer = faded(level.back, relative_depth[k - 1], fades=fades) * thinner
        thinner = min(t, layers[k + 1].thickness) if k + 1 < len(layers) else t
        inner = faded(level.back, relative_depth[k], fades=fades) * thinner
        # The hinge holds the last layer.
        if layer.part == "shoe":
            inner = level.hinge * t
        sizes = graded(t, outer, inner, level.through, t)
        ends = ends_of(sizes, 0.0, t)[1:]
        depths.append(at + (ends / t if straight else ends))
        part += [layer.part] * len(sizes)
        at = float(depths[-1][-1])
    return np.concatenate(depths), tuple(part)
