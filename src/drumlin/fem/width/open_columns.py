"""Columns of elements whose face stays open: they keep the contact nodes at their two ends only.

A lining with a width often presses on half of its face or less. The contact nodes take most of the
memory and most of the time of a solve, wherever they lie. An earlier answer on coarser functions or
coarser elements shows where the face is open over the whole width. In the next solve the columns
there keep few contact nodes (`ShoeElementDivision.open_columns`).

The answer is the same as with all nodes, as long as the face of the open columns stays open. If a
node at an end of an open column is pressed, the brake is solved again, with fewer open columns.
Contact that lies within one open column, with both of its ends open, would not be seen. The first
answer of a solve has all nodes, and shows such contact.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from drumlin.base.arrays import Bools, Floats
from drumlin.brake.brake import Brake, Shoe
from drumlin.fem.error_control.levels import SolvedLevel
from drumlin.fem.hp.division import ShoeElementDivision
from drumlin.fem.preparation.cache import indices_of_first_shoes_of_equal_shape
from drumlin.response.response import Response, ShoeResponse

LEAST_DISTANCE_OF_OPEN_COLUMN_FROM_CONTACT = 0.05
"""Smallest distance of an open column from an earlier contact, relative to the lining's thickness.

The end of the contact may move so far until the brake is solved again. The value changes no answer.
With a smaller value more brakes are solved again, with a larger value columns beside the contact
keep nodes that they do not need.
"""
LARGEST_ROUND_OFF_OF_ANGLE = 1e-9
"""Distance [rad] within which a node at the end of a column belongs to both neighbouring columns.

It only has to exceed round-off, and to be smaller than every column.
"""


def divisions_with_open_columns(
    brake: Brake,
    divisions: Mapping[int, ShoeElementDivision],
    responses: Sequence[Response],
) -> dict[int, ShoeElementDivision]:
    """The divisions of a brake's shoes, with the columns that were open in all earlier answers.

    Parameters
    ----------
    brake : the brake
    divisions : divisions of the sections into hp elements, by the index of the first shoe of each
        shape
    responses : earlier answers with widths, on any elements; without any, no column is open
    """
    margin = LEAST_DISTANCE_OF_OPEN_COLUMN_FROM_CONTACT
    return {
        i: replace(
            division,
            open_columns=_columns_far_from_contact(brake, i, division, responses, margin),
        )
        for i, division in divisions.items()
    }


def solve_until_open_columns_stay_open(
    brake: Brake,
    expected: Sequence[Response],
    solve: Callable[[Sequence[Response]], SolvedLevel],
) -> SolvedLevel:
    """Solve a brake with open columns, and again as long as one of them has contact.

    Parameters
    ----------
    brake : the brake
    expected : earlier answers with widths, in all of which the open columns have to be open
    solve : function that solves the brake; its argument are the answers in which columns have to be
        open

    Raises
    ------
    NoAnswer
        if `solve` raises it
    """
    answers = list(expected)
    while True:
        solved = solve(answers)
        if not _has_any_open_column_contact(brake, solved):
            return solved
        # A column with contact is no longer open, so that this happens at most once per column.
        answers.append(solved.response)
        # The memory of a large model is free before the next one is made.
        del solved


def _has_any_open_column_contact(brake: Brake, solved: SolvedLevel) -> bool:
    """Whether a node of an open column is pressed."""
    for i, division in solved.prepared_model.divisions.items():
        still_open = _columns_far_from_contact(brake, i, division, [solved.response], 0.0)
        if not set(division.open_columns) <= set(still_open):
            return True
    return False


def _columns_far_from_contact(
    brake: Brake,
    first: int,
    division: ShoeElementDivision,
    responses: Sequence[Response],
    margin: float,
) -> tuple[int, ...]:
    """The indices of the columns under a lining that are far from all contact in some answers.

    Parameters
    ----------
    brake : the brake
    first : index of the first shoe of a shape
    division : division of the shoes of this shape
    responses : the answers; without any, the result is empty
    margin : smallest distance of the columns from the contact, relative to the lining's thickness
    """
    alike = indices_of_first_shoes_of_equal_shape(brake)
    shoes = [i for i, own in enumerate(alike) if own == first]
    far = np.full(len(division.angles) - 1, bool(responses))
    distance = margin * brake.shoes[first].lining.thickness / brake.size
    for response in responses:
        for i in shoes:
            far &= _which_columns_are_far_from_contact(
                brake.shoes[i], response.shoes[i], division.angles, distance
            )
    return tuple(np.flatnonzero(far).tolist())


def _which_columns_are_far_from_contact(
    shoe: Shoe, answer: ShoeResponse, ends: Floats, distance: float
) -> Bools:
    """A mask (m,) of m columns: True where no node within a distance [rad] is pressed.

    `ends` (m + 1,) [rad] are the ends of the columns. All values are False for an answer without
    pressures over the width, which does not show where the face is open.
    """
    if answer.surface is None:
        return np.zeros(len(ends) - 1, dtype=bool)
    is_pressed = (answer.surface.pressure != 0).any(axis=1)
    pressed = np.sort(shoe.frame.phi_coordinates_as_list(np.asarray(answer.theta)[is_pressed]))
    reach = distance + LARGEST_ROUND_OFF_OF_ANGLE
    before = np.searchsorted(pressed, ends[:-1] - reach)
    behind = np.searchsorted(pressed, ends[1:] + reach)
    return np.asarray(before == behind)
