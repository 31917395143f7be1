"""The finite-element model: brake -> scene (meshed, condensed bodies) -> response.

`prepare` does what depends on geometry and stiffness; `respond` what depends on friction, rotation,
force, line of action, clearance and penalty, in milliseconds on the same scene.
"""

import math
from dataclasses import dataclass
from functools import partial
from itertools import pairwise

import numpy as np
import scipy.linalg

from drumlin import contact, locking, misfit
from drumlin.arrays import Bools, Floats
from drumlin.brake import Brake, Shoe
from drumlin.errors import BadInput, NoAnswer
from drumlin.fem.adapt import adapt as adapt_meshes
from drumlin.fem.ends import contact_arcs
from drumlin.fem.hp.adapt import DEFAULT, adapt
from drumlin.fem.mesh import DEFAULT_KIND
from drumlin.fem.omission import adapt_without
from drumlin.fem.scene import (
    ELEMENTS,
    Body,
    Kept,
    Scene,
    actuation,
    clock,
    contact_stiffness,
    held,
    pin_of,
    prepare,
    shape_of,
)
from drumlin.fem.whole import Refined, refine, whole
from drumlin.laws import locking_friction
from drumlin.response import Balance, Response, ShoeResponse, relative_balance, untouched, worst
from drumlin.statics import cross, largest

PENALTY = 1e6
"""Default penalty factor alpha: eps = alpha E/t of the lining. The penetration p/eps is then 1e-6 of the
lining's own compression p t/E, and the pressure is off by about as much; each response states by how much."""
REFINED_FROM = 1e-9  # relative imbalance from which on the condensed bodies have lost too many digits
MOST_REFINED = 60_000  # unknowns of a group of shoes up to which that is done before it must be: it takes seconds
LARGEST_IMBALANCE = 1e-8  # one that balances worse, though refined, is no answer
LARGEST_LOSS = 1e-6  # relative, of a condensed body
LARGEST_CORRECTION = 1e-6  # relative, of the pressures, by the last step of a refinement
SETTLED = 1e-10  # relative correction up to which another form of the whole system is not tried
TOO_FAR = "stiffnesses or sizes are too far apart for the arithmetic"
REFINED = "refined in the whole system, condensed it loses digits"
LARGEST_TURN = 0.2  # rad; beyond it small displacements are no longer a model of the shoe's motion


def solve(
    brake: Brake,
    *,
    elements: int | None = None,
    kind: str | None = None,
    tolerance: float | None = None,
    penalty: float = PENALTY,
    kept: Kept | None = None,
) -> Response:
    """Divide, condense and solve a brake, finer and finer until its estimated errors are below a tolerance.

    tolerance: of the estimated relative errors of p (L2, outside the edge zones) and of the torque, of the division and
    of what is left out for it; NoAnswer is raised where it is not reached. By default DEFAULT, or the error that is
    reached. With `elements` a brake is solved on one mesh, without estimate, as one with a mesh file is; with a `kind`
    on meshes of that kind. BadInput is raised for elements and a tolerance together. kept: bodies of earlier solves on
    meshes, see `prepare`.
    """
    meshed = elements is not None or kind is not None or any(shoe.mesh is not None for shoe in brake.shoes)
    answer = partial(respond, penalty=penalty)
    if tolerance is None and not meshed:
        check_penalty(penalty)
        return adapt(brake, DEFAULT, answer, must=False)
    if tolerance is None:
        scene = prepare(
            brake, elements=ELEMENTS if elements is None else elements, kind=kind or DEFAULT_KIND, kept=kept
        )
        return answer(scene, brake)
    if elements is not None:
        raise BadInput(f"--tolerance = {tolerance:g}: chooses the elements; leave out --elements = {elements}")
    if kind is not None:  # a studied method
        return adapt_meshes(brake, tolerance, answer, kind)
    return adapt_without(brake, tolerance, answer)


