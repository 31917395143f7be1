"""The elastic ring of a drum: its mesh of triangles, and its compliance under the linings.

On the friction surface each node of a lining has a node of the ring opposite to it.
"""

import math
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.base.errors import BadInput
from drumlin.brake.brake import Brake
from drumlin.brake.components import RectangularCrossSection
from drumlin.brake.elasticity import ElasticLayer
from drumlin.verification.triangles import lagrange
from drumlin.verification.triangles.contact import RingCondensedToLiningNodes
from drumlin.verification.triangles.face import (
    BodyMeshedByTriangles,
    ShoeCondensedToLiningFace,
    gauss_points_lengths_and_shape_functions_on_curved_edges,
    node_numbers_along_edges,
    triangle_body_with_nodes_and_stiffness,
)
from drumlin.verification.triangles.outline import (
    DegreeAndGradingOfTriangleMesh,
    OutlineOfLayeredBody,
    ShoeMeshOfTriangleCorners,
)
from drumlin.verification.triangles.triangulation import (
    LayerOfTriangulatedBody,
    TriangleMeshInBodyCoordinates,
    coordinates_with_position_dependent_spacing,
    grade_mesh_towards_points,
    halve_surface_edges_until_no_break_lies_inside,
    triangulate_grid_of_layered_body,
)

LARGEST_DIFFERENCE_OF_EQUAL_ANGLES = 1e-12
"""Difference [rad] up to which two angles count as equal. Round-off is some 1e-15."""
MOST_ROUNDS_TO_MATCH_RING_AND_LINING_EDGES = 20
"""Largest number of rounds in which edges on ring and linings are halved to make them match."""
FULL_CIRCLE_IN_RADIANS = 2 * math.pi
"""The angle of a full circle [rad]."""


class _PlaceOfLiningFaceOnRing(NamedTuple):
    """The position of the face of a shoe's lining on the ring.

    Attributes
    ----------
    origin, turn : a place s of the face lies at theta = origin + turn s [rad]; turn is 1 or -1
    whole_turns : multiple of a full turn [rad] that is subtracted from theta, so that all linings
        lie within one turn of the ring
    """

    origin: float
    turn: int
    whole_turns: float

    def ring_angles_at_face_coordinates(self, s: Floats) -> Floats:
        """Angles on the ring [rad] of the places s on the face."""
        return self.origin + self.turn * s - self.whole_turns

    def face_coordinates_at_ring_angles(self, theta: Floats) -> Floats:
        """Places s on the face, growing, at angles theta on the ring [rad]."""
        return np.sort((theta + self.whole_turns - self.origin) * self.turn)


def mesh_drum_ring_and_refine_shoe_meshes_to_match(
    brake: Brake, drafts: list[ShoeMeshOfTriangleCorners], level: DegreeAndGradingOfTriangleMesh
) -> tuple[list[TriangleMeshInBodyCoordinates], BodyMeshedByTriangles]:
    """Mesh the drum ring, and refine the shoes' meshes until their nodes lie opposite ring nodes.

    Returns the refined meshes of the shoes, and the meshed ring. Raises BadInput for a ring without
    a section and for shoes on both sides of the ring.
    """
    section = None if brake.ring is None else brake.ring.section
    if section is None:
        raise BadInput("its ring has no section to mesh")
    if any(
        shoe.sign_internal_plus_external_minus != brake.shoes[0].sign_internal_plus_external_minus
        for shoe in brake.shoes
    ):
        raise BadInput("shoes inside and outside of one ring")
    linings = _positions_of_linings_on_one_turn_of_ring(brake, drafts)
    shape, mesh = _ring_outline_and_mesh_graded_to_linings(brake, section, drafts, linings, level)
    mesh, meshes = _halve_edges_of_ring_and_linings_until_ends_match(
        mesh, [one.mesh for one in drafts], linings
    )
    return meshes, triangle_body_with_nodes_and_stiffness(shape, mesh, level.degree)


def _positions_of_linings_on_one_turn_of_ring(
    brake: Brake, drafts: list[ShoeMeshOfTriangleCorners]
) -> list[_PlaceOfLiningFaceOnRing]:
    """The position of each lining on the ring, with all linings within one turn."""
    first = min(shoe.lining.start for shoe in brake.shoes)
    return [
        _PlaceOfLiningFaceOnRing(
            one.shape.origin,
            one.shape.turn,
            FULL_CIRCLE_IN_RADIANS
            * math.floor(
                (shoe.lining.start - first) / FULL_CIRCLE_IN_RADIANS
                + LARGEST_DIFFERENCE_OF_EQUAL_ANGLES
            ),
        )
        for shoe, one in zip(brake.shoes, drafts, strict=True)
    ]


