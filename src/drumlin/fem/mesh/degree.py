"""Elements of any degree on a mesh of linear or quadratic elements.

A mesh file gives elements of degree 1 or 2. Displacements of a higher degree on the same elements
are more accurate, and the difference between the answers of two degrees gives an estimate of their
errors. The elements are isoparametric: the same polynomials describe the shape of an element and
its displacements. The sides of elements keep the shape that the mesh gives them. Only sides on the
lining's face follow the drum: the distances of the mesh's own nodes from the drum are interpolated
along each side, and give the distances of the side's new nodes.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.brake.brake import Shoe
from drumlin.fem.mesh.arc import mesh_kind_of_scikit_fem_mesh
from drumlin.fem.mesh.edges import nodes_along_element_edges
from drumlin.response.resultants import gauss_lobatto_points, lagrange_shape_function_values

REFERENCE_TRIANGLE_CORNER_COORDINATES = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
"""The corners (3, 2) of scikit-fem's reference triangle."""
REFERENCE_SQUARE_CORNER_COORDINATES = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
"""The corners (4, 2) of scikit-fem's reference square."""
CORNER_PAIRS_OF_TRIANGLE_SIDES = ((0, 1), (1, 2), (0, 2))
"""The corners at the ends of each side of the reference triangle, in scikit-fem's order."""
CORNER_PAIRS_OF_SQUARE_SIDES = ((0, 1), (1, 2), (2, 3), (0, 3))
"""The corners at the ends of each side of the reference square, in scikit-fem's order."""
STRAIGHT_TRIANGLE = 1e-11
"""Distance of a triangle's nodes from a straight triangle below which it counts as straight.

In a straight triangle all sides are straight, and the nodes lie where a linear map of the reference
triangle puts them. The distance is relative to the triangle's size. Round-off of the nodes is up to
2e-12 on a mesh of 10 000 nodes, and grows as triangles become smaller. Straight triangles take less
time to integrate: with 1e-12, most triangles of a mesh with straight sides counted as curved, and
its assembly took 20 ms more. A larger distance may count sides as straight that were moved onto
arcs. With 1e-10 the part of stated errors that is due to straight sides changes by 1e-4 of itself.
"""


class _ShapeFunctionGradient(NamedTuple):
    """The gradient of a shape function, `grad` (2, elements, points) [1/m]; scikit-fem's name."""

    grad: Floats


