"""The division of a shoe into hp elements: columns along its lining, layers through its thickness.

The sizes of columns and layers grow geometrically away from singular points, where the stress is
not smooth. Singular points are the lining's ends, the ends of the contact, kinks of the gap, the
ends of the interfaces between layers, and the corners of the face that the hinge holds. Such a
grading, together with a higher degree, makes the error fall exponentially (Babuska & Guo 1986;
Schwab, p- and hp-Finite Element Methods, ch. 4).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.brake.beam_axis import make_beam_axis
from drumlin.brake.brake import Shoe
from drumlin.brake.components import BeamBody
from drumlin.fem.hp.corner import element_column_size_for_error_at_pointed_gap_kink
from drumlin.response.response import UNCOMPARED_EDGE_ZONE_IN_RADIANS

SMALLEST_ELEMENT_SIZE_OVER_LINING_THICKNESS = 1e-7
"""Smallest size of a column or layer of elements, relative to the lining's thickness.

The limit is set by round-off. In a column of width w in a lining of thickness t, round-off changes
the pressure p by about 1e-16 (t/w)^2, relative to p. At w = 2e-7 t this is 2.5e-3 in the column,
and some 1e-6 of p in L2, because the column is narrow. In much smaller columns no digit of p would
be right. Columns a hundred times larger would leave an error of 1e-3 of p in L2 at a kink of the
gap that points to the drum, where the error falls as the root of w. After this limit is applied,
sizes are rounded down to a power of two, so that some columns are up to half as wide.
"""
UNRESOLVED_LENGTH_OVER_CONTACT_LENGTH = 0.02
"""Length of details of the contact that are not resolved, relative to the contact's length.

If an end of the contact moves by less than this fraction from one solution to the next, it counts
as found. A gap in the contact that is shorter than this fraction counts as closed. With a larger
value the small elements would miss the end of the contact, and the pressure would have the error of
a coarser mesh. With a smaller value the brake is divided and solved again although the end of the
contact is known well enough.
"""
ELEMENT_SIZE_AT_UNBOUNDED_CORNER = 1e-4
"""Size of element columns and layers at a corner of the lining with unbounded pressure.

The size is relative to the length of the contact at the corner. Nearer to the corner the pressure p
is given by its power law, see `corner.response_with_power_laws_at_corners`. With 1e-3 the error of
p on the second level of two brakes was 2.5 times as large. With 1e-5 the error was the same, with a
sixth more unknowns. The size must be far below 0.03 of the contact's length, because farther than
this from the corner p depends on the rest of the contact too, and not on the power law alone.
"""
HALF_FORCE_FRACTION_OF_CONTACT = 0.1632
"""Fraction of a contact, from a corner of the lining on, that bears half of the contact's force.

The pressure is assumed to go as x^(-1/2) at the distance x from the corner, and to fall to zero as
a square root at the other end. The fraction is then the median of the beta distribution with the
parameters 1/2 and 3/2. No square-integrable pressure is more concentrated at the corner.
"""
LONGEST_CONTACT_WITH_CORNER_COLUMNS = (
    UNCOMPARED_EDGE_ZONE_IN_RADIANS / HALF_FORCE_FRACTION_OF_CONTACT
)
"""Length of a contact [rad] up to which element columns shrink towards the corner that it reaches.

The corner of the lining has an unbounded pressure p. In a longer contact more than half of the
force acts farther than UNCOMPARED_EDGE_ZONE_IN_RADIANS from the corner. The error of p is then
stated for these distances alone, so that no small columns are needed at the corner.
"""

BEAM_ERROR_OVER_BLOCK_ERROR = 0.3
"""Displacement error due to a straight beam's layers of elements, over that due to its block's.

A layer of elements of the thickness w at an interface, in a body of modulus E, leaves an error of
about p w/E of the displacement under the pressure p. The layer in the beam may therefore be thicker
than the layer in the block, which lies between beam and lining, by the ratio of the two moduli
times the value given here, rounded down to a power of two. On 13 random posts (kinds "post" and
"post on ring" of `draw_random_brake`) p and torque differ from those with the block's layers by at
most 0.05 and 0.14 of their stated errors; with 3 in place of 0.3 by up to 0.45 and 0.64. The post
brake on its ring takes 0.87 times the time.
"""
COLUMNS_PER_DEGREE_OVER_MOVING_CONTACT_END = 2
"""Number of element columns over the path of a moving contact end, divided by the elements' degree.

