"""The stiffness of element columns on an arc or a pad, by symmetric and antisymmetric motions.

An element column is a stack of elements from the contact through the thickness of a body. An
element between two concentric circles is mapped from the unit square by a product, x = r(eta)
c(xi): xi runs along the arc and eta through the thickness. Here c(xi) is the polynomial through
nodes on the unit circle. The stiffness of an element is therefore a sum of products, too. Each
product has a factor A, which depends on the angle of the column alone, and a factor B, which
depends on the radii of the layer's two faces alone:

    K         = sum_kl (lambda A_kl + 2 mu A'_kl) B_kl
    grad psi  = t f'(xi) g(eta) / r + n f(xi) g'(eta) / (r_2 - r_1)

The shape function is psi = f g, and k and l = 1, 2 count the two terms of its gradient. The vectors
t (along the arc) and n (across the arc) are functions of xi alone. On a plane the radius r is a
constant, and n is the plane's normal. An orthotropic layer adds stiffness of the same form (see
fem.substructure.elasticity), a A''_kl B_kl + b A'''_kl B_kl, because its directions, too, are
functions of xi alone.

A column is symmetric about the radius through its middle. Its displacements are the sum of
symmetric displacements (radial components even about the middle, tangential components odd) and of
antisymmetric displacements. Symmetric forces do no work on antisymmetric displacements, and vice
versa. The stiffness is therefore computed for each kind on its own, with half the unknowns.
"""

from functools import cache
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.fem.hp.columns import (
    condensed_element_column_stiffness,
    numbering_of_element_column_unknowns,
)
from drumlin.fem.hp.element import (
    gauss_points_and_weights_on_0_to_1,
    points_of_square_tensor_grid,
    replace_matrices_by_schur_complements,
    shape_function_values_and_slopes,
)
from drumlin.fem.substructure.elasticity import isotropic_and_orthotropic_elastic_constants


class NodalFunctionsAtGaussPoints(NamedTuple):
    """The q Gauss points and p + 1 nodal functions of degree p along an element column.

    A column is symmetric about its middle, so that the displacements of each pair of mirrored nodes
    are sums of two symmetric and two antisymmetric unknowns. The components x and y of a node stand
    next to each other in all vectors of displacements and forces.

    Attributes
    ----------
    x, weights : (q,) Gauss points of [0, 1] and their weights
    values, slopes : (p + 1, q) values and derivatives of the nodal functions at the Gauss points
    signs_in_symmetric_unknowns : (2, 2 (p + 1)) sign of each nodal displacement if its symmetric
        unknown is 1, and if its antisymmetric unknown is 1
    symmetric_unknown_numbers : (2 (p + 1),) number of the symmetric unknown, 0 to p, that each
        nodal displacement belongs to; the pair of end nodes comes first, and the next inner pairs
        follow
    matrices_to_symmetric_forces : (2, p + 1, 2 (p + 1)) matrices that turn forces on nodes into
        forces on the symmetric and on the antisymmetric unknowns
    boundary_block_indices, inner_by_boundary_block_indices, inner_block_indices : index arrays that
        pick three blocks out of an element's stiffness: boundary by boundary unknowns, inner by
        boundary unknowns, and inner by inner unknowns. The indexed stiffness is flattened from the
        axes (along, along, across, across) the column.
    """

    x: Floats
    weights: Floats
    values: Floats
    slopes: Floats
    signs_in_symmetric_unknowns: Floats
    symmetric_unknown_numbers: Ints
    matrices_to_symmetric_forces: Floats
    boundary_block_indices: Ints
    inner_by_boundary_block_indices: Ints
    inner_block_indices: Ints


