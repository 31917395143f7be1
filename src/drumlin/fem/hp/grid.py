"""The grid of a body in hp elements: all of its nodes and elements, with their numbers.

The contact problem needs only the body's stiffness, condensed to its contact nodes. Pictures,
result files, derivatives and the correction of round-off errors need all nodes, which are computed
at the first access. The grid has the attributes of a scikit-fem basis (`doflocs`, `element_dofs`,
`N`), so that functions for bodies on meshes take a grid too.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.brake.elasticity import ElasticLayer, which_elasticity_matrices_are_orthotropic
from drumlin.fem.hp.element import (
    condense_inner_forces_to_element_boundary,
    condensed_element_stiffness,
    displacements_of_inner_element_nodes,
    gauss_points_of_elements,
    nodal_forces_of_element_stresses,
    node_positions_on_edge_from_0_to_1,
    plane_stress_stiffness_of_elements,
    points_of_square_tensor_grid,
    reference_element_of_degree,
    shape_function_gradients_and_gauss_areas,
    shape_function_values_and_slopes,
)
from drumlin.fem.substructure.body import (
    ElementQuadrature,
    UncondensedBodySystem,
    assemble_sparse_stiffness,
)
from drumlin.fem.substructure.elimination import CondensedSystem
from drumlin.fem.substructure.expansion import (
    FreeStrainFunctionByLayer,
    stress_times_width_of_free_strain,
)


@dataclass(frozen=True)
class RectangularElementBlock:
    """A block of hp elements whose nodes form a rectangle of rows and columns.

    Attributes
    ----------
    number : (rows, columns) numbers of the nodes in the grid
    depth : (rows,) depth of the nodes of each row below the contact
    along : (columns,) position of the nodes of each column along the lining
    part : (layers,) name of the part of the shoe that each layer of elements belongs to
    """

    number: Ints
    depth: Floats
    along: Floats
    part: tuple[str, ...]


@dataclass(frozen=True)
class HpElementGrid:
    """All nodes and hp elements of a body; an element of degree p has a = (p + 1)^2 nodes.

    Attributes
    ----------
    degree : degree p of the elements
    blocks : rectangular blocks of elements that the body consists of
    point_at_depth_and_position : function from depths and positions along the lining to points (2,
        ...) [m]
    sets : numbers of the nodes of each node set, by its name (such as "hinge")
    N : number of nodes. The contact nodes have the first numbers, in the order of the blocks.
    """

    degree: int
    blocks: tuple[RectangularElementBlock, ...]
    point_at_depth_and_position: Callable[[Floats, Floats], Floats]
    sets: Mapping[str, Ints]
    N: int

    @cached_property
    def doflocs(self) -> Floats:
        """Points of the grid's nodes (2, N) [m]."""
        xy = np.zeros((2, self.N))
        for block in self.blocks:
            xy[:, block.number] = self.point_at_depth_and_position(
                block.depth[:, None], block.along
            )
        return xy

    @property
    def dofs(self) -> Ints:
        """The numbers (2 N,) of all displacements; x and y of a node are next to each other."""
        return np.arange(2 * self.N)

    def indices_in_this_basis_of_grid_nodes(self, nodes: Ints) -> Ints:
        """The given numbers of nodes, unchanged, because a whole grid has all nodes."""
        return nodes

    @cached_property
    def element_dofs(self) -> Ints:
        """The numbers of the nodes of each element (a, elements), row by row in the element."""
        p = self.degree
        nodes = []
        for block in self.blocks:
            # Each element has the nodes of p + 1 rows and p + 1 columns of the block.
            rows, columns = (np.arange(0, size - 1, p) for size in block.number.shape)
            i = rows[:, None, None, None] + np.arange(p + 1)[:, None]
            j = columns[None, :, None, None] + np.arange(p + 1)
            nodes.append(block.number[i, j].reshape(-1, (p + 1) ** 2))
        return np.concatenate(nodes).T

    @cached_property
    def subdomains(self) -> dict[str, Ints]:
        """The numbers of the elements in each part of the body, by its name, such as "lining"."""
        names: list[str] = []
        for block in self.blocks:
            # Each layer of the block has as many elements as the block has element columns.
            columns = (block.number.shape[1] - 1) // self.degree
            names += np.repeat(block.part, columns).tolist()
        return {name: np.flatnonzero(np.array(names) == name) for name in dict.fromkeys(names)}

    @property
    def _node_numbers_within_element(self) -> Ints:
        """The numbers (p + 1, p + 1) of nodes within an element, row by row from 0 on."""
        return np.arange((self.degree + 1) ** 2).reshape(self.degree + 1, -1)

    @cached_property
    def quadrilaterals_between_element_nodes(self) -> Ints:
        """The quadrilaterals (4, p p) between neighbouring nodes of an element, for pictures.

        Each quadrilateral is given by its four corners, as node numbers within the element.
        """
        at = self._node_numbers_within_element
        return np.array([at[:-1, :-1], at[:-1, 1:], at[1:, 1:], at[1:, :-1]]).reshape(4, -1)

    @cached_property
    def boundary_nodes_around_each_element(self) -> Ints:
        """The nodes (4 p, elements) on the boundary of each element, in order around it."""
        # Take the nodes along the first edge, the right side, the last edge and the left side.
        at = self._node_numbers_within_element
        around = np.concatenate([at[0, :-1], at[:-1, -1], at[-1, :0:-1], at[:0:-1, 0]])
        return self.element_dofs[around]

    def shape_function_gradients_at_element_nodes(self, elements: Ints) -> Floats:
        """The gradients (a, 2, elements, a) [1/m] of shape functions at the nodes of elements.

        The first axis counts shape functions, the second x and y, the last nodes. `elements` are
        the numbers of the elements.
        """
        # The derivatives on the unit square are multiplied with the inverse of the Jacobian matrix
        # J.
        _, slopes = shape_function_values_and_slopes(
            self.degree,
            points_of_square_tensor_grid(node_positions_on_edge_from_0_to_1(self.degree)),
        )
        J = np.einsum("can,adq->nqcd", self.doflocs[:, self.element_dofs[:, elements]], slopes)
        return np.asarray(np.einsum("adq,nqdc->acnq", slopes, np.linalg.inv(J)))

    @cached_property
    def element_nodes_boundary_nodes_first(self) -> Ints:
        """The numbers of the nodes of each element (elements, a), boundary nodes first.

        They are in the order of `element.ReferenceElement`.
        """
        return np.ascontiguousarray(
            self.element_dofs[reference_element_of_degree(self.degree).order].T
        )

    @cached_property
    def node_coordinates_of_each_element(self) -> Floats:
        """The coordinates (elements, 2, a) [m] of each element's nodes, boundary nodes first."""
        return np.ascontiguousarray(
            self.doflocs[:, self.element_nodes_boundary_nodes_first].transpose(1, 0, 2)
        )

    def elasticity_matrix_times_width_of_each_element(
        self, layers: Mapping[str, ElasticLayer]
    ) -> Floats:
        """The elasticity matrix times the width, for each element (elements, 3, 3) [N/m]."""
        matrices = np.zeros((self.element_dofs.shape[1], 3, 3))
        for name, elements in self.subdomains.items():
            matrices[elements] = layers[name].elasticity_times_width
        return matrices

    def unit_vectors_along_layers_at_gauss_points(
        self, layers: Mapping[str, ElasticLayer], xy: Any
    ) -> Any:
        """The unit vectors (elements, 2, q) along the layers at the Gauss points of all elements.

        `xy` (elements, 2, a) are the nodes of the elements. None is returned if all layers are
        isotropic.
        """
        if not any(
            which_elasticity_matrices_are_orthotropic(layers[name].elasticity)
            for name in self.subdomains
        ):
            return None
        points = gauss_points_of_elements(xy, self.degree)
        directions = np.empty_like(points)
        for name, elements in self.subdomains.items():
            of_layer = layers[name].unit_vectors_along_layer(np.moveaxis(points[elements], 1, 0))
            directions[elements] = np.moveaxis(of_layer, 0, 1)
        return directions

    def stiffness(self, layers: Mapping[str, ElasticLayer], *, precise: bool = False) -> Any:
        """The plane-stress stiffness (2 N, 2 N) [N/m] of the body; with `precise` in long double.

        The unknown 2 i + c is the displacement of node i in direction c: 0 for x, 1 for y.
        """
        kind = np.longdouble if precise else float
        xy = self.node_coordinates_of_each_element.astype(kind)
        along = self.unit_vectors_along_layers_at_gauss_points(layers, xy)
        K = plane_stress_stiffness_of_elements(
            xy,
            self.elasticity_matrix_times_width_of_each_element(layers).astype(kind),
            self.degree,
            along,
        )
        return assemble_sparse_stiffness(K, self.element_nodes_boundary_nodes_first, self.N)

    def nodal_forces_of_layer_expansion(
        self, layers: Mapping[str, ElasticLayer], strains: FreeStrainFunctionByLayer
    ) -> Floats:
        """The nodal forces (2 N,) [N] that are equivalent to free strains of the layers.

        Free strains, such as thermal expansion, cause no stress in a layer that is not bonded to
        others.
        """
        xy = self.node_coordinates_of_each_element
        points = gauss_points_of_elements(xy, self.degree)
        forces = np.zeros((self.N, 2))
        for name, strain in strains.items():
            elements = self.subdomains[name]
            at = np.moveaxis(points[elements], 1, 0)
            stress = stress_times_width_of_free_strain(layers[name], strain(at), at)
            held = np.moveaxis(stress, 2, 0)
            own = nodal_forces_of_element_stresses(xy[elements], held, self.degree)
            np.add.at(forces, self.element_nodes_boundary_nodes_first[elements], own)
        return forces.ravel()

    @property
    def element_quadrature(self) -> ElementQuadrature:
        """The Gauss points of all elements, with the shape functions and the areas there."""
        xy = self.node_coordinates_of_each_element
        _, areas = shape_function_gradients_and_gauss_areas(xy, self.degree)
        return ElementQuadrature(
            xy=np.moveaxis(gauss_points_of_elements(xy, self.degree), 1, 0),
            shapes=reference_element_of_degree(self.degree).values,
            areas=areas,
            nodes=self.element_nodes_boundary_nodes_first,
            parts=self.subdomains,
        )

    @cached_property
    def grid_without_inner_element_nodes(self) -> "ElementBoundaryGrid":
        """The skeleton of the grid: the nodes on the boundaries of its elements."""
        dofs = self.element_nodes_boundary_nodes_first[
            :, : reference_element_of_degree(self.degree).outer
        ]
        nodes = np.unique(dofs)
        number = np.full(self.N, -1)
        number[nodes] = np.arange(len(nodes))
        return ElementBoundaryGrid(self, nodes, number, number[dofs].T)


