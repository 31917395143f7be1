"""Contact forces at the nodes of lining faces, with Coulomb friction at full slip.

Each node of a face is either open or carries a contact force. The set of nodes that carry forces is
changed until no contact force is tensile and no open node penetrates the drum.
"""

import math
from collections.abc import Sequence
from itertools import pairwise, product
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Bools, Floats, Ints
from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.one_sided import (
    ERROR_TEXT_ON_SHOE_THAT_IS_NOT_HELD,
    OneSidedSupportForce,
    all_choices_of_bearing_supports,
    forces_of_one_sided_supports_on_shoe,
)
from drumlin.brake.support import SupportRigidBodyModes, displacements_in_rigid_body_motions
from drumlin.verification.triangles.equations import ContactEquations
from drumlin.verification.triangles.face import ShoeCondensedToLiningFace
from drumlin.verification.triangles.one_sided import (
    ShoeAndItsPlacesInContactEquations,
    contact_equations_on_supports_that_bear,
    do_supports_bear_as_assumed_in_triangle_solution,
    equations_of_one_sided_support_openings,
    one_sided_supports_of_shoes,
)

MOST_CONTACT_SETS_TRIED = 600
"""Largest number of contact sets that are tried before the solver raises NoAnswer.

A contact set is the set of nodes that carry contact forces."""
CONTACT_SETS_BEFORE_SINGLE_NODE_CHANGES = 8
"""Number of contact sets without progress after which only one node at a time is changed.

A node is wrong if it carries a tensile force or penetrates the drum. A set without progress has no
fewer wrong nodes than an earlier set. If all wrong nodes are changed at once, the method is faster,
but may repeat the same sets for ever (Judice & Pires 1994).
"""
LARGEST_CONTACT_SET_ERROR_OVER_NORMAL_FORCE = 1e-13
"""Largest error of a contact set that is accepted, relative to the normal force.

The error is the sum of the tensile forces and of the penetrations, scaled to forces. Errors below
this limit come from round-off."""
CONTACT_SETS_BEFORE_LARGER_ERROR_IS_ACCEPTED = 40
"""Number of contact sets that are tried before a larger error of the contact set is accepted.

The limit of the error is then LARGEST_CONTACT_SET_ERROR_AFTER_MANY_SETS and no longer
LARGEST_CONTACT_SET_ERROR_OVER_NORMAL_FORCE.
"""
LARGEST_CONTACT_SET_ERROR_AFTER_MANY_SETS = 1e-9
"""Largest relative error of a contact set that is accepted if round-off keeps changing the set.

The error is the sum of tensile forces and penetrations, relative to the normal force."""


class RingCondensedToLiningNodes(NamedTuple):
    """An elastic drum ring, statically condensed to its m nodes under the linings.

    Attributes
    ----------
    compliance : (2m, 2m) displacements of the m nodes under unit forces on the m nodes [m/N]
    ring_nodes_of_faces : for the lining face of each shoe, the positions (n,) among the m nodes of
        the ring nodes opposite to the n nodes of the face
    """

    compliance: Floats
    ring_nodes_of_faces: list[Ints]


class NodesAndSupportsInContactAtStart(NamedTuple):
    """Nodes and supports in contact when the contact solver starts, from an earlier solution.

    Attributes
    ----------
    nodes : for each shoe, whether each node (n,) of its lining's face is in contact
    supports : names of the one-sided supports that bear; empty if they are not known
    """

    nodes: list[Bools]
    supports: frozenset[str] = frozenset()

    def contact_at_start_of_some_shoes(
        self, members: Sequence[int]
    ) -> "NodesAndSupportsInContactAtStart":
        """The nodes and supports in contact at the start, for the shoes of indices `members`."""
        return NodesAndSupportsInContactAtStart([self.nodes[i] for i in members], self.supports)


