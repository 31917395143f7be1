"""Columns of elements along a lining, condensed to their two sides and their contact, and merged pairwise.

A column is a stack of elements from the contact inwards. Displacements are counted in directions of their own at each
node, on an arc along the radius and around the drum; so equal columns are one and the same, wherever they stand, and
are made once. Neighbours merge pairwise, level by level, each level in a few batched products.

Unknowns of a piece, x and y of a node together: [extra | left line | inner contact | right line], lines from the
contact inwards. `extra` are shared by all pieces: loads, which stand in the matrix as unknowns of negative stiffness.
"""

from functools import cache
from typing import NamedTuple

import numpy as np

from drumlin.arrays import Floats, Ints
from drumlin.fem.hp.element import element, eliminate, without


class Stack(NamedTuple):
    """Unknowns of a stack of elements, in the order [left line | inner contact | right line | rest | held].

    `place` (layers, n): those of each element's boundary; `sides`: how many there are up to the right line, `free` up
    to the held ones, `size` of all; `line`: of a line; `back` (2 (p + 1),): those of the innermost edge.
    """

    place: Ints
    sides: int
    free: int
    size: int
    line: int
    back: Ints


@cache
def stack(p: int, layers: int, *, contact: bool, held: bool) -> Stack:
    """Without `contact` the inner nodes of the outermost edge go with the rest; `held`: the innermost edge is held."""
    rows, last = layers * p + 1, layers * p
    free = rows - held
    kept = [(i, 0) for i in range(free)] + [(0, j) for j in range(1, p) if contact] + [(i, p) for i in range(free)]
    rest = [(i, j) for i in range(p if contact else 0, free, p) for j in range(1, p)]
    gone = [(last, j) for j in range(p + 1) if held]
    place = np.zeros((rows, p + 1, 2), dtype=np.int64)
    for k, (i, j) in enumerate(kept + rest + gone):
        place[i, j] = 2 * k, 2 * k + 1
    ref = element(p)
    at = [place[k * p : k * p + p + 1].reshape(-1, 2)[ref.order[: ref.outer]].ravel() for k in range(layers)]
    count = 2 * len(kept + rest + gone)
    return Stack(np.array(at), 2 * len(kept), 2 * len(kept + rest), count, 2 * free, place[last].ravel())


def columns(elements: Floats, of: Stack, loads: Floats | None = None) -> Floats:
    """Columns (c, n, n) of condensed elements (layers, c, m, m), without what is inside them.

    loads (c, k, l): unit loads on the k unknowns of the innermost edge; they become l extra unknowns.
    """
    extra = 0 if loads is None else loads.shape[2]
    K = np.zeros((elements.shape[1], extra + of.size, extra + of.size))
    for place, part in zip(of.place + extra, elements, strict=True):
        K[:, place[:, None], place] += part
    if loads is not None:
        K[:, :extra, extra + of.back] = -loads.transpose(0, 2, 1)
        K[:, extra + of.back, :extra] = -loads
    return eliminate(K[:, : extra + of.free, : extra + of.free], extra + of.sides)


def turned(K: Floats, angle: Floats, extra: int = 0) -> Floats:
    """K (..., n, n) with the components of each node in directions turned by its angle (..., n/2) [rad]; extra unknowns
    are left alone."""
    if extra:
        own, rest = slice(extra), slice(extra, None)
        out = np.array(K)
        out[..., rest, rest] = turned(K[..., rest, rest], angle)
        out[..., own, rest] = turned_rows(K[..., own, rest], angle)
        out[..., rest, own] = np.swapaxes(out[..., own, rest], -1, -2)
        return out
    phase = np.exp(-1j * angle)[..., None, :]
    K = np.ascontiguousarray(K)
    for _ in range(2):  # its columns, then its rows
        K = np.ascontiguousarray(np.swapaxes((K.view(complex) * phase).view(float), -1, -2))
    return K


def turned_rows(V: Floats, angle: Floats) -> Floats:
    """Rows of vectors V (..., m, n), x and y of a node together, in directions turned by its angle (..., n/2)."""
    return (np.ascontiguousarray(V).view(complex) * np.exp(-1j * angle)[..., None, :]).view(float)


def merge(A: Floats, B: Floats, line: int, top: int, extra: int = 0) -> Floats:
    """Neighbouring pieces (b, n, n) and (b, m, m) as one; of the line between them its first `top` unknowns stay."""
    n, m = A.shape[1], B.shape[1]
    before = n - line + top  # of A: all but the inner part of the line
    kept = before + m - extra - line
    own, middle = slice(extra, extra + top), slice(before - top, before)
    K = np.zeros((len(A), kept, kept))
    K[:, :before, :before] = A[:, :before, :before]
    C = np.zeros((len(A), line - top, kept))  # of the inner part of the line with the rest
    C[:, :, :before] = A[:, before:, :before]
    inner, beyond = slice(extra + top, extra + line), slice(extra + line, None)
    for target, source in ((slice(extra), slice(extra)), (middle, own), (slice(before, None), beyond)):
        C[:, :, target] += B[:, inner, source]
        for other, row in ((slice(extra), slice(extra)), (middle, own), (slice(before, None), beyond)):
            K[:, other, target] += B[:, row, source]
    return without(K, C, A[:, before:, before:] + B[:, inner, inner])


def merged(K: Floats, line: int, top: int, extra: int = 0) -> Floats:
    """All columns K (m, n, n), in their order, as one piece (k, k); a last one without a neighbour waits."""
    waiting = None
    while True:
        even = len(K) - len(K) % 2
        if len(K) > even:
            waiting = K[even:] if waiting is None else merge(K[even:], waiting, line, top, extra)
        if not even:
            assert waiting is not None  # there is a column
            return waiting[0]
        K = merge(K[0:even:2], K[1:even:2], line, top, extra)
