"""Commands that write a brake as a picture, as meshes, or as input decks of another program."""

from pathlib import Path
from typing import Annotated

import typer

import drumlin
from drumlin.base.errors import BadInput
from drumlin.cli.options import BrakeFile, Elements, Kind, given
from drumlin.cli.terminal import busy, tell


def view(
    brake_file: BrakeFile,
    output: Annotated[
        Path | None, typer.Option(metavar="FILE", help="the picture, .png or .svg")
    ] = None,
    elements: Elements = None,
    kind: Kind = None,
) -> None:
    """Draw a brake and its mesh."""
    from drumlin.base.files import check_outputs
    from drumlin.report.figures import save_figure
    from drumlin.report.view import draw_brake_with_meshes

    brake = drumlin.read_brake(brake_file)
    picture = output or Path(f"{brake_file.stem}.png")
    if picture.suffix not in {".png", ".svg"}:
        raise BadInput(f"--output = {str(picture)!r}: must end in .png or .svg")
    check_outputs(picture)
    with busy("drawing"):
        save_figure(draw_brake_with_meshes(brake, **given(elements=elements, kind=kind)), picture)
    tell(f"picture: {picture}")


def mesh(
    brake_file: BrakeFile,
    output: Annotated[Path, typer.Option(metavar="DIR", help="folder of the meshes")] = Path(
        "meshes"
    ),
    name: Annotated[
        str | None,
        typer.Option(help="first word of the file names; default: that of the brake file"),
    ] = None,
    elements: Elements = None,
    kind: Kind = None,
    suffix: Annotated[
        str, typer.Option("--format", metavar="msh|inp|vtu", help="format of the files")
    ] = "msh",
) -> None:
    """Write the mesh of each shoe as a file with named groups, to look at or to change."""
    from drumlin.base.files import check_outputs
    from drumlin.fem.mesh.file import write_mesh
    from drumlin.fem.preparation.prepare import prepare
    from drumlin.fem.solve import check_division_options

    if name is not None and Path(name).name != name:
        raise BadInput(
            f"--name = {name!r}: must be a word without folders; --output names the folder"
        )
    brake, options = drumlin.read_brake(brake_file), given(elements=elements, kind=kind)
    brake.check_meshable()
    check_division_options(brake, **options)
    paths = [output / f"{name or brake_file.stem}_{shoe.name}.{suffix}" for shoe in brake.shoes]
    check_outputs(*paths)
    with busy("meshing"):
        scene = prepare(brake, **options)
        for path, shoe, body in zip(paths, brake.shoes, scene.bodies, strict=True):
            write_mesh(path, body.mesh, shoe)
            tell(f"{path}: {body.mesh.nelements} elements, {body.unknowns} unknowns")


def export(
    brake_file: BrakeFile,
    to: Annotated[
        str, typer.Option("--to", metavar="calculix", help="the program that the files are for")
    ],
    output: Annotated[Path, typer.Option(metavar="DIR", help="folder of the files")] = Path(),
    elements: Elements = None,
    kind: Kind = None,
    model: Annotated[
        str, typer.Option(metavar="fem|solid", help="plane stress or solid shoes")
    ] = "fem",
) -> None:
    """Write a brake for another program, from drumlin's own mesh: input decks of CalculiX."""
    from drumlin.base.files import check_folder
    from drumlin.brake.plane_brake import read_drum
    from drumlin.fem.solve import check_division_options
    from drumlin.peers import calculix, solid_deck

    if model not in {"fem", "solid"}:
        raise BadInput(f"--model = {model!r}: is not exported; allowed: fem, solid")
    if model == "solid" and kind is not None:
        raise BadInput("--kind belongs to --model fem; solid shoes are of hexahedra")
    if to != "calculix":
        raise BadInput(f"--to = {to!r}: unknown program; allowed: calculix")
    brake, options = read_drum(brake_file, "export"), given(elements=elements, kind=kind)
    check_division_options(brake, **options)
    check_folder(output)
    with busy("writing"):
        write = calculix.export if model == "fem" else solid_deck.export
        paths, apart = write(brake, output, brake_file.stem, **options)
    for path in paths:
        tell(str(path))
    for name in apart:
        tell(f"shoe {name!r}: no deck, its force does not turn it towards the drum")
