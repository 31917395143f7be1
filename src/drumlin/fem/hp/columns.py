"""Columns of elements, whose stiffness is condensed to their two sides and their contact nodes.

A column is a stack of elements from the contact through the thickness of a body. On an arc the
displacements of the nodes on each side are measured along the side's radius and perpendicular to
it. Displacements of nodes between the sides are measured in the axes of the column's middle.
Columns of equal shape then have equal stiffness wherever they lie, and the stiffness is computed
once for each shape.

The nodes on a side of a column form its left or right line, which begins at the contact. The
unknowns of a substructure are [left line | contact | right line], with x and y of a node next to
each other. The contact node at the end of a line belongs to the contact, not to the line. In a
substructure without contact the line has this node too. `extra` unknowns, which all substructures
share, may stand before all other unknowns. They are the factors of unit loads, and their diagonal
blocks of the condensed stiffness are negative.
"""

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.fem.hp.element import (
    replace_matrices_by_schur_complements,
    replace_matrix_by_schur_complement,
)

SlicesOfUnknownsInElementAndColumn = tuple[slice, slice]
"""Two slices for the same unknowns: in an element's stiffness, and in its column's stiffness."""


class NumberingOfElementColumnUnknowns(NamedTuple):
    """The order of the unknowns of an element column, and where each element's unknowns stand.

    A column is a stack of elements, one in each layer, counted from the contact. Its condensation
    keeps the unknowns on its two sides and its contact, and eliminates all other unknowns.

    Attributes
    ----------
    kept : (layers,) the unknowns of each element that are kept, on both sides and on the contact
    inside : (layers,) the unknowns of each element that are eliminated, edge by edge from the
        contact on
    number_of_kept_unknowns : number of kept unknowns of the column
    number_of_eliminated_unknowns : number of eliminated unknowns of the column
    number_of_side_unknowns : number of unknowns of the nodes on one side of the column (a line)
    """

    kept: tuple[tuple[SlicesOfUnknownsInElementAndColumn, ...], ...]
    inside: tuple[SlicesOfUnknownsInElementAndColumn, ...]
    number_of_kept_unknowns: int
    number_of_eliminated_unknowns: int
    number_of_side_unknowns: int


@cache
def numbering_of_element_column_unknowns(
    p: int, layers: int, *, contact: bool, held: bool, sides: int = 2
) -> NumberingOfElementColumnUnknowns:
    """The order of the unknowns of an element column, and where each element's unknowns stand.

    Parameters
    ----------
    p : degree of the elements
    layers : number of elements in the column
    contact : whether the column's edge at the lining's face is in contact; if False, the nodes
        inside this edge are eliminated
    held : whether the nodes on the edge farthest from the contact are fixed, and have no unknowns
    sides : 2 for all unknowns; 1 for the symmetric or the antisymmetric half of them
    """
    side, edge, node = 2 * (p + 1), sides * (p - 1), 2 * contact
    line = 2 * (layers * p + (not held)) - node
    # A line is the nodes on one side of the column. In an element, the unknowns on its two sides
    # come first, and the unknowns on its first and last edge begin at number `own`. In the column,
    # the right line comes after the contact and begins at number `far`.
    own = sides * side
    far = line + (edge + sides * node if contact else 0)
    kept, inside = [], []
    for k in range(layers):
        # `left` and `right` pair the unknowns on one side of the element with their places in the
        # left or right line of the column.
        skipped = node if k == 0 else 0
        start, stop = 2 * k * p - node + skipped, min(2 * (k + 1) * p + 2 - node, line)
        count = skipped + stop - start
        left = slice(skipped, count), slice(start, stop)
        right = slice(side + skipped, side + count), slice(far + start, far + stop)
        places = [left, right][:sides]
        if k == 0 and contact:
            places += _contact_unknowns_of_element_column(p, line, far, sides)
        # The inner nodes of this element's first and last edge are eliminated. But inner nodes on
        # the contact are kept, and nodes on a fixed edge have no unknowns.
        first_edge = (k == 0 and contact) * edge
        last_edge = (2 - (k + 1 == layers and held)) * edge
        above = (k - contact) * edge
        kept.append(tuple(places))
        in_element = slice(own + first_edge, own + last_edge)
        in_column = slice(above + first_edge, above + last_edge)
        inside.append((in_element, in_column))
    return NumberingOfElementColumnUnknowns(
        kept=tuple(kept),
        inside=tuple(inside),
        number_of_kept_unknowns=far + (sides - 1) * line,
        number_of_eliminated_unknowns=edge * (layers + 1 - contact - held),
        number_of_side_unknowns=line,
    )


