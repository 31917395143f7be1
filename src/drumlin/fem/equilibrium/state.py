"""The substructures, gaps, loads and rigid-body modes of a group of shoes.

Nothing in this module depends on the friction coefficient of the drum.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from operator import attrgetter
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats, in_turn
from drumlin.base.lapack import block_diag
from drumlin.brake import clearance
from drumlin.brake.brake import Brake, Shoe
from drumlin.fem.equilibrium.modes import RigidBodyModes, rigid_body_modes
from drumlin.fem.preparation.bodies import (
    ShoeSubstructure,
    acting_loads,
    actuation,
    contact_stiffness,
)
from drumlin.fem.preparation.scene import PreparedModel


class UnitLoad(NamedTuple):
    """The actuation of a shoe per newton of its force.

    `factors` (l,) multiply the load columns of the substructure. `moment` is the moment of the
    actuation about the pin [m].
    """

    factors: Floats
    moment: float


class ModeClosures(NamedTuple):
    """The weighted gap closures N u and the weighted slips T u (n, k) of a shoe's k test modes."""

    normal: Floats
    tangential: Floats


class LoadTerms(NamedTuple):
    """The parts q (n,), B (n, k) and h (k,) of a shoe's problem that friction does not change."""

    q: Floats
    B: Floats
    h: Floats


class RingRoots(NamedTuple):
    """Square roots (m, n) of the ring's flexibility, under pressure and under friction.

    The flexibility by pressures is pressed^T pressed, and by friction pressed^T dragged.
    """

    pressed: Floats
    dragged: Floats


