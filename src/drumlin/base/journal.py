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

# The longest line in bytes. A case has some hundreds, a study's reference some hundred thousand.
# In a file with another stamp a sound line is looked for up to here.
LARGEST_LINE = 2**26

# The first line begins with HEAD. Each further line holds a checksum, then its record: the number
# tells how many bytes stand before the record.
HEAD = b'{"stamp": "'
LEAD = len('{"sum": "0123456789abcdef", ')

# Libraries whose version may change a result's last digits.
COMPUTING = ("numpy", "scipy", "scikit-fem")


def source_stamp(*folders: Path) -> str:
    """A digest of what computes: the source of drumlin and of `folders`, and versions of libraries.

    Of a folder it is the content of all Python and TOML files.
    """
    digest = hashlib.sha256()
    for name in COMPUTING:
        digest.update(f"{name} {importlib.metadata.version(name)}\n".encode())
    for folder in (Path(__file__).parent, *folders):
        for path in sorted([*folder.rglob("*.py"), *folder.rglob("*.toml")]):
            digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def key_of(case: Mapping[str, Any]) -> str:
    """What tells cases apart: their data as JSON, keys in order.

    A value that JSON lacks stands there by its text.
    """
    return json.dumps(case, sort_keys=True, default=str)


class Journal(AbstractContextManager["Journal"]):
    """Finished cases by their data, in a file; without a path in memory only.

    `notes` are lines about the file that was found. Raises BadInput where another run holds the
    file, where it cannot be written, or where it is no journal.
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
        # A ValueError comes of a NUL in the path.
        except (OSError, ValueError) as error:
            reason = getattr(error, "strerror", None) or error
            raise BadInput(f"{path}: cannot be written ({reason})") from error

    def __len__(self) -> int:
        return len(self._rows)

    def __bool__(self) -> bool:
        """An empty journal is a journal."""
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
        """The kept result of a case, or else that of `compute`, which is kept."""
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
            # A line without its end was torn by a kill, or is longer than any that a journal has.
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
        """Rename the file, which is another drumlin's journal, and begin a new one."""
        aside = next(
            p
            for p in (path.with_name(f"{path.name}.{n}") for n in count(1))
            if not os.path.lexists(p)
        )
        path.rename(aside)
        # Only now: until it is renamed no other run may take the file for its own.
        self.close()
        self.notes.append(
            f"{path}: was of another drumlin and is kept as {aside.name}; every case is solved anew"
        )
        self._open(path)

    def _write(self, data: bytes) -> None:
        assert self._file is not None
        # A write that is not buffered may be short.
        while data:
            try:
                data = data[os.write(self._file.fileno(), data) :]
            except OSError as error:
                raise BadInput(f"{self.path}: cannot be written ({error.strerror})") from error


def _locked(path: Path) -> FileIO:
    """The file, made if there is none, for this run alone.

    Raises BadInput, OSError, and BlockingIOError where another run has it.
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
    """A line: a checksum of record and stamp, then the record without its opening brace."""
    checksum = hashlib.sha256(stamp.encode() + data).hexdigest()[:16]
    return b'{"sum": "%s", %s\n' % (checksum.encode(), data)
