"""The exceptions with which drumlin refuses, and the line and exit status of every exception.

A refusal is one plain line for the user. Any other exception gets a line and a status here as well.
"""

import errno
import sys
import traceback
from collections.abc import Callable
from pathlib import Path

from drumlin.base.texts import one_line

_SHORTAGES = ("ENOSPC", "EDQUOT", "EFBIG", "EIO", "ENOMEM", "EMFILE", "ENFILE", "EAGAIN")
SHORT_OF = {getattr(errno, name) for name in _SHORTAGES if hasattr(errno, name)}
"""Error numbers of a system that is short of disk, memory, files or processes. No input is to blame
for them, so that they end as NoAnswer, not as BadInput. Some systems lack some of the numbers.
"""


class DrumlinError(Exception):
    """A problem that one line explains; `exit_status` is the status of the command line."""

    exit_status = 1

    def __str__(self) -> str:
        return one_line(super().__str__())


class BadInput(DrumlinError):
    """The input is wrong: the line names the key, the value and what is allowed."""

    exit_status = 2


class NoAnswer(DrumlinError):
    """The input is right and the question has no answer.

    Such are self-locking, no equilibrium, and not converged.
    """

    exit_status = 3


class LostDigits(NoAnswer):
    """An answer exists, but round-off hides it: stiffnesses or sizes are too far apart."""


class Stopped(BaseException):
    """A signal asks the process to end.

    A file that is being written is given up. No handler of ordinary exceptions catches this one.
    """

    def __init__(self, signal: int) -> None:
        super().__init__("stopped by a signal")
        self.exit_status = 128 + signal


def reason_of(error: BaseException) -> str:
    """The system's words on an error, without the name of the file."""
    by_system = error.strerror if isinstance(error, OSError) else None
    return by_system or str(error) or type(error).__name__


def file_fault(path: object, doing: str, error: BaseException) -> DrumlinError:
    """The exception for a file that cannot be read or written, as `doing` says.

    It is NoAnswer where the system is short of disk, memory or files, else BadInput.
    """
    short = isinstance(error, OSError) and error.errno in SHORT_OF
    kind = NoAnswer if short else BadInput
    return kind(f"{path}: cannot be {doing} ({reason_of(error)})")


def line_and_status(error: BaseException) -> tuple[str, int]:
    """The line that a process prints about the exception that ends it, and its exit status.

    An empty line means that nothing is printed. The status is 2 for bad input, 3 for no answer,
    128 + its number for a signal, and 1 for a fault of drumlin itself.
    """
    line, status = _line_and_status(error)
    return one_line(line), status


def _line_and_status(error: BaseException) -> tuple[str, int]:
    """As `line_and_status`; the line may still be long, or have more than one row."""
    if isinstance(error, DrumlinError | Stopped):
        line, status = str(error), error.exit_status
    elif isinstance(error, KeyboardInterrupt):
        line, status = "stopped", 130
    elif isinstance(error, BrokenPipeError):
        # The reader of the output has seen enough and has closed the pipe.
        line, status = "", 141
    elif isinstance(error, MemoryError):
        line, status = "not enough memory", 3
    elif isinstance(error, ModuleNotFoundError) and not str(error.name).startswith("drumlin"):
        line, status = f"needs the package {error.name!r}, which is not installed", 3
    elif isinstance(error, ImportError):
        line, status = f"a package cannot be loaded: {error}", 3
    elif isinstance(error, OSError):
        where = "" if error.filename is None else f"{error.filename}: "
        line = f"{where}{reason_of(error)}"
        status = 3 if error.errno in SHORT_OF else 2
    else:
        place = traceback.extract_tb(error.__traceback__)[-1:]
        at = "".join(f" ({Path(frame.filename).name}:{frame.lineno})" for frame in place)
        kind = type(error).__name__
        line = f"unexpected {kind}: {error}{at}; a fault of drumlin, please report it"
        status = 1
    return "; ".join([line, *getattr(error, "__notes__", ())]), status


def ended(run: Callable[[], int]) -> int:
    """The exit status of `run`, or of the exception that ends it.

    The line of the exception goes to standard error.
    """
    try:
        return run()
    except SystemExit as error:
        return error.code if isinstance(error.code, int) else int(error.code is not None)
    except BaseException as error:
        line, status = line_and_status(error)
        if line and sys.stderr is not None:
            # The process ends here, so that no printer of the command line is left.
            print(f"drumlin: {line}", file=sys.stderr)  # noqa: T201
        return status
