"""The functions across the width of a shoe, and integrals of their products.

Half the width is divided into pieces between breaks 0 = z_0 < z_1 < ... < z_m; there is a break at
the side of each part. The functions are hierarchic: those of degree q are among those of degree
q + 1. They are

    even:  1,  and in the first piece  N_n(z/z_1),  n = 2, 4, ... <= q
    odd:   z/z_m,                  and N_n(z/z_1),  n = 3, 5, ... <= q
    both:  in each further piece, from z_k-1 to z_k, a hat with its top at z_k and
           N_n, n = 2, 3, ... <= q, of the coordinate that goes from -1 to 1

with N_n the integral of the Legendre polynomial P_n-1 over its norm, zero at both ends of its piece
(Szabo & Babuska, Finite Element Analysis, eq. 3.15). The slopes of all N_n in one piece are
orthonormal on [-1, 1]. A hat falls again to zero in the next piece. A function belongs to the first
piece in which it is not zero. So a part that reaches to z_k has the functions of the pieces 1 to k:
all the others vanish there, and at the bond of two parts the displacements agree over the width of
the narrower part.
"""

from dataclasses import dataclass
from functools import cache, cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre

from drumlin.base.arrays import Floats
from drumlin.brake.brake import Shoe
from drumlin.fem.preparation.meshes import materials_of_parts
from drumlin.response.resultants import GAUSS, WEIGHTS, lobatto

SAME_SIDE = 1e-9
"""Difference of two half widths, relative to the larger, up to which they are one side."""
BESIDE_WEB = 1.0
"""Distance of the further break of an overhanging lining from the web's side, in thicknesses of the
lining. Pressure and displacements change fast over that length beside the web.
"""


class WidthFunction(NamedTuple):
    """A function across the width: the number of its first `piece`, and its `degree` there.

    Degrees 0 and 1 in the first piece are 1 and z over half the width, on the whole width. Degree 1
    in a further piece is a hat.
    """

    piece: int
    degree: int


class WidthIntegrals(NamedTuple):
    """Integrals over the width of a part of products of n even and m odd functions and slopes.

    Attributes
    ----------
    even, even_slopes : (n, n) Int e_k e_l dz [m], Int e_k' e_l' dz [1/m]
    odd, odd_slopes : (m, m) Int o_k o_l dz [m], Int o_k' o_l' dz [1/m]
    even_odd_slopes : (n, m) Int e_k o_l' dz [1]
    even_slopes_odd : (n, m) Int e_k' o_l dz [1]
    """

    even: Floats
    even_slopes: Floats
    odd: Floats
    odd_slopes: Floats
    even_odd_slopes: Floats
    even_slopes_odd: Floats


