"""Types of numpy arrays, slices of the parts of an array, and polar angles of points.

The types say nothing of shapes: each docstring gives the shapes of its arrays in brackets.
"""

from collections.abc import Iterable
from itertools import accumulate, pairwise
from typing import Any

import numpy as np

# The types of arrays of any shape, by their entries: floats, integers, truth values, complex
# numbers.
Floats = np.ndarray[Any, np.dtype[np.float64]]
Ints = np.ndarray[Any, np.dtype[np.int64]]
Bools = np.ndarray[Any, np.dtype[np.bool_]]
Complexes = np.ndarray[Any, np.dtype[np.complex128]]
Values = float | Floats
"""The type of a number, or of an array that broadcasts with the other arguments of a function."""


def slices_of_consecutive_parts(sizes: Iterable[int]) -> tuple[slice, ...]:
    """The slices of consecutive parts of an array; `sizes` are the lengths of the parts."""
    return tuple(slice(a, b) for a, b in pairwise(accumulate(sizes, initial=0)))


def polar_angles_near_given_angle(middle: float, xy: Floats) -> Floats:
    """Polar angles [rad] of the points `xy` (2, ...), each within half a turn of `middle` [rad]."""
    # The points are turned by the angle -middle. Their angles then lie about 0, far from the jump
    # between pi and -pi.
    turned = np.exp(-1j * middle) * (xy[0] + 1j * xy[1])
    return np.asarray(middle + np.angle(turned))
