"""The cells of a mesh file as one kind of elements that drumlin solves with.

Cells of third order become cells of second order on the same curves. Quadrilaterals and triangles
in one mesh become quadratic triangles: each quadrilateral is halved, and linear cells get middle
nodes on their straight sides.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from drumlin.base.arrays import Bools, Floats, Ints
from drumlin.base.errors import BadInput
from drumlin.fem.mesh.content_of_file import FileContent

PLANE_SHAPES = {
    "triangle": 3,
    "triangle6": 3,
    "triangle10": 3,
    "quad": 4,
    "quad8": 4,
    "quad9": 4,
    "quad16": 4,
}
"""Number of corners of each plane cell that a mesh file may have, by meshio's name."""
LOWER = {"triangle10": "triangle6", "quad16": "quad8"}
"""The second-order cell that replaces each third-order cell, by meshio's names."""
BESIDE = frozenset(("vertex", "line", "line3", "line4"))
"""Cells of a mesh file that are no part of the plane mesh: edges, which name groups, and points."""
CUBIC_MIDDLE = (-1 / 16, 9 / 16, 9 / 16, -1 / 16)
"""Weights of the four nodes of a cubic edge, from end to end, in the point at its middle."""


@dataclass(frozen=True)
class PlaneCells:
    """The plane cells of a mesh file, made into cells of one kind.

    Parameters
    ----------
    cell : meshio's name of the kind
    cells : nodes (m, k) of each cell
    points : (n, 2), those of the file first, then nodes that were added
    parent : for each type of the file's cells the cells that were made of each of its rows: first
        number, and how many
    added : whether each point (n,) was added
    notes : lines about what was changed
    """

    cell: str
    cells: Ints
    points: Floats
    parent: Mapping[str, tuple[Ints, Ints]]
    added: Bools
    notes: tuple[str, ...] = ()

    @property
    def corners(self) -> int:
        """Number of corners of a cell."""
        return PLANE_SHAPES[self.cell]

    def made_of(self, cell: str, rows: Ints) -> Ints:
        """Numbers of the cells that were made of rows of a type of the file's cells."""
        first, count = self.parent[cell]
        parts = [first[rows] + i for i in range(2)]
        return np.sort(np.concatenate([part[count[rows] > i] for i, part in enumerate(parts)]))


def make_plane_cells_of_one_kind(content: FileContent, points: Floats, fault: str) -> PlaneCells:
    """The plane cells of a file, points (n, 2) its nodes.

    Raises BadInput, led by `fault`, for cells that are not plane or have nodes that are not there.
    """
    kinds = {
        name: cells for name, cells in content.cells.items() if name not in BESIDE and len(cells)
    }
    strange = sorted(set(kinds) - set(PLANE_SHAPES))
    if strange or not kinds:
        raise BadInput(
            f"{fault}: has cells {strange or sorted(content.cells)}; allowed are triangles and "
            f"quadrilaterals: {', '.join(PLANE_SHAPES)}"
        )
    for cells in kinds.values():
        if cells.min() < 0 or cells.max() >= len(points):
            raise BadInput(f"{fault}: has cells with nodes that the file does not define")
    own = len(points)
    notes: list[str] = []
    if set(kinds) & set(LOWER):
        kinds, points = _lower_to_second_order(kinds, points)
        notes.append("its elements of third order are solved as elements of second order")
    if len(kinds) > 1:
        counts = ", ".join(f"{len(cells)} {name}" for name, cells in kinds.items())
        found = _make_triangles(kinds, points, own)
        notes.append(
            f"its mixed cells ({counts}) are solved as {len(found.cells)} quadratic triangles"
        )
        return replace(found, notes=tuple(notes))
    ((source, cells),) = kinds.items()
    cell = LOWER.get(source, source)
    if cell == "quad8":
        cell, cells, points = _add_centres(cells, points)
    whole = np.arange(len(cells)), np.ones(len(cells), dtype=np.int64)
    added = np.arange(len(points)) >= own
    return PlaneCells(cell, cells, points, {source: whole}, added, tuple(notes))


def _add_centres(cells: Ints, points: Floats) -> tuple[str, Ints, Floats]:
    """Kind, cells and points of nine-node quadrilaterals that replace eight-node ones."""
    centres = points[cells[:, 4:8]].sum(axis=1) / 2 - points[cells[:, :4]].sum(axis=1) / 4
    numbers = len(points) + np.arange(len(cells))
    return "quad9", np.column_stack([cells, numbers]), np.vstack([points, centres])


