"""The division of a lining into linear or quadratic elements, along its arc and its thickness.

Elements become smaller towards the lining's ends, where the pressure is singular. Near an end their
size grows linearly with the distance from the end.
"""

import math
from dataclasses import dataclass

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake.brake import Shoe

RELATIVE_SIZE_OF_LINING_END_ELEMENT = 1 / 32
"""Size of the element at a lining's end, relative to the size of an element in its middle.

The layers of elements at the lining's two faces are thinner than those in its middle by the same
ratio. The pressure p is singular at the end. With four times this size the error of p is a quarter
larger in the median of 22 random brakes, and up to six times as large. With half of this size the
error is the same.
"""
DECIMALS_OF_RATIO_FREE_OF_ROUND_OFF = 9
"""Decimals of a ratio of two lengths that round-off does not change.

The ratios are numbers of elements, at most some thousands, with a relative round-off of 1e-15.
"""
MOST_ELEMENTS_BEYOND_LINING_END = 200
"""Largest number of elements along the shoe's body beyond each end of the lining, to save memory.

A body that reaches farther beyond the lining has larger elements.
"""
MOST_QUADRATIC_LAYERS_BEHIND_LINING = 8
"""Largest number of layers of quadratic elements through a shoe's backing, and through its body.

With this limit the number of unknowns is in proportion to the number of elements along the lining,
not to its square. On 22 random brakes twice as many layers took 1.4 times the unknowns and gave the
same error of the pressure. Half as many layers made the error up to 2.4 times as large.
"""
MOST_LINEAR_LAYERS_BEHIND_LINING = 80
"""Largest number of layers of linear elements through a shoe's backing, and through its body.

Linear elements bend well only in thin layers. The limit is the default number of elements along a
lining. On 22 random brakes 40 and 160 layers give the same errors.
"""


@dataclass(frozen=True)
class LiningDivision:
    """The division of a lining into elements, and the sizes of elements behind and beyond it.

    Attributes
    ----------
    angles : (m + 1,) angles phi of the ends of the elements along the lining [rad]
    depths : (l + 1,) depths of the ends of the lining's layers below its face [m]
    step : length [rad] of the elements of the body beyond the lining, and thickness of the layers
        of backing and body divided by the drum's radius
    behind : smallest number of element layers through the backing, and through the body
    """

    angles: Floats
    depths: Floats
    step: float
    behind: int = 1


def divide_lining_into_elements(shoe: Shoe, radius: float, elements: int) -> LiningDivision:
    """The division of a lining into a given number of elements along its arc.

    The elements become smaller towards the lining's ends. The number of layers grows with the
    number of elements, and layers are thinner at the lining's two faces.

    Parameters
    ----------
    shoe : the shoe of the lining
    radius : radius of the drum [m]
    elements : number of elements along the lining
    """
    start, end = shoe.arc
    thickness = shoe.lining.thickness
    return LiningDivision(
        angles=_element_ends_along_linings_and_slots(shoe, radius, elements),
        depths=points_graded_to_both_ends(
            0,
            thickness,
            number_of_element_layers_in_lining(elements),
            thickness / 2,
            RELATIVE_SIZE_OF_LINING_END_ELEMENT,
        ),
        step=(end - start) / elements,
    )


def _element_ends_along_linings_and_slots(shoe: Shoe, radius: float, elements: int) -> Floats:
    """The angles phi [rad] of the ends of the elements along all linings of a shoe and its slots.

    The parameters are those of `divide_lining_into_elements`.
    """
    start, end = shoe.arc
    parts = []
    for (first, last), count in zip(
        shoe.arcs, number_of_elements_on_each_lining(shoe, elements), strict=True
    ):
        parts.append(first + element_ends_along_lining(last - first, shoe, radius, count))
    # In a slot the elements have the mean length of those along the linings.
    for first, last in shoe.slots:
        count = max(1, _nearest_whole_number((last - first) * elements / (end - start)))
        parts.append(np.linspace(first, last, count + 1)[1:-1])
    return np.sort(np.concatenate(parts))


def number_of_elements_on_each_lining(shoe: Shoe, elements: int) -> list[int]:
    """The number of elements along each lining of a shoe, in proportion to its length.

    `elements` is the number along all linings together. If there are several linings, each of them
    gets two elements at least.
    """
    lengths = [end - start for start, end in shoe.arcs]
    if len(lengths) == 1:
        return [elements]
    total = sum(lengths)
    return [max(2, _nearest_whole_number(elements * length / total)) for length in lengths]


def _nearest_whole_number(ratio: float) -> int:
    """The whole number next to a ratio, the even one if the ratio lies in the middle.

    Ratios that differ by round-off have the same result. Otherwise a brake and its mirror image
    might have different elements.
    """
    return round(round(ratio, DECIMALS_OF_RATIO_FREE_OF_ROUND_OFF))


