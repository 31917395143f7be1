"""Check whether the assumptions of a model hold: small strains, and linings that do not overlap."""

from collections.abc import Iterator
from itertools import combinations

from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake, Shoe

LARGE_STRAIN = 0.05
"""Strain p/E of a lining through its thickness above which a note warns the reader.

Models assume small displacements. At this strain their answers are wrong by about 5 % as well.
"""

LARGEST_STRAIN = 10.0
"""Mean strain of a lining through its thickness above which a brake is refused.

No real load presses a lining in so far: the force in the brake file or its unit is wrong.
"""


def check_strain(shoe: Shoe, scale_factor: float, force: float, contact: float) -> None:
    """Raise NoAnswer if a force would press a lining in by many times its thickness.

    The strain is the mean over the contact, or over a length of one thickness if the contact is
    shorter. The peak strain does not count: at a corner the peak only tells how fine the mesh is.

    Parameters
    ----------
    shoe : the shoe whose lining is pressed
    scale_factor : length per unit of the surface's coordinate [m/rad, on a plane 1]
    force : sum of the normal forces on the lining [N]
    contact : length of the contact, in the surface's coordinate
    """
    lining = shoe.lining
    whole = scale_factor * (lining.end - lining.start)
    length = max(scale_factor * contact, min(lining.thickness, whole))
    strain = force / (lining.width * length * lining.material.E_through)
    if strain > LARGEST_STRAIN:
        raise NoAnswer(
            f"shoe {shoe.name!r}: the lining would be pressed in by {strain:.3g} times its "
            f"thickness; must be at most {LARGEST_STRAIN:g}, "
            f"and small displacements are good up to {LARGE_STRAIN:g}"
        )


def warnings(brake: Brake, peaks: dict[str, float]) -> tuple[str, ...]:
    """Lines that warn the reader of large strains and of linings that overlap.

    `peaks` holds the peak pressure [Pa] of each shoe by its name.
    """
    return (*_strain_warnings(brake, peaks), *_overlap_warnings(brake))


def _strain_warnings(brake: Brake, peaks: dict[str, float]) -> Iterator[str]:
    """A warning for each lining that is strained beyond LARGE_STRAIN."""
    for shoe in brake.shoes:
        material = shoe.lining.material
        if material is None:
            continue
        peak = peaks[shoe.name]
        if peak > LARGE_STRAIN * material.E_through:
            percent = 100 * peak / material.E_through
            yield (
                f"warning: shoe {shoe.name!r}: the lining is strained by up to {percent:.2g} %; "
                f"small displacements are taken, good up to some {100 * LARGE_STRAIN:g} %"
            )


def _overlap_warnings(brake: Brake) -> Iterator[str]:
    """A warning for each pair of linings that cover the same part of the drum or the plane."""
    surface = brake.surface
    text = surface.place
    for one, other in combinations(brake.shoes, 2):
        if one.side != other.side:
            continue
        a, b = one.lining, other.lining
        # Full turns that bring the second lining next to the first one.
        turn = surface.turns(a.start + a.end - b.start - b.end)
        start, end = max(a.start, b.start + turn), min(a.end, b.end + turn)
        # Linings that meet, to round-off, do not overlap.
        if end - start > 1e-9:
            yield (
                f"warning: shoes {one.name!r} and {other.name!r}: their linings lie in each other "
                f"from {text(start)} to {text(end)}; "
                "each is solved as if the other were not there"
            )
