"""Self-locking of an elastic brake: its limit, and the torque on the way there."""

import math
from collections.abc import Sequence

import numpy as np

from drumlin.arrays import Floats
from drumlin.brake.drum_brake import Brake
from drumlin.contact.active_set import settle
from drumlin.contact.self_locking import LARGEST, Limit, Sliding, limit
from drumlin.fem.assembly import Scene
from drumlin.fem.model import at_friction, groups_of, unit_force


def sliding(scene: Scene, brake: Brake, group: list[int], penalty: float = math.inf) -> Sliding:
    """Full slip of a group of shoes at every friction coefficient; the scene must be prepared with friction."""
    return Sliding.through(*(at_friction(scene, brake, group, penalty, friction) for friction in (0.0, 1.0)))


def limits(
    scene: Scene, brake: Brake, most: float = LARGEST, penalty: float = math.inf
) -> dict[tuple[int, ...], Limit]:
    """The limit of self-locking of each group of shoes that meet the drum together, up to mu = `most`.

    Raises NoAnswer where a group has no equilibrium without friction.
    """
    return {tuple(group): limit(sliding(scene, brake, group, penalty), most) for group in groups_of(scene, brake)}


def torques(scene: Scene, brake: Brake, frictions: Sequence[float], penalty: float = math.inf) -> Floats:
    """Torque of each shoe (m, shoes) [N m] at growing friction coefficients (m,), each from the contact set before.

    Raises NoAnswer at and beyond the limit.
    """
    values = np.zeros((len(frictions), len(brake.shoes)))
    for group in groups_of(scene, brake):
        problems, size = sliding(scene, brake, group, penalty), unit_force(brake, group)
        levers = [scene.bodies[i].coupling.lever for i in group]
        active = None
        for row, mu in zip(values, frictions, strict=True):
            found = settle(problems.at(mu), active)
            active = found.active
            parts = np.split(found.p, np.cumsum([len(lever) for lever in levers])[:-1])
            row[group] = [mu * size * float(lever @ p) for lever, p in zip(levers, parts, strict=True)]
    return values
