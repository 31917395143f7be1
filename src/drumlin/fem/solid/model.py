"""The solid model of a brake, from its file to its response, by the contact of the plane model."""

from collections.abc import Mapping
from functools import partial
from pathlib import Path

from drumlin.base.errors import BadInput
from drumlin.brake.brake import Brake, Shoe
from drumlin.fem.error_control.adapt import Tolerance, require_tolerance_between_zero_and_one
from drumlin.fem.error_control.levels import SolvedLevel
from drumlin.fem.model import PENALTY, require_positive_penalty, solve_prepared_model
from drumlin.fem.preparation.bodies import ShoeSubstructure
from drumlin.fem.preparation.cache import (
    Cache,
    memory_of_condensed_body,
    shape_key_of_shoe,
    shoe_without_loads_and_clearances,
)
from drumlin.fem.preparation.scene import (
    PreparedModel,
    Seconds,
    text_lines_on_rigid_parts,
    text_lines_on_shoes_of_equal_shape,
)
from drumlin.fem.solid import MOST_ACROSS, MOST_ELEMENTS
from drumlin.fem.solid.body import condensed_body_of_solid_shoe
from drumlin.fem.width.ladder import solve_and_keep_brake_with_widths
from drumlin.fem.width.prepare import OTHER_HALF, reason_against_any_model_with_widths
from drumlin.response.merit import response_with_figures_of_merit
from drumlin.response.response import Response

SOLID_LINING_ELEMENTS = 48
"""Default number of elements along a lining. The work grows with its fourth power."""
DEFAULT_SOLID_TOLERANCE = 0.01
"""Tolerance of a solve of solid shoes without options: 1 % of the mean pressure and the torque."""
STIFFNESS = 2500
"""Memory of a row of the stiffness of a solid [bytes], approximately."""


def reason_why_solid_model_does_not_apply(brake: Brake) -> str | None:
    """Why the solid model does not apply to a brake; None where it applies."""
    on_ring = "its drum is an elastic ring; solid shoes are pressed on a rigid drum"
    return reason_against_any_model_with_widths(brake, "the solid model", on_ring)


def default_element_count_over_half_width(shoe: Shoe, elements: int) -> int:
    """Default number of elements over half the width of a lining with `elements` along it.

    The pressure is uneven over about the lining's thickness from its sides, and smooth there.
    """
    slender = shoe.lining.width / (2 * shoe.lining.thickness)
    return max(2, round(elements / SOLID_LINING_ELEMENTS * min(2 + slender, 6)))


def prepare_model_of_solid_shoes(
    brake: Brake,
    *,
    elements: int = SOLID_LINING_ELEMENTS,
    across: int | None = None,
    cache: Cache | None = None,
) -> PreparedModel:
    """The solid shoes of a brake, meshed and condensed; shoes of one shape share one body.

    Parameters
    ----------
    brake : the brake
    elements : number of elements along each lining
    across : number of elements over half the width of each lining; by default
        `default_element_count_over_half_width`
    cache : bodies of earlier models; found ones are taken from it, and new ones put there

    Raises
    ------
    BadInput
        where the solid model does not apply, or for too many elements
    """
    reason = reason_why_solid_model_does_not_apply(brake)
    if reason is not None:
        raise BadInput(f"solid does not apply to this brake: {reason}")
    for name, value, most in (
        ("elements", elements, MOST_ELEMENTS),
        ("across", across, MOST_ACROSS),
    ):
        if value is not None and not 1 <= value <= most:
            raise BadInput(f"--{name} = {value}: must be from 1 to {most}")
    seconds: Seconds = {}
    made: dict[tuple[object, ...], ShoeSubstructure] = {}
    cache = Cache() if cache is None else cache
    keys = [shape_key_of_shoe(brake, shoe) for shoe in brake.shoes]
    for key, shoe in zip(keys, brake.shoes, strict=True):
        if key not in made:
            counts = elements, across or default_element_count_over_half_width(shoe, elements)
            same = (
                "solid",
                shoe_without_loads_and_clearances(shoe),
                brake.size,
                brake.friction > 0,
                *counts,
            )
            make = partial(condensed_body_of_solid_shoe, brake, shoe, *counts, seconds)
            made[key] = cache.get(same, make, _memory_size_of_solid_body)
    left_out = [
        "interior fields: recovered only for a file or a picture",
        OTHER_HALF,
        *text_lines_on_shoes_of_equal_shape(brake, len(made)),
    ]
    bodies = tuple(made[key] for key in keys)
    return PreparedModel(
        brake, bodies, None, seconds, (*left_out, *text_lines_on_rigid_parts(brake)), model="solid"
    )


