"""A solid shoe, assembled and condensed to what contact and hinge need.

The condensed body is that of the plane model, with other matrices. The half from the mid-plane
outwards stands for the whole: its stiffness counts twice, and forces and widths are those of the
whole shoe. Nothing is pressed or dragged across the width. So displacements along z are inner
unknowns, on the friction surface too.
"""

import numpy as np

from drumlin.base.arrays import Floats, Ints
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.elasticity import ElasticLayer, solid_elasticity_matrix
from drumlin.brake.fields import Material
from drumlin.fem.mesh.edges import nodes_along_element_edges
from drumlin.fem.preparation.bodies import DividedBody, ShoeSubstructure, make_shoe_substructure
from drumlin.fem.preparation.meshes import (
    contact_line_of_meshed_shoe,
    materials_and_widths_of_shoe_parts,
)
from drumlin.fem.preparation.scene import Seconds, add_elapsed_time
from drumlin.fem.solid.face import (
    ContactFace,
    contact_surface_over_shoe_width,
    integrals_of_products_of_width_functions,
)
from drumlin.fem.solid.mesh import Solid, mesh_of_half_solid_shoe
from drumlin.fem.substructure.body import (
    FRAME,
    Constraints,
    condense_body_to_contact_and_frame,
    matrix_from_unknowns_to_displacements,
    sparse_stiffness_of_body,
)
from drumlin.fem.substructure.elimination import elimination_order_by_nested_dissection
from drumlin.fem.substructure.interface import nodal_forces_of_unit_loads_on_loaded_end
from drumlin.fem.substructure.loads import ACTUATION

HALVES = 2.0
"""Factor on the stiffness of the meshed half, which stands for both halves of a shoe."""


class SolidBody(ShoeSubstructure):
    """A condensed body whose mesh is of hexahedra."""

    @property
    def unknowns(self) -> int:
        """Number of displacement unknowns of the mesh."""
        return int(3 * self.basis.N)


def elastic_layers_of_solid_shoe(shoe: Shoe) -> dict[str, ElasticLayer]:
    """The elastic layers of a shoe by subdomain, with the stiffness of both halves."""
    layers = {}
    for name, (material, _) in materials_and_widths_of_shoe_parts(shoe).items():
        # The assertion holds of every brake that `reason_why_solid_model_does_not_apply` lets pass.
        assert isinstance(material, Material)
        layers[name] = ElasticLayer(solid_elasticity_matrix(material), HALVES)
    return layers


def subdomain_held_by_hinge(shoe: Shoe) -> str:
    """The subdomain that the hinge holds: the body, or the back part of a rigid shoe's lining."""
    if shoe.body is not None:
        return "shoe"
    return "lining" if shoe.backing is None else "backing"


def solid_nodes_that_move_with_pin(solid: Solid, shoe: Shoe) -> Ints:
    """Nodes that move as a rigid line with the pin, across the whole width."""
    line = np.unique(nodes_along_element_edges(solid.plane, solid.section.boundaries["hinge"]))
    return solid.node[line, : solid.levels(subdomain_held_by_hinge(shoe))].ravel()


def friction_surface_of_solid_shoe(solid: Solid, shoe: Shoe, radius: float) -> ContactFace:
    """The friction surface of a solid shoe on a drum of this `radius` [m]."""
    line = contact_line_of_meshed_shoe(
        solid.plane, solid.section.boundaries["contact"], shoe, radius
    )
    return contact_surface_over_shoe_width(line, solid.node, solid.z[: solid.levels("lining")])


def constraints_of_solid_shoe(
    solid: Solid, contact: Ints, rigid: Ints, pin: Floats, *, bonded: bool
) -> Constraints:
    """The constraints of a solid: inner unknowns by dissection, contact nodes as x, y pairs, frame.

    Nodes of the mid-plane do not leave it.

    Parameters
    ----------
    solid : the meshed half of a shoe
    contact : (n,) contact nodes
    rigid : nodes that move with u = (dx, dy) + rotation k x (x - pin)
    pin : (2,) point of the pin [m]
    bonded : whether the rigid nodes are bonded to a rigid shoe; they are free along z otherwise
    """
    basis = solid.basis
    order = elimination_order_by_nested_dissection(basis.doflocs, basis.element_dofs)
    inner = np.ones((basis.N, 3), dtype=bool)
    inner[contact, :2] = inner[rigid, :2] = False
    inner[solid.node[solid.node[:, 0] >= 0, 0], 2] = False
    if bonded:
        inner[rigid, 2] = False
    inside = inner[order.nodes].ravel()
    dofs = (3 * order.nodes[:, None] + np.arange(3)).ravel()[inside]
    # Regions are numbered anew without those that have no inner unknown.
    _, region = np.unique(np.repeat(order.region, 3)[inside], return_inverse=True)
    dofs = np.concatenate([dofs, (3 * contact[:, None] + np.arange(2)).ravel()])
    arm = basis.doflocs[:2, rigid] - pin[:, None]
    return Constraints(
        matrix_from_unknowns_to_displacements(dofs, 3 * basis.N, 3 * rigid, arm), region
    )


