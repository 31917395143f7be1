"""Elements of a mesh split into triangles that become smaller towards singular points.

Stresses are singular at a few points, where the elements of a mesh file are usually too large.
Triangles near these points are bisected again and again (newest-vertex bisection: Mitchell, ACM
Trans. Math. Softw. 15, 1989). A quadrilateral is first cut into two triangles. The first cut of a
triangle halves its longest side. The neighbour at a halved side is cut as well. The parts of an
element together keep the element's shape: the element's map takes the nodes of the parts from the
reference triangle or square to their positions. Curved sides thus stay as they are, and sides on
the drum stay on the drum.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np
import skfem

from drumlin.base.arrays import Bools, Floats, Ints
from drumlin.base.errors import NoAnswer
from drumlin.fem.mesh.degree import (
    REFERENCE_SQUARE_CORNER_COORDINATES,
    REFERENCE_TRIANGLE_CORNER_COORDINATES,
    LagrangeElement,
    NodalBasis,
    nodal_basis_with_given_node_positions,
)
from drumlin.fem.mesh.edges import element_edges_between_vertices_and_missing_count

LARGEST_SIDE_OVER_SINGULAR_POINT_DISTANCE = 1.0
"""Largest side of a triangle relative to its distance from a singular point.

The smallest triangles are at the point itself, see `LargestSidesAtSingularPoints`. A smaller number
makes more triangles. The value is a judgement: hp elements that grow by a factor of 2 to 3 are near
the best (Gui & Babuska, Numer. Math. 49, 1986).
"""
EQUAL_MESH_LENGTH_TOLERANCE = 1e-9
"""Relative difference of two lengths in a mesh that counts as zero.

