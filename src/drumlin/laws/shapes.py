"""Pressure laws p = p_0 f(phi) of rigid shoes on a drum, as formulas on arrays.

The angle phi is measured at the drum's centre O from the hinge, in the shoe's own frame. Forces and
moments of a shoe follow from three integrals over the lining's arc: I of f, I_c of f cos phi, and
I_s of f sin phi. `PressureIntegrals` holds them as `total`, `cos` and `sin`. With these integrals
the equations of every law have the form that the UWA notes give for the short shoe (eq. 6a). Here M
is the actuation moment about the hinge, T the torque, b the lining's width, R the drum's radius, a
the hinge's distance from O, and dD a sign (see `ShoeAnglesAndRadii`):

    M = b R p_0 (M_N - dD mu M_F),      M_N = a I_s,      M_F = R I - a I_c,
    T = mu b R^2 p_0 I,                 mu_lock = M_N / (dD M_F)

The law "block" has mu times the factor `PressureLawOfHingedShoe.friction` in place of mu. All
formulas take arrays that broadcast, so that one call can solve many brakes.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats, NumberOrArray


class PressureIntegrals(NamedTuple):
    """Integrals over the lining's arc of f(phi), the pressure divided by its amplitude p_0.

    Times p_0, the lining's width and the drum's radius, the integrals are forces.

    Attributes
    ----------
    total : integral of f; gives the sum of the magnitudes of all normal forces
    cos : integral of f cos phi; gives the component of the resultant along the line from the drum's
        centre to the hinge
    sin : integral of f sin phi; gives the component of the resultant at right angles to this line
    """

    total: Floats
    cos: Floats
    sin: Floats


class ShoeAnglesAndRadii(NamedTuple):
    """Angles, radii and the sign dD of a shoe on a drum, which the formulas of a law need.

    The attributes are numbers or arrays that broadcast, so that one call serves many shoes.

    Attributes
    ----------
    phi_1, phi_2 : angles of the lining's begin and end from the hinge [rad]
    R : radius of the drum [m]
    a : distance of the hinge from the drum's centre [m]
    dD : double delta of the UWA notes: +1 for an external shoe whose lining the drum drags away
        from the hinge, and for an internal shoe whose lining the drum drags towards the hinge;
        otherwise -1
    slots : angles from the hinge at which each slot between two linings begins and ends [rad]
    """

    phi_1: NumberOrArray
    phi_2: NumberOrArray
    R: NumberOrArray
    a: NumberOrArray
    dD: NumberOrArray
    slots: tuple[tuple[NumberOrArray, NumberOrArray], ...] = ()

    @property
    def linings(self) -> "list[ShoeAnglesAndRadii]":
        """The angles and radii of each lining on its own, in order of the angle from the hinge."""
        ends = [self.phi_1, *(end for slot in self.slots for end in slot), self.phi_2]
        pairs = zip(ends[::2], ends[1::2], strict=True)
        return [self._replace(phi_1=first, phi_2=last, slots=()) for first, last in pairs]

    @property
    def middle(self) -> Floats:
        """Angle phi of the lining's middle [rad]."""
        return np.asarray(0.5 * (self.phi_1 + self.phi_2))

    @property
    def half_of_lining_arc(self) -> Floats:
        """Half the lining's arc, theta_0 [rad]."""
        return np.asarray(0.5 * (self.phi_2 - self.phi_1))


def scaled_normal_and_friction_moments_about_point(
    load: PressureIntegrals, R: NumberOrArray, x: NumberOrArray, y: NumberOrArray = 0.0
) -> tuple[Floats, Floats]:
    """Moments M_N and M_F [m] about a point, of pressure and friction, divided by b R p_0.

    Here b is the lining's width, R the drum's radius and p_0 the pressure's amplitude. The moment
    M_N of the normal pressure opposes the actuation. The moment M_F of the friction is for mu = 1;
    with dD = 1 it helps the actuation.

    Parameters
    ----------
    load : integrals of the pressure over the lining's arc
    R : radius of the drum [m]
    x, y : the point [m]; x = a and y = 0 for the hinge
    """
    M_N = x * load.sin - y * load.cos
    M_F = R * load.total - x * load.cos - y * load.sin
    return np.asarray(M_N), np.asarray(M_F)


