"""Displacements of a straight beam shoe and of the drum ring by finite elements.

A study compares them with the displacements by the foundation model, in which the lining consists
of independent springs (a Winkler foundation).
"""

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import BadInput
from drumlin.brake.beam_axis import make_beam_axis
from drumlin.brake.brake import Brake
from drumlin.fem.analysis.fields import (
    friction_stress_over_friction_coefficient_of_each_lining,
    stress_and_displacement_fields_of_shoe,
)
from drumlin.fem.preparation.displacements import nodal_contact_pressures_of_each_lining
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.response.response import Response


def stations_and_deflections_of_beam(
    scene: PreparedModel, brake: Brake, response: Response, index: int
) -> tuple[Floats, Floats]:
    """The stations x (m,) [m] along a straight beam and its deflection w (m,) [m] there.

    The beam is the body of shoe `index`. x counts from the hinge, and positive w points towards the
    drum.
    """
    shoe = brake.shoes[index]
    axis = make_beam_axis(shoe.pin.xy, shoe.actuation.point.xy)
    of_shoe = stress_and_displacement_fields_of_shoe(scene, brake, response, index)
    from_hinge = of_shoe.points - axis.hinge
    # The nodes on the beam's axis are those whose distance from the axis is round-off.
    on = np.abs(from_hinge @ axis.unit_normal_towards_drum_centre) < 1e-9 * axis.length
    # A node between two materials occurs twice in the fields. `unique` keeps each position once.
    x, first = np.unique(np.round(from_hinge[on] @ axis.along, 12), return_index=True)
    return x, (of_shoe.displacement[on] @ axis.unit_normal_towards_drum_centre)[first]


def angles_and_inward_displacements_of_ring_surface(
    scene: PreparedModel, brake: Brake, response: Response
) -> tuple[Floats, Floats]:
    """The angles (m,) [rad] and inward displacements (m,) [m] of the drum ring's friction surface.

    Raises BadInput for a rigid drum.
    """
    ring = scene.ring
    if ring is None:
        raise BadInput("drum.ring: is missing, a rigid drum has no displacement")
    displacement = ring.displacements_of_ring_nodes(
        nodal_contact_pressures_of_each_lining(brake, response),
        friction_stress_over_friction_coefficient_of_each_lining(brake, response),
        list(map(brake.signed_friction_stress_over_pressure, brake.shoes)),
    )
    nodes = ring.basis.get_dofs(ring.mesh.boundaries["contact"]).flatten()
    x, u = ring.basis.doflocs[:, nodes], displacement[:, nodes]
    theta = np.arctan2(x[1], x[0])
    order = np.argsort(theta)
    inward = -((x * u).sum(axis=0) / np.hypot(*x))
    return theta[order], inward[order]
