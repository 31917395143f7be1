"""Array types, and parts of arrays. Shapes stand in the docstrings."""

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
    """The places of parts of these sizes in an array that holds one after the other."""
    return tuple(slice(a, b) for a, b in pairwise(accumulate(sizes, initial=0)))


def angle_near(middle: float, xy: Floats) -> Floats:
    """Angles [rad] of the points xy (2, ...), within half a turn of `middle` [rad]."""
    return np.asarray(middle + np.angle(np.exp(-1j * middle) * (xy[0] + 1j * xy[1])))
