"""The isoparametric quadrilateral of degree p: shape functions, stiffness, static condensation.

Nodes lie at Gauss-Lobatto points in both directions. skfem's ElementQuadP spans the same
polynomials; its values at the nodes turn its hierarchical functions into these nodal ones, once for
each degree. Displacements use the functions that map the element, so that rigid-body modes are
exact (Zienkiewicz & Taylor, The Finite Element Method, section 8).
"""

from collections.abc import Iterator
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial.legendre import leggauss

from drumlin.base.arrays import Floats, Ints
from drumlin.base.errors import NoAnswer
from drumlin.base.lapack import dgemm, dpotrf, dtrsm
from drumlin.fem.substructure.elasticity import directions_through_layers, split_elasticity
from drumlin.response.resultants import lobatto

SLOPES_PER_BATCH = 32_000
"""Number of slopes of shape functions in a batch of elements whose stiffness is computed together.

A batch of this size stays in the processor's cache. Larger and smaller batches give the same
stiffness, but take more time.
"""
SINGULAR_ELEMENT = (
    "singular stiffness: a part hangs on nothing, or moduli or sizes are too far apart"
)
"""Refusal of an element whose stiffness on its inner nodes is not positive definite."""


class ReferenceElement(NamedTuple):
    """The element of degree p on the unit square, with a = (p + 1)^2 nodes and q Gauss points.

    Attributes
    ----------
    slopes : (a, 2 q) derivatives of the shape functions by both coordinates at the Gauss points
    weights : (q,) weights of the Gauss points
    order : (a,) the order of the element's nodes: those on the boundary, then those inside. The
        numbers are those of the (p + 1)^2 grid of nodes, counted along the layers first.
    outer : number of nodes on the boundary; their order is left side, right side, rest of the
        first edge, rest of the last edge
    values : (a, q) shape functions at the Gauss points
    """

    slopes: Any
    weights: Any
    order: Ints
    outer: int
    values: Any


@cache
def reference_element(p: int, *, precise: bool = False) -> ReferenceElement:
    """The reference element of degree p >= 2; with `precise` its slopes are in long double."""
    x, w = unit_gauss_rule(p)
    number = np.arange((p + 1) ** 2).reshape(p + 1, p + 1)
    edges = number[:, 0], number[:, -1], number[0, 1:-1], number[-1, 1:-1]
    order = np.concatenate([*edges, number[1:-1, 1:-1].ravel()])
    functions = (
        _long_double_shape_functions(p, x) if precise else shape_functions(p, square_grid_points(x))
    )
    values, slopes = functions
    return ReferenceElement(
        slopes=np.ascontiguousarray(slopes[order].reshape(len(order), -1)),
        weights=np.outer(w, w).ravel(),
        order=order,
        outer=4 * p,
        values=values[order],
    )


def unit_gauss_rule(p: int) -> tuple[Floats, Floats]:
    """The p + 1 Gauss points of [0, 1] and their weights."""
    x, w = leggauss(p + 1)
    return 0.5 * (x + 1), 0.5 * w


def unit_edge_nodes(p: int) -> Floats:
    """The p + 1 Gauss-Lobatto points of [0, 1], at which the nodes of an edge lie."""
    return 0.5 * (lobatto(p) + 1)


def square_grid_points(x: Floats) -> Floats:
    """The points (2, n n) of the square grid of x (n,); the first coordinate grows by rows."""
    return np.array([np.repeat(x, len(x)), np.tile(x, len(x))])


def shape_functions(p: int, x: Floats) -> tuple[Floats, Floats]:
    """Values (a, q) and slopes (a, 2, q) of an element's nodal functions at points x (2, q).

    The element is the unit square [0, 1]^2. Its nodes are counted by rows of their grid.
    """
    # scikit-fem loads only with finite elements; the pressure laws do without.
    import skfem  # noqa: PLC0415

    hierarchical = skfem.ElementQuadP(p) if p > 2 else skfem.ElementQuad2()
    count = (p + 1) ** 2
    at_nodes = [
        hierarchical.lbasis(square_grid_points(unit_edge_nodes(p)), i)[0] for i in range(count)
    ]
    at_points = [hierarchical.lbasis(x, i) for i in range(count)]
    values = np.array([value for value, _ in at_points])
    slopes = np.array([slope for _, slope in at_points])
    # The nodal functions are one at their own node and zero at the others.
    nodal: Floats = np.asarray(np.linalg.inv(np.array(at_nodes)), dtype=float)
    return nodal @ values, (nodal @ slopes.reshape(count, -1)).reshape(slopes.shape)


