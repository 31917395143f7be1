"""The law of a rigid shoe on a pivot G at the end of a lever: p = A cos phi + B sin phi.

The shoe has two rigid-body modes: it moves with the lever, and it turns about G. These motions
close the gap to the drum by a linear combination of cos phi and sin phi, and the pressure is
proportional to the closing. Two moment equilibria give the factors A and B. Pressure and friction
have no moment about the pivot G. Together with the actuation moment M they have no moment about the
lever's pin H (UWA notes, hinged shoe with a pivot G):

    [ M_N - dD mu M_F ]_G A + [ M_N - dD mu M_F ]_G B = 0
    [ M_N - dD mu M_F ]_H A + [ M_N - dD mu M_F ]_H B = M / (b R)

Each bracket holds the moments M_N and M_F of the pressure cos phi (before A) or sin phi (before B)
about G or H, see `scaled_normal_and_friction_moments_about_point`. The sign dD is explained at
`ShoeAnglesAndRadii`, b is the lining's width and R the drum's radius. With phi counted from the
lining's middle, B vanishes only if G lies on the middle radius at the distance
`pivot_radius_for_cosine_pressure`.

The functions of this module work on arrays and assume a lining in contact over its whole length. To
solve a brake use `drumlin.laws.rigid`, of which this law is a special case.
"""

import math
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats, NumberOrArray
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.surface import FRICTION_SURFACE_OF_DRUM
from drumlin.laws.shapes import (
    ShoeAnglesAndRadii,
    integrals_of_cos_phi_pressure,
    integrals_of_sine_pressure,
    scaled_normal_and_friction_moments_about_point,
)

PIVOTED_SHOE_LAW_ASSUMPTIONS = (
    "rigid shoe on a pivot of a lever: p = A cos + B sin, no moment about the pivot"
)
"""The assumptions of the law of a pivoted shoe, as printed with its answer."""


class MomentEquilibriumMatrix(NamedTuple):
    """Matrix (2, 2) [m] of the two moment equilibria for the factors A and B of the pressure.

    Attributes
    ----------
    pivot_moment_of_cos, pivot_moment_of_sin : moments about the pivot G of the pressures cos phi
        and sin phi
    pin_moment_of_cos, pin_moment_of_sin : moments about the lever's pin H of the pressures cos phi
        and sin phi
    """

    pivot_moment_of_cos: Floats
    pivot_moment_of_sin: Floats
    pin_moment_of_cos: Floats
    pin_moment_of_sin: Floats

    @property
    def determinant_of_equilibrium_matrix(self) -> Floats:
        """Determinant of the matrix [m^2]; zero at the friction where the lever locks itself."""
        return np.asarray(
            self.pivot_moment_of_cos * self.pin_moment_of_sin
            - self.pivot_moment_of_sin * self.pin_moment_of_cos
        )


class _NormalAndFrictionMomentMatrices(NamedTuple):
    """The matrices of the moments M_N of the normal pressure and M_F of the friction."""

    normal: MomentEquilibriumMatrix
    friction: MomentEquilibriumMatrix


def _matrices_of_normal_and_friction_moments(
    arc: ShoeAnglesAndRadii, x: NumberOrArray, y: NumberOrArray
) -> _NormalAndFrictionMomentMatrices:
    """The matrices M_N of pressure and M_F of friction in the equilibrium matrix M_N - dD mu M_F.

    The pivot is at x, y [m] in the shoe's frame, and the lever's pin at (a, 0).
    """
    normal, friction = [], []
    for point in ((x, y), (arc.a, 0.0)):
        for load in (integrals_of_cos_phi_pressure, integrals_of_sine_pressure):
            M_N, M_F = scaled_normal_and_friction_moments_about_point(load(arc), arc.R, *point)
            normal.append(M_N)
            friction.append(M_F)
    return _NormalAndFrictionMomentMatrices(
        MomentEquilibriumMatrix(*normal), MomentEquilibriumMatrix(*friction)
    )


def _matrix_of_moment_equilibria(
    mu: NumberOrArray, arc: ShoeAnglesAndRadii, x: NumberOrArray, y: NumberOrArray
) -> MomentEquilibriumMatrix:
    """Matrix of the moment equilibria at the friction mu, with the pivot at x, y [m]."""
    of = _matrices_of_normal_and_friction_moments(arc, x, y)
    return MomentEquilibriumMatrix(
        *(N - arc.dD * mu * F for N, F in zip(of.normal, of.friction, strict=True))
    )


def pressure_factors_of_cos_and_sin(
    moment: NumberOrArray,
    width: NumberOrArray,
    mu: NumberOrArray,
    arc: ShoeAnglesAndRadii,
    x: NumberOrArray,
    y: NumberOrArray,
) -> tuple[Floats, Floats]:
    """Factors A and B [Pa] of the pressure A cos phi + B sin phi.

    The function does not check whether the pressure is negative or the lever locks itself.

    Parameters
    ----------
    moment : moment of the actuation about the lever's pin [N m]
    width : width of the lining [m]
    mu : friction coefficient
    arc : angles and radii of the shoe, with the lever's pin as its hinge
    x, y : the pivot in the shoe's frame [m], in which the lever's pin is at (a, 0)
    """
    rows = _matrix_of_moment_equilibria(mu, arc, x, y)
    scale = moment / (width * arc.R * rows.determinant_of_equilibrium_matrix)
    return np.asarray(-rows.pivot_moment_of_sin * scale), np.asarray(
        rows.pivot_moment_of_cos * scale
    )


