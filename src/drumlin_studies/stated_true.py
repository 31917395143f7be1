"""The error that drumlin states with a response, compared with the true error.

The true error is the difference from a far finer solution, the truth. The truth is solved with
curved triangles, a method that shares only the brake with the judged hp elements, or with hp
elements that are some two levels finer, with exact contact. The uncertainty of the truth is the
remaining distance from the limit of its sequence of meshes, plus the round-off of its elimination.

All errors are relative. The error of the pressure p is an L2 norm that leaves out
UNCOMPARED_EDGE_ZONE_IN_RADIANS at the lining's ends. The errors of the pressure, of the peak
pressure and of the hinge reaction are the largest over all shoes. The error of the torque belongs
to the torque of the whole brake.
"""

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, Protocol

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.brake import Brake, Shoe
from drumlin.comparison import length_of_uncompared_zone_at_lining_end
from drumlin.fem.error_control.levels import solve_brake_on_finer_and_finer_mesh_levels
from drumlin.fem.hp.corner import PressureAtNodesOfShoe
from drumlin.fem.model import solve_prepared_model
from drumlin.response.response import (
    UNCOMPARED_EDGE_ZONE_IN_RADIANS,
    ZERO_CHANGES_OF_SHOE_RESULTS,
    RelativeChangesOfShoeResults,
    Response,
    ShoeResponse,
    length_of_edge_zone_left_out_of_peak_search,
    reference_force_of_reaction_errors,
)
from drumlin.response.resultants import length_of_edge_zone_left_out_of_pressure_errors
from drumlin.verification import triangles

QUANTITIES_WHOSE_STATED_ERRORS_ARE_JUDGED = ("pressure", "torque", "peak", "reaction")
"""Quantities whose stated errors are compared with true errors."""
SMALLEST_RELEVANT_TRUE_ERROR = 1e-6
"""Relative true error below which any stated error counts as large enough.

The calibration fits no factor to smaller errors. Nobody asks for a smaller error of the pressure,
and a smaller difference may be round-off or an error of the truth.
"""
JUDGED_TOLERANCES = (1e-2, 1e-3, 1e-4)
"""Relative tolerances to which each brake is solved before its stated errors are judged."""
GAUSS_POINTS, GAUSS_WEIGHTS = np.polynomial.legendre.leggauss(8)
"""Gauss points in [-1, 1] and their weights, for integrals between two nodes of a pressure."""
LARGEST_PRESSURE_CHANGE_OF_TRUTH_OVER_TOLERANCE = 0.1
"""Largest allowed change of the pressure on the last level of the truth, relative to the tolerance.

The truth is solved on finer and finer levels until the change of the pressure is below this limit.
"""
NUMBER_OF_PEAK_SEARCH_ANGLES = 4001
"""Number of evenly spaced angles at which the peak pressure is searched, in addition to the nodes.
"""


class PressureFromNodesAtAnyAngle(PressureAtNodesOfShoe, Protocol):
    """A pressure of a shoe that is given at nodes and can be computed at any angle."""

    def pressure_at(self, theta: Floats) -> Floats:
        """The pressure [Pa] at angles theta [rad]."""


class FarFinerSolutionOfShoe(PressureFromNodesAtAnyAngle, Protocol):
    """The far finer solution of a shoe, against which true errors are taken."""

    @property
    def torque(self) -> float:
        """Torque [N m] of the shoe on the drum."""

    @property
    def normal_force(self) -> float:
        """Size of the resultant force of the normal pressure on the drum [N]."""

    @property
    def hinge_reaction(self) -> Floats:
        """Force (2,) [N] of the hinge pin on the shoe."""


@dataclass(frozen=True)
class FarFinerSolutionOfBrake:
    """A far finer solution of a brake, against which true errors are taken, and its uncertainty.

    Attributes
    ----------
    shoes : sequence of FarFinerSolutionOfShoe
        The solution of each shoe on the finest mesh of a sequence.
    unsure : mapping
        Relative uncertainty by QUANTITIES_WHOSE_STATED_ERRORS_ARE_JUDGED: the estimated distance of
        the solution from the limit of the sequence, plus the round-off of the elimination.
    seconds : float
        Processor time of the sequence [s].
    """

    shoes: Sequence[FarFinerSolutionOfShoe]
    unsure: Mapping[str, float]
    seconds: float