def respond(scene: Scene, brake: Brake, *, penalty: float = PENALTY, start: Response | None = None) -> Response:
    """The response of a brake on a prepared scene of the same geometry and stiffness.

    penalty: factor alpha of the contact stiffness alpha E/t per area; math.inf for exact contact. start: a
    response of a similar brake or on another mesh, whose contact is the first guess: it saves steps and does
    not change the answer. Raises NoAnswer: self-locking, no equilibrium, not converged.
    """
    check_penalty(penalty)
    if [shape_of(brake, s) for s in brake.shoes] != [shape_of(scene.brake, s) for s in scene.brake.shoes]:
        raise BadInput("the brake differs from the prepared scene in more than friction, rotation, load, clearance")
    if brake.friction > 0 and scene.brake.friction == 0:
        raise BadInput(f"friction = {brake.friction:g}: the scene was prepared without friction, for mu = 0 only")
    if brake.drum.ring != scene.brake.drum.ring:
        raise BadInput("the brake's drum.ring differs from that of the prepared scene")
    seconds = dict(scene.seconds)
    with clock(seconds, "contact"):
        answers: dict[int, _Answer] = {}
        for group in groups_of(scene, brake):
            answers |= _answers(scene, brake, group, penalty, start)
        for i in set(range(len(brake.shoes))) - set(answers):
            answers[i] = _untouched(brake.shoes[i])
    balance = worst([answer.balance for answer in answers.values()])
    return Response(
        model="fem",
        shoes=tuple(answers[i].response for i in sorted(answers)),
        balance=balance,
        iterations=max(answer.steps for answer in answers.values()),
        seconds=seconds,
        left_out=scene.left_out,
        notes=tuple(answers[i].note for i in sorted(answers)),
    )


def check_penalty(penalty: float) -> None:
    """Raise BadInput for a factor of the contact stiffness that is none."""
    if not penalty > 0:
        raise BadInput(f"--penalty = {penalty}: must be greater than 0 (or inf)")


@dataclass(frozen=True)
class _Answer:
    response: ShoeResponse
    balance: Balance
    steps: int
    note: str


def turns_towards(body: Body, shoe: Shoe) -> bool:
    """Whether the force turns the shoe towards the drum, at one lining point at least."""
    if shoe.actuation.force == 0:
        return False
    _, moment = actuation(body, shoe)
    approach = body.coupling.N @ body.turned
    return bool(abs(moment) > 1e-14 * np.abs(body.line.xy).max() and (moment * approach > 0).any())


def _untouched(shoe: Shoe) -> _Answer:
    note = f"shoe {shoe.name!r}: no contact, the force does not turn it towards the drum"
    return _Answer(untouched(shoe, -shoe.actuation.vector), Balance(0.0, 0.0), 0, note)


def gap_of(body: Body, brake: Brake, shoe: Shoe) -> Floats:
    """Gap of the unloaded lining at the contact nodes (n,) [m]: off the drum's radius, clearance and misfit."""
    return gap_at(body.line.xy, body.line.phi, brake, shoe)


def gap_at(xy: Floats, phi: Floats, brake: Brake, shoe: Shoe) -> Floats:
    """Gap [m] of the unloaded lining at the points xy (2, ...) [m] of its mesh, at the angles phi (...) there."""
    theta, radius = shoe.frame.theta(phi), brake.drum.radius
    off = shoe.sign * (radius - np.hypot(*xy))
    return np.where(np.abs(off) < 1e-12 * radius, 0.0, off) + misfit.clearance(brake, shoe, theta)  # 0.0: not round-off


def contact_problem(scene: Scene, brake: Brake, group: list[int], penalty: float = math.inf) -> contact.Problem:
    """Full slip of a group of shoes, the drum dragging their linings by mu p, as one complementarity problem.

    The weighted gap  w = M (g + p/eps) - N u + N_ring u_ring  closes as the lining moves by u, elastically and with
    the shoe's turn y about its pin, and opens as the ring moves by u_ring;  C p = h  is the balance of moments
    about the pins. All is per newton of `unit_force`, so that one force alone enters only through the gap.
    """
    size = unit_force(brake, group)
    parts = [_shoe_problem(scene.bodies[i], brake, brake.shoes[i], penalty, size) for i in group]
    if scene.ring is None and len(parts) == 1:
        return parts[0]
    A = scipy.linalg.block_diag(*(part.A for part in parts))
    if scene.ring is not None:
        drag = brake.friction * brake.spin
        pressed = np.hstack([scene.ring.pressed[i] for i in group])
        A += pressed.T @ (pressed + drag * np.hstack([scene.ring.dragged[i] for i in group]))
    return contact.Problem(
        A=A,
        q=np.concatenate([part.q for part in parts]),
        B=scipy.linalg.block_diag(*(part.B for part in parts)),
        C=scipy.linalg.block_diag(*(part.C for part in parts)),
        h=np.concatenate([part.h for part in parts]),
    )


def unit_force(brake: Brake, group: list[int]) -> float:
    """The largest actuation force of a group of shoes [N]."""
    return max(abs(brake.shoes[i].actuation.force) for i in group)


