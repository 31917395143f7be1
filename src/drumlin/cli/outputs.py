"""Commands that write a brake as a picture, as meshes, or as input decks of another program."""

import os
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

import drumlin
from drumlin.base.errors import BadInput
from drumlin.cli.options import (
    BrakeFileArgument,
    ElementsOption,
    ParametricMeshKindOption,
    command_options_given_by_user,
)
from drumlin.cli.terminal import print_line_folded_to_terminal_width, show_spinner_beside_words

if TYPE_CHECKING:
    from drumlin.brake.brake import Brake


def view(
    brake_file: BrakeFileArgument,
    output: Annotated[
        Path | None, typer.Option(metavar="FILE", help="the picture, .png or .svg")
    ] = None,
    elements: ElementsOption = None,
    kind: ParametricMeshKindOption = None,
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
            draw_brake_with_meshes(
                brake, **command_options_given_by_user(elements=elements, kind=kind)
            ),
            picture,
        )
    print_line_folded_to_terminal_width(f"picture: {picture}")


def mesh(
    brake_file: BrakeFileArgument,
    output: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR|FILE",
            help="folder of the meshes, default: meshes; with --check the picture, .png or .svg",
        ),
    ] = None,
    name: Annotated[
        str | None,
        typer.Option(help="first word of the file names; default: that of the brake file"),
    ] = None,
    elements: ElementsOption = None,
    kind: ParametricMeshKindOption = None,
    suffix: Annotated[
        str | None, typer.Option("--format", metavar="msh|inp|vtu", help="format of the files")
    ] = None,
    check: Annotated[
        bool,
        typer.Option("--check", help="draw the mesh files of the shoes as they were read instead"),
    ] = False,
) -> None:
    """Write the mesh of each shoe as a file with named groups, to look at or to change."""
    brake = drumlin.read_brake(brake_file)
    options = command_options_given_by_user(elements=elements, kind=kind)
    if not check:
        _write_mesh_files(brake, output or Path("meshes"), name or brake_file.stem, suffix, options)
        return
    for option, value in {"name": name, "format": suffix, **options}.items():
        if value is not None:
            raise BadInput(
                f"--{option} = {value}: does not belong to --check, which writes no mesh"
            )
    _draw_mesh_files_of_brake(brake, brake_file, output)


def _write_mesh_files(
    brake: "Brake", folder: Path, name: str, suffix: str | None, options: dict[str, Any]
) -> None:
    """Write the mesh of each shoe into a file and print a line for each.

    Parameters
    ----------
    brake : the brake
    folder : folder of the files
    name : first word of the file names
    suffix : format of the files; None: msh
    options : number and kind of the elements, by name
    """
    from drumlin.base.files import check_output_files_are_writable
    from drumlin.fem.mesh.file import write_shoe_mesh_to_file
    from drumlin.fem.preparation.prepare import make_prepared_model
    from drumlin.fem.solve import require_element_options_have_effect

    if Path(name).name != name:
        raise BadInput(
            f"--name = {name!r}: must be a word without folders; --output names the folder"
        )
    brake.check_shoes_can_be_meshed()
    require_element_options_have_effect(brake, **options)
    paths = [folder / f"{name}_{shoe.name}.{suffix or 'msh'}" for shoe in brake.shoes]
    check_output_files_are_writable(*paths)
    with show_spinner_beside_words("meshing"):
        scene = make_prepared_model(brake, **options)
        for path, shoe, body in zip(paths, brake.shoes, scene.bodies, strict=True):
            write_shoe_mesh_to_file(path, body.mesh, shoe)
            print_line_folded_to_terminal_width(
                f"{path}: {body.mesh.nelements} elements, {body.unknowns} unknowns"
            )


def _draw_mesh_files_of_brake(brake: "Brake", brake_file: Path, output: Path | None) -> None:
    """Draw the mesh files of a brake's shoes, and print what will be solved.

    The picture stands beside the brake file, unless `output` names another one. Only a picture that
    `output` names may replace a file.
    """
    from drumlin.base.files import check_output_files_are_writable
    from drumlin.report.figures import save_figure
    from drumlin.report.mesh_check import (
        draw_checked_meshes,
        read_mesh_files_of_brake,
        text_lines_about_mesh_to_be_solved,
    )

    picture = output or brake_file.with_name(f"{brake_file.stem}_mesh.png")
    if picture.suffix not in {".png", ".svg"}:
        raise BadInput(f"--output = {str(picture)!r}: must end in .png or .svg")
    if output is None and os.path.lexists(picture):
        raise BadInput(f"{picture}: exists already; --output {picture} replaces it")
    check_output_files_are_writable(picture)
    with show_spinner_beside_words("drawing"):
        checked = read_mesh_files_of_brake(brake)
        save_figure(draw_checked_meshes(brake, checked), picture)
    for one in checked:
        for line in text_lines_about_mesh_to_be_solved(brake, one):
            print_line_folded_to_terminal_width(line)
    print_line_folded_to_terminal_width(f"picture: {picture}")


def export(
    brake_file: BrakeFileArgument,
    to: Annotated[
        str, typer.Option("--to", metavar="calculix", help="the program that the files are for")
    ] = "calculix",
    output: Annotated[Path, typer.Option(metavar="DIR", help="folder of the files")] = Path(),
    elements: ElementsOption = None,
    kind: ParametricMeshKindOption = None,
    model: Annotated[
        str, typer.Option(metavar="fem|solid", help="plane stress or solid shoes")
    ] = "fem",
) -> None:
    """Write a brake for another program, from drumlin's own mesh: input decks of CalculiX."""
    from drumlin.base.files import check_path_can_be_folder
    from drumlin.brake.plane_brake import read_brake_that_must_be_on_drum
    from drumlin.fem.solve import require_element_options_have_effect
    from drumlin.peers import calculix, solid_deck

    if model not in {"fem", "solid"}:
        raise BadInput(f"--model = {model!r}: is not exported; allowed: fem, solid")
    if model == "solid" and kind is not None:
        raise BadInput("--kind belongs to --model fem; solid shoes are of hexahedra")
    if to != "calculix":
        raise BadInput(f"--to = {to!r}: unknown program; allowed: calculix")
    brake = read_brake_that_must_be_on_drum(brake_file, "export")
    options = command_options_given_by_user(elements=elements, kind=kind)
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
        print_line_folded_to_terminal_width(str(path))
    for name in apart:
        print_line_folded_to_terminal_width(
            f"shoe {name!r}: no deck, its force does not turn it towards the drum"
        )
