"""Slopes from the tangent against differences of whole solves and against scaling."""

import json
import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from command_line import drumlin
from conftest import STUDY
from drumlin.base.errors import DrumlinError, NoAnswer
from drumlin.brake.file import vary
from drumlin.fem.analysis.sensitivity import (
    compare_torque_slopes_with_solve_differences,
    compute_torque_sensitivity,
)
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.solve import solve
from drumlin_studies.random_brake import draw_random_brake
from shared_parts import drum_ring, modulus_slopes

RING = drum_ring(0.015, "free")


@pytest.mark.parametrize(
    "changes", [RING, {"rotation": "clockwise", "shoe.lining.clearance": 1e-5}], ids=["ring", "gap"]
)
def test_every_slope_agrees_with_differences_of_solves_from_the_mesh_up(brake, changes):
    for row in compare_torque_slopes_with_solve_differences(vary(brake, changes), 1, elements=8)[1]:
        assert row["difference"] < 2e-6, row


@given(st.integers(0, 10**6), st.sampled_from(["locking", "opposed"]), st.floats(0.05, 0.5))
def test_the_slope_over_friction_is_that_of_differences_where_no_set_changes(seed, way, friction):
    brake = vary(draw_random_brake(seed, way), {"friction": friction})
    scene = make_prepared_model(brake, elements=12)
    try:
        found = compute_torque_sensitivity(scene, brake)
        around = [
            solve_prepared_model(scene, vary(brake, {"friction": friction + s}))
            for s in (-2e-5, -1e-5, 1e-5, 2e-5)
        ]
    except DrumlinError:
        assume(False)
    touching = [response.shoes[0].pressure > 0 for response in around]
    assume(all((touching[0] == other).all() for other in touching))
    wide, narrow = ((around[-k].torque - around[k - 1].torque) / (2e-5 * (3 - k)) for k in (1, 2))
    # Close to the pole of self-locking the first difference alone is not enough.
    near = (4 * narrow - wide) / 3
    assert found.friction == pytest.approx(near, rel=1e-5, abs=1e-6 * found.torque)


def test_moduli_scaled_alike_change_nothing_and_forces_are_proportional(brake):
    ringed = vary(brake, RING)
    found = compute_torque_sensitivity(make_prepared_model(ringed, elements=12), ringed)
    moduli = modulus_slopes(found)
    assert found.ring is not None
    assert math.fsum([*moduli, found.ring]) == pytest.approx(0.0, abs=1e-10 * max(map(abs, moduli)))
    forces = math.fsum(
        own.force * shoe.actuation.force for own, shoe in zip(found.shoes, brake.shoes, strict=True)
    )
    assert forces == pytest.approx(found.torque, rel=1e-10)


def test_a_pull_is_a_push_the_other_way(brake):
    shoe = brake.shoes[0].actuation
    pull = {
        "shoe[0].actuation.force": -shoe.force,
        "shoe[0].actuation.direction": shoe.direction + math.pi,
    }
    a, b = (
        compute_torque_sensitivity(make_prepared_model(each, elements=8), each).shoes[0]
        for each in (brake, vary(brake, pull))
    )
    assert b.force == pytest.approx(-a.force, rel=1e-9)
    assert b.held["hinge"] == pytest.approx(a.held["hinge"], rel=1e-7)


@pytest.mark.parametrize("index", range(2))
def test_an_uneven_clearance_acts_through_its_density(brake, index):
    """An uneven clearance acts through its density: a bump changes the torque by its integral."""
    scene = make_prepared_model(brake, elements=20)
    found = compute_torque_sensitivity(scene, brake)
    shoe, R = found.shoes[index], brake.drum.radius
    height = 1e-9
    theta = shoe.theta
    # The bump lies nearer to one end than to the other.
    bump = height * np.exp(-(((theta - theta.mean() - 0.3) / 0.2) ** 2))
    table = np.column_stack([theta, bump]).tolist()
    change = (
        solve_prepared_model(scene, vary(brake, {f"shoe[{index}].lining.clearance": table})).torque
        - found.torque
    )
    expected = np.trapezoid(shoe.density * bump, theta) * R
    assert change == pytest.approx(expected, rel=5e-3)
    assert shoe.clearance == pytest.approx(np.trapezoid(shoe.density, theta) * R, rel=2e-2)


def test_sensitivities_on_the_command_line(brake, tmp_path):
    file = tmp_path / "s.json"
    done = drumlin("sensitivity", STUDY / "brake.toml", "--elements", 12, "--json", file)
    assert done.returncode == 0
    data, said = json.loads(file.read_text()), " ".join(done.stdout.split())
    assert data["torque"] == pytest.approx(solve(brake, elements=12).torque, rel=1e-12)
    assert f"S = (mu/T) dT/dmu = {data['S']:.5g} (sine law: 1.3064)" in said
    with pytest.raises(NoAnswer, match="without friction there is no torque"):
        compute_torque_sensitivity(
            make_prepared_model(brake, elements=4), vary(brake, {"friction": 0.0})
        )
