"""Compare time and true error of solves on a mesh file, by drumlin, GetFEM and CalculiX.

    make mesh_cost             a mesh of some 10 000 nodes
    make mesh_cost ARGS=4.4    elements of 4.4 mm, some 2 500 nodes
    make mesh_cost ARGS="1.12 1"   linear elements of 1.12 mm, some 10 000 nodes
    make mesh_cost ARGS="2.25 2 equal"   the peers on finer and finer meshes, some 25 minutes

Gmsh meshes a shoe of the main example with triangles of one size. They are quadratic with curved
sides, or linear if the second argument is 1. drumlin solves the file in two ways: to a tolerance of
0.5 % with stated errors, and with elements of the file's own degree. GetFEM and CalculiX solve the
elements of the same file. The true errors are differences from a solution of the same shoe in hp
elements, without the file. The command prints a row for each solve. All times are processor times
on one thread. The times of drumlin include reading the file. The times of GetFEM and CalculiX do
not include it, because drumlin reads the file for them.

With the word "equal" GetFEM and CalculiX also solve finer meshes of the same shoe, with elements of
one size, and "graded" with elements of a quarter of this size along the lining. The meshes become
finer until the error is at most that of drumlin's answer with a stated error on the first mesh. The
command then prints how many times as long as this answer they take.
"""

import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

from drumlin.base.errors import BadInput, NoAnswer
from drumlin.base.threads import one_blas_thread_unless_user_set_number
from drumlin.brake.brake import Brake
from drumlin.brake.file import vary
from drumlin.door import example
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.solve import solve
from drumlin.peers import NAMES_OF_PEER_PROGRAMS, solve_brake_by_calculix_or_getfem
from drumlin.response.response import Response
from drumlin_studies.mesh_degrees import (
    TOLERANCE_OF_HP_TRUTH,
    ElementKindAndGradingOfGmshMesh,
    write_gmsh_mesh_of_shoe,
)
from drumlin_studies.stated_true import true_errors_of_response

DEFAULT_ELEMENT_SIZE_IN_MM = 2.25
"""Size of the elements [mm] if the command line gives none: the mesh has some 10 000 nodes."""
TOLERANCE_OF_MESH_FILE_SOLVE = 5e-3
"""Relative tolerance to which drumlin solves the mesh file with stated errors."""
NUMBER_OF_TIMED_SOLVES_OF_MESH_FILE = 3
"""Number of times that drumlin solves the mesh file in each way.

The shortest of these times counts, because the first solve also loads modules.
"""


SIZE_RATIO_OF_SUCCESSIVE_MESHES_FOR_PEERS = 0.5**0.5
"""Size of the elements of each finer mesh for the peers, relative to the mesh before.

The number of nodes doubles from mesh to mesh.
"""
LONGEST_SOLVE_BY_PEER_BEFORE_FINER_MESH = 60.0
"""Processor time [s] of a peer's solve above which no finer mesh is tried.

drumlin needs some 0.3 s for the answer that the peers are compared with.
"""


class CostAndErrorsOfMeshFileSolve(NamedTuple):
    """The cost and the errors of one way to solve a mesh file.

    Attributes
    ----------
    way : name of the program and of its way to solve
    seconds : processor time [s]
    pressure, torque : true relative errors of p (L2) and of the torque
    stated : stated relative error of p; None where no error is stated
    """

    way: str
    seconds: float
    pressure: float
    torque: float
    stated: float | None = None


def write_mesh_and_return_brakes_of_main_example(
    path: Path, size: float, order: int = 2, *, graded: bool = False
) -> tuple[Brake, Brake]:
    """Mesh the first shoe of the main example, and write the mesh file at `path`.

    Returns the brake with only this shoe, and the same brake with the mesh file as its shoe. `size`
    is the size of the elements [m], and `order` their order. If `graded` is True, the elements
    along the lining have a quarter of this size.
    """
    shoes = example("double_shoe").shoes
    brake = vary(example("double_shoe"), {"shoe": [shoes[0].model_dump()]})
    form = ElementKindAndGradingOfGmshMesh(
        order, straight=order == 1, recombined=False, fine_contact=graded
    )
    write_gmsh_mesh_of_shoe(brake, form, size, path)
    return brake, vary(brake, {"shoe.mesh": str(path), "shoe.mesh_unit": "mm"})


