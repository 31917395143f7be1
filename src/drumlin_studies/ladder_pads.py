"""The ladder's pads on a plane: brakes from the file up, against springs and the corner's
exponents.
"""

import math
from functools import partial

import numpy as np

from drumlin.brake.brake import Brake
from drumlin.brake.fields import Material
from drumlin.brake.plane_brake import any_from
from drumlin.fem.error_control.levels import LEVELS
from drumlin.fem.model import respond
from drumlin.fem.preparation.prepare import prepare
from drumlin.fem.solve import solve
from drumlin_studies import closed_forms
from drumlin_studies.ladder_case import DISCRETE, KnownAnswer

LENGTH, WIDTH, FORCE = 0.12, 0.04, 500.0
SOFT_LINING = Material(E=3e8, nu=0.25)


def guided(thickness: float, mu: float, lining: Material) -> Brake:
    """A pad on a guide that is square to the plane, rigid behind its lining."""
    shoe = {
        "name": "pad",
        "guide": {"direction": -math.pi / 2},
        "lining": {
            "start": 0.0,
            "end": LENGTH,
            "width": WIDTH,
            "thickness": thickness,
            "material": lining,
        },
        "actuation": {
            "force": FORCE,
            "direction": -math.pi / 2,
            "point": {"x": LENGTH / 2, "y": 0.1},
        },
    }
    data = {"title": "pad", "friction": mu, "plane": {"sliding": "+x"}, "shoe": [shoe]}
    return any_from(data)


def _squeezed() -> float:
    """By how much a thin lining gives way over p (1 - nu^2) t/E: what its ends miss halves with t."""
    off = []
    for t in (1e-3, 5e-4):
        (pad,) = solve(guided(t, 0.0, SOFT_LINING), penalty=math.inf).shoes
        assert pad.motion is not None
        off.append(
            -pad.motion[1]
            / (FORCE / (LENGTH * WIDTH) * t * (1 - SOFT_LINING.nu**2) / SOFT_LINING.E)
        )
    return 2 * off[1] - off[0]


def _edge(mu: float, nu: float) -> float:
    """lambda of p ~ r^(lambda - 1) at the edge that the plane runs onto."""
    brake = guided(0.02, mu, Material(E=3e8, nu=nu))
    (pad,) = respond(prepare(brake, LEVELS[5]), brake).shoes
    r = np.geomspace(2e-6, 4e-5, 12)
    return float(1 + np.polyfit(np.log(r), np.log(pad.pressure_at(r)), 1)[0])


PAD_CASES = (
    KnownAnswer(
        "thin pad on a plane",
        "a brake on a plane, lining as springs",
        "Winkler, p (1 - nu^2) t/E bonded",
        "yielding over the closed form, ends extrapolated",
        1.0,
        1e-3,
        DISCRETE,
        _squeezed,
    ),
    *(
        KnownAnswer(
            "edge of a pad on a plane",
            "singular pressure of a brake",
            "eigenvalue of the corner (Williams 1952)",
            f"lambda, nu = 0.3, mu = {mu}",
            closed_forms.corner_exponent(mu, 0.3),
            1e-2,
            DISCRETE,
            partial(_edge, mu, 0.3),
        )
        for mu in (0.1, 0.3, 0.5)
    ),
)
