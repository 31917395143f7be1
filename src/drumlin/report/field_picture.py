"""The picture of the stresses in the shoes and the ring, in the plane of the drum.

The picture is drawn by matplotlib, in the process that has solved the brake.
"""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, PathPatch
from matplotlib.path import Path

from drumlin.base.arrays import Floats, Ints
from drumlin.base.round_numbers import largest_round_number_not_above_value
from drumlin.brake.brake import Brake
from drumlin.brake.fields import Point
from drumlin.brake.support import SupportedShoe
from drumlin.fem.analysis.fields import StressAndDisplacementFields
from drumlin.report.figures import (
    COLUMN_WIDTH,
    FULL_WIDTH,
    MATPLOTLIB_SETTINGS_FOR_PRINT,
    PIXELS_PER_INCH,
    height_of_title,
    number_of_panels_side_by_side,
    title_folded_into_lines,
    write_title_above_picture,
)
from drumlin.report.palette import COLOR_OF_AXES_AND_NOTES, INK, RED
from drumlin.report.signs import MM_PER_M
from drumlin.response.balance import brake_with_forces_of_response
from drumlin.response.response import Response

ROUND_UPPER_ENDS_OF_COLOUR_BAR = 1, 1.2, 1.6, 2, 2.4, 3.2, 4, 6, 8, 10
"""Allowed upper ends of the colour bar, times any power of ten.

The colour bar has labels at quarters of its length. The quarters of these numbers are round, too.
"""

PERCENTAGE_OF_PLANE_NODES_WITHIN_COLOUR_BAR = 99.5
"""Percentage of the nodes whose stress is within the colour bar.

Stresses at singular edges are far above all other stresses. With all of them in the colour bar, the
rest of the shoe would have one colour. The arrow at the upper end of the bar shows that a few
stresses are larger. The value is a judgement by eye.
"""

LARGEST_DRAWN_DISPLACEMENT_OVER_RADIUS = 0.04
"""Largest length of an enlarged displacement, relative to the drum's radius.

Longer displacements would hide the shape of the shoes. The value is a judgement by eye. On a plane,
half the length of the brake takes the place of the drum's radius.
"""

LONGEST_PRESSURE_ARROW_OVER_RADIUS = 0.2
"""Length of the longest pressure arrows, relative to the drum's radius.

On a plane, half the length of the brake takes the place of the drum's radius.
"""

PERCENTAGE_OF_PROPORTIONAL_ARROWS = 90
"""Percentage of the pressure arrows whose length is in proportion to the pressure.

Pressures at singular edges are far above all other pressures. The longest tenth of the arrows is
therefore shortened to one length.
"""

FORCE_ARROW_LENGTH_OVER_RADIUS = 0.28
"""Length of each force's arrow, relative to the drum's radius.

On a plane, half the length of the brake takes the place of the drum's radius.
"""

PRESSURE_ARROW_SPACING_OVER_RADIUS = math.radians(2.5)
"""Distance between neighbouring pressure arrows, relative to the drum's radius.

On a plane, half the length of the brake takes the place of the drum's radius.
"""

DRAWN_PIN_RADIUS_OVER_DRUM_RADIUS = 0.035
"""Radius of the disc that shows a pin, relative to the drum's radius.

On a plane, half the length of the brake takes the place of the drum's radius.
"""

PICTURE_MARGIN_OVER_RADIUS = 0.03
"""Blank margin around the brake and all arrows, relative to the drum's radius.

On a plane, half the length of the brake takes the place of the drum's radius.
"""

PRESSURE_SHAFT_WIDTH, FORCE_SHAFT_WIDTH = 0.0022, 0.0045
"""Widths of the shafts of pressure and force arrows, relative to the width of matplotlib's axes."""

ARROW_HEAD_WIDTH_OVER_SHAFT_WIDTH = 4
"""Width of an arrow's head, relative to the width of its shaft."""

BAR_WIDTH, COLOUR_BAR_WIDTH = 0.75, 0.14
"""Widths of the colour bar with and without its labels [inches]."""

