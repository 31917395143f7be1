"""Commands that judge answers: reference values, comparison with them, what a solve costs."""

from pathlib import Path
from typing import Annotated

import typer

from drumlin.base.errors import BadInput
from drumlin.base.texts import typed
from drumlin.cli.options import BrakeFile, Elements, Penalty, fem_options
from drumlin.cli.terminal import busy, tell


def cost(
    brake_file: BrakeFile,
    elements: Elements = None,
    penalty: Penalty = None,
    by_size: Annotated[
        bool,
        typer.Option(
            "--table", help="against the unknowns, up to 1 000 000: some minutes, some 8 GiB"
        ),
    ] = False,
    model: Annotated[
        str, typer.Option(metavar="fem|solid", help="solid: its table, up to 100 000 unknowns")
    ] = "fem",
) -> None:
    """Measure a solve against its own assembly, factorisation and back-substitution, and a further
    load case.
    """
    from drumlin.brake.plane_brake import read_any
    from drumlin.fem.solve import check_divided
    from drumlin.models import pick
    from drumlin.verification.cost import measure, solid_table, table

    brake = read_any(brake_file)
    if model not in {"fem", "solid"}:
        raise BadInput(f"--model = {model!r}: has no cost to print; allowed: fem, solid")
    pick(model, brake)
    brake.check_meshable()
    check_divided(brake, elements=elements)
    options = fem_options(elements, penalty=penalty)
    if by_size and options:
        raise BadInput("--table chooses the elements itself; leave out --elements and --penalty")
    if model == "solid" and options:
        raise BadInput(
            "--model solid chooses the elements itself; leave out --elements and --penalty"
        )
    if by_size or model == "solid":
        for line in (table if model == "fem" else solid_table)(brake):
            tell(line, at_once=True)
        return
    with busy("measuring"):
        lines = measure(brake, **options)
    for line in lines:
        tell(line)


def reference(
    brake_file: BrakeFile,
    output: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="where to write; default: NAME.reference.json"),
    ] = None,
) -> None:
    """Make reference values of a brake: torque, reactions, p(theta) with uncertainties, by two
    codes.
    """
    from drumlin.base.files import check_outputs
    from drumlin.brake.file import toml_text
    from drumlin.brake.plane_brake import read_any
    from drumlin.verification.reference import reference as make
    from drumlin.verification.reference_file import as_dict, write_values

    text = toml_text(brake_file)
    brake = read_any(brake_file, text)
    path = output or Path(f"{brake_file.stem}.reference.json")
    check_outputs(path)
    with busy("columns of high degree, then triangles"):
        found = make(brake, text, typed(["drumlin", "reference", str(brake_file)]))
    write_values(as_dict(found), path)
    effect, unit = brake.surface.effect, brake.surface.effect_unit
    tell(f"{effect} {found.torque.value:.10g} {unit}, uncertainty {found.torque.uncertainty:.1e}")
    for shoe in found.shoes:
        tell(
            f"  shoe {shoe.name!r}: {effect} {shoe.torque.value:.10g} {unit}, "
            f"uncertainty {shoe.torque.uncertainty:.1e}; p uncertain by "
            f"{shoe.pressure_uncertainty:.1e} of its peak away from the edges, "
            f"{shoe.distance:.1e} in L2"
        )
    tell(f"reference: {path}")


def check(
    brake_file: BrakeFile,
    result: Annotated[
        Path,
        typer.Argument(
            metavar="RESULT.csv",
            help=r"columns 'shoe', 'theta \[deg]' (on a plane 'x \[mm]'), 'p \[MPa]'; other units as well",
        ),
    ],
    known: Annotated[
        Path | None,
        typer.Option(
            "--reference", metavar="FILE", help="reference values; default: stored, else made anew"
        ),
    ] = None,
    tolerance: Annotated[float, typer.Option(help="of p in L2 and of the torque, relative")] = 0.01,
) -> None:
    """Compare anybody's p(theta) with reference values. The last line is the verdict; exit status 0
    either way.
    """
    from drumlin.brake.file import toml_text
    from drumlin.brake.plane_brake import read_any
    from drumlin.studies import REPOSITORY
    from drumlin.verification.check import check as compare_with
    from drumlin.verification.check import lines, read_curves
    from drumlin.verification.reference import reference as make
    from drumlin.verification.reference_file import read_reference, stored

    if not 0 < tolerance < 1:
        raise BadInput(f"--tolerance = {tolerance:g}: must be greater than 0 and less than 1")
    text = toml_text(brake_file)
    brake = read_any(brake_file, text)
    curves = read_curves(result, brake)
    values = Path("reports") / "reference" / "values"
    path = known or stored(text, brake_file.parent, values, REPOSITORY / values)
    if path is None:
        with busy("no stored reference: columns of high degree, then triangles"):
            found, said = (
                make(brake, text, typed(["drumlin", "reference", str(brake_file)])),
                "made anew",
            )
    else:
        found, said = read_reference(path), str(path)
    verdicts = compare_with(brake, found, curves)
    tell(f"reference: {said}")
    for line in lines(verdicts, tolerance, brake.surface):
        tell(line)
