"""Beginning, middle and end of wear held against `solve`, the worn-in state and the law.

The unworn linings must bear as `solve` says, and so must worn ones at every distance, whichever
way the drum turns. In the end all points wear as the rigid motions of the shoe close the gap: the
pressure must be that of the linings that are set up as worn in, and both must be the rigid-shoe
law as nearly as the mesh can have it.
"""

import math
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake
from drumlin.fem.error_control.adapt import DEFAULT, adapt
from drumlin.fem.model import REFINED, respond
from drumlin.fem.preparation.prepare import prepare
from drumlin.fem.preparation.scene import PreparedModel
from drumlin.fem.solve import scene_of
from drumlin.lining_wear.archard import WearLaw, WearState, run_on
from drumlin.lining_wear.linings import WearSetup, fem_setup
from drumlin.lining_wear.run_in import (
    COEFFICIENT,
    WEAR_SETTLED,
    apart,
    run_in,
    target,
    worn,
)
from drumlin.lining_wear.worn_in import worn_in
from drumlin.response import Response
from drumlin_studies import random_brake, random_kinds
from drumlin_studies.consistency import Check

WORN_ELEMENTS = 24
"""Elements along each lining that is worn. More of them bring the end nearer to the law."""
SAME_TORQUE = 1e-6
"""Relative difference in torque of two answers on one mesh. Both are without a penalty, which wear
does without. Round-off reaches 5e-8 where a lining is much softer than its shoe."""
SAME_PRESSURE = 2e-5
"""The same of the pressure in L2, which round-off changes by up to 1e-5."""
LAW_TORQUE = 1e-3
"""Relative difference in torque of the law and the worn-in pressure on WORN_ELEMENTS; it falls with
their number squared where the law presses part of the lining, and faster elsewhere."""
LAW_PRESSURE = 0.02
"""The same of the pressure in L2. At the end of its contact the law has a kink within an
element."""
END_REACHED = 1.1 * WEAR_SETTLED
"""The same of the end of wear and its limit: WEAR_SETTLED, and a little for the mesh and the penalty."""

TRUE_REASONS = ("small displacements hold up to", "without its ever touching", "lost digits")
"""Parts of lines that refuse one way only and tell why. The first two: linings set up as worn in
leave a very soft shoe so much room that it would have to turn too far. The third: `solve` finds
that its condensed bodies have lost digits; wear does not look for lost digits."""
EXACT_CONTACT = partial(respond, penalty=math.inf)
"""How brakes are solved here: without a penalty."""


ELASTIC_ONLY_KINDS = ("table", "grip")
"""Kinds that are what they are by their elastic bodies: without these they are others."""
WEAR_KINDS = (
    *random_brake.SHAPE_KINDS,
    *random_kinds.HOLDING_KINDS,
    *(f"rigid {kind}" for kind in random_kinds.HOLDING_KINDS if kind not in ELASTIC_ONLY_KINDS),
)
"""The kinds of brakes that are drawn: those of both generators, and the second ones without
elastic bodies."""


class _Bearing(NamedTuple):
    """How linings bear: torque [N m], and pressure (n,) [Pa] at the unknowns of a setup.

    `said`: the line in which drumlin says that other ways than this one lose digits.
    """

    torque: float
    pressure: Floats
    said: str = ""


def checks(seed: int) -> list[Check]:
    """The rows of the brake of a seed; none where the generator has no brake of the seed.

    The seed modulo the number of kinds is the kind.
    """
    kind = WEAR_KINDS[seed % len(WEAR_KINDS)]
    try:
        brake = _drawn(seed, kind)
    except NoAnswer:
        return []
    name = f"{kind} {seed}"
    round_ = brake.round()
    return _beginning(name, brake) + _later(name, round_)


def _drawn(seed: int, kind: str) -> Brake:
    if kind in random_brake.SHAPE_KINDS:
        return random_brake.random_brake(seed, kind)
    return random_kinds.random_kind(
        seed, kind.removeprefix("rigid "), rigid=kind.startswith("rigid ")
    )


