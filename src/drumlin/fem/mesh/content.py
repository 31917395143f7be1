"""What is in a mesh file, and a digest of it. Loads no reader of meshes."""

import hashlib
from pathlib import Path

from drumlin.base.errors import DrumlinError
from drumlin.base.files import read_bytes

LARGEST_MESH = 50_000_000
"""Bytes of a mesh file that are read at most: some 500 000 nodes as text. A longer file is refused
unread.
"""


def mesh_bytes(path: Path) -> bytes:
    """The content of a mesh file. Raises BadInput for one that cannot be read, is too long, or is
    no file on a disk.
    """
    return read_bytes(path, LARGEST_MESH, "a mesh", regular=True)


def content_digest(path: Path) -> str:
    """A digest of what is in a mesh file; of one that cannot be read "none"."""
    try:
        return hashlib.sha256(mesh_bytes(path)).hexdigest()[:16]
    except DrumlinError:
        return "none"
