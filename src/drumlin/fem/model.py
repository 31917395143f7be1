"""The finite-element model: brake -> scene (meshed, condensed bodies) -> response.

`prepare` does what depends on geometry and stiffness; `respond` what depends on friction, rotation,
force, line of action, clearance and penalty, in milliseconds on the same scene.
"""

import math
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.linalg

from drumlin import contact
from drumlin.brake import Brake, Floats, Shoe
from drumlin.errors import BadInput, NoAnswer
from drumlin.fem.body import FRAME, Condensed, condense, scalar_basis, stiffness, tie
from drumlin.fem.interface import ContactLine, Coupling, Ints, contact_line, couple
from drumlin.fem.mesh import shoe_mesh
from drumlin.response import Balance, Response, ShoeResponse, relative_balance, untouched, worst

ELEMENTS = 120
PENALTY = 1e6
"""Default penalty factor alpha: eps = alpha E/t of the lining. The penetration p/eps is then 1e-6 of the
lining's own compression p t/E, and the torque is off by about as much (each response states it)."""
LARGEST_TURN = 0.2  # rad; beyond it small displacements are no longer a model of the shoe's motion

Seconds = dict[str, float]


@contextmanager
def clock(seconds: Seconds, phase: str) -> Iterator[None]:
    """Add the time of the block to seconds[phase]."""
    start = time.perf_counter()
    yield
    seconds[phase] = seconds.get(phase, 0.0) + time.perf_counter() - start


@dataclass(frozen=True)
class Body:
    """One shoe with its lining, condensed, in its own frame (angle phi from the hinge).

    `pressed`, `dragged` (2n, n) and `loaded` (2n, 3): contact displacements, with the frame held, under the
    nodal forces -N^T and T^T and under the unit actuations (force x, force y, couple about `load_centre`).
    `turned` (2n,): contact displacement per turn [rad] about the pin. `closing_*` = N times these: what they
    take from the weighted gap. `held_*` (3, ...): the force x, y and moment that holds the frame meanwhile.
    """

    mesh: Any
    basis: Any
    line: ContactLine
    coupling: Coupling
    condensed: Condensed
    load_centre: Floats
    turned: Floats
    pressed: Floats
    dragged: Floats
    loaded: Floats
    closing_pressed: Floats
    closing_dragged: Floats
    closing_loaded: Floats
    closing_turned: Floats
    held_pressed: Floats
    held_dragged: Floats
    held_loaded: Floats

    @property
    def unknowns(self) -> int:
        """Number of displacement unknowns of the mesh."""
        return int(2 * self.basis.N)


@dataclass(frozen=True)
class Scene:
    """A brake made ready: a condensed body for each shoe (equal shoes share one), and what that cost."""

    brake: Brake
    bodies: tuple[Body, ...]
    seconds: Seconds
    left_out: tuple[str, ...]


def why_not(brake: Brake) -> str | None:
    """Why finite elements do not apply to a brake (None: they do)."""
    if brake.drum.ring is not None:
        return "an elastic drum ring is not modelled yet; leave out [drum.ring] for a rigid drum"
    return None


def solve(
    brake: Brake, *, elements: int = ELEMENTS, penalty: float = PENALTY
) -> Response:
    """Mesh, condense and solve a brake: prepare, then respond."""
    return respond(prepare(brake, elements=elements), brake, penalty=penalty)


def _shape_of(brake: Brake, shoe: Shoe) -> tuple[object, ...]:
    """What a body depends on: equal for shoes that are the same but for place, hand, load and clearance."""
    if shoe.mesh is not None:
        return (shoe.mesh, shoe.frame, shoe.hinge)
    arcs = [shoe.arc]
    if shoe.body is not None:
        arcs.append(tuple(sorted(shoe.frame.phi(np.array([shoe.body.start, shoe.body.end])).tolist())))
    lining, body = shoe.lining, shoe.body
    return (
        brake.drum.radius,
        shoe.side,
        round(shoe.hinge.radius / brake.drum.radius, 12),
        tuple(round(angle, 12) for arc in arcs for angle in arc),
        (lining.thickness, lining.width, lining.material),
        shoe.backing,
        None if body is None else (body.shape, body.thickness, body.width, body.material),
    )


