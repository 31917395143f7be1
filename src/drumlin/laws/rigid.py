"""Solve brakes with rigid shoes by the rigid-shoe law, on a drum or a plane.

The pressure is p = sum of a_k f_k >= 0. Here f_k is how the rigid-body mode k of a shoe closes the
gap. There is one equilibrium for each mode. With the lining's normal n and the direction of drag t,
the rigid-body modes u_k, the test modes v_j (brake.support) and the work Q_j of the actuation,

    f_k = n.u_k,     w Int p (n.v_j - mu s t.v_j) ds = Q_j     over the part of lining where p > 0

In known cases the law has a name: sine (a hinge on a drum), A cos + B sin (a pivot or an abutment),
cosine (a guide on a drum), linear (a hinge on a plane), uniform (a guide on a plane).
"""

import math
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.support import Freedoms
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
"""Notes on what the law neglects, by the word of the surface."""

PRESSURE_NODES = 257
"""Nodes of p over a lining. With quadratic pieces, integrals are exact to 1e-10."""

MOST_CONTACT_STEPS = 200
"""Limit of the steps in which the pressed arcs of a lining settle."""


class PressedShoe(NamedTuple):
    """A rigid shoe in contact.

    Attributes
    ----------
    face : surface on which the shoe presses
    c : (2,), factors of the surface's shapes in the pressure [Pa]
    amounts : (k,), factors of the rigid-body modes in the pressure [Pa per m of gap]
    arcs : arcs in contact
    freedoms : rigid-body modes of the shoe
    sense : of an abutment's friction
    """

    face: Face
    c: Floats
    amounts: Floats
    arcs: Arcs
    freedoms: Freedoms
    sense: int

    @property
    def tip(self) -> float:
        """Motion of the actuation's point along its force, over the lining's compliance [Pa]."""
        return float(self.freedoms.tip @ self.amounts)


def system(face: Face, free: Freedoms, width: float, arcs: Arcs) -> tuple[Floats, Floats]:
    """Matrices N and F (k, k) of the equilibria (N - mu s F) a = Q.

    Parameters
    ----------
    face : surface on which the shoe presses
    free : rigid-body modes of the shoe
    width : of the lining [m]
    arcs : arcs in contact
    """
    products, shapes = width * face.products(arcs), face.closing(free.motions)
    N = face.closing(free.tests) @ products[:2] @ shapes.T
    return N, face.sliding(free.tests) @ products @ shapes.T


def locking(face: Face, free: Freedoms, width: float, arcs: Arcs, spin: int) -> float:
    """Smallest friction mu_lock at which the equilibria become singular; inf if there is none.

    Parameters
    ----------
    face, free, width, arcs : as of `system`
    spin : sense of the motion
    """
    N, F = system(face, free, width, arcs)
    if len(N) == 1:
        drags = spin * float(F[0, 0]) / float(N[0, 0]) if N[0, 0] else 0.0
        return 1 / drags if drags > 1e-14 else math.inf
    # The modes have units of their own: rows and columns are scaled first.
    size = np.sqrt(np.abs(np.diagonal(N))) + 1e-300
    N, F = N / np.outer(size, size), F / np.outer(size, size)
    # The equilibria (N - mu s F) a = Q are singular where 1/mu is an eigenvalue of s N^-1 F.
    try:
        found = np.linalg.eigvals(np.linalg.solve(N, spin * F))
    except np.linalg.LinAlgError:
        return math.inf
    # Pairs of complex eigenvalues and negative ones belong to no friction coefficient.
    real = found.real[np.abs(found.imag) <= 1e-9 * np.abs(found)]
    return min((1 / float(x) for x in real if x > 1e-14), default=math.inf)


def locking_friction(brake: Brake, shoe: Shoe) -> float:
    """Friction mu_lock of a shoe by the law, with all of its lining in contact.

    It is the smaller of both senses of an abutment's friction.
    """
    face, arcs = face_of(brake, shoe), ((shoe.lining.start, shoe.lining.end),)
    width = shoe.lining.width
    limits = [locking(face, shoe.freedoms(sense), width, arcs, brake.spin) for sense in shoe.senses]
    return min(limits)


