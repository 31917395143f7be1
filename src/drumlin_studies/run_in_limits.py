"""Rows on running in: whether brakes end at their rigid-shoe law, and how exact the wear is.

The tables are of brakes that run in from new (`brake_row`, `ratio_row`), of steps of half the size
(`half_row`), of exponents of the pressure (`exponent_row`), of a drum that turns both ways
(`run_with_reversals`), and of implicit against explicit steps (`step_rows`). Distances are in units
of 1/(k K), with the stiffness K = E/t of the lining and the wear coefficient k.
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
from drumlin.fem.analysis.fields import Fields, recover_shoe_fields
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.prepare import prepare
from drumlin.fem.preparation.scene import PreparedModel, reason_why_not_modelled
from drumlin.laws import hinged, law
from drumlin.lining_wear.archard import (
    TOLERANCE,
    WearLaw,
    WearState,
    checkerboard_amplitude,
    interpolate_state,
    wear_linings_by_explicit_euler,
    wear_linings_in_given_steps,
)
from drumlin.lining_wear.linings import (
    WearSetup,
    fem_wear_setup,
    foundation_wear_setup,
    put_shoes_on_guides,
)
from drumlin.lining_wear.run_in import (
    COEFFICIENT,
    WearTarget,
    brake_with_worn_linings,
    compute_run_checks,
    distance_from_target,
    lining_life,
    lining_pressure_norm,
    rigid_law_target,
    run_in,
    unit_sliding_distance,
)
from drumlin.response.norms import relative

ARCHARD = WearLaw(COEFFICIENT)
"""Archard's law, by which all brakes wear unless an exponent is given."""
SPENT_WITHIN = 0.01
"""Relative difference from the law above which a brake counts as "away from the law"."""
AT_LAW = "at the law"
"""Status of a brake that ends at its law."""
PRESSURE_AT_LAW, TORQUE_AT_LAW = 0.01, 0.001
"""Largest relative differences of pressure and torque from the law after running in."""


@dataclass(frozen=True)
class Run:
    """A brake that has run in.

    Attributes
    ----------
    name : str
        Name of the brake and the model.
    setup : WearSetup
        Its linings.
    states : list of WearState
        The states on the way.
    goal : Target
        The limit of the wear.
    unit : float
        The distance 1/(k K) [m].
    """

    name: str
    setup: WearSetup
    states: list[WearState]
    goal: WearTarget
    unit: float

    def distances(self) -> list[float]:
        """The sliding distances of the states [1/(k K)]."""
        return [state.s / self.unit for state in self.states]

    def ripple(self, state: WearState) -> float:
        """Checkerboard of the pressure, the largest of all linings."""
        return max(
            checkerboard_amplitude(surface.along(state.pressure)) for surface in self.setup.surfaces
        )


def run_until_settled(name: str, setup: WearSetup, law: WearLaw = ARCHARD, **options: Any) -> Run:
    """The run of a setup until wear has settled; options as of `run_in`."""
    states = run_in(setup, law, **options)
    goal = rigid_law_target(setup, law, options.get("torque"))
    return Run(name, setup, states, goal, unit_sliding_distance(setup, law))


def wearing_models_of(brake: Brake) -> tuple[list[tuple[str, str, Brake]], str | None]:
    """The ways to run in a brake, and why finite elements cannot (None where they can).

    A way is a suffix to the brake's name, a model and a brake. A single shoe also runs in with the
    opposite rotation; of two shoes one already shows what the other does in the opposite rotation.
    Rigid external shoes also run in on a guide.
    """
    found, reason = list[tuple[str, str, Brake]](), reason_why_not_modelled(brake)
    if reason is None:
        found.append(("", "fem", brake))
        if len(brake.shoes) == 1:
            found.append((", turned back", "fem", reversed_brake(brake)))
        rigid = all(shoe.body is None and shoe.pivot is None for shoe in brake.shoes)
        if rigid and brake.shoes[0].side == "external":
            found.append((", guided", "guided", brake))
    if foundation.why_not(brake) is None:
        found += [("", model, brake) for model in ("foundation", "foundation, lifted")]
    return found, reason


def reversed_brake(brake: Brake) -> Brake:
    """The brake with the opposite rotation."""
    return vary(brake, {"rotation": "clockwise" if brake.spin > 0 else "counter-clockwise"})


def wear_setup_by_model(model: str, brake: Brake, elements: int) -> WearSetup:
    """The setup of a brake by one of the models of `wearing_models_of`."""
    if model.startswith("foundation"):
        return foundation_wear_setup(brake, lift=("all",) if "lifted" in model else ())
    own = put_shoes_on_guides(brake) if model == "guided" else brake
    return fem_wear_setup(prepare(own, elements=elements), own)


def law_and_torque_of_model(model: str, brake: Brake) -> tuple[str, float]:
    """The form of the pressure that a model tends to, and the torque [N m] of the brake's law."""
    if model == "guided":
        return "cos", hinged.guided_torque(brake)
    if model == "fem" and brake.unhinged():
        return "A cos + B sin", law(brake).torque
    # In the published foundation model sections do not tilt.
    return "x cos" if model == "foundation" else "sin", hinged.sine(brake).torque


