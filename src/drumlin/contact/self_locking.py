"""Self-locking: the friction coefficient up to which sliding contact has an equilibrium.

In full slip the matrices of the contact problem grow linearly with the friction coefficient,

    A(mu) = A0 + mu A1,   C(mu) = C0 + mu C1.

On a contact set the pressures and rigid-body motions x solve K(mu) x = r. Here K = K0 + mu K1 is
the bordered matrix [[A, B], [C, 0]], and r holds gaps and loads. The pressures grow without bound
as mu approaches a value at which K is singular. Such a value is an eigenvalue of the matrix pencil
(K0, -K1); the smallest one above the present mu counts. The contact set changes as mu grows, and so
does this eigenvalue. The solution is therefore followed from mu = 0. The limit mu_lock is the
eigenvalue of a contact set that holds right up to the eigenvalue. Such a limit does not depend on
force or clearance, which are negligible beside pressures that grow without bound.

The path of solutions over mu may also end where it turns back: at a change of the contact set
beyond which the determinant has the other sign. Such an end depends on force and clearance: where a
small force presses few nodes of a lining with a wide clearance, there is an equilibrium at a
friction coefficient at which a larger force, which presses more nodes, has none. Beyond such an end
there may be other solutions, to which the contact would jump. A step of mu over which the contact
set changes must therefore be short: the contact force may grow by at most
LARGEST_CONTACT_FORCE_GROWTH_PER_STEP.
"""

from collections.abc import Callable
from contextlib import suppress
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Bools, Floats
from drumlin.base.errors import NoAnswer
from drumlin.contact.active_set import (
    ContactSolution,
    contact_problem_on_every_other_node,
    extend_contact_set_to_all_nodes,
    interpolate_pressures_to_all_nodes,
    restrict_array_to_every_other_node,
    solve_contact_by_block_pivoting,
    solve_contact_problem,
)
from drumlin.contact.equations import ContactProblem, scale_contact_problem

LARGEST_SOUGHT_SELF_LOCKING_FRICTION = 1e3
"""Friction coefficient up to which the limit of self-locking is sought.

A brake whose limit is higher counts as a brake that never locks.
"""

LARGEST_STEP_OF_GROWING_FRICTION = 0.05
"""Largest step of the friction coefficient mu while mu grows from 0 up to self-locking.

The contact is solved after each step. Above mu = 1 the step is relative to mu. The step affects the
computing time, not the result. A step over which the contact set changes is halved until the
contact force grows by less than LARGEST_CONTACT_FORCE_GROWTH_PER_STEP. While the contact set stays
the same, the limit is the mu at which the matrix of its equations is singular. On 30 brakes the
number of factorisations is 1.07 times as large with a step of 0.025, the same with a step of 0.1,
and 1.1 times as large with a step of 0.4.
"""

TEST_DISTANCE_BELOW_SINGULAR_FRICTION = 1e-8
"""Relative distance below a singular friction coefficient at which the contact set is tested.

At the singular friction the pressures of the contact set would be infinite. If the contact set
still holds at this distance below it, the brake locks itself there. The distance is far above
round-off.
"""

LARGEST_CONTACT_FORCE_GROWTH_PER_STEP = 0.5
"""Largest relative growth of the contact force over one step of the friction coefficient mu.

The contact force is the sum of pressures times areas and grows as 1/(mu_lock - mu). From mu/2 to mu
the force grows by at most (1 - 1/4)/(1 - 1/2) - 1 = 0.5 for any mu up to mu_lock/2. If the contact
set changes over a step and the force grows by more, the step is halved.
"""

NODES_ABOVE_WHICH_FRICTION_PATH_IS_COARSE = 600
"""Number of contact nodes above which only every other node is used while friction grows from 0.

The solution on all nodes is then found at once and compared with the solution on every other node.
The constant affects the computing time, which grows with the cube of the number of nodes. It does
not affect the solution, see LARGEST_PRESSURE_DIFFERENCE_OF_SAME_SOLUTION.
"""

