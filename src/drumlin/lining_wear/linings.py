"""Make the contact problems of a brake's linings, for the wear steps of `archard`.

The contact problems come from finite elements, with all supports and actuations of shoes, or from
the foundation model of post brakes.
"""

import math
from bisect import bisect_right
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from operator import attrgetter
from typing import NamedTuple, TypeVar

import numpy as np

from drumlin.base.arrays import Bools, Floats
from drumlin.base.errors import BadInput, NoAnswer
from drumlin.base.lapack import block_diag
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.fields import InterpolationTable, table_rows_from_coordinates_and_values
from drumlin.brake.file import vary
from drumlin.brake.further_loads import brake_with_springs_of_constant_pull
from drumlin.contact.active_set import ContactSolution
from drumlin.contact.equations import ContactProblem
from drumlin.contact.pressure_friction import NodalFrictionAndSlope
from drumlin.contact.self_locking import FrictionDependentProblem
from drumlin.fem.equilibrium.group import ShoeGroup, divide_pressed_shoes_into_groups
from drumlin.fem.equilibrium.pressure_friction import (
    friction_and_its_slopes_at_nodes_of_group,
    group_with_friction_at_nodes,
    solve_shoe_group_with_lining_friction,
)
from drumlin.fem.equilibrium.spring_nodes import (
    SpringNodes,
    contact_problem_with_spring_nodes,
    contact_without_spring_nodes,
    group_under_spring_pulls,
    spring_nodes_of_brake,
)
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.foundation import model as foundation
from drumlin.foundation.post import brake_angles_from_beam_angles
from drumlin.laws.hinged import actuation_moment_towards_drum
from drumlin.lining_wear.archard import (
    AbutmentFrictionCase,
    WearContactProblem,
    WearState,
    find_contact_set_from_soft_linings,
)

BrakeTypeVariableInWear = TypeVar("BrakeTypeVariableInWear", bound=Brake)


class WornLining(NamedTuple):
    """A lining of a shoe, and the positions of its unknowns among all contact unknowns of a brake.

    Linings that influence each other have one contact problem together, which is called an
    interface. A brake has one or more interfaces.

    Attributes
    ----------
    shoe : position of the shoe in the brake
    lining : position of the lining in the shoe, which may have several linings with slots between
        them (`Lining.arcs`)
    name : name of the shoe
    interface : number of the lining's interface
    part : slice of the lining's unknowns in the unknowns of all interfaces
    slice_in_interface : slice of the lining's unknowns in the unknowns of its interface
    theta : (n,) [rad], angles of the lining's contact unknowns; unknowns at the same angle across
        the width count once
    forward : slice that puts the angles `theta` in growing order
    order : degree of the interpolation of pressure and worn depth between the nodes
    across : (m,) [m], distances of the nodes across the width from the mid-plane; m = 1 in plane
        stress. The lining has n m unknowns, ordered by angle and then by distance.
    shares : (m,) fraction of the width that belongs to each node across the width; the sum is 1
    """

    shoe: int
    lining: int
    name: str
    interface: int
    part: slice
    slice_in_interface: slice
    theta: Floats
    forward: slice
    order: int
    across: Floats
    shares: Floats

    def lining_values_over_arc_and_width(self, values: Floats) -> Floats:
        """The values (n, m) of this lining by growing theta and by distance from the mid-plane.

        `values` holds one value for each contact unknown of all linings of the WearSetup.
        """
        return values[self.part].reshape(len(self.theta), -1)[self.forward]

    def lining_values_by_growing_angle(self, values: Floats) -> Floats:
        """The values (n,) of this lining, as means over the width, in the order of growing theta.

        `values` holds one value for each contact unknown of all linings of the WearSetup.
        """
        return self.lining_values_over_arc_and_width(values) @ self.shares

    @property
    def contact_angles_in_growing_order(self) -> Floats:
        """The angles theta (n,) [rad] of the lining's contact unknowns in growing order."""
        return self.theta[self.forward]