@dataclass(frozen=True)
class ElementBoundaryGrid:
    """The skeleton of a grid: the nodes on the boundaries of its elements, without inner nodes.

    A grid of high degree has most of its unknowns inside its elements. The inner unknowns of an
    element couple with its own boundary only, so that each element is condensed on its own. A
    skeleton has the attributes of a scikit-fem basis, as a grid has.

    Attributes
    ----------
    grid : the grid with all nodes
    nodes : (N,) numbers of the skeleton's nodes in the grid
    number : (grid nodes,) number of each node of the grid in the skeleton, -1 for a node inside an
        element
    element_dofs : (4 p, elements) boundary nodes of each element, as numbers in the skeleton
    """

    grid: HpElementGrid
    nodes: Ints
    number: Ints
    element_dofs: Ints

    @property
    def N(self) -> int:
        """Number of nodes of the skeleton."""
        return len(self.nodes)

    @property
    def doflocs(self) -> Floats:
        """The coordinates of the skeleton's nodes (2, N) [m]."""
        return self.grid.doflocs[:, self.nodes]

    @property
    def dofs(self) -> Ints:
        """The indices (2 N,) of the skeleton's displacements among all displacements of the grid.

        The displacements x and y of a node are next to each other.
        """
        return np.asarray((2 * self.nodes[:, None] + np.arange(2)).ravel())

    def indices_in_this_basis_of_grid_nodes(self, nodes: Ints) -> Ints:
        """The numbers of nodes in the skeleton, from their numbers in the grid."""
        return self.number[nodes]

    def stiffness(self, layers: Mapping[str, ElasticLayer]) -> Any:
        """The stiffness (2 N, 2 N) [N/m] on the skeleton, without inner nodes of elements."""
        grid = self.grid
        xy, along = (
            grid.node_coordinates_of_each_element,
            grid.unit_vectors_along_layers_at_gauss_points(
                layers, grid.node_coordinates_of_each_element
            ),
        )
        K = condensed_element_stiffness(
            xy[:, None],
            grid.elasticity_matrix_times_width_of_each_element(layers),
            grid.degree,
            along,
        )
        return assemble_sparse_stiffness(K, self.element_dofs.T, self.N)

    def condensed_forces_on_element_boundaries_and_inner_work(
        self, layers: Mapping[str, ElasticLayer], forces: Floats
    ) -> tuple[Floats, Floats]:
        """The equivalent forces on the skeleton for forces on all nodes of the grid.

        Parameters
        ----------
        layers : elastic layers of the body by name
        forces : (2 grid nodes, k) nodal forces [N] of k load cases

        Returns
        -------
        the forces (2 N, k) [N] on the nodes of the skeleton, and the work (k, k) of the forces
        inside elements on the displacements that they cause while the skeleton's nodes are fixed
        """
        grid, count = self.grid, forces.shape[1]
        xy, along = (
            grid.node_coordinates_of_each_element,
            grid.unit_vectors_along_layers_at_gauss_points(
                layers, grid.node_coordinates_of_each_element
            ),
        )
        # The forces on inner nodes become forces on the elements' boundaries, and are added to the
        # forces given there.
        inner = self._forces_on_inner_element_nodes(forces)
        condensed = condense_inner_forces_to_element_boundary(
            xy,
            grid.elasticity_matrix_times_width_of_each_element(layers),
            grid.degree,
            along,
            inner,
        )
        on_sides = forces.reshape(grid.N, 2, count)[self.nodes]
        by_node = condensed.forces.reshape(len(inner), -1, 2, count)
        np.add.at(on_sides, self.element_dofs.T, by_node)
        return on_sides.reshape(2 * self.N, count), condensed.work

    def _forces_on_inner_element_nodes(self, forces: Floats) -> Floats:
        """The forces on the i inner nodes of each element, from the forces on all nodes.

        The given forces are (2 grid nodes, k), the returned forces (elements, 2 i, k).
        """
        inside = self.grid.element_nodes_boundary_nodes_first[:, len(self.element_dofs) :]
        by_node = forces.reshape(self.grid.N, 2, -1)
        return by_node[inside].reshape(len(inside), -1, forces.shape[1])

    def displacements_of_all_grid_nodes(
        self, layers: Mapping[str, ElasticLayer], u: Floats, forces: Floats | None = None
    ) -> Floats:
        """The displacements (2 grid nodes, m) [m] of all nodes of the grid.

        Parameters
        ----------
        layers : elastic layers of the body by name
        u : (2 N, m) displacements of the skeleton's nodes [m], for m load cases
        forces : (2 grid nodes, m) nodal forces [N], of which only those inside elements are used;
            None if no force acts inside elements
        """
        grid = self.grid
        everywhere = np.empty((grid.N, 2, u.shape[1]))
        on_sides = u.reshape(self.N, 2, -1)
        everywhere[self.nodes] = on_sides
        # The inner nodes of each element follow from its boundary nodes.
        outer = on_sides[self.element_dofs.T].reshape(
            len(grid.element_nodes_boundary_nodes_first), -1, u.shape[1]
        )
        xy, along = (
            grid.node_coordinates_of_each_element,
            grid.unit_vectors_along_layers_at_gauss_points(
                layers, grid.node_coordinates_of_each_element
            ),
        )
        own = None if forces is None else self._forces_on_inner_element_nodes(forces)
        inner = displacements_of_inner_element_nodes(
            xy,
            grid.elasticity_matrix_times_width_of_each_element(layers),
            grid.degree,
            along,
            outer,
            own,
        )
        inside = grid.element_nodes_boundary_nodes_first[:, len(self.element_dofs) :]
        everywhere[inside] = inner.reshape(*inside.shape, 2, -1)
        return everywhere.reshape(2 * grid.N, -1)


