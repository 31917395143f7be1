"""Shoes meshed by triangles, and statically condensed to the faces of their linings."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre

from drumlin.base.arrays import Bools, Floats, Ints
from drumlin.brake import clearance
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.one_sided import unit_forces_of_one_sided_supports_on_shoe
from drumlin.verification.triangles import lagrange
from drumlin.verification.triangles.lagrange import NodesOfTriangleMesh
from drumlin.verification.triangles.outline import OutlineOfLayeredBody
from drumlin.verification.triangles.places import nodal_forces_of_loads_besides_actuation
from drumlin.verification.triangles.triangulation import TriangleMeshInBodyCoordinates

FACE_GAUSS, FACE_WEIGHTS = legendre.leggauss(8)
"""Points in [-1, 1] and weights of the Gauss rule on an edge of a triangle at the lining's face."""


class BodyMeshedByTriangles(NamedTuple):
    """A shoe or a drum ring meshed by triangles, before its static condensation.

    Attributes
    ----------
    shape : outline of the body, in coordinates s along and d across its layers
    mesh : triangles of the body
    nodes : nodes of these triangles
    K : (m, 2n, 2n) stiffness matrix of each triangle [N/m]
    surface : indices of the nodes on the friction surface d = 0, in the order of growing s
    degree : polynomial degree of the triangles
    """

    shape: OutlineOfLayeredBody
    mesh: TriangleMeshInBodyCoordinates
    nodes: NodesOfTriangleMesh
    K: Floats
    surface: Ints
    degree: int


def triangle_body_with_nodes_and_stiffness(
    shape: OutlineOfLayeredBody, mesh: TriangleMeshInBodyCoordinates, degree: int
) -> BodyMeshedByTriangles:
    """The body of outline `shape` with the nodes and the stiffness matrices of its triangles."""
    nodes = lagrange.nodes_of_triangle_mesh_of_given_degree(mesh, shape.place, degree)
    K = lagrange.triangle_stiffness_matrices(mesh, nodes, shape.layers, degree)
    surface = np.flatnonzero(nodes.at[:, 1] == 0)
    return BodyMeshedByTriangles(
        shape, mesh, nodes, K, surface[np.argsort(nodes.at[surface, 0])], degree
    )


@dataclass(frozen=True)
class ShoeCondensedToLiningFace:
    """A shoe, statically condensed to the n nodes of its lining's face.

    Attributes
    ----------
    theta : (n,) angles of the nodes, growing [rad]
    xy : (n, 2) positions of the nodes [m]
    normal, tangent : (n, 2) unit normals into the drum and unit tangents along growing theta
    mass : (n, n) integrals over the face of products of two shape functions, times the lining's
        width [m^2]
    compliance : (2n, 2n) displacements of the nodes under unit forces on them [m/N]
    loaded : (2n,) displacements of the nodes under the actuation and other loads, without heat [m]
    elastic_actuation_work : work [N m] of these loads on the elastic displacements due to these
        loads alone
    displacements_under_unit_pushes : (2n, m) displacements of the nodes under a push of 1 N by each
        of the m one-sided supports of the shoe [m/N]
    push_travel : (m,) displacement [m] of the shoe at the point of each of these pushes, along the
        push, under actuation, other loads and heat, without contact forces
    push_compliance : (m, m) displacements at the point of each push, along the push, under a push
        of 1 N by each support [m/N]
    gap : (n,) gap between lining and drum before loading [m], less the growth of a heated shoe
    degree : polynomial degree of the triangles
    unknowns : number of unknowns of the shoe before its condensation
    friction : (n, n) friction forces on the nodes, positive towards growing theta, per unit normal
        force on each node; None if friction does not depend on the pressure
    """

    theta: Floats
    xy: Floats
    normal: Floats
    tangent: Floats
    mass: Floats
    compliance: Floats
    loaded: Floats
    elastic_actuation_work: float
    displacements_under_unit_pushes: Floats
    push_travel: Floats
    push_compliance: Floats
    gap: Floats
    degree: int
    unknowns: int
    friction: Floats | None = None


def node_numbers_along_edges(
    nodes: NodesOfTriangleMesh, tri: Ints, edge: Ints, degree: int
) -> Ints:
    """Indices (k, degree + 1) of the nodes along one edge of each of k triangles.

    `tri` (k,) are the indices of the triangles, `edge` (k,) the indices 0 to 2 of their edges.
    """
    inner = 3 + edge[:, None] * (degree - 1) + np.arange(degree - 1)
    local = np.concatenate([edge[:, None], inner, ((edge + 1) % 3)[:, None]], axis=1)
    return nodes.nodes_of_triangles[tri[:, None], local]


