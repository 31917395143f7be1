"""Random brakes of one shoe: geometry, stiffness, clearance and load of all sizes that linings are made in."""

import math
from typing import Any

import numpy as np

from drumlin.brake.drum_brake import Brake
from drumlin.brake.file import brake_from, vary
from drumlin.errors import BadInput, NoAnswer
from drumlin.fem.solve import solve
from drumlin.laws import locking_friction, sine

COARSE = 4  # elements of the mesh that shows whether a brake has an answer without friction


def random_brake(seed: int, way: str, attempt: int = 0) -> Brake:
    """A brake of one shoe; `way`: "locking" where the sine law locks below mu = 1.5, "opposed" where it never does."""
    rng = np.random.default_rng([seed, attempt])
    u, R, inside = rng.uniform, 0.15, bool(rng.random() < 0.6)
    origin, hand, gap, arc = u(-3, 3), rng.choice([-1, 1]), u(0.05, 0.4), u(0.4, 2.4)
    start, end = sorted([origin + hand * gap, origin + hand * (gap + arc)])
    far, even = origin + hand * (gap + arc), u(-2e-4, 1e-3) * R
    table = [[x, u(-2e-4, 1e-3) * R] for x in np.linspace(start, end, 5).tolist()]
    shoe: dict[str, Any] = {
        "name": "shoe", "side": "internal" if inside else "external",
        "hinge": {"radius": R * (u(0.25, 0.95) if inside else u(1.05, 1.6)), "angle": origin},
        "lining": {
            "start": start, "end": end, "thickness": R * 10 ** u(-2, -0.7), "width": 0.04,
            "material": {"E": 10 ** u(7.7, 9.7), "nu": u(0, 0.45)}, "clearance": [0.0, even, table][rng.integers(3)],
        },
        "actuation": {
            "force": 10 ** u(2, 5), "direction": far + (0 if inside else math.pi) + u(-0.9, 0.9),
            "point": {"radius": R * (u(0.5, 1) if inside else u(1, 1.6)), "angle": far},
        },
    }  # fmt: skip
    if rng.random() < 0.75:
        shoe["body"] = {"thickness": R * u(0.03, 0.25), "width": 0.04, "start": start - gap / 2, "end": end + gap / 2,
                        "material": {"E": 10 ** u(9.7, 11.5), "nu": 0.3}}  # fmt: skip
    data = {"title": f"random {seed}", "friction": 0.3, "drum": {"radius": R}, "shoe": [shoe]}
    try:
        for rotation in ("clockwise", "counter-clockwise"):
            brake = brake_from(data | {"rotation": rotation})
            law = locking_friction(brake, brake.shoes[0])
            if law < 1.5 if way == "locking" else math.isinf(law):
                sine(vary(brake, {"friction": 0.1 * min(law, 1.0)}))  # is it pressed, and within what the law covers?
                if solve(brake.model_copy(update={"friction": 0.0}), elements=COARSE).shoes[0].contact_arcs:
                    return brake
    except (BadInput, NoAnswer):
        pass
    return random_brake(seed, way, attempt + 1)
