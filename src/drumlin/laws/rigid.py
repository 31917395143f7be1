"""Solve brakes with rigid shoes by the rigid-shoe law, on a drum or a plane.

The rigid-body mode k of a shoe moves its lining by u_k and closes the gap by f_k = n.u_k, with the
lining's normal n. The pressure is p = sum of a_k f_k where the sum is positive, and 0 elsewhere.
There are as many test modes v_j as rigid-body modes, and each test mode gives one equilibrium of
moments or forces. The factors a_k follow from these equilibria. They contain the friction
coefficient mu, the sense s = +1 or -1 of the motion, the direction t along the surface, the width w
of the lining, and the work Q_j of the actuation on the test mode v_j (see
`drumlin.brake.support`):

    w Int p (n.v_j - mu s t.v_j) ds = Q_j     over the part of the lining where p > 0

For some supports the law has a well-known form: sine (a hinge on a drum), A cos + B sin (a pivot or
an abutment), cosine (a guide on a drum), linear (a hinge on a plane), uniform (a guide on a plane).
"""

import math
from dataclasses import replace
from functools import partial
from itertools import chain, pairwise
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.heat import warning_that_law_neglects_heat
from drumlin.brake.one_sided import note_on_shoe_held_off_by_its_supports
from drumlin.brake.support import SupportRigidBodyModes
from drumlin.brake.writing import part_values_other_than_defaults
from drumlin.laws.anchored import (
    contact_of_shoe_on_anchors,
    locking_frictions_of_shoes_on_anchors,
    solve_shoes_on_anchors,
)
from drumlin.laws.face import (
    ContactArcsOfRigidShoe,
    FrictionSurfaceOfRigidShoe,
    friction_surface_of_shoe,
)
from drumlin.laws.shoe_contact import (
    MOST_ITERATIONS_FOR_CONTACT_ARCS,
    RigidShoeContact,
    arcs_of_positive_pressure_on_linings,
    are_contact_arcs_equal,
    equilibrium_matrices_of_rigid_shoe,
    self_locking_friction_on_arcs,
)
from drumlin.response.balance import largest_imbalance_among_shoes, relative_imbalance_of_shoe
from drumlin.response.merit import response_with_figures_of_merit
from drumlin.response.response import (
    LARGEST_NEUTRAL_FRICTION_OVER_PRESSURE_WORK,
    Response,
    ShoeResponse,
    notes_on_forces_of_one_sided_supports,
    response_of_shoe_without_contact,
)
from drumlin.response.resultants import (
    PressureAndFrictionResultant,
    planar_cross_product,
    polynomial_nodes_on_linings_and_slots,
    slots_from_nodes_and_lining_mask,
)
from drumlin.response.self_locking import (
    LockedShoesAndLockingFriction,
    SelfLocking,
    first_shoes_to_lock,
)

RIGID_SHOE_LAW_ASSUMPTIONS = (
    "rigid shoe: p = sum of a_k f_k >= 0, f_k how each freedom of the shoe closes the gap"
)
"""The assumptions of the law of a rigid shoe on any support, as printed with its answer."""
# The beginning of the last note in NEGLECTED_BY_RIGID_LAWS; the name of the surface follows.
_NEGLECTED_CLEARANCE_AND_MISFIT = (
    "clearance and misfit: the law is that of a lining that fits, new or worn in, on a"
)
NEGLECTED_BY_RIGID_LAWS = {
    "drum": (
        "elasticity of shoe, backing and drum: rigid by assumption",
        f"{_NEGLECTED_CLEARANCE_AND_MISFIT} round drum",
    ),
    "plane": ("elasticity: rigid by assumption", f"{_NEGLECTED_CLEARANCE_AND_MISFIT} plane"),
}
"""Notes for users on the effects that the rigid-shoe laws neglect on a drum and on a plane."""

NUMBER_OF_PRESSURE_NODES_ON_DRUM_LINING = 257
"""Number of nodes of the pressure over a lining on a drum.

A parabola through every three successive nodes interpolates the pressure (Simpson's rule).
Integrals over these parabolas have a relative error below 1e-10.
"""


def self_locking_frictions_of_rigid_shoes(brake: Brake) -> list[float]:
    """The limit of `self_locking_friction_of_rigid_shoe` for each shoe of a brake.

    Shoes that a strut joins are computed once.
    """
    on_anchors = locking_frictions_of_shoes_on_anchors(brake)
    return [
        on_anchors[i] if shoe.anchors else self_locking_friction_of_rigid_shoe(brake, shoe)
        for i, shoe in enumerate(brake.shoes)
    ]


