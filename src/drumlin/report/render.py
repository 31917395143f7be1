"""A picture of stress and contact pressure, which pyvista draws without a window.

Drawing without a window needs OpenGL or its replacement in software. If neither is installed, the
library VTK may end the whole process instead of raising an error.
`draw_fields_and_return_failure_reason` therefore runs this module in a process of its own, and
returns the reason if the process fails.
"""

import json
import math
import subprocess
import sys
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import call_function_and_return_exit_status
from drumlin.base.files import temporary_file_replacing_output
from drumlin.base.round_numbers import largest_round_number_not_above_value
from drumlin.base.texts import printable_single_line
from drumlin.brake.brake import Brake
from drumlin.brake.fields import Point
from drumlin.brake.support import Held
from drumlin.report.palette import INK, RED

RENDER_SECONDS = 120
"""Seconds after which a drawing process counts as hung and is ended. A picture takes some 3 s."""

STRESS_TITLE = "von Mises stress [MPa]"
"""The title of the colour bar, and the name of the stresses [MPa] in the grid of pyvista."""

COLOUR_BAR_ENDS = 1, 1.2, 1.6, 2, 2.4, 3.2, 4, 6, 8, 10
"""Allowed upper ends of the colour bar, times any power of ten; a quarter of each is round."""

ARROW_LENGTH = 0.28
"""Length of each force's arrow, relative to the drum's radius, on a plane half a brake's length."""

FIELD_WIDTH, FIELD_HEIGHT = 1500, 1300
"""Width and height [pixels] of the picture of stress and pressure."""


DRAWING_PACKAGES = ("pyvista", "vtkmodules")
"""The packages that draw pictures in space; the extra `fields` installs them."""


class NoPicture(Exception):
    """The exception for a drawing process that has ended without a picture."""


def draw_fields_and_return_failure_reason(
    fields: Path, picture: Path, brake: Brake, title: str
) -> str | None:
    """Draw the displacements, stresses and pressures of a .vtu file into a .png file.

    Parameters
    ----------
    fields : the .vtu file
    picture : the .png file
    brake : the brake, whose friction surface, pins and forces are drawn
    title : title of the picture

    Returns
    -------
    None, or one line that says why the picture could not be drawn
    """
    surface = _friction_surface_line_and_symbol_scale(brake)
    pins: list[list[float]] = []
    for shoe in brake.shoes:
        pins += [list(point.xy) for point in _points_of_shoe_supports(shoe)]
    # `marks` is what the picture shows besides the fields of the .vtu file. It is passed to the
    # drawing process as JSON.
    marks = {
        "surface": surface.line.tolist(),
        "size": surface.size,
        "flat": brake.surface.is_plane_and_not_drum,
        "pins": pins,
        "forces": [
            [*shoe.actuation.point.xy, *shoe.actuation.force_vector] for shoe in brake.shoes
        ],
        "title": title,
    }
    return draw_picture_in_new_process(__name__, fields, picture, json.dumps(marks))


def draw_picture_in_new_process(
    module: str, fields: Path, picture: Path, argument: str
) -> str | None:
    """Start a new process in which a module's `main` draws a .vtu file into a .png file.

    Parameters
    ----------
    module : dotted name of the module with the function `main`
    fields : the .vtu file
    picture : the .png file, which is written whole or not at all
    argument : text that `main` gets as its third argument, after the paths of both files

    Returns
    -------
    None, or one line that says why the picture could not be drawn
    """
    if not all(map(find_spec, DRAWING_PACKAGES)):
        return "no field picture: pyvista needs the extra drumlin[fields]"
    child = (
        f"import sys; sys.path.append(sys.argv.pop(1)); from {module} import main; sys.exit(main())"
    )
    # With -P Python imports nothing from the current folder. The folder of drumlin's source is
    # added to the search path, because drumlin may not be installed.
    folder = str(Path(__file__).parents[2])
    command = [sys.executable, "-P", "-c", child, folder, str(fields)]
    try:
        with temporary_file_replacing_output(picture) as partial:
            run_drawing_process([*command, str(partial), argument])
        return None
    except NoPicture as error:
        # Delete a picture of an earlier run, so that nobody takes it for the picture of the new
        # result.
        if picture.is_file():
            picture.unlink()
        reason = printable_single_line(str(error), 200)
        return f"no field picture: off-screen rendering is not possible here ({reason})"


class _SurfaceLine(NamedTuple):
    """The friction surface to draw.

    Attributes
    ----------
    line : points (n, 2) [m] of the drum's circle or of the plane
    size : length [m] to which the sizes of arrows and symbols are relative
    """

    line: Floats
    size: float


def _friction_surface_line_and_symbol_scale(brake: Brake) -> _SurfaceLine:
    """The line of a brake's friction surface, and the length by which drawn symbols are scaled.

    This length is the drum's radius, or, on a plane, half the length of the brake.
    """
    if not brake.surface.is_plane_and_not_drum:
        turn = np.linspace(0, 2 * math.pi, 361)
        return _SurfaceLine(brake.size * np.column_stack([np.cos(turn), np.sin(turn)]), brake.size)
    places: list[float] = []
    for shoe in brake.shoes:
        places += [shoe.pin.x, shoe.actuation.point.x, shoe.lining.start, shoe.lining.end]
    left, right = min(places), max(places)
    return _SurfaceLine(np.array([[left, 0.0], [right, 0.0]]), 0.5 * (right - left))


