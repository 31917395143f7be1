"""Figures of the post brake: beams, brake path, friction, clearance, and maps of errors."""

from collections.abc import Mapping, Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure

from drumlin.base.arrays import Floats
from drumlin.base.texts import number_as_text
from drumlin.brake.beam_axis import make_beam_axis
from drumlin.brake.brake import Brake
from drumlin.report.figures import (
    FORMULA_TEXT_SIZE,
    FULL_WIDTH,
    LARGEST_HEIGHT,
    MATPLOTLIB_SETTINGS_FOR_PRINT,
    SMALL_TEXT_SIZE,
    draw_legend_below_figure,
    make_figure_for_print,
    number_of_panels_side_by_side,
    title_of_model_in_figures,
)
from drumlin.report.palette import (
    BLUE,
    COLOR_OF_AXES_AND_NOTES,
    ERROR_SCALE_COLORS,
    GREEN,
    INK,
    OCHRE,
    PURPLE,
    color_and_line_style_of_model,
)
from drumlin_studies.post_brake_rows import (
    AbscissasAndOrdinatesOfCurve,
    FiguresOfMeritOverFriction,
    TorqueDifferencesOverRadiusOffset,
    TorqueErrorMapOverStiffnessGroups,
)

BOUNDS = (0.0, 0.01, 0.05, 0.20, np.inf)
"""Borders of the regions of a map: errors within 1, 5 and 20 %, and beyond."""

OWN_BRAKE_MARK: Mapping[str, Any] = {"color": INK, "ms": 5, "ls": "", "clip_on": False}
"""Options of matplotlib for the triangles at the edges of a map that mark the study's own brake."""

RIM_CURVE_COLORS = (GREEN, PURPLE), (OCHRE, BLUE)
"""Colours of the two curves in the left and in the right panel of the rim's displacements.

The left panel has the foundation model's curve of each shoe. The right panel has curves of two
models, in the colours of these models.
"""


def draw_beam_deflections(
    brake: Brake, found: Sequence[Mapping[str, AbscissasAndOrdinatesOfCurve]]
) -> Figure:
    """Deflection r along each post, by each elastic model."""
    panels = []
    for shoe, models in zip(brake.shoes, found, strict=True):
        panels.append(
            (f"{shoe.name} post", {name: (x, r * 1e3) for name, (x, r) in models.items()})
        )
    return draw_curves_of_models(
        panels, "along the beam from the hinge [m]", "relative deformation r [mm]", zero=True
    )


def draw_torque_over_radius_error(offsets: TorqueDifferencesOverRadiusOffset) -> Figure:
    """Relative change of each shoe's torque over the error of the lining's radius."""
    panels = []
    for shoe, models in offsets.items():
        panels.append(
            (shoe, {name: _scaled_curve(values, 1e3, 1e2) for name, values in models.items()})
        )
    return draw_curves_of_models(
        panels,
        "radius of the lining − radius of the drum [mm]",
        "torque off nominal [%]",
        zero=True,
    )


def draw_merit_over_friction(
    brake: Brake, found: FiguresOfMeritOverFriction, key: str, label: str
) -> Figure:
    """One figure of merit of each shoe over friction.

    Angles are in degrees from the middle of the lining.
    """
    panels = []
    for shoe in brake.shoes:
        middle = 0.5 * (shoe.lining.start + shoe.lining.end)
        models = {}
        for model, values in found[shoe.name].items():
            mu, y = np.array([(mu, getattr(merit, key)) for mu, merit in values]).T
            # The angle counts from the middle of the lining, along the beam.
            if key == "resultant_angle":
                y = (
                    np.degrees(y - middle)
                    * make_beam_axis(shoe.pin.xy, shoe.actuation.point.xy).sense
                )
            models[model] = (mu, y)
        panels.append((f"{shoe.name} shoe", models))
    return draw_curves_of_models(panels, "friction coefficient μ", label)


def _scaled_curve(
    values: Sequence[tuple[float, float]], x: float, y: float
) -> AbscissasAndOrdinatesOfCurve:
    """Points as a curve, with a factor on each coordinate."""
    a, b = np.array(values).T
    return a * x, b * y