LARGEST_PRESSURE_DIFFERENCE_OF_SAME_SOLUTION = 0.1
"""Relative difference up to which the pressures on two meshes count as the same solution.

One mesh has all contact nodes, the other one every other node. The difference and the pressures are
measured by the square root of their elastic work. In trials, the pressures of the same solution on
the two meshes differed by 0.004, and two different solutions by 0.7. Any number between tells them
apart; a smaller number costs time.
"""

RELATIVE_RESOLUTION_OF_FRICTION_LIMIT = 1e-12
"""Relative step of the friction coefficient mu below which the search for the friction limit ends.

The limit is then the mu at which the path of solutions over mu turns back.
"""

DISTANCE_OF_PRESSURE_COMPARISON = 1e-3
"""Relative distance below a self-locking limit at which the pressure is compared.

The peak pressure or the contact force at this distance is compared with that at twice this
distance. It is twice as large if it grows without bound as 1/(mu_lock - mu), and nearly the same if
it stays finite. The value is a judgement: near enough that the growth without bound is the largest
part of the pressure, and far above the resolution of limits that are found by repeated solves.
"""

LEAST_GROWTH_OF_UNBOUNDED_PRESSURE = 1.5
"""Growth of the peak pressure or of the contact force above which it counts as without bound.

It lies midway between the two growths that DISTANCE_OF_PRESSURE_COMPARISON states, 1 and 2.
"""


LARGEST_ROUND_OFF_BETWEEN_EQUAL_PROBLEMS = 1e-13
"""Largest difference of two contact problems that counts as round-off.

It is relative to the largest value of each matrix or vector. Two shoes that a rotation of the brake
carries into each other differ by 2e-15; the smallest change that a user makes is far larger.
"""


class FrictionDependentProblem(NamedTuple):
    """A contact problem as a linear function of the friction coefficient mu.

    `frictionless` is the problem at mu = 0. `A_per_friction` (n, n) and `C_per_friction` (k, n) are
    the changes of A and C per mu.
    """

    frictionless: ContactProblem
    A_per_friction: Floats
    C_per_friction: Floats

    @classmethod
    def linear_function_of_friction_from_two_problems(
        cls, frictionless: ContactProblem, other: ContactProblem, friction: float = 1.0
    ) -> "FrictionDependentProblem":
        """Make the linear function of mu from the problems at mu = 0 and at another friction."""
        return cls(
            frictionless,
            (other.A - frictionless.A) / friction,
            (other.C - frictionless.C) / friction,
        )

    def is_equal_up_to_round_off(self, other: "FrictionDependentProblem") -> bool:
        """Whether another problem differs from this problem by round-off alone."""
        ours = (*self.frictionless, self.A_per_friction, self.C_per_friction)
        theirs = (*other.frictionless, other.A_per_friction, other.C_per_friction)
        return all(
            a.shape == b.shape
            and np.abs(a - b).max(initial=0.0)
            <= LARGEST_ROUND_OFF_BETWEEN_EQUAL_PROBLEMS * np.abs(a).max(initial=0.0)
            for a, b in zip(ours, theirs, strict=True)
        )

    def contact_problem_at_friction_coefficient(self, friction: float) -> ContactProblem:
        """The contact problem at a friction coefficient."""
        A, q, B, C, h = self.frictionless
        return ContactProblem(
            A + friction * self.A_per_friction, q, B, C + friction * self.C_per_friction, h
        )


class LargestFrictionWithEquilibrium(NamedTuple):
    """The friction coefficient mu up to which a contact has an equilibrium, as mu grows from 0.

    Attributes
    ----------
    friction : mu_lock; inf if the search found no limit up to its largest friction
    pressure_stays_finite : whether the path of solutions turns back at finite pressure, at a change
        of the contact set; otherwise the pressure grows without bound as 1/(mu_lock - mu)
    last_contact : the solution at the friction coefficient `last_friction`, with the contact set of
        the limit
    last_friction : last friction coefficient that was solved
    steps : number of increases of the friction coefficient that were tried
    """

    friction: float
    pressure_stays_finite: bool
    last_contact: ContactSolution
    last_friction: float
    steps: int