LEGEND_HEIGHT_OF_PAGE, LEGEND_HEIGHT_OF_COLUMN = 0.6, 1.05
"""Height [inches] of the legend in a picture for a page and for a column."""

LEAST_HEIGHT, MOST_HEIGHT = 1.9, 7.5
"""Smallest and largest height of the brake in the picture [inches].

The colour bar with its label needs the smallest height, and with the largest height the picture
and its caption fit on a page.
"""

SAMPLES_PER_PIXEL_SIDE = 2
"""Number of samples in each direction that are averaged for a pixel of the stress colours."""

LARGEST_CELL_SAMPLE_SPACING_IN_PIXELS = 0.7
"""Largest distance [pixels] between neighbouring sampled places of a cell.

With distances of more than one pixel, some pixels within a cell would get no sample."""


class _DrawnFrictionSurface(NamedTuple):
    """The friction surface to draw.

    Attributes
    ----------
    line : points (n, 2) [m] of the drum's circle or of the plane
    size : length [m] to which the sizes of arrows and symbols are relative: the drum's radius, or,
        on a plane, half the length of the brake
    name : "drum" or "plane"
    """

    line: Floats
    size: float
    name: str


def draw_stress_in_shoes_and_ring(
    brake: Brake,
    response: Response,
    bodies: Sequence[StressAndDisplacementFields],
    width: float = FULL_WIDTH,
) -> Figure:
    """Draw the von Mises stress on the deformed bodies, pressure, forces, pins and drum or plane.

    Parameters
    ----------
    brake : the brake
    response : response of the brake by finite elements
    bodies : displacements and stresses of all shoes, and of the drum ring if it is elastic
    width : width of the picture [inches], FULL_WIDTH or COLUMN_WIDTH
    """
    surface = _friction_surface_of_brake(brake)
    size = MM_PER_M * surface.size
    largest = max(float(np.linalg.norm(body.displacement, axis=1).max()) for body in bodies)
    factor = largest_round_number_not_above_value(
        LARGEST_DRAWN_DISPLACEMENT_OVER_RADIUS * surface.size / (largest or 1.0)
    )
    line = MM_PER_M * surface.line
    deformed = [MM_PER_M * (body.points + factor * body.displacement) for body in bodies]
    drawn = _pressure_arrows(brake, response, surface.size)
    pressure = MM_PER_M * drawn.places
    forces = MM_PER_M * _force_arrows(brake_with_forces_of_response(brake, response), surface.size)
    pins = [MM_PER_M * point for point in _points_of_supports(brake)]
    radius = DRAWN_PIN_RADIUS_OVER_DRUM_RADIUS * size
    discs = [pin + radius * np.array([[-1.0, -1.0], [1.0, 1.0]]) for pin in pins]
    places = [line, *deformed, pressure.reshape(-1, 2), forces.reshape(-1, 2), *discs]
    with mpl.rc_context(MATPLOTLIB_SETTINGS_FOR_PRINT):
        motion = f"{brake.motion_as_text}; displacements × {factor:g}"
        title = title_folded_into_lines(brake.title, motion, width)
        figure, axes, bar = _figure_that_shows_all_points(
            np.concatenate(places), size, title, width
        )
        _draw_stress_and_colour_bar(axes, bar, bodies, deformed)
        for body in bodies:
            outline = MM_PER_M * body.points[_edges_of_outline(body)]
            edges = PathPatch(_path_of_edges(outline), fill=False, zorder=2)
            edges.set(edgecolor=COLOR_OF_AXES_AND_NOTES, linewidth=0.5)
            axes.add_patch(edges)
        axes.plot(*line.T, color="black", lw=1.2)
        _draw_arrows(axes, pressure, RED, PRESSURE_SHAFT_WIDTH)
        _draw_arrows(axes, forces, INK, FORCE_SHAFT_WIDTH)
        for x, y in pins:
            axes.add_patch(Circle((x, y), radius, color=INK, zorder=6))
        write_title_above_picture(figure, title)
        force = "actuation or link" if brake.links else "actuation"
        _write_legend(figure, surface.name, drawn.pressure_of_longest, force)
    return figure


