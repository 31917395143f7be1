"""The content of a mesh that meshio read, with groups by name, by number and by integer data."""

from typing import Any

import meshio
import numpy as np

from drumlin.base.arrays import Ints
from drumlin.fem.mesh.content_of_file import FileContent

MOST_VALUES = 1000
"""Largest number of distinct values of an integer array whose values each make a group of cells.

Arrays of materials have a few values. Arrays of element numbers have as many as there are cells.
"""


def content_of_meshio_mesh(raw: Any) -> FileContent:
    """The content of a meshio.Mesh; group names in lower case."""
    return FileContent(
        points=np.asarray(raw.points, dtype=float),
        cells={name: cells.astype(np.int64) for name, cells in raw.cells_dict.items()},
        cell_groups=_cell_groups(raw),
        node_groups=_node_groups(raw),
    )


def _cell_groups(raw: Any) -> dict[str, dict[str, Ints]]:
    """Group name -> cell type -> numbers of its cells of that type."""
    groups: dict[str, dict[str, Ints]] = {}
    for name, members in raw.cell_sets_dict.items():
        if not name.startswith("gmsh:"):
            groups[name.lower()] = dict(members)
    tags = raw.cell_data_dict.get("gmsh:physical", {})
    for name, (tag, dim) in raw.field_data.items():
        # The same number may stand for a line and for a surface.
        for cell, values in tags.items():
            members = np.flatnonzero(np.asarray(values) == tag)
            if len(members) and meshio._mesh.topological_dimension[cell] == dim:
                groups.setdefault(name.lower(), {}).setdefault(cell, members)
    for name, by_cell in raw.cell_data_dict.items():
        if ":" not in name:
            for cell, values in by_cell.items():
                if _is_membership(values):
                    groups.setdefault(name.lower(), {})[cell] = np.flatnonzero(values)
    for name, numbered in _numbered_groups(raw).items():
        groups.setdefault(name, numbered)
    return groups


def _numbered_groups(raw: Any) -> dict[str, dict[str, Ints]]:
    """Groups by number: Gmsh's physical groups, and the values of an integer array of cells.

    The value 3 of an array "material" makes a group "material=3", and a group "3" where it is the
    only array of this kind.
    """
    arrays = {}
    for name, by_cell in raw.cell_data_dict.items():
        ours = name == "gmsh:physical" or ":" not in name
        if ours and all(_is_numbering(values) for values in by_cell.values()):
            arrays[name] = by_cell
    groups: dict[str, dict[str, Ints]] = {}
    for name, by_cell in arrays.items():
        for cell, values in by_cell.items():
            for value in np.unique(np.asarray(values)):
                members = np.flatnonzero(np.asarray(values) == value)
                groups.setdefault(f"{name.lower()}={value:.0f}", {})[cell] = members
                if len(arrays) == 1 or name == "gmsh:physical":
                    groups.setdefault(f"{value:.0f}", {})[cell] = members
    return groups


def _node_groups(raw: Any) -> dict[str, Ints]:
    """Group name -> numbers of its nodes."""
    groups = {name.lower(): np.asarray(members) for name, members in raw.point_sets.items()}
    for name, values in raw.point_data.items():
        if ":" not in name and _is_membership(values):
            groups[name.lower()] = np.flatnonzero(values)
    return groups


def _is_membership(values: Any) -> bool:
    """Whether an array marks the cells or nodes of a group: 1 for members, 0 for all others."""
    values = np.asarray(values)
    return values.ndim == 1 and bool(np.isin(values, (0, 1)).all())


def _is_numbering(values: Any) -> bool:
    """Whether an array numbers groups of cells: whole numbers, few distinct, not only 0 and 1."""
    values = np.asarray(values)
    if values.ndim != 1 or not np.issubdtype(values.dtype, np.number) or _is_membership(values):
        return False
    whole = np.isfinite(values).all() and np.array_equal(values, np.round(values))
    return bool(whole) and len(np.unique(values)) <= MOST_VALUES
