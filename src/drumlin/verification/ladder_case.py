"""A row of the benchmark ladder: what is known, where from, and what gives drumlin's number."""

from collections.abc import Callable
from dataclasses import dataclass

EXACT = "round-off"
PRINTED = "printed digits"
DISCRETE = "discretisation"
MODEL = "limit of the model"


@dataclass(frozen=True)
class Case:
    """A known answer. `family`: what kind of case; `shows`: what of drumlin it judges; `source`: of `expected`.

    `tolerance`: relative; `tier`: why it is as large as it is, one of EXACT, PRINTED, DISCRETE (a mesh of finite
    size), MODEL (the case is a limit that drumlin's own case only tends to). `found`: what drumlin gives.
    """

    family: str
    shows: str
    source: str
    quantity: str
    expected: float
    tolerance: float
    tier: str
    found: Callable[[], float]
