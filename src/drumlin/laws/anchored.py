"""The rigid-shoe law of shoes on one-sided supports: anchors, and struts between shoes on anchors.

Each shoe has three rigid-body motions y: the turn about its pin and two translations. Its lining
has the stiffness E/t per area, so that the pressure is E/t times the closing of the gap. The
matrices N and F are those of `equilibrium_matrices_of_rigid_shoe`. Q is the work of the actuation
and of other loads on the motions, mu the friction coefficient, and s = +1 or -1 the sense in which
drum or plane moves. V y are the gaps at the supports, and f the forces of the supports on the
shoes:

    E/t (N - mu s F) y = Q + V^T f,    V y >= 0,  f >= 0,  f V y = 0

A support that bears (V y = 0) prevents one motion. The equilibria in the motions that remain free
give y, and the equilibria in the prevented motions give f. Every set of bearing supports is tried.
The clearances of supports and linings are neglected.

A floating shoe moves towards its open anchor as friction grows. Where they meet, both anchors and
the strut hold the shoes, and the drum wedges the shoes between them: above this friction no set of
bearing supports has an equilibrium. The limit of self-locking is therefore found by following the
equilibrium as friction grows; one set of supports alone may never lock.
"""

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import NoAnswer
from drumlin.base.lapack import block_diag
from drumlin.brake.brake import Brake
from drumlin.brake.one_sided import (
    ERROR_TEXT_ON_SHOE_THAT_IS_NOT_HELD,
    LARGEST_ROUND_OFF_CONTACT_FORCE,
    LARGEST_ROUND_OFF_PULL_OF_SUPPORT,
    LARGEST_SINGULAR_VALUE_OF_REDUNDANT_SUPPORT,
    BearingFlagsOfOneSidedSupports,
    HeldAndFreeRigidBodyMotions,
    OneSidedSupport,
    OneSidedSupportForce,
    all_choices_of_bearing_supports,
    divide_motions_into_held_and_free,
    do_linings_resist_free_motions,
    error_text_on_shoes_without_contact_force,
    forces_of_one_sided_supports_on_shoe,
    groups_of_shoes_on_anchors,
    one_sided_supports_of_brake,
    text_with_names_of_bearing_supports,
    work_of_support_push_in_rigid_body_modes,
)
from drumlin.brake.support import SupportRigidBodyModes
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
    smallest_friction_with_singular_equilibrium,
)

MOST_FRICTION_HALVINGS = 30
"""Largest number of times that the friction is halved in search of an equilibrium.

The self-locking friction mu_lock depends on which supports bear. An equilibrium shows which of them
bear, but above mu_lock there is no equilibrium. The search therefore lowers the friction. After
thirty halvings the friction is 1e-9 of its value: the brake is as good as frictionless, and more
halvings would change no result.
"""
LARGEST_FOLLOWED_FRICTION = 10.0
"""Friction coefficient up to which the equilibrium of rigid shoes on anchors is followed.

Shoes that have an equilibrium up to there count as shoes that never lock. Linings have friction
coefficients up to some 0.6.
"""
FOLLOWED_FRICTION_STEP = 0.25
"""Step of the friction coefficient, relative to the coefficient, while an equilibrium is followed.

A support that begins and ceases to bear within one step goes unnoticed. A smaller step costs time.
"""
FRICTION_LIMIT_RESOLUTION = 1e-7
"""Relative error of the friction coefficient at which the equilibrium of rigid shoes ends.

Messages print six digits of it.
"""
VANISHING_FORCE = 1e-5
"""Force of a support, relative to the largest one, below which the support is about to open.

It counts at a friction coefficient that lies FRICTION_LIMIT_RESOLUTION below the end of the
equilibrium. A force that falls to zero there is of that order.
"""
NEAR_POLE = 0.01
"""Relative distance of a friction coefficient from mu_lock within which pressures count as growing.

The limit is then mu_lock of the arcs in contact. So near to it the iterations of the arcs need not
converge. On a block between two anchors, the results for several first frictions differ by 0.02 %.
"""
SAME_SUPPORT_FORCE_TOLERANCE = 1e-6
"""Difference of support forces below which two equilibria count as the same.

The difference is relative to the largest support force. A support may touch its shoe with zero
force. The sets of bearing supports with and without this support then have the same equilibrium.
The value lies far above round-off, and far below the difference of two real equilibria.
"""


