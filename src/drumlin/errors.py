"""The old name of the module drumlin.base.errors, which still works with a DeprecationWarning."""

from drumlin.base.moved import moved

__getattr__ = moved(__name__, "drumlin.base.errors")
