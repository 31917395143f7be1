"""Table rows on running in: the wear of new linings until their pressure no longer changes.

The rows show whether worn-in brakes have the pressure of the rigid-shoe law, and how exact the
computed wear is. They treat brakes that run in from new (`table_row_and_wear_run_of_brake`,
`table_row_of_run_in_at_modulus_ratio`), wear in steps of half the size
(`row_comparing_run_with_halved_wear_steps`), wear laws with exponents of the pressure
(`table_row_of_run_in_at_pressure_exponent`), a drum that turns both ways
(`wear_brake_with_drum_reversals`), and implicit against explicit steps
(`rows_and_last_states_of_wear_runs_in_equal_steps`). Sliding distances are in units of 1/(k K),
with the stiffness K = E/t of the lining and the wear coefficient k.
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
from drumlin.fem.analysis.fields import (
    StressAndDisplacementFields,
    stress_and_displacement_fields_of_shoe,
)
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.preparation.scene import PreparedModel, reason_against_finite_element_model
from drumlin.laws import hinged, solve_brake_by_its_rigid_shoe_law
from drumlin.lining_wear.archard import (
    DEFAULT_PRESSURE_ERROR_OF_WEAR_STEP,
    WearLaw,
    WearState,
    interpolate_wear_state_at_distance,
    relative_amplitude_of_node_to_node_pressure_ripple,
    wear_linings_by_explicit_euler,
    wear_linings_in_given_steps,
)
from drumlin.lining_wear.linings import (
    WearSetup,
    brake_with_shoes_on_guides,
    wear_setup_by_finite_elements,
    wear_setup_by_foundation_model,
)
from drumlin.lining_wear.run_in import (
    DEFAULT_WEAR_COEFFICIENT,
    FinalWearPressureAndTorque,
    brake_with_worn_linings,
    compute_checks_of_wear_run,
    compute_life_of_linings,
    final_wear_pressure_and_torque_by_rigid_shoe_law,
    norm_along_lining_without_end_elements,
    relative_differences_from_end_of_wear,
    sliding_distance_of_e_fold_pressure_change,
    wear_brake_linings_until_worn_in,
)
from drumlin.response.norms import relative_error_of_number

ARCHARD_WEAR_LAW = WearLaw(DEFAULT_WEAR_COEFFICIENT)
"""Archard's law: wear in proportion to pressure and sliding distance. All brakes of this module
wear by this law unless an exponent of the pressure is given."""
RUN_IN_TOLERANCE_FROM_LAW = 0.01
"""Relative difference of pressure or torque from the rigid-shoe law, below which a brake counts as
run in.
"""
STATUS_OF_RUN_ENDING_AT_LAW = "at the law"
"""Status of a brake whose pressure and torque reach those of its rigid-shoe law by wear."""
PRESSURE_AT_LAW, TORQUE_AT_LAW = 0.01, 0.001
"""Largest relative differences of pressure and of torque from the rigid-shoe law with which a
worn-in brake counts as "at the law"."""


@dataclass(frozen=True)
class WearRunUntilPressureSettles:
    """The wear of a brake from new linings until the pressure no longer changes.

    Attributes
    ----------
    name : str
        Name of the brake and of the model.
    setup : WearSetup
        The linings before wear, with the equations of their contact.
    states : list of WearState
        Wear and pressure at growing sliding distances.
    goal : FinalWearPressureAndTorque
        The pressure and the torque of the rigid-shoe law, which the brake approaches as it wears.
    unit : float
        The sliding distance 1/(k K) [m].
    """

    name: str
    setup: WearSetup
    states: list[WearState]
    goal: FinalWearPressureAndTorque
    unit: float

    def sliding_distances_of_run_states(self) -> list[float]:
        """The sliding distances of the states, in units of 1/(k K)."""
        return [state.s / self.unit for state in self.states]

    def largest_relative_pressure_alternation_between_nodes(self, state: WearState) -> float:
        """The largest amplitude of any lining's pressure that alternates from node to node.

        The amplitude is relative to the pressure of the same lining in this state.
        """
        return max(
            relative_amplitude_of_node_to_node_pressure_ripple(
                surface.lining_values_by_growing_angle(state.pressure)
            )
            for surface in self.setup.surfaces
        )


def wear_brake_until_pressure_settles(
    name: str, setup: WearSetup, law: WearLaw = ARCHARD_WEAR_LAW, **options: Any
) -> WearRunUntilPressureSettles:
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
        Further arguments of `wear_brake_linings_until_worn_in`.
    """
    states = wear_brake_linings_until_worn_in(setup, law, **options)
    goal = final_wear_pressure_and_torque_by_rigid_shoe_law(setup, law, options.get("torque"))
    return WearRunUntilPressureSettles(
        name, setup, states, goal, sliding_distance_of_e_fold_pressure_change(setup, law)
    )


