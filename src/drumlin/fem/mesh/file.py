"""A shoe's mesh in a file: Gmsh, Abaqus/CalculiX or VTU, with named groups.

A named group is a set of cells or edges (Gmsh's physical names, ELSET, SURFACE), a set of nodes
(NSET), or an array of cells or points that is 1 on the members and 0 elsewhere (VTU). A set of
nodes names the outer edges whose nodes all belong to the set. Capital letters do not matter. The
key `groups` of a shoe names groups that the file calls otherwise, by name or by number.
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
import skfem

from drumlin.base.arrays import Bools, Floats, Ints
from drumlin.base.errors import BadInput, reason_of
from drumlin.base.files import replacing
from drumlin.brake.brake import Shoe
from drumlin.fem.mesh.abaqus import write_inp
from drumlin.fem.mesh.arc import MESH_KINDS, mesh_kind_of
from drumlin.fem.mesh.check import check_cell_nodes, check_shoe_mesh
from drumlin.fem.mesh.contact_surface import move_contact_nodes_onto_surface
from drumlin.fem.mesh.content import read_mesh_bytes
from drumlin.fem.mesh.content_of_file import FileContent, rounding_errors_of_coordinates
from drumlin.fem.mesh.edges import nodes_along_edges
from drumlin.fem.mesh.from_file import ShoeMesh
from drumlin.fem.mesh.inp import read_inp
from drumlin.fem.mesh.msh4 import is_msh4, read_msh4
from drumlin.fem.mesh.of_meshio import content_of_meshio_mesh
from drumlin.fem.mesh.plane_cells import (
    BESIDE,
    PlaneCells,
    make_plane_cells_of_one_kind,
)
from drumlin.fem.mesh.vtu import check_unpacked_size

FORMATS = (".msh", ".inp", ".vtu")
"""The suffixes of mesh files that drumlin reads and writes."""
GROUP_NAMES = ("lining", "backing", "table", "shoe", "contact", "hinge", "actuation")
"""The names of groups that a shoe may need; groups with other names are passed over."""
MOST_FILE_NODES = 1_000_000
"""Largest number of nodes of a mesh in a file; a file with more is refused to save memory."""
LARGEST_NUMBER = 10_000_000
"""Largest number of a node in an .msh file; a file with a larger number is refused.

meshio's reader makes an array as long as the largest number, which could fill the memory.
"""
METRES_PER_UNIT = {"m": 1.0, "mm": 1e-3, "in": 0.0254}
"""Metres per unit of length of a mesh file."""
LONGEST_REASON = 160
"""Largest number of characters that a refusal repeats of the error of meshio's reader."""


def write_mesh(path: Path, mesh: Any, shoe: Shoe) -> None:
    """Write a shoe's mesh in the brake's frame [m] with its groups: .msh (Gmsh 2.2), .inp or .vtu.

    The eight-node quadrilaterals of an .inp file lack the centre node of quad2. Raises BadInput for
    another suffix.
    """
    if path.suffix not in FORMATS:
        raise BadInput(
            f"--format = {path.suffix[1:]!r}: unknown format of a mesh; allowed: msh, inp, vtu"
        )
    basis = skfem.Basis(mesh, mesh_kind_of(mesh).element(), intorder=1)
    cells = basis.element_dofs.T
    edges = {name: nodes_along_edges(basis, facets) for name, facets in mesh.boundaries.items()}
    xy = shoe.points(basis.doflocs).T
    with replacing(path) as partial:
        if path.suffix == ".inp":
            nodes = {name: np.unique(along) for name, along in edges.items()}
            write_inp(partial, xy, mesh_kind_of(mesh).cell, cells, mesh.subdomains, nodes)
        elif path.suffix == ".vtu":
            _write_vtu(partial, xy, mesh_kind_of(mesh).cell, cells, mesh.subdomains, edges)
        else:
            _write_msh(partial, xy, mesh_kind_of(mesh), cells, mesh.subdomains, edges)


def _write_msh(
    path: Path,
    xy: Floats,
    kind: Any,
    cells: Ints,
    subdomains: Mapping[str, Ints],
    edges: Mapping[str, Ints],
) -> None:
    """Write a mesh with its groups as a Gmsh file of format 2.2."""
    # Gmsh wants the ends of an edge first and its middle node last.
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
    content = meshio.Mesh(_points_in_space(xy), blocks, cell_data=data, field_data=names)
    meshio.write(path, content, file_format="gmsh22", binary=False)


