"""The finite-element model: brake -> scene (meshed, condensed bodies) -> response.

`prepare` does what depends on geometry and stiffness; `respond` what depends on friction, rotation,
force, line of action, clearance and penalty, in milliseconds on the same scene.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from drumlin.base.arrays import Bools, Floats
from drumlin.base.errors import BadInput, LostDigits, NoAnswer
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.components import Bar
from drumlin.brake.units import mm
from drumlin.contact.active_set import Contact
from drumlin.fem.equilibrium.group import ShoeGroup, groups_of
from drumlin.fem.equilibrium.sharing import PULLED, WOULD_PULL
from drumlin.fem.mesh.from_file import mesh_notes
from drumlin.fem.preparation.bodies import held
from drumlin.fem.preparation.cache import shape_of
from drumlin.fem.preparation.scene import Scene, clock
from drumlin.fem.substructure.loads import ACTUATION
from drumlin.laws.rigid import cam_notes
from drumlin.response.balance import borne, relative_balance, worst
from drumlin.response.response import (
    NEITHER,
    Balance,
    Change,
    Response,
    ShoeResponse,
    pressed_shoe,
    reaction_size,
    singular_zone,
    untouched,
)
from drumlin.response.resultants import cross

if TYPE_CHECKING:
    from drumlin.fem.error_control.refinement import Refined

DOUBLE = float(np.finfo(float).eps)
OVERLAP = 0.01  # of the lining's thickness, from which on it is said that a mesh lies in the drum
PENALTY = 1e8
"""Default penalty factor alpha: eps = alpha E/t of the lining. The penetration p/eps is then 1e-8
of the lining's own compression p t/E, and the pressure is off by about as much, in a contact that
is short beside the lining's thickness by more; each response states by how much.
"""
LARGEST_IMBALANCE = 1e-8
"""Imbalance of forces and moments, relative to the largest, above which condensed bodies have lost
too many digits: they are refined. An answer that is out of balance by more although refined is
refused.
"""
LARGEST_LOSS = 1e-5
"""Part of the pressure that may be lost to round-off before an answer is refined, and on a mesh,
which states no error, after that: else it is refused. A mesh itself is off by a hundred times as
much; columns state ten times what is left. A judgement, said by the refusal.
"""
MOST_LOSS = 1e-3
"""Part of the pressure that may be lost on columns that cannot be refined. Their stated error holds
ten times the loss, 1 %; an answer that has lost more is refused. A judgement, said by the refusal.
"""
MAX_REFINED = 240_000
"""Limit of time: unknowns of a group of shoes, times their degree squared, up to which columns are
refined. It takes seconds; what the factors of larger systems fill grows with the square."""
SETTLED = 1e-10  # relative correction up to which another form of the whole system is not tried
TOO_FAR = "stiffnesses or sizes are too far apart for the arithmetic"
REFINED = "refined in the whole system, condensed it loses digits"


def respond(
    scene: Scene, brake: Brake, *, penalty: float = PENALTY, start: Response | None = None
) -> Response:
    """The response of a brake on a prepared scene of the same geometry and stiffness.

    penalty: factor alpha of the contact stiffness alpha E/t per area; math.inf for exact contact.
    start: a response of a similar brake or on another mesh, whose contact is the first guess: it
    saves steps and does not change the answer. Raises NoAnswer: self-locking, no equilibrium, not
    converged.
    """
    check_penalty(penalty)
    if brake is not scene.brake:
        _check_same(scene, brake)
    seconds = dict(scene.seconds)
    with clock(seconds, "contact"):
        answers: dict[int, _Answer] = {}
        for group in groups_of(scene, brake, penalty):
            answers |= _answers(group, start)
        for i in set(range(len(brake.shoes))) - set(answers):
            answers[i] = _untouched(brake.shoes[i])
    balance = worst([answer.balance for answer in answers.values()])
    return Response(
        model=scene.model,
        shoes=tuple(answers[i].response for i in sorted(answers)),
        balance=balance,
        iterations=max(answer.steps for answer in answers.values()),
        seconds=seconds,
        left_out=scene.left_out,
        notes=(
            *_overlaps(scene, brake),
            *_meshes(scene, brake, [answers[i].response for i in sorted(answers)]),
            *(answers[i].note for i in sorted(answers)),
            *_grips(brake),
            *cam_notes(brake),
        ),
    )


def _check_same(scene: Scene, brake: Brake) -> None:
    """Raise BadInput for a brake whose bodies are not those of the scene."""
    if [shape_of(brake, shoe) for shoe in brake.shoes] != scene.shapes:
        raise BadInput(
            "the brake differs from the prepared scene in more than friction, rotation, load, clearance"
        )
    if brake.friction > 0 and scene.brake.friction == 0:
        raise BadInput(
            f"friction = {brake.friction:g}: the scene was prepared without friction, for mu = 0 only"
        )
    if brake.ring != scene.brake.ring:
        raise BadInput("the brake's drum.ring differs from that of the prepared scene")


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


def _overlaps(scene: Scene, brake: Brake) -> Iterator[str]:
    """A warning for each shoe's own mesh that lies in the drum or the plane."""
    for body, shoe in zip(scene.bodies, brake.shoes, strict=True):
        if shoe.mesh is None:
            continue
        deep = -float(shoe.off(body.line.xy, brake.size).min())
        if deep > OVERLAP * shoe.lining.thickness:
            yield (
                f"warning: shoe {shoe.name!r}: the contact line of its mesh lies up to {mm(deep)} in the "
                f"{shoe.surface.word}; its pressure is that of the lining squeezed out of there"
            )


