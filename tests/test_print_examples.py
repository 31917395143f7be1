"""Worked examples from print and by hand: duo-servo, parking lever, clutch, chamber and S-cam.

The brake factors are those of the user's manual of HVE (version 5, 7th edition, January 2006),
chapter 29: equation 29-3 for a shoe on a pin, 29-4 for a shoe on an abutment, 29-16 and 29-17 for a
duo-servo brake, 29-10 for the chamber, and Limpert's equation 2-22 for the S-cam.
"""

import math
from typing import Any

import pytest

import drumlin
from drumlin.brake import read_drum_or_plane_brake
from drumlin.brake.brake import Brake
from drumlin.brake.file import vary
from drumlin.laws.rigid import solve_brake_by_rigid_shoe_law
from drumlin.laws.shapes import ratio_of_equivalent_to_lining_friction
from drumlin.response.response import Response
from drumlin.studies import paths_of_example_brakes

INCH, POUND = 0.0254, 4.4482216152605
SOFT = 1e-10
"""Contact stiffness of elements on which all shoes are rigid, relative to that of the lining.

The bodies change the answer by about this fraction, far below the 1e-9 that is tested.
"""
CYLINDER, FOOT, PIN = 0.095, 0.112, 0.118
"""Distances [m] of cylinder, adjuster and anchor pin from the drum's centre, in servo brakes."""


def example(name: str, **changes: Any) -> Brake:
    """An example of `drumlin init`, with other values of some keys."""
    return vary(read_drum_or_plane_brake(paths_of_example_brakes()[name]), changes)


def rigid_limit(brake: Brake) -> Response:
    """The finite elements of a brake on a contact far softer than its shoes."""
    return drumlin.solve(brake, penalty=SOFT, model_error=False)


def factor_of_shoe_on_abutment(mu: float, c: float, a: float, r: float, arc: float) -> float:
    """Torque over F r of a leading shoe on a smooth level abutment, equation 29-4 with beta = 0.

    The force F acts at the distance c [m] from the centre, the abutment at a [m] on the other side.
    """
    F_B = (arc + math.sin(arc)) / (4 * math.sin(arc / 2)) * a / r
    return mu * (c + a) / r / (F_B - mu + mu**2 * F_B)


def factor_of_shoe_on_pin(
    mu: float, h: float, r: float, pin: tuple[float, float], first: float, arc: float, sign: int
) -> float:
    """Torque over F r of a shoe on a pin, equation 29-3.

    `h` [m] is the arm of F about the pin, `pin` its place (x, y) [m]; the lining begins at the
    angle `first` [rad] from the side opposite to the pin. `sign` is -1 for a leading shoe.
    """
    a, a3 = math.hypot(*pin), 2 * first + arc
    pressure = (arc - math.sin(arc) * math.cos(a3)) / (4 * math.sin(arc / 2) * math.sin(a3 / 2))
    friction = 1 + a / r * math.cos(arc / 2) * math.cos(a3 / 2)
    return mu * h / r / (a / r * pressure + sign * mu * friction)


def duo_servo_by_hand(brake: Brake, arcs: tuple[float, float]) -> tuple[float, float, float]:
    """Torque, force of the adjuster and force of the anchor; `arcs` [rad] are in the drum's sense.

    The second shoe is a leading shoe on the anchor under two forces: that of the adjuster, and that
    of the cylinder, which is on the side of the anchor, c < 0.
    """
    F, R, mu = brake.shoes[0].actuation.force, brake.size, brake.friction
    T_1 = F * R * factor_of_shoe_on_abutment(mu, CYLINDER, FOOT, R, arcs[0])
    S = (F * CYLINDER + T_1) / FOOT
    T_2 = R * S * factor_of_shoe_on_abutment(mu, FOOT, PIN, R, arcs[1])
    T_2 += R * F * factor_of_shoe_on_abutment(mu, -CYLINDER, PIN, R, arcs[1])
    return T_1 + T_2, S, (T_1 + T_2) / PIN


