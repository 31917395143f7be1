"""Columns of hp elements times functions across the width, condensed to substructures.

A column is a stack of elements from the contact inwards. The nodes on its left and its right side
form the left and the right line. A substructure has the unknowns [left line | contact | right line]
of `hp.columns`. At each row of nodes a line has the displacements x and y for every even function
of z, and the displacement z for every odd function. In a row the functions that only wider parts
have come first. So the unknowns of a narrower body, which continues beyond the lining, are the last
ones of the line. At the contact x and y of all even functions stand together node by node. u_z is
free of forces there and belongs to the lines.
"""

from collections.abc import Sequence
from enum import IntEnum
from functools import cache, partial
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.fem.hp.arc import nodal_functions_along_element_column
from drumlin.fem.hp.columns import ColumnSubstructure
from drumlin.fem.hp.element import replace_each_by_schur_complement
from drumlin.fem.width.functions import WidthFunctions, WidthIntegrals
from drumlin.fem.width.integrals import (
    SYMMETRIES,
    SectionIntegrals,
    symmetry_matrix_of_forces_along_z,
)


class BackEdge(IntEnum):
    """How the innermost edge of a column moves: freely, along z only (in a grip), or not at all."""

    FREE = 0
    GRIPPED = 1
    BONDED = 2


class WidthUnknown(NamedTuple):
    """A displacement that is an unknown of a column of elements.

    Attributes
    ----------
    z : 1 for a displacement along z, 0 for a displacement in the section
    along : number along the row of nodes, among the unknowns with the same `z`
    row : row of nodes, counted from the contact inwards
    function : number of the function across the width, among the even (z = 0) or the odd ones (z =
        1)
    """

    z: int
    along: int
    row: int
    function: int


class AlongRow(NamedTuple):
    """The numbers of the unknowns along one row of nodes of a column.

    The row has three parts: the left side, the inside and the right side. Each part has the numbers
    of its displacements in the section and the numbers of its displacements along z. A half column,
    for symmetric or antisymmetric displacements, has no right side.
    """

    left: tuple[tuple[int, ...], tuple[int, ...]]
    inside: tuple[tuple[int, ...], tuple[int, ...]]
    right: tuple[tuple[int, ...], tuple[int, ...]] = ((), ())

    @property
    def contact_unknowns_along_row(self) -> tuple[int, ...]:
        """Numbers of all displacements in the section, in the order of the contact's unknowns."""
        return tuple(sorted((*self.left[0], *self.inside[0], *self.right[0])))


def unknowns_along_whole_row(p: int) -> AlongRow:
    """The unknowns along a row of p + 1 nodes of a column, x and y of a node together."""
    inside = tuple(range(2, 2 * p)), tuple(range(1, p))
    return AlongRow(((0, 1), (0,)), inside, ((2 * p, 2 * p + 1), (p,)))


def unknowns_along_half_row(p: int, symmetry: int) -> AlongRow:
    """The unknowns along a row of p + 1 nodes for displacements of one symmetry.

    `symmetry` is 0 for displacements that are symmetric about the column's middle, and 1 for
    antisymmetric ones.
    """
    inside = (
        tuple(range(2, p + 1)),
        tuple(range(1, len(symmetry_matrix_of_forces_along_z(p, symmetry)))),
    )
    return AlongRow(((0, 1), (0,)), inside)