def _points_of_shoe_supports(shoe: Held) -> list[Point]:
    """The points that support a shoe: pin, lever's pivot, abutment and anchors, if it has them."""
    foot = None if shoe.abutment is None else shoe.abutment.point
    anchors = [anchor.point for anchor in shoe.anchors]
    return [point for point in (shoe.hinge, shoe.pivot, foot, *anchors) if point is not None]


def run_drawing_process(command: list[str]) -> None:
    """Run a drawing process to its end.

    Raises NoPicture if the process fails or hangs. The text of the exception is the last line that
    the process wrote to standard error.
    """
    try:
        done = subprocess.run(command, capture_output=True, timeout=RENDER_SECONDS, check=False)
    except (OSError, subprocess.TimeoutExpired) as error:
        raise NoPicture(type(error).__name__) from error
    if done.returncode:
        lines = done.stderr.decode(errors="replace").strip().splitlines()
        raise NoPicture(lines[-1] if lines else f"exit status {done.returncode}")


def draw_fields_in_this_process(fields: Path, picture: Path, marks: dict[str, Any]) -> None:
    """Draw a .vtu file of fields into a .png file, within this process.

    The picture shows the von Mises stress on the deformed shoes, arrows of pressure, pins, forces,
    and drum or plane. `marks` is the dictionary that `draw_fields_and_return_failure_reason` makes.
    """
    import pyvista as pv  # noqa: PLC0415  (only in the process that draws)

    size, line = float(marks["size"]), np.array(marks["surface"])
    grid = pv.read(fields)
    u = np.asarray(grid.point_data["displacement [m]"])
    grid.point_data[STRESS_TITLE] = np.asarray(grid.point_data["von Mises [Pa]"]) * 1e-6
    # Displacements are enlarged: the largest displacement is drawn up to 4 % of the drum's radius
    # long.
    factor = largest_round_number_not_above_value(
        0.04 * size / (float(np.linalg.norm(u, axis=1).max()) or 1.0)
    )
    deformed = grid.copy()
    deformed.points = np.asarray(grid.points) + factor * u
    plotter = pv.Plotter(off_screen=True, window_size=(FIELD_WIDTH, FIELD_HEIGHT))
    plotter.set_background("white")
    _add_stress_colours_to_picture(plotter, deformed)
    plotter.add_mesh(_outline_of_undeformed_shoes(grid), color="#888888", line_width=2)
    points = np.column_stack([line, np.zeros(len(line))])
    plotter.add_mesh(pv.lines_from_points(points), color="black", line_width=5)
    _add_pressure_arrows_to_picture(plotter, grid, size, flat=marks["flat"])
    arrow_ends = _add_force_arrows_to_picture(plotter, marks["forces"], size)
    for x, y in marks["pins"]:
        disc = pv.Disc(center=(x, y, 0), inner=0, outer=0.035 * size, c_res=40)
        plotter.add_mesh(disc, color=INK)
    plotter.add_text(
        _title_and_legend_text_of_picture(marks, factor),
        position="upper_left",
        font_size=12,
        color="black",
    )
    # Aim the camera so that shoes, friction surface, pins and arrows are visible.
    plotter.view_xy()
    plotter.enable_parallel_projection()
    corners = np.reshape(deformed.bounds[:4], (2, 2)).T
    places = [line.min(axis=0), line.max(axis=0), *marks["pins"], *arrow_ends, *corners]
    _aim_camera_so_that_all_points_are_visible(plotter.camera, np.array(places), margin=0.2 * size)
    plotter.screenshot(str(picture))


def _add_stress_colours_to_picture(plotter: Any, deformed: Any) -> None:
    """Add the deformed shoes to the picture, coloured by their stress, and the colour bar."""
    # Stresses at singular edges are far above all other stresses. The colour bar therefore ends at
    # the stress that 0.5 % of the nodes exceed.
    top = _rounded_up_to_end_of_colour_bar(
        float(np.percentile(deformed.point_data[STRESS_TITLE], 99.5))
    )
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


def _add_force_arrows_to_picture(
    plotter: Any, forces: list[list[float]], size: float
) -> list[list[float]]:
    """Add an arrow of the same length for each actuation force to the picture.

    A force is given as x, y [m] and Fx, Fy [N]. Returns the points x, y [m] of all tails and tips.
    """
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


def _title_and_legend_text_of_picture(marks: dict[str, Any], factor: float) -> str:
    """The text in the picture: title, factor on displacements, and meaning of the symbols."""
    surface = "plane" if marks["flat"] else "drum"
    return (
        f"{marks['title']}\n"
        f"Displacements x {factor:g} (undeformed outline grey), {surface} black.\n"
        f"Orange arrows: pressure of the {surface} on the lining. "
        "Black arrows: actuation. Discs: pins and feet."
    )