def _meshes(scene: Scene, brake: Brake, responses: Sequence[ShoeResponse]) -> Iterator[str]:
    """Lines about the mesh files: what was passed over, moved, and counts as a gap.

    Raises BadInput for a contact line that is no shape of a lining.
    """
    for body, shoe, response in zip(scene.bodies, brake.shoes, responses, strict=True):
        if body.of_file is not None:
            yield from mesh_notes(shoe, body.of_file, body.line.xy, brake.size, response)


def _grips(brake: Brake) -> Iterator[str]:
    """How elastic bodies are held, in a line: a pin that stands off one is joined to it rigidly,
    which its pressure feels.
    """
    found: dict[str, list[str]] = {}
    for shoe in brake.shoes:
        if shoe.mesh is not None or not isinstance(shoe.body, Bar):
            continue
        grip = shoe.grip(brake.size)
        if grip is not None:
            length = (grip[1] - grip[0]) * shoe.back(
                brake.size
            )  # a short back has less than is asked for
            said = f"its {shoe.held_by} grips {mm(round(length, 4))} of the back of its body"
        else:
            away = math.dist(shoe.end_face(brake.size), shoe.own_pin)
            joined = "" if away < 0.5 * shoe.body.depth else ", joined by a rigid arm"
            what = "pin" if shoe.held_by == "hinge" else "foot"
            said = f"its {what} holds the end face of its body, {mm(round(away, 4))} from the face's middle{joined}"
        found.setdefault(said, []).append(shoe.name)
    if found:
        yield "held: " + "; ".join(f"{', '.join(names)}: {said}" for said, names in found.items())


def _untouched(shoe: Shoe) -> _Answer:
    note = f"shoe {shoe.name!r}: no contact, the force does not turn it towards the {shoe.surface.word}"
    return _Answer(untouched(shoe, -shoe.actuation.vector), Balance(0.0, 0.0), 0, note)


def _answers(group: ShoeGroup, start: Response | None) -> dict[int, _Answer]:
    """The answers of a group of shoes that meet the drum together, by the shoe's place in the
    brake.
    """
    first = (
        None
        if start is None
        else np.concatenate([_touching(group, k, start) for k in range(len(group.members))])
    )
    group, found = group.settled(first)
    size = group.unit_force
    answers, amounts, forces = {}, group.amounts(found), size * group.forces(found.p)
    changes = size * _changes(group, found, amounts)
    for k, (i, part) in enumerate(zip(group.members, group.parts, strict=True)):
        p, y = size * found.p[part], size * amounts[k]
        answers[i] = _answer(group, k, p, y, changes[:, part], found.steps, forces[k])
    if group.sharing is not None:
        if not _imbalance(answers) < LARGEST_IMBALANCE:
            raise LostDigits(
                f"{group.names}: lost digits, it balances only to {_imbalance(answers):.1e}; {TOO_FAR}"
            )
        return answers
    solid = group.scene.model == "solid"  # whose whole system is not put together
    small = sum(body.unknowns * body.line.order**2 for body in group.bodies) <= MAX_REFINED
    lost = max(answer.response.lost.pressure for answer in answers.values())
    refinable = not solid and (
        small or max(body.line.order for body in group.bodies) <= 2
    )  # else the factors fill
    most = LARGEST_LOSS if solid or refinable else MOST_LOSS
    if lost < most and _imbalance(answers) < LARGEST_IMBALANCE:
        return answers
    if not refinable:
        balance = f"it balances only to {_imbalance(answers):.1e}"
        why = f"its pressure is certain only to {lost:.1e}" if lost >= most else balance
        raise LostDigits(f"{group.names}: lost digits, {why}; {TOO_FAR}")
    try:
        refined = refined_group(group, found.active)
    except NoAnswer as error:
        raise LostDigits(f"{group.names}: lost digits, {TOO_FAR}; refined: {error}") from error
    steps, changes[1] = found.steps + refined.sets, size * np.concatenate(refined.last)
    for k, (i, part) in enumerate(zip(group.members, group.parts, strict=True)):
        p, y = size * refined.p[k], size * refined.motions[k]
        answers[i] = _answer(group, k, p, y, changes[:, part], steps, forces[k], refined=True)
    left = _imbalance(answers)
    if max(body.line.order for body in group.bodies) <= 2:
        lost, most = refined.correction, LARGEST_LOSS
    else:
        lost, most = max(answer.response.lost.pressure for answer in answers.values()), MOST_LOSS
    if lost >= most or not left < LARGEST_IMBALANCE:
        raise LostDigits(
            f"{group.names}: lost digits, even refined its pressure is certain only to {lost:.1e} and balances to "
            f"{left:.1e}; {TOO_FAR}"
        )
    return answers


