"""The cloud of stated over true errors, and the errors of finer and finer columns."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from drumlin.base.arrays import Floats
from drumlin.report.figures import STYLE, key
from drumlin.report.palette import BLUE, GREEN, INK, PURPLE, RED

TITLES = {
    "pressure": "pressure p (L2)",
    "torque": "torque",
    "peak": "peak pressure",
    "reaction": "hinge reaction",
}
MARKS = (("o", BLUE), ("s", RED), ("D", PURPLE), ("^", GREEN))  # a tolerance each
KNOWN = 4.0  # how far above the uncertainty of the truth a true error is known well
PALE = f"pale: the true error is less than {KNOWN:g} times the uncertainty of what stands for the truth"


def cloud(rows: Sequence[Mapping[str, Any]]) -> Figure:
    """Stated over true error against the true one: a panel for each quantity, a mark for each
    tolerance.
    """
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(10.4, 6.4), layout="constrained")
        tolerances = sorted({row["tolerance"] for row in rows}, reverse=True)
        drawn = None
        for axes, name in zip(figure.subplots(2, 2).flat, TITLES, strict=True):
            for tolerance, (mark, color) in zip(tolerances, MARKS, strict=False):
                for known in (True, False):
                    points = [
                        point
                        for row in rows
                        if row["tolerance"] == tolerance
                        for point in _point(row, name, known)
                    ]
                    label = f"tolerance {tolerance:g}" if known else None
                    style = {
                        "color": color,
                        "alpha": 0.8 if known else 0.25,
                        "ls": "",
                        "ms": 4,
                        "label": label,
                    }
                    if points:
                        axes.loglog(*zip(*points, strict=True), marker=mark, **style)
                        drawn = axes
            axes.axhline(1.0, color=INK, lw=1)
            axes.set_title(TITLES[name])
            axes.set_xlabel("true error")
            axes.set_ylabel("stated over true error")
        if drawn is not None:
            key(figure, drawn)
        figure.suptitle(PALE, fontsize="medium")
    return figure


def _point(row: Mapping[str, Any], name: str, known: bool) -> list[tuple[float, float]]:
    """(true, stated over true) of a row, if it has both and its true error is known well, or not."""
    stated, true, unsure = (
        float(row.get(f"{which}_{name}", math.nan)) for which in ("stated", "true", "unsure")
    )
    if not (stated > 0 and true > 0) or (true > KNOWN * unsure) != known:
        return []
    return [(true, stated / true)]


def shares(ratios: Mapping[str, Floats]) -> Figure:
    """Share of stated errors that are at most so many times the true one, a line for each quantity."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(6.4, 4.4), layout="constrained")
        axes = figure.subplots()
        for (name, found), (_, color) in zip(ratios.items(), MARKS, strict=True):
            axes.semilogx(
                np.sort(found), np.linspace(0, 100, len(found)), color=color, label=TITLES[name]
            )
        axes.axvline(1.0, color=INK, lw=1)
        axes.set_xlabel("stated over true error")
        axes.set_ylabel("share of the levels [%]")
        key(figure, axes)
    return figure


def levels(rows: Sequence[Mapping[str, Any]]) -> Figure:
    """Errors of p and of the torque over the cube root of the unknowns of a shoe, the degree beside
    each.
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
        key(figure, axes)
    return figure
