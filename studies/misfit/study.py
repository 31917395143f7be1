"""What do misfit and manufacturing tolerances make of a brake's torque, and how does run-in heal it?"""

import math
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from drumlin.arrays import Floats
from drumlin.brake import clearance
from drumlin.brake.drum_brake import Brake
from drumlin.brake.file import read_brake, vary
from drumlin.comparison import Column, as_csv
from drumlin.fem.assembly import prepare
from drumlin.fem.model import respond
from drumlin.files import write_text
from drumlin.journal import Journal
from drumlin.laws import sine
from drumlin.report import figures, misfit_figures
from drumlin.report.page import Figure, Section, Table, Text, write_page
from drumlin.response.norms import relative
from drumlin.response.response import Response
from drumlin.sweeps import cases as sweep
from drumlin.sweeps.cases import Case, Row
from drumlin.sweeps.tolerances import (
    PERCENTILES,
    Shares,
    Tolerance,
    between,
    cases,
    draw,
    healing,
    numbers,
    shares,
    spread,
    within,
)
from drumlin.sweeps.workers import executor
from drumlin.wear.run_in import COEFFICIENT
from drumlin.wear.worn_in import worn_in

BRAKE = Path(__file__).parents[1] / "double_shoe" / "brake.toml"
MISFIT = "shoe.lining.misfit"
LOBES = 20e-6  # m, amplitude of the drums in the figure of one turn
FAMILY = (-100, -50, -20, 0, 20, 50, 100)  # um, lining radius against drum radius
DISTANCES = (0.0, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0)  # of run-in, in units of 1/(k K)
SEED = 20
QUANTITIES = {"torque": "torque [N m]", "brake_factor": "brake factor T/(F R)", "peak_pressure": "peak pressure [MPa]"}


class Result(NamedTuple):
    """Everything that the report shows."""

    brake: Brake
    law: Response
    single: list[dict[str, Any]]
    family: dict[float, Response]
    sides: tuple[Floats, Floats]
    ratios: dict[str, Floats]
    angles: Floats
    turns: dict[str, dict[str, Floats]]
    tolerances: tuple[Tolerance, ...]
    draws: int
    rows: dict[str, list[Row]]
    shares: dict[str, dict[str, list[Shares]]]
    healed: dict[str, Floats]
    unit: float
    seconds: float


def study(
    *, short: bool = False, say: Callable[[str], None] = lambda _: None, journal: Journal | None = None
) -> Result:
    """One misfit at a time, radius and offset, a turn of the drum, tolerances, run-in; `short`: coarser, fewer."""
    start = time.perf_counter()
    journal = Journal() if journal is None else journal
    elements, fine, n, wide, high, around, healed = (
        (24, 24, 8, 7, 5, 24, 6) if short else (40, 160, 512, 31, 21, 96, 192)
    )
    brake = nominal(read_brake(BRAKE))
    law = sine(brake)
    scene = prepare(brake, elements=fine)
    say("single misfits")
    family = {dr: respond(scene, vary(brake, radius(brake, dr * 1e-6))) for dr in map(float, FAMILY)}
    angles = np.linspace(0, 2 * math.pi, around, endpoint=False)
    turns: dict[str, dict[str, Floats]] = {}
    for state, stood in (("new", brake), ("worn in", worn_in(scene, brake))):
        turns[state] = {}
        for order, name in ((1, "run-out"), (2, "oval"), (3, "three lobes"), (5, "five lobes")):
            lobed = vary(stood, {"drum.out_of_round": [{"order": order, "amplitude": LOBES}]})
            responses = clearance.one_turn(lobed, lambda turned: respond(scene, turned), angles.tolist())
            turns[state][name] = np.array([response.torque for response in responses])
    tolerances = assumed(brake)
    deviates = draw(tolerances, n, SEED)
    with executor(1 if short else None) as (pool, workers):

        def solve(what: str, several: Sequence[Case]) -> list[Row]:
            return sweep.run(
                several, executor=pool, workers=workers, journal=journal,
                done=lambda finished, of: say(f"{what}: {finished} of {of}"),
            )  # fmt: skip

        sides = np.linspace(-150e-6, 150e-6, wide), np.linspace(-100e-6, 100e-6, high)
        grid = [radius(brake, dr) | offset(brake, dc) for dc in sides[1] for dr in sides[0]]
        found = solve("radius and offset", [Case(brake, changes, options={"elements": elements}) for changes in grid])
        rows = {
            "new": solve("new brakes", cases(brake, tolerances, deviates, elements=elements)),
            "worn in": solve("worn-in brakes", cases(brake, tolerances, deviates, elements=elements, worn_in=True)),
            "law": solve("sine law", cases(brake, tolerances, deviates[:2], "sine")),
        }
    stiffness = brake.shoes[0].lining.material.E / brake.shoes[0].lining.thickness
    unit = 1 / (COEFFICIENT * stiffness)
    healing_rows = []
    for i, case in enumerate(cases(brake, tolerances, deviates[0, :healed])):
        say(f"run-in: {i} of {healed}")

        def wear(case: Case = case) -> dict[str, Any]:
            return healing(vary(brake, case.changes), [s * unit for s in DISTANCES], elements=elements)

        healing_rows.append(journal.once({"healing": dict(case.changes), "elements": elements}, wear))
    peak = max(shoe.peak_pressure for shoe in law.shoes)
    return Result(
        brake=brake,
        law=law,
        single=single_rows(brake, law, lambda changed: respond(scene, changed)),
        family=family,
        sides=sides,
        ratios={
            "torque": numbers(found, "torque").reshape(high, wide) / law.torque - 1,
            "peak_pressure": numbers(found, "peak_pressure").reshape(high, wide) / peak - 1,
        },
        angles=angles,
        turns=turns,
        tolerances=tolerances,
        draws=n,
        rows=rows,
        shares={
            state: {
                name: shares(tolerances, numbers(rows[state], name).reshape(-1, n), seed=SEED) for name in QUANTITIES
            }
            for state in ("new", "worn in")
        },
        healed={name: np.array([row[name] for row in healing_rows]) for name in ("torque", "peak_pressure")},
        unit=unit,
        seconds=time.perf_counter() - start,
    )


