"""Archard wear of linings in full slip, as a sequence of contact problems over the sliding
distance.

The depth h worn off the lining opens the gap and grows where the lining is pressed:

    w = q + A x + B y + G h,   p = D x >= 0,  w >= 0,  p w = 0,   C x = h_load,      dh/ds = rate(p)

with rate(p) = k p for the exponent 1. In time these equations are stiff: ripples of one element
settle some thousand times faster than the bending of the shoe. An implicit step makes the wear a
compliance, A + gamma ds G k D, as a soft contact does: one contact problem a stage, stable for any
step, and no checkerboard. The steps are those of the L-stable, stiffly accurate diagonally implicit
Runge-Kutta method of order 2 with gamma = 1 - 1/sqrt(2) (Alexander 1977, SIAM J. Numer. Anal. 14,
1006), with the first order embedded in it as a measure of the error: stages have p w = 0 exactly,
both weights are positive, so that h never shrinks and never grows where nothing presses.

Friction at a rough abutment opposes the slide of the foot one way or the other, or holds the foot.
Each of these ways has a contact problem of its own, a `Footing`. Each stage of a step keeps the
last footing while the stage's answer allows this footing, and takes another one if not.

Wear that goes on for ever becomes steady. The pressure then no longer changes, and every point of
the lining wears as fast as the motions y' of the shoe close the gap at the point. With dp/ds = 0
the equations above, differentiated by s, are

    w' = B y' + G rate(p),   p >= 0,  w' >= 0,  p w' = 0,   C x = h_load

They contain neither stiffness nor gap: they are those of a rigid shoe on a bed of springs. Their
answer (`steady`) is the end of wear on the given mesh. As the mesh is refined it becomes the
rigid-shoe law.

Knows nothing of brakes: `run_in` makes its problems from them.
"""

import math
from collections.abc import Callable, Sequence
from contextlib import nullcontext, suppress
from dataclasses import dataclass, replace
from functools import partial
from itertools import product
from typing import Any, NamedTuple

import numpy as np
import scipy.optimize

from drumlin.base.arrays import Bools, Floats, in_turn
from drumlin.base.errors import BadInput, NoAnswer
from drumlin.base.lapack import block_diag
from drumlin.contact import active_set
from drumlin.contact.active_set import Contact
from drumlin.contact.equations import Problem

GAMMA = 1 - 1 / math.sqrt(2)
TOLERANCE = 1e-3
MOST_STEPS = 20_000
GROWTH = 4.0  # largest factor from one step to the next
ROUNDED = 1e-3  # of the mean pressure: below it an exponent under 1 is rounded off, its slope at p = 0 is infinite
NEWTON = 1e-11
LONG_AGO = 1e9
"""Ratio of a shoe's motion by steady wear to its elastic motion when the slide of its feet is
judged.

Wear that goes on for ever makes this ratio infinite. At 1e9 the elastic motion changes the
direction of a slide by as little as round-off does."""

SOFTEST, SOFTENED_BY, SOFTENINGS = 1e3, 4.0, 20
"""Compliance of the softest linings that a contact set is followed from, relative to the largest
one of the brake; the factor from one compliance to the next; their number. The last one is 4e-9 of
the brake's own, so that the set hardly changes without it. A longer way or a smaller factor only
costs time."""


def always(_: Contact) -> bool:
    """Return True: linings without rough abutments can bear in one way only."""
    return True


class Footing(NamedTuple):
    """One way in which friction may act at the abutments of the shoes.

    `problem`: the contact problem of the unworn linings under this friction. `stands(answer)`:
    whether an answer of `problem` allows this friction: it opposes the slide of each foot, or
    holds the foot.
    """

    problem: Problem
    stands: Callable[[Contact], bool] = always


