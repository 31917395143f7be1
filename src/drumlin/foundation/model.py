"""The foundation model: beams, springs and ring as one contact problem, and its response.

The normal forces N of the sectors keep the gaps  w = Delta + N/k + z - closing >= 0  open or shut. A beam turns
about its hinge by y and bends by its moments, so that with the trapezoidal rule over its stations

    M = loaded - (pressed + mu_hat dragged) N,     closing = y closing_0 + closing^T (dx/EI) M,
    z = c N,                                       M_0 = 0:  (pressed + mu_hat dragged)_0 N = loaded_0,

which are eq. 2, 8, 16 and 19 of Barecki & Scieszka (1987), and eq. 7 solved for the displacement.
"""

import math
import time
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from drumlin.arrays import Bools, Floats
from drumlin.brake.brake import Brake
from drumlin.brake.components import Beam
from drumlin.brake.orthotropic import isotropic_only
from drumlin.brake.surface import DRUM
from drumlin.contact import active_set, self_locking
from drumlin.contact.equations import Problem
from drumlin.errors import BadInput, NoAnswer
from drumlin.foundation.post import Post, post, shoe_angles, trapezoid
from drumlin.foundation.ring import drag_flexibility, flexibility
from drumlin.lapack import block_diag
from drumlin.laws import locking_friction
from drumlin.laws.hinged import pressing_moment
from drumlin.laws.rigid import no_contact
from drumlin.response.balance import shoe_balance, worst
from drumlin.response.merit import with_merits
from drumlin.response.response import Deformation, Response, ShoeResponse, pressed_shoe, untouched
from drumlin.response.resultants import Resultant

RING_SECTIONS = 360
LARGEST_SHOE_TURN = (
    0.2  # rad; beyond it small displacements are no longer a model of the shoe's motion
)

LIFTS = {
    "plane-stress": "layers as columns of stiffness E/t, not bonded and held along the arc: E/((1 - nu^2) t)",
    "tilt": "the beam's sections turn without carrying the lining along the beam: the gap closes by w cos(theta) only",
    "wedge": "the block has one thickness, that of [shoe.backing], and does not fill the space up to the beam",
    "thick-ring": "the ring bends as a thin one of the drum's radius, without hoop and shear deformation",
    "all-modes": "the ring is loaded by an equal shoe opposite, so that it has even modes only",
    "own-pressure": "the other shoe's pressure is the same, half a turn on, not its own",
    "ring-friction": "friction does not bend the ring",
}
"""The simplifications of the paper that can be lifted, each with what it leaves out."""
ALWAYS = (
    "shear and stretching of the beam: it only bends",
    "shear of lining and block: springs side by side",
)
NO_RING = frozenset({"thick-ring", "all-modes", "own-pressure", "ring-friction"})


def why_not(brake: Brake) -> str | None:
    """Why the foundation model does not apply to a brake (None: it does)."""
    refusal = brake.surface.unlike(DRUM) or brake.shares
    if refusal is not None:
        return refusal
    for shoe in brake.shoes:
        if not isinstance(shoe.body, Beam):
            return f'shoe {shoe.name!r}: not a straight beam, [shoe.body] with shape = "beam"'
    return isotropic_only(brake, "the foundation model")


def lifted(brake: Brake, lift: Iterable[str]) -> frozenset[str]:
    """The simplifications to lift, checked; "all" is all that the brake file has the data for."""
    names = set(lift)
    unknown = sorted(names - set(LIFTS) - {"all"})
    if unknown:
        raise BadInput(
            f"--lift = {unknown[0]!r}: unknown simplification; allowed: {', '.join(LIFTS)}, all"
        )
    lacking: dict[str, str] = {}
    if any(
        shoe.backing and isinstance(shoe.body, Beam) and shoe.body.thickness is None
        for shoe in brake.shoes
    ):
        lacking["wedge"] = "needs shoe.body.thickness"
    if brake.ring is not None and brake.ring.section is None:
        lacking["thick-ring"] = "needs drum.ring.thickness, width and material"
    for name in sorted(names & set(lacking)):
        raise BadInput(f"--lift = {name!r}: {lacking[name]}")
    if "all" in names:
        names = set(LIFTS) - set(lacking)
    return frozenset(names | ({"all-modes"} if "own-pressure" in names else set()))


