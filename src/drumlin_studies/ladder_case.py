"""A case of the benchmark ladder: a known result, its source, and the computation by drumlin."""

from collections.abc import Callable
from dataclasses import dataclass

TOLERANCE_REASON_ROUND_OFF = "round-off"
"""Reason of a case's tolerance: only round-off, since drumlin computes the same formula or
equilibrium.
"""
TOLERANCE_REASON_PRINTED_DIGITS = "digits given"
"""Reason of a case's tolerance: half a unit of the last digit that the source prints."""
TOLERANCE_REASON_DISCRETISATION = "discretisation"
"""Reason of a case's tolerance: the discretisation error of drumlin's mesh."""
TOLERANCE_REASON_MODEL_LIMIT = "limit of the model"
"""Reason of a case's tolerance: the closed form holds in a limit, such as zero lining thickness,
that the case approaches but does not reach.
"""


@dataclass(frozen=True)
class KnownAnswerCase:
    """A case of the benchmark ladder: a quantity with a known value, and drumlin's value of it.

    Attributes
    ----------
    family : str
        Name of the group of similar cases.
    shows : str
        Part of drumlin that the case tests.
    source : str
        Source of the expected value.
    quantity : str
        Quantity that is compared, with its unit.
    expected : float
        Known value of the quantity.
    tolerance : float
        Largest relative difference that counts as agreement.
    tier : str
        Reason of the tolerance, one of the four texts above: TOLERANCE_REASON_ROUND_OFF,
        TOLERANCE_REASON_PRINTED_DIGITS, TOLERANCE_REASON_DISCRETISATION or
        TOLERANCE_REASON_MODEL_LIMIT.
    found : function
        Function that computes the quantity by drumlin.
    """

    family: str
    shows: str
    source: str
    quantity: str
    expected: float
    tolerance: float
    tier: str
    found: Callable[[], float]
