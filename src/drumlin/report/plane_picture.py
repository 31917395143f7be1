"""A picture of a .vtu file of plane fields, which pyvista draws without a window.

The reports of validation runs show this picture beside drumlin's own figure of the stresses. The
picture shows that another program, VTK, reads the same stresses from the .vtu file. The drawing
runs in a process of its own, since the graphics library VTK may end the process in which it runs.
"""

from pathlib import Path
from typing import Any

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.round_numbers import largest_round_number_not_above_value
from drumlin.report.field_picture import (
    LARGEST_DRAWN_DISPLACEMENT_OVER_RADIUS,
    LONGEST_PRESSURE_ARROW_OVER_RADIUS,
    PERCENTAGE_OF_PLANE_NODES_WITHIN_COLOUR_BAR,
    PERCENTAGE_OF_PROPORTIONAL_ARROWS,
    rounded_up_to_end_of_colour_bar,
)
from drumlin.report.palette import RED
from drumlin.report.render import draw_picture_in_new_process, draw_picture_named_by_arguments
from drumlin.report.solid_picture import STRESS_ARRAY_NAME

PLANE_PICTURE_PIXELS = 1800, 1300
"""Width and height [pixels] of the picture."""

RELATIVE_WINDOW_RANGES_OF_DRAWN_BODIES = (0.02, 0.82), (0.03, 0.93)
"""Ranges of the width and of the height of the window in which the bodies and arrows are drawn.

The colour bar with its title is to the right of this region, and the picture's title above it.
"""

SIDE_OF_SQUARE_WITH_ONE_PRESSURE_ARROW = 0.04
"""Side of the squares with one pressure arrow each, relative to half the length of the bodies.

Nodes lie close together at the ends of a contact, where arrows at all nodes would hide one another.
"""


def draw_plane_fields_and_return_failure_reason(
    fields: Path, picture: Path, title: str
) -> str | None:
    """Draw the plane fields of a .vtu file into a .png file; returns None or the reason of failure.

    `title` is the title of the picture.
    """
    return draw_picture_in_new_process(__name__, fields, picture, title)


def draw_plane_fields_in_this_process(fields: Path, picture: Path, title: str) -> None:
    """Draw the plane fields of a .vtu file into a .png file within this process.

    The picture shows the von Mises stress on the deformed bodies, their undeformed outlines in
    grey, and the pressures of the drum on the lining as arrows.
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
    bar = {
        "title": STRESS_ARRAY_NAME + "\n", "color": "black", "vertical": True,
        "position_x": 0.87, "position_y": 0.2, "height": 0.55, "width": 0.05,
        "label_font_size": 22, "title_font_size": 20, "fmt": "%.4g", "n_labels": 5,
    }  # fmt: skip
    plotter.add_mesh(
        deformed.extract_surface(algorithm="dataset_surface", nonlinear_subdivision=3),
        scalars=STRESS_ARRAY_NAME,
        cmap="viridis",
        clim=(0, top),
        lighting=False,
        scalar_bar_args=bar,
    )
    plotter.add_mesh(outline, color="#888888", line_width=2)
    _add_pressure_arrows(plotter, grid, size)
    text = f"{title}\nDisplacements x {factor:g} (undeformed outline grey)."
    plotter.add_text(text, position="upper_left", font_size=12, color="black")
    plotter.view_xy()
    plotter.enable_parallel_projection()
    bounds = np.reshape(plotter.bounds, (3, 2))
    plotter.reset_camera()
    (x, y), plotter.camera.parallel_scale = centre_and_half_height_of_window(bounds[:2])
    plotter.camera.focal_point, plotter.camera.position = (x, y, 0), (x, y, bounds.max() + 1)
    plotter.reset_camera_clipping_range()
    plotter.screenshot(str(picture))


def centre_and_half_height_of_window(bounds: Floats) -> tuple[Floats, float]:
    """The place (2,) [m] at the window's centre, and half of the height [m] that the window shows.

    `bounds` (2, 2) [m] are the smallest and largest x, and the smallest and largest y, of all that
    is drawn. With the result, the drawing is as large as possible within
    RELATIVE_WINDOW_RANGES_OF_DRAWN_BODIES, and lies at the centre of this region.
    """
    region = np.array(RELATIVE_WINDOW_RANGES_OF_DRAWN_BODIES)
    # The window, in units of its height.
    window = np.array([PLANE_PICTURE_PIXELS[0] / PLANE_PICTURE_PIXELS[1], 1.0])
    height = float((np.diff(bounds)[:, 0] / (np.diff(region)[:, 0] * window)).max())
    centre = bounds.mean(axis=1) + (0.5 - region.mean(axis=1)) * window * height
    return centre, 0.5 * height


def _outlines_of_bodies(grid: Any) -> Any:
    """The edges of cells that belong to one cell only, after equal nodes are merged."""
    plain = grid.copy()
    plain.clear_data()
    surface = plain.extract_surface(algorithm="dataset_surface", nonlinear_subdivision=1)
    return surface.clean(tolerance=1e-7).extract_feature_edges(
        boundary_edges=True, feature_edges=False, manifold_edges=False, non_manifold_edges=False
    )


def _add_pressure_arrows(plotter: Any, grid: Any, size: float) -> None:
    """Add arrows of the pressures on the lining; the longest ones are shortened to one length.

    `size` [m] is half the length of the drawn bodies, to which the arrows' lengths are relative.
    """
    import pyvista as pv  # noqa: PLC0415

    touching = np.flatnonzero(np.asarray(grid.point_data["pressure [Pa]"]) > 0)
    if not len(touching):
        return
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


def main() -> int:
    """Draw the fields that the arguments of this process name; returns the exit status."""
    return draw_picture_named_by_arguments(draw_plane_fields_in_this_process)
