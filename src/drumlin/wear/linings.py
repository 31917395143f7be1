"""A brake as linings that wear: the contact problems of `wear`, from finite elements or the foundation model.

Besides shoes on hinges: rigid ones on a pivot of a lever, and on a guide along a radius, with the lining meshed.
"""

import math
from collections.abc import Iterable, Sequence
from typing import Literal, NamedTuple

import numpy as np

from drumlin.arrays import Floats
from drumlin.brake.drum_brake import Brake, Shoe
from drumlin.contact import active_set
from drumlin.errors import BadInput, NoAnswer
from drumlin.fem.assembly import Body, Scene
from drumlin.fem.group import grouped, turns_towards
from drumlin.foundation import model as foundation
from drumlin.foundation.post import shoe_angles
from drumlin.laws.hinged import pressing_moment
from drumlin.response.resultants import cross
from drumlin.wear.archard import WearInterface

Guide = Literal["hinge", "radius"]


class Surface(NamedTuple):
    """The lining of shoe `shoe` among the unknowns of its setup.

    `part`: its unknowns in all, `local`: in its interface, number `interface`; `rows`: its rows of that one's C;
    `theta` (n,) [rad] and `forward`: the slice that makes it grow; `order` of the interpolation; `approach` (n, k):
    closing of the gap
    per unit of each rigid motion.
    """

    shoe: int
    name: str
    interface: int
    part: slice
    local: slice
    rows: slice
    theta: Floats
    forward: slice
    order: int
    approach: Floats

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
        """K = E/t of the first lining that touches [Pa/m]; 1/(k K) is the unit of sliding distance."""
        lining = self.brake.shoes[self.surfaces[0].shoe].lining
        return lining.material.E / lining.thickness

    def part(self, interface: int) -> slice:
        """The unknowns of an interface among all."""
        parts = [surface.part for surface in self.surfaces if surface.interface == interface]
        return slice(parts[0].start, parts[-1].stop)


class Motions(NamedTuple):
    """Rigid motions of a shoe, in its frame: contact displacements (2n, k), and the actuation's work on each (k,)."""

    moved: Floats
    work: Floats


def fem_setup(scene: Scene, brake: Brake, *, penalty: float = math.inf, guide: Guide = "hinge") -> WearSetup:
    """The setup of a brake on a prepared scene of finite elements.

    guide: "hinge", the shoes turn about their hinges, and rigid ones about their pivots too; "radius", rigid shoes
    that move along the middle radius of their linings, the guide bearing what else acts on them.
    Raises BadInput, and NoAnswer where no shoe touches.
    """
    special = guide == "radius" or any(shoe.pivot for shoe in brake.shoes)
    if special and (scene.ring is not None or any(shoe.body or shoe.mesh for shoe in brake.shoes)):
        raise BadInput("a shoe on a guide or a pivot is worn in as a rigid one: leave out [shoe.body] and [drum.ring]")
    motions = [motions_of(body, shoe, guide) for body, shoe in zip(scene.bodies, brake.shoes, strict=True)]
    pressing = [
        turns_towards(body, shoe) if guide == "hinge" else bool(moves.work[0] > 0)
        for body, shoe, moves in zip(scene.bodies, brake.shoes, motions, strict=True)
    ]
    touching = [i for i, presses in enumerate(pressing) if presses]
    interfaces, surfaces = list[WearInterface](), list[Surface]()
    for group in grouped(scene, brake, touching, penalty):
        size, problem = group.unit_force, group.problem
        problem = problem._replace(q=size * problem.q, h=size * problem.h)  # newtons
        if special:
            problem = _moving(problem, group.bodies[0], brake, group.shoes[0], motions[group.members[0]])
        gap = np.concatenate(group.gaps)
        placed = [
            (i, shoe.frame.theta(body.line.phi), body.line.order, _approach(body, shoe, motions[i]))
            for i, body, shoe in zip(group.members, group.bodies, group.shoes, strict=True)
        ]
        surfaces += _surfaces(brake, surfaces, len(interfaces), placed)
        interfaces.append(
            WearInterface(
                problem=problem,
                loaded=problem.q - group.masses @ gap,
                weight=group.masses,
                pressure=np.ones(len(gap)),
                area=np.concatenate([body.coupling.area for body in group.bodies]),
                torque=brake.friction * np.concatenate([body.coupling.lever for body in group.bodies]),
            )
        )
    return _setup(brake, "fem", interfaces, surfaces)