class _GeometryOfShoesOnAnchors(NamedTuple):
    """The geometry of shoes on one-sided supports whose equilibria are solved together.

    Attributes
    ----------
    members : indices of the shoes in the brake
    faces, freedoms : friction surface of each shoe, and rigid-body modes of each shoe
    stiffness : (shoes,) stiffness E/t of each lining, divided by E/t of the first lining; ones if
        any E/t is unknown
    supports : the m one-sided supports of the shoes
    opening : (m, k) growth of the gap at each support per unit of each rigid-body mode; k is three
        times the number of shoes
    sizes : (k,) amount of each mode at which points of the shoe move by about 1 m
    """

    members: tuple[int, ...]
    faces: tuple[FrictionSurfaceOfRigidShoe, ...]
    freedoms: tuple[SupportRigidBodyModes, ...]
    stiffness: Floats
    supports: tuple[OneSidedSupport, ...]
    opening: Floats
    sizes: Floats


class EquilibriumOfShoesOnAnchors(NamedTuple):
    """An equilibrium of shoes on one-sided supports.

    `bearing` tells which supports bear, `contacts` has the contact of each shoe by its name, and
    `forces` (m,) [N] are the forces of the supports on the shoes. The pressure of a shoe that the
    supports hold off the drum is zero, on all arcs of its lining. `mu_lock` is the friction
    coefficient at which the shoes would lock with the same bearing supports and the same arcs of
    the linings in contact.
    """

    shoes: _GeometryOfShoesOnAnchors
    bearing: BearingFlagsOfOneSidedSupports
    contacts: dict[str, RigidShoeContact]
    forces: Floats
    mu_lock: float


def _collect_shoes_on_anchors(brake: Brake, members: tuple[int, ...]) -> _GeometryOfShoesOnAnchors:
    """Collect the shoes of a brake with the indices `members`, with their one-sided supports."""
    shoes = [brake.shoes[i] for i in members]
    freedoms = tuple(shoe.rigid_body_modes_of_support() for shoe in shoes)
    supports = tuple(
        support
        for support in one_sided_supports_of_brake(brake)
        if support.sides[0].shoe in members
    )
    opening = np.zeros((len(supports), 3 * len(members)))
    for j, support in enumerate(supports):
        for side in support.sides:
            k = members.index(side.shoe)
            opening[j, 3 * k : 3 * k + 3] = work_of_support_push_in_rigid_body_modes(
                shoes[k], side.push_of_one_newton
            )
    # If the stiffness of any lining is unknown, all linings are taken as equally stiff.
    stiffness = np.ones(len(shoes))
    linings = [shoe.lining for shoe in shoes]
    if all(lining.material is not None and lining.thickness for lining in linings):
        stiffness = np.array([each.material.E_through / each.thickness for each in linings])
    return _GeometryOfShoesOnAnchors(
        members,
        tuple(friction_surface_of_shoe(brake, shoe) for shoe in shoes),
        freedoms,
        stiffness / stiffness[0],
        supports,
        opening,
        np.tile([1 / brake.size, 1.0, 1.0], len(members)),
    )


class _AnchoredEquilibriumMatrices(NamedTuple):
    """Matrices N and F (k, k) of the equilibria of several shoes, weighted by lining stiffness.

    The weight of a shoe is E/t of its lining divided by E/t of the first lining. F is also
    multiplied by the lining's friction coefficient divided by the brake's friction coefficient.
    """

    normal: Floats
    friction: Floats


