"""A picture of solid (three-dimensional) shoes, which pyvista draws without a window.

The drawing runs in a process of its own, since the graphics library VTK may end the process in
which it runs.
"""

from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from drumlin.base.round_numbers import largest_round_number_not_above_value
from drumlin.report.field_picture import (
    draw_colour_bar_of_stress,
    rounded_up_to_end_of_colour_bar,
)
from drumlin.report.figures import (
    FULL_WIDTH,
    MATPLOTLIB_SETTINGS_FOR_PRINT,
    height_of_title,
    save_figure,
    title_folded_into_lines,
    write_title_above_picture,
)
from drumlin.report.render import draw_picture_in_new_process, draw_picture_named_by_arguments

LARGEST_DRAWN_SOLID_DISPLACEMENT_OVER_RADIUS = 0.05
"""Largest length of an enlarged displacement in the picture, relative to the radius of the shoes.

The radius of the shoes is the largest distance of one of their points from the drum's axis.
Longer displacements would hide the shape of the shoes, and with shorter displacements the
deformation would not be seen.
"""

STRESS_ARRAY_NAME = "von Mises stress [MPa]"
"""The name of the stresses [MPa] in the grid of pyvista."""

PERCENTAGE_OF_SOLID_NODES_WITHIN_COLOUR_BAR = 99.0
"""Percentage of the nodes whose stress is within the colour bar.

The stresses at the loaded ends of the shoes are far larger than all other stresses. With a larger
percentage, the rest of each shoe would have one dark colour. With a smaller percentage, the loaded
ends would have the brightest colour everywhere. The value is a judgement by eye.
"""

SOLID_PICTURE_PIXELS = 2000, 1600
"""Width and height [pixels] in which the shoes are drawn, before their blank margins are cut."""

RELATIVE_WIDTH_OF_DRAWN_SHOES = 0.86
"""Width of the shoes in the picture, relative to the width of the picture."""


def draw_solid_shoes_and_return_failure_reason(
    fields: Path, picture: Path, title: str
) -> str | None:
    """Draw the .vtu file of solid shoes into a .png file.

    Returns None, or one line that says why the picture could not be drawn.
    """
    return draw_picture_in_new_process(__name__, fields, picture, title)


def draw_solid_shoes_in_this_process(fields: Path, picture: Path, title: str) -> None:
    """Draw the von Mises stress on the deformed solid shoes into a .png file, within this process.

    The .vtu file holds half of each shoe, on one side of the middle plane of its width. The picture
    shows both halves.
    """
    import pyvista as pv  # noqa: PLC0415  (only in the process that draws)

    grid = pv.read(fields)
    grid.point_data[STRESS_ARRAY_NAME] = np.asarray(grid.point_data["von Mises [Pa]"]) * 1e-6
    factor = _factor_that_enlarges_drawn_displacements(grid)
    stress = np.asarray(grid.point_data[STRESS_ARRAY_NAME])
    top = rounded_up_to_end_of_colour_bar(
        float(np.percentile(stress, PERCENTAGE_OF_SOLID_NODES_WITHIN_COLOUR_BAR))
    )
    plotter = pv.Plotter(off_screen=True, window_size=SOLID_PICTURE_PIXELS)
    plotter.set_background("white")
    for half in _deformed_surfaces_of_both_halves(grid, factor):
        plotter.add_mesh(
            half,
            scalars=STRESS_ARRAY_NAME,
            cmap="viridis",
            clim=(0, top),
            show_scalar_bar=False,
            smooth_shading=False,
            ambient=0.35,
        )
    plotter.view_vector((0.35, 0.55, 1.0), viewup=(0, 1, 0))
    plotter.enable_parallel_projection()
    plotter.reset_camera()
    pixels = _pixels_without_white_margins(np.asarray(plotter.screenshot(return_img=True)))
    lines = title_folded_into_lines(title, f"displacements × {factor:g}")
    figure = _figure_around_pixels(pixels, lines, top, beyond=float(stress.max()) > top)
    save_figure(figure, picture)


def _pixels_without_white_margins(pixels: Any) -> Any:
    """The part of an image (rows, columns, 3) that holds all pixels that are not white."""
    drawn = (pixels < 255).any(axis=2)
    rows, columns = np.flatnonzero(drawn.any(axis=1)), np.flatnonzero(drawn.any(axis=0))
    if not len(rows):
        return pixels
    return pixels[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]


def _figure_around_pixels(pixels: Any, title: str, top: float, *, beyond: bool) -> Figure:
    """A figure of FULL_WIDTH with an image (rows, columns, 3), its title and its colour bar.

    Parameters
    ----------
    pixels : the image
    title : lines of the title
    top : upper end of the colour bar [MPa]
    beyond : whether some stresses are larger than `top`
    """
    height = RELATIVE_WIDTH_OF_DRAWN_SHOES * FULL_WIDTH * pixels.shape[0] / pixels.shape[1]
    total = height + height_of_title(title)
    with mpl.rc_context(MATPLOTLIB_SETTINGS_FOR_PRINT):
        figure = Figure(figsize=(FULL_WIDTH, total))
        axes = figure.add_axes((0, 0, RELATIVE_WIDTH_OF_DRAWN_SHOES, height / total))
        axes.imshow(pixels, aspect="auto")
        axes.set_axis_off()
        bar = figure.add_axes(
            (RELATIVE_WIDTH_OF_DRAWN_SHOES + 0.02, 0.2 * height / total, 0.02, 0.6 * height / total)
        )
        draw_colour_bar_of_stress(bar, ScalarMappable(Normalize(0, top), "viridis"), beyond=beyond)
        write_title_above_picture(figure, title)
    return figure


def _deformed_surfaces_of_both_halves(grid: Any, factor: float) -> list[Any]:
    """The surfaces of both halves of the shoes, with displacements enlarged by a factor.

    The second half is the first half mirrored at the middle plane z = 0.
    """
    halves = []
    for side in (1.0, -1.0):
        half = grid.copy()
        u = np.asarray(grid.point_data["displacement [m]"])
        half.points = (np.asarray(grid.points) + factor * u) * np.array([1.0, 1.0, side])
        halves.append(half.extract_surface(algorithm="dataset_surface", nonlinear_subdivision=2))
    return halves


def _factor_that_enlarges_drawn_displacements(grid: Any) -> float:
    """The factor by which the picture enlarges the displacements.

    The factor is 1, 2 or 5 times a power of ten. It is the largest of these numbers with which no
    displacement is drawn longer than LARGEST_DRAWN_SOLID_DISPLACEMENT_OVER_RADIUS allows.
    """
    u = np.asarray(grid.point_data["displacement [m]"])
    radius = float(np.linalg.norm(np.asarray(grid.points)[:, :2], axis=1).max())
    largest = float(np.linalg.norm(u, axis=1).max()) or 1.0
    return largest_round_number_not_above_value(
        LARGEST_DRAWN_SOLID_DISPLACEMENT_OVER_RADIUS * radius / largest
    )


def main() -> int:
    """Draw the solid shoes that the arguments of this process name; returns the exit status.

    The third argument of the process is the title of the picture.
    """
    return draw_picture_named_by_arguments(draw_solid_shoes_in_this_process)
