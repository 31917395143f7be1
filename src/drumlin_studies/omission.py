"""What can be left out of a brake, and how much that changes: predicted beforehand on a sketch of
the brake.

A solve leaves none of it out: on columns of high degree the whole brake takes no longer than to
find out what may be. The prediction is the difference between two sketches (reduced.py), one of the
brake and one of what is left of it.
To first order it is the pressure's answer to the gap  F p  that the omitted flexibility F opened under it, so that
it goes as the ratio of stiffnesses; but contact may also open or close, and nothing is calibrated.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import BadInput
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.components import Bar, Beam
from drumlin.fem.error_control.levels import Respond
from drumlin.fem.mesh.arc import shoe_mesh
from drumlin.fem.preparation.bodies import ShoeSubstructure
from drumlin.fem.preparation.prepare import prepare
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.response.norms import pressure_distance
from drumlin.response.response import Response
from drumlin_studies.reduced import sketcher

Make = Callable[[Brake], PreparedModel]


class Omission(NamedTuple):
    """A part that can be left out: its name, what is done instead, and whether a brake has it."""

    name: str
    instead: str
    in_brake: Callable[[Brake], bool]


def _arc(shoe: Shoe) -> bool:
    return shoe.mesh is None and not isinstance(shoe.body, Beam)


OMISSIONS = {
    part.name: part
    for part in (
        Omission("ring", "taken as rigid", lambda brake: brake.ring is not None),
        Omission(
            "coupling",
            "each shoe presses the ring alone",
            lambda brake: brake.ring is not None and len(brake.shoes) > 1,
        ),
        Omission(
            "shoe",
            "taken as rigid",
            lambda brake: any(isinstance(shoe.body, Bar) and _arc(shoe) for shoe in brake.shoes),
        ),
        Omission(
            "backing",
            "left away; the shoe stands behind the lining at once",
            lambda brake: any(shoe.backing is not None and _arc(shoe) for shoe in brake.shoes),
        ),
        Omission(
            "drag",
            "friction acts on the moments, and does not shear what is elastic",
            lambda brake: brake.friction > 0,
        ),
        Omission(
            "curvature",
            "elements with straight edges",
            lambda brake: all(shoe.mesh is None for shoe in brake.shoes),
        ),
    )
}
"""What changes the answer when it is left out. A post's beam and block stay: the one ends where the
other begins.
"""


class OmissionChange(NamedTuple):
    """Relative changes that an omission makes: torque of the brake, p (L2 outside the edge zones,
    worst shoe).

    `shoes`: the changes of the shoes' torques, all counted with one sign, relative to the torque of
    the brake: a bound on its own change, in which they cancel in part; `reaction`: of the hinge
    reactions, the worst; `peak` and `each`: of the peak pressures and of the shoes' own torques,
    the worst.
    """

    torque: float
    pressure: float
    shoes: float
    reaction: float
    peak: float
    each: float


def change(simple: Response, whole: Response) -> OmissionChange:
    """The change from the response of the `whole` brake to that of the simpler one."""
    pairs = list(zip(simple.shoes, whole.shoes, strict=True))
    off = [a.torque - b.torque for a, b in pairs]
    size = whole.torque or 1.0
    return OmissionChange(
        abs(sum(off)) / size,
        max(_pressure(a, b) for a, b in pairs),
        sum(map(abs, off)) / size,
        max(
            _length(a.hinge_reaction - b.hinge_reaction) / (_length(b.hinge_reaction) or 1.0)
            for a, b in pairs
        ),
        max(abs(a.peak_pressure - b.peak_pressure) / (b.peak_pressure or 1.0) for a, b in pairs),
        max(abs(a.torque - b.torque) / (b.torque or 1.0) for a, b in pairs),
    )


def _pressure(a: Any, b: Any) -> float:
    return pressure_distance(a, b) if b.pressure.any() else float(a.pressure.any())


def _length(vector: Floats) -> float:
    return float(np.linalg.norm(vector))


def present(brake: Brake) -> list[str]:
    """Names of what a brake has that can be left out of it."""
    return [name for name, part in OMISSIONS.items() if part.in_brake(brake)]


def simplified(brake: Brake, names: Iterable[str]) -> Brake:
    """The brake without `names`, as far as a brake file says it: ring, shoe, backing."""
    names = set(names)
    if unknown := sorted(names - set(OMISSIONS)):
        raise BadInput(f"{unknown[0]!r}: cannot be left out; allowed: {', '.join(OMISSIONS)}")
    gone = {key: None for name, key in (("shoe", "body"), ("backing", "backing")) if name in names}
    shoes = tuple(shoe.model_copy(update=gone) if _arc(shoe) else shoe for shoe in brake.shoes)
    left = brake.without_ring() if "ring" in names else brake
    return left.model_copy(update={"shoes": shoes})


def scene_without(
    brake: Brake, names: Iterable[str], make: Make = prepare
) -> tuple[PreparedModel, Brake]:
    """The scene that `make` makes of a brake without `names`, and what is left of the brake to
    `respond` for.

    "curvature" depends on the mesh and so is the business of `make`: see `prepare_straight`.
    """
    names = set(names)
    simple = simplified(brake, names)
    if "drag" in names and brake.friction > 0:
        scene = _undragged(make(simple.model_copy(update={"friction": 0.0})), simple)
    else:
        scene = make(simple)
    return replace(scene, apart="coupling" in names), simple


def _undragged(scene: PreparedModel, brake: Brake) -> PreparedModel:
    """A scene prepared for mu = 0, for a brake with friction: under drag nothing gives way."""
    made: dict[int, ShoeSubstructure] = {}
    for body, shoe in zip(scene.bodies, brake.shoes, strict=True):
        if id(body) not in made:
            x, y = body.line.xy - shoe.own_pin[:, None]
            rigid = (
                np.stack([[1 + 0 * x, 0 * x], [0 * x, 1 + 0 * x], [-y, x]])
                .transpose(0, 2, 1)
                .reshape(3, -1)
            )
            held = -rigid @ body.coupling.T.T
            made[id(body)] = replace(
                body,
                closure_by_friction=np.zeros_like(body.closure_by_pressure),
                reaction_to_friction=held,
            )
    ring = scene.ring and replace(
        scene.ring, dragged=tuple(np.zeros_like(d) for d in scene.ring.dragged)
    )
    return replace(
        scene, brake=brake, bodies=tuple(made[id(body)] for body in scene.bodies), ring=ring
    )


def prepare_straight(brake: Brake, *, elements: int) -> PreparedModel:
    """`prepare` on quadratic quadrilaterals with straight edges."""

    import skfem  # noqa: PLC0415  (meshes alone load it)

    def mesher(shoe: Shoe, radius: float) -> Any:
        mesh = shoe_mesh(shoe, radius, elements)
        corners = skfem.MeshQuad(
            np.ascontiguousarray(mesh.p[:, : mesh.nvertices]), mesh.t, validate=False
        )
        straight = skfem.MeshQuad2.from_mesh(corners)
        return replace(straight, _subdomains=mesh.subdomains, _boundaries=mesh.boundaries)

    return prepare(brake, elements=elements, mesher=mesher)


def predict(
    brake: Brake, names: Sequence[str], respond: Respond, sketch: Make | None = None
) -> OmissionChange:
    """What leaving `names` out of a brake changes, predicted on sketches in some milliseconds.

    `sketch`: a sketcher that may have meshed the linings before. Raises NoAnswer where one of the
    two sketches has no equilibrium: then nothing is predicted.
    """
    sketch = sketch or sketcher()
    whole = respond(sketch(brake), brake)
    return change(respond(*scene_without(brake, names, sketch)), whole)
