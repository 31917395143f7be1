"""Resultants of a pressure distribution, and where it ends: integrals of piecewise polynomials over
an arc.
"""

import math
from dataclasses import dataclass
from functools import cache, cached_property
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre

from drumlin.arrays import Floats, Ints
from drumlin.brake.surface import FrictionSurface

GAUSS, WEIGHTS = legendre.leggauss(12)


class Resultant(NamedTuple):
    """What the surface does to the lining: forces of pressure and of friction (2,) [N], moment [N
    m] about the origin.
    """

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
    """Gauss-Lobatto points (order + 1,) on [-1, 1]: the nodes of a polynomial of this degree; up to
    2 evenly spaced.
    """
    inner = (
        np.sort(legendre.legroots(legendre.legder(np.eye(order + 1)[order])).real)
        if order > 1
        else np.zeros(0)
    )
    return np.concatenate([[-1.0], 0.5 * (inner - inner[::-1]), [1.0]])


@cache
def _coefficients(order: int) -> Floats:
    """Coefficients in Legendre's polynomials of the shape functions: (order + 1, order + 1), a
    column each.
    """
    return np.asarray(np.linalg.inv(legendre.legvander(lobatto(order), order)), dtype=float)


def shape(order: int, xi: Floats) -> Floats:
    """Lagrange shape functions of degree `order` on the nodes `lobatto` at xi (any shape): (order +
    1, *xi.shape).
    """
    rows = _legendre(order, xi)
    return (_coefficients(order).T @ rows.reshape(order + 1, -1)).reshape(rows.shape)


def _legendre(order: int, xi: Floats) -> Floats:
    """Legendre's polynomials up to a degree at xi (any shape), by their recurrence: (order + 1,
    *xi.shape).
    """
    rows = np.ones((order + 1, *np.shape(xi)))
    if order > 0:
        rows[1] = xi
    for i in range(1, order):
        rows[i + 1] = ((2 * i + 1) * rows[1] * rows[i] - i * rows[i - 1]) / (i + 1)
    return rows


@cache
def _integrals(order: int) -> Floats:
    """Coefficients in Legendre's polynomials of the integrals of the shape functions from -1 on: a
    row each, (order + 1, order + 2).
    """
    return np.ascontiguousarray(legendre.legint(_coefficients(order), lbnd=-1).T)


def slopes(order: int, xi: Floats) -> Floats:
    """Derivatives of these shape functions at xi (any shape): (order + 1, *xi.shape)."""
    derivative = legendre.legder(_coefficients(order))
    return np.moveaxis(legendre.legvander(xi, order - 1) @ derivative, -1, 0)


@cache
def at_gauss(order: int) -> tuple[Floats, Floats]:
    """These shape functions and their derivatives (order + 1, q) at the points GAUSS."""
    return shape(order, GAUSS), slopes(order, GAUSS)


@cache
def _weights(order: int) -> Floats:
    """Integrals (order + 1,) of these shape functions over a piece of length 1."""
    return np.asarray(at_gauss(order)[0] @ WEIGHTS / 2, dtype=float)


def gauss_points(theta: Floats, values: Floats, order: int) -> tuple[Floats, Floats, Floats]:
    """Angles, values and weights (pieces, points) of a Gauss rule on every piece of a piecewise
    polynomial.
    """
    ends = theta[::order]
    half = 0.5 * (ends[1:] - ends[:-1])[:, None]
    return (
        ends[:-1, None] + half * (1 + GAUSS),
        by_piece(values, order) @ at_gauss(order)[0],
        half * WEIGHTS,
    )


def by_piece(values: Floats, order: int) -> Floats:
    """The nodal values (pieces, order + 1) of each piece of a piecewise polynomial."""
    count = (len(values) - 1) // order
    found = np.empty((count, order + 1))
    found[:, :-1], found[:, -1] = values[: count * order].reshape(-1, order), values[order::order]
    return found


