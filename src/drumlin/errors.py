"""The old name of the module drumlin.base.errors, which still works with a DeprecationWarning."""

from drumlin.base.moved import make_getattr_function_of_moved_module

__getattr__ = make_getattr_function_of_moved_module(__name__, "drumlin.base.errors")