@dataclass(frozen=True)
class LagrangeElement:
    """A triangle or a square with Lagrange polynomials of a degree as its shape functions.

    The nodes are the corners, then the Gauss-Lobatto points of each side from its first corner to
    its second corner, then points inside.

    Attributes
    ----------
    degree : degree of the polynomials; for a square the degree in each of the two directions
    corners : number of corners, 3 or 4
    """

    degree: int
    corners: int

    @property
    def sides(self) -> tuple[tuple[int, int], ...]:
        """The two corners of each side."""
        return CORNER_PAIRS_OF_TRIANGLE_SIDES if self.corners == 3 else CORNER_PAIRS_OF_SQUARE_SIDES

    @cached_property
    def doflocs(self) -> Floats:
        """The nodes (nodes, 2) in the reference triangle or square."""
        corners = (
            REFERENCE_TRIANGLE_CORNER_COORDINATES
            if self.corners == 3
            else REFERENCE_SQUARE_CORNER_COORDINATES
        )
        inner = 0.5 + 0.5 * gauss_lobatto_points(self.degree)[1:-1, None]
        on_sides = [corners[a] + inner * (corners[b] - corners[a]) for a, b in self.sides]
        if self.corners == 3:
            i, j = np.indices((self.degree, self.degree)).reshape(2, -1)
            is_inside = (i > 0) & (j > 0) & (i + j < self.degree)
            inside = np.column_stack([i, j])[is_inside] / self.degree
        else:
            x, y = np.meshgrid(inner, inner, indexing="ij")
            inside = np.column_stack([x.ravel(), y.ravel()])
        return np.concatenate([corners, *on_sides, inside])

    @cached_property
    def cells_between_nodes(self) -> Ints:
        """The triangles (3, n) or quadrilaterals (4, n) between neighbouring nodes, for pictures.

        They are given by their corners, numbered within the element.
        """
        # The nodes form a lattice that is not quite even. For each point of an even lattice the
        # nearest node is found.
        i, j = np.indices((self.degree + 1, self.degree + 1))
        lattice = np.stack([i, j], axis=-1)[:, :, None] / self.degree
        at = np.hypot(*np.moveaxis(lattice - self.doflocs, -1, 0)).argmin(axis=-1)
        a, b, c, d = at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]
        if self.corners == 4:
            return np.array([a, b, c, d]).reshape(4, -1)
        diagonal = (i + j)[:-1, :-1]
        lower, upper = diagonal < self.degree, diagonal < self.degree - 1
        return np.hstack([np.array([a, b, d])[:, lower], np.array([b, c, d])[:, upper]])

    @cached_property
    def _monomial_exponents(self) -> Ints:
        """The exponents (2, nodes) of x and y in the monomials that span the polynomials."""
        i, j = np.indices((self.degree + 1, self.degree + 1)).reshape(2, -1)
        is_spanned = (i + j <= self.degree) | (self.corners == 4)
        return np.array([i[is_spanned], j[is_spanned]])

    @cached_property
    def _shape_function_coefficients(self) -> Any:
        """The coefficients (monomials, nodes) of the shape functions, in long double."""
        values, _ = self._monomial_values_and_slopes(self.doflocs.astype(np.longdouble).T)
        found = np.linalg.inv(values.astype(float)).astype(np.longdouble)
        # One step of Newton's method improves the inverse to the accuracy of long double.
        return found @ (2 * np.eye(len(found)) - values @ found)

    def _monomial_values_and_slopes(self, at: Any) -> tuple[Any, Any]:
        """Values (points, monomials) and slopes (2, points, monomials) of the monomials at points.

        `at` (2, points) are points of the reference triangle or square.
        """
        i, j = self._monomial_exponents
        x, y = self._powers_of_coordinates(at)
        by_x = i * x[:, np.maximum(i - 1, 0)] * y[:, j]
        by_y = j * x[:, i] * y[:, np.maximum(j - 1, 0)]
        return x[:, i] * y[:, j], np.array([by_x, by_y])

    def _powers_of_coordinates(self, at: Any) -> Any:
        """The powers (2, points, degree + 1) of x and of y at points `at` (2, points)."""
        # Powers of the distance from the element's centre have less round-off than powers of x, y.
        centred = at - (1 / 3 if self.corners == 3 else 1 / 2)
        factors = np.repeat(centred[:, :, None], self.degree + 1, axis=2)
        factors[:, :, 0] = 1
        return np.multiply.accumulate(factors, axis=2)

    def shape_function_values(self, X: Floats) -> Floats:
        """All shape functions (points, nodes) at reference points X (2, points)."""
        i, j = self._monomial_exponents
        x, y = self._powers_of_coordinates(X)
        return np.asarray((x[:, i] * y[:, j]) @ self._shape_function_coefficients.astype(float))

    def lbasis(self, X: Any, i: int) -> tuple[Any, Any]:
        """Shape function i (points,) and its slopes (2, points), at reference points X (2, points).

        Name and arguments are those of scikit-fem's elements.
        """
        values, slopes = self._monomial_values_and_slopes(X)
        own = self._shape_function_coefficients[:, i].astype(X.dtype)
        return values @ own, slopes @ own


