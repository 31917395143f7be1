"""The holding brake: from rest through partial slip to full slip, as the drum is turned.

The force comes on while the drum is at rest. In `solve` the drum turns already as the force comes
on. Linings forget the difference at full slip, where all their nodes have slipped one way. A foot
on a rough abutment does not forget it: it slides while the force comes on, and may stick where it
has come to. The end of its path is in equilibrium, the foot within its cone of friction, but the
torque is not that of `solve`; a line of the state says so.
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
from drumlin.contact.stick_slip import (
    BACKWARD,
    FORWARD,
    OPEN,
    STICK,
    FrictionalProblem,
    History,
    Increment,
)
from drumlin.fem.analysis.at_rest import Feet, holding_problem
from drumlin.fem.equilibrium.group import ShoeGroup, grouped, pressed_shoes
from drumlin.fem.model import PENALTY, respond
from drumlin.fem.preparation.scene import PreparedModel

HALVINGS = 8
"""Number of times that an increment is halved before its rotation is refused.

The states of a node may change more than once within an increment: then no set of states settles in
one step. Increments that do not settle are some times the rotation to full slip, and each halving
allows twice as many: an increment of forty times that rotation needs seven or eight. More halvings
only take longer to refuse.
"""
FIRST = 1e-7
"""Rotation [rad] from which the search for full slip starts: far below any rotation that makes a
lining slip, which is 1e-4 of p/E or more. The search is geometric, so that a start at a hundredth of
it takes one increment in a hundred more.
"""
LATER = 0.1
"""Fraction by which full slip may come later on a path of other increments than on the path that has
found the rotation.

`full_slip_rotation` goes beyond the rotation that it has found by this fraction. With half of it
some linings on a pivot still stick there at a few nodes. A larger value leaves fewer of the
rotations of a user's path to partial slip. The search itself is no finer: each of its increments
grows the rotation by this fraction at least, and by its reciprocal at most.
"""
MOST_INCREMENTS = 100
"""Number of increments after which the search for full slip is refused as not converged."""
TWO_ANSWERS = 1e-6
"""Relative difference of two torques at full slip above which they belong to two answers. Below it
they differ by the penalty only, which is worth 1e-8.
"""
OTHER_FRICTION = 1e-6
"""Difference of two ratios of a foot's friction to its pressure, above which friction acts otherwise
on the foot. Below it the difference is round-off and the penalty.
"""

Arcs = tuple[tuple[float, float], ...]
"""The start and the end of each arc [rad]."""


@dataclass(frozen=True)
class Hold:
    """One state of a holding brake. The nodes of a lining stand at growing angles.

    Attributes
    ----------
    rotation : of the drum against its rest [rad]
    torque : moment that holds the drum there [N m], positive against the rotation
    names : names of the shoes
    theta : angles (n,) [rad] of each lining's nodes
    pressure : (n,) [Pa] on each lining
    traction : (n,) [Pa] on each lining, along e_theta
    state : of each node (n,): open, stick, slip forward or slip backward
    stick, slip : arcs of each lining that stick and that slip [rad]
    dissipated : energy dissipated by slip since the force came on [J]
    notes : where the moment at full slip is not that of `solve`, both moments and why
    """

    rotation: float
    torque: float
    names: tuple[str, ...]
    theta: tuple[Floats, ...]
    pressure: tuple[Floats, ...]
    traction: tuple[Floats, ...]
    state: tuple[Ints, ...]
    stick: tuple[Arcs, ...]
    slip: tuple[Arcs, ...]
    dissipated: float
    notes: tuple[str, ...] = ()

    @property
    def sticking(self) -> float:
        """The share of the touching contact nodes that stick."""
        touching = sum(int((state != OPEN).sum()) for state in self.state)
        sticking = sum(int((state == STICK).sum()) for state in self.state)
        return sticking / touching if touching else 0.0


class _HeldGroup(NamedTuple):
    """A group of shoes with its stick-slip problem while the drum rests, per newton.

    Attributes
    ----------
    group : the group
    problem : the stick-slip problem, whose last nodes are feet on rough abutments
    lever : growth (n,) of q_s per radian of the drum in the sense of the brake's rotation
    friction : friction coefficient (n,) of each node
    rest : the increment with the force fully on and the drum at rest
    spent : energy dissipated up to there [J per newton squared]
    """

    group: ShoeGroup
    problem: FrictionalProblem
    lever: Floats
    friction: Floats
    rest: Increment
    spent: float

    @property
    def lining_nodes(self) -> int:
        """Number of nodes on linings; the nodes of feet follow them."""
        return self.group.node_ranges[-1].stop

    def torque(self, at: Increment) -> float:
        """The moment that holds the drum [N m], positive against the brake's rotation."""
        return float(self.group.unit_force**2 * (self.lever @ at.t))

    def turned(self, increment: Increment, start: float, end: float) -> Iterator[Increment]:
        """The increments from a converged one at the rotation `start` to `end` [rad]."""
        return turned(self.problem, self.lever, self.friction, increment, start, end)