def solve_fine_reference_by_triangles(brake: Brake) -> FarFinerSolutionOfBrake:
    """The far finer solution of a brake by curved triangles.

    Raises BadInput if triangles cannot mesh the brake, and NoAnswer if the brake has no solution.
    """
    begin = time.process_time()
    return reference_from_last_three_meshes(
        brake, triangles.solve_brake_on_sequence_of_triangle_meshes(brake), begin
    )


def solve_fine_reference_by_hp_elements(brake: Brake, tolerance: float) -> FarFinerSolutionOfBrake:
    """The far finer solution of a brake by hp elements on finer and finer levels, exact contact.

    The brake is solved on finer levels until the pressure changes by less than
    LARGEST_PRESSURE_CHANGE_OF_TRUTH_OVER_TOLERANCE of the tolerance, or on all levels. The level
    that changed the pressure least becomes the truth. It need not be the finest level, on which
    round-off may add more error than the refinement removes.

    Raises NoAnswer where fewer than three levels have an answer.
    """
    begin = time.process_time()
    solutions: list[Sequence[ShoeResponse]] = []
    changes: list[float] = []
    try:
        for _, response in solve_brake_on_finer_and_finer_mesh_levels(
            brake, partial(solve_prepared_model, penalty=math.inf)
        ):
            change = math.inf
            if solutions:
                change = true_errors_of_response(brake, solutions[-1], response.shoes)["pressure"]
            changes.append(change)
            solutions.append(response.shoes)
            if (
                len(solutions) > 2
                and change <= LARGEST_PRESSURE_CHANGE_OF_TRUTH_OVER_TOLERANCE * tolerance
            ):
                break
    except NoAnswer:
        # Because of round-off a fine level may have no answer, although the coarser levels have an
        # answer.
        if len(solutions) < 3:
            raise
    if len(solutions) < 3:
        raise NoAnswer(f"only {len(solutions)} levels of columns have an answer")
    best = 2 + int(np.argmin(changes[2:]))
    last_three = solutions[best - 2 : best + 1]
    return reference_from_last_three_meshes(
        brake, last_three, begin, largest_round_off_errors_of_shoes(solutions[best])
    )


def largest_round_off_errors_of_shoes(
    shoes: Sequence[ShoeResponse],
) -> RelativeChangesOfShoeResults:
    """Relative round-off errors of static condensation, by quantity: the largest over all shoes."""
    by_quantity = zip(*(shoe.lost for shoe in shoes), strict=True)
    return RelativeChangesOfShoeResults(*(max(parts) for parts in by_quantity))


def reference_from_last_three_meshes(
    brake: Brake,
    last: Sequence[Sequence[FarFinerSolutionOfShoe]],
    begin: float,
    lost: RelativeChangesOfShoeResults = ZERO_CHANGES_OF_SHOE_RESULTS,
) -> FarFinerSolutionOfBrake:
    """The last solution of a sequence of finer and finer meshes, with its uncertainty.

    The uncertainty follows from the last three solutions.

    Parameters
    ----------
    brake : Brake
        The brake of the sequence.
    last : sequence of three sequences of FarFinerSolutionOfShoe
        The shoes of the last three solutions, coarse to fine.
    begin : float
        Processor time at which the sequence began [s].
    lost : RelativeChangesOfShoeResults
        Relative round-off errors of the finest solution, which are added to the uncertainty.
    """
    early = true_errors_of_response(brake, last[0], last[1])
    late = true_errors_of_response(brake, last[1], last[2])
    digits = lost._asdict() | {"peak": max(lost.pressure, lost.peak)}
    unsure = {
        name: estimate_distance_of_last_value_from_limit(early[name], late[name]) + digits[name]
        for name in QUANTITIES_WHOSE_STATED_ERRORS_ARE_JUDGED
    }
    return FarFinerSolutionOfBrake(last[2], unsure, time.process_time() - begin)