def integrals_of_sine_pressure(arc: ShoeAnglesAndRadii) -> PressureIntegrals:
    """Integrals of the pressure f = sin phi over the arc (UWA notes; NPTEL lesson 12.1)."""
    phi_1, phi_2 = arc.phi_1, arc.phi_2
    Is = np.cos(phi_1) - np.cos(phi_2)
    Iss = (phi_2 - phi_1) / 2 - (np.sin(2 * phi_2) - np.sin(2 * phi_1)) / 4
    Isc = (np.cos(2 * phi_1) - np.cos(2 * phi_2)) / 4
    return PressureIntegrals(Is, Isc, Iss)


def integrals_of_cos_phi_pressure(arc: ShoeAnglesAndRadii) -> PressureIntegrals:
    """Integrals of the pressure f = cos phi over the arc.

    The pressure of a shoe with two rigid-body modes is a linear combination of cos phi and sin phi.
    """
    phi_1, phi_2 = arc.phi_1, arc.phi_2
    Ic = np.sin(phi_2) - np.sin(phi_1)
    Icc = (phi_2 - phi_1) / 2 + (np.sin(2 * phi_2) - np.sin(2 * phi_1)) / 4
    return PressureIntegrals(Ic, Icc, integrals_of_sine_pressure(arc).cos)


def integrals_of_cosine_pressure(arc: ShoeAnglesAndRadii) -> PressureIntegrals:
    """Integrals of f = cos(phi - middle), where each element presses along its own radius."""
    # The resultant of the pressure lies along the middle radius.
    along = arc.half_of_lining_arc + np.sin(2 * arc.half_of_lining_arc) / 2
    return PressureIntegrals(
        2 * np.sin(arc.half_of_lining_arc), along * np.cos(arc.middle), along * np.sin(arc.middle)
    )


def integrals_of_uniform_pressure(arc: ShoeAnglesAndRadii) -> PressureIntegrals:
    """Integrals of the uniform pressure f = 1, where each element presses along its own radius."""
    along = 2 * np.sin(arc.half_of_lining_arc)
    return PressureIntegrals(
        2 * arc.half_of_lining_arc, along * np.cos(arc.middle), along * np.sin(arc.middle)
    )


def integrals_of_short_shoe_pressure(arc: ShoeAnglesAndRadii) -> PressureIntegrals:
    """Integrals of f = 1, where all elements press along the middle radius (UWA notes, eq. v)."""
    along = 2 * arc.half_of_lining_arc
    return PressureIntegrals(along, along * np.cos(arc.middle), along * np.sin(arc.middle))


def integrals_of_lumped_cosine_pressure(arc: ShoeAnglesAndRadii) -> PressureIntegrals:
    """Integrals of f = cos(phi - middle), lumped in one force along the middle radius.

    The source is NPTEL lesson 12.1.
    """
    along = arc.half_of_lining_arc + np.sin(2 * arc.half_of_lining_arc) / 2
    return PressureIntegrals(along, along * np.cos(arc.middle), along * np.sin(arc.middle))


def ratio_of_equivalent_to_lining_friction(theta_0: NumberOrArray) -> Floats:
    """Ratio mu'/mu of a block's equivalent friction coefficient to its lining's coefficient.

    The equivalent coefficient is mu' = T/(R N), with the torque T and the resultant normal force N.
    For the pressure p_0 cos(theta - middle) on a lining of the half-arc theta_0 [rad] the ratio is
    4 sin theta_0 / (2 theta_0 + sin 2 theta_0) (NPTEL lesson 12.1).
    """
    return np.asarray(4 * np.sin(theta_0) / (2 * theta_0 + np.sin(2 * theta_0)))


def pivot_radius_for_cosine_pressure(R: NumberOrArray, theta_0: NumberOrArray) -> Floats:
    """Radius [m] at which a pivot makes the pressure p_0 cos(theta - middle).

    The pivot lies on the middle radius of a lining of the half-arc theta_0 [rad]. Its distance from
    the drum's centre is 4 R sin theta_0 / (2 theta_0 + sin 2 theta_0).
    """
    return np.asarray(R * ratio_of_equivalent_to_lining_friction(theta_0))


