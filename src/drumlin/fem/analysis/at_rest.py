"""The stick-slip problem of shoes on a drum that rests or is turned by a small angle.

On a sliding drum the friction follows from the pressure. On a drum at rest the tangential tractions
on the linings are also unknowns. A foot on a rough abutment sticks and slips as a lining does, so
that the normal force and the friction force on the foot are unknowns as well.
"""

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.lapack import block_diag
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.support import SENSE_VALUE_OF_ABUTMENT_THAT_DOES_NOT_ACT
from drumlin.contact import equations
from drumlin.contact.stick_slip import StickSlipProblem
from drumlin.fem.equilibrium.group import ShoeGroup
from drumlin.fem.equilibrium.modes import contact_node_displacements_in_rigid_body_motions
from drumlin.fem.equilibrium.sharing import (
    EffectsOfActuationForceOnShoe,
    make_contact_problem_with_strut_and_cam_forces,
)
from drumlin.fem.equilibrium.spring_nodes import (
    SpringNodes,
    actuation_effects_with_spring_nodes,
    opening_of_one_sided_supports_by_spring_forces,
    spring_border_at_friction,
)
from drumlin.fem.model import DEFAULT_PENALTY_FACTOR
from drumlin.fem.preparation.bodies import (
    actuation_factors_and_pin_moment_per_newton,
    penalty_stiffness_of_contact_per_area,
    unit_load_factors_under_all_loads,
)


def make_stick_slip_problem_and_slip_per_drum_rotation(
    group: ShoeGroup, springs: SpringNodes | None = None
) -> tuple[StickSlipProblem, Floats]:
    """The stick-slip problem of a group of shoes on a drum at rest, and the slip per drum rotation.

    The problem is stated per newton of the group's largest actuation force F. The second value (n,)
    [m^3] is the weighted slip of each node per radian of drum rotation: the integral of the slip
    times the node's shape function. If the drum turns by Omega, this value times Omega/F is added
    to the weighted slips `StickSlipProblem.q_s`. Tractions and slips are positive along e_theta of
    the brake.

    The nodes of the linings come first, then one node for each foot on a rough abutment, see
    `FeetOnRoughAbutments`. The last nodes have no friction: one node for each one-sided support,
    then one for each of the `springs` with a rate. With `springs`, the group is a result of
    `group_under_spring_pulls` with the pulls None, so that no spring with a rate loads its shoes.
    """
    feet = FeetOnRoughAbutments.collect_feet_on_rough_abutments(group)
    still = replace(
        group,
        brake=feet.brake_with_smooth_abutments(0.0),
        abutment_friction_directions_of_shoes=feet.senses,
    )
    shoes = [_matrices_of_tractions_on_lining(still, k) for k in range(len(group.members))]
    problem = feet.stick_slip_problem_with_abutment_nodes(
        _stick_slip_problem_without_abutments(still, shoes), still
    )
    problem = _stick_slip_problem_with_one_sided_support_nodes(still, problem, shoes)
    if springs is not None:
        problem = _stick_slip_problem_with_spring_nodes(still, problem, shoes, springs)
    # A brake has one-sided supports, or struts and a cam, but not both.
    if group.indices_of_pushing_and_pushed_shoe_of_struts or group.indices_of_shoes_under_cam:
        problem = _stick_slip_problem_with_strut_and_cam_forces(still, problem, shoes, springs)
    lever = np.concatenate([body.coupling.lever for body in group.substructures_of_shoes])
    return problem, np.append(lever, np.zeros(len(problem.q_w) - len(lever)))


