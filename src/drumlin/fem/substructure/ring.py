"""The elastic drum ring: its mesh, its static condensation, and its coupling with all linings.

The pressures on the linings also act on the ring, whose mesh need not match the meshes of the
shoes. Products of a lining's shape functions psi_i and the ring's shape functions phi_j are
integrated over the overlaps of the edges of both contact lines,

    N_i,jc = b Int psi_i phi_j n_c ds
    T_i,jc = b Int psi_i [phi_j e_c + (r - r_ring) (k x tau)_c d phi_j/ds_ring] ds

with the lining's width b, the lining's arc length ds at the radius r, the drum's unit normal n and
unit tangent e, the unit vector k along the drum's axis, and the ring's unit tangent tau. Both
discrete arcs are only nearly round: the friction acts at the radius r of the lining's arc, but the
ring's own arc lies at r_ring. The second term in the bracket adds the couple of this offset, and is
exact for rigid-body modes. The forces and torques on linings and ring therefore cancel, apart from
round-off.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.base.lapack import solve_lower_triangular_system
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.components import DrumRing, RectangularCrossSection
from drumlin.fem.mesh.degree import nodal_basis_of_mesh
from drumlin.fem.mesh.edges import nodes_along_element_edges
from drumlin.fem.mesh.grading import (
    RELATIVE_SIZE_OF_LINING_END_ELEMENT,
    element_ends_along_lining,
    number_of_element_layers_in_lining,
    number_of_elements_on_each_lining,
    points_graded_to_both_ends,
)
from drumlin.fem.substructure.body import (
    DEGREES_OF_FREEDOM_OF_BODY_FRAME,
    CondensedBody,
    condense_body_to_contact_and_hinge_face,
    multi_point_constraints_of_body,
    rigid_body_displacements_of_nodes,
    sparse_stiffness_of_body,
)
from drumlin.fem.substructure.elasticity import elastic_layers_of_ring
from drumlin.fem.substructure.interface import (
    ContactLine,
    edge_quadrature_points,
    make_contact_line_of_lining,
)
from drumlin.response.resultants import (
    GAUSS,
    WEIGHTS,
    lagrange_shape_function_derivatives,
    lagrange_shape_function_values,
)

MOST_NEWTON_STEPS_TO_RAY_CROSSING = 8
"""Largest number of steps of Newton's iteration for a point on a curved edge.

Each step about squares the error, so that three or four steps reach round-off.
"""
RAY_CROSSING_STEP_TOLERANCE = float(np.sqrt(np.finfo(float).eps))
"""Size of a step of Newton's iteration, in local coordinates from -1 to 1, below which it ends.

The error after a step is about the square of the step, and the square of this value is round-off.
"""
RIM_LOAD_NAME = "rim"
"""Name of the unit loads on a free ring's far edge, which balance the forces of the linings."""


class RingFlexibility(NamedTuple):
    """The flexibility of the drum's ring: weighted gaps (n, n) that it opens at n contact nodes.

    `pressed` are the gaps per nodal pressure, and `dragged` the gaps per nodal friction traction.
    """

    pressed: Floats
    dragged: Floats

    @classmethod
    def flexibility_from_half_flexibilities(
        cls, pressed: Floats, dragged: Floats
    ) -> "RingFlexibility":
        """The flexibility from half flexibilities (m, n) under pressures and under friction."""
        return cls(pressed.T @ pressed, pressed.T @ dragged)


