"""Modules that are imported when something of them is used: start-up costs what is called.

skfem and scipy.sparse take some 0.1 s each, scipy.linalg 0.3 s; a brake that is solved on columns uses none of them.
"""

from importlib import import_module
from typing import Any


class _Later:
    def __init__(self, name: str) -> None:
        self._name = name

    def __getattr__(self, attribute: str) -> Any:
        return getattr(import_module(self._name), attribute)


def later(name: str) -> Any:
    """Stands for the module `name`, which is imported when the first of its attributes is asked for."""
    return _Later(name)