class FoundationSystem(NamedTuple):
    """Shoes that meet the ring together: their posts, the ring's flexibilities c (n, n) [m/N], the
    problem.
    """

    posts: tuple[Post, ...]
    ring: Floats
    problem: Problem


def system(brake: Brake, group: list[int], sections: int, lift: frozenset[str]) -> FoundationSystem:
    """The contact problem of a group of shoes; its pressures are the normal forces of the sectors
    [N].

    Raises BadInput where there are too few or too many `sections`.
    """
    if not 4 <= sections <= 4000:
        raise BadInput(f"--sections = {sections}: must be from 4 to 4000")
    posts = tuple(
        post(
            brake, brake.shoes[i], sections,
            tilt="tilt" in lift, wedge="wedge" in lift, plane_stress="plane-stress" in lift,
        )
        for i in group
    )  # fmt: skip
    theta = np.concatenate([p.axis.origin + p.axis.sense * p.theta for p in posts])
    ring = ring_of(brake, theta, theta, lift)
    A, q, B, C, h = [], [], [], [], []
    for p in posts:
        turning = p.closing.T * (p.step / p.EI)
        moments = p.pressed + p.drag * p.dragged
        A.append(turning @ moments + np.diag(1 / p.k))
        q.append(p.gap - turning @ p.loaded)
        B.append(-p.closing[:1].T)
        C.append(-moments[:1])
        h.append(-p.loaded[:1])
    problem = Problem(
        block_diag(*A) + ring,
        np.concatenate(q),
        block_diag(*B),
        block_diag(*C),
        np.concatenate(h),
    )
    return FoundationSystem(posts, ring, problem)


def ring_of(brake: Brake, theta: Floats, loads: Floats, lift: frozenset[str]) -> Floats:
    """Inward displacement [m/N] of the rim at theta (k,) [rad] per normal force at `loads` (n,)
    [rad]: (k, n).
    """
    ring = brake.ring
    if ring is None:
        return np.zeros((len(theta), len(loads)))
    d = np.subtract.outer(theta, loads)
    twin, R = "all-modes" not in lift, brake.size
    c = flexibility(ring, R, d, twin=twin, sign=-1, thick="thick-ring" in lift)
    if "ring-friction" in lift:  # on the drum it acts against the rotation
        c = c - brake.friction * brake.spin * drag_flexibility(ring, R, d, twin=twin)
    return c


def rim(brake: Brake, response: Response, theta: Floats, lift: Iterable[str] = ()) -> Floats:
    """Inward displacement [m] of the rim at theta (k,) [rad], of each shoe's pressure: (shoes, k).

    `lift` as the response was solved. With "all-modes" the rim moves by the sum; without, each row
    is a rim with the equal shoe opposite.
    """
    names = lifted(brake, lift)
    rows = []
    for shoe, answer in zip(brake.shoes, response.shoes, strict=True):
        N = shoe.lining.width * brake.size * trapezoid(answer.theta) * answer.pressure
        rows.append(ring_of(brake, theta, answer.theta, names) @ N)
    return np.array(rows)


def solve(
    brake: Brake,
    *,
    sections: int = RING_SECTIONS,
    lift: Iterable[str] = (),
    start: list[Bools] | None = None,
) -> Response:
    """The response of a post brake by the foundation model, on `sections` divisions of each beam.

    `lift`: names of LIFTS, or "all". `start`: contact sets of the shoes to begin with.
    Raises BadInput, and NoAnswer: self-locking, no equilibrium, not converged.
    """
    reason = why_not(brake)
    if reason is not None:
        raise BadInput(f"foundation does not apply to this brake: {reason}")
    names, clock = lifted(brake, lift), time.perf_counter()
    shoes = brake.shoes
    touching = [i for i in range(len(shoes)) if pressing_moment(shoes[i]) > 0]
    together = brake.ring is not None and "own-pressure" in names
    answers = {
        i: untouched(shoes[i], -shoes[i].actuation.vector)
        for i in range(len(shoes))
        if i not in touching
    }
    steps = 0
    for group in [touching] if together and touching else [[i] for i in touching]:
        parts = system(brake, group, sections, names)
        found = _found(brake, group, parts, sections, names, start)
        steps = max(steps, found.steps)
        first = 0
        z = parts.ring @ found.p
        for k, i in enumerate(group):
            part = slice(first, first + len(parts.posts[k].theta))
            first = part.stop
            answers[i] = respond(
                brake, i, parts.posts[k], found.p[part], z[part], float(found.y[k])
            )
    ordered = tuple(answers[i] for i in range(len(shoes)))
    response = Response(
        model="foundation",
        shoes=ordered,
        balance=worst([shoe_balance(brake, i, shoe) for i, shoe in enumerate(ordered)]),
        iterations=steps,
        seconds={"solve": time.perf_counter() - clock},
        left_out=left_out(brake, names),
        notes=tuple(no_contact(shoe.name) for shoe in ordered if not shoe.contact_arcs),
    )
    return with_merits(brake, response)


