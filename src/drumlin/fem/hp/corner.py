"""The singular pressure at a pressed corner of a lining and under a tip of its gap.

A lining ends with a face square to the drum. Near the corner the lining is an elastic wedge of 90
degrees that slides on a half-plane, and p goes as x^a, x the distance from the corner. Under a tip
of the gap p goes as ln(1/x) (Johnson, Contact Mechanics, ch. 5).
"""

import math
from dataclasses import replace
from functools import cache
from typing import NamedTuple, Protocol

import numpy as np

from drumlin.base.arrays import Floats
from drumlin.brake import clearance
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.elasticity import elasticity_matrix, has_directions
from drumlin.brake.fields import AnyMaterial
from drumlin.response.response import Response, ShoeResponse, singular_zone
from drumlin.response.resultants import edge_left_out, gauss_points, lobatto

LEAST_ROOT = 1e-3
"""Smallest 1 + a of a power a that is looked for. At 1 + a = 1/2 p ceases to be square-integrable,
which takes a friction coefficient of 0.57 to 0.61 on a rigid drum.
"""
SMOOTH = 1e-6
"""Absolute value of the power a below which p counts as bounded at the corner. A smaller power
cannot be told from a constant: the equations for the parts of both have 16 digits.
"""

ROOTS_TRIED = 200
"""Number of powers between which the determinant of an orthotropic corner is searched for a change
of sign. Two roots between neighbouring powers would be missed.
"""

NEAR_CORNER = 2e-3
"""Part of a contact in which p is replaced by the power of its corner: three or four columns.

The column next to the corner, and a little the next one, suffer from no polynomial being a power;
columns farther away feel the rest of the lining. On two brakes the error of p was the same with
three to six columns, and 10 to 30 times as large with one.
"""
SMALLEST_PIECE = 1e-12
"""Length [rad] of the piece of p next to the corner. Angles of 3 rad are known to 4e-16, and the
nodes of a piece of degree 7 are a sixteenth of its length apart.
"""
PIECE_RATIO = 0.4
"""Ratio of the lengths of neighbouring pieces of p at a corner. Polynomials of degree 5 follow a
power to about 1e-4 on each piece; a larger ratio takes more pieces.
"""

AT_TIP = 1e-9
"""Distance [rad] from a tip below which columns count as ending there; the rest is round-off."""


@cache
def corner_power(inward: float, nu: float, softness: float = 0.0, nu_drum: float = 0.0) -> float:
    """The power a of x with which p goes at a pressed corner of a lining: at most 0, above -1.

    With l = a + 1 and s = sin(pi l/2) the fields r^l of the wedge (Williams 1952), free on one face
    and with the shear `inward` p on the other, meet the half-plane where

        sin(pi l) = f (2 (l + s^2) + (1 + nu) (l^2 - s^2))
                    + k (l^2 - s^2) ((1 - nu_drum) f + 2 cot(pi l)).

    This is the condition of Comninou (Stress singularity at a sharp edge in contact problems with
    friction, ZAMP 27, 1976) for a right angle; without friction that of Dundurs & Lee (Stress
    concentration at a sharp edge in contact problems, J. Elasticity 2, 1972). For little friction
    on a rigid drum a = -4 f/pi.

    Parameters
    ----------
    inward : float
        Friction coefficient f [1], positive where it drags the lining's face away from the corner
        into the lining. Where it drags towards the corner p is bounded: then 0 is returned.
    nu : float
        Poisson's ratio of the lining.
    softness : float
        k = E w of the lining over E w of the drum's ring, w the widths; 0 for a rigid drum.
    nu_drum : float
        Poisson's ratio of the ring.
    """
    if inward < 0 and softness == 0:
        return 0.0

    def excess(root: float) -> float:
        s2 = math.sin(0.5 * math.pi * root) ** 2
        apart = root**2 - s2
        of_drum = softness * apart * ((1 - nu_drum) * inward + 2 / math.tan(math.pi * root))
        return math.sin(math.pi * root) - inward * (2 * (root + s2) + (1 + nu) * apart) - of_drum

    if excess(LEAST_ROOT) <= 0:
        return LEAST_ROOT - 1
    if excess(1 - SMOOTH) >= 0:
        return 0.0
    from scipy.optimize import brentq  # noqa: PLC0415  (few brakes press with a corner)

    return float(brentq(excess, LEAST_ROOT, 1 - SMOOTH)) - 1


