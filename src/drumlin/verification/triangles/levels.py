"""Solve a brake on a sequence of finer and finer meshes of curved triangles."""

import math
from collections.abc import Sequence
from contextlib import suppress

import numpy as np

from drumlin.base.arrays import Bools, Floats
from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake import clearance
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.further_loads import (
    reason_if_loads_besides_actuation_act,
    require_springs_with_constant_pull,
)
from drumlin.brake.one_sided import groups_of_shoes_on_anchors
from drumlin.brake.ring_support import reason_if_ring_edge_is_not_fixed_or_free
from drumlin.verification.triangles.contact import (
    ContactForcesAndRigidMotions,
    NodesAndSupportsInContactAtStart,
    contact_forces_of_shoes_in_one_system,
)
from drumlin.verification.triangles.face import (
    BodyMeshedByTriangles,
    ShoeCondensedToLiningFace,
    condense_shoe_to_lining_face,
    triangle_body_with_nodes_and_stiffness,
)
from drumlin.verification.triangles.outline import (
    DegreeAndGradingOfTriangleMesh,
    OutlineOfLayeredBody,
    PlacesOfNonSmoothPressure,
    ShoeMeshOfTriangleCorners,
    make_graded_shoe_mesh,
    make_shoe_outline,
)
from drumlin.verification.triangles.pressure_friction import solve_until_friction_fits_pressures
from drumlin.verification.triangles.ring import (
    condense_ring_to_lining_nodes,
    mesh_drum_ring_and_refine_shoe_meshes_to_match,
)
from drumlin.verification.triangles.shared import solve_shoes_with_cam_or_strut_forces
from drumlin.verification.triangles.solution import ShoeSolution, shoe_solution_from_contact_forces

MOST_HALVINGS_OF_TRIANGLES_AT_CONTACT_ENDS = 13
"""Largest number of times that triangles are halved towards an end of the contact.

The pressure p is small at an end of the contact, so that smaller triangles change nothing. The
number is also the limit at a kink of the gap that does not point to the drum."""
DISTANCE_OVER_LINING_LENGTH_COUNTED_AS_LINING_END = 1e-9
"""Distance from an end of the lining, relative to the lining's length, within which a kink or an
end of the contact counts as lying at the end of the lining."""
CONTACT_LENGTH_OF_SMALLEST_END_TRIANGLES = 1e-4
"""Length of a contact below which the triangles at its ends become no smaller.

The length is relative to `OutlineOfLayeredBody.triangle_length_before_first_halving`. In an even
shorter contact the triangles are as small as in a contact of this length.
"""

COARSE_MESH_LEVEL_TO_FIND_CONTACT_ENDS = DegreeAndGradingOfTriangleMesh(3, 8, 1.4, 1.0)
"""Degree and grading of the coarse meshes on which the ends of the contact are found.

The arguments of DegreeAndGradingOfTriangleMesh are degree, halvings, longest_over_corner_distance
and size.
"""
MOST_COARSE_SOLVES_TO_FIND_CONTACT_ENDS = 6
"""Largest number of times that the brake is solved on coarse meshes to find the contact's ends.

Each of these meshes is graded to the ends of the contact in the solution before."""
FRACTIONS_OF_FRICTION_SOLVED_FIRST = (0.0, 0.5)
"""Fractions of the coefficient of friction for which the brake is solved first.

With much friction a brake may have several solutions. The right one is the solution that the brake
reaches as the friction grows from zero.
"""
LARGEST_RELATIVE_MOVEMENT_OF_FOUND_CONTACT_ENDS = 2e-3
"""Movement of the ends of a contact between two solutions, relative to the contact's length, below
which the ends count as found."""
TRIANGLE_MESH_LEVELS_FROM_COARSE_TO_FINE = (
    DegreeAndGradingOfTriangleMesh(3, 10, 1.2, 1.0),
    DegreeAndGradingOfTriangleMesh(4, 13, 0.7, 0.8),
    DegreeAndGradingOfTriangleMesh(5, 15, 0.7, 0.8),
)
"""Degree and grading of the meshes of `solve_brake_on_sequence_of_triangle_meshes`, from coarse to
fine."""


