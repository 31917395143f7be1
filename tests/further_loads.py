"""Brakes with forces, springs and masses besides the actuation of their shoes."""

import math
from typing import Any

import numpy as np

from drumlin.brake.brake import Brake
from drumlin.brake.file import make_drum_brake_from_data
from held_shoes import KINDS, STEEL, THIN

R = 0.11
BODY = {"thickness": 0.012, "width": 0.04, "start": -1.1, "end": 1.1, "material": STEEL}
FORCE = {"force": 150.0, "direction": 2.9, "point": {"x": 0.05, "y": 0.05}}
SUPPORTS: dict[str, dict[str, Any]] = KINDS | {"hinge": {"hinge": {"x": 0.03, "y": -0.085}}}

PULL = {
    "shoe": "right",
    "to": "left",
    "point": {"x": 0.05, "y": 0.03},
    "end": {"x": -0.05, "y": 0.03},
    "preload": 100.0,
}


def brake_with(
    kind: str = "hinge", spin: int = 1, mu: float = 0.3, brake: Any = None, **shoe: Any
) -> Brake:
    """A brake with one internal shoe on a support, with further keys of its shoe and of itself."""
    direction, point = (
        (0.05, {"x": 0.1, "y": 0.01}) if kind == "guide" else (0.0, {"x": 0.02, "y": 0.08})
    )
    data: dict[str, Any] = {
        "name": "shoe",
        "side": "internal",
        "lining": THIN | {"start": -0.95, "end": 0.95},
        "actuation": {"force": 1000.0, "direction": direction, "point": point},
    }
    rotation = "counter-clockwise" if spin > 0 else "clockwise"
    whole = {"title": "t", "rotation": rotation, "friction": mu, "drum": {"radius": R}}
    shoes = [{key: value for key, value in (data | SUPPORTS[kind] | shoe).items() if value}]
    return make_drum_brake_from_data(whole | {"shoe": shoes} | (brake or {}))


def two_shoes(body: bool = False, spin: int = 1, **brake: Any) -> Brake:
    """Two hinged shoes that are mirror images of each other, with further keys of the brake."""
    shoes = []
    for name, hand in (("right", 1), ("left", -1)):
        middle = 0.0 if hand > 0 else math.pi
        shoe: dict[str, Any] = {
            "name": name,
            "side": "internal",
            "hinge": {"x": hand * 0.03, "y": -0.085},
            "lining": THIN | {"start": middle - 0.9, "end": middle + 0.9},
            "actuation": {
                "force": 1000.0,
                "direction": 0.0 if hand > 0 else math.pi,
                "point": {"x": hand * 0.02, "y": 0.085},
            },
        }
        if "actuation" in brake:
            del shoe["actuation"]["force"]
        if body:
            shoe["body"] = BODY | {"start": middle - 1.1, "end": middle + 1.1}
        shoes.append(shoe)
    rotation = "counter-clockwise" if spin > 0 else "clockwise"
    whole = {"title": "t", "rotation": rotation, "friction": 0.3, "drum": {"radius": R}}
    return make_drum_brake_from_data(whole | {"shoe": shoes} | brake)


def moment(force: float, direction: float, point: Any, about: Any) -> float:
    """The moment [N m] of a force about a point, counter-clockwise positive, from first principles.

    It is computed from components, not by the functions of the package.
    """
    x, y = point["x"] - about["x"], point["y"] - about["y"]
    return force * (x * math.sin(direction) - y * math.cos(direction))


def single_force(*forces: dict[str, Any]) -> dict[str, Any]:
    """The one force with the same resultant and moment as several forces, for a brake file."""
    total, about_origin = np.zeros(2), 0.0
    for each in forces:
        direction = each["direction"]
        total += each["force"] * np.array([math.cos(direction), math.sin(direction)])
        about_origin += moment(each["force"], direction, each["point"], {"x": 0.0, "y": 0.0})
    size = float(np.hypot(*total))
    # The foot of the perpendicular from the origin on the line of action.
    x, y = (about_origin / size**2 * np.array([total[1], -total[0]])).tolist()
    return {"force": size, "direction": math.atan2(total[1], total[0]), "point": {"x": x, "y": y}}
