"""Two ways to the same quantity on random brakes: which checks the study makes, and on how many
brakes.
"""

from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from multiprocessing import get_context
from typing import Any, NamedTuple

from drumlin.base.journal import Journal
from drumlin_studies import (
    consistency_blocks,
    consistency_hold,
    consistency_refused,
    consistency_slopes,
    consistency_wear,
)
from drumlin_studies.consistency import Check

WORKERS = 2
FIRST_SEED = 200_000  # brakes on which nothing was mended


class Ways(NamedTuple):
    """A check on random brakes: its `title` for the page, what it makes of a seed, and of how many
    seeds.
    """

    title: str
    checks: Callable[[int], list[Check]]
    brakes: int


WAYS = {
    "refusals": Ways("Refused by levels, and by three meshes", consistency_refused.checks, 2000),
    "holding": Ways(
        "The holding brake at full slip, and the sliding brake", consistency_hold.checks, 600
    ),
    "wear": Ways(
        "Wear at its start and end, the sliding and the worn-in brake", consistency_wear.checks, 600
    ),
    "slopes": Ways("Printed slopes, and central differences", consistency_slopes.checks, 600),
    "blocks": Ways(
        "True errors of linings with 7 to 30 blocks, and stated ones",
        consistency_blocks.checks,
        100,
    ),
}


def study(
    journal: Journal, *, short: bool = False, say: Callable[[str], None] = lambda _: None
) -> list[Check]:
    """All comparisons, two brakes at a time; `short`: two brakes a check, here and one by one."""
    rows = []
    for name, way in WAYS.items():
        say(way.title)
        count = 2 if short else way.brakes
        keys = {
            seed: {"of": "ways", "name": name, "seed": seed}
            for seed in range(FIRST_SEED, FIRST_SEED + count)
        }
        left = [seed for seed, key in keys.items() if key not in journal]
        make = partial(_rows, name)
        if short:
            for seed in left:
                journal.add(keys[seed], make(seed))
        else:
            with ProcessPoolExecutor(WORKERS, mp_context=get_context("spawn")) as pool:
                for done, (seed, row) in enumerate(
                    zip(left, pool.map(make, left, chunksize=4), strict=True), 1
                ):
                    journal.add(keys[seed], row)
                    if done % 50 == 0:
                        say(f"{way.title}: {done} of {len(left)}")
        rows += [Check(**row) for key in keys.values() for row in journal[key]["rows"]]
    return rows


def _rows(name: str, seed: int) -> dict[str, Any]:
    return {"rows": [check._asdict() for check in WAYS[name].checks(seed)]}
