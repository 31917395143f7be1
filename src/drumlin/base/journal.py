"""Results of finished cases, kept in a file of JSON lines, so that a stopped run goes on.

Each line has a checksum, so that damage costs the damaged lines alone: their cases are computed
anew. (In the write-ahead log of sqlite3 one flipped bit takes all later records with it, and that
log does not work on network file systems.) A journal belongs to one state of the program: the
journal of another state is renamed. A file that is no journal stays as it is.
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

from drumlin.base.errors import BadInput, reason_of

try:
    import fcntl
except ImportError:
    # On a system without such locks the user takes care that no two runs write one journal.
    fcntl = None  # type: ignore[assignment]

LARGEST_LINE = 2**26
"""Longest line of a journal in bytes; a longer line is damaged.

A case has some hundreds, a study's reference some hundred thousand. In a file whose first line is
not that of this journal, undamaged lines are looked for up to this many bytes.
"""
HEAD = b'{"stamp": "'
"""The beginning of the first line of a journal."""
LEAD = len('{"sum": "0123456789abcdef", ')
"""Bytes before the record in each further line: they hold the checksum."""
COMPUTING = ("numpy", "scipy", "scikit-fem")
"""Libraries whose version may change the last digits of a result."""


def source_stamp(*folders: Path) -> str:
    """A digest of all source of drumlin and of `folders`, and of the versions of its libraries.

    The source is the content of all Python and TOML files.
    """
    digest = hashlib.sha256()
    for name in COMPUTING:
        digest.update(f"{name} {importlib.metadata.version(name)}\n".encode())
    for folder in (Path(__file__).parents[1], *folders):
        for path in sorted([*folder.rglob("*.py"), *folder.rglob("*.toml")]):
            digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def key_of(case: Mapping[str, Any]) -> str:
    """The data of a case as a line of JSON, keys in order; a value that JSON lacks as its text."""
    return json.dumps(case, sort_keys=True, default=str)


class Journal(AbstractContextManager["Journal"]):
    """The results of finished cases, kept in a file, or in memory only where no path is given.

    `notes` are lines about an existing file. Raises BadInput where another run holds the file,
    where the file cannot be written, or where it is not a journal.
    """

    def __init__(self, path: Path | None = None, stamp: str = "") -> None:
        self.path, self.notes = path, list[str]()
        self._stamp = stamp
        self._rows: dict[str, dict[str, Any]] = {}
        self._file: FileIO | None = None
        try:
            if path is not None:
                path.parent.mkdir(parents=True, exist_ok=True)
                while not self._open(path):
                    self.close()
        except BaseException as error:
            self.close()
            if isinstance(error, BlockingIOError):
                raise BadInput(f"{path}: another run is writing it") from error
            # A NUL in the path raises a ValueError.
            if isinstance(error, OSError | ValueError):
                raise BadInput(f"{path}: cannot be written ({reason_of(error)})") from error
            raise

    def __len__(self) -> int:
        return len(self._rows)

    def __contains__(self, case: Mapping[str, Any]) -> bool:
        return key_of(case) in self._rows

    def __getitem__(self, case: Mapping[str, Any]) -> dict[str, Any]:
        return self._rows[key_of(case)]

    def add(self, case: Mapping[str, Any], row: dict[str, Any]) -> None:
        """Keep the result of a case; it is in the file when this method returns."""
        self._rows[key_of(case)] = row
        if self._file is not None:
            record = json.dumps({"key": key_of(case), "row": row}).encode()
            self._write(self._file, _sealed(record[1:], self._stamp))

    def once(
        self, case: Mapping[str, Any], compute: Callable[[], dict[str, Any]]
    ) -> dict[str, Any]:
        """The kept result of a case, else the result of `compute`, which is then kept."""
        if case not in self:
            self.add(case, compute())
        return self[case]

    def finish(self) -> None:
        """Close the file for good: the next run begins anew, and cases stay in `cases.jsonl`."""
        if self._file is not None and self.path is not None:
            self.path.replace(self.path.with_name(f"cases{self.path.suffix}"))
        self.close()

    def close(self) -> None:
        """Close the file; the next run goes on with the cases in the file."""
        if self._file is not None:
            self._file.close()
            self._file = None

    def __exit__(self, *_: object) -> None:
        self.close()

    def _open(self, path: Path) -> bool:
        """Lock the file and read its rows; False where the file is renamed, so that none is left.

        Raises BlockingIOError where another run holds the lock.
        """
        if path.exists() and not path.is_file():
            raise BadInput(f"{path}: cannot be written (is no file)")
        # Without a buffer a result is in the file as soon as it is written.
        self._file = path.open("a+b", buffering=0)
        if fcntl is not None:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        # Another run may have renamed the file before the lock was taken.
        locked = os.fstat(self._file.fileno())
        return path.exists() and os.path.samestat(path.stat(), locked) and self._read(self._file)

    def _read(self, file: FileIO) -> bool:
        """Take over the rows of the locked file, and cut off what follows its last whole line.

        Returns False where the file is the journal of another drumlin and is renamed.
        """
        path, own_head = Path(file.name), HEAD + self._stamp.encode() + b'"}\n'
        with path.open("rb") as reader:
            head = reader.readline(LARGEST_LINE)
            # The file is new, or a kill tore its first line.
            if not head or (head.startswith(HEAD) and own_head[:-1].startswith(head)):
                file.truncate(0)
                self._write(file, own_head)
                return True
            is_own, end, damaged = head == own_head, len(head), int(head != own_head)
            while (is_own or self._rows or end <= LARGEST_LINE) and (
                line := reader.readline(LARGEST_LINE)
            ):
                # The last line lacks its end where a kill tore it.
                if not line.endswith(b"\n") and len(line) < LARGEST_LINE:
                    break
                end += len(line)
                data = line[LEAD:-1]
                if line == _sealed(data, self._stamp):
                    record = json.loads(b"{" + data)
                    self._rows[record["key"]] = record["row"]
                else:
                    damaged += 1
        if not is_own and not self._rows:
            self._rename(path, head)
            return False
        file.truncate(end)
        if damaged:
            self.notes.append(
                f"{path}: {damaged} damaged lines are skipped; their cases are solved anew"
            )
        return True

    def _rename(self, path: Path, head: bytes) -> None:
        """Rename a journal of another drumlin. Raises BadInput where `head` begins no journal."""
        if not re.fullmatch(re.escape(HEAD) + rb'[^"]*"\}\n', head):
            raise BadInput(f"{path}: is no journal; move it away, or write elsewhere")
        names = (path.with_name(f"{path.name}.{n}") for n in count(1))
        # The lock ends only after the rename, so that no other run takes the file for its own.
        aside = path.rename(next(name for name in names if not os.path.lexists(name)))
        self.notes.append(
            f"{path}: was of another drumlin and is kept as {aside.name}; every case is solved anew"
        )

    def _write(self, file: FileIO, data: bytes) -> None:
        """Write data to the end of the file, if need be in several parts."""
        try:
            while data:
                data = data[os.write(file.fileno(), data) :]
        except OSError as error:
            raise BadInput(f"{self.path}: cannot be written ({reason_of(error)})") from error


def _sealed(data: bytes, stamp: str) -> bytes:
    """A line of the journal: a checksum of record and stamp, and the record without its brace."""
    checksum = hashlib.sha256(stamp.encode() + data).hexdigest()[:16]
    return b'{"sum": "%s", %s\n' % (checksum.encode(), data)
