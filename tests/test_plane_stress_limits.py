"""The ranges in which plane stress is right, by the model of the width."""

import pytest

from drumlin.brake.file import read_brake, vary
from drumlin_studies.plane_stress_limits import (
    VARIED_QUANTITIES_OF_FIGURE_PANELS,
    errors_of_plane_stress_by_width_model,
    parameter_ranges_within_error_limits,
    rows_of_plane_stress_limits,
)


@pytest.fixture(scope="module")
def t_brake(root):
    return read_brake(root / "studies" / "plane_stress" / "brake.toml")


@pytest.mark.parametrize(
    "variation", VARIED_QUANTITIES_OF_FIGURE_PANELS, ids=lambda each: each.name
)
def test_a_brake_has_the_value_that_it_is_given(t_brake, variation):
    assert len(variation.values) > 4
    for value in variation.values:
        brake_with_value = variation.brake_with_value(t_brake, value)
        assert variation.value(brake_with_value) == pytest.approx(value)


def test_without_contraction_plane_stress_of_one_width_has_no_error(flexible):
    changes = {"shoe.lining.material.nu": 0.0, "shoe.body.material.nu": 0.0}
    for error in errors_of_plane_stress_by_width_model(vary(flexible, changes)).values():
        # The two answers are on two levels of the section, whose own error is left.
        assert error < 2e-3


def test_ranges_are_those_of_values_within_the_limits():
    rows = [
        {"varied": "x", "brake": "b", "value": value, "pressure": error, "torque": 0.5}
        for value, error in ((1.0, 0.001), (2.0, 0.04), (3.0, 0.1))
    ]
    found = {
        (each.quantity, each.limit): each for each in parameter_ranges_within_error_limits(rows)
    }
    assert found["pressure", 0.01][-2:] == (1.0, 1.0)
    assert found["pressure", 0.05][-2:] == (1.0, 2.0)
    assert found["pressure", 0.2][-2:] == (1.0, 3.0)
    assert found["torque", 0.2][-2:] == (None, None)


@pytest.mark.slow
def test_quantities_of_a_web_are_not_varied_on_shoes_of_one_width(flexible, t_brake):
    rows = rows_of_plane_stress_limits({"one": flexible, "T": t_brake}, every=6)
    varied = {(row["varied"], row["brake"]) for row in rows}
    assert ("web width / lining width", "T") in varied
    assert ("web width / lining width", "one") not in varied
    assert ("friction", "one") in varied


@pytest.mark.slow
def test_thin_tables_and_stiff_linings_are_far_from_plane_stress(t_brake):
    usual = errors_of_plane_stress_by_width_model(t_brake)["pressure"]
    assert 0.03 < usual < 0.07
    for change in ({"shoe.backing.thickness": 1.5e-3}, {"shoe.lining.material.E": 3e9}):
        assert errors_of_plane_stress_by_width_model(vary(t_brake, change))["pressure"] > 2 * usual
