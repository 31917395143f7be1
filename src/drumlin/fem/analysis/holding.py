"""The holding brake: from rest through partial slip to full slip, as the drum is turned against the
shoes.

The force comes on while the drum is at rest. In `solve` the drum turns already as the force comes
on. Linings forget the difference at full slip, where all their nodes have slipped one way. A foot
on a rough abutment does not forget it: it slides while the force comes on and may stick where it
came to. Such an end is in equilibrium, the foot within its cone of friction, but its torque is not
that of `solve`; its state says so in a line.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cache, partial
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.brake import Brake
from drumlin.contact import stick_slip
from drumlin.contact.active_set import Contact
from drumlin.contact.stick_slip import BACKWARD, FORWARD, OPEN, STICK, History, Increment, Problem
from drumlin.fem.analysis.at_rest import Feet, holding_problem
from drumlin.fem.equilibrium.group import ShoeGroup, grouped, pressed_shoes
from drumlin.fem.model import PENALTY, respond
from drumlin.fem.preparation.scene import PreparedModel

HALVINGS = 8
"""Halvings of an increment that does not settle before the rotation is refused.

The states of a node may change more than once within an increment: then no set of states settles in
one step. Increments that do not settle are some times the rotation to full slip, and each halving
allows twice as many: one of forty times that rotation needs seven or eight. More only take longer
to refuse.
"""
FIRST = 1e-7
"""Rotation [rad] from which on full slip is looked for: far below any that slips, 1e-4 of p/E or
more. The search is geometric, so that a hundredth of it takes one increment in a hundred more.
"""
LATER = 0.1
"""Part by which a path of other increments may come to full slip later than the one that has found
the rotation.

`full_slip_rotation` goes so far beyond what it has found. With half of it some linings on a pivot
still stick there at a few nodes; more leaves fewer of the rotations of a user's path to partial
slip. The search itself is no finer: each of its increments grows the rotation by this part at
least, and by its reciprocal at most.
"""
MOST_INCREMENTS = 100
TWO_ANSWERS = 1e-6
"""Relative difference of two torques at full slip above which they are two answers. The equations
of both ways differ by the penalty only, which is worth 1e-8.
"""
OTHER_FRICTION = 1e-6
"""Difference of two ratios of a foot's friction to its pressure above which friction acts
otherwise.
"""


@dataclass(frozen=True)
class Hold:
    """One state of a holding brake.

    `rotation` [rad] of the drum against its rest; `torque` [N m], the moment that holds the drum
    there, positive against the rotation; `dissipated` [J] by slip since the force came on. For each
    shoe `theta` (n,) [rad], `pressure` and `traction` (n,) [Pa] along e_theta on the lining,
    `state` (n,): open, stick, slip forward or backward; `stick`, `slip`: arcs [rad]. `notes`: where
    the moment at full slip is not that of `solve`, both and why.
    """

    rotation: float
    torque: float
    names: tuple[str, ...]
    theta: tuple[Floats, ...]
    pressure: tuple[Floats, ...]
    traction: tuple[Floats, ...]
    state: tuple[Ints, ...]
    stick: tuple[tuple[tuple[float, float], ...], ...]
    slip: tuple[tuple[tuple[float, float], ...], ...]
    dissipated: float
    notes: tuple[str, ...] = ()

    @property
    def sticking(self) -> float:
        """Share of the contact nodes that stick."""
        touching = sum(int((state != OPEN).sum()) for state in self.state)
        return (
            sum(int((state == STICK).sum()) for state in self.state) / touching if touching else 0.0
        )


class _Held(NamedTuple):
    """A group of shoes and its stick-slip problem at rest of the drum, per newton; `friction` (n,)
    of its nodes.

    `lever` (n,): q_s grows by it per radian of the drum in the sense of the brake's rotation.
    `rest`: the force on, the drum at rest; `spent`: what that has dissipated [J per newton
    squared].
    """

    group: ShoeGroup
    problem: Problem
    lever: Floats
    friction: Floats
    rest: Increment
    spent: float

    def torque(self, at: Increment) -> float:
        """The moment that holds the drum [N m], positive against the sense of the brake's rotation."""
        return float(self.group.unit_force**2 * (self.lever @ at.t))

    def turned(self, increment: Increment, start: float, end: float) -> Iterator[Increment]:
        """The increments from one at the rotation `start` to `end` [rad]."""
        return turned(self.problem, self.lever, self.friction, increment, start, end)


