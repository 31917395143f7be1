"""Run time and two errors of all models: against solid shoes, and against plane stress.

A plane model can be exact for plane stress and still miss the real shoe, whose pressure varies over
its width. Each row therefore has two errors: against the solid truth, and against the truth in
plane stress. The solid truth is a solution by functions across the width that are graded to the
sides of all parts. The truth in plane stress is the solution on the level
LEVEL_NUMBER_OF_PLANE_STRESS_TRUTH.
"""

import math
import time
from collections.abc import Callable
from functools import partial
from statistics import median
from typing import NamedTuple

from drumlin.base.errors import DrumlinError
from drumlin.brake.brake import Brake
from drumlin.fem.error_control.adapt import TolerancesOfPressureAndTorque
from drumlin.fem.error_control.levels import (
    REFINEMENT_LEVELS_FROM_COARSE_TO_FINE,
    solve_brake_on_finer_and_finer_mesh_levels,
)
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.width.error import relative_distance_of_plane_stress_from_width_solution
from drumlin.fem.width.ladder import (
    solve_brake_with_widths_to_tolerance,
    solve_cross_section_mesh_with_width_degree,
)
from drumlin.models import model_with_name_that_applies_to_brake, reasons_why_models_do_not_apply
from drumlin.peers.solid_deck import solve_solid_by_calculix
from drumlin.response.response import Response
from drumlin_studies.solid_error import (
    DEGREE_OF_POLYNOMIAL_PIECES_ACROSS_TRUTH_WIDTH,
    response_with_fine_pieces_across_width,
)
from drumlin_studies.work_precision import LEAST_SECONDS_OF_ONE_REPEAT

LEVEL_NUMBER_OF_PLANE_STRESS_TRUTH = 5
"""Number of the refinement level on which the truth in plane stress is solved. Compared solves use
coarser levels.
"""
LONGEST_SECONDS_OF_REPEATED_SOLVE = 1.0
"""Processor time [s] of a solve up to which the solve is repeated; the median time counts."""
NUMBER_OF_TIMED_REPEATS_OF_FAST_SOLVE = 3
"""Number of timed repeats of a fast solve, after a first solve that is not counted."""


class FineSolidSolutionWithUncertainty(NamedTuple):
    """A fine solution with solid shoes that serves as the truth, and its uncertainty.

    Attributes
    ----------
    level : int
        Number of the refinement level in the plane of the drum on which `response` is solved.
    response : Response
        The response that serves as the truth.
    lower : Response
        The response on the same level with one degree less across the width.
    coarser : Response
        The response with one degree less across the width on the next coarser level.
    """

    level: int
    response: Response
    lower: Response
    coarser: Response


class RunTimeAndErrorsOfModelOnBrake(NamedTuple):
    """The run time of a model on a brake, and its two errors.

    Attributes
    ----------
    family : str
        The kind of model; rows of one family make one curve.
    name : str
        The setting, for example the refinement level.
    seconds : float
        Processor time of a cold solve [s]; for CalculiX the time that it reports.
    solid_torque, solid_pressure : float
        Relative errors of the torque and of the mean pressure (L2) against solid shoes.
    plane_torque, plane_pressure : float
        The same errors against plane stress.
    """

    family: str
    name: str
    seconds: float
    solid_torque: float
    solid_pressure: float
    plane_torque: float
    plane_pressure: float


class ModelWithFunctionToTime(NamedTuple):
    """A model with its setting, and a function without arguments that solves the brake by it."""

    family: str
    name: str
    solve: Callable[[], Response]


class SettingsOfSolidComparisonSolves(NamedTuple):
    """The settings of the solves that are compared.

    Attributes
    ----------
    truth : int
        Number of the refinement level of the solid truth. It is at least 2, because the next
        coarser level is solved as well.
    levels : int
        Number of refinement levels of plane stress and of each degree across the width.
    degrees : tuple of int
        Degrees across the width.
    tolerances : tuple of float
        Tolerances of solves that state their errors.
    elements : tuple of int
        Numbers of elements along each lining in solves by CalculiX.
    """

    truth: int
    levels: int
    degrees: tuple[int, ...]
    tolerances: tuple[float, ...]
    elements: tuple[int, ...]


def solve_fine_reference_of_solid_shoes(
    brake: Brake, level: int
) -> FineSolidSolutionWithUncertainty:
    """The solid truth of a brake on a refinement level, and responses that show its uncertainty.

    level : number of the level, at least 2, because the next coarser level is solved as well.
    """
    fine, coarse = (
        REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[level - 1],
        REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[level - 2],
    )
    return FineSolidSolutionWithUncertainty(
        level,
        response_with_fine_pieces_across_width(brake, fine),
        response_with_fine_pieces_across_width(
            brake, fine, DEGREE_OF_POLYNOMIAL_PIECES_ACROSS_TRUTH_WIDTH - 1
        ),
        response_with_fine_pieces_across_width(
            brake, coarse, DEGREE_OF_POLYNOMIAL_PIECES_ACROSS_TRUTH_WIDTH - 1
        ),
    )


def relative_uncertainty_of_solid_shoe_reference(
    brake: Brake, truth: FineSolidSolutionWithUncertainty
) -> dict[str, float]:
    """The relative uncertainty of the torque and the mean pressure of a solid truth.

    The uncertainty is a sum of two distances: between the answers with two degrees across the width
    on the same level, and between the answers on two levels with the lower degree.
    """
    by_degree = relative_distance_of_plane_stress_from_width_solution(
        brake, truth.lower, truth.response
    ).brake
    by_level = relative_distance_of_plane_stress_from_width_solution(
        brake, truth.coarser, truth.lower
    ).brake
    return {name: by_degree[name] + by_level[name] for name in ("torque", "pressure")}