In a shoe with a width, the end of the contact may lie at another angle at each distance from the
mid-plane. The curve on which the lining lifts off then crosses all columns over the path of the
end, so that these columns have equal widths. In a crossed element the pressure has an error that
falls in proportion to the width of the column, and polynomials of a higher degree hardly help. With
degree 3 there are six columns on the path. On five random brakes ("free" 510017, 510030 and 510039,
"built" 510037 and 510042 of `drumlin_studies.solid_error`) the first level then leaves 0.3 to
1.1 % of the pressure, in place of 0.5 to 2.5 % with columns that grow away from two ends of the
contact. The second level leaves 0.1 to 0.3 %, in place of 0.3 to 2.1 %. With four columns on the
first level and six on the second level, the errors of "free" 510030 and 510039 are 1.3 to 2 times
as large.
"""


class KindOfSingularPoint(IntEnum):
    """The kind of a singular point along the lining: which function is not smooth there.

    Attributes
    ----------
    END : the slope of the pressure is not smooth, at an end of the contact
    KINK : the slope of the gap jumps
    STEP : the curvature of the gap jumps, at an end of a step between blocks of the lining
    OPEN_STEP : as STEP, but no pressure acts at this step
    TIP : the slope of the gap jumps and the kink points to the drum; the pressure is unbounded
    """

    END = 0
    KINK = 1
    STEP = 2
    OPEN_STEP = 3
    TIP = 4


class SingularPoint(NamedTuple):
    """A singular point: a position along the lining where the pressure or the gap is not smooth.

    Attributes
    ----------
    position : position phi of the point [rad]
    length : length over which the pressure changes at the point [rad], by the kind of the point.
        END: length of the contact, or of the open gap beside it; KINK: length of the lining; STEP
        and OPEN_STEP: length of the step; TIP: (N/c)^2, where N is the L2 norm of the pressure and
        c ln(1/x) the pressure at the distance x from the point.
    kind : which function is not smooth
    path : distance from this point to the other end of a path [rad]. At one end of the path the
        contact ends in the mid-plane or at the side of the lining, and between both ends of the
        path it ends at the other distances from the mid-plane. The path is 0 if the contact ends at
        one angle.
    """

    position: float
    length: float
    kind: KindOfSingularPoint
    path: float = 0.0


class ElementGradingPoint(NamedTuple):
    """A position along the lining at which two element columns meet, with small columns around it.

    The sizes of the columns grow geometrically away from the point in both directions.

    Attributes
    ----------
    position : position phi of the point [rad]
    column_size : size of the columns on both sides of the point [rad]
    size_ratio_of_columns : size of a column relative to the size of the next column away from the
        point, below 1
    """

    position: float
    column_size: float
    size_ratio_of_columns: float


@dataclass(frozen=True)
class RefinementLevel:
    """A level of refinement: the degree of hp elements, and sizes of their columns and layers.

    A column is a stack of elements through the thickness of a body. Sizes grow geometrically away
    from points where the stress is singular.

    Attributes
    ----------
    degree : degree of the hp elements
    face_layer_size : size of the layer of elements at the lining's face, relative to
        UNCOMPARED_EDGE_ZONE_IN_RADIANS, or to the lining's thickness or the contact's length if
        these are less. Columns at a lining's end that the contact reaches are no wider than
        `face_layer_size` times UNCOMPARED_EDGE_ZONE_IN_RADIANS, even if `lining_end_column_size`
        gives a larger size.
    lining_end_column_size : size of the columns at the lining's ends, relative to the lining's
        thickness or to half its length, whichever is less. At an end that a contact reaches, the
        size is relative to half the contact's length.
    contact_end_column_size : size of the columns at ends of the contact and at kinks of the gap. It
        is relative to the contact's length, or to the geometric mean of this length and the
        lining's thickness if the mean is less. The pressure rises from an end of the contact over a
        distance of about the thickness, which matters less in a longer contact.
    column_size_ratio : size of a column relative to the next column away from a singular point,
        below 1
    size_ratio_at_short_contacts : as `column_size_ratio`, at the ends of a contact (or open gap)
        shorter than the lining is thick
    largest_column : upper limit of the size of a column [rad]
    interface_layer_size : size of the layers of elements at the interface of two layers of the
        shoe, relative to the thinner one of these two layers
    hinge_column_size : size of columns and layers of elements at the face that the hinge holds,
        relative to the body's thickness
    layer_size_ratio : size of a layer of elements relative to the next layer away from an
        interface, below 1
    """

    degree: int
    face_layer_size: float
    lining_end_column_size: float
    contact_end_column_size: float
    column_size_ratio: float
    size_ratio_at_short_contacts: float
    largest_column: float
    interface_layer_size: float
    hinge_column_size: float
    layer_size_ratio: float

    @property
    def pressure_error_due_to_column_size_ratio(self) -> float:
        """The relative error in L2 of the pressure due to the ratio of neighbouring column sizes.

        `levels.RuleOfDegreeAndGradingByLevel` derives the formula.
        """
        root = math.sqrt(self.column_size_ratio)
        return ((1 - root) / (1 + root)) ** self.degree


@dataclass(frozen=True)
class ShoeLayer:
    """A layer of a shoe: the name of its `part` ("lining", "shoe", ...) and its `thickness` [m]."""

    part: str
    thickness: float


@dataclass(frozen=True)
class ShoeElementDivision:
    """The division of a shoe into m columns and l layers of hp elements.

    Attributes
    ----------
    degree : degree of the elements
    angles : (m + 1,) positions phi of the ends of the columns under the lining [rad], or under all
        linings and in the slots between them. In a slot the shoe has its body only.
    column_ends_before_lining, column_ends_behind_lining : positions phi of the ends of the columns
        of the body before and behind the lining [rad], the nearest to the lining first
    depths : (l + 1,) distances of the faces of the layers from the lining's face [m]. For a
        straight beam the depth has no unit: layer k of the shoe (lining, backing, beam; k = 0, 1,
        2) reaches from the depth k to the depth k + 1.
    part : (l,) name of the part of the shoe that each layer of elements belongs to
    face_layer_size_at_unbounded_pressure : size [m] of the layer of elements at the lining's face,
        if this layer is thin because the pressure is unbounded (at a corner of the lining, or at a
        gap kink that points to the drum); inf if the pressure is bounded
    slots : for each slot between two linings, the indices of its first column, and of the first
        column behind the slot
    open_columns : indices of columns under the lining whose face is expected to stay open. Of the
        contact nodes of such a column, the condensation of a shoe with a width keeps only those at
        its two ends.
    """

    degree: int
    angles: Floats
    column_ends_before_lining: Floats
    column_ends_behind_lining: Floats
    depths: Floats
    part: tuple[str, ...]
    face_layer_size_at_unbounded_pressure: float = math.inf
    slots: tuple[tuple[int, int], ...] = ()
    open_columns: tuple[int, ...] = ()

    @property
    def element_column_range_of_each_lining(self) -> list[tuple[int, int]]:
        """For each lining, the range of its columns: the indices (start, stop).

        `start` is the index of its first column, `stop` of the first column behind the lining.
        """
        ends = [0, *(column for slot in self.slots for column in slot), len(self.angles) - 1]
        return list(zip(ends[::2], ends[1::2], strict=True))

    @property
    def element_column_ends_on_each_lining(self) -> list[Floats]:
        """The positions phi of the ends of the columns under each lining [rad]."""
        return [
            self.angles[first : last + 1]
            for first, last in self.element_column_range_of_each_lining
        ]

    @property
    def dictionary_key_of_division(
        self,
    ) -> tuple[int, bytes, bytes, bytes, bytes, tuple[int, ...]]:
        """A dictionary key of the division, which only equal divisions of the shoe share."""
        return (
            self.degree,
            self.angles.tobytes(),
            self.column_ends_before_lining.tobytes(),
            self.column_ends_behind_lining.tobytes(),
            self.depths.tobytes(),
            self.open_columns,
        )

    @property
    def number_of_element_layers(self) -> int:
        """Number of layers of elements through the thickness of the shoe and its lining."""
        return len(self.part)

    @property
    def index_of_first_body_layer(self) -> int:
        """The index of the first layer of elements that belongs to the body of the shoe.

        Layers are counted from 0 at the contact. Only the body continues beyond the lining's ends.
        For a rigid shoe, which has no body of elements, the count of all layers is returned.
        """
        for i, part in enumerate(self.part):
            if part in {"table", "shoe"}:
                return i
        return len(self.part)

    @property
    def contact_nodes(self) -> int:
        """Number of nodes on the faces of all linings."""
        return sum(
            (len(ends) - 1) * self.degree + 1 for ends in self.element_column_ends_on_each_lining
        )

    @property
    def indices_of_kept_contact_nodes(self) -> Ints:
        """The indices of the contact nodes that are not within an open column.

        A shoe with open columns has a single lining.
        """
        kept = np.ones(self.contact_nodes, dtype=bool)
        for column in self.open_columns:
            kept[column * self.degree + 1 : (column + 1) * self.degree] = False
        return np.flatnonzero(kept)


def element_sizes_growing_from_both_ends(
    length: float,
    left: float,
    right: float,
    ratio: float,
    largest: float,
    right_ratio: float | None = None,
) -> list[float]:
    """The sizes of pieces that fill a `length`, small at both ends and equal in the middle.

    Parameters
    ----------
    length : length that the pieces fill
    left, right : sizes of the first and of the last piece
    ratio : size of a piece relative to the next one, counted from the left end, below 1
    largest : upper limit of the size of the equal pieces in the middle
    right_ratio : size of a piece relative to the next one, counted from the right end; None if it
        equals `ratio`
    """
    right_ratio = right_ratio or ratio
    first: list[float] = []
    last: list[float] = []
    while True:
        # Add the next piece at the end where it is smaller, as long as enough length is left.
        rest = length - math.fsum(first) - math.fsum(last)
        smaller = min(left, right)
        if smaller >= largest or rest <= 1.6 * smaller:
            break
        if left <= right:
            first.append(left)
            left /= ratio
        else:
            last.append(right)
            right /= right_ratio
    # The length that is left is filled with equal pieces, at most 1.6 times as large as the next
    # graded piece.
    count = max(1, math.ceil(rest / min(largest, 1.6 * smaller) - 1e-9))
    return [*first, *[rest / count] * count, *last[::-1]]


def relative_element_size_far_from_contact(
    size: float, distance: float, *, coarsens: bool
) -> float:
    """The size of elements at a corner of a layer far from the contact, relative to the thickness.

    Beyond a short contact, stresses fall at least in proportion to 1/distance. The size may
    therefore grow in proportion to the distance, up to 1, a whole layer. It grows in powers of two,
    so that shoes with nearly equal contacts have the same mesh, and one condensed body serves both.

    Parameters
    ----------
    size : size of the elements beside the contact, relative to the layer's thickness
    distance : distance of the corner from the contact, in lengths of the contact
    coarsens : whether the size grows with the distance; if False, `size` is returned
    """
    if not coarsens:
        return size
    doublings = math.floor(math.log2(max(distance, 1.0)))
    return max(size, min(1.0, size * 2.0**doublings))


def interval_ends_from_interval_sizes(sizes: Sequence[float], start: float, end: float) -> Floats:
    """The ends (m + 1,) of m pieces in a row, from their sizes (m,), between `start` and `end`."""
    return np.append(start + np.concatenate([[0.0], np.cumsum(sizes[:-1])]), end)


def shoe_layers_with_their_thickness(shoe: Shoe, radius: float) -> list[ShoeLayer]:
    """The layers of a shoe with their thickness, from the lining to the shoe's back.

    The block between the lining and a straight beam counts as a layer with its smallest thickness.
    `radius` is the radius of the drum [m].
    """
    layers = [ShoeLayer("lining", shoe.lining.thickness)]
    if isinstance(shoe.body, BeamBody):
        # `reason_against_finite_element_model` refuses beams without section or block, so that the
        # assertion holds.
        assert shoe.body.section is not None and shoe.backing is not None
        beam_thickness = shoe.body.section.thickness
        axis = make_beam_axis(shoe.pin.xy, shoe.actuation.point.xy)
        ends = axis.angle(np.array([shoe.lining.start, shoe.lining.end]))
        nearest = 1.0 if ends.min() < 0 < ends.max() else float(np.cos(ends).max())
        back = radius + shoe.lining.thickness
        block = axis.distance_from_drum_centre - beam_thickness / 2 - back * nearest
        return [*layers, ShoeLayer("backing", block), ShoeLayer("shoe", beam_thickness)]
    if shoe.backing is not None:
        layers.append(ShoeLayer("backing", shoe.backing.thickness))
    if shoe.body is not None:
        layers += [ShoeLayer(name, plate.thickness) for name, plate in shoe.body.plates.items()]
    return layers


def divide_shoe_into_hp_elements(
    shoe: Shoe,
    radius: float,
    level: RefinementLevel,
    points: Sequence[SingularPoint] = (),
    *,
    grades_loaded_end: bool = False,
    exponents: tuple[float, float] = (0.0, 0.0),
) -> ShoeElementDivision:
    """The division of a shoe into columns and layers of hp elements.

    If the contact does not reach an end of the lining, the elements at this end get the size of
    elements at interfaces between layers. Far from a short contact, the elements at the lining's
    end and at interfaces are larger, see `relative_element_size_far_from_contact`.

    Parameters
    ----------
    shoe : the shoe
    radius : radius of the drum [m]
    level : degree of the elements, and sizes of columns and layers
    points : singular points along the lining, in the order of their positions
    grades_loaded_end : whether columns become smaller towards the end of the body on which the
        actuation force acts. The contact pressure does not need this, because it depends on the
        resultant force only; derivatives with respect to the position of this end need it.
    exponents : exponents a of the pressure p ~ x^a at the corners of the lining, at its start and
        its end, if the corners are in contact
    """
    layers = shoe_layers_with_their_thickness(shoe, radius)
    # Each lining has contacts, grading points and columns of its own.
    found = [
        _divide_one_lining_into_element_columns(shoe, radius, level, points, exponents, arc)
        for arc in shoe.arcs
    ]
    angles, slots = _element_column_ends_under_linings_and_slots(shoe, radius, level, found)
    before, after = _element_column_ends_before_and_behind_lining(
        shoe,
        radius,
        level,
        layers,
        (found[0].column_sizes_at_lining_ends[0], found[-1].column_sizes_at_lining_ends[1]),
        grades_loaded_end=grades_loaded_end,
    )
    first_layer_size_at_lining_face = min(
        lining.first_layer_size_at_lining_face for lining in found
    )
    smallest_at_tips = min(lining.smallest_column_size_at_tips for lining in found)
    smallest_at_corners = min(lining.smallest_column_size_at_corners for lining in found)
    smallest_at_singularity = min(smallest_at_tips, smallest_at_corners)
    depths, part = _depths_and_parts_of_element_layers(
        layers,
        level,
        radius * min(first_layer_size_at_lining_face, smallest_at_tips),
        radius * smallest_at_corners,
        radius * max(lining.contact.longest for lining in found),
        coarsens=all(lining.contact.may_coarsen_far_from_contact for lining in found),
        thickening=_largest_ratio_of_beam_to_block_layers(shoe),
        straight=isinstance(shoe.body, BeamBody),
    )
    return ShoeElementDivision(
        degree=level.degree,
        angles=angles,
        column_ends_before_lining=before,
        column_ends_behind_lining=after,
        depths=depths,
        part=part,
        face_layer_size_at_unbounded_pressure=radius * smallest_at_singularity
        if smallest_at_singularity < first_layer_size_at_lining_face
        else math.inf,
        slots=slots,
    )


class _LiningElementDivision(NamedTuple):
    """The division of one of a shoe's linings into element columns; all sizes are in rad.

    Attributes
    ----------
    contact : extent of the lining's contacts
    angles : (m + 1,) ends of the element columns under the lining
    column_sizes_at_lining_ends : sizes of the columns at the lining's start and end
    first_layer_size_at_lining_face : size of the layer of elements at the lining's face if the
        pressure is bounded
    smallest_column_size_at_tips : size of the smallest column at a gap kink that points to the
        drum; inf without such a kink
    smallest_column_size_at_corners : size of the smallest column at a corner of the lining with
        unbounded pressure; inf if the pressure is bounded at the corners
    """

    contact: "_ContactExtent"
    angles: Floats
    column_sizes_at_lining_ends: tuple[float, float]
    first_layer_size_at_lining_face: float
    smallest_column_size_at_tips: float
    smallest_column_size_at_corners: float


def _divide_one_lining_into_element_columns(
    shoe: Shoe,
    radius: float,
    level: RefinementLevel,
    points: Sequence[SingularPoint],
    exponents: tuple[float, float],
    arc: tuple[float, float],
) -> _LiningElementDivision:
    """The division into element columns of the lining that covers `arc` (phi_1, phi_2) [rad].

    Parameters
    ----------
    shoe : the shoe
    radius : radius of the drum [m]
    level : degree of the elements, and sizes of columns and layers
    points : singular points on all linings of the shoe
    exponents : exponents of the pressure at the corners of the lining, at its start and its end
    arc : positions of the lining's start and end [rad]
    """
    own = [
        point
        for point in points
        if _is_lining_on_arc_nearest_to_position(shoe, arc, point.position)
    ]
    contact = _extent_of_lining_contacts(shoe, radius, level, own, arc)
    corner_sizes = _element_column_sizes_at_corners(contact, exponents)
    column_sizes_at_lining_ends = _element_column_sizes_at_lining_ends(level, contact, corner_sizes)
    grading_points = _grading_points_along_lining(
        shoe, radius, level, own, contact, column_sizes_at_lining_ends
    )
    # At points with unbounded pressure the columns are as narrow as `tip_sizes` and `corner_sizes`
    # say. The layer of elements at the lining's face is then as thick as the narrowest column is
    # wide.
    tip_sizes = _element_column_sizes_at_pointed_gap_kinks(level, contact, own)
    return _LiningElementDivision(
        contact=contact,
        angles=_element_column_ends_between_grading_points(
            grading_points, level, _paths_with_equal_element_columns(level, contact.thickness, own)
        ),
        column_sizes_at_lining_ends=column_sizes_at_lining_ends,
        first_layer_size_at_lining_face=_size_of_first_element_layer_at_lining_face(level, contact),
        smallest_column_size_at_tips=min(tip_sizes, default=math.inf),
        smallest_column_size_at_corners=min(corner_sizes),
    )


def _is_lining_on_arc_nearest_to_position(shoe: Shoe, arc: tuple[float, float], phi: float) -> bool:
    """Whether the lining on `arc` is the shoe's nearest lining to the position phi [rad].

    `arc` (start, end) are positions [rad].
    """
    distances = {other: max(other[0] - phi, phi - other[1]) for other in shoe.arcs}
    return distances[arc] == min(distances.values())


def _element_column_ends_under_linings_and_slots(
    shoe: Shoe, radius: float, level: RefinementLevel, linings: Sequence[_LiningElementDivision]
) -> tuple[Floats, tuple[tuple[int, int], ...]]:
    """The ends (m + 1,) [rad] of the m columns under linings and in slots, and each slot's columns.

    In a slot between two linings the columns grow from both linings towards the slot's middle. A
    slot is given by the index of its first column, and of the first column behind the slot.

    Parameters
    ----------
    shoe : the shoe
    radius : radius of the drum [m]
    level : degree of the elements, and sizes of columns and layers
    linings : divisions of the linings in the order of their positions
    """
    angles, slots = [linings[0].angles], []
    columns = len(linings[0].angles) - 1
    grip_size = _element_column_size_at_ends_of_grip(shoe, radius, level)
    for before, lining in pairwise(linings):
        first = ElementGradingPoint(
            float(before.angles[-1]), before.column_sizes_at_lining_ends[1], level.column_size_ratio
        )
        last = ElementGradingPoint(
            float(lining.angles[0]), lining.column_sizes_at_lining_ends[0], level.column_size_ratio
        )
        in_slot = [
            at
            for at in shoe.interval_of_body_back_held_by_support(radius) or ()
            if first.position < at < last.position
        ]
        grip_ends = [ElementGradingPoint(at, grip_size, level.column_size_ratio) for at in in_slot]
        ends = _element_column_ends_between_grading_points([first, *grip_ends, last], level)
        angles += [ends[1:], lining.angles[1:]]
        slots.append((columns, columns + len(ends) - 1))
        columns += len(ends) + len(lining.angles) - 2
    return np.concatenate(angles), tuple(slots)


def _element_column_sizes_at_pointed_gap_kinks(
    level: RefinementLevel, contact: "_ContactExtent", points: Sequence[SingularPoint]
) -> list[float]:
    """The sizes [rad] of the element columns at all kinks of the gap that point to the drum.

    Among the singular `points` these kinks have the kind TIP.
    """
    tips = [point for point in points if point.kind == KindOfSingularPoint.TIP]
    return [
        _element_column_size_at_pointed_gap_kink(level, contact.thickness, tip.length)
        for tip in tips
    ]


class _PathWithEqualElementColumns(NamedTuple):
    """A path of a contact's end from `start` to `end` [rad], with the size [rad] of its columns."""

    start: float
    end: float
    column_size: float


