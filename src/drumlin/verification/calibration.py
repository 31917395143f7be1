"""The factors of the error estimate, fitted on random brakes of every kind, and the file that holds them.

Of each brake `observe` takes the levels of a solve one by one and writes down by how much they move,
and how far each is from a far finer solution. `fit` finds the factors with which the stated errors
of all brakes and levels are at least the true ones, but for a small share, 1 - QUANTILE. `as_text`
writes the factors with what they were fitted on. The study `calibration` does all of this,

    make calibrate

and the same tree always writes the same file.
"""

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from drumlin.arrays import Bools, Floats
from drumlin.brake.brake import Brake
from drumlin.errors import NoAnswer
from drumlin.fem.hp.adapt import seen
from drumlin.fem.hp.corner import with_powers
from drumlin.fem.hp.estimate import QUANTITIES, Errors, Factors, beside, distances
from drumlin.fem.hp.levels import Step, steps
from drumlin.fem.model import respond
from drumlin.verification.random_brake import KINDS, random_brake
from drumlin.verification.random_kinds import KINDS as KINDS_OF_HOLDING
from drumlin.verification.random_kinds import random_kind
from drumlin.verification.stated_true import Truth, errors
from drumlin.verification.stored_truth import CERTAIN, by_finer

FIRST_SEED, BRAKES = 300_000, 260
"""Seed of the first random brake of the fit, and their number: ten of each kind. The seeds of the
stored truths (70000 and on) and of the studies that judge (8500 and on) are others."""

QUANTILE = 0.995
"""Share of the true errors that the fit covers. Twice as many may be too small as README promises."""

RELEVANT = 1e-6
"""True error below which a level is not fitted on. No solve is asked for so small an error of p, and
there the truth and the arithmetic are in doubt themselves."""

DIGITS = 2
"""Significant digits of a factor. More would not be found again on other brakes."""


class Level(NamedTuple):
    """What is known of the answer of one level, of each of QUANTITIES.

    `step`: the worst shoe's of `distances`; `beside`: penalty and round-off errors; `true`: the
    error; `unsure`: the uncertainty of the true error.
    """

    step: Mapping[str, float]
    beside: Mapping[str, float]
    true: Mapping[str, float]
    unsure: Mapping[str, float]


def drawn(seed: int) -> tuple[str, Brake]:
    """The kind and the brake of a seed, one of any kind."""
    kinds = [*KINDS, *KINDS_OF_HOLDING]
    kind = kinds[seed % len(kinds)]
    return kind, (random_brake if kind in KINDS else random_kind)(seed, kind)


def observe(seed: int) -> dict[str, Any]:
    """The levels of the brake of a seed, as plain data; without an answer the reason in words."""
    kind, brake = drawn(seed)
    try:
        levels = observed(brake, by_finer(brake), steps(brake, respond))
    except NoAnswer as error:
        return {"seed": seed, "kind": kind, "reason": str(error), "levels": []}
    return {"seed": seed, "kind": kind, "reason": "", "levels": [level._asdict() for level in levels]}


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
            levels.append(
                Level(
                    step=_worst(distances(brake, before, response)),
                    beside=_worst(beside(response.shoes)),
                    true=true,
                    unsure=dict(truth.unsure),
                )
            )
        before = response
    return levels


def _worst(values: Floats) -> dict[str, float]:
    """Of values (1 + 4 shoes,), in the order of `distances`, the brake's torque and the worst shoe's others."""
    most = values[1:].reshape(-1, len(QUANTITIES)).max(axis=0).tolist()
    return dict(zip(QUANTITIES, most, strict=True)) | {"torque": float(values[0])}


class Samples(NamedTuple):
    """Of one quantity on all brakes and levels: `step`, `beside`, `true`, `unsure` (m,)."""

    step: Floats
    beside: Floats
    true: Floats
    unsure: Floats

    @property
    def known(self) -> Bools:
        """Which true errors (m,) are known well: others may be errors of the truth."""
        return np.asarray(self.true > CERTAIN * self.unsure)

    @property
    def needed(self) -> Floats:
        """The factors of the step with which the true errors that are known well would just be stated."""
        most = np.maximum(self.true - self.unsure - self.beside, 0.0)
        return (most / np.maximum(self.step, np.finfo(float).tiny))[self.known]

    def ratios(self, factor: float) -> Floats:
        """Stated over true error, of the true errors that are known well."""
        return ((factor * self.step + self.beside) / self.true)[self.known]


def samples(levels: Sequence[Level], quantity: str) -> Samples:
    """The relevant levels' values of a quantity."""
    rows = [[of[quantity] for of in level] for level in levels]
    found = np.array([row for row in rows if row[2] >= RELEVANT]).reshape(-1, len(Level._fields))
    return Samples(*found.T)


def fit(levels: Sequence[Level]) -> Factors:
    """The smallest factors that state at least QUANTILE of the true errors of each quantity.

    Torque and reaction share theirs, the larger of the two.
    """
    needed = {name: _up(float(np.quantile(samples(levels, name).needed, QUANTILE))) for name in QUANTITIES}
    return Factors(needed["pressure"], max(needed["torque"], needed["reaction"]), needed["peak"])


def _up(value: float) -> float:
    """The next larger number of DIGITS significant digits."""
    scale = 10.0 ** (math.floor(math.log10(value)) - DIGITS + 1)
    return float(f"{math.ceil(value / scale - 1e-9) * scale:.{DIGITS}g}")


MEANING = {
    "pressure": "Error of p in L2 over the distance of p on the last two levels. Smaller: stated errors of p are too "
    "small. Larger: solves go on to a finer level that nobody needed.",
    "force": "Error of a torque or a reaction over its distance on the last two levels, with what cannot cancel in it. "
    "Smaller and larger as above.",
    "peak": "Error of the peak pressure over its distance on the last two levels, or where that is larger over the "
    "geometric mean of the distances of p in the column of the peak and in L2. Smaller and larger as above.",
}
"""A sentence on each of the factors, which stands in their file."""


class Provenance(NamedTuple):
    """What factors were fitted on: the `seeds` in words, the number of `brakes` that had an answer, of their `levels`,
    the `commit` of the code and its `date`."""

    seeds: str
    brakes: int
    levels: int
    commit: str
    date: str


def as_text(factors: Factors, provenance: Provenance) -> str:
    """The factors' file: what they were fitted on, and each with its meaning."""
    data = {
        "written by": "make calibrate; read by drumlin.fem.hp.estimate; not to be edited by hand",
        "provenance": provenance._asdict() | {"quantile": QUANTILE},
        **{name: {"value": value, "meaning": MEANING[name]} for name, value in factors._asdict().items()},
    }
    return json.dumps(data, indent=1) + "\n"
