"""Manufacturing tolerances: draws of a brake's keys, the distribution of what it does, and who is
to blame.

The draws are those of Saltelli et al. (2010), Comput. Phys. Commun. 181, 259: two independent
samples A and B of n brakes, and for each tolerance i a sample AB_i that is A but for the deviate i,
which is B's. Together the 2 n brakes of A and B are a Monte Carlo sample; with the AB_i they give
the shares of the variance (Sobol indices).
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
from drumlin.lining_wear.linings import fem_setup
from drumlin.sweeps.cases import Case, Row

PERCENTILES = (1, 5, 50, 95, 99)


class Tolerance(NamedTuple):
    """One deviate: its distribution (of scipy.stats, frozen), and what it adds to keys of the brake
    file.

    moves: SI per unit of the deviate, by key. A deviate may move several keys: a pin along its
    radius, both radii.
    """

    name: str
    distribution: Any
    moves: Mapping[str, float]


def within(limit: float) -> Any:
    """A deviate that inspection keeps within +-limit: normal, two standard deviations = limit, cut
    there.
    """
    from scipy.stats import truncnorm  # noqa: PLC0415  (0.5 s)

    return truncnorm(-2, 2, scale=limit / 2)


def between(low: float, high: float) -> Any:
    """A deviate that is anything from low to high."""
    from scipy.stats import uniform  # noqa: PLC0415  (0.5 s)

    return uniform(low, high - low)


def draw(tolerances: Sequence[Tolerance], n: int, seed: int) -> Floats:
    """Deviates (d + 2, n, d) of the samples A, B, AB_1 ... AB_d: scrambled Sobol' points; n a power
    of 2.
    """
    from scipy.stats import qmc  # noqa: PLC0415  (0.5 s)

    if n < 2 or n & (n - 1):
        raise BadInput(f"n = {n}: must be a power of 2")
    d = len(tolerances)
    points = qmc.Sobol(2 * d, rng=np.random.default_rng(seed)).random(n)
    values = np.column_stack(
        [tolerances[i % d].distribution.ppf(points[:, i]) for i in range(2 * d)]
    )
    A, B = values[:, :d], values[:, d:]
    mixed = np.repeat(A[None], d, axis=0)
    for i in range(d):
        mixed[i, :, i] = B[:, i]
    return np.concatenate([A[None], B[None], mixed])


def cases(
    brake: Brake,
    tolerances: Sequence[Tolerance],
    deviates: Floats,
    model: str = "fem",
    **options: Any,
) -> list[Case]:
    """The brake with the deviates (..., d) added to its keys, a case each, in their order.

    Raises BadInput where a key of every shoe ("shoe.lining.thickness") would undo that of one
    ("shoe[0].lining...").
    """
    _check_keys({key for tolerance in tolerances for key in tolerance.moves})
    keys = {key: value_of(brake, key) for tolerance in tolerances for key in tolerance.moves}
    slopes = np.array([[tolerance.moves.get(key, 0.0) for key in keys] for tolerance in tolerances])
    values = np.array([*keys.values()]) + deviates.reshape(-1, len(tolerances)) @ slopes
    return [
        Case(brake, dict(zip(keys, row, strict=True)), model, options) for row in values.tolist()
    ]


def _check_keys(keys: set[str]) -> None:
    """Raise BadInput where two keys mean the same number."""
    whole = {key: re.sub(r"\[\d+\]", "", key) for key in keys}
    for key, bare in whole.items():
        if key == bare and list(whole.values()).count(bare) > 1:
            raise BadInput(
                f"tolerances: {key} means every one, and another tolerance moves one of them; name each"
            )


def numbers(rows: Sequence[Row], name: str) -> Floats:
    """One number of every row, (rows,). Raises NoAnswer where a case has none: shares of a variance
    need all.
    """
    failed = [str(row["status"]) for row in rows if row["status"] != "solved"]
    if failed:
        raise NoAnswer(
            f"tolerances: {len(failed)} of {len(rows)} cases have no answer; the first: {failed[0]}"
        )
    return np.array([row[name] for row in rows], dtype=float)


class Spread(NamedTuple):
    """A distribution: mean, standard deviation, both in the quantity's unit, and the PERCENTILES."""

    mean: float
    deviation: float
    percentiles: tuple[float, ...]

    @property
    def relative(self) -> float:
        """Standard deviation over mean."""
        return self.deviation / self.mean


def spread(values: Floats) -> Spread:
    """The distribution of values (n,)."""
    return Spread(
        float(values.mean()),
        float(values.std(ddof=1)),
        tuple(np.percentile(values, PERCENTILES).tolist()),
    )


class Share(NamedTuple):
    """A Sobol index with its confidence interval."""

    value: float
    low: float
    high: float


class Shares(NamedTuple):
    """What share of a variance a deviate has: alone (`first`), and with all that it does jointly
    (`total`).
    """

    name: str
    first: Share
    total: Share


def shares(
    tolerances: Sequence[Tolerance],
    values: Floats,
    *,
    seed: int,
    confidence: float = 0.95,
    resamples: int = 400,
) -> list[Shares]:
    """Sobol indices of values (d + 2, n) on the draws of `draw`; confidence intervals by bootstrap
    of the n.

    The estimators of Saltelli et al. (2010), table 2 (b) and (f), of scipy.stats.sobol_indices.
    """
    rng = np.random.default_rng(seed)
    n = values.shape[1]
    found = _indices(values)
    again = np.array([_indices(values[:, rng.integers(n, size=n)]) for _ in range(resamples)])
    low, high = np.quantile(again, [(1 - confidence) / 2, (1 + confidence) / 2], axis=0)
    return [
        Shares(
            tolerance.name,
            *(Share(float(found[k, i]), float(low[k, i]), float(high[k, i])) for k in (0, 1)),
        )
        for i, tolerance in enumerate(tolerances)
    ]


def _indices(values: Floats) -> Floats:
    """First and total indices (2, d)."""
    from scipy.stats import sobol_indices  # noqa: PLC0415  (0.5 s)

    A, B, AB = values[:1], values[1:2], values[2:, None]
    found = sobol_indices(func={"f_A": A, "f_B": B, "f_AB": AB}, n=values.shape[1])
    return np.array([np.reshape(found.first_order, -1), np.reshape(found.total_order, -1)])


def healing(
    brake: Brake, distances: Sequence[float], *, elements: int, tolerance: float = 3e-3
) -> dict[str, Any]:
    """Torque [N m] and peak pressure [Pa] of a new brake on a round drum as it runs in, at the
    sliding distances [m].

    Archard's wear with the coefficient run_in.COEFFICIENT, until p and torque are settled; they
    stay from there on.
    """
    round_ = vary(brake, {"drum.out_of_round": []})
    setup = fem_setup(prepare(round_, elements=elements), round_)
    states = run_in.run_in(setup, tolerance=tolerance)
    found = [archard.at(states, min(s, states[-1].s)) for s in distances]
    return {
        "torque": [state.torque for state in found],
        "peak_pressure": [run_in.peak(setup, state) for state in found],
        "worn_in": run_in.target(setup).torque,
    }
