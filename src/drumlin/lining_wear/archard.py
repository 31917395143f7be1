"""Archard wear of linings over a sliding distance, as a sequence of contact problems.

Every point of a lining slides on the drum and loses depth where it is pressed. The contact problem
of the lining has the unknowns x, from which the pressure p = D x follows, and the rigid-body
motions y of the shoe. The vector w is the gap between lining and drum at each node, weighted: on
finite elements it holds the integrals of the gap times the shape function of each node. The
foundation model has the gap itself at each sector. The unknowns open the weighted gap by A x + B y.
The weighted gap of the unloaded lining is q, and C x = h_load are the equilibria of the shoe. The
worn depth h opens the weighted gap by G h, and s is the sliding distance:

    w = q + A x + B y + G h,   p = D x >= 0,  w >= 0,  p w = 0,   C x = h_load,      dh/ds = rate(p)

For the exponent 1 of the wear law the rate is k p. The equations are stiff: ripples of the pressure
from element to element settle some thousand times faster than the bending of the shoe. In an
implicit step of the length ds the wear depth depends on the unknown pressure. The wear therefore
acts as an additional compliance gamma ds G k D of the lining. A step has two stages, and each stage
is one contact problem. The method is the diagonally implicit Runge-Kutta method of order 2
with gamma = 1 - 1/sqrt(2), which is L-stable and stiffly accurate (Alexander 1977, SIAM J. Numer.
Anal. 14, 1006). It is stable for any length of step, and the pressure does not alternate from node
to node. The difference from a first-order method with the same stages measures the error. All
stages fulfil p w = 0 exactly. Both weights of the method are positive, so that h never shrinks, and
does not grow where p is zero.

The foot of a shoe may rest on a rough abutment. The friction there either opposes the slide of the
foot in one of two directions, or holds the foot. Each of these three cases has a contact problem of
its own, which is called an `AbutmentFrictionCase`. A stage of a step first tries the case of the
stage before. If the solution contradicts this case, the stage tries the other cases.

After a long sliding distance wear becomes steady: the pressure no longer changes. Every point of
the lining then wears as fast as the rigid-body motions y' of the shoe bring it nearer to the drum.
With dp/ds = 0 the equations above, differentiated by s, are

    w' = B y' + G rate(p),   p >= 0,  w' >= 0,  p w' = 0,   C x = h_load

They contain neither the stiffness of the brake nor the gap q. With p as the unknown, they have the
form of the equations of a rigid shoe on a bed of springs. Their solution, by `solve_steady_wear`,
is the end of wear on the given mesh. As the mesh is refined this solution converges to the
rigid-shoe law.

If the friction coefficient mu(p) depends on the pressure, A and C depend on p. Newton's method then
replaces the friction stress mu(p) p by its tangent, as in `drumlin.contact.pressure_friction`, in
each stage together with the wear rate. The pull of a spring whose points move with the shoes is an
additional unknown in x. This unknown does not wear, so that its row and its column of G are zero.

The module knows nothing of brakes. The module `linings` makes contact problems from a brake.
"""

import math
from bisect import bisect_left
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import nullcontext, suppress
from dataclasses import dataclass, replace
from functools import partial
from itertools import product
from operator import attrgetter
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import (
    Bools,
    Floats,
    slices_from_lengths_of_consecutive_parts,
    text_of_fields_with_arrays_by_shape,
)
from drumlin.base.errors import BadInput, NoAnswer
from drumlin.base.lapack import block_diag
from drumlin.contact import active_set
from drumlin.contact.active_set import ContactSolution
from drumlin.contact.equations import ContactProblem
from drumlin.contact.pressure_friction import (
    FunctionOfNodalFrictionByPressures,
    contact_problem_with_friction_tangent,
    is_newton_change_negligible,
    largest_change_relative_to_peak,
)
from drumlin.contact.self_locking import FrictionDependentProblem

RUNGE_KUTTA_COEFFICIENT_OF_WEAR_STAGES = 1 - 1 / math.sqrt(2)
"""Coefficient gamma of the two implicit stages of a wear step, a Runge-Kutta method.

This value makes the method L-stable (Alexander 1977)."""

DEFAULT_PRESSURE_ERROR_OF_WEAR_STEP = 1e-3
"""Largest error of the pressure in a step of wear if the user gives no tolerance.

It is the L2 norm of the error divided by the L2 norm of the pressure. A step with a larger error is
repeated over a shorter distance. A judgement."""

MAX_WEAR_STEPS = 20_000
"""Largest number of steps of a wear run. A run that needs more is refused.

The example brakes take some 40 steps."""

LARGEST_GROWTH_RATIO_OF_WEAR_STEP = 4.0
"""Largest ratio of the length of a wear step to the length of the step before.

A larger ratio risks a step with too large an error, which has to be repeated."""

MEAN_PRESSURE_FRACTION_OF_SMOOTHED_WEAR_RATE = 1e-3
"""Pressure below which a wear rate p^m with m < 1 is smoothed, relative to the mean pressure.

Without the smoothing the slope of the rate is infinite at p = 0, and Newton's method does not
converge there. A judgement."""

MOST_NEWTON_STEPS_OF_WEAR_STAGE = 60
"""Largest number of Newton steps in a stage of a wear step; beyond it the run is refused.

A judgement."""

SHORTEST_RELATIVE_WEAR_STEP = 1e-13
"""Smallest length of a wear step, relative to the sliding distance so far.

A run that needs a shorter step is refused: such a step would change the distance by little more
than round-off."""

STEADY_WEAR_MOTION_OVER_ELASTIC_MOTION = 1e9
"""Assumed ratio of a shoe's motion by steady wear to its elastic motion under load.

The sum of the two motions tells in which direction the shoe's foot slides on an abutment, and so
which way friction acts there. Wear that goes on for ever makes the ratio infinite. At 1e9 the
elastic motion influences the direction as little as round-off does."""

RELATIVE_COMPLIANCE_FIRST_ADDED_TO_LININGS = 1e3
"""Compliance added to the linings at the start of the search for the nodes in contact.

It is relative to the largest nodal compliance of the brake. With soft linings the contact is easy
to find. The search then follows the contact as the linings become stiffer. A larger value only
costs time."""

ADDED_COMPLIANCE_REDUCTION_FACTOR = 4.0
"""Factor by which the compliance added to soft linings falls from one problem to the next.

The search for the nodes in contact solves a sequence of contact problems, from soft linings to the
real linings. A smaller factor needs more problems for the same range, which only costs time."""

NUMBER_OF_SOFT_LINING_PROBLEMS = 20
"""Number of contact problems with soft linings that are solved before the real linings.

The last problem adds 4e-9 of the brake's largest nodal compliance to the linings. When this rest is
removed, hardly a node changes between contact and gap."""


def accept_any_contact_solution(_: ContactSolution) -> bool:
    """Always true: without friction at abutments no solution contradicts the assumed friction."""
    return True


class AbutmentFrictionCase(NamedTuple):
    """One case of friction at abutments: each shoe's foot slides one way or the other, or sticks.

    Attributes
    ----------
    problem : contact problem of the unworn linings under this friction
    is_consistent_with_solution : function that tells whether a solution of `problem` agrees with
        the case: the friction must oppose the slide of each foot, or be large enough to hold the
        foot
    over_friction : the same contact problem as a linear function of the friction coefficients, if
        friction depends on the pressure; otherwise None
    """

    problem: ContactProblem
    is_consistent_with_solution: Callable[[ContactSolution], bool] = accept_any_contact_solution
    over_friction: FrictionDependentProblem | None = None


