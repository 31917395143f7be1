"""A shoe's mesh in a file: Gmsh, Abaqus/CalculiX or VTU, with named groups.

A named group is a set of cells or edges (Gmsh's physical names, ELSET, SURFACE), a set of nodes
(NSET), or an array of cells or points that is 1 on the members and 0 elsewhere (VTU). A set of
nodes stands for those outer edges whose nodes all belong to the set. Names may be in upper or lower
case. If the file has other names for the groups, or numbers, the key `groups` of a shoe in the
brake's file tells which name or number stands for which group.
"""

import contextlib
import dataclasses
import io
import itertools
import stat
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import meshio
import numpy as np

from drumlin.base.arrays import Bools, Floats, Ints
from drumlin.base.errors import BadInput, system_message_of_error
from drumlin.base.files import temporary_file_replacing_output
from drumlin.brake.brake import Shoe
from drumlin.fem.mesh.abaqus import write_mesh_as_inp_file
from drumlin.fem.mesh.arc import MESH_KINDS, mesh_kind_of_scikit_fem_mesh
from drumlin.fem.mesh.check import (
    check_cells_share_nodes_consistently,
    check_mesh_and_drop_unneeded_groups,
)
from drumlin.fem.mesh.contact_surface import (
    contact_offsets_in_order_of_angle,
    move_contact_nodes_onto_drum_or_plane,
)
from drumlin.fem.mesh.content import read_bytes_of_mesh_file
from drumlin.fem.mesh.content_of_file import MeshFileContent, largest_rounding_errors_of_coordinates
from drumlin.fem.mesh.degree import nodal_basis_of_mesh
from drumlin.fem.mesh.edges import (
    element_edges_between_vertices_and_missing_count,
    nodes_along_element_edges,
)
from drumlin.fem.mesh.from_file import ShoeMeshReadFromFile
from drumlin.fem.mesh.inp import read_mesh_from_inp_text
from drumlin.fem.mesh.msh4 import is_text_in_gmsh_format_4, read_mesh_in_gmsh_format_4
from drumlin.fem.mesh.of_meshio import content_of_meshio_mesh
from drumlin.fem.mesh.plane_cells import (
    CELL_TYPES_BESIDES_PLANE_CELLS,
    CUBIC_EDGE_MIDDLE_WEIGHTS,
    SECOND_ORDER_CELL_OF_THIRD_ORDER_CELL,
    PlaneCellsOfOneKind,
    convert_plane_cells_to_one_kind,
)
from drumlin.fem.mesh.vtu import check_decompressed_vtu_size_fits_memory

MESH_FILE_SUFFIXES = (".msh", ".inp", ".vtu")
"""The suffixes of mesh files that drumlin reads and writes."""
MESH_GROUP_NAMES = ("lining", "backing", "table", "shoe", "contact", "hinge", "actuation")
"""The names of the groups of a mesh that a shoe may need; groups with other names are ignored."""
MOST_NODES_IN_MESH_FILE = 1_000_000
"""Largest number of nodes of a mesh in a file; a file with more nodes is refused to save memory."""
LARGEST_NODE_NUMBER_IN_FILE = 10_000_000
"""Largest label (number) of a node in an .msh file; a file with a larger label is refused.

meshio's reader makes an array as long as the largest number, which could fill the memory.
"""
METRES_PER_MESH_FILE_UNIT = {"m": 1.0, "mm": 1e-3, "in": 0.0254}
"""Metres in each unit of length that the coordinates of a mesh file may have."""
LONGEST_REPEATED_MESHIO_MESSAGE = 160
"""Largest number of characters of meshio's own error message that drumlin's message repeats."""


