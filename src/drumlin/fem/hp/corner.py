"""The singular pressure at a pressed corner of a lining, and under a kink that points to the drum.

A lining ends with a face perpendicular to the drum. Near this corner the lining is an elastic wedge
of 90 degrees that slides on a half-plane, and the pressure p goes as x^a, where x is the distance
from the corner. If the exponent a is negative, p is unbounded. Under a kink of the gap that points
to the drum p goes as ln(1/x) at the distance x from the kink (Johnson, Contact Mechanics, ch. 5).

This module computes the exponents a, and replaces the computed p near the corners by the power law.
It also estimates the errors of p at corners and under kinks, where elements of finite size cannot
follow the unbounded pressure.
"""

import math
from dataclasses import replace
from functools import cache
from typing import NamedTuple, Protocol

import numpy as np

from drumlin.base.arrays import Complexes, Floats
from drumlin.brake import clearance
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.elasticity import (
    plane_stress_elasticity_matrix,
    which_elasticity_matrices_are_orthotropic,
)
from drumlin.brake.fields import IsotropicOrOrthotropicMaterial
from drumlin.response.response import Response, ShoeResponse, length_of_uncompared_edge_zone
from drumlin.response.resultants import (
    gauss_lobatto_points,
    length_of_edge_zone_left_out_of_pressure_errors,
    polynomial_values_at_gauss_points,
)

SMALLEST_SOUGHT_EXPONENT_ROOT = 1e-3
"""Lower end of the interval in which the root l = a + 1 is searched, with a the exponent of p.

The pressure p goes as x^a at the distance x from a pressed corner of a lining. With l below 1/2 the
pressure is not square-integrable; on a rigid drum this needs a friction coefficient of at least
0.57 to 0.61, depending on Poisson's ratio.
"""
LARGEST_EXPONENT_OF_BOUNDED_PRESSURE = 1e-6
"""Size of the exponent a below which the pressure p ~ x^a at a corner counts as bounded.

The distance from the corner is x. With a smaller |a| the functions x^a and 1 are so alike that the
equations for the coefficients of both cannot be solved with 16 digits.
"""

NUMBER_OF_TRIED_PRESSURE_EXPONENTS = 200
"""Number of exponents at which the determinant for an orthotropic corner is evaluated.

The pressure's exponent is a zero of the determinant. It lies between two neighbouring exponents at
which the determinant has opposite signs. Two zeros between neighbouring exponents would be missed.
"""

POWER_LAW_FRACTION_OF_CONTACT = 2e-3
"""Fraction of a contact, from a pressed corner of the lining on, in which p follows a power law.

In this part the polynomials of the pressure p are replaced by the power law of the corner. The part
holds three or four element columns. In the column next to the corner, and a little in the second
column, polynomials are a poor approximation of the power law. In columns farther away the pressure
also depends on the rest of the lining. On two brakes the error of p was the same with three to six
columns, and 10 to 30 times as large with one column.
"""
LENGTH_OF_PRESSURE_PIECE_AT_CORNER = 1e-12
"""Length [rad] of the polynomial piece of the pressure next to a pressed corner of a lining.

Angles of 3 rad are rounded to 4e-16, and neighbouring nodes of a piece of degree 7 can be as near
as a sixteenth of its length. In a shorter piece round-off would change the distances of the nodes
too much.
"""
RATIO_OF_NEIGHBOURING_PRESSURE_PIECES = 0.4
"""Ratio of the lengths of neighbouring polynomial pieces of the pressure at a pressed corner.

The pieces become shorter towards the corner of the lining. Polynomials of degree 5 follow a power
function to about 1e-4 on each piece. With a smaller ratio the polynomials are less exact, and with
a larger ratio more pieces are needed.
"""

TOLERANCE_OF_COLUMN_END_AT_GAP_KINK = 1e-9
"""Distance [rad] from a gap kink, below which an element column counts as ending at the kink.

Such a kink points to the drum, and p is unbounded there. A smaller distance is round-off.
"""


