"""Archard wear of linings in full slip: contact problems, one after another, as the brake slides.

The depth h worn off the lining opens the gap. It grows where the lining is pressed:

    w = q + A x + B y + G h,   p = D x >= 0,  w >= 0,  p w = 0,   C x = h_load,      dh/ds = rate(p)

with rate(p) = k p for the exponent 1. In time these equations are stiff: ripples of one element
settle some thousand times faster than the bending of the shoe. An implicit step makes the wear a
compliance, A + gamma ds G k D, as a soft contact does. Each stage is one contact problem. The
method is stable for any step and makes no checkerboard. The steps are those of the L-stable,
stiffly accurate diagonally implicit Runge-Kutta method of order 2 with gamma = 1 - 1/sqrt(2)
(Alexander 1977, SIAM J. Numer. Anal. 14, 1006), with the first order embedded in it as a measure of
the error. The stages have p w = 0 exactly. Both weights are positive, so that h never shrinks and
never grows where nothing presses.

Friction at a rough abutment opposes the slide of the foot one way or the other, or holds the foot.
Each of these ways has a contact problem of its own, a `Footing`. Each stage of a step keeps the
last footing while the stage's answer allows this footing, and takes another one if not.

Wear that goes on for ever becomes steady. The pressure then no longer changes, and every point of
the lining wears as fast as the motions y' of the shoe close the gap at the point. With dp/ds = 0
the equations above, differentiated by s, are

    w' = B y' + G rate(p),   p >= 0,  w' >= 0,  p w' = 0,   C x = h_load

They contain neither stiffness nor gap: they are those of a rigid shoe on a bed of springs. Their
answer (`solve_steady_wear`) is the end of wear on the given mesh. As the mesh is refined it becomes
the rigid-shoe law.

The module knows nothing of brakes: `linings` makes its problems from them.
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
import scipy.optimize

from drumlin.base.arrays import Bools, Floats, in_turn
from drumlin.base.errors import BadInput, NoAnswer
from drumlin.base.lapack import block_diag
from drumlin.contact import active_set
from drumlin.contact.active_set import Contact
from drumlin.contact.equations import ContactProblem

GAMMA = 1 - 1 / math.sqrt(2)
"""Diagonal coefficient of the Runge-Kutta method; this value makes it L-stable (Alexander 1977)."""

TOLERANCE = 1e-3
"""Error of the pressure that a step may make where no tolerance is given: L2 norm, relative to the
pressure. Steps above it are repeated with a shorter distance. A judgement."""

MAX_WEAR_STEPS = 20_000
"""Largest number of steps. Runs that need more are refused; the example brakes take some 40."""

MAX_STEP_GROWTH = 4.0
"""Largest factor from one step to the next. Larger ones risk a step that has to be repeated."""

ROUNDED_PRESSURE = 1e-3
"""Pressure, relative to the mean one, below which a wear rate of exponent under 1 is rounded off.

Without the rounding the slope of the rate would be infinite at p = 0, and Newton's method would
not converge there. A judgement."""

NEWTON_TOLERANCE = 1e-11
"""Largest change of the pressure, relative to its maximum, with which Newton's method ends. Smaller
values are round-off."""

MAX_NEWTON_STEPS = 60
"""Newton steps after which a stage counts as not converged. A judgement."""

SHORTEST_STEP = 1e-13
"""Step, relative to the distance so far, below which the run gives up: round-off of the distance
would swallow it."""

STEADY_MOTION_RATIO = 1e9
"""Ratio of a shoe's motion by steady wear to its elastic motion when the slide of its feet is
judged.

Wear that goes on for ever makes this ratio infinite. At 1e9 the elastic motion changes the
direction of a slide by as little as round-off does."""

SOFTEST_COMPLIANCE = 1e3
"""Compliance of the softest linings that a contact set is followed from, relative to the largest
compliance of the brake. A larger value only costs time."""

SOFTENED_BY = 4.0
"""Factor between the compliances of successive linings while a contact set is followed from soft
linings. A smaller factor only costs time."""

SOFTENINGS = 20
"""Number of compliances while a contact set is followed from soft linings.

The last compliance is 4e-9 of the brake's own: without it the contact set hardly changes."""


def is_always_allowed(_: Contact) -> bool:
    """Whether an answer allows the friction: always where no abutment is rough."""
    return True


class Footing(NamedTuple):
    """One way in which friction may act at the abutments of the shoes.

    Attributes
    ----------
    problem : contact problem of the unworn linings under this friction
    stands : whether an answer of `problem` allows this friction: it opposes the slide of each
        foot, or holds the foot
    """

    problem: ContactProblem
    stands: Callable[[Contact], bool] = is_always_allowed


