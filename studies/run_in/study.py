"""When are the rigid-shoe laws right? Every brake runs in from new until it is at its law."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from studies.run_in import figures
from studies.run_in.film import write_film

from drumlin.base.errors import BadInput
from drumlin.base.files import write_text
from drumlin.brake.brake import Brake
from drumlin.brake.file import read_brake
from drumlin.brake.plane_brake import read_drum_or_plane_brake
from drumlin.comparison import table_as_csv_text
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.lining_wear.linings import wear_setup_by_finite_elements
from drumlin.lining_wear.run_in import (
    reason_why_wear_never_settles,
    relative_differences_from_end_of_wear,
)
from drumlin.report import figures as drawing
from drumlin.report.page import write_html_page
from drumlin_studies import run_in_limits as limits
from drumlin_studies.run_in_limits import (
    AnimationFrameOfWearRun,
    LastStateOfEqualWearSteps,
    WearRunUntilPressureSettles,
    WearWithRegularDrumReversals,
)
from drumlin_studies.tables import (
    rows_that_have_value_of_key,
    rows_with_given_values,
    values_of_key_in_rows,
)

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
MAIN = ROOT / "studies" / "double_shoe" / "brake.toml"
FLEXIBLE = ROOT / "studies" / "double_shoe" / "flexible.toml"
SHORT = {"laws/block", "laws/pivoted_block", "double_shoe/brake"}
"""The brakes that a trial run of this study (option --short) runs in."""
RATIOS = (1e-4, 1e-3, 1e-2, 1e-1)
"""Young's modulus of the lining over that of the shoe."""
EXPONENTS = (0.5, 1.0, 1.5, 2.0, 3.0)
"""Exponents m of wear laws in which the wear is proportional to p^m."""
CURVES = {
    "stiff": (0.0, 0.3, 3.0, 10.0, 30.0),
    "flexible": (0.0, 3.0, 30.0, 100.0, 300.0),
}
"""Sliding distances at which pressures are drawn [1/(k K)], for stiff and for flexible shoes."""
OPEN_CURVES = (0.003, 0.03, 0.2)
"""Sliding distances, relative to that of the whole run, of one figure's pressures.

The figure shows the brake whose lining touches the drum least when new.
"""
REVERSALS = (10.0, 50.0, 250.0)
"""Sliding distances between two reversals of the drum [1/(k K)]."""
END, STEPS = 3.0, (0.05, 0.5)
"""Sliding distance and sizes of equal steps [1/(k K)]."""
FAR = 0.01
"""Relative difference of the torque from the law above which a new brake is far from its law."""


@dataclass(frozen=True)
class Result:
    """All results that the report of this study shows.

    The rows of the tables come from the module `run_in_limits`.
    """

    main: WearRunUntilPressureSettles
    flexible: WearRunUntilPressureSettles
    runs: list[WearRunUntilPressureSettles]
    brakes: list[dict[str, Any]]
    ratios: list[dict[str, Any]]
    halves: list[dict[str, Any]]
    exponents: list[dict[str, Any]]
    held: WearRunUntilPressureSettles
    reversals: list[WearWithRegularDrumReversals]
    steps: list[dict[str, Any]]
    boards: list[LastStateOfEqualWearSteps]
    frames: list[AnimationFrameOfWearRun]
    skipped: list[str]
    seconds: float


def study(*, short: bool = False, say: Callable[[str], None] = lambda _: None) -> Result:
    """Run in every brake, and the main brake with further ratios of stiffness and wear laws.

    short : trial run with few brakes on coarse meshes.
    """
    start = time.perf_counter()
    elements = 30 if short else 80
    runs, brakes = list[WearRunUntilPressureSettles](), list[dict[str, Any]]()
    found, skipped = brakes_that_run_in(short=short)
    for name, model, brake in found:
        say(f"{name}, {model}")
        row, one = limits.table_row_and_wear_run_of_brake(name, model, brake, elements)
        brakes.append(row)
        runs += [one] if one else []
    # The main brake on one mesh, with stiff and with flexible shoes.
    say("the main brake")
    brake = read_brake(MAIN)
    scene = make_prepared_model(brake, elements=elements)
    setup = wear_setup_by_finite_elements(scene, brake)
    main = limits.wear_brake_until_pressure_settles("stiff shoes", setup)
    soft = read_brake(FLEXIBLE)
    flexible = limits.wear_brake_until_pressure_settles(
        "flexible shoes",
        wear_setup_by_finite_elements(make_prepared_model(soft, elements=elements), soft),
    )
    say("linings from soft to stiff")
    ratios = []
    for ratio in RATIOS[1::2] if short else RATIOS:
        ratios.append(limits.table_row_of_run_in_at_modulus_ratio(brake, ratio, elements))
    # A run with steps of half the size shows the error of the steps.
    say("half the step, twice the way")
    halves = [limits.row_comparing_run_with_halved_wear_steps(one) for one in (main, flexible)]
    say("exponents")
    exponents = []
    for m in (2.0,) if short else EXPONENTS:
        exponents.append(limits.table_row_of_run_in_at_pressure_exponent(setup, m))
    # The actuation follows the friction so that the torque stays.
    say("held torque")
    held = limits.wear_brake_until_pressure_settles("held torque", setup, torque=main.goal.torque)
    reversals = []
    for every in REVERSALS[:1] if short else REVERSALS:
        say(f"reversed every {every:g}")
        reversals.append(
            limits.wear_brake_with_drum_reversals(scene, brake, every, 3 if short else 8)
        )
    # Implicit and explicit steps of equal sizes.
    say("steps")
    steps, boards = limits.rows_and_last_states_of_wear_runs_in_equal_steps(main, END, STEPS)
    say("film")
    frames = limits.animation_frames_of_run(scene, main, 6 if short else 40)
    return Result(
        main,
        flexible,
        runs,
        brakes,
        ratios,
        halves,
        exponents,
        held,
        reversals,
        steps,
        boards,
        frames,
        skipped,
        time.perf_counter() - start,
    )


