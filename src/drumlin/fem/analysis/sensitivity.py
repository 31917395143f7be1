"""Exact sensitivities of the torque of the elastic brake, from the tangent of its equations and not
from differences.

One solution of their transpose, its adjoint (fem.analysis.adjoint), holds what the torque feels of any small
change. Moduli act through the displacements u of the loads and v of the adjoint loads: dT = -v^T dK
u, with K the part of the stiffness that is proportional to the modulus. What holds a shoe acts
through its free motions, and through its body where the nodes of the body move with it
(fem.analysis.moving): a straight beam ends at the hinge, the back of an arc is gripped at the pivot. Then dT
= -v^T (dK/dX dX) u, with dK/dX the exact derivative of the stiffness by the places X of the nodes
(fem.analysis.mutual_work). Where nodes of the contact move too, the coupling there and the gap change by
central differences of these two alone. The division into elements is the one that `solve` would
choose on a mesh; of columns the places where the contact ends stay. Where a change makes the
contact set change the torque has a kink, and these are its slopes on the side of the present set.
Forces of struts and cams are shared anew.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.file import vary
from drumlin.brake.orthotropic import orthotropic_parts
from drumlin.brake.support import wrench
from drumlin.fem.analysis.adjoint import Adjoints, adjoints
from drumlin.fem.analysis.moving import Moves, lines_at, moves_by
from drumlin.fem.analysis.mutual_work import change_by_nodes, work_by_part
from drumlin.fem.equilibrium.group import gap_at, groups_of
from drumlin.fem.model import PENALTY, check_penalty
from drumlin.fem.preparation.bodies import ShoeSubstructure, coupling_of
from drumlin.fem.preparation.prepare import prepare
from drumlin.fem.preparation.scene import PreparedModel
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

PERCENT_PER_MM = 0.1  # in 1/m


@dataclass(frozen=True)
class ShoeSensitivity:
    """What one shoe's own torque, and what the brake's torque T [N m], feel of one shoe.

    Of the shoe's own torque [N m]: `torque`, `friction` d torque/dmu [N m], `S` = (mu/torque) d
    torque/dmu at fixed actuation, None where it is 0. Of the brake's: dT by its `force` [m], by the
    logarithm of each modulus, `moduli` [N m] of "lining", "backing", "shoe" (of an orthotropic part
    by that of one factor on all its moduli, not by each of them), by that of the
    `bending_stiffness` [N m] of its body, which stands in the modulus's place where the brake gives
    it (None where not), by a `clearance` even along its lining [N], by what holds it, `held`: the
    places "hinge", "pivot", "abutment.point" (2,) [N] along x and y of the brake, the angles
    "abutment.direction", "guide.direction" and "abutment.friction" (1,) [N m], by the logarithm of
    the contact stiffness, `penalty` [N m]. `density` (n,) [N/m] at the angles `theta` (n,) [rad],
    growing: dT by clearance and length of arc, 0 off the contact. `force`: None of a shoe whose
    force a strut or a cam gives. On a plane T is the braking force [N], and all is over a length
    more; `theta` [m].
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
    """Sensitivities of a brake: its `torque` T [N m], `friction` dT/dmu [N m], `S` = (mu/T) dT/dmu
    of the whole.

    `drive`: dT by the logarithm of what the brake's actuation says [N m], None where each shoe has
    its own force; `ring`: by that of the drum ring's modulus, or `ring_bending_stiffness` where the
    brake gives that and the modulus does not matter; None for a rigid drum and for the other one.
    `law`: S of the rigid-shoe law, of each shoe on a hinge and then of the whole, where it has an
    answer.
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
        shoes = [
            vars(shoe)
            | {key: getattr(shoe, key).tolist() for key in ("theta", "density")}
            | {"held": {key: value.tolist() for key, value in shoe.held.items()}}
            | {"hinge": shoe.held["hinge"].tolist() if "hinge" in shoe.held else None}
            for shoe in self.shoes
        ]
        return vars(self) | {"shoes": shoes, "law": None if self.law is None else list(self.law)}


def sensitivity(scene: PreparedModel, brake: Brake, *, penalty: float = PENALTY) -> Sensitivity:
    """Sensitivities of the torque of a brake on a prepared scene.

    Raises NoAnswer as `respond` does, and for a brake without friction, which has no torque;
    BadInput likewise.
    """
    check_penalty(penalty)
    if brake.friction == 0:
        raise NoAnswer("sensitivity: without friction there is no torque")
    if scene.brake.friction == 0:
        raise BadInput(
            f"friction = {brake.friction:g}: the scene was prepared without friction, for mu = 0 only"
        )
    shoes: dict[int, ShoeSensitivity] = {}
    ring, drive, rim = 0.0, 0.0, brake.ring
    for group in groups_of(scene, brake, penalty):
        found = adjoints(group)
        shoes |= {i: _shoe(found, k) for k, i in enumerate(group.members)}
        ring, drive = ring + found.ring, drive + found.drive
    all_shoes = tuple(
        shoes[i] if i in shoes else _untouched(scene.bodies[i], shoe)
        for i, shoe in enumerate(brake.shoes)
    )
    torque, friction = (
        math.fsum(getattr(s, key) for s in all_shoes) for key in ("torque", "friction")
    )
    return Sensitivity(
        friction_coefficient=brake.friction,
        torque=torque,
        friction=friction,
        S=_relative(brake.friction, friction, torque),
        drive=None if brake.actuation is None else drive,
        ring=ring if rim is not None and rim.bending_stiffness is None else None,
        ring_bending_stiffness=ring
        if rim is not None and rim.bending_stiffness is not None
        else None,
        shoes=all_shoes,
        law=law_sensitivity(brake),
    )


def as_text(found: Sensitivity, brake: Brake) -> list[str]:
    """The sensitivities in lines for people; elasticities are d ln T / d ln x of the whole torque."""

    def said(S: float | None) -> str:
        return "none" if S is None else f"{S:.5g}"

    surface = brake.surface
    what, unit, name = surface.effect, surface.effect_unit, surface.symbol
    law, of = found.law or (None,) * (len(found.shoes) + 1), f"{name_of(brake)} law"
    lines = [
        f"{what} {found.torque:.6g} {unit}, d{name}/dmu {found.friction:.6g} {unit}, "
        f"S = (mu/{name}) d{name}/dmu = {said(found.S)} ({of}: {said(law[-1])})"
    ]
    T, d = found.torque or math.inf, f"d ln {name}/d ln"
    if found.drive is not None:
        lines.append(f"  {d} actuation {found.drive / T:+.4g}")
    if found.ring is not None:
        lines.append(f"  {d} E of the drum ring {found.ring / T:+.4g}")
    if found.ring_bending_stiffness is not None:
        lines.append(
            f"  {d} bending_stiffness of the drum ring {found.ring_bending_stiffness / T:+.4g}"
        )
    for shoe, own, of_law in zip(brake.shoes, found.shoes, law, strict=False):
        moduli = ", ".join(f"{name} {value / T:+.4g}" for name, value in own.moduli.items())
        force = (
            "" if own.force is None else f"{d} force {own.force * shoe.actuation.force / T:+.4g}; "
        )
        by_law = "" if of_law is None else f" ({of}: {said(of_law)})"
        bent = (
            ""
            if own.bending_stiffness is None
            else f"; {d} bending_stiffness: shoe {own.bending_stiffness / T:+.4g}"
        )
        held = "; ".join(_held_text(key, value / T) for key, value in own.held.items())
        lines += [
            f"  shoe {own.name!r}: {what} {own.torque:.6g} {unit}, d{name}/dmu {own.friction:.6g} {unit}, "
            f"S {said(own.S)}{by_law}; of the whole {what}:",
            f"    {force}{d} E: {moduli}{bent}; {d} penalty {own.penalty / T:+.1e}",
            f"    clearance {own.clearance / T * 1e-3 * PERCENT_PER_MM + 0.0:+.4g} %/µm"
            + (f"; {held}" if held else ""),
        ]
    parts = list(orthotropic_parts(brake))
    if parts:
        lines.append(
            f"  {d} E of {', '.join(parts)}: by one factor on all moduli; not given by each of them"
        )
    return lines


def _held_text(key: str, value: Floats) -> str:
    """What a part of the whole is worth by what holds a shoe."""
    if len(value) == 2:
        x, y = value * PERCENT_PER_MM
        return f"{key} along x {x:+.4g} %/mm, along y {y:+.4g} %/mm"
    if key.endswith("friction"):
        return f"{key} {value[0]:+.4g} % per 0.01"
    return f"{key} {100 * math.radians(value[0]):+.4g} %/deg"


def law_sensitivity(brake: Brake) -> tuple[float | None, ...] | None:
    """S of the rigid-shoe law: each shoe's, the whole's. Of the sine law exactly, since its
    pressure keeps its shape (UWA notes, eq. 8); of others the whole's alone, by differences of
    their closed form. None of an orthotropic brake, which laws refuse."""
    if any(orthotropic_parts(brake)):
        return None
    try:
        if name_of(brake) != "sine":
            return (*(None for _ in brake.shoes), by_differences(brake, rigid_law))
        response = sine(brake)
    except (BadInput, NoAnswer):
        return None
    each = [None if m is None else m.sensitivity_at_fixed_shape for m in response.merits]
    total = math.fsum(
        (s or 0.0) * shoe.torque for s, shoe in zip(each, response.shoes, strict=True)
    )
    return (*each, total / response.torque if response.torque else None)


def _relative(x: float, slope: float, value: float) -> float | None:
    return x * slope / value if value else None


def _shoe(found: Adjoints, k: int) -> ShoeSensitivity:
    group, at = found.group, found.of[k]
    body, shoe = group.bodies[k], group.shoes[k]
    torque, friction = float(found.torque[k]), float(found.friction[k])
    coupling, frame = body.coupling, shoe.frame
    shared, cam = k in [to for _, to in group.links], k in group.cam
    soft = float(at.a @ (coupling.M @ at.p)) / group.stiffnesses[k]
    u, v = _displacements(found, k)
    moduli, bending_stiffness = _moduli(body, shoe, u, v, soft)
    forward = slice(None, None, frame.sense)
    return ShoeSensitivity(
        name=shoe.name,
        torque=torque,
        friction=friction,
        S=_relative(group.brake.friction, friction, torque),
        force=None if shared or cam else math.copysign(1.0, shoe.actuation.force) * at.c,
        moduli=moduli,
        bending_stiffness=bending_stiffness,
        clearance=-float(at.a @ coupling.M.sum(axis=1)),
        held=_held(found, k, u, v),
        penalty=soft,
        theta=frame.theta(body.line.phi)[forward],
        density=-shoe.lining.width * at.a[forward],
    )


def _held(every: Adjoints, k: int, u: Floats, v: Floats) -> dict[str, Floats]:
    """dT by what holds shoe `k`, see `Held.changes`; u, v (2 nodes,): see `_displacements`.

    The work of forces on a rigid motion is that of their wrench, and motions enter the equations by
    work alone. Where its nodes move with a point the strains change too.
    """
    group, at = every.group, every.of[k]
    body, shoe = group.bodies[k], group.shoes[k]
    N, T, drag = body.coupling.N, body.coupling.T, group.brake.drag_on(shoe)
    xy = shoe.points(body.line.xy)
    of_gap, of_drum = (
        wrench(shoe.frame.to_brake(nodal.reshape(-1, 2)), xy.T)
        for nodal in (at.a @ N, drag * (at.p @ T) - at.p @ N)
    )
    direction = math.copysign(1.0, shoe.actuation.force) * shoe.actuation.direction_vector
    push = wrench(direction, shoe.actuation.point.xy)
    own, worked = _counted(shoe, group.senses[k])
    y, b = own * at.y, own * at.b
    way = at.c if k in group.cam else 0.0
    found = {}
    for key, changes in shoe.changes(group.senses[k]).items():
        found[key] = np.array(
            [
                y @ (one.motions @ of_gap)
                - b @ (one.tests @ of_drum + at.F * worked * (one.tests @ push))
                - way * (y * worked) @ (one.motions @ push)
                for one in changes
            ]
        )
        moves = moves_by(group.scene, group.members[k], shoe, key)
        if moves:
            found[key] = found[key] + _by_nodes(every, k, u, v, moves)
    for source, to in group.links:
        if source == k:
            _add_line(found, every, to)
    return found


def _by_nodes(every: Adjoints, k: int, u: Floats, v: Floats, moves: list[Moves]) -> Floats:
    """dT as the nodes of shoe `k` move, for each of the `moves`: by its stiffness, its load, and
    its contact where that moves.

    u, v (2 nodes,): see `_displacements`.
    """
    group, at = every.group, every.of[k]
    body, shoe = group.bodies[k], group.shoes[k]
    nodes, axes = np.array([move.nodes for move in moves]), [move.axis for move in moves]
    found = -change_by_nodes(body.basis, layers_of(shoe), u, v, nodes, axes)
    # What a force on each node is worth, in torque per newton.
    worth = at.F * v - (at.c if k in group.cam else 0.0) * u
    for j, move in enumerate(moves):
        found[j] += float(move.load @ worth)
        if not move.contact_stays:
            found[j] += _by_contact(every, k, u, v, move)
    return found


def _by_contact(every: Adjoints, k: int, u: Floats, v: Floats, move: Moves) -> float:
    """dT as the contact nodes of shoe `k` move along its lining, by central differences of its
    coupling and its gap.

    All pressures, displacements and motions stay as they are, and so do those of the adjoint.
    """
    group, at = every.group, every.of[k]
    body, shoe, brake, motions = group.bodies[k], group.shoes[k], group.brake, group.motions[k]
    line, drag = body.line, brake.drag_on(shoe)
    contact = np.column_stack([2 * line.nodes, 2 * line.nodes + 1]).ravel()
    squeezed, turns = at.p / group.stiffnesses[k], motions.of[2]
    u, v = u[contact] + motions.moved @ at.y, v[contact] - motions.tested @ at.b
    values = []
    for step, other in lines_at(body, shoe, brake.size, move):
        coupling = coupling_of(other, shoe)
        nodal = drag * (coupling.T.T @ at.p) - coupling.N.T @ at.p
        # How a turn by one radian moves the contact nodes aside as they move along the line.
        aside = step * np.array([-move.line[1], move.line[0]]).T.ravel()
        gap = gap_at(other.xy, other.phi, brake, shoe)
        value = brake.friction * float(coupling.lever @ at.p)
        value += float(
            at.a @ (coupling.N @ (u + aside * (turns @ at.y)) - coupling.M @ (gap + squeezed))
        )
        value += float(nodal @ (v - aside * (turns @ at.b)))
        # A strut that starts at the shoe passes on what the shoe's foot bears of these forces.
        whole = shoe.frame.to_brake(nodal.reshape(-1, 2).sum(axis=0))
        value -= sum(
            every.of[to].c * float(whole @ shoe.bearing)
            for source, to in group.links
            if source == k
        )
        values.append((value - _through_ring(every, k, other)) / step)
    return 0.5 * sum(values)


def _through_ring(every: Adjoints, k: int, line: ContactLine) -> float:
    """What the ring takes from the weighted gaps, weighed by the adjoint, with the contact line of
    shoe `k` moved; 0 of a rigid drum."""
    group, scene = every.group, every.group.scene
    if scene.ring is None or scene.ring_under is None:
        return 0.0
    lines = [body.line for body in scene.bodies]
    lines[group.members[k]] = line
    ring = scene.ring_under(tuple(lines))
    pressed, dragged = (
        np.hstack([half[i] for i in group.members]) for half in (ring.pressed, ring.dragged)
    )
    a, p = (np.concatenate([getattr(own, key) for own in every.of]) for key in ("a", "p"))
    return float((pressed @ a) @ ((pressed + group.brake.drag * dragged) @ p))


def _counted(shoe: Shoe, sense: int) -> tuple[Floats, Floats]:
    """Of its freedoms (k,): the sense in which the shoe's own frame counts each, and whether the
    actuation works on it: that of a lever does not where the shoe tilts.
    """
    names = shoe.freedoms(sense).names
    own = [float(shoe.frame.sense) if name == "turn" else 1.0 for name in names]
    return np.array(own), np.array([float(name != "tilt") for name in names])


def _add_line(found: dict[str, Floats], every: Adjoints, k: int) -> None:
    """Add to what the abutment on a strut is worth that the strut pushes shoe `k` along another
    line.

    The force that it passes on does not change with its direction: without friction nothing acts
    across it.
    """
    group, at = every.group, every.of[k]
    body, shoe = group.bodies[k], group.shoes[k]
    direction, point = shoe.actuation.direction_vector, shoe.actuation.point.xy
    turned = np.array([-direction[1], direction[0]])
    centre = shoe.points(body.load_centre[:, None])[:, 0]
    free = shoe.freedoms(group.senses[k])
    own, worked = _counted(shoe, group.senses[k])

    def worth(force: Floats, moment: float, *, carried: bool = False) -> float:
        """Of a change of the unit force (2,) [1] and of its moment about the origin [m]; carried:
        the body's loaded end goes with the force, which then bends it by no couple."""
        couple = 0.0 if carried else shoe.frame.sense * (moment - float(cross(centre, force)))
        pushing = np.array([*shoe.frame.to_shoe(force), couple])
        load = body.columns.factors({ACTUATION: pushing})
        tested = own * worked * (free.tests @ np.array([*force, moment]))
        return at.F * float(at.a @ (body.closure_by_load @ load) - at.b @ tested)

    moves = moves_by(group.scene, group.members[k], shoe, "actuation.point")
    moved = [
        worth(np.zeros(2), float(cross(step, direction)), carried=bool(moves)) for step in np.eye(2)
    ]
    found["abutment.point"] = found["abutment.point"] + moved
    if moves:
        found["abutment.point"] = found["abutment.point"] + _by_nodes(
            every, k, *_displacements(every, k), moves
        )
    passed = [
        every.of[to].c * at.F * float(shoe.bearing @ turned)
        for source, to in group.links
        if source == k
    ]
    line = worth(turned, float(cross(point, turned))) - sum(
        passed
    )  # of a chain: what the shoe passes on itself
    found["abutment.direction"] = found["abutment.direction"] + line


