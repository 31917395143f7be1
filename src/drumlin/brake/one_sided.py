"""One-sided supports: anchors, abutments and struts that push on a shoe and cannot pull.

A solve finds out which of the supports bear. The force and the opening of a support are not
negative, and one of them is zero, as at a contact node of a lining.
"""

import itertools
import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import BadInput
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.components import Actuation
from drumlin.brake.fields import Point
from drumlin.brake.support import SupportedShoe, work_of_force_in_rigid_body_motions

LARGEST_ROUND_OFF_PULL_OF_SUPPORT = 1e-9
"""Largest pull of a support that counts as round-off, relative to the largest force of the brake.

A larger pull means that the support does not bear. An overlap of shoe and support counts as
round-off up to the same fraction of the largest displacement. The value is far above the round-off
of an equilibrium, 1e-12, and far below any force in a brake file.
"""
LARGEST_SINGULAR_VALUE_OF_REDUNDANT_SUPPORT = 1e-9
"""Singular value [m] at or below which one of the bearing supports of a shoe is redundant.

The value is the smallest singular value of a matrix. The matrix has the opening of each bearing
support in each rigid-body motion, and each motion displaces points by about 1 m. If the value is
above the limit, c supports prevent c independent motions. The limit is a judgement: far above
round-off, below any lever arm of a brake.
"""


LARGEST_ROUND_OFF_CONTACT_FORCE = 1e-9
"""Largest contact force of a shoe that counts as round-off, relative to the largest force on it.

Supports alone may hold a shoe, for example if a return spring is stronger than the wheel cylinder.
The lining then has no pressure, and the solution of the contact problem leaves round-off in its
place, 1e-16 to 1e-12 of the forces. A shoe with a smaller contact force than the limit does not
press on the drum. The limit is a judgement: far above round-off, below any force of use.
"""


ERROR_TEXT_ON_SHOE_THAT_IS_NOT_HELD = (
    "no equilibrium, on no choice of its one-sided supports do pushes balance the actuation"
)
"""Error text for a shoe that its anchors, abutments and struts cannot hold by pushing."""


class SupportPushOnShoe(NamedTuple):
    """The push of a one-sided support on one shoe.

    `shoe` is the index of the shoe in the brake, `push_of_one_newton` a force of 1 N with its line
    of action.
    """

    shoe: int
    push_of_one_newton: Actuation


class OneSidedSupport(NamedTuple):
    """A support that can push and not pull: an anchor, an abutment or a strut.

    Attributes
    ----------
    name : text that names the support in messages
    sides : the push on each shoe that bears on the support: one push for a fixed face, two for a
        strut
    clearance : opening of the support while nothing acts [m]
    """

    name: str
    sides: tuple[SupportPushOnShoe, ...]
    clearance: float

    @property
    def is_strut(self) -> bool:
        """Whether the support is a strut between two shoes."""
        return len(self.sides) == 2


def one_sided_supports_of_brake(brake: Brake) -> tuple[OneSidedSupport, ...]:
    """The one-sided supports of a brake: abutment and anchors of each shoe that has anchors.

    A strut between two such shoes is one support in place of the abutments of both.
    """
    numbers = {shoe.name: i for i, shoe in enumerate(brake.shoes)}
    found, on_strut = [], set()
    for link in brake.links:
        ends = [brake.shoes[numbers[name]] for name in (link.source, link.to)]
        if not all(shoe.anchors for shoe in ends):
            continue
        sides = []
        for shoe in ends:
            assert shoe.abutment is not None
            on_strut.add(shoe.name)
            push = _force_of_one_newton_at_point(shoe.abutment.point, shoe.abutment.direction)
            sides.append(SupportPushOnShoe(numbers[shoe.name], push))
        name = f"the strut from {link.source!r} to {link.to!r}"
        found.append(OneSidedSupport(name, tuple(sides), 0.0))
    for i, shoe in enumerate(brake.shoes):
        if not shoe.anchors:
            continue
        if shoe.abutment is not None and shoe.name not in on_strut:
            push = _force_of_one_newton_at_point(shoe.abutment.point, shoe.abutment.direction)
            side = SupportPushOnShoe(i, push)
            found.append(OneSidedSupport(f"the abutment of {shoe.name!r}", (side,), 0.0))
        for j, anchor in enumerate(shoe.anchors):
            number = f" {j + 1}" if len(shoe.anchors) > 1 else ""
            side = SupportPushOnShoe(
                i, _force_of_one_newton_at_point(anchor.point, anchor.direction)
            )
            name = f"anchor{number} of {shoe.name!r}"
            found.append(OneSidedSupport(name, (side,), anchor.clearance))
    return tuple(found)


