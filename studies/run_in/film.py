"""The film of a brake that runs in."""

import io
import math
from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from PIL import Image
from studies.run_in.figures import DISTANCE, LATE, LAW, NEW

from drumlin.base.files import temporary_file_replacing_output
from drumlin.lining_wear.linings import WearSetup
from drumlin.lining_wear.run_in import peak_nodal_pressure_of_wear_state
from drumlin.report.figures import MATPLOTLIB_SETTINGS_FOR_SCREEN
from drumlin_studies.run_in_limits import AnimationFrameOfWearRun, WearRunUntilPressureSettles


def write_film(
    one: WearRunUntilPressureSettles, frames: Sequence[AnimationFrameOfWearRun], path: Path
) -> Path:
    """Write a GIF of shoes that run in, and return its path.

    It shows the deformed shoes with their stress, and the pressure on the drum and over the angle.
    """
    # All pictures share the scales of the first one, where pressure and stress are largest.
    top = 1.15 * peak_nodal_pressure_of_wear_state(one.setup, frames[0].state)
    stresses = np.concatenate([f.von_mises for f in frames[0].fields])
    stress = float(np.percentile(stresses, 99)) * 1e-6
    move = max(float(np.abs(f.displacement).max()) for f in frames[0].fields)
    # The largest displacement is drawn as 6 % of the drum radius.
    scale = float(f"{0.06 * one.setup.brake.size / move:.1g}")
    pictures = []
    for number in range(len(frames)):
        figure = _draw_frame(one, frames, number, (top, stress, scale))
        buffer = io.BytesIO()
        FigureCanvasAgg(figure)
        figure.savefig(buffer, dpi=80, format="png")
        pictures.append(Image.open(buffer).convert("RGB").quantize(96, dither=Image.Dither.NONE))
    with temporary_file_replacing_output(path) as partial:
        pictures[0].save(
            partial,
            save_all=True,
            append_images=pictures[1:],
            loop=0,
            optimize=True,
            duration=[1200, *[110] * (len(pictures) - 2), 2500],
        )
    return path


def _draw_frame(
    one: WearRunUntilPressureSettles,
    frames: Sequence[AnimationFrameOfWearRun],
    number: int,
    scales: tuple[float, float, float],
) -> Figure:
    """One picture of the film.

    scales : largest pressure [Pa], largest stress [MPa], factor on displacements.
    """
    setup, goal, unit = one.setup, one.goal, one.unit
    state, top = frames[number].state, scales[0]
    with mpl.rc_context(MATPLOTLIB_SETTINGS_FOR_SCREEN):
        figure = Figure(figsize=(10.4, 5.4), layout="constrained")
        left, right = np.asarray(figure.subfigures(1, 2, width_ratios=(1.0, 0.95)), dtype=object)
        _draw_deformed_shoes(left.subplots(), setup, frames[number], frames[0].turns, scales)
        panels = right.subplots(len(setup.surfaces) + 1, 1)
        # Pressure over the angle, a panel for each lining, with the law dashed.
        for axes, surface in zip(panels, setup.surfaces, strict=False):
            theta, p = (
                np.degrees(surface.contact_angles_in_growing_order),
                surface.lining_values_by_growing_angle(state.pressure) * 1e-6,
            )
            axes.fill_between(theta, np.minimum(p, top * 1e-6), color=NEW, alpha=0.25, lw=0)
            axes.plot(theta, p, color=NEW, lw=1.6)
            axes.plot(
                theta,
                surface.lining_values_by_growing_angle(goal.pressure) * 1e-6,
                color=LAW,
                lw=1.4,
                ls="--",
            )
            axes.set(ylim=(0, top * 1e-6), xlim=(theta[0], theta[-1]), ylabel="p [MPa]")
            axes.set_title(f"{surface.name} shoe: pressure over θ [deg]; dashed: law", fontsize=9)
        # The last panel: torque over the distance, with a dot at the present moment.
        axes = panels[-1]
        s = []
        for frame in frames:
            s.append(max(frame.state.s / unit, 1e-3))
        torque = []
        for frame in frames:
            torque.append(frame.state.torque)
        axes.semilogx(s, torque, color="#c9d1d9", lw=1.4)
        axes.semilogx(s[: number + 1], torque[: number + 1], color=NEW, lw=1.8)
        axes.plot(s[number], torque[number], "o", color=NEW, ms=5)
        axes.axhline(goal.torque, color=LAW, lw=1.4, ls="--")
        axes.set_title("torque [N m]; dashed: law", fontsize=9)
        axes.set_xlabel(DISTANCE)
        said = "new" if number == 0 else f"s k K = {state.s / unit:.3g}"
        left.suptitle(
            f"{setup.brake.title}: {said}\ndeepest wear {state.depth.max() * 1e3:.3f} mm",
            fontsize=11,
            fontweight="bold",
        )
    return figure


def _draw_deformed_shoes(
    axes: Axes,
    setup: WearSetup,
    frame: AnimationFrameOfWearRun,
    first: Sequence[float],
    scales: tuple[float, float, float],
) -> None:
    """Draw the deformed shoes with the pressure on the drum.

    The turn of a shoe that takes up the wear is left out, because it would move the shoe out of the
    picture. first : turn of each shoe with new linings [rad]; scales : as of `_draw_frame`.
    """
    top, stress, scale = scales
    brake = setup.brake
    radius = brake.size
    for fields, shoe, turn, start in zip(
        frame.fields, brake.shoes, frame.turns, first, strict=True
    ):
        # The turn about the pin since the start would move the shoe out of the picture.
        arm = fields.points - shoe.pin.xy
        followed = (turn - start) * np.column_stack([-arm[:, 1], arm[:, 0]])
        x, y = (fields.points + scale * (fields.displacement - followed)).T
        # Each quadrilateral is drawn as two triangles.
        quads = fields.cells[:, :4] if fields.cell_type.startswith("quad") else None
        corners = (
            fields.cells[:, :3]
            if quads is None
            else np.vstack([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
        )
        axes.tripcolor(
            x * 1e3,
            y * 1e3,
            corners,
            fields.von_mises * 1e-6,
            shading="gouraud",
            cmap="viridis",
            vmin=0,
            vmax=stress,
        )
    for surface in setup.surfaces:
        theta, p = (
            surface.contact_angles_in_growing_order,
            np.minimum(surface.lining_values_by_growing_angle(frame.state.pressure), top),
        )
        # Bars along the drum show the pressure.
        spread = np.linspace(theta[0], theta[-1], 70)
        tall = np.interp(spread, theta, p) / top * 0.3 * radius
        sign = brake.shoes[surface.shoe].sign_internal_plus_external_minus
        ray = np.column_stack([np.cos(spread), np.sin(spread)])
        bars = np.stack([ray * radius, ray * (radius + sign * tall)[:, None]], axis=1)
        axes.add_collection(LineCollection(list(bars * 1e3), colors=LAW, linewidths=2.2))
    # The drum as a circle.
    around = np.linspace(0, 2 * math.pi, 241)
    axes.plot(1e3 * radius * np.cos(around), 1e3 * radius * np.sin(around), color=LATE, lw=1.4)
    for shoe in brake.shoes:
        axes.plot(*(1e3 * shoe.pin.xy), "o", color=LATE, ms=6)
    axes.set_aspect("equal")
    axes.set_axis_off()
    axes.set_title(
        f"stress (0 to {stress:.3g} MPa), displacement × {scale:g} without the turn that takes up\n"
        "the wear; red: pressure on the drum",
        fontsize=9,
        loc="center",
        fontweight="normal",
    )
