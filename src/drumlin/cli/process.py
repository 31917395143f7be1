"""The process of the command line: signals, streams, the command itself and the exit status.

Exit status 0 means an answer, 2 bad input and 3 no answer; with 2 and 3 one plain line says why.
A signal ends the process with status 128 plus the number of the signal. Status 1 is a fault of
drumlin itself. Heavy modules are imported after `main` has started, so that a fault in an import
is reported as one line, too.
"""

import os
import signal
import sys
import warnings
from collections.abc import Sequence
from io import TextIOWrapper
from pathlib import Path
from typing import Any, NoReturn

from drumlin.base.errors import (
    BadInput,
    NoAnswer,
    StoppedBySignal,
    call_function_and_return_exit_status,
    exception_for_unusable_file,
)
from drumlin.base.garbage import (
    leave_memory_to_operating_system_at_end,
    search_memory_for_garbage_seldom,
)

SHELL_COMPLETION_VARIABLE = "_DRUMLIN_COMPLETE"
"""Environment variable that a shell sets to complete a command line with the Tab key.

The library click then answers with the words that may come next.
"""


def main() -> NoReturn:
    """Run the command line of this process, and end the process with its exit status."""
    status = call_function_and_return_exit_status(_prepare_process_and_run_command)
    leave_memory_to_operating_system_at_end()
    sys.exit(status)


def _prepare_process_and_run_command() -> int:
    """Prepare signals, streams and imports of this process, run its command, return exit status."""
    _make_termination_signals_raise_stopped()
    _replace_closed_streams_and_unprintable_letters()
    _exclude_current_folder_from_imports()
    search_memory_for_garbage_seldom()
    # Python's warnings concern programmers, not users. `python -W default` shows them.
    if not sys.warnoptions:
        warnings.simplefilter("ignore")
    try:
        return run_command_line(sys.argv[1:])
    finally:
        _flush_standard_output()


def _make_termination_signals_raise_stopped() -> None:
    """Let the signals SIGTERM and SIGHUP raise StoppedBySignal in this process.

    A signal that the process was started to ignore, as under nohup, stays ignored.
    """
    for name in ("SIGTERM", "SIGHUP"):
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, _raise_stopped_for_signal)


def _flush_standard_output() -> None:
    """Write out the printed lines that standard output still buffers.

    Raises DrumlinError where the lines cannot be written, as on a full disk, and BrokenPipeError
    where the reader of a pipe has gone.
    """
    try:
        sys.stdout.flush()
    except OSError as error:
        # Python flushes standard output once more at its end. The stream now leads to the null
        # device, so that this last flush cannot fail.
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        if isinstance(error, BrokenPipeError):
            raise
        raise exception_for_unusable_file("standard output", "written", error) from error


def run_command_line(words: Sequence[str]) -> int:
    """Run the command that `words` name in this process; returns the exit status.

    Raises DrumlinError for bad input and for no answer; other exceptions are faults of drumlin.
    """
    import typer

    from drumlin.base.files import protect_input_files_within_block
    from drumlin.cli.commands import app, application_for_command_line_words

    # Only Python code can pass a word with a NUL character; some versions of typer fail on it.
    for word in words:
        if "\0" in word:
            raise BadInput(f"argument {word!r}: it holds a NUL character, which is not allowed")
    # If a shell asks how to complete a command line, click prints the answer and ends the process.
    if SHELL_COMPLETION_VARIABLE in os.environ:
        typer.main.get_command(app)(list(words), prog_name="drumlin")
    command = typer.main.get_command(application_for_command_line_words(words))
    with protect_input_files_within_block():
        try:
            with command.make_context("drumlin", list(words) or ["--help"]) as context:
                command.invoke(context)
        except typer.Exit as end:
            return end.exit_code if words else 2
        except Exception as error:
            # An error with the method format_message is a usage error. Its class cannot be tested:
            # it belongs to click or to the copy of click inside typer.
            if not hasattr(error, "format_message"):
                raise
            raise BadInput(_usage_error_as_line(error)) from error
    return 0


def _usage_error_as_line(error: Any) -> str:
    """A usage error of the command line, such as a wrong option, as one line of text.

    Where the value of an option is no number, the line names the option and its value: newer
    versions of typer leave the value out.
    """
    from drumlin.brake.file import ALLOWED_VALUE_TEXT_BY_PYDANTIC_ERROR

    if hasattr(error.__cause__, "errors") and getattr(error, "param", None) is not None:
        fault = error.__cause__.errors()[0]
        if fault["type"] in ALLOWED_VALUE_TEXT_BY_PYDANTIC_ERROR:
            return (
                f"{error.param.opts[-1]} = {fault['input']!r}: "
                f"{ALLOWED_VALUE_TEXT_BY_PYDANTIC_ERROR[fault['type']]}"
            )
    return str(error.format_message())


def _raise_stopped_for_signal(number: int, _: object) -> None:
    """Raise StoppedBySignal for the signal with a number; the handler of SIGTERM and SIGHUP.

    From now on the signal is ignored, so that a second signal cannot interrupt the cleaning up.
    """
    signal.signal(number, signal.SIG_IGN)
    raise StoppedBySignal(number)


def _replace_closed_streams_and_unprintable_letters() -> None:
    """Make standard output and standard error usable.

    A closed standard error is replaced by a null device. A letter that the terminal does not know,
    such as θ or µ, is printed as a question mark. Raises NoAnswer where standard output is closed.
    """
    if sys.stderr is None:
        sys.stderr = Path(os.devnull).open("w", encoding="utf-8")  # noqa: SIM115  (until the end)
    if sys.stdout is None:
        raise NoAnswer("standard output is closed: there is nowhere to print the answer")
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="replace")


def _exclude_current_folder_from_imports() -> None:
    """Keep Python from importing files of the current folder, and matplotlib from opening windows.

    Both settings also hold for processes that this process starts.
    """
    os.environ["PYTHONSAFEPATH"] = "1"
    os.environ["MPLBACKEND"] = "agg"
    if not sys.flags.safe_path and _is_current_folder_searched_first(sys.path[:1]):
        del sys.path[0]
        # If Python found drumlin in the current folder, it would no longer find drumlin's further
        # modules. The folder is therefore added again, at the end of the search path.
        root = str(Path(__file__).parents[2])
        if root not in sys.path:
            sys.path.append(root)


def _is_current_folder_searched_first(first: Sequence[str]) -> bool:
    """Whether the first folder of Python's search path is the current folder.

    With `python -m` and `python -c` it is. `first` is a list with the first folder of the search
    path, or an empty list.
    """
    try:
        return list(first) in ([""], [str(Path.cwd())])
    except OSError:
        # The current folder does not exist any more, so that Python imports nothing from it.
        return False
