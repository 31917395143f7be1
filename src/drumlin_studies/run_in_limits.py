"""Whether brakes that run in end at the law of their rigid shoes, and whether the wear on the way
can be trusted.

Rows of tables: a brake run in from new (`brake_row`, `ratio_row`), half the step (`half_row`),
exponents of the pressure (`exponent_row`), a drum that turns both ways (`reversed_run`), and
implicit against explicit steps (`step_rows`). Distances are in units of 1/(k K), K = E/t of the
lining, k the wear coefficient.
"""

import math
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np

from drumlin import foundation
from drumlin.base.arrays import Floats
from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake
from drumlin.brake.file import vary
from drumlin.fem.analysis.fields import Fields, fields
from drumlin.fem.model import respond
from drumlin.fem.preparation.prepare import prepare
from drumlin.fem.preparation.scene import PreparedModel, why_not
from drumlin.laws import hinged, law
from drumlin.lining_wear.archard import TOLERANCE, WearLaw, WearState, at, explicit, ripple, run_on
from drumlin.lining_wear.linings import WearSetup, fem_setup, foundation_setup, guided
from drumlin.lining_wear.run_in import (
    COEFFICIENT,
    WearTarget,
    checks,
    distance,
    life,
    norm,
    run_in,
    target,
    unit_distance,
    worn,
)
from drumlin.response.norms import relative

ARCHARD = WearLaw(COEFFICIENT)
SPENT_WITHIN = 0.01  # of the law: what "away from the law" means in the tables
AT_LAW = "at the law"
PRESSURE, TORQUE = 0.01, 0.001  # what must hold after run-in


@dataclass(frozen=True)
class Run:
    """A brake run in: its setup, its states, where it tends to, and 1/(k K) [m]."""

    name: str
    setup: WearSetup
    states: list[WearState]
    goal: WearTarget
    unit: float

    def distances(self) -> list[float]:
        """The sliding distances of the states [1/(k K)]."""
        return [state.s / self.unit for state in self.states]

    def ripple(self, state: WearState) -> float:
        """The worst lining's checkerboard."""
        return max(ripple(surface.along(state.pressure)) for surface in self.setup.surfaces)


def settle(name: str, setup: WearSetup, law: WearLaw = ARCHARD, **options: Any) -> Run:
    """Run in a setup until it is settled."""
    states = run_in(setup, law, **options)
    return Run(
        name, setup, states, target(setup, law, options.get("torque")), unit_distance(setup, law)
    )


def ways(brake: Brake) -> tuple[list[tuple[str, str, Brake]], str | None]:
    """How a brake can be run in: words that follow its name, model, brake; and why finite elements
    cannot.

    One shoe alone also with the drum turned back: of two, one is what the other is when the drum
    turns back. Rigid external shoes also on a guide.
    """
    found, reason = list[tuple[str, str, Brake]](), why_not(brake)
    if reason is None:
        found.append(("", "fem", brake))
        if len(brake.shoes) == 1:
            found.append((", turned back", "fem", turned_back(brake)))
        rigid = all(shoe.body is None and shoe.pivot is None for shoe in brake.shoes)
        if rigid and brake.shoes[0].side == "external":
            found.append((", guided", "guided", brake))
    if foundation.why_not(brake) is None:
        found += [("", model, brake) for model in ("foundation", "foundation, lifted")]
    return found, reason


def turned_back(brake: Brake) -> Brake:
    """The brake with the drum turning the other way."""
    return vary(brake, {"rotation": "clockwise" if brake.spin > 0 else "counter-clockwise"})


def setup_of(model: str, brake: Brake, elements: int) -> WearSetup:
    """The setup of a brake by one of the models of `ways`."""
    if model.startswith("foundation"):
        return foundation_setup(brake, lift=("all",) if "lifted" in model else ())
    own = guided(brake) if model == "guided" else brake
    return fem_setup(prepare(own, elements=elements), own)


def law_of(model: str, brake: Brake) -> tuple[str, float]:
    """What the pressure of a model tends to, and the torque [N m] of the brake's law."""
    if model == "guided":
        return "cos", hinged.guided_torque(brake)
    if model == "fem" and brake.unhinged():
        return "A cos + B sin", law(brake).torque
    # As published, the foundation's sections turn without tilt.
    return "x cos" if model == "foundation" else "sin", hinged.sine(brake).torque


