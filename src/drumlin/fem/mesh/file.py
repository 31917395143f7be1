"""A shoe's mesh in a file: Gmsh, Abaqus/CalculiX or VTU, with named groups.

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
from typing import Any

import meshio
import numpy as np
import skfem

from drumlin.base.arrays import Floats, Ints
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
GROUP_NAMES = ("lining", "backing", "table", "shoe", "contact", "hinge", "actuation")
MOST_FILE_NODES = 1_000_000
LARGEST_NUMBER = 10_000_000  # of a node in an .msh file: its reader makes an array of that length
METRES_PER_UNIT = {"m": 1.0, "mm": 1e-3}


def write_mesh(path: Path, mesh: Any, shoe: Shoe) -> None:
    """Write a shoe's mesh in the brake's frame [m] with its groups: .msh (Gmsh 2.2), .inp or .vtu.

    The eight-node quadrilaterals of an .inp file lack the centre node of quad2. Raises BadInput for
    another suffix.
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
    members = {
        name: np.isin(np.arange(len(cells)), elements) for name, elements in subdomains.items()
    }
    nodes = {name: np.isin(np.arange(len(xy)), along) for name, along in edges.items()}
    content = meshio.Mesh(
        _spatial(xy),
        [(cell, cells)],
        cell_data={name: [inside.astype(np.int32)] for name, inside in members.items()},
        point_data={name: inside.astype(np.int32) for name, inside in nodes.items()},
    )
    meshio.write(path, content, file_format="vtu")


def _spatial(xy: Floats) -> Floats:
    return np.column_stack([xy, np.zeros(len(xy))])


def read_mesh(path: Path, shoe: Shoe, radius: float, key: str = "mesh") -> Any:
    """A user's mesh of a shoe [in shoe.mesh_unit and shoe.mesh_frame], in the shoe's frame [m].

    Raises BadInput, naming `key` and the file, for a file that cannot be read or used.
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
    said = io.StringIO()
    try:
        with (
            contextlib.redirect_stdout(said),
            contextlib.redirect_stderr(said),
            warnings.catch_warnings(),
        ):
            warnings.simplefilter("ignore")  # what is wrong with the mesh is found below
            # numpy before 2.3 warns where newer ones refuse: counts that promise other numbers than
            # there are.
            warnings.filterwarnings("error", "string or file could not be read", DeprecationWarning)
            raw = _raw(path, suffix, data)
    except MemoryError as error:
        raise BadInput(
            f"{fault}: is not a mesh that can be read (it needs more memory than there is)"
        ) from error
    except (Exception, SystemExit) as error:  # meshio's readers fail in their own many ways
        gave_up = isinstance(error, SystemExit)
        reason = (
            said.getvalue().strip().removeprefix("Error: ")
            if gave_up
            else f"{type(error).__name__}: {error}"
        )
        raise BadInput(
            f"{fault}: is not a mesh that can be read ({' '.join(reason.split())[:120]})"
        ) from error
    if len(raw.points) > MOST_FILE_NODES:
        raise BadInput(f"{fault}: has {len(raw.points)} nodes; must have at most {MOST_FILE_NODES}")
    points = _plane_points(raw, fault) * METRES_PER_UNIT[shoe.mesh_unit]
    if shoe.mesh_frame == "brake":
        points = shoe.own_points(points)
    cell, cells, points = _plane_cells(raw, points, fault)
    mesh = _with_groups(raw, cell, *_mesh(cell, cells, points, fault), cells, fault)
    return check(mesh, shoe, radius, fault)


def _raw(path: Path, suffix: str, data: bytes) -> Any:
    """The mesh of a file as meshio.Mesh; `data` is its content."""
    if suffix == ".inp":
        return read_inp(data.decode(errors="replace"))
    if suffix == ".vtu":
        check_unpacked(data)
    return meshio.read(path, "vtu" if suffix == ".vtu" else "gmsh")


def _check_numbers(path: Path, fault: str) -> None:
    """Refuse node numbers in a text .msh (2.2, 4.1) that would take all memory; what else is wrong
    is found later.
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
    """The next `count` numbers of a file, or what there is of them."""
    return np.fromfile(file, count=max(count, 0), sep=" ")


