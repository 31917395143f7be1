"""Error against run time of every way to solve a brake: laws, foundation, finite elements, textbook
contact, peers.

A method is data: a family, a name and options, so that it can be the key of a journal and be sent
to another process. Its errors are those of its response against a reference; its time is the
process's own, medians of repeats, each beside a unit of work that is measured at once, so that
ratios hold where the machine's pace changes.
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
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.file import vary
from drumlin.fem.error_control.adapt import DEFAULT, Tolerance, adapt
from drumlin.fem.error_control.levels import LEVELS, steps
from drumlin.fem.mesh.arc import DEFAULT_KIND, shoe_mesh
from drumlin.fem.mesh.grading import EDGE_SIZE, LiningDivision, graded, inner_steps, lining_layers
from drumlin.fem.model import respond
from drumlin.fem.preparation.prepare import prepare
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.models import pick
from drumlin.response.norms import pressure_distance, relative, vector_distance
from drumlin.response.response import Response, edge_zone
from drumlin.verification.cost import peak_memory
from drumlin.verification.reference import Trio, peak_away
from drumlin_studies import pointwise

TIMED_REPEATS = 5  # at least
LEAST_SECONDS = 0.1  # of a measurement, all repeats together
MOST_REPEATS = 9
LEAST_SAMPLE = 2e-3  # s; what is faster is run several times a sample
EQUAL_TIMES = 1.2  # times that differ by less are taken as equal
FURTHER_FRICTION = 0.9  # of the friction coefficient, in the further load case
GRADED_FROM = 36
"""Elements along a lining from which on the smallest ones of a `refined_mesh` shrink in proportion,
so that its error goes on falling where the pressure is singular. Coarser meshes are graded as any
other.
"""
LAYERS_BEHIND = 4
"""Least number of layers through backing and body each of a `refined_mesh`: their error stays below
the lining's, where a mesh is to show how far refinement goes.
"""
ERROR_KEYS = ("torque_error", "peak_error", "pressure_error", "reaction_error")


class Method(NamedTuple):
    """A way to solve a brake. `family`: of METHOD_FAMILIES or PEER_FAMILIES; `options`: its own, plain
    data.
    """

    family: str
    name: str
    options: Mapping[str, Any] = {}

    @property
    def case(self) -> dict[str, Any]:
        """What tells the method apart, for a journal."""
        return {"family": self.family, "method": self.name, **self.options}


class ColdSolve(NamedTuple):
    """What a cold solve leaves: `further` solves another friction with what can be reused of it."""

    response: Response
    further: Callable[[], Response]
    unknowns: Callable[[], int] | None = None


def _other(brake: Brake) -> Brake:
    """The brake of the further load case."""
    return vary(brake, {"friction": FURTHER_FRICTION * brake.friction})


def _model(brake: Brake, *, model: str, **options: Any) -> ColdSolve:
    solver = pick(model, brake).solve
    return ColdSolve(solver(brake, **options), partial(solver, _other(brake), **options))


def even_mesh(shoe: Shoe, radius: float, elements: int, kind: str) -> Any:
    """A mesh of a shoe that is graded nowhere."""
    depths = np.linspace(0, shoe.lining.thickness, lining_layers(elements) + 1)
    step = (shoe.arc[1] - shoe.arc[0]) / elements
    return shoe_mesh(
        shoe, radius, LiningDivision(np.linspace(*shoe.arc, elements + 1), depths, step), kind
    )


def refined_mesh(shoe: Shoe, radius: float, elements: int, layers: int, kind: str) -> Any:
    """A mesh of a shoe whose least elements at the lining's ends are the smaller, the more it has."""
    return shoe_mesh(shoe, radius, refined_division(shoe, radius, elements, layers), kind)


def refined_division(shoe: Shoe, radius: float, elements: int, layers: int) -> LiningDivision:
    """Elements of at most 1/`elements` of the lining, graded to its edges: the more, the smaller
    the smallest.
    """
    (start, end), zone = shoe.arc, shoe.lining.thickness / radius
    fineness = max(1.0, elements / GRADED_FROM)
    half, smallest = (end - start) / 2, EDGE_SIZE / fineness
    step = (end - start) / elements
    count = max(2, math.ceil(2 * inner_steps(half, half, zone, smallest) / step))
    return LiningDivision(
        angles=graded(start, end, count, zone, smallest),
        depths=graded(0, shoe.lining.thickness, layers, shoe.lining.thickness / 2, smallest),
        step=step,
        behind=LAYERS_BEHIND,
    )