@dataclass(frozen=True)
class NodalBasis:
    """The finite-element basis of one displacement component, of any degree on a mesh.

    It has those attributes of scikit-fem's basis that the stiffness and the loads of a body need,
    by the same names.

    Attributes
    ----------
    mesh : scikit-fem's mesh
    elem : the element
    doflocs : (2, N) positions of the nodes [m]
    element_dofs : (nodes of an element, elements) indices of the nodes of each element
    nodal_dofs : (1, vertices) nodes at the corners
    facet_dofs : (degree - 1, facets) nodes inside each side, from its corner of smaller number on
    X, W : (2, points), (points,) points and weights of the quadrature in the reference element
    split : the larger elements that were split into the elements of this basis, see
        `splitting.SplitElements`; None if no elements were split
    """

    mesh: Any
    elem: LagrangeElement
    doflocs: Floats
    element_dofs: Ints
    nodal_dofs: Ints
    facet_dofs: Ints
    X: Floats
    W: Floats
    split: Any = None

    @property
    def N(self) -> int:
        """Number of nodes."""
        return int(self.doflocs.shape[1])

    def get_dofs(self, facets: Ints) -> Ints:
        """The indices of all nodes on the sides `facets` of elements; the name is scikit-fem's."""
        return np.unique(nodes_along_element_edges(self, facets))

    def shape_function_gradients_and_jacobian_determinants(
        self, at: Floats, elements: Any
    ) -> tuple[Floats, Floats]:
        """The gradients (nodes, 2, m, points) [1/m] and Jacobian determinants (m, points) [m^2].

        Parameters
        ----------
        at : (2, points) points in the reference element
        elements : indices (m,) of the elements, or a slice
        """
        dofs = self.element_dofs[:, elements]
        # In long double the slopes of all shape functions at a point add up to zero more exactly.
        # In double precision, rigid motions of a soft shoe would cause considerable stresses by
        # round-off.
        fine = at.astype(np.longdouble)
        local = np.array([self.elem.lbasis(fine, i)[1] for i in range(len(dofs))]).astype(float)
        J = np.einsum("caj,adq->cdjq", self.doflocs[:, dofs], local, optimize=True)
        determinant = J[0, 0] * J[1, 1] - J[0, 1] * J[1, 0]
        inverse = np.array([[J[1, 1], -J[0, 1]], [-J[1, 0], J[0, 0]]]) / determinant
        return np.einsum("adq,dcjq->acjq", local, inverse, optimize=True), determinant

    def numbers_of_straight_triangles(self) -> Ints:
        """The indices (m,) of the triangles whose map from the reference triangle is linear."""
        if self.elem.corners != 3:
            return np.zeros(0, dtype=np.int64)
        first, *others = self.doflocs[:, self.element_dofs].transpose(1, 0, 2)
        second, third = others[0] - first, others[1] - first
        size = np.maximum(np.abs(second), np.abs(third)).max(axis=0)
        off = np.zeros(size.shape)
        for node, (x, y) in zip(others[2:], self.elem.doflocs[3:], strict=True):
            off = np.maximum(off, np.abs(node - first - x * second - y * third).max(axis=0))
        return np.flatnonzero(off <= STRAIGHT_TRIANGLE * size)

    @cached_property
    def _shape_function_gradients_and_areas(self) -> tuple[Floats, Floats]:
        """The gradients (nodes, 2, elements, points) [1/m], and areas (elements, points) [m^2]."""
        gradients, determinants = self.shape_function_gradients_and_jacobian_determinants(
            self.X, slice(None)
        )
        return gradients, np.abs(determinants) * self.W

    @property
    def basis(self) -> list[tuple[_ShapeFunctionGradient]]:
        """The gradients of each shape function, under the attribute names of scikit-fem's basis."""
        return [
            (_ShapeFunctionGradient(gradient),)
            for gradient in self._shape_function_gradients_and_areas[0]
        ]

    @property
    def dx(self) -> Floats:
        """Weights (elements, points) [m^2] of the quadrature points, which add up to the area."""
        return self._shape_function_gradients_and_areas[1]

    def positions_of_points_in_elements(self, elements: Ints, at: Floats) -> Floats:
        """The positions (2, m, q) [m] of q points in each of m elements.

        `at` (m, q, 2) are the points in the reference triangle or square.
        """
        shapes = self.elem.shape_function_values(at.reshape(-1, 2).T).reshape(*at.shape[:2], -1)
        nodes = self.doflocs[:, self.element_dofs[:, elements].T]
        return np.einsum("cma,mqa->cmq", nodes, shapes)

    def basis_with_moved_nodes(self, moves: Floats) -> "NodalBasis":
        """A copy of the basis with its nodes moved by `moves` (2, N) [m]."""
        return replace(self, doflocs=self.doflocs + moves)

    def basis_of_some_elements(self, elements: Ints) -> "NodalBasis":
        """The basis with only some of the elements; the nodes keep their numbers.

        `elements` (m,) are the indices of these elements. The mesh of the basis has only the
        attributes that `substructure.body.sparse_stiffness_of_body` uses.
        """
        position = np.full(self.element_dofs.shape[1], -1)
        position[elements] = np.arange(len(elements))
        subdomains = {}
        for name, members in self.mesh.subdomains.items():
            found = position[members]
            subdomains[name] = found[found >= 0]
        mesh = ElementsOfGroups(len(elements), subdomains)
        return replace(self, mesh=mesh, element_dofs=self.element_dofs[:, elements], split=None)


