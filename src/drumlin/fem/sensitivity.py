"""Exact sensitivities of the torque of the elastic brake, from the tangent of its equations and not from differences.

On the contact set of the answer pressure and turn solve linear equations. One solution of their transpose for a
torque, its adjoint (a, b), holds what that torque feels of any small change of the brake:

    dT = -a^T (dq + dA p + dB y) + b^T (dh - dC p),     and besides  T/mu dmu.

Moduli act through the displacements u of the loads and v of the adjoint pressure: dT = -v^T dK u, with K the part of
the stiffness that is proportional to the modulus. Where a change makes the contact set change the torque has a kink,
and these are its slopes on the side of the present set. The body of the shoe stays in its place when its pin moves.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import scipy.sparse as sp

from drumlin.arrays import Floats
from drumlin.brake.drum_brake import Brake, Shoe
from drumlin.brake.file import vary
from drumlin.contact.active_set import Problem, adjoint
from drumlin.errors import BadInput, NoAnswer
from drumlin.fem.assembly import Body, Scene, actuation, materials_of, prepare
from drumlin.fem.body import FRAME, stiffness
from drumlin.fem.group import ShoeGroup, groups_of
from drumlin.fem.model import PENALTY, check_penalty
from drumlin.fem.solve import solve
from drumlin.laws import sine

PERCENT_PER_MM = 0.1  # in 1/m


@dataclass(frozen=True)
class ShoeSensitivity:
    """What one shoe's own torque, and what the brake's torque T [N m], feel of one shoe.

    Of the shoe's own torque [N m]: `torque`, `friction` d torque/dmu [N m], `S` = (mu/torque) d torque/dmu at fixed
    actuation, None where it is 0. Of the brake's: dT by its `force` [m], by the logarithm of each modulus, `moduli`
    [N m] of "lining", "backing", "shoe", by a `clearance` even along its lining [N], by the hinge's place, `hinge`
    (2,) [N] along x and y of the brake, by the logarithm of the contact stiffness, `penalty` [N m]. `density` (n,)
    [N/m] at the angles `theta` (n,) [rad], growing: dT by clearance and length of arc, 0 off the contact.
    """

    name: str
    torque: float
    friction: float
    S: float | None
    force: float
    moduli: dict[str, float]
    clearance: float
    hinge: Floats
    penalty: float
    theta: Floats
    density: Floats


@dataclass(frozen=True)
class Sensitivity:
    """Sensitivities of a brake: its `torque` T [N m], `friction` dT/dmu [N m], `S` = (mu/T) dT/dmu of the whole.

    `ring`: dT by the logarithm of the drum ring's modulus [N m], None for a rigid drum. `law`: S of the sine law, of
    each shoe and then of the whole, where it has an answer.
    """

    friction_coefficient: float
    torque: float
    friction: float
    S: float | None
    ring: float | None
    shoes: tuple[ShoeSensitivity, ...]
    law: tuple[float | None, ...] | None

    def as_dict(self) -> dict[str, Any]:
        """As plain data for JSON (SI)."""
        shoes = [
            vars(shoe) | {key: getattr(shoe, key).tolist() for key in ("hinge", "theta", "density")}
            for shoe in self.shoes
        ]
        return vars(self) | {"shoes": shoes, "law": None if self.law is None else list(self.law)}


def sensitivity(scene: Scene, brake: Brake, *, penalty: float = PENALTY) -> Sensitivity:
    """Sensitivities of the torque of a brake on a prepared scene.

    Raises NoAnswer as `respond` does, and for a brake without friction, which has no torque; BadInput likewise.
    """
    check_penalty(penalty)
    brake.check_hinged("sensitivity")
    if brake.friction == 0:
        raise NoAnswer("sensitivity: without friction there is no torque")
    if scene.brake.friction == 0:
        raise BadInput(f"friction = {brake.friction:g}: the scene was prepared without friction, for mu = 0 only")
    shoes: dict[int, ShoeSensitivity] = {}
    ring = 0.0
    for group in groups_of(scene, brake, penalty):
        found, of_ring = _group(group)
        shoes |= dict(zip(group.members, found, strict=True))
        ring += of_ring
    all_shoes = tuple(
        shoes[i] if i in shoes else _untouched(scene.bodies[i], shoe) for i, shoe in enumerate(brake.shoes)
    )
    torque, friction = (math.fsum(getattr(s, key) for s in all_shoes) for key in ("torque", "friction"))
    return Sensitivity(
        friction_coefficient=brake.friction,
        torque=torque,
        friction=friction,
        S=_relative(brake.friction, friction, torque),
        ring=None if scene.ring is None else ring,
        shoes=all_shoes,
        law=law_sensitivity(brake),
    )


def as_text(found: Sensitivity, brake: Brake) -> list[str]:
    """The sensitivities in lines for people; elasticities are d ln T / d ln x of the whole torque."""

    def said(S: float | None) -> str:
        return "none" if S is None else f"{S:.5g}"

    law = found.law or (None,) * (len(found.shoes) + 1)
    lines = [
        f"torque {found.torque:.6g} N m, dT/dmu {found.friction:.6g} N m, "
        f"S = (mu/T) dT/dmu = {said(found.S)} (sine law: {said(law[-1])})"
    ]
    T = found.torque or math.inf
    if found.ring is not None:
        lines.append(f"  d ln T/d ln E of the drum ring {found.ring / T:+.4g}")
    for shoe, own, of_law in zip(brake.shoes, found.shoes, law, strict=False):
        moduli = ", ".join(f"{name} {value / T:+.4g}" for name, value in own.moduli.items())
        x, y = own.hinge / T
        lines += [
            f"  shoe {own.name!r}: torque {own.torque:.6g} N m, dT/dmu {own.friction:.6g} N m, S {said(own.S)} "
            f"(sine law: {said(of_law)}); of the whole torque:",
            f"    d ln T/d ln force {own.force * shoe.actuation.force / T:+.4g}; d ln T/d ln E: {moduli}; "
            f"d ln T/d ln penalty {own.penalty / T:+.1e}",
            f"    clearance {own.clearance / T * 1e-3 * PERCENT_PER_MM:+.4g} %/µm; "
            f"hinge along x {x * PERCENT_PER_MM:+.4g} %/mm, along y {y * PERCENT_PER_MM:+.4g} %/mm",
        ]
    return lines


def law_sensitivity(brake: Brake) -> tuple[float | None, ...] | None:
    """S of the sine law, exact since its pressure keeps its shape (UWA notes, eq. 8): each shoe's, the whole's."""
    try:
        response = sine(brake)
    except (BadInput, NoAnswer):
        return None
    each = [None if m is None else m.sensitivity_at_fixed_shape for m in response.merits]
    total = math.fsum((s or 0.0) * shoe.torque for s, shoe in zip(each, response.shoes, strict=True))
    return (*each, total / response.torque if response.torque else None)


def _relative(x: float, slope: float, value: float) -> float | None:
    return x * slope / value if value else None


class _Adjoint(NamedTuple):
    """A shoe's part of the adjoint of the brake's torque: a (n,), b; and of the answer: p (n,) [Pa], turn [rad]."""

    a: Floats
    b: float
    p: Floats
    turn: float


def _group(group: ShoeGroup) -> tuple[list[ShoeSensitivity], float]:
    """The sensitivities of shoes that meet the drum together, and dT by the logarithm of the ring's modulus."""
    found, size, mu, sliding, lever = (
        group.answer(),
        group.unit_force,
        group.brake.friction,
        group.sliding,
        group.levers,
    )
    problem: Problem = sliding.at(mu)
    a, b = adjoint(problem, found.active, mu * lever)
    by_friction = lever.T @ found.p - a.T @ (sliding.A1 @ found.p) - b.T @ (sliding.C1 @ found.p)
    torque = mu * (lever.T @ found.p)
    a_T, b_T, shoes = a.sum(axis=1), b.sum(axis=1), []
    for k, part in enumerate(group.parts):
        adjoint_ = _Adjoint(a_T[part], float(b_T[k]), size * found.p[part], size * float(found.y[k]))
        own = size * float(torque[k]), size * float(by_friction[k])
        shoes.append(_shoe(group, k, adjoint_, *own))
    if group.ring is None:
        return shoes, 0.0
    pressed, dragged = group.ring
    return shoes, size * float((pressed @ a_T) @ ((pressed + group.brake.drag * dragged) @ found.p))


