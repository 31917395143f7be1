"""Figures of outcomes and digits, of soft penalties, and of self-locking."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle

from drumlin.report.figures import MATPLOTLIB_SETTINGS_FOR_SCREEN, draw_legend_below_figure
from drumlin.report.palette import (
    BLUE,
    BROWN,
    GREEN,
    GREY,
    INK,
    OCHRE,
    PURPLE,
    RED,
    SKY,
    color_of_model,
)
from drumlin_studies.tables import rows_with_given_values, values_of_key_in_rows

COLORS = {
    "answer": BLUE,
    "no contact": SKY,
    "self-locking": OCHRE,
    "out of reach": GREY,
    "no equilibrium": BROWN,
    "arithmetic": RED,
    "bad input": PURPLE,
    "not converged": "#000000",
    "traceback": "#000000",
    "inaccurate": "#000000",
}
"""Colours of outcomes: blue for answers, warm colours for refusals, black for faults."""
LEVELS = [0, 4, 6, 8, 10, 12, 14, 16]
"""Borders of the classes of digits, each with a colour of DIGITS."""
DIGITS = ListedColormap([RED, OCHRE, "#efe3b0", "#cfe3d4", "#8fc4b7", "#3f93a8", "#0b5a80"])
REFUSED = "#e6e6e6"

SHADES = (BLUE, GREEN, OCHRE)

Row = Mapping[str, Any]


def draw_outcome_strips(rows: Sequence[Row], knobs: Sequence[str]) -> Figure:
    """The cases of each sweep as cells of a line, coloured by outcome, with their digits."""
    with mpl.rc_context(MATPLOTLIB_SETTINGS_FOR_SCREEN | {"axes.grid": False}):
        longest = max(len(rows_with_given_values(rows, knob=knob)) for knob in knobs)
        figure = Figure(figsize=(12.5, 0.36 * len(knobs) + 1.5), layout="constrained")
        axes = figure.subplots()
        # One line of cells for each sweep; a cell without a number has no answer.
        for line, knob in enumerate(knobs):
            for place, row in enumerate(rows_with_given_values(rows, knob=knob)):
                color = COLORS[row["outcome"]]
                axes.add_patch(Rectangle((place, line), 0.94, 0.84, color=color, lw=0))
                if row.get("digits") is not None:
                    axes.text(
                        place + 0.47,
                        line + 0.45,
                        f"{row['digits']:.0f}",
                        ha="center",
                        va="center",
                        color="white",
                        fontsize=7,
                    )
        axes.set_xlim(0, longest)
        axes.set_ylim(len(knobs), 0)
        axes.set_yticks(np.arange(len(knobs)) + 0.42, knobs)
        axes.set_xticks([])
        axes.tick_params(length=0)
        for side in ("left", "bottom"):
            axes.spines[side].set_visible(False)
        _draw_outcome_legend(figure, rows)
    return figure


def draw_outcome_grids(rows: Sequence[Row], x: str, y: str, labels: tuple[str, str]) -> Figure:
    """Outcome and digits over two knobs, with even distances of their values."""
    knobs = values_of_key_in_rows(rows, "knobs")
    across, up = (sorted(set(values_of_key_in_rows(knobs, name))) for name in (x, y))
    with mpl.rc_context(MATPLOTLIB_SETTINGS_FOR_SCREEN | {"axes.grid": False}):
        figure = Figure(figsize=(12.5, 0.36 * len(up) + 2.1), layout="constrained")
        left, right = figure.subplots(1, 2, sharey=True)
        norm = BoundaryNorm(LEVELS, DIGITS.N)
        for row in rows:
            # Both panels show the same case in the same cell.
            at = (across.index(row["knobs"][x]), up.index(row["knobs"][y]))
            left.add_patch(Rectangle(at, 0.96, 0.94, color=COLORS[row["outcome"]], lw=0))
            digits = row.get("digits")
            color = REFUSED if digits is None else DIGITS(norm(min(digits, 15.99)))
            right.add_patch(Rectangle(at, 0.96, 0.94, color=color, lw=0))
            if digits is not None:
                dark = digits >= 12 or digits < 4
                right.text(
                    at[0] + 0.48,
                    at[1] + 0.47,
                    f"{digits:.1f}",
                    ha="center",
                    va="center",
                    fontsize=8,
                    color="white" if dark else INK,
                )
        for axes, title in ((left, "outcome"), (right, "digits of the torque")):
            axes.set_title(title)
            axes.set_xlim(0, len(across))
            axes.set_ylim(0, len(up))
            axes.set_xticks(np.arange(len(across)) + 0.48, list(map(tick_label, across)))
            axes.set_yticks(np.arange(len(up)) + 0.47, list(map(tick_label, up)))
            axes.tick_params(length=0)
            axes.set_xlabel(labels[0])
        left.set_ylabel(labels[1])
        _draw_outcome_legend(figure, rows)
    return figure


def draw_digits_over_condition(rows: Sequence[Row]) -> Figure:
    """Digits of the torque over its condition.

    A line shows the digits that the condition leaves to double precision.
    """
    with mpl.rc_context(MATPLOTLIB_SETTINGS_FOR_SCREEN):
        figure = Figure(figsize=(7.2, 4.2), layout="constrained")
        axes = figure.subplots()
        for again, color, label in (
            (False, BLUE, "condensed bodies, double precision"),
            (True, RED, "refined: condensation had lost too many digits"),
        ):
            chosen = []
            for r in rows:
                if r.get("torque_condition") and r["refined"] is again:
                    chosen.append(r)
            axes.semilogx(
                values_of_key_in_rows(chosen, "torque_condition"),
                values_of_key_in_rows(chosen, "digits"),
                "o",
                ms=4,
                alpha=0.65,
                color=color,
                mec="none",
                label=label,
            )
        # Double precision leaves the digits of 1/(condition times machine precision).
        k = np.array([1.0, 1e16])
        left = -np.log10(k * np.finfo(float).eps)
        axes.semilogx(
            k, left, color=INK, lw=1.2, label="what its condition leaves to double precision"
        )
        axes.axhline(6, color=RED, lw=1, ls=":")
        axes.set_xlim(1, 1e15)
        axes.set_ylim(0, 16.5)
        axes.set_xlabel("condition of the torque relative to each entry of the whole system [–]")
        axes.set_ylabel("digits of the torque that survive")
        draw_legend_below_figure(figure, axes, ncols=1)
    return figure


def draw_change_by_penalty(series: Mapping[str, Sequence[tuple[float, float]]]) -> Figure:
    """Relative change of the torque by a finite penalty, over the penalty, and a slope of -1."""
    with mpl.rc_context(MATPLOTLIB_SETTINGS_FOR_SCREEN):
        figure = Figure(figsize=(7.2, 4.2), layout="constrained")
        axes = figure.subplots()
        for (name, values), marker, color in zip(series.items(), "os", (BLUE, RED), strict=False):
            penalty, change = np.array([(a, e) for a, e in values if e > 0]).T
            axes.loglog(penalty, change, marker=marker, ms=5, lw=1.3, color=color, label=name)
            middle = np.flatnonzero(penalty >= 1e3)[0]
            # A dashed guide of slope -1 runs beside the curve.
            guide = penalty[middle - 1 : middle + 7]
            axes.loglog(
                guide, 2.5 * change[middle] * penalty[middle] / guide, color=GREY, lw=1, ls="--"
            )
        axes.plot([], [], color=GREY, lw=1, ls="--", label="slope −1")
        axes.axhline(1e-5, color=RED, lw=1, ls=":")
        axes.axvline(1e6, color=GREY, lw=0.8, ls=":")
        axes.set_xlabel("penalty, multiple of E/t of the lining [–]")
        axes.set_ylabel("|torque / torque of exact contact − 1| [–]")
        draw_legend_below_figure(figure, axes)
    return figure


def draw_locking_limits(
    panels: Sequence[tuple[str, Mapping[str, Sequence[Row]]]], law: float
) -> Figure:
    """Friction that locks the brake over the stiffness of a part, a panel for each part.

    Parameters
    ----------
    panels : sequence of pairs
        Name of a part, and rows by name of the curve.
    law : float
        Friction that locks the brake by the sine law.
    """
    with mpl.rc_context(MATPLOTLIB_SETTINGS_FOR_SCREEN):
        figure = Figure(figsize=(5.2 * len(panels), 3.6), layout="constrained")
        grid = figure.subplots(1, len(panels), squeeze=False, sharey=True)
        for axes, (part, curves) in zip(grid.flat, panels, strict=True):
            for (name, rows), color in zip(curves.items(), SHADES, strict=False):
                x, y = values_of_key_in_rows(rows, "factor"), values_of_key_in_rows(rows, "mu_lock")
                axes.semilogx(x, y, marker="o", ms=3, lw=1.6, color=color, label=name)
            axes.axhline(law, color=color_of_model("sine"), ls="--", lw=1.4, label="sine law")
            axes.set_title(f"Stiffness of the {part}")
            axes.set_xlabel(f"modulus of the {part}, times its own [–]")
        draw_legend_below_figure(figure, grid[0, 0])
        grid[0, 0].set_ylabel("limit of self-locking μ [–]")
    return figure


def draw_torque_poles(rows: Sequence[Row]) -> Figure:
    """Torque over friction, and torque times distance from the limit over this distance.

    rows : `name`, `mu`, `torque` [N m], `mu_lock`, `law_mu`, `law_torque` [N m], `law`.
    """
    with mpl.rc_context(MATPLOTLIB_SETTINGS_FOR_SCREEN):
        figure = Figure(figsize=(10.4, 3.8), layout="constrained")
        left, right = figure.subplots(1, 2)
        highest = 6e3
        for row, color in zip(rows, SHADES, strict=False):
            mu, T, end = np.array(row["mu"]), np.array(row["torque"]), row["mu_lock"]
            left.plot(mu, T * 1e-3, color=color, lw=1.8, label=f"finite elements, {row['name']}")
            left.axvline(end, color=color, lw=1, ls=":")
            right.loglog(1 - mu / end, T * (end - mu), color=color, lw=1.8, label=row["name"])
        row = rows[0]
        left.plot(
            row["law_mu"],
            np.array(row["law_torque"]) * 1e-3,
            color=color_of_model("sine"),
            ls="--",
            lw=1.6,
            label="sine law",
        )
        left.axvline(row["law"], color=color_of_model("sine"), lw=1, ls=":")
        left.set_ylim(0, highest * 1e-3)
        left.set_xlim(0, 1.08 * max(values_of_key_in_rows(rows, "mu_lock")))
        left.set_title("Torque towards the limits (dotted)")
        left.set_xlabel("friction coefficient μ [–]")
        left.set_ylabel("torque T [kN m]")
        draw_legend_below_figure(figure, left)
        right.invert_xaxis()
        right.set_title("Torque times distance from its limit")
        right.set_xlabel("distance from the limit $1 - \\mu/\\mu_\\mathrm{lock}$ [–]")
        right.set_ylabel("$T\\,(\\mu_\\mathrm{lock} - \\mu)$ [N m]")
    return figure


def tick_label(value: float) -> str:
    """A value as the label of a tick; powers of ten as powers."""
    if value == 0 or math.isinf(value):
        return "0" if value == 0 else "∞"
    power = math.log10(abs(value))
    if abs(power) >= 3 and abs(power - round(power)) < 1e-9:
        return f"$10^{{{round(power)}}}$"
    return f"{value:.3g}"


def _draw_outcome_legend(figure: Figure, rows: Sequence[Row]) -> None:
    """Draw the key of the outcomes that occur among the rows."""
    there = set()
    for row in rows:
        there.add(row["outcome"])
    handles = []
    for name, color in COLORS.items():
        if name in there:
            handles.append(Patch(color=color, label=name))
    figure.legend(handles=handles, loc="outside lower center", ncols=len(handles))
