"""A mine winder's post brake: sine law, elastic foundation and finite elements side by side, and where each holds."""

import math
import time
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from drumlin import foundation
from drumlin.arrays import Floats
from drumlin.brake.beam_axis import axis_of
from drumlin.brake.drum_brake import Brake
from drumlin.brake.file import read_brake, vary
from drumlin.comparison import COLUMNS, Column, Comparison, as_csv, run
from drumlin.errors import NoAnswer
from drumlin.fem.assembly import Scene, prepare
from drumlin.fem.deflection import beam_deflection, rim_displacement
from drumlin.fem.model import respond
from drumlin.fem.solve import solve
from drumlin.files import write_text
from drumlin.laws import sine
from drumlin.report import figures, post_figures
from drumlin.report.comparison import field_picture, panels, results_json
from drumlin.report.page import Figure, Section, Source, Table, Text, write_page
from drumlin.report.post_figures import Curve, Map
from drumlin.response.norms import relative
from drumlin.response.response import Merit, Response
from drumlin.wear.worn_in import worn_in_foundation

HERE = Path(__file__).parent
ALL = ("all",)
Solver = Callable[[Brake], Response]
MODELS: dict[str, Solver] = {
    "foundation": foundation.solve,
    "lifted": partial(foundation.solve, lift=ALL),
    "sine": sine,
}
TILT_AND_MODELS: dict[str, Solver] = {"tilt": partial(foundation.solve, lift=("tilt",)), **MODELS}
MATCHED = {  # the assumptions of the model: soft lining, block stiff against it, no lateral contraction, rigid drum
    "drum.ring": None,
    "shoe.lining.material": {"E": 2e6, "nu": 0.0},
    "shoe.backing.material": {"E": 5e8, "nu": 0.0},
    "shoe.body.material.nu": 0.0,
}
ERRORS = ("foundation", "tilt", "lifted", "sine")


class Result(NamedTuple):
    """Everything that the report shows; rows of tables as in the columns below."""

    comparison: Comparison
    scene: Scene
    lifts: list[dict[str, Any]]
    clearances: list[dict[str, Any]]
    merits: dict[str, dict[str, list[tuple[float, Merit]]]]
    offsets: dict[str, dict[str, list[tuple[float, float]]]]
    assumptions: list[dict[str, Any]]
    maps: list[list[Map]]
    place: list[tuple[float, float]]
    grids: list[dict[str, Any]]
    elements: int
    seconds: float


def study(*, short: bool = False, say: Callable[[str], None] = lambda _: None) -> Result:
    """All computing; `short`: coarser, fewer points."""
    start = time.perf_counter()
    elements, repeats = (24, 1) if short else (80, 5)
    brake = read_brake(HERE / "brake.toml")
    say("side by side")
    scene = prepare(brake, elements=elements)
    outcomes = [run("fem", partial(solve, brake, elements=elements), 1 if short else 3)]
    outcomes += [run(name, partial(model, brake), repeats) for name, model in MODELS.items()]
    comparison = Comparison("fits", brake, tuple(outcomes))
    say("what each simplification is worth")
    lifts = lift_rows(brake, comparison.responses["fem"])
    say("clearance")
    clearances = clearance_rows(brake, scene)
    offsets = radius_errors(brake, scene, np.linspace(-3e-3, 3e-3, 5 if short else 13))
    say("friction")
    merits = merits_over_friction(brake, scene, np.linspace(0.05, 0.6, 4 if short else 12))
    say("where the assumptions end")
    assumptions = assumption_rows(brake, 16 if short else 40)
    say("map")
    maps, place = error_maps(brake, 3 if short else 7, 12 if short else 30)
    say("grids")
    grids = grid_rows(brake, repeats)
    return Result(
        comparison, scene, lifts, clearances, merits, offsets, assumptions, maps, place, grids, elements,
        time.perf_counter() - start,
    )  # fmt: skip


