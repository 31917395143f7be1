"""The contact problem of a group of shoes in full slip, at any friction coefficient."""

from collections.abc import Sequence
from functools import cached_property
from itertools import product
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.lapack import block_diag
from drumlin.brake.brake import Shoe
from drumlin.brake.one_sided import (
    BearingFlagsOfOneSidedSupports,
    OneSidedSupportForce,
    forces_of_one_sided_supports_on_shoe,
)
from drumlin.contact.active_set import ContactSolution
from drumlin.contact.equations import ContactProblem
from drumlin.contact.self_locking import FrictionDependentProblem
from drumlin.fem.equilibrium.one_sided import (
    ContactProblemOnBearingSupports,
    OneSidedSupportMatrices,
    contact_problem_on_supports_that_bear,
)
from drumlin.fem.equilibrium.sharing import (
    ContactProblemWithStrutAndCamForces,
    EffectsOfActuationForceOnShoe,
    make_contact_problem_with_strut_and_cam_forces,
    surface_motions_by_load_point_travels,
)
from drumlin.fem.equilibrium.springs import (
    SpringMatrices,
    displacement_of_point_along_force_in_modes,
    unit_pulls_on_shoe,
    work_of_force_on_test_modes,
)
from drumlin.fem.equilibrium.state import ShoeGroupData
from drumlin.fem.preparation.bodies import (
    ShoeSubstructure,
    unit_load_factors_of_force_at_point,
    unit_load_factors_of_loads_besides_actuation,
    unit_load_factors_under_all_loads,
)

COMPLIANCE_ROWS_ASSEMBLED_AT_A_TIME = 64
"""Number of rows of a shoe's compliance matrix that are assembled at a time.

With more rows the parts of a large matrix do not fit into the processor's cache; fewer rows take
more calls of numpy. The number changes no result.
"""


class _FootOfShoe(NamedTuple):
    """What the foot of a shoe transmits, and how the shoe follows it.

    `EffectsOfActuationForceOnShoe` describes the four values, of `foot_force_by_pressure` to
    `surface_motion_by_foot_travel`.
    """

    force_by_pressure: Floats
    force_by_actuation_force: float
    force_by_further_loads: float
    surface_motion_by_travel: float


