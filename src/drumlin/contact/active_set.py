"""An active-set method for unilateral contact in full slip.

The contact problem is a linear complementarity problem. Find nodal pressures p (n,) and rigid-body
motions y (k,) with the weighted gaps

    w = q + A p + B y,    p >= 0,  w >= 0,  p w = 0,       C p = h

A (n, n) is the compliance. Friction makes A unsymmetric. A penalty eps adds the compliance M/eps,
which is zero for an infinite penalty. The rigid-body motions y are free; the motion of a hinged
shoe is its rotation. C p = h are the equilibria in the rigid-body modes; without friction C = B^T.

A trial contact set gives each node a pressure or a gap. A node is wrong if its pressure or its gap
is negative. The active-set method is a semismooth Newton method: all wrong nodes change at once
(block principal pivoting: Kostreva 1978; Judice & Pires 1994). If the wrong nodes do not become
fewer, `follow_from_wider_gaps` changes one node at a time (Lemke 1965).
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from itertools import combinations
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Bools, Floats, Ints
from drumlin.base.errors import NoAnswer
from drumlin.contact.equations import (
    TINY,
    Changed,
    Equations,
    EquilibratedSystem,
    Problem,
    bordering_pays,
    equilibrated,
    regular,
)

MOST_PIVOT_STEPS = 120
"""Limit of the steps in which all wrong nodes change at once. A brake needs some ten steps."""

MOST_SET_CHANGES = 10
"""Limit of the changes of the contact set per node while an answer is followed from wider gaps."""

GOLDEN = (math.sqrt(5) - 1) / 2
"""Golden ratio, whose multiples modulo 1 spread the added gaps of the nodes unevenly."""

PATH_LIFT = math.sqrt(np.finfo(float).eps)
"""Gap added to each node where a path of answers begins, relative to the largest gap.

The added gap (the lift) differs from node to node, which keeps two nodes from changing together.
The root of the round-off lies as far above the round-off as below the gaps. With lifts as large as
the gaps a path may miss an answer that smaller lifts find.
"""

PATIENCE = 5
"""Number of steps in a row in which the wrong nodes may change without becoming fewer.

After these steps the nodes change one at a time, along a path with as many steps as nodes change.
Judice and Pires (1994) wait for up to ten steps. On 50 random holding brakes a patience of one
takes 1.2 times the factorisations; five to twelve lie within 2 % of each other. The answers are the
same with any patience.
"""

COARSENED_FROM = 48
"""Number of nodes from which the first contact set is guessed from a coarser problem.

Smaller problems are solved as fast without a guess. Measured by trials: 24 and 96 change the steps
by a tenth and the time not at all.
"""

SET_ROUND_OFF = 1e-12
"""Relative size up to which a negative pressure or a negative gap counts as round-off.

Pressures are relative to the largest pressure, gaps to the largest gap. A node with a larger
negative value changes between contact and separation.
"""

MOST_CANDIDATE_SETS = 2016
"""Number of sets of k nodes among which the first touching set of k modes is sought.

