"""Checks the simulation of lining wear at its beginning, middle and end, on random brakes.

Unworn linings must have the torque and the pressure of `solve`. Worn linings must have the torque
and the pressure that `solve` gives for their worn surface, in both senses of rotation. At the end
of wear, all points of a lining wear at the rate at which a rigid-body motion of the shoe closes the
gap. The pressure must then equal the pressure of the worn-in state and the pressure of the
rigid-shoe law, within the error of the mesh.
"""

import math
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake
from drumlin.fem.error_control.adapt import (
    DEFAULT_TOLERANCES_OF_PRESSURE_AND_TORQUE,
    solve_brake_to_tolerance,
)
from drumlin.fem.model import ITERATIVE_REFINEMENT_REMARK, solve_prepared_model
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.fem.solve import prepared_model_with_finest_elements
from drumlin.lining_wear.archard import WearLaw, WearState, wear_linings_in_given_steps
from drumlin.lining_wear.linings import WearSetup, wear_setup_by_finite_elements
from drumlin.lining_wear.run_in import (
    DEFAULT_WEAR_COEFFICIENT,
    END_OF_WEAR_TOLERANCE,
    brake_with_worn_linings,
    final_wear_pressure_and_torque_by_rigid_shoe_law,
    largest_relative_pressure_difference_of_linings,
    wear_brake_linings_until_worn_in,
)
from drumlin.lining_wear.worn_in import brake_with_worn_in_clearances
from drumlin.response import Response
from drumlin_studies import random_brake, random_kinds
from drumlin_studies.consistency import TwoPathComparison

ELEMENTS_PER_WORN_LINING = 24
"""Number of elements along each worn lining.

With more elements the end of wear is nearer to the rigid-shoe law."""
ALLOWED_TORQUE_DIFFERENCE_ON_ONE_MESH = 1e-6
"""Allowed relative difference between the torques of wear simulation and `solve` on one mesh.

Both have exact contact. Round-off reaches 5e-8 if a lining is much softer than its shoe.
"""
ALLOWED_PRESSURE_DISTANCE_ON_ONE_MESH = 2e-5
"""Allowed relative L2 distance between the pressures of wear simulation and `solve` on one mesh.

Round-off reaches 1e-5."""
ALLOWED_TORQUE_DIFFERENCE_FROM_LAW = 1e-3
"""Allowed relative difference between the torques of the rigid-shoe law and of the worn-in state.

It allows for the error of a mesh with ELEMENTS_PER_WORN_LINING. This error falls with the square of
the number of elements if only a part of the lining is in contact, and else faster.
"""
ALLOWED_PRESSURE_DISTANCE_FROM_LAW = 0.02
"""Allowed relative L2 distance between the pressures of the rigid-shoe law and the worn-in state.

The pressure of the law has a kink at the end of its contact. The kink lies inside an element, whose
pressure is smooth.
"""
ALLOWED_DIFFERENCE_AT_WEAR_END = 1.1 * END_OF_WEAR_TOLERANCE
"""Allowed relative difference of torque and pressure at the end of a wear run from the final values
that wear approaches.

A run ends at a difference of END_OF_WEAR_TOLERANCE. The factor allows for the mesh and the penalty.
"""

ERROR_WORDS_OF_ALLOWED_REFUSALS_BY_ONE_PATH = (
    "small displacements hold up to",
    "without its ever touching",
    "lost digits",
)
"""Words of error messages with which one path may refuse a brake that the other path solves.

The first two texts mean that wear has left a very soft shoe so much clearance that the shoe would
have to rotate too far. The third text means that `solve` finds too large a round-off error of
static condensation, which the wear simulation does not check.
"""
FUNCTION_THAT_SOLVES_WITH_EXACT_CONTACT = partial(solve_prepared_model, penalty=math.inf)
"""Function that solves a prepared model with exact contact, as the wear simulation does."""
KINDS_OF_BRAKES_NEVER_WITH_RIGID_SHOES = ("table", "grip")
"""Kinds of random brakes that cannot be drawn with rigid shoes."""
KINDS_OF_RANDOM_BRAKES_FOR_WEAR_CHECK = (
    *random_brake.FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SHAPE_KIND,
    *random_kinds.FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SUPPORT_KIND,
    *(
        f"rigid {kind}"
        for kind in random_kinds.FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SUPPORT_KIND
        if kind not in KINDS_OF_BRAKES_NEVER_WITH_RIGID_SHOES
    ),
)
"""The kinds of random brakes that seeds draw, some of them also with rigid shoes."""


