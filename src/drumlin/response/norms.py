"""Distances between responses: between pressures in L2 over the lining, vectors and numbers."""

import math
from dataclasses import dataclass
from typing import Self

import numpy as np

from drumlin.base.arrays import Bools, Floats, Ints
from drumlin.response.response import EDGE_ZONE, ShoeResponse
from drumlin.response.resultants import GAUSS, WEIGHTS, edge_left_out


@dataclass(frozen=True)
class Difference:
    """The difference p_a - p_b of the pressures of two responses of a shoe, at Gauss points.

    Attributes
    ----------
    b : the response with the pressure p_b
    theta : angles (pieces, points) [rad] of a Gauss rule on the pieces of both pressures
    weight : weights (pieces, points) [rad] of the rule
    off : differences p_a - p_b (pieces, points) [Pa]
    pressure : pressures p_b (pieces, points) [Pa]
    """

    b: ShoeResponse
    theta: Floats
    weight: Floats
    off: Floats
    pressure: Floats

    @classmethod
    def of(cls, a: ShoeResponse, b: ShoeResponse, *zones: float) -> Self:
        """Evaluate the difference of two responses on pieces on which both are polynomials.

        Pieces also end at the distances `zones` [rad] from the ends of the lining.
        """
        start, end, inner = b.theta[0], b.theta[-1], np.array(zones)
        # Sorted knots may coincide: a piece of no length adds nothing.
        knots = np.sort(
            np.concatenate([start + inner, end - inner, a.theta[:: a.order], b.theta[:: b.order]])
        )
        knots = knots[(knots >= start) & (knots <= end)]
        half = 0.5 * np.diff(knots)[:, None]
        theta = knots[:-1, None] + half * (1 + GAUSS)
        pa, pb = a.pressure_at(theta.ravel()), b.pressure_at(theta.ravel())
        off = (pa - pb).reshape(theta.shape)
        return cls(b, theta, half * WEIGHTS, off, pb.reshape(theta.shape))

    def inside(self, zone: float) -> Bools:
        """Whether each piece (pieces,) is more than a zone [rad] away from the lining's ends."""
        middle, ends = self.theta.mean(axis=1), self.b.theta
        return np.asarray((middle > ends[0] + zone) & (middle < ends[-1] - zone))

    def distance(self, zone: float) -> float:
        """The L2 norm of the difference relative to the L2 norm of p_b.

        Zones [rad] at the ends of the lining do not count. If p_b vanishes outside the zones, the
        distance is 0 for a vanishing p_a and infinite otherwise.
        """
        inside = self.inside(zone)
        weight, off, p = self.weight[inside], self.off[inside], self.pressure[inside]
        size = float(np.vdot(weight, p**2))
        if size > 0:
            return math.sqrt(float(np.vdot(weight, off**2)) / size)
        return math.inf if off.any() else 0.0

    @property
    def columns(self) -> Ints:
        """The number (pieces,) of the element of response b in which each piece lies."""
        ends, starts = self.b.theta[:: self.b.order], self.theta[:, 0]
        return np.asarray(np.searchsorted(ends, starts, side="right") - 1)

    def by_chance(self) -> float:
        """The relative change of the force of p_b if its elements changed with random signs."""
        # Differences of random signs add up like the root of their squares.
        forces = np.bincount(self.columns, (self.weight * self.off).sum(axis=1))
        return float(np.linalg.norm(forces) / np.vdot(self.weight, self.pressure))

    def at_peak(self, zone: float) -> float:
        """The largest difference in the element where p_b peaks, relative to the peak pressure.

        Zones [rad] at the ends of the lining do not count.
        """
        inside, columns = self.inside(zone), self.columns
        highest = np.where(inside, self.pressure.max(axis=1), -math.inf).argmax()
        off = self.off[inside & (columns == columns[highest])]
        return float(np.abs(off).max(initial=0.0)) / self.b.peak_pressure


def pressure_distance(a: ShoeResponse, b: ShoeResponse, edge: float = EDGE_ZONE) -> float:
    """The L2 norm over theta of p_a - p_b, relative to the L2 norm of p_b.

    Zones of `edge` [rad] at the lining's ends do not count, unless half of the force of p_b acts in
    the zones. If p_b vanishes, the distance is 0 for a vanishing p_a and infinite otherwise.
    """
    edge = edge_left_out(b.theta, b.pressure, b.order, edge)
    return Difference.of(a, b, edge).distance(edge)


def vector_distance(a: Floats, b: Floats) -> float:
    """The length of a - b relative to the length of b; nan if b is zero."""
    size = float(np.linalg.norm(b))
    return float(np.linalg.norm(np.asarray(a) - b)) / size if size else math.nan


def relative(value: float, true: float) -> float:
    """The relative deviation (value - true) / true; nan if `true` is 0."""
    return (value - true) / true if true else math.nan