@dataclass(frozen=True)
class RingSubstructure:
    """The elastic drum ring, condensed to its nodes under the linings, in the brake's frame.

    Attributes
    ----------
    mesh, basis : mesh and scalar basis; for a ring of hp elements both are its grid
    line : contact line of the ring
    condensed : the ring, condensed to its contact nodes
    normal_half_flexibilities, friction_half_flexibilities : for each shoe i the half flexibilities
        Y_i and Z_i (m, n_i) of the ring, under the nodal forces N^T of the pressure and -T^T of the
        friction. The pressure p_j of shoe j, with its friction, opens the weighted gap of shoe i
        (the gap times each shape function, integrated over the lining's face) by Y_i^T (Y_j + drag
        Z_j) p_j, where drag is mu_j times the sense of sliding, +1 or -1.
    coupling_matrices : for each shoe i, with n_i contact nodes on its linings, the matrices N and T
        (n_i, 2n)
    held : nodes of the far edge (opposite to the friction surface) that are fixed; empty for a free
        ring
    rim_balance : balance of forces on the far edge of a free ring; None if the far edge is fixed
    """

    mesh: Any
    basis: Any
    line: ContactLine
    condensed: CondensedBody
    normal_half_flexibilities: tuple[Floats, ...]
    friction_half_flexibilities: tuple[Floats, ...]
    coupling_matrices: tuple[tuple[Floats, Floats], ...]
    held: Ints
    rim_balance: "FreeRingForceBalance | None"

    @cached_property
    def flexibility_under_all_linings(self) -> RingFlexibility:
        """The flexibility of the ring under the contact nodes of all shoes, one after the other."""
        return RingFlexibility.flexibility_from_half_flexibilities(
            np.hstack(self.normal_half_flexibilities), np.hstack(self.friction_half_flexibilities)
        )

    def displacements_of_ring_nodes(
        self, pressures: list[Floats], dragging: list[Floats], drags: list[float]
    ) -> Floats:
        """Displacement (2, nodes) [m] of all nodes of the ring under the pressures of the linings.

        Parameters
        ----------
        pressures : for each shoe i, the nodal pressures (n_i,) on all its linings [Pa]
        dragging : for each shoe i, the friction stress (n_i,) at these nodes divided by mu [Pa]; it
            equals the pressure unless mu differs from node to node
        drags : for each shoe, its friction coefficient mu times the sense of sliding, +1 or -1
        """
        nodal = np.zeros(2 * len(self.line.nodes))
        for i, (N, T) in enumerate(self.coupling_matrices):
            nodal += N.T @ pressures[i] - drags[i] * (T.T @ dragging[i])
        frame = np.zeros(DEGREES_OF_FREEDOM_OF_BODY_FRAME)
        if self.rim_balance is None:
            return self.condensed.nodal_displacements_in_one_case(
                nodal, frame, self.condensed.columns.column_factors_of_all_loads({})
            )
        on_rim = self.condensed.columns.column_factors_of_all_loads(
            {RIM_LOAD_NAME: -self.rim_balance.factors @ nodal}
        )
        u = self.condensed.nodal_displacements_in_one_case(nodal, frame, on_rim)
        # A rigid-body motion is subtracted, so that the mean motion of the ring's far edge is zero.
        modes_by_node = rigid_body_displacements_of_nodes(self.basis.doflocs, np.zeros(2)).reshape(
            -1, 2, DEGREES_OF_FREEDOM_OF_BODY_FRAME
        )
        modes = np.ascontiguousarray(modes_by_node.transpose(2, 1, 0))
        mean_of_modes = np.einsum("kci,cil->kl", modes, self.rim_balance.forces)
        mean = np.einsum("ci,cil->l", u, self.rim_balance.forces)
        rigid_motion = np.linalg.solve(mean_of_modes.T, mean)
        return np.asarray(u - np.einsum("k,kci->ci", rigid_motion, modes))


def mesh_of_drum_ring(
    ring: RectangularCrossSection, radius: float, shoes: tuple[Shoe, ...], elements: int
) -> Any:
    """Mesh of quadratic quadrilaterals of the whole ring, finer at the ends of the linings.

    The boundary "contact" is the friction surface of the ring, and "support" the far edge opposite
    to it.

    Parameters
    ----------
    ring : cross-section of the ring
    radius : radius of the friction surface [m]
    shoes : shoes whose linings press the ring
    elements : number of elements along each lining
    """
    angles = _angles_where_ring_elements_meet(radius, shoes, elements)
    depths = points_graded_to_both_ends(
        0,
        ring.thickness,
        number_of_element_layers_in_lining(elements),
        ring.thickness / 2,
        RELATIVE_SIZE_OF_LINING_END_ELEMENT,
    )
    return quadratic_mesh_of_closed_ring(
        angles, depths, radius, shoes[0].sign_internal_plus_external_minus, "drum"
    )


