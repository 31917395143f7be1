"""Runs drumlin's command line on a broken input, and judges how the run ends.

A run ends well with exit status 0 and finite numbers, or with status 2 or 3 and one line of text.
Faults of drumlin are a traceback, a second line, a control character on the screen, a number that
is not finite, an input file that is overwritten, and a run of more than
PROCESSOR_SECONDS_ABOVE_WHICH_RUN_IS_FAULT seconds.
"""

import contextlib
import csv
import io
import json
import os
import re
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

from drumlin.base.errors import call_function_and_return_exit_status
from drumlin.base.resource_use import processor_time_of_ended_child_processes
from drumlin_studies.fuzzing.inputs import FilesAndCommandLineOfBrokenInput

PROCESSOR_SECONDS_ABOVE_WHICH_RUN_IS_FAULT = 10.0
"""Processor time [s] of a run above which the run counts as a fault."""
WALL_SECONDS_AFTER_WHICH_RUN_IS_STOPPED = 300.0
"""Wall-clock time [s] after which a run is stopped. The time is long because the machine may be
busy.
"""


class EndOfCommandLineRun(NamedTuple):
    """How a run of a command line ended.

    Attributes
    ----------
    status : int
        Exit status of the run.
    out, err : str
        Texts that the run wrote to the standard output and to the standard error.
    written : dict
        Contents of the files that the run wrote or changed, by name.
    seconds : float
        Processor time of the run [s].
    """

    status: int
    out: str
    err: str
    written: dict[str, bytes]
    seconds: float


def write_files_of_broken_input(given: FilesAndCommandLineOfBrokenInput, folder: Path) -> None:
    """Write the files of an input into a folder, with a subfolder and links beside them.

    Paths on the command line may name the subfolder or a link.
    """
    for name, data in given.files.items():
        (folder / name).write_bytes(data)
    (folder / "sub").mkdir()
    for link, to in (("link.json", "b.toml"), ("loop", "loop"), ("dangling", "nowhere/x")):
        (folder / link).symlink_to(to)
    (folder / "hard.json").hardlink_to(folder / "b.toml")


def contents_of_written_files(
    folder: Path, given: FilesAndCommandLineOfBrokenInput
) -> dict[str, bytes]:
    """The contents, by name, of the files that a run has added or changed in a folder."""
    found = {}
    for path in sorted(folder.rglob("*")):
        name = str(path.relative_to(folder))
        if path.is_file() and not path.is_symlink() and name != "hard.json":
            data = path.read_bytes()
            if data != given.files.get(name):
                found[name] = data
    return found


def run_input_in_this_process(given: FilesAndCommandLineOfBrokenInput) -> EndOfCommandLineRun:
    """Run the command line of an input in this process; returns how the run ended.

    This is faster than a new process, but an endless loop in compiled code cannot be stopped.
    """
    from drumlin.cli.process import run_command_line  # noqa: PLC0415

    before = Path.cwd()
    out, err = io.StringIO(), io.StringIO()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write_files_of_broken_input(given, folder)
        os.chdir(folder)
        start = time.process_time()
        try:
            with (
                contextlib.redirect_stdout(out),
                contextlib.redirect_stderr(err),
                warnings.catch_warnings(),
                _limit_run_time(),
            ):
                warnings.simplefilter("error")
                # A warning that one library calls a deprecated function of another one is no fault
                # of drumlin.
                warnings.filterwarnings("ignore", category=DeprecationWarning, module="(?!drumlin)")
                status = call_function_and_return_exit_status(lambda: run_command_line(given.words))
        finally:
            os.chdir(before)
        seconds = time.process_time() - start
        return EndOfCommandLineRun(
            status,
            out.getvalue(),
            err.getvalue(),
            contents_of_written_files(folder, given),
            seconds,
        )


class RunTooLong(BaseException):
    """Error: a run has taken too long. As a BaseException it is not caught by drumlin itself."""


