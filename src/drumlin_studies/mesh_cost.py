"""Compare time and true error of solves on a mesh file, by drumlin, GetFEM and CalculiX.

    make mesh_cost             a mesh of some 10 000 nodes
    make mesh_cost ARGS=4.4    elements of 4.4 mm, some 2 500 nodes
    make mesh_cost ARGS="1.12 1"   linear elements of 1.12 mm, some 10 000 nodes

Gmsh meshes a shoe of the main example with triangles of one size. They are quadratic with curved
sides, or linear if the second argument is 1. drumlin solves the file in two ways: to a tolerance of
0.5 % with stated errors, and with elements of the file's own degree. GetFEM and CalculiX solve the
elements of the same file. The true errors are differences from a solution of the same shoe in hp
elements, without the file. The command prints a row for each solve. All times are processor times
on one thread. The times of drumlin include reading the file. The times of GetFEM and CalculiX do
not include it, because drumlin reads the file for them.
"""

import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

from drumlin.base.errors import BadInput, NoAnswer
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
    path: Path, size: float, order: int = 2
) -> tuple[Brake, Brake]:
    """Mesh the first shoe of the main example, and write the mesh file at `path`.

    Returns the brake with only this shoe, and the same brake with the mesh file as its shoe. `size`
    is the size of the elements [m], and `order` their order.
    """
    shoes = example("double_shoe").shoes
    brake = vary(example("double_shoe"), {"shoe": [shoes[0].model_dump()]})
    form = ElementKindAndGradingOfGmshMesh(order, straight=order == 1, recombined=False)
    write_gmsh_mesh_of_shoe(brake, form, size, path)
    return brake, vary(brake, {"shoe.mesh": str(path), "shoe.mesh_unit": "mm"})


def costs_of_solves_on_mesh_file(
    brake: Brake, filed: Brake
) -> Iterator[CostAndErrorsOfMeshFileSolve]:
    """Yield the cost and errors of each way to solve a brake whose shoe is a mesh file.

    `filed` is the brake with the mesh file. `brake` is the same brake without it, which gives the
    true errors.
    """
    known = solve(brake, tolerance=TOLERANCE_OF_HP_TRUTH)

    def cost_of_solve_with_true_errors(
        way: str, response: Response, seconds: float
    ) -> CostAndErrorsOfMeshFileSolve:
        """The cost of a way to solve, with the stated error and the true errors of its response."""
        true = true_errors_of_response(filed, response.shoes, known.shoes)
        stated = response.error["pressure"] if response.error else None
        return CostAndErrorsOfMeshFileSolve(way, seconds, true["pressure"], true["torque"], stated)

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
        yield cost_of_solve_with_true_errors(way, response, min(seconds))
    for name, written in NAMES_OF_PEER_PROGRAMS.items():
        try:
            peer = solve_brake_by_calculix_or_getfem(name, filed)
        except (BadInput, NoAnswer) as error:
            print(f"{written}: {error}", file=sys.stderr)  # noqa: T201
            continue
        yield cost_of_solve_with_true_errors(written, peer.response, peer.process_seconds)


def main(words: Sequence[str]) -> int:
    """Print the table of costs.

    The first of the `words` is the size of the elements [mm], and the second their order. Both are
    optional.
    """
    size = float(words[0]) if words else DEFAULT_ELEMENT_SIZE_IN_MM
    order = int(words[1]) if len(words) > 1 else 2
    with tempfile.TemporaryDirectory() as folder:
        brake, filed = write_mesh_and_return_brakes_of_main_example(
            Path(folder) / "shoe.msh", 1e-3 * size, order
        )
        print("way                     seconds  error of p  stated  error of the torque")  # noqa: T201
        for row in costs_of_solves_on_mesh_file(brake, filed):
            stated = "none" if row.stated is None else f"{100 * row.stated:.2g} %"
            print(  # noqa: T201
                f"{row.way:22s}  {row.seconds:7.2f}  {100 * row.pressure:8.2g} %  {stated:>6s}  "
                f"{100 * row.torque:.2g} %",
                flush=True,
            )
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
