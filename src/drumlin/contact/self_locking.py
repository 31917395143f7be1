"""Self-locking: the friction coefficient up to which sliding contact has an equilibrium that is
reached from mu = 0.

Under full slip the matrices of the contact problem grow linearly with the friction coefficient,

    A(mu) = A0 + mu A1,   C(mu) = C0 + mu C1.

On a contact set pressures and motions solve K(mu) x = r with the bordered K = [[A, B], [C, 0]].
They grow without bound where K0 + mu K1 is singular: at an eigenvalue of the pencil, the smallest
above the mu at hand. The contact set changes on the way there, and so does the eigenvalue: the
answer is followed from mu = 0, and the limit is the eigenvalue of a set that holds right up to it.
It does not depend on force or clearance then, which nothing keeps beside pressures without bound.
Else the answer ends where it turns back: at a change of the contact set beyond which the
determinant has the other sign. Other answers may stand beyond, to which the contact would leap and
grow: so a step over which the set changes is short enough that pressures grow by less than LARGEST_FORCE_GROWTH of
themselves.
"""

from collections.abc import Callable
from contextlib import suppress
from typing import NamedTuple

import numpy as np

from drumlin.arrays import Bools, Floats
from drumlin.contact.active_set import Contact, beside, between, halved, halved_sums, settle, solve
from drumlin.contact.equations import Problem, equilibrated
from drumlin.errors import NoAnswer

LARGEST_FRICTION = 1e3  # friction coefficient up to which a limit is looked for
LARGEST_FRICTION_STEP = 0.05
"""Largest step of mu by which an answer is followed; above mu = 1 relative to it. It is a matter of
time: steps over which the contact set changes are halved until LARGEST_FORCE_GROWTH holds, and while it does not
change the determinant shows the pole. On 30 brakes 0.025 takes 1.07 times the factorisations, 0.1
the same, 0.4
1.1 times, with the same answers.
"""
POLE_DISTANCE = 1e-8  # relative distance from an eigenvalue at which the contact set must hold
LARGEST_FORCE_GROWTH = 0.5
"""Largest relative growth of the contact force, the sum of pressures times their areas, over a step
of friction that the answer is followed through without a look at what lies between. The force grows
as 1/(mu_lock - mu), so that it grows by no more over the second half of any friction up to half of
mu_lock: (1 - 1/4)/(1 - 1/2) = 1.5. Above it the step is halved.
"""
HALVED_ABOVE = 600
"""Nodes above which the answer is followed on every other one, as the work goes with their cube. It
is a matter of time alone: the answer is the same, see LARGEST_MESH_DIFFERENCE.
"""
LARGEST_MESH_DIFFERENCE = 0.1
"""Part of the pressures, in the norm of their work, by which the answers on all nodes and on every
other one may differ. Of two meshes of one answer it is 0.004, of two answers 0.7: any number
between tells them apart, and too small a one costs time.
"""
RESOLUTION = 1e-12  # relative, of a limit where the answer turns back


class Sliding(NamedTuple):
    """A contact problem at every friction coefficient: `still` at mu = 0; A1 (n, n) and C1 (k, n)
    per mu.
    """

    still: Problem
    A1: Floats
    C1: Floats

    @classmethod
    def through(cls, still: Problem, other: Problem, friction: float = 1.0) -> "Sliding":
        """From the problems at mu = 0 and at another friction coefficient."""
        return cls(still, (other.A - still.A) / friction, (other.C - still.C) / friction)

    def at(self, friction: float) -> Problem:
        """The problem at a friction coefficient."""
        A, q, B, C, h = self.still
        return Problem(A + friction * self.A1, q, B, C + friction * self.C1, h)


class Limit(NamedTuple):
    """Where the answer that is followed from mu = 0 ends.

    `friction`: mu_lock, inf where there is none up to LARGEST_FRICTION; `bounded`: whether it turns back
    there at finite pressure, at a change of the contact set; else pressure grows without bound as
    1/(mu_lock - mu). `last`: the answer at the last friction coefficient that was `reached`; its
    contact set is that of the limit.
    """

    friction: float
    bounded: bool
    last: Contact
    reached: float
    steps: int


class PathEnded(NoAnswer):
    """The answer that is followed from mu = 0 ends before the friction that was asked for: at
    `end`.
    """

    def __init__(self, line: str, end: Limit) -> None:
        super().__init__(line)
        self.end = end


