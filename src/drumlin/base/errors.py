"""Exceptions by which drumlin ends without a number, and the line and exit status of each fault."""

import errno
import sys
import traceback
from collections.abc import Callable
from pathlib import Path

from drumlin.base.texts import one_line

SHORT_OF = {
    code
    for name in ("ENOSPC", "EDQUOT", "EFBIG", "EIO", "ENOMEM", "EMFILE", "ENFILE", "EAGAIN")
    if (code := getattr(errno, name, None)) is not None
}
"""Errors of a system that is short of disk, memory, files or processes. No input causes them."""


class DrumlinError(Exception):
    """A problem that is said in one line; `exit_status` is what the command line returns."""

    exit_status = 1

    def __str__(self) -> str:
        return one_line(super().__str__())


class BadInput(DrumlinError):
    """The input is wrong: the line names the key, the value and what is allowed."""

    exit_status = 2


class NoAnswer(DrumlinError):
    """The input is right but has no answer: self-locking, no equilibrium, not converged."""

    exit_status = 3


class LostDigits(NoAnswer):
    """There is an answer, but stiffnesses or sizes are too far apart for the arithmetic."""


class Stopped(BaseException):
    """A signal asks the process to end.

    A file that is being written is given up, and no code may catch this exception on its way.
    """

    def __init__(self, signal: int) -> None:
        super().__init__("stopped by a signal")
        self.exit_status = 128 + signal


def reason_of(error: BaseException) -> str:
    """What the system says of an error, without the name of the file."""
    return (
        (error.strerror if isinstance(error, OSError) else None)
        or str(error)
        or type(error).__name__
    )


def file_fault(path: object, doing: str, error: BaseException) -> DrumlinError:
    """The fault of a file that cannot be read or written (`doing` says which).

    It is NoAnswer where the system is short of something, else BadInput.
    """
    short = isinstance(error, OSError) and error.errno in SHORT_OF
    return (NoAnswer if short else BadInput)(f"{path}: cannot be {doing} ({reason_of(error)})")


def line_and_status(error: BaseException) -> tuple[str, int]:
    """Line of a process on the exception that ends it (empty: no line), and its exit status.

    2 bad input, 3 no answer, 128 + its number for a signal; 1 is a fault of drumlin itself.
    """
    line, status = _line_and_status(error)
    return one_line(line), status


def _line_and_status(error: BaseException) -> tuple[str, int]:
    if isinstance(error, DrumlinError | Stopped):
        line, status = str(error), error.exit_status
    elif isinstance(error, KeyboardInterrupt):
        line, status = "stopped", 130
    elif isinstance(error, BrokenPipeError):
        line, status = "", 141  # whoever read it has seen enough
    elif isinstance(error, MemoryError):
        line, status = "not enough memory", 3
    elif isinstance(error, ModuleNotFoundError) and not str(error.name).startswith("drumlin"):
        line, status = f"needs the package {error.name!r}, which is not installed", 3
    elif isinstance(error, ImportError):
        line, status = f"a package cannot be loaded: {error}", 3
    elif isinstance(error, OSError):
        where = "" if error.filename is None else f"{error.filename}: "
        line, status = f"{where}{reason_of(error)}", 3 if error.errno in SHORT_OF else 2
    else:
        place = traceback.extract_tb(error.__traceback__)[-1:]
        at = "".join(f" ({Path(frame.filename).name}:{frame.lineno})" for frame in place)
        line, status = (
            f"unexpected {type(error).__name__}: {error}{at}; a fault of drumlin, please report it",
            1,
        )
    return "; ".join([line, *getattr(error, "__notes__", ())]), status


def ended(run: Callable[[], int]) -> int:
    """The exit status of `run`, or that of the exception that ends it.

    The line of the exception goes to standard error.
    """
    try:
        return run()
    except SystemExit as error:
        return error.code if isinstance(error.code, int) else int(error.code is not None)
    except BaseException as error:
        line, status = line_and_status(error)
        if line and sys.stderr is not None:
            print(f"drumlin: {line}", file=sys.stderr)  # noqa: T201  (the last word of a process)
        return status
