"""The judge of the estimated error of plane stress on random brakes."""

import numpy as np
import pytest

from drumlin.brake.file import read_brake, vary
from drumlin.fem.width.correction import REMAINING_ERROR_OVER_WIDTH_CORRECTION
from drumlin_studies.random_brake import draw_random_brake
from drumlin_studies.width_error import (
    LEAST_JUDGED_PLANE_STRESS_ERROR,
    TrueAndEstimatedPlaneStressErrorRow,
    table_lines_of_estimated_over_true_errors,
    table_lines_of_remaining_error_after_correction,
    true_and_estimated_plane_stress_errors_or_reason,
)
from sections import t_section


def row(widths, true, ratio, remaining=0.0):
    """A row whose three errors are `true`, and estimated as a multiple of it."""
    names = ("torque", "pressure", "reaction")
    return TrueAndEstimatedPlaneStressErrorRow(
        "t",
        widths,
        dict.fromkeys(names, true),
        dict.fromkeys(names, ratio * true),
        dict.fromkeys(names, remaining * true),
    )


def test_the_table_counts_errors_that_matter():
    rows = [row(1, 1e-2, 0.5), row(1, 1e-2, 1.0), row(1, 1e-4, 9.0), row(3, 1e-2, 2.0)]
    _, one, several, *_ = table_lines_of_estimated_over_true_errors(rows)
    assert one.split() == [*["one", "torque", "2", "0.50"], "0.53", "0.75", "0.97", "1.00", "50%"]
    assert several.split()[:4] == ["several", "torque", "1", "2.00"]


def test_the_table_of_corrected_answers_counts_errors_that_matter():
    rows = [row(1, 1e-2, 1.0, 0.1), row(3, 1e-2, 1.0, 0.9), row(3, 1e-4, 1.0, 9.0)]
    _, torque, *_ = table_lines_of_remaining_error_after_correction(rows)
    name, brakes, share, half, *_, most, within, halved = torque.split()
    assert [name, brakes, half, most] == ["torque", "2", "0.50", "0.90"]
    assert 0.1 < float(share) < 0.9
    assert within == halved == "50%"


@pytest.mark.slow
def test_a_brake_is_judged_on_its_own_section(flexible):
    found = true_and_estimated_plane_stress_errors_or_reason(t_section(flexible), 3)
    assert isinstance(found, TrueAndEstimatedPlaneStressErrorRow)
    assert found.widths == 3
    for name, true in found.true.items():
        assert true > 1e-3
        assert 0.5 < found.estimated_over_true_error(name) < 2.0
        assert 0 < found.remaining[name] < 0.5 * true


def test_a_brake_without_an_estimate_is_a_line(root, flexible):
    ring = read_brake(root / "studies" / "post_brake" / "brake.toml")
    assert (
        true_and_estimated_plane_stress_errors_or_reason(ring)
        == "its drum is an elastic ring, whose own width is not modelled"
    )
    stiff = vary(flexible, {"shoe.lining.material.nu": 0.4999})
    assert "is all but incompressible" in true_and_estimated_plane_stress_errors_or_reason(stiff)


@pytest.mark.parametrize("name", ["torque", "pressure", "reaction"])
def test_the_ratio_of_a_row_is_that_of_estimated_and_true(name):
    assert row(1, 2e-3, 1.25).estimated_over_true_error(name) == pytest.approx(1.25)


@pytest.mark.slow
def test_what_remains_after_the_correction_is_within_its_share_on_other_brakes():
    """On brakes whose share of the correction was not used to choose the stated shares."""
    kinds = ("arc", "backed", "rigid", "out of round")
    brakes = [draw_random_brake(seed, kinds[seed % 4]) for seed in range(3000, 3016)]
    rows = [
        found
        for found in map(true_and_estimated_plane_stress_errors_or_reason, brakes)
        if isinstance(found, TrueAndEstimatedPlaneStressErrorRow)
    ]
    shares = []
    for name, stated in REMAINING_ERROR_OVER_WIDTH_CORRECTION.items():
        own = [found for found in rows if found.true[name] > LEAST_JUDGED_PLANE_STRESS_ERROR]
        shares += [
            found.error_share_remaining_after_width_correction(name) / stated for found in own
        ]
    assert len(shares) > 24
    assert np.mean(np.array(shares) < 1) > 0.85
    assert max(shares) > 0.5
