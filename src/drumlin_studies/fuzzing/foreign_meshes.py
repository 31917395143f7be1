"""Mesh files of the formats that drumlin reads and does not write: VTK, Nastran, MED, universal.

Each function writes a mesh with its groups as another program would. Groups of elements become
properties in Nastran, and groups of edges become sets of nodes, or of elements in MED.
"""

import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import meshio
import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.mesh_files.med import MESHIO_CELL_OF_MED_TYPE
from drumlin.mesh_files.unv import CELL_AND_ORDER_OF_UNV_NODES

FIRST_SET_NUMBER_OF_NASTRAN_FILE = 11
"""Number of the first set of nodes in a written Nastran file; properties count from 1."""
SUFFIXES_OF_FOREIGN_TEXT_MESH_FILES = (".vtk", ".bdf", ".unv")
"""Suffixes of the formats here whose files are text."""
FIELD_WIDTHS_OF_NASTRAN_FORMAT = {"small": 8, "large": 16}
"""Number of characters of a field in the formats of Nastran's lines that have columns."""


def mesh_as_vtk_text(
    xy: Floats, cell: str, cells: Ints, subdomains: Mapping[str, Ints], edges: Mapping[str, Ints]
) -> str:
    """A legacy VTK file, with arrays that are 1 on the members of a group and 0 elsewhere.

    The parameters are those of `drumlin.mesh_files.writing.write_mesh_to_file`.
    """
    inside = {
        name: [np.isin(np.arange(len(cells)), found).astype(np.int32)]
        for name, found in subdomains.items()
    }
    on = {
        name: np.isin(np.arange(len(xy)), along).astype(np.int32) for name, along in edges.items()
    }
    points = np.column_stack([xy, np.zeros(len(xy))])
    mesh = meshio.Mesh(points, [(cell, cells)], cell_data=inside, point_data=on)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "shoe.vtk"
        meshio.write(path, mesh, file_format="vtk42", binary=False)
        return path.read_text(encoding="utf-8")


def mesh_as_nastran_text(
    xy: Floats,
    cell: str,
    cells: Ints,
    subdomains: Mapping[str, Ints],
    edges: Mapping[str, Ints],
    form: str = "free",
) -> str:
    """A Nastran bulk data file: properties from 1 on, and sets SET1 of nodes from 11 on.

    A comment before each property has its name, as HyperMesh writes it. `form` is "free", "small"
    or "large". The other parameters are those of `mesh_as_vtk_text`.
    """
    card = {
        "triangle": "CTRIA3",
        "triangle6": "CTRIA6",
        "quad": "CQUAD4",
        "quad8": "CQUAD8",
        "quad9": "CQUAD",
    }[cell]
    lines = ["SOL 101", "CEND", "BEGIN BULK"]
    for label, point in enumerate(xy, start=1):
        lines += _nastran_lines(["GRID", label, "", *point.tolist(), 0.0], form)
    property_of_each = np.zeros(len(cells), dtype=np.int64)
    for number, (name, members) in enumerate(subdomains.items(), start=1):
        property_of_each[members] = number
        lines.append(f'$HMNAME PROP {number:>12}"{name}" 4')
        lines += _nastran_lines(["PSHELL", number, 1, 10.0], form)
    for label, (number, nodes) in enumerate(
        zip(property_of_each.tolist(), (cells + 1).tolist(), strict=True), start=1
    ):
        lines += _nastran_lines([card, label, number, *nodes], form)
    for number, along in enumerate(edges.values(), start=FIRST_SET_NUMBER_OF_NASTRAN_FILE):
        lines += _nastran_lines(["SET1", number, *(np.unique(along) + 1).tolist()], form)
    return "\n".join([*lines, "ENDDATA"]) + "\n"


def _nastran_lines(words: list[Any], form: str) -> Iterator[str]:
    """Yield the lines of one card; `words` are its name and the values of its fields."""
    name, *values = words
    if form == "free":
        for start in range(0, max(len(values), 1), 8):
            texts = [repr(value) if value != "" else "" for value in values[start : start + 8]]
            yield ",".join([name if start == 0 else "+", *texts])
        return
    width = FIELD_WIDTHS_OF_NASTRAN_FORMAT[form]
    count = 8 if form == "small" else 4
    for start in range(0, max(len(values), 1), count):
        first = name if start == 0 else ""
        if form == "large":
            first = f"{name}*" if start == 0 else "*"
        texts = [_nastran_field(value, width) for value in values[start : start + count]]
        yield first.ljust(8) + "".join(texts)