def list_wear_models_and_reason_against_finite_elements(
    brake: Brake,
) -> tuple[list[tuple[str, str, Brake]], str | None]:
    """The models that can compute the running in of a brake, and why finite elements cannot.

    Each model is a tuple: a suffix to the brake's name, the name of the model, and the brake. The
    reason is None if finite elements apply to the brake. A brake with a single shoe is also listed
    with the opposite rotation. With two shoes this is not needed, because one shoe leads and the
    other trails. A brake with rigid external shoes is also listed with its shoes on guides.
    """
    found, reason = list[tuple[str, str, Brake]](), reason_against_finite_element_model(brake)
    if reason is None:
        found.append(("", "fem", brake))
        if len(brake.shoes) == 1:
            found.append((", turned back", "fem", brake_with_opposite_rotation(brake)))
        rigid = all(shoe.body is None and shoe.pivot is None for shoe in brake.shoes)
        if rigid and brake.shoes[0].side == "external":
            found.append((", guided", "guided", brake))
    if foundation.reason_against_foundation_model(brake) is None:
        found += [("", model, brake) for model in ("foundation", "foundation, lifted")]
    return found, reason


def brake_with_opposite_rotation(brake: Brake) -> Brake:
    """The brake with the opposite rotation."""
    return vary(
        brake, {"rotation": "clockwise" if brake.sign_of_motion > 0 else "counter-clockwise"}
    )


def prepare_wear_setup_by_model(model: str, brake: Brake, elements: int) -> WearSetup:
    """The linings of a brake before wear, with the contact equations of a model.

    elements : number of elements along each lining, for models by finite elements.
    """
    if model.startswith("foundation"):
        return wear_setup_by_foundation_model(brake, lift=("all",) if "lifted" in model else ())
    own = brake_with_shoes_on_guides(brake) if model == "guided" else brake
    return wear_setup_by_finite_elements(make_prepared_model(own, elements=elements), own)


def worn_in_pressure_formula_and_law_torque(model: str, brake: Brake) -> tuple[str, float]:
    """Formula of the pressure that a worn-in lining approaches, and torque [N m] by the same law.

    The formula is a short text, for example "sin" for p ~ sin(phi) with the angle phi from the
    hinge. model : one of the models of `list_wear_models_and_reason_against_finite_elements`.
    """
    if model == "guided":
        return "cos", hinged.torque_of_brake_with_guided_shoes(brake)
    if model == "fem" and brake.reason_why_not_all_shoes_are_hinged():
        return "A cos + B sin", solve_brake_by_its_rigid_shoe_law(brake).torque
    # The published foundation model neglects the tilt of the beam's sections. Wear then leads to
    # the pressure "x cos" and not to "sin".
    return "x cos" if model == "foundation" else "sin", hinged.solve_brake_by_sine_law(brake).torque


def table_row_and_wear_run_of_brake(
    name: str, model: str, brake: Brake, elements: int
) -> tuple[dict[str, Any], WearRunUntilPressureSettles | None]:
    """The table row of a brake that runs in, and its run.

    Where the model has no answer, the run is None and the `status` of the row gives the reason.

    Parameters
    ----------
    name : str
        Name of the brake.
    model : str
        A model of `list_wear_models_and_reason_against_finite_elements`.
    brake : Brake
        The brake.
    elements : int
        Elements along a lining.
    """
    row: dict[str, Any] = {"brake": name, "model": model}
    begin = time.perf_counter()
    try:
        setup = prepare_wear_setup_by_model(model, brake, elements)
        one = wear_brake_until_pressure_settles(f"{name}, {model}", setup)
        row["law"], torque = worn_in_pressure_formula_and_law_torque(model, brake)
    except NoAnswer as error:
        return {**row, "status": f"failed: {error}"}, None
    row |= {
        "target": relative_error_of_number(one.goal.torque, torque),
        **table_row_of_wear_run_until_settled(one),
        "seconds": time.perf_counter() - begin,
    }
    if row["status"] == STATUS_OF_RUN_ENDING_AT_LAW and abs(row["target"]) > TORQUE_AT_LAW:
        row["status"] = "at its own limit, which is not the law"
    return row, one