def _long_double_shape_functions(p: int, x: Floats) -> tuple[Any, Any]:
    """Values (a, q) and slopes (a, 2, q) of the nodal functions at the grid of x, in long double.

    They are products of Lagrange's polynomials.
    """
    nodes = unit_edge_nodes(p).astype(np.longdouble)
    x = x.astype(np.longdouble)
    apart = nodes[:, None] - nodes + np.eye(p + 1)

    def product(i: int, *others: int) -> Any:
        """The product of the factors of polynomial i, without the factors of the nodes `others`."""
        kept = [j for j in range(p + 1) if j != i and j not in others]
        return np.prod([(x - nodes[j]) / apart[i, j] for j in kept], axis=0)

    def derivative(i: int) -> Any:
        """The derivative of polynomial i, by the product rule."""
        return sum(product(i, k) / apart[i, k] for k in range(p + 1) if k != i)

    value = np.array([product(i) for i in range(p + 1)])
    slope = np.array([derivative(i) for i in range(p + 1)])
    both = [np.einsum("ik,jl->ijkl", slope, value), np.einsum("ik,jl->ijkl", value, slope)]
    slopes = np.stack([each.reshape((p + 1) ** 2, -1) for each in both], axis=1)
    return np.einsum("ik,jl->ijkl", value, value).reshape((p + 1) ** 2, -1), slopes


def element_gauss_points(xy: Any, p: int) -> Any:
    """The Gauss points (e, 2, q) of elements with nodes xy (e, 2, a) [m], as precise as xy."""
    return xy @ reference_element(p, precise=xy.dtype == np.longdouble).values


def element_stiffness(xy: Any, elasticity: Any, p: int, along: Any = None) -> Any:
    """The plane-stress stiffness (e, a, 2, a, 2) of elements, in the precision of xy.

    The nodes stand in the order of `ReferenceElement`. With the constants of
    `elasticity.split_elasticity` and the unit vectors d = t along and
    n through the layers

        K_ai,bj = Int lambda psi_a,i psi_b,j + mu psi_a,j psi_b,i + mu delta_ij psi_a,k psi_b,k
                      + sum_d s_d d_i (d . grad psi_a) d_j (d . grad psi_b) dA,   s_t = a,  s_n = b.

    Parameters
    ----------
    xy : (e, 2, a) nodes [m]
    elasticity : (e, 3, 3) elasticity matrices times the width [N/m]
    p : degree
    along : (e, 2, q) unit vectors along the layers at the `element_gauss_points`; None where all
        layers are isotropic
    """
    return _element_integrals(xy, elasticity, p, along).stiffness(slice(None), slice(None))


