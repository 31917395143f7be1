"""Friction limits of self-locking of an elastic brake, and the torques below these limits."""

import math
from collections.abc import Sequence

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake.brake import Brake
from drumlin.brake.friction import require_friction_independent_of_pressure
from drumlin.brake.further_loads import require_springs_with_constant_pull
from drumlin.contact.self_locking import LARGEST_SOUGHT_FRICTION, FrictionLimit
from drumlin.fem.equilibrium.group import divide_pressed_shoes_into_groups
from drumlin.fem.preparation.scene import PreparedModel


def self_locking_friction_of_shoe_groups(
    scene: PreparedModel,
    brake: Brake,
    most: float = LARGEST_SOUGHT_FRICTION,
    penalty: float = math.inf,
) -> dict[tuple[int, ...], FrictionLimit]:
    """The smallest friction coefficient at which each group of shoes locks itself.

    The keys of the result are the positions of the group's shoes in the brake. If a foot leaves its
    abutment at a smaller friction, or a cam or a strut would have to pull there, this smaller
    friction is the limit.

    Parameters
    ----------
    scene : the prepared model
    brake : the brake
    most : friction coefficient up to which the limit is sought
    penalty : factor alpha of the contact stiffness alpha E/t (lining modulus E, thickness t)

    Raises
    ------
    NoAnswer
        if a group has no equilibrium at any friction
    """
    require_springs_with_constant_pull(brake, "self-locking")
    require_friction_independent_of_pressure(brake, "self-locking")
    return {
        group.members: group.find_friction_limit_by_following_contact(most).limit
        for group in divide_pressed_shoes_into_groups(scene, brake, penalty)
    }


def shoe_torques_at_friction_coefficients(
    scene: PreparedModel, brake: Brake, frictions: Sequence[float], penalty: float = math.inf
) -> Floats:
    """The torque (m, shoes) [N m] of each shoe at m friction coefficients in growing order.

    Raises NoAnswer if a friction coefficient reaches or exceeds the limit of self-locking.
    """
    require_springs_with_constant_pull(brake, "self-locking")
    require_friction_independent_of_pressure(brake, "self-locking")
    values = np.zeros((len(frictions), len(brake.shoes)))
    for group in divide_pressed_shoes_into_groups(scene, brake, penalty):
        at, active = group, None
        # The nodes in contact at one friction coefficient are the first guess for the contact at
        # the next one.
        for row, mu in zip(values, frictions, strict=True):
            at, contact = at.copy_of_group_with_other_drum_friction(
                mu
            ).solve_contact_and_abutment_friction(active)
            active = contact.active
            row[list(group.members)] = (
                mu
                * group.largest_actuation_force
                * (group.torque_of_each_shoe_per_nodal_pressure.T @ contact.p)
            )
    return values
