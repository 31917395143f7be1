"""Finer and finer pieces across the width, chosen by the error of the pressure in each piece.

Half the width of a shoe is divided into pieces, on each of which the displacements are polynomials
of the distance z from the mid-plane (`functions`). Where a contact ends at other angles beside a
web than under it, the pressure is not smooth across the width. A higher degree on the same pieces
then helps little, and shorter pieces help more. On one random brake ("free" 510038 of
`drumlin_studies.solid_error`) the error of p on one section falls with the degrees 2, 3, 4 and 5 on
the first pieces from 3.6 to 3.5, 2.0 and 2.0 %. With degree 2 on finer and finer pieces it falls to
0.6, 0.25 and 0.1 %. Degree 5 on the first pieces takes as many unknowns as the answer with 0.25 %.

A step is a set of pieces with a degree. The steps go from coarse to fine: degree 2 and degree 3 on
the first pieces, degree 2 and degree 3 on finer pieces, and so on. The difference between the
pressures of degree 2 and of degree 3 shows in which pieces the error is large. These pieces are
split for the next two steps.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake.brake import Brake, Shoe
from drumlin.fem.preparation.cache import indices_of_first_shoes_of_equal_shape
from drumlin.fem.width.face import WRITTEN_PRESSURE_INTERVALS_PER_WIDTH_PIECE
from drumlin.fem.width.functions import (
    FunctionsAcrossWidth,
    has_parts_of_different_widths,
    piece_ends_across_half_width_of_shoe,
)
from drumlin.response.norms import relative_distance_of_pressures
from drumlin.response.response import Response, ShoeResponse

DEGREES_ON_EQUAL_PIECES = (2, 3)
"""The two degrees with which a brake is solved on each set of pieces, the lower one first.

The lower one is the lowest degree that shows the error of plane stress. The difference of the two
answers is the error of the lower degree on the same pieces. Further degrees are not tried, because
on finer pieces an answer with as many unknowns is more accurate where the error falls slowly.
"""
PLACE_OF_CUT_IN_FIRST_PIECE = 0.6
"""Distance from the mid-plane at which the first piece is split, relative to the piece's end.

The first piece reaches from the mid-plane to the side of the narrowest part, mostly a web. Beside
this side the pressure
changes most, so that the outer one of the two new pieces is the shorter one. On four random brakes
("free" 510030 and 510038, "built" 510030 and 510041 of `drumlin_studies.solid_error`) the cut lay
at 0.6, and other places were not tried. The error is stated in any case.
"""
WIDEST_FIRST_PIECE_WITHOUT_CUT = 1.0
"""Largest half width of a web without a cut, for the error of plane stress.

It is relative to the lining's thickness. Beside a side of the web the pressure changes over about
this length. One parabola over a much wider web does not show this change: on "free" 510048 of
`drumlin_studies.solid_error`, with a half width of 2.5 thicknesses, the error of p by plane stress
was then 0.30 %, with a cut it is 0.68 %, and with further pieces 0.75 %.
"""
LEAST_DIFFERENCE_OF_SPLIT_PIECE = 0.25
"""Smallest difference between the pressures of both degrees for which a piece is split.

It is relative to the largest difference of a piece. Far from the tolerance the difference exceeds
its share in all pieces, although it may be ten times as large in one of them: on "built" 510037 of
`drumlin_studies.solid_error` it is 5.7 % in the piece beside the free side and 0.4 to 0.5 % in the
three others. With 0 all four would be split, and the answers would soon have too many unknowns.
With a value near 1 only one piece is split in each step, and solves take many steps.
"""
PLACE_OF_CUT_IN_OTHER_PIECES = 0.5
"""Place at which all other pieces are split, relative to their length: in the middle."""


@dataclass(frozen=True)
class PiecesAcrossWidthsOfShoes:
    """The pieces across the half widths of a brake's shoes, with the degree on them.

    Attributes
    ----------
    ends : for each shoe, by its name, the ends of its pieces [m], from 0 at the mid-plane to half
        the width
    degree : degree of the polynomials of z on each piece
    """

    ends: Mapping[str, tuple[float, ...]]
    degree: int

    def __call__(self, shoe: Shoe) -> FunctionsAcrossWidth:
        """The functions of z across the width of a shoe."""
        return FunctionsAcrossWidth(self.ends[shoe.name], self.degree)

    @property
    def largest_number_of_pieces(self) -> int:
        """The largest number of pieces across half the width of a shoe."""
        return max(map(len, self.ends.values())) - 1


def coarsest_pieces_across_widths(brake: Brake) -> PiecesAcrossWidthsOfShoes:
    """The first pieces across the widths of a brake's shoes, with the lower degree."""
    return PiecesAcrossWidthsOfShoes(
        {shoe.name: piece_ends_across_half_width_of_shoe(shoe) for shoe in brake.shoes},
        DEGREES_ON_EQUAL_PIECES[0],
    )


