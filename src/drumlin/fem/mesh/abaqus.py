"""Meshes in Abaqus and CalculiX input files: nodes, plane elements, node sets and element sets.

meshio's own reader knows neither CPS6 nor CPS8, the quadratic elements of plane stress.
"""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import meshio
import numpy as np

from drumlin.base.arrays import Ints

LINE_CELLS = {"T2D2": "line", "T3D2": "line", "B21": "line", "B31": "line"} | dict.fromkeys(
    ("T2D3", "T3D3", "B22", "B32"), "line3"
)
PLANE_CELLS = {
    f"{family}{nodes}": cell
    for family in ("CPS", "CPE", "CAX", "S", "M3D", "STRI", "2D")
    for nodes, cell in {
        "3": "triangle",
        "6": "triangle6",
        "65": "triangle6",
        "4": "quad",
        "8": "quad8",
    }.items()
} | dict.fromkeys(("S9", "M3D9"), "quad9")
CELL_OF_TYPE = LINE_CELLS | PLANE_CELLS
TYPE_OF_CELL = {"triangle": "CPS3", "triangle6": "CPS6", "quad": "CPS4", "quad8": "CPS8"}
NODES_PER_CELL = {
    "line": 2,
    "line3": 3,
    "triangle": 3,
    "triangle6": 6,
    "quad": 4,
    "quad8": 8,
    "quad9": 9,
}
MOST_MEMBERS = 2_000_000  # of all sets together; a set may name others and ranges, and be far larger than its text
NUMBERS_PER_LINE = 12  # numbers on a line that is written; the formats allow 16


def read_inp(text: str) -> Any:
    """The mesh in the text of an input file as a meshio.Mesh; set names in lower case; other
    keywords are passed over.

    Raises ValueError with a line that says what cannot be read.
    """
    number: dict[int, int] = {}  # node label -> row of points
    points: list[list[float]] = []
    blocks: list[tuple[str, list[list[int]]]] = []
    place: dict[int, tuple[int, int]] = {}  # element label -> block, row
    node_sets: dict[str, list[int]] = {}
    element_sets: dict[str, list[int]] = {}
    room = MOST_MEMBERS
    for keyword, options, rows in _sections(text):
        if keyword == "INCLUDE":
            raise ValueError("*INCLUDE is not followed; put nodes, elements and sets in one file")
        if keyword == "NODE":
            for label, *xyz in rows:
                if int(label) in number:
                    raise ValueError(f"node {label} is defined twice")
                number[int(label)] = len(points)
                points.append([*map(float, xyz), 0.0, 0.0][:3])
            room -= _members(room, node_sets, options.get("NSET"), [[row[0]] for row in rows])
        elif keyword == "ELEMENT":
            cell, labels, cells = _elements(options.get("TYPE", ""), rows)
            for row, element in enumerate(labels):
                if element in place:
                    raise ValueError(f"element {element} is defined twice")
                place[element] = (len(blocks), row)
            rows_of = [[number[label] for label in nodes] for nodes in cells]
            blocks.append(
                (cell, [[a, b, middle] for a, middle, b in rows_of] if cell == "line3" else rows_of)
            )
            room -= _members(
                room, element_sets, options.get("ELSET"), [[str(label)] for label in labels]
            )
        elif keyword == "NSET":
            room -= _members(room, node_sets, options.get("NSET"), rows, "GENERATE" in options)
        elif keyword == "ELSET":
            room -= _members(room, element_sets, options.get("ELSET"), rows, "GENERATE" in options)
    cell_sets: dict[str, list[Ints]] = {}
    for name, labels in element_sets.items():
        found = np.array(
            [place[label] for label in labels if label in place], dtype=np.int64
        ).reshape(-1, 2)
        order = np.argsort(found[:, 0], kind="stable")
        cuts = np.searchsorted(found[order, 0], np.arange(1, len(blocks)))
        cell_sets[name] = list(np.split(found[order, 1], cuts)) if blocks else []
    return meshio.Mesh(
        np.array(points).reshape(-1, 3),
        [
            (cell, np.array(cells, dtype=np.int64).reshape(-1, NODES_PER_CELL[cell]))
            for cell, cells in blocks
        ],
        cell_sets=cell_sets,
        point_sets={
            name: np.unique(np.array([number[label] for label in labels], dtype=np.int64))
            for name, labels in node_sets.items()
        },
    )


def _sections(text: str) -> Iterator[tuple[str, dict[str, str], list[list[str]]]]:
    """Keyword, options and data rows of each section; upper case, a row that ends with a comma goes
    on.
    """
    keyword, options, rows, goes_on = "", dict[str, str](), list[list[str]](), False
    for line_text in text.splitlines():
        line = line_text.strip()
        if not line or line.startswith("**"):
            continue
        words = [word.strip().upper() for word in line.split(",")]
        if line.startswith("*"):
            yield keyword, options, rows
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
    yield keyword, options, rows


def _elements(kind: str, rows: list[list[str]]) -> tuple[str, list[int], list[list[int]]]:
    """meshio's cell type, labels and node labels of an *ELEMENT section."""
    plain = (
        kind.rstrip("HIRMSTW") if kind[-2:] != "R5" else kind[:-2]
    )  # reduced, hybrid, ... : one shape
    if plain not in CELL_OF_TYPE:
        raise ValueError(
            f"*ELEMENT, TYPE={kind} is not an element of a plane mesh; allowed: {', '.join(CELL_OF_TYPE)}"
        )
    cell = CELL_OF_TYPE[plain]
    if any(len(row) != NODES_PER_CELL[cell] + 1 for row in rows):
        raise ValueError(
            f"*ELEMENT, TYPE={kind} needs a label and {NODES_PER_CELL[cell]} nodes on each line"
        )
    return cell, [int(row[0]) for row in rows], [[int(word) for word in row[1:]] for row in rows]


def _members(
    room: int,
    sets: dict[str, list[int]],
    name: str | None,
    rows: list[list[str]],
    ranges: bool = False,
) -> int:
    """Add the rows of a set: labels, names of earlier sets, or (first, last, step). Returns how
    many members that are.

    Raises ValueError where there are more than `room`, before they fill the memory.
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
            if more[
                room + before - len(members) :
            ]:  # the length of a range may be beyond what len can say
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
    """Write one kind of plane-stress elements with element sets and node sets; quad9 loses its
    centre nodes.

    points (n, 2) [m]; cells (m, k) in meshio's order.
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