def _ring_outline_and_mesh_graded_to_linings(
    brake: Brake,
    section: RectangularCrossSection,
    drafts: list[ShoeMeshOfTriangleCorners],
    linings: list[_PlaceOfLiningFaceOnRing],
    level: DegreeAndGradingOfTriangleMesh,
) -> tuple[OutlineOfLayeredBody, TriangleMeshInBodyCoordinates]:
    """The outline of the ring, and its mesh graded to the points where the pressure is not smooth.

    These points are opposite the linings' ends, and opposite the places on the linings' faces where
    the pressure is not smooth.

    Parameters
    ----------
    brake : the brake with the ring
    section : section of the ring
    drafts : meshes of the shoes
    linings : where the lining of each shoe lies on the ring
    level : degree and grading of the triangles
    """
    pairs = list(zip(linings, drafts, strict=True))
    under = [_ring_angles_of_lining_grid_lines(lining, one) for lining, one in pairs]
    least = min(
        *(one.shape.triangle_length_before_first_halving for one in drafts), section.thickness
    )
    s, d = _grid_line_angles_and_depths_of_first_ring_mesh(
        under, section, brake.size, least, level.size
    )
    shape = _ring_outline(brake, section, s[[0, -1]])
    ends = np.concatenate([_ring_angles_of_lining_ends(lining, one) for lining, one in pairs])
    sharp = np.concatenate(
        [lining.ring_angles_at_face_coordinates(one.sharp.s) for lining, one in pairs]
    )
    smallest = np.concatenate(
        [np.full(len(ends), least * 0.5**level.halvings), *(one.sharp.smallest for one in drafts)]
    )
    at = np.concatenate([ends, sharp])
    mesh = grade_mesh_towards_points(
        triangulate_grid_of_layered_body(s, [d], shape.layers, FULL_CIRCLE_IN_RADIANS),
        shape.place,
        shape.place(at, 0 * at),
        smallest,
        level.longest_over_corner_distance,
    )
    return shape, mesh


def _ring_angles_of_lining_ends(
    lining: _PlaceOfLiningFaceOnRing, draft: ShoeMeshOfTriangleCorners
) -> Floats:
    """Angles [rad] on the ring of the ends of a shoe's linings, also of the ends at slots."""
    face = draft.shape.layers[0]
    return lining.ring_angles_at_face_coordinates(
        np.concatenate([[face.start, face.end], np.ravel(face.slots)])
    )


def _ring_angles_of_lining_grid_lines(
    lining: _PlaceOfLiningFaceOnRing, draft: ShoeMeshOfTriangleCorners
) -> Floats:
    """Ascending angles [rad] of a lining's grid lines; the ring's mesh has the same grid lines."""
    face = draft.shape.layers[0]
    within = (draft.s > face.start - LARGEST_DIFFERENCE_OF_EQUAL_ANGLES) & (
        draft.s < face.end + LARGEST_DIFFERENCE_OF_EQUAL_ANGLES
    )
    return np.sort(lining.ring_angles_at_face_coordinates(draft.s[within]))


def _ring_outline(
    brake: Brake, section: RectangularCrossSection, ends: Floats
) -> OutlineOfLayeredBody:
    """The outline of the ring as a body of one layer.

    The layer begins and ends at the angles `ends` (2,) [rad], which are a whole turn apart: the
    ring is closed, and both angles are the same place.
    """
    R, sign = brake.size, brake.shoes[0].sign_internal_plus_external_minus

    def ring_points_at_angles_and_relative_depths(s: Floats, d: Floats) -> Floats:
        """Points (..., 2) [m] of the ring at the angles s and the fractions d of its thickness."""
        r = R + sign * section.thickness * d
        return np.stack([r * np.cos(s), r * np.sin(s)], axis=-1)

    elastic = ElasticLayer.make_layer_in_plane_stress(section.material, section.width)
    return OutlineOfLayeredBody(
        place=ring_points_at_angles_and_relative_depths,
        layers=[LayerOfTriangulatedBody(-math.inf, math.inf, elastic)],
        thickness=np.array([section.thickness]),
        s=ends,
        corners=np.zeros((0, 2)),
        held=None,
        loaded=None,
        origin=0.0,
        turn=1,
        length=R,
    )


