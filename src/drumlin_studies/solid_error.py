"""Compare the stated errors of solid shoes with their true errors, on random brakes.

    python -m drumlin_studies.solid_error KIND FIRST LAST FILE [TOLERANCE [SECONDS]]

solves the brakes of the seeds FIRST to LAST - 1 to TOLERANCE (by default 0.01) by
`solve_brake_with_widths_to_tolerance`. It appends a line of JSON for each brake to FILE, and skips
brakes that FILE already has, so that a long comparison can be made piece by piece. It prints a line
for each new brake and three tables on all brakes of FILE: the ratios of stated to true errors, the
brakes that reach the tolerance, and the ratios for the errors that a solve by plane stress states
for its neglect of the widths. A brake has three steps: the answer, its truth, and plane stress.
They are given up after SECONDS of processor time together (by default 120). KIND is a name in
FUNCTIONS_THAT_DRAW_BRAKES_BY_SOLID_KIND:

- "free": brakes of draw_random_brake whose shoes have parts of several widths
- "built": steel shoes with a table under the lining and a web, as they are built. The table is as
  wide as the lining and 1/30 to 1/8 of this width thick. The web is 1/12 to 1/4 as wide.
- "one": brakes of draw_random_brake, with bodies made as wide as the linings

The true errors are distances from a reference solution, the truth. A solve with fine elements in
the section (the plane of the drum) and a high degree across the width would take minutes. Therefore
the truth is a sum of two parts. The first part is the answer on the first level of the section's hp
elements, on fine pieces across the width (`functions_across_width_on_fine_pieces`). The second part
is a difference of two answers on pieces that are cut once, with degree
DEGREE_ACROSS_WIDTH_IN_SECOND_PART_OF_TRUTH across the width: the answer on the level after the
level of the judged solve, minus the answer on the first level.

Two differences add up to the uncertainty of the truth: the distance between the fine pieces
and the same pieces with one degree less, and the distance between the truth and a truth whose
second part has one degree less across the width. The second distance shows how much the error of
the section's elements depends on the degree. The error of these elements on the finest level is not
contained.

The present code splits the pieces across the width where p is least exact (`fem.width.pieces`), has
columns of equal width where an end of the contact moves across the width, and has the interface
layers of the level before (`fem.width.levels`). Without open columns it was judged on brakes to
which no number of the code is fitted ("built" 510120 to 510129, "free" 510120 to 510143; three of
them are of another kind, and one has no answer). Of these 30 brakes 26 stated 1 % (8 of 10 "built",
18 of 20 "free"); the other four stated 1.6 to 3.0 %. Of the 80 stated errors with a true error
above zero, 77 are at least as large as the true errors. The other three are of p. Two of them are
uncertain: 0.7 % stated and 1.1 +- 1.6 % true ("free" 510134), and 0.78 of a true error with an
uncertainty of its own size ("free" 510135). The third one is 0.90 of the true error ("free"
510139). The medians of stated over true errors are 2.9 for p and 3.3 for torques of "built" brakes,
and 2.0 and 2.6 for "free" ones.

With open columns (`fem.width.open_columns`), which need less memory, "free" 510124 states 0.98 %,
and "built" 510123 1.03 %. This code was judged on further brakes. Of "built" 510130 to 510139 and
510163 to 510180, 27 of 28 state 1 % (96 %), and "built" 510165 states 1.3 %. Of "free" 510144 to
510155 and 510163 to 510180, 21 of 24 do so (88 %); six of these seeds are brakes of another kind.
"free" 510168 states 1.4 %, and 510149 and 510151, which press with a corner, state 3.6 and 72 %.
Sixteen of these brakes have a truth (up to "built" 510139 and "free" 510155). All 47 stated errors
are at least as large as the true errors, with medians of 2.4 for p and 3.0 for forces.

An earlier code, with the interface layers of plane stress and smaller factors, let 28 of 37 brakes
state 1 % ("built" and "free" from 510091 to 510115). The present code lets "built" 510092, 510112
and 510114 do so as well, at 0.6 to 0.8 %, and "free" 510093 and 510094, at 0.8 %. Four brakes still
state 1.3 % or more: "built" 510115, and "free" 510102, 510104 and 510111. On "free" 510104 the
contact presses with a corner, on too short a length for the elements. On the others better elements
or pieces would take more than MOST_BYTES_OF_SOLID.

Of three brakes the truth has more than 3200 nodes on a contact face, and was refused before
MOST_CONTACT_NODES_OF_TRUTH allowed it ("built" 510102, "free" 510076 and 510101). They reach 1 % by
true errors, and their stated errors are larger than the true ones by 1.6 to 4.6 times. The truths
take up to 1.8 GB and 2 minutes.

On "free" 510102, a brake with a short contact, the error of the section's elements was stated too
small. On the first two levels the reaction differs by 0.003 % with the degree 1 across the width
that the estimate has, by 0.020 % with degree 2, and by 0.034 % with degree 2 on pieces that are cut
once. An earlier code stated 0.009 % and had a true error of 0.034 +- 0.017 %. The present code
takes finer elements there, states 0.003 %, and has a true error of 0.012 +- 0.018 %. Five other
brakes with short contacts ("free" 1406 to 1438) need factors of at most 0.93 on the estimated
errors of their forces, where this brake needs 4.3.

An earlier code, without such columns, let 18 of these 32 brakes state 1 %. One that raised the
degree across the whole width let 28 of 52 brakes state 1 % ("built" 510030 to 510058, "free" 510030
to 510059), took up to 1.4 GB, and stated a fifth of an error of plane stress (p of "free" 510048).
"""

