"""The rigid-shoe law: p = sum of a_k f_k >= 0, with f_k how the freedom k of a shoe closes the gap,
and one equilibrium for each freedom.

With n and t the lining's normal and the direction of drag, u_k the motions of the shoe and v_j
those on which what holds it does no work (brake.support), and Q_j the work of the actuation:

    f_k = n.u_k,     w Int p (n.v_j - mu s t.v_j) ds = Q_j     over the part of the lining where p > 0

Its names on the grounds where it is known: sine (a hinge on a drum), A cos + B sin (a pivot or an
abutment), cosine (a guide on a drum), linear (a hinge on a plane), uniform (a guide on a plane).
"""

import math
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from drumlin.arrays import Floats
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.support import Freedoms
from drumlin.errors import NoAnswer
from drumlin.laws.face import Arcs, Face, face_of
from drumlin.response.balance import shoe_balance, worst
from drumlin.response.merit import with_merits
from drumlin.response.response import NEITHER, Response, ShoeResponse, untouched
from drumlin.response.resultants import Resultant, cross

RIGID_ASSUMES = (
    "rigid shoe: p = sum of a_k f_k >= 0, f_k how each freedom of the shoe closes the gap"
)
_FITS = "clearance and misfit: the law is that of a lining that fits, new or worn in, on a"
LEFT_OUT = {
    "drum": ("elasticity of shoe, backing and drum: rigid by assumption", f"{_FITS} round drum"),
    "plane": ("elasticity: rigid by assumption", f"{_FITS} plane"),
}
"""What the law leaves out, by the word of the surface."""
PRESSURE_NODES = 257  # of p over a lining; quadratic pieces: integrals are right to 1e-10
MOST_CONTACT_STEPS = 200


class PressedShoe(NamedTuple):
    """A rigid shoe that presses: `c` (2,) the mixture of shapes [Pa], `amounts` (k,) of its
    freedoms [Pa m/m of the gap], the `arcs` where it presses, `freedoms` with the `sense` of an
    abutment's friction.
    """

    face: Face
    c: Floats
    amounts: Floats
    arcs: Arcs
    freedoms: Freedoms
    sense: int

    @property
    def tip(self) -> float:
        """How far the actuation's point goes along its force, over the lining's compliance [Pa]."""
        return float(self.freedoms.tip @ self.amounts)


def system(face: Face, free: Freedoms, width: float, arcs: Arcs) -> tuple[Floats, Floats]:
    """N and F (k, k) of the equilibria (N - mu s F) a = Q with the lining pressed on the arcs."""
    products, shapes = width * face.products(arcs), face.closing(free.motions)
    N = face.closing(free.tests) @ products[:2] @ shapes.T
    return N, face.sliding(free.tests) @ products @ shapes.T


def locking(face: Face, free: Freedoms, width: float, arcs: Arcs, spin: int) -> float:
    """mu_lock: the least friction at which the equilibria become singular; inf where there is none."""
    N, F = system(face, free, width, arcs)
    if len(N) == 1:
        drags = spin * float(F[0, 0]) / float(N[0, 0]) if N[0, 0] else 0.0
        return 1 / drags if drags > 1e-14 else math.inf
    size = np.sqrt(np.abs(np.diagonal(N))) + 1e-300
    N, F = N / np.outer(size, size), F / np.outer(size, size)
    try:
        found = np.linalg.eigvals(np.linalg.solve(N, spin * F))
    except np.linalg.LinAlgError:
        return math.inf
    real = found.real[np.abs(found.imag) <= 1e-9 * np.abs(found)]
    return min((1 / float(x) for x in real if x > 1e-14), default=math.inf)


def locking_friction(brake: Brake, shoe: Shoe) -> float:
    """mu_lock of a shoe by the law, all of its lining pressed; the least of both senses of an
    abutment's friction.
    """
    face, ends = face_of(brake, shoe), ((shoe.lining.start, shoe.lining.end),)
    of = [
        locking(face, shoe.freedoms(sense), shoe.lining.width, ends, brake.spin)
        for sense in shoe.senses
    ]
    return min(of)


def press(brake: Brake, shoe: Shoe, *, whole: bool = False) -> PressedShoe | None:
    """The shoe as it presses under its actuation; None where that lifts it off, or is none.

    whole: all of the lining bears, tension included, as closed forms have it. Raises NoAnswer:
    self-locking, or nothing balances the actuation.
    """
    face = face_of(brake, shoe)
    if shoe.actuation.force == 0:
        return None
    if bears(brake, shoe) < 0:
        return None
    failure: NoAnswer | None = None
    for sense in shoe.senses:
        try:
            found = _settled(brake, shoe, face, sense, whole)
        except NoAnswer as error:
            failure = failure or error
            continue
        reaction = -shoe.actuation.vector - _contact(brake, shoe, found).force
        if shoe.stands(reaction, sense, float(found.amounts[-1])):
            return found
    raise failure or NoAnswer(f"shoe {shoe.name!r}: no equilibrium, its foot leaves the abutment")


