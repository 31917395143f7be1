"""Treat misfits as clearance: lining circle, taper, steps between blocks, a drum out of round.

Every misfit is a gap along the drum's radius, or along the normal of the plane, positive = open. It
adds to the lining's `clearance`. It therefore acts in each model that has a clearance (finite
elements, foundation) and leaves their condensed bodies as they are. The laws assume a lining that
fits. Plane stress knows no misfit across the width (coning, bell-mouthing).

The slope of the surfaces is neglected: normals stay those of the drum's circle. For lobes of order
n and amplitude a this neglects at most n a/(mu R) of the torque.
"""

from collections.abc import Callable, Sequence
from typing import TypeVar

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.components import Lining
from drumlin.brake.file import vary

ROUND = 1e-9
"""Change of slope in a clearance table, relative to the largest, up to which it is round-off.

A larger change that points to the drum is a tip of the gap.
"""
T = TypeVar("T")


def gap(brake: Brake, shoe: Shoe, theta: Floats) -> Floats:
    """Gap [m] of a shoe's unloaded lining from the surface, at the places theta, same shape."""
    lining, misfit = shoe.lining, shoe.lining.misfit
    total = lining.clearance_at(theta)
    # A part of the misfit that is zero costs no computation.
    if misfit.radius is not None or misfit.offset.radius > 0:
        total = total + shoe.misfit_gap(theta, brake.size)
    # The taper is the change of the gap from one end of the lining to the other.
    if misfit.taper:
        from_middle = shoe.frame.sense * (theta - lining.middle)
        total = total + misfit.taper * from_middle / (lining.end - lining.start)
    if misfit.blocks:
        total = total + block_gap(lining, theta)
    # A drum that stands back opens the gap of an internal lining and closes an external gap.
    off = brake.surface_off(theta)
    return total if off is None else total + shoe.sign * off


def block_gap(lining: Lining, theta: Floats) -> Floats:
    """Distance [m] by which the blocks of a lining stand back at theta, same shape.

    Blocks are level, with rounded steps of the arc `step` between them. A step of height h has the
    smallest radius (R step)^2/(6 h).
    """
    gap, before = np.zeros(np.shape(theta)), 0.0
    for begin, depth in lining.misfit.blocks:
        # A cubic rises over the step from 0 to 1, level at both ends.
        x = np.clip((theta - begin) / lining.step + 0.5, 0.0, 1.0)
        gap = gap + (depth - before) * x**2 * (3 - 2 * x)
        before = depth
    return gap


def kinks(lining: Lining) -> list[float]:
    """Angles [rad] at which a lining's gap is not smooth."""
    return [*table_kinks(lining), *step_kinks(lining)]


def table_kinks(lining: Lining) -> list[float]:
    """Angles [rad] of the rows of a lining's table of clearances.

    Between these the clearance is linear.
    """
    return [angle for angle, _ in lining.clearance] if isinstance(lining.clearance, tuple) else []


def step_kinks(lining: Lining) -> list[float]:
    """Angles [rad] at which the rounded steps between a lining's blocks begin and end."""
    half = lining.step / 2
    return [begin + side for begin, _ in lining.misfit.blocks for side in (-half, half)]


def tips(lining: Lining) -> list[tuple[float, float]]:
    """Kinks of a lining's gap that point to the drum, under which the pressure is unbounded.

    Each is an angle [rad] and the change of the gap's slope there [m/rad].
    """
    change = slope_changes(lining)
    # A gap whose slope grows has its smallest distance to the drum at the kink.
    sharp = change > ROUND * np.abs(change).max(initial=0.0)
    rows = zip(table_kinks(lining), change.tolist(), sharp, strict=True)
    return [(angle, slope) for angle, slope, is_sharp in rows if is_sharp]


def slope_changes(lining: Lining) -> Floats:
    """Change of the clearance's slope [m/rad] at each of `table_kinks`.

    Beyond the table the clearance is constant.
    """
    if not isinstance(lining.clearance, tuple):
        return np.zeros(0)
    angle, gap = np.array(lining.clearance).T
    # The zeros are the slopes before the first row and after the last one.
    return np.diff(np.concatenate([[0.0], np.diff(gap) / np.diff(angle), [0.0]]))


def thermal_growth(R: float, expansion: float, warming: float) -> float:
    """Growth [m] of a drum's radius, which is the amplitude of lobes of order 0.

    Parameters
    ----------
    R : radius of the drum [m]
    expansion : coefficient of thermal expansion [1/K]
    warming : mean warming [K]
    """
    return expansion * warming * R


def one_turn(brake: Brake, solve: Callable[[Brake], T], angles: Sequence[float]) -> list[T]:
    """Solve a brake as its drum stands at each of several angles, without inertia.

    Parameters
    ----------
    brake : the brake, whose forces stay
    solve : any model; its errors are raised
    angles : of the drum [rad]
    """
    return [solve(vary(brake, {"drum.angle": angle})) for angle in angles]


def ground_to(brake: Brake, mismatch: float) -> dict[str, float]:
    """Changes for `vary` that grind every lining to the drum's radius plus a mismatch [m]."""
    return {
        f"shoe[{i}].lining.misfit.radius": brake.size + mismatch for i in range(len(brake.shoes))
    }


def set_off(brake: Brake, size: float) -> dict[str, float]:
    """Changes for `vary` that move every lining's circle by `size` [m].

    The circle moves along the radius of its hinge, away from the drum's centre.
    """
    slopes = [along_hinge(brake, i, "lining.misfit.offset") for i in range(len(brake.shoes))]
    return {key: size * slope for part in slopes for key, slope in part.items()}


def along_hinge(brake: Brake, index: int, key: str) -> dict[str, float]:
    """Changes of the coordinates of a point `key` as it moves by 1 m along the hinge's radius.

    The point and the hinge are those of shoe `index`.
    """
    hinge = brake.shoes[index].pin
    # The two values are the components of the unit vector from the drum's centre to the hinge.
    return {
        f"shoe[{index}].{key}.x": hinge.x / hinge.radius,
        f"shoe[{index}].{key}.y": hinge.y / hinge.radius,
    }
