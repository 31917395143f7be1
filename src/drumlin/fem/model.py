"""The finite-element model: brake -> scene (meshed, condensed bodies) -> response.

`prepare` does what depends on geometry and stiffness; `respond` what depends on friction, rotation,
force, line of action, clearance and penalty, in milliseconds on the same scene.
"""

import math
from dataclasses import dataclass

import numpy as np

from drumlin import contact
from drumlin.arrays import Bools, Floats
from drumlin.brake import Brake, Shoe
from drumlin.errors import BadInput, NoAnswer
from drumlin.fem.interface import Coupling
from drumlin.fem.mesh import DEFAULT_KIND
from drumlin.fem.scene import ELEMENTS, Body, Scene, actuation, clock, held, prepare, shape_of
from drumlin.laws import locking_friction
from drumlin.response import Balance, Response, ShoeResponse, relative_balance, untouched, worst
from drumlin.statics import cross

PENALTY = 1e6
"""Default penalty factor alpha: eps = alpha E/t of the lining. The penetration p/eps is then 1e-6 of the
lining's own compression p t/E, and the pressure is off by about as much; each response states by how much."""
LARGEST_TURN = 0.2  # rad; beyond it small displacements are no longer a model of the shoe's motion


def solve(brake: Brake, *, elements: int = ELEMENTS, kind: str = DEFAULT_KIND, penalty: float = PENALTY) -> Response:
    """Mesh, condense and solve a brake: prepare, then respond."""
    return respond(prepare(brake, elements=elements, kind=kind), brake, penalty=penalty)


def respond(scene: Scene, brake: Brake, *, penalty: float = PENALTY) -> Response:
    """The response of a brake on a prepared scene of the same geometry and stiffness.

    penalty: factor alpha of the contact stiffness alpha E/t per area; math.inf for exact contact.
    Raises NoAnswer: self-locking, no equilibrium, not converged.
    """
    if not penalty > 0:
        raise BadInput(f"--penalty = {penalty}: must be greater than 0 (or inf)")
    if [shape_of(brake, s) for s in brake.shoes] != [shape_of(scene.brake, s) for s in scene.brake.shoes]:
        raise BadInput("the brake differs from the prepared scene in more than friction, rotation, load, clearance")
    if brake.friction > 0 and scene.brake.friction == 0:
        raise BadInput(f"friction = {brake.friction:g}: the scene was prepared without friction, for mu = 0 only")
    seconds = dict(scene.seconds)
    with clock(seconds, "contact"):
        answers = [_respond(body, brake, shoe, penalty) for body, shoe in zip(scene.bodies, brake.shoes, strict=True)]
    return Response(
        model="fem",
        shoes=tuple(answer.response for answer in answers),
        balance=worst([answer.balance for answer in answers]),
        iterations=max(answer.steps for answer in answers),
        seconds=seconds,
        left_out=scene.left_out,
        notes=tuple(answer.note for answer in answers),
    )


@dataclass(frozen=True)
class _Answer:
    response: ShoeResponse
    balance: Balance
    steps: int
    note: str


def gap_of(body: Body, brake: Brake, shoe: Shoe) -> Floats:
    """Gap of the unloaded lining at the contact nodes (n,) [m]: off the drum's radius, and the clearance."""
    theta, radius = shoe.frame.theta(body.line.phi), brake.drum.radius
    off = shoe.sign * (radius - np.hypot(*body.line.xy))
    return np.where(np.abs(off) < 1e-12 * radius, 0.0, off) + shoe.lining.clearance_at(theta)  # 0.0: not round-off


def contact_problem(body: Body, brake: Brake, shoe: Shoe, penalty: float = math.inf) -> contact.Problem:
    """Full slip of one shoe, the drum dragging its lining by mu p, as a complementarity problem.

    The weighted gap  w = M (g + p/eps) - N u  closes as the lining moves by u, elastically and with the shoe's
    turn y about its pin;  C p = h  is the balance of moments about the pin. All is in the shoe's frame and per
    newton of actuation, so that the force enters only through the gap.
    """
    drag = brake.friction * brake.spin * shoe.frame.sense
    load, moment = actuation(body, shoe)
    N, T, M = body.coupling.N, body.coupling.T, body.coupling.M
    approach = N @ body.turned  # per turn
    A, C = -body.closing_pressed, -approach
    if body.closing_dragged is not None:
        A, C = A - drag * body.closing_dragged, C + drag * (T @ body.turned)
    return contact.Problem(
        A=A + M / (penalty * shoe.lining.material.E / shoe.lining.thickness),
        q=M @ (gap_of(body, brake, shoe) / abs(shoe.actuation.force)) - body.closing_loaded @ load,
        B=-approach[:, None],
        C=C[None],
        h=np.array([-moment]),
    )


