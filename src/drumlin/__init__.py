"""drumlin: shoe brakes by pressure laws and by finite elements in frictional contact, side by side.

    import drumlin

    brake = drumlin.read_brake("brake.toml")      # or drumlin.example("double_shoe")
    response = drumlin.solve(brake)               # finite elements; model="sine" for a law
    print(response.torque, response.shoes[0].peak_pressure)
    response.plot()

`solve` answers by one model, `compare` by all models that apply, `sweep` for many cases. `wear`
runs the linings in, `hold` turns a brake from rest, `sensitivity` gives slopes of the torque,
`self_locking` its limit, `fields` the stresses. `reference` makes values to cite, and `check`
compares a table of p(theta) with them. `vary` changes keys of a brake, `write_brake` writes its
file. Wrong input raises BadInput, a brake without an answer NoAnswer, each with one plain line.
Numbers are SI.

Importing drumlin loads nothing else and changes nothing in the process: each name below is loaded
when it is first used.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from drumlin.base.errors import BadInput, NoAnswer
    from drumlin.brake import read_any as read_brake
    from drumlin.brake import vary
    from drumlin.brake.brake import Brake
    from drumlin.door import (
        check,
        compare,
        example,
        fields,
        hold,
        reference,
        self_locking,
        sensitivity,
        solve,
        sweep,
        wear,
        write_brake,
    )
    from drumlin.response import Response

__version__ = "0.1.0"

__all__ = [
    "BadInput",
    "Brake",
    "NoAnswer",
    "Response",
    "__version__",
    "check",
    "compare",
    "example",
    "fields",
    "hold",
    "read_brake",
    "reference",
    "self_locking",
    "sensitivity",
    "solve",
    "sweep",
    "vary",
    "wear",
    "write_brake",
]

# The names that the functions' own module does not have: module, and name there.
_ELSEWHERE = {
    "BadInput": ("drumlin.base.errors", "BadInput"),
    "Brake": ("drumlin.brake", "Brake"),
    "NoAnswer": ("drumlin.base.errors", "NoAnswer"),
    "Response": ("drumlin.response", "Response"),
    "read_brake": ("drumlin.brake", "read_any"),
    "vary": ("drumlin.brake", "vary"),
}


def __getattr__(name: str) -> Any:
    """A public name, loaded when it is first asked for."""
    if name not in __all__:
        raise AttributeError(f"module 'drumlin' has no attribute {name!r}")
    module, attribute = _ELSEWHERE.get(name, ("drumlin.door", name))
    value = globals()[name] = getattr(import_module(module), attribute)
    return value


def __dir__() -> list[str]:
    """The public names."""
    return sorted(__all__)
