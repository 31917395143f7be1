"""The command line. Exit status: 0 an answer, 2 bad input, 3 no answer; one plain line in the last
two cases.

A signal ends it with 128 and its number, 1 is a fault of drumlin itself. Nothing heavy is imported
before `main` runs, so that even what goes wrong in an import is said in one line.
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

from drumlin.errors import BadInput, NoAnswer, Stopped, ended, file_fault

COMPLETING = "_DRUMLIN_COMPLETE"


def main() -> NoReturn:
    """Run the command line of this process, and end it."""
    sys.exit(ended(_main))


def _main() -> int:
    for name in ("SIGTERM", "SIGHUP"):
        if (
            hasattr(signal, name) and signal.getsignal(getattr(signal, name)) != signal.SIG_IGN
        ):  # as under nohup
            signal.signal(getattr(signal, name), _stop)
    _settle_streams()
    _settle_imports()
    gc.set_threshold(
        20_000
    )  # what is imported stays: to look for garbage in it as often as by default is 3 % of a solve
    if not sys.warnoptions:
        warnings.simplefilter(
            "ignore"
        )  # they are for those who write the program; -W default shows them
    try:
        return run(sys.argv[1:])
    finally:
        try:
            sys.stdout.flush()
        except OSError as error:
            os.dup2(
                os.open(os.devnull, os.O_WRONLY), 1
            )  # or else the interpreter's own flush fails once more
            if isinstance(error, BrokenPipeError):
                raise
            raise file_fault("standard output", "written", error) from error


def run(words: Sequence[str]) -> int:
    """Run a command line in this process; returns its exit status. Raises DrumlinError and whatever
    else goes wrong.
    """
    import typer

    from drumlin.cli.commands import app
    from drumlin.files import inputs_kept

    command = typer.main.get_command(app)
    if COMPLETING in os.environ:  # a shell asks what may come next
        command(list(words), prog_name="drumlin")
    with inputs_kept():
        try:
            with command.make_context("drumlin", list(words) or ["--help"]) as context:
                command.invoke(context)
        except typer.Exit as end:
            return end.exit_code if words else 2
        except Exception as error:
            if not hasattr(error, "format_message"):
                raise
            raise BadInput(_refused(error)) from error  # a usage error, of typer's click or another
    return 0


def _refused(error: Any) -> str:
    """A usage error in a line; where the word of an option is no number, with that word: older
    typers name it.
    """
    from drumlin.brake.file import FAULT_TEXTS

    if hasattr(error.__cause__, "errors") and getattr(error, "param", None) is not None:
        fault = error.__cause__.errors()[0]
        if fault["type"] in FAULT_TEXTS:
            return f"{error.param.opts[-1]} = {fault['input']!r}: {FAULT_TEXTS[fault['type']]}"
    return str(error.format_message())


def _stop(number: int, _: object) -> None:
    signal.signal(
        number, signal.SIG_IGN
    )  # once is enough: what is cleaned up now is not to be stopped
    raise Stopped(number)


def _settle_streams() -> None:
    """Both streams open, and with a ? for a letter such as θ or µ that the terminal does not know."""
    if sys.stderr is None:
        sys.stderr = Path(os.devnull).open("w", encoding="utf-8")  # noqa: SIM115  (until the end)
    if sys.stdout is None:
        raise NoAnswer("standard output is closed: there is nowhere to print the answer")
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="replace")


def _settle_imports() -> None:
    """Nothing is imported from the current folder, here or in processes that this one starts, and
    no window opened.
    """
    os.environ["PYTHONSAFEPATH"] = "1"
    os.environ["MPLBACKEND"] = "agg"
    if not sys.flags.safe_path and _from_here(sys.path[:1]):
        del sys.path[0]
        root = str(Path(__file__).parents[2])
        if root not in sys.path:
            sys.path.append(root)  # drumlin itself, run in the folder of its source


def _from_here(first: Sequence[str]) -> bool:
    """Whether the first place of imports is the current folder, as with python -m and -c."""
    try:
        return list(first) in ([""], [str(Path.cwd())])
    except OSError:
        return False  # the folder has been removed
