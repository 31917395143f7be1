"""The stick-slip problem of shoes while the drum rests, or is turned by a small angle.

Tractions are unknowns of their own. So are the forces on a foot on a rough abutment, which sticks
and slips as the linings do.
"""

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.lapack import block_diag
from drumlin.brake.brake import Brake
from drumlin.brake.support import UNHELD, Abutment
from drumlin.contact import equations
from drumlin.contact.stick_slip import FrictionalProblem
from drumlin.fem.equilibrium.group import ShoeGroup
from drumlin.fem.equilibrium.sharing import ForceEffects, share
from drumlin.fem.model import PENALTY
from drumlin.fem.preparation.bodies import actuation, contact_stiffness


def holding_problem(group: ShoeGroup) -> tuple[FrictionalProblem, Floats]:
    """The stick-slip problem of a group of shoes while the drum rests, per newton, and its lever.

    The lever (n,) [m^3] is the weighted slip per rotation of the drum: a rotation by Omega adds
    lever Omega to q_s. Tractions and slips count along e_theta of the brake. A node for each foot
    on a rough abutment follows the nodes of the linings, see `Feet`.
    """
    feet = Feet.of(group)
    still = replace(group, brake=feet.smooth(0.0), senses=feet.senses)
    shoes = [_shoe_tractions(still, k) for k in range(len(group.members))]
    problem = feet.added(_with_tractions(still, shoes), still)
    if group.links or group.cam:
        problem = _with_shared_forces(still, problem, [shoe.effects for shoe in shoes])
    lever = np.concatenate([shoe.lever for shoe in shoes])
    return problem, np.append(lever, np.zeros(len(feet.on)))


class _ShoeTractions(NamedTuple):
    """The parts of one shoe that tractions t and slips s add to its contact problem.

    Attributes
    ----------
    A_wt : weighted gaps (n, n) per traction
    A_sp, A_st : weighted slips (n, n) per pressure and per traction
    B_s : weighted slips (n, k) per generalised coordinate
    C_t : equilibria (k, n) per traction
    compliance : of the penalty (n, n), along the surface as across it
    q_s : weighted slips (n,) without pressure and traction
    lever : weighted slip (n,) [m^3] per rotation of the drum
    effects : of the actuation force, by tractions
    """

    A_wt: Floats
    A_sp: Floats
    A_st: Floats
    B_s: Floats
    C_t: Floats
    compliance: Floats
    q_s: Floats
    lever: Floats
    effects: ForceEffects


def _shoe_tractions(group: ShoeGroup, k: int) -> _ShoeTractions:
    """The effects of tractions on shoe `k` of a group without friction."""
    body, shoe, modes = group.bodies[k], group.shoes[k], group.modes[k]
    coupling, condensed = body.coupling, body.condensed
    n = len(body.line.nodes)
    # Tractions count along e_theta of the brake.
    T = shoe.frame.sense * coupling.T
    Y = condensed.half_flexibility(np.hstack([-coupling.N.T, T.T, condensed.load_on_contact]))
    pressed, dragged, loaded = np.split(Y, [n, 2 * n], axis=1)
    load, _ = actuation(body, shoe)
    force = abs(shoe.actuation.force) / group.unit_force
    opened = -dragged.T @ (loaded @ load)
    bearing = np.zeros(n)
    if shoe.abutment is not None:
        nodal = T.reshape(n, -1, 2).sum(axis=1)
        bearing = -shoe.frame.to_brake(nodal) @ shoe.bearing
    effects = group.force_effects(0.0)[k]
    tip = (loaded @ load) @ dragged
    return _ShoeTractions(
        # The gaps close by N u as the tractions T^T t act.
        A_wt=pressed.T @ dragged,
        A_sp=-dragged.T @ pressed,
        A_st=-dragged.T @ dragged,
        B_s=-(T @ modes.contact_modes),
        C_t=(T @ modes.test_modes).T,
        compliance=coupling.M / group.stiffnesses[k],
        q_s=force * opened,
        lever=coupling.lever,
        effects=effects._replace(opened=opened, tip=tip, bearing=bearing),
    )


def _with_tractions(still: ShoeGroup, shoes: list[_ShoeTractions]) -> FrictionalProblem:
    """The stick-slip problem of a group whose feet are free in the plane."""
    normal = still.blocks(0.0)
    A_wt = block_diag(*(shoe.A_wt for shoe in shoes))
    A_sp = block_diag(*(shoe.A_sp for shoe in shoes))
    A_st = block_diag(*(shoe.A_st for shoe in shoes))
    if still.ring is not None:
        pressed, dragged = still.ring
        A_wt = A_wt + pressed.T @ dragged
        A_sp = A_sp - dragged.T @ pressed
        A_st = A_st - dragged.T @ dragged
    return FrictionalProblem(
        A_wp=normal.A,
        A_wt=A_wt,
        A_sp=A_sp,
        A_st=A_st,
        B_w=normal.B,
        B_s=block_diag(*(shoe.B_s for shoe in shoes)),
        C_p=normal.C,
        C_t=block_diag(*(shoe.C_t for shoe in shoes)),
        q_w=normal.q,
        q_s=np.concatenate([shoe.q_s for shoe in shoes]),
        h=normal.h,
        Q=block_diag(*(shoe.compliance for shoe in shoes)),
    )


