"""All nodes and elements of a body of columns, numbered.

Pictures, files, slopes and refinement of round-off need them; they are made when asked for. The
grid stands where skfem's basis stands for a body on a mesh.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.brake.elasticity import ElasticLayer, has_directions
from drumlin.fem.hp.element import (
    condensed_elements,
    element,
    gauss_points,
    inner_displacements,
    shape_functions,
    stiffness,
)
from drumlin.response.resultants import lobatto


@dataclass(frozen=True)
class Block:
    """A rectangle of elements.

    Attributes
    ----------
    id : (rows, columns) numbers of its nodes
    depth : (rows,) their depths
    along : (columns,) their positions along the lining
    part : (layers,) the part that each layer of elements belongs to
    """

    id: Ints
    depth: Floats
    along: Floats
    part: tuple[str, ...]


@dataclass(frozen=True)
class ColumnGrid:
    """Nodes and elements of one degree.

    Attributes
    ----------
    degree : of the elements
    blocks : the rectangles of elements
    place : from depths and positions along the lining to points (2, ...) [m]
    sets : nodes by the name of their set
    N : number of nodes; the contact nodes come first, by growing angle where the blocks have them so
    """

    degree: int
    blocks: tuple[Block, ...]
    place: Callable[[Floats, Floats], Floats]
    sets: Mapping[str, Ints]
    N: int

    @cached_property
    def doflocs(self) -> Floats:
        """Points of the nodes (2, N) [m]."""
        xy = np.zeros((2, self.N))
        for block in self.blocks:
            xy[:, block.id] = self.place(block.depth[:, None], block.along)
        return xy

    @cached_property
    def element_dofs(self) -> Ints:
        """Nodes of each element (a, elements), in the order of the element's grid by rows."""
        p = self.degree
        found = []
        for block in self.blocks:
            rows, columns = (np.arange(0, size - 1, p) for size in block.id.shape)
            i = rows[:, None, None, None] + np.arange(p + 1)[:, None]
            j = columns[None, :, None, None] + np.arange(p + 1)
            found.append(block.id[i, j].reshape(-1, (p + 1) ** 2))
        return np.concatenate(found).T

    @cached_property
    def subdomains(self) -> dict[str, Ints]:
        """Elements of each part."""
        names: list[str] = []
        for block in self.blocks:
            columns = (block.id.shape[1] - 1) // self.degree
            for part in block.part:
                names += [part] * columns
        return {name: np.flatnonzero(np.array(names) == name) for name in dict.fromkeys(names)}

    @cached_property
    def quarters(self) -> Ints:
        """Corners (4, p p) of the quadrilaterals between the nodes of an element, as its local nodes."""
        at = np.arange((self.degree + 1) ** 2).reshape(self.degree + 1, -1)
        return np.array(
            [at[:-1, :-1].ravel(), at[:-1, 1:].ravel(), at[1:, 1:].ravel(), at[1:, :-1].ravel()]
        )

    @cached_property
    def outline(self) -> Ints:
        """Nodes around each element (4 p, elements)."""
        at = np.arange((self.degree + 1) ** 2).reshape(self.degree + 1, -1)
        return self.element_dofs[
            np.concatenate([at[0, :-1], at[:-1, -1], at[-1, :0:-1], at[:0:-1, 0]])
        ]

    def gradients(self, elements: Ints) -> Floats:
        """Gradients (a, 2, elements, a) [1/m] of the shape functions of elements at their nodes."""
        p = self.degree
        nodes = 0.5 * (lobatto(p) + 1)
        _, slopes = shape_functions(p, np.array([np.repeat(nodes, p + 1), np.tile(nodes, p + 1)]))
        J = np.einsum("can,adq->nqcd", self.doflocs[:, self.element_dofs[:, elements]], slopes)
        return np.asarray(np.einsum("adq,nqdc->acnq", slopes, np.linalg.inv(J)))

    @cached_property
    def ordered_dofs(self) -> Ints:
        """Nodes of each element (elements, a), in the order of `element.Element`."""
        return np.ascontiguousarray(self.element_dofs[element(self.degree).order].T)

    @cached_property
    def element_nodes(self) -> Floats:
        """Points (elements, 2, a) [m] of the nodes of each element, in that order."""
        return np.ascontiguousarray(self.doflocs[:, self.ordered_dofs].transpose(1, 0, 2))

    def elasticity(self, layers: Mapping[str, ElasticLayer]) -> Floats:
        """Elasticity matrix times the width of each element (elements, 3, 3) [N/m]."""
        found = np.zeros((self.element_dofs.shape[1], 3, 3))
        for name, elements in self.subdomains.items():
            found[elements] = layers[name].stiffness
        return found

    def along(self, layers: Mapping[str, ElasticLayer], xy: Any) -> Any:
        """Unit vectors (elements, 2, q) along the layers at the Gauss points of all elements.

        `xy` (elements, 2, a) are the nodes of the elements. The result is None where all layers are
        isotropic.
        """
        if not any(has_directions(layers[name].elasticity) for name in self.subdomains):
            return None
        points = gauss_points(xy, self.degree)
        found = np.empty_like(points)
        for name, elements in self.subdomains.items():
            found[elements] = np.moveaxis(
                layers[name].directions(np.moveaxis(points[elements], 1, 0)), 0, 1
            )
        return found

    def stiffness(self, layers: Mapping[str, ElasticLayer], *, precise: bool = False) -> Any:
        """The plane-stress stiffness (2 N, 2 N) [N/m]; with `precise` in long double.

        Unknown 2 i + c is component c of node i.
        """
        kind = np.longdouble if precise else float
        xy = np.ascontiguousarray(
            self.doflocs.astype(kind)[:, self.ordered_dofs].transpose(1, 0, 2)
        )
        K = stiffness(xy, self.elasticity(layers).astype(kind), self.degree, self.along(layers, xy))
        return _assembled(K, self.ordered_dofs, self.N)

    @cached_property
    def skeleton(self) -> "Skeleton":
        """The nodes on the sides of the elements."""
        dofs = self.ordered_dofs[:, : element(self.degree).outer]
        nodes = np.unique(dofs)
        place = np.full(self.N, -1)
        place[nodes] = np.arange(len(nodes))
        return Skeleton(self, nodes, place, place[dofs].T)


