"""The functions of z across the width of a shoe, and the integrals of their products.

z is the distance from the mid-plane. Half the width is divided into pieces at breaks 0 = z_0 < z_1
< ... < z_m. Each part of the shoe has a break at its side. The functions are hierarchic: all
functions of the degree q belong to the degree q + 1 as well. They are

    even:  1,  and in the first piece  N_n(z/z_1),  n = 2, 4, ... <= q
    odd:   z/z_m,                  and N_n(z/z_1),  n = 3, 5, ... <= q
    even and odd alike:
           in each further piece, from z_(k-1) to z_k, a hat function with its top at z_k, and
           N_n(x), n = 2, 3, ... <= q, of the coordinate x that goes from -1 to 1 in the piece

N_n is the integral of the Legendre polynomial P_(n-1), divided by the L2 norm of P_(n-1); it is
zero at both ends of its piece (Szabo & Babuska, Finite Element Analysis, eq. 3.15). The slopes of
all N_n in one piece are orthonormal on [-1, 1]. A hat function falls to zero again in the next
piece. A part of half width z_k uses the functions whose first nonzero piece is one of the pieces 1
to k, since all other functions are zero on it. Where two parts are bonded, their displacements
agree over the width of the narrower part.
"""

from dataclasses import dataclass
from functools import cache, cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre

from drumlin.base.arrays import Floats
from drumlin.brake.brake import Shoe
from drumlin.fem.preparation.meshes import materials_and_widths_of_shoe_parts
from drumlin.response.resultants import GAUSS, WEIGHTS, gauss_lobatto_points

SAME_HALF_WIDTH_TOLERANCE = 1e-9
"""Relative difference up to which the half widths of two parts count as equal."""
WIDTH_BREAKPOINT_DISTANCES_BESIDE_WEB = (1.0, 2.5)
"""Distances of extra breaks from the side of a web that a lining overhangs.

The distances are in thicknesses of the lining. Pressure and displacements change fast over the
first distance beside the web, and in long overhangs they do not end smoothly where the lining lifts
off. On four random brakes with overhangs of 5.8 to 17 thicknesses, leaving out the second break
made the error of p on coarse elements 3.5 to 7 times as large with degree 3, and 1.1 to 1.7 times
with degree 2. With degree 4 the second break makes the error smaller on only one of the four
brakes: the error then comes from the elements, which miss the ends of the contact.

The distances were found by these trials, and so were the three numbers below. With other breaks an
answer of the same error needs more or fewer functions. The error is stated in any case.

At the side of a wide web the stress is singular, outside the web and inside it, but there is no
break inside the web. On one brake ("free" 510017 of `drumlin_studies.solid_error`, half width of
the web 1.2 thicknesses) a break inside the web, with two breaks beside the web, divides the error
of p with degree 3 by 2.7, and the error of the torque by 17, for 1.8 times the unknowns. On "free"
510009 a break inside the web divides the error of p with degree 3 by 15, and on six other brakes by
1 to 1.7, for 1.6 times the unknowns. On these six brakes degree 4 without the break needs fewer
unknowns and gives an error at least as small.
"""
LEAST_LENGTH_FROM_WIDTH_BREAKPOINT_TO_SIDE = 0.75
"""Least length from a break beside a web to the lining's side, in thicknesses of the lining.

In shorter pieces additional functions of z improve the answer little. With a larger value long
overhangs have fewer breaks, and with a smaller value the break of a short overhang lies too far
from the web.
"""
WIDTH_BREAKPOINT_DISTANCE_IN_SHORT_OVERHANG = 0.25
"""Distance of the break from the side of a web, relative to a short overhang of the lining.

An overhang is short if neither of the WIDTH_BREAKPOINT_DISTANCES_BESIDE_WEB fits into it. On seven
random brakes with overhangs of 0.7 to 1.6 thicknesses of the lining the error of p with degree 3 is
1.4 to 8 times smaller with a break at about this distance than with no break, or with a break at
one thickness. On one of these brakes distances from 0.12 to 0.25 of the overhang are equally good;
at half the overhang the error with degree 2 is twice as large.
"""
LARGEST_OVERHANG_WITHOUT_WIDTH_BREAKPOINT = 0.5
"""Overhang up to which there is no break beside a web, in thicknesses of the lining.

A lining that hardly overhangs its web bends little there, so that a break would only add unknowns.
"""