def _shoe_problem(body: Body, brake: Brake, shoe: Shoe, penalty: float, size: float) -> contact.Problem:
    drag = brake.friction * brake.spin * shoe.frame.sense
    load, moment = actuation(body, shoe)
    share = abs(shoe.actuation.force) / size
    N, T, M = body.coupling.N, body.coupling.T, body.coupling.M
    approach = N @ body.turned  # per turn
    A, C = -body.closing_pressed, -approach
    if body.closing_dragged is not None:
        A, C = A - drag * body.closing_dragged, C + drag * (T @ body.turned)
    return contact.Problem(
        A=A + M / contact_stiffness(shoe, penalty),
        q=M @ (gap_of(body, brake, shoe) / size) - share * (body.closing_loaded @ load),
        B=-approach[:, None],
        C=C[None],
        h=np.array([-share * moment]),
    )


def answer_of(
    scene: Scene, brake: Brake, group: list[int], penalty: float, first: Bools | None = None
) -> contact.Contact:
    """The contact of a group of shoes per newton of `unit_force`, from the contact set `first` where there is one.

    Raises NoAnswer as `respond` does.
    """
    for i in group:
        body, shoe = scene.bodies[i], brake.shoes[i]
        _check_reach(shoe, body.line.xy, gap_of(body, brake, shoe), actuation(body, shoe)[1])
    at = partial(at_friction, scene, brake, group, penalty)
    law = min(locking_friction(brake, brake.shoes[i]) for i in group)
    try:
        return locking.answer(at, brake.friction, first, law=law, brake="elastic as it is")
    except NoAnswer as error:
        raise NoAnswer(f"{brake.names(group)}: {error}") from error


def _answers(
    scene: Scene, brake: Brake, group: list[int], penalty: float, start: Response | None
) -> dict[int, _Answer]:
    """The answers of a group of shoes that meet the drum together."""
    first = None if start is None else np.concatenate([_touching(scene, brake, start, i) for i in group])
    found = answer_of(scene, brake, group, penalty, first)
    size = unit_force(brake, group)
    soft = [scene.bodies[i].coupling.M / contact_stiffness(brake.shoes[i], penalty) for i in group]
    begins = np.cumsum([0, *(len(M) for M in soft)])
    parts = [slice(a, b) for a, b in pairwise(begins)]
    opened = np.concatenate([M @ found.p[part] for M, part in zip(soft, parts, strict=True)])
    change = size * found.tangent(opened)  # by the penalty's compliance
    answers = {}
    for k, i in enumerate(group):
        p, turn = size * found.p[parts[k]], size * float(found.y[k])
        answers[i] = _answer(scene.bodies[i], brake, brake.shoes[i], p, turn, change[parts[k]], penalty, found.steps)
    small = sum(scene.bodies[i].unknowns for i in group) <= MOST_REFINED
    lost = max(scene.bodies[i].condensed.lost for i in group)
    if lost < LARGEST_LOSS and _imbalance(answers) < (REFINED_FROM if small else LARGEST_IMBALANCE):
        return answers
    try:
        refined = refined_group(scene, brake, group, penalty, found.active)
    except NoAnswer as error:
        raise NoAnswer(f"{brake.names(group)}: lost digits, {TOO_FAR}; refined: {error}") from error
    for k, i in enumerate(group):
        p, turn = size * refined.p[k], size * float(refined.turns[k])
        steps, reaction = found.steps + refined.sets, size * refined.reactions[k]
        answers[i] = _answer(
            scene.bodies[i], brake, brake.shoes[i], p, turn, change[parts[k]], penalty, steps, reaction
        )
    left = _imbalance(answers)
    if refined.correction > LARGEST_CORRECTION or not left < LARGEST_IMBALANCE:
        raise NoAnswer(
            f"{brake.names(group)}: lost digits, even refined the pressures are certain only to "
            f"{refined.correction:.1e} and balance to {left:.1e}; {TOO_FAR}"
        )
    return answers


def _imbalance(answers: dict[int, _Answer]) -> float:
    """The largest imbalance of forces or moments, relative."""
    balance = worst([answer.balance for answer in answers.values()])
    return float(np.nan_to_num(max(balance.force, balance.moment), nan=math.inf))


def refined_group(
    scene: Scene, brake: Brake, group: list[int], penalty: float, active: Bools, order: str = "COLAMD"
) -> Refined:
    """The answer of a group of shoes to all digits: the whole system, refined from the contact set `active` (n,).

    order: of its elimination, by SuperLU's names. Raises NoAnswer where it is singular or does not settle.
    """
    gaps = {i: gap_of(scene.bodies[i], brake, brake.shoes[i]) for i in group}
    refined = refine(whole(scene, brake, group, penalty, gaps), active, order)
    if refined.correction < SETTLED:
        return refined
    other = refine(whole(scene, brake, group, penalty, gaps, carried=False), active, order)
    return min(refined, other, key=lambda found: found.correction)


