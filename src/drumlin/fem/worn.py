"""The clearance of a worn-in lining of finite elements: that with which it bears by the sine law."""

from typing import Any

import numpy as np
import scipy.linalg

from drumlin.brake import Brake
from drumlin.brakefile import vary
from drumlin.errors import BadInput
from drumlin.fem.model import PENALTY, contact_problem, respond, turns_towards, unit_force
from drumlin.fem.scene import Scene, prepare
from drumlin.laws import hinged, sine
from drumlin.laws.shapes import SINE
from drumlin.response import Response

FITTING = {"shoe.lining.clearance": 0.0, "shoe.lining.misfit": {}}


def solve(brake: Brake, *, penalty: float = PENALTY, **options: Any) -> Response:
    """The response of a brake with linings that are worn in; `options` of `prepare`."""
    scene = prepare(brake, **options)
    return respond(scene, worn_in(scene, brake), penalty=penalty)


def worn_in(scene: Scene, brake: Brake) -> Brake:
    """The brake with every clearance and misfit of its linings replaced by those that wear ends with.

    Wear goes with the pressure, so it ends where all points wear as the shoe turns: p ~ sin(phi). The gap that
    gives this pressure on a round drum makes up for all that is elastic, and what is left free, a turn of the shoe,
    is such that the unloaded lining touches. A drum that is not round stays so: as it turns it wears the lining
    evenly, as far as the whole lining stays in contact. Raises NoAnswer for a self-locking shoe, BadInput where
    the sine law does not apply.
    """
    reason = hinged.why_not(SINE, brake)
    if reason is not None:
        raise BadInput(f"worn-in lining: no sine law for this brake: {reason}")
    law, fitting = sine(brake), vary(brake, FITTING)
    changes: dict[str, list[list[float]]] = {}
    touching = [i for i, shoe in enumerate(brake.shoes) if turns_towards(scene.bodies[i], shoe)]
    round_ = vary(fitting, {"drum.out_of_round": []})
    for group in [[i] for i in touching] if scene.ring is None else [touching] if touching else []:
        size, problem = unit_force(round_, group), contact_problem(scene, round_, group)
        bodies = [scene.bodies[i] for i in group]
        angles = [brake.shoes[i].frame.theta(body.line.phi) for i, body in zip(group, bodies, strict=True)]
        p = np.concatenate([law.shoes[i].pressure_at(theta) for i, theta in zip(group, angles, strict=True)])
        M = scipy.linalg.block_diag(*(body.coupling.M for body in bodies))
        closed = scipy.linalg.solve(M, size * problem.q + problem.A @ p, assume_a="pos")
        closing = np.abs(scipy.linalg.solve(M, problem.B, assume_a="pos"))  # per turn
        first = 0
        for k, (i, theta) in enumerate(zip(group, angles, strict=True)):
            part = slice(first, first + len(theta))
            first = part.stop
            own, turn = closed[part], closing[part, k]
            gap = turn * np.max(own / turn) - own
            rows = np.column_stack([theta, gap])[:: brake.shoes[i].frame.sense]
            changes[f"shoe[{i}].lining.clearance"] = rows.tolist()
    return vary(fitting, changes)