def _angles_where_ring_elements_meet(
    radius: float, shoes: tuple[Shoe, ...], elements: int
) -> Floats:
    """Angles [rad] at which elements of a ring meet, equally spaced between the linings.

    Parameters
    ----------
    radius : radius of the friction surface [m]
    shoes : shoes whose linings press the ring
    elements : number of elements along each lining
    """
    parts, arcs = [], []
    for shoe in sorted(shoes, key=lambda shoe: shoe.lining.start % (2 * math.pi)):
        counts = number_of_elements_on_each_lining(shoe, elements)[:: shoe.frame.sense]
        for (start, end), count in zip(shoe.lining.arcs, counts, strict=True):
            arcs.append(end - start)
            angles_of_lining = element_ends_along_lining(arcs[-1], shoe, radius, count)
            parts.append(start % (2 * math.pi) + angles_of_lining)
    angles = np.unique(np.concatenate(parts) % (2 * math.pi))
    step = min(arcs) / elements
    # Where linings overlap, two nearly equal angles would make a thin element. One of them is left
    # out.
    if len(arcs) > 1:
        angles = angles[np.append(True, np.diff(angles) > 0.01 * step)]
    # Wide gaps between the element ends found so far are divided into equal elements, each some
    # 1.5 times as long as the elements under the linings.
    gaps = np.diff(np.append(angles, angles[0] + 2 * math.pi))
    filled = []
    for angle, gap in zip(angles, gaps, strict=True):
        count = max(1, round(gap / (1.5 * step)))
        filled.append(angle + gap * np.arange(count) / count)
    return np.concatenate(filled)


def quadratic_mesh_of_closed_ring(
    angles: Floats, depths: Floats, radius: float, sign: int, name: str
) -> Any:
    """Mesh of quadratic quadrilaterals of a closed ring between two circles about the origin.

    A node lies at radius + sign depth. The boundary "contact" is the circle at depth 0, and
    "support" the circle at the largest depth.

    Parameters
    ----------
    angles : (m,) ends of the elements within one turn [rad]
    depths : (l + 1,) growing depths [m] of the ends of the l element layers, from 0 on
    radius : radius of the friction surface [m]
    sign : 1 if the depth grows outwards, -1 if it grows inwards
    name : name of the one subdomain
    """
    # The import of skfem takes time, and bodies of hp elements do without it.
    import skfem  # noqa: PLC0415

    m = len(angles)
    depth, theta = np.repeat(depths, m), np.tile(angles, len(depths))
    corner = np.arange(len(depths) * m).reshape(len(depths), m)
    after = np.roll(corner, -1, axis=1)
    cells = np.array([corner[:-1], corner[1:], after[1:], after[:-1]]).reshape(4, -1)

    # A midside node lies on the ray through the middle of its edge's chord, at the mean depth of
    # the edge's two ends.
    circle = np.array([np.cos(theta), np.sin(theta)])
    grid = skfem.MeshQuad(circle, cells, validate=False)
    direction = skfem.MeshQuad2.from_mesh(grid).doflocs
    unrolled = skfem.MeshQuad(np.array([depth, theta]), cells, validate=False)
    height = skfem.MeshQuad2.from_mesh(unrolled).doflocs[0]

    outer = np.isin(np.arange(grid.nfacets), grid.boundary_facets())
    middle = depth[grid.facets].mean(axis=0)
    return skfem.MeshQuad2(
        (radius + sign * height) * direction / np.hypot(*direction),
        grid.t,
        _subdomains={name: np.arange(grid.nelements)},
        _boundaries={
            "contact": np.flatnonzero(outer & (middle < 0.5 * depths[-1])),
            "support": np.flatnonzero(outer & (middle > 0.5 * depths[-1])),
        },
    )