def estimate_distance_of_last_value_from_limit(early: float, late: float) -> float:
    """The estimated distance of the last value of a sequence from the limit of the sequence.

    If each change is 1/r of the change before, the distance is the last change divided by r - 1.
    The observed r is limited to values from 2 to 4.

    early : size of the change before the last; late : size of the last change.
    """
    if not late:
        return 0.0
    ratio_of_steps = min(max(early / late, 2.0), 4.0)
    return late / (ratio_of_steps - 1)


def true_errors_of_response(
    brake: Brake, found: Sequence[Any], true: Sequence[FarFinerSolutionOfShoe]
) -> dict[str, float]:
    """The true relative errors of a response, by QUANTITIES_WHOSE_STATED_ERRORS_ARE_JUDGED.

    Parameters
    ----------
    brake : Brake
        The brake that was solved.
    found : sequence of ShoeResponse or ShoeSolution
        The shoes that are judged.
    true : sequence of FarFinerSolutionOfShoe
        The shoes that serve as the truth.
    """
    trios = list(zip(brake.shoes, found, true, strict=True))
    true_torque = math.fsum(shoe.torque for shoe in true)
    torque_error = math.fsum(a.torque - b.torque for _, a, b in trios)
    return {
        "pressure": max(
            relative_pressure_error_of_shoe(a, b, length_of_uncompared_zone_at_lining_end(brake))
            for _, a, b in trios
        ),
        "torque": abs(torque_error) / true_torque if true_torque else 0.0,
        "peak": max(
            _relative_peak_pressure_error(shoe, brake.length_per_surface_coordinate, a, b)
            for shoe, a, b in trios
        ),
        "reaction": max(_relative_hinge_reaction_error(a, b) for _, a, b in trios),
    }


def _relative_hinge_reaction_error(found: Any, true: FarFinerSolutionOfShoe) -> float:
    """Error of a shoe's hinge reaction, relative to `reference_force_of_reaction_errors`."""
    size = reference_force_of_reaction_errors(true.hinge_reaction, true.normal_force)
    return math.dist(found.hinge_reaction, true.hinge_reaction) / size


def relative_pressure_error_of_shoe(
    found: PressureFromNodesAtAnyAngle,
    true: FarFinerSolutionOfShoe,
    edge: float = UNCOMPARED_EDGE_ZONE_IN_RADIANS,
) -> float:
    """L2 norm of the error of a shoe's pressure, relative to the L2 norm of the true pressure.

    Zones at both ends of the lining are left out, unless half of the force acts in these zones. The
    result is nan if the true pressure is zero.

    found : the pressure that is judged; true : the far finer solution; edge : length of each zone
    [rad].
    """
    zone = length_of_edge_zone_left_out_of_pressure_errors(
        true.theta, true.pressure, true.order, edge
    )
    first, last = true.theta[0] + zone, true.theta[-1] - zone
    # The nodes of the judged pressure and the element ends of the true pressure divide the lining
    # into intervals. The error is integrated over each interval.
    knots = np.unique(np.concatenate([[first, last], found.theta, true.theta[:: true.order]]))
    knots = knots[(knots >= first) & (knots <= last)]
    # Within an interval both pressures are smooth. Gauss quadrature is therefore exact enough.
    half = 0.5 * np.diff(knots)[:, None]
    theta, weight = knots[:-1, None] + half * (1 + GAUSS_POINTS), half * GAUSS_WEIGHTS
    p = true.pressure_at(theta)
    size = float(np.sum(weight * p**2))
    if not size:
        return math.nan
    square = float(np.sum(weight * (found.pressure_at(theta) - p) ** 2))
    return math.sqrt(square / size)


