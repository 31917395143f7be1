"""Brakes with widths solved to a tolerance: stated against true errors, and refusals."""

import json
from functools import partial

import pytest

from command_line import drumlin
from drumlin.base.errors import NoAnswer
from drumlin.brake.file import vary
from drumlin.fem import solid
from drumlin.fem.error_control.adapt import Tolerance
from drumlin.fem.error_control.levels import LEVELS
from drumlin.fem.error_control.singular_points import singular_points_of_all_linings
from drumlin.fem.model import PENALTY, solve_prepared_model
from drumlin.fem.preparation.cache import Cache
from drumlin.fem.solve import solve
from drumlin.fem.width.error import distance_of_plane_stress_from_widths
from drumlin.fem.width.functions import WidthFunctions
from drumlin.fem.width.ladder import (
    SOLID_FACTORS,
    ErrorFactors,
    coarsest_level_within_tolerance,
    hp_elements_to_compare_width_degrees,
    smallest_width_degree_within_tolerance,
    solve_brake_with_widths_to_tolerance,
    solve_level_of_section_with_width_degree,
    solve_levels_up_to_tolerance,
)
from drumlin.fem.width.prepare import prepare_brake_with_widths
from drumlin_studies.solid_error import (
    DRAWN,
    JUDGED_ERRORS,
    SolidErrorRow,
    functions_across_width_graded_to_sides,
    response_with_graded_width_functions,
    table_lines_of_stated_over_true_quantiles,
    table_lines_of_stated_plane_stress_errors,
)
from sections import t_section

GRADED = WidthFunctions((0.0, 17e-3, 20e-3), 4)
"""Functions for one width of 40 mm that leave 1e-5 of the torque."""


@pytest.fixture(scope="module")
def truth(brake):
    """The answer of the main brake on the second level, with functions graded to the side."""
    start = solve(brake)
    points = singular_points_of_all_linings(brake, start)
    scene = prepare_brake_with_widths(brake, LEVELS[1], lambda shoe: GRADED, points)
    return solve_prepared_model(scene, brake, start=start)


@pytest.mark.parametrize("tolerance", [2e-2, 5e-3, 2e-3])
def test_stated_errors_are_above_the_true_ones_and_below_the_tolerance(brake, truth, tolerance):
    found = solve_brake_with_widths_to_tolerance(brake, Tolerance(tolerance, tolerance))
    true = distance_of_plane_stress_from_widths(brake, found, truth).brake
    assert found.error["pressure"] < tolerance
    assert found.error["torque"] < tolerance
    # Two parts of the error of the torque may cancel, so that only p tells errors far too large.
    assert found.error["pressure"] < 6 * true["pressure"]
    for name, error in true.items():
        assert error < found.error[name], name


@pytest.mark.slow
def test_a_finer_tolerance_takes_a_finer_section_or_a_higher_degree(brake):
    coarse, fine = (
        solve_brake_with_widths_to_tolerance(brake, Tolerance(t, t)) for t in (5e-2, 1e-3)
    )
    assert coarse.shoes[0].order < fine.shoes[0].order
    assert "degree 2 across the width" in coarse.notes[-1]
    assert "degree 2 across the width" not in fine.notes[-1]


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "seed"), [("T", 0), ("built", 3100), ("free", 3207)])
def test_with_several_widths_stated_errors_are_above_the_true_ones(brake, kind, seed):
    drawn = t_section(brake) if kind == "T" else DRAWN[kind](seed)
    found = solve_brake_with_widths_to_tolerance(drawn, Tolerance(2e-2, 2e-2), must=False)
    truth = response_with_graded_width_functions(drawn, LEVELS[1])
    for name, error in distance_of_plane_stress_from_widths(drawn, found, truth).brake.items():
        assert error < found.error[name], name


@pytest.mark.slow
def test_beside_a_web_the_width_has_its_part_in_the_error():
    brake, level = DRAWN["free"](2000), LEVELS[0]
    plane = solve(brake)
    section = hp_elements_to_compare_width_degrees(brake, plane)
    points = singular_points_of_all_linings(
        brake, plane, error=level.pressure_error_by_column_ratio
    )

    def on_level(across):
        """The answer on one section, on which the section's part of the error cancels."""
        scene = prepare_brake_with_widths(brake, level, across, points)
        return solve_prepared_model(scene, brake, start=plane)

    truth = on_level(functions_across_width_graded_to_sides)
    for allowed in (3e-2, 2e-2, 1e-2):
        found = smallest_width_degree_within_tolerance(
            brake, plane, section, Tolerance(allowed, allowed)
        )
        true = distance_of_plane_stress_from_widths(brake, on_level(found.degree), truth).brake
        assert true["torque"] < found.error.torque
        assert true["pressure"] < found.error.shoes[0]["pressure"] < 6 * true["pressure"]


