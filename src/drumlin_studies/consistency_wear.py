"""Checks beginning, middle and end of wear against `solve`, the worn-in state and the law.

Unworn linings must have the torque and the pressure of `solve`. So must worn linings, at every
distance and in both senses of rotation. At the end all points wear at the rate at which a
rigid-body motion of the shoe closes the gap. The pressure must then be that of the worn-in state,
and both must be that of the rigid-shoe law, within the error of the mesh.
"""

import math
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake
from drumlin.fem.error_control.adapt import DEFAULT_TOLERANCE, solve_to_tolerance
from drumlin.fem.model import REFINED_REMARK, solve_prepared_model
from drumlin.fem.preparation.prepare import prepare
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.fem.solve import prepare_finest_division
from drumlin.lining_wear.archard import WearLaw, WearState, wear_linings_in_given_steps
from drumlin.lining_wear.linings import WearSetup, fem_wear_setup
from drumlin.lining_wear.run_in import (
    COEFFICIENT,
    WEAR_SETTLED,
    brake_with_worn_linings,
    pressure_distance,
    rigid_law_target,
    run_in,
)
from drumlin.lining_wear.worn_in import worn_in_brake
from drumlin.response import Response
from drumlin_studies import random_brake, random_kinds
from drumlin_studies.consistency import Check

WORN_ELEMENTS = 24
"""Elements along each worn lining. With more elements the end is nearer to the law."""
SAME_TORQUE = 1e-6
"""Allowed relative difference of the torques of two answers on one mesh.

Both answers have exact contact. Round-off reaches 5e-8 where a lining is much softer than its shoe.
"""
SAME_PRESSURE = 2e-5
"""Allowed relative L2 difference of the pressures on one mesh. Round-off reaches 1e-5."""
LAW_TORQUE = 1e-3
"""Allowed relative difference of the torques by the law and in the worn-in state.

With WORN_ELEMENTS it is the error of the mesh. It falls with the square of their number where the
law has partial contact, and faster elsewhere.
"""
LAW_PRESSURE = 0.02
"""Allowed relative L2 difference of the pressures by the law and in the worn-in state.

The pressure of the law has a kink at the end of its contact, within an element.
"""
END_REACHED = 1.1 * WEAR_SETTLED
"""Allowed difference of torque and pressure at the end of wear from its limit.

Wear ends at a difference of WEAR_SETTLED. The factor allows for the mesh and the penalty.
"""

TRUE_REASONS = ("small displacements hold up to", "without its ever touching", "lost digits")
"""Words of lines that refuse one path only and give a valid reason.

By the first two, a worn-in lining leaves a very soft shoe so much clearance that it would have to
turn too far. By the third, `solve` finds that static condensation has lost digits, which wear does
not check.
"""
EXACT_CONTACT = partial(solve_prepared_model, penalty=math.inf)
"""Solves a brake without a penalty, as wear does."""
ELASTIC_ONLY_KINDS = ("table", "grip")
"""Kinds that need their elastic bodies: without them they would be brakes of another kind."""
WEAR_KINDS = (
    *random_brake.SHAPE_KINDS,
    *random_kinds.HOLDING_KINDS,
    *(f"rigid {kind}" for kind in random_kinds.HOLDING_KINDS if kind not in ELASTIC_ONLY_KINDS),
)
"""The kinds that are drawn: those of both generators, and HOLDING_KINDS without elastic bodies."""


class _TorqueAndPressure(NamedTuple):
    """Torque and pressure of worn linings by one path.

    Attributes
    ----------
    torque : float
        Torque [N m].
    pressure : array (n,)
        Pressure at the unknowns of a setup [Pa].
    said : str
        The line in which drumlin tells that other paths lose digits.
    """

    torque: float
    pressure: Floats
    said: str = ""


def wear_rows(seed: int) -> list[Check]:
    """The rows of the brake of a seed. The seed modulo the number of WEAR_KINDS chooses the kind.

    There are no rows where the generator has no brake of the seed.
    """
    kind = WEAR_KINDS[seed % len(WEAR_KINDS)]
    try:
        brake = _draw_brake(seed, kind)
    except NoAnswer:
        return []
    name = f"{kind} {seed}"
    return _rows_of_start(name, brake) + _rows_of_wear(name, brake.round())


def _draw_brake(seed: int, kind: str) -> Brake:
    """The brake of a seed and one of WEAR_KINDS."""
    if kind.startswith("rigid "):
        return random_kinds.draw_brake_of_holding_kind(
            seed, kind.removeprefix("rigid "), rigid=True
        )
    return random_kinds.draw_brake_of_kind(seed, kind)


def _rows_of_start(name: str, brake: Brake) -> list[Check]:
    """Rows of the unworn linings, on the last division of `solve`."""
    scene = prepare_finest_division(brake)
    setup = fem_wear_setup(scene, brake)

    def answer_by_solve() -> _TorqueAndPressure:
        """Torque and pressure of the unworn brake by a solve."""
        # As in `solve`, each level starts from the contact set of the level before.
        return _response_torque_and_pressure(
            setup, solve_to_tolerance(brake, DEFAULT_TOLERANCE, EXACT_CONTACT, must=False).response
        )

    def answer_at_start_of_wear() -> _TorqueAndPressure:
        """Torque and pressure of the first state of a wear run."""
        return _state_torque_and_pressure(
            wear_linings_in_given_steps(setup.interfaces, WearLaw(COEFFICIENT), [])[0]
        )

    return _comparison_rows(
        name, "wear's start = solve", setup, (answer_at_start_of_wear, answer_by_solve)
    )