def prepare(brake: Brake, *, elements: int = ELEMENTS) -> Scene:
    """Mesh and condense the bodies of a brake; shoes of one shape share one body.

    elements: number along each parametric lining. Raises BadInput for a brake that finite elements do not
    cover, and for a mesh file that cannot serve.
    """
    reason = why_not(brake)
    if reason is not None:
        raise BadInput(f"fem does not apply to this brake: {reason}")
    if not 1 <= elements <= 100_000:
        raise BadInput(f"--elements = {elements}: must be from 1 to 100000")
    seconds: Seconds = {}
    made: dict[tuple[object, ...], Body] = {}
    bodies = []
    for shoe in brake.shoes:
        key = _shape_of(brake, shoe)
        if key not in made:
            made[key] = _body(brake, shoe, elements, seconds)
        bodies.append(made[key])
    left_out = ["drum: rigid, no [drum.ring] in the brake", "interior fields: recovered only for a picture"]
    if len(made) < len(bodies):
        left_out.append(f"{len(bodies) - len(made)} of {len(bodies)} shoes: same shape as another, condensed once")
    for shoe in brake.shoes:
        if shoe.mesh is None and shoe.body is None:
            left_out.append(f"shoe {shoe.name!r}: rigid, no [shoe.body]; only its lining is meshed")
    return Scene(brake, tuple(bodies), seconds, tuple(left_out))


def _body(brake: Brake, shoe: Shoe, elements: int, seconds: Seconds) -> Body:
    with clock(seconds, "mesh"):
        mesh = shoe_mesh(shoe, brake.drum.radius, elements)
        basis = scalar_basis(mesh)
    with clock(seconds, "assembly"):
        materials = {"lining": (shoe.lining.material, shoe.lining.width)}
        if shoe.backing is not None:
            materials["backing"] = (shoe.backing.material, shoe.lining.width)
        if shoe.body is not None:
            materials["shoe"] = (shoe.body.material, shoe.body.width)
        K = stiffness(basis, materials)
    with clock(seconds, "condensation"):
        pin = np.array([shoe.hinge.radius, 0.0])
        line = contact_line(basis, mesh.boundaries["contact"], sum(shoe.arc) / 2)
        n = len(line.nodes)
        rigid = basis.get_dofs(mesh.boundaries["hinge"]).flatten()
        ties = tie(basis, line.nodes, rigid, pin)
        if "actuation" in mesh.boundaries:
            full, load_centre = end_loads(basis, mesh.boundaries["actuation"])
            forces = ties.T @ full
        else:  # the force acts on the rigid shoe itself
            forces, load_centre = np.zeros((ties.shape[1], 3)), pin
            forces[-FRAME:] = np.eye(3)
        condensed = condense(K, ties, forces, 2 * n + FRAME)
    with clock(seconds, "coupling"):
        coupling = couple(line, shoe.lining.width, shoe.sign)
        S, N = condensed.S, coupling.N
        right = np.hstack([-N.T, coupling.T.T, condensed.loads[: 2 * n]])
        flexibility = scipy.linalg.cho_solve(scipy.linalg.cho_factor(S[: 2 * n, : 2 * n]), right)
        pressed, dragged, loaded = np.split(flexibility, [n, 2 * n], axis=1)
        closing, held = N @ flexibility, S[2 * n :, : 2 * n] @ flexibility
        x, y = line.xy - pin[:, None]
        turned = np.column_stack([-y, x]).ravel()
        return Body(
            mesh=mesh,
            basis=basis,
            line=line,
            coupling=coupling,
            condensed=condensed,
            load_centre=load_centre,
            turned=turned,
            pressed=pressed,
            dragged=dragged,
            loaded=loaded,
            closing_pressed=closing[:, :n],
            closing_dragged=closing[:, n : 2 * n],
            closing_loaded=closing[:, 2 * n :],
            closing_turned=N @ turned,
            held_pressed=held[:, :n],
            held_dragged=held[:, n : 2 * n],
            held_loaded=held[:, 2 * n :] - condensed.loads[2 * n :],
        )


def end_loads(basis: Any, facets: Ints) -> tuple[Floats, Floats]:
    """Nodal forces (2 nodes, 3) of a traction on the loaded end: unit force in x, in y, unit couple; and its centre.

    The force is spread evenly, the couple as a traction that grows linearly from the centre (2,) [m].
    """
    edge = basis.boundary(facets)
    x, weight = np.asarray(edge.global_coordinates()), edge.dx
    length = weight.sum()
    centre = (x * weight).sum(axis=(1, 2)) / length
    arm = x - centre[:, None, None]
    inertia = float((arm**2 * weight).sum())
    turn = np.array([-arm[1], arm[0]]) / inertia
    ones, zeros = np.full(weight.shape, 1 / length), np.zeros(weight.shape)
    loads = np.zeros((basis.N, 2, 3))
    for k, traction in enumerate(([ones, zeros], [zeros, ones], turn)):
        for c in range(2):
            for psi, dofs in zip(edge.basis, edge.element_dofs, strict=True):
                np.add.at(loads[:, c, k], dofs, (psi[0] * traction[c] * weight).sum(axis=1))
    return loads.reshape(-1, 3), centre


