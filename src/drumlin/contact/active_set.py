"""The complementarity problem of unilateral contact, solved by an active-set (semismooth Newton)
method.

All wrong nodes change at once (block principal pivoting: Kostreva 1978; Judice & Pires 1994); where
they do not become fewer, the answer is followed from wider gaps, one node changing at a time (Lemke
1965).

Find pressures p and free motions y such that

    w = q + A p + B y,    p >= 0,  w >= 0,  p w = 0,       C p = h

p (n,): nodal pressures; w (n,): weighted gaps; A (n, n): compliance, unsymmetric with friction, the
penalty included as a compliance M/eps (zero for an infinite penalty); y (k,): what equilibrium
leaves free, for a hinged shoe its rotation; C p = h: the equilibrium in these motions, C = B^T
where there is no friction.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from itertools import combinations

import numpy as np

from drumlin.arrays import Bools, Floats, Ints
from drumlin.contact.equations import (
    TINY,
    Changed,
    Equations,
    EquilibratedSystem,
    Problem,
    equilibrated,
    few_changed,
    regular,
)
from drumlin.errors import NoAnswer

MOST_PIVOT_STEPS = 120  # a brake that has an answer needs some ten
MOST_SET_CHANGES = 10  # changes of each node while an answer is followed from wider gaps
GOLDEN = (math.sqrt(5) - 1) / 2
PATH_LIFT = math.sqrt(np.finfo(float).eps)
"""Relative size of the lift under which no two nodes change together where a path of answers
begins: the root of the round-off, so far above it as it is below the gaps themselves. With a lift
as large as the gaps a path may miss an answer that it finds with all smaller ones.
"""
PATIENCE = 5
"""Steps in a row that all wrong nodes may change at once without becoming fewer.