class _TorqueAndPressureOfWornLinings(NamedTuple):
    """Torque and pressure of worn linings, computed in one of several ways.

    Attributes
    ----------
    torque : float
        Torque [N m].
    pressure : array (n,)
        Pressure at the contact nodes of all linings [Pa].
    said : str
        Line in which drumlin warns of round-off; "" without a warning.
    """

    torque: float
    pressure: Floats
    said: str = ""


def rows_of_wear_checks_of_random_brake(seed: int) -> list[TwoPathComparison]:
    """Run all checks of wear on the random brake of a seed; returns a row for each quantity.

    Consecutive seeds go through KINDS_OF_RANDOM_BRAKES_FOR_WEAR_CHECK. There are no rows if the
    seed gives no brake.
    """
    kind = KINDS_OF_RANDOM_BRAKES_FOR_WEAR_CHECK[seed % len(KINDS_OF_RANDOM_BRAKES_FOR_WEAR_CHECK)]
    try:
        brake = _draw_random_brake_for_wear_check(seed, kind)
    except NoAnswer:
        return []
    name = f"{kind} {seed}"
    return _rows_comparing_unworn_linings_with_solve(
        name, brake
    ) + _rows_comparing_worn_linings_with_solve(name, brake.brake_with_perfectly_round_drum())


def _draw_random_brake_for_wear_check(seed: int, kind: str) -> Brake:
    """The random brake of a seed and of a kind, one of KINDS_OF_RANDOM_BRAKES_FOR_WEAR_CHECK."""
    if kind.startswith("rigid "):
        return random_kinds.draw_random_brake_of_support_kind(
            seed, kind.removeprefix("rigid "), rigid=True
        )
    return random_kinds.draw_random_brake_of_kind(seed, kind)


def _rows_comparing_unworn_linings_with_solve(name: str, brake: Brake) -> list[TwoPathComparison]:
    """Compare the first state of a wear run with `solve`, both on the finest mesh of `solve`."""
    scene = prepared_model_with_finest_elements(brake)
    setup = wear_setup_by_finite_elements(scene, brake)

    def torque_and_pressure_by_solve() -> _TorqueAndPressureOfWornLinings:
        """Torque and pressure of the unworn brake by `solve`."""
        # As in `solve`, each mesh starts from the contact set of the mesh before.
        return _torque_and_pressure_of_response(
            setup,
            solve_brake_to_tolerance(
                brake,
                DEFAULT_TOLERANCES_OF_PRESSURE_AND_TORQUE,
                FUNCTION_THAT_SOLVES_WITH_EXACT_CONTACT,
                must=False,
            ).response,
        )

    def torque_and_pressure_of_first_wear_state() -> _TorqueAndPressureOfWornLinings:
        """Torque and pressure of the first state of a wear run."""
        return _torque_and_pressure_of_wear_state(
            wear_linings_in_given_steps(setup.interfaces, WearLaw(DEFAULT_WEAR_COEFFICIENT), [])[0]
        )

    return _rows_comparing_torque_and_pressure_by_two_paths(
        name,
        "wear's start = solve",
        setup,
        (torque_and_pressure_of_first_wear_state, torque_and_pressure_by_solve),
    )


