"""The a posteriori error estimate: errors of a level, from its difference to the coarser level.

A level is a division of the brake into elements, and level k is finer than level k-1. Let e_k be
the relative error of a result on level k, and d_k the relative difference between the results on
the levels k and k-1. If a level has at most 1/r of the error of the level before, then d_k >=
e_(k-1) - e_k >= (r - 1) e_k, so that

    e_k <= c d_k,   c = 1/(r - 1).

The factor c of each quantity is fitted on random brakes of every kind, see
`SAFETY_FACTORS_OF_ERROR_ESTIMATE`. The difference of a single number may be small by accident
although its error is large. The errors of forces and of peak pressures are therefore estimated by
more than their own difference:

- A force (torque, reaction) is an integral of the pressure p, and the differences of p in several
  columns of hp elements may cancel in it. Therefore a fraction, `cancelled`, of another change is
  added: the change that the force would have if the columns contributed with random signs. That
  change is the root of the sum of the squared contributions.
- The difference of the peak pressure counts as at least the geometric mean of two other
  differences: of p in the column of elements with the peak, and of p in the L2 norm.

Two other errors are added for all quantities: the change by the finite contact stiffness
(`ShoeResponse.softness`), and the round-off error of the elimination of unknowns
(`ShoeResponse.lost`).
"""

import json
import math
from collections.abc import Mapping, Sequence
from itertools import chain
from pathlib import Path
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake.brake import Brake
from drumlin.response.norms import PressureDifference
from drumlin.response.response import (
    Response,
    ShoeResponse,
    length_of_edge_zone_left_out_of_peak_search,
    length_of_uncompared_edge_zone,
    reference_force_of_reaction_errors,
)
from drumlin.response.resultants import length_of_edge_zone_left_out_of_pressure_errors

QUANTITIES_WITH_STATED_ERROR = ("pressure", "torque", "peak", "reaction")
"""Names of the quantities of a shoe that have a stated error.

They are the pressure in L2 outside the zones at the lining's ends, the torque, the peak pressure
and the support reaction.
"""


class SafetyFactorsOfErrorEstimate(NamedTuple):
    """The factors that turn differences between two levels into error estimates.

    Attributes
    ----------
    pressure, force : estimated error of the quantity, divided by the difference of the quantity
        between the last two levels; a force is a torque or a reaction
    cancelled : fraction of another change that is added to the error of a force: the change that
        the force would have if the columns of elements contributed with random signs. The actual
        contributions may cancel by accident.
    peak : estimated error of the peak pressure, divided by its difference between the last two
        levels
    """

    pressure: float
    force: float
    cancelled: float
    peak: float

    def safety_factors_of_level_differences(self, shoes: int) -> Floats:
        """The factors (1 + 4 shoes,) that turn differences of two levels into errors.

        The order is that of `ResponseDifferencesOfTwoLevels`.
        """
        own = (self.pressure, self.force, self.peak, self.force)
        return np.array([self.force, *own * shoes])


def read_safety_factors(path: Path) -> dict[str, float]:
    """Read the safety factors of a file that `make calibrate` has written, by their names."""
    data = json.loads(path.read_text(encoding="utf-8"))
    # The file has an entry with value and meaning for each factor. Its other two entries say where
    # the factors come from.
    origin = ("written by", "provenance")
    return {name: each["value"] for name, each in data.items() if name not in origin}


SAFETY_FACTORS_OF_ERROR_ESTIMATE = SafetyFactorsOfErrorEstimate(
    **read_safety_factors(Path(__file__).with_name("factors.json"))
)
"""The factors of the error estimate, which `make calibrate` fits.

The file factors.json says on which brakes they are fitted, and what each factor does.
"""

SAFETY_FACTOR_OF_PENALTY_ERROR = 2.0
"""Safety factor on the estimated error by the finite contact stiffness, the penalty.

`ShoeResponse.softness` is the first-order change of the results by the penalty. The actual change
is at most twice as large, as long as the lining penetrates the drum by less than the lining itself
is compressed.
"""


