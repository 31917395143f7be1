"""The description of a brake as immutable, validated data, and its TOML file.

The data are the parts of drum and shoes, with every quantity in SI units. The shoes of a `Brake`
press on a drum or on a plane, see `drumlin.brake.surface`. `read_drum_or_plane_brake` reads a brake
from its file. From the rest of drumlin this package imports `drumlin.base` only.
"""

import warnings
from typing import Any

from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.file import read_brake, vary
from drumlin.brake.plane_brake import read_drum_or_plane_brake

__all__ = ["Brake", "Shoe", "read_brake", "read_drum_or_plane_brake", "vary"]


def __getattr__(name: str) -> Any:
    """Return the class that an old name of this module stood for, with a DeprecationWarning.

    Former versions exported separate classes for brakes on a plane.
    """
    # The module is imported only when an old name is looked up.
    from drumlin.brake import plane_brake  # noqa: PLC0415

    old = {
        "BrakeTypeVariableInWear": Brake,
        "FlatBrake": plane_brake.FlatBrake,
        "FlatShoe": plane_brake.FlatShoe,
    }
    if name not in old:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    warnings.warn(
        f"drumlin.brake.{name}: use Brake or Shoe, whatever they run on",
        DeprecationWarning,
        stacklevel=2,
    )
    return old[name]
