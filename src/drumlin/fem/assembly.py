"""The old name of drumlin.fem.preparation.prepare."""

from drumlin.base.moved import moved

__getattr__ = moved(__name__, "drumlin.fem.preparation.prepare")
