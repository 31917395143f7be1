"""Manufacturing tolerances: how much each tolerance contributes to the scatter of a brake's torque.

Brakes with random deviations are drawn as in Saltelli et al. (2010), Comput. Phys. Commun. 181,
259: two independent samples A and B of n brakes each, and for each tolerance i a sample AB_i. The
sample AB_i is A with the deviations of tolerance i taken from B. The 2 n brakes of A and B together
are a Monte Carlo sample of the scatter. All samples together give the share of each tolerance in
the variance of a result (its Sobol indices).
"""

import re
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.brake import Brake
from drumlin.brake.file import numerical_value_of_brake_key, vary
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.lining_wear import archard, run_in
from drumlin.lining_wear.linings import wear_setup_by_finite_elements
from drumlin.sweeps.cases import CaseResultsByName, SweepCase

REPORTED_PERCENTILES = (1, 5, 50, 95, 99)
"""The percentiles [%] of a result's random values that are reported."""


class ManufacturingTolerance(NamedTuple):
    """A manufacturing tolerance: a random deviation, and the keys of the brake that it changes.

    One deviation may change several keys, such as x and y of a pin that is moved along its radius.

    Attributes
    ----------
    name : name of the tolerance in tables
    distribution : distribution of the deviation, a frozen distribution of scipy.stats
    key_changes_per_deviation : change of each key's value, in its SI unit, if the deviation is 1
    """

    name: str
    distribution: Any
    key_changes_per_deviation: Mapping[str, float]


def truncated_normal_distribution(limit: float) -> Any:
    """The distribution of a deviation that inspection keeps between -limit and +limit.

    It is a normal distribution with a standard deviation of limit/2, cut off at both limits.
    """
    from scipy.stats import truncnorm  # noqa: PLC0415  (0.5 s)

    return truncnorm(-2, 2, scale=limit / 2)


def uniform_distribution(low: float, high: float) -> Any:
    """The uniform distribution of a deviation between `low` and `high`."""
    from scipy.stats import uniform  # noqa: PLC0415  (0.5 s)

    return uniform(low, high - low)


def draw_deviations_for_all_sobol_samples(
    tolerances: Sequence[ManufacturingTolerance], n: int, seed: int
) -> Floats:
    """Draw the deviations of all brakes of the samples A, B, AB_1 ... AB_d.

    The module's docstring defines the samples. The random numbers are scrambled Sobol' points,
    which fill the space of 2 d coordinates evenly.

    Parameters
    ----------
    tolerances : the d tolerances
    n : number of brakes in a sample, a power of 2
    seed : seed of the scrambling

    Returns
    -------
    deviations (d + 2, n, d), with the axes sample, brake of the sample, and tolerance
    """
    from scipy.stats import qmc  # noqa: PLC0415  (0.5 s)

    if n < 2 or n & (n - 1):
        raise BadInput(f"n = {n}: must be a power of 2")
    d = len(tolerances)
    points = qmc.Sobol(2 * d, rng=np.random.default_rng(seed)).random(n)
    # The first d coordinates make sample A, the others sample B.
    values = np.empty_like(points)
    for i in range(2 * d):
        # The inverse cumulative distribution turns a uniform random number into a deviation.
        values[:, i] = tolerances[i % d].distribution.ppf(points[:, i])
    A, B = values[:, :d], values[:, d:]
    # Sample AB_i is sample A with the deviations of tolerance i taken from sample B.
    mixed = np.repeat(A[None], d, axis=0)
    for i in range(d):
        mixed[i, :, i] = B[:, i]
    return np.concatenate([A[None], B[None], mixed])