class WearInterface(NamedTuple):
    """Linings that bear together, n contact unknowns x: the terms of the equations above.

    `problem`: contact problem of the unworn linings; `loaded` (n,): the part of its q that the
    actuation makes; `weight` G (n, n): weighted gap per depth; `pressure` (n,): the diagonal of D,
    pressure [Pa] per unknown; `area` (n,) [m^2]: volume per depth, and normal force per pressure;
    `torque` (n,) [m^3]: torque per pressure. `stands` belongs to `problem` as in a Footing;
    `others`: the further footings. `settle(depth)`: the number of the footing and the contact set
    (n,) of linings worn by a depth (n,) [m], found without a first guess; it raises NoAnswer where
    these linings have no equilibrium.
    """

    problem: Problem
    loaded: Floats
    weight: Floats
    pressure: Floats
    area: Floats
    torque: Floats
    stands: Callable[[Contact], bool] = always
    others: tuple[Footing, ...] = ()
    settle: Callable[[Floats], tuple[int, Bools]] | None = None

    @property
    def footings(self) -> tuple[Footing, ...]:
        """All footings, that of `problem` first."""
        return (Footing(self.problem, self.stands), *self.others)


class WearLaw(NamedTuple):
    """dh/ds = coefficient p (p/reference)^(exponent - 1): coefficient [1/Pa] at the pressure
    `reference` [Pa].
    """

    coefficient: float
    exponent: float = 1.0
    reference: float = 1e6

    def rate(self, p: Floats, rounded: float) -> tuple[Floats, Floats]:
        """dh/ds (n,) and its slope [1/Pa] at pressures p (n,); `rounded` [Pa]: see ROUNDED."""
        if self.exponent == 1:
            return self.coefficient * p, np.full(p.shape, self.coefficient)
        k, m = self.coefficient / self.reference ** (self.exponent - 1), self.exponent
        if m > 1:
            return k * p**m, k * m * p ** (m - 1)
        size = p**2 + rounded**2
        return k * p * size ** ((m - 1) / 2), k * size ** ((m - 3) / 2) * (m * p**2 + rounded**2)


