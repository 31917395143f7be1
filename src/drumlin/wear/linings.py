"""A brake as linings that wear: the contact problems of `wear`, from finite elements or the
foundation model.

However the shoes are held and pushed.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import NamedTuple, TypeVar

import numpy as np

from drumlin.arrays import Bools, Floats
from drumlin.brake.brake import Brake
from drumlin.brake.fields import rows_of
from drumlin.brake.file import vary
from drumlin.contact.active_set import Contact
from drumlin.contact.equations import Problem
from drumlin.errors import BadInput, NoAnswer
from drumlin.fem.assembly import Scene
from drumlin.fem.group import ShoeGroup, groups_of
from drumlin.foundation import model as foundation
from drumlin.foundation.post import shoe_angles
from drumlin.laws.hinged import pressing_moment
from drumlin.wear.archard import Footing, WearInterface, from_soft

B = TypeVar("B", bound=Brake)


class Surface(NamedTuple):
    """The lining of shoe `shoe` among the unknowns of its setup.

    `part`: its unknowns in all, `local`: in its interface, number `interface`; `theta` (n,) [rad]
    and `forward`: the slice that makes it grow; `order` of the interpolation.
    """

    shoe: int
    name: str
    interface: int
    part: slice
    local: slice
    theta: Floats
    forward: slice
    order: int

    def along(self, values: Floats) -> Floats:
        """Values (n,) of this lining, by growing theta, of those of all unknowns."""
        return values[self.part][self.forward]

    @property
    def angles(self) -> Floats:
        """theta (n,) [rad], growing."""
        return self.theta[self.forward]


class WearSetup(NamedTuple):
    """A brake ready to be worn in: its interfaces, and where each lining lies in them."""

    brake: Brake
    model: str
    interfaces: tuple[WearInterface, ...]
    surfaces: tuple[Surface, ...]

    @property
    def stiffness(self) -> float:
        """K = E/t of the first lining that touches [Pa/m], E through its thickness; 1/(k K) is the
        unit of sliding distance."""
        lining = self.brake.shoes[self.surfaces[0].shoe].lining
        return lining.material.E_through / lining.thickness

    def part(self, interface: int) -> slice:
        """The unknowns of an interface among all."""
        parts = [surface.part for surface in self.surfaces if surface.interface == interface]
        return slice(parts[0].start, parts[-1].stop)


def fem_setup(scene: Scene, brake: Brake, *, penalty: float = math.inf) -> WearSetup:
    """The setup of a brake on a prepared scene of finite elements. Raises NoAnswer where no shoe
    touches.
    """
    interfaces, surfaces = list[WearInterface](), list[Surface]()
    for group in groups_of(scene, brake, penalty):
        placed = [
            (i, shoe.frame.theta(body.line.phi), body.line.order)
            for i, body, shoe in zip(group.members, group.bodies, group.shoes, strict=True)
        ]
        surfaces += _surfaces(brake, surfaces, len(interfaces), placed)
        interfaces.append(_interface(group))
    return _setup(brake, "fem", interfaces, surfaces)


def _interface(group: ShoeGroup) -> WearInterface:
    """The linings of a group, with all their footings."""
    first, *others = group.ways()
    senses = [way.each_sense for way in (first, *others)]
    problem, gap = _in_newtons(first), np.concatenate(group.gaps)

    def settle(depth: Floats) -> tuple[int, Bools]:
        worn = replace(first, brake=_worn_by(group, depth))
        try:
            settled, found = worn.settled()
        except NoAnswer:
            touching = from_soft(worn.problem, worn.masses)
            if touching is None:
                raise
            settled, found = worn.settled(touching)
        return senses.index(settled.each_sense), found.active

    return WearInterface(
        problem=problem,
        loaded=problem.q - group.masses @ gap,
        weight=group.masses,
        pressure=np.ones(len(gap)),
        area=np.concatenate([body.coupling.area for body in group.bodies]),
        torque=group.brake.friction
        * np.concatenate([body.coupling.lever for body in group.bodies]),
        stands=partial(_stands, first),
        others=tuple(Footing(_in_newtons(way), partial(_stands, way)) for way in others),
        settle=settle,
    )


def _worn_by(group: ShoeGroup, depth: Floats) -> Brake:
    """The brake of a group with its linings worn by a depth (n,) [m] at their unknowns."""
    depths = {}
    for k, part in enumerate(group.parts):
        frame = group.shoes[k].frame
        forward = slice(None, None, frame.sense)
        theta = frame.theta(group.bodies[k].line.phi)
        depths[group.members[k]] = theta[forward], depth[part][forward]
    return worn_by(group.brake, depths)


def worn_by(brake: Brake, depths: Mapping[int, tuple[Floats, Floats]]) -> Brake:
    """The brake with the depth worn off added to the clearance of its linings.

    depths: for each worn lining, by the number of its shoe, growing angles (n,) [rad] and the depth
    (n,) [m] at these angles.
    """
    shoes = list(brake.shoes)
    for i, (theta, depth) in depths.items():
        lining = shoes[i].lining
        clearance = rows_of(theta, lining.clearance_at(theta) + depth)
        worn = lining.model_copy(update={"clearance": clearance})
        shoes[i] = shoes[i].model_copy(update={"lining": worn})
    return brake.model_copy(update={"shoes": tuple(shoes)})


def _in_newtons(group: ShoeGroup) -> Problem:
    size, problem = group.unit_force, group.problem
    return problem._replace(q=size * problem.q, h=size * problem.h)


def _stands(group: ShoeGroup, found: Contact) -> bool:
    """Whether the answer of a group, in newtons, allows the friction at its abutments."""
    unit = replace(found, p=found.p / group.unit_force, y=found.y / group.unit_force)
    return all(group.consistent(unit, k) for k in range(len(group.members)))


def foundation_setup(
    brake: Brake, *, sections: int = foundation.RING_SECTIONS, lift: Iterable[str] = ()
) -> WearSetup:
    """The setup of a post brake on the foundation model; options as of foundation.solve. Raises
    BadInput, NoAnswer.
    """
    reason = foundation.why_not(brake)
    if reason is not None:
        raise BadInput(f"foundation does not apply to this brake: {reason}")
    names = foundation.lifted(brake, lift)
    touching = [i for i, shoe in enumerate(brake.shoes) if pressing_moment(shoe) > 0]
    together = brake.ring is not None and "own-pressure" in names
    interfaces, surfaces = list[WearInterface](), list[Surface]()
    for group in [touching] if together and touching else [[i] for i in touching]:
        posts, _, problem = foundation.system(brake, group, sections, names)
        widths = [brake.shoes[i].lining.width for i in group]
        area = np.concatenate(
            [b * brake.size * p.sector for b, p in zip(widths, posts, strict=True)]
        )
        placed = [
            (i, shoe_angles(p.axis, brake.shoes[i], p.theta), 1)
            for i, p in zip(group, posts, strict=True)
        ]
        surfaces += _surfaces(brake, surfaces, len(interfaces), placed)
        interfaces.append(
            WearInterface(
                problem=problem,
                loaded=problem.q - np.concatenate([p.gap for p in posts]),
                weight=np.eye(len(area)),
                pressure=1 / area,
                area=area,
                torque=brake.friction * brake.size * area,
            )
        )
    return _setup(brake, "foundation", interfaces, surfaces)


def guided(brake: B) -> B:
    """The brake with its shoes on guides along the middle radius of their linings, on a plane along
    its normal, which bear all else.
    """
    held = {"hinge": None, "pivot": None, "abutment": None}

    return vary(
        brake,
        {
            f"shoe[{i}].{key}": value
            for i, shoe in enumerate(brake.shoes)
            for key, value in (held | {"guide": {"direction": shoe.closing}}).items()
        },
    )


def _surfaces(
    brake: Brake, before: Sequence[Surface], interface: int, placed: list[tuple[int, Floats, int]]
) -> list[Surface]:
    """The surfaces of an interface's shoes: shoe, theta and order of each."""
    offset, first, found = sum(len(s.theta) for s in before), 0, []
    for i, theta, order in placed:
        n = len(theta)
        found.append(
            Surface(
                shoe=i,
                name=brake.shoes[i].name,
                interface=interface,
                part=slice(offset + first, offset + first + n),
                local=slice(first, first + n),
                theta=theta,
                forward=slice(None, None, 1 if theta[-1] > theta[0] else -1),
                order=order,
            )
        )
        first += n
    return found


def _setup(
    brake: Brake, model: str, interfaces: list[WearInterface], surfaces: list[Surface]
) -> WearSetup:
    if not interfaces:
        raise NoAnswer("no contact: no shoe is turned towards the drum, so that nothing wears")
    return WearSetup(brake, model, tuple(interfaces), tuple(surfaces))