def _aim_camera_so_that_all_points_are_visible(camera: Any, places: Floats, margin: float) -> None:
    """Aim the camera so that all places (n, 2) [m] are left of the colour bar and below the text.

    The colour bar takes 16 % of the picture's width, and the text 10 % of its height.
    """
    left, bottom = places.min(axis=0) - margin
    right, top = places.max(axis=0) + margin
    # `scale` is half the height [m] that the picture must show to hold all places in both
    # directions.
    scale_by_height = (top - bottom) / 2 / 0.9
    scale_by_width = (right - left) / 2 / 0.84 * FIELD_HEIGHT / FIELD_WIDTH
    scale = max(scale_by_height, scale_by_width)
    x = (left + right) / 2 + 0.13 * scale * FIELD_WIDTH / FIELD_HEIGHT
    y = (bottom + top) / 2 + 0.09 * scale
    camera.parallel_scale = scale
    camera.focal_point, camera.position = (x, y, 0), (x, y, 1)


def _outline_of_undeformed_shoes(grid: Any) -> Any:
    """The outline of the undeformed shoes as a grid of pyvista.

    It consists of all edges of cells that belong to one cell only, after equal nodes are merged.
    """
    flat = grid.copy()
    flat.clear_data()
    surface = flat.extract_surface(algorithm="dataset_surface", nonlinear_subdivision=1)
    return surface.clean(tolerance=1e-7).extract_feature_edges(
        boundary_edges=True, feature_edges=False, manifold_edges=False, non_manifold_edges=False
    )


def _add_pressure_arrows_to_picture(plotter: Any, grid: Any, size: float, *, flat: bool) -> None:
    """Add arrows of the contact pressure to the picture, evenly spread over the contact.

    The length of an arrow is in proportion to the pressure, except for the largest pressures.
    `size` [m] is the drum's radius, or, on a plane (`flat`), half the length of the brake.
    """
    import pyvista as pv  # noqa: PLC0415

    p = np.asarray(grid.point_data["pressure [Pa]"])
    touching = np.flatnonzero(p > 0)
    if not len(touching):
        return
    points = np.asarray(grid.points)[touching]
    push = np.asarray(grid.point_data["push of the drum [Pa]"])[touching]
    chosen = _indices_of_evenly_spread_points(points, size, flat=flat)
    lengths = np.linalg.norm(push[chosen], axis=1)
    # Pressures at singular edges are far above all other pressures. The longest tenth of the arrows
    # is therefore shortened to one length.
    top = float(np.percentile(lengths, 90))
    arrows = push[chosen] * (0.2 * size / np.maximum(lengths, top))[:, None]
    cloud = pv.PolyData(points[chosen] - arrows)
    cloud["arrow"], cloud["size"] = arrows, np.linalg.norm(arrows, axis=1)
    tip = pv.Arrow(tip_length=0.25, tip_radius=0.05, shaft_radius=0.016)
    plotter.add_mesh(cloud.glyph(orient="arrow", scale="size", geom=tip), color=RED, lighting=False)


def _indices_of_evenly_spread_points(points: Floats, size: float, *, flat: bool) -> Any:
    """Indices of evenly spread points among the given points (n, 2 or 3) [m].

    One point is chosen in each sector of 2.5 degrees of the drum. On a plane a stretch of 0.044
    `size` [m] (2.5 degrees in radians) takes the place of a sector.
    """
    place = points[:, 0] / size if flat else np.arctan2(points[:, 1], points[:, 0])
    turns = place / math.radians(2.5)
    slot = np.round(turns)
    # Sort the points by sector, and within a sector by their distance from its middle. The first
    # point of each sector is taken.
    order = np.lexsort((np.abs(turns - slot), slot))
    return order[np.unique(slot[order], return_index=True)[1]]


def _rounded_up_to_end_of_colour_bar(value: float) -> float:
    """The smallest number not below `value` that is one of COLOUR_BAR_ENDS times a power of ten."""
    power = 10.0 ** math.floor(math.log10(value)) if value > 0 else 1.0
    return next(step * power for step in COLOUR_BAR_ENDS if step * power >= value * (1 - 1e-9))


def draw_picture_named_by_arguments(draw: Callable[[Path, Path, str], None]) -> int:
    """Draw the picture that the arguments of this process name; returns the exit status.

    `draw` is called with the .vtu file (argument 1), the .png file (argument 2) and a further text
    (argument 3).
    """

    def draw_and_return_zero() -> int:
        """Draw the picture; returns 0."""
        draw(Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3])
        return 0

    return call_function_and_return_exit_status(draw_and_return_zero)


def main() -> int:
    """Draw the fields that the arguments of this process name; returns the exit status.

    The third argument is the JSON text of the marks: what the picture shows besides the fields.
    """
    return draw_picture_named_by_arguments(
        lambda fields, picture, marks: draw_fields_in_this_process(
            fields, picture, json.loads(marks)
        )
    )