def _equilibrium_matrices_of_shoes_on_arcs(
    brake: Brake, on: _GeometryOfShoesOnAnchors, arcs: list[ContactArcsOfRigidShoe]
) -> _AnchoredEquilibriumMatrices:
    """The matrices N and F of shoes whose linings touch drum or plane on the given arcs."""
    found = []
    for k, i in enumerate(on.members):
        width = on.stiffness[k] * brake.shoes[i].lining.width
        normal_work, friction_work = equilibrium_matrices_of_rigid_shoe(
            on.faces[k], on.freedoms[k], width, arcs[k]
        )
        relative = brake.shoe_friction_over_brake_friction(brake.shoes[i])
        found.append((normal_work, relative * friction_work))
    normal, friction = zip(*found, strict=True)
    return _AnchoredEquilibriumMatrices(block_diag(*normal), block_diag(*friction))


def _rigid_body_motions_held_and_free(
    on: _GeometryOfShoesOnAnchors, bearing: BearingFlagsOfOneSidedSupports
) -> HeldAndFreeRigidBodyMotions | None:
    """The motions that the bearing supports prevent, and the motions that they leave free.

    The result is None if one of the supports is redundant. It is None as well if a free motion
    closes no gap, because no pressure then resists this motion.
    """
    motions = divide_motions_into_held_and_free(on.opening[np.array(bearing, dtype=bool)], on.sizes)
    if motions is None:
        return None
    shapes = [
        face.gap_closing_factors_of_rigid_body_motions(free.motions).T
        for face, free in zip(on.faces, on.freedoms, strict=True)
    ]
    closing = block_diag(*shapes)
    scale = float(np.linalg.norm(closing * on.sizes, axis=0).max())
    return motions if do_linings_resist_free_motions(closing @ motions.free, scale) else None


class _EquilibriumInFreeMotions(NamedTuple):
    """The equilibrium of shoes that can move only in the motions that the supports leave free.

    Attributes
    ----------
    matrices : N and F of the shoes on the arcs in contact
    resisted : (k, k') the motions that the supports leave free and that linings resist
    y : (k,) amounts of the rigid-body modes, times E/t of the first lining
    c : for each shoe the factors (2,) [Pa] of the face's two shape functions in its pressure
    arcs : arcs in contact of each shoe
    """

    matrices: _AnchoredEquilibriumMatrices
    resisted: Floats
    y: Floats
    c: list[Floats]
    arcs: list[ContactArcsOfRigidShoe]


def _equilibrium_in_free_motions(
    brake: Brake,
    on: _GeometryOfShoesOnAnchors,
    free: Floats,
    work: Floats,
    first_arcs: list[ContactArcsOfRigidShoe] | None = None,
) -> _EquilibriumInFreeMotions | None:
    """The equilibrium of shoes that can move only in the motions `free`; None if none is found.

    The function changes the arcs in contact until the pressure is positive on these arcs and
    nowhere else. A shoe whose contact force is round-off keeps its arcs and has no pressure. A shoe
    without an arc in contact is in equilibrium if its supports alone balance its loads.

    Parameters
    ----------
    brake, on : the brake and its shoes
    free : (k, k') amounts of the k rigid-body modes in each motion
    work : (k,) work of the loads on each mode
    first_arcs : arcs in contact from which the search starts; by default those of the linings
    """
    linings = [brake.shoes[i].lining for i in on.members]
    arcs: list[ContactArcsOfRigidShoe] = first_arcs or [lining.arcs for lining in linings]
    before: list[list[ContactArcsOfRigidShoe]] = []
    shapes = [
        face.gap_closing_factors_of_rigid_body_motions(modes.motions)
        for face, modes in zip(on.faces, on.freedoms, strict=True)
    ]
    drag = brake.friction * brake.sign_of_motion
    for _ in range(MOST_ITERATIONS_FOR_CONTACT_ARCS):
        matrices = _equilibrium_matrices_of_shoes_on_arcs(brake, on, arcs)
        K = matrices.normal - drag * matrices.friction
        resisted: Floats | None = free
        if not all(arcs):
            resisted = _motions_that_linings_resist(free, matrices.normal, work)
        if resisted is None:
            break
        try:
            y = resisted @ np.linalg.solve(resisted.T @ K @ resisted, resisted.T @ work)
        except np.linalg.LinAlgError:
            break
        c = [on.stiffness[k] * shape.T @ y[3 * k : 3 * k + 3] for k, shape in enumerate(shapes)]
        is_round_off = [
            _is_contact_force_round_off(brake, on, k, c[k], own) for k, own in enumerate(arcs)
        ]
        after = list(arcs)
        for k, lining in enumerate(linings):
            if not is_round_off[k]:
                after[k] = arcs_of_positive_pressure_on_linings(on.faces[k], c[k], lining.arcs)
        if all(map(are_contact_arcs_equal, after, arcs)):
            # A shoe without an arc in contact, or with round-off as its contact force, has no
            # pressure.
            is_pressed = [bool(own) and not is_round_off[k] for k, own in enumerate(arcs)]
            c = [own * is_pressed[k] for k, own in enumerate(c)]
            return _EquilibriumInFreeMotions(matrices, resisted, y, c, arcs)
        # The search ends if the arcs are those of an earlier iteration, from which the iterations
        # would repeat for ever.
        if any(all(map(are_contact_arcs_equal, after, each)) for each in before):
            break
        before.append(arcs)
        arcs = after
    return None


