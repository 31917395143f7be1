"""Tolerances: the draws, the shares of the variance against closed forms, and what is refused."""

import math

import numpy as np
import pytest

from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.file import numerical_value_of_brake_key, vary
from drumlin.laws import solve_brake_by_sine_law
from drumlin.sweeps import cases as sweep
from drumlin.sweeps.tolerances import (
    ManufacturingTolerance,
    cases_with_random_deviations,
    draw_deviations_for_all_sobol_samples,
    mean_and_percentiles_of_sample,
    sobol_indices_of_tolerances,
    truncated_normal_distribution,
    uniform_distribution,
    values_of_named_result_in_all_cases,
)

TOLERANCES = (
    ManufacturingTolerance("friction", truncated_normal_distribution(0.006), {"friction": 1.0}),
    ManufacturingTolerance(
        "force", truncated_normal_distribution(0.03), {"shoe.actuation.force": 2e3}
    ),
    ManufacturingTolerance(
        "line of force", truncated_normal_distribution(1e-3), {"shoe.actuation.point.y": 1.0}
    ),
    ManufacturingTolerance(
        "modulus", truncated_normal_distribution(0.2), {"shoe.lining.material.E": 3e8}
    ),
)


@pytest.mark.slow
def test_the_shares_of_the_sine_laws_torque_are_those_of_its_derivatives(brake):
    """Shares of small tolerances are those of the sine law's derivatives.

    S_i = (dT/dx_i s_i)^2 / sum. The law has no modulus, whose share is 0. First and total shares
    agree.
    """
    n = 128
    deviates = draw_deviations_for_all_sobol_samples(TOLERANCES, n, seed=3)
    torque = values_of_named_result_in_all_cases(
        sweep.solve_all_cases_of_sweep(
            cases_with_random_deviations(brake, TOLERANCES, deviates, "sine")
        ),
        "torque",
    ).reshape(-1, n)
    parts = []
    for i, tolerance in enumerate(TOLERANCES):
        step = 0.1 * tolerance.distribution.std() * np.eye(len(TOLERANCES))[i]
        high, low = (
            solve_brake_by_sine_law(vary(brake, case.changes)).torque
            for case in cases_with_random_deviations(brake, TOLERANCES, np.array([step, -step]))
        )
        # The slope is taken per standard deviation.
        parts.append(5 * (high - low))
    exact = np.square(parts) / np.sum(np.square(parts))
    assert exact[3] == 0 and exact[:3].min() > 0.01
    found = sobol_indices_of_tolerances(TOLERANCES, torque, seed=1, confidence=0.99, resamples=200)
    for share, true in zip(found, exact, strict=True):
        for index in (share.first, share.total):
            assert index.low - 0.005 <= true <= index.high + 0.005
            assert index.high - index.low < 0.5
        assert share.total.value == pytest.approx(true, abs=0.06)
    both = mean_and_percentiles_of_sample(torque[:2].ravel())
    assert both.deviation == pytest.approx(math.sqrt(np.sum(np.square(parts))), rel=0.06)
    assert both.mean == pytest.approx(solve_brake_by_sine_law(brake).torque, rel=2e-3)


def test_shares_of_a_product_with_interaction():
    """f = x (1 + y) of two even deviates on (-1, 1): first 3/4 and 0, total 1 and 1/4."""
    tolerances = [ManufacturingTolerance(name, uniform_distribution(-1, 1), {}) for name in "xy"]
    deviates = draw_deviations_for_all_sobol_samples(tolerances, 1024, seed=1)
    found = sobol_indices_of_tolerances(
        tolerances, deviates[..., 0] * (1 + deviates[..., 1]), seed=2
    )
    for share, first, total in zip(found, (0.75, 0.0), (1.0, 0.25), strict=True):
        assert (
            share.first.value == pytest.approx(first, abs=0.05)
            and share.first.low <= share.first.high
        )
        assert share.total.value == pytest.approx(total, abs=0.05)


def test_draws_are_what_saltelli_asks_for():
    tolerances = [
        ManufacturingTolerance("a", truncated_normal_distribution(2.0), {}),
        ManufacturingTolerance("b", uniform_distribution(3, 5), {}),
    ]
    x = draw_deviations_for_all_sobol_samples(tolerances, 64, seed=1)
    assert x.shape == (4, 64, 2)
    assert (x[2, :, 0] == x[1, :, 0]).all() and (x[2, :, 1] == x[0, :, 1]).all()
    assert (x[3, :, 0] == x[0, :, 0]).all() and (x[3, :, 1] == x[1, :, 1]).all()
    assert np.abs(x[..., 0]).max() <= 2 and x[..., 1].min() >= 3 and x[..., 1].max() <= 5
    assert (draw_deviations_for_all_sobol_samples(tolerances, 64, seed=1) == x).all() and (
        draw_deviations_for_all_sobol_samples(tolerances, 64, seed=2) != x
    ).any()
    with pytest.raises(BadInput, match="power of 2"):
        draw_deviations_for_all_sobol_samples(tolerances, 48, seed=1)


def test_deviates_add_up_on_the_keys_that_they_share(brake):
    tolerances = [
        ManufacturingTolerance("one", truncated_normal_distribution(1), {"drum.angle": 1.0}),
        ManufacturingTolerance("two", truncated_normal_distribution(1), {"drum.angle": -2.0}),
    ]
    (case,) = cases_with_random_deviations(brake, tolerances, np.array([[0.5, 0.1]]), elements=40)
    assert case.changes == {"drum.angle": pytest.approx(0.3)} and case.options == {"elements": 40}
    assert numerical_value_of_brake_key(brake, "shoe.lining.thickness") == pytest.approx(8e-3)
    with pytest.raises(BadInput, match="name each"):
        clash = [
            ManufacturingTolerance("all", truncated_normal_distribution(1), {"shoe.width": 1.0}),
            ManufacturingTolerance("one", truncated_normal_distribution(1), {"shoe[0].width": 1.0}),
        ]
        cases_with_random_deviations(brake, clash, np.zeros((1, 2)))
    for key, words in (
        ("shoe.lining.tickness", "unknown key"),
        ("shoe.name", "right"),
        ("shoe.hinge.x", "name one"),
    ):
        with pytest.raises(BadInput, match=words):
            numerical_value_of_brake_key(brake, key)


def test_shares_need_an_answer_of_every_case(brake):
    tolerances = [
        ManufacturingTolerance("friction", uniform_distribution(0.2, 1.2), {"friction": 1.0})
    ]
    rows = sweep.solve_all_cases_of_sweep(
        cases_with_random_deviations(
            brake,
            tolerances,
            draw_deviations_for_all_sobol_samples(tolerances, 8, seed=1),
            "sine",
        )
    )
    assert any(row["status"] == "solved" for row in rows)
    with pytest.raises(
        NoAnswer, match=r"of 24 cases have no answer; the first: failed: .*self-locking"
    ):
        values_of_named_result_in_all_cases(rows, "torque")