@dataclass(frozen=True)
class WidthFunctions:
    """The functions of degree `degree` between the `breaks` (m + 1,) [m], from 0 outwards.

    Functions of one parity stand by growing piece, so that those of a narrower part come first.
    """

    breaks: tuple[float, ...]
    degree: int

    @cached_property
    def even(self) -> tuple[WidthFunction, ...]:
        """The even functions."""
        return self._of_parity(0)

    @cached_property
    def odd(self) -> tuple[WidthFunction, ...]:
        """The odd functions; plane stress (degree 0) has none."""
        return self._of_parity(1) if self.degree > 0 else ()

    def _of_parity(self, first: int) -> tuple[WidthFunction, ...]:
        """The functions whose degree in the first piece is `first`, `first` + 2 and so on."""
        found = [WidthFunction(0, degree) for degree in range(first, self.degree + 1, 2)]
        for piece in range(1, len(self.breaks) - 1):
            found += [WidthFunction(piece, degree) for degree in range(1, self.degree + 1)]
        return tuple(found)

    def pieces_of(self, half: float) -> int:
        """Number of pieces within a part of `half` the width [m]."""
        within = np.array(self.breaks[1:]) <= half * (1 + SAME_SIDE)
        return int(np.count_nonzero(within))

    def counts(self, half: float) -> tuple[int, int]:
        """Numbers of even and of odd functions of a part of `half` the width [m]."""
        # In plane stress the one function serves all parts.
        pieces = max(self.pieces_of(half), 1)
        even = sum(function.piece < pieces for function in self.even)
        return even, sum(function.piece < pieces for function in self.odd)

    def values_and_slopes(
        self, functions: tuple[WidthFunction, ...], z: Floats
    ) -> tuple[Floats, Floats]:
        """Values [1] and slopes [1/m] (n, points) of some functions at distances z >= 0 (points,).

        At a break the slopes are those of the outer piece.
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
            if degree >= 2:
                values[k, here], slope = _bubble(degree, x)
                slopes[k, here] = slope * to_unit
                continue
            values[k, here], slopes[k, here] = 0.5 * (1 + x), 0.5 * to_unit
            if own + 2 < len(breaks):
                after, length = piece == own + 1, breaks[own + 2] - end
                values[k, after] = 1 - (z[after] - end) / length
                slopes[k, after] = -1 / length
        return values, slopes

    def face_nodes(self, half: float) -> Floats:
        """Distances (n,) [m] at which values tell the n even functions of a part of `half` width.

        They are the Gauss-Lobatto points of the pieces, of the first piece those with z >= 0.
        """
        if self.degree == 0:
            return np.zeros(1)
        highest = self.degree - self.degree % 2
        inner = lobatto(highest) if highest else np.ones(1)
        nodes = [self.breaks[1] * inner[inner >= 0]]
        for start, end in pairwise(self.breaks[1 : self.pieces_of(half) + 1]):
            nodes.append(start + (end - start) * (lobatto(self.degree)[1:] + 1) / 2)
        return np.concatenate(nodes)


@cache
def width_integrals(functions: WidthFunctions, half: float) -> WidthIntegrals:
    """The integrals over the whole width of a part of `half` the width [m].

    Their Gauss rule is exact up to degree 11 of the functions.
    """
    n, m = functions.counts(half)
    if functions.degree == 0:
        empty, none = np.zeros((0, 0)), np.zeros((1, 0))
        return WidthIntegrals(np.array([[2 * half]]), np.zeros((1, 1)), empty, empty, none, none)
    starts = np.array(functions.breaks[: functions.pieces_of(half)])
    lengths = np.diff(functions.breaks)[: len(starts)]
    z = (starts[:, None] + lengths[:, None] * (GAUSS + 1) / 2).ravel()
    # Half of the Gauss weights for the length of a piece, and twice for both sides.
    weights = (lengths[:, None] * WEIGHTS).ravel()
    e, e_slopes = functions.values_and_slopes(functions.even[:n], z)
    o, o_slopes = functions.values_and_slopes(functions.odd[:m], z)
    return WidthIntegrals(
        even=(e * weights) @ e.T,
        even_slopes=(e_slopes * weights) @ e_slopes.T,
        odd=(o * weights) @ o.T,
        odd_slopes=(o_slopes * weights) @ o_slopes.T,
        even_odd_slopes=(e * weights) @ o_slopes.T,
        even_slopes_odd=(e_slopes * weights) @ o.T,
    )


@cache
def nodes_to_functions(functions: WidthFunctions, half: float) -> Floats:
    """The matrix (functions, nodes) from values at `face_nodes` to the even functions of a part.

    half: half the width of the part [m]
    """
    own = functions.even[: functions.counts(half)[0]]
    values, _ = functions.values_and_slopes(own, functions.face_nodes(half))
    return np.asarray(np.linalg.inv(values.T), dtype=float)


def _bubble(degree: int, x: Floats) -> tuple[Floats, Floats]:
    """The function N_n of a degree n >= 2 and its slope, at x (points,) on [-1, 1]."""
    P = legendre.legvander(x, degree).T
    norm = np.sqrt((2 * degree - 1) / 2)
    value = norm * (P[degree] - P[degree - 2]) / (2 * degree - 1)
    return value, norm * P[degree - 1]


def half_widths_of(shoe: Shoe) -> dict[str, float]:
    """Half the width [m] of each part of a shoe, by the part's name."""
    return {name: width / 2 for name, (_, width) in materials_of_parts(shoe).items()}


def breaks_of(shoe: Shoe, *, beside: bool = True) -> tuple[float, ...]:
    """The breaks (m + 1,) [m] of a shoe: the sides of its parts, and one beside its web.

    Parameters
    ----------
    shoe : a parametric shoe
    beside : whether a lining that overhangs the next narrower part by more than BESIDE_WEB of its
        thickness has a further break there
    """
    halves = half_widths_of(shoe)
    places = sorted(halves.values())
    lining = halves["lining"]
    inner = [half for half in places if half < lining * (1 - SAME_SIDE)]
    if beside and inner:
        extra = max(inner) + BESIDE_WEB * shoe.lining.thickness
        # A piece that is much shorter than the break is far out would not pay.
        if lining - extra > 0.5 * shoe.lining.thickness:
            places.append(extra)
    breaks = [0.0]
    for place in sorted(places):
        if place - breaks[-1] > SAME_SIDE * place:
            breaks.append(place)
    return tuple(breaks)


def functions_of(shoe: Shoe, degree: int) -> WidthFunctions:
    """The functions of a `degree` across the width of a shoe."""
    breaks = breaks_of(shoe)
    return WidthFunctions((0.0, breaks[-1]) if degree == 0 else breaks, degree)
