"""Arguments and options of the commands, each as a type with its help text.

Options that several commands share are here, and options with long help texts.
"""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import typer

from drumlin.base.errors import BadInput
from drumlin.base.written_numbers import number_without_unit_from_text


def parser_of_number_option(option: str) -> Callable[[object], float]:
    """The function that reads the value of an option, a number as people write it.

    The function reads "0,5" and "0.1 %", too. It raises BadInput for a text that is no number, and
    for a number that has two readings.
    """

    def number_of_option(value: object) -> float:
        """The number that the user gave; the default of the option is a number already."""
        try:
            found = number_without_unit_from_text(value)
            if not isinstance(found, int | float):
                raise ValueError(f"must be a number{_hint_about_underscore(value)}")
        except ValueError as error:
            raise BadInput(f"{option} = {value!r}: {error}") from error
        return found

    return number_of_option


def parser_of_whole_number_option(option: str) -> Callable[[object], int]:
    """The function that reads the value of an option, a whole number as people write it.

    The function reads "6.0" and "1 500", too. It raises BadInput for any other text, such as "1e3":
    a count has no exponent.
    """

    def whole_number_of_option(value: object) -> int:
        """The whole number that the user gave; the default of the option is a number already."""
        try:
            found = number_without_unit_from_text(value)
            is_whole = isinstance(found, int | float) and float(found).is_integer()
            if not is_whole or "e" in str(value).lower():
                raise ValueError(f"must be a whole number{_hint_about_underscore(value)}")
        except ValueError as error:
            raise BadInput(f"{option} = {value!r}: {error}") from error
        return int(found)  # type: ignore[call-overload]

    return whole_number_of_option


def _hint_about_underscore(value: object) -> str:
    """A hint for an error message about a text with an underscore between digits, or ""."""
    return " without underscores" if "_" in str(value) else ""


BrakeFilesArgument = Annotated[
    list[Path], typer.Argument(metavar="BRAKE.toml...", help="one brake file or more")
]
BrakeFileArgument = Annotated[Path, typer.Argument(metavar="BRAKE.toml", help="the brake file")]

# Options of the finite-element model.

ElementsOption = Annotated[
    int | None,
    typer.Option(
        parser=parser_of_whole_number_option("--elements"),
        metavar="<int>",
        help="finite elements along each lining",
    ),
]
ParametricMeshKindOption = Annotated[
    str | None, typer.Option(metavar="quad2|quad1|tri2|tri1", help="kind of the parametric mesh")
]
PenaltyOption = Annotated[
    str | None, typer.Option(metavar="ALPHA|inf", help="contact stiffness as a multiple of E/t")
]
ErrorToleranceOption = Annotated[
    float | None,
    typer.Option(
        parser=parser_of_number_option("--tolerance"),
        metavar="<float>",
        help="refine until the estimated errors of p (L2) and torque are below it; on mesh files "
        "as far as possible",
    ),
]
FiniteWidthOption = Annotated[
    bool,
    typer.Option(
        "--finite-width", help="correct torque, p and reactions for the widths of the shoes"
    ),
]
AlsoSolidOption = Annotated[
    bool, typer.Option("--solid", help="also by solid shoes with their widths, which takes longer")
]
NoModelErrorOption = Annotated[
    bool, typer.Option("--no-model-error", help="leave out the error of plane stress itself")
]

# Options of the elastic foundation and of solid shoes.

FoundationSectionsOption = Annotated[
    int | None,
    typer.Option(
        parser=parser_of_whole_number_option("--sections"),
        metavar="<int>",
        help="sections of each beam of the foundation model",
    ),
]
LiftedSimplificationsOption = Annotated[
    list[str] | None,
    typer.Option(metavar="NAME|all", help="simplification of the foundation model to lift"),
]
DegreeAcrossWidthOption = Annotated[
    int | None,
    typer.Option(
        parser=parser_of_whole_number_option("--across"),
        metavar="<int>",
        help="degree of the polynomials across the width of solid shoes",
    ),
]
FieldsFileOption = Annotated[
    Path | None,
    typer.Option(metavar="FILE.vtu", help="write p, displacements and stresses inside the shoes"),
]
WithFieldsFileOption = Annotated[
    bool,
    typer.Option("--fields", help="write p, displacements and stresses as fields.vtu, too"),
]
AnalysisModelOption = Annotated[
    str, typer.Option(metavar="fem|solid", help="plane stress, or shoes with their widths")
]
WearingModelOption = Annotated[
    str, typer.Option(metavar="fem|solid|foundation", help="the elastic model that is worn in")
]

