"""How fast do the finite elements converge, can their stated error be believed, and what is right
beyond doubt?
"""

import math
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from drumlin.base.errors import NoAnswer
from drumlin.base.files import write_text
from drumlin.base.journal import Journal
from drumlin.brake.brake import Brake
from drumlin.brake.file import read_brake, vary
from drumlin.comparison import as_csv
from drumlin.fem.mesh.arc import MESH_KINDS
from drumlin.fem.solve import solve
from drumlin.report import figures
from drumlin.report.page import fill
from drumlin_studies import corner_rows, ladder, stated_true_figure
from drumlin_studies.orders import distance, estimate_row, level_rows, line, order_rows
from drumlin_studies.random_brake import random_brake
from drumlin_studies.random_kinds import HOLDING_KINDS as KINDS_OF_HOLDING
from drumlin_studies.random_kinds import random_kind
from drumlin_studies.side_by_side import PROCESSES, Case, kept
from drumlin_studies.stated_true import JUDGED_TOLERANCES, by_columns, by_triangles, row, summary
from drumlin_studies.stated_true_figure import cloud

HERE = Path(__file__).parent
BRAKE = HERE.parent / "double_shoe" / "brake.toml"
CASES: dict[str, dict[str, Any]] = {
    "whole lining in contact": {},
    "partial contact": {"shoe.lining.clearance": 1e-4},
}


JUDGED, BRAKES, FEW = 600_000, 500, 3
"""First seed of the random brakes that are judged, their number, and that of the short setting. No
factor of the estimate, level or rule was found on them.
"""
CORNERS = 40
"""Brakes that press with a corner or under a tip: four of each kind."""
TENTH, THIRD = 10, 3  # of the seeds: with triangles as truth, to the last tolerance too


class Result(NamedTuple):
    """Errors over meshes of every kind, stated against true errors, random brakes, those that press
    with corners or under tips, and cases with known answers.
    """

    orders: list[dict[str, Any]]
    levels: list[dict[str, Any]]
    estimates: list[dict[str, Any]]
    judged: list[dict[str, Any]]
    corners: list[dict[str, Any]]
    floor: dict[str, float]
    ladder: list[dict[str, Any]]
    seconds: float


def study(
    *,
    short: bool = False,
    say: Callable[[str], None] = lambda _: None,
    journal: Journal | None = None,
) -> Result:
    """Errors of p (L2) and of the torque against a far finer mesh; `short`: coarser all over."""
    start = time.perf_counter()
    journal = journal or Journal()
    sizes, fine, other = ((10, 20, 40), 120, 80) if short else ((20, 40, 80, 160), 640, 400)
    tolerances = (1e-2, 3e-3) if short else (1e-2, 3e-3, 1e-3, 3e-4)
    orders, estimates, floor = [], [], {}
    for case, changes in CASES.items():
        brake = vary(read_brake(BRAKE), changes)
        say(f"{case}: reference")
        reference = solve(brake, elements=fine, penalty=math.inf)
        # another kind of mesh as a second opinion: below their distance nothing is claimed
        floor[case] = distance(
            solve(brake, elements=other, kind="tri2", penalty=math.inf), reference
        )
        for kind in MESH_KINDS:
            say(f"{case}: {kind}")
            orders += order_rows(brake, case, kind, sizes, reference)
        for tolerance in tolerances:
            say(f"{case}: tolerance {tolerance:g}")
            estimates.append(estimate_row(brake, case, tolerance, reference, floor[case]))
    say("columns, level by level")
    levels = level_rows(read_brake(BRAKE))
    processes = 0 if short else PROCESSES
    cases = [
        {"seed": seed, "tolerances": _tolerances(seed, short=short)}
        for seed in _seeds(JUDGED, BRAKES, short)
    ]
    say("random brakes")
    judged = [
        one for found in kept(cases, _judged, journal, say, processes) for one in found["rows"]
    ]
    count = 1 if short else CORNERS
    cases = [{"corner": corner_rows.FIRST_CORNER + k} for k in range(count)]
    say("random corners and tips")
    corners = [
        one for found in kept(cases, _cornered, journal, say, processes) for one in found["rows"]
    ]
    say("benchmark ladder")
    known = [ladder.row(case) for case in ladder.LADDER_CASES]
    return Result(
        orders, levels, estimates, judged, corners, floor, known, time.perf_counter() - start
    )


def _seeds(first: int, count: int, short: bool) -> range:
    return range(first, first + (FEW if short else count))


def _tolerances(seed: int, *, short: bool) -> list[float]:
    return list(
        JUDGED_TOLERANCES[:1]
        if short
        else JUDGED_TOLERANCES
        if seed % THIRD == 0
        else JUDGED_TOLERANCES[:-1]
    )


def _cornered(case: Case) -> dict[str, Any]:
    return {"rows": corner_rows.rows(case["corner"])}


def _drawn(seed: int) -> Brake:
    """A hinged brake of any shape, or, of odd seeds, one of any way to hold and push shoes on a
    drum.
    """
    ways = [way for way in KINDS_OF_HOLDING if not way.startswith("pad")]
    brake = random_kind(seed, ways[seed // 2 % len(ways)]) if seed % 2 else random_brake(seed)
    return brake


def _judged(case: Case) -> dict[str, Any]:
    """Stated against true errors of a random brake, one row a tolerance."""
    seed, tolerances = case["seed"], case["tolerances"]
    brake, failure, true = _drawn(seed), "", None
    triangular = seed // 2 % TENTH == 0
    try:
        true = by_triangles(brake) if triangular else by_columns(brake, tolerances[-1])
    except NoAnswer as error:
        failure = str(error)
    base = {"seed": seed, "truth": "triangles" if triangular else "columns"}
    return {
        "rows": [base | row(brake, tolerance, solve, true, failure) for tolerance in tolerances]
    }


def report(result: Result, folder: Path) -> Path:
    """Write page, figures and CSV; returns the page."""
    for i, case in enumerate(CASES):
        series = {
            kind: [
                (r["elements"], r["pressure"])
                for r in result.orders
                if (r["case"], r["kind"]) == (case, kind)
            ]
            for kind in MESH_KINDS
        }
        figures.save(
            figures.convergence(series, "error of p in L2"), folder / f"orders_{i + 1}.svg"
        )
    figures.save(cloud(result.judged), folder / "stated_true.svg")
    write_text(folder / "stated_true.csv", as_csv(result.judged))
    write_text(folder / "corners.csv", as_csv(result.corners))
    figures.save(stated_true_figure.levels(result.levels), folder / "levels.svg")
    write_text(folder / "levels.csv", as_csv(result.levels))
    write_text(folder / "orders.csv", as_csv(result.orders))
    write_text(folder / "estimates.csv", as_csv(result.estimates))
    write_text(folder / "ladder.csv", as_csv(result.ladder))
    return fill(
        HERE / "page.html",
        folder / "index.html",
        result=result,
        cases=list(CASES),
        judged=summary(result.judged),
        corners=corner_rows.by_kind(result.corners),
        steep=corner_rows.STEEPEST_JUDGED,
        independent=summary([one for one in result.judged if one["truth"] == "triangles"]),
        families=len(ladder.families()),
        line=line(result.levels),
    )