def computed_peak_outside_edge_zones(
    shoe: Shoe, length_per_surface_coordinate: float, found: PressureFromNodesAtAnyAngle
) -> float:
    """Largest pressure [Pa] of a shoe outside the edge zones at the lining's ends.

    The edge zones are included if half of the force acts in them.

    Parameters
    ----------
    shoe : Shoe
        The shoe of the brake.
    length_per_surface_coordinate : float
        Metres per unit of the lining's coordinate (`Brake.length_per_surface_coordinate`).
    found : PressureFromNodesAtAnyAngle
        The pressure of the shoe.
    """
    zone = length_of_edge_zone_left_out_of_pressure_errors(
        found.theta,
        found.pressure,
        found.order,
        length_of_edge_zone_left_out_of_peak_search(shoe, length_per_surface_coordinate),
    )
    start, end = shoe.lining.start + zone, shoe.lining.end - zone
    inside = found.theta[(found.theta > start) & (found.theta < end)]
    angles = np.concatenate([inside, np.linspace(start, end, NUMBER_OF_PEAK_SEARCH_ANGLES)])
    return float(found.pressure_at(angles).max())


def _relative_peak_pressure_error(
    shoe: Shoe, length_per_surface_coordinate: float, found: Any, true: FarFinerSolutionOfShoe
) -> float:
    """Relative error of the peak pressure of a shoe; nan if the true peak is zero.

    A response of drumlin states its peak pressure. The peak of another solution, for example by
    triangles, is found by `computed_peak_outside_edge_zones`.
    """
    true_peak = computed_peak_outside_edge_zones(shoe, length_per_surface_coordinate, true)
    states_peak = hasattr(found, "peak_pressure")
    found_peak = (
        float(found.peak_pressure)
        if states_peak
        else computed_peak_outside_edge_zones(shoe, length_per_surface_coordinate, found)
    )
    return abs(found_peak / true_peak - 1) if true_peak else math.nan


def row_of_stated_and_true_errors(
    brake: Brake,
    tolerance: float,
    solve: Callable[..., Response],
    true: FarFinerSolutionOfBrake | None,
    failure: str = "",
) -> dict[str, Any]:
    """A row with the stated and the true errors of a brake that is solved to a tolerance.

    The keys are QUANTITIES_WHOSE_STATED_ERRORS_ARE_JUDGED with "stated_", "true_" or "unsure_"
    before them; "unsure_" is the uncertainty of the true error. A stated error that drumlin does
    not give is nan. The "true_" and "unsure_" keys are missing without a far finer solution, and
    all three kinds of keys are missing after a failed solve. `outcome` is "reached", "not reached",
    "no truth" or "failed", and `reason` is a line of text on a failure.

    Parameters
    ----------
    brake : Brake
        The brake to be solved.
    tolerance : float
        Relative tolerance of the solve.
    solve : function
        Returns the response of a brake for the keyword argument `tolerance`.
    true : FarFinerSolutionOfBrake or None
        The far finer solution of the brake; None where it has no answer.
    failure : str
        Reason why there is no far finer solution.
    """
    begin = time.process_time()
    base: dict[str, Any] = {"tolerance": tolerance, "title": brake.title, "reason": failure}
    try:
        response = solve(brake, tolerance=tolerance)
    except (BadInput, NoAnswer, ArithmeticError, ValueError, AssertionError) as error:
        return (
            base
            | _outcome_and_reason_of_failed_solve(error)
            | {"seconds": time.process_time() - begin}
        )
    base["seconds"] = time.process_time() - begin
    stated = response.error or {}
    for name in QUANTITIES_WHOSE_STATED_ERRORS_ARE_JUDGED:
        base[f"stated_{name}"] = float(stated.get(name, math.nan))
    if true is None:
        return base | {"outcome": "no truth"}
    errors = true_errors_of_response(brake, response.shoes, true.shoes)
    base["outcome"] = "reached"
    base |= {f"true_{name}": errors[name] for name in QUANTITIES_WHOSE_STATED_ERRORS_ARE_JUDGED}
    base |= {
        f"unsure_{name}": true.unsure[name] for name in QUANTITIES_WHOSE_STATED_ERRORS_ARE_JUDGED
    }
    return base


def _outcome_and_reason_of_failed_solve(error: Exception) -> dict[str, str]:
    """The keys `outcome` and `reason` of a row for a solve that raised an error."""
    if isinstance(error, NoAnswer):
        outcome = "not reached" if "not reached" in str(error) else "failed"
        return {"outcome": outcome, "reason": str(error)}
    return {"outcome": "failed", "reason": f"{type(error).__name__}: {error}"}


