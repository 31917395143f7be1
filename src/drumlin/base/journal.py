"""The journal of a long computation: a file of JSON lines, one for each finished case.

If a computation was stopped, its next run reads the journal and computes only the missing cases.
Each line has a checksum: if lines are damaged, only their cases are computed again. (The
write-ahead log of sqlite3 would lose all records after one flipped bit, and it does not work on
network file systems.) A journal belongs to one version of the program's source. If the source has
changed, the old journal is renamed and a new one begins. A file that is no journal is never
changed.
"""

import hashlib
import importlib.metadata
import json
import os
import re
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager
from io import FileIO
from itertools import count
from pathlib import Path
from typing import Any

from drumlin.base.errors import BadInput, system_message_of_error

try:
    import fcntl
except ImportError:
    # Windows has no module fcntl, so that journals are not locked: there the user must not start
    # two runs that write the same journal.
    fcntl = None  # type: ignore[assignment]

MAX_BYTES_OF_JOURNAL_LINE = 2**26
"""Longest line of a journal [bytes]; a longer line counts as damaged.

The line of a case has some 100 bytes, and a line with the reference values of a study some 100 000.
If the first line of a file is unknown, undamaged lines are searched in its first 2**26 bytes.
"""
FIRST_BYTES_OF_JOURNAL_FILE = b'{"stamp": "'
"""The beginning of a journal's first line. The stamp follows: a checksum of drumlin's source."""
BYTES_OF_JOURNAL_LINE_CHECKSUM = len('{"sum": "0123456789abcdef", ')
"""Number of bytes at the beginning of a case's line, which hold the checksum of the line."""
LIBRARIES_THAT_AFFECT_RESULTS = ("numpy", "scipy", "scikit-fem")
"""Libraries of which another version may change the last digits of a result."""


def checksum_of_source_and_libraries(*folders: Path) -> str:
    """A checksum, 16 hexadecimal digits, of everything on which the results of a run depend.

    It covers all Python and TOML files of drumlin and of the given folders, and the versions of the
    libraries LIBRARIES_THAT_AFFECT_RESULTS.
    """
    digest = hashlib.sha256()
    for name in LIBRARIES_THAT_AFFECT_RESULTS:
        digest.update(f"{name} {importlib.metadata.version(name)}\n".encode())
    for folder in (Path(__file__).parents[1], *folders):
        for path in sorted([*folder.rglob("*.py"), *folder.rglob("*.toml")]):
            digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def case_data_as_json_line(case: Mapping[str, Any]) -> str:
    """The data of a case as one line of JSON, by which the journal finds the result of the case.

    The keys of the data are sorted. A value that JSON cannot write becomes a text (`str`).
    """
    return json.dumps(case, sort_keys=True, default=str)