def nominal(brake: Brake) -> Brake:
    """The brake with the keys that tolerances move: the lining's own radius, and an oval of nothing."""
    return vary(brake, {f"{MISFIT}.radius": brake.drum.radius, "drum.out_of_round": [{"order": 2, "amplitude": 0.0}]})


def radius(brake: Brake, mismatch: float) -> dict[str, float]:
    """Every lining ground to a radius that is greater than the drum's by the mismatch [m]."""
    return {f"shoe[{i}].lining.misfit.radius": brake.drum.radius + mismatch for i in range(len(brake.shoes))}


def offset(brake: Brake, size: float) -> dict[str, float]:
    """Every lining's circle moved by `size` [m] along the radius of its hinge, away from the drum's centre."""
    keys = [along(brake, i, "lining.misfit.offset") for i in range(len(brake.shoes))]
    return {key: size * slope for part in keys for key, slope in part.items()}


def along(brake: Brake, index: int, key: str) -> dict[str, float]:
    """How a point of shoe `index` moves along the radius of its hinge."""
    hinge = brake.shoes[index].hinge
    return {
        f"shoe[{index}].{key}.x": hinge.x / hinge.radius,
        f"shoe[{index}].{key}.y": hinge.y / hinge.radius,
    }


def assumed(brake: Brake) -> tuple[Tolerance, ...]:
    """The tolerances: limits are two standard deviations of a normal distribution cut there. All are assumptions.

    Drums and linings are turned and ground to some hundredths of a millimetre of their radius, pins and lines of
    force are held to tenths, organic linings spread by some 10 % in friction and 20 % in stiffness.
    """
    leading = 0 if sine(brake).shoes[0].self_energising else 1
    found = [
        Tolerance("friction ±0.03", within(0.03), {"friction": 1.0}),
        Tolerance("lining's modulus ±20 %", within(0.2), {"shoe.lining.material.E": modulus(brake)}),
        Tolerance("lining's thickness ±0.2 mm", within(0.2e-3), {"shoe.lining.thickness": 1.0}),
        Tolerance("drum's radius ±50 µm", within(50e-6), {key: -1.0 for key in radius(brake, 0.0)}),
    ]
    for name, i in (("leading", leading), ("trailing", 1 - leading)):
        own = f"shoe[{i}].lining.misfit"
        found += [
            Tolerance(f"lining's radius ±50 µm, {name}", within(50e-6), {f"{own}.radius": 1.0}),
            Tolerance(f"centre of lining ±50 µm, {name}", within(50e-6), along(brake, i, "lining.misfit.offset")),
            Tolerance(f"taper ±50 µm, {name}", within(50e-6), {f"{own}.taper": 1.0}),
        ]
    pins = {key: slope for i in range(len(brake.shoes)) for key, slope in along(brake, i, "hinge").items()}
    return (
        *found,
        Tolerance("pins' distance ±0.2 mm", within(0.2e-3), pins),
        Tolerance("force ±3 %", within(0.03), {"shoe.actuation.force": brake.shoes[0].actuation.force}),
        Tolerance("line of force ±0.5 mm", within(0.5e-3), {"shoe.actuation.point.y": 1.0}),
        Tolerance("ovality of drum 0 to 30 µm", between(0.0, 30e-6), {"drum.out_of_round[0].amplitude": 1.0}),
        Tolerance("where the oval drum stands", between(0.0, 2 * math.pi), {"drum.angle": 1.0}),
    )


