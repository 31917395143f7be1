"""How heat in the drum, in the linings and in the shoes moves the pressure of a brake."""

from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from studies.heat import figures

import drumlin
from drumlin.base.files import write_text
from drumlin.brake.brake import Brake
from drumlin.brake.file import read_brake
from drumlin.comparison import table_as_csv_text
from drumlin.report import figures as drawing
from drumlin.report.page import write_html_page
from drumlin.response.response import Response
from drumlin_studies.heat_rows import (
    HEATED_PARTS_BY_STATE_NAME,
    responses_with_heat_only_in_some_parts,
    rows_of_changes_due_to_heat,
    torque_and_reaction_distances_from_triangles,
)

HERE = Path(__file__).parent


class Result(NamedTuple):
    """Everything that the report shows.

    Attributes
    ----------
    brake : Brake
        The hot brake.
    responses : dict
        The response of the brake with heat in each of HEATED_PARTS_BY_STATE_NAME, by the name of
        the state.
    law : Response
        The response by the sine law, which knows no heat.
    judged : dict
        The distance of the hot brake from its solution by the second solver; empty if short.
    """

    brake: Brake
    responses: dict[str, Response]
    law: Response
    judged: dict[str, float]


def study(*, short: bool = False, say: Callable[[str], None] = lambda _: None) -> Result:
    """Solve the hot brake with the heat of each part alone and of all parts, and the cold brake.

    short : whether the second solver is left out.
    """
    brake = read_brake(HERE / "brake.toml")
    say("heat in each part")
    responses = responses_with_heat_only_in_some_parts(brake, drumlin.solve)
    judged = {}
    if not short:
        say("second solver")
        judged = torque_and_reaction_distances_from_triangles(
            brake, drumlin.solve(brake, tolerance=1e-3)
        )
    return Result(brake, responses, drumlin.solve(brake, "sine"), judged)


def report(result: Result, folder: Path) -> Path:
    """Write page, figure and table, and return the path of the page."""
    rows: list[dict[str, Any]] = rows_of_changes_due_to_heat(result.responses)
    write_text(folder / "results.csv", table_as_csv_text(rows))
    drawing.save_figure(
        figures.draw_pressures_of_each_state(result.responses, result.law), folder / "pressure.svg"
    )
    return write_html_page(
        HERE / "page.html",
        folder / "index.html",
        brake=result.brake,
        rows=rows,
        cold=result.responses["cold"],
        hot=result.responses["all parts"],
        law=result.law,
        judged=result.judged,
        parts=HEATED_PARTS_BY_STATE_NAME,
        source_text=(HERE / "brake.toml").read_text(),
    )
