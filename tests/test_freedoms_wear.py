"""Shoes of every kind run in to their rigid-shoe law, and worn in at once they bear by it."""

from typing import Any

import numpy as np
import pytest

import drumlin
from drumlin.brake.file import vary
from drumlin.brake.plane_brake import FlatBrake
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.laws import solve_brake_by_its_rigid_shoe_law
from drumlin.lining_wear.linings import wear_setup_by_finite_elements
from drumlin.lining_wear.run_in import (
    compute_checks_of_wear_run,
    final_wear_pressure_and_torque_by_rigid_shoe_law,
    wear_brake_linings_until_worn_in,
)
from flat_pads import pad
from held_shoes import BODY, brake_of
from shared_forces import cam_brake, servo

pytestmark = pytest.mark.slow

THICK = {"shoe.lining.thickness": 0.005}
BRAKES: dict[str, Any] = {
    "abutment": lambda: vary(brake_of("abutment", -1, body=BODY), THICK),
    "pivot": lambda: vary(brake_of("pivot", 1, body=BODY), THICK),
    "guide": lambda: vary(brake_of("guide", 1, body=BODY), THICK),
    "cam": lambda: cam_brake(body=0.012, thickness=0.006),
    "strut": lambda: vary(servo(body=0.02), THICK),
}


@pytest.mark.parametrize("name", BRAKES)
def test_worn_in_elastic_shoes_bear_by_the_law(name: str) -> None:
    brake = BRAKES[name]()
    new, worn, rigid = (
        drumlin.solve(brake),
        drumlin.solve(brake, worn_in=True),
        solve_brake_by_its_rigid_shoe_law(brake),
    )
    assert abs(new.torque / rigid.torque - 1) > 2e-3
    assert worn.torque == pytest.approx(rigid.torque, rel=1e-3)
    for a, b in zip(worn.shoes, rigid.shoes, strict=True):
        assert a.torque == pytest.approx(b.torque, rel=1e-3)
        if b.force is not None:
            assert a.force == pytest.approx(b.force, rel=1e-3)


def test_a_worn_in_pad_bears_by_the_law() -> None:
    brake = pad(
        "hinge",
        "-x",
        lining={
            "start": 0.06,
            "end": 0.18,
            "thickness": 0.008,
            "width": 0.04,
            "material": {"E": 3e8, "nu": 0.25},
        },
    )
    assert isinstance(brake, FlatBrake)
    worn, rigid = drumlin.solve(brake, worn_in=True), solve_brake_by_its_rigid_shoe_law(brake)
    assert worn.merits[0].braking_force == pytest.approx(rigid.merits[0].braking_force, rel=1e-4)
    x = np.linspace(0.07, 0.17, 21)
    np.testing.assert_allclose(
        worn.shoes[0].pressure_at(x), rigid.shoes[0].pressure_at(x), rtol=2e-3
    )


@pytest.mark.parametrize("name", ["abutment", "cam"])
def test_running_in_ends_at_the_law(name: str) -> None:
    """The forces of a cam are shared anew at every step: new F1 B1 is not F2 B2, worn in it is."""
    brake = BRAKES[name]()
    setup = wear_setup_by_finite_elements(make_prepared_model(brake, elements=24), brake)
    states, goal = (
        wear_brake_linings_until_worn_in(setup),
        final_wear_pressure_and_torque_by_rigid_shoe_law(setup),
    )
    assert goal.torque == pytest.approx(solve_brake_by_its_rigid_shoe_law(brake).torque, rel=2e-4)
    assert states[-1].torque == pytest.approx(goal.torque, rel=2e-3)
    assert abs(states[0].torque / goal.torque - 1) > 3e-3
    assert (
        compute_checks_of_wear_run(setup, states, drumlin.lining_wear.archard.WearLaw(1e-14)).volume
        < 1e-9
    )