def modulus(brake: Brake) -> float:
    """Young's modulus of the linings [Pa]."""
    return brake.shoes[0].lining.material.E


def single_rows(brake: Brake, law: Response, solve: Callable[[Brake], Response]) -> list[dict[str, Any]]:
    """One misfit at a time, against the lining that fits and against the law."""
    fits = solve(brake)
    growth = clearance.thermal_growth(brake.drum.radius, 11e-6, 100.0)

    def stepped(depth: float) -> dict[str, Any]:
        return {
            f"shoe[{i}].lining.misfit.blocks": [[shoe.lining.middle, depth * shoe.frame.sense]]
            for i, shoe in enumerate(brake.shoes)
        }

    hot = {"drum.out_of_round": [{"order": 0, "amplitude": growth}]}
    several: Mapping[str, Mapping[str, Any]] = {
        "fits": {},
        "linings 50 µm larger in radius": radius(brake, 50e-6),
        "linings 50 µm smaller in radius": radius(brake, -50e-6),
        "linings moved 50 µm along the pin's radius, outwards": offset(brake, 50e-6),
        "linings moved 50 µm along the pin's radius, inwards": offset(brake, -50e-6),
        "taper: 50 µm thinner away from the pin": {f"{MISFIT}.taper": 50e-6},
        "taper: 50 µm thicker away from the pin": {f"{MISFIT}.taper": -50e-6},
        "two blocks: the one away from the pin 20 µm lower": stepped(20e-6),
        "two blocks: the one away from the pin 20 µm higher": stepped(-20e-6),
        f"drum 100 K hotter than the shoes: {growth * 1e6:.0f} µm larger": hot,
    }
    rows = []
    for name, changes in several.items():
        response = solve(vary(brake, changes))
        peak = max(shoe.peak_pressure for shoe in response.shoes)
        rows.append(
            {
                "misfit": name,
                "torque": response.torque,
                "from_fit": relative(response.torque, fits.torque),
                "from_law": relative(response.torque, law.torque),
                "peak": peak,
                "peak_from_law": relative(peak, max(shoe.peak_pressure for shoe in law.shoes)),
                "touching": touching(brake, response),
            }
        )
    return rows


def touching(brake: Brake, response: Response) -> float:
    """The part of all linings that touches."""
    arcs = sum(end - start for shoe in response.shoes for start, end in shoe.contact_arcs)
    return arcs / sum(shoe.lining.end - shoe.lining.start for shoe in brake.shoes)


SINGLE = (
    Column("misfit", "misfit"),
    Column("torque", "torque", "N m", 1, ".1f"),
    Column("from_fit", "from the lining that fits", "%", 100, "+.1f"),
    Column("from_law", "from the sine law", "%", 100, "+.1f"),
    Column("peak", "peak pressure", "MPa", 1e-6, ".3f"),
    Column("peak_from_law", "from the sine law", "%", 100, "+.0f"),
    Column("touching", "lining in contact", "%", 100, ".0f"),
)
SPREADS = (
    Column("quantity", "quantity"),
    Column("state", "state"),
    Column("mean", "mean", form=".4g"),
    Column("relative", "standard deviation", "%", 100, ".1f"),
    *(Column(f"p{k}", f"{k}th percentile" if k != 1 else "1st percentile", form=".4g") for k in PERCENTILES),
)
SHARES = (
    Column("name", "tolerance"),
    *(
        Column(f"{state}_{name}", f"{heading}, {state}", form=".3f")
        for state in ("new", "worn in")
        for name, heading in (
            ("torque", "torque"),
            ("brake_factor", "brake factor"),
            ("peak_pressure", "peak pressure"),
        )
    ),
)


