"""drumlin: shoe brakes by pressure laws and by finite elements in frictional contact, side by side.

    import drumlin

    brake = drumlin.read_brake("brake.toml")      # or drumlin.example("double_shoe")
    response = drumlin.solve(brake)               # finite elements; model="sine" for a law
    print(response.torque, response.shoes[0].peak_pressure)
    response.plot()

`solve` computes a brake by one model, `compare` by all models that apply, and `sweep` for many
cases. `size` finds the value of a key that gives a wanted torque or peak pressure. `wear` wears the
linings, `hold` turns the drum from rest against the shoes, `sensitivity` gives derivatives of the
torque, `self_locking` finds the friction at which the brake locks, and `fields` gives displacements
and stresses. `reference` computes reference values with uncertainties,
and `check` compares a table of p(theta) with them. `law` registers a pressure law of your own, and
`remove_law` removes it. `vary` makes a brake with changed values, and `write_brake` writes its
file. Wrong input raises BadInput, and a brake without an answer raises
NoAnswer, each with a message of one line. All numbers are in SI units.

`import drumlin` loads no other module: each name below is loaded when it is first used.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from drumlin.base.errors import BadInput, NoAnswer
    from drumlin.brake.brake import Brake
    from drumlin.door import (
        check,
        compare,
        example,
        fields,
        hold,
        law,
        read_brake,
        reference,
        remove_law,
        self_locking,
        sensitivity,
        size,
        solve,
        sweep,
        vary,
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
    "law",
    "read_brake",
    "reference",
    "remove_law",
    "self_locking",
    "sensitivity",
    "size",
    "solve",
    "sweep",
    "vary",
    "wear",
    "write_brake",
]

# Module and name of the public objects that are not in drumlin.door, by their public name.
_MODULE_AND_NAME_BY_PUBLIC_NAME = {
    "BadInput": ("drumlin.base.errors", "BadInput"),
    "Brake": ("drumlin.brake", "Brake"),
    "NoAnswer": ("drumlin.base.errors", "NoAnswer"),
    "Response": ("drumlin.response", "Response"),
}


def __getattr__(name: str) -> Any:
    """Load the module of a public name when the name is first used, and return its object."""
    if name not in __all__:
        raise AttributeError(f"module 'drumlin' has no attribute {name!r}")
    module, attribute = _MODULE_AND_NAME_BY_PUBLIC_NAME.get(name, ("drumlin.door", name))
    value = globals()[name] = getattr(import_module(module), attribute)
    return value


def __dir__() -> list[str]:
    """The public names of drumlin in alphabetical order."""
    return sorted(__all__)
