"""All commands, in the order of the help."""

import typer

from drumlin.cli.exploring import explore
from drumlin.cli.judging import check, cost, reference
from drumlin.cli.outputs import export, mesh, view
from drumlin.cli.solving import compare, hold, sensitivity, solve, wear
from drumlin.cli.studying import study, sweep

app = typer.Typer(
    add_completion=False,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    help="Shoe brakes by their pressure laws and by finite elements in frictional contact, side by side.",
)
for command in (
    solve, compare, study, sweep, view, explore, mesh, export, hold, sensitivity, wear, cost, reference, check,
):  # fmt: skip
    app.command()(command)