Then they change one at a time, along a path that takes as many steps as nodes change. Judice and
Pires (1994) wait for up to ten steps. On 50 random holding brakes a patience of one takes 1.2 times
the factorisations, five to twelve within 2 % of each other; the answers are the same with any.
"""
COARSENED_FROM = 48
"""Nodes below which a contact set is not guessed from a coarser problem, as it is found in no time:
with 24 and 96 a tenth more or less of the steps, in the same time.
"""
SET_ROUND_OFF = (
    1e-12  # relative: a pressure or gap below it is round-off, and does not change the contact set
)


@dataclass(frozen=True)
class Contact:
    """Solution of a contact problem. `p` (n,), `w` (n,), `y` (k,), `active` (n,): the contact set.

    `regular`: on the contact set every free motion meets resistance, as it does without friction:
    the determinant has its sign and no motion's resistance is negative. Followed from mu = 0 this
    is lost where the brake locks itself. `system`: the problem equilibrated. `tangent(dq)`: change
    of p where the weighted gaps change by dq (n,) and the contact set stays.
    """

    p: Floats
    w: Floats
    y: Floats
    active: Bools
    steps: int
    regular: bool
    system: EquilibratedSystem
    tangent: Callable[[Floats], Floats]


def solve(problem: Problem, start: Bools | None = None) -> Contact:
    """Solve a contact problem from the contact set `start`, and from wider gaps where that leads
    nowhere.

    Without a start the set of `coarse_start` is tried first.

    Raises NoAnswer where no contact set is consistent: nothing balances the actuation, or not
    converged.
    """
    try:
        return settle(problem, start)
    except NotSettled as unsettled:
        active, steps = narrowed(problem)
        found = settle(problem, active)
        return replace(found, steps=unsettled.steps + steps + found.steps)


class NotSettled(NoAnswer):
    """The contact set still changes after `steps` in which all wrong nodes change at once."""

    def __init__(self, steps: int) -> None:
        super().__init__(f"not converged: the contact set still changes after {steps} steps")
        self.steps = steps


def settle(
    problem: Problem,
    start: Bools | None = None,
    most: int = MOST_PIVOT_STEPS,
    like: EquilibratedSystem | None = None,
) -> Contact:
    """The answer that changing all wrong nodes at once leads to from `start`, in at most `most`
    steps.

    like: see `equilibrated`. Raises NotSettled where the wrong nodes do not become fewer, NoAnswer
    where nothing balances the actuation.
    """
    system = equilibrated(problem, like)
    K, r, n = system.K, system.r, system.n
    active = coarse_start(problem) if start is None else start.copy()
    fewest, patience = n + 1, PATIENCE
    largest_q = np.abs(r[:n]).max()
    base: Equations | None = None
    for step in range(1, most + 1):
        if not _resisted(problem, active):  # a motion that nothing resists yet
            active = active | _first_touch(system.problem)
        on = system.on(active)
        if base is not None and few_changed(base, on):
            equations: Equations = Changed(base, K, on)
        else:
            equations = base = Equations(K, on)
        x = equations.solve(r)
        p, closed, opened = x[:n], K[:, :n] @ x[:n], K[:n, n:] @ x[n:]
        left = r + closed  # w, and what the equilibria are out of balance by
        w = left[:n]
        w += opened
        p_slack = SET_ROUND_OFF * np.abs(p).max()
        w_slack = SET_ROUND_OFF * max(largest_q, np.abs(opened).max(), np.abs(closed[:n]).max())
        change = np.where(active, p < -p_slack, w < -w_slack)
        wrong = int(np.count_nonzero(change))
        if not wrong:
            # One step of refinement: p and y balance to round-off even where wide gaps close on
            # tiny compressions.
            x = (x + equations.solve(left)) * system.across
            w[active] = 0.0
            return Contact(
                p=np.maximum(x[:n], 0.0),
                w=w / system.down[:n],
                y=x[n:],
                active=active,
                steps=step,
                regular=regular(equations, system),
                system=system,
                tangent=partial(_tangent, equations, system),
            )
        fewest, patience = (wrong, PATIENCE) if wrong < fewest else (fewest, patience - 1)
        if patience < 0:
            break
        active = _changed(problem, active, change, p, w, equations, K)
    raise NotSettled(step)


def _changed(
    problem: Problem,
    active: Bools,
    change: Bools,
    p: Floats,
    w: Floats,
    equations: Equations,
    K: Floats,
) -> Bools:
    """The contact set (n,) with the nodes `change` (n,) changed, as far as its motions stay
    resisted.

    A shoe with two free motions that hardly yields stands on two nodes. It cannot leave one of them
    without a third: it turns about the other until the third one touches, see `_blocking`. In this
    way a short contact moves along the lining node by node. p, w (n,): pressures and weighted gaps
    of the set `active`, equilibrated as K is.
    """
    wanted = active ^ change
    if _resisted(problem, wanted):
        return wanted
    found = active | change
    leaving = np.flatnonzero(active & change)
    leaving = leaving[np.argsort(p[leaving], kind="stable")]
    for node in leaving:
        found[node] = False
        found[node] = not _resisted(problem, found)
    if not np.array_equal(found, active) or not len(leaving):
        return found
    worst = int(leaving[0])
    touched = _blocking(K, equations, w, worst, found)
    if touched is None:
        return wanted
    found[[worst, touched]] = False, True
    return found


def _blocking(
    K: Floats,
    equations: Equations,
    w: Floats,
    leaving: int,
    active: Bools,
) -> int | None:
    """The node that touches first as the node `leaving` of a contact set opens; None where none
    does.

    Without that node the set leaves a motion free. So no pressure changes as the node opens, only
    gaps change, by this motion: K of the set `active` (n,), which its `equations` have factorised,
    says how. w (n,): the weighted gaps before.
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