def _integrals_of_sine_pressure_on_arc_part(
    whole: ShoeAnglesAndRadii, part: ShoeAnglesAndRadii
) -> PressureIntegrals:
    """Integrals of the pressure f = sin phi of a shoe over a part of its arc."""
    return integrals_of_sine_pressure(part)


def _integrals_of_cosine_pressure_on_arc_part(
    whole: ShoeAnglesAndRadii, part: ShoeAnglesAndRadii
) -> PressureIntegrals:
    """Integrals over a part of the arc of f = cos(phi - middle of the whole arc)."""
    cos, sin = np.cos(whole.middle), np.sin(whole.middle)
    of_cos, of_sin = integrals_of_cos_phi_pressure(part), integrals_of_sine_pressure(part)
    return PressureIntegrals(*(cos * a + sin * b for a, b in zip(of_cos, of_sin, strict=True)))


def _integrals_of_uniform_pressure_on_arc_part(
    whole: ShoeAnglesAndRadii, part: ShoeAnglesAndRadii
) -> PressureIntegrals:
    """Integrals of the uniform pressure f = 1 of a shoe over a part of its arc."""
    return integrals_of_uniform_pressure(part)


def _friction_factor_of_one_for_each_arc(arc: ShoeAnglesAndRadii) -> Floats:
    """The factor 1 on mu, for laws that do not change mu, in the shape of the arc's angles."""
    return np.ones(np.shape(arc.half_of_lining_arc))


