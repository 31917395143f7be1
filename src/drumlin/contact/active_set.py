"""An active-set method for unilateral contact in full slip.

The contact problem is a linear complementarity problem. Find nodal pressures p (n,) and rigid-body
motions y (k,) with the weighted gaps

    w = q + A p + B y,    p >= 0,  w >= 0,  p w = 0,       C p = h

A (n, n) is the compliance. Friction makes A unsymmetric. A contact penalty eps adds the compliance
M/eps to A, with the mass matrix M of the contact nodes; the addition is zero for an infinite
penalty. A hinged shoe has one rigid-body motion, its rotation. C p = h are the equilibria in the
rigid-body modes; without friction C = B^T.

A trial contact set gives each node a pressure or a gap. A node is wrong if its pressure or its gap
is negative. The active-set method is a semismooth Newton method: all wrong nodes change at once
(block principal pivoting: Kostreva 1978; Judice & Pires 1994). If the wrong nodes do not become
fewer, `find_contact_set_and_step_count_by_closing_wide_gaps` changes one node at a time (Lemke
1965).
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
    SMALLEST_NORMAL_DOUBLE,
    BorderedEquations,
    ContactProblem,
    ContactSetEquations,
    ScaledContactSystem,
    do_contact_equations_resist_all_rigid_modes,
    is_bordered_system_cheaper_than_new_factors,
    scale_contact_problem,
)

MAX_STEPS_OF_ACTIVE_SET_METHOD = 120
"""Largest number of steps of the active-set method for a contact problem.

In each step all nodes with a negative pressure or a negative gap change between contact and
separation. A brake needs some ten steps.
"""

MAX_CONTACT_SET_CHANGES_PER_NODE = 10
"""Largest number of changes of the contact set, per contact node, on a path of solutions.

The path leads from contact under widened gaps to contact under the true gaps. If more changes are
needed, the contact problem is refused.
"""

INVERSE_GOLDEN_RATIO = (math.sqrt(5) - 1) / 2
"""Inverse of the golden ratio, 0.618.

The fractional parts of its multiples are all different. A path of solutions begins with gaps added
to the true ones, and these parts make the added gaps of all contact nodes differ.
"""

SMALLEST_ADDED_GAP_OVER_LARGEST_GAP = math.sqrt(np.finfo(float).eps)
"""Smallest gap that is added to a contact node, relative to the largest gap of all nodes.

Gaps are added where a path of solutions begins. The path then leads back to the true gaps. The
added gaps differ from node to node, so that no two nodes change between contact and separation at
the same time. The square root of the machine precision (1.5e-8) lies as far above round-off as
below the largest gap. With added gaps as large as the true gaps a path may miss a solution that it
finds with smaller added gaps.
"""

MAX_ACTIVE_SET_STEPS_WITHOUT_PROGRESS = 5
"""Number of steps of the active-set method within which the number of wrong nodes must fall.

A contact node is wrong if its pressure or its gap is negative. If the number of wrong nodes has not
fallen, the solution is followed along a path on which one node changes at a time, see
`find_contact_set_and_step_count_by_closing_wide_gaps`. The path needs a step for each node that
changes. Judice and Pires (1994) wait for up to ten steps. On 50 random holding brakes a limit of
one step takes 1.2 times as many factorisations as a limit of five. With limits from five to twelve
steps the numbers of factorisations differ by 2 %. The solutions are the same with any limit.
"""

FEWEST_NODES_FOR_COARSE_CONTACT_GUESS = 48
"""Least number of contact nodes for which the first contact set is guessed on fewer nodes.

The guess is the contact set of the same problem on every other node. Problems with fewer nodes
start with all nodes in contact, which is as fast. In trials, other values, 24 and 96 nodes, changed
the number of steps by a tenth and the time not at all.
"""

LARGEST_ROUND_OFF_OF_PRESSURE_OR_GAP = 1e-12
"""Relative size up to which a negative pressure or a negative gap of a node counts as round-off.

