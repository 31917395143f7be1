"""Where files are read and written.

What is read has a limit, and is text in UTF-8 in every locale. What is written replaces a regular file, whole or not at
all: a temporary name beside it, then a rename. Links are followed, permissions stay; pipes and devices are written to.
"""

import errno
import json
import os
import re
import select
import stat
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from pathlib import Path

from drumlin.errors import BadInput, DrumlinError, file_fault

PATIENCE = 5.0  # s without a byte, after which a pipe is given up
PAUSE = 0.01
"""Seconds between two attempts to read or write a file that is not ready."""
LONGEST_SUFFIX = 16

_inputs: ContextVar[set[tuple[int, int]] | None] = ContextVar("inputs", default=None)


@contextmanager
def inputs_kept() -> Iterator[None]:
    """While the block runs, no file that it reads (or that `keep_input` names) is written over."""
    token = _inputs.set(set())
    try:
        yield
    finally:
        _inputs.reset(token)


def keep_input(path: Path) -> None:
    """Count `path` among the inputs, by what file it is and not by its name, whether or not it is read later."""
    with suppress(OSError, ValueError):
        _keep(path.stat())


def _keep(found: os.stat_result) -> None:
    inputs = _inputs.get()
    if inputs is not None and stat.S_ISREG(found.st_mode):
        inputs.add((found.st_dev, found.st_ino))


# reading


def read_bytes(path: Path, most: int, what: str, *, regular: bool = False) -> bytes:
    """The content of a file of up to `most` bytes, which is to be `what` ("a brake file").

    Parameters
    ----------
    path : of a file, a pipe or a device
    most : bytes that are read at most
    what : the words for the file in the line of a refusal
    regular : whether a file on a disk alone will do, since the content is read again later

    Raises
    ------
    BadInput
        where the file cannot be read, is longer, or where no byte comes from it for PATIENCE seconds
    """
    try:
        handle = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_CLOEXEC", 0))
    except (OSError, ValueError) as error:  # a ValueError of a NUL, or of a letter that the locale has not
        raise file_fault(path, "read", error) from error
    try:
        found = os.fstat(handle)
        _keep(found)
        on_disk = stat.S_ISREG(found.st_mode)
        if regular and not on_disk and not stat.S_ISDIR(found.st_mode):
            raise BadInput(f"{path}: is a pipe or a device; {what} must be a file")
        # The size of a file of the system's own (/proc) is known only once it is read.
        if regular and on_disk and not found.st_size:
            raise BadInput(f"{path}: is empty; not {what}")
        too_long = on_disk and found.st_size > most
        data = b"" if too_long else _drained(handle, path, most, not on_disk)
    except (OSError, ValueError) as error:
        raise file_fault(path, "read", error) from error
    finally:
        os.close(handle)
    if too_long or len(data) > most:
        raise BadInput(f"{path}: larger than {most} bytes; not {what}")
    return data


def _drained(handle: int, path: Path, most: int, stream: bool) -> bytes:
    """All that comes from an open file, or a little more than `most` bytes of it."""
    data = bytearray()
    heard = time.monotonic()
    while len(data) <= most:
        left = heard + PATIENCE - time.monotonic()
        if left <= 0 or (stream and not select.select([handle], [], [], left)[0]):
            raise BadInput(f"{path}: nothing has come from it for {PATIENCE:g} s")
        try:
            chunk = os.read(handle, most + 1 - len(data))
        except BlockingIOError:
            time.sleep(PAUSE)
            continue
        if not chunk:
            break
        data += chunk
        heard = time.monotonic()
    return bytes(data)


def read_text(path: Path, most: int, what: str) -> str:
    """The text of a file of up to `most` bytes, in UTF-8; raises BadInput as `read_bytes`, and for other bytes."""
    data = read_bytes(path, most, what)
    try:
        return data.decode("utf-8-sig").replace("\r\n", "\n")
    except UnicodeDecodeError as error:
        raise BadInput(f"{path}: is not {what}: no UTF-8 text ({error.reason} at byte {error.start})") from error


# writing


def check_output(path: Path) -> None:
    """Raise BadInput where `path` may not or cannot be written over, before anything is computed for it.

    That is a folder, a disk, one of the inputs, and any .toml file: brake and sweep files are written by hand.
    """
    _target(path)


def check_outputs(*paths: Path | None) -> None:
    """`check_output` for some files that are written in one run; raises BadInput also where two are the same file."""
    targets = []
    for path in paths:
        if path is not None:
            target, found = _target(path)
            if target in targets and (found is None or stat.S_ISREG(found.st_mode)):
                raise BadInput(f"{path}: is written twice; give each output a file of its own")
            targets.append(target)


def check_folder(path: Path) -> None:
    """Raise BadInput where `path` cannot be a folder of outputs, since a file stands there or above it."""
    try:
        above = next(folder for folder in (path, *path.absolute().parents) if os.path.lexists(folder))
        if not above.is_dir():
            raise BadInput(f"{path}: cannot be written (not a folder: {above})")
    except (OSError, ValueError, StopIteration) as error:
        raise file_fault(path, "written", error) from error