def torques(response: Response) -> Floats:
    """Torque of each shoe [N m] (shoes,)."""
    return np.array([shoe.torque for shoe in response.shoes])


def worst(response: Response, true: Response) -> float:
    """The error of the torque of the shoe that is farthest off."""
    errors = torques(response) / torques(true) - 1
    return float(errors[np.argmax(np.abs(errors))])


def lift_rows(brake: Brake, fem: Response) -> list[dict[str, Any]]:
    """The paper's model with its simplifications lifted one at a time and together, against finite elements."""
    rows = []
    for lift in ((), *((name,) for name in foundation.LIFTS), ALL):
        response = foundation.solve(brake, lift=lift)
        row = {"lift": ", ".join(lift) or "none (the paper)", "torque": response.torque}
        row |= {f"error_{shoe.name}": relative(shoe.torque, true.torque)
                for shoe, true in zip(response.shoes, fem.shoes, strict=True)}  # fmt: skip
        rows.append(row | {"error": relative(response.torque, fem.torque)})
    return rows


def gaps(brake: Brake, gap: Callable[[Floats], Floats]) -> Brake:
    """The brake with a clearance gap(theta) [m] on every lining, theta from the beam's normal."""
    changes = {}
    for i, shoe in enumerate(brake.shoes):
        theta = np.linspace(shoe.lining.start, shoe.lining.end, 181)
        axis = axis_of(shoe.hinge.xy, shoe.actuation.point.xy)
        changes[f"shoe[{i}].lining.clearance"] = np.column_stack([theta, gap(axis.angle(theta))]).tolist()
    return vary(brake, changes)


def radius_gap(brake: Brake, larger: float) -> Brake:
    """Linings of a radius `larger` [m] than the drum's, touching at their middles (< 0: at their ends)."""
    end = math.cos(0.5 * (brake.shoes[0].lining.end - brake.shoes[0].lining.start))
    return gaps(brake, lambda theta: larger * ((1.0 if larger > 0 else end) - np.cos(theta)))


def clearance_rows(brake: Brake, scene: Scene) -> list[dict[str, Any]]:
    """What clearances do: a lining that fits, new ones, one set off, one worn in."""
    cases = {
        "fits": brake,
        "new lining, radius 1 mm larger": radius_gap(brake, 1e-3),
        "new lining, radius 1 mm smaller": radius_gap(brake, -1e-3),
        "set 1 mm towards the loaded end": gaps(brake, lambda theta: 1e-3 * (np.sin(theta) - np.sin(theta).min())),
        "set 1 mm towards the hinge": gaps(brake, lambda theta: 1e-3 * (np.sin(theta).max() - np.sin(theta))),
        "worn in": worn_in_foundation(brake, lift=ALL),
    }
    nominal, rows = sine(brake), []
    for case, varied in cases.items():
        answers = {"fem": respond(scene, varied), "lifted": MODELS["lifted"](varied)}
        for model, response in answers.items():
            for shoe, merit, law in zip(
                response.shoes, response.merits or merits_of(varied, response), nominal.shoes, strict=True
            ):
                assert isinstance(merit, Merit)
                rows.append(
                    {
                        "case": case, "model": figures.name_of(model), "shoe": shoe.name, "torque": shoe.torque,
                        "from_nominal": relative(shoe.torque, law.torque), "peak": shoe.peak_pressure,
                        "psi": merit.friction_radius, "angle": merit.resultant_angle, "S": merit.shoe_factor,
                        "contact": ", ".join(f"{math.degrees(a):.0f} to {math.degrees(b):.0f}" for a, b in shoe.contact_arcs),
                    }
                )  # fmt: skip
    return rows


def merits_of(brake: Brake, response: Response) -> tuple[Any, ...]:
    """Figures of merit of a response that came without."""
    from drumlin.response.merit import with_merits  # noqa: PLC0415

    return with_merits(brake, response).merits