import json
import math
import signal
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field, replace
from functools import partial
from itertools import pairwise
from pathlib import Path
from types import FrameType
from typing import NamedTuple

import numpy as np

from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.file import vary
from drumlin.fem.error_control.adapt import TolerancesOfPressureAndTorque
from drumlin.fem.error_control.levels import REFINEMENT_LEVELS_FROM_COARSE_TO_FINE
from drumlin.fem.hp.division import RefinementLevel
from drumlin.fem.solve import solve
from drumlin.fem.width.error import relative_distance_of_plane_stress_from_width_solution
from drumlin.fem.width.functions import (
    FunctionsAcrossWidth,
    has_parts_of_different_widths,
    piece_ends_across_half_width_of_shoe,
)
from drumlin.fem.width.ladder import (
    solve_brake_with_widths_to_tolerance,
    solve_cross_section_mesh_with_width_degree,
)
from drumlin.fem.width.pieces import PLACE_OF_CUT_IN_FIRST_PIECE
from drumlin.fem.width.prepare import reason_why_width_model_does_not_apply
from drumlin.response.response import Response, ShoeResponse
from drumlin.response.resultants import gauss_lobatto_points
from drumlin_studies.random_brake import draw_random_brake
from drumlin_studies.width_error import KINDS_OF_RANDOM_BRAKES_ON_RIGID_DRUM

