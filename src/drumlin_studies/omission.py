"""What can be neglected in a brake, and the change that this makes, predicted on a sketch.

A solve neglects nothing: with hp elements the whole brake takes no longer than the decision what
may be neglected. A sketch is a coarse model of the brake (`reduced`). The prediction is the
difference between the sketches of the whole brake and of the simpler brake. To first order it is
the response of the pressure to the gap F p that the neglected flexibility F would open, so that it
grows with the ratio of stiffnesses. Contact may open or close in the sketches as well, and no
factor is calibrated.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.errors import BadInput
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.components import Bar, Beam
from drumlin.fem.error_control.levels import ResponseFunction
from drumlin.fem.mesh.arc import shoe_mesh
from drumlin.fem.preparation.bodies import ShoeSubstructure
from drumlin.fem.preparation.prepare import prepare
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.response.norms import pressure_distance
from drumlin.response.response import Response, ShoeResponse
from drumlin_studies.reduced import surrogate_maker

Make = Callable[[Brake], PreparedModel]
"""A function that prepares a brake."""


class Omission(NamedTuple):
    """A part that can be neglected: the model in its place, and whether a brake has the part."""

    instead: str
    in_brake: Callable[[Brake], bool]


def _body_follows_drum(shoe: Shoe) -> bool:
    """Whether the body of a shoe follows the drum: neither a mesh of its own nor a beam."""
    return shoe.mesh is None and not isinstance(shoe.body, Beam)


def _has_elastic_bar(brake: Brake) -> bool:
    """Whether a shoe of the brake has an elastic body that follows the drum."""
    return any(isinstance(shoe.body, Bar) and _body_follows_drum(shoe) for shoe in brake.shoes)


def _has_backing(brake: Brake) -> bool:
    """Whether a shoe of the brake that follows the drum has a backing."""
    return any(shoe.backing is not None and _body_follows_drum(shoe) for shoe in brake.shoes)


OMISSIONS = {
    "ring": Omission("a rigid drum", lambda brake: brake.ring is not None),
    "coupling": Omission(
        "each shoe presses on the ring as if it were the only shoe",
        lambda brake: brake.ring is not None and len(brake.shoes) > 1,
    ),
    "shoe": Omission("a rigid arc of the shoe", _has_elastic_bar),
    "backing": Omission("no backing; the shoe begins directly behind the lining", _has_backing),
    "drag": Omission(
        "friction only in the balance of moments; friction shears no elastic body",
        lambda brake: brake.friction > 0,
    ),
    "curvature": Omission(
        "elements with straight edges",
        lambda brake: all(shoe.mesh is None for shoe in brake.shoes),
    ),
}
"""The parts whose neglect changes the answer, by name.

