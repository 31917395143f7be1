"""The two counterfaces that a shoe presses on, a drum and a plane, as a rigid shoe sees them.

A rigid motion closes the gap of a lining by a mixture of two shapes: cos and sin of the angle on a
drum, 1 and x on a plane. So the pressure of a rigid shoe is such a mixture, c_1 g_1 + c_2 g_2,
whatever holds it; nothing else tells a drum from a plane here. Integrals are exact.
"""

import math
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake.brake import Brake, Shoe

Arcs = tuple[tuple[float, float], ...]


class DrumFace(NamedTuple):
    """A drum of this radius [m]; sign: +1 for a lining inside it. Places are angles [rad], shapes
    cos, sin, 1.
    """

    radius: float
    sign: int

    def closing(self, motions: Floats) -> Floats:
        """How motions (k, 3) close the gap: factors (k, 2) of the shapes."""
        return self.sign * motions[:, :2]

    def sliding(self, motions: Floats) -> Floats:
        """Motion (k, 3) along e_theta: factors of the shapes and of 1."""
        dx, dy, turn = motions.T
        return np.array([dy, -dx, self.radius * turn]).T

    def shapes(self, place: Floats) -> Floats:
        """The two shapes and 1 at the places (...): (3, ...)."""
        return np.array([np.cos(place), np.sin(place), np.ones(np.shape(place))])

    def products(self, arcs: Arcs) -> Floats:
        """Integrals (3, 2) of the products of shapes over the length of arcs [m]."""
        total = np.zeros((3, 2))
        for a, b in arcs:
            half, across = (b - a) / 2, (math.sin(2 * b) - math.sin(2 * a)) / 4
            both = (math.cos(2 * a) - math.cos(2 * b)) / 4
            total += [
                [half + across, both],
                [both, half - across],
                [math.sin(b) - math.sin(a), math.cos(a) - math.cos(b)],
            ]
        return self.radius * total

    def pressed(self, c: Floats, start: float, end: float) -> Arcs:
        """The arcs of a lining where the mixture c (2,) is positive."""
        top, found = math.atan2(c[1], c[0]), []
        for turn in range(-2, 3):
            a, b = (
                max(start, top + (2 * turn - 0.5) * math.pi),
                min(end, top + (2 * turn + 0.5) * math.pi),
            )
            if b - a > 1e-12 and np.any(c):
                found.append((a, b))
        return tuple(found)

    def peak(self, c: Floats, arcs: Arcs) -> float:
        """The largest value of the mixture on the arcs."""
        top = math.atan2(c[1], c[0])
        at = [
            x
            for a, b in arcs
            for x in (a, b, *(top + 2 * n * math.pi for n in range(-2, 3)))
            if a <= x <= b
        ]
        return float(np.max(c @ self.shapes(np.array(at))[:2]))

    def force(self, loads: Floats, drag: float) -> tuple[Floats, Floats, float]:
        """Forces (2,) of pressure and of friction, and moment about the origin, from the shapes'
        loads (3,) [N].
        """
        along = loads[:2]
        return (
            -self.sign * along,
            drag * np.array([-along[1], along[0]]),
            drag * self.radius * float(loads[2]),
        )

    def centre(self, c: Floats, start: float, end: float) -> int:
        """+1 where a lining from start to end can bear the resultant c (2,) by pressure, -1 by
        tension, else 0.
        """
        middle, half = (start + end) / 2, min((end - start) / 2, math.pi)
        off = math.remainder(math.atan2(c[1], c[0]) - middle, 2 * math.pi)
        back = math.remainder(off + math.pi, 2 * math.pi)
        slack = 1e-9
        return (
            0
            if not np.any(c)
            else 1
            if abs(off) <= half + slack
            else -1
            if abs(back) <= half + slack
            else 0
        )


class PlaneFace(NamedTuple):
    """The plane y = 0 with the linings above it. Places are x [m], shapes 1 and x, and nothing."""

    def closing(self, motions: Floats) -> Floats:
        """As of a drum."""
        return -motions[:, 1:]

    def sliding(self, motions: Floats) -> Floats:
        """As of a drum, along +x."""
        return np.column_stack([motions[:, 0], np.zeros((len(motions), 2))])

    def shapes(self, place: Floats) -> Floats:
        """As of a drum."""
        return np.array([np.ones(np.shape(place)), place, np.zeros(np.shape(place))])

    def products(self, arcs: Arcs) -> Floats:
        """As of a drum."""
        total = np.zeros((3, 2))
        for a, b in np.array(arcs).reshape(-1, 2):
            first = (b**2 - a**2) / 2
            total[:2] += [[b - a, first], [first, (b**3 - a**3) / 3]]
        return total

    def pressed(self, c: Floats, start: float, end: float) -> Arcs:
        """As of a drum."""
        if c[1] != 0:
            zero = -c[0] / c[1]
            start, end = (max(start, zero), end) if c[1] > 0 else (start, min(end, zero))
        return (
            ((start, end),)
            if end - start > 1e-12 * max(abs(start), abs(end)) and c @ [1, (start + end) / 2] > 0
            else ()
        )

    def peak(self, c: Floats, arcs: Arcs) -> float:
        """As of a drum."""
        return float(max(c @ [1.0, x] for arc in arcs for x in arc))

    def force(self, loads: Floats, drag: float) -> tuple[Floats, Floats, float]:
        """As of a drum."""
        return np.array([0.0, loads[0]]), np.array([drag * loads[0], 0.0]), float(loads[1])

    def centre(self, c: Floats, start: float, end: float) -> int:
        """As of a drum."""
        if c[0] == 0:
            return 0
        slack = 1e-9 * (end - start)
        return int(math.copysign(1, c[0])) if start - slack <= c[1] / c[0] <= end + slack else 0


Face = DrumFace | PlaneFace


def face_of(brake: Brake, shoe: Shoe) -> Face:
    """The counterface of a shoe of a brake."""
    return PlaneFace() if shoe.flat else DrumFace(brake.size, shoe.sign)