def pieces_with_a_cut_in_wide_webs(brake: Brake) -> PiecesAcrossWidthsOfShoes:
    """The first pieces, with a cut in webs wider than WIDEST_FIRST_PIECE_WITHOUT_CUT.

    A shoe whose parts have one width has no cut.
    """
    pieces = coarsest_pieces_across_widths(brake)
    found = {}
    for shoe in brake.shoes:
        ends = pieces.ends[shoe.name]
        widest = WIDEST_FIRST_PIECE_WITHOUT_CUT * shoe.lining.thickness
        if has_parts_of_different_widths(shoe) and ends[1] > widest:
            ends = (0.0, PLACE_OF_CUT_IN_FIRST_PIECE * ends[1], *ends[1:])
        found[shoe.name] = ends
    return replace(pieces, ends=found)


def pieces_of_next_step(
    brake: Brake,
    pieces: PiecesAcrossWidthsOfShoes,
    answers: Sequence[Response],
    largest_difference: float,
) -> PiecesAcrossWidthsOfShoes:
    """The step after the last one of `answers`: the same pieces with degree 3, or finer pieces.

    Shoes of one shape get the same pieces.

    Parameters
    ----------
    brake : the brake
    pieces : the pieces of the last answer, with their degree
    answers : the answers of the last two steps, or of the only one
    largest_difference : relative difference of p between the last two answers that is allowed in
        all pieces of a shoe together
    """
    low, high = DEGREES_ON_EQUAL_PIECES
    if pieces.degree == low:
        return replace(pieces, degree=high)
    before, after = answers[-2], answers[-1]
    alike = indices_of_first_shoes_of_equal_shape(brake)
    found: dict[str, tuple[float, ...]] = {}
    for shoe, first in zip(brake.shoes, alike, strict=True):
        ends = pieces.ends[shoe.name]
        of_shape = [k for k, other in enumerate(alike) if other == first]
        differences = np.max(
            [
                _relative_pressure_difference_in_each_piece(
                    before.shoes[k], after.shoes[k], len(ends) - 1
                )
                for k in of_shape
            ],
            axis=0,
        )
        found[shoe.name] = _ends_of_finer_pieces(ends, differences, largest_difference)
    return PiecesAcrossWidthsOfShoes(found, low)


def _relative_pressure_difference_in_each_piece(
    before: ShoeResponse, after: ShoeResponse, count: int
) -> Floats:
    """The difference between two pressures of a shoe in each of its `count` pieces: (count,).

    It is the L2 norm over theta of the part of the mean over the width that the difference in the
    piece makes up, divided by the L2 norm of the mean pressure `after`. A piece of the body beyond
    the lining's side has the largest value of the lining's pieces. All values are 0 for a shoe
    without contact. Both responses have the same elements and the same pieces.
    """
    found = np.zeros(count)
    if before.surface is None or after.surface is None:
        return found
    parts = mean_pressure_of_each_piece(after) - mean_pressure_of_each_piece(before)
    for piece, part in enumerate(parts):
        moved = replace(after, pressure=after.pressure - part)
        found[piece] = relative_distance_of_pressures(moved, after)
    # Pieces of a body beyond the lining's side have no pressure of their own, although the pressure
    # depends on them. They are split like the lining's worst piece.
    found[len(parts) :] = found[: len(parts)].max()
    return found


def mean_pressure_of_each_piece(shoe: ShoeResponse) -> Floats:
    """The part of a shoe's mean pressure that each piece of the half width makes up: (k, n) [Pa].

    The sum over the k pieces of the friction surface is the mean over the width at the n nodes.
    """
    assert shoe.surface is not None
    z, pressure, _ = shoe.surface
    middle, step = len(z) // 2, WRITTEN_PRESSURE_INTERVALS_PER_WIDTH_PIECE
    # Simpson's rule is exact for polynomials up to degree 3, the largest of
    # DEGREES_ON_EQUAL_PIECES.
    weights = np.full(step + 1, 2.0)
    weights[1::2] = 4.0
    weights[[0, -1]] = 1.0
    found = []
    for first in range(middle, len(z) - 1, step):
        own = slice(first, first + step + 1)
        length = z[first + step] - z[first]
        found.append(pressure[:, own] @ weights * length / (3 * step * z[-1]))
    return np.array(found)


def _ends_of_finer_pieces(
    ends: tuple[float, ...], differences: Floats, largest_difference: float
) -> tuple[float, ...]:
    """The ends of the pieces after all pieces with a large difference are split.

    A piece is split if its difference exceeds its share of `largest_difference`, which is the same
    for all pieces, and is at least LEAST_DIFFERENCE_OF_SPLIT_PIECE times the largest difference of
    a piece. The piece with the largest difference is always split. The pieces of a shoe without
    contact, which have no differences, are not split.
    """
    share, largest = largest_difference / len(differences), differences.max()
    is_large = differences >= LEAST_DIFFERENCE_OF_SPLIT_PIECE * largest
    is_split = ((differences > share) & is_large) | ((differences == largest) & (largest > 0))
    found = list(ends)
    for piece, (start, end) in enumerate(pairwise(ends)):
        if is_split[piece]:
            place = PLACE_OF_CUT_IN_OTHER_PIECES if piece else PLACE_OF_CUT_IN_FIRST_PIECE
            found.append(start + place * (end - start))
    return tuple(sorted(found))