class FrictionBeyondSelfLockingError(NoAnswer):
    """The error that a friction coefficient is beyond the limit of self-locking.

    `limit` tells at which friction coefficient the solution ends as friction grows from 0.
    """

    def __init__(self, line: str, limit: LargestFrictionWithEquilibrium) -> None:
        super().__init__(line)
        self.limit = limit


def find_largest_friction_with_equilibrium(
    problem: FrictionDependentProblem,
    largest_friction: float = LARGEST_SOUGHT_SELF_LOCKING_FRICTION,
    known_answer: tuple[float, ContactSolution] | None = None,
    areas: Floats | None = None,
) -> LargestFrictionWithEquilibrium:
    """Find the friction coefficient mu up to which a contact has an equilibrium.

    The contact is solved again and again while mu grows in steps from 0. The search ends where a
    step has no stable solution that continues the solution before the step.

    Parameters
    ----------
    problem : the contact problem as a linear function of the friction coefficient
    largest_friction : friction coefficient at which the search ends without a limit
    known_answer : a friction coefficient and its solution, from which the search starts in place of
        mu = 0
    areas : areas (n,) of the nodes [m^2]; by default 1, see
        `solve_contact_reached_from_zero_friction`

    Raises
    ------
    NoAnswer
        if there is no solution at mu = 0
    """
    areas = _contact_node_areas_or_ones(problem.frictionless, areas)
    mu, found = (
        (0.0, _solve_contact_without_friction(problem.frictionless))
        if known_answer is None
        else known_answer
    )
    steps, step = 0, LARGEST_STEP_OF_GROWING_FRICTION
    critical_set, has_failed_before = np.zeros(0, dtype=bool), False
    while mu < largest_friction:
        steps += 1
        target = min(mu + step, largest_friction)
        after = stable_contact_continued_to_higher_friction_or_none(problem, target, found, areas)
        if after is not None:
            step = min(2 * step, LARGEST_STEP_OF_GROWING_FRICTION * max(1.0, mu))
            found, mu, has_failed_before = after, target, False
            continue
        # The step has failed. If the contact set holds up to the next friction at which its
        # equations are singular, this friction is the limit. Otherwise the step is halved. The
        # singular friction takes the time of some ten steps. It is therefore computed only after
        # the second failure in a row: if half of the failed step succeeds, the path goes on.
        if has_failed_before and not np.array_equal(critical_set, found.active):
            try:
                critical = next_friction_with_singular_contact_equations(problem, mu, found.active)
            except np.linalg.LinAlgError:
                # The present mu is itself the friction at which the equations are singular.
                critical = mu
            critical_set = found.active
            if _is_contact_set_valid_up_to_singular_friction(problem, mu, critical, found.active):
                return LargestFrictionWithEquilibrium(critical, False, found, mu, steps)
        has_failed_before = True
        step = 0.5 * (target - mu)
        if step < RELATIVE_RESOLUTION_OF_FRICTION_LIMIT * max(mu, 1e-3):
            grows = _does_contact_force_grow_without_bound_towards(problem, mu, found.active, areas)
            return LargestFrictionWithEquilibrium(mu, not grows, found, mu, steps)
    return LargestFrictionWithEquilibrium(np.inf, False, found, mu, steps)


