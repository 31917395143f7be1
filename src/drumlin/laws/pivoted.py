"""The law of a shoe on a pivot G at the end of a lever: p = A cos phi + B sin phi.

The rigid shoe has two modes: it moves with the lever and turns about G. Its approach to the drum,
and with it the pressure, is therefore any mixture of cos and sin. Two equilibria fix the mixture.
The contact has no moment about G, and together with the actuation no moment about the lever's pin H
(UWA notes, hinged shoe with a pivot G):

    [ M_N - dD mu M_F ]_G A + [ ... ]_G B = 0,    [ ... ]_H A + [ ... ]_H B = M / (b R)

The first bracket of a row is the load of cos, the second that of sin, both by `moments_about`.
About the lining's middle B vanishes, p = p_0 cos, only if G lies there at `pivot_radius`.

The formulas work on arrays, for a lining that presses all along. `rigid`, of which this law is a
special case, solves brakes.
"""

import math
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats, Values
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.surface import DRUM
from drumlin.laws.shapes import Layout, cos_load, moments_about, sine_load

PIVOTED_ASSUMES = "rigid shoe on a pivot of a lever: p = A cos + B sin, no moment about the pivot"


class Rows(NamedTuple):
    """Matrix (2, 2) [m] of the equilibria in A and B: the row about G, then the row about H."""

    g_cos: Floats
    g_sin: Floats
    h_cos: Floats
    h_sin: Floats

    @property
    def determinant(self) -> Floats:
        """Determinant [m^2]; it is zero if the lever locks itself."""
        return np.asarray(self.g_cos * self.h_sin - self.g_sin * self.h_cos)


class _RowsOfMoments(NamedTuple):
    """Rows of the moments of the `normal` pressure M_N and of the `friction` M_F."""

    normal: Rows
    friction: Rows


def _moments(arc: Layout, x: Values, y: Values) -> _RowsOfMoments:
    """M_N and M_F of the four entries; the matrix is the first less dD mu times the second."""
    normal, friction = [], []
    for point in ((x, y), (arc.a, 0.0)):
        for load in (cos_load, sine_load):
            M_N, M_F = moments_about(load(arc), arc.R, *point)
            normal.append(M_N)
            friction.append(M_F)
    return _RowsOfMoments(Rows(*normal), Rows(*friction))


def _equilibrium_rows(mu: Values, arc: Layout, x: Values, y: Values) -> Rows:
    """Matrix of the equilibria at friction mu, with the pivot at x, y [m]."""
    of = _moments(arc, x, y)
    return Rows(*(N - arc.dD * mu * F for N, F in zip(of.normal, of.friction, strict=True)))


def coefficients(
    moment: Values, width: Values, mu: Values, arc: Layout, x: Values, y: Values
) -> tuple[Floats, Floats]:
    """Factors A and B [Pa] of the pressure, without a check of its sign or of self-locking.

    Parameters
    ----------
    moment : of the actuation about the lever's pin [N m]
    width : of the lining [m]
    mu : friction coefficient
    arc : layout of the shoe, with the lever's pin as its hinge
    x, y : the pivot in the shoe's frame, whose lever's pin is at (a, 0) [m]
    """
    rows = _equilibrium_rows(mu, arc, x, y)
    scale = moment / (width * arc.R * rows.determinant)
    return np.asarray(-rows.g_sin * scale), np.asarray(rows.g_cos * scale)


def torque(moment: Values, mu: Values, arc: Layout, x: Values, y: Values) -> Floats:
    """Torque [N m] under an actuation moment [N m] >= 0; parameters as of `coefficients`.

    It is nan if the lever locks itself or the pressure is negative somewhere.
    """
    # The torque does not depend on the width.
    A, B = coefficients(moment, 1.0, mu, arc, x, y)
    # Over less than half a turn a mixture that is positive at both ends is positive between them.
    least = np.minimum(*(A * np.cos(phi) + B * np.sin(phi) for phi in (arc.phi_1, arc.phi_2)))
    size = mu * arc.R**2 * (A * cos_load(arc).total + B * sine_load(arc).total)
    return np.where(least >= -1e-12 * np.hypot(A, B), size, np.nan)


def sensitivity(mu: Values, arc: Layout, x: Values, y: Values) -> Floats:
    """Sensitivity S = (mu/T) dT/dmu at fixed actuation, with the change of the mixture A : B."""
    A, B = coefficients(1.0, 1.0, mu, arc, x, y)
    rows = _equilibrium_rows(mu, arc, x, y)
    # The changes of A and B follow from the change of the matrix with mu.
    change = Rows(*(-arc.dD * F for F in _moments(arc, x, y).friction))
    g = change.g_cos * A + change.g_sin * B
    h = change.h_cos * A + change.h_sin * B
    dA = -(rows.h_sin * g - rows.g_sin * h) / rows.determinant
    dB = -(rows.g_cos * h - rows.h_cos * g) / rows.determinant
    of_cos, of_sin = cos_load(arc).total, sine_load(arc).total
    return np.asarray(1 + mu * (dA * of_cos + dB * of_sin) / (A * of_cos + B * of_sin))


def locking_friction(arc: Layout, x: float, y: float) -> float:
    """Smallest friction mu_lock at which the determinant vanishes; inf if there is none.

    The determinant is a parabola in mu. The pivot is at x, y [m].
    """
    # Three values at evenly spaced frictions give the coefficients of the parabola.
    at_0, at_1, at_2 = (
        float(_equilibrium_rows(mu, arc, x, y).determinant) for mu in (0.0, 1.0, 2.0)
    )
    second = (at_2 - 2 * at_1 + at_0) / 2
    parabola = np.array([second, at_1 - at_0 - second, at_0])
    # A coefficient that is round-off would make a root far away.
    parabola[np.abs(parabola) < 1e-14 * np.abs(parabola).max()] = 0.0
    roots = np.roots(parabola)
    positive = [float(r.real) for r in roots if abs(r.imag) < 1e-12 and r.real > 0]
    return min(positive, default=math.inf)


def why_not(brake: Brake) -> str | None:
    """Reason why the law does not apply to a brake, or None."""
    refusal = brake.surface.unlike(DRUM) or brake.shares
    if refusal is not None:
        return refusal
    for shoe in brake.shoes:
        if shoe.pivot is None:
            return f"shoe {shoe.name!r}: it has no pivot"
    return None


def pivot_place(shoe: Shoe) -> tuple[float, float]:
    """Position x, y [m] of the pivot in the shoe's frame."""
    assert shoe.pivot is not None, "why_not() has refused a shoe without pivot"
    x, y = shoe.frame.to_shoe(shoe.pivot.xy)
    return float(x), float(y)
