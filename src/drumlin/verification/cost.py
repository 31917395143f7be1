"""The time and memory of a solve, compared with the least that a solve must do.

The baseline is one assembly of the stiffness, one factorisation and one back-substitution.
"""

import math
import multiprocessing
import resource
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path
from statistics import median
from typing import Any, NamedTuple

import numpy as np
from scipy.sparse.linalg import splu

from drumlin.base.arrays import Floats
from drumlin.base.errors import BadInput
from drumlin.brake.brake import Brake, Shoe
from drumlin.fem.mesh.arc import shoe_mesh
from drumlin.fem.mesh.grading import LiningDivision, divide_lining
from drumlin.fem.model import PENALTY, solve_prepared_model
from drumlin.fem.preparation.bodies import ShoeSubstructure
from drumlin.fem.preparation.meshes import Mesher
from drumlin.fem.preparation.prepare import prepare
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.fem.solve import check_division_options
from drumlin.fem.substructure.body import scalar_basis, stiffness
from drumlin.fem.substructure.elasticity import elastic_layers_of_shoe
from drumlin.models import pick

COST_ELEMENTS = 140
"""Elements along the lining of a measured brake: some 20 000 unknowns for a shoe of a car."""

REPEATS = 7
"""Number of times that a measurement is repeated; the median of the times counts."""

SIZES = (20_000, 50_000, 100_000, 200_000, 500_000, 1_000_000)
"""Unknowns of a shoe in the rows of the table of cost."""

SOLID_ELEMENTS = (16, 24, 32, 48, 72)
"""Elements along the lining of a solid shoe in the rows of the table of solid shoes."""

LARGEST_FITTED = 600_000
"""Largest number of unknowns to which the exponent of the time is fitted."""


class Cost(NamedTuple):
    """The time and memory of the solve of a brake. Times are medians of repeats [s].

    Equal shoes share one body, which counts once.

    Attributes
    ----------
    unknowns : number of unknowns of all distinct bodies
    contact_nodes : number of nodes of all distinct bodies on the friction surface
    memory : largest resident memory of the process up to the end of the first solve [bytes]
    solve : time of a whole solve
    further : time of a further load case, another friction coefficient on the same bodies
    assembly : time of assembling the stiffness of all distinct bodies
    factorisation : time of one factorisation of each stiffness
    substitution : time of one back-substitution with each factorisation
    """

    unknowns: int
    contact_nodes: int
    memory: int
    solve: float
    further: float
    assembly: float
    factorisation: float
    substitution: float

    @property
    def solve_ratio(self) -> float:
        """Time of a whole solve, relative to the baseline of the three parts."""
        return self.solve / (self.assembly + self.factorisation + self.substitution)

    @property
    def further_ratio(self) -> float:
        """Time of a further load case, relative to a whole solve."""
        return self.further / self.solve


def measure_fem_cost(
    brake: Brake,
    *,
    elements: int = COST_ELEMENTS,
    penalty: float = PENALTY,
    repeats: int = REPEATS,
    mesher: Mesher | None = None,
) -> Cost:
    """Measure the time and memory of solving a brake by finite elements.

    Parameters
    ----------
    brake : the brake
    elements : along each lining
    penalty : penalty of the contact
    repeats : number of repeats; with 1 the time of the first solve is that of a whole solve
    mesher : function that meshes a shoe in place of drumlin's own
    """

    def prepare_and_respond() -> PreparedModel:
        """Solve the brake from the beginning."""
        scene = prepare(brake, elements=elements, mesher=mesher)
        solve_prepared_model(scene, brake, penalty=penalty)
        return scene

    start = time.perf_counter()
    scene = prepare_and_respond()
    solve = time.perf_counter() - start
    memory = peak_memory()
    # Equal shoes share one body, which is measured once.
    bodies: dict[int, ShoeSubstructure] = {}
    parts = np.zeros(3)
    for body, shoe in zip(scene.bodies, brake.shoes, strict=True):
        if id(body) not in bodies:
            bodies[id(body)] = body
            parts += _baseline_seconds(body, shoe, repeats)
    assembly, factorisation, substitution = parts.tolist()
    if repeats > 1:
        solve = _median_seconds(prepare_and_respond, repeats)
    further_case = partial(solve_prepared_model, scene, _with_less_friction(brake), penalty=penalty)
    return Cost(
        unknowns=sum(body.unknowns for body in bodies.values()),
        contact_nodes=sum(len(body.line.nodes) for body in bodies.values()),
        memory=memory,
        solve=solve,
        further=_median_seconds(further_case, max(repeats, 3)),
        assembly=assembly,
        factorisation=factorisation,
        substitution=substitution,
    )


