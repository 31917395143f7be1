"""Show a response to a person: a short table as text or HTML, and the pressure as a plot."""

from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from drumlin.brake.surface import FrictionSurface

if TYPE_CHECKING:
    from drumlin.response.response import Response, ShoeResponse

POINTS_PER_PIECE = 20
"""Points of a drawn curve in each piece of the pressure; more do not show in a small plot."""


def arcs_text(shoe: "ShoeResponse", surface: FrictionSurface) -> str:
    """The contact arcs of a shoe as text, in degrees, or in mm on a plane."""
    factor = surface.shown
    arcs = [f"{start * factor:.1f} to {end * factor:.1f}" for start, end in shoe.contact_arcs]
    return ", ".join(arcs) or "none"


def rows_of(response: "Response") -> list[tuple[str, ...]]:
    """The rows of a response's table: the head, a row per shoe, and a row of the whole brake."""
    surface, effects = response.surface, response.effects
    head = (
        "shoe",
        f"{surface.effect} [{surface.effect_unit}]",
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
            arcs_text(shoe, surface),
            "yes" if shoe.self_energising else "no",
        )
        rows.append(row)
    return [*rows, ("all", f"{response.effect:.6g}", "", "", "", "")]


def as_text(response: "Response") -> str:
    """The table of a response as text with aligned columns, under a line with model and effect."""
    table = rows_of(response)
    widths = np.char.str_len(table).max(axis=0).tolist()
    lines = [_title(response)]
    for row in table:
        # Each cell is padded to the width of its column.
        lines.append("  ".join(map(str.ljust, row, widths)).rstrip())
    return "\n".join(lines)


def as_html(response: "Response") -> str:
    """The table of a response as HTML, for notebooks."""
    # The module brings a table of all entities, and only notebooks need the module.
    from html import escape  # noqa: PLC0415

    def row(cells: tuple[str, ...], tag: str) -> str:
        """A row of the table whose cells have the given tag."""
        return "<tr>" + "".join(f"<{tag}>{escape(cell)}</{tag}>" for cell in cells) + "</tr>"

    head, *rest = rows_of(response)
    body = "".join(row(cells, "td") for cells in rest)
    return f"<table><caption>{escape(_title(response))}</caption>{row(head, 'th')}{body}</table>"


def plot(response: "Response", axes: Any = None) -> Any:
    """Draw the pressure of every shoe, in MPa over degrees, or over mm on a plane.

    The curves are drawn into the given matplotlib `axes`, or into new axes, which are returned.
    """
    if axes is None:
        # matplotlib is loaded only when something is drawn.
        from matplotlib import pyplot as plt  # noqa: PLC0415

        _, axes = plt.subplots()
    surface = response.surface
    for shoe in response.shoes:
        ends = shoe.theta[:: shoe.order]
        pieces = [np.linspace(a, b, POINTS_PER_PIECE) for a, b in pairwise(ends)]
        theta = np.unique(np.concatenate(pieces))
        axes.plot(theta * surface.shown, shoe.pressure_at(theta) * 1e-6, label=shoe.name)
    axes.set(xlabel=surface.axis, ylabel="pressure p [MPa]", title=_title(response))
    axes.legend()
    return axes


def _title(response: "Response") -> str:
    """One line with the model of a response and the torque or the braking force."""
    surface = response.surface
    unconverged = "" if response.converged else ", not converged"
    effect = f"{response.effect:.6g} {surface.effect_unit}"
    return f"{response.model}: {surface.effect} {effect}{unconverged}"
