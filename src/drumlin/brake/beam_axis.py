"""Coordinates of a straight shoe beam: x along it from the hinge, y towards the drum's centre.

The angle theta of a beam counts from the beam's normal through the drum's centre O, positive
towards the loaded end. A point of the friction surface has x = x_O + R sin(theta) and
y = D - R cos(theta).
"""

import math
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats


class Axis(NamedTuple):
    """A beam's axis.

    Attributes
    ----------
    hinge : (2,), position of the hinge [m]
    along : (2,), unit vector from the hinge to the loaded end
    towards : (2,), unit vector across the axis, towards the drum's centre O
    length : L, from the hinge to the loaded end [m]
    foot : x_O, place of the perpendicular from O [m]
    distance : D, from O to the axis [m]
    sense : +1 if x grows with the brake's angle, -1 if it falls
    origin : the brake's angle of the foot [rad]
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
        """Convert the brake's angles theta [rad] to the beam's, from -pi to pi, same shape."""
        turned = self.sense * (np.asarray(theta) - self.origin)
        return np.asarray(turned - 2 * math.pi * np.round(turned / (2 * math.pi)))

    def components(self, vector: Floats) -> tuple[float, float]:
        """Components of a vector (2,) of the brake's frame along the axis and towards O."""
        return float(vector @ self.along), float(vector @ self.towards)

    def to_brake(self, x: Floats, y: Floats) -> Floats:
        """Convert points x, y [m] of the beam to the brake's frame: (..., 2) [m]."""
        return self.hinge + np.multiply.outer(x, self.along) + np.multiply.outer(y, self.towards)


def axis_of(hinge: Floats, end: Floats) -> Axis:
    """Make the axis from `hinge` (2,) to `end` (2,) [m].

    The two points must differ, and O must not lie on their line.
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
        # With O to its left, the axis runs counter-clockwise round O.
        sense=int(side),
        origin=math.atan2(-towards[1], -towards[0]),
    )
