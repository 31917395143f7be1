"""The error that a response states against the one that it has.

The truth comes from curved triangles, which share nothing with the finite elements that are judged
but the brake, or from columns that are finer by some two levels, with exact contact; how far its
own last steps moved it, and what its elimination has lost, is its uncertainty. All errors are
relative: of p in L2 outside EDGE_ZONE at the lining's ends, the worst shoe's; of the torque, that
of the whole brake; of the peak pressure away from the ends and of the hinge reaction, the worst
shoe's.
"""

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, Protocol

import numpy as np

from drumlin.arrays import Floats
from drumlin.brake.brake import Brake, Shoe
from drumlin.comparison import edge_of
from drumlin.errors import BadInput, NoAnswer
from drumlin.fem.hp.corner import NodalPressure
from drumlin.fem.hp.estimate import ROUND_OFF
from drumlin.fem.hp.levels import steps
from drumlin.fem.model import respond
from drumlin.response.response import (
    EDGE_ZONE,
    NO_CHANGE,
    Response,
    ShoeChange,
    ShoeResponse,
    edge_zone,
    reaction_size,
)
from drumlin.response.resultants import edge_left_out
from drumlin.verification import triangles

QUANTITIES = ("pressure", "torque", "peak", "reaction")
TOLERANCES = (1e-2, 1e-3, 1e-4)
GAUSS, WEIGHTS = np.polynomial.legendre.leggauss(8)
FINER = 0.1  # of a tolerance: the last step of p in a sequence of columns that is the truth for it
SAMPLES = 4001  # angles at which a peak is looked for, besides the nodes


class Pressed(NodalPressure, Protocol):
    """What a pressure is compared of."""

    def pressure_at(self, theta: Floats) -> Floats:
        """Pressure [Pa] at angles [rad]."""


class Solved(Pressed, Protocol):
    """A shoe that is taken as true."""

    @property
    def torque(self) -> float:
        """Torque [N m] on the drum."""

    @property
    def normal_force(self) -> float:
        """Resultant [N] of the normal pressure."""

    @property
    def hinge_reaction(self) -> Floats:
        """Force (2,) [N] of the pin."""


@dataclass(frozen=True)
class Truth:
    """The solution of each shoe on the finest division; `unsure`: relative uncertainties by
    QUANTITIES, from how far the last steps of the sequence went and what its elimination lost;
    `seconds` of processor time it took.
    """

    shoes: Sequence[Solved]
    unsure: Mapping[str, float]
    seconds: float


def by_triangles(brake: Brake) -> Truth:
    """The truth of a brake by triangles. Raises as `triangles.solve`."""
    begin = time.process_time()
    return of_last_three(brake, triangles.sequence(brake), begin)


def by_columns(brake: Brake, tolerance: float) -> Truth:
    """The truth of a brake by levels that go on until p moves by FINER of the tolerance or the
    levels end: the one to which p has moved least, as the finest may have lost more to round-off
    than they add.

    Raises NoAnswer where fewer than three have an answer.
    """
    begin = time.process_time()
    found: list[Sequence[ShoeResponse]] = []
    moved: list[float] = []
    try:
        for _, response in steps(brake, partial(respond, penalty=math.inf)):
            moved.append(
                errors(brake, found[-1], response.shoes)["pressure"] if found else math.inf
            )
            found.append(response.shoes)
            if len(found) > 2 and moved[-1] <= FINER * tolerance:
                break
    except NoAnswer:  # of the finest
        if len(found) < 3:
            raise
    if len(found) < 3:
        raise NoAnswer(f"only {len(found)} levels of columns have an answer")
    best = 2 + int(np.argmin(moved[2:]))
    return of_last_three(brake, found[best - 2 : best + 1], begin, round_off(found[best]))


def round_off(shoes: Sequence[ShoeResponse]) -> ShoeChange:
    """What the elimination may have lost at most of each quantity, over all shoes, relative."""
    return ShoeChange(
        *(ROUND_OFF * max(parts) for parts in zip(*(shoe.lost for shoe in shoes), strict=True))
    )