def radius_errors(brake: Brake, scene: Scene, errors: Floats) -> dict[str, dict[str, list[tuple[float, float]]]]:
    """Shoe -> model -> (error of the lining's radius [m], torque over that of the sine law - 1)."""
    nominal = torques(sine(brake))
    found: dict[str, dict[str, list[tuple[float, float]]]] = {shoe.name: {} for shoe in brake.shoes}
    solvers: dict[str, Solver] = {name: MODELS[name] for name in ("foundation", "lifted")}
    solvers["fem"] = partial(respond, scene)
    for larger in errors.tolist():
        varied = radius_gap(brake, larger)
        for name, solver in solvers.items():
            off = torques(solver(varied)) / nominal - 1
            for shoe, error in zip(brake.shoes, off.tolist(), strict=True):
                found[shoe.name].setdefault(name, []).append((larger, error))
    return found


def merits_over_friction(
    brake: Brake, scene: Scene, friction: Floats
) -> dict[str, dict[str, list[tuple[float, Merit]]]]:
    """Shoe -> model -> (mu, figures of merit); models stop where they lock."""
    found: dict[str, dict[str, list[tuple[float, Merit]]]] = {shoe.name: {} for shoe in brake.shoes}
    solvers: dict[str, Solver] = {**MODELS, "fem": partial(respond, scene)}
    for name, solver in solvers.items():
        for mu in friction.tolist():
            varied = vary(brake, {"friction": mu})
            try:
                response = solver(varied)
            except NoAnswer:
                break
            for shoe, merit in zip(brake.shoes, response.merits or merits_of(varied, response), strict=True):
                assert isinstance(merit, Merit)
                found[shoe.name].setdefault(name, []).append((mu, merit))
    return found


def with_arc(brake: Brake, half: float) -> dict[str, float]:
    """Changes to linings of +- half [deg] about where each beam is nearest to the drum."""
    changes = {}
    for i, shoe in enumerate(brake.shoes):
        middle = 0.5 * (shoe.lining.start + shoe.lining.end)
        changes[f"shoe[{i}].lining.start"] = middle - math.radians(half)
        changes[f"shoe[{i}].lining.end"] = middle + math.radians(half)
    return changes


def assumption_rows(brake: Brake, elements: int) -> list[dict[str, Any]]:
    """From a brake that meets the model's assumptions, each left in turn: errors of the worst shoe's torque."""
    base = vary(brake, MATCHED | with_arc(brake, 15))
    ring = brake.drum.ring
    assert ring is not None
    cases: dict[str, dict[str, Any]] = {
        "all met: 30 deg of arc, E/t of lining 1/36 of the block's, nu = 0": {},
        "60 deg of arc": with_arc(brake, 30),
        "80 deg of arc": with_arc(brake, 40),
        "nu = 0.45 in lining and block": {"shoe.lining.material.nu": 0.45, "shoe.backing.material.nu": 0.45},
        "lining 100 times stiffer: the block is the spring": {"shoe.lining.material.E": 2e8},
        "the same, 80 deg of arc": {"shoe.lining.material.E": 2e8} | with_arc(brake, 40),
        "beam 10 times softer": {"shoe.body.bending_stiffness": 4.5e7},
        "beam 10 times softer, 80 deg of arc": {"shoe.body.bending_stiffness": 4.5e7} | with_arc(brake, 40),
        "elastic ring": {"drum.ring": ring.model_dump()},
        "elastic ring, 80 deg of arc": {"drum.ring": ring.model_dump()} | with_arc(brake, 40),
        "the brake of this study": brake.model_dump(by_alias=True),
    }  # fmt: skip
    rows = []
    for case, changes in cases.items():
        varied = brake if case == "the brake of this study" else vary(base, changes)
        fem = solve(varied, elements=elements)
        rows.append({"case": case} | {name: worst(TILT_AND_MODELS[name](varied), fem) for name in ERRORS})
    return rows


