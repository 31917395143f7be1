"""The process of the command line: signals, streams, the command itself and the exit status.

Exit status 0 means an answer, 2 bad input and 3 no answer; in the last two cases one plain line
says why. A signal ends the process with 128 plus its number. Status 1 is a fault of drumlin itself.
Heavy modules are imported after `main` has started, so that a fault in an import is one line too.
"""

import gc
import os
import signal
import sys
import warnings
from collections.abc import Sequence
from io import TextIOWrapper
from pathlib import Path
from typing import Any, NoReturn

from drumlin.base.errors import BadInput, NoAnswer, Stopped, ended, file_fault

COMPLETING = "_DRUMLIN_COMPLETE"
"""Environment variable by which a shell asks click for the words that may come next."""
GARBAGE_THRESHOLD = 20_000
"""Objects that may be created before Python looks for garbage; its default is 700.

Imported modules stay until the end. With the default, Python searches them again and again, which
takes 3 % of a solve.
"""


def main() -> NoReturn:
    """Run the command line of this process, and end the process with its exit status."""
    sys.exit(ended(_main))


def _main() -> int:
    """Prepare the process and run its command line; returns the exit status."""
    _catch_signals()
    _settle_streams()
    _settle_imports()
    gc.set_threshold(GARBAGE_THRESHOLD)
    # Warnings are for those who write programs; python -W default shows them.
    if not sys.warnoptions:
        warnings.simplefilter("ignore")
    try:
        return run(sys.argv[1:])
    finally:
        _flush_output()


def _catch_signals() -> None:
    """Let SIGTERM and SIGHUP raise Stopped, except where they are ignored, as under nohup."""
    for name in ("SIGTERM", "SIGHUP"):
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, _stop)


def _flush_output() -> None:
    """Write out what is printed. Raises DrumlinError where standard output takes no more."""
    try:
        sys.stdout.flush()
    except OSError as error:
        # The interpreter flushes the stream once more at its end. That flush must not fail too.
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        if isinstance(error, BrokenPipeError):
            raise
        raise file_fault("standard output", "written", error) from error


def run(words: Sequence[str]) -> int:
    """Run a command line in this process; returns its exit status.

    Raises DrumlinError for bad input and for no answer; other exceptions are faults of drumlin.
    """
    import typer

    from drumlin.base.files import inputs_kept
    from drumlin.cli.commands import app

    # No shell can pass such a word. Python code can, and some versions of typer fall over it.
    for word in words:
        if "\0" in word:
            raise BadInput(f"argument {word!r}: it holds a NUL character, which is not allowed")
    command = typer.main.get_command(app)
    # A shell asks for the words that may come next; click answers and ends the process.
    if COMPLETING in os.environ:
        command(list(words), prog_name="drumlin")
    with inputs_kept():
        try:
            with command.make_context("drumlin", list(words) or ["--help"]) as context:
                command.invoke(context)
        except typer.Exit as end:
            return end.exit_code if words else 2
        except Exception as error:
            # Usage errors have this method, in click and in the copy of click that typer carries.
            if not hasattr(error, "format_message"):
                raise
            raise BadInput(_refused(error)) from error
    return 0


def _refused(error: Any) -> str:
    """A usage error as one line.

    Where the word of an option is no number, the line names the option and the word: newer versions
    of typer leave the word out.
    """
    from drumlin.brake.file import FAULT_TEXTS

    if hasattr(error.__cause__, "errors") and getattr(error, "param", None) is not None:
        fault = error.__cause__.errors()[0]
        if fault["type"] in FAULT_TEXTS:
            return f"{error.param.opts[-1]} = {fault['input']!r}: {FAULT_TEXTS[fault['type']]}"
    return str(error.format_message())


def _stop(number: int, _: object) -> None:
    """Raise Stopped, and ignore the signal from now on, so that nothing stops the cleaning up."""
    signal.signal(number, signal.SIG_IGN)
    raise Stopped(number)


def _settle_streams() -> None:
    """Make both output streams usable. Raises NoAnswer where standard output is closed.

    A letter that the terminal does not know, such as θ or µ, is printed as a question mark.
    """
    if sys.stderr is None:
        sys.stderr = Path(os.devnull).open("w", encoding="utf-8")  # noqa: SIM115  (until the end)
    if sys.stdout is None:
        raise NoAnswer("standard output is closed: there is nowhere to print the answer")
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="replace")


def _settle_imports() -> None:
    """Keep Python from importing files of the current folder, and matplotlib from opening windows.

    Both settings also hold for processes that this process starts.
    """
    os.environ["PYTHONSAFEPATH"] = "1"
    os.environ["MPLBACKEND"] = "agg"
    if not sys.flags.safe_path and _from_here(sys.path[:1]):
        del sys.path[0]
        # Without its first place, a drumlin that is run in its source folder does not find itself.
        root = str(Path(__file__).parents[2])
        if root not in sys.path:
            sys.path.append(root)


def _from_here(first: Sequence[str]) -> bool:
    """Whether Python looks for imports in the current folder first, as python -m and -c do."""
    try:
        return list(first) in ([""], [str(Path.cwd())])
    except OSError:
        # The current folder has been removed.
        return False