def _mesh(
    brake: Brake,
    *,
    elements: int,
    kind: str = DEFAULT_KIND,
    even: bool = False,
    penalty: float = math.inf,
) -> ColdSolve:
    mesher = partial(even_mesh, elements=elements, kind=kind) if even else None
    scene = prepare(brake, elements=elements, kind=kind, mesher=mesher)
    response = respond(scene, brake, penalty=penalty)
    return ColdSolve(
        response, lambda: respond(scene, _other(brake), penalty=penalty), partial(_unknowns, scene)
    )


def _unknowns(scene: PreparedModel) -> int:
    """Of the distinct bodies and the ring."""
    bodies = {id(body): body for body in scene.bodies}.values()
    return sum(body.unknowns for body in bodies) + (
        0 if scene.ring is None else int(2 * scene.ring.basis.N)
    )


def _columns(brake: Brake, *, level: int) -> ColdSolve:
    """Columns of a level without an estimate, after the coarsest one has found the ends of the
    contact.
    """
    answer = partial(respond, penalty=math.inf)
    *_, (scene, response) = steps(brake, answer, levels=(LEVELS[0], LEVELS[level])[-level - 1 :])
    return ColdSolve(response, lambda: answer(scene, _other(brake)), partial(_unknowns, scene))


def _estimated(brake: Brake, *, tolerance: float) -> ColdSolve:
    """Columns to a tolerance that is estimated; of the torque the default, where that is less."""
    answer, allowed = (
        partial(respond, penalty=math.inf),
        Tolerance(tolerance, min(tolerance, DEFAULT.torque)),
    )
    scene, response = adapt(brake, allowed, answer)
    return ColdSolve(response, lambda: answer(scene, _other(brake)), partial(_unknowns, scene))


def _pointwise(brake: Brake, *, elements: int, penalty: float) -> ColdSolve:
    solver = partial(pointwise.solve, elements=elements, penalty=penalty)
    return ColdSolve(
        solver(brake),
        lambda: solver(_other(brake)),
        lambda: _unknowns(prepare(brake, elements=elements)),
    )


METHOD_FAMILIES: Mapping[str, Callable[..., ColdSolve]] = {
    "law": _model,
    "foundation": _model,
    "even mesh": _mesh,
    "graded mesh": _mesh,
    "columns": _columns,
    "columns, error stated": _estimated,
    "weak penalty": _mesh,
    "pointwise penalty": _pointwise,
}
PEER_FAMILIES = {written: name for name, written in peers.PEERS.items()}


def solved(brake: Brake, method: Method) -> ColdSolve:
    """A brake by a method, cold. Raises BadInput where it does not apply, NoAnswer where it fails."""
    return METHOD_FAMILIES[method.family](brake, **method.options)


def errors(brake: Brake, response: Response, truth: Response) -> dict[str, float]:
    """Relative errors against a truth: torque of the brake, and of the worst shoe the peak pressure
    and p in L2, both away from the edges, and the hinge reaction.
    """
    found: dict[str, list[float]] = {key: [] for key in ERROR_KEYS[1:]}
    for spec, a, b in zip(brake.shoes, response.shoes, truth.shoes, strict=True):
        edge = edge_zone(spec, brake.scale_factor)
        found["peak_error"].append(abs(relative(peak_away(a, edge), peak_away(b, edge))))
        found["pressure_error"].append(pressure_distance(a, b))
        found["reaction_error"].append(vector_distance(a.hinge_reaction, b.hinge_reaction))
    worst = {
        key: max((v for v in values if not math.isnan(v)), default=0.0)
        for key, values in found.items()
    }
    return {"torque_error": abs(relative(response.torque, truth.torque)), **worst}


