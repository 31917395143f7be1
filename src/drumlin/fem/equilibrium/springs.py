"""The pulls of springs with a rate, which depend on the motion that they themselves cause.

A spring of the rate k pulls by T = T_0 - k d. Here d is the motion by which its two points come
nearer to each other: the rigid-body motions of the shoes, and the elastic motion of the places
where the loads act. As long as the same nodes are in contact, d is a linear function of all pulls,
so that Broyden's method ends after a few contact solves on the same condensed bodies.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple, TypeVar

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import AnswerBeyondModel, NoAnswer
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.further_loads import ForceAtPoint, brake_with_loads_assigned_to_shoes
from drumlin.fem.preparation.bodies import ShoeSubstructure, unit_load_factors_of_force_at_point

RELATIVE_TOLERANCE_OF_SPRING_PULLS = 1e-12
"""Largest error of a spring's pull, relative to the largest force, at which the iteration ends.

The tolerance is far below the relative error of 1e-9 that is allowed in the balance of forces, and
above the round-off error of a motion times the spring rate. For a spring that is stiffer than the
brake, this error is larger, and the tolerance holds for the step of Newton's method. The value is a
judgement.
"""
RELATIVE_PULL_CHANGE_FOR_BRAKE_COMPLIANCE = 1e-6
"""Change of a spring's pull by which the compliance of the brake at the spring is measured.

It is relative to the largest force. The compliance is exact as long as the change leaves the nodes
in contact as they are. The value affects the number of contact solves, not the result.
"""
MAX_HALVINGS_OF_SPRING_PULL_STEP = 12
"""Largest number of halvings of a step of the pulls that ends where the brake has no answer."""
MAX_CONTACT_SOLVES_FOR_SPRING_PULLS = 40
"""Contact solves after which the iteration for the spring pulls fails. Usual brakes take four."""

SolverAnswerTypeVariable = TypeVar("SolverAnswerTypeVariable")


@dataclass(frozen=True)
class SpringMatrices:
    """The effects of the m springs of a brake on a group of s shoes, with n nodes and k modes.

    The approach of a spring is the motion by which its two points come nearer to each other. Pulls,
    pressures and motions are per newton of the group's actuation force. A spring that holds no shoe
    of the group has zeros.

    Attributes
    ----------
    load_column_factors : for each spring and shoe, the factors (l,) by which the load columns of
        the shoe's body make up a pull of 1 N
    resultants : (m, s, 3) force x, force y [N] and moment about the origin [N m] on each shoe of a
        pull of 1 N
    gap_by_pull : opening (n, m) of the weighted gaps (integrals of the gap times each node's shape
        function) per pull
    work : work (k, m) of the pulls on the test modes
    approach_by_pressure : approach (m, n) per nodal pressure
    approach_by_motion : approach (m, k) per coordinate of a rigid-body mode
    approach_by_force : approach (m, s) per actuation force
    approach_by_pull : approach (m, m) per pull
    foot_force_by_pull : force (s, m) along the strut that the foot of each shoe transmits
    tip_travel_by_pull : elastic travel (s, m) of each shoe's point of actuation along its force
    """

    load_column_factors: tuple[tuple[Floats, ...], ...]
    resultants: Floats
    gap_by_pull: Floats
    work: Floats
    approach_by_pressure: Floats
    approach_by_motion: Floats
    approach_by_force: Floats
    approach_by_pull: Floats
    foot_force_by_pull: Floats
    tip_travel_by_pull: Floats

    @classmethod
    def zeros(
        cls, load_columns: Sequence[int], *, springs: int, nodes: int, modes: int
    ) -> "SpringMatrices":
        """The matrices of springs without any effect.

        Parameters
        ----------
        load_columns : number of load columns of each shoe's body
        springs, nodes, modes : numbers of springs, of contact nodes and of rigid-body modes
        """
        m, shoes = springs, len(load_columns)
        return cls(
            load_column_factors=tuple(tuple(map(np.zeros, load_columns)) for _ in range(m)),
            resultants=np.zeros((m, shoes, 3)),
            gap_by_pull=np.zeros((nodes, m)),
            work=np.zeros((modes, m)),
            approach_by_pressure=np.zeros((m, nodes)),
            approach_by_motion=np.zeros((m, modes)),
            approach_by_force=np.zeros((m, shoes)),
            approach_by_pull=np.zeros((m, m)),
            foot_force_by_pull=np.zeros((shoes, m)),
            tip_travel_by_pull=np.zeros((shoes, m)),
        )


def unit_pulls_on_shoe(brake: Brake, shoe: Shoe) -> list[tuple[int, int, ForceAtPoint]]:
    """For each spring on a shoe: its index, the place of its force, and its force at a pull of 1 N.

    The place is the index of the spring's force among the shoe's loads besides the actuation.
    """
    found = []
    # Among the loads of the body, the springs' forces follow the forces in `shoe.forces`, in the
    # order of the springs.
    place = len(shoe.forces)
    for j, spring in enumerate(brake.springs):
        pull = spring.spring_or_lever_force_on_shoe(shoe.name, 1.0)
        if pull is not None:
            found.append((j, place, pull))
            place += 1
    return found


def work_of_force_on_test_modes(shoe: Shoe, sense: int, force: ForceAtPoint) -> Floats:
    """The work (k,) of a force on the test modes of a shoe, in the sense of the shoe's frame.

    `sense` is the direction of friction at the shoe's abutment.
    """
    free = shoe.rigid_body_modes_of_support(sense)
    return _signs_of_modes_in_shoe_frame(shoe, free.names) * (free.test_modes @ force.resultant)


def displacement_of_point_along_force_in_modes(
    shoe: Shoe, sense: int, force: ForceAtPoint
) -> Floats:
    """The displacement (k,) of a force's point along the force, in each unit mode of a shoe.

    `sense` is the direction of friction at the shoe's abutment.
    """
    free = shoe.rigid_body_modes_of_support(sense)
    return _signs_of_modes_in_shoe_frame(shoe, free.names) * (free.motions @ force.resultant)


def _signs_of_modes_in_shoe_frame(shoe: Shoe, names: tuple[str, ...]) -> Floats:
    """The sign (k,) of each mode in the shoe's frame; a mirrored frame reverses turns."""
    return np.where(np.array(names) == "turn", float(shoe.frame.sense), 1.0)


