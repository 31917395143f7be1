"""The plane cells of a mesh file, converted to elements of one kind.

Cells of third order become cells of second order on the same curves. If a mesh has quadrilaterals
and triangles, all cells become quadratic triangles: each quadrilateral is cut into two triangles,
and linear cells get middle nodes on their straight edges. All cells also become quadratic triangles
if a quadrilateral has a corner of 180 degrees. This quadrilateral has no area in the corner, and
the cut begins at the corner.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from drumlin.base.arrays import Bools, Floats, Ints
from drumlin.base.errors import BadInput
from drumlin.fem.mesh.content_of_file import MeshFileContent

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
    parent : for each type of cells in the file, two arrays with an entry for each cell of this
        type: the index of the first new cell made of the cell, and how many new cells were made
    added : (n,) whether each node was added
    notes : lines that tell how the cells were changed
    """

    cell: str
    cells: Ints
    points: Floats
    parent: Mapping[str, tuple[Ints, Ints]]
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
        first, count = self.parent[cell]
        parts = [first[rows] + i for i in range(2)]
        return np.sort(np.concatenate([part[count[rows] > i] for i, part in enumerate(parts)]))


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
        if cells.min() < 0 or cells.max() >= len(points):
            raise BadInput(f"{fault}: has cells with nodes that the file does not define")
    # Cells of third order become cells of second order. If the mesh then has triangles and
    # quadrilaterals, all cells become triangles.
    own = len(points)
    notes: list[str] = []
    if set(kinds) & set(SECOND_ORDER_CELL_OF_THIRD_ORDER_CELL):
        kinds, points = _convert_third_order_cells_and_points_to_second_order(
            kinds, points, on_drum
        )
        notes.append("its elements of third order are solved as elements of second order")
    flat = {name: _flat_corner_of_each_cell(cells, points, name) for name, cells in kinds.items()}
    flat_cells = sum(np.count_nonzero(corner >= 0) for corner in flat.values())
    if len(kinds) > 1 or flat_cells:
        counts = ", ".join(f"{len(cells)} {name}" for name, cells in kinds.items())
        word = "mixed cells" if len(kinds) > 1 else "cells"
        reason = f", {flat_cells} with a corner of 180 degrees" if flat_cells else ""
        found = _convert_cells_to_quadratic_triangles(kinds, points, flat, own)
        notes.append(
            f"its {word} ({counts}{reason}) are solved as {len(found.cells)} quadratic triangles"
        )
        return replace(found, notes=tuple(notes))
    # All cells are of one type. Eight-node quadrilaterals get a node in their centre.
    ((source, cells),) = kinds.items()
    cell = SECOND_ORDER_CELL_OF_THIRD_ORDER_CELL.get(source, source)
    if cell == "quad8":
        cell, cells, points = _add_centre_nodes_to_cells_and_points_of_quadrilaterals(cells, points)
    whole = np.arange(len(cells)), np.ones(len(cells), dtype=np.int64)
    added = np.arange(len(points)) >= own
    return PlaneCellsOfOneKind(cell, cells, points, {source: whole}, added, tuple(notes))


def _add_centre_nodes_to_cells_and_points_of_quadrilaterals(
    cells: Ints, points: Floats
) -> tuple[str, Ints, Floats]:
    """The kind, cells and points of nine-node quadrilaterals that replace eight-node ones.

    Each cell (m, 8) gets a node in its centre, which is added to the points (n, 2).
    """
    centres = points[cells[:, 4:8]].sum(axis=1) / 2 - points[cells[:, :4]].sum(axis=1) / 4
    numbers = len(points) + np.arange(len(cells))
    return "quad9", np.column_stack([cells, numbers]), np.vstack([points, centres])


def _convert_third_order_cells_and_points_to_second_order(
    kinds: dict[str, Ints], points: Floats, on_drum: bool
) -> tuple[dict[str, Ints], Floats]:
    """The cells of a mesh file with second order in place of third order, and all points.

    `kinds` are the cells (m, k) by their type in the file. The result has the same keys, also for
    the converted cells. The points (n, 2) of the file are followed by new middle nodes of edges.
    """
    middles: dict[tuple[int, int], int] = {}
    new: list[Floats] = []
    found: dict[str, Ints] = {}
    for name, cells in kinds.items():
        if name not in SECOND_ORDER_CELL_OF_THIRD_ORDER_CELL:
            found[name] = cells
            continue
        corners = CORNERS_PER_PLANE_CELL[name]
        rows = np.empty((len(cells), 2 * corners), dtype=np.int64)
        rows[:, :corners] = cells[:, :corners]
        for side in range(corners):
            first, last = cells[:, side], cells[:, (side + 1) % corners]
            inner = cells[:, corners + 2 * side : corners + 2 * side + 2]
            # The two cells that share an edge also share the node added in the middle of the edge.
            nodes = points[np.column_stack([first, inner, last])]
            places = _middles_of_third_order_edges(nodes, on_drum)
            for row, place in enumerate(places):
                a, b = int(first[row]), int(last[row])
                key = (min(a, b), max(a, b))
                if key not in middles:
                    middles[key] = len(points) + len(new)
                    new.append(place)
                rows[row, corners + side] = middles[key]
        found[name] = rows
    return found, np.vstack([points, *new])


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


