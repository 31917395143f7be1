"""The isoparametric quadrilateral of degree p: its shape functions, its stiffness, elimination of
what is inside it.

Nodes lie at Gauss-Lobatto points in both directions. skfem's ElementQuadP spans the same
polynomials; its values at the nodes turn its hierarchical functions into these nodal ones, once a
degree. Displacements use the functions that map the element, so rigid motions are exact
(Zienkiewicz & Taylor, The Finite Element Method, section 8).
"""

from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial.legendre import leggauss

from drumlin.base.arrays import Floats, Ints
from drumlin.base.errors import NoAnswer
from drumlin.base.lapack import dgemm, dpotrf, dtrsm
from drumlin.fem.substructure.elasticity import across, split
from drumlin.response.resultants import lobatto

SLOPES_AT_ONCE = 32_000  # slopes that are worked on at once: they stay in the processor's cache
SINGULAR_ELEMENT = (
    "singular stiffness: a part hangs on nothing, or moduli or sizes are too far apart"
)


class Element(NamedTuple):
    """The element of degree p: `slopes` (a, 2 q) of its shape functions by both coordinates at q
    Gauss points, `weights` (q,) of these, `values` (a, q) of the shape functions there. Its a nodes
    are those of the grid (p + 1)^2 in the order `order` (a,), where i p + i + j stands for the i-th
    place across the layers and the j-th along them: first the `outer` on its boundary, those on its
    left and its right side, on what is left of its first and of its last edge."""

    slopes: Any
    weights: Any
    order: Ints
    outer: int
    values: Any


@cache
def element(p: int, *, precise: bool = False) -> Element:
    """The element of degree p >= 2; precise: in long double."""
    x, w = leggauss(p + 1)
    x, w = 0.5 * (x + 1), 0.5 * w
    number = np.arange((p + 1) ** 2).reshape(p + 1, p + 1)
    edges = number[:, 0], number[:, -1], number[0, 1:-1], number[-1, 1:-1]
    order = np.concatenate([*edges, number[1:-1, 1:-1].ravel()])
    values, slopes = _product_functions(p, x) if precise else shape_functions(p, _grid(x))
    return Element(
        slopes=np.ascontiguousarray(slopes[order].reshape(len(order), -1)),
        weights=np.outer(w, w).ravel(),
        order=order,
        outer=4 * p,
        values=values[order],
    )


def shape_functions(p: int, x: Floats) -> tuple[Floats, Floats]:
    """Values (a, q) and slopes (a, 2, q) of the nodal functions, nodes by rows, at points x (2, q)
    of [0, 1]^2.
    """
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


def _product_functions(p: int, x: Floats) -> tuple[Any, Any]:
    """Values (a, q) and slopes (a, 2, q) at the grid of x, as products of Lagrange's polynomials,
    in long double."""
    nodes, x = (0.5 * (lobatto(p) + 1)).astype(np.longdouble), x.astype(np.longdouble)
    apart = nodes[:, None] - nodes + np.eye(p + 1)
    value = np.array(
        [
            np.prod([(x - nodes[j]) / apart[i, j] for j in range(p + 1) if j != i], axis=0)
            for i in range(p + 1)
        ]
    )
    slope = np.array(
        [
            sum(
                np.prod(
                    [(x - nodes[j]) / apart[i, j] for j in range(p + 1) if j not in (i, k)], axis=0
                )
                / apart[i, k]
                for k in range(p + 1)
                if k != i
            )
            for i in range(p + 1)
        ]
    )
    both = [np.einsum("ik,jl->ijkl", slope, value), np.einsum("ik,jl->ijkl", value, slope)]
    slopes = np.stack([each.reshape((p + 1) ** 2, -1) for each in both], axis=1)
    return np.einsum("ik,jl->ijkl", value, value).reshape((p + 1) ** 2, -1), slopes


def gauss_points(xy: Any, p: int) -> Any:
    """The Gauss points (e, 2, q) [m] of elements with nodes xy (e, 2, a) in the element's order, in
    their precision."""
    return xy @ element(p, precise=xy.dtype == np.longdouble).values


def stiffness(xy: Any, elasticity: Any, p: int, along: Any = None) -> Any:
    """Plane-stress stiffness (e, a, 2, a, 2) of elements, nodes in the element's order, in the
    precision of xy.

    With the constants of `elasticity.split` and the unit vectors d = t along and n through the
    layers

        K_ai,bj = Int lambda psi_a,i psi_b,j + mu psi_a,j psi_b,i + mu delta_ij psi_a,k psi_b,k
                      + sum_d s_d d_i (d . grad psi_a) d_j (d . grad psi_b) dA,   s_t = a,  s_n = b.

    Parameters
    ----------
    xy : (e, 2, a) nodes [m]
    elasticity : (e, 3, 3) elasticity matrices times the width [N/m]
    p : degree
    along : (e, 2, q) unit vectors along the layers at the `gauss_points`; not needed where all
        are isotropic
    """
    return _integrals(xy, elasticity, p, along).stiffness(slice(None), slice(None))