def brake_row(
    name: str, model: str, brake: Brake, elements: int
) -> tuple[dict[str, Any], Run | None]:
    """How a brake runs in, as a row; a failure stays as a row."""
    row: dict[str, Any] = {"brake": name, "model": model}
    begin = time.perf_counter()
    try:
        setup = setup_of(model, brake, elements)
        one = settle(f"{name}, {model}", setup)
        row["law"], torque = law_of(model, brake)
    except NoAnswer as error:
        return {**row, "status": f"failed: {error}"}, None
    row |= {
        "target": relative(one.goal.torque, torque),
        **run_row(one),
        "seconds": time.perf_counter() - begin,
    }
    if row["status"] == AT_LAW and abs(row["target"]) > TORQUE:
        row["status"] = "at its own limit, which is not the law"
    return row, one


def run_row(one: Run) -> dict[str, Any]:
    """What a run says of a brake: new, worn in, how long it took, its balances."""
    setup, states, goal, unit = one.setup, one.states, one.goal, one.unit
    new, end = distance(setup, states[0], goal), distance(setup, states[-1], goal)
    spent = life(setup, states, goal, ARCHARD, within=SPENT_WITHIN)
    close = life(setup, states, goal, ARCHARD, within=TORQUE)
    balance = checks(setup, states, ARCHARD)
    holds = end.pressure <= PRESSURE and abs(end.torque) <= TORQUE
    return {
        "new_pressure": new.pressure,
        "new_torque": new.torque,
        "least_torque": min(distance(setup, state, goal).torque for state in states),
        "pressure_distance": spent.pressure * spent.distance / unit,
        "torque_distance": spent.torque * spent.distance / unit,
        "close_distance": close.torque * close.distance / unit,
        "life": spent.distance / unit,
        "pressure_life": spent.pressure,
        "torque_life": spent.torque,
        "end_pressure": end.pressure,
        "end_torque": end.torque,
        "volume": balance.volume,
        "energy": balance.energy,
        "ripple": one.ripple(states[-1]),
        "steps": len(states) - 1,
        "status": AT_LAW if holds else "short of the law",
    }


def ratio_row(brake: Brake, ratio: float, elements: int) -> dict[str, Any]:
    """How a brake with elastic shoes runs in, its linings of `ratio` times the shoe's modulus."""
    body = brake.shoes[0].body
    assert body is not None and body.material is not None  # elastic shoes, whose modulus is known
    changed = vary(brake, {"shoe.lining.material.E": ratio * body.material.E_along})
    return {
        "ratio": ratio,
        **run_row(settle("", fem_setup(prepare(changed, elements=elements), changed))),
    }


def half_row(one: Run) -> dict[str, Any]:
    """A run against the same with every step halved, and ten times as far."""
    s = [state.s for state in one.states]
    middles = [(a + b) / 2 for a, b in pairwise(s)]
    halved = run_on(one.setup.interfaces, ARCHARD, sorted([*s[1:], *middles]))[::2]
    area = np.concatenate([interface.area for interface in one.setup.interfaces])

    def size(p: Floats) -> float:
        return math.sqrt(float(area @ p**2))

    pairs = list(zip(one.states, halved, strict=True))
    long = run_in(one.setup, ARCHARD, distance=10 * s[-1])
    after = distance(one.setup, long[-1], one.goal)
    return {
        "brake": one.name,
        "asked": TOLERANCE,
        "pressure": max(size(a.pressure - b.pressure) / size(b.pressure) for a, b in pairs),
        "torque": max(abs(relative(a.torque, b.torque)) for a, b in pairs),
        "depth": max(float(np.abs(a.depth - b.depth).max() / b.depth.max()) for a, b in pairs[1:]),
        "long_pressure": after.pressure,
        "long_torque": after.torque,
    }


def exponent_row(setup: WearSetup, m: float) -> dict[str, Any]:
    """A hinged brake under another exponent of the pressure: the law is then sin^(1/m)."""
    law = WearLaw(COEFFICIENT, m)
    states, goal = run_in(setup, law), target(setup, law)
    end = distance(setup, states[-1], goal)
    return {
        "exponent": m,
        "goal": goal.torque,
        "sine": relative(goal.torque, hinged.sine(setup.brake).torque),
        "end_pressure": end.pressure,
        "end_torque": end.torque,
        "volume": checks(setup, states, law).volume,
        "steps": len(states) - 1,
    }


