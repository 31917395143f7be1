"""Rigid-shoe laws of a drum brake, as formulas on arrays.

Angles phi are measured at the drum's centre O from the hinge, in the shoe's own frame. A law states
p(phi) = p_0 f(phi). A shoe needs only three integrals of it over the arc, its `Load`. With these
every law has the form of the short shoe of the UWA notes (eq. 6a):

    M = b R p_0 (M_N - dD mu M_F),   M_N = a Load.sin,   M_F = R Load.total - a Load.cos
    T = mu b R^2 p_0 Load.total,     mu_lock = M_N / (dD M_F)

All formulas broadcast: a million brakes are one call.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats, Values


class Load(NamedTuple):
    """Integrals over the arc of a pressure of amplitude 1: of f, f cos phi and f sin phi."""

    total: Floats
    cos: Floats
    sin: Floats


class Layout(NamedTuple):
    """Angles and radii of a shoe on a drum that the formulas of a law take; entries broadcast.

    Attributes
    ----------
    phi_1, phi_2 : begin and end of the lining's arc, from the hinge [rad]
    R : radius of the drum [m]
    a : radius of the hinge [m]
    dD : double delta of the UWA notes: +1 for an external shoe whose lining the drum drags away
        from the hinge, and for an internal shoe whose lining the drum drags towards the hinge;
        otherwise -1
    """

    phi_1: Values
    phi_2: Values
    R: Values
    a: Values
    dD: Values

    @property
    def middle(self) -> Floats:
        """Angle phi of the lining's middle [rad]."""
        return np.asarray(0.5 * (self.phi_1 + self.phi_2))

    @property
    def half(self) -> Floats:
        """Half the lining's arc, theta_0 [rad]."""
        return np.asarray(0.5 * (self.phi_2 - self.phi_1))


def moments_about(load: Load, R: Values, x: Values, y: Values = 0.0) -> tuple[Floats, Floats]:
    """Moments M_N and M_F [m] of a load about a point of the shoe's frame, over b R p_0.

    The normal pressure resists the actuation with M_N. The friction helps it with M_F at
    mu = dD = 1.

    Parameters
    ----------
    load : of the law
    R : radius of the drum [m]
    x, y : the point [m]; x = a and y = 0 for the hinge
    """
    M_N = x * load.sin - y * load.cos
    M_F = R * load.total - x * load.cos - y * load.sin
    return np.asarray(M_N), np.asarray(M_F)


def sine_load(arc: Layout) -> Load:
    """Integrals of the pressure f = sin phi over the arc (UWA notes; NPTEL lesson 12.1)."""
    phi_1, phi_2 = arc.phi_1, arc.phi_2
    Is = np.cos(phi_1) - np.cos(phi_2)
    Iss = (phi_2 - phi_1) / 2 - (np.sin(2 * phi_2) - np.sin(2 * phi_1)) / 4
    Isc = (np.cos(2 * phi_1) - np.cos(2 * phi_2)) / 4
    return Load(Is, Isc, Iss)


def cos_load(arc: Layout) -> Load:
    """Integrals of f = cos phi, which with sin phi spans the pressures of a shoe with two modes."""
    phi_1, phi_2 = arc.phi_1, arc.phi_2
    Ic = np.sin(phi_2) - np.sin(phi_1)
    Icc = (phi_2 - phi_1) / 2 + (np.sin(2 * phi_2) - np.sin(2 * phi_1)) / 4
    return Load(Ic, Icc, sine_load(arc).cos)


def cosine_load(arc: Layout) -> Load:
    """Integrals of the pressure f = cos(phi - middle) over the arc."""
    # The resultant of the pressure lies along the middle radius.
    along = arc.half + np.sin(2 * arc.half) / 2
    return Load(2 * np.sin(arc.half), along * np.cos(arc.middle), along * np.sin(arc.middle))


def uniform_load(arc: Layout) -> Load:
    """Integrals of the even pressure f = 1, where each element presses along its own radius."""
    along = 2 * np.sin(arc.half)
    return Load(2 * arc.half, along * np.cos(arc.middle), along * np.sin(arc.middle))


def short_load(arc: Layout) -> Load:
    """Integrals of f = 1, where all elements press along the middle radius (UWA notes, eq. v)."""
    along = 2 * arc.half
    return Load(along, along * np.cos(arc.middle), along * np.sin(arc.middle))


def block_load(arc: Layout) -> Load:
    """Integrals of f = cos(phi - middle) whose force acts along the middle radius (NPTEL 12.1)."""
    along = arc.half + np.sin(2 * arc.half) / 2
    return Load(along, along * np.cos(arc.middle), along * np.sin(arc.middle))


def equivalent_friction(theta_0: Values) -> Floats:
    """Lumped friction T/R of a block over its normal force, relative to mu: mu'/mu.

    It is 4 sin theta_0 / (2 theta_0 + sin 2 theta_0) for p = p_0 cos over the half-arc theta_0
    [rad] (NPTEL lesson 12.1).
    """
    return np.asarray(4 * np.sin(theta_0) / (2 * theta_0 + np.sin(2 * theta_0)))


def pivot_radius(R: Values, theta_0: Values) -> Floats:
    """Distance [m] from O at which a pivot leaves p = p_0 cos.

    It is 4 R sin theta_0 / (2 theta_0 + sin 2 theta_0).
    """
    return np.asarray(R * equivalent_friction(theta_0))


def _one(arc: Layout) -> Floats:
    """The factor 1 on mu, for friction that is not lumped."""
    return np.ones(np.shape(arc.half))


