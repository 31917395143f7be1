"""The command line. Exit status: 0 an answer, 2 bad input, 3 no answer; one plain line in the last two cases.

A function is a command, which reads, calls and prints; most of its lines are its options.
"""

import sys
from io import TextIOWrapper
from pathlib import Path
from typing import Annotated, Any

import typer

from drumlin.cli.terminal import busy, print_response, print_table, progress
from drumlin.errors import BadInput, DrumlinError, NoAnswer

app = typer.Typer(
    add_completion=False,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    help="Shoe brakes by their pressure laws and by finite elements in frictional contact, side by side.",
)

BrakeFile = Annotated[Path, typer.Argument(metavar="BRAKE.toml", help="the brake file")]
Elements = Annotated[int | None, typer.Option(help="finite elements along each lining")]
Kind = Annotated[str | None, typer.Option(metavar="quad2|quad1|tri2|tri1", help="kind of the parametric mesh")]
Penalty = Annotated[str | None, typer.Option(metavar="ALPHA|inf", help="contact stiffness as a multiple of E/t")]
OPTIONS = {  # model -> its own options
    "fem": ("elements", "kind", "penalty", "tolerance"),
    "foundation": ("sections", "lift"),
}


def _options(elements: int | None, *, kind: str | None = None, penalty: str | None = None) -> dict[str, Any]:
    """The options of the finite elements that were given."""
    given = {"elements": elements, "kind": kind}
    options: dict[str, Any] = {key: value for key, value in given.items() if value is not None}
    if penalty is not None:
        try:
            options["penalty"] = float(penalty)
        except ValueError as error:
            raise BadInput(f"--penalty = {penalty!r}: must be a number greater than 0, or inf") from error
    return options


@app.command()
def solve(
    brake_file: BrakeFile,
    model: Annotated[str, typer.Option(help="which model answers")] = "fem",
    json_file: Annotated[Path | None, typer.Option("--json", metavar="FILE", help="write the response as JSON")] = None,
    pressure: Annotated[
        Path | None, typer.Option(metavar="FILE", help="write the pressures as CSV, a table that check takes")
    ] = None,
    elements: Elements = None,
    kind: Kind = None,
    penalty: Penalty = None,
    tolerance: Annotated[
        float | None, typer.Option(help="refine until the estimated errors of p (L2) and torque are below it")
    ] = None,
    sections: Annotated[int | None, typer.Option(help="sections of each beam of the foundation model")] = None,
    lift: Annotated[
        list[str] | None, typer.Option(metavar="NAME|all", help="simplification of the foundation model to lift")
    ] = None,
) -> None:
    """Solve a brake by one model."""
    from drumlin.brake.plane_brake import FlatBrake, read_any
    from drumlin.files import write_json, write_text
    from drumlin.models import pick

    brake = read_any(brake_file)
    options = _options(elements, kind=kind, penalty=penalty) | ({} if tolerance is None else {"tolerance": tolerance})
    chosen = pick(model, brake)
    options |= {name: value for name, value in (("sections", sections), ("lift", lift)) if value is not None}
    for owner, names in OPTIONS.items():
        if model != owner and set(names) & set(options):
            *some, last = (f"--{name}" for name in names)
            raise BadInput(f"{', '.join(some)} and {last} belong to --model {owner}, not to {model!r}")
    with busy(f"solving by {model}"):
        response = chosen.solve(brake, **options)
    if json_file is not None:
        write_json(json_file, response.as_dict())
    if pressure is not None:
        from drumlin.verification.check import curves_text

        write_text(pressure, curves_text(response, isinstance(brake, FlatBrake)))
    print_response(brake, response)


@app.command()
def compare(
    brake_file: BrakeFile,
    output: Annotated[Path | None, typer.Option(metavar="DIR", help="folder of the report")] = None,
    elements: Elements = None,
    kind: Kind = None,
    penalty: Penalty = None,
) -> None:
    """Solve a brake by all models that apply, side by side, and write one report."""
    from drumlin.brake.plane_brake import FlatBrake, read_any
    from drumlin.report.comparison import write_comparison

    brake = read_any(brake_file)
    if isinstance(brake, FlatBrake):
        raise BadInput(
            f"{brake_file}: plane: compare takes brakes on a drum; solve this one by --model linear or short"
        )
    folder = output or Path("reports") / brake_file.stem
    with busy("comparing the models"):
        result = write_comparison(brake, brake_file.read_text(), folder, _options(elements, kind=kind, penalty=penalty))
    print(f"{brake.title}: {brake.motion}, mu = {brake.friction:g}")
    print_table(result.table)
    for line in result.notes:
        print(line)
    print(f"report: {result.page}")


