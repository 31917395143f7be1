"""The clearance of worn-in linings: that with which they bear by the rigid-shoe law, however elastic the brake is.

Wear goes with the pressure, so it ends where all points wear as the shoe moves: p ~ sin(phi) about a hinge. The gap
that gives this pressure on a round drum makes up for all that is elastic, and what is left free, a motion of the shoe,
is such that the unloaded lining touches.
"""

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
import scipy.linalg

from drumlin.brake import AnyBrake, Brake, Shoe
from drumlin.brake.components import Misfit
from drumlin.brake.fields import Rows, rows_of
from drumlin.brake.unrolled import on_drum
from drumlin.fem.assembly import Scene
from drumlin.fem.group import groups_of
from drumlin.fem.model import PENALTY, respond
from drumlin.fem.solve import as_given, scene_of
from drumlin.foundation.model import SECTIONS, lifted, system
from drumlin.foundation.post import shoe_angles
from drumlin.laws import rigid, sine
from drumlin.response import Response
from drumlin.response.merit import with_merits


def solve(brake: AnyBrake, *, penalty: float = PENALTY, **options: Any) -> Response:
    """The response of a brake of finite elements with linings that are worn in; `options` of `scene_of`."""
    own = on_drum(brake)
    scene = scene_of(own, **options)
    found = respond(scene, worn_in(scene, own), penalty=penalty)
    return with_merits(brake, as_given(brake, found))


def worn_in(scene: Scene, brake: Brake) -> Brake:
    """The brake with every clearance and misfit of its linings replaced by those that wear ends with.

    A drum that is not round stays so: as it turns it wears the lining evenly, as far as the whole lining stays in
    contact. Raises NoAnswer for a self-locking shoe.
    """
    under = rigid.forced(brake)
    pressed = [rigid.press(under, shoe) for shoe in under.shoes]
    fitting = fitted(brake)
    round_ = fitted(brake, drum=True)
    gaps: dict[int, Rows] = {}
    for group in groups_of(scene, round_):
        size, problem, M = group.unit_force, group.problem, group.masses
        angles = [shoe.frame.theta(body.line.phi) for body, shoe in zip(group.bodies, group.shoes, strict=True)]
        p = np.concatenate([rigid.pressure(pressed[i], theta) for i, theta in zip(group.members, angles, strict=True)])
        closed = scipy.linalg.solve(M, size * problem.q + problem.A @ p, assume_a="pos")
        ratios = np.divide(closed, p, out=np.full(len(p), -np.inf), where=p > 0)
        for i, theta, part in zip(group.members, angles, group.parts, strict=True):
            # The motion that the law wears by, so far that the unloaded lining touches, without round-off there; one
            # way of all under a cam.
            most = np.max(ratios if brake.shares else ratios[part])
            gap = np.where(ratios[part] == most, 0.0, most * p[part] - closed[part])
            sense = brake.shoes[i].frame.sense
            gaps[i] = rows_of(theta[::sense], gap[::sense])
    return fitted(fitting, gaps)


def fitted(brake: Brake, gaps: Mapping[int, Rows] | None = None, *, drum: bool = False) -> Brake:
    """The brake with linings that fit, but for the clearances `gaps` by shoe; drum: and on a round drum."""

    def fit(i: int, shoe: Shoe) -> Shoe:
        clearance = (gaps or {}).get(i, 0.0)
        lining = shoe.lining.model_copy(update={"clearance": clearance, "misfit": Misfit()})
        return shoe.model_copy(update={"lining": lining})

    shoes = tuple(fit(i, shoe) for i, shoe in enumerate(brake.shoes))
    changes: dict[str, Any] = {"shoes": shoes}
    if drum:
        changes["drum"] = brake.drum.model_copy(update={"out_of_round": ()})
    return brake.model_copy(update=changes)


def worn_in_foundation(brake: Brake, *, sections: int = SECTIONS, lift: Iterable[str] = ()) -> Brake:
    """The brake with every clearance and misfit replaced by that at which the foundation model bears by the sine law.

    Raises NoAnswer for a self-locking shoe.
    """
    names, law = lifted(brake, lift), sine(brake)
    fitting = fitted(brake, drum=True)
    gaps: dict[int, Rows] = {}
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
            gap = p.closing[0] * np.max(own / p.closing[0]) - own  # made up for by a turn of the shoe
            gaps[i] = rows_of(theta[:: p.axis.sense], gap[:: p.axis.sense])
    return fitted(fitting, gaps)
