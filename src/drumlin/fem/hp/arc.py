"""Columns of an arc or a pad, by their symmetric and their antisymmetric displacements.

Between circles about one centre the map of an element is a product, x = r(eta) c(xi), where c(xi) is
the polynomial through nodes of the unit circle. So its stiffness is a product too, of a factor A of
the angle of its column and a factor B of the radii of its layer:

    K = sum_kl (lambda A_kl + 2 mu A'_kl) B_kl,   grad psi = t f'(xi) g(eta)/r + n f(xi) g'(eta)/(r_2 - r_1)

with psi = f g, with k and l = 1, 2 for the two terms of the gradients, and with t and n functions of
xi alone. On a plane the radius does not change and n is the plane's normal. The directions along and
through a layer are functions of xi alone too. So the stiffness that they add (see
fem.substructure.elasticity) has two terms of the same form, a A''_kl B_kl + b A'''_kl B_kl.

A column is its own mirror image. Its displacements are the sum of symmetric ones (radial components
even about its middle and tangential ones odd) and of antisymmetric ones. The two kinds do no work on
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
    """The nodal functions of degree p along one direction, and the symmetry of a column.

    Attributes
    ----------
    x, weights : (q,) Gauss points of [0, 1] and their weights
    values, slopes : (p + 1, q) the nodal functions there
    sign : (2, 2 (p + 1)) sign with which nodal displacements, x and y together, count in the
        symmetric and in the antisymmetric unknowns
    place : (2 (p + 1),) the unknown of each nodal displacement, of p + 1: first those of the two
        ends, then those of each pair further in
    fold : (2, p + 1, 2 (p + 1)) from forces on nodes to forces on the unknowns of both symmetries
    outer, mixed, inner : positions of the three parts of a condensed element's stiffness in the
        stiffness of unknowns (along, along, across, across)
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
    """The nodal functions of degree p.

    They are those of scikit-fem's quadrilateral: their sums over one direction are the functions
    along the other.
    """
    n = p + 1
    x, w = leggauss(n)
    x, w = 0.5 * (x + 1), 0.5 * w
    value, slope = shape_functions(p, np.array([np.repeat(x, n), np.tile(x, n)]))
    values, slopes = (part.reshape(n, n, n, n).sum(axis=0)[:, 0] for part in (value, slope[:, 1]))
    node = np.repeat(np.arange(n), 2)
    place = 2 * np.minimum(node, p - node) + np.tile([0, 1], n)
    sign = np.ones((2, n, 2))
    sign[0, n // 2 :, 1] = sign[1, n // 2 :, 0] = -1.0
    # The middle node of an even degree moves along the radius, or across it.
    if p % 2 == 0:
        sign[:, p // 2] = np.eye(2)
        place[p : p + 2] = p
    fold = np.zeros((2, n, 2 * n))
    fold[:, place, np.arange(2 * n)] = sign.reshape(2, -1)
    fold /= np.abs(fold).sum(axis=2, keepdims=True)

    # The unknowns on the sides, on the first and last edge, and inside an element.
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
    """Forces on symmetric and antisymmetric unknowns (2, ..., p + 1, m) from forces on nodes.

    The forces V (..., 2 (p + 1), m) on nodes have x and y together.
    """
    fold = functions(p).fold
    return np.asarray(fold.reshape(2, *(1,) * (V.ndim - 2), *fold.shape[1:]) @ V)


def angular(angles: Floats, p: int, *, flat: bool = False, directed: bool = False) -> Floats:
    """The factors A_kl and 2 A'_kl (2, c, (p + 1)^2, 8) of columns, for both symmetries.

    Parameters
    ----------
    angles : (c, p + 1) nodes of the columns about their middle [rad]; lengths on a plane
    p : degree
    flat : whether the columns are on a plane
    directed : whether A''_kl and A'''_kl follow, (2, c, (p + 1)^2, 16), for layers with directions
    """
    of, (count, n) = functions(p), angles.shape
    circle = np.array([np.cos(angles), np.sin(angles)])
    at, by = circle @ of.values, circle @ of.slopes  # (2, c, q)
    if flat:
        at, by = np.zeros_like(at), np.array([np.zeros_like(by[0]), angles @ of.slopes])
        at[0] = 1.0
    strain = _strains(angles, at, by, p, flat=flat)  # (2 c, k a, 3, q)
    trace = strain[:, :, 0] + strain[:, :, 1]
    whole = np.sqrt(2) * strain.reshape(2 * count, 2 * n, -1)
    parts = [trace, whole]
    if directed:
        # The unit vector through the layers, (2 c, 1, q) for each component.
        x, y = np.tile(at / np.hypot(*at), (1, 2, 1))[:, :, None]
        xx, yy, xy = strain[:, :, 0], strain[:, :, 1], strain[:, :, 2]
        through = x**2 * xx + y**2 * yy + np.sqrt(2) * x * y * xy
        parts += [trace - through, through]
    factors = np.empty((2 * count, n, n, len(parts), 2, 2))
    for k, each in enumerate(parts):
        work = (each @ each.swapaxes(1, 2)).reshape(-1, 2, n, 2, n)
        factors[:, :, :, k] = work.transpose(0, 2, 4, 1, 3)
    return factors.reshape(2, count, n * n, 4 * len(parts))


def _strains(angles: Floats, at: Floats, by: Floats, p: int, *, flat: bool) -> Floats:
    """Strains (2 c, 2 (p + 1), 3, q) xx, yy and xy times the root of 2, by symmetric unknowns.

    They belong to both terms of the gradients, and contain the root of the quadrature's weights.

    Parameters
    ----------
    angles : as of `angular`
    at, by : (2, c, q) points of the unit circle (or the plane) and their derivative by xi
    p : degree
    flat : whether the columns are on a plane
    """
    of, (count, n) = functions(p), angles.shape
    root = np.sqrt(of.weights / (at[0] * by[1] - at[1] * by[0]))
    tangent, normal = np.array([-at[1], at[0]]) * root, np.array([by[1], -by[0]]) * root
    gradient = np.empty((2, count, 2, n, len(of.x)))
    gradient[:, :, 0] = tangent[:, :, None] * of.slopes
    gradient[:, :, 1] = normal[:, :, None] * of.values

    # Displacements on both sides count along the radius and across it there.
    turn = np.zeros((count, n))
    turn[:, ::p] = 0.0 if flat else angles[:, ::p]
    c, s = np.array([np.cos(turn), np.sin(turn)])[:, :, None, :, None]
    (cx, cy), (sy, sx) = c * gradient, s * gradient[::-1]
    strain = np.empty((count, 2, n, 2, 3, len(of.x)))
    strain[..., 0, 0, :], strain[..., 1, 0, :] = cx, -sx
    strain[..., 0, 1, :], strain[..., 1, 1, :] = sy, cy
    strain[..., 0, 2, :] = np.sqrt(0.5) * (cy + sx)
    strain[..., 1, 2, :] = np.sqrt(0.5) * (cx - sy)
    folded = _folded(strain.reshape(count, 2, 2 * n, -1), p)
    return folded.reshape(2 * count, 2 * n, 3, -1)


def _across(radii: Floats, constants: Floats, p: int, plane: float | None) -> Floats:
    """The factors B_kl times each of m constants, (l, 4 m, (p + 1)^2), of layers.

    Parameters
    ----------
    radii : (l + 1,) radii between which the layers lie [m]
    constants : (l, m) lambda, mu and, if the layers have directions, a and b [N/m]
    p : degree
    plane : as of `elements`
    """
    of = functions(p)
    x, w, values, slopes = of.x, of.weights, of.values, of.slopes
    step = (radii[1:] - radii[:-1])[:, None, None]
    r = radii[:-1, None, None] + step * x if plane is None else plane
    size = np.abs(step)
    tangential = (size * w / r * values) @ values.T
    mixed = np.sign(step) * ((w * values) @ slopes.T)
    radial = (w * r / size * slopes) @ slopes.T
    B = np.array([tangential, mixed, mixed.swapaxes(1, 2), radial]).swapaxes(0, 1)
    scaled = constants[:, :, None, None, None] * B[:, None]
    return scaled.reshape(*constants.shape[:1], 4 * constants.shape[1], -1)


def elements(
    radii: Floats, A: Floats, elasticity: Floats, p: int, plane: float | None = None
) -> Floats:
    """The stiffness (l, 2, c, 4 p, 4 p) of elements on the boundary unknowns of both symmetries.

    Displacements of the left and the right side count along the radius and across it there.

    Parameters
    ----------
    radii : (l + 1,) radii between which the layers lie [m]
    A : the `angular` parts of the columns, directed where a layer is not isotropic
    elasticity : (l, 3, 3) elasticity matrices times the width [N/m]
    p : degree
    plane : radius that divides the lengths of elements on a plane [m]; None on a drum
    """
    of = functions(p)
    A = A.reshape(-1, *A.shape[2:])
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
    """The stiffness (c, n, n) of columns, on the unknowns of `columns.ColumnSubstructure`.

    Parameters
    ----------
    parts : (l, 2, c, 4 p, 4 p) stiffness of `elements`
    p : degree
    contact, held : as of `columns.stack`
    loads : (c, 2 (p + 1), m) unit loads on the innermost edge; they become m extra unknowns
    """
    of = stack(p, len(parts), contact=contact, held=held, sides=1)
    n = 2 * (p + 1) * contact
    folded = None if loads is None else _folded(loads, p).reshape(-1, p + 1, loads.shape[-1])
    K = columns(parts.reshape(len(parts), -1, 4 * p, 4 * p), of, folded)
    K = K.reshape(2, -1, *K.shape[1:])
    S, A = K

    # The unknowns of a column: extra ones and left line, contact, right line.
    extra = K.shape[-1] - of.sides
    own = extra + of.line
    lines = slice(extra, own)
    left, middle, right = slice(own), slice(own, own + n), slice(own + n, None)
    found = np.empty((K.shape[1], own + n + of.line, own + n + of.line))
    mirror = np.ones(of.line)
    mirror[1::2] = -1.0
    np.add(S[:, left, left], A[:, left, left], out=found[:, left, left])
    # The products are made in place: half of the time is that of new memory.
    left_right = found[:, left, right]
    np.subtract(S[:, left, lines], A[:, left, lines], out=left_right)
    left_right *= mirror
    right_left = found[:, right, left]
    np.subtract(S[:, lines, left], A[:, lines, left], out=right_left)
    right_left *= mirror[:, None]
    right_right = found[:, right, right]
    np.multiply(found[:, lines, lines], mirror, out=right_right)
    right_right *= mirror[:, None]
    if contact:
        (even, odd), place = functions(p).sign, own + functions(p).place
        S, A = S[:, place] * even[:, None], A[:, place] * odd[:, None]
        found[:, middle, left] = S[:, :, left] + A[:, :, left]
        found[:, middle, middle] = S[:, :, place] * even + A[:, :, place] * odd
        found[:, middle, right] = mirror * (S[:, :, lines] - A[:, :, lines])
        found[:, left, middle] = found[:, middle, left].transpose(0, 2, 1)
        found[:, right, middle] = found[:, middle, right].transpose(0, 2, 1)
    return found