def groups(brake: Brake) -> tuple[float, float]:
    """k R^4/EI of the beam and of the ring, k the stiffness of the layers per length of arc."""
    shoe, ring, R = brake.shoes[0], brake.drum.ring, brake.drum.radius
    assert shoe.backing is not None and shoe.body is not None and shoe.body.section is not None and ring is not None
    lining = shoe.lining
    k = lining.width / (lining.thickness / lining.material.E + shoe.backing.thickness / shoe.backing.material.E)
    return k * R**4 / shoe.body.section.bending_stiffness, k * R**4 / ring.EI


def error_maps(brake: Brake, points: int, elements: int) -> tuple[list[list[Map]], list[tuple[float, float]]]:
    """Rows of maps, for block stiff or soft against the lining; in each the worst shoe's torque error of each model."""
    x, y = np.geomspace(0.3, 300, points), np.geomspace(0.3, 300, points)
    rows, places = [], []
    for said, layers in (
        ("soft lining", {"shoe.lining.material.E": 5e6, "shoe.backing.material.E": 3e9}),
        ("wooden block", {}),
    ):
        soft = vary(brake, layers)
        beam, ring = groups(soft)
        section = soft.shoes[0].body.section if soft.shoes[0].body else None
        assert soft.drum.ring is not None and section is not None
        EI, EI_r = section.bending_stiffness * beam, soft.drum.ring.EI * ring
        error = {name: np.full((points, points), np.nan) for name in MODELS}
        for i, at_y in enumerate(y.tolist()):
            for j, at_x in enumerate(x.tolist()):
                varied = vary(
                    soft, {"shoe.body.bending_stiffness": EI / at_x, "drum.ring.bending_stiffness": EI_r / at_y}
                )
                try:
                    fem = solve(varied, elements=elements)
                    for name, model in MODELS.items():
                        error[name][i, j] = worst(model(varied), fem)
                except NoAnswer:
                    continue
        rows.append([Map(f"{NAMES[name]}, {said}", x, y, error[name]) for name in ("sine", "foundation", "lifted")])
        places.append((beam, ring))
    return rows, places


NAMES = {"sine": "sine law", "foundation": "foundation, as printed", "lifted": "foundation, all lifted"}


def grid_rows(brake: Brake, repeats: int) -> list[dict[str, Any]]:
    """Errors of the foundation model against a far finer grid, their ratios, steps and cost."""
    fixed = vary(
        brake,
        {"shoe.lining.material.E": 5e6, "shoe.body.bending_stiffness": 4e9, "drum.ring.bending_stiffness": 4e9,
         "shoe[0].lining.end": math.radians(35)},
    )  # fmt: skip

    def numbers(response: Response) -> Floats:
        merit = response.merits[0]
        assert isinstance(merit, Merit)
        return np.array([response.torque, response.shoes[0].normal_force, merit.friction_radius or 0.0])

    fine, rows, before = numbers(foundation.solve(fixed, sections=2880)), [], np.full(3, np.nan)
    for n in (45, 90, 180, 360, 720, 1440):
        errors = np.abs(numbers(foundation.solve(fixed, sections=n)) / fine - 1)
        outcome = run("foundation", partial(foundation.solve, brake, sections=n), repeats)
        assert outcome.response is not None
        row: dict[str, Any] = {"n": n, "steps": outcome.response.iterations, "seconds": outcome.seconds}
        if n <= 720:
            names = ("torque", "N", "psi")
            row |= dict(zip(names, errors.tolist(), strict=True))
            row |= {f"{name}_ratio": ratio for name, ratio in zip(names, (before / errors).tolist(), strict=True)}
        rows.append(row)
        before = errors
    return rows


