"""The checks of two paths to one quantity: which the study makes, and on how many brakes."""

from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from multiprocessing import get_context
from typing import Any, NamedTuple

from drumlin.base.journal import JournalOfCaseResults
from drumlin_studies import (
    consistency_blocks,
    consistency_hold,
    consistency_refused,
    consistency_slopes,
    consistency_wear,
)
from drumlin_studies.consistency import TwoPathComparison

WORKERS = 2
"""Number of processes."""
FIRST_SEED = 200_000
"""First seed of the brakes. No error of drumlin was found and repaired on these brakes."""


class PathCheck(NamedTuple):
    """A check on random brakes: its title, the rows of a seed, and the number of brakes."""

    title: str
    checks: Callable[[int], list[TwoPathComparison]]
    brakes: int


PATH_CHECKS = {
    "refusals": PathCheck(
        "Refused by levels, and by three meshes",
        consistency_refused.rows_comparing_default_solve_with_meshes,
        2000,
    ),
    "holding": PathCheck(
        "The holding brake at full slip, and the sliding brake",
        consistency_hold.rows_comparing_torques_of_hold_and_solve,
        600,
    ),
    "wear": PathCheck(
        "Wear at its start and end, the sliding and the worn-in brake",
        consistency_wear.rows_of_wear_checks_of_random_brake,
        600,
    ),
    "slopes": PathCheck(
        "Printed slopes, and central differences",
        consistency_slopes.rows_comparing_torque_slopes_of_random_brake,
        600,
    ),
    "blocks": PathCheck(
        "True errors of linings with 7 to 30 blocks, and stated ones",
        consistency_blocks.rows_comparing_stated_with_true_errors_of_block_linings,
        100,
    ),
}


def study(
    journal: JournalOfCaseResults,
    *,
    short: bool = False,
    say: Callable[[str], None] = lambda _: None,
) -> list[TwoPathComparison]:
    """All comparisons, in two processes.

    short : whether two brakes of each check, in this process, are enough.
    """
    rows = []
    for name, way in PATH_CHECKS.items():
        say(way.title)
        count = 2 if short else way.brakes
        keys = {
            seed: {"of": "ways", "name": name, "seed": seed}
            for seed in range(FIRST_SEED, FIRST_SEED + count)
        }
        left = [seed for seed, key in keys.items() if key not in journal]
        make = partial(_check_rows, name)
        if short:
            for seed in left:
                journal.add(keys[seed], make(seed))
        else:
            with ProcessPoolExecutor(WORKERS, mp_context=get_context("spawn")) as pool:
                made = zip(left, pool.map(make, left, chunksize=4), strict=True)
                for done, (seed, row) in enumerate(made, 1):
                    journal.add(keys[seed], row)
                    if done % 50 == 0:
                        say(f"{way.title}: {done} of {len(left)}")
        rows += [TwoPathComparison(**row) for key in keys.values() for row in journal[key]["rows"]]
    return rows


def _check_rows(name: str, seed: int) -> dict[str, Any]:
    """The rows of a check and a seed, in the form that a journal keeps."""
    return {"rows": [check._asdict() for check in PATH_CHECKS[name].checks(seed)]}
