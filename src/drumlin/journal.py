"""Results kept as they come, so that a stopped run goes on where it was: one line of JSON for each finished case.

Each line bears a checksum. A line that a kill tore is the last one and is dropped; a damaged line is skipped and its
case computed anew; all others stand. (A database would lose more: in sqlite3's write-ahead log one flipped bit takes
all later records with it, and that log does not work on network file systems.)

A journal belongs to one state of the program: that of another is kept aside. A file that is no journal stays as it is.
"""

import hashlib
import importlib.metadata
import json
import os
import stat
from collections.abc import Callable, Iterator, Mapping
from io import FileIO
from itertools import count
from pathlib import Path
from typing import Any, Self

from drumlin.errors import BadInput

try:
    import fcntl
except ImportError:  # no such locks on this system: two runs at a time are then the user's own care
    fcntl = None  # type: ignore[assignment]

LARGEST_HEAD = 1000  # bytes of the first line
LARGEST_LINE = 2**26  # bytes; a case has some hundreds, a study's reference some hundred thousand
FIRST_LINES = 1000  # among which a journal with a damaged head must have a sound line
COMPUTING = ("numpy", "scipy", "scikit-fem")  # libraries whose version may change a result's last digits


def source_stamp(*folders: Path) -> str:
    """A digest of what computes: drumlin's own source, that of `folders` (Python and TOML files), and libraries."""
    digest = hashlib.sha256()
    for name in COMPUTING:
        digest.update(f"{name} {importlib.metadata.version(name)}\n".encode())
    for folder in (Path(__file__).parent, *folders):
        for path in sorted([*folder.rglob("*.py"), *folder.rglob("*.toml")]):
            digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def key_of(case: Mapping[str, Any]) -> str:
    """What tells cases apart: their data as JSON, keys in order; values that JSON lacks by their text."""
    return json.dumps(case, sort_keys=True, default=str)


class Journal:
    """Finished cases by their data, in a file; without a path in memory only.

    `notes`: what there is to say of the file that was found, a line each. Raises BadInput where another run holds the
    file, it cannot be written, or it is no journal.
    """

    def __init__(self, path: Path | None = None, stamp: str = "") -> None:
        self.path, self.notes = path, list[str]()
        self._stamp, self._rows, self._file = stamp, dict[str, dict[str, Any]](), None
        if path is None:
            return
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._file = _locked(path)
            try:
                self._read(path)
            except BaseException:
                self.close()
                raise
        except (OSError, ValueError) as error:  # ValueError: a NUL in the path
            raise BadInput(f"{path}: cannot be written ({getattr(error, 'strerror', None) or error})") from error

    def __len__(self) -> int:
        return len(self._rows)

    def __bool__(self) -> bool:
        return True  # an empty journal is a journal

    def __contains__(self, case: Mapping[str, Any]) -> bool:
        return key_of(case) in self._rows

    def __getitem__(self, case: Mapping[str, Any]) -> dict[str, Any]:
        return self._rows[key_of(case)]

    def add(self, case: Mapping[str, Any], row: dict[str, Any]) -> None:
        """Keep the result of a case; it is in the file when this returns."""
        self._rows[key_of(case)] = row
        if self._file is not None:
            self._write(_line({"key": key_of(case), "row": row}, self._stamp))

    def once(self, case: Mapping[str, Any], compute: Callable[[], dict[str, Any]]) -> dict[str, Any]:
        """The kept result of a case, or else that of `compute`, which is kept."""
        if case not in self:
            self.add(case, compute())
        return self[case]

    def finish(self) -> None:
        """Close the file; the next run begins anew, and this one's cases stay beside it in `cases.jsonl`."""
        if self._file is not None and self.path is not None:
            self.path.replace(self.path.with_name(f"cases{self.path.suffix}"))
        self.close()

    def close(self) -> None:
        """Close the file; the next run goes on with it."""
        if self._file is not None:
            self._file.close()
            self._file = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _read(self, path: Path) -> None:
        """Take over the rows that the file has; leave it so that the next line can be written at its end."""
        assert self._file is not None
        head = self._file.readline(LARGEST_HEAD)
        torn = head.startswith(b'{"stamp": "') and not head.endswith(b"\n") and _head(self._stamp).startswith(head)
        if torn or not head:
            self._file.truncate(0)
            self._write(_head(self._stamp))
            return
        stamp, end = _stamp_in(head), len(head)
        damaged = int(stamp != self._stamp)
        for number, line in enumerate(_lines(self._file)):
            if not line.endswith(b"\n") and len(line) <= LARGEST_LINE:  # torn by a kill, or cut
                break
            end += len(line)
            record = _record(line, self._stamp)
            if record is not None:
                self._rows[record["key"]] = record["row"]
                continue
            damaged += 1
            if stamp != self._stamp and not self._rows and (number >= FIRST_LINES or end > LARGEST_LINE):
                break
        if stamp == self._stamp or self._rows:
            self._file.truncate(end)
            if damaged:
                self.notes.append(f"{path}: {damaged} damaged lines are skipped; their cases are solved anew")
        elif stamp is None:
            raise BadInput(f"{path}: is no journal; move it away, or write elsewhere")
        else:
            self._keep_aside(path)

    def _keep_aside(self, path: Path) -> None:
        """Rename the file, which is another drumlin's journal, and begin a new one."""
        aside = next(p for p in (path.with_name(f"{path.name}.{n}") for n in count(1)) if not os.path.lexists(p))
        path.rename(aside)
        self.close()  # only now: until here no other run could take it for its own
        self.notes.append(f"{path}: was of another drumlin and is kept as {aside.name}; every case is solved anew")
        self._file = _locked(path)
        self._read(path)

    def _write(self, data: bytes) -> None:
        assert self._file is not None
        while data:  # an unbuffered write may be short
            try:
                data = data[os.write(self._file.fileno(), data) :]
            except OSError as error:
                raise BadInput(f"{self.path}: cannot be written ({error.strerror})") from error


