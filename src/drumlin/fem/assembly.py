"""Former name of the module drumlin.fem.preparation.prepare; old imports work, with a warning."""

from drumlin.base.moved import make_getattr_function_of_moved_module

NEW_NAMES_OF_ASSEMBLY_FUNCTIONS = {"prepare": "make_prepared_model"}
"""The present name of each renamed function, by its old name."""

__getattr__ = make_getattr_function_of_moved_module(
    __name__, "drumlin.fem.preparation.prepare", NEW_NAMES_OF_ASSEMBLY_FUNCTIONS
)
