"""The plane cells of a mesh file, converted to elements of one kind.

Cells of third order become cells of second order on the same curves. If a mesh has quadrilaterals
and triangles, all cells become quadratic triangles: each quadrilateral is cut into two triangles,
and linear cells get middle nodes on their straight edges. All cells also become quadratic triangles
if a quadrilateral has a corner of 180 degrees. This quadrilateral has no area in the corner, and
the cut begins at the corner.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from drumlin.base.arrays import Bools, Floats, Ints
from drumlin.base.errors import BadInput
from drumlin.mesh_files.content_of_file import MeshFileContent

CORNERS_PER_PLANE_CELL = {
    "triangle": 3,
    "triangle6": 3,
    "triangle10": 3,
    "quad": 4,
    "quad8": 4,
    "quad9": 4,
    "quad16": 4,
}
"""Number of corners of each type of plane cell that a mesh file may have, by meshio's name."""
SECOND_ORDER_CELL_OF_THIRD_ORDER_CELL = {"triangle10": "triangle6", "quad16": "quad8"}
"""The type of second-order cell that replaces each type of third-order cell, by meshio's names."""
CELL_TYPES_BESIDES_PLANE_CELLS = frozenset(("vertex", "line", "line3", "line4"))
"""Types of cells in a mesh file that are no plane elements: points, and edges in named groups."""
CUBIC_EDGE_MIDDLE_WEIGHTS = (-1 / 16, 9 / 16, 9 / 16, -1 / 16)
"""Weights of a cubic edge's four nodes, from end to end: their weighted sum is the edge's middle.

They are the values of the four cubic shape functions in the middle of the edge.
"""
CIRCULAR_EDGE_RADIUS_TOLERANCE = 0.1
"""Largest change of the distance from the drum's centre along an edge that follows a circle.

The change is relative to the edge's chord. If a third-order edge follows a circle, the middle node
of its second-order edge is put on the circle. On all other edges the middle node is the middle of
the cubic curve. The value is a judgement: edges on circles about the centre are far below it, and
radial edges have the value 1.
"""
FLAT_CORNER = np.radians(1.0)
"""Largest difference of a quadrilateral's corner from 180 degrees at which the corner is flat.

Gmsh makes a quadrilateral with a flat corner from two triangles at a smooth outline: two sides of
the quadrilateral are then parts of one curve. Rounded coordinates change the angle: by 0.06 degrees
on three meshes by Gmsh with coordinates rounded to 0.001 mm. If a corner bends inwards by more than
this difference, the mesh is refused as faulty. The value is a judgement.
"""


@dataclass(frozen=True)
class PlaneCellsOfOneKind:
    """The plane cells of a mesh file, converted to cells of one kind.

    Parameters
    ----------
    cell : meshio's name of the kind
    cells : (m, k) nodes of each cell
    points : (n, 2) coordinates of the nodes: the nodes of the file first, then added nodes
    parts : for each type of cells in the file the indices of the new cells made of each cell of
        this type: (number of cells of the type, 1), or (..., 2) for cells that were cut in two
    added : (n,) whether each node was added
    notes : lines that tell how the cells were changed
    """

    cell: str
    cells: Ints
    points: Floats
    parts: Mapping[str, Ints]
    added: Bools
    notes: tuple[str, ...] = ()

    @property
    def number_of_corners_per_cell(self) -> int:
        """Number of corners of each cell."""
        return CORNERS_PER_PLANE_CELL[self.cell]

    def indices_of_new_cells_made_of_file_cells(self, cell: str, rows: Ints) -> Ints:
        """The indices of the new cells that were made of some cells of the file.

        `cell` is the type of the file's cells, and `rows` are their numbers.
        """
        return np.sort(self.parts[cell][rows].ravel())


