"""How fast finite elements converge, whether stated errors are true, and known answers."""

import math
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

from drumlin.base.errors import NoAnswer
from drumlin.base.files import write_text
from drumlin.base.journal import JournalOfCaseResults
from drumlin.brake.brake import Brake
from drumlin.brake.file import read_brake, vary
from drumlin.comparison import table_as_csv_text
from drumlin.fem.mesh.arc import MESH_KINDS
from drumlin.fem.solve import solve
from drumlin.report import figures
from drumlin.report.page import write_html_page
from drumlin_studies import corner_rows, ladder, stated_true_figure
from drumlin_studies.orders import (
    convergence_order_rows_of_meshes,
    error_rows_of_hp_levels,
    estimated_and_true_error_row,
    fit_line_to_log_errors,
    largest_pressure_distance_of_shoes,
)
from drumlin_studies.random_brake import draw_random_brake
from drumlin_studies.random_kinds import (
    FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SUPPORT_KIND as KINDS_OF_HOLDING,
)
from drumlin_studies.random_kinds import draw_random_brake_of_support_kind
from drumlin_studies.side_by_side import (
    NUMBER_OF_PROCESSES_OF_STUDY,
    ComputationInput,
    compute_cases_in_parallel_with_journal,
)
from drumlin_studies.stated_true import (
    JUDGED_TOLERANCES,
    row_of_stated_and_true_errors,
    solve_fine_reference_by_hp_elements,
    solve_fine_reference_by_triangles,
    summary_rows_of_stated_errors,
)
from drumlin_studies.stated_true_figure import plot_stated_over_true_errors
from drumlin_studies.tables import rows_with_given_values

HERE = Path(__file__).parent
BRAKE = HERE.parent / "double_shoe" / "brake.toml"
CASES: dict[str, dict[str, Any]] = {
    "whole lining in contact": {},
    "partial contact": {"shoe.lining.clearance": 1e-4},
}
"""Changes of the double-shoe brake for each case, by name."""
JUDGED, BRAKES, FEW = 700_000, 500, 3
"""First seed of the random brakes, their number, and their number in a trial run (--short).

No factor, level or rule of the error estimate was found on these brakes.
"""
CORNERS = 40
"""Number of brakes that press with a corner or under a tip, four of each kind."""
TENTH, THIRD = 10, 3
"""Which random brakes are treated differently from the rest.

For every TENTH brake the true answer comes from triangles instead of hp elements. Every THIRD brake
is also solved to the last, smallest tolerance.
"""


