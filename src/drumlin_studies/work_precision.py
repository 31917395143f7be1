"""Errors and run times of every method that solves a brake.

The methods are laws, the foundation model, finite elements, penalty contact as in textbooks, and
peers, which are other finite element programs. A method is plain data (a family, a name and
options), so that it can be a key in a journal and be sent to another process. The errors are
differences of the method's response from a reference. The time is processor time, the median of
several repeats. A fixed piece of work, the unit, is timed just before each repeat. The ratio of a
repeat's time to the unit's time hardly depends on the speed of the machine.
"""

import math
import multiprocessing
import subprocess
import sys
import time
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import ProcessPoolExecutor
from functools import cache, partial
from pathlib import Path
from statistics import median, quantiles
from typing import Any, NamedTuple

import numpy as np

from drumlin import peers
from drumlin.base.errors import BadInput, DrumlinError
from drumlin.base.resource_use import peak_memory_of_process
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.file import vary
from drumlin.fem.error_control.adapt import (
    DEFAULT_TOLERANCES_OF_PRESSURE_AND_TORQUE,
    TolerancesOfPressureAndTorque,
    solve_brake_to_tolerance,
)
from drumlin.fem.error_control.levels import (
    REFINEMENT_LEVELS_FROM_COARSE_TO_FINE,
    solve_brake_on_finer_and_finer_mesh_levels,
)
from drumlin.fem.mesh.arc import DEFAULT_MESH_KIND, parametric_mesh_of_shoe
from drumlin.fem.mesh.grading import (
    RELATIVE_SIZE_OF_LINING_END_ELEMENT,
    LiningDivision,
    integral_of_inverse_graded_step,
    number_of_element_layers_in_lining,
    points_graded_to_both_ends,
)
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.models import model_with_name_that_applies_to_brake
from drumlin.response.norms import (
    relative_distance_of_pressures,
    relative_distance_of_vectors,
    relative_error_of_number,
)
from drumlin.response.response import Response, length_of_edge_zone_left_out_of_peak_search
from drumlin.verification.reference import (
    ResponsesBehindReferenceValues,
    peak_pressure_between_edge_zones,
)
from drumlin_studies import pointwise

LEAST_REPEATS_OF_TIMING = 5
"""Smallest number of repeats of a timing."""
MOST_REPEATS_OF_TIMING = 9
"""Largest number of repeats of a timing."""
LEAST_TOTAL_SECONDS_OF_TIMING = 0.1
"""Total time [s] that all repeats of a timing must reach. After MOST_REPEATS_OF_TIMING the timing
ends with less.
"""
LEAST_SECONDS_OF_ONE_REPEAT = 2e-3
"""Shortest time [s] of one repeat of a timing. If a call takes less, a repeat has several calls."""
TIME_RATIO_OF_EQUALLY_FAST_METHODS = 1.2
"""Ratio of the times of two methods up to which both count as equally fast."""
FRICTION_OF_FURTHER_OVER_FIRST_LOAD_CASE = 0.9
"""Coefficient of friction of the further load case, divided by the coefficient of the first load
case.
"""
MOST_ELEMENTS_PER_LINING_OF_WEAK_GRADING = 36
"""Number of elements along a lining above which its mesh is graded more strongly to its ends.

Above this number the size of the smallest elements at the lining's ends falls in inverse proportion
to the number, so that the error goes on falling where the pressure is singular.
"""
LEAST_ELEMENT_LAYERS_BEHIND_LINING = 4
"""Smallest number of element layers through backing and body of `mesh_graded_to_lining_ends`.

With these layers the mesh of backing and body causes less error than the mesh of the lining, whose
refinement is studied.
"""
ROW_KEYS_OF_RELATIVE_ERRORS = ("torque_error", "peak_error", "pressure_error", "reaction_error")
"""Keys of a row that hold relative errors: of torque, peak pressure, pressure, hinge reaction."""


class SolutionMethodOfBrake(NamedTuple):
    """A method to solve a brake: a law, a model, a mesh with its options, or another program.

    Attributes
    ----------
    family : str
        Group of similar methods, a key of COLD_SOLVE_FUNCTIONS_BY_METHOD_FAMILY or
        PEER_KEYS_BY_NAME_IN_TABLES.
    name : str
        Name of the method in tables.
    options : mapping
        Keyword arguments of the family's solver, plain data.
    """

    family: str
    name: str
    options: Mapping[str, Any] = {}

    @property
    def journal_key_of_solve_method(self) -> dict[str, Any]:
        """The method as plain data, under which a journal stores its row."""
        return {"family": self.family, "method": self.name, **self.options}


