"""Columns of elements along a lining, condensed to their two sides and their contact, and merged.

A column is a stack of elements from the contact inwards. Displacements are counted in directions of
their own, on an arc on each side along the radius and around the drum, between the sides as in the
column's middle; so equal columns are one and the same, wherever they stand, and are made once.

Unknowns of a piece, x and y of a node together: [left line | contact | right line]. The lines go
from the contact inwards without their contact node; a piece without contact has whole lines. Before
them may stand `extra` ones, which all pieces share: loads, as unknowns of negative stiffness.
"""

from collections.abc import Sequence
from functools import cache
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.fem.hp.element import schur_complement, schur_complements

UnknownsAt = tuple[slice, slice]  # unknowns of an element, and where they are


class Stack(NamedTuple):
    """Where the unknowns of the layers of a column are: `kept` (layers,) of its two lines and its
    contact among all `sides` of these, with `line` in a line; `inside` (layers,) of its `rest`, by
    edges from the contact inwards.
    """

    kept: tuple[tuple[UnknownsAt, ...], ...]
    inside: tuple[UnknownsAt, ...]
    sides: int
    rest: int
    line: int


@cache
def stack(p: int, layers: int, *, contact: bool, held: bool, sides: int = 2) -> Stack:
    """Without `contact` the inner nodes of the outermost edge go with the rest; `held`: the
    innermost edge is held.

    sides: 1 for the symmetric or the antisymmetric unknowns alone, half of all.
    """
    side, edge, node = 2 * (p + 1), sides * (p - 1), 2 * contact
    line = 2 * (layers * p + (not held)) - node
    own = sides * side  # where the edges of an element begin
    far = line + (edge + sides * node if contact else 0)  # where the right line begins
    kept, inside = [], []
    for k in range(layers):
        skipped = node if k == 0 else 0
        start, stop = 2 * k * p - node + skipped, min(2 * (k + 1) * p + 2 - node, line)
        count = skipped + stop - start
        places = [
            (slice(i * side + skipped, i * side + count), slice(i * far + start, i * far + stop))
            for i in range(sides)
        ]
        if k == 0 and contact:
            corners = [
                (slice(node), slice(line, line + node)),
                (slice(side, side + node), slice(far - node, far)),
            ]
            places += [
                *corners[:sides],
                (slice(own, own + edge), slice(line + node, line + node + edge)),
            ]
        a, b = (k == 0 and contact) * edge, (2 - (k + 1 == layers and held)) * edge
        above = (k - contact) * edge
        kept.append(tuple(places))
        inside.append((slice(own + a, own + b), slice(above + a, above + b)))
    return Stack(
        tuple(kept),
        tuple(inside),
        far + (sides - 1) * line,
        edge * (layers + 1 - contact - held),
        line,
    )


def columns(elements: Floats, of: Stack, loads: Floats | None = None) -> Floats:
    """Columns (c, n, n) of condensed elements (layers, c, m, m), without what is inside them.

    loads (c, k, l): unit loads on the k unknowns of the innermost edge, of one side; they become l
    extra unknowns.
    """
    count, extra = elements.shape[1], 0 if loads is None else loads.shape[2]
    K = np.zeros((count, extra + of.sides, extra + of.sides))
    C = np.zeros((count, of.rest, extra + of.sides))
    inner = np.zeros((count, of.rest, of.rest))
    sides, coupling = K[:, extra:, extra:], C[:, :, extra:]
    for part, kept, inside in zip(elements, of.kept, of.inside, strict=True):
        for places, others, target in (
            (kept, kept, sides),
            ([inside], kept, coupling),
            ([inside], [inside], inner),
        ):
            for own, at in places:
                for other, to in others:
                    view = target[:, at, to]  # target[...] += would look it up twice
                    view += part[:, own, other]
    if loads is not None:
        at = slice(extra + of.line - 2, extra + of.line)
        K[:, at, :extra] = -loads[:, :2]
        K[:, :extra, at] = -loads[:, :2].transpose(0, 2, 1)
        C[:, of.rest - loads.shape[1] + 2 :, :extra] = -loads[:, 2:]
    return schur_complements(K, C, inner)


class ColumnSubstructure(NamedTuple):
    """Stiffness `K` (n, n) of a column or of several merged, and how many unknowns its `left` and
    `right` line have.
    """

    K: Floats
    left: int
    right: int


