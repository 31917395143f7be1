"""The shoes that meet the drum together, as one contact problem.

A shoe on a rigid drum meets it alone. Shoes on an elastic ring feel each other, so all that touch it are solved
together. Whatever is done with the contact (sliding, holding, wear, sensitivity, self-locking) starts from here.
"""

import math
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np
import scipy.linalg

from drumlin.arrays import Bools, Floats
from drumlin.brake import clearance
from drumlin.brake.drum_brake import Brake, Shoe
from drumlin.contact import active_set, self_locking
from drumlin.errors import NoAnswer
from drumlin.fem.assembly import Body, Scene, actuation, contact_stiffness
from drumlin.laws import locking_friction

LARGEST_TURN = 0.2  # rad; beyond it small displacements are no longer a model of the shoe's motion


@dataclass(frozen=True)
class ShoeGroup:
    """The shoes `members` of a brake on a prepared scene, at the contact stiffness `penalty` E/t.

    All of its problem is per newton of `unit_force`, so that one force alone enters only through the gap.
    """

    scene: Scene
    brake: Brake
    members: tuple[int, ...]
    penalty: float = math.inf

    @cached_property
    def shoes(self) -> tuple[Shoe, ...]:
        """The shoes of the group."""
        return tuple(self.brake.shoes[i] for i in self.members)

    @cached_property
    def bodies(self) -> tuple[Body, ...]:
        """Their condensed bodies."""
        return tuple(self.scene.bodies[i] for i in self.members)

    @cached_property
    def parts(self) -> tuple[slice, ...]:
        """The unknowns of each shoe among those of the group."""
        begins = np.cumsum([0, *(len(body.line.nodes) for body in self.bodies)])
        return tuple(slice(int(a), int(b)) for a, b in pairwise(begins))

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
        return tuple(gap_of(body, self.brake, shoe) for body, shoe in zip(self.bodies, self.shoes, strict=True))

    @cached_property
    def stiffnesses(self) -> tuple[float, ...]:
        """Contact stiffness of each shoe per area [Pa/m]."""
        return tuple(contact_stiffness(shoe, self.penalty) for shoe in self.shoes)

    @cached_property
    def levers(self) -> Floats:
        """(n, shoes) [m^3]: friction times this by the pressures is the torque of each shoe."""
        return np.asarray(scipy.linalg.block_diag(*(body.coupling.lever for body in self.bodies)).T)

    @cached_property
    def masses(self) -> Floats:
        """(n, n) [m^2]: what weighs a gap on the linings."""
        return np.asarray(scipy.linalg.block_diag(*(body.coupling.M for body in self.bodies)))

    @cached_property
    def ring(self) -> tuple[Floats, Floats] | None:
        """Square roots (m, n) of the ring's flexibility under pressure and under drag; None for a rigid drum."""
        ring = self.scene.ring
        if ring is None:
            return None
        return np.hstack([ring.pressed[i] for i in self.members]), np.hstack([ring.dragged[i] for i in self.members])

    @cached_property
    def problem(self) -> active_set.Problem:
        """Full slip, the drum dragging the linings by mu p, as one complementarity problem.

        The weighted gap  w = M (g + p/eps) - N u + N_ring u_ring  closes as the lining moves by u, elastically and with
        the shoe's turn y about its pin, and opens as the ring moves by u_ring;  C p = h  is the balance of moments
        about the pins.
        """
        parts = [self._shoe_problem(k) for k in range(len(self.members))]
        if self.ring is None and len(parts) == 1:
            return parts[0]
        A = scipy.linalg.block_diag(*(part.A for part in parts))
        if self.ring is not None:
            pressed, dragged = self.ring
            A += pressed.T @ (pressed + self.brake.drag * dragged)
        return active_set.Problem(
            A=A,
            q=np.concatenate([part.q for part in parts]),
            B=scipy.linalg.block_diag(*(part.B for part in parts)),
            C=scipy.linalg.block_diag(*(part.C for part in parts)),
            h=np.concatenate([part.h for part in parts]),
        )

    def _shoe_problem(self, k: int) -> active_set.Problem:
        body, shoe = self.bodies[k], self.shoes[k]
        drag = self.brake.drag_on(shoe)
        load, moment = actuation(body, shoe)
        share = abs(shoe.actuation.force) / self.unit_force
        N, T, M = body.coupling.N, body.coupling.T, body.coupling.M
        approach = N @ body.turned  # per turn
        A, C = -body.closing_pressed, -approach
        if body.closing_dragged is not None:
            A, C = A - drag * body.closing_dragged, C + drag * (T @ body.turned)
        return active_set.Problem(
            A=A + M / self.stiffnesses[k],
            q=M @ (self.gaps[k] / self.unit_force) - share * (body.closing_loaded @ load),
            B=-approach[:, None],
            C=C[None],
            h=np.array([-share * moment]),
        )

    def at_friction(self, friction: float) -> active_set.Problem:
        """The contact problem at another friction coefficient."""
        return replace(self, brake=self.brake.model_copy(update={"friction": friction})).problem

    @property
    def sliding(self) -> self_locking.Sliding:
        """Full slip at every friction coefficient; the scene must be prepared with friction."""
        return self_locking.Sliding.through(self.at_friction(0.0), self.at_friction(1.0))

    def answer(self, first: Bools | None = None) -> active_set.Contact:
        """The contact per newton of `unit_force`, from the contact set `first` (n,) where there is one.

        Raises NoAnswer: self-locking, no equilibrium, not converged, a turn too large for small displacements.
        """
        for body, shoe, gap in zip(self.bodies, self.shoes, self.gaps, strict=True):
            _check_reach(shoe, body.line.xy, gap, actuation(body, shoe)[1])
        law = min(locking_friction(self.brake, shoe) for shoe in self.shoes)
        try:
            return self_locking.answer(self.at_friction, self.brake.friction, first, law=law, brake="elastic as it is")
        except NoAnswer as error:
            raise NoAnswer(f"{self.names}: {error}") from error