def hold(
    scene: PreparedModel,
    brake: Brake,
    rotations: Floats,
    *,
    penalty: float = PENALTY,
    say: Callable[[str], None] = lambda _: None,
) -> list[Hold]:
    """Turn the drum through `rotations` [rad], positive in the sense of the brake's rotation, after
    the force is on.

    The force comes on while the drum rests, in as many increments as there are rotations where
    there is a gap to close: how far it closes under little force decides where the lining sticks.
    Then each rotation is one increment. The energy converges by the first order of the increment;
    the moment hardly needs it where the drum is not turned back. States at full slip whose moment
    is not that of `solve` have a note.

    Raises NoAnswer: a shoe that does not touch, self-locking with its limit, no equilibrium, not
    converged.
    """
    paths = []
    for held in _held(scene, brake, len(rotations), penalty):
        say(f"holding: {held.group.names}")
        done, spent = _path(held, rotations)
        paths.append(_Path(held, done, spent, cache(partial(_slid, held))))
    return [_state(brake, paths, k, float(rotation)) for k, rotation in enumerate(rotations)]


def _held(scene: PreparedModel, brake: Brake, increments: int, penalty: float) -> Iterator[_Held]:
    """The groups of shoes, the force on and the drum at rest. Raises NoAnswer and BadInput as
    `hold` does.
    """
    if brake.friction == 0 or scene.brake.friction == 0:
        raise BadInput(f"friction = {brake.friction:g}: must be greater than 0 for a holding brake")
    touching = pressed_shoes(scene, brake)
    for i, shoe in enumerate(brake.shoes):
        if i not in touching:
            raise NoAnswer(
                f"shoe {shoe.name!r}: does not touch the drum, so that it cannot hold it"
            )
    for group in grouped(scene, brake, list(range(len(brake.shoes))), penalty):
        problem, lever = holding_problem(group)
        feet = Feet.of(group)
        touches = replace(group, brake=feet.smooth(0.0), senses=()).answer().active
        start = np.append(np.where(touches, STICK, OPEN), np.full(len(feet.on), STICK))
        gap = np.append(
            group.masses @ (np.concatenate(group.gaps) / group.unit_force), np.zeros(len(feet.on))
        )
        friction = feet.friction()
        try:
            rest, spent = _pressed(problem, gap, friction, start, increments)
        except NoAnswer as error:
            group.settled()  # raises where the brake locks itself
            raise NoAnswer(f"{group.names}: {error}, the drum at rest") from error
        yield _Held(group, problem, lever * (brake.spin / group.unit_force), friction, rest, spent)


def _pressed(
    problem: Problem, gap: Floats, friction: Floats, state: Ints, increments: int
) -> tuple[Increment, float]:
    """The increment in which the force is fully on, and what the slip on the way has dissipated.

    gap (n,): weighted, without force. Where it is none everywhere all grows with the force, and one
    increment is exact; else they grow like cubes, for most happens under little force. An increment
    that does not settle from the states at hand, as one of a force so little that one node or two
    bear it, is taken together with the next. Raises NoAnswer where the last does not settle.
    """
    history, energy = History(np.zeros(len(gap)), np.zeros(len(gap))), 0.0
    for share in np.linspace(0, 1, max(increments, 1) + 1)[1:] ** 3 if gap.any() else np.ones(1):
        part = problem._replace(
            q_w=gap + share * (problem.q_w - gap), q_s=share * problem.q_s, h=share * problem.h
        )
        try:
            increment = stick_slip.solve(part, friction, history, state)
        except NoAnswer:
            if share == 1:
                raise
            continue
        energy += _slip_work(problem, increment, history)
        history, state = increment.history, increment.state
    return increment, energy


class _Path(NamedTuple):
    """The increments of a group at the rotations, the energy [J] dissipated up to each, and `slid`:
    what the sliding drum has whose linings slip one way, +1 or -1.
    """

    held: _Held
    increments: list[Increment]
    spent: list[float]
    slid: Callable[[int], "_Slid"]


def _path(held: _Held, rotations: Floats) -> tuple[list[Increment], list[float]]:
    """Increments at the rotations, and the energy [J] dissipated up to each."""
    group, brake = held.group, held.group.brake
    increment, reached, energy = held.rest, 0.0, held.spent
    done, spent = [], []
    for rotation in rotations:
        try:
            for step in held.turned(increment, reached, float(rotation)):
                energy += _slip_work(held.problem, step, increment.history)
                increment = step
        except NoAnswer as error:
            _turning(
                group, brake if rotation > reached else brake.reversed()
            ).settled()  # raises where it locks
            raise NoAnswer(f"{group.names}: {error}, turned by {rotation:.3g} rad") from error
        reached = float(rotation)
        done.append(increment)
        spent.append(energy * group.unit_force**2)
    return done, spent


