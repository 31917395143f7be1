"""Figures of the plane-stress study."""

from collections.abc import Mapping, Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from drumlin.base.arrays import Floats
from drumlin.base.texts import number_as_text
from drumlin.report.figures import (
    FULL_WIDTH,
    LARGEST_HEIGHT,
    MATPLOTLIB_SETTINGS_FOR_PRINT,
    SMALL_TEXT_SIZE,
    make_figure_for_print,
    number_of_panels_side_by_side,
)
from drumlin.report.palette import (
    BLUE,
    COLOR_OF_AXES_AND_NOTES,
    GREEN,
    INK,
    RED,
    SKY,
    color_of_model,
)
from drumlin.response.response import ShoeResponse, length_of_edge_zone_left_out_of_peak_search
from drumlin_studies.plane_stress import (
    PlaneStressErrorMap,
    PressuresOfWornSolidLinings,
    ResponsesBySolidAndPlaneStress,
    TimeAndErrors,
    value_of_largest_magnitude_in_rows,
)

PANELS = {
    "torque": "torque",
    "pressure": "mean p over the width (L2)",
    "uneven": "spread of p across the width",
    "corrected_torque": "torque with --finite-width",
}


def draw_error_maps(charts: Sequence[PlaneStressErrorMap], width: float = FULL_WIDTH) -> Figure:
    """Maps of errors of the worst shoe, two panels side by side on a page and one in a column.

    One bar gives the colours of all panels; the fields give the numbers.

    Parameters
    ----------
    charts : the maps
    width : width of the figure [inches], FULL_WIDTH or COLUMN_WIDTH
    """
    with mpl.rc_context(MATPLOTLIB_SETTINGS_FOR_PRINT | {"axes.grid": False}):
        columns = number_of_panels_side_by_side(width, 2)
        rows = len(charts) * len(PANELS) // columns
        figure = make_figure_for_print(min(2.1 * rows + 0.6, LARGEST_HEIGHT), width)
        grid = figure.subplots(rows, columns, squeeze=False)
        panels = [(chart, key) for chart in charts for key in PANELS]
        for axes, (chart, key) in zip(grid.flat, panels, strict=True):
            drawn = _draw_map_panel(axes, chart, key, f"{chart.name}: {PANELS[key]}")
            # In a column, only the lowest panel of a chart labels the horizontal axis.
            if columns == 1 and key != list(PANELS)[-1]:
                axes.set_xlabel("")
                axes.tick_params(labelbottom=False)
            if columns == 1:
                axes.set_ylabel(axes.get_ylabel().replace(" [", "\n["))
        bar = figure.colorbar(
            drawn, ax=list(grid.flat), location="bottom", aspect=40, extend="min", pad=0.01
        )
        # A column is too narrow for the label on one line.
        gap = " " if columns > 1 else "\n"
        bar.set_label(f"numbers in the fields,{gap}and colours by their size [%]")
        bar.set_ticks(COLOUR_BAR_ERRORS, labels=list(map("{:g}".format, COLOUR_BAR_ERRORS)))
        bar.minorticks_off()
    return figure


COLOUR_BAR_ERRORS = (0.03, 0.1, 0.3, 1, 3, 10, 30, 100)
"""Errors [%] at the ticks of the colour bar; smaller errors have the colour of its lower end."""


TWO_DIGITS_BELOW = 10.0
"""Error [%] from which on the numbers of a panel have one digit behind the point, and not two."""


def _draw_map_panel(axes: Axes, chart: PlaneStressErrorMap, key: str, title: str) -> Any:
    """Draw a map of an error: a colour and a number [%] for each brake; returns the image."""
    error = 100 * chart.errors[key]
    least, most = COLOUR_BAR_ERRORS[0], COLOUR_BAR_ERRORS[-1]
    drawn = axes.imshow(
        np.maximum(np.abs(error), 1e-3 * least),
        origin="lower",
        aspect="auto",
        cmap="Blues",
        norm=LogNorm(least, most),
    )
    # All numbers of a panel have the same digits behind the point.
    digits = 1 if np.abs(error).max() >= TWO_DIGITS_BELOW else 2
    sign = "+" if key in {"torque", "corrected_torque"} else ""
    for j, i in np.ndindex(*error.shape):
        said = number_as_text(float(error[j, i]), f"{sign}.{digits}f").replace("-", "−")
        color = "white" if abs(error[j, i]) > 5 else INK
        axes.text(i, j, said, ha="center", va="center", fontsize=SMALL_TEXT_SIZE, color=color)
    x, y = chart.axes
    axes.set_xticks(range(len(chart.x)), list(map("{:g}".format, chart.x)))
    axes.set_yticks(range(len(chart.y)), list(map("{:g}".format, chart.y)))
    axes.set_xlabel(x)
    axes.set_ylabel(y)
    axes.set_title(title, fontweight="normal")
    return drawn


