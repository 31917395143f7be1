"""What a solve costs against the least that it could: assembly, one factorisation, one
back-substitution.
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

from drumlin.base.errors import BadInput
from drumlin.brake.brake import Brake, Shoe
from drumlin.fem.mesh.arc import shoe_mesh
from drumlin.fem.mesh.grading import LiningDivision, divide
from drumlin.fem.model import PENALTY, respond
from drumlin.fem.preparation.meshes import Mesher
from drumlin.fem.preparation.prepare import prepare
from drumlin.fem.solve import check_divided
from drumlin.fem.substructure.body import scalar_basis, stiffness
from drumlin.fem.substructure.elasticity import layers_of
from drumlin.models import pick

COST_ELEMENTS = 140  # about 20 000 unknowns for a car's shoe
REPEATS = 7
SIZES = (20_000, 50_000, 100_000, 200_000, 500_000, 1_000_000)  # unknowns of a shoe in the table
SOLID_ELEMENTS = (16, 24, 32, 48, 72)
"""Numbers of elements along the lining of the solid shoes in their table."""
LARGEST_FITTED = 600_000
"""Largest number of unknowns to which the exponent of the time is fitted."""


class Cost(NamedTuple):
    """Seconds, medians of repeats: whole solve, further load case, and the three parts of the
    baseline.

    `contact_nodes`: of all distinct bodies; `memory`: largest resident memory of the process up to
    the end of the first solve [bytes].
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
        """Whole solve over assembly + one factorisation + one back-substitution."""
        return self.solve / (self.assembly + self.factorisation + self.substitution)

    @property
    def further_ratio(self) -> float:
        """Further load case over the first solve."""
        return self.further / self.solve


