"""The isoparametric quadrilateral of degree p: shape functions, stiffness, static condensation.

The nodes of the element lie at Gauss-Lobatto points in both directions. The shape functions come
from the class ElementQuadP of scikit-fem, whose hierarchical functions span the same polynomials.
They are transformed to nodal functions once for each degree. The same functions describe the
displacements and the shape of the element, so that rigid-body motions are represented exactly
(Zienkiewicz & Taylor, The Finite Element Method, section 8).
"""

from collections.abc import Iterator
from functools import cache
from itertools import product
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial.legendre import Legendre, leggauss

from drumlin.base.arrays import Floats, Ints
from drumlin.base.errors import NoAnswer
from drumlin.base.lapack import dgemm, dpotrf, dsyrk, dtrsm
from drumlin.fem.substructure.elasticity import (
    isotropic_and_orthotropic_elastic_constants,
    unit_vectors_through_thickness_of_layers,
)
from drumlin.response.resultants import gauss_lobatto_points

SHAPE_FUNCTION_SLOPES_PER_BATCH = 32_000
"""Number of derivatives of shape functions in a batch of elements computed together.

An element has (p + 1)^2 functions with two derivatives at each of its (p + 1)^2 Gauss points. The
data of a batch of this size stay in the processor's cache. Larger and smaller batches give the
same stiffness, but take more time.
"""
SMALLEST_SIZE_COMPUTED_BY_TRIANGLE = 1000
"""Number of kept unknowns from which only one triangle of a Schur complement is computed.

The other triangle is a copy. This halves the multiplications, but the copy takes longer than they
do if there are few unknowns. Measured with 400 to 1000 eliminated unknowns, one thread: with 1000
kept unknowns both ways take the same time, with 1200 and 2500 one triangle takes 0.6 of it.
"""
ROWS_OF_TRANSPOSED_BLOCK = 64
"""Number of rows that are copied together when a triangle of a matrix is copied to the other."""
SINGULAR_ELEMENT_MESSAGE = (
    "singular stiffness: a part hangs on nothing, or moduli or sizes are too far apart"
)
"""Message of the error raised if the stiffness of eliminated unknowns is not positive definite."""


class ReferenceElement(NamedTuple):
    """The element of degree p on the unit square, with a = (p + 1)^2 nodes, at q Gauss points.

    Attributes
    ----------
    slopes : (a, 2 q) derivatives of the shape functions by both coordinates at the Gauss points
    weights : (q,) weights of the Gauss points
    order : (a,) numbers of the element's nodes, those on the boundary first, then those inside. The
        nodes form a grid of p + 1 rows, and are numbered row by row along the layers.
    outer : number of nodes on the boundary. They are ordered: left side, right side, inner nodes of
        the first edge (nearest to the contact), inner nodes of the last edge.
    values : (a, q) shape functions at the Gauss points
    """

    slopes: Any
    weights: Any
    order: Ints
    outer: int
    values: Any


@cache
def reference_element_of_degree(p: int, *, precise: bool = False) -> ReferenceElement:
    """The reference element of degree p >= 2; with `precise` its slopes are in long double."""
    # The nodes on the left and the right side come first, then the other nodes of the first and
    # last edge, then those inside the element.
    x, w = gauss_points_and_weights_on_0_to_1(p)
    number = np.arange((p + 1) ** 2).reshape(p + 1, p + 1)
    edges = number[:, 0], number[:, -1], number[0, 1:-1], number[-1, 1:-1]
    order = np.concatenate([*edges, number[1:-1, 1:-1].ravel()])
    functions = (
        _shape_function_values_and_slopes_in_long_double(p, x)
        if precise
        else shape_function_values_and_slopes(p, points_of_square_tensor_grid(x))
    )
    values, slopes = functions
    return ReferenceElement(
        slopes=np.ascontiguousarray(slopes[order].reshape(len(order), -1)),
        weights=np.outer(w, w).ravel(),
        order=order,
        outer=4 * p,
        values=values[order],
    )


