"""The error of plane stress: how far its answer is from the answer of shoes with their widths.

For the estimate a brake is solved twice on the same coarse hp elements of the section: with degree
2 across the width, and in plane stress. The error is the distance of the two answers. The elements
are small at the ends of the contact that a solve in plane stress has found before. The
discretisation error of the coarse elements is in both answers and cancels. If the coarse elements
do not resolve the contact, the elements of the first level of a solve replace them. A wide web is
cut across its width, see `pieces.WIDEST_FIRST_PIECE_WITHOUT_CUT`. Degree 1 across the width would
not show the error, since u_x and u_y are then constant over the width of a shoe whose parts have
one width.
"""

import math
from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np

from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake
from drumlin.brake.further_loads import brake_with_all_loads_moved_to_actuation
from drumlin.fem.error_control.levels import (
    REFINEMENT_LEVELS_FROM_COARSE_TO_FINE,
    RULE_OF_DEGREE_AND_GRADING,
)
from drumlin.fem.error_control.singular_points import (
    reason_if_any_contact_is_too_short,
    singular_points_of_each_shoe_shape,
)
from drumlin.fem.hp.division import RefinementLevel, ShoeElementDivision
from drumlin.fem.model import DEFAULT_PENALTY_FACTOR, solve_prepared_model
from drumlin.fem.preparation.cache import (
    CacheOfCondensedBodies,
    indices_of_first_shoes_of_equal_shape,
)
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.preparation.scene import LockingFrictionsOfRigidShoes
from drumlin.fem.width.pieces import pieces_with_a_cut_in_wide_webs
from drumlin.fem.width.prepare import (
    prepare_model_with_widths_on_given_elements,
    reason_why_effect_of_widths_is_not_estimated,
    refinement_level_for_narrow_shoes,
)
from drumlin.response.norms import relative_distance_of_pressures
from drumlin.response.response import (
    EstimatedErrorOfPlaneStress,
    Response,
    ShoeResponse,
    length_of_uncompared_edge_zone,
    reference_force_of_reaction_errors,
)

LEVEL_OF_PLANE_STRESS_ERROR_ESTIMATE = replace(
    RULE_OF_DEGREE_AND_GRADING.refinement_level_with_number(0),
    face_layer_size=1.0,
    lining_end_column_size=1.0,
    interface_layer_size=1.0,
    hinge_column_size=1.0,
)
"""Coarse level of hp elements on which the error of plane stress is estimated.

The level is one step coarser than the first level of a solve, by the rule from which all levels
follow. By this rule the elements at corners and interfaces would be larger than the thickness of
their layers. The sizes of these elements are therefore set to the thickness.
"""
WIDTH_DEGREE_COMPARED_WITH_PLANE_STRESS = 2
"""Degree across the width of the answer with which plane stress is compared for its error."""
LARGEST_PRESSURE_ERROR_OF_COARSE_ELEMENTS = 0.1
"""Relative error (L2) of the pressure above which the coarse elements are too coarse.

The error is the distance between the pressures in plane stress on the coarse elements and on a fine
level. Above the limit the elements of the first level of a solve replace the coarse elements.
Contacts that are short compared with the lining's thickness cover one to three nodes of the coarse
elements, and the error of their pressure is 0.5 or more. For all other contacts the error is at
most 0.05.
"""


class CoarsePlaneStressSolution(NamedTuple):
    """The coarse hp elements of a brake's shoes, and the answer of plane stress on these elements.

    `divisions` are the divisions of the shoes' sections into hp elements, by the index of the first
    shoe of each shape. Degrees across the width are compared on these elements. `plane` is the
    answer of plane stress. `rigid_limits` are the friction coefficients at which the rigid shoes
    lock.
    """

    divisions: Mapping[int, ShoeElementDivision]
    plane: Response
    rigid_limits: LockingFrictionsOfRigidShoes


def plane_stress_solution_on_coarse_hp_elements(
    brake: Brake,
    response: Response,
    *,
    penalty: float = DEFAULT_PENALTY_FACTOR,
    cache: CacheOfCondensedBodies | None = None,
) -> CoarsePlaneStressSolution:
    """The coarse hp elements of a brake, with the answer of plane stress on them.

    If the coarse elements do not resolve the contact, they are the elements of the first level of a
    solve. The parameters are those of `estimate_error_of_plane_stress`.

    Raises
    ------
    NoAnswer
        if plane stress has no answer on the first level
    """
    answered = partial(
        plane_stress_solution_on_given_hp_elements, brake, response, penalty=penalty, cache=cache
    )
    try:
        coarse = answered(LEVEL_OF_PLANE_STRESS_ERROR_ESTIMATE)
    except NoAnswer:
        return answered(REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0])
    error = relative_distance_of_plane_stress_from_width_solution(brake, coarse.plane, response)
    if error.unknown or error.brake["pressure"] > LARGEST_PRESSURE_ERROR_OF_COARSE_ELEMENTS:
        return answered(REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0])
    return coarse


