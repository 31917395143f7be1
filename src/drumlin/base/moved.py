"""The old names of modules that have moved: they answer with a warning."""

import warnings
from collections.abc import Callable, Mapping
from importlib import import_module
from typing import Any


def moved(old: str, new: str, renamed: Mapping[str, str] | None = None) -> Callable[[str], Any]:
    """The `__getattr__` of an old module: it gives every public name of the new one and warns.

    The new module is loaded when its first name is asked for.

    Parameters
    ----------
    old, new : dotted names of both modules
    renamed : the present name of each function that had another name in the old module
    """

    def attribute(name: str) -> Any:
        """The value of a name in the new module."""
        if name.startswith("_"):
            # Python itself asks a module for such names, among them __path__.
            raise AttributeError(f"module {old!r} has no attribute {name!r}")
        value = getattr(import_module(new), (renamed or {}).get(name, name))
        warnings.warn(f"{old} has moved to {new}", DeprecationWarning, stacklevel=2)
        return value

    return attribute