def _motions_that_linings_resist(free: Floats, normal: Floats, work: Floats) -> Floats | None:
    """The part of the motions `free` that linings resist, where a shoe has no arc in contact.

    The result is None if the loads do work in the motions that no lining resists: the shoes then
    move on.

    Parameters
    ----------
    free : (k, k') amounts of the k rigid-body modes in each motion
    normal : matrix N (k, k) of the shoes on the arcs in contact
    work : (k,) work of the loads on each mode
    """
    values, directions = np.linalg.eigh(free.T @ normal @ free)
    is_resisted = values > LARGEST_SINGULAR_VALUE_OF_REDUNDANT_SUPPORT * values.max(initial=0.0)
    unresisted = free @ directions[:, ~is_resisted]
    scale = float(np.linalg.norm(free * work[:, None]))
    if np.abs(unresisted.T @ work).max(initial=0.0) > LARGEST_ROUND_OFF_CONTACT_FORCE * scale:
        return None
    return np.asarray(free @ directions[:, is_resisted])


def _is_contact_force_round_off(
    brake: Brake,
    on: _GeometryOfShoesOnAnchors,
    k: int,
    c: Floats,
    arcs: ContactArcsOfRigidShoe,
) -> bool:
    """Whether the contact force of shoe `k` on its arcs is round-off of the loads on the shoes.

    `c` (2,) [Pa] are the factors of the face's two shape functions in the pressure of the shoe.
    """
    shoes = [brake.shoes[i] for i in on.members]
    largest = max(shoe.largest_force_of_any_load for shoe in shoes)
    if not arcs:
        return False
    ends = np.array(arcs).ravel()
    peak = float(np.abs(c @ on.faces[k].shape_function_values(ends)[:2]).max(initial=0.0))
    length = brake.length_per_surface_coordinate * sum(end - start for start, end in arcs)
    return peak * shoes[k].lining.width * length <= LARGEST_ROUND_OFF_CONTACT_FORCE * largest