def _memory_size_of_solid_body(body: ShoeSubstructure) -> int:
    """The memory [bytes] of a condensed solid body, approximately.

    The body keeps its matrices, and the stiffness with which fields are recovered.
    """
    return memory_of_condensed_body(body) + STIFFNESS * body.unknowns


def solve(
    brake: Brake,
    *,
    elements: int | None = None,
    across: int | None = None,
    tolerance: float | None = None,
    penalty: float = PENALTY,
    fields: Path | None = None,
    cache: Cache | None = None,
) -> Response:
    """The response of a brake's solid shoes.

    Without options the hierarchic model of the width solves the brake to DEFAULT_SOLID_TOLERANCE,
    see fem/width/ladder.py. Its answer states its errors. The options of hexahedra choose a mesh of
    hexahedra, whose answer states no errors.

    Parameters
    ----------
    brake, elements, across, cache : as of `prepare_model_of_solid_shoes`
    tolerance : relative error of p (mean over the width, L2) and of the torque that must be
        reached by the hierarchic model of the width
    penalty : factor alpha of the contact stiffness alpha E/t
    fields : name of a .vtu file for the displacements and stresses inside the shoes; half of each
        shoe, on one side of its mid-plane

    Raises
    ------
    BadInput
        as `prepare_model_of_solid_shoes` does, for a file of another kind, and for options of
        hexahedra beside a tolerance
    NoAnswer
        where the contact has no answer, and where a given tolerance is not reached
    """
    require_positive_penalty(penalty)
    if fields is not None and fields.suffix != ".vtu":
        raise BadInput(f"--fields = {str(fields)!r}: must end in .vtu")
    given = {"elements": elements, "across": across}
    if tolerance is not None or all(value is None for value in given.values()):
        solved = _solve_solid_shoes_to_error_tolerance(brake, tolerance, given, penalty, cache)
    else:
        brake.check_shoes_can_be_meshed()
        elements = SOLID_LINING_ELEMENTS if elements is None else elements
        scene = prepare_model_of_solid_shoes(brake, elements=elements, across=across, cache=cache)
        solved = SolvedLevel(scene, solve_prepared_model(scene, brake, penalty=penalty))
    if fields is not None:
        # The fields load only where they are asked for.
        from drumlin.fem.analysis.fields import write_fields_to_vtu_file  # noqa: PLC0415
        from drumlin.fem.solid.width_fields import recover_fields_in_shoes  # noqa: PLC0415

        recovered = recover_fields_in_shoes(solved.scene, brake, solved.response)
        write_fields_to_vtu_file(fields, recovered)
    return response_with_figures_of_merit(brake, solved.response)


def _solve_solid_shoes_to_error_tolerance(
    brake: Brake,
    tolerance: float | None,
    given: Mapping[str, object],
    penalty: float,
    cache: Cache | None,
) -> SolvedLevel:
    """The response of a brake by the hierarchic model of the width to a tolerance, and the model.

    Parameters
    ----------
    brake, penalty, cache : as of `solve`
    tolerance : tolerance that must be reached; with None DEFAULT_SOLID_TOLERANCE is tried, and a
        note says what is reached
    given : the options of hexahedra by name, which must all be None
    """
    for option, value in given.items():
        if value is not None:
            raise BadInput(
                f"--tolerance = {tolerance:g}: chooses degree and division of the solid; leave "
                f"out --{option} = {value}"
            )
    reason = reason_why_solid_model_does_not_apply(brake)
    if reason is not None:
        raise BadInput(f"solid does not apply to this brake: {reason}")
    brake.check_shoes_can_be_meshed()
    asked = DEFAULT_SOLID_TOLERANCE
    if tolerance is not None:
        require_tolerance_between_zero_and_one(tolerance)
        asked = tolerance
    return solve_and_keep_brake_with_widths(
        brake, Tolerance(asked, asked), must=tolerance is not None, penalty=penalty, cache=cache
    )
