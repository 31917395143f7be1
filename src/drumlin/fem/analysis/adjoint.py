"""Solve the adjoint equations of a group of shoes, which give the derivatives of the torque.

As long as the same nodes are in contact, the solved brake fulfils linear equations r = 0. Their
unknowns are the pressures p, the generalised coordinates y of the rigid-body motions, the actuation
forces F and, under a cam, the travel d of the points where its forces act. The adjoint (a, b, c) is
the solution of the transposed equations, whose right side is the derivative of a torque T with
respect to these unknowns. If a small change of the brake changes r by dr, the torque changes by dT
= -(a, b, c) . dr. The torque T is mu times an integral of p, so that a change dmu of the friction
coefficient also adds (T/mu) dmu. If mu depends on p, the equations contain the derivative of the
friction stress mu(p) p by p, and dmu changes all coefficients in proportion.

The actuation forces are unknowns of the equations, so that forces of struts and cams need no
special case: c is the change of T per newton of a given force. The pulls of springs are unknowns as
well. A spring with the preload P_0 and the rate k, whose points come nearer to each other by s, has
the pull P with P + k s = P_0. The multiplier of this equation is the change of T per preload. The
forces of the one-sided supports that bear are unknowns, too: each of these supports stays closed.
"""

from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Bools, Floats
from drumlin.base.errors import NoAnswer
from drumlin.fem.equilibrium.group import ShoeGroup
from drumlin.fem.equilibrium.pressure_friction import (
    group_with_tangent_of_friction_stress,
    solve_shoe_group_with_lining_friction,
)
from drumlin.fem.equilibrium.sharing import contact_matrix_with_forces_as_unknowns
from drumlin.fem.equilibrium.springs import SpringMatrices
from drumlin.fem.preparation.bodies import unit_load_factors_under_all_loads


class ShoeAdjoint(NamedTuple):
    """The adjoint multipliers of one shoe's equations, and the solution of its contact.

    A weighted gap is the integral of the gap times the shape function of a contact node.

    Attributes
    ----------
    gap_multipliers : adjoint multipliers (n,) of the equations of the weighted gaps
    equilibrium_multipliers : adjoint multipliers (k,) of the equilibrium equations of the shoe
    force_multiplier : adjoint multiplier of the equation that gives the shoe's actuation force
    pressures : pressures (n,) [Pa] on the lining in the solution
    coordinates : generalised coordinates (k,) of the shoe's k rigid-body modes in the solution
    force : size of the shoe's actuation force [N] in the solution
    load_of_supports : factors (l,) [N] by which the shoe's load columns make up the forces of the
        one-sided supports on it
    adjoint_load_of_supports : factors (l,) by which the load columns make up the adjoint load that
        belongs to the openings of these supports
    """

    gap_multipliers: Floats
    equilibrium_multipliers: Floats
    force_multiplier: float
    pressures: Floats
    coordinates: Floats
    force: float
    load_of_supports: Floats
    adjoint_load_of_supports: Floats


class TorqueDerivativesAndAdjointOfGroup(NamedTuple):
    """The derivatives of the torques of a group of shoes, and the adjoint of each shoe.

    Attributes
    ----------
    group : the group, with the directions of friction at its abutments in the solution
    shoes : the adjoint and the solution of each shoe
    torques : torque of each shoe (shoes,) [N m]
    torque_slopes_by_friction : derivative (shoes,) [N m] of the torque of each shoe by the friction
        coefficient
    torque_slope_by_log_of_ring_modulus : derivative [N m] of the group's torque by the natural
        logarithm of the ring's modulus
    torque_slope_by_given_forces : derivative [N m] of the group's torque by the natural logarithm
        of a factor on all actuation forces that the brake file gives
    springs : the effects of the brake's springs on the group, at the friction of the solution
    preload_slopes : derivative (springs,) [m] of the group's torque by the preload of each spring
    approaches : motion (springs,) [m] by which the points of each spring come nearer to each other
    """

    group: ShoeGroup
    shoes: list[ShoeAdjoint]
    torques: Floats
    torque_slopes_by_friction: Floats
    torque_slope_by_log_of_ring_modulus: float
    torque_slope_by_given_forces: float
    springs: SpringMatrices
    preload_slopes: Floats
    approaches: Floats