def of_last_three(
    brake: Brake, last: Sequence[Sequence[Solved]], begin: float, lost: ShoeChange = NO_CHANGE
) -> Truth:
    """The truth that the last three solutions of a sequence tell of.

    begin: processor time [s] at which the sequence was begun; lost: relative round-off of the
    finest solution, which counts as uncertainty besides the steps of the sequence.
    """
    early, late = errors(brake, last[0], last[1]), errors(brake, last[1], last[2])
    digits = lost._asdict() | {"peak": max(lost.pressure, lost.peak)}
    unsure = {name: limit(early[name], late[name]) + digits[name] for name in QUANTITIES}
    return Truth(last[2], unsure, time.process_time() - begin)


def limit(early: float, late: float) -> float:
    """What is left after two steps of a sequence that went so far: the last one over r - 1, where
    each step is r times shorter than the one before, r between 2 and 4.
    """
    return late / (min(max(early / late, 2.0), 4.0) - 1) if late else 0.0


def errors(brake: Brake, found: Sequence[Any], true: Sequence[Solved]) -> dict[str, float]:
    """Relative errors of the shoes `found` (ShoeResponse or ShoeSolution), by QUANTITIES."""
    trios = list(zip(brake.shoes, found, true, strict=True))
    torque = math.fsum(shoe.torque for shoe in true)
    off = math.fsum(a.torque - b.torque for _, a, b in trios)
    return {
        "pressure": max(pressure_error(a, b, edge_of(brake)) for _, a, b in trios),
        "torque": abs(off) / torque if torque else 0.0,
        "peak": max(_peak_error(shoe, brake.scale_factor, a, b) for shoe, a, b in trios),
        "reaction": max(
            math.dist(a.hinge_reaction, b.hinge_reaction)
            / reaction_size(b.hinge_reaction, b.normal_force)
            for _, a, b in trios
        ),
    }


def pressure_error(found: Pressed, true: Solved, edge: float = EDGE_ZONE) -> float:
    """L2 norm over theta of the error of p, relative to that of p, outside zones of `edge` at the
    lining's ends, unless half of the force is there.
    """
    zone = edge_left_out(true.theta, true.pressure, true.order, edge)
    first, last = true.theta[0] + zone, true.theta[-1] - zone
    knots = np.unique(np.concatenate([[first, last], found.theta, true.theta[:: true.order]]))
    knots = knots[(knots >= first) & (knots <= last)]
    half = 0.5 * np.diff(knots)[:, None]
    theta, weight = knots[:-1, None] + half * (1 + GAUSS), half * WEIGHTS
    p = true.pressure_at(theta)
    size = float(np.sum(weight * p**2))
    return (
        math.sqrt(float(np.sum(weight * (found.pressure_at(theta) - p) ** 2)) / size)
        if size
        else math.nan
    )


def peak(shoe: Shoe, scale_factor: float, found: Pressed) -> float:
    """Largest pressure [Pa] outside the `edge_zone` at the lining's ends, unless half of the force
    is there.
    """
    zone = edge_left_out(found.theta, found.pressure, found.order, edge_zone(shoe, scale_factor))
    start, end = shoe.lining.start + zone, shoe.lining.end - zone
    inside = found.theta[(found.theta > start) & (found.theta < end)]
    return float(
        found.pressure_at(np.concatenate([inside, np.linspace(start, end, SAMPLES)])).max()
    )


def _peak_error(shoe: Shoe, scale_factor: float, found: Any, true: Solved) -> float:
    """Relative error of the peak that a response states, or of a solution's own; nan where nothing
    presses.
    """
    most = peak(shoe, scale_factor, true)
    own = (
        float(found.peak_pressure)
        if hasattr(found, "peak_pressure")
        else peak(shoe, scale_factor, found)
    )
    return abs(own / most - 1) if most else math.nan


