"""Columns of elements as substructures, condensed to their two sides and their contact nodes.

A column is a stack of elements from the contact inwards. On an arc the displacements of the nodes
on each side are measured along the radius and around the drum. Displacements of nodes between the
sides are measured in the axes of the column's middle. Columns of equal shape then have equal
stiffness wherever they lie, and the stiffness is computed once for each shape.

The nodes on a side of a column form a line. The unknowns of a substructure are [left line | contact
| right line], with x and y of a node together. A line goes from the contact inwards and lacks its
contact node, which belongs to the contact. In a substructure without contact the lines are whole.
`extra` unknowns, which all substructures share, may stand before the others. They are factors of
unit loads, and have a negative stiffness.
"""

from collections.abc import Sequence
from functools import cache
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.fem.hp.element import schur_complement, schur_complements

UnknownsAt = tuple[slice, slice]
"""The slices of some unknowns: in the stiffness of an element, and in that of its column."""


class ColumnUnknowns(NamedTuple):
    """The order of unknowns: which unknowns of an element are which unknowns of its column.

    Attributes
    ----------
    kept : (layers,) unknowns of each element that the condensed column keeps: those on the two
        lines and on the contact
    inside : (layers,) unknowns of each element that are eliminated, by edges from the contact
        inwards
    sides : number of kept unknowns of the column
    rest : number of eliminated unknowns of the column
    line : number of unknowns of a line
    """

    kept: tuple[tuple[UnknownsAt, ...], ...]
    inside: tuple[UnknownsAt, ...]
    sides: int
    rest: int
    line: int


@cache
def order_of_column_unknowns(
    p: int, layers: int, *, contact: bool, held: bool, sides: int = 2
) -> ColumnUnknowns:
    """The order of the unknowns of a column and of its elements.

    Parameters
    ----------
    p : degree
    layers : number of elements
    contact : whether the outermost edge is in contact; otherwise its inner nodes are eliminated
    held : whether the innermost edge is held
    sides : 2; or 1 for the symmetric or the antisymmetric unknowns alone, half of all
    """
    side, edge, node = 2 * (p + 1), sides * (p - 1), 2 * contact
    line = 2 * (layers * p + (not held)) - node
    # In an element the edges begin behind the sides (`own`); in the column the right line begins
    # behind the contact (`far`).
    own = sides * side
    far = line + (edge + sides * node if contact else 0)
    kept, inside = [], []
    for k in range(layers):
        skipped = node if k == 0 else 0
        start, stop = 2 * k * p - node + skipped, min(2 * (k + 1) * p + 2 - node, line)
        count = skipped + stop - start
        left = slice(skipped, count), slice(start, stop)
        right = slice(side + skipped, side + count), slice(far + start, far + stop)
        places = [left, right][:sides]
        # The contact node of each line and the inner contact nodes stand between the lines.
        if k == 0 and contact:
            corners = [
                (slice(node), slice(line, line + node)),
                (slice(side, side + node), slice(far - node, far)),
            ]
            between = slice(own, own + edge), slice(line + node, line + node + edge)
            places += [*corners[:sides], between]
        # The inner nodes of a held edge do not move, and the inner nodes of the contact are kept.
        first_edge = (k == 0 and contact) * edge
        last_edge = (2 - (k + 1 == layers and held)) * edge
        above = (k - contact) * edge
        kept.append(tuple(places))
        in_element = slice(own + first_edge, own + last_edge)
        in_column = slice(above + first_edge, above + last_edge)
        inside.append((in_element, in_column))
    return ColumnUnknowns(
        kept=tuple(kept),
        inside=tuple(inside),
        sides=far + (sides - 1) * line,
        rest=edge * (layers + 1 - contact - held),
        line=line,
    )


def column_stiffness(
    elements: Floats, unknowns: ColumnUnknowns, loads: Floats | None = None
) -> Floats:
    """The condensed stiffness (c, n, n) of c columns of equal layers.

    Parameters
    ----------
    elements : (layers, c, m, m) stiffness of condensed elements
    unknowns : order of the unknowns
    loads : (c, k, l) unit loads on the k unknowns of the innermost edge, of one side; they become
        l extra unknowns
    """
    count = elements.shape[1]
    extra = 0 if loads is None else loads.shape[2]
    size = extra + unknowns.sides
    K = np.zeros((count, size, size))
    C = np.zeros((count, unknowns.rest, size))
    inner = np.zeros((count, unknowns.rest, unknowns.rest))
    sides, coupling = K[:, extra:, extra:], C[:, :, extra:]
    for part, kept, inside in zip(elements, unknowns.kept, unknowns.inside, strict=True):
        _add_element_blocks(part, kept, kept, sides)
        _add_element_blocks(part, (inside,), kept, coupling)
        _add_element_blocks(part, (inside,), (inside,), inner)
    if loads is not None:
        # The first two unknowns of the innermost edge end the line; its other unknowns are
        # eliminated.
        at = slice(extra + unknowns.line - 2, extra + unknowns.line)
        K[:, at, :extra] = -loads[:, :2]
        K[:, :extra, at] = -loads[:, :2].transpose(0, 2, 1)
        C[:, unknowns.rest - loads.shape[1] + 2 :, :extra] = -loads[:, 2:]
    return schur_complements(K, C, inner)


