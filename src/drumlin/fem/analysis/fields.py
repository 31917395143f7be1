"""Displacements and stresses inside the bodies: recovered only where a picture asks for them."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import skfem

from drumlin.base.arrays import Floats, Ints
from drumlin.base.errors import BadInput
from drumlin.base.files import replacing
from drumlin.brake.brake import Brake, Frame, Shoe
from drumlin.brake.elasticity import ElasticLayer
from drumlin.fem.hp.grid import ColumnGrid
from drumlin.fem.mesh.arc import kind_of
from drumlin.fem.preparation.bodies import ShoeSubstructure, actuation
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.fem.substructure.elasticity import layers_of, ring_layers, stress
from drumlin.fem.substructure.interface import Directions, radial, straight
from drumlin.response.balance import loaded
from drumlin.response.response import Response, ShoeResponse


@dataclass(frozen=True)
class Fields:
    """Fields of one shoe in the brake's frame; nodes stand once for each material that meets in
    them.

    `points` (n, 2) [m], `cells` (m, k), `part` (m,): number of the subdomain, `displacement` (n, 2)
    [m], `stress` (n, 3): xx, yy, xy [Pa], `von_mises` (n,) [Pa], `pressure` (n,) [Pa] on the
    friction surface, `push` (n, 2) [Pa]: the normal traction of drum or plane on the lining.
    """

    points: Floats
    cells: Ints
    cell_type: str
    part: Ints
    displacement: Floats
    stress: Floats
    von_mises: Floats
    pressure: Floats
    push: Floats


def fields(scene: PreparedModel, brake: Brake, response: Response, index: int) -> Fields:
    """Recover the fields of shoe `index` from the contact pressure of its response, and the force
    it has there.
    """
    shoe, body, answer = (
        loaded(brake, response).shoes[index],
        scene.bodies[index],
        response.shoes[index],
    )
    p = answer.pressure[:: shoe.frame.sense]
    u = displaced(body, brake, shoe, answer, p).reshape(-1, 2).T
    pressure = np.zeros(body.basis.N)
    pressure[body.line.nodes] = p
    way = straight if shoe.flat else radial(shoe.sign)
    return _fields(
        body.mesh, body.basis, u, layers_of(shoe), pressure, shoe.frame, shoe.points, way
    )


def ring_fields(scene: PreparedModel, brake: Brake, response: Response) -> Fields:
    """Recover the fields of the drum ring from the contact pressures of all shoes."""
    ring, section = scene.ring, brake.ring.section if brake.ring else None
    if ring is None or section is None:
        raise BadInput("drum.ring: is missing, a rigid drum has no fields")
    p = [
        answer.pressure[:: shoe.frame.sense]
        for shoe, answer in zip(brake.shoes, response.shoes, strict=True)
    ]
    u = ring.displacement(p, brake.drag)
    layers, pressure = ring_layers(section), np.zeros(ring.basis.N)
    return _fields(ring.mesh, ring.basis, u, layers, pressure, Frame(0.0, 1), np.asarray, radial(1))


def all_fields(scene: PreparedModel, brake: Brake, response: Response) -> list[Fields]:
    """The fields of each shoe, and after them those of the drum ring where it is elastic."""
    found = [fields(scene, brake, response, i) for i in range(len(brake.shoes))]
    if scene.ring is not None:
        found.append(ring_fields(scene, brake, response))
    return found


def _fields(
    mesh: Any, basis: Any, u: Floats, layers: dict[str, ElasticLayer], pressure: Floats, frame: Frame,
    place: Callable[[Floats], Floats], directions: Directions,
) -> Fields:  # fmt: skip
    """Fields in the brake's frame, where `place` has points (2, n), from displacements u (2, nodes)
    and nodal pressure in the body's own frame; directions: the lining's normals there.
    """
    parts = list(mesh.subdomains)
    blocks = [_part(basis, u, name, layers[name]) for name in parts]
    starts = np.cumsum([0] + [len(block[0]) for block in blocks])
    nodes = np.concatenate([block[0] for block in blocks])
    xy = basis.doflocs[:, nodes]
    turn = frame.to_brake(np.eye(2))
    tensor = np.concatenate([block[2] for block in blocks])
    rotated = np.einsum("ia,nij,jb->nab", turn, tensor, turn)
    xx, yy, shear = rotated[:, 0, 0], rotated[:, 1, 1], rotated[:, 0, 1]
    p = pressure[nodes]
    for k, name in enumerate(parts):
        if name != "lining":
            p[starts[k] : starts[k + 1]] = 0.0  # where shoe or backing end in the friction surface
    return Fields(
        points=place(xy).T,
        cells=np.concatenate(
            [block[1] + start for start, block in zip(starts[:-1], blocks, strict=True)]
        ),
        cell_type="quad" if isinstance(mesh, ColumnGrid) else kind_of(mesh).cell,
        part=np.concatenate([np.full(len(block[1]), i) for i, block in enumerate(blocks)]),
        displacement=frame.to_brake(u[:, nodes].T),
        stress=np.column_stack([xx, yy, shear]),
        von_mises=np.sqrt(xx**2 - xx * yy + yy**2 + 3 * shear**2),
        pressure=p,
        push=-p[:, None] * frame.to_brake(directions(xy)[0].T),
    )


def displaced(
    body: ShoeSubstructure, brake: Brake, shoe: Shoe, answer: ShoeResponse, p: Floats
) -> Floats:
    """Displacements (d nodes,) [m] of all nodes in the shoe's frame, under the pressure p (n,) [Pa]
    on its lining.
    """
    load = abs(shoe.actuation.force) * actuation(body, shoe)[0]
    nodal = brake.drag_on(shoe) * (body.coupling.T.T @ p) - body.coupling.N.T @ p
    motion = np.array(answer.motion or (0.0, 0.0, shoe.frame.sense * (answer.turn or 0.0)))
    return body.condensed.displacements(nodal[:, None], motion[:, None], load[:, None])[:, 0]


def _part(basis: Any, u: Floats, name: str, layer: ElasticLayer) -> tuple[Ints, Ints, Floats]:
    """Nodes, cells (numbered within the nodes) and nodal mean stresses (n, 2, 2) of one subdomain."""
    mesh = basis if isinstance(basis, ColumnGrid) else basis.mesh
    dofs, slopes, cut = _at_nodes(mesh, mesh.subdomains[name])
    gradient = np.einsum("ian,ajnq->ijnq", u[:, dofs], slopes)
    along = layer.directions(basis.doflocs[:, dofs].transpose(0, 2, 1))
    nodes, cells, mean = mean_of(stress(gradient, layer.elasticity, along), dofs)
    return nodes, cells[cut].reshape(len(cut), -1).T, mean


def mean_of(values: Floats, dofs: Ints) -> tuple[Ints, Ints, Floats]:
    """The means of tensors (d, d, m, a) at the nodes of m elements, whose nodes are dofs (a, m).

    Returns the nodes (n,), dofs as numbers within them (a, m), and the means (n, d, d).
    """
    nodes, cells = np.unique(dofs, return_inverse=True)
    cells = cells.reshape(dofs.shape)
    total = np.zeros((len(nodes), *values.shape[:2]))
    np.add.at(total, cells, values.transpose(3, 2, 0, 1))
    return nodes, cells, total / np.bincount(cells.ravel())[:, None, None]


def _at_nodes(mesh: Any, elements: Ints) -> tuple[Ints, Floats, Ints]:
    """Of elements: their nodes (a, n), the gradients (a, 2, n, a) of the shape functions there, and
    the corners (k, c) of the c cells that each is drawn as, by their places in `a`.
    """
    if isinstance(mesh, ColumnGrid):
        dofs = mesh.element_dofs[:, elements]
        return dofs, mesh.gradients(elements), mesh.quarters
    element = kind_of(mesh).element()
    at = element.doflocs.T
    basis = skfem.Basis(mesh, element, quadrature=(at, np.ones(at.shape[1])), elements=elements)
    slopes = np.array([psi[0].grad for psi in basis.basis])
    return basis.element_dofs, slopes, np.arange(len(slopes))[:, None]


HEADS = {
    "displacement [m]": "displacement",
    "stress xx, yy, xy [Pa]": "stress",
    "von Mises [Pa]": "von_mises",
    "pressure [Pa]": "pressure",
    "push of the drum [Pa]": "push",
}


def write_vtu(path: Path, parts: Sequence[Any]) -> None:
    """Write the `Fields` or `SolidFields` of all shoes as one .vtu file for ParaView, with units in
    the names.
    """
    starts = np.cumsum([0] + [len(part.points) for part in parts])

    def joined(name: str) -> Floats:
        values = np.concatenate([getattr(part, name) for part in parts])
        return (
            np.column_stack([values, np.zeros(len(values))]) if values.shape[1:] == (2,) else values
        )

    mesh = meshio.Mesh(
        joined("points"),
        [
            (part.cell_type, part.cells + start)
            for part, start in zip(parts, starts[:-1], strict=True)
        ],
        point_data={head: joined(name) for head, name in HEADS.items() if hasattr(parts[0], name)},
        cell_data={
            "part": [part.part for part in parts],
            "shoe": [np.full(len(part.cells), i) for i, part in enumerate(parts)],
        },
    )
    with replacing(path) as partial:
        meshio.write(partial, mesh, file_format="vtu")
