"""Relative differences between two results: of pressures (L2 norm), of vectors, of numbers."""

import math
from dataclasses import dataclass
from typing import Self

import numpy as np

from drumlin.base.arrays import Bools, Floats, Ints
from drumlin.response.response import UNCOMPARED_EDGE_ZONE_IN_RADIANS, ShoeResponse
from drumlin.response.resultants import (
    GAUSS,
    WEIGHTS,
    length_of_edge_zone_left_out_of_pressure_errors,
)


@dataclass(frozen=True)
class PressureDifference:
    """The difference p_a - p_b between the pressures of two responses a and b of the same shoe.

    The lining is divided into pieces on which both pressures are polynomials. Each piece has the
    points of a Gauss rule.

    Attributes
    ----------
    b : the response with the pressure p_b
    theta : (pieces, points) [rad], angles of the Gauss points
    weight : (pieces, points) [rad], weights of the Gauss points
    pressure_difference : (pieces, points) [Pa], differences p_a - p_b
    pressure : (pieces, points) [Pa], pressures p_b
    """

    b: ShoeResponse
    theta: Floats
    weight: Floats
    pressure_difference: Floats
    pressure: Floats

    @classmethod
    def pressure_difference_of_two_responses(
        cls, a: ShoeResponse, b: ShoeResponse, *zones: float
    ) -> Self:
        """Evaluate the difference between the pressures of two responses of the same shoe.

        Parameters
        ----------
        a, b : the responses with the pressures p_a and p_b
        zones : lengths [rad] of zones at the lining's ends. Pieces end at the borders of these
            zones, so that integrals can leave a zone out.
        """
        start, end, inner = b.theta[0], b.theta[-1], np.array(zones)
        # The knots are the ends of all pieces. If two knots coincide, the piece between them has
        # the length 0 and adds nothing to an integral.
        ends_of_pieces = a.theta[:: a.order], b.theta[:: b.order]
        beside_slots = [np.concatenate([first - inner, last + inner]) for first, last in b.slots]
        knots = np.sort(
            np.concatenate([start + inner, end - inner, *beside_slots, *ends_of_pieces])
        )
        knots = knots[(knots >= start) & (knots <= end)]
        half = 0.5 * np.diff(knots)[:, None]
        theta = knots[:-1, None] + half * (1 + GAUSS)
        pa, pb = a.pressure_at(theta.ravel()), b.pressure_at(theta.ravel())
        pressure_difference = (pa - pb).reshape(theta.shape)
        return cls(b, theta, half * WEIGHTS, pressure_difference, pb.reshape(theta.shape))

    def mask_of_pieces_outside_end_zones(self, zone: float) -> Bools:
        """Mark the pieces (pieces,) farther than `zone` [rad] from both ends of the lining.

        Pieces in a slot between two linings, or in a zone beside a slot, are not marked.
        """
        middle, ends = self.theta.mean(axis=1), self.b.theta
        inside = (middle > ends[0] + zone) & (middle < ends[-1] - zone)
        for first, last in self.b.slots:
            inside &= (middle < first - zone) | (middle > last + zone)
        return np.asarray(inside)

    def relative_norm_of_difference_outside_end_zones(self, zone: float) -> float:
        """The L2 norm of p_a - p_b relative to the L2 norm of p_b, outside the end zones [rad].

        If p_b vanishes outside the zones at the lining's ends, the result is 0 if p_a vanishes
        there, too, and infinite otherwise.
        """
        inside = self.mask_of_pieces_outside_end_zones(zone)
        weight, pressure_difference, p = (
            self.weight[inside],
            self.pressure_difference[inside],
            self.pressure[inside],
        )
        size = float(np.vdot(weight, p**2))
        if size > 0:
            return math.sqrt(float(np.vdot(weight, pressure_difference**2)) / size)
        return math.inf if pressure_difference.any() else 0.0

    @property
    def indices_of_elements_that_contain_pieces(self) -> Ints:
        """For each piece, the number of the element of response b that contains it: (pieces,)."""
        ends, starts = self.b.theta[:: self.b.order], self.theta[:, 0]
        return np.asarray(np.searchsorted(ends, starts, side="right") - 1)

    def relative_force_as_if_elements_had_random_signs(self) -> float:
        """The force of p_a - p_b relative to that of p_b, if the signs of its parts were random.

        The parts are the integrals of p_a - p_b over the elements of response b. The result is the
        root of the sum of their squares, divided by the integral of p_b. Unlike the true force of
        p_a - p_b, it cannot become small because parts cancel by accident.
        """
        # The root mean square of a sum whose terms have random signs is the root of the sum of the
        # terms' squares.
        forces = np.bincount(
            self.indices_of_elements_that_contain_pieces,
            (self.weight * self.pressure_difference).sum(axis=1),
        )
        return float(np.linalg.norm(forces) / np.vdot(self.weight, self.pressure))

    def relative_difference_near_peak(self, zone: float) -> float:
        """The largest |p_a - p_b| in the element in which p_b peaks, relative to b's peak pressure.

        Pressures within `zone` [rad] of the ends of the lining do not count.
        """
        inside, columns = (
            self.mask_of_pieces_outside_end_zones(zone),
            self.indices_of_elements_that_contain_pieces,
        )
        highest = np.where(inside, self.pressure.max(axis=1), -math.inf).argmax()
        pressure_difference = self.pressure_difference[inside & (columns == columns[highest])]
        return float(np.abs(pressure_difference).max(initial=0.0)) / self.b.peak_pressure


def relative_distance_of_pressures(
    a: ShoeResponse, b: ShoeResponse, edge: float = UNCOMPARED_EDGE_ZONE_IN_RADIANS
) -> float:
    """The relative L2 distance between the pressures p_a and p_b of two responses of a shoe.

    It is the L2 norm of p_a - p_b over theta, divided by the L2 norm of p_b. Zones of the length
    `edge` [rad] at the lining's ends do not count, unless half of the force of p_b acts in the
    zones. If p_b vanishes, the distance is 0 if p_a vanishes, too, and infinite otherwise.
    """
    edge = length_of_edge_zone_left_out_of_pressure_errors(
        b.theta, b.pressure, b.order, edge, b.slots
    )
    return PressureDifference.pressure_difference_of_two_responses(
        a, b, edge
    ).relative_norm_of_difference_outside_end_zones(edge)


def relative_distance_of_vectors(a: Floats, b: Floats) -> float:
    """The length of the vector a - b relative to the length of b; nan if b is zero."""
    size = float(np.linalg.norm(b))
    return float(np.linalg.norm(np.asarray(a) - b)) / size if size else math.nan


def relative_error_of_number(value: float, true: float) -> float:
    """The relative error (value - true) / true, with its sign; nan if `true` is 0."""
    return (value - true) / true if true else math.nan