def _halve_edges_of_ring_and_linings_until_ends_match(
    mesh: TriangleMeshInBodyCoordinates,
    meshes: list[TriangleMeshInBodyCoordinates],
    linings: list[_PlaceOfLiningFaceOnRing],
) -> tuple[TriangleMeshInBodyCoordinates, list[TriangleMeshInBodyCoordinates]]:
    """Halve edges on the friction surface until edges of ring and linings end at the same angles.

    Halving one edge may halve other edges, too. Therefore ring and linings are refined in turn
    until neither of them changes.

    Parameters
    ----------
    mesh : mesh of the ring
    meshes : meshes of the shoes
    linings : where the lining of each shoe lies on the ring
    """
    for _ in range(MOST_ROUNDS_TO_MATCH_RING_AND_LINING_EDGES):
        before = len(mesh.layer), [len(one.layer) for one in meshes]
        above = [
            lining.ring_angles_at_face_coordinates(
                np.unique(one.end_coordinates_of_friction_surface_edges())
            )
            for lining, one in zip(linings, meshes, strict=True)
        ]
        mesh = halve_surface_edges_until_no_break_lies_inside(
            mesh, np.unique(np.concatenate(above)), LARGEST_DIFFERENCE_OF_EQUAL_ANGLES
        )
        breaks = np.unique(mesh.end_coordinates_of_friction_surface_edges())
        meshes = [
            halve_surface_edges_until_no_break_lies_inside(
                one,
                lining.face_coordinates_at_ring_angles(breaks),
                LARGEST_DIFFERENCE_OF_EQUAL_ANGLES,
            )
            for lining, one in zip(linings, meshes, strict=True)
        ]
        if before == (len(mesh.layer), [len(one.layer) for one in meshes]):
            return mesh, meshes
    raise AssertionError("ring and linings do not match")


def _grid_line_angles_and_depths_of_first_ring_mesh(
    under: list[Floats], section: RectangularCrossSection, R: float, least: float, size: float
) -> tuple[Floats, Floats]:
    """Grid lines of the ring's first mesh: angles [rad] along it, coordinates d in [0, 1] across.

    Parameters
    ----------
    under : for each lining, the angles [rad] of its grid lines
    section : section of the ring
    R : radius of the drum [m]
    least : length [m] of triangles opposite the linings' ends before they are halved
    size : factor on the lengths of all cells
    """
    parts = sorted(under, key=lambda part: float(part[0]))
    t = section.thickness
    lines = []
    for part, after in zip(parts, [*parts[1:], parts[0] + FULL_CIRCLE_IN_RADIANS], strict=True):
        gap = np.array([part[-1], after[0]])

        def angle_step_between_linings(x: float, gap: Floats = gap) -> float:
            """The angle [rad] between two grid lines near the angle x, between two linings."""
            from_lining = float(np.abs(gap - x).min())
            return min(2.5 * t * size / R, least * size / R + 0.5 * from_lining)

        lines += [
            part,
            coordinates_with_position_dependent_spacing(gap, angle_step_between_linings)[1:-1],
        ]
    across = coordinates_with_position_dependent_spacing(
        np.array([0.0, 1.0]), lambda x: min(0.5, least * size / t + min(x, 1 - x))
    )
    return np.concatenate([*lines, [parts[0][0] + FULL_CIRCLE_IN_RADIANS]]), across