class WearInterface(NamedTuple):
    """Linings that bear together, with n contact unknowns x: the terms of the equations above.

    Attributes
    ----------
    problem : contact problem of the unworn linings
    loaded : (n,), the part of the problem's q that the actuation makes
    weight : G (n, n), weighted gap per depth
    pressure : (n,), the diagonal of D: pressure [Pa] per unknown
    area : (n,) [m^2], volume per depth, and normal force per pressure
    torque : (n,) [m^3], torque per pressure
    stands : whether an answer of `problem` allows its friction, as in a Footing
    others : the further footings
    settle : settle(depth) finds the number of the footing and the contact set (n,) of linings worn
        by a depth (n,) [m], without a first guess. It raises NoAnswer where these linings have no
        equilibrium.
    """

    problem: ContactProblem
    loaded: Floats
    weight: Floats
    pressure: Floats
    area: Floats
    torque: Floats
    stands: Callable[[Contact], bool] = is_always_allowed
    others: tuple[Footing, ...] = ()
    settle: Callable[[Floats], tuple[int, Bools]] | None = None

    @property
    def footings(self) -> tuple[Footing, ...]:
        """All footings, that of `problem` first."""
        return (Footing(self.problem, self.stands), *self.others)


class WearLaw(NamedTuple):
    """The wear law dh/ds = coefficient p (p/reference)^(exponent - 1).

    Attributes
    ----------
    coefficient : [1/Pa], at the pressure `reference`
    exponent : power of the pressure; 1 is Archard's law
    reference : pressure [Pa]; with the exponent 1 it has no effect
    """

    coefficient: float
    exponent: float = 1.0
    reference: float = 1e6

    def rate(self, p: Floats, rounded: float) -> tuple[Floats, Floats]:
        """The wear per distance, dh/ds (n,), and its slope (n,) [1/Pa] at pressures p (n,) [Pa].

        `rounded` [Pa] is the pressure below which an exponent under 1 is rounded off, see
        ROUNDED_PRESSURE.
        """
        if self.exponent == 1:
            return self.coefficient * p, np.full(p.shape, self.coefficient)
        k, m = self.coefficient / self.reference ** (self.exponent - 1), self.exponent
        if m > 1:
            return k * p**m, k * m * p ** (m - 1)
        size = p**2 + rounded**2
        rate = k * p * size ** ((m - 1) / 2)
        slope = k * size ** ((m - 3) / 2) * (m * p**2 + rounded**2)
        return rate, slope


