"""Whether the stated errors of brakes with stored truths are large enough and not needlessly large.

A stated error that is too small is a wrong number. A stated error that is ten times too large costs
a level of hp elements that nobody needed. The ratio of stated to true error shows both.
`judge_stored_truth` takes one brake through all levels once and reads from the levels which errors
a solve states by default and at two tolerances. `error_ratio_spreads` reduces the ratios of each
quantity to two numbers. The command

    python -m drumlin_studies.sharpness FOLDER

writes these numbers to a file whenever the factors of the estimate are fitted.
`lines_on_stated_errors` compares new numbers with the file, so that a test notices a halved factor
as well as a doubled one.
"""

import json
import math
import sys
from collections.abc import Container, Iterable, Mapping, Sequence
from itertools import tee
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.stats import binom

from drumlin.base.errors import NoAnswer
from drumlin.base.files import write_text
from drumlin.brake.brake import Brake
from drumlin.fem.error_control.adapt import DEFAULT_TOLERANCE, Tolerance, solve_to_tolerance
from drumlin.fem.error_control.levels import SolvedLevel, solved_levels
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.response.response import Response
from drumlin_studies.stated_true import JUDGED_QUANTITIES as QUANTITIES
from drumlin_studies.stated_true import stated_over_true, true_errors
from drumlin_studies.stored_truth import CERTAIN, StoredTruth, read_stored_truth

ASKED = {"default": DEFAULT_TOLERANCE, "1e-3": Tolerance(1e-3, 1e-3), "1e-4": Tolerance(1e-4, 1e-4)}
"""The tolerances that a solve is asked for: the default one and two others, by name."""

SMALLEST_TOLERANCE = "1e-4"
"""Name of the smallest tolerance of ASKED, at which a solve is dearest."""

PROMISED = 0.01
"""Largest share of stated errors that are smaller than the true ones, as README promises."""

SURE = 0.95
"""Probability with which a test passes while the promise is kept. If a share PROMISED of all stated
errors is too small, the number of too small ones among those judged stays within the allowed number
with this probability. Without such an allowance few judged errors would fail a test by chance."""

ALLOWED_DRIFT = 0.3
"""Largest relative difference between the median or the smallest tenth of the ratios and its value
in FILE. A change of the levels alone can move these numbers by half of ALLOWED_DRIFT. With twice
ALLOWED_DRIFT a test would overlook a factor of two."""

MORE = 0.1
"""Fraction by which the number of unknowns of all answers together may grow. The time of a solve
grows a little faster than its unknowns, and a user would just notice a tenth more time."""

MUCH_MORE = 1.4
"""Factor by which the number of unknowns of a single brake may grow. An end of the contact that
round-off moves costs one further pass on a level, in addition to four or more passes."""

QUICK = 100_000
"""Largest number of unknowns, of all divisions up to the answer at the smallest tolerance, of a
brake that is solved in at most half a second. The fast tests judge these brakes alone."""

FILE = "sharpness.json"
"""Name of the file with the numbers of the last fit, in the folder of the stored truths."""


SHARPNESS_KEY = "sharpness"
"""Key of FILE for the spreads of all brakes."""

QUICK_SHARPNESS_KEY = "sharpness of quick brakes"
"""Key of FILE for the spreads of the brakes that are quickly solved."""


class StatedTrueErrors(NamedTuple):
    """Stated and true errors of one brake at one tolerance of ASKED.

    Attributes
    ----------
    name : name of the brake
    asked : name of the tolerance
    stated : stated errors, by QUANTITIES
    true : true errors
    unsure : uncertainties of the true errors
    unknowns : number of unknowns, summed over all divisions that were solved up to the answer
    """

    name: str
    asked: str
    stated: Mapping[str, float]
    true: Mapping[str, float]
    unsure: Mapping[str, float]
    unknowns: int = 0

    def ratio(self, quantity: str) -> float:
        """The ratio of the stated error to the true error less its uncertainty.

        The ratio is inf if the uncertainty is as large as the true error, and nan if the quantity
        is not judged.
        """
        kinds = {"stated": self.stated, "true": self.true, "unsure": self.unsure}
        return stated_over_true(
            {f"{kind}_{quantity}": of[quantity] for kind, of in kinds.items()}, quantity
        )

    def certain(self, quantity: str) -> bool:
        """Whether the true error is certain enough for the ratio of stated to true error.

        A stated error of 1 means that the quantity is not known. It is no estimate of an error.
        """
        return self.true[quantity] > CERTAIN * self.unsure[quantity] and self.stated[quantity] < 1.0