class JournalOfCaseResults(AbstractContextManager["JournalOfCaseResults"]):
    """The results of finished cases, kept in a file; without a path they are kept in memory only.

    `journal[case]` is the result of a finished case, and `case in journal` tells whether the case
    is finished. `notes` are lines for the user about damaged or outdated journal files. Raises
    BadInput if another run is writing the file, if it cannot be written, or if it is no journal.
    """

    def __init__(self, path: Path | None = None, stamp: str = "") -> None:
        self.path, self.notes = path, list[str]()
        self._stamp = stamp
        self._rows: dict[str, dict[str, Any]] = {}
        self._file: FileIO | None = None
        try:
            if path is not None:
                path.parent.mkdir(parents=True, exist_ok=True)
                # An outdated journal is renamed as it is opened; then a new file is opened.
                while not self._try_to_lock_and_read_journal_file(path):
                    self.close()
        except BaseException as error:
            self.close()
            if isinstance(error, BlockingIOError):
                raise BadInput(f"{path}: another run is writing it") from error
            # Python raises a ValueError for a NUL in the path.
            if isinstance(error, OSError | ValueError):
                raise BadInput(
                    f"{path}: cannot be written ({system_message_of_error(error)})"
                ) from error
            raise

    def __len__(self) -> int:
        return len(self._rows)

    def __bool__(self) -> bool:
        """Always True, so that an empty journal is not taken for a missing journal (None)."""
        return True

    def __contains__(self, case: Mapping[str, Any]) -> bool:
        return case_data_as_json_line(case) in self._rows

    def __getitem__(self, case: Mapping[str, Any]) -> dict[str, Any]:
        return self._rows[case_data_as_json_line(case)]

    def add(self, case: Mapping[str, Any], row: dict[str, Any]) -> None:
        """Store the result `row` of a case. When this method returns, the result is in the file."""
        self._rows[case_data_as_json_line(case)] = row
        if self._file is not None:
            record = json.dumps({"key": case_data_as_json_line(case), "row": row}).encode()
            self._append_bytes_to_file(
                self._file, _journal_line_with_checksum(record[1:], self._stamp)
            )

    def get_or_compute_case_result(
        self, case: Mapping[str, Any], compute: Callable[[], dict[str, Any]]
    ) -> dict[str, Any]:
        """The stored result of a case. If there is none, the case is computed and stored first.

        `compute` is the function, without arguments, that returns the result.
        """
        if case not in self:
            self.add(case, compute())
        return self[case]

    def close_and_rename_complete_journal(self) -> None:
        """Close the journal of a complete run and rename its file to `cases.jsonl`.

        The next run finds no journal and computes all cases.
        """
        if self._file is not None and self.path is not None:
            self.path.replace(self.path.with_name(f"cases{self.path.suffix}"))
        self.close()

    def close_and_delete_complete_journal(self) -> None:
        """Close the journal of a complete run, whose results are in another file, and delete it."""
        if self._file is not None and self.path is not None:
            # The file stays locked until it is deleted, so that no other run reads it meanwhile.
            # On Windows it is not locked, and must be closed before it can be deleted.
            if fcntl is None:
                self.close()
            self.path.unlink(missing_ok=True)
        self.close()

    def close(self) -> None:
        """Close the journal of an incomplete run; the next run reads its cases and goes on."""
        if self._file is not None:
            self._file.close()
            self._file = None

    def __exit__(self, *_: object) -> None:
        self.close()

    def _try_to_lock_and_read_journal_file(self, path: Path) -> bool:
        """Open and lock the file at `path` and read its cases; False if it must be tried again.

        It must be tried again if this run or another one has renamed the file as outdated, so that
        no file is left at `path`. Raises BlockingIOError if another run has locked the file.
        """
        if path.exists() and not path.is_file():
            raise BadInput(f"{path}: cannot be written (is no file)")
        # Without a buffer each result is in the file at once, even if the process is killed then.
        self._file = path.open("a+b", buffering=0)
        if fcntl is not None:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        # Another run may have renamed the file before the lock was taken.
        locked = os.fstat(self._file.fileno())
        return (
            path.exists()
            and os.path.samestat(path.stat(), locked)
            and self._read_results_if_journal_is_of_this_version(self._file)
        )

    def _read_results_if_journal_is_of_this_version(self, file: FileIO) -> bool:
        """Read the cases of the locked file, and cut off a last line that is incomplete.

        Returns True if that was done. A journal of another version of the program's source is
        renamed instead, and the result is False.
        """
        path, own_head = (
            Path(file.name),
            FIRST_BYTES_OF_JOURNAL_FILE + self._stamp.encode() + b'"}\n',
        )
        with path.open("rb") as reader:
            head = reader.readline(MAX_BYTES_OF_JOURNAL_LINE)
            # The file is new, or its first line is incomplete because the process was killed.
            if not head or (
                head.startswith(FIRST_BYTES_OF_JOURNAL_FILE) and own_head[:-1].startswith(head)
            ):
                file.truncate(0)
                self._append_bytes_to_file(file, own_head)
                return True
            is_own = head == own_head
            # `end` is the length of the complete lines read so far. A first line with another stamp
            # counts as damaged.
            end, damaged = len(head), int(not is_own)
            while (is_own or self._rows or end <= MAX_BYTES_OF_JOURNAL_LINE) and (
                line := reader.readline(MAX_BYTES_OF_JOURNAL_LINE)
            ):
                # The last line is incomplete if the process was killed while it wrote the line.
                if not line.endswith(b"\n") and len(line) < MAX_BYTES_OF_JOURNAL_LINE:
                    break
                end += len(line)
                # A line counts only if its checksum is that of its data and this version's stamp.
                data = line[BYTES_OF_JOURNAL_LINE_CHECKSUM:-1]
                if line == _journal_line_with_checksum(data, self._stamp):
                    record = json.loads(b"{" + data)
                    self._rows[record["key"]] = record["row"]
                else:
                    damaged += 1
        # A journal of another version of the source has another stamp, with which no line has the
        # right checksum: no case was read.
        if not is_own and not self._rows:
            self._rename_outdated_journal(path, head)
            return False
        file.truncate(end)
        if damaged:
            self.notes.append(
                f"{path}: {damaged} damaged lines are skipped; their cases are solved anew"
            )
        return True

    def _rename_outdated_journal(self, path: Path, head: bytes) -> None:
        """Rename a journal of another version of the source to the first free name `path.N`.

        Raises BadInput if the first line `head` of the file is not that of a journal.
        """
        if not re.fullmatch(re.escape(FIRST_BYTES_OF_JOURNAL_FILE) + rb'[^"]*"\}\n', head):
            raise BadInput(f"{path}: is no journal; move it away, or write elsewhere")
        names = (path.with_name(f"{path.name}.{n}") for n in count(1))
        # The file stays locked until it is renamed, so that no other run reads it meanwhile. On
        # Windows it is not locked, and must be closed before it can be renamed.
        if fcntl is None:
            self.close()
        aside = path.rename(next(name for name in names if not os.path.lexists(name)))
        self.notes.append(
            f"{path}: was of another drumlin and is kept as {aside.name}; every case is solved anew"
        )

    def _append_bytes_to_file(self, file: FileIO, data: bytes) -> None:
        """Append all bytes of `data` to the file. Raises BadInput if that fails."""
        try:
            # The operating system may write only a part of the data at once.
            while data:
                data = data[os.write(file.fileno(), data) :]
        except OSError as error:
            raise BadInput(
                f"{self.path}: cannot be written ({system_message_of_error(error)})"
            ) from error


def _journal_line_with_checksum(data: bytes, stamp: str) -> bytes:
    """The line of the journal for one case: a checksum, then the data.

    Parameters
    ----------
    data : the case and its result in JSON, without the opening brace
    stamp : checksum of drumlin's source, which the line's checksum covers as well
    """
    checksum = hashlib.sha256(stamp.encode() + data).hexdigest()[:16]
    return b'{"sum": "%s", %s\n' % (checksum.encode(), data)