@cache
def pressure_exponent_at_lining_corner(
    inward_friction: float, nu: float, stiffness_ratio: float = 0.0, nu_drum: float = 0.0
) -> float:
    """The exponent a of the pressure p ~ x^a at a pressed corner of an isotropic lining.

    The distance from the corner is x. The exponent is at most 0 and above -1. At the distance r
    from the corner the displacements of the lining, a wedge, go as r^l with l = a + 1 (Williams
    1952). One face of the wedge is free; the other has the shear stress f p and stays in contact
    with the drum, a half-plane, if, with s = sin(pi l/2),

        sin(pi l) = f (2 (l + s^2) + (1 + nu) (l^2 - s^2))
                    + k (l^2 - s^2) ((1 - nu_drum) f + 2 cot(pi l)).

    This is the condition of Comninou (Stress singularity at a sharp edge in contact problems with
    friction, ZAMP 27, 1976) for a right angle. Without friction it is the condition of Dundurs &
    Lee (Stress concentration at a sharp edge in contact problems, J. Elasticity 2, 1972). For
    little friction on a rigid drum a = -4 f/pi.

    Parameters
    ----------
    inward_friction : float
        Friction coefficient f [1], positive where the friction drags the lining's face away from
        the corner, into the lining. Where the friction drags towards the corner on a rigid drum, p
        is bounded, and 0 is returned.
    nu : float
        Poisson's ratio of the lining.
    stiffness_ratio : float
        k = E w of the lining divided by E w of the drum's ring, with the widths w; 0 for a rigid
        drum.
    nu_drum : float
        Poisson's ratio of the ring.
    """
    if inward_friction < 0 and stiffness_ratio == 0:
        return 0.0

    def residual_of_exponent_equation(root: float) -> float:
        """Left minus right side of the equation for the root l = a + 1, at l = `root`."""
        s2 = math.sin(0.5 * math.pi * root) ** 2
        difference = root**2 - s2
        of_wedge = inward_friction * (2 * (root + s2) + (1 + nu) * difference)
        slope_of_drum = (1 - nu_drum) * inward_friction + 2 / math.tan(math.pi * root)
        of_drum = stiffness_ratio * difference * slope_of_drum
        return math.sin(math.pi * root) - of_wedge - of_drum

    # If no exponent in the searched interval fulfils the equation, the end of the interval that is
    # nearer to the solution is returned.
    if residual_of_exponent_equation(SMALLEST_SOUGHT_EXPONENT_ROOT) <= 0:
        return SMALLEST_SOUGHT_EXPONENT_ROOT - 1
    if residual_of_exponent_equation(1 - LARGEST_EXPONENT_OF_BOUNDED_PRESSURE) >= 0:
        return 0.0
    # scipy.optimize takes time to load, and only the few brakes with a pressed corner need it.
    from scipy.optimize import brentq  # noqa: PLC0415

    return (
        float(
            brentq(
                residual_of_exponent_equation,
                SMALLEST_SOUGHT_EXPONENT_ROOT,
                1 - LARGEST_EXPONENT_OF_BOUNDED_PRESSURE,
            )
        )
        - 1
    )