def _paths_with_equal_element_columns(
    level: RefinementLevel, thickness: float, points: Sequence[SingularPoint]
) -> list[_PathWithEqualElementColumns]:
    """The paths of the ends of contacts among the singular `points` of a lining.

    `thickness` is the thickness of the lining [rad].
    """
    paths = []
    for point in points:
        if point.path:
            start, end = sorted((point.position, point.position + point.path))
            size = _element_column_size_on_path_of_contact_end(level, thickness, point)
            paths.append(_PathWithEqualElementColumns(start, end, size))
    return paths


def _element_column_size_on_path_of_contact_end(
    level: RefinementLevel, thickness: float, point: SingularPoint
) -> float:
    """The size [rad] of the equal element columns on the path of a contact's end.

    It is at least the size of columns at an end that does not move. `thickness` is the thickness of
    the lining [rad].
    """
    count = COLUMNS_PER_DEGREE_OVER_MOVING_CONTACT_END * level.degree
    smallest = _element_column_size_at_contact_end(level, thickness, point.length)
    return max(abs(point.path) / count, smallest)


def _element_column_ends_between_grading_points(
    points: list[ElementGradingPoint],
    level: RefinementLevel,
    paths: Sequence[_PathWithEqualElementColumns] = (),
) -> Floats:
    """The ends (m + 1,) [rad] of the element columns from the first grading point to the last.

    On the `paths` of the ends of contacts the columns are no wider than the columns of the path.
    """
    ends = []
    for a, b in pairwise(points):
        middle = 0.5 * (a.position + b.position)
        sizes_on_paths = [path.column_size for path in paths if path.start < middle < path.end]
        sizes = element_sizes_growing_from_both_ends(
            b.position - a.position,
            a.column_size,
            b.column_size,
            a.size_ratio_of_columns,
            min(level.largest_column, *sizes_on_paths, math.inf),
            b.size_ratio_of_columns,
        )
        ends.append(interval_ends_from_interval_sizes(sizes, a.position, b.position)[:-1])
    return np.append(np.concatenate(ends), points[-1].position)


