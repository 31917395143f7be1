"""The end of a holding brake held against the sliding brake, on random brakes of all kinds.

The drum is turned as the command `hold` turns it: to full slip, in a few increments. Its moment
there must be the torque of `solve`, or a line of the last state says both and why they differ.
"""

import math
from types import ModuleType

import numpy as np

from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake
from drumlin.fem.analysis.holding import TWO_ANSWERS, Hold, full_slip_rotation, hold
from drumlin.fem.error_control.levels import LEVELS
from drumlin.fem.model import respond
from drumlin.fem.preparation.prepare import prepare
from drumlin.fem.preparation.scene import PreparedModel
from drumlin_studies import random_brake, random_kinds
from drumlin_studies.consistency import Check

HOLD_CHECK = "hold's end = solve"
HOLD_STEPS = 4
"""Increments of the rotation; full slip is reached in any number of increments."""
MESH_ELEMENTS = 12
"""Elements of the mesh, which both ways share, so that its error does not matter."""
LOCKED_ROTATION = 1.0
"""Rotation [rad] to which a brake is held that `solve` refuses: one that locks still sticks there.
"""
TWO_ANSWERS_LINE = "more than one answer"
"""How the line of `full_slip_rotation` begins that has the moments of both ways."""


def checks(seed: int) -> list[Check]:
    """One row for the random brake of a seed: the torque held at full slip and that of the sliding
    brake.

    Seeds go through the kinds of both generators, on one mesh and on columns in turn. No row where
    the generator has no brake of the seed, and for a brake without friction, which holds nothing.
    """
    kinds = _kinds()
    generator, kind = kinds[seed % len(kinds)]
    try:
        draw = random_kinds.random_kind if generator is random_kinds else random_brake.random_brake
        brake = draw(seed, kind)
    except NoAnswer:
        return []
    if brake.friction == 0:
        return []
    on_columns = seed // len(kinds) % 2 == 1
    scene = prepare(brake, LEVELS[1]) if on_columns else prepare(brake, elements=MESH_ELEMENTS)
    return [_check(f"{kind} {seed}", scene, brake)]


def _kinds() -> list[tuple[ModuleType, str]]:
    """The generators and their kinds."""
    return [(module, kind) for module in (random_kinds, random_brake) for kind in module.KINDS]


def _check(name: str, scene: PreparedModel, brake: Brake) -> Check:
    """The row of a brake on a scene."""
    row = Check(
        check=HOLD_CHECK, brake=name, quantity="torque", difference=math.inf, allowed=TWO_ANSWERS
    )
    try:
        sliding = respond(scene, brake).torque
    except NoAnswer as error:
        held = _end(scene, brake, LOCKED_ROTATION)
        locked = held is None or held.sticking > 0
        return row._replace(said=str(error) if locked else "", refused=locked)
    try:
        end = full_slip_rotation(scene, brake)
    except NoAnswer as error:
        return row._replace(said=str(error) if TWO_ANSWERS_LINE in str(error) else "")
    last = _end(scene, brake, end)
    if last is None:
        return row
    return row._replace(difference=abs(last.torque / sliding - 1), said=" ".join(last.notes))


def _end(scene: PreparedModel, brake: Brake, rotation: float) -> Hold | None:
    """The state after a rotation [rad]; None where there is none."""
    try:
        return hold(scene, brake, np.linspace(0.0, rotation, HOLD_STEPS + 1))[-1]
    except NoAnswer:
        return None