class _ElementIntegrals(NamedTuple):
    """What the stiffness of elements is made of.

    `products` Int psi_a,i psi_b,j dA (e, 2, a, 2, a) for i, a, j, b; `constants` (e, 4) of
    `elasticity.split`; of the `directed` (m,) elements, which are not isotropic, the strains along
    and through their layers that unit displacements make, times the root of dA, `strains` (2, m, a,
    2, q).
    """

    products: Any
    constants: Any
    directed: Ints
    strains: tuple[Any, ...]

    def stiffness(self, rows: slice, columns: slice) -> Any:
        """The part (e, rows, 2, columns, 2) of the stiffness."""
        lam, mu = self.constants[:, :1, None], self.constants[:, 1:2, None]
        xx, xy = self.products[:, 0, rows, 0, columns], self.products[:, 0, rows, 1, columns]
        yx, yy = self.products[:, 1, rows, 0, columns], self.products[:, 1, rows, 1, columns]
        K = np.empty((len(xx), xx.shape[1], 2, xx.shape[2], 2), dtype=self.products.dtype)
        np.add((lam + 2 * mu) * xx, mu * yy, out=K[:, :, 0, :, 0])
        np.add((lam + 2 * mu) * yy, mu * xx, out=K[:, :, 1, :, 1])
        np.add(lam * xy, mu * yx, out=K[:, :, 0, :, 1])
        np.add(lam * yx, mu * xy, out=K[:, :, 1, :, 0])
        if len(self.directed):
            K[self.directed] += self._directed(rows, columns)
        return K

    def _directed(self, rows: slice, columns: slice) -> Any:
        """What the directed elements are stiffer, (m, rows, 2, columns, 2)."""

        def work(strain: Any) -> Any:
            left, right = strain[:, rows], strain[:, columns]
            count, points = len(strain), strain.shape[-1]
            found = left.reshape(count, -1, points) @ right.reshape(count, -1, points).transpose(
                0, 2, 1
            )
            return found.reshape(*left.shape[:3], *right.shape[1:3])

        a, b = self.constants[self.directed, 2:].T[:, :, None, None, None, None]
        along, through = self.strains
        return a * work(along) + b * work(through)


def _integrals(xy: Any, elasticity: Any, p: int, along: Any) -> _ElementIntegrals:
    """The integrals over elements; parameters as of `stiffness`."""
    slopes, constants = _rooted_slopes(xy, p), split(elasticity)
    e, _, a, q = slopes.shape
    flat = slopes.reshape(e, 2 * a, q)
    products = (flat @ flat.transpose(0, 2, 1)).reshape(e, 2, a, 2, a)
    directed = np.flatnonzero(constants[:, 2:].any(axis=1))
    strains: tuple[Any, ...] = ()
    if len(directed):
        t = np.moveaxis(along[directed], 1, 0)  # (2, m, q)
        strains = tuple(_stretches(slopes[directed], d) for d in (t, across(t)))
    return _ElementIntegrals(products, constants, directed, strains)


def _stretches(slopes: Any, direction: Any) -> Any:
    """Strains (m, a, 2, q) in a direction (2, m, q) that unit displacements make; slopes (m, 2, a,
    q)."""
    grown = direction[0][:, None] * slopes[:, 0] + direction[1][:, None] * slopes[:, 1]
    return np.stack([direction[0][:, None] * grown, direction[1][:, None] * grown], axis=2)


def _rooted_slopes(xy: Any, p: int) -> Any:
    """Gradients (e, 2, a, q) of the shape functions of elements with nodes xy (e, 2, a) at their
    Gauss points, times the root of the area of each; of an element whose map is turned over with
    the other sign."""
    ref = element(p, precise=xy.dtype == np.longdouble)
    e, _, a = xy.shape
    q = len(ref.weights)
    J = (xy.reshape(2 * e, a) @ ref.slopes).reshape(e, 2, 2, q)  # d x_c / d xi_d
    det = J[:, 0, 0] * J[:, 1, 1] - J[:, 0, 1] * J[:, 1, 0]
    J *= np.sqrt(ref.weights / np.abs(det))[:, None, None]
    first, second = ref.slopes[:, :q], ref.slopes[:, q:]
    G = np.empty(
        (e, 2, a, q), dtype=xy.dtype
    )  # d psi / d x_c times the root of dA, up to the sign of det
    np.subtract(J[:, 1, 1][:, None] * first, J[:, 1, 0][:, None] * second, out=G[:, 0])
    np.subtract(J[:, 0, 0][:, None] * second, J[:, 0, 1][:, None] * first, out=G[:, 1])
    return G


