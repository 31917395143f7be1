"""Displacements and stresses inside solid shoes: recovered only where a picture asks for them."""

from typing import Any, NamedTuple

import numpy as np
import skfem

from drumlin.base.arrays import Floats, Ints
from drumlin.brake.brake import Brake, ShoeFrame
from drumlin.brake.elasticity import ElasticLayer
from drumlin.fem.analysis.fields import nodal_displacements_of_shoe, nodal_means_of_element_tensors
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.fem.solid.body import elastic_layers_of_solid_shoe
from drumlin.response.balance import brake_with_forces_of_response
from drumlin.response.response import Response

# Hexahedra with 20 nodes stand in the order of VTK: the corners of the bottom and of the top, then
# the middles of the edges.
# fmt: off
_BOTTOM = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
_CORNERS = np.array([*_BOTTOM, *((x, y, 1) for x, y, _ in _BOTTOM)], dtype=float)
_EDGES = [
    (0, 1), (1, 2), (2, 3), (3, 0),
    (4, 5), (5, 6), (6, 7), (7, 4),
    (0, 4), (1, 5), (2, 6), (3, 7),
]
# The order of the same nodes with bottom and top exchanged.
_TURNED = [4, 5, 6, 7, 0, 1, 2, 3, 12, 13, 14, 15, 8, 9, 10, 11, 16, 17, 18, 19]
# fmt: on


def hexahedra_with_twenty_nodes_in_vtk_order(cells: Ints) -> Ints:
    """Nodes (m, 20) of hexahedra in the order of VTK and of CalculiX's C3D20.

    `cells` (27, m) are the nodes in the order of skfem.
    """
    middles = _CORNERS[np.array(_EDGES)].mean(axis=1)
    places = np.vstack([_CORNERS, middles])
    same = (skfem.ElementHex2.doflocs == places[:, None]).all(axis=2)
    return np.asarray(cells[same.argmax(axis=1)].T)


def hexahedra_turned_to_positive_volume(points: Floats, cells: Ints) -> Ints:
    """The hexahedra `cells` (m, 8) or (m, 20), turned over where their volume is negative.

    A mirror image makes volumes negative. `points` (n, 3) are the nodes.
    """
    a, b, c, d = (points[cells[:, i]] for i in (0, 1, 3, 4))
    volume = np.einsum("mi,mi->m", np.cross(b - a, c - a), d - a)
    return np.where((volume > 0)[:, None], cells, cells[:, _TURNED[: cells.shape[1]]])


class SolidFields(NamedTuple):
    """Displacement and stress in half a shoe (z >= 0), in the brake's frame.

    A node stands once for each material that meets in it.

    Attributes
    ----------
    points : (n, 3) nodes [m]
    cells : (m, 20) or (m, 8) nodes of each cell
    part : (m,) number of the subdomain of each cell
    displacement : (n, 3) displacement of the nodes [m]
    solid_stress : (n, 6) stresses xx, yy, zz, xy, yz, xz [Pa]
    von_mises : (n,) von Mises stress [Pa]
    pressure : (n,) pressure on the friction surface [Pa], 0 elsewhere
    cell_type : name of the cells in meshio
    """

    points: Floats
    cells: Ints
    part: Ints
    displacement: Floats
    solid_stress: Floats
    von_mises: Floats
    pressure: Floats
    cell_type: str = "hexahedron20"


class _SolidPartFields(NamedTuple):
    """Fields of one subdomain.

    `nodes` (n,) are its nodes, `cells` (27, m) its cells by the positions of their nodes in
    `nodes`, and `stress` (n, 3, 3) the stress of the nodes [Pa] in the shoe's frame.
    """

    nodes: Ints
    cells: Ints
    stress: Floats