def condense_ring_to_lining_nodes(
    brake: Brake, ring: BodyMeshedByTriangles, faces: list[ShoeCondensedToLiningFace]
) -> RingCondensedToLiningNodes:
    """A meshed ring, statically condensed to its nodes opposite the linings' nodes.

    The rim is the face of the ring that looks away from the linings. It is either fixed or free. On
    a free rim, tractions in the shape of the rim's three rigid-body modes balance the contact
    forces. The mean motion of a free rim is zero.
    """
    nodes = ring.nodes
    chosen, of = _ring_nodes_opposite_linings_and_their_positions(brake, ring, faces)
    outer = np.flatnonzero(nodes.at[:, 1] > 1 - LARGEST_DIFFERENCE_OF_EQUAL_ANGLES)
    held = np.zeros((len(nodes.xy), 2), dtype=bool)
    assert brake.ring is not None
    if brake.ring.support == "fixed":
        held[outer] = True
        return RingCondensedToLiningNodes(
            lagrange.condense_body_to_kept_nodes(
                ring.K, nodes, held.ravel(), chosen, np.zeros((held.size, 0))
            ).under_unit_forces,
            of,
        )
    loads = _nodal_forces_of_rigid_mode_tractions_on_rim(ring)
    rigid = _displacements_of_points_by_rigid_motions(nodes.xy).reshape(-1, 3)
    # For the condensation the ring is held at three displacements. Later its mean motion is set to
    # zero.
    right, left = (outer[which(nodes.xy[outer, 0])] for which in (np.argmax, np.argmin))
    held[right] = held[left, 1] = True
    found = lagrange.condense_body_to_kept_nodes(ring.K, nodes, held.ravel(), chosen, loads)
    own = rigid[(2 * chosen[:, None] + np.arange(2)).ravel()]
    # Tractions on the rim balance the contact forces f. They are the columns of `loads` with the
    # factors -l, where l = (rigid^T loads)^-1 own^T f. Then the mean motion of the rim is
    # subtracted from the displacements.
    share = np.linalg.solve(rigid.T @ loads, own.T)
    moved = found.under_unit_forces - found.loaded @ share
    mean = found.loaded.T - found.work @ share
    return RingCondensedToLiningNodes(moved - own @ np.linalg.solve(loads.T @ rigid, mean), of)


def _nodal_forces_of_rigid_mode_tractions_on_rim(ring: BodyMeshedByTriangles) -> Floats:
    """Nodal forces (2N, 3) of tractions on the rim in the shape of its three rigid-body modes."""
    nodes = ring.nodes
    on = ring.mesh.at[..., 1] > 1 - LARGEST_DIFFERENCE_OF_EQUAL_ANGLES
    tri, edge = np.nonzero(on & np.roll(on, -1, axis=1))
    edges = node_numbers_along_edges(nodes, tri, edge, ring.degree)
    psi, x, ds = gauss_points_lengths_and_shape_functions_on_curved_edges(
        nodes.xy[edges], ring.degree
    )
    modes = _displacements_of_points_by_rigid_motions(x)
    spread = np.zeros((len(nodes.xy), 2, 3))
    np.add.at(spread, edges, np.einsum("aq,kqcl,kq->kacl", psi, modes, ds / ds.sum()))
    return spread.reshape(-1, 3)


def _displacements_of_points_by_rigid_motions(xy: Floats) -> Floats:
    """Displacements (..., 2, 3) of points (..., 2) by the three rigid-body modes.

    The modes are a unit displacement along x, one along y, and a unit rotation about the origin.
    """
    x, y = xy[..., 0], xy[..., 1]
    one, zero = np.ones_like(x), np.zeros_like(x)
    return np.stack(
        [np.stack([one, zero, -y], axis=-1), np.stack([zero, one, x], axis=-1)], axis=-2
    )


def _ring_nodes_opposite_linings_and_their_positions(
    brake: Brake, ring: BodyMeshedByTriangles, faces: list[ShoeCondensedToLiningFace]
) -> tuple[Ints, list[Ints]]:
    """The ring's nodes that lie opposite the nodes of the linings' faces.

    Returned are the indices (m,) of these ring nodes and, for the face of each shoe, the positions
    (n,) of its opposite nodes among the m. No node is opposite to a slot between two linings.
    """
    xy = ring.nodes.xy[ring.surface]
    chosen, of, count = [], [], 0
    for shoe, one in zip(brake.shoes, faces, strict=True):
        parts = []
        for start, end in shoe.lining.arcs:
            away = np.angle((xy[:, 0] + 1j * xy[:, 1]) * np.exp(-0.5j * (start + end)))
            below = np.flatnonzero(
                np.abs(away) < 0.5 * (end - start) + LARGEST_DIFFERENCE_OF_EQUAL_ANGLES
            )
            parts.append(below[np.argsort(away[below])])
        under = np.concatenate(parts)
        if len(under) != len(one.theta) or np.abs(xy[under] - one.xy).max() > 1e-9 * brake.size:
            raise AssertionError("ring and lining do not match")
        chosen.append(ring.surface[under])
        of.append(count + np.arange(len(under)))
        count += len(under)
    return np.concatenate(chosen), of
