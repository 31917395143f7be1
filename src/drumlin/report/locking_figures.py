"""Figures of self-locking: the limit over stiffness, the torque towards it."""

from collections.abc import Mapping, Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from drumlin.report.figures import STYLE, color_of

SHADES = ("#0b6e99", "#2a9d5c", "#d19a1b")
Curve = tuple[Sequence[float], Sequence[float]]


def limits(panels: Sequence[tuple[str, Mapping[str, Curve]]], law: float) -> Figure:
    """mu_lock over the factor on the stiffness of each panel's part: (part, {name: (factors, limits)})."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(5.2 * len(panels), 3.6), layout="constrained")
        grid = figure.subplots(1, len(panels), squeeze=False, sharey=True)
        for axes, (part, curves) in zip(grid.flat, panels, strict=True):
            for (name, (x, y)), color in zip(curves.items(), SHADES, strict=False):
                axes.semilogx(x, y, marker="o", ms=3, lw=1.6, color=color, label=name)
            axes.axhline(law, color=color_of("sine"), ls="--", lw=1.4, label="sine law")
            axes.set_title(f"Stiffness of the {part}")
            axes.set_xlabel(f"modulus of the {part}, times its own [-]")
            axes.legend()
        grid[0, 0].set_ylabel("limit of self-locking μ [-]")
    return figure


def poles(rows: Sequence[Mapping[str, Any]]) -> Figure:
    """Torque over friction with both limits, and torque times the distance from the limit over that distance.

    rows: `name`, `mu`, `torque` [N m], `mu_lock`, `law_mu`, `law_torque` [N m], `law`.
    """
    with mpl.rc_context(STYLE):
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
            row["law_mu"], np.array(row["law_torque"]) * 1e-3, color=color_of("sine"), ls="--", lw=1.6, label="sine law"
        )
        left.axvline(row["law"], color=color_of("sine"), lw=1, ls=":")
        left.set_ylim(0, highest * 1e-3)
        left.set_xlim(0, 1.08 * max(row["mu_lock"] for row in rows))
        left.set_title("Torque towards the limits (dotted)")
        left.set_xlabel("friction coefficient μ [-]")
        left.set_ylabel("torque T [kN m]")
        left.legend(loc="upper left", fontsize=8.5)
        right.invert_xaxis()
        right.set_title("Torque times distance from its limit")
        right.set_xlabel("distance from the limit 1 − μ/μ_lock [-]")
        right.set_ylabel("T (μ_lock − μ) [N m]")
        right.legend()
    return figure
