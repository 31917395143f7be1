"""Figures of misfit and tolerances: pressures, maps, one turn of the drum, distributions, shares of a variance."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import matplotlib as mpl
import numpy as np
from matplotlib import patheffects
from matplotlib.figure import Figure

from drumlin.arrays import Floats
from drumlin.report.figures import COLORS, STYLE, smooth
from drumlin.response.response import ShoeResponse
from drumlin.sweeps.tolerances import Shares, spread

NEW, WORN, LAW = "#0b6e99", "#2a9d5c", COLORS["sine"]
LEVELS = (-40, -30, -20, -15, -10, -5, 0, 5, 10, 20, 30, 50, 75, 100, 150, 200, 300, 500, 700, 1000)  # of a map [%]
TINTS = {NEW: "#a9d3e5", WORN: "#b5dfc6"}


def family(
    panels: Sequence[tuple[str, Mapping[float, ShoeResponse], ShoeResponse]], label: str, highest: float
) -> Figure:
    """p(theta) of misfits [um], from blue to red, and the law: a panel (title, {misfit: response}, law) each.

    Pressures are cut at `highest` [Pa].
    """
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(5.4 * len(panels), 3.7), layout="constrained")
        grid = figure.subplots(1, len(panels), squeeze=False, sharey=True)[0]
        values = list(panels[0][1])
        shade = mpl.colors.TwoSlopeNorm(0.0, 1.15 * min(values), 1.15 * max(values))
        for axes, (title, family_, law) in zip(grid, panels, strict=True):
            for value, shoe in family_.items():
                theta, p = smooth(shoe, 600)
                color = "#1d2733" if value == 0 else mpl.colormaps["coolwarm"](shade(value))
                axes.plot(
                    np.degrees(theta),
                    p * 1e-6,
                    color=color,
                    lw=2.0 if value == 0 else 1.6,
                    label=f"{value:+.0f} µm" if value else "fits",
                )
            axes.plot(np.degrees(law.theta), law.pressure * 1e-6, color=LAW, lw=1.8, ls="--", label="sine law")
            axes.set_title(title)
            axes.set_xlabel("angle on the drum θ [deg]")
            axes.set_ylim(0, highest * 1e-6)
        grid[0].set_ylabel("pressure p [MPa]")
        grid[-1].legend(title=label, fontsize=8, title_fontsize=8, loc="upper left", bbox_to_anchor=(1.01, 1.0))
    return figure


class Map(NamedTuple):
    """A quantity over two misfits: title, `ratio` (rows of y, columns of x) to the law's minus 1."""

    title: str
    ratio: Floats


def maps(x: Floats, y: Floats, both: Sequence[Map], xlabel: str, ylabel: str) -> Figure:
    """Maps over x and y [um] side by side, each with its contours in per cent, and the law's value as a thick line."""
    with mpl.rc_context(STYLE | {"axes.grid": False}):
        figure = Figure(figsize=(5.9 * len(both), 4.4), layout="constrained")
        grid = figure.subplots(1, len(both), squeeze=False)[0]
        for axes, one in zip(grid, both, strict=True):
            percent = 100 * one.ratio
            most = float(np.abs(percent).max())
            lines = [level for level in LEVELS if percent.min() < level < percent.max()]
            levels = [float(percent.min()), *lines, float(percent.max())]
            scale = mpl.colors.SymLogNorm(linthresh=20, linscale=1, vmin=-most, vmax=most)
            filled = axes.contourf(x, y, percent, levels=levels, cmap="RdBu_r", norm=scale)
            others = [level for level in lines if level]
            drawn = axes.contour(x, y, percent, levels=others, colors="#46525e", linewidths=0.6, linestyles="solid")
            for text in axes.clabel(drawn, fmt="%+.0f %%", fontsize=7.5):
                text.set_path_effects([patheffects.withStroke(linewidth=2, foreground="white")])
            axes.contour(x, y, percent, levels=[0.0], colors=LAW, linewidths=2.6)
            axes.plot([], [], color=LAW, lw=2.6, label="as the sine law says")
            axes.plot(0, 0, "o", color="#1d2733", ms=5, label="lining that fits")
            axes.set_title(one.title)
            axes.set_xlabel(xlabel)
            bar = figure.colorbar(filled, ax=axes, shrink=0.9, ticks=lines, format="%+.0f")
            bar.set_label("from the sine law [%]")
        grid[0].set_ylabel(ylabel)
        grid[0].legend(loc="lower left", fontsize=8, frameon=True)
    return figure


