"""A picture of a .vtu file of plane fields, which pyvista draws without a window.

The reports of validation runs show this picture beside drumlin's own figure of the stresses. The
picture shows that another program, VTK, reads the same stresses from the .vtu file. The drawing
runs in a process of its own, since the graphics library VTK may end the process in which it runs.
"""

from pathlib import Path
from typing import Any

import numpy as np

from drumlin.base.round_numbers import largest_round_number_not_above_value
from drumlin.brake.brake import Brake
from drumlin.report.field_picture import (
    LARGEST_DRAWN_DISPLACEMENT_OVER_RADIUS,
    LONGEST_PRESSURE_ARROW_OVER_RADIUS,
    PERCENTAGE_OF_PLANE_NODES_WITHIN_COLOUR_BAR,
    PERCENTAGE_OF_PROPORTIONAL_ARROWS,
    length_of_arrows_in_words,
    rounded_up_to_end_of_colour_bar,
)
from drumlin.report.figures import COLUMN_WIDTH, save_figure, title_folded_into_lines
from drumlin.report.palette import RED
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

PLANE_PICTURE_PIXELS = 1800, 1300
"""Width and height [pixels] in which the bodies are drawn, before their margins are cut."""

SIDE_OF_SQUARE_WITH_ONE_PRESSURE_ARROW = 0.04
"""Side of the squares with one pressure arrow each, relative to half the length of the bodies.

Nodes lie close together at the ends of a contact, where arrows at all nodes would hide one another.
"""


def draw_plane_fields_and_return_failure_reason(
    fields: Path, picture: Path, brake: Brake
) -> str | None:
    """Draw the plane fields of a .vtu file into a .png file; returns None or the reason of failure.

    `brake` is the brake of the fields. It gives the title of the picture and the rim of the drum.
    """
    rim = radii_of_drawn_rim(brake)
    return draw_picture_in_new_process(__name__, fields, picture, brake.title, rim)


def draw_plane_fields_in_this_process(
    fields: Path, picture: Path, title: str, rim: RimRadii | None
) -> None:
    """Draw the plane fields of a .vtu file into a .png file within this process.

    The picture shows the von Mises stress on the deformed bodies, their undeformed outlines in
    grey, a rigid drum as a grey band, and the pressures of the drum on the lining as arrows.
    """
    import pyvista as pv  # noqa: PLC0415  (only in the process that draws)

    grid = pv.read(fields)
    grid.point_data[STRESS_ARRAY_NAME] = np.asarray(grid.point_data["von Mises [Pa]"]) * 1e-6
    u = np.asarray(grid.point_data["displacement [m]"])
    size = 0.5 * max(grid.bounds[1] - grid.bounds[0], grid.bounds[3] - grid.bounds[2])
    factor = largest_round_number_not_above_value(
        LARGEST_DRAWN_DISPLACEMENT_OVER_RADIUS
        * size
        / (float(np.linalg.norm(u, axis=1).max()) or 1.0)
    )
    outline = _outlines_of_bodies(grid)
    deformed = grid.copy()
    deformed.points = np.asarray(grid.points) + factor * u
    # Stresses at singular edges are far above all other stresses.
    top = rounded_up_to_end_of_colour_bar(
        float(
            np.percentile(
                grid.point_data[STRESS_ARRAY_NAME], PERCENTAGE_OF_PLANE_NODES_WITHIN_COLOUR_BAR
            )
        )
    )
    plotter = pv.Plotter(off_screen=True, window_size=PLANE_PICTURE_PIXELS)
    plotter.set_background("white")
    if rim is not None:
        band = pv.Disc(inner=rim.inner, outer=rim.outer, c_res=361)
        plotter.add_mesh(band, color=COLOR_OF_DRAWN_RIM, lighting=False)
    plotter.add_mesh(
        deformed.extract_surface(algorithm="dataset_surface", nonlinear_subdivision=3),
        scalars=STRESS_ARRAY_NAME,
        cmap="viridis",
        clim=(0, top),
        lighting=False,
        show_scalar_bar=False,
    )
    plotter.add_mesh(outline, color="#888888", line_width=2)
    longest = _add_pressure_arrows_and_return_pressure_of_longest(plotter, grid, size)
    plotter.view_xy()
    plotter.enable_parallel_projection()
    plotter.reset_camera()
    pixels = pixels_without_white_margins(np.asarray(plotter.screenshot(return_img=True)))
    drum = "" if rim is None else " and drum"
    legend = f"displacements × {factor:g}; undeformed outline{drum} grey"
    if longest is not None:
        legend += f"; pressure on the lining orange, {length_of_arrows_in_words(longest)}"
    lines = title_folded_into_lines(title, legend, COLUMN_WIDTH)
    beyond = float(grid.point_data[STRESS_ARRAY_NAME].max()) > top
    figure = figure_around_pixels(pixels, lines, top, beyond=beyond)
    save_figure(figure, picture, pixels_per_inch=PIXELS_PER_INCH_OF_RENDERED_FIGURE)


def _outlines_of_bodies(grid: Any) -> Any:
    """The edges of cells that belong to one cell only, after equal nodes are merged."""
    plain = grid.copy()
    plain.clear_data()
    surface = plain.extract_surface(algorithm="dataset_surface", nonlinear_subdivision=1)
    return surface.clean(tolerance=1e-7).extract_feature_edges(
        boundary_edges=True, feature_edges=False, manifold_edges=False, non_manifold_edges=False
    )


def _add_pressure_arrows_and_return_pressure_of_longest(
    plotter: Any, grid: Any, size: float
) -> float | None:
    """Add arrows of the pressures on the lining; the longest ones are shortened to one length.

    `size` [m] is half the length of the drawn bodies, to which the arrows' lengths are relative.
    The result is the least pressure [Pa] of an arrow of the largest length, or None without arrows.
    """
    import pyvista as pv  # noqa: PLC0415

    touching = np.flatnonzero(np.asarray(grid.point_data["pressure [Pa]"]) > 0)
    if not len(touching):
        return None
    points = np.asarray(grid.points)[touching]
    cells = np.round(points / (SIDE_OF_SQUARE_WITH_ONE_PRESSURE_ARROW * size))
    chosen = touching[np.unique(cells, axis=0, return_index=True)[1]]
    push = np.asarray(grid.point_data["push of the drum [Pa]"])[chosen]
    lengths = np.linalg.norm(push, axis=1)
    top = float(np.percentile(lengths, PERCENTAGE_OF_PROPORTIONAL_ARROWS))
    arrows = push * (LONGEST_PRESSURE_ARROW_OVER_RADIUS * size / np.maximum(lengths, top))[:, None]
    cloud = pv.PolyData(np.asarray(grid.points)[chosen] - arrows)
    cloud["arrow"], cloud["size"] = arrows, np.linalg.norm(arrows, axis=1)
    tip = pv.Arrow(tip_length=0.25, tip_radius=0.05, shaft_radius=0.016)
    plotter.add_mesh(cloud.glyph(orient="arrow", scale="size", geom=tip), color=RED, lighting=False)
    return top


def main() -> int:
    """Draw the fields that the arguments of this process name; returns the exit status."""
    return draw_picture_named_by_arguments(draw_plane_fields_in_this_process)
