"""The friction surface on which a rigid shoe presses: a drum or a plane.

A rigid-body motion of the shoe closes the gap between lining and surface by c_1 g_1 + c_2 g_2. The
shape functions g_1, g_2 are cos and sin of the angle on a drum, and 1 and x on a plane. The
pressure of a rigid shoe is proportional to the closing of the gap. Whatever the shoe's support, the
pressure is therefore p = c_1 g_1 + c_2 g_2, too. `DrumFrictionSurface` and `PlaneFrictionSurface`
hold the formulas of the rigid-shoe law that differ between a drum and a plane. All integrals are in
closed form.
"""

import math
from itertools import chain
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake.brake import Brake, Shoe
from drumlin.response.resultants import PressureAndFrictionResultant

ContactArcsOfRigidShoe = tuple[tuple[float, float], ...]
"""Begin and end of each stretch of lining in contact: angles [rad] on a drum, x [m] on a plane."""


class DrumFrictionSurface(NamedTuple):
    """A drum as the friction surface of a rigid shoe.

    Places on the drum are angles theta [rad]. The shape functions of the pressure are cos(theta)
    and sin(theta); the slide along the drum has 1 as a third shape function.

    Attributes
    ----------
    radius : radius of the drum [m]
    sign : +1 for a lining inside the drum, -1 for a lining outside
    """

    radius: float
    sign: int

    def gap_closing_factors_of_rigid_body_motions(self, motions: Floats) -> Floats:
        """Factors (k, 2) of cos theta and sin theta by which k rigid-body motions close the gap.

        The gap closes by the first factor times cos theta plus the second factor times sin theta.
        A row of `motions` (k, 3) holds dx [m], dy [m] and the turn [rad] of the shoe.
        """
        return self.sign * motions[:, :2]

    def slide_factors_of_rigid_body_motions(self, motions: Floats) -> Floats:
        """Factors (k, 3) of cos theta, sin theta and 1 in the slide by k rigid-body motions.

        The slide [m] along the drum is the sum of these three functions times their factors.
        A row of `motions` (k, 3) holds dx [m], dy [m] and the turn [rad] of the shoe.
        """
        dx, dy, turn = motions.T
        return np.array([dy, -dx, self.radius * turn]).T

    def shape_function_values(self, place: Floats) -> Floats:
        """Values (3, ...) of the shape functions cos, sin and 1 at angles [rad] of any shape."""
        return np.array([np.cos(place), np.sin(place), np.ones(np.shape(place))])

    def integrals_of_shape_products(self, arcs: ContactArcsOfRigidShoe) -> Floats:
        """Integrals (3, 2) [m], over the length of arcs, of products of two shape functions.

        Row i belongs to the factor cos, sin or 1, and column j to the factor cos or sin.
        """
        total = np.zeros((3, 2))
        for a, b in arcs:
            # The integrals from a to b are half + across for cos^2, and half - across for sin^2.
            half, across = (b - a) / 2, (math.sin(2 * b) - math.sin(2 * a)) / 4
            # The integral of the product cos sin from a to b.
            both = (math.cos(2 * a) - math.cos(2 * b)) / 4
            total += [
                [half + across, both],
                [both, half - across],
                [math.sin(b) - math.sin(a), math.cos(a) - math.cos(b)],
            ]
        return self.radius * total

    def arcs_of_positive_pressure(
        self, c: Floats, start: float, end: float
    ) -> ContactArcsOfRigidShoe:
        """Arcs of a lining in which the pressure c[0] cos(theta) + c[1] sin(theta) is positive.

        The lining reaches from `start` to `end` [rad].
        """
        top, found = math.atan2(c[1], c[0]), []
        for turn in range(-2, 3):
            # The pressure is positive at angles that differ from its maximum at `top` by less than
            # 90 degrees.
            a = max(start, top + (2 * turn - 0.5) * math.pi)
            b = min(end, top + (2 * turn + 0.5) * math.pi)
            if b - a > 1e-12 and np.any(c):
                found.append((a, b))
        return tuple(found)

    def peak_pressure_on_arcs(self, c: Floats, arcs: ContactArcsOfRigidShoe) -> float:
        """Largest value [Pa] of the pressure c[0] cos + c[1] sin on the arcs."""
        top = math.atan2(c[1], c[0])
        # The pressure is largest at an end of an arc, or at the maximum of c[0] cos + c[1] sin if
        # an arc contains this angle.
        tops = [top + 2 * turn * math.pi for turn in range(-2, 3)]
        places: list[float] = []
        for a, b in arcs:
            places += [x for x in (a, b, *tops) if a <= x <= b]
        return float(np.max(c @ self.shape_function_values(np.array(places))[:2]))

    def force(self, loads: Floats, drag: float) -> PressureAndFrictionResultant:
        """Resultant on the shoe of pressure and friction.

        Parameters
        ----------
        loads : (3,) [N], integrals of the pressure times cos, sin and 1 over the lining's area
        drag : friction stress on the lining towards growing angles, divided by the pressure: mu or
            -mu
        """
        along = loads[:2]
        # Friction acts at right angles to the normal force, with the radius as its lever.
        return PressureAndFrictionResultant(
            normal=-self.sign * along,
            friction=drag * np.array([-along[1], along[0]]),
            moment=drag * self.radius * float(loads[2]),
        )

    def sign_of_normal_stress_with_given_resultant(
        self, c: Floats, start: float, end: float
    ) -> int:
        """The sign of the normal stress on a lining that can have a given resultant.

        It is +1 if a pressure (nowhere negative) can have the resultant, -1 if only a tension can,
        and 0 if neither can.

        Parameters
        ----------
        c : (2,) given resultant: integrals of the normal stress times cos and sin over the lining
        start, end : begin and end of the lining [rad]
        """
        if not np.any(c):
            return 0
        middle, half = (start + end) / 2, min((end - start) / 2, math.pi)
        # The resultant of a pressure that is nowhere negative points to an angle between the
        # lining's ends.
        off = math.remainder(math.atan2(c[1], c[0]) - middle, 2 * math.pi)
        back = math.remainder(off + math.pi, 2 * math.pi)
        slack = 1e-9  # rad
        if abs(off) <= half + slack:
            return 1
        return -1 if abs(back) <= half + slack else 0


