"""Results kept as they come, a line of JSON for each finished case, so that a stopped run goes on.

Each line bears a checksum. A line that a kill tore is the last one and is dropped. A damaged line
is skipped, and its case is computed anew; all other lines stand. (A database would lose more: in
the write-ahead log of sqlite3 one flipped bit takes all later records with it, and that log does
not work on network file systems.)

A journal belongs to one state of the program: the journal of another state is kept aside. A file
that is no journal stays as it is.
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

from drumlin.base.errors import BadInput

try:
    import fcntl
except ImportError:
    # On a system without such locks the user takes care that no two runs write one journal.
    fcntl = None  # type: ignore[assignment]

LARGEST_LINE = 2**26
"""Longest line of a journal in bytes. A case has some hundreds, a study's reference some hundred
thousand. A longer line is damaged. In a file with another stamp sound lines are looked for up to
this many bytes.
"""
HEAD = b'{"stamp": "'
"""The beginning of the first line of a journal."""
LEAD = len('{"sum": "0123456789abcdef", ')
"""Bytes before the record in each further line: they hold the checksum."""
COMPUTING = ("numpy", "scipy", "scikit-fem")
"""Libraries whose version may change the last digits of a result."""


def source_stamp(*folders: Path) -> str:
    """A digest of the source that computes results, and of the versions of its libraries.

    The source is that of drumlin and of `folders`: the content of all Python and TOML files.
    """
    digest = hashlib.sha256()
    for name in COMPUTING:
        digest.update(f"{name} {importlib.metadata.version(name)}\n".encode())
    for folder in (Path(__file__).parent, *folders):
        for path in sorted([*folder.rglob("*.py"), *folder.rglob("*.toml")]):
            digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def key_of(case: Mapping[str, Any]) -> str:
    """The key of a case: its data as JSON, with keys in order.

    A value that JSON lacks is replaced by its text.
    """
    return json.dumps(case, sort_keys=True, default=str)


class Journal(AbstractContextManager["Journal"]):
    """The results of finished cases, kept in a file, or in memory only where no path is given.

    `notes` are lines about an existing file. Raises BadInput where another run holds the file,
    where the file cannot be written, or where it is not a journal.
    """

    def __init__(self, path: Path | None = None, stamp: str = "") -> None:
        self.path, self.notes = path, list[str]()
        self._stamp, self._head = stamp, HEAD + f'{stamp}"}}\n'.encode()
        self._rows: dict[str, dict[str, Any]] = {}
        self._file: FileIO | None = None
        if path is None:
            return
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._open(path)
        except BlockingIOError as error:
            raise BadInput(f"{path}: another run is writing it") from error
        # A NUL in the path raises a ValueError.
        except (OSError, ValueError) as error:
            reason = getattr(error, "strerror", None) or error
            raise BadInput(f"{path}: cannot be written ({reason})") from error

    def __len__(self) -> int:
        return len(self._rows)

    def __bool__(self) -> bool:
        """Always true: a journal without cases is not the same as no journal."""
        return True

    def __contains__(self, case: Mapping[str, Any]) -> bool:
        return key_of(case) in self._rows

    def __getitem__(self, case: Mapping[str, Any]) -> dict[str, Any]:
        return self._rows[key_of(case)]

    def add(self, case: Mapping[str, Any], row: dict[str, Any]) -> None:
        """Keep the result of a case; it is in the file when this returns."""
        self._rows[key_of(case)] = row
        if self._file is not None:
            record = json.dumps({"key": key_of(case), "row": row}).encode()
            self._write(_sealed(record[1:], self._stamp))

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
        """Close the file; the next run goes on with it."""
        if self._file is not None:
            self._file.close()
            self._file = None

    def __exit__(self, *_: object) -> None:
        self.close()

    def _open(self, path: Path) -> None:
        """Take the file for this run alone, and read it."""
        self._file = _locked(path)
        try:
            self._read(path, self._file)
        except BaseException:
            self.close()
            raise

    def _read(self, path: Path, file: FileIO) -> None:
        """Take over the rows of the file, and cut off what follows its last whole line."""
        with path.open("rb") as reader:
            head = reader.readline(LARGEST_LINE)
            torn = head.startswith(HEAD) and self._head[:-1].startswith(head)
            if torn or not head:
                file.truncate(0)
                self._write(self._head)
                return
            damaged, end = int(head != self._head), len(head)
            # A line without its end was torn by a kill, or is longer than a journal's lines are.
            while (line := reader.readline(LARGEST_LINE)).endswith(b"\n") or len(
                line
            ) == LARGEST_LINE:
                end += len(line)
                data = line[LEAD:-1]
                if line == _sealed(data, self._stamp):
                    record = json.loads(b"{" + data)
                    self._rows[record["key"]] = record["row"]
                    continue
                damaged += 1
                if head != self._head and not self._rows and end > LARGEST_LINE:
                    break
        if head == self._head or self._rows:
            file.truncate(end)
            if damaged:
                self.notes.append(
                    f"{path}: {damaged} damaged lines are skipped; their cases are solved anew"
                )
        elif re.fullmatch(re.escape(HEAD) + rb'[^"]*"\}\n', head):
            self._keep_aside(path)
        else:
            raise BadInput(f"{path}: is no journal; move it away, or write elsewhere")

    def _keep_aside(self, path: Path) -> None:
        """Rename the file, which is the journal of another drumlin, and begin a new one."""
        names = (path.with_name(f"{path.name}.{n}") for n in count(1))
        aside = next(name for name in names if not os.path.lexists(name))
        path.rename(aside)
        # The lock ends only after the rename, so that no other run takes the file for its own.
        self.close()
        self.notes.append(
            f"{path}: was of another drumlin and is kept as {aside.name}; every case is solved anew"
        )
        self._open(path)

    def _write(self, data: bytes) -> None:
        assert self._file is not None
        # A write without a buffer may write a part of the data only.
        while data:
            try:
                data = data[os.write(self._file.fileno(), data) :]
            except OSError as error:
                raise BadInput(f"{self.path}: cannot be written ({error.strerror})") from error


def _locked(path: Path) -> FileIO:
    """The file, locked for this run alone; it is made if there is none.

    Raises BadInput for a path that is not a file, OSError, and BlockingIOError where another run
    holds the file.
    """
    if path.exists() and not path.is_file():
        raise BadInput(f"{path}: cannot be written (is no file)")
    file = path.open("a+b", buffering=0)
    try:
        if fcntl is not None:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        if path.exists() and os.path.samestat(path.stat(), os.fstat(file.fileno())):
            return file
    except BaseException:
        file.close()
        raise
    # Another run has moved the file away meanwhile.
    file.close()
    return _locked(path)


def _sealed(data: bytes, stamp: str) -> bytes:
    """A line of the journal: a checksum of record and stamp, and the record without its brace."""
    checksum = hashlib.sha256(stamp.encode() + data).hexdigest()[:16]
    return b'{"sum": "%s", %s\n' % (checksum.encode(), data)
