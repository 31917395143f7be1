"""drumlin's exceptions, and the message and exit status with which any exception ends a command.

Wrong input and a brake without an answer end a command with one plain line for the user. This
module also turns any other exception, such as a full disk, into one line and an exit status.
"""

import errno
import re
import sys
import traceback
from collections.abc import Callable
from pathlib import Path

from drumlin.base.texts import printable_single_line

# Names of error numbers, as in Python's module errno. The operating system reports these errors if
# disk space, memory, open files or processes run out, if a file becomes too large, or if a disk
# fails.
_ERRNO_NAMES_OF_RESOURCE_SHORTAGE = (
    "ENOSPC",
    "EDQUOT",
    "EFBIG",
    "EIO",
    "ENOMEM",
    "EMFILE",
    "ENFILE",
    "EAGAIN",
)
ERROR_NUMBERS_OF_RESOURCE_SHORTAGE = {
    getattr(errno, name) for name in _ERRNO_NAMES_OF_RESOURCE_SHORTAGE if hasattr(errno, name)
}
"""Error numbers by which the operating system says that a resource runs out or that a disk fails.

The resources are disk space, memory, open files and processes. drumlin reports them as NoAnswer and
not as BadInput, because the user's input does not cause them. Some operating systems do not define
all of these numbers.
"""


class DrumlinError(Exception):
    """A problem that its message explains in one line.

    `exit_status` is the exit status of the command that this exception ends. `command_line_text` is
    the message for the command line, with options such as `--model`; it is empty if the message is
    the same in Python.
    """

    exit_status = 1
    command_line_text = ""

    def __str__(self) -> str:
        return printable_single_line(super().__str__())

    def replace_options_by_python_arguments_in_message(self) -> None:
        """Change the message to the words of Python: `finite_width` in place of `--finite-width`.

        The message for the command line stays in `command_line_text`.
        """
        line = str(self)
        in_python = _text_with_options_replaced_by_python_arguments(line)
        if in_python != line:
            self.command_line_text, self.args = line, (in_python,)


PYTHON_ARGUMENTS_BY_DIFFERING_OPTION_NAME = {
    "from": "low",
    "to": "high",
    "no-model-error": "model_error=False",
}
"""Python arguments by the name of the command's option, where the two names differ.

The arguments are those of the functions that `import drumlin` gives.
"""


def _text_with_options_replaced_by_python_arguments(text: str) -> str:
    """A message in which Python arguments replace options: `model="fem"` for `--model fem`."""
    # Messages such as "--kind belongs to --model fem" name the model after a blank. In Python the
    # argument is model="fem".
    text = re.sub(r"(?<!\S)--model (\w+)", r'model="\1"', text)

    def python_argument_name_of_matched_option(option: re.Match[str]) -> str:
        """The name of the argument for an option; option[1] is the option's name without dashes."""
        return PYTHON_ARGUMENTS_BY_DIFFERING_OPTION_NAME.get(option[1], option[1].replace("-", "_"))

    return re.sub(r"(?<!\S)--([a-z][a-z-]*)", python_argument_name_of_matched_option, text)


class BadInput(DrumlinError):
    """The input is wrong; the message names the key, its value and the allowed values."""

    exit_status = 2


class FailedLawOfUser(BadInput):
    """The function of a law of the user fails, or returns something else than finite numbers.

    A comparison of models shows the law with this reason, and solves the other models.
    """


class NoAnswer(DrumlinError):
    """The input is right but the problem has no answer.

    Examples are a brake that locks itself, a shoe without equilibrium, and an iteration that does
    not converge.
    """

    exit_status = 3


class AnswerLostToRoundOff(NoAnswer):
    """Round-off hides an answer that exists.

    The cause is a brake whose stiffnesses or sizes differ by too many orders of magnitude.
    """


class AnswerBeyondModel(NoAnswer):
    """The model does not hold for the answer: a spring goes slack, or a shoe turns too far.

    The brake may have an equilibrium nevertheless.
    """


class StoppedBySignal(BaseException):
    """The exception for a signal of the operating system that asks the process to end.

    The exception lets `finally` blocks delete half-written files. The class derives from
    BaseException: code that handles ordinary exceptions (`except Exception`) must not catch it.
    """

    def __init__(self, signal: int) -> None:
        super().__init__("stopped by a signal")
        self.exit_status = 128 + signal