def foundation_setup(brake: Brake, *, sections: int = foundation.SECTIONS, lift: Iterable[str] = ()) -> WearSetup:
    """The setup of a post brake on the foundation model; options as of foundation.solve. Raises BadInput, NoAnswer."""
    reason = foundation.why_not(brake)
    if reason is not None:
        raise BadInput(f"foundation does not apply to this brake: {reason}")
    names = foundation.lifted(brake, lift)
    touching = [i for i, shoe in enumerate(brake.shoes) if pressing_moment(shoe) > 0]
    together = brake.drum.ring is not None and "own-pressure" in names
    interfaces, surfaces = list[WearInterface](), list[Surface]()
    for group in [touching] if together and touching else [[i] for i in touching]:
        posts, _, problem = foundation.system(brake, group, sections, names)
        widths = [brake.shoes[i].lining.width for i in group]
        area = np.concatenate([b * brake.drum.radius * p.sector for b, p in zip(widths, posts, strict=True)])
        placed = [
            (i, shoe_angles(p.axis, brake.shoes[i], p.theta), 1, p.closing[:1].T)
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
                torque=brake.friction * brake.drum.radius * area,
            )
        )
    return _setup(brake, "foundation", interfaces, surfaces)


def motions_of(body: Body, shoe: Shoe, guide: Guide) -> Motions:
    """The rigid motions that a shoe has: its turn about the hinge, that about the pivot, or its way along a radius."""
    x, y = body.line.xy
    force, at = shoe.frame.to_shoe(shoe.actuation.vector), shoe.frame.to_shoe(shoe.actuation.point.xy)
    if guide == "radius":
        middle = sum(shoe.arc) / 2
        e = shoe.sign * np.array([math.cos(middle), math.sin(middle)])
        return Motions(np.tile(e, len(x))[:, None], np.array([float(e @ force)]))
    moved = [body.turned]
    work = [float(cross(at - np.array([shoe.pin.radius, 0.0]), force))]
    if shoe.pivot is not None:  # the actuation acts on the lever: it does no work where the shoe turns on its pivot
        u, v = shoe.frame.to_shoe(shoe.pivot.xy)
        moved.append(np.column_stack([v - y, x - u]).ravel())
        work.append(0.0)
    return Motions(np.column_stack(moved), np.array(work))


def _moving(problem: active_set.Problem, body: Body, brake: Brake, shoe: Shoe, motions: Motions) -> active_set.Problem:
    """The problem of a rigid shoe with these motions: C is what the contact does on them, against the actuation."""
    drag = brake.drag_on(shoe)
    approach = body.coupling.N @ motions.moved
    C = (drag * (body.coupling.T @ motions.moved) - approach).T
    return problem._replace(B=-approach, C=C, h=-motions.work)


def _approach(body: Body, shoe: Shoe, motions: Motions) -> Floats:
    c, s = np.cos(body.line.phi)[:, None], np.sin(body.line.phi)[:, None]
    return shoe.sign * (c * motions.moved[0::2] + s * motions.moved[1::2])


def _surfaces(
    brake: Brake, before: Sequence[Surface], interface: int, placed: list[tuple[int, Floats, int, Floats]]
) -> list[Surface]:
    """The surfaces of an interface's shoes: shoe, theta, order and approach of each."""
    offset, first, row, found = sum(len(s.theta) for s in before), 0, 0, []
    for i, theta, order, approach in placed:
        n, k = approach.shape
        found.append(
            Surface(
                shoe=i,
                name=brake.shoes[i].name,
                interface=interface,
                part=slice(offset + first, offset + first + n),
                local=slice(first, first + n),
                rows=slice(row, row + k),
                theta=theta,
                forward=slice(None, None, 1 if theta[-1] > theta[0] else -1),
                order=order,
                approach=approach,
            )
        )
        first, row = first + n, row + k
    return found


def _setup(brake: Brake, model: str, interfaces: list[WearInterface], surfaces: list[Surface]) -> WearSetup:
    if not interfaces:
        raise NoAnswer("no contact: no shoe is turned towards the drum, so that nothing wears")
    return WearSetup(brake, model, tuple(interfaces), tuple(surfaces))