def solve_without_mesh_file_for_true_errors(brake: Brake) -> Response:
    """The response of a brake in hp elements, which serves as the truth."""
    return solve(brake, tolerance=TOLERANCE_OF_HP_TRUTH)


def cost_of_solve_with_true_errors(
    way: str, filed: Brake, response: Response, seconds: float, known: Response
) -> CostAndErrorsOfMeshFileSolve:
    """The cost of a way to solve, with the stated error and the true errors of its response.

    Parameters
    ----------
    way : name of the program and of its way to solve
    filed : the brake with the mesh file
    response : the response of this way
    seconds : its processor time [s]
    known : response that serves as the truth
    """
    true = true_errors_of_response(filed, response.shoes, known.shoes)
    stated = response.error["pressure"] if response.error else None
    return CostAndErrorsOfMeshFileSolve(way, seconds, true["pressure"], true["torque"], stated)


def costs_of_solves_on_mesh_file(
    filed: Brake, known: Response
) -> Iterator[CostAndErrorsOfMeshFileSolve]:
    """Yield the cost and errors of each way to solve a brake whose shoe is a mesh file.

    `filed` is the brake with the mesh file, and `known` the response that serves as the truth.
    """
    ways: dict[str, Callable[[], Response]] = {
        "drumlin, stated error": lambda: solve(filed, tolerance=TOLERANCE_OF_MESH_FILE_SOLVE),
        "drumlin, file's degree": lambda: solve_prepared_model(make_prepared_model(filed), filed),
    }
    for way, respond in ways.items():
        seconds = []
        for _ in range(NUMBER_OF_TIMED_SOLVES_OF_MESH_FILE):
            start = time.process_time()
            response = respond()
            seconds.append(time.process_time() - start)
        yield cost_of_solve_with_true_errors(way, filed, response, min(seconds), known)
    for name, written in NAMES_OF_PEER_PROGRAMS.items():
        try:
            peer = solve_brake_by_calculix_or_getfem(name, filed)
        except (BadInput, NoAnswer) as error:
            print(f"{written}: {error}", file=sys.stderr)  # noqa: T201
            continue
        yield cost_of_solve_with_true_errors(
            written, filed, peer.response, peer.process_seconds, known
        )


def costs_of_peer_on_finer_meshes(
    name: str,
    path: Path,
    size: float,
    order: int,
    graded: bool,
    aim: CostAndErrorsOfMeshFileSolve,
    known: Response,
) -> Iterator[CostAndErrorsOfMeshFileSolve]:
    """Yield the cost and errors of a peer on finer and finer meshes of the main example's shoe.

    The meshes end when one of them has had at most the error of p of `aim`, and one at most its
    error of the torque, or after a solve of LONGEST_SOLVE_BY_PEER_BEFORE_FINER_MESH.

    Parameters
    ----------
    name : name of the peer
    path : path of the mesh file, which is written anew
    size : size of the elements of the first mesh [m]
    order : order of the elements
    graded : whether elements along the lining are smaller than others
    aim : cost and errors of drumlin's answer, with which the peer is compared
    known : response that serves as the truth
    """
    rest = {"pressure", "torque"}
    seconds = 0.0
    while rest and seconds < LONGEST_SOLVE_BY_PEER_BEFORE_FINER_MESH:
        _, filed = write_mesh_and_return_brakes_of_main_example(path, size, order, graded=graded)
        peer = solve_brake_by_calculix_or_getfem(name, filed)
        seconds = peer.process_seconds
        ends = ", graded" if graded else ""
        way = f"{NAMES_OF_PEER_PROGRAMS[name]}, {1e3 * size:.2g} mm{ends}"
        row = cost_of_solve_with_true_errors(way, filed, peer.response, seconds, known)
        rest = {key for key in rest if getattr(row, key) > getattr(aim, key)}
        size *= SIZE_RATIO_OF_SUCCESSIVE_MESHES_FOR_PEERS
        yield row


