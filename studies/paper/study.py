"""The paper on drumlin: its prose is a page, its numbers are those of the reports that are kept."""

import csv
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from drumlin.base.errors import BadInput
from drumlin.report.page import fill
from drumlin_studies.work_precision import PEER_FAMILIES

HERE = Path(__file__).parent
KEPT = HERE.parents[1] / "reports" / "reference"
MAIN = "double_shoe/brake"
HALF = 5e-3  # of p (L2), at which peers are compared
LAW_ENOUGH = ("torque", "torque", 0.05), ("fine", "torque", 1e-3), ("pressure", "p (L2)", 0.05)

Row = dict[str, Any]


def study(*, short: bool = False, say: Callable[[str], None] = lambda _: None) -> Mapping[str, Any]:
    """The numbers that the prose quotes, errors as parts of one, times in seconds; `short` changes
    nothing.

    Raises BadInput where a kept report is missing.
    """
    say("the kept reports")
    return _double_shoe() | _run_time() | _others()


def _rows(name: str) -> list[Row]:
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
    try:
        return float(text)
    except ValueError:
        return text


def _double_shoe() -> Row:
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
    rows = [row for row in _rows("error_vs_runtime/results.csv") if row["status"] == "converged"]
    main = [row for row in rows if row["brake"] == MAIN]
    best = _rows("error_vs_runtime/recommended.csv")
    (half,) = [
        row
        for row in best
        if (row["brake"], row["quantity"], row["target"]) == (MAIN, "p (L2)", HALF)
    ]  # a row for each brake, quantity and target
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
    """How many times as long a peer takes, cold and for a further load case, on the mesh on which
    both know p.
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
    fit = [
        row
        for row in rows
        if (row["family"], row.get("kind")) == (family, kind)
        and row.get("even") != "True"
        and not row.get("layers")  # nor a refined one
        and row["pressure_error"] <= HALF
    ]
    return min(fit, key=lambda row: row["seconds"], default=None)


def _others() -> Row:
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
    """Write the page; returns it."""
    return fill(HERE / "page.html", folder / "index.html", **result)
