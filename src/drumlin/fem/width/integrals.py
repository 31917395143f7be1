"""Integrals over the section of products of shape functions and of their gradients.

The displacements of a shoe with a width are sums of products of shape functions psi_a of the
section and functions of z: even functions e_k for u_x and u_y, odd functions o_k for u_z. So the
energy of an isotropic element is a sum of products of an integral over the section and an integral
over the width. For two unknowns a and b the two integrals in each line are multiplied, and the
products of the two lines of each case are added. eps_a is the strain in the section due to unknown
a, and tr eps_a its trace; lambda and mu are the Lame constants:

    both in the section:  Int lambda tr eps_a tr eps_b + 2 mu eps_a : eps_b dA  Int e_k e_l dz
                        + Int mu psi_a . psi_b dA                               Int e_k' e_l' dz
    b along z:            Int lambda tr eps_a psi_b dA                          Int e_k o_l' dz
                        + Int mu psi_a . grad psi_b dA                          Int e_k' o_l dz
    both along z:         Int (lambda + 2 mu) psi_a psi_b dA                    Int o_k' o_l' dz
                        + Int mu grad psi_a . grad psi_b dA                     Int o_k o_l dz

An unknown has two indices: the index of its row of nodes, counted from the contact, and its index
along this row. Along a row the displacements x and y are counted together, and the displacements z
separately. Between circles about one centre each integral is a sum of products of a factor of the
angles and a factor of the radii, as in fem/hp/arc.py. The displacements of a column of elements are
then split into displacements that are symmetric and displacements that are antisymmetric about the
column's middle. In symmetric displacements u_z and the radial component are even about the middle.
"""

from functools import cache
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.fem.hp.arc import (
    circle_points_and_slopes_at_gauss_points,
    nodal_functions_along_element_column,
)
from drumlin.fem.hp.element import (
    reference_element_of_degree,
    shape_function_gradients_and_gauss_areas,
)

SYMMETRY_NUMBERS_OF_COLUMN_DISPLACEMENTS = (0, 1)
"""The two symmetries of displacements about a column's middle: 0 symmetric, 1 antisymmetric."""


class LameConstants(NamedTuple):
    """The Lame constants lambda and mu of a layer [Pa].

    If the displacements are constant over z (degree 0 across the width), `lam` is the lambda of
    plane stress.
    """

    lam: float
    mu: float


class ElementIntegralsOverShoeSection(NamedTuple):
    """Integrals over each of c elements of a layer, of products of shape functions and gradients.

    Each integral contains the Lame constants. The axes after c are (along, along, row, row): the
    positions of two unknowns along their rows, and the rows of the two unknowns. Of the unknowns
    along a row, A are displacements x and y in the section, and B are displacements along z. An
    element has n rows of nodes.

    Attributes
    ----------
    plane : (c, A, A, n, n) Int lambda tr eps_a tr eps_b + 2 mu eps_a : eps_b dA [Pa]
    shear : (c, A, A, n, n) Int mu psi_a . psi_b dA [N]
    integrals_of_trace_times_z_value : (c, A, B, n, n) Int lambda tr eps_a psi_b dA [N/m]
    integrals_of_value_times_z_slope : (c, A, B, n, n) Int mu psi_a . grad psi_b dA [N/m]
    across : (c, B, B, n, n) Int (lambda + 2 mu) psi_a psi_b dA [N]
    integrals_of_z_slope_products : (c, B, B, n, n) Int mu grad psi_a . grad psi_b dA [Pa]
    """

    plane: Floats
    shear: Floats
    integrals_of_trace_times_z_value: Floats
    integrals_of_value_times_z_slope: Floats
    across: Floats
    integrals_of_z_slope_products: Floats


class AngularFactorsOfSectionIntegrals(NamedTuple):
    """The angular factors of the integrals over c columns, for displacements of one symmetry.

    Each integral over an element of the section is a sum of products of an angular and a radial
    factor. Along a row of nodes A unknowns are displacements in the section, and B unknowns are
    displacements along z. The letters k and l count the two terms of the gradients in
    fem/hp/arc.py: k, l = 1 for the tangential and 2 for the radial term.

    Attributes
    ----------
    strains : (c, A A, 8) products of the traces of two strains, then twice the products of two
        strain tensors, both for all k and l
    values : (c, A A, 1) products of two displacements in the section
    traces_times_z_values : (c, A B, 2) products of the trace of a strain and u_z, for each k
    values_times_z_slopes : (c, A B, 2) products of a displacement in the section and the gradient
        of u_z, for each l
    z_value_products : (c, B B, 1) products of two u_z
    z_slope_products : (c, B B, 4) products of two gradients of u_z, for all k and l
    """

    strains: Floats
    values: Floats
    traces_times_z_values: Floats
    values_times_z_slopes: Floats
    z_value_products: Floats
    z_slope_products: Floats


