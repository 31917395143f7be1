"""Meshes of shoes in files of Gmsh, Abaqus/CalculiX or VTU, with named groups.

A group is a set of cells or edges with that name (Gmsh's physical names, ELSET), a set of nodes
(NSET), or cell or point data of that name that is 1 on its members and 0 elsewhere (VTU). A set of
nodes names the outer edges whose nodes all belong to it. Capital letters do not matter.
"""

import contextlib
import dataclasses
import io
import stat
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import meshio
import numpy as np
import skfem

from drumlin.base.arrays import Bools, Floats, Ints
from drumlin.base.errors import BadInput, reason_of
from drumlin.base.files import replacing
from drumlin.brake.brake import Shoe
from drumlin.fem.mesh.abaqus import read_inp, write_inp
from drumlin.fem.mesh.arc import MESH_KINDS, kind_of
from drumlin.fem.mesh.check import check, check_cells
from drumlin.fem.mesh.content import mesh_bytes
from drumlin.fem.mesh.edges import edge_nodes
from drumlin.fem.mesh.vtu import check_unpacked

FORMATS = (".msh", ".inp", ".vtu")
"""The suffixes of files that are read and written."""
GROUP_NAMES = ("lining", "backing", "table", "shoe", "contact", "hinge", "actuation")
"""The names of groups that a shoe may need; groups with other names are passed over."""
MOST_FILE_NODES = 1_000_000
"""Largest number of nodes of a mesh in a file; a file with more is refused to save memory."""
LARGEST_NUMBER = 10_000_000
"""Largest number of a node in an .msh file. Its reader makes an array of that length, so that larger
numbers are refused to save memory.
"""
METRES_PER_UNIT = {"m": 1.0, "mm": 1e-3}
"""Metres per unit of length of a mesh file."""


def write_mesh(path: Path, mesh: Any, shoe: Shoe) -> None:
    """Write a shoe's mesh in the brake's frame [m] with its groups: .msh (Gmsh 2.2), .inp or .vtu.

    The eight-node quadrilaterals of an .inp file lack the centre node of quad2.

    Parameters
    ----------
    path : of the file, whose suffix says the format
    mesh : skfem's mesh in the shoe's frame
    shoe : the shoe

    Raises
    ------
    BadInput
        for another suffix
    """
    if path.suffix not in FORMATS:
        raise BadInput(
            f"--format = {path.suffix[1:]!r}: unknown format of a mesh; allowed: msh, inp, vtu"
        )
    basis = skfem.Basis(mesh, kind_of(mesh).element(), intorder=1)
    cells = basis.element_dofs.T
    edges = {name: edge_nodes(basis, facets) for name, facets in mesh.boundaries.items()}
    xy = shoe.points(basis.doflocs).T
    with replacing(path) as partial:
        if path.suffix == ".inp":
            nodes = {name: np.unique(along) for name, along in edges.items()}
            write_inp(partial, xy, kind_of(mesh).cell, cells, mesh.subdomains, nodes)
        elif path.suffix == ".vtu":
            _write_vtu(partial, xy, kind_of(mesh).cell, cells, mesh.subdomains, edges)
        else:
            _write_msh(partial, xy, kind_of(mesh), cells, mesh.subdomains, edges)


def _write_msh(
    path: Path,
    xy: Floats,
    kind: Any,
    cells: Ints,
    subdomains: Mapping[str, Ints],
    edges: Mapping[str, Ints],
) -> None:
    """Write a Gmsh 2.2 file: a physical group for each subdomain and each named line of edges."""
    blocks = [(kind.cell, cells[elements]) for elements in subdomains.values()]
    for along in edges.values():
        # meshio has the middle nodes of an edge behind both ends.
        ends_first = [0, -1, *range(1, len(along) - 1)]
        blocks.append((kind.edge, along[ends_first].T))
    dimensions = [2] * len(subdomains) + [1] * len(edges)
    names = {}
    for number, name in enumerate([*subdomains, *edges], start=1):
        names[name] = np.array([number, dimensions[number - 1]])
    tags = []
    for number, (_, members) in enumerate(blocks, start=1):
        tags.append(np.full(len(members), number, dtype=np.int32))
    data = {"gmsh:physical": tags, "gmsh:geometrical": tags}
    content = meshio.Mesh(_spatial(xy), blocks, cell_data=data, field_data=names)
    meshio.write(path, content, file_format="gmsh22", binary=False)


