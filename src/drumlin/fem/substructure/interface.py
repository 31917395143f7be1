"""The contact line of a lining, and the mortar coupling of its pressure and displacement.

Pressure and displacement are interpolated with the same shape functions psi_i on the contact line.
The discrete arc is x(xi) = sum_i psi_i(xi) x_i, with the contact nodes x_i. At every point n is the
exact unit normal of the drum: e_r for shoes inside the drum, -e_r for shoes outside. The unit
tangent is e = e_phi. With the lining's width b the coupling matrices are

    M_ij   = b Int psi_i psi_j ds
    N_i,jc = b Int psi_i psi_j n_c ds
    T_i,jc = b Int psi_i psi_j e_c ds

The nodal forces of a pressure p with the friction coefficient mu and the sense s of sliding are
-N^T p + mu s T^T p. On any mesh, their resultants equal the resultants of the traction on the same
arc, apart from round-off.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple, Protocol

import numpy as np

from drumlin.base.arrays import Bools, Floats, Ints, polar_angles_within_half_turn_of_angle
from drumlin.fem.mesh.edges import nodes_along_element_edges
from drumlin.response.response import PressureOverArcAndWidth
from drumlin.response.resultants import (
    GAUSS,
    WEIGHTS,
    LiningWithoutEndZones,
    lagrange_shape_function_derivatives,
    lagrange_shape_function_values,
    polynomial_nodes_on_linings_and_slots,
    shape_functions_and_derivatives_at_gauss_points,
    slots_from_nodes_and_lining_mask,
)

NormalsAndTangentsFunction = Callable[[Floats], tuple[Floats, Floats]]
"""Function that takes points (2, ...) [m] and returns unit normals and unit tangents (2, ...).

They are normal and tangential to the drum or the plane on which the lining slides.
"""


@dataclass(frozen=True)
class ContactLine:
    """The friction surface of all linings of a shoe, or of a ring, with nodes sorted by angle.

    Coordinates and angles of a shoe's contact line are in the frame of the shoe.

    Attributes
    ----------
    nodes : (n,) indices of the contact nodes in the mesh
    xy : (2, n) coordinates of these nodes [m]
    phi : (n,) angles of these nodes [rad]
    pieces : (order + 1, m) the nodes of each of m element edges, as indices into `nodes`, by
        growing angle
    edge : length [rad] of the zone at each end of a lining in which no pressure peak is sought
    further_linings : index into `nodes` of the first node of each lining after the first lining
    """

    nodes: Ints
    xy: Floats
    phi: Floats
    pieces: Ints
    edge: float = field(default=0.0, kw_only=True)
    further_linings: tuple[int, ...] = field(default=(), kw_only=True)

    @property
    def interpolation_degree_along_contact_line(self) -> int:
        """Polynomial degree of the interpolation along an edge of the contact line."""
        return len(self.pieces) - 1

    def coupling_matrices_with_drum_or_plane(
        self, width: float, directions: NormalsAndTangentsFunction
    ) -> "ContactCouplingMatrices":
        """The matrices that couple this contact line with the drum or the plane.

        `width` is the width of the lining [m], and `directions` gives the surface's unit vectors.
        """
        return coupling_matrices_of_contact_line(self, width, directions)

    @cached_property
    def lining_part_where_pressure_peak_is_sought(self) -> LiningWithoutEndZones:
        """The part of the contact line in which a peak of the pressure is sought."""
        phi, on_lining = self.node_angles_with_mask_of_linings
        return LiningWithoutEndZones(
            phi,
            self.interpolation_degree_along_contact_line,
            self.edge,
            slots_from_nodes_and_lining_mask(phi, on_lining),
        )

    def split_nodal_values_by_lining(self, values: Floats) -> list[Floats]:
        """The values (n,) at the contact nodes, divided into one array for each lining."""
        return np.split(values, self.further_linings)

    @cached_property
    def node_angles_with_mask_of_linings(self) -> tuple[Floats, Bools]:
        """Angles (m,) [rad] of nodes on linings and in slots, and a mask (m,): True on linings.

        The nodes on linings are the nodes of `angles_and_pressures_averaged_over_width`. Nodes are
        added in the slots between linings, so that a piecewise polynomial spans them, see
        `resultants.polynomial_nodes_on_linings_and_slots`.
        """
        phi, _ = self.angles_and_pressures_averaged_over_width(np.zeros(len(self.phi)))
        parts = self.split_nodal_values_by_lining(phi)
        return polynomial_nodes_on_linings_and_slots(
            parts, self.interpolation_degree_along_contact_line
        )

    @property
    def node_distances_from_mid_plane(self) -> Floats:
        """Distances (m,) [m] of the nodes across the width from the mid-plane.

        In plane stress there is one node across the width, at the distance 0.
        """
        return np.zeros(1)

    @property
    def width_fraction_of_each_node_across_width(self) -> Floats:
        """The fraction (m,) of the width that each node across the width stands for.

        In plane stress there is one node across the width, and its fraction is 1.
        """
        return np.ones(1)

    def angles_and_pressures_averaged_over_width(self, p: Floats) -> tuple[Floats, Floats]:
        """Angles (n,) [rad] of the contact nodes, and the pressure (n,) [Pa] there.

        On the contact face of a solid the pressure is the mean over the width.
        """
        return self.phi, p

    def pressure_distribution_over_arc_and_width(self, p: Floats) -> PressureOverArcAndWidth | None:
        """The pressure over arc and width of a solid's contact face; None for a contact line."""
        return None


