"""Figures of misfit and tolerances: pressures, maps, one turn, distributions, variances."""

from collections.abc import Mapping, Sequence

import matplotlib as mpl
import numpy as np
from matplotlib import patheffects
from matplotlib.figure import Figure

from drumlin.base.arrays import Floats
from drumlin.report.figures import (
    FULL_WIDTH,
    MATPLOTLIB_SETTINGS_FOR_PRINT,
    SMALL_TEXT_SIZE,
    draw_legend_below_figure,
    draw_triangles_where_curve_leaves_axes,
    evenly_spaced_pressure_curve_of_shoe,
    make_figure_for_print,
    number_of_panels_side_by_side,
)
from drumlin.report.palette import BLUE, COLOR_OF_AXES_AND_NOTES, GREEN, INK, OCHRE, PURPLE, RED
from drumlin.response.response import Response
from drumlin.sweeps.tolerances import (
    FirstAndTotalSobolIndexOfTolerance,
    mean_and_percentiles_of_sample,
)
from drumlin_studies.misfit_rows import (
    LINING_STATES_OF_RANDOM_BRAKES,
    QUANTITIES_SHOWN_OVER_RANDOM_BRAKES,
    ResultsOfRandomBrakesWithTolerances,
)

NEW, WORN, LAW = BLUE, GREEN, RED
LEVELS = (
    -40,
    -30,
    -20,
    -15,
    -10,
    -5,
    0,
    5,
    10,
    20,
    30,
    50,
    75,
    100,
    150,
    200,
    300,
    500,
    700,
    1000,
)
"""Contour lines of the maps [%]."""
TINTS = {NEW: "#a9d3e5", WORN: "#b5dfc6"}


def draw_pressures_of_radii(law: Response, family: Mapping[float, Response]) -> Figure:
    """Pressures of linings of other radii, and by the law, a panel for each shoe.

    They are cut at 2.2 times the peak of the lining that fits. family : responses by the radius of
    the lining less that of the drum [um].
    """
    highest = 2.2 * max(shoe.peak_pressure for shoe in family[0.0].shoes)
    with mpl.rc_context(MATPLOTLIB_SETTINGS_FOR_PRINT):
        figure = make_figure_for_print(2.8)
        grid = figure.subplots(1, len(law.shoes), squeeze=False, sharey=True)[0]
        shade = mpl.colors.TwoSlopeNorm(0.0, 1.15 * min(family), 1.15 * max(family))
        for i, (axes, shoe) in enumerate(zip(grid, law.shoes, strict=True)):
            for value, response in family.items():
                theta, p = evenly_spaced_pressure_curve_of_shoe(response.shoes[i], 600)
                color = INK if value == 0 else mpl.colormaps["coolwarm"](shade(value))
                axes.plot(
                    np.degrees(theta),
                    p * 1e-6,
                    color=color,
                    lw=2.0 if value == 0 else 1.6,
                    label=f"{value:+.0f} µm" if value else "fits",
                )
                axes.set_ylim(0, highest * 1e-6)
                draw_triangles_where_curve_leaves_axes(axes, np.degrees(theta), p * 1e-6, color)
            axes.plot(
                np.degrees(shoe.theta),
                shoe.pressure * 1e-6,
                color=LAW,
                lw=1.8,
                ls="--",
                label="sine law",
            )
            axes.set_title(f"{'Leading' if shoe.self_energising else 'Trailing'} shoe")
            axes.set_xlabel("angle on the drum θ [deg]")
        grid[0].set_ylabel("pressure p [MPa]")
        draw_legend_below_figure(figure, grid[-1], title="radius of lining − radius of drum")
    return figure