def narrowed(problem: Problem) -> tuple[Bools, int]:
    """Contact set (n,) of the answer that gaps q + s e lead to as s goes from 1 to 0, and the steps
    to it.

    At s = 1 only the nodes touch that the actuation closes first; e (n,) lifts all others. Between
    two changes of the contact set p and w are linear in s, and each change is of one node; the next
    piece begins where it leaves zero, s growing again where the path turns. Such a path ends at an
    answer or goes on for ever (Lemke 1965; Cottle, Pang & Stone, The Linear Complementarity
    Problem, section 4.5).

    Raises NoAnswer where it goes on for ever.
    """
    system = equilibrated(problem)
    K, r, n = system.K, system.r, system.n
    active = _first_touch(system.problem, alone=True)
    s, way, last, e = 1.0, -1, -1, np.zeros(len(r))
    for step in range(MOST_SET_CHANGES * n):
        equations = Equations(K, system.on(active))
        x = equations.solve(r)
        w = (r + K @ x)[:n]
        if step == 0:
            uneven = 1 + np.arange(n) * GOLDEN % 1  # no two nodes change together
            wider = PATH_LIFT * max(np.abs(w).max(), np.abs(r[:n]).max())
            e[:n] = np.where(active, 0.0, np.maximum(-w, 0.0) + wider * uneven)
        dx = equations.solve(e)
        value, slope = (
            np.where(active, x[:n], w),
            np.where(active, dx[:n], (e + K @ dx)[:n]),
        )  # at s = 0, and per s
        if step > 0:
            way = 1 if slope[last] > 0 else -1  # the node that has changed leaves zero
        falls = way * slope < 0
        reach = np.full(n, np.inf)
        reach[falls] = np.maximum(value + s * slope, 0.0)[falls] / np.abs(slope[falls])
        if way < 0 and reach.min() >= s:
            return active, step + 1
        last = int(reach.argmin())
        s += way * reach[last]
        if not np.isfinite(s):
            break
        leaves, active[last] = active[last], not active[last]
        if leaves and not _resisted(problem, active):
            active[last] = True
            at = np.where(active, 0.0, value + s * slope)
            touched = _blocking(K, equations, at, last, active)
            if touched is None:
                break
            active[[last, touched]] = False, True
            last = touched
    raise NoAnswer("no equilibrium found: from wider gaps the contact never reaches the true ones")


def coarse_start(problem: Problem) -> Bools:
    """Contact set (n,) of the problem on every other node, p linear in between: P^T A P, P^T q, P^T
    B, C P.

    A contact that is small and lies far from where a full start would look moves by its own width a
    step; on coarser problems, each started from a coarser one, these steps are few and cost
    nothing. The smallest problems start from all nodes.
    """
    count = len(problem.q)
    active = np.ones(count, dtype=bool)
    if count < COARSENED_FROM:
        return active
    try:
        coarse = settle(halved(problem)).p > 0
    except NoAnswer:
        return active
    return beside(coarse, count)


def beside(coarse: Bools, count: int) -> Bools:
    """The nodes (count,) of a set of every other node, and those next to them."""
    active = np.empty(count, dtype=bool)
    between = count // 2
    active[::2] = coarse
    active[1::2] = coarse[:between]
    active[1:-1:2] |= coarse[1 : between + count % 2]
    return active


def halved(problem: Problem) -> Problem:
    """The problem on every other node, p linear in between."""
    A, q, B, C, h = problem
    return Problem(
        halved_sums(halved_sums(A, 1)), halved_sums(q), halved_sums(B), halved_sums(C, 1), h
    )