class Spread(NamedTuple):
    """Median of the ratios of stated to true error, and the value below which a tenth lies."""

    median: float
    tenth: float


class AccuracyAndCost(NamedTuple):
    """Accuracy and cost of the answers of all brakes at one tolerance of ASKED.

    Attributes
    ----------
    answers : number of brakes that reach the tolerance
    pressure, torque : median true errors of p and of the torque
    unknowns : number of unknowns of all divisions that were solved, by the brake's name
    """

    answers: int
    pressure: float
    torque: float
    unknowns: dict[str, int]


def judge_stored_truth(name: str, stored: StoredTruth) -> list[StatedTrueErrors]:
    """Stated and true errors of a brake with a stored truth, for each tolerance that it reaches."""
    brake = stored.brake
    solved: list[int] = []

    def counted(scene: PreparedModel, brake: Brake, *, start: Response | None = None) -> Response:
        """The response of `solve_prepared_model`; its number of unknowns is added to `solved`."""
        solved.append(sum(body.unknowns for body in scene.bodies))
        return solve_prepared_model(scene, brake, start=start)

    sequences: tuple[Iterable[SolvedLevel], ...] = tee(solved_levels(brake, counted), len(ASKED))
    found = []
    for (asked, tolerance), sequence in zip(ASKED.items(), sequences, strict=True):
        response = _solve_to_tolerance(brake, tolerance, sequence)
        if response is not None:
            true = true_errors(brake, response.shoes, stored.true.shoes)
            stated = response.error or {}
            found.append(
                StatedTrueErrors(name, asked, stated, true, stored.true.unsure, sum(solved))
            )
    return found


def _solve_to_tolerance(
    brake: Brake, tolerance: Tolerance, sequence: Iterable[SolvedLevel]
) -> Response | None:
    """The answer that a solve would give, or None where the solve would miss the tolerance."""
    try:
        return solve_to_tolerance(
            brake,
            tolerance,
            solve_prepared_model,
            must=tolerance != DEFAULT_TOLERANCE,
            levels=sequence,
        ).response
    except NoAnswer:
        return None


def judge_folder(folder: Path, names: Container[str] | None = None) -> list[StatedTrueErrors]:
    """Stated and true errors of the brakes with stored truths in a folder.

    names : names of the brakes to be judged; all of the folder by default
    """
    found: list[StatedTrueErrors] = []
    for path in truth_files(folder):
        if names is None or path.stem in names:
            found += judge_stored_truth(path.stem, read_stored_truth(path))
    return found


def quickly_solved_brakes(worths: Mapping[str, AccuracyAndCost]) -> set[str]:
    """Names of the brakes that reach every tolerance of ASKED with at most QUICK unknowns."""
    unknowns = worths[SMALLEST_TOLERANCE].unknowns
    return {name for name, count in unknowns.items() if count <= QUICK}


def truth_files(folder: Path) -> list[Path]:
    """The files of the stored truths of a folder, in the order of their names."""
    return sorted(path for path in folder.glob("*.json") if path.name != FILE)


def error_ratio_spreads(rows: Sequence[StatedTrueErrors]) -> dict[str, Spread]:
    """Median and smallest tenth of the ratios of stated to true error, for each quantity."""
    found = {}
    for quantity in QUANTITIES:
        seen = [one.stated[quantity] / one.true[quantity] for one in rows if one.certain(quantity)]
        found[quantity] = Spread(float(np.median(seen)), float(np.quantile(seen, 0.1)))
    return found


def accuracy_and_costs(rows: Sequence[StatedTrueErrors]) -> dict[str, AccuracyAndCost]:
    """Accuracy and cost of the answers, for each tolerance of ASKED."""
    found = {}
    for asked, tolerance in ASKED.items():
        own = [one for one in rows if one.asked == asked]
        reached = [one for one in own if one.stated["pressure"] <= tolerance.pressure]
        pressure, torque = (
            float(np.median([one.true[name] for one in own])) for name in ("pressure", "torque")
        )
        unknowns = {one.name: one.unknowns for one in own}
        found[asked] = AccuracyAndCost(len(reached), pressure, torque, unknowns)
    return found