def _rows_of_wear(name: str, brake: Brake) -> list[Check]:
    """Rows of the worn linings: halfway, after the drum has turned back, and at the end of wear.

    The linings are on a mesh, and the drum is round.
    """
    scene = prepare(brake, elements=WORN_ELEMENTS)
    setup = fem_wear_setup(scene, brake)

    def answer_of_worn_in_brake() -> _TorqueAndPressure:
        """Torque and pressure of the worn-in brake by its contact."""
        return _contact_torque_and_pressure(setup, scene, worn_in_brake(scene, brake))

    def answer_by_law() -> _TorqueAndPressure:
        """Torque and pressure that wear tends to on this mesh."""
        goal = rigid_law_target(setup)
        return _TorqueAndPressure(goal.torque, goal.pressure)

    try:
        states = run_in(setup)
    except NoAnswer as error:
        return _comparison_rows(
            name,
            "wear's end = worn in",
            setup,
            (partial(_raise_refusal, error), answer_of_worn_in_brake),
        )
    ends = partial(_state_torque_and_pressure, states[-1]), answer_of_worn_in_brake
    rows = _comparison_rows(name, "wear's end = worn in", setup, ends, END_REACHED, END_REACHED)
    rows += _comparison_rows(
        name,
        "worn in = law",
        setup,
        (answer_of_worn_in_brake, answer_by_law),
        LAW_TORQUE,
        LAW_PRESSURE,
    )
    # Linings that fit the law from the start have no middle of wear.
    middle = states[len(states) // 2]
    if middle.s == 0:
        return rows
    solved = partial(
        _contact_torque_and_pressure, setup, scene, brake_with_worn_linings(setup, middle)
    )
    middles = partial(_state_torque_and_pressure, middle), solved
    rows += _comparison_rows(name, "wear's middle = solve of the worn linings", setup, middles)
    backward = fem_wear_setup(scene, brake.reversed())
    return rows + _rows_after_reversal(name, setup, backward, scene, middle.s)


def _rows_after_reversal(
    name: str, setup: WearSetup, backward: WearSetup, scene: PreparedModel, s: float
) -> list[Check]:
    """Rows of the linings as the drum begins to turn back.

    Parameters
    ----------
    name : str
        Kind and seed.
    setup, backward : WearSetup
        The linings as the drum turns forward and backward.
    scene : PreparedModel
        The prepared model of the brake.
    s : float
        Sliding distance before the drum turns back [m].
    """
    forward = run_in(setup, distance=s)[-1]

    def answer_after_reversal() -> _TorqueAndPressure:
        """Torque and pressure by wear as the drum begins to turn back."""
        # The first state backward follows at once, before the drum wears the linings further.
        states = run_in(setup, backward=backward, reverse=s, distance=s * (1 + 1e-9))
        return _state_torque_and_pressure(next(state for state in states if not state.forward))

    then = partial(
        _contact_torque_and_pressure, backward, scene, brake_with_worn_linings(backward, forward)
    )
    return _comparison_rows(
        name, "turned back = solve of the worn linings", backward, (answer_after_reversal, then)
    )


def _raise_refusal(error: NoAnswer) -> _TorqueAndPressure:
    """Raise the error of a path that has no answer, in place of its torque and pressure."""
    raise error


def _state_torque_and_pressure(state: WearState) -> _TorqueAndPressure:
    """Torque and pressure of a state of wear."""
    return _TorqueAndPressure(state.torque, state.pressure)


def _contact_torque_and_pressure(
    setup: WearSetup, scene: PreparedModel, brake: Brake
) -> _TorqueAndPressure:
    """Torque and pressure by the contact of a brake whose linings are worn."""
    return _response_torque_and_pressure(setup, EXACT_CONTACT(scene, brake))


def _response_torque_and_pressure(setup: WearSetup, response: Response) -> _TorqueAndPressure:
    """Torque and pressure of a response, at the unknowns of a setup."""
    by_lining = []
    for surface in setup.surfaces:
        by_lining.append(response.shoes[surface.shoe].pressure[surface.forward])
    said = next((note for note in response.notes if REFINED_REMARK in note), "")
    return _TorqueAndPressure(response.torque, np.concatenate(by_lining), said)


def _comparison_rows(
    brake: str,
    check: str,
    setup: WearSetup,
    paths: tuple[Callable[[], _TorqueAndPressure], Callable[[], _TorqueAndPressure]],
    torque: float = SAME_TORQUE,
    pressure: float = SAME_PRESSURE,
) -> list[Check]:
    """The rows of a check: torque and pressure by two paths.

    Parameters
    ----------
    brake : str
        Kind and seed.
    check : str
        Which paths are compared.
    setup : WearSetup
        The linings, whose areas weigh the difference of pressures.
    paths : two functions
        Torque and pressure by each path.
    torque, pressure : float
        Allowed relative differences.
    """
    answers, refusals = list[_TorqueAndPressure](), list[str]()
    for path in paths:
        try:
            answers.append(path())
        except NoAnswer as error:
            refusals.append(str(error))
    # A refusal by one path alone needs one of the valid reasons.
    if refusals:
        both = not answers
        tells = both or any(reason in refusals[0] for reason in TRUE_REASONS)
        said = "; ".join(refusals) if tells else ""
        return [Check(check, brake, "answer", math.inf, 0.0, said, refused=both)]
    first, second = answers
    said = first.said or second.said
    difference = pressure_distance(setup, first.pressure, second.pressure)
    rows = [Check(check, brake, "pressure", difference, pressure, said)]
    # Two zero torques, without friction, agree and have no relative difference.
    if second.torque == 0:
        return rows
    difference = abs(first.torque / second.torque - 1)
    return [Check(check, brake, "torque", difference, torque, said), *rows]
