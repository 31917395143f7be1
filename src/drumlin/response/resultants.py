"""Integrals, largest values and contact arcs of a pressure distribution.

A pressure distribution is a piecewise polynomial over the surface's coordinate, the angle theta on
a drum or x on a plane. It is given by its values at nodes, which are the Gauss-Lobatto points of
each piece. Neighbouring pieces share an end node.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre

from drumlin.base.arrays import Bools, Floats, Ints
from drumlin.brake.surface import FrictionSurface

# Points in [-1, 1] and weights of a Gauss rule that is exact for polynomials up to degree 23.
GAUSS, WEIGHTS = legendre.leggauss(12)

POINTS_OF_POLYNOMIAL_PIECE_SAMPLED_FOR_PEAK = np.cos(np.linspace(math.pi, 0.0, 25))
"""Points at which a polynomial piece is evaluated to find its largest value.

The 25 points are in the coordinate [-1, 1] of the piece. The largest value of the piece is the
vertex of the parabola through the largest value at these points and its two neighbours.
"""


BeginAndEndOfEachSlot = tuple[tuple[float, float], ...]
"""Begin and end of each slot (gap) between two linings of a shoe, in the surface's coordinate."""

PRESSURE_DROP_LENGTH_AT_SLOT = 1e-12
"""Length [rad, on a plane m] of the polynomial pieces on which the pressure falls to 0 at a slot.

The pressure on a shoe with several linings is one continuous piecewise polynomial. At the edge of a
slot between two linings it falls to 0 on a piece of this length, which bears 1e-12 of the force on
a radian of lining.
"""


class PressureAndFrictionResultant(NamedTuple):
    """The resultant forces and the moment of pressure and friction on a lining.

    Attributes
    ----------
    normal : (2,) [N], force of the pressure
    friction : (2,) [N], force of the friction
    moment : moment of pressure and friction together about the origin [N m]
    """

    normal: Floats
    friction: Floats
    moment: float

    @property
    def force(self) -> Floats:
        """The force (2,) [N] of pressure and friction together."""
        return self.normal + self.friction


def planar_cross_product(a: Floats, b: Floats) -> Floats:
    """The out-of-plane component of the vector product a x b, for vectors (..., 2)."""
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


@cache
def gauss_lobatto_points(order: int) -> Floats:
    """The Gauss-Lobatto points (order + 1,) on [-1, 1]: nodes of a polynomial of degree `order`.

    Up to degree 2 the points are evenly spaced.
    """
    inner = np.zeros(0)
    if order > 1:
        # The inner points are the roots of the derivative of the Legendre polynomial of the degree
        # `order`.
        highest = np.eye(order + 1)[order]
        inner = np.sort(legendre.legroots(legendre.legder(highest)).real)
    # The points are symmetric about 0, but for round-off in the computed roots.
    symmetric = 0.5 * (inner - inner[::-1])
    return np.concatenate([[-1.0], symmetric, [1.0]])


@cache
def _legendre_coefficients_of_shape_functions(order: int) -> Floats:
    """The Legendre coefficients (order + 1, order + 1) of the Lagrange shape functions.

    Each column belongs to one shape function.
    """
    return np.asarray(
        np.linalg.inv(legendre.legvander(gauss_lobatto_points(order), order)), dtype=float
    )


def lagrange_shape_function_values(order: int, xi: Floats) -> Floats:
    """The values (order + 1, *xi.shape) of the Lagrange shape functions at points xi in [-1, 1].

    The nodes of the shape functions are the Gauss-Lobatto points.
    """
    rows = _legendre_polynomial_values(order, xi)
    return (
        _legendre_coefficients_of_shape_functions(order).T @ rows.reshape(order + 1, -1)
    ).reshape(rows.shape)