def samples(result: Result, state: str, name: str) -> Floats:
    """The Monte Carlo draws of a quantity (2 n,): those of the independent samples A and B; pressures in MPa."""
    values = numbers(result.rows[state][: 2 * result.draws], name)
    return values * 1e-6 if name == "peak_pressure" else values


def spread_rows(result: Result) -> list[dict[str, Any]]:
    """Distributions as rows; the last ones: torque over that of the sine law for the same friction, force and pins."""
    values = {
        (QUANTITIES[name], state): samples(result, state, name)
        for name in QUANTITIES
        for state in ("new", "worn in", "law")
    }
    for state in ("new", "worn in"):
        values["torque over the sine law's of the same brake", state] = off_law(result, state)
    rows = []
    for (quantity, state), drawn in values.items():
        found = spread(drawn)
        row: dict[str, Any] = {"quantity": quantity, "state": state if state != "law" else "sine law"}
        row |= {"mean": found.mean, "deviation": found.deviation, "relative": found.relative}
        rows.append(row | {f"p{k}": value for k, value in zip(PERCENTILES, found.percentiles, strict=True)})
    return rows


def off_law(result: Result, state: str) -> Floats:
    """Torque of each drawn brake over the torque of the sine law for that very brake (2 n,)."""
    ratio: Floats = samples(result, state, "torque") / samples(result, "law", "torque")
    return ratio


def share_rows(result: Result) -> list[dict[str, Any]]:
    """Total Sobol indices as rows."""
    return [
        {"name": tolerance.name}
        | {
            f"{state}_{name}": found[name][i].total.value
            for state, found in result.shares.items()
            for name in QUANTITIES
        }
        for i, tolerance in enumerate(result.tolerances)
    ]