@app.command()
def study(
    name: Annotated[str, typer.Argument(metavar="NAME", help="a folder of studies/")],
    output: Annotated[Path | None, typer.Option(metavar="DIR", help="folder of the report")] = None,
    short: Annotated[bool, typer.Option("--short", help="the quick setting that the tests use")] = False,
) -> None:
    """Run a study from studies/ and write its report into reports/NAME."""
    from drumlin.studies import run

    with busy(f"study {name}") as say:
        page = run(name, output, short=short, say=say)
    print(f"report: {page}")


@app.command()
def sweep(
    sweep_file: Annotated[Path, typer.Argument(metavar="SWEEP.toml", help="the sweep file")],
    output: Annotated[Path | None, typer.Option(metavar="FILE.csv|FILE.parquet", help="the table of all cases")] = None,
    jobs: Annotated[int | None, typer.Option(help="processes; default: one a core")] = None,
    scheduler: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="a Dask scheduler, in place of this machine's cores")
    ] = None,
) -> None:
    """Solve a brake with any of its keys varied: one table, a row a case. Stopped, it goes on with what is missing."""
    from collections import Counter

    from drumlin.journal import Journal, source_stamp
    from drumlin.sweeps.cases import check_output, run, table, write_table
    from drumlin.sweeps.file import read_sweep
    from drumlin.sweeps.workers import crew

    made = read_sweep(sweep_file)
    table_file = output or Path(sweep_file.with_suffix(".csv").name)
    check_output(table_file)
    with Journal(table_file.with_name(table_file.name + ".journal"), source_stamp()) as journal:
        try:
            with crew(jobs, scheduler) as (executor, workers), progress(made.title) as done:
                rows = run(made.cases, executor=executor, workers=workers, journal=journal, done=done)
        except KeyboardInterrupt:
            print(f"drumlin: stopped; {len(journal)} finished cases are kept in {journal.path}", file=sys.stderr)
            sys.exit(130)
    write_table(table(made.cases, rows), table_file)
    failed = Counter(row["status"].removeprefix("failed: ") for row in rows if row["status"] != "solved")
    print(f"{len(rows)} cases: {len(rows) - failed.total()} solved, {failed.total()} failed")
    for reason, count in failed.most_common(3):
        print(f"  failed, {count}: {reason}")
    print(f"table: {table_file}")
    if failed.total() == len(rows):
        raise NoAnswer("sweep: no case has an answer; the table says why")


@app.command()
def view(
    brake_file: BrakeFile,
    output: Annotated[Path | None, typer.Option(metavar="FILE", help="the picture, .png or .svg")] = None,
    elements: Elements = None,
    kind: Kind = None,
) -> None:
    """Draw a brake and its mesh."""
    from drumlin.brake.plane_brake import read_any
    from drumlin.report.figures import save
    from drumlin.report.view import draw

    brake = read_any(brake_file)
    picture = output or brake_file.with_suffix(".png").name
    if Path(picture).suffix not in {".png", ".svg"}:
        raise BadInput(f"--output = {str(picture)!r}: must end in .png or .svg")
    with busy("drawing"):
        save(draw(brake, **_options(elements, kind=kind)), Path(picture))
    print(f"picture: {picture}")