@dataclass(frozen=True)
class Skeleton:
    """The nodes on the sides of a grid's elements, without those inside.

    It stands where a basis stands. A grid of high degree has most of its unknowns inside its
    elements, and the elimination of these couples no two elements.

    Attributes
    ----------
    grid : the grid
    nodes : (N,) numbers of the nodes in the grid
    place : (grid nodes,) number of each node of the grid here, -1 for a node inside an element
    element_dofs : (4 p, elements) nodes of each element
    """

    grid: ColumnGrid
    nodes: Ints
    place: Ints
    element_dofs: Ints

    @property
    def N(self) -> int:
        """Number of nodes."""
        return len(self.nodes)

    @property
    def doflocs(self) -> Floats:
        """Points of the nodes (2, N) [m]."""
        return self.grid.doflocs[:, self.nodes]

    @property
    def dofs(self) -> Ints:
        """The numbers (2 N,) of its displacements in the grid, x and y of a node together."""
        return np.asarray((2 * self.nodes[:, None] + np.arange(2)).ravel())

    def stiffness(self, layers: Mapping[str, ElasticLayer]) -> Any:
        """The stiffness (2 N, 2 N) [N/m], with the insides of the elements condensed."""
        grid = self.grid
        xy, along = grid.element_nodes, grid.along(layers, grid.element_nodes)
        K = condensed_elements(xy[:, None], grid.elasticity(layers), grid.degree, along)
        return _assembled(K, self.element_dofs.T, self.N)

    def everywhere(self, layers: Mapping[str, ElasticLayer], u: Floats) -> Floats:
        """Displacements (2 grid nodes, m) of all nodes of the grid, from u (2 N, m) of its own.

        No force acts on the nodes inside elements.
        """
        grid = self.grid
        found = np.empty((grid.N, 2, u.shape[1]))
        on = u.reshape(self.N, 2, -1)
        found[self.nodes] = on
        outer = on[self.element_dofs.T].reshape(len(grid.ordered_dofs), -1, u.shape[1])
        along = grid.along(layers, grid.element_nodes)
        inner = inner_displacements(
            grid.element_nodes, grid.elasticity(layers), grid.degree, along, outer
        )
        inside = grid.ordered_dofs[:, len(self.element_dofs) :]
        found[inside] = inner.reshape(*inside.shape, 2, -1)
        return found.reshape(2 * grid.N, -1)


def _assembled(K: Any, dofs: Ints, N: int) -> Any:
    """The sparse stiffness (2 N, 2 N) of elements with nodes `dofs` (e, a).

    K (e, 2 a, 2 a) is the stiffness of the elements, x and y of a node together.
    """
    # Only whole systems load scipy.sparse.
    import scipy.sparse as sp  # noqa: PLC0415

    both = (2 * dofs[:, :, None] + np.arange(2)).reshape(len(dofs), -1).astype(np.int32)
    rows = np.broadcast_to(both[:, :, None], (*both.shape, both.shape[1]))
    at = rows.ravel(), np.swapaxes(rows, 1, 2).ravel()
    return sp.coo_matrix((K.ravel(), at), shape=(2 * N, 2 * N)).tocsc()
