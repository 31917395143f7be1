"""Displacements and stresses inside the shoes and the drum ring of a solved brake, for pictures."""

import importlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from drumlin.base.arrays import BaseClassWithArrayEquality, Floats, Ints
from drumlin.base.errors import BadInput, NoAnswer
from drumlin.base.files import temporary_file_replacing_output
from drumlin.brake.brake import Brake, Shoe, ShoeFrame
from drumlin.brake.elasticity import ElasticLayer
from drumlin.fem.hp.grid import HpElementGrid
from drumlin.fem.preparation.bodies import (
    ShoeSubstructure,
    functions_of_free_thermal_strain_by_layer,
)
from drumlin.fem.preparation.displacements import (
    friction_stress_over_friction_coefficient_of_lining,
    nodal_contact_pressures_of_each_lining,
    nodal_displacements_of_each_shoe,
    nodal_displacements_of_shoe,
)
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.fem.substructure.elasticity import (
    elastic_layers_of_ring,
    elastic_layers_of_shoe,
    stresses_from_displacement_gradients,
)
from drumlin.fem.substructure.expansion import (
    FreeStrainFunctionByLayer,
    stress_times_width_of_free_strain,
)
from drumlin.fem.substructure.interface import (
    NormalsAndTangentsFunction,
    function_that_returns_drum_normals_and_tangents,
    plane_normals_and_tangents,
)
from drumlin.response.balance import brake_with_forces_of_response
from drumlin.response.response import Response

if TYPE_CHECKING:
    import meshio


