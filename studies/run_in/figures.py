"""Figures of linings that run in."""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from drumlin.lining_wear.archard import interpolate_wear_state_at_distance
from drumlin.lining_wear.linings import WornLining
from drumlin.lining_wear.run_in import peak_nodal_pressure_of_wear_state
from drumlin.report.figures import (
    FULL_WIDTH,
    LARGEST_HEIGHT,
    MATPLOTLIB_SETTINGS_FOR_PRINT,
    draw_legend_below_figure,
    draw_triangles_where_curve_leaves_axes,
    make_figure_for_print,
    number_of_panels_side_by_side,
)
from drumlin.report.palette import BLUE, COLOR_OF_AXES_AND_NOTES, INK, RED
from drumlin_studies.run_in_limits import (
    LastStateOfEqualWearSteps,
    WearRunUntilPressureSettles,
    WearWithRegularDrumReversals,
)

NEW, LATE, LAW = BLUE, INK, RED
DISTANCE = "sliding distance s [1/(k K)]"
"""Label of the sliding distance s: k is the wear coefficient, K = E/t the lining's stiffness."""


MOST_NAMED_RUNS = 7
"""Number of runs that a figure of many runs names: more colours are hardly told apart."""
COLOR_OF_OTHER_RUNS = "#c6ced6"
"""Colour of the runs without a name."""


class Series(NamedTuple):
    """A line of a figure: its label, x, y, and its colour where this is given."""

    label: str
    x: Sequence[float]
    y: Sequence[float]
    color: str | None = None


def draw_pressures_over_distance(
    one: WearRunUntilPressureSettles, curves: Sequence[float], width: float = FULL_WIDTH
) -> Figure:
    """Pressure over angle and sliding distance, a row for each lining, or in a column two rows.

    Parameters
    ----------
    one : the run
    curves : sliding distances of the curves [1/(k K)]; a picture beside or below them shows all
        distances
    width : width of the figure [inches], FULL_WIDTH or COLUMN_WIDTH
    """
    setup, states = one.setup, one.states
    with mpl.rc_context(MATPLOTLIB_SETTINGS_FOR_PRINT):
        columns = number_of_panels_side_by_side(width, 2)
        rows = 2 * len(setup.surfaces) // columns
        figure = make_figure_for_print(min(2.2 * rows + 0.5, LARGEST_HEIGHT), width)
        placed = figure.subplots(rows, columns, squeeze=False)
        # A row holds the curves and the picture of a lining, wherever these are placed.
        grid = placed.reshape(-1, 2)
        # The scale of pressure ends above the peak of the new brake.
        top = 1.15 * peak_nodal_pressure_of_wear_state(setup, states[0])
        shades = mpl.colormaps["viridis_r"](np.linspace(0.12, 1.0, len(curves)))
        for (left, right), surface in zip(grid, setup.surfaces, strict=True):
            theta = np.degrees(surface.contact_angles_in_growing_order)
            # One curve for each chosen distance.
            for s, shade in zip(curves, shades, strict=True):
                p = surface.lining_values_by_growing_angle(
                    interpolate_wear_state_at_distance(states, s * one.unit).pressure
                )
                left.plot(
                    theta, p * 1e-6, color=shade, lw=1.6, label=f"s = {s:g}/(k K)" if s else "new"
                )
                left.set_ylim(0, top * 1e-6)
                draw_triangles_where_curve_leaves_axes(left, theta, p * 1e-6, shade)
            left.plot(
                theta,
                surface.lining_values_by_growing_angle(one.goal.pressure) * 1e-6,
                color=LAW,
                lw=1.6,
                ls="--",
                label="sine law",
            )
            left.set(xlim=(theta[0], theta[-1]), ylabel="pressure p [MPa]")
            left.set_title(f"{surface.name} shoe")
            _draw_pressure_map(right, one, surface, top)
            right.set_title(f"{surface.name} shoe, over the distance")
        for axes in grid[-1] if columns > 1 else placed.flat:
            axes.set_xlabel("angle on the drum θ [deg]")
        # The legend is taken from the panel with the most different labels.
        named = max(grid[:, 0], key=lambda axes: len(set(axes.get_legend_handles_labels()[1])))
        if _has_lining_without_contact_anywhere(one):
            named.plot(
                [], [], "s", mfc="white", mec=COLOR_OF_AXES_AND_NOTES, label="white: no contact"
            )
        draw_legend_below_figure(figure, named)
        bar = mpl.cm.ScalarMappable(mpl.colors.Normalize(0, top * 1e-6), "viridis")
        # A column has no room for the bar beside the panels.
        beside = grid[:, 1].tolist() if columns > 1 else list(placed.flat)
        side = "right" if columns > 1 else "bottom"
        figure.colorbar(bar, ax=beside, location=side, label="pressure p [MPa]", shrink=0.8)
    return figure


