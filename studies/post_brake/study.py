"""Where sine law and foundation model hold on the post brake of a mine winder.

Both models are compared with finite elements.
"""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from studies.post_brake import figures

from drumlin import foundation
from drumlin.base.files import write_text
from drumlin.brake.brake import Brake
from drumlin.brake.file import read_brake
from drumlin.comparison import (
    COLUMNS_OF_COMPARISON_TABLE,
    ModelComparison,
    solve_and_time_model,
    table_as_csv_text,
)
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.solve import solve
from drumlin.report import figures as drawing
from drumlin.report.comparison import (
    comparisons_as_json,
    draw_stress_fields,
    panel_title_and_responses_of_each_shoe,
)
from drumlin.report.page import write_html_page
from drumlin.report.plane_picture import draw_plane_fields_and_return_failure_reason
from drumlin.response.norms import relative_error_of_number
from drumlin_studies import post_brake_rows as post
from drumlin_studies.post_brake_rows import (
    LIFT_OPTION_WITH_ALL_EFFECTS,
    POST_BRAKE_SOLVERS_BY_MODEL_NAME,
    AbscissasAndOrdinatesOfCurve,
    FiguresOfMeritOverFriction,
    TorqueDifferencesOverRadiusOffset,
    TorqueErrorMapOverStiffnessGroups,
)

HERE = Path(__file__).parent
MERITS = {
    "shoe_factor": "shoe factor S",
    "friction_radius": "ψ",
    "resultant_angle": "θ from the post's normal [deg]",
}


@dataclass(frozen=True)
class Result:
    """All results that the report of this study shows.

    The rows of the tables come from the module `post_brake_rows`.
    """

    comparison: ModelComparison[Brake]
    lifts: list[dict[str, Any]]
    clearances: list[dict[str, Any]]
    merits: FiguresOfMeritOverFriction
    offsets: TorqueDifferencesOverRadiusOffset
    assumptions: list[dict[str, Any]]
    maps: list[list[TorqueErrorMapOverStiffnessGroups]]
    place: list[tuple[float, float]]
    grids: list[dict[str, Any]]
    beams: list[dict[str, AbscissasAndOrdinatesOfCurve]]
    rims: tuple[dict[str, AbscissasAndOrdinatesOfCurve], dict[str, AbscissasAndOrdinatesOfCurve]]
    elements: int
    seconds: float


def study(*, short: bool = False, say: Callable[[str], None] = lambda _: None) -> Result:
    """Compute all tables, curves and maps.

    short : trial run with coarser meshes and fewer points in the maps.
    """
    start = time.perf_counter()
    elements, repeats = (24, 1) if short else (80, 5)
    brake = read_brake(HERE / "brake.toml")
    say("side by side")
    scene = make_prepared_model(brake, elements=elements)
    outcomes = [
        solve_and_time_model("fem", partial(solve, brake, elements=elements), 1 if short else 3)
    ]
    for name, model in POST_BRAKE_SOLVERS_BY_MODEL_NAME.items():
        outcomes.append(solve_and_time_model(name, partial(model, brake), repeats))
    comparison = ModelComparison("fits", brake, tuple(outcomes))
    responses = comparison.responses
    # One simplification after the other is removed from the foundation model.
    say("what each simplification is worth")
    lifts = post.error_rows_of_foundation_model_effects(brake, responses["fem"])
    # Linings that fit, of another radius, displaced, and worn in.
    say("clearance")
    clearances = post.rows_of_post_brake_results_by_clearance(brake, scene)
    offsets = post.torque_differences_from_sine_law_at_lining_radii(
        brake, scene, np.linspace(-3e-3, 3e-3, 5 if short else 13)
    )
    say("friction")
    merits = post.figures_of_merit_at_friction_coefficients(
        brake, scene, np.linspace(0.05, 0.6, 4 if short else 12)
    )
    # Brakes that violate one assumption of the model each.
    say("where the assumptions end")
    assumptions = post.error_rows_of_violated_assumptions(brake, 16 if short else 40)
    say("map")
    maps, place = post.torque_error_maps_of_models_and_groups_of_brake(
        brake, 3 if short else 7, 12 if short else 30
    )
    # Steps of the foundation model along beam and ring.
    say("grids")
    grids = post.convergence_rows_of_foundation_grids(brake, repeats)
    beams, rims = (
        post.beam_deflection_curves_of_shoes_by_model(scene, brake, responses),
        post.drum_rim_displacement_curves_by_model(scene, brake, responses),
    )
    return Result(
        comparison,
        lifts,
        clearances,
        merits,
        offsets,
        assumptions,
        maps,
        place,
        grids,
        beams,
        rims,
        elements,
        time.perf_counter() - start,
    )