def _legendre_polynomial_values(order: int, xi: Floats) -> Floats:
    """The values (order + 1, *xi.shape) of the Legendre polynomials up to degree `order` at xi."""
    # Bonnet's recurrence gives each polynomial from the two polynomials of the next lower degrees.
    rows = np.ones((order + 1, *np.shape(xi)))
    if order > 0:
        rows[1] = xi
    for i in range(1, order):
        rows[i + 1] = ((2 * i + 1) * rows[1] * rows[i] - i * rows[i - 1]) / (i + 1)
    return rows


@cache
def _legendre_coefficients_of_integrated_shapes(order: int) -> Floats:
    """The Legendre coefficients (order + 1, order + 2) of the integrated Lagrange shape functions.

    A row belongs to the integral of one shape function from -1 to x, as a polynomial in x.
    """
    return np.ascontiguousarray(
        legendre.legint(_legendre_coefficients_of_shape_functions(order), lbnd=-1).T
    )


@cache
def _legendre_coefficients_of_shape_function_derivatives(order: int) -> Floats:
    """The Legendre coefficients (order, order + 1) of the Lagrange shape functions' derivatives.

    Each column belongs to one shape function.
    """
    return np.asarray(legendre.legder(_legendre_coefficients_of_shape_functions(order)))


def lagrange_shape_function_derivatives(order: int, xi: Floats) -> Floats:
    """The derivatives (order + 1, *xi.shape) of the Lagrange shape functions at points xi."""
    rows = _legendre_polynomial_values(order - 1, xi)
    slopes = _legendre_coefficients_of_shape_function_derivatives(order)
    return (slopes.T @ rows.reshape(order, -1)).reshape(order + 1, *rows.shape[1:])


@cache
def shape_functions_and_derivatives_at_gauss_points(order: int) -> tuple[Floats, Floats]:
    """The Lagrange shape functions and their derivatives (order + 1, q) at the q points GAUSS."""
    return lagrange_shape_function_values(order, GAUSS), lagrange_shape_function_derivatives(
        order, GAUSS
    )


@cache
def _integrals_of_shape_functions(order: int) -> Floats:
    """The integrals (order + 1,) of the Lagrange shape functions over a piece of length 1."""
    return np.asarray(
        shape_functions_and_derivatives_at_gauss_points(order)[0] @ WEIGHTS / 2, dtype=float
    )


def polynomial_nodes_on_linings_and_slots(
    parts: Sequence[Floats], order: int
) -> tuple[Floats, Bools]:
    """The nodes of a piecewise polynomial on several linings, and a mask of the nodes on linings.

    Between two linings there are three more pieces. On the first piece the polynomial falls to 0,
    on the second it is 0, and on the third it rises to its value on the next lining.

    Parameters
    ----------
    parts : nodes (n_k,) of each lining, growing
    order : degree of the polynomial pieces

    Returns
    -------
    nodes (n,) and a mask (n,) that is False at the nodes in the slots
    """
    theta, on_lining = [parts[0]], [np.ones(len(parts[0]), dtype=bool)]
    reference = 0.5 * (1 + gauss_lobatto_points(order))
    for before, part in pairwise(parts):
        a, b = float(before[-1]), float(part[0])
        ends = np.array([a, a + PRESSURE_DROP_LENGTH_AT_SLOT, b - PRESSURE_DROP_LENGTH_AT_SLOT, b])
        inside = ends[:-1, None] + np.diff(ends)[:, None] * reference[:-1]
        theta += [inside.ravel()[1:], part]
        on_lining += [np.zeros(3 * order - 1, dtype=bool), np.ones(len(part), dtype=bool)]
    return np.concatenate(theta), np.concatenate(on_lining)


def slots_from_nodes_and_lining_mask(theta: Floats, on_lining: Bools) -> BeginAndEndOfEachSlot:
    """The slots between linings, from the nodes (n,) of a pressure and the mask (n,) `on_lining`.

    The mask is False at nodes in slots, see `polynomial_nodes_on_linings_and_slots`. A slot begins
    and ends exactly at end nodes of the linings beside it.
    """
    open_ends = np.flatnonzero(on_lining[1:] != on_lining[:-1])
    before, behind = open_ends[::2], open_ends[1::2] + 1
    return tuple(zip(theta[before].tolist(), theta[behind].tolist(), strict=True))


