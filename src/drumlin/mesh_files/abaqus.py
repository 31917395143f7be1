"""Element types of Abaqus and CalculiX input files (.inp), and the writing of such files."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from drumlin.base.arrays import Floats, Ints

MESHIO_LINE_CELL_OF_ABAQUS_TYPE = {
    "T2D2": "line",
    "T3D2": "line",
    "B21": "line",
    "B31": "line",
} | dict.fromkeys(("T2D3", "T3D3", "B22", "B32"), "line3")
"""meshio's name of the cell for each Abaqus type of line elements: trusses and beams."""
MESHIO_PLANE_CELL_OF_ABAQUS_TYPE = {
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
"""meshio's name of the cell for each Abaqus type of triangles and quadrilaterals."""
MESHIO_CELL_OF_ABAQUS_TYPE = MESHIO_LINE_CELL_OF_ABAQUS_TYPE | MESHIO_PLANE_CELL_OF_ABAQUS_TYPE
"""meshio's name of the cell for each Abaqus element type that drumlin reads from a mesh file."""
ABAQUS_TYPE_OF_MESHIO_CELL = {
    "triangle": "CPS3",
    "triangle6": "CPS6",
    "quad": "CPS4",
    "quad8": "CPS8",
}
"""Abaqus's plane-stress element type for each of meshio's cell names, as written to .inp files."""
NODES_PER_MESHIO_CELL = {
    "line": 2,
    "line3": 3,
    "triangle": 3,
    "triangle6": 6,
    "quad": 4,
    "quad8": 8,
    "quad9": 9,
}
"""Number of nodes of a mesh cell, by meshio's name of the cell."""
LABELS_PER_LINE_OF_SET = 12
"""Number of node or element labels on a line of a set in a written .inp file.

The file format allows up to 16.
"""


def write_mesh_as_inp_file(
    path: Path,
    xy: Floats,
    cell: str,
    cells: Ints,
    subdomains: Mapping[str, Ints],
    edges: Mapping[str, Ints],
) -> None:
    """Write a mesh of plane-stress elements, with element sets and node sets, to an .inp file.

    Parameters
    ----------
    path : path of the file to write
    xy : (n, 2) coordinates of the nodes [m]
    cell : meshio's name of the elements' type
    cells : (m, k) nodes of each element in meshio's order
    subdomains : elements of each element set, by the set's name
    edges : (2 or 3, k) nodes of the edges that become a node set, by the set's name
    """
    # Plane-stress elements of Abaqus have at most eight nodes, so that centre nodes are left out.
    if cell == "quad9":
        cell, cells = "quad8", cells[:, :8]
    used = np.unique(cells)
    lines = ["*NODE"]
    lines += [f"{i + 1}, {xy[i][0]:.16e}, {xy[i][1]:.16e}, 0." for i in used]
    lines.append(f"*ELEMENT, TYPE={ABAQUS_TYPE_OF_MESHIO_CELL[cell]}")
    lines += [", ".join(map(str, [i, *(row + 1)])) for i, row in enumerate(cells, start=1)]
    # Labels of nodes and elements count from 1 in the file, and from 0 in the arrays.
    nodes = {name: np.unique(along) for name, along in edges.items()}
    for keyword, sets in (("ELSET", subdomains), ("NSET", nodes)):
        for name, members in sets.items():
            lines.append(f"*{keyword}, {keyword}={name.upper()}")
            labels = np.asarray(members) + 1
            for start in range(0, len(labels), LABELS_PER_LINE_OF_SET):
                lines.append(", ".join(map(str, labels[start : start + LABELS_PER_LINE_OF_SET])))
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