def _imbalance(answers: dict[int, _Answer]) -> float:
    """The largest imbalance of forces or moments, relative."""
    balance = worst([answer.balance for answer in answers.values()])
    largest = max(balance.force, balance.moment)
    return math.inf if math.isnan(largest) else largest


def refined_group(group: ShoeGroup, active: Bools, order: str = "COLAMD") -> "Refined":
    """The answer of a group of shoes to all digits: the whole system, refined from the contact set
    `active` (n,).

    order: of its elimination, by SuperLU's names. Raises NoAnswer where it is singular or does not
    settle.
    """
    from drumlin.fem.error_control.refinement import refine, whole  # noqa: PLC0415  (with scipy.sparse; few brakes lose digits)

    refined = refine(whole(group), active, order)
    if refined.correction < SETTLED:
        return refined
    other = refine(whole(group, carried=False), active, order)
    return min(refined, other, key=lambda found: found.correction)


def _answer(
    group: ShoeGroup,
    k: int,
    p: Floats,
    y: Floats,
    changes: Floats,
    steps: int,
    force: float,
    *,
    refined: bool = False,
) -> _Answer:
    """What shoe `k` of a group does under the pressure p (n,), its free motions y and its force
    [N], in its own frame.

    changes (2, n): see `_changes`; of a pressure that was `refined` the second is the last
    correction.
    """
    brake, shoe, body, penalty = group.brake, group.shoes[k], group.bodies[k], group.penalty
    frame, line, coupling = shoe.frame, body.line, body.coupling
    load, moment = group.loads[k]
    if group.sharing is not None and force < PULLED * group.unit_force:
        raise NoAnswer(f"shoe {shoe.name!r}: {WOULD_PULL}")
    load, moment = abs(force) * load, abs(force) * moment
    push = body.columns.part(ACTUATION, load)[:2]
    drag = brake.drag_on(shoe)
    normal, dragged = body.forces @ p
    whole = drag * dragged - normal  # on the lining: force [N], and moment about the centre [N m]
    pin, motions = shoe.own_pin, group.motions[k]
    if not refined:
        reaction = held(body, p, drag, load)
    else:  # by equilibrium, of which moments or work are left to check: a refined pressure has more digits than the
        # strains where the frame is held
        reaction = -np.append(whole[:2] + push, whole[2] + moment - cross(pin, whole[:2]))
    reaction, twist = reaction[:2], float(reaction[2]) if shoe.guide is not None else 0.0
    # Two parts of the actuation's moment about the centre: where mu = 0 and it aims there, all
    # others vanish.
    moments = [float(whole[2]), float(cross(pin, reaction)), moment, float(cross(pin, push))]
    if shoe.guide is not None:
        moments += [
            twist,
            *borne(force, brake.scale_factor * (shoe.lining.end - shoe.lining.start)),
        ]
    balance = relative_balance([whole[:2], reaction, push], moments)
    if shoe.held_by != "hinge":
        nodal, work = drag * (coupling.T.T @ p) - coupling.N.T @ p, abs(force) * motions.work
        acting = nodal[:, None] * motions.tested
        left = np.abs(acting.sum(axis=0) + work) / np.maximum(
            np.abs(work), np.abs(acting).sum(axis=0)
        )
        balance = Balance(balance.force, max(balance.moment, float(left.max())))
    closed, rubbed = (
        float(work[:, 0] @ p) for work in group.closings[k]
    )  # by its first motion, per unit
    stiffness = group.stiffnesses[k]
    pressed = float(coupling.lever @ p)
    softer = float(coupling.lever @ changes[0]) / pressed if pressed else 0.0
    phi, mean = line.along(p)
    note = f"shoe {shoe.name!r}: " + (
        "exact contact, no penetration"
        if math.isinf(penalty)
        else f"penalty {penalty:g} E/t: the lining penetrates by {p.max() / stiffness:.1e} m at most, "
        f"which changes its {shoe.surface.effect} by {softer:+.1e} of it"
    )
    normal_force = math.hypot(*normal[:2])
    softness, lost = _changed(group, k, p, changes, reaction_size(reaction, normal_force))
    if refined:
        note += f"; {REFINED}, so its pressure is certain to {max(lost.pressure, DOUBLE):.0e}"
    least = 0.0 if refined else body.condensed.lost
    lost = Change(*(max(part, least) for part in lost))
    response = pressed_shoe(
        shoe,
        brake.scale_factor,
        frame.theta(phi),
        mean,
        order=line.order,
        peak=line.inside.peak(mean),
        torque=abs(drag) * pressed,
        normal_force=normal_force,
        self_energising=math.copysign(1.0, motions.work[0]) * drag * rubbed > NEITHER * abs(closed),
        hinge_reaction=frame.to_brake(reaction),
        turn=frame.sense * float(motions.of[2] @ y),
        force=None if group.sharing is None else force,
        pivot_reaction=-frame.to_brake(whole[:2]) if shoe.pivot is not None else None,
        reaction_moment=frame.sense * twist,
        motion=tuple((motions.of @ y).tolist()) if shoe.held_by != "hinge" else None,
        surface=line.surface(p),
        softness=softness,
        lost=lost,
    )
    return _Answer(response, balance, steps, note)