def report(result: Result, folder: Path) -> Path:
    """Write page, figures, fields, CSV and JSON, and return the path of the page."""
    comparison = result.comparison
    brake, responses = comparison.brake, comparison.responses
    draw_figures(result, folder)
    draw_stress_fields(
        brake, responses["fem"], folder, "fields", ("svg", "png", "vtu"), elements=result.elements
    )
    not_drawn = draw_plane_fields_and_return_failure_reason(
        folder / "fields.vtu", folder / "fields_vtk.png", brake
    )
    write_text(folder / "results.csv", table_as_csv_text(comparison.rows))
    write_text(
        folder / "results.json",
        comparisons_as_json([comparison], **results_data(result)).replace("NaN", "null"),
    )
    error = {}
    for row in result.lifts:
        error[row["lift"]] = row["error"]
    return write_html_page(
        HERE / "page.html",
        folder / "index.html",
        result=result,
        errors={
            "law": relative_error_of_number(responses["sine"].torque, responses["fem"].torque),
            "printed": error["none (the paper)"],
            "lifted": error["all"],
        },
        rows=comparison.rows,
        columns=COLUMNS_OF_COMPARISON_TABLE,
        left_out=foundation.solve_brake_by_foundation_model(
            brake, lift=LIFT_OPTION_WITH_ALL_EFFECTS
        ).left_out,
        not_drawn=not_drawn,
        file=(HERE / "brake.toml").read_text(),
    )


def draw_figures(result: Result, folder: Path) -> None:
    """Write the figures."""
    brake = result.comparison.brake
    made = {
        "beams": figures.draw_beam_deflections(brake, result.beams),
        "rim": figures.draw_rim_displacements(*result.rims),
        "clearance": figures.draw_torque_over_radius_error(result.offsets),
        **{
            key: figures.draw_merit_over_friction(brake, result.merits, key, label)
            for key, label in MERITS.items()
        },
    }
    for name, figure in made.items():
        drawing.save_figure(figure, folder / f"{name}.svg")
    # These pictures are kept with the repository, and each has a version for a column.
    panels = panel_title_and_responses_of_each_shoe(result.comparison)
    drawing.save_figure_for_page_and_column(
        lambda width: drawing.draw_pressure_along_lining_of_each_shoe(panels, width=width),
        folder / "pressure",
    )
    drawing.save_figure_for_page_and_column(
        partial(figures.draw_error_maps, result.maps, result.place), folder / "map"
    )


def results_data(result: Result) -> dict[str, Any]:
    """The content of results.json beside the comparison, as plain data."""
    return {
        "lifts": result.lifts,
        "clearances": result.clearances,
        "assumptions": result.assumptions,
        "grids": result.grids,
        "offsets": result.offsets,
        "merits": {
            shoe: {
                model: [[mu, *merit] for mu, merit in values] for model, values in models.items()
            }
            for shoe, models in result.merits.items()
        },
        "maps": [
            {
                "title": one.title,
                "x": one.x.tolist(),
                "y": one.y.tolist(),
                "error": [
                    [None if math.isnan(v) else v for v in line] for line in one.error.tolist()
                ],
            }
            for row in result.maps
            for one in row
        ],
    }
