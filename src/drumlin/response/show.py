"""Show a response to the reader: a short table as text or HTML, and a plot of the pressure."""

import textwrap
from collections.abc import Mapping
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from drumlin.base.errors import BadInput
from drumlin.base.shown_tables import html_table_with_caption, text_lines_of_aligned_columns
from drumlin.base.texts import error_text_in_percent, value_as_text
from drumlin.brake.surface import FrictionSurface

if TYPE_CHECKING:
    from drumlin.response.response import Response, ShoeResponse

DRAWN_POINTS_PER_POLYNOMIAL_PIECE = 20
"""Number of points at which each polynomial piece of the pressure is drawn.

More points do not change a small plot.
"""

WIDTH_OF_SHOWN_LINES = 100
"""Number of characters after which a line below the table of a response is broken."""

BEGIN_OF_NOTE_ON_PEAKS_OVER_WIDTH = "peak p over the width:"
"""First words of the note of a solid model that gives the peaks over the arc and the width."""

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
        "reaction [N]",
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
            f"{np.linalg.norm(shoe.hinge_reaction):.6g}",
            "yes" if shoe.self_energising else "no",
        )
        rows.append(row)
    return [*rows, ("all", f"{response.effect:.6g}", "", "", "", "", "")]


def estimated_errors_as_line(effect: str, error: Mapping[str, float]) -> str:
    """The estimated relative errors of pressure, torque, peak and reaction as one line of text.

    `effect` is the printed name of the torque, or of the braking force on a plane. An estimate of 1
    or more says that the value is not known.
    """
    texts = {key: error_text_in_percent(e) if e < 1 else "not known" for key, e in error.items()}
    line = f"estimated error: p {texts['pressure']} (L2, worst shoe)"
    names = {"torque": effect, "peak": "peak pressure", "reaction": "hinge reaction"}
    for key, name in names.items():
        if key in texts:
            line += f", {name} {texts[key]}"
    return line


def plane_stress_errors_as_line(effect: str, response: "Response") -> str:
    """The estimated relative errors of the plane-stress assumption as one line of text.

    Where the errors of the mesh are known too, the line also gives the sums of both errors.
    `effect` is the printed name of the torque, or of the braking force on a plane.
    """
    found, mesh = response.plane_stress_error, response.error
    # The caller has made sure that the response states errors of plane stress.
    assert found is not None
    if found.unknown:
        return f"error of plane stress itself: not known, {found.unknown}"
    names = {"torque": effect, "reaction": "hinge reaction"}
    subject = "error of plane stress itself"
    if found.corrected:
        subject = "error of plane stress after the correction for the widths"
    line = f"{subject}: p {error_text_in_percent(found.brake['pressure'])} (mean over the width)"
    for key, name in names.items():
        line += f", {name} {error_text_in_percent(found.brake[key])}"
    line += ", peak pressure not known"
    if mesh is None:
        return line
    both = {key: found.brake[key] + mesh[key] for key in ("pressure", *names) if key in mesh}
    line += (
        "; both errors together, with all inputs taken as exact: "
        f"p {error_text_in_percent(both.pop('pressure'))}"
    )
    for key, error in both.items():
        line += f", {names[key]} {error_text_in_percent(error)}"
    return line


def lines_below_response_table(response: "Response") -> list[str]:
    """The lines below the table of a response: self-locking, warnings and estimated errors.

    Notes on the supports and on the steps of the solution are left out; `Response.notes` has them.
    """
    word = response.surface.word_for_torque_or_brake_force
    lines = []
    if response.self_locking is not None:
        lines.append(response.self_locking.line())
    for note in response.notes:
        is_shown = note.startswith(("warning:", "note:", BEGIN_OF_NOTE_ON_PEAKS_OVER_WIDTH))
        if is_shown or ": no contact" in note:
            lines.append(note)
    if response.error is not None:
        lines.append(estimated_errors_as_line(word, response.error))
    if response.plane_stress_error is not None:
        lines.append(plane_stress_errors_as_line(word, response))
    return lines


def text_of_response(response: "Response") -> str:
    """A response as text: model and torque, a table with aligned columns, warnings and errors."""
    lines = text_lines_of_aligned_columns(rows_of_response_table(response))
    for line in lines_below_response_table(response):
        lines += textwrap.wrap(line, WIDTH_OF_SHOWN_LINES, subsequent_indent="  ")
    return "\n".join([_title_line_of_response(response), *lines])


def html_table_of_response(response: "Response") -> str:
    """A response as an HTML table with lines below it, which notebooks display."""
    # The standard module `html` loads a table of all entities, and only notebooks need it.
    from html import escape  # noqa: PLC0415

    table = html_table_with_caption(
        _title_line_of_response(response), rows_of_response_table(response)
    )
    lines = [f"<div>{escape(line)}</div>" for line in lines_below_response_table(response)]
    return "".join([table, *lines])


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


LINE_STYLES_OF_SHOES = ("-", "--", ":", "-.")
"""Styles of the lines of the shoes in their order, where the colour of a line is that of its model.

A fifth shoe has the style of the first one.
"""


def plot_pressure_of_each_shoe(
    response: "Response", axes: Any = None, prefix: str = "", color: str | None = None
) -> Any:
    """Draw the pressure of every shoe, in MPa over degrees, or over mm on a plane.

    The curves are drawn into the given matplotlib `axes`, or into new axes if it is None. In the
    legend `prefix` stands before the name of the shoe. With a `color` all curves have it, and the
    shoes differ by the style of their lines; without, each shoe has a colour. The vertical axis
    ends above the largest peak pressure: the unbounded pressure at a sharp edge of a lining is cut,
    and the legend says so. The function returns the axes. Raises BadInput for a value that is no
    axes of matplotlib.
    """
    axes = matplotlib_axes_itself_or_new(axes)
    surface = response.surface
    top = axes.get_ylim()[1] if axes.has_data() else 0.0
    styles = LINE_STYLES_OF_SHOES
    for number, shoe in enumerate(response.shoes):
        top = max(top, TOP_OVER_PEAK * shoe.peak_pressure * 1e-6)
        ends = shoe.theta[:: shoe.order]
        pieces = [np.linspace(a, b, DRAWN_POINTS_PER_POLYNOMIAL_PIECE) for a, b in pairwise(ends)]
        theta = np.unique(np.concatenate(pieces))
        axes.plot(
            theta * surface.si_to_shown_unit_factor,
            shoe.pressure_at(theta) * 1e-6,
            label=f"{prefix}{shoe.name}",
            color=color,
            linestyle="-" if color is None else styles[number % len(styles)],
        )
    axes.set(
        xlabel=surface.axis_label_in_python,
        ylabel="pressure p [MPa]",
        title=_title_line_of_response(response),
    )
    if top > 0:
        axes.set_ylim(0, top)
    is_cut = any(np.max(line.get_ydata()) > top > 0 for line in axes.lines)
    axes.legend(title="cut at the top: p at sharp edges" if is_cut else None)
    return axes


def _title_line_of_response(response: "Response") -> str:
    """A line of text with the model of a response and the torque, on a plane the braking force."""
    surface = response.surface
    unconverged = "" if response.converged else ", not converged"
    effect = f"{response.effect:.6g} {surface.unit_of_torque_or_brake_force}"
    return f"{response.model}: {surface.word_for_torque_or_brake_force} {effect}{unconverged}"
