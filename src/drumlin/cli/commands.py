"""The command-line application with all its commands, in the order of `drumlin --help`."""

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

app = typer.Typer(
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _print_version_and_exit(asked: bool) -> None:
    """Print the version of drumlin and end the process, if --version is given (`asked`)."""
    if asked:
        print_line_folded_to_terminal_width(f"drumlin {__version__}")
        raise typer.Exit


@app.callback()
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


# Each function is a command by its own name, in the order of the help.
for command in (
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
):
    app.command()(command)
