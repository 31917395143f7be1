"""Whether the law of each kind of brake can be trusted, with new and with worn-in linings."""

from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from matplotlib.figure import Figure

from drumlin.base.files import write_text
from drumlin.brake.brake import Brake
from drumlin.brake.plane_brake import read_drum_or_plane_brake
from drumlin.comparison import table_as_csv_text
from drumlin.report import figures
from drumlin.report.drawing import draw_brake
from drumlin.report.page import write_html_page
from drumlin_studies.brake_kinds import (
    LARGEST_ERROR_OF_TRUSTED_LAW,
    BrakeSolvedByAllModels,
    brake_and_reversed_brake,
    brake_factor_of_cam_brake,
    row_of_errors_of_rigid_shoe_law,
    self_locking_friction_by_finite_elements,
    sentence_on_whether_law_can_be_trusted,
    solve_brake_by_all_models,
    torque_error_rows_of_other_models,
)

HERE = Path(__file__).parent
SHOWN = "simplex_abutted"
"""Brake whose pressures are drawn for the reference report as well."""
SHORT = ("simplex_abutted", "s_cam", "rail_clamp")
"""The brakes that a trial run of this study (option --short) solves."""


class Result(NamedTuple):
    """All results that the report of this study shows.

    Attributes
    ----------
    cases : list of BrakeSolvedByAllModels
        Each brake in both senses of motion.
    rows, others : list of dict Rows of the report's tables: by the rigid-shoe law, and by all other
        models.
    verdicts : dict For each brake file a sentence on whether the law can be trusted.
    cams : dict
        Brake factor of worn-in S-cam brakes in closed form, by brake file.
    """

    cases: list[BrakeSolvedByAllModels]
    rows: list[dict[str, Any]]
    others: list[dict[str, Any]]
    verdicts: dict[str, str]
    cams: dict[str, float]


def study(*, short: bool = False, say: Callable[[str], None] = lambda _: None) -> Result:
    """Solve all brakes by their rigid-shoe law and by finite elements.

    short : trial run with three brakes only, coarser worn-in linings, no solid model, and no search
    for the friction at which a brake locks itself.
    """
    cases: list[BrakeSolvedByAllModels] = []
    rows: list[dict[str, Any]] = []
    verdicts, cams = {}, {}
    for path in sorted(HERE.glob("*.toml")):
        if short and path.stem not in SHORT:
            continue
        # Both senses of motion of the brake.
        own = []
        for brake in brake_and_reversed_brake(read_drum_or_plane_brake(path)):
            say(f"{path.stem}: {brake.direction_as_text_in_tables}")
            found = solve_brake_by_all_models(
                path.stem, brake, 24 if short else 60, solid=not short
            )
            cases.append(found)
            own.append(
                row_of_errors_of_rigid_shoe_law(
                    found, None if short else self_locking_friction_by_finite_elements(brake)
                )
            )
        rows += own
        verdicts[path.stem] = sentence_on_whether_law_can_be_trusted(own)
        brake = cases[-1].brake
        if (
            not brake.surface.is_plane_and_not_drum
            and brake.actuation is not None
            and brake.actuation.is_cam_or_wedge
        ):
            cams[path.stem] = brake_factor_of_cam_brake(brake)
    others = [row for found in cases for row in torque_error_rows_of_other_models(found)]
    return Result(cases, rows, others, verdicts, cams)


def report(result: Result, folder: Path) -> Path:
    """Write page, drawings, figures and tables, and return the path of the page."""
    write_text(folder / "brakes.csv", table_as_csv_text(result.rows))
    write_text(folder / "models.csv", table_as_csv_text(result.others))
    drawn: dict[str, Brake] = {}
    for found in result.cases:
        drawn.setdefault(found.file, found.brake)
    for file, brake in drawn.items():
        # One panel for each shoe and sense: new, worn in, and by the law.
        panels = []
        for found in result.cases:
            if found.file != file:
                continue
            for i, shoe in enumerate(found.brake.shoes):
                of = {
                    "fem": found.new.shoes[i],
                    "worn": found.worn.shoes[i],
                    found.law.model: found.law.shoes[i],
                }
                panels.append((f"{shoe.name}, {found.brake.direction_as_text_in_tables}", of))
        endings = ("svg", "png") if file == SHOWN else ("svg",)
        figures.save_pressure_figure_for_page_and_column(
            panels, folder / file, endings, brake.surface
        )
        figure = Figure(figsize=(4.5, 4.5), layout="constrained")
        draw_brake(figure.subplots(), brake)
        figures.save_figure(figure, folder / f"{file}_drawing.svg")
    errors = {}
    for key in ("new", "worn", "p"):
        errors[key] = [abs(row[key]) for row in result.rows]
    rough = set()
    for row in result.rows:
        if abs(row["new"]) > LARGEST_ERROR_OF_TRUSTED_LAW:
            rough.add(row["file"])
    titles = {}
    for f, b in drawn.items():
        titles[f] = b.title
    worst = {}
    for key, values in errors.items():
        worst[key] = max(values)
    least = {}
    for key, values in errors.items():
        least[key] = min(values)
    return write_html_page(
        HERE / "page.html",
        folder / "index.html",
        result=result,
        titles=titles,
        worst=worst,
        least=least,
        trusted=sorted(set(result.verdicts) - rough),
    )