def groups_of_shoes_on_anchors(brake: Brake) -> list[tuple[int, ...]]:
    """The indices of the shoes on anchors, in groups.

    Two shoes with a strut between them are one group, any other shoe is a group of its own.
    """
    groups: list[tuple[int, ...]] = []
    joined: dict[int, tuple[int, ...]] = {}
    for support in one_sided_supports_of_brake(brake):
        if support.is_strut:
            ends = tuple(sorted(side.shoe for side in support.sides))
            joined |= dict.fromkeys(ends, ends)
    for i, shoe in enumerate(brake.shoes):
        group = joined.get(i, (i,))
        if shoe.anchors and group not in groups:
            groups.append(group)
    return groups


def unit_forces_of_one_sided_supports_on_shoe(brake: Brake, name: str) -> list[Actuation]:
    """A force of 1 N by each one-sided support on the shoe `name`, in the order of the supports."""
    found = []
    for support in one_sided_supports_of_brake(brake):
        found += [
            side.push_of_one_newton for side in support.sides if brake.shoes[side.shoe].name == name
        ]
    return found


def _force_of_one_newton_at_point(point: Point, direction: float) -> Actuation:
    """A force of 1 N at a point in a direction [rad]."""
    return Actuation(force=1.0, direction=direction, point=point)


class OneSidedSupportForce(NamedTuple):
    """The force of a one-sided support on a shoe in a solution; 0 if the shoe has left the support.

    `name` is the text that names the support, `push` the force [N] with its line of action.
    """

    name: str
    push: Actuation


BearingFlagsOfOneSidedSupports = tuple[bool, ...]
"""Whether each one-sided support bears on its shoes, in the order of the supports."""


def all_choices_of_bearing_supports(
    count: int, first: BearingFlagsOfOneSidedSupports = ()
) -> Iterator[BearingFlagsOfOneSidedSupports]:
    """Yield every combination of bearing and open supports, for `count` supports.

    Each combination comes once, and the combination `first` before all others.
    """
    if first:
        yield first
    for bearing in itertools.product((True, False), repeat=count):
        if bearing != first:
            yield bearing


def forces_of_one_sided_supports_on_shoe(
    supports: Sequence[OneSidedSupport], forces: Floats, shoe: int
) -> tuple[OneSidedSupportForce, ...]:
    """The forces of the supports on which a shoe bears or could bear.

    `forces` (m,) [N] are the forces of all supports, and `shoe` is the index of the shoe. A
    negative force would be a pull. Such a force is 0 with a round-off error, and is set to 0.
    """
    found = []
    for support, force in zip(supports, np.maximum(forces, 0.0).tolist(), strict=True):
        for side in support.sides:
            if side.shoe == shoe:
                push = side.push_of_one_newton.model_copy(update={"force": force})
                found.append(OneSidedSupportForce(support.name, push))
    return tuple(found)


def work_of_support_push_in_rigid_body_modes(shoe: SupportedShoe, push: Actuation) -> Floats:
    """The work (k,) of a support's push in each rigid-body mode of a shoe.

    For a push of 1 N the work is also the distance by which the support opens, per unit of each
    mode.
    """
    return work_of_force_in_rigid_body_motions(
        shoe.rigid_body_modes_of_support().motions, push.force_vector, push.point.xy
    )


class HeldAndFreeRigidBodyMotions(NamedTuple):
    """The rigid-body motions that c bearing supports prevent, and the motions that they allow.

    Each column of both matrices is a motion: the amounts of the k rigid-body modes in it.

    Attributes
    ----------
    free : (k, k - c), motions that open or close none of the bearing supports
    held : (k, c), motions; motion j opens bearing support j by 1 m and no other bearing support
    """

    free: Floats
    held: Floats