def nodal_forces_of_unit_loads_on_solid_end(solid: Solid) -> tuple[Floats, Floats]:
    """Nodal forces (nodes, 3, 3) of the unit loads on the loaded end, and their centre (2,) [m].

    The last axis counts unit force x, unit force y and unit couple, the second one the components.
    The loads are even over the width.
    """
    line, centre = nodal_forces_of_unit_loads_on_loaded_end(
        solid.plane, solid.section.boundaries["actuation"]
    )
    nodes = np.unique(nodes_along_element_edges(solid.plane, solid.section.boundaries["actuation"]))
    count = solid.levels("shoe")
    share = integrals_of_products_of_width_functions(solid.z[:count]).sum(axis=1)
    forces = np.zeros((solid.basis.N, 3, 3))
    each = line.reshape(-1, 2, 3)[nodes]
    forces[solid.node[nodes, :count], :2] = each[:, None] * (share / share.sum())[:, None, None]
    return forces, centre


def _unit_actuation_loads_of_solid_shoe(
    solid: Solid, shoe: Shoe, constraints: Constraints
) -> tuple[Floats, Floats]:
    """Unit loads (unknowns, 3) of a shoe's actuation, and the point (2,) that they act at [m].

    They are unit force x, unit force y and unit couple on the reduced unknowns.

    Parameters
    ----------
    solid : the meshed half of the shoe
    shoe : the shoe
    constraints : its reduced unknowns
    """
    # Without a loaded end the force acts on the rigid shoe, or on the grip of its body.
    if "actuation" not in solid.section.boundaries or shoe.has_support_on_back_of_body:
        loads = np.zeros((constraints.matrix.shape[1], 3))
        loads[-FRAME:] = np.eye(3)
        return loads, shoe.pin_in_shoe_frame
    forces, centre = nodal_forces_of_unit_loads_on_solid_end(solid)
    return np.asarray(constraints.matrix.T @ forces.reshape(-1, 3)), centre


def condensed_body_of_solid_shoe(
    brake: Brake, shoe: Shoe, elements: int, across: int, seconds: Seconds
) -> ShoeSubstructure:
    """The meshed, assembled and condensed body of a solid shoe.

    Parameters
    ----------
    brake, shoe : the brake and one of its shoes
    elements, across : elements along the lining, and over half of its width
    seconds : time of each phase [s], which this function adds to
    """
    with add_elapsed_time(seconds, "mesh"):
        solid = mesh_of_half_solid_shoe(shoe, brake.size, elements, across)
    with add_elapsed_time(seconds, "assembly"):
        K = sparse_stiffness_of_body(solid.basis, elastic_layers_of_solid_shoe(shoe))
    with add_elapsed_time(seconds, "ties"):
        face, rigid = (
            friction_surface_of_solid_shoe(solid, shoe, brake.size),
            solid_nodes_that_move_with_pin(solid, shoe),
        )
        bonded = shoe.body is None
        constraints = constraints_of_solid_shoe(
            solid, face.nodes, rigid, shoe.pin_in_shoe_frame, bonded=bonded
        )
        loads, centre = _unit_actuation_loads_of_solid_shoe(solid, shoe, constraints)
    with add_elapsed_time(seconds, "condensation"):
        condensed = condense_body_to_contact_and_frame(
            K, constraints, {ACTUATION: loads}, 2 * len(face.nodes)
        )
    with add_elapsed_time(seconds, "coupling"):
        divided = DividedBody(solid.mesh, solid.basis, face)
        friction = brake.friction > 0
        return make_shoe_substructure(
            SolidBody, shoe, divided, condensed, centre, friction=friction
        )
