"""Check whether the assumptions of a model hold: small strains, and linings that do not overlap."""

from collections.abc import Iterator
from itertools import combinations

from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake, Shoe

LARGEST_SILENT_LINING_STRAIN = 0.05
"""Strain p/E of a lining through its thickness above which a note warns the reader.

All models assume small displacements. At a strain of 5 % the error of this assumption is about 5 %,
too.
"""

LARGEST_ACCEPTED_LINING_STRAIN = 10.0
"""Mean strain of a lining through its thickness above which a brake is refused.

No real load compresses a lining by ten times its thickness. Above the limit the force in the brake
file, or its unit, must be wrong.
"""


def require_lining_strain_below_limit(
    shoe: Shoe, length_per_surface_coordinate: float, force: float, contact: float
) -> None:
    """Raise NoAnswer if a force would strain a lining by too much through its thickness.

    The limit is LARGEST_ACCEPTED_LINING_STRAIN.

    The strain is the mean over the contact, or over a length of one thickness if the contact is
    shorter. The peak strain is no measure: at a sharp corner it grows as the mesh is refined.

    Parameters
    ----------
    shoe : the shoe whose lining is pressed
    length_per_surface_coordinate : length per unit of the surface's coordinate [m/rad, on a plane
        1]
    force : sum of the normal forces on the lining [N]
    contact : length of the contact along the surface [rad, on a plane m]
    """
    lining = shoe.lining
    whole = length_per_surface_coordinate * (lining.end - lining.start)
    length = max(length_per_surface_coordinate * contact, min(lining.thickness, whole))
    strain = force / (lining.width * length * lining.material.E_through)
    if strain > LARGEST_ACCEPTED_LINING_STRAIN:
        raise NoAnswer(
            f"shoe {shoe.name!r}: the lining would be pressed in by {strain:.3g} times its "
            f"thickness; must be at most {LARGEST_ACCEPTED_LINING_STRAIN:g}, "
            f"and small displacements are good up to {LARGEST_SILENT_LINING_STRAIN:g}"
        )


def warnings_on_large_strains_and_lining_overlap(
    brake: Brake, peaks: dict[str, float]
) -> tuple[str, ...]:
    """Warnings, a line of text each, on large strains and on linings that overlap.

    `peaks` holds the peak pressure [Pa] of each shoe by its name.
    """
    return (*_warnings_on_large_strains(brake, peaks), *_warnings_on_overlapping_linings(brake))


def _warnings_on_large_strains(brake: Brake, peaks: dict[str, float]) -> Iterator[str]:
    """A warning for each lining whose strain at its peak pressure is large."""
    for shoe in brake.shoes:
        # A lining without a material is rigid and has no strain.
        material = shoe.lining.material
        if material is None:
            continue
        peak = peaks[shoe.name]
        if peak > LARGEST_SILENT_LINING_STRAIN * material.E_through:
            percent = 100 * peak / material.E_through
            yield (
                f"warning: shoe {shoe.name!r}: the lining is strained by up to {percent:.2g} %; "
                f"small displacements are taken, good up to some "
                f"{100 * LARGEST_SILENT_LINING_STRAIN:g} %"
            )


def _warnings_on_overlapping_linings(brake: Brake) -> Iterator[str]:
    """A warning for each pair of linings that cover the same part of the drum or the plane."""
    surface = brake.surface
    text = surface.coordinate_as_text
    for one, other in combinations(brake.shoes, 2):
        if one.side != other.side:
            continue
        a, b = one.lining, other.lining
        # `turn` [rad] is the multiple of a full turn that brings the second lining next to the
        # first one on a drum.
        turn = surface.half_distance_rounded_to_whole_turns(a.start + a.end - b.start - b.end)
        start, end = max(a.start, b.start + turn), min(a.end, b.end + turn)
        # Linings that only meet at their ends, up to round-off, do not overlap.
        if end - start > 1e-9:
            yield (
                f"warning: shoes {one.name!r} and {other.name!r}: their linings lie in each other "
                f"from {text(start)} to {text(end)}; "
                "each is solved as if the other were not there"
            )
