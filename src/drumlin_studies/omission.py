"""Omissions: parts of a brake that a simpler model neglects, and how this changes the answer.

An omission replaces for example the elastic drum ring by a rigid drum.
`relative_change_from_whole_to_simpler_brake` compares the answers of the simpler and of the whole
brake. `predict_response_change_by_omitting_parts` predicts the same change on two surrogates, which
are coarse models of the whole and of the simpler brake (`reduced`). To first order the change is
the response of the brake to the additional gap F p. F p is the displacement that the pressure p
would cause by the neglected flexibility F. The surrogates also contain the change of the contact.
The prediction has no factor that is fitted to data.

A normal solve of drumlin omits no part of the brake. To predict the change by an omission would
take as long as the solve of the whole brake.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.errors import BadInput
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.components import BeamBody, ShoeBodyOfConstantSection
from drumlin.fem.error_control.levels import FunctionThatComputesResponse
from drumlin.fem.mesh.arc import parametric_mesh_of_shoe
from drumlin.fem.preparation.bodies import ShoeSubstructure
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.response.norms import relative_distance_of_pressures
from drumlin.response.response import Response, ShoeResponse
from drumlin_studies.reduced import make_function_that_prepares_surrogates

PrepareModelOfBrake = Callable[[Brake], PreparedModel]
"""A function that returns the prepared model of a brake: meshed and condensed, not yet solved."""


class OmittablePartOrEffect(NamedTuple):
    """A part or effect that can be neglected.

    Attributes
    ----------
    instead : str
        The simpler model in place of the part, in words.
    does_brake_have_part : function
        Returns whether a brake has the part.
    """

    instead: str
    does_brake_have_part: Callable[[Brake], bool]


def _is_body_an_arc_along_drum(shoe: Shoe) -> bool:
    """Whether the body of a shoe is an arc along the drum, not a straight beam or a mesh file."""
    return shoe.mesh is None and not isinstance(shoe.body, BeamBody)


def _has_shoe_with_elastic_arc_body(brake: Brake) -> bool:
    """Whether a shoe of the brake has an elastic body in the form of an arc along the drum."""
    return any(
        isinstance(shoe.body, ShoeBodyOfConstantSection) and _is_body_an_arc_along_drum(shoe)
        for shoe in brake.shoes
    )


def _has_shoe_with_backing(brake: Brake) -> bool:
    """Whether a shoe of the brake has a backing behind its lining, and its body is no beam.

    Shoes with a mesh file do not count.
    """
    return any(
        shoe.backing is not None and _is_body_an_arc_along_drum(shoe) for shoe in brake.shoes
    )


OMITTABLE_PARTS_AND_EFFECTS_BY_NAME = {
    "ring": OmittablePartOrEffect("a rigid drum", lambda brake: brake.ring is not None),
    "coupling": OmittablePartOrEffect(
        "each shoe presses on the ring as if it were the only shoe",
        lambda brake: brake.ring is not None and len(brake.shoes) > 1,
    ),
    "shoe": OmittablePartOrEffect("a rigid arc of the shoe", _has_shoe_with_elastic_arc_body),
    "backing": OmittablePartOrEffect(
        "no backing; the shoe begins directly behind the lining", _has_shoe_with_backing
    ),
    "drag": OmittablePartOrEffect(
        "friction only in the balance of moments; friction shears no elastic body",
        lambda brake: brake.friction > 0,
    ),
    "curvature": OmittablePartOrEffect(
        "elements with straight edges",
        lambda brake: all(shoe.mesh is None for shoe in brake.shoes),
    ),
}
"""Parts and effects that can be neglected in the model of a brake, by name.

