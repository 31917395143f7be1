"""Figures of the post brake: beams, brake path, friction, clearance, and maps of a model's error."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import matplotlib as mpl
import numpy as np
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure

from drumlin.arrays import Floats
from drumlin.report.figures import STYLE, color_of, name_of

Curve = tuple[Floats, Floats]
BOUNDS = (0.0, 0.01, 0.05, 0.20, np.inf)  # regions of a map: error within 1, 5, 20 %, beyond
SHADES = ("#1f7a4d", "#8cc9a1", "#f2dda4", "#d98d78")


def curves(
    panels: Sequence[tuple[str, Mapping[str, Curve]]], xlabel: str, ylabel: str, columns: int = 2, *, zero: bool = False
) -> Figure:
    """Panels (title, {model: (x, y)}) side by side, one scale for all; a model's curve has its own colour.

    A model's name may go on after a space; the words behind it tell curves of one model apart, dashed.
    """
    with mpl.rc_context(STYLE):
        lines = -(-len(panels) // columns)
        figure = Figure(figsize=(5.2 * columns, 3.3 * lines), layout="constrained")
        grid = figure.subplots(lines, columns, squeeze=False, sharey=True)
        for axes, (title, models) in zip(grid.flat, panels, strict=False):
            for name, (x, y) in models.items():
                model, _, rest = name.partition(" ")
                points = len(x) < 12
                axes.plot(
                    x, y, marker="o" if points else None, ms=4, lw=0 if points else 1.8, ls="--" if rest else "-",
                    color=color_of(model), label=f"{name_of(model)} {rest}".strip(),
                )  # fmt: skip
            axes.set_title(title)
            axes.set_xlabel(xlabel)
            if zero:
                axes.axhline(0, color="#5b6875", lw=0.8)
        for axes in grid[:, 0]:
            axes.set_ylabel(ylabel)
        for axes in grid.flat[len(panels) :]:
            axes.set_visible(False)
        grid.flat[0].legend(fontsize=8)
    return figure


def rim(panels: Sequence[tuple[str, Mapping[str, Curve]]], scale: str) -> Figure:
    """Displacement around the rim in polar axes, inwards towards the centre: panels (title, {model: (theta, z)})."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(5.2 * len(panels), 4.8), layout="constrained")
        grid = figure.subplots(1, len(panels), squeeze=False, subplot_kw={"projection": "polar"})
        largest = max(float(np.abs(z).max()) for _, models in panels for _, z in models.values())
        for axes, (title, models) in zip(grid.flat, panels, strict=True):
            turn = np.linspace(0, 2 * np.pi, 200)
            axes.plot(turn, np.zeros(200), color="#1d2733", lw=1, label="unloaded")
            for (name, (theta, z)), style in zip(models.items(), ("-", "--", ":"), strict=False):
                model, _, rest = name.partition(" ")
                axes.plot(theta, -z, lw=1.8, ls=style, color=color_of(model), label=f"{name_of(model)}, {rest}")
            axes.set_ylim(-3 * largest, 1.3 * largest)
            axes.set_yticks([-largest, 0, largest], [f"{-v:+.2g}" for v in (-largest, 0, largest)], fontsize=7)
            axes.set_title(f"{title} [{scale}]")
            axes.legend(fontsize=7, loc="upper center", bbox_to_anchor=(0.5, -0.07), ncols=2)
    return figure


class Map(NamedTuple):
    """The error of a model over two groups: `x` (n,), `y` (m,), `error` (m, n) as fractions, nan where none."""

    title: str
    x: Floats
    y: Floats
    error: Floats


def maps(rows: Sequence[Sequence[Map]], xlabel: str, ylabel: str, mark: Sequence[tuple[float, float]]) -> Figure:
    """Maps of errors, one row each of `rows`; every cell is one pair of solutions, its number is the error in %.

    `mark`: in each row, the place of the study's own brake.
    """
    with mpl.rc_context(STYLE):
        columns = len(rows[0])
        figure = Figure(figsize=(4.3 * columns, 3.9 * len(rows)), layout="constrained")
        grid = figure.subplots(len(rows), columns, squeeze=False, sharex=True, sharey=True)
        shades = ListedColormap(SHADES)
        norm = BoundaryNorm([0, 1, 2, 3, 4], 4)
        for line, panels, place in zip(grid, rows, mark, strict=True):
            for axes, one in zip(line, panels, strict=True):
                region = np.digitize(np.abs(one.error), BOUNDS[1:-1])
                shown = np.ma.masked_where(np.isnan(one.error), region)
                axes.pcolormesh(_edges(one.x), _edges(one.y), shown, cmap=shades, norm=norm, edgecolor="white", lw=0.5)
                for i, y in enumerate(one.y):
                    for j, x in enumerate(one.x):
                        axes.text(x, y, f"{one.error[i, j] * 100:+.0f}", ha="center", va="center", fontsize=7)
                axes.plot(*place, marker="s", ms=15, mfc="none", mec="#1d2733", mew=1.4)
                axes.set_xscale("log")
                axes.set_yscale("log")
                axes.grid(False)
                axes.set_title(one.title, fontsize=9)
                axes.label_outer()
            line[0].set_ylabel(ylabel)
        for axes in grid[-1]:
            axes.set_xlabel(xlabel)
        words = ("within 1 %", "within 5 %", "within 20 %", "beyond 20 %")
        handles = [mpl.patches.Patch(color=shade, label=word) for shade, word in zip(SHADES, words, strict=True)]
        figure.legend(handles=handles, loc="outside lower center", ncols=4)
    return figure


def _edges(centres: Floats) -> Floats:
    """Edges (n + 1,) of cells round geometrically spaced centres (n,)."""
    ratio = np.sqrt(centres[1] / centres[0])
    return np.append(centres / ratio, centres[-1] * ratio)