class MatrixForProducts(Protocol):
    """A matrix (n, k) of which only the products with other matrices are used."""

    def __matmul__(self, X: Floats, /) -> Floats:
        """The product (n, m) of the matrix with a matrix X (k, m)."""


@dataclass(frozen=True)
class ContactCouplingMatrices:
    """The matrices that couple nodal pressures of linings with displacements (mortar method).

    b is the width of the lining, and psi_i are the shape functions of the n contact nodes. N u and
    T u, with the displacements u of the contact nodes, are called weighted gap closure and weighted
    slip [m^3]: integrals of gap closure and slip times each shape function.

    Attributes
    ----------
    M : (n, n) mass matrix of the contact nodes [m^2]; M p are the integrals of the pressure p times
        each shape function
    N : (n, 2n) normal coupling [m^2]; the nodal forces of p are -N^T p
    T : (n, 2n) tangential coupling [m^2]; the nodal forces of the friction are mu s T^T p, with the
        sense s of sliding
    lever : (n,) b Int psi_i |x| ds [m^3], with which the torque of a drum brake is mu lever . p. On
        a plane it is b Int psi_i ds [m^2] and gives the braking force.
    """

    M: Floats
    N: Floats
    T: Floats
    lever: Floats

    @property
    def tangential_coupling_for_products(self) -> "MatrixForProducts":
        """T in a form of which only the products with other matrices are used."""
        return self.T

    def write_normal_coupling(self, out: Floats) -> None:
        """Write the matrix N into an array (n, 2n) of the caller."""
        out[:] = self.N

    @cached_property
    def areas_of_contact_nodes(self) -> Floats:
        """The areas (n,) [m^2] of the friction surface that the contact nodes stand for."""
        return self.M.sum(axis=1)


class EdgeQuadraturePoints(NamedTuple):
    """The q quadrature points on each of m element edges of a mesh.

    Attributes
    ----------
    functions : (order + 1, q) shape functions at the points
    xy : (2, m, q) the points [m]
    ds : (m, q) length of edge that each point stands for [m]
    """

    functions: Floats
    xy: Floats
    ds: Floats


def edge_quadrature_points(
    xy: Floats, at: Floats = GAUSS, weights: Floats = WEIGHTS
) -> EdgeQuadraturePoints:
    """The quadrature points on element edges, with the shape functions and lengths there.

    scikit-fem's boundary bases are not used: they invert the map of the element with an absolute
    tolerance, which fails on small and slender elements.

    Parameters
    ----------
    xy : (2, order + 1, m) nodes of the edges [m]
    at, weights : (q,) points and weights of the quadrature on [-1, 1]
    """
    order = xy.shape[1] - 1
    psi, slope = (
        shape_functions_and_derivatives_at_gauss_points(order)
        if at is GAUSS
        else (
            lagrange_shape_function_values(order, at),
            lagrange_shape_function_derivatives(order, at),
        )
    )
    xy = xy.transpose(0, 2, 1)
    return EdgeQuadraturePoints(psi, xy @ psi, np.hypot(*(xy @ slope)) * weights)


def nodal_forces_of_unit_end_loads_and_end_centre(
    basis: Any, facets: Ints
) -> tuple[Floats, Floats]:
    """Nodal forces (2 nodes, 3) of the unit loads on a loaded end, and the end's centre (2,) [m].

    The loads are unit force x, unit force y and a unit couple about the centre. The forces are
    spread evenly over the end. The couple is a traction that grows linearly with the distance from
    the centre.

    Parameters
    ----------
    basis : scalar basis of the mesh
    facets : indices of the element edges on the loaded end
    """
    nodes = nodes_along_element_edges(basis, facets)
    psi, x, ds = edge_quadrature_points(basis.doflocs[:, nodes])
    centre = (x * ds).sum(axis=(1, 2)) / ds.sum()
    arm = x - centre[:, None, None]
    couple_traction = np.array([-arm[1], arm[0]]) / float((arm**2 * ds).sum())
    even, zeros = np.full(ds.shape, 1 / ds.sum()), np.zeros(ds.shape)
    tractions = np.array([[even, zeros], [zeros, even], couple_traction])
    loads = np.zeros((basis.N, 2, 3))
    np.add.at(loads, nodes, np.einsum("aq,lciq,iq->aicl", psi, tractions, ds))
    return loads.reshape(-1, 3), centre