def indices_of_shoes_pressed_on_drum(brake: Brake) -> list[int]:
    """Numbers of the shoes that the actuation presses on the drum.

    A shoe on a hinge is pressed on the drum if the moment of its actuation closes the gap at some
    angle. Shoes on other supports, and all shoes of a brake with a cam or struts, always count as
    pressed.
    """
    found = []
    for i, shoe in enumerate(brake.shoes):
        if shoe.kind_of_support != "hinge" or brake.reason_why_cam_or_strut_sets_forces:
            found.append(i)
            continue
        theta = np.linspace(shoe.lining.start, shoe.lining.end, 41)
        e = np.stack([np.cos(theta), np.sin(theta)], axis=1)
        arm = brake.size * e - shoe.pin.xy
        closing = shoe.sign_internal_plus_external_minus * (
            -arm[:, 1] * e[:, 0] + arm[:, 0] * e[:, 1]
        )
        if (closing * shoe.moment_of_all_loads_about_point(shoe.pin) > 0).any():
            found.append(i)
    return found


def _shortest_wavelength_of_drum_out_of_roundness(brake: Brake) -> float:
    """Shortest wavelength [m] of the drum's out-of-roundness; its circumference if it is round."""
    highest = max(
        (part.order for part in brake.out_of_round_harmonics if part.amplitude), default=0
    )
    return 2 * math.pi * brake.size / max(highest, 1)


def solve_brake_on_one_triangle_mesh(
    brake: Brake,
    level: DegreeAndGradingOfTriangleMesh,
    before: Sequence[ShoeSolution] | None = None,
) -> list[ShoeSolution]:
    """Solve a brake on triangles of one degree and grading; returns the solution of each shoe.

    Parameters
    ----------
    brake : the brake
    level : degree and grading of the triangles
    before : an earlier solution of each shoe, to the ends of whose contact the triangles are
        graded; if None, the solver starts with the whole lining in contact

    Raises
    ------
    BadInput
        If triangles cannot mesh the brake, or if the drum's ring is neither fixed nor free at its
        rim.
    NoAnswer
        If a shoe does not touch the drum, if no contact set solves the equations, or if friction
        that depends on the pressure does not settle.
    """
    refusal = reason_if_ring_edge_is_not_fixed_or_free(brake, "the verification by triangles")
    shared = _are_actuation_forces_set_by_cam_or_strut(brake)
    if refusal is None and shared:
        refusal = reason_if_loads_besides_actuation_act(brake, "a cam or strut on triangles")
    if refusal is not None:
        raise BadInput(refusal)
    require_springs_with_constant_pull(brake, "the verification by triangles")
    shoes = list(brake.shoes)
    if len(indices_of_shoes_pressed_on_drum(brake)) < len(shoes):
        raise NoAnswer("a shoe that is not turned towards the drum")
    earlier = [None] * len(shoes) if before is None else list(before)
    drafts = [
        _mesh_shoe_graded_to_corners_and_contact_ends(brake, shoe, its, level)
        for shoe, its in zip(shoes, earlier, strict=True)
    ]
    meshes, ring = [one.mesh for one in drafts], None
    if brake.ring is not None:
        meshes, ring = mesh_drum_ring_and_refine_shoe_meshes_to_match(brake, drafts, level)
    # Shoes whose forces come from a cam or a strut are condensed under a force of 1 N, which is
    # scaled later.
    faces = [
        condense_shoe_to_lining_face(
            brake,
            shoe.shoe_with_changed_actuation_force(1.0) if shared else shoe,
            triangle_body_with_nodes_and_stiffness(one.shape, mesh, level.degree),
        )
        for shoe, one, mesh in zip(shoes, drafts, meshes, strict=True)
    ]
    nodes = [
        _mask_of_nodes_in_contact_at_start(one, its)
        for one, its in zip(faces, earlier, strict=True)
    ]
    bore = {force.name for its in before or () for force in its.supports if force.push.force > 0}
    first = NodesAndSupportsInContactAtStart(nodes, frozenset(bore))
    shoes, faces, found = solve_until_friction_fits_pressures(
        brake,
        faces,
        first,
        lambda own, start: _loaded_shoes_and_their_contact_forces(brake, own, ring, start),
    )
    return [
        shoe_solution_from_contact_forces(brake, shoe, one, its)
        for shoe, one, its in zip(shoes, faces, found, strict=True)
    ]