class Result(NamedTuple):
    """All results that the report of this study shows, as rows of tables.

    Attributes
    ----------
    orders : list of dict
        Errors on meshes of each kind.
    levels : list of dict
        Errors of hp elements level by level.
    estimates : list of dict
        Stated and true errors of the double-shoe brake.
    judged, corners : list of dict
        Stated and true errors of random brakes, and of brakes that press with corners or tips.
    floor : dict
        Uncertainty of the reference, by case.
    ladder : list of dict
        Cases with known answers.
    seconds : float
        Run time of the study [s].
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
    journal: JournalOfCaseResults | None = None,
) -> Result:
    """Compute all tables.

    short : trial run with coarser meshes and fewer brakes.
    """
    start = time.perf_counter()
    journal = journal or JournalOfCaseResults()
    sizes, fine, other = ((10, 20, 40), 120, 80) if short else ((20, 40, 80, 160), 640, 400)
    tolerances = (1e-2, 3e-3) if short else (1e-2, 3e-3, 1e-3, 3e-4)
    orders, estimates, floor = [], [], {}
    for case, changes in CASES.items():
        brake = vary(read_brake(BRAKE), changes)
        say(f"{case}: reference")
        reference = solve(brake, elements=fine, penalty=math.inf)
        # A mesh of another kind gives a second reference. No error below their distance is claimed.
        second = solve(brake, elements=other, kind="tri2", penalty=math.inf)
        floor[case] = largest_pressure_distance_of_shoes(second, reference)
        for kind in MESH_KINDS:
            say(f"{case}: {kind}")
            orders += convergence_order_rows_of_meshes(brake, case, kind, sizes, reference)
        for tolerance in tolerances:
            say(f"{case}: tolerance {tolerance:g}")
            estimates.append(
                estimated_and_true_error_row(brake, case, tolerance, reference, floor[case])
            )
    # Errors of hp elements over the number of unknowns.
    say("columns, level by level")
    levels = error_rows_of_hp_levels(read_brake(BRAKE))
    # Random brakes: each is solved to its tolerances and compared with its truth.
    processes = 0 if short else NUMBER_OF_PROCESSES_OF_STUDY
    cases = []
    for seed in _seeds_of_setting(JUDGED, BRAKES, short):
        cases.append({"seed": seed, "tolerances": _tolerances_of_seed(seed, short=short)})
    say("random brakes")
    judged: list[dict[str, Any]] = []
    for found in compute_cases_in_parallel_with_journal(
        cases, _stated_and_true_rows, journal, say, processes
    ):
        judged += found["rows"]
    # Brakes that press with a corner or under a tip, where p may be unbounded.
    count = 1 if short else CORNERS
    cases = []
    for k in range(count):
        cases.append({"corner": corner_rows.SEED_OF_FIRST_CORNER_BRAKE + k})
    say("random corners and tips")
    corners: list[dict[str, Any]] = []
    for found in compute_cases_in_parallel_with_journal(
        cases, _corner_case_rows, journal, say, processes
    ):
        corners += found["rows"]
    # Problems whose answer is known from a formula or a source.
    say("benchmark ladder")
    known = list(map(ladder.run_known_answer_case_and_return_row, ladder.ALL_KNOWN_ANSWER_CASES))
    return Result(
        orders, levels, estimates, judged, corners, floor, known, time.perf_counter() - start
    )


def _seeds_of_setting(first: int, count: int, short: bool) -> range:
    """Seeds from the first one on: `count` of them, or FEW in the short setting."""
    return range(first, first + (FEW if short else count))


def _tolerances_of_seed(seed: int, *, short: bool) -> list[float]:
    """The tolerances to which the brake of a seed is solved."""
    if short:
        return list(JUDGED_TOLERANCES[:1])
    return list(JUDGED_TOLERANCES if seed % THIRD == 0 else JUDGED_TOLERANCES[:-1])


def _corner_case_rows(case: ComputationInput) -> dict[str, Any]:
    """Stated and true errors of a brake that presses with a corner or under a tip."""
    return {"rows": corner_rows.rows_of_stated_and_true_errors_of_corner_brake(case["corner"])}


def _draw_brake(seed: int) -> Brake:
    """The brake of a seed: even seeds draw any shape, odd seeds any support of a drum brake."""
    ways = []
    for way in KINDS_OF_HOLDING:
        if not way.startswith("pad"):
            ways.append(way)
    brake = (
        draw_random_brake_of_support_kind(seed, ways[seed // 2 % len(ways)])
        if seed % 2
        else draw_random_brake(seed)
    )
    return brake


def _stated_and_true_rows(case: ComputationInput) -> dict[str, Any]:
    """Stated and true errors of a random brake, a row for each tolerance."""
    seed, tolerances = case["seed"], case["tolerances"]
    brake, failure, true = _draw_brake(seed), "", None
    # Triangles are independent of hp elements, but slow: they judge every TENTH brake.
    triangular = seed // 2 % TENTH == 0
    try:
        true = (
            solve_fine_reference_by_triangles(brake)
            if triangular
            else solve_fine_reference_by_hp_elements(brake, tolerances[-1])
        )
    except NoAnswer as error:
        failure = str(error)
    base = {"seed": seed, "truth": "triangles" if triangular else "columns"}
    return {
        "rows": [
            base | row_of_stated_and_true_errors(brake, tolerance, solve, true, failure)
            for tolerance in tolerances
        ]
    }


def report(result: Result, folder: Path) -> Path:
    """Write page, figures and tables, and return the path of the page."""
    # One figure for each contact, with a curve for each kind of mesh.
    for i, case in enumerate(CASES):
        series = {}
        for kind in MESH_KINDS:
            rows = []
            for r in result.orders:
                if (r["case"], r["kind"]) == (case, kind):
                    rows.append(r)
            series[kind] = [(r["elements"], r["pressure"]) for r in rows]
        figure = figures.draw_errors_over_element_numbers(series, "error of p in L2")
        figures.save_figure(figure, folder / f"orders_{i + 1}.svg")
    figures.save_figure_for_page_and_column(
        partial(plot_stated_over_true_errors, result.judged), folder / "stated_true"
    )
    write_text(folder / "stated_true.csv", table_as_csv_text(result.judged))
    write_text(folder / "corners.csv", table_as_csv_text(result.corners))
    figures.save_figure(
        stated_true_figure.plot_errors_over_unknowns_of_levels(result.levels), folder / "levels.svg"
    )
    write_text(folder / "levels.csv", table_as_csv_text(result.levels))
    write_text(folder / "orders.csv", table_as_csv_text(result.orders))
    write_text(folder / "estimates.csv", table_as_csv_text(result.estimates))
    write_text(folder / "ladder.csv", table_as_csv_text(result.ladder))
    return write_html_page(
        HERE / "page.html",
        folder / "index.html",
        result=result,
        cases=list(CASES),
        judged=summary_rows_of_stated_errors(result.judged),
        corners=corner_rows.error_summary_rows_by_kind(result.corners),
        steep=corner_rows.SMALLEST_JUDGED_PRESSURE_EXPONENT,
        independent=summary_rows_of_stated_errors(
            rows_with_given_values(result.judged, truth="triangles")
        ),
        families=len(ladder.names_of_families_of_known_answer_cases()),
        line=fit_line_to_log_errors(result.levels),
    )