def _nastran_field(value: Any, width: int) -> str:
    """A value in a field of some characters, with as many decimals as fit there."""
    if not isinstance(value, float):
        return str(value).ljust(width)
    for decimals in range(width, 0, -1):
        text = f"{value:.{decimals}f}"
        if abs(value) < 1:
            text = text.replace("0.", ".", 1)
        if len(text) <= width:
            return text.ljust(width)
    raise ValueError(f"{value} does not fit into {width} characters")


def mesh_as_universal_text(
    xy: Floats, cell: str, cells: Ints, subdomains: Mapping[str, Ints], edges: Mapping[str, Ints]
) -> str:
    """A universal file with thin shells, and groups of elements and nodes in dataset 2467.

    Quadrilaterals with nine nodes lose their centre. The parameters are those of
    `mesh_as_vtk_text`.
    """
    if cell == "quad9":
        cell, cells = "quad8", cells[:, :8]
    used = np.unique(cells)
    lines = ["    -1", "  2411"]
    for node in used.tolist():
        lines.append(f"{node + 1:10d}{1:10d}{1:10d}{11:10d}")
        words = (f"{number:25.16E}".replace("E", "D") for number in (*xy[node], 0.0))
        lines.append("".join(words))
    lines += ["    -1", "    -1", "  2412"]
    count = cells.shape[1]
    # The type of a thin shell, and the order of nodes in which meshio's nodes stand in the file.
    descriptor = {3: 91, 4: 94, 6: 92, 8: 95}[count]
    order = np.argsort(CELL_AND_ORDER_OF_UNV_NODES[count][1])
    for label, row in enumerate(cells[:, order] + 1, start=1):
        lines.append("".join(f"{word:10d}" for word in (label, descriptor, 1, 1, 7, count)))
        lines.append("".join(f"{word:10d}" for word in row))
    lines += ["    -1", "    -1", "  2467"]
    groups = {name: (8, found + 1) for name, found in subdomains.items()}
    groups |= {name: (7, np.intersect1d(along, used) + 1) for name, along in edges.items()}
    for number, (name, (kind, members)) in enumerate(groups.items(), start=1):
        lines.append(f"{number:10d}" + f"{0:10d}" * 6 + f"{len(members):10d}")
        lines.append(name)
        for start in range(0, len(members), 2):
            pair = members[start : start + 2]
            lines.append("".join(f"{kind:10d}{label:10d}{0:10d}{0:10d}" for label in pair))
    return "\n".join([*lines, "    -1"]) + "\n"


def write_mesh_as_med_file(
    path: Path,
    xy: Floats,
    cell: str,
    cells: Ints,
    subdomains: Mapping[str, Ints],
    edges: Mapping[str, Ints],
) -> None:
    """Write a MED file with groups of faces, and groups of lines for the edges, by h5py.

    The parameters are those of `drumlin.mesh_files.writing.write_mesh_to_file`.
    """
    import h5py  # noqa: PLC0415

    med_type = {name: kind for kind, name in MESHIO_CELL_OF_MED_TYPE.items()}
    family = np.zeros(len(cells), dtype=np.int64)
    names: dict[int, str] = {}
    for name, members in subdomains.items():
        names[-1 - len(names)] = name
        family[members] = -len(names)
    lines = [along[[0, -1, *range(1, len(along) - 1)]].T for along in edges.values()]
    numbers = np.concatenate(
        [np.full(len(line), -1 - len(names) - i) for i, line in enumerate(lines)]
    )
    names |= {-1 - len(names) - i: name for i, name in enumerate(edges)}
    with h5py.File(path, "w") as file:
        mesh = file.create_group("ENS_MAA/shoe")
        mesh.attrs.update({"DIM": 2, "ESP": 2, "REP": 0, "TYP": 0})
        step = mesh.create_group("-0000000000000000001-0000000000000000001")
        step["NOE/COO"] = xy.T.ravel()
        step["NOE/FAM"] = np.zeros(len(xy), dtype=np.int64)
        edge = med_type["line" if lines[0].shape[1] == 2 else "line3"]
        for kind, rows, found in (
            (med_type[cell], cells, family),
            (edge, np.concatenate(lines), numbers),
        ):
            step[f"MAI/{kind}/NOD"] = rows.T.ravel() + 1
            step[f"MAI/{kind}/FAM"] = found
        for number, name in names.items():
            group = file.create_group(f"FAS/shoe/ELEME/FAM_{number}_{name}")
            group.attrs["NUM"] = number
            letters = np.frombuffer(name.encode().ljust(80, b"\0"), dtype=np.int8)
            group["GRO/NOM"] = letters[None]
