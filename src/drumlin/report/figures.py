"""Figures by matplotlib: pressures over the lining, convergence. Each function returns a figure to
save.
"""

import math
import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from drumlin.base.arrays import Floats
from drumlin.base.files import replacing
from drumlin.brake.surface import DRUM, FrictionSurface
from drumlin.report.palette import CATEGORIES, color_of, look_of
from drumlin.response.response import ShoeResponse

STYLE = {
    "font.size": 10,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#e3e8ed",
    "axes.axisbelow": True,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.titlesize": 10.5,
    "legend.frameon": False,
    "svg.hashsalt": "drumlin",
    "svg.fonttype": "path",
}
NAMES = {
    "fem": "finite elements",
    "sine": "sine law",
    "cosine": "cosine law",
    "block": "block formula",
    "uniform": "uniform pressure",
    "short": "short shoe",
    "pivoted": "shoe on a pivot",
    "linear": "long flat shoe",
    "rigid": "rigid shoe",
    "worn": "finite elements, worn in",
    "foundation": "elastic foundation",
    "lifted": "foundation, all lifted",
}


def save(figure: Figure, path: Path) -> Path:
    """Write a figure whole or not at all, the same bits for the same figure; the ending says the
    format.

    Returns `path`. A letter that the font lacks is drawn as a box.
    """
    with mpl.rc_context(STYLE), replacing(path) as partial, warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph .* missing from")
        figure.savefig(partial, dpi=160, metadata={"Date": None} if path.suffix == ".svg" else None)
    return path


def name_of(model: str) -> str:
    """A model's name for people."""
    return NAMES.get(model, model)


def key(figure: Figure, axes: Axes, **more: Any) -> None:
    """The key of some axes below the whole figure, where it covers no data; of what has a label
    twice, once.
    """
    handles, labels = axes.get_legend_handles_labels()
    once = dict(zip(labels, handles, strict=True))
    columns = min(len(once), max(2, int(figure.get_figwidth() / 2.2)))
    figure.legend(
        once.values(),
        once.keys(),
        **{"loc": "outside lower center", "ncols": columns, "fontsize": 9} | more,
    )


BOX = 0.11, 0.05  # half the width and height of a curve's name, of the axes


def name_curve(
    axes: Axes, x: Floats, curves: Sequence[Floats], which: int, words: str, color: str
) -> None:
    """Write a name beside curve `which` of some over x (n,), in its colour, where it lies on none;
    else nowhere.
    """
    low, high = axes.get_ylim()
    seen = np.clip((np.array(curves) - low) / (high - low), 0, 1)
    n = len(x)
    half = int(BOX[0] * n)
    best = 0.0, 0, 0.0
    for i in range(half, n - half):
        for side in (1, -1):
            y = seen[which, i] + side * 1.5 * BOX[1]
            free = np.abs(seen[:, i - half : i + half + 1] - y).min(axis=1) - BOX[1]
            others = np.delete(free, which).min(initial=1.0)
            if free[which] > 0 and others > best[0] and BOX[1] < y < 1 - BOX[1]:
                best = float(others), i, y
    if best[0]:
        axes.text(
            float(x[best[1]]),
            low + best[2] * (high - low),
            words,
            color=color,
            fontsize=9,
            ha="center",
            va="center",
        )


def mark_cut(axes: Axes, x: Floats, y: Floats, color: Any) -> None:
    """Mark where a curve leaves the axes at their top, as at a sharp edge, where the pressure has
    no bound.
    """
    top = axes.get_ylim()[1]
    beyond = y > top
    starts = np.flatnonzero(np.diff(np.concatenate([[0], beyond.astype(int), [0]])))
    for a, b in starts.reshape(-1, 2):
        at = a + int(np.argmax(y[a:b]))
        axes.plot(
            [x[at]],
            [top],
            "^",
            color=color,
            ms=6,
            clip_on=False,
            zorder=5,
            label="goes on beyond the axis",
        )


