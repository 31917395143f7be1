"""The error of plane stress: the distance of its answer from that of shoes with their widths.

The estimate is the distance of two answers on one coarse division of the section: the answer of
degree 2 across the width, and the answer of plane stress. The division is graded to the contact
that plane stress has found. The discretisation error of the coarse division is in both answers and
cancels. Where the coarse division does not show the contact, the first level of a solve takes its
place. Degree 1 across the width does not show the error, since u_x and u_y are then constant over
the width of a shoe whose parts have one width.
"""

import math
from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np

from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake
from drumlin.brake.further_loads import brake_with_loads_at_actuation
from drumlin.fem.error_control.levels import LEVEL_RULE, LEVELS
from drumlin.fem.error_control.singular_points import singular_points_of_all_linings
from drumlin.fem.hp.division import Level, ShoeDivision
from drumlin.fem.model import PENALTY, solve_prepared_model
from drumlin.fem.preparation.cache import Cache, first_shoes_of_equal_shape
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.width.prepare import (
    level_for_narrow_shoes,
    prepare_divided_brake_with_widths,
    reason_against_width_model,
)
from drumlin.response.norms import relative_distance_of_pressures
from drumlin.response.response import (
    ModelError,
    Response,
    ShoeResponse,
    length_of_uncompared_edge_zone,
    reference_force_of_reaction_errors,
)

WIDTH_LEVEL = replace(
    LEVEL_RULE.refinement_level_with_number(0), zone=1.0, edge=1.0, back=1.0, hinge=1.0
)
"""Division of the section on which the error of plane stress is estimated.

By the rule of the levels it is one level coarser than the first level of a solve. The rule would
let the sizes of elements at corners exceed the thickness of the parts. Here these sizes are the
thickness.
"""
WIDTH_DEGREE = 2
"""Degree across the width of the answer from which the error of plane stress is estimated."""
COARSE_ENOUGH = 0.1
"""Relative error (L2) of the pressure by plane stress above which a coarse section is replaced.

The first level of a solve then takes the place of the coarse section. Contacts that are short
beside the lining's thickness lie on one to three nodes of the coarse section, and their pressure is
off by 0.5 or more. All other contacts are off by 0.05 at most.
"""


class CoarseSection(NamedTuple):
    """The division of a brake's section on which degrees across the width are compared.

    `divisions` are the divisions into hp elements by the position of the first shoe of each shape,
    and `plane` is the answer of plane stress on them.
    """

    divisions: Mapping[int, ShoeDivision]
    plane: Response


def plane_stress_solution_on_coarse_division(
    brake: Brake, response: Response, *, penalty: float = PENALTY, cache: Cache | None = None
) -> CoarseSection:
    """The coarse section of a brake, with the answer of plane stress on it.

    Where the coarse section misses the contact, the first level of a solve takes its place. The
    parameters are those of `estimate_error_of_plane_stress`.

    Raises
    ------
    NoAnswer
        where plane stress has no answer on the first level
    """
    answered = partial(
        plane_stress_solution_on_given_hp_elements, brake, response, penalty=penalty, cache=cache
    )
    try:
        coarse = answered(WIDTH_LEVEL)
    except NoAnswer:
        return answered(LEVELS[0])
    error = distance_of_plane_stress_from_widths(brake, coarse.plane, response)
    if error.unknown or error.brake["pressure"] > COARSE_ENOUGH:
        return answered(LEVELS[0])
    return coarse