class ResultOfColdSolve(NamedTuple):
    """The result of a cold solve, which starts from the brake without any prepared model.

    Attributes
    ----------
    response : Response
        The response of the brake.
    further : function
        Returns the response to the further load case, with other friction. If the method has a
        prepared model, the function reuses the prepared model of the cold solve.
    unknowns : function, optional
        Returns the number of unknowns of the method's equations.
    """

    response: Response
    further: Callable[[], Response]
    unknowns: Callable[[], int] | None = None


def _brake_of_further_load_case(brake: Brake) -> Brake:
    """The brake in the further load case: it has another friction coefficient."""
    return vary(brake, {"friction": FRICTION_OF_FURTHER_OVER_FIRST_LOAD_CASE * brake.friction})


def _cold_solve_by_law_or_foundation(
    brake: Brake, *, model: str, **options: Any
) -> ResultOfColdSolve:
    """The cold solve of a brake by a law or by the foundation model.

    model : name of the law or model; **options : options of its solver.
    """
    solver = model_with_name_that_applies_to_brake(model, brake).solve
    further = partial(solver, _brake_of_further_load_case(brake), **options)
    return ResultOfColdSolve(solver(brake, **options), further)


def mesh_with_equal_elements_on_lining(shoe: Shoe, radius: float, elements: int, kind: str) -> Any:
    """The mesh of a shoe with elements of equal length along the lining.

    radius : radius of the drum [m]; elements : number of elements along the lining; kind : kind of
        the elements.
    """
    depths = np.linspace(0, shoe.lining.thickness, number_of_element_layers_in_lining(elements) + 1)
    step = (shoe.arc[1] - shoe.arc[0]) / elements
    division = LiningDivision(np.linspace(*shoe.arc, elements + 1), depths, step)
    return parametric_mesh_of_shoe(shoe, radius, division, kind)


def mesh_graded_to_lining_ends(
    shoe: Shoe, radius: float, elements: int, layers: int, kind: str
) -> Any:
    """The mesh of a shoe that is graded to the ends of its lining.

    See `divide_lining_graded_to_its_ends`.

    Parameters
    ----------
    shoe : Shoe
        The shoe.
    radius : float
        Radius of the drum [m].
    elements : int
        Smallest number of elements along the lining.
    layers : int
        Elements through the lining.
    kind : str
        Kind of the elements.
    """
    return parametric_mesh_of_shoe(
        shoe, radius, divide_lining_graded_to_its_ends(shoe, radius, elements, layers), kind
    )


def divide_lining_graded_to_its_ends(
    shoe: Shoe, radius: float, elements: int, layers: int
) -> LiningDivision:
    """The division of a shoe's lining into elements that become smaller towards its ends.

    No element is longer than 1/`elements` of the lining. The smallest elements at the ends have a
    fixed size up to MOST_ELEMENTS_PER_LINING_OF_WEAK_GRADING elements, and above it a size
    proportional to 1/`elements`.

    Parameters
    ----------
    shoe : Shoe
        The shoe.
    radius : float
        Radius of the drum [m].
    elements : int
        Smallest number of elements along the lining.
    layers : int
        Elements through the lining.
    """
    (start, end), zone = shoe.arc, shoe.lining.thickness / radius
    # The number of inner elements follows from the longest allowed element and from the grading.
    fineness = max(1.0, elements / MOST_ELEMENTS_PER_LINING_OF_WEAK_GRADING)
    half, smallest = (end - start) / 2, RELATIVE_SIZE_OF_LINING_END_ELEMENT / fineness
    step = (end - start) / elements
    count = max(
        2, math.ceil(2 * integral_of_inverse_graded_step(half, half, zone, smallest) / step)
    )
    return LiningDivision(
        angles=points_graded_to_both_ends(start, end, count, zone, smallest),
        depths=points_graded_to_both_ends(
            0, shoe.lining.thickness, layers, shoe.lining.thickness / 2, smallest
        ),
        step=step,
        behind=LEAST_ELEMENT_LAYERS_BEHIND_LINING,
    )