def report(result: Result, folder: Path) -> Path:
    """Write page, figures and tables; returns the page."""
    law, brake = result.law, result.brake
    um = [1e6 * side for side in result.sides]
    highest = 2.2 * max(shoe.peak_pressure for shoe in result.family[0.0].shoes)
    drawn = {
        "pressure": misfit_figures.family(
            [
                (
                    f"{'Leading' if shoe.self_energising else 'Trailing'} shoe",
                    {dr: response.shoes[i] for dr, response in result.family.items()},
                    shoe,
                )
                for i, shoe in enumerate(law.shoes)
            ],
            "radius of lining − drum",
            highest,
        ),
        "map": misfit_figures.maps(
            um[0],
            um[1],
            [
                misfit_figures.Map("Torque", result.ratios["torque"]),
                misfit_figures.Map("Peak pressure", result.ratios["peak_pressure"]),
            ],
            "radius of linings − radius of drum [µm]",
            "linings moved along the pin's radius [µm]",
        ),
        "turn": misfit_figures.turns(
            result.angles,
            [(f"{state.capitalize()} linings", series) for state, series in result.turns.items()],
            law.torque,
        ),
        "distribution": misfit_figures.histograms(
            [
                misfit_figures.Histogram(
                    label, samples(result, "new", name), samples(result, "worn in", name), nominal_of(result, name)
                )
                for name, label in QUANTITIES.items()
            ]
        ),
        "shares": misfit_figures.shares(
            [
                ("Torque, new", result.shares["new"]["torque"]),
                ("Torque, worn in", result.shares["worn in"]["torque"]),
                ("Peak pressure, new", result.shares["new"]["peak_pressure"]),
            ]
        ),
        "run_in": misfit_figures.narrowing(
            np.array(DISTANCES),
            [
                ("torque of the brake [N m]", result.healed["torque"], law.torque),
                ("peak pressure [MPa]", 1e-6 * result.healed["peak_pressure"], nominal_of(result, "peak_pressure")),
            ],
        ),
    }
    for name, figure in drawn.items():
        for ending in ("svg", "png") if name in {"distribution", "map"} else ("svg",):
            figures.save(figure, folder / f"{name}.{ending}")
    spreads, ranked = spread_rows(result), share_rows(result)
    for name, table in (("single", result.single), ("spread", spreads), ("shares", ranked)):
        write_text(folder / f"{name}.csv", as_csv(table))
    for state, rows in result.rows.items():
        several = cases(
            brake, result.tolerances, draw(result.tolerances, result.draws, SEED)[: len(rows) // result.draws]
        )
        sweep.write_table(sweep.table(several, rows), folder / f"cases_{state.replace(' ', '_')}.csv")
    page = folder / "index.html"
    write_page(page, "Linings that do not fit", lead(result), sections(result, spreads, ranked, folder))
    return page


def nominal_of(result: Result, name: str) -> float:
    """What the law says of the nominal brake, as `samples` has it."""
    law, shoes = result.law, result.brake.shoes
    force = sum(shoe.actuation.force for shoe in shoes) / len(shoes)
    return {
        "torque": law.torque,
        "brake_factor": law.torque / (force * result.brake.drum.radius),
        "peak_pressure": 1e-6 * max(shoe.peak_pressure for shoe in law.shoes),
    }[name]


def interval(values: Floats) -> str:
    """The 5th and 95th percentile of a ratio, as deviations."""
    low, high = np.percentile(values, (5, 95))
    return f"{low - 1:+.0%} to {high - 1:+.0%}"


def ranking(found: Sequence[Shares], most: int = 4) -> str:
    """The largest total shares, in words, with their confidence intervals."""
    first = sorted(found, key=lambda share: -share.total.value)[:most]
    return ", ".join(
        f"{share.name} ({share.total.value:.2f}; {share.total.low:.2f} to {share.total.high:.2f})" for share in first
    )


def lead(result: Result) -> str:
    """What was found."""
    new, worn = (spread(samples(result, state, "torque")) for state in ("new", "worn in"))
    law = spread(samples(result, "law", "torque"))
    return (
        "Fifty micrometres of misfit, the width of a hair, change the torque of a new double-shoe brake by "
        f"{min(r['from_fit'] for r in result.single[1:7]):+.0%} to {max(r['from_fit'] for r in result.single[1:7]):+.0%}. "
        f"Over all tolerances its torque spreads by {new.relative:.1%} (standard deviation), worn in by {worn.relative:.1%}, "
        f"by the sine law by {law.relative:.1%}. Largest shares of the new brake's variance: "
        f"{ranking(result.shares['new']['torque'])}."
    )


def fitting(result: Result) -> float:
    """The share of the torque's variance that run-in takes away: all but friction, force, levers and the drum."""
    new, worn = (spread(samples(result, state, "torque")).deviation for state in ("new", "worn in"))
    return 1 - (worn / new) ** 2


def assumptions(result: Result) -> str:
    """What the law's user has to assume, in numbers."""
    new, worn = off_law(result, "new"), off_law(result, "worn in")
    peaks = samples(result, "new", "peak_pressure") / nominal_of(result, "peak_pressure")
    ends = np.percentile(result.healed["torque"], (5, 50, 95), axis=0)
    off = np.abs(ends / ends[:, -1:] - 1).max(axis=0)
    by = next(s for k, s in enumerate(DISTANCES) if off[k:].max() < 0.02)
    return (
        "<b>New lining.</b> Even with the friction, force and levers that the brake really has, the sine law's "
        f"torque is off by {interval(1 / new)} from the elastic brake's (5th to 95th percentile), and the mean peak pressure is "
        f"{float(peaks.mean()):.1f} times the law's, {float(np.percentile(peaks, 95)):.1f} times at the 95th percentile. "
        f"<b>Worn in.</b> On a round drum the law is right for every fit; what remains on drums of up to 30 µm ovality is "
        f"{interval(1 / worn)}, over one turn. Run-in takes away {fitting(result):.0%} of the torque's variance. "
        "<b>When.</b> On round drums the 5th, 50th and 95th percentile of the torque are within 2 % of their final values "
        f"after a sliding distance of {by:g}/(k K), {by * result.unit / 1e3:.0f} km at k = 10<sup>−5</sup> mm³/(N m): until then the law's "
        "user must take the spread of a new lining; afterwards that of friction, force and levers alone, and of the drum."
    )


def sections(
    result: Result, spreads: list[dict[str, Any]], ranked: list[dict[str, Any]], folder: Path
) -> list[Section]:
    """The page."""
    turns = {
        state: {name: np.ptp(t) / np.mean(t) for name, t in series.items()} for state, series in result.turns.items()
    }
    said = "; ".join(
        f"{name} {turns['new'][name]:.0%} new, {turns['worn in'][name]:.0%} worn in" for name in turns["new"]
    )
    return [
        Section(
            "What the law's user has to assume",
            [
                Text(assumptions(result)),
                Figure(
                    folder / "distribution.svg",
                    f"{2 * result.draws} brakes drawn from the tolerances, new and worn in. Bars above: 5th, 50th and 95th "
                    "percentile. The brake factor is free of the force's own spread.",
                ),
            ],
        ),
        Section(
            "One misfit at a time",
            [
                Text(
                    "A lining is compressed by some 10 µm when the brake is on: a misfit of that size decides where it bears. A "
                    "larger lining bears at its ends, a smaller one in its middle. Near the pin a pressure has little lever against "
                    "the force, so that much of it is borne there before the shoe is in balance: what moves the contact towards the "
                    "pin raises torque and peak pressure; what moves it away lowers the torque, by far less. To first order a mismatch dR opens the gap by −dR (1 − cos), and a move of the lining across the pin's "
                    "radius does nothing, for the shoe's turn takes it back; only a move along it counts."
                ),
                Table(
                    result.single,
                    SINGLE,
                    "Both shoes alike. Peak pressure: away from the lining's ends by half its thickness; between blocks it is that "
                    "of an edge, rounded over 1 deg.",
                ),
                Figure(
                    folder / "pressure.svg",
                    "Pressure for linings ground to another radius than the drum's; cut at the top.",
                ),
                Figure(
                    folder / "map.svg",
                    "Torque and peak pressure over both misfits. The thick line is where the brake does what the sine law says: "
                    "no fit, but one of many misfits.",
                ),
            ],
        ),
        Section(
            "One turn of a drum that is not round",
            [
                Figure(
                    folder / "turn.svg",
                    f"Torque as the drum turns, lobes of {LOBES * 1e6:.0f} µm amplitude; steady forces, no inertia.",
                ),
                Text(
                    f"Peak to valley over the mean: {said}. The torque has the period of the lobes, not their shape: a lining that "
                    "loses contact is no linear spring. Run-in does not heal this, for the lobes turn. Worn in means here: to a "
                    "round drum's sine law; the slope of the lobes, at most n a/(µR) of the torque "
                    f"({5 * LOBES / (result.brake.friction * result.brake.drum.radius):.1%} for five), is left out."
                ),
            ],
        ),
        Section(
            "Which tolerance matters",
            [
                Figure(
                    folder / "shares.svg",
                    "Sobol indices: the part of the variance that a tolerance makes alone, and with all that it does "
                    "together with others; whiskers: 95 % confidence.",
                ),
                Text(
                    f"Torque, new: {ranking(result.shares['new']['torque'])}. Torque, worn in: "
                    f"{ranking(result.shares['worn in']['torque'])}. Peak pressure, new: "
                    f"{ranking(result.shares['new']['peak_pressure'])}. (Total index; 95 % interval.) First-order indices of the "
                    f"new brake's torque sum to {sum(s.first.value for s in result.shares['new']['torque']):.2f}: the rest is "
                    "made by tolerances together."
                ),
                Table(ranked, SHARES, "Total Sobol indices."),
                Table(spreads, SPREADS, "Distributions. Pressures in MPa, torques in N m."),
                Text(
                    f"{len(result.rows['new'])} new and as many worn-in brakes, each solved by finite elements, none by a "
                    "surrogate; draws and estimators of Saltelli et al. (2010) by scipy. Limits are two standard deviations of a "
                    "normal distribution that is cut there; all limits are assumptions, in <code>studies/misfit/study.py</code>. "
                    "Misfit across the width (coning, bell-mouthing) is none of a plane model. Every case: "
                    "<code>cases_new.csv</code>, <code>cases_worn_in.csv</code>."
                ),
            ],
        ),
        Section(
            "How run-in heals misfit",
            [
                Figure(
                    folder / "run_in.svg",
                    f"{len(result.healed['torque'])} of the brakes on round drums, worn by Archard's law dh/ds = k p, K = E/t; "
                    f"1/(k K) is {result.unit / 1e3:.2g} km at k = 10⁻⁵ mm³/(N m).",
                ),
                Text(
                    "Wear ends where all points of the lining wear as the shoe turns, p ~ sin φ, whatever the lining began with. "
                    "What is left of the spread is that of the law: friction, force and levers."
                ),
                Text(
                    f"Computing for this page took {result.seconds:.0f} s; cases that a stopped run had finished are not counted."
                ),
            ],
        ),
    ]
