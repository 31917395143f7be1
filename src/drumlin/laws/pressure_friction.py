"""Solve laws of even pressure with a friction coefficient mu(p) that depends on the pressure.

If the pressure p is the same everywhere on a lining, the lining has one friction coefficient mu(p).
The law gives the pressure P(mu) at a given coefficient in closed form. The pressure of the shoe is
therefore a zero of p - P(mu(p)).
"""

from collections.abc import Callable
from itertools import pairwise

import numpy as np

from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake
from drumlin.brake.friction import (
    FrictionOverPressureCurve,
    first_key_of_pressure_dependent_friction,
    reason_if_friction_depends_on_pressure,
)
from drumlin.response.response import Response

NAMES_OF_LAWS_OF_UNIFORM_PRESSURE = frozenset({"uniform", "short"})
"""Names of the laws whose pressure is the same everywhere on the lining."""

PRESSURE_SOLVER_TOLERANCE = 4 * float(np.finfo(float).eps)
"""Relative accuracy to which the pressure of a shoe is found: the finest that `brentq` accepts."""

SolveBrakeByLawFunction = Callable[[Brake], Response]
"""A function that solves a brake by a law."""


def reason_why_law_cannot_take_pressure_dependent_friction(name: str, brake: Brake) -> str | None:
    """Why a law cannot solve a brake whose friction depends on the pressure; None if it can.

    `name` is the name of the law.
    """
    if name in NAMES_OF_LAWS_OF_UNIFORM_PRESSURE:
        return None
    return reason_if_friction_depends_on_pressure(
        brake, f"the law {name!r}, whose pressure varies,"
    )


def solve_brake_by_law_of_uniform_pressure(
    solve: SolveBrakeByLawFunction, brake: Brake
) -> Response:
    """Solve a brake by a law, with the friction coefficient that belongs to each shoe's pressure.

    Raises NoAnswer if a shoe has no equilibrium.
    """
    if first_key_of_pressure_dependent_friction(brake) is None:
        return solve(brake)
    count = len(brake.shoes)
    # While one shoe is solved, the other shoes get no friction, so that they cannot lock
    # themselves.
    frictions = []
    for i, shoe in enumerate(brake.shoes):
        curve = brake.friction_coefficient_curve_of_shoe(shoe)

        def pressure(mu: float, index: int = i) -> float:
            """Pressure [Pa] of shoe `index` at the friction mu; inf if the shoe locks itself."""
            alone = [mu if k == index else 0.0 for k in range(count)]
            try:
                return (
                    solve(_brake_with_friction_coefficient_of_each_shoe(brake, alone))
                    .shoes[index]
                    .peak_pressure
                )
            except NoAnswer:
                return np.inf

        frictions.append(_friction_at_equilibrium_of_smallest_pressure(curve, pressure, shoe.name))
    return solve(_brake_with_friction_coefficient_of_each_shoe(brake, frictions))


def _brake_with_friction_coefficient_of_each_shoe(brake: Brake, frictions: list[float]) -> Brake:
    """A copy of a brake in which the lining of each shoe has its own coefficient, `frictions`."""
    shoes = []
    for shoe, friction in zip(brake.shoes, frictions, strict=True):
        lining = shoe.lining.copy_of_lining_with_changed_fields({"friction": friction})
        shoes.append(shoe.model_copy(update={"lining": lining}))
    changes = {"friction_as_written": brake.friction, "shoes": tuple(shoes)}
    return brake.model_copy(update=changes)


def _friction_at_equilibrium_of_smallest_pressure(
    curve: FrictionOverPressureCurve, pressure: Callable[[float], float], name: str
) -> float:
    """The friction coefficient at the smallest pressure at which a shoe is in equilibrium.

    A force that grows from zero reaches this equilibrium first.

    Parameters
    ----------
    curve : friction coefficient over the pressure
    pressure : function that returns the shoe's pressure [Pa] by the law at a friction coefficient
    name : name of the shoe, for the message

    Raises
    ------
    NoAnswer
        if the shoe locks itself
    """
    # The import of scipy takes time, and few brakes need it.
    from scipy.optimize import brentq  # noqa: PLC0415

    def pressure_minus_law_pressure_at_its_friction(p: float) -> float:
        """The pressure p minus the pressure [Pa] that the law gives with the friction at p."""
        # A shoe that locks itself has an infinite pressure: the difference is then negative for
        # every finite p.
        reached = pressure(float(curve.friction_coefficients_at_pressures(np.array(p))))
        return p - reached if np.isfinite(reached) else -max(p, 1.0)

    # The friction is linear between two pressures of the table. `brentq` finds the zero between the
    # first two at which the differences have opposite signs.
    for low, high in pairwise([0.0, *curve.pressure.tolist()]):
        if low < high and pressure_minus_law_pressure_at_its_friction(
            low
        ) <= 0 <= pressure_minus_law_pressure_at_its_friction(high):
            p = brentq(
                pressure_minus_law_pressure_at_its_friction,
                low,
                high,
                xtol=PRESSURE_SOLVER_TOLERANCE * high,
                rtol=PRESSURE_SOLVER_TOLERANCE,
            )
            return float(curve.friction_coefficients_at_pressures(np.array(p)))
    # Beyond the table the coefficient is constant.
    last = float(curve.mu[-1])
    if not np.isfinite(pressure(last)):
        raise NoAnswer(f"shoe {name!r}: self-locking, with friction that depends on the pressure")
    return last
