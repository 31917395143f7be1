"""Radial displacement of a thin circular ring under forces on its rim, in closed form.

A unit radial force has the Fourier series 1/(pi R) (1/2 + sum cos n d). Of it the mode n = 1 is
carried by the shaft without bending the ring, and a mode n >= 2 moves the ring by R^4/(EI (n^2 -
1)^2), so that at the angle d from a force N, inwards where N points inwards,

    z = N R^3/(pi EI) f(d),      f(d) = sum_{n >= 2} cos(n d)/(n^2 - 1)^2.

Two equal opposite forces leave the even modes, twice: this is Barecki & Scieszka (1987), eq. 13 and
15.
"""

import math

import numpy as np

from drumlin.arrays import Floats
from drumlin.brake.components import Ring
from drumlin.brake.fields import Material

SHEAR_FACTOR = 6 / 5  # shear factor of a rectangular section


def _turn(d: Floats) -> tuple[Floats, Floats]:
    """d within [0, 2 pi), and u = pi - d."""
    d = np.mod(d, 2 * math.pi)
    return d, math.pi - d


def one_force(d: Floats) -> Floats:
    """f(d) = sum_{n >= 2} cos(n d)/(n^2 - 1)^2, same shape as d [rad]."""
    d, u = _turn(d)
    return np.asarray(
        -0.5 - (math.pi**2 / 24 + 3 / 16) * np.cos(d) + u * np.sin(d) / 4 + u**2 * np.cos(d) / 8
    )


def two_forces(d: Floats) -> Floats:
    """pi times the bracket of eq. 15: 2 sum over even n of cos(n d)/(n^2 - 1)^2, same shape as d
    [rad].
    """
    d = np.mod(d, math.pi)
    d = np.minimum(d, math.pi - d)
    return np.asarray(math.pi * ((math.pi / 8 - d / 4) * np.cos(d) + np.sin(d) / 4 - 1 / math.pi))


def shear_of_one_force(d: Floats) -> Floats:
    """sum_{n >= 2} n^2 cos(n d)/(n^2 - 1)^2, same shape as d [rad]."""
    angle, u = _turn(d)
    return 0.5 + np.cos(angle) / 4 - u * np.sin(angle) / 2 + one_force(d)


def drag_of_one_force(d: Floats) -> Floats:
    """sum_{n >= 2} sin(n d)/(n (n^2 - 1)^2) = Int_0^d f, same shape as d [rad]."""
    d, u = _turn(d)
    s, c = np.sin(d), np.cos(d)
    return np.asarray(0.5 * u - (math.pi**2 / 24 + 3 / 16) * s - (u * c + s) / 2 + u**2 * s / 8)


def flexibility(
    ring: Ring, radius: float, d: Floats, *, twin: bool, sign: int, thick: bool
) -> Floats:
    """Inward displacement [m/N] of the rim at the angles d [rad] from a unit inward force, same
    shape.

    `twin`: with an equal force opposite. `thick`: bent at the radius of the section's middle, with
    hoop and shear deformation; a mode n of the radial load then moves the ring by (1 + 3 e + n^2 e
    E/(kappa G)) times as much, e = I/(A r^2), and the mean load stretches it (from the energy of
    the curved bar, Timoshenko: Strength of Materials II, M = -r H in every mode n >= 2). The ring
    lies on the side `sign` of the friction surface.
    """
    series = two_forces if twin else one_force
    if not thick:
        return radius**3 / (math.pi * ring.EI) * series(d)
    section = ring.section
    assert section is not None  # why_not
    r = radius + sign * section.thickness / 2
    e = section.thickness**2 / (12 * r**2)
    assert isinstance(section.material, Material)  # why_not
    shear = 2 * (1 + section.material.nu) * SHEAR_FACTOR
    hoop = 0.5
    n2 = shear_of_one_force(d)
    if twin:
        hoop, n2 = 1.0, n2 + shear_of_one_force(d + math.pi)
    return (
        r**3
        / (math.pi * section.bending_stiffness)
        * ((1 + 3 * e) * series(d) + e * shear * n2 + e * hoop)
    )


def drag_flexibility(ring: Ring, radius: float, d: Floats, *, twin: bool) -> Floats:
    """Inward displacement [m/N] of the rim at d [rad] beyond a unit force along the rim, towards
    growing d.

    The ring keeps its length: w = -v'; the force's moment about the section's middle is left out.
    """
    series = drag_of_one_force(d) + (drag_of_one_force(d + math.pi) if twin else 0.0)
    return -(radius**3) / (math.pi * ring.EI) * series
