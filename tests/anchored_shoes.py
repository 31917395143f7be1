"""Brakes whose shoes rest on anchors that they can leave."""

import math
from typing import Any

import numpy as np

import drumlin
from drumlin.brake.brake import Brake
from drumlin.brake.file import make_drum_brake_from_data

R, WIDTH = 0.14, 0.05
CYLINDER, FOOT, PIN = 0.095, -0.112, 0.118
"""Heights [m] of the wheel cylinder, the strut and the anchor above the drum's centre."""
FORCE = 1100.0
LINING = {
    "thickness": 0.0055,
    "width": WIDTH,
    "material": {"E": 3e8, "nu": 0.25},
}
STEEL = {"E": 2.1e11, "nu": 0.3}


def duo_servo(
    spin: int = 1,
    mu: float = 0.35,
    half: tuple[float, float] = (0.8, 0.8),
    body: bool = True,
    scale: float = 1.0,
    order: int = 1,
    **shoe: Any,
) -> Brake:
    """A duo-servo brake: the shoes right and left, on one strut and on either side of one anchor.

    `half` [rad] are half the arcs of both linings, `scale` multiplies all lengths, and the forces
    by its square. With the `order` -1 the left shoe comes first. `shoe` holds further keys of both.
    """
    shoes: list[dict[str, Any]] = []
    for name, hand, arc in (("right", 1, half[0]), ("left", -1, half[1])):
        outwards = 0.0 if hand > 0 else math.pi
        middle = outwards
        found = {
            "name": name,
            "side": "internal",
            "abutment": {
                "point": {"x": hand * 0.025 * scale, "y": FOOT * scale},
                "direction": outwards,
            },
            "anchor": [
                {"point": {"x": hand * 0.012 * scale, "y": PIN * scale}, "direction": outwards}
            ],
            "lining": LINING
            | {
                "thickness": 0.0055 * scale,
                "width": WIDTH * scale,
                "start": middle - arc,
                "end": middle + arc,
            },
            "actuation": {
                "force": FORCE * scale**2,
                "direction": outwards,
                "point": {"x": hand * 0.03 * scale, "y": CYLINDER * scale},
            },
        }
        if body:
            found["body"] = {
                "thickness": 0.03 * scale,
                "width": 0.02 * scale,
                "start": middle - 1.3,
                "end": middle + 1.2,
                "material": STEEL,
            }
            # The foot is the lower end of both bodies.
            if hand < 0:
                found["body"] |= {"start": middle - 1.2, "end": middle + 1.3}
        shoes.append(found | shoe)
    rotation = "counter-clockwise" if spin > 0 else "clockwise"
    return make_drum_brake_from_data(
        {
            "title": "t",
            "rotation": rotation,
            "friction": mu,
            "drum": {"radius": R * scale},
            "shoe": shoes[::order],
            "link": [{"from": "right", "to": "left"}],
        }
    )


def shoe_between_anchors(spin: int = 1, mu: float = 0.3, clearance: float = 0.0) -> Brake:
    """One rigid shoe that a force in its middle presses on the drum, between two anchors."""
    lining = LINING | {"start": -0.6, "end": 0.6}
    anchors = [
        {"point": {"x": 0.12, "y": -0.1}, "direction": math.pi / 2, "clearance": clearance},
        {"point": {"x": 0.12, "y": 0.1}, "direction": -math.pi / 2, "clearance": clearance},
    ]
    shoe = {
        "name": "block",
        "side": "internal",
        "anchor": anchors,
        "lining": lining,
        "actuation": {"force": 1e3, "direction": 0.0, "point": {"x": 0.1, "y": 0.0}},
    }
    rotation = "counter-clockwise" if spin > 0 else "clockwise"
    return make_drum_brake_from_data(
        {"title": "t", "rotation": rotation, "friction": mu, "drum": {"radius": R}, "shoe": [shoe]}
    )


def shoe_equations(hand: int, half: float, spin: int, mu: float) -> np.ndarray:
    """Forces x and y and moment about O on a shoe, (3, 2), of p = A cos + B sin with A, B = 1.

    The integrals over the lining by hand: cos^2, sin cos, sin^2, cos and sin.
    """
    a, b = (0.0 if hand > 0 else math.pi) + np.array([-half, half])
    cc = (b - a) / 2 + (math.sin(2 * b) - math.sin(2 * a)) / 4
    ss = (b - a) / 2 - (math.sin(2 * b) - math.sin(2 * a)) / 4
    cs = (math.sin(b) ** 2 - math.sin(a) ** 2) / 2
    c, s = math.sin(b) - math.sin(a), math.cos(a) - math.cos(b)
    drag, area = mu * spin, WIDTH * R
    return area * np.array(
        [
            [-cc - drag * cs, -cs - drag * ss],
            [-cs + drag * cc, -ss + drag * cs],
            [drag * R * c, drag * R * s],
        ]
    )


def forces(response: drumlin.Response) -> dict[str, float]:
    return {s.name: s.push.force for shoe in response.shoes for s in shoe.supports}
