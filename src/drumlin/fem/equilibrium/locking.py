"""The distance of a solved brake's friction from the self-locking limit of the elastic brake.

The limit is followed from the solution at the brake's friction, not from zero friction. Far from
the limit this costs two contact solves for a group of shoes.
"""

import math
from contextlib import suppress

from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake
from drumlin.brake.friction import first_key_of_pressure_dependent_friction
from drumlin.contact.active_set import solve_contact_by_block_pivoting
from drumlin.contact.self_locking import (
    NODES_ABOVE_WHICH_FRICTION_PATH_IS_COARSE,
    LargestFrictionWithEquilibrium,
    find_largest_friction_with_equilibrium,
    is_equilibrium_certain_up_to_friction,
)
from drumlin.fem.equilibrium.group import (
    ShoeGroup,
    divide_pressed_shoes_into_groups,
    have_groups_equal_friction_limits,
)
from drumlin.fem.equilibrium.pressure_friction import (
    find_friction_factor_that_locks_group,
    solve_shoe_group_with_lining_friction,
)
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.response.self_locking import (
    WARNED_FRACTION_OF_LOCKING_FRICTION,
    LockedShoesAndLockingFriction,
    SelfLocking,
    SelfLockingFactor,
    first_shoes_to_lock,
)

SMALLEST_FRICTION_RATIO_FOR_ELASTIC_LIMIT = 0.5
"""Fraction of the rigid-shoe limit mu_lock above which the elastic limit is sought and stated.

The fraction is the brake's friction divided by the self-locking limit of the rigid-shoe law. The
elastic limit is the limit of the brake with elastic shoes.

At lower friction the elastic limit is sought only as far as is needed to decide whether a warning
is printed. The value is a judgement that changes the time and the printed line alone.
"""
LARGEST_SOUGHT_ELASTIC_LIMIT_OVER_FRICTION = 3.0
"""Upper end of the search for the elastic limit of self-locking, relative to the brake's friction.

The upper end holds for brakes whose friction is above SMALLEST_FRICTION_RATIO_FOR_ELASTIC_LIMIT of
the rigid-shoe limit. In the studies, elastic limits are up to 1.8 times as high as rigid-shoe
limits. The value changes the time and the printed line alone.
"""


def compare_friction_with_self_locking_limits(
    scene: PreparedModel, brake: Brake, penalty: float
) -> SelfLocking:
    """Compare a brake's friction with its self-locking limits by law and by finite elements.

    If the friction is above SMALLEST_FRICTION_RATIO_FOR_ELASTIC_LIMIT times the smallest rigid-shoe
    limit, the elastic limit is sought up to LARGEST_SOUGHT_ELASTIC_LIMIT_OVER_FRICTION times the
    friction. At lower friction it is sought up to 1/WARNED_FRACTION_OF_LOCKING_FRICTION times the
    friction, which is enough to decide on a warning; mostly a single contact solve shows that no
    limit lies so low. If a shoe may leave a support, or a cam or a strut would have to pull, at a
    smaller friction, this smaller friction is the limit. The elastic limit is not sought on meshes
    of more than NODES_ABOVE_WHICH_FRICTION_PATH_IS_COARSE contact nodes, on which the search would
    take longer than the solve.

    Parameters
    ----------
    scene : the prepared model on which the brake was solved
    brake : the brake, which has a solution on this model
    penalty : factor alpha of the contact stiffness alpha E/t

    Raises
    ------
    NoAnswer
        if the brake has no solution on this model
    """
    friction = brake.friction
    scaled = brake.first_key_that_gives_lining_its_own_friction() or ""
    by_law = []
    of_rigid_shoes = scene.locking_frictions_of_rigid_shoes.with_motion_of_file
    for shoe, own in zip(brake.shoes, of_rigid_shoes, strict=True):
        limit = brake.brake_friction_that_gives_shoe_friction(shoe, own)
        by_law.append(LockedShoesAndLockingFriction((shoe.name,), limit))
    law = first_shoes_to_lock(by_law)
    groups = divide_pressed_shoes_into_groups(scene, brake, penalty) if friction > 0 else []
    are_all_small = all(map(_has_group_few_contact_nodes, groups))
    if not groups or not are_all_small:
        return SelfLocking(friction, law, key_of_lining_with_own_friction=scaled)

    def smallest_locking_friction_of_group_by_rigid_law(group: ShoeGroup) -> float:
        """The smallest self-locking friction of the shoes of a group, by the rigid-shoe law."""
        return min(by_law[i].friction for i in group.members)

    # The search begins with the group that locks at the least friction by the rigid-shoe law. The
    # limit of each group bounds the search in the next groups, since only the smallest limit is
    # stated. A group that equals an earlier one has its limit.
    limits, sought = [], friction / WARNED_FRACTION_OF_LOCKING_FRICTION
    if friction > SMALLEST_FRICTION_RATIO_FOR_ELASTIC_LIMIT * law.friction:
        sought = friction * LARGEST_SOUGHT_ELASTIC_LIMIT_OVER_FRICTION
    searched: list[ShoeGroup] = []
    for group in sorted(groups, key=smallest_locking_friction_of_group_by_rigid_law):
        if any(have_groups_equal_friction_limits(group, earlier) for earlier in searched):
            continue
        limits.append(_locking_friction_of_elastic_group(group, sought))
        sought = min(sought, limits[-1].friction)
        searched.append(group)
    return SelfLocking(friction, law, first_shoes_to_lock(limits), sought, scaled)


