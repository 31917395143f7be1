"""Figures and the film of a lining that runs in."""

import io
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from drumlin.arrays import Floats
from drumlin.brake.drum_brake import Brake
from drumlin.fem.fields import Fields
from drumlin.files import replacing
from drumlin.report.figures import COLORS, STYLE
from drumlin.wear.archard import State, at
from drumlin.wear.linings import Rig, Surface
from drumlin.wear.run_in import Target

NEW, LATE, LAW = COLORS["fem"], "#1d2733", COLORS["sine"]
DISTANCE = "sliding distance s k K"


class Series(NamedTuple):
    """A line of a figure: x, y, its label and, where it has to be a certain one, its colour."""

    label: str
    x: Sequence[float]
    y: Sequence[float]
    color: str | None = None


def pressure_picture(rig: Rig, states: Sequence[State], goal: Target, unit: float, curves: Sequence[float]) -> Figure:
    """p(theta) of each lining over the sliding distance (units of `unit` [m]): some as curves, all as a picture.

    `curves`: distances of the curves, in the unit. One row a lining.
    """
    with mpl.rc_context(STYLE):
        rows = len(rig.surfaces)
        figure = Figure(figsize=(10.6, 3.5 * rows), layout="constrained")
        grid = figure.subplots(rows, 2, squeeze=False, width_ratios=(1.0, 1.0))
        top = 1.15 * max(inner_peak(rig, s, states[0]) for s in rig.surfaces)
        shades = mpl.colormaps["viridis_r"](np.linspace(0.12, 1.0, len(curves)))
        for (left, right), surface in zip(grid, rig.surfaces, strict=True):
            theta = np.degrees(surface.angles)
            for s, shade in zip(curves, shades, strict=True):
                p = surface.along(at(states, s * unit).pressure)
                left.plot(theta, p * 1e-6, color=shade, lw=1.6, label=f"s k K = {s:g}" if s else "new")
            left.plot(theta, surface.along(goal.pressure) * 1e-6, color=LAW, lw=1.6, ls="--", label="law")
            left.set(ylim=(0, top * 1e-6), xlim=(theta[0], theta[-1]), ylabel="pressure p [MPa]")
            left.set_title(f"{surface.name} shoe")
            heat(right, surface, states, unit, top)
            right.set_title(f"{surface.name} shoe, over the distance; white: no contact")
        for axes in grid[-1]:
            axes.set_xlabel("angle on the drum θ [deg]")
        grid[0, 0].legend(fontsize=8, ncols=2)
        bar = mpl.cm.ScalarMappable(mpl.colors.Normalize(0, top * 1e-6), "viridis")
        figure.colorbar(bar, ax=grid[:, 1].tolist(), label="pressure p [MPa]", shrink=0.8)
    return figure


def heat(axes: Axes, surface: Surface, states: Sequence[State], unit: float, top: float) -> None:
    """p over theta and the logarithm of the distance, contact's ends as the border of the colour."""
    end = states[-1].s / unit
    levels = np.geomspace(end * 1e-4, end, 240)
    p = np.array([surface.along(at(states, s * unit).pressure) for s in levels])
    axes.pcolormesh(
        np.degrees(surface.angles), levels, np.where(p > 0, p, np.nan), cmap="viridis", vmin=0, vmax=top,
        shading="gouraud" if (p > 0).all() else "nearest", rasterized=True,
    )  # fmt: skip
    axes.set_yscale("log")
    axes.set_ylabel(DISTANCE)
    axes.grid(False)


def inner_peak(rig: Rig, surface: Surface, state: State) -> float:
    """Largest pressure [Pa] of a lining, half its thickness from its ends."""
    theta, p = surface.angles, surface.along(state.pressure)
    zone = rig.brake.shoes[surface.shoe].lining.thickness / (2 * rig.brake.drum.radius)
    return float(p[(theta > theta[0] + zone) & (theta < theta[-1] - zone)].max())


