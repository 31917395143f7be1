"""A picture of solid shoes, rendered off-screen by pyvista in a process of its own: see render.py."""

import sys
from pathlib import Path

import numpy as np

from drumlin.base.errors import ended
from drumlin.report.render import picture_by

SCALAR = "von Mises stress [MPa]"
MOST = 0.05  # of the drum's radius, which the largest displacement is drawn as


def render(fields: Path, picture: Path, title: str) -> str | None:
    """Draw the .vtu file of solid shoes into a .png; returns None, or one line that says why there
    is no picture.
    """
    return picture_by(__name__, fields, picture, title)


def draw(fields: Path, picture: Path, title: str) -> None:
    """Render in this process: von Mises stress on the deformed solids, both halves of each, the
    section in front.
    """
    import pyvista as pv  # noqa: PLC0415  (only in the process that draws)

    grid = pv.read(fields)
    grid.point_data[SCALAR] = np.asarray(grid.point_data["von Mises [Pa]"]) * 1e-6
    u = np.asarray(grid.point_data["displacement [m]"])
    radius = float(np.linalg.norm(np.asarray(grid.points)[:, :2], axis=1).max())
    size = MOST * radius / (float(np.linalg.norm(u, axis=1).max()) or 1.0)
    power = 10.0 ** np.floor(np.log10(size))
    factor = max(step * power for step in (1, 2, 5) if step * power <= size)
    halves = []
    for side in (1.0, -1.0):
        half = grid.copy()
        half.points = (np.asarray(grid.points) + factor * u) * np.array([1.0, 1.0, side])
        halves.append(half.extract_surface(algorithm="dataset_surface", nonlinear_subdivision=2))
    top = float(np.percentile(grid.point_data[SCALAR], 98.0))  # loaded ends are cut off
    plotter = pv.Plotter(off_screen=True, window_size=(1600, 1250))
    plotter.set_background("white")
    bar = {"title": SCALAR + "\n", "color": "black", "vertical": True, "position_x": 0.88, "position_y": 0.2,
           "height": 0.55, "width": 0.05, "label_font_size": 22, "title_font_size": 20, "fmt": "%.3g"}  # fmt: skip
    for i, half in enumerate(halves):
        plotter.add_mesh(half, scalars=SCALAR, cmap="viridis", clim=(0, top), scalar_bar_args=bar,
                         show_scalar_bar=i == 0, smooth_shading=False, ambient=0.35)  # fmt: skip
    plotter.add_text(
        f"{title}\nDisplacements x {factor:g}.", position="upper_left", font_size=13, color="black"
    )
    plotter.view_vector((0.35, 0.55, 1.0), viewup=(0, 1, 0))
    plotter.enable_parallel_projection()
    plotter.reset_camera()
    plotter.camera.zoom(1.15)
    plotter.screenshot(str(picture))


def main() -> int:
    """Draw, in a process of its own, by its arguments; returns its exit status."""

    def drew() -> int:
        draw(Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3])
        return 0

    return ended(drew)