def write_shoe_mesh_to_file(path: Path, mesh: Any, shoe: Shoe) -> None:
    """Write a shoe's mesh with its groups to a file, in the brake's frame [m].

    The suffix of the path is .msh (Gmsh 2.2), .inp or .vtu; BadInput is raised for another suffix.
    In an .inp file quadratic quadrilaterals have eight nodes, without the centre node.
    """
    if path.suffix not in MESH_FILE_SUFFIXES:
        raise BadInput(
            f"--format = {path.suffix[1:]!r}: unknown format of a mesh; allowed: msh, inp, vtu"
        )
    basis = nodal_basis_of_mesh(mesh)
    cells = basis.element_dofs.T
    edges = {
        name: nodes_along_element_edges(basis, facets) for name, facets in mesh.boundaries.items()
    }
    xy = shoe.convert_points_to_brake_frame(basis.doflocs).T
    with temporary_file_replacing_output(path) as partial:
        if path.suffix == ".inp":
            nodes = {name: np.unique(along) for name, along in edges.items()}
            write_mesh_as_inp_file(
                partial, xy, mesh_kind_of_scikit_fem_mesh(mesh).cell, cells, mesh.subdomains, nodes
            )
        elif path.suffix == ".vtu":
            _write_mesh_as_vtu_file(
                partial, xy, mesh_kind_of_scikit_fem_mesh(mesh).cell, cells, mesh.subdomains, edges
            )
        else:
            _write_mesh_as_gmsh_file(
                partial, xy, mesh_kind_of_scikit_fem_mesh(mesh), cells, mesh.subdomains, edges
            )


def _write_mesh_as_gmsh_file(
    path: Path,
    xy: Floats,
    kind: Any,
    cells: Ints,
    subdomains: Mapping[str, Ints],
    edges: Mapping[str, Ints],
) -> None:
    """Write a mesh with its groups as a Gmsh file of format 2.2."""
    # Gmsh's order of nodes on an edge is both ends, then the middle node. Each group becomes a
    # block of cells or edges with a number of its own.
    blocks = [(kind.cell, cells[elements]) for elements in subdomains.values()]
    blocks += [(kind.edge, along[[0, -1, *range(1, len(along) - 1)]].T) for along in edges.values()]
    numbers = range(1, len(blocks) + 1)
    dims = [2] * len(subdomains) + [1] * len(edges)
    names = {
        name: np.array(tag) for name, *tag in zip([*subdomains, *edges], numbers, dims, strict=True)
    }
    tags = [
        np.full(len(block[1]), number, dtype=np.int32)
        for number, block in zip(numbers, blocks, strict=True)
    ]
    data = {"gmsh:physical": tags, "gmsh:geometrical": tags}
    content = meshio.Mesh(
        _plane_points_with_zero_z_added(xy), blocks, cell_data=data, field_data=names
    )
    meshio.write(path, content, file_format="gmsh22", binary=False)


def _write_mesh_as_vtu_file(
    path: Path,
    xy: Floats,
    cell: str,
    cells: Ints,
    subdomains: Mapping[str, Ints],
    edges: Mapping[str, Ints],
) -> None:
    """Write a mesh as a .vtu file; each group is an array that is 1 on its members, else 0."""
    members = {
        name: np.isin(np.arange(len(cells)), elements) for name, elements in subdomains.items()
    }
    nodes = {name: np.isin(np.arange(len(xy)), along) for name, along in edges.items()}
    content = meshio.Mesh(
        _plane_points_with_zero_z_added(xy),
        [(cell, cells)],
        cell_data={name: [inside.astype(np.int32)] for name, inside in members.items()},
        point_data={name: inside.astype(np.int32) for name, inside in nodes.items()},
    )
    meshio.write(path, content, file_format="vtu")


