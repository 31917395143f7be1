"""The old name of drumlin.fem.analysis.self_locking."""

from drumlin.base.moved import moved

RENAMED_IN_SELF_LOCKING = {"limits": "friction_limits_of_groups", "torques": "torques_at_frictions"}
"""The present name of each function by its old name."""

__getattr__ = moved(__name__, "drumlin.fem.analysis.self_locking", RENAMED_IN_SELF_LOCKING)