def cost(
    brake: Brake,
    *,
    elements: int = COST_ELEMENTS,
    penalty: float = PENALTY,
    repeats: int = REPEATS,
    mesher: Mesher | None = None,
) -> Cost:
    """Measure a brake in one run. The baseline is that of its distinct bodies, hinge clamped.

    A further load case is another friction coefficient on the same bodies.
    """
    first = time.perf_counter()
    scene = prepare(brake, elements=elements, mesher=mesher)
    respond(scene, brake, penalty=penalty)
    first = time.perf_counter() - first
    memory = peak_memory()
    other = brake.model_copy(update={"friction": 0.9 * brake.friction})
    bodies = {id(body): (body, shoe) for body, shoe in zip(scene.bodies, brake.shoes, strict=True)}
    phases = np.zeros(3)
    for body, shoe in bodies.values():
        K = stiffness(body.basis, layers_of(shoe))
        free = np.ones(K.shape[0], dtype=bool)
        hinge = body.basis.get_dofs(body.mesh.boundaries["hinge"]).flatten()
        free[2 * hinge] = free[2 * hinge + 1] = False
        K = K[free][:, free].tocsc()
        right = np.ones(K.shape[0])

        factorise = partial(
            splu,
            K,
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
        phases += [
            _time(partial(_assemble, body.mesh, shoe), repeats),
            _time(factorise, repeats),
            _time(partial(factorise().solve, right), repeats),
        ]
    return Cost(
        sum(body.unknowns for body, _ in bodies.values()),
        sum(len(body.line.nodes) for body, _ in bodies.values()),
        memory,
        _time(
            lambda: respond(
                prepare(brake, elements=elements, mesher=mesher), brake, penalty=penalty
            ),
            repeats,
        )
        if repeats > 1
        else first,
        _time(lambda: respond(scene, other, penalty=penalty), max(repeats, 3)),
        *phases.tolist(),
    )


def proportional(unknowns: int, shoe: Shoe, radius: float) -> object:
    """Mesh of about so many unknowns, with as many more elements through it as along it."""
    elements = round(0.95 * math.sqrt(unknowns))
    layers = round(elements / 15)
    even = divide(shoe, radius, elements)
    depths = np.linspace(0, shoe.lining.thickness, layers + 1)
    return shoe_mesh(shoe, radius, LiningDivision(even.angles, depths, even.step, behind=layers))


def table(brake: Brake, sizes: tuple[int, ...] = SIZES) -> Iterator[str]:
    """Cost against unknowns as lines for people, as they come, and the exponent of N to which the
    time grows.

    Each size is measured in a process of its own, so that its peak memory is its own.
    """
    yield "unknowns  contact nodes  solve [s]  of its parts  further [ms]  memory [GiB]"
    costs = []
    for size in sizes:
        repeats = REPEATS if size <= 2 * SIZES[0] else 1
        job = partial(cost, brake, mesher=partial(proportional, size), repeats=repeats)
        with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as process:
            c = process.submit(job).result()
        costs.append(c)
        yield (
            f"{c.unknowns:8d}  {c.contact_nodes:13d}  {c.solve:9.3f}  {c.solve_ratio:12.2f}  "
            f"{c.further * 1e3:12.1f}  "
            f"{c.memory / 2**30:12.2f}"
        )
    fitted = [c for c in costs if c.unknowns <= LARGEST_FITTED]
    if len(fitted) > 1:
        exponent = float(
            np.polyfit(np.log([c.unknowns for c in fitted]), np.log([c.solve for c in fitted]), 1)[
                0
            ]
        )
        yield f"solve ~ N^{exponent:.2f} up to {fitted[-1].unknowns} unknowns"


def solid_table(brake: Brake, elements: Sequence[int] = SOLID_ELEMENTS) -> Iterator[str]:
    """Cost of solid shoes against unknowns as lines for people, in seconds of processor time, as
    they come.

    Further: another friction coefficient on the same bodies. Each size is measured in a process of
    its own.
    """
    yield "unknowns  contact nodes  solve [s]  further [s]  peak memory [GiB]"
    for count in elements:
        with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as process:
            unknowns, nodes, memory, first, further = process.submit(
                _solid_cost, brake, count
            ).result()
        yield f"{unknowns:8d}  {nodes:13d}  {first:9.2f}  {further:11.2f}  {memory / 2**30:17.2f}"


def _solid_cost(brake: Brake, elements: int) -> tuple[int, int, int, float, float]:
    from drumlin.fem.solid import model as solid  # noqa: PLC0415  (hexahedra load only where they are used)

    start = time.process_time()
    scene = solid.prepare(brake, elements=elements)
    respond(scene, brake)
    first = time.process_time() - start
    memory, start = peak_memory(), time.process_time()
    respond(scene, brake.model_copy(update={"friction": 0.9 * brake.friction}))
    bodies = {id(body): body for body in scene.bodies}.values()
    unknowns, nodes = (
        sum(body.unknowns for body in bodies),
        sum(len(body.line.nodes) for body in bodies),
    )
    return unknowns, nodes, memory, first, time.process_time() - start


def cost_lines(
    brake: Brake, model: str = "fem", *, by_size: bool = False, **options: Any
) -> Iterator[str]:
    """The cost of a brake as lines for people, as they come.

    Parameters
    ----------
    brake : the brake
    model : "fem", or "solid", which has a table only
    by_size : whether the cost stands against the number of unknowns, in a table
    options : `elements` and `penalty` of the finite elements; not with a table

    Raises
    ------
    BadInput
        for a model without cost, a brake that the model does not apply to, an option of no use
    """
    if model not in {"fem", "solid"}:
        raise BadInput(f"--model = {model!r}: has no cost to print; allowed: fem, solid")
    pick(model, brake)
    brake.check_meshable()
    check_divided(brake, elements=options.get("elements"))
    if options and (by_size or model == "solid"):
        chooses = "--table" if by_size else "--model solid"
        raise BadInput(f"{chooses} chooses the elements itself; leave out --elements and --penalty")
    if model == "solid":
        yield from solid_table(brake)
    elif by_size:
        yield from table(brake)
    else:
        yield from measure(brake, **options)


def measure(brake: Brake, **options: Any) -> list[str]:
    """The cost of a brake as lines for people."""
    c = cost(brake, **options)
    return [
        f"{c.unknowns} unknowns; medians of {REPEATS} repeats in one run",
        f"assembly {c.assembly * 1e3:.1f} ms, factorisation {c.factorisation * 1e3:.1f} ms, "
        f"substitution {c.substitution * 1e3:.1f} ms",
        f"whole solve {c.solve * 1e3:.1f} ms = {c.solve_ratio:.2f} times their sum",
        f"further load case {c.further * 1e3:.1f} ms = 1/{1 / c.further_ratio:.0f} of the first",
    ]


def peak_memory() -> int:
    """Largest resident memory of this process [bytes]; Linux's getrusage would count what started
    it, too.
    """
    status = Path("/proc/self/status")
    if status.exists():
        line = next(line for line in status.read_text().splitlines() if line.startswith("VmHWM"))
        return 1024 * int(line.split()[1])
    size = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return size if sys.platform == "darwin" else 1024 * size  # kB but for macOS


def _assemble(mesh: Any, shoe: Shoe) -> Any:
    return stiffness(scalar_basis(mesh), layers_of(shoe))


def _time(call: Callable[[], object], repeats: int) -> float:
    seconds = []
    for _ in range(repeats):
        start = time.perf_counter()
        call()
        seconds.append(time.perf_counter() - start)
    return median(seconds)
