"""Figures of stated against true errors, and of true errors against the number of unknowns."""

import math
import textwrap
from collections.abc import Mapping, Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from drumlin.base.arrays import Floats
from drumlin.report.figures import (
    FULL_WIDTH,
    LARGEST_HEIGHT,
    MATPLOTLIB_SETTINGS_FOR_PRINT,
    draw_legend_below_figure,
    make_figure_for_print,
    number_of_panels_side_by_side,
)
from drumlin.report.palette import BLUE, GREEN, INK, PURPLE, RED

PANEL_TITLES_BY_QUANTITY = {
    "pressure": "pressure p (L2)",
    "torque": "torque",
    "peak": "peak pressure",
    "reaction": "hinge reaction",
}
"""Titles of the panels of a figure, by the quantity that a panel shows."""
MARK_AND_COLOUR_OF_EACH_TOLERANCE = (("o", BLUE), ("s", RED), ("D", PURPLE), ("^", GREEN))
"""Mark and colour of the points of each tolerance, from the largest tolerance on."""
LEAST_ERROR_OVER_UNCERTAINTY_OF_DARK_POINT = 4.0
"""Ratio of a true error to its uncertainty above which the true error counts as well known.

Points below this ratio are drawn pale.
"""
PALE_POINTS_NOTE = (
    f"pale: the true error is less than {LEAST_ERROR_OVER_UNCERTAINTY_OF_DARK_POINT:g} times "
    "the uncertainty of the reference "
    "solution\npeak pressure, points on a falling line: drumlin states 100 %, the peak is not known"
)
"""Note above a figure that explains its pale points and its errors of 100 %."""


LETTERS_IN_COLUMN = 52
"""Letters of a line of the note in a figure that is as wide as a column."""


def plot_stated_over_true_errors(
    rows: Sequence[Mapping[str, Any]], width: float = FULL_WIDTH
) -> Figure:
    """Figure of the ratio of stated to true error, plotted against the true error.

    The figure has a panel for each quantity, a point for each brake and tolerance, and a mark for
    each tolerance.

    Parameters
    ----------
    rows : rows of `stated_true.row_of_stated_and_true_errors`
    width : width of the figure [inches], FULL_WIDTH or COLUMN_WIDTH
    """
    with mpl.rc_context(MATPLOTLIB_SETTINGS_FOR_PRINT):
        columns = number_of_panels_side_by_side(width, 2)
        figure = make_figure_for_print(5.0 if columns == 2 else LARGEST_HEIGHT, width)
        drawn = None
        grid = figure.subplots(4 // columns, columns)
        for axes, name in zip(grid.flat, PANEL_TITLES_BY_QUANTITY, strict=True):
            if _plot_error_points_and_return_whether_any_exist(axes, rows, name):
                drawn = axes
            axes.axhline(1.0, color=INK, lw=1)
            axes.set_title(PANEL_TITLES_BY_QUANTITY[name])
            axes.set_xlabel("true error [%]")
            axes.set_ylabel("stated over true error")
        if drawn is not None:
            draw_legend_below_figure(figure, drawn)
        note = PALE_POINTS_NOTE
        if columns == 1:
            note = "\n".join(textwrap.fill(line, LETTERS_IN_COLUMN) for line in note.split("\n"))
        figure.suptitle(note, fontsize="medium")
    return figure


def _plot_error_points_and_return_whether_any_exist(
    axes: Any, rows: Sequence[Mapping[str, Any]], name: str
) -> bool:
    """Draw the points of one quantity into a panel, and return whether there is a point."""
    tolerances = sorted({row["tolerance"] for row in rows}, reverse=True)
    drawn = False
    for tolerance, (mark, color) in zip(
        tolerances, MARK_AND_COLOUR_OF_EACH_TOLERANCE, strict=False
    ):
        # Points with a well-known true error are drawn in full colour and get a label. The other
        # points are drawn pale.
        own = [row for row in rows if row["tolerance"] == tolerance]
        for known in (True, False):
            points = [
                point
                for row in own
                if (point := _true_error_and_stated_ratio_of_row(row, name, known)) is not None
            ]
            if not points:
                continue
            true, ratios = zip(*points, strict=True)
            axes.loglog(
                100 * np.array(true),
                ratios,
                marker=mark,
                color=color,
                alpha=0.8 if known else 0.25,
                ls="",
                ms=4,
                label=f"tolerance {100 * tolerance:g} %" if known else None,
            )
            drawn = True
    return drawn


def _true_error_and_stated_ratio_of_row(
    row: Mapping[str, Any], name: str, known: bool
) -> tuple[float, float] | None:
    """The coordinates of a row's point: true error of a quantity, ratio of stated to true error.

    The result is None if one of the errors is missing or zero. With `known` true, the result is
    None as well if the true error is not well known. With `known` false, it is None if the true
    error is well known.
    """
    stated = float(row.get(f"stated_{name}", math.nan))
    true = float(row.get(f"true_{name}", math.nan))
    unsure = float(row.get(f"unsure_{name}", math.nan))
    if (
        not (stated > 0 and true > 0)
        or (true > LEAST_ERROR_OVER_UNCERTAINTY_OF_DARK_POINT * unsure) != known
    ):
        return None
    return true, stated / true


def plot_cumulative_shares_of_stated_over_true_ratios(ratios: Mapping[str, Floats]) -> Figure:
    """Figure of distributions: share of refinement levels with a stated/true ratio below a value.

    The figure has a line for each quantity.

    ratios : the ratios (n,) of stated to true error for each quantity.
    """
    with mpl.rc_context(MATPLOTLIB_SETTINGS_FOR_PRINT):
        figure = make_figure_for_print(3.6)
        axes = figure.subplots()
        for (name, values), (_, color) in zip(
            ratios.items(), MARK_AND_COLOUR_OF_EACH_TOLERANCE, strict=True
        ):
            # The percentage of ratios up to each ratio, plotted over the sorted ratios, is the
            # cumulative distribution.
            percent = np.linspace(0, 100, len(values))
            axes.semilogx(
                np.sort(values), percent, color=color, label=PANEL_TITLES_BY_QUANTITY[name]
            )
        axes.axvline(1.0, color=INK, lw=1)
        axes.set_xlabel("stated over true error")
        axes.set_ylabel("share of the levels [%]")
        draw_legend_below_figure(figure, axes)
    return figure


def plot_errors_over_unknowns_of_levels(rows: Sequence[Mapping[str, Any]]) -> Figure:
    """Figure of the errors of pressure and torque against the cube root of a shoe's unknowns.

    The text "p = ..." beside each point is the polynomial degree of the hp elements.

    rows : rows of `orders.error_rows_of_hp_levels`.
    """
    with mpl.rc_context(MATPLOTLIB_SETTINGS_FOR_PRINT):
        figure = make_figure_for_print(3.6)
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
        axes.set_xlabel("cube root of the unknowns of a shoe")
        axes.set_ylabel("relative error")
        draw_legend_below_figure(figure, axes)
    return figure