LIFT_COLUMNS = (
    Column("lift", "lifted"),
    Column("torque", "torque", "N m", 1, ".5g"),
    Column("error", "error of torque", "%", 100, "+.1f"),
    Column("error_right", "right shoe", "%", 100, "+.1f"),
    Column("error_left", "left shoe", "%", 100, "+.1f"),
)
CLEARANCE = (
    Column("case", "clearance"),
    Column("shoe", "shoe"),
    Column("model", "model"),
    Column("torque", "torque", "N m", 1, ".5g"),
    Column("from_nominal", "off nominal (sine law)", "%", 100, "+.1f"),
    Column("peak", "peak pressure", "MPa", 1e-6, ".3g"),
    Column("psi", "ψ", "", 1, ".3f"),
    Column("angle", "resultant θ", "deg", 180 / math.pi, ".1f"),
    Column("S", "shoe factor S", "", 1, ".3f"),
    Column("contact", "contact arcs", "deg"),
)
ASSUMPTIONS = (
    Column("case", "brake"),
    Column("foundation", "foundation, as printed", "%", 100, "+.1f"),
    Column("tilt", "tilt lifted", "%", 100, "+.1f"),
    Column("lifted", "all lifted", "%", 100, "+.1f"),
    Column("sine", "sine law", "%", 100, "+.1f"),
)
GRIDS = (
    Column("n", "sections n", form="d"),
    Column("torque", "error of torque", "", 1, ".1e"),
    Column("torque_ratio", "ratio", "", 1, ".2f"),
    Column("N", "error of N", "", 1, ".1e"),
    Column("N_ratio", "ratio", "", 1, ".2f"),
    Column("psi", "error of ψ", "", 1, ".1e"),
    Column("psi_ratio", "ratio", "", 1, ".2f"),
    Column("steps", "active-set steps, this brake", form="d"),
    Column("seconds", "time of this brake", "ms", 1e3, ".3g"),
)


def report(result: Result, folder: Path) -> Path:
    """Write page, figures, fields, CSV and JSON; returns the page."""
    comparison = result.comparison
    brake, fem = comparison.brake, comparison.responses["fem"]
    chart = post_figures.maps(result.maps, "beam: k R⁴/EI", "ring: k R⁴/EI_r", result.place)
    for ending in ("svg", "png"):
        figures.save(figures.pressures(panels(comparison)), folder / f"pressure.{ending}")
        figures.save(chart, folder / f"map.{ending}")
    figures.save(
        post_figures.curves(
            beams(result), "along the beam from the hinge [m]", "relative deformation r [mm]", zero=True
        ),
        folder / "beams.svg",
    )
    figures.save(post_figures.rim(rims(result), "mm"), folder / "rim.svg")
    figures.save(
        post_figures.curves(
            [
                (f"{shoe}", {name: _xy(values, 1e3, 1e2) for name, values in models.items()})
                for shoe, models in result.offsets.items()
            ],
            "radius of the lining − radius of the drum [mm]",
            "torque off nominal [%]",
            zero=True,
        ),
        folder / "clearance.svg",
    )
    for key, label in (
        ("shoe_factor", "shoe factor S"),
        ("friction_radius", "ψ"),
        ("resultant_angle", "θ from the post's normal [deg]"),
    ):
        figures.save(
            post_figures.curves(merit_panels(result, key), "friction coefficient μ", label), folder / f"{key}.svg"
        )
    picture = field_picture(brake, fem, folder, "fields", elements=result.elements)
    table = comparison.rows
    write_text(folder / "results.csv", as_csv(table))
    extra = {
        "lifts": result.lifts, "clearances": result.clearances, "assumptions": result.assumptions, "grids": result.grids,
        "offsets": result.offsets,
        "merits": {shoe: {model: [[mu, *merit] for mu, merit in values] for model, values in models.items()}
                   for shoe, models in result.merits.items()},
        "maps": [{"title": one.title, "x": one.x.tolist(), "y": one.y.tolist(),
                  "error": [[None if math.isnan(v) else v for v in line] for line in one.error.tolist()]}
                 for row in result.maps for one in row],
    }  # fmt: skip
    write_text(folder / "results.json", results_json([comparison], **extra).replace("NaN", "null"))
    page = folder / "index.html"
    write_page(page, "The post brake of a mine winder", lead(result), sections(result, table, picture, folder))
    return page