@cache
def pressure_exponent_at_orthotropic_corner(
    inward_friction: float,
    material: IsotropicOrOrthotropicMaterial,
    drum: IsotropicOrOrthotropicMaterial | None = None,
    lining_width_over_ring_width: float = 1.0,
) -> float:
    """The exponent a of the pressure p ~ x^a at a pressed corner, for orthotropic materials.

    The distance from the corner is x; for isotropic materials see
    `pressure_exponent_at_lining_corner`. The axes of the materials lie along the drum and normal to
    the drum. The stresses in the lining are 2 Re sum_k (mu_k^2, 1, -mu_k) l c_k z_k^(l - 1) with
    z_k = x + mu_k y and the roots mu_k of Lekhnitskii's equation (Anisotropic Plates, section 19).
    Two conditions on the free face, the friction, and the equal slopes of both surfaces are four
    real equations for c_1 and c_2. The pressure goes as the smallest power l - 1 at which their
    determinant vanishes.

    Parameters
    ----------
    inward_friction : float
        Friction coefficient [1], positive where the friction drags the lining's face away from the
        corner, into the lining.
    material : IsotropicOrOrthotropicMaterial
        Material of the lining.
    drum : IsotropicOrOrthotropicMaterial | None
        Material of the drum's elastic ring; None for a rigid drum.
    lining_width_over_ring_width : float
        Width of the lining divided by the width of the ring.
    """
    corner = _orthotropic_corner(material, drum, lining_width_over_ring_width)
    determinant = corner.determinant_of_pressure_exponent_equations
    # The exponent is the smallest zero of the determinant. It is found at the first change of sign
    # among the determinants at many exponents.
    roots = np.linspace(
        SMALLEST_SOUGHT_EXPONENT_ROOT,
        1 - LARGEST_EXPONENT_OF_BOUNDED_PRESSURE,
        NUMBER_OF_TRIED_PRESSURE_EXPONENTS,
    )
    signs = np.sign([determinant(root, inward_friction) for root in roots.tolist()])
    changes = np.flatnonzero(signs[1:] != signs[:-1])
    if not len(changes):
        # Without a zero, either p is bounded, or the zero lies below the smallest root tried.
        below_smallest = signs[0] != np.sign(determinant(SMALLEST_SOUGHT_EXPONENT_ROOT, 0.0))
        return SMALLEST_SOUGHT_EXPONENT_ROOT - 1 if below_smallest else 0.0
    first = int(changes[0])
    # scipy.optimize takes time to load, and only the few brakes with a pressed corner need it.
    from scipy.optimize import brentq  # noqa: PLC0415

    root = brentq(determinant, roots[first], roots[first + 1], args=(inward_friction,))
    return float(root) - 1


class _DrumRingAtOrthotropicCorner(NamedTuple):
    """The drum's ring at a pressed corner of an orthotropic lining.

    Attributes
    ----------
    half_plane : 2/E [1/Pa], with the modulus E of the half-plane that takes the place of the ring
    local : slope of the ring's surface at a point, per pressure at this point, if the friction
        coefficient is 1 [1/Pa]
    lining_width_over_ring_width : width of the lining divided by the width of the ring
    """

    half_plane: float
    local: float
    lining_width_over_ring_width: float


class _OrthotropicCorner(NamedTuple):
    """A pressed corner of an orthotropic lining, for the equations of the pressure's exponent.

    Attributes
    ----------
    mu : (2,) roots mu_k of Lekhnitskii's equation, with positive imaginary part
    slopes : (2,) slope of the lining's face by each of the two terms of the stress function (k = 1,
        2), if the term has the coefficient c_k = 1 [1/Pa]
    unit : modulus [Pa] by which slopes are multiplied
    drum : the drum's elastic ring; None for a rigid drum
    """

    mu: Complexes
    slopes: Complexes
    unit: float
    drum: _DrumRingAtOrthotropicCorner | None

    def determinant_of_pressure_exponent_equations(self, root: float, friction: float) -> float:
        """The determinant of the four real equations for c_1 and c_2, at the exponent l - 1 of p.

        The complex coefficients c_k belong to the two terms of the stress function (see
        `pressure_exponent_at_orthotropic_corner`), and l is `root`.
        """
        mu, slope = self.mu, self.slopes
        rotated = mu ** (root - 1)
        if self.drum is not None:
            of_drum = self.drum.half_plane / math.tan(math.pi * root) + self.drum.local * friction
            slope = slope + self.drum.lining_width_over_ring_width * of_drum
        rows = np.array([mu**2 * rotated, mu * rotated, mu + friction, slope * self.unit])
        return float(np.linalg.det(np.hstack([rows.real, -rows.imag])))


