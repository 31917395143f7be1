"""The solve of a brake by finite elements, from the brake to its response.

A solve divides the brake into elements, condenses its bodies and solves its contact. It does so on
finer and finer divisions until the a posteriori error estimate is small enough.
"""

from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import replace
from functools import partial
from typing import NamedTuple

from drumlin.base.errors import BadInput, NoAnswer
from drumlin.base.texts import error_text_in_percent
from drumlin.brake.brake import Brake
from drumlin.brake.friction import first_key_of_pressure_dependent_friction
from drumlin.brake.further_loads import brake_with_loads_assigned_to_shoes
from drumlin.fem.equilibrium.locking import (
    compare_friction_over_pressure_with_self_locking_limit,
    compare_friction_with_self_locking_limits,
)
from drumlin.fem.error_control.adapt import (
    DEFAULT_TOLERANCES_OF_PRESSURE_AND_TORQUE,
    TolerancesOfPressureAndTorque,
    require_tolerance_between_zero_and_one,
    solve_brake_to_tolerance,
)
from drumlin.fem.error_control.degrees import (
    prepared_model_on_second_level_of_mesh_files,
    solve_brake_on_mesh_files,
)
from drumlin.fem.error_control.first_level import (
    solve_brake_on_first_refinement_level,
    solve_on_levels_and_hand_out_first,
)
from drumlin.fem.error_control.levels import REFINEMENT_LEVELS_FROM_COARSE_TO_FINE, SolvedLevel
from drumlin.fem.mesh.arc import DEFAULT_MESH_KIND
from drumlin.fem.model import DEFAULT_PENALTY_FACTOR, require_positive_penalty, solve_prepared_model
from drumlin.fem.preparation.cache import CacheOfCondensedBodies
from drumlin.fem.preparation.meshes import DEFAULT_ELEMENTS_ALONG_LINING
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.preparation.scene import PreparedModel, add_elapsed_time_of_block_to_phase
from drumlin.fem.width.correction import (
    correct_response_for_shoe_widths,
    require_that_width_model_applies_to_brake,
)
from drumlin.fem.width.error import estimate_error_of_plane_stress
from drumlin.response.balance import (
    brake_with_forces_of_response,
    largest_imbalance_among_shoes,
    relative_imbalance_of_shoe,
)
from drumlin.response.merit import response_with_figures_of_merit
from drumlin.response.response import Response

SMALLEST_REPORTED_PRESSURE_CURVE_IMBALANCE = 1e-8
"""Imbalance of the pressure curve p(theta) above which a note is added to the response.

The imbalance is the relative imbalance of forces or moments under p(theta) minus the relative
imbalance under the nodal forces. Elements with straight or parabolic sides lie a little off the
round drum, so that p(theta) on the drum balances worse than the forces at the nodes. The value
changes no result.
"""


def solve(
    brake: Brake,
    *,
    elements: int | None = None,
    kind: str | None = None,
    tolerance: float | None = None,
    penalty: float = DEFAULT_PENALTY_FACTOR,
    finite_width: bool = False,
    model_error: bool = False,
    self_locking: bool = False,
    use_model: Callable[[PreparedModel, Response], None] | None = None,
    use_first_level: Callable[[Response], None] | None = None,
    cache: CacheOfCondensedBodies | None = None,
) -> Response:
    """Solve a brake by finite elements, on finer and finer divisions up to a tolerance.

    Returns the response of the brake.

    Parameters
    ----------
    brake : the brake
    elements : number of finite elements along each lining; the brake is then solved on one mesh,
        without error estimate
    kind : kind of the finite elements; the brake is then solved on one mesh, without error estimate
    tolerance : largest estimated relative error of p (L2, outside the zones at the lining's ends)
        and of the torque; by default DEFAULT_TOLERANCES_OF_PRESSURE_AND_TORQUE is aimed at, and
        larger errors are accepted. On the mesh of a file the degree of the elements rises until the
        tolerance is met.
    penalty : factor alpha of the contact stiffness alpha E/t
    finite_width : whether the response is corrected for the widths of the shoes, see
        fem/width/correction.py; it then states the error that remains
    model_error : whether the response states the error that plane stress itself causes, see
        fem/width/error.py; not needed together with `finite_width`
    self_locking : whether the response states how far the friction is from locking the brake
    use_model : called with the prepared model and its response in plane stress, before any
        correction, for instance to write the stresses inside the shoes
    use_first_level : called with the response on the first level, which has no error estimate, if
        the first level has a solution; not called for brakes with mesh files, nor if a tolerance,
        elements or a kind are given
    cache : keeps the condensed bodies of earlier solves

    Raises
    ------
    BadInput
        for `elements` or a `kind` together with a tolerance or without effect on any shoe, and for
        a correction that does not apply to the brake
    NoAnswer
        if a given tolerance is not reached on a brake without mesh files, if the correction for the
        widths cannot be computed, and if the contact has no solution
    """
    require_positive_penalty(penalty)
    _require_tolerance_without_elements(tolerance, elements, kind)
    brake.check_shoes_can_be_meshed()
    if finite_width:
        require_that_width_model_applies_to_brake(brake)
    scene, response = _solved_model_in_plane_stress(
        brake,
        elements=elements,
        kind=kind,
        tolerance=tolerance,
        penalty=penalty,
        use_first_level=use_first_level,
        cache=cache,
    )
    seconds = dict(response.seconds)
    if use_model is not None:
        use_model(scene, response)
    if finite_width:
        with add_elapsed_time_of_block_to_phase(seconds, "correction for the widths"):
            response = correct_response_for_shoe_widths(
                brake, response, penalty=penalty, cache=cache
            )
    elif not brake.surface.is_plane_and_not_drum:
        response = _response_with_note_on_curve_balance(brake, response)
    if self_locking:
        # If the self-locking limit of the elastic brake is not found, the response is returned
        # without this limit.
        with add_elapsed_time_of_block_to_phase(seconds, "self-locking"), suppress(NoAnswer):
            # In the search for the self-locking limit the friction grows, while the springs keep
            # the pulls that they have in the response.
            under = brake_with_loads_assigned_to_shoes(brake, response.spring_pulls or None)
            is_over_pressure = first_key_of_pressure_dependent_friction(brake) is not None
            found = (
                compare_friction_over_pressure_with_self_locking_limit(scene, under, penalty)
                if is_over_pressure
                else compare_friction_with_self_locking_limits(scene, under, penalty)
            )
            response = replace(response, self_locking=found)
    if model_error and not finite_width:
        with add_elapsed_time_of_block_to_phase(seconds, "error of plane stress"):
            own = estimate_error_of_plane_stress(brake, response, penalty=penalty, cache=cache)
        response = replace(response, plane_stress_error=own)
    response = replace(response, seconds=seconds)
    return response_with_figures_of_merit(brake, response)


