"""How a parametric lining is divided into elements: along its arc and through its thickness.

Elements shrink linearly towards the lining's edges, where the pressure is singular.
"""

import math
from dataclasses import dataclass

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake.brake import Shoe

EDGE_SIZE = 1 / 32
"""Size of an element at the lining's sharp edge, relative to one in its middle, and of a layer at
its faces. The pressure is singular at the edge. With four times this size the error of p is a
quarter larger in the median of 22 random brakes, at most six times; with half of it, it is the
same.
"""
MOST_BEYOND = 200
"""Limit of memory: elements along the body on either side of the lining."""
MOST_LAYERS = 8
"""Limit of memory: layers through backing and body each, so that unknowns grow with the number of
elements along the lining and not with its square. On 22 random brakes twice as many have 1.4 times
the unknowns and the same error of p, half as many up to 2.4 times that error.
"""
MOST_THIN = 80
"""The same limit for linear elements, which bend well only in thin layers: as many as the default
number along a lining. On 22 random brakes 40 and 160 give the same errors."""


@dataclass(frozen=True)
class LiningDivision:
    """Where elements meet: `angles` phi (m + 1,) along the lining [rad], `depths` (l + 1,) below
    its surface [m].

    `step` [rad]: length of the elements elsewhere, in the body and its overhangs; `behind`: least
    number of layers through backing and body each.
    """

    angles: Floats
    depths: Floats
    step: float
    behind: int = 1


def divide(shoe: Shoe, radius: float, elements: int) -> LiningDivision:
    """`elements` along the lining, graded to its edges; layers in proportion, graded to both faces."""
    start, end = shoe.arc
    thickness = shoe.lining.thickness
    return LiningDivision(
        angles=start + lining_angles(end - start, shoe, radius, elements),
        depths=graded(0, thickness, lining_layers(elements), thickness / 2, EDGE_SIZE),
        step=(end - start) / elements,
    )


def lining_angles(arc: float, shoe: Shoe, radius: float, elements: int) -> Floats:
    """Ends of the elements along a lining, from 0 to `arc` [rad]: symmetric, fine at its ends."""
    return graded(0.0, arc, elements, shoe.lining.thickness / radius, EDGE_SIZE)


def lining_layers(elements: int) -> int:
    """Layers through a lining with this number of elements along it."""
    return min(max(2, round(elements / 15)), 12)


def overhang(near: float, far: float, division: LiningDivision) -> Floats:
    """Places from `near`, where the lining ends, to `far`, about a step apart; both ends once even
    where they coincide.

    Where that would be more than MOST_BEYOND, their distances grow by one ratio from a step on.
    """
    length, step = abs(far - near), division.step
    if length < 1e-9:
        return np.array([near])
    count = max(1, round(length / step))
    parts = np.linspace(0, 1, min(count, MOST_BEYOND) + 1)
    if count > MOST_BEYOND:
        growth = _growth(length / step)
        parts = np.expm1(growth * np.arange(MOST_BEYOND + 1)) / np.expm1(growth * MOST_BEYOND)
    places = near + (far - near) * parts
    places[-1] = far
    return places


def layers_behind(thickness: float, division: LiningDivision, size: float, most: int) -> Floats:
    """Where the layers of backing or body end, as parts (m,) of its thickness, the last of them 1.

    `size` [m]: their thickness, where that makes no more than `most`.
    """
    count = max(division.behind, min(math.ceil(thickness / size), most))
    return np.arange(1, count + 1) / count


def half_geometric(length: float, smallest: float, ratio: float, largest: float) -> Floats:
    """Points from 0 to `length`; steps grow by `ratio` from about `smallest` up to `largest`."""
    points, step = [0.0], min(smallest, length / 2)
    while points[-1] < length:
        points.append(points[-1] + step)
        step = min(step * ratio, largest)
    return np.array(points) * length / points[-1]


def _growth(total: float) -> float:
    """g of MOST_BEYOND steps 1, e^g, e^2g, ... whose sum is `total`, by halving."""
    low, high = 0.0, 1.0
    while high - low > 1e-12:
        middle = 0.5 * (low + high)
        low, high = (
            (middle, high)
            if math.expm1(MOST_BEYOND * middle) < total * math.expm1(middle)
            else (low, middle)
        )
    return high


def graded(start: float, end: float, count: int, zone: float, smallest: float) -> Floats:
    """count + 1 points from start to end; steps shrink linearly over `zone` at each end to
    `smallest` of the inner.

    The step is h(d) = h_0 min(1, smallest + d / zone) at the distance d from the nearer end: points
    lie at equal parts of Int dd / h.
    """
    half = (end - start) / 2
    total = inner_steps(half, half, zone, smallest)
    part = total * np.minimum(np.arange(count + 1), np.arange(count + 1)[::-1]) / (count / 2)
    reach = min(zone * (1 - smallest), half)
    inner = inner_steps(reach, half, zone, smallest)
    d = np.where(
        part <= inner,
        zone * smallest * np.expm1(np.minimum(part, inner) / zone),
        reach + part - inner,
    )
    left = np.arange(count + 1) <= count / 2
    points = np.where(left, start + d, end - d)
    points[0], points[-1] = start, end
    return points


def inner_steps(d: float, half: float, zone: float, smallest: float) -> float:
    """Int_0^d dd h_0 / h of `graded`: the inner steps h_0 that its steps up to `d` stand for.

    Beyond the reach of the grading all steps are h_0.
    """
    reach = min(zone * (1 - smallest), half)
    return zone * math.log1p(min(d, reach) / (zone * smallest)) + max(d - reach, 0.0)