def _plane_points(raw: Any, fault: str) -> Floats:
    """x, y of all nodes (n, 2), in the file's unit."""
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


def _plane_cells(raw: Any, points: Floats, fault: str) -> tuple[str, Ints, Floats]:
    """Type and nodes (m, k) of the plane cells, with centre nodes where the file's quadrilaterals
    lack them.
    """
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
        return cell, cells, points
    centres = (
        points[cells[:, 4:]].sum(axis=1) / 2 - points[cells[:, :4]].sum(axis=1) / 4
    )  # of the same shape
    return (
        "quad9",
        np.column_stack([cells, len(points) + np.arange(len(cells))]),
        np.vstack([points, centres]),
    )


def _mesh(cell: str, cells: Ints, points: Floats, fault: str) -> tuple[Any, Ints]:
    """skfem's mesh, and the number there of each node of the file that is a corner of a cell (-1:
    of none).
    """
    kind = next(kind for kind in MESH_KINDS.values() if kind.cell == cell)
    used, numbered = np.unique(cells, return_inverse=True)
    numbered = numbered.reshape(cells.shape)
    corners = 3 if cell.startswith("triangle") else 4
    check_cells(numbered, corners, fault)
    mesh = kind.mesh(np.ascontiguousarray(points[used].T), np.ascontiguousarray(numbered.T))
    vertex = np.full(len(points), -1)
    vertices = np.unique(cells[:, :corners])
    vertex[vertices] = np.arange(len(vertices))
    return mesh, vertex


def _with_groups(raw: Any, cell: str, mesh: Any, vertex: Ints, cells: Ints, fault: str) -> Any:
    """The mesh with the named groups of the file: subdomains from its cells, boundaries from edges
    or nodes.
    """
    subdomains, boundaries = {}, {}
    filed = "quad8" if cell == "quad9" and "quad9" not in raw.cells_dict else cell
    edge = kind_of(mesh).edge
    for name, members in _named_cells(raw).items():
        if name not in GROUP_NAMES:
            continue
        if len(members.get(filed, ())):
            subdomains[name] = members[filed]
        if len(members.get(edge, ())):
            boundaries[name] = _facets(
                mesh, vertex[raw.cells_dict[edge][members[edge], :2]], f"{fault}: group {name}"
            )
    corners = len(mesh.t)
    outer = mesh.boundary_facets()
    for name, nodes in _named_nodes(raw).items():
        if name not in GROUP_NAMES or name in boundaries:
            continue
        inside = np.zeros(len(vertex), dtype=bool)
        inside[nodes] = True
        ends = cells[:, :corners]
        pairs = np.stack([ends, np.roll(ends, -1, axis=1)], axis=-1)
        whole = inside[pairs].all(axis=-1)
        if cells.shape[1] > corners:
            whole &= inside[cells[:, corners : 2 * corners]]
        found = np.intersect1d(_facets(mesh, vertex[pairs[whole]], fault), outer)
        if len(found):
            boundaries[name] = found
    return dataclasses.replace(mesh, _subdomains=subdomains, _boundaries=boundaries)


def _facets(mesh: Any, ends: Ints, fault: str) -> Ints:
    """Numbers of the facets between the vertices `ends` (n, 2), each once."""
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
    """Group name -> cell type -> numbers of its cells of that type."""
    groups: dict[str, dict[str, Ints]] = {}
    for name, members in raw.cell_sets_dict.items():
        if not name.startswith("gmsh:"):
            groups[name.lower()] = dict(members)
    tags = raw.cell_data_dict.get("gmsh:physical", {})
    for name, (tag, dim) in raw.field_data.items():
        for cell, values in tags.items():  # the same number may stand for a line and for a surface
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
    """Group name -> numbers of its nodes."""
    groups = {name.lower(): np.asarray(members) for name, members in raw.point_sets.items()}
    for name, values in raw.point_data.items():
        if ":" not in name and _is_membership(values):
            groups[name.lower()] = np.flatnonzero(values)
    return groups


def _is_membership(values: Any) -> bool:
    values = np.asarray(values)
    return values.ndim == 1 and bool(np.isin(values, (0, 1)).all())
