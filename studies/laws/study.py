"""Assumptions, results and failures of each rigid-shoe law.

The laws are applied to worked examples and to every kind of brake.
"""

import json
import math
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from studies.laws.figures import (
    draw_brakes_side_by_side,
    draw_friction_over_arc,
    draw_pressures_by_law,
    draw_short_shoe_merits,
    draw_torque_over_speed,
)

from drumlin.base.files import write_text
from drumlin.brake.plane_brake import read_drum_or_plane_brake
from drumlin.comparison import table_as_csv_text
from drumlin.laws.simscape import DoubleShoe
from drumlin.report.figures import save_figure
from drumlin.report.page import software_versions, write_html_page
from drumlin.response.response import ShoeResponse
from drumlin_studies.law_table import (
    responses_of_one_shoe_by_law,
    rows_of_laws_that_cannot_solve_brakes,
    rows_of_shoe_factors_of_post_brake,
    rows_of_shoe_results_by_every_law,
)
from drumlin_studies.worked_examples import (
    rows_of_equivalent_block_friction,
    rows_of_printed_and_computed_numbers,
    rows_of_simscape_double_shoe_brake,
)

HERE = Path(__file__).parent
FILES = (
    "laws/pad.toml",
    "laws/short_block.toml",
    "laws/block.toml",
    "laws/double_block.toml",
    "laws/pivoted_block.toml",
    "double_shoe/brake.toml",
    "laws/double_shoe_external.toml",
    "post_brake/brake.toml",
)
DRAWINGS = {
    "short_shoes": [
        ("short block on a lever", "laws/short_block.toml"),
        ("pad on a plane", "laws/pad.toml"),
    ],
    "double_shoes": [
        ("internal double shoe", "double_shoe/brake.toml"),
        ("external double shoe", "laws/double_shoe_external.toml"),
    ],
    "blocks": [
        ("block on a lever", "laws/block.toml"),
        ("double block brake", "laws/double_block.toml"),
    ],
    "pivoted": [("pivoted block", "laws/pivoted_block.toml")],
    "post_brake": [("post brake", "post_brake/brake.toml")],
}


class Result(NamedTuple):
    """All results that the report of this study shows.

    Attributes
    ----------
    examples, applies, words : list of dict Rows of three tables: the worked examples, every brake
        file by every law, and statements quoted from the sources of the laws.
    pressures : dict
        The response of one shoe by each law.
    """

    examples: list[dict[str, Any]]
    applies: list[dict[str, Any]]
    words: list[dict[str, Any]]
    pressures: dict[str, ShoeResponse]


def study(*, short: bool = False, say: Callable[[str], None] = lambda _: None) -> Result:
    """Compute all tables. The study is fast, so that `short` changes nothing."""
    # Printed numbers of textbooks against the laws.
    say("worked examples")
    given = tomllib.loads((HERE / "examples.toml").read_text())["example"]
    examples: list[dict[str, Any]] = []
    for example in given:
        examples += rows_of_printed_and_computed_numbers(example, HERE)
    examples += rows_of_simscape_double_shoe_brake() + rows_of_equivalent_block_friction()
    # Each brake file by each law that applies to it.
    say("brake files")
    applies: list[dict[str, Any]] = []
    for file in FILES:
        applies += rows_of_shoe_results_by_every_law(
            read_drum_or_plane_brake(HERE.parent / file), file
        )
    post_brake = read_drum_or_plane_brake(HERE.parent / "post_brake/brake.toml")
    shoes = responses_of_one_shoe_by_law(
        read_drum_or_plane_brake(HERE / "block.toml"), read_drum_or_plane_brake(HERE / "pad.toml")
    )
    return Result(examples, applies, rows_of_shoe_factors_of_post_brake(post_brake), shoes)


def report(result: Result, folder: Path) -> Path:
    """Write page, figures, CSV and JSON, and return the path of the page."""
    write_text(
        folder / "results.csv", table_as_csv_text(result.examples + result.applies + result.words)
    )
    data = {
        "versions": software_versions(),
        "examples": result.examples,
        "files": result.applies,
        "words": result.words,
    }
    write_text(folder / "results.json", json.dumps(data, indent=1) + "\n")
    # Drawings of the brakes, several brakes side by side.
    for name, files in DRAWINGS.items():
        save_figure(
            draw_brakes_side_by_side(
                [(title, read_drum_or_plane_brake(HERE.parent / file)) for title, file in files]
            ),
            folder / f"{name}.svg",
        )
    # Angles from the hinge to the middle of the short shoes.
    angles = []
    for angle in (60, 90, 120):
        angles.append(math.radians(angle))
    save_figure(draw_short_shoe_merits(angles, a_over_r=1.2), folder / "merits.svg")
    save_figure(draw_friction_over_arc(), folder / "friction.svg")
    save_figure(
        draw_torque_over_speed(DoubleShoe(), (0, 250, 500, 1000), 1000.0), folder / "speed.svg"
    )
    save_figure(draw_pressures_by_law(result.pressures), folder / "pressures.svg")

    def examples_of(law: str, source: str, but: str | None) -> list[dict[str, Any]]:
        """The rows of a law's worked examples from one source.

        Examples whose source also contains the text `but` are left out.
        """
        rows = []
        for r in result.examples:
            if r["law"] == law and source in r["source"]:
                rows.append(r)
        rows = [r for r in rows if but is None or but not in r["source"]]
        assert rows, f"no worked example of {law} from {source!r}"
        return rows

    return write_html_page(
        HERE / "page.html",
        folder / "index.html",
        result=result,
        examples_of=examples_of,
        reasons=rows_of_laws_that_cannot_solve_brakes(result.applies),
        files={file: (HERE.parent / file).read_text() for file in FILES},
    )
