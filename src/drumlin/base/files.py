"""Read files up to a largest size, and write files whole or not at all.

Texts are in UTF-8 in every locale. A regular file is never overwritten in place: the new content
goes into a temporary file in the same folder, which is then renamed to the file's name. Symbolic
links are followed, and the file keeps its permissions. Pipes and devices cannot be replaced, so
that the content is written to them directly.
"""

import codecs
import json
import os
import re
import stat
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from pathlib import Path

from drumlin.base.errors import BadInput, exception_for_unusable_file

LONGEST_TEMPORARY_FILE_SUFFIX = 16
"""Longest suffix, in characters, that a temporary file takes over from the file that it replaces.

A longer suffix is left out, because the temporary name could become too long for the file system.
No program that reads the file needs such a suffix.
"""

# The input files, which must not be overwritten. Each is listed by its status on the disk, which is
# the same under all names of a file. The list is None outside a block of
# `protect_input_files_within_block`.
_disk_statuses_of_protected_files: ContextVar[list[os.stat_result] | None] = ContextVar(
    "inputs", default=None
)


@contextmanager
def protect_input_files_within_block() -> Iterator[None]:
    """Protect the input files of a `with` block from being overwritten within the block.

    Input files are those that `read_bytes` reads in the block, and those that are given to
    `protect_file_from_being_overwritten`.
    """
    token = _disk_statuses_of_protected_files.set([])
    try:
        yield
    finally:
        _disk_statuses_of_protected_files.reset(token)


def protect_file_from_being_overwritten(path: Path) -> None:
    """Protect the file at `path` from being overwritten, even if it is never read.

    The protection lasts until the block of `protect_input_files_within_block` ends.
    It holds for all names of the file, such as links, which have the same number on the disk.
    """
    inputs = _disk_statuses_of_protected_files.get()
    with suppress(OSError, ValueError):
        if inputs is not None and path.is_file():
            inputs.append(path.stat())


def _is_protected_input_file(status: os.stat_result) -> bool:
    """Whether the file with this status on the disk must not be overwritten or deleted."""
    return any(
        os.path.samestat(status, each) for each in _disk_statuses_of_protected_files.get() or ()
    )


# The functions that read files follow.