class WearSetup(NamedTuple):
    """A brake with the contact problems of its linings, ready for steps of wear.

    Attributes
    ----------
    brake : the brake
    model : name of the model that the contact problems come from, "fem", "solid" or "foundation"
    interfaces : groups of coupled linings; each group is one contact problem
    surfaces : each lining with the positions of its contact unknowns in the interfaces
    springs : the springs with a rate, whose forces are the last unknowns of the only interface;
        None without such springs
    at_constant_pulls : function that returns the setup of the same brake whose springs pull with
        constant forces [N]; None without springs with a rate
    """

    brake: Brake
    model: str
    interfaces: tuple[WearContactProblem, ...]
    surfaces: tuple[WornLining, ...]
    springs: SpringNodes | None = None
    at_constant_pulls: "Callable[[Sequence[float]], WearSetup] | None" = None

    @property
    def is_friction_dependent_on_pressure(self) -> bool:
        """Whether the friction of a lining depends on the pressure."""
        return any(interface.friction is not None for interface in self.interfaces)

    def state_with_spring_pulls_apart(self, state: WearState) -> WearState:
        """A copy of a state, with the springs' values moved from its arrays to its `pulls`.

        Raises NoAnswer if a spring is slack in this state.
        """
        if self.springs is None:
            return state
        n = len(state.pressure) - len(self.springs.numbers)
        pulls = self.springs.pulls_of_all_springs(self.brake, state.pressure[n:])
        return replace(state, depth=state.depth[:n], pressure=state.pressure[:n], pulls=pulls)

    @property
    def lining_stiffness_per_area(self) -> float:
        """The stiffness K = E/t [Pa/m] of the first worn lining: pressure divided by compression.

        E is the modulus through the lining's thickness t. With the wear coefficient k, 1/(k K) is
        the sliding distance over which wear reduces the difference of the pressure from its final
        value by a factor e, for a rigid shoe on independent springs.
        """
        lining = self.brake.shoes[self.surfaces[0].shoe].lining
        return lining.material.E_through / lining.thickness


class _LiningBeforeNumberingItsUnknowns(NamedTuple):
    """A lining of a group, before its unknowns have positions among all contact unknowns.

    `shoe` is the position of the shoe in the brake. The other attributes mean the same as in
    WornLining.
    """

    shoe: int
    lining: int
    theta: Floats
    order: int
    across: Floats
    shares: Floats


def wear_setup_by_finite_elements(
    scene: PreparedModel, brake: Brake, *, penalty: float = math.inf
) -> WearSetup:
    """The contact problems for the wear of a brake's linings, from its finite elements.

    Parameters
    ----------
    scene : prepared finite elements of the brake
    brake : the brake
    penalty : factor alpha of the contact stiffness alpha E/t per area; inf for a rigid contact

    Raises
    ------
    NoAnswer
        if no shoe touches the drum
    """
    springs = None
    if any(spring.rate for spring in brake.springs):
        springs = spring_nodes_of_brake(brake, _pulls_of_unworn_brake(scene, brake, penalty))
    interfaces: list[WearContactProblem] = []
    surfaces: list[WornLining] = []
    for group in divide_pressed_shoes_into_groups(scene, brake, penalty, springs_join=True):
        placed = []
        for i, body, shoe in zip(
            group.members, group.substructures_of_shoes, group.shoes, strict=True
        ):
            line = body.line
            phi, _ = line.angles_and_pressures_averaged_over_width(np.zeros(len(line.nodes)))
            theta = shoe.frame.surface_coordinates_of_phi(phi)
            for own in line.split_nodal_values_by_lining(theta):
                placed.append(
                    _LiningBeforeNumberingItsUnknowns(
                        i,
                        _position_of_lining_at_angles(shoe, own),
                        own,
                        line.interpolation_degree_along_contact_line,
                        line.node_distances_from_mid_plane,
                        line.width_fraction_of_each_node_across_width,
                    )
                )
        surfaces += _place_linings_among_contact_unknowns(brake, surfaces, len(interfaces), placed)
        interfaces.append(_wear_contact_problem_of_shoe_group(group, springs))
    setup = _make_wear_setup(brake, scene.model, interfaces, surfaces)
    if springs is None:
        return setup
    constant = wear_setup_by_finite_elements
    return setup._replace(
        springs=springs,
        at_constant_pulls=lambda pulls: constant(
            scene, brake_with_springs_of_constant_pull(brake, pulls), penalty=penalty
        ),
    )


