"""The solve of shoes of finite width (`--model solid`), and its file of stresses."""

from pathlib import Path

from drumlin.base.errors import BadInput
from drumlin.base.files import require_fields_file_name_ends_in_vtu
from drumlin.brake.brake import Brake
from drumlin.brake.further_loads import brake_with_all_loads_moved_to_actuation
from drumlin.fem.error_control.adapt import (
    TolerancesOfPressureAndTorque,
    require_tolerance_between_zero_and_one,
)
from drumlin.fem.model import DEFAULT_PENALTY_FACTOR, require_positive_penalty
from drumlin.fem.preparation.cache import CacheOfCondensedBodies
from drumlin.fem.width.ladder import (
    LARGEST_WIDTH_DEGREE_WITH_STATED_ERROR,
    solve_brake_with_widths_and_keep_model,
)
from drumlin.fem.width.prepare import reason_why_width_model_does_not_apply
from drumlin.response.merit import response_with_figures_of_merit
from drumlin.response.response import Response

DEFAULT_ERROR_TOLERANCE_OF_SOLID_MODEL = 0.01
"""Default tolerance of the solid model: relative error of p (mean over the width) and of torque."""


def solve(
    brake: Brake,
    *,
    across: int | None = None,
    tolerance: float | None = None,
    penalty: float = DEFAULT_PENALTY_FACTOR,
    fields: Path | None = None,
    cache: CacheOfCondensedBodies | None = None,
) -> Response:
    """The response of a brake's solid shoes, with its stated errors.

    Without a given tolerance the solve aims at DEFAULT_ERROR_TOLERANCE_OF_SOLID_MODEL. If it is not
    reached, a warning in the notes states the estimated error.

    Parameters
    ----------
    brake : the brake
    across : degree of the polynomials across the width; None for the smallest degree that meets the
        tolerance
    tolerance : largest allowed relative error of p (mean over the width, L2 norm) and of the torque
    penalty : factor alpha of the contact stiffness alpha E/t
    fields : name of a .vtu file for displacements and stresses in half of each shoe, on one side of
        its mid-plane; None for no file
    cache : condensed bodies of earlier models; bodies found in it are reused, new ones are added

    Raises
    ------
    BadInput
        if the model does not apply to the brake, for a degree or a tolerance out of range, for a
        degree together with a tolerance, and for a file name that does not end in .vtu
    NoAnswer
        if the contact has no solution, and if a given tolerance is not reached
    """
    require_positive_penalty(penalty)
    require_fields_file_name_ends_in_vtu(fields)
    if across is not None and not 1 <= across <= LARGEST_WIDTH_DEGREE_WITH_STATED_ERROR:
        raise BadInput(
            f"--across = {across}: must be from 1 to {LARGEST_WIDTH_DEGREE_WITH_STATED_ERROR}"
        )
    asked = DEFAULT_ERROR_TOLERANCE_OF_SOLID_MODEL
    if tolerance is not None:
        require_tolerance_between_zero_and_one(tolerance)
        asked = tolerance
        if across is not None:
            raise BadInput(
                f"--tolerance = {tolerance:g}: chooses the degree across the width; leave out "
                f"--across = {across}"
            )
    reason = reason_why_width_model_does_not_apply(brake)
    if reason is not None:
        raise BadInput(f"solid does not apply to this brake: {reason}")
    # The solve begins with plane stress. All loads act at the point of actuation there, as they do
    # in the model with widths.
    solved = solve_brake_with_widths_and_keep_model(
        brake_with_all_loads_moved_to_actuation(brake),
        TolerancesOfPressureAndTorque(asked, asked),
        must=tolerance is not None,
        across=across,
        penalty=penalty,
        cache=cache,
    )
    if fields is not None:
        # The modules of the fields take time to import, and are needed only for a file of fields.
        from drumlin.fem.analysis.fields import write_fields_to_vtu_file  # noqa: PLC0415
        from drumlin.fem.analysis.solid_fields import recover_stresses_in_half_of_each_solid_shoe  # noqa: PLC0415

        recovered = recover_stresses_in_half_of_each_solid_shoe(
            solved.prepared_model, brake, solved.response
        )
        write_fields_to_vtu_file(fields, recovered)
    return response_with_figures_of_merit(brake, solved.response)
