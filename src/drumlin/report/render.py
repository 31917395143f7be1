"""A picture of the fields, rendered off-screen by pyvista in a process of its own.

Off-screen rendering needs OpenGL or its software stand-in. Where there is none VTK may end the
whole process instead of raising, so `render` starts this module as another one and says what came
of it.
"""

import json
import math
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import ended
from drumlin.base.files import replacing
from drumlin.base.texts import one_line
from drumlin.brake.brake import Brake
from drumlin.brake.fields import Point
from drumlin.brake.support import Held
from drumlin.report.palette import RED

TIMEOUT = 120  # s
SCALAR = "von Mises stress [MPa]"
TOPS = 1, 1.2, 1.6, 2, 2.4, 3.2, 4, 6, 8, 10  # of the colour bar, whose quarters are round, too


class NoPicture(Exception):
    """The process that draws has ended without a picture."""


def render(fields: Path, picture: Path, brake: Brake, title: str) -> str | None:
    """Draw a .vtu file of fields into a .png; returns None, or one line that says why there is no
    picture.
    """
    surface, size = _surface(brake)
    marks = {
        "surface": surface.tolist(),
        "size": size,
        "flat": brake.surface.straight,
        "pins": [list(point.xy) for shoe in brake.shoes for point in _points(shoe)],
        "forces": [[*shoe.actuation.point.xy, *shoe.actuation.vector] for shoe in brake.shoes],
        "title": title,
    }
    return picture_by(__name__, fields, picture, json.dumps(marks))


def picture_by(module: str, fields: Path, picture: Path, argument: str) -> str | None:
    """Have a module's `main` draw a .vtu file into a .png, in a process of its own; None, or why
    there is none.
    """
    child = (
        f"import sys; sys.path.append(sys.argv.pop(1)); from {module} import main; sys.exit(main())"
    )
    # With -P nothing is imported from the current folder; drumlin itself from where it is, if it is
    # not installed.
    command = [sys.executable, "-P", "-c", child, str(Path(__file__).parents[2]), str(fields)]
    try:
        with replacing(picture) as partial:
            drawn([*command, str(partial), argument])
        return None
    except NoPicture as error:
        if picture.is_file():
            picture.unlink()  # an old picture must not stand for a new result
        return f"no field picture: off-screen rendering is not possible here ({one_line(str(error), 200)})"


def _surface(brake: Brake) -> tuple[Floats, float]:
    """The friction surface as a line (n, 2) [m], and the length that signs go by: the drum's
    radius, or half of what is in a brake on a plane.
    """
    if brake.surface.straight:
        pins = [x for shoe in brake.shoes for x in (shoe.pin.x, shoe.actuation.point.x)]
        ends = [*pins, *(x for shoe in brake.shoes for x in (shoe.lining.start, shoe.lining.end))]
        return np.array([[min(ends), 0.0], [max(ends), 0.0]]), 0.5 * (max(ends) - min(ends))
    turn = np.linspace(0, 2 * math.pi, 361)
    return brake.size * np.column_stack([np.cos(turn), np.sin(turn)]), brake.size


def _points(shoe: Held) -> list[Point]:
    """Where a shoe is held: its pin, that of its lever and its pivot, its foot."""
    foot = None if shoe.abutment is None else shoe.abutment.point
    return [point for point in (shoe.hinge, shoe.pivot, foot) if point is not None]


def drawn(command: list[str]) -> None:
    """Run a process that draws. Raises NoPicture with the last that it said."""
    try:
        done = subprocess.run(command, capture_output=True, timeout=TIMEOUT, check=False)
    except (OSError, subprocess.TimeoutExpired) as error:
        raise NoPicture(type(error).__name__) from error
    if done.returncode:
        lines = done.stderr.decode(errors="replace").strip().splitlines()
        raise NoPicture(lines[-1] if lines else f"exit status {done.returncode}")