class ContactForcesAndRigidMotions(NamedTuple):
    """Nodal contact forces and rigid-body motions of one shoe, or of several shoes together.

    Attributes
    ----------
    force : (n,) nodal contact forces along the normals [N], 0 at open nodes
    motions : (k,) generalised coordinates of the rigid-body modes of the shoes. Until the solution
        is split by shoes, the forces [N] of the bearing supports come after these coordinates.
    active : (n,) whether a node is in contact
    supports : forces of the one-sided supports of one shoe
    """

    force: Floats
    motions: Floats
    active: Bools
    supports: tuple[OneSidedSupportForce, ...] = ()


def solve_contact_complementarity(
    equations: ContactEquations, first: Bools
) -> ContactForcesAndRigidMotions:
    """Solve w = q + A f + B y >= 0, f >= 0, w f = 0, C f + G y = h for f and y.

    See `ContactEquations` for the symbols. At each node the gap w or the force f is zero; the last
    equation is the equilibrium of the shoes. A node in contact is called active. All nodes with
    a tensile force or a penetration change at once between open and active. If their number does
    not fall, only one node changes at a time. `first` (n,) tells whether each node is active at the
    start.

    Raises
    ------
    NoAnswer
        If no set of active nodes satisfies the inequalities, or if a set is singular.
    """
    A, q, B, weight = equations.A, equations.q, equations.B, equations.weight
    active = first.copy()
    scale = float(np.median(np.abs(np.diag(A)) * weight))
    fewest, spare, least = len(q) + 1, CONTACT_SETS_BEFORE_SINGLE_NODE_CHANGES, math.inf
    best: ContactForcesAndRigidMotions | None = None
    for step in range(MOST_CONTACT_SETS_TRIED):
        # The active nodes have zero gap: their forces and the rigid-body motions are solved for.
        a = np.flatnonzero(active)
        if not len(a):
            raise NoAnswer("no node in contact")
        f, y = _forces_and_motions_of_contact_set(equations, a)
        # The gaps are scaled to forces [N], so that they compare with the contact forces.
        w = (q + A @ f + B @ y) * weight / scale
        size_of = float(np.abs(f).sum())
        # A node is wrong if it is active with a tensile force or open with a negative gap.
        off = np.where(active, f, w)
        wrong = np.flatnonzero(off < 0)
        wrongness = -float(off[wrong].sum()) / size_of
        if wrongness < least:
            least, best = wrongness, ContactForcesAndRigidMotions(f, y, active.copy())
        if wrongness < LARGEST_CONTACT_SET_ERROR_OVER_NORMAL_FORCE or (
            step > CONTACT_SETS_BEFORE_LARGER_ERROR_IS_ACCEPTED
            and least < LARGEST_CONTACT_SET_ERROR_AFTER_MANY_SETS
        ):
            assert best is not None
            return best
        # All wrong nodes change while their number falls. If it has not fallen for
        # CONTACT_SETS_BEFORE_SINGLE_NODE_CHANGES sets, only the last wrong node changes.
        if len(wrong) < fewest:
            fewest, spare = len(wrong), CONTACT_SETS_BEFORE_SINGLE_NODE_CHANGES
        else:
            spare -= 1
        chosen = wrong if spare > 0 else wrong[-1:]
        active[chosen] = ~active[chosen]
    raise NoAnswer(f"no contact set settles: wrong by {least:.1e}")


def _forces_and_motions_of_contact_set(
    equations: ContactEquations, a: Ints
) -> tuple[Floats, Floats]:
    """The nodal forces f (n,) and the unknowns y (k,) if exactly the nodes `a` are in contact.

    Raises NoAnswer if the equations are singular.
    """
    A, q, B, C, G, h = equations[:6]
    system = np.block([[A[np.ix_(a, a)], B[a]], [C[:, a], G]])
    # Forces and motions are scaled to units in which the flexibility of a node is about 1. In SI
    # units, round-off in equations with supports is 1e5 times larger.
    nodal = 1 / np.sqrt(np.abs(np.diag(A)))
    typical = float(np.median(nodal))
    unknown = np.where(equations.is_force, typical, 1 / typical)
    size = np.concatenate([nodal[a], unknown])
    try:
        x = size * np.linalg.solve(system * np.outer(size, size), size * np.concatenate([-q[a], h]))
    except np.linalg.LinAlgError as error:
        raise NoAnswer("a contact set is singular") from error
    f = np.zeros(len(q))
    f[a] = x[: len(a)]
    return f, x[len(a) :]


