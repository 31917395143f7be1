"""An elastic body: its stiffness, and its condensation to the unknowns that contact and hinge need.

Unknowns kept: the displacements c of the contact nodes and the frame f = (dx, dy, turn) of the
rigid line that the hinge holds. All others are eliminated once. With the frame held (f = 0) and
S_cc = L_cc L_cc^T, Y = L_cc^-1 G gives the work G^T S_cc^-1 G = Y^T Y of nodal forces G, and L_fc
Y, with L_fc = S_fc L_cc^-T, the forces that hold the frame meanwhile.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.base.errors import NoAnswer
from drumlin.base.lapack import dpotrf, solve_lower
from drumlin.brake.elasticity import ElasticLayer, has_directions
from drumlin.fem.mesh.arc import kind_of
from drumlin.fem.substructure.elasticity import across, split
from drumlin.fem.substructure.elimination import SINGULAR_BODY, dissection, eliminate, solve
from drumlin.fem.substructure.loads import LoadColumns, stacked_loads

FRAME = 3  # unknowns of a rigid line: dx, dy, turn about the pin


class Constraints(NamedTuple):
    """Reduced unknowns of a body: `matrix` (2 nodes, unknowns) from them to the displacements of
    all nodes, and the `region` of elimination of each inner one. Order: inner, contact nodes as x,
    y pairs by growing angle, frame.
    """

    matrix: Any
    region: Ints


class InnerSystem(NamedTuple):
    """Stiffness `A` on the reduced unknowns `constraints`, and the unit loads (unknowns, l) on them."""

    A: Any
    constraints: Constraints
    loads: Floats

    def displacements(self, nodal: Floats, frame: Floats, loads: Floats) -> Floats:
        """Displacements (2 nodes, m) [m]; see `CondensedBody.displacements`."""
        right = self.loads[:-FRAME] @ loads - self.A[:-FRAME, -FRAME:] @ frame
        right[len(right) - len(nodal) :] += nodal
        u = solve(self.A[:-FRAME, :-FRAME], self.constraints.region, right)
        return np.asarray(self.constraints.matrix @ np.vstack([u, frame]))


@dataclass(frozen=True)
class CondensedBody:
    """A body seen from its 2n contact displacements and its frame.

    `L_cc` (2n, 2n) lower triangular, `L_fc` (3, 2n): see above. `load_on_contact` (2n, l) and `load_on_frame` (3,
    l): unit loads condensed to contact and frame; `load_work` (l, l): their work with both held;
    `columns`: which of the l columns is which load.
    `inside`: makes, where it is asked for, the whole system; `recover`: solves it, see
    `displacements`. `lost`: by how much round-off of the elimination puts a unit force out of
    balance, and `moved` (2n, 3): how far it moves the contact [m] as the frame moves by one; as far
    as known.
    """

    L_cc: Floats
    L_fc: Floats
    load_on_contact: Floats
    load_on_frame: Floats
    load_work: Floats
    inside: Callable[[], InnerSystem]
    recover: Callable[[Floats, Floats, Floats], Floats]
    columns: LoadColumns
    force_imbalance: float = 0.0
    rigid_mode_error: Floats | None = None

    @property
    def constraints(self) -> Constraints:
        """The reduced unknowns."""
        return self.inside().constraints

    @property
    def loads(self) -> Floats:
        """The unit loads (unknowns, l) on the reduced unknowns."""
        return self.inside().loads

    def half(self, forces: Floats) -> Floats:
        """Y = L_cc^-1 forces, for nodal forces (2n, m) on the contact nodes."""
        return solve_lower(self.L_cc, forces)

    def displacement(self, nodal: Floats, frame: Floats, loads: Floats) -> Floats:
        """Displacement of all nodes (2, nodes) [m], by an elimination of the inside that is
        substituted back.

        nodal (2n,): forces on the contact nodes [N]; frame (3,): its displacement; loads (l,):
        factors of the unit loads.
        """
        u = self.displacements(nodal[:, None], frame[:, None], loads[:, None])
        return np.asarray(u.reshape(-1, 2).T)

    def displacements(self, nodal: Floats, frame: Floats, loads: Floats) -> Floats:
        """Displacements (2 nodes, m) [m] of m cases: nodal (2n, m), frame (3, m), loads (l, m) as
        above.
        """
        return self.recover(nodal, frame, loads)


def scalar_basis(mesh: Any) -> Any:
    """skfem's basis of one component; quadrature of order 4 in a quadratic element, 2 in a linear."""
    import skfem  # noqa: PLC0415  (meshes alone load it)

    element = kind_of(mesh).element()
    return skfem.Basis(mesh, element, intorder=4 if element.facet_dofs else 2)


