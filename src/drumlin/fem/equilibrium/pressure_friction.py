"""The contact of a group of shoes whose friction depends on the pressure."""

import math
from dataclasses import replace
from functools import partial

import numpy as np

from drumlin.base.arrays import Bools, Floats
from drumlin.base.errors import NoAnswer
from drumlin.brake.friction import FrictionOverPressureCurve
from drumlin.contact.active_set import ContactSolution
from drumlin.contact.pressure_friction import (
    FrictionFactorLimit,
    NodalFrictionAndSlope,
    find_largest_friction_factor_with_equilibrium,
    is_equilibrium_certain_up_to_friction_factor,
    is_newton_change_negligible,
    largest_change_relative_to_peak,
    solve_contact_with_pressure_dependent_friction,
)
from drumlin.fem.equilibrium.group import ShoeGroup, SolvedGroup

MAX_REPEATED_SOLVES_WITH_CHANGED_SUPPORTS = 5
"""Largest number of repetitions of a solve with pressure-dependent friction and changed supports.

The bearing one-sided supports and the directions of friction at abutments may differ between two
estimates of the linings' friction. Supports and directions are then found anew, and the solve is
repeated. Most brakes need one or two repetitions. A brake that needs more than this number is
refused.
"""


def solve_shoe_group_with_lining_friction(
    group: ShoeGroup, first: Bools | None = None
) -> SolvedGroup:
    """Solve the contact of a group whose linings have constant or pressure-dependent friction.

    The result has the friction coefficient of each node if friction depends on the pressure.
    `first` (n,) is a contact set to start from. Raises NoAnswer as
    `ShoeGroup.solve_contact_and_abutment_friction` does, and if the friction at the nodes does not
    come to agree with the pressures, as `is_newton_change_negligible` judges it.
    """
    curves = [group.brake.friction_coefficient_curve_of_shoe(shoe) for shoe in group.shoes]
    if all(len(curve.mu) == 1 for curve in curves):
        return group.solve_contact_and_abutment_friction(first)
    start, settled = _solve_group_at_smallest_else_largest_friction(group, curves, first)
    last_change = math.inf
    for _ in range(MAX_REPEATED_SOLVES_WITH_CHANGED_SUPPORTS):
        contact = _contact_whose_friction_fits_its_pressures(settled, start)
        friction = _friction_and_its_slopes_at_nodes(settled.group, contact.p).coefficient
        # The contact is solved once more at these fixed coefficients, as for any other brake. This
        # solve checks that friction growing from zero reaches this solution.
        settled = _solve_group_at_nodal_friction(settled.group, friction, contact.active)
        reached = _friction_and_its_slopes_at_nodes(settled.group, settled.contact.p).coefficient
        change = largest_change_relative_to_peak(reached, friction)
        if is_newton_change_negligible(change, last_change):
            return settled
        last_change = change
    raise NoAnswer(
        f"{group.names_of_shoes_as_text}: friction and pressure do not agree, not converged"
    )


def friction_and_its_slopes_at_nodes_of_group(group: ShoeGroup, p: Floats) -> NodalFrictionAndSlope:
    """The friction coefficients at nodal pressures p (n,) [Pa], and their derivatives [1/Pa]."""
    parts = []
    for shoe, nodes in zip(group.shoes, group.contact_node_slices_of_shoes, strict=True):
        curve = group.brake.friction_coefficient_curve_of_shoe(shoe)
        parts.append(
            NodalFrictionAndSlope(
                curve.friction_coefficients_at_pressures(p[nodes]),
                curve.friction_slopes_at_pressures(p[nodes]),
            )
        )
    return NodalFrictionAndSlope(*(np.concatenate(each) for each in zip(*parts, strict=True)))


def group_with_friction_at_nodes(group: ShoeGroup, friction: Floats) -> ShoeGroup:
    """A copy of a group with a friction coefficient (n,) for each of its contact nodes."""
    return replace(group, node_frictions_over_brake_friction=friction / group.brake.friction)