def _write_vtu(
    path: Path,
    xy: Floats,
    cell: str,
    cells: Ints,
    subdomains: Mapping[str, Ints],
    edges: Mapping[str, Ints],
) -> None:
    """Write a mesh as a .vtu file, whose groups are arrays that are 1 on the members."""
    members = {
        name: np.isin(np.arange(len(cells)), elements) for name, elements in subdomains.items()
    }
    nodes = {name: np.isin(np.arange(len(xy)), along) for name, along in edges.items()}
    content = meshio.Mesh(
        _points_in_space(xy),
        [(cell, cells)],
        cell_data={name: [inside.astype(np.int32)] for name, inside in members.items()},
        point_data={name: inside.astype(np.int32) for name, inside in nodes.items()},
    )
    meshio.write(path, content, file_format="vtu")


def _points_in_space(xy: Floats) -> Floats:
    """Points (n, 3) in space for points (n, 2) in the plane: z is zero."""
    return np.column_stack([xy, np.zeros(len(xy))])


def read_mesh(path: Path, shoe: Shoe, radius: float, key: str = "mesh") -> Any:
    """A user's mesh of a shoe [in shoe.mesh_unit and shoe.mesh_frame], in the shoe's frame [m].

    Raises BadInput, naming `key` and the file, for a file that cannot be read or used.
    """
    return read_shoe_mesh(path, shoe, radius, key).mesh


def read_shoe_mesh(path: Path, shoe: Shoe, radius: float, key: str = "mesh") -> ShoeMesh:
    """A user's mesh as `read_mesh`, with what was moved and passed over."""
    fault = f"{key} = '{path}'"
    content = _read_content(path, shoe, fault)
    if len(content.points) > MOST_FILE_NODES:
        raise BadInput(
            f"{fault}: has {len(content.points)} nodes; must have at most {MOST_FILE_NODES}"
        )
    unit = METRES_PER_UNIT[shoe.mesh_unit]
    points = _plane_points(content, fault)
    rounding = content.rounding
    if rounding is None:
        rounding = rounding_errors_of_coordinates(points)
    points = points * unit
    if shoe.mesh_frame == "brake":
        points = shoe.own_points(points)
    plane = make_plane_cells_of_one_kind(content, points, fault)
    # Nodes that were added stand where other nodes put them.
    slack = np.zeros((len(plane.points), 2))
    slack[: len(points)] = rounding * unit
    mesh, vertex = _mesh_and_vertices(plane.cell, plane.cells, plane.points, fault)
    nodal, _ = _mesh_and_vertices(plane.cell, plane.cells, slack, fault)
    mesh = _add_groups(content, shoe, plane, mesh, vertex, fault)
    mesh = check_shoe_mesh(mesh, shoe, radius, fault, content.group_names)
    contact = move_contact_nodes_onto_surface(mesh, nodal.doflocs, shoe, radius)
    if contact.mesh is not mesh:
        check_shoe_mesh(
            contact.mesh, shoe, radius, f"{fault}: with its contact line on the {shoe.surface.word}"
        )
    return ShoeMesh(contact.mesh, contact, content.notes + plane.notes)


def _read_content(path: Path, shoe: Shoe, fault: str) -> FileContent:
    """The content of a mesh file. Raises BadInput, led by `fault`, for an unreadable file."""
    try:
        regular = stat.S_ISREG(path.stat().st_mode)
    except (OSError, ValueError) as error:
        raise BadInput(f"{fault}: no such file ({reason_of(error)})") from error
    suffix = path.suffix.lower()
    if not regular or suffix not in FORMATS:
        raise BadInput(
            f"{fault}: is not a mesh: must be a file whose name ends in {', '.join(FORMATS)}"
        )
    data = read_mesh_bytes(path)
    if suffix == ".msh":
        _check_node_numbers(path, fault)
    printed = io.StringIO()
    try:
        with (
            contextlib.redirect_stdout(printed),
            contextlib.redirect_stderr(printed),
            warnings.catch_warnings(),
        ):
            # Warnings are silenced, since the checks of drumlin find the faults of a mesh.
            warnings.simplefilter("ignore")
            # numpy before 2.3 warns, and newer ones raise, where a file has fewer numbers than its
            # counts promise.
            warnings.filterwarnings("error", "string or file could not be read", DeprecationWarning)
            return _read_by_format(path, suffix, data, shoe)
    except MemoryError as error:
        raise BadInput(
            f"{fault}: is not a mesh that can be read (it needs more memory than there is)"
        ) from error
    # meshio's readers raise errors of many kinds.
    except (Exception, SystemExit) as error:
        reason = f"{type(error).__name__}: {error}"
        if isinstance(error, SystemExit):
            reason = printed.getvalue().strip().removeprefix("Error: ")
        elif type(error) is ValueError:
            reason = str(error)
        raise BadInput(
            f"{fault}: is not a mesh that can be read ({' '.join(reason.split())[:LONGEST_REASON]})"
        ) from error


