"""The nodes on the edges of a mesh, by which its contact, hinge and loaded end are found."""

from typing import Any

import numpy as np

from drumlin.base.arrays import Ints


def nodes_along_edges(basis: Any, facets: Ints) -> Ints:
    """The nodes (order + 1, m) of m edges of a scalar basis, from one end to the other."""
    ends = basis.nodal_dofs[0][basis.mesh.facets[:, facets]]
    return np.vstack([ends[:1], *(row[None, facets] for row in basis.facet_dofs), ends[1:]])
