"""The command-line application with all its commands, in the order of `drumlin --help`."""

from collections.abc import Callable, Iterable, Sequence
from typing import Annotated

import typer

from drumlin import __version__
from drumlin.cli.exploring import explore
from drumlin.cli.judging import check, cost, reference
from drumlin.cli.outputs import export, mesh, view
from drumlin.cli.solving import compare, hold, sensitivity, size, solve, wear
from drumlin.cli.starting import init, schema
from drumlin.cli.studying import study, sweep
from drumlin.cli.terminal import print_line_folded_to_terminal_width

COMMAND_FUNCTIONS = (
    init,
    solve,
    compare,
    study,
    sweep,
    view,
    explore,
    mesh,
    export,
    hold,
    sensitivity,
    size,
    wear,
    cost,
    reference,
    check,
    schema,
)
"""The functions of all commands, in the order of the help; each is a command by its own name."""


def _print_version_and_exit(asked: bool) -> None:
    """Print the version of drumlin and end the process, if --version is given (`asked`)."""
    if asked:
        print_line_folded_to_terminal_width(f"drumlin {__version__}")
        raise typer.Exit


def _take_options_before_any_command(
    version: Annotated[
        bool,
        typer.Option(
            "--version",
            callback=_print_version_and_exit,
            is_eager=True,
            help="print the version and end",
        ),
    ] = False,
) -> None:
    """Shoe brakes by pressure laws and by finite elements in frictional contact, side by side."""


def make_command_line_application(commands: Iterable[Callable[..., None]]) -> typer.Typer:
    """Make the application with these functions as its commands."""
    made = typer.Typer(
        no_args_is_help=True,
        pretty_exceptions_enable=False,
        context_settings={"help_option_names": ["-h", "--help"]},
    )
    made.callback()(_take_options_before_any_command)
    for command in commands:
        made.command()(command)
    return made


app = make_command_line_application(COMMAND_FUNCTIONS)
"""The application with all commands."""


def application_for_command_line_words(words: Sequence[str]) -> typer.Typer:
    """The application with the command that `words` begin with, or with all commands.

    typer reads the options of every command that an application has, which takes some 4 % of the
    time of a solve.
    """
    named = [command for command in COMMAND_FUNCTIONS if list(words[:1]) == [command.__name__]]
    return make_command_line_application(named) if named else app