def system_message_of_error(error: BaseException) -> str:
    """The message of an error as the operating system words it, without the name of the file."""
    by_system = error.strerror if isinstance(error, OSError) else None
    return by_system or str(error) or type(error).__name__


def exception_for_unusable_file(path: object, doing: str, error: BaseException) -> DrumlinError:
    """Return the exception to raise for a file that cannot be read or written.

    The exception is NoAnswer if disk, memory or the number of open files is exhausted, else
    BadInput.

    Parameters
    ----------
    path : path of the file
    doing : "read" or "written", the word in the message for what failed
    error : the exception of the operating system
    """
    short = isinstance(error, OSError) and error.errno in ERROR_NUMBERS_OF_RESOURCE_SHORTAGE
    kind = NoAnswer if short else BadInput
    return kind(f"{path}: cannot be {doing} ({system_message_of_error(error)})")


def is_failure_of_memory_or_system(error: BaseException | None) -> bool:
    """Whether a lack of memory, or the operating system, caused an error, and not the input."""
    # A model may catch an error of the system and raise a refusal in its place. Python keeps the
    # first error as the cause of the refusal, so that the causes are examined, too.
    while error is not None:
        if isinstance(error, MemoryError | OSError):
            return True
        error = error.__cause__ or error.__context__
    return False


def text_of_error_for_command_line(error: BaseException) -> str:
    """The message of an error for the command line, with options in place of Python arguments."""
    return getattr(error, "command_line_text", "") or str(error)


def error_line_and_exit_status(error: BaseException) -> tuple[str, int]:
    """Line to print about the exception that ends a process, and the exit status of the process.

    If the line is empty, nothing is to be printed. The exit status is 2 for wrong input, 3 if there
    is no answer or if memory, disk or a package is lacking, 128 plus the signal's number after a
    signal, and 1 for a fault of drumlin itself.
    """
    line, status = _error_line_of_any_length_and_exit_status(error)
    return printable_single_line(line), status


def _error_line_of_any_length_and_exit_status(error: BaseException) -> tuple[str, int]:
    """The line of text about an exception, and the exit status of the command.

    The text may still be too long, or have line breaks.
    """
    if isinstance(error, DrumlinError | StoppedBySignal):
        line, status = text_of_error_for_command_line(error), error.exit_status
    elif isinstance(error, KeyboardInterrupt):
        line, status = "stopped", 130
    elif isinstance(error, BrokenPipeError):
        # The program that reads the output, such as `head`, has closed the pipe: nothing is wrong.
        line, status = "", 141
    elif isinstance(error, MemoryError):
        line, status = "not enough memory", 3
    # A missing module of another package is an optional package that is not installed. A missing
    # module of drumlin is a fault of drumlin.
    elif isinstance(error, ModuleNotFoundError) and not str(error.name).startswith("drumlin"):
        line, status = f"needs the package {error.name!r}, which is not installed", 3
    elif isinstance(error, ImportError):
        line, status = f"a package cannot be loaded: {error}", 3
    elif isinstance(error, OSError):
        where = "" if error.filename is None else f"{error.filename}: "
        line = f"{where}{system_message_of_error(error)}"
        status = 3 if error.errno in ERROR_NUMBERS_OF_RESOURCE_SHORTAGE else 2
    else:
        # An unexpected exception is a fault of drumlin: the line names the file and its line.
        place = traceback.extract_tb(error.__traceback__)[-1:]
        at = "".join(f" ({Path(frame.filename).name}:{frame.lineno})" for frame in place)
        kind = type(error).__name__
        line = f"unexpected {kind}: {error}{at}; a fault of drumlin, please report it"
        status = 1
    return "; ".join([line, *getattr(error, "__notes__", ())]), status


def call_function_and_return_exit_status(run: Callable[[], int]) -> int:
    """Call `run` and return its exit status, or the exit status of the exception that it raises.

    The line about the exception is printed to standard error.
    """
    try:
        return run()
    except SystemExit as error:
        return error.code if isinstance(error.code, int) else int(error.code is not None)
    except BaseException as error:
        line, status = error_line_and_exit_status(error)
        if line and sys.stderr is not None:
            # The exception has ended the command, so that the functions by which commands print
            # cannot be used here.
            print(f"drumlin: {line}", file=sys.stderr)  # noqa: T201
        return status
