"""The old name of drumlin.fem.preparation.assembly."""

from drumlin.base.moved import moved

__getattr__ = moved(__name__, "drumlin.fem.preparation.assembly")