@dataclass(frozen=True)
class PressureLawOfHingedShoe:
    """A law p = p_0 f(phi) for the pressure of a shoe that turns about its hinge on a drum.

    Attributes
    ----------
    name : name of the law
    assumes : assumptions of the law, in words
    load : function that returns the integrals of f over an arc
    pressure : function that returns f at angles phi
    angle_of_largest_pressure : function that returns the angle phi [rad] of the largest f
    lumped : whether the law lets the whole contact force act at the lining's middle
    friction : function that returns the factor by which the law multiplies mu; 1 for most laws
    remark : note for the reader of the law's results
    pressure_integrals_on_arc_part : function that takes the whole arc and a part of it, and returns
        the integrals of f over the part; None for a law that cannot have several linings on a shoe
    """

    name: str
    assumes: str
    load: Callable[[ShoeAnglesAndRadii], PressureIntegrals]
    pressure: Callable[[Floats, ShoeAnglesAndRadii], Floats]
    angle_of_largest_pressure: Callable[[ShoeAnglesAndRadii], Floats]
    lumped: bool = False
    friction: Callable[[ShoeAnglesAndRadii], Floats] = _friction_factor_of_one_for_each_arc
    remark: str = ""
    pressure_integrals_on_arc_part: (
        Callable[[ShoeAnglesAndRadii, ShoeAnglesAndRadii], PressureIntegrals] | None
    ) = None

    def pressure_integrals_over_all_linings(self, arc: ShoeAnglesAndRadii) -> PressureIntegrals:
        """Integrals of f over the arc of a shoe, or over all linings of a shoe with slots."""
        if not arc.slots:
            return self.load(arc)
        # A law that lumps the force at the lining's middle has no `pressure_integrals_on_arc_part`.
        # Shoes with slots are refused before they get here.
        assert self.pressure_integrals_on_arc_part is not None
        first, *others = (self.pressure_integrals_on_arc_part(arc, part) for part in arc.linings)
        total, cos, sin = first
        for part in others:
            total, cos, sin = total + part.total, cos + part.cos, sin + part.sin
        return PressureIntegrals(total, cos, sin)

    def angle_of_peak_pressure(self, arc: ShoeAnglesAndRadii) -> float:
        """The angle phi [rad] of the largest pressure on a shoe with one or several linings.

        The pressure of every law has one peak. If this angle lies in a slot, the pressure is
        largest at an edge of the slot. `arc` must hold numbers, not arrays.
        """
        top = float(self.angle_of_largest_pressure(arc))
        if not arc.slots:
            return top
        places = np.array([np.clip(top, part.phi_1, part.phi_2) for part in arc.linings])
        return float(places[np.argmax(self.pressure(places, arc))])

    def scaled_normal_and_friction_moments_about_hinge(
        self, arc: ShoeAnglesAndRadii
    ) -> tuple[Floats, Floats]:
        """Moments M_N of pressure and M_F of friction about the hinge, divided by b R p_0 [m].

        Here b is the lining's width, R the drum's radius and p_0 the pressure's amplitude. M_N
        opposes the actuation. M_F is the moment at mu = 1; with dD = 1 it helps the actuation.
        """
        M_N, M_F = scaled_normal_and_friction_moments_about_point(
            self.pressure_integrals_over_all_linings(arc), arc.R, arc.a
        )
        return M_N, self.friction(arc) * M_F

    def actuation_moment_over_pressure_amplitude(
        self, mu: NumberOrArray, arc: ShoeAnglesAndRadii
    ) -> Floats:
        """Actuation moment divided by b R p_0: M_N - dD mu M_F [m].

        Here b is the lining's width, R the drum's radius and p_0 the pressure's amplitude. The
        actuation must balance this moment of pressure and friction about the hinge. It is zero or
        negative if the shoe locks itself.
        """
        M_N, M_F = self.scaled_normal_and_friction_moments_about_hinge(arc)
        return M_N - arc.dD * mu * M_F

    def pressure_amplitude(
        self,
        moment: NumberOrArray,
        width: NumberOrArray,
        mu: NumberOrArray,
        arc: ShoeAnglesAndRadii,
    ) -> Floats:
        """Amplitude p_0 [Pa] of the pressure; nan if the shoe locks itself.

        Parameters
        ----------
        moment : moment of the actuation about the hinge [N m]
        width : width of the lining [m]
        mu : friction coefficient
        arc : angles and radii of the shoe
        """
        resistance = self.actuation_moment_over_pressure_amplitude(mu, arc)
        return moment / (width * arc.R * np.where(resistance > 0, resistance, np.nan))

    def torque(self, moment: NumberOrArray, mu: NumberOrArray, arc: ShoeAnglesAndRadii) -> Floats:
        """Torque [N m] of a shoe under an actuation moment [N m]; nan if the shoe locks itself."""
        return moment * self.torque_over_actuation_moment(mu, arc)

    def torque_over_actuation_moment(self, mu: NumberOrArray, arc: ShoeAnglesAndRadii) -> Floats:
        """Ratio eta = T/M = 1/(m - dD n) of torque to actuation moment (UWA notes, eq. 8).

        For m and n see `short_shoe_pressure_and_friction_moments_over_torque`. The ratio is nan if
        the shoe locks itself.
        """
        resistance = self.actuation_moment_over_pressure_amplitude(mu, arc)
        effect = (
            mu * self.friction(arc) * arc.R * self.pressure_integrals_over_all_linings(arc).total
        )
        return effect / np.where(resistance > 0, resistance, np.nan)

    def sensitivity_of_braking_effect_to_friction(
        self, mu: NumberOrArray, arc: ShoeAnglesAndRadii
    ) -> Floats:
        """Sensitivity S = (mu/T) dT/dmu of the torque at fixed actuation (UWA notes, eq. 8).

        S is nan if the shoe locks itself.
        """
        M_N, _ = self.scaled_normal_and_friction_moments_about_hinge(arc)
        resistance = self.actuation_moment_over_pressure_amplitude(mu, arc)
        return M_N / np.where(resistance > 0, resistance, np.nan)

    def self_locking_friction(self, arc: ShoeAnglesAndRadii) -> Floats:
        """Friction coefficient mu_lock = M_N / (dD M_F) at which the torque becomes infinite.

        It is inf if friction does not help the actuation.
        """
        M_N, M_F = self.scaled_normal_and_friction_moments_about_hinge(arc)
        helps = arc.dD * M_F > 0
        # If the friction force passes almost through the hinge, the quotient overflows to inf,
        # which is the right limit.
        with np.errstate(over="ignore"):
            return np.where(helps, M_N / np.where(helps, arc.dD * M_F, 1.0), np.inf)