def turned(
    problem: Problem,
    lever: Floats,
    friction: float | Floats,
    increment: Increment,
    start: float,
    end: float,
) -> Iterator[Increment]:
    """The increments from a converged one at the rotation `start` to `end` [rad], q_s growing by
    lever (n,) a radian.

    One, where its states settle; else halves of it, see HALVINGS. Raises NoAnswer where none
    settles.
    """
    reached, pieces = start, 1
    while reached != end or start == end:
        step = end if pieces == 1 else reached + (end - reached) / pieces
        moved = problem._replace(q_s=problem.q_s + lever * step)
        try:
            increment = stick_slip.solve(moved, friction, increment.history, increment.state)
        except NoAnswer:
            if pieces >= 2**HALVINGS:
                raise
            pieces *= 2
            continue
        yield increment
        if step == end:
            return
        reached, pieces = step, pieces - 1


def _turning(group: ShoeGroup, brake: Brake) -> ShoeGroup:
    """The group at another rotation or friction of the drum, under which its feet may slide another
    way.
    """
    return replace(group, brake=brake, senses=() if group.rough else group.senses)


def _slip_work(problem: Problem, after: Increment, before: History) -> float:
    """Work of the tractions on the plastic slip of an increment, by its end values."""
    slip = after.s - before.s - problem.Q @ (after.t - before.t)
    return float(after.t @ slip)


def _state(brake: Brake, paths: list[_Path], k: int, rotation: float) -> Hold:
    found: dict[int, tuple[Floats, Floats, Floats, Ints]] = {}
    torque, dissipated, notes = 0.0, 0.0, list[str]()
    for path in paths:
        held, increments = path.held, path.increments
        dissipated += path.spent[k]
        notes += _apart(path, k)
        torque += held.torque(increments[k])
        group, size = held.group, held.group.unit_force
        for i, body, shoe, part in zip(
            group.members, group.bodies, group.shoes, group.parts, strict=True
        ):
            p, t, state = (
                size * increments[k].p[part],
                size * increments[k].t[part],
                increments[k].state[part],
            )
            forward = slice(None, None, shoe.frame.sense)
            found[i] = (
                shoe.frame.theta(body.line.phi)[forward],
                p[forward],
                t[forward],
                state[forward],
            )
    order = sorted(found)
    arcs = [stick_slip.zones(found[i][0], found[i][3]) for i in order]
    return Hold(
        rotation=rotation,
        torque=torque,
        names=tuple(brake.shoes[i].name for i in order),
        theta=tuple(found[i][0] for i in order),
        pressure=tuple(found[i][1] for i in order),
        traction=tuple(found[i][2] for i in order),
        state=tuple(found[i][3] for i in order),
        stick=tuple(arc["stick"] for arc in arcs),
        slip=tuple(arc["slip"] for arc in arcs),
        dissipated=dissipated,
        notes=tuple(notes),
    )


class _Slid(NamedTuple):
    """A group under a drum that slides already as the force comes on, its answer and torque [N m],
    positive against the sense of the brake's rotation; without an answer `why` says why not.
    """

    group: ShoeGroup
    found: Contact | None
    torque: float
    why: str


def _slid(held: _Held, way: int) -> _Slid:
    """The group under the drum that slides so that all nodes slip one way, +1 or -1."""
    brake = held.group.brake
    group = _turning(held.group, brake if way == brake.spin else brake.reversed())
    try:
        group, found = group.settled()
    except NoAnswer as error:
        return _Slid(group, None, math.nan, str(error))
    torque = brake.friction * group.unit_force * float(group.levers.sum(axis=1) @ found.p)
    return _Slid(group, found, way * brake.spin * torque, "")


def _apart(path: _Path, k: int) -> list[str]:
    """A line where in a state all nodes slip one way and the moment is not that of `solve`: both
    moments, and why.
    """
    held, at = path.held, path.increments[k]
    way = _full_slip(held, at)
    if way == 0:
        return []
    torque, slid = held.torque(at), path.slid(way)
    if math.isclose(torque, slid.torque, rel_tol=TWO_ANSWERS):
        return []
    surface = held.group.brake.surface
    unit, moving = surface.effect_unit, surface.moving
    said = f"{held.group.names}: at full slip the {surface.effect} is {torque:.6g} {unit}"
    if slid.found is None:
        return [f"{said}; solve has none: {slid.why}"]
    said += f", by solve {slid.torque:.6g} {unit}"
    feet = _feet_apart(held, at, slid.group, slid.found)
    if not feet:
        return [f"{said}: more than one answer"]
    ends, places = (
        " and ".join(foot.came_to for foot in feet),
        " and ".join(foot.by_solve for foot in feet),
    )
    return [
        f"{said}: the force came on while the {moving} was at rest and left {ends} along its abutment from where it "
        f"was without force; in solve the {moving} moves already as the force comes on, which leaves it at {places}"
    ]


