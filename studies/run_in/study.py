"""When are the pressure laws right? Every brake of studies/ and meshes/ run in from new to the law."""

import math
import time
from collections.abc import Callable, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from drumlin import foundation
from drumlin.brake.drum_brake import Brake
from drumlin.brake.file import read_brake, vary
from drumlin.brake.plane_brake import FlatBrake, read_any
from drumlin.comparison import Column, as_csv
from drumlin.errors import BadInput, NoAnswer
from drumlin.fem.assembly import Scene, prepare, why_not
from drumlin.fem.fields import fields
from drumlin.fem.model import respond
from drumlin.files import write_text
from drumlin.laws import hinged, pivoted
from drumlin.report import figures, wear_figures
from drumlin.report.page import Figure, Section, Table, Text, write_page
from drumlin.report.wear_figures import Frame, Series
from drumlin.response.norms import relative
from drumlin.wear.archard import TOLERANCE, Law, State, at, explicit, ripple, run_on
from drumlin.wear.linings import Rig, fem_rig, foundation_rig
from drumlin.wear.run_in import COEFFICIENT, Target, checks, distance, life, norm, run_in, target, unit_distance, worn

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
MAIN = ROOT / "studies" / "double_shoe" / "brake.toml"
FLEXIBLE = ROOT / "studies" / "double_shoe" / "flexible.toml"
ARCHARD = Law(COEFFICIENT)
WITHIN = 0.01  # of the law: what "away from the law" means in the tables
AT_LAW = "at the law"
PRESSURE, TORQUE = 0.01, 0.001  # what must hold after run-in
RATIOS = (1e-4, 1e-3, 1e-2, 1e-1)  # E of the lining over that of the shoe
CURVES = (0.0, 0.3, 3.0, 10.0, 30.0)
REVERSALS = (10.0, 50.0, 250.0)  # in 1/(k K)


class Run(NamedTuple):
    """One brake run in: its rig, states, where it tends to, and 1/(k K) [m]."""

    name: str
    rig: Rig
    states: list[State]
    goal: Target
    unit: float


class Result(NamedTuple):
    """Everything that the report shows; rows of tables as in the columns below."""

    scene: Scene
    main: Run
    flexible: Run
    runs: list[Run]
    brakes: list[dict[str, Any]]
    ratios: list[dict[str, Any]]
    halves: list[dict[str, Any]]
    exponents: list[dict[str, Any]]
    held: Run
    reversals: list[tuple[float, list[State], list[float], float]]
    steppers: list[dict[str, Any]]
    boards: dict[str, tuple[State, float]]
    skipped: list[str]
    seconds: float


def study(*, short: bool = False, say: Callable[[str], None] = lambda _: None) -> Result:
    """Run in every brake, then the main one in many ways; `short`: few brakes, coarse."""
    start = time.perf_counter()
    elements = 30 if short else 80
    runs, brakes, skipped = list[Run](), list[dict[str, Any]](), list[str]()
    for name, model, brake in cases(skipped, short=short):
        say(f"{name}, {model}")
        row, one = brake_row(name, model, brake, elements)
        brakes.append(row)
        runs += [one] if one else []
    say("the main brake")
    brake = read_brake(MAIN)
    scene = prepare(brake, elements=elements)
    rig = fem_rig(scene, brake)
    main = worn_in("stiff shoes", rig)
    soft = read_brake(FLEXIBLE)
    flexible = worn_in("flexible shoes", fem_rig(prepare(soft, elements=elements), soft))
    say("linings from soft to stiff")
    ratios = [ratio_row(brake, ratio, elements) for ratio in (RATIOS[1::2] if short else RATIOS)]
    say("half the step, twice the way")
    halves = [half_row(one) for one in (main, flexible)]
    say("exponents")
    exponents = [exponent_row(rig, m) for m in ((2.0,) if short else (0.5, 1.0, 1.5, 2.0, 3.0))]
    say("held torque")
    held = worn_in("held torque", rig, torque=main.goal.torque)
    reversals = []
    for every in REVERSALS[:1] if short else REVERSALS:
        say(f"reversed every {every:g}")
        reversals.append((every, *reversed_run(scene, brake, every * main.unit, 3 if short else 8)))
    say("steps")
    steppers, boards = stepping(main, 3.0, (0.05, 0.5))
    return Result(
        scene, main, flexible, runs, brakes, ratios, halves, exponents, held, reversals, steppers, boards, skipped,
        time.perf_counter() - start,
    )  # fmt: skip