def _write_vtu(
    path: Path,
    xy: Floats,
    cell: str,
    cells: Ints,
    subdomains: Mapping[str, Ints],
    edges: Mapping[str, Ints],
) -> None:
    """Write a VTU file: cell or point data for each group, 1 on its members and 0 elsewhere."""
    cell_data, point_data = {}, {}
    for name, elements in subdomains.items():
        inside = np.isin(np.arange(len(cells)), elements)
        cell_data[name] = [inside.astype(np.int32)]
    for name, along in edges.items():
        inside = np.isin(np.arange(len(xy)), along)
        point_data[name] = inside.astype(np.int32)
    content = meshio.Mesh(_spatial(xy), [(cell, cells)], cell_data=cell_data, point_data=point_data)
    meshio.write(path, content, file_format="vtu")


def _spatial(xy: Floats) -> Floats:
    """Points (n, 3) from points xy (n, 2) of the plane z = 0."""
    return np.column_stack([xy, np.zeros(len(xy))])


def read_mesh(path: Path, shoe: Shoe, radius: float, key: str = "mesh") -> Any:
    """A user's mesh of a shoe from its file, in the shoe's frame [m].

    Parameters
    ----------
    path : of the file, in shoe.mesh_unit and shoe.mesh_frame
    shoe : the shoe
    radius : of the drum [m]; on a plane the length of the pad
    key : name of the file's key in messages

    Raises
    ------
    BadInput
        for a file that cannot be read or used; the message names `key` and the file
    """
    fault = f"{key} = '{path}'"
    try:
        regular = stat.S_ISREG(path.stat().st_mode)
    except (OSError, ValueError) as error:
        raise BadInput(f"{fault}: no such file ({reason_of(error)})") from error
    suffix = path.suffix.lower()
    if not regular or suffix not in FORMATS:
        raise BadInput(
            f"{fault}: is not a mesh: must be a file whose name ends in {', '.join(FORMATS)}"
        )
    data = mesh_bytes(path)
    if suffix == ".msh":
        _check_numbers(path, fault)
    raw = _quietly_read(path, suffix, data, fault)
    if len(raw.points) > MOST_FILE_NODES:
        raise BadInput(f"{fault}: has {len(raw.points)} nodes; must have at most {MOST_FILE_NODES}")
    points = _plane_points(raw, fault) * METRES_PER_UNIT[shoe.mesh_unit]
    if shoe.mesh_frame == "brake":
        points = shoe.own_points(points)
    found = _plane_cells(raw, points, fault)
    numbered = _mesh(found, fault)
    mesh = _with_groups(raw, found, numbered, fault)
    return check(mesh, shoe, radius, fault)


def _quietly_read(path: Path, suffix: str, data: bytes, fault: str) -> Any:
    """The mesh of a file as meshio.Mesh, without its reader's printing and warnings.

    Raises
    ------
    BadInput
        for a file that the reader cannot read
    """
    printed = io.StringIO()
    try:
        with (
            contextlib.redirect_stdout(printed),
            contextlib.redirect_stderr(printed),
            warnings.catch_warnings(),
        ):
            # Faults of the mesh are found by our own checks.
            warnings.simplefilter("ignore")
            # numpy before 2.3 warns, and newer ones raise, where a file has fewer numbers than its
            # counts promise.
            warnings.filterwarnings("error", "string or file could not be read", DeprecationWarning)
            return _raw(path, suffix, data)
    except MemoryError as error:
        raise BadInput(
            f"{fault}: is not a mesh that can be read (it needs more memory than there is)"
        ) from error
    # meshio's readers raise errors of many kinds.
    except (Exception, SystemExit) as error:
        reason = f"{type(error).__name__}: {error}"
        if isinstance(error, SystemExit):
            reason = printed.getvalue().strip().removeprefix("Error: ")
        raise BadInput(
            f"{fault}: is not a mesh that can be read ({' '.join(reason.split())[:120]})"
        ) from error


