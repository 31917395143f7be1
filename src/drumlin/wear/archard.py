"""Archard wear of linings in full slip, as a sequence of contact problems over the sliding distance.

The depth h worn off the lining opens the gap and grows where the lining is pressed:

    w = q + A x + B y + G h,   p = D x >= 0,  w >= 0,  p w = 0,   C x = h_load,      dh/ds = rate(p)

with rate(p) = k p for the exponent 1. In time these equations are stiff: ripples of one element settle some thousand
times faster than the bending of the shoe. An implicit step makes the wear a compliance, A + gamma ds G k D, as a
soft contact does: one contact problem a stage, stable for any step, and no checkerboard. The steps are those of the
L-stable, stiffly accurate diagonally implicit Runge-Kutta method of order 2 with gamma = 1 - 1/sqrt(2) (Alexander 1977,
SIAM J. Numer. Anal. 14, 1006), with the first order embedded in it as a measure of the error: stages have p w = 0
exactly, both weights are positive, so that h never shrinks and never grows where nothing presses.

Knows nothing of brakes: `run_in` makes its problems from them.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from drumlin.arrays import Bools, Floats
from drumlin.contact import active_set
from drumlin.contact.equations import Problem
from drumlin.errors import BadInput, NoAnswer
from drumlin.lapack import block_diag

GAMMA = 1 - 1 / math.sqrt(2)
TOLERANCE = 1e-3
MOST_STEPS = 20_000
GROWTH = 4.0  # largest factor from one step to the next
ROUNDED = 1e-3  # of the mean pressure: below it an exponent under 1 is rounded off, its slope at p = 0 is infinite
NEWTON = 1e-11


class WearInterface(NamedTuple):
    """Linings that bear together, n contact unknowns x: the terms of the equations above.

    `problem`: contact problem of the unworn linings; `loaded` (n,): the part of its q that the actuation makes;
    `weight` G (n, n): weighted gap per depth; `pressure` (n,): the diagonal of D, pressure [Pa] per unknown;
    `area` (n,) [m^2]: volume per depth, and normal force per pressure; `torque` (n,) [m^3]: torque per pressure.
    """

    problem: Problem
    loaded: Floats
    weight: Floats
    pressure: Floats
    area: Floats
    torque: Floats


class WearLaw(NamedTuple):
    """dh/ds = coefficient p (p/reference)^(exponent - 1): coefficient [1/Pa] at the pressure `reference` [Pa]."""

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

    `depth` (n,) [m] worn off and `pressure` (n,) [Pa] at the contact unknowns of all interfaces, one after the other;
    `torque` [N m] of all; `force`: factor on the actuation; `forward`: whether the drum turns as the brake says.
    From the start on, by the method's own quadrature: `removed` [m^3] the integral of the rate, `pressed` [N m]
    that of the normal force over s, and `work` [N m^2] that of the torque over s.
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
    """Wear linings in over the sliding `distance` [m], or until `until(state)`; states from the unworn one on.

    forward: the interfaces, each in equilibrium by itself; backward: the same with the drum turning back, which it
    does every `reverse` [m]: the state is then there twice, before and after. torque [N m]: of all interfaces, held by
    the actuation; else the actuation stays. Each step's error of p (L2) is below `tolerance`.
    Raises BadInput, and NoAnswer: no equilibrium, not converged, self-locking.
    """
    if reverse < math.inf and not backward:
        raise BadInput(f"reverse = {reverse:g}: needs the interfaces of the drum turning backward")
    for name, value in {"distance": distance, "reverse": reverse, "torque": 1.0 if torque is None else torque}.items():
        if not value > 0:
            raise BadInput(f"{name} = {value:g}: must be greater than 0")
    _check(law, tolerance, distance)
    machines = {True: _Machine(forward, law, torque), False: _Machine(backward or forward, law, torque)}
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
    """WearInterfaces as one: block by block."""
    problems = [interface.problem for interface in interfaces]
    return WearInterface(
        problem=Problem(
            A=block_diag(*(p.A for p in problems)),
            q=np.concatenate([p.q for p in problems]),
            B=block_diag(*(p.B for p in problems)),
            C=block_diag(*(p.C for p in problems)),
            h=np.concatenate([p.h for p in problems]),
        ),
        weight=block_diag(*(interface.weight for interface in interfaces)),
        loaded=np.concatenate([interface.loaded for interface in interfaces]),
        pressure=np.concatenate([interface.pressure for interface in interfaces]),
        area=np.concatenate([interface.area for interface in interfaces]),
        torque=np.concatenate([interface.torque for interface in interfaces]),
    )


def at_torque(interface: WearInterface, torque: float) -> Problem:
    """The contact problem with the torque [N m] given in place of the size f of the actuation.

    With q + (f - 1) loaded and C x = f h the first row of C gives f = (C x)_0 / h_0: put into the others, f becomes
    part of A and C, and the torque's row takes the place of the first. The sign is that of the row it replaces.
    """
    A, q, B, C, h = interface.problem
    main = int(np.argmax(np.abs(h)))
    factor = C[main] / h[main]
    rows = C - np.outer(h, factor)
    rows[main] = math.copysign(1.0, h[main]) * interface.torque * interface.pressure
    right = np.zeros(len(h))
    right[main] = math.copysign(torque, h[main])
    return Problem(A + np.outer(interface.loaded, factor), q - interface.loaded, B, rows, right)


class _Machine:
    """Steps of interfaces under one actuation and one sense of rotation; the last contact sets are first guesses."""

    def __init__(self, interfaces: WearInterfaces, law: WearLaw, torque: float | None) -> None:
        self.law, self.held = law, torque
        self.interfaces = list(interfaces) if torque is None else [together(interfaces)]
        ends = np.cumsum([0] + [len(interface.area) for interface in self.interfaces])
        self.parts = [slice(a, b) for a, b in pairwise(ends.tolist())]
        self.problems = [
            interface.problem if torque is None else at_torque(interface, torque) for interface in self.interfaces
        ]
        self.area = np.concatenate([interface.area for interface in self.interfaces])
        self.lever = np.concatenate([interface.torque for interface in self.interfaces])
        self.sets: list[Bools | None] = [None] * len(self.interfaces)
        self.forward = True

    def start(self) -> WearState:
        p, *_ = self._bear(np.zeros(len(self.area)), 0.0)
        return self._state(0.0, np.zeros(len(p)), p, (0.0, 0.0, 0.0))

    def turned(self, state: WearState, forward: bool) -> WearState:
        """The same linings with the drum turning this way."""
        self.forward = forward
        p, *_ = self._bear(state.depth, 0.0)
        return self._state(state.s, state.depth, p, (state.removed, state.pressed, state.work))

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
        if math.isinf(ds):
            raise BadInput("nothing wears: a distance must be given")
        p1, r1, _ = self._bear(state.depth, GAMMA * ds)
        p2, r2, tangents = self._bear(state.depth + (1 - GAMMA) * ds * r1, GAMMA * ds)
        depth = state.depth + ds * ((1 - GAMMA) * r1 + GAMMA * r2)
        # The embedded rule ds r1 misses by GAMMA ds (r2 - r1); the stage's own tangent says what p makes of it.
        miss = GAMMA * ds * (r2 - r1)
        dp = np.concatenate(
            [
                interface.pressure * tangent(interface.weight @ miss[part])
                for interface, part, tangent in zip(self.interfaces, self.parts, tangents, strict=True)
            ]
        )
        size = math.sqrt(float(np.abs(self.area) @ p2**2))
        error = math.sqrt(float(np.abs(self.area) @ dp**2)) / size if size else 0.0

        def total(first: Floats, second: Floats, row: Floats) -> float:
            return ds * float(row @ ((1 - GAMMA) * first + GAMMA * second))

        sums = (
            state.removed + total(r1, r2, self.area),
            state.pressed + total(p1, p2, self.area),
            state.work + total(p1, p2, self.lever),
        )
        return self._state(state.s + ds, depth, p2, sums), error

    def _state(self, s: float, depth: Floats, p: Floats, sums: tuple[float, float, float]) -> WearState:
        force = 1.0
        if self.held is not None:
            (interface,) = self.interfaces
            main = int(np.argmax(np.abs(interface.problem.h)))
            force = float(interface.problem.C[main] @ (p / interface.pressure)) / float(interface.problem.h[main])
        return WearState(s, depth, p, float(self.lever @ p), force, self.forward, *sums)

    def _bear(self, depth: Floats, ds: float) -> tuple[Floats, Floats, list[Callable[[Floats], Floats]]]:
        """p and rate (n,) that hold after a wear of ds rate(p) on top of `depth`, and the tangents dx(dw)."""
        found = [self._bear_one(i, depth[part], ds) for i, part in enumerate(self.parts)]
        return (
            np.concatenate([p for p, _, _ in found]),
            np.concatenate([rate for _, rate, _ in found]),
            [tangent for _, _, tangent in found],
        )

    def _bear_one(self, i: int, depth: Floats, ds: float) -> tuple[Floats, Floats, Callable[[Floats], Floats]]:
        interface, (A, q, B, C, h) = self.interfaces[i], self.problems[i]
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
                return p, self.law.rate(p, rounded)[0], solved.tangent
        raise NoAnswer(f"not converged: the pressure under wear of exponent {self.law.exponent:g} still changes")

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
    """Size of the checkerboard in nodal pressures p (n,): how much of them alternates from node to node.

    The fourth difference (1, -4, 6, -4, 1)/16 answers 1 to an alternation of 1 and the fourth power of the spacing to a
    smooth pressure; its L2 norm relative to that of p, without `margin` nodes at the lining's ends and at those of the
    contact. nan where no such node is left.
    """
    # a single node out of contact is what a checkerboard makes: it does not end the contact
    use = _eroded(~_eroded(p <= 0, 1, beyond=True), margin, beyond=False)
    if not use.any():
        return math.nan
    fourth = np.convolve(p, np.array([1.0, -4.0, 6.0, -4.0, 1.0]) / 16, mode="same")
    return float(np.linalg.norm(fourth[use]) / np.linalg.norm(p[use]))


def _eroded(where: Bools, margin: int, *, beyond: bool) -> Bools:
    """Places (n,) with `where` true up to `margin` places to either side; past the array's ends it is `beyond`."""
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
