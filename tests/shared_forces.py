"""Brakes whose shoes share a force, because a cam or a strut acts on both."""

import math
from math import pi, radians
from typing import Any

from drumlin.brake.brake import Brake
from drumlin.brake.file import make_drum_brake_from_data

R = 0.11
STEEL = {"E": 2.1e11, "nu": 0.3}
LINING = {"thickness": 0.001, "width": 0.04, "material": {"E": 3e8, "nu": 0.25}}


def brake_of(spin: int, mu: float, shoes: list[dict[str, Any]], **more: Any) -> Brake:
    rotation = "counter-clockwise" if spin > 0 else "clockwise"
    return make_drum_brake_from_data(
        {"title": "t", "rotation": rotation, "friction": mu, "drum": {"radius": R}, "shoe": shoes}
        | more
    )


def cam_brake(
    spin: int = 1,
    mu: float = 0.3,
    body: float = 0.0,
    thickness: float = 0.001,
    web: float = 0.04,
    **table: Any,
) -> Brake:
    """Two hinged shoes, mirror images of each other, under an S-cam.

    With a `body` thickness [m] the shoes are elastic; with a `web` thickness [m] their table stands
    on a web.
    """
    shoes = []
    for name, hand, middle in (("right", 1, 0.0), ("left", -1, pi)):
        shoe = {
            "name": name,
            "side": "internal",
            "hinge": {"x": hand * 0.03, "y": -0.085},
            "lining": LINING | {"thickness": thickness, "start": middle - 0.9, "end": middle + 0.9},
            "actuation": {
                "direction": 0.0 if hand > 0 else pi,
                "point": {"x": hand * 0.02, "y": 0.085},
            },
        }
        if body:
            ends = (middle - 1.1, middle + 1.1)
            arc = {
                "thickness": body,
                "width": web,
                "start": ends[0],
                "end": ends[1],
                "material": STEEL,
            }
            shoe["body"] = arc | table
        shoes.append(shoe)
    return brake_of(spin, mu, shoes, actuation={"force": 2000.0})


def servo(spin: int = -1, mu: float = 0.3, body: float = 0.0) -> Brake:
    first = {
        "name": "first",
        "side": "internal",
        "abutment": {"point": {"x": 0.025, "y": -0.08}, "direction": math.atan(0.1)},
        "lining": LINING | {"start": 0.1 - radians(50), "end": 0.1 + radians(50)},
        "actuation": {"force": 1000.0, "direction": 0.0, "point": {"x": 0.02, "y": 0.08}},
    }
    lining = LINING | {"start": radians(-90 - 130), "end": radians(-90 - 20)}
    second = {
        "name": "second",
        "side": "internal",
        "hinge": {"x": -0.01, "y": 0.085},
        "lining": lining,
    }
    if body:
        arc = {"thickness": body, "width": 0.04, "material": STEEL}
        first["body"] = arc | {"start": 0.1 - radians(58), "end": 0.1 + radians(58)}
        second["body"] = arc | {"start": radians(-90 - 140), "end": radians(-90 - 14)}
    return brake_of(spin, mu, [first, second], link=[{"from": "first", "to": "second"}])
