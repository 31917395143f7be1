"""Deviations of surfaces from circles and planes.

A lining may be ground to a circle of its own, and a drum may be out of round.
"""

import math

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake.components import Drum
from drumlin.brake.fields import Point


def circle_gap(
    R: float, radius: float | None, offset: Point, middle: float, sign: int, theta: Floats
) -> Floats:
    """Exact gap [m] between a drum and a lining of its own radius, along the drum's radii.

    The lining's circle meets the drum's at the angle `middle` and is moved from there by `offset`.
    About its centre c it lies at rho = c.e_r + sqrt(r^2 - (c x e_r)^2) from the drum's centre. The
    gap is sign (R - rho), to first order sign ((R - r)(1 - cos(theta - middle)) - offset.e_r).

    Parameters
    ----------
    R : radius of the drum [m]
    radius : r, of the lining's circle [m]; None for the drum's radius
    offset : of the lining's circle [m]
    middle : angle of the lining's middle [rad]
    sign : +1 of an internal lining, -1 of an external lining
    theta : angles [rad] at which the gap is wanted, any shape
    """
    r = R if radius is None else radius
    c = (R - r) * np.array([np.cos(middle), np.sin(middle)]) + offset.xy
    along = c[0] * np.cos(theta) + c[1] * np.sin(theta)
    across = c[0] * np.sin(theta) - c[1] * np.cos(theta)
    return sign * (R - along - np.sqrt(r**2 - across**2))


def crown_gap(radius: float | None, offset: Point, x: Floats) -> Floats:
    """Exact gap [m] between a plane and a face that is ground to a circle.

    The circle meets the plane in the face's middle and is moved from there by `offset`.

    Parameters
    ----------
    radius : of the circle [m]; negative of a hollow face, None of a flat face
    offset : of the circle [m]
    x : places from the face's middle [m], any shape
    """
    along = x - offset.x
    if radius is None:
        return np.full(np.shape(x), offset.y)
    root = math.copysign(1.0, radius) * np.sqrt(radius**2 - along**2)
    return offset.y + along**2 / (radius + root)


def off_circle(drum: Drum, theta: Floats) -> Floats:
    """Distance [m] of the drum's surface outside its circle at theta [rad], same shape.

    The deviation turns with the drum.
    """
    at = np.asarray(theta) - drum.angle
    lobes = (part.amplitude * np.cos(part.order * (at - part.phase)) for part in drum.out_of_round)
    return np.sum([np.zeros(at.shape), *lobes], axis=0)
