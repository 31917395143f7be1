"""Figures by matplotlib: contact pressures along linings, and errors over numbers of elements.

The drawing functions return a figure. `save_figure` writes it into a file.
"""

import math
import warnings
from bisect import bisect_right
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import RendererAgg
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.ticker import LogFormatter, LogFormatterMathtext

from drumlin.base.arrays import Floats
from drumlin.base.files import temporary_file_replacing_output
from drumlin.brake.surface import FRICTION_SURFACE_OF_DRUM, FrictionSurface
from drumlin.report.palette import CURVE_COLORS, color_and_line_style_of_model, color_of_model
from drumlin.response.response import ShoeResponse

COLUMN_WIDTH, FULL_WIDTH = 85 / 25.4, 170 / 25.4
"""Widths [inches] of figures in print: 85 mm for a column of a page, 170 mm for the whole page."""

TEXT_SIZE, SMALL_TEXT_SIZE = 8.0, 7.0
"""Sizes [points] of text in a figure that is printed at its own width.

Elsevier's page "Artwork sizing" asks for a printed size of 7 points for normal text, and of at
least 6 points for exponents and indices. Numbers in the cells of a coloured table have the small
size.
"""

LARGEST_HEIGHT = 235 / 25.4
"""Largest height [inches] of a figure that fits with its caption on a page of A4."""

MOST_ROWS_OF_PRESSURE_PANELS = 7
"""Largest number of rows of panels in a figure of pressures.

With 8 rows in LARGEST_HEIGHT, titles and numbers leave no room for the curves.
"""

END_OF_COLUMN_FILE_NAME = "_column"
"""Last part of the name of a figure's version for a column, before the file's ending."""

FORMULA_TEXT_SIZE = SMALL_TEXT_SIZE / 0.7
"""Size [points] of a label with exponents or indices, so that these have SMALL_TEXT_SIZE.

Matplotlib draws exponents and indices of formulas at 0.7 of the size of the formula.
"""

PLAIN_NUMBERS = 1e-3, 1e4
"""Smallest and largest number that is written with all digits at the ticks of an axis.

Numbers outside this range are written like 1e-7.
"""

LINE_HEIGHT_OF_TITLE, GAP_AROUND_TITLE = 0.16, 0.09
"""Height of each line of a picture's title, and the gaps above and below it together [inches].

A line of text of TEXT_SIZE is 0.155 inches high with its spacing.
"""

WIDEST_TITLE_LINE_OVER_FIGURE_WIDTH = 0.96
"""Largest width of a line of a picture's title, relative to the width of the picture.

The title begins at 0.01 of the width. The rest is for the rounding of letters to pixels, which
changes the width of a line by some 1 %.
"""

PIXELS_PER_INCH = 160
"""Resolution of PNG files, in pixels per inch of the printed figure."""

MATPLOTLIB_SETTINGS_FOR_PRINT = {
    "font.size": TEXT_SIZE,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#e3e8ed",
    "axes.axisbelow": True,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.titlesize": TEXT_SIZE,
    "legend.frameon": False,
    "legend.fontsize": TEXT_SIZE,
    "svg.hashsalt": "drumlin",
    "svg.fonttype": "path",
}
"""Settings of matplotlib for all figures that are printed at their own width.

With a fixed hash salt, equal figures give identical SVG files.
"""

MATPLOTLIB_SETTINGS_FOR_SCREEN = MATPLOTLIB_SETTINGS_FOR_PRINT | {
    "font.size": 10,
    "axes.titlesize": 10.5,
    "legend.fontsize": 9,
}
"""Settings of matplotlib for figures that are wider than a page and are read on a screen."""

MODEL_TITLES = {
    "fem": "finite elements",
    "cold": "finite elements, cold",
    "sine": "sine law",
    "cosine": "cosine law",
    "block": "block formula",
    "uniform": "uniform pressure",
    "short": "short shoe",
    "pivoted": "shoe on a pivot",
    "linear": "long flat shoe",
    "rigid": "rigid shoe",
    "worn": "finite elements, worn in",
    "foundation": "elastic foundation",
    "lifted": "foundation, unsimplified",
}
"""The name of each model in figures, by its short name in files and options."""

