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
