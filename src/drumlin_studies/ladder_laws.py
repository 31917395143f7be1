"""Cases of the benchmark ladder on rigid-shoe laws: textbook examples and closed forms."""

import math
from functools import cache, partial
from math import cos, radians, sin
from typing import Any, NamedTuple

import numpy as np

from drumlin.brake.brake import Brake
from drumlin.brake.file import vary
from drumlin.laws import self_locking_friction_of_hinged_shoe
from drumlin.laws.shapes import (
    LAWS_OF_HINGED_SHOES_BY_NAME,
    pivot_radius_for_cosine_pressure,
    ratio_of_equivalent_to_lining_friction,
    short_shoe_pressure_and_friction_moments_over_torque,
)
from drumlin.laws.simscape import DoubleShoe
from drumlin.models import MODELS
from drumlin.response.merit import (
    brake_scaled_to_peak_pressure,
    torque_sensitivity_to_friction_by_differences,
)
from drumlin.response.response import Response
from drumlin_studies import closed_forms
from drumlin_studies.ladder_case import (
    TOLERANCE_REASON_PRINTED_DIGITS,
    TOLERANCE_REASON_ROUND_OFF,
    KnownAnswerCase,
)
from drumlin_studies.textbook_brakes import (
    brake_with_block_on_lever,
    brake_with_one_hinged_pad,
    brake_with_one_hinged_shoe,
)


def _solve_brake_by_law_of_given_name(model: str, brake: object) -> Response:
    """The response of a brake by the rigid-shoe law with the name `model`."""
    return MODELS[model].solve(brake)


def _torque_of_shigley_example_16_2() -> float:
    """Torque [N m] of both shoes of Shigley's example 16-2.

    The force is such that the self-energising shoe has a peak pressure of 1 MPa.
    """
    shoe: dict[str, Any] = {
        "R": 0.15,
        "a": math.hypot(0.112, 0.05),
        "arc": (0.0, radians(126)),
        "mu": 0.32,
        "width": 0.032,
    }
    # The force is scaled until the self-energising shoe has a peak pressure of 1 MPa. The other
    # shoe gets the same force.
    helped = brake_scaled_to_peak_pressure(
        brake_with_one_hinged_shoe(**shoe, moment=100.0, spin=-1), MODELS["sine"].solve, 1e6
    )
    opposed = brake_with_one_hinged_shoe(**shoe, moment=helped.shoes[0].actuation.force, spin=1)
    return (
        _solve_brake_by_law_of_given_name("sine", helped).torque
        + _solve_brake_by_law_of_given_name("sine", opposed).torque
    )


@cache
def _response_of_shigley_problem_16_1() -> Response:
    """Response of the two internal shoes of Shigley's problem 16-1, under 2.2 kN each."""
    block = DoubleShoe(
        r_D=0.15,
        r_p=0.125,
        r_a=0.125 * cos(radians(30)),
        theta_p=radians(30),
        theta_sb=0.0,
        theta_s=radians(120),
        mu_Coulomb=0.28,
    )
    return _solve_brake_by_law_of_given_name("sine", block.brake(2200.0, "clockwise"))


@cache
def _response_of_bhandari_example_12_7() -> Response:
    """Response at a peak pressure of 0.5 MPa of Bhandari's example 12.7, a block on a pivot."""
    h = float(pivot_radius_for_cosine_pressure(0.25, radians(50)))
    lever = brake_with_one_hinged_shoe(
        R=0.25,
        a=0.45,
        arc=(radians(30), radians(130)),
        moment=100.0,
        mu=0.2,
        side="external",
        width=0.1,
        pivot=(h, radians(80)),
    )
    return _solve_brake_by_law_of_given_name(
        "pivoted", brake_scaled_to_peak_pressure(lever, MODELS["pivoted"].solve, 0.5e6)
    )


class ActuatingForceAndBrakeTorque(NamedTuple):
    """Actuating force [N] and torque [N m] of a brake."""

    force: float
    torque: float