def self_locking_friction_of_rigid_shoe(brake: Brake, shoe: Shoe) -> float:
    """Friction coefficient mu_lock at which a rigid shoe with its whole lining in contact locks.

    Friction at an abutment may act in two senses; the result is the smaller of the two values of
    mu_lock. A shoe on anchors locks together with the shoes that a strut joins to it.
    """
    if shoe.anchors:
        return locking_frictions_of_shoes_on_anchors(brake)[brake.shoes.index(shoe)]
    face, arcs = friction_surface_of_shoe(brake, shoe), shoe.lining.arcs
    width = shoe.lining.width
    limits = [
        self_locking_friction_on_arcs(
            face, shoe.rigid_body_modes_of_support(sense), width, arcs, brake.sign_of_motion
        )
        for sense in shoe.senses_of_abutment_friction_to_try
    ]
    return min(limits)


def self_locking_by_rigid_shoe_law(brake: Brake) -> SelfLocking:
    """The brake's friction, and the friction at which its first shoe locks by the rigid-shoe law.

    Both are friction coefficients of the brake. The coefficient of a lining with its own friction
    is assumed to grow in proportion to the coefficient of the brake.
    """
    limits = []
    own_limits = self_locking_frictions_of_rigid_shoes(brake)
    for shoe, limit in zip(brake.shoes, own_limits, strict=True):
        scaled = brake.brake_friction_that_gives_shoe_friction(shoe, limit)
        limits.append(LockedShoesAndLockingFriction((shoe.name,), scaled))
    return SelfLocking(
        brake.friction,
        first_shoes_to_lock(limits),
        key_of_lining_with_own_friction=brake.first_key_that_gives_lining_its_own_friction() or "",
    )


def find_contact_of_rigid_shoe(
    brake: Brake, shoe: Shoe, *, whole: bool = False
) -> RigidShoeContact | None:
    """Find the contact of a rigid shoe; None if its actuation is zero or lifts the shoe off.

    Parameters
    ----------
    brake, shoe : the brake and the shoe
    whole : whether the whole lining stays in contact, under tension if need be, as closed-form laws
        assume; without effect on shoes on anchors

    Raises
    ------
    NoAnswer
        if the shoe locks itself, or no pressure on its lining balances the actuation
    """
    if shoe.anchors:
        return contact_of_shoe_on_anchors(brake, brake.shoes.index(shoe))
    face = friction_surface_of_shoe(brake, shoe)
    if not shoe.is_any_load_on_shoe:
        return None
    # An actuation that only a tension on the lining could balance lifts the shoe off.
    if sign_of_pressure_that_balances_actuation(brake, shoe) < 0:
        return None
    # Friction at an abutment must oppose the slide of the shoe's foot, or hold the foot. The senses
    # of this friction are tried until the solution for one of them fulfils this condition.
    failure: NoAnswer | None = None
    for sense in shoe.senses_of_abutment_friction_to_try:
        try:
            found = _find_contact_for_friction_sense(brake, shoe, face, sense, whole)
        except NoAnswer as error:
            failure = failure or error
            continue
        reaction = (
            -shoe.sum_of_forces_of_all_loads
            - _contact_resultant_of_rigid_shoe(brake, shoe, found).force
        )
        if shoe.can_abutment_exert_reaction_on_shoe(
            reaction, sense, float(found.rigid_body_mode_factors[-1])
        ):
            return found
    raise failure or NoAnswer(f"shoe {shoe.name!r}: no equilibrium, its foot leaves the abutment")


def sign_of_pressure_that_balances_actuation(brake: Brake, shoe: Shoe) -> int:
    """The sign of the normal stress on a lining that can balance its shoe's actuation.

    It is +1 if a pressure can balance it, -1 if only a tension can, and 0 if neither can. Friction
    is neglected here.
    """
    face, ends = friction_surface_of_shoe(brake, shoe), (shoe.lining.start, shoe.lining.end)
    free = shoe.rigid_body_modes_of_support(shoe.senses_of_abutment_friction_to_try[-1])
    shapes = face.gap_closing_factors_of_rigid_body_motions(free.test_modes)
    if len(shapes) == 1:
        # A shoe with one mode moves so that the loads do positive work. A pressure can balance them
        # if this motion closes the gap at some place of the lining.
        places = np.concatenate([np.linspace(*arc, 65) for arc in shoe.lining.arcs])
        works = (
            shapes[0]
            @ face.shape_function_values(places)[:2]
            * free.work_of_all_loads_on_test_modes[0]
        )
        return 1 if works.max() > 1e-12 * np.abs(works).max() else -1
    try:
        resultant = np.asarray(
            np.linalg.solve(shapes, free.work_of_all_loads_on_test_modes), dtype=float
        )
        return face.sign_of_normal_stress_with_given_resultant(resultant, *ends)
    except np.linalg.LinAlgError:
        return 0