def _does_contact_force_grow_without_bound_towards(
    problem: FrictionDependentProblem, limit: float, active: Bools, areas: Floats
) -> bool:
    """Whether the contact force grows towards a limit of friction as towards an infinite force.

    On a mesh the contact grows by whole nodes. As the pressure grows without bound, the next node
    may close a little before the pressure would be infinite, and the path of solutions turns back
    there. Without elements there is no turning back. The contact forces a little below the limit
    therefore decide, see DISTANCE_OF_PRESSURE_COMPARISON.

    Parameters
    ----------
    problem : the contact problem as a linear function of the friction coefficient
    limit : the friction coefficient at which the path turns back
    active : the contact set (n,) there
    areas : areas (n,) of the nodes [m^2]
    """
    forces = []
    for steps in (2, 1):
        friction = limit * (1 - steps * DISTANCE_OF_PRESSURE_COMPARISON)
        contact = _find_stable_contact_or_none(problem, friction, active)
        if contact is None:
            return False
        forces.append(float(areas @ contact.p))
    far, near = forces
    return near > LEAST_GROWTH_OF_UNBOUNDED_PRESSURE * far


def stable_contact_continued_to_higher_friction_or_none(
    problem: FrictionDependentProblem, friction: float, before: ContactSolution, areas: Floats
) -> ContactSolution | None:
    """The stable solution at a higher friction that continues the solution `before`, or None.

    Parameters
    ----------
    problem : the contact problem as a linear function of the friction coefficient
    friction : the higher friction coefficient mu
    before : solution at the lower friction
    areas : areas (n,) of the nodes [m^2]
    """
    after = _find_stable_contact_or_none(problem, friction, before.active)
    if after is None or not _does_solution_continue_at_higher_friction(after, before, areas):
        return None
    return after


def is_equilibrium_certain_up_to_friction(
    problem_at: Callable[[float], ContactProblem],
    before: ContactSolution,
    friction: float,
    areas: Floats,
) -> bool:
    """Whether a contact certainly has an equilibrium from a smaller friction up to `friction`.

    The result is True if the solution at `friction` is stable and its contact force is larger by at
    most LARGEST_CONTACT_FORCE_GROWTH_PER_STEP. If the result is False, only small steps of friction
    can tell whether there is an equilibrium.

    Parameters
    ----------
    problem_at : function that returns the problem at mu; the problem is linear in mu
    before : solution at the smaller friction
    friction : friction coefficient mu
    areas : areas (n,) of the nodes [m^2]
    """
    try:
        found = solve_contact_by_block_pivoting(problem_at(friction), before.active)
    except NoAnswer:
        return False
    return bool(found.stable) and _is_growth_of_contact_force_small(found, before, areas)


def _does_solution_continue_at_higher_friction(
    after: ContactSolution, before: ContactSolution, areas: Floats
) -> bool:
    """Whether a solution continues the solution at the last, smaller friction coefficient.

    The solution continues if the same nodes touch, or if the contact force grows by at most
    LARGEST_CONTACT_FORCE_GROWTH_PER_STEP.
    """
    return np.array_equal(after.active, before.active) or _is_growth_of_contact_force_small(
        after, before, areas
    )


def _is_contact_set_valid_up_to_singular_friction(
    problem: FrictionDependentProblem, mu: float, singular_friction: float, active: Bools
) -> bool:
    """Whether a contact set (n,) that holds at mu also holds just below its singular friction.

    At the friction coefficient `singular_friction` the pressures of the contact set are infinite.
    """
    if not np.isfinite(singular_friction):
        return False
    # The present mu may itself be the friction at which the equations are singular.
    if singular_friction - mu < RELATIVE_RESOLUTION_OF_FRICTION_LIMIT * max(mu, 1e-3):
        return True
    near = mu + (singular_friction - mu) * (1 - TEST_DISTANCE_BELOW_SINGULAR_FRICTION)
    return _find_stable_contact_or_none(problem, near, active, 1) is not None


def _solve_contact_without_friction(
    frictionless: ContactProblem, start: Bools | None = None
) -> ContactSolution:
    """Solve the contact problem at mu = 0. Raises NoAnswer if its solution is unstable."""
    found = solve_contact_problem(frictionless, start)
    if not found.stable:
        raise NoAnswer("no stable equilibrium without friction")
    return found