def limit(
    sliding: Sliding,
    most: float = LARGEST_FRICTION,
    known: tuple[float, Contact] | None = None,
    areas: Floats | None = None,
) -> Limit:
    """Follow the answer from mu = 0 to its end, or to mu = `most`.

    known: a friction coefficient and the answer there, which is followed on from; areas: see
    `answer`. Raises NoAnswer where there is no answer at mu = 0.
    """
    areas = _areas(sliding.still, areas)
    mu, found = (0.0, _without_friction(sliding.still)) if known is None else known
    steps = 0
    reach, critical, of = LARGEST_FRICTION_STEP, np.inf, np.zeros(0, dtype=bool)
    while mu < most:
        steps += 1
        target = min(mu + reach, most)
        after = _reached(sliding, target, found.active)
        if after is not None and (
            np.array_equal(after.active, found.active) or _quiet(after, found, areas)
        ):
            found, mu, reach = after, target, min(2 * reach, LARGEST_FRICTION_STEP * max(1.0, mu))
            continue
        if not np.array_equal(of, found.active):
            critical, of = next_eigenvalue(sliding, mu, found.active), found.active
            near = mu + (critical - mu) * (1 - POLE_DISTANCE)
            met = critical - mu < RESOLUTION * max(
                mu, 1e-3
            )  # the step before has met the pole itself
            if np.isfinite(critical) and (
                met or _reached(sliding, near, found.active, 1) is not None
            ):
                return Limit(critical, False, found, mu, steps)
        reach = 0.5 * (target - mu)
        if reach < RESOLUTION * max(mu, 1e-3):
            return Limit(mu, True, found, mu, steps)
    return Limit(np.inf, False, found, mu, steps)


def _without_friction(still: Problem, start: Bools | None = None) -> Contact:
    found = solve(still, start)
    if not found.regular:
        raise NoAnswer("no stable equilibrium without friction")
    return found


def answer(
    problem_at: Callable[[float], Problem],
    friction: float,
    start: Bools | None = None,
    areas: Floats | None = None,
    *,
    law: float,
    brake: str,
) -> Contact:
    """The answer at a friction coefficient: the one that is followed from mu = 0, which is unique
    there.

    Below the limit of the rigid shoe that is the stable one that settles at once from the contact
    set `start`, if from half of the friction on the contact force grows by less than LARGEST_FORCE_GROWTH of
    itself, as it does up to half of the limit; else it is followed in many small steps, from half
    of the friction on where the answer there is as quiet. Not any stable one, nor the one that
    wider gaps lead to: near the limit, where the contact grows fast, and beyond it some stand
    apart, reached by no friction that grows from 0.

    problem_at: the problem at a friction coefficient, linear in it; areas (n,): of the nodes [m^2],
    by which pressures make a force, 1 where they are forces already; law: mu_lock of the rigid
    shoe; brake: what there is an equilibrium of, in words. Of a HALVED_ABOVE problem the answer on every
    other node is followed, at a fraction of the cost; the one that settles at once from its contact
    set is taken where the two are LARGEST_MESH_DIFFERENCE each other. Raises Ended with both limits where the answer
    ends before that friction, and NoAnswer with another reason where friction is not to blame.
    """
    if friction == 0:
        return _without_friction(problem_at(0.0), start)
    problem = problem_at(friction)
    areas = _areas(problem, areas)
    if len(problem.q) > HALVED_ABOVE:
        like = _as_coarser(problem, problem_at(0.0), friction, start, areas, law)
        if like is not None:
            return like
    half = None
    try:
        found = settle(problem, start)
        stable = found.regular and friction < law
        reason = "self-locking, no stable equilibrium"
        if stable:
            half = settle(problem_at(0.5 * friction), found.active, like=found.system)
            if _quiet(found, half, areas):
                return found
    except NoAnswer as error:
        stable, reason = False, str(error)
    known = (
        (0.5 * friction, half)
        if half is not None and _sure(problem_at, 0.5 * friction, half, areas)
        else None
    )
    try:
        end = limit(Sliding.through(problem_at(0.0), problem_at(1.0)), friction, known, areas)
    except NoAnswer:  # none without friction: friction is not to blame
        if stable:
            return found
        raise NoAnswer(reason) from None
    if np.isinf(end.friction):
        return end.last
    raise PathEnded(locks(friction, end.friction, law=law, brake=brake), end)


def locks(friction: float, limit: float, *, law: float, brake: str) -> str:
    """The reason of a refusal at a friction coefficient beyond the limit; law, brake: as of
    `answer`.
    """
    return (
        f"self-locking, no equilibrium at friction {friction:g}; {brake} there is one up to "
        f"mu_lock = {limit:.4g} (rigid-shoe law: {law:.4g})"
    )