def _find_contact_for_friction_sense(
    brake: Brake, shoe: Shoe, face: FrictionSurfaceOfRigidShoe, sense: int, whole: bool
) -> RigidShoeContact:
    """Find the contact of a rigid shoe for a given sense of the friction at its abutment.

    The function changes the arcs in contact until the pressure is positive on these arcs and
    nowhere else.

    Parameters
    ----------
    brake, shoe : the brake and the shoe
    whole : whether the whole lining stays in contact, under tension if need be
    face : surface on which the shoe presses
    sense : sense of the friction on the foot at an abutment

    Raises
    ------
    NoAnswer
        if the shoe locks itself, or no pressure on its lining balances the actuation
    """
    free, linings = shoe.rigid_body_modes_of_support(sense), shoe.lining.arcs
    mu = brake.friction_coefficient_of_shoe_at_zero_pressure(shoe)
    shapes = face.gap_closing_factors_of_rigid_body_motions(free.motions)
    locking_friction_on = partial(
        self_locking_friction_on_arcs, face, free, shoe.lining.width, spin=brake.sign_of_motion
    )
    arcs: ContactArcsOfRigidShoe = linings
    mu_lock = locking_friction_on(arcs)
    locked = f"self-locking, friction {mu:g} is not below mu_lock = {{:.6g}} of the rigid-shoe law"
    # A shoe with one rigid-body mode moves so that the loads do positive work. This motion tells
    # which arcs come into contact.
    if len(shapes) == 1:
        arcs = arcs_of_positive_pressure_on_linings(
            face, shapes[0] * math.copysign(1.0, free.work_of_all_loads_on_test_modes[0]), linings
        )
        mu_lock = locking_friction_on(arcs)
        if mu >= mu_lock:
            raise NoAnswer(f"shoe {shoe.name!r}: {locked.format(mu_lock)}")
    for _ in range(MOST_ITERATIONS_FOR_CONTACT_ARCS):
        matrices = equilibrium_matrices_of_rigid_shoe(face, free, shoe.lining.width, arcs)
        rigid_body_mode_factors = _pressure_mode_factors_in_equilibrium(
            matrices, free, mu * brake.sign_of_motion
        )
        if rigid_body_mode_factors is None:
            break
        # The next arcs are those where the pressure that follows from the present arcs is positive.
        c = shapes.T @ rigid_body_mode_factors
        after = linings if whole else arcs_of_positive_pressure_on_linings(face, c, linings)
        if after and are_contact_arcs_equal(after, arcs):
            mu_lock = locking_friction_on(arcs)
            if mu >= mu_lock:
                break
            return RigidShoeContact(face, c, rigid_body_mode_factors, arcs, free, sense)
        if not after:
            break
        arcs = after
    # The search has found no equilibrium. If mu is above mu_lock, the shoe locks itself; otherwise
    # it tips at its support.
    if mu >= mu_lock:
        raise NoAnswer(f"shoe {shoe.name!r}: {locked.format(mu_lock)}")
    raise NoAnswer(
        f"shoe {shoe.name!r}: tips, "
        "no pressure of a rigid shoe on its lining balances the actuation"
    )


def _pressure_mode_factors_in_equilibrium(
    matrices: tuple[Floats, Floats], free: SupportRigidBodyModes, drag: float
) -> Floats | None:
    """The factors (k,) of the rigid-body modes in the pressure of a shoe in equilibrium.

    None is returned if the equations are singular.

    Parameters
    ----------
    matrices : N and F, see `equilibrium_matrices_of_rigid_shoe`
    free : rigid-body modes of the shoe
    drag : friction coefficient times the sense of sliding, +1 or -1
    """
    N, F = matrices
    try:
        return np.linalg.solve(N - drag * F, free.work_of_all_loads_on_test_modes).astype(float)
    except np.linalg.LinAlgError:
        return None