@cache
def _force_and_torque_of_bhandari_12_8() -> ActuatingForceAndBrakeTorque:
    """Force and torque of the two internal shoes of Bhandari's example 12.8.

    The force is such that the self-energising shoe has a peak pressure of 1 MPa.
    """
    shoe: dict[str, Any] = {
        "R": 0.125,
        "a": math.hypot(0.0866, 0.05),
        "arc": (0.0, radians(120)),
        "mu": 0.32,
        "width": 0.04,
    }
    helped = brake_scaled_to_peak_pressure(
        brake_with_one_hinged_shoe(**shoe, moment=100.0, spin=-1), MODELS["sine"].solve, 1e6
    )
    # In `brake_with_one_hinged_shoe` the force has a lever arm of 1 m about the hinge. The moment
    # [N m] and the force [N] have the same value.
    moment = helped.shoes[0].actuation.force
    opposed = brake_with_one_hinged_shoe(**shoe, moment=moment, spin=1)
    arm = 0.1875
    torque = (
        _solve_brake_by_law_of_given_name("sine", helped).torque
        + _solve_brake_by_law_of_given_name("sine", opposed).torque
    )
    return ActuatingForceAndBrakeTorque(moment / arm, torque)


def _brake_with_90_degree_block_on_lever(
    a: float = 0.05, spin: int = 1, mu: float = 0.35, x: float = 0.2
) -> Brake:
    """A brake with a block on a lever; the block covers 90 degrees of the drum.

    `brake_with_block_on_lever` explains the lengths a and x [m].
    """
    return brake_with_block_on_lever(
        R=0.125, arm=0.45, x=x, a=a, P=700.0, mu=mu, half=radians(45), spin=spin
    )


def _torque_of_block_by_statics() -> float:
    """Torque [N m] of `_brake_with_90_degree_block_on_lever` by hand, from equilibrium.

    Under the pressure p_0 cos phi the resultant of the friction acts at the distance psi R from the
    centre of a drum of radius R.
    """
    psi = closed_forms.equivalent_over_actual_friction_of_block(radians(45))
    # Moments about the pin of the lever give the normal force.
    normal = 700.0 * 0.45 / (0.2 - 0.35 * (0.125 + 0.05 - psi * 0.125))
    return 0.35 * psi * 0.125 * normal


def _locking_friction_of_block() -> float:
    """Coefficient of friction at which a block on a lever with a high pin locks itself."""
    brake = brake_with_block_on_lever(
        R=0.125, arm=0.45, x=0.03, a=0.15, P=700.0, mu=0.1, half=radians(20), spin=1
    )
    return float(
        self_locking_friction_of_hinged_shoe(
            brake, brake.shoes[0], LAWS_OF_HINGED_SHOES_BY_NAME["block"]
        )
    )


def _two_block_torque_over_one_block() -> float:
    """Torque of a brake with two opposite blocks, divided by the torque of one block alone."""
    one = brake_with_block_on_lever(
        R=0.125, arm=0.45, x=0.2, a=0.0, P=700.0, mu=0.35, half=radians(45), spin=1
    )
    # The second block is the mirror image of the first about the x axis; its force acts upwards.
    data = one.shoes[0].model_dump()
    data["name"] = "below"
    data["hinge"] = {"x": one.shoes[0].pin.x, "y": -one.shoes[0].pin.y}
    data["lining"] |= {"start": -one.shoes[0].lining.end, "end": -one.shoes[0].lining.start}
    data["actuation"] |= {"direction": math.pi / 2, "point": {"x": 0.25, "y": -0.125}}
    both = vary(one, {"shoe": [one.shoes[0].model_dump(), data]})
    return (
        _solve_brake_by_law_of_given_name("block", both).torque
        / _solve_brake_by_law_of_given_name("block", one).torque
    )


def _response_of_short_shoe_on_lever() -> Response:
    """Response, by the short-shoe law, of a brake with a short shoe on a lever of 1 m."""
    return _solve_brake_by_law_of_given_name(
        "short",
        brake_with_block_on_lever(
            R=0.25, arm=1.0, x=0.5, a=0.2, P=100.0, mu=0.35, half=radians(10), spin=1
        ),
    )