@cache
def matrix_from_node_to_unknown_forces_along_z(p: int, symmetry: int) -> Floats:
    """The matrix (B, p + 1) from forces along z on a row's nodes to forces on its B unknowns.

    The row has p + 1 nodes, and the unknowns describe displacements of one symmetry. Each unknown
    belongs to a pair of mirrored nodes. The force on the unknown is half the sum of the forces on
    both nodes, or half their difference for antisymmetric displacements. The first pair are the
    nodes on the two sides of the column, and the pairs nearer to the middle follow. In symmetric
    displacements the last unknown belongs to the middle node, if the row has a middle node.
    """
    count = (p + 1) // 2 + (p % 2 == 0 and symmetry == 0)
    fold = np.zeros((count, p + 1))
    own = np.arange(count)
    fold[own, p - own] = 0.5 if symmetry == 0 else -0.5
    fold[own, own] = 0.5
    if p % 2 == 0 and symmetry == 0:
        fold[-1, p // 2] = 1.0
    return fold


def angular_factors_of_section_integrals(
    angles: Floats, p: int, symmetry: int, *, flat: bool = False
) -> AngularFactorsOfSectionIntegrals:
    """The angular factors of the integrals over columns of elements on an arc or on a plane.

    Displacements of a node on a side of its column are measured along the side's radius and square
    to it. Displacements of all other nodes are measured along the radius of the column's middle and
    square to it.

    Parameters
    ----------
    angles : (c, p + 1) angles of each column's nodes from its middle [rad]; on a plane distances,
        divided by the length [m] that makes positions on the plane dimensionless
    p : degree of the hp elements
    symmetry : 0 for symmetric displacements, 1 for antisymmetric ones
    flat : whether the columns are on a plane
    """
    functions, (count, n) = nodal_functions_along_element_column(p), angles.shape
    at, by = circle_points_and_slopes_at_gauss_points(angles, p, flat=flat)
    size = at[0] * by[1] - at[1] * by[0]
    root = np.sqrt(functions.weights / size)
    tangent, normal = np.array([-at[1], at[0]]) * root, np.array([by[1], -by[0]]) * root

    # The gradients (x or y, columns, k, nodes, points) and the values contain the square root of
    # the Gauss weights, so that products of two of them are integrated by summing.
    gradient = np.empty((2, count, 2, n, len(functions.x)))
    gradient[:, :, 0] = tangent[:, :, None] * functions.slopes
    gradient[:, :, 1] = normal[:, :, None] * functions.values
    value = functions.values * np.sqrt(functions.weights * size)[:, None]  # (c, n, q)

    # `strain` and `moved` are the strains and displacements due to unit displacements of the nodes,
    # along a radius (x) and square to the radius (y). For nodes on a side of the column it is the
    # radius at this side, and for all other nodes the radius at the column's middle.
    turn = np.zeros((count, n))
    turn[:, ::p] = 0.0 if flat else angles[:, ::p]
    c, s = np.cos(turn)[:, :, None], np.sin(turn)[:, :, None]
    ck, sk = c[:, None], s[:, None]
    gx, gy = gradient
    strain = np.empty((count, 2, n, 2, 3, len(functions.x)))
    strain[:, :, :, 0, 0], strain[:, :, :, 1, 0] = ck * gx, -sk * gx
    strain[:, :, :, 0, 1], strain[:, :, :, 1, 1] = sk * gy, ck * gy
    strain[:, :, :, 0, 2] = np.sqrt(0.5) * (ck * gy + sk * gx)
    strain[:, :, :, 1, 2] = np.sqrt(0.5) * (ck * gx - sk * gy)
    moved = np.empty((count, n, 2, 2, len(functions.x)))
    moved[:, :, 0, 0], moved[:, :, 0, 1] = c * value, s * value
    moved[:, :, 1, 0], moved[:, :, 1, 1] = -s * value, c * value

    # In displacements of one symmetry, both nodes of a mirrored pair belong to one unknown. The
    # values due to the two nodes are combined to the value due to this unknown.
    fold, across = (
        functions.matrices_to_symmetric_forces[symmetry],
        matrix_from_node_to_unknown_forces_along_z(p, symmetry),
    )
    A, B = len(fold), len(across)
    strain = (fold @ strain.reshape(count, 2, 2 * n, -1)).reshape(count, 2 * A, 3, -1)
    moved = (fold @ moved.reshape(count, 2 * n, -1)).reshape(count, A, -1)
    value = across @ value
    gradient = across @ gradient.transpose(1, 2, 3, 0, 4).reshape(count, 2, n, -1)

    # The products of every two unknowns are summed over the Gauss points along the arc.
    trace = strain[:, :, 0] + strain[:, :, 1]
    whole = np.sqrt(2) * strain.reshape(count, 2 * A, -1)
    by_strains = np.stack(
        [_scalar_products_of_rows(trace, trace), _scalar_products_of_rows(whole, whole)], axis=-1
    )
    by_strains = by_strains.reshape(count, 2, A, 2, A, 2).transpose(0, 2, 4, 5, 1, 3)
    by_slopes = _scalar_products_of_rows(
        gradient.reshape(count, 2 * B, -1), gradient.reshape(count, 2 * B, -1)
    )
    by_slopes = by_slopes.reshape(count, 2, B, 2, B).transpose(0, 2, 4, 1, 3)
    traces_times_z_values = (
        _scalar_products_of_rows(trace, value).reshape(count, 2, A, B).transpose(0, 2, 3, 1)
    )
    moved_slopes = _scalar_products_of_rows(moved, gradient.reshape(count, 2 * B, -1))
    moved_slopes = moved_slopes.reshape(count, A, 2, B).transpose(0, 1, 3, 2)
    return AngularFactorsOfSectionIntegrals(
        strains=np.ascontiguousarray(by_strains).reshape(count, A * A, 8),
        values=_scalar_products_of_rows(moved, moved).reshape(count, A * A, 1),
        traces_times_z_values=np.ascontiguousarray(traces_times_z_values).reshape(count, A * B, 2),
        values_times_z_slopes=np.ascontiguousarray(moved_slopes).reshape(count, A * B, 2),
        z_value_products=_scalar_products_of_rows(value, value).reshape(count, B * B, 1),
        z_slope_products=np.ascontiguousarray(by_slopes).reshape(count, B * B, 4),
    )


def _scalar_products_of_rows(left: Floats, right: Floats) -> Floats:
    """The scalar products (c, a, b) of the rows of (c, a, q) with the rows of (c, b, q)."""
    return np.asarray(left @ right.swapaxes(-1, -2))


def cross_section_integrals_between_circles(
    inner: float,
    outer: float,
    lame: LameConstants,
    angular: AngularFactorsOfSectionIntegrals,
    p: int,
    plane: float | None = None,
) -> ElementIntegralsOverShoeSection:
    """The integrals over the elements of all columns in a layer between two circles or planes.

    Parameters
    ----------
    inner, outer : radius of the layer's face towards the contact, and radius of its other face [m]
    lame : Lame constants of the layer
    angular : angular factors of the columns
    p : degree of the hp elements
    plane : on a plane the length [m] by which positions are divided; None on a drum
    """
    functions, (lam, mu) = nodal_functions_along_element_column(p), lame
    step = outer - inner
    size = abs(step)
    r = inner + step * functions.x if plane is None else np.full_like(functions.x, plane)
    weights, values, slopes = functions.weights, functions.values, functions.slopes
    # The first two rows are the radial functions of the two terms of the gradients, and the third
    # row is the radial function of displacements. Each function contains the square root of the
    # Gauss weights.
    radial = np.array(
        [
            values * np.sqrt(size * weights / r),
            slopes * np.sqrt(weights * r / size) * np.sign(step),
            values * np.sqrt(size * weights * r),
        ]
    )
    n = p + 1
    B = np.einsum("kiq,ljq->klij", radial, radial).reshape(3, 3, n * n)
    twice = B[:2, :2].reshape(4, -1)
    count = len(angular.values)

    def integrals_from_angular_and_radial_factors(factors: Floats, own: Floats) -> Floats:
        """The integrals (c, a b, n n) as sums of products of angular and radial factors.

        `factors` (c, a b, k) are the angular factors for a times b pairs of unknowns along a row,
        and `own` (k, n n) are the radial factors for n times n pairs of rows.
        """
        return np.asarray(factors @ own)

    found = [
        integrals_from_angular_and_radial_factors(
            angular.strains, np.concatenate([lam * twice, mu * twice])
        ),
        integrals_from_angular_and_radial_factors(angular.values, mu * B[2, 2][None]),
        integrals_from_angular_and_radial_factors(angular.traces_times_z_values, lam * B[:2, 2]),
        integrals_from_angular_and_radial_factors(angular.values_times_z_slopes, mu * B[2, :2]),
        integrals_from_angular_and_radial_factors(
            angular.z_value_products, (lam + 2 * mu) * B[2, 2][None]
        ),
        integrals_from_angular_and_radial_factors(angular.z_slope_products, mu * twice),
    ]
    b = round(np.sqrt(angular.z_value_products.shape[1]))
    a = angular.values_times_z_slopes.shape[1] // b
    shapes = [(a, a), (a, a), (a, b), (a, b), (b, b), (b, b)]
    each = [own.reshape(count, *shape, n, n) for own, shape in zip(found, shapes, strict=True)]
    return ElementIntegralsOverShoeSection(*each)


def cross_section_integrals_of_any_shape(
    xy: Floats, lame: LameConstants, p: int
) -> ElementIntegralsOverShoeSection:
    """The integrals over c elements of any shape, for displacements in the shoe's frame.

    Along a row the unknowns are the displacements of its nodes; x and y of a node are neighbours.

    Parameters
    ----------
    xy : (c, 2, a) coordinates of each element's nodes, in the order of `ReferenceElement` [m]
    lame : Lame constants of the layer
    p : degree of the hp elements
    """
    (lam, mu), reference, n = lame, reference_element_of_degree(p), p + 1
    G, areas = shape_function_gradients_and_gauss_areas(xy, p)  # (c, 2, a, q), (c, q)
    count = len(xy)
    order = np.argsort(reference.order)
    root = np.sqrt(areas)[:, None]
    # The nodes are sorted into a grid: the first index is the number of the row, and the second
    # index is the position along the row.
    G = (G * root[:, None])[:, :, order]
    value = (reference.values * root)[:, order]
    flat = G.reshape(count, 2 * n * n, -1)
    H = _scalar_products_of_rows(flat, flat).reshape(
        count, 2, n, n, 2, n, n
    )  # c, x or y, row, along, ...
    mixed = _scalar_products_of_rows(flat, value).reshape(count, 2, n, n, n, n)
    mass = _scalar_products_of_rows(value, value).reshape(count, n, n, n, n)
    stretch = H[:, 0, :, :, 0] + H[:, 1, :, :, 1]

    plane = lam * H + mu * H.transpose(0, 4, 2, 3, 1, 5, 6)
    shear = np.zeros_like(H)
    for i in range(2):
        plane[:, i, :, :, i] += mu * stretch
        shear[:, i, :, :, i] = mu * mass
    # The axes (x or y, row, along) of a first and a second node are reordered to (along, x or y) of
    # the first, (along, x or y) of the second, row of the first, row of the second node.
    to_plane, to_mixed, to_z = (0, 3, 1, 6, 4, 2, 5), (0, 3, 1, 5, 2, 4), (0, 2, 4, 1, 3)
    by_nodes = 2 * n, n, n, n
    swapped = mixed.transpose(0, 1, 4, 5, 2, 3)
    traces, values = (lam * mixed).transpose(to_mixed), (mu * swapped).transpose(to_mixed)
    return ElementIntegralsOverShoeSection(
        plane=plane.transpose(to_plane).reshape(count, 2 * n, 2 * n, n, n),
        shear=shear.transpose(to_plane).reshape(count, 2 * n, 2 * n, n, n),
        integrals_of_trace_times_z_value=traces.reshape(count, *by_nodes),
        integrals_of_value_times_z_slope=values.reshape(count, *by_nodes),
        across=((lam + 2 * mu) * mass).transpose(to_z),
        integrals_of_z_slope_products=(mu * stretch).transpose(to_z),
    )
