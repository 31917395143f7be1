"""Columns of an arc or a pad, by their symmetric and their antisymmetric motions.

Between circles about one centre the map of an element is a product, x = r(eta) c(xi), c(xi) the
polynomial through nodes of the unit circle. So its stiffness is one too, of what hangs on the angle
of its column, A, and on the radii of its layer, B:

    K = sum_kl (lambda A_kl + 2 mu A'_kl) B_kl,   grad psi = t f'(xi) g(eta)/r + n f(xi) g'(eta)/(r_2 - r_1)

with psi = f g, k and l = 1, 2 for the two terms of the gradients, t and n hanging on xi alone. On a
plane the radius does not change and n is its normal. The directions along and through a layer hang
on xi alone too, so that what a layer is stiffer in them (see fem.substructure.elasticity) adds two terms of the
same form, a A''_kl B_kl + b A'''_kl B_kl.

A column is its own mirror image. Its motions are the sum of symmetric ones, radial displacements
even about its middle and tangential ones odd, and of antisymmetric ones. These two do no work on
each other and have half the unknowns each.
"""

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.polynomial.legendre import leggauss

from drumlin.base.arrays import Floats, Ints
from drumlin.fem.hp.columns import columns, stack
from drumlin.fem.hp.element import schur_complements, shape_functions
from drumlin.fem.substructure.elasticity import split


class Functions(NamedTuple):
    """Of degree p: Gauss points `x` (q,) of [0, 1] and their `weights`; the nodal functions'
    `values` and `slopes` (p + 1, q) there; `sign` (2, 2 (p + 1)) by which displacements of the
    nodes, x and y together, count in the symmetric and the antisymmetric unknowns, and in which of
    these (p + 1), `place` (2 (p + 1),): first those of the two ends, then those of each pair
    further in; `fold` (2, p + 1, 2 (p + 1)): forces on nodes on these unknowns; `outer`, `mixed`,
    `inner`: where the parts of a condensed element's stiffness are in that of unknowns (along,
    along, across, across).
    """

    x: Floats
    weights: Floats
    values: Floats
    slopes: Floats
    sign: Floats
    place: Ints
    fold: Floats
    outer: Ints
    mixed: Ints
    inner: Ints


