"""A shoe's mesh in a file of a mesher, with named groups.

A named group is a set of cells or edges (Gmsh's physical names, ELSET, SURFACE, a group of MED), a
set of nodes (NSET, SET1), or an array of cells or points that is 1 on the members and 0 elsewhere
(VTK). A set of nodes stands for those outer edges whose nodes all belong to the set. Names may be
in upper or lower case. If the file has other names for the groups, or numbers, the key `groups` of
a shoe in the brake's file tells which name or number stands for which group.
"""

import dataclasses
import itertools
from pathlib import Path
from typing import Any

import numpy as np

from drumlin.base.arrays import Bools, Floats, Ints
from drumlin.base.errors import BadInput
from drumlin.brake.brake import Shoe
from drumlin.fem.mesh.arc import MESH_KINDS, mesh_kind_of_scikit_fem_mesh
from drumlin.fem.mesh.check import check_mesh_and_drop_unneeded_groups
from drumlin.fem.mesh.contact_surface import (
    contact_offsets_in_order_of_angle,
    move_contact_nodes_onto_drum_or_plane,
)
from drumlin.fem.mesh.degree import nodal_basis_of_mesh
from drumlin.fem.mesh.edges import (
    element_edges_between_vertices_and_missing_count,
    nodes_along_element_edges,
)
from drumlin.fem.mesh.from_file import ShoeMeshReadFromFile
from drumlin.mesh_files.content_of_file import (
    MeshFileContent,
    largest_rounding_errors_of_coordinates,
)
from drumlin.mesh_files.plane_cells import (
    CUBIC_EDGE_MIDDLE_WEIGHTS,
    SECOND_ORDER_CELL_OF_THIRD_ORDER_CELL,
    PlaneCellsOfOneKind,
    convert_plane_cells_to_one_kind,
)
from drumlin.mesh_files.reading import read_content_of_mesh_file, xy_coordinates_of_plane_mesh
from drumlin.mesh_files.writing import write_mesh_to_file

MESH_GROUP_NAMES = ("lining", "backing", "table", "shoe", "contact", "hinge", "actuation")
"""The names of the groups of a mesh that a shoe may need; groups with other names are ignored."""
METRES_PER_MESH_FILE_UNIT = {"m": 1.0, "mm": 1e-3, "in": 0.0254}
"""Metres in each unit of length that the coordinates of a mesh file may have."""


def write_shoe_mesh_to_file(path: Path, mesh: Any, shoe: Shoe) -> None:
    """Write a shoe's mesh with its groups to a file, in the brake's frame [m].

    The suffix of the path is .msh (Gmsh 2.2), .inp or .vtu; BadInput is raised for another suffix.
    In an .inp file quadratic quadrilaterals have eight nodes, without the centre node.
    """
    basis = nodal_basis_of_mesh(mesh)
    edges = {
        name: nodes_along_element_edges(basis, facets) for name, facets in mesh.boundaries.items()
    }
    write_mesh_to_file(
        path,
        shoe.convert_points_to_brake_frame(basis.doflocs).T,
        mesh_kind_of_scikit_fem_mesh(mesh).cell,
        basis.element_dofs.T,
        mesh.subdomains,
        edges,
    )


def read_shoe_mesh_from_file(path: Path, shoe: Shoe, radius: float, key: str = "mesh") -> Any:
    """Read a user's mesh of a shoe from a file; return scikit-fem's mesh in the shoe's frame [m].

    The coordinates in the file have the unit `shoe.mesh_unit` and the frame `shoe.mesh_frame`.
    BadInput is raised for a file that cannot be read or used; its message names `key` and the file.
    """
    return read_shoe_mesh_with_notes(path, shoe, radius, key).mesh


