"""The comparison of two files of answers finds differences, but ignores times and round-off."""

import pytest

from answers import TIMES, differences

BEFORE = {"torque": 1.0, "seconds": {"solve": 2.0}, "p": [1e6, 0.0, 2e6], "words": ["a", "b"]}


def test_times_paths_and_reordered_operations_are_no_differences():
    after = BEFORE | {"seconds": {"solve": 3.0}, "p": [1e6, 1e-5, 2e6], "torque": 1.0 + 1e-12}
    before = BEFORE | {"brake_file": "here/brake.toml"}
    assert list(differences(before, after | {"brake_file": "there/brake.toml"})) == []


def test_the_phases_of_a_solve_are_no_words():
    printed = "9 steps; ms: mesh 1.5,\n  contact 2.5\nsolved on 2 meshes\n"
    assert TIMES.sub("<time>", printed) == "9 steps; <time>\nsolved on 2 meshes\n"


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
