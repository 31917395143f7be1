"""Self-locking: the friction coefficient up to which sliding contact has an equilibrium.

In full slip the matrices of the contact problem grow linearly with the friction coefficient,

    A(mu) = A0 + mu A1,   C(mu) = C0 + mu C1.

On a contact set pressures and rigid-body motions solve K(mu) x = r with the bordered matrix
K = [[A, B], [C, 0]]. They grow without bound where K0 + mu K1 is singular. The friction is then an
eigenvalue of the pencil, the smallest above the current mu. The contact set changes on the way
there, and so does the eigenvalue. The answer is therefore followed from mu = 0. The limit mu_lock
is the eigenvalue of a contact set that holds right up to the eigenvalue. Such a limit does not
depend on force or clearance, which are negligible spread_to_all_nodes pressures without bound.

An answer may also end where the path turns back: at a change of the contact set beyond which the
determinant has the other sign. Other answers may exist beyond, to which the contact would jump. A
step over which the contact set changes must therefore be short: the contact force may grow by at
most LARGEST_FORCE_GROWTH.
"""

from collections.abc import Callable
from contextlib import suppress
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Bools, Floats
from drumlin.base.errors import NoAnswer
from drumlin.contact.active_set import (
    Contact,
    halved,
    halved_sums,
    interpolated,
    settle,
    solve,
    spread_to_all_nodes,
)
from drumlin.contact.equations import Problem, equilibrated

LARGEST_SOUGHT_FRICTION = 1e3
"""Friction coefficient up to which a limit is sought. A brake with a higher limit has none."""

LARGEST_FRICTION_STEP = 0.05
"""Largest step of mu by which an answer is followed; above mu = 1 the step is relative to mu.

The step changes the time alone. Steps over which the contact set changes are halved until the
growth of force is below LARGEST_FORCE_GROWTH; while the set stays, the determinant shows the limit.
On 30 brakes 0.025 takes 1.07 times the factorisations, 0.1 as many, 0.4 takes 1.1 times. The
answers are the same.
"""

POLE_DISTANCE = 1e-8
"""Relative distance below an eigenvalue at which the contact set must still hold.

If the contact set holds at this distance, the eigenvalue is a limit. The distance is far above
round-off.
"""

LARGEST_FORCE_GROWTH = 0.5
"""Largest relative growth of the contact force over a step of friction that is not halved.

The contact force is the sum of pressures times areas and grows as 1/(mu_lock - mu). From mu/2 to mu
the force grows by at most (1 - 1/4)/(1 - 1/2) - 1 = 0.5 for any mu up to mu_lock/2. A step over
which the contact set changes and the force grows by more is halved.
"""

HALVED_ABOVE = 600
"""Number of nodes above which the answer is followed on every other node.

The number changes the time alone, as the work grows with the cube of the nodes. The answer is the
same, see LARGEST_MESH_DIFFERENCE.
"""

LARGEST_MESH_DIFFERENCE = 0.1
"""Relative difference of pressures on all nodes and on every other node that one answer may have.

The difference and the pressures are measured by their work. One answer on two meshes differs by
0.004, two answers differ by 0.7. Any number between tells them apart; a smaller number costs time.
"""

RESOLUTION = 1e-12
"""Resolution, relative to mu, of a limit where the answer turns back."""


class Sliding(NamedTuple):
    """A contact problem as a linear function of the friction coefficient mu.

    `still` is the problem at mu = 0. `A1` (n, n) and `C1` (k, n) are the changes of A and C per mu.
    """

    still: Problem
    A1: Floats
    C1: Floats

    @classmethod
    def through(cls, still: Problem, other: Problem, friction: float = 1.0) -> "Sliding":
        """Make the linear function from the problems at mu = 0 and at another friction."""
        return cls(still, (other.A - still.A) / friction, (other.C - still.C) / friction)

    def at(self, friction: float) -> Problem:
        """The problem at a friction coefficient."""
        A, q, B, C, h = self.still
        return Problem(A + friction * self.A1, q, B, C + friction * self.C1, h)


class Limit(NamedTuple):
    """The end of the answer that is followed from mu = 0.

    Attributes
    ----------
    friction : mu_lock; inf if there is no limit up to LARGEST_SOUGHT_FRICTION
    bounded : whether the answer turns back at finite pressure, at a change of the contact set;
        otherwise the pressure grows without bound as 1/(mu_lock - mu)
    last : the answer at the friction coefficient `reached`, with the contact set of the limit
    reached : last friction coefficient that was solved
    steps : number of steps of friction that were tried
    """

    friction: float
    bounded: bool
    last: Contact
    reached: float
    steps: int


