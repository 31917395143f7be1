"""Closed forms of elasticity, contact, friction and wear, which judge the benchmark ladder.

They hold for plane stress and, unless a docstring says otherwise, for unit width. They use no part
of drumlin that they judge.
"""

import math
from itertools import pairwise

import numpy as np
from scipy.optimize import brentq

from drumlin.base.arrays import Floats


def hertz_line_contact(load: float, radius: float, modulus: float) -> tuple[float, float]:
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


def persson_clearance(b: float) -> float:
    """Clearance E dR/Q of a disc in a hole of the same material, by b = tan(eps/2).

    dR is the difference of the radii, Q the force per width, eps the half-angle of contact (Persson
    1964; Ciavarella & Decuzzi 2001).
    """
    return (2 - 2 * b**4 - math.log(1 + b**2)) / (math.pi * b**2 * (1 + b**2))


def persson_pressure(b: float, theta: Floats) -> Floats:
    """Pressure p R/Q (n,) of a disc in a hole at theta (n,) [rad]; zero beyond the contact."""
    y = np.tan(theta / 2)
    root = np.sqrt(np.maximum(b**2 - y**2, 0))
    q = math.sqrt(b**2 + 1)
    first = 2 * root / (math.pi * q * (1 + y**2))
    p = first + np.log((q + root) / (q - root)) / (2 * math.pi * b**2 * (1 + b**2))
    return np.where(np.abs(theta) < 2 * math.atan(b), p, 0.0)


def westergaard_pressure(mean: float, full: float, psi: Floats) -> Floats:
    """Pressure [Pa] of a wavy half-plane (Westergaard 1939).

    Parameters
    ----------
    mean : float
        Mean pressure [Pa].
    full : float
        Mean pressure p* [Pa] from which on the whole surface is in contact; then
        p = mean + p* cos 2 psi.
    psi : array
        Places pi x/lambda along the wave of length lambda [rad].
    """
    if mean >= full:
        return np.asarray(mean + full * np.cos(2 * psi))
    share = mean / full
    root = np.sqrt(np.maximum(share - np.sin(psi) ** 2, 0))
    return np.asarray(2 * mean * np.abs(np.cos(psi)) / share * root)


def lame_displacements(
    inner: float, outer: float, pressure: float, E: float, nu: float
) -> tuple[float, float]:
    """Radial displacements [m] of the inner and outer edge of a ring under inner pressure.

    After Lame (1852). The radii `inner` and `outer` are in m, `pressure` and E in Pa.
    """
    c = pressure * inner**2 / (outer**2 - inner**2) / E
    return (
        c * ((1 - nu) * inner + (1 + nu) * outer**2 / inner),
        c * ((1 - nu) * outer + (1 + nu) * outer),
    )


def ring_compliance(n: int, free: float, held: float, E: float, nu: float) -> float:
    """Radial displacement [m/Pa] of a ring's free edge under the pressure cos(n theta) there.

    The displacement goes with cos(n theta) as well. It is negative where the ring lies inside its
    free edge. By Michell's solution (1899; Barber, Elasticity, table 9.1).

    Parameters
    ----------
    n : int
        Order of the harmonic.
    free : float
        Radius of the edge with the pressure and without shear [m].
    held : float
        Radius of the edge that is held fast [m].
    E, nu : float
        Young's modulus [Pa] and Poisson's ratio.
    """
    two_mu = E / (1 + nu)
    if n == 0:
        # Displacement and radial stress of the terms r and 1/r. Their sum is zero at `held`.
        u = np.array([free, 1 / free])
        s = np.array([E / (1 - nu), -two_mu / free**2])
        held_u = np.array([held, 1 / held])
        ratio = np.array([1.0, -held_u[0] / held_u[1]])
        return float(-(u @ ratio) / (s @ ratio))
    at_free, at_held = _michell_terms(n, free, nu), _michell_terms(n, held, nu)
    # Four conditions: no displacement at `held`, unit pressure and no shear at `free`.
    terms = np.linalg.solve(np.vstack([at_held[:2], at_free[2:]]), [0, 0, -1, 0])
    return float(at_free[0] @ terms / two_mu)


def _michell_terms(n: int, r: float, nu: float) -> Floats:
    """Displacements and stresses (4, 4) at a radius, a column for each of Michell's four terms.

    The rows are 2 mu u_r, 2 mu u_theta, s_rr and s_rtheta.

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
        # The terms r theta sin and r ln r cos, combined for single-valued displacements.
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


def corner_exponent(mu: float, nu: float) -> float:
    """The exponent lambda of p ~ r^(lambda - 1) at a right-angled edge on a rigid sliding plane.

    The plane slides onto the edge. Williams' (1952) stress function is r^(lambda + 1) F(theta),
    without traction at theta = pi/2. At theta = 0 the displacement u_theta is zero and the shear is
    mu times the pressure. The result is the smallest root above 1/4, or 1 without friction.
    """
    if mu == 0:
        return 1.0
    k, right = (3 - nu) / (1 + nu), math.pi / 2

    def determinant(e: float) -> float:
        """Determinant of the conditions on A cos(e+1) + B sin(e+1) + C cos(e-1) + D sin(e-1)."""
        a, b = e + 1, e - 1
        sa, ca = math.sin(a * right), math.cos(a * right)
        sb, cb = math.sin(b * right), math.cos(b * right)
        # s_rtheta = -e F' and s_thetatheta = e (e + 1) F.
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
        if determinant(float(low)) * determinant(float(high)) < 0:
            return float(brentq(determinant, low, high, xtol=1e-14))
    return 1.0


def capstan_tension_ratio(mu: float, angle: float) -> float:
    """Ratio of the tensions at the ends of a belt, e^(mu angle) (Euler 1769; Eytelwein 1808)."""
    return math.exp(mu * angle)


def sine_shoe_locking_friction(R: float, a: float, phi_1: float, phi_2: float) -> float:
    """Friction at which a rigid shoe with a lining of springs locks itself.

    The moments of p ~ sin phi and of its friction about the hinge balance each other.

    Parameters
    ----------
    R : float
        Radius of the drum [m].
    a : float
        Distance of the hinge from the drum's centre [m].
    phi_1, phi_2 : float
        Ends of the lining, from the hinge [rad].
    """
    # Moments about the hinge by the integrals of sin^2 phi and of (R - a cos phi) sin phi.
    normal = a * ((phi_2 - phi_1) / 2 - (math.sin(2 * phi_2) - math.sin(2 * phi_1)) / 4)
    friction = (
        R * (math.cos(phi_1) - math.cos(phi_2))
        - a * (math.sin(phi_2) ** 2 - math.sin(phi_1) ** 2) / 2
    )
    return normal / friction


def bonded_layer_stiffness(E: float, nu: float, thickness: float) -> float:
    """Stiffness E/((1 - nu^2) t) [Pa/m] of a thin layer that cannot spread along its back."""
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
        Places, from the middle of the punch [m].
    """
    return np.asarray(load / (math.pi * np.sqrt(half**2 - x**2)))


def block_friction_ratio(half: float) -> float:
    """Equivalent over actual friction of a block under p = p_0 cos phi (NPTEL lesson 12.1).

        mu'/mu = 4 sin half/(2 half + sin 2 half)

    half : half of the block's arc [rad].
    """
    return 4 * math.sin(half) / (2 * half + math.sin(2 * half))
