"""Show a response to a person: as a short table in text or HTML, and its pressure as a plot."""

from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from drumlin.brake.surface import FrictionSurface

if TYPE_CHECKING:
    from drumlin.response.response import Response, ShoeResponse

POINTS_PER_PIECE = 20
"""Points of a drawn curve in each piece of the pressure. More would not show in a small plot."""


def arcs_text(shoe: "ShoeResponse", surface: FrictionSurface) -> str:
    """Contact arcs as text, in the unit in which a person sees places of the surface."""
    factor = surface.shown
    arcs = [f"{start * factor:.1f} to {end * factor:.1f}" for start, end in shoe.contact_arcs]
    return ", ".join(arcs) or "none"


def rows_of(response: "Response") -> list[tuple[str, ...]]:
    """Rows of the table: its head, one row per shoe, and one of the whole brake."""
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
    """The table with its columns aligned, under the name of the model."""
    table = rows_of(response)
    widths = [max(len(row[k]) for row in table) for k in range(len(table[0]))]
    lines = [_title(response)]
    for row in table:
        cells = [cell.ljust(width) for cell, width in zip(row, widths, strict=True)]
        lines.append("  ".join(cells).rstrip())
    return "\n".join(lines)


def as_html(response: "Response") -> str:
    """The table as HTML."""
    # A table of all entities comes with the module, and only notebooks need it.
    from html import escape  # noqa: PLC0415

    def row(cells: tuple[str, ...], tag: str) -> str:
        return "<tr>" + "".join(f"<{tag}>{escape(cell)}</{tag}>" for cell in cells) + "</tr>"

    head, *rest = rows_of(response)
    body = "".join(row(cells, "td") for cells in rest)
    return f"<table><caption>{escape(_title(response))}</caption>{row(head, 'th')}{body}</table>"


def plot(response: "Response", axes: Any = None) -> Any:
    """Draw the pressure of every shoe, in MPa over degrees, or over mm on a plane.

    It draws into matplotlib `axes`, or into new axes, and returns them.
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
    """Model and effect of a response in one line."""
    surface = response.surface
    unconverged = "" if response.converged else ", not converged"
    effect = f"{response.effect:.6g} {surface.effect_unit}"
    return f"{response.model}: {surface.effect} {effect}{unconverged}"