class _TractionMatrices(NamedTuple):
    """The matrices for tractions and slips of a lining in the stick-slip problem of its shoe.

    Weighted gaps and slips are integrals of the gap and of the slip times the shape function of
    each contact node.

    Attributes
    ----------
    A_wt : change (n, n) of the weighted gaps per nodal traction
    A_sp, A_st : change (n, n) of the weighted slips per nodal pressure and per nodal traction
    B_s : change (n, k) of the weighted slips per generalised coordinate of the shoe's rigid motion
    C_t : change (k, n) of the generalised forces on the shoe, in its equilibrium, per traction
    compliance : compliance (n, n) of the penalty contact along the friction surface; it equals the
        compliance normal to the surface
    q_s : weighted slips (n,) without pressure and traction
    effects : the `EffectsOfActuationForceOnShoe` of the actuation force, with slips in place of
        gaps and tractions in place of pressures
    load_travel : elastic displacement (n, l) per nodal traction of the points at which l unit loads
        act, each in the direction of its load
    """

    A_wt: Floats
    A_sp: Floats
    A_st: Floats
    B_s: Floats
    C_t: Floats
    compliance: Floats
    q_s: Floats
    effects: EffectsOfActuationForceOnShoe
    load_travel: Floats


def _matrices_of_tractions_on_lining(group: ShoeGroup, k: int) -> _TractionMatrices:
    """The matrices of tractions on the lining of shoe `k` of a group without friction."""
    body, shoe = group.substructures_of_shoes[k], group.shoes[k]
    modes = group.rigid_body_modes_of_shoes[k]
    coupling, condensed = body.coupling, body.condensed
    n = len(body.line.nodes)
    # Tractions are positive in the direction e_theta of the brake, also if the shoe's own frame is
    # mirrored.
    T = shoe.frame.sense * coupling.T
    # Y is L^-1 f for nodal forces f and the Cholesky factor L of the stiffness L L^T. The product
    # of two parts of Y is a flexibility: pressed^T dragged gives the weighted gaps that tractions
    # open.
    Y = condensed.half_flexibility_under_nodal_forces(
        np.hstack([-coupling.N.T, T.T, condensed.load_on_contact])
    )
    pressed, dragged, loaded = np.split(Y, [n, 2 * n], axis=1)
    load, _ = actuation_factors_and_pin_moment_per_newton(body, shoe)
    acting = unit_load_factors_under_all_loads(body, shoe, shoe.actuation.force)
    acting = acting / group.largest_actuation_force
    tip = dragged.T @ (loaded @ load)
    along = contact_node_displacements_in_rigid_body_motions(
        body, shoe, group.rigid_motion_along_friction_surface[None]
    )
    effects = group.contact_effects_of_each_actuation_force(0.0)[k]
    return _TractionMatrices(
        # Displacements u of the contact nodes close the weighted gaps by N u. The nodal forces of
        # tractions t are T^T t.
        A_wt=pressed.T @ dragged,
        A_sp=-dragged.T @ pressed,
        A_st=-dragged.T @ dragged,
        B_s=-(T @ modes.contact_modes),
        C_t=(T @ modes.test_modes).T,
        compliance=coupling.M / group.contact_stiffness_per_area_of_shoes[k],
        q_s=-(dragged.T @ (loaded @ acting)),
        effects=effects._replace(
            gap_by_force=-tip,
            load_point_travel_by_pressure=tip,
            foot_force_by_pressure=_foot_force_by_tractions(shoe, T),
            gap_by_surface_motion=-(T @ along)[:, 0],
        ),
        load_travel=dragged.T @ loaded,
    )


def _foot_force_by_tractions(shoe: Shoe, T: Floats) -> Floats:
    """The force (n,) along the strut that the foot transmits, per nodal traction on the lining.

    T (n, 2n) has the nodal forces of the tractions. The force is 0 for a shoe without an abutment.
    """
    if shoe.abutment is None:
        return np.zeros(len(T))
    nodal = T.reshape(len(T), -1, 2).sum(axis=1)
    nodal = shoe.frame.convert_vectors_from_shoe_to_brake_frame(nodal)
    return np.asarray(-nodal @ shoe.unit_vector_of_smooth_abutment_force)


