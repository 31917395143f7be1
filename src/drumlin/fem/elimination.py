"""Eliminating the inside of a body: dense fronts over a nested dissection.

The elements are halved again and again; a node belongs to the smallest region that holds all its elements. Its
region's unknowns are eliminated together, by one dense Cholesky factorisation of a front: the region's own
unknowns and those of later regions that they touch. What the front leaves on the later ones is added to the
front of the region that comes next among them (multifrontal elimination: Duff & Reid 1983). The work is matrix
products, the kept unknowns come last whatever the sparsity, nothing of the factors is stored.
"""

from typing import Any, NamedTuple

import numpy as np

from drumlin.arrays import Floats, Ints
from drumlin.errors import NoAnswer
from drumlin.lapack import dpotrf, dtrsm

LEAF = 5  # halvings that a smallest region goes without: it has up to 32 elements

SINGULAR = "singular stiffness: a part hangs on nothing, or moduli are too far apart"


class Order(NamedTuple):
    """Nodes in the order of elimination (n,), and the region (n,) of each, numbered in that order."""

    nodes: Ints
    region: Ints


class Eliminated(NamedTuple):
    """What the elimination of the inside leaves: S (k, k) on the k kept unknowns, the loads (k, l) on them, and the
    work (l, l) of the loads with the kept unknowns held."""

    S: Floats
    loads: Floats
    work: Floats


def dissection(xy: Floats, elements: Ints) -> Order:
    """Nested dissection of a mesh: nodes xy (2, n) or (3, n) [m]; elements (k, m): nodes of each element.

    The elements are halved across the long direction of their region. A node comes after all nodes of the regions
    inside its own.
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
    height = np.ceil(np.log2((first ^ last) + 1.0)).astype(np.int64)  # levels up to the common region
    height = np.maximum(height, min(LEAF, depth))
    end = (first >> height << height) + (1 << height)
    nodes = np.lexsort((height, end))
    new = np.diff(end[nodes], prepend=-1).astype(bool) | np.diff(height[nodes], prepend=-1).astype(bool)
    return Order(nodes, np.cumsum(new) - 1)


def _along(group: Ints, x: Floats) -> Floats:
    """Places (m,) of the points x (d, m) of groups (m,), off the middle of each, along its principal axis."""
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

    region: number of the region of each of them, not decreasing; loads (n, l). Raises NoAnswer for a matrix that
    is not positive definite on them.
    """
    inner, regions = len(region), int(region[-1]) + 1 if len(region) else 0
    starts = np.searchsorted(region, np.arange(regions + 1))
    import scipy.sparse as sp  # noqa: PLC0415  (meshes alone load it)

    lower = sp.tril(A, format="csc")
    lower.sort_indices()
    indptr, indices, data = lower.indptr, lower.indices, lower.data
    f = np.array(loads, dtype=float)
    work = np.zeros((f.shape[1], f.shape[1]))
    left: list[list[tuple[Ints, Floats]]] = [[] for _ in range(regions + 1)]
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
            raise NoAnswer(SINGULAR)
        below = dtrsm(1.0, L, F[own:, :own], side=1, lower=1, trans_a=1)
        if f.shape[1]:
            y = dtrsm(1.0, L, f[a:b], lower=1)
            f[later] -= below @ y
            work += y.T @ y
        if len(later):
            after = regions if later[0] >= inner else int(region[later[0]])
            left[after].append((later, np.subtract(F[own:, own:], below @ below.T, order="F")))
    kept = np.arange(inner, A.shape[0])
    S = lower[inner:, inner:].toarray(order="F")
    _gather(S, kept, left, regions)
    return Eliminated(np.tril(S) + np.tril(S, -1).T, f[inner:], work)


def _gather(F: Floats, touched: Ints, left: list[list[tuple[Ints, Floats]]], region: int) -> None:
    """Add what earlier fronts left on the unknowns `touched` (n,) to the lower triangle of a front F (n, n)."""
    for unknowns, rest in left[region]:
        place = np.searchsorted(touched, unknowns)
        F.T[np.ix_(place, place)] += rest.T  # rows that lie together in memory
    left[region] = []