def _with_less_friction(brake: Brake) -> Brake:
    """The brake with 0.9 of its friction coefficient: a further load case on the same bodies."""
    return brake.model_copy(update={"friction": 0.9 * brake.friction})


def _baseline_seconds(body: ShoeSubstructure, shoe: Shoe, repeats: int) -> Floats:
    """Seconds (3,) of assembly, factorisation and back-substitution of a body, its hinge clamped.

    Each time is the median of a number of `repeats`.
    """
    K = stiffness(body.basis, elastic_layers_of_shoe(shoe))
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
        lambda: stiffness(scalar_basis(body.mesh), elastic_layers_of_shoe(shoe)),
        factorise,
        substitute,
    )
    return np.array([_median_seconds(task, repeats) for task in tasks])


def mesh_of_given_size(unknowns: int, shoe: Shoe, radius: float) -> object:
    """The mesh of a shoe with about a number of `unknowns`, on a brake of a `radius` [m].

    The number of elements through the shoe grows in proportion to the number along the lining.
    """
    elements = round(0.95 * math.sqrt(unknowns))
    layers = round(elements / 15)
    even = divide_lining(shoe, radius, elements)
    depths = np.linspace(0, shoe.lining.thickness, layers + 1)
    return shoe_mesh(shoe, radius, LiningDivision(even.angles, depths, even.step, behind=layers))


def _in_new_process(task: Callable[..., Any], *arguments: Any) -> Any:
    """The result of a task in a process of its own, so that its peak memory is its own."""
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(1, mp_context=context) as process:
        return process.submit(task, *arguments).result()


def cost_table_lines(brake: Brake, sizes: tuple[int, ...] = SIZES) -> Iterator[str]:
    """Lines of a table of cost by number of unknowns, each as soon as it is measured.

    A last line states the power of the number of unknowns with which the time grows.
    """
    yield "unknowns  contact nodes  solve [s]  of its parts  further [ms]  memory [GiB]"
    costs = []
    for size in sizes:
        repeats = REPEATS if size <= 2 * SIZES[0] else 1
        task = partial(
            measure_fem_cost, brake, mesher=partial(mesh_of_given_size, size), repeats=repeats
        )
        row: Cost = _in_new_process(task)
        yield (
            f"{row.unknowns:8d}  {row.contact_nodes:13d}  {row.solve:9.3f}  "
            f"{row.solve_ratio:12.2f}  {row.further * 1e3:12.1f}  {row.memory / 2**30:12.2f}"
        )
        if row.unknowns <= LARGEST_FITTED:
            costs.append((row.unknowns, row.solve))
    if len(costs) > 1:
        # The slope of the line through the logarithms is the power.
        unknowns, seconds = np.log(costs).T
        exponent = np.polyfit(unknowns, seconds, 1)[0]
        yield f"solve ~ N^{exponent:.2f} up to {costs[-1][0]} unknowns"


class _SolidCost(NamedTuple):
    """The size, memory [bytes] and processor time [s] of a solve of solid shoes.

    Attributes
    ----------
    unknowns : number of unknowns of all distinct bodies
    nodes : number of nodes of all distinct bodies on the friction surface
    memory : largest resident memory of the process
    first : time of the whole solve
    further : time of another friction coefficient on the same bodies
    """

    unknowns: int
    nodes: int
    memory: int
    first: float
    further: float