def _stick_slip_problem_without_abutments(
    still: ShoeGroup, shoes: list[_TractionMatrices]
) -> StickSlipProblem:
    """The stick-slip problem of the linings of a group whose feet move freely in the plane.

    Parameters
    ----------
    still : the group without friction
    shoes : the matrices of tractions on each lining
    """
    normal = still.contact_problem_with_given_actuation_forces(0.0)

    def block_diagonal_traction_matrix_of_shoes(name: str) -> Floats:
        """The block-diagonal matrix whose blocks are the attribute `name` of all `shoes`."""
        return block_diag(*(getattr(shoe, name) for shoe in shoes))

    A_wt, A_sp, A_st = (
        block_diagonal_traction_matrix_of_shoes("A_wt"),
        block_diagonal_traction_matrix_of_shoes("A_sp"),
        block_diagonal_traction_matrix_of_shoes("A_st"),
    )
    if still.factors_of_ring_flexibility is not None:
        # The pressures and tractions of all shoes displace the ring under each shoe.
        pressed, dragged = still.factors_of_ring_flexibility
        A_wt = A_wt + pressed.T @ dragged
        A_sp = A_sp - dragged.T @ pressed
        A_st = A_st - dragged.T @ dragged
    return StickSlipProblem(
        A_wp=normal.A,
        A_wt=A_wt,
        A_sp=A_sp,
        A_st=A_st,
        B_w=normal.B,
        B_s=block_diagonal_traction_matrix_of_shoes("B_s"),
        C_p=normal.C,
        C_t=block_diagonal_traction_matrix_of_shoes("C_t"),
        q_w=normal.q,
        q_s=np.concatenate([shoe.q_s for shoe in shoes]),
        h=normal.h,
        Q=block_diagonal_traction_matrix_of_shoes("compliance"),
    )


class FeetOnRoughAbutments(NamedTuple):
    """The feet of a group's shoes on rough abutments, each as a node of the stick-slip problem.

    At the node of a foot, p [N] is the force normal to the abutment's face and t [N] the friction
    force along the face.

    Attributes
    ----------
    group : the group of shoes
    indices_of_shoes_on_rough_abutments : indices, within the group, of the shoes whose feet stand
        on rough abutments
    senses : direction of friction at the abutment of each shoe of the group. If the foot is a node
        of the stick-slip problem, the direction is SENSE_VALUE_OF_ABUTMENT_THAT_DOES_NOT_ACT: the
        node replaces the abutment
    foot_compliance : penalty compliance (feet,) [m/N] of the contact between each foot and its
        abutment, normal to the face and along it
    """

    group: ShoeGroup
    indices_of_shoes_on_rough_abutments: list[int]
    senses: tuple[int, ...]
    foot_compliance: Floats

    @classmethod
    def collect_feet_on_rough_abutments(cls, group: ShoeGroup) -> "FeetOnRoughAbutments":
        """Collect the feet of a group's shoes on rough abutments."""
        # If the contact of the linings is exact (no penalty), a sticking foot needs a finite
        # contact stiffness nevertheless.
        penalty = DEFAULT_PENALTY_FACTOR if math.isinf(group.penalty) else group.penalty
        on, stiffness = [], []
        senses = [1] * len(group.shoes)
        for k, shoe in enumerate(group.shoes):
            if shoe.abutment is None or not shoe.abutment.friction > 0:
                continue
            on.append(k)
            senses[k] = SENSE_VALUE_OF_ABUTMENT_THAT_DOES_NOT_ACT
            area = float(group.substructures_of_shoes[k].coupling.areas_of_contact_nodes.sum())
            stiffness.append(penalty_stiffness_of_contact_per_area(shoe, penalty) * area)
        return cls(group, on, tuple(senses), 1 / np.array(stiffness))

    def brake_with_smooth_abutments(self, friction: float) -> Brake:
        """The brake at a friction coefficient of the drum, with frictionless abutments.

        The friction of linings with a coefficient of their own changes in proportion.
        """
        shoes = []
        for shoe in self.group.brake.shoes:
            abutment = shoe.abutment and shoe.abutment.model_copy(update={"friction": 0.0})
            shoes.append(shoe.model_copy(update={"abutment": abutment}))
        smooth = self.group.brake.model_copy(update={"shoes": tuple(shoes)})
        return smooth.brake_with_new_friction_coefficient(friction)

    def friction_coefficients_of_all_nodes(self) -> Floats:
        """The friction coefficients (n,) of all nodes: linings, feet, then one-sided supports."""
        abutments = [self.group.shoes[k].abutment for k in self.indices_of_shoes_on_rough_abutments]
        of_feet = [abutment.friction for abutment in abutments if abutment is not None]
        of_supports = [0.0] * len(self.group.one_sided_supports)
        of_linings = self.group.brake.friction * self.group.friction_of_nodes_over_brake_friction
        return np.concatenate([of_linings, of_feet, of_supports])

    def stick_slip_problem_with_abutment_nodes(
        self, problem: StickSlipProblem, still: ShoeGroup
    ) -> StickSlipProblem:
        """Add a node for each foot on a rough abutment to a stick-slip problem.

        Parameters
        ----------
        problem : the stick-slip problem of the linings
        still : the frictionless group of this problem, whose feet move freely
        """
        if not self.indices_of_shoes_on_rough_abutments:
            return problem
        count = len(self.indices_of_shoes_on_rough_abutments)
        off = np.zeros((count, problem.B_w.shape[1]))
        slid = np.zeros((count, problem.B_w.shape[1]))
        # The rigid-body modes of the shoe are two translations and the rotation about its foot. One
        # translation moves the foot off the abutment, the other translation moves the foot along
        # the abutment. The rotation does not move the foot.
        for row, k in enumerate(self.indices_of_shoes_on_rough_abutments):
            names = (
                still.shoes[k]
                .rigid_body_modes_of_support(SENSE_VALUE_OF_ABUTMENT_THAT_DOES_NOT_ACT)
                .names
            )
            first = still.rigid_body_mode_slices_of_shoes[k].start
            off[row, first + names.index("off")] = 1.0
            slid[row, first + names.index("slide")] = 1.0
        yielding, nothing = np.diag(self.foot_compliance), np.zeros((count, count))
        no_gap = np.zeros(count)
        return problem._replace(
            A_wp=block_diag(problem.A_wp, yielding),
            A_wt=block_diag(problem.A_wt, nothing),
            A_sp=block_diag(problem.A_sp, nothing),
            A_st=block_diag(problem.A_st, nothing),
            Q=block_diag(problem.Q, yielding),
            B_w=np.vstack([problem.B_w, off]),
            B_s=np.vstack([problem.B_s, -slid]),
            C_p=np.hstack([problem.C_p, off.T]),
            C_t=np.hstack([problem.C_t, slid.T]),
            q_w=np.append(problem.q_w, no_gap),
            q_s=np.append(problem.q_s, no_gap),
        )


