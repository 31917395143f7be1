"""An elastic body: its stiffness, and its condensation to the unknowns that contact and hinge need.

Unknowns kept: the displacements c of the contact nodes and the frame f = (dx, dy, turn) of the rigid line
that the hinge holds. All others are eliminated once by a sparse factorisation K = L D L^T in which the kept
ones come last. Its last blocks are all that contact needs: with the frame held (f = 0),

    S_cc = L_cc D_c L_cc^T,   S_fc = L_fc D_c L_cc^T

so that Y = L_cc^-1 G gives the displacements' work G^T S_cc^-1 G = Y^T D_c^-1 Y under nodal forces G, and the
forces L_fc Y that hold the frame meanwhile.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.linalg
import scipy.sparse as sp
import skfem
from scipy.sparse.linalg import splu
from skfem.models.elasticity import plane_stress

from drumlin.arrays import Floats, Ints
from drumlin.brake import Material
from drumlin.errors import NoAnswer
from drumlin.fem.mesh import kind_of

FRAME = 3  # unknowns of a rigid line: dx, dy, turn about the pin


@dataclass(frozen=True)
class Condensed:
    """A body seen from its 2n contact displacements (nodes as x, y pairs by growing angle) and its frame.

    `L_cc` (2n, 2n) unit lower triangular, `D_c` (2n,) [N/m], `L_fc` (3, 2n): see above. `load_c` (2n, l) and
    `load_f` (3, l): unit loads condensed to contact and frame. `springs` (3,) were added to the frame before
    the elimination, since a free body is singular. `factors`, `ties`, `loads`: what recovers the inside.
    """

    L_cc: Floats
    D_c: Floats
    L_fc: Floats
    load_c: Floats
    load_f: Floats
    springs: Floats
    factors: Any
    ties: Any
    loads: Floats

    def half(self, forces: Floats) -> Floats:
        """Y = L_cc^-1 forces, for nodal forces (2n, m) on the contact nodes."""
        return scipy.linalg.solve_triangular(self.L_cc, forces, lower=True, unit_diagonal=True, check_finite=False)

    def displacement(self, nodal: Floats, frame: Floats, reaction: Floats, loads: Floats) -> Floats:
        """Displacement of all nodes (2, nodes) [m].

        nodal (2n,): forces on the contact nodes [N]; frame (3,): its displacement; reaction (3,): the force x, y
        and moment that hold it; loads (l,): factors of the unit loads.
        """
        right = self.loads @ loads
        right[-FRAME - len(nodal) : -FRAME] += nodal
        right[-FRAME:] += reaction + self.springs * frame
        return np.asarray((self.ties @ self.factors.solve(right)).reshape(-1, 2).T)


def scalar_basis(mesh: Any) -> Any:
    """skfem's basis of one component; quadrature of order 4 in a quadratic element, 2 in a linear."""
    element = kind_of(mesh).element()
    return skfem.Basis(mesh, element, intorder=4 if element.facet_dofs else 2)


def stiffness(basis: Any, materials: Mapping[str, tuple[Material, float]]) -> Any:
    """Plane-stress stiffness (2 nodes, 2 nodes), unknown 2 i + c for component c of node i [N/m].

    materials: subdomain -> (material, width [m]).

        K_ai,bj = b Int lambda psi_a,i psi_b,j + mu psi_a,j psi_b,i + mu delta_ij psi_a,k psi_b,k dA

    The gradients of all shape functions meet in one batched matrix product an element, instead of one
    form evaluation a pair of shape functions.
    """
    lame = np.zeros((2, basis.mesh.nelements))
    for name, elements in basis.mesh.subdomains.items():
        material, width = materials[name]
        lame[:, elements] = np.array(plane_stress(material.E, material.nu))[:, None] * width
    lam, mu = lame[:, :, None, None, None, None]
    gradients = np.array([psi[0].grad for psi in basis.basis])  # (a, i, elements, points)
    a, _, elements, points = gradients.shape
    G = np.ascontiguousarray(gradients.transpose(2, 0, 1, 3)).reshape(elements, 2 * a, points)
    H = (G * basis.dx[:, None, :] @ G.transpose(0, 2, 1)).reshape(elements, a, 2, a, 2)  # Int psi_a,i psi_b,j
    K = lam * H + mu * H.transpose(0, 1, 4, 3, 2)
    for i in range(2):
        K[:, :, i, :, i] += mu[:, :, 0, :, 0] * np.trace(H, axis1=2, axis2=4)
    dofs = (2 * basis.element_dofs.T[:, :, None] + np.arange(2)).reshape(elements, 2 * a).astype(np.int32)
    rows = np.broadcast_to(dofs[:, :, None], (elements, 2 * a, 2 * a))
    columns = np.broadcast_to(dofs[:, None, :], rows.shape)
    return sp.coo_matrix((K.ravel(), (rows.ravel(), columns.ravel())), shape=(2 * basis.N, 2 * basis.N)).tocsc()