class WearContactProblem(NamedTuple):
    """The contact problem of the linings of a group of coupled shoes, prepared for wear.

    The problem has n contact unknowns x, which are nodal pressures or nodal forces.

    Attributes
    ----------
    problem : contact problem of the unworn linings
    loaded : (n,), part of the vector q of `problem`: the weighted gap that the actuation opens
    weight : G (n, n), weighted gap per worn depth
    pressure : (n,), pressure [Pa] per unit of each contact unknown, the diagonal of the matrix D
    area : (n,) [m^2], worn volume per worn depth at each unknown; also normal force per pressure
    torque : (n,) [m^3], torque per pressure at each unknown; per friction stress if friction
        depends on the pressure
    is_consistent_with_solution : function that tells whether a solution of `problem` agrees with
        the friction that the problem assumes at the abutments
    others : the other cases of the friction at the abutments, each with its contact problem
    settle : function settle(depth) that solves the contact of linings worn by a depth (n,) [m]
        without a first guess. It returns the position of the friction case in
        `abutment_friction_cases`, and a mask (n,) of the unknowns in contact. It raises NoAnswer if
        these linings have no equilibrium.
    over_friction : as in `AbutmentFrictionCase`, for the first case
    friction : function that returns the friction at pressures (n,) [Pa]; None if friction does not
        depend on the pressure
    """

    problem: ContactProblem
    loaded: Floats
    weight: Floats
    pressure: Floats
    area: Floats
    torque: Floats
    is_consistent_with_solution: Callable[[ContactSolution], bool] = accept_any_contact_solution
    others: tuple[AbutmentFrictionCase, ...] = ()
    settle: Callable[[Floats], tuple[int, Bools]] | None = None
    over_friction: FrictionDependentProblem | None = None
    friction: FunctionOfNodalFrictionByPressures | None = None

    @property
    def abutment_friction_cases(self) -> tuple[AbutmentFrictionCase, ...]:
        """All cases of friction at the abutments, each with its contact problem.

        The first case has the contact problem `problem`; `others` are the other cases.
        """
        return (
            AbutmentFrictionCase(
                self.problem, self.is_consistent_with_solution, self.over_friction
            ),
            *self.others,
        )

    def quantities_per_torque_arm(self, p: Floats) -> Floats:
        """The values (n,) [Pa] whose scalar product with `torque` is the torque, at pressures p.

        They are the pressures, or the friction stresses if friction depends on the pressure.
        """
        return p if self.friction is None else self.friction(p).coefficient * p

    def contact_problem_at_pressures(
        self, footing: AbutmentFrictionCase, p: Floats
    ) -> ContactProblem:
        """The contact problem of a friction case, with the tangent of the friction stress at p.

        If friction does not depend on the pressures p (n,), the result is the problem of the case
        itself.
        """
        if self.friction is None or footing.over_friction is None:
            return footing.problem
        return contact_problem_with_friction_tangent(footing.over_friction, self.friction(p), p)


class WearLaw(NamedTuple):
    """The wear law dh/ds = coefficient p (p/reference)^(exponent - 1).

    h is the worn depth, s the sliding distance and p the pressure.

    Attributes
    ----------
    coefficient : wear per sliding distance and pressure [1/Pa], at the pressure `reference`
    exponent : power of the pressure; 1 is Archard's law
    reference : pressure [Pa] to which the coefficient belongs; it has no effect with exponent 1
    """

    coefficient: float
    exponent: float = 1.0
    reference: float = 1e6

    def wear_rate_and_its_slope(self, p: Floats, rounded: float) -> tuple[Floats, Floats]:
        """The wear rates dh/ds (n,), and their derivatives by the pressure (n,) [1/Pa].

        Parameters
        ----------
        p : (n,) [Pa], pressures
        rounded : pressure [Pa] below which the rate is smoothed if the exponent is below 1
        """
        if self.exponent == 1:
            return self.coefficient * p, np.full(p.shape, self.coefficient)
        k, m = self.coefficient / self.reference ** (self.exponent - 1), self.exponent
        if m > 1:
            return k * p**m, k * m * p ** (m - 1)
        # For an exponent m below 1 the rate k p^m is replaced by k p (p^2 + rounded^2)^((m - 1)/2),
        # which has a finite slope at p = 0.
        size = p**2 + rounded**2
        rate = k * p * size ** ((m - 1) / 2)
        slope = k * size ** ((m - 3) / 2) * (m * p**2 + rounded**2)
        return rate, slope


@dataclass(frozen=True)
class WearState:
    """The state of all linings after a sliding distance.

    The arrays hold the n contact unknowns of all groups of linings, one group after the other;
    `WearRun.linings(state)` has them for each lining, with angles and the name of the shoe. The
    integrals over the sliding distance use the weights of the Runge-Kutta method.

    Attributes
    ----------
    s : sliding distance [m]
    depth : (n,) [m], worn depth
    pressure : (n,) [Pa]
    torque : torque of all linings [N m]
    force : factor on the actuation forces of the brake, without unit; 1 unless the run keeps a
        given torque. The printed table has the force of the first shoe [N]
    forward : whether the drum turns in the direction that the brake file states
    removed : worn volume [m^3], the integral of the wear rate over area and sliding distance
    pressed : integral [N m] of the normal force over the sliding distance
    work : integral [N m^2] of the torque over the sliding distance
    pulls : pull [N] of each spring of the brake; empty if no spring has a rate
    """

    s: float
    depth: Floats
    pressure: Floats
    torque: float
    force: float
    forward: bool
    removed: float
    pressed: float
    work: float
    pulls: tuple[float, ...] = ()

    def __repr__(self) -> str:
        """The fields, where an array is shown by its shape alone."""
        return text_of_fields_with_arrays_by_shape(self)


WearContactProblemsOfAllGroups = Sequence[WearContactProblem]
"""The contact problems of a brake's groups of linings, which do not influence each other."""


def wear_linings_over_sliding_distance(
    forward: WearContactProblemsOfAllGroups,
    law: WearLaw,
    *,
    backward: WearContactProblemsOfAllGroups = (),
    reverse: float = math.inf,
    torque: float | None = None,
    distance: float = math.inf,
    tolerance: float = DEFAULT_PRESSURE_ERROR_OF_WEAR_STEP,
    until: Callable[[WearState], bool] = lambda _: False,
) -> list[WearState]:
    """Wear linings over a sliding distance, or until a condition holds; returns all states.

    Parameters
    ----------
    forward : groups of linings; the groups do not influence each other
    law : the wear law
    backward : the same groups of linings with the drum turning the other way
    reverse : distance [m] between reversals of the drum. At a reversal the list has two states, one
        before and one after the reversal.
    torque : torque of all linings [N m] that the actuation is adjusted to keep; None for a constant
        actuation
    distance : sliding distance [m] at which the run ends
    tolerance : largest error of the pressure in a step (L2 norm, relative)
    until : function of a WearState that returns whether the run ends with this state

    Raises
    ------
    BadInput
        for an option out of range
    NoAnswer
        if there is no equilibrium, a shoe locks itself, or the steps do not converge
    """
    if reverse < math.inf and not backward:
        raise BadInput(f"reverse = {reverse:g}: needs the interfaces of the drum turning backward")
    held = 1.0 if torque is None else torque
    _require_options_above_zero({"distance": distance, "reverse": reverse, "torque": held})
    _require_valid_wear_options(law, tolerance, distance)
    wear_run = _WearRunInProgress(
        forward=_WearStepper(forward, law, torque),
        backward=_WearStepper(backward or forward, law, torque),
        reverse=reverse,
        distance=distance,
        tolerance=tolerance,
    )
    while not wear_run.has_reached_sliding_distance and not until(wear_run.last_wear_state):
        if len(wear_run.states) > MAX_WEAR_STEPS:
            raise NoAnswer(f"not converged: the wear is not settled after {MAX_WEAR_STEPS} steps")
        wear_run.try_wear_step_and_append_state()
    return wear_run.states