def _cold_solve_on_mesh(
    brake: Brake,
    *,
    elements: int,
    kind: str = DEFAULT_MESH_KIND,
    even: bool = False,
    penalty: float = math.inf,
) -> ResultOfColdSolve:
    """The cold solve of a brake by finite elements on one mesh. It includes making the mesh.

    Parameters
    ----------
    brake : Brake
        The brake.
    elements : int
        Elements along each lining.
    kind : str
        Kind of the elements.
    even : bool
        Whether the elements have equal length. If not, they shrink towards the lining's ends.
    penalty : float
        Penalty factor of the contact; inf for exact contact.
    """
    mesher = (
        partial(mesh_with_equal_elements_on_lining, elements=elements, kind=kind) if even else None
    )
    scene = make_prepared_model(brake, elements=elements, kind=kind, mesher=mesher)
    return _cold_solve_of_prepared_model(
        brake, scene, solve_prepared_model(scene, brake, penalty=penalty), penalty
    )


def _cold_solve_of_prepared_model(
    brake: Brake, scene: PreparedModel, response: Response, penalty: float
) -> ResultOfColdSolve:
    """The `ResultOfColdSolve` of a brake from its prepared model and its response.

    Its function `further` solves the further load case on the same prepared model.

    scene : the prepared model; response : its response; penalty : penalty factor of the contact.
    """

    def solve_further_load_case() -> Response:
        """The response to the further load case on the prepared model."""
        return solve_prepared_model(scene, _brake_of_further_load_case(brake), penalty=penalty)

    return ResultOfColdSolve(
        response, solve_further_load_case, partial(_count_unknowns_of_prepared_model, scene)
    )


def _count_unknowns_of_prepared_model(scene: PreparedModel) -> int:
    """The number of unknowns of a prepared model: of its bodies and of the drum ring.

    Shoes of equal shape share one body, which is counted once.
    """
    bodies = {id(body): body for body in scene.bodies}.values()
    of_bodies = sum(body.unknowns for body in bodies)
    of_ring = 0 if scene.ring is None else int(2 * scene.ring.basis.N)
    return of_bodies + of_ring


def _cold_solve_on_hp_level(brake: Brake, *, level: int) -> ResultOfColdSolve:
    """The cold solve of a brake by hp elements on one level of refinement, without error estimate.

    `level` counts from 0, the coarsest level, which is solved first. Its response has the ends of
    the contact, to which the elements of level `level` are graded.
    """
    levels = (
        REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0],
        REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[level],
    )[-level - 1 :]
    *_, (scene, response) = solve_brake_on_finer_and_finer_mesh_levels(
        brake, partial(solve_prepared_model, penalty=math.inf), levels=levels
    )
    return _cold_solve_of_prepared_model(brake, scene, response, math.inf)


def _cold_solve_to_tolerance(brake: Brake, *, tolerance: float) -> ResultOfColdSolve:
    """The cold solve of a brake by hp elements that are refined to an estimated error.

    tolerance : largest relative error of the pressure. The tolerance of the torque is the smaller
    of `tolerance` and its default.
    """
    allowed = TolerancesOfPressureAndTorque(
        tolerance, min(tolerance, DEFAULT_TOLERANCES_OF_PRESSURE_AND_TORQUE.torque)
    )
    scene, response = solve_brake_to_tolerance(
        brake, allowed, partial(solve_prepared_model, penalty=math.inf)
    )
    return _cold_solve_of_prepared_model(brake, scene, response, math.inf)


def _cold_solve_by_pointwise_penalty(
    brake: Brake, *, elements: int, penalty: float
) -> ResultOfColdSolve:
    """The cold solve of a brake by the pointwise penalty, the contact method of textbooks.

    elements : number of elements along each lining; penalty : penalty factor.
    """
    solver = partial(pointwise.solve_by_pointwise_penalty, elements=elements, penalty=penalty)

    def count_unknowns_of_mesh() -> int:
        """The number of unknowns of the mesh."""
        return _count_unknowns_of_prepared_model(make_prepared_model(brake, elements=elements))

    def solve_further_case_anew() -> Response:
        """The response to the further load case, solved anew without results of the first solve."""
        return solver(_brake_of_further_load_case(brake))

    return ResultOfColdSolve(solver(brake), solve_further_case_anew, count_unknowns_of_mesh)