def cases_with_random_deviations(
    brake: Brake,
    tolerances: Sequence[ManufacturingTolerance],
    deviates: Floats,
    model: str = "fem",
    **options: Any,
) -> list[SweepCase]:
    """Make a case for each drawn brake: the base brake with the deviations added to its keys.

    Parameters
    ----------
    brake : the base brake, without deviations
    tolerances : the d tolerances
    deviates : deviations (..., d), as `draw_deviations_for_all_sobol_samples` returns them
    model, options : model that solves the cases, and its options

    Raises
    ------
    BadInput
        if a key of every shoe ("shoe.lining.thickness") and a key of a single shoe
        ("shoe[0].lining.thickness") would both change the same number
    """
    # Read the base brake's value of each key that a tolerance changes.
    nominal: dict[str, Any] = {}
    changed_keys: set[str] = set()
    for tolerance in tolerances:
        changed_keys.update(tolerance.key_changes_per_deviation)
    _check_keys_mean_different_numbers(changed_keys)
    for tolerance in tolerances:
        nominal |= {
            key: numerical_value_of_brake_key(brake, key)
            for key in tolerance.key_changes_per_deviation
        }
    # Row i holds the change of each key per unit of deviation of tolerance i.
    slopes = np.zeros((len(tolerances), len(nominal)))
    for i, tolerance in enumerate(tolerances):
        slopes[i] = [tolerance.key_changes_per_deviation.get(key, 0.0) for key in nominal]
    values = np.array([*nominal.values()]) + deviates.reshape(-1, len(tolerances)) @ slopes
    made = []
    for row in values.tolist():
        changes = dict(zip(nominal, row, strict=True))
        made.append(SweepCase(brake, changes, model, options))
    return made


def _check_keys_mean_different_numbers(keys: set[str]) -> None:
    """Raise BadInput if two keys of the brake file change the same number.

    For example, "shoe.lining.thickness" changes all shoes, and "shoe[0].lining.thickness" one of
    them.
    """
    without_numbers = {key: re.sub(r"\[\d+\]", "", key) for key in keys}
    for key, bare in without_numbers.items():
        if key == bare and list(without_numbers.values()).count(bare) > 1:
            raise BadInput(
                f"tolerances: {key} means every one, and another tolerance moves one of them; "
                "name each"
            )


def values_of_named_result_in_all_cases(rows: Sequence[CaseResultsByName], name: str) -> Floats:
    """The result called `name`, such as "torque", of all cases as an array (cases,).

    `rows` holds the results of each case. Raises NoAnswer if a case was not solved, since the
    shares of tolerances in a variance need all cases.
    """
    failed = [str(row["status"]) for row in rows if row["status"] != "solved"]
    if failed:
        raise NoAnswer(
            f"tolerances: {len(failed)} of {len(rows)} cases have no answer; the first: {failed[0]}"
        )
    return np.array([row[name] for row in rows], dtype=float)


class MeanDeviationAndPercentilesOfSample(NamedTuple):
    """Mean, standard deviation and percentiles of the values of a sample, in the values' unit.

    The percentiles belong to the percentages in REPORTED_PERCENTILES.
    """

    mean: float
    deviation: float
    percentiles: tuple[float, ...]

    @property
    def relative_standard_deviation(self) -> float:
        """The standard deviation divided by the mean."""
        return self.deviation / self.mean


def mean_and_percentiles_of_sample(values: Floats) -> MeanDeviationAndPercentilesOfSample:
    """The mean, standard deviation and percentiles of the values (n,) of a sample."""
    return MeanDeviationAndPercentilesOfSample(
        mean=float(values.mean()),
        deviation=float(values.std(ddof=1)),
        percentiles=tuple(np.percentile(values, REPORTED_PERCENTILES).tolist()),
    )


class SobolIndexWithInterval(NamedTuple):
    """A Sobol index (share of a tolerance in a variance), and its confidence interval's limits."""

    value: float
    low: float
    high: float


class FirstAndTotalSobolIndexOfTolerance(NamedTuple):
    """The shares of one tolerance in the variance of a result.

    Attributes
    ----------
    name : name of the tolerance
    first : share that the tolerance causes alone (first-order Sobol index)
    total : share with the interactions of this tolerance with others included (total Sobol index)
    """

    name: str
    first: SobolIndexWithInterval
    total: SobolIndexWithInterval


