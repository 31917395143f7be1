"""Friction limits of self-locking of an elastic brake, and the torques below these limits."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from itertools import chain
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import AnswerBeyondModel, BadInput, NoAnswer
from drumlin.base.texts import number_as_text
from drumlin.brake.brake import Brake
from drumlin.brake.friction import (
    first_key_of_pressure_dependent_friction,
    require_friction_independent_of_pressure,
)
from drumlin.brake.further_loads import require_springs_with_constant_pull
from drumlin.brake.one_sided import one_sided_supports_of_brake
from drumlin.contact.self_locking import (
    DISTANCE_OF_PRESSURE_COMPARISON,
    LARGEST_SOUGHT_SELF_LOCKING_FRICTION,
    LEAST_GROWTH_OF_UNBOUNDED_PRESSURE,
    NODES_ABOVE_WHICH_FRICTION_PATH_IS_COARSE,
    FrictionDependentProblem,
    find_largest_friction_with_equilibrium,
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
from drumlin.fem.equilibrium.spring_nodes import (
    contact_problem_with_spring_nodes,
    group_under_spring_pulls,
    spring_nodes_of_brake,
)
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.fem.solve import prepared_model_with_finest_elements

FRICTION_AT_WHICH_RIGHT_ANGLED_CORNER_LOCKS = math.pi / 2
"""Friction coefficient above which a right-angled corner of an elastic lining digs into the drum.

Ahead of the corner the lining ends. A force on the corner, of the normal part N and the part F
along the drum, gives the wedge of 90 degrees the stress A cos(theta)/r (Michell 1902), if the face
on the drum stays straight. Here r is the distance from the corner, and theta the angle from this
face. The integrals of this stress are F = A pi/4 and N = A/2, so that F/N = pi/2. Corners of other
angles lock at higher friction: the ratio is (a + sin a cos a)/sin(a)^2 for the angle a. Above this
ratio the force of the corner node does not vanish as the elements become smaller.
"""

FRICTION_STEP_OF_REPEATED_SOLVES = 0.1
"""Step of the friction coefficient while a brake is solved anew after each step.

Above a friction coefficient of 1 the step is relative to the coefficient. The first step without an
equilibrium is then bisected. An equilibrium that ends and begins again within one step goes
unnoticed; a smaller step costs time.
"""
SMALLEST_FIRST_FRICTION_OF_REPEATED_SOLVES = 1e-3
"""Smallest friction coefficient that is tried first where a brake is solved anew after each step.

If the first step FRICTION_STEP_OF_REPEATED_SOLVES has no equilibrium, the brake may lock below it.
The step is halved until there is an equilibrium, or until it would be smaller than this value. The
value is a judgement: no lining has so little friction.
"""
RESOLUTION_OF_REPEATED_SOLVES = 1e-6
"""Relative error of a self-locking limit that is found by repeated solves.