Units and frames of a file change lengths by round-off, and must not change which side is longer.
"""


class LargestSidesAtSingularPoints(NamedTuple):
    """Singular points, and the largest side that a triangle at each point may have.

    `xy` (2, k) are the points and `sides` (k,) the lengths of the sides, both in m.
    """

    xy: Floats
    sides: Floats


@dataclass(frozen=True)
class TrianglesOfSplitElements:
    """The triangles into which the elements of a mesh are split.

    Attributes
    ----------
    t : (m, 3) vertices of each triangle; the first two end the side that is bisected next
    parent : (m,) element of the mesh that each triangle is a part of
    at : (m, 3, 2) corners of each triangle in the reference triangle or square of its parent
    xy : (2, n) positions of the vertices [m]
    lines : vertices (k, 2) at both ends of each side of the named groups, by the group's name
    """

    t: Ints
    parent: Ints
    at: Floats
    xy: Floats
    lines: Mapping[str, Ints]


class SplitElements(NamedTuple):
    """The elements that were split into triangles, and the place of each triangle in its element.

    Attributes
    ----------
    shape : basis on the elements before the split, which gives their shape
    parent : (m,) element that each triangle is a part of
    at : (m, 3, 2) corners of each triangle in the reference triangle or square of its parent
    """

    shape: NodalBasis
    parent: Ints
    at: Floats


def split_mesh_into_triangles_towards_points(
    shape: NodalBasis, finest: LargestSidesAtSingularPoints, most: int
) -> TrianglesOfSplitElements | None:
    """The triangles that a mesh is split into, small at singular points; None without a split.

    The mesh is not split if no side is too long for its distance from the singular points.

    Parameters
    ----------
    shape : basis of any degree on the mesh, which gives the shape of the elements
    finest : singular points, and the longest side that a triangle may have at each of them
    most : largest number of triangles

    Raises
    ------
    NoAnswer
        if more triangles are needed
    """
    parts = _triangles_of_unsplit_mesh(shape.mesh)
    marked = _which_triangles_have_too_long_side(parts.t, parts.xy, finest)
    if not marked.any():
        return None
    while marked.any():
        parts, unchanged = _bisect_marked_and_touched_triangles(shape, parts, marked)
        if len(parts.t) > most:
            raise NoAnswer(f"its mesh would be split into more than {most} triangles")
        # The unchanged triangles are small enough, and come first.
        marked = np.zeros(len(parts.t), dtype=bool)
        marked[unchanged:] = _which_triangles_have_too_long_side(
            parts.t[unchanged:], parts.xy, finest
        )
    return parts


def _triangles_of_unsplit_mesh(mesh: Any) -> TrianglesOfSplitElements:
    """The elements of a mesh as triangles; quadrilaterals are cut along their shorter diagonal."""
    t, corners = mesh.t.T, REFERENCE_TRIANGLE_CORNER_COORDINATES
    parent = np.arange(len(t))
    rows = np.array([[0, 1, 2]])
    if t.shape[1] == 4:
        corners = REFERENCE_SQUARE_CORNER_COORDINATES
        a, b, c, d = mesh.p[:, mesh.t].transpose(1, 0, 2)
        first_diagonal = np.hypot(*(a - c)) <= (1 + EQUAL_MESH_LENGTH_TOLERANCE) * np.hypot(
            *(b - d)
        )
        halves = np.array([[[0, 1, 2], [0, 2, 3]], [[0, 1, 3], [1, 2, 3]]])
        rows = halves[np.where(first_diagonal, 0, 1)].reshape(-1, 3)
        parent = np.repeat(parent, 2)
    rows = np.broadcast_to(rows, (len(parent), 3))
    t = np.take_along_axis(t[parent], rows, axis=1)
    # The vertices of each triangle are shifted so that the first two end the longest side.
    length = np.hypot(*(mesh.p[:, np.roll(t, -1, axis=1)] - mesh.p[:, t]))
    longest = length.max(axis=1, keepdims=True)
    first = np.argmax(length > (1 - EQUAL_MESH_LENGTH_TOLERANCE) * longest, axis=1)
    turned = (first[:, None] + np.arange(3)) % 3
    t = np.take_along_axis(t, turned, axis=1)
    at = corners[np.take_along_axis(rows, turned, axis=1)]
    lines = {name: mesh.facets[:, facets].T for name, facets in mesh.boundaries.items()}
    return TrianglesOfSplitElements(t, parent, at, mesh.p[:, : mesh.nvertices], lines)


def _which_triangles_have_too_long_side(
    t: Ints, xy: Floats, finest: LargestSidesAtSingularPoints
) -> Bools:
    """A mask (m,): True for a triangle with a side too long for its distance to a singular point.

    Parameters
    ----------
    t : (m, 3) vertices of each triangle
    xy : (2, n) positions of the vertices [m]
    finest : singular points, and the longest side that is allowed at each of them
    """
    start = xy[:, t]
    along = xy[:, np.roll(t, -1, axis=1)] - start
    length = np.hypot(*along)
    longest = length.max(axis=1)
    centre = start.mean(axis=2)
    found = np.zeros(len(t), dtype=bool)
    for point, side in zip(finest.xy.T, finest.sides, strict=True):
        # No point of a triangle is farther from its centre than its longest side. Triangles that
        # are small enough for this least distance are not looked at more closely.
        least_distance = np.hypot(*(point[:, None] - centre)) - longest
        near = np.flatnonzero(
            longest > np.maximum(side, LARGEST_SIDE_OVER_SINGULAR_POINT_DISTANCE * least_distance)
        )
        to = point[:, None, None] - start[:, near]
        share = np.clip((to * along[:, near]).sum(axis=0) / length[near] ** 2, 0, 1)
        distance = np.hypot(*(to - share * along[:, near])).min(axis=1)
        limit = np.maximum(side, LARGEST_SIDE_OVER_SINGULAR_POINT_DISTANCE * distance)
        found[near] |= longest[near] > (1 + EQUAL_MESH_LENGTH_TOLERANCE) * limit
    return found


def _bisect_marked_and_touched_triangles(
    shape: NodalBasis, parts: TrianglesOfSplitElements, marked: Bools
) -> tuple[TrianglesOfSplitElements, int]:
    """Bisect the marked triangles and all triangles that a new vertex touches.

    Returns all parts, and the number of unchanged triangles, which come first among them. `marked`
    (m,) is True for the triangles that have to be bisected.
    """
    count = parts.xy.shape[1]
    unique_number_of_each_side = partial(_unique_number_of_each_side, count=count)
    marked, halved = _triangles_to_bisect_and_halved_sides(parts, marked)
    xy = np.hstack([parts.xy, np.empty((2, len(halved)))])
    lines = {}
    for name, line in parts.lines.items():
        number = unique_number_of_each_side(line)
        is_halved = _which_values_are_in_sorted_array(number, halved)
        middle = count + np.searchsorted(halved, number[is_halved])
        a, b = line[is_halved].T
        new = [np.column_stack([a, middle]), np.column_stack([middle, b])]
        lines[name] = np.concatenate([line[~is_halved], *new])
    t, parent, at = parts.t[marked], parts.parent[marked], parts.at[marked]
    while True:
        # A side that ends at a new vertex is not bisected in this round.
        is_old = (t[:, :2] < count).all(axis=1)
        number = unique_number_of_each_side(t[:, :2])
        split = is_old & _which_values_are_in_sorted_array(number, halved)
        if not split.any():
            break
        (a, b, c), (pa, pb, pc) = t[split].T, at[split].transpose(1, 0, 2)
        middle = count + np.searchsorted(halved, unique_number_of_each_side(t[split, :2]))
        pm = (pa + pb) / 2
        xy[:, middle] = shape.positions_of_points_in_elements(parent[split], pm[:, None])[:, :, 0]
        new_t = [np.column_stack([c, a, middle]), np.column_stack([b, c, middle])]
        new_at = [np.stack([pc, pa, pm], axis=1), np.stack([pb, pc, pm], axis=1)]
        t = np.concatenate([t[~split], *new_t])
        at = np.concatenate([at[~split], *new_at])
        parent = np.concatenate([parent[~split], parent[split], parent[split]])
    found = TrianglesOfSplitElements(
        np.concatenate([parts.t[~marked], t]),
        np.concatenate([parts.parent[~marked], parent]),
        np.concatenate([parts.at[~marked], at]),
        xy,
        lines,
    )
    return found, int(np.count_nonzero(~marked))


def _unique_number_of_each_side(ends: Ints, count: int) -> Ints:
    """A number (...) for each side, equal for equal pairs of vertices.

    `ends` (..., 2) has the pairs of vertices, in any order, and `count` is the number of vertices.
    """
    a, b = ends[..., 0], ends[..., 1]
    return np.asarray(np.minimum(a, b) * count + np.maximum(a, b))


def _triangles_to_bisect_and_halved_sides(
    parts: TrianglesOfSplitElements, marked: Bools
) -> tuple[Bools, Ints]:
    """The triangles (m,) that have to be bisected with the marked ones, and the sides halved there.

    A triangle with a halved side is first bisected across the side of its first two vertices. The
    sides are sorted numbers of `_unique_number_of_each_side`.
    """
    count = parts.xy.shape[1]
    while True:
        ends = parts.t[marked, :2]
        halved = np.unique(_unique_number_of_each_side(ends, count))
        # Only a triangle with two vertices at ends of halved sides can have such a side itself.
        is_end = np.zeros(count, dtype=bool)
        is_end[ends] = True
        near = np.flatnonzero(is_end[parts.t].sum(axis=1) >= 2)
        t = parts.t[near]
        sides = _unique_number_of_each_side(np.stack([t, np.roll(t, -1, axis=1)], axis=-1), count)
        touched = np.zeros(len(marked), dtype=bool)
        touched[near] = _which_values_are_in_sorted_array(sides, halved).any(axis=1)
        if (touched <= marked).all():
            return marked, halved
        marked = touched


def _which_values_are_in_sorted_array(values: Ints, members: Ints) -> Bools:
    """A mask with the shape of `values`: True for a value in the sorted array `members` (m,).

    Few sides of a mesh are halved at once. numpy's isin would sort the numbers of all sides.
    """
    if not len(members):
        return np.zeros(values.shape, dtype=bool)
    place = np.minimum(np.searchsorted(members, values), len(members) - 1)
    return np.asarray(members[place] == values)


def nodal_basis_on_split_triangles(
    shape: NodalBasis, parts: TrianglesOfSplitElements, degree: int
) -> NodalBasis:
    """The basis of the given degree on the triangles into which a mesh's elements are split.

    `shape` is a basis on the elements before the split. It gives the places of the nodes, so that
    the triangles keep the shape of the elements.
    """
    # scikit-fem sorts the vertices of linear triangles, and their reference points must follow.
    order = np.argsort(parts.t, axis=1)
    t = np.take_along_axis(parts.t, order, axis=1)
    at = np.take_along_axis(parts.at, order[:, :, None], axis=1)
    elem = LagrangeElement(degree, 3)
    places = _positions_of_nodes_in_triangles(shape, parts.parent, at, elem)
    groups = {
        name: np.flatnonzero(np.isin(parts.parent, members))
        for name, members in shape.mesh.subdomains.items()
    }
    # The mesh numbers its sides once, which takes long. So it gets the dictionary of its boundaries
    # before the sides are looked up.
    boundaries: dict[str, Ints] = {}
    mesh = skfem.MeshTri1(
        np.ascontiguousarray(parts.xy),
        np.ascontiguousarray(t.T),
        _subdomains=groups,
        _boundaries=boundaries,
    )
    for name, line in parts.lines.items():
        boundaries[name] = element_edges_between_vertices_and_missing_count(mesh, line)[0]
    basis = nodal_basis_with_given_node_positions(mesh, elem, places)
    return replace(basis, split=SplitElements(shape, parts.parent, at))


def _positions_of_nodes_in_triangles(
    shape: NodalBasis, parent: Ints, at: Floats, elem: LagrangeElement
) -> Floats:
    """The positions (2, m, nodes) [m] of the nodes of triangles that are parts of elements.

    Parameters
    ----------
    shape : basis on the elements, which gives their shape
    parent : (m,) element that each triangle is a part of
    at : (m, 3, 2) corners of each triangle in the reference triangle or square of its parent
    elem : the triangle with its nodes
    """
    # Elements that were not split are whole triangles, all of which have their nodes at the same
    # few places in the reference triangle. The shape functions are computed once for each triple of
    # corners.
    triples, which = _distinct_rows_with_number_of_each_row(at.reshape(len(at), -1))
    inside = _barycentric_coordinates_of_nodes(elem) @ triples.reshape(-1, 3, 2)
    shapes = shape.elem.shape_function_values(inside.reshape(-1, 2).T)
    shapes = shapes.reshape(*inside.shape[:2], -1)
    nodes = shape.doflocs[:, shape.element_dofs[:, parent].T]
    return np.asarray((nodes[:, :, None] @ shapes[which].transpose(0, 2, 1))[:, :, 0])


def _distinct_rows_with_number_of_each_row(rows: Floats) -> tuple[Floats, Ints]:
    """The k distinct rows (k, c) of an array `rows` (m, c), and for each row its number (m,) there.

    `numpy.unique` with an axis takes some ten times as long.
    """
    order = np.lexsort(rows.T)
    in_order = rows[order]
    is_new = np.append(True, (in_order[1:] != in_order[:-1]).any(axis=1))
    number = np.empty(len(rows), dtype=np.int64)
    number[order] = np.cumsum(is_new) - 1
    return in_order[is_new], number


def _barycentric_coordinates_of_nodes(elem: LagrangeElement) -> Floats:
    """The barycentric coordinates (nodes, 3) of the nodes of a triangle."""
    x, y = elem.doflocs.T
    return np.column_stack([1 - x - y, x, y])


def node_displacements_that_follow_split_elements(basis: NodalBasis, moves: Floats) -> Floats:
    """The displacements (2, N) [m] of the nodes of triangles that follow their moved elements.

    Parameters
    ----------
    basis : basis on the triangles into which elements are split
    moves : (2, M) displacements [m] of the nodes of the elements before the split, whose basis is
        `basis.split.shape`
    """
    split: SplitElements = basis.split
    is_moved = (np.hypot(*moves) > 0)[split.shape.element_dofs].any(axis=0)
    members = np.flatnonzero(is_moved[split.parent])
    moved = replace(split.shape, doflocs=moves)
    found = np.zeros_like(basis.doflocs)
    found[:, basis.element_dofs[:, members]] = _positions_of_nodes_in_triangles(
        moved, split.parent[members], split.at[members], basis.elem
    ).transpose(0, 2, 1)
    return found