def convert_plane_cells_to_one_kind(
    content: MeshFileContent, points: Floats, fault: str, *, on_drum: bool
) -> PlaneCellsOfOneKind:
    """The plane cells of a mesh file, converted to cells of one kind.

    Parameters
    ----------
    content : content of the mesh file
    points : (n, 2) coordinates of its nodes
    fault : beginning of each message
    on_drum : whether the origin of the coordinates is the centre of a drum

    Raises
    ------
    BadInput
        for cells that are not plane, or that have nodes which the file does not define
    """
    kinds = _plane_cells_of_each_type(content, len(points), fault)
    # Cells of third order become cells of second order. If the mesh then has triangles and
    # quadrilaterals, all cells become triangles.
    own = len(points)
    notes: list[str] = []
    if set(kinds) & set(SECOND_ORDER_CELL_OF_THIRD_ORDER_CELL):
        kinds, points = _convert_third_order_cells_and_points_to_second_order(
            kinds, points, fault, on_drum
        )
        notes.append("its elements of third order are solved as elements of second order")
    flat = {name: _flat_corner_of_each_cell(cells, points, name) for name, cells in kinds.items()}
    flat_cells = sum(np.count_nonzero(corner >= 0) for corner in flat.values())
    if len(kinds) > 1 or flat_cells:
        counts = ", ".join(f"{len(cells)} {name}" for name, cells in kinds.items())
        word = "mixed cells" if len(kinds) > 1 else "cells"
        reason = f", {flat_cells} with a corner of 180 degrees" if flat_cells else ""
        cell, (cells, parts, points) = "triangle6", _quadratic_triangles(kinds, points, flat)
        notes.append(
            f"its {word} ({counts}{reason}) are solved as {len(cells)} quadratic triangles"
        )
    else:
        # All cells are of one type. Eight-node quadrilaterals get a node in their centre.
        ((source, cells),) = kinds.items()
        cell = SECOND_ORDER_CELL_OF_THIRD_ORDER_CELL.get(source, source)
        if cell == "quad8":
            cell, cells, points = _add_centre_nodes_to_cells_and_points_of_quadrilaterals(
                cells, points
            )
        parts = {source: np.arange(len(cells))[:, None]}
    _check_cells_share_nodes_consistently(cells, CORNERS_PER_PLANE_CELL[cell], fault)
    added = np.arange(len(points)) >= own
    return PlaneCellsOfOneKind(cell, cells, points, parts, added, tuple(notes))


def _plane_cells_of_each_type(
    content: MeshFileContent, number_of_nodes: int, fault: str
) -> dict[str, Ints]:
    """The plane cells (m, k) of a mesh file by their type.

    BadInput is raised for cells that are not plane, and for cells with nodes that the file does not
    define. Its message begins with `fault`.
    """
    kinds = {
        name: cells
        for name, cells in content.cells.items()
        if name not in CELL_TYPES_BESIDES_PLANE_CELLS and len(cells)
    }
    strange = sorted(set(kinds) - set(CORNERS_PER_PLANE_CELL))
    if strange or not kinds:
        raise BadInput(
            f"{fault}: has cells {strange or sorted(content.cells)}; allowed are triangles and "
            f"quadrilaterals: {', '.join(CORNERS_PER_PLANE_CELL)}"
        )
    for cells in kinds.values():
        if cells.min() < 0 or cells.max() >= number_of_nodes:
            raise BadInput(f"{fault}: has cells with nodes that the file does not define")
    return kinds


