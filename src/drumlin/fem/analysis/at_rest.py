"""The stick-slip problem of shoes while the drum is at rest or turned by a little.

Tractions are unknowns of their own, and so is what acts on a foot on a face with friction, which
sticks and slips as the linings do.
"""

import math
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.lapack import block_diag
from drumlin.brake.brake import Brake
from drumlin.brake.support import UNHELD, Abutment
from drumlin.contact import equations
from drumlin.contact.stick_slip import Problem
from drumlin.fem.equilibrium.group import ShoeGroup
from drumlin.fem.equilibrium.sharing import Pushed, share
from drumlin.fem.model import PENALTY
from drumlin.fem.preparation.bodies import actuation, contact_stiffness


def holding_problem(group: ShoeGroup) -> tuple[Problem, Floats]:
    """The stick-slip problem of a group of shoes at rest of the drum, per newton; and the lever
    (n,) [m^3].

    The lever is the weighted slip per rotation of the drum: rotating it by Omega adds lever Omega
    to q_s. Tractions and slips count along e_theta of the brake. After the nodes of the linings
    comes one for each foot on a face with friction, see `Feet`.
    """
    feet = Feet.of(group)
    still = replace(group, brake=feet.smooth(0.0), senses=feet.senses)
    normal = still.blocks(0.0)
    shoes = [_tangential(still, k) for k in range(len(group.members))]
    A_wt, A_sp, A_st, B_s, C_t, Q = (block_diag(*(shoe[k] for shoe in shoes)) for k in range(6))
    q_s, lever = (np.concatenate([shoe[k] for shoe in shoes]) for k in (6, 7))
    if group.ring is not None:
        pressed, dragged = group.ring
        A_wt, A_sp, A_st = (
            A_wt + pressed.T @ dragged,
            A_sp - dragged.T @ pressed,
            A_st - dragged.T @ dragged,
        )
    problem = Problem(
        A_wp=normal.A, A_wt=A_wt, A_sp=A_sp, A_st=A_st, B_w=normal.B, B_s=B_s, C_p=normal.C, C_t=C_t,
        q_w=normal.q, q_s=q_s, h=normal.h, Q=Q,
    )  # fmt: skip
    problem = feet.added(problem, still)
    if group.links or group.cam:
        problem = _shared(still, problem, [shoe[8] for shoe in shoes])
    return problem, np.append(lever, np.zeros(len(feet.on)))


class Feet(NamedTuple):
    """Feet on faces with friction, of the shoes `on` of a group: a node each, of a force p [N]
    along the face's normal and t along the face, that gives way by `yielding` (feet,) [m/N] where
    it is pressed or dragged, as the penalty of the lining has it. Without it the shoe's foot is
    free in the plane: `senses`.
    """

    group: ShoeGroup
    on: list[int]
    senses: tuple[int, ...]
    yielding: Floats

    @classmethod
    def of(cls, group: ShoeGroup) -> "Feet":
        """Those of a group."""
        rough = [shoe.abutment is not None and shoe.abutment.friction > 0 for shoe in group.shoes]
        on = [k for k, is_rough in enumerate(rough) if is_rough]
        soft = PENALTY if math.isinf(group.penalty) else group.penalty
        stiffness = [
            contact_stiffness(group.shoes[k], soft) * float(group.bodies[k].coupling.area.sum())
            for k in on
        ]
        senses = tuple(UNHELD if is_rough else 1 for is_rough in rough)
        return cls(group, on, senses, 1 / np.array(stiffness))

    def smooth(self, friction: float) -> Brake:
        """The brake at a friction of the drum, its abutments without."""
        shoes = [
            shoe
            if shoe.abutment is None
            else shoe.model_copy(update={"abutment": _smooth(shoe.abutment)})
            for shoe in self.group.brake.shoes
        ]
        return self.group.brake.model_copy(update={"friction": friction, "shoes": tuple(shoes)})

    def friction(self) -> Floats:
        """The friction coefficient of every node (n,)."""
        n = sum(part.stop - part.start for part in self.group.parts)
        feet = [self.group.shoes[k].abutment for k in self.on]
        return np.array(
            [self.group.brake.friction] * n + [foot.friction for foot in feet if foot is not None]
        )

    def added(self, problem: Problem, still: ShoeGroup) -> Problem:
        """The problem of a group whose feet are free, with a node for each."""
        if not self.on:
            return problem
        off, slid = (
            np.zeros((len(self.on), problem.B_w.shape[1])),
            np.zeros((len(self.on), problem.B_w.shape[1])),
        )
        for row, k in enumerate(self.on):  # a turn does not move the foot
            names = still.shoes[k].freedoms(UNHELD).names
            off[row, still.rows[k].start + names.index("off")] = 1.0
            slid[row, still.rows[k].start + names.index("slide")] = 1.0
        soft, none = np.diag(self.yielding), np.zeros((len(self.on),) * 2)
        no = np.zeros(len(self.on))
        joined = block_diag
        return problem._replace(
            A_wp=joined(problem.A_wp, soft), A_wt=joined(problem.A_wt, none), A_sp=joined(problem.A_sp, none),
            A_st=joined(problem.A_st, none), Q=joined(problem.Q, soft),
            B_w=np.vstack([problem.B_w, off]), B_s=np.vstack([problem.B_s, -slid]),
            C_p=np.hstack([problem.C_p, off.T]), C_t=np.hstack([problem.C_t, slid.T]),
            q_w=np.append(problem.q_w, no), q_s=np.append(problem.q_s, no),
        )  # fmt: skip


