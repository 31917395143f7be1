"""Unilateral contact with Coulomb friction that sticks and slips, one load increment at a time.

Find pressures p, tangential tractions t and free motions y such that, with the changes of slip ds =
s - s_0 and of traction dt = t - t_0 since the last converged increment,

    w = q_w + A_wp p + A_wt t + B_w y,      p >= 0,  w >= 0,  p w = 0
    s = q_s + A_sp p + A_st t + B_s y,      |t| <= mu p,  ds - Q dt = 0 where it sticks,
                                            t = +mu p with ds - Q dt >= 0, or t = -mu p with <= 0,
                                            where it slips
    C_p p + C_t t = h

w, s (n,): weighted gaps and slips (of the drum against the lining); Q (n, n): compliance of a
tangential penalty, zero for none.

What a node may do is a surface of four flat pieces: open, sticking, slipping either way. In a plane
of (a, b) they are the half-plane a < 0 and three wedges of a > 0, and each borders on two others:

    open:      p = t = 0,   w > 0;   w = 0 is the edge to slip, forward or backward as its slip has gone
    forward:   t = +mu p,   p > 0 (edge to open),  slip > 0 (edge to stick);     backward alike
    stick:     slip = 0,    |t| < mu p (edges to forward and backward)

So an increment is one piecewise linear equation (Klarbring 1986; Alart & Curnier 1991). It is
solved by Newton's method, all nodes at once; where that cycles, by following its solution while the
load goes from one that the states at hand balance to the true one, one node changing at a time
(Lemke 1965; Eaves 1976). The history (t_0, s_0) is an input: nothing changes it but the caller, who
commits what has converged.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from drumlin.arrays import Bools, Floats, Ints
from drumlin.contact.active_set import GOLDEN, PATH_LIFT, PATIENCE
from drumlin.errors import NoAnswer
from drumlin.lapack import dgetrf, dgetrs

OPEN, STICK, FORWARD, BACKWARD = 0, 1, 2, 3
MOST_NEWTON_STEPS = 60  # of Newton's method; an increment of a brake needs some five
MOST_STATE_CHANGES = 6  # changes of each node while an answer is followed
STATE_ROUND_OFF = 1e-10


class FrictionalProblem(NamedTuple):
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
    """A converged increment: p, t, s (n,), y (k,), `state` (n,) of each node, and the steps that it
    took.
    """

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


def solve(
    problem: FrictionalProblem, mu: float | Floats, history: History, start: Ints
) -> Increment:
    """Solve one increment from the states `start` (n,); mu: of all nodes, or of each (n,).

    Raises NoAnswer where neither Newton's method nor a path from these states or from wide gaps
    leads to an answer.
    """
    system, scales = _system(problem, mu, history)
    for way in (_newton, _followed, _closed):
        try:
            state, point, steps = way(system, start)
        except NoAnswer as error:
            reason = str(error)
            continue
        (p, t), (w, slip) = np.split(scales * point.z, 2), np.split(point.v / scales, 2)
        s = slip + history.s + problem.Q @ (t - history.t)
        return Increment(p, t, s, w, point.y, state, steps)
    raise NoAnswer(reason)


class _System(NamedTuple):
    """The equations of an increment: v = q + A z + B y, C z = h of z = (p, t) and v = (w, ds - Q
    dt), both (2n,).

    Scaled to a unit diagonal of A, positive for w and negative for the slip; `mu` (n,) is scaled
    with it.
    """

    A: Floats
    q: Floats
    B: Floats
    C: Floats
    h: Floats
    mu: Floats


class _Point(NamedTuple):
    z: Floats
    v: Floats
    y: Floats


def _system(
    problem: FrictionalProblem, mu: float | Floats, history: History
) -> tuple[_System, Floats]:
    """The scaled equations, and the scales (2n,): z = scales z', v = v' / scales."""
    A = np.block([[problem.A_wp, problem.A_wt], [problem.A_sp, problem.A_st - problem.Q]])
    q = np.concatenate([problem.q_w, problem.q_s - history.s + problem.Q @ history.t])
    B, C = np.vstack([problem.B_w, problem.B_s]), np.hstack([problem.C_p, problem.C_t])
    d = 1 / np.sqrt(np.maximum(np.abs(np.diagonal(A)), np.finfo(float).tiny))
    n = len(q) // 2
    return _System(
        d[:, None] * A * d, d * q, d[:, None] * B, C * d, problem.h, mu * d[:n] / d[n:]
    ), d


class _Piece:
    """The linear equations of given states (n,), factorised once.

    Raises NoAnswer where they are singular.
    """

    def __init__(self, system: _System, state: Ints) -> None:
        self.system, self.state = system, state
        n, k = len(state), len(system.h)
        self.on, stuck = np.flatnonzero(state != OPEN), n + np.flatnonzero(state == STICK)
        # t = sliding p where it slips
        self.sliding = (system.mu * ((state == FORWARD).astype(float) - (state == BACKWARD)))[
            self.on
        ]
        self.basic = np.concatenate([self.on, stuck])
        self.columns = np.hstack(
            [system.A[:, self.on] + system.A[:, n + self.on] * self.sliding, system.A[:, stuck]]
        )
        balance = np.hstack(
            [system.C[:, self.on] + system.C[:, n + self.on] * self.sliding, system.C[:, stuck]]
        )
        matrix = np.block(
            [[self.columns[self.basic], system.B[self.basic]], [balance, np.zeros((k, k))]]
        )
        self._factors = _factorised(matrix)

    def at(self, q: Floats, h: Floats) -> _Point:
        """z (2n,), v (2n,) and y (k,) under the data q (2n,) and h (k,)."""
        solution = _back(self._factors, np.concatenate([-q[self.basic], h]))
        basic, y = solution[: len(self.basic)], solution[len(self.basic) :]
        n, m = len(self.state), len(self.on)
        z, v = np.zeros(2 * n), q + self.columns @ basic + self.system.B @ y
        v[self.basic] = 0.0
        z[self.basic] = basic
        z[n + self.on] += self.sliding * basic[:m]
        return _Point(z, v, y)

    def margins(self, point: _Point) -> Floats:
        """How far each node is within the two edges of its piece (2, n), linear in the point; 0 for
        no second edge.
        """
        (p, t), (w, slip), mu = np.split(point.z, 2), np.split(point.v, 2), self.system.mu
        first = np.select([self.state == OPEN, self.state == STICK], [w, mu * p - t], p)
        second = np.select(
            [self.state == STICK, self.state == FORWARD, self.state == BACKWARD],
            [mu * p + t, slip, -slip],
        )
        return np.array([first, second])


# The piece beyond each edge [state, edge]; from open it is FORWARD or BACKWARD by the sign of the
# slip.
NEXT_STATE = np.array([[FORWARD, OPEN], [FORWARD, BACKWARD], [OPEN, STICK], [OPEN, STICK]])


def _newton(system: _System, start: Ints) -> tuple[Ints, _Point, int]:
    """States, point and steps of Newton's method. Raises NoAnswer where it cycles."""
    state, fewest, patience = start, 3 * len(start), PATIENCE
    for step in range(1, MOST_NEWTON_STEPS + 1):
        piece = _Piece(system, state)
        point = piece.at(system.q, system.h)
        outside = piece.margins(point) < -STATE_ROUND_OFF * _sizes(system, piece, point)
        wrong = int(np.count_nonzero(outside))
        if not wrong:
            return state, point, step
        fewest, patience = (wrong, PATIENCE) if wrong < fewest else (fewest, patience - 1)
        if patience < 0:
            break
        state = _wanted(system, state, point, outside)
    raise NoAnswer("not converged: stick and slip do not settle")