Pressures are relative to the largest pressure, gaps to the largest gap. A contact node with a
larger negative value changes between contact and separation.
"""

MAX_CANDIDATE_SETS_OF_FIRST_TOUCHING_NODES = 2016
"""Largest number of sets of nodes among which a shoe's first points of contact are sought.

A shoe with k rigid-body modes first touches at a set of k nodes. The limit keeps the memory small.
All pairs of 64 nodes (2016), or all triples of 23 nodes (1771), fit into the limit. If a shoe has
more nodes, only some of them, evenly spaced, are candidates.
"""


@dataclass(frozen=True)
class ContactSolution:
    """The solution of a contact problem of n nodes and k rigid-body modes.

    Attributes
    ----------
    p : nodal pressures (n,)
    w : weighted gaps (n,)
    y : rigid-body motions (k,)
    active : whether a node (n,) touches, which means that it is in the contact set
    steps : number of contact sets that were solved
    stable : whether the contact resists every rigid-body mode, as it does without friction. Where
        growing friction makes the brake lock itself, the solution is unstable.
    system : the scaled contact problem
    pressure_change : function that returns the change of p (n,) under a given change of the
        weighted gaps (n,) while the contact set stays
    """

    p: Floats
    w: Floats
    y: Floats
    active: Bools
    steps: int
    stable: bool
    system: ScaledContactSystem
    pressure_change: Callable[[Floats], Floats]


class ContactSetNotConvergedError(NoAnswer):
    """The error that the contact set still changes after a number of `steps`."""

    def __init__(self, steps: int) -> None:
        super().__init__(f"not converged: the contact set still changes after {steps} steps")
        self.steps = steps


def solve_contact_problem(problem: ContactProblem, start: Bools | None = None) -> ContactSolution:
    """Solve a contact problem, and return its solution.

    The active-set method starts from a contact set. If the method does not converge, the solution
    is followed from widened gaps.

    Parameters
    ----------
    problem : the contact problem of n nodes
    start : contact set (n,) of the first step; by default the guess of
        `guess_contact_set_from_coarse_problem`

    Raises
    ------
    NoAnswer
        if no pressures balance the actuation, or if neither method converges
    """
    try:
        return solve_contact_by_block_pivoting(problem, start)
    except ContactSetNotConvergedError as unsettled:
        active, steps = find_contact_set_and_step_count_by_closing_wide_gaps(problem)
        found = solve_contact_by_block_pivoting(problem, active)
        return replace(found, steps=unsettled.steps + steps + found.steps)


class _ScaledSolutionOnTrialContactSet(NamedTuple):
    """The scaled solution of the equations of a trial contact set.

    The contact set gives each node either a pressure or a gap, and both may come out negative.

    Attributes
    ----------
    x : pressures and rigid-body motions (n + k,)
    p : pressures (n,), a view of x
    w : weighted gaps (n,), a view of the residual
    residual : weighted gaps (n,), then the imbalance (k,) of the forces in each rigid-body mode
    nodes_with_negative_values : whether a node (n,) has a negative pressure or a negative gap
    """

    x: Floats
    p: Floats
    w: Floats
    residual: Floats
    nodes_with_negative_values: Bools


def solve_contact_by_block_pivoting(
    problem: ContactProblem,
    start: Bools | None = None,
    most_steps: int = MAX_STEPS_OF_ACTIVE_SET_METHOD,
    scales_of: ScaledContactSystem | None = None,
) -> ContactSolution:
    """Solve a contact problem by block pivoting, in which all wrong nodes change at once.

    A node is wrong if its pressure or its gap is negative.

    Parameters
    ----------
    problem : the contact problem of n nodes
    start : contact set (n,) of the first step; by default the guess of
        `guess_contact_set_from_coarse_problem`
    most_steps : limit of the steps
    scales_of : system whose scales are used, see `scale_contact_problem`

    Raises
    ------
    ContactSetNotConvergedError
        if the wrong nodes do not become fewer
    NoAnswer
        if no pressures balance the actuation
    """
    system = scale_contact_problem(problem, scales_of)
    active = guess_contact_set_from_coarse_problem(problem) if start is None else start.copy()
    fewest, patience = system.n + 1, MAX_ACTIVE_SET_STEPS_WITHOUT_PROGRESS
    base: ContactSetEquations | None = None
    for step in range(1, most_steps + 1):
        # If the touching nodes leave a rigid-body mode free, the equations are singular. Therefore
        # the nodes whose gaps the actuation closes first are added.
        if not _can_contact_set_resist_rigid_body_modes(problem, active):
            active = active | _mask_of_nodes_that_touch_first(system.scaled_contact_problem)
        equations = _factorise_equations_of_contact_set(system, active, base)
        if not isinstance(equations, BorderedEquations):
            base = equations
        trial = _solve_on_trial_contact_set(system, equations, active)
        count = int(np.count_nonzero(trial.nodes_with_negative_values))
        if not count:
            return _refine_contact_solution_once(system, equations, active, trial, step)
        # The search ends if the number of wrong nodes has not fallen for some steps.
        if count < fewest:
            fewest, patience = count, MAX_ACTIVE_SET_STEPS_WITHOUT_PROGRESS
        else:
            patience -= 1
        if patience < 0:
            break
        active = _next_contact_set(problem, system, equations, active, trial)
    raise ContactSetNotConvergedError(step)


def _factorise_equations_of_contact_set(
    system: ScaledContactSystem, active: Bools, base: ContactSetEquations | None
) -> ContactSetEquations | BorderedEquations:
    """Factorise the equations of a contact set (n,), and return them.

    The factors of the earlier equations `base` are reused if few nodes differ.
    """
    on = system.mask_of_unknowns_of_contact_set(active)
    if base is not None and is_bordered_system_cheaper_than_new_factors(base, on):
        return BorderedEquations(base, system.K, on)
    return ContactSetEquations(system.K, on)


def _solve_on_trial_contact_set(
    system: ScaledContactSystem, equations: ContactSetEquations, active: Bools
) -> _ScaledSolutionOnTrialContactSet:
    """Solve the equations of a trial contact set (n,), and mark nodes with negative values."""
    K, r, n = system.K, system.r, system.n
    x = equations.solve(r)
    p = x[:n]
    closed = K[:, :n] @ p
    opened = K[:n, n:] @ x[n:]
    residual = r + closed
    w = residual[:n]
    w += opened
    # A pressure or a gap counts as negative only if its size exceeds the round-off of the largest
    # pressure or gap.
    largest_gap = max(np.abs(r[:n]).max(), np.abs(opened).max(), np.abs(closed[:n]).max())
    p_round_off = LARGEST_ROUND_OFF_OF_PRESSURE_OR_GAP * np.abs(p).max()
    w_round_off = LARGEST_ROUND_OFF_OF_PRESSURE_OR_GAP * largest_gap
    wrong = np.where(active, p < -p_round_off, w < -w_round_off)
    return _ScaledSolutionOnTrialContactSet(x, p, w, residual, wrong)


def _refine_contact_solution_once(
    system: ScaledContactSystem,
    equations: ContactSetEquations,
    active: Bools,
    trial: _ScaledSolutionOnTrialContactSet,
    steps: int,
) -> ContactSolution:
    """Refine the solution on the final contact set by one step of iterative refinement.

    The refined pressures and rigid-body motions fulfil the equations to round-off. This holds even
    if the gaps that close are far wider than the compressions of the lining.
    """
    x = (trial.x + equations.solve(trial.residual)) * system.column_scales
    trial.w[active] = 0.0
    n = system.n
    return ContactSolution(
        p=np.maximum(x[:n], 0.0),
        w=trial.w / system.row_scales[:n],
        y=x[n:],
        active=active,
        steps=steps,
        stable=do_contact_equations_resist_all_rigid_modes(equations, system),
        system=system,
        pressure_change=partial(_pressure_change_due_to_gap_change, equations, system),
    )


def _next_contact_set(
    problem: ContactProblem,
    system: ScaledContactSystem,
    equations: ContactSetEquations,
    active: Bools,
    trial: _ScaledSolutionOnTrialContactSet,
) -> Bools:
    """Return the contact set (n,) of the next step of the active-set method.

    All wrong nodes change between contact and separation, if the new set still resists all
    rigid-body modes. Otherwise only some of the nodes with negative pressure leave the set.

    A stiff shoe with two rigid-body modes stands on two nodes. If one node opens, the shoe turns
    about the other node until a third node touches, see `_find_node_that_closes_first`. In this way
    a short contact moves along the lining node by node.
    """
    wanted = active ^ trial.nodes_with_negative_values
    if _can_contact_set_resist_rigid_body_modes(problem, wanted):
        return wanted
    # All nodes with a negative gap join the set. Nodes with negative pressure leave it one after
    # the other, the most negative first, as long as the remaining nodes resist all modes.
    found = active | trial.nodes_with_negative_values
    leaving = np.flatnonzero(active & trial.nodes_with_negative_values)
    leaving = leaving[np.argsort(trial.p[leaving], kind="stable")]
    for node in leaving:
        found[node] = False
        found[node] = not _can_contact_set_resist_rigid_body_modes(problem, found)
    if not np.array_equal(found, active) or not len(leaving):
        return found
    # No node could leave. The node with the most negative pressure opens, and the node that then
    # touches first takes its place.
    pulling = int(leaving[0])
    touched = _find_node_that_closes_first(system.K, equations, trial.w, pulling, found)
    if touched is None:
        return wanted
    found[[pulling, touched]] = False, True
    return found


def _find_node_that_closes_first(
    K: Floats,
    equations: ContactSetEquations,
    w: Floats,
    opening_node: int,
    active: Bools,
) -> int | None:
    """Return the number of the node that touches first while a node of the contact set opens.

    The result is None if no node touches.

    Without the opening node the contact set leaves one rigid-body mode free. As the node opens, the
    gaps therefore change by this mode alone, and no pressure changes.

    Parameters
    ----------
    K : matrix (n + k, n + k) of the scaled contact problem
    equations : the factorised equations of the contact set
    w : scaled weighted gaps (n,) before the node opens
    opening_node : number of the node that opens
    active : the contact set (n,) with the opening node
    """
    unit = np.zeros(len(K))
    unit[opening_node] = -1.0
    slope = (K @ equations.solve(unit))[: len(w)]
    closes = ~active & (
        slope < -LARGEST_ROUND_OFF_OF_PRESSURE_OR_GAP * np.abs(slope).max(initial=0.0)
    )
    if not closes.any():
        return None
    reach = np.full(len(w), np.inf)
    reach[closes] = np.maximum(w[closes], 0.0) / -slope[closes]
    return int(reach.argmin())


class _SolutionPathSegment(NamedTuple):
    """A segment of a solution path, on which the contact set stays the same.

    The parameter s of the path scales the gaps that are added to the true gaps. On the segment all
    pressures and gaps are linear in s. `value` (n,) holds the pressures of the contact set and the
    gaps of all other nodes at s = 0. `slope` (n,) is the change of these values per s.
    """

    value: Floats
    slope: Floats

    def pressures_and_gaps_at_path_parameter(self, s: float) -> Floats:
        """Return pressures in contact and gaps of the other nodes (n,) at path parameter s."""
        return self.value + s * self.slope


def find_contact_set_and_step_count_by_closing_wide_gaps(
    problem: ContactProblem,
) -> tuple[Bools, int]:
    """Follow the solution of a contact problem from widened gaps to the true gaps.

    The gaps are q + s e, with s = 1 where the path begins and s = 0 where it ends. The added gaps e
    (n,) are so wide that at s = 1 only those nodes touch that the actuation closes first. Between
    two changes of the contact set the pressures and gaps are linear in s. One node changes at a
    time. The path may turn, so that s grows again. A path ends at a solution or goes on for ever
    (Lemke 1965; Cottle, Pang & Stone, The Linear Complementarity Problem, section 4.5).

    Returns
    -------
    the contact set (n,) of the solution, and the number of contact sets solved on the path

    Raises
    ------
    NoAnswer
        if the path goes on for ever
    """
    system = scale_contact_problem(problem)
    K, n = system.K, system.n
    active = _mask_of_nodes_that_touch_first(system.scaled_contact_problem, one_node_per_mode=True)
    s, direction, last = 1.0, -1, -1
    lift = np.zeros(len(system.r))
    for step in range(MAX_CONTACT_SET_CHANGES_PER_NODE * n):
        equations = ContactSetEquations(K, system.mask_of_unknowns_of_contact_set(active))
        if step == 0:
            lift[:n] = _added_gaps_that_open_other_nodes(system, equations, active)
        line = _pressures_and_gaps_as_linear_path_segment(system, equations, active, lift)
        # The pressure or gap of the node that has changed last is zero and must not become
        # negative. The sign of its slope over the path parameter s therefore tells whether s
        # grows or falls.
        if step > 0:
            direction = 1 if line.slope[last] > 0 else -1
        reach = _path_parameter_change_until_pressure_or_gap_vanishes(line, s, direction)
        if direction < 0 and reach.min() >= s:
            return active, step + 1
        last = int(reach.argmin())
        s += direction * reach[last]
        if not np.isfinite(s):
            break
        leaves = active[last]
        active[last] = not active[last]
        if leaves and not _can_contact_set_resist_rigid_body_modes(problem, active):
            # Without the node that leaves the contact, the shoe is free to move in a rigid-body
            # mode. The node that stops this motion takes the place of the leaving node.
            active[last] = True
            gaps = np.where(active, 0.0, line.pressures_and_gaps_at_path_parameter(s))
            touched = _find_node_that_closes_first(K, equations, gaps, last, active)
            if touched is None:
                break
            active[[last, touched]] = False, True
            last = touched
    raise NoAnswer("no equilibrium found: from wider gaps the contact never reaches the true ones")


def _added_gaps_that_open_other_nodes(
    system: ScaledContactSystem, equations: ContactSetEquations, active: Bools
) -> Floats:
    """Return the gaps (n,) to add to the true gaps so that all nodes outside a contact set open.

    `active` (n,) is the contact set. The added gaps differ from node to node, so that no two nodes
    touch at the same time as the added gaps shrink.
    """
    r, n = system.r, system.n
    w = (r + system.K @ equations.solve(r))[:n]
    uneven = 1 + np.arange(n) * INVERSE_GOLDEN_RATIO % 1
    smallest = SMALLEST_ADDED_GAP_OVER_LARGEST_GAP * max(np.abs(w).max(), np.abs(r[:n]).max())
    return np.where(active, 0.0, np.maximum(-w, 0.0) + smallest * uneven)


def _pressures_and_gaps_as_linear_path_segment(
    system: ScaledContactSystem, equations: ContactSetEquations, active: Bools, lift: Floats
) -> _SolutionPathSegment:
    """Return pressures and gaps on a contact set (n,) as linear functions of the path parameter s.

    The path parameter s multiplies `lift` (n + k,): the scaled gaps that are added to the true
    gaps, and k zeros.
    """
    K, r, n = system.K, system.r, system.n
    x, dx = equations.solve(r), equations.solve(lift)
    w, dw = (r + K @ x)[:n], (lift + K @ dx)[:n]
    return _SolutionPathSegment(np.where(active, x[:n], w), np.where(active, dx[:n], dw))


def _path_parameter_change_until_pressure_or_gap_vanishes(
    line: _SolutionPathSegment, s: float, direction: int
) -> Floats:
    """Return for each node the change of the path parameter s that makes its pressure or gap zero.

    The changes (n,) are inf where the pressure or gap grows. `direction` is the sense, +1 or -1, in
    which s changes.
    """
    falls = direction * line.slope < 0
    reach = np.full(len(falls), np.inf)
    reach[falls] = np.maximum(line.pressures_and_gaps_at_path_parameter(s), 0.0)[falls] / np.abs(
        line.slope[falls]
    )
    return reach


def guess_contact_set_from_coarse_problem(problem: ContactProblem) -> Bools:
    """Guess the contact set (n,) of a problem from the solution of the problem on every other node.

    If the active-set method starts with all nodes in contact, a short contact moves along the
    lining by its own length in a step. On fewer nodes these steps are few and cheap. The problem on
    every other node gets its own guess in the same way, and the smallest problem starts with all
    nodes in contact.
    """
    count = len(problem.q)
    active = np.ones(count, dtype=bool)
    if count < FEWEST_NODES_FOR_COARSE_CONTACT_GUESS:
        return active
    try:
        coarse = solve_contact_by_block_pivoting(contact_problem_on_every_other_node(problem)).p > 0
    except NoAnswer:
        return active
    return extend_contact_set_to_all_nodes(coarse, count)


def extend_contact_set_to_all_nodes(coarse: Bools, count: int) -> Bools:
    """Extend a contact set on every other node to a contact set (count,) on all nodes.

    A node of the coarse set also adds its two neighbours, which are no nodes of the coarse problem.
    """
    active = np.empty(count, dtype=bool)
    between = count // 2
    active[::2] = coarse
    active[1::2] = coarse[:between]
    active[1:-1:2] |= coarse[1 : between + count % 2]
    return active


def contact_problem_on_every_other_node(problem: ContactProblem) -> ContactProblem:
    """Return the contact problem on every other node.

    The pressure is linear between the nodes that are kept. With the matrix P of this interpolation
    the coarse problem consists of P^T A P, P^T q, P^T B and C P.
    """
    A, q, B, C, h = problem
    return ContactProblem(
        restrict_array_to_every_other_node(restrict_array_to_every_other_node(A, 1)),
        restrict_array_to_every_other_node(q),
        restrict_array_to_every_other_node(B),
        restrict_array_to_every_other_node(C, 1),
        h,
    )


def interpolate_pressures_to_all_nodes(coarse: Floats, count: int) -> Floats:
    """Return pressures at all nodes (count,), interpolated from pressures at every other node."""
    p = np.empty(count)
    p[::2] = coarse
    p[1::2] = 0.5 * coarse[: count // 2]
    p[1 : 2 * len(coarse) - 2 : 2] += 0.5 * coarse[1:]
    return p


def restrict_array_to_every_other_node(rows: Floats, axis: int = 0) -> Floats:
    """Return every other row of an array, with half of each dropped row added to its neighbours.

    Rows (n, ...) become ((n + 1) // 2, ...). The result is P^T times the rows, with the matrix P
    that interpolates linearly from every other node to all nodes. With axis 1 the function treats
    columns in place of rows.
    """
    at = (slice(None),) * axis
    half = rows[*at, ::2].copy()
    between = 0.5 * rows[*at, 1::2]
    half[*at, : between.shape[axis]] += between
    half[*at, 1:] += between[*at, : half.shape[axis] - 1]
    return half


def _pressure_change_due_to_gap_change(
    equations: ContactSetEquations, system: ScaledContactSystem, dq: Floats
) -> Floats:
    """Return the change of the pressures (n,) under a change dq (n,) of the weighted gaps.

    The contact set, whose factorised equations are given, stays the same.
    """
    dr = np.zeros(len(system.r))
    dr[: system.n] = dq
    return (system.column_scales * equations.solve(system.row_scales * dr))[: system.n]


def _can_contact_set_resist_rigid_body_modes(problem: ContactProblem, active: Bools) -> bool:
    """Whether the nodes of a contact set (n,) keep the shoes from moving in every rigid-body mode.

    A shoe with several modes needs at least as many touching nodes as modes.
    """
    B, k = problem.B, len(problem.h)
    touched = B[active]
    if k < 2:
        return bool(touched.any()) or not B.size
    # In a mode without load, such as the slide of a shoe under a cam, the pressures balance each
    # other. The pressure of a single node would have no counterpart.
    unloaded = problem.h == 0
    if unloaded.any():
        bearing = np.count_nonzero(problem.C[unloaded][:, active], axis=1)
        if (bearing == 1).any():
            return False
    # Each mode must move at least one touching node, and the modes of one shoe together as many
    # touching nodes as there are modes.
    moved = touched != 0
    if not moved.any(axis=0).all():
        return False
    resisting = (
        np.count_nonzero(moved[:, of].any(axis=1)) >= len(of)
        for of in _group_modes_that_move_the_same_nodes(B != 0)
    )
    return all(resisting)


def _mask_of_nodes_that_touch_first(
    problem: ContactProblem, *, one_node_per_mode: bool = False
) -> Bools:
    """Mark the nodes (n,) that touch first as the actuation moves the open shoes.

    A shoe with a single rigid-body mode touches at the node whose gap the mode closes first, or at
    several nodes at once. With `one_node_per_mode` only one of these nodes is marked. A shoe with k
    modes touches at k nodes.
    """
    _, q, B, C, h = problem
    n = len(q)
    touching, p = np.zeros(n, dtype=bool), np.zeros(n)
    # If a shoe pushes another shoe, its pressures p are needed for the load on the other shoe.
    for modes in _sort_mode_groups_from_pushing_to_pushed_shoe(
        _group_modes_that_move_the_same_nodes(B != 0), B != 0, C != 0
    ):
        load = h[modes] - C[modes] @ p
        if len(modes) > 1:
            moved = (B[:, modes] != 0).any(axis=1)
            first = _find_touching_nodes_that_balance_shoe_load(
                q, B[:, modes], C[modes], load, moved
            )
            touching[first] = True
        else:
            reach = _rigid_body_motion_until_each_node_touches(problem, modes[0], load)
            first = np.array([reach.argmin()])
            touching[first if one_node_per_mode else reach <= reach.min()] = True
        p[first] = np.linalg.solve(C[modes][:, first], load)
    return touching


def _rigid_body_motion_until_each_node_touches(
    problem: ContactProblem, mode: int, load: Floats
) -> Floats:
    """Return the size (n,) of the motion in a rigid-body mode at which each node touches.

    The size is inf for a node whose pressure does not resist the load on the mode. Raises NoAnswer
    if no pressure resists the load.
    """
    _, q, B, C, _ = problem
    moved = B[:, mode] != 0
    bearing = moved & (C[mode] * load > 0)
    if not bearing.any():
        raise NoAnswer("no equilibrium: contact pressure cannot balance the actuation anywhere")
    reach = np.full(len(q), np.inf)
    reach[bearing] = q[bearing] / np.abs(B[bearing, mode])
    return reach


def _sort_mode_groups_from_pushing_to_pushed_shoe(
    mode_groups: list[list[int]], moves: Bools, bears: Bools
) -> list[list[int]]:
    """Sort the sets of modes, one set for each shoe, in the order in which shoes push each other.

    A shoe comes before the shoes that it pushes. The equilibria of a set then need only the
    pressures of the same shoe and of earlier shoes.

    Parameters
    ----------
    mode_groups : sets of modes that move the same nodes, the nodes of one shoe
    moves : whether a mode moves a node (n, k)
    bears : whether a pressure occurs in the equilibrium of a mode (k, n)
    """
    moved = [moves[:, modes].any(axis=1) for modes in mode_groups]
    known = np.zeros(len(moves), dtype=bool)
    found, left = [], list(range(len(mode_groups)))
    while left:
        # The next set is the first whose equilibria need no pressure that is still unknown. Shoes
        # that push each other in a circle have no such set; then the first set is taken.
        following = left[0]
        for i in left:
            borne = bears[mode_groups[i]].any(axis=0)
            if not (borne & ~moved[i] & ~known).any():
                following = i
                break
        left.remove(following)
        known |= moved[following]
        found.append(mode_groups[following])
    return found


def _group_modes_that_move_the_same_nodes(moved: Bools) -> list[list[int]]:
    """Return the lists of modes that move the same nodes, which are the modes of one shoe.

    `moved` (n, k) says whether a mode moves a node.
    """
    found: list[list[int]] = []
    for mode in range(moved.shape[1]):
        for modes in found:
            if (moved[:, mode] & moved[:, modes[0]]).any():
                modes.append(mode)
                break
        else:
            found.append([mode])
    return found


def _find_touching_nodes_that_balance_shoe_load(
    q: Floats, B: Floats, C: Floats, h: Floats, moved: Bools
) -> Ints:
    """Return the numbers of k nodes at which a shoe with k rigid-body modes touches first.

    Pressures at these nodes alone balance the load. Of all sets of k nodes for which this holds,
    the set is taken with which the other nodes keep the largest minimum gap.

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
    # Some candidates are dropped, evenly along the lining, until there are at most
    # MAX_CANDIDATE_SETS_OF_FIRST_TOUCHING_NODES sets of k nodes.
    count = len(candidates)
    while math.comb(count, k) > MAX_CANDIDATE_SETS_OF_FIRST_TOUCHING_NODES:
        count -= 1
    evenly = np.unique(np.linspace(0, len(candidates) - 1, count).astype(int))
    candidates = candidates[evenly]
    indices = np.array(list(combinations(range(len(candidates)), k)), dtype=int).reshape(-1, k)
    sets = candidates[indices]
    # Only sets whose nodes hold the shoe in all modes are kept.
    equilibria, closings = C.T[sets].transpose(0, 2, 1), B[sets]  # (sets, k, k)
    holds = _which_matrices_are_nonsingular(equilibria) & _which_matrices_are_nonsingular(
        closings.transpose(0, 2, 1)
    )
    sets, equilibria, closings = sets[holds], equilibria[holds], closings[holds]
    # Of the remaining sets, only those are kept that balance the load by pressures >= 0.
    loads = np.broadcast_to(h[:, None], (len(sets), k, 1))
    p = np.linalg.solve(equilibria, loads)[..., 0]
    pressed = (p >= 0).all(axis=1)
    if not pressed.any():
        raise NoAnswer("no equilibrium: contact pressure cannot balance the actuation anywhere")
    # A motion y closes the gaps of the nodes of a set. The set is taken whose motion leaves the
    # largest minimum gap among all candidates.
    gaps = q[sets[pressed]][..., None]
    y = -np.linalg.solve(closings[pressed], gaps)[..., 0]
    smallest_gap = (q[candidates] + y @ B[candidates].T).min(axis=1)
    return np.asarray(sets[pressed][np.argmax(smallest_gap)])


def _which_matrices_are_nonsingular(matrices: Floats) -> Bools:
    """Whether each of the matrices (m, k, k) has a determinant above round-off, as bools (m,).

    The rows stand for rigid-body modes and the columns for nodes.
    """
    # The rows and columns are scaled, because the modes have different units (rotations and
    # translations).
    largest = np.maximum(np.abs(matrices).max(axis=(0, 2)), SMALLEST_NORMAL_DOUBLE)
    scaled = matrices / largest[:, None]
    length = np.maximum(np.linalg.norm(scaled, axis=1, keepdims=True), SMALLEST_NORMAL_DOUBLE)
    scaled = scaled / length
    return np.asarray(np.abs(np.linalg.det(scaled)) > LARGEST_ROUND_OFF_OF_PRESSURE_OR_GAP)
