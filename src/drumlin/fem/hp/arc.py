"""Element columns on an arc or a pad, by their symmetric and their antisymmetric displacements.

Between circles about one centre the map of an element is a product, x = r(eta) c(xi). Here c(xi) is
the polynomial through nodes of the unit circle. So the stiffness of an element is a sum of products
too. Each product has a factor A of the angle of its column and a factor B of the radii of its
layer:

    K         = sum_kl (lambda A_kl + 2 mu A'_kl) B_kl
    grad psi  = t f'(xi) g(eta) / r + n f(xi) g'(eta) / (r_2 - r_1)

with psi = f g, with k and l = 1, 2 for the two terms of the gradients, and with t and n functions
of xi alone. On a plane the radius does not change, and n is the plane's normal. The directions
along and through a layer are functions of xi alone too. So the stiffness that a layer with
directions adds (see fem.substructure.elasticity) has two terms of the same form,
a A''_kl B_kl + b A'''_kl B_kl.

A column is its own mirror image. Its displacements are the sum of symmetric ones (radial components
even about its middle and tangential ones odd) and of antisymmetric ones. The two kinds do no work
on each other and have half the unknowns each.
"""

from functools import cache
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.fem.hp.columns import column_stiffness, order_of_column_unknowns
from drumlin.fem.hp.element import (
    schur_complements,
    shape_functions,
    square_grid_points,
    unit_gauss_rule,
)
from drumlin.fem.substructure.elasticity import split_elasticity