class FunctionAcrossWidth(NamedTuple):
    """A function of z: the first `piece` in which it is not zero, and its `degree` in this piece.

    Pieces are counted from 0 at the mid-plane. In piece 0, degree 0 is the function 1, and degree 1
    is the function z divided by half the width; both extend over the whole width. In all other
    pieces degree 1 is a hat function.
    """

    piece: int
    degree: int


class IntegralsOverWidth(NamedTuple):
    """Integrals of products of a part's functions of z, over the whole width of the part.

    The part has n even functions e_k and m odd functions o_k of z, with the slopes e_k' and o_k'.

    Attributes
    ----------
    even, even_slopes : (n, n) Int e_k e_l dz [m], Int e_k' e_l' dz [1/m]
    odd, odd_slopes : (m, m) Int o_k o_l dz [m], Int o_k' o_l' dz [1/m]
    even_times_odd_slopes : (n, m) Int e_k o_l' dz [1]
    even_slopes_times_odd : (n, m) Int e_k' o_l dz [1]
    """

    even: Floats
    even_slopes: Floats
    odd: Floats
    odd_slopes: Floats
    even_times_odd_slopes: Floats
    even_slopes_times_odd: Floats


@dataclass(frozen=True)
class FunctionsAcrossWidth:
    """All functions across the width of a shoe up to a degree, on given pieces of its half width.

    `breaks` (m + 1,) [m] are the ends of the pieces, from 0 at the mid-plane to half the width.
    Even functions are sorted by piece, and odd functions as well, so that the functions of a
    narrower part come first.
    """

    breaks: tuple[float, ...]
    degree: int

    @cached_property
    def even_functions_across_width(self) -> tuple[FunctionAcrossWidth, ...]:
        """The even functions, for the displacements u_x and u_y in the section."""
        return self._even_or_odd_functions_across_width(0)

    @cached_property
    def odd_functions_across_width(self) -> tuple[FunctionAcrossWidth, ...]:
        """The odd functions, for the displacement u_z; none in plane stress (degree 0)."""
        return self._even_or_odd_functions_across_width(1) if self.degree > 0 else ()

    def _even_or_odd_functions_across_width(self, first: int) -> tuple[FunctionAcrossWidth, ...]:
        """The functions of one parity: even functions for `first` 0, odd functions for `first` 1.

        In the first piece their degrees are `first`, `first` + 2 and so on.
        """
        found = [FunctionAcrossWidth(0, degree) for degree in range(first, self.degree + 1, 2)]
        for piece in range(1, len(self.breaks) - 1):
            found += [FunctionAcrossWidth(piece, degree) for degree in range(1, self.degree + 1)]
        return tuple(found)

    def number_of_width_pieces_in_part(self, half: float) -> int:
        """Number of pieces of the half width from the mid-plane to the side of a part.

        `half` [m] is the half width of the part.
        """
        within = np.array(self.breaks[1:]) <= half * (1 + SAME_HALF_WIDTH_TOLERANCE)
        return int(np.count_nonzero(within))

    def counts_of_even_and_odd_functions_on_part(self, half: float) -> tuple[int, int]:
        """How many even and how many odd functions a part of half width `half` [m] has."""
        # In plane stress every part has the single function 1. The only piece is then as wide as
        # the shoe, and so no piece lies within a narrower part.
        pieces = max(self.number_of_width_pieces_in_part(half), 1)
        even = sum(function.piece < pieces for function in self.even_functions_across_width)
        return even, sum(function.piece < pieces for function in self.odd_functions_across_width)

    def function_values_and_slopes(
        self, functions: tuple[FunctionAcrossWidth, ...], z: Floats
    ) -> tuple[Floats, Floats]:
        """Values [1] and slopes [1/m] (n, points) of n functions at distances z >= 0 (points,) [m].

        At a break the slopes are those in the outer piece.
        """
        breaks = np.array(self.breaks)
        piece = np.clip(np.searchsorted(breaks, z, side="right") - 1, 0, len(breaks) - 2)
        values, slopes = np.zeros((2, len(functions), len(z)))
        for k, (own, degree) in enumerate(functions):
            if own == 0 and degree < 2:
                values[k] = (z / breaks[-1]) ** degree
                slopes[k] = degree / breaks[-1]
                continue
            # The first piece goes from -z_1 to z_1.
            start, end = (-breaks[1] if own == 0 else breaks[own]), breaks[own + 1]
            here, to_unit = piece == own, 2 / (end - start)
            x = (z[here] - start) * to_unit - 1
            # Degrees from 2 on are integrated Legendre polynomials, and degree 1 is a hat function.
            if degree >= 2:
                values[k, here], slope = _values_and_slopes_of_integrated_legendre_polynomial(
                    degree, x
                )
                slopes[k, here] = slope * to_unit
                continue
            values[k, here], slopes[k, here] = 0.5 * (1 + x), 0.5 * to_unit
            if own + 2 < len(breaks):
                after, length = piece == own + 1, breaks[own + 2] - end
                values[k, after] = 1 - (z[after] - end) / length
                slopes[k, after] = -1 / length
        return values, slopes

    def node_distances_across_half_width_of_part(self, half: float) -> Floats:
        """Distances z (n,) [m] of the contact nodes across half the width of a part.

        The n values of a pressure or displacement at these nodes determine the factors of its n
        even functions. The nodes are the Gauss-Lobatto points of the pieces. Of the first piece,
        which reaches from -z_1 to z_1, only the points with z >= 0 are nodes. `half` is the half
        width of the part [m].
        """
        if self.degree == 0:
            return np.zeros(1)
        highest = self.degree - self.degree % 2
        inner = gauss_lobatto_points(highest) if highest else np.ones(1)
        nodes = [self.breaks[1] * inner[inner >= 0]]
        for start, end in pairwise(self.breaks[1 : self.number_of_width_pieces_in_part(half) + 1]):
            nodes.append(start + (end - start) * (gauss_lobatto_points(self.degree)[1:] + 1) / 2)
        return np.concatenate(nodes)


