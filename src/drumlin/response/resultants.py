"""Integrate a pressure distribution, and find its largest value and where it ends.

A pressure distribution is a piecewise polynomial over the surface's coordinate. Its nodes are the
Gauss-Lobatto points of each piece. Consecutive pieces share their end node.
"""

import math
from dataclasses import dataclass
from functools import cache, cached_property
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre

from drumlin.base.arrays import Floats, Ints
from drumlin.brake.surface import FrictionSurface

GAUSS, WEIGHTS = legendre.leggauss(12)

PEAK_SAMPLES = np.cos(np.linspace(math.pi, 0.0, 25))
"""Points of a piece, on [-1, 1], between which its largest value is sought by a parabola."""


class Resultant(NamedTuple):
    """Resultant of the contact on the lining.

    Attributes
    ----------
    normal : (2,), force of the pressure [N]
    friction : (2,), force of the friction [N]
    moment : moment of both about the origin [N m]
    """

    normal: Floats
    friction: Floats
    moment: float

    @property
    def force(self) -> Floats:
        """The whole force (2,) [N]."""
        return self.normal + self.friction


def cross(a: Floats, b: Floats) -> Floats:
    """The out-of-plane component of a x b, of vectors (..., 2)."""
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


@cache
def lobatto(order: int) -> Floats:
    """Gauss-Lobatto points (order + 1,) on [-1, 1], the nodes of a polynomial of this degree.

    Up to degree 2 they are evenly spaced.
    """
    inner = np.zeros(0)
    if order > 1:
        highest = np.eye(order + 1)[order]
        inner = np.sort(legendre.legroots(legendre.legder(highest)).real)
    symmetric = 0.5 * (inner - inner[::-1])
    return np.concatenate([[-1.0], symmetric, [1.0]])


@cache
def _coefficients(order: int) -> Floats:
    """Legendre coefficients of the shape functions, a column each: (order + 1, order + 1)."""
    return np.asarray(np.linalg.inv(legendre.legvander(lobatto(order), order)), dtype=float)


def shape(order: int, xi: Floats) -> Floats:
    """Lagrange shape functions on the nodes `lobatto` at points xi: (order + 1, *xi.shape)."""
    rows = _legendre(order, xi)
    return (_coefficients(order).T @ rows.reshape(order + 1, -1)).reshape(rows.shape)


def _legendre(order: int, xi: Floats) -> Floats:
    """Legendre polynomials up to a degree at points xi, by recurrence: (order + 1, *xi.shape)."""
    rows = np.ones((order + 1, *np.shape(xi)))
    if order > 0:
        rows[1] = xi
    for i in range(1, order):
        rows[i + 1] = ((2 * i + 1) * rows[1] * rows[i] - i * rows[i - 1]) / (i + 1)
    return rows


@cache
def _integrals(order: int) -> Floats:
    """Legendre coefficients of the shape functions' integrals from -1 on, a row each.

    Their shape is (order + 1, order + 2).
    """
    return np.ascontiguousarray(legendre.legint(_coefficients(order), lbnd=-1).T)


def slopes(order: int, xi: Floats) -> Floats:
    """Derivatives of the shape functions at points xi: (order + 1, *xi.shape)."""
    derivative = legendre.legder(_coefficients(order))
    return np.moveaxis(legendre.legvander(xi, order - 1) @ derivative, -1, 0)


@cache
def at_gauss(order: int) -> tuple[Floats, Floats]:
    """The shape functions and their derivatives (order + 1, q) at the points GAUSS."""
    return shape(order, GAUSS), slopes(order, GAUSS)


@cache
def _weights(order: int) -> Floats:
    """Integrals (order + 1,) of the shape functions over a piece of length 1."""
    return np.asarray(at_gauss(order)[0] @ WEIGHTS / 2, dtype=float)


class GaussValues(NamedTuple):
    """Places, values and weights (pieces, points) of a Gauss rule on every piece."""

    places: Floats
    values: Floats
    weights: Floats


def gauss_points(theta: Floats, values: Floats, order: int) -> GaussValues:
    """Evaluate a piecewise polynomial, theta and values (n,), at the Gauss points of its pieces."""
    ends = theta[::order]
    half = 0.5 * (ends[1:] - ends[:-1])[:, None]
    return GaussValues(
        places=ends[:-1, None] + half * (1 + GAUSS),
        values=by_piece(values, order) @ at_gauss(order)[0],
        weights=half * WEIGHTS,
    )