def read_shoe_mesh_with_notes(
    path: Path, shoe: Shoe, radius: float, key: str = "mesh"
) -> ShoeMeshReadFromFile:
    """Read a user's mesh of a shoe from a file, with notes on moved nodes and ignored parts.

    See `read_shoe_mesh_from_file` for the parameters and errors.
    """
    fault = f"{key} = '{path}'"
    content = read_content_of_mesh_file(path, fault, _names_of_element_groups_of_shoe(shoe))
    # The coordinates are converted to the shoe's frame [m]. The array `rounding` has their largest
    # rounding errors in the file's unit.
    unit = METRES_PER_MESH_FILE_UNIT[shoe.mesh_unit]
    points = xy_coordinates_of_plane_mesh(content, fault)
    rounding = content.rounding
    if rounding is None:
        rounding = largest_rounding_errors_of_coordinates(points)
    points = points * unit
    if shoe.mesh_frame == "brake":
        points = shoe.convert_points_to_shoe_frame(points)
    plane = convert_plane_cells_to_one_kind(content, points, fault, on_drum=not shoe.is_on_plane)
    # Nodes that drumlin added lie between nodes of the file and have no rounding error of their
    # own. An added middle node of a third-order side is the exception: it has the rounding errors
    # of the side's four nodes.
    slack = np.zeros((len(plane.points), 2))
    if set(content.cells) & set(SECOND_ORDER_CELL_OF_THIRD_ORDER_CELL):
        slack[:] = np.abs(CUBIC_EDGE_MIDDLE_WEIGHTS).sum() * rounding.max(axis=0) * unit
    slack[: len(points)] = rounding * unit
    mesh, vertex = _mesh_of_cells_and_vertex_number_of_each_node(plane, plane.points)
    nodal, _ = _mesh_of_cells_and_vertex_number_of_each_node(plane, slack)
    mesh = _mesh_with_named_groups_of_file(content, shoe, plane, mesh, vertex, fault)
    mesh = check_mesh_and_drop_unneeded_groups(
        mesh, shoe, radius, fault, content.names_of_all_groups
    )
    # A mesh whose contact nodes were moved is checked again.
    contact = move_contact_nodes_onto_drum_or_plane(mesh, nodal.doflocs, shoe, radius)
    if contact.mesh is not mesh:
        check_mesh_and_drop_unneeded_groups(
            contact.mesh, shoe, radius, f"{fault}: with its contact line on the {shoe.surface.name}"
        )
    off = contact_offsets_in_order_of_angle(contact.mesh, shoe, radius)
    return ShoeMeshReadFromFile(contact.mesh, contact, mesh, off, content.notes + plane.notes)


def _names_of_element_groups_of_shoe(shoe: Shoe) -> list[str]:
    """The names that groups of elements may have in the mesh file of a shoe.

    They are "lining", "backing", "table" and "shoe", or the names in the shoe's key `groups`.
    """
    names = ("lining", "backing", "table", "shoe")
    return list(
        itertools.chain.from_iterable(
            shoe.groups.names_of_group_in_mesh_file(name) for name in names
        )
    )


def _mesh_of_cells_and_vertex_number_of_each_node(
    plane: PlaneCellsOfOneKind, values: Floats
) -> tuple[Any, Ints]:
    """scikit-fem's mesh of the cells in a file, and the vertex number of each node of the file.

    Parameters
    ----------
    plane : the cells, converted to one kind
    values : (n, 2) coordinates of the nodes, or other values that the mesh gets in their place

    Returns
    -------
    the mesh, and for each node (n,) the number of its vertex in the mesh; -1 for a node that is no
    corner of a cell
    """
    kind = next(kind for kind in MESH_KINDS.values() if kind.cell == plane.cell)
    used, numbered = np.unique(plane.cells, return_inverse=True)
    numbered = numbered.reshape(plane.cells.shape)
    mesh = kind.mesh(np.ascontiguousarray(values[used].T), np.ascontiguousarray(numbered.T))
    vertex = np.full(len(values), -1)
    vertices = np.unique(plane.cells[:, : plane.number_of_corners_per_cell])
    vertex[vertices] = np.arange(len(vertices))
    return mesh, vertex


def _mesh_with_named_groups_of_file(
    content: MeshFileContent,
    shoe: Shoe,
    plane: PlaneCellsOfOneKind,
    mesh: Any,
    vertex: Ints,
    fault: str,
) -> Any:
    """The mesh with the groups of the file as its subdomains and boundaries.

    Groups of cells become subdomains. Groups of edges or of nodes become boundaries.

    Parameters
    ----------
    content : content of the mesh file
    shoe : the shoe, whose key `groups` may give other names for groups in the file
    plane : plane cells of the file, all of one kind
    mesh : scikit-fem's mesh of these cells
    vertex : (n,) index in the mesh of each node that is a corner of a cell; -1 for other nodes
    fault : beginning of each message
    """
    subdomains, boundaries = {}, {}
    for name in MESH_GROUP_NAMES:
        wanted = shoe.groups.names_of_group_in_mesh_file(name)
        for alias in wanted:
            if alias in content.broken:
                raise BadInput(f"{fault}: group {name}: {content.broken[alias]}")
        found = _find_elements_in_named_groups(content, plane, wanted)
        if len(found):
            subdomains[name] = found
        facets = _find_element_edges_in_named_groups(
            content, plane, mesh, vertex, wanted, f"{fault}: group {name}"
        )
        if len(facets):
            boundaries[name] = facets
    mesh = dataclasses.replace(mesh, _subdomains=subdomains, _boundaries=boundaries)
    _check_given_groups_are_in_file(content, shoe, fault)
    return mesh


