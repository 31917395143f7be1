"""Table rows on misfit: any deviation of lining or drum from surfaces that fit each other.

The rows show the effect of one misfit at a time, of an out-of-round drum over one revolution, and
of random misfits within manufacturing tolerances.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake.brake import Brake
from drumlin.brake.clearance import (
    lining_circle_offsets_towards_hinge_by_key,
    lining_radii_by_key_for_radius_mismatch,
    solve_brake_at_angular_drum_positions,
)
from drumlin.brake.file import vary
from drumlin.response.norms import relative_error_of_number
from drumlin.response.response import Response
from drumlin.sweeps.cases import CaseResultsByName, results_of_response_by_name
from drumlin.sweeps.tolerances import (
    REPORTED_PERCENTILES,
    FirstAndTotalSobolIndexOfTolerance,
    ManufacturingTolerance,
    mean_and_percentiles_of_sample,
    values_of_named_result_in_all_cases,
)

QUANTITIES_SHOWN_OVER_RANDOM_BRAKES = {
    "torque": "torque [N m]",
    "brake_factor": "brake factor T/(F R)",
    "peak_pressure": "peak pressure [MPa]",
}
"""Quantities whose distribution over the random brakes is shown: name in tables, by key of a row.
"""
LINING_STATES_OF_RANDOM_BRAKES = ("new", "worn in")
"""The two states of the linings in which the random brakes are solved."""
NUMBER_OF_DRUM_LOBES_BY_OUT_OF_ROUNDNESS = {
    "run-out": 1,
    "oval": 2,
    "three lobes": 3,
    "five lobes": 5,
}
"""Number of lobes around the drum, by the name of the out-of-roundness. Run-out has one lobe."""
EXPANSION, WARMING = 11e-6, 100.0
"""Coefficient of thermal expansion of the drum [1/K], and temperature of a warm drum minus
temperature of the shoes [K].
"""


def table_rows_of_changes_due_to_each_misfit_alone(
    brake: Brake, law: Response, solve: Callable[[Brake], Response]
) -> list[dict[str, Any]]:
    """A row for linings that fit and for each single misfit, with torque and peak pressure.

    `from_fit` is the relative change of the torque from the brake with linings that fit. `from_law`
    and `peak_from_law` are the relative differences of torque and peak pressure from a rigid-shoe
    law.

    Parameters
    ----------
    brake : Brake
        The brake without misfit.
    law : Response
        The response of the brake without misfit by the rigid-shoe law.
    solve : function
        Returns the response of a brake.
    """
    fits = solve(brake)
    law_peak = _largest_peak_pressure_of_shoes(law)
    rows = []
    for name, changes in _brake_changes_by_misfit_name(brake).items():
        response = solve(vary(brake, changes))
        row = {
            "misfit": name,
            "torque": response.torque,
            "from_fit": relative_error_of_number(response.torque, fits.torque),
            "from_law": relative_error_of_number(response.torque, law.torque),
            "peak": _largest_peak_pressure_of_shoes(response),
            "peak_from_law": relative_error_of_number(
                _largest_peak_pressure_of_shoes(response), law_peak
            ),
            "touching": fraction_of_linings_in_contact(brake, response),
        }
        rows.append(row)
    return rows


def _largest_peak_pressure_of_shoes(response: Response) -> float:
    """The largest peak pressure of all shoes [Pa]."""
    return max(shoe.peak_pressure for shoe in response.shoes)


def _brake_changes_by_misfit_name(brake: Brake) -> Mapping[str, Mapping[str, Any]]:
    """The changes of the brake file that cause each misfit, by the misfit's name in the table."""
    heat = {"drum.expansion": EXPANSION, "drum.temperature_rise": WARMING}
    growth = vary(brake, heat).out_of_round_harmonics[-1].amplitude

    def brake_changes_for_lining_step(depth: float) -> dict[str, Any]:
        """The changes of the brake file that make a step of `depth` [m] in each lining's middle.

        A positive depth lowers the half of the lining that lies away from the pin.
        """
        changes = {}
        for i, shoe in enumerate(brake.shoes):
            step = [[shoe.lining.middle, depth * shoe.frame.sense]]
            changes[f"shoe[{i}].lining.misfit.blocks"] = step
        return changes

    moved_linings = lining_circle_offsets_towards_hinge_by_key
    return {
        "fits": {},
        "linings 50 µm larger in radius": lining_radii_by_key_for_radius_mismatch(brake, 50e-6),
        "linings 50 µm smaller in radius": lining_radii_by_key_for_radius_mismatch(brake, -50e-6),
        "linings moved 50 µm along the pin's radius, outwards": moved_linings(brake, 50e-6),
        "linings moved 50 µm along the pin's radius, inwards": moved_linings(brake, -50e-6),
        "taper: 50 µm thinner away from the pin": {"shoe.lining.misfit.taper": 50e-6},
        "taper: 50 µm thicker away from the pin": {"shoe.lining.misfit.taper": -50e-6},
        "two blocks: the one away from the pin 20 µm lower": brake_changes_for_lining_step(20e-6),
        "two blocks: the one away from the pin 20 µm higher": brake_changes_for_lining_step(-20e-6),
        f"drum {WARMING:g} K hotter than the shoes: {growth * 1e6:.0f} µm larger": heat,
    }