def by_piece(values: Floats, order: int) -> Floats:
    """The nodal values (pieces, order + 1) of each piece of a piecewise polynomial."""
    count = (len(values) - 1) // order
    found = np.empty((count, order + 1))
    found[:, :-1] = values[: count * order].reshape(-1, order)
    found[:, -1] = values[order::order]
    return found


@cache
def _at_samples(order: int) -> Floats:
    """The shape functions (order + 1, s) at PEAK_SAMPLES."""
    return shape(order, PEAK_SAMPLES)


class _Samples(NamedTuple):
    """Where the largest value inside is sought.

    Attributes
    ----------
    pieces : the pieces that reach inside
    cut : (c,), which of these pieces the zones cut
    shapes : (c, order + 1, s), shape functions at samples of the inner part of the cut pieces
    """

    pieces: slice
    cut: Ints
    shapes: Floats


@dataclass(frozen=True)
class InnerPart:
    """The part of a line more than `zone` [rad] from its ends.

    It serves all piecewise polynomials on the growing nodes theta (n,). The part is empty if no
    place is that far from the ends.
    """

    theta: Floats
    order: int
    zone: float

    @cached_property
    def weights(self) -> Floats:
        """Weights (2, n) of the nodal values in the integrals over the whole line and this part."""
        ends, order = self.theta[:: self.order], self.order
        zone = min(self.zone, 0.5 * float(ends[-1] - ends[0]))
        half = 0.5 * (ends[1:] - ends[:-1])
        limits = np.array([ends[0], ends[0] + zone, ends[-1] - zone, ends[-1]])
        # The limits in the coordinate of each piece, [-1, 1].
        xi = np.minimum(np.maximum((limits[:, None] - ends[:-1]) / half - 1, -1.0), 1.0)
        # Integrals of the shape functions of each piece from its begin up to the limits.
        integrals = _integrals(order) @ _legendre(order + 1, xi).swapaxes(0, 1)
        up_to = half[:, None] * integrals.swapaxes(1, 2)
        between = up_to[3:1:-1] - up_to[:2]
        # Neighbours add up in the nodes that they share.
        found = np.zeros((2, len(self.theta)))
        found[:, :-1] = between[:, :, :-1].reshape(2, -1)
        found[:, order::order] += between[:, :, -1]
        return found

    def part(self, values: Floats) -> float:
        """The integral over this part, relative to the integral over the whole line."""
        whole, inside = (self.weights @ values).tolist()
        return float(inside / (whole or 1.0))

    @cached_property
    def samples(self) -> _Samples:
        """The samples of the inner part; of the whole line if the part is empty."""
        ends = self.theta[:: self.order]
        empty = 2 * self.zone >= self.theta[-1] - self.theta[0]
        zone = 0.0 if empty else self.zone
        start, end = ends[:-1], ends[1:]
        low, high = np.maximum(start, ends[0] + zone), np.minimum(end, ends[-1] - zone)
        pieces = (low < high).nonzero()[0]
        cut = ((low > start) | (high < end))[pieces].nonzero()[0]
        # The samples between low and high, in the coordinate of each cut piece.
        low, high = low[pieces[cut], None], high[pieces[cut], None]
        start, end = start[pieces[cut], None], end[pieces[cut], None]
        xi = (low + high - start - end + (high - low) * PEAK_SAMPLES) / (end - start)
        shapes = shape(self.order, xi).swapaxes(0, 1)
        return _Samples(slice(int(pieces[0]), int(pieces[-1]) + 1), cut, shapes)

    def largest(self, values: Floats) -> float:
        """Largest value of this part; of the whole line if the part is empty."""
        samples = self.samples
        pieces = by_piece(values, self.order)[samples.pieces]
        found = pieces @ _at_samples(self.order)
        if len(samples.cut):
            found[samples.cut] = (pieces[samples.cut, None] @ samples.shapes)[:, 0]
        piece, sample = divmod(int(found.argmax()), len(PEAK_SAMPLES))
        if sample in {0, len(PEAK_SAMPLES) - 1}:
            return float(found[piece, sample])
        x = PEAK_SAMPLES[sample - 1 : sample + 2].tolist()
        return _top_of_parabola(x, found[piece, sample - 1 : sample + 2].tolist())

    def peak(self, pressure: Floats) -> float:
        """Largest pressure of this part; of the whole line if under half of the force acts here."""
        if self.part(pressure) > 0.5:
            return self.largest(pressure)
        return largest(self.theta, pressure, self.order)


