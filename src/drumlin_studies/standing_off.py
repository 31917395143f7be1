"""Random brakes whose linings stand off the drum: clearances far above the lining's compression.

The contact of these brakes is short, and it moves along the lining as friction grows. The brakes
are drawn by the module `random_kinds` and then get another lining modulus, a clearance and a
smaller force.
"""

from typing import Any

import numpy as np

from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.brake import Brake
from drumlin.brake.plane_brake import make_drum_or_plane_brake_from_data
from drumlin.laws import solve_brake_by_its_rigid_shoe_law
from drumlin_studies.random_kinds import (
    FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SUPPORT_KIND,
    MOST_BRAKES_OF_SUPPORT_KIND_DRAWN_PER_SEED,
    RandomNumberGenerator,
    draw_number_uniform_in_logarithm,
    mirror_shoe_data_to_other_drum_side,
    mirror_turn_and_shift_brake,
)

RANGE_OF_LINING_MODULUS = 3e8, 1e11
"""Smallest and largest Young's modulus of the linings [Pa]."""
RANGE_OF_RELATIVE_CLEARANCE = 1e-4, 1 / 300
"""Smallest and largest clearance, as a fraction of the drum's radius or of a pad's length."""
RANGE_OF_FORCE_DIVISOR = 1.0, 300.0
"""Smallest and largest number by which the force of a brake of `random_kinds` is divided."""


def draw_random_brake_with_clearances(seed: int, kind: str | None = None) -> Brake:
    """The random brake of a seed with clearances; by the rigid-shoe law all shoes touch the drum.

    Contact is not tested by finite elements, because some of these brakes have no answer by finite
    elements.

    Parameters
    ----------
    seed : int
        The same seed always gives the same brake.
    kind : str, optional
        One of FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SUPPORT_KIND. By default the seed modulo their
        number chooses the kind.

    Raises
    ------
    NoAnswer
        No brake of the kind passes in MOST_BRAKES_OF_SUPPORT_KIND_DRAWN_PER_SEED draws.
    """
    names = list(FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SUPPORT_KIND)
    kind = names[seed % len(names)] if kind is None else kind
    for attempt in range(MOST_BRAKES_OF_SUPPORT_KIND_DRAWN_PER_SEED):
        rng = np.random.default_rng([seed, names.index(kind), attempt, 1])
        data = _brake_data_with_clearances_and_less_force(
            rng, FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SUPPORT_KIND[kind](rng)
        ) | {"title": f"standing off {kind} {seed}"}
        data["friction"] = round(float(rng.uniform(0.03, 0.5)), 4)
        turn, mirrored = float(rng.uniform(-3, 3)), bool(rng.random() < 0.5)
        try:
            brake = make_drum_or_plane_brake_from_data(data)
            turn = 0.0 if brake.surface.is_plane_and_not_drum else turn
            brake = mirror_turn_and_shift_brake(brake, turn=turn, mirrored=mirrored)
            if all(shoe.contact_arcs for shoe in solve_brake_by_its_rigid_shoe_law(brake).shoes):
                return brake
        except (BadInput, NoAnswer):
            continue
    raise NoAnswer(
        f"no brake of kind {kind} from seed {seed} in "
        f"{MOST_BRAKES_OF_SUPPORT_KIND_DRAWN_PER_SEED} attempts"
    )


def _brake_data_with_clearances_and_less_force(
    rng: RandomNumberGenerator, data: dict[str, Any]
) -> dict[str, Any]:
    """The data of a brake, changed to have clearances, other lining moduli and smaller forces.

    The two shoes of a cam become mirror images of each other. A cam moves the loaded ends of both
    shoes by the same distance. With different clearances only one of the shoes would touch the
    drum.
    """
    # All forces of the brake are divided by the same number.
    divisor = draw_number_uniform_in_logarithm(rng, *RANGE_OF_FORCE_DIVISOR)
    shoes = [
        _shoe_data_with_clearance_and_less_force(rng, shoe, data.get("drum"), divisor)
        for shoe in data["shoe"]
    ]
    result = data | {"shoe": shoes}
    if "actuation" in data:
        result["actuation"] = _actuation_data_with_divided_force(data["actuation"], divisor)
        has_cam = "force" in data["actuation"]
        if has_cam:
            result["shoe"] = [shoes[0], mirror_shoe_data_to_other_drum_side(shoes[0])]
    return result


def _shoe_data_with_clearance_and_less_force(
    rng: RandomNumberGenerator, shoe: dict[str, Any], drum: dict[str, Any] | None, divisor: float
) -> dict[str, Any]:
    """The data of a shoe, changed to a clearance, another lining modulus and a smaller force.

    drum : data of the drum, or None for a brake on a plane; divisor : number by which the force is
    divided.
    """
    lining = {key: value for key, value in shoe["lining"].items() if key != "misfit"}
    size = lining["end"] - lining["start"] if drum is None else drum["radius"]
    lining["clearance"] = size * draw_number_uniform_in_logarithm(rng, *RANGE_OF_RELATIVE_CLEARANCE)
    lining["material"] = lining["material"] | {
        "E": draw_number_uniform_in_logarithm(rng, *RANGE_OF_LINING_MODULUS)
    }
    result = shoe | {"lining": lining}
    if "actuation" in shoe:
        result["actuation"] = _actuation_data_with_divided_force(shoe["actuation"], divisor)
    return result


def _actuation_data_with_divided_force(actuation: dict[str, Any], divisor: float) -> dict[str, Any]:
    """The data of an actuation with its force or hydraulic pressure divided by a number."""
    return {
        key: value / divisor if key in {"force", "pressure"} else value
        for key, value in actuation.items()
    }