class ElementsOfGroups(NamedTuple):
    """Some elements of a mesh by their groups, with the attribute names of scikit-fem's meshes.

    `nelements` is the number of these elements, and `subdomains` has their indices by the name of
    the group.
    """

    nelements: int
    subdomains: Mapping[str, Ints]


def number_of_nodes_at_degree(mesh: Any, degree: int) -> int:
    """The number of nodes of a scikit-fem mesh if its elements have the given degree."""
    inside = len(LagrangeElement(degree, len(mesh.t)).doflocs) - len(mesh.t) * degree
    return int(mesh.nvertices + (degree - 1) * mesh.nfacets + inside * mesh.nelements)


def nodal_basis_of_shoe_mesh(mesh: Any, degree: int, shoe: Shoe, radius: float) -> NodalBasis:
    """The basis of the given degree on a shoe's mesh, with its contact nodes on the lining's face.

    Parameters
    ----------
    mesh : scikit-fem's mesh of linear or quadratic elements in the shoe's frame [m]
    degree : degree of the displacements, at least the degree of the mesh
    shoe : the shoe
    radius : radius of the drum [m]; on a plane the length of the pad
    """
    basis = nodal_basis_of_mesh(mesh, degree)
    # On a plane the sides of the mesh have the right shape already.
    return (
        basis
        if shoe.is_on_plane
        else _basis_with_contact_distances_off_drum_of_mesh(basis, shoe, radius)
    )


def nodal_basis_of_mesh(mesh: Any, degree: int | None = None) -> NodalBasis:
    """The basis of the given degree on a mesh; elements keep the shape that the mesh gives them.

    If no degree is given, the basis has the degree of the mesh itself, 1 or 2.
    """
    elem = LagrangeElement(degree or mesh_kind_of_scikit_fem_mesh(mesh).degree, len(mesh.t))
    # The mapping of the mesh gives the positions of the nodes.
    shape = (2, mesh.nelements, len(elem.doflocs))
    places = np.broadcast_to(mesh.mapping().F(elem.doflocs.T), shape)
    return nodal_basis_with_given_node_positions(mesh, elem, places)


def nodal_basis_with_given_node_positions(
    mesh: Any, elem: LagrangeElement, places: Floats
) -> NodalBasis:
    """The basis on a mesh for elements of the type `elem`, with its nodes at given positions.

    Parameters
    ----------
    mesh : scikit-fem's mesh, of which only the vertices of elements and sides are used
    elem : the element
    places : (2, elements, nodes of an element) positions of the nodes [m]
    """
    vertices, facets, inner = mesh.nvertices, mesh.nfacets, elem.degree - 1
    facet_dofs = vertices + np.arange(inner * facets).reshape(inner, facets)
    rows = [mesh.t]
    # The nodes of a side are numbered from the corner with the smaller number to the other corner.
    for side, (a, b) in enumerate(elem.sides):
        along = facet_dofs[:, mesh.t2f[side]]
        rows.append(np.where(mesh.t[a] < mesh.t[b], along, along[::-1]))
    first = vertices + inner * facets
    inside = len(elem.doflocs) - elem.corners * elem.degree
    rows.append(first + np.arange(inside * mesh.nelements).reshape(inside, mesh.nelements))
    element_dofs = np.concatenate(rows)
    doflocs = np.empty((2, number_of_nodes_at_degree(mesh, elem.degree)))
    doflocs[:, element_dofs] = places.transpose(0, 2, 1)
    # scikit-fem takes long to load, and hp elements do without it.
    import skfem  # noqa: PLC0415

    form = skfem.refdom.RefTri if elem.corners == 3 else skfem.refdom.RefQuad
    X, W = skfem.quadrature.get_quadrature(form, 2 * elem.degree)
    return NodalBasis(
        mesh, elem, doflocs, element_dofs, np.arange(vertices)[None], facet_dofs, X, W
    )


