"""Unilateral contact with friction that sticks and slips, solved one load increment at a time.

The unknowns are pressures p, tangential tractions t and rigid-body motions y. The slip changes by
ds = s - s_0 and the traction by dt = t - t_0 since the last converged increment. The equations are

    w = q_w + A_wp p + A_wt t + B_w y,      p >= 0,  w >= 0,  p w = 0
    s = q_s + A_sp p + A_st t + B_s y,      |t| <= mu p,  ds - Q dt = 0 where it sticks,
                                            t = +mu p with ds - Q dt >= 0, or t = -mu p with <= 0,
                                            where it slips
    C_p p + C_t t = h

Here w (n,) are the weighted gaps and s (n,) the weighted slips of the drum against the lining: the
integrals of gap or slip times each node's shape function. Q (n, n) is the compliance of a
tangential penalty, or zero.

A node has one of four states: open, stick, slip forward and slip backward. The contact law of the
node is linear in each state. Two conditions limit each state, and a node that violates one of them
changes to another state:

    open:      p = t = 0,   w > 0, otherwise it slips, forward or backward by the sign of its slip
    forward:   t = +mu p,   p > 0, otherwise it opens;  slip > 0, otherwise it sticks
    backward:  t = -mu p,   p > 0, otherwise it opens;  slip < 0, otherwise it sticks
    stick:     slip = 0,    |t| < mu p, otherwise it slips, forward or backward by the sign of t

In a step of Newton's method an open node that closes may also stick at once.

An increment is therefore one piecewise linear equation (Klarbring 1986; Alart & Curnier 1991).
Newton's method solves this equation; in each step all nodes that violate a condition change their
state. If Newton's method cycles, it solves the increment at raised friction first, where fewer
nodes slip, and then at friction that is lowered to its true value. If this method fails too, a path
of solutions is followed (a continuation method): the load changes from one that the present states
balance to the true load, and one node changes at a time (Lemke 1965; Eaves 1976).

The history (t_0, s_0) is an input. The functions of this module do not change the history. The
caller passes the converged increment on as the history of the next one.
"""

import math
from contextlib import suppress
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Bools, Floats, Ints
from drumlin.base.errors import NoAnswer
from drumlin.base.lapack import dgetrf, dgetrs
from drumlin.contact.active_set import (
    INVERSE_GOLDEN_RATIO,
    MAX_ACTIVE_SET_STEPS_WITHOUT_PROGRESS,
    SMALLEST_ADDED_GAP_OVER_LARGEST_GAP,
)

OPEN, STICK, FORWARD, BACKWARD = 0, 1, 2, 3
"""Numbers of the states of a contact node: open, sticking, slipping forward and backward."""

MAX_NEWTON_STEPS_FOR_STICK_SLIP_STATES = 60
"""Largest number of steps of Newton's method for stick and slip in one load increment.

An increment of a brake needs some five steps.
"""

MAX_STICK_SLIP_CHANGES_PER_NODE = 6
"""Largest number of changes between open, stick and slip, per contact node, in one increment.

The limit holds for the changes on a path of solutions, which leads from a load that the first
states balance to the true load. It also holds for steps of Newton's method in which single nodes
change. If more changes are needed, the increment is refused.
"""

ROUND_OFF_OF_STICK_SLIP_CONDITIONS = 1e-10
"""Relative amount by which a node may violate the conditions of its state and keep the state.

The state is open, stick or slip. Each condition says that some quantity is positive, for example mu
p - t at a sticking node. The amount covers round-off; it is relative to the largest pressure or
traction, or the largest gap or slip, of all nodes.
"""

LARGEST_FACTOR_OF_RAISED_FRICTION = 256.0
"""Largest factor by which friction is raised in the search for the states of an increment.

The search first raises the friction coefficients of all nodes until Newton's method converges, and
then lowers them to their true values. For 884 increments of duo-servo brakes whose anchors have
clearances, factors up to 8 were enough. With a larger limit, an increment without a solution is
only refused later.
"""

FIRST_RATIO_OF_RAISED_FRICTION_FACTORS = math.sqrt(2)
"""Ratio of two successive factors by which friction is raised and then lowered.

If Newton's method does not converge at the lower friction, the square root of the ratio is tried.
"""

SMALLEST_RATIO_OF_RAISED_FRICTION_FACTORS = 1.001
"""Ratio of two successive factors of raised friction below which the search for states fails.

With a smaller ratio, an increment without a solution is only refused later.
"""


