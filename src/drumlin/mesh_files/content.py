"""The bytes of a mesh file and a digest of them, without loading a library that reads meshes."""

import hashlib
import re
from pathlib import Path

from drumlin.base.errors import DrumlinError
from drumlin.base.files import read_bytes

LARGEST_MESH_FILE_SIZE = 50_000_000
"""Largest size [bytes] of a mesh file: some 500 000 nodes as text.

A larger file is refused before it is read, so that it cannot fill the memory.
"""


def read_bytes_of_mesh_file(path: Path) -> bytes:
    """The content of a mesh file.

    Raises
    ------
    BadInput
        for a file that cannot be read, is too long, or is not a file on a disk
    """
    return read_bytes(path, LARGEST_MESH_FILE_SIZE, "a mesh", regular=True)


INCLUDE_LINE_PATTERN = re.compile(
    rb"^\s*\*include\s*,\s*input\s*=\s*([^\r\n,]+)", re.IGNORECASE | re.MULTILINE
)
"""Pattern of a line *INCLUDE in an Abaqus input file; group 1 is the name of the included file."""
LARGEST_INCLUDE_DEPTH = 8
"""Largest depth of input files that include each other by *INCLUDE.

Usual files have a depth of one or two. Without a limit a file that includes itself would never end.
"""


def digest_of_mesh_file(path: Path, depth: int = 0) -> str:
    """The digest of a mesh file and of the files that it includes: 16 hex digits of a SHA-256.

    For a file that cannot be read, "none" is returned. `depth` is 0 for the mesh file itself, 1 for
    a file that it includes, and so on.
    """
    try:
        data = read_bytes_of_mesh_file(path)
    except DrumlinError:
        return "none"
    # The digests of included files are digested too, in the order of their lines. The search for
    # the pattern takes long, and few files have its word.
    found = hashlib.sha256(data)
    may_include = depth < LARGEST_INCLUDE_DEPTH and b"*include" in data.lower()
    for name in INCLUDE_LINE_PATTERN.findall(data) if may_include else ():
        included = path.parent / name.decode(errors="replace").strip().strip("\"'")
        found.update(digest_of_mesh_file(included, depth + 1).encode())
    return found.hexdigest()[:16]
