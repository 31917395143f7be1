"""How a command line ends, and whether that is as promised.

An input is sound if it ends with 0 and finite numbers, or with 2 or 3 and one line. A traceback, a
second line, a control character on the screen, a number that is not finite, an input that is
written over and a run of more than LONGEST_RUN seconds are faults.
"""

import contextlib
import csv
import io
import json
import os
import re
import resource
import signal
import subprocess
import sys
import tempfile
import time
import tomllib
import warnings
from collections.abc import Iterator, Sequence
from functools import reduce
from pathlib import Path
from typing import Any, NamedTuple

from drumlin.base.errors import ended
from drumlin_studies.fuzzing.inputs import BrokenInput

LONGEST_RUN = 10.0  # s of processor time
LONGEST_WAIT = 300.0  # s by the clock, on a busy machine


class Ending(NamedTuple):
    """How a command line ended: status, what it printed, the files that it wrote or changed,
    seconds.
    """

    status: int
    out: str
    err: str
    written: dict[str, bytes]
    seconds: float


def lay_out(given: BrokenInput, folder: Path) -> None:
    """Write the files of an input, and beside them what paths may hit: a folder, links, a hard
    link.
    """
    for name, data in given.files.items():
        (folder / name).write_bytes(data)
    (folder / "sub").mkdir()
    for link, to in (("link.json", "b.toml"), ("loop", "loop"), ("dangling", "nowhere/x")):
        (folder / link).symlink_to(to)
    (folder / "hard.json").hardlink_to(folder / "b.toml")


def written(folder: Path, given: BrokenInput) -> dict[str, bytes]:
    """The files of a folder that are new or changed since `lay_out`."""
    found = {}
    for path in sorted(folder.rglob("*")):
        name = str(path.relative_to(folder))
        if path.is_file() and not path.is_symlink() and name != "hard.json":
            data = path.read_bytes()
            if data != given.files.get(name):
                found[name] = data
    return found


def in_process(given: BrokenInput) -> Ending:
    """Run an input in this process; quick, but a hang inside a library is only found when it
    returns.
    """
    from drumlin.cli.process import run  # noqa: PLC0415

    before = Path.cwd()
    out, err = io.StringIO(), io.StringIO()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        lay_out(given, folder)
        os.chdir(folder)
        start = time.process_time()
        try:
            with (
                contextlib.redirect_stdout(out), contextlib.redirect_stderr(err), warnings.catch_warnings(), _limited(),
            ):  # fmt: skip
                warnings.simplefilter("error")
                status = ended(lambda: run(given.words))
        finally:
            os.chdir(before)
        seconds = time.process_time() - start
        return Ending(status, out.getvalue(), err.getvalue(), written(folder, given), seconds)


class Late(BaseException):
    """The run has taken too long."""


@contextlib.contextmanager
def _limited() -> Iterator[None]:
    """Raise Late in the block once it has worked too long, or waits for what does not come."""

    def late(*_: object) -> None:
        raise Late

    timers = (
        (signal.ITIMER_PROF, signal.SIGPROF, 1.5 * LONGEST_RUN),
        (signal.ITIMER_REAL, signal.SIGALRM, LONGEST_WAIT),
    )
    before = [(sign, signal.signal(sign, late)) for _, sign, _ in timers]
    for timer, _, seconds in timers:
        signal.setitimer(timer, seconds)
    try:
        yield
    finally:
        for timer, _, _ in timers:
            signal.setitimer(timer, 0)
        for sign, handler in before:
            signal.signal(sign, handler)


def in_subprocess(given: BrokenInput, **more: Any) -> Ending:
    """Run an input as a process of its own; `more` goes to subprocess.run."""
    command = [sys.executable, "-c", "from drumlin.cli import main; main()"]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        lay_out(given, folder)
        start = _spent()
        words = [os.fsencode(word) for word in given.words]
        try:
            done = subprocess.run(
                [*map(os.fsencode, command), *words],
                cwd=folder,
                capture_output=True,
                timeout=LONGEST_WAIT,
                check=False,
                **more,
            )
        except subprocess.TimeoutExpired:
            return Ending(-1, "", "no end", {}, LONGEST_WAIT)
        seconds = _spent() - start
        out, err = (text.decode(errors="replace") for text in (done.stdout, done.stderr))
        return Ending(done.returncode, out, err, written(folder, given), seconds)