def stiffness(basis: Any, layers: Mapping[str, ElasticLayer], *, precise: bool = False) -> Any:
    """Stiffness (d nodes, d nodes) of plane stress, d = 2, or of a solid, d = 3; unknown d i + c
    for component c of node i [N/m].

    layers: by subdomain; those of a solid are isotropic; precise: in long double, from the nodes on
    (plane stress only).

        K_ai,bj = b Int lambda psi_a,i psi_b,j + mu psi_a,j psi_b,i + mu delta_ij psi_a,k psi_b,k dA

    and what layers are stiffer in their own directions, see `hp.element.stiffness`. The gradients
    of all shape functions meet in one batched matrix product an element, instead of one form
    evaluation a pair of shape functions.
    """
    if hasattr(basis, "stiffness"):  # a grid of columns knows its own
        return basis.stiffness(layers, precise=precise)
    import scipy.sparse as sp  # noqa: PLC0415  (meshes alone load it)

    gradients, dx = (
        _precise_gradients(basis)
        if precise
        else (np.array([psi[0].grad for psi in basis.basis]), basis.dx)
    )  # (a, i, elements, points), (elements, points)
    a, d, elements, points = gradients.shape
    lame = np.zeros((2, basis.mesh.nelements))
    for name, members in basis.mesh.subdomains.items():
        matrix = layers[name].stiffness
        lame[:, members] = np.array([matrix[0, 1], matrix[-1, -1]])[:, None]
    lam, mu = lame[:, :, None, None, None, None]
    G = np.ascontiguousarray(gradients.transpose(2, 0, 1, 3)).reshape(elements, d * a, points)
    H = (G * dx[:, None, :] @ G.transpose(0, 2, 1)).reshape(
        elements, a, d, a, d
    )  # Int psi_a,i psi_b,j
    K = lam * H + mu * H.transpose(0, 1, 4, 3, 2)
    for i in range(d):
        K[:, :, i, :, i] += mu[:, :, 0, :, 0] * np.trace(H, axis1=2, axis2=4)
    for name, members in basis.mesh.subdomains.items():
        if d == 2 and has_directions(layers[name].elasticity):
            own = gradients[:, :, members]
            K[members] += _stiffer(
                layers[name], own, dx[members], points_of(basis, precise=precise)[:, members]
            )
    dofs = (
        (d * basis.element_dofs.T[:, :, None] + np.arange(d))
        .reshape(elements, d * a)
        .astype(np.int32)
    )
    rows = np.broadcast_to(dofs[:, :, None], (elements, d * a, d * a))
    columns = np.broadcast_to(dofs[:, None, :], rows.shape)
    return sp.coo_matrix(
        (K.ravel(), (rows.ravel(), columns.ravel())), shape=(d * basis.N, d * basis.N)
    ).tocsc()


def values_of(basis: Any, *, precise: bool = False) -> Any:
    """The shape functions (a, points) of a basis on a mesh at its points of quadrature; precise: in
    long double."""
    at = basis.X.astype(np.longdouble) if precise else basis.X
    return np.array([basis.elem.lbasis(at, i)[0] for i in range(len(basis.element_dofs))])


def points_of(basis: Any, *, precise: bool = False) -> Any:
    """The points of quadrature (2, elements, points) [m] of a basis on a mesh; precise: in long
    double."""
    return np.einsum(
        "cae,aq->ceq", basis.doflocs[:, basis.element_dofs], values_of(basis, precise=precise)
    )


def _stiffer(layer: ElasticLayer, gradients: Any, dx: Any, points: Any) -> Any:
    """What elements (e, a, 2, a, 2) are stiffer in the directions of their layer than its isotropic
    part [N/m].

    gradients (a, 2, e, q) of the shape functions [1/m], areas dx (e, q) [m^2], points (2, e, q)
    [m].
    """
    a, d, elements, _ = gradients.shape
    along = layer.directions(points)

    def work(direction: Any) -> Any:
        """Of the stretches in a direction (2, e, q) by unit displacements, (e, d a, d a)."""
        grown = np.einsum("ceq,aceq->aeq", direction, gradients)
        stretch = np.einsum("ceq,aeq->eacq", direction, grown).reshape(elements, d * a, -1)
        return (stretch * dx[:, None]) @ stretch.transpose(0, 2, 1)

    _, _, by_along, by_through = split(layer.stiffness)
    found = by_along * work(along) + by_through * work(across(along))
    return found.reshape(elements, a, d, a, d)