def _xy(values: Sequence[tuple[float, float]], x: float, y: float) -> Curve:
    a, b = np.array(values).T
    return a * x, b * y


def beams(result: Result) -> list[tuple[str, dict[str, Curve]]]:
    """For each shoe the relative deformation r [mm] along the beam, by each elastic model."""
    brake, responses = result.comparison.brake, result.comparison.responses
    made = []
    for i, shoe in enumerate(brake.shoes):
        x, w = beam_deflection(result.scene, brake, respond(result.scene, brake), i)
        models: dict[str, Curve] = {"fem": (x, (w - w[-1] * x / x[-1]) * 1e3)}
        for name in ("foundation", "lifted"):
            deformation = responses[name].shoes[i].deformation
            assert deformation is not None
            models[name] = (deformation.x, deformation.relative * 1e3)
        made.append((f"{shoe.name} post", models))
    return made


def rims(result: Result) -> list[tuple[str, dict[str, Curve]]]:
    """The rim's displacement [mm] around the drum: the paper's two rims, and the one rim of all shoes."""
    brake, responses = result.comparison.brake, result.comparison.responses
    turn = np.linspace(0, 2 * np.pi, 400)
    paper = foundation.rim(brake, responses["foundation"], turn)
    printed = {f"foundation {shoe.name}": (turn, z * 1e3) for shoe, z in zip(brake.shoes, paper, strict=True)}
    whole: dict[str, Curve] = {
        "lifted both shoes": (turn, foundation.rim(brake, responses["lifted"], turn, ALL).sum(axis=0) * 1e3)
    }
    fem = respond(result.scene, brake)
    theta, z = rim_displacement(result.scene, brake, fem)
    whole["fem both shoes"] = (np.append(theta, theta[0]), np.append(z, z[0]) * 1e3)
    return [("as printed: each with its twin opposite", printed), ("both shoes on one rim", whole)]


def merit_panels(result: Result, key: str) -> list[tuple[str, dict[str, Curve]]]:
    """Panels of one figure of merit over mu; angles in degrees from the hinge's foot normal."""
    made = []
    for shoe in result.comparison.brake.shoes:
        middle = 0.5 * (shoe.lining.start + shoe.lining.end)
        models = {}
        for model, values in result.merits[shoe.name].items():
            mu, y = np.array([(mu, getattr(merit, key)) for mu, merit in values]).T
            if key == "resultant_angle":
                y = np.degrees(y - middle) * axis_of(shoe.hinge.xy, shoe.actuation.point.xy).sense
            models[model] = (mu, y)
        made.append((f"{shoe.name} shoe", models))
    return made


def lead(result: Result) -> str:
    """What was found, in one sentence."""
    last = {row["lift"]: row for row in result.lifts}
    printed, lifted = last["none (the paper)"]["error"], last["all"]["error"]
    law = relative(result.comparison.responses["sine"].torque, result.comparison.responses["fem"].torque)
    return (
        f"Against the finite elements the sine law misses the torque of this brake by {law:+.0%}, the elastic foundation as "
        f"printed by {printed:+.0%}, the same model with its simplifications lifted by {lifted:+.0%}."
    )