def condense_meshed_drum_ring_to_contact_nodes(
    brake: Brake, elements: int, linings: tuple[ContactLine, ...]
) -> RingSubstructure:
    """The drum ring of a brake, meshed and condensed to its nodes under the linings.

    Parameters
    ----------
    brake : the brake, which has a ring with a section
    elements : number of elements along each lining
    linings : contact line of each shoe with all its linings, in the frame of the shoe
    """
    # `scene.reason_against_finite_element_model` refuses a ring without a section.
    ring = brake.ring
    assert ring is not None and ring.section is not None
    mesh = mesh_of_drum_ring(ring.section, brake.size, brake.shoes, elements)
    basis = nodal_basis_of_mesh(mesh)
    K = stiffness_of_drum_ring_without_supports(basis, ring)
    arcs = []
    for shoe, lining in zip(brake.shoes, linings, strict=True):
        angles = shoe.frame.surface_coordinates_of_phi(lining.phi)
        arcs.append((float(angles.min()), float(angles.max())))
    # Only nodes under the linings are contact nodes; all other nodes of the surface are eliminated.
    under = _ring_facets_under_arcs(mesh, arcs)
    line = make_contact_line_of_lining(basis, under, math.pi)
    n = 2 * len(line.nodes)
    far_edge = basis.get_dofs(mesh.boundaries["support"]).flatten()
    held = fixed_nodes_of_ring(ring, far_edge)
    if ring.support != "free":
        constraints = multi_point_constraints_of_body(basis, line.nodes, held, np.zeros(2))
        condensed = condense_body_to_contact_and_hinge_face(K, constraints, {}, n)
        rim_balance = None
    else:
        determinate = indices_of_displacements_that_hold_free_ring(basis, far_edge)
        constraints = multi_point_constraints_of_body(
            basis, line.nodes, held, np.zeros(2), determinate
        )
        rim = rim_forces_distributed_like_rigid_modes(basis, mesh.boundaries["support"])
        condensed = condense_body_to_contact_and_hinge_face(
            K, constraints, {RIM_LOAD_NAME: constraints.matrix.T @ rim}, n
        )
        rim_balance = FreeRingForceBalance.force_balance_of_free_ring(basis, rim, condensed, line)
    return condensed_ring_coupled_with_linings(
        brake, linings, mesh, basis, line, condensed, held, rim_balance
    )


def stiffness_of_drum_ring_without_supports(
    basis: Any, ring: DrumRing, *, precise: bool = False
) -> Any:
    """Sparse stiffness (2 nodes, 2 nodes) [N/m] of a ring without any fixed node.

    All models of the ring take its stiffness from this function. The stiffness of an elastic
    support would be added here.

    Parameters
    ----------
    basis : scalar basis of a mesh, or a grid of hp elements, or the skeleton of such a grid
    ring : the ring, which has a section
    precise : whether to compute in long double
    """
    assert ring.section is not None
    return sparse_stiffness_of_body(basis, elastic_layers_of_ring(ring.section), precise=precise)


def fixed_nodes_of_ring(ring: DrumRing, far_edge: Ints) -> Ints:
    """The fixed nodes of a ring: all nodes of its far edge if the edge is fixed, or none."""
    return far_edge if ring.support == "fixed" else far_edge[:0]


def condensed_ring_coupled_with_linings(
    brake: Brake,
    linings: tuple[ContactLine, ...],
    mesh: Any,
    basis: Any,
    line: ContactLine,
    condensed: CondensedBody,
    held: Ints,
    rim_balance: "FreeRingForceBalance | None",
) -> RingSubstructure:
    """A condensed ring with its half flexibilities under the pressure and friction of all linings.

    Parameters
    ----------
    brake : the brake
    linings : contact line of each shoe with all its linings, in the frame of the shoe
    mesh, basis, line, condensed, held, rim_balance : attributes of the `RingSubstructure`
    """
    matrices = _coupling_matrices_of_all_linings_and_ring(brake.shoes, linings, line)
    return RingSubstructure(
        mesh,
        basis,
        line,
        condensed,
        normal_half_flexibilities=tuple(
            _half_flexibility_of_ring_under_nodal_forces(condensed, N.T, rim_balance)
            for N, _ in matrices
        ),
        friction_half_flexibilities=tuple(
            _half_flexibility_of_ring_under_nodal_forces(condensed, -T.T, rim_balance)
            for _, T in matrices
        ),
        coupling_matrices=tuple(matrices),
        held=held,
        rim_balance=rim_balance,
    )


def _ring_facets_under_arcs(mesh: Any, arcs: list[tuple[float, float]]) -> Ints:
    """Indices of the element edges (facets) of the friction surface under any of the `arcs` [rad].

    An edge on the ring's friction surface counts if it lies at least partly under an arc.
    """
    facets = mesh.boundaries["contact"]
    x, y = mesh.p[:, mesh.facets[:, facets]]
    first, second = np.arctan2(y, x)
    half_facet = 0.5 * np.abs(_angles_wrapped_to_half_turn(second - first))
    middle = np.arctan2(y.sum(axis=0), x.sum(axis=0))
    under = np.zeros(len(facets), dtype=bool)
    for start, end in arcs:
        away = np.abs(_angles_wrapped_to_half_turn(middle - 0.5 * (start + end)))
        half_arc = 0.5 * (end - start)
        under |= away < half_arc + half_facet * (1 - 1e-9)
    return facets[under]