def list_models_compared_with_solid_shoes(
    brake: Brake, setting: SettingsOfSolidComparisonSolves
) -> list[ModelWithFunctionToTime]:
    """The models that apply to a brake, from the laws to solid shoes with stated errors."""
    models = []
    refused = reasons_why_models_do_not_apply(brake)
    for law in ("sine", "cosine", "uniform"):
        if law not in refused:
            answer = partial(model_with_name_that_applies_to_brake(law, brake).solve, brake)
            models.append(ModelWithFunctionToTime("law", law, answer))
    if "foundation" not in refused:
        foundation = model_with_name_that_applies_to_brake("foundation", brake).solve
        models.append(
            ModelWithFunctionToTime(
                "foundation", "lifted", partial(foundation, brake, lift=["all"])
            )
        )
    for degree in (0, *setting.degrees):
        for number in range(1, setting.levels + 1):
            answer = partial(_solve_mesh_level_with_degree_across_width, brake, number, degree)
            models.append(ModelWithFunctionToTime(f"degree {degree}", f"level {number}", answer))
    for tolerance in setting.tolerances:
        models.append(
            ModelWithFunctionToTime(
                "error stated",
                f"to {tolerance:.2g}",
                partial(
                    solve_brake_with_widths_to_tolerance,
                    brake,
                    TolerancesOfPressureAndTorque(tolerance, tolerance),
                ),
            )
        )
    return models


def _solve_mesh_level_with_degree_across_width(brake: Brake, number: int, degree: int) -> Response:
    """The response of a brake with a degree across the width, on one refinement level.

    Degree 0 is plane stress. Solves with other degrees start from the contact in the answer of
    plane stress on the first level.

    Parameters
    ----------
    brake : the brake
    number : number of the level, from 1
    degree : degree across the width
    """
    levels = (
        REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[:1]
        if degree or number == 1
        else (
            REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0],
            REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[number - 1],
        )
    )
    *_, solved = solve_brake_on_finer_and_finer_mesh_levels(
        brake, solve_prepared_model, levels=levels
    )
    if degree == 0:
        return solved.response
    return solve_cross_section_mesh_with_width_degree(
        brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[number - 1], degree, solved.response
    ).response


def measure_models_against_solid_shoes(
    brake: Brake,
    setting: SettingsOfSolidComparisonSolves,
    solid: Response,
    say: Callable[[str], None] = lambda _: None,
) -> list[RunTimeAndErrorsOfModelOnBrake]:
    """A row for each model on a brake: run time, errors against solid truth and plane truth.

    The last rows are solves of solid shoes by CalculiX. Models without an answer have no row.

    Parameters
    ----------
    brake : the brake
    setting : the solves that are made
    solid : response of the solid truth
    say : is called with a line of text on the progress
    """
    plane = _solve_mesh_level_with_degree_across_width(brake, LEVEL_NUMBER_OF_PLANE_STRESS_TRUTH, 0)
    rows = []
    for model in list_models_compared_with_solid_shoes(brake, setting):
        say(f"{model.family}, {model.name}")
        try:
            timed = solve_and_measure_processor_time(model.solve)
        except DrumlinError:
            continue
        rows.append(_row_of_timed_response(brake, model, timed, (solid, plane)))
    for elements in setting.elements:
        say(f"CalculiX, {elements} elements")
        peer = solve_solid_by_calculix(brake, elements=elements)
        model = ModelWithFunctionToTime("CalculiX", f"{elements} elements", lambda: solid)
        timed = TimedResponse(peer.response, peer.seconds)
        rows.append(_row_of_timed_response(brake, model, timed, (solid, plane)))
    return rows


class TimedResponse(NamedTuple):
    """A response, and the processor time [s] of its solve."""

    response: Response
    seconds: float


def solve_and_measure_processor_time(solve_once: Callable[[], Response]) -> TimedResponse:
    """The response of a solve, with its processor time.

    The time of a solve that takes at most LONGEST_SECONDS_OF_REPEATED_SOLVE is the median of
    NUMBER_OF_TIMED_REPEATS_OF_FAST_SOLVE repeats.
    """
    start = time.process_time()
    response = solve_once()
    first = time.process_time() - start
    if first > LONGEST_SECONDS_OF_REPEATED_SOLVE:
        return TimedResponse(response, first)
    loops = max(1, math.ceil(LEAST_SECONDS_OF_ONE_REPEAT / max(first, 1e-6)))
    samples = []
    for _ in range(NUMBER_OF_TIMED_REPEATS_OF_FAST_SOLVE):
        start = time.process_time()
        for _ in range(loops):
            solve_once()
        samples.append((time.process_time() - start) / loops)
    return TimedResponse(response, median(samples))


def _row_of_timed_response(
    brake: Brake,
    model: ModelWithFunctionToTime,
    timed: TimedResponse,
    truths: tuple[Response, Response],
) -> RunTimeAndErrorsOfModelOnBrake:
    """The row of run time and errors of a model, from its timed response.

    `truths` are the solid truth and the truth in plane stress.
    """
    errors: list[float] = []
    for truth in truths:
        true = relative_distance_of_plane_stress_from_width_solution(
            brake, timed.response, truth
        ).brake
        errors += [true["torque"], true["pressure"]]
    return RunTimeAndErrorsOfModelOnBrake(model.family, model.name, timed.seconds, *errors)