def _size_of_first_element_layer_at_lining_face(
    level: RefinementLevel, contact: "_ContactExtent"
) -> float:
    """The size [rad] of the layer of elements at the lining's face if the pressure is bounded.

    Under a short contact the layer is as thick as the columns at the contact's ends are wide. Equal
    columns on the path of an end count as well.

    Parameters
    ----------
    level : the degree and sizes of the shoe's elements
    contact : lengths and positions of the lining's contacts
    """
    start, end = contact.arc
    size = min(
        level.face_layer_size
        * min(
            UNCOMPARED_EDGE_ZONE_IN_RADIANS,
            contact.thickness,
            end - start,
            *contact.lengths_of_contacts_at_lining_ends,
        ),
        *contact.sizes_of_first_layer_under_ends,
        math.inf,
    )
    return max(size, contact.smallest_column)


class _ContactExtent(NamedTuple):
    """The lengths and positions of a lining's contacts, for its division into elements.

    All lengths and sizes are in rad.

    Attributes
    ----------
    arc : positions of the lining's start and end
    thickness : thickness of the lining
    smallest_column : smallest allowed size of an element column
    lengths : for each end of a contact the length of this contact
    sizes_of_first_layer_under_ends : for each end of a contact the largest size of the layer of
        elements at the lining's face
    longest : length of the longest contact, on which the sizes of elements far from the contact
        depend; the length of the lining if no contact is known
    contact_distances_from_lining_ends : distance of the first contact from the lining's start, and
        of the last contact from the lining's end
    lengths_of_contacts_at_lining_ends : lengths of the contacts that reach the lining's start and
        end; inf for an end that no contact reaches
    may_coarsen_far_from_contact : whether elements at corners far from the contact may be larger
    """

    arc: tuple[float, float]
    thickness: float
    smallest_column: float
    lengths: list[float]
    sizes_of_first_layer_under_ends: list[float]
    longest: float
    contact_distances_from_lining_ends: tuple[float, float]
    lengths_of_contacts_at_lining_ends: tuple[float, float]
    may_coarsen_far_from_contact: bool