def _shoe(group: ShoeGroup, k: int, at: _Adjoint, torque: float, friction: float) -> ShoeSensitivity:
    body, brake, shoe = group.bodies[k], group.brake, group.shoes[k]
    frame, N, T, M = shoe.frame, body.coupling.N, body.coupling.T, body.coupling.M
    drag = brake.drag_on(shoe)
    load, moment = actuation(body, shoe)
    sign, force = math.copysign(1.0, shoe.actuation.force), abs(shoe.actuation.force)
    soft = float(at.a @ (M @ at.p)) / group.stiffnesses[k]
    # The pin moved by e_x or e_y turns the lining about another point: k x (x - pin) changes by -k x e.
    turned = np.tile(np.array([[0.0, 1.0], [-1.0, 0.0]]), (len(at.p), 1))
    direction = frame.to_shoe(shoe.actuation.direction_vector) * sign * force
    arm = np.array([direction[1], -direction[0]])  # -d moment / d pin, in newtons
    hinge = at.turn * (at.a @ N) @ turned + at.b * (at.p @ (N - drag * T)) @ turned + at.b * arm
    forward = slice(None, None, frame.sense)
    return ShoeSensitivity(
        name=shoe.name,
        torque=torque,
        friction=friction,
        S=_relative(brake.friction, friction, torque),
        force=sign * float(at.a @ (body.closing_loaded @ load) - at.b * moment),
        moduli=_moduli(body, shoe, at, drag, force * load, soft),
        clearance=-float(at.a @ M.sum(axis=1)),
        hinge=frame.to_brake(hinge),
        penalty=soft,
        theta=frame.theta(body.line.phi)[forward],
        density=-shoe.lining.width * at.a[forward],
    )


