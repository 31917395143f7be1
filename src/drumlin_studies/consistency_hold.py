"""Checks that a holding brake reaches the torque of the sliding brake, on random brakes.

The drum is rotated to full slip in a few increments, as by the command `hold`. At full slip the
holding moment must equal the torque of `solve`, or a printed line must state both values and why
they differ.
"""

import math

import numpy as np

from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake
from drumlin.fem.analysis.holding import (
    LARGEST_TORQUE_DIFFERENCE_OF_SAME_EQUILIBRIUM,
    HoldingState,
    find_drum_rotation_of_full_slip,
    turn_holding_brake_and_return_states_at_rotations,
)
from drumlin.fem.error_control.levels import REFINEMENT_LEVELS_FROM_COARSE_TO_FINE
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.preparation.scene import PreparedModel
from drumlin_studies import random_brake, random_kinds
from drumlin_studies.consistency import TwoPathComparison
from drumlin_studies.random_kinds import draw_random_brake_of_kind

NAME_OF_CHECK_OF_HOLD = "hold's end = solve"
"""Name of this check in tables."""
ROTATION_INCREMENTS_OF_HOLD_CHECK = 4
"""Number of increments of the rotation. The state at full slip does not depend on it."""
ELEMENTS_PER_LINING_OF_HOLD_CHECK = 12
"""Number of elements along a lining. `hold` and `solve` share the mesh, so its error cancels."""
KINDS_OF_RANDOM_BRAKES_FOR_HOLD_CHECK = (
    *random_kinds.FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SUPPORT_KIND,
    *random_brake.FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SHAPE_KIND,
)
"""The kinds of random brakes, in the order in which consecutive seeds draw them."""
ROTATION_THAT_TESTS_SELF_LOCKING = 1.0
"""Rotation of the drum [rad] by which a brake that `solve` refuses is tested for self-locking.

A self-locking brake still sticks after this rotation."""
ERROR_WORDS_ON_TWO_DIFFERENT_HOLDING_MOMENTS = "more than one answer"
"""Words of the error message by which `find_drum_rotation_of_full_slip` reports two different
moments."""


def rows_comparing_torques_of_hold_and_solve(seed: int) -> list[TwoPathComparison]:
    """Compare the torques by `hold` at full slip and by `solve` for the random brake of a seed.

    Consecutive seeds go through all kinds of brakes, on a low-order mesh and on hp elements in
    turn. Returns one row, or none if the seed gives no brake or a brake without friction.
    """
    kind = KINDS_OF_RANDOM_BRAKES_FOR_HOLD_CHECK[seed % len(KINDS_OF_RANDOM_BRAKES_FOR_HOLD_CHECK)]
    try:
        brake = draw_random_brake_of_kind(seed, kind)
    except NoAnswer:
        return []
    if brake.friction == 0:
        return []
    on_hp_elements = seed // len(KINDS_OF_RANDOM_BRAKES_FOR_HOLD_CHECK) % 2 == 1
    scene = (
        make_prepared_model(brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[1])
        if on_hp_elements
        else make_prepared_model(brake, elements=ELEMENTS_PER_LINING_OF_HOLD_CHECK)
    )
    return [_row_comparing_torques_of_hold_and_solve(f"{kind} {seed}", scene, brake)]


def _row_comparing_torques_of_hold_and_solve(
    name: str, scene: PreparedModel, brake: Brake
) -> TwoPathComparison:
    """Compare the torques of a brake by `hold` and by `solve`, both on the same prepared model."""
    row = TwoPathComparison(
        check=NAME_OF_CHECK_OF_HOLD,
        brake=name,
        quantity="torque",
        difference=math.inf,
        allowed=LARGEST_TORQUE_DIFFERENCE_OF_SAME_EQUILIBRIUM,
    )
    # If `solve` refuses the brake, the brake must be self-locking: it must still stick after a
    # large rotation.
    try:
        sliding = solve_prepared_model(scene, brake).torque
    except NoAnswer as error:
        held = _holding_state_after_rotation(scene, brake, ROTATION_THAT_TESTS_SELF_LOCKING)
        locked = held is None or held.sticking > 0
        return row._replace(said=str(error) if locked else "", refused=locked)
    # An error message of `hold` counts as a reason only if it states two different moments.
    try:
        end = find_drum_rotation_of_full_slip(scene, brake)
    except NoAnswer as error:
        return row._replace(
            said=str(error) if ERROR_WORDS_ON_TWO_DIFFERENT_HOLDING_MOMENTS in str(error) else ""
        )
    last = _holding_state_after_rotation(scene, brake, end)
    if last is None:
        return row
    return row._replace(difference=abs(last.torque / sliding - 1), said=" ".join(last.notes))


def _holding_state_after_rotation(
    scene: PreparedModel, brake: Brake, rotation: float
) -> HoldingState | None:
    """The holding state of the brake after a drum rotation [rad], or None if none is found."""
    try:
        return turn_holding_brake_and_return_states_at_rotations(
            scene, brake, np.linspace(0.0, rotation, ROTATION_INCREMENTS_OF_HOLD_CHECK + 1)
        )[-1]
    except NoAnswer:
        return None
