"""Writing so that a stopped run leaves earlier results whole: a temporary name, then a rename."""

import hashlib
import json
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from drumlin.errors import BadInput


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A temporary path beside `path`, with its suffix, that becomes `path` if the block ends well.

    Raises BadInput where the folder cannot be made or written, and for a .toml file: brake files are written by hand.
    """
    if path.suffix.lower() == ".toml":
        raise BadInput(f"{path}: must not be a .toml file: nothing is written over brake and sweep files")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(prefix=f".{path.stem}-", suffix=path.suffix, dir=path.parent)
    except OSError as error:
        raise BadInput(f"{path}: cannot be written ({error.strerror})") from error
    os.close(handle)
    partial = Path(name)
    try:
        yield partial
        partial.chmod(0o644)
        partial.replace(path)
    finally:
        partial.unlink(missing_ok=True)


def write_text(path: Path, text: str) -> None:
    """Write a text file whole or not at all."""
    with replacing(path) as partial:
        partial.write_text(text, encoding="utf-8", errors="replace")  # a path of undecodable bytes


def write_json(path: Path, data: object) -> None:
    """Write a JSON file whole or not at all. Raises ValueError for numbers that are not finite."""
    write_text(path, json.dumps(data, indent=1, allow_nan=False) + "\n")


def content_digest(path: Path) -> str:
    """A digest of what is in a file; of one that cannot be read "none"."""
    try:
        with path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()[:16]
    except (OSError, ValueError):  # ValueError: a NUL in the path
        return "none"