_BYTE_ORDER_MARKS = (
    (codecs.BOM_UTF32_LE, "utf-32"),
    (codecs.BOM_UTF32_BE, "utf-32"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
    (codecs.BOM_UTF8, "utf-8-sig"),
)
"""Byte order marks, the first bytes of some text files, each with the encoding that it stands for.

The marks of UTF-32 are tested first, because one of them begins with the bytes of a UTF-16 mark.
"""


def read_bytes(path: Path, most: int, what: str, *, regular: bool = False) -> bytes:
    """Read the content of a file that has at most `most` bytes.

    Parameters
    ----------
    path : path of a file, a pipe or a device
    most : largest size of the file [bytes]
    what : what the file should be, for the error message, such as "a brake file"
    regular : whether pipes and devices are refused, because the file will be read a second time

    Raises
    ------
    BadInput
        if the file cannot be read or is larger than `most` bytes
    """
    try:
        found = path.stat()
        on_disk = stat.S_ISREG(found.st_mode)
        if regular and not on_disk and not stat.S_ISDIR(found.st_mode):
            raise BadInput(f"{path}: is a pipe or a device; {what} must be a file")
        # The test of the size also refuses files in /proc, whose size Linux states as 0.
        if regular and on_disk and not found.st_size:
            raise BadInput(f"{path}: is empty; not {what}")
        with path.open("rb") as file:
            # One byte more than allowed shows whether the file is too large.
            data = file.read(most + 1)
    # Python raises a ValueError for a NUL in the name or a letter that the locale cannot encode.
    except (OSError, ValueError) as error:
        raise exception_for_unusable_file(path, "read", error) from error
    if len(data) > most:
        raise BadInput(f"{path}: larger than {most} bytes; not {what}")
    protect_file_from_being_overwritten(path)
    return data


def read_text(path: Path, most: int, what: str) -> str:
    """Read the text of a file that has at most `most` bytes; parameters as of `read_bytes`.

    The text is in UTF-8, or in UTF-16 or UTF-32 with the mark at its beginning that Windows writes.
    Raises BadInput if the file cannot be read, is larger, or is in another encoding.
    """
    data = read_bytes(path, most, what)
    encoding = next((name for mark, name in _BYTE_ORDER_MARKS if data.startswith(mark)), "utf-8")
    try:
        text = data.decode(encoding)
    except UnicodeDecodeError as error:
        raise BadInput(
            f"{path}: is not {what}: no {encoding.removesuffix('-sig').upper()} text "
            f"({error.reason} at byte {error.start}); save it as UTF-8"
        ) from error
    # Every second byte of a plain text in UTF-16 is zero.
    if text.count("\0") * 3 > len(text) > 0:
        raise BadInput(
            f"{path}: is not {what}: no UTF-8 text (bytes of zero, as in UTF-16); save it as UTF-8"
        )
    return text.replace("\r\n", "\n")


# The functions that write files follow.


def check_output_files_are_writable(*paths: Path | None) -> None:
    """Raise BadInput if one of the output files must not or cannot be written.

    It is called before a long computation, whose result would be lost. It refuses a folder, a disk,
    an input file (see `protect_input_files_within_block`), a path that two outputs share, and any
    .toml file, because users write brake and sweep files by hand.
    """
    targets = []
    for path in filter(None, paths):
        target, found = _resolved_path_and_file_status_of_output(path)
        if target in targets and (found is None or stat.S_ISREG(found.st_mode)):
            raise BadInput(f"{path}: is written twice; give each output a file of its own")
        targets.append(target)


def check_path_can_be_folder(path: Path) -> None:
    """Raise BadInput if no folder can be made at `path`, because it or a parent of it is a file."""
    try:
        # All missing folders can be made if the nearest parent that exists is a folder.
        folders = (path, *path.absolute().parents)
        above = next(folder for folder in folders if os.path.lexists(folder))
        if not above.is_dir():
            raise BadInput(f"{path}: cannot be written (not a folder: {above})")
    except (OSError, ValueError, StopIteration) as error:
        raise exception_for_unusable_file(path, "written", error) from error


def _resolved_path_and_file_status_of_output(path: Path) -> tuple[Path, os.stat_result | None]:
    """The path to which an output path leads through symbolic links, and the file's status there.

    The status on the disk is None if no file exists there yet. Raises BadInput if the file must not
    or cannot be written, as `check_output_files_are_writable` says.
    """
    try:
        found = path.stat() if path.exists() else None
        target = Path(os.path.realpath(path))
        if found is None and target.is_symlink():
            raise BadInput(f"{path}: cannot be written (links that lead in a circle)")
    except (OSError, ValueError) as error:
        raise exception_for_unusable_file(path, "written", error) from error
    # Brake and sweep files are written by hand, and no output may replace them.
    if ".toml" in {path.suffix.lower(), target.suffix.lower()}:
        raise BadInput(
            f"{path}: must not be a .toml file: nothing is written over brake and sweep files"
        )
    if found is not None:
        if stat.S_ISDIR(found.st_mode):
            raise BadInput(f"{path}: cannot be written (is a folder)")
        # Writing to a disk device would destroy its file system.
        if stat.S_ISBLK(found.st_mode) or stat.S_ISSOCK(found.st_mode):
            raise BadInput(f"{path}: cannot be written (is a disk or a socket)")
        if _is_protected_input_file(found):
            raise BadInput(f"{path}: is one of the files that are read; must not be written over")
    return target, found


@contextmanager
def temporary_file_replacing_output(path: Path) -> Iterator[Path]:
    """Give a `with` block a temporary file to write, which replaces the file at `path` in the end.

    If the block raises an exception, the temporary file is deleted and `path` stays as it is. A
    replaced file keeps its permissions. If `path` is a symbolic link, its target is replaced. If
    `path` is a pipe or a device, the content is copied to it. Raises BadInput if `path` must not or
    cannot be written, and NoAnswer if the disk is full.
    """
    target, found = _resolved_path_and_file_status_of_output(path)
    stream = (
        None if found is None else _pipe_or_stream_number_or_none_for_ordinary_file(path, found)
    )
    folder = target.parent if stream is None else Path(tempfile.gettempdir())
    suffix = path.suffix if len(path.suffix) <= LONGEST_TEMPORARY_FILE_SUFFIX else ""
    partial = folder / f".drumlin-{os.urandom(6).hex()}{suffix}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        # If a file is replaced, the temporary file gets the permissions of this file at the end.
        # Until then no other user may read it.
        partial.touch(0o666 if found is None else 0o600, exist_ok=False)
        try:
            yield partial
            if stream is not None:
                with open(stream, "wb", closefd=stream is path) as file:
                    file.write(partial.read_bytes())
                return
            if found is not None:
                # Most users may not change a file's owner, and some operating systems have no
                # owners: the file then belongs to the user of this process.
                with suppress(OSError, AttributeError):
                    os.chown(partial, found.st_uid, found.st_gid)
                partial.chmod(stat.S_IMODE(found.st_mode) & 0o777)
            partial.replace(target)
        finally:
            partial.unlink(missing_ok=True)
    # Python raises a UnicodeEncodeError for a letter of the name that the locale cannot encode.
    except (OSError, UnicodeEncodeError) as error:
        raise exception_for_unusable_file(path, "written", error) from error


def _pipe_or_stream_number_or_none_for_ordinary_file(
    path: Path, found: os.stat_result
) -> Path | int | None:
    """The pipe, device or stream number to write into; None for a file that can be replaced.

    If standard output or standard error (streams 1 and 2) is redirected to the file, the result is
    the number of the stream: a new file in place of the old one would lose the lines that were
    printed before.

    Parameters
    ----------
    path : path of the output file
    found : status of the file on the disk
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
    with temporary_file_replacing_output(path) as partial:
        # The text may have names of files that are no UTF-8. Question marks replace their bytes.
        partial.write_text(text, encoding="utf-8", errors="replace")


def write_new_text_file(path: Path, text: str) -> None:
    """Write a new text file in UTF-8, whole or not at all.

    Raises BadInput if a file of this name exists already or the path cannot be written.
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
        raise exception_for_unusable_file(path, "written", error) from error


def delete_output_of_earlier_run(path: Path) -> None:
    """Delete the file at `path` that an earlier run has written, if there is one.

    A file that the block of `protect_input_files_within_block` has read stays, and so do folders,
    pipes and devices. Raises BadInput if the file cannot be deleted.
    """
    try:
        if not path.is_file():
            return
        found = path.stat()
        if not _is_protected_input_file(found):
            path.unlink(missing_ok=True)
    except (OSError, ValueError) as error:
        raise exception_for_unusable_file(path, "deleted", error) from error


def write_json(path: Path, data: object) -> None:
    """Write a JSON file whole or not at all. Raises ValueError for numbers that are not finite."""
    write_text(path, json.dumps(data, indent=1, allow_nan=False) + "\n")


# The pattern matches the beginning of a text that a spreadsheet would take for a formula. It does
# not match a number or a range of numbers, such as "-70 to 55.1".
_PATTERN_OF_FORMULA_BEGINNING = re.compile(r"[=@\t\r]|[-+](?![-+0-9.,;: eEto]*\Z)")


def spreadsheet_cell_safe_from_being_run_as_formula(value: object) -> object:
    """The value for a cell of a spreadsheet, made safe from being run as a formula.

    A text that the spreadsheet would take for a formula gets an apostrophe in front. Any other
    value is returned as it is.
    """
    return (
        f"'{value}"
        if isinstance(value, str) and _PATTERN_OF_FORMULA_BEGINNING.match(value)
        else value
    )


def require_fields_file_name_ends_in_vtu(path: Path | None, option: str = "--fields") -> None:
    """Raise BadInput for a file of displacements and stresses whose name does not end in .vtu.

    `option` is the name of the option or argument that the user gave, for the message.
    """
    if path is not None and path.suffix != ".vtu":
        raise BadInput(f"{option} = {str(path)!r}: must end in .vtu")
