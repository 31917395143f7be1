"""Laws of rigid shoes on a plane: the short shoe, and the long shoe with p proportional to x.

A law states the pressure p = p_0 f(x). The place x is the distance along the plane from the hinge's
foot, which is the point of the plane below the hinge. The hinge is at the height h above the plane
(UWA notes, translational shoes, eq. iii and iv). The sign s' is +1 if the sliding body drags the
lining away from the hinge, and -1 if it drags the lining towards the hinge. With s' = 1 and h > 0
the friction opposes the actuation. On a lining of width w, pressure and friction have the moment M
about the hinge, which balances the moment of the actuation. The shoe locks itself at the friction
mu_lock:

    M = w p_0 (X + s' mu h F),    mu_lock = -X / (s' h F)

Here F is the integral of f over the lining, and X is the integral of f times x.
`FlatPressureIntegrals` holds F as `total` and X as `x`.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from drumlin.base.arrays import Floats, NumberOrArray
from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake, Shoe
from drumlin.brake.support import MOTION_TEXTS_BY_KIND_OF_SUPPORT
from drumlin.brake.surface import FRICTION_SURFACE_OF_PLANE
from drumlin.brake.units import length_as_text_in_mm
from drumlin.laws.rigid import NEGLECTED_BY_RIGID_LAWS, note_on_shoe_without_contact
from drumlin.response.balance import largest_imbalance_among_shoes, relative_imbalance_of_shoe
from drumlin.response.merit import response_with_figures_of_merit
from drumlin.response.response import Response, ShoeResponse, response_of_shoe_without_contact


class FlatPressureIntegrals(NamedTuple):
    """Integrals over a lining on a plane of f(x), the pressure divided by its amplitude p_0.

    Attributes
    ----------
    total : integral of f [m]
    x : integral of f times x [m^2]
    """

    total: Floats
    x: Floats


class FlatShoeLengths(NamedTuple):
    """Lengths and the sign s' of a shoe on a plane, which the formulas of a law need.

    The attributes are numbers or arrays that broadcast, so that one call serves many shoes.

    Attributes
    ----------
    x_min, x_max : distances of the lining's begin and end from the hinge's foot [m]
    h : height of the hinge above the plane [m]
    s : sign s', +1 if the sliding body drags the lining away from the hinge, -1 if it drags the
        lining towards the hinge
    """

    x_min: NumberOrArray
    x_max: NumberOrArray
    h: NumberOrArray
    s: NumberOrArray


def integrals_of_linear_pressure(pad: FlatShoeLengths) -> FlatPressureIntegrals:
    """Integrals over the lining of the linear pressure f = x/x_max (UWA notes, eq. iv)."""
    total = (pad.x_max**2 - pad.x_min**2) / (2 * pad.x_max)
    moment = (pad.x_max**3 - pad.x_min**3) / (3 * pad.x_max)
    return FlatPressureIntegrals(np.asarray(total), np.asarray(moment))


def integrals_of_short_flat_shoe_pressure(pad: FlatShoeLengths) -> FlatPressureIntegrals:
    """Integrals over the lining of the uniform pressure f = 1 (UWA notes, eq. iii).

    The force of a uniform pressure acts at the lining's middle.
    """
    total = np.asarray(pad.x_max - pad.x_min)
    return FlatPressureIntegrals(total, total * (pad.x_min + pad.x_max) / 2)


@dataclass(frozen=True)
class PressureLawOfFlatShoe:
    """A law p = p_0 f(x) for the pressure of a hinged shoe on a plane.

    Attributes
    ----------
    name : name of the law
    assumes : assumptions of the law, in words
    load : function that returns the integrals of f over a lining
    pressure : function that returns f at places x
    """

    name: str
    assumes: str
    load: Callable[[FlatShoeLengths], FlatPressureIntegrals]
    pressure: Callable[[Floats, FlatShoeLengths], Floats]

    def actuation_moment_over_pressure_amplitude(
        self, mu: NumberOrArray, pad: FlatShoeLengths
    ) -> Floats:
        """Actuation moment divided by w p_0: X + s' mu h F [m^2].

        The actuation must balance this moment of pressure and friction about the hinge, here for
        the amplitude p_0 = 1 and the width w = 1. It is zero or negative if the shoe locks itself.
        """
        load = self.load(pad)
        return load.x + pad.s * mu * pad.h * load.total

    def pressure_amplitude(
        self, moment: NumberOrArray, width: NumberOrArray, mu: NumberOrArray, pad: FlatShoeLengths
    ) -> Floats:
        """Amplitude p_0 [Pa] of the pressure; nan if the shoe locks itself.

        Parameters
        ----------
        moment : moment of the actuation about the hinge [N m]
        width : width of the lining [m]
        mu : friction coefficient
        pad : lengths of the shoe
        """
        resistance = self.actuation_moment_over_pressure_amplitude(mu, pad)
        return moment / (width * np.where(resistance > 0, resistance, np.nan))

    def braking_force(
        self, moment: NumberOrArray, mu: NumberOrArray, pad: FlatShoeLengths
    ) -> Floats:
        """Braking force mu N [N] under an actuation moment [N m]; nan if the shoe locks itself."""
        return mu * self.pressure_amplitude(moment, 1.0, mu, pad) * self.load(pad).total

    def sensitivity_of_braking_effect_to_friction(
        self, mu: NumberOrArray, pad: FlatShoeLengths
    ) -> Floats:
        """Sensitivity S = (mu/B) dB/dmu of the braking force B at fixed actuation.

        S is nan if the shoe locks itself.
        """
        resistance = self.actuation_moment_over_pressure_amplitude(mu, pad)
        return self.load(pad).x / np.where(resistance > 0, resistance, np.nan)

    def self_locking_friction(self, pad: FlatShoeLengths) -> Floats:
        """Friction coefficient mu_lock at and above which the shoe locks itself.

        It is inf if friction does not help the actuation.
        """
        load = self.load(pad)
        helps = -pad.s * pad.h * load.total
        # If the hinge is almost on the plane, the quotient overflows to inf, which is the right
        # limit.
        with np.errstate(over="ignore"):
            return np.where(helps > 0, load.x / np.where(helps > 0, helps, 1.0), np.inf)


LINEAR_PRESSURE_LAW = PressureLawOfFlatShoe(
    "linear",
    "rigid flat shoe turning about its hinge on a plane: p = p_max x/x_max, x from the hinge's "
    "foot",
    integrals_of_linear_pressure,
    lambda x, pad: np.asarray(x / pad.x_max),
)
"""The law of a long shoe on a plane, whose pressure grows in proportion to the place x."""
SHORT_SHOE_LAW_ON_PLANE = PressureLawOfFlatShoe(
    "short",
    "short flat shoe: N = p_m A and friction mu N at the lining's middle",
    integrals_of_short_flat_shoe_pressure,
    lambda x, pad: np.ones(np.shape(x)),
)
"""The law of a short shoe on a plane, whose forces act at the middle of the lining."""


def distances_of_lining_ends_from_hinge_foot(shoe: Shoe) -> tuple[float, float]:
    """Distances (x_min, x_max) [m] of the lining's two ends from the hinge's foot on the plane.

    The hinge's foot is the point of the plane below the hinge.
    """
    ends = shoe.frame.distances_along_surface_from_pin(
        np.array([shoe.lining.start, shoe.lining.end])
    )
    return float(ends.min()), float(ends.max())


def lengths_of_flat_shoe(brake: Brake, shoe: Shoe) -> FlatShoeLengths:
    """The lengths and the sign s' of a shoe on a plane, which the formulas of a law need."""
    return FlatShoeLengths(
        *distances_of_lining_ends_from_hinge_foot(shoe),
        h=shoe.pin.y,
        s=brake.sign_of_motion * shoe.frame.sense,
    )


