"""The gap between an unloaded lining and the surface, from clearance and all kinds of misfit.

A misfit is a lining ground to a circle of its own, a taper, steps between blocks of the lining, or
a drum that is out of round. Each misfit is a gap along the drum's radius, or along the normal of
the plane, and positive if open. It is added to the lining's `clearance`. It therefore acts in every
model that has a clearance (finite elements, foundation), and the condensed stiffness of the shoes
does not depend on it. The closed-form laws assume that lining and surface fit each other. A misfit
across the width (coning, bell-mouthing) is neglected in plane stress.

The slope of a misfit is neglected: pressure acts along the normals of the drum's circle. For
harmonics of order n and amplitude a this changes the torque by a fraction of at most n a/(mu R).
"""

from collections.abc import Callable, Sequence
from typing import TypeVar

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.components import Lining, indices_of_linings_at_coordinates
from drumlin.brake.file import vary

LARGEST_ROUND_OFF_CHANGE_OF_GAP_SLOPE = 1e-9
"""Largest change of the gap's slope, at a row of a clearance table, that counts as round-off.

It is relative to the largest change of slope in the table. A larger change is a kink of the gap.
"""
# The type of the result of a function that solves a brake.
T = TypeVar("T")


def gaps_between_unloaded_lining_and_surface(brake: Brake, shoe: Shoe, theta: Floats) -> Floats:
    """Gap [m] between a shoe's unloaded lining and the surface, with all misfits of both.

    `theta` are coordinates along the surface (angles on a drum); the result has their shape.
    """
    linings = shoe.lining.linings
    if len(linings) > 1:
        # Each of several linings on a shoe has a clearance and a misfit of its own.
        alone = [shoe.model_copy(update={"lining": part}) for part in linings]
        gaps = [gaps_between_unloaded_lining_and_surface(brake, part, theta) for part in alone]
        return np.choose(indices_of_linings_at_coordinates(shoe.lining, theta), gaps)
    (lining,) = linings
    misfit = lining.misfit
    total = lining.clearances_at_surface_coordinates(theta)
    # Each part of the misfit is computed only if it is not zero.
    if misfit.radius is not None or misfit.offset.radius > 0:
        total = total + shoe.gaps_due_to_ground_lining_radius_and_offset(theta, brake.size)
    # The taper is the difference of the gaps at the two ends of the lining, linear in between.
    if misfit.taper:
        from_middle = shoe.frame.sense * (theta - lining.middle)
        total = total + misfit.taper * from_middle / (lining.end - lining.start)
    if misfit.blocks:
        total = total + gaps_due_to_block_heights(lining, theta)
    # Where the drum lies outside its circle, an internal lining has a larger gap, and an external
    # lining a smaller gap.
    off = brake.radial_deviation_of_drum_surface(theta)
    return total if off is None else total + shoe.sign_internal_plus_external_minus * off


def gaps_due_to_block_heights(lining: Lining, theta: Floats) -> Floats:
    """Gap [m] due to the different heights of a lining's blocks, at coordinates theta, same shape.

    The face of each block lies back by the depth of the block, and the gap changes smoothly over
    the length `lining.step` from one block to the next. On a drum of radius R, a difference h of
    the depths gives the smallest radius of curvature (R step)^2/(6 h).
    """
    gap, before = np.zeros(np.shape(theta)), 0.0
    for begin, depth in lining.misfit.blocks:
        # A cubic polynomial rises from 0 to 1 from one block to the next, with zero slope at both
        # ends.
        x = np.clip((theta - begin) / lining.length_of_step_between_blocks + 0.5, 0.0, 1.0)
        gap = gap + (depth - before) * x**2 * (3 - 2 * x)
        before = depth
    return gap


def coordinates_of_gap_kinks(lining: Lining) -> list[float]:
    """Coordinates along the surface (angles on a drum) at which a lining's gap is not smooth.

    It is not smooth at the rows of a clearance table, and where the rounded steps between blocks
    begin and end.
    """
    return [
        *coordinates_of_clearance_table_rows(lining),
        *coordinates_of_step_ends_between_blocks(lining),
    ]


def coordinates_of_clearance_table_rows(lining: Lining) -> list[float]:
    """Coordinates (angles on a drum) of the rows of a lining's table of clearances.

    The clearance is linear between the rows. The list is empty if the clearance is a number. For
    several linings on a shoe it has the rows of one lining after the other, without rows beyond
    the ends of their own lining.
    """
    return [angle for angle, _ in _clearance_table_rows_and_slope_changes(lining)]


