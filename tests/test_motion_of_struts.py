"""The foot of a shoe that pushes a strut travels with the shoe that the strut pushes.

Springs on rigid shoes are compared with equations by hand, `hold` with a brake on anchors.
"""

import math
from typing import Any

import numpy as np
import pytest

import drumlin
from anchored_shoes import CYLINDER, FOOT, FORCE, LINING, WIDTH, R
from drumlin.brake.brake import Brake
from drumlin.brake.file import make_drum_brake_from_data, vary

HALF, FRICTION = 0.8, 0.1
"""Half of the arc [rad] of both linings, and a friction that keeps them in contact everywhere."""
ANCHOR = np.array([-0.012, 0.118])
"""Place x, y [m] of the pin of the left shoe."""
SPRING: dict[str, Any] = {
    "shoe": "right",
    "to": "left",
    "point": {"x": 0.045, "y": 0.08},
    "end": {"x": -0.045, "y": 0.06},
    "preload": 150.0,
}
SOFT = 1e-8
"""Penalty factor of a contact so soft that the linings beside it are rigid."""


def uni_servo(mu: float = FRICTION, **keys: Any) -> Brake:
    """Two shoes without bodies; the right one pushes the left one, which hangs on a pin."""
    lining = LINING | {"start": -HALF, "end": HALF}
    right = {
        "name": "right",
        "side": "internal",
        "abutment": {"point": {"x": 0.025, "y": FOOT}, "direction": 0.0},
        "lining": lining,
        "actuation": {"force": FORCE, "direction": 0.0, "point": {"x": 0.03, "y": CYLINDER}},
    }
    left = {
        "name": "left",
        "side": "internal",
        "hinge": {"x": ANCHOR[0], "y": ANCHOR[1]},
        "lining": lining | {"start": math.pi - HALF, "end": math.pi + HALF},
    }
    data = {
        "title": "t",
        "rotation": "clockwise",
        "friction": mu,
        "drum": {"radius": R},
        "shoe": [right, left],
        "link": [{"from": "right", "to": "left"}],
    }
    return make_drum_brake_from_data(data | keys)


def uni_servo_on_anchors(mu: float = FRICTION) -> Brake:
    """The same brake; three anchors are the pin of the left shoe, and none holds the right shoe."""
    data = uni_servo(mu).model_dump(by_alias=True, exclude_defaults=True)
    right, left = data["shoe"]
    right["anchor"] = [{"point": {"x": 0.012, "y": 0.118}, "direction": 0.0, "clearance": 0.01}]
    del left["hinge"]
    pin = {"x": ANCHOR[0], "y": ANCHOR[1]}
    left["anchor"] = [{"point": pin, "direction": x} for x in (math.pi, math.pi / 2, -math.pi / 2)]
    left["abutment"] = {"point": {"x": -0.025, "y": FOOT}, "direction": math.pi}
    left["actuation"] = {
        "force": 0.0,
        "direction": math.pi,
        "point": {"x": -0.03, "y": CYLINDER},
    }
    return make_drum_brake_from_data(data)


def forces_of_drum(middle: float, stiffness: float) -> np.ndarray:
    """Forces x, y and moment about O on a rigid shoe, (3, 2), per displacement x and y of O.

    The lining is a layer of springs, and the drum turns clockwise. The integrals over the lining
    are by Gauss's rule.
    """
    x, weight = np.polynomial.legendre.leggauss(40)
    theta = middle + HALF * x
    normal = np.array([np.cos(theta), np.sin(theta)])
    tangent = np.array([-np.sin(theta), np.cos(theta)])
    on_shoe = -normal - FRICTION * tangent
    moment = -FRICTION * R * np.ones_like(theta)
    pressed = stiffness * WIDTH * R * HALF * weight * normal
    return np.vstack([on_shoe, moment]) @ pressed.T


def wrench(force: tuple[float, float], point: tuple[float, float]) -> np.ndarray:
    return np.array([*force, point[0] * force[1] - point[1] * force[0]])