def contact_forces_of_shoes_in_one_system(
    brake: Brake,
    faces: list[ShoeCondensedToLiningFace],
    shoes: list[Shoe],
    rim: RingCondensedToLiningNodes | None,
    first: NodesAndSupportsInContactAtStart,
    senses: tuple[int, ...] | None = None,
) -> list[ContactForcesAndRigidMotions]:
    """The contact forces of shoes that are solved in one system, in the order of the shoes.

    Parameters
    ----------
    brake : the brake, for its friction, sense of rotation and drum
    faces : the shoes, condensed to the faces of their linings
    shoes : the same shoes, for their hinges or abutments and their actuation
    rim : the elastic ring of the drum, or None for a rigid drum
    first : the nodes and the one-sided supports in contact at the start
    senses : sense (+1, 0, -1) of the friction on the foot of each shoe at its abutment. If None,
        all combinations are tried in turn until each abutment pushes the foot of its shoe, and the
        friction there opposes the slide of the foot or holds it

    Raises
    ------
    NoAnswer
        If no contact set solves the equations, if a foot would leave its abutment, if the friction
        at an abutment neither opposes the slide of the foot nor holds the foot, or if no choice of
        bearing supports holds shoes on anchors.
    """
    failure: NoAnswer | None = None
    # Each combination of the senses of friction at the abutments is tried in turn, until the
    # abutments hold all feet as the combination assumes.
    for chosen in (
        product(*(shoe.senses_of_abutment_friction_to_try for shoe in shoes))
        if senses is None
        else [senses]
    ):
        try:
            found = _contact_forces_for_assumed_friction_senses(
                brake, faces, shoes, rim, first, chosen
            )
        except NoAnswer as error:
            failure = failure or error
            continue
        if all(
            _is_abutment_friction_sense_confirmed(brake, *of)
            for of in zip(faces, shoes, found, chosen, strict=True)
        ):
            return found
    raise failure or NoAnswer("a foot leaves its abutment")


def _is_abutment_friction_sense_confirmed(
    brake: Brake,
    one: ShoeCondensedToLiningFace,
    shoe: Shoe,
    found: ContactForcesAndRigidMotions,
    sense: int,
) -> bool:
    """Whether a solution agrees with the sense of friction assumed at a shoe's abutment.

    The abutment must push the foot of the shoe. The friction on the foot must oppose the foot's
    slide or be large enough to hold the foot.
    """
    drum = forces_of_drum_on_lining_nodes(brake, shoe, one, found.force)
    reaction = -drum.sum(axis=0) - shoe.sum_of_forces_of_all_loads
    return shoe.can_abutment_exert_reaction_on_shoe(reaction, sense, float(found.motions[-1]))


class _ContactMatricesOfShoe(NamedTuple):
    """The matrices of one shoe with n nodes and k rigid-body modes in the contact problem.

    Attributes
    ----------
    A, q, B, C, h, weight : the shoe's blocks of the matrices of `ContactEquations`
    normal : (n, 2n) matrix that gives the normal components of the displacements of the nodes
    nodal_forces_per_normal_force : (2n, n) matrix that turns normal forces into nodal forces on the
        lining, with friction
    """

    A: Floats
    q: Floats
    B: Floats
    C: Floats
    h: Floats
    weight: Floats
    normal: Floats
    nodal_forces_per_normal_force: Floats


def friction_forces_per_contact_force(
    brake: Brake, shoe: Shoe, one: ShoeCondensedToLiningFace
) -> Floats:
    """The friction forces (n, n) on the nodes of a face per unit normal force on each node.

    They are positive towards growing theta. Without friction that depends on the pressure, each
    normal force causes friction on its own node only.
    """
    if one.friction is not None:
        return one.friction
    return brake.signed_friction_stress_over_pressure(shoe) * np.eye(len(one.theta))