def _raw(path: Path, suffix: str, data: bytes) -> Any:
    """The mesh of a file as meshio.Mesh; `data` is its content."""
    if suffix == ".inp":
        return read_inp(data.decode(errors="replace"))
    if suffix == ".vtu":
        check_unpacked(data)
    return meshio.read(path, "vtu" if suffix == ".vtu" else "gmsh")


def _check_numbers(path: Path, fault: str) -> None:
    """Refuse node numbers in a text .msh (2.2, 4.1) that would take all memory.

    Other faults are found later.
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
            numbers = _numbers(file, 4 * blocks)[::4]
        else:
            for _ in range(blocks):
                count = int(file.readline().split()[3])
                numbers = np.append(numbers, _numbers(file, count))
                _numbers(file, 3 * count)
    if numbers.size and numbers.max() > LARGEST_NUMBER:
        raise BadInput(
            f"{fault}: numbers a node {numbers.max():.0f}; must be up to {LARGEST_NUMBER}"
        )


def _numbers(file: Any, count: int) -> Floats:
    """The next `count` numbers of a file, or all that are left."""
    return np.fromfile(file, count=max(count, 0), sep=" ")


def _plane_points(raw: Any, fault: str) -> Floats:
    """The coordinates x, y (n, 2) of all nodes, in the file's unit."""
    points = np.asarray(raw.points, dtype=float)
    if not np.isfinite(points).all():
        raise BadInput(f"{fault}: has coordinates that are not finite")
    if points.ndim != 2 or not 2 <= points.shape[1] <= 3 or not len(points):
        raise BadInput(f"{fault}: has no nodes with coordinates x, y")
    if points.shape[1] == 3 and np.ptp(points[:, 2]) > 1e-9 * np.ptp(points):
        raise BadInput(
            f"{fault}: is not plane, its z coordinates differ; must lie in the plane x, y"
        )
    return points[:, :2]


class _PlaneCells(NamedTuple):
    """The plane cells of a file: meshio's type, nodes (m, k), and the points (n, 2) of all nodes."""

    cell: str
    cells: Ints
    points: Floats


def _plane_cells(raw: Any, points: Floats, fault: str) -> _PlaneCells:
    """The plane cells of a file, with centre nodes for quadrilaterals that lack them."""
    kinds = {block.type for block in raw.cells if block.dim > 1}
    allowed = [kind.cell for kind in MESH_KINDS.values()] + ["quad8"]
    if len(kinds) != 1 or not kinds <= set(allowed):
        raise BadInput(
            f"{fault}: has cells {sorted(kinds)}; allowed is one kind of: {', '.join(allowed)}"
        )
    (cell,) = kinds
    cells = raw.cells_dict[cell].astype(np.int64)
    if not len(cells) or cells.min() < 0 or cells.max() >= len(points):
        raise BadInput(f"{fault}: has cells with nodes that the file does not define")
    if cell != "quad8":
        return _PlaneCells(cell, cells, points)
    # A centre node that leaves the shape of the eight-node quadrilateral as it is.
    centres = points[cells[:, 4:]].sum(axis=1) / 2 - points[cells[:, :4]].sum(axis=1) / 4
    with_centres = np.column_stack([cells, len(points) + np.arange(len(cells))])
    return _PlaneCells("quad9", with_centres, np.vstack([points, centres]))


class _NumberedMesh(NamedTuple):
    """skfem's mesh, and the number in it of each node of the file that is a cell's corner, else -1."""

    mesh: Any
    vertex: Ints


def _mesh(plane: _PlaneCells, fault: str) -> _NumberedMesh:
    """The mesh of the plane cells."""
    cell, cells, points = plane
    kind = next(kind for kind in MESH_KINDS.values() if kind.cell == cell)
    used, numbered = np.unique(cells, return_inverse=True)
    numbered = numbered.reshape(cells.shape)
    corners = 3 if cell.startswith("triangle") else 4
    check_cells(numbered, corners, fault)
    mesh = kind.mesh(np.ascontiguousarray(points[used].T), np.ascontiguousarray(numbered.T))
    vertex = np.full(len(points), -1)
    vertices = np.unique(cells[:, :corners])
    vertex[vertices] = np.arange(len(vertices))
    return _NumberedMesh(mesh, vertex)


