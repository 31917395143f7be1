"""Resultants of a pressure distribution: integrals of piecewise polynomials over an arc."""

from functools import cache
from typing import NamedTuple

import numpy as np

from drumlin.arrays import Floats

GAUSS, WEIGHTS = np.polynomial.legendre.leggauss(6)


class Resultant(NamedTuple):
    """What the drum does to the lining: forces of pressure and of friction (2,) [N], moment about O [N m]."""

    normal: Floats
    friction: Floats
    moment: float

    @property
    def force(self) -> Floats:
        """The whole force (2,) [N]."""
        return self.normal + self.friction


def cross(a: Floats, b: Floats) -> Floats:
    """The out-of-plane component of a x b, (..., 2)."""
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


def shape(order: int, xi: Floats) -> Floats:
    """Lagrange shape functions of degree `order` on nodes evenly spaced over [-1, 1]: (order + 1, len(xi))."""
    nodes = np.linspace(-1, 1, order + 1)
    return np.array(
        [np.prod([(xi - b) / (a - b) for j, b in enumerate(nodes) if j != i], axis=0) for i, a in enumerate(nodes)]
    ).reshape(order + 1, len(xi))


def slopes(order: int, xi: Floats) -> Floats:
    """Derivatives of these shape functions at xi (any shape): (order + 1, *xi.shape)."""
    nodes = np.linspace(-1, 1, order + 1)
    return np.array([np.polyval(np.polyder(np.polyfit(nodes, row, order)), xi) for row in np.eye(order + 1)])


@cache
def _at_gauss(order: int) -> Floats:
    return shape(order, GAUSS)


def gauss_points(theta: Floats, values: Floats, order: int) -> tuple[Floats, Floats, Floats]:
    """Angles, values and weights (pieces, points) of a Gauss rule on every piece of a piecewise polynomial."""
    ends = theta[::order]
    half = 0.5 * np.diff(ends)[:, None]
    pieces = np.arange(len(ends) - 1)[:, None] * order + np.arange(order + 1)
    return ends[:-1, None] + half * (1 + GAUSS), values[pieces] @ _at_gauss(order), half * WEIGHTS


def integrate(theta: Floats, values: Floats, order: int) -> float:
    """Integral of a piecewise polynomial (nodes `theta` (n,), `values` (n,)) over theta."""
    _, v, w = gauss_points(theta, values, order)
    return float(np.sum(v * w))


def resultant(
    theta: Floats, pressure: Floats, *, order: int, radius: float, width: float, sign: int, drag: float
) -> Resultant:
    """Resultant on the lining of the traction -p n + drag p e_theta, n = sign e_r, drag = mu s.

    `theta` (n,) [rad], `pressure` (n,) [Pa] piecewise of degree `order`; `radius`, `width` [m].
    """
    angle, p, w = gauss_points(theta, pressure, order)
    load = p * w * radius * width
    c, s = np.cos(angle), np.sin(angle)
    along = np.array([np.sum(load * c), np.sum(load * s)])
    across = np.array([-along[1], along[0]])
    return Resultant(-sign * along, drag * across, float(np.sum(load)) * drag * radius)