def _pulls_of_unworn_brake(scene: PreparedModel, brake: Brake, penalty: float) -> tuple[float, ...]:
    """The pull [N] of each spring on the brake with unworn linings.

    If all springs with a rate have a preload, the result is the preload of each spring. If a spring
    with a rate has no preload, the sign of its pull is unknown, and the function solves the brake
    to find the pulls.
    """
    if all(spring.preload or not spring.rate for spring in brake.springs):
        return tuple(spring.preload for spring in brake.springs)
    return solve_prepared_model(scene, brake, penalty=penalty).spring_pulls


def _position_of_lining_at_angles(shoe: Shoe, theta: Floats) -> int:
    """The position, among the linings of a shoe, of the lining on which given points lie.

    `theta` (n,) are the coordinates of the points along the friction surface, angles [rad] on a
    drum and lengths [m] on a plane. All points lie on the same lining.
    """
    starts = [start for start, _ in shoe.lining.arcs]
    return max(bisect_right(starts, float(theta.mean())) - 1, 0)


def _wear_contact_problem_of_shoe_group(
    group: ShoeGroup, springs: SpringNodes | None
) -> WearContactProblem:
    """The contact problem of a group of coupled shoes, for steps of wear.

    Friction at an abutment may act in several ways: the shoe's foot slides one way or the other,
    or sticks. The result has a contact problem (`AbutmentFrictionCase`) for each of these cases.
    The forces of `springs` with a rate are the last unknowns.
    """
    ways = tuple(group.groups_with_each_abutment_friction_direction())
    first, *others = ways
    further = 0 if springs is None else len(springs.numbers)
    couplings = list(map(attrgetter("coupling"), group.substructures_of_shoes))
    gap = np.concatenate(group.gaps_of_unloaded_linings)
    case = _abutment_friction_case_of_group(first, springs)
    torque = group.brake.friction * group.torque_of_each_shoe_per_nodal_pressure.sum(axis=1)
    friction = None
    if _depends_friction_of_group_on_pressure(group):
        # `torque` is then the torque per friction stress, and not per pressure.
        torque = np.concatenate(list(map(attrgetter("lever"), couplings)))
        friction = partial(_friction_of_linings_and_spring_nodes, group, further)
    area = np.concatenate(list(map(attrgetter("areas_of_contact_nodes"), couplings)))
    nothing = np.zeros(further)
    mass = group.mass_matrix_of_contact_nodes
    return WearContactProblem(
        problem=case.problem,
        loaded=case.problem.q - np.append(mass @ gap, nothing),
        weight=block_diag(mass, np.zeros((further, further))) if further else mass,
        pressure=np.ones(len(gap) + further),
        area=np.append(area, nothing),
        torque=np.append(torque, nothing),
        is_consistent_with_solution=case.is_consistent_with_solution,
        others=tuple(_abutment_friction_case_of_group(way, springs) for way in others),
        settle=partial(_find_friction_case_and_contact_of_worn_lining_group, ways, further),
        over_friction=case.over_friction,
        friction=friction,
    )


def _depends_friction_of_group_on_pressure(group: ShoeGroup) -> bool:
    """Whether the friction coefficient of a lining of the group depends on the pressure."""
    curves = map(group.brake.friction_coefficient_curve_of_shoe, group.shoes)
    return any(len(curve.mu) > 1 for curve in curves)


