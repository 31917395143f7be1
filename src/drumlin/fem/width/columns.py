"""Columns of hp elements times functions across the width, condensed to substructures.

A column is a stack of elements from the contact through the thickness of the shoe. The nodes on its
left side and on its right side form its left and its right line. A row of nodes runs along the arc,
from the left line to the right line. The unknowns of a substructure are [left line | contact |
right line], as in `hp.columns`. At each row a line has the displacements x and y for every even
function of z, and the displacement z for every odd function. In a row, functions of z that are zero
on the narrower parts of the shoe come first. So the unknowns of a narrow body, which continues
beyond the lining, are the last unknowns of the line. Among the unknowns of the contact, x and y of
all even functions of a node stand together. The contact exerts no force along z. The displacements
z of the contact nodes are therefore not unknowns of the contact but of the lines.
"""

from collections.abc import Hashable, Iterator, Sequence
from enum import IntEnum
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.fem.hp.arc import nodal_functions_along_element_column
from drumlin.fem.hp.columns import ColumnSubstructure
from drumlin.fem.hp.element import replace_matrices_by_schur_complements
from drumlin.fem.width.functions import FunctionsAcrossWidth, IntegralsOverWidth
from drumlin.fem.width.integrals import (
    SYMMETRY_NUMBERS_OF_COLUMN_DISPLACEMENTS,
    ElementIntegralsOverShoeSection,
    matrix_from_node_to_unknown_forces_along_z,
)

MOST_CONDENSATION_PLANS = 32
"""Number of plans for the condensation of columns that are kept for later columns.

A brake needs two plans for its columns under the lining and two for the columns beside it, for each
degree of its elements, each degree across the width and each set of pieces across the width. A plan
takes up to 30 MB, and mostly far less.
"""
LARGEST_COUPLING_ELIMINATED_AT_ONCE = 20_000
"""Number of kept times number of eliminated unknowns up to which a column is not divided in halves.

Stretches of few layers have few unknowns, so that the elimination of unknowns between them takes
fewer multiplications than the elimination from the whole column. Small columns take longer in
halves, because the matrices are then many and small.
"""


class ConditionAtEdgeFarthestFromContact(IntEnum):
    """How the edge of a column that is farthest from the contact can move.

    The edge moves freely, along z only (in a grip), or not at all (bonded to a rigid part).
    """

    FREE = 0
    GRIPPED = 1
    BONDED = 2


class ColumnDisplacementUnknown(NamedTuple):
    """A displacement that is an unknown of a column of elements.

    Attributes
    ----------
    z : 1 for a displacement along z, 0 for a displacement in the section
    along : position along the row of nodes, counted among the row's unknowns with the same `z`
    row : index of the row of nodes; row 0 is the column's edge nearest to the contact
    function : index of the function across the width, counted among the even functions for z = 0,
        and among the odd functions for z = 1
    """

    z: int
    along: int
    row: int
    function: int


class NumbersOfUnknownsAlongNodeRow(NamedTuple):
    """The indices of the unknowns along one row of nodes of a column, for one function of z.

    The row consists of the node on the left side, the nodes inside and the node on the right side.
    The displacements in the section are counted from left to right, x and y of a node one after the
    other. The displacements along z are counted separately, from 0 on as well. Each part of the row
    has two tuples: the indices of its displacements in the section, and the indices of its
    displacements along z. If only the symmetric or only the antisymmetric displacements of a column
    are unknowns, there is no right side.
    """

    left: tuple[tuple[int, ...], tuple[int, ...]]
    inside: tuple[tuple[int, ...], tuple[int, ...]]
    right: tuple[tuple[int, ...], tuple[int, ...]] = ((), ())

    @property
    def indices_of_unknowns_along_row_from_left_to_right(self) -> tuple[int, ...]:
        """Indices of the row's displacements in the section, from left to right."""
        return tuple(sorted((*self.left[0], *self.inside[0], *self.right[0])))


def indices_of_unknowns_along_node_row(p: int) -> NumbersOfUnknownsAlongNodeRow:
    """The indices of the unknowns along a row of p + 1 nodes; x and y of a node are neighbours."""
    inside = tuple(range(2, 2 * p)), tuple(range(1, p))
    return NumbersOfUnknownsAlongNodeRow(((0, 1), (0,)), inside, ((2 * p, 2 * p + 1), (p,)))


def indices_of_unknowns_along_symmetric_half_row(
    p: int, symmetry: int
) -> NumbersOfUnknownsAlongNodeRow:
    """The indices of the symmetric or of the antisymmetric unknowns along a row of p + 1 nodes.

    `symmetry` is 0 for displacements that are symmetric about the column's middle, and 1 for
    antisymmetric displacements.
    """
    inside = (
        tuple(range(2, p + 1)),
        tuple(range(1, len(matrix_from_node_to_unknown_forces_along_z(p, symmetry)))),
    )
    return NumbersOfUnknownsAlongNodeRow(((0, 1), (0,)), inside)