def brake_row(
    name: str, model: str, brake: Brake, elements: int
) -> tuple[dict[str, Any], Run | None]:
    """The row of a brake that runs in, and its run; None where the model fails.

    Parameters
    ----------
    name : str
        Name of the brake.
    model : str
        A model of `wearing_models_of`.
    brake : Brake
        The brake.
    elements : int
        Elements along a lining.
    """
    row: dict[str, Any] = {"brake": name, "model": model}
    begin = time.perf_counter()
    try:
        setup = wear_setup_by_model(model, brake, elements)
        one = run_until_settled(f"{name}, {model}", setup)
        row["law"], torque = law_and_torque_of_model(model, brake)
    except NoAnswer as error:
        return {**row, "status": f"failed: {error}"}, None
    row |= {
        "target": relative(one.goal.torque, torque),
        **run_row(one),
        "seconds": time.perf_counter() - begin,
    }
    if row["status"] == AT_LAW and abs(row["target"]) > TORQUE_AT_LAW:
        row["status"] = "at its own limit, which is not the law"
    return row, one


def run_row(one: Run) -> dict[str, Any]:
    """A run as a row: the brake new and worn in, the distance of running in, the balances."""
    setup, states, goal, unit = one.setup, one.states, one.goal, one.unit
    new, end = (
        distance_from_target(setup, states[0], goal),
        distance_from_target(setup, states[-1], goal),
    )
    spent = lining_life(setup, states, goal, ARCHARD, within=SPENT_WITHIN)
    close = lining_life(setup, states, goal, ARCHARD, within=TORQUE_AT_LAW)
    balance = compute_run_checks(setup, states, ARCHARD)
    holds = end.pressure <= PRESSURE_AT_LAW and abs(end.torque) <= TORQUE_AT_LAW
    return {
        "new_pressure": new.pressure,
        "new_torque": new.torque,
        "least_torque": min(distance_from_target(setup, state, goal).torque for state in states),
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
    """The row of a brake whose linings have `ratio` times the modulus of their elastic shoes."""
    body = brake.shoes[0].body
    assert body is not None and body.material is not None
    changed = vary(brake, {"shoe.lining.material.E": ratio * body.material.E_along})
    setup = fem_wear_setup(prepare(changed, elements=elements), changed)
    return {"ratio": ratio, **run_row(run_until_settled("", setup))}


def half_row(one: Run) -> dict[str, Any]:
    """The row of a run against the same run with steps of half the size.

    `long_pressure` and `long_torque` tell the distance from the limit after ten times the distance.
    """
    s = [state.s for state in one.states]
    middles = [(a + b) / 2 for a, b in pairwise(s)]
    halved = wear_linings_in_given_steps(one.setup.interfaces, ARCHARD, sorted([*s[1:], *middles]))[
        ::2
    ]
    area = np.concatenate([interface.area for interface in one.setup.interfaces])

    def pressure_norm(p: Floats) -> float:
        """The L2 norm of p over the linings."""
        return math.sqrt(float(area @ p**2))

    # Every second state of the halved run is at the distance of a state of the run.
    pairs = list(zip(one.states, halved, strict=True))
    long = run_in(one.setup, ARCHARD, distance=10 * s[-1])
    after = distance_from_target(one.setup, long[-1], one.goal)
    return {
        "brake": one.name,
        "asked": TOLERANCE,
        "pressure": max(
            pressure_norm(a.pressure - b.pressure) / pressure_norm(b.pressure) for a, b in pairs
        ),
        "torque": max(abs(relative(a.torque, b.torque)) for a, b in pairs),
        "depth": max(float(np.abs(a.depth - b.depth).max() / b.depth.max()) for a, b in pairs[1:]),
        "long_pressure": after.pressure,
        "long_torque": after.torque,
    }


def exponent_row(setup: WearSetup, m: float) -> dict[str, Any]:
    """The row of a hinged brake whose wear goes with p^m: its law is then sin^(1/m)."""
    law = WearLaw(COEFFICIENT, m)
    states, goal = run_in(setup, law), rigid_law_target(setup, law)
    end = distance_from_target(setup, states[-1], goal)
    return {
        "exponent": m,
        "goal": goal.torque,
        "sine": relative(goal.torque, hinged.sine(setup.brake).torque),
        "end_pressure": end.pressure,
        "end_torque": end.torque,
        "volume": compute_run_checks(setup, states, law).volume,
        "steps": len(states) - 1,
    }


@dataclass(frozen=True)
class Reversals:
    """A run whose drum reverses at regular distances.

    Attributes
    ----------
    every : float
        Distance between two reversals [1/(k K)].
    states : list of WearState
        The states of the run.
    far : list of float
        Relative distance of p from the law of its sense of rotation, for each state.
    mean : float
        Relative distance of the wear between the last two reversals, one in each sense, from the
        wear by the mean of both laws.
    """

    every: float
    states: list[WearState]
    far: list[float]
    mean: float

    @property
    def row(self) -> dict[str, float]:
        """Largest (`after` a reversal) and smallest (`before`) distance of p from its law.

        Both are of the second half of the run.
        """
        later = self.far[len(self.far) // 2 :]
        return {"every": self.every, "after": max(later), "before": min(later), "mean": self.mean}


def run_with_reversals(scene: PreparedModel, brake: Brake, every: float, turns: int) -> Reversals:
    """A brake that wears over several reversals.

    Parameters
    ----------
    scene : Scene
        The prepared model of the brake.
    brake : Brake
        The brake.
    every : float
        Distance between two reversals [1/(k K)].
    turns : int
        Number of reversals.
    """
    setups = {
        True: fem_wear_setup(scene, brake),
        False: fem_wear_setup(scene, reversed_brake(brake)),
    }
    goals = {sense: rigid_law_target(setup) for sense, setup in setups.items()}
    size = every * unit_sliding_distance(setups[True], ARCHARD)
    states = run_in(
        setups[True],
        ARCHARD,
        backward=setups[False],
        reverse=size,
        distance=turns * size,
        tolerance=5e-3,
    )
    far = []
    for state in states:
        sense = state.forward
        far.append(distance_from_target(setups[sense], state, goals[sense]).pressure)
    # The last state before each reversal, and the last state of all.
    turned = [state for state, after in pairwise(states) if state.forward != after.forward]
    turned.append(states[-1])
    # Wear between the last two reversals, against that by the mean of both laws.
    worn_off = turned[-1].depth - turned[-3].depth
    law = ARCHARD.coefficient * size * (goals[True].pressure + goals[False].pressure)
    surfaces = setups[True].surfaces
    mean = max(
        lining_pressure_norm(s, s.along(worn_off - law)) / lining_pressure_norm(s, s.along(law))
        for s in surfaces
    )
    return Reversals(every, states, far, mean)


@dataclass(frozen=True)
class EqualStepsEnd:
    """The end of a run of equal steps: title, state, and checkerboard of the pressure."""

    title: str
    state: WearState
    ripple: float


def step_rows(
    one: Run, end: float, steps: Sequence[float]
) -> tuple[list[dict[str, Any]], list[EqualStepsEnd]]:
    """Rows and ends of implicit and explicit runs of equal steps.

    Parameters
    ----------
    one : Run
        The brake that is run in.
    end : float
        Sliding distance of the runs [1/(k K)].
    steps : sequence of float
        Sizes of the steps [1/(k K)].
    """
    length = end * one.unit
    exact = interpolate_state(run_in(one.setup, ARCHARD, distance=length, tolerance=1e-4), length)
    rows, boards = list[dict[str, Any]](), list[EqualStepsEnd]()
    for way, size, run in _stepping_methods(one, end, steps):
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
        boards.append(EqualStepsEnd(f"{way}\nsteps of {size:g}/(k K)", last, row["ripple"]))
    return rows, boards


def _stepping_methods(
    one: Run, end: float, steps: Sequence[float]
) -> Iterator[tuple[str, float, Callable[[], list[WearState]]]]:
    """Each way to step, with the size of its steps and the function that runs it."""
    for size in steps:
        count, ds = round(end / size), size * one.unit
        stations = [(i + 1) * size * one.unit for i in range(count)]
        yield (
            "implicit",
            size,
            partial(wear_linings_in_given_steps, one.setup.interfaces, ARCHARD, stations),
        )
        yield (
            "explicit",
            size,
            partial(wear_linings_by_explicit_euler, one.setup.interfaces, ARCHARD, ds, count),
        )


def run_of_smallest_contact(runs: Iterable[Run]) -> Run:
    """The run whose new linings have the smallest contact."""
    return min(runs, key=lambda one: float((one.states[0].pressure > 0).mean()))


@dataclass(frozen=True)
class RunFrame:
    """A moment of a run: the state, and each shoe's fields and turn about its pin [rad]."""

    state: WearState
    fields: Sequence[Fields]
    turns: Sequence[float]


def run_frames(scene: PreparedModel, one: Run, count: int) -> list[RunFrame]:
    """Moments of a run with the fields of its shoes, even over the logarithm of the distance.

    Parameters
    ----------
    scene : Scene
        The prepared model of the brake.
    one : Run
        The run.
    count : int
        Number of moments, the first with new linings.
    """
    end = one.states[-1].s
    moments = []
    for s in [0.0, *np.geomspace(3e-4 * end, end, count - 1)]:
        state = interpolate_state(one.states, s)
        brake = brake_with_worn_linings(one.setup, state)
        response = solve_prepared_model(scene, brake, penalty=math.inf)
        shown = [recover_shoe_fields(scene, brake, response, i) for i in range(len(brake.shoes))]
        moments.append(RunFrame(state, shown, [shoe.turn or 0.0 for shoe in response.shoes]))
    return moments
