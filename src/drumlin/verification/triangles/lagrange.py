"""Curved triangles of any degree in plane stress, and static condensation of a mesh to some nodes.

The shape functions are Lagrange polynomials on nodes that are Gauss-Lobatto points on each edge.
The geometry of a triangle is interpolated on the same nodes. The condensation eliminates all other
unknowns by dense Cholesky factors, one part of the mesh after another (multifrontal elimination).
"""

from dataclasses import dataclass
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre
from scipy.linalg import inv, solve_triangular
from scipy.linalg.lapack import dpotrf
from skfem.quadrature import get_quadrature_tri

from drumlin.base.arrays import Bools, Floats, Ints
from drumlin.base.errors import NoAnswer
from drumlin.brake.elasticity import ElasticLayer, which_elasticity_matrices_are_orthotropic
from drumlin.verification.triangles.triangulation import (
    FunctionFromBodyCoordinatesToPoints,
    LayerOfTriangulatedBody,
    TriangleMeshInBodyCoordinates,
    edges_of_mesh_and_of_each_triangle,
)

MOST_TRIANGLES_ELIMINATED_WITHOUT_HALVING = 8
"""Number of triangles up to which a part of the mesh is eliminated without being halved again.

With a smaller number there are more calls of LAPACK, with a larger one there is more arithmetic."""


@cache
def lobatto_points_on_unit_interval(degree: int) -> Floats:
    """The Gauss-Lobatto points (degree + 1,) on [0, 1]."""
    inner = legendre.Legendre.basis(degree).deriv().roots() if degree > 1 else np.zeros(0)
    return 0.5 + 0.5 * np.concatenate([[-1.0], np.sort(np.real(inner)), [1.0]])


@cache
def nodes_of_reference_triangle(degree: int) -> Floats:
    """Barycentric coordinates (n, 3) of the nodes of a triangle.

    The corners 0, 1, 2 come first, then the nodes on the edges 01, 12, 20, in the sense from the
    first to the second corner of the edge, then the nodes inside the triangle.
    """
    x = lobatto_points_on_unit_interval(degree)[1:-1]
    zero = 0 * x
    edges = [
        np.stack([1 - x, x, zero], 1),
        np.stack([zero, 1 - x, x], 1),
        np.stack([x, zero, 1 - x], 1),
    ]
    # The barycentric coordinates of an inner node are proportional to the Gauss-Lobatto points
    # number i, j and k on [0, 1], with i + j + k = degree, and have the sum 1.
    full = lobatto_points_on_unit_interval(degree)
    inside = []
    for i in range(1, degree):
        for j in range(1, degree - i):
            inside.append((full[i], full[j], full[degree - i - j]))
    inner = np.array(inside).reshape(-1, 3)
    return np.concatenate([np.eye(3), *edges, inner / inner.sum(axis=1, keepdims=True)])


def _legendre_products_and_slopes(
    degree: int, x: Floats, y: Floats
) -> tuple[Floats, Floats, Floats]:
    """Products P_i(x) P_j(y) of Legendre polynomials with i + j <= degree, and their derivatives.

    Returned are three arrays (n, points): the n products, their derivatives by x, and by y. The
    polynomials are the shifted Legendre polynomials on [0, 1].
    """
    of_x, slope_of_x = _legendre_polynomials_and_slopes(degree, x)
    of_y, slope_of_y = _legendre_polynomials_and_slopes(degree, y)
    products, slopes_by_x, slopes_by_y = [], [], []
    for i in range(degree + 1):
        for j in range(degree + 1 - i):
            products.append(of_x[i] * of_y[j])
            slopes_by_x.append(slope_of_x[i] * of_y[j])
            slopes_by_y.append(of_x[i] * slope_of_y[j])
    return np.array(products), np.array(slopes_by_x), np.array(slopes_by_y)


def _legendre_polynomials_and_slopes(degree: int, x: Floats) -> tuple[Floats, Floats]:
    """The values (degree + 1, points) of the Legendre polynomials on [0, 1], and their slopes."""
    at = 2 * np.asarray(x) - 1
    slopes = []
    for coefficients in np.eye(degree + 1):
        slopes.append(2 * legendre.legval(at, legendre.legder(coefficients)))
    values = np.asarray(legendre.legvander(at, degree).T, dtype=float)
    return values, np.array(slopes)


