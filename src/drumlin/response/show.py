"""A response as a person sees it in a session: a short table as text or HTML, and its pressure as a plot."""

import html
import math
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from drumlin.response.response import Response

HEAD = ("shoe", "torque [N m]", "normal force [N]", "peak pressure [MPa]", "contact [deg]", "self-energising")
POINTS = 20  # of a curve in each piece of the pressure


def rows_of(response: "Response") -> list[tuple[str, ...]]:
    """One row a shoe, columns as in HEAD, and one of the whole brake."""
    rows = []
    for shoe in response.shoes:
        arcs = ", ".join(f"{math.degrees(a):.1f} to {math.degrees(b):.1f}" for a, b in shoe.contact_arcs)
        rows.append(
            (
                shoe.name,
                f"{shoe.torque:.6g}",
                f"{shoe.normal_force:.6g}",
                f"{shoe.peak_pressure * 1e-6:.4g}",
                arcs or "none",
                "yes" if shoe.self_energising else "no",
            )
        )
    return [*rows, ("all", f"{response.torque:.6g}", "", "", "", "")]


def as_text(response: "Response") -> str:
    """The table with its columns aligned, headed by the model."""
    table = [HEAD, *rows_of(response)]
    widths = [max(len(row[k]) for row in table) for k in range(len(HEAD))]
    lines = ["  ".join(cell.ljust(w) for cell, w in zip(row, widths, strict=True)).rstrip() for row in table]
    return "\n".join([_title(response), *lines])


def as_html(response: "Response") -> str:
    """The table as HTML."""

    def row(cells: tuple[str, ...], tag: str) -> str:
        return "<tr>" + "".join(f"<{tag}>{html.escape(cell)}</{tag}>" for cell in cells) + "</tr>"

    body = "".join(row(cells, "td") for cells in rows_of(response))
    return f"<table><caption>{html.escape(_title(response))}</caption>{row(HEAD, 'th')}{body}</table>"


def plot(response: "Response", axes: Any = None) -> Any:
    """Draw p(theta) of every shoe, in MPa over degrees, into matplotlib `axes` (None: new ones); returns them."""
    if axes is None:
        from matplotlib import pyplot as plt  # noqa: PLC0415  (matplotlib loads when something is drawn)

        _, axes = plt.subplots()
    for shoe in response.shoes:
        ends = shoe.theta[:: shoe.order]
        theta = np.unique(np.concatenate([np.linspace(a, b, POINTS) for a, b in pairwise(ends)]))
        axes.plot(np.degrees(theta), shoe.pressure_at(theta) * 1e-6, label=shoe.name)
    axes.set(xlabel="angle θ [deg]", ylabel="pressure p [MPa]", title=_title(response))
    axes.legend()
    return axes


def _title(response: "Response") -> str:
    said = "" if response.converged else ", not converged"
    return f"{response.model}: torque {response.torque:.6g} N m{said}"