@cache
def orthotropic_corner_power(
    inward: float, material: AnyMaterial, drum: AnyMaterial | None = None, wider: float = 1.0
) -> float:
    """The power a of `corner_power` for orthotropic materials, along and square to the drum.

    Stresses are 2 Re sum_k (mu_k^2, 1, -mu_k) l c_k z_k^(l - 1) with z_k = x + mu_k y and the roots
    mu_k of Lekhnitskii's equation (Anisotropic Plates, section 19). Two conditions on the free
    face, the friction and the equal slopes of both surfaces are four real equations in c_1 and c_2:
    p goes as the smallest power l - 1 at which their determinant vanishes.

    Parameters
    ----------
    inward : float
        As of `corner_power`.
    material : AnyMaterial
        Of the lining, not isotropic.
    drum : AnyMaterial | None
        Of the ring; None of a rigid drum.
    wider : float
        Width of the lining over that of the ring.
    """
    own, unit = _compliances(material), material.E_through
    # Lekhnitskii's roots with positive imaginary part.
    squares = np.roots([own.along, 2 * own.mixed + own.shear, own.through])
    mu = np.sqrt(squares.astype(complex))
    mu = np.where(mu.imag < 0, -mu, mu)
    slopes = own.mixed * mu + own.through / mu
    of_drum = None if drum is None else _compliances(drum)

    def determinant(root: float, inward: float) -> float:
        turned = mu ** (root - 1)
        slope = slopes
        if drum is not None and of_drum is not None:
            local = math.sqrt(of_drum.along * of_drum.through) + of_drum.mixed
            yields = 2 / drum.E_half_plane / math.tan(math.pi * root) + local * inward
            slope = slopes + wider * yields
        rows = np.array([mu**2 * turned, mu * turned, mu + inward, slope * unit])
        return float(np.linalg.det(np.hstack([rows.real, -rows.imag])))

    roots = np.linspace(LEAST_ROOT, 1 - SMOOTH, ROOTS_TRIED)
    values = [determinant(root, inward) for root in roots.tolist()]
    signs = np.sign(values)
    changes = np.flatnonzero(signs[1:] != signs[:-1])
    if not len(changes):
        passed = signs[0] != np.sign(determinant(LEAST_ROOT, 0.0))
        return LEAST_ROOT - 1 if passed else 0.0
    first = int(changes[0])
    from scipy.optimize import brentq  # noqa: PLC0415  (few brakes press with a corner)

    return float(brentq(determinant, roots[first], roots[first + 1], args=(inward,))) - 1


class _Compliances(NamedTuple):
    """Compliances of a material in plane stress [1/Pa]."""

    along: float
    through: float
    mixed: float
    shear: float


def _compliances(material: AnyMaterial) -> _Compliances:
    """The compliances of a material in plane stress."""
    mixed = -material.nu_along_through / material.E_along
    return _Compliances(
        1 / material.E_along, 1 / material.E_through, mixed, 1 / material.G_along_through
    )


def powers_of(brake: Brake, index: int) -> tuple[float, float]:
    """The powers of p at both ends of the lining of shoe `index`, by the shoe's own angles."""
    shoe, ring = brake.shoes[index], brake.ring
    lining, inward = shoe.lining, brake.drag_on(shoe)
    drum = None if ring is None else ring.section
    materials = [lining.material] if drum is None else [lining.material, drum.material]
    if any(has_directions(elasticity_matrix(material)) for material in materials):
        wider = 1.0 if drum is None else lining.width / drum.width
        behind = None if drum is None else drum.material
        at_start = orthotropic_corner_power(inward, lining.material, behind, wider)
        at_end = orthotropic_corner_power(-inward, lining.material, behind, wider)
        return at_start, at_end
    softness = nu_drum = 0.0
    if drum is not None:
        lining_stiffness = lining.material.E_along * lining.width
        softness = lining_stiffness / (drum.material.E_along * drum.width)
        nu_drum = drum.material.nu_along_through
    nu = lining.material.nu_along_through
    at_start = corner_power(inward, nu, softness, nu_drum)
    at_end = corner_power(-inward, nu, softness, nu_drum)
    return at_start, at_end


def left_by_power(power: float, degree: int) -> float:
    """Distance in L2 of x^power from the polynomials of a degree on [0, 1], relative to its norm.

    The closed form is that of Muntz: the product of |a - k|/(a + k + 1) over k = 0 to the degree.
    The power must be above -1/2.
    """
    return math.prod(abs(power - k) / (power + k + 1) for k in range(degree + 1))