def cases(skipped: list[str], *, short: bool) -> list[tuple[str, str, Brake]]:
    """Name, model and brake of everything that can be run in; `skipped` gets the files that cannot, with the reason."""
    found: list[tuple[str, str, Brake]] = []
    for path in sorted([*(ROOT / "studies").glob("*/*.toml"), *(ROOT / "meshes").glob("*.toml")]):
        name = f"{path.parent.name}/{path.stem}"
        if short and name not in {"laws/block", "laws/pivoted_block", "double_shoe/brake"}:
            continue
        try:
            brake = read_any(path)
        except BadInput:
            continue  # another kind of file
        if isinstance(brake, FlatBrake):
            skipped.append(f"{name}: shoes on a plane are not modelled elastically")
            continue
        reason = why_not(brake)
        if reason is None:
            found.append((name, "fem", brake))
            if len(brake.shoes) == 1:  # of two shoes one is what the other is when the drum turns back
                other = "clockwise" if brake.spin > 0 else "counter-clockwise"
                found.append((f"{name}, turned back", "fem", vary(brake, {"rotation": other})))
            if (
                all(shoe.body is None and shoe.pivot is None for shoe in brake.shoes)
                and brake.shoes[0].side == "external"
            ):
                found.append((f"{name}, guided", "guided", brake))
        else:
            skipped.append(f"{name}: {reason}")
        if foundation.why_not(brake) is None:
            found += [(name, model, brake) for model in ("foundation", "foundation, lifted")]
    return found


def rig_of(model: str, brake: Brake, elements: int) -> Rig:
    """The rig of a brake by one of the models of `cases`."""
    if model.startswith("foundation"):
        return foundation_rig(brake, lift=("all",) if "lifted" in model else ())
    return fem_rig(prepare(brake, elements=elements), brake, guide="radius" if model == "guided" else "hinge")


def worn_in(name: str, rig: Rig, law: Law = ARCHARD, **options: Any) -> Run:
    """Run in a rig until it is settled."""
    states = run_in(rig, law, **options)
    return Run(name, rig, states, target(rig, law, options.get("torque")), unit_distance(rig, law))


def law_of(model: str, brake: Brake) -> tuple[str, float]:
    """What the pressure of a model tends to, and the torque [N m] of the brake's law."""
    if model == "guided":
        return "cos", hinged.guided_torque(brake)
    if any(shoe.pivot for shoe in brake.shoes):
        return "A cos + B sin", pivoted.solve(brake).torque
    # As published, the foundation's sections turn without tilt.
    return "x cos" if model == "foundation" else "sin", hinged.sine(brake).torque


def brake_row(name: str, model: str, brake: Brake, elements: int) -> tuple[dict[str, Any], Run | None]:
    """How a brake runs in, as a row; a failure stays as a row."""
    row: dict[str, Any] = {"brake": name, "model": model}
    begin = time.perf_counter()
    try:
        rig = rig_of(model, brake, elements)
        one = worn_in(f"{name}, {model}", rig)
        row["law"], torque = law_of(model, brake)
    except NoAnswer as error:
        return {**row, "status": f"failed: {error}"}, None
    row |= {"target": relative(one.goal.torque, torque), **run_row(one), "seconds": time.perf_counter() - begin}
    if row["status"] == AT_LAW and abs(row["target"]) > TORQUE:
        row["status"] = "at its own limit, which is not the law"
    return row, one


