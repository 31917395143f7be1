"""The lining's contact line and the weak (mortar) coupling of its pressure with its displacement.

The pressure is interpolated with the trace psi_i of the displacement's shape functions. Over the
discrete arc x(xi) = sum_i psi_i(xi) x_i, with the exact radial normal n = sign e_r and tangent
e_phi at every point, and b the lining's width:

    M_ij = b Int psi_i psi_j ds,   N_i,jc = b Int psi_i psi_j n_c ds,   T_i,jc = b Int psi_i psi_j e_c ds

Nodal forces of a pressure p with the drag mu s p are  -N^T p + mu s T^T p: their resultants are those
of the traction on the same arc to round-off, on any mesh.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from drumlin.base.arrays import Floats, Ints, angle_near
from drumlin.fem.mesh.edges import edge_nodes
from drumlin.response.response import PressureOverWidth
from drumlin.response.resultants import GAUSS, WEIGHTS, InnerPart, at_gauss, shape, slopes

Directions = Callable[
    [Floats], tuple[Floats, Floats]
]  # points (2, ...) -> unit normals and tangents


@dataclass(frozen=True)
class ContactLine:
    """The lining's friction surface in the shoe's frame, nodes sorted by angle.

    `nodes` (n,): numbers in the mesh; `xy` (2, n) [m]; `phi` (n,) [rad]; `pieces` (order + 1, m):
    positions in `nodes` of the nodes of each edge, by growing angle; `edge` [rad]: the zone at its
    ends that makes no peak.
    """

    nodes: Ints
    xy: Floats
    phi: Floats
    pieces: Ints
    edge: float = field(default=0.0, kw_only=True)

    @property
    def order(self) -> int:
        """Degree of the interpolation along an edge."""
        return len(self.pieces) - 1

    def couple(self, width: float, directions: Directions) -> "Coupling":
        """The coupling with a counterface of known directions, the lining being `width` [m] wide."""
        return couple(self, width, directions)

    @cached_property
    def inside(self) -> InnerPart:
        """Where its pressure may peak."""
        return InnerPart(self.along(np.zeros(len(self.phi)))[0], self.order, self.edge)

    def along(self, p: Floats) -> tuple[Floats, Floats]:
        """Angles (n,) [rad] and pressure (n,) [Pa] along the line; of a face its mean over the
        width.
        """
        return self.phi, p

    def surface(self, p: Floats) -> PressureOverWidth | None:
        """The pressure over arc and width, of a face."""
        return None


@dataclass(frozen=True)
class Coupling:
    """The matrices of the weak coupling: M (n, n), N and T (n, 2n), and the torque's lever (n,).

    `lever` = b Int psi_i |x| ds [m^3]: torque = mu lever . p; on a plane without |x|: the braking
    force.
    """

    M: Floats
    N: Floats
    T: Floats
    lever: Floats

    @cached_property
    def area(self) -> Floats:
        """b Int psi_i ds (n,) [m^2]."""
        return self.M.sum(axis=1)


def edge_points(
    xy: Floats, at: Floats = GAUSS, weights: Floats = WEIGHTS
) -> tuple[Floats, Floats, Floats]:
    """Gauss points on edges with the nodes xy (2, order + 1, m): shape functions, points (2, m, q),
    ds (m, q).

    `at`, `weights` (q,): another rule of quadrature on [-1, 1].

    Integrated along the edges themselves: skfem's boundary bases invert the map of the element with
    an absolute tolerance, which small and slender elements do not meet.
    """
    order = xy.shape[1] - 1
    psi, slope = at_gauss(order) if at is GAUSS else (shape(order, at), slopes(order, at))
    xy = xy.transpose(0, 2, 1)
    return psi, xy @ psi, np.hypot(*(xy @ slope)) * weights


def end_loads(basis: Any, facets: Ints) -> tuple[Floats, Floats]:
    """Nodal forces (2 nodes, 3) of unit force x, unit force y and unit couple on the loaded end,
    and its centre.

    The force is spread evenly; the couple, about the centre (2,) [m], as a traction that grows
    linearly from it.
    """
    nodes = edge_nodes(basis, facets)
    psi, x, ds = edge_points(basis.doflocs[:, nodes])
    centre = (x * ds).sum(axis=(1, 2)) / ds.sum()
    arm = x - centre[:, None, None]
    turn = np.array([-arm[1], arm[0]]) / float((arm**2 * ds).sum())
    ones, zeros = np.full(ds.shape, 1 / ds.sum()), np.zeros(ds.shape)
    tractions = np.array([[ones, zeros], [zeros, ones], turn])
    loads = np.zeros((basis.N, 2, 3))
    np.add.at(loads, nodes, np.einsum("aq,lciq,iq->aicl", psi, tractions, ds))
    return loads.reshape(-1, 3), centre


def contact_line(
    basis: Any, facets: Ints, middle: float, unit: float | None = None, edge: float = 0.0
) -> ContactLine:
    """The contact line on the `facets` of a scalar basis; angles within 180 deg of `middle` [rad].

    unit [m]: on a plane, whose "angles" are x/unit; edge [rad]: see ContactLine.
    """
    dofs = edge_nodes(basis, facets)
    nodes = np.unique(dofs)
    xy = basis.doflocs[:, nodes]
    phi = angle_near(middle, xy) if unit is None else xy[0] / unit
    by_angle = np.argsort(phi)
    nodes, phi = nodes[by_angle], phi[by_angle]
    place = np.empty(basis.N, dtype=np.int64)
    place[nodes] = np.arange(len(nodes))
    pieces = place[dofs]
    pieces = np.where(phi[pieces[0]] < phi[pieces[-1]], pieces, pieces[::-1])
    return ContactLine(
        nodes, basis.doflocs[:, nodes], phi, pieces[:, np.argsort(phi[pieces[0]])], edge=edge
    )


def radial(sign: int) -> Directions:
    """Normals sign e_r and tangents e_phi at the points x (2, ...) of a round drum about O."""

    def directions(x: Floats) -> tuple[Floats, Floats]:
        r = np.hypot(*x)
        return sign * x / r, np.array([-x[1], x[0]]) / r

    return directions


def straight(x: Floats) -> tuple[Floats, Floats]:
    """Normals and tangents at the points x (2, ...) of a plane y = 0 under the lining."""
    ones, zeros = np.ones(x.shape[1:]), np.zeros(x.shape[1:])
    return np.array([zeros, -ones]), np.array([ones, zeros])


def couple(line: ContactLine, width: float, directions: Directions) -> Coupling:
    """The coupling of a lining of this width b [m] with a counterface of known directions; see
    `radial`.
    """
    n, m = len(line.nodes), line.pieces.shape[1]
    psi, x, ds = edge_points(line.xy[:, line.pieces])
    r, weight = np.ones(ds.shape) if directions is straight else np.hypot(*x), width * ds
    factors = weight * np.concatenate([np.ones((1, *ds.shape)), *directions(x)])  # of M, N and T
    blocks = (factors @ (psi[:, None] * psi).reshape(len(psi) ** 2, -1).T).reshape(
        len(factors), -1
    )  # (.., m a b)
    at = (line.pieces[:, None] * n + line.pieces).reshape(-1, m).T.ravel()
    M, *parts = (_summed(at, block, n * n).reshape(n, n) for block in blocks)
    N, T = (np.array(parts[k : k + 2]).transpose(1, 2, 0).reshape(n, 2 * n) for k in (0, 2))
    return Coupling(M, N, T, _summed(line.pieces.T.ravel(), (weight * r) @ psi.T, n))


def _summed(at: Ints, values: Floats, count: int) -> Floats:
    """Sums (count,) of the values that have the same place `at`."""
    return np.bincount(at, values.ravel(), count).astype(float, copy=False)