def _mesh_shoe_graded_to_corners_and_contact_ends(
    brake: Brake, shoe: Shoe, before: ShoeSolution | None, level: DegreeAndGradingOfTriangleMesh
) -> ShoeMeshOfTriangleCorners:
    """The mesh of a shoe, graded to its corners and to the ends of its contact.

    Parameters
    ----------
    brake : the brake
    shoe : the shoe
    before : an earlier solution of the shoe, which gives the ends of its contact, or None
    level : degree and grading of the triangles
    """
    shape = make_shoe_outline(shoe, brake.size)
    sharp = _places_where_pressure_is_not_smooth(shoe, shape, before, level)
    return make_graded_shoe_mesh(
        shape, sharp, level, _shortest_wavelength_of_drum_out_of_roundness(brake)
    )


def _loaded_shoes_and_their_contact_forces(
    brake: Brake,
    faces: list[ShoeCondensedToLiningFace],
    ring: BodyMeshedByTriangles | None,
    first: NodesAndSupportsInContactAtStart,
) -> tuple[list[Shoe], list[ContactForcesAndRigidMotions]]:
    """The shoes of a brake under their actuation forces, and the contact forces of each.

    Parameters
    ----------
    brake : the brake
    faces : the shoes, condensed to the faces of their linings
    ring : the meshed ring of the drum, or None for a rigid drum
    first : the nodes and the one-sided supports in contact at the start
    """
    shoes = list(brake.shoes)
    if _are_actuation_forces_set_by_cam_or_strut(brake):
        if ring is not None:
            raise BadInput(f"{brake.reason_why_cam_or_strut_sets_forces}, on an elastic ring")
        return solve_shoes_with_cam_or_strut_forces(brake, faces, first)
    if ring is not None:
        rim = condense_ring_to_lining_nodes(brake, ring, faces)
        return shoes, contact_forces_of_shoes_in_one_system(brake, faces, shoes, rim, first)
    # On a rigid drum each shoe is solved by itself, except that shoes on anchors with a strut
    # between them are solved together.
    found: dict[int, ContactForcesAndRigidMotions] = {}
    on_anchors = groups_of_shoes_on_anchors(brake)
    alone = [(i,) for i, shoe in enumerate(shoes) if not shoe.anchors]
    for members in [*on_anchors, *alone]:
        its = contact_forces_of_shoes_in_one_system(
            brake,
            [faces[i] for i in members],
            [shoes[i] for i in members],
            None,
            first.contact_at_start_of_some_shoes(members),
        )
        found |= dict(zip(members, its, strict=True))
    return shoes, [found[i] for i in range(len(shoes))]


def _are_actuation_forces_set_by_cam_or_strut(brake: Brake) -> bool:
    """Whether a cam or a strut gives the shoes their actuation forces.

    A strut between shoes on anchors does not count: it is a one-sided support of both shoes.
    """
    return brake.reason_why_cam_or_strut_sets_forces is not None and not any(
        shoe.anchors for shoe in brake.shoes
    )


def _places_where_pressure_is_not_smooth(
    shoe: Shoe,
    shape: OutlineOfLayeredBody,
    before: ShoeSolution | None,
    level: DegreeAndGradingOfTriangleMesh,
) -> PlacesOfNonSmoothPressure:
    """Places on a lining's face where the pressure is not smooth, and lengths of triangles there.

    These places are the kinks of the gap and the ends of the contact inside the lining. Shorter
    contacts get shorter triangles at their ends.
    """
    lining, tips = (
        shoe.lining,
        {angle for angle, _ in clearance.gap_kinks_that_point_to_drum(shoe.lining)},
    )
    most = min(MOST_HALVINGS_OF_TRIANGLES_AT_CONTACT_ENDS, level.halvings)
    # At a kink of the gap that points to the drum the pressure grows without bound. Therefore the
    # triangles there are smaller than at other kinks.
    beyond = 0.5 ** (level.halvings - most)
    places = [
        (angle, shape.triangle_length_before_first_halving * (beyond if angle in tips else 1.0))
        for angle in clearance.coordinates_of_gap_kinks(lining)
    ]
    for arc in [] if before is None else before.arcs:
        width = max(
            (arc[1] - arc[0]) * shape.length,
            CONTACT_LENGTH_OF_SMALLEST_END_TRIANGLES * shape.triangle_length_before_first_halving,
        )
        places += [
            (float(end), min(shape.triangle_length_before_first_halving, width / 4)) for end in arc
        ]
    slack = DISTANCE_OVER_LINING_LENGTH_COUNTED_AS_LINING_END * (lining.end - lining.start)
    inside = [
        one
        for one in places
        if any(start + slack < one[0] < end - slack for start, end in lining.arcs)
    ]
    angle, length = np.reshape(inside, (-1, 2)).T
    return PlacesOfNonSmoothPressure((angle - shape.origin) * shape.turn, length * 0.5**most)


