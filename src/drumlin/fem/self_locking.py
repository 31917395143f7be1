"""Former name of the module drumlin.fem.analysis.self_locking; old imports work, with a warning."""

from drumlin.base.moved import make_getattr_function_of_moved_module

NEW_NAMES_OF_SELF_LOCKING_FUNCTIONS = {
    "limits": "self_locking_friction_of_shoe_groups",
    "torques": "shoe_torques_at_friction_coefficients",
}
"""The present name of each renamed function, by its old name."""

__getattr__ = make_getattr_function_of_moved_module(
    __name__, "drumlin.fem.analysis.self_locking", NEW_NAMES_OF_SELF_LOCKING_FUNCTIONS
)