class _ContactSolvedDirectlyAtFriction(NamedTuple):
    """A solution at a friction coefficient, found directly and not by following growing friction.

    Attributes
    ----------
    contact : the solution; None if no contact set converges
    contact_at_half_friction : the solution at half of the friction; None if unknown
    stable : whether `contact` is stable and mu is below the limit of the rigid shoe
    is_reached_from_zero_friction : whether `contact` is certainly the solution that growing
        friction would reach from mu = 0
    refusal : the reason to refuse `contact` if `contact` is not stable
    """

    contact: ContactSolution | None
    contact_at_half_friction: ContactSolution | None
    stable: bool
    is_reached_from_zero_friction: bool
    refusal: str


def solve_contact_reached_from_zero_friction(
    problem_at: Callable[[float], ContactProblem],
    friction: float,
    start: Bools | None = None,
    areas: Floats | None = None,
    *,
    rigid_law_limit: float,
    brake_words: str,
) -> ContactSolution:
    """Find the contact that is reached as friction grows from 0 to a friction coefficient.

    The contact problem is first solved directly at this friction. The solution is taken if it is
    stable, if the friction is below the limit of the rigid shoe, and if the contact force grows by
    at most LARGEST_CONTACT_FORCE_GROWTH_PER_STEP from half of the friction on. Up to half of
    mu_lock all three conditions hold. If one of them does not hold, the solution is followed in
    small steps of friction, from mu = 0 or, if the solution at half of the friction is certain,
    from there. Other stable solutions do not count: near mu_lock and beyond it there are stable
    solutions that friction never reaches as it grows from 0. Above
    NODES_ABOVE_WHICH_FRICTION_PATH_IS_COARSE nodes the solution on every other node is followed, at
    a fraction of the cost.

    Parameters
    ----------
    problem_at : function that returns the problem at mu; the problem is linear in mu
    friction : friction coefficient mu
    start : contact set (n,) from which the direct solution starts
    areas : areas (n,) [m^2] of the nodes, which turn pressures into forces; by default 1, for
        pressures that are forces already
    rigid_law_limit : mu_lock of the rigid shoe
    brake_words : words for the brake in the message of a refusal

    Raises
    ------
    FrictionBeyondSelfLockingError
        if the brake locks itself below this friction; the message states mu_lock of the brake and
        of the rigid shoe
    NoAnswer
        if there is no solution for another reason
    """
    if friction == 0:
        return _solve_contact_without_friction(problem_at(0.0), start)
    problem = problem_at(friction)
    areas = _contact_node_areas_or_ones(problem, areas)
    # First the contact is solved directly. With many nodes the direct solution starts from the
    # contact set of the coarse problem, on every other node, and is checked by it.
    if len(problem.q) > NODES_ABOVE_WHICH_FRICTION_PATH_IS_COARSE:
        like = _solve_contact_and_check_on_every_other_node(
            problem, problem_at(0.0), friction, start, areas, rigid_law_limit
        )
        if like is not None:
            return like
    at_once = _solve_contact_directly_at_friction(
        problem_at, problem, friction, start, areas, rigid_law_limit
    )
    if at_once.is_reached_from_zero_friction and at_once.contact is not None:
        return at_once.contact
    # If the direct solution is not certain, the contact is followed in steps of growing friction.
    try:
        end = _follow_contact_up_to_friction(problem_at, friction, at_once, areas)
    except NoAnswer:
        # The contact has no stable solution at mu = 0 either, so that the friction is not beyond a
        # self-locking limit. A stable direct solution then counts.
        if at_once.stable and at_once.contact is not None:
            return at_once.contact
        raise NoAnswer(at_once.refusal) from None
    if np.isinf(end.friction):
        return end.last_contact
    text = self_locking_error_text(
        friction, end.friction, rigid_law_limit=rigid_law_limit, brake_words=brake_words
    )
    raise FrictionBeyondSelfLockingError(text, end)


