"""Two ways of drumlin to the same quantity, held against each other on random brakes.

A holding brake that is turned to full slip must end where the sliding brake is, wear must begin
there, and an exact slope must be the difference of two solves. Each module `consistency_*` draws
the random brake of a seed, takes both ways and returns one row for each quantity that it compared.
"""

from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

CHECK_OUTCOMES = ("agrees", "said", "differs", "refused")


class Check(NamedTuple):
    """One quantity of one random brake, by two ways.

    `check`: what is held against what; `brake`: kind and seed, so that the brake can be drawn
    again; `quantity`: what is compared; `difference`: relative difference of the two values;
    `allowed`: the largest difference that counts as agreement; `said`: the line in which drumlin
    itself says that and why the two differ, or refuses both, empty where drumlin says nothing;
    `refused`: whether neither way has an answer.
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
        """One of CHECK_OUTCOMES; "differs" is a fault of drumlin."""
        if self.refused:
            return "refused"
        if self.difference <= self.allowed:
            return "agrees"
        return "said" if self.said else "differs"


class Count(NamedTuple):
    """How the comparisons of one check ended.

    `compared`: rows in which at least one way has an answer; `agree`, `said`, `differ`, `refused`:
    rows of each outcome; `largest`: largest difference over what is allowed among those that agree.
    """

    check: str
    compared: int
    agree: int
    said: int
    differ: int
    refused: int
    largest: float


def counted(rows: Sequence[Check]) -> list[Count]:
    """How the rows of each check ended, checks in the order of their first row."""
    found = []
    for check in dict.fromkeys(row.check for row in rows):
        own = [row for row in rows if row.check == check]
        outcomes = Counter(row.outcome for row in own)
        largest = max(
            (row.difference / row.allowed for row in own if row.outcome == "agrees"), default=0.0
        )
        found.append(
            Count(
                check=check,
                compared=len(own) - outcomes["refused"],
                agree=outcomes["agrees"],
                said=outcomes["said"],
                differ=outcomes["differs"],
                refused=outcomes["refused"],
                largest=largest,
            )
        )
    return found
