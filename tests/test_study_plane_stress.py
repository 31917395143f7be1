"""The plane-stress study on its short setting: its headline numbers, and its report."""

import numpy as np
import pytest

from drumlin_studies import plane_stress
from picking import having, picked

pytestmark = pytest.mark.slow
STUDY_NAME = "plane_stress"


def test_plane_stress_has_the_torque_of_a_t_section_within_two_per_cent_and_no_width(
    result,
):
    leading = max(result.table, key=lambda row: row["solid_torque"])
    assert leading["friction"] == "assists"
    assert leading["torque"] == pytest.approx(0.0118, abs=2e-3)
    assert abs(leading["corrected_torque"]) < 0.4 * leading["torque"]
    assert 0.15 < leading["uneven"] < 0.3 and 1.4 < leading["mid_over_side"] < 2
    assert leading["peak"] < -0.1


def test_the_error_is_resolved_against_both_meshes(result):
    plane, solid = result.certain
    assert result.validation.is_model_error_detected
    assert result.validation.error == pytest.approx(plane.values[-1] - solid.values[-1])
    assert (
        max(each.uncertainty_of_finest_torque / each.values[-1] for each in result.certain) < 3e-3
    )


def test_without_lateral_contraction_only_the_table_is_left(result):
    by_nu = dict(result.curves["Poisson's ratio of the lining"])
    assert min(by_nu) == 0 and max(picked(by_nu[0.0], "torque")) > 0.01


def test_one_width_is_within_one_per_cent_and_thin_tables_are_not(result):
    one, table = result.maps
    assert np.abs(one.errors["torque"]).max() < 0.01
    # This is the thinnest table on the narrowest web.
    worst = table.errors["torque"][0, 0]
    assert 0.02 < worst < 0.05 and table.errors["uneven"][0, 0] > 0.4
    assert np.abs(table.errors["corrected_torque"]).max() < 0.01


def test_corrected_all_brakes_are_within_half_of_the_largest_errors(result):
    largest = {}
    for key in ("torque", "pressure", "corrected_torque", "corrected_pressure"):
        maps = [chart.errors[key].ravel() for chart in result.maps]
        errors = [*np.concatenate(maps), *(row[key] for row in swept(result))]
        assert len(errors) > 20
        largest[key] = np.abs(errors).max()
    for rungs in result.ladder.values():
        plane = having(rungs, method="plane stress")[-1]
        corrected = having(rungs, method="plane stress, corrected")[-1]
        assert corrected.torque < 0.6 * plane.torque
        assert corrected.pressure < 0.6 * plane.pressure
    assert largest["corrected_torque"] < 0.3 * largest["torque"]
    assert largest["corrected_pressure"] < 0.3 * largest["pressure"]


def test_the_ladder_prices_every_rung_against_both_truths(result):
    car, post = result.ladder.values()
    assert set(picked(post, "method")) - set(picked(car, "method")) == {
        "foundation",
        "lifted",
    }
    for rungs in (car, post):
        plane, solid, law = (
            having(rungs, method=way)[-1] for way in ("plane stress", "solid", "sine")
        )
        assert solid.torque < plane.torque < law.torque and plane.plane_torque < 0.2 * plane.torque
        assert law.seconds < plane.seconds < solid.seconds


def test_the_reader_is_told_which_brakes_plane_stress_prices():
    errors = {"torque": np.array([[0.3, 0.02], [0.04, 0.009], [0.03, -0.008]])}
    chart = plane_stress.PlaneStressErrorMap(
        "some", ("width", "depth"), np.array([1.0, 2.0]), np.array([1.0, 4.0, 9.0]), errors
    )
    assert chart.describe_range_within_error(0.05) == "width from 2 on or depth from 4 on"
    assert chart.describe_range_within_error(0.01) == "for no whole row or column of the map"
    assert chart.describe_range_within_error(0.4) == "everywhere"
    assert chart.fraction_of_brakes_within_error(0.05) == pytest.approx(5 / 6)


def swept(result):
    return [row for points in result.curves.values() for _, table in points for row in table]


def test_worn_in_the_pressure_is_even_across_the_width_and_the_laws_along_the_arc(result):
    for uneven, law in zip(result.worn.uneven, result.worn.distance_from_sine_law, strict=True):
        assert uneven[0] > 0.15 and uneven[-1] < 2e-3
        assert law[0] > 0.5 and law[-1] < 0.1
        healed = [np.array(uneven) / uneven[0], np.array(law) / law[0]]
        # The pressure becomes even across the width first.
        assert (healed[0][1:] < healed[1][1:]).all()


def test_the_report(module, result, tmp_path):
    text = module.report(result, tmp_path).read_text()
    assert "the worst shoe" in text and "E = S − D" in text
    made = set(picked(tmp_path.iterdir(), "name"))
    assert {
        "map.png",
        "map.svg",
        "face.png",
        "curves.svg",
        "worn.svg",
        "solid.vtu",
        "maps.csv",
        "errors.csv",
    } <= made
    assert "solid.png" in made or "no field picture" in text