class PathEnded(NoAnswer):
    """The refusal of a friction coefficient beyond the limit `end` of the followed answer."""

    def __init__(self, line: str, end: Limit) -> None:
        super().__init__(line)
        self.end = end


def limit(
    sliding: Sliding,
    most: float = LARGEST_SOUGHT_FRICTION,
    known: tuple[float, Contact] | None = None,
    areas: Floats | None = None,
) -> Limit:
    """Follow the answer from mu = 0 to its end, or to a largest friction coefficient.

    Parameters
    ----------
    sliding : the problem at every friction coefficient
    most : friction coefficient at which following ends
    known : a friction coefficient and its answer, from which following starts
    areas : areas (n,) of the nodes [m^2]; by default 1, see `answer`

    Raises
    ------
    NoAnswer
        if there is no answer at mu = 0
    """
    areas = _areas_or_ones(sliding.still, areas)
    mu, found = (0.0, _solve_without_friction(sliding.still)) if known is None else known
    steps, step = 0, LARGEST_FRICTION_STEP
    critical, critical_set = np.inf, np.zeros(0, dtype=bool)
    while mu < most:
        steps += 1
        target = min(mu + step, most)
        after = _settle_stable(sliding, target, found.active)
        if after is not None and _continues(after, found, areas):
            step = min(2 * step, LARGEST_FRICTION_STEP * max(1.0, mu))
            found, mu = after, target
            continue
        # The step fails: the contact set may hold up to an eigenvalue, which is then the limit.
        if not np.array_equal(critical_set, found.active):
            try:
                critical = next_eigenvalue(sliding, mu, found.active)
            except np.linalg.LinAlgError:
                # The last step has met the singular friction itself.
                critical = mu
            critical_set = found.active
            if _holds_up_to(sliding, mu, critical, found.active):
                return Limit(critical, False, found, mu, steps)
        step = 0.5 * (target - mu)
        if step < RESOLUTION * max(mu, 1e-3):
            return Limit(mu, True, found, mu, steps)
    return Limit(np.inf, False, found, mu, steps)


def _continues(after: Contact, before: Contact, areas: Floats) -> bool:
    """Whether an answer continues the answer before: by the contact set or by little growth."""
    return np.array_equal(after.active, before.active) or _grows_little(after, before, areas)


def _holds_up_to(sliding: Sliding, mu: float, critical: float, active: Bools) -> bool:
    """Whether a contact set (n,) at mu still holds just below its next eigenvalue `critical`."""
    if not np.isfinite(critical):
        return False
    # The last step may have met the eigenvalue itself.
    if critical - mu < RESOLUTION * max(mu, 1e-3):
        return True
    near = mu + (critical - mu) * (1 - POLE_DISTANCE)
    return _settle_stable(sliding, near, active, 1) is not None


def _solve_without_friction(still: Problem, start: Bools | None = None) -> Contact:
    """Solve for the answer at mu = 0. Raises NoAnswer if the answer is unstable."""
    found = solve(still, start)
    if not found.regular:
        raise NoAnswer("no stable equilibrium without friction")
    return found


class _AtOnce(NamedTuple):
    """The result of settling at a friction coefficient at once, without following from mu = 0.

    Attributes
    ----------
    found : the answer; None if no contact set settles
    half : the answer at half of the friction; None if unknown
    stable : whether `found` is stable and mu is below the limit of the rigid shoe
    sure : whether `found` is certainly the answer that is followed from mu = 0
    reason : the reason to refuse `found` if `found` is not stable
    """

    found: Contact | None
    half: Contact | None
    stable: bool
    sure: bool
    reason: str


