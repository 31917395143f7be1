"""A brake by finite elements from the file up: meshed, condensed, solved, adapted to a tolerance where one is given."""

from functools import partial

from drumlin.brake.drum_brake import Brake
from drumlin.errors import BadInput
from drumlin.fem.assembly import ELEMENTS, Cache, prepare
from drumlin.fem.mesh.arc import DEFAULT_KIND
from drumlin.fem.model import PENALTY, respond
from drumlin.fem.omission import adapt_without
from drumlin.response.merit import with_merits
from drumlin.response.response import Response


def solve(
    brake: Brake,
    *,
    elements: int | None = None,
    kind: str = DEFAULT_KIND,
    tolerance: float | None = None,
    penalty: float = PENALTY,
    cache: Cache | None = None,
) -> Response:
    """Mesh, condense and solve a brake: prepare, then respond; with a `tolerance` on meshes adapted to it.

    tolerance: of the estimated relative errors of p (L2, outside the edge zones) and of the torque, of the mesh and
    of what is left out for it. Raises NoAnswer where it is not reached, BadInput where `elements` are given too.
    cache: bodies of earlier solves, see `prepare`.
    """
    if tolerance is None:
        scene = prepare(brake, elements=ELEMENTS if elements is None else elements, kind=kind, cache=cache)
        return with_merits(brake, respond(scene, brake, penalty=penalty))
    if elements is not None:
        raise BadInput(f"--tolerance = {tolerance:g}: chooses the elements; leave out --elements = {elements}")
    return with_merits(brake, adapt_without(brake, tolerance, partial(respond, penalty=penalty), kind))