def find_spring_pulls_that_fit_shoe_motions(
    brake: Brake, solve: Callable[[Brake], tuple[SolverAnswerTypeVariable, Floats]]
) -> tuple[SolverAnswerTypeVariable, tuple[float, ...]]:
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
    try:
        return _find_spring_pulls_by_broyden(brake, solve)
    except AnswerBeyondModel:
        raise
    except NoAnswer:
        # A spring is stiffer than the brake. Its pull by the motion under the preload is then far
        # too large, and may lift a shoe off.
        return _find_spring_pulls_from_measured_compliance(brake, solve)


class _PreloadsAndRatesOfSprings(NamedTuple):
    """Preload (m,) [N] and rate (m,) [N/m] of each spring, and the largest force [N] on a brake."""

    preloads: Floats
    rates: Floats
    largest_force: float

    @classmethod
    def of_brake(cls, brake: Brake) -> "_PreloadsAndRatesOfSprings":
        """The preloads and rates of the springs of a brake."""
        preloads = np.array([spring.preload for spring in brake.springs])
        forces = [shoe.largest_force_of_any_load for shoe in brake.shoes]
        rates = np.array([spring.rate for spring in brake.springs])
        return cls(preloads, rates, max(*np.abs(preloads), *forces))


def _find_spring_pulls_by_broyden(
    brake: Brake, solve: Callable[[Brake], tuple[SolverAnswerTypeVariable, Floats]]
) -> tuple[SolverAnswerTypeVariable, tuple[float, ...]]:
    """The result of `find_spring_pulls_that_fit_shoe_motions`, for springs softer than the brake.

    The first pulls are the preloads. Raises NoAnswer as that function does.
    """
    preloads, rates, largest = _PreloadsAndRatesOfSprings.of_brake(brake)
    pulls, inverse = preloads.copy(), -np.eye(len(preloads))
    step = excess = np.zeros(len(preloads))
    for count in range(MAX_CONTACT_SOLVES_FOR_SPRING_PULLS):
        answer, approach = solve(brake_with_loads_assigned_to_shoes(brake, pulls.tolist()))
        before, excess = excess, preloads - rates * approach - pulls
        if np.abs(excess).max() <= RELATIVE_TOLERANCE_OF_SPRING_PULLS * largest:
            _check_springs_are_not_slack(preloads, pulls)
            return answer, tuple(pulls.tolist())
        if count > 0:
            # Broyden's method updates the inverse Jacobian matrix, here by the Sherman-Morrison
            # formula.
            moved = inverse @ (excess - before)
            inverse += np.outer(step - moved, step @ inverse) / float(step @ moved)
        step = -inverse @ excess
        pulls = pulls + step
    raise _error_that_no_spring_pull_agrees(excess)


