"""Brakes of every kind by finite elements and by rigid-shoe law, in both senses of motion.

Finite elements solve each brake with new linings and with worn-in linings.
"""

import math
from collections.abc import Mapping
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.surface import DRUM, PLANE
from drumlin.comparison import Outcome, edge_of, run
from drumlin.fem.analysis.self_locking import friction_limits_of_groups
from drumlin.fem.preparation.prepare import prepare
from drumlin.fem.solve import solve
from drumlin.laws import law
from drumlin.lining_wear import worn_in
from drumlin.models import MODELS, applicable
from drumlin.response.merit import brake_factor
from drumlin.response.norms import pressure_distance, relative
from drumlin.response.response import Response
from drumlin_studies.tables import values_of_key

TRUSTED = 0.05
"""Relative error up to which a law can be trusted."""
ROUGH = 0.15
"""Relative error up to which a law is an estimate."""
NO_EFFECT_ERROR = 1e-9
"""Relative error below which the effect of a brake follows from equilibrium alone.

The law and finite elements then agree to round-off, whatever their pressures.
"""


class BrakeInMotion(NamedTuple):
    """A brake in one sense of motion, by several models.

    Attributes
    ----------
    file : str
        Name of the brake file.
    brake : Brake
        The brake.
    law : Response
        By its rigid-shoe law.
    new, worn : Response
        By finite elements, with new and with worn-in linings.
    others : mapping
        By the other models that apply, by name.
    """

    file: str
    brake: Brake
    law: Response
    new: Response
    worn: Response
    others: Mapping[str, Outcome]


def brake_and_reversed_brake(brake: Brake) -> tuple[Brake, Brake]:
    """The brake as in its file, and with the opposite motion of the drum or the body."""
    return brake, brake.reversed()


def solve_by_all_models(
    file: str, brake: Brake, elements: int, *, solid: bool = False
) -> BrakeInMotion:
    """A brake by its law, by finite elements and by the other models that apply.

    Parameters
    ----------
    file : str
        Name of the brake file.
    brake : Brake
        The brake.
    elements : int
        Elements along the worn-in linings.
    solid : bool
        Whether solid shoes are included, where they apply.

    Raises
    ------
    NoAnswer
        The law or finite elements have no answer.
    """
    by_law = law(brake)
    models = [*applicable(brake)]
    if solid and MODELS["solid"].why_not(brake) is None:
        models.append(MODELS["solid"])
    others: dict[str, Outcome] = {}
    for model in models:
        # The law and the default finite elements have places of their own in the result.
        if model.name not in {"fem", by_law.model}:
            others[model.name] = run(model.name, partial(model.solve, brake))
    worn = worn_in.solve_worn_in_brake(brake, elements=elements)
    return BrakeInMotion(file, brake, by_law, solve(brake), worn, others)


def locking_friction(brake: Brake, most: float = 2.0, elements: int = 20) -> float:
    """The coefficient of friction up to which the elastic brake has an answer.

    The result is inf where the brake has an answer up to the friction `most`, and nan where it has
    no answer even without friction. `elements` counts the elements along a lining.
    """
    try:
        found = friction_limits_of_groups(
            prepare(brake, elements=elements), brake, most, penalty=1e6
        )
    except NoAnswer:
        return math.nan
    # The shoe or the group of shoes with the lowest limit locks the brake.
    return min((end.friction for end in found.values()), default=math.inf)


def law_error_row(found: BrakeInMotion, limit: float | None) -> dict[str, Any]:
    """The row of a brake: its law against finite elements, with new and with worn-in linings.

    `factor` and `factor_worn` are brake factors by finite elements, `p` and `p_worn` the relative
    L2 distances of the law's pressure.

    limit : friction up to which the brake has an answer.
    """
    brake, new = found.brake, found.new
    size = new.effect

    def distance(by: Response) -> float:
        """Relative L2 distance of the law's pressure, the largest of all shoes."""
        # A shoe without contact has no pressure to which a distance could be relative.
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


def other_model_rows(found: BrakeInMotion) -> list[dict[str, Any]]:
    """Relative errors of each other model against finite elements, new and worn in: a row each."""
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
    """Brake factor T/(F R) = 4 B1 B2/(B1 + B2) of an S-cam brake with rigid worn-in shoes.

    The cam moves both tips by the same distance. B1 and B2 are the shoe factors T/(F R) that each
    shoe has alone.
    """

    def shoe_factor(shoe: Shoe) -> float:
        """The shoe factor T/(F R) of a shoe that is pushed alone by 1 kN."""
        # The shoe alone under 1 kN.
        alone = brake.model_copy(update={"actuation": None, "shoes": (shoe.under(1e3),)})
        return law(alone).torque / (1e3 * brake.size)

    one, two = map(shoe_factor, brake.shoes)
    return 4 * one * two / (one + two)


def law_verdict(rows: list[dict[str, Any]]) -> str:
    """Whether the law of a brake can be trusted, in words, by its rows of both senses of motion."""
    surface, name = PLANE if rows[0]["unit"] == PLANE.effect_unit else DRUM, rows[0]["law"]
    effect_ = surface.effect

    def judged(key: str) -> str:
        """Whether the larger error of both rows allows trust, with this error in percent."""
        error = np.abs(values_of_key(rows, key)).max()
        word = "is an estimate" if error <= ROUGH else "cannot be trusted"
        word = "can be trusted" if error <= TRUSTED else word
        size = f"up to {100 * error:.2g}" if error > 1e-4 else "less than 0.01"
        return f"{word} (off by {size} %)"

    if np.abs(values_of_key(rows, "new")).max() < NO_EFFECT_ERROR:
        return (
            f"The {effect_} follows from equilibrium alone, whatever the pressure. "
            f"The pressure of the law {name!r} "
            f"{judged('p')} new, and {judged('p_worn')} worn in."
        )
    new = f"{judged('new')}, its pressure {judged('p')}"
    worn = f"{judged('worn')}, its pressure {judged('p_worn')}"
    return f"New, the {effect_} of the law {name!r} {new}; worn in, the {effect_} {worn}."
