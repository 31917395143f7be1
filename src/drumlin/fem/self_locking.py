"""Self-locking of an elastic brake: its limit, and the torque on the way there."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from drumlin.arrays import Floats
from drumlin.brake.drum_brake import Brake
from drumlin.contact.active_set import settle
from drumlin.contact.self_locking import CLOSE, LARGEST, STEP, Limit, limit
from drumlin.errors import NoAnswer
from drumlin.fem.assembly import Scene
from drumlin.fem.group import ShoeGroup, groups_of

NOTHING = 1e-9  # of the largest force: what a shoe is pushed by that is not pushed
FINE = STEP / 4  # of mu, between frictions at which it is asked what pushes: an answer that comes back is not reached


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
    if group.sharing is None and all(shoe.abutment is None for shoe in group.shoes):
        return end

    def pushes(mu: float) -> bool:
        try:
            at, found = replace(group, brake=group.brake.model_copy(update={"friction": mu})).settled()
        except NoAnswer:
            return False
        forces = at.forces(found.p)
        return bool((forces > NOTHING * forces.max()).all())

    low, last = 0.0, min(end.reached, most)
    while low < last:  # up to the first friction at which it does not: further on it may again
        high = min(low + FINE * max(1.0, low), last)
        if not pushes(high):
            break
        low = high
    else:
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
