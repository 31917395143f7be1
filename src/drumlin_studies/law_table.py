"""Tables of brakes solved by all laws and the foundation model: results, refusals, shoe factors."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake
from drumlin.brake.file import vary
from drumlin.laws import LAWS_OF_HINGED_SHOES_BY_NAME
from drumlin.models import MODELS
from drumlin.response.merit import barecki_shoe_factor
from drumlin.response.response import (
    FiguresOfMeritOnDrum,
    FiguresOfMeritOnPlane,
    Response,
    ShoeResponse,
)

MODELS_BESIDES_FINITE_ELEMENTS = tuple(name for name in MODELS if name not in {"fem", "solid"})
"""Names of drumlin's models without finite elements: rigid-shoe laws and the foundation model."""
ShoeResultRow = dict[str, Any]
"""A row of a table: values by the names of their columns."""


def rows_of_shoe_results_by_every_law(brake: Brake, file: str) -> list[ShoeResultRow]:
    """Solve a brake by every law and the foundation model; returns a row for each shoe and model.

    A model that cannot solve the brake has one row, with the reason. `file` is the name of the
    brake file, which every row repeats.
    """
    rows: list[ShoeResultRow] = []
    for name in MODELS_BESIDES_FINITE_ELEMENTS:
        reason = MODELS[name].why_not(brake)
        base = {"file": file, "law": name}
        if reason is not None:
            rows.append({**base, "reason": reason, "status": "does not apply"})
            continue
        try:
            response = MODELS[name].solve(brake)
        except NoAnswer as error:
            rows.append({**base, "reason": str(error), "status": "no answer"})
            continue
        for i in range(len(response.shoes)):
            rows.append({**base, **row_of_shoe_results(response, i)})
    return rows


def row_of_shoe_results(response: Response, index: int) -> ShoeResultRow:
    """The results of the shoe number `index` of a response, as a row of a table."""
    shoe, merit = response.shoes[index], response.merits[index]
    row = {
        "shoe": shoe.name,
        "normal": shoe.normal_force,
        "peak": shoe.peak_pressure,
        "reaction": float(np.linalg.norm(shoe.hinge_reaction)),
        "helps": "yes" if shoe.self_energising else "no",
        "status": "applies",
    }
    if isinstance(merit, FiguresOfMeritOnPlane):
        return row | {"braking": merit.braking_force, "S": merit.sensitivity_at_fixed_shape}
    return row | {
        "torque": shoe.torque,
        "eta": merit.mechanical_advantage,
        "S": merit.sensitivity_at_fixed_shape,
        "factor": merit.shoe_factor,
        "psi": merit.friction_radius,
        "angle": merit.resultant_angle,
    }


def rows_of_laws_that_cannot_solve_brakes(rows: Sequence[ShoeResultRow]) -> list[ShoeResultRow]:
    """A row for each brake file and reason of failure, with the laws that failed for this reason.

    `rows` are rows of `rows_of_shoe_results_by_every_law`.
    """
    laws: dict[tuple[str, str], ShoeResultRow] = {}
    for row in rows:
        if row["status"] == "applies":
            continue
        # Laws that fail for the same reason on the same brake share one row.
        key = row["file"], row["reason"]
        names = f"{laws[key]['laws']}, {row['law']}" if key in laws else row["law"]
        laws[key] = {"file": row["file"], "laws": names, "reason": row["reason"]}
    return list(laws.values())


def rows_of_shoe_factors_of_post_brake(brake: Brake) -> list[ShoeResultRow]:
    """A row for each law and shoe: shoe factor by eq. 26 of Barecki & Scieszka and by the law.

    In a row `S_26` is the shoe factor by eq. 26 and `S` the shoe factor by the law. `word` is
    "leading" or "trailing", by the sign of a term of eq. 26. `helps` says whether the shoe is
    self-energising.
    """
    rows = []
    for law in ("short", "cosine", "uniform", "sine"):
        response = MODELS[law].solve(brake)
        for shoe, data, merit in zip(response.shoes, brake.shoes, response.merits, strict=True):
            assert (
                isinstance(merit, FiguresOfMeritOnDrum)
                and merit.resultant_angle is not None
                and merit.friction_radius is not None
            )
            R = brake.size
            # Eq. 26 needs lengths divided by the drum's radius, and angles counted from the hinge.
            arm = abs(data.actuation.moment_of_force_about_point(data.pin) / data.actuation.force)
            angle = data.frame.phi_of_surface_coordinates(np.array(merit.resultant_angle))
            S = barecki_shoe_factor(
                brake.friction,
                angle,
                merit.friction_radius,
                data.pin.radius / R,
                arm / R,
                merit.double_delta,
            )
            rows.append(
                {
                    "law": law,
                    "shoe": shoe.name,
                    "word": "leading" if merit.double_delta > 0 else "trailing",
                    "helps": "yes" if shoe.self_energising else "no",
                    "S_26": float(S),
                    "S": merit.shoe_factor,
                    "n": merit.n,
                }
            )
    return rows


def responses_of_one_shoe_by_law(block: Brake, pad: Brake) -> dict[str, ShoeResponse]:
    """The response of one shoe by every law, by the names of the laws.

    Laws for drum brakes solve the first shoe of the brake `block`. For the law "pivoted" this shoe
    gets a pivot. The pivot lies away from the point at which the pressure would be symmetric. The
    law "linear" solves the first shoe of the brake `pad`, a brake on a plane.
    """
    shoes = {name: MODELS[name].solve(block).shoes[0] for name in LAWS_OF_HINGED_SHOES_BY_NAME}
    pivoted = vary(block, {"shoe.pivot": {"radius": "140 mm", "angle": "84 deg"}})
    shoes["pivoted"] = MODELS["pivoted"].solve(pivoted).shoes[0]
    shoes["linear"] = MODELS["linear"].solve(pad).shoes[0]
    return shoes