COLD_SOLVE_FUNCTIONS_BY_METHOD_FAMILY: Mapping[str, Callable[..., ResultOfColdSolve]] = {
    "law": _cold_solve_by_law_or_foundation,
    "foundation": _cold_solve_by_law_or_foundation,
    "even mesh": _cold_solve_on_mesh,
    "graded mesh": _cold_solve_on_mesh,
    "columns": _cold_solve_on_hp_level,
    "columns, error stated": _cold_solve_to_tolerance,
    "weak penalty": _cold_solve_on_mesh,
    "pointwise penalty": _cold_solve_by_pointwise_penalty,
}
"""Function that solves a brake and returns a `ResultOfColdSolve`, for each family of drumlin's
methods.
"""
PEER_KEYS_BY_NAME_IN_TABLES = {
    written: name for name, written in peers.NAMES_OF_PEER_PROGRAMS.items()
}
"""Key of each peer in `drumlin.peers`, by its name in tables, for example "CalculiX"."""


def cold_solve_by_method(brake: Brake, method: SolutionMethodOfBrake) -> ResultOfColdSolve:
    """The cold solve of a brake by one of drumlin's methods, from its data to the response.

    Raises BadInput where the method does not apply to the brake, NoAnswer where it has no answer.
    """
    return COLD_SOLVE_FUNCTIONS_BY_METHOD_FAMILY[method.family](brake, **method.options)


def relative_errors_against_reference(
    brake: Brake, response: Response, truth: Response
) -> dict[str, float]:
    """Relative errors of a response against a far finer response, by ROW_KEYS_OF_RELATIVE_ERRORS.

    The error of the torque belongs to the torque of the whole brake. The other errors are the
    largest of all shoes. Peak and L2 norm of the pressure leave out the edge zones at the lining's
    ends.

    brake : the brake; response : the response that is judged; truth : the far finer response.
    """
    # Errors of each shoe. The torque, the first key, is left out: its error belongs to the whole
    # brake.
    by_key: dict[str, list[float]] = {key: [] for key in ROW_KEYS_OF_RELATIVE_ERRORS[1:]}
    for spec, a, b in zip(brake.shoes, response.shoes, truth.shoes, strict=True):
        edge = length_of_edge_zone_left_out_of_peak_search(
            spec, brake.length_per_surface_coordinate
        )
        by_key["peak_error"].append(
            abs(
                relative_error_of_number(
                    peak_pressure_between_edge_zones(a, edge),
                    peak_pressure_between_edge_zones(b, edge),
                )
            )
        )
        by_key["pressure_error"].append(relative_distance_of_pressures(a, b))
        by_key["reaction_error"].append(
            relative_distance_of_vectors(a.hinge_reaction, b.hinge_reaction)
        )
    result = {"torque_error": abs(relative_error_of_number(response.torque, truth.torque))}
    for key, values in by_key.items():
        # A value is nan for a shoe without force. Such shoes are left out.
        result[key] = max((value for value in values if not math.isnan(value)), default=0.0)
    return result


def relative_uncertainties_of_reference_responses(
    brake: Brake, trio: ResponsesBehindReferenceValues
) -> dict[str, float]:
    """The relative uncertainties of a reference solution, by ROW_KEYS_OF_RELATIVE_ERRORS.

    Errors that are smaller than the uncertainty count as not known.

    A reference consists of its value, which is a response, and of other responses by coarser meshes
    or other methods. The uncertainty is the largest difference between the value and another
    response. The differences of the shoes' torques are summed without their signs, and so cannot
    cancel.
    """
    largest: dict[str, float] = {}
    for other in trio.responses_that_give_uncertainty:
        pairs = zip(trio.value.shoes, other.shoes, strict=True)
        apart = math.fsum(abs(a.torque - b.torque) for a, b in pairs)
        own = relative_errors_against_reference(brake, other, trio.value)
        own["torque_error"] = apart / trio.value.torque if apart else 0.0
        largest = {name: max(value, largest.get(name, 0.0)) for name, value in own.items()}
    return largest


class ProcessorTimeOfCall(NamedTuple):
    """The measured processor time of a call.

    Attributes
    ----------
    seconds, lower, upper : float
        Median, lower and upper quartile of the repeats [s].
    ratio : float
        Median over the repeats of the repeat's time divided by the time of the unit just before it.
    repeats : int
        Number of repeats.
    """

    seconds: float
    lower: float
    upper: float
    ratio: float
    repeats: int


