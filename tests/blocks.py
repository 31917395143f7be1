"""A double-shoe brake whose lining has many blocks, and its pressure by curved triangles.

`python tests/blocks.py` computes the reference pressures and torques of the tests, and writes them
to blocks_truth.json. It takes a few minutes. The references come from
`drumlin.verification.triangles`, which shares only the description of the brake with the finite
elements of the solver.
"""

import json
from pathlib import Path
from typing import Any

import numpy as np

from drumlin import Brake, vary
from drumlin.brake import read_brake
from drumlin.verification import triangles
from drumlin_studies.stated_true import true_errors_of_response

HERE = Path(__file__).parent
STORED = HERE / "blocks_truth.json"
STEPS = (10, 12)
ANGLES = 201
DEPTH = 3e-6  # m


def brake_of(steps: int) -> Brake:
    """The left shoe alone, with a lining of equal blocks.

    The faces of the blocks stand back irregularly by 0 to 3 um.
    """
    whole = read_brake(HERE.parent / "studies" / "double_shoe" / "brake.toml")
    brake = whole.model_copy(update={"shoes": whole.shoes[:1]})
    lining = brake.shoes[0].lining
    places = np.linspace(lining.start, lining.end, steps + 2)[1:-1].tolist()
    rows = [[place, DEPTH * (7 * i % 10) / 10] for i, place in enumerate(places, 1)]
    return vary(brake, {"shoe[0].lining.misfit.blocks": rows})


def angles_of(brake: Brake) -> np.ndarray:
    """Evenly spaced angles [rad] of the stored pressures.

    The angles keep 0.2 deg away from the lining's ends.
    """
    lining = brake.shoes[0].lining
    return np.linspace(lining.start + 0.005, lining.end - 0.005, ANGLES)


def stored(steps: int) -> dict[str, Any]:
    """The stored solution by triangles of `brake_of(steps)`.

    `torque` [N m], `pressure` (ANGLES,) [Pa], and `moved`, the relative L2 change of the pressure
    by the last refinement of the triangles.
    """
    found: dict[str, Any] = json.loads(STORED.read_text())[str(steps)]
    return found


def _by_triangles(steps: int) -> dict[str, Any]:
    brake = brake_of(steps)
    *_, before, last = triangles.solve_brake_on_sequence_of_triangle_meshes(brake)
    pressure = last[0].pressure_at(angles_of(brake))
    return {
        "torque": last[0].torque,
        "moved": float(f"{true_errors_of_response(brake, before, last)['pressure']:.2g}"),
        "pressure": [float(f"{p:.6g}") for p in pressure],
    }


if __name__ == "__main__":
    STORED.write_text(json.dumps({str(steps): _by_triangles(steps) for steps in STEPS}) + "\n")
