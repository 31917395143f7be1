"""Figures of the plane-stress study."""

from collections.abc import Mapping, Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from drumlin.arrays import Floats
from drumlin.report.figures import STYLE, key
from drumlin.report.palette import BLUE, GREEN, GREY, INK, PURPLE, RED
from drumlin.response.response import ShoeResponse, edge_zone
from drumlin.texts import formatted
from drumlin.verification.plane_stress import Map, Rung, Three, Worn, worst

LABELS = {
    "one width": ("lining width / thickness", "lining modulus [MPa]"),
    "table and web": ("web width / lining width", "table thickness [mm]"),
}
PANELS = {
    "torque": "torque",
    "pressure": "mean p over the width (L2)",
    "uneven": "p across the width off its mean",
    "corrected_torque": "torque, corrected",
}


def maps(charts: Sequence[Map]) -> Figure:
    """A row for each chart, a panel for each error of the worst shoe, in per cent."""
    with mpl.rc_context(STYLE | {"axes.grid": False}):
        figure = Figure(figsize=(15.5, 3.9 * len(charts)), layout="constrained")
        grid = figure.subplots(len(charts), len(PANELS), squeeze=False)
        for row, chart in zip(grid, charts, strict=True):
            for axes, (name, title) in zip(row, PANELS.items(), strict=True):
                _panel(axes, chart, name, f"{chart.name}: {title}")
    return figure


def _panel(axes: Axes, chart: Map, name: str, title: str) -> None:
    error = 100 * chart.errors[name]
    axes.imshow(np.log10(np.maximum(np.abs(error), 0.03)), origin="lower", aspect="auto", cmap="YlOrRd",
                vmin=-1.5, vmax=1.8)  # fmt: skip
    for j, i in np.ndindex(*error.shape):
        signed = name in {"torque", "corrected_torque"}
        said = formatted(float(error[j, i]), f"{'+' if signed else ''}.2g")
        color = "white" if abs(error[j, i]) > 18 else INK
        axes.text(i, j, said, ha="center", va="center", fontsize=9, color=color)
    x, y = LABELS[chart.name]
    axes.set_xticks(range(len(chart.x)), [f"{value:g}" for value in chart.x])
    axes.set_yticks(range(len(chart.y)), [f"{value:g}" for value in chart.y])
    axes.set_xlabel(x)
    axes.set_ylabel(y)
    axes.set_title(f"{title} [%]", fontsize=9.5)


def faces(three: Three, worn: Worn) -> Figure:
    """p(theta, z) on the faces of the linings, new and worn in, one scale."""
    with mpl.rc_context(STYLE | {"axes.grid": False}):
        new = three.solid.shoes
        figure = Figure(figsize=(11.5, 2.7 * len(new) + 0.8), layout="constrained")
        grid = figure.subplots(len(new), 2, squeeze=False)
        zones = [edge_zone(shoe, three.brake.drum.radius) for shoe in three.brake.shoes]
        top = max(_top(shoe, zone) for shoe, zone in zip(new, zones, strict=True))
        for row, a, b in zip(grid, new, worn.last, strict=True):
            for axes, shoe, state in ((row[0], a, "new"), (row[1], b, "worn in")):
                assert shoe.surface is not None
                drawn = axes.pcolormesh(
                    np.degrees(shoe.theta), shoe.surface.z * 1e3, shoe.surface.pressure.T * 1e-6,
                    shading="gouraud", cmap="viridis", vmin=0, vmax=top * 1e-6,
                )  # fmt: skip
                helps = "assists" if shoe.self_energising else "opposes"
                axes.set_title(f"{shoe.name}, friction {helps}, {state}")
                axes.set_xlabel("angle on the drum θ [deg]")
                axes.set_ylabel("z [mm]")
        figure.colorbar(drawn, ax=list(grid.flat), label="pressure p [MPa]", shrink=0.8)
    return figure


def _top(shoe: ShoeResponse, zone: float) -> float:
    assert shoe.surface is not None
    inside = (shoe.theta > shoe.theta[0] + zone) & (shoe.theta < shoe.theta[-1] - zone)
    return float(shoe.surface.pressure[inside].max())


def curves(found: Mapping[str, Sequence[tuple[float, list[dict[str, Any]]]]]) -> Figure:
    """Errors of the worst shoe over one quantity a panel."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(10.5, 3.8), layout="constrained")
        for axes, (name, points) in zip(np.ravel(figure.subplots(1, len(found), sharey=True)), found.items(),
                                        strict=True):  # fmt: skip
            x = [value for value, _ in points]
            for kind, label, marker in (
                ("torque", "torque", "o"),
                ("pressure", "p averaged over the width (L2)", "s"),
                ("reaction", "hinge reaction", "D"),
                ("corrected_torque", "torque, corrected", "^"),
            ):
                axes.plot(x, [100 * abs(worst(table, kind)) for _, table in points], marker=marker, lw=1.5, label=label)
            axes.set_xlabel(name)
        figure.axes[0].set_ylabel("error of plane stress, worst shoe [%]")
        key(figure, figure.axes[0])
    return figure


def wear(worn: Worn) -> Figure:
    """How uneven p is across the width, and how far its mean is from the sine law, over the sliding distance."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(6.6, 3.9), layout="constrained")
        axes = figure.subplots()
        x: Floats = np.asarray(worn.distance)
        for shoe, uneven, law, color in zip(worn.last, worn.uneven, worn.from_law, (BLUE, RED), strict=False):
            axes.semilogy(x, 100 * np.array(uneven), color=color, marker="o", ms=4,
                          label=f"{shoe.name}: off its mean across the width")  # fmt: skip
            axes.semilogy(x, 100 * np.array(law), color=color, ls="--", label=f"{shoe.name}: mean off the sine law")
        axes.set_xscale("symlog", linthresh=0.1)
        axes.set_xlabel("sliding distance [1/(k K)]")
        axes.set_ylabel("pressure [%]")
        key(figure, axes)
    return figure


def ladder(rungs: Sequence[Rung]) -> Figure:
    """Error over processor time, against the solid truth (full) and against that of plane stress (hollow)."""
    looks = {"sine": (RED, "v"), "cosine": (PURPLE, "D"), "uniform": (GREY, "s"), "plane stress": (BLUE, "o"),
             "plane stress, corrected": (GREEN, "^"), "solid": (INK, "P")}  # fmt: skip
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(11.5, 4.3), layout="constrained")
        panels = figure.subplots(1, 2)
        for axes, name, title in zip(
            panels, ("pressure", "torque"), ("mean p over the width (L2)", "torque"), strict=True
        ):
            for method, (color, mark) in looks.items():
                own = [rung for rung in rungs if rung.method == method]
                x = [1e3 * rung.seconds for rung in own]
                true = [100 * getattr(rung, name) for rung in own]
                plane = [100 * getattr(rung, f"plane_{name}") for rung in own]
                axes.loglog(x, true, marker=mark, color=color, lw=1.5, label=method)
                if method == "plane stress":
                    axes.loglog(x, plane, "o--", color=color, lw=1.0, mfc="white", label="plane stress, against itself")
            axes.set_xlabel("processor time [ms]")
            axes.set_title(f"error of {title}, worst shoe [%]")
        key(figure, panels[0])
    return figure
