"""The old name of drumlin.fem.equilibrium.group."""

from drumlin.base.moved import moved

__getattr__ = moved(__name__, "drumlin.fem.equilibrium.group")