def _with_groups(raw: Any, plane: _PlaneCells, numbered: _NumberedMesh, fault: str) -> Any:
    """The mesh with the named groups of the file.

    Subdomains come from the file's cells, boundaries from its edges or its sets of nodes.
    """
    mesh, vertex = numbered
    subdomains, boundaries = {}, {}
    filed = plane.cell
    if plane.cell == "quad9" and "quad9" not in raw.cells_dict:
        filed = "quad8"
    edge = kind_of(mesh).edge
    for name, members in _named_cells(raw).items():
        if name not in GROUP_NAMES:
            continue
        if len(members.get(filed, ())):
            subdomains[name] = members[filed]
        if len(members.get(edge, ())):
            ends = vertex[raw.cells_dict[edge][members[edge], :2]]
            boundaries[name] = _facets(mesh, ends, f"{fault}: group {name}")
    outer = mesh.boundary_facets()
    for name, nodes in _named_nodes(raw).items():
        if name not in GROUP_NAMES or name in boundaries:
            continue
        inside = np.zeros(len(vertex), dtype=bool)
        inside[nodes] = True
        ends = vertex[_whole_edges(plane.cells, inside, len(mesh.t))]
        found = np.intersect1d(_facets(mesh, ends, fault), outer)
        if len(found):
            boundaries[name] = found
    return dataclasses.replace(mesh, _subdomains=subdomains, _boundaries=boundaries)


def _whole_edges(cells: Ints, inside: Bools, corners: int) -> Ints:
    """The end nodes (e, 2) of the edges of cells (m, k) all of whose nodes are `inside` (n,)."""
    ends = cells[:, :corners]
    pairs = np.stack([ends, np.roll(ends, -1, axis=1)], axis=-1)
    whole = inside[pairs].all(axis=-1)
    if cells.shape[1] > corners:
        whole &= inside[cells[:, corners : 2 * corners]]
    return pairs[whole]


def _facets(mesh: Any, ends: Ints, fault: str) -> Ints:
    """The numbers of the facets between the vertices `ends` (n, 2), each once."""
    key = mesh.facets[0].astype(np.int64) * mesh.nvertices + mesh.facets[1]
    order = np.argsort(key)
    low, high = np.sort(ends, axis=1).T
    wanted = np.unique(low * mesh.nvertices + high)
    place = order[np.minimum(np.searchsorted(key, wanted, sorter=order), len(key) - 1)]
    strange = np.count_nonzero(key[place] != wanted)
    if strange:
        raise BadInput(f"{fault}: {strange} of its {len(wanted)} edges are not edges of the cells")
    return np.sort(place)


def _named_cells(raw: Any) -> dict[str, dict[str, Ints]]:
    """The members of each named group, by the type of their cells."""
    groups: dict[str, dict[str, Ints]] = {}
    for name, members in raw.cell_sets_dict.items():
        if not name.startswith("gmsh:"):
            groups[name.lower()] = dict(members)
    tags = raw.cell_data_dict.get("gmsh:physical", {})
    for name, (tag, dim) in raw.field_data.items():
        # One number may stand for a line and for a surface.
        for cell, values in tags.items():
            members = np.flatnonzero(np.asarray(values) == tag)
            if len(members) and meshio._mesh.topological_dimension[cell] == dim:
                groups.setdefault(name.lower(), {}).setdefault(cell, members)
    for name, by_cell in raw.cell_data_dict.items():
        if ":" not in name:
            for cell, values in by_cell.items():
                if _is_membership(values):
                    groups.setdefault(name.lower(), {})[cell] = np.flatnonzero(values)
    return groups


def _named_nodes(raw: Any) -> dict[str, Ints]:
    """The nodes of each named group."""
    groups = {name.lower(): np.asarray(members) for name, members in raw.point_sets.items()}
    for name, values in raw.point_data.items():
        if ":" not in name and _is_membership(values):
            groups[name.lower()] = np.flatnonzero(values)
    return groups


def _is_membership(values: Any) -> bool:
    """Whether data says of each cell or node if it is a member: 1 or 0."""
    values = np.asarray(values)
    return values.ndim == 1 and bool(np.isin(values, (0, 1)).all())