def _top_of_parabola(x: list[float], y: list[float]) -> float:
    """Largest value of the parabola through three points, of which the middle one is highest."""
    before, at, after = x
    below, top, beyond = y
    left, right = (top - below) / (at - before), (beyond - top) / (after - at)
    bend = (right - left) / (after - before)
    slope = left + bend * (at - before)
    return float(max(top, top - slope * slope / (4 * bend))) if bend < 0 else float(top)


def largest(theta: Floats, values: Floats, order: int) -> float:
    """Largest value of a piecewise polynomial."""
    return InnerPart(theta, order, 0.0).largest(values)


def edge_left_out(theta: Floats, pressure: Floats, order: int, zone: float) -> float:
    """The zone [rad] at the ends that may be left out of judging p(theta).

    It is 0 if half of the force acts in the zones.
    """
    return zone if InnerPart(theta, order, zone).part(pressure) > 0.5 else 0.0


def integrate(theta: Floats, values: Floats, order: int) -> float:
    """Integral over theta of a piecewise polynomial with nodes `theta` (n,) and `values` (n,)."""
    rule = gauss_points(theta, values, order)
    return float(np.sum(rule.values * rule.weights))


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
    """Resultant on the lining of the traction -p n + drag p t.

    The normal n points out of the lining, t along the surface.

    Parameters
    ----------
    surface : surface on which the lining lies
    theta : (n,), places in the surface's coordinate, nodes of the pressure
    pressure : (n,), pressures [Pa] there
    order : degree of the pieces
    size : of the brake [m]
    per_place : area of the lining per unit of the coordinate
    sign : +1 of an internal lining, -1 of an external lining
    drag : friction per pressure along growing places, mu s
    """
    rule = gauss_points(theta, pressure, order)
    load = rule.values * rule.weights * per_place
    normal, along = surface.outwards(rule.places), surface.along(rule.places)
    lever = surface.levers(rule.places, size)
    moment = drag * np.sum(load * lever[1]) - sign * np.sum(load * lever[0])
    return Resultant(
        normal=-sign * np.sum(load * normal, axis=(1, 2)),
        friction=drag * np.sum(load * along, axis=(1, 2)),
        moment=float(moment),
    )


def contact_arcs(
    theta: Floats, pressure: Floats, order: int, *, located: bool = True
) -> tuple[tuple[float, float], ...]:
    """Arcs [rad] in which the lining is pressed.

    Nodes next to a pressed node belong to its arc.

    Parameters
    ----------
    theta : (n,), growing nodes [rad]
    pressure : (n,), nodal pressures [Pa]
    order : degree of the pieces
    located : whether an end without pressure is located within its element
    """
    pressed = pressure > 0
    # A step between two nodes belongs to an arc if one of the nodes is pressed.
    steps = np.zeros(len(theta) + 1, dtype=bool)
    steps[1:-1] = pressed[:-1] | pressed[1:]
    edges = (steps[1:] != steps[:-1]).nonzero()[0].tolist()
    arcs = []
    for first, last in zip(edges[::2], edges[1::2], strict=True):
        start, end = float(theta[first]), float(theta[last])
        if located and not pressed[first]:
            start = _end(theta, pressure, first, order)
        if located and not pressed[last]:
            # The other end is found from behind, in the mirror image of the pressure.
            mirrored = len(theta) - 1 - last
            end = -_end(-theta[::-1], pressure[::-1], mirrored, order)
        arcs.append((start, end))
    return tuple(arcs)


def _end(theta: Floats, pressure: Floats, node: int, order: int) -> float:
    """Locate the end of an arc between an unpressed `node` and the next node.

    The pressure of a smooth contact falls to its end e as sqrt(theta - e). The force from there on,
    F = Int_e p dtheta, therefore has F^(2/3) linear in theta. The line through its values at the
    ends of the first two elements gives e. Integrals of the pressure scatter far less than its
    nodal values.
    """
    begin = node // order * order
    near, far = begin + order, begin + 2 * order
    if far >= len(theta):
        return float(theta[node])
    means = by_piece(pressure[begin : far + 1], order) @ _weights(order)
    first, second = means.tolist()
    first, second = first * (theta[near] - theta[begin]), second * (theta[far] - theta[near])
    f_near, f_far = (max(force, 0.0) ** (2 / 3) for force in (first, first + second))
    if f_far <= f_near:
        return float(theta[node])
    end = theta[near] - f_near * (theta[far] - theta[near]) / (f_far - f_near)
    return float(min(max(end, theta[node]), theta[node + 1]))
