"""The contact problems of a group of shoes in full slip, one for each friction coefficient."""

from functools import cached_property

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.lapack import block_diag
from drumlin.brake.brake import Shoe
from drumlin.contact.active_set import Contact
from drumlin.contact.equations import Problem
from drumlin.contact.self_locking import Sliding
from drumlin.fem.equilibrium.sharing import ForceEffects, Sharing, share
from drumlin.fem.equilibrium.state import GroupState
from drumlin.fem.preparation.bodies import Body

ROW_BLOCK = 64
"""Rows of a compliance matrix that are assembled at a time. Of large matrices more rows do not stay
in the processor's cache, and fewer rows cost more calls. It changes no number.
"""


class GroupProblems(GroupState):
    """A group of shoes and its contact problems, a family in the friction coefficient of the drum.

    The drum drags the linings by mu p. The weighted gap
    w = M (g + p/eps) - N u + N_ring u_ring
    closes as the lining moves by u, which is elastic and by the rigid-body modes y, and opens as
    the ring moves by u_ring. C p = h are the equilibria in the test modes.
    """

    @cached_property
    def problem(self) -> Problem:
        """The contact problem at the friction coefficient of the brake."""
        return self.problem_at(self.brake.friction)

    @property
    def sliding(self) -> Sliding:
        """The contact problem as a linear function of the friction coefficient.

        The model must have been prepared with friction.
        """
        return Sliding.through(self.problem_at(0.0), self.problem_at(1.0))

    def problem_at(self, friction: float) -> Problem:
        """The contact problem at a friction coefficient; linear in it."""
        sharing = self._sharing_at(friction)
        return self.blocks(friction) if sharing is None else sharing.problem

    def blocks(self, friction: float) -> Problem:
        """The problem at a friction coefficient in which each shoe has the force of its own."""
        parts = [self._shoe_problem(k, friction) for k in range(len(self.members))]
        if self.ring is None and len(parts) == 1:
            return parts[0]
        A = block_diag(*(part.A for part in parts))
        if self.ring is not None:
            pressed, dragged = self.ring
            A += pressed.T @ (pressed + friction * self.brake.spin * dragged)
        return Problem(
            A=A,
            q=np.concatenate([part.q for part in parts]),
            B=block_diag(*(part.B for part in parts)),
            C=block_diag(*(part.C for part in parts)),
            h=np.concatenate([part.h for part in parts]),
        )

    def _shoe_problem(self, k: int, friction: float) -> Problem:
        """The contact problem of shoe `k` alone, on a rigid drum."""
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
        """How the shoes share forces by struts and a cam; None where each shoe has its own force."""
        return self._sharing_at(self.brake.friction)

    def _sharing_at(self, friction: float) -> Sharing | None:
        """How the shoes share forces at a friction coefficient."""
        if not self.links and not self.cam:
            return None
        blocks, effects = self.blocks(friction), self.force_effects(friction)
        return share(blocks, effects, self.own_forces, self.links, self.cam, self.total)

    def force_effects(self, friction: float) -> list[ForceEffects]:
        """The effects of each shoe's actuation force at a friction coefficient; linear in it."""
        return [self._force_effects(k, friction) for k in range(len(self.shoes))]

    def _force_effects(self, k: int, friction: float) -> ForceEffects:
        """The effects of the actuation force of shoe `k`."""
        body, shoe, modes = self.bodies[k], self.shoes[k], self.modes[k]
        load = self.loads[k].factors
        drag = self._drag_on(shoe, friction)
        tip_by_friction = 0.0 if body.tip_dragged is None else drag * (load @ body.tip_dragged)
        tip = -(load @ body.closing_loaded.T) + tip_by_friction
        # The force x, y on the lining per pressure.
        contact = (drag * body.forces[1] - body.forces[0])[:2].T  # (n, 2)
        bearing, direct = np.zeros(len(tip)), 0.0
        if shoe.abutment is not None:
            bearing = -shoe.frame.to_brake(contact) @ shoe.bearing
            direct = -float(shoe.bearing @ shoe.actuation.direction_vector)
        return ForceEffects(
            nodes=self.node_ranges[k],
            modes=self.mode_ranges[k],
            opened=-(body.closing_loaded @ load),
            tip=tip,
            yields=float(load @ body.tip_loaded @ load),
            work=modes.work,
            moves=modes.tip,
            bearing=bearing,
            direct=direct,
        )

    def forces(self, p: Floats) -> Floats:
        """The actuation forces (shoes,) under the pressures p (n,), both per newton."""
        return self.own_forces if self.sharing is None else self.sharing.forces(p)

    def coordinates(self, contact: Contact) -> list[Floats]:
        """The generalised coordinates of each shoe in an answer, per newton."""
        y = contact.y
        if self.sharing is not None:
            y = self.sharing.coordinates(contact.p, contact.y)
        return [y[part] for part in self.mode_ranges]


def _gap_per_pressure(body: Body, drag: float, stiffness: float) -> Floats:
    """A (n, n): the weighted gaps of a shoe per pressure, the compliance of the penalty included."""
    pressed, dragged, M = body.closing_pressed, body.closing_dragged, body.coupling.M
    A = np.empty(M.shape)
    for first in range(0, len(A), ROW_BLOCK):
        rows = slice(first, first + ROW_BLOCK)
        part = np.divide(M[rows], stiffness, out=A[rows])
        part -= pressed[rows]
        if dragged is not None:
            part -= drag * dragged[rows]
    return A