Four digits of the limit are printed. Each further digit costs three solves. The limit itself is
known to some 1e-4: on a hinged shoe it changes by 7e-5 between forces of 0.4 and 40 MPa.
"""


class LockingFrictionOfShoeGroup(NamedTuple):
    """The smallest friction coefficient at which a group of shoes locks itself.

    Attributes
    ----------
    friction : the friction coefficient mu_lock; inf if the search found no limit
    pressure_stays_finite : whether the equilibrium ends at finite pressures on these elements
    shoes_pressed_at_point : names of shoes whose contact shrinks to a point at this friction. The
        contact force stays finite and the pressure grows without bound as the elements become
        smaller.
    friction_at_which_corner_locks : the friction coefficient of the brake at which the friction at
        a corner of the group's linings is FRICTION_AT_WHICH_RIGHT_ANGLED_CORNER_LOCKS. It differs
        from this number if a lining has its own friction, or if friction depends on the pressure,
        which is high at a corner.
    """

    friction: float
    pressure_stays_finite: bool
    shoes_pressed_at_point: tuple[str, ...] = ()
    friction_at_which_corner_locks: float = FRICTION_AT_WHICH_RIGHT_ANGLED_CORNER_LOCKS

    @property
    def least_friction_on_finer_elements(self) -> float:
        """The friction coefficient to which mu_lock may fall as the elements become smaller.

        It differs from `friction` where a corner of a lining may dig into the drum, see
        FRICTION_AT_WHICH_RIGHT_ANGLED_CORNER_LOCKS.
        """
        if math.isinf(self.friction):
            return self.friction
        return min(self.friction, self.friction_at_which_corner_locks)


def self_locking_friction_of_shoe_groups(
    scene: PreparedModel,
    brake: Brake,
    most: float = LARGEST_SOUGHT_SELF_LOCKING_FRICTION,
    penalty: float = math.inf,
) -> dict[tuple[int, ...], LockingFrictionOfShoeGroup]:
    """The smallest friction coefficient at which each group of shoes locks itself.

    The keys of the result are the indices of the group's shoes in the brake. If a foot leaves its
    abutment at a smaller friction, or a cam or a strut would have to pull there, this smaller
    friction is the limit. If friction depends on the pressure, the limit is the friction
    coefficient at zero pressure, with all coefficients of the table changed in proportion. Springs
    with a rate join all shoes to one group, and their pulls change while the friction grows.

    Parameters
    ----------
    scene : the prepared model
    brake : the brake
    most : friction coefficient up to which the limit is sought
    penalty : factor alpha of the contact stiffness alpha E/t (lining modulus E, thickness t)

    Raises
    ------
    BadInput
        if the brake has no friction
    NoAnswer
        if a group has no equilibrium at any friction, or if the model does not hold up to the limit
    """
    if not brake.friction:
        raise BadInput("friction = 0: self-locking needs a friction coefficient above 0")
    have_springs_rate = any(spring.rate for spring in brake.springs)
    is_over_pressure = first_key_of_pressure_dependent_friction(brake) is not None
    limits: dict[tuple[int, ...], LockingFrictionOfShoeGroup] = {}
    searched: list[ShoeGroup] = []
    groups = divide_pressed_shoes_into_groups(scene, brake, penalty, springs_join=True)
    for group in groups:
        are_supports_fixed = group.has_neither_strut_cam_nor_abutment
        if have_springs_rate and (is_over_pressure or not are_supports_fixed):
            limit = _limit_by_repeated_solves_of_brake(scene, brake, most, penalty)
        elif have_springs_rate:
            pulls = solve_prepared_model(scene, brake, penalty=penalty).spring_pulls
            limit = _limit_of_hinged_shoes_on_springs_with_rate(group, pulls, most)
        elif is_over_pressure and not are_supports_fixed:
            limit = _limit_by_repeated_solves_of_group(group, most)
        elif is_over_pressure:
            limit = _limit_of_friction_over_pressure(group, most)
        else:
            equal = (each for each in searched if have_groups_equal_friction_limits(group, each))
            if (first := next(equal, None)) is not None:
                limits[group.members] = limits[first.members]
                continue
            searched.append(group)
            found = group.find_friction_limit_by_following_contact(most).limit
            limit = LockingFrictionOfShoeGroup(
                found.friction,
                found.pressure_stays_finite,
                group.names_of_shoes_whose_contact_shrinks_to_point(found),
            )
        corner = _friction_of_brake_at_which_corner_locks(group)
        limits[group.members] = limit._replace(friction_at_which_corner_locks=corner)
    return limits


def _friction_of_brake_at_which_corner_locks(group: ShoeGroup) -> float:
    """The brake's friction coefficient at which a right-angled corner of a lining may lock.

    At a corner the pressure is high, so that the last coefficient of a table over it counts.
    """
    brake = group.brake
    at_corner = max(brake.friction_coefficient_curve_of_shoe(shoe).mu[-1] for shoe in group.shoes)
    return float(FRICTION_AT_WHICH_RIGHT_ANGLED_CORNER_LOCKS * brake.friction / at_corner)


def _limit_of_friction_over_pressure(group: ShoeGroup, most: float) -> LockingFrictionOfShoeGroup:
    """The limit of a group of hinged shoes whose friction depends on the pressure."""
    friction = group.brake.friction
    settled = solve_shoe_group_with_lining_friction(group)
    found = find_friction_factor_that_locks_group(settled, most / friction)
    return LockingFrictionOfShoeGroup(found.factor * friction, found.pressure_stays_finite)


def _limit_of_hinged_shoes_on_springs_with_rate(
    group: ShoeGroup, pulls: Sequence[float], most: float
) -> LockingFrictionOfShoeGroup:
    """The limit of a group of hinged shoes with springs whose pulls depend on their motions.

    The springs are nodes of the contact problem, whose matrices are linear in the friction. `pulls`
    [N] are the pulls of all springs in a solve. They tell whether a spring without preload pulls or
    pushes.
    """
    springs = spring_nodes_of_brake(group.brake, pulls)
    under = group_under_spring_pulls(group, None)
    problem = FrictionDependentProblem.linear_function_of_friction_from_two_problems(
        contact_problem_with_spring_nodes(under, springs, 0.0),
        contact_problem_with_spring_nodes(under, springs, 1.0),
    )
    # A pull is a force already, so that the node of a spring has the area 1.
    areas = np.append(group.contact_node_areas, np.ones(len(springs.numbers)))
    found = find_largest_friction_with_equilibrium(problem, most, areas=areas)
    return LockingFrictionOfShoeGroup(found.friction, found.pressure_stays_finite)


def _limit_by_repeated_solves_of_group(group: ShoeGroup, most: float) -> LockingFrictionOfShoeGroup:
    """The limit of a group on supports that shoes can leave, with friction over the pressure."""

    def peak_pressure(friction: float) -> float:
        """The peak pressure at a friction coefficient. Raises NoAnswer without equilibrium."""
        varied = group.brake.brake_with_multiplied_friction(friction / group.brake.friction)
        settled = solve_shoe_group_with_lining_friction(
            replace(group, brake=varied, are_large_turns_allowed=True)
        )
        if not settled.group.is_contact_solution_physically_possible(settled.contact):
            raise NoAnswer(
                f"{group.names_of_shoes_as_text}: the supports or the drive would have to pull"
            )
        return float(settled.contact.p.max())

    return _limit_by_repeated_solves(peak_pressure, most)


def _limit_by_repeated_solves_of_brake(
    scene: PreparedModel, brake: Brake, most: float, penalty: float
) -> LockingFrictionOfShoeGroup:
    """The limit of a whole brake with springs whose pulls depend on their motions.

    Each solve finds the pulls by an iteration over solves with known pulls. Beyond the friction at
    which the shoes would lock under constant pulls it finds no equilibrium. The limit is therefore
    low by the whole effect of the rate: by 0.05 % for a return spring of 10 N/mm on the shoe of a
    car, by 3 % for 2 kN/mm.
    """

    def peak_pressure(friction: float) -> float:
        """The peak pressure at a friction coefficient. Raises NoAnswer without equilibrium."""
        varied = brake.brake_with_multiplied_friction(friction / brake.friction)
        response = solve_prepared_model(scene, varied, penalty=penalty)
        return float(max(shoe.peak_pressure for shoe in response.shoes))

    return _limit_by_repeated_solves(peak_pressure, most)


def _limit_by_repeated_solves(
    peak_pressure: Callable[[float], float], most: float
) -> LockingFrictionOfShoeGroup:
    """The friction coefficient at which the equilibrium ends, by a solve after each step.

    The friction grows from the first step on that has an equilibrium. `peak_pressure` returns the
    peak pressure at a friction coefficient, and raises NoAnswer without equilibrium. Raises
    NoAnswer if there is no equilibrium up to `most`, or if a spring goes slack or a shoe turns too
    far at finite pressures.
    """
    low, high, failure = _bracket_of_friction_limit_below_first_step(peak_pressure, most)
    # Without an equilibrium below the first step the friction grows on: a shoe may need friction to
    # be pressed on the drum. With one, the end of the equilibrium is bracketed.
    while low in {0.0, high} and high < most:
        high = min(high + FRICTION_STEP_OF_REPEATED_SOLVES * max(1.0, high), most)
        try:
            peak_pressure(high)
        except NoAnswer as error:
            failure = error
        else:
            low = high
    if low == 0:
        raise failure
    if low == most:
        return LockingFrictionOfShoeGroup(math.inf, False)
    while high - low > RESOLUTION_OF_REPEATED_SOLVES * high:
        middle = 0.5 * (low + high)
        try:
            peak_pressure(middle)
        except NoAnswer as error:
            high, failure = middle, error
        else:
            low = middle
    limit = _limit_at_end_of_equilibrium(peak_pressure, low)
    if limit.pressure_stays_finite and isinstance(failure, AnswerBeyondModel):
        raise NoAnswer(f"the friction at self-locking is not known: above {low:.4g}, {failure}")
    return limit


def _bracket_of_friction_limit_below_first_step(
    peak_pressure: Callable[[float], float], most: float
) -> tuple[float, float, NoAnswer]:
    """The largest friction known to have an equilibrium, the least one above without, and why.

    Both lie up to the first step of repeated solves, which is at most `most`, and are the same if
    the first step has an equilibrium. They are 0 and the first step if there is none down to
    SMALLEST_FIRST_FRICTION_OF_REPEATED_SOLVES. The error is that of the last solve without
    equilibrium. `peak_pressure` raises NoAnswer without equilibrium.
    """
    first = min(FRICTION_STEP_OF_REPEATED_SOLVES, most)
    smallest = min(SMALLEST_FIRST_FRICTION_OF_REPEATED_SOLVES, most)
    friction, high, failure = first, first, NoAnswer("no equilibrium at any friction")
    while friction >= smallest:
        try:
            peak_pressure(friction)
        except NoAnswer as error:
            high, friction, failure = friction, 0.5 * friction, error
        else:
            return friction, high, failure
    return 0.0, first, failure


def _limit_at_end_of_equilibrium(
    peak_pressure: Callable[[float], float], friction: float
) -> LockingFrictionOfShoeGroup:
    """The limit of a brake whose equilibrium ends at a friction coefficient.

    If the pressure grows as c/(mu_lock - mu), mu_lock follows from two pressures. The solves may
    end before mu_lock, for example because shoes with a clearance turn too far for small
    displacements.
    """
    below = friction * (1 - DISTANCE_OF_PRESSURE_COMPARISON * np.array([2.0, 1.0]))
    try:
        far, near = map(peak_pressure, below.tolist())
    except NoAnswer:
        return LockingFrictionOfShoeGroup(friction, True)
    if near < LEAST_GROWTH_OF_UNBOUNDED_PRESSURE * far:
        return LockingFrictionOfShoeGroup(friction, True)
    pole = float(near * below[1] - far * below[0]) / (near - far)
    return LockingFrictionOfShoeGroup(max(pole, friction), False)


def line_on_locking_friction_of_elastic_brake(brake: Brake, **mesh_options: Any) -> str:
    """A line of text with the friction coefficient at which the elastic brake locks itself.

    The search takes at most some two solves where the supports of the shoes are fixed, and up to
    13 solves on struts, cams and abutments, or with friction over the pressure. On these brakes,
    on springs with a rate and on the meshes of files the line names the Python call in place of
    the limit. `mesh_options` are the options of `prepared_model_with_finest_elements`.
    """
    if not brake.friction:
        return "self-locking of the elastic brake: none without friction"
    are_supports_fixed = not (
        one_sided_supports_of_brake(brake)
        or brake.reason_why_cam_or_strut_sets_forces
        or brake.links
        or any(shoe.abutment or shoe.anchors for shoe in brake.shoes)
    )
    is_search_long = not are_supports_fixed or (
        first_key_of_pressure_dependent_friction(brake) is not None
        or any(spring.rate for spring in brake.springs)
        or any(shoe.mesh for shoe in brake.shoes)
        or (mesh_options.get("elements") or 0) > NODES_ABOVE_WHICH_FRICTION_PATH_IS_COARSE
    )
    if is_search_long:
        return (
            "self-locking of the elastic brake: the search takes long on this brake; "
            'drumlin.self_locking("BRAKE.toml") in Python finds the limit'
        )
    try:
        scene = prepared_model_with_finest_elements(brake, **mesh_options)
        found = self_locking_friction_of_shoe_groups(scene, brake)
    except NoAnswer as error:
        return f"self-locking of the elastic brake: not known, {error}"
    return f"self-locking of the elastic brake: {_smallest_locking_friction_as_text(brake, found)}"


def _smallest_locking_friction_as_text(
    brake: Brake, found: Mapping[tuple[int, ...], LockingFrictionOfShoeGroup]
) -> str:
    """The smallest of the limits that `self_locking_friction_of_shoe_groups` finds, in words."""
    if not found:
        return "not sought, the actuation presses no shoe"
    members, limit = min(found.items(), key=lambda item: item[1].friction)
    pressed = set(chain.from_iterable(found))
    if math.isinf(limit.friction):
        which = "it locks" if len(pressed) == len(brake.shoes) else "its pressed shoes lock"
        return f"{which} at no friction"
    names = ", ".join(f"shoe {brake.shoes[i].name!r}" for i in members)
    lock = "lock together" if len(members) > 1 else "locks"
    share = number_as_text(brake.friction / limit.friction, ".0%")
    key = brake.first_key_that_gives_lining_its_own_friction()
    scaled = f"; all frictions in proportion, {key} too" if key else ""
    return (
        f"{names} {lock} at mu_lock = {limit.friction:.4g}; "
        f"friction {brake.friction:g} is {share} of it{scaled}"
    )


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
