"""Fits the safety factors of drumlin's error estimate on random brakes, and writes their file.

drumlin solves a brake on a sequence of finer and finer hp meshes, called levels. It estimates the
error by the change from one level to the next, multiplied by a safety factor.
`true_and_estimated_errors_of_random_brake` records this change for a random brake, and the true
error, which is the difference from a far finer solution. `fit_safety_factors` finds the smallest
factors with which the stated errors are at least as large as the true errors, except for the small
share 1 - FRACTION_COVERED_BY_STATED_ERROR. `error_estimate_factors_as_json_text` writes the factors
together with the brakes of the fit. The command

    make calibrate

runs the study `calibration`, which calls these functions. The same source code always writes the
same file.
"""

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from itertools import islice
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Bools, Floats
from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake
from drumlin.fem.error_control.adapt import errors_with_singular_points_and_text_on_short_contacts
from drumlin.fem.error_control.estimate import (
    QUANTITIES_WITH_STATED_ERROR,
    EstimatedErrors,
    SafetyFactorsOfErrorEstimate,
    relative_differences_of_responses_on_two_levels,
    sum_of_penalty_and_round_off_errors,
)
from drumlin.fem.error_control.levels import SolvedLevel, solve_brake_on_finer_and_finer_mesh_levels
from drumlin.fem.hp.corner import response_with_power_laws_at_corners
from drumlin.fem.model import solve_prepared_model
from drumlin_studies.random_brake import FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SHAPE_KIND as KINDS
from drumlin_studies.random_brake import draw_random_brake
from drumlin_studies.random_corners import (
    WAYS_TO_DRAW_BRAKES_BY_CORNER_KIND,
    draw_random_brake_pressing_with_corner_or_kink,
)
from drumlin_studies.random_kinds import (
    FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SUPPORT_KIND as KINDS_OF_HOLDING,
)
from drumlin_studies.random_kinds import draw_random_brake_of_support_kind
from drumlin_studies.stated_true import (
    SMALLEST_RELEVANT_TRUE_ERROR,
    FarFinerSolutionOfBrake,
    true_errors_of_response,
)
from drumlin_studies.stored_truth import (
    LEAST_USABLE_TRUE_ERROR_OVER_ITS_UNCERTAINTY,
    solve_brake_by_finer_hp_meshes,
    solve_brake_on_corner_or_kink_by_fine_triangles,
)

FIRST_SEED, FITTED_BRAKES = 300_000, 260
"""Seed of the first random brake of the fit, and number of these brakes: ten of each kind.

Other brakes, with the seeds from 70000 and from 700000 on, test the fitted factors."""

FIRST_CORNER, CORNER_BRAKES = 310_000, 60
"""Seed of the first brake of the fit that presses on the drum only by a corner or a tip.

A corner is an end of the lining's surface; a tip is a kink of this surface that points to the drum.
The second number is the number of these brakes: six of each kind. The factors are tested on brakes
of other seeds, see `corner_rows.SEED_OF_FIRST_CORNER_BRAKE`.
"""

FRACTION_COVERED_BY_STATED_ERROR = 0.995
"""Fraction of the true errors that must not exceed the stated errors in the fit.

README promises that at most 1 % of the stated errors are too small: twice the share that this fit
allows.
"""

NUMBER_OF_FITTED_HP_MESHES_PER_BRAKE = 5
"""Number of hp meshes (levels) of each brake whose errors are fitted.

A further level would be as fine as the solution from which true errors are taken."""

CANDIDATE_WEIGHTS_IN_FORCE_ERROR_ESTIMATE = tuple(2.0**-k for k in range(4, 14))
"""Candidates for a weight in the error estimate of forces.

The contributions of hp elements to the change of a force may cancel by accident. Therefore the
change that they would cause with random signs is multiplied by this weight and added to the actual
change. `fit_safety_factors` takes the candidate with the smallest median ratio of stated to true
error.
"""

FRACTION_COVERED_BY_TWICE_STATED_ERROR = 0.999
"""Fraction of the true errors that must not exceed twice the stated errors in the fit.

FRACTION_COVERED_BY_STATED_ERROR limits how many stated errors are too small.
FRACTION_COVERED_BY_TWICE_STATED_ERROR limits by how much they are too small.
"""

SIGNIFICANT_DIGITS_OF_SAFETY_FACTOR = 2
"""Number of significant digits of a safety factor. Further digits would depend on which random
brakes were drawn.
"""


