"""How far is the sine law from the elastic truth? The double-shoe brake, stiff and flexible, both rotations."""

import math
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from drumlin.brake.drum_brake import Brake
from drumlin.brake.file import read_brake, vary
from drumlin.comparison import COLUMNS, Column, Comparison, Convergence, as_csv, compare, converge
from drumlin.fem.solve import solve
from drumlin.files import write_text
from drumlin.laws import sine
from drumlin.report import figures
from drumlin.report.comparison import field_picture, panels, results_json
from drumlin.report.page import Figure, Section, Source, Table, Text, write_page
from drumlin.response.norms import relative
from drumlin.response.response import ShoeResponse
from drumlin.verification.cost import Cost, cost

HERE = Path(__file__).parent
ROTATIONS = ("counter-clockwise", "clockwise")
RIGID = {"shoe.body.material.E": 2.1e15, "shoe.lining.thickness": 3e-3}  # E x 10^4, lining of R/50


class Result(NamedTuple):
    """Everything that the report shows."""

    comparisons: list[Comparison]
    limit: list[dict[str, Any]]
    convergence: Convergence
    cost: Cost
    elements: int
    seconds: float


def study(*, short: bool = False, say: Callable[[str], None] = lambda _: None) -> Result:
    """Compare, take the limit of a rigid shoe, converge, and count the cost; `short`: coarser, fewer repeats."""
    start = time.perf_counter()
    elements, repeats = (40, 1) if short else (160, 5)
    comparisons = []
    for file, case in (("brake.toml", "stiff shoes"), ("flexible.toml", "flexible shoes")):
        brake = read_brake(HERE / file)
        for rotation in ROTATIONS:
            say(f"{case}, {rotation}")
            turning = vary(brake, {"rotation": rotation})
            comparisons.append(compare(turning, case, repeats, ("fem", "sine"), elements=elements))
    brake = comparisons[0].brake
    say("limit of a rigid shoe")
    limit = [row for rotation in ROTATIONS for row in rigid_limit(vary(brake, {"rotation": rotation}), elements)]
    say("convergence")
    convergence = converge(brake, (10, 20, 40) if short else (20, 40, 80, 160, 320))
    say("cost")
    return Result(
        comparisons, limit, convergence, cost(brake, repeats=1 if short else 7), elements, time.perf_counter() - start
    )


def rigid_limit(brake: Brake, elements: int) -> list[dict[str, Any]]:
    """Sine law against finite elements with a nearly rigid shoe and a thin lining: torque, and p / sin(phi)."""
    rigid = vary(brake, RIGID)
    law, fem = sine(rigid), solve(rigid, elements=elements)
    rows: list[dict[str, Any]] = []
    for spec, a, b in zip(rigid.shoes, law.shoes, fem.shoes, strict=True):
        edge = 5 * spec.lining.thickness / rigid.drum.radius
        ratio = amplitude(spec.frame.phi(b.theta), b, edge)
        rows.append(
            {
                "rotation": brake.rotation,
                "shoe": spec.name,
                "law": a.torque,
                "fem": b.torque,
                "difference": relative(b.torque, a.torque),
                "spread": float(np.ptp(ratio) / np.mean(ratio)),
            }
        )
    rows.append(
        {"rotation": brake.rotation, "shoe": "all", "law": law.torque, "fem": fem.torque,
         "difference": relative(fem.torque, law.torque)}
    )  # fmt: skip
    return rows


def amplitude(phi: Any, shoe: ShoeResponse, edge: float) -> Any:
    """p / sin(phi) at the nodes farther than `edge` [rad] from the ends."""
    inside = (phi > phi.min() + edge) & (phi < phi.max() - edge)
    return shoe.pressure[inside] / np.sin(phi[inside])