def gauss_points_and_weights_on_0_to_1(p: int) -> tuple[Floats, Floats]:
    """The p + 1 Gauss points (p + 1,) of the interval [0, 1], and their weights (p + 1,)."""
    x, w = leggauss(p + 1)
    return 0.5 * (x + 1), 0.5 * w


def node_positions_on_edge_from_0_to_1(p: int) -> Floats:
    """The positions (p + 1,) in [0, 1] of the nodes on an element's edge: Gauss-Lobatto points."""
    return 0.5 * (gauss_lobatto_points(p) + 1)


def points_of_square_tensor_grid(x: Floats) -> Floats:
    """The points (2, n n) of the square grid with the coordinates x (n,) in both directions.

    The second coordinate changes from each point to the next, and the first coordinate only after n
    points.
    """
    return np.array([np.repeat(x, len(x)), np.tile(x, len(x))])


def shape_function_values_and_slopes(p: int, x: Floats) -> tuple[Floats, Floats]:
    """The values (a, q) and slopes (a, 2, q) of an element's shape functions at points x (2, q).

    The element of degree p is the unit square [0, 1]^2 and has a = (p + 1)^2 nodes. Each function
    is 1 at its node and 0 at the others. The nodes form a grid and are numbered row by row.
    """
    grid = points_of_square_tensor_grid(node_positions_on_edge_from_0_to_1(p))
    at_nodes, _ = _hierarchical_function_values_and_slopes(p, grid)
    values, slopes = _hierarchical_function_values_and_slopes(p, x)
    # A nodal function is 1 at its own node and 0 at the others. The inverse of the matrix of values
    # at the nodes therefore has the coefficients of the nodal functions.
    nodal: Floats = np.asarray(np.linalg.inv(at_nodes), dtype=float)
    return nodal @ values, (nodal @ slopes.reshape(len(slopes), -1)).reshape(slopes.shape)


def _hierarchical_function_values_and_slopes(p: int, x: Floats) -> tuple[Floats, Floats]:
    """Values (a, q) and slopes (a, 2, q) of hierarchical functions of degree p at points x (2, q).

    The functions span the polynomials of degree p on the unit square. They are those of
    scikit-fem's class ElementQuadP, to the last bit. They stand here because scikit-fem takes as
    long to load as a solve takes.
    """
    # A function is the product of two functions of one coordinate, whose numbers are given here:
    # first at the corners, then on each of the four edges, and last inside the square.
    inner = range(2, p + 1)
    numbers = [(0, 0), (1, 0), (1, 1), (0, 1)]
    numbers += [(k, 0) for k in inner] + [(1, k) for k in inner]
    numbers += [(k, 1) for k in inner] + [(0, k) for k in inner]
    numbers += list(product(inner, inner))
    first, second = np.array(numbers).T
    values_x, slopes_x = _integrated_legendre_values_and_slopes(p, x[0])
    values_y, slopes_y = _integrated_legendre_values_and_slopes(p, x[1])
    slopes = slopes_x[first] * values_y[second], slopes_y[second] * values_x[first]
    return values_x[first] * values_y[second], np.stack(slopes, axis=1)


def _integrated_legendre_values_and_slopes(p: int, x: Floats) -> tuple[Floats, Floats]:
    """Values and slopes (p + 1, q) of 1 - x, x, and p - 1 integrals of Legendre polynomials.

    The integrals vanish at both ends of the interval [0, 1]. Their scale is that of Szabo and
    Babuska, Finite Element Analysis, section 6.1. `x` (q,) are the points.
    """
    values, slopes = [1.0 - x, x], [-1.0 + 0.0 * x, 1.0 + 0.0 * x]
    for n in range(2, p + 1):
        integral = Legendre.basis(n - 1).integ(lbnd=-1)
        scale = np.sqrt((2.0 * n - 1.0) / 2.0)
        values.append(integral(2.0 * x - 1.0) * scale)
        slopes.append(2 * integral.deriv()(2.0 * x - 1.0) * scale)
    return np.array(values), np.array(slopes)