@dataclass(frozen=True)
class WearState:
    """The linings after a sliding distance.

    The integrals run from the start, by the quadrature of the method itself.

    Attributes
    ----------
    s : sliding distance [m]
    depth : (n,) [m], worn off at the contact unknowns of all interfaces, one after the other
    pressure : (n,) [Pa], at the same unknowns
    torque : [N m], of all linings
    force : factor on the actuation
    forward : whether the drum turns as the brake says
    removed : [m^3], integral of the wear rate
    pressed : [N m], integral of the normal force over s
    work : [N m^2], integral of the torque over s
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


WearInterfaces = Sequence[WearInterface]
"""The interfaces of a brake, each in equilibrium by itself."""


def wear_linings(
    forward: WearInterfaces,
    law: WearLaw,
    *,
    backward: WearInterfaces = (),
    reverse: float = math.inf,
    torque: float | None = None,
    distance: float = math.inf,
    tolerance: float = TOLERANCE,
    until: Callable[[WearState], bool] = lambda _: False,
) -> list[WearState]:
    """Wear linings over a sliding distance, or until a state is reached; returns all states.

    Parameters
    ----------
    forward : the interfaces, each in equilibrium by itself
    law : the wear law
    backward : the same interfaces with the drum turning back
    reverse : distance [m] after which the drum turns the other way, again and again; the state is
        then there twice, before and after
    torque : of all interfaces [N m], which the actuation holds; None: the actuation stays
    distance : sliding distance [m] at which the run ends
    tolerance : error of p (L2, relative) that a step may make
    until : whether the run ends with a state

    Raises
    ------
    BadInput
        for options out of range
    NoAnswer
        where there is no equilibrium, the shoe locks itself, or the steps do not converge
    """
    if reverse < math.inf and not backward:
        raise BadInput(f"reverse = {reverse:g}: needs the interfaces of the drum turning backward")
    held = 1.0 if torque is None else torque
    _check_positive({"distance": distance, "reverse": reverse, "torque": held})
    _check_law(law, tolerance, distance)
    wear_run = _WearRunInProgress(
        forward=_WearStepper(forward, law, torque),
        backward=_WearStepper(backward or forward, law, torque),
        reverse=reverse,
        distance=distance,
        tolerance=tolerance,
    )
    while not wear_run.has_reached_distance and not until(wear_run.state):
        if len(wear_run.states) > MAX_WEAR_STEPS:
            raise NoAnswer(f"not converged: the wear is not settled after {MAX_WEAR_STEPS} steps")
        wear_run.take_step()
    return wear_run.states


def _check_positive(values: Mapping[str, float]) -> None:
    """Raise BadInput for an option that is not greater than 0."""
    for name, value in values.items():
        if not value > 0:
            raise BadInput(f"{name} = {value:g}: must be greater than 0")


def _check_law(law: WearLaw, tolerance: float, distance: float) -> None:
    """Raise BadInput for a wear law, a tolerance or a sliding distance out of range."""
    if not 0 < tolerance <= 0.1:
        raise BadInput(f"tolerance = {tolerance:g}: must be greater than 0 and at most 0.1")
    if not law.coefficient >= 0:
        raise BadInput(f"coefficient = {law.coefficient:g}: must not be negative")
    if not 0.3 <= law.exponent <= 4:
        raise BadInput(f"exponent = {law.exponent:g}: must be from 0.3 to 4")
    if math.isinf(distance) and law.coefficient == 0:
        raise BadInput("coefficient = 0: nothing wears, so that a distance in m must be given")


class _WearRunInProgress:
    """A wear run in progress: its states so far, and the length of its next step.

    Parameters
    ----------
    forward, backward : the steppers of the linings for the two senses of rotation
    reverse : distance [m] after which the drum turns the other way
    distance : sliding distance [m] at which the run ends
    tolerance : error of p (L2, relative) that a step may make
    """

    def __init__(
        self,
        forward: "_WearStepper",
        backward: "_WearStepper",
        reverse: float,
        distance: float,
        tolerance: float,
    ) -> None:
        self._steppers = {True: forward, False: backward}
        self._reverse, self._distance, self._tolerance = reverse, distance, tolerance
        self._forward = True
        self._next_turn = reverse
        self.states = [forward.initial_state()]
        self._step = forward.first_step_length(self.state, tolerance)
        # A reversal begins with the step that the last reversal, or the start, could have taken.
        self._opening_step = self._step
        self._just_turned = True

    @property
    def state(self) -> WearState:
        """The last state of the run so far."""
        return self.states[-1]

    @property
    def has_reached_distance(self) -> bool:
        """Whether the run has reached its sliding distance, apart from round-off."""
        return self.state.s >= self._distance * (1 - 1e-12)

    def take_step(self) -> None:
        """Take a step, or shorten the step where its error is too large. Raises NoAnswer."""
        end = min(self._distance, self._next_turn)
        left = end - self.state.s
        size = self._size(left)
        after, error = self._steppers[self._forward].step(self.state, size)
        # The error of the embedded first order grows with the square of the step.
        growth = 0.9 * math.sqrt(self._tolerance / max(error, 1e-30))
        factor = min(max(growth, 0.2), MAX_STEP_GROWTH)
        if error > self._tolerance:
            self._shorten_step(size * min(factor, 0.7))
            return
        at_end = size == left
        self.states.append(replace(after, s=end) if at_end else after)
        if self._just_turned:
            self._opening_step, self._just_turned = size * factor, False
        # A step that the end cut short says nothing about the length of the next one.
        cut_short = at_end and size < self._step
        self._step = max(self._step, size) if cut_short else size * factor
        if at_end and end == self._next_turn and not self.has_reached_distance:
            self._reverse_drum()

    def _size(self, left: float) -> float:
        """The length of the next step, with `left` [m] to go. Raises NoAnswer.

        The last two steps share the rest, so that no tiny step remains at the end.
        """
        size = left if self._step > 0.999 * left else min(self._step, left / 2)
        if math.isinf(size):
            raise NoAnswer("not settled: p no longer changes, but differs from what it was to be")
        return size

    def _shorten_step(self, step: float) -> None:
        """Shorten the next step. Raises NoAnswer where round-off would swallow the shorter step."""
        self._step = step
        s = self.state.s
        if step < SHORTEST_STEP * max(s, 1e-300) and s > 0:
            raise NoAnswer("not converged: the step of the wear shrinks to nothing")

    def _reverse_drum(self) -> None:
        """Reverse the drum, and append the state of the linings after the reversal."""
        self._forward = not self._forward
        self._next_turn += self._reverse
        self.states.append(
            self._steppers[self._forward].state_after_reversal(self.state, self._forward)
        )
        self._step, self._just_turned = self._opening_step, True


def wear_linings_in_given_steps(
    interfaces: WearInterfaces, law: WearLaw, stations: Sequence[float]
) -> list[WearState]:
    """Wear linings in steps that end at the distances `stations` [m], without error control."""
    stepper = _WearStepper(interfaces, law, None)
    states = [stepper.initial_state()]
    for s in stations:
        after, _ = stepper.step(states[-1], s - states[-1].s)
        states.append(replace(after, s=s))
    return states


def join_interfaces(interfaces: WearInterfaces) -> WearInterface:
    """Join several interfaces into one, with every combination of their footings."""
    combinations = product(*(interface.footings for interface in interfaces))
    first, *others = map(_joint_footing, combinations)
    all_settle = all(map(attrgetter("settle"), interfaces))
    return WearInterface(
        problem=first.problem,
        weight=block_diag(*map(attrgetter("weight"), interfaces)),
        loaded=_concatenate_attribute(interfaces, "loaded"),
        pressure=_concatenate_attribute(interfaces, "pressure"),
        area=_concatenate_attribute(interfaces, "area"),
        torque=_concatenate_attribute(interfaces, "torque"),
        stands=first.stands,
        others=tuple(others),
        settle=partial(_settle_all_interfaces, interfaces) if all_settle else None,
    )


def _concatenate_attribute(owners: Iterable[Any], name: str) -> Floats:
    """The arrays (n,) that some objects have as their attribute `name`, one after the other."""
    return np.concatenate(list(map(attrgetter(name), owners)))


def _joint_footing(footings: Sequence[Footing]) -> Footing:
    """The footing that holds where each of several interfaces has its own of these footings."""
    problem = ContactProblem(
        A=block_diag(*map(attrgetter("problem.A"), footings)),
        q=_concatenate_attribute(footings, "problem.q"),
        B=block_diag(*map(attrgetter("problem.B"), footings)),
        C=block_diag(*map(attrgetter("problem.C"), footings)),
        h=_concatenate_attribute(footings, "problem.h"),
    )
    return Footing(problem, partial(_allows_all_footings, footings))


def _allows_all_footings(footings: Sequence[Footing], contact: Contact) -> bool:
    """Whether the common answer of several interfaces allows the footing of each of them."""
    unknowns = in_turn(len(footing.problem.q) for footing in footings)
    motions = in_turn(len(footing.problem.h) for footing in footings)
    for footing, unknown, motion in zip(footings, unknowns, motions, strict=True):
        if not footing.stands(replace(contact, p=contact.p[unknown], y=contact.y[motion])):
            return False
    return True


def _settle_all_interfaces(interfaces: WearInterfaces, depth: Floats) -> tuple[int, Bools]:
    """The number of the combination of footings, and the contact set (n,) of all interfaces.

    The linings are worn by a depth (n,) [m].
    """
    number = 0
    active_sets: list[Bools] = []
    parts = in_turn(len(interface.area) for interface in interfaces)
    for interface, part in zip(interfaces, parts, strict=True):
        assert interface.settle is not None
        own_number, active = interface.settle(depth[part])
        # `product` counts its combinations with the last interface changing first.
        number = number * len(interface.footings) + own_number
        active_sets.append(active)
    return number, np.concatenate(active_sets)


class SteadyWear(NamedTuple):
    """Steady wear, the end of wear; see the head of this module.

    Attributes
    ----------
    footing : number of the footing
    contact : its p are the contact unknowns x; its w and y are w' and y' under the rate p^exponent
    """

    footing: int
    contact: Contact


def solve_steady_wear(interface: WearInterface, law: WearLaw) -> SteadyWear:
    """The steady wear that the wear of an interface ends with.

    Steady wear depends on the exponent of the wear law, not on the coefficient. NoAnswer is raised
    where a rigid shoe would lock itself, nothing balances the actuation, or a foot leaves its
    abutment.
    """
    failure: NoAnswer | None = None
    compliance_of_wear = np.diagonal(interface.weight) * interface.pressure
    for number, footing in enumerate(interface.footings):
        try:
            contact = _solve_steady_wear_with_footing(interface, footing, law)
        except NoAnswer as error:
            failure = failure or error
            continue
        # The motion by wear must exceed the elastic motion by far.
        elastic = float(np.abs(np.diagonal(footing.problem.A)).max())
        scale = STEADY_MOTION_RATIO * float(elastic / np.abs(compliance_of_wear).max())
        if footing.stands(replace(contact, y=scale * contact.y)):
            return SteadyWear(number, contact)
    raise failure or NoAnswer("worn in, a foot would leave its abutment")


def _solve_steady_wear_with_footing(
    interface: WearInterface, footing: Footing, law: WearLaw
) -> Contact:
    """The steady wear with one footing. Raises NoAnswer.

    For the exponent 1, steady wear is the answer of one contact problem with the compliance of
    wear. For other exponents this answer is the first guess.
    """
    _, q, B, C, h = footing.problem
    compliance = interface.weight * interface.pressure
    linear = active_set.solve_contact_problem(ContactProblem(compliance, np.zeros(len(q)), B, C, h))
    if not linear.stable:
        raise NoAnswer("worn in, a rigid shoe would lock itself")
    if law.exponent == 1:
        return linear
    return _solve_steady_power_law_wear(interface, footing.problem, law.exponent, linear)


def _solve_steady_power_law_wear(
    interface: WearInterface, problem: ContactProblem, exponent: float, linear: Contact
) -> Contact:
    """The steady wear under the rate p^m. Raises NoAnswer.

    For given motions the rate p^m answers a contact problem without equilibria. The motions whose
    p balances the loads are found by Newton's method.

    Parameters
    ----------
    interface : the linings
    problem : their contact problem
    exponent : m
    linear : the steady wear for m = 1
    """
    q, B, C, h = problem.q, problem.B, problem.C, problem.h
    no_equilibria = np.zeros((len(q), 0)), np.zeros((0, len(q))), np.zeros(0)
    # Rates and motions are relative to the largest pressure.
    top = float((interface.pressure * linear.p).max())
    motions = linear.y / top

    def rates(y: Floats) -> Contact:
        """The contact whose p are the rates under motions y."""
        return active_set.solve_contact_problem(
            ContactProblem(interface.weight, B @ y, *no_equilibria), linear.active
        )

    def unknowns(rate: Floats) -> Floats:
        """The contact unknowns x (n,) that wear at a rate (n,)."""
        return top * rate ** (1 / exponent) / interface.pressure

    # Motions t times as large make p larger by t^(1/m). The first guess balances the largest load.
    load = np.abs(C @ unknowns(rates(motions).p)).max()
    guess = motions * float(np.abs(h).max() / load) ** exponent
    size = np.maximum(np.abs(guess), 1e-9 * np.abs(guess).max())

    def imbalance(z: Any) -> Floats:
        """The loads that motions z, relative to `size`, leave unbalanced."""
        return (C @ unknowns(rates(z * size).p) - h) / np.abs(h).max()

    root = scipy.optimize.root(imbalance, guess / size, tol=1e-13)
    if not root.success:
        raise NoAnswer("no worn-in pressure in equilibrium found")
    contact = rates(root.x * size)
    return replace(contact, p=unknowns(contact.p), y=root.x * size * top**exponent)


def contact_set_from_soft_linings(problem: ContactProblem, weight: Floats) -> Bools | None:
    """The contact set (n,) of a problem, followed from that of far softer linings.

    A soft lining lies on the drum as under a rigid shoe, and its contact set is found from any
    guess. The matrix `weight` (n, n) weighs a gap. Returns None where the set is lost on the way.
    """
    A, q, B, C, h = problem
    compliance = float(np.abs(np.diagonal(A)).max() / np.abs(np.diagonal(weight)).max())
    softest = SOFTEST_COMPLIANCE * compliance
    active = np.ones(len(q), dtype=bool)
    try:
        for k in range(SOFTENINGS):
            softened = A + softest * SOFTENED_BY**-k * weight
            active = active_set.solve_by_block_pivoting(
                ContactProblem(softened, q, B, C, h), active
            ).active
        return active_set.solve_by_block_pivoting(problem, active).active
    except NoAnswer:
        return None


def problem_at_given_torque(
    interface: WearInterface, torque: float, problem: ContactProblem | None = None
) -> ContactProblem:
    """The contact problem with the torque [N m] given in place of the size f of the actuation.

    The gap is q + (f - 1) loaded, and C x = f h balances the loads. The first row of C gives f =
    (C x)_0 / h_0. Put into the other rows, f becomes part of A and C, and the torque's row takes
    the place of the first row. It has the sign of the row that it replaces. "First" means the row
    with the largest load.

    Parameters
    ----------
    interface : the linings
    torque : of all linings [N m]
    problem : of one of the footings; None: of the first
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