def check_duo_servo(response: Response, by_hand: tuple[float, float, float], bears: str) -> None:
    """The torque and the forces of the supports of a duo-servo brake are those by hand."""
    torque, strut, anchor = by_hand
    forces = {force.name: force.push.force for shoe in response.shoes for force in shoe.supports}
    assert response.torque == pytest.approx(torque, rel=1e-9)
    assert forces["the strut from 'primary' to 'secondary'"] == pytest.approx(strut, rel=1e-9)
    assert forces.pop(f"anchor of {bears!r}") == pytest.approx(anchor, rel=1e-9)
    assert [force for name, force in forces.items() if name.startswith("anchor")] == [0.0]


def duo_servo_in_each_sense() -> list[tuple[Brake, tuple[float, float], str]]:
    """The brake, the arcs of the first and of the second shoe, and the shoe on the anchor."""
    brake = example("duo_servo_by_hand")
    primary, secondary = (shoe.lining.end - shoe.lining.start for shoe in brake.shoes)
    return [
        (brake, (primary, secondary), "secondary"),
        (brake.brake_with_reversed_motion(), (secondary, primary), "primary"),
    ]


@pytest.mark.parametrize("sense", (0, 1))
def test_duo_servo_by_the_law_is_its_closed_form(sense: int) -> None:
    """Forwards 217.67 N m, in reverse 217.77 N m."""
    brake, arcs, bears = duo_servo_in_each_sense()[sense]
    by_hand = duo_servo_by_hand(brake, arcs)
    assert by_hand[0] == pytest.approx((217.67, 217.77)[sense], abs=5e-3)
    check_duo_servo(solve_brake_by_rigid_shoe_law(brake), by_hand, bears)


@pytest.mark.slow
@pytest.mark.parametrize("sense", (0, 1))
def test_duo_servo_by_elements_is_its_closed_form(sense: int) -> None:
    brake, arcs, bears = duo_servo_in_each_sense()[sense]
    check_duo_servo(rigid_limit(brake), duo_servo_by_hand(brake, arcs), bears)


def uni_servo_with_full_contact() -> tuple[Brake, float]:
    """The uni-servo brake with little friction and a shorter primary, and its torque in print."""
    arc = {"shoe.primary.lining.start": "-40 deg", "shoe.primary.lining.end": "40 deg"}
    brake = example("uni_servo", friction=0.2, **arc)
    F, R, mu = brake.shoes[0].actuation.force, brake.size, brake.friction
    pin, lining = brake.shoes[1].hinge, brake.shoes[1].lining
    B_1 = factor_of_shoe_on_abutment(mu, CYLINDER, FOOT, R, math.radians(80))
    first = math.atan2(pin.y, pin.x) + math.pi - lining.end
    arc_2 = lining.end - lining.start
    B_2 = factor_of_shoe_on_pin(mu, FOOT + PIN, R, (pin.x, pin.y), first, arc_2, -1)
    return brake, F * R * (B_1 + (CYLINDER + B_1 * R) / FOOT * B_2)


def test_uni_servo_by_the_law_is_the_formula_in_print() -> None:
    """The manual calls it duo-servo: one piston, a primary on an abutment, a pinned secondary."""
    brake, torque = uni_servo_with_full_contact()
    assert solve_brake_by_rigid_shoe_law(brake).torque == pytest.approx(torque, rel=1e-12)


@pytest.mark.slow
def test_uni_servo_by_elements_is_the_formula_in_print() -> None:
    brake, torque = uni_servo_with_full_contact()
    assert rigid_limit(brake).torque == pytest.approx(torque, rel=1e-9)