DEGREE_OF_POLYNOMIAL_PIECES_ACROSS_TRUTH_WIDTH = 3
"""Degree of the reference solution's functions across the width, in each of their pieces."""
FIRST_WORDS_OF_TIMEOUT_REASON = "given up after"
"""First words of the reason why a brake that takes too long has no answer or no truth."""
REASON_TO_LEAVE_OUT_BRAKE_FOR_PART_WIDTHS = "the widths of its parts are those of another kind"
"""The reason why a brake is left out: the parts of its shoes have one width, but the kind needs
several widths, or the other way round.
"""
DEGREE_ACROSS_WIDTH_IN_SECOND_PART_OF_TRUTH = 2
"""Degree across the width in the second part of the truth (the reference solution): the answer on a
finer level of the section minus the answer on its first level.

With degree 3 the solve of a shoe with table and web on the finer level takes minutes.
"""
SHORTEST_LINING_PIECE_OF_SUMMED_PRESSURES = 1e-12
"""Length [rad] below which a piece of a lining is left out of a sum of the pressures of several
responses.

The ends of all elements of these responses divide the lining into pieces. Ends that differ only by
round-off make such short pieces.
"""
CUTS_OF_FIRST_PIECE_ACROSS_TRUTH_WIDTH = 3
"""Number of cuts of the first piece across the width in the first part of the truth.

All other pieces are divided into three. On three random brakes ("free" 510030, 510032, 510038) the
steps of finer pieces of a solve come within 0.08 to 0.17 % of the pressures of these pieces.
"""
MOST_CONTACT_NODES_OF_TRUTH = 6500
"""Largest number of nodes of a shoe's contact face in the solves of a truth.

By `prepare.MATRICES_OF_CONTACT_NODES_WITH_FRICTION` a shoe with so many nodes takes up to 3.0 GB.
With the smaller limit of other solves (`prepare.MOST_NODES_OF_CONTACT_FACE`) those brakes would
have no truth that need the finest elements.
"""
STEEL_DATA_OF_TABLES_AND_WEBS = {"E": 210e9, "nu": 0.3}
"""Material of tables and webs of the "built" shoes: Young's modulus [Pa] and Poisson's ratio."""
RANGE_OF_TABLE_THICKNESS_OVER_LINING_WIDTH = (1 / 30, 1 / 8)
"""Smallest and largest thickness of a "built" shoe's table, relative to the lining's width."""
RANGE_OF_WEB_WIDTH_OVER_LINING_WIDTH = (1 / 12, 1 / 4)
"""Smallest and largest width of a "built" shoe's web, relative to the lining's width."""
NAMES_OF_ERRORS_BOUNDED_BY_TOLERANCE = ("torque", "pressure")
"""Names, in the `error` of a response, of the errors that a tolerance bounds."""
NAMES_OF_STATED_ERRORS_COMPARED_WITH_TRUE = (*NAMES_OF_ERRORS_BOUNDED_BY_TOLERANCE, "reaction")
"""Names, in the `error` of a response, of the stated errors that are compared with true errors."""
LEAST_TRUE_PLANE_STRESS_ERROR_TO_JUDGE = 0.01
"""Smallest true relative error of plane stress for which drumlin's estimate of this error is
judged.
"""
GOOD_FACTOR, POOR_FACTOR = 1.5, 3.0
"""Factors that tell whether an estimate of the error of plane stress is good or poor.

An estimate within a factor GOOD_FACTOR of the true error tells an engineer whether plane stress is
good enough. An estimate below the true error divided by POOR_FACTOR would mislead.
"""
LEAST_JUDGED_TRUE_ERROR_OVER_TRUTH_UNCERTAINTY = 2.0
"""Smallest true error for which a stated error is judged, relative to the uncertainty of the truth.

With a smaller value errors of the truth would be taken for errors of the solve; with a larger value
few brakes would remain.
"""
LEAST_JUDGED_TRUE_ERROR = 1e-5
"""Smallest true relative error for which a stated error is judged. The truth itself has errors of
this size.
"""