def find_friction_factor_that_locks_group(
    settled: SolvedGroup, largest_factor: float, *, single_step: bool = False
) -> FrictionFactorLimit:
    """Find the factor on all friction coefficients of a solved group at which the group locks.

    The bearing supports and the friction directions at abutments are those of the solution.

    Parameters
    ----------
    settled : the group, solved by `solve_shoe_group_with_lining_friction`
    largest_factor : factor at which the search ends without a limit
    single_step : whether a single step to the largest factor is tried before the search
    """
    group = settled.group
    unit = replace(group, node_frictions_over_brake_friction=np.ones(len(group.contact_node_areas)))
    problem, areas = unit.contact_problem_as_function_of_friction, group.contact_node_areas
    friction = partial(_friction_and_its_slopes_at_nodes, group)
    if single_step and is_equilibrium_certain_up_to_friction_factor(
        problem, friction, settled.contact, largest_factor, areas
    ):
        return FrictionFactorLimit(math.inf, False)
    return find_largest_friction_factor_with_equilibrium(
        problem, friction, settled.contact, largest_factor, areas
    )


def group_with_tangent_of_friction_stress(group: ShoeGroup, p: Floats) -> ShoeGroup:
    """A copy of a solved group whose friction coefficients are the slopes of the friction stress.

    The slope d(mu p)/dp = mu + p dmu/dp at nodal pressures p (n,) gives the change of the solution
    by a small change of the brake. The group itself is returned if friction does not depend on the
    pressure.
    """
    curves = [group.brake.friction_coefficient_curve_of_shoe(shoe) for shoe in group.shoes]
    if all(len(curve.mu) == 1 for curve in curves):
        return group
    friction = _friction_and_its_slopes_at_nodes(group, p)
    return group_with_friction_at_nodes(group, friction.coefficient + friction.slope * p)


def _solve_group_at_smallest_else_largest_friction(
    group: ShoeGroup, curves: list[FrictionOverPressureCurve], first: Bools | None
) -> tuple[Floats, SolvedGroup]:
    """Solve a group with the least friction of each lining's curve, or, failing that, the largest.

    Returns the friction coefficients (n,) of the nodes, and the solution. A shoe that needs
    friction to be pressed on the drum may have a solution only at the largest friction. If both
    solves fail, the error of the first is raised.
    """
    counts = [len(body.line.nodes) for body in group.substructures_of_shoes]
    least = np.repeat([curve.mu.min() for curve in curves], counts)
    largest = np.repeat([curve.mu.max() for curve in curves], counts)
    try:
        return least, _solve_group_at_nodal_friction(group, least, first)
    except NoAnswer as error:
        try:
            return largest, _solve_group_at_nodal_friction(group, largest, first)
        except NoAnswer:
            raise error from None


def _solve_group_at_nodal_friction(
    group: ShoeGroup, friction: Floats, first: Bools | None
) -> SolvedGroup:
    """Solve a group at given nodal friction (n,), starting from the contact set `first` (n,)."""
    return group_with_friction_at_nodes(group, friction).solve_contact_and_abutment_friction(first)


def _friction_and_its_slopes_at_nodes(group: ShoeGroup, p: Floats) -> NodalFrictionAndSlope:
    """The friction coefficients at nodal pressures p (n,), and their derivatives by pressure.

    The pressures are per newton of the group's largest actuation force.
    """
    size = group.largest_actuation_force
    found = friction_and_its_slopes_at_nodes_of_group(group, size * p)
    return NodalFrictionAndSlope(found.coefficient, size * found.slope)


def _contact_whose_friction_fits_its_pressures(
    settled: SolvedGroup, start: Floats
) -> ContactSolution:
    """The contact in which the friction at each node agrees with the pressure there.

    The bearing supports and the friction directions at abutments are those of `settled`. `start`
    (n,) are the friction coefficients at which the iteration begins.
    """
    group = settled.group
    # The problem of `unit` has the friction coefficient 1 at every node. Its terms with friction
    # can then be scaled by the coefficient of each node.
    unit = replace(group, node_frictions_over_brake_friction=np.ones(len(start)))
    try:
        return solve_contact_with_pressure_dependent_friction(
            unit.contact_problem_as_function_of_friction,
            lambda p: _friction_and_its_slopes_at_nodes(group, p),
            settled.contact,
            start,
        )
    except NoAnswer as error:
        raise NoAnswer(f"{group.names_of_shoes_as_text}: {error}") from error