def _figure_that_shows_all_points(
    places: Floats, size: float, title: str, figure_width: float = FULL_WIDTH
) -> tuple[Figure, Axes, Axes]:
    """A figure of a width, its axes with limits around all places, and the colour bar's axes.

    The height of the figure follows from the places, so that no part of it stays empty.

    Parameters
    ----------
    places : points (n, 2) [mm] that the axes must show, with a margin for the heads of arrows
    size : the drum's radius [mm]; on a plane, half the length of the brake [mm]
    title : lines of the title, for which the figure has room above the axes
    figure_width : width of the figure [inches], FULL_WIDTH or COLUMN_WIDTH
    """
    room = figure_width - BAR_WIDTH
    in_column = figure_width == COLUMN_WIDTH
    legend_height = LEGEND_HEIGHT_OF_COLUMN if in_column else LEGEND_HEIGHT_OF_PAGE
    low, high = places.min(axis=0), places.max(axis=0)
    # Half of a head's width is in proportion to the width of the axes with both margins.
    head = 0.5 * ARROW_HEAD_WIDTH_OVER_SHAFT_WIDTH * FORCE_SHAFT_WIDTH
    margin = (PICTURE_MARGIN_OVER_RADIUS * size + head * (high[0] - low[0])) / (1 - 2 * head)
    low, high = low - margin, high + margin
    width, height = high - low
    # Flat brakes get room above and below, since the colour bar needs some height.
    lacking = max(LEAST_HEIGHT / room * width - height, 0.0)
    low[1], high[1], height = low[1] - lacking / 2, high[1] + lacking / 2, height + lacking
    shown_height = min(room * height / width, MOST_HEIGHT)
    shown_width = shown_height * width / height
    total = shown_height + height_of_title(title) + legend_height
    figure = Figure(figsize=(figure_width, total))
    left = 0.5 * (room - shown_width) / figure_width
    bottom, relative = legend_height / total, shown_height / total
    axes = figure.add_axes((left, bottom, shown_width / figure_width, relative))
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
    axes.set_axis_off()
    right = left + (shown_width + 0.12) / figure_width
    bar_width = COLOUR_BAR_WIDTH / figure_width
    bar = figure.add_axes((right, bottom + 0.2 * relative, bar_width, 0.6 * relative))
    return figure, axes, bar


def _draw_arrows(axes: Axes, arrows: Floats, color: str, width: float) -> None:
    """Draw arrows from tails to tips (n, 2, 2) [mm].

    `width` is the width of the arrows' shafts, relative to the width of the axes.
    """
    tails, tips = arrows[:, 0], arrows[:, 1]
    axes.quiver(
        *tails.T,
        *(tips - tails).T,
        color=color,
        width=width,
        headwidth=ARROW_HEAD_WIDTH_OVER_SHAFT_WIDTH,
        angles="xy",
        scale_units="xy",
        scale=1,
        zorder=5,
    )