@cache
def integrals_of_function_products_over_width(
    functions: FunctionsAcrossWidth, half: float
) -> IntegralsOverWidth:
    """The integrals of products of functions of z over the whole width of a part of the shoe.

    `half` is the half width of the part [m]. The Gauss rule is exact for functions up to degree 11.
    """
    n, m = functions.counts_of_even_and_odd_functions_on_part(half)
    if functions.degree == 0:
        empty, none = np.zeros((0, 0)), np.zeros((1, 0))
        return IntegralsOverWidth(
            np.array([[2 * half]]), np.zeros((1, 1)), empty, empty, none, none
        )
    starts = np.array(functions.breaks[: functions.number_of_width_pieces_in_part(half)])
    lengths = np.diff(functions.breaks)[: len(starts)]
    z = (starts[:, None] + lengths[:, None] * (GAUSS + 1) / 2).ravel()
    # The weights on [-1, 1] times half the length of a piece integrate over one half of the width,
    # and the integrals over both halves are twice as large: the factors 1/2 and 2 cancel.
    weights = (lengths[:, None] * WEIGHTS).ravel()
    e, e_slopes = functions.function_values_and_slopes(functions.even_functions_across_width[:n], z)
    o, o_slopes = functions.function_values_and_slopes(functions.odd_functions_across_width[:m], z)
    return IntegralsOverWidth(
        even=(e * weights) @ e.T,
        even_slopes=(e_slopes * weights) @ e_slopes.T,
        odd=(o * weights) @ o.T,
        odd_slopes=(o_slopes * weights) @ o_slopes.T,
        even_times_odd_slopes=(e * weights) @ o_slopes.T,
        even_slopes_times_odd=(e_slopes * weights) @ o.T,
    )