def _rows_comparing_worn_linings_with_solve(name: str, brake: Brake) -> list[TwoPathComparison]:
    """Compare worn linings with `solve` halfway, after a reversal of the drum, and at the end.

    The linings have a uniform mesh, and the drum is round.
    """
    scene = make_prepared_model(brake, elements=ELEMENTS_PER_WORN_LINING)
    setup = wear_setup_by_finite_elements(scene, brake)
    worn_in = partial(_torque_and_pressure_of_worn_in_brake, setup, scene, brake)
    try:
        states = wear_brake_linings_until_worn_in(setup)
    except NoAnswer as error:
        return _rows_comparing_torque_and_pressure_by_two_paths(
            name,
            "wear's end = worn in",
            setup,
            (partial(_raise_error_of_refused_path, error), worn_in),
        )
    ends = partial(_torque_and_pressure_of_wear_state, states[-1]), worn_in
    rows = _rows_comparing_torque_and_pressure_by_two_paths(
        name,
        "wear's end = worn in",
        setup,
        ends,
        ALLOWED_DIFFERENCE_AT_WEAR_END,
        ALLOWED_DIFFERENCE_AT_WEAR_END,
    )
    rows += _rows_comparing_torque_and_pressure_by_two_paths(
        name,
        "worn in = law",
        setup,
        (worn_in, partial(_torque_and_pressure_by_rigid_law, setup)),
        ALLOWED_TORQUE_DIFFERENCE_FROM_LAW,
        ALLOWED_PRESSURE_DISTANCE_FROM_LAW,
    )
    # If unworn linings already have the pressure of the law, the wear run ends at once. It then has
    # no worn state that could be compared.
    middle = states[len(states) // 2]
    if middle.s == 0:
        return rows
    solved = partial(
        _torque_and_pressure_of_worn_brake, setup, scene, brake_with_worn_linings(setup, middle)
    )
    middles = partial(_torque_and_pressure_of_wear_state, middle), solved
    rows += _rows_comparing_torque_and_pressure_by_two_paths(
        name, "wear's middle = solve of the worn linings", setup, middles
    )
    backward = wear_setup_by_finite_elements(scene, brake.brake_with_reversed_motion())
    return rows + _rows_comparing_wear_and_solve_after_reversal(
        name, setup, backward, scene, middle.s
    )


def _torque_and_pressure_of_worn_in_brake(
    setup: WearSetup, scene: PreparedModel, brake: Brake
) -> _TorqueAndPressureOfWornLinings:
    """Torque and pressure of a brake with worn-in linings by `solve`."""
    return _torque_and_pressure_of_worn_brake(
        setup, scene, brake_with_worn_in_clearances(scene, brake)
    )


def _torque_and_pressure_by_rigid_law(setup: WearSetup) -> _TorqueAndPressureOfWornLinings:
    """Torque and pressure that wear approaches: the rigid-shoe law on the mesh of the setup."""
    goal = final_wear_pressure_and_torque_by_rigid_shoe_law(setup)
    return _TorqueAndPressureOfWornLinings(goal.torque, goal.pressure)


def _rows_comparing_wear_and_solve_after_reversal(
    name: str, setup: WearSetup, backward: WearSetup, scene: PreparedModel, s: float
) -> list[TwoPathComparison]:
    """Compare worn linings with `solve` at the moment when the drum begins to turn back.

    Parameters
    ----------
    name : str
        Kind and seed of the brake.
    setup, backward : WearSetup
        The linings with the drum turning forward, and with the drum turning backward.
    scene : PreparedModel
        The prepared model of the brake.
    s : float
        Sliding distance before the drum turns back [m].
    """
    forward = wear_brake_linings_until_worn_in(setup, distance=s)[-1]

    def torque_and_pressure_after_reversal() -> _TorqueAndPressureOfWornLinings:
        """Torque and pressure by the wear simulation when the drum begins to turn back."""
        # The first state with the drum turning back comes before any further wear.
        states = wear_brake_linings_until_worn_in(
            setup, backward=backward, reverse=s, distance=s * (1 + 1e-9)
        )
        return _torque_and_pressure_of_wear_state(
            next(state for state in states if not state.forward)
        )

    then = partial(
        _torque_and_pressure_of_worn_brake,
        backward,
        scene,
        brake_with_worn_linings(backward, forward),
    )
    return _rows_comparing_torque_and_pressure_by_two_paths(
        name,
        "turned back = solve of the worn linings",
        backward,
        (torque_and_pressure_after_reversal, then),
    )


def _raise_error_of_refused_path(error: NoAnswer) -> _TorqueAndPressureOfWornLinings:
    """Raise `error`. This function stands in for a path of the check that has refused the brake."""
    raise error


def _torque_and_pressure_of_wear_state(state: WearState) -> _TorqueAndPressureOfWornLinings:
    """Torque and pressure of a state of the wear simulation."""
    return _TorqueAndPressureOfWornLinings(state.torque, state.pressure)


def _torque_and_pressure_of_worn_brake(
    setup: WearSetup, scene: PreparedModel, brake: Brake
) -> _TorqueAndPressureOfWornLinings:
    """Torque and pressure of a brake with worn linings, solved with exact contact."""
    return _torque_and_pressure_of_response(
        setup, FUNCTION_THAT_SOLVES_WITH_EXACT_CONTACT(scene, brake)
    )


def _torque_and_pressure_of_response(
    setup: WearSetup, response: Response
) -> _TorqueAndPressureOfWornLinings:
    """Torque, pressures and warning of round-off of a response.

    The pressures of all linings follow one another in the order of `setup.surfaces`.
    """
    by_lining = []
    for surface in setup.surfaces:
        by_lining.append(response.shoes[surface.shoe].pressure[surface.forward])
    said = next((note for note in response.notes if ITERATIVE_REFINEMENT_REMARK in note), "")
    return _TorqueAndPressureOfWornLinings(response.torque, np.concatenate(by_lining), said)


def _rows_comparing_torque_and_pressure_by_two_paths(
    brake: str,
    check: str,
    setup: WearSetup,
    paths: tuple[
        Callable[[], _TorqueAndPressureOfWornLinings], Callable[[], _TorqueAndPressureOfWornLinings]
    ],
    torque: float = ALLOWED_TORQUE_DIFFERENCE_ON_ONE_MESH,
    pressure: float = ALLOWED_PRESSURE_DISTANCE_ON_ONE_MESH,
) -> list[TwoPathComparison]:
    """Compare torque and pressure by two paths; returns a row for each of the two quantities.

    Parameters
    ----------
    brake : str
        Kind and seed of the brake.
    check : str
        Name of the check, which says what two paths are compared.
    setup : WearSetup
        The linings; the areas of their nodes weight the differences of the nodal pressures.
    paths : two functions
        Functions that return torque and pressure by each path.
    torque, pressure : float
        Allowed relative differences of torque and pressure.
    """
    answers, refusals = list[_TorqueAndPressureOfWornLinings](), list[str]()
    for path in paths:
        try:
            answers.append(path())
        except NoAnswer as error:
            refusals.append(str(error))
    # If only one path refuses the brake, its error message must have one of
    # ERROR_WORDS_OF_ALLOWED_REFUSALS_BY_ONE_PATH.
    if refusals:
        both = not answers
        tells = both or any(
            reason in refusals[0] for reason in ERROR_WORDS_OF_ALLOWED_REFUSALS_BY_ONE_PATH
        )
        said = "; ".join(refusals) if tells else ""
        return [TwoPathComparison(check, brake, "answer", math.inf, 0.0, said, refused=both)]
    first, second = answers
    said = first.said or second.said
    difference = largest_relative_pressure_difference_of_linings(
        setup, first.pressure, second.pressure
    )
    rows = [TwoPathComparison(check, brake, "pressure", difference, pressure, said)]
    # Two zero torques, without friction, agree and have no relative difference.
    if second.torque == 0:
        return rows
    difference = abs(first.torque / second.torque - 1)
    return [TwoPathComparison(check, brake, "torque", difference, torque, said), *rows]