@dataclass(frozen=True)
class WearState:
    """The linings after the sliding distance `s` [m].

    `depth` (n,) [m] worn off and `pressure` (n,) [Pa] at the contact unknowns of all interfaces,
    one after the other; `torque` [N m] of all; `force`: factor on the actuation; `forward`: whether
    the drum turns as the brake says. From the start on, by the method's own quadrature: `removed`
    [m^3] the integral of the rate, `pressed` [N m] that of the normal force over s, and `work` [N
    m^2] that of the torque over s.
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


def run(
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
    """Wear linings in over the sliding `distance` [m], or until `until(state)`; states from the
    unworn one on.

    forward: the interfaces, each in equilibrium by itself; backward: the same with the drum turning
    back, which it does every `reverse` [m]: the state is then there twice, before and after. torque
    [N m]: of all interfaces, held by the actuation; else the actuation stays. Each step's error of
    p (L2) is below `tolerance`. Raises BadInput, and NoAnswer: no equilibrium, not converged,
    self-locking.
    """
    if reverse < math.inf and not backward:
        raise BadInput(f"reverse = {reverse:g}: needs the interfaces of the drum turning backward")
    for name, value in {
        "distance": distance,
        "reverse": reverse,
        "torque": 1.0 if torque is None else torque,
    }.items():
        if not value > 0:
            raise BadInput(f"{name} = {value:g}: must be greater than 0")
    _check(law, tolerance, distance)
    machines = {
        True: _Machine(forward, law, torque),
        False: _Machine(backward or forward, law, torque),
    }
    turning = True
    state = machines[True].start()
    states = [state]
    ds = opening = machines[True].first(state, tolerance)
    turn, fresh = reverse, True
    while state.s < distance * (1 - 1e-12) and not until(state):
        if len(states) > MOST_STEPS:
            raise NoAnswer(f"not converged: the wear is not settled after {MOST_STEPS} steps")
        end = min(distance, turn)
        left = end - state.s
        size = left if ds > 0.999 * left else min(ds, left / 2)  # no crumb at the end
        if math.isinf(size):
            raise NoAnswer("not settled: p no longer changes, but differs from what it was to be")
        after, error = machines[turning].step(state, size)
        factor = min(max(0.9 * math.sqrt(tolerance / max(error, 1e-30)), 0.2), GROWTH)
        if error > tolerance:
            ds = size * min(factor, 0.7)
            if ds < 1e-13 * max(state.s, 1e-300) and state.s > 0:
                raise NoAnswer("not converged: the step of the wear shrinks to nothing")
            continue
        at_end = size == left
        state = after if not at_end else replace(after, s=end)
        states.append(state)
        if fresh:  # the step that a reversal begins with is that which the last one could take
            opening, fresh = size * factor, False
        ds = max(ds, size) if at_end and size < ds else size * factor
        if at_end and end == turn and end < distance * (1 - 1e-12):
            turning, turn = not turning, turn + reverse
            state = machines[turning].turned(state, turning)
            states.append(state)
            ds, fresh = opening, True
    return states


def _check(law: WearLaw, tolerance: float, distance: float) -> None:
    if not 0 < tolerance <= 0.1:
        raise BadInput(f"tolerance = {tolerance:g}: must be greater than 0 and at most 0.1")
    if not law.coefficient >= 0:
        raise BadInput(f"coefficient = {law.coefficient:g}: must not be negative")
    if not 0.3 <= law.exponent <= 4:
        raise BadInput(f"exponent = {law.exponent:g}: must be from 0.3 to 4")
    if math.isinf(distance) and law.coefficient == 0:
        raise BadInput("coefficient = 0: nothing wears, so that a distance in m must be given")


def run_on(interfaces: WearInterfaces, law: WearLaw, stations: Sequence[float]) -> list[WearState]:
    """The same in steps that end at the growing distances `stations` [m], whatever their error."""
    machine = _Machine(interfaces, law, None)
    states = [machine.start()]
    for s in stations:
        after, _ = machine.step(states[-1], s - states[-1].s)
        states.append(replace(after, s=s))
    return states


def together(interfaces: WearInterfaces) -> WearInterface:
    """WearInterfaces as one: block by block, with every combination of their footings."""
    first, *others = [
        Footing(_joined([each.problem for each in footings]), partial(_all_stand, footings))
        for footings in product(*(interface.footings for interface in interfaces))
    ]
    return WearInterface(
        problem=first.problem,
        weight=block_diag(*(interface.weight for interface in interfaces)),
        loaded=np.concatenate([interface.loaded for interface in interfaces]),
        pressure=np.concatenate([interface.pressure for interface in interfaces]),
        area=np.concatenate([interface.area for interface in interfaces]),
        torque=np.concatenate([interface.torque for interface in interfaces]),
        stands=first.stands,
        others=tuple(others),
        settle=partial(_all_settled, interfaces)
        if all(each.settle for each in interfaces)
        else None,
    )


def _joined(problems: Sequence[Problem]) -> Problem:
    return Problem(
        A=block_diag(*(p.A for p in problems)),
        q=np.concatenate([p.q for p in problems]),
        B=block_diag(*(p.B for p in problems)),
        C=block_diag(*(p.C for p in problems)),
        h=np.concatenate([p.h for p in problems]),
    )


def _all_stand(footings: Sequence[Footing], found: Contact) -> bool:
    """Whether each of the joined footings stands in the common answer."""
    unknowns = in_turn(len(footing.problem.q) for footing in footings)
    motions = in_turn(len(footing.problem.h) for footing in footings)
    return all(
        footing.stands(replace(found, p=found.p[own], y=found.y[moved]))
        for footing, own, moved in zip(footings, unknowns, motions, strict=True)
    )


def _all_settled(interfaces: WearInterfaces, depth: Floats) -> tuple[int, Bools]:
    """The number of the footings among their combinations, and the contact set of all."""
    number, touching = 0, list[Bools]()
    parts = in_turn(len(interface.area) for interface in interfaces)
    for interface, part in zip(interfaces, parts, strict=True):
        assert interface.settle is not None
        own, active = interface.settle(depth[part])
        number = number * len(interface.footings) + own
        touching.append(active)
    return number, np.concatenate(touching)


class Steady(NamedTuple):
    """Steady wear, the end of wear; see above.

    `footing`: the number of the footing. `contact`: its p are the contact unknowns x, its w and y
    are w' and y' under the rate p^exponent.
    """

    footing: int
    contact: Contact


def steady(interface: WearInterface, law: WearLaw) -> Steady:
    """The steady wear that the wear of an interface ends with.

    It depends on the exponent of the law, not on its coefficient. Raises NoAnswer: a rigid shoe
    would lock itself, nothing balances the actuation, a foot leaves its abutment.
    """
    failure: NoAnswer | None = None
    for number, footing in enumerate(interface.footings):
        try:
            found = _steady_as(interface, footing, law)
        except NoAnswer as error:
            failure = failure or error
            continue
        soft = np.diagonal(interface.weight) * interface.pressure
        far = LONG_AGO * float(np.abs(np.diagonal(footing.problem.A)).max() / np.abs(soft).max())
        if footing.stands(replace(found, y=far * found.y)):
            return Steady(number, found)
    raise failure or NoAnswer("worn in, a foot would leave its abutment")


def _steady_as(interface: WearInterface, footing: Footing, law: WearLaw) -> Contact:
    _, q, B, C, h = footing.problem
    soft = interface.weight * interface.pressure
    found = active_set.solve(Problem(soft, np.zeros(len(q)), B, C, h))
    if not found.regular:
        raise NoAnswer("worn in, a rigid shoe would lock itself")
    if law.exponent == 1:
        return found
    # For given motions the rate p^m answers a contact problem without equilibria. What is looked
    # for are the motions under which p balances the loads.
    none = np.zeros((len(q), 0)), np.zeros((0, len(q))), np.zeros(0)
    worn = interface.pressure * found.p
    top = float(worn.max())
    motions = found.y / top

    def rates(y: Floats) -> Contact:
        return active_set.solve(Problem(interface.weight, B @ y, *none), found.active)

    def unknowns(rate: Floats) -> Floats:
        return top * rate ** (1 / law.exponent) / interface.pressure

    # Motions t times as large make p larger by t^(1/m). The first guess balances the largest load.
    borne = np.abs(C @ unknowns(rates(motions).p)).max()
    begun = motions * float(np.abs(h).max() / borne) ** law.exponent
    size = np.maximum(np.abs(begun), 1e-9 * np.abs(begun).max())

    def unbalanced(z: Any) -> Floats:
        return (C @ unknowns(rates(z * size).p) - h) / np.abs(h).max()

    root = scipy.optimize.root(unbalanced, begun / size, tol=1e-13)
    if not root.success:
        raise NoAnswer("no worn-in pressure in equilibrium found")
    at = rates(root.x * size)
    return replace(at, p=unknowns(at.p), y=root.x * size * top**law.exponent)


def from_soft(problem: Problem, weight: Floats) -> Bools | None:
    """The contact set (n,) of a problem, followed from that of linings that are far softer.

    weight (n, n): what weighs a gap. A soft lining lies on the drum as under a rigid shoe, and its
    contact set is found from any guess. None where the set is lost on the way.
    """
    A, q, B, C, h = problem
    soft = SOFTEST * float(np.abs(np.diagonal(A)).max() / np.abs(np.diagonal(weight)).max())
    active = np.ones(len(q), dtype=bool)
    try:
        for k in range(SOFTENINGS):
            softer = A + soft * SOFTENED_BY**-k * weight
            active = active_set.settle(Problem(softer, q, B, C, h), active).active
        return active_set.settle(problem, active).active
    except NoAnswer:
        return None


def at_torque(interface: WearInterface, torque: float, problem: Problem | None = None) -> Problem:
    """The contact problem with the torque [N m] given in place of the size f of the actuation.

    problem: of one of the footings, by default the first.

    With q + (f - 1) loaded and C x = f h the first row of C gives f = (C x)_0 / h_0: put into the
    others, f becomes part of A and C, and the torque's row takes the place of the first. The sign
    is that of the row it replaces.
    """
    A, q, B, C, h = interface.problem if problem is None else problem
    main = int(np.argmax(np.abs(h)))
    factor = C[main] / h[main]
    rows = C - np.outer(h, factor)
    rows[main] = math.copysign(1.0, h[main]) * interface.torque * interface.pressure
    right = np.zeros(len(h))
    right[main] = math.copysign(torque, h[main])
    return Problem(A + np.outer(interface.loaded, factor), q - interface.loaded, B, rows, right)


class _Machine:
    """Steps of interfaces under one actuation and one sense of rotation.

    The last contact sets are first guesses, and the last footings are kept while they stand.
    """

    def __init__(self, interfaces: WearInterfaces, law: WearLaw, torque: float | None) -> None:
        self.law, self.held = law, torque
        self.interfaces = list(interfaces) if torque is None else [together(interfaces)]
        self.parts = in_turn(len(interface.area) for interface in self.interfaces)
        self.problems = [
            [
                footing.problem if torque is None else at_torque(interface, torque, footing.problem)
                for footing in interface.footings
            ]
            for interface in self.interfaces
        ]
        self.footing = [0] * len(self.interfaces)
        self.area = np.concatenate([interface.area for interface in self.interfaces])
        self.lever = np.concatenate([interface.torque for interface in self.interfaces])
        self.sets: list[Bools | None] = [None] * len(self.interfaces)
        self.forward = True

    def start(self) -> WearState:
        """The unworn linings."""
        depth = np.zeros(len(self.area))
        return self._state(0.0, depth, self._settled(depth), (0.0, 0.0, 0.0))

    def turned(self, state: WearState, forward: bool) -> WearState:
        """The same linings with the drum turning this way."""
        self.forward = forward
        sums = state.removed, state.pressed, state.work
        return self._state(state.s, state.depth, self._settled(state.depth), sums)

    def _settled(self, depth: Floats) -> Floats:
        """p (n,) under a depth (n,) [m] of wear, found without a first guess."""
        for i, (interface, part) in enumerate(zip(self.interfaces, self.parts, strict=True)):
            if interface.settle is None:
                continue
            # The force of the brake file may lock the brake although the force at the held torque
            # does not.
            with suppress(NoAnswer) if self.held is not None else nullcontext():
                self.footing[i], self.sets[i] = interface.settle(depth[part])
        p, *_ = self._bear(depth, 0.0)
        return p

    def first(self, state: WearState, tolerance: float) -> float:
        """A step [m] that is short even for the fastest ripple."""
        rate = float(self.law.rate(np.full(1, state.pressure.max(initial=1.0)), 0.0)[1][0])
        if rate == 0:
            return math.inf
        ratios = [
            np.diagonal(interface.problem.A) / (np.diagonal(interface.weight) * interface.pressure)
            for interface in self.interfaces
        ]
        return math.sqrt(tolerance) * float(min(np.abs(ratio).min() for ratio in ratios)) / rate

    def step(self, state: WearState, ds: float) -> tuple[WearState, float]:
        """The state after ds [m], and the error of its pressure: of the first order, relative, L2."""
        footing = list(self.footing)
        p1, r1, _ = self._bear(state.depth, GAMMA * ds)
        p2, r2, tangents = self._bear(state.depth + (1 - GAMMA) * ds * r1, GAMMA * ds)
        depth = state.depth + ds * ((1 - GAMMA) * r1 + GAMMA * r2)
        # The embedded rule ds r1 misses by GAMMA ds (r2 - r1); the stage's own tangent says what p
        # makes of it.
        miss = GAMMA * ds * (r2 - r1)
        dp = np.concatenate(
            [
                interface.pressure * tangent(interface.weight @ miss[part])
                for interface, part, tangent in zip(
                    self.interfaces, self.parts, tangents, strict=True
                )
            ]
        )
        error = self._size(dp)
        set_changes = any(not np.array_equal(p > 0, p2 > 0) for p in (state.pressure, p1))
        if set_changes or self.footing != footing:
            # The tangent sees the last contact set only. Where one node presses, equilibrium fixes
            # its pressure and the tangent is zero. Over a step that changes the set, one implicit
            # Euler step of the same length is an independent first-order answer.
            last = list(self.footing), list(self.sets)
            p_euler, *_ = self._bear(state.depth, ds)
            self.footing, self.sets = last
            error = max(error, self._size(p_euler - p2))
        error /= self._size(p2) or 1.0

        def total(first: Floats, second: Floats, row: Floats) -> float:
            return ds * float(row @ ((1 - GAMMA) * first + GAMMA * second))

        sums = (
            state.removed + total(r1, r2, self.area),
            state.pressed + total(p1, p2, self.area),
            state.work + total(p1, p2, self.lever),
        )
        return self._state(state.s + ds, depth, p2, sums), error

    def _size(self, p: Floats) -> float:
        """The L2 norm of p (n,) over the linings."""
        return math.sqrt(float(np.abs(self.area) @ p**2))

    def _state(
        self, s: float, depth: Floats, p: Floats, sums: tuple[float, float, float]
    ) -> WearState:
        force = 1.0
        if self.held is not None:
            force = self._force(0, p)
        return WearState(s, depth, p, float(self.lever @ p), force, self.forward, *sums)

    def _bear(
        self, depth: Floats, ds: float
    ) -> tuple[Floats, Floats, list[Callable[[Floats], Floats]]]:
        """p and rate (n,) that hold after a wear of ds rate(p) on top of `depth`, and the tangents
        dx(dw).
        """
        found = [self._bear_one(i, depth[part], ds) for i, part in enumerate(self.parts)]
        return (
            np.concatenate([p for p, _, _ in found]),
            np.concatenate([rate for _, rate, _ in found]),
            [tangent for _, _, tangent in found],
        )

    def _force(self, i: int, p: Floats) -> float:
        """The factor on the actuation that balances the pressures p (n,) of interface `i`."""
        if self.held is None:
            return 1.0
        interface = self.interfaces[i]
        _, _, _, C, h = interface.footings[self.footing[i]].problem
        main = int(np.argmax(np.abs(h)))
        return float(C[main] @ (p / interface.pressure)) / float(h[main])

    def _bear_one(
        self, i: int, depth: Floats, ds: float
    ) -> tuple[Floats, Floats, Callable[[Floats], Floats]]:
        """The same of one interface, with the footing that stands in the answer."""
        failure: NoAnswer | None = None
        before, footings = (self.footing[i], self.sets[i]), self.interfaces[i].footings
        for number in sorted(range(len(footings)), key=lambda number: number != before[0]):
            self.footing[i], self.sets[i] = number, before[1]
            try:
                p, rate, solved = self._bear_as(i, depth, ds)
            except NoAnswer as error:
                failure = failure or error
                continue
            force = self._force(i, p)
            unit = replace(solved, p=solved.p / force, y=solved.y / force) if force > 0 else solved
            if force > 0 and footings[number].stands(unit):
                return p, rate, solved.tangent
        self.footing[i], self.sets[i] = before
        raise failure or NoAnswer("no equilibrium, a foot leaves its abutment")

    def _bear_as(self, i: int, depth: Floats, ds: float) -> tuple[Floats, Floats, Contact]:
        """p and rate (n,) of one interface with its present footing, and its contact."""
        interface, (A, q, B, C, h) = self.interfaces[i], self.problems[i][self.footing[i]]
        q = q + interface.weight @ depth
        linear = self.law.exponent == 1 or ds == 0
        p = self._guess(i, A, q, B, C, h)
        rounded = ROUNDED * float(interface.area @ p) / float(interface.area.sum())
        for _ in range(1 if linear else 60):
            rate, slope = self.law.rate(p, rounded)
            softer = A + ds * interface.weight * (slope * interface.pressure)
            shift = ds * (interface.weight @ (rate - slope * p))
            solved = active_set.solve(Problem(softer, q + shift, B, C, h), self.sets[i])
            if not solved.regular and self.held is None:
                raise NoAnswer("self-locking, no stable equilibrium")
            self.sets[i] = solved.active
            new = interface.pressure * solved.p
            change, p = float(np.abs(new - p).max()), new
            if linear or change <= NEWTON * float(np.abs(p).max()):
                return p, self.law.rate(p, rounded)[0], solved
        raise NoAnswer(
            f"not converged: the pressure under wear of exponent {self.law.exponent:g} still changes"
        )

    def _guess(self, i: int, A: Floats, q: Floats, B: Floats, C: Floats, h: Floats) -> Floats:
        """A pressure to begin Newton's method with; any, where the rate is linear."""
        if self.law.exponent == 1:
            return np.zeros(len(q))
        found = active_set.solve(Problem(A, q, B, C, h), self.sets[i])
        self.sets[i] = found.active
        return self.interfaces[i].pressure * found.p


