"""Coordinates of a shoe that is a straight beam beside the drum.

x counts along the beam's axis from the hinge, y across the axis towards the drum's centre O. The
angle theta of the beam counts from the normal of the axis through O, positive towards the loaded
end. A point of the drum's friction surface, of radius R, has x = x_O + R sin(theta) and
y = D - R cos(theta). Here D is the distance of O from the axis, and x_O is the coordinate x of the
foot of the perpendicular from O to the axis.
"""

import math
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats


class BeamAxis(NamedTuple):
    """The axis of a straight shoe beam, and the conversion of its coordinates to the brake's.

    Attributes
    ----------
    hinge : (2,), position of the hinge, where x = 0 [m]
    along : (2,), unit vector from the hinge to the loaded end
    unit_normal_towards_drum_centre : (2,), unit vector normal to the axis, towards the drum's
        centre O
    length : L, length of the beam from the hinge to the loaded end [m]
    x_of_perpendicular_foot : x_O, coordinate x of the foot of the perpendicular from O to the axis
        [m]
    distance_from_drum_centre : D, distance of O from the axis [m]
    sense : +1 if x grows with the polar angle about O, -1 if x falls
    polar_angle_of_perpendicular_foot : polar angle about O at which the foot of the perpendicular
        lies [rad]
    """

    hinge: Floats
    along: Floats
    unit_normal_towards_drum_centre: Floats
    length: float
    x_of_perpendicular_foot: float
    distance_from_drum_centre: float
    sense: int
    polar_angle_of_perpendicular_foot: float

    def angle(self, theta: Floats) -> Floats:
        """Convert polar angles about O [rad] to angles of the beam [rad], same shape.

        The angles of the beam are 0 at the foot of the perpendicular and lie from -pi to pi.
        """
        turned = self.sense * (np.asarray(theta) - self.polar_angle_of_perpendicular_foot)
        return np.asarray(turned - 2 * math.pi * np.round(turned / (2 * math.pi)))

    def vector_components_along_and_across_beam(self, vector: Floats) -> tuple[float, float]:
        """Components of a vector (2,) along the beam's axis and normal to it, towards O."""
        return float(vector @ self.along), float(vector @ self.unit_normal_towards_drum_centre)

    def convert_beam_coordinates_to_brake_points(self, x: Floats, y: Floats) -> Floats:
        """Convert coordinates x, y (...) [m] of the beam to points (..., 2) [m] of the brake."""
        return (
            self.hinge
            + np.multiply.outer(x, self.along)
            + np.multiply.outer(y, self.unit_normal_towards_drum_centre)
        )


def make_beam_axis(hinge: Floats, end: Floats) -> BeamAxis:
    """Make the axis of a beam from the positions of its hinge (2,) and its loaded end (2,) [m].

    The two points must differ, and the drum's centre O must not lie on the line through them.
    """
    # O is the origin: the vector from the hinge to O is -hinge.
    length = math.dist(hinge, end)
    along = (end - hinge) / length
    left = np.array([-along[1], along[0]])
    side = -1.0 if left @ -hinge < 0 else 1.0
    # The vector across the axis points to the side on which O lies.
    towards = side * left
    return BeamAxis(
        hinge=hinge,
        along=along,
        unit_normal_towards_drum_centre=towards,
        length=length,
        x_of_perpendicular_foot=float(-hinge @ along),
        distance_from_drum_centre=float(-hinge @ towards),
        # An axis that has O on its left runs counter-clockwise round O.
        sense=int(side),
        polar_angle_of_perpendicular_foot=math.atan2(-towards[1], -towards[0]),
    )
