"""Closed forms in three dimensions that judge mesh, stiffness and contact face of solid shoes.

There is no brake, only parts of the model.
"""

import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
import skfem
from scipy.sparse.linalg import splu

from drumlin.base.arrays import Floats
from drumlin.brake.elasticity import ElasticLayer, solid_elasticity_matrix
from drumlin.brake.fields import Material
from drumlin.contact import active_set
from drumlin.contact.equations import ContactProblem
from drumlin.fem.mesh.edges import nodes_along_edges
from drumlin.fem.mesh.grading import points_with_growing_steps
from drumlin.fem.solid.body import HALVES, constrain_solid
from drumlin.fem.solid.face import ContactFace, contact_face
from drumlin.fem.solid.mesh import Solid, extrude
from drumlin.fem.substructure.body import condense_body, stiffness
from drumlin.fem.substructure.interface import ContactLine, drum_directions, make_contact_line

PART = "lining"
"""Name of the only part of a body."""


def _section_mesh(grid: Any, at: Floats, groups: Mapping[str, Any]) -> Any:
    """A section of quadratic quadrilaterals, a grid whose nodes are moved to `at` (2, nodes)."""
    return skfem.MeshQuad2(
        at, grid.t, _subdomains={PART: np.arange(grid.nelements)}, _boundaries=dict(groups)
    )