def _torque_of_two_short_shoes() -> float:
    """Torque [N m] of two short shoes opposite each other, each at 90 degrees from its pin.

    The distance of the pins from the drum's centre is a = R. The actuating moments M are 60 N m and
    40 N m. The normal forces are then M/(R (1 - mu)) = 400 N and M/(R (1 + mu)) = 160 N.
    """
    shoe: dict[str, Any] = {
        "R": 0.2,
        "a": 0.2,
        "arc": (radians(88), radians(92)),
        "mu": 0.25,
        "side": "external",
    }
    first = brake_with_one_hinged_shoe(**shoe, moment=60.0, hand=1, turned=-math.pi / 2)
    second = brake_with_one_hinged_shoe(**shoe, moment=40.0, hand=-1, turned=-math.pi / 2)
    return (
        _solve_brake_by_law_of_given_name("short", first).torque
        + _solve_brake_by_law_of_given_name("short", second).torque
    )


ACTUATION_MOMENT_OF_FLAT_SHOES = 90.0  # N m
"""Moment [N m] of the actuation about the pin of the flat shoes."""
PIN_HEIGHT_OF_FLAT_SHOES_ABOVE_PLANE = 0.06  # m
"""Height [m] of the pin of the flat shoes above the plane."""
PAD_START, PAD_END = 0.05, 0.2  # m from the pin
"""Places x [m] along the plane at which the lining of the long flat shoe starts and ends."""
FRICTION_COEFFICIENT_OF_FLAT_SHOES = 0.4
"""Coefficient of friction of the flat shoes."""


def _peak_pressure_of_long_pad_by_law() -> float:
    """Peak pressure [Pa] of the long flat shoe by drumlin's linear law."""
    span = (PAD_START, PAD_END)
    brake = brake_with_one_hinged_pad(
        h=PIN_HEIGHT_OF_FLAT_SHOES_ABOVE_PLANE,
        span=span,
        moment=ACTUATION_MOMENT_OF_FLAT_SHOES,
        mu=FRICTION_COEFFICIENT_OF_FLAT_SHOES,
        width=0.03,
    )
    return _solve_brake_by_law_of_given_name("linear", brake).shoes[0].peak_pressure


def _peak_pressure_of_long_pad_by_statics() -> float:
    """Peak pressure [Pa] of the long flat shoe from equilibrium.

    The pressure grows linearly with the distance from the pin. The moments of pressure and friction
    about the pin balance the moment of the actuation.
    """
    normal = (PAD_END**3 - PAD_START**3) / 3
    friction = (
        FRICTION_COEFFICIENT_OF_FLAT_SHOES
        * PIN_HEIGHT_OF_FLAT_SHOES_ABOVE_PLANE
        * (PAD_END**2 - PAD_START**2)
        / 2
    )
    return ACTUATION_MOMENT_OF_FLAT_SHOES * PAD_END / 0.03 / (normal + friction)


def _normal_force_of_short_pad() -> float:
    """Normal force [N] of a short flat shoe by drumlin's short-shoe law."""
    brake = brake_with_one_hinged_pad(
        h=PIN_HEIGHT_OF_FLAT_SHOES_ABOVE_PLANE,
        span=(0.1, 0.16),
        moment=ACTUATION_MOMENT_OF_FLAT_SHOES,
        mu=FRICTION_COEFFICIENT_OF_FLAT_SHOES,
    )
    return _solve_brake_by_law_of_given_name("short", brake).shoes[0].normal_force


DIMENSIONS_OF_NPTEL_LONG_SHOE: dict[str, Any] = {
    "R": 0.2,
    "a": 0.23,
    "arc": (radians(20), radians(130)),
    "mu": 0.3,
    "side": "external",
    "width": 0.05,
}
"""Dimensions of the external long shoe of the NPTEL lesson; lengths in m, angles in rad."""