class StickSlipProblem(NamedTuple):
    """The equations of a load increment of contact that sticks and slips.

    The n nodes have pressures p and tangential tractions t. The shoes have k rigid-body modes. The
    equations are those at the beginning of this module.

    Attributes
    ----------
    A_wp, A_wt, B_w : weighted gaps per pressure (n, n), traction (n, n) and rigid-body motion
        (n, k)
    A_sp, A_st, B_s : weighted slips per pressure (n, n), traction (n, n) and rigid-body motion
        (n, k)
    C_p, C_t : generalised forces (k, n) in the equilibria, per pressure and per traction
    q_w, q_s : weighted gaps and slips (n,) without pressures, tractions and motions
    h : (k,), minus the generalised forces of the loads: C_p p + C_t t = h is the equilibrium
    Q : compliance (n, n) of the tangential penalty, or zero
    """

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


class TractionsAndSlipsOfLastIncrement(NamedTuple):
    """The tractions t (n,) and weighted slips s (n,) of the last converged increment."""

    t: Floats
    s: Floats


@dataclass(frozen=True)
class StickSlipIncrementSolution:
    """The solution of a load increment of contact that sticks and slips.

    Attributes
    ----------
    p, t, s, w : pressures, tractions, slips and weighted gaps (n,)
    y : rigid-body motions (k,)
    state : state (n,) of each node: OPEN, STICK, FORWARD or BACKWARD
    steps : number of linear systems that were solved
    """

    p: Floats
    t: Floats
    s: Floats
    w: Floats
    y: Floats
    state: Ints
    steps: int

    @property
    def tractions_and_slips_for_next_increment(self) -> TractionsAndSlipsOfLastIncrement:
        """The tractions and slips from which the next increment starts."""
        return TractionsAndSlipsOfLastIncrement(self.t, self.s)


def solve_stick_slip_load_increment(
    problem: StickSlipProblem,
    mu: float | Floats,
    history: TractionsAndSlipsOfLastIncrement,
    start: Ints,
) -> StickSlipIncrementSolution:
    """Solve one load increment of contact that sticks and slips, and return its solution.

    Parameters
    ----------
    problem : the equations of n nodes
    mu : friction coefficient of all nodes, or (n,) of each node
    history : tractions and slips of the last increment
    start : states (n,) from which Newton's method starts

    Raises
    ------
    NoAnswer
        if neither Newton's method nor a path of solutions converges; the friction is raised and
        lowered, and the paths begin at the given states and at wide gaps
    """
    system, scales = _scaled_increment_equations_and_factors(problem, mu, history)
    # The methods are tried in this order, the fastest first, until one converges.
    for method in (
        _find_stick_slip_states_by_newton,
        _find_stick_slip_states_by_lowering_friction,
        _find_stick_slip_states_from_balanced_load,
        _find_stick_slip_states_from_widened_gaps,
        _find_stick_slip_states_by_slowed_newton,
    ):
        try:
            settled = method(system, start)
        except NoAnswer as error:
            # If the last method fails, its error is like that of the first method and tells nothing
            # new. The error of the method before the last is therefore raised.
            if method is not _find_stick_slip_states_by_slowed_newton:
                reason = str(error)
            continue
        state, point, steps = settled
        p, t = np.split(scales * point.z, 2)
        w, slip = np.split(point.v / scales, 2)
        s = slip + history.s + problem.Q @ (t - history.t)
        return StickSlipIncrementSolution(p, t, s, w, point.y, state, steps)
    raise NoAnswer(reason)


class _ScaledIncrementEquations(NamedTuple):
    """The scaled equations of an increment: v = q + A z + B y and C z = h.

    The unknowns are z = (p, t) and v = (w, ds - Q dt), both (2n,). Scaling makes the diagonal
    entries of A equal to 1 in the rows of w and -1 in the rows of the slip. The friction
    coefficients `mu` (n,) are scaled as well.
    """

    A: Floats
    q: Floats
    B: Floats
    C: Floats
    h: Floats
    mu: Floats


class _ScaledIncrementSolution(NamedTuple):
    """A solution of the scaled equations: z (2n,), v (2n,) and rigid-body motions y (k,)."""

    z: Floats
    v: Floats
    y: Floats


class _StickSlipStatesAndSolutionOfIncrement(NamedTuple):
    """The final states (n,) of the nodes in a load increment, the solution and the step count."""

    state: Ints
    solution: _ScaledIncrementSolution
    steps: int


