"""Exact sensitivities of the torque of an elastic brake, from the tangent of its equations.

One solution of the transposed equations, their adjoint (fem.analysis.adjoint), holds the effect of
any small change on the torque, without differences of solves.

- Moduli act through the displacements u of the loads and v of the adjoint loads: dT = -v^T dK u,
  with dK the part of the stiffness that is proportional to the modulus.
- The supports of a shoe act through its rigid-body modes, and through its body where nodes of the
  body move with a support (fem.analysis.moving): a straight beam ends at the hinge, the back of an
  arc is gripped at the pivot. Then dT = -v^T (dK/dX dX) u, with dK/dX the exact derivative of the
  stiffness by the places X of the nodes (fem.analysis.mutual_work).
- Where nodes of the contact move too, its coupling and its gap change by central differences of
  these two alone.

On a mesh the division into elements is the one that `solve` would choose; of hp elements the places
stay where the contact ends. Where a change makes the contact set change, the torque has a kink, and
these are its slopes on the side of the present set. Forces of struts and cams are shared anew.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.file import vary
from drumlin.brake.orthotropic import orthotropic_parts
from drumlin.brake.support import SupportChange, wrench
from drumlin.fem.analysis.adjoint import GroupAdjoint, ShoeAdjoint, group_adjoint
from drumlin.fem.analysis.moving import Moves, lines_at, moves_by
from drumlin.fem.analysis.mutual_work import change_by_nodes, work_by_part
from drumlin.fem.equilibrium.group import ShoeGroup, groups_of
from drumlin.fem.equilibrium.state import gap_at
from drumlin.fem.model import PENALTY, check_penalty
from drumlin.fem.preparation.bodies import Body, coupling_of
from drumlin.fem.preparation.prepare import prepare
from drumlin.fem.preparation.scene import Scene
from drumlin.fem.solve import solve
from drumlin.fem.substructure.body import FRAME
from drumlin.fem.substructure.elasticity import layers_of
from drumlin.fem.substructure.interface import ContactLine
from drumlin.fem.substructure.loads import ACTUATION
from drumlin.laws import law as rigid_law
from drumlin.laws import sine
from drumlin.laws.naming import name_of
from drumlin.response.merit import sensitivity as by_differences
from drumlin.response.resultants import cross

PERCENT_PER_MM = 0.1
"""Percent per millimetre of a relative change by a place, which is in 1/m."""


@dataclass(frozen=True)
class ShoeSensitivity:
    """The effects on the torque of one shoe, and the effects of this shoe on the brake's torque T.

    On a plane T is the braking force [N], and all units are divided by a length; `theta` is in m.

    Attributes
    ----------
    name : name of the shoe
    torque : the shoe's own torque [N m]
    friction : change of the shoe's own torque per friction coefficient [N m]
    S : (mu/torque) d torque/dmu of the shoe at a fixed actuation; None where the torque is 0
    force : dT per actuation force [m]; None where a strut or a cam gives the force
    moduli : dT by the logarithm of each modulus [N m] of "lining", "backing", "shoe"; of an
        orthotropic part by that of one factor on all its moduli, not by each of them
    bending_stiffness : dT by the logarithm of the body's bending stiffness [N m], which replaces the
        modulus where the brake gives it; else None
    clearance : dT per clearance that is even along the lining [N]
    held : dT by each support: the places "hinge", "pivot", "abutment.point" (2,) [N] along x and y
        of the brake; the angles "abutment.direction", "guide.direction" and the coefficient
        "abutment.friction" (1,) [N m]
    penalty : dT by the logarithm of the contact stiffness [N m]
    theta : angles (n,) [rad] of the lining's nodes, growing
    density : dT per clearance and length of arc (n,) [N/m]; 0 off the contact
    """

    name: str
    torque: float
    friction: float
    S: float | None
    force: float | None
    moduli: dict[str, float]
    bending_stiffness: float | None
    clearance: float
    held: dict[str, Floats]
    penalty: float
    theta: Floats
    density: Floats


@dataclass(frozen=True)
class Sensitivity:
    """The sensitivities of a brake's torque T.

    Attributes
    ----------
    friction_coefficient : mu
    torque : T [N m]
    friction : dT/dmu [N m]
    S : (mu/T) dT/dmu of the whole brake; None where T is 0
    drive : dT by the logarithm of the brake's actuation [N m]; None where each shoe has its own force
    ring : dT by the logarithm of the ring's modulus [N m]; None for a rigid drum, or where the brake
        gives the bending stiffness
    ring_bending_stiffness : dT by the logarithm of the ring's bending stiffness [N m]; None where the
        brake does not give it
    shoes : the sensitivities of each shoe
    law : S of the rigid-shoe law, of each shoe on a hinge and then of the whole; None without answer
    """

    friction_coefficient: float
    torque: float
    friction: float
    S: float | None
    drive: float | None
    ring: float | None
    ring_bending_stiffness: float | None
    shoes: tuple[ShoeSensitivity, ...]
    law: tuple[float | None, ...] | None

    def as_dict(self) -> dict[str, Any]:
        """As plain data for JSON (SI)."""
        shoes = [_shoe_as_dict(shoe) for shoe in self.shoes]
        return vars(self) | {"shoes": shoes, "law": None if self.law is None else list(self.law)}


def _shoe_as_dict(shoe: ShoeSensitivity) -> dict[str, Any]:
    """The sensitivities of a shoe as plain data; the hinge stands there once more by itself."""
    hinge = shoe.held["hinge"].tolist() if "hinge" in shoe.held else None
    return vars(shoe) | {
        "theta": shoe.theta.tolist(),
        "density": shoe.density.tolist(),
        "held": {key: value.tolist() for key, value in shoe.held.items()},
        "hinge": hinge,
    }


def sensitivity(scene: Scene, brake: Brake, *, penalty: float = PENALTY) -> Sensitivity:
    """The sensitivities of the torque of a brake on a prepared model.

    Raises NoAnswer as `respond` does, and for a brake without friction, which has no torque.
    Raises BadInput as `respond` does.
    """
    check_penalty(penalty)
    if brake.friction == 0:
        raise NoAnswer("sensitivity: without friction there is no torque")
    if scene.brake.friction == 0:
        raise BadInput(
            f"friction = {brake.friction:g}: the scene was prepared without friction, for mu = 0 only"
        )
    pressed: dict[int, ShoeSensitivity] = {}
    ring, drive = 0.0, 0.0
    for group in groups_of(scene, brake, penalty):
        adjoint = group_adjoint(group)
        for k, i in enumerate(group.members):
            pressed[i] = _ShoeSlopes(adjoint, k).sensitivity()
        ring, drive = ring + adjoint.ring, drive + adjoint.drive
    shoes = []
    for i, shoe in enumerate(brake.shoes):
        shoes.append(pressed[i] if i in pressed else _untouched(scene.bodies[i], shoe))
    torque = math.fsum(shoe.torque for shoe in shoes)
    friction = math.fsum(shoe.friction for shoe in shoes)
    elastic = brake.ring is not None
    by_stiffness = brake.ring is not None and brake.ring.bending_stiffness is not None
    return Sensitivity(
        friction_coefficient=brake.friction,
        torque=torque,
        friction=friction,
        S=_elasticity(brake.friction, friction, torque),
        drive=None if brake.actuation is None else drive,
        ring=ring if elastic and not by_stiffness else None,
        ring_bending_stiffness=ring if by_stiffness else None,
        shoes=tuple(shoes),
        law=law_sensitivity(brake),
    )


def _elasticity(x: float, slope: float, value: float) -> float | None:
    """The relative change of a value per relative change of x; None where the value is 0."""
    return x * slope / value if value else None


def _untouched(body: Body, shoe: Shoe) -> ShoeSensitivity:
    """The sensitivities of a shoe that its force does not press: its torque stays 0."""
    theta = shoe.frame.theta(body.line.phi)[:: shoe.frame.sense]
    moduli = dict.fromkeys((_material_name(part) for part in layers_of(shoe)), 0.0)
    given = shoe.body is not None and shoe.body.bending_stiffness is not None
    return ShoeSensitivity(
        name=shoe.name,
        torque=0.0,
        friction=0.0,
        S=None,
        force=0.0,
        bending_stiffness=moduli.pop("shoe") if given else None,
        moduli=moduli,
        clearance=0.0,
        held={},
        penalty=0.0,
        theta=theta,
        density=np.zeros(len(theta)),
    )


def _material_name(part: str) -> str:
    """The name of the material of a part: the table of a T-section is of the shoe's material."""
    return "shoe" if part == "table" else part