def stated_over_true_error_of_row(one: Mapping[str, Any], name: str) -> float:
    """The ratio of a stated error in a row to the true error minus its uncertainty.

    The result is nan where the row lacks one of the errors, and inf where the true error is not
    larger than its uncertainty.

    one : a row of `row_of_stated_and_true_errors`; name : one of
        QUANTITIES_WHOSE_STATED_ERRORS_ARE_JUDGED.
    """
    stated = float(one.get(f"stated_{name}", math.nan))
    true = float(one.get(f"true_{name}", math.nan))
    unsure = float(one.get(f"unsure_{name}", math.nan))
    if math.isnan(stated + true + unsure):
        return math.nan
    certain = true - unsure
    return stated / certain if certain > 0 else math.inf


def summary_rows_of_stated_errors(rows: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """A row for each tolerance and quantity: how often the stated errors are large enough.

    Brakes without a far finer solution are left out. Keys of a row: `brakes`: number of brakes;
    `reached`: fraction of the brakes that reached the tolerance; `missed`: fraction of the brakes
    whose true error minus its uncertainty is above the tolerance; `judged`: number of brakes with a
    stated and a true error.

    The other keys belong to the judged brakes. `above`: fraction whose true error minus its
    uncertainty is above the stated error; `above_whole`: fraction whose whole true error is above
    the stated error; `above_twice`: fraction whose true error minus its uncertainty is above twice
    the stated error; `smallest`: smallest ratio of the stated error to the true error minus its
    uncertainty; `median`: median ratio of stated to true error over the brakes whose true error is
    more than four times its uncertainty; `median_relevant`: the same median over those of these
    brakes whose true error is at least SMALLEST_RELEVANT_TRUE_ERROR.
    """
    table = []
    for tolerance in sorted({one["tolerance"] for one in rows}, reverse=True):
        own = [one for one in rows if one["tolerance"] == tolerance]
        own = [one for one in own if one["outcome"] != "no truth"]
        table += [
            _summary_row_of_quantity(own, tolerance, name)
            for name in QUANTITIES_WHOSE_STATED_ERRORS_ARE_JUDGED
        ]
    return table


def _summary_row_of_quantity(
    rows: Sequence[Mapping[str, Any]], tolerance: float, name: str
) -> dict[str, Any]:
    """The summary row of one quantity, for the rows of one tolerance."""
    # Only rows with a stated and a true error are judged. The ratio of all other rows is nan.
    ratios = np.array([stated_over_true_error_of_row(one, name) for one in rows])
    is_judged = ~np.isnan(ratios)
    judged_rows = [one for one, judged in zip(rows, is_judged, strict=True) if judged]
    judged_ratios = ratios[is_judged]
    stated, true, unsure = f"stated_{name}", f"true_{name}", f"unsure_{name}"
    # Medians are taken over the rows whose true error is well above its uncertainty.
    well_known = [one for one in judged_rows if one[true] > 4 * one[unsure]]
    known_ratios = [one[stated] / one[true] for one in well_known]
    relevant_ratios = [
        one[stated] / one[true] for one in well_known if one[true] >= SMALLEST_RELEVANT_TRUE_ERROR
    ]
    missed = sum(one.get(true, 0.0) - one.get(unsure, 0.0) > tolerance for one in rows)
    brakes, judged = max(1, len(rows)), max(1, len(judged_rows))
    return {
        "tolerance": tolerance,
        "quantity": name,
        "brakes": len(rows),
        "reached": sum(one["outcome"] == "reached" for one in rows) / brakes,
        "judged": len(judged_rows),
        "above": float((judged_ratios < 1).sum()) / judged,
        "above_whole": sum(one[stated] < one[true] for one in judged_rows) / judged,
        "above_twice": float((judged_ratios < 0.5).sum()) / judged,
        "smallest": float(judged_ratios.min()) if judged_rows else math.nan,
        "median": float(np.median(known_ratios)) if known_ratios else math.nan,
        "median_relevant": float(np.median(relevant_ratios)) if relevant_ratios else math.nan,
        "missed": missed / brakes,
    }
