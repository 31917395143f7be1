"""Files are read within limits, and written whole or not at all.

Texts are in UTF-8 in every locale. A regular file that is written over is replaced: the new content
gets a temporary name beside the file, and a rename follows. Links are followed, and permissions
stay. Pipes and devices are written to.
"""

import json
import os
import re
import stat
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from pathlib import Path

from drumlin.base.errors import BadInput, file_fault

LONGEST_SUFFIX = 16
"""Characters of a suffix up to which a temporary name takes it over. A longer suffix would make the
name too long for the file system, and no program needs it.
"""

_inputs: ContextVar[list[os.stat_result] | None] = ContextVar("inputs", default=None)


@contextmanager
def inputs_kept() -> Iterator[None]:
    """Protect every file that the block reads, or that `keep_input` names, from overwriting."""
    token = _inputs.set([])
    try:
        yield
    finally:
        _inputs.reset(token)


def keep_input(path: Path) -> None:
    """Count the file at `path` among the inputs, even if it is never read.

    A file is known by its place on the disk, so that a second name for it counts as well.
    """
    inputs = _inputs.get()
    with suppress(OSError, ValueError):
        if inputs is not None and path.is_file():
            inputs.append(path.stat())


# reading


def read_bytes(path: Path, most: int, what: str, *, regular: bool = False) -> bytes:
    """The content of a file of up to `most` bytes.

    Parameters
    ----------
    path : of a file, a pipe or a device
    most : bytes that are read at most
    what : the words for the file in the line of a refusal, such as "a brake file"
    regular : whether only a file on a disk is accepted, because the content is read again later

    Raises
    ------
    BadInput
        where the file cannot be read, or is longer
    """
    try:
        found = path.stat()
        on_disk = stat.S_ISREG(found.st_mode)
        if regular and not on_disk and not stat.S_ISDIR(found.st_mode):
            raise BadInput(f"{path}: is a pipe or a device; {what} must be a file")
        # The size of a file of the system's own (/proc) is known only once it is read.
        if regular and on_disk and not found.st_size:
            raise BadInput(f"{path}: is empty; not {what}")
        with path.open("rb") as file:
            data = file.read(most + 1)
    # A NUL in the name, or a letter that the locale does not have, raises a ValueError.
    except (OSError, ValueError) as error:
        raise file_fault(path, "read", error) from error
    if len(data) > most:
        raise BadInput(f"{path}: larger than {most} bytes; not {what}")
    keep_input(path)
    return data


def read_text(path: Path, most: int, what: str) -> str:
    """The text of a file of up to `most` bytes, in UTF-8.

    Raises BadInput as `read_bytes` does, and for bytes that are not UTF-8.
    """
    data = read_bytes(path, most, what)
    try:
        return data.decode("utf-8-sig").replace("\r\n", "\n")
    except UnicodeDecodeError as error:
        raise BadInput(
            f"{path}: is not {what}: no UTF-8 text ({error.reason} at byte {error.start})"
        ) from error


# writing


def check_outputs(*paths: Path | None) -> None:
    """Raise BadInput where a path must not or cannot be written, before a computation starts.

    Refused are a folder, a disk, one of the inputs, a second output in the same file, and any .toml
    file, since brake and sweep files are written by hand.
    """
    targets = []
    for path in filter(None, paths):
        target, found = _target(path)
        if target in targets and (found is None or stat.S_ISREG(found.st_mode)):
            raise BadInput(f"{path}: is written twice; give each output a file of its own")
        targets.append(target)


def check_folder(path: Path) -> None:
    """Raise BadInput where `path` cannot be a folder, since a file stands there or above it."""
    try:
        folders = (path, *path.absolute().parents)
        above = next(folder for folder in folders if os.path.lexists(folder))
        if not above.is_dir():
            raise BadInput(f"{path}: cannot be written (not a folder: {above})")
    except (OSError, ValueError, StopIteration) as error:
        raise file_fault(path, "written", error) from error


