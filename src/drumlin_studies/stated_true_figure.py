"""Figures of stated against true errors, and of the errors of finer and finer levels."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from drumlin.base.arrays import Floats
from drumlin.report.figures import STYLE, draw_legend
from drumlin.report.palette import BLUE, GREEN, INK, PURPLE, RED

PANEL_TITLES = {
    "pressure": "pressure p (L2)",
    "torque": "torque",
    "peak": "peak pressure",
    "reaction": "hinge reaction",
}
"""Titles of the panels, by quantity."""
PANEL_MARKS = (("o", BLUE), ("s", RED), ("D", PURPLE), ("^", GREEN))
"""Mark and colour of each tolerance, from the loosest on."""
WELL_KNOWN = 4.0
"""Ratio of a true error to the uncertainty of the truth above which the error is well known.

Errors below it are drawn pale.
"""
PALE_POINTS_NOTE = (
    f"pale: the true error is less than {WELL_KNOWN:g} times the uncertainty of what stands for "
    "the truth"
)


def draw_error_cloud(rows: Sequence[Mapping[str, Any]]) -> Figure:
    """Stated over true error against the true error, a panel for each quantity.

    Each tolerance has a mark of its own.
    """
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(10.4, 6.4), layout="constrained")
        drawn = None
        for axes, name in zip(figure.subplots(2, 2).flat, PANEL_TITLES, strict=True):
            if _draw_points(axes, rows, name):
                drawn = axes
            axes.axhline(1.0, color=INK, lw=1)
            axes.set_title(PANEL_TITLES[name])
            axes.set_xlabel("true error")
            axes.set_ylabel("stated over true error")
        if drawn is not None:
            draw_legend(figure, drawn)
        figure.suptitle(PALE_POINTS_NOTE, fontsize="medium")
    return figure


def _draw_points(axes: Any, rows: Sequence[Mapping[str, Any]], name: str) -> bool:
    """Draw the errors of one quantity, and return whether there are any."""
    tolerances = sorted({row["tolerance"] for row in rows}, reverse=True)
    drawn = False
    for tolerance, (mark, color) in zip(tolerances, PANEL_MARKS, strict=False):
        own = [row for row in rows if row["tolerance"] == tolerance]
        for known in (True, False):
            points = [point for row in own if (point := _error_point(row, name, known)) is not None]
            if not points:
                continue
            true, ratios = zip(*points, strict=True)
            axes.loglog(
                true,
                ratios,
                marker=mark,
                color=color,
                alpha=0.8 if known else 0.25,
                ls="",
                ms=4,
                label=f"tolerance {tolerance:g}" if known else None,
            )
            drawn = True
    return drawn


def _error_point(row: Mapping[str, Any], name: str, known: bool) -> tuple[float, float] | None:
    """True error, and stated over true error, of a quantity of a row.

    None where one of them is missing, or where the true error is well known and `known` is false,
    or the reverse.
    """
    stated = float(row.get(f"stated_{name}", math.nan))
    true = float(row.get(f"true_{name}", math.nan))
    unsure = float(row.get(f"unsure_{name}", math.nan))
    if not (stated > 0 and true > 0) or (true > WELL_KNOWN * unsure) != known:
        return None
    return true, stated / true


def draw_ratio_shares(ratios: Mapping[str, Floats]) -> Figure:
    """Share of the levels over their ratio of stated to true error, a line for each quantity.

    ratios : the ratios (n,) of each quantity.
    """
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(6.4, 4.4), layout="constrained")
        axes = figure.subplots()
        for (name, values), (_, color) in zip(ratios.items(), PANEL_MARKS, strict=True):
            percent = np.linspace(0, 100, len(values))
            axes.semilogx(np.sort(values), percent, color=color, label=PANEL_TITLES[name])
        axes.axvline(1.0, color=INK, lw=1)
        axes.set_xlabel("stated over true error")
        axes.set_ylabel("share of the levels [%]")
        draw_legend(figure, axes)
    return figure


def draw_level_errors(rows: Sequence[Mapping[str, Any]]) -> Figure:
    """Errors of p and of the torque over the cube root of the unknowns of a shoe.

    The polynomial degree stands beside each point.
    """
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(6.4, 4.4), layout="constrained")
        axes = figure.subplots()
        x = [row["root"] for row in rows]
        for name, label, mark, color in (
            ("pressure", "p (L2)", "s", BLUE),
            ("torque", "torque", "o", RED),
        ):
            axes.semilogy(x, [row[name] for row in rows], marker=mark, color=color, label=label)
        for row in rows:
            axes.annotate(
                f"p = {row['degree']}",
                (row["root"], row["pressure"]),
                (4, 5),
                textcoords="offset points",
            )
        axes.set_xlabel("(unknowns of a shoe)$^{1/3}$")
        axes.set_ylabel("relative error")
        draw_legend(figure, axes)
    return figure
