"""What the finite elements of a post brake say of the quantities of the foundation model: w and z."""

import numpy as np

from drumlin.arrays import Floats
from drumlin.beam import axis_of
from drumlin.brake import Brake
from drumlin.fem.fields import fields
from drumlin.fem.scene import Scene
from drumlin.response import Response


def beam_deflection(scene: Scene, brake: Brake, response: Response, index: int) -> tuple[Floats, Floats]:
    """Stations x (m,) [m] along the axis of the straight beam of shoe `index`, and its displacement w (m,) [m]."""
    shoe = brake.shoes[index]
    axis, all_fields = axis_of(shoe.hinge.xy, shoe.actuation.point.xy), fields(scene, brake, response, index)
    away = all_fields.points - axis.hinge
    on = np.abs(away @ axis.towards) < 1e-9 * axis.length
    x, first = np.unique(np.round(away[on] @ axis.along, 12), return_index=True)
    return x, (all_fields.displacement[on] @ axis.towards)[first]


def rim_displacement(scene: Scene, brake: Brake, response: Response, index: int) -> Floats:
    """Inward displacement [m] of the ring at the angles of shoe `index` (n,), under all shoes."""
    shoe, ring = brake.shoes[index], scene.ring
    theta = response.shoes[index].theta
    if ring is None:
        return np.zeros(len(theta))
    drag = brake.friction * brake.spin
    half = np.zeros(len(ring.pressed[0]))
    for i, (other, answer) in enumerate(zip(brake.shoes, response.shoes, strict=True)):
        if answer.contact_arcs:
            half += (ring.pressed[i] + drag * ring.dragged[i]) @ answer.pressure[:: other.frame.sense]
    z = np.linalg.solve(scene.bodies[index].coupling.M, ring.pressed[index].T @ half)
    return np.asarray(-shoe.sign * z)[:: shoe.frame.sense]
