"""Contact in full slip with a friction coefficient mu(p) that depends on the pressure.

The friction stress tau(p) = mu(p) p takes the place of mu p in the contact problem,

    w = q + A0 p + A1 tau(p) + B y,    C0 p + C1 tau(p) = h,    p >= 0,  w >= 0,  p w = 0.

A0 and C0 are the matrices A and C of `ContactProblem` without friction. A1 and C1 are the changes
of A and C per friction coefficient: A1 tau are the changes of the weighted gaps by friction.

Newton's method replaces tau by its tangent tau(p_0) + tau'(p_0) (p - p_0) at the last pressures
p_0. The next pressures then solve a contact problem with a friction coefficient tau' = mu + mu' p
for each node, and with other gaps and forces (a sequence of linear complementarity problems:
Josephy 1979). The error of the next step is about the square of the error of the present one.

If the steps do not converge, the friction law is changed in several parts, from a constant friction
coefficient with a known solution to mu(p).

A brake with this friction locks itself if mu(p) is raised by a large enough factor at all pressures
alike. The solution is followed as the factor grows from 1, in steps over which the contact force
grows by little. The path ends where the pressures grow without bound, or where two solutions meet.
"""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.base.errors import NoAnswer
from drumlin.base.texts import number_as_text
from drumlin.contact.active_set import ContactSolution, solve_contact_problem
from drumlin.contact.equations import ContactProblem
from drumlin.contact.self_locking import (
    LARGEST_CONTACT_FORCE_GROWTH_PER_STEP,
    LARGEST_STEP_OF_GROWING_FRICTION,
    TEST_DISTANCE_BELOW_SINGULAR_FRICTION,
    FrictionDependentProblem,
)
from drumlin.contact.stick_slip import (
    BACKWARD,
    FORWARD,
    StickSlipIncrementSolution,
    StickSlipProblem,
    TractionsAndSlipsOfLastIncrement,
    solve_stick_slip_load_increment,
)

NEWTON_TOLERANCE_OF_CONTACT_PRESSURES = 1e-10
"""Largest change of a pressure in the last step of Newton's method, relative to the peak pressure.

The error of the last step is about the square of its change. The value is the accuracy that is
stated for friction that depends on the pressure.
"""

LARGEST_ROUND_OFF_OF_CONTACT_PRESSURES = 1e-8
"""Largest change of a pressure, relative to the peak, that may be round-off of Newton's method.

Changes below this limit that no longer fall from step to step are round-off. On mesh files with
thin elements they are some 1e-9. Newton's method itself would fall from 1e-8 to 1e-16 in one step.
"""

MAX_NEWTON_STEPS_PER_FRICTION_CHANGE = 20
"""Largest number of steps of Newton's method before the change of the friction law is halved.

The law goes from constant friction to friction that depends on the pressure. Brakes need some
five steps for the whole change. If more are needed, only half of the change is tried.
"""

SMALLEST_ADDED_PART_OF_PRESSURE_DEPENDENCE = 1 / 64
"""Smallest part of the friction's dependence on pressure that is added at once (1: all of it).

If a part fails, half of it is tried. If this half is smaller than the limit, the brake is refused.
The value is a judgement; a smaller one makes a refusal slower.
"""


class NodalFrictionAndSlope(NamedTuple):
    """The friction coefficient (n,) of each node, and its derivative (n,) by the pressure."""

    coefficient: Floats
    slope: Floats


FunctionOfNodalFrictionByPressures = Callable[[Floats], NodalFrictionAndSlope]
"""A function that takes nodal pressures (n,) and returns the friction at the nodes."""


class FrictionFactorLimit(NamedTuple):
    """The factor on all friction coefficients up to which a contact has an equilibrium.

    Attributes
    ----------
    factor : the factor; inf if the search found no limit
    pressure_stays_finite : whether two solutions meet at the limit at finite pressures; False if
        the pressures grow without bound, or if there is no limit
    """

    factor: float
    pressure_stays_finite: bool


