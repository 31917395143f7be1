"""Closed-form solutions of elasticity, contact, friction and wear, as references for drumlin.

The benchmark ladder compares drumlin with these solutions. They hold for plane stress and, unless a
docstring says otherwise, for unit width. They use no code of drumlin, so that they are independent
of it.
"""

import math
from itertools import pairwise

import numpy as np
from scipy.optimize import brentq

from drumlin.base.arrays import Floats


def hertz_half_width_and_peak_pressure(
    load: float, radius: float, modulus: float
) -> tuple[float, float]:
    """Half-width a [m] and peak pressure p_0 [Pa] of a line contact (Hertz 1881).

        a^2 = 4 P R/(pi E*),   p_0 = 2 P/(pi a)

    Parameters
    ----------
    load : float
        Force P per width [N/m].
    radius : float
        Relative radius of curvature R [m].
    modulus : float
        Contact modulus E* [Pa].
    """
    half = math.sqrt(4 * load * radius / (math.pi * modulus))
    return half, 2 * load / (math.pi * half)


def dimensionless_persson_clearance_of_disc_in_hole(b: float) -> float:
    """Dimensionless clearance E dR/Q of a disc pressed into a hole of the same material.

    dR is the difference of the radii and Q the force per width. b = tan(eps/2), with eps the
    half-angle of contact (Persson 1964; Ciavarella & Decuzzi 2001).
    """
    return (2 - 2 * b**4 - math.log(1 + b**2)) / (math.pi * b**2 * (1 + b**2))


def dimensionless_persson_pressure_of_disc_in_hole(b: float, theta: Floats) -> Floats:
    """Dimensionless pressure p R/Q (n,) of a loaded disc in a hole, at the angles theta (n,) [rad].

    R is the radius, Q the force per width, and theta counts from the line of force. b = tan(eps/2),
    with eps the half-angle of contact. Beyond the contact the pressure is zero.
    """
    y = np.tan(theta / 2)
    root = np.sqrt(np.maximum(b**2 - y**2, 0))
    q = math.sqrt(b**2 + 1)
    first = 2 * root / (math.pi * q * (1 + y**2))
    p = first + np.log((q + root) / (q - root)) / (2 * math.pi * b**2 * (1 + b**2))
    return np.where(np.abs(theta) < 2 * math.atan(b), p, 0.0)


def westergaard_pressure_of_wavy_surface(mean: float, full: float, psi: Floats) -> Floats:
    """Pressure [Pa] between a wavy elastic half-plane and a flat rigid one (Westergaard 1939).

    Parameters
    ----------
    mean : float
        Mean pressure [Pa].
    full : float
        Smallest mean pressure p* [Pa] at which the whole surface is in contact; above it
        p = mean + p* cos 2 psi.
    psi : array
        Coordinates pi x/lambda along the wave of length lambda [rad].
    """
    if mean >= full:
        return np.asarray(mean + full * np.cos(2 * psi))
    share = mean / full
    root = np.sqrt(np.maximum(share - np.sin(psi) ** 2, 0))
    return np.asarray(2 * mean * np.abs(np.cos(psi)) / share * root)


def lame_displacements_of_ring_edges(
    inner: float, outer: float, pressure: float, E: float, nu: float
) -> tuple[float, float]:
    """Radial displacements [m] of the inner and the outer edge of a ring under inner pressure.

    Source: Lame (1852). The radii `inner` and `outer` are in m, `pressure` and E in Pa.
    """
    c = pressure * inner**2 / (outer**2 - inner**2) / E
    return (
        c * ((1 - nu) * inner + (1 + nu) * outer**2 / inner),
        c * ((1 - nu) * outer + (1 + nu) * outer),
    )