def plane_stress_solution_on_given_hp_elements(
    brake: Brake,
    response: Response,
    level: RefinementLevel,
    *,
    penalty: float = DEFAULT_PENALTY_FACTOR,
    cache: CacheOfCondensedBodies | None = None,
) -> CoarsePlaneStressSolution:
    """The hp elements of a brake on a given level, with the answer of plane stress on them.

    Parameters
    ----------
    brake : the brake
    response : an earlier answer of plane stress; the elements are small at the ends of its contact
    level : degree of the hp elements, and their sizes at singular points
    penalty : factor alpha of the contact stiffness alpha E/t (lining modulus E, thickness t)
    cache : substructures of earlier solves

    Raises
    ------
    NoAnswer
        if plane stress has no answer on the level
    """
    alike, level = (
        indices_of_first_shoes_of_equal_shape(brake),
        refinement_level_for_narrow_shoes(brake, level),
    )
    points = singular_points_of_each_shoe_shape(
        brake, response, alike, level.pressure_error_due_to_column_size_ratio
    )
    scene = make_prepared_model(brake, level, points, alike=alike, cache=cache)
    plane = solve_prepared_model(scene, brake, penalty=penalty, start=response)
    return CoarsePlaneStressSolution(scene.divisions, plane, scene.locking_frictions_of_rigid_shoes)


class CoarseSolutionsWithAndWithoutWidth(NamedTuple):
    """Answers of a brake on coarse hp elements, without and with widths.

    `plane` is the answer of plane stress, and `wide` is the answer with degree 2 across the width.
    """

    plane: Response
    wide: Response


def coarse_solutions_with_and_without_shoe_width(
    brake: Brake,
    response: Response,
    *,
    penalty: float = DEFAULT_PENALTY_FACTOR,
    cache: CacheOfCondensedBodies | None = None,
) -> CoarseSolutionsWithAndWithoutWidth:
    """The answers of a brake in plane stress and with widths, both on the same coarse hp elements.

    The parameters are those of `estimate_error_of_plane_stress`.

    Raises
    ------
    NoAnswer
        if the brake has no answer in plane stress or no answer with widths, and if a contact is too
        short for any elements
    """
    reason = reason_if_any_contact_is_too_short(brake, response)
    if reason is not None:
        raise NoAnswer(reason)
    brake = brake_with_all_loads_moved_to_actuation(brake)
    try:
        section = plane_stress_solution_on_coarse_hp_elements(
            brake, response, penalty=penalty, cache=cache
        )
        scene = prepare_model_with_widths_on_given_elements(
            brake, section.divisions, pieces_with_a_cut_in_wide_webs(brake), cache=cache
        )
        scene = replace(scene, rigid_limits=section.rigid_limits)
        wide = solve_prepared_model(scene, brake, penalty=penalty, start=response)
    except (NoAnswer, np.linalg.LinAlgError) as error:
        raise NoAnswer(f"on a coarse section, with its width: {error}") from error
    return CoarseSolutionsWithAndWithoutWidth(section.plane, wide)


def estimate_error_of_plane_stress(
    brake: Brake,
    response: Response,
    *,
    penalty: float = DEFAULT_PENALTY_FACTOR,
    cache: CacheOfCondensedBodies | None = None,
) -> EstimatedErrorOfPlaneStress:
    """The estimated error of plane stress, from answers with and without widths on coarse elements.

    Parameters
    ----------
    brake : the brake
    response : answer of plane stress; the coarse elements are small at the ends of its contact
    penalty : factor alpha of the contact stiffness alpha E/t (lining modulus E, thickness t)
    cache : substructures of earlier solves
    """
    reason = reason_why_effect_of_widths_is_not_estimated(brake)
    if reason is not None:
        return EstimatedErrorOfPlaneStress({}, unknown=reason)
    try:
        answers = coarse_solutions_with_and_without_shoe_width(
            brake, response, penalty=penalty, cache=cache
        )
    except NoAnswer as error:
        return EstimatedErrorOfPlaneStress({}, unknown=str(error))
    return relative_distance_of_plane_stress_from_width_solution(brake, *answers)


def relative_distance_of_plane_stress_from_width_solution(
    brake: Brake, plane: Response, wide: Response
) -> EstimatedErrorOfPlaneStress:
    """The relative difference between the answer of plane stress and the answer with widths.

    Parameters
    ----------
    brake : the brake
    plane : the answer of plane stress
    wide : the answer with widths; the differences are relative to its values
    """
    pairs = zip(plane.shoes, wide.shoes, strict=True)
    shoes = [
        relative_torque_pressure_and_reaction_differences(brake.surface_coordinate_per_phi, *pair)
        for pair in pairs
    ]
    for shoe, answer in zip(shoes, plane.shoes, strict=True):
        if not all(map(math.isfinite, shoe.values())):
            name = answer.name
            return EstimatedErrorOfPlaneStress(
                {}, unknown=f"shoe {name!r} loses its contact with its width"
            )
    total = wide.torque or plane.torque or 1.0
    worst = {name: max(shoe[name] for shoe in shoes) for name in ("pressure", "reaction")}
    torque = abs(plane.torque - wide.torque) / total
    return EstimatedErrorOfPlaneStress({"torque": torque, **worst}, tuple(shoes))


def relative_torque_pressure_and_reaction_differences(
    unit: float, plane: ShoeResponse, wide: ShoeResponse
) -> dict[str, float]:
    """Relative differences of torque, pressure (L2) and reaction of a shoe without and with width.

    The pressure is the mean over the width. `unit` is the growth of the coordinate along the
    friction surface per unit of phi: 1 on a drum, and the length of the lining [m] on a plane (see
    `ShoeFrame`).
    """
    zone = length_of_uncompared_edge_zone(float(wide.theta[-1] - wide.theta[0]), unit)
    moved = math.dist(plane.hinge_reaction, wide.hinge_reaction)
    total = wide.torque or plane.torque or 1.0
    return {
        "torque": abs(plane.torque - wide.torque) / total,
        "pressure": relative_distance_of_pressures(plane, wide, zone),
        "reaction": moved
        / reference_force_of_reaction_errors(wide.hinge_reaction, wide.normal_force),
    }