def row(
    brake: Brake,
    tolerance: float,
    solve: Callable[..., Response],
    true: Truth | None,
    failure: str = "",
) -> dict[str, Any]:
    """Stated and true errors of a brake solved to a tolerance: one row.

    Keys "stated_", "true_" and "unsure_" with QUANTITIES, nan where there is none; `outcome`:
    "reached", "not reached", "no truth" or "failed", with its `reason`. true: None where the truth
    itself failed, with `failure`.
    """
    begin = time.process_time()
    base: dict[str, Any] = {"tolerance": tolerance, "title": brake.title, "reason": failure}
    try:
        response = solve(brake, tolerance=tolerance)
    except NoAnswer as error:
        outcome = "not reached" if "not reached" in str(error) else "failed"
        return base | {
            "outcome": outcome,
            "reason": str(error),
            "seconds": time.process_time() - begin,
        }
    except (BadInput, ArithmeticError, ValueError, AssertionError) as error:
        reason = f"{type(error).__name__}: {error}"
        return base | {
            "outcome": "failed",
            "reason": reason,
            "seconds": time.process_time() - begin,
        }
    base["seconds"] = time.process_time() - begin
    stated = {
        f"stated_{name}": float((response.error or {}).get(name, math.nan)) for name in QUANTITIES
    }
    if true is None:
        return base | stated | {"outcome": "no truth"}
    off = errors(brake, response.shoes, true.shoes)
    return (
        base
        | stated
        | {"outcome": "reached"}
        | {f"true_{name}": off[name] for name in QUANTITIES}
        | {f"unsure_{name}": true.unsure[name] for name in QUANTITIES}
    )


def ratio(one: Mapping[str, Any], name: str) -> float:
    """Stated over true error; with what the truth is unsure of taken off the true one. nan where
    nothing is stated, inf where nothing is left to be seen.
    """
    stated, true, unsure = (
        float(one.get(f"{which}_{name}", math.nan)) for which in ("stated", "true", "unsure")
    )
    if math.isnan(stated + true + unsure):
        return math.nan
    seen = true - unsure
    return stated / seen if seen > 0 else math.inf


def summary(rows: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """For each tolerance and quantity: rows, part of them reached, part with the true error above
    the stated one, and above twice it, median of stated over true where the truth is known four
    times better than the error.

    `above` takes off the true error what the truth is unsure of, `above_whole` does not.
    """
    table = []
    for tolerance in sorted({one["tolerance"] for one in rows}, reverse=True):
        mine = [
            one for one in rows if one["tolerance"] == tolerance and one["outcome"] != "no truth"
        ]
        for name in QUANTITIES:
            ratios = np.array([ratio(one, name) for one in mine])
            judged = ~np.isnan(ratios)
            sure = [
                one[f"stated_{name}"] / one[f"true_{name}"]
                for one, known in zip(mine, judged, strict=True)
                if known and one[f"true_{name}"] > 4 * one[f"unsure_{name}"]
            ]
            n = max(1, int(judged.sum()))
            table.append(
                {
                    "tolerance": tolerance,
                    "quantity": name,
                    "brakes": len(mine),
                    "reached": sum(one["outcome"] == "reached" for one in mine) / max(1, len(mine)),
                    "judged": int(judged.sum()),
                    "above": float((ratios[judged] < 1).sum()) / n,
                    "above_whole": sum(
                        one[f"stated_{name}"] < one[f"true_{name}"]
                        for one, known in zip(mine, judged, strict=True)
                        if known
                    )
                    / n,
                    "above_twice": float((ratios[judged] < 0.5).sum()) / n,
                    "smallest": float(ratios[judged].min()) if judged.any() else math.nan,
                    "median": float(np.median(sure)) if sure else math.nan,
                    "missed": sum(
                        one.get(f"true_{name}", 0.0) - one.get(f"unsure_{name}", 0.0) > tolerance
                        for one in mine
                    )
                    / max(1, len(mine)),
                }
            )
    return table
