"""Closed forms of elasticity, contact, friction and wear: what the benchmark ladder is judged by.

Plane stress, unit width unless said. Nothing here is computed by the parts of drumlin that it
judges.
"""

import math

import numpy as np
from scipy.optimize import brentq

from drumlin.base.arrays import Floats


def hertz(load: float, radius: float, modulus: float) -> tuple[float, float]:
    """Half-width [m] and peak pressure [Pa] of a line contact (Hertz 1881): a^2 = 4 P R/(pi E*),
    p_0 = 2 P/(pi a).
    """
    half = math.sqrt(4 * load * radius / (math.pi * modulus))
    return half, 2 * load / (math.pi * half)


def persson_clearance(b: float) -> float:
    """E dR / Q of a disc in a hole of the same material, b = tan(eps/2) (Persson 1964; Ciavarella &
    Decuzzi 2001).
    """
    return (2 - 2 * b**4 - math.log(1 + b**2)) / (math.pi * b**2 * (1 + b**2))


def persson_pressure(b: float, theta: Floats) -> Floats:
    """p R / Q (n,) of that disc at theta (n,) [rad]; 0 outside |theta| < eps."""
    y = np.tan(theta / 2)
    root = np.sqrt(np.maximum(b**2 - y**2, 0))
    q = math.sqrt(b**2 + 1)
    first = 2 * root / (math.pi * q * (1 + y**2))
    p = first + np.log((q + root) / (q - root)) / (2 * math.pi * b**2 * (1 + b**2))
    return np.where(np.abs(theta) < 2 * math.atan(b), p, 0.0)


def westergaard(mean: float, full: float, psi: Floats) -> Floats:
    """p at psi = pi x/lambda of a wavy half-plane under a mean pressure (Westergaard 1939), p* =
    `full`.

    For mean >= p* all is in contact, p = mean + p* cos 2 psi.
    """
    if mean >= full:
        return np.asarray(mean + full * np.cos(2 * psi))
    share = mean / full
    root = np.sqrt(np.maximum(share - np.sin(psi) ** 2, 0))
    return np.asarray(2 * mean * np.abs(np.cos(psi)) / share * root)


def lame(inner: float, outer: float, pressure: float, E: float, nu: float) -> tuple[float, float]:
    """Radial displacements [m] at both edges of a ring under inner pressure (Lame 1852), plane
    stress.
    """
    c = pressure * inner**2 / (outer**2 - inner**2) / E
    return (
        c * ((1 - nu) * inner + (1 + nu) * outer**2 / inner),
        c * ((1 - nu) * outer + (1 + nu) * outer),
    )


def ring_yield(n: int, free: float, held: float, E: float, nu: float) -> float:
    """Radial displacement at r = free, over cos(n theta), under the pressure cos(n theta) there,
    held fast at r = held.

    Michell's solution (1899; Barber, Elasticity, table 9.1), no shear at r = free: [m/Pa], negative
    where the ring lies inside of its free edge.
    """
    k, two_mu = (3 - nu) / (1 + nu), E / (1 + nu)
    if n == 0:
        u = np.array([free, 1 / free])
        s = np.array([E / (1 - nu), -two_mu / free**2])
        held_u = np.array([held, 1 / held])
        ratio = np.array([1.0, -held_u[0] / held_u[1]])
        return float(-(u @ ratio) / (s @ ratio))

    def columns(r: float) -> Floats:
        """u_r, u_theta (times 2 mu), s_rr, s_rtheta of the four terms."""
        fourth: list[float]
        if n == 1:  # r theta sin and r ln r cos, so that displacements are those of one value
            log = math.log(r)
            fourth = [2 * k * log - 1, -1 - 2 * k * log, (k + 3) / r, -(k - 1) / r]
        else:
            fourth = [
                (k + n - 1) * r ** (1 - n),
                -(k - n + 1) * r ** (1 - n),
                -(n + 2) * (n - 1) * r**-n,
                -n * (n - 1) * r**-n,
            ]
        return np.array(
            [
                [
                    -n * r ** (n - 1),
                    n * r ** (n - 1),
                    -n * (n - 1) * r ** (n - 2),
                    n * (n - 1) * r ** (n - 2),
                ],
                [
                    (k - n - 1) * r ** (n + 1),
                    (k + n + 1) * r ** (n + 1),
                    -(n + 1) * (n - 2) * r**n,
                    n * (n + 1) * r**n,
                ],
                [
                    n * r ** (-n - 1),
                    n * r ** (-n - 1),
                    -n * (n + 1) * r ** (-n - 2),
                    -n * (n + 1) * r ** (-n - 2),
                ],
                fourth,
            ]
        ).T

    at_free, at_held = columns(free), columns(held)
    terms = np.linalg.solve(np.vstack([at_held[:2], at_free[2:]]), [0, 0, -1, 0])
    return float(at_free[0] @ terms / two_mu)