def find_largest_friction_factor_with_equilibrium(
    problem: FrictionDependentProblem,
    friction: FunctionOfNodalFrictionByPressures,
    start: ContactSolution,
    largest_factor: float,
    areas: Floats,
) -> FrictionFactorLimit:
    """Find the factor on friction that depends on pressure up to which there is an equilibrium.

    Parameters
    ----------
    problem : the contact problem as a linear function of the friction coefficient
    friction : function that returns the friction at nodal pressures, for the factor 1
    start : solution at the factor 1
    largest_factor : factor at which the search ends without a limit
    areas : areas (n,) of the nodes, which turn pressures into forces
    """
    factor, found, step = 1.0, start, LARGEST_STEP_OF_GROWING_FRICTION
    while factor < largest_factor:
        target = min(factor + step, largest_factor)
        after = _continued_to_friction_factor_or_none(problem, friction, target, found, areas)
        if after is not None:
            found, factor = after, target
            step = min(2 * step, LARGEST_STEP_OF_GROWING_FRICTION * factor)
            continue
        step = 0.5 * (target - factor)
        if step < TEST_DISTANCE_BELOW_SINGULAR_FRICTION * factor:
            # Beyond the last pressure of the friction table the coefficient is constant. If the
            # pressures grow without bound, all of them lie there, and the slopes are 0.
            slopes = friction(found.p).slope[found.active]
            return FrictionFactorLimit(factor, bool(slopes.any()))
    return FrictionFactorLimit(np.inf, False)


def is_equilibrium_certain_up_to_friction_factor(
    problem: FrictionDependentProblem,
    friction: FunctionOfNodalFrictionByPressures,
    start: ContactSolution,
    factor: float,
    areas: Floats,
) -> bool:
    """Whether a single step of the factor on friction proves an equilibrium up to `factor`.

    The result is True if the solution at `factor` is stable and the contact force grows by at most
    LARGEST_CONTACT_FORCE_GROWTH_PER_STEP from the factor 1 on. The other parameters are those of
    `find_largest_friction_factor_with_equilibrium`.
    """
    return (
        _continued_to_friction_factor_or_none(problem, friction, factor, start, areas) is not None
    )


def _continued_to_friction_factor_or_none(
    problem: FrictionDependentProblem,
    friction: FunctionOfNodalFrictionByPressures,
    factor: float,
    before: ContactSolution,
    areas: Floats,
) -> ContactSolution | None:
    """The stable solution at a factor on friction that continues a solution `before`, or None.

    The contact force may grow by at most LARGEST_CONTACT_FORCE_GROWTH_PER_STEP.
    """

    def raised_friction(p: Floats) -> NodalFrictionAndSlope:
        """The friction of the nodes at pressures p, times the factor."""
        whole = friction(p)
        return NodalFrictionAndSlope(factor * whole.coefficient, factor * whole.slope)

    after = _stable_contact_by_newton_or_none(problem, raised_friction, before)
    if after is None:
        return None
    growth = float(areas @ after.p) / float(areas @ before.p)
    return after if growth <= 1 + LARGEST_CONTACT_FORCE_GROWTH_PER_STEP else None


def solve_stick_slip_increment_with_pressure_dependent_friction(
    problem: StickSlipProblem,
    friction: FunctionOfNodalFrictionByPressures,
    history: TractionsAndSlipsOfLastIncrement,
    start: Ints,
    p: Floats,
) -> StickSlipIncrementSolution:
    """Solve a load increment of contact that sticks and slips, whose friction depends on pressure.

    Each step of Newton's method replaces the friction stress mu(p) p of a slipping node by its
    tangent at the last pressures. The unknown traction is then counted from the tangent's stress at
    the pressure 0. For a sticking node, and for a node whose tangent falls with the pressure, the
    largest traction is the pressure times the friction coefficient at the last pressures.

    Parameters
    ----------
    problem : the equations of n nodes
    friction : function that returns the friction at nodal pressures
    history : tractions and slips of the last increment
    start : states (n,) from which Newton's method starts
    p : pressures (n,) from which Newton's method starts

    Raises
    ------
    NoAnswer
        if there is no solution, or if friction and pressures do not come to agree
    """
    state, last_change = start, math.inf
    for _ in range(MAX_NEWTON_STEPS_PER_FRICTION_CHANGE):
        at = friction(p)
        tangent = at.coefficient + at.slope * p
        sense = np.where(state == FORWARD, 1.0, 0.0) - np.where(state == BACKWARD, 1.0, 0.0)
        sense[tangent <= 0] = 0.0
        apart = -sense * at.slope * p**2
        moved = problem._replace(
            q_w=problem.q_w + problem.A_wt @ apart,
            q_s=problem.q_s + problem.A_st @ apart,
            h=problem.h - problem.C_t @ apart,
        )
        found = solve_stick_slip_load_increment(
            moved,
            np.where(sense == 0, at.coefficient, tangent),
            TractionsAndSlipsOfLastIncrement(history.t - apart, history.s),
            state,
        )
        change = largest_change_relative_to_peak(found.p, p)
        settled = np.array_equal(found.state, state) and is_newton_change_negligible(
            change, last_change
        )
        p, state, last_change = found.p, found.state, change
        if settled:
            return replace(found, t=found.t + apart)
    raise NoAnswer("friction and pressure do not agree, not converged")