def press(brake: Brake, shoe: Shoe, *, whole: bool = False) -> PressedShoe | None:
    """The contact of a rigid shoe; None if its actuation is zero or lifts the shoe off.

    Parameters
    ----------
    brake, shoe : the shoe and its brake
    whole : whether all of the lining bears, tension included, as in closed forms

    Raises
    ------
    NoAnswer
        if the shoe locks itself, or nothing balances the actuation
    """
    face = face_of(brake, shoe)
    if shoe.actuation.force == 0:
        return None
    # A force that the lining can balance by tension alone lifts the shoe off.
    if bears(brake, shoe) < 0:
        return None
    # The first sense of an abutment's friction that fits the motion of the foot is the answer.
    failure: NoAnswer | None = None
    for sense in shoe.senses:
        try:
            found = _solve_contact(brake, shoe, face, sense, whole)
        except NoAnswer as error:
            failure = failure or error
            continue
        reaction = -shoe.actuation.vector - _contact_force(brake, shoe, found).force
        if shoe.stands(reaction, sense, float(found.amounts[-1])):
            return found
    raise failure or NoAnswer(f"shoe {shoe.name!r}: no equilibrium, its foot leaves the abutment")


def bears(brake: Brake, shoe: Shoe) -> int:
    """+1 if pressure without friction can balance the actuation, -1 if tension can, 0 otherwise."""
    face, ends = face_of(brake, shoe), (shoe.lining.start, shoe.lining.end)
    free = shoe.freedoms(shoe.senses[-1])
    shapes = face.closing(free.tests)
    if len(shapes) == 1:
        # With one mode, some place of the lining must press against the actuation.
        works = shapes[0] @ face.shapes(np.linspace(*ends, 65))[:2] * free.work[0]
        return 1 if works.max() > 1e-12 * np.abs(works).max() else -1
    try:
        resultant = np.asarray(np.linalg.solve(shapes, free.work), dtype=float)
        return face.centre(resultant, *ends)
    except np.linalg.LinAlgError:
        return 0


def _solve_contact(brake: Brake, shoe: Shoe, face: Face, sense: int, whole: bool) -> PressedShoe:
    """Solve a shoe for its contact with a given sense of the abutment's friction.

    The arcs in contact change until they are those where the pressure is positive. Parameters are
    those of `press`.
    """
    free, ends, mu = shoe.freedoms(sense), (shoe.lining.start, shoe.lining.end), brake.friction
    shapes = face.closing(free.motions)
    arcs: Arcs = (ends,)
    mu_lock = locking(face, free, shoe.lining.width, arcs, brake.spin)
    locked = f"self-locking, friction {mu:g} is not below mu_lock = {{:.6g}} of the rigid-shoe law"
    # With one mode the arcs in contact are known beforehand.
    if len(shapes) == 1:
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
        # The next arcs in contact are those where the pressure on the present arcs is positive.
        c = shapes.T @ amounts
        after = (ends,) if whole else face.pressed(c, *ends)
        if after and _agree(after, arcs):
            mu_lock = locking(face, free, shoe.lining.width, arcs, brake.spin)
            if mu >= mu_lock:
                break
            return PressedShoe(face, c, amounts, arcs, free, sense)
        if not after:
            break
        arcs = after
    # Above mu_lock friction is to blame, below it the place of the support.
    if mu >= mu_lock:
        raise NoAnswer(f"shoe {shoe.name!r}: {locked.format(mu_lock)}")
    raise NoAnswer(
        f"shoe {shoe.name!r}: tips, "
        "no pressure of a rigid shoe on its lining balances the actuation"
    )


def _agree(a: Arcs, b: Arcs) -> bool:
    """Whether two sets of contact arcs are equal but for round-off."""
    if len(a) != len(b):
        return False
    round_off = 1e-13 * max(1.0, np.abs(b).max())
    return bool(np.allclose(a, b, rtol=0, atol=round_off))