def torque_and_pull_by_hand(stiffness: float, rate: float) -> tuple[float, float]:
    """Torque and pull of the spring from the equilibria of both rigid shoes.

    The unknowns are displacement x, y of the right shoe's centre, its turn, the turn of the left
    shoe about its pin, the force of the strut and the pull. The strut keeps both feet at the same
    x.
    """
    right, left = (forces_of_drum(middle, stiffness) for middle in (0.0, math.pi))
    centre = np.array([ANCHOR[1], -ANCHOR[0]])
    point, end = (np.array([p["x"], p["y"]]) for p in (SPRING["point"], SPRING["end"]))
    along = (end - point) / np.linalg.norm(end - point)
    pull = wrench(tuple(along), tuple(point))
    back = wrench(tuple(-along), tuple(end))
    foot, strut = wrench((1.0, 0.0), (0.025, FOOT)), wrench((-1.0, 0.0), (0.025, FOOT))
    about_pin = np.array([ANCHOR[1], -ANCHOR[0], 1.0])
    of_left = np.array([*centre, 1.0])
    matrix, known = np.zeros((6, 6)), np.zeros(6)
    matrix[:3, :2], matrix[:3, 4], matrix[:3, 5] = right, foot, pull
    known[:3] = -wrench((FORCE, 0.0), (0.03, CYLINDER))
    matrix[3, 3:] = about_pin @ np.column_stack([left @ centre, strut, back])
    matrix[4, :3], matrix[4, 3] = foot, strut @ of_left
    matrix[5, :3], matrix[5, 3], matrix[5, 5] = rate * pull, rate * back @ of_left, 1.0
    known[5] = SPRING["preload"]
    unknown = np.linalg.solve(matrix, known)
    torque = right[2] @ unknown[:2] + left[2] @ centre * unknown[3]
    return abs(float(torque)), float(unknown[5])


@pytest.mark.parametrize("rate", [7e3, 1e6, 1e7])
def test_a_spring_between_a_strut_and_its_shoe_is_that_of_rigid_shoes(rate: float) -> None:
    brake = uni_servo(spring=[SPRING | {"rate": rate}])
    stiffness = LINING["material"]["E"] / LINING["thickness"]
    stiff = vary(brake, {"shoe.lining.material.E": LINING["material"]["E"] / SOFT})
    found = drumlin.solve(stiff, elements=24, penalty=SOFT, model_error=False)
    assert all(np.ptp(shoe.contact_arcs[0]) == pytest.approx(1.6) for shoe in found.shoes)
    torque, pull = torque_and_pull_by_hand(stiffness, rate)
    assert found.spring_pulls[0] == pytest.approx(pull, rel=1e-6)
    assert found.torque == pytest.approx(torque, rel=1e-6)


def test_a_holding_uni_servo_turns_as_one_whose_pin_is_anchors() -> None:
    """The strut carries the right shoe with the drum, so that its lining slips less.

    The two brakes are loaded on different paths before the drum turns, which changes all torques by
    some 0.1 %. The growth of the torque with the turn does not depend on the path.
    """
    growths = []
    for brake in (uni_servo(0.6), uni_servo_on_anchors(0.6)):
        states = drumlin.hold(brake, elements=8, rotation=2e-4, steps=4).states
        growths.append(np.diff([state.torque for state in states[1:]]))
    np.testing.assert_allclose(*growths, rtol=1e-3)


@pytest.mark.slow
def test_hold_wear_and_slopes_of_a_sprung_uni_servo_are_those_of_solve() -> None:
    brake = drumlin.example("uni_servo")
    names = {"shoe": "primary", "to": "secondary", "rate": 7e5}
    brake = vary(brake, {"spring": [SPRING | names]})

    def torque(changes: dict[str, Any]) -> float:
        return drumlin.solve(vary(brake, changes), elements=8, model_error=False).torque

    still = torque({})
    assert drumlin.hold(brake, elements=8, steps=4).states[-1].torque == pytest.approx(
        still, rel=1e-8
    )
    worn = drumlin.wear(brake, distance=1.0, elements=8)
    assert worn.states[0].torque == pytest.approx(still, rel=1e-8)
    slopes = drumlin.sensitivity(brake, elements=8)
    near = (torque({"spring[0].rate": 7.01e5}) - torque({"spring[0].rate": 6.99e5})) / 2e3
    assert slopes.springs[0].rate == pytest.approx(near, rel=1e-4)
    for axis, slope in zip("xy", slopes.shoes[0].held["abutment.point"], strict=True):
        key = f"shoe[0].abutment.point.{axis}"
        at = getattr(brake.shoes[0].abutment.point, axis)
        near = (torque({key: at + 1e-6}) - torque({key: at - 1e-6})) / 2e-6
        assert slope == pytest.approx(near, rel=1e-4, abs=1e-5 * still)