def _solve_rigid_shoes_on_given_supports(
    brake: Brake,
    on: _GeometryOfShoesOnAnchors,
    bearing: BearingFlagsOfOneSidedSupports,
    first_arcs: list[ContactArcsOfRigidShoe] | None = None,
) -> EquilibriumOfShoesOnAnchors | None:
    """The equilibrium of shoes with given bearing supports; None if other supports must bear.

    Other supports must bear in three cases: the shoes have no equilibrium on the given supports or
    lock themselves on them, a given support would have to pull, or a support that is not among the
    given ones would overlap its shoe.
    The function seeks the arcs in contact from `first_arcs` on, by default from those of the
    linings.
    """
    motions = _rigid_body_motions_held_and_free(on, bearing)
    if motions is None:
        return None
    work = np.concatenate(
        [modes.actuation_work + modes.work_of_further_loads for modes in on.freedoms]
    )
    settled = _equilibrium_in_free_motions(brake, on, motions.free, work, first_arcs)
    if settled is None:
        return None
    (normal, friction), free, y = settled.matrices, settled.resisted, settled.y
    mu_lock = smallest_friction_with_singular_equilibrium(
        free.T @ normal @ free, free.T @ friction @ free, brake.sign_of_motion
    )
    forces = np.zeros(len(bearing))
    forces[np.array(bearing, dtype=bool)] = motions.held.T @ (
        (normal - brake.friction * brake.sign_of_motion * friction) @ y - work
    )
    if brake.friction >= mu_lock or not _do_supports_of_rigid_shoes_bear_as_assumed(
        on, bearing, y, forces
    ):
        return None
    contacts = {}
    for k, i in enumerate(on.members):
        amounts = on.stiffness[k] * y[3 * k : 3 * k + 3]
        contacts[brake.shoes[i].name] = RigidShoeContact(
            on.faces[k], settled.c[k], amounts, settled.arcs[k], on.freedoms[k], 1
        )
    return EquilibriumOfShoesOnAnchors(on, bearing, contacts, forces, mu_lock)


def _do_supports_of_rigid_shoes_bear_as_assumed(
    on: _GeometryOfShoesOnAnchors,
    bearing: BearingFlagsOfOneSidedSupports,
    y: Floats,
    forces: Floats,
) -> bool:
    """Whether the supports act as assumed: bearing ones do not pull, open ones do not overlap.

    Parameters
    ----------
    on : the shoes
    bearing : whether each of the m supports bears
    y : (k,) amounts of the shoes' rigid-body modes
    forces : (m,) forces of the supports [N]
    """
    bears = np.array(bearing, dtype=bool)
    actuation = max(
        float(np.abs(free.actuation_work + free.work_of_further_loads).max())
        for free in on.freedoms
    )
    largest = max(float(np.abs(forces).max()), actuation * float(on.sizes[0]))
    largest_displacement = np.abs(y / on.sizes).max()
    pulls = (forces[bears] < -LARGEST_ROUND_OFF_PULL_OF_SUPPORT * largest).any()
    overlaps = (
        (on.opening @ y)[~bears] < -LARGEST_ROUND_OFF_PULL_OF_SUPPORT * largest_displacement
    ).any()
    return not (pulls or overlaps)


def _equilibria_of_shoes_on_anchors(
    brake: Brake, members: tuple[int, ...]
) -> Iterator[EquilibriumOfShoesOnAnchors]:
    """Yield each equilibrium of shoes on anchors, trying one set of bearing supports after another.

    Sets of bearing supports that lead to the same support forces count as one equilibrium.
    """
    on = _collect_shoes_on_anchors(brake, members)
    found: list[Floats] = []
    for bearing in all_choices_of_bearing_supports(len(on.supports)):
        solved = _solve_rigid_shoes_on_given_supports(brake, on, bearing)
        if solved is None:
            continue
        size = max(float(np.abs(solved.forces).max()), math.ulp(1.0))
        if not any(
            np.allclose(solved.forces, each, 0, SAME_SUPPORT_FORCE_TOLERANCE * size)
            for each in found
        ):
            found.append(solved.forces)
            yield solved


def _first_equilibrium_of_shoes_on_anchors(
    brake: Brake, members: tuple[int, ...]
) -> EquilibriumOfShoesOnAnchors:
    """The first equilibrium of shoes on anchors. Raises NoAnswer if there is none."""
    first = next(_equilibria_of_shoes_on_anchors(brake, members), None)
    if first is not None:
        return first
    names = brake.text_with_names_of_shoes_at_indices(members)
    limit = _locking_friction_of_anchored_shoe_group(brake, members)
    if brake.friction >= limit:
        raise NoAnswer(
            f"{names}: self-locking, friction {brake.friction:g} is not below mu_lock = "
            f"{limit:.6g} of the rigid-shoe law"
        )
    raise NoAnswer(f"{names}: {ERROR_TEXT_ON_SHOE_THAT_IS_NOT_HELD}")


