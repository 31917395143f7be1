"""Deflection of a thin circular ring under forces on its rim, in closed form.

A unit radial force has the Fourier series 1/(pi R) (1/2 + sum cos n d). The shaft carries the mode
n = 1 without bending the ring. A mode n >= 2 moves the ring by R^4/(EI (n^2 - 1)^2). At the angle d
from an inward force N the ring therefore moves inwards by

    z = N R^3/(pi EI) f(d),      f(d) = sum_{n >= 2} cos(n d)/(n^2 - 1)^2.

Two equal opposite forces leave the even modes, twice: this is Barecki & Scieszka (1987), eq. 13 and
15.
"""

import math

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake.components import Ring
from drumlin.brake.fields import Material

SHEAR_FACTOR = 6 / 5
"""Shear factor of a rectangular section."""


def _principal_angles(d: Floats) -> tuple[Floats, Floats]:
    """The angles d [rad] within [0, 2 pi), and u = pi - d."""
    d = np.mod(d, 2 * math.pi)
    return d, math.pi - d


def one_force(d: Floats) -> Floats:
    """The series f(d) = sum_{n >= 2} cos(n d)/(n^2 - 1)^2 at angles d [rad]."""
    d, u = _principal_angles(d)
    return np.asarray(
        -0.5 - (math.pi**2 / 24 + 3 / 16) * np.cos(d) + u * np.sin(d) / 4 + u**2 * np.cos(d) / 8
    )


def two_forces(d: Floats) -> Floats:
    """The series 2 sum over even n of cos(n d)/(n^2 - 1)^2 at angles d [rad].

    The series is pi times the bracket of eq. 15.
    """
    # The series is periodic in half a turn and even.
    d = np.mod(d, math.pi)
    d = np.minimum(d, math.pi - d)
    return np.asarray(math.pi * ((math.pi / 8 - d / 4) * np.cos(d) + np.sin(d) / 4 - 1 / math.pi))


def shear_of_one_force(d: Floats) -> Floats:
    """The series sum_{n >= 2} n^2 cos(n d)/(n^2 - 1)^2 at angles d [rad]."""
    angle, u = _principal_angles(d)
    return 0.5 + np.cos(angle) / 4 - u * np.sin(angle) / 2 + one_force(d)


def drag_of_one_force(d: Floats) -> Floats:
    """The series sum_{n >= 2} sin(n d)/(n (n^2 - 1)^2) = Int_0^d f at angles d [rad]."""
    d, u = _principal_angles(d)
    s, c = np.sin(d), np.cos(d)
    return np.asarray(0.5 * u - (math.pi**2 / 24 + 3 / 16) * s - (u * c + s) / 2 + u**2 * s / 8)


def flexibility(
    ring: Ring, radius: float, d: Floats, *, twin: bool, sign: int, thick: bool
) -> Floats:
    """The inward displacement [m/N] of the rim per inward force, at angles d from the force.

    A thick ring bends at the radius of the section's middle, with hoop and shear deformation. A
    mode n of the radial load then moves the ring by (1 + 3 e + n^2 e E/(kappa G)) times as much,
    with e = I/(A r^2), and the mean load stretches the ring. The factor follows from the energy of
    the curved bar (Timoshenko: Strength of Materials II, M = -r H in every mode n >= 2).

    Parameters
    ----------
    ring : the ring
    radius : of the friction surface [m]
    d : angles from the force [rad], any shape
    twin : whether an equal force acts opposite
    sign : side of the friction surface on which the ring lies, +1 outside and -1 inside
    thick : whether the ring is thick
    """
    series = two_forces if twin else one_force
    if not thick:
        return radius**3 / (math.pi * ring.EI) * series(d)
    section = ring.section
    # The model has refused rings without a section and orthotropic materials.
    assert section is not None and isinstance(section.material, Material)
    r = radius + sign * section.thickness / 2
    e = section.thickness**2 / (12 * r**2)
    # E/(kappa G) of an isotropic material.
    shear = 2 * (1 + section.material.nu) * SHEAR_FACTOR
    hoop = 0.5
    n2 = shear_of_one_force(d)
    # The force opposite adds its mean load and its modes, half a turn on.
    if twin:
        hoop, n2 = 1.0, n2 + shear_of_one_force(d + math.pi)
    modes = (1 + 3 * e) * series(d) + e * shear * n2 + e * hoop
    return r**3 / (math.pi * section.bending_stiffness) * modes


def drag_flexibility(ring: Ring, radius: float, d: Floats, *, twin: bool) -> Floats:
    """The inward displacement [m/N] of the rim per force along the rim, towards growing angles.

    The ring keeps its length, w = -v'. The force's moment about the section's middle is neglected.

    Parameters
    ----------
    ring : the ring
    radius : of the friction surface [m]
    d : angles from the force [rad], any shape
    twin : whether an equal force acts opposite
    """
    series = drag_of_one_force(d) + (drag_of_one_force(d + math.pi) if twin else 0.0)
    return -(radius**3) / (math.pi * ring.EI) * series