class EstimatedErrors(NamedTuple):
    """Estimated relative errors of a brake and of its shoes, by QUANTITIES_WITH_STATED_ERROR.

    `brake` holds the error of the brake's torque and, for the other quantities, the error of the
    shoe with the largest error. `shoes` holds the errors of each shoe.
    """

    brake: Mapping[str, float]
    shoes: tuple[Mapping[str, float], ...]

    @classmethod
    def brake_errors_from_torque_and_shoe_errors(
        cls, torque: float, shoes: Sequence[Mapping[str, float]]
    ) -> "EstimatedErrors":
        """Make the errors of a brake from the error of its torque and the errors of its shoes.

        For each other quantity the error of the brake is the largest error of a shoe.
        """
        most = {name: max(shoe[name] for shoe in shoes) for name in QUANTITIES_WITH_STATED_ERROR}
        return cls(most | {"torque": torque}, tuple(shoes))


class ResponseDifferencesOfTwoLevels(NamedTuple):
    """Relative differences of the responses on two levels.

    Both arrays (1 + 4 shoes,) begin with the torque of the brake, for which the absolute
    differences of the shoes are summed. The four QUANTITIES_WITH_STATED_ERROR of each shoe follow.

    Attributes
    ----------
    differences : difference of each quantity between the two levels
    changes_with_random_signs : change that each force would have if the columns of elements
        contributed to it with random signs; 0 for pressures
    """

    differences: Floats
    changes_with_random_signs: Floats


def estimate_errors_from_two_mesh_levels(
    brake: Brake,
    before: Response,
    last: Response,
    factors: SafetyFactorsOfErrorEstimate = SAFETY_FACTORS_OF_ERROR_ESTIMATE,
) -> EstimatedErrors:
    """Estimate the relative errors of the response `last` on the finer of two levels.

    The errors follow from the difference to the response `before` on the coarser level, and are
    meant as upper bounds.
    """
    moved = relative_differences_of_responses_on_two_levels(brake, before, last)
    return estimate_errors_from_response_differences(moved, last, factors)


def estimate_errors_from_response_differences(
    moved: ResponseDifferencesOfTwoLevels,
    last: Response,
    factors: SafetyFactorsOfErrorEstimate,
    further: Floats | float = 0.0,
) -> EstimatedErrors:
    """The estimated relative errors of a response, from its differences to a coarser response.

    Parameters
    ----------
    moved : differences of the response to the response on the coarser level
    last : the response
    factors : factors of the estimate
    further : (1 + 4 shoes,) errors that are added, in the order of `ResponseDifferencesOfTwoLevels`
    """
    found = (
        factors.safety_factors_of_level_differences(len(last.shoes)) * moved.differences
        + factors.cancelled * moved.changes_with_random_signs
        + further
    )
    # A quantity that is equal on both levels, such as the torque of a shoe without contact, keeps
    # the error 0.
    found = np.where(found > 0, found + sum_of_penalty_and_round_off_errors(last.shoes), found)
    rows = np.reshape(found[1:], (-1, len(QUANTITIES_WITH_STATED_ERROR))).tolist()
    errors_of_shoes = [dict(zip(QUANTITIES_WITH_STATED_ERROR, row, strict=True)) for row in rows]
    return EstimatedErrors.brake_errors_from_torque_and_shoe_errors(
        float(found[0]), errors_of_shoes
    )


def sum_of_penalty_and_round_off_errors(shoes: Sequence[ShoeResponse]) -> Floats:
    """The relative errors by the penalty plus the relative errors by round-off (1 + 4 shoes,).

    The torque of the brake comes first, then the four QUANTITIES_WITH_STATED_ERROR of each shoe.
    The penalty is the finite contact stiffness.
    """
    return SAFETY_FACTOR_OF_PENALTY_ERROR * _relative_changes_of_shoes_due_to_cause(
        shoes, "softness"
    ) + _relative_changes_of_shoes_due_to_cause(shoes, "lost")


def _relative_changes_of_shoes_due_to_cause(shoes: Sequence[ShoeResponse], name: str) -> Floats:
    """The relative changes (1 + 4 shoes,) by one cause, as in `ResponseDifferencesOfTwoLevels`.

    `name` is the attribute of `ShoeResponse` that holds the changes by this cause, "softness" for
    the penalty or "lost" for round-off.
    """
    rows = []
    for shoe in shoes:
        change = getattr(shoe, name)
        peak = max(change.pressure, change.peak)
        rows.append((change.pressure, change.torque, peak, change.reaction))
    torque_of_brake = max(row[1] for row in rows)
    return np.array([torque_of_brake, *chain(*rows)])


