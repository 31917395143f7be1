"""Table rows on running in, the wear of new linings until their pressure no longer changes.

The rows show whether brakes end at the law of their rigid shoes, and how exact the computed wear
is. They treat brakes that run in from new (`brake_row`, `ratio_row`), wear in steps of half the
size (`half_row`), wear laws with exponents of the pressure (`exponent_row`), a drum that turns both
ways (`run_with_reversals`), and implicit against explicit steps (`step_rows`). Sliding distances
are in units of 1/(k K), with the stiffness K = E/t of the lining and the wear coefficient k.
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
"""Archard's law with wear proportional to pressure and distance; all brakes of this module wear by
it unless an exponent is given."""
SPENT_WITHIN = 0.01
"""Relative difference of pressure or torque from the law up to which a brake counts as run in."""
AT_LAW = "at the law"
"""Status of a brake whose pressure and torque end at its rigid-shoe law."""
PRESSURE_AT_LAW, TORQUE_AT_LAW = 0.01, 0.001
"""Largest relative differences of pressure and of torque from the rigid-shoe law with which a
worn-in brake counts as "at the law"."""


@dataclass(frozen=True)
class Run:
    """The wear of a brake from new linings until the pressure no longer changes.

    Attributes
    ----------
    name : str
        Name of the brake and of the model.
    setup : WearSetup
        The linings, with the equations of their contact.
    states : list of WearState
        Wear and pressure at growing sliding distances.
    goal : WearTarget
        The pressure and the torque of the rigid-shoe law, to which the wear tends.
    unit : float
        The sliding distance 1/(k K) [m].
    """

    name: str
    setup: WearSetup
    states: list[WearState]
    goal: WearTarget
    unit: float

    def distances(self) -> list[float]:
        """The sliding distances of the states, in units of 1/(k K)."""
        return [state.s / self.unit for state in self.states]

    def ripple(self, state: WearState) -> float:
        """The largest amplitude on any lining by which the pressure alternates from node to node.

        The amplitude is relative to the pressure of the lining in the state.
        """
        return max(
            checkerboard_amplitude(surface.along(state.pressure)) for surface in self.setup.surfaces
        )


def run_until_settled(name: str, setup: WearSetup, law: WearLaw = ARCHARD, **options: Any) -> Run:
    """The run of a brake until the pressure of its linings no longer changes.

    Parameters
    ----------
    name : str
        Name of the brake and of the model.
    setup : WearSetup
        The new linings.
    law : WearLaw
        The law of wear.
    **options
        Further arguments of `run_in`.
    """
    states = run_in(setup, law, **options)
    goal = rigid_law_target(setup, law, options.get("torque"))
    return Run(name, setup, states, goal, unit_sliding_distance(setup, law))


def wearing_models_of(brake: Brake) -> tuple[list[tuple[str, str, Brake]], str | None]:
    """The models by which a brake can run in, and the reason why finite elements cannot.

    Each model comes as a suffix to the brake's name, the name of the model, and the brake. The
    reason is None where finite elements can run in the brake. A brake with a single shoe also runs
    in with the opposite rotation. With two shoes this is not needed: in one rotation the one shoe
    leads and the other trails. Rigid external shoes also run in on a guide.
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
    """The linings of a brake before wear, by one of the models of `wearing_models_of`.

    elements : number of elements along each lining, for models by finite elements.
    """
    if model.startswith("foundation"):
        return foundation_wear_setup(brake, lift=("all",) if "lifted" in model else ())
    own = put_shoes_on_guides(brake) if model == "guided" else brake
    return fem_wear_setup(prepare(own, elements=elements), own)


def law_and_torque_of_model(model: str, brake: Brake) -> tuple[str, float]:
    """The form of the pressure to which the wear of a model tends, and the law's torque [N m].

    The form is a formula in words, for example "sin" for p ~ sin(phi) with the angle phi from the
    hinge. model : one of the models of `wearing_models_of`.
    """
    if model == "guided":
        return "cos", hinged.guided_torque(brake)
    if model == "fem" and brake.unhinged():
        return "A cos + B sin", law(brake).torque
    # In the published foundation model the beam's sections do not tilt, which leads to "x cos".
    return "x cos" if model == "foundation" else "sin", hinged.sine(brake).torque


