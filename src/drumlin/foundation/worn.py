"""The clearance of a worn-in lining: that with which it bears by the sine law however elastic the brake is."""

from collections.abc import Iterable

import numpy as np

from drumlin.brake import Brake
from drumlin.brakefile import vary
from drumlin.foundation.model import SECTIONS, lifted, system
from drumlin.foundation.post import shoe_angles
from drumlin.laws import sine


def worn_in(brake: Brake, *, sections: int = SECTIONS, lift: Iterable[str] = ()) -> Brake:
    """The brake with every clearance and misfit replaced by that at which the pressure is that of the sine law.

    Wear goes with the pressure, so it ends where all points wear as the shoe turns. What is left free, a turn of
    the shoe, is such that the unloaded lining touches. Raises NoAnswer for a self-locking shoe.
    """
    names, law = lifted(brake, lift), sine(brake)
    fitting = vary(brake, {"shoe.lining.clearance": 0.0, "shoe.lining.misfit": {}, "drum.out_of_round": []})
    indices = list(range(len(brake.shoes)))
    changes: dict[str, list[list[float]]] = {}
    groups = [indices] if "own-pressure" in names else [[i] for i in indices]
    for group in groups:
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
            gap = p.closing[0] * np.max(own / p.closing[0]) - own
            rows = np.column_stack([theta, gap])[:: p.axis.sense]
            changes[f"shoe[{i}].lining.clearance"] = rows.tolist()
    return vary(fitting, changes)
