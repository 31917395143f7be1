"""Element columns of the section times the functions across, condensed to substructures.

A substructure has the unknowns [left line | contact | right line] of `hp.columns`. At each row of
nodes a line has x and y of every even function and z of every odd one. Functions that only wider
parts have come first in a row, so that the unknowns of a narrower body which continues beyond the
lining are the last ones of the line. At the contact x and y of all even functions stand together
node by node; u_z, on which nothing acts there, belongs to the lines.
"""

from collections.abc import Sequence
from enum import IntEnum
from functools import cache, partial
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.fem.hp.arc import nodal_functions
from drumlin.fem.hp.columns import ColumnSubstructure
from drumlin.fem.hp.element import schur_complements
from drumlin.fem.width.functions import WidthFunctions, WidthIntegrals
from drumlin.fem.width.integrals import SYMMETRIES, SectionIntegrals, fold_z


class BackEdge(IntEnum):
    """How the innermost edge of a column moves: freely, only along z (in a grip), or not."""

    FREE = 0
    GRIPPED = 1
    BONDED = 2


class WidthUnknown(NamedTuple):
    """An unknown of a column.

    Attributes
    ----------
    z : 1 for a displacement along z, 0 for one in the plane
    along : number along the row of nodes, of the unknowns of its kind
    row : row of nodes, from the contact inwards
    function : number of the function across the width, of its parity
    """

    z: int
    along: int
    row: int
    function: int


class AlongRow(NamedTuple):
    """The unknowns along one row of nodes: numbers of those in the plane and of those along z.

    Each of the three parts (the left side, the inside, the right side) has both numbers; a half
    column has no right side.
    """

    left: tuple[tuple[int, ...], tuple[int, ...]]
    inside: tuple[tuple[int, ...], tuple[int, ...]]
    right: tuple[tuple[int, ...], tuple[int, ...]] = ((), ())

    @property
    def contact(self) -> tuple[int, ...]:
        """Numbers of all unknowns in the plane, in the order of the contact."""
        return tuple(sorted((*self.left[0], *self.inside[0], *self.right[0])))


def whole_row(p: int) -> AlongRow:
    """The unknowns along a row of p + 1 nodes, x and y of a node together."""
    inside = tuple(range(2, 2 * p)), tuple(range(1, p))
    return AlongRow(((0, 1), (0,)), inside, ((2 * p, 2 * p + 1), (p,)))


def half_row(p: int, symmetry: int) -> AlongRow:
    """The symmetric (0) or antisymmetric (1) unknowns along a row of p + 1 nodes."""
    inside = tuple(range(2, p + 1)), tuple(range(1, len(fold_z(p, symmetry))))
    return AlongRow(((0, 1), (0,)), inside)