def table_row_of_wear_run_until_settled(one: WearRunUntilPressureSettles) -> dict[str, Any]:
    """The table row of a run, in which a brake wears until its pressure no longer changes.

    The row has the relative differences of pressure and torque from the rigid-shoe law with new
    linings ("new_") and in the last state ("end_"). It also has the sliding distances after which
    pressure and torque are near the law, the same distances as shares of the lining's life, and the
    errors of the balances of volume and energy.
    """
    setup, states, goal, unit = one.setup, one.states, one.goal, one.unit
    # Relative distances of pressure and torque from the law: with new linings, and after the last
    # state.
    new, end = (
        relative_differences_from_end_of_wear(setup, states[0], goal),
        relative_differences_from_end_of_wear(setup, states[-1], goal),
    )
    # Shares of the lining's life during which pressure or torque differs from the law by more than
    # 1 % (`spent`), and by more than 0.1 % (`close`).
    spent = compute_life_of_linings(
        setup, states, goal, ARCHARD_WEAR_LAW, within=RUN_IN_TOLERANCE_FROM_LAW
    )
    close = compute_life_of_linings(setup, states, goal, ARCHARD_WEAR_LAW, within=TORQUE_AT_LAW)
    balance = compute_checks_of_wear_run(setup, states, ARCHARD_WEAR_LAW)
    holds = end.pressure <= PRESSURE_AT_LAW and abs(end.torque) <= TORQUE_AT_LAW
    return {
        "new_pressure": new.pressure,
        "new_torque": new.torque,
        "least_torque": min(
            relative_differences_from_end_of_wear(setup, state, goal).torque for state in states
        ),
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
        "ripple": one.largest_relative_pressure_alternation_between_nodes(states[-1]),
        "steps": len(states) - 1,
        "status": STATUS_OF_RUN_ENDING_AT_LAW if holds else "short of the law",
    }


def table_row_of_run_in_at_modulus_ratio(
    brake: Brake, ratio: float, elements: int
) -> dict[str, Any]:
    """The row of a brake whose linings have `ratio` times the modulus of the shoes' bodies.

    elements : number of elements along each lining.
    """
    body = brake.shoes[0].body
    assert body is not None and body.material is not None
    changed = vary(brake, {"shoe.lining.material.E": ratio * body.material.E_along})
    setup = wear_setup_by_finite_elements(make_prepared_model(changed, elements=elements), changed)
    return {
        "ratio": ratio,
        **table_row_of_wear_run_until_settled(wear_brake_until_pressure_settles("", setup)),
    }


def row_comparing_run_with_halved_wear_steps(one: WearRunUntilPressureSettles) -> dict[str, Any]:
    """The row that compares a wear run with the same run in steps of half the size.

    `pressure`, `torque` and `depth` are the largest relative differences between both runs.
    `long_pressure` and `long_torque` are the relative differences from the rigid-shoe law after a
    third run, over ten times the sliding distance.
    """
    s = [state.s for state in one.states]
    # The run is repeated with two steps in place of each step. Every second state of the new run
    # has the sliding distance of a state of the old run.
    middles = [(a + b) / 2 for a, b in pairwise(s)]
    halved = wear_linings_in_given_steps(
        one.setup.interfaces, ARCHARD_WEAR_LAW, sorted([*s[1:], *middles])
    )[::2]
    area = np.concatenate([interface.area for interface in one.setup.interfaces])

    def pressure_norm_over_linings(p: Floats) -> float:
        """The L2 norm of nodal pressures over the area of all linings."""
        return math.sqrt(float(area @ p**2))

    # Pairs of states, one of each run, at the same sliding distance.
    pairs = list(zip(one.states, halved, strict=True))
    long = wear_brake_linings_until_worn_in(one.setup, ARCHARD_WEAR_LAW, distance=10 * s[-1])
    after = relative_differences_from_end_of_wear(one.setup, long[-1], one.goal)
    return {
        "brake": one.name,
        "asked": DEFAULT_PRESSURE_ERROR_OF_WEAR_STEP,
        "pressure": max(
            pressure_norm_over_linings(a.pressure - b.pressure)
            / pressure_norm_over_linings(b.pressure)
            for a, b in pairs
        ),
        "torque": max(abs(relative_error_of_number(a.torque, b.torque)) for a, b in pairs),
        "depth": max(float(np.abs(a.depth - b.depth).max() / b.depth.max()) for a, b in pairs[1:]),
        "long_pressure": after.pressure,
        "long_torque": after.torque,
    }