def sections(result: Result, table: list[dict[str, Any]], picture: Figure | Text, folder: Path) -> list[Section]:
    """The page."""
    return [
        Section(
            "Pressure on the linings",
            [
                Figure(folder / "pressure.svg", "The same brake by four models."),
                Text(
                    "The ends of each post are drawn in and its middle stays behind; the rim gives way under the linings and bulges "
                    "between them. As printed, with an equal pressure opposite, that leaves both ends of each lining bearing. But "
                    "the opposite of a loaded end is a hinge's end: with both shoes on one rim, loaded above its middle on both "
                    "sides, the ends at the hinges lift off. Friction bends the rim to one side and makes the two unequal. The finite "
                    "elements add what springs side by side cannot do: friction shears the tall wooden block along the arc, which "
                    "opens the gap at the end towards which it is dragged, and the block's own edges are soft."
                ),
                Table(table, COLUMNS, "Errors against the finite elements. “lifted”: the foundation with all of the paper's simplifications lifted."),
            ],
        ),
        Section(
            "What each simplification of the paper is worth",
            [
                Table(result.lifts, LIFT_COLUMNS, "Lifted one at a time, then together; errors against the finite elements."),
                Text(
                    "The paper closes the gap by w cos θ. A section of the beam that turns by w′ also moves the lining along the "
                    "beam, by w′ times its distance from the axis, and this closes the gap by the sine of θ of it: with that "
                    "(<code>tilt</code>) a rigid post on a rigid drum presses by the sine law, without it by x cos θ. The paper's "
                    "ring carries an equal pressure opposite; that both shoes load one ring each in its own way is here the largest "
                    "of all corrections."
                ),
                Source("not in the model", "\n".join(foundation.solve(result.comparison.brake, lift=ALL).left_out)),
            ],
        ),
        Section(
            "Posts and brake path",
            [
                Figure(folder / "beams.svg", "Deformation r of the posts beyond the straight line through their ends (our reading: the paper's sketch of r is not legible). Towards the drum is positive."),
                Figure(folder / "rim.svg", "Displacement of the rim, inwards towards the centre. Left: as printed, a rim for each shoe with the same pressure opposite. Right: both shoes on one rim, all modes."),
                picture,
            ],
        ),
        Section(
            "Clearance",
            [
                Figure(folder / "clearance.svg", "Torque of each shoe over that of the sine law, which is what such brakes are rated by, over the error of the lining's radius."),
                Table(result.clearances, CLEARANCE, "Linings that fit, new ones of another radius, displaced ones, and one worn in until it bears by the sine law (by the foundation with all lifted; the finite elements show what it leaves out)."),
            ],
        ),
        Section(
            "Friction",
            [
                Figure(folder / "shoe_factor.svg", "Shoe factor S = T/(P R)."),
                Figure(folder / "friction_radius.svg", "Apparent radius of friction over R, ψ: above 1 the more the pressure sits at the lining's ends."),
                Figure(folder / "resultant_angle.svg", "Angle of the resultant from the post's normal [deg], positive towards the loaded end."),
            ],
        ),
        Section(
            "Where each model holds",
            [
                Table(result.assumptions, ASSUMPTIONS, "From a brake that meets the assumptions of the foundation model, each left in turn. Error of the torque of the worst shoe against the finite elements."),
                Figure(folder / "map.svg", "Error [%] of the torque of the worst shoe against the finite elements over the two groups that govern the foundation model: k R⁴/EI of the beam and of the ring, with k = b/(t/E of lining + t/E of block). Square: the posts and rim of this brake. Top: with a soft lining on a stiff block, where the springs are springs; bottom: with its own layers, where the wooden block shears. The place in a map holds for this geometry, linings of 80 deg and both shoes together."),
            ],
        ),
        Section(
            "Can the foundation model be trusted, and what does it cost?",
            [
                Table(result.grids, GRIDS, "Errors against n = 2880 on a variant whose lining bears everywhere, so that the contact set is fixed: second order, a ratio of 4. Steps and time: this brake, both posts, median of the repeats."),
                Text(f"All computing for this page took {result.seconds:.0f} s."),
            ],
        ),
        Section("The brake", [Source("studies/post_brake/brake.toml", (HERE / "brake.toml").read_text())]),
    ]  # fmt: skip