def ring_displacement_per_harmonic_pressure(
    n: int, free: float, held: float, E: float, nu: float
) -> float:
    """Amplitude of the radial displacement [m/Pa] of a ring's free edge under a harmonic pressure.

    The pressure cos(n theta) acts on the free edge; the other edge is fixed. The displacement also
    varies as cos(n theta). It is negative if the free edge is the outer one. Source: Michell (1899)
    and Barber, Elasticity, table 9.1.

    Parameters
    ----------
    n : int
        Order of the harmonic.
    free : float
        Radius of the free edge, on which the pressure acts without shear [m].
    held : float
        Radius of the fixed edge [m].
    E, nu : float
        Young's modulus [Pa] and Poisson's ratio.
    """
    two_mu = E / (1 + nu)
    if n == 0:
        # The displacement is a sum of the terms r and 1/r that vanishes at the fixed edge. The
        # arrays u and s hold the displacement and the radial stress of the two terms at the free
        # edge.
        u = np.array([free, 1 / free])
        s = np.array([E / (1 - nu), -two_mu / free**2])
        held_u = np.array([held, 1 / held])
        ratio = np.array([1.0, -held_u[0] / held_u[1]])
        return float(-(u @ ratio) / (s @ ratio))
    at_free, at_held = (
        _michell_displacements_and_stresses(n, free, nu),
        _michell_displacements_and_stresses(n, held, nu),
    )
    # Four conditions: no displacement at the fixed edge, unit pressure and no shear at the free
    # edge.
    terms = np.linalg.solve(np.vstack([at_held[:2], at_free[2:]]), [0, 0, -1, 0])
    return float(at_free[0] @ terms / two_mu)


def _michell_displacements_and_stresses(n: int, r: float, nu: float) -> Floats:
    """Displacements and stresses (4, 4) at a radius, for the four terms of Michell's solution.

    Each column is a term. The rows are 2 mu u_r, 2 mu u_theta, s_rr and s_rtheta, with the shear
    modulus mu and without the factors cos(n theta) or sin(n theta).

    Parameters
    ----------
    n : int
        Order of the harmonic, 1 or more.
    r : float
        Radius [m].
    nu : float
        Poisson's ratio.
    """
    k = (3 - nu) / (1 + nu)
    if n == 1:
        # For n = 1 the terms r theta sin theta and r ln r cos theta are combined, so that
        # displacements have one value at each point.
        log = math.log(r)
        fourth = [2 * k * log - 1, -1 - 2 * k * log, (k + 3) / r, -(k - 1) / r]
    else:
        fourth = [
            (k + n - 1) * r ** (1 - n),
            -(k - n + 1) * r ** (1 - n),
            -(n + 2) * (n - 1) * r**-n,
            -n * (n - 1) * r**-n,
        ]
    first = [
        -n * r ** (n - 1),
        n * r ** (n - 1),
        -n * (n - 1) * r ** (n - 2),
        n * (n - 1) * r ** (n - 2),
    ]
    second = [
        (k - n - 1) * r ** (n + 1),
        (k + n + 1) * r ** (n + 1),
        -(n + 1) * (n - 2) * r**n,
        n * (n + 1) * r**n,
    ]
    third = [
        n * r ** (-n - 1),
        n * r ** (-n - 1),
        -n * (n + 1) * r ** (-n - 2),
        -n * (n + 1) * r ** (-n - 2),
    ]
    return np.array([first, second, third, fourth]).T


