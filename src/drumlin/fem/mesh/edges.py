"""The nodes on the edges of a mesh's elements, for its contact, hinge and loaded end face."""

from typing import Any

import numpy as np

from drumlin.base.arrays import Ints


def nodes_along_element_edges(basis: Any, facets: Ints) -> Ints:
    """The nodes (order + 1, m) on m edges of elements, from one end of each edge to the other.

    `basis` is scikit-fem's basis of a scalar on the mesh, and `facets` (m,) are the numbers of the
    edges. The order is the degree of the elements.
    """
    ends = basis.nodal_dofs[0][basis.mesh.facets[:, facets]]
    return np.vstack([ends[:1], *(row[None, facets] for row in basis.facet_dofs), ends[1:]])


def element_edges_between_vertices_and_missing_count(mesh: Any, ends: Ints) -> tuple[Ints, int]:
    """The indices of the mesh's edges between pairs of vertices `ends` (n, 2), each once.

    The second result is the number of pairs that are no edge of the mesh.
    """
    # An edge is looked up by one number that is made of the numbers of its two vertices.
    key = mesh.facets[0].astype(np.int64) * mesh.nvertices + mesh.facets[1]
    order = np.argsort(key)
    low, high = np.sort(ends, axis=1).T
    wanted = np.unique(low * mesh.nvertices + high)
    place = order[np.minimum(np.searchsorted(key, wanted, sorter=order), len(key) - 1)]
    is_edge = key[place] == wanted
    return np.sort(place[is_edge]), int(np.count_nonzero(~is_edge))