def _contact_force(brake: Brake, shoe: Shoe, found: PressedShoe) -> Resultant:
    """Resultant of pressure and friction on a shoe in contact."""
    loads = shoe.lining.width * found.face.products(found.arcs) @ found.c
    return found.face.force(loads, brake.friction * brake.spin)


def respond(brake: Brake, shoe: Shoe, found: PressedShoe | None) -> ShoeResponse:
    """The response of a shoe in contact, or without contact if `found` is None."""
    if found is None:
        return untouched(shoe, -shoe.actuation.vector)
    contact, flat = _contact_force(brake, shoe, found), shoe.flat
    ends = (shoe.lining.start, shoe.lining.end)
    # The pressure on a plane is linear, so that two steps are enough.
    place = nodes(ends, found.arcs, 2 if flat else PRESSURE_NODES - 1)
    about_pin = _moments_about_pin(shoe, contact)
    of_actuation = shoe.actuation.moment_about(shoe.pin)
    guided = shoe.guide is not None
    reaction_moment = -about_pin.pressure - about_pin.friction - of_actuation
    # Friction helps if its moment about the pin has the sense of the actuation's.
    helping = about_pin.friction * of_actuation
    if guided:
        helping = _work_of_friction(brake, found)
    return ShoeResponse(
        name=shoe.name,
        torque=0.0 if flat else abs(contact.moment),
        normal_force=float(np.linalg.norm(contact.normal)),
        self_energising=bool(helping > 0),
        peak_pressure=found.face.peak(found.c, found.arcs),
        hinge_reaction=-shoe.actuation.vector - contact.force,
        contact_arcs=found.arcs,
        theta=place,
        pressure=pressure(found, place),
        pivot_reaction=-contact.force if shoe.pivot is not None else None,
        reaction_moment=reaction_moment if guided else 0.0,
    )


def _work_of_friction(brake: Brake, found: PressedShoe) -> float:
    """Work of the friction on the slide along a guide, less NEITHER of the work of the pressure.

    It is not positive where the guide is square to the surface.
    """
    a = found.amounts
    systems = system(found.face, found.freedoms, 1.0, found.arcs)
    closed, dragged = (float(a @ work @ a) for work in systems)
    return brake.friction * brake.spin * dragged - NEITHER * closed


def pressure(found: PressedShoe | None, place: Floats) -> Floats:
    """Pressure [Pa] of a shoe at places of its lining, same shape; 0 of a shoe without contact."""
    if found is None:
        return np.zeros(np.shape(place))
    return np.maximum(found.c @ found.face.shapes(place)[:2], 0.0)


class _PinMoments(NamedTuple):
    """Moments of pressure and of friction about a shoe's pin [N m]."""

    pressure: float
    friction: float


def _moments_about_pin(shoe: Shoe, contact: Resultant) -> _PinMoments:
    """Moments of a contact's resultant about the shoe's pin."""
    pin = shoe.pin.xy
    # About the origin only the pressure has a moment on a plane, and only the friction on a drum.
    pressure, friction = (contact.moment, 0.0) if shoe.flat else (0.0, contact.moment)
    return _PinMoments(
        pressure - float(cross(pin, contact.normal)),
        friction - float(cross(pin, contact.friction)),
    )


def nodes(ends: tuple[float, float], arcs: Arcs, steps: int) -> Floats:
    """Nodes of quadratic pieces over a lining, evenly spaced between the ends of the contact.

    Parameters
    ----------
    ends : places where the lining begins and ends
    arcs : arcs in contact, whose ends are ends of pieces
    steps : number of steps over the whole lining
    """
    # A set keeps each end once: an arc in contact may end where the lining ends.
    marks = sorted({*ends, *(end for arc in arcs for end in arc)})
    found = [np.array(marks[:1])]
    for a, b in pairwise(marks):
        count = 2 * max(1, round(steps * (b - a) / (ends[1] - ends[0]) / 2))
        found.append(np.linspace(a, b, count + 1)[1:])
    return np.concatenate(found)