def solve_brake_on_first_level_without_error_estimate(
    brake: Brake,
    *,
    penalty: float = DEFAULT_PENALTY_FACTOR,
    model_error: bool = False,
    cache: CacheOfCondensedBodies | None = None,
) -> Response:
    """The response of a brake on the first level of a solve, without an error estimate.

    On a drum the response has no figures of merit and no notes on the assumptions: a sweep, which
    needs the response many times, shows neither. The parameters are those of `solve`. Raises
    NoAnswer if the first level has no solution.
    """
    require_positive_penalty(penalty)
    brake.check_shoes_can_be_meshed()
    response = solve_brake_on_first_refinement_level(
        brake, partial(solve_prepared_model, penalty=penalty), cache
    )
    # The braking force of a shoe on a plane is one of its figures of merit.
    if brake.surface.is_plane_and_not_drum:
        response = response_with_figures_of_merit(brake, response)
    if not model_error:
        return response
    own = estimate_error_of_plane_stress(brake, response, penalty=penalty, cache=cache)
    return replace(response, plane_stress_error=own)


def _require_tolerance_without_elements(
    tolerance: float | None, elements: int | None, kind: str | None
) -> None:
    """Raise BadInput if elements are given together with a tolerance, which chooses them itself."""
    for option, value in {"elements": elements, "kind": kind}.items():
        if tolerance is not None and value is not None:
            raise BadInput(
                f"--tolerance = {tolerance:g}: chooses the elements; leave out --{option} = {value}"
            )


def _solved_model_in_plane_stress(
    brake: Brake,
    *,
    elements: int | None,
    kind: str | None,
    tolerance: float | None,
    penalty: float,
    use_first_level: Callable[[Response], None] | None,
    cache: CacheOfCondensedBodies | None,
) -> SolvedLevel:
    """The prepared model and the response of a brake in plane stress; parameters as in `solve`.

    A given tolerance must be met, except on the meshes of files. On these meshes, and without a
    given tolerance, the solve comes as close to its tolerance as it can. If elements or their kind
    are given, the brake is solved once, without error estimate.
    """
    answer = partial(solve_prepared_model, penalty=penalty)
    if tolerance is not None:
        require_tolerance_between_zero_and_one(tolerance)
    if elements is None and kind is None and any(shoe.mesh for shoe in brake.shoes):
        return solve_brake_on_mesh_files(brake, answer, tolerance, cache)
    if tolerance is not None:
        asked = TolerancesOfPressureAndTorque(tolerance, tolerance)
        return solve_brake_to_tolerance(brake, asked, answer, cache=cache)
    if _is_brake_solved_on_hp_element_levels(brake, elements, kind):
        levels = None
        if use_first_level is not None:
            levels = solve_on_levels_and_hand_out_first(brake, answer, cache, use_first_level)
        return solve_brake_to_tolerance(
            brake,
            DEFAULT_TOLERANCES_OF_PRESSURE_AND_TORQUE,
            answer,
            must=False,
            cache=cache,
            levels=levels,
        )
    model = prepared_model_with_finest_elements(brake, elements=elements, kind=kind, cache=cache)
    return SolvedLevel(model, answer(model, brake))