def run_row(one: Run) -> dict[str, Any]:
    """What a run says of a brake: new, worn in, how long it took, its balances."""
    rig, states, goal, unit = one.rig, one.states, one.goal, one.unit
    new, end = distance(rig, states[0], goal), distance(rig, states[-1], goal)
    spent = life(rig, states, goal, ARCHARD, within=WITHIN)
    close = life(rig, states, goal, ARCHARD, within=TORQUE)
    balance = checks(rig, states, ARCHARD)
    holds = end.pressure <= PRESSURE and abs(end.torque) <= TORQUE
    return {
        "new_pressure": new.pressure,
        "new_torque": new.torque,
        "least_torque": min(distance(rig, state, goal).torque for state in states),
        "pressure_distance": spent.pressure * spent.distance / unit,
        "torque_distance": spent.torque * spent.distance / unit,
        "close_distance": close.torque * close.distance / unit,
        "life": spent.distance / unit,
        "pressure_life": spent.pressure,
        "torque_life": spent.torque,
        "end_pressure": end.pressure,
        "end_torque": end.torque,
        "volume": balance.volume,
        "energy": balance.energy,
        "ripple": ripple_of(one, states[-1]),
        "steps": len(states) - 1,
        "status": AT_LAW if holds else "short of the law",
    }


def ripple_of(one: Run, state: State) -> float:
    """The worst lining's checkerboard."""
    return max(ripple(surface.along(state.pressure)) for surface in one.rig.surfaces)


def ratio_row(brake: Brake, ratio: float, elements: int) -> dict[str, Any]:
    """The main brake with a lining of `ratio` times the shoe's modulus."""
    body = brake.shoes[0].body
    assert body is not None and body.material is not None  # the main brake has shoes of steel
    changed = vary(brake, {"shoe.lining.material.E": ratio * body.material.E})
    return {"ratio": ratio, **run_row(worn_in("", fem_rig(prepare(changed, elements=elements), changed)))}


def half_row(one: Run) -> dict[str, Any]:
    """A run against the same with every step halved, and ten times as far."""
    s = [state.s for state in one.states]
    middles = [(a + b) / 2 for a, b in pairwise(s)]
    halved = run_on(one.rig.rubs, ARCHARD, sorted([*s[1:], *middles]))[::2]
    area = np.concatenate([rub.area for rub in one.rig.rubs])

    def size(p: Any) -> float:
        return math.sqrt(float(area @ p**2))

    pairs = list(zip(one.states, halved, strict=True))
    long = run_in(one.rig, ARCHARD, distance=10 * s[-1])
    after = distance(one.rig, long[-1], one.goal)
    return {
        "brake": one.name,
        "asked": TOLERANCE,
        "pressure": max(size(a.pressure - b.pressure) / size(b.pressure) for a, b in pairs),
        "torque": max(abs(relative(a.torque, b.torque)) for a, b in pairs),
        "depth": max(float(np.abs(a.depth - b.depth).max() / b.depth.max()) for a, b in pairs[1:]),
        "long_pressure": after.pressure,
        "long_torque": after.torque,
    }


def exponent_row(rig: Rig, m: float) -> dict[str, Any]:
    """The main brake under another exponent of the pressure: the law is then sin^(1/m)."""
    law = Law(COEFFICIENT, m)
    states, goal = run_in(rig, law), target(rig, law)
    end = distance(rig, states[-1], goal)
    return {
        "exponent": m,
        "goal": goal.torque,
        "sine": relative(goal.torque, hinged.sine(rig.brake).torque),
        "end_pressure": end.pressure,
        "end_torque": end.torque,
        "volume": checks(rig, states, law).volume,
        "steps": len(states) - 1,
    }


def reversed_run(scene: Scene, brake: Brake, every: float, turns: int) -> tuple[list[State], list[float], float]:
    """States under reversals, the distance of p from the law of the sense that each has, and that of the mean wear.

    The mean: depth worn over the last two reversals, one each way, against that by the mean of both laws.
    """
    other = vary(brake, {"rotation": "clockwise" if brake.spin > 0 else "counter-clockwise"})
    rigs = {True: fem_rig(scene, brake), False: fem_rig(scene, other)}
    goals = {sense: target(rig) for sense, rig in rigs.items()}
    states = run_in(rigs[True], ARCHARD, backward=rigs[False], reverse=every, distance=turns * every, tolerance=5e-3)
    far = [distance(rigs[state.forward], state, goals[state.forward]).pressure for state in states]
    turned = [state for state, after in pairwise(states) if state.forward != after.forward] + states[-1:]
    worn_off = turned[-1].depth - turned[-3].depth
    law = ARCHARD.coefficient * every * (goals[True].pressure + goals[False].pressure)
    rig = rigs[True]
    mean = max(norm(s, s.along(worn_off - law)) / norm(s, s.along(law)) for s in rig.surfaces)
    return states, far, mean