def _check_cells_share_nodes_consistently(cells: Ints, corners: int, fault: str) -> None:
    """Refuse cells of a mesh file whose lists of nodes contradict each other.

    A cell may not have a node twice. No node may be a corner of one cell and a middle node of
    another. Cells that share an edge must share its middle node, and cells that share a middle node
    must share its edge.

    Parameters
    ----------
    cells : (m, k) nodes of the cells in meshio's order
    corners : number of corners of a cell
    fault : beginning of each message

    Raises
    ------
    BadInput
        for the first fault that is found
    """
    # meshio's order of nodes is the corners, then the middle nodes of the edges, then the centre.
    ends, middles, centres = np.split(cells, [corners, 2 * corners], axis=1)
    edges = np.sort(np.stack([ends, np.roll(ends, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
    # The two nodes of an edge make one number, which is faster to compare than pairs.
    one_more = int(cells.max()) + 1
    edge = edges[:, 0].astype(np.int64) * one_more + edges[:, 1]
    distinct = [len(np.unique(nodes)) for nodes in (ends, middles, centres)]
    repeated = (np.diff(np.sort(cells, axis=1), axis=1) == 0).any()
    of_two_kinds = sum(distinct) > len(np.unique(cells))
    if repeated or of_two_kinds:
        raise BadInput(
            f"{fault}: has nodes that a cell has twice, "
            "or that are a corner here and inside an edge there"
        )
    # Each edge has its own middle node if three counts are equal: edges, middle nodes, and pairs of
    # an edge and its middle node.
    bonds = {len(np.unique(edge))}
    if middles.size:
        bonds |= {distinct[1], len(np.unique(np.column_stack([edge, middles.ravel()]), axis=0))}
    if len(bonds) > 1 or distinct[2] not in {0, len(cells)}:
        raise BadInput(
            f"{fault}: has cells that share an edge but not its middle node, "
            "or a middle but not the edge"
        )


def _add_centre_nodes_to_cells_and_points_of_quadrilaterals(
    cells: Ints, points: Floats
) -> tuple[str, Ints, Floats]:
    """The kind, cells and points of nine-node quadrilaterals that replace eight-node ones.

    Each cell (m, 8) gets a node in its centre, which is added to the points (n, 2).
    """
    numbers = len(points) + np.arange(len(cells))
    centres = _centres_of_quadrilaterals(points, cells[:, :4], cells[:, 4:8])
    return "quad9", np.column_stack([cells, numbers]), np.vstack([points, centres])


def _centres_of_quadrilaterals(points: Floats, corners: Ints, middles: Ints) -> Floats:
    """The centres (m, 2) of quadrilaterals with given corners (m, 4) and middle nodes (m, 4)."""
    return np.asarray(points[middles].sum(axis=1) / 2 - points[corners].sum(axis=1) / 4)


def _number_of_each_edge(ends: Ints) -> tuple[Ints, Ints]:
    """A number (m,) for each edge, and the position (n,) of the first edge with each number.

    Edges between the same two nodes have the same number, from 0 on. `ends` (m, 2) are the nodes.
    """
    low, high = np.sort(ends, axis=1).T
    key = low * (int(ends.max()) + 1) + high
    _, first, number = np.unique(key, return_index=True, return_inverse=True)
    return number, first


def _convert_third_order_cells_and_points_to_second_order(
    kinds: dict[str, Ints], points: Floats, fault: str, on_drum: bool
) -> tuple[dict[str, Ints], Floats]:
    """The cells of a mesh file with second order in place of third order, and all points.

    `kinds` are the cells (m, k) by their type in the file. The result has the same keys, also for
    the converted cells. The points (n, 2) of the file are followed by new middle nodes of edges.
    BadInput is raised for two cells with different nodes on their common edge; its message begins
    with `fault`.
    """
    # The nodes of each side stand in the order from end to end.
    sides: dict[str, Ints] = {}
    for name in set(kinds) & set(SECOND_ORDER_CELL_OF_THIRD_ORDER_CELL):
        corners = CORNERS_PER_PLANE_CELL[name]
        ends = ends_of_each_side(kinds[name], corners)
        inner = kinds[name][:, corners : 3 * corners].reshape(ends.shape)
        sides[name] = np.concatenate([ends[..., :1], inner, ends[..., 1:]], axis=-1)
    # The two cells that share an edge also share the node added in the middle of the edge.
    every = np.concatenate([side.reshape(-1, 4) for side in sides.values()])
    number, first = _number_of_each_edge(every[:, [0, 3]])
    inner = np.sort(every[:, 1:3], axis=1)
    if not np.array_equal(inner, inner[first[number]]):
        raise BadInput(f"{fault}: has cells that share an edge but not the nodes inside it")
    found, done = dict(kinds), 0
    for name, side in sides.items():
        count = len(side) * side.shape[1]
        middles = len(points) + number[done : done + count].reshape(len(side), -1)
        found[name] = np.hstack([side[..., 0], middles])
        done += count
    return found, np.vstack([points, _middles_of_third_order_edges(points[every[first]], on_drum)])


def ends_of_each_side(cells: Ints, corners: int) -> Ints:
    """The two corner nodes (m, corners, 2) at the ends of each side of m cells."""
    first = cells[:, :corners]
    return np.stack([first, np.roll(first, -1, axis=1)], axis=-1)


def _middles_of_third_order_edges(nodes: Floats, on_drum: bool) -> Floats:
    """The middles (m, 2) of m edges whose four nodes (m, 4, 2), from end to end, are given.

    The middle of a cubic curve through four points of a circle of radius R lies inside the circle
    by R/3456 times the fourth power of the edge's length over R. This distance is small, but on the
    contact line it would count as a gap. If the origin is the centre of a drum (`on_drum`), the
    middle of an edge along a circle therefore has the distance from the centre that its four nodes
    have.
    """
    middles = np.einsum("i,mix->mx", CUBIC_EDGE_MIDDLE_WEIGHTS, nodes)
    if not on_drum:
        return middles
    distances = np.hypot(nodes[:, :, 0], nodes[:, :, 1])
    chords = np.hypot(*(nodes[:, -1] - nodes[:, 0]).T)
    along = np.ptp(distances, axis=1) < CIRCULAR_EDGE_RADIUS_TOLERANCE * chords
    wanted = distances @ np.array(CUBIC_EDGE_MIDDLE_WEIGHTS)
    middles[along] *= (wanted[along] / np.hypot(*middles[along].T))[:, None]
    return middles


def _quadratic_triangles(
    kinds: dict[str, Ints], points: Floats, flat: Mapping[str, Ints]
) -> tuple[Ints, dict[str, Ints], Floats]:
    """All cells of a mesh file as quadratic triangles (m, 6), their parts by type, and all points.

    The parts are those of `PlaneCellsOfOneKind`. Added nodes follow the nodes of the file.

    Parameters
    ----------
    kinds : cells (m, k) of each type, of first or second order
    points : (n, 2) coordinates of the nodes
    flat : for each type the position (m,) of the corner of 180 degrees in each cell; -1 without one
    """
    middles, points = _middle_nodes_of_each_side_and_all_points(kinds, points)
    made, parts, count = [], {}, 0
    for source, cells in kinds.items():
        # The triangles (m, 1 or 2, 6) are those made of each of the m cells.
        if CORNERS_PER_PLANE_CELL[source] == 3:
            triangles = np.hstack([cells[:, :3], middles[source]])[:, None]
        else:
            triangles, points = _triangles_of_quadrilaterals_and_all_points(
                cells, middles[source], flat[source], points
            )
        made.append(triangles.reshape(-1, 6))
        parts[source] = count + np.arange(len(made[-1])).reshape(triangles.shape[:2])
        count += len(made[-1])
    return np.concatenate(made), parts, points


def _flat_corner_of_each_cell(cells: Ints, points: Floats, name: str) -> Ints:
    """The position (m,) of the corner of 180 degrees in each cell; -1 for a cell without one.

    Only quadrilaterals have such corners: a triangle with one has no area.

    Parameters
    ----------
    cells : (m, k) nodes of the cells, of first or second order
    points : (n, 2) coordinates of the nodes
    name : meshio's name of the cells' type
    """
    corners = CORNERS_PER_PLANE_CELL[name]
    if corners == 3:
        return np.full(len(cells), -1)
    here = points[cells[:, :corners]]
    after, before = np.roll(here, -1, axis=1), np.roll(here, 1, axis=1)
    onward, back = after - here, before - here
    if cells.shape[1] > corners:
        # The tangents of quadratic edges at their ends; their lengths do not matter.
        middles = points[cells[:, corners : 2 * corners]]
        onward = 4 * middles - 3 * here - after
        back = 4 * np.roll(middles, 1, axis=1) - 3 * here - before
    cross = onward[..., 0] * back[..., 1] - onward[..., 1] * back[..., 0]
    turn = np.arctan2(np.abs(cross), -(onward * back).sum(axis=-1))
    return np.where(turn.min(axis=1) <= FLAT_CORNER, turn.argmin(axis=1), -1)


def _middle_nodes_of_each_side_and_all_points(
    kinds: Mapping[str, Ints], points: Floats
) -> tuple[dict[str, Ints], Floats]:
    """The middle nodes (m, corners) of the sides of all cells by type, and all points.

    A linear cell beside a quadratic one shares the middle node of their common side. A missing
    middle node is added to the points (n, 2) of the file, half-way between the ends of its side.
    """
    ends, own = [], []
    for name, cells in kinds.items():
        corners = CORNERS_PER_PLANE_CELL[name]
        ends.append(ends_of_each_side(cells, corners).reshape(-1, 2))
        is_linear = cells.shape[1] == corners
        own.append(
            np.full(cells.size, -1) if is_linear else cells[:, corners : 2 * corners].ravel()
        )
    every, given = np.concatenate(ends), np.concatenate(own)
    number, first = _number_of_each_edge(every)
    of_edge = np.full(len(first), -1)
    of_edge[number[given >= 0]] = given[given >= 0]
    missing = np.flatnonzero(of_edge < 0)
    of_edge[missing] = len(points) + np.arange(len(missing))
    middles = np.where(given >= 0, given, of_edge[number])
    found, done = {}, 0
    for (name, cells), sides in zip(kinds.items(), ends, strict=True):
        found[name] = middles[done : done + len(sides)].reshape(len(cells), -1)
        done += len(sides)
    return found, np.vstack([points, points[every[first[missing]]].mean(axis=1)])


def _triangles_of_quadrilaterals_and_all_points(
    cells: Ints, middles: Ints, flat: Ints, points: Floats
) -> tuple[Ints, Floats]:
    """The two quadratic triangles (m, 2, 6) that replace each quadrilateral, and all points.

    The cut begins at the corner of 180 degrees, or runs along the shorter diagonal. The middle node
    of the cut is the centre node of the quadrilateral, or a node added to the points.

    Parameters
    ----------
    cells : (m, k) nodes of the quadrilaterals, the corners first
    middles : (m, 4) middle nodes of their sides
    flat : (m,) position of the corner of 180 degrees; -1 without one
    points : (n, 2) coordinates of the nodes
    """
    # The corners a, b, c, d are turned so that the cut runs from a to c.
    at = points[cells[:, :4]]
    diagonals = np.hypot(*np.moveaxis(at[:, :2] - at[:, 2:], -1, 0))
    begin = np.where(flat >= 0, flat, diagonals[:, 0] > diagonals[:, 1])
    turned = (begin[:, None] + np.arange(4)) % 4
    corners = np.take_along_axis(cells[:, :4], turned, axis=1)
    sides = np.take_along_axis(middles, turned, axis=1)
    # The cut from a flat corner is straight: a centre node may lie far off its middle.
    places = _centres_of_quadrilaterals(points, corners, sides)
    places[flat >= 0] = points[corners[flat >= 0]][:, [0, 2]].mean(axis=1)
    has_own = (flat < 0) & (cells.shape[1] > 8)
    centre = np.where(has_own, cells[:, -1], len(points) + np.cumsum(~has_own) - 1)
    (a, b, c, d), (ab, bc, cd, da) = corners.T, sides.T
    halves = [np.stack([a, b, c, ab, bc, centre]), np.stack([a, c, d, centre, cd, da])]
    return np.array(halves).transpose(2, 0, 1), np.vstack([points, places[~has_own]])
