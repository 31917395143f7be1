"""Commands that judge answers.

The commands make reference values, compare a table with reference values, and time a solve.
"""

from pathlib import Path
from typing import Annotated

import typer

import drumlin
from drumlin.base.texts import error_text_in_percent
from drumlin.cli.options import (
    BrakeFileArgument,
    ElementsOption,
    PenaltyOption,
    command_options_given_by_user,
    parser_of_number_option,
    penalty_as_number,
)
from drumlin.cli.terminal import print_line_folded_to_terminal_width, show_spinner_beside_words


def cost(
    brake_file: BrakeFileArgument,
    elements: ElementsOption = None,
    penalty: PenaltyOption = None,
    by_size: Annotated[
        bool,
        typer.Option(
            "--table", help="against the unknowns, up to 1 000 000: some minutes, some 8 GiB"
        ),
    ] = False,
    model: Annotated[
        str,
        typer.Option(metavar="fem|solid", help="solid: its table by the degree across the width"),
    ] = "fem",
) -> None:
    """Compare the time of a solve with that of its parts and of a further load case.

    The parts are assembly, one factorisation and one back-substitution. All times are also given
    in default solves of the brake, which hardly depend on the machine.
    """
    from drumlin.verification.cost import time_and_memory_report_lines

    brake = drumlin.read_brake(brake_file)
    options = command_options_given_by_user(elements=elements, penalty=penalty_as_number(penalty))
    with show_spinner_beside_words("measuring"):
        lines = time_and_memory_report_lines(brake, model, by_size=by_size, **options)
        first = next(lines)
    print_line_folded_to_terminal_width(first, at_once=True)
    for line in lines:
        print_line_folded_to_terminal_width(line, at_once=True)


def reference(
    brake_file: BrakeFileArgument,
    output: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="where to write; default: NAME.reference.json"),
    ] = None,
) -> None:
    """Make reference values of a brake with uncertainties: torque, reactions, p(theta).

    Two programs that share nothing but the brake compute them.
    """
    path = output or Path(f"{brake_file.stem}.reference.json")
    with show_spinner_beside_words("columns of high degree, then triangles"):
        found = drumlin.reference(brake_file, path)
    effect, unit = (
        found.surface.word_for_torque_or_brake_force,
        found.surface.unit_of_torque_or_brake_force,
    )
    print_line_folded_to_terminal_width(
        f"{effect} {found.torque.value:.10g} {unit}, "
        f"uncertainty {found.torque.uncertainty:.1g} {unit}"
    )
    for shoe in found.shoes:
        print_line_folded_to_terminal_width(
            f"  shoe {shoe.name!r}: {effect} {shoe.torque.value:.10g} {unit}, "
            f"uncertainty {shoe.torque.uncertainty:.1g} {unit}; p uncertain by "
            f"{error_text_in_percent(shoe.relative_pressure_uncertainty_outside_edge_zones)} "
            f"of its peak away from the edges, "
            f"{error_text_in_percent(shoe.distance)} in L2"
        )
    print_line_folded_to_terminal_width(f"reference: {path}")


def check(
    brake_file: BrakeFileArgument,
    result: Annotated[
        Path,
        typer.Argument(
            metavar="RESULT.csv",
            help=r"columns 'shoe', 'theta \[deg]' (on a plane 'x \[mm]'), 'p \[MPa]'; other "
            r"units as well",
        ),
    ],
    known: Annotated[
        Path | None,
        typer.Option(
            "--reference", metavar="FILE", help="reference values; default: stored, else made anew"
        ),
    ] = None,
    tolerance: Annotated[
        float,
        typer.Option(
            parser=parser_of_number_option("--tolerance"),
            metavar="<float>",
            help="of p in L2 and of the torque, relative",
        ),
    ] = 0.01,
) -> None:
    """Compare anybody's p(theta) with reference values.

    The last line is the verdict. The exit status is 0 whatever the verdict is.
    """
    with show_spinner_beside_words("reading") as say:
        found = drumlin.check(brake_file, result, reference=known, tolerance=tolerance, say=say)
    print_line_folded_to_terminal_width(f"reference: {found.reference}")
    for line in found.lines():
        print_line_folded_to_terminal_width(line)