def _basis_with_contact_distances_off_drum_of_mesh(
    basis: NodalBasis, shoe: Shoe, radius: float
) -> NodalBasis:
    """The basis whose contact nodes have the distances off the drum that the mesh's nodes have.

    The distances of the mesh's own nodes are interpolated along each side.
    """
    mesh = basis.mesh
    facets = mesh.boundaries["contact"]
    own = nodal_basis_of_mesh(mesh)
    given = shoe.distances_from_friction_surface(
        own.doflocs[:, nodes_along_element_edges(own, facets)], radius
    )
    at = gauss_lobatto_points(basis.elem.degree)
    target = lagrange_shape_function_values(len(given) - 1, at).T @ given
    xy = basis.doflocs[:, nodes_along_element_edges(basis, facets)]
    outward = -shoe.sign_internal_plus_external_minus * xy / np.hypot(*xy)
    moves = (target - shoe.distances_from_friction_surface(xy, radius)) * outward
    return basis.basis_with_moved_nodes(
        node_displacements_that_follow_moved_sides(basis, facets, moves)
    )


def node_displacements_that_follow_moved_sides(
    basis: NodalBasis, facets: Ints, moves: Floats
) -> Floats:
    """The displacements (2, N) [m] of all nodes if the nodes on some sides are moved.

    The nodes inside the elements at these sides follow their side, so that the elements keep their
    shape. The corners stay where they are.

    Parameters
    ----------
    basis : the basis
    facets : (m,) indices of the sides
    moves : (2, degree + 1, m) displacements [m] of the nodes on each side, from end to end; 0 at
        corners
    """
    mesh, elem = basis.mesh, basis.elem
    change = np.zeros_like(basis.doflocs)
    position = np.full(mesh.nfacets, -1)
    position[facets] = np.arange(len(facets))
    inside = np.arange(len(elem.doflocs)) >= elem.corners * elem.degree
    for side, (a, b) in enumerate(elem.sides):
        which = position[mesh.t2f[side]]
        elements = np.flatnonzero(which >= 0)
        of_side = moves[:, :, which[elements]]
        reversed_ = mesh.t[a, elements] > mesh.t[b, elements]
        of_side = np.where(reversed_, of_side[:, ::-1], of_side)
        along, share = _node_places_along_side_and_shares_of_its_move(elem, a, b)
        shapes = lagrange_shape_function_values(elem.degree, along) * share
        following = np.einsum("ckm,kn->cnm", of_side, shapes)
        change[:, basis.element_dofs[inside][:, elements]] += following[:, inside]
    change[:, nodes_along_element_edges(basis, facets)] = moves
    return change


def _node_places_along_side_and_shares_of_its_move(
    elem: LagrangeElement, a: int, b: int
) -> tuple[Floats, Floats]:
    """How the nodes of an element follow one side: a place on the side, and a share of its move.

    When a side is moved, each node follows the move of one place on the side. The first result
    (nodes,) is this place, from -1 at corner a to 1 at corner b. The second result (nodes,) is the
    fraction of the move that the node takes. It is 1 on the side itself, and falls to 0 at the
    opposite side of a quadrilateral or at the two other sides of a triangle. Only the fractions of
    nodes inside the element are used.
    """
    if elem.corners == 3:
        x, y = elem.doflocs.T
        corner = np.array([1 - x - y, x, y])
        along = corner[b] - corner[a]
        ends = 1 - along**2
        share = np.zeros_like(ends)
        np.divide(4 * corner[a] * corner[b], ends, out=share, where=ends > 0)
        return along, share
    direction = REFERENCE_SQUARE_CORNER_COORDINATES[b] - REFERENCE_SQUARE_CORNER_COORDINATES[a]
    from_start = elem.doflocs - REFERENCE_SQUARE_CORNER_COORDINATES[a]
    return 2 * from_start @ direction - 1, 1 - np.abs(from_start @ direction[::-1])
