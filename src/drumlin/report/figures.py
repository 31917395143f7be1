"""Figures by matplotlib: pressures over the lining, convergence. Each function returns a figure to save."""

import math
import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from drumlin.arrays import Floats
from drumlin.files import replacing
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
COLORS = {
    "fem": "#0b6e99",
    "sine": "#c8553d",
    "cosine": "#7a5195",
    "block": "#b58ad6",
    "uniform": "#8a8f98",
    "short": "#1d2733",
    "pivoted": "#d19a1b",
    "linear": "#6b8e23",
    "rigid": "#c8553d",
    "worn": "#2a9d5c",
    "foundation": "#2a9d5c",
    "lifted": "#d19a1b",
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
    """Write a figure whole or not at all, the same bits for the same figure; the ending says the format.

    Returns `path`. A letter that the font lacks is drawn as a box.
    """
    with mpl.rc_context(STYLE), replacing(path) as partial, warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph .* missing from")
        figure.savefig(partial, dpi=160, metadata={"Date": None} if path.suffix == ".svg" else None)
    return path


def name_of(model: str) -> str:
    """A model's name for people."""
    return NAMES.get(model, model)


def color_of(model: str) -> str:
    """A model's colour, the same in every figure."""
    return COLORS.get(model, "#444444")


def smooth(shoe: ShoeResponse, points: int = 300) -> tuple[Floats, Floats]:
    """Angles [rad] and pressure [Pa] of a response for drawing: evenly spread, and its own nodes near the ends."""
    even = np.linspace(shoe.theta[0], shoe.theta[-1], points)
    near = np.minimum(shoe.theta - shoe.theta[0], shoe.theta[-1] - shoe.theta) < 3 * (even[1] - even[0])
    theta = np.unique(np.concatenate([shoe.theta[near], even]))
    return theta, np.maximum(shoe.pressure_at(theta), 0.0)


def pressures(
    panels: Sequence[tuple[str, Mapping[str, ShoeResponse]]], columns: int = 2, *, flat: bool = False
) -> Figure:
    """Pressure over the angle on the drum, or over the place on a plane: a panel (title, {model: response}) each.

    One pressure scale for all.

    A singular edge is cut off at twice the largest pressure away from the edges.
    """
    with mpl.rc_context(STYLE):
        lines = math.ceil(len(panels) / columns)
        figure = Figure(figsize=(5.2 * columns, 3.1 * lines), layout="constrained")
        grid = figure.subplots(lines, columns, squeeze=False, sharey=True)
        unit = 1e3 if flat else math.degrees(1)
        highest = max(shoe.peak_pressure for _, responses in panels for shoe in responses.values())
        for axes, (title, responses) in zip(grid.flat, panels, strict=False):
            for model, shoe in responses.items():
                theta, p = smooth(shoe)
                axes.plot(theta * unit, p * 1e-6, color=color_of(model), lw=1.8, label=name_of(model))
                if model == "fem":
                    axes.fill_between(theta * unit, p * 1e-6, color=color_of(model), alpha=0.12, lw=0)
            axes.set_title(title)
            axes.set_xlabel("place x [mm]" if flat else "angle on the drum θ [deg]")
            axes.set_xlim(theta[0] * unit - 3, theta[-1] * unit + 3)
            axes.set_ylim(0, 1.12 * highest * 1e-6 if highest > 0 else 1)
            axes.label_outer(remove_inner_ticks=False)
        for axes in grid[:, 0]:
            axes.set_ylabel("pressure p [MPa]")
        for axes in grid.flat[len(panels) :]:
            axes.set_visible(False)
        grid.flat[0].legend(loc="best")
    return figure


def convergence(series: Mapping[str, Sequence[tuple[int, float]]], ylabel: str) -> Figure:
    """Errors (as fractions) over the number of elements along the lining, log-log, a line for each name."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(6.2, 3.8), layout="constrained")
        axes = figure.subplots()
        for (name, values), marker in zip(series.items(), "osD^v<>", strict=False):
            n, e = zip(*values, strict=True)
            axes.loglog(n, np.array(e) * 100, marker=marker, ms=5, lw=1.4, label=name)
        axes.set_xlabel("elements along the lining")
        axes.set_ylabel(f"{ylabel} [%]")
        axes.set_xticks(sorted({n for values in series.values() for n, _ in values}))
        axes.xaxis.set_major_formatter("{x:.0f}")
        axes.minorticks_off()
        axes.legend()
    return figure