@contextlib.contextmanager
def _limit_run_time() -> Iterator[None]:
    """Raise RunTooLong in a `with` block that takes too much processor time or wall-clock time.

    Windows has no such timers; there the block may take any time.
    """
    if not hasattr(signal, "setitimer"):
        yield
        return

    def raise_run_too_long(*_: object) -> None:
        """Raise RunTooLong when a timer ends."""
        raise RunTooLong

    # One timer counts processor time, the other one wall-clock time.
    timers = (
        (signal.ITIMER_PROF, signal.SIGPROF, 1.5 * PROCESSOR_SECONDS_ABOVE_WHICH_RUN_IS_FAULT),
        (signal.ITIMER_REAL, signal.SIGALRM, WALL_SECONDS_AFTER_WHICH_RUN_IS_STOPPED),
    )
    before = [(sign, signal.signal(sign, raise_run_too_long)) for _, sign, _ in timers]
    for timer, _, seconds in timers:
        signal.setitimer(timer, seconds)
    try:
        yield
    finally:
        for timer, _, _ in timers:
            signal.setitimer(timer, 0)
        for sign, handler in before:
            signal.signal(sign, handler)


def run_command_of_input_in_new_process(
    given: FilesAndCommandLineOfBrokenInput, **more: Any
) -> EndOfCommandLineRun:
    """Run the command line of an input in a new process; returns how the run ended.

    `more` are further arguments of subprocess.run.
    """
    command = [sys.executable, "-c", "from drumlin.cli import main; main()"]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write_files_of_broken_input(given, folder)
        start = processor_time_of_ended_child_processes()
        words = [os.fsencode(word) for word in given.words]
        try:
            done = subprocess.run(
                [*map(os.fsencode, command), *words],
                cwd=folder,
                capture_output=True,
                timeout=WALL_SECONDS_AFTER_WHICH_RUN_IS_STOPPED,
                check=False,
                **more,
            )
        except subprocess.TimeoutExpired:
            return EndOfCommandLineRun(
                -1, "", "no end", {}, WALL_SECONDS_AFTER_WHICH_RUN_IS_STOPPED
            )
        seconds = processor_time_of_ended_child_processes() - start
        out, err = (text.decode(errors="replace") for text in (done.stdout, done.stderr))
        return EndOfCommandLineRun(
            done.returncode, out, err, contents_of_written_files(folder, given), seconds
        )


_PATTERN_OF_NON_FINITE_NUMBER = re.compile(
    r"(?<![\w'\"/.-])[-+]?(?:nan|inf|NaN|Infinity)(?![\w'\"/.])"
)
"""Pattern of a number in a text that is not finite; words and paths with "nan" do not match."""


def describe_fault_of_run(given: FilesAndCommandLineOfBrokenInput, end: EndOfCommandLineRun) -> str:
    """The fault with which the run of an input ended, as text, or "" if it ended well."""
    if end.seconds > PROCESSOR_SECONDS_ABOVE_WHICH_RUN_IS_FAULT:
        return f"took {end.seconds:.0f} s"
    if end.status not in {0, 2, 3}:
        return f"status {end.status}: {' '.join(end.err.split())[-300:]}"
    for name in ("out", "err"):
        control = re.search(r"[^\n -~\u00a0-\U0010ffff]", getattr(end, name))
        if control:
            return f"control character {control.group()!r} in std{name}"
    return (
        _describe_fault_of_refused_run(end)
        if end.status
        else _describe_fault_of_successful_run(given, end)
    )


INITIALS_OF_ALLOWED_LEFTOVER_FILES = ("m/", "m.", "t.csv")
"""First letters of the names of files that a run may leave although it ends with an error.

The files are meshes that were written before the error, and the table and journal of a sweep.
"""
_JOURNAL_REPAIR_LINE_PATTERN = re.compile(r"(?:drumlin: t\.csv\.journal: [^\n]*\n)*")
"""Pattern of the lines in which a sweep reports that it has repaired its journal."""


def _describe_fault_of_refused_run(end: EndOfCommandLineRun) -> str:
    """The fault of a run with exit status 2 or 3, as text, or "" if it ended well."""
    said = _JOURNAL_REPAIR_LINE_PATTERN.sub("", end.err, count=1)
    if said.count("\n") != 1 or not said.startswith("drumlin: "):
        # The error message of a sweep that refuses its journal matches _JOURNAL_REPAIR_LINE_PATTERN
        # too, and must not be removed as a note.
        said = end.err
    if said.count("\n") != 1 or not said.startswith("drumlin: "):
        return f"not one line: {end.err[:200]!r}"
    if any(not name.startswith(INITIALS_OF_ALLOWED_LEFTOVER_FILES) for name in end.written):
        return f"files of a refused run: {', '.join(end.written)[:200]}"
    return ""