def _shape_function_values_and_slopes_in_long_double(p: int, x: Floats) -> tuple[Any, Any]:
    """The values (a, q) and slopes (a, 2, q) of an element's shape functions, in long double.

    They are products of Lagrange's polynomials, at the points of the square grid with the
    coordinates x in both directions. Element and order are as in
    `shape_function_values_and_slopes`.
    """
    # A node's distance from itself is never used. It is set to 1, to avoid a division by 0.
    nodes = node_positions_on_edge_from_0_to_1(p).astype(np.longdouble)
    x = x.astype(np.longdouble)
    apart = nodes[:, None] - nodes + np.eye(p + 1)

    def lagrange_polynomial_without_given_factors(i: int, *others: int) -> Any:
        """Lagrange's polynomial of node i at all x, without the factors of the nodes `others`."""
        kept = [j for j in range(p + 1) if j != i and j not in others]
        return np.prod([(x - nodes[j]) / apart[i, j] for j in kept], axis=0)

    def derivative_of_lagrange_polynomial(i: int) -> Any:
        """The derivative of Lagrange's polynomial of node i at all x, by the product rule."""
        return sum(
            lagrange_polynomial_without_given_factors(i, k) / apart[i, k]
            for k in range(p + 1)
            if k != i
        )

    value = np.array([lagrange_polynomial_without_given_factors(i) for i in range(p + 1)])
    slope = np.array([derivative_of_lagrange_polynomial(i) for i in range(p + 1)])
    both = [np.einsum("ik,jl->ijkl", slope, value), np.einsum("ik,jl->ijkl", value, slope)]
    slopes = np.stack([each.reshape((p + 1) ** 2, -1) for each in both], axis=1)
    return np.einsum("ik,jl->ijkl", value, value).reshape((p + 1) ** 2, -1), slopes


def gauss_points_of_elements(xy: Any, p: int) -> Any:
    """The Gauss points (e, 2, q) [m] of e elements with the nodes xy (e, 2, a) [m].

    They are in long double if `xy` is.
    """
    return xy @ reference_element_of_degree(p, precise=xy.dtype == np.longdouble).values


def plane_stress_stiffness_of_elements(xy: Any, elasticity: Any, p: int, along: Any = None) -> Any:
    """The plane-stress stiffness (e, a, 2, a, 2) [N/m] of e elements, in the precision of xy.

    The nodes are in the order of `ReferenceElement`. The elastic constants lambda, mu, a and b are
    defined in `elasticity.isotropic_and_orthotropic_elastic_constants`. The unit vectors d are t
    along the layers and n through the layers. The stiffness is

        K_ai,bj = Int lambda psi_a,i psi_b,j + mu psi_a,j psi_b,i + mu delta_ij psi_a,k psi_b,k
                      + sum_d s_d d_i (d . grad psi_a) d_j (d . grad psi_b) dA,   s_t = a,  s_n = b.

    As indices of K and psi, a and b count nodes; s_t and s_n are the elastic constants a and b.

    Parameters
    ----------
    xy : (e, 2, a) nodes [m]
    elasticity : (e, 3, 3) elasticity matrices times the width [N/m]
    p : degree
    along : (e, 2, q) unit vectors along the layers at the `gauss_points_of_elements`; None where
        all layers are isotropic
    """
    return _integrals_for_element_stiffness(xy, elasticity, p, along).stiffness(
        slice(None), slice(None)
    )