@cache
def matrix_from_node_values_to_function_factors(
    functions: FunctionsAcrossWidth, half: float
) -> Floats:
    """The matrix (functions, nodes) that converts values at nodes to factors of even functions.

    The nodes lie across a part of half width `half` [m]. The even functions are those of this part.
    """
    own = functions.even_functions_across_width[
        : functions.counts_of_even_and_odd_functions_on_part(half)[0]
    ]
    values, _ = functions.function_values_and_slopes(
        own, functions.node_distances_across_half_width_of_part(half)
    )
    return np.asarray(np.linalg.inv(values.T), dtype=float)


def _values_and_slopes_of_integrated_legendre_polynomial(
    degree: int, x: Floats
) -> tuple[Floats, Floats]:
    """The values and slopes of the integrated Legendre polynomial N_n at points x in [-1, 1].

    `degree` is n, at least 2. N_n is defined in the docstring of this module.
    """
    P = legendre.legvander(x, degree).T
    norm = np.sqrt((2 * degree - 1) / 2)
    value = norm * (P[degree] - P[degree - 2]) / (2 * degree - 1)
    return value, norm * P[degree - 1]


def half_widths_of_parts(shoe: Shoe) -> dict[str, float]:
    """The half width [m] of each part of a shoe, by the part's name."""
    return {
        name: width / 2 for name, (_, width) in materials_and_widths_of_shoe_parts(shoe).items()
    }


def has_parts_of_different_widths(shoe: Shoe) -> bool:
    """Whether some parts of a shoe are wider than others."""
    halves = half_widths_of_parts(shoe).values()
    return max(halves) > min(halves) * (1 + SAME_HALF_WIDTH_TOLERANCE)


def piece_ends_across_half_width_of_shoe(shoe: Shoe) -> tuple[float, ...]:
    """The breaks (m + 1,) [m] that divide the half width of a shoe into pieces.

    They are 0 at the mid-plane, the half widths of the parts, and in most shoes whose lining
    overhangs a web one or two more breaks beside the web.

    Parameters
    ----------
    shoe : a parametric shoe
    """
    halves = half_widths_of_parts(shoe)
    lining = halves["lining"]
    places = list(halves.values())
    inner = [half for half in places if half < lining * (1 - SAME_HALF_WIDTH_TOLERANCE)]
    if inner:
        thickness = shoe.lining.thickness
        overhang = (lining - max(inner)) / thickness
        places += [
            max(inner) + distance * thickness
            for distance in width_breakpoint_distances_from_web(overhang)
        ]
    breaks = [0.0]
    for place in sorted(places):
        if place - breaks[-1] > SAME_HALF_WIDTH_TOLERANCE * place:
            breaks.append(place)
    return tuple(breaks)


def width_breakpoint_distances_from_web(overhang: float) -> list[float]:
    """The distances of breaks from the side of a web that a lining overhangs.

    The distances and the `overhang` are in thicknesses of the lining.
    """
    found = [
        own
        for own in WIDTH_BREAKPOINT_DISTANCES_BESIDE_WEB
        if overhang - own > LEAST_LENGTH_FROM_WIDTH_BREAKPOINT_TO_SIDE
    ]
    if not found and overhang > LARGEST_OVERHANG_WITHOUT_WIDTH_BREAKPOINT:
        found = [WIDTH_BREAKPOINT_DISTANCE_IN_SHORT_OVERHANG * overhang]
    return found


def functions_across_width_of_shoe(shoe: Shoe, degree: int) -> FunctionsAcrossWidth:
    """All functions across the width of a shoe up to a degree, on pieces between its breaks."""
    breaks = piece_ends_across_half_width_of_shoe(shoe)
    return FunctionsAcrossWidth((0.0, breaks[-1]) if degree == 0 else breaks, degree)
