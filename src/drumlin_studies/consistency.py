"""Checks that two paths through drumlin lead to the same number, on random brakes.

For example, a holding brake that is turned to full slip must end with the torque of the sliding
brake, and an exact slope must agree with the difference of two solves. Each module `consistency_*`
draws the random brake of a seed, follows both paths and returns a row for each quantity.
"""

from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

CHECK_OUTCOMES = ("agrees", "said", "differs", "refused")
"""How a comparison can end.

"said" means that the numbers differ and that drumlin itself tells the reason; "refused" that both
paths have no answer. "differs" is a fault of drumlin.
"""


class Check(NamedTuple):
    """One quantity of one random brake, by two paths.

    Attributes
    ----------
    check : str
        Which paths are compared.
    brake : str
        Kind and seed, so that the brake can be drawn again.
    quantity : str
        What is compared.
    difference : float
        Relative difference of the two values.
    allowed : float
        Largest difference that counts as agreement.
    said : str
        The line in which drumlin tells that and why the two differ, or why it refuses both; empty
        where drumlin says nothing.
    refused : bool
        Whether neither path has an answer.
    """

    check: str
    brake: str
    quantity: str
    difference: float
    allowed: float
    said: str = ""
    refused: bool = False

    @property
    def outcome(self) -> str:
        """How the comparison ended, one of CHECK_OUTCOMES."""
        if self.refused:
            return "refused"
        if self.difference <= self.allowed:
            return "agrees"
        return "said" if self.said else "differs"


class Count(NamedTuple):
    """How many comparisons of one check ended with each outcome.

    Attributes
    ----------
    check : str
        Which paths are compared.
    compared : int
        Number of rows in which at least one path has an answer.
    agree, said, differ, refused : int
        Number of rows of each outcome.
    largest : float
        Largest difference over the allowed difference, among the rows that agree.
    """

    check: str
    compared: int
    agree: int
    said: int
    differ: int
    refused: int
    largest: float


def count_outcomes(rows: Sequence[Check]) -> list[Count]:
    """The number of rows of each outcome, for each check in the order of its first row."""
    rows_of: dict[str, list[Check]] = {}
    for row in rows:
        rows_of.setdefault(row.check, []).append(row)
    counts = []
    for check, own in rows_of.items():
        outcomes = Counter(row.outcome for row in own)
        used = [row.difference / row.allowed for row in own if row.outcome == "agrees"]
        counts.append(
            Count(
                check=check,
                # A brake that both paths refuse has no numbers to compare.
                compared=len(own) - outcomes["refused"],
                agree=outcomes["agrees"],
                said=outcomes["said"],
                differ=outcomes["differs"],
                refused=outcomes["refused"],
                # 1 would mean that a difference is as large as is allowed.
                largest=max(used, default=0.0),
            )
        )
    return counts
