"""A brake by finite elements from the file up: divided, condensed, solved, finer until its error is small enough."""

from dataclasses import replace
from functools import partial
from typing import Any

from drumlin.brake.drum_brake import Brake
from drumlin.brake.plane_brake import AnyBrake, FlatBrake
from drumlin.brake.unrolled import unrolled, why_not
from drumlin.errors import BadInput
from drumlin.fem.adapt import adapt as adapt_meshes
from drumlin.fem.assembly import ELEMENTS, Cache, prepare
from drumlin.fem.hp.adapt import DEFAULT, adapt
from drumlin.fem.mesh.arc import DEFAULT_KIND
from drumlin.fem.model import PENALTY, check_penalty, respond
from drumlin.fem.omission import adapt_without
from drumlin.response.merit import with_merits
from drumlin.response.response import Response

SOFT = 2.0  # times one over the penalty: the relative error of p that it makes at most, as seen on random brakes


def solve(
    brake: AnyBrake,
    *,
    elements: int | None = None,
    kind: str | None = None,
    tolerance: float | None = None,
    penalty: float = PENALTY,
    cache: Cache | None = None,
) -> Response:
    """Divide, condense and solve a brake, finer and finer until its estimated errors are below a tolerance.

    tolerance: of the estimated relative errors of p (L2, outside the edge zones) and of the torque, of the division and
    of what is left out for it; NoAnswer is raised where it is not reached. By default DEFAULT, or the error that is
    reached. With `elements` a brake is solved on one mesh, without estimate, as one with a mesh file is; with a `kind`
    on meshes of that kind. BadInput is raised for elements and a tolerance together. cache: bodies of earlier solves on
    meshes, see `prepare`.
    """
    if isinstance(brake, FlatBrake):
        reason = why_not(brake)
        if reason is not None:
            raise BadInput(f"fem does not apply to this brake: {reason}")
        found = by_elements(unrolled(brake), elements=elements, kind=kind, tolerance=tolerance, penalty=penalty)
        return with_merits(brake, on_plane(brake, found))
    options: dict[str, Any] = {
        "elements": elements,
        "kind": kind,
        "tolerance": tolerance,
        "penalty": penalty,
        "cache": cache,
    }
    return with_merits(brake, by_elements(brake, **options))


def on_plane(brake: FlatBrake, found: Response) -> Response:
    """A response of the `unrolled` brake in lengths x [m]."""
    unit = brake.shoes[0].lining.end - brake.shoes[0].lining.start
    shoes = tuple(
        replace(
            shoe,
            torque=0.0,
            theta=unit * shoe.theta,
            contact_arcs=tuple((unit * a, unit * b) for a, b in shoe.contact_arcs),
        )
        for shoe in found.shoes
    )
    return replace(found, shoes=shoes, left_out=tuple(line for line in found.left_out if not line.startswith("drum:")))


def by_elements(
    brake: Brake,
    *,
    elements: int | None = None,
    kind: str | None = None,
    tolerance: float | None = None,
    penalty: float = PENALTY,
    cache: Cache | None = None,
) -> Response:
    """`solve` of a brake on a drum, or one `unrolled`, without its figures of merit."""
    check_penalty(penalty)
    answer = partial(respond, penalty=penalty)
    if tolerance is not None and elements is not None:
        raise BadInput(f"--tolerance = {tolerance:g}: chooses the elements; leave out --elements = {elements}")
    if tolerance is not None and kind is not None:  # a studied method
        found = adapt_meshes(brake, tolerance, answer, kind)
    elif tolerance is not None:
        found = adapt_without(brake, tolerance, answer, SOFT / penalty)
    elif elements is None and kind is None and not any(shoe.mesh for shoe in brake.shoes):
        found = adapt(brake, DEFAULT, answer, must=False, soft=SOFT / penalty)
    else:
        elements = ELEMENTS if elements is None else elements
        found = answer(prepare(brake, elements=elements, kind=kind or DEFAULT_KIND, cache=cache), brake)
    return found