@dataclass(frozen=True)
class SolidErrorRow:
    """The true and the stated errors of a brake that was solved to a tolerance.

    Attributes
    ----------
    kind, seed : how the brake is drawn, a name in FUNCTIONS_THAT_DRAW_BRAKES_BY_SOLID_KIND, and its
        seed
    tolerance : the tolerance of the solve
    reason : why the brake has no truth; empty if it has one
    title : title of the brake
    stated, true : relative errors by the names of NAMES_OF_STATED_ERRORS_COMPARED_WITH_TRUE;
        `stated` is empty without an answer, and `true` without a truth
    unsure : uncertainties of the true errors, by the same names
    cost : processor time of the solve, divided by the time of a default solve by plane stress; 0
        without an answer
    how : text on the degrees of the solve, across the width and in the section
    plane_true, plane_stated : true and stated errors of plane stress, by the same names;
        `plane_stated` is empty if the solve by plane stress states no errors
    """

    kind: str
    seed: int
    tolerance: float
    reason: str = ""
    title: str = ""
    stated: dict[str, float] = field(default_factory=dict)
    true: dict[str, float] = field(default_factory=dict)
    unsure: dict[str, float] = field(default_factory=dict)
    cost: float = 0.0
    how: str = ""
    plane_true: dict[str, float] = field(default_factory=dict)
    plane_stated: dict[str, float] = field(default_factory=dict)

    @property
    def do_stated_errors_meet_tolerance(self) -> bool:
        """Whether the stated errors meet the tolerance."""
        return (
            max(self.stated[name] for name in NAMES_OF_ERRORS_BOUNDED_BY_TOLERANCE)
            <= self.tolerance
        )

    @property
    def do_true_errors_meet_tolerance(self) -> bool:
        """Whether the true errors meet the tolerance."""
        return (
            max(self.true[name] for name in NAMES_OF_ERRORS_BOUNDED_BY_TOLERANCE) <= self.tolerance
        )

    def is_true_error_certain_and_large_enough(self, name: str) -> bool:
        """Whether a true error is certain and large enough to judge the stated error.

        `name` is one of NAMES_OF_STATED_ERRORS_COMPARED_WITH_TRUE.
        """
        least = max(
            LEAST_JUDGED_TRUE_ERROR,
            LEAST_JUDGED_TRUE_ERROR_OVER_TRUTH_UNCERTAINTY * self.unsure[name],
        )
        return self.true[name] > least

    def is_stated_error_surely_too_small(self, name: str) -> bool:
        """Whether a stated error is below the true error minus the truth's uncertainty.

        `name` is one of NAMES_OF_STATED_ERRORS_COMPARED_WITH_TRUE.
        """
        return self.true[name] - self.unsure[name] > max(LEAST_JUDGED_TRUE_ERROR, self.stated[name])

    def is_stated_error_at_least_true_error(self, name: str) -> bool:
        """Whether a stated error is at least the true error, or both are too small to judge.

        `name` is one of NAMES_OF_STATED_ERRORS_COMPARED_WITH_TRUE.
        """
        return max(LEAST_JUDGED_TRUE_ERROR, self.stated[name]) >= self.true[name]

    def ratio_of_stated_to_true_error(self, name: str) -> float:
        """The ratio of stated to true error; inf if the true error is 0.

        `name` is one of NAMES_OF_STATED_ERRORS_COMPARED_WITH_TRUE.
        """
        return self.stated[name] / self.true[name] if self.true[name] else math.inf


class SolidReferenceWithUncertaintySolutions(NamedTuple):
    """A reference solution of solid shoes, the truth, and two solutions that show its uncertainty.

    Attributes
    ----------
    truth : the truth
    lower : the truth, computed with one degree less across the width in the
        first part
    truth_with_lower_degree_step : the truth, computed with one degree less across the width in the
        difference of two levels
    """

    truth: Response
    lower: Response
    truth_with_lower_degree_step: Response


def draw_random_brake_on_rigid_drum(seed: int) -> Brake:
    """Draw the random brake of a seed, of a kind with a rigid drum."""
    return draw_random_brake(
        seed, KINDS_OF_RANDOM_BRAKES_ON_RIGID_DRUM[seed % len(KINDS_OF_RANDOM_BRAKES_ON_RIGID_DRUM)]
    )


def draw_random_brake_with_steel_table_and_web(seed: int) -> Brake:
    """Draw the brake of a seed whose shoe is built as usual, of a steel table and a steel web."""
    brake = draw_random_brake(seed, "backed")
    rng = np.random.default_rng([seed, len(KINDS_OF_RANDOM_BRAKES_ON_RIGID_DRUM)])
    table, web = (
        math.exp(rng.uniform(*np.log(part)))
        for part in (
            RANGE_OF_TABLE_THICKNESS_OVER_LINING_WIDTH,
            RANGE_OF_WEB_WIDTH_OVER_LINING_WIDTH,
        )
    )
    width = brake.shoes[0].lining.width
    changes = {
        "shoe.backing.thickness": table * width,
        "shoe.backing.material": STEEL_DATA_OF_TABLES_AND_WEBS,
        "shoe.body.width": web * width,
        "shoe.body.material": STEEL_DATA_OF_TABLES_AND_WEBS,
    }
    return vary(brake, changes)


def draw_random_brake_with_bodies_as_wide_as_linings(seed: int) -> Brake:
    """Draw the random brake of a seed, with elastic bodies made as wide as the linings."""
    brake = draw_random_brake_on_rigid_drum(seed)
    if any(shoe.body is None for shoe in brake.shoes):
        return brake
    return vary(brake, {"shoe.body.width": brake.shoes[0].lining.width})


