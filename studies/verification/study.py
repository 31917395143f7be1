"""How fast do the finite elements converge, and can their error estimate be believed?"""

import math
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from drumlin.brake.file import read_brake, vary
from drumlin.comparison import as_csv
from drumlin.fem.mesh.arc import KINDS
from drumlin.fem.solve import solve
from drumlin.files import write_text
from drumlin.report import figures
from drumlin.report.page import fill
from drumlin.verification.orders import distance, estimate_row, order_rows

HERE = Path(__file__).parent
BRAKE = HERE.parent / "double_shoe" / "brake.toml"
CASES: dict[str, dict[str, Any]] = {
    "whole lining in contact": {},
    "partial contact": {"shoe.lining.clearance": 1e-4},
}


class Result(NamedTuple):
    """Errors over the meshes of every kind, and estimates against true errors."""

    orders: list[dict[str, Any]]
    estimates: list[dict[str, Any]]
    floor: dict[str, float]
    seconds: float


def study(*, short: bool = False, say: Callable[[str], None] = lambda _: None) -> Result:
    """Errors of p (L2) and of the torque against a far finer mesh; `short`: coarser all over."""
    start = time.perf_counter()
    sizes, fine, other = ((10, 20, 40), 120, 80) if short else ((20, 40, 80, 160), 640, 400)
    tolerances = (1e-2, 3e-3) if short else (1e-2, 3e-3, 1e-3, 3e-4)
    orders, estimates, floor = [], [], {}
    for case, changes in CASES.items():
        brake = vary(read_brake(BRAKE), changes)
        say(f"{case}: reference")
        reference = solve(brake, elements=fine, penalty=math.inf)
        # another kind of mesh as a second opinion: below their distance nothing is claimed
        floor[case] = distance(solve(brake, elements=other, kind="tri2", penalty=math.inf), reference)
        for kind in KINDS:
            say(f"{case}: {kind}")
            orders += order_rows(brake, case, kind, sizes, reference)
        for tolerance in tolerances:
            say(f"{case}: tolerance {tolerance:g}")
            estimates.append(estimate_row(brake, case, tolerance, reference, floor[case]))
    return Result(orders, estimates, floor, time.perf_counter() - start)


def report(result: Result, folder: Path) -> Path:
    """Write page, figures and CSV; returns the page."""
    for i, case in enumerate(CASES):
        series = {
            kind: [(r["elements"], r["pressure"]) for r in result.orders if (r["case"], r["kind"]) == (case, kind)]
            for kind in KINDS
        }
        figures.save(figures.convergence(series, "error of p in L2"), folder / f"orders_{i + 1}.svg")
    write_text(folder / "orders.csv", as_csv(result.orders))
    write_text(folder / "estimates.csv", as_csv(result.estimates))
    return fill(HERE / "page.html", folder / "index.html", result=result, cases=list(CASES))