def measure_call_time_over_unit_workload(
    call: Callable[[], object], unit: Callable[[], object], first: float
) -> ProcessorTimeOfCall:
    """The processor time of a call, from several repeats, with the unit timed before each repeat.

    Parameters
    ----------
    call : function
        The function that is timed.
    unit : function
        A fixed piece of work that shows the present speed of the machine.
    first : float
        Time [s] of a first call, from which follows the number of calls in a repeat.
    """
    # A repeat has as many calls as it needs to take at least LEAST_SECONDS_OF_ONE_REPEAT.
    loops = max(1, math.ceil(LEAST_SECONDS_OF_ONE_REPEAT / max(first, 1e-6)))
    samples: list[float] = []
    ratios: list[float] = []

    def needs_another_timing_repeat() -> bool:
        """Whether the total time is too short and MOST_REPEATS_OF_TIMING are not reached."""
        return (
            sum(samples) * loops < LEAST_TOTAL_SECONDS_OF_TIMING
            and len(samples) < MOST_REPEATS_OF_TIMING
        )

    while len(samples) < LEAST_REPEATS_OF_TIMING or needs_another_timing_repeat():
        # The unit is timed just before the call, so that the machine has the same speed for both.
        beside = _processor_time_per_call(unit, 1)
        samples.append(_processor_time_per_call(call, loops))
        ratios.append(samples[-1] / beside)
    quartiles = _quartiles_of_values(samples)
    return ProcessorTimeOfCall(*quartiles, median(ratios), len(samples))


class MedianAndQuartiles(NamedTuple):
    """Median, lower and upper quartile of a list of values."""

    median: float
    lower: float
    upper: float


def _quartiles_of_values(samples: list[float]) -> MedianAndQuartiles:
    """The median and the lower and upper quartile of a list of values."""
    if len(samples) == 1:
        return MedianAndQuartiles(samples[0], samples[0], samples[0])
    lower, middle, upper = quantiles(samples, n=4, method="inclusive")
    return MedianAndQuartiles(middle, lower, upper)


def _processor_time_per_call(call: Callable[[], object], loops: int = 1) -> float:
    """The processor time of one call [s], as the mean over `loops` calls."""
    start = time.process_time()
    for _ in range(loops):
        call()
    return (time.process_time() - start) / loops


def measure_drumlin_method_on_brake(
    brake: Brake, method: SolutionMethodOfBrake, truth: Response, unit: Callable[[], object]
) -> dict[str, Any]:
    """The row of one of drumlin's methods on a brake: errors, times, memory and unknowns.

    Where the method does not apply or has no answer, the `status` of the row gives the reason.

    Parameters
    ----------
    brake : Brake
        The brake to be solved.
    method : SolutionMethodOfBrake
        A method of COLD_SOLVE_FUNCTIONS_BY_METHOD_FAMILY.
    truth : Response
        The reference against which errors are taken.
    unit : function
        The unit of work beside which each repeat is timed.
    """
    row: dict[str, Any] = dict(method.journal_key_of_solve_method)
    start = time.process_time()
    try:
        cold = cold_solve_by_method(brake, method)
    except DrumlinError as error:
        return row | {
            "seconds": time.process_time() - start,
            "status": _status_text_of_refused_or_failed_solve(error),
        }
    first = time.process_time() - start
    row |= relative_errors_against_reference(brake, cold.response, truth)
    row["unknowns"] = None if cold.unknowns is None else cold.unknowns()
    row |= measure_call_time_over_unit_workload(
        partial(cold_solve_by_method, brake, method), unit, first
    )._asdict()
    try:
        further = measure_call_time_over_unit_workload(
            cold.further, unit, _processor_time_per_call(cold.further)
        )
        row |= {"further": further.seconds, "further_ratio": further.ratio}
    except DrumlinError as error:
        row["note"] = f"further load case: {_status_text_of_refused_or_failed_solve(error)}"
    return row | {
        "memory": peak_memory_of_solve_in_new_process(brake, method),
        "status": "converged",
    }


def _status_text_of_refused_or_failed_solve(error: DrumlinError) -> str:
    """The text for the `status` of a row whose method has refused the brake or failed."""
    return f"{'refused' if isinstance(error, BadInput) else 'failed'}: {error}"