def make_contact_line_of_lining(
    basis: Any, facets: Ints, middle: float, unit: float | None = None, edge: float = 0.0
) -> ContactLine:
    """The contact line on the friction surface of a mesh, with nodes and edges by growing angle.

    Parameters
    ----------
    basis : scalar basis of the mesh
    facets : indices of the element edges on the friction surface
    middle : angle [rad]; the angle of each node is chosen within half a turn of it
    unit : length [m] by which x is divided to give the "angle" on a plane; None on a drum
    edge : length [rad] of the zone at each end in which no pressure peak is sought
    """
    dofs = nodes_along_element_edges(basis, facets)
    nodes = np.unique(dofs)
    xy = basis.doflocs[:, nodes]
    phi = polar_angles_within_half_turn_of_angle(middle, xy) if unit is None else xy[0] / unit
    by_angle = np.argsort(phi)
    nodes, phi = nodes[by_angle], phi[by_angle]
    position = np.empty(basis.N, dtype=np.int64)
    position[nodes] = np.arange(len(nodes))
    pieces = position[dofs]
    # The nodes of an edge are sorted by angle, and the edges by the angle of their first node.
    pieces = np.where(phi[pieces[0]] < phi[pieces[-1]], pieces, pieces[::-1])
    pieces = pieces[:, np.argsort(phi[pieces[0]])]
    return ContactLine(nodes, basis.doflocs[:, nodes], phi, pieces, edge=edge)


def function_that_returns_drum_normals_and_tangents(sign: int) -> NormalsAndTangentsFunction:
    """The function that returns the unit normals and the unit tangents e_phi of a drum.

    The centre of the drum is the origin. The normal is e_r for shoes inside the drum (`sign` 1),
    and -e_r for shoes outside (`sign` -1).
    """

    def drum_normals_and_tangents(x: Floats) -> tuple[Floats, Floats]:
        """Unit normals and unit tangents (2, ...) of the drum at points x (2, ...)."""
        r = np.hypot(*x)
        return sign * x / r, np.array([-x[1], x[0]]) / r

    return drum_normals_and_tangents


def plane_normals_and_tangents(x: Floats) -> tuple[Floats, Floats]:
    """The unit normals and tangents (2, ...), at points x, of a plane y = 0 under the lining."""
    ones, zeros = np.ones(x.shape[1:]), np.zeros(x.shape[1:])
    return np.array([zeros, -ones]), np.array([ones, zeros])


def coupling_matrices_of_contact_line(
    line: ContactLine, width: float, directions: NormalsAndTangentsFunction
) -> ContactCouplingMatrices:
    """The matrices that couple a lining with the drum or the plane, see `ContactCouplingMatrices`.

    Parameters
    ----------
    line : contact line of the lining
    width : width b of the lining [m]
    directions : function that gives normals and tangents of the drum or the plane
    """
    n, m = len(line.nodes), line.pieces.shape[1]
    psi, x, ds = edge_quadrature_points(line.xy[:, line.pieces])
    r = np.ones(ds.shape) if directions is plane_normals_and_tangents else np.hypot(*x)
    weight = width * ds

    # The five rows of `factors` belong to M, to the two components of N and to the two components
    # of T. They multiply psi_a psi_b in the integrals over every edge.
    factors = weight * np.concatenate([np.ones((1, *ds.shape)), *directions(x)])
    products = (psi[:, None] * psi).reshape(len(psi) ** 2, -1)
    blocks = (factors @ products.T).reshape(len(factors), -1)
    at = (line.pieces[:, None] * n + line.pieces).reshape(-1, m).T.ravel()
    M, *parts = (
        _sum_values_with_equal_position(at, block, n * n).reshape(n, n) for block in blocks
    )
    # The x and y components of N are interleaved for each node, and so are the components of T.
    N = np.array(parts[:2]).transpose(1, 2, 0).reshape(n, 2 * n)
    T = np.array(parts[2:]).transpose(1, 2, 0).reshape(n, 2 * n)
    lever = _sum_values_with_equal_position(line.pieces.T.ravel(), (weight * r) @ psi.T, n)
    return ContactCouplingMatrices(M, N, T, lever)


def _sum_values_with_equal_position(at: Ints, values: Floats, count: int) -> Floats:
    """Sums (count,): entry k is the sum of all `values` whose entry in `at` is k."""
    return np.bincount(at, values.ravel(), count).astype(float, copy=False)
