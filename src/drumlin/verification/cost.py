"""The time and memory of solving a brake, compared with the least work that a solve needs.

This least work is one assembly of the stiffness, one factorisation and one back-substitution.
"""

import math
import multiprocessing
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from statistics import median
from typing import Any, NamedTuple

import numpy as np
from scipy.sparse.linalg import splu

from drumlin.base.arrays import Floats
from drumlin.base.errors import BadInput
from drumlin.base.resource_use import peak_memory_of_process
from drumlin.brake.brake import Brake, Shoe
from drumlin.fem.error_control.levels import REFINEMENT_LEVELS_FROM_COARSE_TO_FINE
from drumlin.fem.mesh.arc import parametric_mesh_of_shoe
from drumlin.fem.mesh.degree import nodal_basis_of_mesh
from drumlin.fem.mesh.grading import LiningDivision, divide_lining_into_elements
from drumlin.fem.model import DEFAULT_PENALTY_FACTOR, solve_prepared_model
from drumlin.fem.preparation.bodies import ShoeSubstructure
from drumlin.fem.preparation.meshes import Mesher
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.fem.solve import require_element_options_have_effect, solve
from drumlin.fem.substructure.body import (
    sparse_stiffness_of_body,
)
from drumlin.fem.substructure.elasticity import elastic_layers_of_shoe
from drumlin.fem.width.prepare import prepare_model_with_shoe_widths
from drumlin.models import model_with_name_that_applies_to_brake

DEFAULT_ELEMENTS_PER_LINING_FOR_COST = 140
"""Default number of elements along each lining of a brake whose cost is measured.

A shoe of a car's brake then has some 20 000 unknowns.
"""

NUMBER_OF_TIMINGS_OF_EACH_TASK = 7
"""Number of times that each task, such as a factorisation, is timed; the median is reported."""

UNKNOWNS_OF_SHOE_BY_ROW_OF_COST_TABLE = (20_000, 50_000, 100_000, 200_000, 500_000, 1_000_000)
"""Number of unknowns of a shoe for each row of the table of cost by size."""

DEGREES_ACROSS_WIDTH_BY_ROW_OF_COST_TABLE = (1, 2, 3, 4, 5)
"""Polynomial degree across the width for each row of the table of cost of solid shoes."""

MOST_UNKNOWNS_OF_ROW_IN_FIT_OF_TIME = 600_000
"""Number of unknowns above which a row of the cost table is not used to fit time ~ unknowns^k.
"""


class TimesAndMemoryOfSolve(NamedTuple):
    """The time and memory of solving a brake. All times are medians of repeated runs, in seconds.

    Shoes of equal shape share one finite-element model, which counts once.

    Attributes
    ----------
    unknowns : number of unknowns of all distinct shoes
    contact_nodes : number of nodes of all distinct shoes on the friction surface
    memory : largest resident memory of the process up to the end of the first solve [bytes]; nan
        where the system does not tell it
    solve : time of a whole solve, from the brake to its pressures
    further : time of a further load case: another friction coefficient with the same stiffness
    assembly : time of assembling the stiffness of all distinct shoes
    factorisation : time of one factorisation of each stiffness
    substitution : time of one back-substitution with each factorisation
    """

    unknowns: int
    contact_nodes: int
    memory: float
    solve: float
    further: float
    assembly: float
    factorisation: float
    substitution: float

    @property
    def solve_time_over_sum_of_its_parts(self) -> float:
        """Time of a solve, divided by the time of one assembly, factorisation and substitution."""
        return self.solve / (self.assembly + self.factorisation + self.substitution)

    @property
    def further_solve_time_over_solve_time(self) -> float:
        """Time of a further load case, relative to a whole solve."""
        return self.further / self.solve