def peak_memory_of_solve_in_new_process(brake: Brake, method: SolutionMethodOfBrake) -> float:
    """The peak memory [bytes] of a whole solve by a method, without the loaded program.

    The solve runs in a process of its own.
    """
    with ProcessPoolExecutor(1, mp_context=_multiprocessing_start_context()) as process:
        return process.submit(_peak_memory_growth_by_solve_in_this_process, brake, method).result()


@cache
def _multiprocessing_start_context() -> Any:
    """The multiprocessing context that starts new processes.

    It forks a server process that has only loaded this module. Where the system has no fork server,
    each new process loads the module itself.
    """
    if "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload([__name__])
    return context


def _peak_memory_growth_by_solve_in_this_process(
    brake: Brake, method: SolutionMethodOfBrake
) -> float:
    """The growth of this process's peak memory [bytes] by a whole solve of a brake by a method."""
    before = peak_memory_of_process()
    cold_solve_by_method(brake, method)
    return peak_memory_of_process() - before


def wall_seconds_of_solve_command(
    brake_file: Path, *options: str, repeats: int = LEAST_REPEATS_OF_TIMING
) -> float:
    """The wall time of a whole `drumlin solve` process [s], the median of several processes.

    Parameters
    ----------
    brake_file : Path
        The brake file.
    *options : str
        Further options of the command line.
    repeats : int
        Number of processes.
    """
    command = [
        sys.executable,
        "-c",
        "from drumlin.cli import main; main()",
        "solve",
        str(brake_file),
        *options,
    ]
    samples = []
    for _ in range(repeats):
        start = time.perf_counter()
        subprocess.run(command, check=True, capture_output=True)
        samples.append(time.perf_counter() - start)
    return median(samples)


def measure_peer_program_on_brake(
    brake: Brake,
    method: SolutionMethodOfBrake,
    truth: Response,
    unit: Callable[[], object],
    repeats: int = LEAST_REPEATS_OF_TIMING,
) -> dict[str, Any]:
    """The row of a peer, another finite element program, on a brake: errors, times and unknowns.

    The times are reported by the peer; each is the median over the repeats. The ratios are these
    times divided by the time of the unit of work, which is timed before each repeat.

    Parameters
    ----------
    brake : Brake
        The brake to be solved.
    method : SolutionMethodOfBrake
        A method of PEER_KEYS_BY_NAME_IN_TABLES. The option `even` asks for a uniform mesh, `layers`
        for a `mesh_graded_to_lining_ends`.
    truth : Response
        The reference against which errors are taken.
    unit : function
        The unit of work beside which each repeat is timed.
    repeats : int
        Number of solves.
    """
    row: dict[str, Any] = dict(method.journal_key_of_solve_method)
    options = _solver_arguments_of_peer_method(method)
    start = time.perf_counter()
    solve = partial(
        peers.solve_brake_by_calculix_or_getfem,
        PEER_KEYS_BY_NAME_IN_TABLES[method.family],
        brake,
        **options,
    )
    answers, units = [], []
    try:
        for _ in range(repeats):
            units.append(
                median(_processor_time_per_call(unit) for _ in range(LEAST_REPEATS_OF_TIMING))
            )
            answers.append(solve())
    except DrumlinError as error:
        return row | {
            "seconds": time.perf_counter() - start,
            "status": _status_text_of_refused_or_failed_solve(error),
        }
    pairs = list(zip(answers, units, strict=True))
    quartiles = _quartiles_of_values([answer.seconds for answer in answers])
    errors = relative_errors_against_reference(brake, answers[0].response, truth)
    return {
        **row,
        **errors,
        "seconds": quartiles.median,
        "lower": quartiles.lower,
        "upper": quartiles.upper,
        "repeats": repeats,
        "ratio": median(answer.seconds / pace for answer, pace in pairs),
        "further_ratio": median(answer.further_seconds / pace for answer, pace in pairs),
        "process": median(answer.process_seconds for answer in answers),
        "further": median(answer.further_seconds for answer in answers),
        "unknowns": answers[0].unknowns,
        "version": answers[0].version,
        "status": "converged",
    }


def _solver_arguments_of_peer_method(method: SolutionMethodOfBrake) -> dict[str, Any]:
    """The keyword arguments of `solve_brake_by_calculix_or_getfem` for a method.

    The options `even` and `layers` of the method become a function that meshes a shoe.
    """
    options = dict(method.options)
    even, layers = options.pop("even", False), options.pop("layers", None)
    if even:
        kind = options.get("kind", DEFAULT_MESH_KIND)
        options["mesher"] = partial(
            mesh_with_equal_elements_on_lining, elements=options["elements"], kind=kind
        )
    if layers is not None:
        options["mesher"] = partial(mesh_graded_to_lining_ends, layers=layers, **options)
    return options


