"""Gaps between lining and drum or plane that follow from the shapes of their surfaces.

A lining may be ground to a circle of its own, and a drum may be out of round.
"""

import math
from collections.abc import Sequence

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake.components import OutOfRoundHarmonic
from drumlin.brake.fields import Point


def gaps_of_lining_ground_to_circle(
    R: float, radius: float | None, offset: Point, middle: float, sign: int, theta: Floats
) -> Floats:
    """Exact gap [m] between a drum and a lining with a circle of its own, along the drum's radii.

    The circle of the lining touches the circle of the drum at the angle `middle`, and is then moved
    by `offset`. If its centre is c and its radius r, its distance from the drum's centre in the
    direction e_r is rho = c.e_r + sqrt(r^2 - (c x e_r)^2). The gap is sign (R - rho). To first
    order it is sign ((R - r)(1 - cos(theta - middle)) - offset.e_r).

    Parameters
    ----------
    R : radius of the drum [m]
    radius : radius r of the lining's circle [m]; None for the drum's radius
    offset : displacement of the lining's circle [m]
    middle : angle of the lining's middle [rad]
    sign : +1 for an internal lining, -1 for an external lining
    theta : angles [rad] at which the gap is computed, any shape

    Returns
    -------
    Floats
        gap [m] at each angle, with the shape of `theta`; positive where lining and drum are apart
    """
    # c is the centre of the lining's circle. `along` and `across` are c.e_r and c x e_r, with the
    # radial unit vector e_r at each angle.
    r = R if radius is None else radius
    to_middle = np.array([np.cos(middle), np.sin(middle)])
    c = (R - r) * to_middle + offset.xy
    along = c[0] * np.cos(theta) + c[1] * np.sin(theta)
    across = c[0] * np.sin(theta) - c[1] * np.cos(theta)
    return sign * (R - along - np.sqrt(r**2 - across**2))


def gaps_of_pad_ground_to_circle(radius: float | None, offset: Point, x: Floats) -> Floats:
    """Exact gap [m] between a plane and the face of a pad that is ground to a circle.

    The circle touches the plane at the middle of the face, and is then moved by `offset`.

    Parameters
    ----------
    radius : radius of the circle [m]; negative for a hollow face, None for a flat face
    offset : displacement of the circle [m]
    x : distances along the plane from the middle of the face [m], any shape

    Returns
    -------
    Floats
        gap [m] at each distance, with the shape of `x`
    """
    along = x - offset.x
    if radius is None:
        return np.full(np.shape(x), offset.y)
    # x^2/(r + sqrt(r^2 - x^2)) is r - sqrt(r^2 - x^2) without cancellation for a large radius r.
    root = math.copysign(1.0, radius) * np.sqrt(radius**2 - along**2)
    return offset.y + along**2 / (radius + root)


def radial_deviation_of_drum(
    harmonics: Sequence[OutOfRoundHarmonic], angle: float, theta: Floats
) -> Floats:
    """Radial deviation [m] of a drum that is out of round, at angles theta [rad], same shape.

    It is positive where the friction surface lies outside its circle. The deviation turns with the
    drum, so that it depends on the angular position of the drum.

    Parameters
    ----------
    harmonics : harmonics of the deviation
    angle : angular position of the drum [rad]
    theta : angles [rad]
    """
    # `at` are the angles from a mark on the drum; the harmonics turn with this mark.
    at = np.asarray(theta) - angle
    lobes = (part.amplitude * np.cos(part.order * (at - part.phase)) for part in harmonics)
    return np.sum([np.zeros(at.shape), *lobes], axis=0)