def _displacements(found: Adjoints, k: int) -> tuple[Floats, Floats]:
    """Displacements u of shoe `k` under its loads and v under the adjoint ones (2 nodes,), both
    with the frame held."""
    group, at = found.group, found.of[k]
    body, shoe, (load, _) = group.bodies[k], group.shoes[k], group.loads[k]
    N, T, drag = body.coupling.N, body.coupling.T, group.brake.drag_on(shoe)
    nodal = np.column_stack([drag * (T.T @ at.p) - N.T @ at.p, N.T @ at.a])
    loads = np.column_stack([at.F * load, (-at.c if k in group.cam else 0.0) * load])
    u, v = body.condensed.displacements(nodal, np.zeros((FRAME, 2)), loads).T
    return u, v


def _moduli(
    body: ShoeSubstructure, shoe: Shoe, u: Floats, v: Floats, soft: float
) -> tuple[dict[str, float], float | None]:
    """dT by the logarithm of each modulus and of the bending stiffness of its body, where that is
    given [N m].

    The lining's modulus is in the contact stiffness alpha E/t too, which changes the torque by
    `soft`.
    """
    effects: dict[str, float] = {}
    for name, work in work_by_part(body.basis, layers_of(shoe), u, v).items():
        own = "shoe" if name == "table" else name  # of one material
        effects[own] = effects.get(own, 0.0) - work + (soft if name == "lining" else 0.0)
    given = None if shoe.body is None else shoe.body.bending_stiffness
    return effects, None if given is None else effects.pop("shoe")


