"""The old name of drumlin.fem.analysis.self_locking."""

from drumlin.base.moved import moved

__getattr__ = moved(__name__, "drumlin.fem.analysis.self_locking")
