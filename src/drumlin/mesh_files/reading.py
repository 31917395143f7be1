"""The reading of mesh files of all formats: Gmsh, Abaqus, VTK, Nastran, MED and universal files."""

import contextlib
import io
import stat
import warnings
from collections.abc import Collection
from pathlib import Path

import meshio
import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import BadInput, system_message_of_error
from drumlin.mesh_files.content import read_bytes_of_mesh_file
from drumlin.mesh_files.content_of_file import MeshFileContent
from drumlin.mesh_files.inp import read_mesh_from_inp_text
from drumlin.mesh_files.med import read_mesh_in_med_file
from drumlin.mesh_files.msh4 import is_text_in_gmsh_format_4, read_mesh_in_gmsh_format_4
from drumlin.mesh_files.nastran import read_mesh_in_nastran_bulk_data
from drumlin.mesh_files.of_meshio import content_of_meshio_mesh
from drumlin.mesh_files.plane_cells import CELL_TYPES_BESIDES_PLANE_CELLS
from drumlin.mesh_files.unv import read_mesh_in_universal_file
from drumlin.mesh_files.vtk import check_vtk_file_is_unstructured_and_fits_memory
from drumlin.mesh_files.vtu import check_decompressed_vtu_size_fits_memory

NASTRAN_FILE_SUFFIXES = (".bdf", ".nas", ".dat")
"""The suffixes of Nastran bulk data files."""
MESH_FILE_SUFFIXES = (".msh", ".inp", ".vtu", ".vtk", *NASTRAN_FILE_SUFFIXES, ".med", ".unv")
"""The suffixes of mesh files that drumlin reads."""
MOST_NODES_IN_MESH_FILE = 1_000_000
"""Largest number of nodes of a mesh in a file; a file with more nodes is refused to save memory."""
LARGEST_NODE_NUMBER_IN_FILE = 10_000_000
"""Largest label (number) of a node in an .msh file; a file with a larger label is refused.

meshio's reader makes an array as long as the largest number, which could fill the memory.
"""
LONGEST_REPEATED_MESHIO_MESSAGE = 160
"""Largest number of characters of meshio's own error message that drumlin's message repeats."""


def read_content_of_mesh_file(
    path: Path, fault: str, wanted: Collection[str] = ()
) -> MeshFileContent:
    """Read the content of a mesh file: nodes, cells and groups.

    Parameters
    ----------
    path : path of the file
    fault : beginning of each message
    wanted : names of the groups of elements that are wanted. If only some instances of an assembly
        have elements in these groups, the other instances are ignored.

    Raises
    ------
    BadInput
        for a file that cannot be read, or has too many nodes
    """
    suffix = _suffix_of_mesh_file(path, fault)
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
            content = _read_mesh_file_by_its_format(path, suffix, data, wanted)
    except MemoryError as error:
        raise BadInput(
            f"{fault}: is not a mesh that can be read (it needs more memory than there is)"
        ) from error
    except ImportError as error:
        raise BadInput(f"{fault}: {error}") from error
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
    if len(content.points) > MOST_NODES_IN_MESH_FILE:
        raise BadInput(
            f"{fault}: has {len(content.points)} nodes; must have at most {MOST_NODES_IN_MESH_FILE}"
        )
    return content


def _suffix_of_mesh_file(path: Path, fault: str) -> str:
    """The suffix of a mesh file in lower case; BadInput for a path that is no mesh file."""
    try:
        regular = stat.S_ISREG(path.stat().st_mode)
    except (OSError, ValueError) as error:
        is_absent = isinstance(error, FileNotFoundError)
        reason = "" if is_absent else f" ({system_message_of_error(error)})"
        raise BadInput(f"{fault}: no such file{reason}") from error
    suffix = path.suffix.lower()
    if not regular or suffix not in MESH_FILE_SUFFIXES:
        raise BadInput(
            f"{fault}: is not a mesh: must be a file whose name ends in "
            f"{', '.join(MESH_FILE_SUFFIXES)}"
        )
    return suffix


def _read_mesh_file_by_its_format(
    path: Path, suffix: str, data: bytes, wanted: Collection[str]
) -> MeshFileContent:
    """The nodes, cells and groups of a mesh file, read by the reader of its format.

    The suffix and the first bytes of `data`, the content of the file, tell the format.
    """
    start = data.lstrip()[:1]
    # The mesher of CalculiX writes Abaqus text into files named .msh.
    if suffix == ".inp" or (suffix == ".msh" and start == b"*"):
        return read_mesh_from_inp_text(data.decode(errors="replace"), path.parent, wanted)
    if suffix == ".msh" and is_text_in_gmsh_format_4(data):
        return read_mesh_in_gmsh_format_4(data.decode(errors="replace"))
    if suffix in NASTRAN_FILE_SUFFIXES:
        return read_mesh_in_nastran_bulk_data(data.decode(errors="replace"))
    if suffix == ".unv":
        return read_mesh_in_universal_file(data.decode(errors="replace"))
    if suffix == ".med":
        return read_mesh_in_med_file(data)
    if suffix == ".vtu":
        check_decompressed_vtu_size_fits_memory(data)
    if suffix == ".vtk":
        check_vtk_file_is_unstructured_and_fits_memory(data)
    format_of_meshio = {".vtu": "vtu", ".vtk": "vtk"}.get(suffix, "gmsh")
    return content_of_meshio_mesh(meshio.read(path, format_of_meshio))


def _check_node_numbers_fit_memory(path: Path, fault: str) -> None:
    """Refuse an .msh file (text, format 2.2) with node numbers that would fill the memory.

    Other faults of the file are found later, when it is read.
    """
    # Each line of a node has its number and three coordinates.
    numbers = np.zeros(0)
    with (
        contextlib.suppress(ValueError, IndexError, MemoryError, DeprecationWarning),
        path.open("rb") as file,
    ):
        version, binary = file.read(256).split()[1:3]
        if binary != b"0" or not version.startswith(b"2"):
            return
        file.seek(0)
        if any(line.strip() == b"$Nodes" for line in iter(file.readline, b"")):
            count = int(file.readline().split()[0])
            numbers = np.fromfile(file, count=max(4 * count, 0), sep=" ")[::4]
    if numbers.size and numbers.max() > LARGEST_NODE_NUMBER_IN_FILE:
        raise BadInput(
            f"{fault}: numbers a node {numbers.max():.0f}; must be up to "
            f"{LARGEST_NODE_NUMBER_IN_FILE}"
        )


def xy_coordinates_of_plane_mesh(content: MeshFileContent, fault: str) -> Floats:
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