def _angles_wrapped_to_half_turn(angle: Floats) -> Floats:
    """The angles [rad] moved by whole turns to the interval from -pi to pi."""
    return np.asarray((angle + math.pi) % (2 * math.pi) - math.pi)


def _coupling_matrices_of_all_linings_and_ring(
    shoes: Sequence[Shoe], linings: Sequence[ContactLine], ring: ContactLine
) -> list[tuple[Floats, Floats]]:
    """The coupling matrices N and T of each shoe's linings with the ring.

    Contact lines of one polynomial degree are integrated together, which takes less time than one
    after the other.

    Parameters
    ----------
    shoes : the shoes
    linings : contact line of each shoe with all its linings, in the frame of the shoe
    ring : contact line of the ring, in the brake's frame
    """
    found: dict[int, tuple[Floats, Floats]] = {}
    degrees = [lining.interpolation_degree_along_contact_line for lining in linings]
    for degree in sorted(set(degrees)):
        members = [i for i, own in enumerate(degrees) if own == degree]
        joined = _contact_line_of_several_linings(
            [shoes[i] for i in members], [linings[i] for i in members]
        )
        edges = [linings[i].pieces.shape[1] for i in members]
        N, T = coupling_matrices_of_lining_and_ring(
            joined,
            ring,
            np.repeat([shoes[i].lining.width for i in members], edges),
            shoes[0].sign_internal_plus_external_minus,
        )
        ends = np.cumsum([len(linings[i].nodes) for i in members])[:-1]
        parts = zip(np.split(N, ends), np.split(T, ends), strict=True)
        found.update(zip(members, parts, strict=True))
    return [found[i] for i in range(len(linings))]


def _contact_line_of_several_linings(
    shoes: Sequence[Shoe], linings: Sequence[ContactLine]
) -> ContactLine:
    """The contact lines of several shoes, all of one degree, as one line in the brake's frame."""
    firsts = np.cumsum([0, *(len(lining.nodes) for lining in linings[:-1])])
    xy = [
        shoe.frame.convert_vectors_from_shoe_to_brake_frame(lining.xy.T).T
        for shoe, lining in zip(shoes, linings, strict=True)
    ]
    pieces = [lining.pieces + first for lining, first in zip(linings, firsts, strict=True)]
    return ContactLine(
        np.concatenate([lining.nodes for lining in linings]),
        np.hstack(xy),
        np.concatenate([lining.phi for lining in linings]),
        np.hstack(pieces),
    )