def _untouched(body: ShoeSubstructure, shoe: Shoe) -> ShoeSensitivity:
    """Of a shoe that its force does not press: nothing changes its torque of 0."""
    theta = shoe.frame.theta(body.line.phi)[:: shoe.frame.sense]
    none = dict.fromkeys(("shoe" if name == "table" else name for name in layers_of(shoe)), 0.0)
    bent = None if shoe.body is None or shoe.body.bending_stiffness is None else none.pop("shoe")
    return ShoeSensitivity(
        shoe.name, 0.0, 0.0, None, 0.0, none, bent, 0.0, {}, 0.0, theta, np.zeros(len(theta))
    )


def against_differences(
    brake: Brake, index: int, *, elements: int, penalty: float = PENALTY
) -> tuple[Sensitivity, list[dict[str, Any]]]:
    """Slopes of the whole torque next to central differences of solves from the mesh up; a row
    each.

    Force, moduli, clearance (one number) and hinge are those of shoe `index`, which has an elastic
    body. Rows: `what`, `unit`, `exact`, `near`, relative `difference`. Raises as `solve` does.
    """
    found = sensitivity(prepare(brake, elements=elements), brake, penalty=penalty)
    mu, shoe, of, key = brake.friction, brake.shoes[index], found.shoes[index], f"shoe[{index}]."
    gap, body, material = shoe.lining.clearance, shoe.body, shoe.lining.material
    assert isinstance(gap, float) and body is not None and body.material is not None
    linings, bodies, x, y = material.moduli, body.material.moduli, shoe.pin.x, shoe.pin.y
    table: list[tuple[str, str, float, Callable[[float], dict[str, Any]], float]] = [
        ("dT/dμ", "N m", found.friction, lambda s: {"friction": mu + s}, 1e-5),
        (
            "dT/dF",
            "m",
            of.force or 0.0,
            lambda s: {"actuation.force": shoe.actuation.force * (1 + s)},
            1e-4,
        ),
        (
            "dT/d ln E, lining",
            "N m",
            of.moduli["lining"],
            lambda s: {f"lining.material.{name}": E * (1 + s) for name, E in linings.items()},
            1e-4,
        ),
        (
            "dT/d ln E, shoe",
            "N m",
            of.moduli["shoe"],
            lambda s: {f"body.material.{name}": E * (1 + s) for name, E in bodies.items()},
            1e-4,
        ),
        ("dT/d clearance", "N", of.clearance, lambda s: {"lining.clearance": gap + s}, 1e-9),
        (
            "dT/dx, hinge",
            "N",
            float(of.held["hinge"][0]),
            lambda s: {"hinge": {"x": x + s, "y": y}},
            1e-6,
        ),
        (
            "dT/dy, hinge",
            "N",
            float(of.held["hinge"][1]),
            lambda s: {"hinge": {"x": x, "y": y + s}},
            1e-6,
        ),
    ]
    rows = []
    for what, unit, exact, changes, step in table:
        up, down = (
            solve(
                vary(
                    brake,
                    {k if k == "friction" else key + k: value for k, value in changes(s).items()},
                ),
                elements=elements,
                penalty=penalty,
            ).torque
            for s in (step, -step)
        )
        near = (up - down) / (2 * step * (shoe.actuation.force if what == "dT/dF" else 1.0))
        rows.append(
            {
                "what": what,
                "unit": unit,
                "exact": exact,
                "near": near,
                "difference": abs(exact / near - 1),
            }
        )
    return found, rows