def recover_fields_in_solid_shoe(
    scene: PreparedModel, brake: Brake, response: Response, index: int
) -> SolidFields:
    """The fields in shoe `index` of a brake, from the contact pressure of its response.

    Parameters
    ----------
    scene : the prepared model of solid shoes
    brake : the brake
    response : response of the brake on the model
    index : position of the shoe in the brake
    """
    brake = brake_with_forces_of_response(brake, response)
    shoe, body, answer = brake.shoes[index], scene.bodies[index], response.shoes[index]
    p = np.zeros(len(body.line.nodes))
    if answer.surface is not None:
        m = len(answer.surface.z) // 2
        p = np.ascontiguousarray(answer.surface.pressure[:: shoe.frame.sense, m:]).ravel()
    u = nodal_displacements_of_shoe(body, brake, shoe, answer, p).reshape(-1, 3).T
    pressure = np.zeros(body.basis.N)
    pressure[body.line.nodes] = p
    layers = elastic_layers_of_solid_shoe(shoe)

    # The subdomains follow one another; a node at their interface stands once for each of them.
    parts, cells, part_of_cell, pressures = [], [], [], []
    count = 0
    for i, (name, members) in enumerate(body.mesh.subdomains.items()):
        part = _fields_in_one_subdomain_of_solid(body.mesh, u, members, layers[name])
        parts.append(part)
        cells.append(hexahedra_with_twenty_nodes_in_vtk_order(part.cells) + count)
        part_of_cell.append(np.full(part.cells.shape[1], i))
        pressures.append(pressure[part.nodes] * (name == "lining"))
        count += len(part.nodes)
    nodes = np.concatenate([part.nodes for part in parts])
    x, moved = body.basis.doflocs[:, nodes], u[:, nodes]
    points = np.column_stack([shoe.points(x[:2]).T, x[2]])
    stress = np.concatenate([part.stress for part in parts])
    return SolidFields(
        points=points,
        cells=hexahedra_turned_to_positive_volume(points, np.concatenate(cells)),
        part=np.concatenate(part_of_cell),
        displacement=np.column_stack([shoe.frame.convert_to_brake_frame(moved[:2].T), moved[2]]),
        solid_stress=stress_components_in_brake_frame(stress, shoe.frame),
        von_mises=von_mises_stress_of_solid(stress),
        pressure=np.concatenate(pressures),
    )


def _fields_in_one_subdomain_of_solid(
    mesh: Any, u: Floats, elements: Ints, layer: ElasticLayer
) -> _SolidPartFields:
    """The fields of one subdomain; the stress of a node is the mean over the elements there.

    Parameters
    ----------
    mesh : the hexahedra
    u : (3, nodes) displacement [m]
    elements : elements of the subdomain
    layer : elastic layer of the subdomain
    """
    element = skfem.ElementHex2()
    at = element.doflocs.T
    basis = skfem.Basis(mesh, element, quadrature=(at, np.ones(at.shape[1])), elements=elements)
    slopes = np.array([psi[0].grad for psi in basis.basis])
    gradient = np.einsum("ian,ajnq->ijnq", u[:, basis.element_dofs], slopes)
    lam, mu = layer.elasticity[0, 1], layer.elasticity[-1, -1]
    at_nodes = mu * (gradient + gradient.swapaxes(0, 1))
    at_nodes[range(3), range(3)] += lam * np.trace(gradient)
    return _SolidPartFields(*nodal_means_of_element_tensors(at_nodes, basis.element_dofs))


def von_mises_stress_of_solid(stress: Floats) -> Floats:
    """The von Mises stress (n,) [Pa] of stresses (n, 3, 3) [Pa]."""
    deviator = stress - np.trace(stress, axis1=1, axis2=2)[:, None, None] / 3 * np.eye(3)
    return np.sqrt(1.5 * (deviator**2).sum(axis=(1, 2)))


def stress_components_in_brake_frame(stress: Floats, frame: ShoeFrame) -> Floats:
    """The stresses xx, yy, zz, xy, yz, xz (n, 6) [Pa] in the brake's frame.

    `stress` (n, 3, 3) [Pa] are the stresses in the shoe's frame.
    """
    # Stresses are tensors: both of their indices turn with the frame.
    turn = np.eye(3)
    turn[:2, :2] = frame.convert_to_brake_frame(np.eye(2))
    turned = np.einsum("ia,nij,jb->nab", turn, stress, turn, optimize=True)
    rows, columns = [0, 1, 2, 0, 1, 0], [0, 1, 2, 1, 2, 2]
    return np.asarray(turned[:, rows, columns])
