"""Brakes with one hinged shoe that carries several linings."""

from typing import Any

from drumlin.brake.brake import Brake
from drumlin.brake.file import make_drum_brake_from_data

STEEL = {"E": "210 GPa", "nu": 0.3}


def lining(start: float, end: float, **more: Any) -> dict[str, Any]:
    """The table of a lining from `start` to `end` [deg]."""
    return {
        "start": f"{start} deg",
        "end": f"{end} deg",
        "thickness": "18 mm",
        "width": "180 mm",
        "material": {"E": "300 MPa", "nu": 0.25},
        **more,
    }


def brake_with(linings: Any, **shoe: Any) -> Brake:
    """The brake of one hinged shoe on which linings with the given tables stand."""
    return make_drum_brake_from_data(
        {
            "title": "linings apart",
            "rotation": "clockwise",
            "friction": 0.35,
            "drum": {"radius": "210 mm"},
            "shoe": [
                {
                    "name": "right",
                    "side": "internal",
                    "hinge": {"x": "32 mm", "y": "-160 mm"},
                    "lining": linings,
                    "actuation": {
                        "force": "20 kN",
                        "direction": "0 deg",
                        "point": {"x": "30 mm", "y": "150 mm"},
                    },
                    **shoe,
                }
            ],
        }
    )


APART = brake_with([lining(-56, -5), lining(5, 56)])
BODY = {
    "thickness": "24 mm",
    "width": "60 mm",
    "start": "-70 deg",
    "end": "64 deg",
    "material": STEEL,
}