def draw_ratio_maps(sides: tuple[Floats, Floats], ratios: Mapping[str, Floats]) -> Figure:
    """Maps of torque and peak pressure over those of the law.

    A thick line shows the value of the law.

    Parameters
    ----------
    sides : two arrays
        Radius of the lining less that of the drum, and offset of the lining [m].
    ratios : mapping
        Value over the law's value, minus 1: a row for each offset, a column for each radius.
    """
    x, y = (1e6 * side for side in sides)
    both = {"Torque": ratios["torque"], "Peak pressure": ratios["peak_pressure"]}
    with mpl.rc_context(MATPLOTLIB_SETTINGS_FOR_PRINT | {"axes.grid": False}):
        figure = make_figure_for_print(3.2)
        grid = figure.subplots(1, len(both), squeeze=False)[0]
        for axes, (title, ratio) in zip(grid, both.items(), strict=True):
            percent = 100 * ratio
            most = float(np.abs(percent).max())
            lines = []
            for level in LEVELS:
                if percent.min() < level < percent.max():
                    lines.append(level)
            levels = [float(percent.min()), *lines, float(percent.max())]
            # Colours are linear up to 20 %, logarithmic beyond, and white on the law.
            scale = mpl.colors.SymLogNorm(linthresh=20, linscale=1, vmin=-most, vmax=most)
            filled = axes.contourf(x, y, percent, levels=levels, cmap="RdBu_r", norm=scale)
            others = []
            for level in lines:
                if level:
                    others.append(level)
            drawn = axes.contour(
                x, y, percent, levels=others, colors="#46525e", linewidths=0.6, linestyles="solid"
            )
            # A white outline makes the numbers on the lines legible.
            for text in axes.clabel(drawn, fmt="%+.0f %%", fontsize=SMALL_TEXT_SIZE):
                text.set_path_effects([patheffects.withStroke(linewidth=2, foreground="white")])
            axes.contour(x, y, percent, levels=[0.0], colors=LAW, linewidths=2.6)
            axes.plot([], [], color=LAW, lw=2.6, label="as the sine law says")
            axes.plot(0, 0, "o", color=INK, ms=5, label="lining that fits")
            axes.set_title(title)
            axes.set_xlabel("radius of linings − radius of drum [µm]")
            bar = figure.colorbar(filled, ax=axes, shrink=0.9, ticks=lines, format="%+.0f")
            bar.set_label("from the sine law [%]")
        grid[0].set_ylabel("linings moved along the pin's radius [µm]")
        draw_legend_below_figure(figure, grid[0])
    return figure


def draw_torque_over_turn(
    angles: Floats, states: Mapping[str, Mapping[str, Floats]], law: float
) -> Figure:
    """Torque over the angles [rad] of one turn of the drum, and the torque by the law [N m].

    There is a line for each state of the linings and each name of lobes.
    """
    with mpl.rc_context(MATPLOTLIB_SETTINGS_FOR_PRINT):
        figure = make_figure_for_print(2.8)
        grid = figure.subplots(1, len(states), squeeze=False, sharey=True)[0]
        for axes, (state, series) in zip(grid, states.items(), strict=True):
            for (name, torque), color in zip(
                series.items(), (BLUE, OCHRE, PURPLE, GREEN), strict=False
            ):
                axes.plot(
                    np.degrees(np.append(angles, 2 * np.pi)),
                    np.append(torque, torque[0]),
                    lw=1.8,
                    color=color,
                    label=name,
                )
            axes.axhline(law, color=LAW, lw=1.8, ls="--", label="sine law")
            axes.set_title(f"{state.capitalize()} linings")
            axes.set_xlabel("angle of the drum [deg]")
            axes.set_xlim(0, 360)
            axes.set_xticks(range(0, 361, 60))
        grid[0].set_ylabel("torque of the brake [N m]")
        draw_legend_below_figure(figure, grid[-1])
    return figure


