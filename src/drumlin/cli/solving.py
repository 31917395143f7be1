"""Commands that answer for a brake. Each reads, calls and prints; most of its lines are its
options.
"""

from pathlib import Path
from typing import Annotated, Any

import typer

from drumlin.cli.answer import print_response
from drumlin.cli.options import (
    BrakeFile,
    BrakeFiles,
    Elements,
    FiniteWidth,
    Kind,
    Penalty,
    fem_options,
    for_width,
)
from drumlin.cli.terminal import Column, busy, note, print_columns, print_table, tell
from drumlin.errors import BadInput, NoAnswer

OPTIONS = {  # model -> its own options
    "fem": ("elements", "kind", "penalty", "tolerance", "finite-width"),
    "solid": ("elements", "across", "penalty", "fields"),
    "foundation": ("sections", "lift"),
}


def solve(
    brake_files: BrakeFiles,
    model: Annotated[str, typer.Option(help="which model answers")] = "fem",
    json_file: Annotated[
        Path | None,
        typer.Option(
            "--json", metavar="FILE", help="write the response as JSON; of several brakes as a list"
        ),
    ] = None,
    pressure: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="write the pressures as CSV, a table that check takes"),
    ] = None,
    elements: Elements = None,
    kind: Kind = None,
    penalty: Penalty = None,
    tolerance: Annotated[
        float | None,
        typer.Option(help="refine until the estimated errors of p (L2) and torque are below it"),
    ] = None,
    sections: Annotated[
        int | None, typer.Option(help="sections of each beam of the foundation model")
    ] = None,
    lift: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME|all", help="simplification of the foundation model to lift"),
    ] = None,
    finite_width: FiniteWidth = False,
    across: Annotated[
        int | None, typer.Option(help="elements over half the width of a solid lining")
    ] = None,
    fields: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE.vtu", help="write p, displacements, stresses of the solid shoes"
        ),
    ] = None,
    verbose: Annotated[
        bool,
        typer.Option(
            "--verbose", "-v", help="figures of merit, how it was solved, what is left out"
        ),
    ] = False,
) -> None:
    """Solve a brake, or several, by one model."""
    from drumlin.brake.plane_brake import read_any
    from drumlin.files import check_outputs, write_json, write_text
    from drumlin.models import pick

    brakes = [read_any(brake_file) for brake_file in brake_files]
    check_outputs(json_file, pressure, fields)
    options = fem_options(elements, kind=kind, penalty=penalty) | (
        {} if tolerance is None else {"tolerance": tolerance}
    )
    chosen = [pick(model, brake) for brake in brakes]
    more = (("sections", sections), ("lift", lift), ("across", across), ("fields", fields))
    options |= {name: value for name, value in more if value is not None}
    options |= {"finite_width": True} if finite_width else {}
    for owner, names in OPTIONS.items():
        others = [f"--{name}" for name in names if name not in OPTIONS.get(model, ())]
        if model != owner and any(option[2:].replace("-", "_") in options for option in others):
            *some, last = others
            said = f"{', '.join(some)} and {last} belong" if some else f"{last} belongs"
            raise BadInput(f"{said} to --model {owner}, not to {model!r}")
    for option, path in (("--pressure", pressure), ("--fields", fields)):
        if path is not None and len(brakes) > 1:
            raise BadInput(f"{option} writes the file of one brake; give one brake file")
    failed, found = 0, list[dict[str, Any]]()
    for i, (brake_file, brake, one) in enumerate(zip(brake_files, brakes, chosen, strict=True)):
        try:
            with busy(f"solving by {model}"):
                response = one.solve(brake, **options)
        except NoAnswer as error:
            if len(brakes) == 1:
                raise
            failed += 1
            found.append({"brake_file": str(brake_file), "failure": str(error)})
            note(f"{brake_file}: {error}")
            continue
        found.append({"brake_file": str(brake_file), **response.as_dict()})
        if pressure is not None:
            from drumlin.verification.check import curves_text

            write_text(pressure, curves_text(response, brake.surface))
        if i > failed:
            tell("")
        print_response(brake, response, verbose=verbose)
    if json_file is not None:
        write_json(json_file, found[0] if len(brakes) == 1 else found)
    if failed:
        raise NoAnswer(f"{failed} of {len(brakes)} brakes have no answer")


