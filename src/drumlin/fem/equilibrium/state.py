"""The state of a group of shoes: its members, their substructures, gaps, loads and rigid-body modes.

Nothing in this module depends on the friction coefficient of the drum.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats, in_turn
from drumlin.base.lapack import block_diag
from drumlin.brake import clearance
from drumlin.brake.brake import Brake, Shoe
from drumlin.fem.equilibrium.modes import RigidBodyModes, rigid_body_modes
from drumlin.fem.preparation.bodies import Body, actuation, contact_stiffness
from drumlin.fem.preparation.scene import Scene


class UnitLoad(NamedTuple):
    """The actuation of a shoe per newton of its force.

    `factors` (l,): of each load column of the substructure; `moment`: about the pin [m].
    """

    factors: Floats
    moment: float


class ModeClosures(NamedTuple):
    """N u and T u (n, k) of the k test modes of a shoe: weighted gap closure and weighted slip."""

    normal: Floats
    tangential: Floats


class LoadTerms(NamedTuple):
    """The parts q (n,), B (n, k) and h (k,) of a shoe's contact problem. They know no friction."""

    q: Floats
    B: Floats
    h: Floats


class RingRoots(NamedTuple):
    """Square roots (m, n) of the ring's flexibility, under pressure and under friction."""

    pressed: Floats
    dragged: Floats