def fastest_rows_within_error(
    rows: Iterable[Mapping[str, Any]], key: str, target: float, floors: Mapping[str, float]
) -> list[Any]:
    """The rows of the methods whose error is below a target, fastest first.

    The rows about as fast as the fastest row come first, in the order of their errors. Speeds are
    compared by the times divided by the time of a fixed piece of work. A mesh counts only if the
    errors of all finer meshes with otherwise equal options are below the target as well. Otherwise
    an error that changes its sign between two meshes could be small by chance.

    Parameters
    ----------
    rows : iterable of mappings
        Rows of methods on one brake.
    key : str
        Key of the error, one of ROW_KEYS_OF_RELATIVE_ERRORS.
    target : float
        Largest allowed error. If it is below the uncertainty of the reference, the result is empty.
    floors : mapping
        Uncertainties of the reference by ROW_KEYS_OF_RELATIVE_ERRORS, as from
        `relative_uncertainties_of_reference_responses`.
    """
    if target < floors[key]:
        return []
    enough_rows = []
    for members in converged_rows_by_mesh_series(rows).values():
        # A series has methods that differ in fineness only. In each series only those rows count
        # that are finer than the finest row with an error above the target.
        above = [k for k, row in enumerate(members) if row[key] > target]
        enough_rows += members[above[-1] + 1 if above else 0 :]
    # Rows about as fast as the fastest row are sorted by their errors.
    enough_rows.sort(key=lambda row: row["ratio"])
    ties = [
        row
        for row in enough_rows
        if row["ratio"] <= TIME_RATIO_OF_EQUALLY_FAST_METHODS * enough_rows[0]["ratio"]
    ]
    return sorted(ties, key=lambda row: row[key]) + enough_rows[len(ties) :]


def converged_rows_by_mesh_series(
    rows: Iterable[Mapping[str, Any]],
) -> dict[tuple[str, str], list[Any]]:
    """The rows with an answer in groups, by family and series, from coarse to fine in a group.

    A series has methods of one family that differ in their fineness only.
    """

    def sort_key_from_coarse_to_fine(row: Mapping[str, Any]) -> tuple[float, float]:
        """A key by which coarse rows come first: elements, sections or level, then tolerance."""
        size = row.get("elements") or row.get("sections") or row.get("level") or 0
        return size, -(row.get("tolerance") or 0)

    by_series: dict[tuple[str, str], list[Any]] = {}
    for row in rows:
        if row["status"] == "converged":
            by_series.setdefault((row["family"], mesh_series_name_of_row(row)), []).append(row)
    for members in by_series.values():
        members.sort(key=sort_key_from_coarse_to_fine)
    return by_series


def mesh_series_name_of_row(row: Mapping[str, Any]) -> str:
    """The name of the series of a row. The methods of a series differ in fineness only."""
    if row["family"] == "law":
        return str(row["model"])
    if row["family"] == "foundation":
        return "lifted" if row.get("lift") else "as published"
    if row["family"].startswith("columns"):
        return "columns"
    if "penalty" in row:
        return f"{row.get('kind', DEFAULT_MESH_KIND)}, {row['penalty']:g} E/t"
    graded = ", even" if row.get("even") else ", refined" if row.get("layers") else ""
    return str(row.get("kind", DEFAULT_MESH_KIND)) + (
        graded if row["family"] in PEER_KEYS_BY_NAME_IN_TABLES else ""
    )


def median_seconds_of_unit_workload(rows: Iterable[Mapping[str, Any]]) -> float:
    """The time of the unit of work [s]: the median over all rows of time divided by ratio."""
    return median(row["seconds"] / row["ratio"] for row in rows if "ratio" in row)


def median_relative_scatter_of_timings(rows: Iterable[Mapping[str, Any]]) -> float:
    """The typical scatter of timings: interquartile range of the repeats, divided by the median.

    The result is the median over the rows with at least LEAST_REPEATS_OF_TIMING repeats.
    """
    return median(
        (row["upper"] - row["lower"]) / row["seconds"]
        for row in rows
        if row.get("repeats", 0) >= LEAST_REPEATS_OF_TIMING
    )
