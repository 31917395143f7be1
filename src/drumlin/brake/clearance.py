"""Misfit as clearance: lining circle against drum circle, taper, steps between blocks, a drum that
is not round.

Every misfit is a gap along the drum's radius, or the normal of the plane, positive = open, that
adds to the lining's `clearance`. So it acts in each model that has a clearance (finite elements,
foundation) and shares their condensed bodies; the laws are those of a lining that fits. In plane
stress a misfit across the width (coning, bell-mouthing) does not exist. The slope of the surfaces
is left out: normals stay those of the drum's circle, which for lobes of order n and amplitude a
leaves out at most n a/(mu R) of the torque.
"""

from collections.abc import Callable, Sequence
from typing import TypeVar

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.components import Lining
from drumlin.brake.file import vary

ROUND = 1e-9
"""Fraction of the largest change of slope in a clearance table. A smaller change is round-off, no
tip of the gap.
"""
T = TypeVar("T")


def gap(brake: Brake, shoe: Shoe, theta: Floats) -> Floats:
    """Gap [m] of a shoe's unloaded lining from the surface as it stands, at the places theta, same
    shape.
    """
    lining, misfit = shoe.lining, shoe.lining.misfit
    total = lining.clearance_at(theta)
    if misfit.radius is not None or misfit.offset.radius > 0:
        total = total + shoe.misfit_gap(theta, brake.size)
    if misfit.taper:
        total = total + misfit.taper * (shoe.frame.sense * (theta - lining.middle)) / (
            lining.end - lining.start
        )
    if misfit.blocks:
        total = total + block_gap(lining, theta)
    off = brake.surface_off(theta)
    return total if off is None else total + shoe.sign * off


def block_gap(lining: Lining, theta: Floats) -> Floats:
    """How far the blocks of a lining stand back [m] at theta, same shape: level, with rounded steps
    of the arc `step`.

    A step of height h has the smallest radius (R step)^2/(6 h).
    """
    gap, before = np.zeros(np.shape(theta)), 0.0
    for begin, depth in lining.misfit.blocks:
        x = np.clip((theta - begin) / lining.step + 0.5, 0.0, 1.0)
        gap, before = gap + (depth - before) * x**2 * (3 - 2 * x), depth
    return gap


def kinks(lining: Lining) -> list[float]:
    """Angles [rad] at which a lining's gap is not smooth."""
    return [*table_kinks(lining), *step_kinks(lining)]


def table_kinks(lining: Lining) -> list[float]:
    """Angles [rad] of the rows of a lining's table of clearances, between which the clearance is
    straight."""
    return [angle for angle, _ in lining.clearance] if isinstance(lining.clearance, tuple) else []


def step_kinks(lining: Lining) -> list[float]:
    """Angles [rad] at which the rounded steps between a lining's blocks begin and end."""
    half = lining.step / 2
    return [begin + side for begin, _ in lining.misfit.blocks for side in (-half, half)]


def tips(lining: Lining) -> list[tuple[float, float]]:
    """Where a lining's gap has a kink that points to the drum, under which a pressure is unbounded:
    the angle [rad], and by how much the slope of the gap changes there [m/rad]."""
    change = slope_changes(lining)
    sharp = change > ROUND * np.abs(change).max(initial=0.0)
    rows = zip(table_kinks(lining), change.tolist(), sharp, strict=True)
    return [(angle, slope) for angle, slope, is_sharp in rows if is_sharp]


def slope_changes(lining: Lining) -> Floats:
    """By how much the slope of the clearance [m/rad] changes at each of `table_kinks`; it is level
    beyond the table."""
    if not isinstance(lining.clearance, tuple):
        return np.zeros(0)
    angle, gap = np.array(lining.clearance).T
    return np.diff(np.concatenate([[0.0], np.diff(gap) / np.diff(angle), [0.0]]))


def thermal_growth(R: float, expansion: float, warming: float) -> float:
    """Growth of a drum's radius [m] by its mean warming [K], expansion [1/K]: the amplitude of
    lobes of order 0.
    """
    return expansion * warming * R


def one_turn(brake: Brake, solve: Callable[[Brake], T], angles: Sequence[float]) -> list[T]:
    """The responses as the drum stands at each of the angles [rad], with steady forces and without
    inertia.

    solve: any model, such as `respond` on one scene: the bodies stay. Raises what it raises.
    """
    return [solve(vary(brake, {"drum.angle": angle})) for angle in angles]


def ground_to(brake: Brake, mismatch: float) -> dict[str, float]:
    """Changes (of `vary`): every lining ground to a radius that is greater than the drum's by the
    mismatch [m].
    """
    return {
        f"shoe[{i}].lining.misfit.radius": brake.size + mismatch for i in range(len(brake.shoes))
    }


def set_off(brake: Brake, size: float) -> dict[str, float]:
    """Changes: every lining's circle moved by `size` [m] along the radius of its hinge, away from
    the drum's centre.
    """
    slopes = [along_hinge(brake, i, "lining.misfit.offset") for i in range(len(brake.shoes))]
    return {key: size * slope for part in slopes for key, slope in part.items()}


def along_hinge(brake: Brake, index: int, key: str) -> dict[str, float]:
    """How the point `key` of shoe `index` moves along the radius of its hinge: what 1 m adds to its
    coordinates.
    """
    hinge = brake.shoes[index].pin
    return {
        f"shoe[{index}].{key}.x": hinge.x / hinge.radius,
        f"shoe[{index}].{key}.y": hinge.y / hinge.radius,
    }
