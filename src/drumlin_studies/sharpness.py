"""Whether stated errors are large enough, and no larger than they need to be, on the brakes with
stored truths.

An error that is stated too small is a wrong number; one that is stated ten times too large costs a
level of hp elements that nobody needed. Both are measured by the ratio of stated to true error.
`judged` takes one brake through all levels once and reads from them what a solve states by default
and at two tolerances. `sharpness` reduces the ratios of each quantity to two numbers, and
`complaints` compares these with those that were written down when the factors of the estimate were
last fitted,

    python -m drumlin_studies.sharpness FOLDER

so that a test sees a factor that is halved as well as one that is doubled.
"""

import json
import math
import sys
from collections.abc import Iterable, Mapping, Sequence
from itertools import tee
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from scipy.stats import binom

from drumlin.base.errors import NoAnswer
from drumlin.base.files import write_text
from drumlin.brake.brake import Brake
from drumlin.fem.error_control.adapt import DEFAULT, Tolerance, adapt
from drumlin.fem.error_control.levels import Step, steps
from drumlin.fem.model import respond
from drumlin.response.response import Response
from drumlin_studies.stated_true import JUDGED_QUANTITIES as QUANTITIES
from drumlin_studies.stated_true import errors, ratio
from drumlin_studies.stored_truth import CERTAIN, StoredTruth, read

ASKED = {"default": DEFAULT, "1e-3": Tolerance(1e-3, 1e-3), "1e-4": Tolerance(1e-4, 1e-4)}
"""What a solve is asked for: nothing, and two tolerances."""

PROMISED = 0.01
"""Largest share of stated errors that may be too small, as README promises."""

SURE = 0.95
"""Of as many stated errors as are judged, the number that may be too small is the one that a share
PROMISED stays below with this probability: a promise that is kept must not turn a test red because
few are judged.
"""

NEAR = 0.3
"""How far the median and the smallest tenth of the ratios may be from the values that were written
down, relative. Half of it would be within what a change of the levels moves them by; at twice it a
factor of two would pass unseen.
"""

FILE = "sharpness.json"


class Judged(NamedTuple):
    """Stated and true errors of one brake at one of ASKED, by QUANTITIES.

    `unsure`: uncertainties of the true errors.
    """

    name: str
    asked: str
    stated: Mapping[str, float]
    true: Mapping[str, float]
    unsure: Mapping[str, float]

    def ratio(self, quantity: str) -> float:
        """Stated over true error, the true one less its uncertainty; inf where nothing is left, nan
        if unjudged.
        """
        kinds = {"stated": self.stated, "true": self.true, "unsure": self.unsure}
        return ratio({f"{kind}_{quantity}": of[quantity] for kind, of in kinds.items()}, quantity)

    def certain(self, quantity: str) -> bool:
        """Whether the true error is seen well enough to judge by how much the stated one is larger.

        A stated error of 1 says that the quantity is not known, which is no estimate of its size.
        """
        return self.true[quantity] > CERTAIN * self.unsure[quantity] and self.stated[quantity] < 1.0


class Spread(NamedTuple):
    """Of the ratios of stated to true error of one quantity: their median, and the value a tenth of
    them is below.
    """

    median: float
    tenth: float


def judged(name: str, stored: StoredTruth) -> list[Judged]:
    """Stated and true errors of the brake of a stored truth, one for each of ASKED that has an
    answer.
    """
    brake = stored.brake
    sequences: tuple[Iterable[Step], ...] = tee(steps(brake, respond), len(ASKED))
    found = []
    for (asked, tolerance), sequence in zip(ASKED.items(), sequences, strict=True):
        response = _answer(brake, tolerance, sequence)
        if response is not None:
            true = errors(brake, response.shoes, stored.true.shoes)
            found.append(Judged(name, asked, response.error or {}, true, stored.true.unsure))
    return found


def _answer(brake: Brake, tolerance: Tolerance, sequence: Iterable[Step]) -> Response | None:
    """The answer that a solve would give, or None where it would say that the tolerance is not
    reached.
    """
    try:
        return adapt(brake, tolerance, respond, must=tolerance != DEFAULT, along=sequence).response
    except NoAnswer:
        return None


def judge_folder(folder: Path) -> list[Judged]:
    """`judged` of all stored truths of a folder."""
    return [one for path in truth_files(folder) for one in judged(path.stem, read(path))]


def truth_files(folder: Path) -> list[Path]:
    """The files of the stored truths of a folder, by name."""
    return sorted(path for path in folder.glob("*.json") if path.name != FILE)


def sharpness(rows: Sequence[Judged]) -> dict[str, Spread]:
    """How much larger than the true errors the stated ones are, for each quantity."""
    found = {}
    for quantity in QUANTITIES:
        seen = [one.stated[quantity] / one.true[quantity] for one in rows if one.certain(quantity)]
        found[quantity] = Spread(float(np.median(seen)), float(np.quantile(seen, 0.1)))
    return found


def complaints(rows: Sequence[Judged], written: Mapping[str, Spread]) -> list[str]:
    """What is wrong with the stated errors of `rows`, one line for each fault; none where all is
    well.

    written: the spreads of the last calibration.
    """
    found = []
    for quantity, spread in sharpness(rows).items():
        ratios = [(one.ratio(quantity), one) for one in rows]
        known = [(value, one) for value, one in ratios if not math.isnan(value)]
        small = [f"{one.name} at {one.asked} ({value:.2f})" for value, one in known if value < 1]
        if len(small) > binom.ppf(SURE, len(known), PROMISED):
            found.append(
                f"{quantity}: {len(small)} of {len(known)} stated errors are too small: {', '.join(small)}"
            )
        for which, value, before in zip(Spread._fields, spread, written[quantity], strict=True):
            if abs(value / before - 1) > NEAR:
                found.append(
                    f"{quantity}: {which} of stated over true error {value:.2f}, was {before:.2f}"
                )
    return found


def scaled(rows: Iterable[Judged], quantity: str, factor: float) -> list[Judged]:
    """The rows with the stated errors of one quantity times a factor."""
    return [
        one._replace(stated={**one.stated, quantity: factor * one.stated[quantity]}) for one in rows
    ]


def read_sharpness(folder: Path) -> dict[str, Spread]:
    """The spreads that were written down in a folder of stored truths."""
    data: dict[str, dict[str, float]] = json.loads((folder / FILE).read_text(encoding="utf-8"))
    return {quantity: Spread(**values) for quantity, values in data.items()}


def main(folder: str) -> None:
    """Write the spreads of the stored truths of a folder into its FILE."""
    found = sharpness(judge_folder(Path(folder)))
    data: dict[str, Any] = {
        quantity: {which: round(value, 2) for which, value in spread._asdict().items()}
        for quantity, spread in found.items()
    }
    write_text(Path(folder) / FILE, json.dumps(data, indent=1) + "\n")
    sys.stdout.write(f"{json.dumps(data)}\n")


if __name__ == "__main__":
    main(*sys.argv[1:])
