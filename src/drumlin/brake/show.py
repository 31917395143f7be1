"""Show a brake to the user: a line about the whole brake, and a table with a row for each shoe."""

from typing import TYPE_CHECKING

from drumlin.base.shown_tables import html_table_with_caption, text_lines_of_aligned_columns

if TYPE_CHECKING:
    from drumlin.brake.brake import Brake


def title_line_of_brake(brake: "Brake") -> str:
    """A line of text with the title of a brake, its surface, its motion and its friction."""
    surface = brake.surface
    size = "" if surface.is_plane_and_not_drum else f"drum radius {brake.size * 1e3:.6g} mm, "
    return f"{brake.title}: {size}{brake.motion_as_text}, {brake.friction_coefficients_as_text}"


def rows_of_brake_table(brake: "Brake") -> list[tuple[str, ...]]:
    """The cells of the table of a brake: the headings, and a row for each shoe."""
    surface = brake.surface
    rows: list[tuple[str, ...]] = [
        (
            "shoe",
            f"lining [{surface.shown_unit}]",
            "thickness [mm]",
            "width [mm]",
            "force [N]",
            "support",
        )
    ]
    for shoe in brake.shoes:
        lining = shoe.lining
        shown = surface.si_to_shown_unit_factor
        arcs = [f"{a * shown:.6g} to {b * shown:.6g}" for a, b in lining.arcs]
        thickness = "" if lining.thickness is None else f"{lining.thickness * 1e3:.6g}"
        rows.append(
            (
                shoe.name,
                ", ".join(arcs),
                thickness,
                f"{lining.width * 1e3:.6g}",
                f"{shoe.actuation.force:.6g}",
                shoe.kind_of_support,
            )
        )
    return rows


def text_of_brake(brake: "Brake") -> str:
    """A brake as text: its title line, and a table of its shoes with aligned columns."""
    return "\n".join(
        [title_line_of_brake(brake), *text_lines_of_aligned_columns(rows_of_brake_table(brake))]
    )


def html_table_of_brake(brake: "Brake") -> str:
    """A brake as an HTML table, which notebooks display."""
    return html_table_with_caption(title_line_of_brake(brake), rows_of_brake_table(brake))