CURVE_NAME_HALF_WIDTH_OVER_AXES_WIDTH = 0.16
"""Half the width of the name written beside a curve, relative to the width of the axes."""

CURVE_NAME_HALF_HEIGHT_OVER_AXES_HEIGHT = 0.05
"""Half the height of the name written beside a curve, relative to the height of the axes."""

PressurePanel = tuple[str, Mapping[str, ShoeResponse]]
"""A panel of the pressure figure: its title, and one shoe's responses by name of the model."""


def make_figure_for_print(height: float, width: float = FULL_WIDTH) -> Figure:
    """An empty figure of a height and a width [inches]; its text has TEXT_SIZE at this width.

    `width` is FULL_WIDTH or COLUMN_WIDTH. The text gets its size if callers draw into the figure
    within `mpl.rc_context(MATPLOTLIB_SETTINGS_FOR_PRINT)`.
    """
    return Figure(figsize=(width, height), layout="constrained")


def number_of_panels_side_by_side(width: float, most: int) -> int:
    """The panels in a row of a figure: `most` on a page, and one in a column, where text is large.

    `width` [inches] is FULL_WIDTH or COLUMN_WIDTH.
    """
    return 1 if width == COLUMN_WIDTH else most


class PlainLogFormatter(LogFormatter):
    """Numbers at the ticks of a logarithmic axis as plain text: 0.001, 10, 1e-7.

    Matplotlib's own powers of ten have exponents that are too small in print.
    """

    def __call__(self, x: float, pos: int | None = None) -> str:
        """The text at a tick; it is empty where matplotlib leaves a tick without a number."""
        return plain_number(x) if super().__call__(x, pos) else ""


def plain_number(value: float) -> str:
    """A number at a tick, with all digits within PLAIN_NUMBERS, and else like 1e-7."""
    if value == 0 or PLAIN_NUMBERS[0] <= abs(value) * (1 + 1e-9) <= PLAIN_NUMBERS[1] * (1 + 2e-9):
        return f"{value:.6g}"
    digits, exponent = f"{value:.6e}".split("e")
    return f"{float(digits):g}e{int(exponent)}"


def number_logarithmic_axes_plainly(figure: Figure) -> None:
    """Write plain numbers like 1e-7 at the ticks of all logarithmic axes of a figure."""
    for axes in figure.axes:
        for axis in (axes.xaxis, axes.yaxis):
            if isinstance(axis.get_major_formatter(), LogFormatterMathtext):
                axis.set_major_formatter(PlainLogFormatter())
            if isinstance(axis.get_minor_formatter(), LogFormatterMathtext):
                axis.set_minor_formatter(PlainLogFormatter())


def save_figure(figure: Figure, path: Path, *, pixels_per_inch: float = PIXELS_PER_INCH) -> Path:
    """Write a figure into a file whole or not at all; returns `path`.

    Logarithmic axes get plain numbers, because exponents are too small in print.

    The ending of the path chooses the format. Equal figures give identical files. A character that
    the font does not have is drawn as a box. The file of a figure for print states the width.
    """
    number_logarithmic_axes_plainly(figure)
    metadata: dict[str, str | None] = {}
    is_for_print = figure.get_figwidth() in {COLUMN_WIDTH, FULL_WIDTH}
    if is_for_print and path.suffix in {".png", ".svg"}:
        width = figure.get_figwidth() * 25.4
        metadata["Description"] = f"drawn for print at a width of {width:.0f} mm"
    # An SVG file gets no date, so that it depends on the figure alone.
    if path.suffix == ".svg":
        metadata["Date"] = None
    with (
        mpl.rc_context(MATPLOTLIB_SETTINGS_FOR_PRINT),
        temporary_file_replacing_output(path) as partial,
        warnings.catch_warnings(),
    ):
        warnings.filterwarnings("ignore", "Glyph .* missing from")
        figure.savefig(partial, dpi=pixels_per_inch, metadata=metadata)
    return path


def save_figure_as_files(
    figure: Figure, path: Path, endings: Sequence[str] = ("svg", "png")
) -> None:
    """Write a figure as PATH.svg for print and as PATH.png for screens, or with other `endings`."""
    for ending in endings:
        save_figure(figure, path.with_name(f"{path.name}.{ending}"))
        # The places of all panels and labels stay as the first file has them.
        figure.set_layout_engine("none")


