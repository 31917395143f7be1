"""Two ways to the same quantity agree on random brakes, or drumlin says why they do not."""

from itertools import chain, product

import pytest

from conftest import partly
from drumlin.studies import import_study_and_find_folder_above_studies
from drumlin_studies import consistency_refused
from drumlin_studies.consistency import TwoPathComparison, counts_of_comparison_outcomes_by_check
from picking import having, picked

WAYS = import_study_and_find_folder_above_studies("stability")[0].ways.PATH_CHECKS
# Seeds of brakes on which nothing was mended, nor shown by the study.
FIRST_SEED = 300_000
# Number of brakes that the fast test takes.
SHARE = {"refusals": 1, "holding": 6, "wear": 2, "slopes": 4, "blocks": 1}
# Brakes up to which the slow test goes on.
UP_TO = {"refusals": 150, "holding": 60, "wear": 50, "slopes": 50, "blocks": 4}


# Blocks take three seconds a brake.
PARTS = partly(
    product(WAYS, (0, 1)), [(name, 0) for name in WAYS if name not in ("blocks", "slopes")]
)


@pytest.mark.parametrize(("name", "part"), PARTS)
def test_two_ways_to_one_quantity_agree_or_say_why_not(name, part):
    first, last = (0, SHARE[name]) if part == 0 else (SHARE[name], UP_TO[name])
    seeds = range(FIRST_SEED + first, FIRST_SEED + last)
    rows = list(chain.from_iterable(map(WAYS[name].checks, seeds)))
    assert having(rows, outcome="differs") == []
    answered = [row for row in rows if row.outcome != "refused"]
    # Of the brakes that the default solve answers, one in ten is compared with three meshes. Meshes
    # that disagree prove nothing: at least half of these brakes must remain.
    assert (
        len(answered)
        >= 0.5 * len(seeds) / consistency_refused.SOLVED_BRAKES_PER_ONE_CHECKED_ON_UNIFORM_MESHES
    )


def test_a_difference_beyond_what_is_allowed_counts_unless_it_is_said():
    row = TwoPathComparison("holding", "hinge 1", "torque", 2e-3, 1e-3)
    said, refused = row._replace(said="held, it ends elsewhere"), row._replace(refused=True)
    near = row._replace(difference=5e-4)
    assert picked((row, said, refused, near), "outcome") == [
        "differs",
        "said",
        "refused",
        "agrees",
    ]
    (count,) = counts_of_comparison_outcomes_by_check([row, said, refused, near, near])
    assert count == ("holding", 4, 2, 1, 1, 1, 0.5)