def _wanted(system: _System, state: Ints, point: _Point, outside: Bools) -> Ints:
    """The states (n,) that the nodes `outside` (2, n) of their pieces ask for."""
    (p, _), (w, slip) = np.split(point.z, 2), np.split(point.v, 2)
    wanted = state.copy()
    for edge in (0, 1):
        wanted[outside[edge]] = NEXT_STATE[state[outside[edge]], edge]
    closing = (state == OPEN) & outside[0]
    wanted[closing] = np.select(
        [slip > -system.mu * w, slip < system.mu * w], [FORWARD, BACKWARD], STICK
    )[closing]
    wanted[(state == STICK) & outside.any(axis=0) & (p < 0)] = OPEN
    return wanted


def _sizes(system: _System, piece: _Piece, point: _Point) -> Floats:
    """The largest numbers that the margins (2, n) are differences of."""
    of_z = np.abs(point.z).max(initial=0.0)
    of_v = max(np.abs(system.q).max(), np.abs(system.B @ point.y).max(), np.abs(point.v).max())
    opened, sticks = piece.state == OPEN, piece.state == STICK
    return np.array([np.where(opened, of_v, of_z), np.where(sticks, of_z, of_v)])


def _followed(system: _System, start: Ints) -> tuple[Ints, _Point, int]:
    """The path from a load that the states `start` (n,) balance."""
    return _path(system, start, wide=False)


def _closed(system: _System, start: Ints) -> tuple[Ints, _Point, int]:
    """The path from gaps so wide that only the nodes touch that the actuation closes first,
    slipping.
    """
    n = len(start)
    state = np.full(n, OPEN)
    for k, load in enumerate(system.h):
        if load == 0:  # nothing acts on this motion: it needs no node of its own
            continue
        bearing = system.C[k, :n] * load > 0  # nodes whose pressure resists the actuation
        if not bearing.any():
            raise NoAnswer("no equilibrium: contact pressure cannot balance the actuation anywhere")
        turn = np.maximum(np.abs(system.B[:n, k]), np.finfo(float).tiny)
        first = int(np.where(bearing, system.q[:n] / turn, np.inf).argmin())
        state[first] = (
            FORWARD if system.C[k, n + first] * load >= 0 else BACKWARD
        )  # the way that does not lock
    return _path(system, state, wide=True)