FUNCTIONS_THAT_DRAW_BRAKES_BY_SOLID_KIND: dict[str, Callable[[int], Brake]] = {
    "free": draw_random_brake_on_rigid_drum,
    "built": draw_random_brake_with_steel_table_and_web,
    "one": draw_random_brake_with_bodies_as_wide_as_linings,
}
"""The function that draws a brake from a seed, for each KIND on the command line."""


def functions_across_width_on_fine_pieces(
    shoe: Shoe,
    degree: int = DEGREE_OF_POLYNOMIAL_PIECES_ACROSS_TRUTH_WIDTH,
    cuts: int = CUTS_OF_FIRST_PIECE_ACROSS_TRUTH_WIDTH,
) -> FunctionsAcrossWidth:
    """Functions across the width of a shoe, on finer pieces than those of a solve's first step.

    The first piece is cut `cuts` times, each time at PLACE_OF_CUT_IN_FIRST_PIECE between the last
    cut and the side of the web. All other pieces are divided into as many equal pieces, but at
    least into two.

    Parameters
    ----------
    shoe : the shoe
    degree : degree of the functions in each piece
    cuts : number of cuts of the first piece
    """
    ends = piece_ends_across_half_width_of_shoe(shoe)
    rest = (1 - PLACE_OF_CUT_IN_FIRST_PIECE) ** np.arange(1, cuts + 1)
    found = [0.0, *(ends[1] * (1 - rest)), *ends[1:]]
    for inner, outer in pairwise(ends[1:]):
        found += [*np.linspace(inner, outer, max(cuts, 2) + 1)[1:-1]]
    return FunctionsAcrossWidth(tuple(sorted(map(float, found))), degree)


def response_with_fine_pieces_across_width(
    brake: Brake,
    level: RefinementLevel,
    degree: int = DEGREE_OF_POLYNOMIAL_PIECES_ACROSS_TRUTH_WIDTH,
) -> Response:
    """The response of a brake with functions across the width on fine pieces.

    Parameters
    ----------
    brake : the brake
    level : degree and grading of the hp elements of the shoes' sections
    degree : degree of the functions across the width, in each of their pieces
    """
    fine = partial(functions_across_width_on_fine_pieces, degree=degree)
    return solve_cross_section_mesh_with_width_degree(
        brake, level, fine, solve(brake), most_contact_nodes=MOST_CONTACT_NODES_OF_TRUTH
    ).response


def response_plus_difference_of_two_others(
    base: Response, start: Response, end: Response
) -> Response:
    """The response base + end - start, from three responses of the same brake.

    The sum is made of torques, normal forces, reactions, peaks and pressures. The other attributes
    are those of `base`.

    Parameters
    ----------
    base : the response
    start, end : the responses whose difference, end minus start, is added
    """
    shoes = [
        _shoe_response_plus_difference_of_two_others(*own)
        for own in zip(base.shoes, start.shoes, end.shoes, strict=True)
    ]
    return replace(base, shoes=tuple(shoes))


def _shoe_response_plus_difference_of_two_others(
    base: ShoeResponse, start: ShoeResponse, end: ShoeResponse
) -> ShoeResponse:
    """One shoe's sum base + end - start, as in `response_plus_difference_of_two_others`."""
    # The ends of all elements divide the lining into pieces. On each piece the three pressures are
    # polynomials, and so is their sum, with the largest of the three degrees.
    order = max(base.order, start.order, end.order)
    ends = np.unique(np.concatenate([own.theta[:: own.order] for own in (base, start, end)]))
    ends = ends[np.append(True, np.diff(ends) > SHORTEST_LINING_PIECE_OF_SUMMED_PRESSURES)]
    inner = 0.5 * (1 + gauss_lobatto_points(order)[1:])
    theta = np.append(ends[0], (ends[:-1, None] + np.diff(ends)[:, None] * inner).ravel())
    pressure = base.pressure_at(theta) + end.pressure_at(theta) - start.pressure_at(theta)
    return replace(
        base,
        torque=base.torque + end.torque - start.torque,
        normal_force=base.normal_force + end.normal_force - start.normal_force,
        peak_pressure=base.peak_pressure + end.peak_pressure - start.peak_pressure,
        hinge_reaction=base.hinge_reaction + end.hinge_reaction - start.hinge_reaction,
        theta=theta,
        pressure=pressure,
        order=order,
        surface=None,
    )