def compare(
    brake_file: BrakeFile,
    output: Annotated[Path | None, typer.Option(metavar="DIR", help="folder of the report")] = None,
    elements: Elements = None,
    kind: Kind = None,
    penalty: Penalty = None,
    finite_width: FiniteWidth = False,
) -> None:
    """Solve a brake by all models that apply, side by side, and write one report."""
    from drumlin.brake.file import toml_text
    from drumlin.brake.plane_brake import read_any
    from drumlin.files import check_folder
    from drumlin.report.comparison import write_comparison

    text = toml_text(brake_file)
    brake = read_any(brake_file, text)
    folder = output or Path("reports") / brake_file.stem
    check_folder(folder)
    with busy("comparing the models"):
        options = fem_options(elements, kind=kind, penalty=penalty)
        result = write_comparison(
            brake, text, folder, options | ({"finite_width": True} if finite_width else {})
        )
    tell(f"{brake.title}: {brake.motion}, mu = {brake.friction:g}")
    print_table(result.table, result.columns)
    for line in result.notes:
        tell(line)
    tell(f"report: {result.page}")


def hold(
    brake_file: BrakeFile,
    rotation: Annotated[
        str | None,
        typer.Option(
            metavar="ANGLE",
            help='how far the drum is turned, such as "0.02 deg", on a plane the body slid; default: to full slip',
        ),
    ] = None,
    steps: Annotated[int, typer.Option(help="increments of the rotation")] = 20,
    json_file: Annotated[
        Path | None, typer.Option("--json", metavar="FILE", help="write all states as JSON")
    ] = None,
    elements: Elements = None,
    kind: Kind = None,
    penalty: Penalty = None,
    finite_width: FiniteWidth = False,
) -> None:
    """Hold the drum: from rest through partial slip to full slip, as it is turned against the
    shoes.
    """
    import numpy as np

    from drumlin.brake.plane_brake import read_any
    from drumlin.brake.units import quantity
    from drumlin.fem.holding import as_dict, full_slip_rotation
    from drumlin.fem.holding import hold as turn
    from drumlin.fem.solve import scene_of
    from drumlin.files import check_outputs, write_json
    from drumlin.texts import formatted

    brake, wide = for_width(read_any(brake_file), finite_width)
    brake.check_meshable()
    surface = brake.surface
    check_outputs(json_file)
    if not 1 <= steps <= 10_000:
        raise BadInput(f"--steps = {steps}: must be from 1 to 10000")
    options, stiffness = fem_options(elements, kind=kind), fem_options(None, penalty=penalty)
    end = None if rotation is None else quantity("--rotation", rotation, surface.unit)
    with busy("holding") as say:
        scene = scene_of(brake, **options)
        end = full_slip_rotation(scene, brake, **stiffness) if end is None else end
        states = turn(scene, brake, np.linspace(0.0, end, steps + 1), say=say, **stiffness)
    if json_file is not None:
        write_json(json_file, as_dict(states))
    for line in wide:
        tell(line)
    way = f"{surface.moved} [{surface.shown_unit}]"
    moment = f"{surface.held} [{surface.effect_unit}]"
    turned = [at.rotation * surface.shown for at in states]
    columns = {
        "way": Column("way", way, [f"{each:.6f}" for each in turned]),
        "moment": Column("moment", moment, [formatted(at.torque, ".4f") for at in states]),
        "sticking": Column(
            "sticking", "sticking [%]", [f"{100 * at.sticking:.1f}" for at in states]
        ),
        "dissipated": Column(
            "dissipated", "dissipated [J]", [f"{at.dissipated:.5g}" for at in states]
        ),
    }
    print_columns(columns, [])
    for line in states[-1].notes:
        tell(line)


def sensitivity(
    brake_file: BrakeFile,
    json_file: Annotated[
        Path | None, typer.Option("--json", metavar="FILE", help="write them as JSON")
    ] = None,
    elements: Elements = None,
    kind: Kind = None,
    penalty: Penalty = None,
) -> None:
    """What the torque feels of friction, force, moduli, clearance and hinge, exactly: slopes of the
    elastic brake.
    """
    from drumlin.brake.plane_brake import read_any
    from drumlin.fem.sensitivity import as_text
    from drumlin.fem.sensitivity import sensitivity as slopes
    from drumlin.fem.solve import scene_of
    from drumlin.files import check_outputs, write_json

    brake = read_any(brake_file)
    check_outputs(json_file)
    options, stiffness = fem_options(elements, kind=kind), fem_options(None, penalty=penalty)
    with busy("sensitivity"):
        brake.check_meshable()
        found = slopes(scene_of(brake, **options), brake, **stiffness)
    if json_file is not None:
        write_json(json_file, found.as_dict())
    tell(f"{brake.title}: fem, {brake.motion}, mu = {brake.friction:g}")
    for line in as_text(found, brake):
        tell(line)