def measure_time_and_memory_of_fem(
    brake: Brake,
    *,
    elements: int = DEFAULT_ELEMENTS_PER_LINING_FOR_COST,
    penalty: float = DEFAULT_PENALTY_FACTOR,
    repeats: int = NUMBER_OF_TIMINGS_OF_EACH_TASK,
    mesher: Mesher | None = None,
) -> TimesAndMemoryOfSolve:
    """Measure the time and memory of solving a brake by finite elements.

    Parameters
    ----------
    brake : the brake
    elements : number of elements along each lining
    penalty : contact penalty
    repeats : number of times that each task is timed (the further load case at least 3 times); with
        1 the time of the first solve counts
    mesher : function that meshes a shoe; None: drumlin's own mesher
    """
    mesh_and_solve = partial(_mesh_and_solve_brake, brake, elements, penalty, mesher)
    start = time.perf_counter()
    scene = mesh_and_solve()
    solve = time.perf_counter() - start
    memory = peak_memory_of_process()
    # Shoes of equal shape share one body, whose assembly and factorisation are timed once.
    shoe_of = dict(zip(map(id, scene.bodies), brake.shoes, strict=True))
    bodies = list({id(body): body for body in scene.bodies}.values())
    parts = np.zeros(3)
    for body in bodies:
        parts += _seconds_to_assemble_factorise_and_substitute(body, shoe_of[id(body)], repeats)
    assembly, factorisation, substitution = parts.tolist()
    if repeats > 1:
        solve = _median_seconds_of_call(mesh_and_solve, repeats)
    further_case = partial(
        solve_prepared_model,
        scene,
        _brake_with_friction_of_further_load_case(brake),
        penalty=penalty,
    )
    return TimesAndMemoryOfSolve(
        unknowns=sum(body.unknowns for body in bodies),
        contact_nodes=sum(len(body.line.nodes) for body in bodies),
        memory=memory,
        solve=solve,
        further=_median_seconds_of_call(further_case, max(repeats, 3)),
        assembly=assembly,
        factorisation=factorisation,
        substitution=substitution,
    )


def _mesh_and_solve_brake(
    brake: Brake, elements: int, penalty: float, mesher: Mesher | None
) -> PreparedModel:
    """Mesh a brake and solve it; returns the prepared model.

    `elements` is the number of elements along each lining, `penalty` the contact penalty, and
    `mesher` a function that meshes a shoe (None for drumlin's own mesher).
    """
    scene = make_prepared_model(brake, elements=elements, mesher=mesher)
    solve_prepared_model(scene, brake, penalty=penalty)
    return scene


def _brake_with_friction_of_further_load_case(brake: Brake) -> Brake:
    """A copy of the brake with 0.9 times its friction coefficient, used as a further load case."""
    return brake.brake_with_new_friction_coefficient(0.9 * brake.friction)