def _check_given_groups_are_in_file(content: MeshFileContent, shoe: Shoe, fault: str) -> None:
    """Refuse names in a shoe's key `groups` that the mesh file does not have."""
    for name in shoe.groups.element_groups_named_in_brake_file:
        missing = [
            alias
            for alias in shoe.groups.names_of_group_in_mesh_file(name)
            if alias not in content.names_of_all_groups
        ]
        if missing:
            found = ", ".join(content.names_of_all_groups) or "none"
            raise BadInput(
                f"{fault}: groups.{name} = {missing[0]!r}: not in the file; found: {found}"
            )


def _find_elements_in_named_groups(
    content: MeshFileContent, plane: PlaneCellsOfOneKind, names: list[str]
) -> Ints:
    """The indices of the elements in the groups of the given names, each index once."""
    found = [np.zeros(0, dtype=np.int64)]
    for name in names:
        for cell, rows in content.cell_groups.get(name, {}).items():
            if cell in plane.parts:
                found.append(plane.indices_of_new_cells_made_of_file_cells(cell, rows))
    return np.unique(np.concatenate(found))


def _find_element_edges_in_named_groups(
    content: MeshFileContent,
    plane: PlaneCellsOfOneKind,
    mesh: Any,
    vertex: Ints,
    names: list[str],
    fault: str,
) -> Ints:
    """The indices of the mesh's edges in the groups of the given names in a file.

    Groups of edges are used. If the file has none of these names, groups of nodes are used.

    Parameters
    ----------
    content, plane, mesh, vertex : as in `_mesh_with_named_groups_of_file`
    names : names of the groups
    fault : beginning of each message
    """
    ends = [np.zeros((0, 2), dtype=np.int64)]
    for name in names:
        for cell, rows in content.cell_groups.get(name, {}).items():
            if cell.startswith("line"):
                ends.append(content.cells[cell][rows, :2])
        if name in content.edge_groups:
            ends.append(content.edge_groups[name])
    # A set of nodes is used only if the file has no edges of the same name.
    found = _numbers_of_element_edges_between_vertices(mesh, vertex[np.concatenate(ends)], fault)
    nodes = [content.node_groups[name] for name in names if name in content.node_groups]
    if len(found) or not nodes:
        return found
    inside = np.zeros(len(vertex), dtype=bool)
    inside[np.concatenate(nodes)] = True
    return np.intersect1d(
        _element_edges_with_all_nodes_in_set(plane, mesh, vertex, inside, fault),
        mesh.boundary_facets(),
    )


def _element_edges_with_all_nodes_in_set(
    plane: PlaneCellsOfOneKind, mesh: Any, vertex: Ints, inside: Bools, fault: str
) -> Ints:
    """The indices of the mesh's edges whose nodes all belong to a set of nodes.

    If no middle node belongs to the set, only the corners of the edges must belong to it. `inside`
    (n,) marks the nodes of the set; the other parameters are those of
    `_mesh_with_named_groups_of_file`.
    """
    corners = plane.number_of_corners_per_cell
    ends = plane.cells[:, :corners]
    pairs = np.stack([ends, np.roll(ends, -1, axis=1)], axis=-1)
    whole: Bools = np.all(inside[pairs], axis=-1)
    middles = plane.cells[:, corners : 2 * corners]
    if middles.size and inside[middles].any():
        whole &= inside[middles] | plane.added[middles]
    return _numbers_of_element_edges_between_vertices(mesh, vertex[pairs[whole]], fault)


def _numbers_of_element_edges_between_vertices(mesh: Any, ends: Ints, fault: str) -> Ints:
    """The indices of the mesh's edges between pairs of vertices `ends` (n, 2), each once.

    BadInput is raised for pairs that are no edge of the mesh; its message begins with `fault`.
    """
    found, strange = element_edges_between_vertices_and_missing_count(mesh, ends)
    if strange:
        wanted = len(np.unique(np.sort(ends, axis=1), axis=0))
        raise BadInput(f"{fault}: {strange} of its {wanted} edges are not edges of the cells")
    return found
