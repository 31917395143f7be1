"""Errors of the solid model against exact formulas of elasticity in three dimensions.

The formulas judge the mesh, the stiffness matrix and the contact face of solid shoes on simple
bodies, without a brake.
"""

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
import skfem
from scipy.sparse.linalg import splu

from drumlin.base.arrays import Floats, Ints
from drumlin.brake.elasticity import ElasticLayer, solid_elasticity_matrix
from drumlin.brake.fields import Material
from drumlin.contact import active_set
from drumlin.contact.equations import ContactProblem
from drumlin.fem.mesh.edges import nodes_along_element_edges
from drumlin.fem.mesh.grading import positions_with_steps_growing_by_constant_ratio
from drumlin.fem.solid.body import HALVES, constraints_of_solid_shoe
from drumlin.fem.solid.face import ContactFace, contact_surface_over_shoe_width
from drumlin.fem.solid.mesh import Solid, extrude_shoe_section_to_solid
from drumlin.fem.substructure.body import (
    condense_body_to_contact_and_frame,
    sparse_stiffness_of_body,
)
from drumlin.fem.substructure.interface import (
    ContactLine,
    function_for_drum_normals_and_tangents,
    make_contact_line_of_lining,
)

PART = "lining"
"""Name of the only subdomain in the mesh of each body of this module."""


def _section_mesh_with_moved_nodes(grid: Any, at: Floats, groups: Mapping[str, Any]) -> Any:
    """The mesh of a plane section in quadratic quadrilaterals.

    grid : mesh of linear quadrilaterals with the elements; at : places (2, nodes) [m] of the nodes;
    groups : numbers of the edges on each boundary, by its name.
    """
    return skfem.MeshQuad2(
        at, grid.t, _subdomains={PART: np.arange(grid.nelements)}, _boundaries=dict(groups)
    )


def solid_mesh_of_ring_sector(radii: Floats, angles: Floats, z: Floats) -> Solid:
    """The solid mesh of a ring sector, with the boundary "contact" outside and "hinge" inside.

    Parameters
    ----------
    radii, angles, z : array
        Corners of the elements along the radius [m], the angle [rad] and the width [m].
    """
    grid = skfem.MeshQuad.init_tensor(radii[-1] - radii[::-1], angles)
    middle = grid.p[:, grid.facets].mean(axis=1)
    thick = float(radii[-1] - radii[0])
    groups = {
        "contact": np.flatnonzero(middle[0] < 1e-12 * thick),
        "hinge": np.flatnonzero(middle[0] > thick * (1 - 1e-12)),
    }
    quadratic = skfem.MeshQuad2.from_mesh(grid)
    r, phi = radii[-1] - quadratic.doflocs[0], quadratic.doflocs[1]
    return extrude_shoe_section_to_solid(
        _section_mesh_with_moved_nodes(grid, np.array([r * np.cos(phi), r * np.sin(phi)]), groups),
        {PART: float(z[-1])},
        z,
    )


def contact_face_of_ring_sector(solid: Solid) -> ContactFace:
    """The contact face of a ring sector, on which angles are measured from the x axis."""
    return contact_surface_over_shoe_width(
        make_contact_line_of_lining(solid.plane, solid.section.boundaries["contact"], 0.0),
        solid.node,
        solid.z,
    )


