"""Checks the errors that drumlin states, for linings that are divided into many blocks.

Random brakes of every kind get linings with FEWEST_BLOCK_STEPS to MOST_BLOCK_STEPS steps in the
height of their surface, one at the beginning of each block. The steps are smaller or larger than
the compression of the lining under load, so that in some brakes all blocks press on the drum and in
others only a few. The errors that drumlin states are compared with true errors: the differences
from a far finer solution.
"""

from typing import NamedTuple

import numpy as np

from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.file import vary
from drumlin.fem.error_control.adapt import DEFAULT_TOLERANCE, solve_brake_to_tolerance
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.solve import solve
from drumlin.response.response import Response, ShoeResponse
from drumlin_studies import random_brake, random_kinds
from drumlin_studies.consistency import TwoPathComparison
from drumlin_studies.random_kinds import draw_random_brake_of_kind
from drumlin_studies.stated_true import (
    JUDGED_QUANTITIES,
    Truth,
    solve_fine_reference_by_hp_elements,
    true_errors_of_response,
)

BLOCKS_CHECK = "blocks: error stated by the default solve, error against finer levels"
"""Name of this check in tables."""
FEWEST_BLOCK_STEPS, MOST_BLOCK_STEPS = 7, 30
"""Smallest and largest number of steps on a lining. Each step is a row of `misfit.blocks` in the
brake file, and makes two kinks in the gap.
"""
BLOCK_ATTEMPTS = 200
"""Number of brakes that are drawn for one seed before the generator gives up."""
BLOCK_TRIAL_ELEMENTS = 40
"""Number of elements along a lining of the mesh on which a drawn brake is solved for a first look.
This solve gives the compression of the linings, and shows whether every shoe is in contact.
"""
LEAST_STEP_SPACING_OVER_STEP_ARC = 1.05
"""Smallest distance between the beginnings of two steps, relative to the short arc over which the
height changes at a step. `misfit.blocks` needs more than 1.
"""
LARGEST_STEP_DEPTH_DECADES = (-1.0, 1.0)
"""Range of the largest step's depth relative to the lining's compression, as powers of ten."""
BLOCKS_TRUTH_TOLERANCE = 2.5e-3
"""Relative tolerance of the finer solution from which true errors are taken.

The meshes of this solution are refined until p changes by a tenth of the tolerance.
"""
BLOCK_KINDS = (*random_brake.DRAW_BY_SHAPE_KIND, *random_kinds.DRAW_BY_SUPPORT_KIND)
"""The kinds of random brakes, in the order in which consecutive seeds draw them."""
Rng = np.random.Generator
"""The type of the generators of random numbers."""


def draw_random_brake_with_blocks(seed: int, steps: int | None = None) -> Brake:
    """The random brake of a seed, with blocks on each of its linings.

    Parameters
    ----------
    seed : int
        The same seed always gives the same brake. The seed modulo the number of BLOCK_KINDS chooses
        the kind.
    steps : int, optional
        Number of steps on each lining. By default the seed gives a number from FEWEST_BLOCK_STEPS
        to MOST_BLOCK_STEPS. The number of steps changes nothing else of the brake.

    Raises
    ------
    NoAnswer
        If none of BLOCK_ATTEMPTS drawn brakes has room for its steps.
    """
    kind = BLOCK_KINDS[seed % len(BLOCK_KINDS)]
    for attempt in range(BLOCK_ATTEMPTS):
        rng = np.random.default_rng([seed, attempt])
        drawn = int(rng.integers(FEWEST_BLOCK_STEPS, MOST_BLOCK_STEPS + 1))
        depth = 10 ** rng.uniform(*LARGEST_STEP_DEPTH_DECADES)
        try:
            brake = draw_random_brake_of_kind(seed + len(BLOCK_KINDS) * (attempt + 1), kind)
            # The brake must have room for the number of steps that the seed gives, also if `steps`
            # is another number. The same seed then gives the same brake for any `steps`.
            found = _brake_with_random_blocks(brake, rng, drawn, depth)
            return found if steps is None else _brake_with_random_blocks(brake, rng, steps, depth)
        except (BadInput, NoAnswer):
            continue
    raise NoAnswer(
        f"no brake of kind {kind} with blocks from seed {seed} in {BLOCK_ATTEMPTS} attempts"
    )