def _contact_unknowns_of_element_column(
    p: int, line: int, far: int, sides: int
) -> list[SlicesOfUnknownsInElementAndColumn]:
    """The unknowns of a column's contact nodes: in its first element, and in the whole column.

    All contact nodes, with the two at the column's sides, are numbered after the left line and
    before the right line. A line is the nodes on one side of the column.

    Parameters
    ----------
    p : degree of the elements
    sides : 2 for all unknowns; 1 for the symmetric or the antisymmetric half of them
    line : number of unknowns of the left line
    far : number of the first unknown of the right line
    """
    side, edge = 2 * (p + 1), sides * (p - 1)
    corners = [
        (slice(2), slice(line, line + 2)),
        (slice(side, side + 2), slice(far - 2, far)),
    ]
    own = sides * side
    between = slice(own, own + edge), slice(line + 2, line + 2 + edge)
    return [*corners[:sides], between]


def condensed_element_column_stiffness(
    elements: Floats, unknowns: NumberingOfElementColumnUnknowns, loads: Floats | None = None
) -> Floats:
    """The condensed stiffness (c, n, n) of c element columns with the same layers.

    The stiffness of the elements of each column is assembled. Then all unknowns are eliminated that
    are neither on a side of the column nor on its contact.

    Parameters
    ----------
    elements : (layers, c, m, m) stiffness of each element on its boundary nodes
    unknowns : the kept and the eliminated unknowns of a column
    loads : (c, k, l) unit loads on the k unknowns of the edge farthest from the contact; the
        factors of the l loads become extra unknowns. With loads, `elements` and `unknowns` must be
        of symmetric or antisymmetric halves of columns.
    """
    count = elements.shape[1]
    extra = 0 if loads is None else loads.shape[2]
    size = extra + unknowns.number_of_kept_unknowns
    K = np.zeros((count, size, size))
    C = np.zeros((count, unknowns.number_of_eliminated_unknowns, size))
    inner = np.zeros(
        (count, unknowns.number_of_eliminated_unknowns, unknowns.number_of_eliminated_unknowns)
    )
    sides, coupling = K[:, extra:, extra:], C[:, :, extra:]
    for part, kept, inside in zip(elements, unknowns.kept, unknowns.inside, strict=True):
        _add_element_stiffness_to_columns(part, kept, kept, sides)
        _add_element_stiffness_to_columns(part, (inside,), kept, coupling)
        _add_element_stiffness_to_columns(part, (inside,), (inside,), inner)
    if loads is not None:
        # The loads act on the edge farthest from the contact. The first node of this edge is the
        # last node on the column's side; the unknowns of the edge's other nodes are eliminated.
        at = slice(
            extra + unknowns.number_of_side_unknowns - 2, extra + unknowns.number_of_side_unknowns
        )
        K[:, at, :extra] = -loads[:, :2]
        K[:, :extra, at] = -loads[:, :2].transpose(0, 2, 1)
        C[:, unknowns.number_of_eliminated_unknowns - loads.shape[1] + 2 :, :extra] = -loads[:, 2:]
    return replace_matrices_by_schur_complements(K, C, inner)


