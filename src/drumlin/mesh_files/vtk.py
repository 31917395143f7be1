"""The check of a legacy VTK mesh file (.vtk) before meshio reads it."""

import re

DATASET_OF_VTK_FILE_PATTERN = re.compile(rb"^\s*DATASET\s+(\w+)", re.IGNORECASE | re.MULTILINE)
"""Pattern of the line that names the kind of a VTK file's mesh, which is group 1."""
COUNTS_IN_VTK_FILE_PATTERN = re.compile(
    rb"^(?:POINTS|CELLS|CELL_TYPES|OFFSETS|CONNECTIVITY|CELL_DATA|POINT_DATA|SCALARS|FIELD|METADATA"
    rb"|LOOKUP_TABLE)\b([^\n]*)",
    re.IGNORECASE | re.MULTILINE,
)
"""Pattern of the lines of a VTK file with numbers of points, cells or values, in group 1."""


def check_vtk_file_is_unstructured_and_fits_memory(data: bytes) -> None:
    """Refuse the content of a .vtk file that has no cells of its own or states false counts.

    meshio makes arrays as long as the counts say, which could fill the memory. A point or a cell
    takes more than a byte of the file. Other faults of the file are found later, when it is read.

    Raises
    ------
    ValueError
        with a line that says why the file is refused
    """
    found = DATASET_OF_VTK_FILE_PATTERN.search(data)
    if found is None:
        raise ValueError("has no line DATASET: it is no legacy VTK file")
    kind = found[1].decode().upper()
    if kind != "UNSTRUCTURED_GRID":
        raise ValueError(f"DATASET {kind} is not read; must be UNSTRUCTURED_GRID")
    for counts in COUNTS_IN_VTK_FILE_PATTERN.findall(data):
        for word in counts.split():
            if word.isdigit() and int(word[:20]) > len(data):
                raise ValueError(
                    f"states {word.decode()[:20]} points, cells or values, but is shorter"
                )