def stepping(
    one: Run, end: float, steps: Sequence[float]
) -> tuple[list[dict[str, Any]], dict[str, tuple[State, float]]]:
    """Implicit and explicit steps of equal size up to `end`, in 1/(k K): checkerboard, contact, torque."""
    exact = at(run_in(one.rig, ARCHARD, distance=end * one.unit, tolerance=1e-4), end * one.unit)
    rows, boards = list[dict[str, Any]](), dict[str, tuple[State, float]]()
    for size in steps:
        count = round(end / size)
        ways: dict[str, Callable[[], list[State]]] = {
            "implicit": lambda size=size, count=count: run_on(  # type: ignore[misc]
                one.rig.rubs, ARCHARD, [(i + 1) * size * one.unit for i in range(count)]
            ),
            "explicit": lambda size=size, count=count: explicit(one.rig.rubs, ARCHARD, size * one.unit, count),  # type: ignore[misc]
        }
        for way, run in ways.items():
            row: dict[str, Any] = {"way": way, "step": size}
            try:
                last = run()[-1]
            except NoAnswer as error:
                rows.append({**row, "status": f"failed: {error}"})
                continue
            row["ripple"] = ripple_of(one, last)
            row["touching"] = float((last.pressure > 0).mean())
            row["torque"] = last.torque
            row["torque_error"] = relative(last.torque, exact.torque)
            rows.append({**row, "status": "ended"})
            boards[f"{way}\nsteps of {size:g}/(k K)"] = (last, row["ripple"])
    return rows, boards


BRAKES = (
    Column("brake", "brake"),
    Column("model", "model"),
    Column("law", "p tends to"),
    Column("new_torque", "torque, new, off the law", "%", 100, "+.2f"),
    Column("new_pressure", "p, new, off the law (L2)", "%", 100, ".0f"),
    Column("torque_distance", "torque within 1 % after", "1/(k K)", 1, ".3g"),
    Column("close_distance", "within 0.1 % after", "1/(k K)", 1, ".3g"),
    Column("pressure_distance", "p within 1 % after", "1/(k K)", 1, ".3g"),
    Column("torque_life", "of life with torque off", "%", 100, ".3g"),
    Column("pressure_life", "of life with p off", "%", 100, ".3g"),
    Column("end_torque", "torque, worn in, off the law", "%", 100, "+.4f"),
    Column("end_pressure", "p, worn in, off the law (L2)", "%", 100, ".3f"),
    Column("target", "limit off the torque of the law", "%", 100, "+.1e"),
    Column("volume", "volume balance", "", 1, ".0e"),
    Column("energy", "energy balance", "", 1, ".0e"),
    Column("ripple", "checkerboard", "", 1, ".0e"),
    Column("steps", "steps", form="d"),
    Column("seconds", "time", "s", 1, ".2f"),
    Column("status", "status"),
)
SOFT_TO_STIFF = (
    Column("ratio", "E lining / E shoe", "", 1, ".0e"),
    *(c for c in BRAKES if c.key not in {"brake", "model", "law", "target", "seconds"}),
)
HALVES = (
    Column("brake", "brake"),
    Column("asked", "asked of a step", "%", 100, ".2g"),
    Column("pressure", "half the step: p (L2), largest", "%", 100, ".2g"),
    Column("torque", "torque, largest", "%", 100, ".2g"),
    Column("depth", "worn depth, largest", "%", 100, ".2g"),
    Column("long_pressure", "ten times as far: p off the law", "%", 100, ".1e"),
    Column("long_torque", "torque off the law", "%", 100, "+.1e"),
)
EXPONENTS = (
    Column("exponent", "exponent m", "", 1, "g"),
    Column("goal", "torque of p ~ sin^(1/m)", "N m", 1, ".5g"),
    Column("sine", "off the sine law", "%", 100, "+.2f"),
    Column("end_torque", "torque, worn in, off it", "%", 100, "+.4f"),
    Column("end_pressure", "p, worn in, off it (L2)", "%", 100, ".3f"),
    Column("volume", "volume balance", "", 1, ".0e"),
    Column("steps", "steps", form="d"),
)
STEPPERS = (
    Column("way", "steps"),
    Column("step", "size", "1/(k K)", 1, "g"),
    Column("ripple", "checkerboard", "", 1, ".1e"),
    Column("touching", "nodes in contact", "%", 100, ".0f"),
    Column("torque", "torque", "N m", 1, ".5g"),
    Column("torque_error", "off fine steps", "%", 100, "+.3f"),
    Column("status", "status"),
)