def _extent_of_lining_contacts(
    shoe: Shoe,
    radius: float,
    level: RefinementLevel,
    points: Sequence[SingularPoint],
    arc: tuple[float, float],
) -> _ContactExtent:
    """The lengths and positions of a lining's contacts, from the singular points at their ends.

    If no singular point is an end of a contact, the contact is assumed to cover the whole lining.

    Parameters
    ----------
    shoe : the shoe
    radius : radius of the drum [m]
    level : degree of the elements, and sizes of columns and layers
    points : singular points on the lining
    arc : positions of the lining's start and end [rad]
    """
    layers = shoe_layers_with_their_thickness(shoe, radius)
    start, end = arc
    t = layers[0].thickness / radius
    contact_ends = [point for point in points if point.kind == KindOfSingularPoint.END]
    positions = [point.position for point in contact_ends] or [start, end]
    lengths = [point.length for point in contact_ends]
    smallest_column = SMALLEST_ELEMENT_SIZE_OVER_LINING_THICKNESS * t
    longest = max(*lengths, smallest_column) if lengths else end - start
    # In a shoe whose thickness is more than half its length, the contact force still stresses the
    # corners at the shoe's back.
    deep = 2 * sum(layer.thickness for layer in layers) > radius * (end - start)
    # The force of one short contact follows from balance alone. The forces of several contacts on
    # an elastic shoe depend on how the shoe bends, and so on the stress at far corners.
    one_short = len(lengths) == 2 and longest < t and len(shoe.arcs) == 1
    return _ContactExtent(
        arc=arc,
        thickness=t,
        smallest_column=smallest_column,
        lengths=lengths,
        sizes_of_first_layer_under_ends=[
            _element_column_size_on_path_of_contact_end(level, t, point)
            if point.path
            else level.contact_end_column_size * point.length
            for point in contact_ends
        ],
        longest=longest,
        contact_distances_from_lining_ends=(positions[0] - start, end - positions[-1]),
        lengths_of_contacts_at_lining_ends=_shortest_contact_lengths_at_lining_ends(
            arc, t, level, contact_ends
        ),
        may_coarsen_far_from_contact=not deep and (shoe.body is None or one_short),
    )