def displacement_error_against_lame_ring(
    elements: int, material: Material, radii: tuple[float, float] = (0.6, 1.0), half: float = 0.5
) -> float:
    """Error of the solid mesh on a quarter ring under outer pressure, against Lame's solution.

    The result is the largest error of a displacement over the largest displacement. The faces
    z = +-half are free. Plane stress is then exact for any width:
    u_r = A r + B/r, u_z = -nu/E (s_r + s_theta) z.

    Parameters
    ----------
    elements : int
        Number of elements through the thickness of the ring.
    material : Material
        Material of the ring.
    radii : tuple of float
        Inner and outer radius [m].
    half : float
        Half of the width [m].
    """
    a, b = radii
    solid = solid_mesh_of_ring_sector(
        np.linspace(a, b, elements + 1),
        np.linspace(0, math.pi / 2, 3 * elements + 1),
        np.linspace(0, half, 3),
    )
    E, nu, p = material.E, material.nu, 1.0
    K = sparse_stiffness_of_body(
        solid.basis, {PART: ElasticLayer(solid_elasticity_matrix(material), HALVES)}
    )
    face, x = contact_face_of_ring_sector(solid), solid.basis.doflocs
    load = np.zeros((solid.basis.N, 3))
    load[face.nodes, :2] = -(
        face.couple_lining_with_drum_or_plane(0.0, function_for_drum_normals_and_tangents(1)).N.T
        @ np.full(len(face.nodes), p)
    ).reshape(-1, 2)
    fixed = np.zeros((solid.basis.N, 3), dtype=bool)
    for c in range(3):
        fixed[np.abs(x[c]) < 1e-9, c] = True
    # Solve with symmetry in the three planes of the axes, under the nodal forces of the pressure.
    free = np.flatnonzero(~fixed.ravel())
    u = np.zeros(int(3 * solid.basis.N))
    u[free] = splu(K[free][:, free].tocsc()).solve(load.ravel()[free])
    r = np.hypot(x[0], x[1])
    # Lame's stresses are s_r = A (1 - a^2/r^2) and s_theta = A (1 + a^2/r^2).
    A = -p * b**2 / (b**2 - a**2)
    radial_u = A / E * ((1 - nu) * r + (1 + nu) * a**2 / r)
    exact = np.array([radial_u * x[0] / r, radial_u * x[1] / r, -2 * nu / E * A * x[2]])
    return float(np.abs(u.reshape(-1, 3).T - exact).max() / np.abs(exact).max())


def nodal_force_error_of_patch_test(elements: int, material: Material) -> float:
    """Error of the nodal forces by which the pressure on a curved contact face acts on a solid.

    The solid has the uniform strain of a hydrostatic pressure of 1. The stiffness matrix K and the
    displacements u give the exact nodal forces K u. On the inner nodes of the contact face they
    must equal the nodal forces -N^T p of the pressure p = 1, where N is the coupling matrix of the
    face. The result is the largest difference over the largest force.

    elements : number of elements along the face; material : material of the solid.
    """
    z = np.array([0.0, 0.1, 0.15])
    solid = solid_mesh_of_ring_sector(
        np.linspace(0.6, 1.0, 3), np.linspace(-0.5, 0.5, elements + 1), z
    )
    K = sparse_stiffness_of_body(
        solid.basis, {PART: ElasticLayer(solid_elasticity_matrix(material), HALVES)}
    )
    u = -(1 - 2 * material.nu) / material.E * solid.basis.doflocs.T
    forces = (K @ u.ravel()).reshape(-1, 3)
    face = contact_face_of_ring_sector(solid)
    mine = -(
        face.couple_lining_with_drum_or_plane(0.0, function_for_drum_normals_and_tangents(1)).N.T
        @ np.ones(len(face.nodes))
    ).reshape(-1, 2)
    within = (np.abs(face.phi) < 0.5 - 1e-9) & (
        np.tile(face.z, len(face.line.nodes)) < z[-1] - 1e-9
    )
    wanted = forces[face.nodes, :2]
    return float(np.abs(mine - wanted)[within].max() / np.abs(wanted[within]).max())


class PointContact(NamedTuple):
    """Accuracy of a point contact on a mesh, against Hertz's formula.

    Attributes
    ----------
    peak : float
        Computed peak pressure over the peak pressure by Hertz.
    distance : float
        Relative L2 distance of the computed pressure from the pressure by Hertz.
    unknowns : int
        Number of unknowns of the mesh.
    """

    peak: float
    distance: float
    unknowns: int


def _normals_and_tangents_of_flat_top(x: Floats) -> tuple[Floats, Floats]:
    """The normals along y and the tangents along x (2, ...) of a plane, at points x (2, ...)."""
    zero, one = np.zeros_like(x[0]), np.ones_like(x[0])
    return np.stack([zero, one]), np.stack([one, zero])


