"""A changed rule for refining meshes is judged by the level at which each solve would stop."""

import math

import pytest

from drumlin.fem.error_control.estimate import (
    QUANTITIES_WITH_STATED_ERROR,
    SafetyFactorsOfErrorEstimate,
)
from drumlin.fem.error_control.levels import RULE_OF_DEGREE_AND_GRADING
from drumlin_studies.calibration import TrueErrorsAndEstimateTermsOnLevel
from drumlin_studies.level_rules import (
    LevelErrorsAndTimesByRule,
    find_mesh_at_which_refinement_stops,
    refinement_rule_with_changed_numbers,
    report_text_on_refinement_rule,
)

FACTORS = SafetyFactorsOfErrorEstimate(pressure=0.5, force=0.5, cancelled=0.1, peak=1.0)


def level(step, chance=0.0, true=1e-9):
    """A level on which every quantity differs by `step` from the level before."""
    return TrueErrorsAndEstimateTermsOnLevel(
        step=dict.fromkeys(QUANTITIES_WITH_STATED_ERROR, step),
        chance=dict.fromkeys(QUANTITIES_WITH_STATED_ERROR, chance),
        beside=dict.fromkeys(QUANTITIES_WITH_STATED_ERROR, 1e-6),
        true=dict.fromkeys(QUANTITIES_WITH_STATED_ERROR, true),
        unsure=dict.fromkeys(QUANTITIES_WITH_STATED_ERROR, 0.0),
    )


BRAKE = LevelErrorsAndTimesByRule([level(1e-2), level(1e-3), level(1e-4)], [1.0, 2.0, 4.0, 8.0])


@pytest.mark.parametrize(
    ("tolerance", "seconds", "reached"),
    [(1e-2, 3.0, True), (1e-3, 7.0, True), (1e-4, 15.0, True), (1e-5, 15.0, False)],
)
def test_a_solve_stops_at_the_first_level_that_suffices(tolerance, seconds, reached):
    found = find_mesh_at_which_refinement_stops(BRAKE, FACTORS, tolerance, tolerance)
    assert (found.seconds, found.reached) == (seconds, reached)


def test_errors_are_stated_by_the_factors_of_the_estimate():
    found = find_mesh_at_which_refinement_stops(
        LevelErrorsAndTimesByRule([level(1e-2, chance=1e-2)], [1.0, 1.0]), FACTORS, 1.0, 1.0
    ).stated
    assert found["peak"] == pytest.approx(1e-2 + 1e-6)
    assert found["pressure"] == pytest.approx(5e-3 + 1e-6)
    assert found["torque"] == found["reaction"] == pytest.approx(6e-3 + 1e-6)


def test_a_rule_is_reported_by_what_a_user_would_see():
    brakes = [
        LevelErrorsAndTimesByRule([level(1e-2, true=2e-3), level(1e-3, true=2e-4)], [1.0, 1.0, 2.0])
    ] * 4
    text = report_text_on_refinement_rule(brakes)
    assert "default: 16.0 s, 0.0 % reached" in text
    assert "1e-3: 16.0 s, 100.0 % reached" in text
    assert "pressure: median 1.0, 0 of 4 too small" in text


def test_words_change_numbers_of_the_rule():
    rule = refinement_rule_with_changed_numbers(["fall=6", "first_degree=4"])
    assert (rule.fall, rule.first_degree, rule.sizes) == (6.0, 4, RULE_OF_DEGREE_AND_GRADING.sizes)
    assert math.isclose(rule.refinement_level_with_number(2).degree, 5)
    with pytest.raises(ValueError, match="fal"):
        refinement_rule_with_changed_numbers(["fal=6"])