@app.command()
def mesh(
    brake_file: BrakeFile,
    output: Annotated[Path, typer.Option(metavar="DIR", help="folder of the meshes")] = Path("meshes"),
    name: Annotated[
        str | None, typer.Option(help="first word of the file names; default: that of the brake file")
    ] = None,
    elements: Elements = None,
    kind: Kind = None,
    suffix: Annotated[str, typer.Option("--format", metavar="msh|inp|vtu", help="format of the files")] = "msh",
) -> None:
    """Write the mesh of each shoe as a file with named groups, to look at or to change."""
    from drumlin.brake.file import read_brake
    from drumlin.fem.assembly import prepare
    from drumlin.fem.mesh.file import write_mesh

    brake = read_brake(brake_file)
    with busy("meshing"):
        scene = prepare(brake, **_options(elements, kind=kind))
        for shoe, body in zip(brake.shoes, scene.bodies, strict=True):
            path = output / f"{name or brake_file.stem}_{shoe.name}.{suffix}"
            if shoe.mesh and path.resolve() == shoe.mesh.resolve():
                raise BadInput(f"{path}: is the mesh that the brake file reads; must not be written over")
            write_mesh(path, body.mesh, shoe)
            print(f"{path}: {body.mesh.nelements} elements, {body.unknowns} unknowns")


@app.command()
def export(
    brake_file: BrakeFile,
    to: Annotated[str, typer.Option("--to", metavar="calculix", help="the program that the files are for")],
    output: Annotated[Path, typer.Option(metavar="DIR", help="folder of the files")] = Path(),
    elements: Elements = None,
    kind: Kind = None,
) -> None:
    """Write a brake for another program, from drumlin's own mesh: input decks of CalculiX."""
    from drumlin.brake.file import read_brake
    from drumlin.peers import calculix

    if to != "calculix":
        raise BadInput(f"--to = {to!r}: unknown program; allowed: calculix")
    brake = read_brake(brake_file)
    with busy("writing"):
        paths, apart = calculix.export(brake, output, brake_file.stem, **_options(elements, kind=kind))
    for path in paths:
        print(path)
    for name in apart:
        print(f"shoe {name!r}: no deck, its force does not turn it towards the drum")


@app.command()
def hold(
    brake_file: BrakeFile,
    rotation: Annotated[
        str | None,
        typer.Option(metavar="ANGLE", help='how far the drum is turned, such as "0.02 deg"; default: to full slip'),
    ] = None,
    steps: Annotated[int, typer.Option(help="increments of the rotation")] = 20,
    json_file: Annotated[Path | None, typer.Option("--json", metavar="FILE", help="write all states as JSON")] = None,
    elements: Elements = None,
    kind: Kind = None,
    penalty: Penalty = None,
) -> None:
    """Hold the drum: from rest through partial slip to full slip, as it is turned against the shoes."""
    import numpy as np

    from drumlin.brake.file import read_brake
    from drumlin.brake.units import quantity
    from drumlin.fem.assembly import prepare
    from drumlin.fem.holding import as_dict, full_slip_rotation
    from drumlin.fem.holding import hold as turn
    from drumlin.files import write_json

    brake = read_brake(brake_file)
    if not 1 <= steps <= 10_000:
        raise BadInput(f"--steps = {steps}: must be from 1 to 10000")
    options = _options(elements, kind=kind, penalty=penalty)
    stiffness = {key: options.pop(key) for key in ("penalty",) if key in options}
    end = None if rotation is None else quantity("--rotation", rotation, "rad")
    with busy("holding") as say:
        scene = prepare(brake, **options)
        end = full_slip_rotation(scene, brake, **stiffness) if end is None else end
        states = turn(scene, brake, np.linspace(0.0, end, steps + 1), say=say, **stiffness)
    if json_file is not None:
        write_json(json_file, as_dict(states))
    print(f"{'rotation [deg]':>15}{'moment [N m]':>15}{'sticking [%]':>14}{'dissipated [J]':>16}")
    for at in states:
        print(f"{np.degrees(at.rotation):15.6f}{at.torque:15.4f}{100 * at.sticking:14.1f}{at.dissipated:16.5g}")


@app.command()
def sensitivity(
    brake_file: BrakeFile,
    json_file: Annotated[Path | None, typer.Option("--json", metavar="FILE", help="write them as JSON")] = None,
    elements: Elements = None,
    kind: Kind = None,
    penalty: Penalty = None,
) -> None:
    """What the torque feels of friction, force, moduli, clearance and hinge, exactly: slopes of the elastic brake."""
    from drumlin.brake.file import read_brake
    from drumlin.fem.assembly import prepare
    from drumlin.fem.sensitivity import as_text
    from drumlin.fem.sensitivity import sensitivity as slopes
    from drumlin.files import write_json

    brake = read_brake(brake_file)
    options = _options(elements, kind=kind, penalty=penalty)
    stiffness = {key: options.pop(key) for key in ("penalty",) if key in options}
    with busy("sensitivity"):
        found = slopes(prepare(brake, **options), brake, **stiffness)
    if json_file is not None:
        write_json(json_file, found.as_dict())
    print(f"{brake.title}: fem, {brake.motion}, mu = {brake.friction:g}")
    for line in as_text(found, brake):
        print(line)


