"""Brakes from the numbers that textbooks give."""

import math

from drumlin.brake.brake import Brake
from drumlin.brake.file import brake_from
from drumlin.brake.plane_brake import any_from

TEXTBOOK_LINING = {"thickness": 0.01, "width": 0.04, "material": {"E": 3e8, "nu": 0.25}}


def hinged(
    *,
    R: float,
    a: float,
    arc: tuple[float, float],
    moment: float,
    mu: float,
    side: str = "internal",
    spin: int = 1,
    hand: int = 1,
    turned: float = 0.0,
    width: float = 0.04,
    pivot: tuple[float, float] | None = None,
) -> Brake:
    """One shoe with its hinge at the angle `turned`, its lining on the `hand` side, pressed by
    `moment` [N m].

    The force is a unit of moment away: across the hinge's radius, through the point a + 1 m from O.
    """
    start, end = sorted(turned + hand * phi for phi in arc)
    pressing = -hand if side == "internal" else hand  # sense of the moment
    shoe = {
        "name": "shoe",
        "side": side,
        "hinge": {"radius": a, "angle": turned},
        "lining": TEXTBOOK_LINING | {"start": start, "end": end, "width": width},
        "actuation": {
            "force": moment,
            "direction": turned + pressing * math.pi / 2,
            "point": {"radius": a + 1.0, "angle": turned},
        },
    }
    if pivot is not None:
        radius, phi = pivot
        shoe["pivot"] = {"radius": radius, "angle": turned + hand * phi}
    return brake_from(
        {
            "title": "test",
            "rotation": "counter-clockwise" if spin > 0 else "clockwise",
            "friction": mu,
            "drum": {"radius": R},
            "shoe": [shoe],
        }
    )


def lever_block(
    *,
    R: float,
    arm: float,
    x: float,
    a: float,
    P: float,
    mu: float,
    half: float,
    spin: int,
) -> Brake:
    """Block on top of the drum, its lever's pin x to the left and a above the line of friction, P
    down at the arm.
    """
    block = {
        "name": "block",
        "side": "external",
        "hinge": {"x": -x, "y": R + a},
        "lining": TEXTBOOK_LINING | {"start": math.pi / 2 - half, "end": math.pi / 2 + half},
        "actuation": {"force": P, "direction": -math.pi / 2, "point": {"x": arm - x, "y": R + a}},
    }
    return brake_from(
        {
            "title": "block on a lever",
            "rotation": "counter-clockwise" if spin > 0 else "clockwise",
            "friction": mu,
            "drum": {"radius": R},
            "shoe": [block],
        }
    )


def pad(
    *,
    h: float,
    span: tuple[float, float],
    moment: float,
    mu: float,
    sliding: str = "+x",
    hand: int = 1,
    width: float = 0.04,
) -> Brake:
    """One flat shoe, its hinge h above the plane at x = 0, its lining on the `hand` side, pressed
    by `moment`.
    """
    start, end = sorted(hand * x for x in span)
    return any_from(
        {
            "title": "test",
            "friction": mu,
            "plane": {"sliding": sliding},
            "shoe": [
                {
                    "name": "pad",
                    "hinge": {"x": 0.0, "y": h},
                    "lining": {"start": start, "end": end, "width": width},
                    "actuation": {
                        "force": moment,
                        "direction": -math.pi / 2,
                        "point": {"x": hand * 1.0, "y": h},
                    },
                }
            ],
        },
    )
