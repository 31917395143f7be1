"""Manufacturing tolerances: random draws of a brake's keys and their shares in what it does.

The draws are those of Saltelli et al. (2010), Comput. Phys. Commun. 181, 259: two independent
samples A and B of n brakes, and for each tolerance i a sample AB_i. The sample AB_i is A with the
deviate i of B. Together the 2 n brakes of A and B are a Monte Carlo sample. With the samples AB_i
they give the shares of the variance (Sobol indices).
"""

import re
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.brake import Brake
from drumlin.brake.file import value_of, vary
from drumlin.fem.preparation.prepare import prepare
from drumlin.lining_wear import archard, run_in
from drumlin.lining_wear.linings import fem_wear_setup
from drumlin.sweeps.cases import Row, SweepCase

PERCENTILES = (1, 5, 50, 95, 99)
"""The percentiles [%] by which a distribution is reported."""


class ManufacturingTolerance(NamedTuple):
    """One random deviation of manufacture and the keys of the brake file that it moves.

    A deviation may move several keys: a pin along its radius, or both radii.

    Attributes
    ----------
    name : of the tolerance, in tables
    distribution : of the deviate, a frozen distribution of scipy.stats
    moves : change of each key in SI per unit of the deviate
    """

    name: str
    distribution: Any
    moves: Mapping[str, float]


def truncated_normal_deviate(limit: float) -> Any:
    """The distribution of a deviate that inspection keeps within +-limit.

    It is normal with a standard deviation of limit/2, cut off at the limits.
    """
    from scipy.stats import truncnorm  # noqa: PLC0415  (0.5 s)

    return truncnorm(-2, 2, scale=limit / 2)


def uniform_deviate(low: float, high: float) -> Any:
    """The uniform distribution of a deviate from low to high."""
    from scipy.stats import uniform  # noqa: PLC0415  (0.5 s)

    return uniform(low, high - low)


def draw_deviates(tolerances: Sequence[ManufacturingTolerance], n: int, seed: int) -> Floats:
    """Draw the samples A, B, AB_1 ... AB_d of d deviates by scrambled Sobol' points.

    Parameters
    ----------
    tolerances : the d tolerances
    n : brakes in a sample, a power of 2
    seed : of the scrambling

    Returns
    -------
    the deviates (d + 2, n, d)
    """
    from scipy.stats import qmc  # noqa: PLC0415  (0.5 s)

    if n < 2 or n & (n - 1):
        raise BadInput(f"n = {n}: must be a power of 2")
    d = len(tolerances)
    points = qmc.Sobol(2 * d, rng=np.random.default_rng(seed)).random(n)
    # The first d coordinates make sample A, the others sample B.
    values = np.empty_like(points)
    for i in range(2 * d):
        # The inverse of the distribution function turns a uniform number into a deviate.
        values[:, i] = tolerances[i % d].distribution.ppf(points[:, i])
    A, B = values[:, :d], values[:, d:]
    # Sample AB_i is A with the deviates of tolerance i taken from B.
    mixed = np.repeat(A[None], d, axis=0)
    for i in range(d):
        mixed[i, :, i] = B[:, i]
    return np.concatenate([A[None], B[None], mixed])


def tolerance_cases(
    brake: Brake,
    tolerances: Sequence[ManufacturingTolerance],
    deviates: Floats,
    model: str = "fem",
    **options: Any,
) -> list[SweepCase]:
    """Make a case for each row of deviates: the brake with the deviates added to its keys.

    Parameters
    ----------
    brake : the base brake
    tolerances : the d tolerances
    deviates : (..., d), as `draw_deviates` returns them
    model, options : who solves the cases, and its options

    Raises
    ------
    BadInput
        where a key of every shoe ("shoe.lining.thickness") would undo one of a single shoe
        ("shoe[0].lining.thickness")
    """
    # A dict keeps the keys in the order in which the tolerances first move them.
    nominal: dict[str, Any] = {}
    _check_keys({key for tolerance in tolerances for key in tolerance.moves})
    for tolerance in tolerances:
        nominal |= {key: value_of(brake, key) for key in tolerance.moves}
    # Row i holds the change of each key per unit of deviate i.
    slopes = np.zeros((len(tolerances), len(nominal)))
    for i, tolerance in enumerate(tolerances):
        slopes[i] = [tolerance.moves.get(key, 0.0) for key in nominal]
    values = np.array([*nominal.values()]) + deviates.reshape(-1, len(tolerances)) @ slopes
    made = []
    for row in values.tolist():
        changes = dict(zip(nominal, row, strict=True))
        made.append(SweepCase(brake, changes, model, options))
    return made


def _check_keys(keys: set[str]) -> None:
    """Raise BadInput where two keys mean the same number."""
    without_numbers = {key: re.sub(r"\[\d+\]", "", key) for key in keys}
    for key, bare in without_numbers.items():
        if key == bare and list(without_numbers.values()).count(bare) > 1:
            raise BadInput(
                f"tolerances: {key} means every one, and another tolerance moves one of them; "
                "name each"
            )