def _stick_slip_problem_with_one_sided_support_nodes(
    still: ShoeGroup, problem: StickSlipProblem, shoes: list[_TractionMatrices]
) -> StickSlipProblem:
    """Add a node without friction for each one-sided support to a stick-slip problem.

    The pressure of the node is the force of the support [N], and its gap is the opening [m].

    Parameters
    ----------
    still : the group without friction
    problem : the stick-slip problem of the linings, and of the feet on rough abutments
    shoes : the matrices of tractions on each lining
    """
    supports = still.one_sided_supports
    if not supports:
        return problem
    matrices, count = still.one_sided_support_matrices_at_friction(0.0), len(supports)
    size = len(problem.q_w)
    by_pressure, by_traction = np.zeros((count, size)), np.zeros((count, size))
    gap, yielding = np.zeros((size, count)), np.zeros((count, count))
    linings = matrices.opening_by_pressure.shape[1]
    by_pressure[:, :linings] = matrices.opening_by_pressure
    gap[:linings] = matrices.gap_by_force
    penalty = DEFAULT_PENALTY_FACTOR if math.isinf(still.penalty) else still.penalty
    for j, support in enumerate(supports):
        for side in support.sides:
            nodes = still.contact_node_slices_of_shoes[side.shoe]
            travel = shoes[side.shoe].load_travel @ still.load_column_factors_of_support_push(side)
            by_traction[j, nodes] = travel
        shoe = still.shoes[support.sides[0].shoe]
        area = float(still.contact_node_areas[nodes].sum())
        yielding[j, j] = 1 / (penalty_stiffness_of_contact_per_area(shoe, penalty) * area)
    nothing, no_slip = np.zeros((count, count)), np.zeros((count, problem.B_s.shape[1]))
    by_motion = matrices.opening_by_motion
    return problem._replace(
        A_wp=np.block([[problem.A_wp, gap], [by_pressure, matrices.opening_by_force + yielding]]),
        A_wt=block_diag(problem.A_wt, nothing)
        + _zero_matrix_with_lower_left_block(by_traction, count),
        A_sp=block_diag(problem.A_sp, nothing)
        - _zero_matrix_with_lower_left_block(by_traction, count).T,
        A_st=block_diag(problem.A_st, nothing),
        Q=block_diag(problem.Q, yielding),
        B_w=np.vstack([problem.B_w, by_motion]),
        B_s=np.vstack([problem.B_s, no_slip]),
        C_p=np.hstack([problem.C_p, by_motion.T]),
        C_t=np.hstack([problem.C_t, no_slip.T]),
        q_w=np.append(problem.q_w, matrices.opening),
        q_s=np.append(problem.q_s, np.zeros(count)),
    )


