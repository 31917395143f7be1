"""Results kept as they come, so that a stopped run goes on where it was: one line of JSON for each finished case.

A line is written whole or, by a kill in its middle, is the torn last one, which the next run drops. A journal
belongs to one state of the program: another one begins it anew.
"""

import hashlib
import json
import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Self

from drumlin.errors import BadInput

try:
    import fcntl
except ImportError:  # no such locks on this system: two runs at a time are then the user's own care
    fcntl = None  # type: ignore[assignment]


def source_stamp(*folders: Path) -> str:
    """A digest of drumlin's own source and that of `folders` (Python files and brake files)."""
    digest = hashlib.sha256()
    for folder in (Path(__file__).parent, *folders):
        for path in sorted([*folder.rglob("*.py"), *folder.rglob("*.toml")]):
            digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def key_of(case: Mapping[str, Any]) -> str:
    """What tells cases apart: their data as JSON, keys in order; values that JSON lacks by their text."""
    return json.dumps(case, sort_keys=True, default=str)


class Journal:
    """Finished cases by their data, in a file; without a path in memory only.

    Raises BadInput where another run holds the file or it cannot be written.
    """

    def __init__(self, path: Path | None = None, stamp: str = "") -> None:
        self.path, self._rows, self._file = path, dict[str, dict[str, Any]](), None
        if path is None:
            return
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._file = path.open("a+b", buffering=0)
        except OSError as error:
            raise BadInput(f"{path}: cannot be written ({error.strerror})") from error
        try:
            if fcntl is not None:
                fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            self._file.close()
            raise BadInput(f"{path}: another run is writing it") from error
        self._file.seek(0)
        text = self._file.read()
        whole = text[: text.rfind(b"\n") + 1]
        try:
            lines = [json.loads(line) for line in whole.splitlines()]
        except ValueError as error:
            self._file.close()
            raise BadInput(f"{path}: is no journal; move it away, or write elsewhere") from error
        if not lines or lines[0] != {"stamp": stamp}:
            self._file.truncate(0)
            self._write({"stamp": stamp})
            return
        self._file.truncate(len(whole))
        self._rows = {line["key"]: line["row"] for line in lines[1:]}

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
            self._write({"key": key_of(case), "row": row})

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

    def _write(self, line: dict[str, Any]) -> None:
        assert self._file is not None
        data = (json.dumps(line) + "\n").encode()
        while data:  # an unbuffered write may be short
            try:
                data = data[os.write(self._file.fileno(), data) :]
            except OSError as error:
                raise BadInput(f"{self.path}: cannot be written ({error.strerror})") from error
