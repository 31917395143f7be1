"""Static condensation of a body by dense matrices, called fronts, over a nested dissection.

The set of elements is halved again and again, into smaller and smaller regions. A node belongs to
the smallest region that contains all elements around it. The unknowns of a region are eliminated
together, by one dense Cholesky factorisation of the region's front. The front is the dense matrix
of the region's own unknowns and of the later unknowns that are coupled with them. The Schur
complement of the front on these later unknowns is added to the front of the earliest of their
regions (multifrontal elimination: Duff & Reid 1983). The work consists of dense matrix products.
The kept unknowns come last. The factors are stored only if the displacements of the eliminated
unknowns are needed.
"""

from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.base.errors import NoAnswer
from drumlin.base.lapack import dpotrf, dsyrk, dtrsm

NODES_OF_SMALLEST_DISSECTION_REGION = 128
"""Approximate number of nodes in the smallest regions of the nested dissection.

Smaller regions need more calls of dense routines, and larger regions more multiplications with
zeros. With 64 or 256 nodes in place of 128, the condensation of eight meshes by Gmsh, of degree 1
to 5, took up to 1.4 times as long. The result is the same apart from round-off.
"""

_PendingSchurComplementsOfEachRegion = list[list[tuple[Ints, Floats]]]
"""For each region the Schur complements of earlier fronts that are still to be added to its front.

Each complement has the numbers of its unknowns (m,) and its lower triangle (m, m).
"""

SINGULAR_BODY_MESSAGE = "singular stiffness: a part hangs on nothing, or moduli are too far apart"
"""Message of the error that is raised if the stiffness of a body is not positive definite."""


class EliminationOrder(NamedTuple):
    """The order in which elimination removes the nodes of a mesh.

    Attributes
    ----------
    nodes : (n,) indices of the nodes in the order of elimination
    region : (n,) number of the region of each of these nodes, not decreasing
    """

    nodes: Ints
    region: Ints


class CondensedSystem(NamedTuple):
    """The equations of a body on its k kept unknowns, after the inner unknowns are eliminated.

    Attributes
    ----------
    S : (k, k) Schur complement on the kept unknowns, the condensed stiffness
    loads : (k, l) condensed loads
    work : (l, l) work of each load on the displacements due to each load, if the kept unknowns are
        zero
    """

    S: Floats
    loads: Floats
    work: Floats


