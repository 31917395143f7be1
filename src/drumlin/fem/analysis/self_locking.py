"""Self-locking of an elastic brake: its limit, and the torque on the way there."""

import math
from collections.abc import Sequence

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake.brake import Brake
from drumlin.contact.self_locking import LARGEST, Limit
from drumlin.fem.equilibrium.group import groups_of
from drumlin.fem.preparation.scene import PreparedModel


def limits(
    scene: PreparedModel, brake: Brake, most: float = LARGEST, penalty: float = math.inf
) -> dict[tuple[int, ...], Limit]:
    """The limit of self-locking of each group of shoes that meet the drum together, up to mu =
    `most`: or where a foot leaves its abutment, or a cam or a strut would have to pull, if that
    comes before.

    Raises NoAnswer where a group has no equilibrium, see `ShoeGroup.followed`.
    """
    return {group.members: group.followed(most).limit for group in groups_of(scene, brake, penalty)}


def torques(
    scene: PreparedModel, brake: Brake, frictions: Sequence[float], penalty: float = math.inf
) -> Floats:
    """Torque of each shoe (m, shoes) [N m] at growing friction coefficients (m,), each from the
    contact set before.

    Raises NoAnswer at and beyond the limit.
    """
    values = np.zeros((len(frictions), len(brake.shoes)))
    for group in groups_of(scene, brake, penalty):
        at, active = group, None
        for row, mu in zip(values, frictions, strict=True):
            at, found = at.at_friction(mu).settled(active)
            active = found.active
            row[list(group.members)] = mu * group.unit_force * (group.levers.T @ found.p)
    return values
