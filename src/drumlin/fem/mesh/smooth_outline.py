"""Smooth arcs in place of straight element sides, to estimate the error of a polygonal outline.

In a mesh with straight sides each arc of the shoe is a polygon, whose sides are chords of the arc.
The mesh does not show whether the polygon or the arc is meant. The change of the answer with arcs
in place of the chords is therefore counted as an error.
"""

from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.fem.mesh.degree import (
    NodalBasis,
    nodal_basis_of_mesh,
    node_displacements_that_follow_moved_sides,
)
from drumlin.fem.mesh.edges import nodes_along_element_edges
from drumlin.response.resultants import gauss_lobatto_points

LARGEST_NONSINGULAR_CORNER_ANGLE = np.radians(185.0)
"""Largest angle inside a corner of one layer, between free faces, without a singular point.

Stresses are singular at angles above 180 degrees. Angles slightly above 180 degrees are left out,
since the singularity is very weak there.
"""
LARGEST_TURN_BETWEEN_CHORDS_OF_CURVE = np.radians(35.0)
"""Largest angle between the directions of two neighbouring sides that may be chords of one curve.

A larger angle is a corner. In a circle of eleven sides the angle is 33 degrees. Real corners below
the limit count as curves, which makes the stated error larger. The value is a judgement.
"""


class _VerticesBetweenChordsOfCurve(NamedTuple):
    """The vertices of a mesh where two sides of a line meet as chords of one curve.

    A line is the outline of the shoe or an interface of two layers.

    Attributes
    ----------
    before, after : (n,) positions in the list of sides of the two sides that meet
    ends_before : (n,) whether the second corner of the side `before` is at the vertex
    starts_after : (n,) whether the first corner of the side `after` is at the vertex
    curvature : (n,) curvature [1/m] of the circle through the ends of both sides; positive for a
        turn to the left on the way from `before` to `after`
    vertices : (n,) indices of the vertices
    """

    before: Ints
    after: Ints
    ends_before: Ints
    starts_after: Ints
    curvature: Floats
    vertices: Ints


def node_displacements_onto_smooth_outline(basis: NodalBasis) -> Floats:
    """The displacements (2, N) [m] of all nodes by which the chords of curved lines become arcs.

    The lines are the outline of the shoe and the interfaces of its layers. Sides on the contact
    line do not move. The chords are sides of the mesh's elements. If these elements were split into
    triangles, the nodes of the triangles follow the elements.
    """
    if basis.split is not None:
        # The module loads scikit-fem, which takes long, and solves without split elements do
        # without it.
        from drumlin.fem.mesh.splitting import (  # noqa: PLC0415
            node_displacements_that_follow_split_elements,
        )

        moves = node_displacements_onto_smooth_outline(basis.split.shape)
        return node_displacements_that_follow_split_elements(basis, moves)
    facets, kinds = _sides_on_outline_and_interfaces(basis.mesh)
    moving = ~np.isin(facets, basis.mesh.boundaries["contact"])
    facets, kinds = facets[moving], kinds[moving]
    bends = _vertices_between_chords_of_outline_curves(basis.mesh, facets, kinds)
    # The arc that replaces a side has the mean curvature of the bends at the side's two ends.
    total, count = np.zeros(len(facets)), np.zeros(len(facets))
    for side, forward in ((bends.before, bends.ends_before), (bends.after, bends.starts_after)):
        np.add.at(total, side, np.where(forward, bends.curvature, -bends.curvature))
        np.add.at(count, side, 1)
    curvature = total / np.maximum(count, 1)
    xy = basis.doflocs[:, nodes_along_element_edges(basis, facets)]
    chord = xy[:, -1] - xy[:, 0]
    along = 0.5 + 0.5 * gauss_lobatto_points(basis.elem.degree)[:, None]
    # A curve to the left bulges to the right of its chord. The height of a circle's arc over its
    # chord is the root of r^2 - x^2 minus the root of r^2 - length^2 / 4, with the radius r and the
    # distance x from the middle of the chord. `bulge` is this height divided by the chord's length,
    # in a form without a difference of nearly equal numbers.
    angle = curvature * np.hypot(*chord)
    roots = [np.sqrt(1 - (angle * x) ** 2) for x in (along - 0.5, 0.5)]
    bulge = angle * along * (1 - along) / (roots[0] + roots[1])
    arc = xy[:, :1] + along * chord[:, None] + bulge * np.array([chord[1], -chord[0]])[:, None]
    moves = np.where(count > 0, arc - xy, 0.0)
    return node_displacements_that_follow_moved_sides(basis, facets, moves)


def _layer_number_of_each_element(mesh: Any) -> Ints:
    """The number (elements + 1,) of each element's layer, from 1 on; the last entry is 0.

    The last entry stands for the space outside the shoe.
    """
    layer = np.zeros(mesh.nelements + 1, dtype=np.int64)
    for number, members in enumerate(mesh.subdomains.values(), start=1):
        layer[members] = number
    return layer


