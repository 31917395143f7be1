"""A picture of solid (three-dimensional) shoes, which pyvista draws without a window.

The drawing runs in a process of its own, since the graphics library may end its whole process.
"""

from pathlib import Path
from typing import Any

import numpy as np

from drumlin.base.round_numbers import largest_round_number_not_above_value
from drumlin.report.render import (
    STRESS_TITLE,
    draw_picture_in_new_process,
    draw_picture_named_by_arguments,
)

LARGEST_DISPLACEMENT = 0.05
"""Length of the largest displacement in the picture, relative to the drum's radius.

Longer displacements would hide the shape of the shoes, and with shorter displacements the
deformation would not be seen.
"""


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
    grid.point_data[STRESS_TITLE] = np.asarray(grid.point_data["von Mises [Pa]"]) * 1e-6
    factor = _factor_that_enlarges_drawn_displacements(grid)
    # Stresses at loaded ends are far above all other stresses. The colour bar therefore ends at the
    # stress that 2 % of the nodes exceed.
    top = float(np.percentile(grid.point_data[STRESS_TITLE], 98.0))
    plotter = pv.Plotter(off_screen=True, window_size=(1600, 1250))
    plotter.set_background("white")
    bar = {
        "title": STRESS_TITLE + "\n", "color": "black", "vertical": True,
        "position_x": 0.88, "position_y": 0.2, "height": 0.55, "width": 0.05,
        "label_font_size": 22, "title_font_size": 20, "fmt": "%.3g",
    }  # fmt: skip
    for i, half in enumerate(_deformed_surfaces_of_both_halves(grid, factor)):
        plotter.add_mesh(
            half,
            scalars=STRESS_TITLE,
            cmap="viridis",
            clim=(0, top),
            scalar_bar_args=bar,
            show_scalar_bar=i == 0,
            smooth_shading=False,
            ambient=0.35,
        )
    text = f"{title}\nDisplacements x {factor:g}."
    plotter.add_text(text, position="upper_left", font_size=13, color="black")
    plotter.view_vector((0.35, 0.55, 1.0), viewup=(0, 1, 0))
    plotter.enable_parallel_projection()
    plotter.reset_camera()
    plotter.camera.zoom(1.15)
    plotter.screenshot(str(picture))


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

    It is 1, 2 or 5 times a power of ten, and the largest at which no displacement is drawn longer
    than LARGEST_DISPLACEMENT.
    """
    u = np.asarray(grid.point_data["displacement [m]"])
    radius = float(np.linalg.norm(np.asarray(grid.points)[:, :2], axis=1).max())
    largest = float(np.linalg.norm(u, axis=1).max()) or 1.0
    return largest_round_number_not_above_value(LARGEST_DISPLACEMENT * radius / largest)


def main() -> int:
    """Draw the solid shoes that the arguments of this process name; returns the exit status.

    The third argument of the process is the title of the picture.
    """
    return draw_picture_named_by_arguments(draw_solid_shoes_in_this_process)