def draw_face_pressures(
    three: ResponsesBySolidAndPlaneStress,
    worn: PressuresOfWornSolidLinings,
    width: float = FULL_WIDTH,
) -> Figure:
    """Pressure on the faces of the linings, new and worn in, with one scale.

    `width` [inches] is FULL_WIDTH or COLUMN_WIDTH.
    """
    with mpl.rc_context(MATPLOTLIB_SETTINGS_FOR_PRINT | {"axes.grid": False}):
        new = three.solid.shoes
        columns = number_of_panels_side_by_side(width, 2)
        rows = 2 * len(new) // columns
        figure = make_figure_for_print(min(1.7 * rows + 0.5, LARGEST_HEIGHT), width)
        grid = figure.subplots(rows, columns, squeeze=False)
        # The singular pressure at the ends of the linings is outside the scale.
        zones = [
            length_of_edge_zone_left_out_of_peak_search(shoe, three.brake.size)
            for shoe in three.brake.shoes
        ]
        top = max(_largest_face_pressure(shoe, zone) for shoe, zone in zip(new, zones, strict=True))
        for row, a, b in zip(grid.reshape(-1, 2), new, worn.last, strict=True):
            for axes, shoe, state in ((row[0], a, "new"), (row[1], b, "worn in")):
                assert shoe.surface is not None
                drawn = axes.pcolormesh(
                    np.degrees(shoe.theta),
                    shoe.surface.z * 1e3,
                    shoe.surface.pressure.T * 1e-6,
                    shading="gouraud",
                    rasterized=True,
                    cmap="viridis",
                    vmin=0,
                    vmax=top * 1e-6,
                )
                helps = "assists" if shoe.self_energising else "opposes"
                axes.set_title(f"{shoe.name}, friction {helps}, {state}")
                axes.set_xlabel("angle on the drum θ [deg]")
                axes.set_ylabel("across the width z [mm]")
        # A column has no room for the bar beside the panels and their titles.
        side = "right" if columns > 1 else "bottom"
        bar = figure.colorbar(drawn, ax=list(grid.flat), location=side, shrink=0.8)
        bar.set_label("pressure p [MPa]")
    return figure


def _largest_face_pressure(shoe: ShoeResponse, zone: float) -> float:
    """The largest pressure [Pa] on the face, without a zone [rad] at each end of the lining."""
    assert shoe.surface is not None
    inside = (shoe.theta > shoe.theta[0] + zone) & (shoe.theta < shoe.theta[-1] - zone)
    return float(shoe.surface.pressure[inside].max())