def _read_by_format(path: Path, suffix: str, data: bytes, shoe: Shoe) -> FileContent:
    """The nodes, cells and groups of a mesh file with the bytes `data`.

    Suffix and first bytes together tell the format.
    """
    start = data.lstrip()[:1]
    # The mesher of CalculiX writes Abaqus text into files named .msh.
    if suffix == ".inp" or (suffix == ".msh" and start == b"*"):
        return read_inp(data.decode(errors="replace"), path.parent, _names_of_element_groups(shoe))
    if suffix == ".msh" and is_msh4(data):
        return read_msh4(data.decode(errors="replace"))
    if suffix == ".vtu":
        check_unpacked_size(data)
    return content_of_meshio_mesh(meshio.read(path, "vtu" if suffix == ".vtu" else "gmsh"))


def _names_of_element_groups(shoe: Shoe) -> list[str]:
    """The names in the file of the groups of elements that a shoe may have."""
    names = ("lining", "backing", "table", "shoe")
    return list(itertools.chain.from_iterable(shoe.groups.names_of(name) for name in names))


def _check_node_numbers(path: Path, fault: str) -> None:
    """Refuse node numbers in a text .msh file (2.2, 4.1) that would take all memory.

    Other faults of the file are found later, by its reader.
    """
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
            numbers = _next_numbers(file, 4 * blocks)[::4]
        else:
            for _ in range(blocks):
                count = int(file.readline().split()[3])
                numbers = np.append(numbers, _next_numbers(file, count))
                _next_numbers(file, 3 * count)
    if numbers.size and numbers.max() > LARGEST_NUMBER:
        raise BadInput(
            f"{fault}: numbers a node {numbers.max():.0f}; must be up to {LARGEST_NUMBER}"
        )


def _next_numbers(file: Any, count: int) -> Floats:
    """The next `count` numbers of an open text file, or fewer where the file has fewer."""
    return np.fromfile(file, count=max(count, 0), sep=" ")


def _plane_points(content: FileContent, fault: str) -> Floats:
    """Coordinates x, y (n, 2) of all nodes, in the file's unit.

    Raises BadInput, led by `fault`, for a mesh that is not plane. Nodes that belong to no plane
    cell may lie anywhere.
    """
    points = content.points
    used = [cells.ravel() for name, cells in content.cells.items() if name not in BESIDE]
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


def _mesh_and_vertices(cell: str, cells: Ints, points: Floats, fault: str) -> tuple[Any, Ints]:
    """skfem's mesh of the cells, and the number (n,) of each of the file's nodes as its vertex.

    The number is -1 for a node that is no corner of a cell.
    """
    kind = next(kind for kind in MESH_KINDS.values() if kind.cell == cell)
    used, numbered = np.unique(cells, return_inverse=True)
    numbered = numbered.reshape(cells.shape)
    corners = 3 if cell.startswith("triangle") else 4
    check_cell_nodes(numbered, corners, fault)
    mesh = kind.mesh(np.ascontiguousarray(points[used].T), np.ascontiguousarray(numbered.T))
    vertex = np.full(len(points), -1)
    vertices = np.unique(cells[:, :corners])
    vertex[vertices] = np.arange(len(vertices))
    return mesh, vertex