def solve_adjoint_for_torque_of_shoe_group(group: ShoeGroup) -> TorqueDerivativesAndAdjointOfGroup:
    """Solve a group's contact problem, and the adjoint problem for the sum of its shoes' torques.

    Raises NoAnswer as `solve_shoe_group_with_lining_friction` does.
    """
    group, contact = solve_shoe_group_with_lining_friction(group)
    size, mu = group.largest_actuation_force, group.brake.friction
    lever, n = group.torque_of_each_shoe_per_nodal_pressure, len(contact.p)
    without_friction = _equation_matrix_of_shoe_group(group, 0.0)
    per_friction = _equation_matrix_of_shoe_group(group, 1.0) - without_friction
    # A small change dp of a pressure changes the friction stress mu(p) p by d(mu p)/dp dp.
    tangent, tangent_per_friction = (
        group_with_tangent_of_friction_stress(group, contact.p),
        per_friction,
    )
    if tangent is not group:
        tangent_per_friction = _equation_matrix_of_shoe_group(tangent, 1.0) - without_friction
    y = group.rigid_body_coordinates_of_each_shoe(contact)
    F = np.abs(group.actuation_forces_under_contact_pressures(contact.p))
    coordinates = sum(map(len, y))
    # The last unknowns are the travel of the points of actuation under a cam, or the forces of
    # one-sided supports, and the pulls of springs. `answer` is multiplied below only by a matrix of
    # derivatives by friction. This matrix is zero in the columns of these unknowns, so that zeros
    # may stand for their values.
    further = np.zeros(len(without_friction) - n - coordinates - len(F))
    answer = np.concatenate([contact.p, *y, F, further])
    weights = np.zeros((len(answer), len(F)))
    weights[:n] = mu * tangent.torque_of_each_shoe_per_nodal_pressure
    # Pressures are unknowns only at the nodes in contact, and the forces of one-sided supports only
    # where these bear. All other unknowns are always free.
    on = np.concatenate([contact.active, np.ones(len(answer) - n, dtype=bool)])
    first_spring = len(answer) - len(group.brake.springs)
    supports = slice(first_spring - len(group.one_sided_supports), first_spring)
    on[supports] = group.bearing
    each = _solve_adjoint_equations_for_torques(
        without_friction + mu * tangent_per_friction, on, weights
    )
    # The torque of the group is the sum of the shoes' torques, and so is its adjoint.
    a, b, c, by_preload = np.split(each.sum(axis=1), [n, n + coordinates, first_spring])
    loads = _loads_of_one_sided_supports(group, contact.p, each.sum(axis=1)[supports])
    shoes = []
    for k, (nodes, modes) in enumerate(
        zip(group.contact_node_slices_of_shoes, group.rigid_body_mode_slices_of_shoes, strict=True)
    ):
        p, force = size * contact.p[nodes], size * float(F[k])
        shoes.append(ShoeAdjoint(a[nodes], b[modes], float(c[k]), p, size * y[k], force, *loads[k]))
    # The first term is the change of the torque at fixed pressures. The second term comes from the
    # change of the pressures, because the equations contain the friction.
    by_friction = lever.T @ contact.p - each.T @ (per_friction @ answer)
    given = _torque_slope_by_logarithm_of_actuation_forces(group, shoes)
    springs = group.spring_matrices_at_friction(mu)
    return TorqueDerivativesAndAdjointOfGroup(
        group=group,
        shoes=shoes,
        torques=size * mu * (lever.T @ contact.p),
        torque_slopes_by_friction=size * by_friction,
        torque_slope_by_log_of_ring_modulus=_torque_slope_by_logarithm_of_ring_modulus(
            group, a, contact.p
        ),
        torque_slope_by_given_forces=size
        * group.sum_of_cam_forces_over_largest_force
        * float(c[-1])
        if group.indices_of_shoes_under_cam
        else given,
        springs=springs,
        preload_slopes=by_preload,
        approaches=_approaches_of_springs(group, springs, contact.p, shoes),
    )


def _approaches_of_springs(
    group: ShoeGroup, springs: SpringMatrices, p: Floats, shoes: list[ShoeAdjoint]
) -> Floats:
    """The lengths (springs,) [m] by which the two points of each spring come nearer to each other.

    Parameters
    ----------
    group : the solved group
    springs : the effects of its springs
    p : pressures (n,) per newton of the group's actuation force
    shoes : the solution of each shoe
    """
    y = np.concatenate([own.coordinates for own in shoes])
    found = group.largest_actuation_force * (springs.approach_by_pressure @ p)
    found = found + springs.approach_by_motion @ y
    for k, own in enumerate(shoes):
        body = group.substructures_of_shoes[k]
        load = unit_load_factors_under_all_loads(body, group.shoes[k], own.force)
        load = load + own.load_of_supports
        for j, factors in enumerate(springs.load_column_factors):
            found[j] += float(factors[k] @ body.flexibility.load_point_motion_by_load @ load)
    along = motions_along_surface_with_struts_in_solution(group, shoes)
    return np.asarray(found + group.approach_of_springs_by_surface_motion(springs) @ along)