class PiecewisePolynomialAtGaussPoints(NamedTuple):
    """A piecewise polynomial at the points of a Gauss rule, with the same rule on every piece.

    Attributes
    ----------
    places : (pieces, points), the points in the surface's coordinate
    values : (pieces, points), values of the polynomial
    weights : (pieces, points), weights of the points in an integral over the coordinate
    """

    places: Floats
    values: Floats
    weights: Floats


def polynomial_values_at_gauss_points(
    theta: Floats, values: Floats, order: int
) -> PiecewisePolynomialAtGaussPoints:
    """A piecewise polynomial, with values (n,) at nodes theta (n,), evaluated at Gauss points."""
    ends = theta[::order]
    half = 0.5 * (ends[1:] - ends[:-1])[:, None]
    return PiecewisePolynomialAtGaussPoints(
        places=ends[:-1, None] + half * (1 + GAUSS),
        values=arrange_nodal_values_by_piece(values, order)
        @ shape_functions_and_derivatives_at_gauss_points(order)[0],
        weights=half * WEIGHTS,
    )


def arrange_nodal_values_by_piece(values: Floats, order: int) -> Floats:
    """The nodal values (n,) of a piecewise polynomial, as one row (order + 1,) for each piece.

    A node that two pieces share is in the rows of both.
    """
    count = (len(values) - 1) // order
    found = np.empty((count, order + 1))
    found[:, :-1] = values[: count * order].reshape(-1, order)
    found[:, -1] = values[order::order]
    return found


@cache
def _shape_functions_at_peak_sample_points(order: int) -> Floats:
    """The Lagrange shape functions (order + 1, s) at the s points sampled for the peak."""
    return lagrange_shape_function_values(order, POINTS_OF_POLYNOMIAL_PIECE_SAMPLED_FOR_PEAK)


class _PeakSamplePointsOutsideEndZones(NamedTuple):
    """The points at which the largest pressure outside the end zones of a lining is sought.

    Pieces of the pressure outside the end zones have the points
    POINTS_OF_POLYNOMIAL_PIECE_SAMPLED_FOR_PEAK. A piece that an end zone cuts has points on its
    uncut part only.

    Attributes
    ----------
    pieces : the pieces that lie outside the end zones or are cut by one; a slice, or their numbers
        if there are slots
    cut : (c,), numbers within `pieces` of the pieces that are cut
    shapes : (c, order + 1, s), Lagrange shape functions at the s points of each cut piece
    """

    pieces: slice | Ints
    cut: Ints
    shapes: Floats