def _respond(body: Body, brake: Brake, shoe: Shoe, penalty: float) -> _Answer:
    frame, line, coupling = shoe.frame, body.line, body.coupling
    load, moment = actuation(body, shoe)
    sense = math.copysign(1.0, moment)
    approach = coupling.N @ body.turned
    size = abs(shoe.actuation.force)
    if size == 0 or abs(moment) <= 1e-14 * brake.drum.radius or (sense * approach <= 0).all():
        note = f"shoe {shoe.name!r}: no contact, the force does not turn it towards the drum"
        return _Answer(untouched(shoe, -shoe.actuation.vector), Balance(0.0, 0.0), 0, note)
    _check_reach(shoe, line.xy, gap_of(body, brake, shoe), sense)
    try:
        found = contact.solve(contact_problem(body, brake, shoe, penalty))
    except NoAnswer as error:
        raise NoAnswer(f"shoe {shoe.name!r}: {_locked(body, brake, shoe) or error}") from error
    if not found.regular:
        raise NoAnswer(f"shoe {shoe.name!r}: {_locked(body, brake, shoe) or 'self-locking, no stable equilibrium'}")

    p, load, moment = size * found.p, size * load, size * moment
    drag = brake.friction * brake.spin * frame.sense
    nodal = (drag * (coupling.T.T @ p) - coupling.N.T @ p).reshape(-1, 2)  # on the lining [N]
    reaction = held(body, p, drag, load)[:2]
    pin = np.array([shoe.hinge.radius, 0.0])
    balance = relative_balance(
        [nodal.sum(axis=0), reaction, load[:2]],
        [float(cross(line.xy.T, nodal).sum()), float(cross(pin, reaction)), moment + float(cross(pin, load[:2]))],
    )
    stiffness = penalty * shoe.lining.material.E / shoe.lining.thickness
    note = f"shoe {shoe.name!r}: " + (
        "exact contact, no penetration"
        if math.isinf(penalty)
        else f"penalty {penalty:g} E/t: the lining penetrates by {p.max() / stiffness:.1e} m at most, "
        f"which changes its torque by {_softening(found, coupling, stiffness):+.1e} of it"
    )
    forward = slice(None, None, frame.sense)
    theta = frame.theta(line.phi)[forward]
    response = ShoeResponse(
        name=shoe.name,
        torque=abs(drag) * float(coupling.lever @ p),
        normal_force=float(np.linalg.norm((coupling.N.T @ p).reshape(-1, 2).sum(axis=0))),
        self_energising=drag * float((coupling.T @ body.turned) @ p) * moment > 0,
        peak_pressure=float(p[_inside(line.phi, shoe.lining.thickness / (2 * brake.drum.radius))].max()),
        hinge_reaction=frame.to_brake(reaction),
        contact_arcs=_contact_arcs(theta, p[forward]),
        theta=theta,
        pressure=p[forward],
        order=line.order,
        turn=frame.sense * size * float(found.y[0]),
    )
    return _Answer(response, balance, found.steps, note)


def _inside(phi: Floats, zone: float) -> Bools:
    """Nodes more than `zone` [rad] from the ends; all where there are none."""
    inside = (phi > phi[0] + zone) & (phi < phi[-1] - zone)
    return inside if inside.any() else ~inside


def _softening(found: contact.Contact, coupling: Coupling, stiffness: float) -> float:
    """Relative change of Int p r ds (and so of the torque) by the compliance M/eps, to first order in 1/eps."""
    return float(coupling.lever @ found.tangent(coupling.M @ found.p)) / stiffness / float(coupling.lever @ found.p)


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


def _contact_arcs(theta: Floats, p: Floats) -> tuple[tuple[float, float], ...]:
    """Arcs [rad] in which the interpolated pressure is positive: steps between nodes with p > 0 at either end."""
    arcs: list[tuple[float, float]] = []
    for i in range(len(p) - 1):
        if p[i] > 0 or p[i + 1] > 0:
            if arcs and arcs[-1][1] == theta[i]:
                arcs[-1] = (arcs[-1][0], float(theta[i + 1]))
            else:
                arcs.append((float(theta[i]), float(theta[i + 1])))
    return tuple(arcs)


def _locked(body: Body, brake: Brake, shoe: Shoe) -> str:
    """What to say where there is no equilibrium because of friction; empty where friction is not the reason.

    The friction up to which there is an equilibrium, found by halving: the contact set changes on the way, so
    that no single eigenvalue gives it.
    """

    def holds(friction: float) -> bool:
        try:
            return contact.solve(
                contact_problem(body, brake.model_copy(update={"friction": friction}), shoe), most=25
            ).regular
        except NoAnswer:
            return False

    if not holds(0.0):
        return ""
    below, above = 0.0, brake.friction
    while above - below > 1e-4 * above:
        middle = 0.5 * (below + above)
        below, above = (middle, above) if holds(middle) else (below, middle)
    return (
        f"self-locking, no equilibrium at friction {brake.friction:g}; this elastic shoe has one up to "
        f"mu_lock = {below:.4g} (sine law: {locking_friction(brake, shoe):.4g})"
    )
