"""The straight shoe beam's own coordinates: x along its axis from the hinge, y towards the drum's
centre.

The angle theta of a beam counts from the beam's normal through the drum's centre O, positive
towards the loaded end, so that a point of the friction surface has x = x_O + R sin(theta), y = D -
R cos(theta).
"""

import math
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats


class Axis(NamedTuple):
    """A beam's axis: its `hinge` (2,) [m], unit vectors `along` it and `towards` the drum's centre
    (2,).

    `length` L from hinge to loaded end, `foot` x_O of the perpendicular from O, `distance` D of O,
    all [m]; `sense` +1 where x grows with the brake's angle, -1 where it falls; `origin`: the
    brake's angle of the foot.
    """

    hinge: Floats
    along: Floats
    towards: Floats
    length: float
    foot: float
    distance: float
    sense: int
    origin: float

    def angle(self, theta: Floats) -> Floats:
        """The beam's angles of the brake's angles theta [rad], same shape, from -pi to pi."""
        turned = self.sense * (np.asarray(theta) - self.origin)
        return np.asarray(turned - 2 * math.pi * np.round(turned / (2 * math.pi)))

    def components(self, vector: Floats) -> tuple[float, float]:
        """A vector (2,) of the brake's frame along and towards."""
        return float(vector @ self.along), float(vector @ self.towards)

    def to_brake(self, x: Floats, y: Floats) -> Floats:
        """Points of the beam's coordinates in the brake's frame (..., 2) [m]."""
        return self.hinge + np.multiply.outer(x, self.along) + np.multiply.outer(y, self.towards)


def axis_of(hinge: Floats, end: Floats) -> Axis:
    """The axis from `hinge` (2,) to `end` (2,) [m]; the two must differ, and O must not lie on
    their line.
    """
    length = math.dist(hinge, end)
    along = (end - hinge) / length
    left = np.array([-along[1], along[0]])
    side = -1.0 if left @ -hinge < 0 else 1.0
    towards = side * left
    return Axis(
        hinge=hinge,
        along=along,
        towards=towards,
        length=length,
        foot=float(-hinge @ along),
        distance=float(-hinge @ towards),
        sense=int(side),  # with O to the left of the axis, the axis runs round O counter-clockwise
        origin=math.atan2(-towards[1], -towards[0]),
    )