def lines_on_losses(
    rows: Sequence[StatedTrueErrors], written: Mapping[str, AccuracyAndCost]
) -> list[str]:
    """Lines that say what has become worse for a user since the last fit; empty if nothing has.

    written : accuracy and cost of the answers at the last fit, by ASKED
    """
    found = []
    for asked, now in accuracy_and_costs(rows).items():
        before = written[asked]
        if now.answers < before.answers:
            found.append(f"{asked}: {now.answers} brakes reach it, {before.answers} did")
        for quantity in ("pressure", "torque"):
            error, known = getattr(now, quantity), getattr(before, quantity)
            if error > (1 + ALLOWED_DRIFT) * known:
                found.append(f"{asked}: true error of {quantity} {error:.1e}, was {known:.1e}")
        both = now.unknowns.keys() & before.unknowns.keys()
        more, most = (sum(of.unknowns[name] for name in both) for of in (now, before))
        if more > (1 + MORE) * most:
            found.append(f"{asked}: {more} unknowns in all, were {most}")
        for name in sorted(both):
            if now.unknowns[name] > MUCH_MORE * before.unknowns[name]:
                was = before.unknowns[name]
                found.append(f"{asked}: {name} takes {now.unknowns[name]} unknowns, took {was}")
    return found


def lines_on_stated_errors(
    rows: Sequence[StatedTrueErrors], written: Mapping[str, Spread]
) -> list[str]:
    """Lines that say what is wrong with the stated errors of `rows`; empty if nothing is.

    written : median and smallest tenth of the ratios at the last fit, by quantity
    """
    found = []
    for quantity, spread in error_ratio_spreads(rows).items():
        ratios = [(one.ratio(quantity), one) for one in rows]
        known = [(value, one) for value, one in ratios if not math.isnan(value)]
        small = [f"{one.name} at {one.asked} ({value:.2f})" for value, one in known if value < 1]
        if len(small) > binom.ppf(SURE, len(known), PROMISED):
            found.append(
                f"{quantity}: {len(small)} of {len(known)} stated errors are too small: "
                f"{', '.join(small)}"
            )
        for which, value, before in zip(Spread._fields, spread, written[quantity], strict=True):
            if abs(value / before - 1) > ALLOWED_DRIFT:
                found.append(
                    f"{quantity}: {which} of stated over true error {value:.2f}, was {before:.2f}"
                )
    return found


def scale_stated_errors(
    rows: Iterable[StatedTrueErrors], quantity: str, factor: float
) -> list[StatedTrueErrors]:
    """The rows with the stated errors of one quantity multiplied by a factor."""
    return [
        one._replace(stated={**one.stated, quantity: factor * one.stated[quantity]}) for one in rows
    ]


class Written(NamedTuple):
    """The contents of FILE.

    Attributes
    ----------
    spreads : spreads of the ratios of stated to true error of all brakes, by quantity
    quick_spreads : spreads of the ratios of the brakes that are quickly solved, by quantity
    worths : accuracy and cost of the answers of all brakes, by tolerance of ASKED
    """

    spreads: dict[str, Spread]
    quick_spreads: dict[str, Spread]
    worths: dict[str, AccuracyAndCost]


def read_sharpness(folder: Path) -> Written:
    """The contents of FILE in a folder of stored truths."""
    data = json.loads((folder / FILE).read_text(encoding="utf-8"))
    spreads, quick_spreads = (
        {quantity: Spread(**values) for quantity, values in data[key].items()}
        for key in (SHARPNESS_KEY, QUICK_SHARPNESS_KEY)
    )
    worths = {asked: AccuracyAndCost(**values) for asked, values in data["worth"].items()}
    return Written(spreads, quick_spreads, worths)


def _rounded_spreads(rows: Sequence[StatedTrueErrors]) -> dict[str, dict[str, float]]:
    """The spreads of `error_ratio_spreads`, rounded as FILE holds them."""
    return {
        quantity: {which: round(value, 2) for which, value in spread._asdict().items()}
        for quantity, spread in error_ratio_spreads(rows).items()
    }


def main(folder: str) -> None:
    """Write the sharpness and the worth of the stored truths of a folder into its FILE."""
    rows = judge_folder(Path(folder))
    worths = accuracy_and_costs(rows)
    quick = quickly_solved_brakes(worths)
    spreads = _rounded_spreads(rows)
    quick_spreads = _rounded_spreads([one for one in rows if one.name in quick])
    worth = {
        asked: {
            "answers": of.answers,
            "pressure": float(f"{of.pressure:.3g}"),
            "torque": float(f"{of.torque:.3g}"),
            "unknowns": of.unknowns,
        }
        for asked, of in worths.items()
    }
    data = {SHARPNESS_KEY: spreads, QUICK_SHARPNESS_KEY: quick_spreads, "worth": worth}
    write_text(Path(folder) / FILE, json.dumps(data, indent=1) + "\n")
    sys.stdout.write(f"{json.dumps(spreads)}\n")


if __name__ == "__main__":
    main(*sys.argv[1:])
