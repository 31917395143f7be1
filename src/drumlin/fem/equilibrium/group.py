"""The shoes that meet the drum together, as one contact problem.

A shoe on a rigid drum meets it alone. Shoes on an elastic ring feel each other, so all that touch
it are solved together. Whatever is done with the contact (sliding, holding, wear, sensitivity,
self-locking) starts from here.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Bools, Floats, in_turn
from drumlin.base.errors import NoAnswer
from drumlin.base.lapack import block_diag
from drumlin.brake import clearance
from drumlin.brake.brake import Brake, Shoe
from drumlin.contact import active_set, self_locking
from drumlin.contact.equations import Problem
from drumlin.fem.equilibrium import reach
from drumlin.fem.equilibrium.motions import Motions, motions_of
from drumlin.fem.equilibrium.sharing import PULLED, WOULD_PULL, Pushed, Sharing, share
from drumlin.fem.preparation.bodies import ShoeSubstructure, actuation, contact_stiffness
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.laws import rigid

LEAVES = "no equilibrium, a foot leaves its abutment"
ELASTIC = "elastic as it is"
FRICTION_STEP = self_locking.STEP / 4
"""Step of the drum's friction, above 1 relative to it, after which feet are asked how they slide
and shoes whether they are pushed. A foot that leaves and comes back within one step is not seen.
"""
NEAR_POLE = 1e-4
"""Relative distance from the pole of the pressures up to which feet are asked how they slide. A
change nearer to the pole moves the limit by less than this, the last digit of four that are
printed.
"""
ROWS = 64  # of a matrix that are made at a time: of a large one no more stay near the processor


@dataclass(frozen=True)
class ShoeGroup:
    """The shoes `members` of a brake on a prepared scene, at the contact stiffness `penalty` E/t.

    All of its problem is per newton of `unit_force`, so that one force alone enters only through
    the gap. `senses`: how friction acts at the abutments, one of a shoe. They are empty until
    `settled` has found them. A group with a rough abutment has no problem before that.
    """

    scene: PreparedModel
    brake: Brake
    members: tuple[int, ...]
    penalty: float = math.inf
    senses: tuple[int, ...] = ()

    @property
    def each_sense(self) -> tuple[int, ...]:
        """The sense of each shoe's friction at its abutment, +1 of a shoe without.

        Raises RuntimeError where an abutment is rough and its sense is not known yet.
        """
        if not self.senses and self.rough:
            raise RuntimeError(
                f"{self.names}: friction at the abutment has no sense yet, ask for `settled`"
            )
        return self.senses or (1,) * len(self.members)

    @property
    def rough(self) -> bool:
        """Whether friction acts at an abutment of the group."""
        return any(len(shoe.senses) > 1 for shoe in self.shoes)

    @cached_property
    def motions(self) -> tuple[Motions, ...]:
        """The free motions of each shoe."""
        return tuple(
            motions_of(body, shoe, moment, sense)
            for body, shoe, (_, moment), sense in zip(
                self.bodies, self.shoes, self.loads, self.each_sense, strict=True
            )
        )

    @cached_property
    def rows(self) -> tuple[slice, ...]:
        """The motions of each shoe among those of the group."""
        return in_turn(motions.work.size for motions in self.motions)

    @cached_property
    def shoes(self) -> tuple[Shoe, ...]:
        """The shoes of the group."""
        return tuple(self.brake.shoes[i] for i in self.members)

    @cached_property
    def bodies(self) -> tuple[ShoeSubstructure, ...]:
        """Their condensed bodies."""
        return tuple(self.scene.bodies[i] for i in self.members)

    @cached_property
    def parts(self) -> tuple[slice, ...]:
        """The unknowns of each shoe among those of the group."""
        return in_turn(len(body.line.nodes) for body in self.bodies)

    @cached_property
    def unit_force(self) -> float:
        """The largest actuation force [N]."""
        return max(abs(shoe.actuation.force) for shoe in self.shoes)

    @property
    def names(self) -> str:
        """The shoes as a refusal names them."""
        return ", ".join(f"shoe {shoe.name!r}" for shoe in self.shoes)

    @cached_property
    def gaps(self) -> tuple[Floats, ...]:
        """Gaps (n_i,) [m] of the unloaded linings at their contact nodes."""
        return tuple(
            gap_of(body, self.brake, shoe)
            for body, shoe in zip(self.bodies, self.shoes, strict=True)
        )

    @cached_property
    def loads(self) -> tuple[tuple[Floats, float], ...]:
        """Factors (l,) of each body's load columns, and the moment about its pin, see `actuation`."""
        return tuple(
            actuation(body, shoe) for body, shoe in zip(self.bodies, self.shoes, strict=True)
        )

    @cached_property
    def stiffnesses(self) -> tuple[float, ...]:
        """Contact stiffness of each shoe per area [Pa/m]."""
        return tuple(contact_stiffness(shoe, self.penalty) for shoe in self.shoes)

    @cached_property
    def closings(self) -> tuple[tuple[Floats, Floats], ...]:
        """Of each shoe and the motions that its equilibria are tested on N u and T u (n_i, k)."""
        return tuple(
            body.rotation_closure
            if shoe.held_by == "hinge"
            else (body.coupling.N @ at.tested, body.coupling.T @ at.tested)
            for body, shoe, at in zip(self.bodies, self.shoes, self.motions, strict=True)
        )

    @cached_property
    def loaded(self) -> tuple[tuple[Floats, Floats, Floats], ...]:
        """q (n_i,), B (n_i, k) and h (k,) of each shoe: they hang on no friction coefficient."""
        found = []
        for body, shoe, at, gap, (load, _), (tested, _) in zip(
            self.bodies, self.shoes, self.motions, self.gaps, self.loads, self.closings, strict=True
        ):
            own = abs(shoe.actuation.force) / self.unit_force
            q = body.coupling.M @ (gap / self.unit_force) - own * (body.closure_by_load @ load)
            closing = tested if at.moved is at.tested else body.coupling.N @ at.moved
            found.append((q, -closing, -own * at.work))
        return tuple(found)

    @cached_property
    def levers(self) -> Floats:
        """(n, shoes) [m^3]: friction times this by the pressures is the torque of each shoe."""
        return np.asarray(block_diag(*(body.coupling.lever for body in self.bodies)).T)

    @cached_property
    def areas(self) -> Floats:
        """Area (n,) [m^2] of each contact node: times the pressures the contact force."""
        return np.concatenate([body.coupling.area for body in self.bodies])

    @cached_property
    def masses(self) -> Floats:
        """(n, n) [m^2]: what weighs a gap on the linings."""
        return np.asarray(block_diag(*(body.coupling.M for body in self.bodies)))

    @cached_property
    def ring(self) -> tuple[Floats, Floats] | None:
        """Square roots (m, n) of the ring's flexibility under pressure and under drag; None for a
        rigid drum.
        """
        ring = self.scene.ring
        if ring is None:
            return None
        return np.hstack([ring.pressed[i] for i in self.members]), np.hstack(
            [ring.dragged[i] for i in self.members]
        )

    @cached_property
    def problem(self) -> Problem:
        """Full slip, the drum dragging the linings by mu p, as one complementarity problem.

        The weighted gap  w = M (g + p/eps) - N u + N_ring u_ring  closes as the lining moves by u, elastically and by
        the shoe's free motions y, and opens as the ring moves by u_ring;  C p = h  are the equilibria in these motions.
        """
        return self.problem_at(self.brake.friction)

    def problem_at(self, friction: float) -> Problem:
        """`problem` at another friction coefficient; linear in it."""
        sharing = self._sharing_at(friction)
        return self.blocks(friction) if sharing is None else sharing.problem

    @cached_property
    def links(self) -> list[tuple[int, int]]:
        """The struts between its shoes, (from, to)."""
        names = [shoe.name for shoe in self.shoes]
        return [
            (names.index(link.source), names.index(link.to))
            for link in self.brake.links
            if link.to in names
        ]

    @cached_property
    def cam(self) -> list[int]:
        """The shoes whose tips a cam moves alike; none without one."""
        drive, behind = self.brake.actuation, [to for _, to in self.links]
        return (
            [k for k in range(len(self.shoes)) if k not in behind] if drive and drive.is_cam else []
        )

    @cached_property
    def total(self) -> float:
        """The sum of the cam's forces, per newton of `unit_force`."""
        return (
            self.brake.actuation.total / self.unit_force
            if self.brake.actuation and self.cam
            else 0.0
        )

    def pushed(self, friction: float) -> list[Pushed]:
        """What each shoe is as its force pushes it, per newton, at a friction coefficient; linear
        in it.
        """
        return [self._pushed_shoe(k, friction) for k in range(len(self.shoes))]

    @cached_property
    def sharing(self) -> Sharing | None:
        """How the shoes share forces by struts and a cam; None where each has its own."""
        return self._sharing_at(self.brake.friction)

    def _sharing_at(self, friction: float) -> Sharing | None:
        if not self.links and not self.cam:
            return None
        return share(
            self.blocks(friction),
            self.pushed(friction),
            self.own_forces,
            self.links,
            self.cam,
            self.total,
        )

    def _pushed_shoe(self, k: int, friction: float) -> Pushed:
        body, shoe, motions = self.bodies[k], self.shoes[k], self.motions[k]
        drag = self._drag_on(shoe, friction)
        load, _ = self.loads[k]
        tip = -(load @ body.closure_by_load.T) + (
            0.0
            if body.load_motion_by_friction is None
            else drag * (load @ body.load_motion_by_friction)
        )
        contact = (drag * body.forces[1] - body.forces[0])[:2].T  # (n, 2) per pressure
        bearing = (
            np.zeros(len(tip))
            if shoe.abutment is None
            else -shoe.frame.to_brake(contact) @ shoe.bearing
        )
        direct = (
            0.0 if shoe.abutment is None else -float(shoe.bearing @ shoe.actuation.direction_vector)
        )
        return Pushed(
            part=self.parts[k], rows=self.rows[k], opened=-(body.closure_by_load @ load), tip=tip,
            yields=float(load @ body.load_motion_by_load @ load), work=motions.work, moves=motions.tip, bearing=bearing,
            direct=direct,
        )  # fmt: skip

    @cached_property
    def own_forces(self) -> Floats:
        """Their own actuation forces (shoes,), per newton."""
        return np.array([shoe.actuation.force for shoe in self.shoes]) / self.unit_force

    def forces(self, p: Floats) -> Floats:
        """The actuation forces (shoes,) under the pressures p (n,), both per newton."""
        return self.own_forces if self.sharing is None else self.sharing.forces(p)

    def amounts(self, found: active_set.Contact) -> list[Floats]:
        """The free motions of each shoe in an answer, per newton."""
        y = found.y if self.sharing is None else self.sharing.amounts(found.p, found.y)
        return [y[rows] for rows in self.rows]

    def _drag_on(self, shoe: Shoe, friction: float) -> float:
        return friction * self.brake.spin * shoe.frame.sense

    def blocks(self, friction: float) -> Problem:
        """The problem at a friction coefficient with the forces of each shoe's own actuation."""
        parts = [self._shoe_problem(k, friction) for k in range(len(self.members))]
        if self.ring is None and len(parts) == 1:
            return parts[0]
        A = block_diag(*(part.A for part in parts))
        if self.ring is not None:
            pressed, dragged = self.ring
            A += pressed.T @ (pressed + friction * self.brake.spin * dragged)
        return Problem(
            A=A,
            q=np.concatenate([part.q for part in parts]),
            B=block_diag(*(part.B for part in parts)),
            C=block_diag(*(part.C for part in parts)),
            h=np.concatenate([part.h for part in parts]),
        )

    def _shoe_problem(self, k: int, friction: float) -> Problem:
        drag = self._drag_on(self.shoes[k], friction)
        (q, B, h), (pressed, dragged) = self.loaded[k], self.closings[k]
        A = _yielding(self.bodies[k], drag, self.stiffnesses[k])
        return Problem(A, q, B, (drag * dragged - pressed).T, h)

    @property
    def sliding(self) -> self_locking.Sliding:
        """Full slip at every friction coefficient; the scene must be prepared with friction."""
        return self_locking.Sliding.through(self.problem_at(0.0), self.problem_at(1.0))

    def answer(self, first: Bools | None = None) -> active_set.Contact:
        """The contact per newton of `unit_force`, from the contact set `first` (n,) where there is
        one.

        Raises NoAnswer: self-locking, no equilibrium, not converged, a turn too large for small
        displacements.
        """
        for body, shoe, gap, load in zip(
            self.bodies, self.shoes, self.gaps, self.loads, strict=True
        ):
            reach.check_pin(shoe, body.line.xy, gap, load[1])
        law = min(self.law(i) for i in self.members)
        try:
            found = self_locking.answer(
                self.problem_at, self.brake.friction, first, self.areas, law=law, brake=ELASTIC
            )
        except NoAnswer as error:
            pulled = self._pulled_at(error.end) if isinstance(error, self_locking.Ended) else ""
            raise (Pulled(pulled) if pulled else NoAnswer(f"{self.names}: {error}")) from error
        for shoe, sense, gap, amounts in zip(
            self.shoes, self.each_sense, self.gaps, self.amounts(found), strict=True
        ):
            reach.check_turns(shoe, sense, gap, self.unit_force * amounts)
        return found

    def _pulled_at(self, end: self_locking.Limit) -> str:
        """As `_pulled`, of an answer that ends: a force that shoes share may have fallen to nothing
        there.

        The shoe leaves the drum then, and nothing locks: its cam or strut would have to pull it.
        """
        sharing = self._sharing_at(end.reached)
        return "" if sharing is None else self._pulled(sharing.forces(end.last.p))

    def _pulled(self, forces: Floats) -> str:
        """The line that refuses shoes of which what pushes one would have to pull; empty where all
        are pushed.
        """
        i = int(forces.argmin())
        return (
            f"shoe {self.shoes[i].name!r}: {WOULD_PULL}"
            if forces[i] <= PULLED * forces.max()
            else ""
        )

    def law(self, i: int) -> float:
        """mu_lock of a shoe by the rigid-shoe law: that of the scene for a hinged one dragged the
        same way.
        """
        (shoe, spin), (known, other) = (
            (brake.shoes[i], brake.spin) for brake in (self.brake, self.scene.brake)
        )
        same = (
            shoe.held_by == known.held_by == "hinge"
            and spin * shoe.frame.sense == other * known.frame.sense
        )
        return self.scene.laws[i] if same else rigid.locking_friction(self.brake, shoe)

    def settled(self, first: Bools | None = None) -> tuple["ShoeGroup", active_set.Contact]:
        """The group with the friction at its abutments as its answer has it, and that answer.

        The drum turns already as the force comes on. Friction opposes the whole slide of a foot
        from where it stood without force, or holds the foot there. The first senses that stand are
        taken, those of the rigid shoe first; the order does not matter, for no brake is known of
        which two stand. Raises NoAnswer as `answer` does, and where a foot would leave its
        abutment.
        """
        try:
            return self._standing(first)
        except NoAnswer as error:
            refusal = self._refusal(error)
            if refusal is error:
                raise
            raise refusal from error

    def _standing(self, first: Bools | None = None) -> tuple["ShoeGroup", active_set.Contact]:
        """`settled`, where it is refused with the reason of the senses that are tried first."""
        failure = NoAnswer(f"{self.names}: {LEAVES}")
        for k, group in enumerate(self.ways()):
            try:
                found = group.answer(first)
            except NoAnswer as error:
                if k == 0:
                    failure = error
                continue
            if all(group.consistent(found, i) for i in range(len(self.members))):
                return group, found
        raise failure

    def ways(self) -> Iterator["ShoeGroup"]:
        """The group with every way in which friction may act at its abutments: its own first, else
        the rigid shoe's.
        """
        begin = self.senses or tuple(_sense(self.brake, shoe) for shoe in self.shoes)
        choices = [
            (own, *(s for s in shoe.senses if s != own))
            for own, shoe in zip(begin, self.shoes, strict=True)
        ]
        for senses in product(*choices):
            yield self if senses == self.senses else replace(self, senses=senses)

    def _refusal(self, failure: NoAnswer) -> NoAnswer:
        """Why a group does not settle: where feet are rough, what ends the answer that is followed
        as they slide.
        """
        if not self.rough:
            return failure
        friction = self.brake.friction
        try:
            end = self.followed(friction)
        except NoAnswer:
            return failure
        if not end.limit.friction < friction:
            return failure
        law = min(self.law(i) for i in self.members)
        locked = self_locking.locks(friction, end.limit.friction, law=law, brake=ELASTIC)
        return NoAnswer(end.lets_go or f"{self.names}: {locked}")

    def followed(self, most: float) -> "Followed":
        """The end, up to mu = `most`, of the answer that is followed from the least friction of the
        drum that has one.

        On the way a rough foot may begin to slide, stop or slide the other way. From there on the
        answer is followed with its friction as it is then. Raises NoAnswer where there is no answer
        without friction of the drum, nor under any, as where it takes friction to press a foot on
        its abutment.
        """
        if not self.links and not self.cam and all(shoe.abutment is None for shoe in self.shoes):
            return Followed(self_locking.limit(self.sliding, most, areas=self.areas), lets_go="")
        low, (at, found) = self._first(most)
        end = self_locking.limit(at.sliding, most, (low, found), self.areas)
        while low < (last := min(end.friction * (1 - NEAR_POLE), most)):
            high = min(low + FRICTION_STEP * max(1.0, low), last)
            after = at._pushing(high)
            # Under more friction an answer may stand again, but the one that is followed has ended
            # here.
            if after is None:
                return at._ended(end, low, high)
            low = high
            if after[0].senses != at.senses:
                at, found = after
                end = self_locking.limit(at.sliding, most, (low, found), self.areas)
        return Followed(end, lets_go=at._pulled_at(end))

    def at_friction(self, friction: float) -> "ShoeGroup":
        """The group at another friction of the drum; its senses are then those to try first."""
        return replace(self, brake=self.brake.model_copy(update={"friction": friction}))

    def _first(self, most: float) -> tuple[float, tuple["ShoeGroup", active_set.Contact]]:
        """The least friction of the drum under which the group settles, to FRICTION_STEP, and its
        answer there.
        """
        friction = 0.0
        while friction < most:
            found = self._pushing(friction)
            if found is not None:
                return friction, found
            friction += FRICTION_STEP * max(1.0, friction)
        return 0.0, self.at_friction(0.0)._standing()  # raises: it says why there is none

    def _pushing(self, friction: float) -> tuple["ShoeGroup", active_set.Contact] | None:
        """The settled group at a friction of the drum and its answer; None without one, or where
        one is pulled that can only be pushed.
        """
        try:
            at, found = self.at_friction(friction)._standing()
        except NoAnswer:
            return None
        return None if at._pulled(at.forces(found.p)) else (at, found)

    def _ended(self, end: self_locking.Limit, low: float, high: float) -> "Followed":
        """The end between two frictions, an answer at the first of them only."""
        at = self
        while high - low > self_locking.CLOSE * high:
            middle = 0.5 * (low + high)
            after = at._pushing(middle)
            low, high = (low, middle) if after is None else (middle, high)
            at = at if after is None else after[0]
        return Followed(
            end._replace(friction=low, bounded=True, reached=low), at.at_friction(high)._lets_go()
        )

    def _lets_go(self) -> str:
        """The line that says what would have to pull, with the senses at hand, that can only push;
        empty if nothing.
        """
        try:
            found = self.answer()
        except Pulled as error:
            return str(error)
        except NoAnswer:
            return ""
        feet = [(k, shoe) for k, shoe in enumerate(self.shoes) if shoe.abutment is not None]
        presses = all(float(self.reaction(found, k) @ shoe.bearing) > 0 for k, shoe in feet)
        return self._pulled(self.forces(found.p)) or ("" if presses else f"{self.names}: {LEAVES}")

    def consistent(self, found: active_set.Contact, k: int) -> bool:
        """Whether the abutment of shoe `k` bears as an answer has it; see `Held.stands`."""
        shoe = self.shoes[k]
        if shoe.abutment is None:
            return True
        return shoe.stands(
            self.reaction(found, k), self.each_sense[k], float(self.amounts(found)[k][-1])
        )

    def reaction(self, found: active_set.Contact, k: int) -> Floats:
        """The force (2,) of the abutment of shoe `k` on its foot, per newton, by equilibrium of an
        answer.
        """
        shoe, body = self.shoes[k], self.bodies[k]
        drag, p = self.brake.drag_on(shoe), found.p[self.parts[k]]
        normal, dragged = body.forces @ p
        push = self.forces(found.p)[k] * shoe.actuation.direction_vector
        return np.asarray(-shoe.frame.to_brake((drag * dragged - normal)[:2]) - push)


