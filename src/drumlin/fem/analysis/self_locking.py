"""Self-locking of an elastic brake: its limit, and the torque at frictions below the limit."""

import math
from collections.abc import Sequence

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake.brake import Brake
from drumlin.contact.self_locking import LARGEST_SOUGHT_FRICTION, Limit
from drumlin.fem.equilibrium.group import groups_of
from drumlin.fem.preparation.scene import Scene


def limits(
    scene: Scene, brake: Brake, most: float = LARGEST_SOUGHT_FRICTION, penalty: float = math.inf
) -> dict[tuple[int, ...], Limit]:
    """The limit of self-locking of each group of shoes, by the positions of its shoes.

    A limit comes earlier where a foot leaves its abutment, or a cam or a strut would have to pull.

    Parameters
    ----------
    scene : the prepared model
    brake : the brake
    most : friction coefficient up to which the limit is looked for
    penalty : factor alpha of the contact stiffness alpha E/t

    Raises
    ------
    NoAnswer
        where a group has no equilibrium, see `ShoeGroup.followed`
    """
    return {group.members: group.followed(most).limit for group in groups_of(scene, brake, penalty)}


def torques(
    scene: Scene, brake: Brake, frictions: Sequence[float], penalty: float = math.inf
) -> Floats:
    """Torque (m, shoes) [N m] of each shoe at growing friction coefficients (m,).

    Each answer starts from the contact set of the one before. Raises NoAnswer at the limit and
    beyond it.
    """
    values = np.zeros((len(frictions), len(brake.shoes)))
    for group in groups_of(scene, brake, penalty):
        at, active = group, None
        for row, mu in zip(values, frictions, strict=True):
            at, contact = at.at_friction(mu).settled(active)
            active = contact.active
            row[list(group.members)] = mu * group.unit_force * (group.levers.T @ contact.p)
    return values