class Feet(NamedTuple):
    """The feet of a group's shoes on rough abutments, each a node of the stick-slip problem.

    The node bears a force p [N] along the normal of the abutment's face and a force t along the
    face.

    Attributes
    ----------
    group : the group
    on : the shoes of the group whose feet are nodes
    senses : of the group without these nodes, in which the feet are free in the plane
    yielding : compliance (feet,) [m/N] of each node across and along the face; it stands for the
        penalty of the lining
    """

    group: ShoeGroup
    on: list[int]
    senses: tuple[int, ...]
    yielding: Floats

    @classmethod
    def of(cls, group: ShoeGroup) -> "Feet":
        """The feet of a group on rough abutments."""
        rough = [shoe.abutment is not None and shoe.abutment.friction > 0 for shoe in group.shoes]
        on = [k for k, is_rough in enumerate(rough) if is_rough]
        # Exact contact needs a compliance for feet all the same.
        penalty = PENALTY if math.isinf(group.penalty) else group.penalty
        stiffness = []
        for k in on:
            area = float(group.bodies[k].coupling.area.sum())
            stiffness.append(contact_stiffness(group.shoes[k], penalty) * area)
        senses = tuple(UNHELD if is_rough else 1 for is_rough in rough)
        return cls(group, on, senses, 1 / np.array(stiffness))

    def smooth(self, friction: float) -> Brake:
        """The brake at a friction of the drum, its abutments without friction."""
        shoes = []
        for shoe in self.group.brake.shoes:
            smooth = shoe
            if shoe.abutment is not None:
                smooth = shoe.model_copy(update={"abutment": _without_friction(shoe.abutment)})
            shoes.append(smooth)
        return self.group.brake.model_copy(update={"friction": friction, "shoes": tuple(shoes)})

    def friction(self) -> Floats:
        """The friction coefficient (n,) of every node."""
        n = sum(part.stop - part.start for part in self.group.node_ranges)
        abutments = [self.group.shoes[k].abutment for k in self.on]
        of_feet = [abutment.friction for abutment in abutments if abutment is not None]
        return np.array([self.group.brake.friction] * n + of_feet)

    def added(self, problem: FrictionalProblem, still: ShoeGroup) -> FrictionalProblem:
        """The problem with a node for each foot; `still` is the group whose feet are free."""
        if not self.on:
            return problem
        count = len(self.on)
        off = np.zeros((count, problem.B_w.shape[1]))
        slid = np.zeros((count, problem.B_w.shape[1]))
        # The shoe turns about its foot, so that a turn does not move the foot.
        for row, k in enumerate(self.on):
            names = still.shoes[k].freedoms(UNHELD).names
            first = still.mode_ranges[k].start
            off[row, first + names.index("off")] = 1.0
            slid[row, first + names.index("slide")] = 1.0
        yielding, nothing = np.diag(self.yielding), np.zeros((count, count))
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


def _without_friction(abutment: Abutment) -> Abutment:
    """The abutment without friction."""
    return abutment.model_copy(update={"friction": 0.0})


def _with_shared_forces(
    still: ShoeGroup, problem: FrictionalProblem, by_tractions: list[ForceEffects]
) -> FrictionalProblem:
    """The problem of shoes that share forces by struts and a cam.

    `by_tractions` holds the effects of each shoe's force as tractions act. Pressures and tractions
    are put together as the n + n pressures of a contact problem.
    """
    n = len(problem.q_w)
    whole = equations.Problem(
        A=np.block([[problem.A_wp, problem.A_wt], [problem.A_sp, problem.A_st]]),
        q=np.concatenate([problem.q_w, problem.q_s]),
        B=np.vstack([problem.B_w, problem.B_s]),
        C=np.hstack([problem.C_p, problem.C_t]),
        h=problem.h,
    )
    effects = []
    for normal, tangential in zip(still.force_effects(0.0), by_tractions, strict=True):
        nodes = np.arange(n)[normal.nodes]
        effects.append(
            normal._replace(
                nodes=np.concatenate([nodes, n + nodes]),
                opened=np.concatenate([normal.opened, tangential.opened]),
                tip=np.concatenate([normal.tip, tangential.tip]),
                bearing=np.concatenate([normal.bearing, tangential.bearing]),
            )
        )
    sharing = share(whole, effects, still.own_forces, still.links, still.cam, still.total)
    A, q, B, C, h = sharing.problem
    return FrictionalProblem(
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
        Q=problem.Q,
    )