@app.command()
def wear(
    brake_file: BrakeFile,
    model: Annotated[str, typer.Option(metavar="fem|foundation", help="the elastic model that is worn in")] = "fem",
    distance: Annotated[
        str | None,
        typer.Option(help='sliding distance, such as "20 km", or a number of 1/(k K), K = E/t; default: until settled'),
    ] = None,
    coefficient: Annotated[
        str | None, typer.Option(metavar="K", help='of wear, such as "1e-5 mm^3/(N m)"; with an exponent: at 1 MPa')
    ] = None,
    exponent: Annotated[float, typer.Option(help="of the pressure in the rate of wear")] = 1.0,
    torque: Annotated[str | None, typer.Option(help="hold this torque by the force, not the force")] = None,
    reverse: Annotated[str | None, typer.Option(help="the drum turns back after every such distance")] = None,
    guided: Annotated[bool, typer.Option("--guided", help="rigid shoes moving along their middle radius")] = False,
    tolerance: Annotated[float | None, typer.Option(help="relative error of p (L2) a step")] = None,
    json_file: Annotated[Path | None, typer.Option("--json", metavar="FILE", help="write all states as JSON")] = None,
    elements: Elements = None,
    kind: Kind = None,
    sections: Annotated[int | None, typer.Option(help="sections of each beam of the foundation model")] = None,
    lift: Annotated[
        list[str] | None, typer.Option(metavar="NAME|all", help="simplification of the foundation model to lift")
    ] = None,
) -> None:
    """Run the linings in: wear them by Archard's law until the pressure is that of the rigid-shoe law."""
    from drumlin.brake.file import read_brake, vary
    from drumlin.brake.units import quantity
    from drumlin.files import write_json
    from drumlin.wear.archard import WearLaw
    from drumlin.wear.linings import WearSetup, fem_setup, foundation_setup
    from drumlin.wear.run_in import COEFFICIENT, as_dict, report_lines, run_in, target
    from drumlin.wear.run_in import unit_distance as unit_of

    brake = read_brake(brake_file)
    if model not in {"fem", "foundation"}:
        raise BadInput(f"--model = {model!r}: does not wear; allowed: fem, foundation")
    meshing = _options(elements, kind=kind)
    solving: dict[str, Any] = {
        name: value for name, value in (("sections", sections), ("lift", lift)) if value is not None
    }
    if solving if model == "fem" else (meshing or guided):
        raise BadInput("--elements, --kind and --guided belong to --model fem, --sections and --lift to foundation")
    law = WearLaw(COEFFICIENT if coefficient is None else quantity("--coefficient", coefficient, "1/Pa"), exponent)
    options: dict[str, Any] = {} if tolerance is None else {"tolerance": tolerance}
    if torque is not None:
        options["torque"] = quantity("--torque", torque, "N m")

    def length(key: str, text: str, setup: WearSetup) -> float:
        try:
            number = float(text)
        except ValueError:
            return quantity(key, text, "m")
        return number * unit_of(setup, law)

    with busy("running in") as say:
        if model == "fem":
            from drumlin.fem.assembly import prepare

            scene = prepare(brake, **meshing)

            def setup_of(turning: Any) -> WearSetup:
                return fem_setup(scene, turning, guide="radius" if guided else "hinge")
        else:

            def setup_of(turning: Any) -> WearSetup:
                return foundation_setup(turning, **solving)

        setup = setup_of(brake)
        if reverse is not None:
            other = "clockwise" if brake.spin > 0 else "counter-clockwise"
            options |= {
                "backward": setup_of(vary(brake, {"rotation": other})),
                "reverse": length("--reverse", reverse, setup),
            }
        if distance is not None:
            options["distance"] = length("--distance", distance, setup)
        say("wearing")
        states = run_in(setup, law, **options)
    goal = target(setup, law, options.get("torque"))
    if json_file is not None:
        write_json(json_file, as_dict(setup, states, goal, law))
    for line in report_lines(setup, states, goal, law):
        print(line)


