"""Displacements and stresses inside the bodies, recovered where a picture asks for them."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import meshio
import numpy as np
import skfem

from drumlin.base.arrays import Floats, Ints
from drumlin.base.errors import BadInput
from drumlin.base.files import replacing
from drumlin.brake.brake import Brake, Shoe, ShoeFrame
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
    """Fields of one body in the frame of the brake.

    A node stands once for each material that meets in it, since stresses jump there.

    Attributes
    ----------
    points : nodes (n, 2) [m]
    cells : nodes of each cell (m, k)
    cell_type : of the cells, by its name in meshio
    part : number of the subdomain of each cell (m,)
    displacement : (n, 2) [m]
    stress : xx, yy, xy (n, 3) [Pa]
    von_mises : equivalent stress (n,) [Pa]
    pressure : on the friction surface (n,) [Pa]
    push : normal traction of the drum or the plane on the lining (n, 2) [Pa]
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


class _Solved(NamedTuple):
    """A body with its displacements, in its own frame.

    Attributes
    ----------
    mesh, basis : the elements of the body
    layers : its materials by the names of the subdomains
    u : displacements (2, nodes) [m]
    pressure : nodal pressure (nodes,) [Pa], 0 off the contact
    """

    mesh: Any
    basis: Any
    layers: dict[str, ElasticLayer]
    u: Floats
    pressure: Floats


class _Placement(NamedTuple):
    """Where a body stands in the brake.

    Attributes
    ----------
    frame : its frame
    points : gives points (2, n) [m] of the body in the frame of the brake
    directions : gives the normals of the lining at points (2, n) [m]
    """

    frame: ShoeFrame
    points: Callable[[Floats], Floats]
    directions: Directions


class _PartFields(NamedTuple):
    """One subdomain of a body: its nodes (n,), cells (k, m) within them, mean stress (n, 2, 2)."""

    nodes: Ints
    cells: Ints
    stress: Floats


class NodalMeans(NamedTuple):
    """Means of a field at nodes.

    Attributes
    ----------
    nodes : the nodes (n,)
    cells : the nodes of each element (a, m), as numbers within `nodes`
    values : the means (n, d, d)
    """

    nodes: Ints
    cells: Ints
    values: Floats


class _ElementNodes(NamedTuple):
    """Elements at their own nodes.

    Attributes
    ----------
    dofs : nodes (a, m) of the m elements
    slopes : gradients (a, 2, m, a) of the shape functions at the nodes
    corners : corners (k, c) of the c cells that each element is drawn as, as numbers below a
    """

    dofs: Ints
    slopes: Floats
    corners: Ints


def fields(scene: PreparedModel, brake: Brake, response: Response, index: int) -> Fields:
    """The fields of shoe `index` under the contact pressure and the force of its response."""
    shoe, body = loaded(brake, response).shoes[index], scene.bodies[index]
    answer = response.shoes[index]
    p = answer.pressure[:: shoe.frame.sense]
    u = displaced(body, brake, shoe, answer, p).reshape(-1, 2).T
    pressure = np.zeros(body.basis.N)
    pressure[body.line.nodes] = p
    solved = _Solved(body.mesh, body.basis, layers_of(shoe), u, pressure)
    directions = straight if shoe.flat else radial(shoe.sign)
    return _fields(solved, _Placement(shoe.frame, shoe.points, directions))


def ring_fields(scene: PreparedModel, brake: Brake, response: Response) -> Fields:
    """The fields of the drum ring under the contact pressures of all shoes.

    Raises BadInput for a rigid drum.
    """
    ring, section = scene.ring, brake.ring.section if brake.ring else None
    if ring is None or section is None:
        raise BadInput("drum.ring: is missing, a rigid drum has no fields")
    u = ring.displacement(contact_pressures(brake, response), brake.drag)
    no_pressure = np.zeros(ring.basis.N)
    solved = _Solved(ring.mesh, ring.basis, ring_layers(section), u, no_pressure)
    return _fields(solved, _Placement(ShoeFrame(0.0, 1), np.asarray, radial(1)))


def contact_pressures(brake: Brake, response: Response) -> list[Floats]:
    """The nodal pressures (n_i,) [Pa] of each shoe, in the order of its own frame."""
    pairs = zip(brake.shoes, response.shoes, strict=True)
    return [answer.pressure[:: shoe.frame.sense] for shoe, answer in pairs]


def all_fields(scene: PreparedModel, brake: Brake, response: Response) -> list[Fields]:
    """The fields of each shoe, and after them those of the drum ring where it is elastic."""
    every = [fields(scene, brake, response, i) for i in range(len(brake.shoes))]
    if scene.ring is not None:
        every.append(ring_fields(scene, brake, response))
    return every


def displaced(
    body: ShoeSubstructure, brake: Brake, shoe: Shoe, answer: ShoeResponse, p: Floats
) -> Floats:
    """Displacements (d nodes,) [m] of all nodes of a shoe, in its own frame.

    Parameters
    ----------
    body : the substructure of the shoe
    brake : the brake
    shoe : the shoe with the force that it has in the response
    answer : the response of the shoe
    p : pressures (n,) [Pa] on its lining, in the order of its own frame
    """
    load = abs(shoe.actuation.force) * actuation(body, shoe)[0]
    nodal = brake.drag_on(shoe) * (body.coupling.T.T @ p) - body.coupling.N.T @ p
    motion = np.array(answer.motion or (0.0, 0.0, shoe.frame.sense * (answer.turn or 0.0)))
    return body.condensed.displacements(nodal[:, None], motion[:, None], load[:, None])[:, 0]