def table_row_of_run_in_at_pressure_exponent(setup: WearSetup, m: float) -> dict[str, Any]:
    """The row of a hinged brake whose wear is proportional to the pressure to the power m.

    The pressure of the worn-in lining is then proportional to sin(phi)^(1/m), with the angle phi
    from the hinge.
    """
    law = WearLaw(DEFAULT_WEAR_COEFFICIENT, m)
    states, goal = (
        wear_brake_linings_until_worn_in(setup, law),
        final_wear_pressure_and_torque_by_rigid_shoe_law(setup, law),
    )
    end = relative_differences_from_end_of_wear(setup, states[-1], goal)
    return {
        "exponent": m,
        "goal": goal.torque,
        "sine": relative_error_of_number(
            goal.torque, hinged.solve_brake_by_sine_law(setup.brake).torque
        ),
        "end_pressure": end.pressure,
        "end_torque": end.torque,
        "volume": compute_checks_of_wear_run(setup, states, law).volume,
        "steps": len(states) - 1,
    }


@dataclass(frozen=True)
class WearWithRegularDrumReversals:
    """The wear of a brake whose drum reverses its sense of rotation at regular sliding distances.

    Attributes
    ----------
    every : float
        Sliding distance between two reversals, in units of 1/(k K).
    states : list of WearState
        Wear and pressure at growing sliding distances.
    far : list of float
        For each state the relative distance of its pressure from the rigid-shoe law for the present
        sense of rotation.
    mean : float
        Relative difference between two worn depths: the depth worn between the last reversals, once
        in each sense of rotation, and the depth that the mean of the law's pressures for both
        senses would cause.
    """

    every: float
    states: list[WearState]
    far: list[float]
    mean: float

    @property
    def row_of_wear_run_with_drum_reversals(self) -> dict[str, float]:
        """The table row of a run with reversals of the drum.

        `after` is the largest distance of the pressure from its law, reached right after a
        reversal; `before` is the smallest distance, reached right before a reversal. Both are taken
        over the second half of the run.
        """
        later = self.far[len(self.far) // 2 :]
        return {"every": self.every, "after": max(later), "before": min(later), "mean": self.mean}


def wear_brake_with_drum_reversals(
    scene: PreparedModel, brake: Brake, every: float, turns: int
) -> WearWithRegularDrumReversals:
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
        Number of runs without reversal, each over the distance `every`. The drum reverses between
        two runs.
    """
    # Linings and rigid-shoe law for each sense of rotation. The key True is the first sense.
    setups = {
        True: wear_setup_by_finite_elements(scene, brake),
        False: wear_setup_by_finite_elements(scene, brake_with_opposite_rotation(brake)),
    }
    goals = {
        sense: final_wear_pressure_and_torque_by_rigid_shoe_law(setup)
        for sense, setup in setups.items()
    }
    size = every * sliding_distance_of_e_fold_pressure_change(setups[True], ARCHARD_WEAR_LAW)
    states = wear_brake_linings_until_worn_in(
        setups[True],
        ARCHARD_WEAR_LAW,
        backward=setups[False],
        reverse=size,
        distance=turns * size,
        tolerance=5e-3,
    )
    far = [
        relative_differences_from_end_of_wear(
            setups[state.forward], state, goals[state.forward]
        ).pressure
        for state in states
    ]
    # `turned` gets the last state before each reversal, and the last state of the whole run.
    turned = [state for state, after in pairwise(states) if state.forward != after.forward]
    turned.append(states[-1])
    # The depth worn in the last two runs, one in each sense of rotation, is compared with the depth
    # by Archard's law under the worn-in pressures of both senses of rotation.
    worn_off = turned[-1].depth - turned[-3].depth
    law = ARCHARD_WEAR_LAW.coefficient * size * (goals[True].pressure + goals[False].pressure)
    mean = _largest_relative_difference_on_linings(setups[True], worn_off, law)
    return WearWithRegularDrumReversals(every, states, far, mean)


def _largest_relative_difference_on_linings(
    setup: WearSetup, values: Floats, reference: Floats
) -> float:
    """The largest relative L2 difference, among the linings of a brake, of values from a reference.

    Parameters
    ----------
    setup : WearSetup
        The linings, with n nodes altogether.
    values, reference : array (n,)
        The values and their reference at the nodes. The elements at the lining's ends are left out.
    """
    differences = []
    for surface in setup.surfaces:
        norms = [
            norm_along_lining_without_end_elements(
                surface, surface.lining_values_by_growing_angle(of)
            )
            for of in (values - reference, reference)
        ]
        differences.append(norms[0] / norms[1])
    return max(differences)


@dataclass(frozen=True)
class LastStateOfEqualWearSteps:
    """The last state of a brake whose linings have worn in steps of equal size.

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


def rows_and_last_states_of_wear_runs_in_equal_steps(
    one: WearRunUntilPressureSettles, end: float, steps: Sequence[float]
) -> tuple[list[dict[str, Any]], list[LastStateOfEqualWearSteps]]:
    """Table rows and last states of wear runs in steps of equal size, implicit and explicit ones.

    The torque of each run is compared with the torque of a reference run, whose fine steps have a
    small estimated error.

    Parameters
    ----------
    one : WearRunUntilPressureSettles
        A run of the brake, whose linings and unit of distance are used.
    end : float
        Sliding distance of the runs, in units of 1/(k K).
    steps : sequence of float
        Sizes of the steps, in units of 1/(k K).
    """
    # The reference for the torque is a run over the same distance, whose steps have a small
    # estimated error.
    length = end * one.unit
    exact = interpolate_wear_state_at_distance(
        wear_brake_linings_until_worn_in(
            one.setup, ARCHARD_WEAR_LAW, distance=length, tolerance=1e-4
        ),
        length,
    )
    rows, boards = list[dict[str, Any]](), list[LastStateOfEqualWearSteps]()
    for way, size, run in _list_implicit_and_explicit_wear_runs(one, end, steps):
        row: dict[str, Any] = {"way": way, "step": size}
        try:
            last = run()[-1]
        except NoAnswer as error:
            rows.append({**row, "status": f"failed: {error}"})
            continue
        row["ripple"] = one.largest_relative_pressure_alternation_between_nodes(last)
        row["touching"] = float((last.pressure > 0).mean())
        row["torque"] = last.torque
        row["torque_error"] = relative_error_of_number(last.torque, exact.torque)
        rows.append({**row, "status": "ended"})
        boards.append(
            LastStateOfEqualWearSteps(f"{way}\nsteps of {size:g}/(k K)", last, row["ripple"])
        )
    return rows, boards


def _list_implicit_and_explicit_wear_runs(
    one: WearRunUntilPressureSettles, end: float, steps: Sequence[float]
) -> Iterator[tuple[str, float, Callable[[], list[WearState]]]]:
    """Yield for each step size an implicit and an explicit run: name, step size, and function.

    one : a run of the brake; end : sliding distance of the runs; steps : sizes of the steps; both
        in units of 1/(k K).
    """
    for size in steps:
        count, ds = round(end / size), size * one.unit
        stations = [(i + 1) * size * one.unit for i in range(count)]
        yield (
            "implicit",
            size,
            partial(wear_linings_in_given_steps, one.setup.interfaces, ARCHARD_WEAR_LAW, stations),
        )
        yield (
            "explicit",
            size,
            partial(
                wear_linings_by_explicit_euler, one.setup.interfaces, ARCHARD_WEAR_LAW, ds, count
            ),
        )


def wear_run_whose_new_linings_touch_least(
    runs: Iterable[WearRunUntilPressureSettles],
) -> WearRunUntilPressureSettles:
    """The run whose new linings touch the drum with the smallest fraction of their nodes."""
    return min(runs, key=lambda one: float((one.states[0].pressure > 0).mean()))


@dataclass(frozen=True)
class AnimationFrameOfWearRun:
    """A frame of an animation of a wear run: the wear, and the fields and the turn of each shoe.

    The fields are displacements and stresses inside the shoe. The turn is the angle [rad] by which
    the shoe has turned about its pin.
    """

    state: WearState
    fields: Sequence[StressAndDisplacementFields]
    turns: Sequence[float]


def animation_frames_of_run(
    scene: PreparedModel, one: WearRunUntilPressureSettles, count: int
) -> list[AnimationFrameOfWearRun]:
    """The frames of an animation of a run-in, each with the stress fields of the shoes.

    In the first frame the linings are new. The other frames are evenly spaced in the logarithm of
    the sliding distance.

    Parameters
    ----------
    scene : PreparedModel
        The prepared model of the brake.
    one : WearRunUntilPressureSettles
        The run.
    count : int
        Number of frames.
    """
    # For each frame the brake with worn linings is solved, and its stresses are computed.
    end = one.states[-1].s
    moments = []
    for s in [0.0, *np.geomspace(3e-4 * end, end, count - 1)]:
        state = interpolate_wear_state_at_distance(one.states, s)
        brake = brake_with_worn_linings(one.setup, state)
        response = solve_prepared_model(scene, brake, penalty=math.inf)
        shown = [
            stress_and_displacement_fields_of_shoe(scene, brake, response, i)
            for i in range(len(brake.shoes))
        ]
        moments.append(
            AnimationFrameOfWearRun(state, shown, [shoe.turn or 0.0 for shoe in response.shoes])
        )
    return moments
