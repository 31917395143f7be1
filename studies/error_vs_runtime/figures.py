"""Figures of error over run time, and of predicted over true changes by omissions."""

from collections.abc import Mapping, Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from drumlin.report.figures import (
    FULL_WIDTH,
    LARGEST_HEIGHT,
    MATPLOTLIB_SETTINGS_FOR_PRINT,
    make_figure_for_print,
    number_of_panels_side_by_side,
)
from drumlin.report.palette import (
    BLUE,
    BROWN,
    COLOR_OF_AXES_AND_NOTES,
    COLOR_OF_SHADED_AREAS,
    GREEN,
    GREY,
    INK,
    OCHRE,
    PURPLE,
    RED,
    SKY,
)
from drumlin_studies.tables import rows_with_given_values, values_of_key_in_rows
from drumlin_studies.work_precision import converged_rows_by_mesh_series

COLORS = {
    "law": COLOR_OF_AXES_AND_NOTES,
    "foundation": GREEN,
    "even mesh": GREY,
    "graded mesh": BLUE,
    "columns": RED,
    "columns, error stated": RED,
    "weak penalty": SKY,
    "pointwise penalty": OCHRE,
    "GetFEM": PURPLE,
    "CalculiX": BROWN,
}
MARKERS = {
    "quad2": "s",
    "quad1": "D",
    "tri2": "^",
    "tri1": "v",
    "sine": "*",
    "cosine": "P",
    "uniform": "X",
}
FAMILY_NAMES = {
    "law": "laws",
    "foundation": "elastic foundation",
    "even mesh": "uniform mesh",
    "graded mesh": "graded mesh",
    "columns": "hp elements",
    "columns, error stated": "hp elements, error stated",
}
"""Name of each family in the figure, where it differs from the name in the rows."""
MARKER_NAMES = {
    "quad2": "quadratic quadrilaterals",
    "quad1": "linear quadrilaterals",
    "tri2": "quadratic triangles",
    "tri1": "linear triangles",
    "sine": "sine law",
    "cosine": "cosine law",
    "uniform": "uniform pressure",
}
"""Name of each marker in the figure."""
PANELS = {
    "torque_error": "error of the torque [%]",
    "pressure_error": "error of the pressure (L2), worst shoe [%]",
}
LOOKS = {
    "ring": ("o", BLUE),
    "coupling": ("D", PURPLE),
    "shoe": ("s", RED),
    "backing": ("^", GREEN),
    "drag": ("v", OCHRE),
    "curvature": ("P", GREY),
    "all but curvature": ("*", INK),
}
"""Marker and colour of each omission."""
LEAST = 1e-6
"""Relative change below which an omission is not drawn."""
CHANGES = (("shoes", "torques of the shoes"), ("pressure", "pressure (L2), worst shoe"))
"""The changes that are drawn, and what changes in each panel."""