class _Loading(NamedTuple):
    """The increment in which the force is fully on, and the energy [J/N^2] dissipated up to it."""

    increment: Increment
    spent: float


class _SlidingAnswer(NamedTuple):
    """The answer of a group under a drum that slides already as the force comes on.

    Attributes
    ----------
    group : the group, with the senses of friction at its abutments that the answer has
    contact : the answer; None where there is none
    torque : [N m], positive against the sense of the brake's rotation
    why : the reason why there is no answer, else empty
    """

    group: ShoeGroup
    contact: Contact | None
    torque: float
    why: str


class _HeldPath(NamedTuple):
    """The path of a group through given rotations of the drum.

    Attributes
    ----------
    held : the group
    increments : the increment at each rotation
    spent : energy [J] dissipated up to each rotation
    sliding : gives the answer of the sliding drum, by the sense in which all nodes slip, +1 or -1
    """

    held: _HeldGroup
    increments: list[Increment]
    spent: list[float]
    sliding: Callable[[int], _SlidingAnswer]


class _LiningState(NamedTuple):
    """The nodes of one lining in a state of the brake, at growing angles; see `Hold`."""

    theta: Floats
    pressure: Floats
    traction: Floats
    state: Ints


class _FootSlide(NamedTuple):
    """The slide of a foot along its abutment in words: at the end of a path, and by `solve`."""

    came_to: str
    by_solve: str


def hold(
    scene: PreparedModel,
    brake: Brake,
    rotations: Floats,
    *,
    penalty: float = PENALTY,
    say: Callable[[str], None] = lambda _: None,
) -> list[Hold]:
    """The states of a brake whose drum is turned through `rotations` after the force is on.

    The force comes on while the drum rests. Where there is a gap to close it comes on in as many
    increments as there are rotations, since the closure under little force decides where the lining
    sticks. Then each rotation is one increment. The energy converges with the first order of the
    increment; the moment hardly depends on it where the drum is not turned back. A state at full
    slip whose moment is not that of `solve` has a note.

    Parameters
    ----------
    scene : the prepared model
    brake : the brake
    rotations : of the drum [rad], positive in the sense of the brake's rotation
    penalty : factor alpha of the contact stiffness alpha E/t
    say : is told the group of shoes that is solved next

    Raises
    ------
    NoAnswer
        a shoe that does not touch, self-locking with its limit, no equilibrium, not converged
    BadInput
        for a brake without friction
    """
    paths = []
    for held in _held_groups(scene, brake, len(rotations), penalty):
        say(f"holding: {held.group.names}")
        paths.append(_path(held, rotations))
    return [_state(brake, paths, k, float(rotation)) for k, rotation in enumerate(rotations)]


# The force comes on


def _held_groups(
    scene: PreparedModel, brake: Brake, increments: int, penalty: float
) -> Iterator[_HeldGroup]:
    """The groups of shoes with the force on and the drum at rest. Raises as `hold` does."""
    if brake.friction == 0 or scene.brake.friction == 0:
        raise BadInput(f"friction = {brake.friction:g}: must be greater than 0 for a holding brake")
    touching = pressed_shoes(scene, brake)
    for i, shoe in enumerate(brake.shoes):
        if i not in touching:
            raise NoAnswer(
                f"shoe {shoe.name!r}: does not touch the drum, so that it cannot hold it"
            )
    for group in grouped(scene, brake, list(range(len(brake.shoes))), penalty):
        yield _held_group(group, increments)


