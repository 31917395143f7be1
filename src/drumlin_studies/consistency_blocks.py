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
from drumlin.fem.error_control.adapt import (
    DEFAULT_TOLERANCES_OF_PRESSURE_AND_TORQUE,
    solve_brake_to_tolerance,
)
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.solve import solve
from drumlin.response.response import Response, ShoeResponse
from drumlin_studies import random_brake, random_kinds
from drumlin_studies.consistency import TwoPathComparison
from drumlin_studies.random_kinds import draw_random_brake_of_kind
from drumlin_studies.stated_true import (
    QUANTITIES_WHOSE_STATED_ERRORS_ARE_JUDGED,
    FarFinerSolutionOfBrake,
    solve_fine_reference_by_hp_elements,
    true_errors_of_response,
)

NAME_OF_CHECK_WITH_BLOCK_LININGS = (
    "blocks: error stated by the default solve, error against finer levels"
)
"""Name of this check in tables."""
FEWEST_BLOCK_STEPS, MOST_BLOCK_STEPS = 7, 30
"""Smallest and largest number of steps on a lining. Each step is a row of `misfit.blocks` in the
brake file, and makes two kinks in the gap.
"""
MOST_BRAKES_WITH_BLOCKS_DRAWN_PER_SEED = 200
"""Number of brakes that are drawn for one seed before the generator gives up."""
ELEMENTS_PER_LINING_OF_FIRST_BLOCK_BRAKE_SOLVE = 40
"""Number of elements along a lining of the mesh on which a drawn brake is solved for a first look.
This solve gives the compression of the linings, and shows whether every shoe is in contact.
"""
LEAST_STEP_SPACING_OVER_STEP_ARC = 1.05
"""Smallest distance between the beginnings of two steps, relative to the short arc over which the
height changes at a step. `misfit.blocks` needs more than 1.
"""
POWERS_OF_TEN_OF_STEP_DEPTH_OVER_COMPRESSION = (-1.0, 1.0)
"""Range of the largest step's depth relative to the lining's compression, as powers of ten."""
TOLERANCE_OF_FINER_SOLUTION_WITH_BLOCKS = 2.5e-3
"""Relative tolerance of the finer solution from which true errors are taken.

The meshes of this solution are refined until p changes by a tenth of the tolerance.
"""
KINDS_OF_RANDOM_BRAKES_WITH_BLOCKS = (
    *random_brake.FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SHAPE_KIND,
    *random_kinds.FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SUPPORT_KIND,
)
"""The kinds of random brakes, in the order in which consecutive seeds draw them."""
RandomNumberGenerator = np.random.Generator
"""The type of the generators of random numbers."""


def draw_random_brake_with_blocks(seed: int, steps: int | None = None) -> Brake:
    """The random brake of a seed, with blocks on each of its linings.

    Parameters
    ----------
    seed : int
        The same seed always gives the same brake. The seed modulo the number of
        KINDS_OF_RANDOM_BRAKES_WITH_BLOCKS chooses the kind.
    steps : int, optional
        Number of steps on each lining. By default the seed gives a number from FEWEST_BLOCK_STEPS
        to MOST_BLOCK_STEPS. The number of steps changes nothing else of the brake.

    Raises
    ------
    NoAnswer
        If none of MOST_BRAKES_WITH_BLOCKS_DRAWN_PER_SEED drawn brakes has room for its steps.
    """
    kind = KINDS_OF_RANDOM_BRAKES_WITH_BLOCKS[seed % len(KINDS_OF_RANDOM_BRAKES_WITH_BLOCKS)]
    for attempt in range(MOST_BRAKES_WITH_BLOCKS_DRAWN_PER_SEED):
        rng = np.random.default_rng([seed, attempt])
        drawn = int(rng.integers(FEWEST_BLOCK_STEPS, MOST_BLOCK_STEPS + 1))
        depth = 10 ** rng.uniform(*POWERS_OF_TEN_OF_STEP_DEPTH_OVER_COMPRESSION)
        try:
            brake = draw_random_brake_of_kind(
                seed + len(KINDS_OF_RANDOM_BRAKES_WITH_BLOCKS) * (attempt + 1), kind
            )
            # The brake must have room for the number of steps that the seed gives, also if `steps`
            # is another number. The same seed then gives the same brake for any `steps`.
            found = _brake_with_random_blocks(brake, rng, drawn, depth)
            return found if steps is None else _brake_with_random_blocks(brake, rng, steps, depth)
        except (BadInput, NoAnswer):
            continue
    raise NoAnswer(
        f"no brake of kind {kind} with blocks from seed {seed} in "
        f"{MOST_BRAKES_WITH_BLOCKS_DRAWN_PER_SEED} attempts"
    )


def _brake_with_random_blocks(
    brake: Brake, rng: RandomNumberGenerator, steps: int, depth: float
) -> Brake:
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
    fitting = solve(brake, elements=ELEMENTS_PER_LINING_OF_FIRST_BLOCK_BRAKE_SOLVE)
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
    if not all(
        shoe.contact_arcs
        for shoe in solve(other, elements=ELEMENTS_PER_LINING_OF_FIRST_BLOCK_BRAKE_SOLVE).shoes
    ):
        raise NoAnswer("a shoe does not press")
    return other


def _random_start_angles_of_lining_blocks(
    rng: RandomNumberGenerator, shoe: Shoe, steps: int
) -> np.ndarray:
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


class ResponseWithStatedAndTrueErrors(NamedTuple):
    """A response with its stated errors, a far finer solution, and the response's true errors."""

    response: Response
    truth: FarFinerSolutionOfBrake
    errors: dict[str, float]


def solve_with_stated_and_true_errors(brake: Brake) -> ResponseWithStatedAndTrueErrors:
    """Solve a brake by default and on far finer meshes, and compute the true errors.

    Raises NoAnswer if either solve finds no equilibrium.
    """
    response = solve_brake_to_tolerance(
        brake, DEFAULT_TOLERANCES_OF_PRESSURE_AND_TORQUE, solve_prepared_model, must=False
    ).response
    true = solve_fine_reference_by_hp_elements(brake, TOLERANCE_OF_FINER_SOLUTION_WITH_BLOCKS)
    return ResponseWithStatedAndTrueErrors(
        response, true, true_errors_of_response(brake, response.shoes, true.shoes)
    )


def rows_comparing_stated_with_true_errors_of_block_linings(seed: int) -> list[TwoPathComparison]:
    """Compare the errors that drumlin states with true errors, for the random brake of a seed.

    Returns a row for each quantity. The allowed error is the stated error plus the uncertainty of
    the finer solution. If drumlin calls the peak pressure unbounded, its stated error is 1.
    """
    brake = draw_random_brake_with_blocks(seed)
    kinds = KINDS_OF_RANDOM_BRAKES_WITH_BLOCKS
    name = f"{kinds[seed % len(kinds)]} {seed}"
    try:
        response, truth, true_errors = solve_with_stated_and_true_errors(brake)
    except NoAnswer as error:
        return [
            TwoPathComparison(
                NAME_OF_CHECK_WITH_BLOCK_LININGS, name, "p", 0.0, 0.0, str(error), refused=True
            )
        ]
    assert response.error is not None
    rows = []
    for quantity in QUANTITIES_WHOSE_STATED_ERRORS_ARE_JUDGED:
        allowed = response.error[quantity] + truth.unsure[quantity]
        rows.append(
            TwoPathComparison(
                NAME_OF_CHECK_WITH_BLOCK_LININGS, name, quantity, true_errors[quantity], allowed
            )
        )
    return rows
