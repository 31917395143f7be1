"""Safety factors with which stated errors are at least as large as true errors.

The factors are fitted on random brakes, into a file that the program reads.
"""

import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.files import write_text
from drumlin.base.journal import JournalOfCaseResults
from drumlin.fem.error_control.estimate import (
    QUANTITIES_WITH_STATED_ERROR,
    SafetyFactorsOfErrorEstimate,
)
from drumlin.fem.width.ladder import SafetyFactorsOfSolidErrors
from drumlin.report import figures
from drumlin.report.page import write_html_page
from drumlin_studies.calibration import (
    CORNER_BRAKES,
    FIRST_CORNER,
    FIRST_SEED,
    FITTED_BRAKES,
    FRACTION_COVERED_BY_STATED_ERROR,
    MEANINGS_OF_SAFETY_FACTORS,
    OriginOfSafetyFactors,
    TrueErrorsAndEstimateTermsOnLevel,
    error_estimate_factors_as_json_text,
    fit_safety_factors,
    true_and_estimated_errors_of_quantity,
    true_and_estimated_errors_of_random_brake,
)
from drumlin_studies.side_by_side import (
    NUMBER_OF_PROCESSES_OF_STUDY,
    ComputationInput,
    compute_cases_in_parallel_with_journal,
)
from drumlin_studies.stated_true import SMALLEST_RELEVANT_TRUE_ERROR
from drumlin_studies.stated_true_figure import plot_cumulative_shares_of_stated_over_true_ratios
from drumlin_studies.width_calibration import (
    FRACTION_COVERED_BY_STATED_WIDTH_ERROR,
    MEANINGS_OF_SOLID_SAFETY_FACTORS,
    SEEDS_FOR_FIT_TO_ERRORS_OF_SECTION_MESH,
    SEEDS_FOR_FIT_TO_ERRORS_OF_STEPS,
    SEEDS_FOR_FIT_TO_ERRORS_OF_WIDTH_DEGREE,
    EstimatedAndTrueErrorOfSolidShoe,
    fit_safety_factors_of_width_errors,
    width_error_rows_as_csv_text,
    width_error_rows_of_random_brake,
    width_safety_factors_as_json_text,
)

HERE = Path(__file__).parent
FEW = 4
"""Number of random brakes in a trial run of this study (option --short)."""
SHORT_SEEDS = (1002, 1006, 1018)
"""Seeds of the random solid shoes in a trial run of this study."""
COMPUTING = (
    "src/drumlin/fem",
    "src/drumlin/contact",
    "src/drumlin/response",
    "src/drumlin_studies",
)
"""Source folders whose changes may change the fitted factors.

The file that holds the factors lies in one of them, but is left out.
"""


class Result(NamedTuple):
    """The errors of each random brake, the fitted factors, and the commit that computed them.

    `width_rows` and `width_factors` are those of solid shoes.
    """

    rows: list[dict[str, Any]]
    factors: SafetyFactorsOfErrorEstimate
    provenance: OriginOfSafetyFactors
    width_rows: list[EstimatedAndTrueErrorOfSolidShoe]
    width_factors: SafetyFactorsOfSolidErrors


def study(
    *,
    short: bool = False,
    say: Callable[[str], None] = lambda _: None,
    journal: JournalOfCaseResults | None = None,
) -> Result:
    """Compute the errors of all random brakes in two processes, and fit the factors to them.

    short : whether few brakes are enough; their factors mean nothing.
    """
    journal = journal or JournalOfCaseResults()
    # Random brakes of all kinds, and brakes that press with corners.
    seeds = range(FIRST_SEED, FIRST_SEED + (FEW if short else FITTED_BRAKES))
    corners = range(FIRST_CORNER, FIRST_CORNER + (1 if short else CORNER_BRAKES))
    cases = []
    for seed in (*seeds, *corners):
        cases.append({"seed": seed})
    rows = compute_cases_in_parallel_with_journal(
        cases, _observe_case, journal, say, 0 if short else NUMBER_OF_PROCESSES_OF_STUDY
    )
    levels = levels_of(rows)
    commit, date = last_commit()
    brakes = sum(bool(row["levels"]) for row in rows)
    words = f"{seeds[0]} to {seeds[-1]}, {corners[0]} to {corners[-1]}"
    width_rows = _observe_solid_shoes(journal, say, short=short)
    return Result(
        rows,
        fit_safety_factors(levels),
        OriginOfSafetyFactors(words, brakes, len(levels), commit, date),
        width_rows,
        fit_safety_factors_of_width_errors(width_rows),
    )


