"""How far surfaces lie off circles and planes: linings ground to a circle of their own, drums that
are not round.
"""

import math

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake.components import Drum
from drumlin.brake.fields import Point


def circle_gap(
    R: float, radius: float | None, offset: Point, middle: float, sign: int, theta: Floats
) -> Floats:
    """Gap [m] between a drum of radius R [m] and a lining of its own radius [m], exactly, along the
    drum's radii.

    The lining's circle meets the drum's at the angle `middle` [rad] and is moved from there by
    `offset`: about
    its centre c it lies at  rho = c.e_r + sqrt(r^2 - (c x e_r)^2)  from the drum's centre, and the gap is
    sign (R - rho), to first order  sign ((R - r)(1 - cos(theta - middle)) - offset.e_r).
    sign: +1 for an internal lining. With `radius` None the lining has the drum's.
    """
    r = R if radius is None else radius
    c = (R - r) * np.array([np.cos(middle), np.sin(middle)]) + offset.xy
    along = c[0] * np.cos(theta) + c[1] * np.sin(theta)
    across = c[0] * np.sin(theta) - c[1] * np.cos(theta)
    return sign * (R - along - np.sqrt(r**2 - across**2))


def crown_gap(radius: float | None, offset: Point, x: Floats) -> Floats:
    """Gap [m] between a plane and a face ground to a circle of this radius [m], exactly, at x [m]
    from its middle.

    The circle meets the plane there and is moved by `offset`; a negative radius is that of a hollow
    face, None a flat.
    """
    along = x - offset.x
    if radius is None:
        return np.full(np.shape(x), offset.y)
    return offset.y + along**2 / (
        radius + math.copysign(1.0, radius) * np.sqrt(radius**2 - along**2)
    )


def off_circle(drum: Drum, theta: Floats) -> Floats:
    """How far [m] the drum's surface lies outside its circle at theta [rad], same shape; it turns
    with the drum.
    """
    at = np.asarray(theta) - drum.angle
    lobes = (part.amplitude * np.cos(part.order * (at - part.phase)) for part in drum.out_of_round)
    return np.sum([np.zeros(at.shape), *lobes], axis=0)