def respond(scene: Scene, brake: Brake, *, penalty: float = PENALTY) -> Response:
    """The response of a brake on a prepared scene of the same geometry and stiffness.

    penalty: factor alpha of the contact stiffness alpha E/t per area; math.inf for exact contact.
    Raises NoAnswer: self-locking, no equilibrium, not converged.
    """
    if not penalty > 0:
        raise BadInput(f"--penalty = {penalty}: must be greater than 0 (or inf)")
    if [_shape_of(brake, s) for s in brake.shoes] != [_shape_of(scene.brake, s) for s in scene.brake.shoes]:
        raise BadInput("the brake differs from the prepared scene in more than friction, rotation, load, clearance")
    seconds = dict(scene.seconds)
    with clock(seconds, "contact"):
        answers = [_respond(body, brake, shoe, penalty) for body, shoe in zip(scene.bodies, brake.shoes, strict=True)]
    left_out = list(scene.left_out)
    if brake.friction == 0:
        left_out.append("friction: mu = 0")
    return Response(
        model="fem",
        shoes=tuple(answer.response for answer in answers),
        balance=worst([answer.balance for answer in answers]),
        iterations=max(answer.steps for answer in answers),
        seconds=seconds,
        left_out=tuple(left_out),
        notes=tuple(answer.note for answer in answers),
    )


@dataclass(frozen=True)
class _Answer:
    response: ShoeResponse
    balance: Balance
    steps: int
    note: str


def _respond(body: Body, brake: Brake, shoe: Shoe, penalty: float) -> _Answer:
    """Full slip of one shoe: the drum drags the lining with mu p everywhere in contact."""
    frame, line, coupling = shoe.frame, body.line, body.coupling
    drag = brake.friction * brake.spin * frame.sense
    load, moment = _load(body, shoe)
    gap = shoe.sign * (brake.drum.radius - np.hypot(*line.xy)) + shoe.lining.clearance_at(frame.theta(line.phi))
    sense = math.copysign(1.0, moment)
    if abs(moment) <= 1e-14 * shoe.actuation.force * brake.drum.radius or (sense * body.closing_turned <= 0).all():
        note = f"shoe {shoe.name!r}: no contact, the force does not turn it towards the drum"
        return _Answer(untouched(shoe, -shoe.actuation.vector), Balance(0.0, 0.0), 0, note)
    _check_reach(shoe, line.xy, gap, sense)

    stiffness = shoe.lining.material.E / shoe.lining.thickness  # per area, of the lining
    M = coupling.M
    A = -body.closing_pressed - drag * body.closing_dragged + M / (penalty * stiffness)
    q = M @ gap - body.closing_loaded @ load
    B = -body.closing_turned[:, None]
    C = (drag * (coupling.T @ body.turned) - coupling.N @ body.turned)[None]
    try:
        found = contact.solve(A, q, B, C, np.array([-moment]))
    except NoAnswer as error:
        raise NoAnswer(f"shoe {shoe.name!r}: {error}{_locking(body, brake, shoe)}") from error
    if not found.regular:
        raise NoAnswer(f"shoe {shoe.name!r}: no stable equilibrium{_locking(body, brake, shoe)}")

    p = found.p
    nodal = (drag * (coupling.T.T @ p) - coupling.N.T @ p).reshape(-1, 2)  # on the lining [N]
    pin = np.array([shoe.hinge.radius, 0.0])
    contact_force, contact_moment = nodal.sum(axis=0), float(_cross(line.xy.T, nodal).sum())
    held = body.held_pressed @ p + drag * (body.held_dragged @ p) + body.held_loaded @ load
    reaction = held[:2]
    balance = relative_balance(
        [contact_force, reaction, load[:2]],
        [contact_moment, float(_cross(pin, reaction)), moment + float(_cross(pin, load[:2]))],
    )
    torque = abs(drag) * float(coupling.lever @ p)
    softening = contact.tangent(A, M @ p, B, C, found.active) / (penalty * stiffness)
    note = (
        f"shoe {shoe.name!r}: penalty {penalty:g} E/t lets the lining penetrate by "
        f"{p.max() / (penalty * stiffness):.1e} m at most and changes its normal force by "
        f"{float(coupling.lever @ softening) / float(coupling.lever @ p):.1e} of it"
    )
    forward = slice(None, None, frame.sense)
    response = ShoeResponse(
        name=shoe.name,
        torque=torque,
        normal_force=float(np.linalg.norm(coupling.N.T @ p @ np.tile(np.eye(2), (len(p), 1)))),
        self_energising=drag * float((coupling.T @ body.turned) @ p) * moment > 0,
        peak_pressure=float(p.max()),
        hinge_reaction=frame.to_brake(reaction),
        contact_arcs=_contact_arcs(frame.theta(line.phi)[forward], p[forward], line.order),
        theta=frame.theta(line.phi)[forward],
        pressure=p[forward],
        order=line.order,
        turn=frame.sense * float(found.y[0]),
    )
    return _Answer(response, balance, found.steps, note)