def answer(
    problem_at: Callable[[float], Problem],
    friction: float,
    start: Bools | None = None,
    areas: Floats | None = None,
    *,
    law: float,
    brake: str,
) -> Contact:
    """Find the answer at a friction coefficient that a path from mu = 0 reaches.

    A stable answer that settles at once is taken if the friction is below the limit of the rigid
    shoe, and if the contact force grows by at most LARGEST_FORCE_GROWTH from half of the friction
    on. Both hold up to half of mu_lock. Otherwise the answer is followed in small steps, from half
    of the friction if the answer there is sure. Other stable answers do not count: near the limit
    and beyond the limit some stand apart, and no friction that grows from 0 reaches them. Above
    HALVED_ABOVE nodes the answer on every other node is followed, at a fraction of the cost.

    Parameters
    ----------
    problem_at : function that returns the problem at mu; the problem is linear in mu
    friction : friction coefficient mu
    start : contact set (n,) from which the answer may settle at once
    areas : areas (n,) [m^2] of the nodes, which turn pressures into forces; by default 1, for
        pressures that are forces already
    law : mu_lock of the rigid shoe
    brake : words for the brake in the message of a refusal

    Raises
    ------
    PathEnded
        with both limits, if the answer ends before this friction
    NoAnswer
        if there is no answer for another reason
    """
    if friction == 0:
        return _solve_without_friction(problem_at(0.0), start)
    problem = problem_at(friction)
    areas = _areas_or_ones(problem, areas)
    if len(problem.q) > HALVED_ABOVE:
        like = _settle_like_coarse(problem, problem_at(0.0), friction, start, areas, law)
        if like is not None:
            return like
    at_once = _settle_at_once(problem_at, problem, friction, start, areas, law)
    if at_once.sure and at_once.found is not None:
        return at_once.found
    known = None
    half = at_once.half
    if half is not None and _is_followed(problem_at, 0.5 * friction, half, areas):
        known = (0.5 * friction, half)
    try:
        end = limit(Sliding.through(problem_at(0.0), problem_at(1.0)), friction, known, areas)
    except NoAnswer:
        # There is no answer without friction either, so that friction is not to blame.
        if at_once.stable and at_once.found is not None:
            return at_once.found
        raise NoAnswer(at_once.reason) from None
    if np.isinf(end.friction):
        return end.last
    raise PathEnded(locking_text(friction, end.friction, law=law, brake=brake), end)


def _settle_at_once(
    problem_at: Callable[[float], Problem],
    problem: Problem,
    friction: float,
    start: Bools | None,
    areas: Floats,
    law: float,
) -> _AtOnce:
    """Settle at a friction coefficient and at half of the coefficient, without following a path.

    `problem` is the problem at `friction`. The other parameters are parameters of `answer`.
    """
    found = half = None
    try:
        found = settle(problem, start)
        if not (found.regular and friction < law):
            return _AtOnce(found, None, False, False, "self-locking, no stable equilibrium")
        half = settle(problem_at(0.5 * friction), found.active, like=found.system)
        sure = _grows_little(found, half, areas)
    except NoAnswer as error:
        return _AtOnce(found, half, False, False, str(error))
    return _AtOnce(found, half, True, sure, "self-locking, no stable equilibrium")


def locking_text(friction: float, limit: float, *, law: float, brake: str) -> str:
    """The text that refuses a friction coefficient beyond a limit.

    Parameters
    ----------
    friction : the refused friction coefficient
    limit : mu_lock of the brake
    law : mu_lock of the rigid shoe
    brake : words for the brake
    """
    return (
        f"self-locking, no equilibrium at friction {friction:g}; {brake} there is one up to "
        f"mu_lock = {limit:.4g} (rigid-shoe law: {law:.4g})"
    )


def _settle_like_coarse(
    problem: Problem,
    still: Problem,
    friction: float,
    start: Bools | None,
    areas: Floats,
    law: float,
) -> Contact | None:
    """Settle at once, and compare with the answer that is followed on every other node.

    Parameters
    ----------
    problem, still : the problems at the friction coefficient and at mu = 0
    friction, areas, law : parameters of `answer`
    start : contact set (n,) to settle from; by default the contact set of the coarse answer

    Returns
    -------
    the answer on all nodes; None if this answer differs from the coarse one, is unstable or does
    not settle
    """
    coarse = Sliding.through(halved(still), halved(problem), friction)
    try:
        like = answer(coarse.at, friction, None, halved_sums(areas), law=law, brake="")
        first = spread_to_all_nodes(like.p > 0, len(problem.q)) if start is None else start
        found = settle(problem, first)
    except NoAnswer:
        return None
    # The work of the difference tells two meshes of one answer from two answers.
    off = interpolated(like.p, len(found.p)) - found.p
    work_off = float(off @ (problem.A @ off))
    work = float(found.p @ (problem.A @ found.p))
    same = work_off < LARGEST_MESH_DIFFERENCE**2 * work
    return found if found.regular and same else None


def _is_followed(
    problem_at: Callable[[float], Problem], friction: float, found: Contact, areas: Floats
) -> bool:
    """Whether an answer below the limit of the rigid shoe is surely followed from mu = 0."""
    try:
        half = settle(problem_at(0.5 * friction), found.active, like=found.system)
        return found.regular and _grows_little(found, half, areas)
    except NoAnswer:
        return False


