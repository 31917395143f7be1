"""A brake as linings that wear: the contact problems of `wear`, from finite elements or the foundation model.

However the shoes are held and pushed.
"""

import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple, TypeVar

import numpy as np

from drumlin.arrays import Floats
from drumlin.brake.drum_brake import Brake, Shoe
from drumlin.brake.file import vary
from drumlin.brake.plane_brake import FlatBrake
from drumlin.brake.support import Meshed
from drumlin.errors import BadInput, NoAnswer
from drumlin.fem.assembly import Body, Scene
from drumlin.fem.group import groups_of
from drumlin.fem.motions import Motions
from drumlin.foundation import model as foundation
from drumlin.foundation.post import shoe_angles
from drumlin.laws.hinged import pressing_moment
from drumlin.wear.archard import WearInterface

B = TypeVar("B", bound=Brake | FlatBrake)


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

    @property
    def flat(self) -> bool:
        """Whether its linings lie on a plane; then its torque is the braking force [N]."""
        return any(shoe.flat for shoe in self.brake.shoes)

    @property
    def unit(self) -> float:
        """What theta counts in: 1 rad, on a plane the unit of the `unrolled` brake [m]."""
        return self.brake.drum.radius if self.flat else 1.0

    @property
    def motion(self) -> str:
        """What moves, in words."""
        return f"body slides along {'+x' if self.brake.spin > 0 else '-x'}" if self.flat else self.brake.motion

    def part(self, interface: int) -> slice:
        """The unknowns of an interface among all."""
        parts = [surface.part for surface in self.surfaces if surface.interface == interface]
        return slice(parts[0].start, parts[-1].stop)


def fem_setup(scene: Scene, brake: Brake, *, penalty: float = math.inf) -> WearSetup:
    """The setup of a brake on a prepared scene of finite elements. Raises NoAnswer where no shoe touches."""
    interfaces, surfaces = list[WearInterface](), list[Surface]()
    for group in groups_of(scene, brake, penalty):
        size, problem = group.unit_force, group.problem
        problem = problem._replace(q=size * problem.q, h=size * problem.h)  # newtons
        gap = np.concatenate(group.gaps)
        placed = [
            (i, shoe.frame.theta(body.line.phi), body.line.order, _approach(body, motions, shoe))
            for i, body, shoe, motions in zip(group.members, group.bodies, group.shoes, group.motions, strict=True)
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


def guided(brake: B) -> B:
    """The brake with its shoes on guides along the middle radius of their linings, on a plane along its normal, which
    bear all else."""
    held = {"hinge": None, "pivot": None, "abutment": None}

    def way(shoe: Meshed) -> float:
        return shoe.lining.middle + (shoe.sign < 0) * math.pi if isinstance(shoe, Shoe) else -math.pi / 2

    return vary(
        brake,
        {
            f"shoe[{i}].{key}": value
            for i, shoe in enumerate(brake.shoes)
            for key, value in (held | {"guide": {"direction": way(shoe)}}).items()
        },
    )


def _approach(body: Body, motions: Motions, shoe: Shoe) -> Floats:
    if shoe.flat:
        return -motions.moved[1::2]
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