Tangent = Callable[[Floats], Floats]
"""The change dx (n,) of the contact unknowns that a change dw (n,) of the weighted gap causes."""


class _WearIntegrals(NamedTuple):
    """The integrals over the sliding distance that a WearState holds.

    Attributes
    ----------
    removed : [m^3], integral of the wear rate
    pressed : [N m], integral of the normal force
    work : [N m^2], integral of the torque
    """

    removed: float
    pressed: float
    work: float


class _WornContact(NamedTuple):
    """The answer for the linings of all interfaces in contact with the drum.

    Attributes
    ----------
    p : pressure (n,) [Pa]
    rate : wear per sliding distance, dh/ds (n,)
    tangents : for each interface, the change of the contact unknowns by a change of the gap
    """

    p: Floats
    rate: Floats
    tangents: list[Tangent]


class _InterfaceContact(NamedTuple):
    """The answer for the linings of one interface in contact with the drum.

    Attributes
    ----------
    p : pressure (n,) [Pa]
    rate : wear per sliding distance, dh/ds (n,)
    contact : answer of the contact problem
    """

    p: Floats
    rate: Floats
    contact: Contact


class _WearStepper:
    """A solver that wears the linings of some interfaces step by step, for one sense of rotation.

    The last contact sets are first guesses, and the last footings are kept while they stand.

    Parameters
    ----------
    interfaces : the linings
    law : the wear law
    torque : which the actuation holds [N m]; None: the actuation stays
    """

    def __init__(self, interfaces: WearInterfaces, law: WearLaw, torque: float | None) -> None:
        self.law, self.held = law, torque
        # A held torque is the sum of all linings, so that they have one common problem.
        self.interfaces = list(interfaces) if torque is None else [join_interfaces(interfaces)]
        self.parts = in_turn(len(interface.area) for interface in self.interfaces)
        self.problems = list(map(self._problems_of, self.interfaces))
        self.footing = [0] * len(self.interfaces)
        self.area = _concatenate_attribute(self.interfaces, "area")
        self.lever = _concatenate_attribute(self.interfaces, "torque")
        self.sets: list[Bools | None] = [None] * len(self.interfaces)
        self.forward = True

    def _problems_of(self, interface: WearInterface) -> list[ContactProblem]:
        """The contact problem of each footing of an interface."""
        problems: list[ContactProblem] = list(map(attrgetter("problem"), interface.footings))
        if self.held is None:
            return problems
        return list(map(partial(problem_at_given_torque, interface, self.held), problems))

    def initial_state(self) -> WearState:
        """The state of the unworn linings in contact. Raises NoAnswer."""
        depth = np.zeros(len(self.area))
        return self._make_state(
            0.0, depth, self._settled_pressure(depth), _WearIntegrals(0.0, 0.0, 0.0)
        )

    def state_after_reversal(self, state: WearState, forward: bool) -> WearState:
        """The state of the same linings as the drum begins to turn forward or backward."""
        self.forward = forward
        integrals = _WearIntegrals(state.removed, state.pressed, state.work)
        return self._make_state(
            state.s, state.depth, self._settled_pressure(state.depth), integrals
        )

    def _settled_pressure(self, depth: Floats) -> Floats:
        """The pressure (n,) [Pa] of linings worn by a depth (n,) [m], without a first guess."""
        for i, (interface, part) in enumerate(zip(self.interfaces, self.parts, strict=True)):
            if interface.settle is None:
                continue
            # The force of the brake file may lock the brake although the force at the held torque
            # does not.
            with suppress(NoAnswer) if self.held is not None else nullcontext():
                self.footing[i], self.sets[i] = interface.settle(depth[part])
        return self._solve_contact(depth, 0.0).p

    def first_step_length(self, state: WearState, tolerance: float) -> float:
        """The length [m] of a first step, which is short even for the fastest ripple."""
        largest = state.pressure.max(initial=1.0)
        slope = float(self.law.rate(np.full(1, largest), 0.0)[1][0])
        if slope == 0:
            return math.inf
        # The least ratio of a node's elastic compliance to its compliance of wear at a slope of 1.
        least = math.inf
        for interface in self.interfaces:
            of_wear = np.diagonal(interface.weight) * interface.pressure
            ratios = np.diagonal(interface.problem.A) / of_wear
            least = min(least, float(np.abs(ratios).min()))
        return math.sqrt(tolerance) * least / slope

    def step(self, state: WearState, ds: float) -> tuple[WearState, float]:
        """The state after a step of ds [m], and the relative L2 error of its pressure."""
        footing = list(self.footing)
        first = self._solve_contact(state.depth, GAMMA * ds)
        second = self._solve_contact(state.depth + (1 - GAMMA) * ds * first.rate, GAMMA * ds)
        depth = state.depth + ds * ((1 - GAMMA) * first.rate + GAMMA * second.rate)
        # The embedded rule ds r1 misses the depth by GAMMA ds (r2 - r1). The tangent of the last
        # stage gives the error of p that belongs to it.
        error = self._size(
            self._pressure_change(second.tangents, GAMMA * ds * (second.rate - first.rate))
        )
        # The tangent holds for one contact set and one footing.
        pressed = second.p > 0
        same_set = ((state.pressure > 0) == pressed).all() and ((first.p > 0) == pressed).all()
        if not same_set or self.footing != footing:
            error = max(error, self._euler_error(state, ds, second.p))
        error /= self._size(second.p) or 1.0

        def integral_over_step(at_first: Floats, at_second: Floats, row: Floats) -> float:
            """The integral of row . values over the step, by the method's quadrature."""
            return ds * float(row @ ((1 - GAMMA) * at_first + GAMMA * at_second))

        integrals = _WearIntegrals(
            removed=state.removed + integral_over_step(first.rate, second.rate, self.area),
            pressed=state.pressed + integral_over_step(first.p, second.p, self.area),
            work=state.work + integral_over_step(first.p, second.p, self.lever),
        )
        return self._make_state(state.s + ds, depth, second.p, integrals), error

    def _pressure_change(self, tangents: Sequence[Tangent], depth: Floats) -> Floats:
        """The change of p (n,) that a small change of depth (n,) [m] causes."""
        changes = []
        for interface, part, tangent in zip(self.interfaces, self.parts, tangents, strict=True):
            changes.append(interface.pressure * tangent(interface.weight @ depth[part]))
        return np.concatenate(changes)

    def _euler_error(self, state: WearState, ds: float, p: Floats) -> float:
        """The L2 distance of p (n,) after a step from the answer of one implicit Euler step.

        The tangent sees the last contact set only. Where one node presses, equilibrium fixes its
        pressure and the tangent is zero. Over a step that changes the set, an implicit Euler step
        of the same length is an independent answer of the first order.
        """
        last = list(self.footing), list(self.sets)
        euler = self._solve_contact(state.depth, ds)
        self.footing, self.sets = last
        return self._size(euler.p - p)

    def _size(self, p: Floats) -> float:
        """The L2 norm of p (n,) over the linings."""
        return math.sqrt(float(np.abs(self.area) @ p**2))

    def _make_state(
        self, s: float, depth: Floats, p: Floats, integrals: _WearIntegrals
    ) -> WearState:
        """The state at the distance s [m] with a depth (n,) [m], p (n,) [Pa] and the integrals."""
        force = self._actuation_factor(0, p)
        return WearState(s, depth, p, float(self.lever @ p), force, self.forward, *integrals)

    def _solve_contact(self, depth: Floats, ds: float) -> _WornContact:
        """The linings in contact after a further wear of ds rate(p) on top of `depth` (n,) [m]."""
        bearings = [
            self._solve_interface_contact(i, depth[part], ds) for i, part in enumerate(self.parts)
        ]
        return _WornContact(
            p=_concatenate_attribute(bearings, "p"),
            rate=_concatenate_attribute(bearings, "rate"),
            tangents=list(map(attrgetter("contact.pressure_change"), bearings)),
        )

    def _actuation_factor(self, i: int, p: Floats) -> float:
        """The factor on the actuation that balances the pressures p (n,) of interface `i`.

        It is 1 unless the torque is held.
        """
        if self.held is None:
            return 1.0
        interface = self.interfaces[i]
        problem = interface.footings[self.footing[i]].problem
        main = int(np.argmax(np.abs(problem.h)))
        return float(problem.C[main] @ (p / interface.pressure)) / float(problem.h[main])

    def _solve_interface_contact(self, i: int, depth: Floats, ds: float) -> _InterfaceContact:
        """Interface `i` in contact, with the footing that stands in the answer. Raises NoAnswer."""
        failure: NoAnswer | None = None
        last_footing, last_set = self.footing[i], self.sets[i]
        footings = self.interfaces[i].footings
        # The last footing is tried first.
        for number in sorted(range(len(footings)), key=lambda number: number != last_footing):
            self.footing[i], self.sets[i] = number, last_set
            try:
                bearing = self._solve_contact_with_footing(i, depth, ds)
            except NoAnswer as error:
                failure = failure or error
                continue
            force = self._actuation_factor(i, bearing.p)
            # A footing judges the answer under the brake's own actuation.
            contact = bearing.contact
            if force > 0:
                contact = replace(contact, p=contact.p / force, y=contact.y / force)
            if force > 0 and footings[number].stands(contact):
                return bearing
        self.footing[i], self.sets[i] = last_footing, last_set
        raise failure or NoAnswer("no equilibrium, a foot leaves its abutment")

    def _solve_contact_with_footing(self, i: int, depth: Floats, ds: float) -> _InterfaceContact:
        """Interface `i` in contact with its present footing. Raises NoAnswer.

        Newton's method makes the wear rate linear about the last p: the slope is a compliance, the
        rest of the rate a gap.
        """
        interface, problem = self.interfaces[i], self.problems[i][self.footing[i]]
        A, q, B, C, h = problem._replace(q=problem.q + interface.weight @ depth)
        is_linear = self.law.exponent == 1 or ds == 0
        p = self._first_pressure_guess(i, ContactProblem(A, q, B, C, h))
        rounded = ROUNDED_PRESSURE * float(interface.area @ p) / float(interface.area.sum())
        for _ in range(1 if is_linear else MAX_NEWTON_STEPS):
            rate, slope = self.law.rate(p, rounded)
            softer = A + ds * interface.weight * (slope * interface.pressure)
            shift = ds * (interface.weight @ (rate - slope * p))
            contact = active_set.solve_contact_problem(
                ContactProblem(softer, q + shift, B, C, h), self.sets[i]
            )
            if not contact.stable and self.held is None:
                raise NoAnswer("self-locking, no stable equilibrium")
            self.sets[i] = contact.active
            new = interface.pressure * contact.p
            change, p = float(np.abs(new - p).max()), new
            if is_linear or change <= NEWTON_TOLERANCE * float(np.abs(p).max()):
                return _InterfaceContact(p, self.law.rate(p, rounded)[0], contact)
        raise NoAnswer(
            "not converged: "
            f"the pressure under wear of exponent {self.law.exponent:g} still changes"
        )

    def _first_pressure_guess(self, i: int, problem: ContactProblem) -> Floats:
        """The pressure (n,) with which Newton's method begins; a linear rate takes any pressure."""
        if self.law.exponent == 1:
            return np.zeros(len(problem.q))
        contact = active_set.solve_contact_problem(problem, self.sets[i])
        self.sets[i] = contact.active
        return self.interfaces[i].pressure * contact.p