def relative_differences_of_responses_on_two_levels(
    brake: Brake, a: Response, b: Response
) -> ResponseDifferencesOfTwoLevels:
    """The relative differences of two responses of one brake, `a` and, on finer elements, `b`.

    The result also holds the changes that forces would have if the columns of hp elements
    contributed with random signs.
    """
    pairs = list(zip(a.shoes, b.shoes, strict=True))
    rows = []
    for shoe, (of_a, of_b) in zip(brake.shoes, pairs, strict=True):
        zone = length_of_edge_zone_left_out_of_peak_search(
            shoe, brake.length_per_surface_coordinate
        )
        rows.append(
            _relative_shoe_response_differences_of_levels(
                zone, brake.surface_coordinate_per_phi, of_a, of_b
            )
        )
    of_shoes = np.array(rows)  # (shoes, 2, 4)
    # The difference of the brake's torque is the sum of the absolute differences of its shoes.
    total = b.torque or a.torque or 1.0
    shares = np.array([of_b.torque or of_a.torque for of_a, of_b in pairs]) / total
    both = []
    for values in (of_shoes[:, 0], of_shoes[:, 1]):
        torque_of_brake = float(values[:, 1] @ shares)
        both.append(np.array([torque_of_brake, *values.ravel()]))
    steps, chance = both
    return ResponseDifferencesOfTwoLevels(steps, chance)


def _relative_shoe_response_differences_of_levels(
    zone: float, unit: float, a: ShoeResponse, b: ShoeResponse
) -> tuple[tuple[float, ...], ...]:
    """The relative differences between two responses of a shoe, and the changes with random signs.

    Each of the two results is a tuple (4,) in the order of QUANTITIES_WITH_STATED_ERROR. The second
    tuple has the changes that torque and reaction would have if the columns of elements contributed
    to them with random signs, and zeros.

    Parameters
    ----------
    zone : length of the zone at each end of the lining in which no pressure peak is sought
    unit : change of the coordinate theta per radian of the shoe's angle phi, see `ShoeFrame`
    a, b : responses of the shoe on a level and on the next finer level
    """
    held = reference_force_of_reaction_errors(b.hinge_reaction, b.normal_force)
    torque = abs(a.torque - b.torque) / (b.torque or a.torque or 1.0)
    peak = abs(a.peak_pressure - b.peak_pressure) / (b.peak_pressure or a.peak_pressure or 1.0)
    reaction = math.dist(a.hinge_reaction, b.hinge_reaction) / held
    if not b.pressure.any():
        pressure = float(a.pressure.any())
        return (pressure, torque, peak, reaction), (0.0,) * len(QUANTITIES_WITH_STATED_ERROR)
    singular = length_of_uncompared_edge_zone(b.length_of_shortest_lining, unit)
    edge = length_of_edge_zone_left_out_of_pressure_errors(
        b.theta, b.pressure, b.order, singular, b.slots
    )
    peak_zone = length_of_edge_zone_left_out_of_pressure_errors(
        b.theta, b.pressure, b.order, zone, b.slots
    )
    step = PressureDifference.pressure_difference_of_two_responses(a, b, edge, peak_zone)
    pressure = step.relative_norm_of_difference_outside_end_zones(edge)
    peak = max(peak, math.sqrt(pressure * step.relative_difference_near_peak(peak_zone)))
    # The pressures on both levels balance the same actuation, so that a change of p only moves the
    # force within the contact. This changes torque and reaction by a fraction of at most about the
    # angle [rad] of the contact, which matters if the contact is short.
    reach = (b.contact_arcs[-1][1] - b.contact_arcs[0][0]) / unit
    chance = min(step.relative_force_as_if_elements_had_random_signs(), reach)
    torque_by_chance = chance if b.torque else 0.0
    reaction_by_chance = chance * b.normal_force / held
    by_chance = (0.0, torque_by_chance, 0.0, reaction_by_chance)
    return (pressure, torque, peak, reaction), by_chance