def _precise_gradients(basis: Any) -> tuple[Any, Any]:
    """Gradients (a, 2, elements, points) of the shape functions and area weights (elements,
    points), long double.

    The elements are isoparametric: the nodes of the shape functions are those of the map.
    """
    at = basis.X.astype(np.longdouble)
    count = basis.element_dofs.shape[0]
    slopes = np.array([basis.elem.lbasis(at, i)[1] for i in range(count)])  # (a, 2, points)
    nodes = basis.doflocs.astype(np.longdouble)[:, basis.element_dofs]  # (2, a, elements)
    J = np.einsum("caj,adq->cdjq", nodes, slopes)
    det = J[0, 0] * J[1, 1] - J[0, 1] * J[1, 0]
    inverse = np.array([[J[1, 1], -J[0, 1]], [-J[1, 0], J[0, 0]]]) / det
    return np.einsum("adq,dcjq->acjq", slopes, inverse), np.abs(det) * basis.W


def constrain(
    basis: Any, contact: Ints, rigid: Ints, pin: Floats, alone: Ints | None = None
) -> Constraints:
    """The reduced unknowns: inner nodes in the order of a dissection, contact nodes, then the
    frame.

    The `rigid` nodes move with u = (dx, dy) + turn k x (x - pin). Without rigid nodes three
    unknowns `alone` (3,) of other nodes stand in the frame's place.
    """
    import scipy.sparse as sp  # noqa: PLC0415  (meshes alone load it)

    order = dissection(basis.doflocs, basis.element_dofs)
    inner = np.ones(basis.N, dtype=bool)
    inner[contact] = inner[rigid] = False
    inside = inner[order.nodes]
    nodes = np.concatenate([order.nodes[inside], contact])
    region = np.repeat(order.region[inside], 2)
    dofs = np.column_stack([2 * nodes, 2 * nodes + 1]).ravel()
    if alone is not None:
        others = ~np.isin(dofs, alone)
        dofs = np.concatenate([dofs[others], alone])
        entries = np.ones(len(dofs)), (dofs, np.arange(len(dofs)))
        return Constraints(
            sp.csc_matrix(entries, shape=(2 * basis.N, len(dofs))), region[others[: len(region)]]
        )
    frame = np.arange(len(dofs), len(dofs) + FRAME)
    x, y = basis.doflocs[:, rigid] - pin[:, None]
    ones = np.ones(len(rigid))
    rows = [dofs, 2 * rigid, 2 * rigid, 2 * rigid + 1, 2 * rigid + 1]
    columns = [np.arange(len(dofs)), *(np.full(len(rigid), frame[k]) for k in (0, 2, 1, 2))]
    values = [np.ones(len(dofs)), ones, -y, ones, x]
    entries = np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))
    return Constraints(sp.csc_matrix(entries, shape=(2 * basis.N, len(dofs) + FRAME)), region)


def condense(
    K: Any, constraints: Constraints, loads: Mapping[str, Floats], contact: int
) -> CondensedBody:
    """Eliminate all but the last `contact` + 3 unknowns.

    Parameters
    ----------
    K : (2 nodes, 2 nodes) stiffness
    loads : unit loads (unknowns, k) on the reduced unknowns, by name
    contact : number of displacements of the contact nodes

    Raises
    ------
    NoAnswer
        for a singular stiffness
    """
    A = (constraints.matrix.T @ K @ constraints.matrix).tocsc()
    all_loads = stacked_loads(loads, A.shape[0])
    S, left, work = eliminate(A, constraints.region, all_loads)
    L_cc, info = dpotrf(S[:contact, :contact], lower=1)
    if info:
        raise NoAnswer(SINGULAR_BODY)
    L_fc = solve_lower(L_cc, S[:contact, contact:]).T
    inside = InnerSystem(A, constraints, all_loads)
    return CondensedBody(
        L_cc,
        L_fc,
        left[:contact],
        left[contact:],
        work,
        partial(InnerSystem, *inside),
        inside.displacements,
        LoadColumns.of(loads),
    )