def sobol_indices_of_tolerances(
    tolerances: Sequence[ManufacturingTolerance],
    values: Floats,
    *,
    seed: int,
    confidence: float = 0.95,
    resamples: int = 400,
) -> list[FirstAndTotalSobolIndexOfTolerance]:
    """The shares of each tolerance in the variance of a result, with confidence intervals.

    The estimators are (b) and (f) of table 2 in Saltelli et al. (2010), as
    scipy.stats.sobol_indices computes them. The confidence intervals come from a bootstrap, which
    draws the n brakes again with replacement.

    Parameters
    ----------
    tolerances : the d tolerances
    values : the result (d + 2, n) of each brake in each sample of
        `draw_deviations_for_all_sobol_samples`
    seed : seed of the bootstrap
    confidence : probability of the confidence intervals
    resamples : number of bootstrap samples
    """
    rng = np.random.default_rng(seed)
    n = values.shape[1]
    indices = _first_and_total_sobol_indices(values)
    resampled = []
    for _ in range(resamples):
        chosen = rng.integers(n, size=n)
        resampled.append(_first_and_total_sobol_indices(values[:, chosen]))
    # The confidence interval excludes the same probability below it and above it.
    tails = [(1 - confidence) / 2, (1 + confidence) / 2]
    low, high = np.quantile(np.array(resampled), tails, axis=0)

    def sobol_index_with_interval(kind: int, i: int) -> SobolIndexWithInterval:
        """The first-order (`kind` 0) or total (1) Sobol index of tolerance i, with its interval."""
        return SobolIndexWithInterval(
            float(indices[kind, i]), float(low[kind, i]), float(high[kind, i])
        )

    return [
        FirstAndTotalSobolIndexOfTolerance(
            tolerance.name,
            first=sobol_index_with_interval(0, i),
            total=sobol_index_with_interval(1, i),
        )
        for i, tolerance in enumerate(tolerances)
    ]


def _first_and_total_sobol_indices(values: Floats) -> Floats:
    """First-order and total Sobol indices (2, d) of a result (d + 2, n) in all samples."""
    from scipy.stats import sobol_indices  # noqa: PLC0415  (0.5 s)

    A, B, AB = values[:1], values[1:2], values[2:, None]
    found = sobol_indices(func={"f_A": A, "f_B": B, "f_AB": AB}, n=values.shape[1])
    return np.array([np.reshape(found.first_order, -1), np.reshape(found.total_order, -1)])


def torque_and_peak_during_run_in(
    brake: Brake, distances: Sequence[float], *, elements: int, tolerance: float = 3e-3
) -> dict[str, Any]:
    """Torque and peak pressure of a new brake on a round drum while its linings run in by wear.

    The linings wear by Archard's law with run_in.DEFAULT_WEAR_COEFFICIENT until pressure and torque
    no longer change. At greater sliding distances both have their last values.

    Parameters
    ----------
    brake : the brake with new linings
    distances : sliding distances [m]
    elements : number of finite elements along each lining
    tolerance : relative error of the pressure in each step of the wear

    Returns
    -------
    dictionary with "torque" [N m] and "peak_pressure" [Pa] at each distance, and "worn_in", the
    torque [N m] of the rigid-shoe law, which is the limit for very long wear
    """
    on_round_drum = vary(brake, {"drum.out_of_round": []})
    setup = wear_setup_by_finite_elements(
        make_prepared_model(on_round_drum, elements=elements), on_round_drum
    )
    states = run_in.wear_brake_linings_until_worn_in(setup, tolerance=tolerance)
    settled_at = states[-1].s
    # The computation ends when pressure and torque no longer change. At greater sliding distances
    # the last state is taken.
    states_at = [
        archard.interpolate_wear_state_at_distance(states, min(s, settled_at)) for s in distances
    ]
    return {
        "torque": [state.torque for state in states_at],
        "peak_pressure": [
            run_in.peak_nodal_pressure_of_wear_state(setup, state) for state in states_at
        ],
        "worn_in": run_in.final_wear_pressure_and_torque_by_rigid_shoe_law(setup).torque,
    }
