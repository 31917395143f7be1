"""Types of arrays, and the places of parts in them. Shapes stand in the docstrings."""

from collections.abc import Iterable
from itertools import accumulate, pairwise
from typing import Any

import numpy as np

Floats = np.ndarray[Any, np.dtype[np.float64]]
Ints = np.ndarray[Any, np.dtype[np.int64]]
Bools = np.ndarray[Any, np.dtype[np.bool_]]
Values = float | Floats
"""One number or an array that broadcasts with the others."""


def in_turn(sizes: Iterable[int]) -> tuple[slice, ...]:
    """The places of parts of given sizes that stand one after the other in an array."""
    return tuple(slice(a, b) for a, b in pairwise(accumulate(sizes, initial=0)))


def angle_near(middle: float, xy: Floats) -> Floats:
    """Angles [rad] of the points xy (2, ...), within half a turn of `middle` [rad]."""
    # The points are turned back by the middle, so that their angles do not jump at half a turn.
    turned = np.exp(-1j * middle) * (xy[0] + 1j * xy[1])
    return np.asarray(middle + np.angle(turned))