def _require_options_above_zero(values: Mapping[str, float]) -> None:
    """Raise BadInput if the value of an option is not above 0; `values` holds values by name."""
    for name, value in values.items():
        if not value > 0:
            raise BadInput(f"{name} = {value:g}: must be greater than 0")


def require_wear_law_in_range(law: WearLaw) -> None:
    """Raise BadInput for a wear law whose coefficient or exponent is out of range."""
    if not 0 <= law.coefficient < math.inf:
        raise BadInput(f"coefficient = {law.coefficient:g}: must not be negative, and finite")
    if not 0.3 <= law.exponent <= 4:
        raise BadInput(f"exponent = {law.exponent:g}: must be from 0.3 to 4")


def _require_valid_wear_options(law: WearLaw, tolerance: float, distance: float) -> None:
    """Raise BadInput for a wear law, a tolerance or a sliding distance out of range."""
    if not 0 < tolerance <= 0.1:
        raise BadInput(f"tolerance = {tolerance:g}: must be greater than 0 and at most 0.1")
    require_wear_law_in_range(law)
    if math.isinf(distance) and law.coefficient == 0:
        raise BadInput("coefficient = 0: nothing wears, so that a distance in m must be given")


class _WearRunInProgress:
    """A wear run in progress: its states so far, and the length of its next step.

    Parameters
    ----------
    forward, backward : solvers of a wear step for the two directions of rotation
    reverse : distance [m] between reversals of the drum
    distance : sliding distance [m] at which the run ends
    tolerance : largest error of the pressure in a step (L2 norm, relative)
    """

    def __init__(
        self,
        forward: "_WearStepper",
        backward: "_WearStepper",
        reverse: float,
        distance: float,
        tolerance: float,
    ) -> None:
        # The solvers of wear steps, by whether the drum turns forward.
        self._steppers = {True: forward, False: backward}
        self._reverse, self._distance, self._tolerance = reverse, distance, tolerance
        self._forward = True
        self._next_turn = reverse
        self.states = [forward.wear_state_of_unworn_linings()]
        self._step = forward.length_of_first_wear_step(self.last_wear_state, tolerance)
        # The pressure changes fast at the start and after a reversal. The first step after a
        # reversal therefore gets the length that suited the first step after the reversal before,
        # or after the start.
        self._opening_step = self._step
        self._just_turned = True

    @property
    def last_wear_state(self) -> WearState:
        """The last state of the wear run so far."""
        return self.states[-1]

    @property
    def has_reached_sliding_distance(self) -> bool:
        """Whether the wear run has reached its sliding distance, up to round-off."""
        return self.last_wear_state.s >= self._distance * (1 - 1e-12)

    def try_wear_step_and_append_state(self) -> None:
        """Try a step: append the state at its end or, if the error is too large, shorten the step.

        Raises NoAnswer if the step has no solution or becomes too short.
        """
        # A step ends at the latest where the run ends or the drum is reversed.
        end = min(self._distance, self._next_turn)
        left = end - self.last_wear_state.s
        size = self._length_of_next_wear_step(left)
        after, error = self._steppers[self._forward].wear_state_and_error_after_step(
            self.last_wear_state, size
        )
        # The error is the difference from a first-order method, and so grows with the square of the
        # step's length. The factor for the next length is therefore a square root.
        growth = 0.9 * math.sqrt(self._tolerance / max(error, 1e-30))
        factor = min(max(growth, 0.2), LARGEST_GROWTH_RATIO_OF_WEAR_STEP)
        if error > self._tolerance:
            self._set_length_of_next_wear_step(size * min(factor, 0.7))
            return
        at_end = size == left
        self.states.append(replace(after, s=end) if at_end else after)
        if self._just_turned:
            self._opening_step, self._just_turned = size * factor, False
        # If this step was shortened only to end at a reversal or at the end of the run, the next
        # step gets the length that was planned for this one.
        cut_short = at_end and size < self._step
        self._step = max(self._step, size) if cut_short else size * factor
        if at_end and end == self._next_turn and not self.has_reached_sliding_distance:
            self._reverse_drum_rotation_and_append_state()

    def _length_of_next_wear_step(self, left: float) -> float:
        """The length [m] of the next step; `left` [m] is the distance to the end or next reversal.

        If between one and two planned steps remain, two steps of half the remaining distance are
        made, so that the last step is not tiny. Raises NoAnswer if the length is infinite, because
        wear no longer changes the pressure.
        """
        size = left if self._step > 0.999 * left else min(self._step, left / 2)
        if math.isinf(size):
            raise NoAnswer("not settled: p no longer changes, but differs from what it was to be")
        return size

    def _set_length_of_next_wear_step(self, step: float) -> None:
        """Set the length of the next step to `step` [m].

        Raises NoAnswer if the step is below SHORTEST_RELATIVE_WEAR_STEP, relative to the distance
        so far.
        """
        self._step = step
        s = self.last_wear_state.s
        if step < SHORTEST_RELATIVE_WEAR_STEP * max(s, 1e-300) and s > 0:
            raise NoAnswer("not converged: the step of the wear shrinks to nothing")

    def _reverse_drum_rotation_and_append_state(self) -> None:
        """Let the drum turn the other way, and append the state after the reversal."""
        self._forward = not self._forward
        self._next_turn += self._reverse
        stepper = self._steppers[self._forward]
        self.states.append(
            stepper.wear_state_just_after_drum_reversal(self.last_wear_state, self._forward)
        )
        self._step, self._just_turned = self._opening_step, True


def wear_linings_in_given_steps(
    interfaces: WearContactProblemsOfAllGroups, law: WearLaw, stations: Sequence[float]
) -> list[WearState]:
    """Wear linings in steps that end at the distances `stations` [m], without error control.

    Returns the states before the first step and after each step.
    """
    stepper = _WearStepper(interfaces, law, None)
    states = [stepper.wear_state_of_unworn_linings()]
    for s in stations:
        after, _ = stepper.wear_state_and_error_after_step(states[-1], s - states[-1].s)
        states.append(replace(after, s=s))
    return states