def save_figure_for_page_and_column(
    draw: Callable[[float], Figure], path: Path, endings: Sequence[str] = ("svg", "png")
) -> None:
    """Write a figure for a page of 170 mm, and beside it one for a column of 85 mm.

    The figure for the column has the panels below each other. A figure for the page that a journal
    shrinks to a column would have letters of 4 points.

    Parameters
    ----------
    draw : draws the figure for a width [inches], FULL_WIDTH or COLUMN_WIDTH
    path : path of the files without ending; END_OF_COLUMN_FILE_NAME follows the name of the second
    endings : endings of the files
    """
    save_figure_as_files(draw(FULL_WIDTH), path, endings)
    in_column = path.with_name(f"{path.name}{END_OF_COLUMN_FILE_NAME}")
    save_figure_as_files(draw(COLUMN_WIDTH), in_column, endings)


def title_folded_into_lines(title: str, last: str, width: float = FULL_WIDTH) -> str:
    """A picture's title, folded into lines that fit into a width, and `last` on lines below it.

    Lines are folded at blanks, and within a word only if the word is wider than a line. A factor
    such as "× 50" stays with the word before it. `width` [inches] is the width of the picture.
    """
    unbroken = last.replace(" × ", "\N{NO-BREAK SPACE}×\N{NO-BREAK SPACE}")
    lines = _lines_no_wider_than(title, width) + _lines_no_wider_than(unbroken, width)
    return "\n".join(lines).replace("\N{NO-BREAK SPACE}×\N{NO-BREAK SPACE}", " × ")


def _lines_no_wider_than(text: str, width: float) -> list[str]:
    """The lines of a text in bold letters of TEXT_SIZE, none wider than a figure allows.

    `width` [inches] is the width of the figure.
    """
    # At 72 pixels per inch the renderer's widths are points.
    renderer = RendererAgg(1, 1, 72)
    font = FontProperties(weight="bold", size=TEXT_SIZE)
    widest = WIDEST_TITLE_LINE_OVER_FIGURE_WIDTH * width * 72

    def width_of_first_letters(count: int) -> float:
        """The width [points] of the first letters of the text that is left."""
        return renderer.get_text_width_height_descent(text[:count], font, False)[0]

    lines = []
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph .* missing from")
        while width_of_first_letters(len(text)) > widest:
            # The largest number of letters that fit into a line.
            most = bisect_right(range(len(text)), widest, key=width_of_first_letters) - 1
            blank = text.rfind(" ", 1, most + 1)
            end = blank if blank > 0 else most
            lines.append(text[:end].rstrip())
            text = text[end:].lstrip()
    return [*lines, text]


def height_of_title(title: str) -> float:
    """The height [inches] that `write_title_above_picture` needs for a title of some lines."""
    return GAP_AROUND_TITLE + LINE_HEIGHT_OF_TITLE * (title.count("\n") + 1)


def write_title_above_picture(figure: Figure, title: str) -> None:
    """Write a title, as `title_folded_into_lines` folds it, at the upper left edge of a figure."""
    top = 1 - 0.06 / figure.get_figheight()
    # A dollar sign in a title is a dollar sign, and begins no formula.
    figure.text(0.01, top, title, va="top", weight="bold", size=TEXT_SIZE, parse_math=False)


def title_of_model_in_figures(model: str) -> str:
    """The name of a model in figures and tables, by its short name in files and options."""
    return MODEL_TITLES.get(model, model)


def draw_legend_below_figure(figure: Figure, axes: Axes, **more: Any) -> None:
    """Draw the legend of `axes` below the whole figure, where it covers no data.

    A label that several curves share appears once. `more` are options of matplotlib's legend.
    """
    handles, labels = axes.get_legend_handles_labels()
    handle_of = dict(zip(labels, handles, strict=True))
    # A column of the legend is as wide as a sample of the curve's line and some 22 letters. This
    # is 2.2 inches at 10 points.
    width = 0.22 * mpl.rcParams["font.size"]
    least = number_of_panels_side_by_side(figure.get_figwidth(), 2)
    columns = min(len(handle_of), max(least, int(figure.get_figwidth() / width)))
    options = {"loc": "outside lower center", "ncols": columns} | more
    figure.legend(handle_of.values(), handle_of.keys(), **options)


