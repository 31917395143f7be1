"""The pulls of springs with a rate, which depend on the motion that they themselves cause.

A spring of the rate k pulls by T = T_0 - k d. Here d is the motion by which its two points come
nearer to each other: the rigid-body motions of the shoes, and the elastic motion of the places
where the loads act. As long as the same nodes are in contact, d is a linear function of all pulls,
so that Broyden's method ends after a few contact solves on the same condensed bodies.
"""

from collections.abc import Callable
from typing import TypeVar

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.further_loads import brake_with_loads_assigned_to_shoes
from drumlin.fem.preparation.bodies import ShoeSubstructure, load_column_factors_of_force_at_point

SETTLED_PULL = 1e-12
"""Largest error of a spring's pull, relative to the largest force, at which the iteration ends.

It is far below the relative error of 1e-9 that is allowed in the balance of forces, and above the
round-off error of a motion times the spring rate. A spring that is stiffer than the brake has a
larger round-off and is refused. The value is a judgement.
"""
MOST_SPRING_STEPS = 40
"""Contact solves after which the iteration for the spring pulls fails. Usual brakes take four."""

Answer = TypeVar("Answer")


def find_spring_pulls_that_fit_shoe_motions(
    brake: Brake, solve: Callable[[Brake], tuple[Answer, Floats]]
) -> tuple[Answer, tuple[float, ...]]:
    """Find the pulls of all springs that agree with the motions of the springs' points.

    Parameters
    ----------
    brake : the brake
    solve : function of a brake with known pulls, which returns the answer and the motion (springs,)
        [m] by which the two points of each spring come nearer to each other

    Returns
    -------
    the answer of `solve` under these pulls, and the pull of each spring [N]

    Raises
    ------
    NoAnswer
        as `solve` does, and if no pulls agree with the motions, or a spring would go slack
    """
    preloads = np.array([spring.preload for spring in brake.springs])
    rates = np.array([spring.rate for spring in brake.springs])
    largest = max(*np.abs(preloads), *(shoe.largest_force_of_any_load for shoe in brake.shoes))
    pulls, inverse = preloads.copy(), -np.eye(len(preloads))
    step = excess = np.zeros(len(preloads))
    for count in range(MOST_SPRING_STEPS):
        answer, approach = solve(brake_with_loads_assigned_to_shoes(brake, pulls.tolist()))
        before, excess = excess, preloads - rates * approach - pulls
        if np.abs(excess).max() <= SETTLED_PULL * largest:
            _check_springs_are_not_slack(preloads, pulls)
            return answer, tuple(pulls.tolist())
        if count > 0:
            # Broyden's method updates the inverse Jacobian matrix, here by the Sherman-Morrison
            # formula.
            moved = inverse @ (excess - before)
            inverse += np.outer(step - moved, step @ inverse) / float(step @ moved)
        step = -inverse @ excess
        pulls = pulls + step
    i = int(np.abs(excess).argmax())
    raise NoAnswer(
        f"spring[{i}]: no pull agrees with the motion of its points; "
        "the spring may hold its shoe off before the lining touches"
    )


def _check_springs_are_not_slack(preloads: Floats, pulls: Floats) -> None:
    """Raise NoAnswer for a spring whose pull and preload have opposite signs."""
    for i, (preload, pull) in enumerate(zip(preloads.tolist(), pulls.tolist(), strict=True)):
        if pull * preload < 0:
            verb = ("pushes", "pull") if preload < 0 else ("pulls", "push")
            raise NoAnswer(
                f"spring[{i}]: goes slack: it {verb[0]} by its preload and would have to {verb[1]}"
            )


def displacements_of_spring_points_along_pulls(
    brake: Brake, shoe: Shoe, body: ShoeSubstructure, elastic: Floats, pin_motion: Floats
) -> Floats:
    """The displacement (springs,) [m] of each spring's point on a shoe along the spring's pull.

    Parameters
    ----------
    brake : the brake with its springs
    shoe : the shoe
    body : its substructure
    elastic : (l,) displacements of the loaded points by the strain of the body, one for each load
        column [m, rad]
    pin_motion : (3,) displacement x, y [m] of the pin and turn [rad], in the frame of the shoe
    """
    found = np.zeros(len(brake.springs))
    # Among the loads of the body, the springs' forces follow the forces in `shoe.forces`, in the
    # order of the springs.
    index = len(shoe.forces)
    for j, spring in enumerate(brake.springs):
        pull = spring.spring_or_lever_force_on_shoe(shoe.name, 1.0)
        if pull is None:
            continue
        at_own_place = load_column_factors_of_force_at_point(body, shoe, index, pull)
        index += 1
        fx, fy, moment = pull.resultant.tolist()
        about_pin = shoe.frame.sense * (moment - (shoe.pin.x * fy - shoe.pin.y * fx))
        at_pin = np.array(
            [*shoe.frame.convert_vectors_to_shoe_frame(pull.resultant[:2]), about_pin]
        )
        found[j] = at_own_place @ elastic + at_pin @ pin_motion
    return found


def notes_on_spring_pulls(brake: Brake, pulls: tuple[float, ...]) -> list[str]:
    """A note for each spring with a rate: its pull in the response and its preload."""
    return [
        f"spring[{i}]: its pull is {pull:.6g} N, its preload {spring.preload:.6g} N"
        for i, (spring, pull) in enumerate(zip(brake.springs, pulls, strict=False))
        if spring.rate > 0
    ]
