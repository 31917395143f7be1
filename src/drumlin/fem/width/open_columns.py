"""Columns of elements whose face stays open: they keep the contact nodes at their two ends only.

A lining with a width often presses on half of its face or less. The contact nodes take most of the
memory and most of the time of a solve, wherever they lie. An earlier answer on coarser functions or
coarser elements shows where the face is open over the whole width. In the next solve the columns
there keep few contact nodes (`ShoeElementDivision.open_columns`).

Between the contact and an open column there is always a column with all of its nodes, which are
open, too. The weighted gap at the end of an open column is an average over this whole column, and
does not show whether the end itself would touch. The nodes of the column between do show it: if the
contact grows, they are pressed first. The brake is then solved again, with fewer open columns. As
long as they are open, the answer is the same as with all nodes. Contact that lies within one open
column, with both of its ends open, would not be seen. The first answer of a solve has all nodes,
and shows such contact.
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
"""Smallest distance of an earlier contact from an open column and from its two neighbours.

It is relative to the lining's thickness. The end of the contact may move so far until the brake is
solved again. The value is above 0, so that the brake is not solved again for ever: contact that
causes a new solve is at least so far from all earlier contact. With a smaller value more brakes are
solved again, with a larger value columns beside the contact keep nodes that they do not need.
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
    responses : earlier answers with widths, on any elements; without any, the divisions stay
    """
    if not responses:
        return dict(divisions)
    margin, found = LEAST_DISTANCE_OF_OPEN_COLUMN_FROM_CONTACT, {}
    for i, division in divisions.items():
        far = _columns_far_from_contact(brake, i, division, responses, margin)
        found[i] = replace(division, open_columns=far)
    return found


def solve_until_open_columns_stay_open(
    brake: Brake,
    expected: Sequence[Response],
    solve: Callable[[Sequence[Response]], SolvedLevel],
) -> SolvedLevel:
    """Solve a brake with open columns, and again as long as the contact comes near one of them.

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
        if not _is_contact_near_any_open_column(brake, solved):
            return solved
        answers.append(solved.response)
        # The memory of a large model is free before the next one is made.
        del solved


def _is_contact_near_any_open_column(brake: Brake, solved: SolvedLevel) -> bool:
    """Whether a node of an open column, or of a column beside it, is pressed."""
    for i, division in solved.prepared_model.divisions.items():
        if division.open_columns:
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
    """The indices of the columns under a lining that are far from all contact in all given answers.

    Parameters
    ----------
    brake : the brake
    first : index of the first shoe of a shape
    division : division of the shoes of this shape
    responses : the answers, at least one
    margin : smallest distance of the contact from the columns and their neighbours, relative to the
        lining's thickness
    """
    alike = indices_of_first_shoes_of_equal_shape(brake)
    shoes = [i for i, own in enumerate(alike) if own == first]
    far = np.ones(len(division.angles) - 1, dtype=bool)
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
    """A mask (m,) of m columns, True where neither they nor their neighbours have contact nearby.

    The contact may reach the far end of a neighbour, but must be farther than `distance` [rad] from
    all of its other nodes. `ends` (m + 1,) [rad] are the ends of the columns. All values are False
    for an answer without pressures over the width, which does not show where the face is open.
    """
    if answer.surface is None:
        return np.zeros(len(ends) - 1, dtype=bool)
    is_pressed = (answer.surface.pressure != 0).any(axis=1)
    pressed = np.sort(shoe.frame.phi_coordinates_as_list(np.asarray(answer.theta)[is_pressed]))
    # A column at an end of the lining has one neighbour. Beyond the lining there is no contact.
    start = np.concatenate([[-np.inf], ends[:-2]])
    end = np.concatenate([ends[2:], [np.inf]])
    before = np.searchsorted(pressed, start - distance + LARGEST_ROUND_OFF_OF_ANGLE)
    behind = np.searchsorted(pressed, end + distance - LARGEST_ROUND_OFF_OF_ANGLE)
    return np.asarray(before == behind)
