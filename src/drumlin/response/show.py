"""A response as a person sees it in a session: its words, a short table as text or HTML, its pressure as a plot."""

import math
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from drumlin.response.response import Response, ShoeResponse

POINTS = 20  # of a curve in each piece of the pressure


def effect_words(*, flat: bool) -> tuple[str, str]:
    """What a brake does, on a drum or on a plane, and its unit."""
    return ("braking force", "N") if flat else ("torque", "N m")


def place_unit(*, flat: bool) -> tuple[str, float]:
    """The unit in which a person sees angles or, on a plane, places; and how many of it a radian or metre is."""
    return ("mm", 1e3) if flat else ("deg", math.degrees(1))


def factor_word(*, flat: bool) -> str:
    """What a brake factor and a shoe factor are the ratio of."""
    return "B/F" if flat else "T/(F R)"


def _forces(response: "Response") -> list[float]:
    """Braking force [N] of each shoe on a plane; none on a drum."""
    return [getattr(merit, "braking_force") for merit in response.merits if hasattr(merit, "braking_force")]  # noqa: B009


def arcs_text(shoe: "ShoeResponse", *, flat: bool) -> str:
    """Contact arcs as text: numbers in degrees, or in mm for a shoe on a plane."""
    _, factor = place_unit(flat=flat)
    return ", ".join(f"{a * factor:.1f} to {b * factor:.1f}" for a, b in shoe.contact_arcs) or "none"


def rows_of(response: "Response") -> list[tuple[str, ...]]:
    """The head, one row a shoe, and one of the whole brake."""
    forces = _forces(response)
    flat = bool(forces)
    (what, unit), (place, _) = effect_words(flat=flat), place_unit(flat=flat)
    head = (
        "shoe",
        f"{what} [{unit}]",
        "normal force [N]",
        "peak pressure [MPa]",
        f"contact [{place}]",
        "self-energising",
    )
    rows: list[tuple[str, ...]] = [head]
    for i, shoe in enumerate(response.shoes):
        rows.append(
            (
                shoe.name,
                f"{forces[i] if forces else shoe.torque:.6g}",
                f"{shoe.normal_force:.6g}",
                f"{shoe.peak_pressure * 1e-6:.4g}",
                arcs_text(shoe, flat=flat),
                "yes" if shoe.self_energising else "no",
            )
        )
    return [*rows, ("all", f"{sum(forces) if forces else response.torque:.6g}", "", "", "", "")]


def as_text(response: "Response") -> str:
    """The table with its columns aligned, headed by the model."""
    table = rows_of(response)
    widths = [max(len(row[k]) for row in table) for k in range(len(table[0]))]
    lines = ["  ".join(cell.ljust(w) for cell, w in zip(row, widths, strict=True)).rstrip() for row in table]
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
    """Draw p of every shoe, in MPa over degrees (on a plane mm), into matplotlib `axes`, or new ones; returns them."""
    if axes is None:
        from matplotlib import pyplot as plt  # noqa: PLC0415  (matplotlib loads when something is drawn)

        _, axes = plt.subplots()
    flat = bool(_forces(response))
    _, per_unit = place_unit(flat=flat)
    for shoe in response.shoes:
        ends = shoe.theta[:: shoe.order]
        theta = np.unique(np.concatenate([np.linspace(a, b, POINTS) for a, b in pairwise(ends)]))
        axes.plot(theta * per_unit, shoe.pressure_at(theta) * 1e-6, label=shoe.name)
    axes.set(xlabel="place x [mm]" if flat else "angle θ [deg]", ylabel="pressure p [MPa]", title=_title(response))
    axes.legend()
    return axes


def _title(response: "Response") -> str:
    said, forces = "" if response.converged else ", not converged", _forces(response)
    what, unit = effect_words(flat=bool(forces))
    return f"{response.model}: {what} {sum(forces) if forces else response.torque:.6g} {unit}{said}"