class _Displacements(NamedTuple):
    """Displacements u of the loads and v of the adjoint loads (2 nodes,), with the frame held."""

    u: Floats
    v: Floats


class _CountedModes(NamedTuple):
    """How a shoe counts its rigid-body modes.

    Attributes
    ----------
    sign : (k,) of each mode in the frame of the shoe against that of the brake
    worked : (k,) 1 where the actuation works on the mode; it does not where the shoe tilts on a lever
    """

    sign: Floats
    worked: Floats


class _ModuliSlopes(NamedTuple):
    """dT by the logarithm of each modulus, and of the body's bending stiffness if it is given."""

    moduli: dict[str, float]
    bending_stiffness: float | None


class _ShoeSlopes:
    """The effects of changes at shoe `k` of a group on the brake's torque.

    adjoint: of the group; k: the shoe's number within the group.
    """

    def __init__(self, adjoint: GroupAdjoint, k: int) -> None:
        self.adjoint, self.k = adjoint, k
        self.group: ShoeGroup = adjoint.group
        self.own: ShoeAdjoint = adjoint.shoes[k]
        self.body, self.shoe = self.group.bodies[k], self.group.shoes[k]
        self.drag = self.group.brake.drag_on(self.shoe)
        # Under a cam the travel of the shoe's tip enters the equation that gives its force.
        self.under_cam = k in self.group.cam
        self.tip_multiplier = self.own.c if self.under_cam else 0.0
        names = self.shoe.freedoms(self.group.senses[k]).names
        signs = [float(self.shoe.frame.sense) if name == "turn" else 1.0 for name in names]
        worked = [float(name != "tilt") for name in names]
        self.counted = _CountedModes(np.array(signs), np.array(worked))

    def sensitivity(self) -> ShoeSensitivity:
        """All sensitivities of the shoe."""
        group, k, own, body = self.group, self.k, self.own, self.body
        shoe, coupling = self.shoe, self.body.coupling
        torque = float(self.adjoint.torque[k])
        friction = float(self.adjoint.friction[k])
        by_penalty = float(own.a @ (coupling.M @ own.p)) / group.stiffnesses[k]
        of_moduli = self._moduli(by_penalty)
        shares_force = self._pushed_by_strut() or k in group.cam
        sign_of_force = math.copysign(1.0, shoe.actuation.force)
        forward = slice(None, None, shoe.frame.sense)
        return ShoeSensitivity(
            name=shoe.name,
            torque=torque,
            friction=friction,
            S=_elasticity(group.brake.friction, friction, torque),
            force=None if shares_force else sign_of_force * own.c,
            moduli=of_moduli.moduli,
            bending_stiffness=of_moduli.bending_stiffness,
            clearance=-float(own.a @ coupling.M.sum(axis=1)),
            held=self._held(),
            penalty=by_penalty,
            theta=shoe.frame.theta(body.line.phi)[forward],
            density=-shoe.lining.width * own.a[forward],
        )

    def _pushed_by_strut(self) -> bool:
        """Whether a strut gives the shoe's force."""
        return self.k in [to for _, to in self.group.links]

    def _strut_ends(self) -> list[int]:
        """The shoes that struts from this shoe push."""
        return [to for source, to in self.group.links if source == self.k]

    # Moduli

    @cached_property
    def displacements(self) -> _Displacements:
        """The displacements of the shoe under its loads and under the adjoint loads."""
        own, load = self.own, self.group.loads[self.k].factors
        N, T = self.body.coupling.N, self.body.coupling.T
        nodal = np.column_stack([self.drag * (T.T @ own.p) - N.T @ own.p, N.T @ own.a])
        adjoint_force = -own.c if self.under_cam else 0.0
        loads = np.column_stack([own.F * load, adjoint_force * load])
        u, v = self.body.condensed.displacements(nodal, np.zeros((FRAME, 2)), loads).T
        return _Displacements(u, v)

    def _moduli(self, by_penalty: float) -> _ModuliSlopes:
        """The effects of the shoe's moduli, or of its bending stiffness, where that is given.

        The lining's modulus is in the contact stiffness alpha E/t too, whose effect is `by_penalty`.
        """
        u, v = self.displacements
        effects: dict[str, float] = {}
        for part, work in work_by_part(self.body.basis, layers_of(self.shoe), u, v).items():
            name = _material_name(part)
            more = by_penalty if part == "lining" else 0.0
            effects[name] = effects.get(name, 0.0) - work + more
        bar = self.shoe.body
        given = bar is not None and bar.bending_stiffness is not None
        bending_stiffness = effects.pop("shoe") if given else None
        return _ModuliSlopes(effects, bending_stiffness)

    # Supports

    def _held(self) -> dict[str, Floats]:
        """The effects of the shoe's supports, see `Held.changes`.

        The work of forces on a rigid motion is that of their wrench, and motions enter the equations
        by work alone. Where nodes move with a point the strains change too.
        """
        group, k = self.group, self.k
        effects = {}
        for key, changes in self.shoe.changes(group.senses[k]).items():
            effects[key] = np.array([self._by_modes(change) for change in changes])
            moves = moves_by(group.scene, group.members[k], self.shoe, key)
            if moves:
                effects[key] = effects[key] + self._by_nodes(moves)
        for to in self._strut_ends():
            _add_direction_of_strut(effects, _ShoeSlopes(self.adjoint, to))
        return effects

    def _by_modes(self, change: SupportChange) -> float:
        """The effect of a change of the rigid-body modes on the torque."""
        own, shoe, worked = self.own, self.shoe, self.counted.worked
        N, T = self.body.coupling.N, self.body.coupling.T
        xy = shoe.points(self.body.line.xy)
        on_gaps, by_drum = own.a @ N, self.drag * (own.p @ T) - own.p @ N
        of_gaps = wrench(shoe.frame.to_brake(on_gaps.reshape(-1, 2)), xy.T)
        of_drum = wrench(shoe.frame.to_brake(by_drum.reshape(-1, 2)), xy.T)
        sign = math.copysign(1.0, shoe.actuation.force)
        push = wrench(sign * shoe.actuation.direction_vector, shoe.actuation.point.xy)
        y, b = self.counted.sign * own.y, self.counted.sign * own.b
        by_equilibria = change.tests @ of_drum + own.F * worked * (change.tests @ push)
        by_tip = self.tip_multiplier * (y * worked) @ (change.motions @ push)
        return float(y @ (change.motions @ of_gaps) - b @ by_equilibria - by_tip)

    def _by_nodes(self, moves: list[Moves]) -> Floats:
        """The effects of moving nodes, (moves,): by the stiffness, the load, and the contact."""
        own, body = self.own, self.body
        u, v = self.displacements
        nodes, axes = np.array([move.nodes for move in moves]), [move.axis for move in moves]
        effects = -change_by_nodes(body.basis, layers_of(self.shoe), u, v, nodes, axes)
        # The torque per force on each node.
        per_force = own.F * v - self.tip_multiplier * u
        for j, move in enumerate(moves):
            effects[j] += float(move.load @ per_force)
            if not move.contact_stays:
                effects[j] += self._by_contact(move)
        return effects

    def _by_contact(self, move: Moves) -> float:
        """The effect of contact nodes that move along the lining, by central differences.

        The differences are those of the coupling and of the gap alone: all pressures, displacements
        and motions stay as they are, and so do those of the adjoint.
        """
        values = []
        for step, line in lines_at(self.body, self.shoe, self.group.brake.size, move):
            value = self._contact_value(line, step, move)
            values.append((value - self._through_ring(line)) / step)
        return 0.5 * sum(values)

    def _contact_value(self, line: ContactLine, step: float, move: Moves) -> float:
        """The contact terms of the torque and its equations with the nodes moved by a step [m]."""
        own, group, brake, shoe, k = self.own, self.group, self.group.brake, self.shoe, self.k
        modes, nodes = group.modes[k], self.body.line.nodes
        contact = np.column_stack([2 * nodes, 2 * nodes + 1]).ravel()
        squeezed, turns = own.p / group.stiffnesses[k], modes.pin_motion[2]
        u = self.displacements.u[contact] + modes.contact_modes @ own.y
        v = self.displacements.v[contact] - modes.test_modes @ own.b
        coupling = coupling_of(line, shoe)
        nodal = self.drag * (coupling.T.T @ own.p) - coupling.N.T @ own.p
        # A turn by one radian moves the contact nodes aside as they move along the line.
        aside = step * np.array([-move.line[1], move.line[0]]).T.ravel()
        gap = gap_at(line.xy, line.phi, brake, shoe)
        value = brake.friction * float(coupling.lever @ own.p)
        closing = coupling.N @ (u + aside * (turns @ own.y))
        value += float(own.a @ (closing - coupling.M @ (gap + squeezed)))
        value += float(nodal @ (v - aside * (turns @ own.b)))
        # A strut from the shoe passes on what its foot bears of these forces.
        whole = shoe.frame.to_brake(nodal.reshape(-1, 2).sum(axis=0))
        value -= sum(
            self.adjoint.shoes[to].c * float(whole @ shoe.bearing) for to in self._strut_ends()
        )
        return value

    def _through_ring(self, line: ContactLine) -> float:
        """The ring's part of the weighted gaps, times the adjoint, with the contact line moved.

        It is 0 for a rigid drum.
        """
        group, scene = self.group, self.group.scene
        if scene.ring is None or scene.ring_under is None:
            return 0.0
        lines = [body.line for body in scene.bodies]
        lines[group.members[self.k]] = line
        ring = scene.ring_under(tuple(lines))
        pressed = np.hstack([ring.pressed[i] for i in group.members])
        dragged = np.hstack([ring.dragged[i] for i in group.members])
        a = np.concatenate([shoe.a for shoe in self.adjoint.shoes])
        p = np.concatenate([shoe.p for shoe in self.adjoint.shoes])
        return float((pressed @ a) @ ((pressed + group.brake.drag * dragged) @ p))

    # The line of a strut

    def by_force_line(self, force: Floats, moment: float, *, carried: bool = False) -> float:
        """The effect of a change of the shoe's unit force.

        Parameters
        ----------
        force : change of the unit force (2,) [1]
        moment : change of its moment about the origin [m]
        carried : whether the body's loaded end goes with the force, which then adds no couple
        """
        own, shoe, body = self.own, self.shoe, self.body
        centre = shoe.points(body.load_centre[:, None])[:, 0]
        free = shoe.freedoms(self.group.senses[self.k])
        couple = 0.0 if carried else shoe.frame.sense * (moment - float(cross(centre, force)))
        pushing = np.array([*shoe.frame.to_shoe(force), couple])
        load = body.columns.factors({ACTUATION: pushing})
        work = free.tests @ np.array([*force, moment])
        tested = self.counted.sign * self.counted.worked * work
        return own.F * float(own.a @ (body.closing_loaded @ load) - own.b @ tested)

    def by_point_of_force(self) -> list[Floats]:
        """The effects (2,) of moving the point at which a strut pushes the shoe, in parts to be added.

        The first is that of the force's moment, the second, if any, that of the body's nodes.
        """
        key, direction = "actuation.point", self.shoe.actuation.direction_vector
        moves = moves_by(self.group.scene, self.group.members[self.k], self.shoe, key)
        effects = []
        for step in np.eye(2):
            moment = float(cross(step, direction))
            effects.append(self.by_force_line(np.zeros(2), moment, carried=bool(moves)))
        by_moment = np.array(effects)
        return [by_moment, self._by_nodes(moves)] if moves else [by_moment]

    def by_direction_of_force(self) -> float:
        """The effect of turning the direction in which a strut pushes the shoe."""
        shoe = self.shoe
        direction, point = shoe.actuation.direction_vector, shoe.actuation.point.xy
        turned = np.array([-direction[1], direction[0]])
        # In a chain the shoe passes its force on to a further shoe.
        passed_on = [
            self.adjoint.shoes[to].c * self.own.F * float(shoe.bearing @ turned)
            for to in self._strut_ends()
        ]
        return self.by_force_line(turned, float(cross(point, turned))) - sum(passed_on)


