"""A case of the benchmark ladder: what is known, its source, and what drumlin finds."""

from collections.abc import Callable
from dataclasses import dataclass

EXACT = "round-off"
"""The tolerance is round-off: drumlin computes the same formula or the same balance."""
PRINTED = "digits given"
"""The tolerance is half a unit of the last digit that the source prints."""
DISCRETE = "discretisation"
"""The tolerance is the error of a mesh of finite size."""
MODEL = "limit of the model"
"""The tolerance is the distance of the case from a limit that the closed form describes."""


@dataclass(frozen=True)
class KnownAnswer:
    """A known answer.

    Attributes
    ----------
    family : str
        What kind of case it is.
    shows : str
        Which part of drumlin the case judges.
    source : str
        Where the expected value comes from.
    quantity : str
        What is compared, with its unit.
    expected : float
        The known value.
    tolerance : float
        Largest relative difference.
    tier : str
        Why the tolerance is as large as it is: EXACT, PRINTED, DISCRETE or MODEL.
    found : function
        Computes drumlin's value.
    """

    family: str
    shows: str
    source: str
    quantity: str
    expected: float
    tolerance: float
    tier: str
    found: Callable[[], float]
