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
from drumlin.fem.shapes import elements
from drumlin.lapack import dpotrf, dtrsm
from drumlin.response.resultants import lobatto

CHUNK = 16_000  # slopes that are worked on at once: they stay in the processor's cache
SMALL = 24  # unknowns up to which a batch is eliminated at once, rather than one after the other by faster routines
SINGULAR = "singular stiffness: a part hangs on nothing, or moduli or sizes are too far apart"


class Element(NamedTuple):
    """The element of degree p: `slopes` (a, 2 q) of its shape functions by both coordinates at q Gauss points,
    `weights` (q,) of these. Its a nodes are those of the grid (p + 1)^2 in the order `order` (a,), where i p + i + j
    stands for the i-th place across the layers and the j-th along them: first the `outer` on its boundary."""

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
    inside = np.pad(np.ones((p - 1, p - 1), dtype=bool), 1)
    order = np.concatenate([number[~inside], number[inside]])
    slopes = _product_slopes(p, x) if precise else shape_functions(p, _grid(x))[1]
    return Element(np.ascontiguousarray(slopes[order].reshape(len(order), -1)), np.outer(w, w).ravel(), order, 4 * p)


def shape_functions(p: int, x: Floats) -> tuple[Floats, Floats]:
    """Values (a, q) and slopes (a, 2, q) of the nodal functions, nodes by rows, at points x (2, q) of [0, 1]^2."""
    hierarchical = elements().ElementQuadP(p) if p > 2 else elements().ElementQuad2()
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
    ref = element(p, precise=xy.dtype == np.longdouble)
    e, _, a = xy.shape
    q = len(ref.weights)
    J = (xy.reshape(2 * e, a) @ ref.slopes).reshape(e, 2, 2, q)  # d x_c / d xi_d
    det = J[:, 0, 0] * J[:, 1, 1] - J[:, 0, 1] * J[:, 1, 0]
    J = J / det[:, None, None]
    first, second = ref.slopes[:, :q], ref.slopes[:, q:]
    G = np.empty((e, a, 2, q), dtype=xy.dtype)  # d psi / d x_c
    G[:, :, 0] = J[:, 1, 1][:, None] * first - J[:, 1, 0][:, None] * second
    G[:, :, 1] = J[:, 0, 0][:, None] * second - J[:, 0, 1][:, None] * first
    dA = np.abs(det) * ref.weights
    lam, mu = lame[:, :1] * dA, lame[:, 1:] * dA
    right = G.reshape(e, a, 2 * q).transpose(0, 2, 1)
    swapped = G[:, :, ::-1].reshape(e, a, 2 * q).transpose(0, 2, 1)
    K = np.empty((e, a, 2, a, 2), dtype=xy.dtype)
    for i, j, factors in ((0, 0, (lam + 2 * mu, mu)), (1, 1, (mu, lam + 2 * mu)), (0, 1, (lam, mu))):
        left = (G * np.stack(factors, axis=1)[:, None]).reshape(e, a, 2 * q)
        K[:, :, i, :, j] = left @ (right if i == j else swapped)
    K[:, :, 1, :, 0] = K[:, :, 0, :, 1].transpose(0, 2, 1)
    return K


def eliminate(K: Floats, kept: int) -> Floats:
    """Batched symmetric K (b, n, n), positive definite on what goes, without all but its first `kept` unknowns."""
    if K.shape[-1] == kept:
        return K
    return without(K[:, :kept, :kept], K[:, kept:, :kept], K[:, kept:, kept:])


def without(K: Floats, C: Floats, inner: Floats) -> Floats:
    """K - C^T inner^-1 C, batched: (b, k, k), (b, m, k), (b, m, m). Raises NoAnswer for a singular `inner`.

    Backward stable, by Cholesky's or Gauss's factors: an inverse loses digits in thin columns.
    """
    try:
        if C.shape[1] <= SMALL:
            return K - C.transpose(0, 2, 1) @ np.linalg.solve(inner, C)
        out = np.empty(K.shape)
        for k in range(len(K)):
            L, info = dpotrf(inner[k].T, lower=1)
            if info:
                raise NoAnswer(SINGULAR)
            Y = dtrsm(1.0, L, C[k].T, side=1, lower=1, trans_a=1)
            np.subtract(K[k], Y @ Y.T, out=out[k])
    except np.linalg.LinAlgError as error:
        raise NoAnswer(SINGULAR) from error
    return out


def condensed_elements(xy: Floats, lame: Floats, p: int) -> Floats:
    """Stiffness (e, n, n) of elements on their boundary nodes, x and y of a node together; arguments of `stiffness`."""
    ref = element(p)
    kept = 2 * ref.outer
    out = np.empty((len(xy), kept, kept))
    step = max(1, CHUNK // ref.slopes.size)
    for k in range(0, len(xy), step):
        part = slice(k, k + step)
        K = stiffness(xy[part], lame[part], p)
        size = 2 * len(ref.order)
        out[part] = eliminate(K.reshape(len(K), size, size), kept)
    return out
