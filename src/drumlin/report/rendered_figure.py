"""What the pictures that pyvista draws have in common: title, colour bar, and the rim of the drum.

pyvista draws the bodies only. Title and colour bar are drawn by matplotlib around its pixels, so
that their text has the same size in print as in all other figures.
"""

from typing import Any, NamedTuple

import matplotlib as mpl
import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from drumlin.brake.brake import Brake
from drumlin.report.field_picture import (
    BAR_WIDTH,
    COLOUR_BAR_WIDTH,
    LEAST_HEIGHT,
    MOST_HEIGHT,
    draw_colour_bar_of_stress,
)
from drumlin.report.figures import (
    COLUMN_WIDTH,
    MATPLOTLIB_SETTINGS_FOR_PRINT,
    PIXELS_PER_INCH,
    height_of_title,
    write_title_above_picture,
)

STRESS_ARRAY_NAME = "von Mises stress [MPa]"
"""The name of the stresses [MPa] in the grid of pyvista."""

PIXELS_PER_INCH_OF_RENDERED_FIGURE = 2 * PIXELS_PER_INCH
"""Resolution of a picture of pyvista, in pixels per inch of the printed figure.

A picture for a column has with it as many pixels as other figures have for a page.
"""

DRAWN_RIM_THICKNESS_OVER_RADIUS = 0.025
"""Thickness of the grey band that stands for a rigid drum, relative to the drum's radius.

The thickness of a rigid drum is not a number of the brake. The band is thinner than the linings of
usual brakes, so that nobody takes it for a shoe. The value is a judgement by eye.
"""

COLOR_OF_DRAWN_RIM = "#c3c8cd"
"""The colour of the band that stands for a rigid drum. No stress has this colour."""


class RimRadii(NamedTuple):
    """Radii of the grey band that stands for the drum in a picture.

    Attributes
    ----------
    inner : inner radius of the band [m]
    outer : outer radius of the band [m]
    """

    inner: float
    outer: float


def radii_of_drawn_rim(brake: Brake) -> RimRadii | None:
    """The radii of the band that stands for a rigid drum; None for a plane or an elastic ring.

    One radius of the band is the radius of the drum, and the band lies on the side of the drum that
    has no shoes. An elastic ring is a body with stresses of its own, and needs no band.
    """
    if brake.surface.is_plane_and_not_drum or brake.ring is not None:
        return None
    thickness = DRAWN_RIM_THICKNESS_OVER_RADIUS * brake.size
    if brake.shoes[0].side == "external":
        return RimRadii(brake.size - thickness, brake.size)
    return RimRadii(brake.size, brake.size + thickness)


def pixels_without_white_margins(pixels: Any) -> Any:
    """The part of an image (rows, columns, 3) that holds all pixels that are not white."""
    drawn = (pixels < 255).any(axis=2)
    rows, columns = np.flatnonzero(drawn.any(axis=1)), np.flatnonzero(drawn.any(axis=0))
    if not len(rows):
        return pixels
    return pixels[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1]


def figure_around_pixels(pixels: Any, title: str, top: float, *, beyond: bool) -> Figure:
    """A figure of COLUMN_WIDTH with an image (rows, columns, 3), its title and its colour bar.

    The text is large enough for a column, so that no second version is needed.

    Parameters
    ----------
    pixels : the image
    title : lines of the title
    top : upper end of the colour bar [MPa]
    beyond : whether some stresses are larger than `top`
    """
    room = COLUMN_WIDTH - BAR_WIDTH
    rows, columns = pixels.shape[:2]
    height = min(room * rows / columns, MOST_HEIGHT)
    width = height * columns / rows
    # A flat picture gets room above and below, since the colour bar needs some height.
    shown = max(height, LEAST_HEIGHT)
    total = shown + height_of_title(title)
    with mpl.rc_context(MATPLOTLIB_SETTINGS_FOR_PRINT):
        figure = Figure(figsize=(COLUMN_WIDTH, total))
        left, bottom = 0.5 * (room - width) / COLUMN_WIDTH, 0.5 * (shown - height) / total
        axes = figure.add_axes((left, bottom, width / COLUMN_WIDTH, height / total))
        axes.imshow(pixels, aspect="auto")
        axes.set_axis_off()
        bar = figure.add_axes(
            (
                (room + 0.08) / COLUMN_WIDTH,
                0.2 * shown / total,
                COLOUR_BAR_WIDTH / COLUMN_WIDTH,
                0.6 * shown / total,
            )
        )
        draw_colour_bar_of_stress(bar, ScalarMappable(Normalize(0, top), "viridis"), beyond=beyond)
        write_title_above_picture(figure, title)
    return figure