@dataclass(frozen=True, eq=False)
class StressAndDisplacementFields(BaseClassWithArrayEquality):
    """Displacements and stresses of one body at its nodes, in the frame of the brake.

    Stresses jump between materials, so that a node is repeated for each material around the node.

    Attributes
    ----------
    points : coordinates (n, 2) [m] of the nodes
    cells : numbers (m, k) of the nodes of each cell
    cell_type : type of the cells by its name in meshio
    part : number (m,) of the subdomain (material) of each cell
    displacement : displacement (n, 2) [m]
    stress : stresses xx, yy, xy (n, 3) [Pa]
    von_mises : equivalent stress (n,) [Pa]
    pressure : contact pressure (n,) [Pa] on the friction surface, 0 elsewhere
    push : pressure as a vector (n, 2) [Pa]: the normal traction of the drum or plane on the lining
    name : name of the shoe, or "drum ring"
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
    name: str = ""

    def __repr__(self) -> str:
        """A line with name, number of nodes and cells, and largest displacement and stress."""
        moved = 1e3 * float(np.linalg.norm(self.displacement, axis=1).max())
        name = f"{self.name}: " if self.name else ""
        return (
            f"{name}{len(self.points)} nodes, {len(self.cells)} cells {self.cell_type}, "
            f"displacement up to {moved:.3g} mm, "
            f"von Mises stress up to {1e-6 * self.von_mises.max():.3g} MPa"
        )

    def to_meshio(self) -> "meshio.Mesh":
        """The body as a `meshio.Mesh`, with the names of fields that a .vtu file has."""
        return meshio_mesh_with_fields_of_all_shoes([self])

    def to_pyvista(self) -> Any:
        """The body as a `pyvista.UnstructuredGrid`. Raises BadInput if pyvista is not installed."""
        try:
            pyvista = importlib.import_module("pyvista")
        except ImportError as error:
            raise BadInput(
                "to_pyvista: needs the package pyvista, which is not installed: "
                'pip install "drumlin[fields]"'
            ) from error
        return pyvista.from_meshio(self.to_meshio())


class _BodyWithNodalDisplacements(NamedTuple):
    """A body and the displacements of its nodes, in the body's own frame.

    Attributes
    ----------
    mesh, basis : the mesh of the body and the finite-element basis on the mesh
    layers : materials of the body by the names of the subdomains
    u : displacements (2, nodes) [m]
    pressure : nodal pressure (nodes,) [Pa], 0 off the contact
    strains : free strains of the heated subdomains, by name
    """

    mesh: Any
    basis: Any
    layers: dict[str, ElasticLayer]
    u: Floats
    pressure: Floats
    strains: FreeStrainFunctionByLayer = MappingProxyType({})


class _TransformationToBrakeFrame(NamedTuple):
    """Functions that transform a body from its own frame to the frame of the brake.

    Attributes
    ----------
    frame : the frame of the body, which converts vectors to the frame of the brake
    points : function that transforms the coordinates (2, n) [m] of points
    directions : function that returns the normals of the lining at points (2, n) [m]
    """

    frame: ShoeFrame
    points: Callable[[Floats], Floats]
    directions: NormalsAndTangentsFunction


class _StressesOfSubdomain(NamedTuple):
    """The nodes, cells and stresses of one subdomain, a part of a body with one material.

    Attributes
    ----------
    nodes : numbers (n,) of the subdomain's nodes among all nodes of the body
    cells : nodes (m, k) of each cell, as indices into `nodes`
    stress : nodal stress (n, 2, 2) [Pa], the mean over the elements around a node
    """

    nodes: Ints
    cells: Ints
    stress: Floats


class NodalMeansOfTensorField(NamedTuple):
    """The mean of a tensor field at each node, over the elements that meet at the node.

    Attributes
    ----------
    nodes : numbers (n,) of these nodes among all nodes of the body
    cells : indices (a, m) into `nodes`: the a nodes of each of m elements
    values : the mean tensors (n, d, d)
    """

    nodes: Ints
    cells: Ints
    values: Floats


class _ShapeFunctionsAtElementNodes(NamedTuple):
    """The nodes of m elements, and the gradients of the elements' shape functions at these nodes.

    Attributes
    ----------
    dofs : nodes (a, m) of the elements
    slopes : gradients (a, 2, m, a) [1/m] of the shape functions at the nodes
    corners : node numbers (k, c), within an element, of the k corners of each of c cells; pictures
        show the element as these cells
    """

    dofs: Ints
    slopes: Floats
    corners: Ints


def stress_and_displacement_fields_of_shoe(
    scene: PreparedModel, brake: Brake, response: Response, index: int
) -> StressAndDisplacementFields:
    """Displacements and stresses in shoe `index` under the pressure and the force of a response."""
    shoe, body = brake_with_forces_of_response(brake, response).shoes[index], scene.bodies[index]
    answer = response.shoes[index]
    p = answer.nodal_pressures_on_linings[:: shoe.frame.sense]
    u = nodal_displacements_of_shoe(body, brake, shoe, answer, p)
    return _fields_of_shoe_with_nodal_displacements(body, brake, shoe, p, u)


def _fields_of_shoe_with_nodal_displacements(
    body: ShoeSubstructure, brake: Brake, shoe: Shoe, p: Floats, displacements: Floats
) -> StressAndDisplacementFields:
    """Displacements and stresses in a shoe whose nodes have known displacements.

    Parameters
    ----------
    body, brake, shoe : the shoe's substructure, the brake, and the shoe
    p : pressures (n,) [Pa] at the contact nodes, in the order of their angle in the shoe's frame
    displacements : displacements (2 nodes,) [m] in the shoe's frame
    """
    u = displacements.reshape(-1, 2).T
    pressure = np.zeros(body.basis.N)
    pressure[body.line.nodes] = p
    solved = _BodyWithNodalDisplacements(
        body.mesh,
        body.basis,
        elastic_layers_of_shoe(shoe),
        u,
        pressure,
        functions_of_free_thermal_strain_by_layer(shoe, brake.size),
    )
    directions = (
        plane_normals_and_tangents
        if shoe.is_on_plane
        else function_that_returns_drum_normals_and_tangents(shoe.sign_internal_plus_external_minus)
    )
    return _stress_and_displacement_fields_in_brake_frame(
        solved,
        _TransformationToBrakeFrame(shoe.frame, shoe.convert_points_to_brake_frame, directions),
    )


def stress_and_displacement_fields_of_ring(
    scene: PreparedModel, brake: Brake, response: Response
) -> StressAndDisplacementFields:
    """Displacements and stresses in the drum ring under the contact pressures of all shoes.

    Raises BadInput for a rigid drum.
    """
    ring, section = scene.ring, brake.ring.section if brake.ring else None
    if ring is None or section is None:
        raise BadInput("drum.ring: is missing, a rigid drum has no fields")
    u = ring.displacements_of_ring_nodes(
        nodal_contact_pressures_of_each_lining(brake, response),
        friction_stress_over_friction_coefficient_of_each_lining(brake, response),
        list(map(brake.signed_friction_stress_over_pressure, brake.shoes)),
    )
    no_pressure = np.zeros(ring.basis.N)
    solved = _BodyWithNodalDisplacements(
        ring.mesh, ring.basis, elastic_layers_of_ring(section), u, no_pressure
    )
    return _stress_and_displacement_fields_in_brake_frame(
        solved,
        _TransformationToBrakeFrame(
            ShoeFrame(0.0, 1), np.asarray, function_that_returns_drum_normals_and_tangents(1)
        ),
    )


def friction_stress_over_friction_coefficient_of_each_lining(
    brake: Brake, response: Response
) -> list[Floats]:
    """The friction stress divided by the friction coefficient: for each shoe an array (n_i,) [Pa].

    The quotient equals the pressure, unless friction depends on the pressure. The nodes are in the
    order of their angle in the shoe's own frame.
    """
    pressures = nodal_contact_pressures_of_each_lining(brake, response)
    found = []
    for shoe, answer, p in zip(brake.shoes, response.shoes, pressures, strict=True):
        found.append(friction_stress_over_friction_coefficient_of_lining(brake, shoe, answer, p))
    return found


def stress_and_displacement_fields_of_shoes_and_ring(
    scene: PreparedModel, brake: Brake, response: Response
) -> list[StressAndDisplacementFields]:
    """Displacements and stresses in each shoe, and then in the drum ring if it is elastic.

    Raises NoAnswer for a shoe that its loads turn away from the drum, since it has no equilibrium.
    """
    loaded = brake_with_forces_of_response(brake, response)
    pressures = nodal_contact_pressures_of_each_lining(loaded, response)
    for body, shoe, p in zip(scene.bodies, loaded.shoes, pressures, strict=True):
        # The response of such a shoe has no elements.
        if len(p) != len(body.line.nodes):
            raise NoAnswer(f"shoe {shoe.name!r}: no contact, so that its stresses are not known")
    displacements = nodal_displacements_of_each_shoe(scene.bodies, loaded, response)
    every = []
    for i, shoe in enumerate(loaded.shoes):
        fields = _fields_of_shoe_with_nodal_displacements(
            scene.bodies[i], brake, shoe, pressures[i], displacements[i]
        )
        every.append(replace(fields, name=shoe.name))
    if scene.ring is not None:
        ring = stress_and_displacement_fields_of_ring(scene, brake, response)
        every.append(replace(ring, name="drum ring"))
    return every


def _stress_and_displacement_fields_in_brake_frame(
    solved: _BodyWithNodalDisplacements, place: _TransformationToBrakeFrame
) -> StressAndDisplacementFields:
    """Recover the fields of a solved body, and transform them to the frame of the brake."""
    mesh, basis = solved.mesh, solved.basis
    nodes, cells, numbers, stresses, pressures, first = [], [], [], [], [], 0
    for number, name in enumerate(mesh.subdomains):
        part = _mean_nodal_stresses_of_subdomain(solved, name)
        nodes.append(part.nodes)
        cells.append(part.cells + first)
        numbers.append(np.full(len(part.cells), number))
        stresses.append(part.stress)
        # The edge of a shoe body or a backing may meet the friction surface at the lining's end.
        # The contact pressure at such a node belongs to the lining alone.
        bears = 1.0 if name == "lining" else 0.0
        pressures.append(bears * solved.pressure[part.nodes])
        first += len(part.nodes)
    all_nodes = np.concatenate(nodes)
    xy = basis.doflocs[:, all_nodes]
    to_brake = place.frame.convert_vectors_from_shoe_to_brake_frame
    # Stresses are tensors: both of their indices turn with the frame.
    turn = to_brake(np.eye(2))
    rotated = np.einsum("ia,nij,jb->nab", turn, np.concatenate(stresses), turn)
    xx, yy, shear = rotated[:, 0, 0], rotated[:, 1, 1], rotated[:, 0, 1]
    p = np.concatenate(pressures)
    return StressAndDisplacementFields(
        points=place.points(xy).T,
        cells=np.concatenate(cells),
        cell_type={3: "triangle", 4: "quad"}[cells[0].shape[1]],
        part=np.concatenate(numbers),
        displacement=to_brake(solved.u[:, all_nodes].T),
        stress=np.column_stack([xx, yy, shear]),
        von_mises=np.sqrt(xx**2 - xx * yy + yy**2 + 3 * shear**2),
        pressure=p,
        push=-p[:, None] * to_brake(place.directions(xy)[0].T),
    )


def _mean_nodal_stresses_of_subdomain(
    solved: _BodyWithNodalDisplacements, name: str
) -> _StressesOfSubdomain:
    """The nodes, cells and mean stresses of the subdomain `name` of a solved body.

    The free thermal strains of a heated subdomain are subtracted from its strains.
    """
    basis, layer = solved.basis, solved.layers[name]
    mesh = basis if isinstance(basis, HpElementGrid) else basis.mesh
    dofs, slopes, corners = _shape_gradients_at_element_nodes(basis, mesh.subdomains[name])
    gradient = np.einsum("ian,ajnq->ijnq", solved.u[:, dofs], slopes)
    points = basis.doflocs[:, dofs].transpose(0, 2, 1)
    stress = stresses_from_displacement_gradients(
        gradient, layer.elasticity, layer.unit_vectors_along_layer(points)
    )
    if name in solved.strains:
        free_strains = solved.strains[name](points)
        stress = (
            stress - stress_times_width_of_free_strain(layer, free_strains, points) / layer.width
        )
    # Each element has its own stress at a shared node. The field is the mean of these stresses.
    means = nodal_means_of_element_tensors(stress, dofs)
    cells = means.cells[corners].reshape(len(corners), -1).T
    return _StressesOfSubdomain(means.nodes, cells, means.values)


def nodal_means_of_element_tensors(values: Floats, dofs: Ints) -> NodalMeansOfTensorField:
    """The means of tensors at the nodes of a mesh, over the elements that meet at each node.

    Parameters
    ----------
    values : tensors (d, d, m, a) at the a nodes of each of m elements
    dofs : numbers (a, m) of these nodes in the mesh
    """
    nodes, cells = np.unique(dofs, return_inverse=True)
    cells = cells.reshape(dofs.shape)
    total = np.zeros((len(nodes), *values.shape[:2]))
    np.add.at(total, cells, values.transpose(3, 2, 0, 1))
    return NodalMeansOfTensorField(nodes, cells, total / np.bincount(cells.ravel())[:, None, None])


def _shape_gradients_at_element_nodes(basis: Any, elements: Ints) -> _ShapeFunctionsAtElementNodes:
    """The gradients of the shape functions of chosen elements, at the nodes of these elements."""
    if isinstance(basis, HpElementGrid):
        dofs = basis.element_dofs[:, elements]
        return _ShapeFunctionsAtElementNodes(
            dofs,
            basis.shape_function_gradients_at_element_nodes(elements),
            basis.quadrilaterals_between_element_nodes,
        )
    slopes, _ = basis.shape_function_gradients_and_jacobian_determinants(
        basis.elem.doflocs.T, elements
    )
    return _ShapeFunctionsAtElementNodes(
        basis.element_dofs[:, elements], slopes, basis.elem.cells_between_nodes
    )


FIELD_ATTRIBUTE_BY_VTU_NAME = {
    "displacement [m]": "displacement",
    "stress xx, yy, xy [Pa]": "stress",
    "stress xx, yy, zz, xy, yz, xz [Pa]": "solid_stress",
    "von Mises [Pa]": "von_mises",
    "pressure [Pa]": "pressure",
    "push of the drum [Pa]": "push",
}
"""The attribute of a class of fields that holds each nodal field of a .vtu file.

