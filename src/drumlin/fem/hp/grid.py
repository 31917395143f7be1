"""All nodes and elements of a body of columns, numbered: what pictures, files, slopes and
refinement need, made if asked.

It stands where skfem's basis stands for a body on a mesh.
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
    """A rectangle of elements: `id` (rows, columns) of its nodes, their `depth` (rows,) and place
    `along` (columns,).
    """

    id: Ints
    depth: Floats
    along: Floats
    part: tuple[str, ...]


@dataclass(frozen=True)
class ColumnGrid:
    """Nodes and elements of degree `degree` in `blocks`; `place`(depth, along) are their points (2,
    ...) [m].

    The contact nodes come first, by growing angle where the blocks have them so. `sets`: nodes by
    name.
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
            names += [
                part for part in block.part for _ in range((block.id.shape[1] - 1) // self.degree)
            ]
        return {name: np.flatnonzero(np.array(names) == name) for name in dict.fromkeys(names)}

    @cached_property
    def quarters(self) -> Ints:
        """Places in an element of the corners (4, p p) of the quadrilaterals between its nodes."""
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
        """Gradients (a, 2, elements, a) [1/m] of an element's shape functions at its nodes."""
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
        """Unit vectors along the layers (elements, 2, q) at the Gauss points of elements with nodes
        xy (elements, 2, a); None where all layers are isotropic."""
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
        """Plane-stress stiffness (2 N, 2 N), unknown 2 i + c for component c of node i [N/m];
        precise: long double."""
        kind = np.longdouble if precise else float
        xy = np.ascontiguousarray(
            self.doflocs.astype(kind)[:, self.ordered_dofs].transpose(1, 0, 2)
        )
        K = stiffness(xy, self.elasticity(layers).astype(kind), self.degree, self.along(layers, xy))
        return _assembled(K, self.ordered_dofs, self.N)

    @cached_property
    def skeleton(self) -> "Skeleton":
        """Its nodes on the sides of elements."""
        dofs = self.ordered_dofs[:, : element(self.degree).outer]
        nodes = np.unique(dofs)
        place = np.full(self.N, -1)
        place[nodes] = np.arange(len(nodes))
        return Skeleton(self, nodes, place, place[dofs].T)


@dataclass(frozen=True)
class Skeleton:
    """The nodes on the sides of a grid's elements, `nodes` (N,) of the grid's, without those inside
    elements.

    `place` (grid nodes,): which of them a node of the grid is, -1 for a node inside; `element_dofs`
    (4 p, elements). It stands where a basis stands: a grid of high degree has most of its unknowns
    inside its elements, and their elimination touches no other element.
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
        """Its displacements (2 N,) among those of the grid, x and y of a node together."""
        return np.asarray((2 * self.nodes[:, None] + np.arange(2)).ravel())

    def stiffness(self, layers: Mapping[str, ElasticLayer]) -> Any:
        """Stiffness (2 N, 2 N) [N/m] without what is inside the elements."""
        grid = self.grid
        xy, along = grid.element_nodes, grid.along(layers, grid.element_nodes)
        K = condensed_elements(xy[:, None], grid.elasticity(layers), grid.degree, along)
        return _assembled(K, self.element_dofs.T, self.N)

    def everywhere(self, layers: Mapping[str, ElasticLayer], u: Floats) -> Floats:
        """Displacements (2 grid nodes, m) of all nodes by those of its own, u (2 N, m); no force
        acts on the others."""
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
    """The sparse stiffness (2 N, 2 N) of elements with nodes dofs (e, a); K: (e, 2 a, 2 a), x and y
    of a node together."""
    import scipy.sparse as sp  # noqa: PLC0415  (only where the whole system is put together)

    both = (2 * dofs[:, :, None] + np.arange(2)).reshape(len(dofs), -1).astype(np.int32)
    rows = np.broadcast_to(both[:, :, None], (*both.shape, both.shape[1]))
    at = rows.ravel(), np.swapaxes(rows, 1, 2).ravel()
    return sp.coo_matrix((K.ravel(), at), shape=(2 * N, 2 * N)).tocsc()
