"""Functions that select values, rows and notes from lists of results."""

from collections.abc import Iterable, Mapping
from operator import attrgetter
from typing import Any

Names = str | tuple[str, ...]


def field(thing: Any, name: Names) -> Any:
    """The value of a row's key or an object's attribute, such as "torque" or "lining.thickness".

    For several names the function returns a tuple of values.
    """
    if isinstance(name, tuple):
        return tuple(field(thing, one) for one in name)
    return thing[name] if isinstance(thing, Mapping) else attrgetter(name)(thing)


def picked(things: Iterable[Any], name: Names) -> list[Any]:
    """The named field of each row or object, in their order."""
    return [field(thing, name) for thing in things]


def having(things: Iterable[Any], **values: Any) -> list[Any]:
    """The rows or objects whose named fields have these values."""
    return [
        thing
        for thing in things
        if all(field(thing, name) == value for name, value in values.items())
    ]


def keyed(things: Iterable[Any], key: Names, value: Names | None = None) -> dict[Any, Any]:
    """A dictionary of rows or objects, or of one of their fields, by another of their fields."""
    return {field(one, key): one if value is None else field(one, value) for one in things}


def saying(texts: Iterable[str], words: str) -> list[str]:
    """The notes or lines that contain the words."""
    return [text for text in texts if words in text]
