"""The benchmark ladder: every case within its tolerance, and closed forms judged by their limits."""

import math

import pytest

from drumlin.verification.ladder import CASES, families, within


@pytest.mark.parametrize("case", CASES, ids=lambda case: f"{case.family}: {case.quantity}".replace(" ", "_"))
def test_every_case_is_within_its_tolerance(case):
    value = case.found()
    assert within(case, value), f"{value!r} for {case.expected!r}, {value / case.expected - 1:.2e} off"
    assert not within(case, 1.1 * value)
    assert not within(case, value / 1.1)
    assert not within(case, math.nan)


def test_the_ladder_has_forty_families_each_with_its_source():
    assert len(families()) >= 40
    assert all(case.source and case.shows for case in CASES)
    assert len({(case.family, case.quantity) for case in CASES}) == len(CASES)
    assert all(0 < case.tolerance <= 0.03 for case in CASES)