def reason_against_flat_law(law: PressureLawOfFlatShoe, brake: Brake) -> str | None:
    """The reason why a law of shoes on a plane does not apply to a brake; None if it applies."""
    refusal = (
        brake.surface.reason_why_surface_is_not_required_one(FRICTION_SURFACE_OF_PLANE)
        or brake.reason_why_cam_or_strut_sets_forces
    )
    if refusal is not None:
        return refusal
    for shoe in brake.shoes:
        if shoe.kind_of_support != "hinge":
            return f"shoe {shoe.name!r}: {MOTION_TEXTS_BY_KIND_OF_SUPPORT[shoe.kind_of_support]}"
        # The pressure of the linear law is proportional to x: behind the hinge it would be tension.
        x_min, x_max = distances_of_lining_ends_from_hinge_foot(shoe)
        if law is LINEAR_PRESSURE_LAW and x_min < 0:
            return (
                f"shoe {shoe.name!r}: the lining must lie on one side of the hinge, "
                f"not reach {length_as_text_in_mm(-x_min)} beyond"
            )
        if x_min + x_max <= 0:
            return (
                f"shoe {shoe.name!r}: the normal force passes through the hinge, "
                "so that no moment can press it"
            )
    return None


def solve_brake_on_plane_by_law(law: PressureLawOfFlatShoe, brake: Brake) -> Response:
    """Solve a brake on a plane by a law of flat shoes. Raises NoAnswer for a self-locking shoe."""
    word = brake.surface.name
    shoes = tuple(_flat_shoe_response_by_law(law, brake, shoe) for shoe in brake.shoes)
    apart = [
        note_on_shoe_without_contact(shoe.name, word) for shoe in shoes if not shoe.contact_arcs
    ]
    balances = [relative_imbalance_of_shoe(brake, i, shoe) for i, shoe in enumerate(shoes)]
    response = Response(
        model=law.name,
        shoes=shoes,
        balance=largest_imbalance_among_shoes(balances),
        left_out=NEGLECTED_BY_RIGID_LAWS[word],
        notes=tuple(apart),
    )
    return response_with_figures_of_merit(brake, response)