def reference_solution_for_solid_solve(
    brake: Brake, found: Response
) -> SolidReferenceWithUncertaintySolutions:
    """The reference solution for a solve of a brake with solid shoes, and its uncertainty.

    `found` is the response of the solve. The second part of the truth reaches to the level after
    the level of the solve. For a solve on the finest level it reaches to the same level.

    Raises
    ------
    NoAnswer
        if one of the solves has no answer
    """
    number = [level.degree for level in REFINEMENT_LEVELS_FROM_COARSE_TO_FINE].index(
        max(shoe.order for shoe in found.shoes)
    )
    finer = REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[
        min(number + 1, len(REFINEMENT_LEVELS_FROM_COARSE_TO_FINE) - 1)
    ]
    answer = partial(
        solve_cross_section_mesh_with_width_degree,
        brake,
        most_contact_nodes=MOST_CONTACT_NODES_OF_TRUTH,
    )
    steps = []
    for degree in (
        DEGREE_ACROSS_WIDTH_IN_SECOND_PART_OF_TRUTH,
        DEGREE_ACROSS_WIDTH_IN_SECOND_PART_OF_TRUTH - 1,
    ):
        once = partial(functions_across_width_on_fine_pieces, degree=degree, cuts=1)
        start = answer(REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0], once, found).response
        end = answer(finer, once, start).response
        steps.append((start, end))
    fine, lower = (
        response_with_fine_pieces_across_width(
            brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0], degree
        )
        for degree in (
            DEGREE_OF_POLYNOMIAL_PIECES_ACROSS_TRUTH_WIDTH,
            DEGREE_OF_POLYNOMIAL_PIECES_ACROSS_TRUTH_WIDTH - 1,
        )
    )
    return SolidReferenceWithUncertaintySolutions(
        response_plus_difference_of_two_others(fine, *steps[0]),
        response_plus_difference_of_two_others(lower, *steps[0]),
        response_plus_difference_of_two_others(fine, *steps[1]),
    )


def row_of_stated_and_true_errors_of_random_solid_brake(
    kind: str, seed: int, tolerance: float, seconds: float
) -> SolidErrorRow:
    """The stated and the true errors of a random brake with solid shoes.

    Parameters
    ----------
    kind : how the brake is drawn, a name in FUNCTIONS_THAT_DRAW_BRAKES_BY_SOLID_KIND
    seed : seed of the brake
    tolerance : allowed relative error of the pressure, averaged over the width, and of the torque
    seconds : processor time [s] after which the brake is given up
    """
    row = SolidErrorRow(kind, seed, tolerance)
    try:
        brake = FUNCTIONS_THAT_DRAW_BRAKES_BY_SOLID_KIND[kind](seed)
        row = replace(row, title=brake.title, reason=reason_why_brake_is_left_out(brake, kind))
        if not row.reason:
            with limit_time_of_block(seconds):
                for more in _rows_with_stated_and_then_true_errors(brake, row):
                    row = more
    except (BadInput, NoAnswer, np.linalg.LinAlgError, TimeoutError) as error:
        row = replace(row, reason=str(error))
    return row


def reason_why_brake_is_left_out(brake: Brake, kind: str) -> str:
    """The reason why a brake is not compared; empty if it is compared.

    The kind "one" leaves out brakes whose shoes have parts of several widths, and the other kinds
    leave out brakes whose shoes have parts of one width. `kind` is a name in
    FUNCTIONS_THAT_DRAW_BRAKES_BY_SOLID_KIND.
    """
    several = any(map(has_parts_of_different_widths, brake.shoes))
    if several == (kind == "one"):
        return REASON_TO_LEAVE_OUT_BRAKE_FOR_PART_WIDTHS
    return reason_why_width_model_does_not_apply(brake) or ""