def _scaled_increment_equations_and_factors(
    problem: StickSlipProblem, mu: float | Floats, history: TractionsAndSlipsOfLastIncrement
) -> tuple[_ScaledIncrementEquations, Floats]:
    """Return the scaled equations of a load increment, and the scale factors (2n,).

    Pressures and tractions are z = scales z_scaled.
    """
    A = np.block([[problem.A_wp, problem.A_wt], [problem.A_sp, problem.A_st - problem.Q]])
    # The slips and tractions of the last increment become constant terms, so that v holds the
    # change of the slip in this increment.
    q_slip = problem.q_s - history.s + problem.Q @ history.t
    q = np.concatenate([problem.q_w, q_slip])
    B = np.vstack([problem.B_w, problem.B_s])
    C = np.hstack([problem.C_p, problem.C_t])
    d = 1 / np.sqrt(np.maximum(np.abs(np.diagonal(A)), np.finfo(float).tiny))
    n = len(q) // 2
    system = _ScaledIncrementEquations(
        A=d[:, None] * A * d,
        q=d * q,
        B=d[:, None] * B,
        C=C * d,
        h=problem.h,
        mu=mu * d[:n] / d[n:],
    )
    return system, d


class _IncrementEquationsForGivenStates:
    """The linear equations of a load increment under given states (n,) of all nodes.

    The equations are factorised once. Raises NoAnswer if they are singular.
    """

    def __init__(self, system: _ScaledIncrementEquations, state: Ints) -> None:
        self.system, self.state = system, state
        n, k = len(state), len(system.h)
        self.pressed_nodes = np.flatnonzero(state != OPEN)
        stuck = n + np.flatnonzero(state == STICK)
        # A slipping node has the traction t = traction_per_pressure * p. At a sticking node the
        # factor is 0, because its traction is an unknown of its own.
        sense = (state == FORWARD).astype(float) - (state == BACKWARD)
        self.traction_per_pressure = (system.mu * sense)[self.pressed_nodes]
        # The unknowns are the pressures of pressed nodes and the tractions of sticking nodes.
        self.unknown_numbers = np.concatenate([self.pressed_nodes, stuck])
        pressed, dragged = self.pressed_nodes, n + self.pressed_nodes
        # At a slipping node the column of the pressure includes the effect of the traction +-mu p.
        by_pressure = system.A[:, pressed] + system.A[:, dragged] * self.traction_per_pressure
        self.columns_of_unknowns = np.hstack([by_pressure, system.A[:, stuck]])
        balance_by_pressure = (
            system.C[:, pressed] + system.C[:, dragged] * self.traction_per_pressure
        )
        balance = np.hstack([balance_by_pressure, system.C[:, stuck]])
        matrix = np.block(
            [
                [self.columns_of_unknowns[self.unknown_numbers], system.B[self.unknown_numbers]],
                [balance, np.zeros((k, k))],
            ]
        )
        self._factors = _scale_matrix_and_compute_lu_factors(matrix)

    def solve_increment_under_loads(self, q: Floats, h: Floats) -> _ScaledIncrementSolution:
        """Return the solution of the increment under its constant terms q (2n,) and loads h (k,).

        q holds the gaps and slips that are there without pressures, tractions and motions.
        """
        right = np.concatenate([-q[self.unknown_numbers], h])
        solution = _solve_with_scaled_lu_factors(self._factors, right)
        basic, y = solution[: len(self.unknown_numbers)], solution[len(self.unknown_numbers) :]
        n, m = len(self.state), len(self.pressed_nodes)
        v = q + self.columns_of_unknowns @ basic + self.system.B @ y
        v[self.unknown_numbers] = 0.0
        z = np.zeros(2 * n)
        z[self.unknown_numbers] = basic
        z[n + self.pressed_nodes] += self.traction_per_pressure * basic[:m]
        return _ScaledIncrementSolution(z, v, y)

    def distances_of_nodes_from_their_two_state_changes(
        self, solution: _ScaledIncrementSolution
    ) -> Floats:
        """Return the distances (2, n) of each node from its two possible changes of state.

        The distances are the gap of an open node, the margins mu p - t and mu p + t of a sticking
        node, and the pressure and the slip of a slipping node. A negative distance says that the
        node has to change its state. An open node has a single change, and its second distance is
        0. All distances are linear in the solution.
        """
        p, t = np.split(solution.z, 2)
        w, slip = np.split(solution.v, 2)
        mu = self.system.mu
        opened, sticks = self.state == OPEN, self.state == STICK
        forward, backward = self.state == FORWARD, self.state == BACKWARD
        first = np.select([opened, sticks], [w, mu * p - t], p)
        second = np.select([sticks, forward, backward], [mu * p + t, slip, -slip])
        return np.array([first, second])