def motions_along_surface_with_struts_in_solution(
    group: ShoeGroup, shoes: list[ShoeAdjoint]
) -> Floats:
    """The motion (s,) of each shoe along the drum or the plane, as its strut carries its foot.

    `shoes` have the solution of each shoe. The motions are turns [rad] about the drum's centre, or
    slides [m] along the plane.
    """
    return group.motions_along_surface_with_struts(
        [own.pressures for own in shoes],
        [own.coordinates for own in shoes],
        np.array([own.force for own in shoes]),
    )


class _LoadsOfOneSidedSupports(NamedTuple):
    """The attributes of a `ShoeAdjoint` that belong to one-sided supports."""

    load_of_supports: Floats
    adjoint_load_of_supports: Floats


def _loads_of_one_sided_supports(
    group: ShoeGroup, p: Floats, multipliers: Floats
) -> list[_LoadsOfOneSidedSupports]:
    """The loads of one-sided supports on each shoe, and the adjoint loads.

    Parameters
    ----------
    group : the solved group
    p : pressures (n,) per newton of the group's actuation force
    multipliers : adjoint multiplier (m,) of the opening of each support; 0 where a support is open
    """
    loads = []
    for body in group.substructures_of_shoes:
        nothing = np.zeros(body.load_matrix_columns_by_load_name.number_of_load_columns)
        loads.append(_LoadsOfOneSidedSupports(nothing, nothing.copy()))
    on_supports = group.contact_problem_on_bearing_supports_or_none
    if on_supports is None:
        return loads
    forces = group.largest_actuation_force * on_supports.forces_of_one_sided_supports(p)
    for support, force, multiplier in zip(
        group.one_sided_supports, forces.tolist(), multipliers.tolist(), strict=True
    ):
        for side in support.sides:
            factors = group.load_column_factors_of_support_push(side)
            loads[side.shoe].load_of_supports[:] += force * factors
            loads[side.shoe].adjoint_load_of_supports[:] -= multiplier * factors
    return loads


def _torque_slope_by_logarithm_of_ring_modulus(group: ShoeGroup, a: Floats, p: Floats) -> float:
    """The derivative [N m] of the torque by the natural logarithm of the drum ring's modulus.

    `a` are the gap multipliers and `p` the pressures (n,) of the group. A rigid drum gives 0.
    """
    if group.factors_of_ring_flexibility is None:
        return 0.0
    pressed, dragged = group.factors_of_ring_flexibility
    return group.largest_actuation_force * float(
        (pressed @ a) @ (pressed @ p + dragged @ (group.friction_stress_over_pressure_at_nodes * p))
    )


def _torque_slope_by_logarithm_of_actuation_forces(
    group: ShoeGroup, shoes: list[ShoeAdjoint]
) -> float:
    """The derivative [N m] of the torque by the logarithm of a factor on all given forces.

    Given forces are the actuation forces in the brake file; forces of struts are not in the file.
    """
    pushed_by_struts = [to for _, to in group.indices_of_pushing_and_pushed_shoe_of_struts]
    return float(
        sum(
            own.force_multiplier * own.force
            for k, own in enumerate(shoes)
            if k not in pushed_by_struts
        )
    )


def _equation_matrix_of_shoe_group(group: ShoeGroup, friction: float) -> Floats:
    """The matrix of all equations of a group of shoes at a friction coefficient.

    The matrix is linear in the friction coefficient. The actuation forces are among the unknowns,
    see `contact_matrix_with_forces_as_unknowns`.
    """
    blocks = group.contact_problem_with_given_actuation_forces(friction)
    effects = group.contact_effects_of_each_actuation_force(friction)
    matrix = contact_matrix_with_forces_as_unknowns(
        blocks,
        effects,
        group.indices_of_pushing_and_pushed_shoe_of_struts,
        group.indices_of_shoes_under_cam,
    )
    if group.one_sided_supports:
        matrix = _equation_matrix_with_support_forces(matrix, group, friction)
    if not group.brake.springs:
        return matrix
    return _equation_matrix_with_spring_pulls(
        matrix, group, group.spring_matrices_at_friction(friction), friction
    )


