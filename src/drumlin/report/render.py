"""A picture of the fields, which pyvista renders off-screen in a process of its own.

Off-screen rendering needs OpenGL or its software stand-in. Where neither is there, VTK may end the
whole process instead of raising an error. `render_fields` therefore starts this module as another
process and says what came of it.
"""

import json
import math
import subprocess
import sys
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import ended
from drumlin.base.files import replacing
from drumlin.base.texts import one_line
from drumlin.brake.brake import Brake
from drumlin.brake.fields import Point
from drumlin.brake.support import Held
from drumlin.report.palette import INK, RED

RENDER_SECONDS = 120
"""Seconds after which a process that draws counts as hung. A picture takes some three."""

STRESS_TITLE = "von Mises stress [MPa]"
"""The title of the colour bar, and the name of its values in the grid."""

BAR_TOPS = 1, 1.2, 1.6, 2, 2.4, 3.2, 4, 6, 8, 10
"""Upper ends of the colour bar, times a power of ten. Their quarters are round numbers, too."""

ARROW_LENGTH = 0.28
"""Length of a force's arrow relative to the size of the brake."""

FIELD_WIDTH, FIELD_HEIGHT = 1500, 1300
"""Width and height of the picture of the fields in pixels."""


class NoPicture(Exception):
    """The process that draws has ended without a picture."""


def render_fields(fields: Path, picture: Path, brake: Brake, title: str) -> str | None:
    """Draw a .vtu file of fields into a .png.

    Parameters
    ----------
    fields : the .vtu file
    picture : the .png file
    brake : whose friction surface, pins and forces are drawn
    title : of the picture

    Returns
    -------
    None, or one line that says why there is no picture
    """
    surface = _surface_line(brake)
    pins: list[list[float]] = []
    for shoe in brake.shoes:
        pins += [list(point.xy) for point in _support_points(shoe)]
    marks = {
        "surface": surface.line.tolist(),
        "size": surface.size,
        "flat": brake.surface.straight,
        "pins": pins,
        "forces": [[*shoe.actuation.point.xy, *shoe.actuation.vector] for shoe in brake.shoes],
        "title": title,
    }
    return draw_in_own_process(__name__, fields, picture, json.dumps(marks))


def draw_in_own_process(module: str, fields: Path, picture: Path, argument: str) -> str | None:
    """Have a module's `main` draw a .vtu file into a .png, in a process of its own.

    Parameters
    ----------
    module : dotted name of the module
    fields : the .vtu file
    picture : the .png file, which is written whole or not at all
    argument : what `main` needs besides the files

    Returns
    -------
    None, or one line that says why there is no picture
    """
    child = (
        f"import sys; sys.path.append(sys.argv.pop(1)); from {module} import main; sys.exit(main())"
    )
    # With -P nothing is imported from the current folder. A drumlin that is not installed is
    # imported from its own folder.
    folder = str(Path(__file__).parents[2])
    command = [sys.executable, "-P", "-c", child, folder, str(fields)]
    try:
        with replacing(picture) as partial:
            run_drawing_process([*command, str(partial), argument])
        return None
    except NoPicture as error:
        # An old picture must not stand for a new result.
        if picture.is_file():
            picture.unlink()
        reason = one_line(str(error), 200)
        return f"no field picture: off-screen rendering is not possible here ({reason})"


class _SurfaceLine(NamedTuple):
    """The friction surface as a line (n, 2) [m], and the length that signs are relative to [m]."""

    line: Floats
    size: float


def _surface_line(brake: Brake) -> _SurfaceLine:
    """The friction surface of a brake.

    Signs are relative to the drum's radius, on a plane to half the length of the brake.
    """
    if not brake.surface.straight:
        turn = np.linspace(0, 2 * math.pi, 361)
        return _SurfaceLine(brake.size * np.column_stack([np.cos(turn), np.sin(turn)]), brake.size)
    places: list[float] = []
    for shoe in brake.shoes:
        places += [shoe.pin.x, shoe.actuation.point.x, shoe.lining.start, shoe.lining.end]
    left, right = min(places), max(places)
    return _SurfaceLine(np.array([[left, 0.0], [right, 0.0]]), 0.5 * (right - left))


def _support_points(shoe: Held) -> list[Point]:
    """The points where a shoe is held: its pin, its lever's pivot, its foot."""
    foot = None if shoe.abutment is None else shoe.abutment.point
    return [point for point in (shoe.hinge, shoe.pivot, foot) if point is not None]


