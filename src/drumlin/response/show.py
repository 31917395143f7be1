"""A response as a person sees it in a session: its words, a short table as text or HTML, its
pressure as a plot.
"""

from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from drumlin.brake.surface import FrictionSurface

if TYPE_CHECKING:
    from drumlin.response.response import Response, ShoeResponse

POINTS_PER_PIECE = 20  # of a curve in each piece of the pressure


def arcs_text(shoe: "ShoeResponse", surface: FrictionSurface) -> str:
    """Contact arcs as text: numbers in the unit in which a person sees places of the surface."""
    factor = surface.shown
    return (
        ", ".join(f"{a * factor:.1f} to {b * factor:.1f}" for a, b in shoe.contact_arcs) or "none"
    )


def rows_of(response: "Response") -> list[tuple[str, ...]]:
    """The head, one row a shoe, and one of the whole brake."""
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
        rows.append(
            (
                shoe.name,
                f"{effects[i]:.6g}",
                f"{shoe.normal_force:.6g}",
                f"{shoe.peak_pressure * 1e-6:.4g}",
                arcs_text(shoe, surface),
                "yes" if shoe.self_energising else "no",
            )
        )
    return [*rows, ("all", f"{response.effect:.6g}", "", "", "", "")]


def as_text(response: "Response") -> str:
    """The table with its columns aligned, headed by the model."""
    table = rows_of(response)
    widths = [max(len(row[k]) for row in table) for k in range(len(table[0]))]
    lines = [
        "  ".join(cell.ljust(w) for cell, w in zip(row, widths, strict=True)).rstrip()
        for row in table
    ]
    return "\n".join([_title(response), *lines])


def as_html(response: "Response") -> str:
    """The table as HTML."""
    from html import escape  # noqa: PLC0415  (with a table of all entities, which a notebook alone needs)

    def row(cells: tuple[str, ...], tag: str) -> str:
        return "<tr>" + "".join(f"<{tag}>{escape(cell)}</{tag}>" for cell in cells) + "</tr>"

    head, *rest = rows_of(response)
    body = "".join(row(cells, "td") for cells in rest)
    return f"<table><caption>{escape(_title(response))}</caption>{row(head, 'th')}{body}</table>"


def plot(response: "Response", axes: Any = None) -> Any:
    """Draw p of every shoe, in MPa over degrees (on a plane mm), into matplotlib `axes`, or new
    ones; returns them.
    """
    if axes is None:
        from matplotlib import pyplot as plt  # noqa: PLC0415  (matplotlib loads when something is drawn)

        _, axes = plt.subplots()
    surface = response.surface
    for shoe in response.shoes:
        ends = shoe.theta[:: shoe.order]
        theta = np.unique(
            np.concatenate([np.linspace(a, b, POINTS_PER_PIECE) for a, b in pairwise(ends)])
        )
        axes.plot(theta * surface.shown, shoe.pressure_at(theta) * 1e-6, label=shoe.name)
    axes.set(xlabel=surface.axis, ylabel="pressure p [MPa]", title=_title(response))
    axes.legend()
    return axes


def _title(response: "Response") -> str:
    said, surface = "" if response.converged else ", not converged", response.surface
    return f"{response.model}: {surface.effect} {response.effect:.6g} {surface.effect_unit}{said}"