The beam and the block of a post cannot be neglected, because the beam ends where the block begins.
"""


class OmissionChange(NamedTuple):
    """Relative changes by an omission; of several shoes the largest change counts.

    Attributes
    ----------
    torque : float
        Change of the brake's torque.
    pressure : float
        L2 change of p outside the edge zones.
    shoes : float
        Sum of the absolute changes of the shoes' torques over the brake's torque. It bounds
        `torque`, in which they partly cancel.
    reaction, peak : float
        Change of the hinge reaction and of the peak pressure.
    each : float
        Change of a shoe's torque over this torque.
    """

    torque: float
    pressure: float
    shoes: float
    reaction: float
    peak: float
    each: float


def omission_change(simple: Response, whole: Response) -> OmissionChange:
    """The change from the response of the whole brake to that of the simpler brake."""
    torques, pressures, reactions, peaks, each = [], [], [], [], []
    # Where the shoe of the whole brake has no torque, peak or reaction, the change itself counts.
    for a, b in zip(simple.shoes, whole.shoes, strict=True):
        torques.append(a.torque - b.torque)
        each.append(abs(a.torque - b.torque) / (b.torque or 1.0))
        pressures.append(_pressure_change(a, b))
        reaction = float(np.linalg.norm(b.hinge_reaction)) or 1.0
        reactions.append(float(np.linalg.norm(a.hinge_reaction - b.hinge_reaction)) / reaction)
        peaks.append(abs(a.peak_pressure - b.peak_pressure) / (b.peak_pressure or 1.0))
    size = whole.torque or 1.0
    return OmissionChange(
        torque=abs(sum(torques)) / size,
        pressure=max(pressures),
        shoes=sum(map(abs, torques)) / size,
        reaction=max(reactions),
        peak=max(peaks),
        each=max(each),
    )


def _pressure_change(a: ShoeResponse, b: ShoeResponse) -> float:
    """Relative L2 change of p from shoe b to shoe a; 1 where only shoe a presses."""
    return pressure_distance(a, b) if b.pressure.any() else float(a.pressure.any())


def parts_present(brake: Brake) -> list[str]:
    """Names of the parts of a brake that can be neglected."""
    return [name for name, part in OMISSIONS.items() if part.in_brake(brake)]


def simplified_brake(brake: Brake, names: Iterable[str]) -> Brake:
    """The brake without some of the parts ring, shoe and backing.

    The other parts of OMISSIONS are no parts of a brake file: see `scene_without`.
    """
    names = set(names)
    if unknown := sorted(names - set(OMISSIONS)):
        raise BadInput(f"{unknown[0]!r}: cannot be left out; allowed: {', '.join(OMISSIONS)}")
    gone: dict[str, None] = {}
    if "shoe" in names:
        gone["body"] = None
    if "backing" in names:
        gone["backing"] = None
    shoes = []
    for shoe in brake.shoes:
        # A mesh of its own and the beam of a post cannot do without these parts.
        shoes.append(shoe.model_copy(update=gone) if _body_follows_drum(shoe) else shoe)
    left = brake.without_ring() if "ring" in names else brake
    return left.model_copy(update={"shoes": tuple(shoes)})


def scene_without(
    brake: Brake, names: Iterable[str], make: Make = prepare
) -> tuple[PreparedModel, Brake]:
    """The prepared model of a brake without some parts, and the simpler brake itself.

    Parameters
    ----------
    brake : Brake
        The whole brake.
    names : iterable of str
        Names of OMISSIONS. "curvature" is a matter of the mesh: see `prepare_straight`.
    make : function
        Prepares a brake.
    """
    names = set(names)
    simple = simplified_brake(brake, names)
    # A model without friction has no friction to deform it.
    if "drag" in names and brake.friction > 0:
        scene = _scene_without_friction(make(simple.model_copy(update={"friction": 0.0})), simple)
    else:
        scene = make(simple)
    return replace(scene, apart="coupling" in names), simple


def _scene_without_friction(scene: PreparedModel, brake: Brake) -> PreparedModel:
    """A model that is prepared without friction, for a brake with friction.

    Friction then acts on the balance of moments and causes no deformation.
    """
    made: dict[int, ShoeSubstructure] = {}
    bodies = []
    for body, shoe in zip(scene.bodies, brake.shoes, strict=True):
        if id(body) not in made:
            x, y = body.line.xy - shoe.own_pin[:, None]
            # Rigid-body modes of the contact nodes: along x, along y, and turn about the pin.
            modes = np.stack([[1 + 0 * x, 0 * x], [0 * x, 1 + 0 * x], [-y, x]])
            rigid = modes.transpose(0, 2, 1).reshape(3, -1)
            made[id(body)] = replace(
                body,
                closure_by_friction=np.zeros_like(body.closure_by_pressure),
                reaction_to_friction=-rigid @ body.coupling.T.T,
            )
        # Shoes that share a body go on sharing it.
        bodies.append(made[id(body)])
    ring = scene.ring
    if ring is not None:
        ring = replace(
            ring,
            friction_half_flexibilities=tuple(map(np.zeros_like, ring.friction_half_flexibilities)),
        )
    return replace(scene, brake=brake, bodies=tuple(bodies), ring=ring)


def prepare_straight(brake: Brake, *, elements: int) -> PreparedModel:
    """The prepared model of a brake on quadratic quadrilaterals with straight edges."""
    import skfem  # noqa: PLC0415  (meshes alone load it)

    def mesh_with_straight_edges(shoe: Shoe, radius: float) -> Any:
        """The mesh of a shoe with straight edges between its corners."""
        mesh = shoe_mesh(shoe, radius, elements)
        corners = skfem.MeshQuad(
            np.ascontiguousarray(mesh.p[:, : mesh.nvertices]), mesh.t, validate=False
        )
        straight = skfem.MeshQuad2.from_mesh(corners)
        return replace(straight, _subdomains=mesh.subdomains, _boundaries=mesh.boundaries)

    return prepare(brake, elements=elements, mesher=mesh_with_straight_edges)


def predict_omission_change(
    brake: Brake, names: Sequence[str], respond: ResponseFunction, sketch: Make | None = None
) -> OmissionChange:
    """The change by an omission, predicted on sketches in some milliseconds.

    Parameters
    ----------
    brake : Brake
        The whole brake.
    names : sequence of str
        Names of OMISSIONS.
    respond : function
        The response of a prepared model.
    sketch : function, optional
        A sketcher, which may have meshed the linings already.

    Raises
    ------
    NoAnswer
        One of the two sketches has no equilibrium.
    """
    sketch = sketch or surrogate_maker()
    whole = respond(sketch(brake), brake)
    return omission_change(respond(*scene_without(brake, names, sketch)), whole)
