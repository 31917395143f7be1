"""The factors of the error estimate, fitted on random brakes of every kind, and the file that holds
them.

Of each brake `observe` takes the levels of a solve one by one and writes down by how much they
move, and how far each is from a far finer solution. `fit` finds the factors with which the stated
errors of all brakes and levels are at least the true ones, but for a small share, 1 - QUANTILE.
`as_text` writes the factors with what they were fitted on. The study `calibration` does all of
this,

    make calibrate

and the same tree always writes the same file.
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
from drumlin.fem.error_control.adapt import seen
from drumlin.fem.error_control.estimate import QUANTITIES, Errors, Factors, beside, distances
from drumlin.fem.error_control.levels import Step, steps
from drumlin.fem.hp.corner import with_powers
from drumlin.fem.model import respond
from drumlin_studies.random_brake import SHAPE_KINDS as KINDS
from drumlin_studies.random_brake import random_brake
from drumlin_studies.random_corners import CORNER_KINDS, random_corner
from drumlin_studies.random_kinds import HOLDING_KINDS as KINDS_OF_HOLDING
from drumlin_studies.random_kinds import random_kind
from drumlin_studies.stated_true import Truth, errors
from drumlin_studies.stored_truth import CERTAIN, by_deep_triangles, by_finer

FIRST_SEED, BRAKES = 300_000, 260
"""Seed of the first random brake of the fit, and their number: ten of each kind. The seeds of the
stored truths (70000 and on) and of the study that judges (700000 and on) are others."""

FIRST_CORNER, CORNER_BRAKES = 310_000, 60
"""Seed of the first brake of the fit that presses with a corner or under a tip, and their number:
six of each kind. Other seeds are judged, see `corner_rows.FIRST_JUDGED`."""

QUANTILE = 0.995
"""Share of the true errors that the fit covers. Twice as many may be too small as README promises.
"""

FITTED = 5
"""Number of levels that are fitted on. The one after them is as fine as the truth itself."""

RELEVANT = 1e-6
"""True error below which any stated error counts as large enough. No solve is asked for so small an
error of p, and there the truth and the arithmetic are in doubt themselves.
"""

WEIGHTS = tuple(2.0**-k for k in range(4, 14))
"""Candidates for the weight of what chance signs would move a force by, over that of the step. The
one with the sharpest estimate is taken.
"""

HALF = 0.999
"""Share of the true errors that are at most twice what the factors alone state. A share QUANTILE
bounds how many stated errors are too small; this bounds by how much.
"""

DIGITS = 2
"""Significant digits of a factor. More would not be found again on other brakes."""


class Level(NamedTuple):
    """What is known of the answer of one level, of each of QUANTITIES.

    `step`, `chance`: the worst shoe's of `Distances`; `beside`: penalty and round-off errors;
    `true`: the error; `unsure`: the uncertainty of the true error.
    """

    step: Mapping[str, float]
    chance: Mapping[str, float]
    beside: Mapping[str, float]
    true: Mapping[str, float]
    unsure: Mapping[str, float]


def drawn(seed: int) -> tuple[str, Brake]:
    """The kind and the brake of a seed, one of any kind.

    Seeds from FIRST_CORNER on are of brakes that press with a corner or under a tip.
    """
    if seed >= FIRST_CORNER:
        names = list(CORNER_KINDS)
        return names[seed % len(names)], random_corner(seed)
    kinds = [*KINDS, *KINDS_OF_HOLDING]
    kind = kinds[seed % len(kinds)]
    return kind, (random_brake if kind in KINDS else random_kind)(seed, kind)


def observe(seed: int) -> dict[str, Any]:
    """The levels of the brake of a seed, as plain data; without an answer the reason in words."""
    kind = ""
    try:
        kind, brake = drawn(seed)
        truth = (by_deep_triangles if seed >= FIRST_CORNER else by_finer)(brake)
        levels = observed(brake, truth, islice(steps(brake, respond), FITTED))
    except (NoAnswer, AssertionError) as error:
        # Rounding turns over triangles that are too small.
        return {"seed": seed, "kind": kind, "reason": str(error), "levels": []}
    return {
        "seed": seed,
        "kind": kind,
        "reason": "",
        "levels": [level._asdict() for level in levels],
    }


def observed(brake: Brake, truth: Truth, found: Iterable[Step]) -> list[Level]:
    """What is known of the levels of a brake, from the second one on.

    Quantities are left out of which a solve says that they are not known, as of an unbounded peak.
    """
    nothing = Errors.worst(0.0, [dict.fromkeys(QUANTITIES, 0.0)] * len(brake.shoes))
    levels: list[Level] = []
    before = None
    for _, raw in found:
        response = with_powers(brake, raw)
        if before is not None:
            unknown, _ = seen(nothing, brake, response)
            true = {
                name: math.nan if unknown.brake[name] > 0 else value
                for name, value in errors(brake, response.shoes, truth.shoes).items()
            }
            moved = distances(brake, before, response)
            levels.append(
                Level(
                    step=_worst(moved.steps),
                    chance=_worst(moved.chance),
                    beside=_worst(beside(response.shoes)),
                    true=true,
                    unsure=dict(truth.unsure),
                )
            )
        before = response
    return levels


def _worst(values: Floats) -> dict[str, float]:
    """Of values (1 + 4 shoes,), in the order of `Distances`, the brake's torque and the worst
    shoe's others.
    """
    most = values[1:].reshape(-1, len(QUANTITIES)).max(axis=0).tolist()
    return dict(zip(QUANTITIES, most, strict=True)) | {"torque": float(values[0])}


class Samples(NamedTuple):
    """Of one quantity on all brakes and levels: `step`, `chance`, `beside`, `true`, `unsure` (m,)."""

    step: Floats
    chance: Floats
    beside: Floats
    true: Floats
    unsure: Floats

    @property
    def known(self) -> Bools:
        """Which true errors (m,) are relevant and known well: others may be errors of the truth."""
        return np.asarray((self.true >= RELEVANT) & (self.true > CERTAIN * self.unsure))

    def factor(self, weight: float) -> float:
        """The smallest factor of step + weight chance that covers what QUANTILE and HALF ask for.

        Where the true error is not known well any factor counts as enough, as it does in the
        promise.
        """
        most = np.where(self.known, self.true - self.unsure - self.beside, 0.0)
        needed = np.maximum(most, 0.0) / np.maximum(
            self.step + weight * self.chance, np.finfo(float).tiny
        )
        return _up(
            max(float(np.quantile(needed, QUANTILE)), 0.5 * float(np.quantile(needed, HALF)))
        )

    def ratios(self, factor: float, weight: float) -> Floats:
        """Stated over true error, of the true errors that are known well."""
        stated = factor * (self.step + weight * self.chance) + self.beside
        return stated[self.known] / self.true[self.known]


def samples(levels: Sequence[Level], quantity: str) -> Samples:
    """A quantity on all levels that have a true error of it."""
    rows = [
        [of[quantity] for of in level] for level in levels if not math.isnan(level.true[quantity])
    ]
    return Samples(*np.array(rows).reshape(-1, len(Level._fields)).T)


def fit(levels: Sequence[Level]) -> Factors:
    """The smallest factors that state at least QUANTILE of the true errors of each quantity.

    Torque and reaction share theirs, the larger of the two. Of the WEIGHTS of chance that with the
    smallest median of stated over true error.
    """
    forces = [samples(levels, name) for name in ("torque", "reaction")]

    def factor(weight: float) -> float:
        return max(of.factor(weight) for of in forces)

    def sharpness(weight: float) -> float:
        return float(
            np.median(np.concatenate([of.ratios(factor(weight), weight) for of in forces]))
        )

    weight = min(WEIGHTS, key=sharpness)
    pressure, peak = (samples(levels, name).factor(0.0) for name in ("pressure", "peak"))
    return Factors(pressure, factor(weight), _up(factor(weight) * weight), peak)


def _up(value: float) -> float:
    """The next larger number of DIGITS significant digits."""
    scale = 10.0 ** (math.floor(math.log10(value)) - DIGITS + 1)
    return float(f"{math.ceil(value / scale - 1e-9) * scale:.{DIGITS}g}")


MEANING = {
    "pressure": "Error of p in L2 over the distance of p on the last two levels. Smaller: stated errors of p are too "
    "small. Larger: solves go on to a finer level that nobody needed.",
    "force": "Error of a torque or a reaction over its distance on the last two levels. Smaller and larger as above.",
    "cancelled": "Fraction of what a force would move by, were the signs of the columns' contributions chance, that is "
    "added to its error. Smaller: forces that two levels share by accident are stated as sure. Larger: the errors of "
    "torque and reactions are stated many times too large where p is hardly known, as at a pressed corner.",
    "peak": "Error of the peak pressure over its distance on the last two levels, or where that is larger over the "
    "geometric mean of the distances of p in the column of the peak and in L2. Smaller and larger as above.",
}
"""A sentence on each of the factors, which stands in their file."""


class Provenance(NamedTuple):
    """What factors were fitted on: the `seeds` in words, the number of `brakes` that had an answer,
    of their `levels`, the `commit` of the code and its `date`.
    """

    seeds: str
    brakes: int
    levels: int
    commit: str
    date: str


def as_text(factors: Factors, provenance: Provenance) -> str:
    """The factors' file: what they were fitted on, and each with its meaning."""
    data = {
        "written by": "make calibrate; read by drumlin.fem.error_control.estimate; not to be edited by hand",
        "provenance": provenance._asdict() | {"quantile": QUANTILE},
        **{
            name: {"value": value, "meaning": MEANING[name]}
            for name, value in factors._asdict().items()
        },
    }
    return json.dumps(data, indent=1) + "\n"
