"""Elements of Abaqus and CalculiX input files, and the writing of such files."""

from pathlib import Path
from typing import Any

import numpy as np

from drumlin.base.arrays import Ints

LINE_CELLS = {"T2D2": "line", "T3D2": "line", "B21": "line", "B31": "line"} | dict.fromkeys(
    ("T2D3", "T3D3", "B22", "B32"), "line3"
)
PLANE_CELLS = {
    f"{family}{nodes}": cell
    for family in ("CPS", "CPE", "S", "M3D", "STRI", "2D")
    for nodes, cell in {
        "3": "triangle",
        "6": "triangle6",
        "65": "triangle6",
        "4": "quad",
        "8": "quad8",
    }.items()
} | dict.fromkeys(("S9", "M3D9"), "quad9")
CELL_OF_TYPE = LINE_CELLS | PLANE_CELLS
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
NUMBERS_PER_LINE = 12
"""Number of labels on a line that is written; the formats allow 16."""


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