def coordinates_of_step_ends_between_blocks(lining: Lining) -> list[float]:
    """Coordinates (angles on a drum) where the rounded steps between blocks begin and end."""
    half = lining.length_of_step_between_blocks / 2
    blocks = [block for part in lining.linings for block in part.misfit.blocks]
    return [begin + side for begin, _ in blocks for side in (-half, half)]


def gap_kinks_that_point_to_drum(lining: Lining) -> list[tuple[float, float]]:
    """Kinks of a lining's gap that point to the drum; an elastic pressure is infinite at them.

    Each kink is a pair: its coordinate (an angle on a drum) and the change of the gap's slope
    there, in metres per unit of the coordinate.
    """
    change = clearance_slope_change_at_each_table_row(lining)
    # Where the slope of the gap grows abruptly, the lining has a convex edge towards the drum.
    sharp = change > LARGEST_ROUND_OFF_CHANGE_OF_GAP_SLOPE * np.abs(change).max(initial=0.0)
    rows = zip(coordinates_of_clearance_table_rows(lining), change.tolist(), sharp, strict=True)
    return [(angle, slope) for angle, slope, is_sharp in rows if is_sharp]


def clearance_slope_change_at_each_table_row(lining: Lining) -> Floats:
    """Change of the clearance's slope at each row of a lining's clearance table, (n,).

    It is in metres per unit of the surface's coordinate (rad on a drum). The clearance is constant
    beyond the table. The array is empty if the clearance is a number.
    """
    return np.array([change for _, change in _clearance_table_rows_and_slope_changes(lining)])


def _clearance_table_rows_and_slope_changes(lining: Lining) -> list[tuple[float, float]]:
    """For each row of a lining's clearance table its coordinate and the change of slope there.

    See `coordinates_of_clearance_table_rows` and `clearance_slope_change_at_each_table_row`.
    """
    found: list[tuple[float, float]] = []
    for part in lining.linings_with_touching_ones_joined:
        if not isinstance(part.clearance, tuple):
            continue
        angle, gap = np.array(part.clearance).T
        # The clearance is constant, with the slope 0, before the first row and after the last one.
        slope = np.concatenate([[0.0], np.diff(gap) / np.diff(angle), [0.0]])
        rows = zip(angle.tolist(), np.diff(slope).tolist(), strict=True)
        # If the shoe has several linings, rows beyond the ends of their own lining do not count.
        alone = len(lining.linings_with_touching_ones_joined) == 1
        found += [row for row in rows if alone or part.start < row[0] < part.end]
    return found


def solve_brake_at_angular_drum_positions(
    brake: Brake, solve: Callable[[Brake], T], angles: Sequence[float]
) -> list[T]:
    """Solve a brake for several angular positions of a drum that is out of round.

    Inertia is neglected, and the forces on the shoes are the same at each position.

    Parameters
    ----------
    brake : the brake
    solve : function that solves a brake; its exceptions are not caught
    angles : angular positions of the drum [rad]

    Returns
    -------
    list
        the result of `solve` at each angle
    """
    return [solve(vary(brake, {"drum.angle": angle})) for angle in angles]


def lining_radii_by_key_for_radius_mismatch(brake: Brake, mismatch: float) -> dict[str, float]:
    """New lining radii, for `vary`: every lining is ground to the drum's radius plus `mismatch`.

    The result has the new radius [m] by the key in the brake file, such as
    "shoe[0].lining.misfit.radius". `mismatch` is in m.
    """
    return {
        f"shoe[{i}].lining.misfit.radius": brake.size + mismatch for i in range(len(brake.shoes))
    }


def lining_circle_offsets_towards_hinge_by_key(brake: Brake, size: float) -> dict[str, float]:
    """New offsets of the lining circles, for `vary`: each is moved by `size` [m] towards the hinge.

    The circle to which the lining is ground moves along the line from the drum's centre to the
    shoe's hinge. The result has x and y of the offset [m] by their keys in the brake file.
    """
    slopes = [
        point_coordinate_changes_per_metre_along_hinge_radius(brake, i, "lining.misfit.offset")
        for i in range(len(brake.shoes))
    ]
    return {key: size * slope for part in slopes for key, slope in part.items()}


def point_coordinate_changes_per_metre_along_hinge_radius(
    brake: Brake, index: int, key: str
) -> dict[str, float]:
    """Changes of x and y of a point that moves by 1 m along the line from drum centre to hinge.

    The result has them by their keys in the brake file. The point is a datum of the shoe with this
    index, under the key `key`, such as "lining.misfit.offset". The hinge is the same shoe's hinge.
    """
    hinge = brake.shoes[index].pin
    # The two values are the components of the unit vector from the drum's centre to the hinge.
    return {
        f"shoe[{index}].{key}.x": hinge.x / hinge.radius,
        f"shoe[{index}].{key}.y": hinge.y / hinge.radius,
    }
