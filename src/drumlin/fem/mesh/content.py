"""The bytes of a mesh file and their digest, without loading a reader of meshes."""

import hashlib
from pathlib import Path

from drumlin.base.errors import DrumlinError
from drumlin.base.files import read_bytes

LARGEST_MESH = 50_000_000
"""Largest size [bytes] of a mesh file: some 500 000 nodes as text. A larger file is refused unread, so
that it cannot fill the memory.
"""


def mesh_bytes(path: Path) -> bytes:
    """The content of a mesh file.

    Raises
    ------
    BadInput
        for a file that cannot be read, is too long, or is not a file on a disk
    """
    return read_bytes(path, LARGEST_MESH, "a mesh", regular=True)


def content_digest(path: Path) -> str:
    """A digest of a mesh file's content; "none" for a file that cannot be read."""
    try:
        return hashlib.sha256(mesh_bytes(path)).hexdigest()[:16]
    except DrumlinError:
        return "none"
