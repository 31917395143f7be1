"""Deflection of a circular ring under forces on its rim, in closed form.

Let R be the radius of a thin ring, EI its bending stiffness, and d the angle from a radial force. A
unit force on the rim is the line load 1/(pi R) (1/2 + sum_{n >= 1} cos(n d)). The mean of the load
does not bend the ring, and the drum's shaft carries the mode n = 1. A line load cos(n d) with
n >= 2 moves the rim radially by R^4/(EI (n^2 - 1)^2) cos(n d). At the angle d from an inward force
N the rim therefore moves inwards by

    z = N R^3/(pi EI) f(d),      f(d) = sum_{n >= 2} cos(n d)/(n^2 - 1)^2.

Under two equal and opposite forces the odd modes cancel and the even modes double. The result is
eq. 13 and 15 of Barecki & Scieszka (1987).
"""

import math

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake.components import DrumRing
from drumlin.brake.fields import Material

INVERSE_SHEAR_CORRECTION_FACTOR = 6 / 5
"""Shear factor 1/kappa of a rectangular cross-section; its shear stiffness is kappa G A."""


def _angle_within_full_turn_and_its_difference_from_pi(d: Floats) -> tuple[Floats, Floats]:
    """The angles d [rad] minus full turns, in [0, 2 pi), and pi minus these angles."""
    d = np.mod(d, 2 * math.pi)
    return d, math.pi - d


def deflection_series_of_one_radial_force(d: Floats) -> Floats:
    """The series f(d) = sum_{n >= 2} cos(n d)/(n^2 - 1)^2 of a ring under one radial force.

    d are angles [rad] from the force, of any shape. The result has the same shape.
    """
    d, u = _angle_within_full_turn_and_its_difference_from_pi(d)
    return np.asarray(
        -0.5 - (math.pi**2 / 24 + 3 / 16) * np.cos(d) + u * np.sin(d) / 4 + u**2 * np.cos(d) / 8
    )


def deflection_series_of_two_opposite_forces(d: Floats) -> Floats:
    """The deflection series of a ring under two opposite radial forces, by the angle d [rad].

    The series is 2 sum over even n >= 2 of cos(n d)/(n^2 - 1)^2, which is pi times the bracket in
    eq. 15 of Barecki & Scieszka (1987). d is the angle from one of the forces and has any shape.
    """
    # The series is an even function of d with the period pi.
    d = np.mod(d, math.pi)
    d = np.minimum(d, math.pi - d)
    return np.asarray(math.pi * ((math.pi / 8 - d / 4) * np.cos(d) + np.sin(d) / 4 - 1 / math.pi))


def shear_series_of_one_radial_force(d: Floats) -> Floats:
    """The series sum_{n >= 2} n^2 cos(n d)/(n^2 - 1)^2 of a ring's shear under one radial force.

    d are angles [rad] from the force, of any shape. The result has the same shape.
    """
    angle, u = _angle_within_full_turn_and_its_difference_from_pi(d)
    return (
        0.5 + np.cos(angle) / 4 - u * np.sin(angle) / 2 + deflection_series_of_one_radial_force(d)
    )


def deflection_series_of_one_tangential_force(d: Floats) -> Floats:
    """The series of the radial displacement of a ring under one force along its rim.

    The series is sum_{n >= 2} sin(n d)/(n (n^2 - 1)^2), the integral of
    `deflection_series_of_one_radial_force` from 0 to d. d are angles [rad] from the force, of any
    shape. The result has the same shape.
    """
    d, u = _angle_within_full_turn_and_its_difference_from_pi(d)
    s, c = np.sin(d), np.cos(d)
    return np.asarray(0.5 * u - (math.pi**2 / 24 + 3 / 16) * s - (u * c + s) / 2 + u**2 * s / 8)


def inward_ring_displacement_per_radial_force(
    ring: DrumRing, radius: float, d: Floats, *, twin: bool, sign: int, thick: bool
) -> Floats:
    """The inward displacement [m/N] of a ring's rim per inward radial force.

    A thin ring bends at the radius of the friction surface. A thick ring bends at the radius r of
    its section's middle, and it has hoop and shear deformation as well. Let I be the second moment
    and A the area of its section, and e = I/(A r^2). The displacement of a thick ring in the mode n
    is 1 + 3 e + n^2 e E/(kappa G) times the displacement of a thin ring. This ratio follows from
    the energy of a curved bar (Timoshenko: Strength of Materials II, with moment M = -r H and hoop
    force H in modes n >= 2). The mean of the load stretches or compresses a thick ring.

    Parameters
    ----------
    ring : the ring
    radius : radius of the friction surface [m]
    d : angles from the force [rad], any shape; the result has the same shape
    twin : whether an equal force acts on the opposite side of the ring
    sign : +1 if the ring lies outside the friction surface, -1 if it lies inside
    thick : whether to compute the ring as thick, with hoop and shear deformation
    """
    series = (
        deflection_series_of_two_opposite_forces if twin else deflection_series_of_one_radial_force
    )
    if not thick:
        return radius**3 / (math.pi * ring.EI) * series(d)
    section = ring.section
    # `validated_names_of_effects_to_include` and `reason_against_foundation_model` refuse rings
    # without a section and orthotropic materials.
    assert section is not None and isinstance(section.material, Material)
    r = radius + sign * section.thickness / 2
    e = section.thickness**2 / (12 * r**2)
    # The ratio E/(kappa G) of Young's modulus to the effective shear modulus.
    shear = 2 * (1 + section.material.nu) * INVERSE_SHEAR_CORRECTION_FACTOR
    # The mean of the line load of one force, in units of 1/(pi R).
    hoop = 0.5
    n2 = shear_series_of_one_radial_force(d)
    # An equal force on the opposite side doubles the mean load. Its shear series is that of the
    # first force, turned by pi.
    if twin:
        hoop, n2 = 1.0, n2 + shear_series_of_one_radial_force(d + math.pi)
    modes = (1 + 3 * e) * series(d) + e * shear * n2 + e * hoop
    return r**3 / (math.pi * section.bending_stiffness) * modes


def inward_ring_displacement_per_tangential_force(
    ring: DrumRing, radius: float, d: Floats, *, twin: bool
) -> Floats:
    """The inward displacement [m/N] of a ring's rim per force along the rim.

    The force points towards growing angles. The ring keeps its length: its outward displacement w
    and its displacement v along the rim satisfy w = -v'. The moment of the force about the middle
    of the ring's section is neglected.

    Parameters
    ----------
    ring : the ring
    radius : radius of the friction surface [m]
    d : angles from the force [rad], any shape; the result has the same shape
    twin : whether an equal force acts on the opposite side of the ring
    """
    series = deflection_series_of_one_tangential_force(d) + (
        deflection_series_of_one_tangential_force(d + math.pi) if twin else 0.0
    )
    return -(radius**3) / (math.pi * ring.EI) * series