@cache
def functions(p: int) -> Functions:
    """Those of scikit-fem's quadrilateral, whose sums over one direction are those along the other."""
    n = p + 1
    x, w = leggauss(n)
    x, w = 0.5 * (x + 1), 0.5 * w
    value, slope = shape_functions(p, np.array([np.repeat(x, n), np.tile(x, n)]))
    values, slopes = (part.reshape(n, n, n, n).sum(axis=0)[:, 0] for part in (value, slope[:, 1]))
    node = np.repeat(np.arange(n), 2)
    place = 2 * np.minimum(node, p - node) + np.tile([0, 1], n)
    sign = np.ones((2, n, 2))
    sign[0, n // 2 :, 1] = sign[1, n // 2 :, 0] = -1.0
    if p % 2 == 0:  # the middle moves along the radius, or across it
        sign[:, p // 2] = np.eye(2)
        place[p : p + 2] = p
    fold = np.zeros((2, n, 2 * n))
    fold[:, place, np.arange(2 * n)] = sign.reshape(2, -1)
    fold /= np.abs(fold).sum(axis=2, keepdims=True)
    across = np.arange(n)
    sides = np.tile([0, 1], n), np.repeat(across, 2)
    further = np.arange(2, n)
    first, last = (further, np.zeros(p - 1, int)), (further, np.full(p - 1, p))
    outer = [np.concatenate(parts) for parts in zip(sides, first, last, strict=True)]
    inner = [np.tile(further, p - 1), np.repeat(across[1:-1], p - 1)]

    def at(rows: list[Ints], columns: list[Ints]) -> Ints:
        a, b = (part[:, None] for part in rows)
        return np.asarray(((a * n + columns[0]) * n + b) * n + columns[1])

    parts = at(outer, outer), at(inner, outer), at(inner, inner)
    return Functions(x, w, values, slopes, sign.reshape(2, -1), place, fold, *parts)


def _folded(V: Floats, p: int) -> Floats:
    """Forces V (..., 2 (p + 1), m) on nodes, x and y together, on the symmetric and antisymmetric
    unknowns: (2, ..., p + 1, m).
    """
    fold = functions(p).fold
    return np.asarray(fold.reshape(2, *(1,) * (V.ndim - 2), *fold.shape[1:]) @ V)


def angular(angles: Floats, p: int, *, flat: bool = False, directed: bool = False) -> Floats:
    """A_kl and 2 A'_kl (2, c, (p + 1)^2, 8) of columns with nodes at `angles` (c, p + 1) about
    their middle [rad].

    flat: of columns on a plane, whose angles are lengths; directed: with A''_kl and A'''_kl, (2, c,
    (p + 1)^2, 16), for layers that are not isotropic.
    """
    of, (count, n) = functions(p), angles.shape
    circle = np.array([np.cos(angles), np.sin(angles)])
    at, by = circle @ of.values, circle @ of.slopes  # (2, c, q)
    if flat:
        at, by = np.zeros_like(at), np.array([np.zeros_like(by[0]), angles @ of.slopes])
        at[0] = 1.0
    root = np.sqrt(of.weights / (at[0] * by[1] - at[1] * by[0]))
    tangent, normal = np.array([-at[1], at[0]]) * root, np.array([by[1], -by[0]]) * root
    gradient = np.empty((2, count, 2, n, len(of.x)))
    gradient[:, :, 0], gradient[:, :, 1] = (
        tangent[:, :, None] * of.slopes,
        normal[:, :, None] * of.values,
    )
    turn = np.zeros((count, n))
    turn[:, ::p] = (
        0.0 if flat else angles[:, ::p]
    )  # of the sides along the radius and across it there
    c, s = np.array([np.cos(turn), np.sin(turn)])[:, :, None, :, None]
    (cx, cy), (sy, sx) = c * gradient, s * gradient[::-1]
    strain = np.empty(
        (count, 2, n, 2, 3, len(of.x))
    )  # xx, yy and xy times the root of 2, of either component
    strain[..., 0, 0, :], strain[..., 1, 0, :] = cx, -sx
    strain[..., 0, 1, :], strain[..., 1, 1, :] = sy, cy
    strain[..., 0, 2, :], strain[..., 1, 2, :] = np.sqrt(0.5) * (cy + sx), np.sqrt(0.5) * (cx - sy)
    strain = _folded(strain.reshape(count, 2, 2 * n, -1), p).reshape(
        2 * count, 2 * n, 3, -1
    )  # (2 c, k a, 3, q)
    trace, whole = (
        strain[:, :, 0] + strain[:, :, 1],
        np.sqrt(2) * strain.reshape(2 * count, 2 * n, -1),
    )
    parts = [trace, whole]
    if directed:
        x, y = np.tile(at / np.hypot(*at), (1, 2, 1))[
            :, :, None
        ]  # the unit vector through the layers, (2 c, 1, q)
        through = (
            x**2 * strain[:, :, 0] + y**2 * strain[:, :, 1] + np.sqrt(2) * x * y * strain[:, :, 2]
        )
        parts += [trace - through, through]
    found = np.empty((2 * count, n, n, len(parts), 2, 2))
    for k, each in enumerate(parts):
        found[:, :, :, k] = (
            (each @ each.swapaxes(1, 2)).reshape(-1, 2, n, 2, n).transpose(0, 2, 4, 1, 3)
        )
    return found.reshape(2, count, n * n, 4 * len(parts))


def _across(radii: Floats, constants: Floats, p: int, plane: float | None) -> Floats:
    """B_kl times each of m constants, (l, 4 m, (p + 1)^2), of layers between the radii (l + 1,)
    [m].

    constants (l, m): lambda, mu and, if the layers have directions, a and b; plane: of `elements`.
    """
    x, w, values, slopes, *_ = functions(p)
    step = (radii[1:] - radii[:-1])[:, None, None]
    r, size = radii[:-1, None, None] + step * x if plane is None else plane, np.abs(step)
    mixed = np.sign(step) * ((w * values) @ slopes.T)
    B = np.array(
        [
            (size * w / r * values) @ values.T,
            mixed,
            mixed.swapaxes(1, 2),
            (w * r / size * slopes) @ slopes.T,
        ]
    ).swapaxes(0, 1)
    return (constants[:, :, None, None, None] * B[:, None]).reshape(
        *constants.shape[:1], 4 * constants.shape[1], -1
    )


def elements(
    radii: Floats, A: Floats, elasticity: Floats, p: int, plane: float | None = None
) -> Floats:
    """Stiffness (l, 2, c, 4 p, 4 p) of elements on their symmetric and their antisymmetric boundary
    unknowns.

    Displacements of the left and the right side count along the radius and across it there.

    Parameters
    ----------
    radii : (l + 1,) radii between which the layers lie [m]
    A : the `angular` parts of the columns, directed where a layer is not isotropic
    elasticity : (l, 3, 3) elasticity matrices times the width [N/m]
    p : degree
    plane : of elements on a plane, whose angles are lengths, by what [m]
    """
    of, A = functions(p), A.reshape(-1, *A.shape[2:])
    constants = split(elasticity)[:, : A.shape[-1] // 4]
    found = np.empty((len(constants), len(A), 4 * p, 4 * p))
    for layer, B in enumerate(_across(radii, constants, p, plane)):
        K = (A @ B).reshape(len(A), -1)
        found[layer] = schur_complements(
            *(K.take(part, 1) for part in (of.outer, of.mixed, of.inner))
        )
    return found.reshape(len(constants), 2, -1, 4 * p, 4 * p)


def arc_columns(
    parts: Floats, p: int, *, contact: bool, held: bool, loads: Floats | None = None
) -> Floats:
    """Columns (c, n, n) of `elements` (l, 2, c, 4 p, 4 p), on the unknowns of `columns.ColumnSubstructure`.

    loads (c, 2 (p + 1), m): unit loads on the innermost edge; they become m extra unknowns.
    """
    of, n = stack(p, len(parts), contact=contact, held=held, sides=1), 2 * (p + 1) * contact
    folded = None if loads is None else _folded(loads, p).reshape(-1, p + 1, loads.shape[-1])
    K = columns(parts.reshape(len(parts), -1, 4 * p, 4 * p), of, folded)
    K = K.reshape(2, -1, *K.shape[1:])
    extra = K.shape[-1] - of.sides
    own = extra + of.line
    left, lines, middle, right = (
        slice(own),
        slice(extra, own),
        slice(own, own + n),
        slice(own + n, None),
    )
    found, (S, A) = np.empty((K.shape[1], own + n + of.line, own + n + of.line)), K
    mirror = np.ones(of.line)
    mirror[1::2] = -1.0
    np.add(S[:, left, left], A[:, left, left], out=found[:, left, left])
    for rows, along, to, by in (
        (left, lines, (left, right), mirror),
        (lines, left, (right, left), mirror[:, None]),
    ):
        part = found[:, *to]
        np.subtract(S[:, rows, along], A[:, rows, along], out=part)
        part *= by  # in place: half of the time is that of new memory
    part = found[:, right, right]
    np.multiply(found[:, lines, lines], mirror, out=part)
    part *= mirror[:, None]
    if contact:
        (even, odd), place = functions(p).sign, own + functions(p).place
        S, A = S[:, place] * even[:, None], A[:, place] * odd[:, None]
        found[:, middle, left] = S[:, :, left] + A[:, :, left]
        found[:, middle, middle] = S[:, :, place] * even + A[:, :, place] * odd
        found[:, middle, right] = mirror * (S[:, :, lines] - A[:, :, lines])
        found[:, left, middle] = found[:, middle, left].transpose(0, 2, 1)
        found[:, right, middle] = found[:, middle, right].transpose(0, 2, 1)
    return found