def turns(angles: Floats, panels: Sequence[tuple[str, Mapping[str, Floats]]], law: float) -> Figure:
    """Torque over one turn of the drum, angles [rad]: panels (title, {name: torque [N m]}), and the law's torque."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(5.6 * len(panels), 3.6), layout="constrained")
        grid = figure.subplots(1, len(panels), squeeze=False, sharey=True)[0]
        for axes, (title, series) in zip(grid, panels, strict=True):
            for (name, torque), color in zip(
                series.items(), ("#0b6e99", "#d19a1b", "#7a5195", "#2a9d5c"), strict=False
            ):
                axes.plot(
                    np.degrees(np.append(angles, 2 * np.pi)),
                    np.append(torque, torque[0]),
                    lw=1.8,
                    color=color,
                    label=name,
                )
            axes.axhline(law, color=LAW, lw=1.8, ls="--", label="sine law")
            axes.set_title(title)
            axes.set_xlabel("angle of the drum [deg]")
            axes.set_xlim(0, 360)
            axes.set_xticks(range(0, 361, 60))
        grid[0].set_ylabel("torque of the brake [N m]")
        grid[-1].legend(fontsize=8, loc="upper left", bbox_to_anchor=(1.01, 1.0))
    return figure


class Histogram(NamedTuple):
    """Draws of a quantity, new and worn in, in the unit that the axis names; the law's value of the nominal brake."""

    label: str
    new: Floats
    worn: Floats
    law: float


def histograms(panels: Sequence[Histogram]) -> Figure:
    """Distributions of new and worn-in brakes, with the 5th, 50th and 95th percentile above them."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(4.6 * len(panels), 3.9), layout="constrained")
        grid = figure.subplots(1, len(panels), squeeze=False)[0]
        for axes, one in zip(grid, panels, strict=True):
            every = np.concatenate([one.new, one.worn])
            bins = np.linspace(every.min(), np.quantile(every, 0.998), 36)
            counts = []
            for values, color, name in ((one.new, NEW, "new"), (one.worn, WORN, "worn in")):
                count, *_ = axes.hist(values, bins, color=color, alpha=0.45, label=name, density=True)
                counts.append(float(count.max()))
            top = max(counts)
            for values, color, height in ((one.new, NEW, 1.08), (one.worn, WORN, 1.17)):
                low, middle, high = np.percentile(values, (5, 50, 95))
                axes.plot([low, high], [height * top] * 2, color=color, lw=2)
                axes.plot([low, middle, high], [height * top] * 3, "|", color=color, ms=10, mew=2)
            axes.axvline(one.law, color=LAW, lw=1.8, ls="--", label="sine law, nominal")
            axes.set_xlabel(one.label)
            axes.set_yticks([])
            axes.set_ylim(0, 1.26 * top)
        grid[0].set_ylabel("density")
        grid[-1].legend(fontsize=8)
    return figure


def shares(panels: Sequence[tuple[str, Sequence[Shares]]]) -> Figure:
    """Sobol indices as bars with their confidence intervals, in the order of the first panel's totals."""
    with mpl.rc_context(STYLE):
        order = np.argsort([share.total.value for share in panels[0][1]])
        figure = Figure(figsize=(1.9 + 4.4 * len(panels), 0.6 + 0.4 * len(order)), layout="constrained")
        grid = figure.subplots(1, len(panels), squeeze=False, sharey=True)[0]
        at = np.arange(len(order))
        for axes, (title, found) in zip(grid, panels, strict=True):
            color = WORN if "worn" in title else NEW
            for kind, shift, fill in (("total", 0.19, TINTS[color]), ("first", -0.19, color)):
                index = [getattr(found[i], kind) for i in order]
                value = np.array([one.value for one in index])
                error = np.abs(np.array([[one.value - one.low, one.high - one.value] for one in index]).T)
                name = "with its interactions (total)" if kind == "total" else "alone (first order)"
                axes.barh(at + shift, np.maximum(value, 0), 0.36, color=fill, label=name)
                axes.errorbar(value, at + shift, xerr=error, fmt="none", ecolor="#1d2733", elinewidth=0.9, capsize=2)
            axes.set_title(title)
            axes.set_xlabel("share of the variance [–]")
            axes.set_xlim(-0.06, None)
            axes.axvline(0, color="#5b6875", lw=0.8)
            axes.set_yticks(at, [found[i].name for i in order])
            axes.grid(visible=False, axis="y")
            axes.legend(fontsize=8, loc="lower right")
    return figure


def narrowing(distances: Floats, panels: Sequence[tuple[str, Floats, float]]) -> Figure:
    """Percentiles over the sliding distance in units of 1/(k K): panels (label, values (draws, distances), law)."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(5.6 * len(panels), 3.7), layout="constrained")
        grid = figure.subplots(1, len(panels), squeeze=False)[0]
        for axes, (label, values, law) in zip(grid, panels, strict=True):
            rows = np.array([spread(column).percentiles for column in values.T]).T
            axes.fill_between(distances, rows[0], rows[4], color=WORN, alpha=0.15, lw=0, label="1st to 99th percentile")
            axes.fill_between(distances, rows[1], rows[3], color=WORN, alpha=0.3, lw=0, label="5th to 95th percentile")
            axes.plot(distances, rows[2], color=WORN, lw=2, label="median")
            axes.axhline(law, color=LAW, lw=1.8, ls="--", label="sine law, nominal")
            axes.set_xscale("symlog", linthresh=1.0)
            axes.set_xlim(0, distances[-1])
            axes.set_xlabel("sliding distance · k K [–]")
            axes.set_ylabel(label)
        grid[0].legend(fontsize=8)
    return figure