NEXT_STATE_BY_STATE_AND_VIOLATED_CONDITION = np.array(
    [[FORWARD, OPEN], [FORWARD, BACKWARD], [OPEN, STICK], [OPEN, STICK]]
)
"""The next state of a contact node (4, 2), by its present state and the violated condition.

Each state has two conditions, which are in the order of
`_IncrementEquationsForGivenStates.distances_of_nodes_from_their_two_state_changes`. For an
open node that closes, the table has FORWARD alone. The code that uses the table corrects this entry
to BACKWARD by the sign of the slip, or in a step of Newton's method to STICK if the slip is small.
"""


def _solution_and_violated_conditions(
    system: _ScaledIncrementEquations, state: Ints
) -> tuple[_ScaledIncrementSolution, Bools]:
    """The solution of the increment in the given states (n,), and the conditions it violates.

    The conditions are a mask (2, n): True where a node violates the first or the second condition
    of its state by more than round-off.
    """
    equations = _IncrementEquationsForGivenStates(system, state)
    point = equations.solve_increment_under_loads(system.q, system.h)
    return point, _conditions_violated_beyond_round_off(system, equations, point)


def _conditions_violated_beyond_round_off(
    system: _ScaledIncrementEquations,
    equations: _IncrementEquationsForGivenStates,
    solution: _ScaledIncrementSolution,
) -> Bools:
    """The conditions (2, n) of the nodes' states that a solution violates beyond round-off."""
    round_off = (
        ROUND_OFF_OF_STICK_SLIP_CONDITIONS
        * _sizes_to_which_round_off_of_margins_is_relative(system, equations, solution)
    )
    return equations.distances_of_nodes_from_their_two_state_changes(solution) < -round_off


def _find_stick_slip_states_by_slowed_newton(
    system: _ScaledIncrementEquations, start: Ints
) -> _StickSlipStatesAndSolutionOfIncrement:
    """Find the states of the nodes by Newton's method, made slow enough not to go in circles.

    While the number of wrong states does not fall, only the wrong node with the highest number
    changes its state in a step (block principal pivoting, Judice and Pires 1994, Computers and
    Operations Research 21, page 587, with the single changes of Murty). A drum that is turned in a
    few increments by many times the rotation to full slip needs this method.
    """
    state, fewest = start, 3 * len(start)
    for step in range(1, MAX_STICK_SLIP_CHANGES_PER_NODE * len(start) + 1):
        point, outside = _solution_and_violated_conditions(system, state)
        wrong = int(np.count_nonzero(outside))
        if not wrong:
            return _StickSlipStatesAndSolutionOfIncrement(state, point, step)
        if wrong >= fewest:
            outside[:, : np.flatnonzero(outside.any(axis=0))[-1]] = False
        fewest = min(fewest, wrong)
        state = _next_stick_slip_states_by_newton(system, state, point, outside)
    raise NoAnswer("not converged: stick and slip do not settle")


def _find_stick_slip_states_by_newton(
    system: _ScaledIncrementEquations, start: Ints
) -> _StickSlipStatesAndSolutionOfIncrement:
    """Find open, sticking and slipping nodes by Newton's method, in which all nodes change at once.

    `start` (n,) are the states of the first step. Raises NoAnswer if the number of nodes in a wrong
    state has not fallen for MAX_ACTIVE_SET_STEPS_WITHOUT_PROGRESS steps.
    """
    state, fewest, patience = start, 3 * len(start), MAX_ACTIVE_SET_STEPS_WITHOUT_PROGRESS
    for step in range(1, MAX_NEWTON_STEPS_FOR_STICK_SLIP_STATES + 1):
        point, outside = _solution_and_violated_conditions(system, state)
        wrong = int(np.count_nonzero(outside))
        if not wrong:
            return _StickSlipStatesAndSolutionOfIncrement(state, point, step)
        # The search ends if the number of nodes in a wrong state has not fallen for some steps.
        if wrong < fewest:
            fewest, patience = wrong, MAX_ACTIVE_SET_STEPS_WITHOUT_PROGRESS
        else:
            patience -= 1
        if patience < 0:
            break
        state = _next_stick_slip_states_by_newton(system, state, point, outside)
    raise NoAnswer("not converged: stick and slip do not settle")


