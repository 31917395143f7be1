"""The prepared model of a brake: its condensed bodies, and messages on what they neglect."""

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.heat import is_any_shoe_heated
from drumlin.fem.hp.division import RefinementLevel, ShoeElementDivision, SingularPoint
from drumlin.fem.mesh import beam as beam_mesh
from drumlin.fem.preparation.bodies import NodePositionsAndActuationForces, ShoeSubstructure
from drumlin.fem.preparation.cache import cache_key_of_shoe_shape
from drumlin.fem.substructure.interface import ContactLine
from drumlin.fem.substructure.ring import RingSubstructure
from drumlin.laws import rigid

SecondsOfEachPhase = dict[str, float]
"""The type of a dictionary with the time [s] of each phase of a solve, by the phase's name."""
SingularPointsByShoeShape = Mapping[int, Sequence[SingularPoint]]
"""The singular points of the pressure for each shape of shoe.

The key is the index of the first shoe of the shape.
"""


@contextmanager
def add_elapsed_time_of_block_to_phase(seconds: SecondsOfEachPhase, phase: str) -> Iterator[None]:
    """Measure the time [s] of the block of a `with` statement, and add it to seconds[phase]."""
    start = time.perf_counter()
    yield
    seconds[phase] = seconds.get(phase, 0.0) + time.perf_counter() - start


class CondensedBodiesOfBrake(NamedTuple):
    """The condensed bodies of a brake: one for each shoe, and one for the drum's ring.

    The function `nodes_of_changed_shoe` divides a changed shoe into elements by the rule by which
    these bodies were divided. The function `ring_under_contact_lines` divides the ring by the same
    rule for other contact lines of the shoes. `PreparedModel` explains both functions. `divisions`
    has the divisions into hp elements, by the index of the first shoe of each shape; it is empty
    for meshes.
    """

    bodies: tuple[ShoeSubstructure, ...]
    ring: RingSubstructure | None
    nodes_of_changed_shoe: Callable[[int, Shoe], NodePositionsAndActuationForces]
    ring_under_contact_lines: Callable[[tuple[ContactLine, ...]], RingSubstructure]
    divisions: Mapping[int, ShoeElementDivision] = {}


@dataclass(frozen=True)
class LockingFrictionsOfRigidShoes:
    """The friction coefficients at which the shoes of a brake lock by the rigid-shoe law.

    They are computed when they are first asked for. On anchors this takes longer than on hinges, so
    that the prepared models of all levels of a solve share one object of this class.

    `brake` is the brake.
    """

    brake: Brake

    @cached_property
    def with_motion_of_file(self) -> list[float]:
        """The coefficient for each shoe, while the drum turns as in the brake file."""
        return rigid.self_locking_frictions_of_rigid_shoes(self.brake)

    @cached_property
    def with_reversed_motion(self) -> list[float]:
        """The coefficient for each shoe, while the drum turns the other way."""
        return rigid.self_locking_frictions_of_rigid_shoes(self.brake.brake_with_reversed_motion())


@dataclass(frozen=True)
class PreparedModel:
    """The prepared model of a brake: a substructure for each shoe, and one for the drum's ring.

    Attributes
    ----------
    brake : the brake
    bodies : the substructure of each shoe; shoes of one shape share one substructure
    ring : the substructure of the drum's ring; None for a rigid drum
    seconds : time of each phase of the preparation [s]
    left_out : a message for each effect or part that the model neglects or does not compute
    apart : whether each shoe deforms the elastic ring as if no other shoe pressed on the ring
    model : name of the model whose bodies these are: "fem" (plane stress) or "solid" (with widths)
    nodes_of_changed_shoe : function of an index i and a changed shoe that returns the nodes of the
        body that shoe i would have after the change, divided by the same rule; None if the bodies
        cannot be divided anew
    ring_under_contact_lines : function of other contact lines of the shoes that returns the
        substructure of the ring under these lines; None if the bodies cannot be divided anew
    divisions : division into hp elements by the index of the first shoe of each shape; empty for
        meshes
    level : degree of hp elements, and sizes at singular points; None if every shoe without a mesh
        file has a parametric mesh
    points : singular points of the pressure at which the elements of this level are small, by the
        index of the first shoe of each shape
    rigid_limits : friction coefficients at which the rigid shoes lock, which the levels of a solve
        share; None for a model of its own
    """

    brake: Brake
    bodies: tuple[ShoeSubstructure, ...]
    ring: RingSubstructure | None
    seconds: SecondsOfEachPhase
    left_out: tuple[str, ...]
    apart: bool = False
    model: str = "fem"
    nodes_of_changed_shoe: Callable[[int, Shoe], NodePositionsAndActuationForces] | None = None
    ring_under_contact_lines: Callable[[tuple[ContactLine, ...]], RingSubstructure] | None = None
    divisions: Mapping[int, ShoeElementDivision] = field(default_factory=dict)
    level: RefinementLevel | None = None
    points: SingularPointsByShoeShape = field(default_factory=dict)
    rigid_limits: LockingFrictionsOfRigidShoes | None = None

    @cached_property
    def cache_keys_of_shoe_shapes(self) -> list[tuple[object, ...]]:
        """The key of each shoe's shape; shoes that share a condensed body have equal keys."""
        return [cache_key_of_shoe_shape(self.brake, shoe) for shoe in self.brake.shoes]

    @cached_property
    def locking_frictions_of_rigid_shoes(self) -> LockingFrictionsOfRigidShoes:
        """The friction coefficients at which the shoes lock by the rigid-shoe law."""
        return self.rigid_limits or LockingFrictionsOfRigidShoes(self.brake)


def reason_against_finite_element_model(brake: Brake) -> str | None:
    """The reason why finite elements do not apply to a brake; None if they apply."""
    if brake.reason_why_shoes_cannot_be_meshed() is not None:
        return brake.reason_why_shoes_cannot_be_meshed()
    if brake.ring is not None and len({shoe.side for shoe in brake.shoes}) > 1:
        return "shoes inside and outside of one elastic ring are not modelled"
    if brake.ring is not None and brake.ring.section is None:
        return (
            "its ring has no section to mesh: thickness, "
            "and width and material or bending_stiffness"
        )
    if (
        brake.actuation is not None
        and brake.actuation.is_cam_or_wedge
        and is_any_shoe_heated(brake)
    ):
        return "a cam on heated shoes is not modelled: its travel would count their growth as well"
    for shoe in brake.shoes:
        reason = beam_mesh.reason_why_beam_shoe_cannot_be_meshed(shoe, brake.size)
        if reason is not None:
            return f"shoe {shoe.name!r}: {reason}"
    return None


def messages_on_shoes_of_equal_shape(brake: Brake, shapes: int) -> list[str]:
    """A message on the shoes that share the body of another shoe, as a list.

    The list is empty if all shoes have different shapes. `shapes` is the number of different
    shapes.
    """
    count = len(brake.shoes)
    if shapes == count:
        return []
    return [f"{count - shapes} of {count} shoes: same shape as another, condensed once"]


def messages_on_rigid_parts(brake: Brake) -> list[str]:
    """A message for each part that is rigid because the brake file gives no elastic data of it."""
    lines = []
    if brake.ring is None and not brake.surface.is_plane_and_not_drum:
        lines.append("drum: rigid, no [drum.ring] in the brake")
    for shoe in brake.shoes:
        if shoe.mesh is None and shoe.body is None:
            lines.append(f"shoe {shoe.name!r}: rigid, no [shoe.body]; only its lining is meshed")
    return lines
