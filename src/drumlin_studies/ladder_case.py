"""A row of the benchmark ladder: what is known, where from, and what gives drumlin's number."""

from collections.abc import Callable
from dataclasses import dataclass

EXACT = "round-off"
PRINTED = "digits given"
DISCRETE = "discretisation"
MODEL = "limit of the model"


@dataclass(frozen=True)
class KnownAnswer:
    """A known answer. `family`: what kind of case; `shows`: what of drumlin it judges; `source`: of
    `expected`.

    `tolerance`: relative; `tier`: why it is as large as it is: EXACT, PRINTED (digits of the
    source), DISCRETE (a mesh of finite size) or MODEL (a limit that drumlin's case only tends to).
    `found`: what drumlin gives.
    """

    family: str
    shows: str
    source: str
    quantity: str
    expected: float
    tolerance: float
    tier: str
    found: Callable[[], float]