def _answer(
    body: Body,
    brake: Brake,
    shoe: Shoe,
    p: Floats,
    turn: float,
    change: Floats,
    penalty: float,
    steps: int,
    reaction: Floats | None = None,
) -> _Answer:
    """What one shoe does under the pressure p (n,) and the turn about its pin, in its own frame.

    reaction (2,): of the pin, where it is known otherwise than from the condensed body.
    """
    frame, line, coupling = shoe.frame, body.line, body.coupling
    load, moment = actuation(body, shoe)
    load, moment = abs(shoe.actuation.force) * load, abs(shoe.actuation.force) * moment
    drag = brake.friction * brake.spin * frame.sense
    nodal = (drag * (coupling.T.T @ p) - coupling.N.T @ p).reshape(-1, 2)  # on the lining [N]
    refined = reaction is not None
    if reaction is None:
        reaction = held(body, p, drag, load)[:2]
    pin = pin_of(shoe)
    balance = relative_balance(
        [nodal.sum(axis=0), reaction, load[:2]],
        # Two parts of the actuation's moment about the centre: where mu = 0 and it aims there, all others vanish.
        [float(cross(line.xy.T, nodal).sum()), float(cross(pin, reaction)), moment, float(cross(pin, load[:2]))],
    )
    stiffness = contact_stiffness(shoe, penalty)
    pressed = float(coupling.lever @ p)
    note = f"shoe {shoe.name!r}: " + (
        "exact contact, no penetration"
        if math.isinf(penalty)
        else f"penalty {penalty:g} E/t: the lining penetrates by {p.max() / stiffness:.1e} m at most, "
        f"which changes its torque by {float(coupling.lever @ change) / pressed if pressed else 0.0:+.1e} of it"
    )
    if refined:
        note += f"; {REFINED}"
    forward = slice(None, None, frame.sense)
    theta = frame.theta(line.phi)[forward]
    response = ShoeResponse(
        name=shoe.name,
        torque=abs(drag) * pressed,
        normal_force=float(np.linalg.norm((coupling.N.T @ p).reshape(-1, 2).sum(axis=0))),
        self_energising=drag * float((coupling.T @ body.turned) @ p) * moment > 0,
        peak_pressure=largest(line.phi, p, line.order, edge_zone(shoe, brake.drum.radius)),
        hinge_reaction=frame.to_brake(reaction),
        contact_arcs=contact_arcs(theta, p[forward], line.order),
        theta=theta,
        pressure=p[forward],
        order=line.order,
        turn=frame.sense * turn,
    )
    return _Answer(response, balance, steps, note)


def edge_zone(shoe: Shoe, radius: float) -> float:
    """Zone at each end of a lining [rad] in which no peak of the pressure is looked for: half the lining's thickness,
    at most a quarter of its length."""
    start, end = shoe.arc
    return min(shoe.lining.thickness / (2 * radius), 0.25 * (end - start))


def _touching(scene: Scene, brake: Brake, start: Response, index: int) -> Bools:
    """Contact nodes of shoe `index` within the contact arcs of an earlier response."""
    theta = brake.shoes[index].frame.theta(scene.bodies[index].line.phi)
    touching = np.zeros(len(theta), dtype=bool)
    for first, last in start.shoes[index].contact_arcs:
        touching |= (theta > first - 1e-9) & (theta < last + 1e-9)
    return touching


def _check_reach(shoe: Shoe, xy: Floats, gap: Floats, moment: float) -> None:
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
    turns = math.copysign(1.0, moment) * (np.concatenate([angle, -angle]) - np.tile(psi[meets], 2)) % (2 * math.pi)
    if turns.min() > LARGEST_TURN:
        raise NoAnswer(
            f"shoe {shoe.name!r}: it would have to turn by {math.degrees(turns.min()):.3g} deg to touch the drum; "
            f"small displacements hold up to {math.degrees(LARGEST_TURN):.3g} deg"
        )


def at_friction(scene: Scene, brake: Brake, group: list[int], penalty: float, friction: float) -> contact.Problem:
    """The contact problem of a group of shoes at another friction coefficient."""
    return contact_problem(scene, brake.model_copy(update={"friction": friction}), group, penalty)


def groups_of(scene: Scene, brake: Brake) -> list[list[int]]:
    """The shoes that the actuation turns towards the drum, in groups that must be solved together."""
    touching = [i for i, shoe in enumerate(brake.shoes) if turns_towards(scene.bodies[i], shoe)]
    # Shoes meet each other only through an elastic ring.
    alone = scene.ring is None or scene.apart
    return [[i] for i in touching] if alone else [touching] if touching else []
