"""Commands that write a brake as a picture, as meshes, or as input decks of another program."""

from pathlib import Path
from typing import Annotated

import typer

import drumlin
from drumlin.base.errors import BadInput
from drumlin.cli.options import BrakeFile, Elements, Kind, options_given_by_user
from drumlin.cli.terminal import print_folded_line, show_spinner_beside_words


def view(
    brake_file: BrakeFile,
    output: Annotated[
        Path | None, typer.Option(metavar="FILE", help="the picture, .png or .svg")
    ] = None,
    elements: Elements = None,
    kind: Kind = None,
) -> None:
    """Draw a brake and its mesh."""
    from drumlin.base.files import check_output_files_are_writable
    from drumlin.report.figures import save_figure
    from drumlin.report.view import draw_brake_with_meshes

    brake = drumlin.read_brake(brake_file)
    picture = output or Path(f"{brake_file.stem}.png")
    if picture.suffix not in {".png", ".svg"}:
        raise BadInput(f"--output = {str(picture)!r}: must end in .png or .svg")
    check_output_files_are_writable(picture)
    with show_spinner_beside_words("drawing"):
        save_figure(
            draw_brake_with_meshes(brake, **options_given_by_user(elements=elements, kind=kind)),
            picture,
        )
    print_folded_line(f"picture: {picture}")


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
    from drumlin.base.files import check_output_files_are_writable
    from drumlin.fem.mesh.file import write_shoe_mesh_to_file
    from drumlin.fem.preparation.prepare import make_prepared_model
    from drumlin.fem.solve import require_element_options_have_effect

    if name is not None and Path(name).name != name:
        raise BadInput(
            f"--name = {name!r}: must be a word without folders; --output names the folder"
        )
    brake, options = (
        drumlin.read_brake(brake_file),
        options_given_by_user(elements=elements, kind=kind),
    )
    brake.check_shoes_can_be_meshed()
    require_element_options_have_effect(brake, **options)
    paths = [output / f"{name or brake_file.stem}_{shoe.name}.{suffix}" for shoe in brake.shoes]
    check_output_files_are_writable(*paths)
    with show_spinner_beside_words("meshing"):
        scene = make_prepared_model(brake, **options)
        for path, shoe, body in zip(paths, brake.shoes, scene.bodies, strict=True):
            write_shoe_mesh_to_file(path, body.mesh, shoe)
            print_folded_line(f"{path}: {body.mesh.nelements} elements, {body.unknowns} unknowns")


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
    from drumlin.base.files import check_path_can_be_folder
    from drumlin.brake.plane_brake import read_brake_file_with_drum
    from drumlin.fem.solve import require_element_options_have_effect
    from drumlin.peers import calculix, solid_deck

    if model not in {"fem", "solid"}:
        raise BadInput(f"--model = {model!r}: is not exported; allowed: fem, solid")
    if model == "solid" and kind is not None:
        raise BadInput("--kind belongs to --model fem; solid shoes are of hexahedra")
    if to != "calculix":
        raise BadInput(f"--to = {to!r}: unknown program; allowed: calculix")
    brake, options = (
        read_brake_file_with_drum(brake_file, "export"),
        options_given_by_user(elements=elements, kind=kind),
    )
    require_element_options_have_effect(brake, **options)
    check_path_can_be_folder(output)
    with show_spinner_beside_words("writing"):
        write = (
            calculix.export_calculix_deck_of_each_shoe
            if model == "fem"
            else solid_deck.export_solid_calculix_decks
        )
        paths, apart = write(brake, output, brake_file.stem, **options)
    for path in paths:
        print_folded_line(str(path))
    for name in apart:
        print_folded_line(f"shoe {name!r}: no deck, its force does not turn it towards the drum")