# Options that belong to one or two commands.

ResponseJsonOption = Annotated[
    Path | None,
    typer.Option(
        "--json", metavar="FILE", help="write the response as JSON; of several brakes as a list"
    ),
]
StatesJsonOption = Annotated[
    Path | None, typer.Option("--json", metavar="FILE", help="write all states as JSON")
]
SlopesJsonOption = Annotated[
    Path | None, typer.Option("--json", metavar="FILE", help="write them as JSON")
]
PressureFileOption = Annotated[
    Path | None,
    typer.Option(metavar="FILE", help="write the pressures as CSV, a table that check takes"),
]
VerboseOption = Annotated[
    bool,
    typer.Option("--verbose", "-v", help="figures of merit, how it was solved, what is left out"),
]
VerboseComparisonOption = Annotated[
    bool, typer.Option("--verbose", "-v", help="how each model models the brake and solved it")
]
RotationOption = Annotated[
    str | None,
    typer.Option(
        metavar="ANGLE",
        help='how far the drum is turned, such as "0.02 deg", on a plane the body slid; '
        "default: to full slip",
    ),
]
SlidingDistanceOption = Annotated[
    str | None,
    typer.Option(
        help='sliding distance, such as "20 km", or a number of 1/(k K), K = E/t; '
        "default: until settled"
    ),
]
WearCoefficientOption = Annotated[
    str | None,
    typer.Option(
        metavar="K", help='of wear, such as "1e-5 mm^3/(N m)"; with an exponent: at 1 MPa'
    ),
]
HeldTorqueOption = Annotated[
    str | None, typer.Option(help="hold this torque by the force, not the force")
]
WantedTorqueOption = Annotated[
    str | None,
    typer.Option(
        metavar="TORQUE|largest",
        help='wanted torque, such as "400 N m"; on a plane a braking force; '
        "largest: the largest one in the range",
    ),
]
WantedPeakPressureOption = Annotated[
    str | None,
    typer.Option(
        metavar="PRESSURE",
        help='peak pressure, such as "1 MPa": with --torque a limit, else wanted',
    ),
]
SizedFileOption = Annotated[
    Path | None, typer.Option("--write", metavar="FILE.toml", help="write the sized brake")
]
ReversalDistanceOption = Annotated[
    str | None, typer.Option(help="the drum turns back after every such distance")
]
GuidedAlongMiddleRadiusOption = Annotated[
    bool, typer.Option("--guided", help="rigid shoes moving along their middle radius")
]
ReportFolderOption = Annotated[
    Path | None, typer.Option(metavar="DIR", help="folder of the report")
]


def command_options_given_by_user(**options: Any) -> dict[str, Any]:
    """The options that the user has given, by name: all whose value is neither None nor False.

    Raises BadInput if the number of elements is out of range.
    """
    from drumlin.models import model_options_given_by_user

    return model_options_given_by_user(**options)


def penalty_as_number(penalty: str | None) -> float | None:
    """The contact stiffness that --penalty gives, as a number; None if the option is not given.

    Raises BadInput for a text that is no number, and for a number that has two readings.
    """
    if penalty is None:
        return None
    if penalty.strip().lower() in {"inf", "infinity"}:
        return math.inf
    try:
        found = number_without_unit_from_text(penalty)
    except ValueError as error:
        raise BadInput(f"--penalty = {penalty!r}: {error}") from error
    if not isinstance(found, float):
        raise BadInput(f"--penalty = {penalty!r}: must be a number greater than 0, or inf")
    return found