def _add_element_stiffness_to_columns(
    part: Floats,
    rows: Sequence[SlicesOfUnknownsInElementAndColumn],
    columns: Sequence[SlicesOfUnknownsInElementAndColumn],
    target: Floats,
) -> None:
    """Add blocks of element stiffness to the stiffness of their element columns, in place.

    Parameters
    ----------
    part : (c, m, m) stiffness of the element of one layer in each of c element columns
    rows, columns : unknowns of the rows and of the columns of all blocks, each as two slices: in
        the element and in the element column
    target : (c, n, n) stiffness of the element columns, which the blocks are added to
    """
    for own, at in rows:
        for other, to in columns:
            # The statement `target[...] += ...` would index the array twice, which takes longer.
            view = target[:, at, to]
            view += part[:, own, other]


class ColumnSubstructure(NamedTuple):
    """A substructure of one element column, or of several that are assembled side by side.

    `K` (n, n) is its condensed stiffness, with the unknowns [left line | contact | right line]. A
    line is the nodes on one side of the substructure. `left` and `right` are the numbers of
    unknowns of the two lines.
    """

    K: Floats
    left: int
    right: int

    @property
    def made(self) -> "ColumnSubstructure":
        """The substructure itself; the property exists because unmade substructures have it."""
        return self


def join_and_condense_neighbouring_substructures(
    A: "AnyColumnSubstructure", B: "AnyColumnSubstructure", shared: int, extra: int = 0
) -> ColumnSubstructure:
    """The stiffness of two neighbouring stretches of element columns, joined to one stretch.

    The nodes between the two stretches are eliminated, except for their common contact node.

    Parameters
    ----------
    A, B : the left and the right substructure
    shared : number of contact unknowns that belong to both: the last ones of A, the first ones of B
    extra : number of extra unknowns (factors of unit loads), which belong to both
    """
    # A stretch of wide shoes takes hundreds of megabytes. Its blocks are copied, and its memory is
    # free before the other stretch is made, and before the joined stiffness is allocated.
    line, left, right = A.right, A.left, B.right
    first = A.made
    del A
    before = len(first.K) - line
    inner = first.K[before:, before:].copy()
    left_coupling, left_rest = first.K[before:, :before].copy(), first.K[:before, :before].copy()
    del first
    # The nodes between A and B, which are eliminated, end at the unknown `beyond` in B.
    second = B.made
    del B
    beyond = extra + line
    n = before - shared + len(second.K) - beyond
    rest = slice(before - shared, None)
    inner += second.K[extra:beyond, extra:beyond]
    C = np.zeros((line, n))
    C[:, :before] = left_coupling
    del left_coupling
    # The statement `C[...] += ...` would index the array twice, which takes longer.
    coupling = C[:, rest]
    coupling += second.K[extra:beyond, beyond:]
    if extra:
        C[:, :extra] += second.K[extra:beyond, :extra]
    own = np.r_[:extra, beyond : len(second.K)]
    right_rest = second.K[own[:, None], own] if extra else second.K[beyond:, beyond:].copy()
    del second
    K = np.zeros((n, n))
    K[:before, :before] = left_rest
    at = K[rest, rest]
    at += right_rest[extra:, extra:]
    if extra:
        K[:extra, :extra] += right_rest[:extra, :extra]
        K[:extra, rest] += right_rest[:extra, extra:]
        K[rest, :extra] += right_rest[extra:, :extra]
    return ColumnSubstructure(replace_matrix_by_schur_complement(K, C, inner), left, right)


@dataclass(frozen=True, eq=False)
class ColumnSubstructureMadeWhenNeeded:
    """A substructure whose stiffness is computed only when it is joined with its neighbours.

    Attributes
    ----------
    unknowns : number of unknowns of the substructure
    left, right : numbers of unknowns of its two lines
    make : function that computes the substructure
    """

    unknowns: int
    left: int
    right: int
    make: Callable[[], ColumnSubstructure]

    @property
    def made(self) -> ColumnSubstructure:
        """The substructure; each access computes it."""
        return self.make()