def _contact_resultant_of_rigid_shoe(
    brake: Brake, shoe: Shoe, found: RigidShoeContact
) -> PressureAndFrictionResultant:
    """Resultant of pressure and friction on a rigid shoe in contact."""
    loads = shoe.lining.width * found.face.integrals_of_shape_products(found.arcs) @ found.c
    return found.face.force(loads, brake.signed_friction_stress_over_pressure(shoe))


def response_of_rigid_shoe(
    brake: Brake, shoe: Shoe, found: RigidShoeContact | None
) -> ShoeResponse:
    """The response of a rigid shoe with the contact `found`; None stands for no contact."""
    if found is None:
        return response_of_shoe_without_contact(shoe, -shoe.sum_of_forces_of_all_loads)
    contact, flat = _contact_resultant_of_rigid_shoe(brake, shoe, found), shoe.is_on_plane
    # The pressure on a plane is linear in x, so that three nodes (two intervals) are enough.
    steps, linings = 2 if flat else NUMBER_OF_PRESSURE_NODES_ON_DRUM_LINING - 1, []
    for ends in shoe.lining.arcs:
        own = tuple(arc for arc in found.arcs if ends[0] <= arc[0] and arc[1] <= ends[1])
        linings.append(node_places_of_pressure_along_lining(ends, own, steps))
    place, on_lining = polynomial_nodes_on_linings_and_slots(linings, 2)
    about_pin = _pressure_and_friction_moments_about_pin(shoe, contact)
    of_actuation = shoe.moment_of_all_loads_about_point(shoe.pin)
    guided = shoe.guide is not None
    # The reaction has a moment about the pin if a guide keeps the shoe from turning, or if several
    # anchors act at different points.
    has_moment = guided or bool(shoe.anchors)
    reaction_moment = -about_pin.pressure - about_pin.friction - of_actuation
    # Friction is self-energising if its moment about the pin has the sign of the loads' moment.
    helping = about_pin.friction * of_actuation
    # A shoe on a guide does not turn, and a shoe on anchors turns about no given point. For such a
    # shoe friction is self-energising if it does positive work in the motion of the shoe.
    if has_moment:
        drag = brake.signed_friction_stress_over_pressure(shoe)
        helping = _friction_work_minus_round_off_threshold(drag, found)
    return ShoeResponse(
        name=shoe.name,
        torque=0.0 if flat else abs(contact.moment),
        normal_force=float(np.linalg.norm(contact.normal)),
        self_energising=bool(helping > 0),
        peak_pressure=found.face.peak_pressure_on_arcs(found.c, found.arcs),
        hinge_reaction=-shoe.sum_of_forces_of_all_loads - contact.force,
        contact_arcs=found.arcs,
        theta=place,
        pressure=pressures_of_rigid_shoe_at_places(found, place) * on_lining,
        slots=slots_from_nodes_and_lining_mask(place, on_lining),
        pivot_reaction=None
        if shoe.pivot is None
        else -contact.force - shoe.resultant_of_loads_besides_actuation[:2],
        reaction_moment=reaction_moment if has_moment else 0.0,
    )


def _friction_work_minus_round_off_threshold(drag: float, found: RigidShoeContact) -> float:
    """Work of the friction in the motion of a shoe, minus the largest work that counts as zero.

    The largest work that counts as zero is LARGEST_NEUTRAL_FRICTION_OVER_PRESSURE_WORK times the
    work of the pressure. Without this term round-off could make the result positive where friction
    does no work, as with a guide square to the surface. The result is positive if friction is
    self-energising. `drag` is the friction stress on the lining divided by the pressure.
    """
    a = found.rigid_body_mode_factors
    systems = equilibrium_matrices_of_rigid_shoe(found.face, found.freedoms, 1.0, found.arcs)
    closed, dragged = (float(a @ work @ a) for work in systems)
    return drag * dragged - LARGEST_NEUTRAL_FRICTION_OVER_PRESSURE_WORK * closed


def pressures_of_rigid_shoe_at_places(found: RigidShoeContact | None, place: Floats) -> Floats:
    """Pressure [Pa] of a rigid shoe at places of its lining, in the shape of `place`.

    The pressure is 0 where the lining does not touch. It is 0 everywhere if `found` is None, which
    means that the shoe does not touch.
    """
    if found is None:
        return np.zeros(np.shape(place))
    return np.maximum(found.c @ found.face.shape_function_values(place)[:2], 0.0)


