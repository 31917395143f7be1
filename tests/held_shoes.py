"""Shoes on a drum held by a pivot, an abutment or a guide."""

from typing import Any

from drumlin.brake.brake import Brake
from drumlin.brake.file import make_drum_brake_from_data

R = 0.11
STEEL = {"E": 2.1e11, "nu": 0.3}
BODY = {"thickness": 0.012, "width": 0.04, "start": -1.15, "end": 1.1, "material": STEEL}
THIN = {"thickness": 0.001, "width": 0.04, "material": {"E": 3e8, "nu": 0.25}}
KINDS: dict[str, dict[str, Any]] = {
    "abutment": {"abutment": {"point": {"x": 0.025, "y": -0.08}, "direction": 0.2}},
    "rough abutment": {
        "abutment": {"point": {"x": 0.025, "y": -0.08}, "direction": 0.0, "friction": 0.2}
    },
    "pivot": {"hinge": {"x": -0.03, "y": -0.12}, "pivot": {"x": 0.12, "y": 0.004}},
    "guide": {"guide": {"direction": 0.1}},
}


def brake_of(kind: str, spin: int, mu: float = 0.35, **more: Any) -> Brake:
    """One internal shoe with a given support. The shoe is rigid unless it has a body.

    The lining is 1 mm thick and covers an angle of 2 rad, symmetrical about +x.
    """
    direction, point = (
        (0.05, {"x": 0.1, "y": 0.01}) if kind == "guide" else (0.0, {"x": 0.02, "y": 0.08})
    )
    shoe = {
        "name": "shoe",
        "side": "internal",
        "lining": THIN | {"start": -0.95, "end": 0.95},
        "actuation": {"force": 1000.0, "direction": direction, "point": point},
    }
    rotation = "counter-clockwise" if spin > 0 else "clockwise"
    data = {"title": "t", "rotation": rotation, "friction": mu, "drum": {"radius": R}}
    return make_drum_brake_from_data(data | {"shoe": [shoe | KINDS[kind] | more]})