def tip_size(length: float, degree: int, error: float) -> float:
    """Size of the columns [rad] on both sides of a tip that leave a given error of p in L2.

    A polynomial leaves an error of 1/(degree + 1) of ln x on [0, 1], by the sum of its Legendre
    coefficients.

    Parameters
    ----------
    length : (N/c)^2 [rad] for a pressure of the norm N [Pa rad^0.5] that goes as c ln(1/x)
    degree : of the columns
    error : relative to the norm of p
    """
    return 0.5 * length * (error * (degree + 1)) ** 2


def with_powers(brake: Brake, found: Response) -> Response:
    """The response with p given by the corner's power in the columns next to pressed corners.

    It changes contacts that are so short that the zone at the lining's ends counts, see
    `edge_left_out`; elsewhere p at the corner is not judged. A column leaves an error of its size
    to the power a + 1/2, which falls slowly. The power function that has the force and the moment
    of a few columns is far more exact there.
    """
    shoes = tuple(_with_powers(brake, i, shoe) for i, shoe in enumerate(found.shoes))
    same = all(one is other for one, other in zip(shoes, found.shoes, strict=True))
    return found if same else replace(found, shoes=shoes)


def _with_powers(brake: Brake, index: int, found: ShoeResponse) -> ShoeResponse:
    """The response of one shoe, as `with_powers`."""
    for at_start, power in steep_corners(brake, index, found):
        found = _with_power(found, power, brake.unit, at_start=at_start)
    return found


class NodalPressure(Protocol):
    """The nodal pressure of a shoe, see `ShoeResponse`."""

    @property
    def theta(self) -> Floats:
        """Angles [rad] of its nodes, growing."""

    @property
    def pressure(self) -> Floats:
        """Pressure [Pa] there."""

    @property
    def order(self) -> int:
        """Degree of its pieces."""


def steep_corners(brake: Brake, index: int, found: NodalPressure) -> list[tuple[bool, float]]:
    """The pressed corners of a shoe at which p is unbounded and counts.

    Each is given by whether it lies where theta begins, and by the power of p.
    """
    theta, p = found.theta, found.pressure
    if max(p[0], p[-1]) <= 0:
        return []
    zone = singular_zone(float(theta[-1] - theta[0]), brake.unit)
    if edge_left_out(theta, p, found.order, zone) > 0:
        return []
    powers = powers_of(brake, index)[:: brake.shoes[index].frame.sense]
    pressed = ((True, p[0], powers[0]), (False, p[-1], powers[1]))
    return [(at_start, power) for at_start, value, power in pressed if value > 0 and power < 0]


def _with_power(found: ShoeResponse, power: float, unit: float, *, at_start: bool) -> ShoeResponse:
    """The response of a shoe with the `power` at one of its corners, see `power_at_corner`."""
    corner = float(found.theta[0 if at_start else -1])
    arc = next((b - a for a, b in found.contact_arcs if corner in {a, b}), 0.0)
    theta, pressure = power_at_corner(
        found.theta,
        found.pressure,
        found.order,
        power,
        reach=NEAR_CORNER * arc,
        at_start=at_start,
        unit=unit,
    )
    return replace(found, theta=theta, pressure=pressure)


def power_at_corner(
    theta: Floats,
    pressure: Floats,
    order: int,
    power: float,
    *,
    reach: float,
    at_start: bool,
    unit: float = 1.0,
) -> tuple[Floats, Floats]:
    """Nodes and values of a pressure with c x^power + d + e x near a corner, at the distance x.

    The new pieces have the force and the moment of the pieces that they replace, and p where these
    end. They have the same order and shrink towards the corner.

    Parameters
    ----------
    theta, pressure : (n,) [rad], [Pa]
        Growing nodes and values of a piecewise polynomial of degree `order`.
    power : float
        As of `corner_power`, above -1.
    reach : float
        Angle [rad] from the corner up to which pieces give way.
    at_start : bool
        Whether the corner is at theta[0], not at theta[-1].
    unit : float
        The surface's coordinate, in which theta counts, per unit of phi: see `ShoeFrame`.
    """
    sign = 1 if at_start else -1
    corner = float(theta[0 if at_start else -1])
    x, p = np.abs(theta - corner)[::sign], pressure[::sign]
    last = order * (int(np.searchsorted(x[::order], reach, side="right")) - 1)
    if last <= 0 or x[last] <= unit * SMALLEST_PIECE:
        return theta, pressure
    angles = corner + sign * _pieces(float(x[last]), order, unit * SMALLEST_PIECE)
    nodes = np.abs(angles - corner)
    nodes[-1] = x[last]
    ways = np.array([_power_at(nodes, power, order), np.ones_like(nodes), nodes / x[last]])
    matrix = np.array([[*_force_and_moment(nodes, way, order), way[-1]] for way in ways]).T
    conditions = [*_force_and_moment(x[: last + 1], p[: last + 1], order), p[last]]
    fitted = np.linalg.solve(matrix, conditions) @ ways
    return (
        np.concatenate([angles[:-1], theta[::sign][last:]])[::sign],
        np.concatenate([fitted[:-1], p[last:]])[::sign],
    )