def _as_coarser(
    problem: Problem,
    still: Problem,
    friction: float,
    start: Bools | None,
    areas: Floats,
    law: float,
) -> Contact | None:
    """The stable answer that settles at once, where it is like the `answer` on every other node; or
    None.

    problem, still: at the friction coefficient and at 0; start: the contact set to settle from, by
    default the coarse answer's.
    """
    coarse = Sliding.through(halved(still), halved(problem), friction)
    try:
        like = answer(coarse.at, friction, None, halved_sums(areas), law=law, brake="")
        found = settle(problem, beside(like.p > 0, len(problem.q)) if start is None else start)
    except NoAnswer:
        return None
    off = between(like.p, len(found.p)) - found.p
    same = float(off @ (problem.A @ off)) < LARGEST_MESH_DIFFERENCE**2 * float(
        found.p @ (problem.A @ found.p)
    )
    return found if found.regular and same else None


def _sure(
    problem_at: Callable[[float], Problem], friction: float, found: Contact, areas: Floats
) -> bool:
    """Whether an answer at a friction coefficient, below the limit of the rigid shoe, is the one
    that is followed.
    """
    try:
        half = settle(problem_at(0.5 * friction), found.active, like=found.system)
        return found.regular and _quiet(found, half, areas)
    except NoAnswer:
        return False


def _quiet(found: Contact, before: Contact, areas: Floats) -> bool:
    """Whether the contact force has grown by less than LARGEST_FORCE_GROWTH since the answer at less friction.

    The force, not the sum of pressures: the contact moves along the lining as friction grows, and
    where it comes from wide columns to narrow ones more nodes press, and harder, under the same
    force.
    """
    return before.regular and float(areas @ found.p) <= (1 + LARGEST_FORCE_GROWTH) * float(
        areas @ before.p
    )


def _areas(problem: Problem, areas: Floats | None) -> Floats:
    return np.ones(len(problem.q)) if areas is None else areas


def next_eigenvalue(sliding: Sliding, friction: float, active: Bools) -> float:
    """The smallest mu above `friction` at which K0 + mu K1 of a contact set is singular; inf where
    there is none.

    With x of K(mu) G = K1 an eigenvalue gamma of G belongs to the singular friction mu - 1/gamma.
    """
    system = equilibrated(sliding.at(friction))
    on = np.flatnonzero(active)
    unknowns = np.flatnonzero(system.on(active))
    rows = np.vstack([sliding.A1[on][:, on], sliding.C1[:, on]])
    rows *= system.down[unknowns, None] * system.across[on]
    G = np.linalg.solve(system.K[unknowns[:, None], unknowns], rows)[: len(on)]
    gamma = np.linalg.eigvals(G)
    gamma = gamma[gamma.imag == 0].real
    falling = gamma[gamma < -1e-300]
    return float(friction - 1 / falling.min()) if len(falling) else np.inf


class Agreement(NamedTuple):
    """Where other first guesses of the contact set lead, against the answer followed from mu = 0.

    Of `starts`: `same`, those that end at it; `others`, at another answer that is `regular` too;
    `unstable`, at one that is not; `lost`, those that did not converge. `difference`: the largest
    one of pressure among `same`, relative to the largest pressure.
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
    """Solve a problem from each of the contact sets `starts` (n,), and compare with its `answer`."""
    counts, largest, scale = (
        dict.fromkeys(("same", "others", "unstable", "lost"), 0),
        0.0,
        np.abs(answer.p).max(),
    )
    for start in starts:
        try:
            found = solve(problem, start)
        except NoAnswer:
            counts["lost"] += 1
            continue
        difference = float(np.abs(found.p - answer.p).max() / scale)
        same = difference <= tolerance
        counts["same" if same else "others" if found.regular else "unstable"] += 1
        largest = max(largest, difference) if same else largest
    return Agreement(len(starts), **counts, difference=largest)


def first_singular(sliding: Sliding) -> float:
    """The smallest mu > 0 at which K0 + mu K1 is singular on any contact set, whether it is ever
    met or not; or inf.

    Below it all sets have a determinant of one sign, and every load and clearance has exactly one
    answer (a P-matrix where there are no free motions: Samelson, Thrall & Wesler 1958). All 2^n
    sets are tried: for small n only.
    """
    n, k = sliding.still.B.shape
    sets = ((np.arange(2**n)[:, None] >> np.arange(n)) & 1).astype(bool)
    smallest = np.inf
    for active in sets[sets.sum(axis=1) >= max(k, 1)]:
        with suppress(
            np.linalg.LinAlgError
        ):  # a set that leaves a motion free at every friction: never met
            smallest = min(smallest, next_eigenvalue(sliding, 0.0, active))
    return smallest


def _reached(sliding: Sliding, friction: float, start: Bools, most: int = 30) -> Contact | None:
    try:
        found = settle(sliding.at(friction), start, most)
    except NoAnswer:
        return None
    return found if found.regular else None