def draw_error_over_time(
    title: str,
    rows: Sequence[Mapping[str, Any]],
    floors: Mapping[str, float],
    width: float = FULL_WIDTH,
) -> Figure:
    """Errors of torque and p over the time of a cold solve.

    Errors below the uncertainty of the reference are shaded. A marker is a solve, a colour a family
    of methods. `width` [inches] is FULL_WIDTH or COLUMN_WIDTH.
    """
    with mpl.rc_context(MATPLOTLIB_SETTINGS_FOR_PRINT):
        columns = number_of_panels_side_by_side(width, 2)
        figure = make_figure_for_print(4.6 if columns == 2 else LARGEST_HEIGHT, width)
        grid = figure.subplots(2 // columns, columns, squeeze=False).ravel()
        for axes, (key, label) in zip(grid, PANELS.items(), strict=True):
            _draw_error_panel(axes, rows, key, floors[key])
            axes.set_ylabel(label)
            axes.set_xlabel("run time of a cold solve [ms]")
        grid[0].set_title(title)
        # The key names families by colour and kinds of elements by marker.
        handles: list[Any] = []
        for family in _converged_families(rows):
            handles.append(
                mpl.lines.Line2D(
                    [],
                    [],
                    color=COLORS[family],
                    ls=_line_style(family, "") or "-",
                    lw=2,
                    label=FAMILY_NAMES.get(family, family),
                )
            )
        marks = set()
        for _, series_ in converged_rows_by_mesh_series(rows):
            marks.add(series_.split(",")[0])
        for name, marker in MARKERS.items():
            if name in marks:
                handles.append(
                    mpl.lines.Line2D(
                        [],
                        [],
                        color=COLOR_OF_AXES_AND_NOTES,
                        marker=marker,
                        ls="",
                        ms=5,
                        label=MARKER_NAMES[name],
                    )
                )
        if any("lower" in row for row in rows):
            words = "bars: quartiles of the repeats"
            handles.append(
                mpl.lines.Line2D(
                    [], [], color=COLOR_OF_AXES_AND_NOTES, marker="|", ms=7, label=words
                )
            )
        if any(name.endswith("even") for _, name in converged_rows_by_mesh_series(rows)):
            words = "dotted: peer on a uniform mesh"
            handles.append(
                mpl.lines.Line2D([], [], color=COLOR_OF_AXES_AND_NOTES, ls=":", lw=1.5, label=words)
            )
        words = "uncertainty of the reference"
        handles.append(mpl.patches.Patch(color=COLOR_OF_SHADED_AREAS, label=words))
        figure.legend(
            handles=handles,
            loc="outside lower center",
            ncols=number_of_panels_side_by_side(width, 3),
        )
    return figure


def _converged_families(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """The families with a converged row, in the order of COLORS."""
    found = set()
    for row in rows:
        if row["status"] == "converged":
            found.add(row["family"])
    return [family for family in COLORS if family in found]


def _line_style(family: str, name: str) -> str:
    """Line style of a series: dotted on uniform meshes, dashed where the error is stated."""
    if family == "law":
        return ""
    return ":" if name.endswith("even") else "--" if family.endswith("stated") else "-"


def _draw_error_panel(axes: Any, rows: Sequence[Mapping[str, Any]], key: str, floor: float) -> None:
    """Draw the errors `key` of all methods over the time of a cold solve."""
    # Below the uncertainty of the reference an error is drawn at a third of it.
    lowest = max(100 * floor, 1e-8)
    smallest = lowest / 3
    for (family, name), members in converged_rows_by_mesh_series(rows).items():
        seconds = np.array(values_of_key_in_rows(members, "seconds")) * 1e3
        error = np.maximum(np.array(values_of_key_in_rows(members, key)) * 100, smallest)
        spread = (
            np.array(
                [[row["seconds"] - row["lower"], row["upper"] - row["seconds"]] for row in members]
            ).T
            * 1e3
        )
        # Families that are not recommended are drawn lighter.
        light = family in {"even mesh", "weak penalty"}
        axes.errorbar(
            seconds,
            error,
            xerr=spread,
            color=COLORS[family],
            marker=MARKERS.get(name.split(",")[0], "o"),
            ms=7 if family == "law" else 3.5,
            lw=1.0 if light else 1.5,
            alpha=0.75 if light else 1.0,
            ls=_line_style(family, name),
            elinewidth=0.8,
        )
    axes.set_xscale("log")
    axes.set_yscale("log")
    top = 100 * max(values_of_key_in_rows(rows_with_given_values(rows, status="converged"), key))
    axes.set_ylim(smallest * 0.8, 2.0 * max(top, lowest))
    axes.axhspan(smallest * 0.8, lowest, color=COLOR_OF_SHADED_AREAS, alpha=0.7, lw=0)
    axes.xaxis.set_major_formatter("{x:g}")
    axes.minorticks_off()


def draw_predicted_changes(rows: Sequence[Mapping[str, Any]]) -> Figure:
    """Predicted over true changes of the shoes' torques and of p, a marker for each omission.

    On the line both are equal, in the band within a factor of two. Changes below LEAST are not
    drawn. rows : from `omission_table.table_rows_for_each_part_omitted_from_brake`.
    """
    with mpl.rc_context(MATPLOTLIB_SETTINGS_FOR_PRINT):
        figure = make_figure_for_print(4.1)
        grid = figure.subplots(1, len(CHANGES))
        for axes, (key, title) in zip(grid, CHANGES, strict=True):
            for part, (marker, color) in LOOKS.items():
                points = []
                for row in rows:
                    if (
                        row["part"] == part
                        and min(row.get(key) or 0.0, row.get(f"predicted_{key}") or 0.0) > LEAST
                    ):
                        points.append((row[key], row[f"predicted_{key}"]))
                if points:
                    x, y = zip(*points, strict=True)
                    axes.plot(
                        100 * np.array(x),
                        100 * np.array(y),
                        marker,
                        ms=7 if marker != "*" else 10,
                        color=color,
                        mec="white",
                        mew=0.6,
                        ls="",
                        label=part,
                    )
            # On the line the prediction is exact; in the band it is within a factor of two.
            ends = [100 * LEAST, 1000]
            axes.plot(ends, ends, color=INK, lw=1, zorder=1)
            axes.fill_between(
                ends, [v / 2 for v in ends], [v * 2 for v in ends], color=BLUE, alpha=0.10, lw=0
            )
            axes.set(xscale="log", yscale="log", xlim=ends, ylim=ends, aspect="equal")
            axes.set_title(f"Change of the {title}")
            axes.set_xlabel("true change [%]")
        grid[0].set_ylabel("change predicted beforehand [%]")
        handles = {
            h.get_label(): h for axes in grid for h in axes.get_lines() if h.get_marker() != "None"
        }
        figure.legend(
            handles.values(),
            handles.keys(),
            loc="outside lower center",
            ncols=4,
            title="what is left out",
        )
    return figure
