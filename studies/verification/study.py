"""How fast do the finite elements converge, and can their error estimate be believed?"""

import math
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from drumlin.brake.drum_brake import Brake
from drumlin.brake.file import read_brake, vary
from drumlin.comparison import Column, as_csv
from drumlin.errors import NoAnswer
from drumlin.fem.mesh.arc import KINDS
from drumlin.fem.solve import solve
from drumlin.files import write_text
from drumlin.report import figures
from drumlin.report.page import Figure, Section, Table, Text, write_page
from drumlin.response.norms import pressure_distance, relative
from drumlin.response.response import Response

BRAKE = Path(__file__).parents[1] / "double_shoe" / "brake.toml"
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


def distance(response: Response, reference: Response) -> float:
    """The larger of both shoes' relative L2 distances of p, outside the edge zones."""
    return max(pressure_distance(a, b) for a, b in zip(response.shoes, reference.shoes, strict=True))


def order_rows(brake: Brake, case: str, kind: str, sizes: tuple[int, ...], reference: Response) -> list[dict[str, Any]]:
    """Errors on meshes that double, with the observed orders between each and the one before."""
    rows: list[dict[str, Any]] = []
    for n in sizes:
        response = solve(brake, elements=n, kind=kind, penalty=math.inf)
        row = {
            "case": case,
            "kind": kind,
            "elements": n,
            "pressure": distance(response, reference),
            "torque": abs(relative(response.torque, reference.torque)),
            "steps": response.iterations,
        }
        if rows:
            row["order"] = math.log(rows[-1]["pressure"] / row["pressure"]) / math.log(n / rows[-1]["elements"])
        rows.append(row)
    return rows


def estimate_row(brake: Brake, case: str, tolerance: float, reference: Response, floor: float) -> dict[str, Any]:
    """What was asked for, what was estimated, what is true as far as the reference knows, and the time of it."""
    start = time.perf_counter()
    row: dict[str, Any] = {"case": case, "tolerance": tolerance}
    try:
        response = solve(brake, tolerance=tolerance, penalty=math.inf)
    except NoAnswer as error:
        return {**row, "seconds": time.perf_counter() - start, "status": f"failed: {error}"}
    seconds = time.perf_counter() - start
    assert response.error is not None  # a tolerance was asked for
    true = distance(response, reference)
    return {
        **row,
        "estimate": response.error["pressure"],
        "true": true,
        "ratio": response.error["pressure"] / true,
        "torque_estimate": response.error["torque"],
        "torque_true": abs(relative(response.torque, reference.torque)),
        "seconds": seconds,
        "status": "converged" if true > floor else "converged; truth below what the reference knows",
    }


ORDERS = (
    Column("case", "case"),
    Column("kind", "kind"),
    Column("elements", "elements along the lining", form="d"),
    Column("pressure", "error of p (L2)", "%", 100, ".3g"),
    Column("order", "observed order of p", form=".2f"),
    Column("torque", "error of torque", "%", 100, ".2g"),
    Column("steps", "active-set steps", form="d"),
)
ESTIMATES = (
    Column("case", "case"),
    Column("tolerance", "asked for", "%", 100, ".2g"),
    Column("estimate", "estimated error of p", "%", 100, ".2g"),
    Column("true", "true error of p", "%", 100, ".2g"),
    Column("ratio", "estimate over truth", form=".1f"),
    Column("torque_estimate", "estimated error of torque", "%", 100, ".1e"),
    Column("torque_true", "true error of torque", "%", 100, ".1e"),
    Column("seconds", "time", "ms", 1e3, ".0f"),
    Column("status", "status"),
)


def report(result: Result, folder: Path) -> Path:
    """Write page, figures and CSV; returns the page."""
    blocks: list[Any] = []
    for i, case in enumerate(CASES):
        series = {
            kind: [(r["elements"], r["pressure"]) for r in result.orders if (r["case"], r["kind"]) == (case, kind)]
            for kind in KINDS
        }
        path = figures.save(figures.convergence(series, "error of p in L2"), folder / f"orders_{i + 1}.svg")
        blocks.append(
            Figure(path, f"{case.capitalize()}: error of p over the elements along the lining, four kinds of mesh.")
        )
    floors = "; ".join(f"{case}: {floor:.1e}" for case, floor in result.floor.items())
    write_text(folder / "orders.csv", as_csv(result.orders))
    write_text(folder / "estimates.csv", as_csv(result.estimates))
    page = folder / "index.html"
    write_page(
        page,
        "Convergence of the finite elements",
        "Errors of the contact pressure on meshes of four kinds, and the estimated error against the true one.",
        [
            Section(
                "Observed orders",
                [
                    Text(
                        "Reference: quadratic quadrilaterals, far finer. Its distance from a fine mesh of quadratic triangles "
                        f"is the floor below which nothing is claimed ({floors}). Errors are relative L2 norms of p, the larger of "
                        "both shoes, outside 0.2 deg at the lining's ends. Published rates on a curved contact are 0.5 for "
                        "linear quadrilaterals, 1.0 for quadratic ones with local averages of the pressure and 2.5 for quadratic "
                        "ones with a continuous pressure, which is what drumlin uses; a contact end inside the lining, where p "
                        "goes as the root of the distance, bounds every order by 1 on meshes that are not refined towards it."
                    ),
                    *blocks,
                    Table(result.orders, ORDERS, "Meshes that double, exact contact."),
                ],
            ),
            Section(
                "Estimated and true error",
                [
                    Text(
                        "With a tolerance drumlin refines towards the lining's ends and the ends of the contact until the estimate "
                        "of the error of p and of the torque is below it. The estimate extrapolates the distances between "
                        "successive meshes; it should be above the truth, and not far above."
                    ),
                    Table(result.estimates, ESTIMATES, "Cold solves of both shoes, all meshes of each counted."),
                ],
            ),
            Section("What it cost", [Text(f"All computing for this page took {result.seconds:.0f} s.")]),
        ],
    )
    return page
