"""The rigid-body modes of a shoe: motions of its contact nodes, and the work of its loads."""

import math
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake.brake import Shoe
from drumlin.brake.support import displacements_in_rigid_body_motions
from drumlin.fem.preparation.bodies import (
    ShoeSubstructure,
    moment_of_loads_besides_actuation_about_pin,
)


class RigidBodyModes(NamedTuple):
    """The k rigid-body modes of a shoe, each of unit size, in the frame of the shoe.

    The contact modes are the motions that the support allows. The test modes are motions on which
    the force of the support does no work, so that virtual work on them gives equilibria without
    this force. With friction at an abutment the contact modes and the test modes differ: the
    support does not allow the foot to move along a test mode.

    Attributes
    ----------
    contact_modes : displacements (2n, k) of the n contact nodes in the contact modes
    test_modes : displacements (2n, k) of the contact nodes in the test modes
    actuation_work : work (k,) of the actuation on the test modes, per newton of its force
    work_of_further_loads : work (k,) of springs, weight and additional forces on the test modes
        [N m for a turn, N for a slide]
    load_point_travel : displacement (k,) of the point of actuation along its force in the contact
        modes
    pin_motion : displacements x and y of the pin, and turn of the shoe (3, k), in the contact modes
    """

    contact_modes: Floats
    test_modes: Floats
    actuation_work: Floats
    work_of_further_loads: Floats
    load_point_travel: Floats
    pin_motion: Floats


def pin_motions_in_rigid_body_motions(shoe: Shoe, motions: Floats) -> Floats:
    """Convert k rigid-body motions (k, 3) in the brake's frame to motions (3, k) of a shoe's pin.

    The rows of the result are the displacements x and y of the pin in the shoe's frame, and the
    turn of the shoe in the sense of that frame.
    """
    at_point = displacements_in_rigid_body_motions(motions, shoe.pin.xy[:, None])
    in_shoe = shoe.frame.convert_vectors_to_shoe_frame(np.moveaxis(at_point, 0, -1))
    u = in_shoe[0]  # (k, 2)
    return np.vstack([u.T, shoe.frame.sense * motions[:, 2]])


def make_rigid_body_modes(
    body: ShoeSubstructure, shoe: Shoe, moment: float, sense: int = 1
) -> RigidBodyModes:
    """Make the rigid-body modes of a shoe.

    Parameters
    ----------
    body : the substructure of the shoe
    shoe : the shoe
    moment : moment of the actuation about the pin [m], per newton of its force
    sense : direction of the friction at an abutment: +1 or -1 along its face, 0 if the foot sticks,
        see `SupportedShoe.rigid_body_modes_of_support`
    """
    if shoe.kind_of_support == "hinge":
        return _rigid_body_mode_of_turn_about_pin(body, shoe, moment)
    # A shoe that a strut pushes has no actuation force of its own. Its modes are made for a unit
    # force.
    loaded = shoe if shoe.actuation.force else shoe.shoe_with_changed_actuation_force(1.0)
    free = loaded.rigid_body_modes_of_support(sense)
    size = abs(shoe.actuation.force) or 1.0
    modes = RigidBodyModes(
        contact_modes=contact_node_displacements_in_rigid_body_motions(body, shoe, free.motions),
        test_modes=contact_node_displacements_in_rigid_body_motions(body, shoe, free.test_modes),
        actuation_work=free.actuation_work / size,
        work_of_further_loads=free.work_of_further_loads,
        load_point_travel=free.actuation_point_travel * math.copysign(1.0, shoe.actuation.force),
        pin_motion=pin_motions_in_rigid_body_motions(shoe, free.motions),
    )
    if free.names[0] == "turn":
        # The first mode is a turn about the pin, computed from a turn about the drum's centre. It
        # is overwritten by the same turn computed about the pin, which has less round-off.
        for whole, exact in zip(
            modes, _rigid_body_mode_of_turn_about_pin(body, shoe, moment), strict=True
        ):
            whole[..., :1] = exact
    return modes


def contact_node_displacements_in_rigid_body_motions(
    body: ShoeSubstructure, shoe: Shoe, motions: Floats
) -> Floats:
    """The displacements (2n, k) of a shoe's n contact nodes in k rigid-body motions.

    The displacements are in the frame of the shoe. `motions` (k, 3) are in the frame of the brake.
    """
    xy = shoe.convert_points_to_brake_frame(body.line.xy)
    u = shoe.frame.convert_vectors_to_shoe_frame(
        np.moveaxis(displacements_in_rigid_body_motions(motions, xy), 0, -1)
    )  # (n, k, 2)
    return np.asarray(u.transpose(0, 2, 1).reshape(-1, len(motions)))


def _rigid_body_mode_of_turn_about_pin(
    body: ShoeSubstructure, shoe: Shoe, moment: float
) -> RigidBodyModes:
    """The turn of a shoe about its pin as a single rigid-body mode.

    `moment` [m] is the moment of the actuation about the pin, per newton of its force.
    """
    turned = body.rotation_mode[:, None]
    work, further = (
        np.array([moment]),
        np.array([moment_of_loads_besides_actuation_about_pin(shoe)]),
    )
    return RigidBodyModes(turned, turned, work, further, work, np.array([[0.0], [0.0], [1.0]]))