def between(coarse: Floats, count: int) -> Floats:
    """Pressures (count,) of those at every other node: P p."""
    p = np.empty(count)
    p[::2] = coarse
    p[1::2] = 0.5 * coarse[: count // 2]
    p[1 : 2 * len(coarse) - 2 : 2] += 0.5 * coarse[1:]
    return p


def halved_sums(rows: Floats, axis: int = 0) -> Floats:
    """P^T rows: every other row with half of each neighbour (n, ...) -> ((n + 1) // 2, ...); axis
    1: of columns.
    """
    at = (slice(None),) * axis
    half, between = rows[*at, ::2].copy(), 0.5 * rows[*at, 1::2]
    half[*at, : between.shape[axis]] += between
    half[*at, 1:] += between[*at, : half.shape[axis] - 1]
    return half


def _tangent(equations: Equations, system: EquilibratedSystem, dq: Floats) -> Floats:
    dr = np.zeros(len(system.r))
    dr[: system.n] = dq
    return (system.across * equations.solve(system.down * dr))[: system.n]


def _resisted(problem: Problem, active: Bools) -> bool:
    """Whether each free motion meets a node of the contact set (n,), motions of the same nodes one
    each.

    Where nothing acts on a motion, as on the slide of a shoe that a cam pushes, pressures have to
    balance each other: one alone cannot.
    """
    B, k = problem.B, len(problem.h)
    touched = B[active]
    if k < 2:
        return bool(touched.any()) or not B.size
    idle = problem.h == 0
    if idle.any() and (np.count_nonzero(problem.C[idle][:, active], axis=1) == 1).any():
        return False
    touched = touched != 0
    return bool(touched.any(axis=0).all()) and all(
        np.count_nonzero(touched[:, of].any(axis=1)) >= len(of) for of in _together(B != 0)
    )


def _first_touch(problem: Problem, *, alone: bool = False) -> Bools:
    """For each free motion the nodes that the actuation closes first, when nothing touches;
    `alone`: one of them.

    Shoes that push others come before these, whose forces follow from the pressures of the first
    ones.
    """
    _, q, B, C, h = problem
    n = len(q)
    touching, p = np.zeros(n, dtype=bool), np.zeros(n)
    for motions in _in_order(_together(B != 0), B != 0, C != 0):
        own = (B[:, motions] != 0).any(axis=1)
        load = h[motions] - C[motions] @ p
        if len(motions) > 1:
            first = _first_nodes(q, B[:, motions], C[motions], load, own)
            touching[first] = True
        else:
            (k,) = motions
            # The nodes whose pressure resists the actuation.
            bearing = own & (C[k] * load > 0)
            if not bearing.any():
                raise NoAnswer(
                    "no equilibrium: contact pressure cannot balance the actuation anywhere"
                )
            reach = np.full(n, np.inf)
            reach[bearing] = q[bearing] / np.abs(B[bearing, k])
            first = np.array([reach.argmin()])
            touching[first if alone else reach <= reach.min()] = True
        p[first] = np.linalg.solve(C[motions][:, first], load)
    return touching


MOST_CANDIDATE_SETS = 2016
"""Limit of memory: sets of nodes, as many as there are motions, among which those that bear these
motions first are looked for. It takes all pairs of 64 nodes, or all triples of 23; of more nodes
every few.
"""


def _in_order(sets: list[list[int]], moves: Bools, bears: Bools) -> list[list[int]]:
    """Sets of motions, those first whose equilibria know no pressures but their own and those of
    earlier ones.

    moves (n, k): whether a motion moves a node; bears (k, n): whether a pressure is in its
    equilibrium.
    """
    moved = [moves[:, motions].any(axis=1) for motions in sets]
    known = np.zeros(len(moves), dtype=bool)
    found, left = [], list(range(len(sets)))
    while left:
        ready = (i for i in left if not (bears[sets[i]].any(axis=0) & ~moved[i] & ~known).any())
        following = next(ready, left[0])
        left.remove(following)
        known |= moved[following]
        found.append(sets[following])
    return found


def _together(moved: Bools) -> list[list[int]]:
    """The motions in sets that move the same nodes; moved (n, k)."""
    found: list[list[int]] = []
    for k in range(moved.shape[1]):
        like = next(
            (motions for motions in found if (moved[:, k] & moved[:, motions[0]]).any()), None
        )
        if like is None:
            found.append([k])
        else:
            like.append(k)
    return found


def _first_nodes(q: Floats, B: Floats, C: Floats, h: Floats, own: Bools) -> Ints:
    """As many nodes as motions B (n, k), C (k, n) whose pressures balance these, with which the
    others are most open.

    own (n,): the nodes that the motions move.
    """
    k, on = len(h), np.flatnonzero(own)
    few = len(on)
    while math.comb(few, k) > MOST_CANDIDATE_SETS:
        few -= 1
    on = on[np.unique(np.linspace(0, len(on) - 1, few).astype(int))]
    sets = on[np.array(list(combinations(range(len(on)), k)), dtype=int).reshape(-1, k)]
    equilibria, closings = C.T[sets].transpose(0, 2, 1), B[sets]  # (sets, k, k)
    fixed = _independent(equilibria) & _independent(closings.transpose(0, 2, 1))
    sets, equilibria, closings = sets[fixed], equilibria[fixed], closings[fixed]
    p = np.linalg.solve(equilibria, np.broadcast_to(h[:, None], (len(sets), k, 1)))[..., 0]
    bears = (p >= 0).all(axis=1)
    if not bears.any():
        raise NoAnswer("no equilibrium: contact pressure cannot balance the actuation anywhere")
    y = -np.linalg.solve(closings[bears], q[sets[bears]][..., None])[..., 0]
    open_ = (q[on] + y @ B[on].T).min(axis=1)
    return np.asarray(sets[bears][np.argmax(open_)])


def _independent(matrices: Floats) -> Bools:
    """Whether matrices (m, k, k) of motions by nodes are regular beyond round-off, whatever units
    the motions have.
    """
    scaled = matrices / np.maximum(np.abs(matrices).max(axis=(0, 2)), TINY)[:, None]
    scaled = scaled / np.maximum(np.linalg.norm(scaled, axis=1, keepdims=True), TINY)
    return np.asarray(np.abs(np.linalg.det(scaled)) > SET_ROUND_OFF)