def _draw_stress_and_colour_bar(
    axes: Axes, bar: Axes, bodies: Sequence[StressAndDisplacementFields], deformed: Sequence[Floats]
) -> None:
    """Colour the deformed bodies by their von Mises stress, and draw the colour bar.

    `deformed` are the deformed points (n, 2) [mm] of each body.
    """
    stresses = [1e-6 * body.von_mises for body in bodies]
    highest = float(
        np.percentile(np.concatenate(stresses), PERCENTAGE_OF_PLANE_NODES_WITHIN_COLOUR_BAR)
    )
    top = rounded_up_to_end_of_colour_bar(highest)
    colours = ScalarMappable(Normalize(0, top), "viridis")
    (left, right), (bottom, above) = axes.get_xlim(), axes.get_ylim()
    shown_width = axes.get_window_extent().width / axes.figure.dpi
    pixel = (right - left) / (shown_width * PIXELS_PER_INCH)
    shape = (math.ceil((above - bottom) / pixel), math.ceil((right - left) / pixel))
    fine = np.full(
        (SAMPLES_PER_PIXEL_SIDE * shape[0], SAMPLES_PER_PIXEL_SIDE * shape[1]), np.nan, np.float32
    )
    for body, points, stress in zip(bodies, deformed, stresses, strict=True):
        columns_and_rows = (points - (left, bottom)) / pixel * SAMPLES_PER_PIXEL_SIDE
        paint_values_of_cells(fine, columns_and_rows, body.cells, stress)
    axes.imshow(
        _colours_with_smooth_edges(fine, colours),
        extent=(left, left + shape[1] * pixel, bottom, bottom + shape[0] * pixel),
        origin="lower",
        aspect="auto",
        interpolation="none",
    )
    axes.set(xlim=(left, right), ylim=(bottom, above))
    beyond = max(float(stress.max()) for stress in stresses) > top
    draw_colour_bar_of_stress(bar, colours, beyond=beyond)


def draw_colour_bar_of_stress(bar: Axes, colours: ScalarMappable, *, beyond: bool) -> None:
    """Draw the colour bar of the von Mises stress [MPa] into the axes `bar`.

    With `beyond`, an arrow at the upper end of the bar shows that some stresses are larger.
    """
    bar.figure.colorbar(
        colours,
        cax=bar,
        label="von Mises stress [MPa]",
        ticks=list(np.linspace(0, colours.norm.vmax or 0.0, 5)),
        extend="max" if beyond else "neither",
        format="%.4g",
    )


