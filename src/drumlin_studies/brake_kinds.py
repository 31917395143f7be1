"""Brakes of every kind, solved by finite elements and by rigid-shoe laws in both senses of motion.

Finite elements solve each brake with new linings and with worn-in linings. The tables show the
errors of the laws.
"""

import math
from collections.abc import Mapping
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.surface import FRICTION_SURFACE_OF_DRUM, FRICTION_SURFACE_OF_PLANE
from drumlin.comparison import (
    ModelResultOrReasonOfFailure,
    length_of_uncompared_zone_at_lining_end,
    solve_and_time_model,
)
from drumlin.fem.analysis.self_locking import self_locking_friction_of_shoe_groups
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.solve import solve
from drumlin.laws import solve_brake_by_its_rigid_shoe_law
from drumlin.lining_wear import worn_in
from drumlin.models import MODELS, applicable_models
from drumlin.response.merit import brake_factor
from drumlin.response.norms import relative_distance_of_pressures, relative_error_of_number
from drumlin.response.response import Response
from drumlin_studies.tables import values_of_key_in_rows

LARGEST_ERROR_OF_TRUSTED_LAW = 0.05
"""Relative error up to which the study's report says that a rigid-shoe law can be trusted."""
LARGEST_ERROR_OF_ROUGH_LAW = 0.15
"""Relative error up to which the study's report calls a rigid-shoe law a rough estimate."""
LARGEST_LAW_ERROR_OF_TORQUE_SET_BY_EQUILIBRIUM = 1e-9
"""Relative error of the law's torque below which the report says that the torque follows from
equilibrium alone, whatever the pressure.

The torques of law and finite elements then agree to round-off, even if their pressures differ.
"""


class BrakeSolvedByAllModels(NamedTuple):
    """A brake in one sense of motion, and its responses by several models.

    Attributes
    ----------
    file : str
        Name of the brake file.
    brake : Brake
        The brake.
    law : Response
        Response by the rigid-shoe law.
    new, worn : Response
        Responses by finite elements, with new and with worn-in linings.
    others : mapping
        Outcomes of the other models that can solve the brake, by their names.
    """

    file: str
    brake: Brake
    law: Response
    new: Response
    worn: Response
    others: Mapping[str, ModelResultOrReasonOfFailure]


def brake_and_reversed_brake(brake: Brake) -> tuple[Brake, Brake]:
    """The brake, and a copy of it with the opposite motion of the drum or the plane."""
    return brake, brake.brake_with_reversed_motion()


def solve_brake_by_all_models(
    file: str, brake: Brake, elements: int, *, solid: bool = False
) -> BrakeSolvedByAllModels:
    """Solve a brake by its rigid-shoe law, by finite elements and by every other suitable model.

    Parameters
    ----------
    file : str
        Name of the brake file.
    brake : Brake
        The brake.
    elements : int
        Number of elements along the worn-in linings.
    solid : bool
        Whether the model of three-dimensional shoes is included if it can solve the brake.

    Raises
    ------
    NoAnswer
        If the law or finite elements find no equilibrium.
    """
    by_law = solve_brake_by_its_rigid_shoe_law(brake)
    models = [*applicable_models(brake)]
    if solid and MODELS["solid"].why_not(brake) is None:
        models.append(MODELS["solid"])
    others: dict[str, ModelResultOrReasonOfFailure] = {}
    for model in models:
        # The law and the default finite elements are left out, because the result holds them
        # elsewhere.
        if model.name not in {"fem", by_law.model}:
            others[model.name] = solve_and_time_model(model.name, partial(model.solve, brake))
    worn = worn_in.solve_worn_in_brake(brake, elements=elements)
    return BrakeSolvedByAllModels(file, brake, by_law, solve(brake), worn, others)


def self_locking_friction_by_finite_elements(
    brake: Brake, most: float = 2.0, elements: int = 20
) -> float:
    """The coefficient of friction at which the brake with elastic linings locks itself.

    The result is inf if the brake has an equilibrium at every friction up to `most`, and nan if it
    has no equilibrium even without friction. `elements` is the number of elements along a lining.
    """
    try:
        found = self_locking_friction_of_shoe_groups(
            make_prepared_model(brake, elements=elements), brake, most, penalty=1e6
        )
    except NoAnswer:
        return math.nan
    # The shoe or the group of shoes with the lowest limit locks the brake.
    return min((end.friction for end in found.values()), default=math.inf)