class _IntegralsForElementStiffness(NamedTuple):
    """The integrals and constants from which the stiffness of elements is computed.

    There are e elements. The number of nodes of an element is called a, as in the shapes below.

    Attributes
    ----------
    products : (e, 2, a, 2, a) integrals Int psi_a,i psi_b,j dA of products of the gradients of two
        shape functions; the axes after the first are i, a, j, b
    constants : (e, 4) lambda, mu, a, b of `elasticity.isotropic_and_orthotropic_elastic_constants`
    orthotropic_elements : (m,) numbers of the elements whose material is orthotropic
    strains : (2, m, a, 2, q) strains along the layers, and strains through them, of the orthotropic
        elements at their Gauss points due to unit displacements of their nodes, times the root of
        dA; empty if m is 0
    """

    products: Any
    constants: Any
    orthotropic_elements: Ints
    strains: tuple[Any, ...]

    def stiffness(self, rows: slice, columns: slice) -> Any:
        """The forces on the nodes `rows` due to unit displacements of the nodes `columns`.

        This block of the stiffness is (e, rows, 2, columns, 2) for e elements.
        """
        # The isotropic part of the stiffness has four blocks: forces along x and y due to
        # displacements along x and y.
        lam, mu = self.constants[:, :1, None], self.constants[:, 1:2, None]
        xx, xy = self.products[:, 0, rows, 0, columns], self.products[:, 0, rows, 1, columns]
        yx, yy = self.products[:, 1, rows, 0, columns], self.products[:, 1, rows, 1, columns]
        K = np.empty((len(xx), xx.shape[1], 2, xx.shape[2], 2), dtype=self.products.dtype)
        np.add((lam + 2 * mu) * xx, mu * yy, out=K[:, :, 0, :, 0])
        np.add((lam + 2 * mu) * yy, mu * xx, out=K[:, :, 1, :, 1])
        np.add(lam * xy, mu * yx, out=K[:, :, 0, :, 1])
        np.add(lam * yx, mu * xy, out=K[:, :, 1, :, 0])
        if len(self.orthotropic_elements):
            K[self.orthotropic_elements] += self._element_stiffness_added_by_orthotropy(
                rows, columns
            )
        return K

    def _element_stiffness_added_by_orthotropy(self, rows: slice, columns: slice) -> Any:
        """The part of the stiffness (m, rows, 2, columns, 2) that orthotropy adds.

        `rows` and `columns` select nodes of the m orthotropic elements.
        """

        def integrals_of_products_of_two_strains(strain: Any) -> Any:
            """The integrals of strains due to nodes `rows` times strains due to nodes `columns`."""
            left, right = strain[:, rows], strain[:, columns]
            count, points = len(strain), strain.shape[-1]
            flat_right = right.reshape(count, -1, points).transpose(0, 2, 1)
            product = left.reshape(count, -1, points) @ flat_right
            return product.reshape(*left.shape[:3], *right.shape[1:3])

        a, b = self.constants[self.orthotropic_elements, 2:].T[:, :, None, None, None, None]
        along, through = self.strains
        return a * integrals_of_products_of_two_strains(
            along
        ) + b * integrals_of_products_of_two_strains(through)


def _integrals_for_element_stiffness(
    xy: Any, elasticity: Any, p: int, along: Any
) -> _IntegralsForElementStiffness:
    """The integrals from which the stiffness of elements is computed.

    The elements have the nodes `xy` [m] and the degree p. `elasticity` holds elasticity matrices
    times the width [N/m], and `along` unit vectors along the layers at the Gauss points.
    """
    slopes, constants = (
        _gradients_times_root_of_gauss_areas(xy, p),
        isotropic_and_orthotropic_elastic_constants(elasticity),
    )
    e, _, a, q = slopes.shape
    flat = slopes.reshape(e, 2 * a, q)
    products = (flat @ flat.transpose(0, 2, 1)).reshape(e, 2, a, 2, a)
    # Only elements of orthotropic material need the strains along and through their layers.
    orthotropic_elements = np.flatnonzero(constants[:, 2:].any(axis=1))
    strains: tuple[Any, ...] = ()
    if len(orthotropic_elements):
        t = np.moveaxis(along[orthotropic_elements], 1, 0)  # (2, m, q)
        own = slopes[orthotropic_elements]
        strains = (
            _strains_along_direction_due_to_unit_displacements(own, t),
            _strains_along_direction_due_to_unit_displacements(
                own, unit_vectors_through_thickness_of_layers(t)
            ),
        )
    return _IntegralsForElementStiffness(products, constants, orthotropic_elements, strains)


def _strains_along_direction_due_to_unit_displacements(slopes: Any, direction: Any) -> Any:
    """The strains (m, a, 2, q) in a direction due to unit displacements of m elements.

    `slopes` (m, 2, a, q) are the gradients of the shape functions at the Gauss points, and
    `direction` (2, m, q) are unit vectors there.
    """
    grown = direction[0][:, None] * slopes[:, 0] + direction[1][:, None] * slopes[:, 1]
    return np.stack([direction[0][:, None] * grown, direction[1][:, None] * grown], axis=2)


