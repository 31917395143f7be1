"""The reader of meshes in MED files (.med) of Salome and Code_Aster, which are HDF5 files.

h5py reads the HDF5 file. A family is a set of nodes or elements that belong to the same groups.
meshio's own reader ignores the kind of the coordinates, and fails on families without groups and on
names with letters beyond ASCII.
"""

import io
from collections import defaultdict
from typing import Any

import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.mesh_files.content_of_file import MeshFileContent

MESHIO_CELL_OF_MED_TYPE = {
    "PO1": "vertex",
    "SE2": "line",
    "SE3": "line3",
    "SE4": "line4",
    "TR3": "triangle",
    "TR6": "triangle6",
    "QU4": "quad",
    "QU8": "quad8",
    "QU9": "quad9",
}
"""meshio's name of the cell for each type of elements in a MED file that is read."""
NODES_PER_MED_CELL = {
    "PO1": 1,
    "SE2": 2,
    "SE3": 3,
    "SE4": 4,
    "TR3": 3,
    "TR6": 6,
    "QU4": 4,
    "QU8": 8,
    "QU9": 9,
}
"""Number of nodes of each type of elements in a MED file that is read."""
CARTESIAN_MED_COORDINATES = 0
"""The kind of coordinates (attribute REP of a mesh) that are x, y, z; 1 and 2 are angles."""
MOST_NUMBERS_IN_MED_ARRAY = 20_000_000
"""Largest number of numbers in an array of a MED file; a larger one is refused to save memory."""
LINE_TO_INSTALL_MED_READER = "needs h5py to be read: pip install 'drumlin[med]'"
"""The message for a MED file where the package h5py is not installed."""


def read_mesh_in_med_file(data: bytes) -> MeshFileContent:
    """Read the mesh in the content of a MED file; names of groups become lower case.

    Raises
    ------
    ValueError
        with a line that says what cannot be read
    ImportError
        with a line that says how h5py is installed
    """
    try:
        # The package is an extra of drumlin, and is loaded only for a MED file.
        import h5py  # noqa: PLC0415
    except ImportError as error:
        raise ImportError(LINE_TO_INSTALL_MED_READER) from error
    try:
        with h5py.File(io.BytesIO(data), "r") as file:
            return _content_of_only_mesh(file)
    # h5py raises errors of several kinds for a damaged file and for parts that are missing.
    except (OSError, RuntimeError, KeyError, TypeError, AttributeError) as error:
        raise ValueError(f"is no MED file or is damaged: {error}") from error


def _content_of_only_mesh(file: Any) -> MeshFileContent:
    """The content of an open MED file that must have one mesh with one step."""
    meshes = file.get("ENS_MAA", {})
    if len(meshes) != 1:
        raise ValueError(f"has {len(meshes)} meshes; must have one")
    ((name, mesh),) = meshes.items()
    if mesh.attrs.get("REP", CARTESIAN_MED_COORDINATES) != CARTESIAN_MED_COORDINATES:
        raise ValueError(f"the mesh {name} has cylindrical or spherical coordinates; write x, y, z")
    # Since version 3 of the format a mesh may have several steps with other coordinates.
    steps = [mesh] if "NOE" in mesh else list(mesh.values())
    if len(steps) != 1 or "NOE" not in steps[0] or "MAI" not in steps[0]:
        raise ValueError(f"the mesh {name} has {len(steps)} steps; must have one, with elements")
    families = mesh["FAS"] if "FAS" in mesh else file.get(f"FAS/{name}", {})
    return _content_of_med_step(steps[0], int(mesh.attrs["ESP"]), families)


def _content_of_med_step(step: Any, dimension: int, families: Any) -> MeshFileContent:
    """The content of one step of a mesh in a MED file.

    Parameters
    ----------
    step : the step's group in the HDF5 file
    dimension : number of coordinates of a node
    families : group of the mesh's families in the HDF5 file
    """
    # Arrays of a MED file have all x first, then all y; and all first nodes, then all second ones.
    points = _numbers_of_dataset(step["NOE"]["COO"], dimension).astype(float)
    node_names = _group_names_of_families(families.get("NOEUD", {}))
    element_names = _group_names_of_families(families.get("ELEME", {}))
    cells: dict[str, Ints] = {}
    cell_groups: dict[str, dict[str, Ints]] = defaultdict(dict)
    for kind, elements in step["MAI"].items():
        if kind not in MESHIO_CELL_OF_MED_TYPE:
            raise ValueError(
                f"has elements of type {kind}, which make no plane mesh; "
                f"allowed: {', '.join(MESHIO_CELL_OF_MED_TYPE)}"
            )
        cell = MESHIO_CELL_OF_MED_TYPE[kind]
        nodes = _numbers_of_dataset(elements["NOD"], NODES_PER_MED_CELL[kind])
        cells[cell] = nodes.astype(np.int64) - 1
        for name, members in _members_by_group_name(elements, len(nodes), element_names).items():
            cell_groups[name][cell] = members
    return MeshFileContent(
        points=points,
        cells=cells,
        cell_groups=cell_groups,
        node_groups=_members_by_group_name(step["NOE"], len(points), node_names),
    )


def _numbers_of_dataset(dataset: Any, columns: int) -> Floats:
    """The array (n, columns) in a dataset that has one column after the other.

    ValueError is raised for a dataset that is too large or has another number of numbers.
    """
    if dataset.size > MOST_NUMBERS_IN_MED_ARRAY:
        raise ValueError(f"has an array of more than {MOST_NUMBERS_IN_MED_ARRAY} numbers")
    values = np.asarray(dataset[()]).ravel()
    if columns < 1 or values.size % columns:
        raise ValueError(f"has an array of {values.size} numbers for {columns} columns")
    return values.reshape(columns, -1).T


def _group_names_of_families(families: Any) -> dict[int, list[str]]:
    """The names of the groups of each family of nodes or elements, by the family's number."""
    found = {}
    for family in families.values():
        names: Any = family["GRO"]["NOM"][()] if "GRO" in family else ()
        # A name has 80 characters, filled up with zeros or blanks, as numbers of eight bits.
        texts = [np.asarray(name).tobytes().split(b"\0")[0] for name in names]
        found[int(family.attrs["NUM"])] = [_name_of_bytes(text) for text in texts]
    return found


def _name_of_bytes(text: bytes) -> str:
    """The name of a group in lower case, from bytes in UTF-8 or else in Latin-1."""
    try:
        return text.decode().strip().lower()
    except UnicodeDecodeError:
        return text.decode("latin-1").strip().lower()


def _members_by_group_name(place: Any, count: int, names: dict[int, list[str]]) -> dict[str, Ints]:
    """The indices of the nodes or elements in each group, by the group's name.

    Parameters
    ----------
    place : group of the nodes or of the elements of one type in the HDF5 file
    count : number of these nodes or elements
    names : names of the groups of each family

    Raises
    ------
    ValueError
        for a number of families that is not the number of nodes or elements
    """
    if "FAM" not in place:
        return {}
    of_each = _numbers_of_dataset(place["FAM"], 1).ravel().astype(np.int64)
    if len(of_each) != count:
        raise ValueError(f"gives {len(of_each)} families to {count} nodes or elements")
    members: dict[str, list[Ints]] = defaultdict(list)
    for number in np.unique(of_each):
        for name in names.get(int(number), []):
            members[name].append(np.flatnonzero(of_each == number))
    return {name: np.sort(np.concatenate(found)) for name, found in members.items()}