def fraction_of_linings_in_contact(brake: Brake, response: Response) -> float:
    """Total length of all contact arcs, divided by the total length of all linings."""
    arcs: float = 0
    for shoe in response.shoes:
        for start, end in shoe.contact_arcs:
            arcs += end - start
    return arcs / sum(shoe.lining.end - shoe.lining.start for shoe in brake.shoes)


def torques_at_angles_of_lobed_drum(
    brake: Brake, solve: Callable[[Brake], Response], amplitude: float, angles: Sequence[float]
) -> dict[str, Floats]:
    """Torques of a brake at several angles of its drum, for each form of out-of-roundness.

    Parameters
    ----------
    brake : Brake
        The brake with a round drum.
    solve : function
        Returns the response of a brake.
    amplitude : float
        Amplitude of the lobes [m].
    angles : sequence of float
        Angles [rad] by which the drum has turned.

    Returns
    -------
    dict
        Arrays (angles,) of torques [N m] by the keys of NUMBER_OF_DRUM_LOBES_BY_OUT_OF_ROUNDNESS.
    """
    found = {}
    for name, order in NUMBER_OF_DRUM_LOBES_BY_OUT_OF_ROUNDNESS.items():
        lobed = vary(brake, {"drum.out_of_round": [{"order": order, "amplitude": amplitude}]})
        responses = solve_brake_at_angular_drum_positions(lobed, solve, angles)
        found[name] = np.array([response.torque for response in responses])
    return found


def torque_ranges_over_mean_torque(torques: Mapping[str, Floats]) -> dict[str, float]:
    """Largest minus smallest torque, divided by the mean torque, by the keys of `torques`."""
    return {name: float(np.ptp(torque) / np.mean(torque)) for name, torque in torques.items()}


def maps_of_relative_deviation_from_law(
    rows: Sequence[CaseResultsByName], brake: Brake, law: Response, shape: tuple[int, int]
) -> dict[str, Floats]:
    """Maps of the relative differences of torque and peak pressure from their values by the law.

    Parameters
    ----------
    rows : sequence of mappings
        Rows of a sweep over two quantities, in the order of the maps.
    brake : Brake
        The brake without the changes of the sweep.
    law : Response
        The response of that brake by the law.
    shape : tuple of two int
        Shape of each map.

    Returns
    -------
    dict
        The arrays of the given shape under the keys "torque" and "peak_pressure".
    """
    # The law is evaluated for the brake without the changes of the sweep.
    nominal = results_of_response_by_name(brake, law)
    maps = {}
    for name in ("torque", "peak_pressure"):
        maps[name] = (
            values_of_named_result_in_all_cases(rows, name).reshape(shape) / nominal[name] - 1
        )
    return maps


@dataclass(frozen=True)
class ResultsOfRandomBrakesWithTolerances:
    """Results of brakes whose dimensions were drawn at random from manufacturing tolerances.

    Attributes
    ----------
    rows : mapping
        The rows of the brakes by state: "new" and "worn in" were solved by finite elements, "law"
        by the sine law. The first 2 n rows of each state are the two independent samples A and B of
        `tolerances.draw_deviations_for_all_sobol_samples`.
    n : int
        Number of brakes in each of the samples A and B.
    """

    rows: Mapping[str, Sequence[CaseResultsByName]]
    n: int

    def values_of_quantity_for_random_brakes(self, state: str, name: str) -> Floats:
        """The values (2 n,) of a quantity of the random brakes.

        The peak pressure is in MPa, the other quantities are in SI units.

        state : a key of `rows`, for example "new"; name : a key of
            QUANTITIES_SHOWN_OVER_RANDOM_BRAKES.
        """
        values = values_of_named_result_in_all_cases(self.rows[state][: 2 * self.n], name)
        return values * 1e-6 if name == "peak_pressure" else values

    def torque_over_torque_by_law(self, state: str) -> Floats:
        """Torque (2 n,) of each random brake, divided by its torque by the sine law.

        state : "new" or "worn in", the state of the linings.
        """
        ratio: Floats = self.values_of_quantity_for_random_brakes(
            state, "torque"
        ) / self.values_of_quantity_for_random_brakes("law", "torque")
        return ratio

    def percentiles_5_and_95_of_law_torque_error(self, state: str) -> tuple[float, float]:
        """5th and 95th percentile of the relative error of the torque by the sine law.

        state : "new" or "worn in", the state of the linings of the random brakes.
        """
        low, high = np.percentile(1 / self.torque_over_torque_by_law(state), (5, 95))
        return low - 1, high - 1

    def relative_standard_deviation_of_torque(self, state: str) -> float:
        """Standard deviation of the torque of the random brakes, divided by their mean torque.

        state : a key of `rows`, for example "new" for new linings.
        """
        return mean_and_percentiles_of_sample(
            self.values_of_quantity_for_random_brakes(state, "torque")
        ).relative_standard_deviation

    def mean_and_95th_percentile_of_relative_peak_pressure(
        self, pressure: float
    ) -> tuple[float, float]:
        """Mean and 95th percentile of the peak pressure of new linings, over `pressure` [MPa]."""
        peaks = self.values_of_quantity_for_random_brakes("new", "peak_pressure") / pressure
        return float(peaks.mean()), float(np.percentile(peaks, 95))

    def fraction_of_torque_variance_removed_by_run_in(self) -> float:
        """Fraction of the variance of the torque among brakes that disappears by running in.

        The rest of the variance comes from the tolerances of friction, force, levers and drum.
        """
        new = mean_and_percentiles_of_sample(
            self.values_of_quantity_for_random_brakes("new", "torque")
        ).deviation
        worn = mean_and_percentiles_of_sample(
            self.values_of_quantity_for_random_brakes("worn in", "torque")
        ).deviation
        return 1 - (worn / new) ** 2