def wear_linings_by_explicit_euler(
    interfaces: WearInterfaces, law: WearLaw, ds: float, steps: int
) -> list[WearState]:
    """Wear linings by explicit Euler steps on the nodal pressures.

    This common method makes a checkerboard or very short steps; it stands here for comparison.

    Parameters
    ----------
    interfaces : the linings
    law : the wear law
    ds : length of a step [m]
    steps : their number
    """
    stepper = _WearStepper(interfaces, law, None)
    states = [stepper.initial_state()]
    for _ in range(steps):
        before = states[-1]
        mean = float(stepper.area @ before.pressure) / float(stepper.area.sum())
        rate = law.rate(before.pressure, ROUNDED_PRESSURE * mean)[0]
        depth = before.depth + ds * rate
        bearing = stepper._solve_contact(depth, 0.0)
        integrals = _WearIntegrals(
            removed=before.removed + ds * float(stepper.area @ rate),
            pressed=before.pressed + ds * float(stepper.area @ before.pressure),
            work=before.work + ds * before.torque,
        )
        states.append(stepper._make_state(before.s + ds, depth, bearing.p, integrals))
    return states


def checkerboard_amplitude(p: Floats, margin: int = 5) -> float:
    """Size of the checkerboard in nodal pressures p (n,): the part that alternates between nodes.

    The fourth difference (1, -4, 6, -4, 1)/16 turns an alternation of size 1 into 1 and a smooth
    pressure into the fourth power of the spacing. The result is its L2 norm relative to that of p.
    It leaves out `margin` nodes at the ends of the lining and of the contact, and is nan where no
    other node is left.
    """
    # A single node out of contact is the work of a checkerboard: it does not end the contact.
    open_stretches = _erode_mask(p <= 0, 1, beyond=True)
    use = _erode_mask(~open_stretches, margin, beyond=False)
    if not use.any():
        return math.nan
    fourth = np.convolve(p, np.array([1.0, -4.0, 6.0, -4.0, 1.0]) / 16, mode="same")
    return float(np.linalg.norm(fourth[use]) / np.linalg.norm(p[use]))