def _has_lining_without_contact_anywhere(one: WearRunUntilPressureSettles) -> bool:
    """Whether a place of a lining is out of contact in a state of the run."""
    return any(bool((state.pressure <= 0).any()) for state in one.states)


def _draw_pressure_map(
    axes: Axes, one: WearRunUntilPressureSettles, surface: WornLining, top: float
) -> None:
    """Draw p over angle and logarithm of the distance. Places without contact are white."""
    # Distances evenly spread on a logarithmic scale, over four decades.
    end = one.states[-1].s / one.unit
    levels = np.geomspace(end * 1e-4, end, 240)
    p = np.array(
        [
            surface.lining_values_by_growing_angle(
                interpolate_wear_state_at_distance(one.states, s * one.unit).pressure
            )
            for s in levels
        ]
    )
    axes.pcolormesh(
        np.degrees(surface.contact_angles_in_growing_order),
        levels,
        np.where(p > 0, p, np.nan),
        cmap="viridis",
        vmin=0,
        vmax=top,
        shading="gouraud" if (p > 0).all() else "nearest",
        rasterized=True,
    )
    axes.set_yscale("log")
    axes.set_ylabel(DISTANCE)
    axes.grid(False)


def draw_torques_over_distance(runs: Sequence[WearRunUntilPressureSettles]) -> Figure:
    """Relative difference of the torque from the law over the distance, a line for each run.

    Only the runs whose torque is farthest from the law when new have names and colours.
    """
    ranked = sorted(
        runs, key=lambda one: abs(one.states[0].torque / one.goal.torque - 1), reverse=True
    )
    series = [torque_error_series(one, one.name) for one in ranked[:MOST_NAMED_RUNS]]
    for k, one in enumerate(ranked[MOST_NAMED_RUNS:]):
        label = "_" if k else "other brakes"
        series.append(torque_error_series(one, label, COLOR_OF_OTHER_RUNS))
    # Named lines lie above the others.
    return draw_lines_over_distance(
        series[::-1],
        "torque off the law [%]",
        law="law",
        band=0.1,
    )


def torque_error_series(
    one: WearRunUntilPressureSettles, label: str, color: str | None = None
) -> Series:
    """Torque off the law [%] over the distance."""
    return Series(
        label,
        one.sliding_distances_of_run_states(),
        [100 * (s.torque / one.goal.torque - 1) for s in one.states],
        color,
    )


def draw_held_force(one: WearRunUntilPressureSettles) -> Figure:
    """The force that holds the law's torque."""
    force = []
    for state in one.states:
        force.append(100 * (state.force - 1))
    series = Series("force for the law's torque", one.sliding_distances_of_run_states(), force)
    return draw_lines_over_distance([series], "force off the brake's own [%]", law="law: no change")


def draw_reversals(
    main: WearRunUntilPressureSettles, turned: WearWithRegularDrumReversals
) -> Figure:
    """Torque and pressure of the main brake off its laws as the drum turns both ways."""
    one = replace(main, states=turned.states)
    far = Series(
        "p off the law (L2) / 10",
        one.sliding_distances_of_run_states(),
        [10 * x for x in turned.far],
        LATE,
    )
    return draw_lines_over_distance(
        [torque_error_series(one, "torque off the law", NEW), far],
        "distance from the law [%]",
        law="law",
        log=False,
    )