@dataclass(frozen=True)
class Reversals:
    """A run under reversals every so often [1/(k K)]: its states, and how `far` p is in each from
    the law of its sense.

    `mean`: how far the wear of the last two reversals, one each way, is from that by the mean of
    both laws.
    """

    every: float
    states: list[WearState]
    far: list[float]
    mean: float

    @property
    def row(self) -> dict[str, float]:
        """What becomes of p in the second half of the run: right `after` a reversal, and at its
        best `before` one.
        """
        later = self.far[len(self.far) // 2 :]
        return {"every": self.every, "after": max(later), "before": min(later), "mean": self.mean}


def reversed_run(scene: PreparedModel, brake: Brake, every: float, turns: int) -> Reversals:
    """A brake worn over `turns` reversals, one every so often [1/(k K)]."""
    setups = {True: fem_setup(scene, brake), False: fem_setup(scene, turned_back(brake))}
    goals = {sense: target(setup) for sense, setup in setups.items()}
    size = every * unit_distance(setups[True], ARCHARD)
    states = run_in(
        setups[True],
        ARCHARD,
        backward=setups[False],
        reverse=size,
        distance=turns * size,
        tolerance=5e-3,
    )
    far = [
        distance(setups[state.forward], state, goals[state.forward]).pressure for state in states
    ]
    turned = [
        state for state, after in pairwise(states) if state.forward != after.forward
    ] + states[-1:]
    worn_off = turned[-1].depth - turned[-3].depth
    law = ARCHARD.coefficient * size * (goals[True].pressure + goals[False].pressure)
    mean = max(
        norm(s, s.along(worn_off - law)) / norm(s, s.along(law)) for s in setups[True].surfaces
    )
    return Reversals(every, states, far, mean)


@dataclass(frozen=True)
class Board:
    """Where equal steps ended: what they were, the state, its checkerboard."""

    title: str
    state: WearState
    ripple: float


def step_rows(
    one: Run, end: float, steps: Sequence[float]
) -> tuple[list[dict[str, Any]], list[Board]]:
    """Implicit and explicit steps of equal size up to `end`, in 1/(k K): checkerboard, contact,
    torque.
    """
    exact = at(run_in(one.setup, ARCHARD, distance=end * one.unit, tolerance=1e-4), end * one.unit)
    rows, boards = list[dict[str, Any]](), list[Board]()
    for way, size, run in _ways_to_step(one, end, steps):
        row: dict[str, Any] = {"way": way, "step": size}
        try:
            last = run()[-1]
        except NoAnswer as error:
            rows.append({**row, "status": f"failed: {error}"})
            continue
        row["ripple"] = one.ripple(last)
        row["touching"] = float((last.pressure > 0).mean())
        row["torque"] = last.torque
        row["torque_error"] = relative(last.torque, exact.torque)
        rows.append({**row, "status": "ended"})
        boards.append(Board(f"{way}\nsteps of {size:g}/(k K)", last, row["ripple"]))
    return rows, boards


def _ways_to_step(
    one: Run, end: float, steps: Sequence[float]
) -> Iterator[tuple[str, float, Callable[[], list[WearState]]]]:
    for size in steps:
        count, ds = round(end / size), size * one.unit
        stations = [(i + 1) * size * one.unit for i in range(count)]
        yield "implicit", size, partial(run_on, one.setup.interfaces, ARCHARD, stations)
        yield "explicit", size, partial(explicit, one.setup.interfaces, ARCHARD, ds, count)


def least_touching(runs: Iterable[Run]) -> Run:
    """The brake of which the least lies on when new."""
    return min(runs, key=lambda one: float((one.states[0].pressure > 0).mean()))


@dataclass(frozen=True)
class RunFrame:
    """A moment of a run: its state, and of each shoe the fields and the turn about its pin [rad]."""

    state: WearState
    fields: Sequence[Fields]
    turns: Sequence[float]


def frames(scene: PreparedModel, one: Run, count: int) -> list[RunFrame]:
    """Moments of a run, evenly spread over the logarithm of the distance, with the fields of the
    shoes.
    """
    end = one.states[-1].s
    found = []
    for s in [0.0, *np.geomspace(3e-4 * end, end, count - 1)]:
        state = at(one.states, s)
        brake = worn(one.setup, state)
        response = respond(scene, brake, penalty=math.inf)
        shown = [fields(scene, brake, response, i) for i in range(len(brake.shoes))]
        found.append(RunFrame(state, shown, [shoe.turn or 0.0 for shoe in response.shoes]))
    return found
