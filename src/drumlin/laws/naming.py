"""Choose the name of the rigid-shoe law for a brake."""

from drumlin.brake.brake import Brake
from drumlin.laws import flat, hinged, pivoted, rigid
from drumlin.laws.shapes import SINE
from drumlin.response.response import Response


def name_of(brake: Brake) -> str:
    """Name of the rigid-shoe law of a brake: "sine", "pivoted", "linear" or "rigid"."""
    known = {
        "sine": hinged.why_not(SINE, brake),
        "pivoted": pivoted.why_not(brake),
        "linear": flat.why_not(flat.LINEAR, brake),
    }
    for name, reason in known.items():
        if reason is None:
            return name
    return "rigid"


def why_not(brake: Brake) -> str | None:
    """Reason why the rigid-shoe law has another name than "rigid" for a brake, or None."""
    name = name_of(brake)
    return None if name == "rigid" else f"it is the law {name!r} of this brake"


def law(brake: Brake) -> Response:
    """Solve a brake by its rigid-shoe law. Raises NoAnswer if there is no equilibrium."""
    return rigid.solve(brake, name_of(brake))
