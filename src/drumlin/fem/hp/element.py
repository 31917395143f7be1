"""The isoparametric quadrilateral of degree p: its shape functions, its stiffness, elimination of what is inside it.

Nodes lie at Gauss-Lobatto points in both directions. skfem's ElementQuadP spans the same polynomials; its values at the
nodes turn its hierarchical functions into these nodal ones, once a degree. Displacements use the functions that map the
element, so rigid motions are exact (Zienkiewicz & Taylor, The Finite Element Method, section 8).
"""

from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial.legendre import leggauss

from drumlin.arrays import Floats, Ints
from drumlin.errors import NoAnswer
from drumlin.lapack import dgemm, dpotrf, dtrsm
from drumlin.response.resultants import lobatto

CHUNK = 32_000  # slopes that are worked on at once: they stay in the processor's cache
SINGULAR = "singular stiffness: a part hangs on nothing, or moduli or sizes are too far apart"


class Element(NamedTuple):
    """The element of degree p: `slopes` (a, 2 q) of its shape functions by both coordinates at q Gauss points,
    `weights` (q,) of these. Its a nodes are those of the grid (p + 1)^2 in the order `order` (a,), where i p + i + j
    stands for the i-th place across the layers and the j-th along them: first the `outer` on its boundary, those on
    its left and its right side, on what is left of its first and of its last edge."""

    slopes: Any
    weights: Any
    order: Ints
    outer: int


@cache
def element(p: int, *, precise: bool = False) -> Element:
    """The element of degree p >= 2; precise: in long double."""
    x, w = leggauss(p + 1)
    x, w = 0.5 * (x + 1), 0.5 * w
    number = np.arange((p + 1) ** 2).reshape(p + 1, p + 1)
    edges = number[:, 0], number[:, -1], number[0, 1:-1], number[-1, 1:-1]
    order = np.concatenate([*edges, number[1:-1, 1:-1].ravel()])
    slopes = _product_slopes(p, x) if precise else shape_functions(p, _grid(x))[1]
    return Element(np.ascontiguousarray(slopes[order].reshape(len(order), -1)), np.outer(w, w).ravel(), order, 4 * p)


def shape_functions(p: int, x: Floats) -> tuple[Floats, Floats]:
    """Values (a, q) and slopes (a, 2, q) of the nodal functions, nodes by rows, at points x (2, q) of [0, 1]^2."""
    import skfem  # noqa: PLC0415  (laws need none of it)

    hierarchical = skfem.ElementQuadP(p) if p > 2 else skfem.ElementQuad2()
    count = (p + 1) ** 2

    def of(points: Floats) -> tuple[Floats, Floats]:
        both = [hierarchical.lbasis(points, i) for i in range(count)]
        return np.array([value for value, _ in both]), np.array([slope for _, slope in both])

    at_nodes, _ = of(_grid(0.5 * (lobatto(p) + 1)))
    values, slopes = of(x)
    nodal: Floats = np.asarray(np.linalg.inv(at_nodes), dtype=float)
    return nodal @ values, (nodal @ slopes.reshape(count, -1)).reshape(slopes.shape)


def _grid(x: Floats) -> Floats:
    """The points (2, n n) of the grid of x (n,), the first coordinate growing by rows."""
    return np.array([np.repeat(x, len(x)), np.tile(x, len(x))])


def _product_slopes(p: int, x: Floats) -> Any:
    """Slopes (a, 2, q) at the grid of x, as products of Lagrange's polynomials, in long double."""
    nodes, x = (0.5 * (lobatto(p) + 1)).astype(np.longdouble), x.astype(np.longdouble)
    apart = nodes[:, None] - nodes + np.eye(p + 1)
    value = np.array(
        [np.prod([(x - nodes[j]) / apart[i, j] for j in range(p + 1) if j != i], axis=0) for i in range(p + 1)]
    )
    slope = np.array(
        [
            sum(
                np.prod([(x - nodes[j]) / apart[i, j] for j in range(p + 1) if j not in (i, k)], axis=0) / apart[i, k]
                for k in range(p + 1)
                if k != i
            )
            for i in range(p + 1)
        ]
    )
    both = [np.einsum("ik,jl->ijkl", slope, value), np.einsum("ik,jl->ijkl", value, slope)]
    return np.stack([each.reshape((p + 1) ** 2, -1) for each in both], axis=1)


def stiffness(xy: Any, lame: Any, p: int) -> Any:
    """Plane-stress stiffness (e, a, 2, a, 2) of elements with nodes xy (e, 2, a) [m], in the element's order.

    lame (e, 2): lambda and mu of plane stress times the width [N/m]. In the precision of xy.

        K_ai,bj = Int lambda psi_a,i psi_b,j + mu psi_a,j psi_b,i + mu delta_ij psi_a,k psi_b,k dA
    """
    return _stiffness(_products(xy, p), lame, slice(None), slice(None))


def _products(xy: Any, p: int) -> Any:
    """Int psi_a,i psi_b,j dA (e, 2, a, 2, a) for i, a, j, b of elements with nodes xy (e, 2, a)."""
    ref = element(p, precise=xy.dtype == np.longdouble)
    e, _, a = xy.shape
    q = len(ref.weights)
    J = (xy.reshape(2 * e, a) @ ref.slopes).reshape(e, 2, 2, q)  # d x_c / d xi_d
    det = J[:, 0, 0] * J[:, 1, 1] - J[:, 0, 1] * J[:, 1, 0]
    J *= np.sqrt(ref.weights / np.abs(det))[:, None, None]
    first, second = ref.slopes[:, :q], ref.slopes[:, q:]
    G = np.empty((e, 2, a, q), dtype=xy.dtype)  # d psi / d x_c times the root of dA, up to the sign of det
    np.subtract(J[:, 1, 1][:, None] * first, J[:, 1, 0][:, None] * second, out=G[:, 0])
    np.subtract(J[:, 0, 0][:, None] * second, J[:, 0, 1][:, None] * first, out=G[:, 1])
    G = G.reshape(e, 2 * a, q)
    return (G @ G.transpose(0, 2, 1)).reshape(e, 2, a, 2, a)