class _PressureAndFrictionMomentsAboutPin(NamedTuple):
    """The moments [N m] about a shoe's pin of the pressure and of the friction on its lining."""

    pressure: float
    friction: float


def _pressure_and_friction_moments_about_pin(
    shoe: Shoe, contact: PressureAndFrictionResultant
) -> _PressureAndFrictionMomentsAboutPin:
    """Moments about a shoe's pin of pressure and friction, from the resultant of both."""
    pin = shoe.pin.xy
    # The moment of the resultant is taken about the origin. About this point only the pressure has
    # a moment on a plane, and only the friction on a drum.
    pressure, friction = (contact.moment, 0.0) if shoe.is_on_plane else (0.0, contact.moment)
    return _PressureAndFrictionMomentsAboutPin(
        pressure - float(planar_cross_product(pin, contact.normal)),
        friction - float(planar_cross_product(pin, contact.friction)),
    )


def node_places_of_pressure_along_lining(
    ends: tuple[float, float], arcs: ContactArcsOfRigidShoe, steps: int
) -> Floats:
    """Choose the places (n,), along a lining, of the nodes at which the pressure is given.

    A parabola through every three successive nodes gives the pressure between them. Each end of an
    arc in contact is the end of a parabola, and between two such ends the nodes are evenly spaced.

    Parameters
    ----------
    ends : places where the lining begins and ends
    arcs : arcs of the lining in contact
    steps : approximate number of intervals between nodes along the whole lining
    """
    # A set holds each end once, even if an arc in contact ends where the lining ends.
    marks = sorted({*ends, *chain.from_iterable(arcs)})
    found = [np.array(marks[:1])]
    for a, b in pairwise(marks):
        count = 2 * max(1, round(steps * (b - a) / (ends[1] - ends[0]) / 2))
        found.append(np.linspace(a, b, count + 1)[1:])
    return np.concatenate(found)


def brake_with_cam_and_strut_forces_by_rigid_law(brake: Brake, *, whole: bool = False) -> Brake:
    """Set the forces of a cam and of struts on the shoes by the rigid-shoe law.

    Returns a changed copy of the brake. With `whole` the whole lining stays in contact, under
    tension if need be. Raises NoAnswer if a shoe has no equilibrium.
    """
    shoes: list[Shoe] = list(brake.shoes)
    place = {shoe.name: i for i, shoe in enumerate(shoes)}
    if brake.actuation is not None and brake.actuation.is_cam_or_wedge:
        _divide_cam_force_between_shoes(
            brake, shoes, brake.actuation.force_of_cylinder_or_sum_of_cam_forces, whole
        )
    # A strut pushes a shoe with the force that the other shoe exerts on the strut by its abutment.
    pushed = brake.names_of_shoes_pushed_by_struts
    for link in brake.links:
        if link.to not in pushed:
            continue
        source, to = shoes[place[link.source]], place[link.to]
        found = find_contact_of_rigid_shoe(brake, source, whole=whole)
        force = 0.0
        if found is not None:
            force = math.hypot(*response_of_rigid_shoe(brake, source, found).hinge_reaction)
        shoes[to] = shoes[to].shoe_with_changed_actuation_force(force)
    return brake.model_copy(update={"shoes": tuple(shoes)})


def _divide_cam_force_between_shoes(
    brake: Brake, shoes: list[Shoe], total: float, whole: bool
) -> None:
    """Give the shoes under a cam, in the list `shoes`, their parts of the cam's force.

    The two parts add up to `total` [N]. The cam moves the loaded ends of both shoes equally, so
    that each part is inversely proportional to the displacement of the shoe's loaded end per force.
    Raises NoAnswer if the cam does not press a shoe. With `whole` the whole lining stays in
    contact, under tension if need be.
    """
    # A shoe behind a strut is pushed by the strut and not by the cam.
    behind = brake.names_of_shoes_pushed_by_struts
    on_cam = [i for i, shoe in enumerate(shoes) if shoe.name not in behind]
    if any(shoes[i].has_loads_besides_actuation for i in on_cam):
        first = _cam_force_on_first_shoe_with_further_loads(brake, shoes, on_cam, total, whole)
        for i, force in zip(on_cam, (first, total - first), strict=True):
            shoes[i] = shoes[i].shoe_with_changed_actuation_force(force)
        return
    motions_per_force = []
    for i in on_cam:
        found = find_contact_of_rigid_shoe(brake, shoes[i], whole=whole)
        if found is None or found.loaded_point_motion_over_compliance <= 0:
            raise NoAnswer(f"shoe {shoes[i].name!r}: the cam does not press it")
        motions_per_force.append(
            found.loaded_point_motion_over_compliance / shoes[i].actuation.force
        )
    # The loaded ends of the shoes act like springs in parallel: the sum of their stiffnesses
    # carries the cam's force.
    stiffness = math.fsum(1 / motion for motion in motions_per_force)
    for i, motion in zip(on_cam, motions_per_force, strict=True):
        shoes[i] = shoes[i].shoe_with_changed_actuation_force(total / (motion * stiffness))