@app.command()
def cost(
    brake_file: BrakeFile,
    elements: Elements = None,
    penalty: Penalty = None,
    by_size: Annotated[
        bool, typer.Option("--table", help="against the unknowns, up to 1 000 000: some minutes, some 8 GiB")
    ] = False,
) -> None:
    """Measure a solve against its own assembly, factorisation and back-substitution, and a further load case."""
    from drumlin.brake.file import read_brake
    from drumlin.verification.cost import measure, table

    brake = read_brake(brake_file)
    options = _options(elements, penalty=penalty)
    if by_size and options:
        raise BadInput("--table chooses the elements itself; leave out --elements and --penalty")
    if by_size:
        for line in table(brake):
            print(line, flush=True)
        return
    with busy("measuring"):
        lines = measure(brake, **options)
    for line in lines:
        print(line)


@app.command()
def reference(
    brake_file: BrakeFile,
    output: Annotated[
        Path | None, typer.Option(metavar="FILE", help="where to write; default: NAME.reference.json")
    ] = None,
) -> None:
    """Make reference values of a brake: torque, reactions, p(theta) with uncertainties, by two fine meshes."""
    from drumlin.brake.file import read_brake
    from drumlin.verification.reference import as_dict, write_values
    from drumlin.verification.reference import reference as make

    brake, path = read_brake(brake_file), output or Path(f"{brake_file.stem}.reference.json")
    with busy("two fine meshes"):
        found = make(brake, brake_file.read_text(), f"drumlin reference {brake_file.as_posix()}")
    write_values(as_dict(found), path)
    print(f"torque {found.torque.value:.10g} N m, uncertainty {found.torque.uncertainty:.1e}")
    for shoe in found.shoes:
        print(
            f"  shoe {shoe.name!r}: torque {shoe.torque.value:.10g} N m, uncertainty {shoe.torque.uncertainty:.1e}; "
            f"p uncertain by {shoe.pressure_uncertainty:.1e} of its peak away from the edges, "
            f"{shoe.distance:.1e} in L2"
        )
    print(f"reference: {path}")


@app.command()
def check(
    brake_file: BrakeFile,
    result: Annotated[
        Path,
        typer.Argument(metavar="RESULT.csv", help=r"columns 'shoe', 'theta \[deg]', 'p \[MPa]'; other units as well"),
    ],
    known: Annotated[
        Path | None,
        typer.Option("--reference", metavar="FILE", help="reference values; default: stored, else made anew"),
    ] = None,
    tolerance: Annotated[float, typer.Option(help="of p in L2 and of the torque, relative")] = 0.01,
) -> None:
    """Compare anybody's p(theta) with reference values. The last line is the verdict; exit status 0 either way."""
    from drumlin.brake.file import read_brake
    from drumlin.studies import REPOSITORY
    from drumlin.verification.check import check as compare_with
    from drumlin.verification.check import lines, read_curves
    from drumlin.verification.reference import read_reference, stored
    from drumlin.verification.reference import reference as make

    if not 0 < tolerance < 1:
        raise BadInput(f"--tolerance = {tolerance:g}: must be greater than 0 and less than 1")
    brake, text = read_brake(brake_file), brake_file.read_text()
    curves = read_curves(result, brake)
    values = Path("reports") / "reference" / "values"
    path = known or stored(text, brake_file.parent, values, REPOSITORY / values)
    if path is None:
        with busy("no stored reference: two fine meshes"):
            found = make(brake, text, f"drumlin reference {brake_file.as_posix()}")
        print("reference: made anew")
    else:
        found = read_reference(path)
        print(f"reference: {path}")
    for line in lines(compare_with(brake, found, curves), tolerance):
        print(line)


def main() -> None:
    """Run the command line; a DrumlinError becomes one line and its exit status."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="replace")  # a terminal that knows no θ or µ shows a ? there
    try:
        app()
    except DrumlinError as error:
        print(f"drumlin: {error}", file=sys.stderr)
        sys.exit(error.exit_status)