def compare_friction_over_pressure_with_self_locking_limit(
    scene: PreparedModel, brake: Brake, penalty: float
) -> SelfLockingFactor:
    """The factor on all friction coefficients mu(p) at which a brake locks itself.

    The friction of the brake depends on the pressure p.

    The factor is sought as `compare_friction_with_self_locking_limits` seeks the friction. The
    law's limit is compared with the largest coefficient of each lining.

    Parameters
    ----------
    scene : the prepared model on which the brake was solved
    brake : the brake, which has a solution on this model
    penalty : factor alpha of the contact stiffness alpha E/t

    Raises
    ------
    NoAnswer
        if the brake has no solution on this model
    """
    key = first_key_of_pressure_dependent_friction(brake) or ""
    groups = divide_pressed_shoes_into_groups(scene, brake, penalty)
    if not groups or not all(
        group.has_neither_strut_cam_nor_abutment and _has_group_few_contact_nodes(group)
        for group in groups
    ):
        return SelfLockingFactor(key)
    of_rigid_shoes = scene.locking_frictions_of_rigid_shoes.with_motion_of_file
    by_law = [
        limit / brake.friction_coefficient_curve_of_shoe(shoe).mu.max()
        for shoe, limit in zip(brake.shoes, of_rigid_shoes, strict=True)
    ]
    limits, sought = [], 1 / WARNED_FRACTION_OF_LOCKING_FRICTION
    if SMALLEST_FRICTION_RATIO_FOR_ELASTIC_LIMIT * min(by_law) < 1:
        sought = LARGEST_SOUGHT_ELASTIC_LIMIT_OVER_FRICTION
    for group in groups:
        shoes = tuple(brake.shoes[i].name for i in group.members)
        settled = solve_shoe_group_with_lining_friction(group)
        limit = find_friction_factor_that_locks_group(settled, sought, single_step=True)
        limits.append(
            LockedShoesAndLockingFriction(shoes, limit.factor, limit.pressure_stays_finite)
        )
        sought = min(sought, limit.factor)
    return SelfLockingFactor(key, first_shoes_to_lock(limits), sought)


def _has_group_few_contact_nodes(group: ShoeGroup) -> bool:
    """Whether the search for the elastic limit of a group takes little time beside the solve."""
    return len(group.contact_node_areas) <= NODES_ABOVE_WHICH_FRICTION_PATH_IS_COARSE


def _locking_friction_of_elastic_group(
    group: ShoeGroup, sought: float
) -> LockedShoesAndLockingFriction:
    """The friction at which a group of elastic shoes locks itself; inf if it is above `sought`.

    Raises NoAnswer if the group has no solution at the friction of its brake.
    """
    if group.has_neither_strut_cam_nor_abutment:
        limit = _limit_of_group_on_fixed_supports_or_none(group, sought)
        solved = group
    else:
        settled = group.solve_contact_and_abutment_friction()
        solved = settled.group
        limit = settled.group.find_friction_limit_above_solution(settled.contact, sought).limit
    shoes = tuple(shoe.name for shoe in group.shoes)
    if limit is None or not limit.friction < sought:
        return LockedShoesAndLockingFriction(shoes, math.inf)
    return LockedShoesAndLockingFriction(
        shoes,
        limit.friction,
        limit.pressure_stays_finite,
        solved.names_of_shoes_whose_contact_shrinks_to_point(limit),
    )


def _limit_of_group_on_fixed_supports_or_none(
    group: ShoeGroup, sought: float
) -> LargestFrictionWithEquilibrium | None:
    """The limit of a group whose shoes cannot leave their supports; None if it is above `sought`.

    Raises NoAnswer if the group has no solution at the friction of its brake.
    """
    areas, problem_at = group.contact_node_areas, group.contact_problem_of_group_at_friction
    # If this direct solution does not converge, the slower search below decides.
    with suppress(NoAnswer):
        contact = solve_contact_by_block_pivoting(group.contact_problem_of_group)
        if contact.stable and is_equilibrium_certain_up_to_friction(
            problem_at, contact, sought, areas
        ):
            return None
    # The limit may be near. The search follows the solution that growing friction reaches, which
    # takes longer.
    contact = group.solve_contact_for_given_abutment_friction()
    return find_largest_friction_with_equilibrium(
        group.contact_problem_as_function_of_friction,
        sought,
        (group.brake.friction, contact),
        areas,
    )