def dissection(xy: Floats, elements: Ints) -> Ints:
    """Nodes in the order of a nested dissection: elimination in this order keeps the factors sparse.

    xy (2, n) [m]; elements (k, m): nodes of each element. The elements are halved again and again across
    the long direction of their region; a node belongs to the smallest region that holds all its elements,
    and comes after all nodes of the regions inside that one.
    """
    centre = xy[:, elements].mean(axis=1)
    count = elements.shape[1]
    region = np.zeros(count, dtype=np.int64)  # binary path of halvings
    depth = max(0, int(np.ceil(np.log2(count))))
    resolution = 1e-9 * float(np.ptp(centre, axis=1).max()) or 1.0
    for level in range(depth):
        size = np.bincount(region, minlength=1 << level)

        dx, dy = centre - _means(region, centre)
        xy_, xx_yy = _means(region, np.array([dx * dy, dx * dx - dy * dy]))
        along = 0.5 * np.arctan2(2 * xy_, xx_yy)  # principal axis
        place = np.round((dx * np.cos(along) + dy * np.sin(along)) / resolution)
        order = np.lexsort((place, region))
        rank = np.empty(count, dtype=np.int64)
        rank[order] = np.arange(count) - (np.cumsum(size) - size)[region[order]]
        region = 2 * region + (rank >= (size[region] + 1) // 2)
    first = np.full(xy.shape[1], 1 << depth)
    last = np.full(xy.shape[1], -1)
    for nodes in elements:
        np.minimum.at(first, nodes, region)
        np.maximum.at(last, nodes, region)
    height = np.ceil(np.log2((first ^ last) + 1.0)).astype(np.int64)  # levels up to the common region
    return np.lexsort((height, (first >> height << height) + (1 << height)))


def _means(group: Ints, values: Floats) -> Floats:
    """Mean of each row of `values` (k, m) over the members of a member's group (m,): (k, m)."""
    size = np.bincount(group)
    return np.array([(np.bincount(group, row) / np.maximum(size, 1))[group] for row in values])


def tie(basis: Any, contact: Ints, rigid: Ints, pin: Floats, alone: Ints | None = None) -> Any:
    """Sparse matrix (2 nodes, unknowns) from the reduced unknowns to the displacements of all nodes.

    Unknowns: inner nodes in dissection order, contact nodes, then the frame: the `rigid` nodes move with
    u = (dx, dy) + turn k x (x - pin). Without rigid nodes three unknowns `alone` (3,) stand in their place.
    """
    order = dissection(basis.doflocs, basis.element_dofs)
    inner = np.ones(basis.N, dtype=bool)
    inner[contact] = inner[rigid] = False
    nodes = np.concatenate([order[inner[order]], contact])
    dofs = np.column_stack([2 * nodes, 2 * nodes + 1]).ravel()
    if alone is not None:
        dofs = np.concatenate([dofs[~np.isin(dofs, alone)], alone])
        return sp.csc_matrix((np.ones(len(dofs)), (dofs, np.arange(len(dofs)))), shape=(2 * basis.N, len(dofs)))
    frame = np.arange(len(dofs), len(dofs) + FRAME)
    x, y = basis.doflocs[:, rigid] - pin[:, None]
    ones = np.ones(len(rigid))
    rows = [dofs, 2 * rigid, 2 * rigid, 2 * rigid + 1, 2 * rigid + 1]
    columns = [np.arange(len(dofs)), *(np.full(len(rigid), frame[k]) for k in (0, 2, 1, 2))]
    values = [np.ones(len(dofs)), ones, -y, ones, x]
    entries = np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))
    return sp.csc_matrix(entries, shape=(2 * basis.N, len(dofs) + FRAME))


def condense(K: Any, ties: Any, loads: Floats, contact: int) -> Condensed:
    """Eliminate all but the last `contact` + 3 unknowns.

    K (2 nodes, 2 nodes): stiffness; ties (2 nodes, unknowns); loads (unknowns, l): unit loads.
    """
    A = (ties.T @ K @ ties).tocsc()
    inner = A.shape[0] - contact - FRAME
    springs = A.diagonal()[-FRAME:]
    padded = np.concatenate([np.zeros(inner + contact), springs])
    # Symmetric positive definite: pivots stay on the diagonal, the order stays ours.
    try:
        factors = splu(
            A + sp.diags_array(padded, format="csc"),
            permc_spec="NATURAL",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
    except RuntimeError as error:  # a zero pivot
        raise NoAnswer("singular stiffness: a part hangs on nothing, or moduli are too far apart") from error
    last = factors.L[:, inner:][inner:].toarray()
    diagonal = factors.U.diagonal()[inner:]
    L_cc, L_fc, D_c = last[:contact, :contact], last[contact:, :contact], diagonal[:contact]
    # L D L^T x = load: what the elimination leaves of the load on the kept unknowns is L_kk D_k L_kk^T x_k.
    left = diagonal[:, None] * (last.T @ factors.solve(loads)[inner:])
    condensed = last @ left
    return Condensed(L_cc, D_c, L_fc, condensed[:contact], condensed[contact:], springs, factors, ties, loads)