AnyColumnSubstructure = ColumnSubstructure | ColumnSubstructureMadeWhenNeeded
"""A substructure of element columns, made already or when it is needed."""


def column_with_contact_nodes_at_its_ends_only(
    piece: AnyColumnSubstructure, shared: int
) -> AnyColumnSubstructure:
    """A column without the contact nodes between its two sides, which are eliminated.

    No force acts on these nodes. A column that is made when needed is still made when needed.

    Parameters
    ----------
    piece : the column, which shares contact unknowns with a neighbour on each side
    shared : number of contact unknowns that the column shares with each neighbour
    """
    if isinstance(piece, ColumnSubstructureMadeWhenNeeded):
        make = piece.make
        return ColumnSubstructureMadeWhenNeeded(
            piece.left + 2 * shared + piece.right,
            piece.left,
            piece.right,
            lambda: column_with_contact_nodes_at_its_ends_only(make(), shared).made,
        )
    n = len(piece.K)
    gone = slice(piece.left + shared, n - piece.right - shared)
    # The slices `before` and `behind` are the kept unknowns in the column. In the result the latter
    # ones have the slice `after`.
    before, behind = slice(gone.start), slice(gone.stop, n)
    after = slice(gone.start, n - (gone.stop - gone.start))
    K, C = np.empty((after.stop, after.stop)), np.empty((gone.stop - gone.start, after.stop))
    for columns, to in ((before, before), (behind, after)):
        K[before, to], K[after, to] = piece.K[before, columns], piece.K[behind, columns]
        C[:, to] = piece.K[gone, columns]
    replace_matrix_by_schur_complement(K, C, piece.K[gone, gone].copy())
    return ColumnSubstructure(K, piece.left, piece.right)


class _JoinOfNeighbours(NamedTuple):
    """Two neighbouring stretches of a row of columns that are joined, and the joined stretch.

    Stretches are given by numbers: the distinct columns of the row come first, and each join has
    the next number.
    """

    left: int
    right: int
    joined: int


def assemble_and_condense_row_of_element_columns(
    pieces: Sequence[AnyColumnSubstructure],
    shared: int,
    extra: int = 0,
) -> ColumnSubstructure:
    """The stiffness of a row of element columns, condensed to its two ends and its contact nodes.

    Neighbours share `shared` contact unknowns, and all columns have `extra` common unknowns, the
    factors of unit loads. The pairs that are joined are those of `_order_of_joins_of_row`. If the
    same pair of objects occurs again, its stiffness is not computed again. The stiffness of a pair
    is dropped after its last use. A substructure that is made when needed is made for each join,
    and dropped after the join. This takes little time, because joins have far more multiplications.
    """
    first = dict[int, int]()
    row = [first.setdefault(id(piece), k) for k, piece in enumerate(pieces)]
    sizes = [_SizeOfSubstructure.size_of_column_substructure(piece) for piece in pieces]
    joins = _joins_in_depth_first_order(_order_of_joins_of_row(row, sizes, shared, extra))
    uses = Counter(number for join in joins for number in (join.left, join.right))
    made = dict[int, ColumnSubstructure]()

    def stretch_with_number(number: int) -> ColumnSubstructure:
        """A column, or a joined stretch, which is dropped after its last use."""
        if number < len(pieces):
            return pieces[number].made
        uses[number] -= 1
        return made[number] if uses[number] > 0 else made.pop(number)

    for join in joins:
        made[join.joined] = join_and_condense_neighbouring_substructures(
            stretch_with_number(join.left), stretch_with_number(join.right), shared, extra
        )
    return stretch_with_number(joins[-1].joined if joins else row[0])


