"""Mesh files that are broken on purpose: cut off, torn, folded, without groups or misnamed.

A misnamed file has the suffix of another format. A group is the set of elements of a part of the
shoe, or the set of nodes on one of its boundaries.
"""

import math
import random
import tempfile
import tomllib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import meshio
import numpy as np

from drumlin.brake.file import make_drum_brake_from_data
from drumlin.fem.mesh.arc import mesh_kind_of_scikit_fem_mesh
from drumlin.fem.mesh.degree import nodal_basis_of_mesh
from drumlin.fem.mesh.edges import nodes_along_element_edges
from drumlin.fem.mesh.file import write_shoe_mesh_to_file
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.mesh_files.writing import WRITTEN_MESH_FILE_SUFFIXES
from drumlin_studies.fuzzing.foreign_meshes import (
    FIRST_SET_NUMBER_OF_NASTRAN_FILE,
    mesh_as_nastran_text,
    mesh_as_universal_text,
    mesh_as_vtk_text,
)
from drumlin_studies.fuzzing.inputs import (
    NAMES_OF_VALID_BRAKE_FILES_TO_BREAK,
    FilesAndCommandLineOfBrokenInput,
    content_of_brake_file,
    data_as_toml,
)

SUFFIXES_OF_BROKEN_MESH_FILES = (".msh", ".inp", ".vtu", ".vtk", ".bdf", ".unv")
"""Suffixes of the mesh files that are broken: Gmsh, Abaqus, both of VTK, Nastran and universal."""
GROUPS_IN_NASTRAN_FILE = {
    name: FIRST_SET_NUMBER_OF_NASTRAN_FILE + i
    for i, name in enumerate(("contact", "hinge", "actuation"))
}
"""The key `groups` of a shoe with a Nastran file: the number of each set, by drumlin's name."""


class PointsCellsAndGroupsOfMesh(NamedTuple):
    """A mesh with its groups, as the functions that write mesh files take it.

    Attributes
    ----------
    xy : (n, 2) coordinates of the nodes
    cell : meshio's name of the cells' type
    cells : (m, k) nodes of each cell in meshio's order
    subdomains : indices of the cells of each group of cells, by the group's name
    edges : (2 or 3, k) nodes of the edges of each group of edges, from end to end, by its name
    """

    xy: Any
    cell: str
    cells: Any
    subdomains: dict[str, Any]
    edges: dict[str, Any]


@cache
def valid_mesh_files_by_suffix() -> dict[str, bytes]:
    """Valid mesh files of a small shoe, by suffix; "brake" is the brake file that uses them."""
    data = tomllib.loads(content_of_brake_file(NAMES_OF_VALID_BRAKE_FILES_TO_BREAK[0]).decode())
    data["shoe"] = data["shoe"][:1]
    brake = make_drum_brake_from_data(data, unit_required=True)
    mesh = make_prepared_model(brake, elements=6, kind="tri2").bodies[0].mesh
    with tempfile.TemporaryDirectory() as folder:
        paths = [Path(folder) / f"shoe{suffix}" for suffix in WRITTEN_MESH_FILE_SUFFIXES]
        for path in paths:
            write_shoe_mesh_to_file(path, mesh, brake.shoes[0])
        files = {path.suffix: path.read_bytes() for path in paths}
    parts = mesh_parts_in_brake_frame(mesh, brake.shoes[0])
    files[".vtk"] = mesh_as_vtk_text(*parts).encode()
    files[".bdf"] = mesh_as_nastran_text(*parts).encode()
    files[".unv"] = mesh_as_universal_text(*parts).encode()
    return files | {"brake": data_as_toml(data)}


def mesh_parts_in_brake_frame(mesh: Any, shoe: Any) -> PointsCellsAndGroupsOfMesh:
    """The parts of scikit-fem's mesh of a shoe, as the functions that write mesh files take them.

    They are the nodes (n, 2) in the brake's frame [m], meshio's name of the cells, the nodes (m, k)
    of the cells, and the elements and the edges of each group by its name. The groups of edges
    stand in the order of GROUPS_IN_NASTRAN_FILE.
    """
    basis = nodal_basis_of_mesh(mesh)
    edges = {
        name: nodes_along_element_edges(basis, mesh.boundaries[name])
        for name in GROUPS_IN_NASTRAN_FILE
    }
    return PointsCellsAndGroupsOfMesh(
        shoe.convert_points_to_brake_frame(basis.doflocs).T,
        mesh_kind_of_scikit_fem_mesh(mesh).cell,
        basis.element_dofs.T,
        mesh.subdomains,
        edges,
    )


