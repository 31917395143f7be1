"""The errors that the default solve states of linings of many blocks, against finer levels.

Random brakes of every kind get linings with FEWEST_BLOCK_STEPS to MOST_BLOCK_STEPS steps between
blocks. The steps are shallow or deep against the compression that the brake's own force makes, so
that in some brakes all blocks press and in others few of them do.
"""

import numpy as np

from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.file import vary
from drumlin.fem.error_control.adapt import DEFAULT, adapt
from drumlin.fem.model import respond
from drumlin.fem.solve import solve
from drumlin.response.response import Response, ShoeResponse
from drumlin_studies import random_brake, random_kinds
from drumlin_studies.consistency import Check
from drumlin_studies.stated_true import JUDGED_QUANTITIES, Truth, by_columns, errors

BLOCKS_CHECK = "blocks: error stated by the default solve, error against finer levels"
FEWEST_BLOCK_STEPS, MOST_BLOCK_STEPS = 7, 30
"""Rows of `misfit.blocks`, each of which is a step with two kinks."""
BLOCK_ATTEMPTS = 200
BLOCK_TRIAL_ELEMENTS = 40
"""Elements of the mesh that shows how far a brake is compressed, and whether it has an answer with
its blocks."""
STEP_SPACING = 1.05
"""Least distance between two steps over the arc of a step. `misfit.blocks` asks for more than 1."""
STEP_DEPTH_DECADES = (-1.0, 1.0)
"""Decades between which the largest step lies, over the compression that the brake's force
makes."""
BLOCKS_TRUTH_TOLERANCE = 2.5e-3
"""Tolerance for which finer levels are taken as true: they end where p moves by a tenth of it."""
BLOCK_KINDS = (*random_brake.SHAPE_KINDS, *random_kinds.HOLDING_KINDS)
Rng = np.random.Generator


def random_blocks(seed: int, steps: int | None = None) -> Brake:
    """The brake of a seed with blocks on each of its linings; its kind is the seed modulo the
    number of BLOCK_KINDS.

    steps: number of the steps of each lining, by default FEWEST_BLOCK_STEPS to MOST_BLOCK_STEPS of the seed. With fewer
    steps it is the same brake. Raises NoAnswer where no brake of the kind has room for its steps.
    """
    kind = BLOCK_KINDS[seed % len(BLOCK_KINDS)]
    for attempt in range(BLOCK_ATTEMPTS):
        rng = np.random.default_rng([seed, attempt])
        drawn, depth = (
            int(rng.integers(FEWEST_BLOCK_STEPS, MOST_BLOCK_STEPS + 1)),
            10 ** rng.uniform(*STEP_DEPTH_DECADES),
        )
        try:
            brake = _of_kind(seed + len(BLOCK_KINDS) * (attempt + 1), kind)
            found = _with_blocks(brake, rng, drawn, depth)
            return found if steps is None else _with_blocks(brake, rng, steps, depth)
        except (BadInput, NoAnswer):
            continue
    raise NoAnswer(
        f"no brake of kind {kind} with blocks from seed {seed} in {BLOCK_ATTEMPTS} attempts"
    )


def _of_kind(seed: int, kind: str) -> Brake:
    if kind in random_brake.SHAPE_KINDS:
        return random_brake.random_brake(seed, kind)
    return random_kinds.random_kind(seed, kind)


def _with_blocks(brake: Brake, rng: Rng, steps: int, depth: float) -> Brake:
    """The brake with so many steps on each lining, of depths up to `depth` times its compression.

    Raises BadInput where a lining has no room for them, NoAnswer where a shoe does not press or
    locks.
    """
    fitting = solve(brake, elements=BLOCK_TRIAL_ELEMENTS)
    changes: dict[str, list[list[float]]] = {}
    for i, (shoe, found) in enumerate(zip(brake.shoes, fitting.shoes, strict=True)):
        places = _places(rng, shoe, steps)
        depths = depth * _compression(brake, shoe, found) * rng.uniform(0, 1, steps)
        rows = [[float(x), float(y)] for x, y in zip(places, depths, strict=True)]
        changes[f"shoe[{i}].lining.misfit.blocks"] = rows
    other = vary(brake, changes)
    if not all(shoe.contact_arcs for shoe in solve(other, elements=BLOCK_TRIAL_ELEMENTS).shoes):
        raise NoAnswer("a shoe does not press")
    return other


def _places(rng: Rng, shoe: Shoe, steps: int) -> np.ndarray:
    """Where its blocks begin [rad]: random, with room for each step. Raises BadInput where there is
    none."""
    lining, room = shoe.lining, STEP_SPACING * shoe.lining.step
    free = lining.end - lining.start - (steps + 1) * room
    if free <= 0:
        raise BadInput(f"no room for {steps} steps")
    return lining.start + np.sort(rng.uniform(0, free, steps)) + room * np.arange(1, steps + 1)


def _compression(brake: Brake, shoe: Shoe, found: ShoeResponse) -> float:
    """How far the mean pressure of a shoe presses its lining together [m], about."""
    lining = shoe.lining
    area = brake.scale_factor * (lining.end - lining.start) * lining.width
    return found.normal_force / area * lining.thickness / lining.material.E_through


def stated_and_true(brake: Brake) -> tuple[Response, Truth, dict[str, float]]:
    """The response of a default solve, the truth by finer levels, and the errors of the one against
    the other.

    Raises NoAnswer where one of the two has none.
    """
    found = adapt(brake, DEFAULT, respond, must=False).response
    true = by_columns(brake, BLOCKS_TRUTH_TOLERANCE)
    return found, true, errors(brake, found.shoes, true.shoes)


def checks(seed: int) -> list[Check]:
    """A row for each of QUANTITIES of the brake of a seed: its true error, and the stated one that
    is allowed.

    The truth's own uncertainty is added to the stated error. A peak that is said to be unbounded
    has a stated error of 1.
    """
    brake = random_blocks(seed)
    name = f"{BLOCK_KINDS[seed % len(BLOCK_KINDS)]} {seed}"
    try:
        found, true, off = stated_and_true(brake)
    except NoAnswer as error:
        return [Check(BLOCKS_CHECK, name, "p", 0.0, 0.0, str(error), refused=True)]
    assert found.error is not None
    return [
        Check(
            BLOCKS_CHECK,
            name,
            quantity,
            off[quantity],
            found.error[quantity] + true.unsure[quantity],
        )
        for quantity in JUDGED_QUANTITIES
    ]