def forces_of_drum_on_lining_nodes(
    brake: Brake, shoe: Shoe, one: ShoeCondensedToLiningFace, force: Floats
) -> Floats:
    """The forces (n, 2) [N] of the drum on the nodes of a face, from the normal forces (n,) [N]."""
    along = friction_forces_per_contact_force(brake, shoe, one) @ force
    return along[:, None] * one.tangent - force[:, None] * one.normal


def _contact_matrices_of_shoe(
    one: ShoeCondensedToLiningFace, freedoms: SupportRigidBodyModes, drag: Floats
) -> _ContactMatricesOfShoe:
    """The matrices of one shoe in the contact problem, on a rigid drum.

    Parameters
    ----------
    one : the shoe, condensed to the face of its lining
    freedoms : rigid-body modes and test modes of the shoe
    drag : (n, n) friction forces at full slip per unit normal force on each node, positive towards
        growing theta
    """
    m = len(one.theta)
    normal, nodal_forces_per_normal_force = np.zeros((m, 2 * m)), np.zeros((2 * m, m))
    for c in range(2):
        normal[np.arange(m), 2 * np.arange(m) + c] = one.normal[:, c]
        nodal_forces_per_normal_force[c::2] = one.tangent[:, c, None] * drag
        nodal_forces_per_normal_force[2 * np.arange(m) + c, np.arange(m)] -= one.normal[:, c]
    by_motion, tested = (
        displacements_in_rigid_body_motions(motions, one.xy.T).transpose(1, 0, 2).reshape(2 * m, -1)
        for motions in (freedoms.motions, freedoms.test_modes)
    )
    return _ContactMatricesOfShoe(
        A=-normal @ one.compliance @ nodal_forces_per_normal_force,
        q=one.gap - normal @ one.loaded,
        B=-normal @ by_motion,
        C=tested.T @ nodal_forces_per_normal_force,
        h=-freedoms.work_of_all_loads_on_test_modes,
        weight=one.mass.sum(axis=1),
        normal=normal,
        nodal_forces_per_normal_force=nodal_forces_per_normal_force,
    )


def _contact_forces_for_assumed_friction_senses(
    brake: Brake,
    faces: list[ShoeCondensedToLiningFace],
    shoes: list[Shoe],
    rim: RingCondensedToLiningNodes | None,
    first: NodesAndSupportsInContactAtStart,
    senses: tuple[int, ...],
) -> list[ContactForcesAndRigidMotions]:
    """The contact forces of each shoe, for an assumed sense of the friction at each abutment."""
    own = [
        _contact_matrices_of_shoe(
            one,
            shoe.rigid_body_modes_of_support(sense),
            friction_forces_per_contact_force(brake, shoe, one),
        )
        for one, shoe, sense in zip(faces, shoes, senses, strict=True)
    ]
    begin = np.concatenate([[0], np.cumsum([len(face.theta) for face in faces])])
    rows = np.concatenate([[0], np.cumsum([len(one.h) for one in own])])
    n, k = int(begin[-1]), int(rows[-1])
    # Each shoe has its own block of the matrices.
    A, B, C = np.zeros((n, n)), np.zeros((n, k)), np.zeros((k, n))
    for i, one in enumerate(own):
        part, row = slice(begin[i], begin[i + 1]), slice(rows[i], rows[i + 1])
        A[part, part], B[part, row], C[row, part] = one.A, one.B, one.C
    q = np.concatenate([one.q for one in own])
    h = np.concatenate([one.h for one in own])
    weight = np.concatenate([one.weight for one in own])
    # The gaps at one lining also change by the displacements of the ring under every lining.
    if rim is not None:
        # The indices of the x and y displacements of the ring's nodes under each shoe's linings.
        under = [(2 * nodes[:, None] + np.arange(2)).ravel() for nodes in rim.ring_nodes_of_faces]
        for i, j in np.ndindex(len(faces), len(faces)):
            compliance = rim.compliance[np.ix_(under[i], under[j])]
            change = own[i].normal @ compliance @ own[j].nodal_forces_per_normal_force
            A[begin[i] : begin[i + 1], begin[j] : begin[j + 1]] -= change
    places = [
        ShoeAndItsPlacesInContactEquations(
            shoe, face, one.normal, one.nodal_forces_per_normal_force, slice(*nodes), slice(*modes)
        )
        for shoe, face, one, nodes, modes in zip(
            shoes, faces, own, pairwise(begin.tolist()), pairwise(rows.tolist()), strict=True
        )
    ]
    is_force = np.zeros(k, dtype=bool)
    equations = ContactEquations(A, q, B, C, np.zeros((k, k)), h, weight, is_force)
    return _contact_forces_with_bearing_supports_by_trial(brake, places, equations, first)