def _sides_on_outline_and_interfaces(mesh: Any) -> tuple[Ints, Ints]:
    """The sides (m,) on the outline and on interfaces of layers, and the number (m,) of the line.

    Sides between the same two layers have the same number.
    """
    # Beyond the outline scikit-fem gives the element number -1. It selects the last entry of the
    # layer numbers, which is 0.
    both = np.sort(_layer_number_of_each_element(mesh)[mesh.f2t], axis=0)
    facets = np.flatnonzero(both[0] != both[1])
    return facets, both[0, facets] * (len(mesh.subdomains) + 1) + both[1, facets]


def _vertices_between_chords_of_outline_curves(
    mesh: Any, facets: Ints, kinds: Ints
) -> _VerticesBetweenChordsOfCurve:
    """The vertices at which exactly two sides of a line meet at a small angle, called bends.

    Parameters
    ----------
    mesh : scikit-fem's mesh
    facets : (m,) indices of the sides
    kinds : (m,) number of the line of each side
    """
    ends = mesh.facets[:, facets]
    vertex = ends.ravel()
    side = np.tile(np.arange(len(facets)), 2)
    # The sides are sorted by vertex and line, so that two sides that meet are neighbours.
    key = vertex * (kinds.max(initial=0) + 1) + np.tile(kinds, 2)
    order = np.argsort(key, kind="stable")
    _, first, count = np.unique(key[order], return_index=True, return_counts=True)
    pair = first[count == 2]
    before, after, at = side[order[pair]], side[order[pair + 1]], vertex[order[pair]]
    start = mesh.p[:, ends[:, before].sum(axis=0) - at]
    middle = mesh.p[:, at]
    end = mesh.p[:, ends[:, after].sum(axis=0) - at]
    u, v = middle - start, end - middle
    cross = u[0] * v[1] - u[1] * v[0]
    curvature = 2 * cross / (np.hypot(*u) * np.hypot(*v) * np.hypot(*(u + v)))
    control = _tangent_crossing_points_of_sides(mesh, facets)
    u, v = middle - control[:, before], control[:, after] - middle
    turn = np.arctan2(u[0] * v[1] - u[1] * v[0], (u * v).sum(axis=0))
    found = _VerticesBetweenChordsOfCurve(
        before, after, ends[1, before] == at, ends[0, after] == at, curvature, at
    )
    smooth = np.abs(turn) <= LARGEST_TURN_BETWEEN_CHORDS_OF_CURVE
    return _VerticesBetweenChordsOfCurve(*(values[smooth] for values in found))


def _tangent_crossing_points_of_sides(mesh: Any, facets: Ints) -> Floats:
    """The points (2, m) at which the tangents at both ends of each side meet.

    For a straight side it is the side's middle.
    """
    basis = nodal_basis_of_mesh(mesh)
    xy = basis.doflocs[:, nodes_along_element_edges(basis, facets)]
    chord = (xy[:, 0] + xy[:, -1]) / 2
    return 2 * xy[:, 1] - chord if xy.shape[1] == 3 else chord


def singular_corners_of_mesh(mesh: Any) -> Ints:
    """The vertices (n,) of a shoe's mesh at which stresses are singular under any load.

    They are the ends of the contact line and of the hinge, the re-entrant corners of the outline,
    and the corners and ends of the interfaces of layers.
    """
    facets, kinds = _sides_on_outline_and_interfaces(mesh)
    vertices, sides = np.unique(mesh.facets[:, facets], return_counts=True)
    bends = _vertices_between_chords_of_outline_curves(mesh, facets, kinds)
    corners = np.union1d(vertices[sides > 2], np.setdiff1d(vertices, bends.vertices))
    # Corners of one layer are singular only if they are re-entrant.
    layer = np.broadcast_to(_layer_number_of_each_element(mesh)[:-1], mesh.t.shape)
    lowest = np.full(mesh.nvertices, len(mesh.subdomains))
    highest = np.zeros(mesh.nvertices, dtype=np.int64)
    np.minimum.at(lowest, mesh.t, layer)
    np.maximum.at(highest, mesh.t, layer)
    is_singular = (lowest < highest) | (
        _angles_inside_corners(mesh) > LARGEST_NONSINGULAR_CORNER_ANGLE
    )
    corners = corners[is_singular[corners]]
    for name in ("contact", "hinge"):
        ends, count = np.unique(mesh.facets[:, mesh.boundaries[name]], return_counts=True)
        corners = np.union1d(corners, ends[count == 1])
    return corners


def _angles_inside_corners(mesh: Any) -> Floats:
    """The angle (vertices,) [rad] that elements, taken with straight sides, fill at each vertex."""
    corners = mesh.p[:, mesh.t]
    along, back = (np.roll(corners, shift, axis=1) - corners for shift in (-1, 1))
    cross = along[0] * back[1] - along[1] * back[0]
    angles = np.abs(np.arctan2(cross, (along * back).sum(axis=0)))
    summed = np.bincount(mesh.t.ravel(), angles.ravel(), mesh.nvertices)
    return summed.astype(float, copy=False)