def groups_of(scene: Scene, brake: Brake, penalty: float = math.inf) -> list[ShoeGroup]:
    """The shoes that the actuation turns towards the drum, in groups that must be solved together."""
    touching = [i for i, shoe in enumerate(brake.shoes) if turns_towards(scene.bodies[i], shoe)]
    return grouped(scene, brake, touching, penalty)


def grouped(scene: Scene, brake: Brake, touching: list[int], penalty: float = math.inf) -> list[ShoeGroup]:
    """The shoes `touching` in groups: each alone, or all together where they meet through an elastic ring."""
    alone = scene.ring is None or scene.apart
    groups = [(i,) for i in touching] if alone else [tuple(touching)] if touching else []
    return [ShoeGroup(scene, brake, members, penalty) for members in groups]


def turns_towards(body: Body, shoe: Shoe) -> bool:
    """Whether the force turns the shoe towards the drum, at one lining point at least."""
    if shoe.actuation.force == 0:
        return False
    _, moment = actuation(body, shoe)
    approach = body.coupling.N @ body.turned
    return bool(abs(moment) > 1e-14 * np.abs(body.line.xy).max() and (moment * approach > 0).any())


def gap_of(body: Body, brake: Brake, shoe: Shoe) -> Floats:
    """Gap of the unloaded lining at the contact nodes (n,) [m]: off the drum's radius, clearance and misfit."""
    return gap_at(body.line.xy, body.line.phi, brake, shoe)


def gap_at(xy: Floats, phi: Floats, brake: Brake, shoe: Shoe) -> Floats:
    """Gap [m] of the unloaded lining at the points xy (2, ...) [m] of its mesh, at the angles phi (...) there."""
    theta, radius = shoe.frame.theta(phi), brake.drum.radius
    off = shoe.sign * (radius - np.hypot(*xy))
    return np.where(np.abs(off) < 1e-12 * radius, 0.0, off) + clearance.gap(brake, shoe, theta)  # 0.0: not round-off


def _check_reach(shoe: Shoe, xy: Floats, gap: Floats, moment: float) -> None:
    """Raise NoAnswer where the shoe would have to turn too far to touch, or could turn for ever.

    A lining point at distance d from the pin and angle psi reaches the radius r when it has turned by
    alpha: r^2 = a^2 + d^2 + 2 a d cos(psi + alpha), with a the pin's distance from the drum's centre.
    """
    if (gap <= 0).any():
        return
    a, r = shoe.pin.radius, np.hypot(*xy)
    v = xy * ((r - shoe.sign * gap) / r) - np.array([[a], [0.0]])  # the lining stands back by its gap
    d, psi = np.hypot(*v), np.arctan2(v[1], v[0])
    cosine = (r**2 - a**2 - d**2) / (2 * a * d)
    meets = np.abs(cosine) <= 1
    if not meets.any():
        raise NoAnswer(f"shoe {shoe.name!r}: no equilibrium, the force turns it without its ever touching the drum")
    angle = np.arccos(cosine[meets])
    turns = math.copysign(1.0, moment) * (np.concatenate([angle, -angle]) - np.tile(psi[meets], 2)) % (2 * math.pi)
    if turns.min() > LARGEST_TURN:
        raise NoAnswer(
            f"shoe {shoe.name!r}: it would have to turn by {math.degrees(turns.min()):.3g} deg to touch the drum; "
            f"small displacements hold up to {math.degrees(LARGEST_TURN):.3g} deg"
        )
