"""Where a model's assumptions end: a warning beyond small strains, and where shoes lie in each other."""

import math
from collections.abc import Iterator
from itertools import combinations

from drumlin.brake.drum_brake import Brake, Shoe
from drumlin.brake.units import deg
from drumlin.errors import NoAnswer

LARGE_STRAIN = 0.05  # of the lining, p/E; small displacements are off by about as much
LARGEST_STRAIN = 10.0  # beyond it no scaled load is meant: the force or its unit is wrong


def check_strain(shoe: Shoe, peak: float) -> None:
    """Raise NoAnswer where the peak pressure [Pa] would press the lining in by many times its thickness."""
    if peak > LARGEST_STRAIN * shoe.lining.material.E:
        raise NoAnswer(
            f"shoe {shoe.name!r}: the lining would be pressed in by {peak / shoe.lining.material.E:.3g} times its "
            f"thickness; must be at most {LARGEST_STRAIN:g}, and small displacements are good up to {LARGE_STRAIN:g}"
        )


def warnings(brake: Brake, peaks: dict[str, float]) -> tuple[str, ...]:
    """What a reader must know before the numbers: one line each.

    peaks: name of a shoe -> its peak pressure [Pa].
    """
    strained = [
        f"warning: shoe {shoe.name!r}: the lining is strained by up to {100 * peaks[shoe.name] / E:.2g} %; "
        f"small displacements are taken, good up to some {100 * LARGE_STRAIN:g} %"
        for shoe in brake.shoes
        if peaks[shoe.name] > LARGE_STRAIN * (E := shoe.lining.material.E)
    ]
    return (*strained, *_overlaps(brake))


def _overlaps(brake: Brake) -> Iterator[str]:
    """Pairs of shoes whose linings cover the same arc of the drum."""
    for a, b in combinations(brake.shoes, 2):
        if a.side != b.side:
            continue
        turn = 2 * math.pi * round((a.lining.middle - b.lining.middle) / (2 * math.pi))
        start = max(a.lining.start, b.lining.start + turn)
        end = min(a.lining.end, b.lining.end + turn)
        if end - start > 1e-9:
            yield (
                f"warning: shoes {a.name!r} and {b.name!r}: their linings lie in each other from {deg(start)} to "
                f"{deg(end)}; each is solved as if the other were not there"
            )