class TrueErrorsAndEstimateTermsOnLevel(NamedTuple):
    """True errors on one hp mesh (level), and the terms of their estimate, by quantity.

    Attributes
    ----------
    step : relative change from the level before to this one, the largest of all shoes
    chance : change that a force would have if the elements contributed to it with random signs
    beside : error by the finite contact stiffness (penalty) plus round-off error, without factor
    true : true error, relative to a far finer solution
    unsure : uncertainty of the true error
    """

    step: Mapping[str, float]
    chance: Mapping[str, float]
    beside: Mapping[str, float]
    true: Mapping[str, float]
    unsure: Mapping[str, float]


def draw_random_calibration_brake_and_name_of_kind(seed: int) -> tuple[str, Brake]:
    """The name of a kind of brakes, and the random brake of this kind, that a seed gives.

    Consecutive seeds go through all kinds. Seeds from FIRST_CORNER on give brakes that press on the
    drum only by a corner of the lining or by a kink of its surface that points to the drum.
    """
    if seed >= FIRST_CORNER:
        names = list(WAYS_TO_DRAW_BRAKES_BY_CORNER_KIND)
        return names[seed % len(names)], draw_random_brake_pressing_with_corner_or_kink(seed)
    kinds = [*KINDS, *KINDS_OF_HOLDING]
    kind = kinds[seed % len(kinds)]
    return kind, (draw_random_brake if kind in KINDS else draw_random_brake_of_support_kind)(
        seed, kind
    )


def true_and_estimated_errors_of_random_brake(seed: int) -> dict[str, Any]:
    """True and estimated errors of the random brake of a seed on all its meshes, as plain data.

    If the brake cannot be solved, "levels" is empty and "reason" says why.
    """
    kind = ""
    try:
        kind, brake = draw_random_calibration_brake_and_name_of_kind(seed)
        truth = (
            solve_brake_on_corner_or_kink_by_fine_triangles
            if seed >= FIRST_CORNER
            else solve_brake_by_finer_hp_meshes
        )(brake)
        levels = true_errors_and_estimates_on_each_mesh(
            brake,
            truth,
            islice(
                solve_brake_on_finer_and_finer_mesh_levels(brake, solve_prepared_model),
                NUMBER_OF_FITTED_HP_MESHES_PER_BRAKE,
            ),
        )
    except (NoAnswer, AssertionError) as error:
        # drumlin raises an AssertionError if round-off has inverted a tiny triangle of the finer
        # solution.
        return {"seed": seed, "kind": kind, "reason": str(error), "levels": []}
    return {
        "seed": seed,
        "kind": kind,
        "reason": "",
        "levels": [level._asdict() for level in levels],
    }


def true_errors_and_estimates_on_each_mesh(
    brake: Brake, truth: FarFinerSolutionOfBrake, found: Iterable[SolvedLevel]
) -> list[TrueErrorsAndEstimateTermsOnLevel]:
    """True errors of a brake and the terms of their estimate, on each mesh from the second one on.

    The true error of a quantity is nan if drumlin itself says that the quantity is not known, such
    as the peak of a pressure without bound.
    """
    # drumlin gets stated errors of zero for all quantities. An error that it returns larger than 0
    # then marks a quantity that it calls unknown, such as a peak without bound.
    nothing = EstimatedErrors.brake_errors_from_torque_and_shoe_errors(
        0.0, [dict.fromkeys(QUANTITIES_WITH_STATED_ERROR, 0.0)] * len(brake.shoes)
    )
    levels: list[TrueErrorsAndEstimateTermsOnLevel] = []
    before = None
    for _, raw in found:
        response = response_with_power_laws_at_corners(brake, raw)
        if before is not None:
            unknown, _ = errors_with_singular_points_and_text_on_short_contacts(
                nothing, brake, response
            )
            true = {
                name: math.nan if unknown.brake[name] > 0 else value
                for name, value in true_errors_of_response(
                    brake, response.shoes, truth.shoes
                ).items()
            }
            moved = relative_differences_of_responses_on_two_levels(brake, before, response)
            levels.append(
                TrueErrorsAndEstimateTermsOnLevel(
                    step=_largest_value_of_each_quantity_over_shoes(moved.differences),
                    chance=_largest_value_of_each_quantity_over_shoes(
                        moved.changes_with_random_signs
                    ),
                    beside=_largest_value_of_each_quantity_over_shoes(
                        sum_of_penalty_and_round_off_errors(response.shoes)
                    ),
                    true=true,
                    unsure=dict(truth.unsure),
                )
            )
        before = response
    return levels