def write_name_beside_curve(
    axes: Axes, x: Floats, curves: Sequence[Floats], which: int, words: str, color: str
) -> None:
    """Write the name of a curve beside the curve, if there is a place that no curve crosses.

    Parameters
    ----------
    axes : axes in which the curves are drawn
    x : (n,) x values of all curves
    curves : (n,) y values of each curve
    which : index in `curves` of the curve to be named
    words : name of this curve
    color : colour of the name
    """
    low, high = axes.get_ylim()
    # Convert the y values of the curves to heights, from 0 at the lower end of the axes to 1 at the
    # upper end.
    heights = np.clip((np.array(curves) - low) / (high - low), 0, 1)
    place = _free_place_for_curve_name(heights, which)
    if place is None:
        return
    y = low + place.height * (high - low)
    axes.text(float(x[place.point]), y, words, color=color, ha="center", va="center")


class _FreePlaceForCurveName(NamedTuple):
    """A free place for a curve's name, given by its middle.

    Attributes
    ----------
    point : index of the curve's point above or below which the name stands
    height : height of the name's middle, from 0 at the lower end of the axes to 1 at the upper end
    """

    point: int
    height: float


def _free_place_for_curve_name(heights: Floats, which: int) -> _FreePlaceForCurveName | None:
    """The place for a curve's name, above or below it, that is farthest from all other curves.

    It is None if every place is crossed by a curve or lies beyond the axes. `heights` (curves, n)
    are the y values of the curves, relative to the height of the axes. `which` is the index of the
    named curve.
    """
    n = heights.shape[1]
    half = int(CURVE_NAME_HALF_WIDTH_OVER_AXES_WIDTH * n)
    best, farthest = None, 0.0
    for i in range(half, n - half):
        for side in (1, -1):
            y = heights[which, i] + side * 1.5 * CURVE_NAME_HALF_HEIGHT_OVER_AXES_HEIGHT
            # The vertical distance of each curve from the box that the name would take.
            around = heights[:, i - half : i + half + 1]
            free = np.abs(around - y).min(axis=1) - CURVE_NAME_HALF_HEIGHT_OVER_AXES_HEIGHT
            others = np.delete(free, which).min(initial=1.0)
            is_inside = (
                CURVE_NAME_HALF_HEIGHT_OVER_AXES_HEIGHT
                < y
                < 1 - CURVE_NAME_HALF_HEIGHT_OVER_AXES_HEIGHT
            )
            if free[which] > 0 and others > farthest and is_inside:
                best, farthest = _FreePlaceForCurveName(i, y), float(others)
    return best


def draw_triangles_where_curve_leaves_axes(axes: Axes, x: Floats, y: Floats, color: Any) -> None:
    """Draw a triangle at each stretch in which a curve y (n,) over x (n,) lies above the axes.

    A pressure curve does so at a sharp edge of the lining, where the pressure is unbounded.
    """
    top = axes.get_ylim()[1]
    is_beyond = (y > top).astype(int)
    changes = np.flatnonzero(np.diff(np.concatenate([[0], is_beyond, [0]])))
    for start, end in changes.reshape(-1, 2):
        # The triangle stands on the upper edge of the axes, below the highest point of this stretch
        # of the curve.
        highest = start + int(np.argmax(y[start:end]))
        axes.plot(
            [x[highest]],
            [top],
            "^",
            color=color,
            ms=6,
            clip_on=False,
            zorder=5,
            label="goes on beyond the axis",
        )


def evenly_spaced_pressure_curve_of_shoe(
    shoe: ShoeResponse, points: int = 300
) -> tuple[Floats, Floats]:
    """The pressure curve of a shoe: angles (n,) [rad; on a plane m] and pressures (n,) [Pa].

    The angles are evenly spread. Near both ends of the lining, the curve also has points at the
    nodes of the response.
    """
    even = np.linspace(shoe.theta[0], shoe.theta[-1], points)
    spacing = even[1] - even[0]
    from_end = np.minimum(shoe.theta - shoe.theta[0], shoe.theta[-1] - shoe.theta)
    near = from_end < 3 * spacing
    theta = np.unique(np.concatenate([shoe.theta[near], even]))
    return theta, np.maximum(shoe.pressure_at(theta), 0.0)