def _add_element_blocks(
    part: Floats, rows: Sequence[UnknownsAt], columns: Sequence[UnknownsAt], target: Floats
) -> None:
    """Add blocks of the elements `part` (c, m, m) of one layer to the columns `target`.

    Parameters
    ----------
    part : (c, m, m) stiffness of one element in each of c columns
    rows, columns : the unknowns of the rows and of the columns of the blocks
    target : (c, n, n) matrices that the blocks are added to
    """
    for own, at in rows:
        for other, to in columns:
            # The statement target[...] += would look the view up twice.
            view = target[:, at, to]
            view += part[:, own, other]


class ColumnSubstructure(NamedTuple):
    """A substructure: the stiffness `K` (n, n) of one column, or of several assembled columns.

    `left` and `right` are the numbers of unknowns of the left and the right line.
    """

    K: Floats
    left: int
    right: int


def assemble_column_pair(
    A: ColumnSubstructure, B: ColumnSubstructure, shared: int, extra: int = 0
) -> ColumnSubstructure:
    """Two neighbouring substructures as one; the line between them is eliminated.

    Parameters
    ----------
    A, B : the left and the right substructure
    shared : number of contact unknowns that both share, the last of A and the first of B
    extra : number of extra unknowns, which both share
    """
    # The shared line begins at `before` in A, and ends at `beyond` in B.
    line = A.right
    before, beyond = len(A.K) - line, extra + line
    n = before - shared + len(B.K) - beyond
    K, C = np.zeros((n, n)), np.zeros((line, n))
    rest = slice(before - shared, None)
    K[:before, :before] = A.K[:before, :before]
    C[:, :before] = A.K[before:, :before]
    # The statement K[...] += would write the views twice.
    own, coupling = K[rest, rest], C[:, rest]
    own += B.K[beyond:, beyond:]
    coupling += B.K[extra:beyond, beyond:]
    if extra:
        K[:extra, :extra] += B.K[:extra, :extra]
        K[:extra, rest] += B.K[:extra, beyond:]
        K[rest, :extra] += B.K[beyond:, :extra]
        C[:, :extra] += B.K[extra:beyond, :extra]
    inner = A.K[before:, before:] + B.K[extra:beyond, extra:beyond]
    return ColumnSubstructure(schur_complement(K, C, inner), A.left, B.right)


def assemble_column_row(
    pieces: Sequence[ColumnSubstructure], shared: int, extra: int = 0
) -> ColumnSubstructure:
    """All substructures of a row as one, condensed to its outer lines and its contact.

    `shared` and `extra` are numbers of unknowns, as in `assemble_column_pair`. The two neighbours
    that make the smallest substructure are assembled first, which takes within a few percent of the
    fewest multiplications. Equal pairs, of the same two objects, are assembled once.
    """
    made = list(pieces)
    first = dict[int, int]()
    row = [first.setdefault(id(piece), k) for k, piece in enumerate(pieces)]
    made_of: dict[tuple[int, int], int] = {}

    def sizes_of(row: list[int]) -> list[int]:
        """Number of unknowns that each pair of neighbours would have."""
        return [len(made[i].K) + len(made[j].K) - 2 * made[i].right for i, j in pairwise(row)]

    sizes = sizes_of(row)
    while sizes:
        k = sizes.index(min(sizes))
        pair = row[k], row[k + 1]
        if pair not in made_of:
            made_of[pair] = len(made)
            made.append(assemble_column_pair(made[pair[0]], made[pair[1]], shared, extra))
        row[k : k + 2] = [made_of[pair]]
        # Only the sizes of the pairs with the new substructure change.
        near = max(k - 1, 0)
        sizes[near : k + 2] = sizes_of(row[near : k + 2])
    return made[row[0]]


def eliminate_side_line(
    piece: ColumnSubstructure, end: Floats | None = None, part: int = 0, *, right: bool = False
) -> ColumnSubstructure:
    """The substructure without the unknowns of its left or right line, which has no neighbour.

    Parameters
    ----------
    piece : the substructure
    end : (l + part, l + part) stiffness of a body that hangs on the line; the l own unknowns of the
        body take the place of the line, on [own | part] on the left, [part | own] on the right
    part : number of the last unknowns of the line that the body hangs on
    right : whether the right line is eliminated; otherwise the left line is
    """
    own = 0 if end is None else len(end) - part
    n, line = len(piece.K), piece.right if right else piece.left
    # In the substructure the unknowns `rest` remain and the unknowns `gone` go. In the result the
    # remaining unknowns are `kept`, and those of the body are `added`.
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
        ends, on = (slice(part, None), slice(part)) if right else (slice(own), slice(own, None))
        K[added, added] += end[ends, ends]
        C[line - part :, added] += end[on, ends]
        inner[line - part :, line - part :] += end[on, on]
    schur_complement(K, C, inner)
    return ColumnSubstructure(K, piece.left, 0) if right else ColumnSubstructure(K, 0, piece.right)


def rotate_matrix_components(K: Floats, angle: Floats) -> Floats:
    """The matrix K (n, n) with each node's components in axes turned by an angle (n/2,) [rad]."""
    return rotate_vector_components(rotate_vector_components(K, angle).T, angle)


def rotate_vector_components(V: Floats, angle: Floats) -> Floats:
    """Vectors V (..., m, n) with each node's components in axes turned by the node's angle.

    Each row has x and y of a node together; the angles (..., n/2) are in rad.
    """
    return (np.ascontiguousarray(V).view(complex) * np.exp(-1j * angle)[..., None, :]).view(float)