def _held_group(group: ShoeGroup, increments: int) -> _HeldGroup:
    """A group with the force on and the drum at rest. Raises NoAnswer as `hold` does."""
    problem, lever = holding_problem(group)
    feet = Feet.of(group)
    count = len(feet.on)
    # Nodes that touch without friction stick at first, as do the feet.
    touches = replace(group, brake=feet.without_abutment_friction(0.0), senses=()).answer().active
    start = np.append(np.where(touches, STICK, OPEN), np.full(count, STICK))
    unit_gaps = np.concatenate(group.gaps) / group.unit_force
    gap = np.append(group.masses @ unit_gaps, np.zeros(count))
    friction = feet.node_friction()
    try:
        loading = _loading(problem, gap, friction, start, increments)
    except NoAnswer as error:
        # A brake that locks itself is refused by the line below, with its limit.
        group.settled()
        raise NoAnswer(f"{group.names}: {error}, the drum at rest") from error
    per_rotation = lever * (group.brake.spin / group.unit_force)
    return _HeldGroup(group, problem, per_rotation, friction, *loading)


def _loading(
    problem: FrictionalProblem, gap: Floats, friction: Floats, state: Ints, increments: int
) -> _Loading:
    """The increment in which the force is fully on, and the energy dissipated by slip up to it.

    Without gaps all quantities grow with the force, and one increment is exact. Otherwise the force
    grows like the cubes of whole numbers, since most changes happen under little force. An
    increment that does not settle from the present states, as under a force so small that one node
    or two bear it, is taken together with the next.

    Parameters
    ----------
    problem : the stick-slip problem under the full force
    gap : weighted gaps (n,) without force
    friction : friction coefficient (n,) of each node
    state : states (n,) to start from
    increments : number of increments

    Raises
    ------
    NoAnswer
        where the last increment does not settle
    """
    history, energy = History(np.zeros(len(gap)), np.zeros(len(gap))), 0.0
    shares = np.linspace(0, 1, max(increments, 1) + 1)[1:] ** 3 if gap.any() else np.ones(1)
    for share in shares:
        q_w = gap + share * (problem.q_w - gap)
        part = problem._replace(q_w=q_w, q_s=share * problem.q_s, h=share * problem.h)
        try:
            increment = stick_slip.solve(part, friction, history, state)
        except NoAnswer:
            if share == 1:
                raise
            continue
        energy += _slip_work(problem, increment, history)
        history, state = increment.history, increment.state
    return _Loading(increment, energy)


# The drum is turned


def _path(held: _HeldGroup, rotations: Floats) -> _HeldPath:
    """The path of a group through the rotations. Raises NoAnswer as `hold` does."""
    group, brake = held.group, held.group.brake
    increment, reached, energy = held.rest, 0.0, held.spent
    increments, spent = [], []
    for rotation in rotations:
        try:
            for step in held.turned(increment, reached, float(rotation)):
                energy += _slip_work(held.problem, step, increment.history)
                increment = step
        except NoAnswer as error:
            # A brake that locks itself is refused by the line below, with its limit.
            _under(group, brake if rotation > reached else brake.reversed()).settled()
            raise NoAnswer(f"{group.names}: {error}, turned by {rotation:.3g} rad") from error
        reached = float(rotation)
        increments.append(increment)
        spent.append(energy * group.unit_force**2)
    return _HeldPath(held, increments, spent, cache(partial(_sliding_answer, held)))


