"""A case of the benchmark ladder: a known result, its source, and the computation by drumlin."""

from collections.abc import Callable
from dataclasses import dataclass

TOLERANCE_REASON_ROUND_OFF = "round-off"
"""Reason of a case's tolerance: round-off alone. drumlin evaluates the same formula or equilibrium
as the source.
"""
TOLERANCE_REASON_PRINTED_DIGITS = "digits given"
"""Reason of a case's tolerance: half a unit of the last digit that the source prints."""
TOLERANCE_REASON_DISCRETISATION = "discretisation"
"""Reason of a case's tolerance: the discretisation error of drumlin's mesh."""
TOLERANCE_REASON_MODEL_LIMIT = "limit of the model"
"""Reason of a case's tolerance: the closed form holds in a limit, such as zero lining thickness.
The case is near this limit, but not at the limit.
"""


@dataclass(frozen=True)
class KnownAnswerCase:
    """A case of the benchmark ladder: a quantity with a known value, and drumlin's value of it.

    Attributes
    ----------
    family : str
        Name of the group of similar cases.
    shows : str
        What the case tests of drumlin, in words.
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
        Function without arguments that returns drumlin's value of the quantity.
    """

    family: str
    shows: str
    source: str
    quantity: str
    expected: float
    tolerance: float
    tier: str
    found: Callable[[], float]