LIMIT = (
    Column("rotation", "drum turns"),
    Column("shoe", "shoe"),
    Column("law", "torque, sine law", "N m", 1, ".6g"),
    Column("fem", "torque, finite elements", "N m", 1, ".6g"),
    Column("difference", "difference", "%", 100, "+.3f"),
    Column("spread", "spread of p/sin φ (max − min)", "%", 100, ".2f"),
)
MESHES = (
    Column("elements", "elements along the lining", form="d"),
    Column("unknowns_torque", "torque", "N m", 1, ".7f"),
    Column("torque_error", "distance of torque from limit", "", 1, "+.1e"),
    Column("right", "step of p to next finer mesh, right (L2)", "", 1, ".1e"),
    Column("left", "step of p to next finer mesh, left (L2)", "", 1, ".1e"),
    Column("steps", "active-set steps", form="d"),
)


def mesh_rows(convergence: Convergence) -> list[dict[str, Any]]:
    """The convergence study as rows."""
    limit = convergence.torque.value
    steps = [convergence.pressure_steps(i) for i in range(2)]
    return [
        {
            "elements": n,
            "unknowns_torque": response.torque,
            "torque_error": relative(response.torque, limit),
            "right": steps[0][k] if k < len(steps[0]) else None,
            "left": steps[1][k] if k < len(steps[1]) else None,
            "steps": response.iterations,
        }
        for k, (n, response) in enumerate(zip(convergence.elements, convergence.responses, strict=True))
    ]


def report(result: Result, folder: Path) -> Path:
    """Write page, figures, fields, CSV and JSON; returns the page."""
    table = [row for comparison in result.comparisons for row in comparison.rows]
    main = [panel for comparison in result.comparisons[:2] for panel in panels(comparison)]
    flexible = [panel for comparison in result.comparisons[2:] for panel in panels(comparison)]
    for ending in ("svg", "png"):
        figures.save(figures.pressures(main), folder / f"pressure.{ending}")
    figures.save(figures.pressures(flexible), folder / "pressure_flexible.svg")
    convergence = result.convergence
    steps = {
        f"p, {name} shoe (L2, to the next finer mesh)": list(
            zip(convergence.elements, convergence.pressure_steps(i), strict=False)
        )
        for i, name in enumerate(("right", "left"))
    }
    limit = convergence.torque
    steps["torque, from its limit"] = [
        (n, abs(relative(r.torque, limit.value)))
        for n, r in zip(convergence.elements, convergence.responses, strict=True)
    ]
    figures.save(figures.convergence(steps, "relative distance"), folder / "convergence.svg")
    brake = result.comparisons[0].brake
    response = result.comparisons[0].responses["fem"]
    picture = field_picture(brake, response, folder, "fields", elements=result.elements)
    write_text(folder / "results.csv", as_csv(table))
    extra = {
        "rigid_limit": result.limit,
        "convergence": mesh_rows(convergence),
        "torque_limit": limit._asdict(),
        "cost": result.cost._asdict(),
    }
    write_text(folder / "results.json", results_json(result.comparisons, **extra))
    page = folder / "index.html"
    write_page(page, "The sine law against the elastic brake", lead(table), sections(result, table, picture, folder))
    return page


def lead(table: list[dict[str, Any]]) -> str:
    """What was found, in one sentence."""
    errors = {(row["case"], row["shoe"]): row["torque_error"] for row in table if row["model"] == "sine"}
    said = [f"{errors[case, 'all']:+.1%} for {case}" for case in ("stiff shoes", "flexible shoes")]
    return (
        "Internal double-shoe brake, default parameters of the Simscape block. The sine law misses the torque of "
        f"the brake by {' and by '.join(said)}; single shoes, peak pressure and hinge reactions by far more."
    )