def _locking_friction_of_anchored_shoe_group(brake: Brake, members: tuple[int, ...]) -> float:
    """The friction coefficient at which shoes on anchors lock; inf if they never do.

    The function follows the equilibrium from the brake's friction on. If there is no equilibrium at
    this friction, the function halves the friction until there is one.
    """
    friction = brake.friction
    for _ in range(MOST_FRICTION_HALVINGS):
        found = next(
            _equilibria_of_shoes_on_anchors(
                brake.brake_with_new_friction_coefficient(friction), members
            ),
            None,
        )
        if found is not None:
            return _locking_friction_beyond_equilibrium(brake, friction, found)
        friction /= 2
    return math.inf


def _locking_friction_beyond_equilibrium(
    brake: Brake, friction: float, found: EquilibriumOfShoesOnAnchors
) -> float:
    """The friction coefficient above `friction` at which shoes lock; inf if they never do.

    The shoes lock where the pressures of the equilibrium `found` grow without bound. They also lock
    where another support begins to bear and allows no equilibrium: the drum then wedges the shoes
    between their supports. They do not lock where a bearing support would have to pull.
    """
    tried = set()
    while found.bearing not in tried:
        tried.add(found.bearing)
        friction, found = _largest_friction_on_same_supports(brake, friction, found)
        if friction >= LARGEST_FOLLOWED_FRICTION:
            return math.inf
        beyond = brake.brake_with_new_friction_coefficient(
            friction * (1 + 2 * FRICTION_LIMIT_RESOLUTION)
        )
        after = next(_equilibria_of_shoes_on_anchors(beyond, found.shoes.members), None)
        if after is None:
            break
        friction, found = beyond.friction, after
    bearing_forces = found.forces[np.array(found.bearing, dtype=bool)]
    if bearing_forces.min(initial=math.inf) < VANISHING_FORCE * np.abs(found.forces).max(initial=0):
        return math.inf
    return found.mu_lock if found.mu_lock < (1 + NEAR_POLE) * friction else friction


def _largest_friction_on_same_supports(
    brake: Brake, friction: float, found: EquilibriumOfShoesOnAnchors
) -> tuple[float, EquilibriumOfShoesOnAnchors]:
    """The largest friction coefficient at which the bearing supports stay, and its equilibrium.

    The search begins at `friction`, with the equilibrium `found`, and ends at
    LARGEST_FOLLOWED_FRICTION.
    """
    step = FOLLOWED_FRICTION_STEP * max(friction, FOLLOWED_FRICTION_STEP)
    while (
        friction < LARGEST_FOLLOWED_FRICTION and step > 0.5 * FRICTION_LIMIT_RESOLUTION * friction
    ):
        raised = brake.brake_with_new_friction_coefficient(friction + step)
        arcs = [found.contacts[raised.shoes[i].name].arcs for i in found.shoes.members]
        after = _solve_rigid_shoes_on_given_supports(raised, found.shoes, found.bearing, arcs)
        if after is None:
            step /= 2
        else:
            friction, found = raised.friction, after
    return friction, found


def _indices_of_shoes_solved_with_shoe(brake: Brake, index: int) -> tuple[int, ...]:
    """The indices of all shoes whose equilibria are solved together with those of shoe `index`."""
    return next(group for group in groups_of_shoes_on_anchors(brake) if index in group)


def contact_of_shoe_on_anchors(brake: Brake, index: int) -> RigidShoeContact | None:
    """The contact of shoe `index`, which is on anchors; None if supports hold it off the drum.

    Raises NoAnswer if the shoe locks itself, if no set of its supports holds it, or if no shoe that
    is solved with it presses on the drum.
    """
    found = _first_equilibrium_of_shoes_on_anchors(
        brake, _indices_of_shoes_solved_with_shoe(brake, index)
    )
    return _contacts_of_pressed_shoes(brake, found).get(brake.shoes[index].name)