def brake_row(
    name: str, model: str, brake: Brake, elements: int
) -> tuple[dict[str, Any], Run | None]:
    """The table row of a brake that runs in, and its run.

    Where the model has no answer, the run is None and the `status` of the row gives the reason.

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
    """The table row of a run, in which a brake wears until its pressure no longer changes.

    The row has the distances of pressure and torque from the law for new linings ("new_") and after
    the last state ("end_"), the sliding distances after which they are near the law, the shares of
    the lining's life, and the errors of the balances of volume and energy.
    """
    setup, states, goal, unit = one.setup, one.states, one.goal, one.unit
    # Distances of pressure and torque from the law, with new linings and after the last state.
    new, end = (
        distance_from_target(setup, states[0], goal),
        distance_from_target(setup, states[-1], goal),
    )
    # Shares of the lining's life that are spent more than 1 %, and more than 0.1 %, off the law.
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
    """The row of a brake whose linings have `ratio` times the modulus of the shoes' bodies.

    elements : number of elements along each lining.
    """
    body = brake.shoes[0].body
    assert body is not None and body.material is not None
    changed = vary(brake, {"shoe.lining.material.E": ratio * body.material.E_along})
    setup = fem_wear_setup(prepare(changed, elements=elements), changed)
    return {"ratio": ratio, **run_row(run_until_settled("", setup))}


def half_row(one: Run) -> dict[str, Any]:
    """The row that compares a run with the same run in steps of half the size.

    `pressure`, `torque` and `depth` are the largest relative differences between both runs.
    `long_pressure` and `long_torque` are the differences from the rigid-shoe law after ten times
    the sliding distance of the run.
    """
    s = [state.s for state in one.states]
    # The run is repeated with a further state in the middle of each step; every second state of the
    # new run then belongs to a state of the old run.
    middles = [(a + b) / 2 for a, b in pairwise(s)]
    halved = wear_linings_in_given_steps(one.setup.interfaces, ARCHARD, sorted([*s[1:], *middles]))[
        ::2
    ]
    area = np.concatenate([interface.area for interface in one.setup.interfaces])

    def pressure_norm(p: Floats) -> float:
        """The L2 norm of nodal pressures over the area of all linings."""
        return math.sqrt(float(area @ p**2))

    # Pairs of states of both runs at the same sliding distance.
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
    """The row of a hinged brake that wears by the power m of the pressure.

    The pressure of the worn-in lining is then proportional to sin(phi)^(1/m), with the angle phi
    from the hinge.
    """
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
    """The wear of a brake whose drum reverses its sense of rotation at regular sliding distances.

    Attributes
    ----------
    every : float
        Sliding distance between two reversals, in units of 1/(k K).
    states : list of WearState
        Wear and pressure at growing sliding distances.
    far : list of float
        For each state the relative distance of its pressure from the rigid-shoe law in the state's
        sense of rotation.
    mean : float
        Relative distance of the wear over the last two stretches, one in each sense of rotation,
        from the wear by the mean of the laws of both senses.
    """

    every: float
    states: list[WearState]
    far: list[float]
    mean: float

    @property
    def row(self) -> dict[str, float]:
        """The table row of a run with reversals of the drum.

        `after` is the largest distance of the pressure from its law, reached right after a
        reversal; `before` is the smallest distance, reached right before one. Both are taken over
        the second half of the run.
        """
        later = self.far[len(self.far) // 2 :]
        return {"every": self.every, "after": max(later), "before": min(later), "mean": self.mean}


def run_with_reversals(scene: PreparedModel, brake: Brake, every: float, turns: int) -> Reversals:
    """The wear of a brake over several reversals of the drum.

    Parameters
    ----------
    scene : PreparedModel
        The prepared model of the brake.
    brake : Brake
        The brake, in the first sense of rotation.
    every : float
        Sliding distance between two reversals, in units of 1/(k K).
    turns : int
        Number of stretches between reversals.
    """
    # Linings and rigid-shoe law for each sense of rotation; True is the first sense.
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
    # `turned` has the last state before each reversal and the last state of the run.
    turned = [state for state, after in pairwise(states) if state.forward != after.forward]
    turned.append(states[-1])
    # The wear over the last two stretches is compared with the wear by the mean of both laws.
    worn_off = turned[-1].depth - turned[-3].depth
    law = ARCHARD.coefficient * size * (goals[True].pressure + goals[False].pressure)
    surfaces = setups[True].surfaces
    distances = []
    for surface in surfaces:
        difference = lining_pressure_norm(surface, surface.along(worn_off - law))
        distances.append(difference / lining_pressure_norm(surface, surface.along(law)))
    mean = max(distances)
    return Reversals(every, states, far, mean)


@dataclass(frozen=True)
class EqualStepsEnd:
    """The last state of a run in equal steps.

    Attributes
    ----------
    title : str
        Name of the method and size of the steps.
    state : WearState
        The last state.
    ripple : float
        Relative amplitude by which the pressure alternates from node to node.
    """

    title: str
    state: WearState
    ripple: float


def step_rows(
    one: Run, end: float, steps: Sequence[float]
) -> tuple[list[dict[str, Any]], list[EqualStepsEnd]]:
    """Table rows and last states of runs in equal steps, by implicit and by explicit steps.

    The torque of each run is compared with that of a run in fine steps of controlled error.

    Parameters
    ----------
    one : Run
        A run of the brake, whose linings and unit of distance are used.
    end : float
        Sliding distance of the runs, in units of 1/(k K).
    steps : sequence of float
        Sizes of the steps, in units of 1/(k K).
    """
    # The reference: a run over the same distance with steps of small estimated error.
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
    """For each size of steps an implicit and an explicit run: name, size, function that runs it.

    one, end, steps : the parameters of `step_rows`.
    """
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
    """The run whose new linings touch the drum with the smallest fraction of their nodes."""
    return min(runs, key=lambda one: float((one.states[0].pressure > 0).mean()))


@dataclass(frozen=True)
class RunFrame:
    """A moment of a run: the wear state, and for each shoe its fields and its turn.

    The fields are displacements and stresses inside the shoe; the turn is the angle [rad] by which
    the shoe has turned about its pin.
    """

    state: WearState
    fields: Sequence[Fields]
    turns: Sequence[float]


def run_frames(scene: PreparedModel, one: Run, count: int) -> list[RunFrame]:
    """Moments of a run with the fields of its shoes, for an animation.

    The first moment has new linings; the others are at even distances of the logarithm of the
    sliding distance.

    Parameters
    ----------
    scene : PreparedModel
        The prepared model of the brake.
    one : Run
        The run.
    count : int
        Number of moments.
    """
    # At each moment the brake with worn linings is solved and the stresses are computed.
    end = one.states[-1].s
    moments = []
    for s in [0.0, *np.geomspace(3e-4 * end, end, count - 1)]:
        state = interpolate_state(one.states, s)
        brake = brake_with_worn_linings(one.setup, state)
        response = solve_prepared_model(scene, brake, penalty=math.inf)
        shown = [recover_shoe_fields(scene, brake, response, i) for i in range(len(brake.shoes))]
        moments.append(RunFrame(state, shown, [shoe.turn or 0.0 for shoe in response.shoes]))
    return moments
