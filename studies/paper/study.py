"""The paper on drumlin, whose numbers are those of the kept reports."""

import csv
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from drumlin.base.errors import BadInput
from drumlin.report.page import write_page
from drumlin_studies.work_precision import PEER_FAMILIES

HERE = Path(__file__).parent
KEPT = HERE.parents[1] / "reports" / "reference"
MAIN = "double_shoe/brake"
HALF = 5e-3
"""Relative L2 error of p at which other programs are compared."""
LAW_ENOUGH = ("torque", "torque", 0.05), ("fine", "torque", 1e-3), ("pressure", "p (L2)", 0.05)

Row = dict[str, Any]


def study(*, short: bool = False, say: Callable[[str], None] = lambda _: None) -> Mapping[str, Any]:
    """The numbers that the prose quotes: errors as fractions, times in seconds.

    `short` changes nothing. Raises BadInput where a kept report is missing.
    """
    say("the kept reports")
    return _double_shoe() | _run_time() | _others()


def _rows(name: str) -> list[Row]:
    """The rows of a table of the kept reports."""
    try:
        with (KEPT / name).open(encoding="utf-8") as file:
            return [
                {key: _value(text) for key, text in row.items() if text != ""}
                for row in csv.DictReader(file)
            ]
    except OSError as error:
        raise BadInput(
            f"reports/reference/{name}: the paper quotes it, and it is missing"
        ) from error


def _value(text: str) -> Any:
    """A cell of a table, as a number where it is a number."""
    try:
        return float(text)
    except ValueError:
        return text


def _double_shoe() -> Row:
    """Errors of the sine law on the double-shoe brake."""
    made = [
        row for row in _rows("double_shoe/results.csv") if row["rotation"] == "counter-clockwise"
    ]
    sine = [row for row in made if row["model"] == "sine"]
    shoes = [row for row in sine if row["case"] == "stiff shoes" and row["shoe"] != "all"]
    total = {row["case"]: row["torque_error"] for row in sine if row["shoe"] == "all"}
    return {
        "stiff": total["stiff shoes"],
        "flexible": total["flexible shoes"],
        "shoes": [row["torque_error"] for row in shoes],
        "peak": min(row["peak_error"] for row in shoes),
    }


def _run_time() -> Row:
    """Numbers on error against run time."""
    rows = [row for row in _rows("error_vs_runtime/results.csv") if row["status"] == "converged"]
    main = [row for row in rows if row["brake"] == MAIN]
    best = _rows("error_vs_runtime/recommended.csv")
    # There is one row for each brake, quantity and target.
    of_p = [row for row in best if (row["brake"], row["quantity"]) == (MAIN, "p (L2)")]
    (half,) = [row for row in of_p if row["target"] == HALF]
    return {
        "brakes": len({row["brake"] for row in best}),
        "laws": [row["torque_error"] for row in rows if row.get("model") == "sine"],
        "law_p": next(row["pressure_error"] for row in main if row.get("model") == "sine"),
        "half": half["seconds"],
        "by_law": {
            name: sum(
                (row["family"], row["quantity"], row["target"]) == ("law", quantity, target)
                for row in best
            )
            for name, quantity, target in LAW_ENOUGH
        },
        "peers": _peers(main),
    }


def _peers(rows: list[Row]) -> dict[str, list[float]]:
    """Times of peers over those of drumlin, cold and for a further load case.

    Each is on its fastest graded mesh of a kind with an error of p within HALF. Only equal meshes
    are compared.
    """
    found: dict[str, list[float]] = {}
    for family in PEER_FAMILIES:
        for kind in ("quad1", "quad2"):
            theirs, ours = (_quickest(rows, name, kind) for name in (family, "graded mesh"))
            if theirs is not None and ours is not None and theirs["elements"] == ours["elements"]:
                for key in ("seconds", "further"):
                    found.setdefault(f"{family} {key}", []).append(theirs[key] / ours[key])
    return found


def _quickest(rows: list[Row], family: str, kind: str) -> Row | None:
    """The fastest row of a family on graded meshes of a kind with an error of p within HALF."""
    own = [row for row in rows if (row["family"], row.get("kind")) == (family, kind)]
    graded = [row for row in own if row.get("even") != "True" and not row.get("layers")]
    fit = [row for row in graded if row["pressure_error"] <= HALF]
    return min(fit, key=lambda row: row["seconds"], default=None)


def _others() -> Row:
    """Numbers on running in, on the post brake and on plane stress."""
    worn = {row["brake"]: row for row in _rows("run_in/brakes.csv") if row["model"] == "fem"}
    fits = [
        row
        for row in _rows("post_brake/results.csv")
        if (row["case"], row["shoe"]) == ("fits", "all")
    ]
    post = {row["model"]: row for row in fits}
    solid = _rows("plane_stress/errors.csv")
    leading = next(row for row in solid if (row["case"], row["shoe"]) == ("T-section", "leading"))
    return {
        "worn": worn[MAIN]["end_pressure"],
        "worn_life": worn[MAIN]["pressure_life"],
        "flexible_life": worn["double_shoe/flexible"]["pressure_life"],
        "post": {model: post[model]["torque_error"] for model in ("sine", "foundation", "lifted")},
        "plane": leading["torque"],
        "corrected": leading["corrected_torque"],
        "uneven": leading["uneven"],
    }


def report(result: Mapping[str, Any], folder: Path) -> Path:
    """Write the page and return its path."""
    return write_page(HERE / "page.html", folder / "index.html", **result)