def _colours_with_smooth_edges(fine: Any, colours: ScalarMappable) -> Any:
    """The colours (rows, columns, 3), from 0 to 255, of a picture's pixels, from samples of values.

    `fine` holds the samples. It has SAMPLES_PER_PIXEL_SIDE times as many rows and columns as the
    picture has pixels. The colour of a pixel is the mean colour of the pixel's samples. Samples
    without a value (NaN) are white.
    """
    painted = ~np.isnan(fine)
    shades = np.full((*fine.shape, 3), 255, np.uint8)
    # A table of 256 colours is faster than one colour for each value.
    table = colours.cmap(np.arange(256), bytes=True)[:, :3]
    relative = np.asarray(colours.norm(fine[painted]), float)
    shades[painted] = table[np.clip(256 * relative, 0, 255).astype(np.uint8)]
    sums = np.zeros(
        (fine.shape[0] // SAMPLES_PER_PIXEL_SIDE, fine.shape[1] // SAMPLES_PER_PIXEL_SIDE, 3),
        np.uint16,
    )
    for row, column in np.ndindex(SAMPLES_PER_PIXEL_SIDE, SAMPLES_PER_PIXEL_SIDE):
        sums += shades[row::SAMPLES_PER_PIXEL_SIDE, column::SAMPLES_PER_PIXEL_SIDE]
    return (sums // SAMPLES_PER_PIXEL_SIDE**2).astype(np.uint8)


def paint_values_of_cells(image: Any, points: Floats, cells: Ints, values: Floats) -> None:
    """Paint nodal values into the pixels of an image that the cells of a mesh cover.

    Within a cell the value is bilinear between its nodes. Each cell is sampled at places that are
    at most LARGEST_CELL_SAMPLE_SPACING_IN_PIXELS apart, so that no pixel within a cell stays empty.

    Parameters
    ----------
    image : pixels (rows, columns), which are changed; the other pixels keep their values
    points : places (n, 2) of the nodes, as column and row in pixels
    cells : numbers (m, 3 or 4) of the nodes of each cell
    values : values (n,) at the nodes
    """
    # A triangle counts as a quadrilateral whose last two corners are at one place.
    corners = cells if cells.shape[1] == 4 else cells[:, [0, 1, 2, 2]]
    places = points[corners]
    sides = np.linalg.norm(places - np.roll(places, -1, axis=1), axis=2)
    # Numbers of samples in both directions of a cell. They are rounded up to powers of two, so that
    # many cells have the same numbers and are sampled at once.
    lengths = np.stack([sides[:, 0::2].max(axis=1), sides[:, 1::2].max(axis=1)], axis=1)
    powers = np.ceil(
        np.log2(np.maximum(lengths / LARGEST_CELL_SAMPLE_SPACING_IN_PIXELS, 1.0))
    ).astype(int)
    for across, along in np.unique(powers, axis=0):
        own = (powers == (across, along)).all(axis=1)
        x, y = ((np.arange(2**power) + 0.5) / 2**power for power in (across, along))
        weights = np.stack(
            [np.outer(1 - x, 1 - y), np.outer(x, 1 - y), np.outer(x, y), np.outer(1 - x, y)]
        ).reshape(4, -1)
        column, row = np.einsum("mcd,cs->dms", places[own], weights).astype(np.int64)
        image[row, column] = values[corners[own]] @ weights


def _edges_of_outline(body: StressAndDisplacementFields) -> Ints:
    """The edges (n, 2) of a body's cells, as node numbers, that belong to one cell only.

    Nodes at one place count as one node, since a body has separate nodes for each material.
    """
    # Places that are nearer than a ten-millionth of the body's length are one place.
    grid = np.round(body.points / (1e-7 * np.ptp(body.points))).astype(np.int64)
    _, same = np.unique(grid, axis=0, return_inverse=True)
    edges = np.stack([body.cells, np.roll(body.cells, -1, axis=1)], axis=-1).reshape(-1, 2)
    merged = np.sort(same.reshape(-1)[edges], axis=1)
    _, first, count = np.unique(merged, axis=0, return_index=True, return_counts=True)
    return np.asarray(edges[first[count == 1]])


def _path_of_edges(edges: Floats) -> Path:
    """A path with the edges (n, 2, 2), each from its begin to its end.

    Matplotlib draws one path faster than a line for each edge.
    """
    codes = np.tile([Path.MOVETO, Path.LINETO], len(edges))
    return Path(edges.reshape(-1, 2), codes)


def _friction_surface_of_brake(brake: Brake) -> _DrawnFrictionSurface:
    """The line of a brake's friction surface, and the length by which symbols are scaled."""
    if not brake.surface.is_plane_and_not_drum:
        turn = np.linspace(0, 2 * math.pi, 361)
        circle = brake.size * np.column_stack([np.cos(turn), np.sin(turn)])
        return _DrawnFrictionSurface(circle, brake.size, "drum")
    ends: list[float] = []
    for shoe in brake.shoes:
        ends += [shoe.pin.x, shoe.actuation.point.x, shoe.lining.start, shoe.lining.end]
    left, right = min(ends), max(ends)
    line = np.array([[left, 0.0], [right, 0.0]])
    return _DrawnFrictionSurface(line, 0.5 * (right - left), "plane")


def _points_of_supports(brake: Brake) -> list[Floats]:
    """The points (2,) [m] that support the shoes: pins, levers' pivots, abutments and anchors."""
    found: list[Floats] = []
    for shoe in brake.shoes:
        found += [point.xy for point in _support_points_of_shoe(shoe)]
    return found


def _support_points_of_shoe(shoe: SupportedShoe) -> list[Point]:
    """The points that support a shoe: pin, lever's pivot, abutment and anchors, if it has them."""
    foot = None if shoe.abutment is None else shoe.abutment.point
    anchors = [anchor.point for anchor in shoe.anchors]
    return [point for point in (shoe.hinge, shoe.pivot, foot, *anchors) if point is not None]


def _force_arrows(brake: Brake, size: float) -> Floats:
    """Tail and tip (n, 2, 2) [m] of an arrow of the same length for each actuation force."""
    arrows = []
    for shoe in brake.shoes:
        force = np.asarray(shoe.actuation.force_vector, float)
        if force.any():
            tail = shoe.actuation.point.xy
            along = force / float(np.linalg.norm(force))
            arrows.append([tail, tail + FORCE_ARROW_LENGTH_OVER_RADIUS * size * along])
    return np.array(arrows).reshape(-1, 2, 2)


class _PressureArrows(NamedTuple):
    """Arrows of the pressure.

    Attributes
    ----------
    places : tail and tip (n, 2, 2) [m]
    pressure_of_longest : least pressure [Pa] of an arrow of the largest length; nan without arrows
    """

    places: Floats
    pressure_of_longest: float


def _pressure_arrows(brake: Brake, response: Response, size: float) -> _PressureArrows:
    """Arrows of the pressure, evenly spread over the contact.

    `size` [m] is the drum's radius, or, on a plane, half the length of the brake.
    """
    is_plane = brake.surface.is_plane_and_not_drum
    spacing = PRESSURE_ARROW_SPACING_OVER_RADIUS * (size if is_plane else 1.0)
    tips, pushes = [], []
    for shoe, answer in zip(brake.shoes, response.shoes, strict=True):
        first, last = np.ceil(answer.theta[0] / spacing), np.floor(answer.theta[-1] / spacing)
        theta = spacing * np.arange(first, last + 1)
        p = answer.pressure_at(theta)
        theta, p = theta[p > 0], p[p > 0]
        if is_plane:
            tips.append(np.column_stack([theta, np.zeros_like(theta)]))
            pushes.append(np.column_stack([np.zeros_like(p), p]))
        else:
            radial = np.column_stack([np.cos(theta), np.sin(theta)])
            tips.append(size * radial)
            pushes.append(-shoe.sign_internal_plus_external_minus * p[:, None] * radial)
    tip, push = np.concatenate(tips), np.concatenate(pushes)
    if not len(tip):
        return _PressureArrows(np.zeros((0, 2, 2)), math.nan)
    lengths = np.linalg.norm(push, axis=1)
    top = float(np.percentile(lengths, PERCENTAGE_OF_PROPORTIONAL_ARROWS))
    scale = LONGEST_PRESSURE_ARROW_OVER_RADIUS * size / np.maximum(lengths, top)
    return _PressureArrows(np.stack([tip - scale[:, None] * push, tip], axis=1), top)


def length_of_arrows_in_words(pressure_of_longest: float) -> str:
    """What the longest arrows of a picture stand for, by the least of their pressures [Pa]."""
    return f"longest arrows: {1e-6 * pressure_of_longest:.2g} MPa or more"


def _write_legend(figure: Figure, surface: str, pressure_of_longest: float, force: str) -> None:
    """Write below the picture what its symbols mean.

    Parameters
    ----------
    figure : the figure
    surface : "drum" or "plane"
    pressure_of_longest : least pressure [Pa] of an arrow of the largest length; nan without arrows
    force : what exerts the forces on the shoes, such as "actuation"
    """
    arrow: dict[str, Any] = {"marker": ">", "markevery": [1], "ms": 4}
    pressed = f"pressure of the {surface} on the lining"
    if math.isfinite(pressure_of_longest):
        pressed += f"\n({length_of_arrows_in_words(pressure_of_longest)})"
    handles = [
        Line2D([], [], color=RED, lw=1, label=pressed, **arrow),
        Line2D([], [], color=INK, lw=1.4, label=f"force of {force}", **arrow),
        Line2D([], [], color=INK, ls="", marker="o", ms=6, label="pin or foot"),
        Line2D([], [], color="black", lw=1.2, label=surface),
        Line2D([], [], color=COLOR_OF_AXES_AND_NOTES, lw=0.8, label="undeformed outline"),
    ]
    columns = number_of_panels_side_by_side(figure.get_figwidth(), 3)
    figure.legend(handles=handles, loc="lower center", ncols=columns)


def rounded_up_to_end_of_colour_bar(value: float) -> float:
    """The smallest number not below `value` that is a round end of a colour bar."""
    power = 10.0 ** math.floor(math.log10(value)) if value > 0 else 1.0
    return next(
        step * power
        for step in ROUND_UPPER_ENDS_OF_COLOUR_BAR
        if step * power >= value * (1 - 1e-9)
    )
