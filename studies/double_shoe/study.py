"""The errors of the sine law on a double-shoe brake with elastic shoes.

The study solves a double-shoe brake with stiff and with flexible shoes, in both rotations.
"""

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from drumlin.base.files import write_text
from drumlin.brake.brake import Brake
from drumlin.brake.file import read_brake, vary
from drumlin.comparison import (
    COLUMNS_OF_COMPARISON_TABLE,
    ModelComparison,
    ResultsOnRefinedMeshes,
    compare,
    solve_on_refined_meshes,
    table_as_csv_text,
)
from drumlin.report import figures
from drumlin.report.comparison import (
    comparisons_as_json,
    draw_stress_fields,
    panel_title_and_responses_of_each_shoe,
)
from drumlin.report.page import write_html_page
from drumlin.report.plane_picture import draw_plane_fields_and_return_failure_reason
from drumlin.response.norms import relative_error_of_number
from drumlin.verification.cost import TimesAndMemoryOfSolve, measure_time_and_memory_of_fem
from drumlin_studies.orders import (
    largest_equilibrium_residual_of_responses,
    rows_comparing_sine_law_with_rigid_shoe_solves,
    torque_convergence_rows_of_meshes,
)

HERE = Path(__file__).parent
ROTATIONS = ("counter-clockwise", "clockwise")
FILES = {"brake.toml": "stiff shoes", "flexible.toml": "flexible shoes"}


class Result(NamedTuple):
    """All results that the report of this study shows."""

    comparisons: list[ModelComparison[Brake]]
    limit: list[dict[str, Any]]
    convergence: ResultsOnRefinedMeshes
    cost: TimesAndMemoryOfSolve
    elements: int
    seconds: float


def study(*, short: bool = False, say: Callable[[str], None] = lambda _: None) -> Result:
    """Compare the models, take the limit of a rigid shoe, refine the mesh, and measure the cost.

    short : whether coarser meshes and fewer repeats are enough.
    """
    start = time.perf_counter()
    elements, repeats = (40, 1) if short else (160, 5)
    comparisons = []
    for file, case in FILES.items():
        brake = read_brake(HERE / file)
        for rotation in ROTATIONS:
            say(f"{case}, {rotation}")
            turning = vary(brake, {"rotation": rotation})
            comparisons.append(compare(turning, case, repeats, ("fem", "sine"), elements=elements))
    brake = comparisons[0].brake
    # With a stiff shoe and a thin lining the finite elements approach the law.
    say("limit of a rigid shoe")
    limit: list[dict[str, Any]] = []
    for rotation in ROTATIONS:
        limit += rows_comparing_sine_law_with_rigid_shoe_solves(
            vary(brake, {"rotation": rotation}), elements
        )
    # Meshes that double show the order of the error.
    say("convergence")
    convergence = solve_on_refined_meshes(brake, (10, 20, 40) if short else (20, 40, 80, 160, 320))
    say("cost")
    return Result(
        comparisons,
        limit,
        convergence,
        measure_time_and_memory_of_fem(brake, repeats=1 if short else 7),
        elements,
        time.perf_counter() - start,
    )


def report(result: Result, folder: Path) -> Path:
    """Write page, figures, fields, CSV and JSON, and return the path of the page."""
    rows = []
    for comparison in result.comparisons:
        for row in comparison.rows:
            rows.append(row)
    meshes = torque_convergence_rows_of_meshes(result.convergence)
    limit = result.convergence.torque
    write_text(folder / "results.csv", table_as_csv_text(rows))
    extra = {
        "rigid_limit": result.limit,
        "convergence": meshes,
        "torque_limit": limit._asdict(),
        "cost": result.cost._asdict(),
    }
    write_text(folder / "results.json", comparisons_as_json(result.comparisons, **extra))
    draw_figures(result, folder)
    # The stress picture is that of the stiff brake.
    main = result.comparisons[0]
    draw_stress_fields(
        main.brake,
        main.responses["fem"],
        folder,
        "fields",
        ("svg", "png", "vtu"),
        elements=result.elements,
    )
    not_drawn = draw_plane_fields_and_return_failure_reason(
        folder / "fields.vtu", folder / "fields_vtk.png", main.brake
    )
    missed = {}
    for row in rows:
        if (row["model"], row["shoe"]) == ("sine", "all"):
            missed[row["case"]] = row["torque_error"]
    orders = []
    for i in range(2):
        orders.append(result.convergence.pressure(i))
    brakes = {}
    for name in FILES:
        brakes[f"studies/double_shoe/{name}"] = (HERE / name).read_text()
    return write_html_page(
        HERE / "page.html",
        folder / "index.html",
        result=result,
        rows=rows,
        columns=COLUMNS_OF_COMPARISON_TABLE,
        missed=missed,
        not_drawn=not_drawn,
        meshes=meshes,
        limit=limit,
        orders=orders,
        residual=largest_equilibrium_residual_of_responses(
            [comparison.responses["fem"] for comparison in result.comparisons]
        ),
        left_out=main.responses["fem"].left_out,
        brakes=brakes,
    )


def draw_figures(result: Result, folder: Path) -> None:
    """Write the figures, which are of kinds that several reports share."""
    panels: dict[str, list[figures.PressurePanel]] = {case: [] for case in FILES.values()}
    for comparison in result.comparisons:
        panels[comparison.case] += panel_title_and_responses_of_each_shoe(comparison)
    stiff, flexible = panels.values()
    # The first panels, of one rotation, are the picture at the top of README.
    one_rotation = stiff[: len(result.comparisons[0].brake.shoes)]
    for name, drawn in (("pressure", stiff), ("pressure_one_rotation", one_rotation)):
        figures.save_pressure_figure_for_page_and_column(drawn, folder / name)
    figures.save_figure(
        figures.draw_pressure_along_lining_of_each_shoe(flexible), folder / "pressure_flexible.svg"
    )
    convergence = result.convergence
    steps = {}
    for i, shoe in enumerate(convergence.responses[0].shoes):
        steps[f"p, {shoe.name} shoe (L2, to the next finer mesh)"] = list(
            zip(
                convergence.elements,
                convergence.relative_pressure_distances_between_meshes(i),
                strict=False,
            )
        )
    steps["torque, from its limit"] = [
        (n, abs(relative_error_of_number(r.torque, convergence.torque.value)))
        for n, r in zip(convergence.elements, convergence.responses, strict=True)
    ]
    figures.save_figure(
        figures.draw_errors_over_element_numbers(steps, "relative distance"),
        folder / "convergence.svg",
    )