def _beginning(name: str, brake: Brake) -> list[Check]:
    """The unworn linings, on the division that `solve` ends on."""
    scene = scene_of(brake)
    setup = fem_setup(scene, brake)

    def solved() -> _Bearing:
        # As `solve` does it: each level begins with the contact that the level before has found.
        return _borne(setup, adapt(brake, DEFAULT, EXACT_CONTACT, must=False).response)

    def begun() -> _Bearing:
        return _of(run_on(setup.interfaces, WearLaw(COEFFICIENT), [])[0])

    return _rows(name, "wear's start = solve", setup, (begun, solved))


def _later(name: str, brake: Brake) -> list[Check]:
    """The linings on the way, turned back and in the end, on a mesh. The drum must be round."""
    scene = prepare(brake, elements=WORN_ELEMENTS)
    setup = fem_setup(scene, brake)

    def set_up() -> _Bearing:
        return _solved(setup, scene, worn_in(scene, brake))

    def by_law() -> _Bearing:
        goal = target(setup)
        return _Bearing(goal.torque, goal.pressure)

    try:
        states = run_in(setup)
    except NoAnswer as error:
        return _rows(name, "wear's end = worn in", setup, (partial(_refused, error), set_up))
    rows = _rows(
        name,
        "wear's end = worn in",
        setup,
        (partial(_of, states[-1]), set_up),
        END_REACHED,
        END_REACHED,
    )
    rows += _rows(name, "worn in = law", setup, (set_up, by_law), LAW_TORQUE, LAW_PRESSURE)
    middle = states[len(states) // 2]
    if middle.s == 0:
        return rows
    then = partial(_solved, setup, scene, worn(setup, middle))
    rows += _rows(
        name, "wear's middle = solve of the worn linings", setup, (partial(_of, middle), then)
    )
    other = brake.reversed()
    return rows + _turned_back(name, setup, fem_setup(scene, other), scene, middle.s)


def _turned_back(
    name: str, setup: WearSetup, backward: WearSetup, scene: PreparedModel, s: float
) -> list[Check]:
    """The linings as the drum begins to turn back after the distance s [m]."""
    forward = run_in(setup, distance=s)[-1]

    def turned() -> _Bearing:
        states = run_in(setup, backward=backward, reverse=s, distance=s * (1 + 1e-9))
        return _of(next(state for state in states if not state.forward))

    then = partial(_solved, backward, scene, worn(backward, forward))
    return _rows(name, "turned back = solve of the worn linings", backward, (turned, then))


def _refused(error: NoAnswer) -> _Bearing:
    raise error


def _of(state: WearState) -> _Bearing:
    return _Bearing(state.torque, state.pressure)


def _solved(setup: WearSetup, scene: PreparedModel, brake: Brake) -> _Bearing:
    """By the contact of the brake itself."""
    return _borne(setup, EXACT_CONTACT(scene, brake))


def _borne(setup: WearSetup, response: Response) -> _Bearing:
    by_lining = [
        response.shoes[surface.shoe].pressure[surface.forward] for surface in setup.surfaces
    ]
    said = next((note for note in response.notes if REFINED in note), "")
    return _Bearing(response.torque, np.concatenate(by_lining), said)


def _rows(
    brake: str,
    check: str,
    setup: WearSetup,
    ways: tuple[Callable[[], _Bearing], Callable[[], _Bearing]],
    torque: float = SAME_TORQUE,
    pressure: float = SAME_PRESSURE,
) -> list[Check]:
    """The rows of a check: torque and pressure by two ways, with the differences allowed."""
    found, refusals = list[_Bearing](), list[str]()
    for way in ways:
        try:
            found.append(way())
        except NoAnswer as error:
            refusals.append(str(error))
    if refusals:
        both = not found
        tells = both or any(reason in refusals[0] for reason in TRUE_REASONS)
        said = "; ".join(refusals) if tells else ""
        return [Check(check, brake, "answer", math.inf, 0.0, said, refused=both)]
    a, b = found
    off = apart(setup, a.pressure, b.pressure)
    rows = [Check(check, brake, "pressure", off, pressure, a.said or b.said)]
    if b.torque == 0:
        return rows
    off = abs(a.torque / b.torque - 1)
    return [Check(check, brake, "torque", off, torque, a.said or b.said), *rows]