def _follow_contact_up_to_friction(
    problem_at: Callable[[float], ContactProblem],
    friction: float,
    at_once: _ContactSolvedDirectlyAtFriction,
    areas: Floats,
) -> LargestFrictionWithEquilibrium:
    """Follow the contact in steps of growing friction up to a friction coefficient.

    The steps begin at half of the friction if the direct solution there is certain, and at mu = 0
    otherwise. The friction of the result is inf if the contact exists up to `friction`.

    Parameters
    ----------
    problem_at, friction, areas : as in `solve_contact_reached_from_zero_friction`
    at_once : the direct solution
    """
    known = None
    half = at_once.contact_at_half_friction
    if half is not None and _is_contact_reached_from_zero_friction(
        problem_at, 0.5 * friction, half, areas
    ):
        known = (0.5 * friction, half)
    problem = FrictionDependentProblem.linear_function_of_friction_from_two_problems(
        problem_at(0.0), problem_at(1.0)
    )
    return find_largest_friction_with_equilibrium(problem, friction, known, areas)


def _solve_contact_directly_at_friction(
    problem_at: Callable[[float], ContactProblem],
    problem: ContactProblem,
    friction: float,
    start: Bools | None,
    areas: Floats,
    rigid_law_limit: float,
) -> _ContactSolvedDirectlyAtFriction:
    """Solve the contact at a friction coefficient directly, without steps of growing friction.

    The contact at half of the friction is solved too. If the contact force grows by little from
    half of the friction on, growing friction certainly reaches the solution. `problem` is the
    problem at `friction`. The other parameters are those of
    `solve_contact_reached_from_zero_friction`.
    """
    found = half = None
    try:
        found = solve_contact_by_block_pivoting(problem, start)
        if not (found.stable and friction < rigid_law_limit):
            return _ContactSolvedDirectlyAtFriction(
                found, None, False, False, "self-locking, no stable equilibrium"
            )
        half = solve_contact_by_block_pivoting(
            problem_at(0.5 * friction), found.active, scales_of=found.system
        )
        sure = _is_growth_of_contact_force_small(found, half, areas)
    except NoAnswer as error:
        return _ContactSolvedDirectlyAtFriction(found, half, False, False, str(error))
    return _ContactSolvedDirectlyAtFriction(
        found, half, True, sure, "self-locking, no stable equilibrium"
    )


def self_locking_error_text(
    friction: float, limit: float, *, rigid_law_limit: float, brake_words: str
) -> str:
    """Return the text that refuses a friction coefficient beyond the limit of self-locking.

    Parameters
    ----------
    friction : the refused friction coefficient
    limit : mu_lock of the brake
    rigid_law_limit : mu_lock of the rigid shoe
    brake_words : words for the brake
    """
    # The limit has four digits, or the least number of digits that tells it from the friction.
    for digits in range(4, 13):
        refused, largest = f"{friction:.{max(digits, 6)}g}", f"{limit:.{digits}g}"
        if float(largest) < float(refused):
            break
    return (
        f"self-locking, no equilibrium at friction {refused}; {brake_words} there is one up to "
        f"mu_lock = {largest} (rigid-shoe law: {rigid_law_limit:.4g})"
    )


def _solve_contact_and_check_on_every_other_node(
    problem: ContactProblem,
    frictionless: ContactProblem,
    friction: float,
    start: Bools | None,
    areas: Floats,
    rigid_law_limit: float,
) -> ContactSolution | None:
    """Solve the contact on all nodes directly, and check it by the solution on every other node.

    The solution on every other node, the coarse solution, is computed in steps of friction that
    grow from 0.

    Parameters
    ----------
    problem, frictionless : the problems at the friction coefficient and at mu = 0
    friction, areas, rigid_law_limit : parameters of `solve_contact_reached_from_zero_friction`
    start : contact set (n,) of the first step; by default the contact set of the coarse solution

    Returns
    -------
    the solution on all nodes; None if it differs from the coarse solution, is unstable or does not
    converge
    """
    coarse = FrictionDependentProblem.linear_function_of_friction_from_two_problems(
        contact_problem_on_every_other_node(frictionless),
        contact_problem_on_every_other_node(problem),
        friction,
    )
    try:
        like = solve_contact_reached_from_zero_friction(
            coarse.contact_problem_at_friction_coefficient,
            friction,
            None,
            restrict_array_to_every_other_node(areas),
            rigid_law_limit=rigid_law_limit,
            brake_words="",
        )
        first = (
            extend_contact_set_to_all_nodes(like.p > 0, len(problem.q)) if start is None else start
        )
        found = solve_contact_by_block_pivoting(problem, first)
    except NoAnswer:
        return None
    # The two solutions count as the same if the elastic work of their difference is small.
    off = interpolate_pressures_to_all_nodes(like.p, len(found.p)) - found.p
    work_off = float(off @ (problem.A @ off))
    work = float(found.p @ (problem.A @ found.p))
    same = work_off < LARGEST_PRESSURE_DIFFERENCE_OF_SAME_SOLUTION**2 * work
    return found if found.stable and same else None


