"""Whether a brake with extreme parameters is solved right, or refused with the true reason.

The answers are compared with those of the textbook method, contact springs at quadrature points.
"""

import math
import statistics
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any, NamedTuple

from studies.stability import figures, locking, ways

from drumlin.base.files import write_text
from drumlin.base.journal import JournalOfCaseResults
from drumlin.comparison import table_as_csv_text
from drumlin.report.figures import save_figure
from drumlin.report.page import write_html_page
from drumlin_studies import consistency, self_locking
from drumlin_studies.extreme_cases import all_extreme_cases
from drumlin_studies.outcomes import (
    OUTCOMES_OF_POINTWISE_PENALTY_TRIALS,
    count_row_values_by_varied_quantity,
    log_slope_of_error_over_penalty,
    relative_torque_changes_due_to_penalty,
    rows_with_fewest_correct_digits,
    solve_time_rows_by_varied_quantity,
    trial_rows_with_fault_as_outcome,
    trial_rows_with_varied_penalty,
)
from drumlin_studies.tables import (
    rows_that_have_value_of_key,
    rows_with_given_values,
    values_of_key_in_rows,
)
from drumlin_studies.trial import (
    ALL_TRIAL_OUTCOMES,
    LARGEST_RELATIVE_RESIDUAL_OF_RIGHT_ANSWER,
    REFUSAL_OUTCOMES_BY_MESSAGE_WORDS,
    TORQUE_DIGITS_THAT_AGREE_WITH_REFINED_SOLUTION,
    TRIAL_OUTCOMES_WITH_ANSWER,
    solve_and_judge_case,
)

HERE = Path(__file__).parent
WORKERS = 2
"""Number of processes."""
GRIDS = {
    "shoe × friction": (
        "shoe",
        "friction",
        ("modulus of the shoe over that of the lining [-]", "friction μ [-]"),
    ),
    "thickness × penalty": (
        "penalty",
        "thickness",
        ("penalty, multiple of E/t [-]", "lining thickness over R [-]"),
    ),
}
"""For each grid of two varied inputs: the inputs along x and y, and the labels of the axes.
"""

Row = dict[str, Any]


class Result(NamedTuple):
    """All results that the report of this study shows.

    Attributes
    ----------
    rows : list of dict
        A row for each case.
    locked : locking.Result
        Tables on self-locking.
    compared : list of TwoPathComparison
        Comparisons of two paths to one quantity.
    seconds : float
        Run time of the study [s].
    """

    rows: list[Row]
    locked: locking.Result
    compared: list[consistency.TwoPathComparison]
    seconds: float


def study(
    *,
    short: bool = False,
    say: Callable[[str], None] = lambda _: None,
    journal: JournalOfCaseResults | None = None,
) -> Result:
    """Solve every case with extreme inputs, in two processes.

    short : trial run with some 70 cases, all solved in this process.
    """
    start = time.perf_counter()
    journal = journal or JournalOfCaseResults()
    # Cases whose results an earlier run left in the journal are not solved again.
    keys = {case: {"case": repr(case)} for case in all_extreme_cases(short=short)}
    left = [case for case, key in keys.items() if key not in journal]
    if short:
        for case in left:
            journal.add(keys[case], solve_and_judge_case(case))
    else:
        with ProcessPoolExecutor(WORKERS, mp_context=get_context("spawn")) as pool:
            for done, (case, row) in enumerate(
                zip(left, pool.map(solve_and_judge_case, left), strict=True), 1
            ):
                journal.add(keys[case], row)
                if done % 10 == 0:
                    say(f"{done} of {len(left)} cases")
    locked = locking.study(journal, short=short, say=say)
    compared = ways.study(journal, short=short, say=say)
    return Result(
        [journal[key] for key in keys.values()],
        locked,
        compared,
        time.perf_counter() - start,
    )


def report(result: Result, folder: Path) -> Path:
    """Write page, figures and tables, and return the path of the page."""
    rows = result.rows
    compared = []
    for check in result.compared:
        compared.append(check._asdict() | {"outcome": check.outcome})
    write_text(folder / "ways.csv", table_as_csv_text(compared))
    write_text(
        folder / "cases.csv",
        table_as_csv_text([{k: v for k, v in row.items() if k != "knobs"} for row in rows]),
    )
    known = rows_that_have_value_of_key(rows, "digits")
    softened = relative_torque_changes_due_to_penalty(rows)
    swept = softened if softened and all(len(values) >= 4 for values in softened.values()) else {}
    draw_figures(result, known, swept, folder)
    locked = result.locked
    grids = {}
    for knob in GRIDS:
        grids[knob] = _figure_file(knob)
    # The slopes of the penalty error, and its largest value at the default penalty or above.
    slopes = []
    for values in swept.values():
        slopes.append(log_slope_of_error_over_penalty(values))
    changes = []
    for values in swept.values():
        for penalty, change in values:
            if penalty >= 1e6:
                changes.append(change)
    ways_counted = []
    for count in consistency.counts_of_comparison_outcomes_by_check(result.compared):
        ways_counted.append(count._asdict())
    below = []
    for row in known:
        if row["digits"] < min(TORQUE_DIGITS_THAT_AGREE_WITH_REFINED_SOLUTION, row["allowed"]):
            below.append(row)
    return write_html_page(
        HERE / "page.html",
        folder / "index.html",
        result=result,
        rows=rows,
        **_rows_by_ending(rows),
        faults=trial_rows_with_fault_as_outcome(rows),
        residual=LARGEST_RELATIVE_RESIDUAL_OF_RIGHT_ANSWER,
        required=TORQUE_DIGITS_THAT_AGREE_WITH_REFINED_SOLUTION,
        grids=grids,
        outcome_names=ALL_TRIAL_OUTCOMES,
        outcomes=count_row_values_by_varied_quantity(rows, "outcome", ALL_TRIAL_OUTCOMES),
        known=known,
        median_digits=statistics.median(values_of_key_in_rows(known, "digits")),
        below=below,
        worst=rows_with_fewest_correct_digits(rows),
        pointwise_names=OUTCOMES_OF_POINTWISE_PENALTY_TRIALS,
        pointwise=count_row_values_by_varied_quantity(
            rows, "pointwise", OUTCOMES_OF_POINTWISE_PENALTY_TRIALS
        ),
        penalties=trial_rows_with_varied_penalty(rows) if swept else [],
        stiff=max(changes, default=None),
        slopes=slopes,
        timings=solve_time_rows_by_varied_quantity(rows),
        **_locking_values(locked),
        limits=self_locking,
        ways_counted=ways_counted,
        ways_differing=rows_with_given_values(compared, outcome="differs"),
    )