class PlaneFrictionSurface(NamedTuple):
    """The plane y = 0 as the friction surface of a rigid shoe, with the linings above it.

    Places on the plane are x [m]. The shape functions of the pressure are 1 and x. A third shape
    function, which is 0, gives all arrays the same shapes as in `DrumFrictionSurface`. The methods
    have the same meaning as in `DrumFrictionSurface`.
    """

    def gap_closing_factors_of_rigid_body_motions(self, motions: Floats) -> Floats:
        """Factors (k, 2) of 1 and x by which k rigid-body motions close the gap.

        The gap [m] closes by the first factor plus the second factor times x.
        A row of `motions` (k, 3) holds dx [m], dy [m] and the turn [rad] of the shoe.
        """
        return -motions[:, 1:]

    def slide_factors_of_rigid_body_motions(self, motions: Floats) -> Floats:
        """Factors (k, 3) of 1, x and 0 in the slide [m] along +x by k rigid-body motions.

        The slide is the first factor, since a turn about the origin moves no point of the plane
        y = 0 along x.
        A row of `motions` (k, 3) holds dx [m], dy [m] and the turn [rad] of the shoe.
        """
        return np.column_stack([motions[:, 0], np.zeros((len(motions), 2))])

    def shape_function_values(self, place: Floats) -> Floats:
        """Values (3, ...) of the shape functions 1, x and 0 at places x [m] of any shape."""
        return np.array([np.ones(np.shape(place)), place, np.zeros(np.shape(place))])

    def integrals_of_shape_products(self, arcs: ContactArcsOfRigidShoe) -> Floats:
        """Integrals (3, 2), over the length of arcs, of products of two shape functions.

        Row i belongs to the factor 1, x or 0, and column j to the factor 1 or x.
        """
        total = np.zeros((3, 2))
        for a, b in np.array(arcs).reshape(-1, 2):
            first = (b**2 - a**2) / 2
            total[:2] += [[b - a, first], [first, (b**3 - a**3) / 3]]
        return total

    def arcs_of_positive_pressure(
        self, c: Floats, start: float, end: float
    ) -> ContactArcsOfRigidShoe:
        """The arc, if any, of a lining in which the pressure c[0] + c[1] x is positive.

        The lining reaches from `start` to `end` [m].
        """
        # A linear pressure changes its sign once, and is positive on one side of its zero.
        if c[1] != 0:
            zero = -c[0] / c[1]
            start, end = (max(start, zero), end) if c[1] > 0 else (start, min(end, zero))
        long_enough = end - start > 1e-12 * max(abs(start), abs(end))
        if long_enough and c @ [1, (start + end) / 2] > 0:
            return ((start, end),)
        return ()

    def peak_pressure_on_arcs(self, c: Floats, arcs: ContactArcsOfRigidShoe) -> float:
        """Largest value [Pa] of the pressure c[0] + c[1] x on the arcs."""
        # A linear pressure is largest at an end of an arc.
        return float(max(c @ [1.0, x] for x in chain.from_iterable(arcs)))

    def force(self, loads: Floats, drag: float) -> PressureAndFrictionResultant:
        """Resultant on the shoe of pressure and friction.

        Parameters
        ----------
        loads : (3,), integrals of the pressure times 1 [N], x [N m] and 0 over the lining's area
        drag : friction stress on the lining along +x, divided by the pressure: mu or -mu
        """
        normal, friction = np.array([0.0, loads[0]]), np.array([drag * loads[0], 0.0])
        return PressureAndFrictionResultant(normal, friction, float(loads[1]))

    def sign_of_normal_stress_with_given_resultant(
        self, c: Floats, start: float, end: float
    ) -> int:
        """The sign of the normal stress on a lining that can have a given resultant.

        It is +1 if a pressure (nowhere negative) can have the resultant, -1 if only a tension can,
        and 0 if neither can.

        Parameters
        ----------
        c : (2,) given normal force and moment: integrals of the normal stress times 1 and times x
        start, end : begin and end of the lining [m]
        """
        if c[0] == 0:
            return 0
        slack = 1e-9 * (end - start)
        # The force c[0] with the moment c[1] acts at the place x = c[1] / c[0]. A pressure can have
        # this resultant if the place is on the lining.
        return int(math.copysign(1, c[0])) if start - slack <= c[1] / c[0] <= end + slack else 0


FrictionSurfaceOfRigidShoe = DrumFrictionSurface | PlaneFrictionSurface
"""The friction surface of a rigid shoe."""


def friction_surface_of_shoe(brake: Brake, shoe: Shoe) -> FrictionSurfaceOfRigidShoe:
    """The drum or the plane on which a shoe of a brake presses."""
    return (
        PlaneFrictionSurface()
        if shoe.is_on_plane
        else DrumFrictionSurface(brake.size, shoe.sign_internal_plus_external_minus)
    )