def _element_column_sizes_at_corners(
    contact: _ContactExtent, exponents: tuple[float, float]
) -> tuple[float, float]:
    """The sizes of the element columns [rad] that unbounded pressures at the lining's corners need.

    The first size is for the corner at the lining's start, the second for its end. A size is inf if
    the pressure is bounded at the corner, or if the contact is so long that the stated error
    excludes the corner. `exponents` are the exponents a of the pressure p ~ x^a at the distance x
    from both corners.
    """
    sizes = []
    for length, exponent in zip(contact.lengths_of_contacts_at_lining_ends, exponents, strict=True):
        graded = exponent < 0 and length <= LONGEST_CONTACT_WITH_CORNER_COLUMNS
        size = ELEMENT_SIZE_AT_UNBOUNDED_CORNER * length if graded else math.inf
        sizes.append(max(size, contact.smallest_column))
    return sizes[0], sizes[1]


def _element_column_sizes_at_lining_ends(
    level: RefinementLevel, contact: _ContactExtent, corner_sizes: tuple[float, float]
) -> tuple[float, float]:
    """The sizes of the element columns at the lining's start and end [rad].

    Parameters
    ----------
    level : the degree and sizes of the shoe's elements
    contact : extent of the contact
    corner_sizes : sizes of columns that unbounded pressures at both corners need [rad]
    """
    start, end = contact.arc
    t, smallest = contact.thickness, contact.smallest_column
    pressed_size = min(
        level.lining_end_column_size * min(t, 0.5 * (end - start)),
        level.face_layer_size * UNCOMPARED_EDGE_ZONE_IN_RADIANS,
    )
    sizes = []
    both_ends = zip(
        contact.contact_distances_from_lining_ends,
        contact.lengths_of_contacts_at_lining_ends,
        corner_sizes,
        strict=True,
    )
    for open_length, reaching_length, corner_size in both_ends:
        # If the gap is open at the lining's end, at least two columns lie between this end and the
        # contact.
        is_open = open_length > 0 and math.isinf(reaching_length)
        gap_size = max(0.5 * open_length, smallest) if is_open else math.inf
        size_without_force = relative_element_size_far_from_contact(
            level.interface_layer_size,
            open_length / contact.longest,
            coarsens=contact.may_coarsen_far_from_contact,
        ) * min(t, open_length)
        without_contact = max(min(pressed_size, gap_size), size_without_force)
        with_contact = max(level.lining_end_column_size * 0.5 * reaching_length, smallest)
        sizes.append(min(without_contact, with_contact, corner_size))
    return sizes[0], sizes[1]


def _grading_points_along_lining(
    shoe: Shoe,
    radius: float,
    level: RefinementLevel,
    points: Sequence[SingularPoint],
    contact: _ContactExtent,
    column_sizes_at_lining_ends: tuple[float, float],
) -> list[ElementGradingPoint]:
    """The grading points along the lining, in the order of their positions.

    Element columns become smaller towards these points: the lining's ends, the singular points, and
    the ends of a grip that holds the shoe's back.

    Parameters
    ----------
    shoe : the shoe
    radius : radius of the drum [m]
    level : degree of the elements, and sizes of columns and layers
    points : singular points along the lining, in the order of their positions
    contact : extent of the contact
    column_sizes_at_lining_ends : sizes of the columns at the lining's start and end [rad]
    """
    start, end = contact.arc
    first = ElementGradingPoint(start, column_sizes_at_lining_ends[0], level.column_size_ratio)
    last = ElementGradingPoint(end, column_sizes_at_lining_ends[1], level.column_size_ratio)
    inner = []
    for point in points:
        distance = min(point.position - start, end - point.position)
        inner.append(grading_point_at_singular_point(point, level, contact.thickness, distance))
    grading_points = _grading_points_without_close_ones(first, last, inner)
    grip = shoe.interval_of_body_back_held_by_support(radius)
    if grip is None:
        return grading_points
    # The ends of the grip, which is the part of the back that the support holds, are grading
    # points. They replace other grading points that are too near to them.
    grip_size = _element_column_size_at_ends_of_grip(shoe, radius, level)
    kept = []
    for candidate in grading_points[1:-1]:
        distance = min(abs(candidate.position - end_of_grip) for end_of_grip in grip)
        if distance > max(candidate.column_size, grip_size):
            kept.append(candidate)
    on_lining = [end_of_grip for end_of_grip in grip if start < end_of_grip < end]
    grip_ends = [
        ElementGradingPoint(end_of_grip, grip_size, level.column_size_ratio)
        for end_of_grip in on_lining
    ]
    return [grading_points[0], *sorted([*kept, *grip_ends]), grading_points[-1]]


def _element_column_size_at_ends_of_grip(
    shoe: Shoe, radius: float, level: RefinementLevel
) -> float:
    """The size [rad] of the element columns at the ends of a grip that holds the shoe's back."""
    return (
        level.hinge_column_size
        * shoe_layers_with_their_thickness(shoe, radius)[-1].thickness
        / radius
    )


