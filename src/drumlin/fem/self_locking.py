"""Self-locking of an elastic brake: its limit, and the torque on the way there."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from drumlin.arrays import Floats
from drumlin.brake.drum_brake import Brake
from drumlin.contact.active_set import settle
from drumlin.contact.self_locking import CLOSE, LARGEST, Limit, limit
from drumlin.fem.assembly import Scene
from drumlin.fem.group import ShoeGroup, groups_of


def limits(
    scene: Scene, brake: Brake, most: float = LARGEST, penalty: float = math.inf
) -> dict[tuple[int, ...], Limit]:
    """The limit of self-locking of each group of shoes that meet the drum together, up to mu = `most`: or where a foot
    leaves its abutment, or a cam or a strut would have to pull, if that comes before.

    Raises NoAnswer where a group has no equilibrium without friction.
    """
    return {
        group.members: _pushing(group, limit(group.sliding, most), most) for group in groups_of(scene, brake, penalty)
    }


def _pushing(group: ShoeGroup, end: Limit, most: float) -> Limit:
    """The limit, or where before it something that can only push would have to pull."""
    smooth = [k for k, shoe in enumerate(group.shoes) if shoe.abutment is not None and shoe.abutment.friction == 0]
    if not smooth and group.sharing is None:
        return end

    def pushes(mu: float) -> bool:
        at = replace(group, brake=group.brake.model_copy(update={"friction": mu}))
        found = settle(sliding.at(mu), end.last.active)
        return all(at.consistent(found, k) for k in smooth) and bool((at.forces(found.p) > 0).all())

    sliding, low, high = group.sliding, 0.0, min(end.reached, most)
    if pushes(high):
        return end
    while high - low > CLOSE * high:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if pushes(middle) else (low, middle)
    return end._replace(friction=low, bounded=True, reached=low)


def torques(scene: Scene, brake: Brake, frictions: Sequence[float], penalty: float = math.inf) -> Floats:
    """Torque of each shoe (m, shoes) [N m] at growing friction coefficients (m,), each from the contact set before.

    Raises NoAnswer at and beyond the limit.
    """
    values = np.zeros((len(frictions), len(brake.shoes)))
    for group in groups_of(scene, brake, penalty):
        problems = group.sliding
        active = None
        for row, mu in zip(values, frictions, strict=True):
            found = settle(problems.at(mu), active)
            active = found.active
            row[list(group.members)] = mu * group.unit_force * (group.levers.T @ found.p)
    return values