class ContactProblemsOfShoeGroup(ShoeGroupData):
    """A group of shoes with its contact problem at every friction coefficient of the drum.

    The drum drags the linings by the traction mu p. The weighted gap is w = M (g + p/eps) - N u +
    N_ring u_ring. Here g is the gap of the unloaded lining, and eps the stiffness of the contact.
    The gap closes as the lining moves by u, and opens as the drum's ring moves by u_ring. The
    displacement u has an elastic part and a part due to the rigid-body modes with the coordinates
    y. C p = h are the equilibria in the test modes, the rigid-body motions on which the supports do
    no work.
    """

    @cached_property
    def contact_problem_of_group(self) -> ContactProblem:
        """The contact problem at the friction coefficient of the brake."""
        return self.contact_problem_of_group_at_friction(self.brake.friction)

    @property
    def contact_problem_as_function_of_friction(self) -> FrictionDependentProblem:
        """The contact problem as a linear function of the friction coefficient.

        The prepared model must include friction.
        """
        return FrictionDependentProblem.linear_function_of_friction_from_two_problems(
            self.contact_problem_of_group_at_friction(0.0),
            self.contact_problem_of_group_at_friction(1.0),
        )

    def contact_problem_of_group_at_friction(self, friction: float) -> ContactProblem:
        """The contact problem of the group at a friction coefficient.

        Its matrices are linear functions of the friction coefficient.
        """
        supports = self._contact_problem_on_bearing_supports(friction)
        if supports is not None:
            return supports.problem
        sharing = self._strut_and_cam_contact_problem_at_friction(friction)
        return (
            self.contact_problem_with_given_actuation_forces(friction)
            if sharing is None
            else sharing.problem
        )

    def contact_problem_with_given_actuation_forces(self, friction: float) -> ContactProblem:
        """The contact problem of the group at a friction coefficient, under given forces.

        Each shoe has its actuation force of the brake file. Struts, a cam and one-sided supports
        are neglected. The matrices of single shoes are the blocks of the group's matrices, and the
        flexibility of the drum's ring is added.
        """
        parts = [
            self._contact_problem_of_single_shoe(k, friction) for k in range(len(self.members))
        ]
        if self.prepared_model.ring is None and len(parts) == 1:
            return parts[0]
        A, q, B, C, h = zip(*parts, strict=True)
        compliance = block_diag(*A)
        if self.ring_flexibility is not None:
            drags = (
                friction * self.brake.sign_of_motion * self.friction_of_nodes_over_brake_friction
            )
            compliance += self.ring_flexibility.pressed
            compliance += drags * self.ring_flexibility.dragged
        return ContactProblem(
            compliance, np.concatenate(q), block_diag(*B), block_diag(*C), np.concatenate(h)
        )

    def _contact_problem_of_single_shoe(self, k: int, friction: float) -> ContactProblem:
        """The contact problem of shoe `k` alone on a rigid drum, at a friction coefficient."""
        drag = self._friction_coefficient_signed_by_drag_on_shoe(k, friction)
        terms, closures = (
            self.contact_terms_independent_of_friction[k],
            self.gap_closures_of_test_modes[k],
        )
        A = _shoe_compliance_with_penalty(
            self.substructures_of_shoes[k], drag, self.contact_stiffness_per_area_of_shoes[k]
        )
        C = (np.reshape(drag, (-1, 1)) * closures.tangential - closures.normal).T
        return ContactProblem(A, terms.q, terms.B, C, terms.h)

    def _friction_coefficient_signed_by_drag_on_shoe(
        self, k: int, friction: float
    ) -> float | Floats:
        """The friction coefficient of shoe `k`, signed by the sense of drag in the shoe's frame.

        It is an array (n_k,) if the coefficient differs from node to node. `friction` is the
        friction coefficient of the brake.
        """
        own: float | Floats = friction * self.friction_of_each_shoe_over_brake_friction[k]
        if self.node_frictions_over_brake_friction is not None:
            own = (
                friction
                * self.node_frictions_over_brake_friction[self.contact_node_slices_of_shoes[k]]
            )
        return own * self.brake.sign_of_motion * self.shoes[k].frame.sense

    # The following methods treat the forces of struts and of a cam.

    @cached_property
    def strut_and_cam_contact_problem_or_none(self) -> ContactProblemWithStrutAndCamForces | None:
        """The contact problem with strut and cam forces; None without struts and a cam."""
        return self._strut_and_cam_contact_problem_at_friction(self.brake.friction)

    def _strut_and_cam_contact_problem_at_friction(
        self, friction: float
    ) -> ContactProblemWithStrutAndCamForces | None:
        """The contact problem with strut and cam forces; None without struts and a cam.

        All matrices hold at the friction coefficient `friction` of the brake.
        """
        if (
            not self.indices_of_pushing_and_pushed_shoe_of_struts
            and not self.indices_of_shoes_under_cam
        ):
            return None
        blocks, effects = (
            self.contact_problem_with_given_actuation_forces(friction),
            self.contact_effects_of_each_actuation_force(friction),
        )
        return make_contact_problem_with_strut_and_cam_forces(
            blocks,
            effects,
            self.actuation_forces_of_file_over_largest_force,
            self.indices_of_pushing_and_pushed_shoe_of_struts,
            self.indices_of_shoes_under_cam,
            self.sum_of_cam_forces_over_largest_force,
        )

    def contact_effects_of_each_actuation_force(
        self, friction: float
    ) -> list[EffectsOfActuationForceOnShoe]:
        """For each shoe, what its force causes, and what moves its tip and loads its foot.

        The tip is the point where the actuation force acts. The foot is the end of the shoe on an
        abutment or a strut. All values are linear functions of the friction coefficient.
        """
        return [
            self._effects_of_actuation_force_on_shoe(k, friction) for k in range(len(self.shoes))
        ]

    def _effects_of_actuation_force_on_shoe(
        self, k: int, friction: float
    ) -> EffectsOfActuationForceOnShoe:
        """The effects of shoe k's actuation force, and what moves its tip and loads its foot."""
        body, shoe, modes = (
            self.substructures_of_shoes[k],
            self.shoes[k],
            self.rigid_body_modes_of_shoes[k],
        )
        load = self.actuation_of_each_shoe_by_one_newton[k].load_column_factors
        drag = self._friction_coefficient_signed_by_drag_on_shoe(k, friction)
        tip = self._elastic_load_point_travel_per_nodal_pressure(k, load, friction)
        # `contact` has the force of pressure and friction on the lining, per nodal pressure.
        contact = (
            drag * body.resultants_of_unit_nodal_pressures_and_tractions[1]
            - body.resultants_of_unit_nodal_pressures_and_tractions[0]
        )[:2].T  # (n, 2)
        further = np.zeros(len(load))
        if shoe.has_loads_besides_actuation:
            further = (
                unit_load_factors_of_loads_besides_actuation(body, shoe)
                / self.largest_actuation_force
            )
        foot = self._foot_of_shoe(shoe, contact)
        motion_by_load = body.flexibility.load_point_motion_by_load
        return EffectsOfActuationForceOnShoe(
            nodes=self.contact_node_slices_of_shoes[k],
            modes=self.rigid_body_mode_slices_of_shoes[k],
            gap_by_force=-(body.flexibility.gap_closure_by_load @ load),
            load_point_travel_by_pressure=tip,
            load_point_travel_by_force=float(load @ motion_by_load @ load),
            load_point_travel_by_further_loads=float(load @ motion_by_load @ further),
            work=modes.actuation_work,
            load_point_travel_by_modes=modes.load_point_travel,
            foot_force_by_pressure=foot.force_by_pressure,
            foot_force_by_force=foot.force_by_actuation_force,
            foot_force_by_further_loads=foot.force_by_further_loads,
            surface_motion_by_foot_travel=foot.surface_motion_by_travel,
            load_point_travel_by_surface_motion=self._work_on_motion_along_surface(
                shoe.actuation.unit_vector_of_force, shoe.actuation.point.xy
            ),
            gap_by_surface_motion=np.zeros(len(tip)),
        )

    def _foot_of_shoe(self, shoe: Shoe, contact: Floats) -> _FootOfShoe:
        """The force that the foot of a shoe transmits, and the motion that its travel causes.

        `contact` (n, 2) is the force of pressure and friction on the lining, per nodal pressure.
        All values are 0 for a shoe without an abutment.
        """
        if shoe.abutment is None:
            return _FootOfShoe(np.zeros(len(contact)), 0.0, 0.0, 0.0)
        along = shoe.unit_vector_of_smooth_abutment_force
        by_loads = along @ shoe.resultant_of_loads_besides_actuation[:2]
        # The strut carries the foot against the force of a smooth abutment on it.
        lever = self._work_on_motion_along_surface(along, shoe.abutment.point.xy)
        return _FootOfShoe(
            force_by_pressure=-shoe.frame.convert_vectors_from_shoe_to_brake_frame(contact) @ along,
            force_by_actuation_force=-float(along @ shoe.actuation.unit_vector_of_force),
            force_by_further_loads=-float(by_loads) / self.largest_actuation_force,
            surface_motion_by_travel=-1 / lever if lever else 0.0,
        )

    @property
    def rigid_motion_along_friction_surface(self) -> Floats:
        """The rigid-body motion (3,) that moves a shoe along the drum or the plane.

        The entries are the displacements x, y [m] of the origin and the turn [rad]. On a drum the
        motion is a turn by 1 rad about the drum's centre, on a plane a slide by 1 m.
        """
        if self.brake.surface.is_plane_and_not_drum:
            return np.array([1.0, 0.0, 0.0])
        return np.array([0.0, 0.0, 1.0])

    def _work_on_motion_along_surface(self, force: Floats, point: Floats) -> float:
        """The work of a force (2,) at a point (2,) on the motion along the friction surface."""
        moment = point[0] * force[1] - point[1] * force[0]
        return float(self.rigid_motion_along_friction_surface @ np.append(force, moment))

    def approach_of_springs_by_surface_motion(self, springs: SpringMatrices) -> Floats:
        """The approach (m, s) of each spring's points as a shoe moves along the friction surface.

        The columns stand for the shoes.
        """
        return np.asarray(springs.resultants @ self.rigid_motion_along_friction_surface)

    def approach_of_springs_by_load_point_travel(self, springs: SpringMatrices) -> Floats:
        """The approach (m, s) of each spring's points as struts carry the feet of the shoes.

        The columns stand for the travel of each shoe's point of actuation by its strain and its
        rigid-body modes. The approach is 0 for a shoe that no strut pushes.
        """
        struts = self.indices_of_pushing_and_pushed_shoe_of_struts
        if not struts:
            return np.zeros(springs.resultants.shape[:2])
        motions = surface_motions_by_load_point_travels(
            self.contact_effects_of_each_actuation_force(0.0), struts
        )
        return np.asarray(self.approach_of_springs_by_surface_motion(springs) @ motions)

    def motions_along_surface_with_struts(
        self, pressures: Sequence[Floats], coordinates: Sequence[Floats], forces: Floats
    ) -> Floats:
        """The motion (s,) of each shoe along the drum or the plane, as its strut carries its foot.

        The motions are turns [rad] about the drum's centre or slides [m] along the plane.

        Parameters
        ----------
        pressures : pressures (n_i,) [Pa] on each shoe
        coordinates : generalised coordinates (k_i,) of each shoe
        forces : actuation forces (s,) [N]
        """
        struts = self.indices_of_pushing_and_pushed_shoe_of_struts
        if not struts:
            return np.zeros(len(self.shoes))
        effects = self.contact_effects_of_each_actuation_force(self.brake.friction)
        travels = self.largest_actuation_force * np.array(
            [shoe.load_point_travel_by_further_loads for shoe in effects]
        )
        for i, shoe in enumerate(effects):
            travels[i] += shoe.load_point_travel_by_pressure @ pressures[i]
            travels[i] += shoe.load_point_travel_by_modes @ coordinates[i]
            travels[i] += shoe.load_point_travel_by_force * forces[i]
        return np.asarray(surface_motions_by_load_point_travels(effects, struts) @ travels)

    def _elastic_load_point_travel_per_nodal_pressure(
        self, k: int, load: Floats, friction: float
    ) -> Floats:
        """The elastic travel (n,) of a load's point on shoe `k` along the load, per nodal pressure.

        `load` (l,) are the factors by which the load columns of the body make up the load.
        """
        body = self.substructures_of_shoes[k]
        drag = self._friction_coefficient_signed_by_drag_on_shoe(k, friction)
        travel = -(load @ body.flexibility.gap_closure_by_load.T)
        # A model that was prepared without friction does not know how friction moves the points of
        # loads.
        if body.flexibility.load_point_motion_by_friction is not None:
            travel = travel + drag * (load @ body.flexibility.load_point_motion_by_friction)
        return np.asarray(travel)

    # The following method treats springs between shoes, or from a shoe to the frame.

    def spring_matrices_at_friction(self, friction: float) -> SpringMatrices:
        """The effects of all springs of the brake on the group at a friction coefficient.

        The effects are linear in the friction coefficient.
        """
        found = SpringMatrices.zeros(
            [
                body.load_matrix_columns_by_load_name.number_of_load_columns
                for body in self.substructures_of_shoes
            ],
            springs=len(self.brake.springs),
            nodes=len(self.contact_node_areas),
            modes=self.rigid_body_mode_slices_of_shoes[-1].stop,
        )
        for i in range(len(self.shoes)):
            self._add_effects_of_springs_on_shoe(found, i, friction)
        return found

    def _add_effects_of_springs_on_shoe(
        self, found: SpringMatrices, i: int, friction: float
    ) -> None:
        """Add the effects of all springs on shoe `i` to `found`, whose arrays are changed."""
        shoe, body = self.shoes[i], self.substructures_of_shoes[i]
        sense = self.known_abutment_friction_directions[i]
        nodes, modes = self.contact_node_slices_of_shoes[i], self.rigid_body_mode_slices_of_shoes[i]
        acting = self.actuation_of_each_shoe_by_one_newton[i].load_column_factors
        pulls = unit_pulls_on_shoe(self.brake, shoe)
        motion_by_load = body.flexibility.load_point_motion_by_load
        for j, place, pull in pulls:
            load = unit_load_factors_of_force_at_point(body, shoe, place, pull)
            found.load_column_factors[j][i][:] = load
            found.resultants[j, i] = pull.resultant
            found.gap_by_pull[nodes, j] = -(body.flexibility.gap_closure_by_load @ load)
            found.work[modes, j] = work_of_force_on_test_modes(shoe, sense, pull)
            found.approach_by_motion[j, modes] = displacement_of_point_along_force_in_modes(
                shoe, sense, pull
            )
            found.approach_by_pressure[j, nodes] = (
                self._elastic_load_point_travel_per_nodal_pressure(i, load, friction)
            )
            found.approach_by_force[j, i] = load @ motion_by_load @ acting
            found.tip_travel_by_pull[i, j] = acting @ motion_by_load @ load
            if shoe.abutment is not None:
                found.foot_force_by_pull[i, j] = -float(
                    shoe.unit_vector_of_smooth_abutment_force @ np.array(pull.force)
                )
        for (one, *_), (other, *_) in product(pulls, repeat=2):
            loads = found.load_column_factors[one][i], found.load_column_factors[other][i]
            found.approach_by_pull[one, other] += loads[0] @ motion_by_load @ loads[1]

    # The following methods treat supports that push and cannot pull.

    def one_sided_support_matrices_at_friction(self, friction: float) -> OneSidedSupportMatrices:
        """The effects of the one-sided supports of the group at a friction coefficient.

        The effects are linear in the friction coefficient.
        """
        count, n = len(self.one_sided_supports), len(self.contact_node_areas)
        sizes = np.concatenate(
            [self._mode_amounts_that_move_shoe_about_one_metre(shoe) for shoe in self.shoes]
        )
        opening, by_pressure = np.zeros(count), np.zeros((count, n))
        by_motion, gap = np.zeros((count, len(sizes))), np.zeros((n, count))
        loads = []
        for j, support in enumerate(self.one_sided_supports):
            opening[j] = support.clearance / self.largest_actuation_force
            loads.append(
                {
                    side.shoe: self.load_column_factors_of_support_push(side)
                    for side in support.sides
                }
            )
            for side in support.sides:
                k, load = side.shoe, loads[j][side.shoe]
                nodes, body = self.contact_node_slices_of_shoes[k], self.substructures_of_shoes[k]
                force = self.shoes[k].actuation.force
                acting = unit_load_factors_under_all_loads(body, self.shoes[k], force)
                travel = load @ body.flexibility.load_point_motion_by_load @ acting
                opening[j] += travel / self.largest_actuation_force
                by_pressure[j, nodes] = self._elastic_load_point_travel_per_nodal_pressure(
                    k, load, friction
                )
                modes = self.rigid_body_mode_slices_of_shoes[k]
                by_motion[j, modes] = self.work_of_support_push_on_shoe_modes(
                    k, side.push_of_one_newton
                )
                gap[nodes, j] = -(body.flexibility.gap_closure_by_load @ load)
        by_force = np.zeros((count, count))
        for i, j in product(range(count), repeat=2):
            for k in loads[i].keys() & loads[j].keys():
                flexibility = self.substructures_of_shoes[k].flexibility
                by_force[i, j] += loads[i][k] @ flexibility.load_point_motion_by_load @ loads[j][k]
        return OneSidedSupportMatrices(opening, by_pressure, by_force, by_motion, gap, sizes)

    def openings_of_one_sided_supports_by_pulls(self) -> Floats:
        """The opening (supports, springs) of each one-sided support per pull of each spring.

        The opening comes from the strain of the bodies. It is also the approach of the spring's
        points per force of the support, by the theorem of Maxwell and Betti.
        """
        factors = self.spring_matrices_at_friction(0.0).load_column_factors
        opening = np.zeros((len(self.one_sided_supports), len(self.brake.springs)))
        for row, support in enumerate(self.one_sided_supports):
            for side in support.sides:
                flexibility = self.substructures_of_shoes[side.shoe].flexibility
                motion = (
                    self.load_column_factors_of_support_push(side)
                    @ flexibility.load_point_motion_by_load
                )
                for column, of_shoes in enumerate(factors):
                    opening[row, column] += motion @ of_shoes[side.shoe]
        return opening

    def _mode_amounts_that_move_shoe_about_one_metre(self, shoe: Shoe) -> Floats:
        """The amount (k,) of each rigid-body motion of a shoe by which its points move about 1 m.

        A turn is taken to move a point at the distance of the drum's radius, or of a plane's size.
        """
        turns = np.isin(shoe.rigid_body_modes_of_support().names, ["turn", "tilt"])
        return np.where(turns, 1 / self.brake.size, 1.0)

    @cached_property
    def contact_problem_on_bearing_supports_or_none(self) -> ContactProblemOnBearingSupports | None:
        """The contact problem on the one-sided supports that bear; None without such supports."""
        return self._contact_problem_on_bearing_supports(self.brake.friction)

    def _contact_problem_on_bearing_supports(
        self, friction: float
    ) -> ContactProblemOnBearingSupports | None:
        """The contact problem, at a friction coefficient, on the one-sided supports that bear.

        It is None for a group without one-sided supports. Raises RuntimeError if it is not known
        which supports bear, or if they do not hold the shoes.
        """
        if not self.one_sided_supports:
            return None
        found = self.contact_problem_on_given_supports_or_none(self.bearing, friction)
        if found is None:
            raise RuntimeError(
                f"{self.names_of_shoes_as_text}: it is not known which supports bear, "
                "ask for `solve_contact_and_abutment_friction`"
            )
        return found

    def contact_problem_on_given_supports_or_none(
        self, bearing: BearingFlagsOfOneSidedSupports, friction: float
    ) -> ContactProblemOnBearingSupports | None:
        """The contact problem on chosen bearing supports; None if they do not hold the shoes."""
        if len(bearing) != len(self.one_sided_supports):
            return None
        return contact_problem_on_supports_that_bear(
            self.contact_problem_with_given_actuation_forces(friction),
            self.one_sided_support_matrices_at_friction(friction),
            bearing,
        )

    def support_forces_on_shoe(self, p: Floats, k: int) -> tuple[OneSidedSupportForce, ...]:
        """The forces [N] of one-sided supports on shoe `k`.

        p (n,) are the pressures per newton of `largest_actuation_force`.
        """
        if self.contact_problem_on_bearing_supports_or_none is None:
            return ()
        forces = (
            self.largest_actuation_force
            * self.contact_problem_on_bearing_supports_or_none.forces_of_one_sided_supports(p)
        )
        return forces_of_one_sided_supports_on_shoe(self.one_sided_supports, forces, k)

    def actuation_forces_under_contact_pressures(self, p: Floats) -> Floats:
        """The actuation force (shoes,) of each shoe under pressures p (n,).

        Forces and pressures are per newton of `largest_actuation_force`.
        """
        shared = self.strut_and_cam_contact_problem_or_none
        if shared is None:
            return self.actuation_forces_of_file_over_largest_force
        return shared.actuation_forces_under_contact_pressures(p)

    def rigid_body_coordinates_of_each_shoe(self, contact: ContactSolution) -> list[Floats]:
        """The generalised coordinates (k_i,) of each shoe, the amounts of its rigid-body modes.

        They belong to a solution of the group's contact, and are per newton of
        `largest_actuation_force`.
        """
        y = contact.y
        if self.contact_problem_on_bearing_supports_or_none is not None:
            y = self.contact_problem_on_bearing_supports_or_none.rigid_body_motions(
                contact.p, contact.y
            )
        shared = self.strut_and_cam_contact_problem_or_none
        if shared is not None:
            y = shared.rigid_body_coordinates_from_contact_solution(contact.p, contact.y)
        return [y[part] for part in self.rigid_body_mode_slices_of_shoes]


def _shoe_compliance_with_penalty(
    body: ShoeSubstructure, drag: float | Floats, stiffness: float
) -> Floats:
    """The compliance matrix (n, n) of a shoe: opening of the weighted gaps per nodal pressure.

    A weighted gap is the integral of the gap times the shape function of a node. The matrix
    contains the compliance of the shoe and of the penalty contact.

    Parameters
    ----------
    body : the substructure of the shoe
    drag : friction coefficient with the sign of the drag in the frame of the shoe, for the shoe or
        for each of its n nodes
    stiffness : contact stiffness of the penalty per area [Pa/m]
    """
    pressed, dragged, M = (
        body.flexibility.gap_closure_by_pressure,
        body.flexibility.gap_closure_by_friction,
        body.coupling.M,
    )
    A = np.empty(M.shape)
    for first in range(0, len(A), COMPLIANCE_ROWS_ASSEMBLED_AT_A_TIME):
        rows = slice(first, first + COMPLIANCE_ROWS_ASSEMBLED_AT_A_TIME)
        part = np.divide(M[rows], stiffness, out=A[rows])
        part -= pressed[rows]
        if dragged is not None:
            part -= drag * dragged[rows]
    return A