def _orthotropic_corner(
    material: IsotropicOrOrthotropicMaterial,
    drum: IsotropicOrOrthotropicMaterial | None,
    lining_width_over_ring_width: float,
) -> _OrthotropicCorner:
    """The pressed corner of an orthotropic lining, with the constants for the pressure's exponent.

    The lining has the `material`, and the drum's elastic ring the material `drum` (None for a rigid
    drum). `lining_width_over_ring_width` is the width of the lining divided by the width of the
    ring.
    """
    compliances = _plane_stress_compliances(material)
    squares = np.roots(
        [compliances.along, 2 * compliances.mixed + compliances.shear, compliances.through]
    )
    mu = np.sqrt(squares.astype(complex))
    mu = np.where(mu.imag < 0, -mu, mu)
    slopes = compliances.mixed * mu + compliances.through / mu
    ring = None
    if drum is not None:
        of_drum = _plane_stress_compliances(drum)
        local = math.sqrt(of_drum.along * of_drum.through) + of_drum.mixed
        half_plane = 2 / drum.young_modulus_of_equivalent_half_plane
        ring = _DrumRingAtOrthotropicCorner(half_plane, local, lining_width_over_ring_width)
    return _OrthotropicCorner(mu, slopes, material.E_through, ring)


class _PlaneStressCompliances(NamedTuple):
    """The compliances of an orthotropic material in plane stress [1/Pa].

    Attributes
    ----------
    along : strain along the drum per stress along the drum
    through : strain normal to the drum per stress normal to the drum
    mixed : strain in one of these directions per stress in the other direction
    shear : shear strain per shear stress
    """

    along: float
    through: float
    mixed: float
    shear: float


def _plane_stress_compliances(material: IsotropicOrOrthotropicMaterial) -> _PlaneStressCompliances:
    """The compliances [1/Pa] of a material in plane stress, along the drum and normal to it."""
    return _PlaneStressCompliances(
        along=1 / material.E_along,
        through=1 / material.E_through,
        mixed=-material.nu_along_through / material.E_along,
        shear=1 / material.G_along_through,
    )


def pressure_exponents_at_both_lining_corners(brake: Brake, index: int) -> tuple[float, float]:
    """The exponents a of the pressure p ~ x^a at both corners of the lining of shoe `index`.

    The distance from the corner is x, see `pressure_exponent_at_lining_corner`. The first exponent
    belongs to the lining's start, the corner with the smaller angle phi in the shoe's own frame,
    and the second exponent to the lining's end.
    """
    shoe, ring = brake.shoes[index], brake.ring
    lining, inward_friction = (
        shoe.lining,
        brake.signed_friction_stress_over_pressure_in_shoe_frame(shoe),
    )
    drum = None if ring is None else ring.section
    materials = [lining.material] if drum is None else [lining.material, drum.material]
    if any(
        which_elasticity_matrices_are_orthotropic(plane_stress_elasticity_matrix(material))
        for material in materials
    ):
        lining_width_over_ring_width = 1.0 if drum is None else lining.width / drum.width
        drum_material = None if drum is None else drum.material
        at_start = pressure_exponent_at_orthotropic_corner(
            inward_friction, lining.material, drum_material, lining_width_over_ring_width
        )
        at_end = pressure_exponent_at_orthotropic_corner(
            -inward_friction, lining.material, drum_material, lining_width_over_ring_width
        )
        return at_start, at_end
    # All materials are isotropic. A rigid drum has the stiffness ratio 0.
    stiffness_ratio = nu_drum = 0.0
    if drum is not None:
        lining_stiffness = lining.material.E_along * lining.width
        stiffness_ratio = lining_stiffness / (drum.material.E_along * drum.width)
        nu_drum = drum.material.nu_along_through
    nu = lining.material.nu_along_through
    at_start = pressure_exponent_at_lining_corner(inward_friction, nu, stiffness_ratio, nu_drum)
    at_end = pressure_exponent_at_lining_corner(-inward_friction, nu, stiffness_ratio, nu_drum)
    return at_start, at_end


