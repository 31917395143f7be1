"""The prepared model of a brake: its condensed bodies, and what the bodies neglect."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

from drumlin.brake.brake import Brake, Shoe
from drumlin.fem.mesh import beam as beam_mesh
from drumlin.fem.preparation.bodies import BodyNodes, ShoeSubstructure
from drumlin.fem.preparation.cache import shape_key_of_shoe
from drumlin.fem.substructure.interface import ContactLine
from drumlin.fem.substructure.ring import RingSubstructure
from drumlin.laws import rigid

Seconds = dict[str, float]
"""Time [s] that each phase of a solve has taken, by the phase's name."""


@contextmanager
def add_elapsed_time(seconds: Seconds, phase: str) -> Iterator[None]:
    """Add the time [s] that the block of a with statement takes to seconds[phase]."""
    start = time.perf_counter()
    yield
    seconds[phase] = seconds.get(phase, 0.0) + time.perf_counter() - start


class DividedBodies(NamedTuple):
    """The condensed bodies of a brake's shoes, one for each shoe, and of its ring.

    `nodes_of_changed_shoe` divides a changed shoe by the rule that divided these bodies.
    `ring_under_lines` divides a ring under other contact lines likewise; see `PreparedModel`.
    """

    bodies: tuple[ShoeSubstructure, ...]
    ring: RingSubstructure | None
    nodes_of_changed_shoe: Callable[[int, Shoe], BodyNodes]
    ring_under_lines: Callable[[tuple[ContactLine, ...]], RingSubstructure]


@dataclass(frozen=True)
class PreparedModel:
    """The prepared model of a brake: a substructure for each shoe, and one for its ring.

    Attributes
    ----------
    brake : the brake
    bodies : the substructure of each shoe; shoes of one shape share one
    ring : the substructure of the drum's ring; None of a rigid drum
    seconds : time of each phase of the preparation [s]
    left_out : a line for each part of the model that is neglected or not computed
    apart : whether each shoe meets the ring as if the other shoes did not press it
    model : name of the model whose bodies these are
    nodes_of_changed_shoe : function of (i, shoe) that returns the nodes of the body that shoe i
        would have as another shoe, divided by the same rule; None if the bodies cannot be divided
        anew
    ring_under_lines : function of other contact lines that returns the ring under these lines; None
        if the bodies cannot be divided anew
    """

    brake: Brake
    bodies: tuple[ShoeSubstructure, ...]
    ring: RingSubstructure | None
    seconds: Seconds
    left_out: tuple[str, ...]
    apart: bool = False
    model: str = "fem"
    nodes_of_changed_shoe: Callable[[int, Shoe], BodyNodes] | None = None
    ring_under_lines: Callable[[tuple[ContactLine, ...]], RingSubstructure] | None = None

    @cached_property
    def shapes(self) -> list[tuple[object, ...]]:
        """The shape of each shoe, see `shape_key_of_shoe`."""
        return [shape_key_of_shoe(self.brake, shoe) for shoe in self.brake.shoes]

    @cached_property
    def laws(self) -> list[float]:
        """The friction coefficient at which each shoe locks by the rigid-shoe law."""
        return [rigid.locking_friction(self.brake, shoe) for shoe in self.brake.shoes]


def reason_why_not_modelled(brake: Brake) -> str | None:
    """Why finite elements do not apply to a brake; None where they apply."""
    if brake.unmeshable() is not None:
        return brake.unmeshable()
    if brake.ring is not None and len({shoe.side for shoe in brake.shoes}) > 1:
        return "shoes inside and outside of one elastic ring are not modelled"
    if brake.ring is not None and brake.ring.section is None:
        return (
            "its ring has no section to mesh: thickness, "
            "and width and material or bending_stiffness"
        )
    for shoe in brake.shoes:
        reason = beam_mesh.reason_why_not_meshed(shoe, brake.size)
        if reason is not None:
            return f"shoe {shoe.name!r}: {reason}"
    return None


def lines_on_equal_shapes(brake: Brake, shapes: int) -> list[str]:
    """A line on the shoes that share the body of another one; none where all shapes differ.

    shapes: number of different shapes of shoe
    """
    count = len(brake.shoes)
    if shapes == count:
        return []
    return [f"{count - shapes} of {count} shoes: same shape as another, condensed once"]


def lines_on_rigid_parts(brake: Brake) -> list[str]:
    """A line for each elastic part that the brake's file does not have, and that is rigid here."""
    lines = []
    if brake.ring is None and not brake.surface.straight:
        lines.append("drum: rigid, no [drum.ring] in the brake")
    for shoe in brake.shoes:
        if shoe.mesh is None and shoe.body is None:
            lines.append(f"shoe {shoe.name!r}: rigid, no [shoe.body]; only its lining is meshed")
    return lines
