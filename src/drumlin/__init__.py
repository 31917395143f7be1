"""drumlin: shoe brakes by the pressure laws and by finite elements in frictional contact, side by
side.

    import drumlin

    brake = drumlin.read_brake("brake.toml")
    response = drumlin.solve(brake)               # finite elements; model="sine" for a law
    print(response.torque, response.shoes[0].peak_pressure)
    response.plot()

`solve` answers by one model, `compare` by all that apply, `sweep` for many cases; `vary` changes
keys of a brake. What is wrong with the input raises BadInput, what has no answer NoAnswer, each
with one plain line. Numbers are SI.

Importing drumlin loads nothing else and changes nothing in the process: what is named here is
loaded when it is used.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from drumlin.base.errors import BadInput, NoAnswer
    from drumlin.brake import read_any as read_brake
    from drumlin.brake import vary
    from drumlin.brake.brake import Brake
    from drumlin.comparison import compare
    from drumlin.models import solve
    from drumlin.response import Response
    from drumlin.sweeps.run import sweep

__version__ = "0.1.0"

__all__ = [
    "BadInput",
    "Brake",
    "NoAnswer",
    "Response",
    "__version__",
    "compare",
    "read_brake",
    "solve",
    "sweep",
    "vary",
]

_PLACES = {
    "BadInput": ("drumlin.base.errors", "BadInput"),
    "Brake": ("drumlin.brake", "Brake"),
    "NoAnswer": ("drumlin.base.errors", "NoAnswer"),
    "Response": ("drumlin.response", "Response"),
    "compare": ("drumlin.comparison", "compare"),
    "read_brake": ("drumlin.brake", "read_any"),
    "solve": ("drumlin.models", "solve"),
    "sweep": ("drumlin.sweeps.run", "sweep"),
    "vary": ("drumlin.brake", "vary"),
}


def __getattr__(name: str) -> Any:
    if name not in _PLACES:
        raise AttributeError(f"module 'drumlin' has no attribute {name!r}")
    module, attribute = _PLACES[name]
    value = globals()[name] = getattr(import_module(module), attribute)
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