def _smooth(face: Abutment) -> Abutment:
    return face.model_copy(update={"friction": 0.0})


def _shared(still: ShoeGroup, problem: Problem, dragged: list[Pushed]) -> Problem:
    """The problem of shoes that share forces by struts and a cam; `dragged`: what each is under
    tractions.
    """
    n = len(problem.q_w)
    whole = equations.Problem(
        A=np.block([[problem.A_wp, problem.A_wt], [problem.A_sp, problem.A_st]]),
        q=np.concatenate([problem.q_w, problem.q_s]),
        B=np.vstack([problem.B_w, problem.B_s]),
        C=np.hstack([problem.C_p, problem.C_t]),
        h=problem.h,
    )
    pushed = []
    for one, two in zip(still.pushed(0.0), dragged, strict=True):
        nodes = np.arange(n)[one.part]
        opened, tip, bearing = (
            np.concatenate(both)
            for both in ((one.opened, two.opened), (one.tip, two.tip), (one.bearing, two.bearing))
        )
        part = np.concatenate([nodes, n + nodes])
        pushed.append(one._replace(part=part, opened=opened, tip=tip, bearing=bearing))
    A, q, B, C, h = share(
        whole, pushed, still.own_forces, still.links, still.cam, still.total
    ).problem
    return Problem(
        A_wp=A[:n, :n], A_wt=A[:n, n:], A_sp=A[n:, :n], A_st=A[n:, n:], B_w=B[:n], B_s=B[n:], C_p=C[:, :n],
        C_t=C[:, n:], q_w=q[:n], q_s=q[n:], h=h, Q=problem.Q,
    )  # fmt: skip


def _tangential(group: ShoeGroup, k: int) -> tuple[Any, ...]:
    """A_wt, A_sp, A_st, B_s, C_t, Q, q_s and lever of shoe `k` of a group, and what it is under
    tractions.
    """
    body, shoe = group.bodies[k], group.shoes[k]
    sense, coupling, condensed = shoe.frame.sense, body.coupling, body.condensed
    n = len(body.line.nodes)
    T = sense * coupling.T  # along e_theta of the brake
    Y = condensed.half(np.hstack([-coupling.N.T, T.T, condensed.load_on_contact]))
    pressed, dragged, loaded = np.split(Y, [n, 2 * n], axis=1)
    load, _ = actuation(body, shoe)
    share = abs(shoe.actuation.force) / group.unit_force
    motions = group.motions[k]
    compliance = coupling.M / group.stiffnesses[k]
    opened = -dragged.T @ (loaded @ load)
    nodal = T.reshape(n, -1, 2).sum(axis=1)
    bearing = np.zeros(n) if shoe.abutment is None else -shoe.frame.to_brake(nodal) @ shoe.bearing
    pushed = group.pushed(0.0)[k]._replace(
        opened=opened, tip=(loaded @ load) @ dragged, bearing=bearing
    )
    return (
        pressed.T @ dragged,  # -N u under T^T t
        -dragged.T @ pressed,
        -dragged.T @ dragged,
        -(T @ motions.moved),
        (T @ motions.tested).T,
        compliance,
        share * opened,
        coupling.lever,
        pushed,
    )
