"""The command line. Exit status: 0 an answer, 2 bad input, 3 no answer; one plain line in the last two cases."""

import json
import math
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from io import TextIOWrapper
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING, Annotated, Any

import typer

from drumlin.errors import BadInput, DrumlinError, NoAnswer

if TYPE_CHECKING:
    from rich.status import Status

    from drumlin.flat import AnyBrake
    from drumlin.response import FlatMerit, Merit, Response

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
ALIKE = ("case", "rotation")  # columns that are the same in all rows of one brake
LEAST = (*ALIKE, "self_energising", "contact", "reaction_error", "reaction", "peak_error", "peak_pressure", "seconds")
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
    from drumlin.files import write_text
    from drumlin.flat import FlatBrake, read_any
    from drumlin.models import pick

    brake = read_any(brake_file)
    options = _options(elements, kind=kind, penalty=penalty) | ({} if tolerance is None else {"tolerance": tolerance})
    chosen = pick(model, brake)
    options |= {name: value for name, value in (("sections", sections), ("lift", lift)) if value is not None}
    for owner, names in OPTIONS.items():
        if model != owner and set(names) & set(options):
            *some, last = (f"--{name}" for name in names)
            raise BadInput(f"{', '.join(some)} and {last} belong to --model {owner}, not to {model!r}")
    with _busy(f"solving by {model}"):
        response = chosen.solve(brake, **options)
    if json_file is not None:
        write_text(json_file, json.dumps(response.as_dict(), indent=1, allow_nan=False) + "\n")
    if pressure is not None:
        from drumlin.check import curves_text

        write_text(pressure, curves_text(response, isinstance(brake, FlatBrake)))
    _print_response(brake, response)


@app.command()
def compare(
    brake_file: BrakeFile,
    output: Annotated[Path | None, typer.Option(metavar="DIR", help="folder of the report")] = None,
    elements: Elements = None,
    kind: Kind = None,
    penalty: Penalty = None,
) -> None:
    """Solve a brake by all models that apply, side by side, and write one report."""
    from drumlin.flat import FlatBrake, read_any
    from drumlin.report.comparison import write_comparison

    brake = read_any(brake_file)
    if isinstance(brake, FlatBrake):
        raise BadInput(
            f"{brake_file}: plane: compare takes brakes on a drum; solve this one by --model linear or short"
        )
    folder = output or Path("reports") / brake_file.stem
    with _busy("comparing the models"):
        result = write_comparison(brake, brake_file.read_text(), folder, _options(elements, kind=kind, penalty=penalty))
    print(f"{brake.title}: {brake.motion}, mu = {brake.friction:g}")
    _print_table(result.table)
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

    with _busy(f"study {name}") as say:
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
    from drumlin.sweep import check_output, run, table, write_table
    from drumlin.sweepfile import read_sweep
    from drumlin.workers import crew

    made = read_sweep(sweep_file)
    table_file = output or Path(sweep_file.with_suffix(".csv").name)
    check_output(table_file)
    with Journal(table_file.with_name(table_file.name + ".journal"), source_stamp()) as journal:
        try:
            with crew(jobs, scheduler) as (executor, workers), _progress(made.title) as done:
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


@contextmanager
def _progress(words: str) -> Iterator[Callable[[int, int], None]]:
    """A bar with the time left, on a terminal; to be told how many cases have finished, and of how many."""
    if not sys.stderr.isatty():
        yield lambda finished, of: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = TextColumn("{task.description}", markup=False), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn()
    with Progress(*columns, console=Console(stderr=True)) as progress:
        task = progress.add_task(words, total=None)
        yield lambda finished, of: progress.update(task, completed=finished, total=of)


