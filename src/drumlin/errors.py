"""The old name of the module drumlin.base.errors, which still works with a DeprecationWarning."""

from drumlin.base.moved import getattr_of_moved_module

__getattr__ = getattr_of_moved_module(__name__, "drumlin.base.errors")