class _ElementIntegrals(NamedTuple):
    """Integrals of products of shape functions' gradients, which make the stiffness of elements.

    Attributes
    ----------
    products : (e, 2, a, 2, a) Int psi_a,i psi_b,j dA for i, a, j, b
    constants : (e, 4) lambda, mu, a, b of `elasticity.split_elasticity`
    directed : (m,) the elements whose layers are not isotropic
    strains : (2, m, a, 2, q) strains of the directed elements along and through their layers due to
        unit displacements, times the root of dA
    """

    products: Any
    constants: Any
    directed: Ints
    strains: tuple[Any, ...]

    def stiffness(self, rows: slice, columns: slice) -> Any:
        """The stiffness (e, rows, 2, columns, 2) of the forces on `rows` by the nodes `columns`."""
        lam, mu = self.constants[:, :1, None], self.constants[:, 1:2, None]
        xx, xy = self.products[:, 0, rows, 0, columns], self.products[:, 0, rows, 1, columns]
        yx, yy = self.products[:, 1, rows, 0, columns], self.products[:, 1, rows, 1, columns]
        K = np.empty((len(xx), xx.shape[1], 2, xx.shape[2], 2), dtype=self.products.dtype)
        np.add((lam + 2 * mu) * xx, mu * yy, out=K[:, :, 0, :, 0])
        np.add((lam + 2 * mu) * yy, mu * xx, out=K[:, :, 1, :, 1])
        np.add(lam * xy, mu * yx, out=K[:, :, 0, :, 1])
        np.add(lam * yx, mu * xy, out=K[:, :, 1, :, 0])
        if len(self.directed):
            K[self.directed] += self._directional_stiffness(rows, columns)
        return K

    def _directional_stiffness(self, rows: slice, columns: slice) -> Any:
        """The stiffness (m, rows, 2, columns, 2) that orthotropy along and through layers adds."""

        def work(strain: Any) -> Any:
            """The integrals of products of two strains: one of `rows`, one of `columns`."""
            left, right = strain[:, rows], strain[:, columns]
            count, points = len(strain), strain.shape[-1]
            flat_right = right.reshape(count, -1, points).transpose(0, 2, 1)
            product = left.reshape(count, -1, points) @ flat_right
            return product.reshape(*left.shape[:3], *right.shape[1:3])

        a, b = self.constants[self.directed, 2:].T[:, :, None, None, None, None]
        along, through = self.strains
        return a * work(along) + b * work(through)


def _element_integrals(xy: Any, elasticity: Any, p: int, along: Any) -> _ElementIntegrals:
    """The integrals of gradients over elements; parameters as of `element_stiffness`."""
    slopes, constants = _weighted_gradients(xy, p), split_elasticity(elasticity)
    e, _, a, q = slopes.shape
    flat = slopes.reshape(e, 2 * a, q)
    products = (flat @ flat.transpose(0, 2, 1)).reshape(e, 2, a, 2, a)
    directed = np.flatnonzero(constants[:, 2:].any(axis=1))
    strains: tuple[Any, ...] = ()
    if len(directed):
        t = np.moveaxis(along[directed], 1, 0)  # (2, m, q)
        own = slopes[directed]
        strains = (
            _strains_in_direction(own, t),
            _strains_in_direction(own, directions_through_layers(t)),
        )
    return _ElementIntegrals(products, constants, directed, strains)


def _strains_in_direction(slopes: Any, direction: Any) -> Any:
    """Strains (m, a, 2, q) in a direction (2, m, q) due to unit displacements.

    `slopes` (m, 2, a, q) are the gradients of the shape functions.
    """
    grown = direction[0][:, None] * slopes[:, 0] + direction[1][:, None] * slopes[:, 1]
    return np.stack([direction[0][:, None] * grown, direction[1][:, None] * grown], axis=2)


def _weighted_gradients(xy: Any, p: int) -> Any:
    """Gradients (e, 2, a, q) of the shape functions, times the root of the Gauss points' areas.

    `xy` (e, 2, a) are the nodes. The gradients of an element whose map is inverted have the other
    sign.
    """
    reference = reference_element(p, precise=xy.dtype == np.longdouble)
    e, _, a = xy.shape
    q = len(reference.weights)
    J = (xy.reshape(2 * e, a) @ reference.slopes).reshape(e, 2, 2, q)  # d x_c / d xi_d
    det = J[:, 0, 0] * J[:, 1, 1] - J[:, 0, 1] * J[:, 1, 0]
    J *= np.sqrt(reference.weights / np.abs(det))[:, None, None]
    first, second = reference.slopes[:, :q], reference.slopes[:, q:]
    # The gradient G is d psi / d x_c times the root of dA, but for the sign of det.
    G = np.empty((e, 2, a, q), dtype=xy.dtype)
    np.subtract(J[:, 1, 1][:, None] * first, J[:, 1, 0][:, None] * second, out=G[:, 0])
    np.subtract(J[:, 0, 0][:, None] * second, J[:, 0, 1][:, None] * first, out=G[:, 1])
    return G