def _contact_forces_with_bearing_supports_by_trial(
    brake: Brake,
    places: list[ShoeAndItsPlacesInContactEquations],
    equations: ContactEquations,
    start: NodesAndSupportsInContactAtStart,
) -> list[ContactForcesAndRigidMotions]:
    """The contact forces of each shoe; trials find which one-sided supports bear.

    Sets of bearing supports are tried until no support of the set pulls and no other support
    overlaps its shoe. The set of an earlier solution is tried first. Shoes without one-sided
    supports are solved without trials.

    Parameters
    ----------
    brake : the brake
    places : the shoes and the positions of their unknowns in the equations
    equations : the contact equations of the shoes without the forces of one-sided supports
    start : the nodes and the supports in contact at the start

    Raises
    ------
    NoAnswer
        If no set of supports holds the shoes, or if no contact set solves the equations.
    """
    first, shoes = np.concatenate(start.nodes), [place.shoe for place in places]
    supports = one_sided_supports_of_shoes(brake, shoes)
    if not supports:
        return _split_contact_solution_by_shoe(
            places, solve_contact_complementarity(equations, first)
        )
    openings = equations_of_one_sided_support_openings(supports, places, brake)
    failure: NoAnswer | None = None
    earlier = tuple(support.name in start.supports for support in supports)
    for bearing in all_choices_of_bearing_supports(len(supports), earlier if any(earlier) else ()):
        on_supports = contact_equations_on_supports_that_bear(equations, openings, bearing)
        if on_supports is None:
            continue
        try:
            found = solve_contact_complementarity(on_supports, first)
        except NoAnswer as error:
            failure = failure or error
            continue
        y, s = found.motions[: len(equations.h)], np.zeros(len(supports))
        s[np.array(bearing)] = found.motions[len(equations.h) :]
        if do_supports_bear_as_assumed_in_triangle_solution(openings, bearing, found.force, s, y):
            return [
                one._replace(supports=forces_of_one_sided_supports_on_shoe(supports, s, i))
                for i, one in enumerate(_split_contact_solution_by_shoe(places, found))
            ]
    names = ", ".join(repr(shoe.name) for shoe in shoes)
    raise failure or NoAnswer(f"{names}: {ERROR_TEXT_ON_SHOE_THAT_IS_NOT_HELD}")


def _split_contact_solution_by_shoe(
    places: list[ShoeAndItsPlacesInContactEquations], found: ContactForcesAndRigidMotions
) -> list[ContactForcesAndRigidMotions]:
    """Split a solution into the parts of the shoes, without the forces of one-sided supports."""
    return [
        ContactForcesAndRigidMotions(
            found.force[place.nodes], found.motions[place.modes], found.active[place.nodes]
        )
        for place in places
    ]


def loaded_point_displacement_along_force(
    brake: Brake,
    one: ShoeCondensedToLiningFace,
    shoe: Shoe,
    found: ContactForcesAndRigidMotions,
    sense: int,
) -> float:
    """Displacement [m] of the point where the actuation force F > 0 acts, along this force.

    It is the work of F divided by F, and has a part due to elastic deformation and a part due to
    rigid-body motion.
    """
    drum = forces_of_drum_on_lining_nodes(brake, shoe, one, found.force)
    elastic = float(one.loaded @ drum.ravel()) + one.elastic_actuation_work
    return elastic / shoe.actuation.force + float(
        shoe.rigid_body_modes_of_support(sense).actuation_point_travel @ found.motions
    )