class ColumnLayers(NamedTuple):
    """The layers of a column of elements, which determine the column's unknowns.

    Attributes
    ----------
    p : degree of the section
    counts : (layers,) numbers of even and of odd functions of each layer, from the contact inwards
    even, odd : number of the first piece of the width of each even and each odd function of the
        shoe
    contact : whether the outermost edge is in contact
    back : how the innermost edge moves
    """

    p: int
    counts: tuple[tuple[int, int], ...]
    even: tuple[int, ...]
    odd: tuple[int, ...]
    contact: bool
    back: BackEdge

    def function_counts_of_node_row(self, row: int) -> tuple[int, int]:
        """Numbers of even and of odd functions across the width at a row of nodes."""
        layers = len(self.counts)
        if row == layers * self.p and self.back != BackEdge.FREE:
            return 0, (self.counts[-1][1] if self.back == BackEdge.GRIPPED else 0)
        # A row between two layers has the functions of the layer that has more of them.
        near = {(row - 1) // self.p, row // self.p} if row else {0}
        return max(self.counts[layer] for layer in near if layer < layers)

    def kind_and_function_of_row_unknowns(self, row: int) -> list[tuple[int, int]]:
        """The kind and the function of each displacement of a row, those of wide parts first.

        The kind is 1 for displacements along z and 0 for displacements in the section.
        """
        even, odd = self.function_counts_of_node_row(row)
        found = []
        for piece in range(max((*self.even, *self.odd)), -1, -1):
            found += [(0, f) for f in range(even) if self.even[f] == piece]
            found += [(1, f) for f in range(odd) if self.odd[f] == piece]
        return found

    def row_unknowns_without_contact(
        self, row: int, along: tuple[tuple[int, ...], tuple[int, ...]]
    ) -> list[WidthUnknown]:
        """The unknowns of a row of nodes with the numbers `along` it without those of contact."""
        found = []
        for z, function in self.kind_and_function_of_row_unknowns(row):
            if not (self.contact and row == 0 and z == 0):
                found += [WidthUnknown(z, a, row, function) for a in along[z]]
        return found

    def unknowns_on_left_or_right_side_of_column(
        self, along: tuple[tuple[int, ...], tuple[int, ...]]
    ) -> list[WidthUnknown]:
        """The unknowns of the left or the right line of a column, from the contact inwards.

        `along` are the numbers of this side in each row.
        """
        rows = range(len(self.counts) * self.p + 1)
        return [
            unknown for row in rows for unknown in self.row_unknowns_without_contact(row, along)
        ]

    def unknowns_of_contact_nodes(self, along: AlongRow) -> list[WidthUnknown]:
        """The unknowns of the contact, by their number along the row and then by function."""
        if not self.contact:
            return []
        functions = range(self.counts[0][0])
        return [
            WidthUnknown(0, a, 0, f) for a in along.contact_unknowns_along_row for f in functions
        ]


def column_layers_of_shoe(
    functions: WidthFunctions, halves: Sequence[float], p: int, *, contact: bool, back: BackEdge
) -> ColumnLayers:
    """The stack of given layers of a shoe with functions across its width.

    Parameters
    ----------
    functions : functions across the width
    halves : half width of each layer (l,) [m], from the contact inwards
    p : degree of the section
    contact : whether the outermost edge is in contact
    back : how the innermost edge moves
    """
    return ColumnLayers(
        p,
        tuple(functions.numbers_of_even_and_odd_functions(half) for half in halves),
        tuple(function.piece for function in functions.even_functions_across_width),
        tuple(function.piece for function in functions.odd_functions_across_width),
        contact,
        back,
    )


UnknownRun = tuple[slice, slice]
"""Two slices of the same unknowns: in the stiffness of a condensed element, and of its column."""


class LayerPlan(NamedTuple):
    """How the elements of a layer are condensed and added to the stiffness of their columns.

    Attributes
    ----------
    outer, mixed, inner : positions, in the values of `_stiffness_entries_of_elements`, of three
        blocks of an element's stiffness: boundary unknowns, inner by boundary unknowns, and inner
        unknowns
    kept, rest : runs of boundary unknowns that the column keeps, and of those that it eliminates
    """

    outer: Ints
    mixed: Ints
    inner: Ints
    kept: tuple[UnknownRun, ...]
    rest: tuple[UnknownRun, ...]


class ColumnPlan(NamedTuple):
    """How a column is condensed: the plan of each layer, and numbers of unknowns.

    `kept` and `rest` are the numbers of kept and of eliminated unknowns, and
    `line` that of a side line.
    """

    layers: tuple[LayerPlan, ...]
    kept: int
    rest: int
    line: int


@cache
def condensation_plan_of_column(stack: ColumnLayers, along: AlongRow) -> ColumnPlan:
    """The plan that condenses columns of a stack of layers.

    `along` are the unknowns along each row of nodes.
    """
    names = unknowns_of_column(stack, along)
    kept, rest = ({unknown: k for k, unknown in enumerate(row)} for row in (names.kept, names.rest))
    layers = []
    for k, counts in enumerate(stack.counts):
        mine, within = names.boundary[k], names.within[k]
        place = partial(
            _flat_positions_of_element_stiffness_block,
            along=along,
            counts=counts,
            p=stack.p,
            first=k * stack.p,
        )
        layers.append(
            LayerPlan(
                outer=place(mine, mine),
                mixed=place(within, mine),
                inner=place(within, within),
                kept=_runs_of_consecutive_unknowns(mine, kept),
                rest=_runs_of_consecutive_unknowns(mine, rest),
            )
        )
    line = len(stack.unknowns_on_left_or_right_side_of_column(along.left))
    return ColumnPlan(tuple(layers), len(kept), len(rest), line)


class ColumnUnknownNames(NamedTuple):
    """The unknowns of a column, by what its condensation does with them.

    Attributes
    ----------
    kept : unknowns that the column keeps: left line, contact, right line
    rest : unknowns on the edges of its elements that the column eliminates
    boundary : unknowns on the boundary of the element of each layer, kept ones and others
    within : unknowns inside the element of each layer, which are eliminated first
    """

    kept: list[WidthUnknown]
    rest: list[WidthUnknown]
    boundary: list[list[WidthUnknown]]
    within: list[list[WidthUnknown]]


def unknowns_of_column(stack: ColumnLayers, along: AlongRow) -> ColumnUnknownNames:
    """The unknowns of a column of a stack of layers.

    `along` are the unknowns along each row of nodes.
    """
    p, last = stack.p, len(stack.counts)
    kept = [
        *stack.unknowns_on_left_or_right_side_of_column(along.left),
        *stack.unknowns_of_contact_nodes(along),
        *stack.unknowns_on_left_or_right_side_of_column(along.right),
    ]
    # The column keeps its two lines and its contact. It eliminates the inner nodes on the edges of
    # its layers.
    edges = [stack.row_unknowns_without_contact(k * p, along.inside) for k in range(last + 1)]
    boundary, within = [], []
    for k, counts in enumerate(stack.counts):
        rows = range(k * p, (k + 1) * p + 1)
        outer = (*kept, *edges[k], *edges[k + 1])
        boundary.append([u for u in outer if _is_unknown_of_layer(u, rows, counts)])
        # The unknowns inside an element are eliminated before its stiffness is added to that of the
        # column of elements.
        inside = []
        for row in rows[1:-1]:
            own = stack.row_unknowns_without_contact(row, along.inside)
            inside += [u for u in own if _is_unknown_of_layer(u, rows, counts)]
        within.append(inside)
    return ColumnUnknownNames(kept, [u for edge in edges for u in edge], boundary, within)


def _is_unknown_of_layer(unknown: WidthUnknown, rows: range, counts: tuple[int, int]) -> bool:
    """Whether an unknown belongs to the elements of a layer with these rows and function counts."""
    return unknown.row in rows and unknown.function < counts[unknown.z]


def _runs_of_consecutive_unknowns(
    mine: list[WidthUnknown], numbers: dict[WidthUnknown, int]
) -> tuple[UnknownRun, ...]:
    """The runs of unknowns that follow one another both in `mine` and by their `numbers`.

    A run is a slice in `mine` and a slice of numbers; unknowns without a number are left out.
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
    rows: list[WidthUnknown],
    columns: list[WidthUnknown],
    along: AlongRow,
    counts: tuple[int, int],
    p: int,
    first: int,
) -> Ints:
    """Positions (rows, columns) of a block of an element's stiffness among the flat entries.

    Parameters
    ----------
    rows, columns : unknowns of the block
    along : the unknowns along a row of nodes
    counts : numbers of even and of odd functions of the layer
    p : degree of the section
    first : the first row of nodes of the layer
    """
    parts = along.left, along.inside, along.right
    sizes = np.array([sum(len(part[z]) for part in parts) for z in (0, 1)])
    n, functions = p + 1, np.array(counts)
    r = np.array(rows, dtype=int).reshape(-1, 4)[:, None]
    c = np.array(columns, dtype=int).reshape(-1, 4)[None]
    # The values have a block of displacements in the section by those along z. Entries of the
    # transposed block are found in it with row and column swapped.
    swapped = ((r[..., 0] == 1) & (c[..., 0] == 0))[..., None]
    r, c = np.where(swapped, c, r), np.where(swapped, r, c)
    of, by = r[..., 0], c[..., 0]
    # The values have three parts, one behind the other: products of two displacements in the
    # section, products of one in the section and one along z, and products of two along z.
    lengths = sizes * n * functions
    start = np.array([0, lengths[0] ** 2, lengths[0] ** 2 + lengths[0] * lengths[1]])[of + by]
    along_both = r[..., 1] * sizes[by] + c[..., 1]
    rows_both = (r[..., 2] - first) * n + c[..., 2] - first
    functions_both = r[..., 3] * functions[by] + c[..., 3]
    number = (along_both * n**2 + rows_both) * functions[of] * functions[by] + functions_both
    return np.ascontiguousarray(start + number)


def _stiffness_entries_of_elements(section: SectionIntegrals, width: WidthIntegrals) -> Floats:
    """The entries of the stiffness of elements, in one row (c, values) for each element.

    The entries of u_x and u_y by themselves come first, then those by u_z, then those of u_z by
    itself. Each of the three parts has the indices (along, along, row, row, function, function).

    Parameters
    ----------
    section : integrals over the section
    width : integrals over the width
    """
    count = len(section.plane)
    parts = [
        _sum_of_section_times_width_integrals(
            [section.plane, section.shear], [width.even, width.even_slopes]
        ),
        _sum_of_section_times_width_integrals(
            [section.coupled, section.sheared], [width.even_odd_slopes, width.even_slopes_odd]
        ),
        _sum_of_section_times_width_integrals(
            [section.across, section.tilted], [width.odd_slopes, width.odd]
        ),
    ]
    return np.concatenate([part.reshape(count, -1) for part in parts], axis=1)


def _sum_of_section_times_width_integrals(section: list[Floats], width: list[Floats]) -> Floats:
    """The sum of two products, each of an integral over the section and one over the width."""
    if width[0].size == 0:
        return np.zeros((len(section[0]), 0))
    over = np.array([own.ravel() for own in width])
    found = section[0].reshape(-1, 1) * over[0]
    if over[1].any():
        found += section[1].reshape(-1, 1) * over[1]
    return found


class AssembledColumns(NamedTuple):
    """The stiffness of c columns on the boundaries of their elements, in three blocks.

    Attributes
    ----------
    kept : (c, k, k) block of the unknowns that the columns keep
    coupling : (c, r, k) block of eliminated by kept unknowns
    rest : (c, r, r) block of the unknowns on edges of elements that the columns eliminate
    """

    kept: Floats
    coupling: Floats
    rest: Floats


def assembled_stiffness_of_columns(
    parts: Sequence[SectionIntegrals], widths: Sequence[WidthIntegrals], plan: ColumnPlan
) -> AssembledColumns:
    """The stiffness of columns on the boundaries of their elements.

    The unknowns inside elements are eliminated.

    Parameters
    ----------
    parts : integrals over the section of the elements of each layer
    widths : integrals over the width of each layer
    plan : the plan of the columns
    """
    count = len(parts[0].plane)
    K = np.zeros((count, plan.kept, plan.kept))
    C = np.zeros((count, plan.rest, plan.kept))
    inner = np.zeros((count, plan.rest, plan.rest))
    for part, width, layer in zip(parts, widths, plan.layers, strict=True):
        # The inner unknowns of each element are eliminated first.
        values = _stiffness_entries_of_elements(part, width)
        own = values.take(layer.outer, axis=1)
        if layer.inner.size:
            replace_each_by_schur_complement(
                own, values.take(layer.mixed, axis=1), values.take(layer.inner, axis=1)
            )
        _add_element_blocks_to_columns(own, layer.kept, layer.kept, K)
        _add_element_blocks_to_columns(own, layer.rest, layer.kept, C)
        _add_element_blocks_to_columns(own, layer.rest, layer.rest, inner)
    return AssembledColumns(K, C, inner)


def displacements_inside_elements(
    part: SectionIntegrals, width: WidthIntegrals, layer: LayerPlan, boundary: Floats
) -> Floats:
    """The displacements (c, i, m) of the i unknowns inside c elements, in m load cases.

    No force acts inside the elements.

    Parameters
    ----------
    part : integrals over the section of the elements
    width : integrals over their width
    layer : the plan of their layer
    boundary : (c, b, m) displacements of the b unknowns on the boundaries of the elements
    """
    values = _stiffness_entries_of_elements(part, width)
    forces = values.take(layer.mixed, axis=1) @ boundary
    return -np.asarray(np.linalg.solve(values.take(layer.inner, axis=1), forces), dtype=float)


def _condensed_stiffness_of_columns(
    parts: Sequence[SectionIntegrals], widths: Sequence[WidthIntegrals], plan: ColumnPlan
) -> Floats:
    """The stiffness (c, kept, kept) of columns on the unknowns that their plan keeps.

    The parameters are those of `assembled_stiffness_of_columns`.
    """
    K, C, inner = assembled_stiffness_of_columns(parts, widths, plan)
    return replace_each_by_schur_complement(K, C, inner) if plan.rest else K


def _add_element_blocks_to_columns(
    part: Floats, rows: Sequence[UnknownRun], columns: Sequence[UnknownRun], target: Floats
) -> None:
    """Add blocks of element stiffness `part` (c, m, m) to column stiffness `target` (c, n, n)."""
    for own, at in rows:
        for other, to in columns:
            view = target[:, at, to]
            view += part[:, own, other]


def condense_columns_of_any_shape(
    parts: Sequence[SectionIntegrals], widths: Sequence[WidthIntegrals], stack: ColumnLayers
) -> list[ColumnSubstructure]:
    """Condensed columns of elements of any shape, from integrals on the unknowns of all nodes.

    Parameters
    ----------
    parts : integrals over the section of the elements of each layer
    widths : integrals over the width of each layer
    stack : the layers of the columns
    """
    plan = condensation_plan_of_column(stack, unknowns_along_whole_row(stack.p))
    order = _unknown_order_with_contact_by_nodes(stack, plan, 2)
    columns = _condensed_stiffness_of_columns(parts, widths, plan)
    if len(order):
        columns = columns[:, order[:, None], order]
    return [ColumnSubstructure(K, plan.line, plan.line) for K in columns]


def _unknown_order_with_contact_by_nodes(stack: ColumnLayers, plan: ColumnPlan, sides: int) -> Ints:
    """The order (n,) of a column's unknowns that keeps x and y of a contact node together.

    The order is empty without contact. `sides` is 2 for a whole column and 1 for a half.
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
    parts: Sequence[Sequence[SectionIntegrals]],
    widths: Sequence[WidthIntegrals],
    stack: ColumnLayers,
) -> list[ColumnSubstructure]:
    """Condensed columns that are their own mirror images, from integrals of both symmetries.

    Symmetric and antisymmetric displacements about the middle of a column do no work on each other,
    so that each half is condensed alone.

    Parameters
    ----------
    parts : integrals over the section of each layer, for the symmetric and for the antisymmetric
        displacements
    widths : integrals over the width of each layer
    stack : the layers of the columns
    """
    plans = [
        condensation_plan_of_column(stack, unknowns_along_half_row(stack.p, symmetry))
        for symmetry in SYMMETRIES
    ]
    halves = [_condensed_stiffness_of_columns(parts[i], widths, plans[i]) for i in SYMMETRIES]
    line = plans[0].line
    own = [half[:, :line] for half in halves]
    mirror = np.array(
        [
            _sign_of_displacement_on_mirrored_side(unknown)
            for unknown in stack.unknowns_on_left_or_right_side_of_column(
                unknowns_along_half_row(stack.p, 0).left
            )
        ]
    )
    n = 2 * (stack.p + 1) * stack.counts[0][0] if stack.contact else 0
    left, right = slice(line), slice(line + n, None)
    # Displacements of the left line alone are half symmetric and half antisymmetric. So the sum of
    # both stiffnesses belongs to one side, and their difference couples the two sides.
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


