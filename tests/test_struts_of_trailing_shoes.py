"""The uni-servo brake turned the other way: its small torque by hand, and the note on it."""

import math

import numpy as np
import pytest

import drumlin
from drumlin.brake.brake import Brake

POINTS = 20001
"""Points of the trapezoidal rule along a lining."""
NOTE = "note: friction opposes shoe 'primary' and shoe 'secondary' in this sense of the motion"


def reversed_uni_servo() -> Brake:
    return drumlin.example("uni_servo").brake_with_reversed_motion()


def resultant(brake: Brake, factors: tuple[float, float], start: float, end: float) -> np.ndarray:
    """Force x, y and moment about O (3,) on a shoe, of p = A cos + B sin and its friction.

    The drum turns counter-clockwise. The integral is that of the trapezoidal rule.
    """
    theta = np.linspace(start, end, POINTS)
    p = factors[0] * np.cos(theta) + factors[1] * np.sin(theta)
    drag = brake.friction * p
    rows = np.array(
        [
            -p * np.cos(theta) - drag * np.sin(theta),
            -p * np.sin(theta) + drag * np.cos(theta),
            drag * brake.size,
        ]
    )
    widths = np.diff(theta)
    area = brake.shoes[0].lining.width * brake.size
    return area * (0.5 * (rows[:, 1:] + rows[:, :-1]) * widths).sum(axis=1)


def primary_by_hand(brake: Brake) -> tuple[float, float]:
    """Torque and strut force of the primary, whose lining touches from an unknown angle on.

    The strut bears on its foot along x. The contact begins where the pressure is zero.
    """
    shoe = brake.shoes[0]
    start, end, F = shoe.lining.start, shoe.lining.end, shoe.actuation.force
    load = F * np.array([1.0, 0.0, -shoe.actuation.point.y])
    strut = np.array([1.0, 0.0, -shoe.abutment.point.y])
    for _ in range(60):
        parts = [resultant(brake, each, start, end) for each in ((1.0, 0.0), (0.0, 1.0))]
        A, B, S = np.linalg.solve(np.column_stack([*parts, strut]), -load)
        start = max(shoe.lining.start, math.atan(-A / B))
    return float(A * parts[0][2] + B * parts[1][2]), float(S)


def secondary_by_hand(brake: Brake, strut: float) -> float:
    """Torque of the secondary, which the strut turns about its pin."""
    pin, lining = brake.shoes[1].hinge, brake.shoes[1].lining
    foot = brake.shoes[0].abutment.point
    x, y, moment = resultant(brake, (-pin.y, pin.x), lining.start, lining.end)
    about_pin = moment - (pin.x * y - pin.y * x)
    of_strut = strut * (foot.y - pin.y)
    return float(-of_strut / about_pin * moment)


def test_a_reversed_uni_servo_has_the_small_torque_of_its_trailing_shoes() -> None:
    brake = reversed_uni_servo()
    first, strut = primary_by_hand(brake)
    by_hand = first + secondary_by_hand(brake, strut)
    response = drumlin.solve(brake, "rigid")
    assert response.torque == pytest.approx(by_hand, rel=1e-7)
    # Turned forwards, the strut passes on some 2.4 times the force of the cylinder.
    assert strut < 0.3 * brake.shoes[0].actuation.force
    (note,) = [line for line in response.notes if line.startswith(NOTE)]
    assert f"passes on {strut:.6g} N of {brake.shoes[0].actuation.force:.6g} N" in note


def test_elements_say_why_the_torque_of_a_reversed_uni_servo_is_small() -> None:
    backwards = drumlin.solve(reversed_uni_servo(), elements=8)
    forwards = drumlin.solve(drumlin.example("uni_servo"), elements=8)
    assert backwards.torque < 0.15 * forwards.torque
    assert any(line.startswith(NOTE) for line in backwards.notes)
    assert not any(line.startswith(NOTE) for line in forwards.notes)