def lines(
    series: Sequence[Series], ylabel: str, *, law: str | None = None, band: float = 0.0, log: bool = True
) -> Figure:
    """Lines over the sliding distance; a line at 0 called `law`, with a band about it."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(8.6, 4.2), layout="constrained")
        axes = figure.subplots()
        if law is not None:
            axes.axhline(0, color=LAW, lw=1.6, ls="--", label=law)
        if band:
            axes.axhspan(-band, band, color=LAW, alpha=0.12, lw=0)
        shades = mpl.colormaps["viridis"](np.linspace(0, 0.9, max(len(series), 2)))
        for one, shade in zip(series, shades, strict=False):
            axes.plot(one.x, one.y, lw=1.6, color=one.color or shade, label=one.label)
        if log:
            axes.set_xscale("symlog", linthresh=0.01, linscale=0.3)
            ticks = [0.0, *10.0 ** np.arange(-2, math.ceil(math.log10(max(max(one.x) for one in series))) + 1)]
            axes.set_xticks(ticks, ["0", *(f"{tick:g}" for tick in ticks[1:])])
            axes.set_xlim(0, 1.1 * max(max(one.x) for one in series))
        axes.set_xlabel(f"{DISTANCE} (0: new)" if log else DISTANCE)
        axes.set_ylabel(ylabel)
        axes.legend(fontsize=8, loc="center left", bbox_to_anchor=(1.01, 0.5))
    return figure


def profiles(rig: Rig, states: Sequence[State], unit: float, curves: Sequence[float]) -> Figure:
    """Worn depth over the angle at some distances, and the arcs in contact over the distance; a column a lining."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(5.2 * len(rig.surfaces), 5.6), layout="constrained")
        grid = figure.subplots(2, len(rig.surfaces), squeeze=False, sharey="row", sharex="col")
        shades = mpl.colormaps["viridis_r"](np.linspace(0.12, 1.0, len(curves)))
        end = states[-1].s / unit
        levels = np.geomspace(end * 1e-4, end, 200)
        for column, surface in zip(grid.T, rig.surfaces, strict=True):
            theta = np.degrees(surface.angles)
            for s, shade in zip(curves, shades, strict=True):
                depth = surface.along(at(states, s * unit).depth)
                column[0].plot(theta, depth * 1e6, color=shade, lw=1.6, label=f"s k K = {s:g}")
            column[0].set_yscale("symlog", linthresh=1)
            column[0].set_title(f"{surface.name} shoe")
            touching = np.array([surface.along(at(states, s * unit).pressure) > 0 for s in levels])
            column[1].contourf(theta, levels, touching, levels=[0.5, 1.5], colors=[COLORS["fem"]], alpha=0.35)
            column[1].set_yscale("log")
            column[1].set_xlabel("angle on the drum θ [deg]")
        grid[0, 0].set_ylabel("worn depth [µm]")
        grid[1, 0].set_ylabel(f"{DISTANCE}, in contact: filled")
        grid[0, -1].legend(fontsize=8)
    return figure


