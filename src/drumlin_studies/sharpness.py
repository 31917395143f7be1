"""Sharpness: whether the errors that drumlin states are large enough and not needlessly large.

The stated errors are compared with the true errors of brakes whose far finer solutions are stored
as files (`stored_truth`). A stated error that is too small is a wrong number. A stated error that
is ten times too large makes drumlin solve on a finer level than needed. The ratio of stated to true
error shows both. `stated_and_true_errors_of_stored_brake` solves one brake on all levels of
refinement once, and finds the errors that a solve states by default and at two tolerances.
`spreads_of_stated_over_true_errors` reduces the ratios of each quantity to two numbers. The command

    python -m drumlin_studies.sharpness FOLDER

writes these numbers to a file whenever the factors of the estimate are fitted.
`describe_faults_of_stated_errors` compares new numbers with the file, so that a test notices a
halved factor as well as a doubled one.
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
from drumlin.fem.error_control.adapt import (
    DEFAULT_TOLERANCES_OF_PRESSURE_AND_TORQUE,
    TolerancesOfPressureAndTorque,
    solve_brake_to_tolerance,
)
from drumlin.fem.error_control.levels import SolvedLevel, solve_brake_on_finer_and_finer_mesh_levels
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.response.response import Response
from drumlin_studies.stated_true import (
    QUANTITIES_WHOSE_STATED_ERRORS_ARE_JUDGED as QUANTITIES_WITH_STATED_ERROR,
)
from drumlin_studies.stated_true import stated_over_true_error_of_row, true_errors_of_response
from drumlin_studies.stored_truth import (
    LEAST_USABLE_TRUE_ERROR_OVER_ITS_UNCERTAINTY,
    StoredTruth,
    read_stored_fine_solution,
)

TOLERANCES_OF_SOLVES_BY_NAME = {
    "default": DEFAULT_TOLERANCES_OF_PRESSURE_AND_TORQUE,
    "1e-3": TolerancesOfPressureAndTorque(1e-3, 1e-3),
    "1e-4": TolerancesOfPressureAndTorque(1e-4, 1e-4),
}
"""The tolerances to which the brakes are solved, by name: the default and two smaller tolerances.
"""

NAME_OF_SMALLEST_TOLERANCE_OF_SOLVES = "1e-4"
"""Name of the smallest tolerance of TOLERANCES_OF_SOLVES_BY_NAME, at which a solve takes
longest.
"""

PROMISED_FRACTION_OF_TOO_SMALL_ERRORS = 0.01
"""Largest fraction of stated errors that may be below the true errors, as README promises."""

PASS_PROBABILITY_AT_PROMISED_FRACTION = 0.95
"""Probability with which a program with just the promised fraction of too small errors passes.

The promised fraction of too small errors is PROMISED_FRACTION_OF_TOO_SMALL_ERRORS.

This probability gives the number of judged errors that may be too small. A smaller number would
make a test on few errors fail by chance, although the promise is kept.
"""

ALLOWED_RELATIVE_CHANGE_OF_SPREAD = 0.3
"""Largest relative change of a number in `StatedOverTrueSpread` since the last fit.

The values of the last fit are in the file SPREADS_AND_COSTS_FILE_NAME.

A change of the refinement levels alone can change these numbers by half of this limit. With twice
this limit a test would overlook a change of all stated errors by a factor of two. The limit also
holds for the growth of the median true errors.
"""

ALLOWED_GROWTH_OF_ALL_UNKNOWNS = 0.1
"""Fraction by which the number of unknowns of all answers together may grow since the last fit. The
time of a solve grows a little faster than the number of unknowns. A user would just notice a solve
that takes a tenth more time.
"""

ALLOWED_GROWTH_FACTOR_OF_BRAKE_UNKNOWNS = 1.4
"""Factor by which the number of unknowns of a single brake may grow since the last fit. A brake
needs solves on four or more refinement levels. A change in round-off can cost a solve on one more
level.
"""

MOST_UNKNOWNS_OF_QUICK_BRAKE = 100_000
"""Largest number of unknowns of a brake that counts as quickly solved: in at most half a second.