def join_contact_problems_of_lining_groups(
    interfaces: WearContactProblemsOfAllGroups,
) -> WearContactProblem:
    """Join several groups of linings into one group, with one common contact problem.

    The friction at the abutments of a group may have several cases (`AbutmentFrictionCase`): each
    foot slides one way or the other, or sticks. The joint group has a case for every combination of
    its groups' cases.
    """
    combinations = product(*(interface.abutment_friction_cases for interface in interfaces))
    first, *others = map(_join_abutment_friction_cases, combinations)
    all_settle = all(map(attrgetter("settle"), interfaces))
    return WearContactProblem(
        problem=first.problem,
        weight=block_diag(*map(attrgetter("weight"), interfaces)),
        loaded=_concatenate_attribute_of_objects(interfaces, "loaded"),
        pressure=_concatenate_attribute_of_objects(interfaces, "pressure"),
        area=_concatenate_attribute_of_objects(interfaces, "area"),
        torque=_concatenate_attribute_of_objects(interfaces, "torque"),
        is_consistent_with_solution=first.is_consistent_with_solution,
        others=tuple(others),
        settle=partial(_find_friction_case_and_contact_of_all_worn_linings, interfaces)
        if all_settle
        else None,
    )


def _concatenate_attribute_of_objects(owners: Iterable[Any], name: str) -> Floats:
    """Concatenate the arrays (n,) that several objects have in their attribute `name`."""
    return np.concatenate(list(map(attrgetter(name), owners)))


def _join_abutment_friction_cases(footings: Sequence[AbutmentFrictionCase]) -> AbutmentFrictionCase:
    """Join one friction case of each group of linings to a friction case of the joint group.

    The matrices of the joint contact problem are block diagonal.
    """
    problem = ContactProblem(
        A=block_diag(*map(attrgetter("problem.A"), footings)),
        q=_concatenate_attribute_of_objects(footings, "problem.q"),
        B=block_diag(*map(attrgetter("problem.B"), footings)),
        C=block_diag(*map(attrgetter("problem.C"), footings)),
        h=_concatenate_attribute_of_objects(footings, "problem.h"),
    )
    return AbutmentFrictionCase(
        problem, partial(_is_friction_consistent_at_all_abutments, footings)
    )


def _is_friction_consistent_at_all_abutments(
    footings: Sequence[AbutmentFrictionCase], contact: ContactSolution
) -> bool:
    """Whether the solution of a joint contact problem agrees with the friction at all abutments.

    `footings` holds the friction case that was assumed for each group of linings.
    """
    unknowns = slices_from_lengths_of_consecutive_parts(
        len(footing.problem.q) for footing in footings
    )
    motions = slices_from_lengths_of_consecutive_parts(
        len(footing.problem.h) for footing in footings
    )
    for footing, unknown, motion in zip(footings, unknowns, motions, strict=True):
        if not footing.is_consistent_with_solution(
            replace(contact, p=contact.p[unknown], y=contact.y[motion])
        ):
            return False
    return True


def _find_friction_case_and_contact_of_all_worn_linings(
    interfaces: WearContactProblemsOfAllGroups, depth: Floats
) -> tuple[int, Bools]:
    """Solve the contact of several groups of worn linings, each group without a first guess.

    Returns the position of the combination of the groups' friction cases in the order of
    `itertools.product`, and a mask (n,) of the unknowns in contact. `depth` (n,) [m] is the worn
    depth.
    """
    number = 0
    active_sets: list[Bools] = []
    parts = slices_from_lengths_of_consecutive_parts(
        len(interface.area) for interface in interfaces
    )
    for interface, part in zip(interfaces, parts, strict=True):
        assert interface.settle is not None
        own_number, active = interface.settle(depth[part])
        # Combinations are numbered as by `itertools.product`: the case of the last group changes
        # fastest, like the last digit of a number.
        number = number * len(interface.abutment_friction_cases) + own_number
        active_sets.append(active)
    return number, np.concatenate(active_sets)


class SteadyWearContactSolution(NamedTuple):
    """The contact of linings in steady wear, in which the pressure no longer changes.

    Attributes
    ----------
    footing : position of the friction case in `WearContactProblem.abutment_friction_cases`
    contact : solution of the contact problem of steady wear. Its field `p` holds the nodal
        pressures or nodal forces, the unknowns x of `WearContactProblem`. Its gap w and its motions
        y are changes per sliding distance, for a wear rate of pressure^exponent.
    """

    footing: int
    contact: ContactSolution


def solve_steady_wear(interface: WearContactProblem, law: WearLaw) -> SteadyWearContactSolution:
    """Solve the steady wear of a group of linings, in which the pressure no longer changes.

    The pressure depends on the exponent of the wear law, and not on its coefficient. NoAnswer is
    raised if a rigid shoe would lock itself, if no pressure balances the actuation, or if no
    friction case at the abutments agrees with its solution.
    """
    failure: NoAnswer | None = None
    compliance_of_wear = np.diagonal(interface.weight) * interface.pressure
    for number, footing in enumerate(interface.abutment_friction_cases):
        try:
            contact = _solve_steady_wear_for_abutment_friction(interface, footing, law)
        except NoAnswer as error:
            failure = failure or error
            continue
        # After a long sliding distance the motion by wear is far larger than the elastic motion,
        # and alone decides in which direction a foot slides. For the check of the friction, the
        # motion by wear is therefore scaled to STEADY_WEAR_MOTION_OVER_ELASTIC_MOTION times the
        # elastic motion.
        elastic = float(np.abs(np.diagonal(footing.problem.A)).max())
        scale = STEADY_WEAR_MOTION_OVER_ELASTIC_MOTION * float(
            elastic / np.abs(compliance_of_wear).max()
        )
        if footing.is_consistent_with_solution(replace(contact, y=scale * contact.y)):
            return SteadyWearContactSolution(number, contact)
    raise failure or NoAnswer("worn in, a foot would leave its abutment")


def _solve_steady_wear_for_abutment_friction(
    interface: WearContactProblem, footing: AbutmentFrictionCase, law: WearLaw
) -> ContactSolution:
    """Solve the steady wear of linings under the friction case `footing` at the abutments.

    If friction depends on the pressure, Newton's method takes its tangent at the last pressures.
    Raises NoAnswer if there is no equilibrium.
    """
    p, last_change = np.zeros(len(interface.area)), math.inf
    for _ in range(MOST_NEWTON_STEPS_OF_WEAR_STAGE):
        problem = interface.contact_problem_at_pressures(footing, p)
        contact = _solve_steady_wear_of_contact_problem(interface, problem, law)
        change = largest_change_relative_to_peak(contact.p, p)
        if interface.friction is None or is_newton_change_negligible(change, last_change):
            return contact
        p, last_change = contact.p, change
    raise NoAnswer("no worn-in pressure found whose friction agrees with it")


def _solve_steady_wear_of_contact_problem(
    interface: WearContactProblem, problem: ContactProblem, law: WearLaw
) -> ContactSolution:
    """Solve the steady wear of linings with a given contact problem.

    For the exponent 1 of the wear law, steady wear is the solution of one contact problem. In this
    problem the wear depth per pressure takes the place of the elastic compliance. For other
    exponents this solution is the first guess. Raises NoAnswer if there is no equilibrium.
    """
    _, q, B, C, h = problem
    compliance = interface.weight * interface.pressure
    linear = active_set.solve_contact_problem(ContactProblem(compliance, np.zeros(len(q)), B, C, h))
    if not linear.stable:
        raise NoAnswer("worn in, a rigid shoe would lock itself")
    if law.exponent == 1:
        return linear
    return _solve_steady_power_law_wear(interface, problem, law.exponent, linear)