@dataclass(frozen=True)
class Law:
    """A law p = p_0 f(phi) of a shoe that turns about its hinge.

    Attributes
    ----------
    name : of the law
    assumes : its assumptions, in words
    load : integrals of f over an arc
    pressure : f at angles phi
    peak_at : angle phi of the largest f [rad]
    lumped : whether all of the contact acts at the lining's middle
    friction : factor on mu of a lumped friction
    remark : note for readers of its numbers
    """

    name: str
    assumes: str
    load: Callable[[Layout], Load]
    pressure: Callable[[Floats, Layout], Floats]
    peak_at: Callable[[Layout], Floats]
    lumped: bool = False
    friction: Callable[[Layout], Floats] = _one
    remark: str = ""

    def moments(self, arc: Layout) -> tuple[Floats, Floats]:
        """Moments M_N and M_F [m] about the hinge over b R p_0, see `moments_about`."""
        M_N, M_F = moments_about(self.load(arc), arc.R, arc.a)
        return M_N, self.friction(arc) * M_F

    def resistance(self, mu: Values, arc: Layout) -> Floats:
        """Actuation moment over b R p_0, M_N - dD mu M_F [m].

        It is not positive if the shoe locks itself.
        """
        M_N, M_F = self.moments(arc)
        return M_N - arc.dD * mu * M_F

    def amplitude(self, moment: Values, width: Values, mu: Values, arc: Layout) -> Floats:
        """Amplitude p_0 [Pa] of the pressure; nan if the shoe locks itself.

        Parameters
        ----------
        moment : of the actuation [N m]
        width : of the lining [m]
        mu : friction coefficient
        arc : layout of the shoe
        """
        resistance = self.resistance(mu, arc)
        return moment / (width * arc.R * np.where(resistance > 0, resistance, np.nan))

    def torque(self, moment: Values, mu: Values, arc: Layout) -> Floats:
        """Torque [N m] under an actuation moment [N m]; nan if the shoe locks itself."""
        return moment * self.mechanical_advantage(mu, arc)

    def mechanical_advantage(self, mu: Values, arc: Layout) -> Floats:
        """Ratio eta = T/M = 1/(m - dD n) (UWA, eq. 8); nan if the shoe locks itself."""
        resistance = self.resistance(mu, arc)
        effect = mu * self.friction(arc) * arc.R * self.load(arc).total
        return effect / np.where(resistance > 0, resistance, np.nan)

    def sensitivity(self, mu: Values, arc: Layout) -> Floats:
        """Sensitivity S = (mu/eta) d eta/d mu = m eta (UWA, eq. 8); nan if self-locking."""
        M_N, _ = self.moments(arc)
        resistance = self.resistance(mu, arc)
        return M_N / np.where(resistance > 0, resistance, np.nan)

    def locking_friction(self, arc: Layout) -> Floats:
        """Friction mu_lock = M_N / (dD M_F) at which the torque becomes infinite.

        It is inf if friction does not help the actuation.
        """
        M_N, M_F = self.moments(arc)
        helps = arc.dD * M_F > 0
        # Friction that passes almost through the hinge overflows to the right result, inf.
        with np.errstate(over="ignore"):
            return np.where(helps, M_N / np.where(helps, arc.dD * M_F, 1.0), np.inf)


def m_and_n(mu: Values, theta_m: Values, r: Values, a: Values) -> tuple[Floats, Floats]:
    """Figures m = (a/(mu r)) sin theta_m and n = 1 - (a/r) cos theta_m of a short shoe.

    The shoe stands at the angle theta_m [rad] (UWA, eq. 6a).
    """
    m = a / (mu * r) * np.sin(theta_m)
    n = 1 - a / r * np.cos(theta_m)
    return np.asarray(m), np.asarray(n)


def _middle(arc: Layout) -> Floats:
    """Angle phi [rad] of the lining's middle, where a pressure of this kind has its peak."""
    return arc.middle


def _cosine(phi: Floats, arc: Layout) -> Floats:
    """The pressure f = cos(phi - middle), same shape as phi."""
    return np.cos(phi - arc.middle)


def _constant(phi: Floats, arc: Layout) -> Floats:
    """The even pressure f = 1, same shape as phi."""
    return np.ones(np.broadcast_shapes(np.shape(phi), np.shape(arc.middle)))


SINE = Law(
    "sine",
    "rigid shoe turning about its hinge: p = p_a sin(phi)/sin(phi_a), phi from the hinge",
    sine_load,
    lambda phi, arc: np.sin(phi),
    lambda arc: np.clip(np.pi / 2, arc.phi_1, arc.phi_2),
)
COSINE = Law(
    "cosine",
    "rigid shoe moving along its middle radius: p = p_0 cos(theta - middle), each element "
    "along its radius",
    cosine_load,
    _cosine,
    _middle,
    remark="friction is mu N at psi R, each element in its place; mu' N at the drum's surface "
    "is the law 'block'",
)
BLOCK = Law(
    "block",
    "p = p_0 cos(theta - middle) lumped at the drum's surface: N, and friction mu' N, at the "
    "lining's middle",
    block_load,
    _cosine,
    _middle,
    lumped=True,
    friction=lambda arc: equivalent_friction(arc.half),
)
UNIFORM = Law(
    "uniform",
    "the same pressure everywhere on the lining, each element along its radius",
    uniform_load,
    _constant,
    _middle,
)
SHORT_LAW = Law(
    "short",
    "short shoe: N = p_m A and friction mu N at the lining's middle",
    short_load,
    _constant,
    _middle,
    lumped=True,
)
LAWS = {law.name: law for law in (SINE, COSINE, BLOCK, UNIFORM, SHORT_LAW)}