def _rows_with_stated_and_then_true_errors(
    brake: Brake, row: SolidErrorRow
) -> Iterator[SolidErrorRow]:
    """Yield the row of a brake with its stated errors, and then with its true errors as well."""
    names, started = NAMES_OF_STATED_ERRORS_COMPARED_WITH_TRUE, time.process_time()
    solve(brake, model_error=False)
    plane_done = time.process_time()
    tolerance = TolerancesOfPressureAndTorque(row.tolerance, row.tolerance)
    found = solve_brake_with_widths_to_tolerance(brake, tolerance, must=False)
    done = time.process_time()
    row = replace(
        row,
        stated={name: (found.error or {})[name] for name in names},
        cost=(done - plane_done) / (plane_done - started),
        how=found.notes[-1],
    )
    yield row
    plane = solve(brake, model_error=True)
    reference = reference_solution_for_solid_solve(brake, found)

    def relative_distances_from_truth(response: Response) -> dict[str, float]:
        """The relative distances of a response from the truth, by the names of stated errors."""
        apart = relative_distance_of_plane_stress_from_width_solution(
            brake, response, reference.truth
        ).brake
        return {name: apart[name] for name in names}

    by_degree, by_step = map(
        relative_distances_from_truth, (reference.lower, reference.truth_with_lower_degree_step)
    )
    yield replace(
        row,
        true=relative_distances_from_truth(found),
        unsure={name: by_degree[name] + by_step[name] for name in names},
        plane_true=relative_distances_from_truth(plane),
        plane_stated=dict(plane.plane_stress_error.brake) if plane.plane_stress_error else {},
    )


@contextmanager
def limit_time_of_block(seconds: float, *, by_clock: bool = False) -> Iterator[None]:
    """Raise TimeoutError in a `with` block that takes more than some time [s].

    The time is this process's processor time. Where another process computes, its time by the clock
    is limited instead.

    Raises
    ------
    TimeoutError
        when the time is over
    """
    timer, number, words = signal.ITIMER_PROF, signal.SIGPROF, " of processor time"
    if by_clock:
        timer, number, words = signal.ITIMER_REAL, signal.SIGALRM, ""

    def raise_timeout_error_for_signal(number: int, frame: FrameType | None) -> None:
        """Raise TimeoutError; the parameters are those of a handler of signals."""
        raise TimeoutError(f"{FIRST_WORDS_OF_TIMEOUT_REASON} {seconds:g} s{words}")

    before = signal.signal(number, raise_timeout_error_for_signal)
    signal.setitimer(timer, seconds)
    try:
        yield
    finally:
        signal.setitimer(timer, 0.0)
        signal.signal(number, before)


def read_solid_error_rows(path: Path) -> list[SolidErrorRow]:
    """The rows in a file with a line of JSON for each row; an empty list without the file."""
    if not path.exists():
        return []
    lines = path.read_text(encoding="utf-8").splitlines()
    return [SolidErrorRow(**json.loads(line)) for line in lines]


def table_lines_of_stated_over_true_quantiles(rows: Sequence[SolidErrorRow]) -> list[str]:
    """Table lines on stated and true errors: how many stated errors are too small, and ratios.

    A stated error is surely too small if it is below the true error minus the uncertainty of the
    truth. The quantiles of the ratios, and the number of ratios below 1/2, belong to the judged
    errors.
    """
    lines = ["error     brakes  at least true  surely too small  judged  below half   5 %   half"]
    known = [row for row in rows if row.true]
    for name in NAMES_OF_STATED_ERRORS_COMPARED_WITH_TRUE:
        if not known:
            continue
        enough = np.mean([row.is_stated_error_at_least_true_error(name) for row in known])
        small = sum(row.is_stated_error_surely_too_small(name) for row in known)
        ratios = [
            row.ratio_of_stated_to_true_error(name)
            for row in known
            if row.is_true_error_certain_and_large_enough(name)
        ]
        half = sum(ratio < 0.5 for ratio in ratios)
        at = np.quantile(ratios, [0.05, 0.5]) if ratios else [math.nan, math.nan]
        numbers = "  ".join(f"{value:5.2f}" for value in at)
        line = f"{name:9} {len(known):6}  {enough:13.0%}  {small:16}  {len(ratios):6}  {half:10}"
        lines.append(f"{line}  {numbers}")
    return lines