def row_of_errors_of_rigid_shoe_law(
    found: BrakeSolvedByAllModels, limit: float | None
) -> dict[str, Any]:
    """A row of a table with the errors of a brake's law, for new and for worn-in linings.

    `new` and `worn` are relative errors of the law's torque (on a plane, of its braking force)
    against finite elements with new and with worn-in linings; `p` and `p_worn` are relative L2
    distances of the law's pressure from the finite elements' pressure. `factor` and `factor_worn`
    are brake factors by finite elements. `limit` is the friction at which the brake locks itself.
    """
    brake, new = found.brake, found.new
    size = new.effect

    def largest_pressure_error_of_law_on_any_shoe(by: Response) -> float:
        """Largest relative L2 distance, over all shoes, of the law's pressure from that in `by`."""
        # A shoe without contact has no pressure to which a distance could be relative.
        pairs = zip(found.law.shoes, by.shoes, strict=True)
        return max(
            relative_distance_of_pressures(a, b, length_of_uncompared_zone_at_lining_end(brake))
            for a, b in pairs
            if b.contact_arcs
        )

    return {
        "file": found.file,
        "motion": brake.direction_as_text_in_tables,
        "law": found.law.model,
        "effect": size,
        "unit": brake.surface.unit_of_torque_or_brake_force,
        "factor": brake_factor(brake, new),
        "factor_worn": brake_factor(brake, found.worn),
        "peak": max(shoe.peak_pressure for shoe in new.shoes),
        "reaction": max(float(np.linalg.norm(shoe.hinge_reaction)) for shoe in new.shoes),
        "mu_lock": limit,
        "new": relative_error_of_number(found.law.effect, size),
        "worn": relative_error_of_number(found.law.effect, found.worn.effect),
        "p": largest_pressure_error_of_law_on_any_shoe(new),
        "p_worn": largest_pressure_error_of_law_on_any_shoe(found.worn),
        "peak_worn": max(shoe.peak_pressure for shoe in found.worn.shoes),
        "balance": max(new.balance.force, new.balance.moment),
    }


def torque_error_rows_of_other_models(found: BrakeSolvedByAllModels) -> list[dict[str, Any]]:
    """Rows of a table with the relative errors of the torque of the other models.

    The other models are all models but the rigid-shoe law and the finite elements.

    The errors are relative to finite elements with new and with worn-in linings.
    """
    base: dict[str, Any] = {"file": found.file, "motion": found.brake.direction_as_text_in_tables}
    rows: list[dict[str, Any]] = []
    for name, outcome in found.others.items():
        if outcome.response is None:
            rows.append(base | {"model": name, "status": outcome.failure})
            continue
        by = outcome.response.effect
        errors = {
            "new": relative_error_of_number(by, found.new.effect),
            "worn": relative_error_of_number(by, found.worn.effect),
        }
        rows.append(base | {"model": name, "effect": by} | errors | {"status": "solved"})
    return rows


def brake_factor_of_cam_brake(brake: Brake) -> float:
    """Brake factor T/(F R) = 4 B1 B2/(B1 + B2) of an S-cam brake with rigid worn-in shoes.

    The cam moves the loaded ends of both shoes by the same distance. F is the mean of the two
    forces of the cam. B1 and B2 are the shoe factors T/(F R) of the two shoes, each actuated alone.
    """

    def shoe_factor_of_shoe_alone_in_brake(shoe: Shoe) -> float:
        """The shoe factor T/(F R) of a shoe that is alone in the brake, for a force F of 1 kN."""
        alone = brake.model_copy(
            update={"actuation": None, "shoes": (shoe.shoe_with_changed_actuation_force(1e3),)}
        )
        return solve_brake_by_its_rigid_shoe_law(alone).torque / (1e3 * brake.size)

    one, two = map(shoe_factor_of_shoe_alone_in_brake, brake.shoes)
    return 4 * one * two / (one + two)


def sentence_on_whether_law_can_be_trusted(rows: list[dict[str, Any]]) -> str:
    """A sentence that says whether the law of a brake can be trusted.

    `rows` are the results of `row_of_errors_of_rigid_shoe_law` for both senses of motion.
    """
    surface, name = (
        FRICTION_SURFACE_OF_PLANE
        if rows[0]["unit"] == FRICTION_SURFACE_OF_PLANE.unit_of_torque_or_brake_force
        else FRICTION_SURFACE_OF_DRUM,
        rows[0]["law"],
    )
    effect_ = surface.word_for_torque_or_brake_force

    def text_that_judges_error_of_law(key: str) -> str:
        """A verdict such as "can be trusted (off by up to 3 %)".

        `key` names an error of the law in the rows, such as "worn". The larger error of the two
        senses of motion decides.
        """
        error = np.abs(values_of_key_in_rows(rows, key)).max()
        word = "is an estimate" if error <= LARGEST_ERROR_OF_ROUGH_LAW else "cannot be trusted"
        word = "can be trusted" if error <= LARGEST_ERROR_OF_TRUSTED_LAW else word
        size = f"up to {100 * error:.2g}" if error > 1e-4 else "less than 0.01"
        return f"{word} (off by {size} %)"

    if (
        np.abs(values_of_key_in_rows(rows, "new")).max()
        < LARGEST_LAW_ERROR_OF_TORQUE_SET_BY_EQUILIBRIUM
    ):
        return (
            f"The {effect_} follows from equilibrium alone, whatever the pressure. "
            f"The pressure of the law {name!r} "
            f"{text_that_judges_error_of_law('p')} new, and "
            f"{text_that_judges_error_of_law('p_worn')} worn in."
        )
    new = (
        f"{text_that_judges_error_of_law('new')}, its pressure {text_that_judges_error_of_law('p')}"
    )
    worn = (
        f"{text_that_judges_error_of_law('worn')}, its pressure "
        f"{text_that_judges_error_of_law('p_worn')}"
    )
    return f"New, the {effect_} of the law {name!r} {new}; worn in, the {effect_} {worn}."