def brakes_that_run_in(*, short: bool) -> tuple[list[tuple[str, str, Brake]], list[str]]:
    """Name, model and brake for every file that can run in; a reason for every other file."""
    found, skipped = list[tuple[str, str, Brake]](), list[str]()
    for path in sorted([*(ROOT / "studies").glob("*/*.toml"), *(ROOT / "meshes").glob("*.toml")]):
        name = f"{path.parent.name}/{path.stem}"
        if short and name not in SHORT:
            continue
        try:
            brake = read_drum_or_plane_brake(path)
        except BadInput:
            # The file is no brake.
            continue
        if brake.surface.is_plane_and_not_drum:
            skipped.append(f"{name}: shoes on a plane are not modelled elastically")
            continue
        never = reason_why_wear_never_settles(brake)
        if never is not None:
            skipped.append(f"{name}: {never}")
            continue
        ways, reason = limits.list_wear_models_and_reason_against_finite_elements(brake)
        for how, model, varied in ways:
            found.append((name + how, model, varied))
        skipped += [f"{name}: {reason}"] if reason else []
    return found, skipped


def report(result: Result, folder: Path) -> Path:
    """Write page, figures, film and tables, and return the path of the page."""
    for name, rows in {
        "brakes": result.brakes,
        "ratios": result.ratios,
        "halves": result.halves,
        "exponents": result.exponents,
        "steppers": result.steps,
    }.items():
        write_text(folder / f"{name}.csv", table_as_csv_text(rows))
    reversal = result.reversals[min(1, len(result.reversals) - 1)]
    least = limits.wear_run_whose_new_linings_touch_least([result.main, *result.runs])
    draw_figures(result, least, reversal, folder)
    lives = []
    for row in result.brakes:
        if "life" in row:
            lives.append(row)
    far = []
    for row in lives:
        if abs(row["new_torque"]) > FAR:
            far.append(row)
    reversals = []
    for one in result.reversals:
        reversals.append(one.row_of_wear_run_with_drum_reversals)
    return write_html_page(
        HERE / "page.html",
        folder / "index.html",
        result=result,
        stiff=limits.table_row_of_wear_run_until_settled(result.main),
        soft=limits.table_row_of_wear_run_until_settled(result.flexible),
        met=len(rows_with_given_values(result.brakes, status=limits.STATUS_OF_RUN_ENDING_AT_LAW)),
        within=(limits.PRESSURE_AT_LAW, limits.TORQUE_AT_LAW),
        least=least,
        far=far,
        volume=max(
            values_of_key_in_rows(rows_that_have_value_of_key(result.brakes, "volume"), "volume")
        ),
        reversal=reversal.row_of_wear_run_with_drum_reversals,
        reversals=reversals,
    )


def draw_figures(
    result: Result,
    least: WearRunUntilPressureSettles,
    reversal: WearWithRegularDrumReversals,
    folder: Path,
) -> None:
    """Write the figures and the film.

    Parameters
    ----------
    result : Result
        Everything that the report shows.
    least : WearRunUntilPressureSettles
        The brake with the smallest contact when new.
    reversal : WearWithRegularDrumReversals
        The run with reversals that is drawn.
    folder : Path
        Folder of the report.
    """
    main = result.main
    for key, one in (("stiff", main), ("flexible", result.flexible)):
        drawing.save_figure_for_page_and_column(
            partial(figures.draw_pressures_over_distance, one, CURVES[key]),
            folder / f"pressure_{key}",
        )
    marks = []
    for part in OPEN_CURVES:
        marks.append(float(f"{least.sliding_distances_of_run_states()[-1] * part:.1g}"))
    far = [
        one
        for one in result.runs
        if abs(relative_differences_from_end_of_wear(one.setup, one.states[0], one.goal).torque)
        > FAR
    ]
    made = {
        "profiles": figures.draw_worn_profiles(least, marks),
        "pressure_open": figures.draw_pressures_over_distance(least, [0.0, *marks]),
        "torque": figures.draw_torques_over_distance(far or [main]),
        "held": figures.draw_held_force(result.held),
        "reversal": figures.draw_reversals(main, reversal),
        "checkerboard": figures.draw_checkerboards(main.setup.surfaces[0], result.boards),
    }
    for name, figure in made.items():
        drawing.save_figure(figure, folder / f"{name}.svg")
    write_film(main, result.frames, folder / "film.gif")