def explicit(interfaces: WearInterfaces, law: WearLaw, ds: float, steps: int) -> list[WearState]:
    """The same by explicit steps of ds [m] on the nodal pressures: what not to do, for comparison."""
    machine = _Machine(interfaces, law, None)
    states = [machine.start()]
    for _ in range(steps):
        before = states[-1]
        mean = float(machine.area @ before.pressure) / float(machine.area.sum())
        rate = law.rate(before.pressure, ROUNDED * mean)[0]
        depth = before.depth + ds * rate
        p, *_ = machine._bear(depth, 0.0)
        sums = (
            before.removed + ds * float(machine.area @ rate),
            before.pressed + ds * float(machine.area @ before.pressure),
            before.work + ds * before.torque,
        )
        states.append(machine._state(before.s + ds, depth, p, sums))
    return states


def ripple(p: Floats, margin: int = 5) -> float:
    """Size of the checkerboard in nodal pressures p (n,): how much of them alternates from node to
    node.

    The fourth difference (1, -4, 6, -4, 1)/16 answers 1 to an alternation of 1 and the fourth power
    of the spacing to a smooth pressure; its L2 norm relative to that of p, without `margin` nodes
    at the lining's ends and at those of the contact. nan where no such node is left.
    """
    # a single node out of contact is what a checkerboard makes: it does not end the contact
    use = _eroded(~_eroded(p <= 0, 1, beyond=True), margin, beyond=False)
    if not use.any():
        return math.nan
    fourth = np.convolve(p, np.array([1.0, -4.0, 6.0, -4.0, 1.0]) / 16, mode="same")
    return float(np.linalg.norm(fourth[use]) / np.linalg.norm(p[use]))


