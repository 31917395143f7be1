"""The pulls of springs with a rate as unknowns of the contact problem of a group of shoes.

A spring of the preload T_0 and the rate k pulls by T = T_0 - k d, where d is the motion by which
its two points come nearer to each other. The spring takes the form of a contact node. With the sign
s of its preload, its pull t = s T takes the place of a pressure, and s d + (t - s T_0)/k takes the
place of a gap. This gap is zero as long as the spring acts, and opens when the spring goes slack.
All contact solvers then find the pulls together with the pressures, in one problem.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.base.errors import AnswerBeyondModel
from drumlin.brake.brake import Brake
from drumlin.brake.further_loads import brake_with_loads_assigned_to_shoes
from drumlin.contact.active_set import ContactSolution
from drumlin.contact.equations import ContactProblem
from drumlin.fem.equilibrium.group import ShoeGroup
from drumlin.fem.equilibrium.one_sided import contact_problem_on_supports_that_bear
from drumlin.fem.equilibrium.sharing import (
    EffectsOfActuationForceOnShoe,
    make_contact_problem_with_strut_and_cam_forces,
)
from drumlin.fem.preparation.bodies import unit_load_factors_under_all_loads


class SpringNodes(NamedTuple):
    """The springs with a rate of a brake, as m nodes after the contact nodes of a group of shoes.

    Attributes
    ----------
    numbers : indices (m,) of the springs among all springs of the brake
    signs : sign (m,) of the pulls: 1 for springs that pull, -1 for springs that push
    rates : rate (m,) of each spring [N/m]
    preloads : preload (m,) of each spring [N]
    """

    numbers: Ints
    signs: Floats
    rates: Floats
    preloads: Floats

    def pulls_of_all_springs(self, brake: Brake, forces: Floats) -> tuple[float, ...]:
        """The pull [N] of each spring of the brake, under forces (m,) [N] of the spring nodes.

        Raises NoAnswer if a spring is slack.
        """
        pulls = np.array([spring.preload for spring in brake.springs])
        signs = dict(zip(self.numbers.tolist(), self.signs.tolist(), strict=True))
        pulls[self.numbers] = self.signs * forces
        for i, force in zip(self.numbers.tolist(), forces.tolist(), strict=True):
            if force <= 0:
                preload = brake.springs[i].preload
                # The pull of a spring without preload has the sign of its pull in `solve`.
                verb = ("pushes", "pull") if signs[i] < 0 else ("pulls", "push")
                cause = "by its preload" if preload else "in solve, without a preload,"
                raise AnswerBeyondModel(
                    f"spring[{i}]: goes slack: it {verb[0]} {cause} and would have to {verb[1]}"
                )
        return tuple(pulls.tolist())


def spring_nodes_of_brake(brake: Brake, pulls: Sequence[float]) -> SpringNodes:
    """Make nodes of a contact problem from the springs of a brake that have a rate.

    `pulls` [N] are pulls of all springs. They give the signs of springs without a preload.
    """
    numbers = [i for i, spring in enumerate(brake.springs) if spring.rate]
    preloads = np.array([brake.springs[i].preload for i in numbers])
    known = np.where(preloads == 0, np.array([pulls[i] for i in numbers]), preloads)
    return SpringNodes(
        np.array(numbers, dtype=int),
        np.where(known < 0, -1.0, 1.0),
        np.array([brake.springs[i].rate for i in numbers]),
        preloads,
    )


def group_under_spring_pulls(group: ShoeGroup, pulls: Sequence[float] | None) -> ShoeGroup:
    """A copy of a group whose shoes are loaded by given pulls [N] of all springs of the brake.

    If `pulls` is None, each spring without a rate pulls by its preload. Springs with a rate do not
    act, because their pulls are unknowns.
    """
    if pulls is None:
        pulls = [0.0 if spring.rate else spring.preload for spring in group.brake.springs]
    return replace(group, brake=brake_with_loads_assigned_to_shoes(group.brake, pulls))


class SpringBorder(NamedTuple):
    """The rows and columns of m spring nodes in the contact problem of a group.

    The group is a result of `group_under_spring_pulls` with the pulls None. Forces, pressures and
    motions are per newton of the group's largest actuation force.

    Attributes
    ----------
    gap_by_force : opening (n, m) of the weighted gaps (integrals of the gap times each contact
        node's shape function) per force of a spring node
    work : work (k, m) of the forces on the test modes
    opening_by_pressure : opening (m, n) of the nodes per pressure
    opening_by_motion : opening (m, k) per rigid-body motion
    opening_by_force : opening (m, m) per force of a node
    opening : opening (m,) under the loads, per newton of the group's actuation force
    """

    gap_by_force: Floats
    work: Floats
    opening_by_pressure: Floats
    opening_by_motion: Floats
    opening_by_force: Floats
    opening: Floats


def spring_border_at_friction(
    group: ShoeGroup, nodes: SpringNodes, friction: float
) -> SpringBorder:
    """The rows and columns of spring nodes in the contact problem at a friction coefficient."""
    springs, numbers, size = (
        group.spring_matrices_at_friction(friction),
        nodes.numbers,
        group.largest_actuation_force,
    )
    signs = nodes.signs
    opening = -nodes.preloads / (nodes.rates * size)
    for k, body in enumerate(group.substructures_of_shoes):
        own_force = group.shoes[k].actuation.force
        acting = unit_load_factors_under_all_loads(body, group.shoes[k], own_force) / size
        motion = body.flexibility.load_point_motion_by_load @ acting
        for row, j in enumerate(numbers.tolist()):
            opening[row] += float(springs.load_column_factors[j][k] @ motion)
    of_pulls = springs.approach_by_pull[np.ix_(numbers, numbers)]
    return SpringBorder(
        gap_by_force=springs.gap_by_pull[:, numbers] * signs,
        work=springs.work[:, numbers] * signs,
        opening_by_pressure=signs[:, None] * springs.approach_by_pressure[numbers],
        opening_by_motion=signs[:, None] * springs.approach_by_motion[numbers],
        opening_by_force=np.diag(1 / nodes.rates) + signs[:, None] * of_pulls * signs,
        opening=signs * opening,
    )


def contact_problem_with_spring_nodes(
    group: ShoeGroup, nodes: SpringNodes, friction: float
) -> ContactProblem:
    """The contact problem of a group at a friction coefficient, with spring nodes at its end.

    The group is a result of `group_under_spring_pulls` with the pulls None. If it has one-sided
    supports, it must be known which of them bear, and they must hold the shoes. The problem is
    linear in the friction coefficient.
    """
    A, q, B, C, h = group.contact_problem_with_given_actuation_forces(friction)
    border = spring_border_at_friction(group, nodes, friction)
    problem = ContactProblem(
        A=np.block(
            [[A, border.gap_by_force], [border.opening_by_pressure, border.opening_by_force]]
        ),
        q=np.concatenate([q, border.opening]),
        B=np.vstack([B, border.opening_by_motion]),
        C=np.hstack([C, border.work]),
        h=h,
    )
    if group.one_sided_supports:
        return _contact_problem_with_spring_nodes_on_bearing_supports(
            group, nodes, friction, problem
        )
    struts, cam = (
        group.indices_of_pushing_and_pushed_shoe_of_struts,
        group.indices_of_shoes_under_cam,
    )
    if not struts and not cam:
        return problem
    return make_contact_problem_with_strut_and_cam_forces(
        problem,
        actuation_effects_with_spring_nodes(group, nodes, friction),
        group.actuation_forces_of_file_over_largest_force,
        struts,
        cam,
        group.sum_of_cam_forces_over_largest_force,
    ).problem


def opening_of_one_sided_supports_by_spring_forces(group: ShoeGroup, nodes: SpringNodes) -> Floats:
    """The opening (supports, m) of each one-sided support per force of each of m spring nodes.

    It is also the opening of the spring nodes per force of a support.
    """
    return group.openings_of_one_sided_supports_by_pulls()[:, nodes.numbers] * nodes.signs


def _contact_problem_with_spring_nodes_on_bearing_supports(
    group: ShoeGroup, nodes: SpringNodes, friction: float, problem: ContactProblem
) -> ContactProblem:
    """The contact problem with spring nodes on the one-sided supports that bear.

    `problem` is the problem with spring nodes in which no support acts. Raises RuntimeError if it
    is not known which supports bear, or if they do not hold the shoes.
    """
    matrices = group.one_sided_support_matrices_at_friction(friction)
    by_spring = opening_of_one_sided_supports_by_spring_forces(group, nodes)
    with_springs = replace(
        matrices,
        opening_by_pressure=np.hstack([matrices.opening_by_pressure, by_spring]),
        gap_by_force=np.vstack([matrices.gap_by_force, by_spring.T]),
    )
    found = contact_problem_on_supports_that_bear(problem, with_springs, group.bearing)
    if found is None:
        raise RuntimeError(f"{group.names_of_shoes_as_text}: it is not known which supports bear")
    return found.problem


def actuation_effects_with_spring_nodes(
    group: ShoeGroup, nodes: SpringNodes, friction: float, first: int | None = None
) -> list[EffectsOfActuationForceOnShoe]:
    """The effects of each actuation force, with spring nodes after the contact nodes of each shoe.

    `first` is the index of the first spring node among the nodes of the group. If it is None, the
    spring nodes follow the contact nodes of the linings.
    """
    springs, numbers = group.spring_matrices_at_friction(friction), nodes.numbers
    n = len(group.contact_node_areas)
    first = n if first is None else first
    approach = group.approach_of_springs_by_surface_motion(springs)[numbers]
    effects = []
    for k, own in enumerate(group.contact_effects_of_each_actuation_force(friction)):
        places = np.append(np.arange(n)[own.nodes], first + np.arange(len(numbers)))
        effects.append(
            own._replace(
                nodes=places,
                gap_by_force=np.append(
                    own.gap_by_force, nodes.signs * springs.approach_by_force[numbers, k]
                ),
                load_point_travel_by_pressure=np.append(
                    own.load_point_travel_by_pressure,
                    nodes.signs * springs.tip_travel_by_pull[k, numbers],
                ),
                foot_force_by_pressure=np.append(
                    own.foot_force_by_pressure,
                    nodes.signs * springs.foot_force_by_pull[k, numbers],
                ),
                gap_by_surface_motion=np.append(
                    own.gap_by_surface_motion, nodes.signs * approach[:, k]
                ),
            )
        )
    return effects


def contact_without_spring_nodes(contact: ContactSolution, nodes: SpringNodes) -> ContactSolution:
    """The part of a solution with spring nodes that belongs to the contact nodes of the linings."""
    n = len(contact.p) - len(nodes.numbers)
    return replace(contact, p=contact.p[:n], w=contact.w[:n], active=contact.active[:n])
