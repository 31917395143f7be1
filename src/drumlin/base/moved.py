"""Keep old names of modules and of functions usable, with a DeprecationWarning."""

import warnings
from collections.abc import Callable, Mapping
from importlib import import_module
from typing import Any


def make_getattr_function_of_moved_module(
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
        """The object with this name in the new module, after a warning that the module has moved.

        Raises AttributeError for a private name, which begins with an underscore.
        """
        if name.startswith("_"):
            # Python itself looks up private names such as __path__, which must give no warning.
            raise AttributeError(f"module {old!r} has no attribute {name!r}")
        value = getattr(import_module(new), (renamed or {}).get(name, name))
        warnings.warn(f"{old} has moved to {new}", DeprecationWarning, stacklevel=2)
        return value

    return object_of_new_module_with_warning


def make_getattr_function_for_renamed_functions(
    module: str, renamed: Mapping[str, str]
) -> Callable[[str], Any]:
    """Make the function `__getattr__` of a module whose functions have new names.

    Each look-up of an old name returns the function, and warns with its new name.

    Parameters
    ----------
    module : dotted name of the module
    renamed : new names of functions by their old names
    """

    def function_by_old_name_with_warning(name: str) -> Any:
        """The function whose old name this is. Raises AttributeError for any other name."""
        if name not in renamed:
            raise AttributeError(f"module {module!r} has no attribute {name!r}")
        warnings.warn(f"{module}.{name} is now {renamed[name]}", DeprecationWarning, stacklevel=2)
        return getattr(import_module(module), renamed[name])

    return function_by_old_name_with_warning