def _changes(group: ShoeGroup, found: Contact, amounts: Sequence[Floats]) -> Floats:
    """To first order how the penalty changes the pressure (n,), and how what the elimination has
    lost does: (2, n).

    What the compliance x = 1/alpha of the contact changes goes as x/(1 + x), and the tangent there
    as x/(1 + x)^2. Lost digits move the contact as if it had strained under the motions of the
    frame.
    """
    opened, strayed = [], []
    for k, (body, part) in enumerate(zip(group.bodies, group.parts, strict=True)):
        opened.append(
            (1 + 1 / group.penalty) * (body.coupling.M @ found.p[part]) / group.stiffnesses[k]
        )
        moved, frame = body.condensed.moved, group.motions[k].of @ amounts[k]
        strayed.append(
            np.zeros(len(opened[k])) if moved is None else body.coupling.N @ (moved @ frame)
        )
    return np.array([found.tangent(np.concatenate(gaps)) for gaps in (opened, strayed)])


def _changed(
    group: ShoeGroup, k: int, p: Floats, changes: Floats, held_size: float
) -> list[Change]:
    """What small changes (m, n) of the pressure p (n,) of shoe `k`, whose reaction is so large [N],
    do to it.

    The pressure counts outside EDGE_ZONE at the lining's ends, unless half of the force is there.
    """
    shoe, body = group.shoes[k], group.bodies[k]
    (start, end), phi, area, lever = (
        shoe.arc,
        body.line.phi,
        body.coupling.area,
        body.coupling.lever,
    )
    zone = singular_zone(end - start)
    weight = np.where((phi > start + zone) & (phi < end - zone), area, 0.0)
    if weight @ p < 0.5 * (area @ p):
        weight = area
    held_by = held(body, changes.T, group.brake.drag_on(shoe), np.zeros((body.columns.count, 1)))
    top = float(p[weight > 0].max(initial=0.0))
    highest = np.abs(changes[:, (weight > 0) & (p == top)]).max(axis=1, initial=0.0)
    parts = np.array(
        [np.sqrt(changes**2 @ weight), np.abs(changes @ lever), np.hypot(*held_by[:2]), highest]
    ).T
    wholes = [math.sqrt(weight @ p**2), float(lever @ p), held_size, top]
    return [Change(*row) for row in (parts / [whole or 1.0 for whole in wholes]).tolist()]


def _touching(group: ShoeGroup, k: int, start: Response) -> Bools:
    """Contact nodes of shoe `k` of a group within the contact arcs of an earlier response."""
    theta = group.shoes[k].frame.theta(group.bodies[k].line.phi)
    touching = np.zeros(len(theta), dtype=bool)
    for first, last in start.shoes[group.members[k]].contact_arcs:
        touching |= (theta > first - 1e-9) & (theta < last + 1e-9)
    return touching