def corner_exponent(mu: float, nu: float) -> float:
    """lambda of p ~ r^(lambda - 1) at a right-angled edge on a rigid plane that slides onto it,
    plane stress.

    Williams' (1952) stress function r^(lambda + 1) F(theta): no traction at theta = pi/2; u_theta =
    0 and shear mu times pressure at theta = 0. The smallest root above 1/4; 1 without friction.
    """
    if mu == 0:
        return 1.0
    k, right = (3 - nu) / (1 + nu), math.pi / 2

    def determinant(e: float) -> float:
        """Of the conditions on A cos(e+1) + B sin(e+1) + C cos(e-1) + D sin(e-1)."""
        a, b = e + 1, e - 1
        sa, ca, sb, cb = (
            math.sin(a * right),
            math.cos(a * right),
            math.sin(b * right),
            math.cos(b * right),
        )
        rows = [
            [0.0, a, 0.0, k + e],
            [mu * (e + 1), a, mu * (e + 1), b],  # s_rt = -e F', s_tt = e (e + 1) F
            [ca, sa, cb, sb],
            [-a * sa, a * ca, -b * sb, b * cb],
        ]
        return float(np.linalg.det(np.array(rows)))

    places = np.linspace(0.25, 0.999, 400)
    values = [determinant(float(e)) for e in places]
    for low, high, before, after in zip(places, places[1:], values, values[1:], strict=False):
        if before * after < 0:
            return float(brentq(determinant, low, high, xtol=1e-14))
    return 1.0


def capstan(mu: float, angle: float) -> float:
    """Ratio of a belt's tensions, e^(mu angle) (Euler 1769; Eytelwein 1808)."""
    return math.exp(mu * angle)


def sine_shoe_limit(R: float, a: float, phi_1: float, phi_2: float) -> float:
    """Friction at which a rigid shoe on a Winkler lining locks itself: moments of p ~ sin phi about
    its hinge.
    """
    normal = a * ((phi_2 - phi_1) / 2 - (math.sin(2 * phi_2) - math.sin(2 * phi_1)) / 4)
    friction = (
        R * (math.cos(phi_1) - math.cos(phi_2))
        - a * (math.sin(phi_2) ** 2 - math.sin(phi_1) ** 2) / 2
    )
    return normal / friction


def bonded_layer(E: float, nu: float, thickness: float) -> float:
    """Stiffness [Pa/m] of a thin layer that cannot spread along its back, plane stress: E/((1 -
    nu^2) t).
    """
    return E / ((1 - nu**2) * thickness)


def flat_punch(load: float, half: float, x: Floats) -> Floats:
    """p (n,) under a rigid frictionless flat punch (Sadowsky 1928): P/(pi sqrt(a^2 - x^2)), |x| <
    a.
    """
    return np.asarray(load / (math.pi * np.sqrt(half**2 - x**2)))


def equivalent_block(half: float) -> float:
    """mu'/mu of a block of this half-arc [rad] under p = p_0 cos: 4 sin/(2 half + sin 2 half)
    (NPTEL lesson 12.1).
    """
    return 4 * math.sin(half) / (2 * half + math.sin(2 * half))