@dataclass(frozen=True)
class _NodesWithAddedMiddleNodes:
    """The nodes of a mesh file, to which nodes in the middle of edges and cells are added.

    Attributes
    ----------
    points : (n, 2) coordinates of the nodes before nodes are added
    middles : number of the middle node of each edge that has one, by the edge's two corners, the
        smaller number first
    added : coordinates (2,) of each added node; the first added node has the index n, the next n +
    1
    """

    points: Floats
    middles: dict[tuple[int, int], int]
    added: list[Floats]

    def add_node_and_return_number(self, place: Floats) -> int:
        """Add a node at a place (2,), and return its number."""
        self.added.append(place)
        return len(self.points) + len(self.added) - 1

    def find_or_add_middle_node_of_edge(self, first: int, last: int) -> int:
        """The number of the middle node between two corners, which is added if it is missing."""
        key = (min(first, last), max(first, last))
        if key not in self.middles:
            self.middles[key] = self.add_node_and_return_number(
                (self.points[first] + self.points[last]) / 2
            )
        return self.middles[key]

    def coordinates_of_node(self, number: int) -> Floats:
        """The coordinates (2,) of a node of the file or of an added node."""
        count = len(self.points)
        return self.points[number] if number < count else self.added[number - count]


def _convert_cells_to_quadratic_triangles(
    kinds: dict[str, Ints], points: Floats, flat: Mapping[str, Ints], own: int
) -> PlaneCellsOfOneKind:
    """All cells of a mesh file as quadratic triangles.

    Parameters
    ----------
    kinds : cells (m, k) of each type, of first or second order
    points : (n, 2) coordinates of the nodes
    flat : for each type the position (m,) of the corner of 180 degrees in each cell; -1 without one
    own : number of nodes in the file; nodes with a larger index were added
    """
    nodes = _NodesWithAddedMiddleNodes(points, _middle_nodes_of_quadratic_cells(kinds), [])
    # Each triangle of the file makes one triangle, and each quadrilateral makes two.
    made: list[list[int]] = []
    parent = {}
    for source, cells in kinds.items():
        corners = CORNERS_PER_PLANE_CELL[source]
        first = np.empty(len(cells), dtype=np.int64)
        for row, cell in enumerate(cells.tolist()):
            first[row] = len(made)
            made += _quadratic_triangles_of_cell(nodes, cell, corners, int(flat[source][row]))
        parent[source] = (first, np.full(len(cells), 1 if corners == 3 else 2, dtype=np.int64))
    every = np.vstack([points, *nodes.added]) if nodes.added else points
    return PlaneCellsOfOneKind(
        "triangle6",
        np.array(made, dtype=np.int64),
        every,
        parent,
        np.arange(len(every)) >= own,
    )


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


def _middle_nodes_of_quadratic_cells(kinds: dict[str, Ints]) -> dict[tuple[int, int], int]:
    """The middle node of each edge of the cells of second order, by the edge's two corners.

    A linear cell beside a quadratic one takes the middle node of their common edge from here.
    `kinds` are the cells (m, k) of each type.
    """
    middles: dict[tuple[int, int], int] = {}
    for name, cells in kinds.items():
        corners = CORNERS_PER_PLANE_CELL[name]
        for side in range(corners if cells.shape[1] > corners else 0):
            ends = np.sort(cells[:, [side, (side + 1) % corners]], axis=1)
            middles |= zip(
                map(tuple, ends.tolist()), cells[:, corners + side].tolist(), strict=True
            )
    return middles


def _quadratic_triangles_of_cell(
    nodes: _NodesWithAddedMiddleNodes, cell: list[int], corners: int, flat: int
) -> list[list[int]]:
    """The nodes of the quadratic triangles, one or two, that replace a cell of a mesh file.

    Parameters
    ----------
    nodes : nodes of the file, to which missing middle nodes are added
    cell : nodes of the cell, its corners first
    corners : number of its corners, 3 or 4
    flat : position of its corner of 180 degrees; -1 without one
    """
    sides = cell[corners : 2 * corners] or [
        nodes.find_or_add_middle_node_of_edge(cell[i], cell[(i + 1) % corners])
        for i in range(corners)
    ]
    if corners == 3:
        return [[*cell[:3], *sides]]
    if flat >= 0:
        # The cut from the flat corner is straight: a centre node may lie far off its middle.
        a, b, c, d = cell[flat:4] + cell[:flat]
        ab, bc, cd, da = sides[flat:] + sides[:flat]
        middle = nodes.add_node_and_return_number((nodes.points[a] + nodes.points[c]) / 2)
        return [[a, b, c, ab, bc, middle], [a, c, d, middle, cd, da]]
    if len(cell) > 8:
        centre = cell[8]
    else:
        centre = nodes.add_node_and_return_number(_centre_of_quadrilateral(nodes, cell, sides))
    return _cut_quadrilateral_into_triangles(nodes.points, cell[:4], sides, centre)


def _centre_of_quadrilateral(
    nodes: _NodesWithAddedMiddleNodes, cell: list[int], sides: list[int]
) -> Floats:
    """The centre (2,) of a quadrilateral with straight or curved edges.

    Parameters
    ----------
    nodes : nodes of the file, and added ones
    cell : nodes of the quadrilateral, its four corners first
    sides : middle nodes of its edges
    """
    middles = [nodes.coordinates_of_node(i) for i in sides]
    return np.sum(middles, axis=0) / 2 - nodes.points[cell[:4]].sum(axis=0) / 4


def _cut_quadrilateral_into_triangles(
    points: Floats, corners: list[int], sides: list[int], centre: int
) -> list[list[int]]:
    """The nodes of the two quadratic triangles that a quadrilateral is cut into.

    The cut runs along the shorter diagonal. `corners` and `sides` are the numbers of the corners
    and of the middle nodes of the edges; `centre` is the number of the node in the middle of the
    cut.
    """
    a, b, c, d = corners
    ab, bc, cd, da = sides
    if np.hypot(*(points[a] - points[c])) <= np.hypot(*(points[b] - points[d])):
        return [[a, b, c, ab, bc, centre], [a, c, d, centre, cd, da]]
    return [[a, b, d, ab, centre, da], [b, c, d, bc, cd, centre]]