def draw(fields: Path, picture: Path, marks: dict[str, Any]) -> None:
    """Render in this process: von Mises stress on deformed shoes, arrows of pressure, pins, forces,
    drum or plane.
    """
    import pyvista as pv  # noqa: PLC0415  (only in the process that draws)

    radius, around = float(marks["size"]), np.array(marks["surface"])
    face = "plane" if marks["flat"] else "drum"
    grid = pv.read(fields)
    u = np.asarray(grid.point_data["displacement [m]"])
    grid.point_data[SCALAR] = np.asarray(grid.point_data["von Mises [Pa]"]) * 1e-6
    factor = _round_down(0.04 * radius / (float(np.linalg.norm(u, axis=1).max()) or 1.0))
    deformed = grid.copy()
    deformed.points = np.asarray(grid.points) + factor * u
    plotter = pv.Plotter(off_screen=True, window_size=(1500, 1300))
    plotter.set_background("white")
    bar = {
        "title": SCALAR + "\n", "color": "black", "vertical": True, "position_x": 0.87, "position_y": 0.2,
        "height": 0.55, "width": 0.05, "label_font_size": 22, "title_font_size": 20, "fmt": "%.4g", "n_labels": 5,
    }  # fmt: skip
    top = _round_up(float(np.percentile(grid.point_data[SCALAR], 99.5)))
    surface = deformed.extract_surface(algorithm="dataset_surface", nonlinear_subdivision=3)
    plotter.add_mesh(
        surface, scalars=SCALAR, cmap="viridis", clim=(0, top), lighting=False, scalar_bar_args=bar
    )
    plotter.add_mesh(_outline(grid), color="#888888", line_width=2)
    line = np.column_stack([around, np.zeros(len(around))])
    plotter.add_mesh(pv.lines_from_points(line), color="black", line_width=5)
    _add_pressure(plotter, grid, radius, flat=marks["flat"])
    ends = []
    for x, y, fx, fy in marks["forces"]:
        size = math.hypot(fx, fy)
        if size > 0:
            ends += [[x, y], [x + 0.28 * radius * fx / size, y + 0.28 * radius * fy / size]]
            arrow = pv.Arrow(start=(x, y, 0), direction=(fx / size, fy / size, 0), scale=0.28 * radius,
                             tip_radius=0.06, shaft_radius=0.02)  # fmt: skip
            plotter.add_mesh(arrow, color="#1d2733")
    for x, y in marks["pins"]:
        plotter.add_mesh(
            pv.Disc(center=(x, y, 0), inner=0, outer=0.035 * radius, c_res=40), color="#1d2733"
        )
    text = (
        f"{marks['title']}\nDisplacements x {factor:g} (undeformed outline grey), {face} black.\n"
    )
    text += f"Red arrows: pressure of the {face} on the lining. Black arrows: actuation. Discs: pins and feet."
    plotter.add_text(text, position="upper_left", font_size=12, color="black")
    plotter.view_xy()
    plotter.enable_parallel_projection()
    # All of the scene to the left of the colour bar and below the text.
    places = np.array(
        [
            around.min(axis=0),
            around.max(axis=0),
            *marks["pins"],
            *ends,
            *np.reshape(deformed.bounds[:4], (2, 2)).T,
        ]
    )
    (left, bottom), (right, top_edge) = (
        places.min(axis=0) - 0.2 * radius,
        places.max(axis=0) + 0.2 * radius,
    )
    scale = max((top_edge - bottom) / 2 / 0.9, (right - left) / 2 / 0.84 * 1300 / 1500)
    x = (left + right) / 2 + 0.13 * scale * 1500 / 1300
    y = (bottom + top_edge) / 2 + 0.09 * scale
    plotter.camera.parallel_scale = scale
    plotter.camera.focal_point, plotter.camera.position = (x, y, 0), (x, y, 1)
    plotter.screenshot(str(picture))


def _outline(grid: Any) -> Any:
    """The undeformed outline: boundary edges of the cells, with the nodes of a shared edge merged."""
    flat = grid.copy()
    flat.clear_data()
    surface = flat.extract_surface(algorithm="dataset_surface", nonlinear_subdivision=1).clean(
        tolerance=1e-7
    )
    return surface.extract_feature_edges(
        boundary_edges=True, feature_edges=False, manifold_edges=False, non_manifold_edges=False
    )


def _add_pressure(plotter: Any, grid: Any, radius: float, *, flat: bool) -> None:
    """About a hundred arrows, evenly spread over the contact, their length the pressure."""
    import pyvista as pv  # noqa: PLC0415

    p = np.asarray(grid.point_data["pressure [Pa]"])
    touching = np.flatnonzero(p > 0)
    if not len(touching):
        return
    points, push = (
        np.asarray(grid.points)[touching],
        np.asarray(grid.point_data["push of the drum [Pa]"])[touching],
    )
    turns = (
        points[:, 0] / radius if flat else np.arctan2(points[:, 1], points[:, 0])
    ) / math.radians(2.5)
    slot = np.round(turns)
    order = np.lexsort((np.abs(turns - slot), slot))  # of each slot the node nearest its middle
    chosen = order[np.unique(slot[order], return_index=True)[1]]
    size = np.linalg.norm(push[chosen], axis=1)
    top = float(np.percentile(size, 90))  # singular edges are cut off
    arrows = push[chosen] * (0.2 * radius / np.maximum(size, top))[:, None]
    cloud = pv.PolyData(points[chosen] - arrows)
    cloud["arrow"], cloud["size"] = arrows, np.linalg.norm(arrows, axis=1)
    tip = pv.Arrow(tip_length=0.25, tip_radius=0.05, shaft_radius=0.016)
    plotter.add_mesh(cloud.glyph(orient="arrow", scale="size", geom=tip), color=RED)


def _round_down(value: float) -> float:
    """The largest 1, 2 or 5 times a power of ten that is not above `value`."""
    power = 10.0 ** math.floor(math.log10(value))
    return max(
        (step * power for step in (1, 2, 5) if step * power <= value * (1 + 1e-9)), default=power
    )


def _round_up(value: float) -> float:
    """The smallest of TOPS times a power of ten that is not below `value`."""
    power = 10.0 ** math.floor(math.log10(value)) if value > 0 else 1.0
    return next(step * power for step in TOPS if step * power >= value * (1 - 1e-9))


def main() -> int:
    """Draw, in a process of its own, by its arguments; returns its exit status."""

    def drawn() -> int:
        draw(Path(sys.argv[1]), Path(sys.argv[2]), json.loads(sys.argv[3]))
        return 0

    return ended(drawn)