def bears(brake: Brake, shoe: Shoe) -> int:
    """+1 where pressure without friction can balance the actuation, -1 where tension would, else 0."""
    face, ends = face_of(brake, shoe), (shoe.lining.start, shoe.lining.end)
    free = shoe.freedoms(shoe.senses[-1])
    shapes = face.closing(free.tests)
    if len(shapes) == 1:
        most = shapes[0] @ face.shapes(np.linspace(*ends, 65))[:2] * free.work[0]
        return 1 if most.max() > 1e-12 * np.abs(most).max() else -1
    try:
        return face.centre(np.asarray(np.linalg.solve(shapes, free.work), dtype=float), *ends)
    except np.linalg.LinAlgError:
        return 0


def _settled(brake: Brake, shoe: Shoe, face: Face, sense: int, whole: bool) -> PressedShoe:
    free, ends, mu = shoe.freedoms(sense), (shoe.lining.start, shoe.lining.end), brake.friction
    shapes = face.closing(free.motions)
    arcs: Arcs = (ends,)
    mu_lock = locking(face, free, shoe.lining.width, arcs, brake.spin)
    locked = f"self-locking, friction {mu:g} is not below mu_lock = {{:.6g}} of the rigid-shoe law"
    if len(shapes) == 1:  # where it presses is known beforehand
        arcs = face.pressed(shapes[0] * math.copysign(1.0, free.work[0]), *ends)
        mu_lock = locking(face, free, shoe.lining.width, arcs, brake.spin)
        if mu >= mu_lock:
            raise NoAnswer(f"shoe {shoe.name!r}: {locked.format(mu_lock)}")
    for _ in range(MOST_CONTACT_STEPS):
        N, F = system(face, free, shoe.lining.width, arcs)
        try:
            amounts: Floats = np.linalg.solve(N - mu * brake.spin * F, free.work).astype(float)
        except np.linalg.LinAlgError:
            break
        c = shapes.T @ amounts
        after = (ends,) if whole else face.pressed(c, *ends)
        if after and _same(after, arcs):
            mu_lock = locking(face, free, shoe.lining.width, arcs, brake.spin)
            if mu >= mu_lock:
                break
            return PressedShoe(face, c, amounts, arcs, free, sense)
        if not after:
            break
        arcs = after
    if mu >= mu_lock:
        raise NoAnswer(f"shoe {shoe.name!r}: {locked.format(mu_lock)}")
    raise NoAnswer(
        f"shoe {shoe.name!r}: tips, no pressure of a rigid shoe on its lining balances the actuation"
    )


def _same(a: Arcs, b: Arcs) -> bool:
    return len(a) == len(b) and bool(
        np.allclose(a, b, rtol=0, atol=1e-13 * max(1.0, np.abs(b).max()))
    )


def _contact(brake: Brake, shoe: Shoe, found: PressedShoe) -> Resultant:
    loads = shoe.lining.width * found.face.products(found.arcs) @ found.c
    normal, friction, moment = found.face.force(loads, brake.friction * brake.spin)
    return Resultant(normal, friction, moment)


def respond(brake: Brake, shoe: Shoe, found: PressedShoe | None) -> ShoeResponse:
    """The response of a shoe that presses so, or not at all."""
    if found is None:
        return untouched(shoe, -shoe.actuation.vector)
    contact, flat = _contact(brake, shoe, found), shoe.flat
    place = nodes(
        (shoe.lining.start, shoe.lining.end), found.arcs, 2 if flat else PRESSURE_NODES - 1
    )
    reaction = -shoe.actuation.vector - contact.force
    about = _about(shoe, contact)
    if shoe.guide is None:  # the moment of friction about the pin has the sense of the actuation's
        helping = about[1] * shoe.actuation.moment_about(shoe.pin)
    else:  # the work of friction on the slide
        a, systems = found.amounts, system(found.face, found.freedoms, 1.0, found.arcs)
        closed, dragged = (float(a @ work @ a) for work in systems)
        helping = (
            brake.friction * brake.spin * dragged - NEITHER * closed
        )  # none where the guide is square to it
    return ShoeResponse(
        name=shoe.name,
        torque=0.0 if flat else abs(contact.moment),
        normal_force=float(np.linalg.norm(contact.normal)),
        self_energising=bool(helping > 0),
        peak_pressure=found.face.peak(found.c, found.arcs),
        hinge_reaction=reaction,
        contact_arcs=found.arcs,
        theta=place,
        pressure=pressure(found, place),
        pivot_reaction=-contact.force if shoe.pivot is not None else None,
        reaction_moment=-about[0] - about[1] - shoe.actuation.moment_about(shoe.pin)
        if shoe.guide is not None
        else 0.0,
    )