def _contacts_of_pressed_shoes(
    brake: Brake, found: EquilibriumOfShoesOnAnchors
) -> dict[str, RigidShoeContact]:
    """The contact of each shoe with a contact force, by its name.

    Raises NoAnswer if no shoe has a contact force.
    """
    pressed = {name: contact for name, contact in found.contacts.items() if contact.c.any()}
    if not pressed:
        raise NoAnswer(error_text_on_shoes_without_contact_force(brake, found.shoes.members))
    return pressed


def locking_frictions_of_shoes_on_anchors(brake: Brake) -> dict[int, float]:
    """The friction coefficient at which each shoe on anchors locks, by the shoe's index.

    It is inf for a shoe that never locks. The friction coefficients of all linings are scaled in
    proportion until the shoe locks. The result is the coefficient of this shoe's lining. Shoes with
    a strut between them lock together.
    """
    found = {}
    for members in groups_of_shoes_on_anchors(brake):
        limit = _locking_friction_of_anchored_shoe_group(brake, members)
        for i in members:
            found[i] = limit * brake.shoe_friction_over_brake_friction(brake.shoes[i])
    return found


def which_supports_of_rigid_shoes_bear(
    brake: Brake, members: tuple[int, ...]
) -> BearingFlagsOfOneSidedSupports:
    """Whether each one-sided support of the shoes `members` bears, by the rigid-shoe law.

    The order is that of `one_sided_supports_of_brake`. The result is () if the shoes have no
    equilibrium. `members` are the indices of the shoes in the brake.
    """
    bears: dict[str, bool] = {}
    for group in groups_of_shoes_on_anchors(brake):
        if group[0] not in members:
            continue
        found = next(_equilibria_of_shoes_on_anchors(brake, group), None)
        if found is None:
            return ()
        names = [support.name for support in found.shoes.supports]
        bears |= dict(zip(names, found.bearing, strict=True))
    order = [support.name for support in one_sided_supports_of_brake(brake)]
    return tuple(bears[name] for name in order if name in bears)


class SolutionOfAllShoesOnAnchors(NamedTuple):
    """The answer of the rigid-shoe law for all shoes on anchors of a brake.

    Attributes
    ----------
    contacts : contact of each shoe that presses on the drum, by its name
    supports : forces of the one-sided supports on each shoe, by its name
    warnings : a line of text for each group of shoes with more than one equilibrium; it names the
        supports that bear in each of these equilibria
    """

    contacts: dict[str, RigidShoeContact]
    supports: dict[str, tuple[OneSidedSupportForce, ...]]
    warnings: tuple[str, ...]


def solve_shoes_on_anchors(brake: Brake) -> SolutionOfAllShoesOnAnchors:
    """Solve all shoes on anchors of a brake by the rigid-shoe law.

    Raises NoAnswer for shoes that lock themselves, that no set of their supports holds, or all of
    which their supports hold off the drum.
    """
    contacts: dict[str, RigidShoeContact] = {}
    supports: dict[str, tuple[OneSidedSupportForce, ...]] = {}
    warnings = []
    for members in groups_of_shoes_on_anchors(brake):
        found = list(_equilibria_of_shoes_on_anchors(brake, members)) or [
            _first_equilibrium_of_shoes_on_anchors(brake, members)
        ]
        first = found[0]
        contacts |= _contacts_of_pressed_shoes(brake, first)
        for i in members:
            supports[brake.shoes[i].name] = forces_of_one_sided_supports_on_shoe(
                first.shoes.supports, first.forces, i
            )
        if len(found) > 1:
            choices = "; ".join(
                text_with_names_of_bearing_supports(each.shoes.supports, each.bearing)
                for each in found
            )
            warnings.append(
                f"warning: {brake.text_with_names_of_shoes_at_indices(members)}: more than one "
                "equilibrium by the rigid-shoe "
                f"law, on the supports {choices}; the law takes the first"
            )
    return SolutionOfAllShoesOnAnchors(contacts, supports, tuple(warnings))
