"""A post brake for tests of the foundation model."""

import math

from drumlin.brake.brake import Brake
from drumlin.brake.file import make_drum_brake_from_data, vary


def upright(
    R=2.0, D=2.5, arc=40.0, EI=5e8, layer=5e8, mu=0.4, spin=1, gap=0.0, force=1e5, **more
) -> Brake:
    """A post brake with one post on the right of a rigid drum, hinged below, without blocks."""
    data = {
        "title": "post",
        "rotation": "counter-clockwise" if spin > 0 else "clockwise",
        "friction": mu,
        "drum": {"radius": R},
        "shoe": [
            {
                "name": "post",
                "side": "external",
                "hinge": {"x": D, "y": -2.3},
                "lining": {
                    "start": -math.radians(arc),
                    "end": math.radians(arc),
                    "thickness": 0.02,
                    "width": 0.3,
                    "material": {"E": layer, "nu": 0.25},
                    "clearance": gap,
                },
                "body": {"shape": "beam", "bending_stiffness": EI},
                "actuation": {"force": force, "direction": math.pi, "point": {"x": D, "y": 2.3}},
            }
        ],
    }
    return vary(make_drum_brake_from_data(data), more)
