"""Unilateral contact with Coulomb friction that sticks and slips, one load increment at a time.

Find pressures p, tangential tractions t and free motions y such that, with the changes of slip ds = s - s_0 and
of traction dt = t - t_0 since the last converged increment,

    w = q_w + A_wp p + A_wt t + B_w y,      p >= 0,  w >= 0,  p w = 0
    s = q_s + A_sp p + A_st t + B_s y,      |t| <= mu p,  ds - Q dt = 0 where it sticks,
                                            t = +mu p with ds - Q dt >= 0, or t = -mu p with <= 0, where it slips
    C_p p + C_t t = h

w, s (n,): weighted gaps and slips (of the drum against the lining); Q (n, n): compliance of a tangential penalty,
zero for none. The state of each node, open, sticking, or slipping either way, is iterated like a contact set.
The history (t_0, s_0) is an input: nothing changes it but the caller, who commits what has converged.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy.linalg

from drumlin.arrays import Bools, Floats, Ints
from drumlin.errors import NoAnswer

OPEN, STICK, FORWARD, BACKWARD = 0, 1, 2, 3
MOST_STEPS = 80
PATIENCE = 6
SLACK = 1e-10


class Problem(NamedTuple):
    """The matrices and vectors of the equations above."""

    A_wp: Floats
    A_wt: Floats
    A_sp: Floats
    A_st: Floats
    B_w: Floats
    B_s: Floats
    C_p: Floats
    C_t: Floats
    q_w: Floats
    q_s: Floats
    h: Floats
    Q: Floats


class History(NamedTuple):
    """Tractions and weighted slips (n,) of the last converged increment."""

    t: Floats
    s: Floats


@dataclass(frozen=True)
class Increment:
    """A converged increment: p, t, s (n,), y (k,), `state` (n,) of each node, and the steps that it took."""

    p: Floats
    t: Floats
    s: Floats
    w: Floats
    y: Floats
    state: Ints
    steps: int

    @property
    def history(self) -> History:
        """What the next increment starts from."""
        return History(self.t, self.s)


def solve(problem: Problem, mu: float, history: History, start: Ints) -> Increment:
    """Solve one increment from the states `start` (n,). Raises NoAnswer where the states do not settle."""
    n = len(problem.q_w)
    state = start.copy()
    fewest, patience = n + 1, PATIENCE
    for step in range(1, MOST_STEPS + 1):
        p, t, y = _balance(problem, mu, history, state)
        w = problem.q_w + problem.A_wp @ p + problem.A_wt @ t + problem.B_w @ y
        s = problem.q_s + problem.A_sp @ p + problem.A_st @ t + problem.B_s @ y
        slip = s - history.s - problem.Q @ (t - history.t)
        wanted = _wanted(state, mu, p, t, w, slip, problem)
        wrong = wanted != state
        count = int(np.count_nonzero(wrong))
        if not count:
            return Increment(p, t, s, w, y, state, step)
        fewest, patience = (count, PATIENCE) if count < fewest else (fewest, patience - 1)
        if patience < 0:  # perhaps a cycle: one node at a time until fewer are wrong
            wrong = np.arange(n) == np.flatnonzero(wrong)[-1]
        state = np.where(wrong, wanted, state)
    raise NoAnswer(f"not converged: stick and slip still change after {MOST_STEPS} steps")


def _wanted(state: Ints, mu: float, p: Floats, t: Floats, w: Floats, slip: Floats, problem: Problem) -> Ints:
    """The state that each node's own numbers ask for."""
    p_slack = SLACK * np.abs(p).max(initial=0.0)
    w_slack = SLACK * max(np.abs(problem.q_w).max(), np.abs(problem.A_wp @ p).max())
    s_slack = SLACK * max(np.abs(problem.q_s).max(), np.abs(problem.A_st @ t).max(), np.abs(slip).max())
    wanted = state.copy()
    wanted[(state == OPEN) & (w < -w_slack)] = STICK
    wanted[(state == STICK) & (t > mu * p + p_slack)] = FORWARD
    wanted[(state == STICK) & (t < -mu * p - p_slack)] = BACKWARD
    wanted[(state == FORWARD) & (slip < -s_slack)] = STICK
    wanted[(state == BACKWARD) & (slip > s_slack)] = STICK
    wanted[(state != OPEN) & (p < -p_slack)] = OPEN
    return wanted


def _balance(problem: Problem, mu: float, history: History, state: Ints) -> tuple[Floats, Floats, Floats]:
    """p, t, y of the linear equations of the given states."""
    on, stuck = np.flatnonzero(state != OPEN), np.flatnonzero(state == STICK)
    sliding = mu * ((state == FORWARD).astype(float) - (state == BACKWARD))  # t = sliding p where it slips
    a, b, k = len(on), len(stuck), problem.B_w.shape[1]
    A_w = problem.A_wp[:, on] + problem.A_wt[:, on] * sliding[on]
    Q_s = problem.A_st - problem.Q
    A_s = problem.A_sp[:, on] + Q_s[:, on] * sliding[on]
    matrix = np.block(
        [
            [A_w[on], problem.A_wt[np.ix_(on, stuck)], problem.B_w[on]],
            [A_s[stuck], Q_s[np.ix_(stuck, stuck)], problem.B_s[stuck]],
            [problem.C_p[:, on] + problem.C_t[:, on] * sliding[on], problem.C_t[:, stuck], np.zeros((k, k))],
        ]
    )
    right = np.concatenate([-problem.q_w[on], (history.s - problem.q_s - problem.Q @ history.t)[stuck], problem.h])
    solution = _solve_scaled(matrix, right)
    p, t = np.zeros(len(state)), np.zeros(len(state))
    p[on] = solution[:a]
    t[on] = sliding[on] * p[on]
    t[stuck] = solution[a : a + b]
    return p, t, solution[a + b :]


def _solve_scaled(matrix: Floats, right: Floats) -> Floats:
    """Solve after equilibrating rows and columns, whose units differ."""
    if not right.size:
        return right
    tiny = np.finfo(float).tiny
    row = 1 / np.maximum(np.abs(matrix).max(axis=1), tiny)
    column = 1 / np.maximum(np.abs(row[:, None] * matrix).max(axis=0), tiny)
    lu, pivots, info = scipy.linalg.lapack.dgetrf(row[:, None] * matrix * column)
    if info or not np.isfinite(np.diagonal(lu)).all():
        raise NoAnswer("no equilibrium: contact and friction cannot balance the actuation")
    solution, _ = scipy.linalg.lapack.dgetrs(lu, pivots, row * right)
    return column * solution


def zones(nodes: Floats, state: Ints) -> dict[str, tuple[tuple[float, float], ...]]:
    """Arcs [rad] of stick and of slip: runs of nodes in one state, ending half-way to the next node."""
    edges = np.concatenate([nodes[:1], 0.5 * (nodes[1:] + nodes[:-1]), nodes[-1:]])
    return {
        "stick": _runs(edges, state == STICK),
        "slip": _runs(edges, (state == FORWARD) | (state == BACKWARD)),
    }


def _runs(edges: Floats, where: Bools) -> tuple[tuple[float, float], ...]:
    change = np.flatnonzero(np.diff(np.concatenate([[0], where.astype(int), [0]])))
    return tuple((float(edges[a]), float(edges[b])) for a, b in change.reshape(-1, 2))
