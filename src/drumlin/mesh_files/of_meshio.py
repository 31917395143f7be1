"""The content of a mesh that meshio has read, with its named and its numbered groups.

meshio is a Python library that reads mesh files of many formats. Groups of cells and nodes come
from names, from numbers, and from arrays of whole numbers in the file.
"""

from typing import Any

import numpy as np

from drumlin.base.arrays import Ints
from drumlin.mesh_files.content_of_file import MeshFileContent

MOST_GROUP_NUMBERS_IN_ARRAY = 1000
"""Largest number of different values in an array of whole numbers that defines groups of cells.

In an array of material numbers, for example, each value makes a group. An array with more different
values, for example an array of element numbers, makes no groups.
"""


def content_of_meshio_mesh(raw: Any) -> MeshFileContent:
    """The content of a `meshio.Mesh`; names of groups become lower case."""
    return MeshFileContent(
        points=np.asarray(raw.points, dtype=float),
        cells={name: cells.astype(np.int64) for name, cells in raw.cells_dict.items()},
        cell_groups=_cell_groups_by_name(raw),
        node_groups=_node_groups_by_name(raw),
    )


def _cell_groups_by_name(raw: Any) -> dict[str, dict[str, Ints]]:
    """The groups of cells in a `meshio.Mesh`: group name -> cell type -> indices of the cells.

    The index of a cell is its position among all cells of its type.
    """
    # First come the groups that the file names as sets of cells.
    groups: dict[str, dict[str, Ints]] = {}
    for name, members in raw.cell_sets_dict.items():
        if not name.startswith("gmsh:"):
            groups[name.lower()] = dict(members)
    # Next come Gmsh's physical groups with a name.
    tags = raw.cell_data_dict.get("gmsh:physical", {})
    dimension = {block.type: block.dim for block in raw.cells}
    for name, (tag, dim) in raw.field_data.items():
        # Gmsh may give a curve and a surface the same number, so that the dimension is compared.
        for cell, values in tags.items():
            members = np.flatnonzero(np.asarray(values) == tag)
            if len(members) and dimension[cell] == dim:
                groups.setdefault(name.lower(), {}).setdefault(cell, members)
    # Last come arrays of 0 and 1, which mark the members of a group, and groups by number.
    for name, by_cell in raw.cell_data_dict.items():
        if ":" not in name:
            for cell, values in by_cell.items():
                if _is_array_marking_group_members(values):
                    groups.setdefault(name.lower(), {})[cell] = np.flatnonzero(values)
    for name, numbered in _cell_groups_by_number(raw).items():
        groups.setdefault(name, numbered)
    return groups


def _cell_groups_by_number(raw: Any) -> dict[str, dict[str, Ints]]:
    """The groups of cells with a number in the file: group name -> cell type -> cell numbers.

    They are Gmsh's physical groups, and the values of arrays of whole numbers. The physical group 3
    is the group "3". The value 3 of an array "material" makes a group "material=3". It also makes a
    group "3" if there is no other array of whole numbers.
    """
    arrays = {}
    for name, by_cell in raw.cell_data_dict.items():
        ours = name == "gmsh:physical" or ":" not in name
        if ours and all(_is_array_of_group_numbers(values) for values in by_cell.values()):
            arrays[name] = by_cell
    groups: dict[str, dict[str, Ints]] = {}
    for name, by_cell in arrays.items():
        for cell, values in by_cell.items():
            for value in np.unique(np.asarray(values)):
                members = np.flatnonzero(np.asarray(values) == value)
                if name != "gmsh:physical":
                    groups.setdefault(f"{name.lower()}={value:.0f}", {})[cell] = members
                if len(arrays) == 1 or name == "gmsh:physical":
                    groups.setdefault(f"{value:.0f}", {})[cell] = members
    return groups


def _node_groups_by_name(raw: Any) -> dict[str, Ints]:
    """The groups of nodes in a `meshio.Mesh`: group name -> indices of the nodes."""
    groups = {name.lower(): np.asarray(members) for name, members in raw.point_sets.items()}
    for name, values in raw.point_data.items():
        if ":" not in name and _is_array_marking_group_members(values):
            groups[name.lower()] = np.flatnonzero(values)
    return groups


def _is_array_marking_group_members(values: Any) -> bool:
    """Whether an array marks the members of one group of cells or nodes: 1 inside, 0 outside."""
    values = np.asarray(values)
    return _has_one_number_per_member(values) and bool(np.isin(values, (0, 1)).all())


def _is_array_of_group_numbers(values: Any) -> bool:
    """Whether an array gives each cell the number of its group.

    Its values are whole numbers, at most MOST_GROUP_NUMBERS_IN_ARRAY different ones, and not 0 and
    1 alone.
    """
    values = np.asarray(values)
    if (
        not _has_one_number_per_member(values)
        or not np.issubdtype(values.dtype, np.number)
        or _is_array_marking_group_members(values)
    ):
        return False
    whole = np.isfinite(values).all() and np.array_equal(values, np.round(values))
    return bool(whole) and len(np.unique(values)) <= MOST_GROUP_NUMBERS_IN_ARRAY


def _has_one_number_per_member(values: Any) -> bool:
    """Whether an array has one number for each cell or node, as a row (n,) or a column (n, 1).

    meshio makes columns of the scalars in legacy VTK files.
    """
    return values.ndim == 1 or values.shape[1:] == (1,)