def _flat_shoe_response_by_law(
    law: PressureLawOfFlatShoe, brake: Brake, shoe: Shoe
) -> ShoeResponse:
    """The response of one shoe on a plane by a law. Raises NoAnswer if the shoe locks itself."""
    pad, w = lengths_of_flat_shoe(brake, shoe), shoe.lining.width
    mu = brake.friction_coefficient_of_shoe_at_zero_pressure(shoe)
    moment = -shoe.frame.sense * shoe.moment_of_all_loads_about_point(shoe.pin)
    # Without a force, or under a force that lifts the lining off the plane, the shoe is not in
    # contact.
    if moment <= 0:
        return response_of_shoe_without_contact(shoe, -shoe.sum_of_forces_of_all_loads)
    if law.actuation_moment_over_pressure_amplitude(mu, pad) <= 0:
        raise NoAnswer(
            f"shoe {shoe.name!r}: self-locking, friction {mu:g} is not below "
            f"mu_lock = {float(law.self_locking_friction(pad)):.6g} of the {law.name} law"
        )
    amplitude = float(law.pressure_amplitude(moment, w, mu, pad))
    # The amplitude is the peak pressure, where f is 1: at the lining's end away from the hinge, or
    # everywhere on a short shoe.
    N = amplitude * w * float(law.load(pad).total)
    # The pressure is linear in x, so that one quadratic piece with three nodes represents it.
    x = np.linspace(shoe.lining.start, shoe.lining.end, 3)
    return ShoeResponse(
        name=shoe.name,
        torque=0.0,
        normal_force=N,
        self_energising=bool(mu * pad.s * pad.h < 0),
        peak_pressure=amplitude,
        hinge_reaction=-shoe.sum_of_forces_of_all_loads
        - N * np.array([mu * brake.sign_of_motion, 1.0]),
        contact_arcs=((shoe.lining.start, shoe.lining.end),),
        theta=x,
        pressure=amplitude * law.pressure(shoe.frame.distances_along_surface_from_pin(x), pad),
    )