def draw_histograms(
    drawn: ResultsOfRandomBrakesWithTolerances,
    nominal: Mapping[str, float],
    width: float = FULL_WIDTH,
) -> Figure:
    """Distributions of each quantity over new and worn-in brakes, a panel for each quantity.

    Above them stand the 5th, 50th and 95th percentile, and the law's value of the nominal brake.
    `width` [inches] is FULL_WIDTH or COLUMN_WIDTH.
    """
    with mpl.rc_context(MATPLOTLIB_SETTINGS_FOR_PRINT):
        panels = len(QUANTITIES_SHOWN_OVER_RANDOM_BRAKES)
        columns = number_of_panels_side_by_side(width, panels)
        figure = make_figure_for_print(1.8 * panels / columns + 0.8, width)
        grid = figure.subplots(panels // columns, columns, squeeze=False).ravel()
        for axes, (name, label) in zip(
            grid, QUANTITIES_SHOWN_OVER_RANDOM_BRAKES.items(), strict=True
        ):
            new, worn = (
                drawn.values_of_quantity_for_random_brakes(state, name)
                for state in LINING_STATES_OF_RANDOM_BRAKES
            )
            every = np.concatenate([new, worn])
            # The longest tail, 0.2 % of the brakes, is left out of the bins.
            bins = np.linspace(every.min(), np.quantile(every, 0.998), 36)
            counts = []
            for values, color, said in ((new, NEW, "new"), (worn, WORN, "worn in")):
                count, *_ = axes.hist(
                    values, bins, color=color, alpha=0.45, label=said, density=True
                )
                counts.append(float(count.max()))
            top = max(counts)
            # Above the histograms: 5th, 50th and 95th percentile.
            for values, color, height in ((new, NEW, 1.08), (worn, WORN, 1.17)):
                low, middle, high = np.percentile(values, (5, 50, 95))
                axes.plot([low, high], [height * top] * 2, color=color, lw=2)
                axes.plot([low, middle, high], [height * top] * 3, "|", color=color, ms=10, mew=2)
            axes.axvline(nominal[name], color=LAW, lw=1.8, ls="--", label="sine law, nominal")
            axes.set_xlabel(label)
            axes.set_yticks([])
            axes.set_ylim(0, 1.26 * top)
        axes.plot(
            [],
            [],
            "|-",
            color=COLOR_OF_AXES_AND_NOTES,
            ms=10,
            mew=2,
            lw=2,
            label="5th, 50th and 95th percentile",
        )
        for axes in grid[::columns]:
            axes.set_ylabel("probability density")
        draw_legend_below_figure(figure, grid[-1])
    return figure


def draw_sobol_indices(
    found: Mapping[str, Mapping[str, Sequence[FirstAndTotalSobolIndexOfTolerance]]],
) -> Figure:
    """Sobol indices as bars with confidence intervals, sorted by the totals of the first panel.

    found : indices by state and quantity.
    """
    panels = (
        ("Torque, new", found["new"]["torque"]),
        ("Torque, worn in", found["worn in"]["torque"]),
        ("Peak pressure, new", found["new"]["peak_pressure"]),
    )
    with mpl.rc_context(MATPLOTLIB_SETTINGS_FOR_PRINT):
        order = np.argsort([share.total.value for share in panels[0][1]])
        figure = make_figure_for_print(0.6 + 0.32 * len(order))
        grid = figure.subplots(1, len(panels), squeeze=False, sharey=True)[0]
        at = np.arange(len(order))
        for axes, (title, several) in zip(grid, panels, strict=True):
            color = WORN if "worn" in title else NEW
            # The total index above, the first-order index below.
            for kind, shift, fill in (("total", 0.19, TINTS[color]), ("first", -0.19, color)):
                index = []
                for i in order:
                    index.append(getattr(several[i], kind))
                value = np.array([one.value for one in index])
                error = np.abs(
                    np.array([[one.value - one.low, one.high - one.value] for one in index]).T
                )
                name = "with its interactions (total)" if kind == "total" else "alone (first order)"
                axes.barh(at + shift, np.maximum(value, 0), 0.36, color=fill, label=name)
                axes.errorbar(
                    value, at + shift, xerr=error, fmt="none", ecolor=INK, elinewidth=0.9, capsize=2
                )
            axes.set_title(title)
            axes.set_xlabel("share of the variance [–]")
            axes.set_xlim(-0.06, None)
            axes.axvline(0, color=COLOR_OF_AXES_AND_NOTES, lw=0.8)
            axes.set_yticks(at, [several[i].name for i in order])
            axes.grid(visible=False, axis="y")
        axes.errorbar(
            [],
            [],
            xerr=[],
            fmt="none",
            ecolor=INK,
            elinewidth=0.9,
            capsize=2,
            label="confidence interval",
        )
        draw_legend_below_figure(figure, axes)
    return figure


def draw_percentiles_over_distance(
    distances: Floats, healed: Mapping[str, Floats], nominal: Mapping[str, float]
) -> Figure:
    """Percentiles of torque and peak pressure over the sliding distance.

    Parameters
    ----------
    distances : array
        Sliding distances [1/(k K)].
    healed : mapping
        Torque [N m] and peak pressure [Pa] (brakes, distances).
    nominal : mapping
        Both of the nominal brake by the law.
    """
    panels = (
        ("torque of the brake [N m]", healed["torque"], nominal["torque"]),
        ("peak pressure [MPa]", 1e-6 * healed["peak_pressure"], nominal["peak_pressure"]),
    )
    with mpl.rc_context(MATPLOTLIB_SETTINGS_FOR_PRINT):
        figure = make_figure_for_print(2.8)
        grid = figure.subplots(1, len(panels), squeeze=False)[0]
        for axes, (label, values, law) in zip(grid, panels, strict=True):
            rows = np.array(
                [mean_and_percentiles_of_sample(column).percentiles for column in values.T]
            ).T
            axes.fill_between(
                distances,
                rows[0],
                rows[4],
                color=WORN,
                alpha=0.15,
                lw=0,
                label="1st to 99th percentile",
            )
            axes.fill_between(
                distances,
                rows[1],
                rows[3],
                color=WORN,
                alpha=0.3,
                lw=0,
                label="5th to 95th percentile",
            )
            axes.plot(distances, rows[2], color=WORN, lw=2, label="median")
            axes.axhline(law, color=LAW, lw=1.8, ls="--", label="sine law, nominal")
            axes.set_xscale("symlog", linthresh=1.0)
            axes.set_xlim(0, distances[-1])
            axes.set_xlabel("sliding distance · k K [–]")
            axes.set_ylabel(label)
        draw_legend_below_figure(figure, grid[0])
    return figure