class _StatesAtRaisedFriction(NamedTuple):
    """The factor by which the friction of all nodes is raised, and the states found with it."""

    factor: float
    found: _StickSlipStatesAndSolutionOfIncrement


def _find_stick_slip_states_by_lowering_friction(
    system: _ScaledIncrementEquations, start: Ints
) -> _StickSlipStatesAndSolutionOfIncrement:
    """Find the states of the nodes at raised friction, and follow them down to the true friction.

    The shoes of a resting duo-servo brake that have not come to an anchor need this method: only
    the sticking nodes keep the shoes from turning with the drum. If Newton's method changes all
    nodes at once, it may let all of them slip, and no equilibrium is left.

    `start` (n,) are the states of the first step. Raises NoAnswer if Newton's method converges at
    no raised friction, or if it loses the states on the way down.
    """
    factor, found = _states_at_lowest_raised_friction_at_which_newton_converges(system, start)
    ratio, steps = FIRST_RATIO_OF_RAISED_FRICTION_FACTORS, found.steps
    while factor > 1:
        lower = max(1.0, factor / ratio)
        try:
            found = _find_stick_slip_states_by_newton(
                system._replace(mu=lower * system.mu), found.state
            )
        except NoAnswer:
            ratio = math.sqrt(ratio)
            if ratio < SMALLEST_RATIO_OF_RAISED_FRICTION_FACTORS:
                raise
            continue
        factor, steps = lower, steps + found.steps
    return found._replace(steps=steps)


def _states_at_lowest_raised_friction_at_which_newton_converges(
    system: _ScaledIncrementEquations, start: Ints
) -> _StatesAtRaisedFriction:
    """The lowest raised friction at which Newton's method converges, and the states found there.

    Newton's method begins with all nodes sticking that have friction, or with the states `start`
    (n,). Raises NoAnswer if it does not converge up to LARGEST_FACTOR_OF_RAISED_FRICTION.
    """
    all_stick = np.where(system.mu > 0, STICK, start)
    factor = FIRST_RATIO_OF_RAISED_FRICTION_FACTORS
    while factor < LARGEST_FACTOR_OF_RAISED_FRICTION:
        raised = system._replace(mu=factor * system.mu)
        for first in (all_stick, start):
            with suppress(NoAnswer):
                found = _find_stick_slip_states_by_newton(raised, first)
                return _StatesAtRaisedFriction(factor, found)
        factor *= FIRST_RATIO_OF_RAISED_FRICTION_FACTORS
    raise NoAnswer("not converged: stick and slip do not settle")


def _next_stick_slip_states_by_newton(
    system: _ScaledIncrementEquations,
    state: Ints,
    solution: _ScaledIncrementSolution,
    outside: Bools,
) -> Ints:
    """Return the states (n,) of the nodes for the next step of Newton's method.

    `outside` (2, n) says which of the two conditions of its state a node violates.
    """
    p, _ = np.split(solution.z, 2)
    w, slip = np.split(solution.v, 2)
    wanted = state.copy()
    for edge in (0, 1):
        beyond = outside[edge]
        wanted[beyond] = NEXT_STATE_BY_STATE_AND_VIOLATED_CONDITION[state[beyond], edge]
    # A closing node sticks, unless its slip is larger than mu times its overlap -w.
    closing = (state == OPEN) & outside[0]
    ways = np.select([slip > -system.mu * w, slip < system.mu * w], [FORWARD, BACKWARD], STICK)
    # A node without friction never sticks.
    wanted[closing] = np.where(system.mu > 0, ways, np.maximum(ways, FORWARD))[closing]
    # A sticking node whose pressure is negative opens at once.
    wanted[(state == STICK) & outside.any(axis=0) & (p < 0)] = OPEN
    return wanted


