"""The response of a brake to a small change of the shape of its shoes' meshes.

Let the nodes of a body move by t V, with a factor t from 0 to 1. The stiffness K and the nodal
forces F of the loads then change at the rates K' and F' at t = 0. To first order in the moves, the
displacements u change as if the nodal forces F' - K' u acted on the unchanged body. These forces
are one additional load column of the condensed body.

The rates must be those at t = 0. In the elements at an outline the stiffness changes by per cents,
and nearly all of these changes cancel to first order. In the differences between t = 1 and t = 0,
the terms of second order would be larger than the change that is sought.

If the factors of the eliminated unknowns were kept, the new response costs little more than another
solution of the contact, and far less than a body on the changed mesh.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake.brake import Brake, Shoe
from drumlin.fem.preparation.bodies import (
    ShoeSubstructure,
    nodal_forces_of_unit_loads_besides_actuation,
    substructure_with_load_of_changed_shape,
)
from drumlin.fem.preparation.displacements import (
    load_column_factors_and_frame_motion_in_response,
    nodal_contact_pressures_of_each_lining,
    nodal_displacements_of_shoe,
)
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.fem.substructure.body import sparse_stiffness_of_body
from drumlin.fem.substructure.elasticity import elastic_layers_of_shoe
from drumlin.response.balance import brake_with_forces_of_response
from drumlin.response.response import Response, ShoeResponse

STEP = 1e-3
"""Factor t of the moves at which stiffness and loads are compared with their values at t = 0.

The quotients of their differences and t stand for the rates at t = 0. A larger factor adds terms of
second order, 14 % of the change of the torque at t = 0.1 on a mesh of 10 000 nodes. A smaller
factor adds round-off; at t = 1e-6 its effect is as large. The value is a judgement.
"""
MoveFunction = Callable[[Any], Floats]
"""Function of the basis of a body that returns the moves (2, N) [m] of its nodes."""


def prepared_model_with_moved_nodes(
    scene: PreparedModel, brake: Brake, response: Response, moves_of_nodes: MoveFunction
) -> PreparedModel:
    """The prepared model after a small move of the nodes of the meshes from files.

    The model is valid near the given response, to first order in the moves. Nodes of the contact
    must not move. The actuation keeps its forces on the same nodes.

    Parameters
    ----------
    scene : the prepared model
    brake : the brake
    response : the response of the brake on the prepared model
    moves_of_nodes : function of the basis of a mesh that returns the moves of its nodes
    """
    under_forces = brake_with_forces_of_response(brake, response)
    pressures = nodal_contact_pressures_of_each_lining(brake, response)
    bodies = []
    for i, body in enumerate(scene.bodies):
        if body.mesh_read_from_file is not None:
            moves = moves_of_nodes(body.basis)
            forces = _nodal_forces_due_to_moved_nodes(
                body, under_forces, under_forces.shoes[i], response.shoes[i], pressures[i], moves
            )
            body = substructure_with_load_of_changed_shape(body, forces)  # noqa: PLW2901
        bodies.append(body)
    return replace(scene, bodies=tuple(bodies))


def _nodal_forces_due_to_moved_nodes(
    body: ShoeSubstructure,
    brake: Brake,
    shoe: Shoe,
    answer: ShoeResponse,
    p: Floats,
    moves: Floats,
) -> Floats:
    """The nodal forces (2 nodes,) [N] that stand for moved nodes of a body.

    `moves` (2, nodes) [m] are the moves of the nodes. The other parameters are those of
    `nodal_displacements_of_shoe`.
    """
    load, motion = load_column_factors_and_frame_motion_in_response(body, brake, shoe, answer)
    u = nodal_displacements_of_shoe(body, brake, shoe, answer, p)
    # Only elements with moved nodes change their stiffness.
    members = np.flatnonzero((np.hypot(*moves) > 0)[body.basis.element_dofs].any(axis=0))
    before = body.basis.basis_of_some_elements(members)
    after = before.basis_with_moved_nodes(STEP * moves)
    layers = elastic_layers_of_shoe(shoe)
    K, moved_K = (sparse_stiffness_of_body(basis, layers) for basis in (before, after))
    # Nodes of the rigid line turn with the frame about their new places.
    rigid = np.unique(body.basis.get_dofs(body.mesh.boundaries["hinge"]))
    turned = np.zeros((body.basis.N, 2))
    turned[rigid] = motion[2] * np.array([-moves[1, rigid], moves[0, rigid]]).T
    forces = (K @ u - moved_K @ u) / STEP - K @ turned.ravel()

    columns = body.load_matrix_columns_by_load_name
    old = nodal_forces_of_unit_loads_besides_actuation(body.basis, shoe, brake.size)
    moved = body.basis.basis_with_moved_nodes(STEP * moves)
    new = nodal_forces_of_unit_loads_besides_actuation(moved, shoe, brake.size) if old else {}
    for name, unit_forces in new.items():
        factors = columns.column_factors_of_one_named_load(name, load)
        forces += (unit_forces - old[name]) @ factors / STEP
    return np.asarray(forces)