def _largest_value_of_each_quantity_over_shoes(values: Floats) -> dict[str, float]:
    """For each quantity its largest value over all shoes; for the torque, the value of the brake.

    `values` (1 + 4 shoes,) are errors or changes in the order of `ResponseDifferencesOfTwoLevels`:
    the torque of the brake comes first, then four quantities of each shoe.
    """
    most = values[1:].reshape(-1, len(QUANTITIES_WITH_STATED_ERROR)).max(axis=0).tolist()
    return dict(zip(QUANTITIES_WITH_STATED_ERROR, most, strict=True)) | {"torque": float(values[0])}


class TrueErrorsAndEstimateTermsOfQuantity(NamedTuple):
    """The attributes of `TrueErrorsAndEstimateTermsOnLevel` for one quantity, as arrays (m,).

    Each of the m entries belongs to one brake on one of its meshes (levels).
    """

    step: Floats
    chance: Floats
    beside: Floats
    true: Floats
    unsure: Floats

    @property
    def mask_of_true_errors_usable_in_fit(self) -> Bools:
        """Whether each true error (m,) is large enough and certain enough to be used in the fit.

        A smaller or less certain value may be an error of the far finer solution instead.
        """
        return np.asarray(
            (self.true >= SMALLEST_RELEVANT_TRUE_ERROR)
            & (self.true > LEAST_USABLE_TRUE_ERROR_OVER_ITS_UNCERTAINTY * self.unsure)
        )

    def smallest_safety_factor(self, weight: float) -> float:
        """The smallest safety factor for which nearly all stated errors cover the true errors.

        FRACTION_COVERED_BY_STATED_ERROR and FRACTION_COVERED_BY_TWICE_STATED_ERROR say how many
        stated errors may be too small. The stated error is factor * (step + weight * chance) +
        beside, with the attributes of `TrueErrorsAndEstimateTermsOnLevel`. Any factor counts as
        large enough for a true error that is not usable.
        """
        # The part of each true error that factor * (step + weight * chance) must cover.
        most = np.where(
            self.mask_of_true_errors_usable_in_fit, self.true - self.unsure - self.beside, 0.0
        )
        needed = np.maximum(most, 0.0) / np.maximum(
            self.step + weight * self.chance, np.finfo(float).tiny
        )
        return round_up_to_significant_digits(
            max(
                float(np.quantile(needed, FRACTION_COVERED_BY_STATED_ERROR)),
                0.5 * float(np.quantile(needed, FRACTION_COVERED_BY_TWICE_STATED_ERROR)),
            )
        )

    def stated_over_true_errors(self, factor: float, weight: float) -> Floats:
        """Ratios (k,) of the stated to the true error, for the k entries with a usable true error.

        See `mask_of_true_errors_usable_in_fit`.
        """
        stated = factor * (self.step + weight * self.chance) + self.beside
        return (
            stated[self.mask_of_true_errors_usable_in_fit]
            / self.true[self.mask_of_true_errors_usable_in_fit]
        )


def true_and_estimated_errors_of_quantity(
    levels: Sequence[TrueErrorsAndEstimateTermsOnLevel], quantity: str
) -> TrueErrorsAndEstimateTermsOfQuantity:
    """True errors of one quantity and the terms of their estimate, on all meshes of all brakes.

    Meshes on which the true error is nan are left out.
    """
    rows = []
    for level in levels:
        if not math.isnan(level.true[quantity]):
            rows.append([errors[quantity] for errors in level])
    return TrueErrorsAndEstimateTermsOfQuantity(
        *np.array(rows).reshape(-1, len(TrueErrorsAndEstimateTermsOnLevel._fields)).T
    )


def fit_safety_factors(
    levels: Sequence[TrueErrorsAndEstimateTermsOnLevel],
) -> SafetyFactorsOfErrorEstimate:
    """The smallest safety factors for which nearly all stated errors cover the true errors.

    The fractions of stated errors that may be too small are set by FRACTION_COVERED_BY_STATED_ERROR
    and FRACTION_COVERED_BY_TWICE_STATED_ERROR. Torque and reaction have the same factor, the larger
    of their two factors. The estimated error of a force has a term for the change that the force
    would have if the elements contributed with random signs. Of the weights
    CANDIDATE_WEIGHTS_IN_FORCE_ERROR_ESTIMATE of this term, the one with the smallest median ratio
    of stated to true error is taken.
    """
    # The weight of the change with random signs is chosen first, because the safety factor of
    # forces depends on it.
    forces = [
        true_and_estimated_errors_of_quantity(levels, name) for name in ("torque", "reaction")
    ]
    weight = min(
        CANDIDATE_WEIGHTS_IN_FORCE_ERROR_ESTIMATE,
        key=partial(_median_stated_over_true_error, forces),
    )
    of_forces = _largest_safety_factor_of_quantities(forces, weight)
    pressure, peak = (
        true_and_estimated_errors_of_quantity(levels, name).smallest_safety_factor(0.0)
        for name in ("pressure", "peak")
    )
    return SafetyFactorsOfErrorEstimate(
        pressure,
        of_forces,
        round_up_to_significant_digits(of_forces * weight),
        peak,
    )


