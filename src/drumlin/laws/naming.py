"""Tell under which name the rigid-shoe law applies to a brake, such as "sine"."""

from drumlin.brake.brake import Brake
from drumlin.laws import flat, hinged, pivoted, rigid
from drumlin.laws.shapes import SINE_PRESSURE_LAW
from drumlin.response.response import Response


def name_of_rigid_shoe_law(brake: Brake) -> str:
    """The name of the rigid-shoe law of a brake: "sine", "pivoted", "linear" or "rigid".

    The name is "rigid" if none of the laws with a closed form applies to the brake.
    """
    known = {
        "sine": hinged.reason_against_hinged_shoe_law(SINE_PRESSURE_LAW, brake),
        "pivoted": pivoted.reason_against_pivoted_shoe_law(brake),
        "linear": flat.reason_against_flat_law(flat.LINEAR_PRESSURE_LAW, brake),
    }
    for name, reason in known.items():
        if reason is None:
            return name
    return "rigid"


def reason_why_brake_has_no_law_named_rigid(brake: Brake) -> str | None:
    """The reason why the rigid-shoe law of a brake is not named "rigid"; None if it is.

    The law has another name, such as "sine", if a closed-form law applies to this brake.
    """
    name = name_of_rigid_shoe_law(brake)
    return None if name == "rigid" else f"on this brake it is the same as the law {name!r}"


def solve_brake_by_its_rigid_shoe_law(brake: Brake) -> Response:
    """Solve a brake by the rigid-shoe law, and name the law in the response.

    The name is that of `name_of_rigid_shoe_law`.

    Raises NoAnswer if a shoe has no equilibrium.
    """
    return rigid.solve_brake_by_rigid_shoe_law(brake, name_of_rigid_shoe_law(brake))