def _gradients_times_root_of_gauss_areas(xy: Any, p: int) -> Any:
    """The gradients (e, 2, a, q) of shape functions, times the root of each Gauss point's area.

    The sum over the Gauss points of the product of two such gradients is an integral over the
    element. `xy` (e, 2, a) are the nodes of the elements. In an element with a negative Jacobian
    determinant all gradients have the opposite sign, which does not change the products.
    """
    reference = reference_element_of_degree(p, precise=xy.dtype == np.longdouble)
    e, _, a = xy.shape
    q = len(reference.weights)
    J = (xy.reshape(2 * e, a) @ reference.slopes).reshape(e, 2, 2, q)  # d x_c / d xi_d
    det = J[:, 0, 0] * J[:, 1, 1] - J[:, 0, 1] * J[:, 1, 0]
    J *= np.sqrt(reference.weights / np.abs(det))[:, None, None]
    first, second = reference.slopes[:, :q], reference.slopes[:, q:]
    # G is the gradient d psi / d x_c times the root of dA. If det is negative, G has the opposite
    # sign.
    G = np.empty((e, 2, a, q), dtype=xy.dtype)
    np.subtract(J[:, 1, 1][:, None] * first, J[:, 1, 0][:, None] * second, out=G[:, 0])
    np.subtract(J[:, 0, 0][:, None] * second, J[:, 0, 1][:, None] * first, out=G[:, 1])
    return G


def replace_matrix_by_schur_complement(K: Floats, C: Floats, inner: Floats) -> Floats:
    """The Schur complement K - C^T inner^-1 C (k, k) of a stiffness, written into K.

    It is the stiffness on the k kept unknowns after the elimination of m other unknowns. C (m, k)
    couples eliminated and kept unknowns, and `inner` (m, m) is the stiffness on the eliminated
    unknowns. All three matrices must be contiguous in rows, and are overwritten, so that BLAS works
    on them in place. `inner` is not inverted but factored (Cholesky), because this is backward
    stable: thin columns of elements would otherwise lose digits.

    Raises
    ------
    NoAnswer
        for an `inner` that is not positive definite
    """
    assert K.flags.c_contiguous and C.flags.c_contiguous and inner.flags.c_contiguous
    L, info = dpotrf(inner.T, lower=1, clean=0, overwrite_a=1)
    if info:
        raise NoAnswer(SINGULAR_ELEMENT_MESSAGE)
    Y = dtrsm(1.0, L, C.T, side=1, lower=1, trans_a=1, overwrite_b=1)
    if len(K) < SMALLEST_SIZE_COMPUTED_BY_TRIANGLE:
        dgemm(-1.0, Y, Y, 1.0, K.T, trans_b=1, overwrite_c=1)
    else:
        dsyrk(-1.0, Y, 1.0, K.T, lower=1, overwrite_c=1)
        _copy_upper_triangle_to_lower_triangle(K)
    return K


def _copy_upper_triangle_to_lower_triangle(K: Floats) -> None:
    """Make a matrix K (n, n) symmetric: write its upper triangle into its lower triangle."""
    for start in range(0, len(K), ROWS_OF_TRANSPOSED_BLOCK):
        end = min(start + ROWS_OF_TRANSPOSED_BLOCK, len(K))
        block = K[start:end, start:end]
        block[:] = np.triu(block) + np.triu(block, 1).T
        K[end:, start:end] = K[start:end, end:].T


def replace_matrices_by_schur_complements(K: Floats, C: Floats, inner: Floats) -> Floats:
    """The Schur complements K - C^T inner^-1 C of b matrices, written into K (b, k, k).

    `inner` (b, m, m) is the stiffness on the m unknowns that are eliminated, and C (b, m, k) their
    coupling with the k remaining unknowns. The matrices are treated one by one, because numpy's
    functions for many matrices would make more copies.
    """
    for own in zip(K, C, inner, strict=True):
        replace_matrix_by_schur_complement(*own)
    return K


