"""The substructures, gaps, loads and rigid-body modes of a group of shoes.

Nothing in this module depends on the friction coefficient of the drum.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from operator import attrgetter
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats, slices_from_lengths_of_consecutive_parts
from drumlin.base.lapack import block_diag
from drumlin.brake import clearance
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.components import Actuation
from drumlin.brake.one_sided import (
    BearingFlagsOfOneSidedSupports,
    OneSidedSupport,
    SupportPushOnShoe,
    one_sided_supports_of_brake,
    work_of_support_push_in_rigid_body_modes,
)
from drumlin.fem.equilibrium.modes import RigidBodyModes, make_rigid_body_modes
from drumlin.fem.preparation.bodies import (
    ShoeSubstructure,
    actuation_factors_and_pin_moment_per_newton,
    penalty_stiffness_of_contact_per_area,
    unit_load_factors_of_one_sided_support_push,
    unit_load_factors_under_all_loads,
)
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.fem.substructure.ring import RingFlexibility


class ActuationByOneNewton(NamedTuple):
    """The actuation of a shoe by a force of one newton.

    `load_column_factors` (l,) are the factors by which the load columns of the substructure make up
    the load. `moment_about_pin` is the moment of the actuation about the pin [m].
    """

    load_column_factors: Floats
    moment_about_pin: float


class GapClosuresOfTestModes(NamedTuple):
    """The effects of a shoe's k test modes on its n contact nodes, per unit of each mode.

    `normal` (n, k) are the closures N u of the gap, and `tangential` (n, k) the slips T u. Both are
    integrated along the contact line with the shape function of each node. A test mode is a
    rigid-body motion on which the shoe's support does no work.
    """

    normal: Floats
    tangential: Floats


class ContactTermsIndependentOfFriction(NamedTuple):
    """The parts of a shoe's contact problem that friction does not change.

    These are the weighted gaps q (n,) at zero pressure (integrals of the gap times each node's
    shape function), their opening B (n, k) per rigid-body mode, and the generalised forces h (k,)
    of the loads, which the pressures p balance by C p = h.
    """

    q: Floats
    B: Floats
    h: Floats


class FactorsOfRingFlexibility(NamedTuple):
    """Factors (m, n) whose products are the flexibility matrices of the drum's ring at n nodes.

    The weighted gaps (integrals of the gap times each node's shape function) that the ring opens
    are pressed^T pressed per pressure of the shoes, and pressed^T dragged per friction traction of
    the shoes.
    """

    pressed: Floats
    dragged: Floats


@dataclass(frozen=True)
class ShoeGroupData:
    """Shoes of a brake that are solved together, on a prepared model.

    All contact problems of the group are stated per newton of `largest_actuation_force`. If only
    one force acts, its size then changes the gaps alone.

    Attributes
    ----------
    prepared_model : the prepared model
    brake : the brake, whose friction, forces and clearances may differ from those of the model
    members : indices of the group's shoes in the brake
    penalty : factor alpha of the contact stiffness alpha E/t; inf for exact contact
    abutment_friction_directions_of_shoes : direction of the friction at each shoe's abutment: +1 or
        -1 along its face, 0 if the foot sticks. It is empty until
        `ShoeGroup.solve_contact_and_abutment_friction` has found the directions; a group with a
        rough abutment has no contact problem before.
    shoe_frictions_over_brake_friction : (shoes,) friction coefficient of each shoe divided by the
        brake's coefficient; empty to compute it from the brake, which is impossible once the
        brake's friction is set to 0
    bearing : whether each one-sided support of the group bears; empty until the solve has found
        which of them do. A group with such supports has no contact problem before.
    are_large_turns_allowed : whether a solution in which a shoe turns too far for small
        displacements is taken. The limit of self-locking needs such solutions: their pressures grow
        without bound, and with them the turns.
    node_frictions_over_brake_friction : (n,) friction coefficient at each contact node divided by
        the brake's coefficient; None if it is the same at all nodes of a shoe
    worn_depths_at_contact_nodes : (n,) [m], depth by which wear has opened the gap at the contact
        nodes of the group; None for unworn linings
    """

    prepared_model: PreparedModel
    brake: Brake
    members: tuple[int, ...]
    penalty: float = math.inf
    abutment_friction_directions_of_shoes: tuple[int, ...] = ()
    shoe_frictions_over_brake_friction: tuple[float, ...] = ()
    node_frictions_over_brake_friction: Floats | None = None
    worn_depths_at_contact_nodes: Floats | None = None
    bearing: BearingFlagsOfOneSidedSupports = ()
    are_large_turns_allowed: bool = False

    # These properties describe the shoes of the group and the friction on them.

    @cached_property
    def shoes(self) -> tuple[Shoe, ...]:
        """The shoes of the group."""
        return tuple(self.brake.shoes[i] for i in self.members)

    @cached_property
    def substructures_of_shoes(self) -> tuple[ShoeSubstructure, ...]:
        """The substructures of the shoes."""
        return tuple(self.prepared_model.bodies[i] for i in self.members)

    @property
    def names_of_shoes_as_text(self) -> str:
        """The names of the shoes as the text with which error messages begin."""
        return self.brake.text_with_names_of_shoes_at_indices(self.members)

    @property
    def has_abutment_with_friction(self) -> bool:
        """Whether friction acts at an abutment of the group."""
        return any(len(shoe.senses_of_abutment_friction_to_try) > 1 for shoe in self.shoes)

    @property
    def known_abutment_friction_directions(self) -> tuple[int, ...]:
        """The direction of friction at each shoe's abutment: +1 or -1 along its face.

        It is 0 for a foot that sticks, and +1 for a smooth or missing abutment. Raises RuntimeError
        if an abutment is rough and the direction is not known yet.
        """
        if not self.abutment_friction_directions_of_shoes and self.has_abutment_with_friction:
            raise RuntimeError(
                f"{self.names_of_shoes_as_text}: friction at the abutment has no sense yet, "
                "ask for `solve_contact_and_abutment_friction`"
            )
        return self.abutment_friction_directions_of_shoes or (1,) * len(self.members)

    @cached_property
    def friction_of_each_shoe_over_brake_friction(self) -> tuple[float, ...]:
        """The friction coefficient of each shoe's lining divided by the brake's coefficient."""
        return self.shoe_frictions_over_brake_friction or tuple(
            map(self.brake.shoe_friction_over_brake_friction, self.shoes)
        )

    @property
    def friction_stress_over_pressure_at_nodes(self) -> Floats:
        """The friction stress over pressure (n,) at each contact node, positive along e_theta."""
        return (
            self.brake.friction
            * self.brake.sign_of_motion
            * self.friction_of_nodes_over_brake_friction
        )

    def friction_stress_over_friction_coefficient_of_shoe(self, k: int, p: Floats) -> Floats:
        """The friction stress (n_k,) on shoe `k`, divided by the shoe's friction coefficient.

        It equals the pressures p (n_k,), unless the coefficient differs from node to node.
        """
        return np.asarray(self.node_friction_over_shoe_friction(k) * p)

    def node_friction_over_shoe_friction(self, k: int) -> Floats:
        """The friction coefficient (n_k,) at each node of shoe `k`, divided by the shoe's own."""
        nodes = self.contact_node_slices_of_shoes[k]
        if self.node_frictions_over_brake_friction is None:
            return np.ones(nodes.stop - nodes.start)
        own = self.node_frictions_over_brake_friction[nodes]
        return np.asarray(own / self.friction_of_each_shoe_over_brake_friction[k])

    # These properties give the indices of each shoe's unknowns among the unknowns of the group.

    @cached_property
    def contact_node_slices_of_shoes(self) -> tuple[slice, ...]:
        """The slice of each shoe's contact nodes among the nodes of the group."""
        return slices_from_lengths_of_consecutive_parts(
            len(body.line.nodes) for body in self.substructures_of_shoes
        )

    @cached_property
    def rigid_body_mode_slices_of_shoes(self) -> tuple[slice, ...]:
        """The slice of each shoe's rigid-body modes among the modes of the group."""
        return slices_from_lengths_of_consecutive_parts(
            modes.actuation_work.size for modes in self.rigid_body_modes_of_shoes
        )

    # These properties give the loads and the rigid-body modes of each shoe.

    @cached_property
    def largest_actuation_force(self) -> float:
        """The largest force [N] on a shoe; contact problems are stated per newton of this force."""
        return max(shoe.largest_force_of_any_load for shoe in self.shoes)

    @cached_property
    def actuation_forces_of_file_over_largest_force(self) -> Floats:
        """The actuation forces (shoes,) of the brake file, divided by `largest_actuation_force`."""
        return (
            np.array([shoe.actuation.force for shoe in self.shoes]) / self.largest_actuation_force
        )

    @cached_property
    def actuation_of_each_shoe_by_one_newton(self) -> tuple[ActuationByOneNewton, ...]:
        """The actuation of each shoe by a force of one newton."""
        return tuple(
            ActuationByOneNewton(*each)
            for each in map(
                actuation_factors_and_pin_moment_per_newton,
                self.substructures_of_shoes,
                self.shoes,
            )
        )

    @cached_property
    def rigid_body_modes_of_shoes(self) -> tuple[RigidBodyModes, ...]:
        """The rigid-body modes of each shoe."""
        found = []
        for k, sense in enumerate(self.known_abutment_friction_directions):
            moment = self.actuation_of_each_shoe_by_one_newton[k].moment_about_pin
            found.append(
                make_rigid_body_modes(self.substructures_of_shoes[k], self.shoes[k], moment, sense)
            )
        return tuple(found)

    @cached_property
    def gaps_of_unloaded_linings(self) -> tuple[Floats, ...]:
        """For each shoe the gaps (n_i,) [m] of its unloaded linings at contact nodes."""
        gaps = []
        for body, shoe, part in zip(
            self.substructures_of_shoes,
            self.shoes,
            self.contact_node_slices_of_shoes,
            strict=True,
        ):
            gap = unloaded_lining_gaps_at_points(body.line.xy, body.line.phi, self.brake, shoe)
            gaps.append(
                gap
                if self.worn_depths_at_contact_nodes is None
                else gap + self.worn_depths_at_contact_nodes[part]
            )
        return tuple(gaps)

    @cached_property
    def contact_stiffness_per_area_of_shoes(self) -> tuple[float, ...]:
        """The contact stiffness of each shoe per area [Pa/m]."""
        return tuple(
            penalty_stiffness_of_contact_per_area(shoe, self.penalty) for shoe in self.shoes
        )

    @cached_property
    def gap_closures_of_test_modes(self) -> tuple[GapClosuresOfTestModes, ...]:
        """The gap closures and slips of the test modes of each shoe."""
        closures = []
        for body, shoe, modes in zip(
            self.substructures_of_shoes, self.shoes, self.rigid_body_modes_of_shoes, strict=True
        ):
            if shoe.kind_of_support == "hinge":
                found = GapClosuresOfTestModes(*body.gap_closure_and_slip_per_turn_about_pin)
            else:
                coupling, u = body.coupling, modes.test_modes
                found = GapClosuresOfTestModes(coupling.N @ u, coupling.T @ u)
            closures.append(found)
        return tuple(closures)

    @cached_property
    def contact_terms_independent_of_friction(
        self,
    ) -> tuple[ContactTermsIndependentOfFriction, ...]:
        """The parts of each shoe's contact problem that friction does not change."""
        return tuple(map(self._contact_terms_of_shoe_without_friction, range(len(self.members))))

    def _contact_terms_of_shoe_without_friction(self, k: int) -> ContactTermsIndependentOfFriction:
        """The parts of the contact problem of shoe `k` that friction does not change."""
        body, modes = self.substructures_of_shoes[k], self.rigid_body_modes_of_shoes[k]
        own_force = self.shoes[k].actuation.force
        force = abs(own_force) / self.largest_actuation_force
        gap = body.coupling.M @ (self.gaps_of_unloaded_linings[k] / self.largest_actuation_force)
        acting = (
            unit_load_factors_under_all_loads(body, self.shoes[k], own_force)
            / self.largest_actuation_force
        )
        q = gap - body.flexibility.gap_closure_by_load @ acting
        # Without friction at an abutment the contact modes are the test modes.
        if modes.contact_modes is modes.test_modes:
            closure = self.gap_closures_of_test_modes[k].normal
        else:
            closure = body.coupling.N @ modes.contact_modes
        h = -force * modes.actuation_work
        if self.shoes[k].has_loads_besides_actuation:
            h = h - modes.work_of_further_loads / self.largest_actuation_force
        return ContactTermsIndependentOfFriction(q, -closure, h)

    # These properties describe supports that push and cannot pull.

    @cached_property
    def one_sided_supports(self) -> tuple[OneSidedSupport, ...]:
        """The group's one-sided supports; their shoe numbers are indices within the group."""
        found = []
        for support in one_sided_supports_of_brake(self.brake):
            if support.sides[0].shoe in self.members:
                sides = tuple(
                    side._replace(shoe=self.members.index(side.shoe)) for side in support.sides
                )
                found.append(support._replace(sides=sides))
        return tuple(found)

    def work_of_support_push_on_shoe_modes(self, k: int, push: Actuation) -> Floats:
        """The work (k,) of a one-sided support's push on the rigid-body modes of shoe `k`.

        For a push of 1 N it is also the opening of the support per unit of each mode.
        """
        shoe = self.shoes[k]
        work = work_of_support_push_in_rigid_body_modes(shoe, push)
        work[0] *= shoe.frame.sense
        return work

    def load_column_factors_of_support_push(self, side: SupportPushOnShoe) -> Floats:
        """The factors (l,) by which a shoe's load columns make up the push of a support by 1 N."""
        body, shoe = self.substructures_of_shoes[side.shoe], self.shoes[side.shoe]
        return unit_load_factors_of_one_sided_support_push(
            body, shoe, side.push_of_one_newton, self.brake.size
        )

    # These properties are integrals over the linings.

    @cached_property
    def torque_of_each_shoe_per_nodal_pressure(self) -> Floats:
        """The torque (n, shoes) [m^3] of each shoe per nodal pressure, for a brake friction of 1.

        The friction of a lining or node with a coefficient of its own is scaled in proportion.
        """
        levers = block_diag(*map(attrgetter("coupling.lever"), self.substructures_of_shoes))
        return np.asarray((levers * self.friction_of_nodes_over_brake_friction).T)

    @cached_property
    def friction_of_nodes_over_brake_friction(self) -> Floats:
        """The friction coefficient (n,) at each contact node divided by the brake's coefficient."""
        if self.node_frictions_over_brake_friction is not None:
            return self.node_frictions_over_brake_friction
        counts = [len(body.line.nodes) for body in self.substructures_of_shoes]
        return np.repeat(self.friction_of_each_shoe_over_brake_friction, counts)

    @cached_property
    def contact_node_areas(self) -> Floats:
        """The area (n,) [m^2] of each contact node; pressure times area is the nodal force."""
        return np.concatenate(
            list(map(attrgetter("coupling.areas_of_contact_nodes"), self.substructures_of_shoes))
        )

    @cached_property
    def mass_matrix_of_contact_nodes(self) -> Floats:
        """The mass matrix (n, n) [m^2] of the contact nodes; it turns gaps into weighted gaps.

        A weighted gap is the integral of the gap times the shape function of a node.
        """
        return np.asarray(block_diag(*map(attrgetter("coupling.M"), self.substructures_of_shoes)))

    # These properties describe the ring, the struts and the cam.

    @cached_property
    def factors_of_ring_flexibility(self) -> FactorsOfRingFlexibility | None:
        """The factors of the drum ring's flexibility under the linings; None without a ring."""
        ring = self.prepared_model.ring
        if ring is None:
            return None
        return FactorsOfRingFlexibility(
            pressed=np.hstack([ring.normal_half_flexibilities[i] for i in self.members]),
            dragged=np.hstack([ring.friction_half_flexibilities[i] for i in self.members]),
        )

    @cached_property
    def ring_flexibility(self) -> RingFlexibility | None:
        """The flexibility of the drum's ring under the linings; None without a ring."""
        ring = self.prepared_model.ring
        if ring is None:
            return None
        # Mostly the group has all shoes, and later groups of the same shoes need the product, too.
        if list(self.members) == list(range(len(ring.normal_half_flexibilities))):
            return ring.flexibility_under_all_linings
        factors = self.factors_of_ring_flexibility
        assert factors is not None
        return RingFlexibility.flexibility_from_half_flexibilities(*factors)

    @cached_property
    def indices_of_pushing_and_pushed_shoe_of_struts(self) -> list[tuple[int, int]]:
        """For each strut of the group, the indices of the pushing shoe and of the pushed shoe.

        The indices count within the group.
        """
        names = [shoe.name for shoe in self.shoes]
        pushed = self.brake.names_of_shoes_pushed_by_struts
        links = []
        for link in self.brake.links:
            if link.to in names and link.to in pushed:
                links.append((names.index(link.source), names.index(link.to)))
        return links

    @cached_property
    def indices_of_shoes_under_cam(self) -> list[int]:
        """The indices, within the group, of the shoes that a cam pushes; empty without a cam.

        The cam moves the points of actuation of these shoes by the same travel.
        """
        drive = self.brake.actuation
        if not drive or not drive.is_cam_or_wedge:
            return []
        pushed_by_struts = {to for _, to in self.indices_of_pushing_and_pushed_shoe_of_struts}
        return sorted(set(range(len(self.shoes))) - pushed_by_struts)

    @cached_property
    def sum_of_cam_forces_over_largest_force(self) -> float:
        """The sum of the cam's forces, per newton of `largest_actuation_force`; 0 without a cam."""
        if not self.brake.actuation or not self.indices_of_shoes_under_cam:
            return 0.0
        return (
            self.brake.actuation.force_of_cylinder_or_sum_of_cam_forces
            / self.largest_actuation_force
        )


def unloaded_lining_gaps_at_points(xy: Floats, phi: Floats, brake: Brake, shoe: Shoe) -> Floats:
    """The gaps (...) [m] of an unloaded lining at points of its friction surface.

    A gap is the sum of the point's distance from the drum's radius, the clearance and the misfit.

    Parameters
    ----------
    xy : coordinates (2, ...) [m] of the points in the frame of the shoe
    phi : angles (...) [rad] of the points in the frame of the shoe
    brake : the brake
    shoe : the shoe of the lining
    """
    theta, radius = shoe.frame.surface_coordinates_of_phi(phi), brake.size
    off = shoe.distances_from_friction_surface(xy, radius)
    # Round-off moves nodes off the drum's radius. This must not count as a gap or an overlap.
    off = np.where(np.abs(off) < 1e-12 * radius, 0.0, off)
    return off + clearance.gaps_between_unloaded_lining_and_surface(brake, shoe, theta)
