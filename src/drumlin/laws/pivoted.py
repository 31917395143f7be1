"""The shoe on a pivot G at the end of a lever: two freedoms, p = A cos phi + B sin phi.

The rigid shoe moves with the lever and turns about G, so its approach to the drum, and with it the
pressure, is any mixture of cos and sin. Two equilibria fix the mixture: the contact has no moment
about G, and with the actuation none about the lever's pin H (UWA notes, hinged shoe with a pivot
G):

    [ M_N - dD mu M_F ]_G A + [ ... ]_G B = 0,    [ ... ]_H A + [ ... ]_H B = M / (b R)

The first bracket of a row is the load of cos, the second that of sin, both by `moments_about`. B =
0 about the lining's middle, p = p_0 cos, only when G lies there at the radius `pivot_radius`.

Formulas on arrays, of a lining that presses all along; a brake is solved by `rigid`, of which this
is a special case.
"""

import math
from typing import NamedTuple

import numpy as np

from drumlin.arrays import Floats, Values
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.surface import DRUM
from drumlin.laws.shapes import Layout, cos_load, moments_about, sine_load

PIVOTED_ASSUMES = "rigid shoe on a pivot of a lever: p = A cos + B sin, no moment about the pivot"


class Rows(NamedTuple):
    """The equilibria as a 2 by 2 system for A, B: about G [[g_cos, g_sin],, about H [h_cos, h_sin]]
    [m].
    """

    g_cos: Floats
    g_sin: Floats
    h_cos: Floats
    h_sin: Floats

    @property
    def determinant(self) -> Floats:
        """Zero where the lever locks itself [m^2]."""
        return np.asarray(self.g_cos * self.h_sin - self.g_sin * self.h_cos)


def _moments(arc: Layout, x: Values, y: Values) -> tuple[Rows, Rows]:
    """M_N and M_F of the four entries: the system is the first less dD mu times the second."""
    of = [
        moments_about(load(arc), arc.R, *point)
        for point in ((x, y), (arc.a, 0.0))
        for load in (cos_load, sine_load)
    ]
    return Rows(*(normal for normal, _ in of)), Rows(*(friction for _, friction in of))


def _rows(mu: Values, arc: Layout, x: Values, y: Values) -> Rows:
    normal, friction = _moments(arc, x, y)
    return Rows(*(N - arc.dD * mu * F for N, F in zip(normal, friction, strict=True)))


def coefficients(
    moment: Values, width: Values, mu: Values, arc: Layout, x: Values, y: Values
) -> tuple[Floats, Floats]:
    """A and B [Pa] under an actuation moment [N m] about the lever's pin; pivot at x, y [m].

    phi and x, y are in the shoe's frame: from the lever's pin at (a, 0). Not judged: where p turns
    negative or the lever locks itself, see `torque`.
    """
    rows = _rows(mu, arc, x, y)
    scale = moment / (width * arc.R * rows.determinant)
    return np.asarray(-rows.g_sin * scale), np.asarray(rows.g_cos * scale)


def torque(moment: Values, mu: Values, arc: Layout, x: Values, y: Values) -> Floats:
    """Torque [N m] under an actuation moment [N m] >= 0; nan where the lever locks itself or p < 0
    somewhere.
    """
    A, B = coefficients(moment, 1.0, mu, arc, x, y)  # the torque does not depend on the width
    least = np.minimum(*(A * np.cos(phi) + B * np.sin(phi) for phi in (arc.phi_1, arc.phi_2)))
    size = mu * arc.R**2 * (A * cos_load(arc).total + B * sine_load(arc).total)
    return np.where(least >= -1e-12 * np.hypot(A, B), size, np.nan)


def sensitivity(mu: Values, arc: Layout, x: Values, y: Values) -> Floats:
    """S = (mu/T) dT/dmu at fixed actuation, the change of the mixture A : B included."""
    A, B = coefficients(1.0, 1.0, mu, arc, x, y)
    rows = _rows(mu, arc, x, y)
    change = Rows(*(-arc.dD * F for F in _moments(arc, x, y)[1]))
    g, h = change.g_cos * A + change.g_sin * B, change.h_cos * A + change.h_sin * B
    dA = -(rows.h_sin * g - rows.g_sin * h) / rows.determinant
    dB = -(rows.g_cos * h - rows.h_cos * g) / rows.determinant
    of_cos, of_sin = cos_load(arc).total, sine_load(arc).total
    return np.asarray(1 + mu * (dA * of_cos + dB * of_sin) / (A * of_cos + B * of_sin))


def locking_friction(arc: Layout, x: float, y: float) -> float:
    """mu_lock: the least friction at which the determinant, a parabola in mu, is 0; inf where there
    is none.
    """
    at_0, at_1, at_2 = (float(_rows(mu, arc, x, y).determinant) for mu in (0.0, 1.0, 2.0))
    second = (at_2 - 2 * at_1 + at_0) / 2
    parabola = np.array([second, at_1 - at_0 - second, at_0])
    parabola[np.abs(parabola) < 1e-14 * np.abs(parabola).max()] = 0.0
    roots = np.roots(parabola)
    return min(
        (float(r.real) for r in roots if abs(r.imag) < 1e-12 and r.real > 0), default=math.inf
    )


def why_not(brake: Brake) -> str | None:
    """Why the law does not apply to a brake; None where it does."""
    refusal = brake.surface.unlike(DRUM) or brake.shares
    if refusal is not None:
        return refusal
    for shoe in brake.shoes:
        if shoe.pivot is None:
            return f"shoe {shoe.name!r}: it has no pivot"
    return None


def pivot_place(shoe: Shoe) -> tuple[float, float]:
    """The pivot x, y [m] in the shoe's frame."""
    assert shoe.pivot is not None, "why_not() has refused a shoe without pivot"
    x, y = shoe.frame.to_shoe(shoe.pivot.xy)
    return float(x), float(y)