def _element_column_ends_before_and_behind_lining(
    shoe: Shoe,
    radius: float,
    level: RefinementLevel,
    layers: list[ShoeLayer],
    column_sizes_at_lining_ends: tuple[float, float],
    *,
    grades_loaded_end: bool,
) -> tuple[Floats, Floats]:
    """The ends of the element columns of a shoe's body before and behind the lining [rad].

    The nearest end to the lining comes first. The body reaches beyond the lining towards the hinge
    and towards the actuation force.

    Parameters
    ----------
    shoe : the shoe
    radius : radius of the drum [m]
    level : degree of the elements, and sizes of columns and layers
    grades_loaded_end : whether columns become smaller towards the end of the body on which the
        actuation force acts
    layers : layers of the shoe
    column_sizes_at_lining_ends : sizes of the columns at the lining's start and end [rad]
    """
    start, end = shoe.arc
    near, far = _positions_of_shoe_body_ends(shoe, radius)
    before, after = np.array([start]), np.array([end])
    if layers[-1].part != "shoe":
        return before, after
    left, right = column_sizes_at_lining_ends
    body = layers[-1].thickness / radius
    size_at_hinge = level.hinge_column_size * body
    largest = max(body, level.largest_column)
    # A body that ends with the lining, up to round-off, has no columns beyond it.
    if start - near > 1e-9:
        sizes = element_sizes_growing_from_both_ends(
            start - near, left, size_at_hinge, level.column_size_ratio, largest
        )
        before = start - interval_ends_from_interval_sizes(sizes, 0.0, start - near)
    if far - end > 1e-9:
        size_at_load = min(size_at_hinge, far - end) if grades_loaded_end else far - end
        sizes = element_sizes_growing_from_both_ends(
            far - end, right, size_at_load, level.column_size_ratio, largest
        )
        after = end + interval_ends_from_interval_sizes(sizes, 0.0, far - end)
    return before, after


def grading_point_at_singular_point(
    point: SingularPoint, level: RefinementLevel, thickness: float, distance: float
) -> ElementGradingPoint:
    """The grading point at a singular point: its position, and the size of the columns beside it.

    The position of an end of the contact is rounded to half an element column, so that brakes with
    nearly equal contacts have the same mesh. At a step without pressure, columns of half the step's
    length represent the gap, which is a cubic polynomial there, exactly.

    At an end of the contact the pressure p rises as the root of the distance x, and at the end of a
    step p goes as x ln x. Columns of size w therefore leave errors in L2 in proportion to w and to
    w^1.5. The columns at a step can therefore shrink less from level to level than the columns at
    an end of the contact: their size relative to the step is the square root of
    `contact_end_column_size`. With the power 2/3 in place of 1/2 both errors would fall at the same
    rate. On brakes with 10 and 12 steps the power 1/2 was as accurate on the second level, with an
    eighth fewer unknowns.

    Parameters
    ----------
    point : the singular point
    level : degree of the elements, and sizes of columns and layers
    thickness : thickness of the lining [rad]
    distance : distance of the point from the nearer end of the lining [rad]; at least two columns
        fit into it
    """
    if point.kind == KindOfSingularPoint.OPEN_STEP:
        return ElementGradingPoint(point.position, 0.5 * point.length, level.column_size_ratio)
    if point.kind == KindOfSingularPoint.STEP:
        return ElementGradingPoint(
            point.position,
            point.length * math.sqrt(level.contact_end_column_size),
            level.column_size_ratio,
        )
    if point.kind == KindOfSingularPoint.TIP:
        size = _element_column_size_at_pointed_gap_kink(level, thickness, point.length)
        return ElementGradingPoint(point.position, size, level.column_size_ratio)
    if point.path:
        size = _element_column_size_on_path_of_contact_end(level, thickness, point)
        return ElementGradingPoint(point.position, size, level.column_size_ratio)
    # The size at an end of the contact or at a kink is rounded to a power of two, so that similar
    # brakes have equal meshes.
    size = _element_column_size_at_contact_end(level, thickness, point.length)
    if distance > size:
        size = min(size, 0.5 * distance)
    size = 2.0 ** math.floor(
        math.log2(max(size, SMALLEST_ELEMENT_SIZE_OVER_LINING_THICKNESS * thickness))
    )
    if point.kind == KindOfSingularPoint.KINK:
        return ElementGradingPoint(point.position, size, level.column_size_ratio)
    ratio = (
        level.size_ratio_at_short_contacts if point.length <= thickness else level.column_size_ratio
    )
    return ElementGradingPoint(round(2 * point.position / size) * size / 2, size, ratio)


def _element_column_size_at_contact_end(
    level: RefinementLevel, thickness: float, length: float
) -> float:
    """The size of the element columns at an end of a contact [rad].

    An open gap beside the contact that is shorter than this size is not resolved by the mesh.
    `thickness` is the thickness of the lining, and `length` the length of the contact, both in rad.
    """
    return level.contact_end_column_size * min(length, math.sqrt(thickness * length))


def _element_column_size_at_pointed_gap_kink(
    level: RefinementLevel, thickness: float, length: float
) -> float:
    """The size [rad] of element columns at a kink of the gap that points to the drum.

    At such a kink the pressure is unbounded. The size is a power of two.

    Parameters
    ----------
    level : degree of the elements, and sizes of columns and layers
    thickness : thickness of the lining [rad]
    length : the length (N/c)^2 [rad], where N is the L2 norm of the pressure and c ln(1/x) the
        pressure at the distance x from the kink
    """
    size = element_column_size_for_error_at_pointed_gap_kink(
        length, level.degree, level.contact_end_column_size
    )
    return 2.0 ** math.floor(
        math.log2(max(size, SMALLEST_ELEMENT_SIZE_OVER_LINING_THICKNESS * thickness))
    )


def _shortest_contact_lengths_at_lining_ends(
    arc: tuple[float, float],
    thickness: float,
    level: RefinementLevel,
    contact_ends: Sequence[SingularPoint],
) -> tuple[float, float]:
    """The lengths of the shortest contacts that reach the lining's start and end [rad].

    A contact reaches an end of the lining if no element column fits between the contact and this
    end. The length is inf for an end of the lining that no contact reaches.

    Parameters
    ----------
    arc : positions of the lining's start and end [rad]
    thickness : thickness of the lining [rad]
    level : the degree and sizes of the shoe's elements
    contact_ends : singular points at the ends of contacts
    """
    start, end = arc
    at_start, at_end = [], []
    for point in contact_ends:
        column = _element_column_size_at_contact_end(level, thickness, point.length)
        if point.position - start < column:
            at_start.append(point.length)
        if end - point.position < column:
            at_end.append(point.length)
    return min(at_start, default=math.inf), min(at_end, default=math.inf)