def draw_lines_over_distance(
    series: Sequence[Series],
    ylabel: str,
    *,
    law: str | None = None,
    band: float = 0.0,
    log: bool = True,
) -> Figure:
    """Lines over the sliding distance; a line at 0 called `law`, with a band about it."""
    with mpl.rc_context(MATPLOTLIB_SETTINGS_FOR_PRINT):
        figure = make_figure_for_print(3.4)
        axes = figure.subplots()
        if law is not None:
            axes.axhline(0, color=LAW, lw=1.6, ls="--", label=law)
        if band:
            axes.axhspan(-band, band, color=LAW, alpha=0.12, lw=0)
        uncoloured = sum(one.color is None for one in series)
        shades = iter(mpl.colormaps["viridis"](np.linspace(0, 0.9, max(uncoloured, 2))))
        for one in series:
            axes.plot(one.x, one.y, lw=1.6, color=one.color or next(shades), label=one.label)
        # The symmetric logarithm shows the new brake at the distance 0, too.
        if log:
            axes.set_xscale("symlog", linthresh=0.01, linscale=0.3)
            ticks = [
                0.0,
                *10.0
                ** np.arange(-2, math.ceil(math.log10(max(max(one.x) for one in series))) + 1),
            ]
            axes.set_xticks(ticks, ["0", *(f"{tick:g}" for tick in ticks[1:])])
            axes.set_xlim(0, 1.1 * max(max(one.x) for one in series))
        axes.set_xlabel(f"{DISTANCE} (0: new)" if log else DISTANCE)
        axes.set_ylabel(ylabel)
        # Names of brakes and models are too long for three of them side by side.
        draw_legend_below_figure(figure, axes, **({"ncols": 2} if len(series) > 2 else {}))
    return figure


def draw_worn_profiles(one: WearRunUntilPressureSettles, curves: Sequence[float]) -> Figure:
    """Worn depth over the angle at some distances, and the arcs in contact over the distance.

    Each lining has a column.
    """
    setup, states, unit = one.setup, one.states, one.unit
    with mpl.rc_context(MATPLOTLIB_SETTINGS_FOR_PRINT):
        figure = make_figure_for_print(4.4)
        grid = figure.subplots(2, len(setup.surfaces), squeeze=False, sharey="row", sharex="col")
        shades = mpl.colormaps["viridis_r"](np.linspace(0.12, 1.0, len(curves)))
        end = states[-1].s / unit
        levels = np.geomspace(end * 1e-4, end, 200)
        for column, surface in zip(grid.T, setup.surfaces, strict=True):
            theta = np.degrees(surface.contact_angles_in_growing_order)
            for s, shade in zip(curves, shades, strict=True):
                depth = surface.lining_values_by_growing_angle(
                    interpolate_wear_state_at_distance(states, s * unit).depth
                )
                column[0].plot(theta, depth * 1e6, color=shade, lw=1.6, label=f"s = {s:g}/(k K)")
            column[0].set_yscale("symlog", linthresh=1)
            column[0].set_title(f"{surface.name} shoe")
            touching = np.array(
                [
                    surface.lining_values_by_growing_angle(
                        interpolate_wear_state_at_distance(states, s * unit).pressure
                    )
                    > 0
                    for s in levels
                ]
            )
            column[1].contourf(
                theta, levels, touching, levels=[0.5, 1.5], colors=[BLUE], alpha=0.35
            )
            column[1].set_yscale("log")
            column[1].set_xlabel("angle on the drum θ [deg]")
        grid[0, 0].set_ylabel("worn depth [µm]")
        grid[1, 0].set_ylabel(f"{DISTANCE},\nin contact: filled")
        draw_legend_below_figure(figure, grid[0, -1])
    return figure


def draw_checkerboards(surface: WornLining, boards: Sequence[LastStateOfEqualWearSteps]) -> Figure:
    """Nodal pressures of the most loaded third of a lining, a panel for each way to step.

    Titles tell the checkerboard of the pressure.
    """
    with mpl.rc_context(MATPLOTLIB_SETTINGS_FOR_PRINT):
        figure = make_figure_for_print(2.8)
        grid = figure.subplots(1, len(boards), sharey=True, squeeze=False)[0]
        theta = np.degrees(surface.contact_angles_in_growing_order)
        # The third of the lining about its largest pressure.
        third = (theta[-1] - theta[0]) / 3
        smooth = surface.lining_values_by_growing_angle(boards[0].state.pressure)
        start = min(max(theta[smooth.argmax()] - third / 2, theta[0]), theta[-1] - third)
        for axes, board in zip(grid, boards, strict=True):
            p = surface.lining_values_by_growing_angle(board.state.pressure) * 1e-6
            axes.plot(theta, p, color=BLUE, lw=0.8, marker="o", ms=2.2)
            torque = f"torque {board.state.torque:.2f} N m"
            said = f"{board.title}\ncheckerboard {board.ripple:.1e}\n{torque}"
            axes.set_title(said)
            axes.set_xlim(start, start + third)
            axes.set_xlabel("angle on the drum θ [deg]")
        grid[0].set_ylim(0, 4 * smooth.max() * 1e-6)
        grid[0].set_ylabel("nodal pressure p [MPa]")
    return figure