def short_shoe_pressure_and_friction_moments_over_torque(
    mu: NumberOrArray, theta_m: NumberOrArray, r: NumberOrArray, a: NumberOrArray
) -> tuple[Floats, Floats]:
    """Moments m of the pressure and n of the friction on a short shoe, divided by its torque.

    Both are moments about the hinge: m = (a/(mu r)) sin theta_m and n = 1 - (a/r) cos theta_m (UWA
    notes, eq. 6a).

    Parameters
    ----------
    mu : friction coefficient
    theta_m : angle of the shoe from the hinge [rad]
    r : radius at which the friction acts [m]
    a : distance of the hinge from the drum's centre [m]
    """
    m = a / (mu * r) * np.sin(theta_m)
    n = 1 - a / r * np.cos(theta_m)
    return np.asarray(m), np.asarray(n)


def _angle_of_lining_middle(arc: ShoeAnglesAndRadii) -> Floats:
    """Angle phi [rad] of the lining's middle, where some laws have their largest pressure."""
    return arc.middle


def _cosine_pressure_about_middle(phi: Floats, arc: ShoeAnglesAndRadii) -> Floats:
    """The pressure f = cos(phi - middle), same shape as phi."""
    return np.cos(phi - arc.middle)


def _uniform_pressure_of_amplitude_one(phi: Floats, arc: ShoeAnglesAndRadii) -> Floats:
    """The uniform pressure f = 1, same shape as phi."""
    return np.ones(np.broadcast_shapes(np.shape(phi), np.shape(arc.middle)))


SINE_PRESSURE_LAW = PressureLawOfHingedShoe(
    "sine",
    "rigid shoe turning about its hinge: p = p_a sin(phi)/sin(phi_a), phi from the hinge",
    integrals_of_sine_pressure,
    lambda phi, arc: np.sin(phi),
    lambda arc: np.clip(np.pi / 2, arc.phi_1, arc.phi_2),
    pressure_integrals_on_arc_part=_integrals_of_sine_pressure_on_arc_part,
)
"""The law of a rigid shoe that turns about its hinge."""
COSINE_PRESSURE_LAW = PressureLawOfHingedShoe(
    "cosine",
    "rigid shoe moving along its middle radius: p = p_0 cos(theta - middle), each element "
    "along its radius",
    integrals_of_cosine_pressure,
    _cosine_pressure_about_middle,
    _angle_of_lining_middle,
    remark="each part of the lining has its own friction force; the law 'block' has the friction "
    "as one force at the lining's middle",
    pressure_integrals_on_arc_part=_integrals_of_cosine_pressure_on_arc_part,
)
"""The law of a rigid shoe that moves along its middle radius."""
LUMPED_COSINE_PRESSURE_LAW = PressureLawOfHingedShoe(
    "block",
    "p = p_0 cos(theta - middle) lumped at the drum's surface: N, and friction mu' N, at the "
    "lining's middle",
    integrals_of_lumped_cosine_pressure,
    _cosine_pressure_about_middle,
    _angle_of_lining_middle,
    lumped=True,
    friction=lambda arc: ratio_of_equivalent_to_lining_friction(arc.half_of_lining_arc),
)
"""The cosine law with all forces at the lining's middle, as textbooks use it for blocks."""
UNIFORM_PRESSURE_LAW = PressureLawOfHingedShoe(
    "uniform",
    "the same pressure everywhere on the lining, each element along its radius",
    integrals_of_uniform_pressure,
    _uniform_pressure_of_amplitude_one,
    _angle_of_lining_middle,
    pressure_integrals_on_arc_part=_integrals_of_uniform_pressure_on_arc_part,
)
"""The law of a uniform pressure on the whole lining."""
SHORT_SHOE_LAW_ON_DRUM = PressureLawOfHingedShoe(
    "short",
    "short shoe: N = p_m A and friction mu N at the lining's middle",
    integrals_of_short_shoe_pressure,
    _uniform_pressure_of_amplitude_one,
    _angle_of_lining_middle,
    lumped=True,
)
"""The law of a short shoe, whose forces act at the middle of the lining."""
LAWS_OF_HINGED_SHOES_BY_NAME = {
    law.name: law
    for law in (
        SINE_PRESSURE_LAW,
        COSINE_PRESSURE_LAW,
        LUMPED_COSINE_PRESSURE_LAW,
        UNIFORM_PRESSURE_LAW,
        SHORT_SHOE_LAW_ON_DRUM,
    )
}
"""The laws p = p_0 f(phi) of hinged shoes on a drum, by their names."""