def elimination_order_by_nested_dissection(xy: Floats, elements: Ints) -> EliminationOrder:
    """The order in which the nodes of a mesh are eliminated, by nested dissection.

    The elements of a region are cut into halves across the region's long direction. A node comes
    after all nodes of the smaller regions inside the node's own region.

    Parameters
    ----------
    xy : (2, n) or (3, n) nodes [m]
    elements : (k, m) nodes of each of m elements
    """
    # The set of elements is halved again and again, until the smallest regions have about
    # NODES_OF_SMALLEST_DISSECTION_REGION nodes. The bits of an element's `path` tell in which half
    # the element lies after each halving. The bit of the first halving is the highest bit.
    centre = xy[:, elements].mean(axis=1)
    count = elements.shape[1]
    path = np.zeros(count, dtype=np.int64)
    halvings_to_single_elements = max(0, int(np.ceil(np.log2(count))))
    omitted = round(np.log2(NODES_OF_SMALLEST_DISSECTION_REGION * count / xy.shape[1]))
    depth = halvings_to_single_elements - min(max(omitted, 0), halvings_to_single_elements)
    resolution = 1e-9 * float(np.ptp(centre, axis=1).max()) or 1.0
    # Each level halves every region: its elements are sorted along its long direction, and the
    # second half of them gets the bit 1.
    for level in range(depth):
        size = np.bincount(path, minlength=1 << level)
        from_mean = centre - _mean_of_values_in_each_group(path, centre)
        position = np.round(_positions_along_principal_axis(path, from_mean) / resolution)
        order = np.lexsort((position, path))
        rank = np.empty(count, dtype=np.int64)
        rank[order] = np.arange(count) - (np.cumsum(size) - size)[path[order]]
        path = 2 * path + (rank >= (size[path] + 1) // 2)

    # The bits of an element's path tell which halves contain the element. A region is given by the
    # beginning of a path: the first bits that the paths of all elements at a node have in common.
    first = np.full(xy.shape[1], 1 << depth)
    last = np.full(xy.shape[1], -1)
    for nodes in elements:
        np.minimum.at(first, nodes, path)
        np.maximum.at(last, nodes, path)
    height = np.ceil(np.log2((first ^ last) + 1.0)).astype(np.int64)

    # The paths of a region's elements are a range of whole numbers. Regions are eliminated in the
    # order of the ends of their ranges. Of two ranges with the same end, the shorter range is
    # first.
    end = (first >> height << height) + (1 << height)
    nodes = np.lexsort((height, end))
    other_end = np.diff(end[nodes], prepend=-1).astype(bool)
    other_height = np.diff(height[nodes], prepend=-1).astype(bool)
    return EliminationOrder(nodes, np.cumsum(other_end | other_height) - 1)


def _positions_along_principal_axis(group: Ints, x: Floats) -> Floats:
    """Positions (m,) of points along the principal axis of their group, its long direction.

    `x` (d, m) are the points relative to the mean of their group, and `group` (m,) is the number of
    the group of each point.
    """
    if len(x) == 2:
        xy, xx_yy = _mean_of_values_in_each_group(
            group, np.array([x[0] * x[1], x[0] * x[0] - x[1] * x[1]])
        )
        along = 0.5 * np.arctan2(2 * xy, xx_yy)
        return np.asarray(x[0] * np.cos(along) + x[1] * np.sin(along))
    # `spread` are the second moments of each group about its mean, (groups, 3, 3).
    products = (x[:, None] * x).reshape(len(x) ** 2, -1)
    moments = np.array([np.bincount(group, row) for row in products])
    spread = moments.reshape(len(x), len(x), -1).transpose(2, 0, 1)
    axis = np.linalg.eigh(spread)[1][:, :, -1]
    return np.einsum("md,dm->m", axis[group], x)


def _mean_of_values_in_each_group(group: Ints, values: Floats) -> Floats:
    """For each of m members, the means (k, m) of k quantities over the member's group.

    `values` (k, m) are the quantities, and `group` (m,) is the number of each member's group.
    """
    size = np.maximum(np.bincount(group), 1)
    return np.array([(np.bincount(group, row) / size)[group] for row in values])


def eliminate_inner_unknowns(A: Any, region: Ints, loads: Floats) -> CondensedSystem:
    """The Schur complement of a sparse matrix on its last unknowns, and the condensed loads.

    Parameters
    ----------
    A : (n, n) sparse matrix, symmetric and positive definite
    region : number of the region of each eliminated unknown, not decreasing; the eliminated
        unknowns come first in A, and the kept unknowns last
    loads : (n, l) loads

    Raises
    ------
    NoAnswer
        for a matrix that is not positive definite on the eliminated unknowns
    """
    lower = _lower_triangle_of_sparse_matrix(A)
    complements = _empty_lists_of_schur_complements(region)
    fronts = _factorise_front_of_each_region(lower, region, complements)
    f, work = _condense_loads_by_fronts(fronts, loads)
    S = _schur_complement_on_kept_unknowns(lower, len(region), complements)
    return CondensedSystem(_symmetric_matrix_of_lower_triangle(S), f[len(region) :], work)


class FactorsOfElimination(NamedTuple):
    """The factors of all fronts of a matrix, for any number of right-hand sides.

    The first unknowns of the matrix are eliminated, and its last k unknowns are kept.

    Attributes
    ----------
    fronts : the factorised fronts, in the order of elimination
    order : (n,) indices of the unknowns in the order of elimination; the kept unknowns come last
    """

    fronts: "tuple[CholeskyFactorOfFront, ...]"
    order: Ints

    @classmethod
    def factors_of_sparse_matrix(cls, A: Any, region: Ints) -> "FactorsOfElimination":
        """Eliminate the first unknowns of a sparse matrix.

        Parameters and errors are those of `factorise_fronts_in_any_order`.
        """
        fronts, order = factorise_fronts_in_any_order(A, region)
        return cls(tuple(fronts), order)

    @property
    def memory(self) -> int:
        """The memory [bytes] of the factors."""
        return sum(front.L.nbytes + front.rows_of_later_unknowns.nbytes for front in self.fronts)

    def solve_with_given_last_unknowns(self, right: Floats, given: Floats) -> Floats:
        """The solution x (n, m) of A x = right, in which the kept unknowns have given values.

        The equations of the kept unknowns are left out.

        Parameters
        ----------
        right : (n, m) right-hand sides; the last k rows are not used
        given : (k, m) values of the kept unknowns, the last k unknowns
        """
        x, _ = _condense_loads_by_fronts(self.fronts, right[self.order])
        x[len(x) - len(given) :] = given
        for front in reversed(self.fronts):
            _substitute_back_in_front(front, x)
        found = np.empty_like(x)
        found[self.order] = x
        return found


def factorise_fronts_in_any_order(
    A: Any, region: Ints
) -> "tuple[Iterator[CholeskyFactorOfFront], Ints]":
    """Eliminate the first unknowns of a sparse matrix, which are in any order.

    Returns an iterator over the factorised fronts, and the order of elimination: the indices (n,)
    of the unknowns, of which the kept ones come last. The iterator does the elimination, and raises
    NoAnswer for a matrix that is not positive definite on the eliminated unknowns.

    Parameters
    ----------
    A : (n, n) sparse matrix, symmetric and positive definite
    region : (m,) number of the region of each of the first m unknowns, which are eliminated
    """
    count = A.shape[0]
    order = np.concatenate(
        [np.argsort(region, kind="stable"), np.arange(len(region), count, dtype=np.int64)]
    )
    by_region = region[order[: len(region)]]
    lower = _lower_triangle_of_reordered_matrix(A, order)
    complements = _empty_lists_of_schur_complements(by_region)
    return _factorise_front_of_each_region(lower, by_region, complements), order


def _condense_loads_by_fronts(
    fronts: "Iterable[CholeskyFactorOfFront]", loads: Floats
) -> tuple[Floats, Floats]:
    """Condense loads (n, l) by forward substitution with each front's factor.

    Returns an array (n, l) and the work (l, l) of the loads. In the array, rows of eliminated
    unknowns contain the result of the forward substitution, and rows of kept unknowns the condensed
    loads. The work is the work of each load on the displacements due to each load, if the kept
    unknowns are zero.
    """
    f = np.array(loads, dtype=float)
    work = np.zeros((f.shape[1], f.shape[1]))
    for front in fronts:
        if f.shape[1]:
            y = dtrsm(1.0, front.L, f[front.own], lower=1)
            f[front.own] = y
            f[front.later] -= front.rows_of_later_unknowns @ y
            work += y.T @ y
    return f, work


def _substitute_back_in_front(front: "CholeskyFactorOfFront", x: Floats) -> None:
    """Replace the rows of a front's own unknowns in x (n, m) by the solution.

    The rows of the own unknowns contain the result of the forward substitution, and the rows of
    later unknowns the solution.
    """
    rest = x[front.own] - front.rows_of_later_unknowns.T @ x[front.later]
    x[front.own] = dtrsm(1.0, front.L, rest, lower=1, trans_a=1)


def _symmetric_matrix_of_lower_triangle(S: Floats) -> Floats:
    """The symmetric matrix (k, k) whose lower triangle is that of S."""
    return np.asarray(np.tril(S) + np.tril(S, -1).T)


class CholeskyFactorOfFront(NamedTuple):
    """The Cholesky factor of a front, the dense matrix of one region of the nested dissection.

    Attributes
    ----------
    own : the k unknowns that the front eliminates
    later : (m,) unknowns of later regions that are coupled with the own unknowns
    L : (k, k) Cholesky factor of the block of the own unknowns
    rows_of_later_unknowns : (m, k) rows of the factor for the later unknowns
    """

    own: slice
    later: Ints
    L: Floats
    rows_of_later_unknowns: Floats


def _empty_lists_of_schur_complements(region: Ints) -> _PendingSchurComplementsOfEachRegion:
    """Empty lists in which Schur complements are collected.

    There is one list for each region, and one for the kept unknowns. `region` (n,) is the number of
    the region of each eliminated unknown, not decreasing.
    """
    regions = int(region[-1]) + 1 if len(region) else 0
    return [[] for _ in range(regions + 1)]


def _lower_triangle_of_sparse_matrix(A: Any) -> Any:
    """The lower triangle of a sparse matrix in CSC format, with sorted row numbers."""
    # The import of scipy.sparse takes time, and condensed hp elements do without it.
    import scipy.sparse as sp  # noqa: PLC0415

    lower = sp.tril(A, format="csc")
    lower.sort_indices()
    return lower


def _lower_triangle_of_reordered_matrix(A: Any, order: Ints) -> Any:
    """The lower triangle, in CSC format, of a symmetric matrix with its unknowns in a new order.

    Entry k of `order` (n,) is the index of the unknown that comes k-th.
    """
    # The import of scipy.sparse takes time, and condensed hp elements do without it.
    import scipy.sparse as sp  # noqa: PLC0415

    position = np.empty(len(order), dtype=np.int32)
    position[order] = np.arange(len(order), dtype=np.int32)
    A = A.tocsc()
    rows, columns = position[A.indices], np.repeat(position, np.diff(A.indptr))
    is_lower = rows >= columns
    rows, columns = rows[is_lower], columns[is_lower]
    lower = sp.csc_matrix((A.data[is_lower], (rows, columns)), shape=A.shape)
    lower.sort_indices()
    return lower


def _factorise_front_of_each_region(
    lower: Any, region: Ints, complements: _PendingSchurComplementsOfEachRegion
) -> Iterator[CholeskyFactorOfFront]:
    """Yield the factorised front of each region, in the order of elimination.

    The Schur complement of each front is appended to `complements`.

    Parameters
    ----------
    lower : lower triangle of the sparse matrix
    region : number of the region of each eliminated unknown, not decreasing
    complements : Schur complements of earlier fronts that are to be added to each region's front
    """
    inner, regions = len(region), len(complements) - 1
    starts = np.searchsorted(region, np.arange(regions + 1))
    indptr, indices, data = lower.indptr, lower.indices, lower.data
    is_touched = np.zeros(lower.shape[0], dtype=bool)
    position = np.empty(lower.shape[0], dtype=np.int64)
    for r in range(regions):
        start, end = starts[r], starts[r + 1]
        if start == end:
            continue
        # The front has the region's own unknowns first, then the later unknowns that are coupled
        # with them by entries of the matrix or by complements of earlier fronts.
        span = slice(indptr[start], indptr[end])
        rows = indices[span]
        columns = np.repeat(np.arange(end - start), np.diff(indptr[start : end + 1]))
        for unknowns in (rows, *(numbers for numbers, _ in complements[r])):
            is_touched[unknowns] = True
        touched = start + np.flatnonzero(is_touched[start:])
        is_touched[touched] = False
        position[touched] = np.arange(len(touched))
        F = np.zeros((len(touched), len(touched)), order="F")
        F[position[rows], columns] = data[span]
        _add_schur_complements_to_front(F, position, complements, r)

        own = end - start
        later = touched[own:]
        L, info = dpotrf(F[:own, :own], lower=1)
        if info:
            raise NoAnswer(SINGULAR_BODY_MESSAGE)
        rows_of_later_unknowns = dtrsm(1.0, L, F[own:, :own], side=1, lower=1, trans_a=1)
        if len(later):
            # The complement is added to the front of the earliest region of its unknowns.
            next_region = regions if later[0] >= inner else int(region[later[0]])
            # Only the lower triangle of a complement is computed, and no other entry is used.
            kept = np.array(F[own:, own:], order="F")
            complement = dsyrk(-1.0, rows_of_later_unknowns, 1.0, kept, lower=1, overwrite_c=1)
            complements[next_region].append((later, complement))
        yield CholeskyFactorOfFront(slice(start, end), later, L, rows_of_later_unknowns)


def _schur_complement_on_kept_unknowns(
    lower: Any, inner: int, complements: _PendingSchurComplementsOfEachRegion
) -> Floats:
    """The lower triangle (k, k) of the Schur complement on the k unknowns that are kept.

    The kept unknowns follow the first `inner` unknowns in the matrix `lower`.
    """
    S: Floats = lower[inner:, inner:].toarray(order="F")
    position = np.arange(lower.shape[0]) - inner
    _add_schur_complements_to_front(S, position, complements, len(complements) - 1)
    return S


def _add_schur_complements_to_front(
    F: Floats, position: Ints, complements: _PendingSchurComplementsOfEachRegion, region: int
) -> None:
    """Add the Schur complements of earlier fronts to the lower triangle of a region's front.

    `F` (n, n) is the front of the region number `region`, stored by columns. For the number of an
    unknown in the whole matrix, `position` gives the row that this unknown has in the front.
    """
    # numpy adds at one index of a flat array in half the time that it takes at a pair of indices.
    # The front is stored by columns, so that the array is a view of it.
    flat = F.T.reshape(-1)
    for unknowns, complement in complements[region]:
        own = position[unknowns]
        flat[own[:, None] * len(F) + own] += complement.T
    complements[region] = []
