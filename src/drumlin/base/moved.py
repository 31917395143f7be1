"""Keep the old names of modules that have moved usable, with a DeprecationWarning."""

import warnings
from collections.abc import Callable, Mapping
from importlib import import_module
from typing import Any


def getattr_of_moved_module(
    old: str, new: str, renamed: Mapping[str, str] | None = None
) -> Callable[[str], Any]:
    """Make the function `__getattr__` of an old module, which looks up names in the new module.

    Each look-up warns that the module has moved. The new module is imported at the first look-up.

    Parameters
    ----------
    old, new : dotted names of the old and of the new module
    renamed : new names of functions by their old names, for functions that were renamed as well
    """

    def object_of_new_module_with_warning(name: str) -> Any:
        """The object that has this name in the new module. Raises AttributeError for `_name`."""
        if name.startswith("_"):
            # Python asks every module for private names such as __path__, and must not be warned.
            raise AttributeError(f"module {old!r} has no attribute {name!r}")
        value = getattr(import_module(new), (renamed or {}).get(name, name))
        warnings.warn(f"{old} has moved to {new}", DeprecationWarning, stacklevel=2)
        return value

    return object_of_new_module_with_warning