def _seconds_to_assemble_factorise_and_substitute(
    body: ShoeSubstructure, shoe: Shoe, repeats: int
) -> Floats:
    """The times (3,) [s] of assembling, factorising and back-substituting one shoe's stiffness.

    The shoe is clamped at its hinge. Each time is the median of `repeats` runs.
    """
    K = sparse_stiffness_of_body(body.basis, elastic_layers_of_shoe(shoe))
    # The two displacements of each node at the hinge are fixed and leave the matrix.
    free = np.ones(K.shape[0], dtype=bool)
    hinge = body.basis.get_dofs(body.mesh.boundaries["hinge"]).flatten()
    free[2 * hinge] = free[2 * hinge + 1] = False
    K = K[free][:, free].tocsc()
    # These settings make SuperLU use the symmetry of the matrix.
    factorise = partial(
        splu,
        K,
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    substitute = partial(factorise().solve, np.ones(K.shape[0]))
    tasks = (
        lambda: sparse_stiffness_of_body(
            nodal_basis_of_mesh(body.mesh), elastic_layers_of_shoe(shoe)
        ),
        factorise,
        substitute,
    )
    return np.array([_median_seconds_of_call(task, repeats) for task in tasks])


def shoe_mesh_with_given_number_of_unknowns(unknowns: int, shoe: Shoe, radius: float) -> object:
    """The mesh of a shoe with about `unknowns` unknowns, on a drum of the given radius [m].

    The number of elements through the shoe grows in proportion to the number along the lining.
    """
    elements = round(0.95 * math.sqrt(unknowns))
    layers = round(elements / 15)
    even = divide_lining_into_elements(shoe, radius, elements)
    depths = np.linspace(0, shoe.lining.thickness, layers + 1)
    return parametric_mesh_of_shoe(
        shoe, radius, LiningDivision(even.angles, depths, even.step, behind=layers)
    )


def _result_of_call_in_new_process(task: Callable[..., Any], *arguments: Any) -> Any:
    """The result of task(*arguments), run in a new process.

    The largest memory of the new process is then the memory of this task alone.
    """
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(1, mp_context=context) as process:
        return process.submit(task, *arguments).result()


def table_lines_of_cost_by_number_of_unknowns(
    brake: Brake, sizes: tuple[int, ...] = UNKNOWNS_OF_SHOE_BY_ROW_OF_COST_TABLE
) -> Iterator[str]:
    """Yield the lines of a table of cost, with a row for each number of unknowns in `sizes`.

    Each row comes as soon as it is measured. The last line states the exponent k in
    time ~ unknowns^k.
    """
    yield "unknowns  contact nodes  solve [s]  of its parts  further [ms]  memory [GiB]"
    costs = []
    for size in sizes:
        repeats = (
            NUMBER_OF_TIMINGS_OF_EACH_TASK
            if size <= 2 * UNKNOWNS_OF_SHOE_BY_ROW_OF_COST_TABLE[0]
            else 1
        )
        task = partial(
            measure_time_and_memory_of_fem,
            brake,
            mesher=partial(shoe_mesh_with_given_number_of_unknowns, size),
            repeats=repeats,
        )
        row: TimesAndMemoryOfSolve = _result_of_call_in_new_process(task)
        yield (
            f"{row.unknowns:8d}  {row.contact_nodes:13d}  {row.solve:9.3f}  "
            f"{row.solve_time_over_sum_of_its_parts:12.2f}  {row.further * 1e3:12.1f}  "
            f"{row.memory / 2**30:12.2f}"
        )
        if row.unknowns <= MOST_UNKNOWNS_OF_ROW_IN_FIT_OF_TIME:
            costs.append((row.unknowns, row.solve))
    if len(costs) > 1:
        # The exponent is the slope of a straight line through log(time) against log(unknowns).
        unknowns, seconds = np.log(costs).T
        exponent = np.polyfit(unknowns, seconds, 1)[0]
        yield f"solve ~ N^{exponent:.2f} up to {costs[-1][0]} unknowns"


class _TimesAndMemoryOfSolidSolve(NamedTuple):
    """The size, memory and processor time of solving a brake with three-dimensional shoes.

    Attributes
    ----------
    unknowns : number of unknowns of all distinct shoes
    nodes : number of nodes of all distinct shoes on the friction surface
    memory : largest resident memory of the process [bytes]; nan where the system does not tell it
    first : processor time of the whole solve [s]
    further : processor time of a further load case [s]: another friction coefficient
    """

    unknowns: int
    nodes: int
    memory: float
    first: float
    further: float


def table_lines_of_solid_shoe_cost_by_degree(
    brake: Brake, degrees: Sequence[int] = DEGREES_ACROSS_WIDTH_BY_ROW_OF_COST_TABLE
) -> Iterator[str]:
    """Yield the lines of a table of the cost of three-dimensional (solid) shoes.

    There is a row for each degree across the width in `degrees`, all with the coarsest mesh of the
    shoe's cross-section. Each row comes as soon as it is measured. Times are seconds of processor
    time. A further load case is another friction coefficient with the same stiffness.
    """
    yield "degree  unknowns  contact nodes  solve [s]  further [s]  peak memory [GiB]"
    for degree in degrees:
        row: _TimesAndMemoryOfSolidSolve = _result_of_call_in_new_process(
            _measure_time_and_memory_of_solid, brake, degree
        )
        yield (
            f"{degree:6d}  {row.unknowns:8d}  {row.nodes:13d}  {row.first:9.3f}  "
            f"{row.further:11.3f}  {row.memory / 2**30:17.2f}"
        )


def _measure_time_and_memory_of_solid(brake: Brake, degree: int) -> _TimesAndMemoryOfSolidSolve:
    """Measure the cost of solving a brake with solid shoes of a degree across the width."""
    start = time.process_time()
    scene = prepare_model_with_shoe_widths(brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0], degree)
    solve_prepared_model(scene, brake)
    first = time.process_time() - start
    memory, start = peak_memory_of_process(), time.process_time()
    solve_prepared_model(scene, _brake_with_friction_of_further_load_case(brake))
    further = time.process_time() - start
    # Shoes of equal shape share one body, which counts once.
    bodies = {id(body): body for body in scene.bodies}.values()
    unknowns = sum(body.unknowns for body in bodies)
    nodes = sum(len(body.line.nodes) for body in bodies)
    return _TimesAndMemoryOfSolidSolve(unknowns, nodes, memory, first, further)