PEAK_SAMPLES = np.cos(np.linspace(math.pi, 0.0, 25))
"""Where in a piece its largest value is looked for; between them a parabola tells."""


@cache
def _at_samples(order: int) -> Floats:
    return shape(order, PEAK_SAMPLES)


@dataclass(frozen=True)
class InnerPart:
    """The part of a line more than `zone` [rad] from its ends, for all piecewise polynomials on its
    nodes theta (n,), growing; none where nothing is so far away.
    """

    theta: Floats
    order: int
    zone: float

    @cached_property
    def weights(self) -> Floats:
        """Integrals (2, n) over the whole line and over this part of it, per nodal value."""
        ends, order = self.theta[:: self.order], self.order
        zone = min(self.zone, 0.5 * float(ends[-1] - ends[0]))
        half = 0.5 * (ends[1:] - ends[:-1])
        at = np.array([ends[0], ends[0] + zone, ends[-1] - zone, ends[-1]])
        xi = np.minimum(
            np.maximum((at[:, None] - ends[:-1]) / half - 1, -1.0), 1.0
        )  # in each piece
        up_to = half[:, None] * (
            _integrals(order) @ _legendre(order + 1, xi).swapaxes(0, 1)
        ).swapaxes(1, 2)
        own = up_to[3:1:-1] - up_to[:2]
        found = np.zeros((2, len(self.theta)))
        found[:, :-1] = own[:, :, :-1].reshape(2, -1)
        found[:, order::order] += own[:, :, -1]
        return found

    def part(self, values: Floats) -> float:
        """The part of the integral that is inside."""
        whole, inside = (self.weights @ values).tolist()
        return float(inside / (whole or 1.0))

    @cached_property
    def samples(self) -> tuple[slice, Ints, Floats]:
        """The pieces that reach inside; which of these zones cut (c,), and the shape functions (c,
        order + 1, s) where what is left of them is looked at.
        """
        ends, whole = self.theta[:: self.order], 2 * self.zone >= self.theta[-1] - self.theta[0]
        start, end, zone = ends[:-1], ends[1:], 0.0 if whole else self.zone
        low, high = np.maximum(start, ends[0] + zone), np.minimum(end, ends[-1] - zone)
        on = (low < high).nonzero()[0]
        cut = ((low > start) | (high < end))[on].nonzero()[0]
        a, b, start, end = (x[on[cut], None] for x in (low, high, start, end))
        xi = (a + b - start - end + (b - a) * PEAK_SAMPLES) / (end - start)
        return slice(int(on[0]), int(on[-1]) + 1), cut, shape(self.order, xi).swapaxes(0, 1)

    def largest(self, values: Floats) -> float:
        """The largest value inside; everywhere where nothing is."""
        on, cut, at = self.samples
        pieces = by_piece(values, self.order)[on]
        found = pieces @ _at_samples(self.order)
        if len(cut):
            found[cut] = (pieces[cut, None] @ at)[:, 0]
        i, j = divmod(int(found.argmax()), len(PEAK_SAMPLES))
        if j in {0, len(PEAK_SAMPLES) - 1}:
            return float(found[i, j])
        (before, x, after), (below, top, beyond) = (
            PEAK_SAMPLES[j - 1 : j + 2].tolist(),
            found[i, j - 1 : j + 2].tolist(),
        )
        left, right = (top - below) / (x - before), (beyond - top) / (after - x)
        bend = (right - left) / (after - before)
        slope = left + bend * (x - before)
        return float(max(top, top - slope * slope / (4 * bend))) if bend < 0 else float(top)

    def peak(self, pressure: Floats) -> float:
        """The largest value inside; everywhere where less than half of the force is there."""
        return (
            self.largest(pressure)
            if self.part(pressure) > 0.5
            else largest(self.theta, pressure, self.order)
        )


