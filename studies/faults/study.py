"""How drumlin ends on broken inputs and after sweeps that are killed."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from drumlin.base.journal import JournalOfCaseResults
from drumlin.report.page import write_html_page
from drumlin_studies.fuzzing import kills, promises, trials

HERE = Path(__file__).parent
WORKERS = 2
"""Number of processes."""
UNKNOWN = "not known to it"
"""Kind of inputs with options that an earlier drumlin does not have: neither sound nor a fault."""
INPUTS = {
    "bytes": 1000,
    "schema": 2000,
    "sizes": 1500,
    "structure": 500,
    "huge": 100,
    "meshes": 1500,
    "impossible meshes": 1500,
    "references": 700,
    "tables": 700,
    "sweeps": 1000,
    "changed sweeps": 500,
    "journals": 400,
    "command lines": 1200,
    "words": 300,
}
"""Number of random broken inputs from each generator."""
APART = 30
"""Number of inputs of each generator that are also given to drumlin in a process of its own."""
SWEEPS = {"one job": 4, "two jobs": 4, "Dask": 2}
"""Number of sweeps that are killed, by the way in which they run."""
KILLS = 10
"""Number of kills of each sweep."""


class Result(NamedTuple):
    """All results that the report of this study shows.

    Attributes
    ----------
    within, apart : dict
        Verdicts by generator on inputs that run in the study's process, and in processes of their
        own.
    killed : list of dict
        Rows of the killed sweeps.
    """

    within: dict[str, list[trials.InputVerdict]]
    apart: dict[str, list[trials.InputVerdict]]
    killed: list[dict[str, Any]]


def study(
    *,
    short: bool = False,
    say: Callable[[str], None] = lambda _: None,
    journal: JournalOfCaseResults | None = None,
) -> Result:
    """Try all inputs and kill all sweeps.

    short : trial run with five inputs of each generator and without killed sweeps.
    """
    journal = journal or JournalOfCaseResults()
    # Most inputs run in this process, which is faster; some run in their own.
    within = dict.fromkeys(INPUTS, 5) if short else INPUTS
    apart = {"words": 1} if short else dict.fromkeys(INPUTS, APART)
    processes = 0 if short else WORKERS
    return Result(
        trials.run_and_judge_generators(within, journal, processes=processes, say=say),
        trials.run_and_judge_generators(apart, journal, apart=True, processes=processes, say=say),
        [] if short else kills.kill_and_finish_many_sweeps(SWEEPS, KILLS, journal, say),
    )


def report(result: Result, folder: Path) -> Path:
    """Write the page and return its path."""
    within, apart = (
        trials.rows_of_verdict_counts_by_generator(result.within),
        trials.rows_of_verdict_counts_by_generator(result.apart),
    )
    before = json.loads((HERE / "before.json").read_text(encoding="utf-8"))
    return write_html_page(
        HERE / "page.html",
        folder / "index.html",
        within=within,
        apart=apart,
        before=before
        | {
            "rows": [
                _earlier_and_present_row(row, result.within[row["generator"]])
                for row in before["rows"]
            ]
        },
        killed=kills.killed_sweeps_summary_rows(result.killed),
        refusal_lines=trials.most_frequent_refusals_text(result.within),
        faults=_fault_lines(result),
        promises=promises.PROMISES_WITH_THEIR_TESTS,
        statuses=promises.STATUS_MEANINGS,
    )


def _fault_lines(result: Result) -> list[str]:
    """All faults, in words."""
    faults = []
    for verdicts in (*result.within.values(), *result.apart.values()):
        for verdict in verdicts:
            if verdict.fault:
                faults.append(verdict.fault)
    return faults + [f"{row['way']}: {row['fault']}" for row in result.killed if row["fault"]]


def _earlier_and_present_row(row: dict[str, Any], now: list[trials.InputVerdict]) -> dict[str, Any]:
    """The faults of an earlier drumlin beside those of the present one on the same inputs."""
    counts: dict[str, int] = row["faults"]
    later = counts.pop(UNKNOWN, 0)
    return {
        "generator": row["generator"],
        "inputs": row["inputs"] - later,
        "before": sum(counts.values()),
        "kinds": ", ".join(f"{count} {kind}" for kind, count in counts.items()),
        "now": sum(bool(verdict.fault) for verdict in now[: row["inputs"]]),
    }