def table_lines_of_brakes_within_tolerance(rows: Sequence[SolidErrorRow]) -> list[str]:
    """Text lines: share of brakes that reach the tolerance, number given up, and typical time."""
    answered = [row for row in rows if row.stated]
    known = [row for row in answered if row.true]
    apply = [
        row for row in rows if row.stated or row.reason.startswith(FIRST_WORDS_OF_TIMEOUT_REASON)
    ]
    lines = []
    if apply:
        share = sum(row.do_stated_errors_meet_tolerance for row in answered) / len(apply)
        lines.append(f"{share:.0%} of {len(apply)} brakes reach the tolerance by stated errors")
        lines.append(f"{len(apply) - len(answered)} of them are given up before their answer")
    if known:
        share = sum(row.do_true_errors_meet_tolerance for row in known) / len(known)
        lines.append(f"{share:.0%} of {len(known)} brakes with a truth reach it by true errors")
    if answered:
        cost = np.median([row.cost for row in answered])
        lines.append(f"{cost:.0f} times the time of a default solve by plane stress (median)")
    return lines


def table_lines_that_judge_stated_plane_stress_errors(rows: Sequence[SolidErrorRow]) -> list[str]:
    """Table lines on the stated errors of plane stress: how many are good, and how many are poor.

    Only brakes on which plane stress has a true error of at least
    LEAST_TRUE_PLANE_STRESS_ERROR_TO_JUDGE are judged. A good estimate is within the factor
    GOOD_FACTOR of the true error. A poor estimate is below the true error divided by POOR_FACTOR.
    """
    lines = ["plane stress: error  brakes  within 1.5  below 1/3  least   half   most"]
    for name in NAMES_OF_STATED_ERRORS_COMPARED_WITH_TRUE:
        ratios = [
            row.plane_stated[name] / row.plane_true[name]
            for row in rows
            if row.plane_stated and row.plane_true[name] >= LEAST_TRUE_PLANE_STRESS_ERROR_TO_JUDGE
        ]
        if ratios:
            good = np.mean([1 / GOOD_FACTOR <= ratio <= GOOD_FACTOR for ratio in ratios])
            poor = np.mean([ratio < 1 / POOR_FACTOR for ratio in ratios])
            numbers = "  ".join(f"{v:5.2f}" for v in np.quantile(ratios, [0.0, 0.5, 1.0]))
            lines.append(f"{name:19} {len(ratios):7}  {good:10.0%}  {poor:9.0%}  {numbers}")
    return lines


def text_line_of_solid_errors(row: SolidErrorRow) -> str:
    """A line of text on a brake: its errors, its time and its degrees, or why it has no errors."""
    parts = []
    for name in NAMES_OF_STATED_ERRORS_COMPARED_WITH_TRUE if row.stated else ():
        part = f"{name} stated {row.stated[name]:.1e}"
        if row.true:
            part += f" true {row.true[name]:.1e} +- {row.unsure[name]:.0e}"
        parts.append(part)
    if row.stated:
        parts += [f"cost {row.cost:.0f}", row.how]
    if row.reason:
        parts.append(row.reason)
    return f"{row.title or row.seed}: {', '.join(parts)}"


def main() -> None:
    """Compare the brakes of a kind, keep their rows in a file, and print the tables of all rows."""
    kind, first, last, path = sys.argv[1], *map(int, sys.argv[2:4]), Path(sys.argv[4])
    tolerance, seconds = [*map(float, sys.argv[5:]), *(1e-2, 120.0)[len(sys.argv) - 5 :]]
    rows = [
        row for row in read_solid_error_rows(path) if (row.kind, row.tolerance) == (kind, tolerance)
    ]
    for seed in sorted({*range(first, last)} - {row.seed for row in rows}):
        rows.append(
            row_of_stated_and_true_errors_of_random_solid_brake(kind, seed, tolerance, seconds)
        )
        with path.open("a", encoding="utf-8") as file:
            file.write(json.dumps(asdict(rows[-1])) + "\n")
        sys.stdout.write(f"{text_line_of_solid_errors(rows[-1])}\n")
        sys.stdout.flush()
    lines = table_lines_of_stated_over_true_quantiles(rows)
    lines += table_lines_of_brakes_within_tolerance(rows)
    lines += table_lines_that_judge_stated_plane_stress_errors(rows)
    sys.stdout.write("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