def _plane_points_with_zero_z_added(xy: Floats) -> Floats:
    """The points (n, 3) in space for points (n, 2) in the plane; their z is zero."""
    return np.column_stack([xy, np.zeros(len(xy))])


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
    content = _read_content_of_mesh_file(path, shoe, fault)
    if len(content.points) > MOST_NODES_IN_MESH_FILE:
        raise BadInput(
            f"{fault}: has {len(content.points)} nodes; must have at most {MOST_NODES_IN_MESH_FILE}"
        )
    # The coordinates are converted to the shoe's frame [m]. The array `rounding` has their largest
    # rounding errors in the file's unit.
    unit = METRES_PER_MESH_FILE_UNIT[shoe.mesh_unit]
    points = _xy_coordinates_of_plane_mesh(content, fault)
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
    check_cells_share_nodes_consistently(plane.cells, plane.number_of_corners_per_cell, fault)
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


def _read_content_of_mesh_file(path: Path, shoe: Shoe, fault: str) -> MeshFileContent:
    """Read the content of a mesh file: nodes, cells and groups.

    BadInput is raised for a file that cannot be read; its message begins with `fault`.
    """
    try:
        regular = stat.S_ISREG(path.stat().st_mode)
    except (OSError, ValueError) as error:
        raise BadInput(f"{fault}: no such file ({system_message_of_error(error)})") from error
    suffix = path.suffix.lower()
    if not regular or suffix not in MESH_FILE_SUFFIXES:
        raise BadInput(
            f"{fault}: is not a mesh: must be a file whose name ends in "
            f"{', '.join(MESH_FILE_SUFFIXES)}"
        )
    data = read_bytes_of_mesh_file(path)
    if suffix == ".msh":
        _check_node_numbers_fit_memory(path, fault)
    printed = io.StringIO()
    try:
        with (
            contextlib.redirect_stdout(printed),
            contextlib.redirect_stderr(printed),
            warnings.catch_warnings(),
        ):
            # Warnings of meshio are not shown, since drumlin's own checks find faults of a mesh.
            warnings.simplefilter("ignore")
            # If a file has fewer numbers than it promises, numpy before 2.3 warns and later ones
            # raise an error. The warning becomes an error too.
            warnings.filterwarnings("error", "string or file could not be read", DeprecationWarning)
            return _read_mesh_file_by_its_format(path, suffix, data, shoe)
    except MemoryError as error:
        raise BadInput(
            f"{fault}: is not a mesh that can be read (it needs more memory than there is)"
        ) from error
    # meshio's readers raise errors of many kinds, even SystemExit, which would end the program.
    except (Exception, SystemExit) as error:
        reason = f"{type(error).__name__}: {error}"
        if isinstance(error, SystemExit):
            reason = printed.getvalue().strip().removeprefix("Error: ")
        elif type(error) is ValueError:
            reason = str(error)
        raise BadInput(
            f"{fault}: is not a mesh that can be read "
            f"({' '.join(reason.split())[:LONGEST_REPEATED_MESHIO_MESSAGE]})"
        ) from error


def _read_mesh_file_by_its_format(
    path: Path, suffix: str, data: bytes, shoe: Shoe
) -> MeshFileContent:
    """The nodes, cells and groups of a mesh file, read by the reader of its format.

    The suffix and the first bytes of `data`, the content of the file, tell the format.
    """
    start = data.lstrip()[:1]
    # The mesher of CalculiX writes Abaqus text into files named .msh.
    if suffix == ".inp" or (suffix == ".msh" and start == b"*"):
        return read_mesh_from_inp_text(
            data.decode(errors="replace"), path.parent, _names_of_element_groups_of_shoe(shoe)
        )
    if suffix == ".msh" and is_text_in_gmsh_format_4(data):
        return read_mesh_in_gmsh_format_4(data.decode(errors="replace"))
    if suffix == ".vtu":
        check_decompressed_vtu_size_fits_memory(data)
    return content_of_meshio_mesh(meshio.read(path, "vtu" if suffix == ".vtu" else "gmsh"))


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