def _spent() -> float:
    """Processor time of the processes that have ended [s]: on a busy machine the clock says little."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


_NOT_FINITE = re.compile(r"(?<![\w'\"/.-])[-+]?(?:nan|inf|NaN|Infinity)(?![\w'\"/.])")


def fault_of(given: BrokenInput, end: Ending) -> str:
    """What is wrong with how an input ended; empty where nothing is."""
    if end.seconds > LONGEST_RUN:
        return f"took {end.seconds:.0f} s"
    if end.status not in {0, 2, 3}:
        return f"status {end.status}: {' '.join(end.err.split())[-300:]}"
    for name in ("out", "err"):
        control = re.search(r"[^\n -~\u00a0-\U0010ffff]", getattr(end, name))
        if control:
            return f"control character {control.group()!r} in std{name}"
    return _fault_of_refusal(end) if end.status else _fault_of_answer(given, end)


KEPT_FILES = ("m/", "m.", "t.csv")
"""What a refused run may leave: meshes up to the one that failed, a sweep's table of failed cases
and its journal.
"""
_NOTES = re.compile(r"(?:drumlin: t\.csv\.journal: [^\n]*\n)*")


def _fault_of_refusal(end: Ending) -> str:
    said = _NOTES.sub("", end.err, count=1)
    if said.count("\n") != 1 or not said.startswith("drumlin: "):
        said = end.err  # a journal that is refused is named like one that is repaired
    if said.count("\n") != 1 or not said.startswith("drumlin: "):
        return f"not one line: {end.err[:200]!r}"
    if any(not name.startswith(KEPT_FILES) for name in end.written):
        return f"files of a refused run: {', '.join(end.written)[:200]}"
    return ""


def _fault_of_answer(given: BrokenInput, end: Ending) -> str:
    if not _NOTES.fullmatch(end.err):
        return f"an answer with {end.err[:200]!r} in stderr"
    if given.must_fail:
        return "an answer of an input that has none"
    names = _names(given)
    _, _, numbers = end.out.partition(", drum turns")  # before it the title, which may be any text
    numbers = reduce(lambda text, name: text.replace(name, "_"), names, numbers or end.out)
    if _NOT_FINITE.search(numbers):
        return f"not finite: {_around(numbers)}"
    if any(end.written.get(name) != data for name, data in given.right.items()):
        return f"not the right {', '.join(given.right)}"
    if set(end.written) & {name for name in given.files if name not in {"r.csv", "t.csv.journal"}}:
        return f"an input was written over: {', '.join(end.written)}"
    return next(
        (why for name, data in end.written.items() if (why := _bad_file(name, data, names))), ""
    )


def _names(given: BrokenInput) -> list[str]:
    """Names of shoes that read like what is no number: "nan mm" is a name."""
    try:
        shoes = tomllib.loads(given.files.get("b.toml", b"").decode()).get("shoe", [])
        names = {str(shoe.get("name")) for shoe in shoes}
    except (ValueError, AttributeError, TypeError, RecursionError):
        return []
    return [name for name in names if _NOT_FINITE.search(name)]


def _around(text: str) -> str:
    match = _NOT_FINITE.search(text)
    return (
        ""
        if match is None
        else text[max(match.start() - 60, 0) : match.end() + 20].replace("\n", " ")
    )


def _bad_file(name: str, data: bytes, names: Sequence[str]) -> str:
    """What is wrong with a file that was written."""
    if Path(name).name.startswith(".drumlin-"):
        return f"a temporary file is left: {name}"
    if data.startswith(b"{") and ".journal" not in name:
        try:
            json.loads(data, parse_constant=_refuse)
        except ValueError as error:
            return f"{name}: {error}"
    if data.startswith((b"shoe,", b"case,")):
        for row in csv.reader(io.StringIO(data.decode())):
            if any(_NOT_FINITE.fullmatch(cell) for cell in row if cell not in names):
                return f"{name}: {row}"
            if any(cell[:1] in {"=", "@", "\t"} for cell in row):
                return f"{name}: a formula: {row}"
    return ""


def _refuse(word: str) -> float:
    raise ValueError(f"holds {word}")