def draw_pressure_along_lining_of_each_shoe(
    panels: Sequence[PressurePanel],
    columns: int = 2,
    *,
    surface: FrictionSurface = FRICTION_SURFACE_OF_DRUM,
    width: float = FULL_WIDTH,
) -> Figure:
    """Draw the contact pressure along the lining, in a panel for each shoe.

    If the panels do not fit on a page, each panel shows several successive shoes. All panels have
    one scale of pressure. The unbounded pressure at a sharp edge is cut off above the largest
    pressure away from the edges, and marked by a triangle. If no panel has more than two curves,
    the names also stand beside the curves. A legend below the figure names all curves.

    Parameters
    ----------
    panels : title and responses of each shoe
    columns : number of panels side by side
    surface : friction surface, drum or plane
    width : width of the figure [inches], FULL_WIDTH or COLUMN_WIDTH; a figure of one panel has
        COLUMN_WIDTH in any case
    """
    with mpl.rc_context(MATPLOTLIB_SETTINGS_FOR_PRINT):
        columns = min(number_of_panels_side_by_side(width, columns), len(panels))
        groups = _consecutive_panels_in_groups(panels, columns * MOST_ROWS_OF_PRESSURE_PANELS)
        rows = math.ceil(len(groups) / columns)
        # Two panels side by side fill a page of 170 mm, and one panel a column of 85 mm.
        width = FULL_WIDTH if columns > 1 else COLUMN_WIDTH
        height = min(2.1 * rows + 0.3, LARGEST_HEIGHT)
        figure = make_figure_for_print(height, width)
        grid = figure.subplots(rows, columns, squeeze=False, sharey=True)
        most = max(len(responses) for _, responses in panels)
        few = most <= 2 and len(groups) == len(panels)
        top = _upper_end_of_pressure_axis(panels)
        for axes, group in zip(grid.flat, groups, strict=False):
            axes.set_ylim(0, top)
            _draw_pressure_of_shoes(axes, group, surface, named=few)
            axes.tick_params(labelleft=axes in grid[:, 0])
        for axes in grid[:, 0]:
            axes.set_ylabel("pressure p [MPa]")
        # In each column only the lowest panel labels its horizontal axis. Unused panels stay empty.
        used = list(grid.flat)[: len(groups)]
        for column in range(columns):
            _label_only_lowest_panel(used[column::columns])
        for axes in grid.flat[len(groups) :]:
            axes.set_visible(False)
        # The legend is taken from the panel with the most different labels.
        draw_legend_below_figure(
            figure, max(used, key=lambda axes: len(set(axes.get_legend_handles_labels()[1])))
        )
    return figure


def save_pressure_figure_for_page_and_column(
    panels: Sequence[PressurePanel],
    path: Path,
    endings: Sequence[str] = ("svg", "png"),
    surface: FrictionSurface = FRICTION_SURFACE_OF_DRUM,
) -> None:
    """Write the figure of the pressures along the linings for a page and for a column.

    The parameters are those of `draw_pressure_along_lining_of_each_shoe` and of
    `save_figure_for_page_and_column`.
    """

    def draw(width: float) -> Figure:
        """The figure with a width [inches]."""
        return draw_pressure_along_lining_of_each_shoe(panels, surface=surface, width=width)

    save_figure_for_page_and_column(draw, path, endings)


def _upper_end_of_pressure_axis(panels: Sequence[PressurePanel]) -> float:
    """The upper end [MPa] of the pressure axis: 1.12 times the largest peak, 1 without pressure."""
    peaks: list[float] = []
    for _, responses in panels:
        peaks += [shoe.peak_pressure for shoe in responses.values()]
    highest = max(peaks)
    return 1.12 * highest * 1e-6 if highest > 0 else 1


def _consecutive_panels_in_groups(
    panels: Sequence[PressurePanel], most: int
) -> list[Sequence[PressurePanel]]:
    """Groups of successive panels of equal size; the last may be smaller. At most `most` groups."""
    size = math.ceil(len(panels) / most)
    return [panels[first : first + size] for first in range(0, len(panels), size)]