def run_drawing_process(command: list[str]) -> None:
    """Run a process that draws. Raises NoPicture with the last line that it wrote."""
    try:
        done = subprocess.run(command, capture_output=True, timeout=RENDER_SECONDS, check=False)
    except (OSError, subprocess.TimeoutExpired) as error:
        raise NoPicture(type(error).__name__) from error
    if done.returncode:
        lines = done.stderr.decode(errors="replace").strip().splitlines()
        raise NoPicture(lines[-1] if lines else f"exit status {done.returncode}")


def draw_fields_picture(fields: Path, picture: Path, marks: dict[str, Any]) -> None:
    """Render in this process.

    The picture shows the von Mises stress on the deformed shoes, arrows of pressure, pins, forces,
    and drum or plane. `marks` are those of `render_fields`.
    """
    import pyvista as pv  # noqa: PLC0415  (only in the process that draws)

    size, line = float(marks["size"]), np.array(marks["surface"])
    grid = pv.read(fields)
    u = np.asarray(grid.point_data["displacement [m]"])
    grid.point_data[STRESS_TITLE] = np.asarray(grid.point_data["von Mises [Pa]"]) * 1e-6
    # The largest displacement is drawn as about 4 % of the size of the brake.
    factor = _round_down(0.04 * size / (float(np.linalg.norm(u, axis=1).max()) or 1.0))
    deformed = grid.copy()
    deformed.points = np.asarray(grid.points) + factor * u
    plotter = pv.Plotter(off_screen=True, window_size=(FIELD_WIDTH, FIELD_HEIGHT))
    plotter.set_background("white")
    _add_stress(plotter, deformed)
    plotter.add_mesh(_undeformed_outline(grid), color="#888888", line_width=2)
    points = np.column_stack([line, np.zeros(len(line))])
    plotter.add_mesh(pv.lines_from_points(points), color="black", line_width=5)
    _add_pressure(plotter, grid, size, flat=marks["flat"])
    arrow_ends = _add_forces(plotter, marks["forces"], size)
    for x, y in marks["pins"]:
        disc = pv.Disc(center=(x, y, 0), inner=0, outer=0.035 * size, c_res=40)
        plotter.add_mesh(disc, color=INK)
    plotter.add_text(
        _text_of_picture(marks, factor), position="upper_left", font_size=12, color="black"
    )
    plotter.view_xy()
    plotter.enable_parallel_projection()
    corners = np.reshape(deformed.bounds[:4], (2, 2)).T
    places = [line.min(axis=0), line.max(axis=0), *marks["pins"], *arrow_ends, *corners]
    _aim_camera(plotter.camera, np.array(places), margin=0.2 * size)
    plotter.screenshot(str(picture))


def _add_stress(plotter: Any, deformed: Any) -> None:
    """Add the deformed shoes with the colours of the stress, and the colour bar."""
    # The stresses at singular edges are far above all others: the colours cut them off.
    top = _round_up(float(np.percentile(deformed.point_data[STRESS_TITLE], 99.5)))
    surface = deformed.extract_surface(algorithm="dataset_surface", nonlinear_subdivision=3)
    bar = {
        "title": STRESS_TITLE + "\n", "color": "black", "vertical": True,
        "position_x": 0.87, "position_y": 0.2, "height": 0.55, "width": 0.05,
        "label_font_size": 22, "title_font_size": 20, "fmt": "%.4g", "n_labels": 5,
    }  # fmt: skip
    plotter.add_mesh(
        surface,
        scalars=STRESS_TITLE,
        cmap="viridis",
        clim=(0, top),
        lighting=False,
        scalar_bar_args=bar,
    )


def _add_forces(plotter: Any, forces: list[list[float]], size: float) -> list[list[float]]:
    """Add an arrow for each force (x, y, Fx, Fy); returns the ends of the arrows [m]."""
    import pyvista as pv  # noqa: PLC0415

    length = ARROW_LENGTH * size
    ends = []
    for x, y, fx, fy in forces:
        force = math.hypot(fx, fy)
        if force > 0:
            ends += [[x, y], [x + length * fx / force, y + length * fy / force]]
            arrow = pv.Arrow(
                start=(x, y, 0),
                direction=(fx / force, fy / force, 0),
                scale=length,
                tip_radius=0.06,
                shaft_radius=0.02,
            )
            plotter.add_mesh(arrow, color=INK)
    return ends