def left_out(brake: Brake, names: frozenset[str]) -> tuple[str, ...]:
    """What is not computed for this brake, and how to have it."""
    ring = brake.ring is not None
    blocks = any(shoe.backing for shoe in brake.shoes)
    kept = [
        f"{text} (--lift {name})"
        for name, text in LIFTS.items()
        if name not in names and (ring or name not in NO_RING) and (blocks or name != "wedge")
    ]
    return (*(() if ring else ("drum: rigid, no [drum.ring] in the brake",)), *ALWAYS, *kept)


def _found(
    brake: Brake,
    group: list[int],
    parts: FoundationSystem,
    sections: int,
    names: frozenset[str],
    start: list[Bools] | None,
) -> active_set.Contact:
    said = brake.names(group)
    begin = None if start is None else np.concatenate([start[i] for i in group])

    def at(friction: float) -> Problem:
        if friction == brake.friction:
            return parts.problem
        return system(
            brake.model_copy(update={"friction": friction}), group, sections, names
        ).problem

    law = min(locking_friction(brake, brake.shoes[i]) for i in group)
    try:
        found = self_locking.answer(at, brake.friction, begin, law=law, brake="on the foundation")
    except NoAnswer as error:
        raise NoAnswer(f"{said}: {error}") from error
    turn = float(np.abs(found.y).max())
    if turn > LARGEST_SHOE_TURN:
        raise NoAnswer(
            f"{said}: it would have to turn by {math.degrees(turn):.3g} deg; "
            f"small displacements hold up to {math.degrees(LARGEST_SHOE_TURN):.3g} deg"
        )
    return found


def respond(brake: Brake, index: int, p: Post, N: Floats, z: Floats, turn: float) -> ShoeResponse:
    """The response of shoe `index` to the normal forces N (n,) [N], ring displacements z (n,) [m]
    and the turn.
    """
    shoe, R = brake.shoes[index], brake.size
    pressure = N / (shoe.lining.width * R * p.sector)
    moment = p.loaded - (p.pressed + p.drag * p.dragged) @ N
    w = turn * p.x + np.maximum(np.subtract.outer(p.x, p.x), 0.0) @ (p.step / p.EI * moment)
    theta = shoe_angles(p.axis, shoe, p.theta)
    contact_ = _resultant(brake, theta, N)
    helping = float(-p.drag * (p.dragged[0] @ N))  # against the resisting moments
    return pressed_shoe(
        shoe,
        R,
        theta,
        pressure,
        order=1,
        torque=abs(contact_.moment),
        normal_force=float(np.linalg.norm(contact_.normal)),
        self_energising=helping > 0,
        hinge_reaction=-shoe.actuation.vector - contact_.force,
        turn=p.axis.sense * turn,
        located=False,
        lumped=contact_,
        deformation=Deformation(
            x=p.x, w=w, relative=w - w[-1] * p.x / p.x[-1], z=z[:: p.axis.sense]
        ),
    )


def _resultant(brake: Brake, theta: Floats, N: Floats) -> Resultant:
    """What the drum does to an external lining by the normal forces N at the brake's angles theta
    (n,).
    """
    along = np.array([N @ np.cos(theta), N @ np.sin(theta)])
    drag = brake.drag
    return Resultant(
        along, drag * np.array([-along[1], along[0]]), drag * brake.size * float(N.sum())
    )