def ring_sector_mesh(radii: Floats, angles: Floats, z: Floats) -> Solid:
    """A sector of a ring, with the boundary "contact" outside and "hinge" inside.

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
    return extrude(
        _section_mesh(grid, np.array([r * np.cos(phi), r * np.sin(phi)]), groups),
        {PART: float(z[-1])},
        z,
    )


def contact_face_of(solid: Solid) -> ContactFace:
    """The contact face of a sector whose middle has the angle 0."""
    return contact_face(
        make_contact_line(solid.plane, solid.section.boundaries["contact"], 0.0),
        solid.node,
        solid.z,
    )


def lame_displacement_error(
    elements: int, material: Material, radii: tuple[float, float] = (0.6, 1.0), half: float = 0.5
) -> float:
    """Error of a quarter ring under outer pressure: largest error of u over the largest u.

    The faces z = +-half are free. Plane stress holds exactly for any width (Lame):
    u_r = A r + B/r, u_z = -nu/E (s_r + s_theta) z.

    Parameters
    ----------
    elements : int
        Elements through the ring.
    material : Material
        Its material.
    radii : tuple of float
        Inner and outer radius [m].
    half : float
        Half of the width [m].
    """
    a, b = radii
    solid = ring_sector_mesh(
        np.linspace(a, b, elements + 1),
        np.linspace(0, math.pi / 2, 3 * elements + 1),
        np.linspace(0, half, 3),
    )
    E, nu, p = material.E, material.nu, 1.0
    K = stiffness(solid.basis, {PART: ElasticLayer(solid_elasticity_matrix(material), HALVES)})
    face, x = contact_face_of(solid), solid.basis.doflocs
    load = np.zeros((solid.basis.N, 3))
    load[face.nodes, :2] = -(
        face.couple_with_counterface(0.0, drum_directions(1)).N.T @ np.full(len(face.nodes), p)
    ).reshape(-1, 2)
    fixed = np.zeros((solid.basis.N, 3), dtype=bool)
    for c in range(3):
        fixed[np.abs(x[c]) < 1e-9, c] = True
    free = np.flatnonzero(~fixed.ravel())
    u = np.zeros(int(3 * solid.basis.N))
    u[free] = splu(K[free][:, free].tocsc()).solve(load.ravel()[free])
    r = np.hypot(x[0], x[1])
    # The stresses are s_r = A (1 - a^2/r^2) and s_theta = A (1 + a^2/r^2).
    A = -p * b**2 / (b**2 - a**2)
    radial_u = A / E * ((1 - nu) * r + (1 + nu) * a**2 / r)
    exact = np.array([radial_u * x[0] / r, radial_u * x[1] / r, -2 * nu / E * A * x[2]])
    return float(np.abs(u.reshape(-1, 3).T - exact).max() / np.abs(exact).max())


def patch_force_error(elements: int, material: Material) -> float:
    """Error of the coupling on a curved face: largest error of a nodal force over the largest.

    Under the uniform strain of a hydrostatic pressure p = 1 the nodal forces on the surface are
    K u. On the inner nodes of the friction face they must be -N^T p.
    """
    z = np.array([0.0, 0.1, 0.15])
    solid = ring_sector_mesh(np.linspace(0.6, 1.0, 3), np.linspace(-0.5, 0.5, elements + 1), z)
    K = stiffness(solid.basis, {PART: ElasticLayer(solid_elasticity_matrix(material), HALVES)})
    u = -(1 - 2 * material.nu) / material.E * solid.basis.doflocs.T
    forces = (K @ u.ravel()).reshape(-1, 3)
    face = contact_face_of(solid)
    mine = -(
        face.couple_with_counterface(0.0, drum_directions(1)).N.T @ np.ones(len(face.nodes))
    ).reshape(-1, 2)
    within = (np.abs(face.phi) < 0.5 - 1e-9) & (
        np.tile(face.z, len(face.line.nodes)) < z[-1] - 1e-9
    )
    wanted = forces[face.nodes, :2]
    return float(np.abs(mine - wanted)[within].max() / np.abs(wanted[within]).max())


class PointContact(NamedTuple):
    """Hertz's point contact on a mesh.

    Attributes
    ----------
    peak : float
        Peak pressure over the closed form.
    distance : float
        Relative L2 distance of p from the closed form.
    unknowns : int
        Number of unknowns.
    """

    peak: float
    distance: float
    unknowns: int


def _upward_normal_and_tangent(x: Floats) -> tuple[Floats, Floats]:
    """Normal along y and tangent along x at points (2, ...)."""
    zero, one = np.zeros_like(x[0]), np.ones_like(x[0])
    return np.stack([zero, one]), np.stack([one, zero])


def hertz_point_contact(
    per_radius: int, nu: float = 0.3, size: float = 6.0, growth: float = 1.6
) -> PointContact:
    """A rigid sphere of radius 1 in a block, with a contact of radius 1 (Hertz 1882).

    With E' = E/(1 - nu^2) the force is F = 4 E'/3 and the peak pressure 3 F/(2 pi).

    Parameters
    ----------
    per_radius : int
        Elements to the radius of the contact.
    nu : float
        Poisson's ratio.
    size : float
        Half of the block's edges, over the radius of the contact.
    growth : float
        Ratio of neighbouring elements away from the contact.
    """
    h = 1.25 / round(1.25 * per_radius)
    s = np.concatenate(
        [np.arange(0, 1.25, h), 1.25 + points_with_growing_steps(size - 1.25, h, growth, size)]
    )
    depth = points_with_growing_steps(size, h, growth, size)
    grid = skfem.MeshQuad.init_tensor(np.concatenate([-s[:0:-1], s]), -depth[::-1])
    middle = grid.p[:, grid.facets].mean(axis=1)
    groups = {
        "contact": np.flatnonzero(middle[1] > -1e-12),
        "hinge": np.flatnonzero(middle[1] < 1e-9 - size),
    }
    section = _section_mesh(grid, skfem.MeshQuad2.from_mesh(grid).doflocs, groups)
    solid = extrude(section, {PART: size}, s)
    material = Material(E=1.0, nu=nu)
    face = contact_face(_flat_contact_line(solid), solid.node, solid.z)
    held = np.unique(nodes_along_edges(solid.plane, groups["hinge"]))
    ties = constrain_solid(solid, face.nodes, solid.node[held].ravel(), np.zeros(2), bonded=True)
    K = stiffness(solid.basis, {PART: ElasticLayer(solid_elasticity_matrix(material), HALVES)})
    body = condense_body(K, ties, {}, 2 * len(face.nodes))
    coupling = face.couple_with_counterface(0.0, _upward_normal_and_tangent)
    half = body.half_flexibility(coupling.N.T)
    r = np.hypot(face.xy[0], np.tile(face.z, len(face.line.nodes)))
    load, area = 4 / 3 / (1 - nu**2), coupling.area
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


def _flat_contact_line(solid: Solid) -> ContactLine:
    """The flat top of a block as a contact line. Its x coordinates take the place of angles."""
    ends = nodes_along_edges(solid.plane, solid.section.boundaries["contact"])
    at = solid.plane.doflocs
    nodes = np.unique(ends)
    nodes = nodes[np.argsort(at[0, nodes])]
    place = np.empty(solid.plane.N, dtype=np.int64)
    place[nodes] = np.arange(len(nodes))
    pieces = place[ends]
    pieces = np.where(pieces[0] < pieces[-1], pieces, pieces[::-1])
    return ContactLine(nodes, at[:, nodes], at[0, nodes], pieces[:, np.argsort(pieces[0])])
