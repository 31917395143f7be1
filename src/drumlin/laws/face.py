"""The two surfaces on which a rigid shoe presses, a drum and a plane.

A rigid-body motion closes the gap of a lining by a mixture of two shapes: cos and sin of the angle
on a drum, 1 and x on a plane. The pressure of a rigid shoe is therefore such a mixture,
c_1 g_1 + c_2 g_2, whatever its support. Nothing else differs between a drum and a plane here.
Integrals are exact.
"""

import math
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake.brake import Brake, Shoe
from drumlin.response.resultants import Resultant

Arcs = tuple[tuple[float, float], ...]


class DrumFace(NamedTuple):
    """A drum of this radius [m]; places are angles [rad], the shapes are cos, sin and 1.

    The sign is +1 for a lining inside the drum and -1 for a lining outside.
    """

    radius: float
    sign: int

    def closing(self, motions: Floats) -> Floats:
        """Factors (k, 2) of the shapes by which rigid-body motions (k, 3) close the gap."""
        return self.sign * motions[:, :2]

    def sliding(self, motions: Floats) -> Floats:
        """Factors (k, 3) of the shapes and of 1 in the slide along e_theta of motions (k, 3)."""
        dx, dy, turn = motions.T
        return np.array([dy, -dx, self.radius * turn]).T

    def shapes(self, place: Floats) -> Floats:
        """The two shapes and 1 at the places (...): (3, ...)."""
        return np.array([np.cos(place), np.sin(place), np.ones(np.shape(place))])

    def products(self, arcs: Arcs) -> Floats:
        """Integrals (3, 2) [m] of the products of shapes over the length of arcs."""
        total = np.zeros((3, 2))
        for a, b in arcs:
            # Integrals of cos^2, cos sin and sin^2, and below of cos and sin, from a to b.
            half, across = (b - a) / 2, (math.sin(2 * b) - math.sin(2 * a)) / 4
            both = (math.cos(2 * a) - math.cos(2 * b)) / 4
            total += [
                [half + across, both],
                [both, half - across],
                [math.sin(b) - math.sin(a), math.cos(a) - math.cos(b)],
            ]
        return self.radius * total

    def pressed(self, c: Floats, start: float, end: float) -> Arcs:
        """Arcs of a lining from start to end [rad] in which the mixture c (2,) is positive."""
        top, found = math.atan2(c[1], c[0]), []
        for turn in range(-2, 3):
            # The mixture is positive within a quarter of a turn from its top.
            a = max(start, top + (2 * turn - 0.5) * math.pi)
            b = min(end, top + (2 * turn + 0.5) * math.pi)
            if b - a > 1e-12 and np.any(c):
                found.append((a, b))
        return tuple(found)

    def peak(self, c: Floats, arcs: Arcs) -> float:
        """Largest value of the mixture c (2,) on the arcs."""
        top = math.atan2(c[1], c[0])
        # The mixture is largest at its top or, where no arc holds the top, at an end of an arc.
        tops = [top + 2 * turn * math.pi for turn in range(-2, 3)]
        places: list[float] = []
        for a, b in arcs:
            places += [x for x in (a, b, *tops) if a <= x <= b]
        return float(np.max(c @ self.shapes(np.array(places))[:2]))

    def force(self, loads: Floats, drag: float) -> Resultant:
        """Resultant of the loads (3,) [N] of the shapes, with friction `drag` per pressure."""
        along = loads[:2]
        # Friction acts across the normal force, with the radius as its lever.
        return Resultant(
            normal=-self.sign * along,
            friction=drag * np.array([-along[1], along[0]]),
            moment=drag * self.radius * float(loads[2]),
        )

    def centre(self, c: Floats, start: float, end: float) -> int:
        """+1 if a lining from start to end can bear a resultant c (2,) by pressure, -1 by tension.

        It is 0 if neither bears the resultant.
        """
        if not np.any(c):
            return 0
        middle, half = (start + end) / 2, min((end - start) / 2, math.pi)
        # Pressures on the lining have resultants whose directions lie between the lining's ends.
        off = math.remainder(math.atan2(c[1], c[0]) - middle, 2 * math.pi)
        back = math.remainder(off + math.pi, 2 * math.pi)
        slack = 1e-9  # rad
        if abs(off) <= half + slack:
            return 1
        return -1 if abs(back) <= half + slack else 0


class PlaneFace(NamedTuple):
    """The plane y = 0 with the linings above it; places are x [m], the shapes are 1, x and 0.

    Its functions are those of `DrumFace`.
    """

    def closing(self, motions: Floats) -> Floats:
        """Factors (k, 2) of the shapes by which rigid-body motions (k, 3) close the gap."""
        return -motions[:, 1:]

    def sliding(self, motions: Floats) -> Floats:
        """Factors (k, 3) of the shapes in the slide along +x of motions (k, 3)."""
        return np.column_stack([motions[:, 0], np.zeros((len(motions), 2))])

    def shapes(self, place: Floats) -> Floats:
        """The two shapes and 0 at the places (...): (3, ...)."""
        return np.array([np.ones(np.shape(place)), place, np.zeros(np.shape(place))])

    def products(self, arcs: Arcs) -> Floats:
        """Integrals (3, 2) of the products of shapes over the length of arcs."""
        total = np.zeros((3, 2))
        for a, b in np.array(arcs).reshape(-1, 2):
            first = (b**2 - a**2) / 2
            total[:2] += [[b - a, first], [first, (b**3 - a**3) / 3]]
        return total

    def pressed(self, c: Floats, start: float, end: float) -> Arcs:
        """Arcs of a lining from start to end [m] in which the mixture c (2,) is positive."""
        # A linear pressure changes its sign once, and presses on one side of its zero.
        if c[1] != 0:
            zero = -c[0] / c[1]
            start, end = (max(start, zero), end) if c[1] > 0 else (start, min(end, zero))
        long_enough = end - start > 1e-12 * max(abs(start), abs(end))
        if long_enough and c @ [1, (start + end) / 2] > 0:
            return ((start, end),)
        return ()

    def peak(self, c: Floats, arcs: Arcs) -> float:
        """Largest value of the mixture c (2,) on the arcs."""
        return float(max(c @ [1.0, x] for arc in arcs for x in arc))

    def force(self, loads: Floats, drag: float) -> Resultant:
        """Resultant of the loads (3,) of the shapes, with friction `drag` per pressure."""
        normal, friction = np.array([0.0, loads[0]]), np.array([drag * loads[0], 0.0])
        return Resultant(normal, friction, float(loads[1]))

    def centre(self, c: Floats, start: float, end: float) -> int:
        """+1 if a lining can bear a resultant c (2,) by pressure, -1 by tension, 0 by neither."""
        if c[0] == 0:
            return 0
        slack = 1e-9 * (end - start)
        # c[0] is a force and c[1] its moment: their ratio is the place where the force acts.
        return int(math.copysign(1, c[0])) if start - slack <= c[1] / c[0] <= end + slack else 0


Face = DrumFace | PlaneFace


def face_of(brake: Brake, shoe: Shoe) -> Face:
    """The surface on which a shoe of a brake presses."""
    return PlaneFace() if shoe.flat else DrumFace(brake.size, shoe.sign)