def checkerboard(surface: Surface, columns: Mapping[str, tuple[State, float]]) -> Figure:
    """Nodal p(theta) over the most loaded third of one lining by several ways to step; titles carry the ripple."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(10.6, 3.6), layout="constrained")
        grid = figure.subplots(1, len(columns), sharey=True, squeeze=False)[0]
        theta = np.degrees(surface.angles)
        third = (theta[-1] - theta[0]) / 3
        smooth = surface.along(next(iter(columns.values()))[0].pressure)
        start = min(max(theta[smooth.argmax()] - third / 2, theta[0]), theta[-1] - third)
        for axes, (title, (state, ripple)) in zip(grid, columns.items(), strict=True):
            p = surface.along(state.pressure) * 1e-6
            axes.plot(theta, p, color=COLORS["fem"], lw=0.8, marker="o", ms=2.2)
            said = f"{title}\ncheckerboard {ripple:.1e}\ntorque {state.torque:.2f} N m"
            axes.set_title(said, fontsize=8.5)
            axes.set_xlim(start, start + third)
            axes.set_xlabel("angle on the drum θ [deg]")
        grid[0].set_ylim(0, 4 * smooth.max() * 1e-6)
        grid[0].set_ylabel("nodal pressure p [MPa]")
    return figure


class Frame(NamedTuple):
    """A moment of the film: the state, and of each shoe the fields and the turn about its pin [rad]."""

    state: State
    fields: Sequence[Fields]
    turns: Sequence[float]


def film(rig: Rig, frames: Sequence[Frame], goal: Target, unit: float, path: Path) -> Path:
    """A GIF of the deformed shoes with their stress, the pressure on the drum and over theta, while they run in."""
    from PIL import Image  # noqa: PLC0415  (comes with matplotlib; only for a film)

    top = 1.15 * max(inner_peak(rig, s, frame.state) for s in rig.surfaces for frame in frames[:1])
    stress = float(np.percentile(np.concatenate([f.von_mises for f in frames[0].fields]), 99)) * 1e-6
    move = max(float(np.abs(f.displacement).max()) for f in frames[0].fields)
    scale = float(f"{0.06 * rig.brake.drum.radius / move:.1g}")
    pictures = []
    for number in range(len(frames)):
        figure = _frame(rig, frames, number, goal, unit, (top, stress, scale))
        buffer = io.BytesIO()
        FigureCanvasAgg(figure)
        figure.savefig(buffer, dpi=80, format="png")
        pictures.append(Image.open(buffer).convert("RGB").quantize(96, dither=Image.Dither.NONE))
    with replacing(path) as partial:
        pictures[0].save(
            partial, save_all=True, append_images=pictures[1:], loop=0, optimize=True,
            duration=[1200, *[110] * (len(pictures) - 2), 2500],
        )  # fmt: skip
    return path


def _frame(
    rig: Rig, frames: Sequence[Frame], number: int, goal: Target, unit: float, scales: tuple[float, float, float]
) -> Figure:
    state, top = frames[number].state, scales[0]
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(10.4, 5.4), layout="constrained")
        left, right = np.asarray(figure.subfigures(1, 2, width_ratios=(1.0, 0.95)), dtype=object)
        _shoes(left.subplots(), rig, frames[number], frames[0].turns, scales)
        panels = right.subplots(len(rig.surfaces) + 1, 1)
        for axes, surface in zip(panels, rig.surfaces, strict=False):
            theta, p = np.degrees(surface.angles), surface.along(state.pressure) * 1e-6
            axes.fill_between(theta, np.minimum(p, top * 1e-6), color=NEW, alpha=0.25, lw=0)
            axes.plot(theta, p, color=NEW, lw=1.6)
            axes.plot(theta, surface.along(goal.pressure) * 1e-6, color=LAW, lw=1.4, ls="--")
            axes.set(ylim=(0, top * 1e-6), xlim=(theta[0], theta[-1]), ylabel="p [MPa]")
            axes.set_title(f"{surface.name} shoe: pressure over θ [deg]; dashed: law", fontsize=9)
        axes = panels[-1]
        s = [max(frame.state.s / unit, 1e-3) for frame in frames]
        torque = [frame.state.torque for frame in frames]
        axes.semilogx(s, torque, color="#c9d1d9", lw=1.4)
        axes.semilogx(s[: number + 1], torque[: number + 1], color=NEW, lw=1.8)
        axes.plot(s[number], torque[number], "o", color=NEW, ms=5)
        axes.axhline(goal.torque, color=LAW, lw=1.4, ls="--")
        axes.set_title("torque [N m]; dashed: law", fontsize=9)
        axes.set_xlabel(DISTANCE)
        said = "new" if number == 0 else f"s k K = {state.s / unit:.3g}"
        left.suptitle(
            f"{rig.brake.title}: {said}\ndeepest wear {state.depth.max() * 1e3:.3f} mm", fontsize=11, fontweight="bold"
        )
    return figure


def _shoes(axes: Axes, rig: Rig, frame: Frame, first: Sequence[float], scales: tuple[float, float, float]) -> None:
    """The shoes deformed, without the turn beyond `first` that takes up the wear: it would leave the picture."""
    top, stress, scale = scales
    brake: Brake = rig.brake
    radius = brake.drum.radius
    for fields, shoe, turn, start in zip(frame.fields, brake.shoes, frame.turns, first, strict=True):
        arm = fields.points - shoe.hinge.xy
        followed = (turn - start) * np.column_stack([-arm[:, 1], arm[:, 0]])
        x, y = (fields.points + scale * (fields.displacement - followed)).T
        quads = fields.cells[:, :4] if fields.cell_type.startswith("quad") else None
        corners = fields.cells[:, :3] if quads is None else np.vstack([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
        axes.tripcolor(
            x * 1e3, y * 1e3, corners, fields.von_mises * 1e-6, shading="gouraud", cmap="viridis", vmin=0, vmax=stress
        )
    for surface in rig.surfaces:
        theta, p = surface.angles, np.minimum(surface.along(frame.state.pressure), top)
        spread = np.linspace(theta[0], theta[-1], 70)
        tall = np.interp(spread, theta, p) / top * 0.3 * radius
        sign = brake.shoes[surface.shoe].sign
        ray = np.column_stack([np.cos(spread), np.sin(spread)])
        bars = np.stack([ray * radius, ray * (radius + sign * tall)[:, None]], axis=1)
        axes.add_collection(LineCollection(list(bars * 1e3), colors=LAW, linewidths=2.2))
    around = np.linspace(0, 2 * math.pi, 241)
    axes.plot(1e3 * radius * np.cos(around), 1e3 * radius * np.sin(around), color=LATE, lw=1.4)
    for shoe in brake.shoes:
        axes.plot(*(1e3 * shoe.hinge.xy), "o", color=LATE, ms=6)
    axes.set_aspect("equal")
    axes.set_axis_off()
    axes.set_title(
        f"stress (0 to {stress:.3g} MPa), displacement × {scale:g} without the turn that takes up\n"
        "the wear; red: pressure on the drum", fontsize=9,
        loc="center", fontweight="normal",
    )  # fmt: skip


def curve(states: Sequence[State], unit: float, values: Sequence[float] | Floats) -> tuple[list[float], list[float]]:
    """x and y of a line: distances in the unit."""
    return [state.s / unit for state in states], [float(value) for value in values]