@cache
def triangle_shape_functions_gradients_and_weights(degree: int) -> tuple[Floats, Floats, Floats]:
    """Shape functions of the reference triangle at the q points of a quadrature rule.

    Returned are the values (n, q), the gradients (n, 2, q) and the weights (q,) of the rule. The
    rule is exact for polynomials of twice the degree.
    """
    nodes = nodes_of_reference_triangle(degree)
    X, W = get_quadrature_tri(2 * degree)
    at_nodes, _, _ = _legendre_products_and_slopes(degree, nodes[:, 1], nodes[:, 2])
    value, dx, dy = _legendre_products_and_slopes(degree, X[0], X[1])
    inverse = np.linalg.inv(at_nodes)
    return inverse @ value, np.stack([inverse @ dx, inverse @ dy], axis=1), W


@dataclass(frozen=True)
class NodesOfTriangleMesh:
    """The N nodes of a mesh of m triangles.

    Attributes
    ----------
    nodes_of_triangles : (m, n) indices of the nodes of each triangle
    at : (N, 2) coordinates s and d of each node; at a node where the grid of a closed ring begins
        and ends, s is one of its two values
    xy : (N, 2) positions of the nodes [m]
    """

    nodes_of_triangles: Ints
    at: Floats
    xy: Floats


def nodes_of_triangle_mesh_of_given_degree(
    mesh: TriangleMeshInBodyCoordinates, place: FunctionFromBodyCoordinatesToPoints, degree: int
) -> NodesOfTriangleMesh:
    """The nodes of a mesh of triangles of a polynomial degree: at corners, on edges and inside."""
    edges, of_edge = edges_of_mesh_and_of_each_triangle(mesh)
    corners = int(mesh.vertices.max()) + 1
    inner = degree - 1
    m = len(mesh.vertices)
    parts = [mesh.vertices]
    # The nodes on an edge are numbered from its end with the smaller number, so that both triangles
    # at the edge give its nodes the same numbers.
    for e in range(3):
        first, last = mesh.vertices[:, e], mesh.vertices[:, (e + 1) % 3]
        along = np.where((first < last)[:, None], np.arange(inner), np.arange(inner)[::-1])
        parts.append(corners + of_edge[:, e : e + 1] * inner + along)
    n = (degree + 1) * (degree + 2) // 2
    inside = n - 3 * degree
    parts.append(corners + len(edges) * inner + np.arange(m)[:, None] * inside + np.arange(inside))
    of = np.concatenate(parts, axis=1)
    used, of = np.unique(of, return_inverse=True)
    of = of.reshape(m, n)
    at = np.zeros((len(used), 2))
    at[of] = np.einsum("nk,mkc->mnc", nodes_of_reference_triangle(degree), mesh.at)
    return NodesOfTriangleMesh(of, at, place(at[:, 0], at[:, 1]))