def _draw_pressure_of_shoes(
    axes: Axes, panels: Sequence[PressurePanel], surface: FrictionSurface, *, named: bool
) -> None:
    """Draw the pressure curves of successive shoes side by side; the title names first and last.

    If `named`, which needs a single shoe, the models' names stand beside the curves.
    """
    first, last = panels[0][0], panels[-1][0]
    axes.set_title(first if first == last else f"{first} to {last}")
    axes.set_xlabel(surface.axis_label_in_report)
    unit = surface.si_to_shown_unit_factor
    for _, responses in panels:
        curves = {}
        for model, shoe in responses.items():
            theta, p = evenly_spaced_pressure_curve_of_shoe(shoe)
            curves[model] = (theta * unit, p * 1e-6)
            _draw_pressure_curve_of_model(axes, model, *curves[model])
        if named:
            _write_models_beside_pressure_curves(axes, curves)
    drawn = np.concatenate([line.get_xdata() for line in axes.lines])
    axes.set_xlim(drawn.min() - 3, drawn.max() + 3)


def _draw_pressure_curve_of_model(axes: Axes, model: str, x: Floats, y: Floats) -> None:
    """Draw the pressure curve y (n,) [MPa] of one shoe over the places x (n,) in shown units."""
    # The curve of worn-in linings coincides with the curve of the law. It is drawn wider, so that
    # it is seen on both sides of the other curve.
    width = 4.0 if model == "worn" else 1.8
    style = color_and_line_style_of_model(model)
    axes.plot(x, y, **style, lw=width, label=title_of_model_in_figures(model))
    draw_triangles_where_curve_leaves_axes(axes, x, y, color_of_model(model))
    if model == "fem":
        axes.fill_between(x, y, color=color_of_model(model), alpha=0.12, lw=0)


def _write_models_beside_pressure_curves(
    axes: Axes, curves: Mapping[str, tuple[Floats, Floats]]
) -> None:
    """Write the models' names beside the curves (x, y) of one shoe."""
    places = [x for x, _ in curves.values()]
    even = np.linspace(places[-1][0], places[-1][-1], 200)
    lines = [np.interp(even, *curve) for curve in curves.values()]
    for i, model in enumerate(curves):
        write_name_beside_curve(
            axes, even, lines, i, title_of_model_in_figures(model), color_of_model(model)
        )


def _label_only_lowest_panel(column: Sequence[Axes]) -> None:
    """Remove the labels of the horizontal axis from all panels of a column except the lowest.

    If the panels show different ranges of this axis, no label is removed.
    """
    if len(set(map(Axes.get_xlim, column))) != 1:
        return
    for axes in column[:-1]:
        axes.set_xlabel("")
        axes.tick_params(labelbottom=False)


def draw_errors_over_element_numbers(
    series: Mapping[str, Sequence[tuple[int, float]]], ylabel: str
) -> Figure:
    """Draw errors over the number of elements along the lining, both on logarithmic scales.

    `series` holds pairs of a number of elements and an error (a fraction), by the name of a curve.
    `ylabel` names the quantity whose errors are drawn.
    """
    with mpl.rc_context(MATPLOTLIB_SETTINGS_FOR_PRINT):
        figure = make_figure_for_print(3.4)
        axes = figure.subplots()
        # Each curve of the figure has its own marker and colour.
        looks = zip("osD^v<>", CURVE_COLORS, strict=False)
        elements: set[int] = set()
        for values in series.values():
            elements |= dict(values).keys()
        for (name, values), (marker, color) in zip(series.items(), looks, strict=False):
            n, e = zip(*values, strict=True)
            axes.loglog(n, np.array(e) * 100, marker=marker, color=color, ms=5, lw=1.4, label=name)
        axes.set_xlabel("elements along the lining")
        axes.set_ylabel(f"{ylabel} [%]")
        axes.set_xticks(sorted(elements))
        axes.xaxis.set_major_formatter("{x:.0f}")
        axes.minorticks_off()
        draw_legend_below_figure(figure, axes, ncols=1)
    return figure
