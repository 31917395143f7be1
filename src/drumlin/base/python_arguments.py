"""Check and convert the arguments that a user passes to the public functions in Python."""

import numbers
import os
from collections.abc import Callable, Hashable, Sequence, Set
from decimal import Decimal
from typing import Any

from drumlin.base.errors import BadInput
from drumlin.base.texts import value_as_text

WORDS_FOR_ANNOTATED_TYPES = {
    "int": "a whole number",
    "float": "a number",
    "bool": "True or False",
    "str": "a text",
    "Path": "a path",
    "Sequence[str]": "a list of texts",
    "None": "None",
}
"""What a value must be, in words for an error message, by the type in a function's annotation."""

ARGUMENTS_THAT_LIST_THEIR_ALLOWED_TEXTS = ("model", "kind", "name")
"""Names of arguments for which the functions themselves refuse a value that is no text.

Their error message lists the allowed texts, and helps more than a message on the type. They look
the value up in a table, for which it must have a hash value.
"""


def argument_with_annotated_type(name: str, value: object, annotation: str) -> object:
    """The value of an argument, converted to the annotated type that it stands for.

    A whole float serves as a whole number, 0 and 1 as False and True, a fraction and a decimal
    number as a number, and a set of texts as a list. A value of any type is returned unchanged if
    the annotation has a type that WORDS_FOR_ANNOTATED_TYPES lacks.

    Parameters
    ----------
    name : name of the argument, for the error message
    value : its value
    annotation : its annotation as text, such as "int | None"

    Raises
    ------
    BadInput
        for a value that has none of the annotated types, and stands for none of their values
    """
    types = annotation.split(" | ")
    if set(types) - set(_TESTS_OF_TYPES):
        return value
    if name in ARGUMENTS_THAT_LIST_THEIR_ALLOWED_TEXTS and isinstance(value, Hashable):
        return value
    for word in types:
        if _TESTS_OF_TYPES[word](value):
            return _CONVERSIONS_OF_TYPES.get(word, _same_value)(value)
    *others, last = [WORDS_FOR_ANNOTATED_TYPES[word] for word in types]
    allowed = f"{', '.join(others)} or {last}" if others else last
    raise BadInput(f"{name} = {_value_or_shape_as_text(value)}: must be {allowed}")


MOST_SHOWN_ENTRIES_OF_ARRAY = 10
"""Largest number of entries of an array that an error line shows; of a larger one the shape."""


def _value_or_shape_as_text(value: object) -> str:
    """A value as text for an error line; a large array of numpy by its shape alone."""
    size, shape = getattr(value, "size", 0), getattr(value, "shape", ())
    if isinstance(size, int) and size > MOST_SHOWN_ENTRIES_OF_ARRAY:
        return f"array of shape {shape}"
    return value_as_text(value)


def _kind_of_numpy_scalar(value: object) -> str:
    """The letter of numpy for the kind of a scalar or of an array without dimensions.

    The letter is "b" for a bool, "i" or "u" for an integer and "f" for a float. The result is ""
    for other arrays, and for values that are not of numpy.
    """
    # numpy is not imported for this test, because `import drumlin` must be fast.
    is_scalar = getattr(value, "shape", None) == ()
    return str(getattr(getattr(value, "dtype", None), "kind", "")) if is_scalar else ""


def _is_bool(value: object) -> bool:
    """Whether the value is True or False, of Python or of numpy."""
    return isinstance(value, bool) or _kind_of_numpy_scalar(value) == "b"


def _is_number_but_no_bool(value: Any) -> bool:
    """Whether the value is a real number that a float can hold; True and False are none.

    Numbers of Python, of numpy and of the modules `fractions` and `decimal` are numbers.
    """
    is_real_of_numpy = _kind_of_numpy_scalar(value) in ("i", "u", "f")
    is_real = is_real_of_numpy or isinstance(value, numbers.Real | Decimal)
    if not is_real or _is_bool(value):
        return False
    try:
        float(value)
    except (OverflowError, ValueError):
        # The number is a fraction beyond the largest float, or a signalling nan of `decimal`.
        return False
    return True


def _is_whole_number_but_no_bool(value: Any) -> bool:
    """Whether the value is a whole number such as 6 or 6.0; True and False are none."""
    return _is_number_but_no_bool(value) and (
        isinstance(value, numbers.Integral) or float(value).is_integer()
    )


def _is_truth_value(value: Any) -> bool:
    """Whether the value is True, False, 1 or 0, of Python or of numpy."""
    return _is_bool(value) or (_is_number_but_no_bool(value) and value in (0, 1))


def _is_list_or_set_of_texts(value: Any) -> bool:
    """Whether the value is a list, another sequence, or a set of texts; a single text is none."""
    is_list = isinstance(value, Sequence | Set) and not isinstance(value, str | bytes)
    return is_list and all(isinstance(entry, str) for entry in value)


def _float_of_number(value: Any) -> float:
    """The number as a float; an integer of Python stays an integer."""
    return value if isinstance(value, int | float) else float(value)


def _list_of_texts(value: Any) -> Sequence[str]:
    """The texts in their order; those of a set are sorted, because a set has no order."""
    return sorted(value) if isinstance(value, Set) else value


def _same_value(value: object) -> object:
    """The value itself, for a type whose values need no conversion."""
    return value


_TESTS_OF_TYPES: dict[str, Callable[[object], bool]] = {
    "int": _is_whole_number_but_no_bool,
    "float": _is_number_but_no_bool,
    "bool": _is_truth_value,
    "str": lambda value: isinstance(value, str),
    "Path": lambda value: isinstance(value, os.PathLike),
    "Sequence[str]": _is_list_or_set_of_texts,
    "None": lambda value: value is None,
}

_CONVERSIONS_OF_TYPES: dict[str, Callable[[Any], object]] = {
    "int": int,
    "float": _float_of_number,
    "bool": bool,
    "Sequence[str]": _list_of_texts,
}