def coupling_matrices_of_lining_and_ring(
    lining: ContactLine, ring: ContactLine, width: float | Floats, sign: int
) -> tuple[Floats, Floats]:
    """The coupling matrices N and T (n, 2 n_ring) [m^2] of a lining's pressure with the ring.

    They are integrated over the overlaps of the edges of both contact lines, with the unit normal
    n = sign e_r. A pressure p exerts the nodal forces N^T p on the ring, and its friction the nodal
    forces -mu s T^T p, with the sense s of sliding.

    Parameters
    ----------
    lining, ring : contact lines in the brake's frame
    width : width of the lining [m]; if widths differ, (e,) the width at each of the e edges
    sign : 1 if the lining presses outwards, -1 if it presses inwards
    """
    own, other = _edges_with_angles_of_their_ends(lining), _edges_with_angles_of_their_ends(ring)
    overlaps = _overlaps_of_lining_and_ring_edges(own, other)
    own_nodes = own.pieces[:, overlaps.lining]
    ring_nodes = other.pieces[:, overlaps.ring]
    own_xy, ring_xy = lining.xy[:, own_nodes], ring.xy[:, ring_nodes]

    at = _quadrature_of_overlaps(lining, ring, own_xy, ring_xy, overlaps)
    x, r = at.x, np.hypot(*at.x)
    widths = np.broadcast_to(width, own.start.shape)
    ds = at.ds * widths[overlaps.lining, None]

    # The friction acts on the lining's arc, at the distance `arm` from the ring's arc. The couple
    # of this offset is applied by the slopes of the ring's shape functions.
    r_ring = np.hypot(*np.einsum("cki,kiq->ciq", ring_xy, at.phi))
    tau = np.einsum("cki,kiq->ciq", ring_xy, at.ring_slopes)
    tangent_length = np.hypot(*tau)
    arm = np.array([-tau[1], tau[0]]) / tangent_length * (r - r_ring)
    phi_slope = at.ring_slopes / tangent_length

    n, m = len(lining.nodes), len(ring.nodes)
    N, T = np.zeros((n, m, 2)), np.zeros((n, m, 2))
    where = (own_nodes[:, None], ring_nodes[None])
    normal, tangent = sign * x / r, np.array([-x[1], x[0]]) / r
    np.add.at(N, where, np.einsum("aiq,biq,ciq,iq->abic", at.psi, at.phi, normal, ds))
    np.add.at(T, where, np.einsum("aiq,biq,ciq,iq->abic", at.psi, at.phi, tangent, ds))
    np.add.at(T, where, np.einsum("aiq,biq,ciq,iq->abic", at.psi, phi_slope, arm, ds))
    return N.reshape(n, 2 * m), T.reshape(n, 2 * m)


class _OverlapQuadrature(NamedTuple):
    """The q quadrature points of each of k overlaps of a lining's edges with edges of the ring.

    Attributes
    ----------
    psi, phi : (nodes, k, q) shape functions of the lining's edges and of the ring's edges
    ring_slopes : (nodes, k, q) derivatives of `phi` by the local coordinate of the ring's edges
    x : (2, k, q) points on the lining's edges [m]
    ds : (k, q) length of arc [m] that each point stands for, with its Gauss weight
    """

    psi: Floats
    phi: Floats
    ring_slopes: Floats
    x: Floats
    ds: Floats


def _quadrature_of_overlaps(
    lining: ContactLine,
    ring: ContactLine,
    own_xy: Floats,
    ring_xy: Floats,
    overlaps: "_OverlapsOfLiningAndRingEdges",
) -> _OverlapQuadrature:
    """The quadrature points of the overlaps, where rays from the drum's centre cross both edges.

    Parameters
    ----------
    lining, ring : contact lines in the brake's frame
    own_xy, ring_xy : (2, nodes, k) nodes of the lining's edge and of the ring's edge of each
        overlap [m]
    overlaps : the k overlaps
    """
    # xi is the local coordinate of a point on the lining's edge, and eta its coordinate on the
    # ring's edge.
    length = (overlaps.end - overlaps.start)[:, None]
    angle = overlaps.start[:, None] + 0.5 * length * (1 + GAUSS)
    xi = _edge_coordinates_where_rays_cross(own_xy, angle)
    eta = _edge_coordinates_where_rays_cross(ring_xy, angle)
    degree, ring_degree = (line.interpolation_degree_along_contact_line for line in (lining, ring))
    psi = lagrange_shape_function_values(degree, xi.ravel()).reshape(-1, *xi.shape)
    phi = lagrange_shape_function_values(ring_degree, eta.ravel()).reshape(-1, *eta.shape)
    x = np.einsum("cki,kiq->ciq", own_xy, psi)
    dx = np.einsum("cki,kiq->ciq", own_xy, lagrange_shape_function_derivatives(degree, xi))
    angle_per_xi = np.abs(x[0] * dx[1] - x[1] * dx[0]) / np.hypot(*x) ** 2
    return _OverlapQuadrature(
        psi=psi,
        phi=phi,
        ring_slopes=lagrange_shape_function_derivatives(ring_degree, eta),
        x=x,
        ds=np.hypot(*dx) / angle_per_xi * 0.5 * length * WEIGHTS,
    )


class _OverlapsOfLiningAndRingEdges(NamedTuple):
    """The k overlaps of a lining's edges with edges of the ring.

    `lining` (k,) and `ring` (k,) are the indices of the two edges that overlap. The overlap goes
    from the angle `start` (k,) to the angle `end` (k,) [rad].
    """

    lining: Ints
    ring: Ints
    start: Floats
    end: Floats