def _add_direction_of_strut(effects: dict[str, Floats], pushed: _ShoeSlopes) -> None:
    """Add to the effects of an abutment on a strut those of the line along which the strut pushes.

    The force that a strut passes on does not change with its direction: without friction no force
    acts across it.
    """
    for part in pushed.by_point_of_force():
        effects["abutment.point"] = effects["abutment.point"] + part
    by_direction = pushed.by_direction_of_force()
    effects["abutment.direction"] = effects["abutment.direction"] + by_direction


# Lines for people


def as_text(found: Sensitivity, brake: Brake) -> list[str]:
    """The sensitivities in lines for people.

    Elasticities are d ln T / d ln x of the whole torque.
    """
    surface = brake.surface
    symbol, effect, unit = surface.symbol, surface.effect, surface.effect_unit
    law = found.law or (None,) * (len(found.shoes) + 1)
    of_law = f"{name_of(brake)} law"
    T, elasticity = found.torque or math.inf, f"d ln {symbol}/d ln"
    lines = [
        f"{effect} {found.torque:.6g} {unit}, d{symbol}/dmu {found.friction:.6g} {unit}, "
        f"S = (mu/{symbol}) d{symbol}/dmu = {_S_text(found.S)} ({of_law}: {_S_text(law[-1])})"
    ]
    if found.drive is not None:
        lines.append(f"  {elasticity} actuation {found.drive / T:+.4g}")
    if found.ring is not None:
        lines.append(f"  {elasticity} E of the drum ring {found.ring / T:+.4g}")
    if found.ring_bending_stiffness is not None:
        lines.append(
            f"  {elasticity} bending_stiffness of the drum ring {found.ring_bending_stiffness / T:+.4g}"
        )
    for k, own in enumerate(found.shoes):
        by_law = "" if law[k] is None else f" ({of_law}: {_S_text(law[k])})"
        lines.append(
            f"  shoe {own.name!r}: {effect} {own.torque:.6g} {unit}, d{symbol}/dmu {own.friction:.6g} {unit}, "
            f"S {_S_text(own.S)}{by_law}; of the whole {effect}:"
        )
        lines += _shoe_lines(own, brake.shoes[k].actuation.force, T, elasticity)
    parts = list(orthotropic_parts(brake))
    if parts:
        lines.append(
            f"  {elasticity} E of {', '.join(parts)}: by one factor on all moduli; not given by each of them"
        )
    return lines


