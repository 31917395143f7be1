"""Groups of shoes that must be solved together, and the answers of their contact problems.

A shoe on a rigid drum meets it alone. Shoes on an elastic ring feel each other, as do shoes that
share a force, so that they are solved together. All analyses of the contact (sliding, holding,
wear, sensitivity, self-locking) start from these groups.
"""

import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import product
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Bools, Floats
from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake, Shoe
from drumlin.contact import active_set, self_locking
from drumlin.fem.equilibrium import reach
from drumlin.fem.equilibrium.problems import GroupProblems
from drumlin.fem.equilibrium.sharing import NO_PUSH, WOULD_PULL
from drumlin.fem.preparation.bodies import Body, actuation
from drumlin.fem.preparation.scene import Scene
from drumlin.laws import rigid

FOOT_LEAVES = "no equilibrium, a foot leaves its abutment"
ELASTIC_BRAKE = "elastic as it is"
"""How the refusal of a self-locking brake names the elastic model, beside the rigid-shoe law."""
FRICTION_STEP = self_locking.LARGEST_FRICTION_STEP / 4
"""Largest step of the drum's friction coefficient between two checks of an answer that is followed.

A check asks how feet slide and whether shoes are still pushed. Above a coefficient of 1 the step is
relative to it. A foot that leaves its abutment and comes back within a step goes unnoticed; a
smaller step costs time.
"""
NEAR_POLE = 1e-4
"""Relative distance from the pole of the pressures up to which an answer is checked as above.

A change of the footing nearer to the pole moves the limit by less than this fraction, which is the
last of the four digits that are printed.
"""


class PullNeeded(NoAnswer):
    """The refusal of an answer in which a cam or a strut, which can only push, would have to pull."""


class FollowedEnd(NamedTuple):
    """The end of an answer that is followed in the friction coefficient of the drum.

    `limit`: the friction at which it ends. `lets_go`: the line that names the contact which would
    have to pull there although it can only push; empty where the answer ends otherwise.
    """

    limit: self_locking.Limit
    lets_go: str


class SettledGroup(NamedTuple):
    """A group with the senses of friction at its abutments that its answer has, and the answer."""

    group: "ShoeGroup"
    contact: active_set.Contact