def _solve_steady_power_law_wear(
    interface: WearContactProblem, problem: ContactProblem, exponent: float, linear: ContactSolution
) -> ContactSolution:
    """Solve the steady wear of linings under a wear rate p^m with an exponent m other than 1.

    If the motions of the shoe are given, the wear rates p^m follow from a contact problem without
    equations of equilibrium. A root finder varies the motions until the pressures balance the
    loads.

    Parameters
    ----------
    interface : the linings
    problem : contact problem of the linings
    exponent : the exponent m
    linear : the steady wear for m = 1, as first guess

    Raises
    ------
    NoAnswer
        if the root finder does not converge
    """
    q, B, C, h = problem.q, problem.B, problem.C, problem.h
    no_equilibria = np.zeros((len(q), 0)), np.zeros((0, len(q))), np.zeros(0)
    # Wear rates below are divided by the rate at the largest pressure, so that they are about 1.
    top = float((interface.pressure * linear.p).max())
    motions = linear.y / top

    def contact_with_wear_rates_as_pressures(y: Floats) -> ContactSolution:
        """The contact solution if the shoe moves by y per sliding distance.

        Its field p holds wear rates: since the lining cannot penetrate the drum, it wears as fast
        as the shoe moves it towards the drum.
        """
        return active_set.solve_contact_problem(
            ContactProblem(interface.weight, B @ y, *no_equilibria), linear.active
        )

    def contact_unknowns_at_wear_rates(rate: Floats) -> Floats:
        """The contact unknowns x (n,) under which the lining wears at the rates (n,)."""
        return top * rate ** (1 / exponent) / interface.pressure

    # If the motions are t times as large, the pressure is t^(1/m) times as large. The first guess
    # of the motions is scaled so that its pressure balances the largest load.
    load = np.abs(
        C @ contact_unknowns_at_wear_rates(contact_with_wear_rates_as_pressures(motions).p)
    ).max()
    guess = motions * float(np.abs(h).max() / load) ** exponent
    size = np.maximum(np.abs(guess), 1e-9 * np.abs(guess).max())

    def relative_load_imbalances_under_motions(z: Any) -> Floats:
        """The imbalance of each load, relative to the largest load, for motions z times `size`."""
        return (
            C @ contact_unknowns_at_wear_rates(contact_with_wear_rates_as_pressures(z * size).p) - h
        ) / np.abs(h).max()

    # scipy.optimize takes time to load, and only a wear exponent other than 1 needs it.
    from scipy.optimize import root as root_of_equations  # noqa: PLC0415

    root = root_of_equations(relative_load_imbalances_under_motions, guess / size, tol=1e-13)
    if not root.success:
        raise NoAnswer("no worn-in pressure in equilibrium found")
    contact = contact_with_wear_rates_as_pressures(root.x * size)
    return replace(
        contact, p=contact_unknowns_at_wear_rates(contact.p), y=root.x * size * top**exponent
    )


def find_contact_set_from_soft_linings(problem: ContactProblem, weight: Floats) -> Bools | None:
    """Find which unknowns (n,) are in contact, by a sequence of stiffer and stiffer linings.

    On a very soft lining the shoe acts as a rigid body, and the contact is found from any first
    guess. The contact of each lining is the first guess for the next, stiffer lining. The sequence
    ends with the lining of the given problem. The result is None if a lining of the sequence has no
    solution.

    Parameters
    ----------
    problem : contact problem of the linings
    weight : (n, n), weighted gap per compression of the added soft lining
    """
    A, q, B, C, h = problem
    compliance = float(np.abs(np.diagonal(A)).max() / np.abs(np.diagonal(weight)).max())
    softest = RELATIVE_COMPLIANCE_FIRST_ADDED_TO_LININGS * compliance
    active = np.ones(len(q), dtype=bool)
    try:
        for k in range(NUMBER_OF_SOFT_LINING_PROBLEMS):
            softened = A + softest * ADDED_COMPLIANCE_REDUCTION_FACTOR**-k * weight
            active = active_set.solve_contact_by_block_pivoting(
                ContactProblem(softened, q, B, C, h), active
            ).active
        return active_set.solve_contact_by_block_pivoting(problem, active).active
    except NoAnswer:
        return None


def contact_problem_at_given_torque(
    interface: WearContactProblem, torque: float, problem: ContactProblem | None = None
) -> ContactProblem:
    """The contact problem of linings whose torque is given in place of their actuation.

    Let f be the unknown factor on the actuation. The unloaded gap is then q + (f - 1) loaded, and
    the equilibria are C x = f h. The equilibrium with the largest load, say row 0 of C, gives
    f = (C x)_0 / h_0. Inserted into the gap and the other equilibria, f adds terms to A and C. The
    equation of the given torque, with the sign of h_0, takes the place of row 0.

    Parameters
    ----------
    interface : the linings
    torque : torque of all linings [N m]
    problem : contact problem of one of the friction cases at the abutments; None for the first case
    """
    A, q, B, C, h = interface.problem if problem is None else problem
    main = int(np.argmax(np.abs(h)))
    factor = C[main] / h[main]
    rows = C - np.outer(h, factor)
    rows[main] = math.copysign(1.0, h[main]) * interface.torque * interface.pressure
    right = np.zeros(len(h))
    right[main] = math.copysign(torque, h[main])
    return ContactProblem(
        A + np.outer(interface.loaded, factor), q - interface.loaded, B, rows, right
    )


ContactChangePerGapChangeFunction = Callable[[Floats], Floats]
"""A linear function from a change (n,) of the weighted gap to the change (n,) of contact unknowns.

It is valid as long as the same unknowns stay in contact."""


class _IntegralsOverSlidingDistance(NamedTuple):
    """The integrals over the sliding distance in a WearState.

    Attributes
    ----------
    removed : worn volume [m^3], the integral of the wear rate over area and distance
    pressed : integral [N m] of the normal force over the distance
    work : integral [N m^2] of the torque over the distance
    """

    removed: float
    pressed: float
    work: float


class _ContactOfAllLinings(NamedTuple):
    """The contact of all linings of a brake with the drum, at one stage of a wear step.

    Attributes
    ----------
    p : (n,) [Pa], pressures
    rate : (n,), wear per sliding distance, dh/ds
    tangents : for each group of linings, the linear function from a change of its weighted gap to
        the change of its contact unknowns
    """

    p: Floats
    rate: Floats
    tangents: list[ContactChangePerGapChangeFunction]


class _ContactOfLiningGroup(NamedTuple):
    """The contact of one group of linings with the drum, at one stage of a wear step.

    Attributes
    ----------
    p : (n,) [Pa], pressures
    rate : (n,), wear per sliding distance, dh/ds
    contact : solution of the contact problem
    """

    p: Floats
    rate: Floats
    contact: ContactSolution


