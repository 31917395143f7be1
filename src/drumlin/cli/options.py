"""Arguments and options that several commands share."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from drumlin.base.errors import BadInput

if TYPE_CHECKING:
    from drumlin.brake.brake import Brake

BrakeFiles = Annotated[
    list[Path], typer.Argument(metavar="BRAKE.toml...", help="one brake file or more")
]
BrakeFile = Annotated[Path, typer.Argument(metavar="BRAKE.toml", help="the brake file")]
Elements = Annotated[int | None, typer.Option(help="finite elements along each lining")]
Kind = Annotated[
    str | None, typer.Option(metavar="quad2|quad1|tri2|tri1", help="kind of the parametric mesh")
]
FiniteWidth = Annotated[
    bool,
    typer.Option(
        "--finite-width", help="correct plane stress for the width; torque within 1.5 % of a solid"
    ),
]
Penalty = Annotated[
    str | None, typer.Option(metavar="ALPHA|inf", help="contact stiffness as a multiple of E/t")
]


def fem_options(
    elements: int | None, *, kind: str | None = None, penalty: str | None = None
) -> dict[str, Any]:
    """The options of the finite elements that were given. Raises BadInput for what they cannot be."""
    if elements is not None:
        from drumlin.fem.preparation.meshes import MOST_ELEMENTS

        if not 1 <= elements <= MOST_ELEMENTS:
            raise BadInput(f"--elements = {elements}: must be from 1 to {MOST_ELEMENTS}")
    given = {"elements": elements, "kind": kind}
    options: dict[str, Any] = {key: value for key, value in given.items() if value is not None}
    if penalty is not None:
        try:
            options["penalty"] = float(penalty)
        except ValueError as error:
            raise BadInput(
                f"--penalty = {penalty!r}: must be a number greater than 0, or inf"
            ) from error
    return options


def for_width(brake: "Brake", wanted: bool) -> tuple["Brake", list[str]]:
    """The brake, where it is `wanted` corrected for the widths of its shoes, and a line that says
    so.
    """
    if not wanted:
        return brake, []
    from drumlin.fem.preparation.finite_width import finite_width, said

    other = finite_width(brake)
    return other, [said(brake, other)]
