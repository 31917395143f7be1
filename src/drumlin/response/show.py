"""Show a response to the reader: a short table as text or HTML, and a plot of the pressure."""

from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from drumlin.base.errors import BadInput
from drumlin.base.shown_tables import html_table_with_caption, text_lines_of_aligned_columns
from drumlin.base.texts import value_as_text
from drumlin.brake.surface import FrictionSurface

if TYPE_CHECKING:
    from drumlin.response.response import Response, ShoeResponse

DRAWN_POINTS_PER_POLYNOMIAL_PIECE = 20
"""Number of points at which each polynomial piece of the pressure is drawn.

More points do not change a small plot.
"""

TOP_OVER_PEAK = 1.12
"""Upper end of the pressure axis, relative to the largest peak pressure, as in reports."""


def text_of_contact_arcs(shoe: "ShoeResponse", surface: FrictionSurface) -> str:
    """The contact arcs of a shoe as text, in degrees, on a plane in mm; "none" without contact."""
    factor = surface.si_to_shown_unit_factor
    arcs = [f"{start * factor:.1f} to {end * factor:.1f}" for start, end in shoe.contact_arcs]
    return ", ".join(arcs) or "none"


def rows_of_response_table(response: "Response") -> list[tuple[str, ...]]:
    """The cells of the table of a response: headings, a row for each shoe, a row for the brake."""
    surface, effects = response.surface, response.effects
    head = (
        "shoe",
        f"{surface.word_for_torque_or_brake_force} [{surface.unit_of_torque_or_brake_force}]",
        "normal force [N]",
        "peak pressure [MPa]",
        f"contact [{surface.shown_unit}]",
        "self-energising",
    )
    rows: list[tuple[str, ...]] = [head]
    for i, shoe in enumerate(response.shoes):
        row = (
            shoe.name,
            f"{effects[i]:.6g}",
            f"{shoe.normal_force:.6g}",
            f"{shoe.peak_pressure * 1e-6:.4g}",
            text_of_contact_arcs(shoe, surface),
            "yes" if shoe.self_energising else "no",
        )
        rows.append(row)
    return [*rows, ("all", f"{response.effect:.6g}", "", "", "", "")]


def text_of_response(response: "Response") -> str:
    """A response as text: a line with model and torque, and a table with aligned columns."""
    table = text_lines_of_aligned_columns(rows_of_response_table(response))
    return "\n".join([_title_line_of_response(response), *table])


def html_table_of_response(response: "Response") -> str:
    """A response as an HTML table, which notebooks display."""
    return html_table_with_caption(
        _title_line_of_response(response), rows_of_response_table(response)
    )


def matplotlib_axes_itself_or_new(axes: Any) -> Any:
    """The given axes of matplotlib; for None new axes.

    Raises BadInput for any other value.
    """
    # matplotlib is loaded only when something is drawn.
    from matplotlib import pyplot as plt  # noqa: PLC0415
    from matplotlib.axes import Axes  # noqa: PLC0415

    if axes is None:
        return plt.subplots()[1]
    if not isinstance(axes, Axes):
        raise BadInput(f"axes = {value_as_text(axes)}: must be one axes of matplotlib, or None")
    return axes


def plot_pressure_of_each_shoe(response: "Response", axes: Any = None, prefix: str = "") -> Any:
    """Draw the pressure of every shoe, in MPa over degrees, or over mm on a plane.

    The curves are drawn into the given matplotlib `axes`, or into new axes if it is None. In the
    legend `prefix` stands before the name of the shoe. The vertical axis ends above the largest
    peak pressure: the unbounded pressure at a sharp edge of a lining is cut. The function returns
    the axes. Raises BadInput for a value that is no axes of matplotlib.
    """
    axes = matplotlib_axes_itself_or_new(axes)
    surface = response.surface
    top = axes.get_ylim()[1] if axes.has_data() else 0.0
    for shoe in response.shoes:
        top = max(top, TOP_OVER_PEAK * shoe.peak_pressure * 1e-6)
        ends = shoe.theta[:: shoe.order]
        pieces = [np.linspace(a, b, DRAWN_POINTS_PER_POLYNOMIAL_PIECE) for a, b in pairwise(ends)]
        theta = np.unique(np.concatenate(pieces))
        axes.plot(
            theta * surface.si_to_shown_unit_factor,
            shoe.pressure_at(theta) * 1e-6,
            label=f"{prefix}{shoe.name}",
        )
    axes.set(
        xlabel=surface.axis_label_in_python,
        ylabel="pressure p [MPa]",
        title=_title_line_of_response(response),
    )
    if top > 0:
        axes.set_ylim(0, top)
    axes.legend()
    return axes


def _title_line_of_response(response: "Response") -> str:
    """A line of text with the model of a response and the torque, on a plane the braking force."""
    surface = response.surface
    unconverged = "" if response.converged else ", not converged"
    effect = f"{response.effect:.6g} {surface.unit_of_torque_or_brake_force}"
    return f"{response.model}: {surface.word_for_torque_or_brake_force} {effect}{unconverged}"