def _joins_in_depth_first_order(joins: list[_JoinOfNeighbours]) -> list[_JoinOfNeighbours]:
    """The same joins in an order in which few joined stretches wait for their neighbours.

    All joins of a stretch come before the joins of the next stretch.
    """
    by_number = {join.joined: join for join in joins}
    found: dict[int, _JoinOfNeighbours] = {}
    waiting = [joins[-1].joined] if joins else []
    while waiting:
        join = by_number[waiting[-1]]
        before = [
            number
            for number in (join.right, join.left)
            if number in by_number and number not in found
        ]
        if before:
            waiting.extend(before)
        else:
            found.setdefault(waiting.pop(), join)
    return list(found.values())


class _SizeOfSubstructure(NamedTuple):
    """The number of unknowns of a substructure, and the number on its right line."""

    unknowns: int
    right: int

    @classmethod
    def size_of_column_substructure(cls, piece: AnyColumnSubstructure) -> "_SizeOfSubstructure":
        """The size of a substructure, which need not be computed yet."""
        unknowns = len(piece.K) if isinstance(piece, ColumnSubstructure) else piece.unknowns
        return cls(unknowns, piece.right)


def _order_of_joins_of_row(
    columns: Sequence[int], sizes: Sequence[_SizeOfSubstructure], shared: int, extra: int
) -> list[_JoinOfNeighbours]:
    """The order in which the columns of a row are joined, each pair of columns once.

    Neighbours are joined in pairs, and the pair with the fewest unknowns comes first. This order
    takes only a few percent more multiplications than the best order.

    Parameters
    ----------
    columns : (columns,) number of each column; equal columns have the same number
    sizes : (columns,) size of each column
    shared, extra : as in `assemble_and_condense_row_of_element_columns`
    """
    # The list `row` has the numbers of the stretches that are not joined yet. In each step two
    # neighbours are replaced by one stretch. A pair has the unknowns of both stretches without the
    # line between them, on which both have the same unknowns.
    row = list(columns)
    unknowns, right = [size.unknowns for size in sizes], [size.right for size in sizes]
    counts = [unknowns[i] + unknowns[j] - 2 * right[i] for i, j in pairwise(row)]
    joins: dict[tuple[int, int], _JoinOfNeighbours] = {}
    while counts:
        fewest = min(counts)
        k = counts.index(fewest)
        pair = row[k], row[k + 1]
        if pair not in joins:
            joins[pair] = _JoinOfNeighbours(*pair, len(unknowns))
            unknowns.append(fewest - shared - extra)
            right.append(right[pair[1]])
        joined = joins[pair].joined
        row[k : k + 2] = [joined]
        # The numbers of unknowns change only for the pairs with the new stretch.
        del counts[k]
        if k > 0:
            before = row[k - 1]
            counts[k - 1] = unknowns[before] + unknowns[joined] - 2 * right[before]
        if k < len(counts):
            counts[k] = unknowns[joined] + unknowns[row[k + 1]] - 2 * right[joined]
    return list(joins.values())


def matrix_entries_while_columns_are_joined(side: int, contact: Sequence[int], shared: int) -> int:
    """The largest number of matrix entries that exist at once while large columns are joined.

    The columns are joined in the order of `assemble_and_condense_row_of_element_columns`. All
    columns have different stiffness. Each inner column is made when it is joined. The first and the
    last column have no unknowns on their outer sides; the row of the caller holds them until all
    columns are joined.

    Parameters
    ----------
    side : number of unknowns on each side of a column
    contact : (columns,) number of unknowns of each column's contact; there are at least two columns
    shared : number of contact unknowns that neighbours share
    """
    columns = len(contact)
    sizes = [_SizeOfSubstructure(2 * side + own, side) for own in contact]
    sizes[0] = _SizeOfSubstructure(side + contact[0], side)
    sizes[-1] = _SizeOfSubstructure(side + contact[-1], 0)
    joins = _order_of_joins_of_row(range(columns), sizes, shared, 0)
    unknowns = [*(size.unknowns for size in sizes), *([0] * len(joins))]
    for join in joins:
        unknowns[join.joined] = unknowns[join.left] + unknowns[join.right] - 2 * side - shared
    ends = {0, columns - 1}
    existing, largest = ends.copy(), 0

    def entries_of_existing_stretches() -> int:
        """The number of matrix entries of all stretches that exist at the moment."""
        return sum(unknowns[number] ** 2 for number in existing)

    for join in _joins_in_depth_first_order(joins):
        # The stretches are taken one after the other. The blocks that are copied of a stretch are
        # its stiffness on the eliminated line, its coupling with the remaining unknowns, and the
        # block of these unknowns. A stretch is dropped then, unless the caller holds it.
        n, line = unknowns[join.joined], side**2
        left, right = (unknowns[number] - side for number in (join.left, join.right))
        existing.add(join.left)
        largest = max(largest, entries_of_existing_stretches() + line + side * left + left**2)
        existing -= {join.left} - ends
        existing.add(join.right)
        copied = line + side * n + left**2 + right**2
        largest = max(largest, entries_of_existing_stretches() + copied)
        existing -= {join.right} - ends
        existing.add(join.joined)
        largest = max(largest, entries_of_existing_stretches() + copied)
    return largest


