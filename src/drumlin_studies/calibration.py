"""Fits the safety factors of drumlin's error estimate on random brakes, and writes their file.

drumlin solves a brake on a sequence of finer and finer hp meshes, called levels. It estimates the
error by the change from one level to the next, multiplied by a safety factor. `observe_levels`
records this change for a random brake, and the true error against a far finer solution.
`fit_safety_factors` finds the smallest factors with which the stated errors are at least as large
as the true errors, except for the small share 1 - QUANTILE. `factors_as_text` writes the factors
together with the brakes of the fit. The command

    make calibrate

runs the study `calibration`, which calls these functions. The same source code always writes the
same file.
"""

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from itertools import islice
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Bools, Floats
from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake
from drumlin.fem.error_control.adapt import errors_with_singularities
from drumlin.fem.error_control.estimate import QUANTITIES, Errors, Factors, beside, distances
from drumlin.fem.error_control.levels import SolvedLevel, solved_levels
from drumlin.fem.hp.corner import response_with_power_laws
from drumlin.fem.model import solve_prepared_model
from drumlin_studies.random_brake import SHAPE_KINDS as KINDS
from drumlin_studies.random_brake import random_brake
from drumlin_studies.random_corners import CORNER_KINDS, random_corner
from drumlin_studies.random_kinds import HOLDING_KINDS as KINDS_OF_HOLDING
from drumlin_studies.random_kinds import draw_brake_of_holding_kind
from drumlin_studies.stated_true import RELEVANT, Truth, true_errors
from drumlin_studies.stored_truth import CERTAIN, solve_by_deep_triangles, solve_by_finer_divisions

FIRST_SEED, FITTED_BRAKES = 300_000, 260
"""Seed of the first random brake of the fit, and number of these brakes: ten of each kind.

Other brakes, with the seeds from 70000 and from 700000 on, test the fitted factors."""

FIRST_CORNER, CORNER_BRAKES = 310_000, 60
"""Seed of the first brake of the fit that presses on the drum by a corner or a tip of the lining.

The second number is the number of these brakes: six of each kind. The factors are tested on brakes
of other seeds, see `corner_rows.FIRST_JUDGED`."""

QUANTILE = 0.995
"""Fraction of the true errors that must not exceed the stated errors in the fit.

README promises that at most twice the rest, 1 %, of the stated errors is too small."""

FITTED = 5
"""Number of hp meshes (levels) of each brake whose errors are fitted.

A further level would be as fine as the solution from which true errors are taken."""

CHANCE_WEIGHTS = tuple(2.0**-k for k in range(4, 14))
"""Candidates for a weight in the error estimate of forces.

The contributions of hp elements to the change of a force may cancel by accident. Therefore the
change that they would cause with random signs is multiplied by this weight and added to the actual
change. `fit_safety_factors` takes the candidate with the smallest median of stated over true error.
"""

HALF = 0.999
"""Fraction of the true errors that must not exceed twice the stated errors in the fit.

QUANTILE limits how many stated errors are too small; HALF limits by how much they are too small."""

SIGNIFICANT_DIGITS = 2
"""Number of significant digits of a safety factor. Further digits depend on the brakes drawn."""


class LevelRecord(NamedTuple):
    """True errors on one hp mesh (level), and the terms of their estimate, by quantity.

    Attributes
    ----------
    step : relative change since the level before, the largest of all shoes
    chance : change that the hp elements' contributions would cause with random signs
    beside : penalty and round-off errors
    true : true error, relative to a far finer solution
    unsure : uncertainty of the true error
    """

    step: Mapping[str, float]
    chance: Mapping[str, float]
    beside: Mapping[str, float]
    true: Mapping[str, float]
    unsure: Mapping[str, float]


def draw_calibration_brake(seed: int) -> tuple[str, Brake]:
    """The random brake of a seed, and before it the name of its kind.

    Consecutive seeds go through all kinds. Seeds from FIRST_CORNER on give brakes that press on the
    drum by a corner or a tip of the lining.
    """
    if seed >= FIRST_CORNER:
        names = list(CORNER_KINDS)
        return names[seed % len(names)], random_corner(seed)
    kinds = [*KINDS, *KINDS_OF_HOLDING]
    kind = kinds[seed % len(kinds)]
    return kind, (random_brake if kind in KINDS else draw_brake_of_holding_kind)(seed, kind)


def observe_levels(seed: int) -> dict[str, Any]:
    """True and estimated errors of the random brake of a seed on all its meshes, as plain data.

    If the brake cannot be solved, "levels" is empty and "reason" says why.
    """
    kind = ""
    try:
        kind, brake = draw_calibration_brake(seed)
        truth = (solve_by_deep_triangles if seed >= FIRST_CORNER else solve_by_finer_divisions)(
            brake
        )
        levels = level_errors(
            brake, truth, islice(solved_levels(brake, solve_prepared_model), FITTED)
        )
    except (NoAnswer, AssertionError) as error:
        # An AssertionError means that round-off has turned over a tiny triangle.
        return {"seed": seed, "kind": kind, "reason": str(error), "levels": []}
    return {
        "seed": seed,
        "kind": kind,
        "reason": "",
        "levels": [level._asdict() for level in levels],
    }