def _describe_fault_of_successful_run(
    given: FilesAndCommandLineOfBrokenInput, end: EndOfCommandLineRun
) -> str:
    """The fault of a run with exit status 0, as text, or "" if it ended well."""
    if not _JOURNAL_REPAIR_LINE_PATTERN.fullmatch(end.err):
        return f"an answer with {end.err[:200]!r} in stderr"
    unexpected = _describe_unexpected_answer(given, end)
    if unexpected:
        return unexpected
    names = _shoe_names_like_non_finite_numbers(given)
    # The title of the brake and the names of shoes may be any text. They are left out of the search
    # for numbers that are not finite.
    _, _, numbers = end.out.partition(", drum turns")
    numbers = reduce(lambda text, name: text.replace(name, "_"), names, numbers or end.out)
    if _PATTERN_OF_NON_FINITE_NUMBER.search(numbers):
        return f"not finite: {_text_around_non_finite_number(numbers)}"
    if any(end.written.get(name) != data for name, data in given.right.items()):
        return f"not the right {', '.join(given.right)}"
    if set(end.written) & {name for name in given.files if name not in {"r.csv", "t.csv.journal"}}:
        return f"an input was written over: {', '.join(end.written)}"
    return next(
        (
            why
            for name, data in end.written.items()
            if (why := _describe_fault_of_written_file(name, data, names))
        ),
        "",
    )


def _describe_unexpected_answer(
    given: FilesAndCommandLineOfBrokenInput, end: EndOfCommandLineRun
) -> str:
    """Why the input has no answer, or another one than that of the run; "" if it may be right.

    The undamaged files of the input, if there are any, are solved in this process. The JSON files
    of both runs must be equal, apart from run times.
    """
    if given.must_fail:
        return "an answer of an input that has none"
    if not given.undamaged_files:
        return ""
    undamaged = given._replace(files=dict(given.undamaged_files), undamaged_files={})
    right = run_input_in_this_process(undamaged)
    data, right_data = _json_data_without_run_times(end), _json_data_without_run_times(right)
    if right.status == 0 and data == right_data:
        return ""
    return "another answer than that of the undamaged files"


def _json_data_without_run_times(end: EndOfCommandLineRun) -> dict[str, Any]:
    """The data of the JSON files that a run has written, by name, without its run times."""
    data = {name: json.loads(text) for name, text in end.written.items() if name.endswith(".json")}
    return {
        name: {key: value for key, value in answer.items() if key != "seconds"}
        for name, answer in data.items()
    }


def _shoe_names_like_non_finite_numbers(given: FilesAndCommandLineOfBrokenInput) -> list[str]:
    """Names of shoes in the brake file that contain a non-finite number, such as "inf mm"."""
    try:
        shoes = tomllib.loads(given.files.get("b.toml", b"").decode()).get("shoe", [])
        names = {str(shoe.get("name")) for shoe in shoes}
    except (ValueError, AttributeError, TypeError, RecursionError):
        return []
    return [name for name in names if _PATTERN_OF_NON_FINITE_NUMBER.search(name)]


def _text_around_non_finite_number(text: str) -> str:
    """The part of a text around its first number that is not finite; "" if all are finite."""
    match = _PATTERN_OF_NON_FINITE_NUMBER.search(text)
    return (
        ""
        if match is None
        else text[max(match.start() - 60, 0) : match.end() + 20].replace("\n", " ")
    )


def _describe_fault_of_written_file(name: str, data: bytes, names: Sequence[str]) -> str:
    """The fault of a file that a run has written, as text, or "" if it has none.

    Parameters
    ----------
    name : str
        Name of the file.
    data : bytes
        Content of the file.
    names : sequence of str
        Names of shoes that contain a non-finite number; in a table they are no fault.
    """
    if Path(name).name.startswith(".drumlin-"):
        return f"a temporary file is left: {name}"
    if data.startswith(b"{") and ".journal" not in name:
        try:
            json.loads(data, parse_constant=_refuse_non_finite_json_word)
        except ValueError as error:
            return f"{name}: {error}"
    if data.startswith((b"shoe,", b"case,")):
        for row in csv.reader(io.StringIO(data.decode())):
            if any(
                _PATTERN_OF_NON_FINITE_NUMBER.fullmatch(cell) for cell in row if cell not in names
            ):
                return f"{name}: {row}"
            if any(cell[:1] in {"=", "@", "\t"} for cell in row):
                return f"{name}: a formula: {row}"
    return ""


def _refuse_non_finite_json_word(word: str) -> float:
    """Raise ValueError for the word NaN or Infinity, which Python's JSON reader would accept."""
    raise ValueError(f"holds {word}")