def _actuating_moment_of_nptel_shoe() -> float:
    """Actuating moment [N m] of the NPTEL long shoe for a peak pressure of 0.8 MPa.

    It is the moment M_p of the pressure minus the moment M_f of friction about the hinge.
    """
    # Peak pressure, width, radius of the drum, distance of the hinge, friction, ends of the lining.
    p, b, R, d, mu, t_1, t_2 = 0.8e6, 0.05, 0.2, 0.23, 0.3, radians(20), radians(130)
    M_p = 0.5 * p * b * R * d * ((t_2 - t_1) + 0.5 * (sin(2 * t_1) - sin(2 * t_2)))
    M_f = mu * p * b * R * (R * (cos(t_1) - cos(t_2)) - d / 4 * (cos(2 * t_1) - cos(2 * t_2)))
    return M_p - M_f


def _torque_of_nptel_long_shoe() -> float:
    """Torque [N m] of the NPTEL long shoe at a peak pressure of 0.8 MPa, by the sine law."""
    moment = _actuating_moment_of_nptel_shoe()
    brake = brake_with_one_hinged_shoe(**DIMENSIONS_OF_NPTEL_LONG_SHOE, moment=moment, spin=1)
    return _solve_brake_by_law_of_given_name("sine", brake).torque


SHORT_EXTERNAL_SHOE_DIMENSIONS: dict[str, Any] = {
    "R": 0.2,
    "a": 0.25,
    "arc": (radians(75) - 0.05, radians(75) + 0.05),
    "mu": 0.3,
    "side": "external",
}
"""Dimensions of a short external shoe; lengths in m, angles in rad."""


def _friction_sensitivity_by_differences() -> float:
    """Sensitivity S = (mu/T) dT/dmu of a short shoe's torque to friction, from two solves."""
    return torque_sensitivity_to_friction_by_differences(
        brake_with_one_hinged_shoe(**SHORT_EXTERNAL_SHOE_DIMENSIONS, moment=50.0),
        MODELS["short"].solve,
    )


def _friction_sensitivity_by_formula() -> float:
    """Sensitivity S = (mu/T) dT/dmu of a short shoe's torque to friction, by S = m/(m - n).

    m is the moment of the normal force about the hinge, and n is the moment of the friction about
    the hinge. Both moments are divided by the torque.
    """
    m, n = 0.25 * sin(radians(75)) / (0.3 * 0.2), 1 - 0.25 * cos(radians(75)) / 0.2
    assert np.allclose(
        short_shoe_pressure_and_friction_moments_over_torque(0.3, radians(75), 0.2, 0.25), (m, n)
    )
    return m / (m - n)


def _result_of_simscape_double_shoe(what: str) -> float:
    """A result of Simscape's double-shoe brake block with its default parameters.

    With `what` = "T/F" the result is the torque divided by the force [m]. With `what` = "mu_lock"
    the result is the coefficient of friction at which the brake locks itself.
    """
    block = DoubleShoe()
    return (
        float(sum(block.torques_of_leading_and_trailing_shoe(1.0, 1.0)))
        if what == "T/F"
        else block.mu_lock
    )