def _check_node_numbers_fit_memory(path: Path, fault: str) -> None:
    """Refuse an .msh file (text, format 2.2 or 4.1) with node numbers that would fill the memory.

    Other faults of the file are found later, when it is read.
    """
    # Format 2.2 has a node's number and three coordinates on each line. Format 4.1 has blocks of
    # nodes: the numbers of all nodes of a block come first, then the coordinates.
    numbers = np.zeros(0)
    with (
        contextlib.suppress(ValueError, IndexError, MemoryError, DeprecationWarning),
        path.open("rb") as file,
    ):
        version, binary = file.read(256).split()[1:3]
        file.seek(0)
        if binary != b"0" or not any(
            line.strip() == b"$Nodes" for line in iter(file.readline, b"")
        ):
            return
        blocks = int(file.readline().split()[0])
        if version.startswith(b"2"):
            numbers = _read_next_numbers_of_text_file(file, 4 * blocks)[::4]
        else:
            for _ in range(blocks):
                count = int(file.readline().split()[3])
                numbers = np.append(numbers, _read_next_numbers_of_text_file(file, count))
                _read_next_numbers_of_text_file(file, 3 * count)
    if numbers.size and numbers.max() > LARGEST_NODE_NUMBER_IN_FILE:
        raise BadInput(
            f"{fault}: numbers a node {numbers.max():.0f}; must be up to "
            f"{LARGEST_NODE_NUMBER_IN_FILE}"
        )


def _read_next_numbers_of_text_file(file: Any, count: int) -> Floats:
    """The next `count` numbers of an open text file, or fewer where the file has fewer."""
    return np.fromfile(file, count=max(count, 0), sep=" ")


def _xy_coordinates_of_plane_mesh(content: MeshFileContent, fault: str) -> Floats:
    """The coordinates x, y (n, 2) of all nodes of a mesh file, in the file's unit.

    BadInput is raised for a mesh that is not plane; its message begins with `fault`. Nodes that
    belong to no plane cell may have any z.
    """
    points = content.points
    used = [
        cells.ravel()
        for name, cells in content.cells.items()
        if name not in CELL_TYPES_BESIDES_PLANE_CELLS
    ]
    nodes = np.unique(np.concatenate(used)) if used else np.zeros(0, dtype=np.int64)
    nodes = nodes[(nodes >= 0) & (nodes < len(points))]
    if not np.isfinite(points).all():
        raise BadInput(f"{fault}: has coordinates that are not finite")
    if points.ndim != 2 or not 2 <= points.shape[1] <= 3 or not len(points):
        raise BadInput(f"{fault}: has no nodes with coordinates x, y")
    spatial = points.shape[1] == 3 and len(nodes) > 0
    if spatial and np.ptp(points[nodes, 2]) > 1e-9 * np.ptp(points[nodes]):
        raise BadInput(
            f"{fault}: is not plane, its z coordinates differ; must lie in the plane x, y"
        )
    return points[:, :2]


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
    outer_ends = list(ends)
    for name in names:
        for cell, rows in content.cell_groups.get(name, {}).items():
            if cell.startswith("line"):
                ends.append(content.cells[cell][rows, :2])
        ends += [content.edge_groups[name]] if name in content.edge_groups else []
        outer_ends += (
            [content.outline_edge_groups[name]] if name in content.outline_edge_groups else []
        )
    # A set of nodes is used only if the file has no edges of the same name.
    found = _numbers_of_element_edges_between_vertices(mesh, vertex[np.concatenate(ends)], fault)
    outlined = _numbers_of_element_edges_between_vertices(
        mesh, vertex[np.concatenate(outer_ends)], fault
    )
    outer = mesh.boundary_facets()
    found = np.union1d(found, np.intersect1d(outlined, outer))
    nodes = [content.node_groups[name] for name in names if name in content.node_groups]
    if len(found) or not nodes:
        return found
    inside = np.zeros(len(vertex), dtype=bool)
    inside[np.concatenate(nodes)] = True
    return np.intersect1d(
        _element_edges_with_all_nodes_in_set(plane, mesh, vertex, inside, fault), outer
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
