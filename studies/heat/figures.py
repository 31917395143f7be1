"""The figure of the pressures of a brake with heat in each of its parts."""

from collections.abc import Mapping

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from drumlin.report.figures import (
    MATPLOTLIB_SETTINGS_FOR_PRINT,
    draw_legend_below_figure,
    draw_triangles_where_curve_leaves_axes,
    evenly_spaced_pressure_curve_of_shoe,
    make_figure_for_print,
)
from drumlin.report.palette import BLUE, GREEN, INK, OCHRE, PURPLE, RED
from drumlin.response.response import Response

STATES = {
    "cold": (INK, "-"),
    "drum": (BLUE, "--"),
    "linings": (GREEN, "-."),
    "bodies": (OCHRE, (0, (1, 1))),
    "all parts": (PURPLE, "-"),
}
"""Colour and line style of each state of the brake."""


def draw_pressures_of_each_state(responses: Mapping[str, Response], law: Response) -> Figure:
    """The pressure over the angle for each state, a panel for each shoe, beside the sine law.

    Parameters
    ----------
    responses : mapping
        The response of each state, by the keys of STATES.
    law : Response
        The response by the sine law.
    """
    count = len(law.shoes)
    # Under a sharp edge of a lining p has no bound. The axes end above the peaks elsewhere.
    top = 1.25e-6 * max(
        shoe.peak_pressure for response in responses.values() for shoe in response.shoes
    )
    with mpl.rc_context(MATPLOTLIB_SETTINGS_FOR_PRINT):
        figure = make_figure_for_print(2.8)
        panels = figure.subplots(1, count, squeeze=False, sharey=True)[0]
        for i, (axes, shoe) in enumerate(zip(panels, law.shoes, strict=True)):
            axes.set_ylim(0, top)
            for name, response in responses.items():
                color, style = STATES[name]
                theta, p = evenly_spaced_pressure_curve_of_shoe(response.shoes[i])
                label = "cold" if name == "cold" else f"hot: {name}"
                width = 2.2 if name in ("cold", "all parts") else 1.5
                axes.plot(np.degrees(theta), p * 1e-6, color=color, ls=style, lw=width, label=label)
                draw_triangles_where_curve_leaves_axes(axes, np.degrees(theta), p * 1e-6, color)
            axes.plot(
                np.degrees(shoe.theta),
                shoe.pressure * 1e-6,
                color=RED,
                ls=(0, (6, 2)),
                lw=1.2,
                label="sine law, cold or hot",
            )
            axes.set_title(f"{shoe.name} shoe")
            axes.set_xlabel("angle on the drum θ [deg]")
        panels[0].set_ylabel("pressure p [MPa]")
        draw_legend_below_figure(figure, panels[0])
    return figure
