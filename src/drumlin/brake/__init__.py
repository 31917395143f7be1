"""The brake as frozen, validated data: what drums and shoes are made of, quantities with units, its file.

A brake on a drum is a `Brake`, one on a plane a `FlatBrake`; both are read from a TOML file by `read_any`. Imports
nothing of drumlin but arrays, errors, texts and files.
"""

from drumlin.brake.drum_brake import Brake, Shoe
from drumlin.brake.file import read_brake, vary
from drumlin.brake.plane_brake import AnyBrake, FlatBrake, FlatShoe, read_any

__all__ = ["AnyBrake", "Brake", "FlatBrake", "FlatShoe", "Shoe", "read_any", "read_brake", "vary"]