The number limits the memory. All pairs of 64 nodes or all triples of 23 nodes stay below it. Of
more nodes only every few are candidates.
"""


@dataclass(frozen=True)
class Contact:
    """The solution of a contact problem of n nodes and k rigid-body modes.

    Attributes
    ----------
    p : nodal pressures (n,)
    w : weighted gaps (n,)
    y : rigid-body motions (k,)
    active : whether a node (n,) is in the contact set
    steps : number of contact sets that were solved
    regular : whether the contact resists every rigid-body mode, as it does without friction. Under
        growing friction an answer is no longer regular where the brake locks itself.
    system : the equilibrated contact problem
    tangent : function that returns the change of p (n,) under a change of the weighted gaps (n,)
        while the contact set stays
    """

    p: Floats
    w: Floats
    y: Floats
    active: Bools
    steps: int
    regular: bool
    system: EquilibratedSystem
    tangent: Callable[[Floats], Floats]


class NotSettled(NoAnswer):
    """The refusal of a contact set that still changes after a number of `steps`."""

    def __init__(self, steps: int) -> None:
        super().__init__(f"not converged: the contact set still changes after {steps} steps")
        self.steps = steps


def solve(problem: Problem, start: Bools | None = None) -> Contact:
    """Solve a contact problem from a contact set, and from wider gaps if that does not converge.

    Parameters
    ----------
    problem : the contact problem of n nodes
    start : contact set (n,) of the first step; by default the set of `coarse_start`

    Raises
    ------
    NoAnswer
        if no pressures balance the actuation, or without convergence
    """
    try:
        return settle(problem, start)
    except NotSettled as unsettled:
        active, steps = follow_from_wider_gaps(problem)
        found = settle(problem, active)
        return replace(found, steps=unsettled.steps + steps + found.steps)


class _Trial(NamedTuple):
    """The scaled solution on a trial contact set.

    Attributes
    ----------
    x : pressures and rigid-body motions (n + k,)
    p : pressures (n,), a view of x
    w : weighted gaps (n,), a view of the residual
    residual : weighted gaps, then the imbalance of each rigid-body mode (n + k,)
    wrong : whether a node (n,) has a negative pressure or a negative gap
    """

    x: Floats
    p: Floats
    w: Floats
    residual: Floats
    wrong: Bools


def settle(
    problem: Problem,
    start: Bools | None = None,
    most: int = MOST_PIVOT_STEPS,
    like: EquilibratedSystem | None = None,
) -> Contact:
    """Solve a contact problem by changing all wrong nodes at once.

    Parameters
    ----------
    problem : the contact problem of n nodes
    start : contact set (n,) of the first step; by default the set of `coarse_start`
    most : limit of the steps
    like : system whose scales are used, see `equilibrated`

    Raises
    ------
    NotSettled
        if the wrong nodes do not become fewer
    NoAnswer
        if no pressures balance the actuation
    """
    system = equilibrated(problem, like)
    active = coarse_start(problem) if start is None else start.copy()
    fewest, patience = system.n + 1, PATIENCE
    base: Equations | None = None
    for step in range(1, most + 1):
        # The equations are singular while no node touches in a rigid-body mode.
        if not _resists_modes(problem, active):
            active = active | _first_touching_set(system.problem)
        equations = _equations_of(system, active, base)
        if not isinstance(equations, Changed):
            base = equations
        trial = _solve_trial(system, equations, active)
        count = int(np.count_nonzero(trial.wrong))
        if not count:
            return _refine(system, equations, active, trial, step)
        fewest, patience = (count, PATIENCE) if count < fewest else (fewest, patience - 1)
        if patience < 0:
            break
        active = _next_contact_set(problem, system, equations, active, trial)
    raise NotSettled(step)


def _equations_of(
    system: EquilibratedSystem, active: Bools, base: Equations | None
) -> Equations | Changed:
    """Factorise the equations of a contact set (n,), or reuse `base` if few nodes differ."""
    on = system.on(active)
    if base is not None and bordering_pays(base, on):
        return Changed(base, system.K, on)
    return Equations(system.K, on)


def _solve_trial(system: EquilibratedSystem, equations: Equations, active: Bools) -> _Trial:
    """Solve the equations of a contact set (n,), and judge the sign of each pressure and gap."""
    K, r, n = system.K, system.r, system.n
    x = equations.solve(r)
    p = x[:n]
    closed = K[:, :n] @ p
    opened = K[:n, n:] @ x[n:]
    residual = r + closed
    w = residual[:n]
    w += opened
    # Pressures and gaps are negative only beyond the round-off of their largest members.
    largest_gap = max(np.abs(r[:n]).max(), np.abs(opened).max(), np.abs(closed[:n]).max())
    p_round_off = SET_ROUND_OFF * np.abs(p).max()
    w_round_off = SET_ROUND_OFF * largest_gap
    wrong = np.where(active, p < -p_round_off, w < -w_round_off)
    return _Trial(x, p, w, residual, wrong)


def _refine(
    system: EquilibratedSystem, equations: Equations, active: Bools, trial: _Trial, steps: int
) -> Contact:
    """Refine the solution on a consistent contact set by one step of iterative refinement.

    After the refinement pressures and motions balance to round-off, even if wide gaps close on tiny
    compressions.
    """
    x = (trial.x + equations.solve(trial.residual)) * system.column_scales
    trial.w[active] = 0.0
    n = system.n
    return Contact(
        p=np.maximum(x[:n], 0.0),
        w=trial.w / system.row_scales[:n],
        y=x[n:],
        active=active,
        steps=steps,
        regular=regular(equations, system),
        system=system,
        tangent=partial(_pressure_change, equations, system),
    )


def _next_contact_set(
    problem: Problem,
    system: EquilibratedSystem,
    equations: Equations,
    active: Bools,
    trial: _Trial,
) -> Bools:
    """The next contact set (n,): the wrong nodes change if the set still resists all modes.

    A stiff shoe with two rigid-body modes stands on two nodes. If one node opens, the shoe turns
    about the other node until a third node touches, see `_first_blocking_node`. In this way a short
    contact moves along the lining node by node.
    """
    wanted = active ^ trial.wrong
    if _resists_modes(problem, wanted):
        return wanted
    # Touching nodes are added. Pulling nodes leave in the order of their pull, if the rest resists.
    found = active | trial.wrong
    leaving = np.flatnonzero(active & trial.wrong)
    leaving = leaving[np.argsort(trial.p[leaving], kind="stable")]
    for node in leaving:
        found[node] = False
        found[node] = not _resists_modes(problem, found)
    if not np.array_equal(found, active) or not len(leaving):
        return found
    # No node could leave: the node that pulls most is exchanged for the first that touches.
    pulling = int(leaving[0])
    touched = _first_blocking_node(system.K, equations, trial.w, pulling, found)
    if touched is None:
        return wanted
    found[[pulling, touched]] = False, True
    return found


def _first_blocking_node(
    K: Floats,
    equations: Equations,
    w: Floats,
    leaving: int,
    active: Bools,
) -> int | None:
    """The node that touches first as a node of the contact set opens; None if no node touches.

    Without the leaving node the contact set leaves one rigid-body mode free. As the node opens, the
    gaps therefore change by this mode alone, and no pressure changes.

    Parameters
    ----------
    K : matrix (n + k, n + k) of the equilibrated system
    equations : the factorised equations of the contact set
    w : scaled weighted gaps (n,) before the node opens
    leaving : number of the node that opens
    active : the contact set (n,) with the leaving node
    """
    unit = np.zeros(len(K))
    unit[leaving] = -1.0
    slope = (K @ equations.solve(unit))[: len(w)]
    closes = ~active & (slope < -SET_ROUND_OFF * np.abs(slope).max(initial=0.0))
    if not closes.any():
        return None
    reach = np.full(len(w), np.inf)
    reach[closes] = np.maximum(w[closes], 0.0) / -slope[closes]
    return int(reach.argmin())


class _Line(NamedTuple):
    """Pressures of the contact set and gaps of all other nodes as linear functions of s.

    `value` (n,) are the pressures and gaps at s = 0, and `slope` (n,) their change per s.
    """

    value: Floats
    slope: Floats

    def at(self, s: float) -> Floats:
        """The pressures and gaps (n,) at s."""
        return self.value + s * self.slope


def follow_from_wider_gaps(problem: Problem) -> tuple[Bools, int]:
    """Follow the answer from wider gaps q + s e, s = 1, to the true gaps, s = 0.

    At s = 1 only those nodes touch that the actuation closes first; e (n,) lifts all other nodes.
    Between two changes of the contact set p and w are linear in s. One node changes at a time. The
    path may turn, so that s grows again. A path ends at an answer or goes on for ever (Lemke 1965;
    Cottle, Pang & Stone, The Linear Complementarity Problem, section 4.5).

    Returns
    -------
    the contact set (n,) of the answer, and the number of steps to it

    Raises
    ------
    NoAnswer
        if the path goes on for ever
    """
    system = equilibrated(problem)
    K, n = system.K, system.n
    active = _first_touching_set(system.problem, alone=True)
    s, direction, last = 1.0, -1, -1
    lift = np.zeros(len(system.r))
    for step in range(MOST_SET_CHANGES * n):
        equations = Equations(K, system.on(active))
        if step == 0:
            lift[:n] = _start_lift(system, equations, active)
        line = _answer_line(system, equations, active, lift)
        # The node that has changed last must leave zero.
        if step > 0:
            direction = 1 if line.slope[last] > 0 else -1
        reach = _distances_to_zero(line, s, direction)
        if direction < 0 and reach.min() >= s:
            return active, step + 1
        last = int(reach.argmin())
        s += direction * reach[last]
        if not np.isfinite(s):
            break
        leaves = active[last]
        active[last] = not active[last]
        if leaves and not _resists_modes(problem, active):
            # A leaving node that frees a mode is exchanged for the node that stops the mode.
            active[last] = True
            gaps = np.where(active, 0.0, line.at(s))
            touched = _first_blocking_node(K, equations, gaps, last, active)
            if touched is None:
                break
            active[[last, touched]] = False, True
            last = touched
    raise NoAnswer("no equilibrium found: from wider gaps the contact never reaches the true ones")


def _start_lift(system: EquilibratedSystem, equations: Equations, active: Bools) -> Floats:
    """Gaps (n,) to add so that all nodes outside a contact set (n,) are open.

    The added gaps differ from node to node, so that no two nodes change together.
    """
    r, n = system.r, system.n
    w = (r + system.K @ equations.solve(r))[:n]
    uneven = 1 + np.arange(n) * GOLDEN % 1
    smallest = PATH_LIFT * max(np.abs(w).max(), np.abs(r[:n]).max())
    return np.where(active, 0.0, np.maximum(-w, 0.0) + smallest * uneven)


def _answer_line(
    system: EquilibratedSystem, equations: Equations, active: Bools, lift: Floats
) -> _Line:
    """The pressures and gaps on a contact set (n,) as functions of s, with gaps q + s lift."""
    K, r, n = system.K, system.r, system.n
    x, dx = equations.solve(r), equations.solve(lift)
    w, dw = (r + K @ x)[:n], (lift + K @ dx)[:n]
    return _Line(np.where(active, x[:n], w), np.where(active, dx[:n], dw))


def _distances_to_zero(line: _Line, s: float, direction: int) -> Floats:
    """The changes of s (n,) after which pressures or gaps have fallen to zero; inf if they grow.

    `direction` is the sense, +1 or -1, in which s changes.
    """
    falls = direction * line.slope < 0
    reach = np.full(len(falls), np.inf)
    reach[falls] = np.maximum(line.at(s), 0.0)[falls] / np.abs(line.slope[falls])
    return reach


def coarse_start(problem: Problem) -> Bools:
    """Guess the contact set (n,) by solving the problem on every other node.

    From a start with all nodes, a small contact at an unexpected place moves by its own width in a
    step. On a coarser problem these steps are few and cheap. A coarser problem starts from a still
    coarser problem, and the smallest problem from all nodes.
    """
    count = len(problem.q)
    active = np.ones(count, dtype=bool)
    if count < COARSENED_FROM:
        return active
    try:
        coarse = settle(halved(problem)).p > 0
    except NoAnswer:
        return active
    return spread_to_all_nodes(coarse, count)


def spread_to_all_nodes(coarse: Bools, count: int) -> Bools:
    """The contact set (count,) on all nodes from a contact set on every other node.

    The nodes next to a node of the coarse set belong to the fine set.
    """
    active = np.empty(count, dtype=bool)
    between = count // 2
    active[::2] = coarse
    active[1::2] = coarse[:between]
    active[1:-1:2] |= coarse[1 : between + count % 2]
    return active


def halved(problem: Problem) -> Problem:
    """The contact problem on every other node, with pressures that are linear in between.

    With the interpolation P the coarse problem is P^T A P, P^T q, P^T B and C P.
    """
    A, q, B, C, h = problem
    return Problem(
        halved_sums(halved_sums(A, 1)), halved_sums(q), halved_sums(B), halved_sums(C, 1), h
    )


def interpolated(coarse: Floats, count: int) -> Floats:
    """Interpolate pressures at every other node to pressures at all nodes (count,)."""
    p = np.empty(count)
    p[::2] = coarse
    p[1::2] = 0.5 * coarse[: count // 2]
    p[1 : 2 * len(coarse) - 2 : 2] += 0.5 * coarse[1:]
    return p


def halved_sums(rows: Floats, axis: int = 0) -> Floats:
    """Add half of each row to its neighbours and keep every other row.

    Rows (n, ...) become ((n + 1) // 2, ...), the transposed interpolation P^T times the rows. With
    axis 1 columns are summed in place of rows.
    """
    at = (slice(None),) * axis
    half = rows[*at, ::2].copy()
    between = 0.5 * rows[*at, 1::2]
    half[*at, : between.shape[axis]] += between
    half[*at, 1:] += between[*at, : half.shape[axis] - 1]
    return half


def _pressure_change(equations: Equations, system: EquilibratedSystem, dq: Floats) -> Floats:
    """The change of the pressures (n,) under a change dq (n,) of the weighted gaps."""
    dr = np.zeros(len(system.r))
    dr[: system.n] = dq
    return (system.column_scales * equations.solve(system.row_scales * dr))[: system.n]


def _resists_modes(problem: Problem, active: Bools) -> bool:
    """Whether a contact set (n,) resists each rigid-body mode.

    Modes of the same nodes need as many touching nodes as modes.
    """
    B, k = problem.B, len(problem.h)
    touched = B[active]
    if k < 2:
        return bool(touched.any()) or not B.size
    # Pressures in a mode without load, as the slide of a shoe under a cam, balance each other. A
    # single node cannot resist a mode without load.
    unloaded = problem.h == 0
    if unloaded.any():
        bearing = np.count_nonzero(problem.C[unloaded][:, active], axis=1)
        if (bearing == 1).any():
            return False
    moved = touched != 0
    if not moved.any(axis=0).all():
        return False
    resisting = (
        np.count_nonzero(moved[:, of].any(axis=1)) >= len(of) for of in _group_modes(B != 0)
    )
    return all(resisting)


def _first_touching_set(problem: Problem, *, alone: bool = False) -> Bools:
    """The set of nodes (n,) that the actuation closes first in each mode, if no node touches yet.

    With `alone` a shoe with a single mode touches with one node only.
    """
    _, q, B, C, h = problem
    n = len(q)
    touching, p = np.zeros(n, dtype=bool), np.zeros(n)
    # The pressures of a shoe that pushes another shoe give the load on the other shoe.
    for modes in _order_by_pressures(_group_modes(B != 0), B != 0, C != 0):
        load = h[modes] - C[modes] @ p
        if len(modes) > 1:
            moved = (B[:, modes] != 0).any(axis=1)
            first = _first_touching_nodes(q, B[:, modes], C[modes], load, moved)
            touching[first] = True
        else:
            reach = _touching_motions(problem, modes[0], load)
            first = np.array([reach.argmin()])
            touching[first if alone else reach <= reach.min()] = True
        p[first] = np.linalg.solve(C[modes][:, first], load)
    return touching


def _touching_motions(problem: Problem, mode: int, load: Floats) -> Floats:
    """The motion (n,) of a single mode at which each node touches.

    The motion is inf for a node whose pressure does not resist the load on the mode. Raises
    NoAnswer if no pressure resists the load.
    """
    _, q, B, C, _ = problem
    moved = B[:, mode] != 0
    bearing = moved & (C[mode] * load > 0)
    if not bearing.any():
        raise NoAnswer("no equilibrium: contact pressure cannot balance the actuation anywhere")
    reach = np.full(len(q), np.inf)
    reach[bearing] = q[bearing] / np.abs(B[bearing, mode])
    return reach


def _order_by_pressures(sets: list[list[int]], moves: Bools, bears: Bools) -> list[list[int]]:
    """Order sets of modes so that the equilibria of a set need only pressures of earlier sets.

    Parameters
    ----------
    sets : sets of modes that move the same nodes
    moves : whether a mode moves a node (n, k)
    bears : whether a pressure occurs in the equilibrium of a mode (k, n)
    """
    moved = [moves[:, modes].any(axis=1) for modes in sets]
    known = np.zeros(len(moves), dtype=bool)
    found, left = [], list(range(len(sets)))
    while left:
        # Shoes that push each other in a circle have no order: then the first set is taken.
        following = left[0]
        for i in left:
            borne = bears[sets[i]].any(axis=0)
            if not (borne & ~moved[i] & ~known).any():
                following = i
                break
        left.remove(following)
        known |= moved[following]
        found.append(sets[following])
    return found


def _group_modes(moved: Bools) -> list[list[int]]:
    """Group the modes that move the same nodes; `moved` (n, k) says whether a mode moves a node."""
    found: list[list[int]] = []
    for mode in range(moved.shape[1]):
        for modes in found:
            if (moved[:, mode] & moved[:, modes[0]]).any():
                modes.append(mode)
                break
        else:
            found.append([mode])
    return found


def _first_touching_nodes(q: Floats, B: Floats, C: Floats, h: Floats, moved: Bools) -> Ints:
    """The k nodes that balance k modes by pressure while all other nodes are as open as possible.

    Parameters
    ----------
    q : weighted gaps (n,)
    B : gaps (n, k) per motion of a mode
    C : equilibria (k, n) of the modes
    h : loads (k,) on the modes
    moved : whether the modes move a node (n,)

    Raises
    ------
    NoAnswer
        if no k nodes balance the load by pressures
    """
    k = len(h)
    candidates = np.flatnonzero(moved)
    # Candidates are thinned evenly until their sets fit into the memory.
    count = len(candidates)
    while math.comb(count, k) > MOST_CANDIDATE_SETS:
        count -= 1
    evenly = np.unique(np.linspace(0, len(candidates) - 1, count).astype(int))
    candidates = candidates[evenly]
    indices = np.array(list(combinations(range(len(candidates)), k)), dtype=int).reshape(-1, k)
    sets = candidates[indices]
    # Only sets whose nodes hold all modes in place are kept.
    equilibria, closings = C.T[sets].transpose(0, 2, 1), B[sets]  # (sets, k, k)
    holds = _are_regular(equilibria) & _are_regular(closings.transpose(0, 2, 1))
    sets, equilibria, closings = sets[holds], equilibria[holds], closings[holds]
    loads = np.broadcast_to(h[:, None], (len(sets), k, 1))
    p = np.linalg.solve(equilibria, loads)[..., 0]
    pressed = (p >= 0).all(axis=1)
    if not pressed.any():
        raise NoAnswer("no equilibrium: contact pressure cannot balance the actuation anywhere")
    # The set is chosen whose motion leaves the smallest remaining gap widest.
    gaps = q[sets[pressed]][..., None]
    y = -np.linalg.solve(closings[pressed], gaps)[..., 0]
    smallest_gap = (q[candidates] + y @ B[candidates].T).min(axis=1)
    return np.asarray(sets[pressed][np.argmax(smallest_gap)])


def _are_regular(matrices: Floats) -> Bools:
    """Whether matrices (m, k, k) of modes by nodes are regular beyond round-off."""
    # Scaled rows and columns make the units of the modes irrelevant.
    largest = np.maximum(np.abs(matrices).max(axis=(0, 2)), TINY)
    scaled = matrices / largest[:, None]
    length = np.maximum(np.linalg.norm(scaled, axis=1, keepdims=True), TINY)
    scaled = scaled / length
    return np.asarray(np.abs(np.linalg.det(scaled)) > SET_ROUND_OFF)