def solid_cost_table_lines(brake: Brake, elements: Sequence[int] = SOLID_ELEMENTS) -> Iterator[str]:
    """Lines of a table of the cost of solid shoes, each as soon as it is measured.

    `elements` are the numbers of elements along the lining. Times are seconds of processor time. A
    further load case is another friction coefficient on the same bodies.
    """
    yield "unknowns  contact nodes  solve [s]  further [s]  peak memory [GiB]"
    for count in elements:
        row: _SolidCost = _in_new_process(_measure_solid_cost, brake, count)
        yield (
            f"{row.unknowns:8d}  {row.nodes:13d}  {row.first:9.2f}  "
            f"{row.further:11.2f}  {row.memory / 2**30:17.2f}"
        )


def _measure_solid_cost(brake: Brake, elements: int) -> _SolidCost:
    """Measure the solve of a brake's solid shoes with a number of elements along the lining."""
    # The model of solid shoes loads slowly, and no other cost needs it.
    from drumlin.fem.solid import model as solid  # noqa: PLC0415

    start = time.process_time()
    scene = solid.prepare(brake, elements=elements)
    solve_prepared_model(scene, brake)
    first = time.process_time() - start
    memory, start = peak_memory(), time.process_time()
    solve_prepared_model(scene, _with_less_friction(brake))
    further = time.process_time() - start
    # Equal shoes share one body.
    bodies = {id(body): body for body in scene.bodies}.values()
    unknowns = sum(body.unknowns for body in bodies)
    nodes = sum(len(body.line.nodes) for body in bodies)
    return _SolidCost(unknowns, nodes, memory, first, further)


def cost_report_lines(
    brake: Brake, model: str = "fem", *, by_size: bool = False, **options: Any
) -> Iterator[str]:
    """Lines of text on the cost of a brake, each as soon as it is measured.

    Parameters
    ----------
    brake : the brake
    model : "fem", or "solid", whose cost is always a table
    by_size : whether the lines are a table of the cost by number of unknowns
    options : `elements` and `penalty` of the finite elements; not with a table

    Raises
    ------
    BadInput
        for another model, a brake that the model does not cover, or an option that has no effect
    """
    if model not in {"fem", "solid"}:
        raise BadInput(f"--model = {model!r}: has no cost to print; allowed: fem, solid")
    pick(model, brake)
    brake.check_meshable()
    check_division_options(brake, elements=options.get("elements"))
    if options and (by_size or model == "solid"):
        chooses = "--table" if by_size else "--model solid"
        raise BadInput(f"{chooses} chooses the elements itself; leave out --elements and --penalty")
    if model == "solid":
        yield from solid_cost_table_lines(brake)
    elif by_size:
        yield from cost_table_lines(brake)
    else:
        yield from measured_cost_lines(brake, **options)


def measured_cost_lines(brake: Brake, **options: Any) -> list[str]:
    """Lines of text on the cost of a brake; `options` as of `measure_fem_cost`."""
    found = measure_fem_cost(brake, **options)
    return [
        f"{found.unknowns} unknowns; medians of {REPEATS} repeats in one run",
        f"assembly {found.assembly * 1e3:.1f} ms, "
        f"factorisation {found.factorisation * 1e3:.1f} ms, "
        f"substitution {found.substitution * 1e3:.1f} ms",
        f"whole solve {found.solve * 1e3:.1f} ms = {found.solve_ratio:.2f} times their sum",
        f"further load case {found.further * 1e3:.1f} ms "
        f"= 1/{1 / found.further_ratio:.0f} of the first",
    ]


def peak_memory() -> int:
    """The largest resident memory of this process so far [bytes]."""
    # On Linux getrusage would count the memory of the process that started this process, too.
    status = Path("/proc/self/status")
    if status.exists():
        line = next(line for line in status.read_text().splitlines() if line.startswith("VmHWM"))
        return 1024 * int(line.split()[1])
    size = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    # getrusage gives bytes on macOS, elsewhere units of 1024 bytes.
    return size if sys.platform == "darwin" else 1024 * size


def _median_seconds(call: Callable[[], object], repeats: int) -> float:
    """The median time [s] of a number of `repeats` of a call."""
    seconds = []
    for _ in range(repeats):
        start = time.perf_counter()
        call()
        seconds.append(time.perf_counter() - start)
    return median(seconds)
