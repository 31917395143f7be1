"""Eliminating the inside of a body: dense fronts over a nested dissection.

The elements are halved again and again; a node belongs to the smallest region that holds all its
elements. Its region's unknowns are eliminated together, by one dense Cholesky factorisation of a
front: the region's own unknowns and those of later regions that they touch. What the front leaves
on the later ones is added to the front of the region that comes next among them (multifrontal
elimination: Duff & Reid 1983). The work is matrix products, and the kept unknowns come last
whatever the sparsity. The factors are kept only where the displacements inside are asked for.
"""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.base.errors import NoAnswer
from drumlin.base.lapack import dpotrf, dtrsm

LEAF_HALVINGS = 5  # halvings that a smallest region goes without: it has up to 32 elements

_Left = list[list[tuple[Ints, Floats]]]

SINGULAR_BODY = "singular stiffness: a part hangs on nothing, or moduli are too far apart"


class Order(NamedTuple):
    """Nodes in the order of elimination (n,), and the region (n,) of each, numbered in that order."""

    nodes: Ints
    region: Ints


class Eliminated(NamedTuple):
    """What the elimination of the inside leaves: S (k, k) on the k kept unknowns, the loads (k, l)
    on them, and the work (l, l) of the loads with the kept unknowns held.
    """

    S: Floats
    loads: Floats
    work: Floats


