"""Tables of many trials (see `trial`): faults, counts, worst answers, times and penalties."""

import math
import statistics
from collections import Counter
from collections.abc import Sequence
from typing import Any

from drumlin_studies.tables import matching_rows, rows_with_value, values_of_key
from drumlin_studies.trial import TRIAL_FAULTS

Row = dict[str, Any]
POINTWISE_OUTCOMES = (
    "agrees",
    "differs",
    "cycles",
    "does not end",
    "singular",
    "a number where there is none",
    "not for rings",
    "not tried: too large",
)
"""What can become of a case by the pointwise penalty."""
TIME_KEYS = ("seconds", "seconds_whole", "pointwise_seconds", "steps", "pointwise_steps")
"""Keys of a row that hold times [s] and numbers of steps."""


def fault_rows(rows: Sequence[Row]) -> list[Row]:
    """The rows that are neither right nor refused for a physical reason."""
    return [row for row in rows if row["outcome"] in TRIAL_FAULTS]


def rows_of_fewest_digits(rows: Sequence[Row], count: int = 10) -> list[Row]:
    """The rows whose answers have the fewest correct digits."""
    return sorted(rows_with_value(rows, "digits"), key=lambda row: row["digits"])[:count]


def _rows_by_knob(rows: Sequence[Row]) -> dict[str, list[Row]]:
    """The rows of each knob by its name, and all rows under the name "all"."""
    groups: dict[str, list[Row]] = {}
    for row in rows:
        groups.setdefault(row["knob"], []).append(row)
    return groups | {"all": list(rows)}


def count_values_by_knob(rows: Sequence[Row], key: str, names: Sequence[str]) -> list[Row]:
    """How often each value of a key occurs, in a row for each knob and a row for all.

    key : key of the rows; names : the values that are counted, None where there are none.
    """
    table = []
    for knob, own in _rows_by_knob(rows).items():
        count = Counter(row.get(key) for row in own)
        line: Row = {"knob": knob, "cases": len(own)}
        for name in names:
            line[name] = count[name] or None
        table.append(line)
    return table


def time_rows_by_knob(rows: Sequence[Row]) -> list[Row]:
    """Medians and largest values of TIME_KEYS, in a row for each knob and a row for all."""
    table = []
    for knob, own in _rows_by_knob(rows).items():
        line: Row = {"knob": knob, "cases": len(own)}
        for key in TIME_KEYS:
            # A case that is refused early has no times.
            values = values_of_key(rows_with_value(own, key), key)
            line[key] = statistics.median(values) if values else None
            line[f"most_{key}"] = max(values) if values else None
        table.append(line)
    return table


def torque_change_by_penalty(rows: Sequence[Row]) -> dict[str, list[tuple[float, float]]]:
    """The relative change of the torque by a finite penalty, for each sweep of the penalty.

    A sweep is a list of penalty factors and changes, by its name.
    """
    found: dict[str, list[tuple[float, float]]] = {}
    swept = matching_rows(rows, knob="penalty", outcome="answer")
    for clearance, name in (
        (0.0, "whole lining in contact, stiff shoe"),
        (1e-4, "partial contact, soft shoe"),
    ):
        torque: dict[float, float] = {}
        for row in swept:
            if row["knobs"]["clearance"] == clearance:
                torque[row["knobs"]["penalty"]] = row["torque"]
        # Changes are relative to exact contact, which an infinite penalty stands for.
        if math.inf not in torque:
            continue
        exact = torque.pop(math.inf)
        found[name] = [(penalty, abs(t / exact - 1)) for penalty, t in sorted(torque.items())]
    return found


def penalty_rows(rows: Sequence[Row]) -> list[Row]:
    """The rows of the penalty sweep with the whole lining in contact.

    They are given the `penalty` and the relative `change` of the torque by it.
    """
    swept = []
    for row in matching_rows(rows, knob="penalty"):
        if row["knobs"]["clearance"] == 0:
            swept.append({**row, "penalty": row["knobs"]["penalty"]})
    exact = matching_rows(swept, penalty=math.inf)[0]["torque"]
    for row in swept:
        row["change"] = row["torque"] / exact - 1
    return swept


def penalty_error_slope(
    values: Sequence[tuple[float, float]], low: float = 1e2, high: float = 1e6
) -> float:
    """Slope of log error over log penalty between two penalties `low` and `high`."""
    inside = [(math.log(a), math.log(e)) for a, e in values if low <= a <= high and e > 0]
    return (inside[-1][1] - inside[0][1]) / (inside[-1][0] - inside[0][0])