def schur_complement(K: Floats, C: Floats, inner: Floats) -> Floats:
    """The Schur complement K - C^T inner^-1 C (k, k), which takes the place of K.

    C is (m, k) and `inner` (m, m), of the m unknowns that are eliminated. All three matrices are
    in rows without gaps and are overwritten, so that BLAS works on them in place. The Cholesky
    factors are backward stable; an inverse would lose digits in thin columns.

    Raises
    ------
    NoAnswer
        for an `inner` that is not positive definite
    """
    assert K.flags.c_contiguous and C.flags.c_contiguous and inner.flags.c_contiguous
    L, info = dpotrf(inner.T, lower=1, clean=0, overwrite_a=1)
    if info:
        raise NoAnswer(SINGULAR_ELEMENT)
    Y = dtrsm(1.0, L, C.T, side=1, lower=1, trans_a=1, overwrite_b=1)
    dgemm(-1.0, Y, Y, 1.0, K.T, trans_b=1, overwrite_c=1)
    return K


def schur_complements(K: Floats, C: Floats, inner: Floats) -> Floats:
    """The Schur complements of b matrices, which take the place of K (b, k, k).

    C is (b, m, k) and `inner` (b, m, m), as of `schur_complement`. The matrices go one by one,
    since numpy's batched functions would need more copies.
    """
    for own in zip(K, C, inner, strict=True):
        schur_complement(*own)
    return K


class _StiffnessBlocks(NamedTuple):
    """The stiffness of a batch of e elements, by blocks of boundary unknowns and inner unknowns.

    Attributes
    ----------
    part : slice of the batch among all elements
    outer : (e, k, k) block of the boundary unknowns
    coupling : (e, m, k) block of inner by boundary unknowns
    inner : (e, m, m) block of the inner unknowns
    """

    part: slice
    outer: Floats
    coupling: Floats
    inner: Floats


