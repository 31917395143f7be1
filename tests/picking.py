"""Values, rows and notes picked from lists of results."""

from collections.abc import Iterable, Mapping
from operator import attrgetter
from typing import Any

Names = str | tuple[str, ...]


def field(thing: Any, name: Names) -> Any:
    """One key of a row or one attribute of an object, such as "torque" or "lining.thickness".

    Several names give a tuple of their fields.
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
    """Rows or objects by one of their fields, or one of their fields by another."""
    return {field(one, key): one if value is None else field(one, value) for one in things}


def saying(texts: Iterable[str], words: str) -> list[str]:
    """The notes or lines that contain the words."""
    return [text for text in texts if words in text]