def schur_complement(K: Floats, C: Floats, inner: Floats) -> Floats:
    """K - C^T inner^-1 C: (k, k), (m, k), (m, m), each in rows without gaps, all overwritten.

    Raises NoAnswer for an `inner` that is not positive definite. Backward stable, by Cholesky's
    factors: an inverse loses digits in thin columns. What BLAS is given in rows without gaps it
    works on where it lies.
    """
    assert K.flags.c_contiguous and C.flags.c_contiguous and inner.flags.c_contiguous
    L, info = dpotrf(inner.T, lower=1, clean=0, overwrite_a=1)
    if info:
        raise NoAnswer(SINGULAR_ELEMENT)
    Y = dtrsm(1.0, L, C.T, side=1, lower=1, trans_a=1, overwrite_b=1)
    dgemm(-1.0, Y, Y, 1.0, K.T, trans_b=1, overwrite_c=1)
    return K


def schur_complements(K: Floats, C: Floats, inner: Floats) -> Floats:
    """`schur_complement` for batches (b, k, k), (b, m, k), (b, m, m), one after the other: numpy's own need
    more copies.
    """
    for own in zip(K, C, inner, strict=True):
        schur_complement(*own)
    return K


def condensed_elements(
    xy: Floats, elasticity: Floats, p: int, along: Floats | None = None
) -> Floats:
    """Stiffness (l, c, 8 p, 8 p) of elements on their boundary nodes, x and y of a node together.

    Parameters
    ----------
    xy : (l, c, 2, a) nodes of c elements in each of l layers [m]
    elasticity : (l, 3, 3) of each layer, see `stiffness`
    p : degree
    along : (l, c, 2, q), see `stiffness`
    """
    ref, shape = element(p), xy.shape[:2]
    outer, inside = slice(ref.outer), slice(ref.outer, None)
    xy, elasticity = xy.reshape(-1, *xy.shape[2:]), np.repeat(elasticity, shape[1], axis=0)
    along = None if along is None else along.reshape(len(xy), 2, -1)
    out = np.empty((len(xy), 2 * ref.outer, 2 * ref.outer))
    step = max(1, SLOPES_AT_ONCE // ref.slopes.size)
    for k in range(0, len(xy), step):
        part = slice(k, k + step)
        found = _integrals(xy[part], elasticity[part], p, None if along is None else along[part])
        e, sizes = len(found.products), (2 * ref.outer, 2 * (len(ref.order) - ref.outer))
        out[part] = schur_complements(
            *(
                found.stiffness(rows, columns).reshape(e, n, m)
                for rows, columns, n, m in (
                    (outer, outer, sizes[0], sizes[0]),
                    (inside, outer, sizes[1], sizes[0]),
                    (inside, inside, sizes[1], sizes[1]),
                )
            )
        )
    return out.reshape(*shape, *out.shape[1:])


def inner_displacements(
    xy: Floats, elasticity: Floats, p: int, along: Floats | None, u: Floats
) -> Floats:
    """Displacements (e, 2 i, m) of the i nodes inside elements, which no force acts on.

    xy (e, 2, a), elasticity (e, 3, 3) and along (e, 2, q) are as of `stiffness`; u (e, 8 p, m) are
    the displacements of the boundary nodes.
    """
    ref = element(p)
    outer, inside = slice(ref.outer), slice(ref.outer, None)
    found = np.empty((len(xy), 2 * (len(ref.order) - ref.outer), u.shape[2]))
    step = max(1, SLOPES_AT_ONCE // ref.slopes.size)
    for k in range(0, len(xy), step):
        part = slice(k, k + step)
        own = _integrals(xy[part], elasticity[part], p, None if along is None else along[part])
        coupling, inner = (
            own.stiffness(inside, columns).reshape(len(own.products), found.shape[1], -1)
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
    inverse = (
        np.array([[J[:, 1, 1], -J[:, 0, 1]], [-J[:, 1, 0], J[:, 0, 0]]]) / det
    )  # d xi_d / d x_c, (d, c, e, q)
    slopes = ref.slopes.reshape(len(ref.order), 2, q)
    return np.einsum("adq,dceq->ecaq", slopes, inverse), np.abs(det) * ref.weights