def assembled_pair(
    A: ColumnSubstructure, B: ColumnSubstructure, shared: int, extra: int = 0
) -> ColumnSubstructure:
    """Neighbouring pieces as one, without the line between them; they share the last and first
    `shared` unknowns of their contacts.
    """
    line = A.right
    before, beyond = (
        len(A.K) - line,
        extra + line,
    )  # of A: where the line begins, of B: where it ends
    n = before - shared + len(B.K) - beyond
    K, C = np.zeros((n, n)), np.zeros((line, n))
    rest = slice(before - shared, None)
    K[:before, :before] = A.K[:before, :before]
    C[:, :before] = A.K[before:, :before]
    own, coupling = K[rest, rest], C[:, rest]  # K[...] += would write them twice
    own += B.K[beyond:, beyond:]
    coupling += B.K[extra:beyond, beyond:]
    if extra:
        K[:extra, :extra] += B.K[:extra, :extra]
        K[:extra, rest] += B.K[:extra, beyond:]
        K[rest, :extra] += B.K[beyond:, :extra]
        C[:, :extra] += B.K[extra:beyond, :extra]
    return ColumnSubstructure(
        schur_complement(K, C, A.K[before:, before:] + B.K[extra:beyond, extra:beyond]),
        A.left,
        B.right,
    )


def assembled(
    pieces: Sequence[ColumnSubstructure], shared: int, extra: int = 0
) -> ColumnSubstructure:
    """One piece of all, in their order.

    The neighbours that make the smallest piece go first: that is within a few percent of the fewest
    multiplications. Equal pairs, of the same two objects, are merged once.
    """
    found, first = list(pieces), dict[int, int]()
    row = [first.setdefault(id(piece), k) for k, piece in enumerate(pieces)]
    made: dict[tuple[int, int], int] = {}

    def sizes_of(row: list[int]) -> list[int]:
        return [len(found[i].K) + len(found[j].K) - 2 * found[i].right for i, j in pairwise(row)]

    sizes = sizes_of(row)
    while sizes:
        k = sizes.index(min(sizes))
        pair = row[k], row[k + 1]
        if pair not in made:
            made[pair] = len(found)
            found.append(assembled_pair(found[pair[0]], found[pair[1]], shared, extra))
        row[k : k + 2] = [made[pair]]
        near = max(k - 1, 0)
        sizes[near : k + 2] = sizes_of(row[near : k + 2])
    return found[row[0]]


def without_line(
    piece: ColumnSubstructure, end: Floats | None = None, part: int = 0, *, right: bool = False
) -> ColumnSubstructure:
    """A piece without its left or its right line, which has no neighbour.

    end (l + part, l + part): stiffness of what hangs on the last `part` unknowns of the line, with
    l unknowns of its own, which come to stand in the place of the line: on [own | part] on the
    left, [part | own] on the right.
    """
    own, n, line = (
        0 if end is None else len(end) - part,
        len(piece.K),
        piece.right if right else piece.left,
    )
    rest, gone = (slice(n - line), slice(n - line, n)) if right else (slice(line, n), slice(line))
    K, C, inner = (
        np.zeros((own + n - line,) * 2),
        np.zeros((line, own + n - line)),
        piece.K[gone, gone].copy(),
    )
    at = slice(n - line) if right else slice(own, None)
    K[at, at], C[:, at] = piece.K[rest, rest], piece.K[gone, rest]
    if end is not None:
        ends, on = (slice(part, None), slice(part)) if right else (slice(own), slice(own, None))
        at = slice(n - line, None) if right else slice(own)
        K[at, at] += end[ends, ends]
        C[line - part :, at] += end[on, ends]
        inner[line - part :, line - part :] += end[on, on]
    schur_complement(K, C, inner)
    return ColumnSubstructure(K, piece.left, 0) if right else ColumnSubstructure(K, 0, piece.right)


def turned(K: Floats, angle: Floats) -> Floats:
    """K (n, n) with the components of each node in directions turned by its angle (n/2,) [rad]."""
    return turned_rows(turned_rows(K, angle).T, angle)


def turned_rows(V: Floats, angle: Floats) -> Floats:
    """Rows of vectors V (..., m, n), x and y of a node together, in directions turned by its angle
    (..., n/2).
    """
    return (np.ascontiguousarray(V).view(complex) * np.exp(-1j * angle)[..., None, :]).view(float)