def quantities_of_nominal_brake_by_law(brake: Brake, law: Response) -> dict[str, float]:
    """The values of the shown quantities by the law, for the brake without tolerances.

    The peak pressure is in MPa, the other quantities are in SI units.
    """
    row = results_of_response_by_name(brake, law)
    row["peak_pressure"] *= 1e-6
    return {name: row[name] for name in QUANTITIES_SHOWN_OVER_RANDOM_BRAKES}


def rows_with_mean_and_percentiles_of_quantities(
    drawn: ResultsOfRandomBrakesWithTolerances,
) -> list[dict[str, Any]]:
    """A row for each quantity in each state: mean, standard deviation and percentiles.

    The last rows treat the ratio of the torque to the torque by the sine law of the same brake.
    """
    values: dict[tuple[str, str], Floats] = {}
    for name, title in QUANTITIES_SHOWN_OVER_RANDOM_BRAKES.items():
        for state in (*LINING_STATES_OF_RANDOM_BRAKES, "law"):
            values[title, state] = drawn.values_of_quantity_for_random_brakes(state, name)
    for state in LINING_STATES_OF_RANDOM_BRAKES:
        values["torque over the sine law's of the same brake", state] = (
            drawn.torque_over_torque_by_law(state)
        )
    # A row for each quantity and state: mean, standard deviation, standard deviation over mean, and
    # percentiles.
    rows = []
    for (quantity, state), sample in values.items():
        found = mean_and_percentiles_of_sample(sample)
        row: dict[str, Any] = {
            "quantity": quantity,
            "state": state if state != "law" else "sine law",
        }
        row |= {
            "mean": found.mean,
            "deviation": found.deviation,
            "relative": found.relative_standard_deviation,
        }
        for k, value in zip(REPORTED_PERCENTILES, found.percentiles, strict=True):
            row[f"p{k}"] = value
        rows.append(row)
    return rows


def rows_of_sobol_indices_by_tolerance(
    tolerances: Sequence[ManufacturingTolerance],
    shares: Mapping[str, Mapping[str, Sequence[FirstAndTotalSobolIndexOfTolerance]]],
) -> list[dict[str, Any]]:
    """A row for each tolerance with its total Sobol indices.

    A total Sobol index is the share of a quantity's variance that the tolerance causes alone or
    together with other tolerances.

    tolerances : the tolerances; shares : Sobol indices in the order of the tolerances, by state and
    by quantity of QUANTITIES_SHOWN_OVER_RANDOM_BRAKES.
    """
    rows = []
    for i, tolerance in enumerate(tolerances):
        row: dict[str, Any] = {"name": tolerance.name}
        for state, by_quantity in shares.items():
            for name in QUANTITIES_SHOWN_OVER_RANDOM_BRAKES:
                row[f"{state}_{name}"] = by_quantity[name][i].total.value
        rows.append(row)
    return rows


def sliding_distance_until_torque_settles(
    distances: Sequence[float], torque: Floats, within: float
) -> float:
    """The sliding distance [m] after which the distribution of the torque has settled.

    The distribution has settled where its 5th, 50th and 95th percentile keep their last values.

    Parameters
    ----------
    distances : sequence of float
        Sliding distances [m].
    torque : array (brakes, distances)
        Torque of each brake [N m].
    within : float
        Largest relative difference of a percentile from its last value.
    """
    # `off` is the largest relative difference of the three percentiles from their last values, at
    # each distance.
    ends = np.percentile(torque, (5, 50, 95), axis=0)
    off = np.abs(ends / ends[:, -1:] - 1).max(axis=0)
    return next(s for k, s in enumerate(distances) if off[k:].max() < within)