def _grows_little(found: Contact, before: Contact, areas: Floats) -> bool:
    """Whether the contact force grows from a stable answer by at most LARGEST_FORCE_GROWTH."""
    # The sum of pressures would mislead: as friction grows, the contact moves along the lining. In
    # narrower elements more nodes press, and press harder, under the same force.
    force, force_before = float(areas @ found.p), float(areas @ before.p)
    return before.regular and force <= (1 + LARGEST_FORCE_GROWTH) * force_before


def _areas_or_ones(problem: Problem, areas: Floats | None) -> Floats:
    """The areas (n,) of the nodes, or 1 for each node if `areas` is None."""
    return np.ones(len(problem.q)) if areas is None else areas


def next_eigenvalue(sliding: Sliding, friction: float, active: Bools) -> float:
    """The smallest mu above `friction` at which K0 + mu K1 of a contact set is singular, or inf.

    With K(mu) G = K1, each eigenvalue gamma of G gives the singular friction mu - 1/gamma. Raises
    numpy's LinAlgError where K is singular at `friction` itself.
    """
    system = equilibrated(sliding.at(friction))
    nodes = np.flatnonzero(active)
    unknowns = np.flatnonzero(system.on(active))
    # K1 has columns of pressures alone: friction does not act on rigid-body motions.
    K1 = np.vstack([sliding.A1[nodes][:, nodes], sliding.C1[:, nodes]])
    K1 *= system.row_scales[unknowns, None] * system.column_scales[nodes]
    G = np.linalg.solve(system.K[unknowns[:, None], unknowns], K1)[: len(nodes)]
    gamma = np.linalg.eigvals(G)
    gamma = gamma[gamma.imag == 0].real
    # Only negative gamma give a friction above the present one; a gamma next to 0 gives mu = inf.
    falling = gamma[gamma < -1e-300]
    return float(friction - 1 / falling.min()) if len(falling) else np.inf


class Agreement(NamedTuple):
    """Counts of the answers to which several first contact sets lead.

    Attributes
    ----------
    starts : number of first contact sets
    same : number of first sets that end at the answer which is followed from mu = 0
    others : number of first sets that end at another stable answer
    unstable : number of first sets that end at an unstable answer
    lost : number of first sets that do not converge
    difference : largest difference of pressure among `same`, relative to the largest pressure
    """

    starts: int
    same: int
    others: int
    unstable: int
    lost: int
    difference: float


def agreement(
    problem: Problem, answer: Contact, starts: list[Bools], tolerance: float = 1e-6
) -> Agreement:
    """Solve a problem from each of several contact sets, and compare with its answer.

    Parameters
    ----------
    problem : contact problem of n nodes
    answer : the answer of the problem that is followed from mu = 0
    starts : first contact sets (n,)
    tolerance : difference of pressure, relative to the largest pressure, up to which answers are
        the same
    """
    counts = dict.fromkeys(("same", "others", "unstable", "lost"), 0)
    largest, scale = 0.0, np.abs(answer.p).max()
    for start in starts:
        try:
            found = solve(problem, start)
        except NoAnswer:
            counts["lost"] += 1
            continue
        difference = float(np.abs(found.p - answer.p).max() / scale)
        if difference <= tolerance:
            counts["same"] += 1
            largest = max(largest, difference)
        else:
            counts["others" if found.regular else "unstable"] += 1
    return Agreement(len(starts), **counts, difference=largest)


def first_singular(sliding: Sliding) -> float:
    """The smallest mu > 0 at which K0 + mu K1 is singular on any contact set, or inf.

    Below this friction the determinants of all contact sets have one sign, and every load and
    clearance has exactly one answer (without rigid-body modes a P-matrix: Samelson, Thrall & Wesler
    1958). A brake need not meet the contact set that is singular. All 2^n sets are tried, so that n
    must be small.
    """
    n, k = sliding.still.B.shape
    sets = ((np.arange(2**n)[:, None] >> np.arange(n)) & 1).astype(bool)
    smallest = np.inf
    for active in sets[sets.sum(axis=1) >= max(k, 1)]:
        # A contact set that leaves a mode free is singular at any friction; no answer has this set.
        with suppress(np.linalg.LinAlgError):
            smallest = min(smallest, next_eigenvalue(sliding, 0.0, active))
    return smallest


def _settle_stable(
    sliding: Sliding, friction: float, start: Bools, most: int = 30
) -> Contact | None:
    """The stable answer that settles from a contact set (n,) in `most` steps; None without one."""
    try:
        found = settle(sliding.at(friction), start, most)
    except NoAnswer:
        return None
    return found if found.regular else None