def _add_groups(
    content: FileContent, shoe: Shoe, plane: PlaneCells, mesh: Any, vertex: Ints, fault: str
) -> Any:
    """The mesh with the groups of the file as its subdomains and boundaries.

    Subdomains come from cells, boundaries from edges or from nodes. `vertex` (n,) is the number in
    the mesh of each point that is a corner.
    """
    subdomains, boundaries = {}, {}
    for name in GROUP_NAMES:
        wanted = shoe.groups.names_of(name)
        for alias in wanted:
            if alias in content.broken:
                raise BadInput(f"{fault}: group {name}: {content.broken[alias]}")
        found = _find_cells(content, plane, wanted)
        if len(found):
            subdomains[name] = found
        facets = _find_facets(content, plane, mesh, vertex, wanted, f"{fault}: group {name}")
        if len(facets):
            boundaries[name] = facets
    mesh = dataclasses.replace(mesh, _subdomains=subdomains, _boundaries=boundaries)
    _check_given_names(content, shoe, fault)
    return mesh


def _check_given_names(content: FileContent, shoe: Shoe, fault: str) -> None:
    """Refuse names in the key `groups` that the file does not have."""
    for name in shoe.groups.given:
        missing = [
            alias for alias in shoe.groups.names_of(name) if alias not in content.group_names
        ]
        if missing:
            found = ", ".join(content.group_names) or "none"
            raise BadInput(
                f"{fault}: groups.{name} = {missing[0]!r}: not in the file; found: {found}"
            )


def _find_cells(content: FileContent, plane: PlaneCells, names: list[str]) -> Ints:
    """Numbers of the elements in the groups of these names, each once."""
    found = [np.zeros(0, dtype=np.int64)]
    for name in names:
        for cell, rows in content.cell_groups.get(name, {}).items():
            if cell in plane.parent:
                found.append(plane.made_of(cell, rows))
    return np.unique(np.concatenate(found))


def _find_facets(
    content: FileContent,
    plane: PlaneCells,
    mesh: Any,
    vertex: Ints,
    names: list[str],
    fault: str,
) -> Ints:
    """Numbers of the facets in the groups of these names: of edges, or else of nodes."""
    ends = [np.zeros((0, 2), dtype=np.int64)]
    outer_ends = list(ends)
    for name in names:
        for cell, rows in content.cell_groups.get(name, {}).items():
            if cell.startswith("line"):
                ends.append(content.cells[cell][rows, :2])
        ends += [content.edge_groups[name]] if name in content.edge_groups else []
        outer_ends += [content.outer_groups[name]] if name in content.outer_groups else []
    # A set of nodes counts only where the file has no edges of the same name.
    found = _facets_between_vertices(mesh, vertex[np.concatenate(ends)], fault)
    outlined = _facets_between_vertices(mesh, vertex[np.concatenate(outer_ends)], fault)
    outer = mesh.boundary_facets()
    found = np.union1d(found, np.intersect1d(outlined, outer))
    nodes = [content.node_groups[name] for name in names if name in content.node_groups]
    if len(found) or not nodes:
        return found
    inside = np.zeros(len(vertex), dtype=bool)
    inside[np.concatenate(nodes)] = True
    return np.intersect1d(_facets_between_nodes(plane, mesh, vertex, inside, fault), outer)


def _facets_between_nodes(
    plane: PlaneCells, mesh: Any, vertex: Ints, inside: Bools, fault: str
) -> Ints:
    """The facets whose nodes all belong to a set of nodes, `inside` (n,).

    A set without any middle node names the corners of its edges alone.
    """
    corners = plane.corners
    ends = plane.cells[:, :corners]
    pairs = np.stack([ends, np.roll(ends, -1, axis=1)], axis=-1)
    whole: Bools = np.all(inside[pairs], axis=-1)
    middles = plane.cells[:, corners : 2 * corners]
    if middles.size and inside[middles].any():
        whole &= inside[middles] | plane.added[middles]
    return _facets_between_vertices(mesh, vertex[pairs[whole]], fault)


def _facets_between_vertices(mesh: Any, ends: Ints, fault: str) -> Ints:
    """Numbers of the facets between the vertices `ends` (n, 2), each once."""
    # A facet is found by one number that both its vertices make.
    key = mesh.facets[0].astype(np.int64) * mesh.nvertices + mesh.facets[1]
    order = np.argsort(key)
    low, high = np.sort(ends, axis=1).T
    wanted = np.unique(low * mesh.nvertices + high)
    place = order[np.minimum(np.searchsorted(key, wanted, sorter=order), len(key) - 1)]
    strange = np.count_nonzero(key[place] != wanted)
    if strange:
        raise BadInput(f"{fault}: {strange} of its {len(wanted)} edges are not edges of the cells")
    return np.sort(place)
