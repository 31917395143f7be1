"""The work-precision figure: error over run time, a marker a solve, a colour a family of methods."""

from collections.abc import Mapping, Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from drumlin.report.figures import STYLE
from drumlin.verification.work_precision import series

COLORS = {
    "law": "#c8553d",
    "foundation": "#2a9d5c",
    "even mesh": "#8a8f98",
    "graded mesh": "#0b6e99",
    "adapted mesh": "#1d2733",
    "weak penalty": "#7fb8d4",
    "pointwise penalty": "#d19a1b",
    "GetFEM": "#7a5195",
    "CalculiX": "#6b8e23",
}
MARKERS = {"quad2": "s", "quad1": "D", "tri2": "^", "tri1": "v", "sine": "*", "cosine": "P", "uniform": "X"}
PANELS = {"torque_error": "error of the torque [%]", "pressure_error": "error of p, L2, worst shoe [%]"}


def work_precision(title: str, rows: Sequence[Mapping[str, Any]], floors: Mapping[str, float]) -> Figure:
    """Errors of torque and p over the seconds of a cold solve, log-log; the reference's floor is shaded."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(10.6, 4.9), layout="constrained")
        grid = figure.subplots(1, 2)
        for axes, (key, label) in zip(grid, PANELS.items(), strict=True):
            _panel(axes, rows, key, floors[key])
            axes.set_ylabel(label)
            axes.set_xlabel("run time of a cold solve [ms]")
        grid[0].set_title(title)
        handles: list[Any] = [
            mpl.lines.Line2D([], [], color=COLORS[family], lw=3, label=family) for family in _families(rows)
        ]
        marks = {series_.split(",")[0] for (_, series_) in series(rows)}
        handles += [
            mpl.lines.Line2D([], [], color="#444444", marker=marker, ls="", ms=6, label=name)
            for name, marker in MARKERS.items()
            if name in marks
        ]
        handles.append(mpl.patches.Patch(color="#e9d8c3", label="below what the reference knows"))
        figure.legend(handles=handles, loc="outside right upper", fontsize=8.5)
    return figure


def _families(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    found = {row["family"] for row in rows if row["status"] == "converged"}
    return [family for family in COLORS if family in found]


def _panel(axes: Any, rows: Sequence[Mapping[str, Any]], key: str, floor: float) -> None:
    lowest = max(100 * floor, 1e-8)
    smallest = lowest / 3
    for (family, name), members in series(rows).items():
        seconds = np.array([row["seconds"] for row in members]) * 1e3
        error = np.maximum(np.array([row[key] for row in members]) * 100, smallest)
        spread = np.array([[row["seconds"] - row["lower"], row["upper"] - row["seconds"]] for row in members]).T * 1e3
        light = family in {"even mesh", "weak penalty"}
        axes.errorbar(
            seconds, error, xerr=spread, color=COLORS[family], marker=MARKERS.get(name.split(",")[0], "o"),
            ms=9 if family == "law" else 4.5, lw=1.0 if light else 1.5, alpha=0.75 if light else 1.0,
            ls="" if family == "law" else ":" if name.endswith("even") else "-", elinewidth=0.8,
        )  # fmt: skip
    axes.set_xscale("log")
    axes.set_yscale("log")
    top = max(100 * row[key] for row in rows if row["status"] == "converged")
    axes.set_ylim(smallest * 0.8, 2.0 * max(top, lowest))
    axes.axhspan(smallest * 0.8, lowest, color="#e9d8c3", alpha=0.7, lw=0)
    axes.xaxis.set_major_formatter("{x:g}")
    axes.minorticks_off()
