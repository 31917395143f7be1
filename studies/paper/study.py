"""The paper on drumlin, whose numbers are those of the kept reports."""

import csv
import shutil
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from studies.paper.markdown import paper_as_markdown

from drumlin.base.errors import BadInput
from drumlin.report.page import write_html_page
from drumlin_studies.tables import rows_with_given_values, values_of_key_in_rows
from drumlin_studies.work_precision import PEER_KEYS_BY_NAME_IN_TABLES

HERE = Path(__file__).parent
KEPT = HERE.parents[1] / "reports" / "reference"
MAIN = "double_shoe/brake"
HALF = 5e-3
"""Relative L2 error of p at which other programs are compared."""
PEER_TIMES = ("half", HALF, "ratio"), ("fine", 1e-3, "ratio"), ("further", 1e-3, "further_ratio")
"""Name, relative L2 error of p and column of the time of each comparison with other programs."""
LAW_ENOUGH = ("torque", "torque", 0.05), ("fine", "torque", 1e-3), ("pressure", "p (L2)", 0.05)

Row = dict[str, Any]


def study(*, short: bool = False, say: Callable[[str], None] = lambda _: None) -> Mapping[str, Any]:
    """The numbers that the text of the paper quotes: errors as fractions, times in seconds.

    `short` changes nothing. Raises BadInput where a kept report is missing.
    """
    say("the kept reports")
    return _double_shoe_numbers() | _run_time_numbers() | _wear_and_post_numbers()


def _kept_rows(name: str) -> list[Row]:
    """The rows of a table of the kept reports."""
    try:
        with (KEPT / name).open(encoding="utf-8") as file:
            return list(map(_row_of_values, csv.DictReader(file)))
    except OSError as error:
        raise BadInput(
            f"reports/reference/{name}: the paper quotes it, and it is missing"
        ) from error


def _row_of_values(cells: Mapping[str, str]) -> Row:
    """The values of a row of text by key, without the empty cells."""
    found = {}
    for key, text in cells.items():
        if text != "":
            found[key] = _cell_value(text)
    return found


def _cell_value(text: str) -> Any:
    """The content of a table's cell: a number if the text is a number, else the text."""
    try:
        return float(text)
    except ValueError:
        return text


def _double_shoe_numbers() -> Row:
    """Errors of the sine law on the double-shoe brake."""
    rows = _kept_rows("double_shoe/results.csv")
    sine = rows_with_given_values(rows, rotation="counter-clockwise", model="sine")
    # The rows named "all" hold the errors of the whole brake, the others those of single shoes.
    shoes = []
    for row in rows_with_given_values(sine, case="stiff shoes"):
        if row["shoe"] != "all":
            shoes.append(row)
    total = {}
    for row in rows_with_given_values(sine, shoe="all"):
        total[row["case"]] = row["torque_error"]
    return {
        "stiff": total["stiff shoes"],
        "flexible": total["flexible shoes"],
        "shoes": values_of_key_in_rows(shoes, "torque_error"),
        "peak": min(values_of_key_in_rows(shoes, "peak_error")),
    }


def _run_time_numbers() -> Row:
    """Numbers on error against run time."""
    rows = rows_with_given_values(_kept_rows("error_vs_runtime/results.csv"), status="converged")
    main = rows_with_given_values(rows, brake=MAIN)
    best = _kept_rows("error_vs_runtime/recommended.csv")
    # There is one row for each brake, quantity and target.
    (half,) = rows_with_given_values(best, brake=MAIN, quantity="p (L2)", target=HALF)
    # On how many brakes a law is the fastest method that keeps a target.
    by_law = {}
    for name, quantity, target in LAW_ENOUGH:
        by_law[name] = len(
            rows_with_given_values(best, family="law", quantity=quantity, target=target)
        )
    return {
        "brakes": len(set(values_of_key_in_rows(best, "brake"))),
        "laws": values_of_key_in_rows(rows_with_given_values(rows, model="sine"), "torque_error"),
        "law_p": rows_with_given_values(main, model="sine")[0]["pressure_error"],
        "half": half["seconds"],
        "by_law": by_law,
        "peers": _peer_time_ratios(main, best),
    }


def _peer_time_ratios(main: list[Row], best: list[Row]) -> dict[str, float]:
    """Ratios of other programs' times to drumlin's for the same accuracy of the pressure.

    Each program is timed on the mesh on which it reaches the accuracy fastest, drumlin by the
    method that it recommends. The keys are such as "GetFEM half".
    """
    found = {}
    for family in PEER_KEYS_BY_NAME_IN_TABLES:
        for name, target, time in PEER_TIMES:
            (choice,) = rows_with_given_values(best, brake=MAIN, quantity="p (L2)", target=target)
            (ours,) = rows_with_given_values(main, family=choice["family"], method=choice["method"])
            fit = []
            for row in rows_with_given_values(main, family=family):
                if row["pressure_error"] <= target and time in row:
                    fit.append(row)
            if fit:
                fastest = min(fit, key=lambda row: row["seconds"])
                found[f"{family} {name}"] = fastest[time] / ours[time]
    return found


def _wear_and_post_numbers() -> Row:
    """Numbers on running in, on the post brake and on plane stress."""
    worn = {}
    for row in rows_with_given_values(_kept_rows("run_in/brakes.csv"), model="fem"):
        worn[row["brake"]] = row
    # Errors of the torque of the whole post brake whose linings fit, by model.
    post = {}
    for row in rows_with_given_values(
        _kept_rows("post_brake/results.csv"), case="fits", shoe="all"
    ):
        if row["model"] in {"sine", "foundation", "lifted"}:
            post[row["model"]] = row["torque_error"]
    # Errors of plane stress on the shoe of T-section that friction presses on.
    solid = _kept_rows("plane_stress/errors.csv")
    leading = rows_with_given_values(solid, case="T-section", shoe="leading")[0]
    return {
        "worn": worn[MAIN]["end_pressure"],
        "worn_life": worn[MAIN]["pressure_life"],
        "flexible_life": worn["double_shoe/flexible"]["pressure_life"],
        "post": post,
        "plane": leading["torque"],
        "corrected": leading["corrected_torque"],
        "uneven": leading["uneven"],
    }


def report(result: Mapping[str, Any], folder: Path) -> Path:
    """Write the page, and the same paper as paper.md with its sources; return the page's path."""
    page = write_html_page(HERE / "page.html", folder / "index.html", **result)
    text = paper_as_markdown(page.read_text(encoding="utf-8"))
    (folder / "paper.md").write_text(text, encoding="utf-8")
    shutil.copyfile(HERE / "paper.bib", folder / "paper.bib")
    return page