def plane_stress_solution_on_given_hp_elements(
    brake: Brake,
    response: Response,
    level: Level,
    *,
    penalty: float = PENALTY,
    cache: Cache | None = None,
) -> CoarseSection:
    """The section of a brake by a level, with the answer of plane stress on it.

    Parameters
    ----------
    brake : the brake
    response : answer of plane stress, whose contact grades the section
    level : degree and grading of the hp elements
    penalty : factor alpha of the contact stiffness alpha E/t (lining modulus E, thickness t)
    cache : substructures of earlier solves

    Raises
    ------
    NoAnswer
        where plane stress has no answer on the level
    """
    alike, level = first_shoes_of_equal_shape(brake), level_for_narrow_shoes(brake, level)
    points = singular_points_of_all_linings(
        brake, response, alike, level.pressure_error_by_column_ratio
    )
    scene = make_prepared_model(brake, level, points, alike=alike, cache=cache)
    plane = solve_prepared_model(scene, brake, penalty=penalty, start=response)
    return CoarseSection(scene.divisions, plane)


class CoarseAnswers(NamedTuple):
    """Two answers on the coarse section of a brake: of plane stress, and of degree 2 in width."""

    plane: Response
    wide: Response


def coarse_solutions_with_and_without_widths(
    brake: Brake, response: Response, *, penalty: float = PENALTY, cache: Cache | None = None
) -> CoarseAnswers:
    """The answers of plane stress and of the model of the width on a coarse section of a brake.

    The parameters are those of `estimate_error_of_plane_stress`.

    Raises
    ------
    NoAnswer
        where one of the answers is missing
    """
    brake = brake_with_loads_at_actuation(brake)
    try:
        section = plane_stress_solution_on_coarse_division(
            brake, response, penalty=penalty, cache=cache
        )
        scene = prepare_divided_brake_with_widths(
            brake, section.divisions, WIDTH_DEGREE, cache=cache
        )
        wide = solve_prepared_model(scene, brake, penalty=penalty, start=response)
    except (NoAnswer, np.linalg.LinAlgError) as error:
        raise NoAnswer(f"on a coarse section, with its width: {error}") from error
    return CoarseAnswers(section.plane, wide)


def estimate_error_of_plane_stress(
    brake: Brake, response: Response, *, penalty: float = PENALTY, cache: Cache | None = None
) -> ModelError:
    """The estimated error of plane stress, from two answers on a coarse division of the section.

    Parameters
    ----------
    brake : the brake
    response : answer of plane stress, whose contact grades the coarse division
    penalty : factor alpha of the contact stiffness alpha E/t (lining modulus E, thickness t)
    cache : substructures of earlier solves
    """
    reason = reason_against_width_model(brake)
    if reason is not None:
        return ModelError({}, unknown=reason)
    try:
        answers = coarse_solutions_with_and_without_widths(
            brake, response, penalty=penalty, cache=cache
        )
    except NoAnswer as error:
        return ModelError({}, unknown=str(error))
    return distance_of_plane_stress_from_widths(brake, *answers)


def distance_of_plane_stress_from_widths(
    brake: Brake, plane: Response, wide: Response
) -> ModelError:
    """The relative distance of the answer of plane stress from that of shoes with their widths.

    Parameters
    ----------
    brake : the brake
    plane : the answer of plane stress
    wide : the answer with the widths, to whose values the distances are relative
    """
    pairs = zip(plane.shoes, wide.shoes, strict=True)
    shoes = [relative_distances_of_shoe_responses(brake.unit, *pair) for pair in pairs]
    for shoe, answer in zip(shoes, plane.shoes, strict=True):
        if not all(map(math.isfinite, shoe.values())):
            name = answer.name
            return ModelError({}, unknown=f"shoe {name!r} loses its contact with its width")
    total = wide.torque or plane.torque or 1.0
    worst = {name: max(shoe[name] for shoe in shoes) for name in ("pressure", "reaction")}
    torque = abs(plane.torque - wide.torque) / total
    return ModelError({"torque": torque, **worst}, tuple(shoes))


def relative_distances_of_shoe_responses(
    unit: float, plane: ShoeResponse, wide: ShoeResponse
) -> dict[str, float]:
    """The relative distances of torque, mean pressure (L2) and reaction of one shoe.

    The mean pressure is the mean over the width. `unit` is the coordinate of the surface per unit
    of phi, see `ShoeFrame`.
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
