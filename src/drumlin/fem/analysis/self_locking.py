"""Friction limits of self-locking of an elastic brake, and the torques below these limits."""

import math
from collections.abc import Sequence

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import BadInput
from drumlin.brake.brake import Brake
from drumlin.brake.friction import (
    first_key_of_pressure_dependent_friction,
    require_friction_independent_of_pressure,
)
from drumlin.brake.further_loads import require_springs_with_constant_pull
from drumlin.contact.self_locking import (
    LARGEST_SOUGHT_SELF_LOCKING_FRICTION,
    LargestFrictionWithEquilibrium,
)
from drumlin.fem.equilibrium.group import divide_pressed_shoes_into_groups
from drumlin.fem.equilibrium.pressure_friction import (
    find_friction_factor_that_locks_group,
    solve_shoe_group_with_lining_friction,
)
from drumlin.fem.preparation.scene import PreparedModel


def self_locking_friction_of_shoe_groups(
    scene: PreparedModel,
    brake: Brake,
    most: float = LARGEST_SOUGHT_SELF_LOCKING_FRICTION,
    penalty: float = math.inf,
) -> dict[tuple[int, ...], LargestFrictionWithEquilibrium]:
    """The smallest friction coefficient at which each group of shoes locks itself.

    The keys of the result are the indices of the group's shoes in the brake. If a foot leaves its
    abutment at a smaller friction, or a cam or a strut would have to pull there, this smaller
    friction is the limit. If friction depends on the pressure, the limit is the friction
    coefficient at zero pressure, with all coefficients of the table changed in proportion.

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
    if first_key_of_pressure_dependent_friction(brake) is not None:
        return _limits_of_friction_over_pressure(scene, brake, most, penalty)
    return {
        group.members: group.find_friction_limit_by_following_contact(most).limit
        for group in divide_pressed_shoes_into_groups(scene, brake, penalty)
    }


def _limits_of_friction_over_pressure(
    scene: PreparedModel, brake: Brake, most: float, penalty: float
) -> dict[tuple[int, ...], LargestFrictionWithEquilibrium]:
    """The limits of `self_locking_friction_of_shoe_groups` for friction that depends on pressure.

    Each limit is the brake's friction coefficient at zero pressure, with all its coefficients in
    proportion. Raises BadInput for supports, struts and cams, at which equilibrium may end at a
    smaller friction.
    """
    limits = {}
    for group in divide_pressed_shoes_into_groups(scene, brake, penalty):
        if not group.has_neither_strut_cam_nor_abutment:
            key = first_key_of_pressure_dependent_friction(brake)
            raise BadInput(
                f"{key}: self-locking takes no friction that depends on the pressure on shoes with "
                "abutments, anchors, struts or a cam"
            )
        settled = solve_shoe_group_with_lining_friction(group)
        found = find_friction_factor_that_locks_group(settled, most / brake.friction)
        limits[group.members] = LargestFrictionWithEquilibrium(
            friction=found.factor * brake.friction,
            pressure_stays_finite=found.pressure_stays_finite,
            last_contact=settled.contact,
            last_friction=brake.friction,
            steps=0,
        )
    return limits


def shoe_torques_at_friction_coefficients(
    scene: PreparedModel, brake: Brake, frictions: Sequence[float], penalty: float = math.inf
) -> Floats:
    """The torque (m, shoes) [N m] of each shoe at m friction coefficients in increasing order.

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