SHIGLEY, BHANDARI = "Shigley, Mechanical Engineering Design", "Bhandari, Design of Machine Elements"
"""Citations of two textbooks with worked examples, for the ladder's table."""
LESSON, UWA = (
    "NPTEL, Machine Design II, lesson 12.1",
    "University of Western Australia, notes on brakes",
)
"""Citations of lecture notes with worked examples, for the ladder's table."""
KNOWN_ANSWER_CASES_ON_RIGID_SHOE_LAWS = (
    KnownAnswerCase(
        family="internal shoes rated by pressure",
        shows="sine law",
        source=f"{SHIGLEY}, ex. 16-2, its formulas",
        quantity="torque [N m]",
        expected=527.761,
        tolerance=1e-6,
        tier=TOLERANCE_REASON_PRINTED_DIGITS,
        found=_torque_of_shigley_example_16_2,
    ),
    KnownAnswerCase(
        family="internal shoes under a force",
        shows="sine law",
        source=f"{SHIGLEY}, problem 16-1",
        quantity="peak pressure [kPa]",
        expected=734.0,
        tolerance=7e-4,
        tier=TOLERANCE_REASON_PRINTED_DIGITS,
        found=lambda: _response_of_shigley_problem_16_1().shoes[0].peak_pressure * 1e-3,
    ),
    KnownAnswerCase(
        family="internal shoes under a force",
        shows="sine law",
        source=f"{SHIGLEY}, problem 16-1, its formulas",
        quantity="torque [N m]",
        expected=422.004,
        tolerance=1.2e-6,
        tier=TOLERANCE_REASON_PRINTED_DIGITS,
        found=lambda: _response_of_shigley_problem_16_1().torque,
    ),
    KnownAnswerCase(
        family="pivoted block",
        shows="law of a shoe on a pivot",
        source=f"{BHANDARI}, ex. 12.7",
        quantity="torque [N mm]",
        expected=957555.554,
        tolerance=1e-9,
        tier=TOLERANCE_REASON_PRINTED_DIGITS,
        found=lambda: _response_of_bhandari_example_12_7().torque * 1e3,
    ),
    KnownAnswerCase(
        family="internal shoes of a car",
        shows="sine law",
        source=f"{BHANDARI}, ex. 12.8",
        quantity="force [N]",
        expected=2089.795894,
        tolerance=1e-9,
        tier=TOLERANCE_REASON_PRINTED_DIGITS,
        found=lambda: _force_and_torque_of_bhandari_12_8().force,
    ),
    KnownAnswerCase(
        family="internal shoes of a car",
        shows="sine law",
        source=f"{BHANDARI}, ex. 12.8",
        quantity="torque [N mm]",
        expected=434831.0515,
        tolerance=1e-9,
        tier=TOLERANCE_REASON_PRINTED_DIGITS,
        found=lambda: _force_and_torque_of_bhandari_12_8().torque * 1e3,
    ),
    KnownAnswerCase(
        family="block on a lever",
        shows="block law",
        source="problem collection; printed with mu' rounded to .385",
        quantity="torque [N m]",
        expected=83.87,
        tolerance=5e-4,
        tier=TOLERANCE_REASON_PRINTED_DIGITS,
        found=lambda: (
            _solve_brake_by_law_of_given_name(
                "block", _brake_with_90_degree_block_on_lever()
            ).torque
        ),
    ),
    KnownAnswerCase(
        family="block on a lever, exact statics",
        shows="cosine law",
        source="statics of p_0 cos, mu N at psi R",
        quantity="torque [N m]",
        expected=_torque_of_block_by_statics(),
        tolerance=1e-11,
        tier=TOLERANCE_REASON_ROUND_OFF,
        found=lambda: (
            _solve_brake_by_law_of_given_name(
                "cosine", _brake_with_90_degree_block_on_lever()
            ).torque
        ),
    ),
    *(
        KnownAnswerCase(
            family="equivalent friction of a block",
            shows="block law",
            source=LESSON,
            quantity=f"mu'/mu, half-arc {angle} deg",
            expected=closed_forms.equivalent_over_actual_friction_of_block(radians(angle)),
            tolerance=1e-13,
            tier=TOLERANCE_REASON_ROUND_OFF,
            found=partial(
                lambda half: float(ratio_of_equivalent_to_lining_friction(half)), radians(angle)
            ),
        )
        for angle in (30, 90)
    ),
    KnownAnswerCase(
        family="back stop",
        shows="self-locking of a block",
        source=f"{LESSON}: mu' = x/a",
        quantity="mu_lock",
        expected=0.03 / 0.15 / closed_forms.equivalent_over_actual_friction_of_block(radians(20)),
        tolerance=1e-9,
        tier=TOLERANCE_REASON_ROUND_OFF,
        found=_locking_friction_of_block,
    ),
    KnownAnswerCase(
        family="double block",
        shows="several shoes",
        source=LESSON,
        quantity="torque over that of one block",
        expected=2.0,
        tolerance=1e-12,
        tier=TOLERANCE_REASON_ROUND_OFF,
        found=_two_block_torque_over_one_block,
    ),
    KnownAnswerCase(
        family="short shoe on a lever",
        shows="short-shoe law",
        source="GATE examination",
        quantity="normal force [N]",
        expected=232.558,
        tolerance=2e-6,
        tier=TOLERANCE_REASON_PRINTED_DIGITS,
        found=lambda: _response_of_short_shoe_on_lever().shoes[0].normal_force,
    ),
    KnownAnswerCase(
        family="short shoe on a lever",
        shows="short-shoe law",
        source="GATE examination",
        quantity="torque [N m]",
        expected=20.35,
        tolerance=2.5e-4,
        tier=TOLERANCE_REASON_PRINTED_DIGITS,
        found=lambda: _response_of_short_shoe_on_lever().torque,
    ),
    KnownAnswerCase(
        family="two short shoes",
        shows="short-shoe law",
        source="statics by hand: .25 x .2 x (400 + 160)",
        quantity="torque [N m]",
        expected=28.0,
        tolerance=1e-9,
        tier=TOLERANCE_REASON_ROUND_OFF,
        found=_torque_of_two_short_shoes,
    ),
    KnownAnswerCase(
        family="long shoe on a plane",
        shows="linear law",
        source=f"{UWA}, eq. iv",
        quantity="peak pressure [Pa]",
        expected=_peak_pressure_of_long_pad_by_statics(),
        tolerance=1e-12,
        tier=TOLERANCE_REASON_ROUND_OFF,
        found=_peak_pressure_of_long_pad_by_law,
    ),
    KnownAnswerCase(
        family="short shoe on a plane",
        shows="short-shoe law",
        source=f"{UWA}, eq. iii",
        quantity="normal force [N]",
        expected=ACTUATION_MOMENT_OF_FLAT_SHOES
        / (0.13 + FRICTION_COEFFICIENT_OF_FLAT_SHOES * PIN_HEIGHT_OF_FLAT_SHOES_ABOVE_PLANE),
        tolerance=1e-12,
        tier=TOLERANCE_REASON_ROUND_OFF,
        found=_normal_force_of_short_pad,
    ),
    KnownAnswerCase(
        family="external long shoe",
        shows="sine law",
        source=LESSON,
        quantity="torque [N m]",
        expected=0.3 * 0.8e6 * 0.05 * 0.2**2 * (cos(radians(20)) - cos(radians(130))),
        tolerance=1e-12,
        tier=TOLERANCE_REASON_ROUND_OFF,
        found=_torque_of_nptel_long_shoe,
    ),
    KnownAnswerCase(
        family="sensitivity to friction",
        shows="S by differences",
        source=f"{UWA}, S = m/(m - n)",
        quantity="S",
        expected=_friction_sensitivity_by_formula(),
        tolerance=1e-6,
        tier=TOLERANCE_REASON_ROUND_OFF,
        found=_friction_sensitivity_by_differences,
    ),
    KnownAnswerCase(
        family="double-shoe block of Simscape",
        shows="sine law",
        source="Simscape Driveline, its formulas at its defaults",
        quantity="T/F [m]",
        expected=0.2176081,
        tolerance=5e-7,
        tier=TOLERANCE_REASON_PRINTED_DIGITS,
        found=partial(_result_of_simscape_double_shoe, "T/F"),
    ),
    KnownAnswerCase(
        family="double-shoe block of Simscape",
        shows="self-locking",
        source="Simscape Driveline, its formulas at its defaults",
        quantity="mu_lock",
        expected=0.823082,
        tolerance=1e-6,
        tier=TOLERANCE_REASON_PRINTED_DIGITS,
        found=partial(_result_of_simscape_double_shoe, "mu_lock"),
    ),
)
"""The cases of the ladder on rigid-shoe laws."""