@dataclass(frozen=True)
class GroupState:
    """Shoes of a brake that are solved together, on a prepared model.

    All contact problems of the group are stated per newton of `unit_force`. The size of a force
    that acts alone then changes the gap alone.

    Attributes
    ----------
    scene : the prepared model
    brake : the brake, whose friction, forces and clearances may differ from those of the model
    members : positions of the shoes in the brake
    penalty : factor alpha of the contact stiffness alpha E/t; inf for exact contact
    senses : sense of the friction at each shoe's abutment, see `Held.freedoms`; empty until
        `ShoeGroup.settled` has found the senses. A group with a rough abutment has no contact
        problem before the senses are known.
    """

    scene: PreparedModel
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
    def bodies(self) -> tuple[ShoeSubstructure, ...]:
        """The substructures of the shoes."""
        return tuple(self.scene.bodies[i] for i in self.members)

    @property
    def names(self) -> str:
        """The names of the shoes as the text of a refusal."""
        return self.brake.names(self.members)

    @property
    def rough(self) -> bool:
        """Whether friction acts at an abutment of the group."""
        return any(len(shoe.senses) > 1 for shoe in self.shoes)

    @property
    def each_sense(self) -> tuple[int, ...]:
        """The sense of each shoe's friction at its abutment, +1 for a smooth or missing abutment.

        Raises RuntimeError if an abutment is rough and its sense is not known yet.
        """
        if not self.senses and self.rough:
            raise RuntimeError(
                f"{self.names}: friction at the abutment has no sense yet, ask for `settled`"
            )
        return self.senses or (1,) * len(self.members)

    # The places of each shoe's unknowns

    @cached_property
    def node_ranges(self) -> tuple[slice, ...]:
        """The places of each shoe's pressures among the pressures of the group."""
        return in_turn(len(body.line.nodes) for body in self.bodies)

    @cached_property
    def mode_ranges(self) -> tuple[slice, ...]:
        """The places of each shoe's generalised coordinates among the coordinates of the group."""
        return in_turn(modes.work.size for modes in self.modes)

    # The loads and the rigid-body modes of each shoe

    @cached_property
    def unit_force(self) -> float:
        """The largest actuation force [N], to which the group's contact problems are scaled."""
        return max(abs(shoe.actuation.force) for shoe in self.shoes)

    @cached_property
    def own_forces(self) -> Floats:
        """The actuation forces (shoes,) that the brake file gives, per newton of `unit_force`."""
        return np.array([shoe.actuation.force for shoe in self.shoes]) / self.unit_force

    @cached_property
    def loads(self) -> tuple[UnitLoad, ...]:
        """The actuation of each shoe per newton of its force."""
        return tuple(UnitLoad(*each) for each in map(actuation, self.bodies, self.shoes))

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
        """The gaps (n_i,) [m] of each unloaded lining at its contact nodes."""
        gaps = []
        for body, shoe in zip(self.bodies, self.shoes, strict=True):
            gaps.append(gap_at(body.line.xy, body.line.phi, self.brake, shoe))
        return tuple(gaps)

    @cached_property
    def stiffnesses(self) -> tuple[float, ...]:
        """The contact stiffness of each shoe per area [Pa/m]."""
        return tuple(contact_stiffness(shoe, self.penalty) for shoe in self.shoes)

    @cached_property
    def test_closures(self) -> tuple[ModeClosures, ...]:
        """The gap closures and slips of the test modes of each shoe."""
        closures = []
        for body, shoe, modes in zip(self.bodies, self.shoes, self.modes, strict=True):
            if shoe.held_by == "hinge":
                found = ModeClosures(*body.rotation_closure)
            else:
                coupling, u = body.coupling, modes.test_modes
                found = ModeClosures(coupling.N @ u, coupling.T @ u)
            closures.append(found)
        return tuple(closures)

    @cached_property
    def load_terms(self) -> tuple[LoadTerms, ...]:
        """The parts of each shoe's contact problem that friction does not change."""
        return tuple(map(self._load_terms, range(len(self.members))))

    def _load_terms(self, k: int) -> LoadTerms:
        """The parts of the contact problem of shoe `k` that friction does not change."""
        body, modes = self.bodies[k], self.modes[k]
        own_force = self.shoes[k].actuation.force
        force = abs(own_force) / self.unit_force
        gap = body.coupling.M @ (self.gaps[k] / self.unit_force)
        acting = acting_loads(body, self.shoes[k], own_force) / self.unit_force
        q = gap - body.closure_by_load @ acting
        # Without friction at an abutment the closures of the test modes serve for both.
        if modes.contact_modes is modes.test_modes:
            closure = self.test_closures[k].normal
        else:
            closure = body.coupling.N @ modes.contact_modes
        return LoadTerms(q, -closure, -force * modes.work)

    # Integrals over the linings

    @cached_property
    def levers(self) -> Floats:
        """The torque (n, shoes) [m^3] of each shoe per pressure of each node and per mu."""
        return np.asarray(block_diag(*map(attrgetter("coupling.lever"), self.bodies)).T)

    @cached_property
    def areas(self) -> Floats:
        """The area (n,) [m^2] of each contact node, which turns its pressure into a force."""
        return np.concatenate(list(map(attrgetter("coupling.area"), self.bodies)))

    @cached_property
    def masses(self) -> Floats:
        """The mass matrix (n, n) [m^2] of the contact nodes, which weights the gaps."""
        return np.asarray(block_diag(*map(attrgetter("coupling.M"), self.bodies)))

    # The ring, the struts and the cam

    @cached_property
    def ring(self) -> RingRoots | None:
        """The flexibility of the ring under the group's linings; None for a rigid drum."""
        ring = self.scene.ring
        if ring is None:
            return None
        return RingRoots(
            pressed=np.hstack([ring.normal_half_flexibilities[i] for i in self.members]),
            dragged=np.hstack([ring.friction_half_flexibilities[i] for i in self.members]),
        )

    @cached_property
    def links(self) -> list[tuple[int, int]]:
        """The numbers of the shoes from which and to which each strut of the group pushes."""
        names = [shoe.name for shoe in self.shoes]
        links = []
        for link in self.brake.links:
            if link.to in names:
                links.append((names.index(link.source), names.index(link.to)))
        return links

    @cached_property
    def cam(self) -> list[int]:
        """The numbers of the shoes whose tips a cam moves by one travel; empty without a cam."""
        drive = self.brake.actuation
        if not drive or not drive.is_cam:
            return []
        pushed_by_struts = {to for _, to in self.links}
        return sorted(set(range(len(self.shoes))) - pushed_by_struts)

    @cached_property
    def total(self) -> float:
        """The sum of the cam's forces, per newton of `unit_force`; 0 without a cam."""
        if not self.brake.actuation or not self.cam:
            return 0.0
        return self.brake.actuation.total / self.unit_force


def gap_at(xy: Floats, phi: Floats, brake: Brake, shoe: Shoe) -> Floats:
    """The gaps (...) [m] of an unloaded lining at points of its friction surface.

    A gap is the distance off the drum's radius, the clearance and the misfit together.

    Parameters
    ----------
    xy : places (2, ...) [m] of the points in the frame of the shoe
    phi : angles (...) [rad] of the points in the frame of the shoe
    brake : the brake
    shoe : the shoe of the lining
    """
    theta, radius = shoe.frame.theta(phi), brake.size
    off = shoe.off(xy, radius)
    # Round-off moves nodes off the drum's radius, which would look like a gap or an overlap.
    off = np.where(np.abs(off) < 1e-12 * radius, 0.0, off)
    return off + clearance.gap(brake, shoe, theta)
