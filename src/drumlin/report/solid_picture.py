"""A picture of solid (three-dimensional) shoes, which pyvista draws without a window.

The drawing runs in a process of its own, since the graphics library VTK may end the process in
which it runs.
"""

from pathlib import Path
from typing import Any

import numpy as np

from drumlin.base.round_numbers import largest_round_number_not_above_value
from drumlin.brake.brake import Brake
from drumlin.report.field_picture import rounded_up_to_end_of_colour_bar
from drumlin.report.figures import COLUMN_WIDTH, save_figure, title_folded_into_lines
from drumlin.report.render import draw_picture_in_new_process, draw_picture_named_by_arguments
from drumlin.report.rendered_figure import (
    COLOR_OF_DRAWN_RIM,
    PIXELS_PER_INCH_OF_RENDERED_FIGURE,
    STRESS_ARRAY_NAME,
    RimRadii,
    figure_around_pixels,
    pixels_without_white_margins,
    radii_of_drawn_rim,
)

LARGEST_DRAWN_SOLID_DISPLACEMENT_OVER_RADIUS = 0.05
"""Largest length of an enlarged displacement in the picture, relative to the radius of the shoes.

The radius of the shoes is the largest distance of one of their points from the drum's axis.
Longer displacements would hide the shape of the shoes, and with shorter displacements the
deformation would not be seen.
"""

PERCENTAGE_OF_SOLID_NODES_WITHIN_COLOUR_BAR = 99.0
"""Percentage of the nodes whose stress is within the colour bar.

The stresses at the loaded ends of the shoes are far larger than all other stresses. With a larger
percentage, the rest of each shoe would have one dark colour. With a smaller percentage, the loaded
ends would have the brightest colour everywhere. The value is a judgement by eye.
"""

SOLID_PICTURE_PIXELS = 2000, 1600
"""Width and height [pixels] in which the shoes are drawn, before their blank margins are cut."""


def draw_solid_shoes_and_return_failure_reason(
    fields: Path, picture: Path, brake: Brake
) -> str | None:
    """Draw the .vtu file of the solid shoes of a brake into a .png file, with the rim of the drum.

    Returns None, or one line that says why the picture could not be drawn.
    """
    rim = radii_of_drawn_rim(brake)
    return draw_picture_in_new_process(__name__, fields, picture, brake.title, rim)


def draw_solid_shoes_in_this_process(
    fields: Path, picture: Path, title: str, rim: RimRadii | None
) -> None:
    """Draw the von Mises stress on the deformed solid shoes into a .png file, within this process.

    The .vtu file holds half of each shoe, on one side of the middle plane of its width. The picture
    shows both halves. A flat grey ring in the middle plane is the rim of the drum.
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
    if rim is not None:
        disc = pv.Disc(inner=rim.inner, outer=rim.outer, c_res=361)
        plotter.add_mesh(disc, color=COLOR_OF_DRAWN_RIM, lighting=False)
    plotter.view_vector((0.35, 0.55, 1.0), viewup=(0, 1, 0))
    plotter.enable_parallel_projection()
    plotter.reset_camera()
    pixels = pixels_without_white_margins(np.asarray(plotter.screenshot(return_img=True)))
    drum = "" if rim is None else "; drum grey"
    lines = title_folded_into_lines(title, f"displacements × {factor:g}{drum}", COLUMN_WIDTH)
    figure = figure_around_pixels(pixels, lines, top, beyond=float(stress.max()) > top)
    save_figure(figure, picture, pixels_per_inch=PIXELS_PER_INCH_OF_RENDERED_FIGURE)


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

    The arguments of the process are those of `draw_solid_shoes_in_this_process`.
    """
    return draw_picture_named_by_arguments(draw_solid_shoes_in_this_process)
