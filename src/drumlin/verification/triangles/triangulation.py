"""Meshes whose triangles shrink geometrically towards given points of a layered body.

The coordinate s runs along the body and d across its layers: layer j fills j <= d <= j + 1.
Triangles are halved by newest-vertex bisection, which bounds their angles (Mitchell 1989; hanging
nodes are avoided as by Funken, Praetorius & Wissgott 2011), until each triangle is short enough for
its distance from the nearest of the given points.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from drumlin.base.arrays import Bools, Floats, Ints
from drumlin.brake.elasticity import ElasticLayer

FunctionFromBodyCoordinatesToPoints = Callable[[Floats, Floats], Floats]
"""A function that returns the points (..., 2) [m] of a layered body for given s (...) and d (...).

s is the coordinate along the layers. d is the depth: 0 on the friction surface, and larger by 1
behind each layer.
"""
MOST_ROUNDS_OF_TRIANGLE_BISECTION = 200
"""Largest number of rounds of bisection, above which the refinement counts as endless.

Two rounds halve the lengths of the triangles, and the finest meshes need some 26 halvings."""


@dataclass(frozen=True)
class LayerOfTriangulatedBody:
    """One layer of a layered body that triangles mesh.

    Attributes
    ----------
    start, end : first and last coordinate s of the layer
    elastic : elastic constants of the layer, with directions in the brake's frame
    slots : first and last s of each gap in the layer, such as a slot between two linings
    free_strains : (2, 2) free strains of a heated layer: the rows are strains along and through it,
        the columns its near and its far face; None for a layer without heat
    """

    start: float
    end: float
    elastic: ElasticLayer
    slots: tuple[tuple[float, float], ...] = ()
    free_strains: Floats | None = None

    def mask_of_coordinates_with_material(self, s: Floats) -> Bools:
        """Whether the layer has material at each of the coordinates s, as a mask in their shape."""
        there = (s > self.start) & (s < self.end)
        for first, last in self.slots:
            there &= (s < first) | (s > last)
        return there


@dataclass(frozen=True)
class TriangleMeshInBodyCoordinates:
    """A mesh of m triangles in the coordinates s and d of a layered body.

    Attributes
    ----------
    vertices : (m, 3) numbers of the corners; bisection halves the edge between the first two
    at : (m, 3, 2) coordinates s and d of the corners
    layer : (m,) number of the layer in which each triangle lies
    """

    vertices: Ints
    at: Floats
    layer: Ints

    @property
    def indices_of_triangle_edges_on_friction_surface(self) -> tuple[Ints, Ints]:
        """Numbers (k,) of the triangles with an edge on the surface d = 0, and of these edges.

        Edge 0 goes from corner 0 to 1, edge 1 from 1 to 2, edge 2 from 2 to 0.
        """
        on = self.at[:, :, 1] == 0
        tri, edge = np.nonzero(on & np.roll(on, -1, axis=1))
        return tri, edge

    def end_coordinates_of_friction_surface_edges(self) -> Floats:
        """Coordinates s (k, 2) of the ends of each edge on the surface d = 0, the smaller first."""
        tri, edge = self.indices_of_triangle_edges_on_friction_surface
        return np.sort(
            np.stack([self.at[tri, edge, 0], self.at[tri, (edge + 1) % 3, 0]], axis=1), axis=1
        )


def triangulate_grid_of_layered_body(
    s: Floats,
    d: Sequence[Floats],
    layers: Sequence[LayerOfTriangulatedBody],
    period: float | None = None,
) -> TriangleMeshInBodyCoordinates:
    """Mesh a layered body by a grid, each cell of which is cut into two triangles.

    A cell of the grid becomes no triangles if its layer has no material there.

    Parameters
    ----------
    s : (n,) growing coordinates of the grid lines along the body
    d : for each layer, the growing coordinates of its grid lines across
    layers : the layers
    period : for a ring, a full turn in s, after which the last grid line is the first one again;
        None for a body with two ends
    """
    depths = np.unique(np.concatenate(d))
    count = len(s) - (period is not None)
    # Cell (i, j) lies between grid lines i, i + 1 along the body and j, j + 1 across it.
    i = np.repeat(np.arange(len(s) - 1), len(depths) - 1)
    j = np.tile(np.arange(len(depths) - 1), len(s) - 1)
    layer = np.floor(0.5 * (depths[j] + depths[j + 1])).astype(int)
    middle = 0.5 * (s[i] + s[i + 1])
    reaches = np.array([one.mask_of_coordinates_with_material(middle) for one in layers])
    there = reaches[layer, np.arange(len(layer))]
    i, j, layer = i[there], j[there], layer[there]

    def node_numbers_and_coordinates_of_cell_corners(a: int, b: int) -> tuple[Ints, Floats]:
        """Numbers (n,) and coordinates s, d (n, 2) of the corner (i + a, j + b) of all cells."""
        at = np.stack([s[i + a], depths[j + b]], axis=1)
        return ((i + a) % count) * len(depths) + j + b, at

    # Neighbouring cells are cut along opposite diagonals, so that the mesh prefers no direction.
    flip = (i + j) % 2 == 1
    corners = (0, 0), (1, 0), (1, 1), (0, 1)
    quads = [node_numbers_and_coordinates_of_cell_corners(*corner) for corner in corners]
    numbers = np.stack([number for number, _ in quads], axis=1)
    places = np.stack([at for _, at in quads], axis=1)
    numbers[flip], places[flip] = (
        np.roll(numbers[flip], -1, axis=1),
        np.roll(places[flip], -1, axis=1),
    )
    halves = [[2, 0, 1], [0, 2, 3]]
    return TriangleMeshInBodyCoordinates(
        np.concatenate([numbers[:, half] for half in halves]),
        np.concatenate([places[:, half] for half in halves]),
        np.concatenate([layer, layer]),
    )


def edges_of_mesh_and_of_each_triangle(mesh: TriangleMeshInBodyCoordinates) -> tuple[Ints, Ints]:
    """The k edges of a mesh, and the numbers (m, 3) of the edges of each triangle.

    An edge (2,) is given by the numbers of its two ends, the smaller first.
    """
    pairs = np.sort(np.stack([mesh.vertices, np.roll(mesh.vertices, -1, axis=1)], axis=2), axis=2)
    flat = pairs.reshape(-1, 2)
    size = int(mesh.vertices.max()) + 1
    _, first, number = np.unique(
        flat[:, 0] * size + flat[:, 1], return_index=True, return_inverse=True
    )
    return flat[first], number.reshape(-1, 3)


def bisect_marked_triangles_without_hanging_nodes(
    mesh: TriangleMeshInBodyCoordinates, marked: Bools
) -> TriangleMeshInBodyCoordinates:
    """Halve the triangles of a mesh for which `marked` (m,) is true; returns the new mesh.

    More triangles are halved where a new node would otherwise lie inside the edge of a triangle (a
    hanging node).
    """
    edges, of = edges_of_mesh_and_of_each_triangle(mesh)
    halved = np.zeros(len(edges), dtype=bool)
    halved[of[marked, 0]] = True
    # A triangle with any halved edge must have its first edge halved, too.
    while True:
        due = halved[of].any(axis=1) & ~halved[of[:, 0]]
        if not due.any():
            break
        halved[of[due, 0]] = True
    number = np.cumsum(halved) - 1 + int(mesh.vertices.max()) + 1
    # The columns of v and at are the corners 0, 1, 2 and the middles 3, 4, 5 of the edges 01, 12,
    # 20.
    v = np.concatenate([mesh.vertices, number[of]], axis=1)
    at = np.concatenate([mesh.at, 0.5 * (mesh.at + np.roll(mesh.at, -1, axis=1))], axis=1)
    # Which edges of a triangle are halved decides into which smaller triangles it is cut.
    cut = halved[of]
    kinds = [
        (~cut[:, 0], [[0, 1, 2]]),
        (cut[:, 0] & ~cut[:, 1] & ~cut[:, 2], [[2, 0, 3], [1, 2, 3]]),
        (cut[:, 0] & cut[:, 1] & ~cut[:, 2], [[2, 0, 3], [3, 1, 4], [2, 3, 4]]),
        (cut[:, 0] & ~cut[:, 1] & cut[:, 2], [[3, 2, 5], [0, 3, 5], [1, 2, 3]]),
        (cut.all(axis=1), [[3, 2, 5], [0, 3, 5], [3, 1, 4], [2, 3, 4]]),
    ]
    vertices, positions, layers = [], [], []
    for which, smaller_triangles in kinds:
        for corners in smaller_triangles:
            vertices.append(v[which][:, corners])
            positions.append(at[which][:, corners])
            layers.append(mesh.layer[which])
    return TriangleMeshInBodyCoordinates(
        np.concatenate(vertices), np.concatenate(positions), np.concatenate(layers)
    )


def grade_mesh_towards_points(
    mesh: TriangleMeshInBodyCoordinates,
    place: FunctionFromBodyCoordinatesToPoints,
    points: Floats,
    smallest: Floats,
    steep: float,
) -> TriangleMeshInBodyCoordinates:
    """Halve the triangles of a mesh until they are short enough near the given points.

    Parameters
    ----------
    mesh : the mesh to refine
    place : function that returns the points [m] for given s and d
    points : (k, 2) points towards which the triangles shrink [m]
    smallest : (k,) length at each point below which triangles are not halved [m]
    steep : largest length of a triangle, relative to the distance of its centre from a point
    """
    for _ in range(MOST_ROUNDS_OF_TRIANGLE_BISECTION):
        # A triangle is marked if its longest edge exceeds the length allowed at its centre.
        corners = place(mesh.at[..., 0], mesh.at[..., 1])
        size = np.hypot(*np.moveaxis(corners - np.roll(corners, -1, axis=1), 2, 0)).max(axis=1)
        centre = corners.mean(axis=1)
        allowed = np.full(len(size), np.inf)
        for point, least in zip(points, smallest, strict=True):
            distance = np.hypot(*(centre - point).T)
            allowed = np.minimum(allowed, np.maximum(steep * distance, least))
        marked = size > allowed
        if not marked.any():
            return mesh
        mesh = bisect_marked_triangles_without_hanging_nodes(mesh, marked)
    raise AssertionError("the triangulation does not end")


def halve_surface_edges_until_no_break_lies_inside(
    first: TriangleMeshInBodyCoordinates, breaks: Floats, slack: float
) -> TriangleMeshInBodyCoordinates:
    """Halve the edges of a mesh on the surface d = 0 until no break lies inside an edge.

    Breaks are places where edges of an opposite mesh end, so that the edges of both meshes match.

    Parameters
    ----------
    first : the mesh to refine
    breaks : (k,) growing coordinates s of the breaks
    slack : distance in s from an end of an edge within which a break counts as lying on this end
    """
    for _ in range(MOST_ROUNDS_OF_TRIANGLE_BISECTION):
        tri, _ = first.indices_of_triangle_edges_on_friction_surface
        spans = first.end_coordinates_of_friction_surface_edges()
        within = np.searchsorted(breaks, spans[:, 1] - slack) > np.searchsorted(
            breaks, spans[:, 0] + slack
        )
        if not within.any():
            return first
        marked = np.zeros(len(first.layer), dtype=bool)
        marked[tri[within]] = True
        first = bisect_marked_triangles_without_hanging_nodes(first, marked)
    raise AssertionError("the surfaces do not match")


def coordinates_with_position_dependent_spacing(
    breaks: Floats, size: Callable[[float], float]
) -> Floats:
    """Points from the first to the last of the growing `breaks`, about size(x) apart at x.

    Every break is one of the points.
    """
    points = [np.array(breaks[:1])]
    for a, b in pairwise(breaks.tolist()):
        # The integral of 1/size from a to x counts the steps up to x. It is scaled to a whole
        # number at b, and points lie where it is 1, 2, 3 and so on.
        x = np.linspace(a, b, 400)
        density = np.array([1 / size(float(one)) for one in x])
        count = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(x))])
        whole = max(1, int(np.ceil(count[-1] - 1e-9)))
        inner = np.interp(np.arange(1, whole + 1) * count[-1] / whole, count, x)
        inner[-1] = b
        points.append(inner)
    return np.concatenate(points)