def _is_contact_reached_from_zero_friction(
    problem_at: Callable[[float], ContactProblem],
    friction: float,
    found: ContactSolution,
    areas: Floats,
) -> bool:
    """Whether friction that grows from mu = 0 certainly leads to a solution `found`.

    The solution must be stable, and the contact force must grow by little from half of the friction
    on. The function assumes that the friction is below the limit of the rigid shoe.
    """
    try:
        half = solve_contact_by_block_pivoting(
            problem_at(0.5 * friction), found.active, scales_of=found.system
        )
        return found.stable and _is_growth_of_contact_force_small(found, half, areas)
    except NoAnswer:
        return False


def _is_growth_of_contact_force_small(
    found: ContactSolution, before: ContactSolution, areas: Floats
) -> bool:
    """Whether the contact force grows little from an earlier solution.

    The limit is LARGEST_CONTACT_FORCE_GROWTH_PER_STEP.

    `before` is the earlier solution, which must be stable. The contact force is the sum of
    pressures times areas (n,).
    """
    # The sum of the pressures without areas would not measure the force: as friction grows, the
    # contact moves along the lining, and where elements are shorter, more nodes press under the
    # same force.
    force, force_before = float(areas @ found.p), float(areas @ before.p)
    return before.stable and force <= (1 + LARGEST_CONTACT_FORCE_GROWTH_PER_STEP) * force_before


def _contact_node_areas_or_ones(problem: ContactProblem, areas: Floats | None) -> Floats:
    """The areas (n,) of the nodes, or 1 for each node if `areas` is None."""
    return np.ones(len(problem.q)) if areas is None else areas


def next_friction_with_singular_contact_equations(
    problem: FrictionDependentProblem, friction: float, active: Bools
) -> float:
    """Return the smallest friction above `friction` at which a contact set (n,) has no solution.

    At this friction coefficient the matrix K(mu) = K0 + mu K1 of the equations of the contact set
    `active` is singular. The result is inf if there is no such mu. With K(mu) G = K1, each
    eigenvalue gamma of G gives the singular friction mu - 1/gamma. Raises numpy's LinAlgError where
    K is singular at `friction` itself.
    """
    system = scale_contact_problem(problem.contact_problem_at_friction_coefficient(friction))
    nodes = np.flatnonzero(active)
    unknowns = np.flatnonzero(system.mask_of_unknowns_of_contact_set(active))
    # K1 has columns for pressures only, because B does not depend on friction.
    K1 = np.vstack([problem.A_per_friction[nodes][:, nodes], problem.C_per_friction[:, nodes]])
    K1 *= system.row_scales[unknowns, None] * system.column_scales[nodes]
    G = np.linalg.solve(system.K[unknowns[:, None], unknowns], K1)[: len(nodes)]
    gamma = np.linalg.eigvals(G)
    gamma = gamma[gamma.imag == 0].real
    # gamma are the eigenvalues of K(mu)^-1 K1. Each negative gamma gives a friction mu - 1/gamma
    # above the present mu at which the equations are singular. A gamma next to 0 stands for an
    # infinite friction.
    falling = gamma[gamma < -1e-300]
    return float(friction - 1 / falling.min()) if len(falling) else np.inf