def _fields(solved: _Solved, place: _Placement) -> Fields:
    """The fields of a body in the frame of the brake."""
    mesh, basis = solved.mesh, solved.basis
    names = list(mesh.subdomains)
    parts = [_part_fields(basis, solved.u, name, solved.layers[name]) for name in names]
    starts = np.cumsum([0] + [len(part.nodes) for part in parts])
    nodes = np.concatenate([part.nodes for part in parts])
    xy = basis.doflocs[:, nodes]
    to_brake = place.frame.to_brake
    turn = to_brake(np.eye(2))
    tensor = np.concatenate([part.stress for part in parts])
    rotated = np.einsum("ia,nij,jb->nab", turn, tensor, turn)
    xx, yy, shear = rotated[:, 0, 0], rotated[:, 1, 1], rotated[:, 0, 1]
    p = solved.pressure[nodes]
    for k, name in enumerate(names):
        if name != "lining":
            # The shoe or a backing may end in the friction surface, and shares nodes with it.
            p[starts[k] : starts[k + 1]] = 0.0
    cells = [part.cells + start for start, part in zip(starts[:-1], parts, strict=True)]
    return Fields(
        points=place.points(xy).T,
        cells=np.concatenate(cells),
        cell_type="quad" if isinstance(mesh, ColumnGrid) else kind_of(mesh).cell,
        part=np.concatenate([np.full(len(part.cells), i) for i, part in enumerate(parts)]),
        displacement=to_brake(solved.u[:, nodes].T),
        stress=np.column_stack([xx, yy, shear]),
        von_mises=np.sqrt(xx**2 - xx * yy + yy**2 + 3 * shear**2),
        pressure=p,
        push=-p[:, None] * to_brake(place.directions(xy)[0].T),
    )


def _part_fields(basis: Any, u: Floats, name: str, layer: ElasticLayer) -> _PartFields:
    """The nodes, cells and mean stresses of one subdomain under displacements u (2, nodes)."""
    mesh = basis if isinstance(basis, ColumnGrid) else basis.mesh
    dofs, slopes, corners = _at_nodes(mesh, mesh.subdomains[name])
    gradient = np.einsum("ian,ajnq->ijnq", u[:, dofs], slopes)
    along = layer.directions(basis.doflocs[:, dofs].transpose(0, 2, 1))
    means = mean_of(stress(gradient, layer.elasticity, along), dofs)
    cells = means.cells[corners].reshape(len(corners), -1).T
    return _PartFields(means.nodes, cells, means.values)


def mean_of(values: Floats, dofs: Ints) -> NodalMeans:
    """The means of tensors (d, d, m, a) at the nodes of m elements, whose nodes are dofs (a, m)."""
    nodes, cells = np.unique(dofs, return_inverse=True)
    cells = cells.reshape(dofs.shape)
    total = np.zeros((len(nodes), *values.shape[:2]))
    np.add.at(total, cells, values.transpose(3, 2, 0, 1))
    return NodalMeans(nodes, cells, total / np.bincount(cells.ravel())[:, None, None])


def _at_nodes(mesh: Any, elements: Ints) -> _ElementNodes:
    """Some elements of a mesh at their own nodes."""
    if isinstance(mesh, ColumnGrid):
        dofs = mesh.element_dofs[:, elements]
        return _ElementNodes(dofs, mesh.gradients(elements), mesh.subcells)
    element = kind_of(mesh).element()
    at = element.doflocs.T
    basis = skfem.Basis(mesh, element, quadrature=(at, np.ones(at.shape[1])), elements=elements)
    slopes = np.array([psi[0].grad for psi in basis.basis])
    return _ElementNodes(basis.element_dofs, slopes, np.arange(len(slopes))[:, None])


HEADS = {
    "displacement [m]": "displacement",
    "stress xx, yy, xy [Pa]": "stress",
    "von Mises [Pa]": "von_mises",
    "pressure [Pa]": "pressure",
    "push of the drum [Pa]": "push",
}
"""The names of nodal fields in a .vtu file, with units, and the attributes of `Fields`."""


def write_vtu(path: Path, parts: Sequence[Any]) -> None:
    """Write the `Fields` or `SolidFields` of all shoes as one .vtu file for ParaView."""
    starts = np.cumsum([0] + [len(part.points) for part in parts])
    cells = []
    for part, start in zip(parts, starts[:-1], strict=True):
        cells.append((part.cell_type, part.cells + start))
    given = {head: name for head, name in HEADS.items() if hasattr(parts[0], name)}
    mesh = meshio.Mesh(
        _joined(parts, "points"),
        cells,
        point_data={head: _joined(parts, name) for head, name in given.items()},
        cell_data={
            "part": [part.part for part in parts],
            "shoe": [np.full(len(part.cells), i) for i, part in enumerate(parts)],
        },
    )
    with replacing(path) as partial:
        meshio.write(partial, mesh, file_format="vtu")


def _joined(parts: Sequence[Any], name: str) -> Floats:
    """An attribute of all parts, one after the other; vectors in the plane get z = 0."""
    values = np.concatenate([getattr(part, name) for part in parts])
    if values.shape[1:] == (2,):
        return np.column_stack([values, np.zeros(len(values))])
    return values