class LayersOfElementColumn(NamedTuple):
    """The layers of a column of elements, which determine the column's unknowns.

    Attributes
    ----------
    p : degree of the hp elements
    counts : (layers,) how many even and how many odd functions of z each layer has, from the
        contact on
    even, odd : for each even and each odd function of z of the shoe, the index of the first piece
        of the half width in which the function is not zero
    contact : whether the column's edge nearest to the contact is in contact; False in the body
        beyond the lining, where this edge is free
    back : how the edge farthest from the contact moves
    """

    p: int
    counts: tuple[tuple[int, int], ...]
    even: tuple[int, ...]
    odd: tuple[int, ...]
    contact: bool
    back: ConditionAtEdgeFarthestFromContact

    @property
    def number_of_unknowns_on_each_side(self) -> int:
        """Number of unknowns on the left side of a column, which is the number on its right side.

        Unknowns of the contact are not counted.
        """
        left = indices_of_unknowns_along_node_row(self.p).left
        return len(self.unknowns_on_left_or_right_side_of_column(left))

    @property
    def number_of_unknowns_of_contact(self) -> int:
        """Number of unknowns of a column's contact nodes; 0 without contact."""
        return 2 * (self.p + 1) * self.counts[0][0] if self.contact else 0

    def counts_of_even_and_odd_functions_at_node_row(self, row: int) -> tuple[int, int]:
        """How many even and how many odd functions of z have unknowns at a row of nodes."""
        layers = len(self.counts)
        if row == layers * self.p and self.back != ConditionAtEdgeFarthestFromContact.FREE:
            return 0, (
                self.counts[-1][1] if self.back == ConditionAtEdgeFarthestFromContact.GRIPPED else 0
            )
        # A row between two layers has the functions of the layer that has more functions.
        near = {(row - 1) // self.p, row // self.p} if row else {0}
        return max(self.counts[layer] for layer in near if layer < layers)

    def kind_and_width_function_of_row_unknowns(self, row: int) -> list[tuple[int, int]]:
        """The pairs (kind, index of the function of z) of the unknowns at a row of nodes.

        The kind is 1 for displacements along z and 0 for displacements in the section. Functions
        that are zero on the narrower parts of the shoe come first.
        """
        even, odd = self.counts_of_even_and_odd_functions_at_node_row(row)
        found = []
        for piece in range(max((*self.even, *self.odd)), -1, -1):
            found += [(0, f) for f in range(even) if self.even[f] == piece]
            found += [(1, f) for f in range(odd) if self.odd[f] == piece]
        return found

    def unknowns_of_node_row_besides_contact(
        self, row: int, along: tuple[tuple[int, ...], tuple[int, ...]]
    ) -> list[ColumnDisplacementUnknown]:
        """The unknowns at a row of nodes that do not belong to the contact.

        `along` is the part `left`, `inside` or `right` of an `NumbersOfUnknownsAlongNodeRow`.
        """
        found = []
        for z, function in self.kind_and_width_function_of_row_unknowns(row):
            if not (self.contact and row == 0 and z == 0):
                found += [ColumnDisplacementUnknown(z, a, row, function) for a in along[z]]
        return found

    def unknowns_on_left_or_right_side_of_column(
        self, along: tuple[tuple[int, ...], tuple[int, ...]]
    ) -> list[ColumnDisplacementUnknown]:
        """The unknowns on the left or the right side of a column, row by row from the contact on.

        `along` is the part `left` or `right` of an `NumbersOfUnknownsAlongNodeRow`, which is the
        same for all rows.
        """
        rows = range(len(self.counts) * self.p + 1)
        return [
            unknown
            for row in rows
            for unknown in self.unknowns_of_node_row_besides_contact(row, along)
        ]

    def unknowns_of_contact_nodes(
        self, along: NumbersOfUnknownsAlongNodeRow
    ) -> list[ColumnDisplacementUnknown]:
        """The unknowns of the contact nodes; the list is empty without contact.

        For each displacement in the section, from left to right along the contact, the list has one
        unknown for each even function of z. `along` has the indices of the displacements along a
        row of nodes.
        """
        if not self.contact:
            return []
        functions = range(self.counts[0][0])
        return [
            ColumnDisplacementUnknown(0, a, 0, f)
            for a in along.indices_of_unknowns_along_row_from_left_to_right
            for f in functions
        ]


def layers_of_element_column_from_half_widths(
    functions: FunctionsAcrossWidth,
    halves: Sequence[float],
    p: int,
    *,
    contact: bool,
    back: ConditionAtEdgeFarthestFromContact,
) -> LayersOfElementColumn:
    """The layers of a column of elements, from the half widths of its layers.

    Parameters
    ----------
    functions : functions across the width of the shoe
    halves : (l,) half width of each layer [m], from the contact on
    p : degree of the hp elements
    contact, back : as in `LayersOfElementColumn`
    """
    return LayersOfElementColumn(
        p,
        tuple(functions.counts_of_even_and_odd_functions_on_part(half) for half in halves),
        tuple(function.piece for function in functions.even_functions_across_width),
        tuple(function.piece for function in functions.odd_functions_across_width),
        contact,
        back,
    )


RunSlicesInElementAndColumnStiffness = tuple[slice, slice]
"""The slices of a run of consecutive unknowns in the stiffness of an element and of its column.

The unknowns inside the element are already eliminated from its stiffness.
"""


class LayerCondensationPlan(NamedTuple):
    """How the elements of a layer are condensed and added to the stiffness of their columns.

    Attributes
    ----------
    outer, inner_by_boundary, inner : positions of three blocks of an element's stiffness in the
        result of `_flat_stiffness_entries_of_each_element`: boundary by boundary unknowns, inner by
        boundary unknowns, and inner by inner unknowns
    kept, rest : runs of the boundary unknowns that the column keeps, and of the boundary unknowns
        that it eliminates; each run is a pair of slices, see `RunSlicesInElementAndColumnStiffness`
    """

    outer: Ints
    inner_by_boundary: Ints
    inner: Ints
    kept: tuple[RunSlicesInElementAndColumnStiffness, ...]
    rest: tuple[RunSlicesInElementAndColumnStiffness, ...]


class StretchCondensationPlan(NamedTuple):
    """How a stretch of consecutive layers of a column is put together and condensed.

    A stretch of several layers consists of two or more shorter stretches. It eliminates unknowns on
    the edges between these, and unknowns on the two edges of the column.

    Attributes
    ----------
    layer : index of the only layer of the stretch; None for several layers
    parts : the shorter stretches, from the contact on; none for a single layer
    kept, rest : for each part (or for the only layer), runs of the unknowns that the stretch keeps
        and of the unknowns that it eliminates; each run has a slice in the part and a slice in the
        stretch
    number_of_kept_unknowns, number_of_eliminated_unknowns : numbers of unknowns of the stretch
    """

    layer: int | None
    parts: tuple["StretchCondensationPlan", ...]
    kept: tuple[tuple[RunSlicesInElementAndColumnStiffness, ...], ...]
    rest: tuple[tuple[RunSlicesInElementAndColumnStiffness, ...], ...]
    number_of_kept_unknowns: int
    number_of_eliminated_unknowns: int


class ColumnCondensationPlan(NamedTuple):
    """How a column is condensed: the plan of each layer, and three counts of unknowns.

    `kept` and `rest` are the counts of the unknowns that the column keeps and eliminates, and
    `line` is the count of the unknowns on its left side. `whole` is the plan that condenses the
    column stretch by stretch.
    """

    layers: tuple[LayerCondensationPlan, ...]
    kept: int
    rest: int
    line: int
    whole: StretchCondensationPlan


@lru_cache(maxsize=MOST_CONDENSATION_PLANS)
def condensation_plan_of_column(
    stack: LayersOfElementColumn, along: NumbersOfUnknownsAlongNodeRow
) -> ColumnCondensationPlan:
    """The plan by which columns with the layers `stack` are condensed.

    `along` has the indices of the unknowns along a row of nodes; they are the same for all rows.
    """
    names = unknowns_of_element_column_by_role_in_condensation(stack, along)
    kept, rest = ({unknown: k for k, unknown in enumerate(row)} for row in (names.kept, names.rest))
    # Layers whose elements have the same unknowns share the arrays of positions, which are large.
    positions: dict[Hashable, Ints] = {}
    layers = []
    for k, counts in enumerate(stack.counts):

        def positions_of_block(
            rows: list[ColumnDisplacementUnknown],
            columns: list[ColumnDisplacementUnknown],
            first: int = k * stack.p,
            counts: tuple[int, int] = counts,
        ) -> Ints:
            """The positions of a block of the layer's element stiffness."""
            of_rows, of_columns = (
                tuple(unknown._replace(row=unknown.row - first) for unknown in unknowns)
                for unknowns in (rows, columns)
            )
            key = of_rows, of_columns, counts
            if key not in positions:
                positions[key] = _flat_positions_of_element_stiffness_block(
                    of_rows, of_columns, along, counts, stack.p
                )
            return positions[key]

        mine, within = names.boundary[k], names.within[k]
        layers.append(
            LayerCondensationPlan(
                outer=positions_of_block(mine, mine),
                inner_by_boundary=positions_of_block(within, mine),
                inner=positions_of_block(within, within),
                kept=_runs_of_consecutive_unknowns(mine, kept),
                rest=_runs_of_consecutive_unknowns(mine, rest),
            )
        )
    line = len(stack.unknowns_on_left_or_right_side_of_column(along.left))
    is_large = len(kept) * len(rest) > LARGEST_COUPLING_ELIMINATED_AT_ONCE
    whole = _plan_of_stretch(names, range(len(stack.counts)), stack.p, halve=is_large).plan
    return ColumnCondensationPlan(tuple(layers), len(kept), len(rest), line, whole)


class _StretchPlanWithUnknowns(NamedTuple):
    """The plan of a stretch of layers, and the unknowns that the stretch keeps, in their order."""

    plan: StretchCondensationPlan
    kept: list[ColumnDisplacementUnknown]


def _plan_of_stretch(
    names: "ColumnUnknownsByRoleInCondensation", layers: range, p: int, *, halve: bool
) -> _StretchPlanWithUnknowns:
    """The plan of a stretch of consecutive layers.

    Parameters
    ----------
    names : unknowns of the column
    layers : indices of the layers of the stretch
    p : degree of the hp elements
    halve : whether the stretch consists of two halves, each of which consists of two halves again;
        if False it consists of its layers
    """
    count, only = len(names.boundary), len(layers) == 1
    parts: list[_StretchPlanWithUnknowns] = []
    if not only:
        middle = layers.start + len(layers) // 2
        halves = [range(layers.start, middle), range(middle, layers.stop)]
        pieces = halves if halve else [range(k, k + 1) for k in layers]
        parts = [_plan_of_stretch(names, piece, p, halve=halve) for piece in pieces]
    unknowns_of_parts = [names.boundary[layers.start]] if only else [part.kept for part in parts]
    # A longer stretch eliminates the unknowns on an edge between this stretch and its neighbour.
    # Without halves the whole column eliminates the unknowns on all edges.
    open_rows = {row * p for row in (layers.start, layers.stop) if 0 < row < count}
    if only and count > 1 and not halve:
        open_rows = {layers.start * p, layers.stop * p}
    order = {unknown: k for k, unknown in enumerate((*names.kept, *names.rest))}
    found = sorted({unknown for own in unknowns_of_parts for unknown in own}, key=order.__getitem__)
    kept: list[ColumnDisplacementUnknown] = []
    gone: list[ColumnDisplacementUnknown] = []
    for unknown in found:
        stays = order[unknown] < len(names.kept) or unknown.row in open_rows
        (kept if stays else gone).append(unknown)
    numbers = [{unknown: k for k, unknown in enumerate(own)} for own in (kept, gone)]
    runs = [
        tuple(_runs_of_consecutive_unknowns(own, number) for own in unknowns_of_parts)
        for number in numbers
    ]
    plan = StretchCondensationPlan(
        layers.start if only else None,
        tuple(part.plan for part in parts),
        runs[0],
        runs[1],
        len(kept),
        len(gone),
    )
    return _StretchPlanWithUnknowns(plan, kept)


class ColumnUnknownsByRoleInCondensation(NamedTuple):
    """The unknowns of a column, sorted by their role in its condensation.

    Attributes
    ----------
    kept : unknowns that the column keeps: of its left side, its contact and its right side
    rest : unknowns on edges of elements inside the column, which the column eliminates
    boundary : unknowns on the boundary of each layer's element, from `kept` and from `rest`
    within : unknowns inside each layer's element, which are eliminated first
    """

    kept: list[ColumnDisplacementUnknown]
    rest: list[ColumnDisplacementUnknown]
    boundary: list[list[ColumnDisplacementUnknown]]
    within: list[list[ColumnDisplacementUnknown]]


def unknowns_of_element_column_by_role_in_condensation(
    stack: LayersOfElementColumn, along: NumbersOfUnknownsAlongNodeRow
) -> ColumnUnknownsByRoleInCondensation:
    """The unknowns of a column, sorted by their role in its condensation.

    `stack` are the layers of the column. `along` has the indices of the unknowns along a row of
    nodes; they are the same for all rows.
    """
    p, last = stack.p, len(stack.counts)
    kept = [
        *stack.unknowns_on_left_or_right_side_of_column(along.left),
        *stack.unknowns_of_contact_nodes(along),
        *stack.unknowns_on_left_or_right_side_of_column(along.right),
    ]
    # The column keeps the unknowns on its two sides and on its contact. It eliminates the other
    # unknowns on the edges of its layers.
    edges = [
        stack.unknowns_of_node_row_besides_contact(k * p, along.inside) for k in range(last + 1)
    ]
    boundary, within = [], []
    for k, counts in enumerate(stack.counts):
        rows = range(k * p, (k + 1) * p + 1)
        outer = (*kept, *edges[k], *edges[k + 1])
        boundary.append([u for u in outer if _is_unknown_of_layer(u, rows, counts)])
        # The unknowns inside an element are eliminated before its stiffness is added to the
        # stiffness of the column of elements.
        inside = []
        for row in rows[1:-1]:
            own = stack.unknowns_of_node_row_besides_contact(row, along.inside)
            inside += [u for u in own if _is_unknown_of_layer(u, rows, counts)]
        within.append(inside)
    return ColumnUnknownsByRoleInCondensation(
        kept, [u for edge in edges for u in edge], boundary, within
    )


def _is_unknown_of_layer(
    unknown: ColumnDisplacementUnknown, rows: range, counts: tuple[int, int]
) -> bool:
    """Whether an unknown belongs to the elements of a layer.

    The layer has the rows of nodes `rows`. `counts` tells how many even and how many odd functions
    of z the layer has.
    """
    return unknown.row in rows and unknown.function < counts[unknown.z]


def _runs_of_consecutive_unknowns(
    mine: list[ColumnDisplacementUnknown], numbers: dict[ColumnDisplacementUnknown, int]
) -> tuple[RunSlicesInElementAndColumnStiffness, ...]:
    """The runs of unknowns that are consecutive both in the list `mine` and by their `numbers`.

    A run is a slice of `mine`, and the slice of the numbers that these unknowns have. Unknowns
    without a number are left out.
    """
    found: list[list[int]] = []
    for k, unknown in enumerate(mine):
        at = numbers.get(unknown)
        if at is None:
            continue
        if found and (found[-1][1], found[-1][3]) == (k, at):
            found[-1][1], found[-1][3] = k + 1, at + 1
        else:
            found.append([k, k + 1, at, at + 1])
    return tuple((slice(a, b), slice(c, d)) for a, b, c, d in found)


def _flat_positions_of_element_stiffness_block(
    rows: Sequence[ColumnDisplacementUnknown],
    columns: Sequence[ColumnDisplacementUnknown],
    along: NumbersOfUnknownsAlongNodeRow,
    counts: tuple[int, int],
    p: int,
) -> Ints:
    """The positions of a block of an element's stiffness in the flat list of its entries.

    The list is a row of the result of `_flat_stiffness_entries_of_each_element`. The positions have
    the shape (rows, columns).

    Parameters
    ----------
    rows, columns : unknowns of the block; rows of nodes are counted from the layer's first row
    along : indices of the unknowns along a row of nodes
    counts : how many even and how many odd functions of z the layer has
    p : degree of the hp elements
    """
    parts = along.left, along.inside, along.right
    sizes = np.array([sum(len(part[z]) for part in parts) for z in (0, 1)])
    n, functions = p + 1, np.array(counts)
    r = np.array(rows, dtype=int).reshape(-1, 4)[:, None]
    c = np.array(columns, dtype=int).reshape(-1, 4)[None]
    # The entries contain the block of displacements in the section by displacements along z, and
    # not its transpose. An entry of the transpose is found with row and column swapped.
    swapped = ((r[..., 0] == 1) & (c[..., 0] == 0))[..., None]
    r, c = np.where(swapped, c, r), np.where(swapped, r, c)
    of, by = r[..., 0], c[..., 0]
    # The entries have three parts: they couple two displacements in the section, then a
    # displacement in the section with a displacement along z, then two displacements along z.
    lengths = sizes * n * functions
    start = np.array([0, lengths[0] ** 2, lengths[0] ** 2 + lengths[0] * lengths[1]])[of + by]
    along_both = r[..., 1] * sizes[by] + c[..., 1]
    rows_both = r[..., 2] * n + c[..., 2]
    functions_both = r[..., 3] * functions[by] + c[..., 3]
    number = (along_both * n**2 + rows_both) * functions[of] * functions[by] + functions_both
    return np.ascontiguousarray(start + number, dtype=np.int32)


def _flat_stiffness_entries_of_each_element(
    section: ElementIntegralsOverShoeSection, width: IntegralsOverWidth
) -> Floats:
    """The entries of the stiffness of c elements, as a flat row for each element (c, entries).

    Each entry belongs to two unknowns. First come the entries of two displacements in the section
    (u_x or u_y), then the entries of a displacement in the section and a displacement u_z, then the
    entries of two displacements u_z. Each of these three parts is flattened from the axes (along,
    along, row, row, function, function): the positions of both unknowns along their rows, then
    their rows, then their functions of z.

    Parameters
    ----------
    section : integrals over the section of the c elements
    width : integrals over the width of the elements' layer
    """
    count = len(section.plane)
    parts = [
        _sum_of_section_times_width_integrals(
            [section.plane, section.shear], [width.even, width.even_slopes]
        ),
        _sum_of_section_times_width_integrals(
            [section.integrals_of_trace_times_z_value, section.integrals_of_value_times_z_slope],
            [width.even_times_odd_slopes, width.even_slopes_times_odd],
        ),
        _sum_of_section_times_width_integrals(
            [section.across, section.integrals_of_z_slope_products], [width.odd_slopes, width.odd]
        ),
    ]
    return np.concatenate([part.reshape(count, -1) for part in parts], axis=1)


def _sum_of_section_times_width_integrals(section: list[Floats], width: list[Floats]) -> Floats:
    """The sum of two products, each of an integral over the section and one over the width.

    `section` and `width` hold two integrals each, of the shapes (c, A, B, n, n) and (k, l). In the
    result (c A B n n, k l), a row belongs to an entry of the section's integrals, and a column to
    an entry of the width's integrals.
    """
    if width[0].size == 0:
        return np.zeros((len(section[0]), 0))
    over = np.array([own.ravel() for own in width])
    found = section[0].reshape(-1, 1) * over[0]
    if over[1].any():
        found += section[1].reshape(-1, 1) * over[1]
    return found


class AssembledStiffnessOfColumns(NamedTuple):
    """The stiffness of c columns, before unknowns on edges of their elements are eliminated.

    The unknowns inside the elements are already eliminated.

    Attributes
    ----------
    kept : (c, k, k) stiffness for the k unknowns that a column keeps
    coupling : (c, r, k) stiffness that couples eliminated (rows) with kept unknowns (columns)
    rest : (c, r, r) stiffness for the r unknowns on edges of elements that a column eliminates
    """

    kept: Floats
    coupling: Floats
    rest: Floats


def column_stiffnesses_without_inner_element_unknowns(
    parts: Sequence[ElementIntegralsOverShoeSection],
    widths: Sequence[IntegralsOverWidth],
    plan: ColumnCondensationPlan,
) -> AssembledStiffnessOfColumns:
    """The stiffness of columns of elements for the unknowns on the boundaries of the elements.

    The unknowns inside the elements are eliminated.

    Parameters
    ----------
    parts : integrals over the section of each layer's elements
    widths : integrals over the width of each layer
    plan : the plan by which the columns are condensed
    """
    count = len(parts[0].plane)
    K = np.zeros((count, plan.kept, plan.kept))
    C = np.zeros((count, plan.rest, plan.kept))
    inner = np.zeros((count, plan.rest, plan.rest))
    for part, width, layer in zip(parts, widths, plan.layers, strict=True):
        own = _element_stiffnesses_on_boundary_unknowns(part, width, layer)
        _add_element_blocks_to_columns(own, layer.kept, layer.kept, K)
        _add_element_blocks_to_columns(own, layer.rest, layer.kept, C)
        _add_element_blocks_to_columns(own, layer.rest, layer.rest, inner)
    return AssembledStiffnessOfColumns(K, C, inner)


def _element_stiffnesses_on_boundary_unknowns(
    part: ElementIntegralsOverShoeSection, width: IntegralsOverWidth, layer: LayerCondensationPlan
) -> Floats:
    """The stiffness (c, b, b) of c elements of a layer on the b unknowns on their boundaries.

    The unknowns inside the elements are eliminated. `part` and `width` are the integrals over the
    section and over the width of the layer's elements.
    """
    values = _flat_stiffness_entries_of_each_element(part, width)
    own = values.take(layer.outer, axis=1)
    if layer.inner.size:
        replace_matrices_by_schur_complements(
            own, values.take(layer.inner_by_boundary, axis=1), values.take(layer.inner, axis=1)
        )
    return own


def displacements_inside_elements(
    part: ElementIntegralsOverShoeSection,
    width: IntegralsOverWidth,
    layer: LayerCondensationPlan,
    boundary: Floats,
) -> Floats:
    """The displacements (c, i, m) of the i unknowns inside c elements, in m load cases.

    No force acts inside the elements.

    Parameters
    ----------
    part : integrals over the section of the elements
    width : integrals over the width of the elements' layer
    layer : how the elements of the layer are condensed
    boundary : (c, b, m) displacements of the b unknowns on the boundaries of the elements
    """
    values = _flat_stiffness_entries_of_each_element(part, width)
    forces = values.take(layer.inner_by_boundary, axis=1) @ boundary
    return -np.asarray(np.linalg.solve(values.take(layer.inner, axis=1), forces), dtype=float)


def _stiffness_of_columns_on_kept_unknowns(
    parts: Sequence[ElementIntegralsOverShoeSection],
    widths: Sequence[IntegralsOverWidth],
    plan: ColumnCondensationPlan,
    stretch: StretchCondensationPlan | None = None,
) -> Floats:
    """The stiffness (c, kept, kept) of c columns on the unknowns that their plan keeps.

    `stretch` is a stretch of the columns' layers; without it the stiffness of whole columns is
    returned. The other parameters are those of `column_stiffnesses_without_inner_element_unknowns`.
    """
    own = stretch or plan.whole

    def stiffness_of_parts() -> Iterator[Floats]:
        """Yield the stiffness of each part of the stretch."""
        if own.layer is not None:
            k = own.layer
            yield _element_stiffnesses_on_boundary_unknowns(parts[k], widths[k], plan.layers[k])
        for shorter in own.parts:
            yield _stiffness_of_columns_on_kept_unknowns(parts, widths, plan, shorter)

    if own.layer is not None and not own.number_of_eliminated_unknowns:
        return next(stiffness_of_parts())
    count, kept, rest = (
        len(parts[0].plane),
        own.number_of_kept_unknowns,
        own.number_of_eliminated_unknowns,
    )
    K, C, inner = (np.zeros((count, *size)) for size in ((kept, kept), (rest, kept), (rest, rest)))
    for part, kept_runs, rest_runs in zip(stiffness_of_parts(), own.kept, own.rest, strict=True):
        _add_element_blocks_to_columns(part, kept_runs, kept_runs, K)
        _add_element_blocks_to_columns(part, rest_runs, kept_runs, C)
        _add_element_blocks_to_columns(part, rest_runs, rest_runs, inner)
    return replace_matrices_by_schur_complements(K, C, inner) if rest else K


def _add_element_blocks_to_columns(
    part: Floats,
    rows: Sequence[RunSlicesInElementAndColumnStiffness],
    columns: Sequence[RunSlicesInElementAndColumnStiffness],
    target: Floats,
) -> None:
    """Add blocks of element stiffness `part` (c, m, m) to column stiffness `target` (c, n, n)."""
    for own, at in rows:
        for other, to in columns:
            view = target[:, at, to]
            view += part[:, own, other]


def condense_element_columns_of_any_shape(
    parts: Sequence[ElementIntegralsOverShoeSection],
    widths: Sequence[IntegralsOverWidth],
    stack: LayersOfElementColumn,
) -> list[ColumnSubstructure]:
    """Condense columns of elements of any shape to the nodes on their two sides and their contact.

    Parameters
    ----------
    parts : integrals over the section of each layer's elements, on the unknowns of all nodes
    widths : integrals over the width of each layer
    stack : the layers of the columns
    """
    plan = condensation_plan_of_column(stack, indices_of_unknowns_along_node_row(stack.p))
    order = _order_of_column_unknowns_by_contact_nodes(stack, plan, 2)
    columns = _stiffness_of_columns_on_kept_unknowns(parts, widths, plan)
    if len(order):
        columns = columns[:, order[:, None], order]
    return [ColumnSubstructure(K, plan.line, plan.line) for K in columns]


def _order_of_column_unknowns_by_contact_nodes(
    stack: LayersOfElementColumn, plan: ColumnCondensationPlan, sides: int
) -> Ints:
    """A column's unknowns (n,), in an order in which x and y of a contact node are neighbours.

    The order is empty without contact. `sides` is 2 for all unknowns of a column, and 1 for its
    symmetric or antisymmetric unknowns, which have no right side.
    """
    if not stack.contact:
        return np.zeros(0, dtype=int)
    functions, nodes = stack.counts[0][0], stack.p + 1
    contact = np.arange(2 * nodes * functions).reshape(nodes, 2, functions).transpose(0, 2, 1)
    line = np.arange(plan.line)
    count = contact.size
    right = line + plan.line + count if sides == 2 else line[:0]
    return np.concatenate([line, plan.line + contact.ravel(), right])


def condense_mirror_symmetric_columns(
    parts: Sequence[Sequence[ElementIntegralsOverShoeSection]],
    widths: Sequence[IntegralsOverWidth],
    stack: LayersOfElementColumn,
) -> list[ColumnSubstructure]:
    """Condense columns that are their own mirror images to their two sides and their contact.

    Forces of symmetric displacements about the middle of a column do no work on antisymmetric
    displacements. The stiffness of each symmetry is therefore condensed alone.

    Parameters
    ----------
    parts : integrals over the section of each layer, for the symmetric and for the antisymmetric
        displacements
    widths : integrals over the width of each layer
    stack : the layers of the columns
    """
    plans = [
        condensation_plan_of_column(
            stack, indices_of_unknowns_along_symmetric_half_row(stack.p, symmetry)
        )
        for symmetry in SYMMETRY_NUMBERS_OF_COLUMN_DISPLACEMENTS
    ]
    halves = [
        _stiffness_of_columns_on_kept_unknowns(parts[i], widths, plans[i])
        for i in SYMMETRY_NUMBERS_OF_COLUMN_DISPLACEMENTS
    ]
    line = plans[0].line
    own = [half[:, :line] for half in halves]
    left_indices = indices_of_unknowns_along_symmetric_half_row(stack.p, 0).left
    on_left = stack.unknowns_on_left_or_right_side_of_column(left_indices)
    mirror = np.array([_sign_of_displacement_on_mirrored_side(unknown) for unknown in on_left])
    n = stack.number_of_unknowns_of_contact
    left, right = slice(line), slice(line + n, None)
    # A displacement of the left side alone is the sum of a symmetric and an antisymmetric
    # displacement of half its size. So the sum of the symmetric and the antisymmetric stiffness is
    # the stiffness of one side, and their difference couples the two sides.
    (S, A), count = own, len(halves[0])
    whole = np.empty((count, 2 * line + n, 2 * line + n))
    np.add(S[:, :, :line], A[:, :, :line], out=whole[:, left, left])
    left_right = whole[:, left, right]
    np.subtract(S[:, :, :line], A[:, :, :line], out=left_right)
    left_right *= mirror
    np.multiply(left_right.transpose(0, 2, 1), 1.0, out=whole[:, right, left])
    right_right = whole[:, right, right]
    np.multiply(whole[:, left, left], mirror, out=right_right)
    right_right *= mirror[:, None]
    if stack.contact:
        _write_contact_stiffness_of_mirrored_columns(halves, stack, mirror, whole)
    return [ColumnSubstructure(K, line, line) for K in whole]


def _sign_of_displacement_on_mirrored_side(unknown: ColumnDisplacementUnknown) -> float:
    """The sign of a right-side displacement relative to the same displacement on the left side.

    The displacements of the column are symmetric about its middle. Displacements around the drum
    then have opposite signs (-1) on the two sides, and all other displacements equal signs (+1).
    """
    return -1.0 if unknown.z == 0 and unknown.along == 1 else 1.0


def _write_contact_stiffness_of_mirrored_columns(
    halves: list[Floats], stack: LayersOfElementColumn, mirror: Floats, whole: Floats
) -> None:
    """Write the contact's rows and columns into the stiffness of c whole columns.

    The entries follow from the stiffness on symmetric and on antisymmetric unknowns.

    Parameters
    ----------
    halves : the stiffness (c, m, m) on the symmetric unknowns, and the stiffness (c, m, m) on the
        antisymmetric unknowns, both in the order [left side | half of the contact]
    stack : the layers of each column
    mirror : (line,) sign of each displacement on the right side relative to the left side, in
        symmetric displacements
    whole : (c, n, n) stiffness of the columns, in the order [left side | contact | right side]; it
        is changed in place
    """
    functions, count = nodal_functions_along_element_column(stack.p), stack.counts[0][0]
    line = len(mirror)
    # `place` has the index of the symmetric (or antisymmetric) unknown to which each displacement
    # of the contact nodes belongs. At each node and function of z the displacements x and y follow
    # one another.
    place = (
        functions.symmetric_unknown_numbers.reshape(-1, 1, 2) * count + np.arange(count)[:, None]
    )
    place = line + place.ravel()
    signs = [
        np.repeat(sign.reshape(-1, 1, 2), count, axis=1).ravel()
        for sign in functions.signs_in_symmetric_unknowns
    ]
    middle = slice(line, line + len(place))
    by_contact = [
        half.take(place, axis=1) * sign[:, None] for half, sign in zip(halves, signs, strict=True)
    ]
    S, A = by_contact
    whole[:, middle, :line] = S[:, :, :line] + A[:, :, :line]
    whole[:, middle, line + len(place) :] = mirror * (S[:, :, :line] - A[:, :, :line])
    whole[:, middle, middle] = sum(
        own.take(place, axis=2) * sign for own, sign in zip(by_contact, signs, strict=True)
    )
    whole[:, :line, middle] = whole[:, middle, :line].transpose(0, 2, 1)
    whole[:, line + len(place) :, middle] = whole[:, middle, line + len(place) :].transpose(0, 2, 1)


def column_beside_grip_with_shared_node_held(
    piece: ColumnSubstructure, stack: LayersOfElementColumn, *, right: bool
) -> ColumnSubstructure:
    """A column beside a grip, with the node that it shares with the grip free along z only.

    This node is the one farthest from the contact on the side towards the grip.

    Parameters
    ----------
    piece : the column, whose edge farthest from the contact is free
    stack : the layers of the column
    right : whether the grip lies on the column's right side; if False, it lies on the left side
    """
    last = len(stack.counts) * stack.p
    side = indices_of_unknowns_along_symmetric_half_row(stack.p, 0).left
    held = [
        u.row == last and u.z == 0 for u in stack.unknowns_on_left_or_right_side_of_column(side)
    ]
    free = np.ones(len(piece.K), dtype=bool)
    place = slice(len(piece.K) - piece.right, None) if right else slice(piece.left)
    free[place] = ~np.array(held)
    kept = np.flatnonzero(free)
    gone = sum(held)
    return ColumnSubstructure(
        np.ascontiguousarray(piece.K[np.ix_(kept, kept)]),
        piece.left - (0 if right else gone),
        piece.right - (gone if right else 0),
    )