@dataclass(frozen=True)
class LiningWithoutEndZones:
    """The part of a lining outside the zones at its ends, for integrals and peaks of pressures.

    One object serves all pressures that have the same nodes. The part is empty if the two zones
    cover the lining. If a shoe has several linings, there is a zone at both ends of each lining.

    Attributes
    ----------
    theta : (n,), growing nodes of the pressures, from one end of the lining to the other
    order : degree of the polynomial pieces of the pressures
    zone : length of the zone at each end, in the coordinate of theta
    slots : begin and end of each slot between two linings, in the coordinate of theta
    """

    theta: Floats
    order: int
    zone: float
    slots: BeginAndEndOfEachSlot = ()

    @cached_property
    def integration_weights_with_and_without_end_zones(self) -> Floats:
        """The weights (2, n) of nodal values in two integrals over theta.

        The first row is for the integral over the whole lining, the second row for the integral
        over the part outside the end zones.
        """
        ends, order = self.theta[:: self.order], self.order
        zone = min(self.zone, 0.5 * float(ends[-1] - ends[0]))
        half = 0.5 * (ends[1:] - ends[:-1])
        around_slots = [place for a, b in self.slots for place in (a - zone, b + zone)]
        limits = np.array([ends[0], ends[0] + zone, ends[-1] - zone, ends[-1], *around_slots])
        # xi are the limits of the two integrals, in the coordinate [-1, 1] of each piece. A limit
        # outside the piece becomes the nearer end of the piece.
        xi = np.minimum(np.maximum((limits[:, None] - ends[:-1]) / half - 1, -1.0), 1.0)
        # Each shape function is integrated from the beginning of its piece up to each limit.
        integrals = _legendre_coefficients_of_integrated_shapes(
            order
        ) @ _legendre_polynomial_values(order + 1, xi).swapaxes(0, 1)
        up_to = half[:, None] * integrals.swapaxes(1, 2)
        between = up_to[3:1:-1] - up_to[:2]
        # Each slot, with the zones beside it, is taken out of the second integral. The first
        # integral, over the whole lining, needs no change, because no pressure acts in a slot.
        for before, behind in zip(up_to[4::2], up_to[5::2], strict=True):
            between[1] -= behind - before
        # A node that two pieces share gets the sum of the weights from both pieces.
        found = np.zeros((2, len(self.theta)))
        found[:, :-1] = between[:, :, :-1].reshape(2, -1)
        found[:, order::order] += between[:, :, -1]
        return found

    def fraction_of_integral_outside_end_zones(self, values: Floats) -> float:
        """The fraction of the integral over the lining that lies outside the end zones.

        `values` (n,) are the nodal values of a piecewise polynomial, such as pressures.
        """
        whole, inside = (self.integration_weights_with_and_without_end_zones @ values).tolist()
        return float(inside / (whole or 1.0))

    @cached_property
    def sample_points_for_largest_value(self) -> _PeakSamplePointsOutsideEndZones:
        """The points at which the largest pressure on the lining is sought.

        They lie outside the end zones, or on the whole lining if the end zones cover it.
        """
        ends = self.theta[:: self.order]
        empty = 2 * self.zone >= self.theta[-1] - self.theta[0]
        zone = 0.0 if empty else self.zone
        start, end = ends[:-1], ends[1:]
        low, high = np.maximum(start, ends[0] + zone), np.minimum(end, ends[-1] - zone)
        for slot_start, slot_end in self.slots:
            behind = start >= slot_start
            low = np.where(behind, np.maximum(low, slot_end + zone), low)
            high = np.where(behind, high, np.minimum(high, slot_start - zone))
        pieces = (low < high).nonzero()[0]
        cut = ((low > start) | (high < end))[pieces].nonzero()[0]
        # xi are the sample points between low and high, in the coordinate [-1, 1] of cut pieces.
        low, high = low[pieces[cut], None], high[pieces[cut], None]
        start, end = start[pieces[cut], None], end[pieces[cut], None]
        xi = (
            low + high - start - end + (high - low) * POINTS_OF_POLYNOMIAL_PIECE_SAMPLED_FOR_PEAK
        ) / (end - start)
        shapes = lagrange_shape_function_values(self.order, xi).swapaxes(0, 1)
        in_row = slice(int(pieces[0]), int(pieces[-1]) + 1)
        return _PeakSamplePointsOutsideEndZones(pieces if self.slots else in_row, cut, shapes)

    def largest_value_outside_end_zones(self, values: Floats) -> float:
        """The largest value outside the end zones, or on the whole lining if the zones cover it.

        `values` (n,) are the nodal values of a piecewise polynomial.
        """
        samples = self.sample_points_for_largest_value
        pieces = arrange_nodal_values_by_piece(values, self.order)[samples.pieces]
        found = pieces @ _shape_functions_at_peak_sample_points(self.order)
        if len(samples.cut):
            found[samples.cut] = (pieces[samples.cut, None] @ samples.shapes)[:, 0]
        piece, sample = divmod(
            int(found.argmax()), len(POINTS_OF_POLYNOMIAL_PIECE_SAMPLED_FOR_PEAK)
        )
        # A parabola needs a sample on both sides, which the first and the last sample do not have.
        if sample in {0, len(POINTS_OF_POLYNOMIAL_PIECE_SAMPLED_FOR_PEAK) - 1}:
            return float(found[piece, sample])
        x = POINTS_OF_POLYNOMIAL_PIECE_SAMPLED_FOR_PEAK[sample - 1 : sample + 2].tolist()
        return _largest_value_of_parabola(x, found[piece, sample - 1 : sample + 2].tolist())

    def peak_pressure_outside_end_zones(self, pressure: Floats) -> float:
        """The largest pressure [Pa] outside the end zones, from nodal pressures (n,) [Pa].

        If at least half of the force acts in the end zones, the peak is sought on the whole lining.
        """
        if self.fraction_of_integral_outside_end_zones(pressure) > 0.5:
            return self.largest_value_outside_end_zones(pressure)
        return largest_value_of_piecewise_polynomial(self.theta, pressure, self.order)