@app.command()
def view(
    brake_file: BrakeFile,
    output: Annotated[Path | None, typer.Option(metavar="FILE", help="the picture, .png or .svg")] = None,
    elements: Elements = None,
    kind: Kind = None,
) -> None:
    """Draw a brake and its mesh."""
    from drumlin.flat import read_any
    from drumlin.report.figures import save
    from drumlin.report.view import draw

    brake = read_any(brake_file)
    picture = output or brake_file.with_suffix(".png").name
    if Path(picture).suffix not in {".png", ".svg"}:
        raise BadInput(f"--output = {str(picture)!r}: must end in .png or .svg")
    with _busy("drawing"):
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
    from drumlin.brakefile import read_brake
    from drumlin.fem.meshfile import write_mesh
    from drumlin.fem.scene import prepare

    brake = read_brake(brake_file)
    with _busy("meshing"):
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
    from drumlin.brakefile import read_brake
    from drumlin.peers import calculix

    if to != "calculix":
        raise BadInput(f"--to = {to!r}: unknown program; allowed: calculix")
    brake = read_brake(brake_file)
    with _busy("writing"):
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

    from drumlin.brakefile import read_brake
    from drumlin.fem.holding import as_dict, full_slip_rotation
    from drumlin.fem.holding import hold as turn
    from drumlin.fem.scene import prepare
    from drumlin.files import write_text
    from drumlin.units import to_si

    brake = read_brake(brake_file)
    if not 1 <= steps <= 10_000:
        raise BadInput(f"--steps = {steps}: must be from 1 to 10000")
    options = _options(elements, kind=kind, penalty=penalty)
    stiffness = {key: options.pop(key) for key in ("penalty",) if key in options}
    try:
        end = None if rotation is None else to_si(rotation, "rad", unit_required=True)
    except ValueError as error:
        raise BadInput(f"--rotation = {rotation!r}: {error}") from error
    with _busy("holding") as say:
        scene = prepare(brake, **options)
        end = full_slip_rotation(scene, brake, **stiffness) if end is None else end
        states = turn(scene, brake, np.linspace(0.0, end, steps + 1), say=say, **stiffness)
    if json_file is not None:
        write_text(json_file, json.dumps(as_dict(states), indent=1, allow_nan=False) + "\n")
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
    from drumlin.brakefile import read_brake
    from drumlin.fem.scene import prepare
    from drumlin.fem.sensitivity import as_text
    from drumlin.fem.sensitivity import sensitivity as slopes
    from drumlin.files import write_text

    brake = read_brake(brake_file)
    options = _options(elements, kind=kind, penalty=penalty)
    stiffness = {key: options.pop(key) for key in ("penalty",) if key in options}
    with _busy("sensitivity"):
        found = slopes(prepare(brake, **options), brake, **stiffness)
    if json_file is not None:
        write_text(json_file, json.dumps(found.as_dict(), indent=1, allow_nan=False) + "\n")
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
    from drumlin.brakefile import read_brake, vary
    from drumlin.files import write_text
    from drumlin.rig import Rig, fem_rig, foundation_rig
    from drumlin.run_in import COEFFICIENT, as_dict, report_lines, run_in, target
    from drumlin.run_in import unit_distance as unit_of
    from drumlin.units import quantity
    from drumlin.wear import Law

    brake = read_brake(brake_file)
    if model not in {"fem", "foundation"}:
        raise BadInput(f"--model = {model!r}: does not wear; allowed: fem, foundation")
    meshing = _options(elements, kind=kind)
    solving: dict[str, Any] = {
        name: value for name, value in (("sections", sections), ("lift", lift)) if value is not None
    }
    if solving if model == "fem" else (meshing or guided):
        raise BadInput("--elements, --kind and --guided belong to --model fem, --sections and --lift to foundation")
    law = Law(COEFFICIENT if coefficient is None else quantity("--coefficient", coefficient, "1/Pa"), exponent)
    options: dict[str, Any] = {} if tolerance is None else {"tolerance": tolerance}
    if torque is not None:
        options["torque"] = quantity("--torque", torque, "N m")

    def length(key: str, text: str, rig: Rig) -> float:
        try:
            number = float(text)
        except ValueError:
            return quantity(key, text, "m")
        return number * unit_of(rig, law)

    with _busy("running in") as say:
        if model == "fem":
            from drumlin.fem.scene import prepare

            scene = prepare(brake, **meshing)

            def rig_of(turning: Any) -> Rig:
                return fem_rig(scene, turning, guide="radius" if guided else "hinge")
        else:

            def rig_of(turning: Any) -> Rig:
                return foundation_rig(turning, **solving)

        rig = rig_of(brake)
        if reverse is not None:
            other = "clockwise" if brake.spin > 0 else "counter-clockwise"
            options |= {
                "backward": rig_of(vary(brake, {"rotation": other})),
                "reverse": length("--reverse", reverse, rig),
            }
        if distance is not None:
            options["distance"] = length("--distance", distance, rig)
        say("wearing")
        states = run_in(rig, law, **options)
    goal = target(rig, law, options.get("torque"))
    if json_file is not None:
        write_text(json_file, json.dumps(as_dict(rig, states, goal, law), indent=1, allow_nan=False) + "\n")
    for line in report_lines(rig, states, goal, law):
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
    from drumlin.brakefile import read_brake
    from drumlin.fem.cost import measure, table

    brake = read_brake(brake_file)
    options = _options(elements, penalty=penalty)
    if by_size and options:
        raise BadInput("--table chooses the elements itself; leave out --elements and --penalty")
    if by_size:
        for line in table(brake):
            print(line, flush=True)
        return
    with _busy("measuring"):
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
    from drumlin.brakefile import read_brake
    from drumlin.reference import as_dict, write_values
    from drumlin.reference import reference as make

    brake, path = read_brake(brake_file), output or Path(f"{brake_file.stem}.reference.json")
    with _busy("two fine meshes"):
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
    from drumlin.brakefile import read_brake
    from drumlin.check import check as compare_with
    from drumlin.check import lines, read_curves
    from drumlin.reference import read_reference, stored
    from drumlin.reference import reference as make
    from drumlin.studies import REPOSITORY

    if not 0 < tolerance < 1:
        raise BadInput(f"--tolerance = {tolerance:g}: must be greater than 0 and less than 1")
    brake, text = read_brake(brake_file), brake_file.read_text()
    curves = read_curves(result, brake)
    values = Path("reports") / "reference" / "values"
    path = known or stored(text, brake_file.parent, values, REPOSITORY / values)
    if path is None:
        with _busy("no stored reference: two fine meshes"):
            found = make(brake, text, f"drumlin reference {brake_file.as_posix()}")
        print("reference: made anew")
    else:
        found = read_reference(path)
        print(f"reference: {path}")
    for line in lines(compare_with(brake, found, curves), tolerance):
        print(line)