def floor(brake: Brake, trio: Trio) -> dict[str, float]:
    """The largest distance of the other responses of a reference from its value: errors below it
    are not claimed.

    That of the torque is the sum of the shoes' distances, which do not cancel.
    """
    found: dict[str, float] = {}
    for other in trio.others:
        apart = math.fsum(
            abs(a.torque - b.torque) for a, b in zip(trio.value.shoes, other.shoes, strict=True)
        )
        own = errors(brake, other, trio.value) | {
            "torque_error": apart / trio.value.torque if apart else 0.0
        }
        found = {name: max(value, found.get(name, 0.0)) for name, value in own.items()}
    return found


class Timing(NamedTuple):
    """Seconds of a call, median and quartiles of the repeats, and the median of its ratios to the
    unit beside it.
    """

    seconds: float
    lower: float
    upper: float
    ratio: float
    repeats: int


def timing(call: Callable[[], object], unit: Callable[[], object], first: float) -> Timing:
    """Time a call that took `first` seconds once and, before each of its repeats, the unit."""
    loops = max(1, math.ceil(LEAST_SAMPLE / max(first, 1e-6)))
    samples: list[float] = []
    ratios: list[float] = []
    while len(samples) < TIMED_REPEATS or (
        sum(samples) * loops < LEAST_SECONDS and len(samples) < MOST_REPEATS
    ):
        beside = _spent(unit, 1)
        samples.append(_spent(call, loops))
        ratios.append(samples[-1] / beside)
    return Timing(*_quartiles(samples), median(ratios), len(samples))


def _quartiles(samples: list[float]) -> tuple[float, float, float]:
    """Median, lower and upper quartile."""
    if len(samples) == 1:
        return samples[0], samples[0], samples[0]
    lower, middle, upper = quantiles(samples, n=4, method="inclusive")
    return middle, lower, upper


def _spent(call: Callable[[], object], loops: int = 1) -> float:
    """The process's own seconds of one of `loops` calls."""
    start = time.process_time()
    for _ in range(loops):
        call()
    return (time.process_time() - start) / loops


def measure(
    brake: Brake, method: Method, truth: Response, unit: Callable[[], object]
) -> dict[str, Any]:
    """One row: errors, times, memory, unknowns; a method that fails or is refused is a row that
    says why.
    """
    row: dict[str, Any] = dict(method.case)
    start = time.process_time()
    try:
        found = solved(brake, method)
    except DrumlinError as error:
        return row | {"seconds": time.process_time() - start, "status": _said(error)}
    first = time.process_time() - start
    row |= errors(brake, found.response, truth) | {
        "unknowns": None if found.unknowns is None else found.unknowns()
    }
    row |= timing(partial(solved, brake, method), unit, first)._asdict()
    try:
        again = timing(found.further, unit, _spent(found.further))
        row |= {"further": again.seconds, "further_ratio": again.ratio}
    except DrumlinError as error:
        row["note"] = f"further load case: {_said(error)}"
    return row | {"memory": memory(brake, method), "status": "converged"}


def _said(error: DrumlinError) -> str:
    return f"{'refused' if isinstance(error, BadInput) else 'failed'}: {error}"


def memory(brake: Brake, method: Method) -> int:
    """Peak memory of a cold solve beyond the loaded program [bytes], in a process of its own."""
    with ProcessPoolExecutor(1, mp_context=_context()) as process:
        return process.submit(_grown, brake, method).result()


@cache
def _context() -> Any:
    """Processes that begin with the program loaded, where the system has such, and with nothing of
    this one.
    """
    if "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload([__name__])
    return context


def _grown(brake: Brake, method: Method) -> int:
    before = peak_memory()
    solved(brake, method)
    return peak_memory() - before


