"""The clearance of worn-in linings: that with which they bear by the sine law, however elastic the brake is.

Wear goes with the pressure, so it ends where all points wear as the shoe turns: p ~ sin(phi). The gap that gives this
pressure on a round drum makes up for all that is elastic, and what is left free, a turn of the shoe, is such that the
unloaded lining touches.
"""

from collections.abc import Iterable
from typing import Any

import numpy as np
import scipy.linalg

from drumlin.arrays import Floats
from drumlin.brake import Brake, vary
from drumlin.errors import BadInput
from drumlin.fem.assembly import Scene
from drumlin.fem.group import groups_of
from drumlin.fem.model import PENALTY, respond
from drumlin.fem.solve import scene_of
from drumlin.foundation.model import SECTIONS, lifted, system
from drumlin.foundation.post import shoe_angles
from drumlin.laws import hinged, sine
from drumlin.laws.shapes import SINE
from drumlin.response import Response
from drumlin.response.merit import with_merits

FITTING = {"shoe.lining.clearance": 0.0, "shoe.lining.misfit": {}}
ROUND: dict[str, Any] = {"drum.out_of_round": []}


def solve(brake: Brake, *, penalty: float = PENALTY, **options: Any) -> Response:
    """The response of a brake of finite elements with linings that are worn in; `options` of `scene_of`."""
    scene = scene_of(brake, **options)
    return with_merits(brake, respond(scene, worn_in(scene, brake), penalty=penalty))


def worn_in(scene: Scene, brake: Brake) -> Brake:
    """The brake with every clearance and misfit of its linings replaced by those that wear ends with.

    A drum that is not round stays so: as it turns it wears the lining evenly, as far as the whole lining stays in
    contact. Raises NoAnswer for a self-locking shoe, BadInput where the sine law does not apply.
    """
    reason = hinged.why_not(SINE, brake)
    if reason is not None:
        raise BadInput(f"worn-in lining: no sine law for this brake: {reason}")
    law, fitting = sine(brake), vary(brake, FITTING)
    changes: dict[str, list[list[float]]] = {}
    round_ = vary(fitting, ROUND)
    for group in groups_of(scene, round_):
        size, problem, M = group.unit_force, group.problem, group.masses
        angles = [shoe.frame.theta(body.line.phi) for body, shoe in zip(group.bodies, group.shoes, strict=True)]
        p = np.concatenate([law.shoes[i].pressure_at(theta) for i, theta in zip(group.members, angles, strict=True)])
        closed = scipy.linalg.solve(M, size * problem.q + problem.A @ p, assume_a="pos")
        closing = np.abs(scipy.linalg.solve(M, problem.B, assume_a="pos"))  # per turn
        for k, (i, theta, part) in enumerate(zip(group.members, angles, group.parts, strict=True)):
            rows = _clearance(theta, closed[part], closing[part, k])
            changes[f"shoe[{i}].lining.clearance"] = rows[:: brake.shoes[i].frame.sense].tolist()
    return vary(fitting, changes)


def worn_in_foundation(brake: Brake, *, sections: int = SECTIONS, lift: Iterable[str] = ()) -> Brake:
    """The brake with every clearance and misfit replaced by that at which the foundation model bears by the sine law.

    Raises NoAnswer for a self-locking shoe.
    """
    names, law = lifted(brake, lift), sine(brake)
    fitting = vary(brake, FITTING | ROUND)
    changes: dict[str, list[list[float]]] = {}
    shoes = list(range(len(brake.shoes)))
    for group in [shoes] if "own-pressure" in names else [[i] for i in shoes]:
        parts = system(fitting, group, sections, names)
        angles = [shoe_angles(p.axis, brake.shoes[i], p.theta) for i, p in zip(group, parts.posts, strict=True)]
        N = np.concatenate(
            [
                law.shoes[i].pressure_at(theta) * brake.shoes[i].lining.width * brake.drum.radius * p.sector
                for i, theta, p in zip(group, angles, parts.posts, strict=True)
            ]
        )
        closed = parts.problem.q + parts.problem.A @ N  # what the clearance and the shoe's turn must make up
        first = 0
        for i, theta, p in zip(group, angles, parts.posts, strict=True):
            own = closed[first : first + len(theta)]
            first += len(theta)
            rows = _clearance(theta, own, p.closing[0])
            changes[f"shoe[{i}].lining.clearance"] = rows[:: p.axis.sense].tolist()
    return vary(fitting, changes)


def _clearance(theta: Floats, closed: Floats, closing: Floats) -> Floats:
    """Rows (n, 2) of angle and gap: what is `closed` made up for by a turn that closes `closing` (n,) [m/rad]."""
    return np.column_stack([theta, closing * np.max(closed / closing) - closed])