def _zero_matrix_with_lower_left_block(block: Floats, count: int) -> Floats:
    """A square matrix of zeros with a block (count, size) at the start of its last `count` rows."""
    size = block.shape[1]
    whole = np.zeros((size + count, size + count))
    whole[size:, :size] = block
    return whole


def _stick_slip_problem_with_spring_nodes(
    still: ShoeGroup,
    problem: StickSlipProblem,
    shoes: list[_TractionMatrices],
    springs: SpringNodes,
) -> StickSlipProblem:
    """Add a node without friction for each spring with a rate to a stick-slip problem.

    The pressure of the node is the pull of the spring [N]. The gap of the node is zero while the
    spring acts.

    Parameters
    ----------
    still : the group without friction
    problem : the stick-slip problem of the linings, of the feet on rough abutments, and of the
        one-sided supports
    shoes : the matrices of tractions on each lining
    springs : the springs
    """
    border, count = spring_border_at_friction(still, springs, 0.0), len(springs.numbers)
    factors = still.spring_matrices_at_friction(0.0).load_column_factors
    size, linings = len(problem.q_w), border.opening_by_pressure.shape[1]
    by_pressure, by_traction = np.zeros((count, size)), np.zeros((count, size))
    gap, of_shoes = np.zeros((size, count)), still.contact_node_slices_of_shoes
    by_pressure[:, :linings], gap[:linings] = border.opening_by_pressure, border.gap_by_force
    on_supports = opening_of_one_sided_supports_by_spring_forces(still, springs)
    supports = slice(size - len(on_supports), size)
    by_pressure[:, supports], gap[supports] = on_supports.T, on_supports
    for row, j in enumerate(springs.numbers.tolist()):
        for shoe, nodes, load in zip(shoes, of_shoes, factors[j], strict=True):
            by_traction[row, nodes] = springs.signs[row] * (shoe.load_travel @ load)
    lower_left = _zero_matrix_with_lower_left_block(by_traction, count)
    nothing, no_slip = np.zeros((count, count)), np.zeros((count, problem.B_s.shape[1]))
    return problem._replace(
        A_wp=np.block([[problem.A_wp, gap], [by_pressure, border.opening_by_force]]),
        A_wt=block_diag(problem.A_wt, nothing) + lower_left,
        A_sp=block_diag(problem.A_sp, nothing) - lower_left.T,
        A_st=block_diag(problem.A_st, nothing),
        Q=block_diag(problem.Q, np.diag(1 / springs.rates)),
        B_w=np.vstack([problem.B_w, border.opening_by_motion]),
        B_s=np.vstack([problem.B_s, no_slip]),
        C_p=np.hstack([problem.C_p, border.work]),
        C_t=np.hstack([problem.C_t, no_slip.T]),
        q_w=np.append(problem.q_w, border.opening),
        q_s=np.append(problem.q_s, np.zeros(count)),
    )