def _brake_with_random_blocks(brake: Brake, rng: Rng, steps: int, depth: float) -> Brake:
    """A copy of the brake with random steps between blocks on each lining.

    Parameters
    ----------
    brake : Brake
        The brake without blocks.
    rng : numpy.random.Generator
        Random numbers that give the places and depths of the steps.
    steps : int
        Number of steps on each lining.
    depth : float
        Largest depth of a step, relative to the compression of the lining under load.

    Raises
    ------
    BadInput
        If a lining has no room for the steps.
    NoAnswer
        If a shoe does not touch the drum or locks itself.
    """
    fitting = solve(brake, elements=BLOCK_TRIAL_ELEMENTS)
    changes: dict[str, list[list[float]]] = {}
    for i, (shoe, found) in enumerate(zip(brake.shoes, fitting.shoes, strict=True)):
        places = _random_start_angles_of_lining_blocks(rng, shoe, steps)
        depths = (
            depth
            * _lining_compression_under_mean_pressure(brake, shoe, found)
            * rng.uniform(0, 1, steps)
        )
        changes[f"shoe[{i}].lining.misfit.blocks"] = np.column_stack([places, depths]).tolist()
    other = vary(brake, changes)
    # A shoe that does not touch the drum would have no error to compare.
    if not all(shoe.contact_arcs for shoe in solve(other, elements=BLOCK_TRIAL_ELEMENTS).shoes):
        raise NoAnswer("a shoe does not press")
    return other


def _random_start_angles_of_lining_blocks(rng: Rng, shoe: Shoe, steps: int) -> np.ndarray:
    """Random angles (steps,) [rad] where a lining's blocks begin, with room for a step at each.

    Raises BadInput if the lining is too short for the steps.
    """
    lining, room = (
        shoe.lining,
        LEAST_STEP_SPACING_OVER_STEP_ARC * shoe.lining.length_of_step_between_blocks,
    )
    free = lining.end - lining.start - (steps + 1) * room
    if free <= 0:
        raise BadInput(f"no room for {steps} steps")
    # Sorted random angles in the arc that the steps leave free. Each angle is shifted by the room
    # of the steps before it.
    return lining.start + np.sort(rng.uniform(0, free, steps)) + room * np.arange(1, steps + 1)


def _lining_compression_under_mean_pressure(brake: Brake, shoe: Shoe, found: ShoeResponse) -> float:
    """Compression [m] of a lining under the mean pressure on it."""
    lining = shoe.lining
    area = brake.length_per_surface_coordinate * (lining.end - lining.start) * lining.width
    return found.normal_force / area * lining.thickness / lining.material.E_through


class StatedAndTrue(NamedTuple):
    """A response with its stated errors, a far finer solution, and the response's true errors."""

    response: Response
    truth: Truth
    errors: dict[str, float]


def solve_with_stated_and_true_errors(brake: Brake) -> StatedAndTrue:
    """Solve a brake by default and on far finer meshes, and compute the true errors.

    Raises NoAnswer if either solve finds no equilibrium.
    """
    response = solve_brake_to_tolerance(
        brake, DEFAULT_TOLERANCE, solve_prepared_model, must=False
    ).response
    true = solve_fine_reference_by_hp_elements(brake, BLOCKS_TRUTH_TOLERANCE)
    return StatedAndTrue(response, true, true_errors_of_response(brake, response.shoes, true.shoes))


def rows_comparing_stated_with_true_errors_of_block_linings(seed: int) -> list[TwoPathComparison]:
    """Compare the errors that drumlin states with true errors, for the random brake of a seed.

    Returns a row for each quantity. The allowed error is the stated error plus the uncertainty of
    the finer solution. If drumlin calls the peak pressure unbounded, its stated error is 1.
    """
    brake = draw_random_brake_with_blocks(seed)
    name = f"{BLOCK_KINDS[seed % len(BLOCK_KINDS)]} {seed}"
    try:
        response, truth, true_errors = solve_with_stated_and_true_errors(brake)
    except NoAnswer as error:
        return [TwoPathComparison(BLOCKS_CHECK, name, "p", 0.0, 0.0, str(error), refused=True)]
    assert response.error is not None
    rows = []
    for quantity in JUDGED_QUANTITIES:
        allowed = response.error[quantity] + truth.unsure[quantity]
        rows.append(TwoPathComparison(BLOCKS_CHECK, name, quantity, true_errors[quantity], allowed))
    return rows
