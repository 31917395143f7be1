"""Types of numpy arrays, their comparison, slices of an array's parts, and polar angles of points.

The types do not tell the shapes: every docstring gives the shapes of its arrays in brackets.
"""

from collections.abc import Iterable, Mapping
from dataclasses import fields, is_dataclass
from itertools import accumulate, pairwise
from typing import Any

import numpy as np

# The types of arrays of any shape, by their entries: floats, integers, truth values, complex
# numbers.
Floats = np.ndarray[Any, np.dtype[np.float64]]
Ints = np.ndarray[Any, np.dtype[np.int64]]
Bools = np.ndarray[Any, np.dtype[np.bool_]]
Complexes = np.ndarray[Any, np.dtype[np.complex128]]
NumberOrArray = float | Floats
"""The type of a number, or of an array that broadcasts with the other arguments of a function."""


def slices_from_lengths_of_consecutive_parts(sizes: Iterable[int]) -> tuple[slice, ...]:
    """The slices that cut an array into consecutive parts; `sizes` are the lengths of the parts."""
    return tuple(slice(a, b) for a, b in pairwise(accumulate(sizes, initial=0)))


def polar_angles_within_half_turn_of_angle(middle: float, xy: Floats) -> Floats:
    """Polar angles [rad] of the points `xy` (2, ...), each within half a turn of `middle` [rad]."""
    # The points, as complex numbers, are turned by -middle. The angles relative to `middle` then
    # lie between -pi and pi, as `np.angle` gives them.
    turned = np.exp(-1j * middle) * (xy[0] + 1j * xy[1])
    return np.asarray(middle + np.angle(turned))


def text_of_fields_with_arrays_by_shape(value: Any) -> str:
    """A text for `repr` of a dataclass or NamedTuple: its fields, and each array by its shape."""
    names = [field.name for field in fields(value)] if is_dataclass(value) else value._fields
    texts = [f"{name}={_text_with_arrays_by_shape(getattr(value, name))}" for name in names]
    return f"{type(value).__name__}({', '.join(texts)})"


def _text_with_arrays_by_shape(value: Any) -> str:
    """The text of one field: `repr`, but each array in it by its shape."""
    if isinstance(value, np.ndarray):
        return f"array{value.shape}"
    if type(value) is tuple:
        return f"({', '.join(map(_text_with_arrays_by_shape, value))})"
    has_fields = is_dataclass(value) or hasattr(value, "_fields")
    return text_of_fields_with_arrays_by_shape(value) if has_fields else repr(value)


def are_nested_values_with_arrays_equal(one: Any, other: Any) -> bool:
    """Whether two values are equal, even if their tuples, lists and mappings have arrays in them.

    Arrays are equal if they have the same shape and the same entries.
    """
    if isinstance(one, np.ndarray) or isinstance(other, np.ndarray):
        return np.array_equal(one, other)
    if isinstance(one, Mapping) and isinstance(other, Mapping):
        return one.keys() == other.keys() and all(
            are_nested_values_with_arrays_equal(value, other[key]) for key, value in one.items()
        )
    if isinstance(one, tuple | list) and type(one) is type(other):
        return len(one) == len(other) and all(map(are_nested_values_with_arrays_equal, one, other))
    return bool(one == other)


class BaseClassWithArrayEquality:
    """Base class of results whose fields hold arrays: results with equal fields are equal.

    The comparison that Python gives to dataclasses raises an error for arrays. Subclasses are
    dataclasses with `eq=False`. Fields with `compare=False`, such as run times, are not compared.
    """

    # A result holds arrays and mappings, which have no hash.
    __hash__ = None  # type: ignore[assignment]

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        names = [field.name for field in fields(self) if field.compare]  # type: ignore[arg-type]
        return all(
            are_nested_values_with_arrays_equal(getattr(self, name), getattr(other, name))
            for name in names
        )
