"""Resultants of a pressure distribution, and where it ends: integrals of piecewise polynomials over an arc."""

import math
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre

from drumlin.arrays import Floats

GAUSS, WEIGHTS = legendre.leggauss(12)


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


@cache
def lobatto(order: int) -> Floats:
    """Gauss-Lobatto points (order + 1,) on [-1, 1]: the nodes of a polynomial of this degree; up to 2 evenly spaced."""
    inner = np.sort(legendre.legroots(legendre.legder(np.eye(order + 1)[order])).real) if order > 1 else np.zeros(0)
    return np.concatenate([[-1.0], 0.5 * (inner - inner[::-1]), [1.0]])


@cache
def _coefficients(order: int) -> Floats:
    """Coefficients in Legendre's polynomials of the shape functions: (order + 1, order + 1), a column each."""
    return np.asarray(np.linalg.inv(legendre.legvander(lobatto(order), order)), dtype=float)


def angle_near(middle: float, xy: Floats) -> Floats:
    """Angles [rad] of the points xy (2, ...), within half a turn of `middle` [rad]."""
    return np.asarray(middle + np.angle(np.exp(-1j * middle) * (xy[0] + 1j * xy[1])))


def shape(order: int, xi: Floats) -> Floats:
    """Lagrange shape functions of degree `order` on the nodes `lobatto` at xi (any shape): (order + 1, *xi.shape)."""
    return np.moveaxis(legendre.legvander(xi, order) @ _coefficients(order), -1, 0)


def slopes(order: int, xi: Floats) -> Floats:
    """Derivatives of these shape functions at xi (any shape): (order + 1, *xi.shape)."""
    derivative = legendre.legder(_coefficients(order))
    return np.moveaxis(legendre.legvander(xi, order - 1) @ derivative, -1, 0)


@cache
def _at_gauss(order: int) -> Floats:
    return shape(order, GAUSS)


def gauss_points(theta: Floats, values: Floats, order: int) -> tuple[Floats, Floats, Floats]:
    """Angles, values and weights (pieces, points) of a Gauss rule on every piece of a piecewise polynomial."""
    ends = theta[::order]
    half = 0.5 * np.diff(ends)[:, None]
    pieces = np.arange(len(ends) - 1)[:, None] * order + np.arange(order + 1)
    return ends[:-1, None] + half * (1 + GAUSS), values[pieces] @ _at_gauss(order), half * WEIGHTS


SAMPLES = np.cos(np.linspace(math.pi, 0.0, 25))
"""Where in a piece its largest value is looked for; between them a parabola tells."""


def largest(theta: Floats, values: Floats, order: int, zone: float = 0.0) -> float:
    """Largest value of a piecewise polynomial more than `zone` [rad] from its ends; everywhere where nothing else
    is.
    """
    first, last = float(theta[0]) + zone, float(theta[-1]) - zone
    ends = theta[::order]
    low, high = (ends[:-1], ends[1:]) if first >= last else (np.maximum(ends[:-1], first), np.minimum(ends[1:], last))
    on = np.flatnonzero(low < high)
    half, middle = 0.5 * (ends[on + 1] - ends[on]), 0.5 * (ends[on + 1] + ends[on])
    xi = (0.5 * (low + high)[on] - middle)[:, None] + 0.5 * (high - low)[on][:, None] * SAMPLES
    pieces = values[on[:, None] * order + np.arange(order + 1)]
    found = np.einsum("aij,ia->ij", shape(order, xi / half[:, None]), pieces)
    i, j = np.unravel_index(found.argmax(), found.shape)
    if j in {0, len(SAMPLES) - 1}:
        return float(found[i, j])
    x, y = SAMPLES[j - 1 : j + 2], found[i, j - 1 : j + 2]
    a, b, c = np.polyfit(x - x[1], y, 2)
    return float(max(y[1], c - b * b / (4 * a))) if a < 0 else float(y[1])


def edge_left_out(theta: Floats, pressure: Floats, order: int, zone: float) -> float:
    """The zone [rad] at the ends that may be left out of judging p(theta): none where half of the force is there."""
    at, p, w = gauss_points(theta, pressure, order)
    inside = (at > theta[0] + zone) & (at < theta[-1] - zone)
    return zone if (p * w)[inside].sum() > 0.5 * (p * w).sum() else 0.0


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


def contact_arcs(
    theta: Floats, pressure: Floats, order: int, *, located: bool = True
) -> tuple[tuple[float, float], ...]:
    """Arcs [rad] in which the lining is pressed; theta (n,) [rad], pressure (n,) [Pa], piecewise of degree `order`.

    Nodes next to a pressed one belong to its arc; an end without pressure is then located within its step, unless
    not `located`.
    """
    pressed = pressure > 0
    steps = pressed[:-1] | pressed[1:]
    last = len(theta) - 1
    arcs = []
    for i in range(last):
        if steps[i] and not (i and steps[i - 1]):
            start = i
        if steps[i] and not (i + 1 < last and steps[i + 1]):
            ends = float(theta[start]), float(theta[i + 1])
            if located:
                ends = (
                    _end(theta, pressure, start, order),
                    -_end(-theta[::-1], pressure[::-1], last - i - 1, order),
                )
            arcs.append(ends)
    return tuple(arcs)


def _end(theta: Floats, pressure: Floats, node: int, order: int) -> float:
    """The end between `node` and the next one of an arc that begins at `node`.

    The pressure of a smooth contact falls to its end e as sqrt(theta - e), so that F = Int_e p dtheta has
    F^(2/3) linear in theta: the line through its values at the ends of the first two elements gives e. Integrals
    of the pressure scatter far less than its nodal values.
    """
    i = node // order * order
    if pressure[node] > 0 or i + 2 * order >= len(theta):
        return float(theta[node])
    near, far = i + order, i + 2 * order
    f = [max(integrate(theta[i : k + 1], pressure[i : k + 1], order), 0.0) ** (2 / 3) for k in (near, far)]
    if f[1] <= f[0]:
        return float(theta[node])
    end = theta[near] - f[0] * (theta[far] - theta[near]) / (f[1] - f[0])
    return float(min(max(end, theta[node]), theta[node + 1]))