def _equation_matrix_with_support_forces(
    matrix: Floats, group: ShoeGroup, friction: float
) -> Floats:
    """The matrix of the equations of a group with the forces of its one-sided supports.

    The last columns stand for the forces of all supports, and the last rows for their openings.

    Parameters
    ----------
    matrix : the matrix without these forces
    group : the group of shoes
    friction : the friction coefficient of `matrix`
    """
    supports = group.one_sided_support_matrices_at_friction(friction)
    n, k = supports.gap_by_force.shape[0], supports.opening_by_motion.shape[1]
    count, first = len(supports.opening), len(matrix)
    by_support = np.zeros((first, count))
    by_support[:n], by_support[n : n + k] = supports.gap_by_force, supports.opening_by_motion.T
    opening = np.zeros((count, first))
    opening[:, :n] = supports.opening_by_pressure
    opening[:, n : n + k] = supports.opening_by_motion
    for row, support in enumerate(group.one_sided_supports):
        for side in support.sides:
            flexibility = group.substructures_of_shoes[side.shoe].flexibility
            acting = group.actuation_of_each_shoe_by_one_newton[side.shoe].load_column_factors
            push = group.load_column_factors_of_support_push(side)
            motion = push @ flexibility.load_point_motion_by_load @ acting
            opening[row, n + k + side.shoe] += motion
    return np.block([[matrix, by_support], [opening, supports.opening_by_force]])


def _equation_matrix_with_spring_pulls(
    matrix: Floats, group: ShoeGroup, springs: SpringMatrices, friction: float
) -> Floats:
    """The matrix of the equations of a group with the pulls of its springs as last unknowns.

    Parameters
    ----------
    matrix : the matrix without the pulls
    group : the group of shoes
    springs : the effects of the springs, at the friction coefficient of `matrix`
    friction : the friction coefficient of `matrix`
    """
    rates = np.array([spring.rate for spring in group.brake.springs])
    n, k = len(springs.gap_by_pull), len(springs.work)
    force, first = n + k, len(matrix)
    by_pull = np.zeros((first, len(rates)))
    by_pull[:n], by_pull[n:force] = springs.gap_by_pull, springs.work
    for source, to in group.indices_of_pushing_and_pushed_shoe_of_struts:
        by_pull[force + to] = -springs.foot_force_by_pull[source]
    for i in group.indices_of_shoes_under_cam:
        by_pull[force + i] = springs.tip_travel_by_pull[i]
    if group.one_sided_supports:
        on_supports = slice(first - len(group.one_sided_supports), first)
        by_pull[on_supports] = group.openings_of_one_sided_supports_by_pulls()
    approach = np.zeros((len(rates), first))
    approach[:, :n], approach[:, n:force] = springs.approach_by_pressure, springs.approach_by_motion
    approach[:, force : force + len(group.shoes)] = springs.approach_by_force
    if group.one_sided_supports:
        approach[:, on_supports] = by_pull[on_supports].T
    # The shoes that push struts follow the points of actuation of the next shoes.
    by_travel = group.approach_of_springs_by_load_point_travel(springs)
    for i, shoe in enumerate(group.contact_effects_of_each_actuation_force(friction)):
        travel = np.zeros(first)
        travel[:n][shoe.nodes] = shoe.load_point_travel_by_pressure
        travel[n:force][shoe.modes] = shoe.load_point_travel_by_modes
        travel[force + i] = shoe.load_point_travel_by_force
        approach += np.outer(by_travel[:, i], travel)
    approach_by_pull = springs.approach_by_pull + by_travel @ springs.tip_travel_by_pull
    of_pulls = np.eye(len(rates)) + rates[:, None] * approach_by_pull
    return np.block([[matrix, by_pull], [rates[:, None] * approach, of_pulls]])


def _solve_adjoint_equations_for_torques(matrix: Floats, on: Bools, weights: Floats) -> Floats:
    """Solve the transposed equations of a group of shoes for the adjoint of each of j torques.

    Parameters
    ----------
    matrix : the matrix (m, m) of the equations
    on : whether an unknown is free (m,); all other unknowns are 0
    weights : the derivatives (m, j) of the torques by the unknowns

    Returns
    -------
    the adjoints (m, j), 0 at the unknowns that are not free

    Raises
    ------
    NoAnswer
        if the equations are singular
    """
    K = matrix[np.ix_(on, on)]
    # Scaling of the rows and then of the columns makes their largest entries 1.
    row = 1 / np.abs(K).max(axis=1)
    column = 1 / np.abs(row[:, None] * K).max(axis=0)
    scaled = (row[:, None] * K * column).T
    solution = np.zeros(weights.shape)
    try:
        solution[on] = row[:, None] * np.linalg.solve(scaled, column[:, None] * weights[on])
    except np.linalg.LinAlgError as error:
        raise NoAnswer("no equilibrium: the contact cannot balance the actuation") from error
    return solution