@dataclass(frozen=True)
class GroupState:
    """Shoes of a brake that are solved together, on a prepared model.

    All contact problems of the group are stated per newton of `unit_force`, so that a force that
    acts alone enters only through the gap.

    Attributes
    ----------
    scene : the prepared model
    brake : the brake, whose friction, forces and clearances may differ from those of the model
    members : positions of the shoes in the brake
    penalty : factor alpha of the contact stiffness alpha E/t; inf for exact contact
    senses : sense of the friction at each shoe's abutment, see `Held.freedoms`. It is empty until
        `ShoeGroup.settled` has found it. A group with a rough abutment has no problem before that.
    """

    scene: Scene
    brake: Brake
    members: tuple[int, ...]
    penalty: float = math.inf
    senses: tuple[int, ...] = ()

    # The members

    @cached_property
    def shoes(self) -> tuple[Shoe, ...]:
        """The shoes of the group."""
        return tuple(self.brake.shoes[i] for i in self.members)

    @cached_property
    def bodies(self) -> tuple[Body, ...]:
        """The substructures of the shoes."""
        return tuple(self.scene.bodies[i] for i in self.members)

    @property
    def names(self) -> str:
        """The shoes as a refusal names them."""
        return ", ".join(f"shoe {shoe.name!r}" for shoe in self.shoes)

    @property
    def rough(self) -> bool:
        """Whether friction acts at an abutment of the group."""
        return any(len(shoe.senses) > 1 for shoe in self.shoes)

    @property
    def each_sense(self) -> tuple[int, ...]:
        """The sense of each shoe's friction at its abutment, +1 for a shoe without friction there.

        Raises RuntimeError where an abutment is rough and its sense is not known yet.
        """
        if not self.senses and self.rough:
            raise RuntimeError(
                f"{self.names}: friction at the abutment has no sense yet, ask for `settled`"
            )
        return self.senses or (1,) * len(self.members)

    # The places of each shoe's unknowns

    @cached_property
    def node_ranges(self) -> tuple[slice, ...]:
        """Where the pressures of each shoe stand among those of the group."""
        return in_turn(len(body.line.nodes) for body in self.bodies)

    @cached_property
    def mode_ranges(self) -> tuple[slice, ...]:
        """Where the generalised coordinates of each shoe stand among those of the group."""
        return in_turn(modes.work.size for modes in self.modes)

    # What moves and loads each shoe

    @cached_property
    def unit_force(self) -> float:
        """The largest actuation force [N]."""
        return max(abs(shoe.actuation.force) for shoe in self.shoes)

    @cached_property
    def own_forces(self) -> Floats:
        """The actuation forces (shoes,) that the brake file gives, per newton of `unit_force`."""
        return np.array([shoe.actuation.force for shoe in self.shoes]) / self.unit_force

    @cached_property
    def loads(self) -> tuple[UnitLoad, ...]:
        """The actuation of each shoe per newton of its force."""
        pairs = zip(self.bodies, self.shoes, strict=True)
        return tuple(UnitLoad(*actuation(body, shoe)) for body, shoe in pairs)

    @cached_property
    def modes(self) -> tuple[RigidBodyModes, ...]:
        """The rigid-body modes of each shoe."""
        found = []
        for k, sense in enumerate(self.each_sense):
            moment = self.loads[k].moment
            found.append(rigid_body_modes(self.bodies[k], self.shoes[k], moment, sense))
        return tuple(found)

    @cached_property
    def gaps(self) -> tuple[Floats, ...]:
        """Gaps (n_i,) [m] of the unloaded linings at their contact nodes."""
        pairs = zip(self.bodies, self.shoes, strict=True)
        return tuple(gap_of(body, self.brake, shoe) for body, shoe in pairs)

    @cached_property
    def stiffnesses(self) -> tuple[float, ...]:
        """Contact stiffness of each shoe per area [Pa/m]."""
        return tuple(contact_stiffness(shoe, self.penalty) for shoe in self.shoes)

    @cached_property
    def test_closures(self) -> tuple[ModeClosures, ...]:
        """Closure and slip of the test modes of each shoe."""
        return tuple(self._test_closures(k) for k in range(len(self.members)))

    def _test_closures(self, k: int) -> ModeClosures:
        """Closure and slip of the test modes of shoe `k`."""
        body = self.bodies[k]
        if self.shoes[k].held_by == "hinge":
            return ModeClosures(*body.turning)
        test_modes = self.modes[k].test_modes
        return ModeClosures(body.coupling.N @ test_modes, body.coupling.T @ test_modes)

    @cached_property
    def load_terms(self) -> tuple[LoadTerms, ...]:
        """The parts of each shoe's contact problem that the friction coefficient does not change."""
        return tuple(self._load_terms(k) for k in range(len(self.members)))

    def _load_terms(self, k: int) -> LoadTerms:
        """The parts of the contact problem of shoe `k` that know no friction."""
        body, modes = self.bodies[k], self.modes[k]
        force = abs(self.shoes[k].actuation.force) / self.unit_force
        gap = body.coupling.M @ (self.gaps[k] / self.unit_force)
        q = gap - force * (body.closing_loaded @ self.loads[k].factors)
        if modes.contact_modes is modes.test_modes:
            closure = self.test_closures[k].normal
        else:
            closure = body.coupling.N @ modes.contact_modes
        return LoadTerms(q, -closure, -force * modes.work)

    # Integrals over the linings

    @cached_property
    def levers(self) -> Floats:
        """(n, shoes) [m^3]: the torque of each shoe is mu times this matrix times the pressures."""
        return np.asarray(block_diag(*(body.coupling.lever for body in self.bodies)).T)

    @cached_property
    def areas(self) -> Floats:
        """Area (n,) [m^2] of each contact node; the pressures times it are the contact force."""
        return np.concatenate([body.coupling.area for body in self.bodies])

    @cached_property
    def masses(self) -> Floats:
        """Mass matrix (n, n) [m^2] of the contact nodes, which weighs the gaps of the linings."""
        return np.asarray(block_diag(*(body.coupling.M for body in self.bodies)))

    # What the shoes share

    @cached_property
    def ring(self) -> RingRoots | None:
        """The flexibility of the ring under the group's linings; None for a rigid drum."""
        ring = self.scene.ring
        if ring is None:
            return None
        return RingRoots(
            pressed=np.hstack([ring.pressed[i] for i in self.members]),
            dragged=np.hstack([ring.dragged[i] for i in self.members]),
        )

    @cached_property
    def links(self) -> list[tuple[int, int]]:
        """The struts between shoes of the group, (from, to) each."""
        names = [shoe.name for shoe in self.shoes]
        links = [link for link in self.brake.links if link.to in names]
        return [(names.index(link.source), names.index(link.to)) for link in links]

    @cached_property
    def cam(self) -> list[int]:
        """The shoes whose tips a cam moves alike; empty without a cam."""
        drive = self.brake.actuation
        if not drive or not drive.is_cam:
            return []
        pushed_by_struts = [to for _, to in self.links]
        return [k for k in range(len(self.shoes)) if k not in pushed_by_struts]

    @cached_property
    def total(self) -> float:
        """The sum of the cam's forces, per newton of `unit_force`; 0 without a cam."""
        if not self.brake.actuation or not self.cam:
            return 0.0
        return self.brake.actuation.total / self.unit_force


def gap_of(body: Body, brake: Brake, shoe: Shoe) -> Floats:
    """Gaps (n,) [m] of the unloaded lining at the contact nodes of its substructure.

    A gap is the distance off the drum's radius, the clearance and the misfit together.
    """
    return gap_at(body.line.xy, body.line.phi, brake, shoe)


def gap_at(xy: Floats, phi: Floats, brake: Brake, shoe: Shoe) -> Floats:
    """Gaps [m] of the unloaded lining at points xy (2, ...) [m] of its mesh and their angles phi.

    Both are in the frame of the shoe.
    """
    theta, radius = shoe.frame.theta(phi), brake.size
    off = shoe.off(xy, radius)
    # Nodes on the drum's radius are off it by round-off, which would be a gap or an overlap.
    off = np.where(np.abs(off) < 1e-12 * radius, 0.0, off)
    return off + clearance.gap(brake, shoe, theta)