def report(result: Result, folder: Path) -> Path:
    """Write page, figures, film and tables; returns the page."""
    for name in ("brakes", "ratios", "halves", "exponents", "steppers"):
        write_text(folder / f"{name}.csv", as_csv(getattr(result, name)))
    pictures = draw(result, folder)
    page = folder / "index.html"
    write_page(page, "Running in: when are the pressure laws right?", lead(result), sections(result, pictures))
    return page


def draw(result: Result, folder: Path) -> dict[str, Path]:
    """All figures and the film."""
    main, flexible = result.main, result.flexible
    made: dict[str, Path] = {}
    for one, curves in ((main, CURVES), (flexible, (0.0, 3.0, 30.0, 100.0, 300.0))):
        key = one.name.split()[0]
        for ending in ("svg", "png"):
            picture = wear_figures.pressure_picture(one.rig, one.states, one.goal, one.unit, curves)
            made[key] = figures.save(picture, folder / f"pressure_{key}.{ending}")
    open_one = least_contact(result)
    ends = open_one.states[-1].s / open_one.unit * np.array([0.003, 0.03, 0.2, 1.0])
    marks = [float(f"{end:.1g}") for end in ends[:-1]]
    made["profiles"] = figures.save(
        wear_figures.profiles(open_one.rig, open_one.states, open_one.unit, marks), folder / "profiles.svg"
    )
    made["open"] = figures.save(
        wear_figures.pressure_picture(open_one.rig, open_one.states, open_one.goal, open_one.unit, [0.0, *marks]),
        folder / "pressure_open.svg",
    )
    shown = [one for one in result.runs if abs(distance(one.rig, one.states[0], one.goal).torque) > 0.01]
    torques = [
        Series(
            one.name,
            *wear_figures.curve(one.states, one.unit, [100 * (s.torque / one.goal.torque - 1) for s in one.states]),
        )
        for one in shown or [main]
    ]
    made["torque"] = figures.save(
        wear_figures.lines(torques, "torque off the law [%]", law="law", band=0.1), folder / "torque.svg"
    )
    force = Series(
        "", *wear_figures.curve(result.held.states, result.held.unit, [100 * (s.force - 1) for s in result.held.states])
    )
    made["held"] = figures.save(
        wear_figures.lines(
            [force._replace(label="force for the law's torque")], "force off the brake's own [%]", law="law: no change"
        ),
        folder / "held.svg",
    )
    _, states, far, _ = result.reversals[min(1, len(result.reversals) - 1)]
    made["reversal"] = figures.save(
        wear_figures.lines(
            [
                Series("torque off the law", *wear_figures.curve(states, main.unit, [100 * (s.torque / main.goal.torque - 1) for s in states]), wear_figures.NEW),
                Series("p off the law (L2) / 10", *wear_figures.curve(states, main.unit, [10 * x for x in far]), wear_figures.LATE),
            ],
            "distance from the law [%]", law="law", log=False,
        ),
        folder / "reversal.svg",
    )  # fmt: skip
    made["checkerboard"] = figures.save(
        wear_figures.checkerboard(main.rig.surfaces[0], result.boards), folder / "checkerboard.svg"
    )
    made["film"] = film(result.scene, main, folder / "film.gif", 6 if len(result.ratios) < len(RATIOS) else 40)
    return made


def least_contact(result: Result) -> Run:
    """The brake of which the least lies on when new."""
    return min([result.main, *result.runs], key=lambda one: float((one.states[0].pressure > 0).mean()))