class Pulled(NoAnswer):
    """What pushes a shoe, a cam or a strut, would have to pull it."""


class Followed(NamedTuple):
    """Where the answer ends that is followed in friction: the `limit`; and where it ends because
    something would have to pull that can only push, `lets_go`, the line that says what, else empty.
    """

    limit: self_locking.Limit
    lets_go: str


def _yielding(body: ShoeSubstructure, drag: float, stiffness: float) -> Floats:
    """A (n, n): what pressures take from the weighted gaps, the penalty's compliance included."""
    pressed, dragged, M = body.closure_by_pressure, body.closure_by_friction, body.coupling.M
    A = np.empty(M.shape)
    for first in range(0, len(A), ROWS):
        rows = slice(first, first + ROWS)
        part = np.divide(M[rows], stiffness, out=A[rows])
        part -= pressed[rows]
        if dragged is not None:
            part -= drag * dragged[rows]
    return A


def groups_of(scene: PreparedModel, brake: Brake, penalty: float = math.inf) -> list[ShoeGroup]:
    """The shoes that the actuation turns towards the drum, in groups that must be solved together."""
    touching = pressed_shoes(scene, brake)
    if brake.actuation is not None and brake.actuation.is_cam:
        lacking = [shoe.name for i, shoe in enumerate(brake.shoes) if i not in touching]
        if lacking:
            raise NoAnswer(f"shoe {lacking[0]!r}: the cam does not press it")
    return grouped(scene, brake, touching, penalty)