def _erode_mask(where: Bools, margin: int, *, beyond: bool) -> Bools:
    """Places (n,) around which `where` is true up to `margin` places to either side.

    Places past the ends of the array count as `beyond`.
    """
    padded = np.pad(where, margin, constant_values=beyond)
    eroded: Bools = np.lib.stride_tricks.sliding_window_view(padded, 2 * margin + 1).min(axis=1)
    return eroded


def interpolate_state(states: Sequence[WearState], s: float) -> WearState:
    """The state at the sliding distance s [m], interpolated between two computed states."""
    # After a reversal the same distance is there twice; the state before the reversal counts.
    after = min(bisect_left(states, s, key=attrgetter("s")), len(states) - 1)
    b = states[after]
    if after == 0 or b.s == s:
        return b
    a = states[after - 1]
    t = (s - a.s) / (b.s - a.s)

    def interpolate(x: float, y: float) -> float:
        """The value at s on the straight line from x at the state a to y at b."""
        return (1 - t) * x + t * y

    return WearState(
        s=s,
        depth=(1 - t) * a.depth + t * b.depth,
        pressure=(1 - t) * a.pressure + t * b.pressure,
        torque=interpolate(a.torque, b.torque),
        force=interpolate(a.force, b.force),
        forward=b.forward,
        removed=interpolate(a.removed, b.removed),
        pressed=interpolate(a.pressed, b.pressed),
        work=interpolate(a.work, b.work),
    )


def settling_distance(s: Sequence[float], values: Sequence[float], limit: float) -> float:
    """The distance from which on |values| stay at or below a limit; inf where the last is above it.

    Parameters
    ----------
    s : distances [m], growing
    values : a number at each distance
    limit : on their sizes
    """
    above = np.flatnonzero(np.abs(values) > limit)
    if not len(above):
        return 0.0
    i = int(above[-1])
    if i + 1 >= len(s):
        return math.inf
    a, b = abs(values[i]), abs(values[i + 1])
    return s[i] + (s[i + 1] - s[i]) * (a - limit) / (a - b)