def _locked(path: Path) -> FileIO:
    """The file, made if there is none, at its beginning and this run's alone. Raises BadInput, OSError."""
    while True:
        if path.exists() and not stat.S_ISREG(path.stat().st_mode):
            raise BadInput(f"{path}: cannot be written (is no file)")
        file = path.open("a+b", buffering=0)
        try:
            if fcntl is not None:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            if path.exists() and os.path.samestat(path.stat(), os.fstat(file.fileno())):
                file.seek(0)
                return file
        except BlockingIOError as error:
            file.close()
            raise BadInput(f"{path}: another run is writing it") from error
        except BaseException:
            file.close()
            raise
        file.close()  # another run moved it away meanwhile


def _lines(file: FileIO) -> Iterator[bytes]:
    """The lines that follow, each up to LARGEST_LINE, the last one perhaps without its end."""
    rest = b""
    while piece := file.read(2**20):
        *whole, rest = (rest + piece).split(b"\n")
        yield from (line + b"\n" for line in whole)
        if len(rest) > LARGEST_LINE:
            yield rest
            rest = b""
    if rest:
        yield rest


def _head(stamp: str) -> bytes:
    return (json.dumps({"stamp": stamp}) + "\n").encode()


def _stamp_in(head: bytes) -> str | None:
    """The stamp that a journal begins with; None of other files."""
    try:
        data = json.loads(head)
    except (ValueError, RecursionError):
        return None
    stamp = data.get("stamp") if isinstance(data, dict) and len(data) == 1 else None
    return stamp if isinstance(stamp, str) else None


def _sum(data: bytes, stamp: str) -> bytes:
    return hashlib.sha256(stamp.encode() + data).hexdigest()[:16].encode()


def _line(record: dict[str, Any], stamp: str) -> bytes:
    """A record as a line of JSON that begins with the checksum of what follows it and of the stamp."""
    data = json.dumps(record).encode()[1:]
    return b'{"sum": "' + _sum(data, stamp) + b'", ' + data + b"\n"


def _record(line: bytes, stamp: str) -> dict[str, Any] | None:
    """The record of a line; None of a damaged one."""
    begin, middle, data = line[:9], line[9:28], line[28:-1]
    if begin + middle != b'{"sum": "' + _sum(data, stamp) + b'", ':
        return None
    record = json.loads(b"{" + data)
    return record if isinstance(record.get("key"), str) and isinstance(record.get("row"), dict) else None
