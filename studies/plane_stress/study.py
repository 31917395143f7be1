"""How far plane stress is from a solid shoe of T-section, and for which brakes it is enough."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from studies.plane_stress import figures
from studies.plane_stress.limits import draw_plane_stress_limits, marked_values

from drumlin.base.files import write_text
from drumlin.brake.brake import Brake
from drumlin.brake.components import BeamBody
from drumlin.brake.file import read_brake, vary
from drumlin.comparison import table_as_csv_text
from drumlin.fem.analysis.fields import write_fields_to_vtu_file
from drumlin.fem.analysis.solid_fields import recover_stresses_in_half_of_each_solid_shoe
from drumlin.fem.error_control.levels import REFINEMENT_LEVELS_FROM_COARSE_TO_FINE
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.width.prepare import prepare_model_with_shoe_widths
from drumlin.report import figures as drawing
from drumlin.report.page import write_html_page
from drumlin.report.solid_picture import draw_solid_shoes_and_return_failure_reason
from drumlin_studies import plane_stress as rows
from drumlin_studies.plane_stress import (
    PlaneStressErrorMap,
    PressuresOfWornSolidLinings,
    ResponsesBySolidAndPlaneStress,
    TimeAndErrors,
    TorqueOnLevels,
)
from drumlin_studies.plane_stress_limits import (
    parameter_ranges_within_error_limits,
    rows_of_plane_stress_limits,
)
from drumlin_studies.uncertainty import ComparisonOfSimulationWithData

HERE = Path(__file__).parent
WIDTHS: Sequence[float] = (1.0, 2.0, 5.0, 10.0, 20.0)
"""Width of the lining over its thickness."""
MODULI: Sequence[float] = (50.0, 150.0, 300.0, 1000.0, 3000.0)  # MPa
WEBS: Sequence[float] = (0.1, 0.2, 0.4, 0.7, 1.0)
"""Width of the web over that of the lining."""
TABLES: Sequence[float] = (1.5, 2.0, 3.0, 5.0, 8.0)  # mm
FRICTIONS: Sequence[float] = (0.1, 0.2, 0.3, 0.4, 0.5)
POISSON: Sequence[float] = (0.0, 0.1, 0.25, 0.35, 0.45)
DISTANCES: Sequence[float] = (
    0.0,
    0.03,
    0.1,
    0.3,
    1.0,
    3.0,
    10.0,
    20.0,
    40.0,
    70.0,
    100.0,
    150.0,
    200.0,
)  # 1/(k K)


@dataclass(frozen=True)
class Setting:
    """How fine the meshes are, and how many brakes are solved.

    Attributes
    ----------
    levels : int
        Number of levels of the section on which the study's own brake is solved.
    every : int
        One in so many points of the maps is solved.
    truth : int
        Degree across the width of the solid that serves as truth of the ladder.
    meshes, solids : tuple of int
        Elements of the ladder in plane stress, and degrees of its solids.
    """

    levels: int
    every: int
    truth: int
    meshes: tuple[int, ...]
    solids: tuple[int, ...]


FULL = Setting(3, 1, 6, (8, 16, 32, 64, 128), (1, 2, 3, 4, 5))
SHORT = Setting(2, 4, 4, (8, 16), (1, 2))


@dataclass(frozen=True)
class Result:
    """Everything that the report shows."""

    three: ResponsesBySolidAndPlaneStress
    scene: Any
    table: list[dict[str, Any]]
    certain: tuple[TorqueOnLevels, TorqueOnLevels]
    validation: ComparisonOfSimulationWithData
    maps: tuple[PlaneStressErrorMap, PlaneStressErrorMap]
    curves: dict[str, list[tuple[float, list[dict[str, Any]]]]]
    worn: PressuresOfWornSolidLinings
    ladder: dict[str, list[TimeAndErrors]]
    limits: list[dict[str, Any]]
    marked: dict[str, dict[str, float]]
    seconds: float


def study(*, short: bool = False, say: Callable[[str], None] = lambda _: None) -> Result:
    """Compute all tables, curves and maps.

    short : whether coarser meshes and fewer points are enough.
    """
    start = time.perf_counter()
    setting = SHORT if short else FULL
    brake = read_brake(HERE / "brake.toml")
    say("the brake itself")
    scene = prepare_model_with_shoe_widths(
        brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0], rows.DEFAULT_DEGREE_ACROSS_SOLID_WIDTH
    )
    three = rows.solve_by_solid_and_plane_stress(brake)
    # Finer divisions of the section give the uncertainty of the torque in both models.
    say("levels of the section")
    levels = REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[: setting.levels]
    true = rows.solve_torque_on_refinement_levels(
        lambda level: rows.solve_with_solid_shoes(brake, level=level).torque, levels
    )
    plane = rows.solve_torque_on_refinement_levels(
        lambda level: solve_prepared_model(make_prepared_model(brake, level), brake).torque, levels
    )
    maps = _map_errors(brake, setting, say)
    curves = _error_curves(brake, setting, say)
    say("wear")
    worn = rows.wear_solid_linings(brake, DISTANCES if not short else DISTANCES[::3])
    # Time and error of each model, on the car brake and on the post brake.
    ladder = {}
    for each in (brake, post_brake_on_rigid_drum()):
        say(f"the ladder: {each.title}")
        ladder[each.title] = rows.measure_time_and_errors_of_models(
            each, setting.truth, setting.meshes, setting.solids
        )
    varied = {"one width": read_brake(HERE.parent / "double_shoe" / "flexible.toml")}
    varied["T-section"] = brake
    limits = rows_of_plane_stress_limits(varied, setting.every, say)
    return Result(
        three=three,
        scene=scene,
        table=rows.plane_stress_error_rows_of_shoes(three, "T-section"),
        certain=(plane, true),
        validation=rows.compare_plane_stress_torque_with_solid(plane, true),
        maps=maps,
        curves=curves,
        worn=worn,
        ladder=ladder,
        limits=limits,
        marked=marked_values(varied),
        seconds=time.perf_counter() - start,
    )


def _map_errors(
    brake: Brake, setting: Setting, say: Callable[[str], None]
) -> tuple[PlaneStressErrorMap, PlaneStressErrorMap]:
    """Maps of the error: over width and modulus of a plain lining, and over web and table."""
    thickness = brake.shoes[0].lining.thickness
    width = brake.shoes[0].lining.width

    def with_lining(x: float, y: float) -> Brake:
        """The plain brake with a lining of the width x [thickness] and the modulus y [MPa]."""
        return rows.brake_with_width_and_lining_modulus(brake, x * thickness, y * 1e6)

    def with_section(x: float, y: float) -> Brake:
        """The brake with a web of the width x [lining width] and a table of y [mm]."""
        changes = {"shoe.body.width": x * width, "shoe.backing.thickness": y * 1e-3}
        return vary(brake, changes)

    every = setting.every
    one_width = rows.map_plane_stress_errors(
        "one width",
        ("lining width / thickness", "lining modulus [MPa]"),
        with_lining,
        WIDTHS[::every],
        MODULI[::every],
        say,
    )
    table_and_web = rows.map_plane_stress_errors(
        "table and web",
        ("web width / lining width", "table thickness [mm]"),
        with_section,
        WEBS[::every],
        TABLES[::every],
        say,
    )
    return one_width, table_and_web


def _error_curves(
    brake: Brake, setting: Setting, say: Callable[[str], None]
) -> dict[str, list[tuple[float, list[dict[str, Any]]]]]:
    """Error rows over the values of single quantities, by the name of the quantity."""
    thickness = brake.shoes[0].lining.thickness
    curves = {}
    for name, key, values, unit in (
        ("friction", "friction", FRICTIONS, 1.0),
        ("Poisson's ratio of the lining", "shoe.lining.material.nu", POISSON, 1.0),
        ("lining width / thickness", "shoe.lining.width", WIDTHS, thickness),
        ("lining modulus [MPa]", "shoe.lining.material.E", MODULI, 1e6),
    ):
        say(name)
        points = []
        for value in values[:: setting.every]:
            changed = vary(brake, {key: unit * value})
            three = rows.solve_by_solid_and_plane_stress(changed)
            points.append((value, rows.plane_stress_error_rows_of_shoes(three)))
        curves[name] = points
    return curves


def post_brake_on_rigid_drum() -> Brake:
    """The mine winder's post brake on a rigid drum, with a beam of full section.

    The width of the beam gives it the bending stiffness of the real beam.
    """
    brake = read_brake(HERE.parent / "post_brake" / "brake.toml")
    body = brake.shoes[0].body
    assert isinstance(body, BeamBody) and body.section is not None
    changes = {
        "drum.ring": None,
        "shoe.body.bending_stiffness": None,
        "shoe.body.width": body.section.width,
    }
    return vary(brake, changes)


def report(result: Result, folder: Path) -> Path:
    """Write page, figures, tables and fields, and return the path of the page."""
    # These pictures are kept with the repository, and each has a version for a column.
    for name, draw in {
        "limits": partial(draw_plane_stress_limits, result.limits, result.marked),
        "map": partial(figures.draw_error_maps, result.maps),
        "face": partial(figures.draw_face_pressures, result.three, result.worn),
        "ladder": partial(figures.draw_error_over_time, result.ladder),
    }.items():
        drawing.save_figure_for_page_and_column(draw, folder / name)
    drawing.save_figure(figures.draw_error_curves(result.curves), folder / "curves.svg")
    drawing.save_figure(figures.draw_unevenness_over_distance(result.worn), folder / "worn.svg")
    brake, response = result.three.brake, result.three.solid
    write_fields_to_vtu_file(
        folder / "solid.vtu",
        recover_stresses_in_half_of_each_solid_shoe(result.scene, brake, response),
    )
    not_drawn = draw_solid_shoes_and_return_failure_reason(
        folder / "solid.vtu", folder / "solid.png", brake
    )
    write_text(folder / "errors.csv", table_as_csv_text(result.table))
    write_text(folder / "limits.csv", table_as_csv_text(result.limits))
    rungs = [
        {"brake": name} | rung._asdict()
        for name, ladder in result.ladder.items()
        for rung in ladder
    ]
    write_text(folder / "ladder.csv", table_as_csv_text(rungs))
    points = []
    for chart in result.maps:
        for j, y in enumerate(chart.y):
            for i, x in enumerate(chart.x):
                points.append(
                    {
                        "map": chart.name,
                        "x": x,
                        "y": y,
                        **{key: float(values[j, i]) for key, values in chart.errors.items()},
                    }
                )
    write_text(folder / "maps.csv", table_as_csv_text(points))
    largest = {}
    for key in rows.WIDTH_ERROR_NAMES_BY_ROW_KEY:
        largest[key] = max(float(np.abs(chart.errors[key]).max()) for chart in result.maps)
    return write_html_page(
        HERE / "page.html",
        folder / "index.html",
        result=result,
        not_drawn=not_drawn,
        ranges=[each._asdict() for each in parameter_ranges_within_error_limits(result.limits)],
        within=partial(_share_within, result.maps),
        largest=largest,
        shares=rows.rows_of_shares_within_error_limits(result.maps),
        sentence=rows.sentences_on_maps_of_plane_stress_errors(result.maps),
        along=rows.sentences_on_largest_plane_stress_errors(result.curves),
    )


def _share_within(
    maps: tuple[PlaneStressErrorMap, PlaneStressErrorMap], limit: float, key: str
) -> float:
    """Fraction of all brakes of the maps whose error is within a limit."""
    return float(np.mean([np.mean(np.abs(chart.errors[key]) <= limit) for chart in maps]))