def pressed_shoes(scene: PreparedModel, brake: Brake) -> list[int]:
    """The shoes that their forces press on the drum, and those that struts from them push."""
    touching = {i for i, shoe in enumerate(brake.shoes) if pressed(scene.bodies[i], brake, shoe)}
    names = [shoe.name for shoe in brake.shoes]
    for link in brake.links:  # a chain is named from the actuation on
        if names.index(link.source) in touching:
            touching.add(names.index(link.to))
    return sorted(touching)


def grouped(
    scene: PreparedModel, brake: Brake, touching: list[int], penalty: float = math.inf
) -> list[ShoeGroup]:
    """The shoes `touching` in groups: each alone, or all together where they meet through an
    elastic ring or share a force.
    """
    alone = (scene.ring is None or scene.apart) and brake.shares is None
    groups = [(i,) for i in touching] if alone else [tuple(touching)] if touching else []
    made = [ShoeGroup(scene, brake, members, penalty) for members in groups]
    return [group if group.rough else replace(group, senses=group.each_sense) for group in made]


def _sense(brake: Brake, shoe: Shoe) -> int:
    """How friction acts where the rigid shoe is held: what is tried first of the elastic one."""
    if len(shoe.senses) == 1:
        return 1
    try:
        found = rigid.press(brake, shoe)
    except NoAnswer:
        return 1
    return 1 if found is None else found.sense