class Stack(NamedTuple):
    """What tells the unknowns of a column: its layers, its functions, and its edges.

    Attributes
    ----------
    p : degree of the section
    counts : (layers,) numbers of even and of odd functions of each layer, from the contact inwards
    even, odd : first piece of each function of the shoe
    contact : whether the outermost edge is in contact
    back : how the innermost edge moves
    """

    p: int
    counts: tuple[tuple[int, int], ...]
    even: tuple[int, ...]
    odd: tuple[int, ...]
    contact: bool
    back: BackEdge

    def functions(self, row: int) -> tuple[int, int]:
        """Numbers of even and of odd functions that a row of nodes has."""
        layers = len(self.counts)
        if row == layers * self.p and self.back != BackEdge.FREE:
            return 0, (self.counts[-1][1] if self.back == BackEdge.GRIPPED else 0)
        near = {(row - 1) // self.p, row // self.p} if row else {0}
        return max(self.counts[layer] for layer in near if layer < layers)

    def unknowns_of_row(self, row: int) -> list[tuple[int, int]]:
        """The kind and the function of each displacement of a row, those of wide parts first."""
        even, odd = self.functions(row)
        found = []
        for piece in range(max((*self.even, *self.odd)), -1, -1):
            found += [(0, f) for f in range(even) if self.even[f] == piece]
            found += [(1, f) for f in range(odd) if self.odd[f] == piece]
        return found

    def row_of(
        self, row: int, along: tuple[tuple[int, ...], tuple[int, ...]]
    ) -> list[WidthUnknown]:
        """The unknowns of a row with the numbers `along` it, without those of the contact."""
        found = []
        for z, function in self.unknowns_of_row(row):
            if not (self.contact and row == 0 and z == 0):
                found += [WidthUnknown(z, a, row, function) for a in along[z]]
        return found

    def line(self, along: tuple[tuple[int, ...], tuple[int, ...]]) -> list[WidthUnknown]:
        """The unknowns of a line, of the left or the right side."""
        rows = range(len(self.counts) * self.p + 1)
        return [unknown for row in rows for unknown in self.row_of(row, along)]

    def on_contact(self, along: AlongRow) -> list[WidthUnknown]:
        """The unknowns of the contact, by their number along the row and by function."""
        if not self.contact:
            return []
        functions = range(self.counts[0][0])
        return [WidthUnknown(0, a, 0, f) for a in along.contact for f in functions]


def stack_of(
    functions: WidthFunctions, halves: Sequence[float], p: int, *, contact: bool, back: BackEdge
) -> Stack:
    """The stack of layers with `halves` of their widths (l,) [m], from the contact inwards."""
    return Stack(
        p,
        tuple(functions.counts(half) for half in halves),
        tuple(function.piece for function in functions.even),
        tuple(function.piece for function in functions.odd),
        contact,
        back,
    )


Run = tuple[slice, slice]
"""Places of some unknowns: in the stiffness of a condensed element, and in that of its column."""


class LayerPlan(NamedTuple):
    """How the elements of a layer are condensed and added to their columns.

    Attributes
    ----------
    outer, mixed, inner : positions of the blocks of boundary unknowns, of inner by boundary
        unknowns and of inner unknowns in the integrals of an element
    kept, rest : runs of boundary unknowns among those of the column that stay, and among those that
        are eliminated
    """

    outer: Ints
    mixed: Ints
    inner: Ints
    kept: tuple[Run, ...]
    rest: tuple[Run, ...]


class ColumnPlan(NamedTuple):
    """How a column is condensed: its layers, and the numbers of unknowns that stay or go."""

    layers: tuple[LayerPlan, ...]
    kept: int
    rest: int
    line: int


@cache
def column_plan(stack: Stack, along: AlongRow) -> ColumnPlan:
    """The plan of the columns of a stack, with these unknowns along each row of nodes."""
    p, last = stack.p, len(stack.counts)
    left, right = stack.line(along.left), stack.line(along.right)
    stays = [*left, *stack.on_contact(along), *right]
    edges = [stack.row_of(k * p, along.inside) for k in range(last + 1)]
    goes = [unknown for edge in edges for unknown in edge]
    kept, rest = ({unknown: k for k, unknown in enumerate(row)} for row in (stays, goes))
    layers = []
    for k, counts in enumerate(stack.counts):
        rows = range(k * p, (k + 1) * p + 1)
        mine = [u for u in (*stays, *edges[k], *edges[k + 1]) if _in_layer(u, rows, counts)]
        within = []
        for row in rows[1:-1]:
            own = [u for u in stack.row_of(row, along.inside) if _in_layer(u, rows, counts)]
            within += own
        place = partial(_positions, along=along, counts=counts, p=p, first=k * p)
        layers.append(
            LayerPlan(
                outer=place(mine, mine),
                mixed=place(within, mine),
                inner=place(within, within),
                kept=_runs(mine, kept),
                rest=_runs(mine, rest),
            )
        )
    return ColumnPlan(tuple(layers), len(stays), len(goes), len(left))


def _in_layer(unknown: WidthUnknown, rows: range, counts: tuple[int, int]) -> bool:
    """Whether an unknown is one of the elements of a layer with these rows and functions."""
    return unknown.row in rows and unknown.function < counts[unknown.z]


def _runs(mine: list[WidthUnknown], numbers: dict[WidthUnknown, int]) -> tuple[Run, ...]:
    """The runs of unknowns that follow one another both in `mine` and by their `numbers`."""
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


def _positions(
    rows: list[WidthUnknown],
    columns: list[WidthUnknown],
    along: AlongRow,
    counts: tuple[int, int],
    p: int,
    first: int,
) -> Ints:
    """Positions (rows, columns) of a block in the integrals that `_element_values` puts together.

    Parameters
    ----------
    rows, columns : unknowns of the block
    along : the unknowns along a row of nodes
    counts : numbers of even and of odd functions of the layer
    p : degree
    first : the first row of nodes of the layer
    """
    parts = along.left, along.inside, along.right
    sizes = np.array([sum(len(part[z]) for part in parts) for z in (0, 1)])
    n, functions = p + 1, np.array(counts)
    r = np.array(rows, dtype=int).reshape(-1, 4)[:, None]
    c = np.array(columns, dtype=int).reshape(-1, 4)[None]
    # The block of z by the plane is the transpose of that of the plane by z.
    swapped = ((r[..., 0] == 1) & (c[..., 0] == 0))[..., None]
    r, c = np.where(swapped, c, r), np.where(swapped, r, c)
    of, by = r[..., 0], c[..., 0]
    # The three parts of the values follow one another: plane by plane, plane by z, and z by z.
    lengths = sizes * n * functions
    start = np.array([0, lengths[0] ** 2, lengths[0] ** 2 + lengths[0] * lengths[1]])[of + by]
    along_both = r[..., 1] * sizes[by] + c[..., 1]
    rows_both = (r[..., 2] - first) * n + c[..., 2] - first
    functions_both = r[..., 3] * functions[by] + c[..., 3]
    number = (along_both * n**2 + rows_both) * functions[of] * functions[by] + functions_both
    return np.ascontiguousarray(start + number)


def _element_values(section: SectionIntegrals, width: WidthIntegrals) -> Floats:
    """The stiffness of elements (c, values), with u_x and u_y, mixed, and with u_z.

    Each part has the indices (along, along, row, row, function, function).

    Parameters
    ----------
    section : integrals over the section
    width : integrals over the width
    """
    count = len(section.plane)
    parts = [
        _spread([section.plane, section.shear], [width.even, width.even_slopes]),
        _spread([section.coupled, section.sheared], [width.even_odd_slopes, width.even_slopes_odd]),
        _spread([section.across, section.tilted], [width.odd_slopes, width.odd]),
    ]
    return np.concatenate([part.reshape(count, -1) for part in parts], axis=1)


def _spread(section: list[Floats], width: list[Floats]) -> Floats:
    """The sum of the products of two integrals over the section and two over the width."""
    if width[0].size == 0:
        return np.zeros((len(section[0]), 0))
    over = np.array([own.ravel() for own in width])
    found = section[0].reshape(-1, 1) * over[0]
    if over[1].any():
        found += section[1].reshape(-1, 1) * over[1]
    return found


def _condensed(
    parts: Sequence[SectionIntegrals], widths: Sequence[WidthIntegrals], plan: ColumnPlan
) -> Floats:
    """The stiffness (c, kept, kept) of columns on the unknowns that their plan keeps.

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
        values = _element_values(part, width)
        own = values.take(layer.outer, axis=1)
        if layer.inner.size:
            schur_complements(
                own, values.take(layer.mixed, axis=1), values.take(layer.inner, axis=1)
            )
        _add_runs(own, layer.kept, layer.kept, K)
        _add_runs(own, layer.rest, layer.kept, C)
        _add_runs(own, layer.rest, layer.rest, inner)
    return schur_complements(K, C, inner) if plan.rest else K


def _add_runs(part: Floats, rows: Sequence[Run], columns: Sequence[Run], target: Floats) -> None:
    """Add blocks of the elements `part` (c, m, m) to the columns `target` (c, n, n)."""
    for own, at in rows:
        for other, to in columns:
            view = target[:, at, to]
            view += part[:, own, other]


def whole_columns(
    parts: Sequence[SectionIntegrals], widths: Sequence[WidthIntegrals], stack: Stack
) -> list[ColumnSubstructure]:
    """Columns whose section integrals have the unknowns of all nodes, in any axes.

    Parameters
    ----------
    parts : integrals over the section of the elements of each layer
    widths : integrals over the width of each layer
    stack : the layers
    """
    plan = column_plan(stack, whole_row(stack.p))
    order = _contact_by_nodes(stack, plan, 2)
    columns = _condensed(parts, widths, plan)
    if len(order):
        columns = columns[:, order[:, None], order]
    return [ColumnSubstructure(K, plan.line, plan.line) for K in columns]


def _contact_by_nodes(stack: Stack, plan: ColumnPlan, sides: int) -> Ints:
    """The order (n,) of unknowns in which x and y at the contact stand together."""
    if not stack.contact:
        return np.zeros(0, dtype=int)
    functions, nodes = stack.counts[0][0], stack.p + 1
    contact = np.arange(2 * nodes * functions).reshape(nodes, 2, functions).transpose(0, 2, 1)
    line = np.arange(plan.line)
    count = contact.size
    right = line + plan.line + count if sides == 2 else line[:0]
    return np.concatenate([line, plan.line + contact.ravel(), right])


def mirrored_columns(
    parts: Sequence[Sequence[SectionIntegrals]], widths: Sequence[WidthIntegrals], stack: Stack
) -> list[ColumnSubstructure]:
    """Columns that are their own mirror images, from integrals of both symmetries.

    Parameters
    ----------
    parts : of the symmetric and of the antisymmetric unknowns, as of `whole_columns`
    widths : integrals over the width of each layer
    stack : the layers
    """
    plans = [column_plan(stack, half_row(stack.p, symmetry)) for symmetry in SYMMETRIES]
    halves = [_condensed(parts[i], widths, plans[i]) for i in SYMMETRIES]
    line = plans[0].line
    own = [half[:, :line] for half in halves]
    mirror = np.array([_mirror(unknown) for unknown in stack.line(half_row(stack.p, 0).left)])
    n = 2 * (stack.p + 1) * stack.counts[0][0] if stack.contact else 0
    left, right = slice(line), slice(line + n, None)
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
        _unfold_contact(halves, stack, mirror, whole)
    return [ColumnSubstructure(K, line, line) for K in whole]


def _mirror(unknown: WidthUnknown) -> float:
    """The sign of a line's unknown on the other side, in symmetric displacements."""
    return -1.0 if unknown.z == 0 and unknown.along == 1 else 1.0


def _unfold_contact(halves: list[Floats], stack: Stack, mirror: Floats, whole: Floats) -> None:
    """Put the contact's rows and columns of mirrored columns into `whole`.

    Parameters
    ----------
    halves : stiffness (c, kept, kept) of both symmetries
    stack : the layers
    mirror : (line,) signs of the right line
    whole : (c, n, n) stiffness of the whole columns
    """
    functions, count = nodal_functions(stack.p), stack.counts[0][0]
    line = len(mirror)
    # The unknown of x and y at each node, of each function, with x and y together.
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


def restrict_back(piece: ColumnSubstructure, stack: Stack, *, right: bool) -> ColumnSubstructure:
    """A column beside a grip: the last row of one of its lines moves along z alone.

    Parameters
    ----------
    piece : the column, of a stack with a free back
    stack : its layers
    right : whether the grip begins at the right line; otherwise it ends at the left line
    """
    last = len(stack.counts) * stack.p
    side = half_row(stack.p, 0).left
    held = [u.row == last and u.z == 0 for u in stack.line(side)]
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
