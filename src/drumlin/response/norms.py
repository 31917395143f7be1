"""Distances between responses: of pressures in L2 over the lining, of vectors, of numbers."""

import math
from dataclasses import dataclass
from typing import Self

import numpy as np

from drumlin.base.arrays import Bools, Floats, Ints
from drumlin.response.response import EDGE_ZONE, ShoeResponse
from drumlin.response.resultants import GAUSS, WEIGHTS, edge_left_out


@dataclass(frozen=True)
class Difference:
    """p_a - p_b: `off` (pieces, points) [Pa] at the angles theta [rad] of a Gauss rule on the
    pieces of both, with its `weight`, and p_b, `pressure`, there; of two shoes' responses `a` and
    `b`.
    """

    b: ShoeResponse
    theta: Floats
    weight: Floats
    off: Floats
    pressure: Floats

    @classmethod
    def of(cls, a: ShoeResponse, b: ShoeResponse, *zones: float) -> Self:
        """Pieces end at these zones [rad] from the lining's ends, too."""
        ends = b.theta[0], b.theta[-1]
        # sorted alone: between two knots at one place lies nothing
        inner = [x for zone in zones for x in (ends[0] + zone, ends[1] - zone)]
        knots = np.sort(np.concatenate([inner, a.theta[:: a.order], b.theta[:: b.order]]))
        knots = knots[(knots >= ends[0]) & (knots <= ends[1])]
        half = 0.5 * np.diff(knots)[:, None]
        theta = knots[:-1, None] + half * (1 + GAUSS)
        pa, pb = a.pressure_at(theta.ravel()), b.pressure_at(theta.ravel())
        return cls(
            b, theta, half * WEIGHTS, (pa - pb).reshape(theta.shape), pb.reshape(theta.shape)
        )

    def inside(self, zone: float) -> Bools:
        """Which pieces (pieces,) are more than one of those zones from the lining's ends."""
        middle, ends = self.theta.mean(axis=1), self.b.theta
        return np.asarray((middle > ends[0] + zone) & (middle < ends[-1] - zone))

    def distance(self, zone: float) -> float:
        """In L2 inside the zone, relative to p_b; where this presses nowhere: 0 if neither does
        p_a, else infinite.
        """
        on = self.inside(zone)
        weight, off, p = self.weight[on], self.off[on], self.pressure[on]
        size = float(np.vdot(weight, p**2))
        if size > 0:
            return math.sqrt(float(np.vdot(weight, off**2)) / size)
        return math.inf if off.any() else 0.0

    @property
    def columns(self) -> Ints:
        """The column of b that each piece (pieces,) is in."""
        return np.asarray(
            np.searchsorted(self.b.theta[:: self.b.order], self.theta[:, 0], side="right") - 1
        )

    def by_chance(self) -> float:
        """The part of the integral of p_b by which it would differ if that of each column had a
        sign by chance.
        """
        columns = np.bincount(self.columns, (self.weight * self.off).sum(axis=1))
        return float(np.linalg.norm(columns) / np.vdot(self.weight, self.pressure))

    def at_peak(self, zone: float) -> float:
        """The largest difference in the column where p_b is largest inside the zone, in parts of
        the peak.
        """
        inside, columns = self.inside(zone), self.columns
        highest = np.where(inside, self.pressure.max(axis=1), -math.inf).argmax()
        off = self.off[inside & (columns == columns[highest])]
        return float(np.abs(off).max(initial=0.0)) / self.b.peak_pressure


def pressure_distance(a: ShoeResponse, b: ShoeResponse, edge: float = EDGE_ZONE) -> float:
    """L2 norm over theta of p_a - p_b, relative to that of p_b, outside zones of `edge` [rad] at
    the lining's ends.

    Where half of p_b's force is within those zones, over the whole lining; where it presses
    nowhere: 0 if neither does p_a, else infinite.
    """
    edge = edge_left_out(b.theta, b.pressure, b.order, edge)
    return Difference.of(a, b, edge).distance(edge)


def vector_distance(a: Floats, b: Floats) -> float:
    """Length of a - b relative to that of b."""
    size = float(np.linalg.norm(b))
    return float(np.linalg.norm(np.asarray(a) - b)) / size if size else math.nan


def relative(value: float, true: float) -> float:
    """(value - true) / true; nan where true is 0."""
    return (value - true) / true if true else math.nan