def eliminate_nodes_on_column_side(
    piece: AnyColumnSubstructure, end: Floats | None = None, part: int = 0, *, right: bool = False
) -> ColumnSubstructure:
    """The stiffness of joined columns without the unknowns on one side, which are eliminated.

    Parameters
    ----------
    piece : the substructure of element columns; no other column is attached to the side
    end : (l + part, l + part) stiffness of a body that is attached to the side; None without a
        body. Its l unknowns that the side does not share take the place of the side's unknowns.
        The unknowns of `end` are [l | part] at the left side and [part | l] at the right side.
    part : number of the side's unknowns, the last ones, at which the body is attached
    right : True to eliminate the nodes on the right side, False for the left side
    """
    piece = piece.made
    own = 0 if end is None else len(end) - part
    n, line = len(piece.K), piece.right if right else piece.left
    # The slices `rest` and `gone` are the remaining and the eliminated unknowns in the given
    # stiffness. The slices `kept` and `added` are the remaining unknowns and the attached body's
    # own unknowns in the result.
    if right:
        rest, gone = slice(n - line), slice(n - line, n)
        kept, added = rest, slice(n - line, None)
    else:
        rest, gone = slice(line, n), slice(line)
        kept, added = slice(own, None), slice(own)
    size = own + n - line
    K, C = np.zeros((size, size)), np.zeros((line, size))
    inner = piece.K[gone, gone].copy()
    K[kept, kept], C[:, kept] = piece.K[rest, rest], piece.K[gone, rest]
    if end is not None:
        if right:
            ends, on = slice(part, None), slice(part)
        else:
            ends, on = slice(own), slice(own, None)
        K[added, added] += end[ends, ends]
        C[line - part :, added] += end[on, ends]
        inner[line - part :, line - part :] += end[on, on]
    replace_matrix_by_schur_complement(K, C, inner)
    return ColumnSubstructure(K, piece.left, 0) if right else ColumnSubstructure(K, 0, piece.right)


def rotate_node_axes_of_matrix(K: Floats, angle: Floats) -> Floats:
    """The matrix K (n, n) with the x and y of each node measured in turned axes.

    `angle` (n/2,) [rad] is the angle by which the axes of each of the n/2 nodes are turned.
    """
    return rotate_node_axes_of_vectors(rotate_node_axes_of_vectors(K, angle).T, angle)


def rotate_node_axes_of_vectors(V: Floats, angle: Floats) -> Floats:
    """The vectors V (..., m, n) with the x and y of each node measured in turned axes.

    Each row of V is a vector, with x and y of a node next to each other. `angle` (..., n/2) [rad]
    has the angle by which the axes of each node are turned.
    """
    # The components x + i y of a node are one complex number.
    components = np.ascontiguousarray(V).view(complex)
    turns = np.exp(-1j * angle)[..., None, :]
    return (components * turns).view(float)
