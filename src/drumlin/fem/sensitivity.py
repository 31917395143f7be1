"""The old name of drumlin.fem.analysis.sensitivity."""

from drumlin.base.moved import moved

__getattr__ = moved(__name__, "drumlin.fem.analysis.sensitivity")
