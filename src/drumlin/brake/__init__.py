"""The brake as frozen, validated data: parts of drums and shoes, quantities with units, its file.

A `Brake` runs on a surface, a drum or a plane, see `drumlin.brake.surface`. `read_any` reads it
from a TOML file. Of drumlin the package imports the lowest room `drumlin.base` only.
"""

import warnings
from typing import Any

from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.file import read_brake, vary
from drumlin.brake.plane_brake import read_any

__all__ = ["Brake", "Shoe", "read_any", "read_brake", "vary"]


def __getattr__(name: str) -> Any:
    """Serve names of the time when a brake on a plane was another class, with a warning."""
    # The module is imported only when an old name is asked for.
    from drumlin.brake import plane_brake  # noqa: PLC0415

    old = {"AnyBrake": Brake, "FlatBrake": plane_brake.FlatBrake, "FlatShoe": plane_brake.FlatShoe}
    if name not in old:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    warnings.warn(
        f"drumlin.brake.{name}: use Brake or Shoe, whatever they run on",
        DeprecationWarning,
        stacklevel=2,
    )
    return old[name]
