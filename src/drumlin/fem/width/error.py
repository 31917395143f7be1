"""The error of plane stress itself: how far its answer is from that of the shoes with their widths.

The estimate is the distance of two answers on one coarse division of the section, graded to the
contact that plane stress has found: that of degree 2 across the width, and that of plane stress.
What the coarse division lacks is in both answers and cancels. Degree 1 does not tell the error,
since u_x and u_y then vary in no part of one width.
"""

import math
from dataclasses import replace

import numpy as np

from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake
from drumlin.fem.error_control.levels import RULE
from drumlin.fem.error_control.singular_points import singular_points_of
from drumlin.fem.model import PENALTY, respond
from drumlin.fem.preparation.cache import Cache
from drumlin.fem.preparation.cache import alike as equal_shapes
from drumlin.fem.preparation.prepare import prepare
from drumlin.fem.width.prepare import prepare_width, width_why_not
from drumlin.response.norms import pressure_distance
from drumlin.response.response import (
    ModelError,
    Response,
    ShoeResponse,
    reaction_size,
    singular_zone,
)

WIDTH_LEVEL = replace(RULE.level(0), zone=1.0, edge=1.0, back=1.0, hinge=1.0)
"""Division of the section on which the error of plane stress is estimated.

It is one level coarser, by the rule of the levels, than the first level of a solve. The rule would
let sizes at corners exceed the thickness of the parts; they are the thickness.
"""
WIDTH_DEGREE = 2
"""Degree across the width of the answer from which the error of plane stress is estimated."""


def plane_stress_error(
    brake: Brake, response: Response, *, penalty: float = PENALTY, cache: Cache | None = None
) -> ModelError:
    """The estimated error of plane stress, by two answers on a coarse division.

    Parameters
    ----------
    brake : the brake
    response : its answer by plane stress, whose contact grades the coarse division
    penalty : factor alpha of the contact stiffness alpha E/t
    cache : substructures of earlier solves
    """
    reason = width_why_not(brake)
    if reason is not None:
        return ModelError({}, unknown=reason)
    alike = equal_shapes(brake)
    points = singular_points_of(brake, response, alike, WIDTH_LEVEL.error)
    try:
        scene = prepare(brake, WIDTH_LEVEL, points, alike=alike, cache=cache)
        plane = respond(scene, brake, penalty=penalty, start=response)
        wide_scene = prepare_width(brake, WIDTH_LEVEL, WIDTH_DEGREE, points, cache=cache)
        wide = respond(wide_scene, brake, penalty=penalty, start=response)
    except (NoAnswer, np.linalg.LinAlgError) as error:
        return ModelError({}, unknown=f"on a coarse section, with its width: {error}")
    return model_distance(brake, plane, wide)


def model_distance(brake: Brake, plane: Response, wide: Response) -> ModelError:
    """The relative distance of an answer by plane stress from one of shoes with their widths.

    Parameters
    ----------
    brake : the brake
    plane : the answer by plane stress
    wide : the answer with the widths, to which errors are relative
    """
    pairs = zip(plane.shoes, wide.shoes, strict=True)
    shoes = [shoe_distance(brake.unit, *pair) for pair in pairs]
    for shoe, answer in zip(shoes, plane.shoes, strict=True):
        if not all(map(math.isfinite, shoe.values())):
            name = answer.name
            return ModelError({}, unknown=f"shoe {name!r} loses its contact with its width")
    total = wide.torque or plane.torque or 1.0
    worst = {name: max(shoe[name] for shoe in shoes) for name in ("pressure", "reaction")}
    torque = abs(plane.torque - wide.torque) / total
    return ModelError({"torque": torque, **worst}, tuple(shoes))


def shoe_distance(unit: float, plane: ShoeResponse, wide: ShoeResponse) -> dict[str, float]:
    """The relative distances of torque, mean pressure (L2) and reaction of one shoe.

    unit: of the surface's coordinate per radian, see `Frame`
    """
    zone = singular_zone(float(wide.theta[-1] - wide.theta[0]), unit)
    moved = math.dist(plane.hinge_reaction, wide.hinge_reaction)
    total = wide.torque or plane.torque or 1.0
    return {
        "torque": abs(plane.torque - wide.torque) / total,
        "pressure": pressure_distance(plane, wide, zone),
        "reaction": moved / reaction_size(wide.hinge_reaction, wide.normal_force),
    }