The number is the sum over all meshes up to the answer at the smallest tolerance. The fast tests
judge only the brakes within this limit.
"""

SPREADS_AND_COSTS_FILE_NAME = "sharpness.json"
"""Name of the file with all spreads and costs at the last fit of the error estimate.

The file is in the folder of the stored truths.
"""


FILE_KEY_OF_SPREADS_OF_ALL_BRAKES = "sharpness"
"""Key of SPREADS_AND_COSTS_FILE_NAME for the spreads of all brakes."""

FILE_KEY_OF_SPREADS_OF_QUICK_BRAKES = "sharpness of quick brakes"
"""Key of SPREADS_AND_COSTS_FILE_NAME for the spreads of the brakes that are quickly solved."""


class StatedTrueErrors(NamedTuple):
    """Stated and true errors of one brake at one tolerance of TOLERANCES_OF_SOLVES_BY_NAME.

    Attributes
    ----------
    name : name of the brake
    asked : name of the tolerance
    stated : relative errors that the solve states, by QUANTITIES_WITH_STATED_ERROR
    true : relative errors against the stored far finer solution, by QUANTITIES_WITH_STATED_ERROR
    unsure : uncertainties of the true errors, by QUANTITIES_WITH_STATED_ERROR
    unknowns : number of unknowns, summed over all meshes that were solved up to the answer
    """

    name: str
    asked: str
    stated: Mapping[str, float]
    true: Mapping[str, float]
    unsure: Mapping[str, float]
    unknowns: int = 0

    def stated_over_true_error(self, quantity: str) -> float:
        """The ratio of the stated error to the true error minus its uncertainty.

        The ratio is inf if the uncertainty is at least as large as the true error, and nan if one
        of the errors is not known.
        """
        kinds = {"stated": self.stated, "true": self.true, "unsure": self.unsure}
        return stated_over_true_error_of_row(
            {f"{kind}_{quantity}": of[quantity] for kind, of in kinds.items()}, quantity
        )

    def is_true_error_certain(self, quantity: str) -> bool:
        """Whether the true error of a quantity is known well enough to judge its stated error.

        A stated error of 1 means that drumlin does not know the quantity. Such an error is not
        judged, and the result is False.
        """
        return (
            self.true[quantity]
            > LEAST_USABLE_TRUE_ERROR_OVER_ITS_UNCERTAINTY * self.unsure[quantity]
            and self.stated[quantity] < 1.0
        )


class StatedOverTrueSpread(NamedTuple):
    """Two numbers on the ratios of stated to true error of a quantity.

    Attributes
    ----------
    median : median of the ratios
    tenth : ratio below which a tenth of all ratios lies
    """

    median: float
    tenth: float


class MedianErrorsAndUnknownsOfAllBrakes(NamedTuple):
    """Accuracy and cost of the answers of all brakes at one tolerance.

    Attributes
    ----------
    answers : number of brakes whose stated error of the pressure is within the tolerance
    pressure, torque : median true errors of the pressure and of the torque
    unknowns : number of unknowns of all meshes that were solved, by the brake's name
    """

    answers: int
    pressure: float
    torque: float
    unknowns: dict[str, int]


def stated_and_true_errors_of_stored_brake(
    name: str, stored: StoredTruth
) -> list[StatedTrueErrors]:
    """Stated and true errors of a brake, for each tolerance that it reaches.

    Each level of refinement is solved once and used for all tolerances.

    name : name of the brake; stored : the brake with its far finer solution, the truth.
    """
    brake = stored.brake
    solved: list[int] = []

    def solve_and_count_unknowns(
        scene: PreparedModel, brake: Brake, *, start: Response | None = None
    ) -> Response:
        """Solve a prepared model; appends the number of its unknowns to `solved`."""
        solved.append(sum(body.unknowns for body in scene.bodies))
        return solve_prepared_model(scene, brake, start=start)

    # All tolerances read the same sequence of solved levels. So each level is solved once.
    sequences: tuple[Iterable[SolvedLevel], ...] = tee(
        solve_brake_on_finer_and_finer_mesh_levels(brake, solve_and_count_unknowns),
        len(TOLERANCES_OF_SOLVES_BY_NAME),
    )
    found = []
    for (asked, tolerance), sequence in zip(
        TOLERANCES_OF_SOLVES_BY_NAME.items(), sequences, strict=True
    ):
        response = _response_within_tolerance_or_none(brake, tolerance, sequence)
        if response is not None:
            true = true_errors_of_response(brake, response.shoes, stored.true.shoes)
            stated = response.error or {}
            found.append(
                StatedTrueErrors(name, asked, stated, true, stored.true.unsure, sum(solved))
            )
    return found


def _response_within_tolerance_or_none(
    brake: Brake, tolerance: TolerancesOfPressureAndTorque, sequence: Iterable[SolvedLevel]
) -> Response | None:
    """The response of a brake to a tolerance, or None where no level reaches the tolerance.

    sequence : the solved levels of refinement, from coarse to fine.
    """
    try:
        return solve_brake_to_tolerance(
            brake,
            tolerance,
            solve_prepared_model,
            must=tolerance != DEFAULT_TOLERANCES_OF_PRESSURE_AND_TORQUE,
            levels=sequence,
        ).response
    except NoAnswer:
        return None


def stated_and_true_errors_of_folder(
    folder: Path, names: Container[str] | None = None
) -> list[StatedTrueErrors]:
    """Stated and true errors of the brakes whose far finer solutions are files of a folder.

    names : names of the brakes to be judged; all of the folder by default
    """
    found: list[StatedTrueErrors] = []
    for path in list_files_of_stored_fine_solutions(folder):
        if names is None or path.stem in names:
            found += stated_and_true_errors_of_stored_brake(
                path.stem, read_stored_fine_solution(path)
            )
    return found


def names_of_quickly_solved_brakes(
    worths: Mapping[str, MedianErrorsAndUnknownsOfAllBrakes],
) -> set[str]:
    """Names of the brakes that reach the smallest tolerance with few unknowns.

    Few unknowns are at most MOST_UNKNOWNS_OF_QUICK_BRAKE.

    `worths` are accuracy and cost of the answers of all brakes, by tolerance of
    TOLERANCES_OF_SOLVES_BY_NAME.
    """
    unknowns = worths[NAME_OF_SMALLEST_TOLERANCE_OF_SOLVES].unknowns
    return {name for name, count in unknowns.items() if count <= MOST_UNKNOWNS_OF_QUICK_BRAKE}


def list_files_of_stored_fine_solutions(folder: Path) -> list[Path]:
    """The files of far finer solutions in a folder, in the order of their names."""
    return sorted(
        path for path in folder.glob("*.json") if path.name != SPREADS_AND_COSTS_FILE_NAME
    )


def spreads_of_stated_over_true_errors(
    rows: Sequence[StatedTrueErrors],
) -> dict[str, StatedOverTrueSpread]:
    """The spread of the ratios of stated to true error over all brakes, for each quantity.

    Only ratios with a certain true error count.
    """
    found = {}
    for quantity in QUANTITIES_WITH_STATED_ERROR:
        seen = [
            one.stated[quantity] / one.true[quantity]
            for one in rows
            if one.is_true_error_certain(quantity)
        ]
        found[quantity] = StatedOverTrueSpread(
            float(np.median(seen)), float(np.quantile(seen, 0.1))
        )
    return found


def median_errors_and_unknowns_by_tolerance(
    rows: Sequence[StatedTrueErrors],
) -> dict[str, MedianErrorsAndUnknownsOfAllBrakes]:
    """Accuracy and cost of the answers of all brakes, for each tolerance of the solves."""
    found = {}
    for asked, tolerance in TOLERANCES_OF_SOLVES_BY_NAME.items():
        own = [one for one in rows if one.asked == asked]
        reached = [one for one in own if one.stated["pressure"] <= tolerance.pressure]
        pressure = float(np.median([one.true["pressure"] for one in own]))
        torque = float(np.median([one.true["torque"] for one in own]))
        unknowns = {one.name: one.unknowns for one in own}
        found[asked] = MedianErrorsAndUnknownsOfAllBrakes(len(reached), pressure, torque, unknowns)
    return found


def describe_growth_of_median_errors_and_unknowns(
    rows: Sequence[StatedTrueErrors], written: Mapping[str, MedianErrorsAndUnknownsOfAllBrakes]
) -> list[str]:
    """Lines of text, one for each accuracy or cost that has become worse.

    Each value is compared with its value at the last fit of the error estimate's factors.

    written : accuracy and cost of the answers at the last fit, by the keys of
        TOLERANCES_OF_SOLVES_BY_NAME
    """
    found = []
    for asked, now in median_errors_and_unknowns_by_tolerance(rows).items():
        # Two ways to become worse: fewer brakes reach the tolerance, or the median true errors are
        # larger.
        before = written[asked]
        if now.answers < before.answers:
            found.append(f"{asked}: {now.answers} brakes reach it, {before.answers} did")
        for quantity in ("pressure", "torque"):
            error, known = getattr(now, quantity), getattr(before, quantity)
            if error > (1 + ALLOWED_RELATIVE_CHANGE_OF_SPREAD) * known:
                found.append(f"{asked}: true error of {quantity} {error:.1e}, was {known:.1e}")
        # A third way to become worse: more unknowns, of all brakes together or of a single brake.
        both = now.unknowns.keys() & before.unknowns.keys()
        more = sum(now.unknowns[name] for name in both)
        most = sum(before.unknowns[name] for name in both)
        if more > (1 + ALLOWED_GROWTH_OF_ALL_UNKNOWNS) * most:
            found.append(f"{asked}: {more} unknowns in all, were {most}")
        for name in sorted(both):
            if now.unknowns[name] > ALLOWED_GROWTH_FACTOR_OF_BRAKE_UNKNOWNS * before.unknowns[name]:
                was = before.unknowns[name]
                found.append(f"{asked}: {name} takes {now.unknowns[name]} unknowns, took {was}")
    return found


def describe_faults_of_stated_errors(
    rows: Sequence[StatedTrueErrors], written: Mapping[str, StatedOverTrueSpread]
) -> list[str]:
    """Lines of text, one for each fault of the stated errors.

    A fault is a quantity with too many stated errors below true errors, or a number of
    `StatedOverTrueSpread` that differs from the last fit by more than
    ALLOWED_RELATIVE_CHANGE_OF_SPREAD.

    rows : stated and true errors of all brakes; written : `StatedOverTrueSpread` at the last fit,
        by quantity
    """
    found = []
    for quantity, spread in spreads_of_stated_over_true_errors(rows).items():
        ratios = [(one.stated_over_true_error(quantity), one) for one in rows]
        known = [(value, one) for value, one in ratios if not math.isnan(value)]
        small = [f"{one.name} at {one.asked} ({value:.2f})" for value, one in known if value < 1]
        # The number of too small errors that is allowed is a quantile of the binomial distribution.
        if len(small) > binom.ppf(
            PASS_PROBABILITY_AT_PROMISED_FRACTION, len(known), PROMISED_FRACTION_OF_TOO_SMALL_ERRORS
        ):
            found.append(
                f"{quantity}: {len(small)} of {len(known)} stated errors are too small: "
                f"{', '.join(small)}"
            )
        # The median of the ratios, and the ratio below which a tenth lies, must stay near their
        # values at the last fit.
        for which, value, before in zip(
            StatedOverTrueSpread._fields, spread, written[quantity], strict=True
        ):
            if abs(value / before - 1) > ALLOWED_RELATIVE_CHANGE_OF_SPREAD:
                found.append(
                    f"{quantity}: {which} of stated over true error {value:.2f}, was {before:.2f}"
                )
    return found


def rows_with_scaled_stated_errors(
    rows: Iterable[StatedTrueErrors], quantity: str, factor: float
) -> list[StatedTrueErrors]:
    """The rows with the stated errors of one quantity multiplied by a factor."""
    return [
        one._replace(stated={**one.stated, quantity: factor * one.stated[quantity]}) for one in rows
    ]


class StoredErrorRatioSpreadsAndCosts(NamedTuple):
    """The contents of SPREADS_AND_COSTS_FILE_NAME.

    Attributes
    ----------
    spreads : spreads of the ratios of stated to true error of all brakes, by quantity
    quick_spreads : spreads of the ratios of the brakes that are quickly solved, by quantity
    worths : accuracy and cost of the answers of all brakes, by tolerance of
        TOLERANCES_OF_SOLVES_BY_NAME
    """

    spreads: dict[str, StatedOverTrueSpread]
    quick_spreads: dict[str, StatedOverTrueSpread]
    worths: dict[str, MedianErrorsAndUnknownsOfAllBrakes]


def read_stored_spreads_of_stated_errors(folder: Path) -> StoredErrorRatioSpreadsAndCosts:
    """The spreads and costs at the last fit, from the file in a folder of far finer solutions."""
    data = json.loads((folder / SPREADS_AND_COSTS_FILE_NAME).read_text(encoding="utf-8"))
    spreads = {
        of: StatedOverTrueSpread(**values)
        for of, values in data[FILE_KEY_OF_SPREADS_OF_ALL_BRAKES].items()
    }
    quick_spreads = {
        of: StatedOverTrueSpread(**values)
        for of, values in data[FILE_KEY_OF_SPREADS_OF_QUICK_BRAKES].items()
    }
    worths = {
        asked: MedianErrorsAndUnknownsOfAllBrakes(**values)
        for asked, values in data["worth"].items()
    }
    return StoredErrorRatioSpreadsAndCosts(spreads, quick_spreads, worths)


def _rounded_spreads_of_stated_over_true_errors(
    rows: Sequence[StatedTrueErrors],
) -> dict[str, dict[str, float]]:
    """The spread of the ratios of stated to true error, rounded to two decimals for the file.

    The first key is the quantity, such as "pressure". The inner keys are the names of the numbers
    in `StatedOverTrueSpread`.
    """
    rounded = {}
    for quantity, spread in spreads_of_stated_over_true_errors(rows).items():
        rounded[quantity] = {name: round(value, 2) for name, value in spread._asdict().items()}
    return rounded


def main(folder: str) -> None:
    """Judge the stated errors of the brakes in a folder, and write SPREADS_AND_COSTS_FILE_NAME."""
    rows = stated_and_true_errors_of_folder(Path(folder))
    worths = median_errors_and_unknowns_by_tolerance(rows)
    quick = names_of_quickly_solved_brakes(worths)
    spreads = _rounded_spreads_of_stated_over_true_errors(rows)
    quick_spreads = _rounded_spreads_of_stated_over_true_errors(
        [one for one in rows if one.name in quick]
    )
    worth = {
        asked: {
            "answers": of.answers,
            "pressure": float(f"{of.pressure:.3g}"),
            "torque": float(f"{of.torque:.3g}"),
            "unknowns": of.unknowns,
        }
        for asked, of in worths.items()
    }
    data = {
        FILE_KEY_OF_SPREADS_OF_ALL_BRAKES: spreads,
        FILE_KEY_OF_SPREADS_OF_QUICK_BRAKES: quick_spreads,
        "worth": worth,
    }
    write_text(Path(folder) / SPREADS_AND_COSTS_FILE_NAME, json.dumps(data, indent=1) + "\n")
    sys.stdout.write(f"{json.dumps(spreads)}\n")


if __name__ == "__main__":
    main(*sys.argv[1:])
