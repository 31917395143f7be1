"""The Double-Shoe Brake block of Simscape Driveline, with the parameters and formulas of the block.

The brake has two shoes, which are mirror images about the brake's symmetry axis. Equal forces F
with the arm c about the pin press both shoes. The sine law gives the torques T_LS of the leading
shoe, from F c = M_N - M_F, and T_TS of the trailing shoe, from F c = M_N + M_F. Three relations of
the block cannot be stated in a brake file:

    mu = mu_Coulomb tanh(4 omega / omega_threshold)
    T = T_LS + T_TS + mu_visc omega
    T = 0 for F <= 0

The block's documentation page prints + mu_visc in place of + mu_visc omega. This is a misprint,
since mu_visc alone is not a torque. The page calls theta_s the span of the shoe, with the default
130 deg. Its formulas, however, use theta_s as the angle from the hinge at which the lining ends.
`DoubleShoe.reading` chooses between the two meanings; the meaning in the formulas is the default.
"""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from drumlin.base.arrays import Floats, NumberOrArray
from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.brake import Brake
from drumlin.brake.fields import Material
from drumlin.brake.file import make_drum_brake_from_data
from drumlin.brake.units import angle_as_text_in_degrees, length_as_text_in_mm
from drumlin.laws.shapes import SINE_PRESSURE_LAW, ShoeAnglesAndRadii

DEFAULT_SIMSCAPE_LINING_MATERIAL = Material(E=300e6, nu=0.25)
"""Material of the lining in `DoubleShoe.brake` if the user gives none.

The torque of the sine law does not depend on the material.
"""


