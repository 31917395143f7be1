"""Arguments and options of the commands, each as a type with its help text.

Options that several commands share are here, and options with long help texts.
"""

from pathlib import Path
from typing import Annotated, Any

import typer

from drumlin.base.errors import BadInput

BrakeFiles = Annotated[
    list[Path], typer.Argument(metavar="BRAKE.toml...", help="one brake file or more")
]
BrakeFile = Annotated[Path, typer.Argument(metavar="BRAKE.toml", help="the brake file")]

# Options of the finite-element model.

Elements = Annotated[int | None, typer.Option(help="finite elements along each lining")]
ParametricMeshKind = Annotated[
    str | None, typer.Option(metavar="quad2|quad1|tri2|tri1", help="kind of the parametric mesh")
]
Penalty = Annotated[
    str | None, typer.Option(metavar="ALPHA|inf", help="contact stiffness as a multiple of E/t")
]
ErrorTolerance = Annotated[
    float | None,
    typer.Option(
        help="refine until the estimated errors of p (L2) and torque are below it; on mesh files "
        "as far as possible"
    ),
]
FiniteWidth = Annotated[
    bool,
    typer.Option(
        "--finite-width", help="correct torque, p and reactions for the widths of the shoes"
    ),
]
AlsoSolid = Annotated[
    bool, typer.Option("--solid", help="also by solid shoes with their widths, which takes longer")
]
NoModelError = Annotated[
    bool, typer.Option("--no-model-error", help="leave out the error of plane stress itself")
]

# Options of the elastic foundation and of solid shoes.

FoundationSections = Annotated[
    int | None, typer.Option(help="sections of each beam of the foundation model")
]
LiftedSimplifications = Annotated[
    list[str] | None,
    typer.Option(metavar="NAME|all", help="simplification of the foundation model to lift"),
]
DegreeAcrossWidth = Annotated[
    int | None, typer.Option(help="degree of the polynomials across the width of solid shoes")
]
FieldsFile = Annotated[
    Path | None,
    typer.Option(metavar="FILE.vtu", help="write p, displacements and stresses inside the shoes"),
]
WithFieldsFile = Annotated[
    bool,
    typer.Option("--fields", help="write p, displacements and stresses as fields.vtu, too"),
]
AnalysisModel = Annotated[
    str, typer.Option(metavar="fem|solid", help="plane stress, or shoes with their widths")
]
WearingModel = Annotated[
    str, typer.Option(metavar="fem|solid|foundation", help="the elastic model that is worn in")
]

# Options that belong to one or two commands.

ResponseJson = Annotated[
    Path | None,
    typer.Option(
        "--json", metavar="FILE", help="write the response as JSON; of several brakes as a list"
    ),
]
StatesJson = Annotated[
    Path | None, typer.Option("--json", metavar="FILE", help="write all states as JSON")
]
SlopesJson = Annotated[
    Path | None, typer.Option("--json", metavar="FILE", help="write them as JSON")
]
PressureFile = Annotated[
    Path | None,
    typer.Option(metavar="FILE", help="write the pressures as CSV, a table that check takes"),
]
Verbose = Annotated[
    bool,
    typer.Option("--verbose", "-v", help="figures of merit, how it was solved, what is left out"),
]
Rotation = Annotated[
    str | None,
    typer.Option(
        metavar="ANGLE",
        help='how far the drum is turned, such as "0.02 deg", on a plane the body slid; '
        "default: to full slip",
    ),
]
SlidingDistance = Annotated[
    str | None,
    typer.Option(
        help='sliding distance, such as "20 km", or a number of 1/(k K), K = E/t; '
        "default: until settled"
    ),
]
WearCoefficient = Annotated[
    str | None,
    typer.Option(
        metavar="K", help='of wear, such as "1e-5 mm^3/(N m)"; with an exponent: at 1 MPa'
    ),
]
HeldTorque = Annotated[
    str | None, typer.Option(help="hold this torque by the force, not the force")
]
WantedTorque = Annotated[
    str | None,
    typer.Option(
        metavar="TORQUE|largest",
        help='wanted torque, such as "400 N m"; on a plane a braking force; '
        "largest: the largest one in the range",
    ),
]
WantedPeakPressure = Annotated[
    str | None,
    typer.Option(
        metavar="PRESSURE",
        help='peak pressure, such as "1 MPa": with --torque a limit, else wanted',
    ),
]
SizedFile = Annotated[
    Path | None, typer.Option("--write", metavar="FILE.toml", help="write the sized brake")
]
ReversalDistance = Annotated[
    str | None, typer.Option(help="the drum turns back after every such distance")
]
GuidedAlongMiddleRadius = Annotated[
    bool, typer.Option("--guided", help="rigid shoes moving along their middle radius")
]
ReportFolder = Annotated[Path | None, typer.Option(metavar="DIR", help="folder of the report")]


def command_options_given_by_user(**options: Any) -> dict[str, Any]:
    """The options that the user has given, by name: all whose value is neither None nor False.

    Raises BadInput if the number of elements is out of range.
    """
    from drumlin.models import model_options_given_by_user

    return model_options_given_by_user(**options)


def penalty_as_number(penalty: str | None) -> float | None:
    """The contact stiffness that --penalty gives, as a number; None if the option is not given.

    Raises BadInput where the given text is no number.
    """
    if penalty is None:
        return None
    try:
        return float(penalty)
    except ValueError as error:
        raise BadInput(
            f"--penalty = {penalty!r}: must be a number greater than 0, or inf"
        ) from error