def _eroded(where: Bools, margin: int, *, beyond: bool) -> Bools:
    """Places (n,) with `where` true up to `margin` places to either side; past the array's ends it
    is `beyond`.
    """
    padded = np.pad(where, margin, constant_values=beyond)
    found: Bools = np.lib.stride_tricks.sliding_window_view(padded, 2 * margin + 1).min(axis=1)
    return found


def at(states: Sequence[WearState], s: float) -> WearState:
    """The state at the sliding distance s [m] between two computed ones, in a straight line."""
    after = next((i for i, state in enumerate(states) if state.s >= s), len(states) - 1)
    b = states[after]
    if after == 0 or b.s == s:
        return b
    a = states[after - 1]
    t = (s - a.s) / (b.s - a.s)

    def mid(x: float, y: float) -> float:
        return (1 - t) * x + t * y

    return WearState(
        s,
        (1 - t) * a.depth + t * b.depth,
        (1 - t) * a.pressure + t * b.pressure,
        mid(a.torque, b.torque),
        mid(a.force, b.force),
        b.forward,
        mid(a.removed, b.removed),
        mid(a.pressed, b.pressed),
        mid(a.work, b.work),
    )


def last_beyond(s: Sequence[float], values: Sequence[float], limit: float) -> float:
    """The distance from which on |values| stay at or below `limit`: inf where the last is above it."""
    beyond = [i for i, value in enumerate(values) if abs(value) > limit]
    if not beyond:
        return 0.0
    i = beyond[-1]
    if i + 1 >= len(s):
        return math.inf
    a, b = abs(values[i]), abs(values[i + 1])
    return s[i] + (s[i + 1] - s[i]) * (a - limit) / (a - b)
