"""The division of a parametric lining into elements along its arc and through its thickness.

Elements shrink linearly towards the lining's edges, where the pressure is singular.
"""

import math
from dataclasses import dataclass

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake.brake import Shoe

EDGE_SIZE = 1 / 32
"""Size of an element at the lining's sharp edge relative to an element in the lining's middle.

Layers at the lining's faces are as much thinner than in its middle. The pressure is singular at the
edge. With four times this size the error of p is a quarter larger in the median of 22 random
brakes, and up to six times as large; with half of this size the error is the same.
"""
MOST_OVERHANG_ELEMENTS = 200
"""Largest number of elements along the body on either side of the lining, to save memory.

Longer overhangs have larger elements.
"""
MOST_QUADRATIC_LAYERS = 8
"""Largest number of layers through the backing, and through the body, of quadratic elements.

With a limit the unknowns grow with the number of elements along the lining and not with its square.
On 22 random brakes twice as many layers take 1.4 times the unknowns for the same error of p. Half
as many layers make the error up to 2.4 times as large.
"""
MOST_LINEAR_LAYERS = 80
"""Largest number of layers through the backing, and through the body, of linear elements.

Linear elements bend well only in thin layers. The limit is the default number of elements along a
lining. On 22 random brakes 40 and 160 layers give the same errors.
"""


@dataclass(frozen=True)
class LiningDivision:
    """The division of a lining, and of the parts around it.

    Attributes
    ----------
    angles : (m + 1,) phi of the ends of the elements along the lining [rad]
    depths : (l + 1,) ends of its layers below its surface [m]
    step : length of the elements elsewhere, in the body and its overhangs [rad]
    behind : smallest number of layers through backing and body each
    """

    angles: Floats
    depths: Floats
    step: float
    behind: int = 1


def divide_lining(shoe: Shoe, radius: float, elements: int) -> LiningDivision:
    """The division of a lining into `elements`, graded to its ends, with layers in proportion."""
    start, end = shoe.arc
    thickness = shoe.lining.thickness
    return LiningDivision(
        angles=start + element_ends_along_lining(end - start, shoe, radius, elements),
        depths=points_graded_to_both_ends(
            0, thickness, number_of_lining_layers(elements), thickness / 2, EDGE_SIZE
        ),
        step=(end - start) / elements,
    )


def element_ends_along_lining(arc: float, shoe: Shoe, radius: float, elements: int) -> Floats:
    """Ends of the elements along a lining from 0 to `arc` [rad], graded to both of its ends."""
    return points_graded_to_both_ends(0.0, arc, elements, shoe.lining.thickness / radius, EDGE_SIZE)


def number_of_lining_layers(elements: int) -> int:
    """The number of layers through a lining with this number of elements along it."""
    return min(max(2, round(elements / 15)), 12)


def element_ends_beyond_lining(near: float, far: float, division: LiningDivision) -> Floats:
    """Ends of the elements from `near`, where the lining ends, to `far`, about a step apart.

    Ends that coincide count once. If equal steps would make more than MOST_OVERHANG_ELEMENTS
    elements, the first element is a step long and the lengths grow by one ratio.
    """
    length, step = abs(far - near), division.step
    if length < 1e-9:
        return np.array([near])
    count = max(1, round(length / step))
    parts = np.linspace(0, 1, min(count, MOST_OVERHANG_ELEMENTS) + 1)
    if count > MOST_OVERHANG_ELEMENTS:
        growth = _find_growth_of_overhang(length / step)
        parts = np.expm1(growth * np.arange(MOST_OVERHANG_ELEMENTS + 1)) / np.expm1(
            growth * MOST_OVERHANG_ELEMENTS
        )
    places = near + (far - near) * parts
    places[-1] = far
    return places


def layer_ends_behind_lining(
    thickness: float, division: LiningDivision, size: float, most: int
) -> Floats:
    """Ends (m,) of the layers of backing or body, as parts of its thickness, the last of them 1.

    Parameters
    ----------
    thickness : of backing or body [m]
    division : of the lining
    size : thickness of the layers [m], where that makes no more than `most`
    most : largest number of layers
    """
    count = max(division.behind, min(math.ceil(thickness / size), most))
    return np.arange(1, count + 1) / count


def points_with_growing_steps(
    length: float, smallest: float, ratio: float, largest: float
) -> Floats:
    """Points from 0 to `length` whose steps grow by `ratio` from about `smallest` to `largest`."""
    points, step = [0.0], min(smallest, length / 2)
    while points[-1] < length:
        points.append(points[-1] + step)
        step = min(step * ratio, largest)
    return np.array(points) * length / points[-1]


def _find_growth_of_overhang(total: float) -> float:
    """Return the growth g by which steps 1, e^g, e^2g, ... have the sum `total`, by bisection.

    The number of steps is MOST_OVERHANG_ELEMENTS.
    """
    low, high = 0.0, 1.0
    while high - low > 1e-12:
        middle = 0.5 * (low + high)
        if math.expm1(MOST_OVERHANG_ELEMENTS * middle) < total * math.expm1(middle):
            low = middle
        else:
            high = middle
    return high


def points_graded_to_both_ends(
    start: float, end: float, count: int, zone: float, smallest: float
) -> Floats:
    """count + 1 points from start to end, whose steps shrink linearly over a zone at each end.

    At the distance d from the nearer end the step is h(d) = h_0 min(1, smallest + d / zone). The
    points lie at equal parts of Int dd / h.

    Parameters
    ----------
    start, end : the ends
    count : number of steps
    zone : length over which the steps shrink at each end
    smallest : smallest step relative to the inner steps h_0
    """
    # Equal parts of the integral of dd / h give the points, mirrored about the middle.
    half = (end - start) / 2
    total = number_of_inner_steps(half, half, zone, smallest)
    part = total * np.minimum(np.arange(count + 1), np.arange(count + 1)[::-1]) / (count / 2)
    reach = min(zone * (1 - smallest), half)
    inner = number_of_inner_steps(reach, half, zone, smallest)
    in_zone = zone * smallest * np.expm1(np.minimum(part, inner) / zone)
    d = np.where(part <= inner, in_zone, reach + part - inner)
    # Points of the second half count their distance d from the end.
    left = np.arange(count + 1) <= count / 2
    points = np.where(left, start + d, end - d)
    points[0], points[-1] = start, end
    return points


def number_of_inner_steps(d: float, half: float, zone: float, smallest: float) -> float:
    """Return the number of inner steps h_0 with which the graded steps up to `d` count.

    The number is Int_0^d dd h_0 / h, with the steps h of `points_graded_to_both_ends`. Beyond the
    reach of the grading all steps are h_0.
    """
    reach = min(zone * (1 - smallest), half)
    return zone * math.log1p(min(d, reach) / (zone * smallest)) + max(d - reach, 0.0)