def edge_shape_function_values_and_derivatives(degree: int, at: Floats) -> tuple[Floats, Floats]:
    """Values and derivatives (degree + 1, q) of the shape functions of an edge at q points.

    The shape functions are Lagrange polynomials on the Gauss-Lobatto nodes of the edge. The points
    `at` (q,) lie in [0, 1] along the edge.
    """
    nodes = lagrange.lobatto_points_on_unit_interval(degree)
    V = np.linalg.inv(legendre.legvander(2 * nodes - 1, degree))
    value = legendre.legvander(2 * at - 1, degree)
    unit = np.eye(degree + 1)
    slope = np.stack([2 * legendre.legval(2 * at - 1, legendre.legder(e)) for e in unit], axis=1)
    return (value @ V).T, (slope @ V).T


def gauss_points_lengths_and_shape_functions_on_curved_edges(
    xy: Floats, degree: int
) -> tuple[Floats, Floats, Floats]:
    """Shape functions, points and lengths of a Gauss rule with q points on each of k curved edges.

    The nodes of the edges are xy (k, degree + 1, 2) [m]. Returned are the values (degree + 1, q) of
    the shape functions, the points (k, q, 2) [m], and the lengths ds (k, q) [m], which include the
    weights of the rule.
    """
    psi, slope = edge_shape_function_values_and_derivatives(degree, 0.5 + 0.5 * FACE_GAUSS)
    x, dx = (np.einsum("kac,aq->kqc", xy, values) for values in (psi, slope))
    return psi, x, np.hypot(dx[..., 0], dx[..., 1]) * 0.5 * FACE_WEIGHTS


def _nodal_forces_on_loaded_end(
    body: BodyMeshedByTriangles, force: Floats, point: Floats
) -> Floats:
    """Nodal forces (2N,) [N] on a shoe's loaded end that are equivalent to a force through a point.

    The force (2,) [N] is spread evenly over the loaded end. Tractions that grow linearly from the
    centre of the end add the couple that the force through the point (2,) [m] has about this
    centre.
    """
    # Edge number `edge[k]` of the triangle `tri[k]` lies on the loaded end of the shoe's body. The
    # ends of lining and backing are left out.
    at = body.mesh.at
    assert body.shape.loaded is not None
    on = (np.abs(at[..., 0] - body.shape.loaded) < 1e-12) & (
        at[..., 1] >= body.shape.number_of_first_layer_of_shoe_body - 1e-12
    )
    tri, edge = np.nonzero(on & np.roll(on, -1, axis=1))
    of = node_numbers_along_edges(body.nodes, tri, edge, body.degree)
    psi, x, ds = gauss_points_lengths_and_shape_functions_on_curved_edges(
        body.nodes.xy[of], body.degree
    )
    centre = np.einsum("kqc,kq->c", x, ds) / ds.sum()
    arm = x - centre
    lever = point - centre
    couple = lever[0] * force[1] - lever[1] * force[0]
    turning = (
        np.stack([-arm[..., 1], arm[..., 0]], axis=-1)
        * couple
        / float(np.einsum("kqc,kqc,kq->", arm, arm, ds))
    )
    nodal = np.einsum("aq,kqc,kq->kac", psi, force / ds.sum() + turning, ds)
    loads = np.zeros_like(body.nodes.xy)
    np.add.at(loads, of, nodal)
    return loads.ravel()