def _sizes_to_which_round_off_of_margins_is_relative(
    system: _ScaledIncrementEquations,
    equations: _IncrementEquationsForGivenStates,
    solution: _ScaledIncrementSolution,
) -> Floats:
    """The sizes (2, n) to which the round-off of each node's two margins is relative.

    A margin says how far a node is from a change of state, for example mu p - t from sticking to
    slipping. For a margin that is a stress, the size is the largest pressure or traction of all
    nodes. For a margin that is a gap or a slip, it is the largest gap or slip of all nodes.
    """
    of_z = np.abs(solution.z).max(initial=0.0)
    of_v = max(
        np.abs(system.q).max(), np.abs(system.B @ solution.y).max(), np.abs(solution.v).max()
    )
    opened, sticks = equations.state == OPEN, equations.state == STICK
    return np.array([np.where(opened, of_v, of_z), np.where(sticks, of_z, of_v)])


def _find_stick_slip_states_from_balanced_load(
    system: _ScaledIncrementEquations, start: Ints
) -> _StickSlipStatesAndSolutionOfIncrement:
    """Find open, sticking and slipping nodes on a path of solutions.

    The path begins at a load that the states `start` (n,) balance, and ends at the true load.
    """
    return _follow_stick_slip_states_to_true_load(system, start, from_wide_gaps=False)


def _find_stick_slip_states_from_widened_gaps(
    system: _ScaledIncrementEquations, start: Ints
) -> _StickSlipStatesAndSolutionOfIncrement:
    """Find open, sticking and slipping nodes on a path of solutions from widened gaps.

    Where the path begins, only the nodes that the actuation closes first touch, and they slip. Of
    `start` (n,) only the number of nodes is used.
    """
    n = len(start)
    state = np.full(n, OPEN)
    for mode, load in enumerate(system.h):
        # A rigid-body mode without load is balanced without a touching node of its own.
        if load == 0:
            continue
        # Only the pressure of a bearing node can balance the load on the mode.
        bearing = system.C[mode, :n] * load > 0
        if not bearing.any():
            raise NoAnswer("no equilibrium: contact pressure cannot balance the actuation anywhere")
        turn = np.maximum(np.abs(system.B[:n, mode]), np.finfo(float).tiny)
        turn = np.where(bearing, turn, 1.0)
        first = int(np.where(bearing, system.q[:n] / turn, np.inf).argmin())
        # The node slips in the sense in which its friction helps to balance the load on the mode.
        helps = system.C[mode, n + first] * load >= 0
        state[first] = FORWARD if helps else BACKWARD
    return _follow_stick_slip_states_to_true_load(system, state, from_wide_gaps=True)


class _StickSlipStateChangeOnPath(NamedTuple):
    """The change of a node between open, stick and slip that comes next on a path of solutions.

    Attributes
    ----------
    node : number of the node that changes its state
    number_of_reached_condition : number of the condition, 0 or 1, that the node reaches, as in
        NEXT_STATE_BY_STATE_AND_VIOLATED_CONDITION
    load_change : change of the load parameter r of the path up to the change of state; inf if no
        node changes its state
    """

    node: int
    number_of_reached_condition: int
    load_change: float


def _follow_stick_slip_states_to_true_load(
    system: _ScaledIncrementEquations, state: Ints, *, from_wide_gaps: bool
) -> _StickSlipStatesAndSolutionOfIncrement:
    """Follow the path of solutions for gaps and slips q + r e and loads h + r f from r = 1 to 0.

    The added terms e and f are chosen so that the first states of the nodes hold at r = 1, each by
    a margin. With `from_wide_gaps` the gap of each open node is widened by such a margin. Between
    two changes of state the solution is linear in r. One node changes at a time. The path may turn,
    so that r grows again. Returns the states at r = 0 with their solution. Raises NoAnswer if the
    path does not reach r = 0 within MAX_STICK_SLIP_CHANGES_PER_NODE changes per node, or if the
    solution at r = 0 violates the conditions of the states.
    """
    state, r, direction, node, edge = state.copy(), 1.0, -1.0, -1, 0
    equations = _IncrementEquationsForGivenStates(system, state)
    e, f = _added_gaps_and_loads_that_make_stick_slip_states_valid(
        system, equations, from_wide_gaps
    )
    for passed in range(1, MAX_STICK_SLIP_CHANGES_PER_NODE * len(state) + 1):
        # In the present states the solution is point + r slope, with the load parameter r. The
        # distances of the nodes from a change of state are value + r change.
        point = equations.solve_increment_under_loads(system.q, system.h)
        slope = equations.solve_increment_under_loads(e, f)
        value = equations.distances_of_nodes_from_their_two_state_changes(point)
        change = equations.distances_of_nodes_from_their_two_state_changes(slope)
        # The node that has changed last is exactly at a limit of its new state, and its distance
        # from this limit must grow. The sign of this growth tells whether r grows or falls.
        if node >= 0:
            direction = float(np.sign(change[edge, node]))
        met = _next_stick_slip_state_change_on_path(value, change, r, direction)
        node, edge = met.node, met.number_of_reached_condition
        if direction < 0 and met.load_change >= r:
            # Where the equations were nearly singular on the way, the path may end in states whose
            # conditions the solution violates.
            if _conditions_violated_beyond_round_off(system, equations, point).any():
                break
            return _StickSlipStatesAndSolutionOfIncrement(state, point, passed)
        if not np.isfinite(met.load_change):
            break
        r += direction * met.load_change
        before = state[node]
        slip = point.v[len(state) + node] + r * slope.v[len(state) + node]
        state = state.copy()
        if before == OPEN:
            state[node], edge = FORWARD if slip > 0 else BACKWARD, 0
        else:
            state[node] = NEXT_STATE_BY_STATE_AND_VIOLATED_CONDITION[before, edge]
            # `edge` becomes the number of the condition whose violation would lead back to the old
            # state.
            edge = int(NEXT_STATE_BY_STATE_AND_VIOLATED_CONDITION[state[node], 1] == before)
        equations = _IncrementEquationsForGivenStates(system, state)
    raise NoAnswer(
        "not converged: stick and slip do not settle, nor does a path lead to where they do"
    )