def film(scene: Scene, one: Run, path: Path, count: int) -> Path:
    """The film of a run: frames evenly spread over the logarithm of the distance."""
    end = one.states[-1].s
    frames = []
    for s in [0.0, *np.geomspace(3e-4 * end, end, count - 1)]:
        state = at(one.states, s)
        brake = worn(one.rig, state)
        response = respond(scene, brake, penalty=math.inf)
        shown = [fields(scene, brake, response, i) for i in range(len(brake.shoes))]
        frames.append(Frame(state, shown, [shoe.turn or 0.0 for shoe in response.shoes]))
    return wear_figures.film(one.rig, frames, one.goal, one.unit, path)


def lead(result: Result) -> str:
    """What was found, in a sentence or two."""
    stiff = run_row(result.main)
    soft = run_row(result.flexible)
    met = sum(row["status"] == AT_LAW for row in result.brakes)
    return (
        f"{met} of {len(result.brakes)} elastic models of brakes, worn by Archard's law, end at the law of their rigid shoes "
        f"(p within {PRESSURE:.0%}, torque within {TORQUE:.1%}), elastic as they are. New linings on stiff shoes carry "
        f"a pressure {stiff['new_pressure']:.0%} off the law and need {stiff['pressure_life']:.0%} of their life to come "
        f"within 1 % of it; on flexible shoes {soft['pressure_life']:.0%}: they are worn out first."
    )


