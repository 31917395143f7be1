"""The colours and line styles of all figures.

Readers with red-green blindness can tell the nine colours of curves apart. The models also differ
in their line styles.
"""

from typing import Any

BLUE, RED, GREEN, OCHRE, PURPLE = "#0072b2", "#d55e00", "#00c663", "#feaa00", "#7d1fce"
SKY, GREY, BROWN, INK = "#77bbe2", "#828890", "#635135", "#1d2733"
"""The colours of curves; with the five colours from BLUE to PURPLE there are nine.

INK is also the colour of text and outlines.
"""

CURVE_COLORS = (BLUE, RED, GREEN, OCHRE, PURPLE, SKY, GREY, BROWN, INK)
"""The colours of curves, in the order in which a figure uses them."""

COLOR_OF_AXES_AND_NOTES = "#5b6875"
"""The colour of axes and notes. No curve has this colour."""

COLOR_OF_SHADED_AREAS = "#e9d8c3"
"""The colour of shaded areas. No curve has this colour."""

ERROR_SCALE_COLORS = ("#2166ac", "#92c5de", "#f7e3b0", "#d6604d")
"""Colours of a scale of errors, from low (blue) to high (red)."""

COLOR_AND_LINE_STYLE_BY_MODEL: dict[str, tuple[str, Any]] = {
    "fem": (BLUE, "-"),
    "sine": (RED, "--"),
    "cosine": (PURPLE, "-."),
    "block": (SKY, (0, (1, 1))),
    "uniform": (GREY, (0, (5, 1, 1, 1, 1, 1))),
    "short": (INK, (0, (3, 1))),
    "pivoted": (OCHRE, "-."),
    "linear": (BROWN, "--"),
    "rigid": (RED, "-."),
    "solid": (INK, "-"),
    "worn": (GREEN, "-"),
    "cold": (SKY, "-"),
    "foundation": (GREEN, (0, (6, 2))),
    "lifted": (OCHRE, ":"),
}
"""Colour and matplotlib line style of each model's curves, by the name of the model."""


def color_of_model(model: str) -> str:
    """The colour of a model's curves in all figures; the colour of axes for an unknown model."""
    return (
        COLOR_AND_LINE_STYLE_BY_MODEL[model][0]
        if model in COLOR_AND_LINE_STYLE_BY_MODEL
        else COLOR_OF_AXES_AND_NOTES
    )


def color_and_line_style_of_model(model: str) -> dict[str, Any]:
    """Colour and line style of a model's curves, as keyword arguments of matplotlib."""
    return {
        "color": color_of_model(model),
        "ls": COLOR_AND_LINE_STYLE_BY_MODEL[model][1]
        if model in COLOR_AND_LINE_STYLE_BY_MODEL
        else "-",
    }