def _largest_value_of_parabola(x: list[float], y: list[float]) -> float:
    """The largest value of a parabola through three points (x, y), the middle one the highest.

    If the points lie on a line, the highest y is returned.
    """
    before, at, after = x
    below, top, beyond = y
    left, right = (top - below) / (at - before), (beyond - top) / (after - at)
    bend = (right - left) / (after - before)
    slope = left + bend * (at - before)
    return float(max(top, top - slope * slope / (4 * bend))) if bend < 0 else float(top)


def largest_value_of_piecewise_polynomial(theta: Floats, values: Floats, order: int) -> float:
    """The largest value of a piecewise polynomial with values (n,) at the nodes theta (n,)."""
    return LiningWithoutEndZones(theta, order, 0.0).largest_value_outside_end_zones(values)


def length_of_edge_zone_left_out_of_pressure_errors(
    theta: Floats, pressure: Floats, order: int, zone: float, slots: BeginAndEndOfEachSlot = ()
) -> float:
    """The length [rad] of the zone at each end of a lining in which pressure errors do not count.

    The result is `zone`, or 0 if at least half of the force on the lining acts in the zones.
    `theta`, `order`, `zone` and `slots` are as in `LiningWithoutEndZones`; `pressure` (n,) are the
    nodal pressures.
    """
    inner = LiningWithoutEndZones(theta, order, zone, slots)
    return zone if inner.fraction_of_integral_outside_end_zones(pressure) > 0.5 else 0.0


def integral_of_piecewise_polynomial(theta: Floats, values: Floats, order: int) -> float:
    """The integral over theta of a piecewise polynomial with values (n,) at nodes theta (n,)."""
    rule = polynomial_values_at_gauss_points(theta, values, order)
    return float(np.sum(rule.values * rule.weights))