def _path(system: _System, state: Ints, *, wide: bool) -> tuple[Ints, _Point, int]:
    """States, point and steps at r = 0 of the path of answers to q + r e, h + r f that comes from r
    = 1.

    e and f are what the states at r = 1 need to hold, with a margin; with `wide` the open nodes
    have one anyway. Between two changes of a state all is linear in r; each change is of one node,
    and the next piece begins where it left, r growing again where the path turns. Raises NoAnswer
    where the path goes on for ever.
    """
    state, r, way, node, edge = state.copy(), 1.0, -1.0, -1, 0
    piece = _Piece(system, state)
    e, f = _lift(system, piece, wide)
    for passed in range(1, MOST_STATE_CHANGES * len(state) + 1):
        point, slope = piece.at(system.q, system.h), piece.at(e, f)
        value, change = piece.margins(point), piece.margins(slope)
        if node >= 0:
            way = float(np.sign(change[edge, node]))  # the node that has changed leaves the edge
        falls = way * change < 0
        reach = np.full(falls.shape, np.inf)
        reach[falls] = np.maximum(value + r * change, 0.0)[falls] / np.abs(change[falls])
        edge, node = divmod(int(reach.argmin()), len(state))
        step = reach[edge, node]
        if way < 0 and step >= r:
            return state, point, passed
        if not np.isfinite(step):
            break
        r += way * step
        state = state.copy()
        before = state[node]
        slip = point.v[len(state) + node] + r * slope.v[len(state) + node]
        state[node] = (
            (FORWARD if slip > 0 else BACKWARD) if before == OPEN else NEXT_STATE[before, edge]
        )
        edge = int(NEXT_STATE[state[node], 1] == before) if before != OPEN else 0
        piece = _Piece(system, state)
    raise NoAnswer(
        "not converged: stick and slip do not settle, nor does a path lead to where they do"
    )


def _lift(system: _System, piece: _Piece, wide: bool) -> tuple[Floats, Floats]:
    """Changes of q (2n,) and h (k,) under which every node lies within its piece."""
    point, state = piece.at(system.q, system.h), piece.state
    n = len(state)
    slack = PATH_LIFT * _sizes(system, piece, point)
    margin = piece.margins(point)
    uneven = 1 + np.arange(2 * n).reshape(2, n) * GOLDEN % 1  # no two nodes change together
    low = margin <= 0
    if wide:
        low[0] |= state == OPEN
    low[1] &= state != OPEN
    margin = np.where(
        low, np.maximum(margin, 0) + slack * uneven if wide else slack * uneven, margin
    )
    (p, t), (w, slip) = np.split(point.z, 2), np.split(point.v, 2)
    sticks, slips = state == STICK, (state == FORWARD) | (state == BACKWARD)
    sense = np.where(state == BACKWARD, -1.0, 1.0)
    w = np.where(state == OPEN, margin[0], w)
    slip = np.where(slips, sense * margin[1], slip)
    touched = np.maximum(system.mu, np.finfo(float).tiny)
    # the two margins of a sticking node are mu p - t and mu p + t
    p = np.where(
        slips,
        margin[0],
        np.where(sticks & low.any(axis=0), (margin[0] + margin[1]) / (2 * touched), p),
    )
    t = np.where(slips, sense * system.mu * p, np.where(sticks, 0.5 * (margin[1] - margin[0]), t))
    z, v = np.concatenate([p, t]), np.concatenate([w, slip])
    return v - (system.q + system.A @ z + system.B @ point.y), system.C @ z - system.h


def _factorised(matrix: Floats) -> tuple[Floats, Ints, Floats, Floats]:
    """LU factors and pivots of the matrix with equilibrated rows and columns, whose units differ,
    and their scales.
    """
    if not matrix.size:
        return matrix, np.zeros(0, dtype=np.int32), np.zeros(0), np.zeros(0)
    tiny = np.finfo(float).tiny
    row = 1 / np.maximum(np.abs(matrix).max(axis=1), tiny)
    column = 1 / np.maximum(np.abs(row[:, None] * matrix).max(axis=0), tiny)
    lu, pivots, info = dgetrf(row[:, None] * matrix * column)
    if info or not np.isfinite(np.diagonal(lu)).all():
        raise NoAnswer("no equilibrium: contact and friction cannot balance the actuation")
    return lu, pivots, row, column


def _back(factors: tuple[Floats, Ints, Floats, Floats], right: Floats) -> Floats:
    lu, pivots, row, column = factors
    if not right.size:
        return right
    solution, _ = dgetrs(lu, pivots, row * right)
    return column * solution


def zones(nodes: Floats, state: Ints) -> dict[str, tuple[tuple[float, float], ...]]:
    """Arcs [rad] of stick and of slip: runs of nodes in one state, ending half-way to the next
    node.
    """
    edges = np.concatenate([nodes[:1], 0.5 * (nodes[1:] + nodes[:-1]), nodes[-1:]])
    return {
        "stick": _runs(edges, state == STICK),
        "slip": _runs(edges, (state == FORWARD) | (state == BACKWARD)),
    }


def _runs(edges: Floats, where: Bools) -> tuple[tuple[float, float], ...]:
    change = np.flatnonzero(np.diff(np.concatenate([[0], where.astype(int), [0]])))
    return tuple((float(edges[a]), float(edges[b])) for a, b in change.reshape(-1, 2))