"drag" is the deformation of the elastic bodies by friction. The shoe of a post brake is a straight
beam with a block between beam and lining. The beam ends where the block begins. Therefore neither
beam nor block can be left out.
"""


class RelativeResponseChangesByOmission(NamedTuple):
    """Relative changes of an answer by an omission.

    All changes are taken without sign. `pressure`, `reaction`, `peak` and `each` belong to the shoe
    with the largest change.

    Attributes
    ----------
    torque : float
        Change of the brake's torque.
    pressure : float
        L2 norm of the change of the pressure p, outside the zones at the lining's ends.
    shoes : float
        Sum of the absolute changes of the shoes' torques, divided by the brake's torque. The sum is
        an upper bound of `torque`, in which changes of opposite sign cancel.
    reaction, peak : float
        Change of the hinge reaction and of the peak pressure.
    each : float
        Change of the torque of a shoe, divided by the torque of the same shoe.
    """

    torque: float
    pressure: float
    shoes: float
    reaction: float
    peak: float
    each: float


def relative_change_from_whole_to_simpler_brake(
    simple: Response, whole: Response
) -> RelativeResponseChangesByOmission:
    """Relative changes from the whole brake's response to the simpler brake's response."""
    torques, pressures, reactions, peaks, each = [], [], [], [], []
    # If torque, peak or reaction of the whole brake is zero, the absolute change takes the place of
    # the relative change.
    for a, b in zip(simple.shoes, whole.shoes, strict=True):
        torques.append(a.torque - b.torque)
        each.append(abs(a.torque - b.torque) / (b.torque or 1.0))
        pressures.append(_relative_pressure_change_of_shoe(a, b))
        reaction = float(np.linalg.norm(b.hinge_reaction)) or 1.0
        reactions.append(float(np.linalg.norm(a.hinge_reaction - b.hinge_reaction)) / reaction)
        peaks.append(abs(a.peak_pressure - b.peak_pressure) / (b.peak_pressure or 1.0))
    size = whole.torque or 1.0
    return RelativeResponseChangesByOmission(
        torque=abs(sum(torques)) / size,
        pressure=max(pressures),
        shoes=sum(map(abs, torques)) / size,
        reaction=max(reactions),
        peak=max(peaks),
        each=max(each),
    )


def _relative_pressure_change_of_shoe(a: ShoeResponse, b: ShoeResponse) -> float:
    """L2 distance between the pressures of responses a and b of a shoe, over the L2 norm of b's.

    If the shoe has no contact in response b, the result is 1 with contact in response a, and 0
    without.
    """
    return relative_distance_of_pressures(a, b) if b.pressure.any() else float(a.pressure.any())


def names_of_omissions_possible_for_brake(brake: Brake) -> list[str]:
    """Names of the OMITTABLE_PARTS_AND_EFFECTS_BY_NAME that a brake has."""
    return [
        name
        for name, part in OMITTABLE_PARTS_AND_EFFECTS_BY_NAME.items()
        if part.does_brake_have_part(brake)
    ]


def brake_without_neglected_parts(brake: Brake, names: Iterable[str]) -> Brake:
    """The brake without drum ring, shoe bodies or backings, as far as `names` has their names.

    The names of the parts are "ring", "shoe" and "backing". The other names of
    OMITTABLE_PARTS_AND_EFFECTS_BY_NAME change no data of the brake, but the prepared model: see
    `prepared_model_and_brake_without_neglected_parts`. Raises BadInput if a name is not in
    OMITTABLE_PARTS_AND_EFFECTS_BY_NAME.
    """
    names = set(names)
    if unknown := sorted(names - set(OMITTABLE_PARTS_AND_EFFECTS_BY_NAME)):
        raise BadInput(
            f"{unknown[0]!r}: cannot be left out; allowed: "
            f"{', '.join(OMITTABLE_PARTS_AND_EFFECTS_BY_NAME)}"
        )
    gone: dict[str, None] = {}
    if "shoe" in names:
        gone["body"] = None
    if "backing" in names:
        gone["backing"] = None
    shoes = []
    for shoe in brake.shoes:
        # A shoe with a mesh file or with a straight beam keeps its body and its backing.
        shoes.append(shoe.model_copy(update=gone) if _is_body_an_arc_along_drum(shoe) else shoe)
    left = brake.brake_without_ring() if "ring" in names else brake
    return left.model_copy(update={"shoes": tuple(shoes)})


def prepared_model_and_brake_without_neglected_parts(
    brake: Brake, names: Iterable[str], make: PrepareModelOfBrake = make_prepared_model
) -> tuple[PreparedModel, Brake]:
    """The prepared model of a brake without some parts or effects, and the simpler brake.

    Parameters
    ----------
    brake : Brake
        The whole brake.
    names : iterable of str
        Names of OMITTABLE_PARTS_AND_EFFECTS_BY_NAME. The name "curvature" has no effect here:
        `make` must be `prepare_model_with_straight_element_edges` for elements with straight edges.
    make : function
        Returns the prepared model of a brake.
    """
    names = set(names)
    simple = brake_without_neglected_parts(brake, names)
    # If "drag" is neglected, friction deforms no body. The model is then prepared without friction.
    # Friction is added to the balance of forces and moments only.
    if "drag" in names and brake.friction > 0:
        scene = _prepared_model_without_deformation_by_friction(
            make(simple.model_copy(update={"friction_as_written": 0.0})), simple
        )
    else:
        scene = make(simple)
    return replace(scene, apart="coupling" in names), simple


def _prepared_model_without_deformation_by_friction(
    scene: PreparedModel, brake: Brake
) -> PreparedModel:
    """A prepared model for a brake with friction in which friction causes no deformation.

    Friction acts on the balance of forces and moments of each shoe only.

    scene : the prepared model of the same brake without friction; brake : the brake with friction.
    """
    made: dict[int, ShoeSubstructure] = {}
    bodies = []
    for body, shoe in zip(scene.bodies, brake.shoes, strict=True):
        if id(body) not in made:
            x, y = body.line.xy - shoe.pin_position_in_shoe_frame[:, None]
            # Rigid-body modes of the contact nodes: translation along x, along y, and rotation
            # about the pin.
            modes = np.stack([[1 + 0 * x, 0 * x], [0 * x, 1 + 0 * x], [-y, x]])
            rigid = modes.transpose(0, 2, 1).reshape(3, -1)
            by_pressure = body.flexibility.gap_closure_by_pressure
            flexibility = body.flexibility._replace(
                gap_closure_by_friction=np.zeros_like(by_pressure),
                reaction_to_friction=-rigid @ body.coupling.T.T,
            )
            made[id(body)] = replace(body, flexibility=flexibility)
        # Shoes of equal shape still share one condensed body.
        bodies.append(made[id(body)])
    ring = scene.ring
    if ring is not None:
        ring = replace(
            ring,
            friction_half_flexibilities=tuple(map(np.zeros_like, ring.friction_half_flexibilities)),
        )
    return replace(scene, brake=brake, bodies=tuple(bodies), ring=ring)


def prepare_model_with_straight_element_edges(brake: Brake, *, elements: int) -> PreparedModel:
    """The prepared model of a brake whose quadratic elements have straight edges.

    elements : number of elements along each lining.
    """
    import skfem  # noqa: PLC0415  (meshes alone load it)

    def mesh_with_straight_edges(shoe: Shoe, radius: float) -> Any:
        """The mesh of a shoe with straight lines between the corners of each element."""
        mesh = parametric_mesh_of_shoe(shoe, radius, elements)
        corners = skfem.MeshQuad(
            np.ascontiguousarray(mesh.p[:, : mesh.nvertices]), mesh.t, validate=False
        )
        straight = skfem.MeshQuad2.from_mesh(corners)
        return replace(straight, _subdomains=mesh.subdomains, _boundaries=mesh.boundaries)

    return make_prepared_model(brake, elements=elements, mesher=mesh_with_straight_edges)


def predict_response_change_by_omitting_parts(
    brake: Brake,
    names: Sequence[str],
    respond: FunctionThatComputesResponse,
    sketch: PrepareModelOfBrake | None = None,
) -> RelativeResponseChangesByOmission:
    """The relative change of the answer by omissions, predicted with two coarse models.

    Parameters
    ----------
    brake : Brake
        The whole brake.
    names : sequence of str
        Names of OMITTABLE_PARTS_AND_EFFECTS_BY_NAME.
    respond : function
        Returns the response of a prepared model and a brake.
    sketch : function, optional
        Returns the surrogate of a brake. `reduced.make_function_that_prepares_surrogates` makes
        this function, which keeps the meshes of the linings for later calls.

    Raises
    ------
    NoAnswer
        The surrogate of the whole or of the simpler brake has no equilibrium.
    """
    sketch = sketch or make_function_that_prepares_surrogates()
    whole = respond(sketch(brake), brake)
    return relative_change_from_whole_to_simpler_brake(
        respond(*prepared_model_and_brake_without_neglected_parts(brake, names, sketch)), whole
    )