def _rows_by_ending(rows: list[Row]) -> dict[str, list[Row]]:
    """The rows with an answer, those refused for a stated reason, and all without an answer."""
    endings: dict[str, list[Row]] = {"answers": [], "refused": [], "unanswered": []}
    for row in rows:
        has_answer = row["outcome"] in TRIAL_OUTCOMES_WITH_ANSWER
        endings["answers" if has_answer else "unanswered"].append(row)
        if row["outcome"] in (*REFUSAL_OUTCOMES_BY_MESSAGE_WORDS.values(), "bad input"):
            endings["refused"].append(row)
    return endings


def _locking_values(locked: locking.Result) -> dict[str, Any]:
    """The values on self-locking that the page quotes, by their names on the page."""
    # The limit of the stiffest shoe, for each thickness of the lining.
    stiffest = []
    for of_thickness in locking.rows_by_thickness(locked.shoe).values():
        stiffest.append(max(of_thickness, key=lambda row: row["factor"]))
    # Difference from the law's limit over the relative thickness of the lining.
    rigid = []
    for row in locked.rigid:
        rigid.append(row | {"per_thickness": row["difference"] / row["t_over_R"]})
    poles = {}
    for row in locked.torque:
        poles[row["name"]] = self_locking.torque_times_distance_to_locking_friction_and_its_change(
            row
        )
    # Random brakes whose answers agree, and those with several answers below the limit.
    table = uniqueness_page_rows(locked.unique)
    agreeing: list[Row] = []
    disagreeing: list[Row] = []
    for row in table:
        (disagreeing if row["disagreeing"] else agreeing).append(row)
    return {
        "locked": locked,
        "law": locked.mesh[0]["law"],
        "stiffest": stiffest,
        "rigid": rigid,
        "own_ring": rows_with_given_values(locked.ring, support="free", factor=1)[0],
        "poles": poles,
        "agreeing": agreeing,
        "disagreeing": disagreeing,
    }


def draw_figures(
    result: Result, known: list[Row], swept: dict[str, list[tuple[float, float]]], folder: Path
) -> None:
    """Write the figures.

    Parameters
    ----------
    result : Result All results that the report of this study shows.
    known : list of dict
        Rows whose digits are known.
    swept : dict
        Changes of the torque by a finite penalty; empty where too few penalties were tried.
    folder : Path
        Folder of the report.
    """
    rows, locked = result.rows, result.locked
    knobs = [
        knob
        for knob in dict.fromkeys(values_of_key_in_rows(rows, "knob"))
        if " × " not in knob and knob != "hypercube"
    ]
    save_figure(figures.draw_outcome_strips(rows, knobs), folder / "sweeps.svg")
    for knob, (x, y, labels) in GRIDS.items():
        save_figure(
            figures.draw_outcome_grids(rows_with_given_values(rows, knob=knob), x, y, labels),
            folder / _figure_file(knob),
        )
    save_figure(figures.draw_digits_over_condition(known), folder / "condition.svg")
    if swept:
        save_figure(figures.draw_change_by_penalty(swept), folder / "penalty.svg")
    shoes = {}
    for t, of in locking.rows_by_thickness(locked.shoe).items():
        shoes[f"lining {t * 1e3:g} mm"] = of
    rings = {}
    for support in ("free", "fixed"):
        rings[f"{support} rim"] = rows_with_given_values(locked.ring, support=support)
    panels = [("shoe", shoes), ("drum ring", rings)]
    save_figure(figures.draw_locking_limits(panels, locked.mesh[0]["law"]), folder / "locking.svg")
    save_figure(figures.draw_torque_poles(locked.torque), folder / "locking_torque.svg")


def _figure_file(knob: str) -> str:
    """The name of the file of a grid's figure."""
    return knob.replace(" × ", "_") + ".svg"


def uniqueness_page_rows(rows: list[Row]) -> list[Row]:
    """Rows of the random brakes for the page: kind of the limit, and where answers disagree."""
    return [
        row
        | {
            "ends": None if row["mu_lock"] is None else "turns back" if row["bounded"] else "pole",
            "where": ", ".join(f"{f:g}" for f in row["disagreeing"]) or None,
            "law": None if math.isinf(row["law"]) else row["law"],
        }
        for row in rows
    ]