def _target(path: Path) -> tuple[Path, os.stat_result | None]:
    """The file that a path leads to through links, and its status; None where no file is yet."""
    try:
        found = path.stat() if path.exists() else None
        target = Path(os.path.realpath(path))
        if found is None and target.is_symlink():
            raise BadInput(f"{path}: cannot be written (links that lead in a circle)")
    except (OSError, ValueError) as error:
        raise file_fault(path, "written", error) from error
    if ".toml" in {path.suffix.lower(), target.suffix.lower()}:
        raise BadInput(
            f"{path}: must not be a .toml file: nothing is written over brake and sweep files"
        )
    if found is not None:
        if stat.S_ISDIR(found.st_mode):
            raise BadInput(f"{path}: cannot be written (is a folder)")
        if stat.S_ISBLK(found.st_mode) or stat.S_ISSOCK(found.st_mode):
            raise BadInput(f"{path}: cannot be written (is a disk or a socket)")
        if any(os.path.samestat(found, each) for each in _inputs.get() or ()):
            raise BadInput(f"{path}: is one of the files that are read; must not be written over")
    return target, found


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A temporary path, with the suffix of `path`, that becomes `path` if the block ends well.

    A regular file is replaced by a rename and keeps its permissions. A link stays, and its target
    is replaced. The content for a pipe or a device is sent to it in the end. Raises BadInput where
    `check_outputs` does or where the system refuses, and NoAnswer where the disk is full.
    """
    target, found = _target(path)
    stream = None if found is None else _stream(path, found)
    folder = target.parent if stream is None else Path(tempfile.gettempdir())
    suffix = path.suffix if len(path.suffix) <= LONGEST_SUFFIX else ""
    partial = folder / f".drumlin-{os.urandom(6).hex()}{suffix}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        # Nobody else reads the content before the permissions of the file that it replaces are set.
        partial.touch(0o666 if found is None else 0o600, exist_ok=False)
        try:
            yield partial
            if stream is not None:
                with open(stream, "wb", closefd=stream is path) as file:
                    file.write(partial.read_bytes())
                return
            if found is not None:
                # Few users may give a file away, and some systems cannot.
                with suppress(OSError, AttributeError):
                    os.chown(partial, found.st_uid, found.st_gid)
                partial.chmod(stat.S_IMODE(found.st_mode) & 0o777)
            partial.replace(target)
        finally:
            partial.unlink(missing_ok=True)
    # A letter of the name that the locale does not have raises a UnicodeEncodeError.
    except (OSError, UnicodeEncodeError) as error:
        raise file_fault(path, "written", error) from error


def _stream(path: Path, found: os.stat_result) -> Path | int | None:
    """The pipe, device or stream that is written to and not replaced; None for other files.

    A file that standard output or error goes to is written to by the number of the stream: a new
    file in its place would lose the printed lines.
    """
    if not stat.S_ISREG(found.st_mode):
        return path
    for handle in (1, 2):
        with suppress(OSError):
            if os.path.samestat(os.fstat(handle), found):
                return handle
    return None


def write_text(path: Path, text: str) -> None:
    """Write a text file in UTF-8, whole or not at all."""
    with replacing(path) as partial:
        # The text may hold paths with bytes that are in no encoding.
        partial.write_text(text, encoding="utf-8", errors="replace")


def write_new(path: Path, text: str) -> None:
    """Write a text file in UTF-8 where no file stands yet, whole or not at all.

    Raises BadInput for a file that is there already, or a path that cannot be written.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with path.open("x", encoding="utf-8", errors="replace") as file:
            try:
                file.write(text)
            except OSError:
                path.unlink(missing_ok=True)
                raise
    except (OSError, ValueError) as error:
        raise file_fault(path, "written", error) from error


def write_json(path: Path, data: object) -> None:
    """Write a JSON file whole or not at all. Raises ValueError for numbers that are not finite."""
    write_text(path, json.dumps(data, indent=1, allow_nan=False) + "\n")


# The beginning of a text that a spreadsheet takes for a formula. Numbers and ranges such as
# "-70 to 55.1" do not match.
_FORMULA = re.compile(r"[=@\t\r]|[-+](?![-+0-9.,;: eEto]*\Z)")


def cell(value: object) -> object:
    """A cell for a spreadsheet: a text that would be a formula is led by an apostrophe."""
    return f"'{value}" if isinstance(value, str) and _FORMULA.match(value) else value
