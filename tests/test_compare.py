"""Comparison of models: differences of pressures, extrapolation to a limit, and tables."""

import math

import numpy as np
import pytest

from drumlin.brake.file import vary
from drumlin.comparison import (
    ResultTableColumn,
    compare,
    richardson_limit_from_three_meshes,
    table_as_csv_text,
)
from drumlin.laws import solve_brake_by_sine_law
from drumlin.response.norms import relative_distance_of_pressures, relative_distance_of_vectors
from picking import picked


def test_richardson_recovers_order_and_limit():
    value = richardson_limit_from_three_meshes(*(2.0 + 3.0 * h**2.5 for h in (0.4, 0.2, 0.1)))
    assert value.order == pytest.approx(2.5, rel=1e-9)
    assert value.value == pytest.approx(2.0, rel=1e-12)
    assert value.uncertainty == pytest.approx(3.0 * 0.1**2.5, rel=1e-9)


def test_no_order_is_claimed_where_differences_grow():
    value = richardson_limit_from_three_meshes(1.0, 1.1, 1.3)
    assert math.isnan(value.order)
    assert value.value == 1.3
    assert value.uncertainty == pytest.approx(0.2)
    assert richardson_limit_from_three_meshes(1.0, 2.0, 2.0).value == 2.0


def test_pressure_distance_is_the_relative_l2_norm(brake):
    a = solve_brake_by_sine_law(brake).shoes[0]
    b = solve_brake_by_sine_law(vary(brake, {"shoe.actuation.force": 2200.0})).shoes[0]
    assert relative_distance_of_pressures(a, a) == 0
    assert relative_distance_of_pressures(b, a) == pytest.approx(0.1, rel=1e-9)


def test_pressure_is_interpolated_between_nodes_and_zero_beyond(brake):
    shoe = solve_brake_by_sine_law(brake).shoes[0]
    theta = np.array([shoe.theta[0] - 0.1, 0.123, shoe.theta[-1] + 0.1])
    amplitude = shoe.peak_pressure
    assert shoe.pressure_at(theta) == pytest.approx(
        [0, amplitude * math.sin(0.123 + math.radians(75)), 0], rel=1e-8
    )


def test_a_failed_model_stays_in_the_table(brake):
    comparison = compare(vary(brake, {"friction": 0.9}), models=("fem", "sine"), elements=20)
    failed = [row for row in comparison.rows if row["status"].startswith("failed")]
    assert picked(failed, "model") == ["sine"]
    assert "self-locking" in failed[0]["status"]
    assert "fem" in comparison.responses
    assert table_as_csv_text(comparison.rows).count("\n") == len(comparison.rows) + 1


def test_cells_for_people():
    column = ResultTableColumn("x", "peak", "MPa", 1e-6, ".3g")
    assert column.title == "peak [MPa]"
    assert column.text({"x": 1.23456e6}) == "1.23"
    assert column.text({}) == column.text({"x": math.nan}) == "–"
    assert relative_distance_of_vectors(
        np.array([3.0, 4.0]), np.array([3.0, 0.0])
    ) == pytest.approx(4 / 3)