def _find_spring_pulls_from_measured_compliance(
    brake: Brake, solve: Callable[[Brake], tuple[SolverAnswerTypeVariable, Floats]]
) -> tuple[SolverAnswerTypeVariable, tuple[float, ...]]:
    """The result of `find_spring_pulls_that_fit_shoe_motions`, for springs of any rate.

    Newton's method uses the compliance of the brake at its springs, which is measured at each step
    by small changes of the pulls. Raises NoAnswer as that function does.
    """
    preloads, rates, largest = _PreloadsAndRatesOfSprings.of_brake(brake)
    small = RELATIVE_PULL_CHANGE_FOR_BRAKE_COMPLIANCE * largest

    def solve_under_pulls(under: Floats) -> tuple[SolverAnswerTypeVariable, Floats]:
        """The answer under pulls (m,) [N] of all springs, and the approach (m,) [m] of each."""
        return solve(brake_with_loads_assigned_to_shoes(brake, under.tolist()))

    pulls = preloads.copy()
    answer, approach = solve_under_pulls(pulls)
    for _ in range(MAX_CONTACT_SOLVES_FOR_SPRING_PULLS):
        excess = preloads - rates * approach - pulls
        slopes = np.zeros((len(pulls), len(pulls)))
        for j in np.flatnonzero(rates):
            changed = pulls.copy()
            changed[j] += small
            slopes[:, j] = (solve_under_pulls(changed)[1] - approach) / small
        step = np.linalg.solve(np.eye(len(pulls)) + rates[:, None] * slopes, excess)
        if np.abs(step).max() <= RELATIVE_TOLERANCE_OF_SPRING_PULLS * largest:
            _check_springs_are_not_slack(preloads, pulls)
            return answer, tuple(pulls.tolist())
        for halvings in range(MAX_HALVINGS_OF_SPRING_PULL_STEP + 1):
            try:
                answer, approach = solve_under_pulls(pulls + step)
                break
            except NoAnswer:
                if halvings == MAX_HALVINGS_OF_SPRING_PULL_STEP:
                    raise
                step = step / 2
        pulls = pulls + step
    raise _error_that_no_spring_pull_agrees(excess)


def _error_that_no_spring_pull_agrees(excess: Floats) -> NoAnswer:
    """The error that the pulls do not agree with the motions, by `excess` (m,) [N] of each pull."""
    i = int(np.abs(excess).argmax())
    return NoAnswer(
        f"spring[{i}]: no pull agrees with the motion of its points; "
        "the spring may hold its shoe off before the lining touches"
    )


def _check_springs_are_not_slack(preloads: Floats, pulls: Floats) -> None:
    """Raise NoAnswer for a spring whose pull and preload have opposite signs."""
    for i, (preload, pull) in enumerate(zip(preloads.tolist(), pulls.tolist(), strict=True)):
        if pull * preload < 0:
            verb = ("pushes", "pull") if preload < 0 else ("pulls", "push")
            raise AnswerBeyondModel(
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
    body : the substructure of the shoe
    elastic : (l,) displacements of the loaded points by the strain of the body, one for each load
        column [m, rad]
    pin_motion : (3,) displacement x, y [m] of the pin and turn [rad], in the frame of the shoe
    """
    found = np.zeros(len(brake.springs))
    for j, place, pull in unit_pulls_on_shoe(brake, shoe):
        at_own_place = unit_load_factors_of_force_at_point(body, shoe, place, pull)
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
