"""Brakes with pads on a plane, one for each kind of support."""

from math import pi
from typing import Any

from drumlin.brake.file import make_validated_brake_part
from drumlin.brake.plane_brake import FlatBrake

LINING = {"thickness": 0.001, "width": 0.04, "material": {"E": 3e8, "nu": 0.25}}
BODY = {
    "thickness": 0.02,
    "width": 0.04,
    "start": 0.05,
    "end": 0.19,
    "material": {"E": 2.1e11, "nu": 0.3},
}
KINDS: dict[str, dict[str, Any]] = {
    "hinge": {"hinge": {"x": 0.0, "y": 0.06}},
    "guide": {"guide": {"direction": -pi / 2 + 0.2}},
    "pivot": {"hinge": {"x": 0.0, "y": 0.1}, "pivot": {"x": 0.12, "y": 0.03}},
    "abutment": {"abutment": {"point": {"x": 0.03, "y": 0.03}, "direction": 0.1, "friction": 0.1}},
}


def pad(kind: str, sliding: str = "+x", mu: float = 0.3, **more: Any) -> FlatBrake:
    shoe = {
        "name": "pad",
        "lining": LINING | {"start": 0.06, "end": 0.18},
        "actuation": {"force": 500.0, "direction": -pi / 2, "point": {"x": 0.25, "y": 0.08}},
    }
    if kind in {"abutment", "guide"}:
        shoe["actuation"] = {"force": 500.0, "direction": -pi / 2, "point": {"x": 0.14, "y": 0.08}}
    data = {
        "title": "t",
        "friction": mu,
        "plane": {"sliding": sliding},
        "shoe": [shoe | KINDS[kind] | more],
    }
    return make_validated_brake_part(FlatBrake, data)