def _observe_solid_shoes(
    journal: JournalOfCaseResults, say: Callable[[str], None], *, short: bool
) -> list[EstimatedAndTrueErrorOfSolidShoe]:
    """The rows of random solid shoes; `short` is whether few brakes are enough."""
    cases = []
    for part, kinds in (
        ("width", SEEDS_FOR_FIT_TO_ERRORS_OF_WIDTH_DEGREE),
        ("pieces", SEEDS_FOR_FIT_TO_ERRORS_OF_STEPS),
        ("section", SEEDS_FOR_FIT_TO_ERRORS_OF_SECTION_MESH),
    ):
        for kind, seeds in kinds.items():
            for seed in seeds:
                cases.append({"part": part, "kind": kind, "seed": seed})
    if short:
        # Shoes without bodies are solved in a tenth of a second.
        cases = [{"part": "width", "kind": "free", "seed": seed} for seed in SHORT_SEEDS]
    found = compute_cases_in_parallel_with_journal(
        cases,
        _observe_solid_case,
        journal,
        say,
        0 if short else NUMBER_OF_PROCESSES_OF_STUDY,
        "solid shoes",
    )
    return [EstimatedAndTrueErrorOfSolidShoe(**row) for each in found for row in each["rows"]]


def _observe_solid_case(case: ComputationInput) -> dict[str, Any]:
    """The rows of a case's brake with solid shoes, as plain data."""
    rows = width_error_rows_of_random_brake(**case)
    return {"rows": [row._asdict() for row in rows]}


def _observe_case(case: ComputationInput) -> dict[str, Any]:
    """True and estimated errors of one random brake on all of its meshes (levels)."""
    return true_and_estimated_errors_of_random_brake(case["seed"])


def levels_of(rows: list[dict[str, Any]]) -> list[TrueErrorsAndEstimateTermsOnLevel]:
    """True and estimated errors of all random brakes on all of their meshes (levels)."""
    levels: list[TrueErrorsAndEstimateTermsOnLevel] = []
    for row in rows:
        for level in row["levels"]:
            levels.append(TrueErrorsAndEstimateTermsOnLevel(**level))
    return levels


def last_commit() -> tuple[str, str]:
    """Hash and date of the last commit that changed COMPUTING; empty outside a repository."""
    own = (":!src/drumlin/fem/error_control/factors.json", ":!src/drumlin/fem/width/factors.json")
    command = ["git", "log", "-1", "--format=%h %cs", "--", *COMPUTING, *own]
    try:
        run = subprocess.run(
            command, cwd=HERE.parents[1], capture_output=True, text=True, check=True
        )
    except (OSError, subprocess.CalledProcessError):
        return "", ""
    commit, _, date = run.stdout.strip().partition(" ")
    return commit, date


def report(result: Result, folder: Path) -> Path:
    """Write the file of the factors, figure and page, and return the path of the page."""
    write_text(
        folder / "factors.json",
        error_estimate_factors_as_json_text(result.factors, result.provenance),
    )
    provenance = result.provenance
    text = width_safety_factors_as_json_text(
        result.width_factors, result.width_rows, provenance.commit, provenance.date
    )
    write_text(folder / "width_factors.json", text)
    write_text(folder / "width_rows.csv", width_error_rows_as_csv_text(result.width_rows))
    levels = levels_of(result.rows)
    # Factor of each quantity, and weight of the change by random signs.
    force = result.factors.force
    factors = {
        "pressure": (result.factors.pressure, 0.0),
        "torque": (force, result.factors.cancelled / force),
        "reaction": (force, result.factors.cancelled / force),
        "peak": (result.factors.peak, 0.0),
    }
    ratios = {}
    for name in QUANTITIES_WITH_STATED_ERROR:
        ratios[name] = true_and_estimated_errors_of_quantity(levels, name).stated_over_true_errors(
            *factors[name]
        )
    figures.save_figure(
        plot_cumulative_shares_of_stated_over_true_ratios(ratios), folder / "factors.svg"
    )
    spread = []
    for name, found in ratios.items():
        spread.append(
            {
                "quantity": name,
                "factor": factors[name][0],
                "levels": len(found),
                "below": float(np.mean(found < 1)),
                "smallest": float(found.min()),
                "tenth": float(np.quantile(found, 0.1)),
                "median": float(np.median(found)),
            }
        )
    failed = []
    for row in result.rows:
        if not row["levels"]:
            failed.append(row)
    return write_html_page(
        HERE / "page.html",
        folder / "index.html",
        result=result,
        spread=spread,
        meaning=MEANINGS_OF_SAFETY_FACTORS,
        quantile=FRACTION_COVERED_BY_STATED_ERROR,
        relevant=SMALLEST_RELEVANT_TRUE_ERROR,
        failed=failed,
        width_meaning=MEANINGS_OF_SOLID_SAFETY_FACTORS,
        width_quantile=FRACTION_COVERED_BY_STATED_WIDTH_ERROR,
        width_brakes=len({(row.kind, row.seed) for row in result.width_rows}),
    )