def time_and_memory_report_lines(
    brake: Brake, model: str = "fem", *, by_size: bool = False, **options: Any
) -> Iterator[str]:
    """Yield lines of text on the time and memory of solving a brake, as they are measured.

    Parameters
    ----------
    brake : the brake
    model : "fem" for plane shoes; "solid" for three-dimensional shoes, whose cost is always a table
    by_size : True: a table of the cost by number of unknowns; False: the cost of this brake
    options : `elements` and `penalty` of the finite elements; not allowed with a table

    Raises
    ------
    BadInput
        for another model, a brake that the model does not cover, or an option that has no effect
    """
    if model not in {"fem", "solid"}:
        raise BadInput(f"--model = {model!r}: has no cost to print; allowed: fem, solid")
    model_with_name_that_applies_to_brake(model, brake)
    brake.check_shoes_can_be_meshed()
    require_element_options_have_effect(brake, elements=options.get("elements"))
    if options and (by_size or model == "solid"):
        chooses = "--table" if by_size else "--model solid"
        raise BadInput(f"{chooses} chooses the elements itself; leave out --elements and --penalty")
    if model == "solid":
        yield from table_lines_of_solid_shoe_cost_by_degree(brake)
    elif by_size:
        yield from table_lines_of_cost_by_number_of_unknowns(brake)
    else:
        yield from time_and_memory_lines_of_one_brake(brake, **options)


def time_and_memory_lines_of_one_brake(brake: Brake, **options: Any) -> list[str]:
    """Lines of text on the cost of one brake.

    The `options` are arguments of `measure_time_and_memory_of_fem`.
    """
    found = measure_time_and_memory_of_fem(brake, **options)
    return [
        f"{found.unknowns} unknowns; medians of {NUMBER_OF_TIMINGS_OF_EACH_TASK} repeats in "
        f"one run",
        f"assembly {found.assembly * 1e3:.1f} ms, "
        f"factorisation {found.factorisation * 1e3:.1f} ms, "
        f"substitution {found.substitution * 1e3:.1f} ms",
        f"whole solve {found.solve * 1e3:.1f} ms = "
        f"{found.solve_time_over_sum_of_its_parts:.2f} times their sum",
        f"further load case {found.further * 1e3:.1f} ms "
        f"= 1/{1 / found.further_solve_time_over_solve_time:.0f} of the first",
        _text_line_of_times_in_default_solves(brake, found),
    ]


def _text_line_of_times_in_default_solves(brake: Brake, found: TimesAndMemoryOfSolve) -> str:
    """A line with the time of a default solve of the brake, and the other times in such solves.

    A default solve chooses its hp elements itself, and states its errors. The ratios hardly depend
    on the machine.
    """
    unit = _median_seconds_of_call(partial(solve, brake), NUMBER_OF_TIMINGS_OF_EACH_TASK)
    ratios = {
        "assembly": found.assembly,
        "factorisation": found.factorisation,
        "substitution": found.substitution,
        "whole solve": found.solve,
        "further load case": found.further,
    }
    texts = [f"{name} {seconds / unit:.2g}" for name, seconds in ratios.items()]
    return (
        f"default solve {unit * 1e3:.1f} ms; the times above in default solves: {', '.join(texts)}"
    )


def _median_seconds_of_call(call: Callable[[], object], repeats: int) -> float:
    """The median time [s] of `repeats` runs of `call`."""
    seconds = []
    for _ in range(repeats):
        start = time.perf_counter()
        call()
        seconds.append(time.perf_counter() - start)
    return median(seconds)