class SolutionCountsFromStartingContactSets(NamedTuple):
    """Counts of the solutions that the active-set method finds from several first contact sets.

    Attributes
    ----------
    number_of_start_sets : number of first contact sets
    sets_with_known_solution : number of first sets that lead to the known solution, which friction
        growing from 0 reaches
    sets_with_other_stable_solution : number of first sets that lead to another stable solution
    sets_with_unstable_solution : number of first sets that lead to an unstable solution
    sets_without_convergence : number of first sets from which the method does not converge
    largest_pressure_difference : largest difference of pressure among `sets_with_known_solution`,
        relative to the largest pressure
    """

    number_of_start_sets: int
    sets_with_known_solution: int
    sets_with_other_stable_solution: int
    sets_with_unstable_solution: int
    sets_without_convergence: int
    largest_pressure_difference: float


def compare_solutions_from_starting_contact_sets(
    problem: ContactProblem, answer: ContactSolution, starts: list[Bools], tolerance: float = 1e-6
) -> SolutionCountsFromStartingContactSets:
    """Solve a contact problem from several first contact sets, and compare the solutions.

    Returns how many of the first sets lead to the known solution, and how many to others.

    Parameters
    ----------
    problem : contact problem of n nodes
    answer : the known solution of the problem, which friction growing from 0 reaches
    starts : first contact sets (n,)
    tolerance : difference of pressure, relative to the largest pressure, up to which two solutions
        count as the same
    """
    counts = dict.fromkeys(
        (
            "sets_with_known_solution",
            "sets_with_other_stable_solution",
            "sets_with_unstable_solution",
            "sets_without_convergence",
        ),
        0,
    )
    largest, scale = 0.0, np.abs(answer.p).max()
    for start in starts:
        try:
            found = solve_contact_problem(problem, start)
        except NoAnswer:
            counts["sets_without_convergence"] += 1
            continue
        difference = float(np.abs(found.p - answer.p).max() / scale)
        if difference <= tolerance:
            counts["sets_with_known_solution"] += 1
            largest = max(largest, difference)
        else:
            kind = "other_stable" if found.stable else "unstable"
            counts[f"sets_with_{kind}_solution"] += 1
    return SolutionCountsFromStartingContactSets(
        len(starts), **counts, largest_pressure_difference=largest
    )


def smallest_friction_that_makes_any_contact_set_singular(
    problem: FrictionDependentProblem,
) -> float:
    """Return the smallest mu > 0 at which K0 + mu K1 is singular on any contact set, or inf.

    Below this friction the determinants of all contact sets have the same sign, and every load and
    clearance has exactly one solution (without rigid-body modes the matrix A is a P-matrix:
    Samelson, Thrall & Wesler 1958). The singular contact set need not occur in the brake. All 2^n
    contact sets are tried, so that the number n of nodes must be small.
    """
    n, k = problem.frictionless.B.shape
    sets = ((np.arange(2**n)[:, None] >> np.arange(n)) & 1).astype(bool)
    smallest = np.inf
    for active in sets[sets.sum(axis=1) >= max(k, 1)]:
        # The matrix of a contact set that leaves a rigid-body mode free is singular at any
        # friction. No solution has such a set, so that the error is ignored.
        with suppress(np.linalg.LinAlgError):
            smallest = min(
                smallest, next_friction_with_singular_contact_equations(problem, 0.0, active)
            )
    return smallest


def _find_stable_contact_or_none(
    problem: FrictionDependentProblem, friction: float, start: Bools, most_steps: int = 30
) -> ContactSolution | None:
    """Return the stable solution at a friction coefficient, or None if the method finds none.

    The active-set method starts from the contact set `start` (n,) and takes at most `most_steps`
    steps.
    """
    try:
        found = solve_contact_by_block_pivoting(
            problem.contact_problem_at_friction_coefficient(friction), start, most_steps
        )
    except NoAnswer:
        return None
    return found if found.stable else None