def _stiffness_blocks_in_batches(
    xy: Floats, elasticity: Floats, p: int, along: Floats | None
) -> Iterator[_StiffnessBlocks]:
    """The stiffness of elements, in batches that fit into the processor's cache.

    The parameters are those of `element_stiffness`.
    """
    reference = reference_element(p)
    on, inside = slice(reference.outer), slice(reference.outer, None)
    outer_count = 2 * reference.outer
    inner_count = 2 * len(reference.order) - outer_count
    step = max(1, SLOPES_PER_BATCH // reference.slopes.size)
    for k in range(0, len(xy), step):
        part = slice(k, k + step)
        directions = None if along is None else along[part]
        integrals = _element_integrals(xy[part], elasticity[part], p, directions)
        yield _StiffnessBlocks(
            part,
            integrals.stiffness(on, on).reshape(-1, outer_count, outer_count),
            integrals.stiffness(inside, on).reshape(-1, inner_count, outer_count),
            integrals.stiffness(inside, inside).reshape(-1, inner_count, inner_count),
        )


def condensed_element_stiffness(
    xy: Floats, elasticity: Floats, p: int, along: Floats | None = None
) -> Floats:
    """The condensed stiffness (l, c, 8 p, 8 p) of elements on their boundary nodes.

    x and y of a node stand together.

    Parameters
    ----------
    xy : (l, c, 2, a) nodes of c elements in each of l layers [m]
    elasticity : (l, 3, 3) elasticity matrix times the width of each layer [N/m]
    p : degree
    along : (l, c, 2, q) unit vectors along the layers at the `element_gauss_points`; None where all
        layers are isotropic
    """
    shape = xy.shape[:2]
    xy = xy.reshape(-1, *xy.shape[2:])
    elasticity = np.repeat(elasticity, shape[1], axis=0)
    along = None if along is None else along.reshape(len(xy), 2, -1)
    condensed = np.empty((len(xy), 8 * p, 8 * p))
    for part, outer, coupling, inner in _stiffness_blocks_in_batches(xy, elasticity, p, along):
        condensed[part] = schur_complements(outer, coupling, inner)
    return condensed.reshape(*shape, 8 * p, 8 * p)


class CondensedForces(NamedTuple):
    """The forces inside elements, condensed to their boundary nodes.

    `forces` (e, 8 p, k) are the forces on the boundary nodes, and `work` (k, k) is the work of the
    inner forces while the boundaries are held.
    """

    forces: Floats
    work: Floats


def condense_inner_forces(
    xy: Floats, elasticity: Floats, p: int, along: Floats | None, inner_forces: Floats
) -> CondensedForces:
    """The forces on the boundary nodes of elements that stand for forces on their inner nodes.

    Parameters
    ----------
    xy, elasticity, p, along : as of `element_stiffness`
    inner_forces : (e, 2 i, k) forces on the i nodes inside each element
    """
    count = inner_forces.shape[2]
    forces, work = np.empty((len(xy), 8 * p, count)), np.zeros((count, count))
    for part, _, coupling, inner in _stiffness_blocks_in_batches(xy, elasticity, p, along):
        own = inner_forces[part]
        displacements = np.linalg.solve(inner, own)
        forces[part] = -(coupling.transpose(0, 2, 1) @ displacements)
        work += (own.transpose(0, 2, 1) @ displacements).sum(axis=0)
    return CondensedForces(forces, work)


def stress_forces(xy: Floats, stresses: Floats, p: int) -> Floats:
    """Nodal forces (e, a, 2) [N] that are in equilibrium with stresses inside elements.

    They are the integrals of sigma_ij psi_a,j over each element.

    Parameters
    ----------
    xy : (e, 2, a) nodes of the elements [m]
    stresses : (e, 2, 2, q) stresses times the width [N/m] at the `element_gauss_points`
    p : degree
    """
    forces = np.empty((len(xy), xy.shape[2], 2))
    step = max(1, SLOPES_PER_BATCH // reference_element(p).slopes.size)
    for k in range(0, len(xy), step):
        part = slice(k, k + step)
        G, area = shape_function_gradients(xy[part], p)
        forces[part] = np.einsum("eijq,ejaq,eq->eai", stresses[part], G, area, optimize=True)
    return forces


def inner_node_displacements(
    xy: Floats,
    elasticity: Floats,
    p: int,
    along: Floats | None,
    u: Floats,
    inner_forces: Floats | None = None,
) -> Floats:
    """Displacements (e, 2 i, m) of the i nodes inside elements.

    Parameters
    ----------
    xy, elasticity, p, along : as of `element_stiffness`
    u : (e, 8 p, m) displacements of the boundary nodes
    inner_forces : (e, 2 i, m) forces on the inner nodes; None where no force acts on them
    """
    inner_count = 2 * xy.shape[2] - 8 * p
    found = np.empty((len(xy), inner_count, u.shape[2]))
    for part, _, coupling, inner in _stiffness_blocks_in_batches(xy, elasticity, p, along):
        right = coupling @ u[part]
        if inner_forces is not None:
            right -= inner_forces[part]
        found[part] = -np.linalg.solve(inner, right)
    return found


def shape_function_gradients(xy: Floats, p: int) -> tuple[Floats, Floats]:
    """Gradients (e, 2, a, q) of the shape functions [1/m], and areas (e, q) of Gauss points [m^2].

    `xy` (e, 2, a) are the nodes of the elements.
    """
    reference = reference_element(p)
    q = len(reference.weights)
    J = (xy @ reference.slopes).reshape(*xy.shape[:2], 2, q)  # d x_c / d xi_d
    det = J[:, 0, 0] * J[:, 1, 1] - J[:, 0, 1] * J[:, 1, 0]
    # The inverse has the derivatives d xi_d / d x_c, (d, c, e, q).
    inverse = np.array([[J[:, 1, 1], -J[:, 0, 1]], [-J[:, 1, 0], J[:, 0, 0]]]) / det
    slopes = reference.slopes.reshape(len(reference.order), 2, q)
    return np.einsum("adq,dceq->ecaq", slopes, inverse), np.abs(det) * reference.weights