class _WearStepper:
    """A solver that wears the linings of a brake step by step, for one direction of rotation.

    A step has two stages, and each stage solves the contact. The unknowns in contact at a stage are
    the first guess for the next stage, which also tries the same friction case at the abutments
    (`AbutmentFrictionCase`) first.

    Parameters
    ----------
    interfaces : groups of linings; the groups do not influence each other
    law : the wear law
    torque : torque of all linings [N m] that the actuation is adjusted to keep; None for a constant
        actuation
    """

    def __init__(
        self, interfaces: WearContactProblemsOfAllGroups, law: WearLaw, torque: float | None
    ) -> None:
        self.law, self.held = law, torque
        # A given torque is the sum of the torques of all linings, so that all linings then need one
        # common contact problem.
        self.interfaces = (
            list(interfaces)
            if torque is None
            else [join_contact_problems_of_lining_groups(interfaces)]
        )
        self.parts = slices_from_lengths_of_consecutive_parts(
            len(interface.area) for interface in self.interfaces
        )
        self.problems = list(map(self._contact_problems_of_linings, self.interfaces))
        self.footing = [0] * len(self.interfaces)
        self.area = _concatenate_attribute_of_objects(self.interfaces, "area")
        self.lever = _concatenate_attribute_of_objects(self.interfaces, "torque")
        self.sets: list[Bools | None] = [None] * len(self.interfaces)
        # The pressures of the last stage, from which Newton's method starts if friction depends on
        # the pressure.
        self.pressures = [np.zeros(len(interface.area)) for interface in self.interfaces]
        self.forward = True

    def _contact_problems_of_linings(self, interface: WearContactProblem) -> list[ContactProblem]:
        """The contact problems of a group of linings: one for each friction case at its abutments.

        If the wear run keeps a given torque, the problems prescribe this torque in place of the
        actuation.
        """
        problems: list[ContactProblem] = list(
            map(attrgetter("problem"), interface.abutment_friction_cases)
        )
        if self.held is None:
            return problems
        return list(map(partial(contact_problem_at_given_torque, interface, self.held), problems))

    def wear_state_of_unworn_linings(self) -> WearState:
        """The state of the unworn linings under load. Raises NoAnswer if it has no equilibrium."""
        depth = np.zeros(len(self.area))
        pressure = self._solve_pressure_without_first_guess(depth)
        return self._make_wear_state(
            0.0, depth, pressure, _IntegralsOverSlidingDistance(0.0, 0.0, 0.0)
        )

    def wear_state_just_after_drum_reversal(self, state: WearState, forward: bool) -> WearState:
        """The state of linings directly after a reversal of the drum; `state` is the state before.

        `forward` tells whether the drum now turns in the direction that the brake file states.
        """
        self.forward = forward
        integrals = _IntegralsOverSlidingDistance(state.removed, state.pressed, state.work)
        pressure = self._solve_pressure_without_first_guess(state.depth)
        return self._make_wear_state(state.s, state.depth, pressure, integrals)

    def _solve_pressure_without_first_guess(self, depth: Floats) -> Floats:
        """The pressure (n,) [Pa] of linings worn by a depth (n,) [m], found without a first guess.

        The contact that is found is the first guess for the steps that follow.
        """
        for i, (interface, part) in enumerate(zip(self.interfaces, self.parts, strict=True)):
            if interface.settle is None:
                continue
            # `settle` searches under the force of the brake file. If the run keeps a given torque,
            # the brake may lock itself under this force and still have an equilibrium at the
            # torque. The search then fails. The first guess is then the contact of the stage
            # before, if there was a stage.
            with suppress(NoAnswer) if self.held is not None else nullcontext():
                self.footing[i], self.sets[i] = interface.settle(depth[part])
        return self._solve_contact_of_all_linings(depth, 0.0).p

    def length_of_first_wear_step(self, state: WearState, tolerance: float) -> float:
        """The length [m] of the first step, short enough for the node with the fastest change of p.

        The length is infinite if nothing wears.
        """
        largest = state.pressure.max(initial=1.0)
        slope = float(self.law.wear_rate_and_its_slope(np.full(1, largest), 0.0)[1][0])
        if slope == 0:
            return math.inf
        # Wear changes the pressure of a node over a sliding distance of about a/(k g). Here a is
        # the node's elastic compliance (weighted gap per pressure), k the slope of the wear law and
        # g the weighted gap per worn depth. The node with the shortest distance counts.
        least = math.inf
        for interface in self.interfaces:
            of_wear = np.diagonal(interface.weight) * interface.pressure
            # Unknowns that do not wear, the pulls of springs, are left out.
            wears = of_wear != 0
            ratios = np.diagonal(interface.problem.A)[wears] / of_wear[wears]
            least = min(least, float(np.abs(ratios).min()))
        return math.sqrt(tolerance) * least / slope

    def wear_state_and_error_after_step(
        self, state: WearState, ds: float
    ) -> tuple[WearState, float]:
        """The state after a step of length ds [m], and the relative L2 error of its pressure."""
        footing = list(self.footing)
        # Each of the two stages of the Runge-Kutta method gives wear rates. Their weighted mean
        # times the length of the step is the depth that the step wears off.
        first = self._solve_contact_of_all_linings(
            state.depth, RUNGE_KUTTA_COEFFICIENT_OF_WEAR_STAGES * ds
        )
        second = self._solve_contact_of_all_linings(
            state.depth + (1 - RUNGE_KUTTA_COEFFICIENT_OF_WEAR_STAGES) * ds * first.rate,
            RUNGE_KUTTA_COEFFICIENT_OF_WEAR_STAGES * ds,
        )
        depth = state.depth + ds * (
            (1 - RUNGE_KUTTA_COEFFICIENT_OF_WEAR_STAGES) * first.rate
            + RUNGE_KUTTA_COEFFICIENT_OF_WEAR_STAGES * second.rate
        )
        # r1 and r2 are the wear rates of the two stages. A first-order method with the same stages
        # would wear by ds r1, and this depth is wrong by RUNGE_KUTTA_COEFFICIENT_OF_WEAR_STAGES ds
        # (r2 - r1). The derivative of the pressure by the worn depth at the last stage turns this
        # error of the depth into an error of the pressure.
        depth_error = RUNGE_KUTTA_COEFFICIENT_OF_WEAR_STAGES * ds * (second.rate - first.rate)
        error = self._norm_of_pressure_over_all_linings(
            self._pressure_change_due_to_worn_depth(second.tangents, depth_error)
        )
        # This derivative is valid only if the same unknowns were in contact, with the same friction
        # at the abutments, throughout the step.
        pressed = second.p > 0
        same_set = ((state.pressure > 0) == pressed).all() and ((first.p > 0) == pressed).all()
        if not same_set or self.footing != footing:
            error = max(
                error, self._norm_of_pressure_difference_from_euler_step(state, ds, second.p)
            )
        error /= self._norm_of_pressure_over_all_linings(second.p) or 1.0

        def integral_over_wear_step(at_first: Floats, at_second: Floats, row: Floats) -> float:
            """The integral of row @ values over the step, from the values at its two stages."""
            return ds * float(
                row
                @ (
                    (1 - RUNGE_KUTTA_COEFFICIENT_OF_WEAR_STAGES) * at_first
                    + RUNGE_KUTTA_COEFFICIENT_OF_WEAR_STAGES * at_second
                )
            )

        integrals = _IntegralsOverSlidingDistance(
            removed=state.removed + integral_over_wear_step(first.rate, second.rate, self.area),
            pressed=state.pressed + integral_over_wear_step(first.p, second.p, self.area),
            work=state.work
            + integral_over_wear_step(
                self._quantities_per_torque_arm(first.p),
                self._quantities_per_torque_arm(second.p),
                self.lever,
            ),
        )
        return self._make_wear_state(state.s + ds, depth, second.p, integrals), error

    def _pressure_change_due_to_worn_depth(
        self, tangents: Sequence[ContactChangePerGapChangeFunction], depth: Floats
    ) -> Floats:
        """The change of the pressure (n,) [Pa] by a small change of the worn depth.

        Parameters
        ----------
        tangents : for each group of linings, the linear function from a change of its weighted gap
            to the change of its contact unknowns
        depth : (n,) [m], change of the worn depth
        """
        changes = []
        for interface, part, tangent in zip(self.interfaces, self.parts, tangents, strict=True):
            changes.append(interface.pressure * tangent(interface.weight @ depth[part]))
        return np.concatenate(changes)

    def _norm_of_pressure_difference_from_euler_step(
        self, state: WearState, ds: float, p: Floats
    ) -> float:
        """The L2 norm of the pressure p after a step minus the pressure of one implicit Euler step.

        The norm measures the error of a step during which nodes come into contact or leave it. The
        derivative of the pressure by the worn depth cannot measure this error, because it is valid
        only for the nodes in contact at the end of the step.

        Parameters
        ----------
        state : state before the step
        ds : length of the step [m]
        p : pressures (n,) [Pa] after the step
        """
        last = list(self.footing), list(self.sets)
        euler = self._solve_contact_of_all_linings(state.depth, ds)
        self.footing, self.sets = last
        return self._norm_of_pressure_over_all_linings(euler.p - p)

    def _norm_of_pressure_over_all_linings(self, p: Floats) -> float:
        """The L2 norm of a pressure (n,) [Pa] over the area of all linings."""
        return math.sqrt(float(np.abs(self.area) @ p**2))

    def _make_wear_state(
        self, s: float, depth: Floats, p: Floats, integrals: _IntegralsOverSlidingDistance
    ) -> WearState:
        """Make the state at a sliding distance s [m] from worn depth (n,) [m] and pressure p (n,).

        `integrals` are the integrals over the sliding distance up to s.
        """
        force = self._actuation_factor_that_balances_pressures(0, p)
        torque = float(self.lever @ self._quantities_per_torque_arm(p))
        return WearState(s, depth, p, torque, force, self.forward, *integrals)

    def _quantities_per_torque_arm(self, p: Floats) -> Floats:
        """The values (n,) [Pa] whose product with `lever` is the torque, at pressures p (n,)."""
        if all(interface.friction is None for interface in self.interfaces):
            return p
        each = zip(self.interfaces, self.parts, strict=True)
        return np.concatenate([own.quantities_per_torque_arm(p[part]) for own, part in each])

    def _solve_contact_of_all_linings(self, depth: Floats, ds: float) -> _ContactOfAllLinings:
        """Solve the contact of all linings at a stage of a wear step.

        Parameters
        ----------
        depth : (n,) [m], worn depth before the wear of the stage
        ds : distance [m] over which the stage wears the linings further, at the wear rate of the
            pressure that it solves for; 0 for no further wear
        """
        bearings = [
            self._solve_contact_of_lining_group(i, depth[part], ds)
            for i, part in enumerate(self.parts)
        ]
        return _ContactOfAllLinings(
            p=_concatenate_attribute_of_objects(bearings, "p"),
            rate=_concatenate_attribute_of_objects(bearings, "rate"),
            tangents=list(map(attrgetter("contact.pressure_change"), bearings)),
        )

    def _actuation_factor_that_balances_pressures(self, i: int, p: Floats) -> float:
        """The factor on the actuation with which the pressures on lining group `i` are in balance.

        `p` (n,) [Pa] are the pressures. The factor is 1 unless the wear run keeps a given torque.
        """
        if self.held is None:
            return 1.0
        interface = self.interfaces[i]
        problem = interface.abutment_friction_cases[self.footing[i]].problem
        main = int(np.argmax(np.abs(problem.h)))
        return float(problem.C[main] @ (p / interface.pressure)) / float(problem.h[main])

    def _solve_contact_of_lining_group(
        self, i: int, depth: Floats, ds: float
    ) -> _ContactOfLiningGroup:
        """Solve the contact of lining group `i` at a stage of a wear step.

        The friction cases at the abutments (`AbutmentFrictionCase`) are tried until a solution
        agrees with its case. Raises NoAnswer if no solution does. `depth` (n,) [m] is the worn
        depth before the stage. In the stage the linings wear further over the distance `ds` [m], at
        the rate of the pressure that is solved for.
        """
        failure: NoAnswer | None = None
        last_footing, last_set = self.footing[i], self.sets[i]
        footings = self.interfaces[i].abutment_friction_cases
        # The friction case that held at the stage before is tried first.
        for number in sorted(range(len(footings)), key=lambda number: number != last_footing):
            self.footing[i], self.sets[i] = number, last_set
            try:
                bearing = self._solve_contact_for_abutment_friction(i, depth, ds)
            except NoAnswer as error:
                failure = failure or error
                continue
            force = self._actuation_factor_that_balances_pressures(i, bearing.p)
            # `is_consistent_with_solution`, which checks the friction on the feet, expects a
            # solution under the actuation of the brake file. The solution is scaled to this
            # actuation.
            contact = bearing.contact
            if force > 0:
                contact = replace(contact, p=contact.p / force, y=contact.y / force)
            if force > 0 and footings[number].is_consistent_with_solution(contact):
                return bearing
        self.footing[i], self.sets[i] = last_footing, last_set
        raise failure or NoAnswer("no equilibrium, a foot leaves its abutment")

    def _solve_contact_for_abutment_friction(
        self, i: int, depth: Floats, ds: float
    ) -> _ContactOfLiningGroup:
        """Solve the contact of lining group `i` for the friction case `self.footing[i]`.

        In each iteration of Newton's method the wear rate is linear in the pressure: the tangent at
        the pressure of the iteration before. The slope of this tangent acts as a compliance of the
        linings, and its constant part as a gap. Raises NoAnswer for self-locking or no convergence.
        `depth` (n,) [m] is the worn depth before the stage, and `ds` [m] the distance over which
        the stage wears the linings.
        """
        interface, worn = self.interfaces[i], self.interfaces[i].weight @ depth
        A, q, B, C, h = self._worn_contact_problem_at_pressures(i, self.pressures[i], worn)
        is_linear = (self.law.exponent == 1 or ds == 0) and interface.friction is None
        p = self._first_guess_of_pressure(i, ContactProblem(A, q, B, C, h))
        rounded = (
            MEAN_PRESSURE_FRACTION_OF_SMOOTHED_WEAR_RATE
            * float(interface.area @ p)
            / float(interface.area.sum())
        )
        last_change = math.inf
        for _ in range(1 if is_linear else MOST_NEWTON_STEPS_OF_WEAR_STAGE):
            if interface.friction is not None:
                A, q, B, C, h = self._worn_contact_problem_at_pressures(i, p, worn)
            rate, slope = self.law.wear_rate_and_its_slope(p, rounded)
            softer = A + ds * interface.weight * (slope * interface.pressure)
            shift = ds * (interface.weight @ (rate - slope * p))
            contact = active_set.solve_contact_problem(
                ContactProblem(softer, q + shift, B, C, h), self.sets[i]
            )
            new = interface.pressure * contact.p
            change = largest_change_relative_to_peak(new, p)
            settled = is_linear or is_newton_change_negligible(change, last_change)
            p, last_change = new, change
            # The tangent of the friction stress at pressures that are not settled yet may be that
            # of a brake that locks itself.
            if not contact.stable and self.held is None and (settled or interface.friction is None):
                raise NoAnswer("self-locking, no stable equilibrium")
            self.sets[i] = contact.active
            if settled:
                self.pressures[i] = p
                return _ContactOfLiningGroup(
                    p, self.law.wear_rate_and_its_slope(p, rounded)[0], contact
                )
        raise NoAnswer(
            "not converged: "
            f"the pressure under wear of exponent {self.law.exponent:g} still changes"
        )

    def _worn_contact_problem_at_pressures(self, i: int, p: Floats, worn: Floats) -> ContactProblem:
        """The contact problem of worn linings, with the tangent of the friction stress at p (n,).

        `i` is the number of the group of linings, and `worn` (n,) the weighted gap that their worn
        depth opens.
        """
        interface, number = self.interfaces[i], self.footing[i]
        problem = self.problems[i][number]
        if interface.friction is not None:
            footing = interface.abutment_friction_cases[number]
            problem = interface.contact_problem_at_pressures(footing, p)
        return problem._replace(q=problem.q + worn)

    def _first_guess_of_pressure(self, i: int, problem: ContactProblem) -> Floats:
        """The pressure (n,) [Pa] from which Newton's method starts, for lining group `i`.

        For an exponent of the wear law other than 1, it is the pressure of the linings without the
        wear of this stage. For the exponent 1 it is the pressure of the last stage if friction
        depends on the pressure. If friction does not, the equations are linear and need no first
        guess, so that zeros are returned.
        """
        if self.law.exponent == 1:
            return self.pressures[i] if self.interfaces[i].friction else np.zeros(len(problem.q))
        contact = active_set.solve_contact_problem(problem, self.sets[i])
        self.sets[i] = contact.active
        return self.interfaces[i].pressure * contact.p