def _cam_force_on_first_shoe_with_further_loads(
    brake: Brake, shoes: list[Shoe], on_cam: list[int], total: float, whole: bool
) -> float:
    """The force [N] of a cam on the first of its two shoes, if springs or other forces act as well.

    The cam moves the loaded ends of both shoes equally. The difference of their displacements grows
    with the force on the first shoe, so that it is zero at a force between 0 and `total`. The
    parameters are those of `_divide_cam_force_between_shoes`, and `on_cam` has the positions of the
    two shoes in `shoes`. Raises NoAnswer if the cam does not press both shoes.
    """
    # The import of scipy takes time, and few brakes come here.
    from scipy.optimize import brentq  # noqa: PLC0415

    def loaded_end_motion_in_pascal(i: int, force: float) -> float:
        """Displacement of a shoe's loaded end, divided by its lining's compression per pressure.

        The quotient is in Pa. `i` is the index of the shoe, and `force` [N] the force on it. The
        result is 0 if the shoe does not touch.
        """
        shoe = shoes[i].shoe_with_changed_actuation_force(force)
        found = find_contact_of_rigid_shoe(brake, shoe, whole=whole)
        return 0.0 if found is None else found.loaded_point_motion_over_compliance

    one, other = on_cam

    def difference_of_both_loaded_end_motions(force: float) -> float:
        """The motion [Pa] of the first shoe's loaded end minus that of the second shoe's.

        `force` [N] is the force on the first shoe; the rest of `total` acts on the second.
        """
        return loaded_end_motion_in_pascal(one, force) - loaded_end_motion_in_pascal(
            other, total - force
        )

    low, high = (
        difference_of_both_loaded_end_motions(0.0),
        difference_of_both_loaded_end_motions(total),
    )
    if not low < 0 < high:
        # A shoe that springs or other forces move farther than the cam loses contact with the cam.
        lacking = on_cam[0] if low >= 0 else on_cam[1]
        raise NoAnswer(f"shoe {shoes[lacking].name!r}: the cam does not press it")
    force = float(
        brentq(difference_of_both_loaded_end_motions, 0.0, total, xtol=1e-13 * total, rtol=1e-15)
    )
    for i, part in ((one, force), (other, total - force)):
        if loaded_end_motion_in_pascal(i, part) <= 0:
            raise NoAnswer(f"shoe {shoes[i].name!r}: the cam does not press it")
    return force


def solve_brake_by_rigid_shoe_law(
    brake: Brake, name: str = "rigid", *, whole: bool = False
) -> Response:
    """Solve a brake by the rigid-shoe law.

    Parameters
    ----------
    brake : the brake
    name : name of the law, which the response states as its model
    whole : whether the whole lining stays in contact, under tension if need be

    Raises
    ------
    NoAnswer
        for a self-locking shoe, or for a shoe whose actuation no pressure balances
    """
    under = brake_with_cam_and_strut_forces_by_rigid_law(brake, whole=whole)
    anchored = solve_shoes_on_anchors(under)
    shoes = []
    for shoe in under.shoes:
        found = anchored.contacts.get(shoe.name)
        if not shoe.anchors:
            found = find_contact_of_rigid_shoe(under, shoe, whole=whole)
        answer = response_of_rigid_shoe(under, shoe, found)
        shoes.append(replace(answer, supports=anchored.supports.get(shoe.name, ())))
    # If a cam or a strut decides the forces on the shoes, each response states its shoe's force.
    if under.shoes != brake.shoes:
        shoes = [
            replace(response, force=shoe.actuation.force)
            for response, shoe in zip(shoes, under.shoes, strict=True)
        ]
    word = brake.surface.name
    notes_on_contact = [
        note_on_shoe_held_off_by_its_supports(shoe)
        if shoe.anchors
        else note_on_shoe_without_contact(shoe.name, word)
        for shoe, answer in zip(under.shoes, shoes, strict=True)
        if not answer.contact_arcs
    ]
    balances = [relative_imbalance_of_shoe(under, i, shoe) for i, shoe in enumerate(shoes)]
    response = Response(
        model=name,
        shoes=tuple(shoes),
        balance=largest_imbalance_among_shoes(balances),
        left_out=NEGLECTED_BY_RIGID_LAWS[word],
        notes=(
            *notes_on_contact,
            *notes_on_forces_of_one_sided_supports(shoes),
            *anchored.warnings,
            *notes_on_cam_force_of_unlike_linings(brake),
        ),
    )
    return response_with_figures_of_merit(brake, response)


