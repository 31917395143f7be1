"""Check the types of arguments that a user passes to the public functions in Python."""

import numbers
import os
from collections.abc import Callable, Hashable, Sequence

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


def require_argument_of_annotated_type(name: str, value: object, annotation: str) -> None:
    """Raise BadInput if the value of an argument has none of its annotated types.

    A value of any type passes if the annotation has a type that WORDS_FOR_ANNOTATED_TYPES lacks.

    Parameters
    ----------
    name : name of the argument, for the error message
    value : its value
    annotation : its annotation as text, such as "int | None"
    """
    types = annotation.split(" | ")
    if set(types) - set(_TESTS_OF_TYPES):
        return
    if name in ARGUMENTS_THAT_LIST_THEIR_ALLOWED_TEXTS and isinstance(value, Hashable):
        return
    if not any(_TESTS_OF_TYPES[word](value) for word in types):
        *others, last = [WORDS_FOR_ANNOTATED_TYPES[word] for word in types]
        allowed = f"{', '.join(others)} or {last}" if others else last
        raise BadInput(f"{name} = {_value_or_shape_as_text(value)}: must be {allowed}")


MOST_SHOWN_ENTRIES_OF_ARRAY = 10
"""Largest number of entries of an array that an error line shows; of others it tells the shape."""


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


def _is_number_but_no_bool(value: object) -> bool:
    """Whether the value is a real number, of Python or of numpy; True and False are none."""
    is_real = isinstance(value, numbers.Real) or _kind_of_numpy_scalar(value) in ("i", "u", "f")
    return is_real and not _is_bool(value)


def _is_whole_number_but_no_bool(value: object) -> bool:
    """Whether the value is an integer, of Python or of numpy; True and False are none."""
    return isinstance(value, numbers.Integral) and not _is_bool(value)


def _is_list_of_texts(value: object) -> bool:
    """Whether the value is a list or another sequence of texts; a single text is none."""
    is_list = isinstance(value, Sequence) and not isinstance(value, str | bytes)
    return is_list and all(isinstance(entry, str) for entry in value)  # type: ignore[attr-defined]


_TESTS_OF_TYPES: dict[str, Callable[[object], bool]] = {
    "int": _is_whole_number_but_no_bool,
    "float": _is_number_but_no_bool,
    "bool": _is_bool,
    "str": lambda value: isinstance(value, str),
    "Path": lambda value: isinstance(value, os.PathLike),
    "Sequence[str]": _is_list_of_texts,
    "None": lambda value: value is None,
}