def polynomial_error_of_power_function(exponent: float, degree: int) -> float:
    """The relative error in L2 of the best polynomial of a degree for x^exponent on [0, 1].

    The error is relative to the norm of the power function. The exponent must be above -1/2. The
    error for x^a has a closed form (Muntz): the product of |a - k|/(a + k + 1) for k = 0 to the
    degree.
    """
    return math.prod(abs(exponent - k) / (exponent + k + 1) for k in range(degree + 1))


def element_column_size_for_error_at_pointed_gap_kink(
    length: float, degree: int, error: float
) -> float:
    """The size [rad] of element columns beside a gap kink that points to the drum.

    With this size the pressure p has the relative error `error` at the kink. The pressure goes as c
    ln(1/x) at the distance x from the kink. The best polynomial for ln x on [0, 1] has the error
    1/(degree + 1) in L2, by the sum of the Legendre coefficients.

    Parameters
    ----------
    length : the length (N/c)^2 [rad], where N [Pa rad^0.5] is the L2 norm of p over the contact
    degree : degree of the hp elements in the columns
    error : error of p in L2, relative to the norm of p
    """
    return 0.5 * length * (error * (degree + 1)) ** 2


def response_with_power_laws_at_corners(brake: Brake, response: Response) -> Response:
    """The response in which p follows a power law near the corners where p is unbounded.

    The pressure p goes as x^a at the distance x from a pressed corner of a lining. A polynomial in
    the element column at the corner has an error proportional to the column's size to the power a +
    1/2, which falls slowly. A power function with the same force and the same moment in a few
    columns as the computed p is far more exact there. The response of long contacts is not changed,
    because the stated error of their pressure excludes the zones at the lining's ends, see
    `length_of_edge_zone_left_out_of_pressure_errors`.
    """
    shoes = tuple(
        _shoe_response_with_pressure_power_laws(brake, i, shoe)
        for i, shoe in enumerate(response.shoes)
    )
    unchanged = all(new is old for new, old in zip(shoes, response.shoes, strict=True))
    return response if unchanged else replace(response, shoes=shoes)


def _shoe_response_with_pressure_power_laws(
    brake: Brake, index: int, response: ShoeResponse
) -> ShoeResponse:
    """The response of shoe `index`, with a power law near each corner of unbounded pressure."""
    for corner in corners_with_unbounded_pressure(brake, index, response):
        response = _shoe_response_with_one_corner_power_law(
            response, corner, brake.surface_coordinate_per_phi
        )
    return response


class PressureAtNodesOfShoe(Protocol):
    """The pressure of a shoe at its nodes: a part of `ShoeResponse`."""

    @property
    def theta(self) -> Floats:
        """Angles [rad] of the nodes, in increasing order."""

    @property
    def pressure(self) -> Floats:
        """Pressure [Pa] at the nodes."""

    @property
    def order(self) -> int:
        """Degree of the polynomial pieces of the pressure."""


class CornerWithUnboundedPressure(NamedTuple):
    """A corner of a lining at which the pressure p ~ x^a is unbounded.

    Attributes
    ----------
    at_start : whether the corner is the lining's end with the smaller angle theta
    exponent : the exponent a, which is negative; see `pressure_exponent_at_lining_corner`
    """

    at_start: bool
    exponent: float