def _overlaps_of_lining_and_ring_edges(
    lining: "_EdgesWithAnglesOfTheirEnds", ring: "_EdgesWithAnglesOfTheirEnds"
) -> _OverlapsOfLiningAndRingEdges:
    """The overlaps of a lining's edges with the ring's edges.

    The angles of two overlapping edges may differ by a whole turn.
    """
    turns = np.subtract.outer(lining.start + lining.end, ring.start + ring.end)
    whole_turns = 2 * math.pi * np.round(0.5 * turns / (2 * math.pi))
    first = np.maximum(lining.start[:, None], ring.start + whole_turns)
    last = np.minimum(lining.end[:, None], ring.end + whole_turns)
    # Overlaps of 1e-13 rad and less are round-off.
    i, j = np.nonzero(first < last - 1e-13)
    return _OverlapsOfLiningAndRingEdges(i, j, first[i, j], last[i, j])


class _EdgesWithAnglesOfTheirEnds(NamedTuple):
    """The m element edges of a contact line: their nodes, and the angles of their ends.

    `pieces` (order + 1, m) are the nodes of each edge. Each edge goes from the angle `start` (m,)
    to the angle `end` (m,) [rad].
    """

    pieces: Ints
    start: Floats
    end: Floats


def _edges_with_angles_of_their_ends(line: ContactLine) -> _EdgesWithAnglesOfTheirEnds:
    """The nodes of each edge of a contact line by growing angle, and the angles of its two ends."""
    z = line.xy[0] + 1j * line.xy[1]
    first, last = z[line.pieces[0]], z[line.pieces[-1]]
    turn = np.angle(last / first)
    pieces = np.where(turn > 0, line.pieces, line.pieces[::-1])
    start = np.angle(np.where(turn > 0, first, last))
    return _EdgesWithAnglesOfTheirEnds(pieces, start, start + np.abs(turn))


def _edge_coordinates_where_rays_cross(xy: Floats, angle: Floats) -> Floats:
    """Local coordinates xi (m, points) in [-1, 1] where edges cross rays from the drum's centre.

    `xy` (2, k, m) are the nodes of the edges, and `angle` (m, points) the angles of the rays [rad].
    """
    order = xy.shape[1] - 1
    # A point lies on the ray where its scalar product with the ray's normal is zero.
    normal = np.array([-np.sin(angle), np.cos(angle)])
    side = np.einsum("cki,ciq->kiq", xy, normal)
    xi = (side[0] + side[-1]) / (side[0] - side[-1])
    # Newton's iteration starts where the chord crosses the ray, which is exact on straight edges.
    # Its error is squared in each step, so that a step below the root of the round-off is the last.
    for _ in range(MOST_NEWTON_STEPS_TO_RAY_CROSSING if order > 1 else 0):
        functions = lagrange_shape_function_values(order, xi)
        value = np.einsum("kiq,kiq->iq", functions, side)
        slope = np.einsum("kiq,kiq->iq", lagrange_shape_function_derivatives(order, xi), side)
        step = value / slope
        xi = xi - step
        if np.abs(step).max(initial=0.0) < RAY_CROSSING_STEP_TOLERANCE:
            break
    return np.clip(xi, -1.0, 1.0)


def rim_forces_distributed_like_rigid_modes(basis: Any, facets: Ints) -> Floats:
    """Nodal forces (2 nodes, 3) on a ring's far edge, distributed like its rigid-body modes.

    The far edge is the edge opposite to the friction surface. The work of these forces on a
    displacement of the ring is the mean, along the far edge, of the scalar product of the
    displacement and each mode. `facets` are the indices of the element edges on the far edge.
    """
    nodes = nodes_along_element_edges(basis, facets)
    psi, x, ds = edge_quadrature_points(basis.doflocs[:, nodes])
    weight = ds / ds.sum()
    modes = np.array([[np.ones_like(ds), 0 * ds], [0 * ds, np.ones_like(ds)], [-x[1], x[0]]])
    loads = np.zeros((basis.N, 2, DEGREES_OF_FREEDOM_OF_BODY_FRAME))
    np.add.at(loads, nodes, np.einsum("aq,lciq,iq->aicl", psi, modes, weight))
    return loads.reshape(-1, DEGREES_OF_FREEDOM_OF_BODY_FRAME)


