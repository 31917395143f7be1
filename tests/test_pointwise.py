"""The textbook method of contact springs at quadrature points is right, or does not converge."""

import math
from pathlib import Path

import pytest

from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.file import read_brake, vary
from drumlin.fem.solve import solve
from drumlin_studies import pointwise
from picking import picked

BRAKE = Path(__file__).parents[1] / "studies" / "double_shoe" / "brake.toml"


@pytest.fixture(scope="module")
def brake():
    return read_brake(BRAKE)


@pytest.mark.slow
def test_its_error_is_linear_in_the_penalty_s_compliance(brake):
    exact = solve(brake, penalty=math.inf).torque
    soft, stiff = (
        pointwise.solve_by_pointwise_penalty(brake, penalty=alpha).torque / exact - 1
        for alpha in (1e2, 1e3)
    )
    assert soft / stiff == pytest.approx(10, rel=0.03)
    assert abs(stiff) < 1e-4


@pytest.mark.slow
def test_it_agrees_shoe_by_shoe(brake):
    weak, points = (
        solve(brake, penalty=1e3),
        pointwise.solve_by_pointwise_penalty(brake, penalty=1e3),
    )
    for a, b in zip(weak.shoes, points.shoes, strict=True):
        assert b.torque == pytest.approx(a.torque, rel=1e-4)
        assert b.normal_force == pytest.approx(a.normal_force, rel=1e-4)
        assert b.hinge_reaction == pytest.approx(a.hinge_reaction, rel=1e-3)
        assert b.turn == pytest.approx(a.turn, rel=1e-3)
        assert b.self_energising == a.self_energising
    assert max(points.balance.force, points.balance.moment) < 1e-10


def test_a_stiff_penalty_on_a_coarse_mesh_cycles_and_is_refused(brake):
    with pytest.raises(NoAnswer, match="repeats itself"):
        pointwise.solve_by_pointwise_penalty(brake, elements=20, penalty=1e6)
    # The weak form converges at this penalty all the same.
    assert solve(brake, elements=20, penalty=1e6).converged


def test_refusals(brake):
    with pytest.raises(BadInput, match="penalty = inf"):
        pointwise.solve_by_pointwise_penalty(brake, penalty=math.inf)
    ring = {"thickness": 15e-3, "width": 40e-3, "material": {"E": 120e9, "nu": 0.25}}
    with pytest.raises(BadInput, match=r"drum\.ring"):
        pointwise.solve_by_pointwise_penalty(vary(brake, {"drum.ring": ring}))


def test_a_shoe_that_is_pulled_off_does_not_touch(brake):
    away = pointwise.solve_by_pointwise_penalty(vary(brake, {"shoe.actuation.force": -1.0}))
    assert away.torque == 0 and not any(picked(away.shoes, "contact_arcs"))
