"""The holding brake: from rest through partial slip to full slip, as the drum is turned against the shoes."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.linalg

from drumlin.arrays import Floats, Ints
from drumlin.brake.drum_brake import Brake
from drumlin.contact import active_set, stick_slip
from drumlin.contact.stick_slip import BACKWARD, FORWARD, OPEN, STICK, History, Increment, Problem
from drumlin.errors import BadInput, NoAnswer
from drumlin.fem.assembly import Scene, actuation
from drumlin.fem.group import ShoeGroup, grouped, turns_towards
from drumlin.fem.model import PENALTY, respond

HALVINGS = 8  # of an increment that does not settle


@dataclass(frozen=True)
class Hold:
    """One state of a holding brake.

    `rotation` [rad] of the drum against its rest; `torque` [N m], the moment that holds the drum there, positive
    against the rotation; `dissipated` [J] by slip since the force came on. For each shoe `theta` (n,) [rad],
    `pressure` and `traction` (n,) [Pa] along e_theta on the lining, `state` (n,): open, stick, slip forward or
    backward; `stick`, `slip`: arcs [rad].
    """

    rotation: float
    torque: float
    names: tuple[str, ...]
    theta: tuple[Floats, ...]
    pressure: tuple[Floats, ...]
    traction: tuple[Floats, ...]
    state: tuple[Ints, ...]
    stick: tuple[tuple[tuple[float, float], ...], ...]
    slip: tuple[tuple[tuple[float, float], ...], ...]
    dissipated: float

    @property
    def sticking(self) -> float:
        """Share of the contact nodes that stick."""
        touching = sum(int((state != OPEN).sum()) for state in self.state)
        return sum(int((state == STICK).sum()) for state in self.state) / touching if touching else 0.0


def holding_problem(group: ShoeGroup) -> tuple[Problem, Floats]:
    """The stick-slip problem of a group of shoes at rest of the drum, per newton; and the lever (n,) [m^3].

    The lever is the weighted slip per rotation of the drum: rotating it by Omega adds lever Omega to q_s.
    Tractions and slips count along e_theta of the brake.
    """
    normal = group.at_friction(0.0)
    shoes = [_tangential(group, k) for k in range(len(group.members))]
    A_wt, A_sp, A_st, B_s, C_t, Q = (scipy.linalg.block_diag(*(shoe[k] for shoe in shoes)) for k in range(6))
    q_s, lever = (np.concatenate([shoe[k] for shoe in shoes]) for k in (6, 7))
    if group.ring is not None:
        pressed, dragged = group.ring
        A_wt, A_sp, A_st = A_wt + pressed.T @ dragged, A_sp - dragged.T @ pressed, A_st - dragged.T @ dragged
    problem = Problem(
        A_wp=normal.A, A_wt=A_wt, A_sp=A_sp, A_st=A_st, B_w=normal.B, B_s=B_s, C_p=normal.C, C_t=C_t,
        q_w=normal.q, q_s=q_s, h=normal.h, Q=Q,
    )  # fmt: skip
    return problem, lever


def _tangential(group: ShoeGroup, k: int) -> tuple[Floats, ...]:
    """A_wt, A_sp, A_st, B_s, C_t, Q, q_s and lever of shoe `k` of a group."""
    body, shoe = group.bodies[k], group.shoes[k]
    sense, coupling, condensed = shoe.frame.sense, body.coupling, body.condensed
    n = len(body.line.nodes)
    T = sense * coupling.T  # along e_theta of the brake
    Y = condensed.half(np.hstack([-coupling.N.T, T.T, condensed.load_c]))
    pressed, dragged, loaded = np.split(Y, [n, 2 * n], axis=1)
    load, _ = actuation(body, shoe)
    share = abs(shoe.actuation.force) / group.unit_force
    turning = T @ body.turned
    compliance = coupling.M / group.stiffnesses[k]
    return (
        pressed.T @ dragged,  # -N u under T^T t
        -dragged.T @ pressed,
        -dragged.T @ dragged,
        -turning[:, None],
        turning[None],
        compliance,
        -share * (dragged.T @ (loaded @ load)),
        coupling.lever,
    )


def hold(
    scene: Scene,
    brake: Brake,
    rotations: Floats,
    *,
    penalty: float = PENALTY,
    say: Callable[[str], None] = lambda _: None,
) -> list[Hold]:
    """Turn the drum through `rotations` [rad], positive in the sense of the brake's rotation, after the force is on.

    The force is applied at rest of the drum, then each rotation is one increment, halved where stick and slip do
    not settle. Raises NoAnswer: a shoe that does not touch, no equilibrium, not converged.
    """
    if brake.friction == 0 or scene.brake.friction == 0:
        raise BadInput(f"friction = {brake.friction:g}: must be greater than 0 for a holding brake")
    groups = grouped(scene, brake, list(range(len(brake.shoes))), penalty)
    for i, shoe in enumerate(brake.shoes):
        if not turns_towards(scene.bodies[i], shoe):
            raise NoAnswer(f"shoe {shoe.name!r}: does not touch the drum, so that it cannot hold it")
    paths = []
    for group in groups:
        say(f"holding: {', '.join(shoe.name for shoe in group.shoes)}")
        paths.append((group, *_path(group, rotations)))
    return [_state(brake, paths, k, float(rotation)) for k, rotation in enumerate(rotations)]


def _path(group: ShoeGroup, rotations: Floats) -> tuple[list[Increment], list[float]]:
    """Increments at the rotations, and the energy [J per newton squared] dissipated up to each."""
    problem, lever = holding_problem(group)
    brake, size = group.brake, group.unit_force
    n = len(lever)
    rest = History(np.zeros(n), np.zeros(n))
    normal = active_set.Problem(problem.A_wp, problem.q_w, problem.B_w, problem.C_p, problem.h)
    touching = active_set.solve(normal).active
    increment = stick_slip.solve(problem, brake.friction, rest, np.where(touching, STICK, OPEN))
    done, spent, reached = [], [], 0.0
    energy = _slip_work(problem, increment, rest)
    for rotation in rotations:
        for step in turned(problem, lever * (brake.spin / size), brake.friction, increment, reached, float(rotation)):
            energy += _slip_work(problem, step, increment.history)
            increment = step
        reached = float(rotation)
        done.append(increment)
        spent.append(energy * size**2)
    return done, spent


def turned(
    problem: Problem, lever: Floats, friction: float, increment: Increment, start: float, end: float
) -> Iterator[Increment]:
    """The increments from a converged one at the rotation `start` to `end` [rad], q_s growing by lever (n,) a radian.

    One, where its states settle; else halves of it. Raises NoAnswer where 2^-8 of it does not settle.
    """
    reached, pieces = start, 1
    while reached != end or start == end:
        step = end if pieces == 1 else reached + (end - reached) / pieces
        moved = problem._replace(q_s=problem.q_s + lever * step)
        try:
            increment = stick_slip.solve(moved, friction, increment.history, increment.state)
        except NoAnswer:
            if pieces >= 2**HALVINGS:
                raise
            pieces *= 2
            continue
        yield increment
        if step == end:
            return
        reached, pieces = step, pieces - 1


def _slip_work(problem: Problem, after: Increment, before: History) -> float:
    """Work of the tractions on the plastic slip of an increment, by its end values."""
    slip = after.s - before.s - problem.Q @ (after.t - before.t)
    return float(after.t @ slip)


def _state(brake: Brake, paths: list[tuple[ShoeGroup, list[Increment], list[float]]], k: int, rotation: float) -> Hold:
    found: dict[int, tuple[Floats, Floats, Floats, Ints]] = {}
    torque = dissipated = 0.0
    for group, increments, spent in paths:
        dissipated += spent[k]
        size = group.unit_force
        for i, body, shoe, part in zip(group.members, group.bodies, group.shoes, group.parts, strict=True):
            p, t, state = size * increments[k].p[part], size * increments[k].t[part], increments[k].state[part]
            torque += brake.spin * float(body.coupling.lever @ t)
            forward = slice(None, None, shoe.frame.sense)
            found[i] = (shoe.frame.theta(body.line.phi)[forward], p[forward], t[forward], state[forward])
    order = sorted(found)
    arcs = [stick_slip.zones(found[i][0], found[i][3]) for i in order]
    return Hold(
        rotation=rotation,
        torque=torque,
        names=tuple(brake.shoes[i].name for i in order),
        theta=tuple(found[i][0] for i in order),
        pressure=tuple(found[i][1] for i in order),
        traction=tuple(found[i][2] for i in order),
        state=tuple(found[i][3] for i in order),
        stick=tuple(arc["stick"] for arc in arcs),
        slip=tuple(arc["slip"] for arc in arcs),
        dissipated=dissipated,
    )


def full_slip_rotation(scene: Scene, brake: Brake, *, penalty: float = PENALTY) -> float:
    """A rotation of the drum [rad] after which every touching node slips, found by doubling. Raises NoAnswer."""
    rotation = 1e-7
    target = respond(scene, brake, penalty=penalty).torque
    while rotation < 0.2:
        try:
            states = hold(scene, brake, rotation * np.linspace(0.25, 1, 4), penalty=penalty)
        except NoAnswer:
            break
        if states[-1].sticking == 0 and math.isclose(states[-1].torque, target, rel_tol=1e-6):
            return rotation
        rotation *= 2
    raise NoAnswer("the drum does not come to slip everywhere within small rotations")


def as_dict(states: list[Hold]) -> list[dict[str, Any]]:
    """States as plain data for JSON: rad, N m, Pa, J; node states by name."""
    names = {OPEN: "open", STICK: "stick", FORWARD: "slip", BACKWARD: "slip back"}
    return [
        {
            "rotation": state.rotation,
            "torque": state.torque,
            "dissipated": state.dissipated,
            "shoes": [
                {
                    "name": name,
                    "theta": state.theta[i].tolist(),
                    "pressure": state.pressure[i].tolist(),
                    "traction": state.traction[i].tolist(),
                    "state": [names[int(value)] for value in state.state[i]],
                    "stick": [list(arc) for arc in state.stick[i]],
                    "slip": [list(arc) for arc in state.slip[i]],
                }
                for i, name in enumerate(state.names)
            ],
        }
        for state in states
    ]