def element_ends_along_lining(arc: float, shoe: Shoe, radius: float, elements: int) -> Floats:
    """The angles [rad] of the ends of the elements along a lining, from 0 to `arc`.

    The elements become smaller towards both ends of the lining.

    Parameters
    ----------
    arc : angle that the lining covers [rad]
    shoe : the shoe of the lining
    radius : radius of the drum [m]
    elements : number of elements
    """
    return points_graded_to_both_ends(
        0.0, arc, elements, shoe.lining.thickness / radius, RELATIVE_SIZE_OF_LINING_END_ELEMENT
    )


def number_of_element_layers_in_lining(elements: int) -> int:
    """The number of layers through a lining with a given number of elements along its arc."""
    return min(max(2, round(elements / 15)), 12)


def element_ends_beyond_lining(near: float, far: float, division: LiningDivision) -> Floats:
    """The ends (m + 1,) of m elements of a shoe's body beyond one end of the lining [rad].

    The elements have about the length of the division's `step`. If there would be more than
    MOST_ELEMENTS_BEYOND_LINING_END of them, only the first one has this length, and the lengths
    grow by a constant ratio.

    Parameters
    ----------
    near : position of the lining's end [rad]
    far : position of the body's end [rad]; only `near` is returned if both coincide
    division : division of the lining
    """
    length, step = abs(far - near), division.step
    if length < 1e-9:
        return np.array([near])
    # The elements are equal. If they are too many, their number is limited, and their lengths grow
    # by a constant ratio with the distance from the lining.
    count = max(1, _nearest_whole_number(length / step))
    parts = np.linspace(0, 1, min(count, MOST_ELEMENTS_BEYOND_LINING_END) + 1)
    if count > MOST_ELEMENTS_BEYOND_LINING_END:
        growth = _element_growth_exponent_for_total_length(length / step)
        parts = np.expm1(growth * np.arange(MOST_ELEMENTS_BEYOND_LINING_END + 1)) / np.expm1(
            growth * MOST_ELEMENTS_BEYOND_LINING_END
        )
    places = near + (far - near) * parts
    places[-1] = far
    return places


def relative_layer_depths_behind_lining(
    thickness: float, division: LiningDivision, size: float, most: int
) -> Floats:
    """The depths (m,) at which m element layers of a backing or a body end, over its thickness.

    The layers have equal thickness, and the last depth is 1.

    Parameters
    ----------
    thickness : thickness of the backing or the body [m]
    division : division of the lining
    size : largest thickness of a layer [m]; it is exceeded if `most` layers are too few for it
    most : largest number of layers
    """
    count = max(division.behind, min(math.ceil(thickness / size), most))
    return np.arange(1, count + 1) / count


def _element_growth_exponent_for_total_length(total: float) -> float:
    """The growth g for which the sum of the steps 1, e^g, e^(2g), ... is `total`, by bisection.

    The steps are lengths of elements beyond the lining, relative to the first element's length.
    Their number is MOST_ELEMENTS_BEYOND_LINING_END.
    """
    low, high = 0.0, 1.0
    while high - low > 1e-12:
        middle = 0.5 * (low + high)
        if math.expm1(MOST_ELEMENTS_BEYOND_LINING_END * middle) < total * math.expm1(middle):
            low = middle
        else:
            high = middle
    return high


def points_graded_to_both_ends(
    start: float, end: float, count: int, zone: float, smallest: float
) -> Floats:
    """Points (count + 1,) from `start` to `end`, whose steps become smaller towards both ends.

    At the distance d from the nearer end the step is about h(d) = h_0 min(1, smallest + d / zone),
    with the step h_0 in the middle. The integral of 1/h(d) has the same value from each point to
    the next.

    Parameters
    ----------
    start, end : positions of the first and the last point
    count : number of steps
    zone : length at each end over which the steps become smaller
    smallest : step at the ends relative to the step h_0 in the middle
    """
    # The points are symmetric about the middle. The integral from the nearer end to each point
    # grows in equal parts, and the distance d follows from the integral.
    half = (end - start) / 2
    total = integral_of_inverse_graded_step(half, half, zone, smallest)
    part = total * np.minimum(np.arange(count + 1), np.arange(count + 1)[::-1]) / (count / 2)
    reach = min(zone * (1 - smallest), half)
    inner = integral_of_inverse_graded_step(reach, half, zone, smallest)
    in_zone = zone * smallest * np.expm1(np.minimum(part, inner) / zone)
    d = np.where(part <= inner, in_zone, reach + part - inner)
    # In the second half of the points d is the distance from `end`, before it from `start`.
    left = np.arange(count + 1) <= count / 2
    points = np.where(left, start + d, end - d)
    points[0], points[-1] = start, end
    return points


def integral_of_inverse_graded_step(d: float, half: float, zone: float, smallest: float) -> float:
    """The integral of h_0 / h(x) over the distance x from an end, from 0 to d; h is the step.

    The steps h are those of `points_graded_to_both_ends`. Beyond the zone in which they become
    smaller, all steps are h_0.

    Parameters
    ----------
    d : distance from the end
    half : distance of the middle from the end, which limits the zone
    zone : length over which the steps become smaller
    smallest : step at the end relative to h_0
    """
    # At distances from the end above `reach` all steps are h_0.
    reach = min(zone * (1 - smallest), half)
    return zone * math.log1p(min(d, reach) / (zone * smallest)) + max(d - reach, 0.0)