def torque_of_pivoted_shoe(
    moment: NumberOrArray,
    mu: NumberOrArray,
    arc: ShoeAnglesAndRadii,
    x: NumberOrArray,
    y: NumberOrArray,
) -> Floats:
    """Torque [N m] of a shoe on a lever's pivot under an actuation moment that is not negative.

    The parameters are those of `pressure_factors_of_cos_and_sin`.

    The torque is nan if the lever locks itself or the pressure is negative somewhere.
    """
    # The torque does not depend on the width of the lining, which is set to 1.
    A, B = pressure_factors_of_cos_and_sin(moment, 1.0, mu, arc, x, y)
    # On an arc below half a turn, A cos + B sin is positive if it is positive at both ends.
    least = np.minimum(*(A * np.cos(phi) + B * np.sin(phi) for phi in (arc.phi_1, arc.phi_2)))
    size = (
        mu
        * arc.R**2
        * (A * integrals_of_cos_phi_pressure(arc).total + B * integrals_of_sine_pressure(arc).total)
    )
    return np.where(least >= -1e-12 * np.hypot(A, B), size, np.nan)


def torque_sensitivity_of_pivoted_shoe(
    mu: NumberOrArray, arc: ShoeAnglesAndRadii, x: NumberOrArray, y: NumberOrArray
) -> Floats:
    """Sensitivity S = (mu/T) dT/dmu of the torque at fixed actuation.

    S includes the change of the pressure's shape, which is the ratio A : B, with mu.
    """
    A, B = pressure_factors_of_cos_and_sin(1.0, 1.0, mu, arc, x, y)
    rows = _matrix_of_moment_equilibria(mu, arc, x, y)
    # The derivatives dA/dmu and dB/dmu follow from the derivative of the equilibrium matrix.
    change = MomentEquilibriumMatrix(
        *(-arc.dD * F for F in _matrices_of_normal_and_friction_moments(arc, x, y).friction)
    )
    g = change.pivot_moment_of_cos * A + change.pivot_moment_of_sin * B
    h = change.pin_moment_of_cos * A + change.pin_moment_of_sin * B
    dA = (
        -(rows.pin_moment_of_sin * g - rows.pivot_moment_of_sin * h)
        / rows.determinant_of_equilibrium_matrix
    )
    dB = (
        -(rows.pivot_moment_of_cos * h - rows.pin_moment_of_cos * g)
        / rows.determinant_of_equilibrium_matrix
    )
    of_cos, of_sin = integrals_of_cos_phi_pressure(arc).total, integrals_of_sine_pressure(arc).total
    return np.asarray(1 + mu * (dA * of_cos + dB * of_sin) / (A * of_cos + B * of_sin))


def self_locking_friction_of_pivoted_shoe(arc: ShoeAnglesAndRadii, x: float, y: float) -> float:
    """Friction coefficient mu_lock at which the lever locks itself; inf if it never does.

    It is the smallest mu > 0 at which the determinant of the equilibria vanishes. The pivot is at
    x, y [m] in the shoe's frame.
    """
    # The determinant is a parabola in mu: its values at mu = 0, 1 and 2 give its coefficients.
    at_0, at_1, at_2 = (
        float(_matrix_of_moment_equilibria(mu, arc, x, y).determinant_of_equilibrium_matrix)
        for mu in (0.0, 1.0, 2.0)
    )
    second = (at_2 - 2 * at_1 + at_0) / 2
    parabola = np.array([second, at_1 - at_0 - second, at_0])
    # A coefficient that is round-off only is set to zero, because it would give a huge false root.
    parabola[np.abs(parabola) < 1e-14 * np.abs(parabola).max()] = 0.0
    roots = np.roots(parabola)
    positive = [float(r.real) for r in roots if abs(r.imag) < 1e-12 and r.real > 0]
    return min(positive, default=math.inf)


def reason_against_pivoted_shoe_law(brake: Brake) -> str | None:
    """The reason why the law of pivoted shoes does not apply to a brake; None if it applies."""
    refusal = (
        brake.surface.reason_why_surface_is_not_required_one(FRICTION_SURFACE_OF_DRUM)
        or brake.reason_why_cam_or_strut_sets_forces
    )
    if refusal is not None:
        return refusal
    for shoe in brake.shoes:
        if shoe.pivot is None:
            return f"shoe {shoe.name!r}: it has no pivot"
    return None


def pivot_position_in_shoe_frame(shoe: Shoe) -> tuple[float, float]:
    """Position x, y [m] in the shoe's frame of the pivot at the end of the shoe's lever."""
    assert shoe.pivot is not None, "why_not() has refused a shoe without pivot"
    x, y = shoe.frame.convert_vectors_to_shoe_frame(shoe.pivot.xy)
    return float(x), float(y)