def smooth(shoe: ShoeResponse, points: int = 300) -> tuple[Floats, Floats]:
    """Angles [rad] and pressure [Pa] of a response for drawing: evenly spread, and its own nodes
    near the ends.
    """
    even = np.linspace(shoe.theta[0], shoe.theta[-1], points)
    near = np.minimum(shoe.theta - shoe.theta[0], shoe.theta[-1] - shoe.theta) < 3 * (
        even[1] - even[0]
    )
    theta = np.unique(np.concatenate([shoe.theta[near], even]))
    return theta, np.maximum(shoe.pressure_at(theta), 0.0)


def pressures(
    panels: Sequence[tuple[str, Mapping[str, ShoeResponse]]],
    columns: int = 2,
    *,
    surface: FrictionSurface = DRUM,
) -> Figure:
    """Pressure over the place on a surface: a panel (title, {model: response}) each.

    One pressure scale for all.

    A singular edge is cut off above the largest pressure away from the edges, and marked. Two
    curves have their names beside them, more a key below.
    """
    with mpl.rc_context(STYLE):
        columns = min(columns, len(panels))
        rows, few = (
            math.ceil(len(panels) / columns),
            max(len(responses) for _, responses in panels) <= 2,
        )
        figure = Figure(figsize=(5.2 * columns, 3.1 * rows), layout="constrained")
        grid = figure.subplots(rows, columns, squeeze=False, sharey=True)
        unit = surface.shown
        highest = max(shoe.peak_pressure for _, responses in panels for shoe in responses.values())
        for axes, (title, responses) in zip(grid.flat, panels, strict=False):
            axes.set_title(title)
            axes.set_xlabel(surface.figure_axis)
            axes.set_ylim(0, 1.12 * highest * 1e-6 if highest > 0 else 1)
            drawn = {model: smooth(shoe) for model, shoe in responses.items()}
            for model, (theta, p) in drawn.items():
                axes.plot(theta * unit, p * 1e-6, **look_of(model), lw=1.8, label=name_of(model))
                mark_cut(axes, theta * unit, p * 1e-6, color_of(model))
                if model == "fem":
                    axes.fill_between(
                        theta * unit, p * 1e-6, color=color_of(model), alpha=0.12, lw=0
                    )
            axes.set_xlim(theta[0] * unit - 3, theta[-1] * unit + 3)
            axes.tick_params(labelleft=axes in grid[:, 0])
            if few:
                even = np.linspace(theta[0], theta[-1], 200)
                lines = [np.interp(even, *curve) * 1e-6 for curve in drawn.values()]
                for i, model in enumerate(drawn):
                    name_curve(axes, even * unit, lines, i, name_of(model), color_of(model))
        for axes in grid[:, 0]:
            axes.set_ylabel("pressure p [MPa]")
        for k in range(columns):
            below = list(grid.flat)[k : len(panels) : columns]
            if (
                len({axes.get_xlim() for axes in below}) == 1
            ):  # then the lowest one says the angle for all
                for axes in below[:-1]:
                    axes.set_xlabel("")
                    axes.tick_params(labelbottom=False)
        for axes in grid.flat[len(panels) :]:
            axes.set_visible(False)
        key(
            figure,
            max(
                grid.flat[: len(panels)],
                key=lambda axes: len(set(axes.get_legend_handles_labels()[1])),
            ),
        )
    return figure


def convergence(series: Mapping[str, Sequence[tuple[int, float]]], ylabel: str) -> Figure:
    """Errors (as fractions) over the number of elements along the lining, log-log, a line for each
    name.
    """
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(6.2, 3.8), layout="constrained")
        axes = figure.subplots()
        for (name, values), marker, color in zip(
            series.items(), "osD^v<>", CATEGORIES, strict=False
        ):
            n, e = zip(*values, strict=True)
            axes.loglog(n, np.array(e) * 100, marker=marker, color=color, ms=5, lw=1.4, label=name)
        axes.set_xlabel("elements along the lining")
        axes.set_ylabel(f"{ylabel} [%]")
        axes.set_xticks(sorted({n for values in series.values() for n, _ in values}))
        axes.xaxis.set_major_formatter("{x:.0f}")
        axes.minorticks_off()
        key(figure, axes, ncols=1)
    return figure
