"""The figure of the ranges in which plane stress is right to 1, 5 and 20 %."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from drumlin.brake.brake import Brake
from drumlin.fem.width.ladder import has_shoe_with_parts_of_different_widths
from drumlin.report.figures import (
    FULL_WIDTH,
    LARGEST_HEIGHT,
    MATPLOTLIB_SETTINGS_FOR_PRINT,
    make_figure_for_print,
    number_of_panels_side_by_side,
)
from drumlin.report.palette import BLUE, ERROR_SCALE_COLORS, INK
from drumlin_studies.plane_stress_limits import (
    LIMITS_OF_PLANE_STRESS_ERROR,
    NAMES_OF_LIMITED_QUANTITIES,
    VARIED_QUANTITIES_OF_FIGURE_PANELS,
)

COLORS = {"one width": BLUE, "T-section": INK}
"""Colour of each varied brake."""
LINES = {"pressure": "-", "torque": "--"}
"""Line style of each quantity."""
LOWEST, HIGHEST = 0.1, 60.0
"""Ends of the axis of errors [%]."""
WIDE_RANGE = 20.0
"""Largest over smallest value of a quantity from which on its axis is logarithmic."""


def marked_values(brakes: Mapping[str, Brake]) -> dict[str, dict[str, float]]:
    """The value of each varied quantity on the brakes themselves, by quantity and brake's name."""
    found: dict[str, dict[str, float]] = {}
    for variation in VARIED_QUANTITIES_OF_FIGURE_PANELS:
        own = {}
        for name, brake in brakes.items():
            if not variation.needs_web or has_shoe_with_parts_of_different_widths(brake):
                own[name] = variation.value(brake)
        found[variation.name] = own
    return found


def draw_plane_stress_limits(
    rows: Sequence[Mapping[str, Any]],
    usual: Mapping[str, Mapping[str, float]],
    width: float = FULL_WIDTH,
) -> Figure:
    """Errors of plane stress over each varied quantity, on bands that end at the limits.

    Parameters
    ----------
    rows : from `rows_of_plane_stress_limits`
    usual : values of the brakes that are varied, by quantity and brake; a drawn one has a full mark
    width : width of the figure [inches], FULL_WIDTH or COLUMN_WIDTH
    """
    names = list(dict.fromkeys(row["varied"] for row in rows))
    with mpl.rc_context(MATPLOTLIB_SETTINGS_FOR_PRINT):
        columns = number_of_panels_side_by_side(width, (len(names) + 1) // 2)
        lines = math.ceil(len(names) / columns)
        figure = make_figure_for_print(min(2.2 * lines + 0.8, LARGEST_HEIGHT), width)
        grid = figure.subplots(lines, columns, sharey=True, squeeze=False)
        for axes, name in zip(grid.flat, names, strict=False):
            own = [row for row in rows if row["varied"] == name]
            _draw_limits_of_quantity(axes, own, usual.get(name, {}))
            axes.set_xlabel(name)
        for axes in grid[:, 0]:
            axes.set_ylabel(
                "error of plane stress [%]" if columns > 1 else "error of\nplane stress [%]"
            )
        for axes in grid.flat[len(names) :]:
            axes.set_visible(False)
        handles: list[Any] = []
        for brake, color in COLORS.items():
            for quantity, said in NAMES_OF_LIMITED_QUANTITIES.items():
                handles.append(
                    mpl.lines.Line2D(
                        [], [], color=color, ls=LINES[quantity], label=f"{brake}: {said}"
                    )
                )
        handles.append(
            mpl.lines.Line2D([], [], color=INK, marker="o", ls="", ms=5, label="the brake itself")
        )
        legend_columns = number_of_panels_side_by_side(width, 2)
        figure.legend(handles=handles, loc="outside lower center", ncols=legend_columns)
    return figure


def _draw_limits_of_quantity(
    axes: Axes, rows: Sequence[Mapping[str, Any]], usual: Mapping[str, float]
) -> None:
    """Draw the errors of all brakes over one quantity; `usual` has a value for each brake."""
    ends = (LOWEST, *(100 * limit for limit in LIMITS_OF_PLANE_STRESS_ERROR), HIGHEST)
    for low, high, color in zip(ends[:-1], ends[1:], ERROR_SCALE_COLORS, strict=True):
        axes.axhspan(low, high, color=color, alpha=0.35, lw=0)
    for brake, color in COLORS.items():
        own = [row for row in rows if row["brake"] == brake]
        for quantity, line in LINES.items():
            x = np.array([row["value"] for row in own])
            y = np.array([max(100 * row[quantity], LOWEST) for row in own])
            axes.plot(x, y, ls=line, color=color, marker="o", ms=3, mfc="white", lw=1.3)
            at = np.isclose(x, usual.get(brake, np.nan))
            axes.plot(x[at], y[at], ls="", color=color, marker="o", ms=5)
    values = [row["value"] for row in rows]
    if min(values) > 0 and max(values) / min(values) > WIDE_RANGE:
        axes.set_xscale("log")
        axes.xaxis.set_major_formatter("{x:g}")
    axes.set_yscale("log")
    axes.set_ylim(LOWEST, HIGHEST)
    # Smaller errors are drawn at the lower end of the axis.
    ticks = [100 * limit for limit in LIMITS_OF_PLANE_STRESS_ERROR]
    axes.set_yticks([LOWEST, *ticks], [f"≤ {LOWEST:g}", *map("{:g}".format, ticks)])
    axes.minorticks_off()
    axes.grid(False)
