"""Integrals, peaks and contact arcs of a pressure distribution.

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
"""Points on [-1, 1] at which a piece is evaluated before a parabola gives its largest value."""


class Resultant(NamedTuple):
    """Resultant of the contact on the lining.

    Attributes
    ----------
    normal : force (2,) [N] of the pressure
    friction : force (2,) [N] of the friction
    moment : moment of pressure and friction about the origin [N m]
    """

    normal: Floats
    friction: Floats
    moment: float

    @property
    def force(self) -> Floats:
        """The force (2,) [N] of pressure and friction together."""
        return self.normal + self.friction


def cross(a: Floats, b: Floats) -> Floats:
    """The out-of-plane component of the vector product a x b, for vectors (..., 2)."""
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


@cache
def lobatto(order: int) -> Floats:
    """The Gauss-Lobatto points (order + 1,) on [-1, 1], the nodes of a polynomial of this degree.

    The points are evenly spaced up to degree 2.
    """
    inner = np.zeros(0)
    if order > 1:
        # The inner points are the roots of the derivative of the Legendre polynomial.
        highest = np.eye(order + 1)[order]
        inner = np.sort(legendre.legroots(legendre.legder(highest)).real)
    # Round-off makes the roots slightly unsymmetric.
    symmetric = 0.5 * (inner - inner[::-1])
    return np.concatenate([[-1.0], symmetric, [1.0]])


@cache
def _coefficients(order: int) -> Floats:
    """The Legendre coefficients (order + 1, order + 1) of the shape functions, a column each."""
    return np.asarray(np.linalg.inv(legendre.legvander(lobatto(order), order)), dtype=float)


def shape(order: int, xi: Floats) -> Floats:
    """The Lagrange shape functions on the nodes `lobatto` at points xi: (order + 1, *xi.shape)."""
    rows = _legendre_values(order, xi)
    return (_coefficients(order).T @ rows.reshape(order + 1, -1)).reshape(rows.shape)


def _legendre_values(order: int, xi: Floats) -> Floats:
    """The Legendre polynomials up to a degree at points xi, shaped (order + 1, *xi.shape)."""
    # The recurrence gives each polynomial from the two polynomials before.
    rows = np.ones((order + 1, *np.shape(xi)))
    if order > 0:
        rows[1] = xi
    for i in range(1, order):
        rows[i + 1] = ((2 * i + 1) * rows[1] * rows[i] - i * rows[i - 1]) / (i + 1)
    return rows


@cache
def _integral_coefficients(order: int) -> Floats:
    """The Legendre coefficients (order + 1, order + 2) of the integrals of the shape functions.

    Each row is the integral of one shape function from -1 on.
    """
    return np.ascontiguousarray(legendre.legint(_coefficients(order), lbnd=-1).T)


def slopes(order: int, xi: Floats) -> Floats:
    """The derivatives of the shape functions at points xi: (order + 1, *xi.shape)."""
    derivative = legendre.legder(_coefficients(order))
    return np.moveaxis(legendre.legvander(xi, order - 1) @ derivative, -1, 0)


@cache
def at_gauss(order: int) -> tuple[Floats, Floats]:
    """The shape functions and their derivatives (order + 1, q) at the points GAUSS."""
    return shape(order, GAUSS), slopes(order, GAUSS)


@cache
def _piece_weights(order: int) -> Floats:
    """The integrals (order + 1,) of the shape functions over a piece of length 1."""
    return np.asarray(at_gauss(order)[0] @ WEIGHTS / 2, dtype=float)


class GaussValues(NamedTuple):
    """The places, values and weights (pieces, points) of a Gauss rule on every piece."""

    places: Floats
    values: Floats
    weights: Floats


def gauss_points(theta: Floats, values: Floats, order: int) -> GaussValues:
    """Evaluate a piecewise polynomial with nodal theta and values (n,) at Gauss points."""
    ends = theta[::order]
    half = 0.5 * (ends[1:] - ends[:-1])[:, None]
    return GaussValues(
        places=ends[:-1, None] + half * (1 + GAUSS),
        values=by_piece(values, order) @ at_gauss(order)[0],
        weights=half * WEIGHTS,
    )


def by_piece(values: Floats, order: int) -> Floats:
    """Arrange the nodal values (n,) of a piecewise polynomial by pieces, (pieces, order + 1)."""
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
    """Samples of the part of a line away from its ends, at which the largest value is sought.

    Attributes
    ----------
    pieces : the pieces of the line that lie in the part, wholly or in part
    cut : numbers (c,), within `pieces`, of the pieces that the ends of the part cut
    shapes : shape functions (c, order + 1, s) at samples of the inner part of the cut pieces
    """

    pieces: slice
    cut: Ints
    shapes: Floats


@dataclass(frozen=True)
class InnerPart:
    """The part of a line more than `zone` [rad] away from its ends.

    The same part serves all piecewise polynomials on the growing nodes theta (n,). The part is
    empty if the zones cover the line.
    """

    theta: Floats
    order: int
    zone: float

    @cached_property
    def weights(self) -> Floats:
        """The weights (2, n) of nodal values in integrals over the whole line and over the part."""
        ends, order = self.theta[:: self.order], self.order
        zone = min(self.zone, 0.5 * float(ends[-1] - ends[0]))
        half = 0.5 * (ends[1:] - ends[:-1])
        limits = np.array([ends[0], ends[0] + zone, ends[-1] - zone, ends[-1]])
        # The limits in the coordinate of each piece, [-1, 1].
        xi = np.minimum(np.maximum((limits[:, None] - ends[:-1]) / half - 1, -1.0), 1.0)
        # Integrals of the shape functions of each piece from its begin up to the limits.
        integrals = _integral_coefficients(order) @ _legendre_values(order + 1, xi).swapaxes(0, 1)
        up_to = half[:, None] * integrals.swapaxes(1, 2)
        between = up_to[3:1:-1] - up_to[:2]
        # A node between two pieces gets the weights of both pieces.
        found = np.zeros((2, len(self.theta)))
        found[:, :-1] = between[:, :, :-1].reshape(2, -1)
        found[:, order::order] += between[:, :, -1]
        return found

    def part(self, values: Floats) -> float:
        """The integral of nodal values (n,) over the part, relative to that over the whole line."""
        whole, inside = (self.weights @ values).tolist()
        return float(inside / (whole or 1.0))

    @cached_property
    def samples(self) -> _Samples:
        """The samples of the part; of the whole line if the part is empty."""
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
        """The largest value in the part; in the whole line if the part is empty.

        `values` (n,) are the nodal values of a piecewise polynomial.
        """
        samples = self.samples
        pieces = by_piece(values, self.order)[samples.pieces]
        found = pieces @ _at_samples(self.order)
        if len(samples.cut):
            found[samples.cut] = (pieces[samples.cut, None] @ samples.shapes)[:, 0]
        piece, sample = divmod(int(found.argmax()), len(PEAK_SAMPLES))
        # At the end of a piece there is no parabola through a neighbour on both sides.
        if sample in {0, len(PEAK_SAMPLES) - 1}:
            return float(found[piece, sample])
        x = PEAK_SAMPLES[sample - 1 : sample + 2].tolist()
        return _top_of_parabola(x, found[piece, sample - 1 : sample + 2].tolist())

    def peak(self, pressure: Floats) -> float:
        """The largest pressure in the part; in the whole line if half of the force acts outside."""
        if self.part(pressure) > 0.5:
            return self.largest(pressure)
        return largest(self.theta, pressure, self.order)


def _top_of_parabola(x: list[float], y: list[float]) -> float:
    """The largest value of a parabola through three points whose middle one is highest."""
    before, at, after = x
    below, top, beyond = y
    left, right = (top - below) / (at - before), (beyond - top) / (after - at)
    bend = (right - left) / (after - before)
    slope = left + bend * (at - before)
    return float(max(top, top - slope * slope / (4 * bend))) if bend < 0 else float(top)


def largest(theta: Floats, values: Floats, order: int) -> float:
    """The largest value of a piecewise polynomial with nodal theta and values (n,)."""
    return InnerPart(theta, order, 0.0).largest(values)


def edge_left_out(theta: Floats, pressure: Floats, order: int, zone: float) -> float:
    """The zone [rad] at each end of a lining that does not count in a judgement of p(theta).

    The zone is `zone`, or 0 if half of the force acts in the zones.
    """
    return zone if InnerPart(theta, order, zone).part(pressure) > 0.5 else 0.0


def integrate(theta: Floats, values: Floats, order: int) -> float:
    """The integral over theta of a piecewise polynomial with nodal theta and values (n,)."""
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
    """The resultant on the lining of the traction -p n + drag p t.

    The normal n points out of the lining, t along the surface.

    Parameters
    ----------
    surface : surface on which the lining lies
    theta : nodes (n,) of the pressure in the surface's coordinate
    pressure : pressures (n,) [Pa] at the nodes
    order : degree of the pieces
    size : size of the brake [m]
    per_place : area of the lining per unit of the coordinate
    sign : +1 for an internal lining, -1 for an external lining
    drag : friction per pressure along the growing coordinate, mu or -mu
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
    """The arcs [rad], begin and end of each, in which the lining is pressed.

    Nodes next to a pressed node belong to the arc of the pressed node.

    Parameters
    ----------
    theta : growing nodes (n,) [rad]
    pressure : nodal pressures (n,) [Pa]
    order : degree of the pieces
    located : whether an end of the contact is located within its element
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
            start = _locate_end(theta, pressure, first, order)
        if located and not pressed[last]:
            # The other end is found from behind, in the mirror image of the pressure.
            mirrored = len(theta) - 1 - last
            end = -_locate_end(-theta[::-1], pressure[::-1], mirrored, order)
        arcs.append((start, end))
    return tuple(arcs)


def _locate_end(theta: Floats, pressure: Floats, node: int, order: int) -> float:
    """Locate the end of a contact arc [rad] between an unpressed `node` and the next node.

    The pressure of a smooth contact falls to its end e as sqrt(theta - e). The force from the end
    on, F = Int_e p dtheta, therefore has F^(2/3) linear in theta. The line through the values of
    F^(2/3) at the ends of the first two elements gives e. Integrals of the pressure scatter far
    less than nodal pressures.
    """
    begin = node // order * order
    near, far = begin + order, begin + 2 * order
    # An arc of less than two elements ends at its node.
    if far >= len(theta):
        return float(theta[node])
    means = by_piece(pressure[begin : far + 1], order) @ _piece_weights(order)
    first, second = means.tolist()
    first, second = first * (theta[near] - theta[begin]), second * (theta[far] - theta[near])
    f_near, f_far = (max(force, 0.0) ** (2 / 3) for force in (first, first + second))
    if f_far <= f_near:
        return float(theta[node])
    end = theta[near] - f_near * (theta[far] - theta[near]) / (f_far - f_near)
    return float(min(max(end, theta[node]), theta[node + 1]))