class _BoundaryAndInnerStiffnessOfElements(NamedTuple):
    """The stiffness of a batch of e elements in three blocks.

    Each element has k unknowns on its boundary and m unknowns inside.

    Attributes
    ----------
    part : slice of the elements of the batch among all elements
    outer : (e, k, k) block of the boundary unknowns
    coupling : (e, m, k) block of inner unknowns by boundary unknowns
    inner : (e, m, m) block of the inner unknowns
    """

    part: slice
    outer: Floats
    coupling: Floats
    inner: Floats


def _stiffness_blocks_of_element_batches(
    xy: Floats, elasticity: Floats, p: int, along: Floats | None
) -> Iterator[_BoundaryAndInnerStiffnessOfElements]:
    """Yield the stiffness of elements in three blocks, one batch of elements after the other.

    A batch fits into the processor's cache. The elements have the nodes `xy` [m] and the degree p.
    `elasticity` holds elasticity matrices times the width [N/m], and `along` unit vectors along the
    layers at the Gauss points.
    """
    reference = reference_element_of_degree(p)
    on, inside = slice(reference.outer), slice(reference.outer, None)
    outer_count = 2 * reference.outer
    inner_count = 2 * len(reference.order) - outer_count
    step = max(1, SHAPE_FUNCTION_SLOPES_PER_BATCH // reference.slopes.size)
    for k in range(0, len(xy), step):
        part = slice(k, k + step)
        directions = None if along is None else along[part]
        integrals = _integrals_for_element_stiffness(xy[part], elasticity[part], p, directions)
        yield _BoundaryAndInnerStiffnessOfElements(
            part,
            integrals.stiffness(on, on).reshape(-1, outer_count, outer_count),
            integrals.stiffness(inside, on).reshape(-1, inner_count, outer_count),
            integrals.stiffness(inside, inside).reshape(-1, inner_count, inner_count),
        )


def condensed_element_stiffness(
    xy: Floats, elasticity: Floats, p: int, along: Floats | None = None
) -> Floats:
    """The stiffness (l, c, 8 p, 8 p) [N/m] of elements, condensed to their 4 p boundary nodes.

    The inner nodes of each element are eliminated. The unknowns x and y of a node are next to each
    other.

    Parameters
    ----------
    xy : (l, c, 2, a) nodes of c elements in each of l layers [m]
    elasticity : (l, 3, 3) elasticity matrix times the width of each layer [N/m]
    p : degree
    along : (l, c, 2, q) unit vectors along the layers at the `gauss_points_of_elements`; None where
        all layers are isotropic
    """
    # The elements of all layers are treated as one list, in batches.
    shape = xy.shape[:2]
    xy = xy.reshape(-1, *xy.shape[2:])
    elasticity = np.repeat(elasticity, shape[1], axis=0)
    along = None if along is None else along.reshape(len(xy), 2, -1)
    condensed = np.empty((len(xy), 8 * p, 8 * p))
    for part, outer, coupling, inner in _stiffness_blocks_of_element_batches(
        xy, elasticity, p, along
    ):
        condensed[part] = replace_matrices_by_schur_complements(outer, coupling, inner)
    return condensed.reshape(*shape, 8 * p, 8 * p)


class ForcesCondensedToElementBoundary(NamedTuple):
    """Forces on the inner nodes of e elements of degree p, condensed to their boundary nodes.

    `forces` (e, 8 p, k) are the equivalent forces on the boundary nodes for k load cases. `work`
    (k, k) is the work of the inner forces of each load case on the displacements that each load
    case causes while the boundary nodes are fixed, summed over all elements.
    """

    forces: Floats
    work: Floats


def condense_inner_forces_to_element_boundary(
    xy: Floats, elasticity: Floats, p: int, along: Floats | None, inner_forces: Floats
) -> ForcesCondensedToElementBoundary:
    """The forces on the boundary nodes of elements that are equivalent to forces on inner nodes.

    Parameters
    ----------
    xy : (e, 2, a) nodes of the elements [m]
    elasticity : (e, 3, 3) elasticity matrices times the width [N/m]
    p : degree of the elements
    along : (e, 2, q) unit vectors along the layers at the Gauss points; None where all layers are
        isotropic
    inner_forces : (e, 2 i, k) forces on the i inner nodes of each element, for k load cases
    """
    count = inner_forces.shape[2]
    forces, work = np.empty((len(xy), 8 * p, count)), np.zeros((count, count))
    for part, _, coupling, inner in _stiffness_blocks_of_element_batches(xy, elasticity, p, along):
        # With fixed boundary nodes the inner nodes move by `displacements`. The equivalent forces
        # are the opposite of the reactions of the boundary nodes.
        own = inner_forces[part]
        displacements = np.linalg.solve(inner, own)
        forces[part] = -(coupling.transpose(0, 2, 1) @ displacements)
        work += (own.transpose(0, 2, 1) @ displacements).sum(axis=0)
    return ForcesCondensedToElementBoundary(forces, work)


def nodal_forces_of_element_stresses(xy: Floats, stresses: Floats, p: int) -> Floats:
    """The nodal forces (e, a, 2) [N] in equilibrium with the stresses inside e elements.

    They are the integrals of sigma_ij psi_a,j over each element, with psi_a the shape functions.

    Parameters
    ----------
    xy : (e, 2, a) nodes of the elements [m]
    stresses : (e, 2, 2, q) stresses times the width [N/m] at the `gauss_points_of_elements`
    p : degree
    """
    forces = np.empty((len(xy), xy.shape[2], 2))
    step = max(1, SHAPE_FUNCTION_SLOPES_PER_BATCH // reference_element_of_degree(p).slopes.size)
    for k in range(0, len(xy), step):
        part = slice(k, k + step)
        G, area = shape_function_gradients_and_gauss_areas(xy[part], p)
        forces[part] = np.einsum("eijq,ejaq,eq->eai", stresses[part], G, area, optimize=True)
    return forces


def displacements_of_inner_element_nodes(
    xy: Floats,
    elasticity: Floats,
    p: int,
    along: Floats | None,
    u: Floats,
    inner_forces: Floats | None = None,
) -> Floats:
    """The displacements (e, 2 i, m) [m] of the i inner nodes of e elements, for m load cases.

    Parameters
    ----------
    xy : (e, 2, a) nodes of the elements [m]
    elasticity : (e, 3, 3) elasticity matrices times the width [N/m]
    p : degree of the elements
    along : (e, 2, q) unit vectors along the layers at the Gauss points; None where all layers are
        isotropic
    u : (e, 8 p, m) displacements of the boundary nodes [m]
    inner_forces : (e, 2 i, m) forces on the inner nodes [N]; None if no force acts on them
    """
    inner_count = 2 * xy.shape[2] - 8 * p
    found = np.empty((len(xy), inner_count, u.shape[2]))
    for part, _, coupling, inner in _stiffness_blocks_of_element_batches(xy, elasticity, p, along):
        # The inner nodes are in equilibrium if the inner stiffness times their displacements is
        # -`right`.
        right = coupling @ u[part]
        if inner_forces is not None:
            right -= inner_forces[part]
        found[part] = -np.linalg.solve(inner, right)
    return found


def shape_function_gradients_and_gauss_areas(xy: Floats, p: int) -> tuple[Floats, Floats]:
    """The gradients (e, 2, a, q) [1/m] of shape functions at the Gauss points of e elements.

    The areas (e, q) [m^2] that the Gauss points stand for are returned too. `xy` (e, 2, a) are the
    nodes of the elements [m], and p is their degree.
    """
    reference = reference_element_of_degree(p)
    q = len(reference.weights)
    J = (xy @ reference.slopes).reshape(*xy.shape[:2], 2, q)  # d x_c / d xi_d
    det = J[:, 0, 0] * J[:, 1, 1] - J[:, 0, 1] * J[:, 1, 0]
    # The inverse (d, c, e, q) of the Jacobian matrix J has the derivatives d xi_d / d x_c.
    inverse = np.array([[J[:, 1, 1], -J[:, 0, 1]], [-J[:, 1, 0], J[:, 0, 0]]]) / det
    slopes = reference.slopes.reshape(len(reference.order), 2, q)
    return np.einsum("adq,dceq->ecaq", slopes, inverse), np.abs(det) * reference.weights