def pressure(found: PressedShoe | None, place: Floats) -> Floats:
    """The pressure [Pa] of a shoe that presses so at the places of its lining, same shape; 0 of one
    that does not.
    """
    if found is None:
        return np.zeros(np.shape(place))
    return np.maximum(found.c @ found.face.shapes(place)[:2], 0.0)


def _about(shoe: Shoe, contact: Resultant) -> tuple[float, float]:
    """Moments of pressure and of friction about the shoe's pin."""
    pin = shoe.pin.xy
    pressure, friction = (
        (contact.moment, 0.0) if shoe.flat else (0.0, contact.moment)
    )  # about the origin
    return pressure - float(cross(pin, contact.normal)), friction - float(
        cross(pin, contact.friction)
    )


def nodes(ends: tuple[float, float], arcs: Arcs, steps: int) -> Floats:
    """Nodes of quadratic pieces over a lining: even ones, and the ends of the contact among those
    between pieces.
    """
    marks = sorted({*ends, *(x for arc in arcs for x in arc)})
    found = [np.array(marks[:1])]
    for a, b in pairwise(marks):
        count = 2 * max(1, round(steps * (b - a) / (ends[1] - ends[0]) / 2))
        found.append(np.linspace(a, b, count + 1)[1:])
    return np.concatenate(found)


def forced(brake: Brake, *, whole: bool = False) -> Brake:
    """The brake with the forces that its shoes share, those of a cam and of struts, by the law.
    Raises NoAnswer.
    """
    shoes: list[Shoe] = list(brake.shoes)
    place = {shoe.name: i for i, shoe in enumerate(shoes)}
    behind = {link.to for link in brake.links}
    if brake.actuation is not None and brake.actuation.is_cam:
        free = [i for i, shoe in enumerate(shoes) if shoe.name not in behind]
        yields = []  # of the shoe's tip, per newton
        for i in free:
            found = press(brake, shoes[i], whole=whole)
            if found is None or found.tip <= 0:
                raise NoAnswer(f"shoe {shoes[i].name!r}: the cam does not press it")
            yields.append(found.tip / shoes[i].actuation.force)
        total = math.fsum(1 / size for size in yields)
        for i, size in zip(free, yields, strict=True):
            shoes[i] = shoes[i].under(brake.actuation.total / (size * total))
    for link in brake.links:
        source, to = shoes[place[link.source]], place[link.to]
        found = press(brake, source, whole=whole)
        shoes[to] = shoes[to].under(
            0.0 if found is None else math.hypot(*respond(brake, source, found).hinge_reaction)
        )
    return brake.model_copy(update={"shoes": tuple(shoes)})


def solve(brake: Brake, name: str = "rigid", *, whole: bool = False) -> Response:
    """The response of a brake by the law, under the `name` that it has for such brakes; whole: as
    for `press`.

    Raises NoAnswer: self-locking, or a shoe that nothing balances.
    """
    under = forced(brake, whole=whole)
    shoes = tuple(respond(under, shoe, press(under, shoe, whole=whole)) for shoe in under.shoes)
    shared = under.shoes != brake.shoes
    if shared:
        shoes = tuple(
            replace(r, force=shoe.actuation.force)
            for r, shoe in zip(shoes, under.shoes, strict=True)
        )
    word = brake.surface.word
    response = Response(
        model=name,
        shoes=shoes,
        balance=worst([shoe_balance(under, i, shoe) for i, shoe in enumerate(shoes)]),
        left_out=LEFT_OUT[word],
        notes=(
            *(no_contact(shoe.name, word) for shoe in shoes if not shoe.contact_arcs),
            *cam_notes(brake),
        ),
    )
    return with_merits(brake, response)


def cam_notes(brake: Brake) -> tuple[str, ...]:
    """How a cam shares its force between linings of unlike E/t, in a line; none where they are
    alike.

    Both tips go the same way. A new lining under a rigid shoe gives way by p t/E, a worn-in one
    wears by p.
    """
    if brake.actuation is None or not brake.actuation.is_cam:
        return ()
    behind = {link.to for link in brake.links}
    linings = [shoe.lining for shoe in brake.shoes if shoe.name not in behind]
    moduli = [
        own.material.E_through / own.thickness
        for own in linings
        if own.material is not None and own.thickness
    ]
    if len(moduli) < 2 or math.isclose(*moduli[:2], rel_tol=1e-6):
        return ()
    return (
        f"cam: linings of unlike E/t, {moduli[0]:.3g} and {moduli[1]:.3g} Pa/m: where rigid shoes are mirror images "
        "its forces are such that F1 B1 t1/E1 = F2 B2 t2/E2 new, F1 B1 = F2 B2 worn in, both wearing alike",
    )


def no_contact(name: str, body: str = "drum") -> str:
    """The note for a shoe that its force does not press."""
    return f"shoe {name!r}: no contact, the force does not turn it towards the {body}"