def solve_contact_with_pressure_dependent_friction(
    problem: FrictionDependentProblem,
    friction: FunctionOfNodalFrictionByPressures,
    start: ContactSolution,
    base: Floats,
) -> ContactSolution:
    """Solve a contact problem whose friction depends on the pressure, and return its solution.

    Parameters
    ----------
    problem : the contact problem as a linear function of the friction coefficient
    friction : function that returns the friction at nodal pressures
    start : solution with the friction coefficients `base`
    base : constant friction coefficients (n,) of the nodes, independent of the pressure

    Raises
    ------
    NoAnswer
        if no stable solution is found
    """
    found, reached, part = start, 0.0, 1.0
    while reached < 1:
        target = min(reached + part, 1.0)

        def friction_with_scaled_pressure_dependence(
            p: Floats, share: float = target
        ) -> NodalFrictionAndSlope:
            """The friction at pressures p, with a fraction `share` of its dependence on p."""
            whole = friction(p)
            return NodalFrictionAndSlope(
                base + share * (whole.coefficient - base), share * whole.slope
            )

        after = _stable_contact_by_newton_or_none(
            problem, friction_with_scaled_pressure_dependence, found
        )
        if after is not None:
            found, reached = after, target
            continue
        part /= 2
        if part < SMALLEST_ADDED_PART_OF_PRESSURE_DEPENDENCE:
            raise NoAnswer(
                "no equilibrium is found with friction that depends on the pressure; "
                f"with {number_as_text(reached, '.0%')} of this dependence there is one"
            )
    return found


def _stable_contact_by_newton_or_none(
    problem: FrictionDependentProblem,
    friction: FunctionOfNodalFrictionByPressures,
    start: ContactSolution,
) -> ContactSolution | None:
    """The stable solution that Newton's method reaches from `start`; None if it reaches none."""
    found, last_change = start, math.inf
    for _ in range(MAX_NEWTON_STEPS_PER_FRICTION_CHANGE):
        try:
            after = solve_contact_problem(
                contact_problem_with_friction_tangent(problem, friction(found.p), found.p),
                found.active,
            )
        except NoAnswer:
            return None
        change = largest_change_relative_to_peak(after.p, found.p)
        found = after
        if is_newton_change_negligible(change, last_change):
            return found if found.stable else None
        last_change = change
    return None


def largest_change_relative_to_peak(values: Floats, before: Floats) -> float:
    """The largest change of pressures or friction coefficients (n,), relative to the largest value.

    It is 0 if nothing has changed, and inf if every value has become 0 or less.
    """
    change, peak = float(np.abs(values - before).max()), float(values.max())
    if change == 0:
        return 0.0
    return change / peak if peak > 0 else math.inf


def is_newton_change_negligible(change: float, last_change: float) -> bool:
    """Whether the change of the last step ends Newton's method for friction over the pressure.

    It does if the change is below the tolerance, or if it is as small as round-off may be and has
    not fallen from the step before. Every iteration in which friction and pressure come to agree
    ends by this function.

    Parameters
    ----------
    change : change in the last step, relative to the peak
    last_change : relative change in the step before; inf for the first step
    """
    if change <= NEWTON_TOLERANCE_OF_CONTACT_PRESSURES:
        return True
    return last_change <= change <= LARGEST_ROUND_OFF_OF_CONTACT_PRESSURES


def contact_problem_with_friction_tangent(
    problem: FrictionDependentProblem, friction: NodalFrictionAndSlope, p: Floats
) -> ContactProblem:
    """The contact problem in which tau(p) = mu(p) p is replaced by its tangent at pressures p."""
    A, q, B, C, h = problem.frictionless
    tangent = friction.coefficient + friction.slope * p
    # `constant` is the friction stress of the tangent at the pressure 0, a constant load.
    constant = -friction.slope * p**2
    return ContactProblem(
        A + problem.A_per_friction * tangent,
        q + problem.A_per_friction @ constant,
        B,
        C + problem.C_per_friction * tangent,
        h - problem.C_per_friction @ constant,
    )