def _S_text(S: float | None) -> str:
    """S in words."""
    return "none" if S is None else f"{S:.5g}"


def _shoe_lines(own: ShoeSensitivity, force: float, T: float, elasticity: str) -> list[str]:
    """The lines on one shoe's effects on the whole torque.

    Parameters
    ----------
    own : the sensitivities of the shoe
    force : its actuation force [N]
    T : the whole torque [N m]
    elasticity : the words "d ln T/d ln"
    """
    by_force = "" if own.force is None else f"{elasticity} force {own.force * force / T:+.4g}; "
    moduli = ", ".join(f"{name} {value / T:+.4g}" for name, value in own.moduli.items())
    bent = ""
    if own.bending_stiffness is not None:
        bent = f"; {elasticity} bending_stiffness: shoe {own.bending_stiffness / T:+.4g}"
    held = "; ".join(_held_text(key, value / T) for key, value in own.held.items())
    per_micrometre = own.clearance / T * 1e-3 * PERCENT_PER_MM + 0.0
    return [
        f"    {by_force}{elasticity} E: {moduli}{bent}; {elasticity} penalty {own.penalty / T:+.1e}",
        f"    clearance {per_micrometre:+.4g} %/µm" + (f"; {held}" if held else ""),
    ]


def _held_text(key: str, value: Floats) -> str:
    """The words on the relative effect of one support."""
    if len(value) == 2:
        x, y = value * PERCENT_PER_MM
        return f"{key} along x {x:+.4g} %/mm, along y {y:+.4g} %/mm"
    if key.endswith("friction"):
        return f"{key} {value[0]:+.4g} % per 0.01"
    return f"{key} {100 * math.radians(value[0]):+.4g} %/deg"