def _next_stick_slip_state_change_on_path(
    value: Floats, change: Floats, r: float, direction: float
) -> _StickSlipStateChangeOnPath:
    """Return the change of state that comes next on a path of solutions.

    Parameters
    ----------
    value, change : distances (2, n) of the nodes from a change of state at r = 0, and their change
        per r
    r : present value of the load parameter of the path
    direction : sense, +1 or -1, in which r changes
    """
    falls = direction * change < 0
    reach = np.full(falls.shape, np.inf)
    reach[falls] = np.maximum(value + r * change, 0.0)[falls] / np.abs(change[falls])
    edge, node = divmod(int(reach.argmin()), falls.shape[1])
    return _StickSlipStateChangeOnPath(node, edge, reach[edge, node])


def _added_gaps_and_loads_that_make_stick_slip_states_valid(
    system: _ScaledIncrementEquations,
    equations: _IncrementEquationsForGivenStates,
    from_wide_gaps: bool,
) -> tuple[Floats, Floats]:
    """Return terms to add to q (2n,) and h (k,) that make the present states a solution.

    q are the gaps and slips without pressures, tractions and motions; h are the loads on the
    rigid-body modes. With `from_wide_gaps` the added terms also widen the gaps of all open nodes.
    """
    point, state = equations.solve_increment_under_loads(system.q, system.h), equations.state
    margin = _distances_from_state_change_made_positive(system, equations, point, from_wide_gaps)
    (p, t), (w, slip) = np.split(point.z, 2), np.split(point.v, 2)
    opened, sticks = state == OPEN, state == STICK
    slips = (state == FORWARD) | (state == BACKWARD)
    sense = np.where(state == BACKWARD, -1.0, 1.0)
    # The distances from a change of state are the gap of an open node, and the pressure and the
    # size of the slip of a slipping node.
    w = np.where(opened, margin.distances[0], w)
    slip = np.where(slips, sense * margin.distances[1], slip)
    # The distances of a sticking node are mu p - t and mu p + t. Their sum gives the pressure p,
    # their difference the traction t. Other nodes may be without friction.
    mu = np.where(sticks, np.maximum(system.mu, np.finfo(float).tiny), 1.0)
    stick_p = (margin.distances[0] + margin.distances[1]) / (2 * mu)
    stick_t = 0.5 * (margin.distances[1] - margin.distances[0])
    too_small = sticks & margin.enlarged.any(axis=0)
    p = np.where(slips, margin.distances[0], np.where(too_small, stick_p, p))
    t = np.where(slips, sense * system.mu * p, np.where(sticks, stick_t, t))
    # The added terms are the residuals of the equations for the pressures, tractions, gaps and
    # slips chosen above.
    z, v = np.concatenate([p, t]), np.concatenate([w, slip])
    of_q = v - (system.q + system.A @ z + system.B @ point.y)
    of_h = system.C @ z - system.h
    return of_q, of_h