def wear_linings_by_explicit_euler(
    interfaces: WearContactProblemsOfAllGroups, law: WearLaw, ds: float, steps: int
) -> list[WearState]:
    """Wear linings by explicit Euler steps; returns the states before and after each step.

    This common method needs very short steps, or else the pressure alternates from node to node. It
    serves only as a comparison for the implicit method of `wear_linings_over_sliding_distance`.

    Parameters
    ----------
    interfaces : groups of linings; the groups do not influence each other
    law : the wear law
    ds : length of a step [m]
    steps : number of steps
    """
    stepper = _WearStepper(interfaces, law, None)
    states = [stepper.wear_state_of_unworn_linings()]
    for _ in range(steps):
        before = states[-1]
        mean = float(stepper.area @ before.pressure) / float(stepper.area.sum())
        rate = law.wear_rate_and_its_slope(
            before.pressure, MEAN_PRESSURE_FRACTION_OF_SMOOTHED_WEAR_RATE * mean
        )[0]
        depth = before.depth + ds * rate
        bearing = stepper._solve_contact_of_all_linings(depth, 0.0)
        integrals = _IntegralsOverSlidingDistance(
            removed=before.removed + ds * float(stepper.area @ rate),
            pressed=before.pressed + ds * float(stepper.area @ before.pressure),
            work=before.work + ds * before.torque,
        )
        states.append(stepper._make_wear_state(before.s + ds, depth, bearing.p, integrals))
    return states