def _target(path: Path) -> tuple[Path, os.stat_result | None]:
    """The file that is meant by a path, links followed, and what stands there (None: nothing yet)."""
    try:
        found = path.stat() if path.exists() else None
        target = path if found is not None and not stat.S_ISREG(found.st_mode) else Path(os.path.realpath(path))
        if found is None and target.is_symlink():
            raise BadInput(f"{path}: cannot be written (links that lead in a circle)")
    except (OSError, ValueError) as error:
        raise file_fault(path, "written", error) from error
    if ".toml" in {path.suffix.lower(), target.suffix.lower()}:
        raise BadInput(f"{path}: must not be a .toml file: nothing is written over brake and sweep files")
    if found is not None:
        if stat.S_ISDIR(found.st_mode):
            raise BadInput(f"{path}: cannot be written (is a folder)")
        if stat.S_ISBLK(found.st_mode) or stat.S_ISSOCK(found.st_mode):
            raise BadInput(f"{path}: cannot be written (is a disk or a socket)")
        if (found.st_dev, found.st_ino) in (_inputs.get() or ()):
            raise BadInput(f"{path}: is one of the files that are read; must not be written over")
    return target, found


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A temporary path, with the suffix of `path`, that becomes `path` if the block ends well.

    A regular file is replaced by a rename and keeps its permissions; a link stays and its target is replaced; what is
    written for a pipe or a device is sent to it in the end. Raises BadInput where `check_output` does or the system
    does not allow it, NoAnswer where the disk is full.
    """
    target, found = _target(path)
    try:
        standard = None if found is None else _standard(found)
        if found is not None and (standard is not None or not stat.S_ISREG(found.st_mode)):
            import tempfile  # noqa: PLC0415  (for pipes and devices only)

            with tempfile.TemporaryDirectory(prefix="drumlin-") as folder:
                partial = Path(folder) / f"output{_suffix(path)}"
                yield partial
                _send(partial.read_bytes(), path, standard)
            return
        target.parent.mkdir(parents=True, exist_ok=True)
        partial = target.with_name(f".drumlin-{os.urandom(6).hex()}{_suffix(path)}")
        try:
            os.close(os.open(partial, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666 if found is None else 0o600))
            yield partial
            if found is not None:
                _same_owner(partial, found)
            partial.replace(target)
        finally:
            partial.unlink(missing_ok=True)
    except DrumlinError:
        raise
    except (OSError, UnicodeEncodeError) as error:  # the locale may lack a letter of the name
        raise file_fault(path, "written", error) from error


def _suffix(path: Path) -> str:
    return path.suffix if len(path.suffix) <= LONGEST_SUFFIX else ""


def _standard(found: os.stat_result) -> int | None:
    """The handle, 1 or 2, that has this regular file open: a new file in its place would lose what is printed."""
    for handle in (1, 2):
        with suppress(OSError):
            if stat.S_ISREG(found.st_mode) and os.path.samestat(os.fstat(handle), found):
                return handle
    return None


def _same_owner(partial: Path, found: os.stat_result) -> None:
    """Give a file the owner, as far as that is allowed, and the permissions of another."""
    if hasattr(os, "chown"):
        with suppress(OSError):
            os.chown(partial, found.st_uid, found.st_gid)
    partial.chmod(stat.S_IMODE(found.st_mode) & 0o777)


def _send(data: bytes, path: Path, standard: int | None) -> None:
    """Write to a pipe or device, or a standard stream. Raises BadInput where no one reads it for PATIENCE seconds."""
    handle = _opened(path) if standard is None else os.dup(standard)
    try:
        while data:
            if not select.select([], [handle], [], PATIENCE)[1]:
                raise _unread(path)
            with suppress(BlockingIOError):
                data = data[os.write(handle, data) :]
    finally:
        os.close(handle)


def _opened(path: Path) -> int:
    """A handle to write to a pipe or device; the reader of a pipe may come later."""
    end = time.monotonic() + PATIENCE
    while True:
        try:
            return os.open(path, os.O_WRONLY | getattr(os, "O_NONBLOCK", 0))
        except OSError as error:
            if error.errno != errno.ENXIO or not path.is_fifo():
                raise
            if time.monotonic() > end:
                raise _unread(path) from error
            time.sleep(PAUSE)


def _unread(path: Path) -> BadInput:
    return BadInput(f"{path}: cannot be written (no one has read from it for {PATIENCE:g} s)")


def write_text(path: Path, text: str) -> None:
    """Write a text file in UTF-8, whole or not at all."""
    with replacing(path) as partial:
        partial.write_text(text, encoding="utf-8", errors="replace")  # a path of undecodable bytes


def write_json(path: Path, data: object) -> None:
    """Write a JSON file whole or not at all. Raises ValueError for numbers that are not finite."""
    write_text(path, json.dumps(data, indent=1, allow_nan=False) + "\n")


_FORMULA = re.compile(r"[=@\t\r]|[-+](?![-+0-9.,;: eEto]*\Z)")  # "-70 to 55.1" is none


def cell(value: object) -> object:
    """A cell of a table for a spreadsheet: a text that it would take for a formula is led by an apostrophe."""
    return f"'{value}" if isinstance(value, str) and _FORMULA.match(value) else value