class _Foot(NamedTuple):
    """How far a foot has slid along its abutment in words: at the end of a path, and by `solve`."""

    came_to: str
    by_solve: str


def _full_slip(held: _Held, at: Increment) -> int:
    """The sense in which all nodes of the linings slip that touch, +1 or -1; 0 where some do not."""
    touching = set(at.state[: held.group.parts[-1].stop].tolist()) - {OPEN}
    return 1 if touching == {FORWARD} else -1 if touching == {BACKWARD} else 0


def _feet_apart(held: _Held, at: Increment, slid: ShoeGroup, found: Contact) -> list[_Foot]:
    """The feet on which friction acts otherwise at the end of a path than in the answer `found` of
    the group `slid`.
    """
    n, size, feet = held.group.parts[-1].stop, held.group.unit_force, []
    for node, k in enumerate(Feet.of(held.group).on, start=n):
        shoe, (x, y) = slid.shoes[k], slid.reaction(found, k)
        bearing, along = float(shoe.bearing @ (x, y)), float(shoe.bearing @ (y, -x))
        if at.p[node] > 0 and abs(at.t[node] / at.p[node] - along / bearing) <= OTHER_FRICTION:
            continue
        slide = float(slid.amounts(found)[k][-1]) if slid.each_sense[k] else 0.0
        came_to, by_solve = (
            f"{1e6 * size * length:.6g} µm" for length in (0.0 - at.s[node], slide)
        )
        feet.append(_Foot(f"the foot of shoe {shoe.name!r} {came_to}", by_solve))
    return feet


def full_slip_rotation(
    scene: PreparedModel, brake: Brake, *, increments: int = 20, penalty: float = PENALTY
) -> float:
    """A rotation of the drum [rad] after which every touching node slips, at the moment of the
    sliding drum.

    increments: in which the force comes on, see `hold`. Raises NoAnswer: self-locking with its
    limit, a shoe that does not touch, not converged.
    """
    shoes = respond(scene, brake, penalty=penalty).shoes
    ends = []
    for held in _held(scene, brake, increments, penalty):
        target = sum(shoes[i].torque for i in held.group.members)
        try:
            ends.append(_slipping(held, target, FORWARD if brake.spin > 0 else BACKWARD))
        except NoAnswer as error:
            raise NoAnswer(f"{held.group.names}: {error}") from error
    return (1 + LATER) * max(ends)


def _slipping(held: _Held, target: float, way: int) -> float:
    """A rotation [rad] after which all touching nodes slip one way: that is an answer of the
    sliding drum.

    Raises NoAnswer also where it is another one than that with the moment `target` [N m].
    """
    increment, reached, step, n = held.rest, 0.0, FIRST, held.group.parts[-1].stop
    for _ in range(MOST_INCREMENTS):
        before = held.torque(increment)
        *_, increment = held.turned(increment, reached, reached + step)
        torque, reached = held.torque(increment), reached + step
        if np.isin(increment.state[:n], [OPEN, way]).all():
            if len(increment.state) > n:  # a foot that sticks stands where it came to by its path
                return reached
            if math.isclose(torque, target, rel_tol=TWO_ANSWERS):
                return reached
            raise NoAnswer(
                f"more than one answer: held it comes to slip everywhere at {torque:.5g} N m, "
                f"at once it slides at {target:.5g} N m"
            )
        lacking = (target - torque) / (torque - before) if torque > before else math.inf
        step = min(max(step * lacking, LATER * reached), reached / LATER)
    sticking = np.count_nonzero(increment.state[:n] == STICK)
    raise NoAnswer(
        f"not converged: after a rotation of {reached:.3g} rad {sticking} of {n} nodes still stick, "
        f"at {torque:.5g} of the sliding drum's {target:.5g} N m"
    )


def as_dict(states: list[Hold]) -> list[dict[str, Any]]:
    """States as plain data for JSON: rad, N m, Pa, J; node states by name; notes."""
    names = {OPEN: "open", STICK: "stick", FORWARD: "slip", BACKWARD: "slip back"}
    return [
        {
            "rotation": state.rotation,
            "torque": state.torque,
            "dissipated": state.dissipated,
            "notes": list(state.notes),
            "shoes": [
                {
                    "name": name,
                    "theta": state.theta[i].tolist(),
                    "pressure": state.pressure[i].tolist(),
                    "traction": state.traction[i].tolist(),
                    "state": [names[int(value)] for value in state.state[i]],
                    "stick": [list(arc) for arc in state.stick[i]],
                    "slip": [list(arc) for arc in state.slip[i]],
                }
                for i, name in enumerate(state.names)
            ],
        }
        for state in states
    ]