# Other ways to the same numbers


def law_sensitivity(brake: Brake) -> tuple[float | None, ...] | None:
    """S of the rigid-shoe law, of each shoe and then of the whole; None where laws have no answer.

    That of the sine law is exact, since its pressure keeps its shape (UWA notes, eq. 8). Of other
    laws only S of the whole is known, by differences of their closed form. Laws refuse orthotropic
    brakes.
    """
    if any(orthotropic_parts(brake)):
        return None
    try:
        if name_of(brake) != "sine":
            return (*(None for _ in brake.shoes), by_differences(brake, rigid_law))
        response = sine(brake)
    except (BadInput, NoAnswer):
        return None
    each = [
        None if merit is None else merit.sensitivity_at_fixed_shape for merit in response.merits
    ]
    pairs = zip(each, response.shoes, strict=True)
    total = math.fsum((S or 0.0) * shoe.torque for S, shoe in pairs)
    return (*each, total / response.torque if response.torque else None)


class _Probe(NamedTuple):
    """A slope that is compared with differences.

    Attributes
    ----------
    what : the slope in words
    unit : its unit
    exact : its exact value
    changes : gives the keys of the brake file that change, with their values, by the step
    step : step of the central difference; relative for force and moduli, else in the key's unit
    per_force : force [N] by which the difference is divided besides; 1 for other slopes
    """

    what: str
    unit: str
    exact: float
    changes: Callable[[float], Mapping[str, Any]]
    step: float
    per_force: float = 1.0