def _stick_slip_problem_with_strut_and_cam_forces(
    still: ShoeGroup,
    problem: StickSlipProblem,
    shoes: list[_TractionMatrices],
    springs: SpringNodes | None,
) -> StickSlipProblem:
    """Replace the actuation forces in a stick-slip problem by the forces of struts and a cam.

    Parameters
    ----------
    still : the group without friction
    problem : the stick-slip problem in which each shoe has its own, given actuation force
    shoes : the matrices of tractions on each lining
    springs : springs whose nodes are the last nodes of the problem; None without such nodes
    """
    sharing = make_contact_problem_with_strut_and_cam_forces(
        _contact_problem_with_tractions_among_pressures(problem),
        _actuation_effects_on_pressures_and_tractions(still, shoes, len(problem.q_w), springs),
        still.actuation_forces_of_file_over_largest_force,
        still.indices_of_pushing_and_pushed_shoe_of_struts,
        still.indices_of_shoes_under_cam,
        still.sum_of_cam_forces_over_largest_force,
    )
    return _stick_slip_problem_from_contact_problem(sharing.problem, problem.Q)


def _contact_problem_with_tractions_among_pressures(
    problem: StickSlipProblem,
) -> equations.ContactProblem:
    """A stick-slip problem written as a contact problem, with tractions among the pressures.

    The n pressures and the n tractions are stacked to 2n unknowns, and the gaps and slips likewise,
    since `make_contact_problem_with_strut_and_cam_forces` takes a contact problem.
    """
    return equations.ContactProblem(
        A=np.block([[problem.A_wp, problem.A_wt], [problem.A_sp, problem.A_st]]),
        q=np.concatenate([problem.q_w, problem.q_s]),
        B=np.vstack([problem.B_w, problem.B_s]),
        C=np.hstack([problem.C_p, problem.C_t]),
        h=problem.h,
    )


def _actuation_effects_on_pressures_and_tractions(
    still: ShoeGroup, shoes: list[_TractionMatrices], n: int, springs: SpringNodes | None
) -> list[EffectsOfActuationForceOnShoe]:
    """The effects of the actuation force on gaps and slips, and of contact stresses on shoes.

    For each shoe the effects are stacked in two ways. The slips per actuation force follow the gaps
    per actuation force. The effects of tractions on the points of actuation and on the feet follow
    the effects of pressures on them.

    Parameters
    ----------
    still : the group without friction
    shoes : the matrices of tractions on each lining
    n : number of nodes, each with one pressure and one traction
    springs : springs whose nodes are the last of the n nodes; None without such nodes
    """
    effects = []
    whole = still.contact_effects_of_each_actuation_force(0.0)
    slipping = [np.arange(n)[own.nodes] for own in whole]
    if springs is not None:
        whole = actuation_effects_with_spring_nodes(still, springs, 0.0, n - len(springs.numbers))
    for normal, slips, shoe in zip(whole, slipping, shoes, strict=True):
        nodes, tangential = np.arange(n)[normal.nodes], shoe.effects
        both = normal._replace(
            nodes=np.concatenate([nodes, n + slips]),
            gap_by_force=np.concatenate([normal.gap_by_force, tangential.gap_by_force]),
            load_point_travel_by_pressure=np.concatenate(
                [normal.load_point_travel_by_pressure, tangential.load_point_travel_by_pressure]
            ),
            foot_force_by_pressure=np.concatenate(
                [normal.foot_force_by_pressure, tangential.foot_force_by_pressure]
            ),
            gap_by_surface_motion=np.concatenate(
                [normal.gap_by_surface_motion, tangential.gap_by_surface_motion]
            ),
        )
        effects.append(both)
    return effects


def _stick_slip_problem_from_contact_problem(
    stacked: equations.ContactProblem, Q: Floats
) -> StickSlipProblem:
    """The stick-slip problem from a contact problem with stacked pressures and tractions.

    `Q` (n, n) is the compliance of the penalty contact.
    """
    A, q, B, C, h = stacked
    n = len(Q)
    return StickSlipProblem(
        A_wp=A[:n, :n],
        A_wt=A[:n, n:],
        A_sp=A[n:, :n],
        A_st=A[n:, n:],
        B_w=B[:n],
        B_s=B[n:],
        C_p=C[:, :n],
        C_t=C[:, n:],
        q_w=q[:n],
        q_s=q[n:],
        h=h,
        Q=Q,
    )