def _friction_of_linings_and_spring_nodes(
    group: ShoeGroup, further: int, p: Floats
) -> NodalFrictionAndSlope:
    """The friction coefficients of linings at pressures p (n + further,) [Pa], and their slopes.

    The last `further` entries of p and of the result belong to springs. The result is 0 there.
    """
    found = friction_and_its_slopes_at_nodes_of_group(group, p[: len(p) - further])
    nothing = np.zeros(further)
    return NodalFrictionAndSlope(
        np.append(found.coefficient, nothing), np.append(found.slope, nothing)
    )


def _abutment_friction_case_of_group(
    group: ShoeGroup, springs: SpringNodes | None
) -> AbutmentFrictionCase:
    """The case of friction at the abutments of a group, with its contact problem in newtons."""
    is_consistent_with_solution = partial(
        _are_abutment_friction_and_supports_as_assumed, group, springs
    )
    problem = _contact_problem_in_newtons(group, group.brake.friction, springs)
    if not _depends_friction_of_group_on_pressure(group):
        return AbutmentFrictionCase(problem, is_consistent_with_solution)
    # `unit` has the friction coefficient 1 at every node. Its terms with friction can therefore be
    # multiplied by the real coefficient of each node later.
    unit = replace(group, node_frictions_over_brake_friction=np.ones(len(group.contact_node_areas)))
    over_friction = FrictionDependentProblem.linear_function_of_friction_from_two_problems(
        _contact_problem_in_newtons(unit, 0.0, springs),
        _contact_problem_in_newtons(unit, 1.0, springs),
    )
    return AbutmentFrictionCase(problem, is_consistent_with_solution, over_friction)


def _find_friction_case_and_contact_of_worn_lining_group(
    ways: Sequence[ShoeGroup], further: int, depth: Floats
) -> tuple[int, Bools]:
    """Solve the contact of worn linings without a first guess.

    Returns the position in `ways` of the friction case of the solution, and a mask (n,) of the
    unknowns in contact.

    Parameters
    ----------
    ways : the group of shoes, once for each case of friction at the abutments; the search starts
        from the first case
    further : number of the unknowns of springs, which follow the contact unknowns and count as in
        contact; the search assumes that the springs pull with their preloads
    depth : worn depth (n,) [m] at the contact unknowns

    Raises
    ------
    NoAnswer
        if the worn linings have no equilibrium
    """
    worn = replace(ways[0], worn_depths_at_contact_nodes=depth[: len(depth) - further])
    try:
        settled, contact = solve_shoe_group_with_lining_friction(worn)
    except NoAnswer:
        # The search without a first guess may miss an equilibrium. The contact of very soft linings
        # is easy to find. From there the contact is followed as the linings become stiffer, which
        # gives a first guess.
        active = find_contact_set_from_soft_linings(
            worn.contact_problem_of_group, worn.mass_matrix_of_contact_nodes
        )
        if active is None:
            raise
        settled, contact = solve_shoe_group_with_lining_friction(worn, active)
    # A solution belongs to the case in `ways` with the same senses of friction at the abutments and
    # the same supports in contact.
    choices = attrgetter("known_abutment_friction_directions", "bearing")
    active = np.append(contact.active, np.ones(further, dtype=bool))
    return list(map(choices, ways)).index(choices(settled)), active


def brake_with_added_worn_depths(
    brake: Brake, depths: Mapping[tuple[int, int], tuple[Floats, Floats]]
) -> Brake:
    """The brake with worn linings: the worn depth is added to the clearance of each lining.

    The keys of `depths` are the pairs (`WornLining.shoe`, `WornLining.lining`) of the worn linings.
    The values are growing angles (n,) [rad] and the worn depth (n,) [m] at these angles.
    """
    clearances: dict[tuple[int, int], InterpolationTable] = {}
    for place, (theta, depth) in depths.items():
        lining = brake.shoes[place[0]].lining
        clearances[place] = table_rows_from_coordinates_and_values(
            theta, lining.clearances_at_surface_coordinates(theta) + depth
        )
    return brake_with_given_lining_clearances(brake, clearances)


