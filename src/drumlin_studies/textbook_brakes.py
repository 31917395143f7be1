"""Brakes made from the few dimensions that textbooks give: drum, hinge, arc and friction."""

import math

from drumlin.brake.brake import Brake
from drumlin.brake.file import make_drum_brake_from_data
from drumlin.brake.plane_brake import make_drum_or_plane_brake_from_data

TEXTBOOK_LINING = {"thickness": 0.01, "width": 0.04, "material": {"E": 3e8, "nu": 0.25}}
"""Data of the lining of all drum brakes of this module, in SI units.

The brakes are solved by closed-form laws, whose results do not depend on thickness and modulus.
"""


def brake_with_one_hinged_shoe(
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
    """A drum brake with one hinged shoe that is pressed by a given moment about its hinge.

    The moment is applied as a force with a lever arm of 1 m. The force acts on the line from the
    drum's centre through the hinge, 1 m beyond the hinge, and is normal to this line.

    Parameters
    ----------
    R, a : float
        Radius of the drum, and distance of the hinge from the drum's centre [m].
    arc : tuple of two float
        Angles of the lining's ends, measured from the hinge [rad].
    moment : float
        Moment of the actuation about the hinge [N m].
    mu : float
        Coefficient of friction.
    side : str
        "internal" or "external".
    spin : int
        1 if the drum turns counter-clockwise, -1 if it turns clockwise.
    hand : int
        1 if the angles in `arc` count counter-clockwise from the hinge, -1 if they count clockwise.
    turned : float
        Angle [rad] of the hinge around the drum, counter-clockwise from the x axis.
    width : float
        Width of the lining [m].
    pivot : tuple of two float, optional
        Radius [m] of a pivot, and its angle from the hinge [rad], counted as in `arc`. With a pivot
        the shoe hangs on a lever, and the hinge is the hinge of the lever.
    """
    start, end = sorted(turned + hand * phi for phi in arc)
    # Sense of the actuation moment about the hinge: 1 if a counter-clockwise moment presses the
    # shoe on the drum, -1 if a clockwise moment does.
    pressing = -hand if side == "internal" else hand
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
    return make_drum_brake_from_data(
        {
            "title": "test",
            "rotation": "counter-clockwise" if spin > 0 else "clockwise",
            "friction": mu,
            "drum": {"radius": R},
            "shoe": [shoe],
        }
    )


def brake_with_block_on_lever(
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
    """A drum brake with a block on top of the drum, which a horizontal lever presses down.

    Parameters
    ----------
    R : float
        Radius of the drum [m].
    arm : float
        Distance of the force from the lever's pin [m].
    x, a : float
        Position [m] of the lever's pin: x to the left of the block's middle, and a above the top of
        the drum.
    P : float
        Downward force on the lever [N].
    mu : float
        Coefficient of friction.
    half : float
        Half of the block's arc [rad].
    spin : int
        1 if the drum turns counter-clockwise, -1 if it turns clockwise.
    """
    block = {
        "name": "block",
        "side": "external",
        "hinge": {"x": -x, "y": R + a},
        "lining": TEXTBOOK_LINING | {"start": math.pi / 2 - half, "end": math.pi / 2 + half},
        "actuation": {"force": P, "direction": -math.pi / 2, "point": {"x": arm - x, "y": R + a}},
    }
    return make_drum_brake_from_data(
        {
            "title": "block on a lever",
            "rotation": "counter-clockwise" if spin > 0 else "clockwise",
            "friction": mu,
            "drum": {"radius": R},
            "shoe": [block],
        }
    )


def brake_with_one_hinged_pad(
    *,
    h: float,
    span: tuple[float, float],
    moment: float,
    mu: float,
    sliding: str = "+x",
    hand: int = 1,
    width: float = 0.04,
) -> Brake:
    """A brake on a plane with one hinged flat shoe that is pressed by a moment about its hinge.

    Parameters
    ----------
    h : float
        Height of the hinge above the plane [m]. The hinge is at x = 0.
    span : tuple of two float
        Distances of the lining's ends from the hinge [m].
    moment : float
        Moment of the actuation about the hinge [N m].
    mu : float
        Coefficient of friction.
    sliding : str
        Direction in which the plane slides, "+x" or "-x".
    hand : int
        1 if the lining lies at positive x, -1 if it lies at negative x.
    width : float
        Width of the lining [m].
    """
    start, end = sorted(hand * x for x in span)
    return make_drum_or_plane_brake_from_data(
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