def displacement_exponent_at_sliding_corner(mu: float, nu: float) -> float:
    """The exponent lambda of p ~ r^(lambda - 1) at a right-angled corner on a rigid sliding plane.

    r is the distance from the corner. The plane slides from the corner into the contact, so that
    its friction drags the body away from the corner. Williams' (1952) stress function is r^(lambda
    + 1) F(theta), without traction on the free side theta = pi/2. On the contact side theta = 0 the
    displacement u_theta is zero and the shear is mu times the pressure. The result is the smallest
    root above 1/4, or 1 without friction.
    """
    if mu == 0:
        return 1.0
    k, right = (3 - nu) / (1 + nu), math.pi / 2

    def determinant_of_corner_boundary_conditions(e: float) -> float:
        """Determinant of the four boundary conditions for the exponent e; 0 for a solution.

        The stress function is r^(e+1) F(theta), with F = A cos((e+1) theta) + B sin((e+1) theta) +
        C cos((e-1) theta) + D sin((e-1) theta).
        """
        a, b = e + 1, e - 1
        sa, ca = math.sin(a * right), math.cos(a * right)
        sb, cb = math.sin(b * right), math.cos(b * right)
        # On a ray the stresses are s_rtheta = -e F' and s_thetatheta = e (e + 1) F, times r^(e-1).
        rows = [
            [0.0, a, 0.0, k + e],
            [mu * (e + 1), a, mu * (e + 1), b],
            [ca, sa, cb, sb],
            [-a * sa, a * ca, -b * sb, b * cb],
        ]
        return float(np.linalg.det(np.array(rows)))

    # The first change of sign of the determinant brackets the smallest root.
    exponents = np.linspace(0.25, 0.999, 400)
    for low, high in pairwise(exponents):
        if (
            determinant_of_corner_boundary_conditions(float(low))
            * determinant_of_corner_boundary_conditions(float(high))
            < 0
        ):
            return float(brentq(determinant_of_corner_boundary_conditions, low, high, xtol=1e-14))
    return 1.0


def capstan_tension_ratio(mu: float, angle: float) -> float:
    """Ratio of the tensions at the ends of a belt on a drum, e^(mu angle), with the angle in rad.

    Sources: Euler (1769), Eytelwein (1808).
    """
    return math.exp(mu * angle)


def locking_friction_of_hinged_shoe_with_sine_pressure(
    R: float, a: float, phi_1: float, phi_2: float
) -> float:
    """Coefficient of friction at which a rigid hinged shoe on a lining of springs locks itself.

    At this friction the moment of the pressure p ~ sin phi about the hinge equals the moment of
    friction.

    Parameters
    ----------
    R : float
        Radius of the drum [m].
    a : float
        Distance of the hinge from the drum's centre [m].
    phi_1, phi_2 : float
        Angles of the lining's ends from the line to the hinge [rad].
    """
    # Moments about the hinge: of the pressure, and of friction divided by mu. Both are divided by
    # p_0 b R, with the width b.
    normal = a * ((phi_2 - phi_1) / 2 - (math.sin(2 * phi_2) - math.sin(2 * phi_1)) / 4)
    friction = (
        R * (math.cos(phi_1) - math.cos(phi_2))
        - a * (math.sin(phi_2) ** 2 - math.sin(phi_1) ** 2) / 2
    )
    return normal / friction


def pressure_per_compression_of_thin_bonded_layer(E: float, nu: float, thickness: float) -> float:
    """Stiffness E/((1 - nu^2) t) [Pa/m] through a thin layer that is bonded to a rigid back.

    The layer cannot extend along its back.
    """
    return E / ((1 - nu**2) * thickness)


def flat_punch_pressure(load: float, half: float, x: Floats) -> Floats:
    """Pressure (n,) [Pa] under a rigid frictionless flat punch (Sadowsky 1928).

        p = P/(pi sqrt(a^2 - x^2)),   |x| < a

    Parameters
    ----------
    load : float
        Force P per width [N/m].
    half : float
        Half-width a of the punch [m].
    x : array (n,)
        Coordinates, from the middle of the punch [m].
    """
    return np.asarray(load / (math.pi * np.sqrt(half**2 - x**2)))


def equivalent_over_actual_friction_of_block(half: float) -> float:
    """Equivalent divided by actual coefficient of friction of a block with p = p_0 cos phi.

        mu'/mu = 4 sin half/(2 half + sin 2 half)

    `half` is half of the angle of the block's arc [rad]. Source: NPTEL lesson 12.1.
    """
    return 4 * math.sin(half) / (2 * half + math.sin(2 * half))