BodySystemAssemblyFunction = Callable[[HpElementGrid | ElementBoundaryGrid], UncondensedBodySystem]
"""A function that assembles a body's system of equations: stiffness, constraints and loads.

Its argument gives the nodes whose displacements are unknowns: all nodes of a grid, or only the
nodes on the boundaries of elements (its skeleton).
"""


@dataclass(frozen=True)
class EliminatedUnknownsOfHpElementBody:
    """The displacements of a body in hp elements that its condensation has eliminated.

    They are computed again from the contact forces, the unit loads and the motion of the frame (the
    rigid face that the hinge holds): first on the skeleton (the nodes on the boundaries of
    elements), then inside the elements one by one. The class is a
    `substructure.body.EliminatedUnknownsAndEquationsOfAnyBody`.

    Attributes
    ----------
    grid : all nodes and elements of the body
    layers : elastic layers of the body by name
    whole_system : function that makes the body's system of equations before condensation, with the
        unit loads that act on boundaries of elements
    forces_of_further_loads : (2 grid nodes, k) nodal forces of k additional unit loads, which may
        act inside elements; they come after the other unit loads
    """

    grid: HpElementGrid
    layers: Mapping[str, ElasticLayer]
    whole_system: BodySystemAssemblyFunction
    forces_of_further_loads: Floats

    @classmethod
    def eliminated_unknowns_with_system_loads_only(
        cls,
        grid: HpElementGrid,
        layers: Mapping[str, ElasticLayer],
        whole_system: BodySystemAssemblyFunction,
    ) -> "EliminatedUnknownsOfHpElementBody":
        """Make the eliminated unknowns of a body with no unit loads but those of `whole_system`."""
        return cls(grid, layers, whole_system, np.zeros((2 * grid.N, 0)))

    def equations_of_body_before_condensation(self) -> UncondensedBodySystem:
        """The body's system of equations before condensation, on all nodes of its grid."""
        return self._system_with_further_unit_loads(
            self.whole_system(self.grid), self.forces_of_further_loads
        )

    def copy_with_further_unit_loads(self, forces: Floats) -> "EliminatedUnknownsOfHpElementBody":
        """A copy with k additional unit loads, given as nodal forces (2 grid nodes, k)."""
        return replace(
            self, forces_of_further_loads=np.hstack([self.forces_of_further_loads, forces])
        )

    def condense_loads_and_stiffness(self) -> CondensedSystem:
        """The unit loads and the stiffness, condensed to the contact nodes and the frame.

        The frame is the rigid face that the hinge holds. The inner nodes of elements are eliminated
        first, and then the skeleton's nodes outside contact and hinge.
        """
        sides = self.grid.grid_without_inner_element_nodes
        on_sides, inner_work = sides.condensed_forces_on_element_boundaries_and_inner_work(
            self.layers, self.forces_of_further_loads
        )
        system = self._system_with_further_unit_loads(self.whole_system(sides), on_sides)
        # The work of the additional loads inside elements is added to the work of the loads on the
        # skeleton.
        S, loads, work = system.condense_loads_and_stiffness()
        first = len(work) - len(inner_work)
        work[first:, first:] += inner_work
        return CondensedSystem(S, loads, work)

    def nodal_displacements_in_load_cases(
        self, nodal: Floats, frame: Floats, loads: Floats
    ) -> Floats:
        """The displacements (2 grid nodes, m) [m] of all nodes in m load cases.

        In each load case, forces `nodal` (2n, m) [N] act on the n contact nodes, and the unit loads
        act with the factors `loads` (l, m). The rigid face that the hinge holds moves by `frame`
        (3, m).
        """
        sides, count = (
            self.grid.grid_without_inner_element_nodes,
            self.forces_of_further_loads.shape[1],
        )
        system = self.whole_system(sides)
        # Without additional loads no force acts inside elements.
        if not count:
            on_sides = system.nodal_displacements_in_load_cases(nodal, frame, loads)
            return sides.displacements_of_all_grid_nodes(self.layers, on_sides)
        forces_on_sides, _ = sides.condensed_forces_on_element_boundaries_and_inner_work(
            self.layers, self.forces_of_further_loads
        )
        system = self._system_with_further_unit_loads(system, forces_on_sides)
        on_sides = system.nodal_displacements_in_load_cases(nodal, frame, loads)
        forces = self.forces_of_further_loads @ loads[len(loads) - count :]
        return sides.displacements_of_all_grid_nodes(self.layers, on_sides, forces)

    def _system_with_further_unit_loads(
        self, system: UncondensedBodySystem, forces: Floats
    ) -> UncondensedBodySystem:
        """The system of equations with k additional unit loads, given as nodal forces (2 N, k)."""
        return system.copy_with_further_unit_loads(forces) if forces.shape[1] else system