def brake_with_given_lining_clearances(
    brake: BrakeTypeVariableInWear, clearances: Mapping[tuple[int, int], InterpolationTable]
) -> BrakeTypeVariableInWear:
    """A copy of the brake in which some shoes have new clearances.

    The keys of `clearances` are the pairs (`WornLining.shoe`, `WornLining.lining`). If a lining of
    a shoe is among the keys, all linings of this shoe must be. The values are tables of clearance
    by angle.
    """
    shoes = list(brake.shoes)
    for i in {shoe for shoe, _ in clearances}:
        lining = shoes[i].lining
        own = [clearances[i, k] for k in range(len(lining.arcs))]
        shoes[i] = shoes[i].model_copy(
            update={"lining": lining.copy_of_lining_with_other_clearances(own)}
        )
    return brake.model_copy(update={"shoes": tuple(shoes)})


def _contact_problem_in_newtons(
    group: ShoeGroup, friction: float, springs: SpringNodes | None
) -> ContactProblem:
    """The contact problem of a group of shoes at a friction coefficient, with loads in newtons.

    The methods of the group, in contrast, measure forces in units of the group's largest actuation
    force. The forces of `springs` with a rate are the last unknowns.
    """
    if springs is None:
        size = group.largest_actuation_force
        problem = (
            group.contact_problem_of_group
            if friction == group.brake.friction
            else group.contact_problem_of_group_at_friction(friction)
        )
    else:
        under = group_under_spring_pulls(group, None)
        size = under.largest_actuation_force
        problem = contact_problem_with_spring_nodes(under, springs, friction)
    return problem._replace(q=size * problem.q, h=size * problem.h)


def _are_abutment_friction_and_supports_as_assumed(
    group: ShoeGroup, springs: SpringNodes | None, contact: ContactSolution
) -> bool:
    """Whether a solution agrees with what was assumed at the supports of a group of shoes.

    Friction at an abutment must oppose the slide of the shoe's foot or hold the foot. Each
    one-sided support must touch or be free as assumed. `contact` is the solution in newtons, with
    the forces of `springs` with a rate after the pressures.
    """
    if group.has_neither_strut_cam_nor_abutment:
        return True
    own = contact
    if springs is not None:
        own = contact_without_spring_nodes(contact, springs)
        forces = contact.p[len(own.p) :]
        group = group_under_spring_pulls(group, springs.pulls_of_all_springs(group.brake, forces))
    if _depends_friction_of_group_on_pressure(group):
        found = friction_and_its_slopes_at_nodes_of_group(group, own.p)
        group = group_with_friction_at_nodes(group, found.coefficient)
    size = group.largest_actuation_force
    unit = replace(own, p=own.p / size, y=own.y / size)
    return group.does_contact_confirm_support_assumptions(unit)


