"""The old name of drumlin.fem.analysis.sensitivity."""

from drumlin.base.moved import moved

RENAMED_IN_SENSITIVITY = {
    "sensitivity": "compute_torque_sensitivity",
    "as_text": "sensitivity_as_text_lines",
    "law_sensitivity": "sensitivity_by_rigid_law",
    "against_differences": "compare_with_differences_of_solves",
}
"""The present name of each function by its old name."""

__getattr__ = moved(__name__, "drumlin.fem.analysis.sensitivity", RENAMED_IN_SENSITIVITY)
