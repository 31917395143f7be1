"""Where a model's assumptions end: a warning beyond small strains, and where shoes lie in each
other.
"""

from collections.abc import Iterator
from itertools import combinations

from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake, Shoe

LARGE_STRAIN = 0.05
"""Strain p/E of a lining through its thickness above which a note says that small displacements are
off by about as much.
"""
LARGEST_STRAIN = (
    10.0  # in the mean; beyond it no scaled load is meant: the force or its unit is wrong
)


def check_strain(shoe: Shoe, scale_factor: float, force: float, contact: float) -> None:
    """Raise NoAnswer where a force [N] on a contact of a length would press the lining in by many
    times its thickness: in the mean, and where the contact is shorter than that, over as much as
    the lining has. Its peak may be at a corner, where it only tells how fine the mesh is.
    scale_factor: of the brake's surface.
    """
    lining = shoe.lining
    length = max(
        scale_factor * contact, min(lining.thickness, scale_factor * (lining.end - lining.start))
    )
    strain = force / (lining.width * length * lining.material.E_through)
    if strain > LARGEST_STRAIN:
        raise NoAnswer(
            f"shoe {shoe.name!r}: the lining would be pressed in by {strain:.3g} times its "
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
        if shoe.lining.material is not None
        and peaks[shoe.name] > LARGE_STRAIN * (E := shoe.lining.material.E_through)
    ]
    return (*strained, *_overlaps(brake))


def _overlaps(brake: Brake) -> Iterator[str]:
    """Pairs of shoes whose linings cover the same part of the drum or the plane."""
    surface = brake.surface
    text = surface.place
    for one, other in combinations(brake.shoes, 2):
        if one.side != other.side:
            continue
        a, b = one.lining, other.lining
        turn = surface.turns(a.start + a.end - b.start - b.end)
        start, end = max(a.start, b.start + turn), min(a.end, b.end + turn)
        if end - start > 1e-9:
            yield (
                f"warning: shoes {one.name!r} and {other.name!r}: their linings lie in each other from {text(start)} "
                f"to {text(end)}; each is solved as if the other were not there"
            )