def divide_motions_into_held_and_free(
    opening: Floats, sizes: Floats
) -> HeldAndFreeRigidBodyMotions | None:
    """Divide the motions of a group of shoes into c that supports prevent and k - c free motions.

    The result is None if a support is redundant: then c supports prevent fewer than c motions.

    Parameters
    ----------
    opening : (c, k), opening of each bearing support per unit of each rigid-body mode
    sizes : (k,), amount of each rigid-body mode that displaces points of the brake by about 1 m
    """
    count = len(opening)
    if count > len(sizes):
        return None
    if not count:
        return HeldAndFreeRigidBodyMotions(np.diag(sizes), np.zeros((len(sizes), 0)))
    left, values, right = np.linalg.svd(opening * sizes)
    if values.min() <= LARGEST_SINGULAR_VALUE_OF_REDUNDANT_SUPPORT:
        return None
    held = sizes[:, None] * right[:count].T @ (left / values).T
    return HeldAndFreeRigidBodyMotions(sizes[:, None] * right[count:].T, held)


def first_redundant_supports(opening: Floats, sizes: Floats) -> tuple[int, ...]:
    """The indices of the fewest supports that prevent one motion twice; () without such supports.

    Parameters
    ----------
    opening : (m, k), opening of each support per unit of each rigid-body mode
    sizes : (k,), amount of each rigid-body mode that displaces points of the brake by about 1 m
    """
    for count in range(2, len(sizes) + 1):
        for chosen in itertools.combinations(range(len(opening)), count):
            if divide_motions_into_held_and_free(opening[list(chosen)], sizes) is None:
                return chosen
    return ()


def do_linings_resist_free_motions(closing: Floats, scale: float) -> bool:
    """Whether the linings resist every motion that the bearing supports leave free.

    A motion that closes no gap, such as a turn about the drum's centre, meets no resistance.

    Parameters
    ----------
    closing : (n, k), decrease of the gap at n points of the linings in each of k free motions
    scale : largest decrease of a gap in a motion that displaces points of the brake by about 1 m
    """
    values = np.linalg.svd(closing, compute_uv=False)
    return bool(values.min(initial=math.inf) > LARGEST_SINGULAR_VALUE_OF_REDUNDANT_SUPPORT * scale)


def require_no_shoe_on_anchors(brake: Brake, what: str) -> None:
    """Raise BadInput if a shoe of the brake rests on anchors; `what` names the computation."""
    for i, shoe in enumerate(brake.shoes):
        if shoe.anchors:
            raise BadInput(
                f"shoe[{i}].anchor: {what} takes no shoes that can leave their supports, "
                f"as shoe {shoe.name!r} can"
            )


def error_text_on_shoes_without_contact_force(brake: Brake, members: Sequence[int]) -> str:
    """The error text for shoes that their supports hold although no lining presses on the drum.

    The text names the actuation forces and the springs. `members` are the indices of the shoes in
    the brake.
    """
    shoes = [brake.shoes[i] for i in members]
    names = {shoe.name for shoe in shoes}
    forces = [
        f"actuation {shoe.actuation.force:.6g} N on {shoe.name!r}"
        for shoe in shoes
        if shoe.actuation.force
    ]
    springs = [
        f"spring[{i}] with a preload of {spring.preload:.6g} N"
        + (f" and a rate of {spring.rate * 1e-3:.6g} N/mm" if spring.rate else "")
        for i, spring in enumerate(brake.springs)
        if names & {spring.shoe, spring.to}
    ]
    cause = "the net force presses no shoe against"
    if springs:
        cause = "the springs hold every shoe off"
    return (
        f"{brake.text_with_names_of_shoes_at_indices(members)}: no contact, {cause} the "
        f"{brake.surface.name}: {', '.join([*forces, *springs]) or 'no actuation force'}"
    )


def note_on_shoe_held_off_by_its_supports(shoe: Shoe) -> str:
    """The note on a shoe without contact force that its supports hold, while other shoes press."""
    return (
        f"shoe {shoe.name!r}: no contact, its loads hold it off the {shoe.surface.name}, "
        "on its supports"
    )


def text_with_names_of_bearing_supports(
    supports: Sequence[OneSidedSupport], bearing: BearingFlagsOfOneSidedSupports
) -> str:
    """The names of the supports that bear, as a text; "none" if no support bears."""
    names = [support.name for support, bears in zip(supports, bearing, strict=True) if bears]
    return ", ".join(names) or "none"