def files_of_brake_with_valid_mesh_file(suffix: str) -> dict[str, bytes]:
    """A brake file "b.toml" and the valid mesh file of its shoe with a suffix, by name."""
    files = valid_mesh_files_by_suffix()
    data = tomllib.loads(files["brake"].decode())
    data["shoe"][0]["mesh"] = f"m{suffix}"
    if suffix == ".bdf":
        data["shoe"][0]["groups"] = GROUPS_IN_NASTRAN_FILE
    return {"b.toml": data_as_toml(data), f"m{suffix}": files[suffix]}


def input_with_mesh_file(
    kind: str, mesh: bytes, suffix: str, *, must_fail: bool = True
) -> FilesAndCommandLineOfBrokenInput:
    """An input of `drumlin solve`: a brake whose shoe has a mesh file.

    Parameters
    ----------
    kind : str
        Kind of the input in tables.
    mesh : bytes
        Content of the mesh file.
    suffix : str
        Suffix of the mesh file.
    must_fail : bool
        Whether drumlin must refuse the input.
    """
    files = files_of_brake_with_valid_mesh_file(suffix) | {f"m{suffix}": mesh}
    words = ["solve", "b.toml", "--json", "r.json"]
    return FilesAndCommandLineOfBrokenInput(kind, files, words, must_fail=must_fail)


def make_input_with_impossible_mesh(rng: random.Random) -> FilesAndCommandLineOfBrokenInput:
    """An input with a mesh file that is broken in one of four ways.

    The file is cut off, has the suffix of another format, states wrong counts, or is no valid shoe.
    """
    (maker,) = rng.choices(
        [
            _input_with_cut_off_mesh,
            _input_with_mesh_suffix_of_other_format,
            _input_with_wrong_mesh_counts,
            _input_with_spoiled_shoe_mesh,
        ],
        [3, 1, 1, 6],
    )
    return maker(rng)


