"""Meshes in Abaqus and CalculiX input files: nodes, plane elements, node sets and element sets.

meshio's own reader knows neither CPS6 nor CPS8, the quadratic elements of plane stress.
"""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import meshio
import numpy as np

from drumlin.base.arrays import Ints

LINE_CELLS = {"T2D2": "line", "T3D2": "line", "B21": "line", "B31": "line"} | dict.fromkeys(
    ("T2D3", "T3D3", "B22", "B32"), "line3"
)
"""meshio's cell of each type of line element, which names boundary edges."""


def _plane_cells() -> dict[str, str]:
    """meshio's cell of each type of plane element."""
    cells = {"3": "triangle", "6": "triangle6", "65": "triangle6", "4": "quad", "8": "quad8"}
    types = {}
    for family in ("CPS", "CPE", "CAX", "S", "M3D", "STRI", "2D"):
        for nodes, cell in cells.items():
            types[f"{family}{nodes}"] = cell
    return types | dict.fromkeys(("S9", "M3D9"), "quad9")


CELL_OF_TYPE = LINE_CELLS | _plane_cells()
"""meshio's cell of each element type that is read."""
TYPE_OF_CELL = {"triangle": "CPS3", "triangle6": "CPS6", "quad": "CPS4", "quad8": "CPS8"}
"""The plane-stress element type that is written for each of meshio's cells."""
NODES_PER_CELL = {
    "line": 2,
    "line3": 3,
    "triangle": 3,
    "triangle6": 6,
    "quad": 4,
    "quad8": 8,
    "quad9": 9,
}
"""Number of nodes of meshio's cells."""
MOST_MEMBERS = 2_000_000
"""Largest number of members of all sets together; a file with more is refused. A set may name other
sets and ranges, and be far larger than its text, so that the limit saves memory.
"""
NUMBERS_PER_LINE = 12
"""Number of labels on a line that is written; the formats allow 16."""


class _InputSection(NamedTuple):
    """A section of an input file: keyword, options and data rows, in upper case."""

    keyword: str
    options: dict[str, str]
    rows: list[list[str]]


class _ElementRows(NamedTuple):
    """The elements of a section: meshio's cell, the labels (m,), and the node labels (m, k)."""

    cell: str
    labels: list[int]
    nodes: list[list[int]]


class _Content:
    """What has been read of an input file so far.

    `row_of_node` is the row in `points` of each node label. `blocks` are the elements by cell, and
    `place` the block and the row in it of each element label. `room` is the number of members that
    sets may still have.
    """

    def __init__(self) -> None:
        self.points: list[list[float]] = []
        self.row_of_node: dict[int, int] = {}
        self.blocks: list[tuple[str, list[list[int]]]] = []
        self.place: dict[int, tuple[int, int]] = {}
        self.node_sets: dict[str, list[int]] = {}
        self.element_sets: dict[str, list[int]] = {}
        self.room = MOST_MEMBERS

    def add(self, section: _InputSection) -> None:
        """Read a section; other keywords than those of nodes, elements and sets are passed over."""
        keyword, options, rows = section
        ranges = "GENERATE" in options
        if keyword == "INCLUDE":
            raise ValueError("*INCLUDE is not followed; put nodes, elements and sets in one file")
        if keyword == "NODE":
            self._add_nodes(options, rows)
        elif keyword == "ELEMENT":
            self._add_elements(options, rows)
        elif keyword == "NSET":
            self.room -= _members(self.room, self.node_sets, options.get("NSET"), rows, ranges)
        elif keyword == "ELSET":
            self.room -= _members(self.room, self.element_sets, options.get("ELSET"), rows, ranges)

    def _add_nodes(self, options: dict[str, str], rows: list[list[str]]) -> None:
        """Read the nodes of a section: label and coordinates in each row."""
        for label, *xyz in rows:
            if int(label) in self.row_of_node:
                raise ValueError(f"node {label} is defined twice")
            self.row_of_node[int(label)] = len(self.points)
            self.points.append([*map(float, xyz), 0.0, 0.0][:3])
        labels = [[row[0]] for row in rows]
        self.room -= _members(self.room, self.node_sets, options.get("NSET"), labels)

    def _add_elements(self, options: dict[str, str], rows: list[list[str]]) -> None:
        """Read the elements of a section, which are all of one type."""
        elements = _elements(options.get("TYPE", ""), rows)
        for row, element in enumerate(elements.labels):
            if element in self.place:
                raise ValueError(f"element {element} is defined twice")
            self.place[element] = (len(self.blocks), row)
        cells = [[self.row_of_node[label] for label in nodes] for nodes in elements.nodes]
        # meshio has the middle node of an edge behind both ends.
        if elements.cell == "line3":
            cells = [[a, b, middle] for a, middle, b in cells]
        self.blocks.append((elements.cell, cells))
        labels = [[str(label)] for label in elements.labels]
        self.room -= _members(self.room, self.element_sets, options.get("ELSET"), labels)

    def mesh(self) -> Any:
        """The content as a meshio.Mesh."""
        cells = [
            (cell, np.array(rows, dtype=np.int64).reshape(-1, NODES_PER_CELL[cell]))
            for cell, rows in self.blocks
        ]
        node_sets = {}
        for name, labels in self.node_sets.items():
            rows_of_nodes = [self.row_of_node[label] for label in labels]
            node_sets[name] = np.unique(np.array(rows_of_nodes, dtype=np.int64))
        element_sets = {name: self._by_block(labels) for name, labels in self.element_sets.items()}
        points = np.array(self.points).reshape(-1, 3)
        return meshio.Mesh(points, cells, cell_sets=element_sets, point_sets=node_sets)

    def _by_block(self, labels: list[int]) -> list[Ints]:
        """The rows in each block of the elements of a set."""
        places = [self.place[label] for label in labels if label in self.place]
        found = np.array(places, dtype=np.int64).reshape(-1, 2)
        order = np.argsort(found[:, 0], kind="stable")
        cuts = np.searchsorted(found[order, 0], np.arange(1, len(self.blocks)))
        return list(np.split(found[order, 1], cuts)) if self.blocks else []


