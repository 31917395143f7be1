"""The grid convergence index against NASA's published example, and V&V 20's comparison error."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drumlin_studies.uncertainty import (
    compare_simulated_value_with_reference_value,
    grid_convergence_index_of_three_values,
)


def test_nasas_example():
    """NASA's NPARC tutorial on grid convergence: pressure recovery on 200, 100 and 50 cells.

    "Examining Spatial (Grid) Convergence".

    Its program computes in single precision: its digits are those of the values as that rounds
    them.
    """
    values = (0.97050, 0.96854, 0.96178)
    assert grid_convergence_index_of_three_values(*values).order == pytest.approx(
        1.786170, abs=1e-6
    )
    assert grid_convergence_index_of_three_values(*values).asymptotic == pytest.approx(
        1.002, abs=1e-4
    )
    found = grid_convergence_index_of_three_values(*(float(np.float32(value)) for value in values))
    assert found.order == pytest.approx(1.78618479, abs=3e-7)
    assert found.extrapolated == pytest.approx(0.971300304, abs=3e-9)
    assert found.fine == pytest.approx(0.00103080, abs=1e-8)
    assert found.coarse == pytest.approx(0.00356244, abs=1e-8)


@given(
    limit=st.floats(1.0, 10.0),
    size=st.floats(1e-3, 0.1),
    order=st.floats(0.5, 4.0),
    ratio=st.floats(1.3, 3.0),
    sign=st.sampled_from([-1, 1]),
)
def test_a_pure_power_is_seen_through(limit, size, order, ratio, sign):
    values = [limit + sign * size * ratio ** (order * k) / ratio ** (2 * order) for k in range(3)]
    found = grid_convergence_index_of_three_values(*values, ratio=ratio)
    assert found.order == pytest.approx(order, rel=1e-6)
    assert found.extrapolated == pytest.approx(limit, rel=1e-8)
    assert found.fine == pytest.approx(1.25 * abs(limit - values[0]) / values[0], rel=1e-5)


@pytest.mark.parametrize("values", [(1.0, 1.1, 1.05), (1.0, 1.1, 1.15), (1.0, 1.0, 1.0)])
def test_without_an_order_there_is_no_index(values):
    with pytest.raises(ValueError, match="no order"):
        grid_convergence_index_of_three_values(*values)


def test_the_comparison_error_and_its_uncertainty():
    found = compare_simulated_value_with_reference_value(
        103.0, 100.0, numerical=0.3, inputs=1.2, of_data=0.4
    )
    assert found.error == 3.0
    assert found.uncertainty == pytest.approx(1.3)
    assert found.model_error_interval == pytest.approx((1.7, 4.3))
    assert (
        found.is_model_error_detected
        and not compare_simulated_value_with_reference_value(
            101.0, 100.0, numerical=0.3, inputs=1.2, of_data=0.4
        ).is_model_error_detected
    )