def wear(
    brake_file: BrakeFile,
    model: Annotated[
        str, typer.Option(metavar="fem|foundation", help="the elastic model that is worn in")
    ] = "fem",
    distance: Annotated[
        str | None,
        typer.Option(
            help='sliding distance, such as "20 km", or a number of 1/(k K), K = E/t; default: until settled'
        ),
    ] = None,
    coefficient: Annotated[
        str | None,
        typer.Option(
            metavar="K", help='of wear, such as "1e-5 mm^3/(N m)"; with an exponent: at 1 MPa'
        ),
    ] = None,
    exponent: Annotated[float, typer.Option(help="of the pressure in the rate of wear")] = 1.0,
    torque: Annotated[
        str | None, typer.Option(help="hold this torque by the force, not the force")
    ] = None,
    reverse: Annotated[
        str | None, typer.Option(help="the drum turns back after every such distance")
    ] = None,
    guided: Annotated[
        bool, typer.Option("--guided", help="rigid shoes moving along their middle radius")
    ] = False,
    tolerance: Annotated[float | None, typer.Option(help="relative error of p (L2) a step")] = None,
    json_file: Annotated[
        Path | None, typer.Option("--json", metavar="FILE", help="write all states as JSON")
    ] = None,
    elements: Elements = None,
    kind: Kind = None,
    sections: Annotated[
        int | None, typer.Option(help="sections of each beam of the foundation model")
    ] = None,
    lift: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME|all", help="simplification of the foundation model to lift"),
    ] = None,
    finite_width: FiniteWidth = False,
) -> None:
    """Run the linings in: wear them by Archard's law until the pressure is that of the rigid-shoe
    law.
    """
    from drumlin.brake.plane_brake import read_any
    from drumlin.brake.units import quantity
    from drumlin.files import check_outputs, write_json
    from drumlin.lining_wear.archard import WearLaw
    from drumlin.lining_wear.linings import WearSetup, fem_setup, foundation_setup
    from drumlin.lining_wear.linings import guided as on_guides
    from drumlin.lining_wear.run_in import (
        COEFFICIENT,
        as_dict,
        check_depth,
        report_lines,
        run_in,
        target,
    )
    from drumlin.lining_wear.run_in import unit_distance as unit_of

    brake, wide = for_width(read_any(brake_file), finite_width and model == "fem")
    brake = on_guides(brake) if guided else brake
    brake.check_meshable()
    check_outputs(json_file)
    if model not in {"fem", "foundation"}:
        raise BadInput(f"--model = {model!r}: does not wear; allowed: fem, foundation")
    meshing = fem_options(elements, kind=kind)
    solving: dict[str, Any] = {
        name: value for name, value in (("sections", sections), ("lift", lift)) if value is not None
    }
    if solving if model == "fem" else (meshing or guided or finite_width):
        raise BadInput(
            "--elements, --kind, --guided and --finite-width belong to --model fem, --sections and --lift to foundation"
        )
    law = WearLaw(
        COEFFICIENT if coefficient is None else quantity("--coefficient", coefficient, "1/Pa"),
        exponent,
    )
    options: dict[str, Any] = {} if tolerance is None else {"tolerance": tolerance}
    if torque is not None:
        options["torque"] = quantity("--torque", torque, brake.surface.effect_unit)

    def length(key: str, text: str, setup: WearSetup) -> float:
        try:
            number = float(text)
        except ValueError:
            return quantity(key, text, "m")
        return number * unit_of(setup, law)

    with busy("running in") as say:
        if model == "fem":
            from drumlin.fem.solve import scene_of

            scene = scene_of(brake, **meshing)

            def setup_of(turning: Any) -> WearSetup:
                return fem_setup(scene, turning)
        else:

            def setup_of(turning: Any) -> WearSetup:
                return foundation_setup(turning, **solving)

        setup = setup_of(brake)
        if reverse is not None:
            options |= {
                "backward": setup_of(brake.reversed()),
                "reverse": length("--reverse", reverse, setup),
            }
        if distance is not None:
            options["distance"] = length("--distance", distance, setup)
        say("wearing")
        states = run_in(setup, law, **options)
    check_depth(setup, states)
    goal = target(setup, law, options.get("torque"))
    if json_file is not None:
        write_json(json_file, as_dict(setup, states, goal, law))
    for line in (*wide, *report_lines(setup, states, goal, law)):
        tell(line)
