"""The old name of drumlin.base.errors."""

from drumlin.base.moved import moved

__getattr__ = moved(__name__, "drumlin.base.errors")