The keys are the names of the fields in the file. The values are names of attributes of
`StressAndDisplacementFields` or of `StressAndDisplacementFieldsOfHalfShoe`.
"""


def write_fields_to_vtu_file(path: Path, parts: Sequence[Any]) -> None:
    """Write the fields of all shoes, flat or solid, as one .vtu file for ParaView."""
    # meshio takes long to load, and pictures of the fields do not need it.
    import meshio  # noqa: PLC0415

    mesh = meshio_mesh_with_fields_of_all_shoes(parts)
    with temporary_file_replacing_output(path) as partial:
        meshio.write(partial, mesh, file_format="vtu")


def write_fields_of_solved_model_to_vtu_file(
    path: Path, brake: Brake, scene: PreparedModel, response: Response
) -> None:
    """Write the fields of all bodies of a solved model as one .vtu file for ParaView."""
    write_fields_to_vtu_file(
        path, stress_and_displacement_fields_of_shoes_and_ring(scene, brake, response)
    )


def meshio_mesh_with_fields_of_all_shoes(parts: Sequence[Any]) -> "meshio.Mesh":
    """The fields of all shoes, flat or solid, as one mesh with fields at nodes and cells."""
    import meshio  # noqa: PLC0415

    cells, numbers, shoes, first = [], [], [], 0
    for i, part in enumerate(parts):
        cells.append((part.cell_type, part.cells + first))
        numbers.append(part.part)
        shoes.append(np.full(len(part.cells), i))
        first += len(part.points)
    # `StressAndDisplacementFields` and `StressAndDisplacementFieldsOfHalfShoe` have different
    # stress attributes, and only `StressAndDisplacementFields` has the attribute `push`.
    nodal = {}
    for head, name in FIELD_ATTRIBUTE_BY_VTU_NAME.items():
        if hasattr(parts[0], name):
            nodal[head] = _join_field_arrays_of_all_bodies(parts, name)
    cell_data = {"part": numbers, "shoe": shoes}
    return meshio.Mesh(_join_field_arrays_of_all_bodies(parts, "points"), cells, nodal, cell_data)


def _join_field_arrays_of_all_bodies(parts: Sequence[Any], name: str) -> Floats:
    """The values of attribute `name` of all bodies in one array; plane vectors get z = 0."""
    values = np.concatenate([getattr(part, name) for part in parts])
    if values.shape[1:] == (2,):
        return np.column_stack([values, np.zeros(len(values))])
    return values