def notes_on_cam_force_of_unlike_linings(brake: Brake) -> tuple[str, ...]:
    """A note on how a cam divides its force, if the linings of its two shoes have different E/t.

    If the linings have equal E/t, or if there is no cam, the result has no note.

    The cam moves the loaded ends of both shoes equally. New linings allow this by the compression
    p t/E, which depends on E/t. Worn-in linings allow it by wear, which is proportional to the
    pressure p for any E/t.
    """
    if brake.actuation is None or not brake.actuation.is_cam_or_wedge:
        return ()
    behind = brake.names_of_shoes_pushed_by_struts
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


UNUSED_KEYS_LINE_START = "keys that the law does not use: "
"""Beginning of the line of text that names the keys of a brake file that a law does not use."""


def response_with_note_on_ignored_keys(brake: Brake, response: Response) -> Response:
    """The response of a rigid-shoe law, with a line that names the given keys that the law ignores.

    Responses of other models are returned unchanged.

    The law also ignores `misfit.blocks`. The real lining does not press where blocks lie back, so
    that torque and pressure of the law are wrong; a warning says so.
    """
    if response.left_out != NEGLECTED_BY_RIGID_LAWS[brake.surface.name]:
        return response
    keys = _given_keys_that_laws_do_not_use(brake)
    line = (UNUSED_KEYS_LINE_START + ", ".join(keys),) if keys else ()
    heat = warning_that_law_neglects_heat(brake)
    blocks = tuple(
        f"warning: shoe {shoe.name!r}: misfit.blocks are left out, the law takes the lining as "
        "whole; --model fem has the blocks, and linings apart are [[shoe.lining]], a table each"
        for shoe in brake.shoes
        if any(part.misfit.blocks for part in shoe.lining.linings)
    )
    warnings = blocks if heat is None else (heat, *blocks)
    return replace(
        response, left_out=(*response.left_out, *line), notes=(*response.notes, *warnings)
    )


def _given_keys_that_laws_do_not_use(brake: Brake) -> list[str]:
    """The keys of a brake, such as "shoe.body", that no rigid-shoe law uses; each key once."""
    # The key `out_of_round` is read from the drum, because `out_of_round_harmonics` of a brake also
    # has the growth of a heated drum, about which there is a separate warning.
    out_of_round = getattr(getattr(brake, "drum", None), "out_of_round", ())
    parts: dict[str, object] = {"drum.ring": brake.ring, "drum.out_of_round": out_of_round}
    for shoe in brake.shoes:
        of_shoe: dict[str, object] = {name: getattr(shoe, name) for name in ("body", "backing")}
        of_shoe["mesh"] = shoe.mesh
        of_shoe["anchor.clearance"] = any(anchor.clearance for anchor in shoe.anchors)
        for part in shoe.lining.linings:
            misfit = sorted(key for key, _, _ in part_values_other_than_defaults(part.misfit))
            unlike = {f"lining.misfit.{key}": True for key in misfit}
            of_shoe |= {"lining.clearance": part.clearance, **unlike}
            parts |= {f"shoe.{name}": value for name, value in of_shoe.items() if value}
    # Nothing moves in the laws, so that a spring pulls with its preload.
    parts["spring.rate"] = any(spring.rate for spring in brake.springs)
    return [key for key, value in parts.items() if value]


def note_on_shoe_without_contact(name: str, body: str = "drum") -> str:
    """The text of the note on a shoe that its actuation does not press on the drum or plane.

    `name` is the name of the shoe, and `body` the word for the moving body.
    """
    return f"shoe {name!r}: no contact, the force does not turn it towards the {body}"
