"""Tables of many trials. A trial is the solve of a brake with extreme parameters.

The tables show the faults, the number of trials with each outcome, the answers with the largest
errors, run times, and the effect of the contact penalty. A knob is a quantity of the brake or of
its solve that the trials vary.
"""

import math
import statistics
from collections import Counter
from collections.abc import Sequence
from typing import Any

from drumlin_studies.tables import (
    rows_that_have_value_of_key,
    rows_with_given_values,
    values_of_key_in_rows,
)
from drumlin_studies.trial import TRIAL_OUTCOMES_THAT_ARE_FAULTS_OF_DRUMLIN

TrialRow = dict[str, Any]
"""A row of a table: the values of a trial by key."""
OUTCOMES_OF_POINTWISE_PENALTY_TRIALS = (
    "agrees",
    "differs",
    "cycles",
    "does not end",
    "singular",
    "a number where there is none",
    "not for rings",
    "not tried: too large",
)
"""All outcomes of a trial by the pointwise penalty, the contact method of textbooks.

"a number where there is none" means that the method gives an answer to a case that drumlin refuses.
"""
ROW_KEYS_OF_TIMES_AND_ITERATION_COUNTS = (
    "seconds",
    "seconds_whole",
    "pointwise_seconds",
    "steps",
    "pointwise_steps",
)
"""Keys of a row that hold times [s] and numbers of iterations."""


def trial_rows_with_fault_as_outcome(rows: Sequence[TrialRow]) -> list[TrialRow]:
    """The rows of trials that ended with a fault: no right answer, and no refusal with a reason."""
    return [row for row in rows if row["outcome"] in TRIAL_OUTCOMES_THAT_ARE_FAULTS_OF_DRUMLIN]


def rows_with_fewest_correct_digits(rows: Sequence[TrialRow], count: int = 10) -> list[TrialRow]:
    """The `count` rows whose torques have the fewest correct digits, fewest first."""
    return sorted(rows_that_have_value_of_key(rows, "digits"), key=lambda row: row["digits"])[
        :count
    ]


def _group_rows_by_varied_quantity(rows: Sequence[TrialRow]) -> dict[str, list[TrialRow]]:
    """The rows in groups, by the quantity (knob) that a trial varies; group "all" has all rows."""
    groups: dict[str, list[TrialRow]] = {}
    for row in rows:
        groups.setdefault(row["knob"], []).append(row)
    return groups | {"all": list(rows)}


def count_row_values_by_varied_quantity(
    rows: Sequence[TrialRow], key: str, names: Sequence[str]
) -> list[TrialRow]:
    """A row for each varied quantity (knob) with counts of the values of a key.

    The last row counts over all trials. A count of zero is None.

    rows : the rows of the trials; key : key of these rows; names : the values that are counted.
    """
    table = []
    for knob, own in _group_rows_by_varied_quantity(rows).items():
        count = Counter(row.get(key) for row in own)
        line: TrialRow = {"knob": knob, "cases": len(own)}
        for name in names:
            line[name] = count[name] or None
        table.append(line)
    return table


def solve_time_rows_by_varied_quantity(rows: Sequence[TrialRow]) -> list[TrialRow]:
    """A row for each varied quantity (knob) with median and largest times and iteration counts.

    The last row is for all trials.
    """
    table = []
    for knob, own in _group_rows_by_varied_quantity(rows).items():
        line: TrialRow = {"knob": knob, "cases": len(own)}
        for key in ROW_KEYS_OF_TIMES_AND_ITERATION_COUNTS:
            # A trial that drumlin refuses before the solve has no times and is left out here.
            values = values_of_key_in_rows(rows_that_have_value_of_key(own, key), key)
            line[key] = statistics.median(values) if values else None
            line[f"most_{key}"] = max(values) if values else None
        table.append(line)
    return table


def relative_torque_changes_due_to_penalty(
    rows: Sequence[TrialRow],
) -> dict[str, list[tuple[float, float]]]:
    """The relative change of the torque that a finite penalty causes.

    The result has a list of pairs (penalty factor, change) for each of two brakes. In one brake the
    whole lining is in contact, in the other a part of the lining. The changes have no sign.
    """
    found: dict[str, list[tuple[float, float]]] = {}
    swept = rows_with_given_values(rows, knob="penalty", outcome="answer")
    for clearance, name in (
        (0.0, "whole lining in contact, stiff shoe"),
        (1e-4, "partial contact, soft shoe"),
    ):
        torque: dict[float, float] = {}
        for row in swept:
            if row["knobs"]["clearance"] == clearance:
                torque[row["knobs"]["penalty"]] = row["torque"]
        # An infinite penalty stands for exact contact, to which the changes are relative.
        if math.inf not in torque:
            continue
        exact = torque.pop(math.inf)
        found[name] = [(penalty, abs(t / exact - 1)) for penalty, t in sorted(torque.items())]
    return found


def trial_rows_with_varied_penalty(rows: Sequence[TrialRow]) -> list[TrialRow]:
    """The rows of the trials in which the penalty varies and the whole lining is in contact.

    Each row gets two further keys: `penalty`, the penalty factor, and `change`, the relative
    difference of the torque from the torque with exact contact.
    """
    swept = []
    for row in rows_with_given_values(rows, knob="penalty"):
        if row["knobs"]["clearance"] == 0:
            swept.append({**row, "penalty": row["knobs"]["penalty"]})
    exact = rows_with_given_values(swept, penalty=math.inf)[0]["torque"]
    for row in swept:
        row["change"] = row["torque"] / exact - 1
    return swept


def log_slope_of_error_over_penalty(
    values: Sequence[tuple[float, float]], low: float = 1e2, high: float = 1e6
) -> float:
    """Slope of log(error) against log(penalty factor), between two penalty factors.

    values : pairs of a penalty factor and an error, in the order of the factors; low, high : the
    slope is taken between the first and the last factor in this range.
    """
    inside = [(math.log(a), math.log(e)) for a, e in values if low <= a <= high and e > 0]
    return (inside[-1][1] - inside[0][1]) / (inside[-1][0] - inside[0][0])