def _moduli(body: Body, shoe: Shoe, at: _Adjoint, drag: float, load: Floats, soft: float) -> dict[str, float]:
    """dT by the logarithm of each modulus [N m]; the lining's is in the contact stiffness alpha E/t too."""
    N, T = body.coupling.N, body.coupling.T
    nodal = np.column_stack([drag * (T.T @ at.p) - N.T @ at.p, N.T @ at.a])
    loads = np.column_stack([load, np.zeros(len(load))])
    u = body.condensed.displacements(nodal, np.zeros((FRAME, 2)), loads)
    effects: dict[str, float] = {}
    for name, (material, width) in materials_of(shoe).items():
        parts = {other: (material, width if other == name else 0.0) for other in materials_of(shoe)}
        K: sp.csc_matrix = stiffness(body.basis, parts)
        own = "shoe" if name == "table" else name  # of one material
        effects[own] = effects.get(own, 0.0) - float(u[:, 1] @ (K @ u[:, 0])) + (soft if name == "lining" else 0.0)
    return effects


def _untouched(body: Body, shoe: Shoe) -> ShoeSensitivity:
    """Of a shoe that its force does not press: nothing changes its torque of 0."""
    theta = shoe.frame.theta(body.line.phi)[:: shoe.frame.sense]
    none = dict.fromkeys(materials_of(shoe), 0.0)
    return ShoeSensitivity(shoe.name, 0.0, 0.0, None, 0.0, none, 0.0, np.zeros(2), 0.0, theta, np.zeros(len(theta)))


def against_differences(
    brake: Brake, index: int, *, elements: int, penalty: float = PENALTY
) -> tuple[Sensitivity, list[dict[str, Any]]]:
    """Slopes of the whole torque next to central differences of solves from the mesh up; a row each.

    Force, moduli, clearance (one number) and hinge are those of shoe `index`, which has an elastic body. Rows: `what`,
    `unit`, `exact`, `near`, relative `difference`. Raises as `solve` does.
    """
    found = sensitivity(prepare(brake, elements=elements), brake, penalty=penalty)
    mu, shoe, of, key = brake.friction, brake.shoes[index], found.shoes[index], f"shoe[{index}]."
    gap, body, material = shoe.lining.clearance, shoe.body, shoe.lining.material
    assert isinstance(gap, float) and body is not None and body.material is not None
    E, x, y = body.material.E, shoe.pin.x, shoe.pin.y
    table: list[tuple[str, str, float, Callable[[float], dict[str, Any]], float]] = [
        ("dT/dμ", "N m", found.friction, lambda s: {"friction": mu + s}, 1e-5),
        ("dT/dF", "m", of.force, lambda s: {"actuation.force": shoe.actuation.force * (1 + s)}, 1e-4),
        ("dT/d ln E, lining", "N m", of.moduli["lining"], lambda s: {"lining.material.E": material.E * (1 + s)}, 1e-4),
        ("dT/d ln E, shoe", "N m", of.moduli["shoe"], lambda s: {"body.material.E": E * (1 + s)}, 1e-4),
        ("dT/d clearance", "N", of.clearance, lambda s: {"lining.clearance": gap + s}, 1e-9),
        ("dT/dx, hinge", "N", float(of.hinge[0]), lambda s: {"hinge": {"x": x + s, "y": y}}, 1e-6),
        ("dT/dy, hinge", "N", float(of.hinge[1]), lambda s: {"hinge": {"x": x, "y": y + s}}, 1e-6),
    ]
    rows = []
    for what, unit, exact, changes, step in table:
        up, down = (
            solve(
                vary(brake, {k if k == "friction" else key + k: value for k, value in changes(s).items()}),
                elements=elements,
                penalty=penalty,
            ).torque
            for s in (step, -step)
        )
        near = (up - down) / (2 * step * (shoe.actuation.force if what == "dT/dF" else 1.0))
        rows.append({"what": what, "unit": unit, "exact": exact, "near": near, "difference": abs(exact / near - 1)})
    return found, rows
