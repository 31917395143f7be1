"""A picture of the fields, rendered off-screen by pyvista in a process of its own.

Off-screen rendering needs OpenGL or its software stand-in. Where there is none VTK may end the whole process
instead of raising, so `render` starts this module as another one and says what came of it.
"""

import math
import subprocess
import sys
from pathlib import Path

import numpy as np

from drumlin.files import replacing

TIMEOUT = 120  # s


def render(fields: Path, picture: Path, radius: float, title: str) -> str | None:
    """Draw a .vtu file of fields into a .png; returns None, or one line that says why there is no picture."""
    with replacing(picture) as partial:
        command = [sys.executable, "-m", "drumlin.report.render", str(fields), str(partial), repr(radius), title]
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=TIMEOUT, check=False)
        except (OSError, subprocess.TimeoutExpired) as error:
            reason = type(error).__name__
        else:
            if done.returncode == 0 and partial.stat().st_size > 0:
                return None
            lines = done.stderr.strip().splitlines()
            reason = lines[-1][:200] if lines else f"exit status {done.returncode}"
    picture.unlink(missing_ok=True)
    return f"no field picture: off-screen rendering is not possible here ({reason})"


def _draw(fields: Path, picture: Path, radius: float, title: str) -> None:
    import pyvista as pv  # noqa: PLC0415  (only in the process that draws)

    pv.OFF_SCREEN = True
    grid = pv.read(fields)
    u, p = grid.point_data["displacement [m]"], grid.point_data["pressure [Pa]"]
    push = np.asarray(grid.point_data["push of the drum [Pa]"])
    largest = float(np.linalg.norm(u, axis=1).max()) or 1.0
    factor = _round_down(0.04 * radius / largest)
    grid.point_data["von Mises stress [MPa]"] = np.asarray(grid.point_data["von Mises [Pa]"]) * 1e-6
    shape = grid.copy()
    shape.points = grid.points + factor * np.asarray(u)
    surface = shape.extract_surface(algorithm="dataset_surface", nonlinear_subdivision=3)
    plotter = pv.Plotter(off_screen=True, window_size=(1500, 1350))
    plotter.set_background("white")
    bar = {
        "title": "von Mises stress [MPa]", "color": "black", "vertical": True, "position_x": 0.86,
        "position_y": 0.2, "height": 0.6, "width": 0.06, "label_font_size": 22, "title_font_size": 22, "fmt": "%.3g",
    }
    top = float(np.percentile(grid.point_data["von Mises stress [MPa]"], 99.5))
    plotter.add_mesh(surface, scalars="von Mises stress [MPa]", cmap="viridis", clim=(0, top), scalar_bar_args=bar)
    plotter.add_mesh(grid.extract_feature_edges(boundary_edges=True, feature_edges=False), color="#777777", line_width=1)
    plotter.add_mesh(_circle(pv, radius), color="black", line_width=4)
    touching = np.flatnonzero(np.asarray(p) > 0)
    if len(touching):
        step = max(1, len(touching) // 90)
        chosen = touching[np.argsort(np.arctan2(grid.points[touching, 1], grid.points[touching, 0]))][::step]
        length = 0.22 * radius / np.percentile(np.asarray(p)[touching], 99)
        arrows = push[chosen] * length
        cloud = pv.PolyData(np.asarray(grid.points)[chosen] - arrows)
        cloud["arrow"] = arrows
        size = np.linalg.norm(arrows, axis=1)
        cloud["size"] = size
        tip = pv.Arrow(tip_length=0.25, tip_radius=0.045, shaft_radius=0.014)
        plotter.add_mesh(cloud.glyph(orient="arrow", scale="size", geom=tip), color="#c8553d")
    plotter.add_text(
        f"{title}\ndisplacements x {factor:g}, undeformed outline grey, drum black\narrows: pressure of the drum on the lining",
        position="upper_left", font_size=11, color="black",
    )
    plotter.view_xy()
    plotter.enable_parallel_projection()
    plotter.camera.parallel_scale = 1.38 * radius
    plotter.camera.focal_point = (0.12 * radius, 0.06 * radius, 0)
    plotter.camera.position = (0.12 * radius, 0.06 * radius, 1)
    plotter.screenshot(str(picture))


def _circle(pv: object, radius: float) -> object:
    turn = np.linspace(0, 2 * math.pi, 361)
    points = radius * np.column_stack([np.cos(turn), np.sin(turn), np.zeros_like(turn)])
    return pv.lines_from_points(points)  # type: ignore[attr-defined]


def _round_down(value: float) -> float:
    """The largest 1, 2 or 5 times a power of ten that is not above `value`."""
    power = 10 ** math.floor(math.log10(value))
    return next(step * power for step in (5, 2, 1) if step * power <= value * (1 + 1e-9))


if __name__ == "__main__":
    _draw(Path(sys.argv[1]), Path(sys.argv[2]), float(sys.argv[3]), sys.argv[4])