def _largest_safety_factor_of_quantities(
    quantities: Sequence[TrueErrorsAndEstimateTermsOfQuantity], weight: float
) -> float:
    """The largest safety factor that any of the quantities needs.

    `weight` multiplies the change that a force would have if elements contributed with random
    signs.
    """
    return max(of.smallest_safety_factor(weight) for of in quantities)


def _median_stated_over_true_error(
    quantities: Sequence[TrueErrorsAndEstimateTermsOfQuantity], weight: float
) -> float:
    """The median ratio of stated to true error over several quantities with a common safety factor.

    `weight` multiplies the change that a force would have if elements contributed with random
    signs.
    """
    factor = _largest_safety_factor_of_quantities(quantities, weight)
    ratios = [of.stated_over_true_errors(factor, weight) for of in quantities]
    return float(np.median(np.concatenate(ratios)))


def round_up_to_significant_digits(value: float) -> float:
    """The value rounded up to SIGNIFICANT_DIGITS_OF_SAFETY_FACTOR significant digits."""
    # The subtraction of 1e-9 protects a value that already has the right digits: round-off above it
    # would otherwise raise its last digit.
    scale = 10.0 ** (math.floor(math.log10(value)) - SIGNIFICANT_DIGITS_OF_SAFETY_FACTOR + 1)
    return float(
        f"{math.ceil(value / scale - 1e-9) * scale:.{SIGNIFICANT_DIGITS_OF_SAFETY_FACTOR}g}"
    )


MEANINGS_OF_SAFETY_FACTORS = {
    "pressure": "Error of p in the L2 norm over the distance between the last two levels. "
    "If the factor is too small, stated errors of p are too small. "
    "If it is too large, solves go on to a finer level that nobody needs.",
    "force": "Error of a torque or a reaction over its distance between the last two levels. "
    "A factor that is too small or too large has the same effects as that of the pressure.",
    "cancelled": "Fraction of a force change that is added to the error of the force: the change "
    "that the last change of p would cause if its columns contributed with random signs. "
    "If the fraction is too small, a force that agrees on two levels by accident has too small a "
    "stated error. If it is too large, the stated errors of torque and reactions are many times "
    "too large wherever p is hardly known, as at a pressed corner.",
    "peak": "Error of the peak pressure over the larger of two distances between the last two "
    "levels: the distance of the peak, and the geometric mean of the distances of p in the column "
    "of the peak and in the L2 norm. "
    "A factor that is too small or too large has the same effects as that of the pressure.",
}
"""The meaning of each safety factor, as the file of the factors states it."""


class OriginOfSafetyFactors(NamedTuple):
    """The brakes and the code with which safety factors were fitted.

    Attributes
    ----------
    seeds : seeds of the random brakes, as text
    brakes : number of brakes that could be solved
    levels : number of levels of all these brakes together
    commit, date : commit of the source code and its date
    """

    seeds: str
    brakes: int
    levels: int
    commit: str
    date: str


def safety_factors_as_json_text(
    factors: Mapping[str, float],
    meanings: Mapping[str, str],
    provenance: Mapping[str, Any],
    reader: str,
) -> str:
    """The JSON text of a file of safety factors: each factor, its meaning, and their origin.

    Parameters
    ----------
    factors, meanings : mapping
        The factors and what each of them does, by name.
    provenance : mapping
        Where the factors come from.
    reader : str
        The module that reads the file.
    """
    written_by = f"make calibrate; read by {reader}; not to be edited by hand"
    entries = {name: {"value": value, "meaning": meanings[name]} for name, value in factors.items()}
    data = {"written by": written_by, "provenance": dict(provenance), **entries}
    return json.dumps(data, indent=1) + "\n"


def error_estimate_factors_as_json_text(
    factors: SafetyFactorsOfErrorEstimate, provenance: OriginOfSafetyFactors
) -> str:
    """The JSON text of the file with the safety factors of the error estimate."""
    return safety_factors_as_json_text(
        factors._asdict(),
        MEANINGS_OF_SAFETY_FACTORS,
        provenance._asdict() | {"quantile": FRACTION_COVERED_BY_STATED_ERROR},
        "drumlin.fem.error_control.estimate",
    )
