"""Brakes of every kind by finite elements and by their rigid-shoe law, new and worn in, in both
senses of motion.
"""

import math
from collections.abc import Mapping
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake
from drumlin.brake.surface import DRUM, PLANE
from drumlin.comparison import Outcome, edge_of, run
from drumlin.fem.analysis.self_locking import limits
from drumlin.fem.preparation.prepare import prepare
from drumlin.fem.solve import solve
from drumlin.laws import law
from drumlin.lining_wear import worn_in
from drumlin.models import MODELS, applicable
from drumlin.response.merit import brake_factor
from drumlin.response.norms import pressure_distance, relative
from drumlin.response.response import Response

TRUSTED, ROUGH = 0.05, 0.15  # relative errors up to which a law is trusted, and is an estimate
NO_EFFECT_ERROR = 1e-9  # below it the effect is no matter of the pressure


class BrakeInMotion(NamedTuple):
    """A brake in one sense of motion: by its law, new, and worn in; `others`: by the other models
    that apply.
    """

    file: str
    brake: Brake
    law: Response
    new: Response
    worn: Response
    others: Mapping[str, Outcome]


def both_ways(brake: Brake) -> tuple[Brake, Brake]:
    """The brake as its file says, and with the drum or the body moving the other way."""
    return brake, brake.reversed()


def case(file: str, brake: Brake, elements: int, *, solid: bool = False) -> BrakeInMotion:
    """A brake by law and finite elements; elements: along the worn-in linings; solid: also with
    solid shoes, where these apply. Raises NoAnswer.
    """
    by_law = law(brake)
    others = [model for model in applicable(brake) if model.name not in {"fem", by_law.model}]
    if solid and MODELS["solid"].why_not(brake) is None:
        others.append(MODELS["solid"])
    return BrakeInMotion(
        file,
        brake,
        by_law,
        solve(brake),
        worn_in.solve(brake, elements=elements),
        {model.name: run(model.name, partial(model.solve, brake)) for model in others},
    )


def mu_lock(brake: Brake, most: float = 2.0, elements: int = 20) -> float:
    """The friction [1] up to which the elastic brake has an answer; inf where there is one up to
    `most`.
    """
    try:
        found = limits(prepare(brake, elements=elements), brake, most, penalty=1e6)
    except NoAnswer:
        return math.nan
    return min((end.friction for end in found.values()), default=math.inf)


def row_of(found: BrakeInMotion, limit: float | None) -> dict[str, Any]:
    """One row of the table of brakes; `factor`, `factor_worn`: brake factors by finite elements,
    new and worn in.
    """
    brake, new = found.brake, found.new
    size = new.effect

    def distance(by: Response) -> float:
        """Of the law's pressure, L2, the worst shoe."""
        pairs = zip(found.law.shoes, by.shoes, strict=True)
        return max(pressure_distance(a, b, edge_of(brake)) for a, b in pairs if b.contact_arcs)

    return {
        "file": found.file,
        "motion": brake.sense,
        "law": found.law.model,
        "effect": size,
        "unit": brake.surface.effect_unit,
        "factor": brake_factor(brake, new),
        "factor_worn": brake_factor(brake, found.worn),
        "peak": max(shoe.peak_pressure for shoe in new.shoes),
        "reaction": max(float(np.linalg.norm(shoe.hinge_reaction)) for shoe in new.shoes),
        "mu_lock": limit,
        "new": relative(found.law.effect, size),
        "worn": relative(found.law.effect, found.worn.effect),
        "p": distance(new),
        "p_worn": distance(found.worn),
        "peak_worn": max(shoe.peak_pressure for shoe in found.worn.shoes),
        "balance": max(new.balance.force, new.balance.moment),
    }


def others_of(found: BrakeInMotion) -> list[dict[str, Any]]:
    """A row for each other model that applies: how far its effect is from finite elements, new and
    worn in.
    """
    base: dict[str, Any] = {"file": found.file, "motion": found.brake.sense}
    rows: list[dict[str, Any]] = []
    for name, outcome in found.others.items():
        if outcome.response is None:
            rows.append(base | {"model": name, "status": outcome.failure})
            continue
        by = outcome.response.effect
        errors = {"new": relative(by, found.new.effect), "worn": relative(by, found.worn.effect)}
        rows.append(base | {"model": name, "effect": by} | errors | {"status": "solved"})
    return rows


def cam_factor(brake: Brake) -> float:
    """4 B1 B2/(B1 + B2) of an S-cam brake with equal displacement of both tips: T/(F R) of rigid
    worn-in shoes, from the shoe factors B = T/(F R) that each has alone.
    """
    one, two = (
        law(brake.model_copy(update={"actuation": None, "shoes": (shoe.under(1e3),)})).torque
        / (1e3 * brake.size)
        for shoe in brake.shoes
    )
    return 4 * one * two / (one + two)


def verdict(rows: list[dict[str, Any]]) -> str:
    """Whether the law of a brake can be trusted, from its rows of both senses of motion."""
    surface, name = PLANE if rows[0]["unit"] == PLANE.effect_unit else DRUM, rows[0]["law"]
    effect_ = surface.effect

    def judged(key: str) -> str:
        error = max(abs(row[key]) for row in rows)
        word = (
            "can be trusted"
            if error <= TRUSTED
            else "is an estimate"
            if error <= ROUGH
            else "cannot be trusted"
        )
        return f"{word} ({f'off by up to {100 * error:.2g}' if error > 1e-4 else 'off by less than 0.01'} %)"

    if all(abs(row["new"]) < NO_EFFECT_ERROR for row in rows):
        return (
            f"The {effect_} follows from equilibrium alone, whatever the pressure. The pressure of the law {name!r} "
            f"{judged('p')} new, and {judged('p_worn')} worn in."
        )
    new, worn = (
        f"{judged(key)}, its pressure {judged(more)}"
        for key, more in (("new", "p"), ("worn", "p_worn"))
    )
    return f"New, the {effect_} of the law {name!r} {new}; worn in, the {effect_} {worn}."