class _busy:
    """A spinner on a terminal while a block runs; `say` changes its words. Silent where no one watches."""

    def __init__(self, words: str) -> None:
        self._words = words
        self._status: Status | None = None

    def __enter__(self) -> Callable[[str], None]:
        if sys.stderr.isatty():
            from rich.console import Console
            from rich.text import Text

            self._status = Console(stderr=True).status(Text(self._words))
            self._status.start()
        return self._say

    def _say(self, words: str) -> None:
        if self._status is not None:
            from rich.text import Text

            self._status.update(Text(words))

    def __exit__(self, *_: object) -> None:
        if self._status is not None:
            self._status.stop()


def _print_response(brake: "AnyBrake", response: "Response") -> None:
    from drumlin.compare import arcs_text
    from drumlin.response import FlatMerit

    print(f"{brake.title}: {response.model}, {brake.motion}, mu = {brake.friction:g}")
    forces = [merit.braking_force for merit in response.merits if isinstance(merit, FlatMerit)]
    print(f"braking force {sum(forces):.6g} N" if forces else f"torque {response.torque:.6g} N m")
    for shoe, merit in zip(response.shoes, response.merits, strict=True):
        x, y = shoe.hinge_reaction
        effect, unit = f"torque {shoe.torque:.6g} N m", "deg"
        if isinstance(merit, FlatMerit):
            effect, unit = f"braking force {merit.braking_force:.6g} N", "mm"
        touching = f"contact {arcs_text(shoe, unit)} {unit}" if shoe.contact_arcs else "no contact"
        print(
            f"  shoe {shoe.name!r}: {effect}"
            f"{', self-energising' if shoe.self_energising else ''}; normal force {shoe.normal_force:.6g} N; "
            f"peak pressure {shoe.peak_pressure * 1e-6:.4g} MPa; hinge reaction ({x:.6g}, {y:.6g}) N; "
            f"{touching}"
        )
        print(f"    {_merit_text(merit)}")
    spent = ", ".join(f"{phase} {seconds * 1e3:.1f}" for phase, seconds in response.seconds.items())
    if spent:
        print(f"  {response.iterations} active-set steps; balance: force {response.balance.force:.1e}, "
              f"moment {response.balance.moment:.1e}; ms: {spent}")  # fmt: skip
    if response.error is not None:
        print(f"  estimated error: p {response.error['pressure']:.1e} (L2, worst shoe), "
              f"torque {response.error['torque']:.1e}")  # fmt: skip
    for line in response.notes:
        print(f"  {line}")
    for line in response.left_out:
        print(f"  left out: {line}")


def _merit_text(merit: "Merit | FlatMerit") -> str:
    """Figures of merit for people: names as in the JSON, the angle in degrees; without those that are None."""
    values = {key: value for key, value in merit._asdict().items() if value is not None}
    angle = values.pop("resultant_angle", None)
    said = [] if angle is None else [f"resultant at {math.degrees(angle):.4g} deg"]
    return ", ".join(said + [f"{key} {value:.5g}" for key, value in values.items()])


def _print_table(table: list[dict[str, Any]]) -> None:
    """Rows for people. No number is cut: on a narrow terminal the columns that matter least are left out, by name."""
    from rich.console import Console
    from rich.table import Table

    from drumlin.compare import COLUMNS

    console = Console(width=None if sys.stdout.isatty() else 200, markup=False)
    shown = [c for c in COLUMNS if any(row.get(c.key) is not None for row in table)]
    cells = {c.key: [c.text(row) for row in table] for c in shown}
    heads = {c.key: fill(c.heading, 9, break_long_words=False) + (f"\n[{c.unit}]" if c.unit else "") for c in shown}
    widths = {key: max(map(len, (*heads[key].split("\n"), *cells[key]))) for key in cells}
    widths["status"] = 10  # it is folded
    cut = []
    for key in LEAST:
        if key in ALIKE or sum(widths[c.key] + 2 for c in shown) > console.width:
            cut += [c.title for c in shown if c.key == key and key not in ALIKE]
            shown = [c for c in shown if c.key != key]
    grid = Table(box=None, pad_edge=False, header_style="bold")
    for c in shown:
        left = c.key in {"shoe", "model", "status"}
        grid.add_column(heads[c.key], justify="left" if left else "right", no_wrap=c.key != "status", overflow="fold")
    for row in zip(*(cells[c.key] for c in shown), strict=True):
        grid.add_row(*row)
    console.print(grid)
    if cut:
        print(f"not shown here, the terminal is too narrow: {', '.join(cut)}")


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
