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
from typing import NamedTuple

import numpy as np
from scipy.stats import binom

from drumlin.base.errors import NoAnswer
from drumlin.base.files import write_text
from drumlin.brake.brake import Brake
from drumlin.fem.error_control.adapt import DEFAULT, Tolerance, adapt
from drumlin.fem.error_control.levels import Step, steps
from drumlin.fem.model import respond
from drumlin.fem.preparation.scene import Scene
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

MORE = 0.1
"""Part by which the unknowns of all answers together may grow: the time of a solve grows a little
faster than they do, and a tenth of it is what a user would just see."""

MUCH_MORE = 1.4
"""How many times as many unknowns one brake may take as it did. An end of the contact that
round-off moves costs one more pass on a level, of four and more."""

FILE = "sharpness.json"


class Judged(NamedTuple):
    """Stated and true errors of one brake at one of ASKED, by QUANTITIES.

    `unsure`: uncertainties of the true errors; `unknowns`: number of unknowns, summed over all
    divisions that were solved up to the answer.
    """

    name: str
    asked: str
    stated: Mapping[str, float]
    true: Mapping[str, float]
    unsure: Mapping[str, float]
    unknowns: int = 0

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


class Worth(NamedTuple):
    """What a user gets and pays at one of ASKED, over all brakes.

    Attributes
    ----------
    answers : number of brakes that reach what is asked for
    pressure, torque : median true errors of p and of the torque
    unknowns : number of unknowns of all divisions that were solved, by the brake's name
    """

    answers: int
    pressure: float
    torque: float
    unknowns: dict[str, int]


def judged(name: str, stored: StoredTruth) -> list[Judged]:
    """Stated and true errors of the brake of a stored truth, one for each of ASKED that has an
    answer.
    """
    brake = stored.brake
    solved: list[int] = []

    def counted(scene: Scene, brake: Brake, *, start: Response | None = None) -> Response:
        """The response, counted among those that were solved."""
        solved.append(sum(body.unknowns for body in scene.bodies))
        return respond(scene, brake, start=start)

    sequences: tuple[Iterable[Step], ...] = tee(steps(brake, counted), len(ASKED))
    found = []
    for (asked, tolerance), sequence in zip(ASKED.items(), sequences, strict=True):
        response = _answer(brake, tolerance, sequence)
        if response is not None:
            true = errors(brake, response.shoes, stored.true.shoes)
            stated = response.error or {}
            found.append(Judged(name, asked, stated, true, stored.true.unsure, sum(solved)))
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


def worths(rows: Sequence[Judged]) -> dict[str, Worth]:
    """What a user gets and pays, for each of ASKED."""
    found = {}
    for asked, tolerance in ASKED.items():
        own = [one for one in rows if one.asked == asked]
        reached = [one for one in own if one.stated["pressure"] <= tolerance.pressure]
        pressure, torque = (
            float(np.median([one.true[name] for one in own])) for name in ("pressure", "torque")
        )
        unknowns = {one.name: one.unknowns for one in own}
        found[asked] = Worth(len(reached), pressure, torque, unknowns)
    return found


def losses(rows: Sequence[Judged], written: Mapping[str, Worth]) -> list[str]:
    """What has become worse for a user, one line for each loss; none where nothing has.

    written: what was written down when the factors were last fitted.
    """
    found = []
    for asked, now in worths(rows).items():
        before = written[asked]
        if now.answers < before.answers:
            found.append(f"{asked}: {now.answers} brakes reach it, {before.answers} did")
        for quantity in ("pressure", "torque"):
            error, known = getattr(now, quantity), getattr(before, quantity)
            if error > (1 + NEAR) * known:
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


class Written(NamedTuple):
    """What FILE holds: spreads by quantity, and by each of ASKED what a user gets and pays."""

    spreads: dict[str, Spread]
    worths: dict[str, Worth]


def read_sharpness(folder: Path) -> Written:
    """What was written down in a folder of stored truths."""
    data = json.loads((folder / FILE).read_text(encoding="utf-8"))
    spreads = {quantity: Spread(**values) for quantity, values in data["sharpness"].items()}
    return Written(spreads, {asked: Worth(**values) for asked, values in data["worth"].items()})


def main(folder: str) -> None:
    """Write the sharpness and the worth of the stored truths of a folder into its FILE."""
    rows = judge_folder(Path(folder))
    spreads = {
        quantity: {which: round(value, 2) for which, value in spread._asdict().items()}
        for quantity, spread in sharpness(rows).items()
    }
    worth = {
        asked: {
            "answers": of.answers,
            "pressure": float(f"{of.pressure:.3g}"),
            "torque": float(f"{of.torque:.3g}"),
            "unknowns": of.unknowns,
        }
        for asked, of in worths(rows).items()
    }
    data = {"sharpness": spreads, "worth": worth}
    write_text(Path(folder) / FILE, json.dumps(data, indent=1) + "\n")
    sys.stdout.write(f"{json.dumps(spreads)}\n")


if __name__ == "__main__":
    main(*sys.argv[1:])