def _grading_points_without_close_ones(
    start: ElementGradingPoint, end: ElementGradingPoint, inner: Sequence[ElementGradingPoint]
) -> list[ElementGradingPoint]:
    """The grading points from `start` to `end`, without inner points that are too near to another.

    Element columns become smaller towards the grading points. A point is dropped if it lies in the
    column at an end of the lining. A point is also dropped if its distance from the previous point
    is at most the smaller column size of the two points. The previous point then gets the smaller
    size and the larger ratio of the two. A point with small columns thus remains beside a point
    with larger columns, for example an end of the contact beside a step.
    """
    kept = [start]
    for point in inner:
        last = kept[-1]
        if end.position - point.position <= max(end.column_size, point.column_size):
            break
        smallest_distance = (max if len(kept) == 1 else min)(last.column_size, point.column_size)
        if point.position - last.position > smallest_distance:
            kept.append(point)
        elif len(kept) > 1 and point.column_size < last.column_size:
            kept[-1] = ElementGradingPoint(
                last.position,
                point.column_size,
                max(last.size_ratio_of_columns, point.size_ratio_of_columns),
            )
    return [*kept, end]


def _positions_of_shoe_body_ends(shoe: Shoe, radius: float) -> tuple[float, float]:
    """The positions phi at which the body of a shoe begins and ends [rad], the hinge's end first.

    A straight beam reaches beyond its lining. There a position is the lining's end plus the
    distance along the beam divided by the radius of the lining's back.
    """
    start, end = shoe.arc
    if isinstance(shoe.body, BeamBody):
        axis, back = (
            make_beam_axis(shoe.pin.xy, shoe.actuation.point.xy),
            radius + shoe.lining.thickness,
        )
        angles = np.sort(axis.angle(shoe.frame.surface_coordinates_of_phi(np.array([start, end]))))
        foot = axis.x_of_perpendicular_foot + back * np.sin(angles)
        return start - float(foot[0]) / back, end + (axis.length - float(foot[1])) / back
    if shoe.body is None:
        return start, end
    near, far = sorted(
        shoe.frame.phi_coordinates_as_list((shoe.body.start, shoe.body.end)), key=abs
    )
    return near, far


def _largest_ratio_of_beam_to_block_layers(shoe: Shoe) -> float:
    """The largest allowed ratio of the layers of elements in a straight beam to those in its block.

    The layers meet at the interface of beam and block, see BEAM_ERROR_OVER_BLOCK_ERROR. The ratio
    is at least 1, and 1 for a shoe without a straight beam.
    """
    if not isinstance(shoe.body, BeamBody):
        return 1.0
    # `reason_against_finite_element_model` refuses beams without section or block, so that the
    # assertion holds.
    assert shoe.body.section is not None and shoe.backing is not None
    section, block = shoe.body.section, shoe.backing
    beam_stiffness = section.width * section.material.young_modulus_of_equivalent_half_plane
    # The block is as wide as the lining.
    block_stiffness = shoe.lining.width * block.material.young_modulus_of_equivalent_half_plane
    # Powers of two give brakes with nearly equal moduli the same layers.
    ratio = BEAM_ERROR_OVER_BLOCK_ERROR * beam_stiffness / block_stiffness
    return 2.0 ** max(0, math.floor(math.log2(ratio)))


def _depths_and_parts_of_element_layers(
    layers: list[ShoeLayer],
    level: RefinementLevel,
    first_layer_size_at_lining_face: float,
    layer_size_at_corner: float,
    contact_length: float,
    *,
    coarsens: bool,
    thickening: float,
    straight: bool,
) -> tuple[Floats, tuple[str, ...]]:
    """The depths of the faces of the layers of elements, and the name of each layer's part.

    The depths (l + 1,) are counted from the lining's face. The names (l,) say to which part of the
    shoe ("lining", "shoe", ...) each layer belongs.

    If the pressure is unbounded at a corner of the lining, the first layer at the lining's face is
    divided once more, into layers that become smaller towards the face. The layers below it grow as
    the columns do. If they grew by `layer_size_ratio`, as elsewhere, they would have nearly equal
    depths on all levels, and the first two levels nearly equal errors of the torque: up to 1e-4 on
    29 rigid shoes that press with a corner, stated up to 16 times too small. With the layers as
    they are, the errors are at most 4e-6, and none is stated more than 1.5 times too small.

    Parameters
    ----------
    layers : layers of the shoe
    level : degree of the elements, and sizes of columns and layers
    first_layer_size_at_lining_face : size of the layer of elements at the contact [m], if the
        pressure is bounded at the lining's corners
    layer_size_at_corner : size of the layer of elements at the lining's face [m] that an unbounded
        pressure at a corner needs; inf if the pressure is bounded there
    contact_length : length of the contact [m]
    coarsens : whether elements far from the contact are larger
    thickening : thickness of the layer of elements in the shoe's body at its interface, over the
        thickness that this layer has in the block of a straight beam
    straight : whether the depth grows from k to k + 1 through layer k of the shoe (k = 0, 1, ...),
        as for a straight beam; if False, depths are in m
    """
    depths, part, at = [np.zeros(1)], [], 0.0
    is_graded_to_corner = layer_size_at_corner < first_layer_size_at_lining_face
    distances = np.cumsum([layer.thickness for layer in layers]) / contact_length
    for k, layer in enumerate(layers):
        # `outer` and `inner` are the sizes of the elements nearest to the contact and farthest from
        # it in this layer of the shoe.
        t = layer.thickness
        outer = first_layer_size_at_lining_face
        if k > 0:
            thinner = min(t, layers[k - 1].thickness)
            size = relative_element_size_far_from_contact(
                level.interface_layer_size, distances[k - 1], coarsens=coarsens
            )
            outer = size * thinner
            if layer.part == "shoe":
                outer = min(thickening * outer, t)
        thinner = min(t, layers[k + 1].thickness) if k + 1 < len(layers) else t
        inner = (
            relative_element_size_far_from_contact(
                level.interface_layer_size, distances[k], coarsens=coarsens
            )
            * thinner
        )
        # The hinge holds the end face of this layer, and the stress is singular at the corners of
        # this face.
        if layer.part == "shoe":
            inner = level.hinge_column_size * t
        divided_lining = is_graded_to_corner and k == 0
        ratio = level.column_size_ratio if divided_lining else level.layer_size_ratio
        sizes = element_sizes_growing_from_both_ends(t, outer, inner, ratio, t)
        if divided_lining:
            first = sizes[0]
            sizes[:1] = element_sizes_growing_from_both_ends(
                first, layer_size_at_corner, first, level.layer_size_ratio, first
            )
        ends = interval_ends_from_interval_sizes(sizes, 0.0, t)[1:]
        depths.append(at + (ends / t if straight else ends))
        part += [layer.part] * len(sizes)
        at = float(depths[-1][-1])
    return np.concatenate(depths), tuple(part)