def sections(result: Result, pictures: dict[str, Path]) -> list[Section]:
    """The page."""
    stiff, soft = run_row(result.main), run_row(result.flexible)
    worst_volume = max(row["volume"] for row in result.brakes if "volume" in row)
    lives = [row for row in result.brakes if "life" in row]
    elastic = [row for row in lives if abs(row["new_torque"]) > 0.01]
    reversal = result.reversals[min(1, len(result.reversals) - 1)]
    return [
        Section(
            "A lining runs in",
            [
                Figure(pictures["film"], "The main brake from new to worn in; shoes coloured by von Mises stress."),
                Figure(
                    pictures["stiff"],
                    "Main brake, stiff shoes. K = E/t of the lining, k the wear coefficient, s sliding distance.",
                ),
                Text(
                    "dh/ds = k p: where the elastic shoe presses hardest the lining wears fastest. Ripples and the singular "
                    "edge go first, within s k K of about 1; the bending of the shoe holds out longest, because the shoe "
                    "springs back as the lining gives way. In the end all points must wear as the shoe turns, p ~ sin φ: "
                    "what was elastic is then in the worn shape."
                ),
                Figure(pictures["flexible"], "The same brake with shoes 12 mm thick."),
                Figure(
                    pictures["open"],
                    f"The brake that bears least of its lining when new: {least_contact(result).name}.",
                ),
                Figure(pictures["profiles"], "The same: worn depth (logarithmic above 1 µm), and the arcs in contact."),
            ],
        ),
        Section(
            "Every brake",
            [
                Figure(
                    pictures["torque"],
                    "Torque over the sliding distance of brakes that are off by more than 1 % when new. Band: 0.1 %.",
                ),
                Table(
                    result.brakes,
                    BRAKES,
                    "Away from the law: more than 1 %. Life: until the deepest wear is 80 % of the thickness, at the brake's own "
                    "force. Distances of p in L2, the worst lining, one element at each end left out. 'Limit off the "
                    "torque of the law': what the model's own steady state is from the closed form; the foundation as published turns its "
                    "lining without tilt, so that its limit is x cos θ and not sin φ. Checkerboard: of the last state.",
                ),
                *([Text("Not run in: " + "; ".join(result.skipped) + ".")] if result.skipped else []),
                Table(result.ratios, SOFT_TO_STIFF, "Main brake with linings from soft to stiff."),
            ],
        ),
        Section(
            "What the user of a law should assume",
            [
                Text(
                    f"<b>A new lining.</b> Rigid shoes with an elastic lining are near their law from the start and reach it within a "
                    "few 1/(k K). Elastic shoes are not: of the brakes here whose torque starts more than "
                    f"1 % off, it starts {min(row['new_torque'] for row in elastic):+.0%} to {max(row['new_torque'] for row in elastic):+.0%} "
                    f"off, and p {min(row['new_pressure'] for row in elastic):.0%} to {max(row['new_pressure'] for row in elastic):.0%}. "
                    "The torque does not fall to the law evenly: on the main brake it first falls below by "
                    f"{-stiff['least_torque']:.1%}, and within the run-in any value between must be expected."
                    if elastic
                    else "No brake of this short run starts far off."
                ),
                Text(
                    "<b>A worn-in lining.</b> Torque and pressure are those of the law, whatever the elasticity, for one sense of "
                    f"rotation and one line of force. Main brake: torque within 1 % after {stiff['torque_distance']:.3g}/(k K), "
                    f"{stiff['torque_life']:.1%} of its life, p after {stiff['pressure_distance']:.3g}/(k K), {stiff['pressure_life']:.0%}. "
                    f"Flexible shoes: {soft['torque_distance']:.3g}/(k K), {soft['torque_life']:.0%}, and {soft['pressure_distance']:.3g}/(k K), "
                    f"{soft['pressure_life']:.0%} of the life. The part of life is "
                    "(s k K)(p/E)/0.8 and depends on neither k nor the speed: light duty (p/E small) runs in early in life, heavy "
                    "duty late or never. For a stiffer lining s k K grows but p/E falls: over the stiffnesses in the table above "
                    f"p is off the law for {min(row['pressure_life'] for row in result.ratios):.0%} to "
                    f"{max(row['pressure_life'] for row in result.ratios):.0%} of the life."
                ),
                Text("Not modelled: the lining's stiffness grows as it thins, heat, and wear of the drum."),
            ],
        ),
        Section(
            "Turned back, or held at a torque",
            [
                Figure(pictures["reversal"], f"Main brake, reversed every {reversal[0]:g}/(k K)."),
                Text(
                    "Worn in for one sense a lining is not worn in for the other: the elastic shoe leans to the other side. Right "
                    f"after a reversal at {reversal[0]:g}/(k K) p is {max(reversal[2][len(reversal[2]) // 2 :]):.0%} off the law, nearly as "
                    f"far as a new lining ({stiff['new_pressure']:.0%}). A brake that turns both ways equally keeps to the law only in "
                    f"the mean of both senses, here within {max(mean for *_, mean in result.reversals):.1%}."
                ),
                Table(
                    [
                        {
                            "every": every,
                            "after": max(far[len(far) // 2 :]),
                            "before": min(far[len(far) // 2 :]),
                            "mean": mean,
                        }
                        for every, _, far, mean in result.reversals
                    ],
                    (
                        Column("every", "reversed every", "1/(k K)", 1, "g"),
                        Column("after", "p off the law right after a reversal", "%", 100, ".0f"),
                        Column("before", "p off the law at its best", "%", 100, ".2g"),
                        Column("mean", "mean wear of both senses off the law", "%", 100, ".2g"),
                    ),
                    "Second half of each run.",
                ),
                Figure(pictures["held"], "Force that holds the law's torque, main brake."),
            ],
        ),
        Section(
            "Can the wear be trusted?",
            [
                Text(
                    f"Worn volume against k ∫∫ p: at most {worst_volume:.0e}. The energy balance compares the worn shape, integrated "
                    "over a round lining, with k/μ times the work of the torque; it sees how round the mesh is."
                ),
                Table(result.halves, HALVES, "Half the step gives the same answer; a longer run stays at the law."),
                Table(
                    result.exponents,
                    EXPONENTS,
                    "dh/ds ~ p^m, main brake: p tends to sin^(1/m), the torque to that of this pressure.",
                ),
                Figure(pictures["checkerboard"], "Right shoe after s k K = 3, nodal pressures."),
                Text(
                    "Checkerboard: L2 norm of the fourth difference (1, −4, 6, −4, 1)/16 of the nodal pressures over that of "
                    "p, five nodes at the contact's ends left out: 1 for a pressure that alternates, 0 for a smooth one on an even mesh (1e-4 on these graded ones). An "
                    "explicit step, depth += k p ds at the nodes, breaks into it while its torque still looks right; the implicit "
                    "step makes the wear a compliance and does not."
                ),
                Table(result.steppers, STEPPERS, "Equal steps up to s k K = 3."),
                Text(f"All computing for this page took {result.seconds:.0f} s."),
            ],
        ),
    ]