class NodalFunctions(NamedTuple):
    """Nodal functions of degree p along one direction of an element column, and its symmetry.

    Attributes
    ----------
    x, weights : (q,) Gauss points of [0, 1] and their weights
    values, slopes : (p + 1, q) the nodal functions at the Gauss points
    sign : (2, 2 (p + 1)) sign with which nodal displacements, x and y together, count in the
        symmetric and in the antisymmetric unknowns
    place : (2 (p + 1),) the unknown of each nodal displacement, of p + 1: first those of the two
        ends, then those of each pair further in
    fold : (2, p + 1, 2 (p + 1)) from forces on nodes to forces on the unknowns of both symmetries
    outer, mixed, inner : positions of the three blocks of an element's stiffness (boundary
        unknowns, inner by boundary unknowns, inner unknowns) in the unordered stiffness, which has
        the indices (along, along, across, across)
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
def nodal_functions(p: int) -> NodalFunctions:
    """The nodal functions of degree p along one direction, and the symmetry of a column.

    The sums of the shape functions of scikit-fem's quadrilateral over one direction are the nodal
    functions along the other direction.
    """
    n = p + 1
    x, weights = unit_gauss_rule(p)
    value, slope = shape_functions(p, square_grid_points(x))
    # The functions are summed over the nodes across the column, at the first Gauss point there.
    values = value.reshape(n, n, n, n).sum(axis=0)[:, 0]
    slopes = slope[:, 1].reshape(n, n, n, n).sum(axis=0)[:, 0]
    node = np.repeat(np.arange(n), 2)
    place = 2 * np.minimum(node, p - node) + np.tile([0, 1], n)
    sign = np.ones((2, n, 2))
    sign[0, n // 2 :, 1] = sign[1, n // 2 :, 0] = -1.0
    # The middle node of an even degree moves along the radius in the symmetric displacements, and
    # around the drum in the antisymmetric ones.
    if p % 2 == 0:
        sign[:, p // 2] = np.eye(2)
        place[p : p + 2] = p
    fold = np.zeros((2, n, 2 * n))
    fold[:, place, np.arange(2 * n)] = sign.reshape(2, -1)
    fold /= np.abs(fold).sum(axis=2, keepdims=True)

    # The unknowns of an element by their two numbers, along and across the column: first those on
    # the sides, on the first and on the last edge, then those inside the element.
    further = np.arange(2, n)
    outer_along = np.concatenate([np.tile([0, 1], n), further, further])
    outer_across = np.repeat([*range(n), 0, p], [2] * n + [p - 1] * 2)
    outer = outer_along, outer_across
    inner = np.tile(further, p - 1), np.repeat(np.arange(1, p), p - 1)

    def positions(rows: tuple[Ints, Ints], columns: tuple[Ints, Ints]) -> Ints:
        """Positions of a block in the unordered stiffness, by its rows and its columns."""
        along, across = rows[0][:, None], rows[1][:, None]
        return np.asarray(((along * n + columns[0]) * n + across) * n + columns[1])

    blocks = positions(outer, outer), positions(inner, outer), positions(inner, inner)
    return NodalFunctions(x, weights, values, slopes, sign.reshape(2, -1), place, fold, *blocks)


def _forces_by_symmetry(V: Floats, p: int) -> Floats:
    """Forces on symmetric and on antisymmetric unknowns (2, ..., p + 1, m) of a column.

    They follow from the forces V (..., 2 (p + 1), m) on its nodes, with x and y together.
    """
    fold = nodal_functions(p).fold
    return np.asarray(fold.reshape(2, *(1,) * (V.ndim - 2), *fold.shape[1:]) @ V)


def circle_at_gauss_points(angles: Floats, p: int, *, flat: bool) -> tuple[Floats, Floats]:
    """Points (2, c, q) of the unit circle at the Gauss points of columns; their derivatives by xi.

    Both are interpolated between the nodes of the columns. On a plane the line x = 1 takes the
    place of the circle.

    Parameters
    ----------
    angles : (c, p + 1) nodes of the columns about their middle [rad]; lengths on a plane
    p : degree
    flat : whether the columns are on a plane
    """
    functions = nodal_functions(p)
    if flat:
        slope = angles @ functions.slopes
        one, zero = np.ones_like(slope), np.zeros_like(slope)
        return np.array([one, zero]), np.array([zero, slope])
    circle = np.array([np.cos(angles), np.sin(angles)])
    return circle @ functions.values, circle @ functions.slopes


def angular_integrals(
    angles: Floats, p: int, *, flat: bool = False, directed: bool = False
) -> Floats:
    """The factors A_kl and 2 A'_kl of the stiffness of columns, (2, c, (p + 1)^2, 8).

    The first axis counts the symmetric and the antisymmetric displacements.

    Parameters
    ----------
    angles : (c, p + 1) nodes of the columns about their middle [rad]; lengths on a plane
    p : degree
    flat : whether the columns are on a plane
    directed : whether A''_kl and A'''_kl follow, (2, c, (p + 1)^2, 16), for layers with directions
    """
    count, n = angles.shape
    at, by = circle_at_gauss_points(angles, p, flat=flat)
    strain = _weighted_strains(angles, at, by, p, flat=flat)  # (2 c, k a, 3, q)
    trace = strain[:, :, 0] + strain[:, :, 1]
    whole = np.sqrt(2) * strain.reshape(2 * count, 2 * n, -1)
    parts = [trace, whole]
    if directed:
        # Both components (2 c, 1, q) of the unit vector through the layers.
        x, y = np.tile(at / np.hypot(*at), (1, 2, 1))[:, :, None]
        xx, yy, xy = strain[:, :, 0], strain[:, :, 1], strain[:, :, 2]
        through = x**2 * xx + y**2 * yy + np.sqrt(2) * x * y * xy
        parts += [trace - through, through]
    factors = np.empty((2 * count, n, n, len(parts), 2, 2))
    for k, each in enumerate(parts):
        work = (each @ each.swapaxes(1, 2)).reshape(-1, 2, n, 2, n)
        factors[:, :, :, k] = work.transpose(0, 2, 4, 1, 3)
    return factors.reshape(2, count, n * n, 4 * len(parts))


def _weighted_strains(angles: Floats, at: Floats, by: Floats, p: int, *, flat: bool) -> Floats:
    """Strains xx, yy and sqrt(2) xy of columns, (2 c, 2 (p + 1), 3, q), by unit displacements.

    The strains are those of both terms of the gradients, by the unknowns of both symmetries. They
    contain the root of the quadrature's weights, so that products of two strains are integrals.

    Parameters
    ----------
    angles : (c, p + 1) nodes of the columns about their middle [rad]; lengths on a plane
    at, by : (2, c, q) points of the unit circle (or the plane) and their derivative by xi
    p : degree
    flat : whether the columns are on a plane
    """
    functions, (count, n) = nodal_functions(p), angles.shape
    root = np.sqrt(functions.weights / (at[0] * by[1] - at[1] * by[0]))
    tangent, normal = np.array([-at[1], at[0]]) * root, np.array([by[1], -by[0]]) * root
    gradient = np.empty((2, count, 2, n, len(functions.x)))
    gradient[:, :, 0] = tangent[:, :, None] * functions.slopes
    gradient[:, :, 1] = normal[:, :, None] * functions.values

    # A displacement on a side of a column counts along the radius of the side and across the
    # radius.
    turn = np.zeros((count, n))
    turn[:, ::p] = 0.0 if flat else angles[:, ::p]
    c, s = np.array([np.cos(turn), np.sin(turn)])[:, :, None, :, None]
    (cx, cy), (sy, sx) = c * gradient, s * gradient[::-1]
    strain = np.empty((count, 2, n, 2, 3, len(functions.x)))
    strain[..., 0, 0, :], strain[..., 1, 0, :] = cx, -sx
    strain[..., 0, 1, :], strain[..., 1, 1, :] = sy, cy
    strain[..., 0, 2, :] = np.sqrt(0.5) * (cy + sx)
    strain[..., 1, 2, :] = np.sqrt(0.5) * (cx - sy)
    by_symmetry = _forces_by_symmetry(strain.reshape(count, 2, 2 * n, -1), p)
    return by_symmetry.reshape(2 * count, 2 * n, 3, -1)


def _radial_integrals(radii: Floats, constants: Floats, p: int, plane: float | None) -> Floats:
    """The factors B_kl of the stiffness of layers times m constants, (l, 4 m, (p + 1)^2).

    Parameters
    ----------
    radii : (l + 1,) radii between which the layers lie [m]
    constants : (l, m) lambda, mu and, if the layers have directions, a and b [N/m]
    p : degree
    plane : radius that divides the lengths of elements on a plane [m]; None on a drum
    """
    functions = nodal_functions(p)
    weights, values, slopes = functions.weights, functions.values, functions.slopes
    step = (radii[1:] - radii[:-1])[:, None, None]
    r = radii[:-1, None, None] + step * functions.x if plane is None else plane
    size = np.abs(step)
    tangential = (size * weights / r * values) @ values.T
    mixed = np.sign(step) * ((weights * values) @ slopes.T)
    radial = (weights * r / size * slopes) @ slopes.T
    B = np.array([tangential, mixed, mixed.swapaxes(1, 2), radial]).swapaxes(0, 1)
    scaled = constants[:, :, None, None, None] * B[:, None]
    return scaled.reshape(len(constants), 4 * constants.shape[1], -1)


def condensed_arc_element_stiffness(
    radii: Floats, A: Floats, elasticity: Floats, p: int, plane: float | None = None
) -> Floats:
    """Stiffness (l, 2, c, 4 p, 4 p) of condensed arc elements, for both symmetries.

    The unknowns are those on the boundary of an element. Displacements
    on the left and the right side are measured along the side's own radius and across it.

    Parameters
    ----------
    radii : (l + 1,) radii between which the layers lie [m]
    A : the `angular_integrals` of the columns, directed where a layer is not isotropic
    elasticity : (l, 3, 3) elasticity matrices times the width [N/m]
    p : degree
    plane : radius that divides the lengths of elements on a plane [m]; None on a drum
    """
    functions = nodal_functions(p)
    A = A.reshape(-1, *A.shape[2:])
    constants = split_elasticity(elasticity)[:, : A.shape[-1] // 4]
    condensed = np.empty((len(constants), len(A), 4 * p, 4 * p))
    for layer, B in enumerate(_radial_integrals(radii, constants, p, plane)):
        K = (A @ B).reshape(len(A), -1)
        outer, mixed, inner = (
            K.take(functions.outer, 1),
            K.take(functions.mixed, 1),
            K.take(functions.inner, 1),
        )
        condensed[layer] = schur_complements(outer, mixed, inner)
    return condensed.reshape(len(constants), 2, -1, 4 * p, 4 * p)


def arc_column_stiffness(
    parts: Floats, p: int, *, contact: bool, held: bool, loads: Floats | None = None
) -> Floats:
    """The stiffness (c, n, n) of columns on an arc or a pad, without their inner unknowns.

    The unknowns are those of `columns.ColumnSubstructure`.

    Parameters
    ----------
    parts : (l, 2, c, 4 p, 4 p) stiffness of `condensed_arc_element_stiffness`
    p : degree
    contact : whether the outermost edge of the columns is in contact
    held : whether the innermost edge of the columns is held
    loads : (c, 2 (p + 1), m) unit loads on the innermost edge; the factors of the loads
        become m extra unknowns
    """
    half = order_of_column_unknowns(p, len(parts), contact=contact, held=held, sides=1)
    n = 2 * (p + 1) * contact
    folded = None
    if loads is not None:
        folded = _forces_by_symmetry(loads, p).reshape(-1, p + 1, loads.shape[-1])
    K = column_stiffness(parts.reshape(len(parts), -1, 4 * p, 4 * p), half, folded)
    S, A = K.reshape(2, -1, *K.shape[1:])

    # A column has the unknowns of the loads and of the left line, the contact, and the right line.
    extra = K.shape[-1] - half.sides
    own = extra + half.line
    lines = slice(extra, own)
    left, middle, right = slice(own), slice(own, own + n), slice(own + n, None)
    whole = np.empty((S.shape[0], own + n + half.line, own + n + half.line))
    mirror = np.ones(half.line)
    mirror[1::2] = -1.0
    np.add(S[:, left, left], A[:, left, left], out=whole[:, left, left])
    # The products are made in place, since new memory would take as long as the products.
    left_right = whole[:, left, right]
    np.subtract(S[:, left, lines], A[:, left, lines], out=left_right)
    left_right *= mirror
    right_left = whole[:, right, left]
    np.subtract(S[:, lines, left], A[:, lines, left], out=right_left)
    right_left *= mirror[:, None]
    right_right = whole[:, right, right]
    np.multiply(whole[:, lines, lines], mirror, out=right_right)
    right_right *= mirror[:, None]
    if contact:
        functions = nodal_functions(p)
        (even, odd), place = functions.sign, own + functions.place
        S, A = S[:, place] * even[:, None], A[:, place] * odd[:, None]
        whole[:, middle, left] = S[:, :, left] + A[:, :, left]
        whole[:, middle, middle] = S[:, :, place] * even + A[:, :, place] * odd
        whole[:, middle, right] = mirror * (S[:, :, lines] - A[:, :, lines])
        whole[:, left, middle] = whole[:, middle, left].transpose(0, 2, 1)
        whole[:, right, middle] = whole[:, middle, right].transpose(0, 2, 1)
    return whole