def _lower_to_second_order(
    kinds: dict[str, Ints], points: Floats
) -> tuple[dict[str, Ints], Floats]:
    """Cells in which second order replaces third order, by the file's names; and all points."""
    middles: dict[tuple[int, int], int] = {}
    new: list[Floats] = []
    found: dict[str, Ints] = {}
    for name, cells in kinds.items():
        if name not in LOWER:
            found[name] = cells
            continue
        corners = PLANE_SHAPES[name]
        rows = np.empty((len(cells), 2 * corners), dtype=np.int64)
        rows[:, :corners] = cells[:, :corners]
        for side in range(corners):
            first, last = cells[:, side], cells[:, (side + 1) % corners]
            inner = cells[:, corners + 2 * side : corners + 2 * side + 2]
            # Both cells at an edge share the node that is added in the middle of the edge.
            nodes = points[np.column_stack([first, inner, last])]
            places = np.einsum("i,mix->mx", CUBIC_MIDDLE, nodes)
            for row, place in enumerate(places):
                a, b = int(first[row]), int(last[row])
                key = (min(a, b), max(a, b))
                if key not in middles:
                    middles[key] = len(points) + len(new)
                    new.append(place)
                rows[row, corners + side] = middles[key]
        found[name] = rows
    return found, np.vstack([points, *new])


def _make_triangles(kinds: dict[str, Ints], points: Floats, own: int) -> PlaneCells:
    """All cells as quadratic triangles; `own`: number of points that the file has."""
    middles: dict[tuple[int, int], int] = {}
    # The middle nodes that the file has serve the linear cells beside them too.
    for name, cells in kinds.items():
        corners = PLANE_SHAPES[name]
        for side in range(corners if cells.shape[1] > corners else 0):
            ends = np.sort(cells[:, [side, (side + 1) % corners]], axis=1)
            middles |= zip(
                map(tuple, ends.tolist()), cells[:, corners + side].tolist(), strict=True
            )
    new: list[Floats] = []

    # Nodes that are added get the numbers after those of the file.
    def added(place: Floats) -> int:
        new.append(place)
        return len(points) + len(new) - 1

    def middle(first: int, last: int) -> int:
        key = (min(first, last), max(first, last))
        if key not in middles:
            middles[key] = added((points[first] + points[last]) / 2)
        return middles[key]

    made: list[list[int]] = []
    parent = {}
    for source, cells in kinds.items():
        corners = PLANE_SHAPES[source]
        first = np.empty(len(cells), dtype=np.int64)
        for row, cell in enumerate(cells.tolist()):
            first[row] = len(made)
            sides = cell[corners : 2 * corners] or [
                middle(cell[i], cell[(i + 1) % corners]) for i in range(corners)
            ]
            if corners == 3:
                made.append([*cell[:3], *sides])
            else:
                centre = cell[8] if len(cell) > 8 else added(_find_centre(points, cell, sides, new))
                made += _halve_quadrilateral(points, cell[:4], sides, centre)
        parent[source] = (first, np.full(len(cells), 1 if corners == 3 else 2, dtype=np.int64))
    every = np.vstack([points, *new]) if new else points
    return PlaneCells(
        "triangle6",
        np.array(made, dtype=np.int64),
        every,
        parent,
        np.arange(len(every)) >= own,
    )


def _find_centre(points: Floats, cell: list[int], sides: list[int], new: list[Floats]) -> Floats:
    """The centre (2,) of a quadrilateral whose sides may be curved, from corners and middles."""
    middles = [points[i] if i < len(points) else new[i - len(points)] for i in sides]
    return np.sum(middles, axis=0) / 2 - points[cell[:4]].sum(axis=0) / 4


def _halve_quadrilateral(
    points: Floats, corners: list[int], sides: list[int], centre: int
) -> list[list[int]]:
    """Two triangles that a quadrilateral is cut into along its shorter diagonal."""
    a, b, c, d = corners
    ab, bc, cd, da = sides
    if np.hypot(*(points[a] - points[c])) <= np.hypot(*(points[b] - points[d])):
        return [[a, b, c, ab, bc, centre], [a, c, d, centre, cd, da]]
    return [[a, b, d, ab, centre, da], [b, c, d, bc, cd, centre]]
