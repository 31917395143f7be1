"""The prepared model for the analyses of holding, wear and sensitivity: plane stress, or solid.

Each of these three analyses solves the brake on one fixed division into elements. The
cross-sections of three-dimensional (solid) shoes are divided as for plane stress, so that the
results of both models differ only by the effect of the widths.
"""

from drumlin.base.errors import BadInput
from drumlin.base.texts import did_you_mean_hint
from drumlin.brake.brake import Brake
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.fem.solve import prepared_model_with_finest_elements
from drumlin.fem.width.prepare import (
    prepare_model_with_widths_on_given_elements,
    reason_why_width_model_does_not_apply,
)

MODELS_OF_HOLD_WEAR_AND_SENSITIVITY = ("fem", "solid")
"""Models for the analyses of holding, wear and sensitivity: plane stress, and solid shoes."""
DEGREE_ACROSS_WIDTH_FOR_ANALYSES = 3
"""Degree of the polynomials across the width of solid shoes, for holding, wear and sensitivity.

On 18 example brakes without ring and mesh files, the step from degree 3 to degree 6 changes the
torque by at most 0.2 % and the mean pressure (L2) by at most 0.5 % (first level of a solve). Both
values belong to the S-cam brake; for all other brakes the values are 0.03 % and 0.12 %. The step
from degree 2 to degree 6 changes torque and mean pressure by 0.2 % and 0.6 %, without the S-cam
brake by 0.09 % and 0.34 %. The results of plane stress differ by some 1 % from the results of solid
shoes. With each degree the time grows by a factor of about 1.5.
"""


def prepared_model_for_hold_wear_or_sensitivity(
    brake: Brake, model: str = "fem", *, elements: int | None = None, kind: str | None = None
) -> PreparedModel:
    """The prepared model of a brake for the analyses of holding, wear and sensitivity.

    Parameters
    ----------
    brake : the brake
    model : "fem" for plane stress, "solid" for three-dimensional shoes
    elements, kind : number of elements along each lining and their kind (quad2, quad1, tri2, tri1),
        for plane stress; None for hp elements

    Raises
    ------
    BadInput
        for an unknown model, for a model that does not apply to the brake, for `elements` or `kind`
        together with "solid", and for a number or kind of elements without effect on the brake
    NoAnswer
        for a singular stiffness, and for a contact face with too many nodes
    """
    if model not in MODELS_OF_HOLD_WEAR_AND_SENSITIVITY:
        hint = did_you_mean_hint(model, MODELS_OF_HOLD_WEAR_AND_SENSITIVITY)
        raise BadInput(
            f"--model = {model!r}: does not do this{hint}; allowed: "
            f"{', '.join(MODELS_OF_HOLD_WEAR_AND_SENSITIVITY)}"
        )
    if model == "fem":
        return prepared_model_with_finest_elements(brake, elements=elements, kind=kind)
    if elements is not None or kind is not None:
        raise BadInput("--elements and --kind belong to --model fem, not to 'solid'")
    reason = reason_why_width_model_does_not_apply(brake)
    if reason is not None:
        raise BadInput(f"--model = 'solid': does not apply to this brake: {reason}; allowed: fem")
    plane = prepared_model_with_finest_elements(brake)
    return prepare_model_with_widths_on_given_elements(
        brake, plane.divisions, DEGREE_ACROSS_WIDTH_FOR_ANALYSES
    )
