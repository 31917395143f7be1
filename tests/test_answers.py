"""The comparison of two files of answers sees differences but not times or reordered sums."""

import pytest

from answers import differences

BEFORE = {"torque": 1.0, "seconds": {"solve": 2.0}, "p": [1e6, 0.0, 2e6], "words": ["a", "b"]}


def test_times_and_reordered_operations_are_no_differences():
    after = BEFORE | {"seconds": {"solve": 3.0}, "p": [1e6, 1e-5, 2e6], "torque": 1.0 + 1e-12}
    assert list(differences(BEFORE, after)) == []


@pytest.mark.parametrize(
    "change",
    [
        {"torque": 1.0 + 1e-8},
        {"p": [1e6, 1.0, 2e6]},
        {"p": [1e6]},
        {"words": ["a", "c"]},
        {"more": 1},
    ],
)
def test_other_numbers_words_and_keys_are(change):
    assert list(differences(BEFORE, BEFORE | change)) != []