def _load(body: Body, shoe: Shoe) -> tuple[Floats, float]:
    """Factors of the body's unit actuations (force x, force y, couple) and the moment about the pin, shoe's frame."""
    force, point = shoe.frame.to_shoe(shoe.actuation.vector), shoe.frame.to_shoe(shoe.actuation.point.xy)
    couple_ = float(_cross(point - body.load_centre, force))
    return np.array([*force, couple_]), float(_cross(point - np.array([shoe.hinge.radius, 0.0]), force))


def _cross(a: Floats, b: Floats) -> Floats:
    """The out-of-plane component of a x b, (..., 2)."""
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


def _check_reach(shoe: Shoe, xy: Floats, gap: Floats, sense: float) -> None:
    """Raise NoAnswer where the shoe would have to turn too far to touch, or could turn for ever.

    A lining point at distance d from the pin and angle psi reaches the radius r when it has turned by
    alpha: r^2 = a^2 + d^2 + 2 a d cos(psi + alpha), with a the pin's distance from the drum's centre.
    """
    if (gap <= 0).any():
        return
    a, r = shoe.hinge.radius, np.hypot(*xy)
    v = xy * ((r - shoe.sign * gap) / r) - np.array([[a], [0.0]])  # the lining stands back by its gap
    d, psi = np.hypot(*v), np.arctan2(v[1], v[0])
    cosine = (r**2 - a**2 - d**2) / (2 * a * d)
    meets = np.abs(cosine) <= 1
    if not meets.any():
        raise NoAnswer(f"shoe {shoe.name!r}: no equilibrium, the force turns it without its ever touching the drum")
    angle = np.arccos(cosine[meets])
    turns = sense * (np.concatenate([angle, -angle]) - np.tile(psi[meets], 2)) % (2 * math.pi)
    if turns.min() > LARGEST_TURN:
        raise NoAnswer(
            f"shoe {shoe.name!r}: it would have to turn by {math.degrees(turns.min()):.3g} deg to touch the drum; "
            f"small displacements hold up to {math.degrees(LARGEST_TURN):.3g} deg"
        )


def _contact_arcs(theta: Floats, p: Floats, order: int) -> tuple[tuple[float, float], ...]:
    """Arcs [rad] in which the interpolated pressure is positive: steps between nodes with p > 0 at either end."""
    arcs: list[tuple[float, float]] = []
    for i in range(len(p) - 1):
        if p[i] > 0 or p[i + 1] > 0:
            if arcs and arcs[-1][1] == theta[i]:
                arcs[-1] = (arcs[-1][0], float(theta[i + 1]))
            else:
                arcs.append((float(theta[i]), float(theta[i + 1])))
    return tuple(arcs)


def _locking(body: Body, brake: Brake, shoe: Shoe) -> str:
    """What to say of friction when there is no equilibrium: where the elastic shoe locks, near its frictionless state.

    K(mu) = K_0 + mu K_1 on the whole lining is singular at the smallest positive real eigenvalue.
    """
    if brake.friction == 0:
        return ""
    n = len(body.line.nodes)
    spin = brake.spin * shoe.frame.sense
    K = np.zeros((2, n + 1, n + 1))
    K[0, :n, :n], K[1, :n, :n] = -body.closing_pressed, -spin * body.closing_dragged
    K[0, :n, n] = K[0, n, :n] = -body.closing_turned
    K[1, n, :n] = spin * (body.coupling.T @ body.turned)
    scale = 1 / np.sqrt(np.append(np.diagonal(K[0])[:n], np.abs(K[0, n, :n]).max() ** 2 / np.diagonal(K[0]).max()))
    K = K * scale[:, None] * scale
    mu = scipy.linalg.eigvals(K[0], -K[1])
    real = mu.real[np.isfinite(mu) & (np.abs(mu.imag) < 1e-6 * np.abs(mu)) & (mu.real > 0)]
    if not real.size or real.min() > brake.friction:
        return ""
    return (
        f" (self-locking: friction = {brake.friction:g}; with its whole lining in contact this shoe locks itself "
        f"at {real.min():.4g})"
    )