def condense_shoe_to_lining_face(
    brake: Brake, shoe: Shoe, body: BodyMeshedByTriangles
) -> ShoeCondensedToLiningFace:
    """A meshed shoe, statically condensed to the nodes of its lining's face."""
    shape, nodes, kept = body.shape, body.nodes, body.surface
    if shape.held is None:
        loads = np.zeros((2 * len(nodes.xy), 1))
    else:
        force = shoe.actuation
        loads = _nodal_forces_on_loaded_end(body, force.force_vector, force.point.xy)[:, None]
    if shoe.has_loads_besides_actuation and shape.plates:
        loads[:, 0] += nodal_forces_of_loads_besides_actuation(body, shoe)
    heat = lagrange.nodal_forces_of_heated_triangles(body.mesh, nodes, shape.layers, body.degree)
    loads = np.column_stack(
        [loads, heat, *_nodal_forces_of_one_newton_by_each_support(brake, shoe, body)]
    )
    # The nodes of the face are put in the order of growing theta.
    theta = shape.origin + shape.turn * nodes.at[kept, 0]
    kept, theta = kept[:: shape.turn], theta[:: shape.turn]
    compliance = lagrange.condense_body_to_kept_nodes(
        body.K, nodes, np.repeat(_mask_of_fixed_nodes_of_shoe(body), 2), kept, loads
    )
    er = np.stack([np.cos(theta), np.sin(theta)], axis=1)
    normal = shoe.sign_internal_plus_external_minus * er
    growth = (normal * compliance.loaded[:, 1].reshape(-1, 2)).sum(axis=1)
    return ShoeCondensedToLiningFace(
        theta=theta,
        xy=nodes.xy[kept],
        normal=normal,
        tangent=np.stack([-er[:, 1], er[:, 0]], axis=1),
        mass=_mass_matrix_of_face(body, kept, shoe.lining.width),
        compliance=compliance.under_unit_forces,
        loaded=compliance.loaded[:, 0],
        elastic_actuation_work=float(compliance.work[0, 0]),
        displacements_under_unit_pushes=compliance.loaded[:, 2:],
        push_travel=compliance.work[2:, :2].sum(axis=1),
        push_compliance=compliance.work[2:, 2:],
        gap=clearance.gaps_between_unloaded_lining_and_surface(brake, shoe, theta) - growth,
        degree=body.degree,
        unknowns=2 * len(nodes.xy),
    )


def _nodal_forces_of_one_newton_by_each_support(
    brake: Brake, shoe: Shoe, body: BodyMeshedByTriangles
) -> list[Floats]:
    """Nodal forces (2N,) [N] of a push of 1 N by each one-sided support of a shoe.

    The forces are 0 if the support pushes at the fixed end of the shoe, or if the shoe is fixed at
    its back: such a push does not deform the shoe.
    """
    loads = []
    for push in unit_forces_of_one_sided_supports_on_shoe(brake, shoe.name):
        load = np.zeros(2 * len(body.nodes.xy))
        if body.shape.held is not None and shoe.is_point_nearer_to_loaded_end_than_to_pin(
            push.point, brake.size
        ):
            load = _nodal_forces_on_loaded_end(body, push.force_vector, push.point.xy)
        loads.append(load)
    return loads


def _mask_of_fixed_nodes_of_shoe(body: BodyMeshedByTriangles) -> Bools:
    """Mark the fixed nodes of a shoe, as a mask (N,).

    A shoe with a hinged end is fixed at this end of its body. Any other shoe is fixed at its back,
    or at the part of its back that a holder grips.
    """
    shape, at = body.shape, body.nodes.at
    if shape.held is not None:
        return (np.abs(at[:, 0] - shape.held) < 1e-12) & (
            at[:, 1] > shape.number_of_first_layer_of_shoe_body - 1e-12
        )
    fixed = at[:, 1] > len(shape.layers) - 1e-12
    if shape.grip is not None:
        first, last = shape.grip
        fixed &= (at[:, 0] > first - 1e-12) & (at[:, 0] < last + 1e-12)
    return fixed


def _mass_matrix_of_face(body: BodyMeshedByTriangles, kept: Ints, width: float) -> Floats:
    """The mass matrix M (n, n) [m^2] of a lining's face: M p are the nodal forces of a pressure p.

    Parameters
    ----------
    body : the meshed shoe
    kept : indices (n,) of the nodes of the face
    width : width of the lining [m]
    """
    nodes = body.nodes
    place = np.empty(len(nodes.xy), dtype=np.int64)
    place[kept] = np.arange(len(kept))
    edges = body.mesh.indices_of_triangle_edges_on_friction_surface
    of = place[node_numbers_along_edges(nodes, *edges, body.degree)]
    psi, _, ds = gauss_points_lengths_and_shape_functions_on_curved_edges(
        nodes.xy[kept][of], body.degree
    )
    mass = np.zeros((len(kept), len(kept)))
    products = width * np.einsum("aq,bq,kq->kab", psi, psi, ds)
    np.add.at(mass, (of[:, :, None], of[:, None, :]), products)
    return mass