def _pieces(length: float, order: int, smallest: float) -> Floats:
    """Nodes (n,) of pieces from 0 to a `length` [rad] that shrink to the `smallest` towards 0."""
    count = math.ceil(math.log(smallest / length) / math.log(PIECE_RATIO))
    ends = np.append(0.0, length * PIECE_RATIO ** np.arange(count, -1, -1))
    inner = ends[:-1, None] + np.diff(ends)[:, None] * 0.5 * (1 + lobatto(order)[:-1])
    return np.append(inner.ravel(), length)


def _power_at(x: Floats, power: float, order: int) -> Floats:
    """The function (x/x[-1])^power at the nodes x (n,).

    In the piece at 0 the values are those of the nearest polynomial in L2.
    """
    found = np.empty_like(x)
    found[order:] = (x[order:] / x[-1]) ** power
    gamma, first = math.gamma, 2 * x[:order] / x[order] - 1
    own = [
        (2 * n + 1) * gamma(power + 1) ** 2 / (gamma(power + n + 2) * gamma(power - n + 1))
        for n in range(order + 1)
    ]
    found[:order] = found[order] * np.polynomial.legendre.legval(first, own)
    return found


def _force_and_moment(x: Floats, p: Floats, order: int) -> tuple[float, float]:
    """The integrals of p and of p x over x; the second one is relative to the last x."""
    at, value, weight = gauss_points(x, p, order)
    return float(np.sum(value * weight)), float(np.sum(value * weight * at)) / float(x[-1])


def left_at_corners(brake: Brake, index: int, found: NodalPressure) -> float:
    """The error of p in L2, relative to p, that the smallest pieces at pressed corners leave.

    The pieces are as small as angles allow. The error is 1 where p is not square-integrable.
    """
    left = 0.0
    _, p, weight = gauss_points(found.theta, found.pressure, found.order)
    parts = np.sum(weight * p**2, axis=1)
    for at_start, power in steep_corners(brake, index, found):
        if power <= -0.5:
            return 1.0
        own = float(parts[0 if at_start else -1] / parts.sum())
        left += left_by_power(power, found.order) * math.sqrt(own)
    return left


def tip_rises(shoe: Shoe, scale_factor: float) -> list[tuple[float, float]]:
    """The tips of a lining's gap: position, and the c [Pa] of p = c ln(1/x) under each.

    c = E s/(2 pi), as of a half-plane whose slope changes by s.
    """
    half_plane = shoe.lining.material.E_half_plane / (2 * math.pi * scale_factor)
    return [(angle, half_plane * slope) for angle, slope in clearance.tips(shoe.lining)]


def left_under_tips(shoe: Shoe, scale_factor: float, found: ShoeResponse) -> float:
    """The error of p in L2, relative to p, that the columns at pressed tips of the gap leave.

    See `tip_size`.
    """
    theta, p, order = found.theta, found.pressure, found.order
    ends, pressed, left = theta[::order], p[::order] > 0, 0.0
    for angle, rise in tip_rises(shoe, scale_factor):
        k = int(np.abs(ends - angle).argmin())
        inner = 0 < k < len(ends) - 1
        if inner and abs(ends[k] - angle) < AT_TIP * shoe.frame.unit and pressed[k]:
            left += rise**2 * float(ends[k + 1] - ends[k - 1]) / (order + 1) ** 2
    _, value, weight = gauss_points(theta, p, order)
    size = float(np.sum(weight * value**2))
    return math.sqrt(left / size) if size else 0.0
