"""Consistency checks: two ways to compute one quantity must agree, on random brakes.

For example, a holding brake whose drum is rotated to full slip must end with the torque of the
sliding brake, and an exact derivative must agree with the difference of two solves. Each module
`consistency_*` draws the random brake of a seed, computes its quantities in both ways, called
paths, and returns a row for each quantity.
"""

from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

OUTCOMES_OF_TWO_PATH_COMPARISON = ("agrees", "said", "differs", "refused")
"""The possible outcomes of comparing one quantity by two paths.

"said" means that the values differ and that drumlin itself prints the reason. "refused" means that
neither path gives a value. "differs" is a fault of drumlin.
"""


class TwoPathComparison(NamedTuple):
    """The comparison of one quantity of a random brake, computed by two paths.

    Attributes
    ----------
    check : str
        Name of the check, which says what two paths are compared.
    brake : str
        Kind and seed of the brake, so that it can be drawn again.
    quantity : str
        Name of the quantity.
    difference : float
        Relative difference of the two values.
    allowed : float
        Largest difference that counts as agreement.
    said : str
        Line in which drumlin prints why the values differ, or why it refuses the brake; "" if
        drumlin prints no reason.
    refused : bool
        Whether neither path gives a value.
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
        """The outcome of the comparison, one of OUTCOMES_OF_TWO_PATH_COMPARISON."""
        if self.refused:
            return "refused"
        if self.difference <= self.allowed:
            return "agrees"
        return "said" if self.said else "differs"


class ComparisonOutcomeCounts(NamedTuple):
    """The numbers of comparisons of one check that ended with each outcome.

    Attributes
    ----------
    check : str
        Name of the check, which says what two paths are compared.
    compared : int
        Number of comparisons in which at least one path gives a value.
    agree, said, differ, refused : int
        Number of comparisons with each outcome.
    largest : float
        Largest ratio of the difference to the allowed difference, among comparisons that agree.
    """

    check: str
    compared: int
    agree: int
    said: int
    differ: int
    refused: int
    largest: float


def counts_of_comparison_outcomes_by_check(
    rows: Sequence[TwoPathComparison],
) -> list[ComparisonOutcomeCounts]:
    """Count the outcomes of comparisons; returns counts for each check, in order of appearance."""
    rows_of: dict[str, list[TwoPathComparison]] = {}
    for row in rows:
        rows_of.setdefault(row.check, []).append(row)
    counts = []
    for check, own in rows_of.items():
        outcomes = Counter(row.outcome for row in own)
        used = [row.difference / row.allowed for row in own if row.outcome == "agrees"]
        counts.append(
            ComparisonOutcomeCounts(
                check=check,
                # A comparison without a value on either path is not counted as compared.
                compared=len(own) - outcomes["refused"],
                agree=outcomes["agrees"],
                said=outcomes["said"],
                differ=outcomes["differs"],
                refused=outcomes["refused"],
                # The largest ratio of a difference to its allowed difference; at 1 the allowance is
                # used up.
                largest=max(used, default=0.0),
            )
        )
    return counts