def values_of_rows(rows: Sequence[Row], name: str) -> Floats:
    """The number called `name` of every row, (rows,).

    Raises NoAnswer where a case has no answer, since shares of a variance need all cases.
    """
    failed = [str(row["status"]) for row in rows if row["status"] != "solved"]
    if failed:
        raise NoAnswer(
            f"tolerances: {len(failed)} of {len(rows)} cases have no answer; the first: {failed[0]}"
        )
    return np.array([row[name] for row in rows], dtype=float)


class SampleSpread(NamedTuple):
    """Mean, standard deviation and percentiles of a sample, in the unit of its values.

    The percentiles are those of PERCENTILES.
    """

    mean: float
    deviation: float
    percentiles: tuple[float, ...]

    @property
    def relative(self) -> float:
        """Standard deviation over mean."""
        return self.deviation / self.mean


def sample_spread(values: Floats) -> SampleSpread:
    """Mean, standard deviation and percentiles of values (n,)."""
    return SampleSpread(
        mean=float(values.mean()),
        deviation=float(values.std(ddof=1)),
        percentiles=tuple(np.percentile(values, PERCENTILES).tolist()),
    )


class SobolIndex(NamedTuple):
    """A Sobol index (share of a variance) with its confidence interval from low to high."""

    value: float
    low: float
    high: float


class SobolIndices(NamedTuple):
    """The shares of one deviate in a variance.

    Attributes
    ----------
    name : of the tolerance
    first : share that the deviate has alone
    total : share with all that the deviate does together with others
    """

    name: str
    first: SobolIndex
    total: SobolIndex


def sobol_indices_of_tolerances(
    tolerances: Sequence[ManufacturingTolerance],
    values: Floats,
    *,
    seed: int,
    confidence: float = 0.95,
    resamples: int = 400,
) -> list[SobolIndices]:
    """Sobol indices of each tolerance with confidence intervals.

    The estimators are those of Saltelli et al. (2010), table 2 (b) and (f), as
    scipy.stats.sobol_indices computes them. The intervals come from a bootstrap: the n brakes are
    drawn again with replacement.

    Parameters
    ----------
    tolerances : the d tolerances
    values : (d + 2, n), a number of each brake that `draw_deviates` made
    seed : of the bootstrap
    confidence : of the intervals
    resamples : number of samples of the bootstrap
    """
    rng = np.random.default_rng(seed)
    n = values.shape[1]
    indices = _sobol_index_values(values)
    resampled = []
    for _ in range(resamples):
        chosen = rng.integers(n, size=n)
        resampled.append(_sobol_index_values(values[:, chosen]))
    # The interval leaves out as much below as above.
    tails = [(1 - confidence) / 2, (1 + confidence) / 2]
    low, high = np.quantile(np.array(resampled), tails, axis=0)

    def share(kind: int, i: int) -> SobolIndex:
        """The first (kind 0) or total (kind 1) index of tolerance i."""
        return SobolIndex(float(indices[kind, i]), float(low[kind, i]), float(high[kind, i]))

    return [
        SobolIndices(tolerance.name, first=share(0, i), total=share(1, i))
        for i, tolerance in enumerate(tolerances)
    ]


def _sobol_index_values(values: Floats) -> Floats:
    """First-order and total Sobol indices (2, d) of values (d + 2, n)."""
    from scipy.stats import sobol_indices  # noqa: PLC0415  (0.5 s)

    A, B, AB = values[:1], values[1:2], values[2:, None]
    found = sobol_indices(func={"f_A": A, "f_B": B, "f_AB": AB}, n=values.shape[1])
    return np.array([np.reshape(found.first_order, -1), np.reshape(found.total_order, -1)])


def torque_and_peak_during_run_in(
    brake: Brake, distances: Sequence[float], *, elements: int, tolerance: float = 3e-3
) -> dict[str, Any]:
    """Torque and peak pressure of a new brake on a round drum as it runs in.

    Archard's wear with run_in.COEFFICIENT goes on until pressure and torque are settled. At greater
    distances both stay as they then are.

    Parameters
    ----------
    brake : the brake with new linings
    distances : sliding distances [m]
    elements : along each lining
    tolerance : relative error of the pressure in each step of the wear

    Returns
    -------
    "torque" [N m] and "peak_pressure" [Pa] at each distance; "worn_in", the torque [N m] of the law
    that the wear tends to
    """
    on_round_drum = vary(brake, {"drum.out_of_round": []})
    setup = fem_wear_setup(prepare(on_round_drum, elements=elements), on_round_drum)
    states = run_in.run_in(setup, tolerance=tolerance)
    settled_at = states[-1].s
    # The wear ends where pressure and torque are settled; later states are equal to the last.
    states_at = [archard.interpolate_state(states, min(s, settled_at)) for s in distances]
    return {
        "torque": [state.torque for state in states_at],
        "peak_pressure": [run_in.peak_nodal_pressure(setup, state) for state in states_at],
        "worn_in": run_in.rigid_law_target(setup).torque,
    }
