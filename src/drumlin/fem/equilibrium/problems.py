"""The contact problem of a group of shoes in full slip, at any friction coefficient."""

from functools import cached_property

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.lapack import block_diag
from drumlin.brake.brake import Shoe
from drumlin.contact.active_set import Contact
from drumlin.contact.equations import ContactProblem
from drumlin.contact.self_locking import FrictionDependentProblem
from drumlin.fem.equilibrium.sharing import (
    ForceEffects,
    ForceSharing,
    make_problem_with_shared_forces,
)
from drumlin.fem.equilibrium.state import GroupState
from drumlin.fem.preparation.bodies import ShoeSubstructure

ROWS_AT_A_TIME = 64
"""Number of rows of a shoe's compliance matrix that are assembled at a time.

More rows of a large matrix do not fit into the processor's cache, and fewer rows take more calls of
numpy. The number changes no result.
"""


class GroupProblems(GroupState):
    """A group of shoes with its contact problem at every friction coefficient of the drum.

    The drum drags the linings by the traction mu p. The weighted gap is
    w = M (g + p/eps) - N u + N_ring u_ring.
    Here g is the gap of the unloaded lining, and eps the stiffness of the contact. The gap closes
    as the lining moves by u, and opens as the drum's ring moves by u_ring. The displacement u has
    an elastic part and a part due to the rigid-body modes with the coordinates y. C p = h are the
    equilibria in the test modes.
    """

    @cached_property
    def problem(self) -> ContactProblem:
        """The contact problem at the friction coefficient of the brake."""
        return self.problem_at_friction(self.brake.friction)

    @property
    def friction_dependent_problem(self) -> FrictionDependentProblem:
        """The contact problem as a linear function of the friction coefficient.

        The prepared model must include friction.
        """
        return FrictionDependentProblem.from_two_problems(
            self.problem_at_friction(0.0), self.problem_at_friction(1.0)
        )

    def problem_at_friction(self, friction: float) -> ContactProblem:
        """The contact problem of the group at a friction coefficient.

        Its matrices are linear functions of the friction coefficient.
        """
        sharing = self._force_sharing_at(friction)
        return self.problem_with_own_forces(friction) if sharing is None else sharing.problem

    def problem_with_own_forces(self, friction: float) -> ContactProblem:
        """The contact problem of the group at a friction coefficient, without struts and cam.

        Each shoe has its own actuation force. The matrices of single shoes are the blocks of the
        group's matrices, and the flexibility of the ring is added.
        """
        parts = [self._problem_of_single_shoe(k, friction) for k in range(len(self.members))]
        if self.ring_flexibility_roots is None and len(parts) == 1:
            return parts[0]
        A, q, B, C, h = zip(*parts, strict=True)
        compliance = block_diag(*A)
        if self.ring_flexibility_roots is not None:
            pressed, dragged = self.ring_flexibility_roots
            compliance += pressed.T @ (pressed + friction * self.brake.spin * dragged)
        return ContactProblem(
            compliance, np.concatenate(q), block_diag(*B), block_diag(*C), np.concatenate(h)
        )

    def _problem_of_single_shoe(self, k: int, friction: float) -> ContactProblem:
        """The contact problem of shoe `k` alone on a rigid drum, at a friction coefficient."""
        drag = self._signed_friction_on(self.shoes[k], friction)
        terms, closures = self.frictionless_terms[k], self.gap_closures_of_test_modes[k]
        A = _compliance_with_penalty(self.bodies[k], drag, self.contact_stiffnesses[k])
        C = (drag * closures.tangential - closures.normal).T
        return ContactProblem(A, terms.q, terms.B, C, terms.h)

    def _signed_friction_on(self, shoe: Shoe, friction: float) -> float:
        """The friction coefficient, positive or negative by the sense of drag in a shoe's frame."""
        return friction * self.brake.spin * shoe.frame.sense

    # The following methods treat forces that the shoes share.

    @cached_property
    def force_sharing(self) -> ForceSharing | None:
        """How the shoes share forces by struts and a cam; None if each shoe has its own force."""
        return self._force_sharing_at(self.brake.friction)

    def _force_sharing_at(self, friction: float) -> ForceSharing | None:
        """How the shoes share forces by struts and a cam at a friction coefficient, or None."""
        if not self.struts and not self.cam_shoes:
            return None
        blocks, effects = self.problem_with_own_forces(friction), self.effects_of_forces(friction)
        return make_problem_with_shared_forces(
            blocks, effects, self.own_forces, self.struts, self.cam_shoes, self.cam_force_sum
        )

    def effects_of_forces(self, friction: float) -> list[ForceEffects]:
        """The effects of each shoe's actuation force on gaps, equilibria, tip and foot.

        The effects are linear in the friction coefficient.
        """
        return [self._effects_of_force_on(k, friction) for k in range(len(self.shoes))]

    def _effects_of_force_on(self, k: int, friction: float) -> ForceEffects:
        """The effects of the actuation force of shoe `k` at a friction coefficient."""
        body, shoe, modes = self.bodies[k], self.shoes[k], self.rigid_body_modes[k]
        load = self.unit_loads[k].load_factors
        drag = self._signed_friction_on(shoe, friction)
        tip = -(load @ body.closure_by_load.T)
        # A model that is prepared without friction does not know how friction moves the tip.
        if body.load_motion_by_friction is not None:
            tip = tip + drag * (load @ body.load_motion_by_friction)
        # This is the force on the lining along x and y, per pressure of each node.
        contact = (drag * body.forces[1] - body.forces[0])[:2].T  # (n, 2)
        bearing, direct = np.zeros(len(tip)), 0.0
        if shoe.abutment is not None:
            bearing = -shoe.frame.to_brake(contact) @ shoe.bearing
            direct = -float(shoe.bearing @ shoe.actuation.direction_vector)
        return ForceEffects(
            nodes=self.node_ranges[k],
            modes=self.mode_ranges[k],
            gap_by_force=-(body.closure_by_load @ load),
            tip_travel_by_pressure=tip,
            tip_travel_by_force=float(load @ body.load_motion_by_load @ load),
            work=modes.actuation_work,
            tip_travel_by_modes=modes.tip_travel,
            foot_force_by_pressure=bearing,
            foot_force_by_force=direct,
        )

    def actuation_forces(self, p: Floats) -> Floats:
        """The actuation force (shoes,) of each shoe under pressures p (n,).

        Forces and pressures are per newton of `unit_force`.
        """
        return (
            self.own_forces
            if self.force_sharing is None
            else self.force_sharing.actuation_forces(p)
        )

    def generalised_coordinates(self, contact: Contact) -> list[Floats]:
        """The coordinates (k_i,) of each shoe's rigid-body modes in a solution.

        They are per newton of `unit_force`.
        """
        y = contact.y
        if self.force_sharing is not None:
            y = self.force_sharing.generalised_coordinates(contact.p, contact.y)
        return [y[part] for part in self.mode_ranges]


def _compliance_with_penalty(body: ShoeSubstructure, drag: float, stiffness: float) -> Floats:
    """The compliance matrix (n, n) of a shoe: weighted gaps per nodal pressure.

    It includes the compliance of the contact by the penalty.

    Parameters
    ----------
    body : the substructure of the shoe
    drag : friction coefficient with the sign of the drag in the frame of the shoe
    stiffness : contact stiffness of the penalty per area [Pa/m]
    """
    pressed, dragged, M = body.closure_by_pressure, body.closure_by_friction, body.coupling.M
    A = np.empty(M.shape)
    for first in range(0, len(A), ROWS_AT_A_TIME):
        rows = slice(first, first + ROWS_AT_A_TIME)
        part = np.divide(M[rows], stiffness, out=A[rows])
        part -= pressed[rows]
        if dragged is not None:
            part -= drag * dragged[rows]
    return A
