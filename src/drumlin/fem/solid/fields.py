"""Displacements and stresses inside solid shoes: recovered only where a picture asks for them."""

from typing import Any, NamedTuple

import numpy as np
import skfem

from drumlin.base.arrays import Floats, Ints
from drumlin.brake.brake import Brake
from drumlin.brake.elasticity import ElasticLayer
from drumlin.fem.analysis.fields import nodal_means, shoe_displacements
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.fem.solid.body import solid_layers
from drumlin.response.balance import loaded
from drumlin.response.response import Response

_BOTTOM = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
_CORNERS = np.array([*_BOTTOM, *((x, y, 1) for x, y, _ in _BOTTOM)], dtype=float)
_EDGES = [
    (0, 1),
    (1, 2),
    (2, 3),
    (3, 0),
    (4, 5),
    (5, 6),
    (6, 7),
    (7, 4),
    (0, 4),
    (1, 5),
    (2, 6),
    (3, 7),
]
_TURNED = [
    4,
    5,
    6,
    7,
    0,
    1,
    2,
    3,
    12,
    13,
    14,
    15,
    8,
    9,
    10,
    11,
    16,
    17,
    18,
    19,
]  # bottom and top exchanged


def serendipity(cells: Ints) -> Ints:
    """Nodes (m, 20) of hexahedra with 20 nodes, in the order of VTK and of CalculiX's C3D20, of
    skfem's (27, m).
    """
    places = np.vstack([_CORNERS, *(_CORNERS[list(edge)].mean(axis=0) for edge in _EDGES)])
    local = skfem.ElementHex2.doflocs
    order = [int(np.flatnonzero((local == place).all(axis=1))[0]) for place in places]
    return np.asarray(cells[order].T)


def oriented(points: Floats, cells: Ints) -> Ints:
    """Cells (m, 20) of nodes at `points` (n, 3) that all have a positive volume: a mirror image
    turns them over.
    """
    a, b, c, d = (points[cells[:, i]] for i in (0, 1, 3, 4))
    volume = np.einsum("mi,mi->m", np.cross(b - a, c - a), d - a)
    return np.where((volume > 0)[:, None], cells, cells[:, _TURNED])


class SolidFields(NamedTuple):
    """Fields of half a shoe (z >= 0) in the brake's frame; nodes stand once for each material that
    meets in them.

    `points` (n, 3) [m], `cells` (m, 20), `part` (m,): number of the subdomain, `displacement` (n,
    3) [m], `von_mises` (n,) [Pa], `pressure` (n,) [Pa] on the friction surface.
    """

    points: Floats
    cells: Ints
    part: Ints
    displacement: Floats
    von_mises: Floats
    pressure: Floats
    cell_type: str = "hexahedron20"


def recover(scene: PreparedModel, brake: Brake, response: Response, index: int) -> SolidFields:
    """Recover the fields of shoe `index` from the contact pressure of its response."""
    brake = loaded(brake, response)
    shoe, body, answer = brake.shoes[index], scene.bodies[index], response.shoes[index]
    frame = shoe.frame
    p = np.zeros(len(body.line.nodes))
    if answer.surface is not None:
        m = len(answer.surface.z) // 2
        p = np.ascontiguousarray(answer.surface.pressure[:: frame.sense, m:]).ravel()
    u = shoe_displacements(body, brake, shoe, answer, p).reshape(-1, 3).T
    pressure = np.zeros(body.basis.N)
    pressure[body.line.nodes] = p
    layers = solid_layers(shoe)
    parts = [
        (*_part(body.mesh, u, members, layers[name]), name)
        for name, members in body.mesh.subdomains.items()
    ]
    starts = np.cumsum([0, *(len(nodes) for nodes, *_ in parts)])
    nodes = np.concatenate([part[0] for part in parts])

    x, moved = body.basis.doflocs[:, nodes], u[:, nodes]
    points = np.column_stack([shoe.points(x[:2]).T, x[2]])
    cells = np.concatenate(
        [serendipity(part[1]) + start for part, start in zip(parts, starts, strict=False)]
    )
    return SolidFields(
        points=points,
        cells=oriented(points, cells),
        part=np.concatenate([np.full(part[1].shape[1], i) for i, part in enumerate(parts)]),
        displacement=np.column_stack([frame.to_brake(moved[:2].T), moved[2]]),
        von_mises=np.concatenate([part[2] for part in parts]),
        pressure=np.concatenate([pressure[part[0]] * (part[3] == "lining") for part in parts]),
    )


def _part(mesh: Any, u: Floats, elements: Ints, layer: ElasticLayer) -> tuple[Ints, Ints, Floats]:
    """Nodes, cells (27, m) numbered within them, and nodal von Mises stress (n,) of the mean
    stresses of a part.
    """
    element = skfem.ElementHex2()
    at = element.doflocs.T
    basis = skfem.Basis(mesh, element, quadrature=(at, np.ones(at.shape[1])), elements=elements)
    slopes = np.array([psi[0].grad for psi in basis.basis])
    gradient = np.einsum("ian,ajnq->ijnq", u[:, basis.element_dofs], slopes)
    lam, mu = layer.elasticity[0, 1], layer.elasticity[-1, -1]
    at_nodes = mu * (gradient + gradient.swapaxes(0, 1))
    at_nodes[range(3), range(3)] += lam * np.trace(gradient)
    nodes, cells, stress = nodal_means(at_nodes, basis.element_dofs)
    deviator = stress - np.trace(stress, axis1=1, axis2=2)[:, None, None] / 3 * np.eye(3)
    return nodes, cells, np.sqrt(1.5 * (deviator**2).sum(axis=(1, 2)))