def _input_with_cut_off_mesh(rng: random.Random) -> FilesAndCommandLineOfBrokenInput:
    """An input whose mesh file is cut off after less than three quarters of its bytes."""
    suffix = rng.choice(SUFFIXES_OF_BROKEN_MESH_FILES)
    text = valid_mesh_files_by_suffix()[suffix]
    left = text[: rng.randrange(3 * len(text) // 4)]
    return input_with_mesh_file(f"mesh {suffix}: cut off", left, suffix)


def _input_with_mesh_suffix_of_other_format(rng: random.Random) -> FilesAndCommandLineOfBrokenInput:
    """An input whose mesh file has the suffix of another format, or is no mesh at all."""
    suffix, other = rng.sample(SUFFIXES_OF_BROKEN_MESH_FILES, 2)
    noise = bytes(rng.randrange(256) for _ in range(99))
    mesh_of_other_format = valid_mesh_files_by_suffix()[other]
    text = rng.choice(
        [
            mesh_of_other_format,
            content_of_brake_file(rng.choice(NAMES_OF_VALID_BRAKE_FILES_TO_BREAK)),
            b"",
            noise,
        ]
    )
    kind = f"mesh {suffix}: another format"
    if text is not mesh_of_other_format:
        return input_with_mesh_file(kind, text, suffix)
    # A reader may know the format by the content. The answer must then be that of the right suffix.
    undamaged_files = files_of_brake_with_valid_mesh_file(other)
    given = input_with_mesh_file(kind, text, suffix, must_fail=False)
    return given._replace(undamaged_files=undamaged_files)


def _input_with_wrong_mesh_counts(rng: random.Random) -> FilesAndCommandLineOfBrokenInput:
    """An input whose mesh file states a wrong number of nodes, elements or named groups."""
    text = valid_mesh_files_by_suffix()[".msh"].decode()
    keyword = rng.choice(["$Nodes\n", "$Elements\n", "$PhysicalNames\n"])
    start = text.index(keyword) + len(keyword)
    count = rng.choice(["-1", "0", "1", "999999", "99999999999999", "1e9", "nan"])
    false = text[:start] + count + text[text.index("\n", start) :]
    return input_with_mesh_file("mesh .msh: false counts", false.encode(), ".msh")


def _input_with_spoiled_shoe_mesh(rng: random.Random) -> FilesAndCommandLineOfBrokenInput:
    """An input whose mesh file is readable but no valid shoe: torn, folded, or without groups."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "shoe.vtu"
        path.write_bytes(valid_mesh_files_by_suffix()[".vtu"])
        mesh = meshio.read(path)
        name, spoil = rng.choice(list(MESH_SPOILING_FUNCTIONS_BY_FAULT.items()))
        # The mesh is taken apart into arrays, spoiled, and written again.
        points, cells = mesh.points.copy(), mesh.cells[0].data.copy()
        cell_data = {key: values[0].copy() for key, values in mesh.cell_data.items()}
        point_data = {key: values.copy() for key, values in mesh.point_data.items()}
        points, cells, cell_data, point_data = spoil(rng, points, cells, cell_data, point_data)
        meshio.Mesh(
            points,
            [(mesh.cells[0].type, cells)],
            cell_data={key: [values] for key, values in cell_data.items()},
            point_data=point_data,
        ).write(path, file_format="vtu")
        return input_with_mesh_file(f"mesh: {name}", path.read_bytes(), ".vtu")


PointsCellsAndDataOfSpoiledMesh = tuple[Any, Any, dict[str, Any], dict[str, Any]]
"""A spoiled mesh: its points, its cells, the data of its cells and the data of its points.

Each function below takes these four values of a valid mesh and returns them for a spoiled mesh. The
argument `at` holds data of cells, and `on` data of points, both by the name of the group.
"""


def _mesh_with_inverted_element(
    rng: random.Random, points: Any, cells: Any, at: Any, on: Any
) -> PointsCellsAndDataOfSpoiledMesh:
    """The mesh with two corners of a random element exchanged."""
    i = rng.randrange(len(cells))
    cells[i, [0, 1]] = cells[i, [1, 0]]
    return points, cells, at, on


def _mesh_torn_in_two(
    rng: random.Random, points: Any, cells: Any, at: Any, on: Any
) -> PointsCellsAndDataOfSpoiledMesh:
    """The mesh without the elements that cross a ray at a random angle, which leaves two parts."""
    # An element stays if all of its corners are on one side of the ray.
    theta = np.arctan2(points[:, 1], points[:, 0])[cells[:, :3]]
    cut = rng.uniform(-0.6, 0.5)
    keep = (theta.max(axis=1) < cut) | (theta.min(axis=1) > cut)
    return points, cells[keep], {key: values[keep] for key, values in at.items()}, on


def _mesh_with_doubled_node(
    rng: random.Random, points: Any, cells: Any, at: Any, on: Any
) -> PointsCellsAndDataOfSpoiledMesh:
    """The mesh with a node doubled, so that an element does not share it with its neighbours."""
    i, k = rng.randrange(len(cells)), rng.randrange(3)
    points = np.vstack([points, points[cells[i, k]]])
    on = {key: np.append(values, values[cells[i, k]]) for key, values in on.items()}
    # A corner that belongs to one element only can be doubled without harm. An element is then
    # inverted instead.
    if np.count_nonzero(cells == cells[i, k]) == 1:
        return _mesh_with_inverted_element(rng, points, cells, at, on)
    cells[i, k] = len(points) - 1
    return points, cells, at, on


def _mesh_with_infinite_coordinate(
    rng: random.Random, points: Any, cells: Any, at: Any, on: Any
) -> PointsCellsAndDataOfSpoiledMesh:
    """The mesh with one coordinate of a random corner set to NaN or infinity."""
    points[cells[rng.randrange(len(cells)), rng.randrange(3)], rng.randrange(2)] = rng.choice(
        [math.nan, math.inf]
    )
    return points, cells, at, on


def _mesh_with_corner_node_moved_far_away(
    rng: random.Random, points: Any, cells: Any, at: Any, on: Any
) -> PointsCellsAndDataOfSpoiledMesh:
    """The mesh with a random corner moved by 0.3 m, far across the neighbouring elements."""
    points[cells[rng.randrange(len(cells)), rng.randrange(3)], :2] += rng.choice([-1, 1]) * 0.3
    return points, cells, at, on


def _mesh_with_doubled_element(
    rng: random.Random, points: Any, cells: Any, at: Any, on: Any
) -> PointsCellsAndDataOfSpoiledMesh:
    """The mesh with a random element listed twice."""
    i = rng.randrange(len(cells))
    return (
        points,
        np.vstack([cells, cells[i : i + 1]]),
        {k: np.append(v, v[i]) for k, v in at.items()},
        on,
    )


def _mesh_with_missing_group(
    rng: random.Random, points: Any, cells: Any, at: Any, on: Any
) -> PointsCellsAndDataOfSpoiledMesh:
    """The mesh with one of its groups removed or emptied."""
    data, name = rng.choice(
        [(at, "lining"), (at, "shoe"), (on, "contact"), (on, "hinge"), (on, "actuation")]
    )
    if rng.random() < 0.5:
        del data[name]
    else:
        data[name][:] = 0
    return points, cells, at, on


def _mesh_with_wrong_groups(
    rng: random.Random, points: Any, cells: Any, at: Any, on: Any
) -> PointsCellsAndDataOfSpoiledMesh:
    """The mesh with a random element in no group of elements, or in all of them."""
    i, value = rng.randrange(len(cells)), rng.randrange(2)
    for values in at.values():
        values[i] = value
    return points, cells, at, on


def _mesh_in_other_length_unit(
    rng: random.Random, points: Any, cells: Any, at: Any, on: Any
) -> PointsCellsAndDataOfSpoiledMesh:
    """The mesh with its coordinates in another unit of length: mm, km or inches for metres."""
    return points * rng.choice([1e3, 1e-3, 25.4]), cells, at, on


def _mesh_with_point_off_plane(
    rng: random.Random, points: Any, cells: Any, at: Any, on: Any
) -> PointsCellsAndDataOfSpoiledMesh:
    """The mesh with a random point moved off the plane by 0.01 m."""
    points[rng.randrange(len(points)), 2] = 0.01
    return points, cells, at, on


def _mesh_with_element_of_nonexistent_node(
    rng: random.Random, points: Any, cells: Any, at: Any, on: Any
) -> PointsCellsAndDataOfSpoiledMesh:
    """The mesh with a random element that refers to a node that does not exist."""
    cells[rng.randrange(len(cells)), rng.randrange(cells.shape[1])] = rng.choice(
        [-1, len(points), 2**40]
    )
    return points, cells, at, on


def _mesh_with_middle_node_moved_far_away(
    rng: random.Random, points: Any, cells: Any, at: Any, on: Any
) -> PointsCellsAndDataOfSpoiledMesh:
    """The mesh with the middle node of an edge moved far away, so that an element folds over."""
    points[cells[rng.randrange(len(cells)), rng.randrange(3, 6)], :2] += 0.2
    return points, cells, at, on


MESH_SPOILING_FUNCTIONS_BY_FAULT: dict[str, Callable[..., PointsCellsAndDataOfSpoiledMesh]] = {
    "inverted element": _mesh_with_inverted_element,
    "disconnected parts": _mesh_torn_in_two,
    "doubled node": _mesh_with_doubled_node,
    "NaN or infinity": _mesh_with_infinite_coordinate,
    "folded": _mesh_with_corner_node_moved_far_away,
    "doubled element": _mesh_with_doubled_element,
    "group missing": _mesh_with_missing_group,
    "element in no group or in two": _mesh_with_wrong_groups,
    "another unit": _mesh_in_other_length_unit,
    "not plane": _mesh_with_point_off_plane,
    "undefined node": _mesh_with_element_of_nonexistent_node,
    "middle node far off": _mesh_with_middle_node_moved_far_away,
}
"""The functions that spoil a mesh, by a short name of the fault that they cause."""