def draw_curves_of_models(
    panels: Sequence[tuple[str, Mapping[str, AbscissasAndOrdinatesOfCurve]]],
    xlabel: str,
    ylabel: str,
    columns: int = 2,
    *,
    zero: bool = False,
) -> Figure:
    """Curves of several models in panels with one scale.

    Parameters
    ----------
    panels : sequence of pairs
        Title of a panel, and its curves by name of the model. Words after the name of a model tell
        several curves of the model apart; they are drawn dotted.
    xlabel, ylabel : str
        Labels of the axes.
    columns : int
        Panels side by side.
    zero : bool
        Whether a line marks y = 0.
    """
    with mpl.rc_context(MATPLOTLIB_SETTINGS_FOR_PRINT):
        lines = -(-len(panels) // columns)
        figure = make_figure_for_print(2.2 * lines + 0.3)
        grid = figure.subplots(lines, columns, squeeze=False, sharey=True)
        for axes, (title, models) in zip(grid.flat, panels, strict=False):
            for name, (x, y) in models.items():
                model, _, rest = name.partition(" ")
                # Few points are drawn as marks, many points as a line.
                points = len(x) < 12
                axes.plot(
                    x,
                    y,
                    marker="o" if points else None,
                    ms=4,
                    lw=0 if points else 1.8,
                    **(color_and_line_style_of_model(model) | ({"ls": ":"} if rest else {})),
                    label=f"{title_of_model_in_figures(model)} {rest}".strip(),
                )
            axes.set_title(title)
            axes.set_xlabel(xlabel)
            if zero:
                axes.axhline(0, color=COLOR_OF_AXES_AND_NOTES, lw=0.8)
        for axes in grid[:, 0]:
            axes.set_ylabel(ylabel)
        for axes in grid.flat[len(panels) :]:
            axes.set_visible(False)
        draw_legend_below_figure(figure, grid.flat[0])
    return figure


def draw_rim_displacements(
    own: Mapping[str, AbscissasAndOrdinatesOfCurve], one: Mapping[str, AbscissasAndOrdinatesOfCurve]
) -> Figure:
    """Displacement around the rim in polar axes, with inward displacements towards the centre.

    Parameters
    ----------
    own : mapping
        The paper's rim of each shoe, by its name.
    one : mapping
        The rim under all shoes, by model.
    """
    panels = (
        (
            "as published: each with its twin opposite",
            {f"foundation {name}": _curve_in_mm(z) for name, z in own.items()},
        ),
        (
            "both shoes on one rim",
            {f"{model} both shoes": _curve_in_mm(z) for model, z in one.items()},
        ),
    )
    with mpl.rc_context(MATPLOTLIB_SETTINGS_FOR_PRINT):
        figure = make_figure_for_print(4.2)
        grid = figure.subplots(1, len(panels), squeeze=False, subplot_kw={"projection": "polar"})
        # Room inside and outside the rim for the largest displacement.
        largest = max(float(np.abs(z).max()) for _, models in panels for _, z in models.values())
        for axes, (title, models), colors in zip(grid.flat, panels, RIM_CURVE_COLORS, strict=True):
            turn = np.linspace(0, 2 * np.pi, 200)
            axes.plot(turn, np.zeros(200), color=INK, lw=1, label="unloaded")
            styles = zip(colors, ("-", "--"), strict=True)
            for (name, (theta, z)), (color, style) in zip(models.items(), styles, strict=True):
                model, _, rest = name.partition(" ")
                axes.plot(
                    theta,
                    -z,
                    lw=1.8,
                    color=color,
                    ls=style,
                    label=f"{title_of_model_in_figures(model)}, {rest}",
                )
            axes.set_ylim(-3 * largest, 1.3 * largest)
            axes.set_yticks(
                [-largest, 0, largest],
                [f"{-v:+.2g}" for v in (-largest, 0, largest)],
                fontsize=SMALL_TEXT_SIZE,
            )
            axes.set_title(f"{title} [mm]")
            axes.legend(fontsize=SMALL_TEXT_SIZE, loc="upper center", bbox_to_anchor=(0.5, -0.07))
    return figure


def _curve_in_mm(curve: AbscissasAndOrdinatesOfCurve) -> AbscissasAndOrdinatesOfCurve:
    """A curve in m as a curve in mm."""
    theta, z = curve
    return theta, z * 1e3


def draw_error_maps(
    rows: Sequence[Sequence[TorqueErrorMapOverStiffnessGroups]],
    mark: Sequence[tuple[float, float]],
    width: float = FULL_WIDTH,
) -> Figure:
    """Maps of errors. A cell is one pair of solutions with its error in %.

    Parameters
    ----------
    rows : sequence of sequences of TorqueErrorMapOverStiffnessGroups
        The maps of each row.
    mark : sequence of pairs
        In each row the place of the study's own brake.
    width : float
        Width of the figure [inches], FULL_WIDTH or COLUMN_WIDTH.
    """
    with mpl.rc_context(MATPLOTLIB_SETTINGS_FOR_PRINT):
        columns = number_of_panels_side_by_side(width, len(rows[0]))
        lines = len(rows) * len(rows[0]) // columns
        figure = make_figure_for_print(min(2.5 * lines + 0.3, LARGEST_HEIGHT), width)
        grid = figure.subplots(lines, columns, squeeze=False, sharex=True, sharey=True)
        shades = ListedColormap(ERROR_SCALE_COLORS)
        norm = BoundaryNorm([0, 1, 2, 3, 4], 4)
        for line, panels, place in zip(grid.reshape(len(rows), -1), rows, mark, strict=True):
            for axes, one in zip(line, panels, strict=True):
                # The colour of a cell tells its region of errors; cells without an answer stay
                # white.
                region = np.digitize(np.abs(one.error), BOUNDS[1:-1])
                shown = np.ma.masked_where(np.isnan(one.error), region)
                axes.pcolormesh(
                    _cell_edges(one.x),
                    _cell_edges(one.y),
                    shown,
                    cmap=shades,
                    norm=norm,
                    edgecolor="white",
                    lw=0.5,
                )
                for i, y in enumerate(one.y):
                    for j, x in enumerate(one.x):
                        color = "white" if region[i, j] == 0 else INK
                        said = number_as_text(one.error[i, j] * 100, "+.0f").replace("-", "−")
                        axes.text(
                            x,
                            y,
                            said,
                            ha="center",
                            va="center",
                            fontsize=SMALL_TEXT_SIZE,
                            color=color,
                        )
                _mark_own_brake_beside_map(axes, place)
                axes.set_xscale("log")
                axes.set_yscale("log")
                axes.grid(False)
                # On a page, the model and the lining stand in two lines, since the panels are
                # narrow. The gap is for the mark at the upper edge.
                title = one.title if columns == 1 else "\n".join(one.title.rsplit(", ", 1))
                axes.set_title(title, pad=11)
                axes.label_outer()
        for axes in grid[:, 0]:
            label = r"ring: $k R^4/EI_\mathrm{r}$ [–]"
            axes.set_ylabel(label, fontsize=FORMULA_TEXT_SIZE)
        for axes in grid[-1]:
            axes.set_xlabel(r"beam: $k R^4/EI$ [–]", fontsize=FORMULA_TEXT_SIZE)
        words = ("within 1 %", "within 5 %", "within 20 %", "beyond 20 %")
        handles = []
        for shade, word in zip(ERROR_SCALE_COLORS, words, strict=True):
            handles.append(mpl.patches.Patch(color=shade, label=word))
        own = mpl.lines.Line2D([], [], marker="<", label="the study's own brake", **OWN_BRAKE_MARK)
        legend_columns = 5 if columns > 1 else 2
        figure.legend(handles=[*handles, own], loc="outside lower center", ncols=legend_columns)
    return figure


def _mark_own_brake_beside_map(axes: Axes, place: tuple[float, float]) -> None:
    """Mark a place of a map at its upper and right edge, outside of the cells with their numbers.

    `place` is the place of the study's own brake, in the coordinates of the map.
    """
    x, y = place
    axes.plot([x], [1.025], marker="v", transform=axes.get_xaxis_transform(), **OWN_BRAKE_MARK)
    axes.plot([1.03], [y], marker="<", transform=axes.get_yaxis_transform(), **OWN_BRAKE_MARK)


def _cell_edges(centres: Floats) -> Floats:
    """Edges (n + 1,) of cells around geometrically spaced centres (n,)."""
    ratio = np.sqrt(centres[1] / centres[0])
    return np.append(centres / ratio, centres[-1] * ratio)