def _stiffness(products: Any, lame: Any, rows: slice, columns: slice) -> Any:
    """The part (e, rows, 2, columns, 2) of the stiffness of elements; see `stiffness` and `_products`."""
    lam, mu = lame[:, :1, None], lame[:, 1:, None]
    xx, xy = products[:, 0, rows, 0, columns], products[:, 0, rows, 1, columns]
    yx, yy = products[:, 1, rows, 0, columns], products[:, 1, rows, 1, columns]
    K = np.empty((len(xx), xx.shape[1], 2, xx.shape[2], 2), dtype=products.dtype)
    np.add((lam + 2 * mu) * xx, mu * yy, out=K[:, :, 0, :, 0])
    np.add((lam + 2 * mu) * yy, mu * xx, out=K[:, :, 1, :, 1])
    np.add(lam * xy, mu * yx, out=K[:, :, 0, :, 1])
    np.add(lam * yx, mu * xy, out=K[:, :, 1, :, 0])
    return K


def without(K: Floats, C: Floats, inner: Floats) -> Floats:
    """K - C^T inner^-1 C: (k, k), (m, k), (m, m), each in rows without gaps, all overwritten.

    Raises NoAnswer for an `inner` that is not positive definite. Backward stable, by Cholesky's factors: an inverse
    loses digits in thin columns. What BLAS is given in rows without gaps it works on where it lies.
    """
    assert K.flags.c_contiguous and C.flags.c_contiguous and inner.flags.c_contiguous
    L, info = dpotrf(inner.T, lower=1, clean=0, overwrite_a=1)
    if info:
        raise NoAnswer(SINGULAR)
    Y = dtrsm(1.0, L, C.T, side=1, lower=1, trans_a=1, overwrite_b=1)
    dgemm(-1.0, Y, Y, 1.0, K.T, trans_b=1, overwrite_c=1)
    return K


def without_each(K: Floats, C: Floats, inner: Floats) -> Floats:
    """`without` for batches (b, k, k), (b, m, k), (b, m, m), one after the other: numpy's own need more copies."""
    for own in zip(K, C, inner, strict=True):
        without(*own)
    return K


def condensed_elements(xy: Floats, lame: Floats, p: int) -> Floats:
    """Stiffness (l, c, 8 p, 8 p) of elements with nodes xy (l, c, 2, a) on their boundary nodes, x and y of a node
    together; lame (l, 2): of each layer, see `stiffness`."""
    ref, shape = element(p), xy.shape[:2]
    outer, inside = slice(ref.outer), slice(ref.outer, None)
    xy, lame = xy.reshape(-1, *xy.shape[2:]), np.repeat(lame, shape[1], axis=0)
    out = np.empty((len(xy), 2 * ref.outer, 2 * ref.outer))
    step = max(1, CHUNK // ref.slopes.size)
    for k in range(0, len(xy), step):
        part = slice(k, k + step)
        found = _products(xy[part], p)
        e, sizes = len(found), (2 * ref.outer, 2 * (len(ref.order) - ref.outer))
        out[part] = without_each(
            *(
                _stiffness(found, lame[part], rows, columns).reshape(e, n, m)
                for rows, columns, n, m in (
                    (outer, outer, sizes[0], sizes[0]),
                    (inside, outer, sizes[1], sizes[0]),
                    (inside, inside, sizes[1], sizes[1]),
                )
            )
        )
    return out.reshape(*shape, *out.shape[1:])


def inner_displacements(xy: Floats, lame: Floats, p: int, u: Floats) -> Floats:
    """Displacements (e, 2 i, m) of the i nodes inside elements, which no force acts on.

    xy (e, 2, a) and lame (e, 2) are as of `stiffness`; u (e, 8 p, m) are the displacements of the
    boundary nodes.
    """
    ref = element(p)
    outer, inside = slice(ref.outer), slice(ref.outer, None)
    found = np.empty((len(xy), 2 * (len(ref.order) - ref.outer), u.shape[2]))
    step = max(1, CHUNK // ref.slopes.size)
    for k in range(0, len(xy), step):
        part = slice(k, k + step)
        products = _products(xy[part], p)
        coupling, inner = (
            _stiffness(products, lame[part], inside, columns).reshape(len(products), found.shape[1], -1)
            for columns in (outer, inside)
        )
        found[part] = -np.linalg.solve(inner, coupling @ u[part])
    return found


def gradients(xy: Floats, p: int) -> tuple[Floats, Floats]:
    """Gradients (e, 2, a, q) [1/m] of the shape functions of elements with nodes xy (e, 2, a) at
    the Gauss points, and the areas (e, q) [m^2] that these stand for."""
    ref = element(p)
    q = len(ref.weights)
    J = (xy @ ref.slopes).reshape(*xy.shape[:2], 2, q)  # d x_c / d xi_d
    det = J[:, 0, 0] * J[:, 1, 1] - J[:, 0, 1] * J[:, 1, 0]
    inverse = np.array([[J[:, 1, 1], -J[:, 0, 1]], [-J[:, 1, 0], J[:, 0, 0]]]) / det  # d xi_d / d x_c, (d, c, e, q)
    slopes = ref.slopes.reshape(len(ref.order), 2, q)
    return np.einsum("adq,dceq->ecaq", slopes, inverse), np.abs(det) * ref.weights