def indices_of_displacements_that_hold_free_ring(basis: Any, support: Ints) -> Ints:
    """Indices (3,) of three displacements that, if fixed, keep a free ring from rigid-body motion.

    They are displacements of two nodes of the far edge. This support is statically determinate: it
    takes no force if the loads are in equilibrium.
    """
    angle = np.arctan2(basis.doflocs[1, support], basis.doflocs[0, support])
    right = support[np.argmin(np.abs(angle))]
    left = support[np.argmax(np.abs(angle))]
    return np.array([2 * right, 2 * right + 1, 2 * left + 1])


@dataclass(frozen=True)
class FreeRingForceBalance:
    """The balance of a free ring: forces on its far edge that balance the forces of the linings.

    The far edge, or rim, is the edge opposite to the friction surface. B are unit rim forces that
    are distributed like the rigid-body modes R. The rim forces -B lambda balance the contact forces
    f of the linings, with lambda = (R^T B)^-1 R^T f. The mean motion of the rim is zero. Three
    displacements of the ring are fixed, which is statically determinate, so that no force acts on
    them. The work of the forces is (Y - Y_B lambda)^T (Y - Y_B lambda) + lambda^T beta lambda. Y
    and Y_B are the half flexibilities under f and under B, and beta is the work of B if the contact
    nodes are fixed as well.

    Attributes
    ----------
    forces : (2, nodes, 3) rim forces B
    factors : (3, 2n) lambda for each unit nodal force on the contact
    half_flexibility : (2n, 3) Y_B, the half flexibility under B
    root_of_rim_force_work : (3, 3) square root of beta
    """

    forces: Floats
    factors: Floats
    half_flexibility: Floats
    root_of_rim_force_work: Floats

    @classmethod
    def force_balance_of_free_ring(
        cls, basis: Any, rim: Floats, condensed: CondensedBody, line: ContactLine
    ) -> "FreeRingForceBalance":
        """The force balance of a ring that is condensed with the rim forces B as its unit loads.

        Parameters
        ----------
        basis : scalar basis, or a grid of hp elements
        rim : (2 nodes, 3) rim forces B
        condensed : the condensed ring
        line : contact line of the ring
        """
        modes = rigid_body_displacements_of_nodes(basis.doflocs, np.zeros(2))
        on_contact = (
            modes.reshape(-1, 2, DEGREES_OF_FREEDOM_OF_BODY_FRAME)[line.nodes]
            .reshape(-1, DEGREES_OF_FREEDOM_OF_BODY_FRAME)
            .T
        )
        factors = np.linalg.solve(modes.T @ rim, on_contact)
        # The import of scipy.linalg takes time, and brakes with a rigid drum do without it.
        from scipy.linalg import sqrtm  # noqa: PLC0415

        return cls(
            forces=rim.reshape(-1, 2, DEGREES_OF_FREEDOM_OF_BODY_FRAME).transpose(1, 0, 2),
            factors=np.asarray(factors),
            half_flexibility=condensed.half_flexibility_under_nodal_forces(
                condensed.load_on_contact
            ),
            root_of_rim_force_work=sqrtm(condensed.load_work).real,
        )


def _half_flexibility_of_ring_under_nodal_forces(
    condensed: CondensedBody, forces: Floats, rim_balance: FreeRingForceBalance | None
) -> Floats:
    """The half flexibility W (m, k) of a drum ring under nodal forces on its contact nodes.

    W^T W (k, k) is the work of the forces of each load case on the displacements of each load case.

    Parameters
    ----------
    condensed : the condensed ring
    forces : (2n, k) nodal forces
    rim_balance : balance of forces on a free ring; None if the far edge is fixed
    """
    # No force acts on the first rows, where the half flexibility is therefore zero.
    first = int(np.argmax(forces.any(axis=1)))
    Y = np.zeros(forces.shape)
    Y[first:] = solve_lower_triangular_system(condensed.L_cc[first:, first:], forces[first:])
    if rim_balance is None:
        return Y
    rim_factors = rim_balance.factors @ forces
    on_contact = Y - rim_balance.half_flexibility @ rim_factors
    return np.vstack([on_contact, rim_balance.root_of_rim_force_work @ rim_factors])