def dissection(xy: Floats, elements: Ints) -> Order:
    """Nested dissection of a mesh: nodes xy (2, n) or (3, n) [m]; elements (k, m): nodes of each
    element.

    The elements are halved across the long direction of their region. A node comes after all nodes
    of the regions inside its own.
    """
    centre = xy[:, elements].mean(axis=1)
    count = elements.shape[1]
    half = np.zeros(count, dtype=np.int64)  # binary path of halvings
    depth = max(0, int(np.ceil(np.log2(count))))
    resolution = 1e-9 * float(np.ptp(centre, axis=1).max()) or 1.0
    for level in range(depth):
        size = np.bincount(half, minlength=1 << level)
        place = np.round(_along(half, centre - _means(half, centre)) / resolution)
        order = np.lexsort((place, half))
        rank = np.empty(count, dtype=np.int64)
        rank[order] = np.arange(count) - (np.cumsum(size) - size)[half[order]]
        half = 2 * half + (rank >= (size[half] + 1) // 2)
    first = np.full(xy.shape[1], 1 << depth)
    last = np.full(xy.shape[1], -1)
    for nodes in elements:
        np.minimum.at(first, nodes, half)
        np.maximum.at(last, nodes, half)
    height = np.ceil(np.log2((first ^ last) + 1.0)).astype(
        np.int64
    )  # levels up to the common region
    height = np.maximum(height, min(LEAF_HALVINGS, depth))
    end = (first >> height << height) + (1 << height)
    nodes = np.lexsort((height, end))
    new = np.diff(end[nodes], prepend=-1).astype(bool) | np.diff(height[nodes], prepend=-1).astype(
        bool
    )
    return Order(nodes, np.cumsum(new) - 1)


def _along(group: Ints, x: Floats) -> Floats:
    """Places (m,) of the points x (d, m) of groups (m,), off the middle of each, along its
    principal axis.
    """
    if len(x) == 2:
        xy, xx_yy = _means(group, np.array([x[0] * x[1], x[0] * x[0] - x[1] * x[1]]))
        along = 0.5 * np.arctan2(2 * xy, xx_yy)
        return np.asarray(x[0] * np.cos(along) + x[1] * np.sin(along))
    spread = np.array([[np.bincount(group, a * b) for b in x] for a in x]).transpose(2, 0, 1)
    axis = np.linalg.eigh(spread)[1][:, :, -1]
    return np.einsum("md,dm->m", axis[group], x)


def _means(group: Ints, values: Floats) -> Floats:
    """Mean of each row of `values` (k, m) over the members of a member's group (m,): (k, m)."""
    size = np.bincount(group)
    return np.array([(np.bincount(group, row) / np.maximum(size, 1))[group] for row in values])


def eliminate(A: Any, region: Ints, loads: Floats) -> Eliminated:
    """Eliminate the first len(region) unknowns of a symmetric positive definite sparse A (n, n).

    region: number of the region of each of them, not decreasing; loads (n, l). Raises NoAnswer for
    a matrix that is not positive definite on them.
    """
    lower, inner, left = _lower(A), len(region), _nothing(region)
    f = np.array(loads, dtype=float)
    work = np.zeros((f.shape[1], f.shape[1]))
    for front in _fronts(lower, region, left):
        if f.shape[1]:
            y = dtrsm(1.0, front.L, f[front.own], lower=1)
            f[front.later] -= front.below @ y
            work += y.T @ y
    S = _kept(lower, inner, left)
    return Eliminated(np.tril(S) + np.tril(S, -1).T, f[inner:], work)


def solve(A: Any, region: Ints, right: Floats) -> Floats:
    """The solution (n, m) of A x = right for a symmetric positive definite sparse A (n, n).

    The fronts of the elimination are kept until the solution is substituted back. `region` is as of
    `eliminate`; the unknowns behind them are solved for together. Raises NoAnswer for a matrix that
    is not positive definite.
    """
    lower, inner, left = _lower(A), len(region), _nothing(region)
    x = np.array(right, dtype=float)
    fronts = []
    for front in _fronts(lower, region, left):
        x[front.own] = dtrsm(1.0, front.L, x[front.own], lower=1)
        x[front.later] -= front.below @ x[front.own]
        fronts.append(front)
    L, info = dpotrf(_kept(lower, inner, left), lower=1)
    if info:
        raise NoAnswer(SINGULAR_BODY)
    x[inner:] = dtrsm(1.0, L, dtrsm(1.0, L, x[inner:], lower=1), lower=1, trans_a=1)
    while fronts:
        front = fronts.pop()
        x[front.own] = dtrsm(
            1.0, front.L, x[front.own] - front.below.T @ x[front.later], lower=1, trans_a=1
        )
    return x


class _FrontFactor(NamedTuple):
    """What the elimination of the unknowns `own` of a region is: the Cholesky factor `L` (k, k) of
    their part of the front, and the rows `below` (m, k) of the factor for the unknowns `later` (m,)
    that they touch."""

    own: slice
    later: Ints
    L: Floats
    below: Floats


def _nothing(region: Ints) -> _Left:
    """A place for each region, and a last one for the kept unknowns, for what earlier fronts leave
    on its unknowns."""
    regions = int(region[-1]) + 1 if len(region) else 0
    return [[] for _ in range(regions + 1)]


def _lower(A: Any) -> Any:
    """The lower triangle of a sparse matrix, by columns in order."""
    import scipy.sparse as sp  # noqa: PLC0415  (meshes alone load it)

    lower = sp.tril(A, format="csc")
    lower.sort_indices()
    return lower


def _fronts(lower: Any, region: Ints, left: _Left) -> Iterator[_FrontFactor]:
    """The fronts of all regions in turn; what they leave on later unknowns goes to `left`."""
    inner, regions = len(region), len(left) - 1
    starts = np.searchsorted(region, np.arange(regions + 1))
    indptr, indices, data = lower.indptr, lower.indices, lower.data
    for r in range(regions):
        a, b = starts[r], starts[r + 1]
        if a == b:
            continue
        span = slice(indptr[a], indptr[b])
        rows = indices[span]
        columns = np.repeat(np.arange(b - a), np.diff(indptr[a : b + 1]))
        touched = np.unique(np.concatenate([rows, *(unknowns for unknowns, _ in left[r])]))
        F = np.zeros((len(touched), len(touched)), order="F")
        F[np.searchsorted(touched, rows), columns] = data[span]
        _gather(F, touched, left, r)
        own, later = b - a, touched[b - a :]
        L, info = dpotrf(F[:own, :own], lower=1)
        if info:
            raise NoAnswer(SINGULAR_BODY)
        below = dtrsm(1.0, L, F[own:, :own], side=1, lower=1, trans_a=1)
        if len(later):
            after = regions if later[0] >= inner else int(region[later[0]])
            left[after].append((later, np.subtract(F[own:, own:], below @ below.T, order="F")))
        yield _FrontFactor(slice(a, b), later, L, below)


def _kept(lower: Any, inner: int, left: _Left) -> Floats:
    """The lower triangle of the stiffness (k, k) that the elimination of the `inner` ones leaves on
    the others."""
    S: Floats = lower[inner:, inner:].toarray(order="F")
    _gather(S, np.arange(inner, lower.shape[0]), left, len(left) - 1)
    return S


def _gather(F: Floats, touched: Ints, left: _Left, region: int) -> None:
    """Add what earlier fronts left on the unknowns `touched` (n,) to the lower triangle of a front
    F (n, n).
    """
    for unknowns, rest in left[region]:
        place = np.searchsorted(touched, unknowns)
        F.T[np.ix_(place, place)] += rest.T  # rows that lie together in memory
    left[region] = []