def against_differences(
    brake: Brake, index: int, *, elements: int, penalty: float = PENALTY
) -> tuple[Sensitivity, list[dict[str, Any]]]:
    """The slopes of the whole torque, beside central differences of solves from the mesh up.

    A row has the keys `what`, `unit`, `exact`, `near`, and the relative `difference`. Raises as
    `solve` does.

    Parameters
    ----------
    brake : the brake
    index : the shoe whose force, moduli, clearance (one number) and hinge are changed; its body is
        elastic
    elements : finite elements along each lining
    penalty : factor alpha of the contact stiffness alpha E/t
    """
    slopes = sensitivity(prepare(brake, elements=elements), brake, penalty=penalty)
    rows = []
    for probe in _probes(brake, index, slopes):
        torques = []
        for step in (probe.step, -probe.step):
            changed = vary(brake, dict(probe.changes(step)))
            torques.append(solve(changed, elements=elements, penalty=penalty).torque)
        up, down = torques
        near = (up - down) / (2 * probe.step * probe.per_force)
        rows.append(
            {
                "what": probe.what,
                "unit": probe.unit,
                "exact": probe.exact,
                "near": near,
                "difference": abs(probe.exact / near - 1),
            }
        )
    return slopes, rows


def _probes(brake: Brake, index: int, slopes: Sensitivity) -> list[_Probe]:
    """The slopes of a brake and of its shoe `index` that are compared with differences."""
    shoe, own, key = brake.shoes[index], slopes.shoes[index], f"shoe[{index}]."
    gap, body, material = shoe.lining.clearance, shoe.body, shoe.lining.material
    assert isinstance(gap, float) and body is not None and body.material is not None
    force, x, y = shoe.actuation.force, shoe.pin.x, shoe.pin.y
    by_x, by_y = (float(slope) for slope in own.held["hinge"])

    def moduli(part: str, values: Mapping[str, float], step: float) -> dict[str, float]:
        """All moduli of a part, a relative step larger."""
        return {f"{key}{part}.material.{name}": E * (1 + step) for name, E in values.items()}

    def friction(step: float) -> dict[str, Any]:
        return {"friction": brake.friction + step}

    def actuation_force(step: float) -> dict[str, Any]:
        return {key + "actuation.force": force * (1 + step)}

    def lining_moduli(step: float) -> dict[str, Any]:
        return moduli("lining", material.moduli, step)

    def body_moduli(step: float) -> dict[str, Any]:
        assert body is not None and body.material is not None
        return moduli("body", body.material.moduli, step)

    def clearance(step: float) -> dict[str, Any]:
        return {key + "lining.clearance": gap + step}

    def hinge_along_x(step: float) -> dict[str, Any]:
        return {key + "hinge": {"x": x + step, "y": y}}

    def hinge_along_y(step: float) -> dict[str, Any]:
        return {key + "hinge": {"x": x, "y": y + step}}

    return [
        _Probe("dT/dμ", "N m", slopes.friction, friction, 1e-5),
        _Probe("dT/dF", "m", own.force or 0.0, actuation_force, 1e-4, force),
        _Probe("dT/d ln E, lining", "N m", own.moduli["lining"], lining_moduli, 1e-4),
        _Probe("dT/d ln E, shoe", "N m", own.moduli["shoe"], body_moduli, 1e-4),
        _Probe("dT/d clearance", "N", own.clearance, clearance, 1e-9),
        _Probe("dT/dx, hinge", "N", by_x, hinge_along_x, 1e-6),
        _Probe("dT/dy, hinge", "N", by_y, hinge_along_y, 1e-6),
    ]