def sections(result: Result, table: list[dict[str, Any]], picture: Figure | Text, folder: Path) -> list[Section]:
    """The page."""
    limit, c = result.convergence.torque, result.cost
    orders = [result.convergence.pressure(i) for i in range(2)]
    return [
        Section(
            "Pressure on the linings",
            [
                Figure(folder / "pressure.svg", "Stiff shoes. Law and finite elements carry the same actuation force."),
                Text(
                    "The law takes the shoe as rigid: the lining is pressed as the shoe turns, p ~ sin φ from the hinge. "
                    "The elastic shoe bends, and friction decides where it leans: the shoe whose friction assists (dragged "
                    "towards its hinge) bears at both ends, the other one mostly at its loaded end. Where the drum runs "
                    "onto the lining's sharp edge the elastic pressure has no bound; the curve is cut there."
                ),
                Figure(folder / "pressure_flexible.svg", "Flexible shoes: the same brake with shoes 12 mm thick."),
            ],
        ),
        Section(
            "Numbers",
            [
                Table(
                    table,
                    COLUMNS,
                    "Errors are those of the law against the finite elements. Peak pressure: away from the lining's ends "
                    "by half its thickness. p in L2 over the lining without 0.2 deg at each end. Run time of the whole "
                    "brake: median of the repeats, bodies meshed and condensed anew each time.",
                ),
                Text("Every number of this page: <code>results.csv</code> and <code>results.json</code> beside it."),
            ],
        ),
        Section("Inside the shoes", [picture]),
        Section(
            "Can the finite elements be trusted?",
            [
                Text(
                    "<b>Rigid limit.</b> With the shoe's modulus 10<sup>4</sup> times higher and a lining of 3 mm the finite "
                    "elements must return to the sine law: torque within 0.3 %, p/sin φ constant within 1 % away from the "
                    "edges (five lining thicknesses). A still thinner lining would be stiffer against the shoe, and the shoe "
                    "would bend again; a thicker one slides in shear before it presses."
                ),
                Table(result.limit, LIMIT, "Sine law and finite elements in the limit where both must agree."),
                Text(
                    f"<b>Convergence.</b> Exact contact on meshes that double. Torque: observed order {limit.order:.1f}, "
                    f"extrapolated {limit.value:.6f} N m with an uncertainty of {limit.uncertainty:.1e} N m. Pressure in L2 "
                    f"outside 0.2 deg at the ends: observed order {orders[0][0]:.1f} (right) and {orders[1][0]:.1f} (left), "
                    f"estimated error of the finest mesh {orders[0][1]:.1e} and {orders[1][1]:.1e}."
                ),
                Figure(
                    folder / "convergence.svg", "Distances between successive meshes, and of the torque from its limit."
                ),
                Table(mesh_rows(result.convergence), MESHES, "Meshes that double; distances are relative."),
                Text(
                    "<b>Balance.</b> Actuation, contact and hinge reaction of every shoe, the reaction taken from the "
                    "elimination and not from the balance itself: relative residual at most "
                    f"{largest_residual(result):.0e}."
                ),
            ],
        ),
        Section(
            "What it costs",
            [
                Text(
                    f"At {c.unknowns} unknowns the whole solve of the brake takes {c.solve * 1e3:.0f} ms, {c.solve_ratio:.2f} "
                    "times one assembly, one sparse factorisation and one substitution measured in the same run "
                    f"({c.assembly * 1e3:.0f} + {c.factorisation * 1e3:.0f} + {c.substitution * 1e3:.1f} ms); a further "
                    f"friction coefficient on the same bodies takes {c.further * 1e3:.1f} ms, 1/{1 / c.further_ratio:.0f} of "
                    f"the first. All computing for this page took {result.seconds:.0f} s."
                ),
                Source("left out", "\n".join(result.comparisons[0].responses["fem"].left_out)),
            ],
        ),
        Section(
            "The brakes",
            [
                Source(f"studies/double_shoe/{name}", (HERE / name).read_text())
                for name in ("brake.toml", "flexible.toml")
            ],
        ),
    ]


def largest_residual(result: Result) -> float:
    """The largest relative force or moment residual of all finite-element responses."""
    responses = [c.responses["fem"] for c in result.comparisons]
    return max(max(r.balance.force, r.balance.moment) for r in responses if not math.isnan(r.balance.force))