@dataclass(frozen=True)
class DoubleShoe:
    """The Simscape Double-Shoe Brake block: its parameters with their defaults, in SI units.

    BadInput is raised for a parameter outside the range that the block's page documents.

    Attributes
    ----------
    r_D : radius of the drum [m]
    r_a : distance of the actuation force's line from the drum's centre [m]
    r_p : distance of the pin from the drum's centre [m]
    theta_p : angle of the pin from the symmetry axis [rad]
    theta_sb : angle from the pin to the lining's beginning [rad]
    theta_s : span of the shoe or its end angle, according to `reading` [rad]
    mu_Coulomb : friction coefficient at full speed
    mu_visc : viscous torque per angular speed [N m s/rad]
    omega_threshold : speed at which friction is almost full [rad/s]
    reading : meaning of theta_s, "end" or "span"
    """

    r_D: float = 0.150
    r_a: float = 0.100
    r_p: float = 0.125
    theta_p: float = math.radians(15)
    theta_sb: float = math.radians(5)
    theta_s: float = math.radians(130)
    mu_Coulomb: float = 0.3
    mu_visc: float = 0.01
    omega_threshold: float = 0.01
    reading: Literal["end", "span"] = "end"

    def __post_init__(self) -> None:
        """Raise BadInput for parameters that the block's documentation page does not allow."""
        # No lining may reach beyond the symmetry axis, which is at this angle from the pin.
        widest = math.pi - self.theta_p
        least = self.theta_sb if self.reading == "end" else 0.0
        # Each rule holds the parameter's name, the function that writes its value, whether the
        # value is allowed, and the text of the message.
        rules = (
            ("r_D", length_as_text_in_mm, self.r_D > 0, "must be greater than 0"),
            ("r_a", length_as_text_in_mm, self.r_a > 0, "must be greater than 0"),
            ("r_p", length_as_text_in_mm, self.r_p > 0, "must be greater than 0"),
            ("theta_p", angle_as_text_in_degrees, self.theta_p >= 0, "must be at least 0"),
            (
                "theta_sb",
                angle_as_text_in_degrees,
                0 <= self.theta_sb <= widest,
                f"must be from 0 to 180 deg - theta_p = {angle_as_text_in_degrees(widest)}",
            ),
            (
                "theta_s",
                angle_as_text_in_degrees,
                least < self.theta_s <= widest - self.theta_sb,
                f"must be above {angle_as_text_in_degrees(least)} and at most "
                f"180 deg - theta_p - theta_sb = "
                f"{angle_as_text_in_degrees(widest - self.theta_sb)}",
            ),
            ("mu_Coulomb", "{:g}".format, self.mu_Coulomb > 0, "must be greater than 0"),
            ("mu_visc", "{:g} N m s/rad".format, self.mu_visc >= 0, "must be at least 0"),
            (
                "omega_threshold",
                "{:g} rad/s".format,
                self.omega_threshold > 0,
                "must be greater than 0",
            ),
        )
        for key, shown, allowed, message in rules:
            value = getattr(self, key)
            if not (allowed and math.isfinite(value)):
                raise BadInput(f"{key} = {shown(value)}: {message}")
        if self.reading not in ("end", "span"):
            raise BadInput(f"reading = {self.reading!r}: must be 'end' or 'span'")

    @property
    def arc(self) -> tuple[float, float]:
        """Angles (phi_1, phi_2) [rad] of the lining's begin and end from the pin.

        The end depends on `reading`, the meaning of theta_s.
        """
        return self.theta_sb, self.theta_s + (self.theta_sb if self.reading == "span" else 0.0)

    @property
    def notes(self) -> tuple[str, ...]:
        """Warnings that the block's documentation page gives for these parameters."""
        phi_1, phi_2 = self.arc
        if phi_2 - phi_1 >= math.radians(45) - 1e-9:
            return ()
        said = f"contact angle {angle_as_text_in_degrees(phi_2 - phi_1)}"
        return (f"{said}: below 45 deg the long-shoe approximation is less accurate",)

    @property
    def arm(self) -> float:
        """Arm of the actuation force about the pin, c = r_a + r_p cos theta_p [m]."""
        return self.r_a + self.r_p * math.cos(self.theta_p)

    @property
    def mu_lock(self) -> float:
        """Friction coefficient at which the leading shoe locks itself."""
        return float(SINE_PRESSURE_LAW.self_locking_friction(self._angles_and_radii_of_shoe(1)))

    def _angles_and_radii_of_shoe(self, dD: int) -> ShoeAnglesAndRadii:
        """Angles and radii for the sine law of the leading (dD = 1) or trailing (dD = -1) shoe."""
        return ShoeAnglesAndRadii(*self.arc, R=self.r_D, a=self.r_p, dD=dD)

    def friction(self, omega: NumberOrArray) -> Floats:
        """Friction coefficient at speeds omega [rad/s], with the shape and the sign of omega."""
        return np.asarray(self.mu_Coulomb * np.tanh(4 * np.asarray(omega) / self.omega_threshold))

    def torques_of_leading_and_trailing_shoe(
        self, force: NumberOrArray, omega: NumberOrArray
    ) -> tuple[Floats, Floats]:
        """Torques T_LS and T_TS [N m] of the shoes that are leading and trailing at omega > 0.

        The arrays `force` [N] and `omega` [rad/s] broadcast. Raises NoAnswer if the leading shoe
        locks itself.
        """
        if self.mu_Coulomb >= self.mu_lock:
            raise NoAnswer(
                f"double shoe: self-locking, mu_Coulomb = {self.mu_Coulomb:g} "
                f"is not below mu_lock = {self.mu_lock:.6g}"
            )
        moment, mu = np.maximum(force, 0.0) * self.arm, self.friction(omega)
        return SINE_PRESSURE_LAW.torque(
            moment, mu, self._angles_and_radii_of_shoe(1)
        ), SINE_PRESSURE_LAW.torque(moment, mu, self._angles_and_radii_of_shoe(-1))

    def peak_line_loads_of_leading_and_trailing_shoe(
        self, force: NumberOrArray, omega: NumberOrArray
    ) -> tuple[Floats, Floats]:
        """Largest line loads [N/m] of the leading and the trailing shoe: pressure times width.

        The arrays `force` [N] and `omega` [rad/s] broadcast.
        """
        moment, mu = np.maximum(force, 0.0) * self.arm, self.friction(omega)
        leading, trailing = (
            SINE_PRESSURE_LAW.pressure_amplitude(moment, 1.0, mu, layout)
            * SINE_PRESSURE_LAW.pressure(
                SINE_PRESSURE_LAW.angle_of_largest_pressure(layout), layout
            )
            for layout in (self._angles_and_radii_of_shoe(1), self._angles_and_radii_of_shoe(-1))
        )
        return leading, trailing

    def torque(self, force: NumberOrArray, omega: NumberOrArray) -> Floats:
        """Braking torque T [N m] of the block; it acts against the rotation and has omega's sign.

        The arrays `force` [N] and `omega` [rad/s] broadcast. Where the force is not positive the
        shoes do not touch, so that the viscous torque is zero as well. Raises NoAnswer if the
        leading shoe locks itself.
        """
        leading, trailing = self.torques_of_leading_and_trailing_shoe(force, omega)
        total = leading + trailing + self.mu_visc * np.asarray(omega)
        return np.where(np.asarray(force) > 0, total, 0.0)

    def brake(
        self,
        force: float,
        rotation: str = "counter-clockwise",
        side: str = "internal",
        *,
        width: float = 0.04,
        thickness: float = 0.008,
        material: Material = DEFAULT_SIMSCAPE_LINING_MATERIAL,
    ) -> Brake:
        """A Brake with the block's shoes and the friction mu_Coulomb of full speed.

        The brake is symmetric about the y axis, and its pins are at the bottom. The block has no
        width, thickness and material of the lining; the torque of the sine law does not depend on
        these parameters.

        Parameters
        ----------
        force : actuation force on each shoe [N]
        rotation, side : values of the keys in a brake file
        width, thickness : width and thickness of the lining [m]
        material : material of the lining
        """
        phi_1, phi_2 = self.arc
        # The left shoe is the mirror image of the right shoe.
        layers = {"thickness": thickness, "width": width, "material": material}
        inwards = 180.0 if side == "external" else 0.0
        shoes = []
        for name, hand in (("right", 1), ("left", -1)):
            pin = -math.pi / 2 + hand * self.theta_p
            start, end = sorted((pin + hand * phi_1, pin + hand * phi_2))
            direction = math.radians(inwards + (0.0 if hand > 0 else 180.0))
            point = {"x": 0.0, "y": self.r_a}
            shoe = {
                "name": name,
                "side": side,
                "hinge": {"radius": self.r_p, "angle": pin},
                "lining": {"start": start, "end": end} | layers,
                "actuation": {"force": force, "direction": direction, "point": point},
            }
            shoes.append(shoe)
        data = {
            "title": f"{side} double-shoe brake",
            "rotation": rotation,
            "friction": self.mu_Coulomb,
            "drum": {"radius": self.r_D},
            "shoe": shoes,
        }
        return make_drum_brake_from_data(data)