def relative_amplitude_of_node_to_node_pressure_ripple(p: Floats, margin: int = 5) -> float:
    """How much nodal pressures p (n,) alternate from node to node, relative to p.

    It is the norm of the fourth difference (1, -4, 6, -4, 1)/16 of p, divided by the norm of p. The
    ratio is 1 for p = +1, -1, +1, ..., and of the order of the node spacing to the fourth power for
    a smooth p. At each end of the lining and of the contact, `margin` nodes are left out. The
    result is nan if no node is left.
    """
    # If the pressure alternates, single nodes may have no pressure although they lie in the
    # contact. The contact therefore ends only where three successive nodes have no pressure.
    open_stretches = _mask_of_true_with_true_neighbours(p <= 0, 1, beyond=True)
    use = _mask_of_true_with_true_neighbours(~open_stretches, margin, beyond=False)
    if not use.any():
        return math.nan
    fourth = np.convolve(p, np.array([1.0, -4.0, 6.0, -4.0, 1.0]) / 16, mode="same")
    return float(np.linalg.norm(fourth[use]) / np.linalg.norm(p[use]))


def _mask_of_true_with_true_neighbours(where: Bools, margin: int, *, beyond: bool) -> Bools:
    """The mask (n,) that is true where `where` (n,) is true for an entry and all its neighbours.

    Neighbours are the entries up to `margin` places away on either side. Beyond the ends of the
    array the value `beyond` is assumed.
    """
    padded = np.pad(where, margin, constant_values=beyond)
    eroded: Bools = np.lib.stride_tricks.sliding_window_view(padded, 2 * margin + 1).min(axis=1)
    return eroded


def interpolate_wear_state_at_distance(states: Sequence[WearState], s: float) -> WearState:
    """The state at a sliding distance s [m], interpolated between the states before and after."""
    # At a reversal two states have the same distance. The state before the reversal counts.
    after = min(bisect_left(states, s, key=attrgetter("s")), len(states) - 1)
    b = states[after]
    if after == 0 or b.s == s:
        return b
    a = states[after - 1]
    t = (s - a.s) / (b.s - a.s)

    def interpolate_number_at_distance(x: float, y: float) -> float:
        """Interpolate at the distance s between x of the earlier state and y of the later state."""
        return (1 - t) * x + t * y

    return WearState(
        s=s,
        depth=(1 - t) * a.depth + t * b.depth,
        pressure=(1 - t) * a.pressure + t * b.pressure,
        torque=interpolate_number_at_distance(a.torque, b.torque),
        force=interpolate_number_at_distance(a.force, b.force),
        forward=b.forward,
        removed=interpolate_number_at_distance(a.removed, b.removed),
        pressed=interpolate_number_at_distance(a.pressed, b.pressed),
        work=interpolate_number_at_distance(a.work, b.work),
        pulls=tuple(
            interpolate_number_at_distance(x, y) for x, y in zip(a.pulls, b.pulls, strict=True)
        ),
    )


def distance_after_which_values_stay_small(
    s: Sequence[float], values: Sequence[float], limit: float
) -> float:
    """The distance [m] beyond which the absolute values of a quantity stay at or below a limit.

    It is interpolated linearly between two of the given distances. It is 0 if no value is above the
    limit, and inf if the last value is above it.

    Parameters
    ----------
    s : growing distances [m]
    values : the quantity at each distance
    limit : limit on the absolute values
    """
    above = np.flatnonzero(np.abs(values) > limit)
    if not len(above):
        return 0.0
    i = int(above[-1])
    if i + 1 >= len(s):
        return math.inf
    a, b = abs(values[i]), abs(values[i + 1])
    return s[i] + (s[i + 1] - s[i]) * (a - limit) / (a - b)
