"""Start a process of its own for a picture, which pyvista draws without a window.

Drawing without a window needs OpenGL or its replacement in software. If neither is installed, the
library VTK may end the whole process instead of raising an error. `draw_picture_in_new_process`
therefore draws in another process, and returns the reason if the drawing fails.
"""

import subprocess
import sys
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path

from drumlin.base.errors import call_function_and_return_exit_status
from drumlin.base.files import temporary_file_replacing_output
from drumlin.base.texts import printable_single_line
from drumlin.report.rendered_figure import RimRadii

LONGEST_DRAWING_SECONDS = 120
"""Seconds after which a drawing process counts as hung and is ended. A picture takes some 3 s."""

DRAWING_PACKAGES = ("pyvista", "vtkmodules")
"""The packages that draw pictures of .vtu files; the extra `fields` of drumlin installs them."""


class PictureNotDrawn(Exception):
    """The exception for a drawing process that has ended without a picture."""


def draw_picture_in_new_process(
    module: str, fields: Path, picture: Path, title: str, rim: RimRadii | None
) -> str | None:
    """Start a new process in which a module's `main` draws a .vtu file into a .png file.

    Parameters
    ----------
    module : dotted name of the module with the function `main`
    fields : the .vtu file
    picture : the .png file, which is written whole or not at all
    title : title of the picture
    rim : radii of the band that stands for the drum; None for no band

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
            run_drawing_process([*command, str(partial), title, *map(repr, rim or ())])
        return None
    except PictureNotDrawn as error:
        # Delete a picture of an earlier run, so that nobody takes it for the picture of the new
        # result.
        if picture.is_file():
            picture.unlink()
        reason = printable_single_line(str(error), 200)
        return f"no field picture: off-screen rendering is not possible here ({reason})"


def run_drawing_process(command: list[str]) -> None:
    """Run a drawing process to its end.

    Raises PictureNotDrawn if the process fails or hangs. The text of the exception is the last line
    that the process wrote to standard error.
    """
    try:
        done = subprocess.run(
            command, capture_output=True, timeout=LONGEST_DRAWING_SECONDS, check=False
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        raise PictureNotDrawn(type(error).__name__) from error
    if done.returncode:
        lines = done.stderr.decode(errors="replace").strip().splitlines()
        raise PictureNotDrawn(lines[-1] if lines else f"exit status {done.returncode}")


def draw_picture_named_by_arguments(
    draw: Callable[[Path, Path, str, RimRadii | None], None],
) -> int:
    """Draw the picture that the arguments of this process name; returns the exit status.

    `draw` is called with the .vtu file (argument 1), the .png file (argument 2), the title of the
    picture (argument 3) and the radii [m] of the drum's band (arguments 4 and 5), which may lack.
    """

    def draw_picture_and_return_zero() -> int:
        """Draw the picture; returns 0."""
        rim = RimRadii(*map(float, sys.argv[4:])) if sys.argv[4:] else None
        draw(Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3], rim)
        return 0

    return call_function_and_return_exit_status(draw_picture_and_return_zero)