class _DistancesFromStickSlipStateChange(NamedTuple):
    """The distances (2, n) of all nodes from a change of state, made positive.

    `enlarged` (2, n) marks the distances that were made larger.
    """

    distances: Floats
    enlarged: Bools


def _distances_from_state_change_made_positive(
    system: _ScaledIncrementEquations,
    equations: _IncrementEquationsForGivenStates,
    solution: _ScaledIncrementSolution,
    from_wide_gaps: bool,
) -> _DistancesFromStickSlipStateChange:
    """Return the distances (2, n) of nodes from a change of state, negative ones made positive.

    With `from_wide_gaps` the gaps of all open nodes are widened too. The added distances differ
    from node to node, so that no two nodes change their state at the same load.
    """
    state = equations.state
    n = len(state)
    uneven = 1 + np.arange(2 * n).reshape(2, n) * INVERSE_GOLDEN_RATIO % 1
    slack = SMALLEST_ADDED_GAP_OVER_LARGEST_GAP * _sizes_to_which_round_off_of_margins_is_relative(
        system, equations, solution
    )
    margin = equations.distances_of_nodes_from_their_two_state_changes(solution)
    lifted = margin <= 0
    if from_wide_gaps:
        lifted[0] |= state == OPEN
    lifted[1] &= state != OPEN
    wider = np.maximum(margin, 0) + slack * uneven if from_wide_gaps else slack * uneven
    return _DistancesFromStickSlipStateChange(np.where(lifted, wider, margin), lifted)


class _LuFactorsOfScaledMatrix(NamedTuple):
    """The LU factors and pivots of a scaled matrix, and the scales of its rows and columns."""

    lu: Floats
    pivots: Ints
    row_scales: Floats
    column_scales: Floats


def _scale_matrix_and_compute_lu_factors(matrix: Floats) -> _LuFactorsOfScaledMatrix:
    """Return the LU factors of a matrix whose rows and columns are scaled to a largest entry of 1.

    The scales make up for the different units of pressures and motions. Raises NoAnswer if the
    matrix is singular.
    """
    if not matrix.size:
        return _LuFactorsOfScaledMatrix(
            matrix, np.zeros(0, dtype=np.int32), np.zeros(0), np.zeros(0)
        )
    tiny = np.finfo(float).tiny
    row = 1 / np.maximum(np.abs(matrix).max(axis=1), tiny)
    column = 1 / np.maximum(np.abs(row[:, None] * matrix).max(axis=0), tiny)
    lu, pivots, info = dgetrf(row[:, None] * matrix * column)
    if info or not np.isfinite(np.diagonal(lu)).all():
        raise NoAnswer("no equilibrium: contact and friction cannot balance the actuation")
    return _LuFactorsOfScaledMatrix(lu, pivots, row, column)


def _solve_with_scaled_lu_factors(factors: _LuFactorsOfScaledMatrix, right: Floats) -> Floats:
    """Return the solution of a linear system from the LU factors of its scaled matrix."""
    if not right.size:
        return right
    solution, _ = dgetrs(factors.lu, factors.pivots, factors.row_scales * right)
    return factors.column_scales * solution


def sticking_and_slipping_arcs_of_lining(
    nodes: Floats, state: Ints
) -> dict[str, tuple[tuple[float, float], ...]]:
    """Return the arcs of a lining that stick and that slip, under the keys "stick" and "slip".

    Each arc is given by its start and its end [rad]. An arc covers neighbouring nodes in one state;
    its ends lie half-way to the next nodes, or at an end of the lining. `nodes` (n,) are the angles
    [rad] of the nodes, and `state` (n,) are their states.
    """
    edges = np.concatenate([nodes[:1], 0.5 * (nodes[1:] + nodes[:-1]), nodes[-1:]])
    return {
        "stick": _start_and_end_of_runs_of_true_values(edges, state == STICK),
        "slip": _start_and_end_of_runs_of_true_values(
            edges, (state == FORWARD) | (state == BACKWARD)
        ),
    }


def _start_and_end_of_runs_of_true_values(
    edges: Floats, where: Bools
) -> tuple[tuple[float, float], ...]:
    """Return the start and the end of each run of neighbouring true values in `where` (n,).

    Value i of `where` belongs to the interval from edges[i] to edges[i + 1].
    """
    padded = np.concatenate([[0], where.astype(int), [0]])
    change = np.flatnonzero(np.diff(padded))
    return tuple((float(edges[a]), float(edges[b])) for a, b in change.reshape(-1, 2))