def pressed(body: ShoeSubstructure, brake: Brake, shoe: Shoe) -> bool:
    """Whether the force presses the shoe on the drum, at one lining point at least."""
    if shoe.held_by == "hinge":
        return turns_towards(body, shoe)
    return shoe.actuation.force != 0 and rigid.bears(brake, shoe) >= 0


def turns_towards(body: ShoeSubstructure, shoe: Shoe) -> bool:
    """Whether the force turns the shoe towards the drum, at one lining point at least."""
    if shoe.actuation.force == 0:
        return False
    _, moment = actuation(body, shoe)
    approach, _ = body.rotation_closure
    return bool(abs(moment) > 1e-14 * np.abs(body.line.xy).max() and (moment * approach > 0).any())


def gap_of(body: ShoeSubstructure, brake: Brake, shoe: Shoe) -> Floats:
    """Gap of the unloaded lining at the contact nodes (n,) [m]: off the drum's radius, clearance
    and misfit.
    """
    return gap_at(body.line.xy, body.line.phi, brake, shoe)


def gap_at(xy: Floats, phi: Floats, brake: Brake, shoe: Shoe) -> Floats:
    """Gap [m] of the unloaded lining at the points xy (2, ...) [m] of its mesh, at the angles phi
    (...) there.
    """
    theta, radius = shoe.frame.theta(phi), brake.size
    off = shoe.off(xy, radius)
    return np.where(np.abs(off) < 1e-12 * radius, 0.0, off) + clearance.gap(
        brake, shoe, theta
    )  # 0.0: not round-off