def read_inp(text: str) -> Any:
    """The mesh in the text of an input file as a meshio.Mesh, with set names in lower case.

    Keywords of other sections than nodes, elements and sets are passed over.

    Raises
    ------
    ValueError
        with a line that says what cannot be read
    """
    content = _Content()
    for section in _sections(text):
        content.add(section)
    return content.mesh()


def _sections(text: str) -> Iterator[_InputSection]:
    """The sections of a file; a row of elements that ends with a comma goes on in the next line."""
    keyword, options, rows, goes_on = "", dict[str, str](), list[list[str]](), False
    for line_text in text.splitlines():
        line = line_text.strip()
        if not line or line.startswith("**"):
            continue
        words = [word.strip().upper() for word in line.split(",")]
        if line.startswith("*"):
            yield _InputSection(keyword, options, rows)
            keyword, rows, goes_on = words[0][1:].strip(), [], False
            pairs = [word.partition("=") for word in words[1:]]
            options = {key.strip(): value.strip() for key, _, value in pairs}
            continue
        row = [word for word in words if word]
        if goes_on:
            rows[-1] += row
        else:
            rows.append(row)
        goes_on = line.endswith(",") and keyword == "ELEMENT"
    yield _InputSection(keyword, options, rows)


def _elements(kind: str, rows: list[list[str]]) -> _ElementRows:
    """The elements of an *ELEMENT section of this type."""
    # Letters at the end say reduced, hybrid and the like: the shape is the same.
    plain = kind[:-2] if kind[-2:] == "R5" else kind.rstrip("HIRMSTW")
    if plain not in CELL_OF_TYPE:
        raise ValueError(
            f"*ELEMENT, TYPE={kind} is not an element of a plane mesh; allowed: {', '.join(CELL_OF_TYPE)}"
        )
    cell = CELL_OF_TYPE[plain]
    if any(len(row) != NODES_PER_CELL[cell] + 1 for row in rows):
        raise ValueError(
            f"*ELEMENT, TYPE={kind} needs a label and {NODES_PER_CELL[cell]} nodes on each line"
        )
    labels = [int(row[0]) for row in rows]
    nodes = [[int(word) for word in row[1:]] for row in rows]
    return _ElementRows(cell, labels, nodes)


def _members(
    room: int,
    sets: dict[str, list[int]],
    name: str | None,
    rows: list[list[str]],
    ranges: bool = False,
) -> int:
    """Add rows to a set, and return the number of their members.

    Parameters
    ----------
    room : largest number of members
    sets : members of earlier sets by name; the set is added to them
    name : of the set; without one nothing is added
    rows : labels or names of earlier sets; or, with `ranges`, first label, last label and step
    ranges : whether the rows are ranges

    Raises
    ------
    ValueError
        where the members are more than `room`, before they fill the memory
    """
    if not name:
        return 0
    members = sets.setdefault(name.lower(), [])
    before = len(members)
    for row in rows:
        if ranges:
            first, last, step = [*map(int, row), 1][:3]
            added: list[Sequence[int]] = [range(first, last + 1, step)]
        else:
            added = [[int(word)] if word.isdigit() else sets.get(word.lower(), []) for word in row]
        for more in added:
            # The length of a range may be beyond what len can say: a slice shows whether it fits.
            rest = room + before - len(members)
            if more[rest:]:
                raise ValueError(f"the sets have more than {MOST_MEMBERS} members together")
            members += more
    return len(members) - before


def write_inp(
    path: Path,
    points: Any,
    cell: str,
    cells: Ints,
    subdomains: dict[str, Ints],
    nodes: dict[str, Ints],
) -> None:
    """Write one kind of plane-stress elements with element sets and node sets.

    Parameters
    ----------
    path : of the file
    points : (n, 2) nodes [m]
    cell : meshio's name of the cells; quad9 loses its centre nodes
    cells : (m, k) nodes of the cells in meshio's order
    subdomains, nodes : elements and nodes of each set, by name
    """
    if cell == "quad9":
        cell, cells = "quad8", cells[:, :8]
    used = np.unique(cells)
    lines = ["*NODE"]
    lines += [f"{i + 1}, {points[i][0]:.16e}, {points[i][1]:.16e}, 0." for i in used]
    lines.append(f"*ELEMENT, TYPE={TYPE_OF_CELL[cell]}")
    lines += [", ".join(map(str, [i, *(row + 1)])) for i, row in enumerate(cells, start=1)]
    for keyword, sets in (("ELSET", subdomains), ("NSET", nodes)):
        for name, members in sets.items():
            lines.append(f"*{keyword}, {keyword}={name.upper()}")
            labels = np.asarray(members) + 1
            for start in range(0, len(labels), NUMBERS_PER_LINE):
                lines.append(", ".join(map(str, labels[start : start + NUMBERS_PER_LINE])))
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