def corners_with_unbounded_pressure(
    brake: Brake, index: int, response: PressureAtNodesOfShoe
) -> list[CornerWithUnboundedPressure]:
    """The pressed corners of the lining of shoe `index` at which its pressure p is unbounded.

    The list is empty for a long contact, because the stated error of its pressure excludes the
    zones at the lining's ends, see `length_of_edge_zone_left_out_of_pressure_errors`.
    """
    theta, p = response.theta, response.pressure
    if max(p[0], p[-1]) <= 0:
        return []
    # The corners are not needed if the stated error of the pressure excludes the lining's ends.
    zone = length_of_uncompared_edge_zone(
        brake.shoes[index].lining.length_of_shortest_lining, brake.surface_coordinate_per_phi
    )
    slots = brake.shoes[index].lining.slots
    if length_of_edge_zone_left_out_of_pressure_errors(theta, p, response.order, zone, slots) > 0:
        return []
    # The exponents are ordered by the shoe's own angle phi, which may grow opposite to theta.
    exponents = pressure_exponents_at_both_lining_corners(brake, index)[
        :: brake.shoes[index].frame.sense
    ]
    corners = []
    for at_start, value, exponent in ((True, p[0], exponents[0]), (False, p[-1], exponents[1])):
        if value > 0 and exponent < 0:
            corners.append(CornerWithUnboundedPressure(at_start, exponent))
    return corners


def _shoe_response_with_one_corner_power_law(
    response: ShoeResponse, corner: CornerWithUnboundedPressure, unit: float
) -> ShoeResponse:
    """The response of a shoe whose pressure near one corner of its lining becomes a power law.

    `unit` is the change of the surface's coordinate theta (on a plane x) per radian of the shoe's
    angle phi.
    """
    at_corner = float(response.theta[0 if corner.at_start else -1])
    arcs = response.contact_arcs
    contact_length = next((end - start for start, end in arcs if at_corner in {start, end}), 0.0)
    theta, pressure = nodes_and_pressures_with_power_law_at_corner(
        response.theta,
        response.pressure,
        response.order,
        corner,
        reach=POWER_LAW_FRACTION_OF_CONTACT * contact_length,
        unit=unit,
    )
    return replace(response, theta=theta, pressure=pressure)


def nodes_and_pressures_with_power_law_at_corner(
    theta: Floats,
    pressure: Floats,
    order: int,
    corner: CornerWithUnboundedPressure,
    *,
    reach: float,
    unit: float = 1.0,
) -> tuple[Floats, Floats]:
    """The pressure with c x^a + d + e x in place of its polynomials near a corner of the lining.

    The distance from the corner is x. The coefficients c, d and e follow from three conditions:
    force and moment of the replaced part stay the same, and p is continuous where this part ends.
    The power law is given by polynomial pieces of the same degree, which become shorter towards the
    corner. The new nodes [rad] and values [Pa] are returned.

    Parameters
    ----------
    theta, pressure : (n,) [rad], [Pa]
        Nodes, in increasing order, and values of the pressure, a piecewise polynomial.
    order : int
        Degree of the pieces.
    corner : CornerWithUnboundedPressure
        The end of the lining at which the corner lies, and the exponent a of p, above -1.
    reach : float
        Distance [rad] from the corner up to which pieces are replaced.
    unit : float
        Change of the surface's coordinate theta (on a plane x) per radian of the shoe's angle phi,
        see `ShoeFrame`.
    """
    sign = 1 if corner.at_start else -1
    at_corner = float(theta[0 if corner.at_start else -1])
    x, p = np.abs(theta - at_corner)[::sign], pressure[::sign]
    # Whole polynomial pieces are replaced. If no piece lies within `reach`, p is not changed.
    last = order * (int(np.searchsorted(x[::order], reach, side="right")) - 1)
    if last <= 0 or x[last] <= unit * LENGTH_OF_PRESSURE_PIECE_AT_CORNER:
        return theta, pressure
    distances = _pressure_node_positions_closer_towards_corner(
        float(x[last]), order, unit * LENGTH_OF_PRESSURE_PIECE_AT_CORNER
    )
    angles = at_corner + sign * distances
    nodes = np.abs(angles - at_corner)
    nodes[-1] = x[last]

    # The coefficients c, d and e of x^a, 1 and x follow from force, moment and continuity.
    power = _power_function_values_at_nodes(nodes, corner.exponent, order)
    functions = np.array([power, np.ones_like(nodes), nodes / x[last]])
    columns = [
        [*_force_and_scaled_moment_of_pressure(nodes, values, order), values[-1]]
        for values in functions
    ]
    conditions = [
        *_force_and_scaled_moment_of_pressure(x[: last + 1], p[: last + 1], order),
        p[last],
    ]
    fitted = np.linalg.solve(np.array(columns).T, conditions) @ functions
    return (
        np.concatenate([angles[:-1], theta[::sign][last:]])[::sign],
        np.concatenate([fitted[:-1], p[last:]])[::sign],
    )


