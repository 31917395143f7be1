"""Contact in full slip with a friction coefficient mu(p) that depends on the pressure.

The friction stress tau(p) = mu(p) p takes the place of mu p in the contact problem,

    w = q + A0 p + A1 tau(p) + B y,    C0 p + C1 tau(p) = h,    p >= 0,  w >= 0,  p w = 0.

Newton's method replaces tau by its tangent tau(p_0) + tau'(p_0) (p - p_0) at the last pressures
p_0. The next pressures then solve a contact problem with a friction coefficient tau' = mu + mu' p
for each node, and with other gaps and forces (a sequence of linear complementarity problems:
Josephy 1979). The error of a step is squared in the next step.

If the steps do not converge, friction is brought from a known constant value to mu(p) in smaller
parts.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import NoAnswer
from drumlin.base.texts import number_as_text
from drumlin.contact.active_set import Contact, solve_contact_problem
from drumlin.contact.equations import ContactProblem
from drumlin.contact.self_locking import FrictionDependentProblem

FRICTION_TOLERANCE = 1e-10
"""Largest change of a pressure in the last step of Newton's method, relative to the peak pressure.

The error of the last step is about the square of its change. The value is the accuracy that is
stated for friction that depends on the pressure.
"""

MOST_STEPS_TO_FRICTION = 20
"""Largest number of steps of Newton's method before the change of the friction law is halved.

The law goes from constant friction to friction that depends on the pressure. Brakes need some
five steps for the whole change. If more are needed, only half of the change is tried.
"""

SMALLEST_FRICTION_PART = 1 / 64
"""Smallest part of the friction's dependence on pressure that is added at once (1: all of it).

If a part fails, half of it is tried. If this half is smaller than the limit, the brake is refused.
The value is a judgement; a smaller one makes a refusal slower.
"""


class NodalFriction(NamedTuple):
    """The friction coefficient (n,) of each node, and its derivative (n,) by the pressure."""

    coefficient: Floats
    slope: Floats


FrictionAtPressures = Callable[[Floats], NodalFriction]
"""A function that takes nodal pressures (n,) and returns the friction at the nodes."""


def solve_contact_with_pressure_dependent_friction(
    problem: FrictionDependentProblem, friction: FrictionAtPressures, start: Contact, base: Floats
) -> Contact:
    """Solve a contact problem whose friction depends on the pressure, and return its solution.

    Parameters
    ----------
    problem : the contact problem at every friction coefficient
    friction : function that returns the friction at nodal pressures
    start : solution with the friction coefficients `base`
    base : (n,) friction coefficients of the nodes that do not depend on the pressure

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
        ) -> NodalFriction:
            """The friction at pressures p, with a fraction `share` of its dependence on p."""
            whole = friction(p)
            return NodalFriction(base + share * (whole.coefficient - base), share * whole.slope)

        after = _stable_contact_by_newton_or_none(
            problem, friction_with_scaled_pressure_dependence, found
        )
        if after is not None:
            found, reached = after, target
            continue
        part /= 2
        if part < SMALLEST_FRICTION_PART:
            raise NoAnswer(
                "no equilibrium is found with friction that depends on the pressure; "
                f"with {number_as_text(reached, '.0%')} of this dependence there is one"
            )
    return found


def _stable_contact_by_newton_or_none(
    problem: FrictionDependentProblem, friction: FrictionAtPressures, start: Contact
) -> Contact | None:
    """The stable solution that Newton's method reaches from `start`; None if it reaches none."""
    found = start
    for _ in range(MOST_STEPS_TO_FRICTION):
        try:
            after = solve_contact_problem(
                contact_problem_with_friction_tangent(problem, friction(found.p), found.p),
                found.active,
            )
        except NoAnswer:
            return None
        change = np.abs(after.p - found.p).max()
        found = after
        if change <= FRICTION_TOLERANCE * found.p.max():
            return found if found.stable else None
    return None


def contact_problem_with_friction_tangent(
    problem: FrictionDependentProblem, friction: NodalFriction, p: Floats
) -> ContactProblem:
    """The contact problem in which tau(p) = mu(p) p is replaced by its tangent at pressures p."""
    A, q, B, C, h = problem.frictionless
    tangent = friction.coefficient + friction.slope * p
    # At the pressure 0 the tangent has this stress. It acts as a constant load.
    constant = -friction.slope * p**2
    return ContactProblem(
        A + problem.A_per_friction * tangent,
        q + problem.A_per_friction @ constant,
        B,
        C + problem.C_per_friction * tangent,
        h - problem.C_per_friction @ constant,
    )