@pytest.mark.slow
def test_a_tolerance_that_is_out_of_reach_is_refused_and_says_what_was_reached(brake):
    with pytest.raises(NoAnswer, match=r"tolerance 1e-07 not reached .*: estimated error of p"):
        solve_brake_with_widths_to_tolerance(brake, Tolerance(1e-7, 1e-7))


def test_without_contraction_one_width_is_plane_stress(flexible):
    changes = {"shoe.lining.material.nu": 0.0, "shoe.body.material.nu": 0.0}
    brake = vary(flexible, changes)
    found, plane = solve_brake_with_widths_to_tolerance(brake, Tolerance(1e-2, 1e-2)), solve(brake)
    assert found.torque == pytest.approx(plane.torque, rel=found.error["torque"])
    assert found.error["torque"] < 1e-4


def test_the_command_line_takes_a_tolerance_for_solid_shoes(root, truth, tmp_path):
    file = root / "studies" / "double_shoe" / "brake.toml"
    done = drumlin(
        "solve", file, "--model", "solid", "--tolerance", "0.01", "--json", tmp_path / "a.json"
    )
    assert done.returncode == 0, done.stderr
    data = json.loads((tmp_path / "a.json").read_text())
    assert data["model"] == "solid"
    assert data["torque"] == pytest.approx(truth.torque, rel=data["error"]["torque"])
    # The pressure of the face is as wide as the lining, and its mean is that of the curve.
    surface = data["shoes"][0]["surface"]
    assert surface["z"][0] == -surface["z"][-1] == pytest.approx(-20e-3)
    assert "plane_stress_error" not in data


@pytest.mark.slow
def test_divisions_follow_the_contact_that_the_width_has_found():
    brake = DRAWN["free"](2000)
    plane = solve(brake)
    first, second = (
        solve_level_of_section_with_width_degree(brake, level, 2, plane).response
        for level in LEVELS[:2]
    )
    # With elements for the contact of plane stress the two levels differ by 3.7 %.
    moved = distance_of_plane_stress_from_widths(brake, first, second).brake
    assert moved["pressure"] < 5e-3


@pytest.mark.slow
def test_the_error_of_the_section_beside_a_web_covers_that_of_a_higher_degree():
    brake, loose = DRAWN["built"](3111), Tolerance(0.1, 0.1)
    plane, answer = solve(brake), partial(solve_prepared_model, penalty=PENALTY)
    climb = solve_levels_up_to_tolerance(brake, loose, answer, Cache(), LEVELS[:2], plane)
    factors = ErrorFactors(SOLID_FACTORS.section_pressure, SOLID_FACTORS.section_force)
    section = coarsest_level_within_tolerance(brake, climb, loose, factors)
    first, second = (
        solve_level_of_section_with_width_degree(brake, level, 3, plane).response
        for level in LEVELS[:2]
    )
    moved = distance_of_plane_stress_from_widths(brake, first, second).brake
    assert section.level == LEVELS[0]
    assert moved["pressure"] < section.error.largest_pressure_error < 2 * moved["pressure"]


def test_without_options_solid_shoes_state_their_errors(brake, truth):
    found = solid.solve(brake)
    true = distance_of_plane_stress_from_widths(brake, found, truth).brake
    for name, error in true.items():
        assert error < found.error[name] < 1e-2, name


def test_the_table_of_solid_errors_counts_the_too_small_ones():
    # A row whose truth is as uncertain as the true error is counted as reached, and not judged.
    unjudged = 0.1

    def row(ratio, reached):
        """A row with this ratio of stated to true errors."""
        names = dict.fromkeys(JUDGED_ERRORS, 1e-3)
        stated = dict.fromkeys(JUDGED_ERRORS, ratio * 1e-3)
        unsure = dict.fromkeys(JUDGED_ERRORS, 1e-3 if ratio == unjudged else 1e-6)
        plane_true = dict.fromkeys(JUDGED_ERRORS, 0.02)
        plane_stated = dict.fromkeys(JUDGED_ERRORS, ratio * 0.02)
        cost = 10 * ratio
        return SolidErrorRow(
            "t", names, stated, unsure, cost, reached, "how", plane_true, plane_stated
        )

    rows = [row(0.5, True), row(3.0, True), row(4.0, False), row(unjudged, True)]
    _, torque, *_, reached, cost = table_lines_of_stated_over_true_quantiles(rows)
    assert torque.split()[:4] == ["torque", "3", "33%", "0.50"]
    assert reached == "75% of 4 brakes reach the tolerance"
    assert cost.startswith("18 times")
    small = row(1.0, True)._replace(plane_true=dict.fromkeys(JUDGED_ERRORS, 1e-3))
    unknown = row(1.0, True)._replace(plane_stated={})
    _, torque, *_ = table_lines_of_stated_plane_stress_errors(
        [*rows, row(1.4, True), small, unknown]
    )
    # Of the ratios 0.5, 3, 4, 0.1 and 1.4 the last one is good, and 0.1 is poor.
    assert torque.split() == ["torque", "5", "20%", "20%", "0.10", "1.40", "4.00"]