def _pressure_node_positions_closer_towards_corner(
    length: float, order: int, smallest: float
) -> Floats:
    """The nodes (n,) [rad] of polynomial pieces from 0 to `length`, with the shortest piece at 0.

    Parameters
    ----------
    length : length of all pieces together [rad]
    order : degree of the pieces
    smallest : upper limit of the length of the piece at 0 [rad]
    """
    count = math.ceil(math.log(smallest / length) / math.log(RATIO_OF_NEIGHBOURING_PRESSURE_PIECES))
    ends = np.append(
        0.0, length * RATIO_OF_NEIGHBOURING_PRESSURE_PIECES ** np.arange(count, -1, -1)
    )
    inner = ends[:-1, None] + np.diff(ends)[:, None] * 0.5 * (1 + gauss_lobatto_points(order)[:-1])
    return np.append(inner.ravel(), length)


def _power_function_values_at_nodes(x: Floats, exponent: float, order: int) -> Floats:
    """The values (n,) of the power function (x/x[-1])^exponent at the nodes x (n,).

    The power function is unbounded at x = 0. In the piece at 0 it is therefore replaced by the
    polynomial of degree `order` that is nearest to it in L2. The Legendre coefficients of this
    polynomial have a closed form.
    """
    # Outside the piece at 0 the values are those of the power function itself.
    values = np.empty_like(x)
    values[order:] = (x[order:] / x[-1]) ** exponent
    gamma, first = math.gamma, 2 * x[:order] / x[order] - 1
    coefficients = [
        (2 * n + 1) * gamma(exponent + 1) ** 2 / (gamma(exponent + n + 2) * gamma(exponent - n + 1))
        for n in range(order + 1)
    ]
    values[:order] = values[order] * np.polynomial.legendre.legval(first, coefficients)
    return values


def _force_and_scaled_moment_of_pressure(x: Floats, p: Floats, order: int) -> tuple[float, float]:
    """The force Int p dx, and the moment Int p x dx divided by the last x, of a pressure p.

    The pressure has the values `p` at the nodes `x` and is a polynomial of degree `order` on each
    piece.
    """
    points, values, weights = polynomial_values_at_gauss_points(x, p, order)
    force = float(np.sum(values * weights))
    moment = float(np.sum(values * weights * points))
    return force, moment / float(x[-1])


def remaining_pressure_error_at_lining_corners(
    brake: Brake, index: int, response: PressureAtNodesOfShoe
) -> float:
    """The relative error in L2 of the pressure p of shoe `index` at corners where p is unbounded.

    The error is that of the polynomial pieces next to the corners, which are as short as the
    round-off of angles allows. The error is 1 if p is not square-integrable. The error is also 1 if
    p is unbounded beside a slot between two linings and the stated error does not exclude the
    linings' ends, because no power law replaces the polynomials at a slot.
    """
    if _does_stated_error_include_unbounded_pressure_at_slot(brake, index, response):
        return 1.0
    corners = corners_with_unbounded_pressure(brake, index, response)
    if not corners:
        return 0.0
    _, p, weight = polynomial_values_at_gauss_points(
        response.theta, response.pressure, response.order
    )
    squares = np.sum(weight * p**2, axis=1)
    error = 0.0
    for corner in corners:
        if corner.exponent <= -0.5:
            return 1.0
        part = float(squares[0 if corner.at_start else -1] / squares.sum())
        error += polynomial_error_of_power_function(corner.exponent, response.order) * math.sqrt(
            part
        )
    return error