def solve_point_contact_against_hertz(
    per_radius: int, nu: float = 0.3, size: float = 6.0, growth: float = 1.6
) -> PointContact:
    """The accuracy of the contact between a rigid sphere and a solid block (Hertz 1882).

    Sphere and contact have the radius 1. With E' = E/(1 - nu^2) the force is F = 4 E'/3 and the
    peak pressure 3 F/(2 pi).

    Parameters
    ----------
    per_radius : int
        Number of elements along the radius of the contact.
    nu : float
        Poisson's ratio.
    size : float
        Height of the block and half of its other edges, over the radius of the contact.
    growth : float
        Ratio of the sizes of neighbouring elements away from the contact.
    """
    solid, bottom = _solid_block_graded_to_contact(per_radius, size, growth)
    material = Material(E=1.0, nu=nu)
    face = contact_surface_over_shoe_width(_contact_line_on_flat_top(solid), solid.node, solid.z)
    held = np.unique(nodes_along_element_edges(solid.plane, bottom))
    ties = constraints_of_solid_shoe(
        solid, face.nodes, solid.node[held].ravel(), np.zeros(2), bonded=True
    )
    K = sparse_stiffness_of_body(
        solid.basis, {PART: ElasticLayer(solid_elasticity_matrix(material), HALVES)}
    )
    body = condense_body_to_contact_and_frame(K, ties, {}, 2 * len(face.nodes))
    coupling = face.couple_lining_with_drum_or_plane(0.0, _normals_and_tangents_of_flat_top)
    half = body.nodal_forces_over_cholesky_factor(coupling.N.T)
    r = np.hypot(face.xy[0], np.tile(face.z, len(face.line.nodes)))
    # The contact problem of the block against the paraboloid r^2/2, with the total force given.
    load, area = 4 / 3 / (1 - nu**2), coupling.areas_of_contact_nodes
    problem = ContactProblem(
        A=half.T @ half,
        q=coupling.M @ (r**2 / 2),
        B=-area[:, None],
        C=area[None],
        h=np.array([load]),
    )
    p = active_set.solve_contact_problem(problem, r < 1.05).p
    exact = 1.5 * load / math.pi * np.sqrt(np.maximum(1 - r**2, 0.0))
    off, size_ = p - exact, exact @ coupling.M @ exact
    return PointContact(
        float(p[r.argmin()] / exact.max()),
        math.sqrt(off @ coupling.M @ off / size_),
        int(3 * solid.basis.N),
    )


def _solid_block_graded_to_contact(
    per_radius: int, size: float, growth: float
) -> tuple[Solid, Ints]:
    """A solid block whose elements grow away from a contact of radius 1, and its bottom's edges.

    Elements have equal size up to 1.25 radii from the centre of the contact and grow beyond.
    `per_radius` is the number of elements along the radius of the contact, `size` the height of the
    block over this radius, and `growth` the ratio of the sizes of neighbouring elements away from
    the contact.
    """
    h = 1.25 / round(1.25 * per_radius)
    s = np.concatenate(
        [
            np.arange(0, 1.25, h),
            1.25 + positions_with_steps_growing_by_constant_ratio(size - 1.25, h, growth, size),
        ]
    )
    depth = positions_with_steps_growing_by_constant_ratio(size, h, growth, size)
    grid = skfem.MeshQuad.init_tensor(np.concatenate([-s[:0:-1], s]), -depth[::-1])
    middle = grid.p[:, grid.facets].mean(axis=1)
    groups = {
        "contact": np.flatnonzero(middle[1] > -1e-12),
        "hinge": np.flatnonzero(middle[1] < 1e-9 - size),
    }
    section = _section_mesh_with_moved_nodes(grid, skfem.MeshQuad2.from_mesh(grid).doflocs, groups)
    return extrude_shoe_section_to_solid(section, {PART: size}, s), groups["hinge"]


def _contact_line_on_flat_top(solid: Solid) -> ContactLine:
    """The contact line on the flat top of a block, with x coordinates in the place of angles."""
    ends = nodes_along_element_edges(solid.plane, solid.section.boundaries["contact"])
    at = solid.plane.doflocs
    nodes = np.unique(ends)
    nodes = nodes[np.argsort(at[0, nodes])]
    place = np.empty(solid.plane.N, dtype=np.int64)
    place[nodes] = np.arange(len(nodes))
    # Nodes of each edge, as their places along x; both nodes and edges are in growing order.
    pieces = place[ends]
    pieces = np.where(pieces[0] < pieces[-1], pieces, pieces[::-1])
    return ContactLine(nodes, at[:, nodes], at[0, nodes], pieces[:, np.argsort(pieces[0])])