def process_seconds(brake_file: Path, *options: str, repeats: int = TIMED_REPEATS) -> float:
    """Wall-clock seconds of a whole `drumlin solve` of a brake file, from the start of its process;
    the median.
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


def peer_row(
    brake: Brake,
    method: Method,
    truth: Response,
    unit: Callable[[], object],
    repeats: int = TIMED_REPEATS,
) -> dict[str, Any]:
    """The row of a peer, by drumlin.peers; times are those that it states, medians of the repeats,
    ratios to the unit that is timed before each; options `even`: on a mesh that is graded nowhere,
    `layers`: on a `refined_mesh`.
    """
    row: dict[str, Any] = dict(method.case)
    options = dict(method.options)
    even, layers = options.pop("even", False), options.pop("layers", None)
    if even:
        options["mesher"] = partial(
            even_mesh, elements=options["elements"], kind=options.get("kind", DEFAULT_KIND)
        )
    if layers is not None:
        options["mesher"] = partial(refined_mesh, layers=layers, **options)
    start = time.perf_counter()
    answers, beside = [], []
    try:
        for _ in range(repeats):
            beside.append(median(_spent(unit) for _ in range(TIMED_REPEATS)))
            answers.append(peers.solve(PEER_FAMILIES[method.family], brake, **options))
    except DrumlinError as error:
        return row | {"seconds": time.perf_counter() - start, "status": _said(error)}
    samples = [answer.seconds for answer in answers]
    middle, lower, upper = _quartiles(samples)
    return (
        row
        | errors(brake, answers[0].response, truth)
        | {
            "seconds": middle,
            "lower": lower,
            "upper": upper,
            "repeats": repeats,
            "ratio": median(
                answer.seconds / pace for answer, pace in zip(answers, beside, strict=True)
            ),
            "further_ratio": median(
                answer.further_seconds / pace for answer, pace in zip(answers, beside, strict=True)
            ),
            "process": median(answer.process_seconds for answer in answers),
            "further": median(answer.further_seconds for answer in answers),
            "unknowns": answers[0].unknowns,
            "version": answers[0].version,
            "status": "converged",
        }
    )


def enough(
    rows: Iterable[Mapping[str, Any]], key: str, target: float, floors: Mapping[str, float]
) -> list[Any]:
    """The rows whose error `key` is at most `target`, fastest first; of equally fast ones the most
    exact is first.

    Times are compared as ratios to the unit beside them.

    A mesh counts only where every finer one of its series is below the target as well: an error
    that passes through zero is luck. Nothing is claimed below the floor of the reference.
    """
    if target < floors[key]:
        return []
    found = []
    for members in series(rows).values():
        above = [k for k, row in enumerate(members) if row[key] > target]
        found += members[above[-1] + 1 if above else 0 :]
    found.sort(key=lambda row: row["ratio"])
    ties = [row for row in found if row["ratio"] <= EQUAL_TIMES * found[0]["ratio"]]
    return sorted(ties, key=lambda row: row[key]) + found[len(ties) :]


def series(rows: Iterable[Mapping[str, Any]]) -> dict[tuple[str, str], list[Any]]:
    """Converged rows by family and kind, coarse to fine: by unknowns or, where they are not
    counted, by tolerance.
    """
    found: dict[tuple[str, str], list[Any]] = {}
    for row in rows:
        if row["status"] == "converged":
            found.setdefault((row["family"], series_name(row)), []).append(row)
    for members in found.values():
        members.sort(
            key=lambda row: (
                row.get("elements") or row.get("sections") or row.get("level") or 0,
                -(row.get("tolerance") or 0),
            )
        )
    return found


def series_name(row: Mapping[str, Any]) -> str:
    """What a row has in common with the finer and coarser ones of its kind."""
    if row["family"] == "law":
        return str(row["model"])
    if row["family"] == "foundation":
        return "lifted" if row.get("lift") else "as published"
    if row["family"].startswith("columns"):
        return "columns"
    if "penalty" in row:
        return f"{row.get('kind', DEFAULT_KIND)}, {row['penalty']:g} E/t"
    graded = ", even" if row.get("even") else ", refined" if row.get("layers") else ""
    return str(row.get("kind", DEFAULT_KIND)) + (graded if row["family"] in PEER_FAMILIES else "")


def unit_seconds(rows: Iterable[Mapping[str, Any]]) -> float:
    """Seconds of the unit, from the rows' times and ratios; the median."""
    return median(row["seconds"] / row["ratio"] for row in rows if "ratio" in row)


def spread(rows: Iterable[Mapping[str, Any]]) -> float:
    """The interquartile range of the repeats over their median; the median of the rows with TIMED_REPEATS
    or more.
    """
    return median(
        (row["upper"] - row["lower"]) / row["seconds"]
        for row in rows
        if row.get("repeats", 0) >= TIMED_REPEATS
    )