def _does_stated_error_include_unbounded_pressure_at_slot(
    brake: Brake, index: int, response: PressureAtNodesOfShoe
) -> bool:
    """Whether p is unbounded beside a slot, at a place that the stated error of p includes."""
    lining = brake.shoes[index].lining
    edges = [int(np.abs(response.theta - edge).argmin()) for edge in np.ravel(lining.slots)]
    if not np.any(response.pressure[edges] > 0):
        return False
    zone = length_of_uncompared_edge_zone(
        lining.length_of_shortest_lining, brake.surface_coordinate_per_phi
    )
    counts = length_of_edge_zone_left_out_of_pressure_errors(
        response.theta, response.pressure, response.order, zone, lining.slots
    )
    return counts == 0 and min(pressure_exponents_at_both_lining_corners(brake, index)) < 0


class LogarithmicPressureAtGapKink(NamedTuple):
    """The pressure p = c ln(1/x) near a kink of the gap that points to the drum.

    The distance x from the kink is small.

    Attributes
    ----------
    theta : position of the kink [rad]
    factor : the factor c [Pa]
    """

    theta: float
    factor: float


def logarithmic_pressures_at_pointed_gap_kinks(
    shoe: Shoe, length_per_surface_coordinate: float
) -> list[LogarithmicPressureAtGapKink]:
    """The logarithmic pressure c ln(1/x) under each kink of the gap that points to the drum.

    The distance from the kink is x. For a half-plane of modulus E and a change of slope s at the
    kink, c = E s/(2 pi) (Johnson, Contact Mechanics, ch. 5). `length_per_surface_coordinate` is the
    length per unit of the surface's coordinate [m/rad, on a plane 1].
    """
    # `half_plane` is the factor c in p = c ln(1/x) if the slope of the gap at the kink changes by 1
    # per unit of the surface's coordinate.
    half_plane = shoe.lining.material.young_modulus_of_equivalent_half_plane / (
        2 * math.pi * length_per_surface_coordinate
    )
    tips = clearance.gap_kinks_that_point_to_drum(shoe.lining)
    return [LogarithmicPressureAtGapKink(theta, half_plane * slope) for theta, slope in tips]


def remaining_pressure_error_at_pointed_gap_kinks(
    shoe: Shoe, length_per_surface_coordinate: float, response: ShoeResponse
) -> float:
    """The relative error in L2 of a shoe's pressure p due to kinks that point to the drum.

    If such a kink is in contact, p goes as ln(1/x) at the distance x from the kink. The error
    arises in the element columns on both sides of each kink, because a polynomial cannot follow the
    logarithm. `length_per_surface_coordinate` is the length per unit of the surface's coordinate
    [m/rad, on a plane 1].
    """
    theta, p, order = response.theta, response.pressure, response.order
    column_ends, pressed = theta[::order], p[::order] > 0
    squared_error = 0.0
    for tip in logarithmic_pressures_at_pointed_gap_kinks(shoe, length_per_surface_coordinate):
        # A kink counts if the lining is in contact there, and if two element columns meet at the
        # kink.
        k = int(np.abs(column_ends - tip.theta).argmin())
        has_two_columns = 0 < k < len(column_ends) - 1
        at_tip = (
            abs(column_ends[k] - tip.theta)
            < TOLERANCE_OF_COLUMN_END_AT_GAP_KINK * shoe.frame.surface_coordinate_per_phi
        )
        if has_two_columns and at_tip and pressed[k]:
            both_columns = float(column_ends[k + 1] - column_ends[k - 1])
            squared_error += tip.factor**2 * both_columns / (order + 1) ** 2
    if not squared_error:
        return 0.0
    _, values, weights = polynomial_values_at_gauss_points(theta, p, order)
    squared_norm = float(np.sum(weights * values**2))
    return math.sqrt(squared_error / squared_norm) if squared_norm else 0.0