def _sign_of_displacement_on_mirrored_side(unknown: WidthUnknown) -> float:
    """The sign by which a symmetric displacement on the left line is repeated on the right line.

    It is -1 for displacements around the drum, and +1 for all others.
    """
    return -1.0 if unknown.z == 0 and unknown.along == 1 else 1.0


def _write_contact_stiffness_of_mirrored_columns(
    halves: list[Floats], stack: ColumnLayers, mirror: Floats, whole: Floats
) -> None:
    """Write the contact's rows and columns of the stiffness of mirrored columns into `whole`.

    Parameters
    ----------
    halves : stiffness (c, kept, kept) of the symmetric and of the antisymmetric displacements
    stack : the layers of the columns
    mirror : (line,) signs of the right line's unknowns in symmetric displacements
    whole : (c, n, n) stiffness of the whole columns, which is changed in place
    """
    functions, count = nodal_functions_along_element_column(stack.p), stack.counts[0][0]
    line = len(mirror)
    # `place` is the symmetric or antisymmetric unknown to which x or y of a contact node belongs,
    # for each function across the width, with x and y together.
    place = functions.place.reshape(-1, 1, 2) * count + np.arange(count)[:, None]
    place = line + place.ravel()
    signs = [np.repeat(sign.reshape(-1, 1, 2), count, axis=1).ravel() for sign in functions.sign]
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


def column_with_back_held_beside_grip(
    piece: ColumnSubstructure, stack: ColumnLayers, *, right: bool
) -> ColumnSubstructure:
    """A column beside a grip, with the innermost nodes of one of its sides free along z only.

    Parameters
    ----------
    piece : the column, of a stack with a free back
    stack : the layers of the column
    right : whether the grip begins at the right line; otherwise it ends at the left line
    """
    last = len(stack.counts) * stack.p
    side = unknowns_along_half_row(stack.p, 0).left
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