def prepared_model_with_finest_elements(
    brake: Brake,
    *,
    elements: int | None = None,
    kind: str | None = None,
    cache: CacheOfCondensedBodies | None = None,
) -> PreparedModel:
    """The prepared model of the finest division that `solve` uses, for further analyses.

    The parameters and the errors raised are those of `finest_prepared_model_with_stated_errors`.
    """
    return finest_prepared_model_with_stated_errors(
        brake, elements=elements, kind=kind, cache=cache
    ).scene


class FinestPreparedModelWithErrors(NamedTuple):
    """The prepared model of the finest division of a brake, and the errors of its response.

    Attributes
    ----------
    scene : the prepared model
    error : estimated relative errors of the response in full slip, as in `Response.error`; None
        without an estimate or without a solution
    """

    scene: PreparedModel
    error: Mapping[str, float] | None = None


def finest_prepared_model_with_stated_errors(
    brake: Brake,
    *,
    elements: int | None = None,
    kind: str | None = None,
    cache: CacheOfCondensedBodies | None = None,
) -> FinestPreparedModelWithErrors:
    """The prepared model of the finest division that `solve` uses, with the errors that it states.

    The elements of a mesh file are split and their degree is raised as in `solve`. For a brake
    without a solution in full slip, the second level of refinement is taken.

    Parameters
    ----------
    brake : the brake
    elements, kind : number and kind of the elements, as in `solve`
    cache : keeps the condensed bodies of earlier solves

    Raises
    ------
    BadInput
        for `elements` or a `kind` that would change no part of the brake
    """
    require_element_options_have_effect(brake, elements=elements, kind=kind)
    if elements is None and kind is None and any(shoe.mesh for shoe in brake.shoes):
        try:
            solved = solve_brake_on_mesh_files(brake, solve_prepared_model, None, cache)
        except NoAnswer:
            return FinestPreparedModelWithErrors(
                prepared_model_on_second_level_of_mesh_files(brake, cache)
            )
        return FinestPreparedModelWithErrors(solved.prepared_model, solved.response.error)
    if not _is_brake_solved_on_hp_element_levels(brake, elements, kind):
        elements = DEFAULT_ELEMENTS_ALONG_LINING if elements is None else elements
        kind = kind or DEFAULT_MESH_KIND
        return FinestPreparedModelWithErrors(
            make_prepared_model(brake, elements=elements, kind=kind, cache=cache)
        )
    # The model is that of the last level on which a solution was found.
    try:
        solved = solve_brake_to_tolerance(
            brake,
            DEFAULT_TOLERANCES_OF_PRESSURE_AND_TORQUE,
            solve_prepared_model,
            must=False,
            cache=cache,
        )
    except NoAnswer:
        return FinestPreparedModelWithErrors(
            make_prepared_model(brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[1], cache=cache)
        )
    return FinestPreparedModelWithErrors(solved.prepared_model, solved.response.error)


def require_element_options_have_effect(
    brake: Brake, *, elements: int | None = None, kind: str | None = None
) -> None:
    """Raise BadInput for options `elements` or `kind` that would change no part of the brake.

    Shoes with mesh files are not divided. An elastic ring is divided into a number of elements, but
    always of one kind.

    Parameters
    ----------
    brake : the brake
    elements : number of elements along each lining; None for no choice
    kind : kind of the elements; None for no choice
    """
    given = {"kind": kind} if brake.ring else {"elements": elements, "kind": kind}
    for option, value in given.items():
        if value is not None and all(shoe.mesh for shoe in brake.shoes):
            raise BadInput(
                f"--{option} = {value}: all shoes have mesh files, whose elements stay as they are"
            )


def _is_brake_solved_on_hp_element_levels(
    brake: Brake, elements: int | None, kind: str | None
) -> bool:
    """Whether a brake is solved on finer and finer hp elements, and not on one mesh."""
    return elements is None and kind is None and not any(shoe.mesh for shoe in brake.shoes)


def _response_with_note_on_curve_balance(brake: Brake, response: Response) -> Response:
    """A copy of the response with a note, if the curve p(theta) balances worse than nodal forces.

    If the curve balances as well as the nodal forces, the response itself is returned.
    """
    # Positive differences mean that p(theta) balances worse than the nodal forces do.
    under_forces = brake_with_forces_of_response(brake, response)
    curve = largest_imbalance_among_shoes(
        [relative_imbalance_of_shoe(under_forces, i, shoe) for i, shoe in enumerate(response.shoes)]
    )
    more_force = curve.force - response.balance.force
    more_moment = curve.moment - response.balance.moment
    if max(more_force, more_moment) <= SMALLEST_REPORTED_PRESSURE_CURVE_IMBALANCE:
        return response
    note = (
        f"p(theta) on the round drum balances to {error_text_in_percent(curve.force)} (force) and "
        f"{error_text_in_percent(curve.moment)} (moment) only: the lining's elements are not "
        "quite as round"
    )
    return replace(response, notes=(*response.notes, note))