def _mask_of_nodes_in_contact_at_start(
    one: ShoeCondensedToLiningFace, before: ShoeSolution | None
) -> Bools:
    """Mark the nodes (n,) of a lining's face that are in contact when the contact solver starts.

    These are the nodes in contact in the earlier solution `before`, or all nodes if it is None.
    """
    if before is None:
        return np.ones(len(one.theta), dtype=bool)
    inside = [
        (one.theta > a - DISTANCE_OVER_LINING_LENGTH_COUNTED_AS_LINING_END)
        & (one.theta < b + DISTANCE_OVER_LINING_LENGTH_COUNTED_AS_LINING_END)
        for a, b in before.arcs
    ]
    return np.any(inside, axis=0)


def solve_brake_on_sequence_of_triangle_meshes(
    brake: Brake,
    levels: Sequence[DegreeAndGradingOfTriangleMesh] = TRIANGLE_MESH_LEVELS_FROM_COARSE_TO_FINE,
) -> list[list[ShoeSolution]]:
    """Solve a brake on a sequence of meshes; returns for each mesh the solutions of all shoes.

    Every mesh is graded to the ends of the contact in the solution on the mesh before. Coarse
    meshes of COARSE_MESH_LEVEL_TO_FIND_CONTACT_ENDS are solved first, until the ends of the contact
    settle. The first of these solutions have the fractions FRACTIONS_OF_FRICTION_SOLVED_FIRST of
    the coefficient of friction: with much friction a brake may have several solutions, and the
    right one is reached as friction grows from zero.

    Raises BadInput if triangles cannot mesh the brake, and NoAnswer if the brake has no solution.
    """
    before = None
    # If the solution at lower friction fails, the solver only starts from a worse contact set.
    for part in FRACTIONS_OF_FRICTION_SOLVED_FIRST:
        with suppress(NoAnswer):
            before = solve_brake_on_one_triangle_mesh(
                brake.brake_with_new_friction_coefficient(part * brake.friction),
                COARSE_MESH_LEVEL_TO_FIND_CONTACT_ENDS,
                before,
            )
    # The coarse mesh is graded again until the ends of the contact stay in their places.
    for _ in range(MOST_COARSE_SOLVES_TO_FIND_CONTACT_ENDS):
        after = solve_brake_on_one_triangle_mesh(
            brake, COARSE_MESH_LEVEL_TO_FIND_CONTACT_ENDS, before
        )
        same = before is not None and all(
            _have_same_contact_arcs(a.arcs, b.arcs) for a, b in zip(before, after, strict=True)
        )
        before = after
        if same:
            break
    found: list[list[ShoeSolution]] = []
    for level in levels:
        found.append(solve_brake_on_one_triangle_mesh(brake, level, found[-1] if found else before))
    return found


def _have_same_contact_arcs(a: Floats, b: Floats) -> bool:
    """Whether the ends of the contact arcs (k, 2) [rad] of two solutions agree.

    They may differ by LARGEST_RELATIVE_MOVEMENT_OF_FOUND_CONTACT_ENDS.
    """
    return a.shape == b.shape and bool(
        (
            np.abs(a - b).max(axis=1)
            < LARGEST_RELATIVE_MOVEMENT_OF_FOUND_CONTACT_ENDS * np.diff(b, axis=1)[:, 0]
        ).all()
    )
