"""Shoes that springs pull off the drum, on supports that push and cannot pull.

A brake without contact is refused. A shoe held off leaves its partner the torque of equations by
hand. Springs stiffer than the brake have the pull of a second way to compute it.
"""

from collections.abc import Callable

import numpy as np
import pytest

import drumlin
from anchored_shoes import CYLINDER, FOOT, FORCE, PIN, duo_servo, forces, shoe_equations
from drumlin.base.errors import NoAnswer
from drumlin.brake.brake import Brake
from drumlin.brake.file import vary

MU, HALF = 0.2, 0.8
PULL_ON_RIGHT_SHOE = 3000.0
"""Preload [N] of the spring that pulls the right shoe to the frame, on the line y = 0."""
HELD_OFF = "shoe 'right': no contact, its loads hold it off the drum, on its supports"


def brake_with_both_shoes_held_off(preload: float) -> Brake:
    """A duo-servo brake with a return spring from shoe to shoe, on the line of the cylinder."""
    ends = {"point": {"x": 0.03, "y": CYLINDER}, "end": {"x": -0.03, "y": CYLINDER}}
    spring = {"shoe": "right", "to": "left", "preload": preload} | ends
    return vary(duo_servo(-1, MU, (0.7, 0.8)), {"spring": [spring]})


def brake_with_right_shoe_held_off(half: float = HALF) -> Brake:
    """A duo-servo brake, turning so that its left shoe bears on the anchor, with a spring.

    The spring pulls the right shoe to the frame.
    """
    ends = {"point": {"x": 0.06, "y": 0.0}, "end": {"x": 0.0, "y": 0.0}}
    spring = {"shoe": "right", "preload": PULL_ON_RIGHT_SHOE} | ends
    return vary(duo_servo(-1, MU, (half, half)), {"spring": [spring]})


ANALYSES: dict[str, Callable[[Brake], object]] = {
    "solve": lambda brake: drumlin.solve(brake, elements=16),
    "rigid": lambda brake: drumlin.solve(brake, "rigid"),
    "wear": lambda brake: drumlin.wear(brake, elements=16),
    "hold": lambda brake: drumlin.hold(brake, elements=16),
    "hold at a rotation": lambda brake: drumlin.hold(brake, elements=16, rotation=1e-4),
    "sensitivity": lambda brake: drumlin.sensitivity(brake, elements=16),
}


@pytest.mark.parametrize("name", ANALYSES)
def test_springs_that_hold_both_shoes_off_the_drum_are_named(name: str) -> None:
    with pytest.raises(NoAnswer) as refusal:
        ANALYSES[name](brake_with_both_shoes_held_off(2000.0))
    assert str(refusal.value) == (
        "shoe 'right', shoe 'left': no contact, the springs hold every shoe off the drum: "
        "actuation 1100 N on 'right', actuation 1100 N on 'left', "
        "spring[0] with a preload of 2000 N"
    )


def test_a_spring_weaker_than_the_cylinder_lets_the_shoes_touch() -> None:
    """The torque is that of the net force: both act on one line."""
    net, full = (
        drumlin.solve(brake_with_both_shoes_held_off(preload), "rigid")
        for preload in (FORCE - 10, 0.0)
    )
    assert net.torque / full.torque == pytest.approx(10 / FORCE, rel=1e-9)
    # Elastic shoes spread a spring's pull over another length than the cylinder's push.
    net, full = (
        drumlin.solve(brake_with_both_shoes_held_off(preload), elements=16)
        for preload in (FORCE - 10, 0.0)
    )
    assert net.torque / full.torque == pytest.approx(10 / FORCE, rel=1e-5)


def torque_of_left_shoe_by_hand() -> float:
    """The torque of the left shoe, while anchor and strut alone hold the right shoe.

    The right shoe balances forces x and moments about O of its cylinder, its spring, its strut S
    and its anchor a. S loads the left shoe, whose unknowns are A, B of its pressure and its anchor.
    """
    spring = FORCE - PULL_ON_RIGHT_SHOE
    own = np.array([[1.0, 1.0], [-FOOT, -PIN]])
    strut, anchor = np.linalg.solve(own, [-spring, FORCE * CYLINDER])
    assert min(strut, anchor) > 0
    load = -(FORCE * np.array([1.0, 0.0, -CYLINDER]) + strut * np.array([1.0, 0.0, -FOOT]))
    pin = -np.array([1.0, 0.0, -PIN])
    lining = shoe_equations(-1, HALF, -1, MU)
    A, B, push = np.linalg.solve(np.column_stack([lining, pin]), -load)
    assert push > 0
    return abs(float(lining[2] @ [A, B]))


def test_a_rigid_shoe_held_off_the_drum_leaves_the_torque_of_its_partner() -> None:
    response = drumlin.solve(brake_with_right_shoe_held_off(), "rigid")
    assert response.shoes[0].torque == 0
    assert response.shoes[0].contact_arcs == ()
    assert response.torque == pytest.approx(torque_of_left_shoe_by_hand(), rel=1e-9)
    assert HELD_OFF in response.notes
    assert max(response.balance.force, response.balance.moment) < 1e-9


def test_an_elastic_shoe_held_off_the_drum_leaves_the_torque_of_its_partner() -> None:
    """The anchors balance the torque, and each analysis says that the right shoe does not press."""
    brake = brake_with_right_shoe_held_off(0.7)
    response = drumlin.solve(brake, elements=16)
    found = forces(response)
    assert response.shoes[0].torque == 0
    assert not response.shoes[0].pressure.any()
    by_anchors = (found["anchor of 'left'"] - found["anchor of 'right'"]) * PIN
    assert response.torque == pytest.approx(by_anchors, rel=1e-9)
    assert max(response.balance.force, response.balance.moment) < 1e-9
    assert HELD_OFF in response.notes
    held = drumlin.hold(brake, elements=16, steps=4)
    assert held.states[-1].torque == pytest.approx(response.torque, rel=1e-7)
    assert held.states[-1].notes == (HELD_OFF,)
    worn = drumlin.wear(brake, elements=16, distance=0.02)
    assert worn.states[0].torque == pytest.approx(response.torque, rel=1e-7)
    assert worn.states[-1].depth[worn.setup.surfaces[0].part].max() < 1e-15
    assert HELD_OFF in worn.lines()
    slopes = drumlin.sensitivity(brake, elements=16)
    assert slopes.torque == pytest.approx(response.torque, rel=1e-7)


def brake_with_spring_of_rate(rate: float) -> Brake:
    """A duo-servo brake with a spring from shoe to shoe, below the cylinder."""
    ends = {"point": {"x": 0.06, "y": 0.07}, "end": {"x": -0.06, "y": 0.07}}
    spring = {"shoe": "right", "to": "left", "preload": 50.0, "rate": rate} | ends
    return vary(duo_servo(-1, MU, (0.7, 0.8)), {"spring": [spring]})


@pytest.mark.parametrize("rate", (2e7, 1e8, 1e10))
def test_a_spring_stiffer_than_the_brake_pulls_as_in_one_problem_with_the_contact(
    rate: float,
) -> None:
    """`solve` finds the pull from outside, `wear` as an unknown beside the pressures."""
    brake = brake_with_spring_of_rate(rate)
    solved = drumlin.solve(brake, elements=16)
    unworn = drumlin.wear(brake, elements=16, distance=1e-4).states[0]
    assert solved.torque == pytest.approx(unworn.torque, rel=1e-7)
    assert solved.spring_pulls == pytest.approx(unworn.pulls, rel=1e-8)
    assert max(solved.balance.force, solved.balance.moment) < 1e-9
