"""The writing of meshes with named groups to Gmsh, Abaqus/CalculiX and VTU files."""

from collections.abc import Mapping
from pathlib import Path

import meshio
import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.base.errors import BadInput
from drumlin.base.files import temporary_file_replacing_output
from drumlin.mesh_files.abaqus import write_mesh_as_inp_file

WRITTEN_MESH_FILE_SUFFIXES = (".msh", ".inp", ".vtu")
"""The suffixes of mesh files that drumlin writes."""
MESHIO_EDGE_OF_CELL = {
    "triangle": "line",
    "triangle6": "line3",
    "quad": "line",
    "quad9": "line3",
}
"""meshio's name of the edges of each kind of cells that is written, by its name of the cells."""


def write_mesh_to_file(
    path: Path,
    xy: Floats,
    cell: str,
    cells: Ints,
    subdomains: Mapping[str, Ints],
    edges: Mapping[str, Ints],
) -> None:
    """Write a mesh with its groups to a file.

    In an .inp file quadratic quadrilaterals have eight nodes, without the centre node.

    Parameters
    ----------
    path : path of the file, whose suffix is .msh (Gmsh 2.2), .inp or .vtu
    xy : (n, 2) coordinates of the nodes [m]
    cell : meshio's name of the cells' type
    cells : (m, k) nodes of each cell in meshio's order
    subdomains : indices of the cells of each group of cells, by the group's name
    edges : (2 or 3, k) nodes of the edges of each group of edges, from end to end, by its name

    Raises
    ------
    BadInput
        for another suffix
    """
    if path.suffix not in WRITTEN_MESH_FILE_SUFFIXES:
        raise BadInput(
            f"--format = {path.suffix[1:]!r}: unknown format of a mesh; allowed: msh, inp, vtu"
        )
    write = {
        ".msh": _write_mesh_as_gmsh_file,
        ".inp": write_mesh_as_inp_file,
        ".vtu": _write_mesh_as_vtu_file,
    }[path.suffix]
    with temporary_file_replacing_output(path) as partial:
        write(partial, xy, cell, cells, subdomains, edges)


def _write_mesh_as_gmsh_file(
    path: Path,
    xy: Floats,
    cell: str,
    cells: Ints,
    subdomains: Mapping[str, Ints],
    edges: Mapping[str, Ints],
) -> None:
    """Write a mesh with its groups as a Gmsh file of format 2.2."""
    # Gmsh's order of nodes on an edge is both ends, then the middle node. Each group becomes a
    # block of cells or edges with a number of its own.
    blocks = [(cell, cells[elements]) for elements in subdomains.values()]
    blocks += [
        (MESHIO_EDGE_OF_CELL[cell], along[[0, -1, *range(1, len(along) - 1)]].T)
        for along in edges.values()
    ]
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