def resultant_of_pressure_and_friction(
    surface: FrictionSurface,
    theta: Floats,
    pressure: Floats,
    *,
    order: int,
    size: float,
    per_place: float,
    sign: int,
    drag: float,
    dragging: Floats | None = None,
) -> PressureAndFrictionResultant:
    """The resultant of the pressure p and the friction on a lining.

    The traction on the lining is -p n + drag p t. The normal n points out of the lining, and t
    along the surface towards the growing coordinate. If `dragging` is given, the friction is drag
    times `dragging` in place of drag times p.

    Parameters
    ----------
    surface : surface on which the lining lies, drum or plane
    theta : (n,), nodes of the pressure in the surface's coordinate
    pressure : (n,) [Pa], pressures at the nodes
    order : degree of the polynomial pieces of the pressure
    size : size of the brake [m], on a drum its radius
    per_place : area of the lining per unit of the surface's coordinate [m^2/rad, on a plane m]
    sign : +1 for an internal lining, -1 for an external lining
    drag : friction stress divided by pressure, positive towards the growing coordinate: mu or -mu
    dragging : (n,) [Pa], nodal values that take the place of the pressures in the friction; None
        for the pressures themselves
    """
    rule = polynomial_values_at_gauss_points(theta, pressure, order)
    load = rule.values * rule.weights * per_place
    rubbing = load
    if dragging is not None:
        values = polynomial_values_at_gauss_points(theta, dragging, order).values
        rubbing = values * rule.weights * per_place
    normal, along = (
        surface.unit_normals_into_surface(rule.places),
        surface.unit_tangents_of_surface(rule.places),
    )
    lever = surface.moments_of_unit_normal_and_tangential_forces(rule.places, size)
    moment = drag * np.sum(rubbing * lever[1]) - sign * np.sum(load * lever[0])
    return PressureAndFrictionResultant(
        normal=-sign * np.sum(load * normal, axis=(1, 2)),
        friction=drag * np.sum(rubbing * along, axis=(1, 2)),
        moment=float(moment),
    )


def contact_arcs_from_nodal_pressures(
    theta: Floats, pressure: Floats, order: int, *, located: bool = True
) -> tuple[tuple[float, float], ...]:
    """The first and the last angle [rad] of each arc on which a lining is in contact with the drum.

    Parameters
    ----------
    theta : (n,) [rad], growing nodes of the pressure
    pressure : (n,) [Pa], pressures at the nodes
    order : degree of the polynomial pieces of the pressure
    located : whether to locate an end of the contact between two nodes; otherwise an arc ends at
        the first node without pressure
    """
    pressed = pressure > 0
    # The stretch between two neighbouring nodes belongs to an arc if the pressure is positive at
    # one of them.
    steps = np.zeros(len(theta) + 1, dtype=bool)
    steps[1:-1] = pressed[:-1] | pressed[1:]
    edges = (steps[1:] != steps[:-1]).nonzero()[0].tolist()
    arcs = []
    for first, last in zip(edges[::2], edges[1::2], strict=True):
        start, end = float(theta[first]), float(theta[last])
        if located and not pressed[first]:
            start = _angle_at_which_contact_begins(theta, pressure, first, order)
        if located and not pressed[last]:
            # The last angle of an arc is found as the first angle of the mirrored pressure.
            mirrored = len(theta) - 1 - last
            end = -_angle_at_which_contact_begins(-theta[::-1], pressure[::-1], mirrored, order)
        arcs.append((start, end))
    return tuple(arcs)


def _angle_at_which_contact_begins(theta: Floats, pressure: Floats, node: int, order: int) -> float:
    """The angle [rad] at which a contact arc begins, between an unpressed `node` and the next node.

    Towards its first angle e the pressure of a smooth contact falls as sqrt(theta - e). For the
    force F = Int_e p dtheta from e up to theta, F^(2/3) is therefore linear in theta. The line
    through the values of F^(2/3) at the ends of the first two elements gives e. Integrals of the
    pressure scatter far less than nodal pressures.
    """
    begin = node // order * order
    near, far = begin + order, begin + 2 * order
    # If fewer than two elements remain up to the end of the lining, the angle of the node is
    # returned.
    if far >= len(theta):
        return float(theta[node])
    means = arrange_nodal_values_by_piece(
        pressure[begin : far + 1], order
    ) @ _integrals_of_shape_functions(order)
    first, second = means.tolist()
    first, second = first * (theta[near] - theta[begin]), second * (theta[far] - theta[near])
    f_near, f_far = (max(force, 0.0) ** (2 / 3) for force in (first, first + second))
    if f_far <= f_near:
        return float(theta[node])
    end = theta[near] - f_near * (theta[far] - theta[near]) / (f_far - f_near)
    return float(min(max(end, theta[node]), theta[node + 1]))
