"""Figure of what is left out of brakes: the predicted change over the true one."""

from collections.abc import Mapping, Sequence
from typing import Any

import matplotlib as mpl
from matplotlib.figure import Figure

from drumlin.report.figures import STYLE

LOOKS = {  # what is left out -> marker, colour
    "ring": ("o", "#0b6e99"),
    "coupling": ("D", "#7a5195"),
    "shoe": ("s", "#c8553d"),
    "backing": ("^", "#2a9d5c"),
    "drag": ("v", "#d19a1b"),
    "curvature": ("P", "#8a8f98"),
    "all but curvature": ("*", "#1d2733"),
}
LEAST = 1e-6  # changes below it are of no interest
PANELS = (("shoes", "shoes' torques (sum of sizes)"), ("pressure", "pressure p (L2, worst shoe)"))


def predictions(rows: Sequence[Mapping[str, Any]]) -> Figure:
    """Predicted over true change of the shoes' torques and of p, log-log, a marker for each thing left out.

    Line: equal; band: within a factor 2. rows: of `left_out.omissions`. Changes (fractions) below LEAST are not drawn.
    """
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(10.4, 4.4), layout="constrained")
        grid = figure.subplots(1, len(PANELS))
        for axes, (key, title) in zip(grid, PANELS, strict=True):
            for part, (marker, color) in LOOKS.items():
                points = [
                    (row[key], row[f"predicted_{key}"])
                    for row in rows
                    if row["part"] == part and min(row.get(key) or 0.0, row.get(f"predicted_{key}") or 0.0) > LEAST
                ]
                if points:
                    x, y = zip(*points, strict=True)
                    axes.plot(
                        [100 * v for v in x], [100 * v for v in y],
                        marker, ms=7 if marker != "*" else 10, color=color, mec="white", mew=0.6, ls="", label=part,
                    )  # fmt: skip
            ends = [100 * LEAST, 1000]
            axes.plot(ends, ends, color="#1d2733", lw=1, zorder=1)
            axes.fill_between(ends, [v / 2 for v in ends], [v * 2 for v in ends], color="#0b6e99", alpha=0.10, lw=0)
            axes.set(xscale="log", yscale="log", xlim=ends, ylim=ends, aspect="equal")
            axes.set_title(f"Change of the {title}")
            axes.set_xlabel("true change [%]")
        grid[0].set_ylabel("change predicted beforehand [%]")
        handles = {h.get_label(): h for axes in grid for h in axes.get_lines() if h.get_marker() != "None"}
        figure.legend(handles.values(), handles.keys(), loc="outside right center", title="left out")
    return figure