def forced(brake: Brake, *, whole: bool = False) -> Brake:
    """The brake with the forces that a cam or struts share among its shoes, by the law.

    `whole` is as of `press`. Raises NoAnswer if a shoe has no equilibrium.
    """
    shoes: list[Shoe] = list(brake.shoes)
    place = {shoe.name: i for i, shoe in enumerate(shoes)}
    if brake.actuation is not None and brake.actuation.is_cam:
        _share_cam(brake, shoes, brake.actuation.total, whole)
    # A strut passes on the force on the foot of the shoe before it.
    for link in brake.links:
        source, to = shoes[place[link.source]], place[link.to]
        found = press(brake, source, whole=whole)
        force = 0.0
        if found is not None:
            force = math.hypot(*respond(brake, source, found).hinge_reaction)
        shoes[to] = shoes[to].under(force)
    return brake.model_copy(update={"shoes": tuple(shoes)})


def _share_cam(brake: Brake, shoes: list[Shoe], total: float, whole: bool) -> None:
    """Give the shoes of a cam, in place, their parts of its force `total` [N].

    The tips of both shoes move equally. Each force is inverse to the tip's motion per force.
    """
    behind = {link.to for link in brake.links}
    on_cam = [i for i, shoe in enumerate(shoes) if shoe.name not in behind]
    motions_per_force = []
    for i in on_cam:
        found = press(brake, shoes[i], whole=whole)
        if found is None or found.tip <= 0:
            raise NoAnswer(f"shoe {shoes[i].name!r}: the cam does not press it")
        motions_per_force.append(found.tip / shoes[i].actuation.force)
    # The tips are springs side by side: the sum of their stiffnesses carries the cam's force.
    stiffness = math.fsum(1 / motion for motion in motions_per_force)
    for i, motion in zip(on_cam, motions_per_force, strict=True):
        shoes[i] = shoes[i].under(total / (motion * stiffness))


def solve(brake: Brake, name: str = "rigid", *, whole: bool = False) -> Response:
    """Solve a brake by the rigid-shoe law.

    Parameters
    ----------
    brake : the brake
    name : of the law for such brakes
    whole : as of `press`

    Raises
    ------
    NoAnswer
        for a self-locking shoe or a shoe that nothing balances
    """
    under = forced(brake, whole=whole)
    shoes = tuple(respond(under, shoe, press(under, shoe, whole=whole)) for shoe in under.shoes)
    # Responses name the forces that the solve has found; the file gives only their sum.
    if under.shoes != brake.shoes:
        shoes = tuple(
            replace(response, force=shoe.actuation.force)
            for response, shoe in zip(shoes, under.shoes, strict=True)
        )
    word = brake.surface.word
    apart = [no_contact(shoe.name, word) for shoe in shoes if not shoe.contact_arcs]
    response = Response(
        model=name,
        shoes=shoes,
        balance=worst([shoe_balance(under, i, shoe) for i, shoe in enumerate(shoes)]),
        left_out=LEFT_OUT[word],
        notes=(*apart, *cam_notes(brake)),
    )
    return with_merits(brake, response)


def cam_notes(brake: Brake) -> tuple[str, ...]:
    """A note on how a cam shares its force between linings of different E/t, if they differ.

    Both tips move equally. A new lining under a rigid shoe gives way by p t/E, a worn-in lining
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
        f"cam: linings of unlike E/t, {moduli[0]:.3g} and {moduli[1]:.3g} Pa/m: "
        "where rigid shoes are mirror images "
        "its forces are such that F1 B1 t1/E1 = F2 B2 t2/E2 new, F1 B1 = F2 B2 worn in, "
        "both wearing alike",
    )


def no_contact(name: str, body: str = "drum") -> str:
    """Note on a shoe that its force does not press."""
    return f"shoe {name!r}: no contact, the force does not turn it towards the {body}"
