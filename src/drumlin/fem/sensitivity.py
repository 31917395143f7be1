"""Former name of the module drumlin.fem.analysis.sensitivity; old imports work, with a warning."""

from drumlin.base.moved import make_getattr_function_of_moved_module

NEW_NAMES_OF_SENSITIVITY_FUNCTIONS = {
    "sensitivity": "compute_torque_sensitivity",
    "as_text": "sensitivity_as_text_lines",
    "law_sensitivity": "friction_sensitivity_by_rigid_shoe_law",
    "against_differences": "compare_torque_slopes_with_solve_differences",
}
"""The present name of each renamed function, by its old name."""

__getattr__ = make_getattr_function_of_moved_module(
    __name__, "drumlin.fem.analysis.sensitivity", NEW_NAMES_OF_SENSITIVITY_FUNCTIONS
)
