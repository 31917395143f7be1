"""The contact problem of a group of shoes in full slip, at any friction coefficient."""

from functools import cached_property

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.lapack import block_diag
from drumlin.brake.brake import Shoe
from drumlin.contact.active_set import Contact
from drumlin.contact.equations import Problem
from drumlin.contact.self_locking import Sliding
from drumlin.fem.equilibrium.sharing import ForceEffects, Sharing, share_forces
from drumlin.fem.equilibrium.state import GroupState
from drumlin.fem.preparation.bodies import ShoeSubstructure

ROW_BLOCK = 64
"""Rows of a compliance matrix that are assembled at a time.

More rows of a large matrix do not stay in the processor's cache, and fewer rows cost more calls.
The number of rows changes no result.
"""


class GroupProblems(GroupState):
    """A group of shoes with its contact problem at every friction coefficient of the drum.

    The drum drags the linings by mu p. The weighted gap is
    w = M (g + p/eps) - N u + N_ring u_ring.
    The gap closes as the lining moves by u and opens as the ring moves by u_ring. The displacement
    u has an elastic part and a part by the rigid-body modes y. C p = h are the equilibria in the
    test modes.
    """

    @cached_property
    def problem(self) -> Problem:
        """The contact problem at the friction coefficient of the brake."""
        return self.problem_at(self.brake.friction)

    @property
    def sliding(self) -> Sliding:
        """The contact problem as a linear function of the friction coefficient.

        The prepared model must include friction.
        """
        return Sliding.through(self.problem_at(0.0), self.problem_at(1.0))

    def problem_at(self, friction: float) -> Problem:
        """The contact problem at a friction coefficient, on which its matrices depend linearly."""
        sharing = self._sharing_at(friction)
        return self.blocks(friction) if sharing is None else sharing.problem

    def blocks(self, friction: float) -> Problem:
        """The contact problem at a friction coefficient if no shoe shares its force.

        The matrices of single shoes are the blocks, and the flexibility of the ring is added.
        """
        parts = [self._shoe_problem(k, friction) for k in range(len(self.members))]
        if self.ring is None and len(parts) == 1:
            return parts[0]
        A, q, B, C, h = zip(*parts, strict=True)
        compliance = block_diag(*A)
        if self.ring is not None:
            pressed, dragged = self.ring
            compliance += pressed.T @ (pressed + friction * self.brake.spin * dragged)
        return Problem(
            compliance, np.concatenate(q), block_diag(*B), block_diag(*C), np.concatenate(h)
        )

    def _shoe_problem(self, k: int, friction: float) -> Problem:
        """The contact problem of shoe `k` alone on a rigid drum, at a friction coefficient."""
        drag = self._drag_on(self.shoes[k], friction)
        terms, closures = self.load_terms[k], self.test_closures[k]
        A = _gap_per_pressure(self.bodies[k], drag, self.stiffnesses[k])
        C = (drag * closures.tangential - closures.normal).T
        return Problem(A, terms.q, terms.B, C, terms.h)

    def _drag_on(self, shoe: Shoe, friction: float) -> float:
        """The friction coefficient with the sign of the drag in the frame of a shoe."""
        return friction * self.brake.spin * shoe.frame.sense

    # Forces that the shoes share

    @cached_property
    def sharing(self) -> Sharing | None:
        """How the shoes share forces by struts and a cam; None if each shoe has its own force."""
        return self._sharing_at(self.brake.friction)

    def _sharing_at(self, friction: float) -> Sharing | None:
        """How the shoes share forces at a friction coefficient."""
        if not self.links and not self.cam:
            return None
        blocks, effects = self.blocks(friction), self.force_effects(friction)
        return share_forces(blocks, effects, self.own_forces, self.links, self.cam, self.total)

    def force_effects(self, friction: float) -> list[ForceEffects]:
        """The effects of each shoe's actuation force, which are linear in the friction."""
        return [self._force_effects(k, friction) for k in range(len(self.shoes))]

    def _force_effects(self, k: int, friction: float) -> ForceEffects:
        """The effects of the actuation force of shoe `k` at a friction coefficient."""
        body, shoe, modes = self.bodies[k], self.shoes[k], self.modes[k]
        load = self.loads[k].factors
        drag = self._drag_on(shoe, friction)
        tip = -(load @ body.closure_by_load.T)
        # A model that is prepared without friction has no motion of the load by friction.
        if body.load_motion_by_friction is not None:
            tip = tip + drag * (load @ body.load_motion_by_friction)
        # The force on the lining along x and y, per pressure of each node.
        contact = (drag * body.forces[1] - body.forces[0])[:2].T  # (n, 2)
        bearing, direct = np.zeros(len(tip)), 0.0
        if shoe.abutment is not None:
            bearing = -shoe.frame.to_brake(contact) @ shoe.bearing
            direct = -float(shoe.bearing @ shoe.actuation.direction_vector)
        return ForceEffects(
            nodes=self.node_ranges[k],
            modes=self.mode_ranges[k],
            opened=-(body.closure_by_load @ load),
            tip=tip,
            yields=float(load @ body.load_motion_by_load @ load),
            work=modes.work,
            moves=modes.tip,
            bearing=bearing,
            direct=direct,
        )

    def forces(self, p: Floats) -> Floats:
        """The actuation forces (shoes,) under pressures p (n,), both per newton of `unit_force`."""
        return self.own_forces if self.sharing is None else self.sharing.forces(p)

    def coordinates(self, contact: Contact) -> list[Floats]:
        """The generalised coordinates of each shoe in an answer, per newton of `unit_force`."""
        y = contact.y
        if self.sharing is not None:
            y = self.sharing.coordinates(contact.p, contact.y)
        return [y[part] for part in self.mode_ranges]


def _gap_per_pressure(body: ShoeSubstructure, drag: float, stiffness: float) -> Floats:
    """The weighted gaps (n, n) of a shoe per pressure, with the compliance of the penalty.

    Parameters
    ----------
    body : the substructure of the shoe
    drag : friction coefficient with the sign of the drag in the frame of the shoe
    stiffness : contact stiffness of the penalty per area [Pa/m]
    """
    pressed, dragged, M = body.closure_by_pressure, body.closure_by_friction, body.coupling.M
    A = np.empty(M.shape)
    for first in range(0, len(A), ROW_BLOCK):
        rows = slice(first, first + ROW_BLOCK)
        part = np.divide(M[rows], stiffness, out=A[rows])
        part -= pressed[rows]
        if dragged is not None:
            part -= drag * dragged[rows]
    return A