def _text_of_picture(marks: dict[str, Any], factor: float) -> str:
    """The text of the picture: its title and the meaning of its signs."""
    surface = "plane" if marks["flat"] else "drum"
    return (
        f"{marks['title']}\n"
        f"Displacements x {factor:g} (undeformed outline grey), {surface} black.\n"
        f"Red arrows: pressure of the {surface} on the lining. "
        "Black arrows: actuation. Discs: pins and feet."
    )


def _aim_camera(camera: Any, places: Floats, margin: float) -> None:
    """Aim the camera so that all places (n, 2) [m] lie left of the colour bar and below the text.

    The colour bar takes 16 % of the width, the text 10 % of the height.
    """
    left, bottom = places.min(axis=0) - margin
    right, top = places.max(axis=0) + margin
    # Half the height of the picture [m].
    scale = max((top - bottom) / 2 / 0.9, (right - left) / 2 / 0.84 * FIELD_HEIGHT / FIELD_WIDTH)
    x = (left + right) / 2 + 0.13 * scale * FIELD_WIDTH / FIELD_HEIGHT
    y = (bottom + top) / 2 + 0.09 * scale
    camera.parallel_scale = scale
    camera.focal_point, camera.position = (x, y, 0), (x, y, 1)


def _undeformed_outline(grid: Any) -> Any:
    """The undeformed outline: boundary edges of the cells with merged nodes of shared edges."""
    flat = grid.copy()
    flat.clear_data()
    surface = flat.extract_surface(algorithm="dataset_surface", nonlinear_subdivision=1)
    return surface.clean(tolerance=1e-7).extract_feature_edges(
        boundary_edges=True, feature_edges=False, manifold_edges=False, non_manifold_edges=False
    )


def _add_pressure(plotter: Any, grid: Any, size: float, *, flat: bool) -> None:
    """Add about a hundred arrows, evenly spread over the contact, with the pressure as length."""
    import pyvista as pv  # noqa: PLC0415

    p = np.asarray(grid.point_data["pressure [Pa]"])
    touching = np.flatnonzero(p > 0)
    if not len(touching):
        return
    points = np.asarray(grid.points)[touching]
    push = np.asarray(grid.point_data["push of the drum [Pa]"])[touching]
    chosen = _choose_evenly_spread(points, size, flat=flat)
    lengths = np.linalg.norm(push[chosen], axis=1)
    # The pressures at singular edges are far above all others: their arrows are cut off.
    top = float(np.percentile(lengths, 90))
    arrows = push[chosen] * (0.2 * size / np.maximum(lengths, top))[:, None]
    cloud = pv.PolyData(points[chosen] - arrows)
    cloud["arrow"], cloud["size"] = arrows, np.linalg.norm(arrows, axis=1)
    tip = pv.Arrow(tip_length=0.25, tip_radius=0.05, shaft_radius=0.016)
    plotter.add_mesh(cloud.glyph(orient="arrow", scale="size", geom=tip), color=RED)


def _choose_evenly_spread(points: Floats, size: float, *, flat: bool) -> Any:
    """Positions of points (n, 2+) [m], one in each 2.5 degrees of the surface.

    On a plane 2.5 degrees mean this angle in radians times `size` [m].
    """
    place = points[:, 0] / size if flat else np.arctan2(points[:, 1], points[:, 0])
    turns = place / math.radians(2.5)
    slot = np.round(turns)
    # In each slot the point nearest to its middle comes first.
    order = np.lexsort((np.abs(turns - slot), slot))
    return order[np.unique(slot[order], return_index=True)[1]]


def _round_down(value: float) -> float:
    """The largest 1, 2 or 5 times a power of ten that is not above `value`."""
    power = 10.0 ** math.floor(math.log10(value))
    steps = [step * power for step in (1, 2, 5) if step * power <= value * (1 + 1e-9)]
    return max(steps, default=power)


def _round_up(value: float) -> float:
    """The smallest of BAR_TOPS times a power of ten that is not below `value`."""
    power = 10.0 ** math.floor(math.log10(value)) if value > 0 else 1.0
    return next(step * power for step in BAR_TOPS if step * power >= value * (1 - 1e-9))


def main() -> int:
    """Draw, in a process of its own, by its arguments; returns its exit status."""

    def drew() -> int:
        """Draw the picture that the arguments name."""
        draw_fields_picture(Path(sys.argv[1]), Path(sys.argv[2]), json.loads(sys.argv[3]))
        return 0

    return ended(drew)
