"""The free motions of a shoe as its contact feels them."""

import math
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake.brake import Shoe
from drumlin.brake.support import moved
from drumlin.fem.preparation.bodies import ShoeSubstructure


class Motions(NamedTuple):
    """The free motions of a shoe, of a unit each, in its own frame: contact displacements `moved`
    (2n, k), those that its equilibria are tested on, `tested` (2n, k), and the `work` (k,) of the
    actuation on these per newton. `tip` (k,): how far the actuation's point goes along its force;
    `of` (3, k): dx, dy at its pin and turn.
    """

    moved: Floats
    tested: Floats
    work: Floats
    tip: Floats
    of: Floats


def at_pin(shoe: Shoe, motions: Floats) -> Floats:
    """Rigid motions (k, 3) of the brake's frame in the shoe's own, (3, k): dx, dy of its pin and
    turn.
    """
    u = shoe.frame.to_shoe(np.moveaxis(moved(motions, shoe.pin.xy[:, None]), 0, -1))[0]  # (k, 2)
    return np.vstack([u.T, shoe.frame.sense * motions[:, 2]])


def motions_of(body: ShoeSubstructure, shoe: Shoe, moment: float, sense: int = 1) -> Motions:
    """The free motions of a shoe.

    moment: of its actuation about its pin [m], per newton; sense: of an abutment's friction, see
    `Held.freedoms`.
    """
    if shoe.held_by == "hinge":
        return _turn(body, moment)
    free, frame = (shoe if shoe.actuation.force else shoe.under(1.0)).freedoms(sense), shoe.frame
    tip = free.tip * math.copysign(1.0, shoe.actuation.force)
    xy = shoe.points(body.line.xy)

    def own(motions: Floats) -> Floats:
        u = frame.to_shoe(np.moveaxis(moved(motions, xy), 0, -1))  # (n, k, 2)
        return np.asarray(u.transpose(0, 2, 1).reshape(-1, len(motions)))

    work = free.work / (abs(shoe.actuation.force) or 1.0)
    found = own(free.motions), own(free.tests), work
    of = at_pin(shoe, free.motions)
    if free.names[0] == "turn":  # exactly, as below
        for part, whole in zip((*found, tip, of), _turn(body, moment), strict=True):
            part[..., :1] = whole
    return Motions(*found, tip, of)


def _turn(body: ShoeSubstructure, moment: float) -> Motions:
    """The turn about the pin, free of the round-off of one about the drum's centre."""
    turned, work = body.rotation_mode[:, None], np.array([moment])
    return Motions(turned, turned, work, work, np.array([[0.0], [0.0], [1.0]]))
