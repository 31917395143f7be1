"""Checks that a holding brake ends with the torque of the sliding brake, on random brakes.

The drum is turned to full slip in a few increments, as by the command `hold`. The moment there must
be the torque of `solve`, or a line of the last state must tell both numbers and why they differ.
"""

import math

import numpy as np

from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake
from drumlin.fem.analysis.holding import (
    LARGEST_TORQUE_DIFFERENCE,
    Hold,
    find_full_slip_rotation,
    hold_drum_through_rotations,
)
from drumlin.fem.error_control.levels import LEVELS
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.prepare import prepare
from drumlin.fem.preparation.scene import PreparedModel
from drumlin_studies import random_brake, random_kinds
from drumlin_studies.consistency import Check
from drumlin_studies.random_kinds import draw_brake_of_kind

HOLD_CHECK = "hold's end = solve"
"""Name of the check in rows."""
HOLD_STEPS = 4
"""Increments of the rotation. Full slip does not depend on their number."""
MESH_ELEMENTS = 12
"""Elements along a lining. Both paths share the mesh, so that its error does not matter."""
HOLD_KINDS = (*random_kinds.HOLDING_KINDS, *random_brake.SHAPE_KINDS)
"""The kinds of both generators, in the order in which seeds draw them."""
LOCKED_ROTATION = 1.0
"""Rotation [rad] of a brake that `solve` refuses. A brake that locks still sticks there."""
TWO_ANSWERS_LINE = "more than one answer"
"""Words of the line in which `find_full_slip_rotation` tells the moments of both paths."""


def hold_against_solve_rows(seed: int) -> list[Check]:
    """The row of the random brake of a seed: its torque at full slip against that of `solve`.

    Seeds go through the kinds of both generators, on a mesh and on hp elements in turn. There is no
    row where the generator has no brake of the seed, and none for a brake without friction.
    """
    kind = HOLD_KINDS[seed % len(HOLD_KINDS)]
    try:
        brake = draw_brake_of_kind(seed, kind)
    except NoAnswer:
        return []
    if brake.friction == 0:
        return []
    on_hp_elements = seed // len(HOLD_KINDS) % 2 == 1
    scene = prepare(brake, LEVELS[1]) if on_hp_elements else prepare(brake, elements=MESH_ELEMENTS)
    return [_hold_row(f"{kind} {seed}", scene, brake)]


def _hold_row(name: str, scene: PreparedModel, brake: Brake) -> Check:
    """The row of a brake: the torques of `hold` and `solve` on the same prepared model."""
    row = Check(
        check=HOLD_CHECK,
        brake=name,
        quantity="torque",
        difference=math.inf,
        allowed=LARGEST_TORQUE_DIFFERENCE,
    )
    # Where `solve` refuses a brake, it must still stick after a large rotation.
    try:
        sliding = solve_prepared_model(scene, brake).torque
    except NoAnswer as error:
        held = _state_after_rotation(scene, brake, LOCKED_ROTATION)
        locked = held is None or held.sticking > 0
        return row._replace(said=str(error) if locked else "", refused=locked)
    # A refusal counts as told only where it names the moments of both paths.
    try:
        end = find_full_slip_rotation(scene, brake)
    except NoAnswer as error:
        return row._replace(said=str(error) if TWO_ANSWERS_LINE in str(error) else "")
    last = _state_after_rotation(scene, brake, end)
    if last is None:
        return row
    return row._replace(difference=abs(last.torque / sliding - 1), said=" ".join(last.notes))


def _state_after_rotation(scene: PreparedModel, brake: Brake, rotation: float) -> Hold | None:
    """The state of the brake after a rotation [rad], or None where there is no answer."""
    try:
        return hold_drum_through_rotations(
            scene, brake, np.linspace(0.0, rotation, HOLD_STEPS + 1)
        )[-1]
    except NoAnswer:
        return None