@cache
def nodal_functions_along_element_column(p: int) -> NodalFunctionsAtGaussPoints:
    """The nodal functions of degree p along an element column, and their symmetric unknowns.

    They follow from the shape functions of scikit-fem's quadrilateral: summed over all nodes across
    the column, these functions are the nodal functions along the column.
    """
    n = p + 1
    x, weights = gauss_points_and_weights_on_0_to_1(p)
    value, slope = shape_function_values_and_slopes(p, points_of_square_tensor_grid(x))
    # The sum of an element's shape functions over the nodes across the column is the nodal function
    # along the column. The sum has the same value at all Gauss points across the column, so that
    # the first of these values is taken.
    values = value.reshape(n, n, n, n).sum(axis=0)[:, 0]
    slopes = slope[:, 1].reshape(n, n, n, n).sum(axis=0)[:, 0]
    node = np.repeat(np.arange(n), 2)
    place = 2 * np.minimum(node, p - node) + np.tile([0, 1], n)
    sign = np.ones((2, n, 2))
    sign[0, n // 2 :, 1] = sign[1, n // 2 :, 0] = -1.0
    # An edge of even degree has a node in the middle of the column. This node moves along the
    # radius in symmetric displacements, and around the drum in antisymmetric ones.
    if p % 2 == 0:
        sign[:, p // 2] = np.eye(2)
        place[p : p + 2] = p
    # The force on a symmetric unknown is the mean of the forces on both mirrored nodes.
    fold = np.zeros((2, n, 2 * n))
    fold[:, place, np.arange(2 * n)] = sign.reshape(2, -1)
    fold /= np.abs(fold).sum(axis=2, keepdims=True)
    return NodalFunctionsAtGaussPoints(
        x,
        weights,
        values,
        slopes,
        sign.reshape(2, -1),
        place,
        fold,
        *_index_arrays_of_element_stiffness_blocks(p),
    )


def _index_arrays_of_element_stiffness_blocks(p: int) -> tuple[Ints, Ints, Ints]:
    """Index arrays that pick three blocks out of the stiffness of an element of degree p.

    The blocks are boundary by boundary, inner by boundary and inner by inner unknowns: the
    attributes `boundary_block_indices`, `inner_by_boundary_block_indices` and `inner_block_indices`
    of `NodalFunctionsAtGaussPoints`.
    """
    # Each unknown of an element has a number along the column and a number across the column. The
    # unknowns are ordered: first those on the element's two sides, then those on its first and its
    # last edge, then those inside the element.
    n = p + 1
    further = np.arange(2, n)
    outer_along = np.concatenate([np.tile([0, 1], n), further, further])
    outer_across = np.repeat([*range(n), 0, p], [2] * n + [p - 1] * 2)
    outer = outer_along, outer_across
    inner = np.tile(further, p - 1), np.repeat(np.arange(1, p), p - 1)

    def index_array_of_stiffness_block(rows: tuple[Ints, Ints], columns: tuple[Ints, Ints]) -> Ints:
        """Indices (rows, columns) of a block's entries in an element's flattened stiffness.

        The block's rows and columns are unknowns, given by their numbers along and across the
        element column.
        """
        along, across = rows[0][:, None], rows[1][:, None]
        return np.asarray(((along * n + columns[0]) * n + across) * n + columns[1])

    return (
        index_array_of_stiffness_block(outer, outer),
        index_array_of_stiffness_block(inner, outer),
        index_array_of_stiffness_block(inner, inner),
    )


def _split_forces_into_symmetric_and_antisymmetric(V: Floats, p: int) -> Floats:
    """The forces (2, ..., p + 1, m) on the symmetric and the antisymmetric unknowns of a column.

    The element column is symmetric about its middle. V (..., 2 (p + 1), m) are the forces on its
    nodes, with x and y of a node next to each other, and p is the degree of the elements.
    """
    fold = nodal_functions_along_element_column(p).matrices_to_symmetric_forces
    return np.asarray(fold.reshape(2, *(1,) * (V.ndim - 2), *fold.shape[1:]) @ V)


def circle_points_and_slopes_at_gauss_points(
    angles: Floats, p: int, *, flat: bool
) -> tuple[Floats, Floats]:
    """The points of the unit circle at the Gauss points of c element columns, and their slopes.

    In each column the circle is replaced by the polynomial through the column's nodes on it. On a
    plane the line x = 1 takes the place of the circle.

    Parameters
    ----------
    angles : (c, p + 1) angles of each column's nodes from its middle [rad]; on a plane distances,
        divided by the length [m] that makes positions on the plane dimensionless
    p : degree of the elements
    flat : whether the columns are on a plane

    Returns
    -------
    the points (2, c, q), and their derivatives (2, c, q) by the coordinate xi along the column
    """
    functions = nodal_functions_along_element_column(p)
    if flat:
        slope = angles @ functions.slopes
        one, zero = np.ones_like(slope), np.zeros_like(slope)
        return np.array([one, zero]), np.array([zero, slope])
    circle = np.array([np.cos(angles), np.sin(angles)])
    return circle @ functions.values, circle @ functions.slopes


def angular_factors_of_column_stiffness(
    angles: Floats, p: int, *, flat: bool = False, directed: bool = False
) -> Floats:
    """The integrals along element columns, which are the angular factors of their stiffness.

    The integrals are the factors A_kl and 2 A'_kl (2, c, (p + 1)^2, 8) of the formula for the
    stiffness in the module's docstring. The first axis counts the symmetric and the antisymmetric
    displacements of the c columns.

    Parameters
    ----------
    angles : (c, p + 1) angles of each column's nodes from its middle [rad]; on a plane distances,
        divided by the length [m] that makes positions on the plane dimensionless
    p : degree of the elements
    flat : whether the columns are on a plane
    directed : whether the factors A''_kl and A'''_kl for orthotropic layers are appended; the
        result then is (2, c, (p + 1)^2, 16)
    """
    count, n = angles.shape
    at, by = circle_points_and_slopes_at_gauss_points(angles, p, flat=flat)
    strain = _strains_due_to_unit_displacements_of_columns(
        angles, at, by, p, flat=flat
    )  # (2 c, k a, 3, q)
    trace = strain[:, :, 0] + strain[:, :, 1]
    whole = np.sqrt(2) * strain.reshape(2 * count, 2 * n, -1)
    parts = [trace, whole]
    if directed:
        # x and y (2 c, 1, q) are the components of the unit vector through the layers.
        x, y = np.tile(at / np.hypot(*at), (1, 2, 1))[:, :, None]
        xx, yy, xy = strain[:, :, 0], strain[:, :, 1], strain[:, :, 2]
        through = x**2 * xx + y**2 * yy + np.sqrt(2) * x * y * xy
        parts += [trace - through, through]
    # Each factor is the integral of a strain component by one unit displacement, times the same
    # component by another unit displacement.
    factors = np.empty((2 * count, n, n, len(parts), 2, 2))
    for k, each in enumerate(parts):
        work = (each @ each.swapaxes(1, 2)).reshape(-1, 2, n, 2, n)
        factors[:, :, :, k] = work.transpose(0, 2, 4, 1, 3)
    return factors.reshape(2, count, n * n, 4 * len(parts))


def _strains_due_to_unit_displacements_of_columns(
    angles: Floats, at: Floats, by: Floats, p: int, *, flat: bool
) -> Floats:
    """The strains xx, yy and sqrt(2) xy due to unit displacements of element columns.

    The result is (2 c, 2 (p + 1), 3, q). The first axis counts all c columns with symmetric
    displacements, then with antisymmetric ones. The second axis counts the two terms of the
    gradient, and for each the p + 1 unknowns. The strains are multiplied with the root of the
    quadrature weights, so that the sum of products of two strains over the q Gauss points is an
    integral.

    Parameters
    ----------
    angles : (c, p + 1) angles of each column's nodes from its middle [rad]; on a plane distances,
        divided by the length [m] that makes positions on the plane dimensionless
    at, by : (2, c, q) points of the unit circle (or the plane), and their derivatives by xi
    p : degree of the elements
    flat : whether the columns are on a plane
    """
    functions, (count, n) = nodal_functions_along_element_column(p), angles.shape
    root = np.sqrt(functions.weights / (at[0] * by[1] - at[1] * by[0]))
    tangent, normal = np.array([-at[1], at[0]]) * root, np.array([by[1], -by[0]]) * root
    gradient = np.empty((2, count, 2, n, len(functions.x)))
    gradient[:, :, 0] = tangent[:, :, None] * functions.slopes
    gradient[:, :, 1] = normal[:, :, None] * functions.values

    # Nodes on a side of a column have their displacements measured along the radius at this side
    # and perpendicular to it. Columns of equal shape then have equal stiffness wherever they lie.
    turn = np.zeros((count, n))
    turn[:, ::p] = 0.0 if flat else angles[:, ::p]
    c, s = np.array([np.cos(turn), np.sin(turn)])[:, :, None, :, None]
    (cx, cy), (sy, sx) = c * gradient, s * gradient[::-1]
    # The axes of `strain` are the column, the term of the gradient, the node, its displacement, the
    # strain xx, yy or sqrt(2) xy, and the Gauss point.
    strain = np.empty((count, 2, n, 2, 3, len(functions.x)))
    strain[..., 0, 0, :], strain[..., 1, 0, :] = cx, -sx
    strain[..., 0, 1, :], strain[..., 1, 1, :] = sy, cy
    strain[..., 0, 2, :] = np.sqrt(0.5) * (cy + sx)
    strain[..., 1, 2, :] = np.sqrt(0.5) * (cx - sy)
    by_symmetry = _split_forces_into_symmetric_and_antisymmetric(
        strain.reshape(count, 2, 2 * n, -1), p
    )
    return by_symmetry.reshape(2 * count, 2 * n, 3, -1)


def _radial_factors_of_layer_stiffness(
    radii: Floats, constants: Floats, p: int, plane: float | None
) -> Floats:
    """The integrals through l layers, times m elastic constants: the radial factors of stiffness.

    The integrals are the factors B_kl (l, 4 m, (p + 1)^2) of the formula for the stiffness in the
    module's docstring.

    Parameters
    ----------
    radii : (l + 1,) radii of the faces of the layers [m]
    constants : (l, m) lambda, mu and, if a layer is orthotropic, a and b [N/m]
    p : degree of the elements
    plane : on a plane, the length [m] that positions along the plane are divided by; None on a drum
    """
    functions = nodal_functions_along_element_column(p)
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
    """The stiffness (l, 2, c, 4 p, 4 p) of elements on an arc, condensed to their boundary.

    There are l layers of c elements. The second axis counts the symmetric and the antisymmetric
    unknowns. The inner unknowns of each element are eliminated. Displacements on the left and the
    right side of an element are measured along the radius at this side and perpendicular to it.

    Parameters
    ----------
    radii : (l + 1,) radii of the faces of the layers [m]
    A : the result of `angular_factors_of_column_stiffness` for the columns; with `directed` if a
        layer is orthotropic
    elasticity : (l, 3, 3) elasticity matrices times the width [N/m]
    p : degree of the elements
    plane : on a plane, the length [m] that positions along the plane are divided by; None on a drum
    """
    functions = nodal_functions_along_element_column(p)
    A = A.reshape(-1, *A.shape[2:])
    constants = isotropic_and_orthotropic_elastic_constants(elasticity)[:, : A.shape[-1] // 4]
    condensed = np.empty((len(constants), len(A), 4 * p, 4 * p))
    for layer, B in enumerate(_radial_factors_of_layer_stiffness(radii, constants, p, plane)):
        K = (A @ B).reshape(len(A), -1)
        outer, mixed, inner = (
            K.take(functions.boundary_block_indices, 1),
            K.take(functions.inner_by_boundary_block_indices, 1),
            K.take(functions.inner_block_indices, 1),
        )
        condensed[layer] = replace_matrices_by_schur_complements(outer, mixed, inner)
    return condensed.reshape(len(constants), 2, -1, 4 * p, 4 * p)


def condensed_arc_column_stiffness(
    parts: Floats, p: int, *, contact: bool, held: bool, loads: Floats | None = None
) -> Floats:
    """The stiffness (c, n, n) of element columns, condensed to their two sides and contact nodes.

    The columns lie on an arc or a flat pad. The unknowns have the order of
    `columns.ColumnSubstructure`.

    Parameters
    ----------
    parts : (l, 2, c, 4 p, 4 p) stiffness of the l elements of each of c columns, as returned by
        `condensed_arc_element_stiffness`
    p : degree of the elements
    contact : whether the edge of the columns at the lining's face is in contact
    held : whether the nodes on the columns' edge farthest from the contact are fixed
    loads : (c, 2 (p + 1), m) unit loads on the edge farthest from the contact; the factors of the
        m loads become extra unknowns
    """
    half = numbering_of_element_column_unknowns(p, len(parts), contact=contact, held=held, sides=1)
    folded = None
    if loads is not None:
        folded = _split_forces_into_symmetric_and_antisymmetric(loads, p).reshape(
            -1, p + 1, loads.shape[-1]
        )
    K = condensed_element_column_stiffness(
        parts.reshape(len(parts), -1, 4 * p, 4 * p), half, folded
    )
    symmetric, antisymmetric = K.reshape(2, -1, *K.shape[1:])
    blocks = _OrderOfElementColumnUnknowns(
        K.shape[-1] - half.number_of_kept_unknowns,
        half.number_of_side_unknowns,
        2 * (p + 1) * contact,
    )
    whole = np.empty((len(symmetric), blocks.number_of_unknowns, blocks.number_of_unknowns))
    _write_stiffness_of_column_sides(whole, symmetric, antisymmetric, blocks)
    if contact:
        _write_stiffness_of_column_contact_nodes(whole, symmetric, antisymmetric, blocks, p)
    return whole


class _OrderOfElementColumnUnknowns(NamedTuple):
    """The order [loads | left side | contact | right side] of the unknowns of an element column.

    The stiffness on symmetric or on antisymmetric unknowns has the order [loads | left side | half
    of the contact].

    Attributes
    ----------
    number_of_load_unknowns, number_of_side_unknowns, number_of_contact_unknowns : number of
        unknowns of the loads, of one side, and of the contact nodes
    """

    number_of_load_unknowns: int
    number_of_side_unknowns: int
    number_of_contact_unknowns: int

    @property
    def number_of_unknowns(self) -> int:
        """Number of all unknowns of an element column: loads, both sides and contact."""
        return (
            self.number_of_load_unknowns
            + 2 * self.number_of_side_unknowns
            + self.number_of_contact_unknowns
        )

    @property
    def slice_of_left_side_unknowns(self) -> slice:
        """The slice of the left side's unknowns among all unknowns of an element column."""
        return slice(
            self.number_of_load_unknowns,
            self.number_of_load_unknowns + self.number_of_side_unknowns,
        )

    @property
    def slice_of_load_and_left_side_unknowns(self) -> slice:
        """The slice of the unknowns of loads and left side among all unknowns of a column."""
        return slice(self.number_of_load_unknowns + self.number_of_side_unknowns)

    @property
    def slice_of_contact_unknowns(self) -> slice:
        """The slice of the contact's unknowns among all unknowns of an element column."""
        return slice(
            self.number_of_load_unknowns + self.number_of_side_unknowns,
            self.number_of_load_unknowns
            + self.number_of_side_unknowns
            + self.number_of_contact_unknowns,
        )

    @property
    def slice_of_right_side_unknowns(self) -> slice:
        """The slice of the right side's unknowns among all unknowns of an element column."""
        return slice(
            self.number_of_load_unknowns
            + self.number_of_side_unknowns
            + self.number_of_contact_unknowns,
            None,
        )

    @property
    def signs_of_mirrored_displacements(self) -> Floats:
        """The factors that mirror displacements of a column's left side to its right side.

        The shape is (number_of_side_unknowns,). Displacements along the radius keep their sign (1),
        and displacements around the drum change it (-1). The two signs alternate.
        """
        mirror = np.ones(self.number_of_side_unknowns)
        mirror[1::2] = -1.0
        return mirror


def _write_stiffness_of_column_sides(
    whole: Floats, symmetric: Floats, antisymmetric: Floats, blocks: _OrderOfElementColumnUnknowns
) -> None:
    """Write the stiffness on the unknowns of loads and of both column sides into `whole`.

    Parameters
    ----------
    whole : (c, n, n) stiffness of c columns, which is changed in place
    symmetric, antisymmetric : (c, m, m) stiffness of the columns on their symmetric and on their
        antisymmetric unknowns
    blocks : order of the unknowns, and how many there are of each kind
    """
    S, A, mirror = symmetric, antisymmetric, blocks.signs_of_mirrored_displacements
    left, lines, right = (
        blocks.slice_of_load_and_left_side_unknowns,
        blocks.slice_of_left_side_unknowns,
        blocks.slice_of_right_side_unknowns,
    )
    np.add(S[:, left, left], A[:, left, left], out=whole[:, left, left])
    # The blocks are written into existing arrays, because new arrays would double the time.
    left_right = whole[:, left, right]
    np.subtract(S[:, left, lines], A[:, left, lines], out=left_right)
    left_right *= mirror
    right_left = whole[:, right, left]
    np.subtract(S[:, lines, left], A[:, lines, left], out=right_left)
    right_left *= mirror[:, None]
    right_right = whole[:, right, right]
    np.multiply(whole[:, lines, lines], mirror, out=right_right)
    right_right *= mirror[:, None]


def _write_stiffness_of_column_contact_nodes(
    whole: Floats,
    symmetric: Floats,
    antisymmetric: Floats,
    blocks: _OrderOfElementColumnUnknowns,
    p: int,
) -> None:
    """Write the stiffness of the contact nodes, and their coupling with both sides, into `whole`.

    Parameters
    ----------
    whole : (c, n, n) stiffness of c columns, which is changed in place
    symmetric, antisymmetric : (c, m, m) stiffness of the columns on their symmetric and on their
        antisymmetric unknowns
    blocks : order of the unknowns, and how many there are of each kind
    p : degree of the elements
    """
    functions = nodal_functions_along_element_column(p)
    left, lines, middle, right = (
        blocks.slice_of_load_and_left_side_unknowns,
        blocks.slice_of_left_side_unknowns,
        blocks.slice_of_contact_unknowns,
        blocks.slice_of_right_side_unknowns,
    )
    (even, odd), place = (
        functions.signs_in_symmetric_unknowns,
        middle.start + functions.symmetric_unknown_numbers,
    )
    S, A = symmetric[:, place] * even[:, None], antisymmetric[:, place] * odd[:, None]
    whole[:, middle, left] = S[:, :, left] + A[:, :, left]
    whole[:, middle, middle] = S[:, :, place] * even + A[:, :, place] * odd
    whole[:, middle, right] = blocks.signs_of_mirrored_displacements * (
        S[:, :, lines] - A[:, :, lines]
    )
    whole[:, left, middle] = whole[:, middle, left].transpose(0, 2, 1)
    whole[:, right, middle] = whole[:, middle, right].transpose(0, 2, 1)
