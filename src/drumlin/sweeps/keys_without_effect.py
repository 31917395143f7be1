"""Which varied keys of a sweep change no result of a law.

A law of rigid shoes knows no clearance, no body and often no modulus. A sweep of such a key by a
law has the same results in all cases, which looks like an answer.
"""

import json
import math
from collections.abc import Mapping, Sequence
from typing import Any

from drumlin.sweeps.cases import CaseResultsByName, SweepCase, solve_case_without_raising

MODELS_WHOSE_RESULTS_DEPEND_ON_ALL_KEYS = {"fem", "solid"}
"""Models whose results depend on all geometry, loads and stiffnesses of a brake.

They are not solved anew for the question, because one case takes as long as many cases of a law.
"""

MOST_CASES_WHOSE_KEY_VALUES_ARE_READ = 1000
"""Largest number of cases whose values of a key are read, evenly among all; reading takes time."""

MOST_KEY_VALUES_TRIED_WITH_LAW = 4
"""Largest number of values of a key with which a law is solved anew.

A key may have an effect only from some value on, such as the threshold of a cylinder. Two values
could both lie below. More values cost time, some milliseconds each.
"""

RELATIVE_DIFFERENCE_OF_EQUAL_LAW_RESULTS = 1e-9
"""Relative difference of two results of a law up to which they are equal but for round-off.

Round-off of the laws is some 1e-12. A key with an effect below a billionth has none for a user.
"""


def notes_on_keys_without_effect(
    cases: Sequence[SweepCase], rows: Sequence[CaseResultsByName]
) -> tuple[str, ...]:
    """A line for each law of a sweep whose results do not depend on some of the varied keys.

    For each key the first and the last case of the law are solved anew, with other values of this
    key alone. There is no line if solved cases that differ in this key alone have other results.
    `rows` are the results of the cases.
    """
    notes = []
    for model in dict.fromkeys(case.model for case in cases):
        if model in MODELS_WHOSE_RESULTS_DEPEND_ON_ALL_KEYS:
            continue
        numbers = [number for number, case in enumerate(cases) if case.model == model]
        own, own_rows = [cases[number] for number in numbers], [rows[number] for number in numbers]
        keys = [
            key
            for key in own[0].changes
            if _has_key_no_effect_in_first_and_last_case(own, key)
            and _have_cases_that_differ_in_key_equal_results(own, own_rows, key)
        ]
        if keys:
            notes.append(f"{model} does not use {', '.join(keys)}: no result depends on it")
    return tuple(notes)


def _has_key_no_effect_in_first_and_last_case(cases: Sequence[SweepCase], key: str) -> bool:
    """Whether the values of a key, put into the first and last case of a law, change no result.

    The result is False if in both cases fewer than two of the values have an answer.
    """
    read = cases[:: max(len(cases) // MOST_CASES_WHOSE_KEY_VALUES_ARE_READ, 1)]
    values = {json.dumps(case.changes[key], default=str): case.changes[key] for case in read}
    step = max(len(values) // MOST_KEY_VALUES_TRIED_WITH_LAW, 1)
    tried = list(values.values())[::step][:MOST_KEY_VALUES_TRIED_WITH_LAW]
    is_known = False
    for base in (cases[0], cases[-1]):
        rows = []
        for value in tried:
            case = base._replace(changes={**base.changes, key: value})
            row = solve_case_without_raising(case).row
            if row["status"] == "solved":
                rows.append(row)
        if not all(_are_results_equal(rows[0], row) for row in rows[1:]):
            return False
        is_known = is_known or len(rows) > 1
    return is_known


def _have_cases_that_differ_in_key_equal_results(
    cases: Sequence[SweepCase], rows: Sequence[CaseResultsByName], key: str
) -> bool:
    """Whether all solved cases of a law that differ in one key alone have equal results.

    `rows` are the results of the cases. The key may have an effect only with some values of other
    keys: the direction of a force has none where the force is zero.
    """
    first_rows: dict[str, CaseResultsByName] = {}
    for case, row in zip(cases, rows, strict=True):
        if row["status"] == "solved":
            others = {name: value for name, value in case.changes.items() if name != key}
            first = first_rows.setdefault(json.dumps(others, default=str), row)
            if not _are_results_equal(first, row):
                return False
    return True


def _are_results_equal(row: CaseResultsByName, other: CaseResultsByName) -> bool:
    """Whether two cases have the same results but for round-off; their balances are round-off."""
    return row.keys() == other.keys() and all(
        _are_values_equal(row, other, name) for name in row if name != "balance"
    )


def _are_values_equal(row: Mapping[str, Any], other: Mapping[str, Any], name: str) -> bool:
    """Whether two cases have the same value of a result, but for round-off."""
    one, two = row[name], other[name]
    if isinstance(one, float) and isinstance(two, float):
        return math.isclose(one, two, rel_tol=RELATIVE_DIFFERENCE_OF_EQUAL_LAW_RESULTS)
    return bool(one == two)