def text_of_peer_at_error_of_drumlin(
    peer: str,
    quantity: str,
    rows: Sequence[CostAndErrorsOfMeshFileSolve],
    aim: CostAndErrorsOfMeshFileSolve,
    error: float,
) -> str:
    """How many times as long as drumlin a peer takes for an error of a quantity, as a line.

    Parameters
    ----------
    peer : written name of the peer
    quantity : "pressure" or "torque"
    rows : cost and errors of the peer on all its meshes; the fastest one counts
    aim : cost and errors of drumlin's answer
    error : relative error that the peer has to reach
    """
    reached = [row for row in rows if getattr(row, quantity) <= error]
    what = f"{100 * error:.2g} % of the {quantity}"
    if not reached:
        nearest = min(getattr(row, quantity) for row in rows)
        longest = max(row.seconds for row in rows)
        return f"{peer}: {what} is not reached in {longest:.0f} s, nearest {100 * nearest:.2g} %"
    best = min(reached, key=lambda row: row.seconds)
    ratio = best.seconds / aim.seconds
    return f"{peer}: {what} in {best.seconds:.2f} s, {ratio:.1f} times as long ({best.way})"


def print_costs_of_peers_at_errors_of_drumlin(
    folder: Path, size: float, order: int, aim: CostAndErrorsOfMeshFileSolve, known: Response
) -> None:
    """Print the costs of the peers on finer meshes, and their times for the errors of drumlin.

    `folder` is a folder for mesh files. The other arguments are those of
    `costs_of_peer_on_finer_meshes`.
    """
    for name, written in NAMES_OF_PEER_PROGRAMS.items():
        rows = []
        for graded in (False, True):
            path = folder / "finer.msh"
            finer = costs_of_peer_on_finer_meshes(name, path, size, order, graded, aim, known)
            try:
                for row in finer:
                    print_cost_and_errors(row)
                    rows.append(row)
            except (BadInput, NoAnswer) as error:
                print(f"{written}: {error}", file=sys.stderr)  # noqa: T201
        errors = (
            ("pressure", TOLERANCE_OF_MESH_FILE_SOLVE),
            ("pressure", aim.pressure),
            ("torque", aim.torque),
        )
        for quantity, reached in errors if rows else ():
            print(text_of_peer_at_error_of_drumlin(written, quantity, rows, aim, reached))  # noqa: T201


def print_cost_and_errors(row: CostAndErrorsOfMeshFileSolve) -> None:
    """Print a row of the table of costs."""
    stated = "none" if row.stated is None else f"{100 * row.stated:.2g} %"
    print(  # noqa: T201
        f"{row.way:26s}  {row.seconds:7.2f}  {100 * row.pressure:8.2g} %  {stated:>6s}  "
        f"{100 * row.torque:.2g} %",
        flush=True,
    )


def main(words: Sequence[str]) -> int:
    """Print the table of costs.

    The first of the `words` is the size of the elements [mm], and the second their order. With the
    third word "equal" the peers also solve finer meshes. All are optional.
    """
    size = float(words[0]) if words else DEFAULT_ELEMENT_SIZE_IN_MM
    order = int(words[1]) if len(words) > 1 else 2
    with one_blas_thread_unless_user_set_number(), tempfile.TemporaryDirectory() as folder:
        brake, filed = write_mesh_and_return_brakes_of_main_example(
            Path(folder) / "shoe.msh", 1e-3 * size, order
        )
        known = solve_without_mesh_file_for_true_errors(brake)
        print("way                         seconds  error of p  stated  error of the torque")  # noqa: T201
        rows = []
        for row in costs_of_solves_on_mesh_file(filed, known):
            print_cost_and_errors(row)
            rows.append(row)
        if "equal" in words:
            print_costs_of_peers_at_errors_of_drumlin(
                Path(folder), 1e-3 * size, order, rows[0], known
            )
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