def draw_error_curves(found: Mapping[str, Sequence[tuple[float, list[dict[str, Any]]]]]) -> Figure:
    """Errors of the worst shoe, a panel for each quantity that varies."""
    with mpl.rc_context(MATPLOTLIB_SETTINGS_FOR_PRINT):
        figure = make_figure_for_print(4.6)
        panels = np.ravel(figure.subplots(2, len(found) // 2, sharey=True))
        for axes, (name, points) in zip(panels, found.items(), strict=True):
            x = []
            for value, _ in points:
                x.append(value)
            for key, label, marker in (
                ("torque", "torque", "o"),
                ("pressure", "p averaged over the width (L2)", "s"),
                ("peak", "peak pressure against the face's", "v"),
                ("reaction", "hinge reaction", "D"),
                ("corrected_torque", "torque, corrected", "^"),
            ):
                y = []
                for _, table in points:
                    y.append(100 * abs(value_of_largest_magnitude_in_rows(table, key)))
                axes.semilogy(x, y, marker=marker, lw=1.5, label=label)
            # Quantities that vary over more than a decade have a logarithmic axis.
            if max(x) > 10 * max(min(x), 0.1):
                axes.set_xscale("log")
            axes.set_xlabel(name)
        for axes in panels[:: len(found) // 2]:
            axes.set_ylabel("error of plane stress, worst shoe [%]")
        figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=5)
    return figure


def draw_unevenness_over_distance(worn: PressuresOfWornSolidLinings) -> Figure:
    """How uneven p is across the width, and its mean against the sine law, over the distance."""
    with mpl.rc_context(MATPLOTLIB_SETTINGS_FOR_PRINT):
        figure = make_figure_for_print(3.4)
        axes = figure.subplots()
        x: Floats = np.asarray(worn.distance)
        for shoe, uneven, law, color in zip(
            worn.last, worn.uneven, worn.distance_from_sine_law, (GREEN, RED), strict=False
        ):
            axes.semilogy(
                x,
                100 * np.array(uneven),
                color=color,
                marker="o",
                ms=4,
                label=f"{shoe.name}: off its mean across the width",
            )
            axes.semilogy(
                x,
                100 * np.array(law),
                color=color,
                ls="--",
                label=f"{shoe.name}: mean off the sine law",
            )
        axes.set_xscale("symlog", linthresh=0.1)
        axes.set_xlabel("sliding distance [1/(k K)]")
        axes.set_ylabel("pressure [%]")
        axes.legend()
    return figure


WAYS = {
    "sine": "sine law",
    "cosine": "cosine law",
    "uniform": "uniform pressure",
    "foundation": "elastic foundation",
    "lifted": "foundation, unsimplified",
    "plane stress": "plane stress",
    "plane stress, corrected": "plane stress, corrected for the width",
    "solid": "solid",
}
COLORS = {"plane stress": BLUE, "plane stress, corrected": SKY}


def draw_error_over_time(
    found: Mapping[str, Sequence[TimeAndErrors]], width: float = FULL_WIDTH
) -> Figure:
    """Error over processor time, a row for each brake, or in a column two rows.

    Full marks are errors against the solid truth, hollow marks against the truth in plane stress.
    `width` [inches] is FULL_WIDTH or COLUMN_WIDTH.
    """
    with mpl.rc_context(MATPLOTLIB_SETTINGS_FOR_PRINT):
        columns = number_of_panels_side_by_side(width, 2)
        rows = 2 * len(found) // columns
        figure = make_figure_for_print(min(2.5 * rows + 0.5, LARGEST_HEIGHT), width)
        grid = figure.subplots(rows, columns, squeeze=False)
        for row, (brake, rungs) in zip(grid.reshape(-1, 2), found.items(), strict=True):
            for axes, key, title in zip(
                row, ("pressure", "torque"), ("p (L2)", "torque"), strict=True
            ):
                for method, name in WAYS.items():
                    _draw_method(axes, [rung for rung in rungs if rung.method == method], key, name)
                axes.set_xlabel("processor time [ms]")
                axes.set_title(f"{brake}:\nerror of {title}, worst shoe [%]")
        # Two entries of the key without points explain the marks.
        grid[0, 0].plot(
            [], [], "o-", color=COLOR_OF_AXES_AND_NOTES, label="full marks: against the solid"
        )
        grid[0, 0].plot(
            [],
            [],
            "o--",
            color=COLOR_OF_AXES_AND_NOTES,
            mfc="white",
            label="hollow marks: against plane stress",
        )
        named = {
            text: line
            for axes in grid.flat
            for line, text in zip(*axes.get_legend_handles_labels(), strict=True)
        }
        legend_columns = number_of_panels_side_by_side(width, 3)
        figure.legend(
            named.values(), named.keys(), loc="outside lower center", ncols=legend_columns
        )
    return figure


def _draw_method(axes: Axes, own: Sequence[TimeAndErrors], key: str, name: str) -> None:
    """Draw the errors of one method over the processor time."""
    if not own:
        return
    method, x = own[0].method, [1e3 * rung.seconds for rung in own]
    color = COLORS.get(method) or color_of_model(method)
    if method not in {
        "solid",
        "plane stress, corrected",
    }:  # whose answer is not meant to be that of plane stress
        hollow = []
        for rung in own:
            hollow.append(100 * getattr(rung, f"plane_{key}"))
        axes.loglog(x, hollow, "o--", color=color, lw=1.0, ms=4, mfc="white")
    axes.loglog(
        x, [100 * getattr(rung, key) for rung in own], "o-", color=color, lw=1.5, ms=4, label=name
    )
