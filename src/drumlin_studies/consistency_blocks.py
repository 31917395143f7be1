"""The errors that the default solve states of linings of many blocks, against finer levels.

Random brakes of every kind get linings with FEWEST_BLOCK_STEPS to MOST_BLOCK_STEPS steps between
blocks. The steps are shallow or deep against the compression that the brake's own force makes, so
that in some brakes all blocks press and in others few of them do.
"""

from typing import NamedTuple

import numpy as np

from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.file import vary
from drumlin.fem.error_control.adapt import DEFAULT_TOLERANCE, solve_to_tolerance
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.solve import solve
from drumlin.response.response import Response, ShoeResponse
from drumlin_studies import random_brake, random_kinds
from drumlin_studies.consistency import Check
from drumlin_studies.random_kinds import draw_brake_of_kind
from drumlin_studies.stated_true import JUDGED_QUANTITIES, Truth, true_errors, truth_by_hp_elements

BLOCKS_CHECK = "blocks: error stated by the default solve, error against finer levels"
"""Name of the check in rows."""
FEWEST_BLOCK_STEPS, MOST_BLOCK_STEPS = 7, 30
"""Smallest and largest number of rows of `misfit.blocks`. Each row is a step with two kinks."""
BLOCK_ATTEMPTS = 200
"""Draws for one seed before the generator gives up."""
BLOCK_TRIAL_ELEMENTS = 40
"""Elements of the mesh that shows how far a lining is compressed and whether all shoes press."""
STEP_SPACING = 1.05
"""Smallest distance between two steps, over the arc of a step. `misfit.blocks` needs more than 1.
"""
STEP_DEPTH_DECADES = (-1.0, 1.0)
"""Range of the largest step over the compression by the brake's force, as powers of ten."""
BLOCKS_TRUTH_TOLERANCE = 2.5e-3
"""Tolerance of the finer levels that serve as truth. They end where p changes by a tenth of it."""
BLOCK_KINDS = (*random_brake.SHAPE_KINDS, *random_kinds.HOLDING_KINDS)
"""The kinds of both generators, in the order in which seeds draw them."""
Rng = np.random.Generator


def random_blocks(seed: int, steps: int | None = None) -> Brake:
    """The brake of a seed with blocks on each of its linings.

    Parameters
    ----------
    seed : int
        The same seed always gives the same brake. The seed modulo the number of BLOCK_KINDS chooses
        the kind.
    steps : int, optional
        Number of steps on each lining, by default FEWEST_BLOCK_STEPS to MOST_BLOCK_STEPS by the
        seed. Another number of steps does not change the brake behind them.

    Raises
    ------
    NoAnswer
        No brake of the kind has room for its steps in BLOCK_ATTEMPTS draws.
    """
    kind = BLOCK_KINDS[seed % len(BLOCK_KINDS)]
    for attempt in range(BLOCK_ATTEMPTS):
        rng = np.random.default_rng([seed, attempt])
        drawn = int(rng.integers(FEWEST_BLOCK_STEPS, MOST_BLOCK_STEPS + 1))
        depth = 10 ** rng.uniform(*STEP_DEPTH_DECADES)
        try:
            brake = draw_brake_of_kind(seed + len(BLOCK_KINDS) * (attempt + 1), kind)
            # The drawn number of steps must fit, so that `steps` never changes the brake.
            found = _with_blocks(brake, rng, drawn, depth)
            return found if steps is None else _with_blocks(brake, rng, steps, depth)
        except (BadInput, NoAnswer):
            continue
    raise NoAnswer(
        f"no brake of kind {kind} with blocks from seed {seed} in {BLOCK_ATTEMPTS} attempts"
    )


def _with_blocks(brake: Brake, rng: Rng, steps: int, depth: float) -> Brake:
    """The brake with steps on each lining.

    Parameters
    ----------
    brake : Brake
        The brake without blocks.
    rng : numpy.random.Generator
        What places and depths are drawn from.
    steps : int
        Number of steps on each lining.
    depth : float
        Largest depth of a step, over the compression of the lining.

    Raises
    ------
    BadInput
        A lining has no room for the steps.
    NoAnswer
        A shoe does not press or locks.
    """
    fitting = solve(brake, elements=BLOCK_TRIAL_ELEMENTS)
    changes: dict[str, list[list[float]]] = {}
    for i, (shoe, found) in enumerate(zip(brake.shoes, fitting.shoes, strict=True)):
        places = _step_places(rng, shoe, steps)
        depths = depth * _mean_compression(brake, shoe, found) * rng.uniform(0, 1, steps)
        changes[f"shoe[{i}].lining.misfit.blocks"] = np.column_stack([places, depths]).tolist()
    other = vary(brake, changes)
    # Every shoe must press, because a shoe that does not touch would have no error to judge.
    if not all(shoe.contact_arcs for shoe in solve(other, elements=BLOCK_TRIAL_ELEMENTS).shoes):
        raise NoAnswer("a shoe does not press")
    return other


def _step_places(rng: Rng, shoe: Shoe, steps: int) -> np.ndarray:
    """Random beginnings of the blocks of a lining (steps,) [rad], with room for each step.

    Raises BadInput where the lining is too short.
    """
    lining, room = shoe.lining, STEP_SPACING * shoe.lining.step
    free = lining.end - lining.start - (steps + 1) * room
    if free <= 0:
        raise BadInput(f"no room for {steps} steps")
    # Sorted places in the free arc, each moved on by the room of the steps before it.
    return lining.start + np.sort(rng.uniform(0, free, steps)) + room * np.arange(1, steps + 1)


def _mean_compression(brake: Brake, shoe: Shoe, found: ShoeResponse) -> float:
    """Compression of a lining by the mean pressure of its shoe [m]."""
    lining = shoe.lining
    area = brake.scale_factor * (lining.end - lining.start) * lining.width
    return found.normal_force / area * lining.thickness / lining.material.E_through


class StatedAndTrue(NamedTuple):
    """A response, the truth of its brake, and its errors against the truth by JUDGED_QUANTITIES."""

    response: Response
    truth: Truth
    errors: dict[str, float]


def stated_and_true_errors(brake: Brake) -> StatedAndTrue:
    """The default solve of a brake and its truth by finer levels.

    Raises NoAnswer where the solve or the truth has no answer.
    """
    response = solve_to_tolerance(
        brake, DEFAULT_TOLERANCE, solve_prepared_model, must=False
    ).response
    true = truth_by_hp_elements(brake, BLOCKS_TRUTH_TOLERANCE)
    return StatedAndTrue(response, true, true_errors(brake, response.shoes, true.shoes))


def block_error_rows(seed: int) -> list[Check]:
    """A row for each of JUDGED_QUANTITIES of the brake of a seed: true against stated error.

    The stated error plus the uncertainty of the truth is the allowed difference. The stated error
    of a peak that drumlin calls unbounded is 1.
    """
    brake = random_blocks(seed)
    name = f"{BLOCK_KINDS[seed % len(BLOCK_KINDS)]} {seed}"
    try:
        response, truth, true_errors = stated_and_true_errors(brake)
    except NoAnswer as error:
        return [Check(BLOCKS_CHECK, name, "p", 0.0, 0.0, str(error), refused=True)]
    assert response.error is not None
    rows = []
    for quantity in JUDGED_QUANTITIES:
        allowed = response.error[quantity] + truth.unsure[quantity]
        rows.append(Check(BLOCKS_CHECK, name, quantity, true_errors[quantity], allowed))
    return rows