def s_cam_under_chamber() -> tuple[Brake, float]:
    """The brake of the example `air_chamber` without its spring, and its torque in print."""
    brake = example("air_chamber", spring=[])
    P = 3000 * POUND - 200.0
    F = 0.75 * P * 6 * INCH / (2 * 0.5 * INCH)
    R, mu, pin = brake.size, brake.friction, brake.shoes[0].hinge
    lining = brake.shoes[0].lining
    first = math.atan2(pin.y, pin.x) + math.pi - lining.end
    leading, trailing = (
        factor_of_shoe_on_pin(mu, 0.31, R, (pin.x, pin.y), first, lining.end - lining.start, sign)
        for sign in (-1, 1)
    )
    return brake, F * R * 4 * leading * trailing / (leading + trailing)


def test_s_cam_under_its_chamber_by_the_law_is_the_formula_in_print() -> None:
    """A chamber of type 30 at 100 psi has 3000 lbf in print, less 200 N of its spring."""
    brake, torque = s_cam_under_chamber()
    assert solve_brake_by_rigid_shoe_law(brake).torque == pytest.approx(torque, rel=1e-12)


@pytest.mark.slow
def test_s_cam_under_its_chamber_by_elements_is_the_formula_in_print() -> None:
    brake, torque = s_cam_under_chamber()
    assert rigid_limit(brake).torque == pytest.approx(torque, rel=1e-9)


def parking_brake_by_hand() -> tuple[Brake, float]:
    """The parking brake and its torque from the statics of lever, spring and pinned shoes."""
    brake = example("parking_lever")
    R, mu, pin = brake.size, brake.friction, brake.shoes[0].hinge
    lining = brake.shoes[0].lining
    first = math.atan2(pin.y, pin.x) + math.pi - lining.end
    strut = 250.0 * 145 / 25
    # The drum turns counter-clockwise: the right shoe trails, the left shoe leads.
    moments = {1: strut * 0.16 - 120 * 0.175, -1: (strut - 250.0) * 0.185 - 120 * 0.175}
    arc, at = lining.end - lining.start, (pin.x, pin.y)
    torque = 0.0
    for sign, moment in moments.items():
        torque += moment * R * factor_of_shoe_on_pin(mu, 1.0, R, at, first, arc, sign)
    return brake, torque


def test_parking_brake_by_the_law_is_its_closed_form() -> None:
    brake, torque = parking_brake_by_hand()
    assert torque == pytest.approx(301.45, abs=5e-3)
    assert solve_brake_by_rigid_shoe_law(brake).torque == pytest.approx(torque, rel=1e-12)


@pytest.mark.slow
def test_parking_brake_by_elements_is_its_closed_form() -> None:
    brake, torque = parking_brake_by_hand()
    assert rigid_limit(brake).torque == pytest.approx(torque, rel=1e-9)


def clutch_by_hand() -> tuple[Brake, float]:
    """The clutch with springs of constant pull, and its torque by hand."""
    brake = example("centrifugal_clutch")
    speed, R = 400 * math.pi / 30, brake.size
    force = 6 * speed**2 * 0.160 - 1450
    return brake, 4 * brake.friction * force * R * float(
        ratio_of_equivalent_to_lining_friction(math.radians(3))
    )


def test_clutch_by_the_law_has_the_numbers_in_print() -> None:
    """The print has 82.1 N on each shoe and 82.1 N m; both are within its rounding."""
    brake, torque = clutch_by_hand()
    law = solve_brake_by_rigid_shoe_law(brake)
    assert law.torque == pytest.approx(torque, rel=1e-12)
    assert round(law.torque, 1) == 82.1
    assert [round(shoe.torque / brake.size, 1) for shoe in law.shoes] == [82.1] * 4


@pytest.mark.slow
def test_clutch_by_elements_is_its_closed_form() -> None:
    """A spring with a rate would give way on the soft contact, so that it has none here."""
    brake, torque = clutch_by_hand()
    rates = {f"spring[{k}].rate": 0.0 for k in range(4)}
    assert rigid_limit(vary(brake, rates)).torque == pytest.approx(torque, rel=1e-9)
