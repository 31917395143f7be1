"""Meshes adapted until the estimated errors of pressure and torque are below a tolerance.

The first mesh is coarse. Each further one has GROWTH times as many elements along the arc and one layer more
through the lining, is graded to the lining's edges and to the ends of the contact that the mesh before it
found, and starts from its contact set.

The estimate. Let e_k be the error of mesh k and d_k the distance between the meshes k - 1 and k. If errors
fall by the factor r from mesh to mesh, then d_k >= e_(k-1) - e_k = (r - 1) e_k, so that

    e_k <= d_k / (r - 1),   r = d_(k-1) / d_k  as observed, from SLOWEST to FASTEST.

FASTEST is the order 2.5 in the number of elements that quadratic elements have for the pressure at best. Where
d falls faster, by chance or because the contact's ends have just been found, d_(k-1) / FASTEST stands for d_k.
So an estimate takes three meshes.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np

from drumlin.brake import clearance
from drumlin.brake.drum_brake import Brake, Shoe
from drumlin.errors import NoAnswer
from drumlin.fem.assembly import Scene, prepare, shape_of
from drumlin.fem.hp.adapt import check_tolerance, last_of
from drumlin.fem.hp.levels import Respond
from drumlin.fem.mesh.arc import DEFAULT_KIND, shoe_mesh
from drumlin.fem.mesh.grading import Division, refine
from drumlin.response.norms import pressure_distance
from drumlin.response.response import Response, ShoeResponse

FIRST_ELEMENTS, FIRST_LAYERS = 24, 4
GROWTH = 1.5
SLOWEST, FASTEST = 1.5, GROWTH**2.5
MOST_MESHES = 9
MOST_UNKNOWNS = 300_000  # of a body; beyond it the next mesh would take minutes

Divide = Callable[..., Division]
Points = dict[tuple[object, ...], list[float]]


def adapt(brake: Brake, tolerance: float, respond: Respond, kind: str = DEFAULT_KIND) -> Response:
    """The response whose estimated errors of p and of the torque are at most `tolerance` (relative).

    Raises NoAnswer, saying what was reached, where the meshes that are allowed do not suffice; BadInput for a
    tolerance out of range and for a brake with a mesh file, which cannot be refined.
    """
    check_tolerance(brake, tolerance)
    responses: list[Response] = []
    error: dict[str, float] = {}
    unknowns = 0
    for level in range(MOST_MESHES):
        last = responses[-1] if responses else None
        scene = _scene(brake, level, last, kind)
        responses.append(respond(scene, brake, start=last))
        unknowns = max(body.unknowns for body in scene.bodies)
        if level > 1:
            error = estimate(responses[-3:])
            if max(error.values()) <= tolerance:
                return replace(last_of(responses, unknowns), error=error)
        if error and unknowns * GROWTH**2 > MOST_UNKNOWNS:
            break
    raise NoAnswer(
        f"tolerance {tolerance:g} not reached on {len(responses)} meshes of up to {unknowns} unknowns a shoe: "
        f"estimated error of p {error['pressure']:.1e}, of the torque {error['torque']:.1e}"
    )


def estimate(responses: Sequence[Response]) -> dict[str, float]:
    """Estimated relative errors of the last of three responses, each on a finer mesh than the one before."""
    shoes = range(len(responses[-1].shoes))
    steps = [[_pressure_step(a.shoes[i], b.shoes[i]) for a, b in pairwise(responses)] for i in shoes]
    torque = responses[-1].torque
    torque_steps = [abs(b.torque - a.torque) / torque if torque else 0.0 for a, b in pairwise(responses)]
    return {"pressure": max(_limit(*pair) for pair in steps), "torque": _limit(*torque_steps)}


def _pressure_step(a: ShoeResponse, b: ShoeResponse) -> float:
    if not b.pressure.any():
        return 1.0 if a.pressure.any() else 0.0
    return pressure_distance(a, b)


def _limit(before: float, last: float) -> float:
    """Estimated error from the last two distances between successive meshes."""
    last = max(last, before / FASTEST)
    return last / (max(before / last, SLOWEST) - 1) if last else 0.0


def _scene(brake: Brake, level: int, response: Response | None, kind: str) -> Scene:
    """Mesh number `level`."""
    elements = round(FIRST_ELEMENTS * GROWTH**level)
    divide = partial(refine, elements=elements, layers=FIRST_LAYERS + level)
    return scene_refined(brake, response, divide, kind, elements)


def scene_refined(brake: Brake, response: Response | None, divide: Divide, kind: str, elements: int) -> Scene:
    """The scene on linings divided by `divide`(shoe, radius, points=places where the pressure is not smooth).

    response: whose contact ends are such places; elements: of a ring. Shoes of one shape share a mesh, refined at
    the contact ends of them all.
    """
    points: Points = {}
    for i, shoe in enumerate(brake.shoes):
        found = _points(shoe, None if response is None else response.shoes[i])
        points.setdefault(shape_of(brake, shoe), []).extend(found)

    def mesher(shoe: Shoe, radius: float) -> Any:
        return shoe_mesh(shoe, radius, divide(shoe, radius, points=sorted(points[shape_of(brake, shoe)])), kind)

    return prepare(brake, elements=elements, mesher=mesher)


def _points(shoe: Shoe, response: ShoeResponse | None) -> list[float]:
    """Angles phi inside the lining where its pressure is not smooth: ends of the contact, kinks of the clearance."""
    theta = [end for arc in response.contact_arcs for end in arc] if response is not None else []
    theta += clearance.kinks(shoe.lining)
    phi = shoe.frame.phi(np.array(theta))
    start, end = shoe.arc
    return [float(angle) for angle in phi if start < angle < end]