def triangle_stiffness_matrices(
    mesh: TriangleMeshInBodyCoordinates,
    nodes: NodesOfTriangleMesh,
    layers: list[LayerOfTriangulatedBody],
    degree: int,
) -> Floats:
    """The plane-stress stiffness matrices (m, 2n, 2n) of m triangles of n nodes [N/m].

    Unknown 2 i + c of a triangle is component c of the displacement of its node i.
    """
    values, slopes, weights = triangle_shape_functions_gradients_and_weights(degree)
    matrices = np.array([layer.elastic.elasticity_times_width for layer in layers])
    directed = which_elasticity_matrices_are_orthotropic(matrices)
    n = slopes.shape[0]
    found = np.empty((len(mesh.layer), 2 * n, 2 * n))
    # Some 2000 triangles are integrated at once, which bounds the memory.
    for part in np.array_split(np.arange(len(mesh.layer)), max(1, len(mesh.layer) // 2000)):
        x = nodes.xy[nodes.nodes_of_triangles[part]]  # (m, n, 2)
        J = np.einsum("mnc,ndq->mqcd", x, slopes)
        det = J[..., 0, 0] * J[..., 1, 1] - J[..., 0, 1] * J[..., 1, 0]
        if (det * np.sign(det[:, :1]) <= 0).any():
            raise AssertionError("a triangle is turned over")
        cofactors = [J[..., 1, 1], -J[..., 0, 1], -J[..., 1, 0], J[..., 0, 0]]
        inverse = np.stack(cofactors, -1).reshape(J.shape)
        # G[m, n, c, q] is the derivative of shape function n by coordinate c, in triangle m at
        # quadrature point q.
        G = np.einsum("ndq,mqdc->mncq", slopes, inverse / det[..., None, None])
        lam, mu = matrices[mesh.layer[part]][:, [0, 2], [1, 2]].T
        H = np.einsum("mncq,mq,mkdq->mnckd", G, np.abs(det) * weights, G, optimize=True)
        lam, turned = lam[:, None, None, None, None], H.transpose(0, 1, 4, 3, 2)
        K = lam * H + mu[:, None, None, None, None] * turned
        same = mu[:, None, None] * (H[:, :, 0, :, 0] + H[:, :, 1, :, 1])
        K[:, :, 0, :, 0] += same
        K[:, :, 1, :, 1] += same
        found[part] = K.reshape(len(part), 2 * n, 2 * n)
        # Triangles in orthotropic layers get the stiffness in the directions of their layer.
        for number in np.flatnonzero(directed):
            own = np.flatnonzero(mesh.layer[part] == number)
            points = np.einsum("mnc,nq->cmq", x[own], values)
            area = np.abs(det[own]) * weights
            found[part[own]] = _stiffness_matrices_of_orthotropic_triangles(
                G[own], area, layers[number].elastic, points
            )
    return found


def _stiffness_matrices_of_orthotropic_triangles(
    G: Floats, area: Floats, layer: ElasticLayer, points: Floats
) -> Floats:
    """Stiffness matrices (m, 2n, 2n) of triangles in an orthotropic layer [N/m].

    The stiffness is the integral of B^T Q^T D Q B. The matrix Q takes strains in x and y to strains
    in the layer's directions (Cook et al., Concepts and Applications of Finite Element Analysis,
    section 8.2).

    Parameters
    ----------
    G : (m, n, 2, q) gradients of the shape functions at the quadrature points [1/m]
    area : (m, q) quadrature weights times the Jacobian determinant [m^2]
    layer : elastic constants and directions of the layer
    points : (2, m, q) quadrature points [m]
    """
    m, n, _, q = G.shape
    c, s = layer.unit_vectors_along_layer(points)
    turn = np.array(
        [[c * c, s * s, c * s], [s * s, c * c, -c * s], [-2 * c * s, 2 * c * s, c * c - s * s]]
    )
    D = np.einsum("ikmq,ij,jlmq->mqkl", turn, layer.elasticity_times_width, turn)
    B = np.zeros((m, q, 3, n, 2))
    B[:, :, 0, :, 0] = B[:, :, 2, :, 1] = G[:, :, 0].transpose(0, 2, 1)
    B[:, :, 1, :, 1] = B[:, :, 2, :, 0] = G[:, :, 1].transpose(0, 2, 1)
    B = B.reshape(m, q, 3, 2 * n)
    stressed = (D * area[..., None, None]) @ B
    return np.asarray(B.reshape(m, -1, 2 * n).transpose(0, 2, 1) @ stressed.reshape(m, -1, 2 * n))


def nodal_forces_of_heated_triangles(
    mesh: TriangleMeshInBodyCoordinates,
    nodes: NodesOfTriangleMesh,
    layers: list[LayerOfTriangulatedBody],
    degree: int,
) -> Floats:
    """Nodal forces (2N,) [N] that deform unloaded triangles by the free strains of heated layers.

    The forces are the integral of B^T Q^T D eps_0 (Cook et al., Concepts and Applications of Finite
    Element Analysis, section 8.2), with the free strains eps_0 in the directions of the layer. The
    free strains are linear across the thickness of the layer. N is the number of nodes.
    """
    values, slopes, weights = triangle_shape_functions_gradients_and_weights(degree)
    forces = np.zeros_like(nodes.xy)
    for number, layer in enumerate(layers):
        if layer.free_strains is None:
            continue
        of = nodes.nodes_of_triangles[mesh.layer == number]
        x = nodes.xy[of]
        J = np.einsum("mnc,ndq->mqcd", x, slopes)
        G = np.einsum("ndq,mqdc->mncq", slopes, np.linalg.inv(J))
        area = np.abs(np.linalg.det(J)) * weights
        points = np.einsum("mnc,nq->cmq", x, values)
        # The coordinate d counts the layers from the friction surface. In this layer d rises
        # from `number` to `number` + 1; the near face of the layer is the face at `number`.
        through = np.einsum("mn,nq->mq", nodes.at[of, 1], values) - number
        near, far = layer.free_strains[:, :, None, None].swapaxes(0, 1)
        strains = near + (far - near) * through
        strains = np.concatenate([strains, np.zeros_like(strains[:1])])
        along, across, shear = np.einsum(
            "ij,jmq->imq", layer.elastic.elasticity_times_width, strains
        )
        c, s = layer.elastic.unit_vectors_along_layer(points)
        # The stress is transformed from the directions of the layer into the components xx, yy and
        # xy.
        xx = c * c * along + s * s * across - 2 * c * s * shear
        yy = s * s * along + c * c * across + 2 * c * s * shear
        xy = c * s * (along - across) + (c * c - s * s) * shear
        stress = np.array([[xx, xy], [xy, yy]])
        np.add.at(forces, of, np.einsum("cdmq,mndq,mq->mnc", stress, G, area))
    return forces.ravel()


@dataclass(frozen=True)
class ComplianceOfCondensedBody:
    """The compliance of a body that is statically condensed to n kept nodes.

    Attributes
    ----------
    under_unit_forces : (2n, 2n) displacements of the kept nodes under unit forces on them [m/N]
    loaded : (2n, l) displacements of the kept nodes under each of l loads on the body [m]
    work : (l, l) work of each of the l loads on the displacements due to each of the l loads [N m]
    """

    under_unit_forces: Floats
    loaded: Floats
    work: Floats


class CondensedStiffnessOfBodyPart(NamedTuple):
    """The stiffness of a part of a body, condensed to the unknowns that are not eliminated yet.

    Attributes
    ----------
    dofs : (k,) indices of the remaining unknowns, in growing order. An unknown remains because it
        belongs to a kept node or to triangles of parts that are not added yet.
    triangles : (k,) number of triangles of the part around each remaining unknown
    K : (k, k) stiffness [N/m]
    loads : (k, l) l loads on the remaining unknowns [N]
    work : (l, l) work of the loads on the eliminated unknowns [N m]
    """

    dofs: Ints
    triangles: Ints
    K: Floats
    loads: Floats
    work: Floats


class _BodyToCondense(NamedTuple):
    """A meshed body and its loads, as the elimination of its unknowns needs them.

    Attributes
    ----------
    K : (m, 2n, 2n) stiffness of each triangle [N/m]
    dofs : (m, 2n) indices of the unknowns of each triangle
    centres : (m, 2) centre of the nodes of each triangle [m]
    held : (2N,) whether a displacement is fixed to 0
    triangles : (2N,) number of triangles around each unknown. For an unknown that is kept the
        number is one too large: the elimination then never finds all of its triangles and keeps it.
    loads : (2N, l) nodal forces of l loads [N], 0 at fixed displacements
    """

    K: Floats
    dofs: Ints
    centres: Floats
    held: Bools
    triangles: Ints
    loads: Floats


def condense_body_to_kept_nodes(
    K: Floats, nodes: NodesOfTriangleMesh, held: Bools, kept: Ints, loads: Floats
) -> ComplianceOfCondensedBody:
    """Condense a body statically to the nodes `kept`; returns their compliance.

    The set of triangles is cut into halves across its longer side, and the halves are cut again.
    The parts are then assembled in the reverse order. An unknown is eliminated, by dense Cholesky
    factors, as soon as all triangles around it are assembled.

    Parameters
    ----------
    K : (m, 2n, 2n) stiffness of each triangle [N/m]
    nodes : nodes of the triangles
    held : (2N,) whether a displacement is fixed to 0
    kept : indices of the nodes that remain
    loads : (2N, l) nodal forces of l loads [N]

    Raises
    ------
    NoAnswer
        If the stiffness of a part is singular.
    """
    dofs = (2 * nodes.nodes_of_triangles[:, :, None] + np.arange(2)).reshape(
        len(nodes.nodes_of_triangles), -1
    )
    kept_dofs = (2 * kept[:, None] + np.arange(2)).ravel()
    triangles = np.bincount(dofs.ravel(), minlength=2 * len(nodes.xy))
    triangles[kept_dofs] += 1
    centres = nodes.xy[nodes.nodes_of_triangles].mean(axis=1)
    loads = np.where(held[:, None], 0.0, loads)
    whole = _schur_complement_of_triangles(
        _BodyToCondense(K, dofs, centres, held, triangles, loads), np.arange(len(centres))
    )
    # Only the unknowns of the kept nodes are left, in growing order.
    at = np.searchsorted(whole.dofs, kept_dofs)
    S, f = whole.K[np.ix_(at, at)], whole.loads[at] + loads[kept_dofs]
    compliance = inv(0.5 * (S + S.T))
    compliance = 0.5 * (compliance + compliance.T)
    loaded = compliance @ f
    return ComplianceOfCondensedBody(compliance, loaded, whole.work + f.T @ loaded)


def _schur_complement_of_triangles(
    body: _BodyToCondense, members: Ints
) -> CondensedStiffnessOfBodyPart:
    """The Schur complement of the part of the body with the triangles of indices `members`."""
    # A small part is assembled from its triangles, a larger one from its two halves.
    if len(members) <= MOST_TRIANGLES_ELIMINATED_WITHOUT_HALVING:
        parts = [
            _stiffness_of_single_triangle_as_body_part(body, triangle)
            for triangle in members.tolist()
        ]
    else:
        x = body.centres[members]
        # The part is cut across the longer side of its bounding box.
        longer = int(np.argmax(np.ptp(x, axis=0)))
        order = members[np.argsort(x[:, longer], kind="stable")]
        half = len(order) // 2
        parts = [
            _schur_complement_of_triangles(body, order[:half]),
            _schur_complement_of_triangles(body, order[half:]),
        ]
    return _assemble_parts_and_eliminate_inner_unknowns(body, parts)


def _stiffness_of_single_triangle_as_body_part(
    body: _BodyToCondense, triangle: int
) -> CondensedStiffnessOfBodyPart:
    """The stiffness of one triangle as a part of a body, without fixed unknowns and loads."""
    dofs = body.dofs[triangle]
    on = ~body.held[dofs]
    count, columns = int(on.sum()), body.loads.shape[1]
    return CondensedStiffnessOfBodyPart(
        dofs[on],
        np.ones(count, dtype=int),
        body.K[triangle][np.ix_(on, on)],
        np.zeros((count, columns)),
        np.zeros((columns, columns)),
    )


def _assemble_parts_and_eliminate_inner_unknowns(
    body: _BodyToCondense, parts: list[CondensedStiffnessOfBodyPart]
) -> CondensedStiffnessOfBodyPart:
    """Assemble parts of the body and eliminate the unknowns that no other part shares."""
    dofs, where = np.unique(np.concatenate([part.dofs for part in parts]), return_inverse=True)
    triangles = np.bincount(where, np.concatenate([part.triangles for part in parts])).astype(int)
    # An unknown can be eliminated if all triangles around it are in the parts that are joined
    # here. The n unknowns to eliminate come first in the stiffness S and the loads f.
    gone = triangles == body.triangles[dofs]
    n = int(gone.sum())
    order = np.argsort(~gone, kind="stable")
    place = np.argsort(order)
    S = np.zeros((len(order), len(order)))
    f = np.zeros((len(order), body.loads.shape[1]))
    for part in parts:
        at = place[np.searchsorted(dofs, part.dofs)]
        S[at[:, None], at] += part.K
        f[at] += part.loads
    f[:n] += body.loads[dofs[gone]]
    work = np.sum([part.work for part in parts], axis=0)
    assembled = CondensedStiffnessOfBodyPart(dofs[order], triangles[order], S, f, work)
    return _eliminate_first_unknowns_of_body_part(assembled, n)


def _eliminate_first_unknowns_of_body_part(
    part: CondensedStiffnessOfBodyPart, n: int
) -> CondensedStiffnessOfBodyPart:
    """Eliminate the first n unknowns of a part of a body.

    The Schur complement is S22 - S21 S11^-1 S12, with the Cholesky factor L of S11 = L L^T. Raises
    NoAnswer if S11 is singular.
    """
    if n == 0:
        return part
    S, f = part.K, part.loads
    L, info = dpotrf(S[:n, :n], lower=1, clean=0)
    if info:
        raise NoAnswer("singular stiffness")
    Y = solve_triangular(L, np.hstack([S[:n, n:], f[:n]]), lower=True, check_finite=False)
    coupled, loaded = Y[:, : len(S) - n], Y[:, len(S) - n :]
    return CondensedStiffnessOfBodyPart(
        part.dofs[n:],
        part.triangles[n:],
        S[n:, n:] - coupled.T @ coupled,
        f[n:] - coupled.T @ loaded,
        part.work + loaded.T @ loaded,
    )