def level_errors(brake: Brake, truth: Truth, found: Iterable[SolvedLevel]) -> list[LevelRecord]:
    """True errors of a brake and the terms of their estimate, on each mesh from the second one on.

    The true error of a quantity is nan if drumlin itself says that the quantity is not known, such
    as the peak of a pressure without bound.
    """
    # With stated errors of zero, only a quantity that drumlin calls unknown gets an error above 0.
    nothing = Errors.worst(0.0, [dict.fromkeys(QUANTITIES, 0.0)] * len(brake.shoes))
    levels: list[LevelRecord] = []
    before = None
    for _, raw in found:
        response = response_with_power_laws(brake, raw)
        if before is not None:
            unknown, _ = errors_with_singularities(nothing, brake, response)
            true = {
                name: math.nan if unknown.brake[name] > 0 else value
                for name, value in true_errors(brake, response.shoes, truth.shoes).items()
            }
            moved = distances(brake, before, response)
            levels.append(
                LevelRecord(
                    step=_largest_of_shoes(moved.steps),
                    chance=_largest_of_shoes(moved.chance),
                    beside=_largest_of_shoes(beside(response.shoes)),
                    true=true,
                    unsure=dict(truth.unsure),
                )
            )
        before = response
    return levels


def _largest_of_shoes(values: Floats) -> dict[str, float]:
    """The largest value over all shoes for each quantity; for the torque, the value of the brake.

    `values` (1 + 4 shoes,) are in the order of `Distances`: the torque of the brake comes first.
    """
    most = values[1:].reshape(-1, len(QUANTITIES)).max(axis=0).tolist()
    return dict(zip(QUANTITIES, most, strict=True)) | {"torque": float(values[0])}


class Samples(NamedTuple):
    """The attributes of `LevelRecord` for one quantity, as arrays (m,).

    Each of the m entries is a level of a brake.
    """

    step: Floats
    chance: Floats
    beside: Floats
    true: Floats
    unsure: Floats

    @property
    def known(self) -> Bools:
        """Whether each true error (m,) is large enough and certain enough to be used in the fit.

        A smaller one may be the error of the finer solution from which true errors are taken.
        """
        return np.asarray((self.true >= RELEVANT) & (self.true > CERTAIN * self.unsure))

    def factor(self, weight: float) -> float:
        """The smallest safety factor with which the conditions QUANTILE and HALF are satisfied.

        The stated error is factor * (step + weight * chance) + beside. For a true error that is not
        certain, any factor counts as large enough.
        """
        # The factor that each sample needs, so that its stated error equals its true error.
        most = np.where(self.known, self.true - self.unsure - self.beside, 0.0)
        needed = np.maximum(most, 0.0) / np.maximum(
            self.step + weight * self.chance, np.finfo(float).tiny
        )
        return _round_up(
            max(float(np.quantile(needed, QUANTILE)), 0.5 * float(np.quantile(needed, HALF)))
        )

    def ratios(self, factor: float, weight: float) -> Floats:
        """Ratios (k,) of the error that drumlin states to the true error, for k `known` samples."""
        stated = factor * (self.step + weight * self.chance) + self.beside
        return stated[self.known] / self.true[self.known]


def samples_of_quantity(levels: Sequence[LevelRecord], quantity: str) -> Samples:
    """The errors of one quantity on all meshes of all brakes, without those whose error is nan."""
    rows = [
        [of[quantity] for of in level] for level in levels if not math.isnan(level.true[quantity])
    ]
    return Samples(*np.array(rows).reshape(-1, len(LevelRecord._fields)).T)


def fit_safety_factors(levels: Sequence[LevelRecord]) -> Factors:
    """The smallest safety factors with which QUANTILE and HALF are satisfied for each quantity.

    Torque and reaction share one factor, the larger of the two. The weight of the change by random
    signs is that of CHANCE_WEIGHTS with the smallest median of stated over true error.
    """
    # The factor of forces depends on the weight of the change by random signs.
    forces = [samples_of_quantity(levels, name) for name in ("torque", "reaction")]

    def force_factor(weight: float) -> float:
        """The safety factor of torque and reaction, for a given weight.

        The weight is that of the change by random signs.
        """
        return max(of.factor(weight) for of in forces)

    def median_error_ratio(weight: float) -> float:
        """The median ratio of stated to true error of torque and reaction, for a given weight.

        The weight is that of the change by random signs.
        """
        return float(
            np.median(np.concatenate([of.ratios(force_factor(weight), weight) for of in forces]))
        )

    weight = min(CHANCE_WEIGHTS, key=median_error_ratio)
    pressure, peak = (
        samples_of_quantity(levels, name).factor(0.0) for name in ("pressure", "peak")
    )
    return Factors(pressure, force_factor(weight), _round_up(force_factor(weight) * weight), peak)


def _round_up(value: float) -> float:
    """The value rounded up to SIGNIFICANT_DIGITS significant digits."""
    # The small number keeps a value that is already rounded from being rounded up again.
    scale = 10.0 ** (math.floor(math.log10(value)) - SIGNIFICANT_DIGITS + 1)
    return float(f"{math.ceil(value / scale - 1e-9) * scale:.{SIGNIFICANT_DIGITS}g}")


MEANING = {
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


class Provenance(NamedTuple):
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


def factors_as_text(factors: Factors, provenance: Provenance) -> str:
    """The JSON text of the safety factors' file: provenance, and each factor with its meaning."""
    data = {
        "written by": "make calibrate; read by drumlin.fem.error_control.estimate; "
        "not to be edited by hand",
        "provenance": provenance._asdict() | {"quantile": QUANTILE},
        **{
            name: {"value": value, "meaning": MEANING[name]}
            for name, value in factors._asdict().items()
        },
    }
    return json.dumps(data, indent=1) + "\n"
