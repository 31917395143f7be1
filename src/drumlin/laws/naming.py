"""The rigid-shoe law of a brake by the name that it has there."""

from drumlin.brake.brake import Brake
from drumlin.laws import flat, hinged, pivoted, rigid
from drumlin.laws.shapes import SINE
from drumlin.response.response import Response


def name_of(brake: Brake) -> str:
    """The name of the rigid-shoe law of a brake: "sine", "pivoted", "linear", or else "rigid"."""
    known = {
        "sine": hinged.why_not(SINE, brake),
        "pivoted": pivoted.why_not(brake),
        "linear": flat.why_not(flat.LINEAR, brake),
    }
    return next((name for name, reason in known.items() if reason is None), "rigid")


def why_not(brake: Brake) -> str | None:
    """Why the rigid-shoe law is not called "rigid" for a brake; None where it is."""
    name = name_of(brake)
    return None if name == "rigid" else f"it is the law {name!r} of this brake"


def law(brake: Brake) -> Response:
    """The response of a brake by its rigid-shoe law. Raises NoAnswer."""
    return rigid.solve(brake, name_of(brake))