def largest(theta: Floats, values: Floats, order: int) -> float:
    """Largest value of a piecewise polynomial."""
    return InnerPart(theta, order, 0.0).largest(values)


def edge_left_out(theta: Floats, pressure: Floats, order: int, zone: float) -> float:
    """The zone [rad] at the ends that may be left out of judging p(theta): none where half of the
    force is there.
    """
    return zone if InnerPart(theta, order, zone).part(pressure) > 0.5 else 0.0


def integrate(theta: Floats, values: Floats, order: int) -> float:
    """Integral of a piecewise polynomial (nodes `theta` (n,), `values` (n,)) over theta."""
    _, v, w = gauss_points(theta, values, order)
    return float(np.sum(v * w))


def resultant(
    surface: FrictionSurface,
    theta: Floats,
    pressure: Floats,
    *,
    order: int,
    size: float,
    per_place: float,
    sign: int,
    drag: float,
) -> Resultant:
    """Resultant on the lining of the traction -p n + drag p t, n out of the lining, t along the
    surface, drag = mu s.

    Parameters
    ----------
    surface : what the lining lies on theta, pressure : (n,), places in the surface's coordinate and
    pressures [Pa], piecewise of degree `order` order : degree of the pieces size : of the brake [m]
    per_place : area of the lining per unit of the coordinate sign : +1 of an internal lining, -1 of
    an external one drag : friction per pressure along growing places
    """
    place, p, w = gauss_points(theta, pressure, order)
    load = p * w * per_place
    normal, along = surface.outwards(place), surface.along(place)
    lever = surface.levers(place, size)
    return Resultant(
        -sign * np.sum(load * normal, axis=(1, 2)),
        drag * np.sum(load * along, axis=(1, 2)),
        float(drag * np.sum(load * lever[1]) - sign * np.sum(load * lever[0])),
    )


def contact_arcs(
    theta: Floats, pressure: Floats, order: int, *, located: bool = True
) -> tuple[tuple[float, float], ...]:
    """Arcs [rad] in which the lining is pressed; theta (n,) [rad], pressure (n,) [Pa], piecewise of
    degree `order`.

    Nodes next to a pressed one belong to its arc; an end without pressure is then located within
    its step, unless not `located`.
    """
    pressed = pressure > 0
    steps = np.zeros(len(theta) + 1, dtype=bool)
    steps[1:-1] = pressed[:-1] | pressed[1:]
    edges = (steps[1:] != steps[:-1]).nonzero()[0].tolist()
    arcs = []
    for start, end in zip(edges[::2], edges[1::2], strict=True):
        ends = float(theta[start]), float(theta[end])
        if located and not pressed[start]:
            ends = _end(theta, pressure, start, order), ends[1]
        if located and not pressed[end]:
            ends = ends[0], -_end(-theta[::-1], pressure[::-1], len(theta) - 1 - end, order)
        arcs.append(ends)
    return tuple(arcs)


def _end(theta: Floats, pressure: Floats, node: int, order: int) -> float:
    """The end between `node` and the next one of an arc that begins at `node`, where nothing
    presses.

    The pressure of a smooth contact falls to its end e as sqrt(theta - e), so that F = Int_e p
    dtheta has F^(2/3) linear in theta: the line through its values at the ends of the first two
    elements gives e. Integrals of the pressure scatter far less than its nodal values.
    """
    i = node // order * order
    near, far = i + order, i + 2 * order
    if far >= len(theta):
        return float(theta[node])
    first, second = (by_piece(pressure[i : far + 1], order) @ _weights(order)).tolist()
    first, second = first * (theta[near] - theta[i]), second * (theta[far] - theta[near])
    f = [max(force, 0.0) ** (2 / 3) for force in (first, first + second)]
    if f[1] <= f[0]:
        return float(theta[node])
    end = theta[near] - f[0] * (theta[far] - theta[near]) / (f[1] - f[0])
    return float(min(max(end, theta[node]), theta[node + 1]))
