"""What the finite elements of a post brake say of the quantities of the foundation model: w and z."""

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import BadInput
from drumlin.brake.beam_axis import axis_of
from drumlin.brake.brake import Brake
from drumlin.fem.analysis.fields import fields
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.response.response import Response


def beam_deflection(
    scene: PreparedModel, brake: Brake, response: Response, index: int
) -> tuple[Floats, Floats]:
    """Stations x (m,) [m] along the axis of the straight beam of shoe `index`, and its displacement
    w (m,) [m].
    """
    shoe = brake.shoes[index]
    axis, all_fields = (
        axis_of(shoe.pin.xy, shoe.actuation.point.xy),
        fields(scene, brake, response, index),
    )
    away = all_fields.points - axis.hinge
    on = np.abs(away @ axis.towards) < 1e-9 * axis.length
    x, first = np.unique(np.round(away[on] @ axis.along, 12), return_index=True)
    return x, (all_fields.displacement[on] @ axis.towards)[first]


def rim_displacement(
    scene: PreparedModel, brake: Brake, response: Response
) -> tuple[Floats, Floats]:
    """Angles (m,) [rad] of the nodes of the ring's friction surface and their inward displacement z
    (m,) [m].

    Raises BadInput for a rigid drum.
    """
    ring = scene.ring
    if ring is None:
        raise BadInput("drum.ring: is missing, a rigid drum has no displacement")
    p = [
        answer.pressure[:: shoe.frame.sense]
        for shoe, answer in zip(brake.shoes, response.shoes, strict=True)
    ]
    nodes = ring.basis.get_dofs(ring.mesh.boundaries["contact"]).flatten()
    x, u = ring.basis.doflocs[:, nodes], ring.displacement(p, brake.drag)[:, nodes]
    theta = np.arctan2(x[1], x[0])
    order = np.argsort(theta)
    return theta[order], -((x * u).sum(axis=0) / np.hypot(*x))[order]