class ShoeGroup(GroupProblems):
    """A group of shoes with its state, its contact problems and their answers."""

    def at_friction(self, friction: float) -> "ShoeGroup":
        """The group at another friction of the drum; its senses are then tried first."""
        return replace(self, brake=self.brake.model_copy(update={"friction": friction}))

    # The answer under given senses of friction at the abutments

    def answer(self, first: Bools | None = None) -> active_set.Contact:
        """The contact per newton of `unit_force`, from the contact set `first` (n,) if it is given.

        Raises NoAnswer: self-locking, no equilibrium, not converged, a turn too large for small
        displacements.
        """
        for k, shoe in enumerate(self.shoes):
            xy = self.bodies[k].line.xy
            reach.check_pin(shoe, xy, self.gaps[k], self.loads[k].moment)
        law = min(self.law(i) for i in self.members)
        try:
            contact = self_locking.answer(
                self.problem_at,
                self.brake.friction,
                first,
                self.areas,
                law=law,
                brake=ELASTIC_BRAKE,
            )
        except self_locking.PathEnded as error:
            refusal = self._pull_at(error.end)
            raise (
                PullNeeded(refusal) if refusal else NoAnswer(f"{self.names}: {error}")
            ) from error
        except NoAnswer as error:
            raise NoAnswer(f"{self.names}: {error}") from error
        for k, coordinates in enumerate(self.coordinates(contact)):
            turns = self.unit_force * coordinates
            reach.check_turns(self.shoes[k], self.each_sense[k], self.gaps[k], turns)
        return contact

    def law(self, i: int) -> float:
        """The locking friction of shoe `i` of the brake by the rigid-shoe law.

        The prepared model knows it for a hinged shoe that the drum drags the same way.
        """
        shoe, known = self.brake.shoes[i], self.scene.brake.shoes[i]
        hinged = shoe.held_by == known.held_by == "hinge"
        drag = self.brake.spin * shoe.frame.sense
        if hinged and drag == self.scene.brake.spin * known.frame.sense:
            return self.scene.laws[i]
        return rigid.locking_friction(self.brake, shoe)

    def _pull_at(self, end: self_locking.Limit) -> str:
        """The line that refuses an answer which ends because a shared force falls to zero, or "".

        The shoe leaves the drum there, and nothing locks: its cam or strut would have to pull it.
        """
        sharing = self._sharing_at(end.reached)
        return "" if sharing is None else self._pull(sharing.forces(end.last.p))

    def _pull(self, forces: Floats) -> str:
        """The line that refuses actuation forces (shoes,) of which one pulls; empty if all push."""
        i = int(forces.argmin())
        if forces[i] <= NO_PUSH * forces.max():
            return f"shoe {self.shoes[i].name!r}: {WOULD_PULL}"
        return ""

    # The answer with the senses of friction at the abutments that it has

    def settled(self, first: Bools | None = None) -> SettledGroup:
        """The group with the senses of friction at its abutments that its answer has, and the answer.

        The drum turns already as the force comes on. Friction opposes the whole slide of a foot
        from its place without force, or holds the foot there. The first senses that agree with
        their answer are taken, those of the rigid shoe first. Their order does not matter: no brake
        is known in which two choices agree. Raises NoAnswer as `answer` does, and where a foot
        would leave its abutment.
        """
        try:
            return self._first_footing(first)
        except NoAnswer as error:
            refusal = self._refusal(error)
            if refusal is error:
                raise
            raise refusal from error

    def _first_footing(self, first: Bools | None = None) -> SettledGroup:
        """As `settled`, but refused with the reason of the senses that are tried first."""
        failure = NoAnswer(f"{self.names}: {FOOT_LEAVES}")
        for number, group in enumerate(self.footings()):
            try:
                contact = group.answer(first)
            except NoAnswer as error:
                if number == 0:
                    failure = error
                continue
            if all(group.consistent(contact, k) for k in range(len(self.members))):
                return SettledGroup(group, contact)
        raise failure

    def footings(self) -> Iterator["ShoeGroup"]:
        """The group with each choice of senses at its abutments: its own first, or the rigid shoe's."""
        begin = self.senses or tuple(_sense(self.brake, shoe) for shoe in self.shoes)
        choices = []
        for own, shoe in zip(begin, self.shoes, strict=True):
            others = [sense for sense in shoe.senses if sense != own]
            choices.append((own, *others))
        for senses in product(*choices):
            yield self if senses == self.senses else replace(self, senses=senses)

    def consistent(self, contact: active_set.Contact, k: int) -> bool:
        """Whether the abutment of shoe `k` bears as an answer assumes; see `Held.stands`."""
        shoe = self.shoes[k]
        if shoe.abutment is None:
            return True
        slide = float(self.coordinates(contact)[k][-1])
        return shoe.stands(self.reaction(contact, k), self.each_sense[k], slide)

    def reaction(self, contact: active_set.Contact, k: int) -> Floats:
        """The force (2,) of the abutment on the foot of shoe `k`, per newton, by equilibrium."""
        shoe, body = self.shoes[k], self.bodies[k]
        drag, p = self.brake.drag_on(shoe), contact.p[self.node_ranges[k]]
        normal, dragged = body.forces @ p
        push = self.forces(contact.p)[k] * shoe.actuation.direction_vector
        return np.asarray(-shoe.frame.to_brake((drag * dragged - normal)[:2]) - push)

    def _refusal(self, failure: NoAnswer) -> NoAnswer:
        """The reason why a group does not settle.

        Where feet are rough it is the end of the answer that is followed while they slide.
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
        locked = self_locking.locks(friction, end.limit.friction, law=law, brake=ELASTIC_BRAKE)
        return NoAnswer(end.lets_go or f"{self.names}: {locked}")

    # The answer followed in the friction coefficient of the drum

    def followed(self, most: float) -> FollowedEnd:
        """The end, up to mu = `most`, of the answer that is followed in the friction of the drum.

        It begins at the least friction of the drum that has an answer. On its path a rough foot may
        begin to slide, stop, or slide the other way; from there the answer is followed with the new
        sense. Raises NoAnswer where there is no answer without friction of the drum, nor under any,
        as where it takes friction to press a foot on its abutment.
        """
        if not self.links and not self.cam and all(shoe.abutment is None for shoe in self.shoes):
            limit = self_locking.limit(self.sliding, most, areas=self.areas)
            return FollowedEnd(limit, lets_go="")
        low, (at, contact) = self._least_friction(most)
        end = self_locking.limit(at.sliding, most, (low, contact), self.areas)
        while low < (last := min(end.friction * (1 - NEAR_POLE), most)):
            high = min(low + FRICTION_STEP * max(1.0, low), last)
            after = at._pushing(high)
            # Under more friction the group may settle again, but the followed answer ends here.
            if after is None:
                return at._end_between(end, low, high)
            low = high
            if after.group.senses != at.senses:
                at, contact = after
                end = self_locking.limit(at.sliding, most, (low, contact), self.areas)
        return FollowedEnd(end, lets_go=at._pull_at(end))

    def _least_friction(self, most: float) -> tuple[float, SettledGroup]:
        """The least friction of the drum, to FRICTION_STEP, that has an answer, and the answer."""
        friction = 0.0
        while friction < most:
            found = self._pushing(friction)
            if found is not None:
                return friction, found
            friction += FRICTION_STEP * max(1.0, friction)
        # Without any answer, the line below raises the reason.
        return 0.0, self.at_friction(0.0)._first_footing()

    def _pushing(self, friction: float) -> SettledGroup | None:
        """The settled group at a friction of the drum; None without an answer in which all push."""
        try:
            found = self.at_friction(friction)._first_footing()
        except NoAnswer:
            return None
        pulls = found.group._pull(found.group.forces(found.contact.p))
        return None if pulls else found

    def _end_between(self, end: self_locking.Limit, low: float, high: float) -> FollowedEnd:
        """The end by bisection between two frictions, of which only the first has an answer."""
        at = self
        while high - low > self_locking.POLE_DISTANCE * high:
            middle = 0.5 * (low + high)
            after = at._pushing(middle)
            if after is None:
                high = middle
            else:
                low, at = middle, after.group
        limit = end._replace(friction=low, bounded=True, reached=low)
        return FollowedEnd(limit, at.at_friction(high)._lets_go())

    def _lets_go(self) -> str:
        """The line that names a contact which would have to pull under the present senses, or ""."""
        try:
            contact = self.answer()
        except PullNeeded as error:
            return str(error)
        except NoAnswer:
            return ""
        pull = self._pull(self.forces(contact.p))
        if pull:
            return pull
        for k, shoe in enumerate(self.shoes):
            if shoe.abutment is not None and not self._foot_presses(contact, k):
                return f"{self.names}: {FOOT_LEAVES}"
        return ""

    def _foot_presses(self, contact: active_set.Contact, k: int) -> bool:
        """Whether the foot of shoe `k` presses on its abutment in an answer."""
        return float(self.reaction(contact, k) @ self.shoes[k].bearing) > 0


def groups_of(scene: Scene, brake: Brake, penalty: float = math.inf) -> list[ShoeGroup]:
    """The shoes that are pressed on the drum, in groups that must be solved together.

    Raises NoAnswer where a cam presses only some of its shoes.
    """
    touching = pressed_shoes(scene, brake)
    if brake.actuation is not None and brake.actuation.is_cam:
        lacking = [shoe.name for i, shoe in enumerate(brake.shoes) if i not in touching]
        if lacking:
            raise NoAnswer(f"shoe {lacking[0]!r}: the cam does not press it")
    return grouped(scene, brake, touching, penalty)


def pressed_shoes(scene: Scene, brake: Brake) -> list[int]:
    """The positions of the shoes that their own forces, or struts from such shoes, press."""
    touching = set()
    for i, shoe in enumerate(brake.shoes):
        if pressed(scene.bodies[i], brake, shoe):
            touching.add(i)
    names = [shoe.name for shoe in brake.shoes]
    # The links of a chain stand in the order from the actuation on.
    for link in brake.links:
        if names.index(link.source) in touching:
            touching.add(names.index(link.to))
    return sorted(touching)


def grouped(
    scene: Scene, brake: Brake, touching: list[int], penalty: float = math.inf
) -> list[ShoeGroup]:
    """The shoes `touching` in groups: each alone, or all together.

    They are together where they meet through an elastic ring or share a force. A group without
    rough abutments gets its senses at once.
    """
    alone = (scene.ring is None or scene.apart) and brake.shares is None
    members: list[tuple[int, ...]] = [(i,) for i in touching]
    if not alone:
        members = [tuple(touching)] if touching else []
    groups = [ShoeGroup(scene, brake, each, penalty) for each in members]
    return [group if group.rough else replace(group, senses=group.each_sense) for group in groups]


def _sense(brake: Brake, shoe: Shoe) -> int:
    """The sense of friction at the abutment of the rigid shoe, which is tried first."""
    if len(shoe.senses) == 1:
        return 1
    try:
        footing = rigid.press(brake, shoe)
    except NoAnswer:
        return 1
    return 1 if footing is None else footing.sense


def pressed(body: Body, brake: Brake, shoe: Shoe) -> bool:
    """Whether the force presses the shoe on the drum, at one lining point at least."""
    if shoe.held_by == "hinge":
        return turns_towards(body, shoe)
    return shoe.actuation.force != 0 and rigid.bears(brake, shoe) >= 0


def turns_towards(body: Body, shoe: Shoe) -> bool:
    """Whether the force turns the shoe towards the drum, at one lining point at least."""
    if shoe.actuation.force == 0:
        return False
    _, moment = actuation(body, shoe)
    approach, _ = body.turning
    # A lever arm below 1e-14 of the lining's distance from the centre is round-off.
    turns = abs(moment) > 1e-14 * np.abs(body.line.xy).max()
    return bool(turns and (moment * approach > 0).any())