def turned(
    problem: FrictionalProblem,
    lever: Floats,
    friction: float | Floats,
    increment: Increment,
    start: float,
    end: float,
) -> Iterator[Increment]:
    """The increments from a converged one at the rotation `start` to the rotation `end`.

    It is one increment where its states settle, else parts of it, see HALVINGS.

    Parameters
    ----------
    problem : the stick-slip problem while the drum rests
    lever : growth (n,) of q_s per radian
    friction : friction coefficient of all nodes, or (n,) of each node
    increment : the converged increment
    start, end : rotations [rad]

    Raises
    ------
    NoAnswer
        where no part settles
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


def _under(group: ShoeGroup, brake: Brake) -> ShoeGroup:
    """The group at another rotation or friction of the drum, under which feet may slide otherwise."""
    return replace(group, brake=brake, senses=() if group.rough else group.senses)


def _slip_work(problem: FrictionalProblem, after: Increment, before: History) -> float:
    """The work of the tractions on the plastic slip of an increment, by its end values."""
    slip = after.s - before.s - problem.Q @ (after.t - before.t)
    return float(after.t @ slip)


def _state(brake: Brake, paths: list[_HeldPath], k: int, rotation: float) -> Hold:
    """The state of the brake at the rotation of number `k`, from the paths of all groups."""
    linings: dict[int, _LiningState] = {}
    torque, dissipated, notes = 0.0, 0.0, list[str]()
    for path in paths:
        dissipated += path.spent[k]
        notes += _other_moment_note(path, k)
        torque += path.held.torque(path.increments[k])
        linings |= _lining_states(path.held.group, path.increments[k])
    order = sorted(linings)
    arcs = [stick_slip.zones(linings[i].theta, linings[i].state) for i in order]
    return Hold(
        rotation=rotation,
        torque=torque,
        names=tuple(brake.shoes[i].name for i in order),
        theta=tuple(linings[i].theta for i in order),
        pressure=tuple(linings[i].pressure for i in order),
        traction=tuple(linings[i].traction for i in order),
        state=tuple(linings[i].state for i in order),
        stick=tuple(arc["stick"] for arc in arcs),
        slip=tuple(arc["slip"] for arc in arcs),
        dissipated=dissipated,
        notes=tuple(notes),
    )


def _lining_states(group: ShoeGroup, at: Increment) -> dict[int, _LiningState]:
    """The nodes of each lining of a group in an increment, by the position of the shoe."""
    size = group.unit_force
    states = {}
    for k, part in enumerate(group.node_ranges):
        frame = group.shoes[k].frame
        forward = slice(None, None, frame.sense)
        p, t = size * at.p[part], size * at.t[part]
        theta = frame.theta(group.bodies[k].line.phi)
        states[group.members[k]] = _LiningState(
            theta[forward], p[forward], t[forward], at.state[part][forward]
        )
    return states


# Full slip


def _sliding_answer(held: _HeldGroup, sense: int) -> _SlidingAnswer:
    """The answer under a sliding drum whose linings slip in the sense +1 or -1."""
    brake = held.group.brake
    group = _under(held.group, brake if sense == brake.spin else brake.reversed())
    try:
        group, contact = group.settled()
    except NoAnswer as error:
        return _SlidingAnswer(group, None, math.nan, str(error))
    torque = brake.friction * group.unit_force * float(group.levers.sum(axis=1) @ contact.p)
    return _SlidingAnswer(group, contact, sense * brake.spin * torque, "")


def _other_moment_note(path: _HeldPath, k: int) -> list[str]:
    """A line where all nodes slip one way and the moment is not that of `solve`: both, and why."""
    held, at = path.held, path.increments[k]
    sense = _full_slip_sense(held, at)
    if sense == 0:
        return []
    torque, sliding = held.torque(at), path.sliding(sense)
    if math.isclose(torque, sliding.torque, rel_tol=TWO_ANSWERS):
        return []
    surface = held.group.brake.surface
    unit, moving = surface.effect_unit, surface.moving
    text = f"{held.group.names}: at full slip the {surface.effect} is {torque:.6g} {unit}"
    if sliding.contact is None:
        return [f"{text}; solve has none: {sliding.why}"]
    text += f", by solve {sliding.torque:.6g} {unit}"
    feet = _other_feet(held, at, sliding.group, sliding.contact)
    if not feet:
        return [f"{text}: more than one answer"]
    ends = " and ".join(foot.came_to for foot in feet)
    places = " and ".join(foot.by_solve for foot in feet)
    return [
        f"{text}: the force came on while the {moving} was at rest and left {ends} along its abutment from where it "
        f"was without force; in solve the {moving} moves already as the force comes on, which leaves it at {places}"
    ]


def _full_slip_sense(held: _HeldGroup, at: Increment) -> int:
    """The sense +1 or -1 in which all touching nodes of the linings slip; 0 where some do not."""
    touching = set(at.state[: held.lining_nodes].tolist()) - {OPEN}
    if touching == {FORWARD}:
        return 1
    return -1 if touching == {BACKWARD} else 0


def _other_feet(
    held: _HeldGroup, at: Increment, group: ShoeGroup, contact: Contact
) -> list[_FootSlide]:
    """The feet on which friction acts otherwise at the end of a path than in a sliding answer.

    Parameters
    ----------
    held : the group of the path
    at : the end of the path
    group, contact : the sliding answer
    """
    size, feet = held.group.unit_force, []
    for node, k in enumerate(Feet.of(held.group).on, start=held.lining_nodes):
        shoe, (x, y) = group.shoes[k], group.reaction(contact, k)
        bearing, along = float(shoe.bearing @ (x, y)), float(shoe.bearing @ (y, -x))
        presses = at.p[node] > 0
        if presses and abs(at.t[node] / at.p[node] - along / bearing) <= OTHER_FRICTION:
            continue
        slide = float(group.coordinates(contact)[k][-1]) if group.each_sense[k] else 0.0
        # The slip counts against the slide; 0.0 less it is never printed as -0.
        came_to = _micrometres(size, 0.0 - at.s[node])
        by_solve = _micrometres(size, slide)
        feet.append(_FootSlide(f"the foot of shoe {shoe.name!r} {came_to}", by_solve))
    return feet


def _micrometres(force: float, slide: float) -> str:
    """A slide per newton [m/N] under a force [N], in words."""
    return f"{1e6 * force * slide:.6g} µm"


def full_slip_rotation(
    scene: PreparedModel, brake: Brake, *, increments: int = 20, penalty: float = PENALTY
) -> float:
    """A rotation of the drum [rad] after which every touching node slips.

    The moment there is that of the sliding drum.

    Parameters
    ----------
    scene : the prepared model
    brake : the brake
    increments : number of increments in which the force comes on, see `hold`
    penalty : factor alpha of the contact stiffness alpha E/t

    Raises
    ------
    NoAnswer
        self-locking with its limit, a shoe that does not touch, not converged
    """
    shoes = respond(scene, brake, penalty=penalty).shoes
    ends = []
    for held in _held_groups(scene, brake, increments, penalty):
        target = sum(shoes[i].torque for i in held.group.members)
        try:
            ends.append(_full_slip(held, target, FORWARD if brake.spin > 0 else BACKWARD))
        except NoAnswer as error:
            raise NoAnswer(f"{held.group.names}: {error}") from error
    return (1 + LATER) * max(ends)


def _full_slip(held: _HeldGroup, target: float, slipping: int) -> float:
    """A rotation [rad] after which all touching nodes have the state `slipping`.

    Full slip is an answer of the sliding drum. Raises NoAnswer where it is another answer than that
    with the moment `target` [N m], and where no rotation is found.
    """
    increment, reached, step, n = held.rest, 0.0, FIRST, held.lining_nodes
    for _ in range(MOST_INCREMENTS):
        before = held.torque(increment)
        *_, increment = held.turned(increment, reached, reached + step)
        torque, reached = held.torque(increment), reached + step
        if np.isin(increment.state[:n], [OPEN, slipping]).all():
            # A foot that sticks stands where its path has brought it, so that the moment may differ.
            has_feet = len(increment.state) > n
            if has_feet or math.isclose(torque, target, rel_tol=TWO_ANSWERS):
                return reached
            raise NoAnswer(
                f"more than one answer: held it comes to slip everywhere at {torque:.5g} N m, "
                f"at once it slides at {target:.5g} N m"
            )
        # The moment that is lacking, in steps like the last.
        lacking = (target - torque) / (torque - before) if torque > before else math.inf
        step = min(max(step * lacking, LATER * reached), reached / LATER)
    sticking = np.count_nonzero(increment.state[:n] == STICK)
    raise NoAnswer(
        f"not converged: after a rotation of {reached:.3g} rad {sticking} of {n} nodes still stick, "
        f"at {torque:.5g} of the sliding drum's {target:.5g} N m"
    )


# Plain data


def as_dict(states: list[Hold]) -> list[dict[str, Any]]:
    """States as plain data for JSON, in rad, N m, Pa and J; node states stand there by name."""
    return [
        {
            "rotation": state.rotation,
            "torque": state.torque,
            "dissipated": state.dissipated,
            "notes": list(state.notes),
            "shoes": [_lining_as_dict(state, i) for i in range(len(state.names))],
        }
        for state in states
    ]


def _lining_as_dict(state: Hold, i: int) -> dict[str, Any]:
    """One lining of a state as plain data."""
    names = {OPEN: "open", STICK: "stick", FORWARD: "slip", BACKWARD: "slip back"}
    return {
        "name": state.names[i],
        "theta": state.theta[i].tolist(),
        "pressure": state.pressure[i].tolist(),
        "traction": state.traction[i].tolist(),
        "state": [names[int(value)] for value in state.state[i]],
        "stick": [list(arc) for arc in state.stick[i]],
        "slip": [list(arc) for arc in state.slip[i]],
    }