def wear_setup_by_foundation_model(
    brake: Brake,
    *,
    sections: int = foundation.DEFAULT_DIVISIONS_OF_SHOE_BEAM,
    lift: Iterable[str] = (),
) -> WearSetup:
    """The contact problems for the wear of a post brake's linings, from the foundation model.

    Parameters
    ----------
    brake : the brake
    sections : number of divisions of each shoe's beam
    lift : names in `foundation.INCLUDABLE_EFFECTS` of the effects that the model includes

    Raises
    ------
    BadInput
        if the model does not apply to the brake, and for an unknown name in `lift`
    NoAnswer
        if no shoe touches the drum
    """
    reason = foundation.reason_against_foundation_model(brake)
    if reason is not None:
        raise BadInput(f"foundation does not apply to this brake: {reason}")
    names = foundation.validated_names_of_effects_to_include(brake, lift)
    touching = [i for i, shoe in enumerate(brake.shoes) if actuation_moment_towards_drum(shoe) > 0]
    # Shoes influence each other only if the drum is an elastic ring, and the model includes how the
    # pressure of each shoe bends this ring.
    meet = brake.ring is not None and "own-pressure" in names
    groups = [touching] if meet and touching else [[i] for i in touching]
    interfaces: list[WearContactProblem] = []
    surfaces: list[WornLining] = []
    for group in groups:
        system = foundation.contact_problem_of_shoe_group(brake, group, sections, names)
        areas, gaps, placed, torques = [], [], [], []
        for i, post in zip(group, system.posts, strict=True):
            shoe = brake.shoes[i]
            gaps.append(post.gap)
            areas.append(shoe.lining.width * brake.size * post.sector)
            torques.append(brake.friction_coefficient_of_shoe_at_zero_pressure(shoe) * areas[-1])
            theta = brake_angles_from_beam_angles(post.axis, shoe, post.theta)
            for own in np.split(theta, post.further_linings):
                k = _position_of_lining_at_angles(shoe, own)
                placed.append(
                    _LiningBeforeNumberingItsUnknowns(i, k, own, 1, np.zeros(1), np.ones(1))
                )
        surfaces += _place_linings_among_contact_unknowns(brake, surfaces, len(interfaces), placed)
        area = np.concatenate(areas)
        # The contact unknowns are the normal forces [N] on the sectors of the linings.
        interfaces.append(
            WearContactProblem(
                problem=system.problem,
                loaded=system.problem.q - np.concatenate(gaps),
                weight=np.eye(len(area)),
                pressure=1 / area,
                area=area,
                torque=brake.size * np.concatenate(torques),
            )
        )
    return _make_wear_setup(brake, "foundation", interfaces, surfaces)


def brake_with_shoes_on_guides(brake: BrakeTypeVariableInWear) -> BrakeTypeVariableInWear:
    """The brake with each shoe on a straight guide in place of its hinge, pivot or abutment.

    On a drum the guide has the direction of the radius at the lining's middle. On a plane it has
    the direction of the plane's normal.
    """
    changes: dict[str, object] = {}
    for i, shoe in enumerate(brake.shoes):
        for key in ("hinge", "pivot", "abutment"):
            changes[f"shoe[{i}].{key}"] = None
        changes[f"shoe[{i}].guide"] = {
            "direction": shoe.angle_of_direction_in_which_lining_closes_gap
        }
    return vary(brake, changes)


def _place_linings_among_contact_unknowns(
    brake: Brake,
    before: Sequence[WornLining],
    interface: int,
    placed: Sequence[_LiningBeforeNumberingItsUnknowns],
) -> list[WornLining]:
    """The linings of one group with the positions of their contact unknowns in the wear setup.

    Parameters
    ----------
    brake : the brake
    before : linings of all earlier groups
    interface : position of the group in the setup
    placed : linings of the group, in the order of its contact unknowns
    """
    offset = before[-1].part.stop if before else 0
    first = 0
    surfaces = []
    for i, lining, theta, order, across, shares in placed:
        n = len(theta) * len(across)
        surfaces.append(
            WornLining(
                shoe=i,
                lining=lining,
                name=brake.shoes[i].name,
                interface=interface,
                part=slice(offset + first, offset + first + n),
                slice_in_interface=slice(first, first + n),
                theta=theta,
                forward=slice(None, None, 1 if theta[-1] > theta[0] else -1),
                order=order,
                across=across,
                shares=shares,
            )
        )
        first += n
    return surfaces


def _make_wear_setup(
    brake: Brake, model: str, interfaces: list[WearContactProblem], surfaces: list[WornLining]
) -> WearSetup:
    """The wear setup from groups of linings. Raises NoAnswer if no shoe touches the drum.

    Parameters
    ----------
    brake : the brake
    model : name of the model, "fem", "solid" or "foundation"
    interfaces : groups of coupled linings; each group is one contact problem
    surfaces : each lining with the positions of its contact unknowns
    """
    if not interfaces:
        raise NoAnswer("no contact: no shoe is turned towards the drum, so that nothing wears")
    return WearSetup(brake, model, tuple(interfaces), tuple(surfaces))
