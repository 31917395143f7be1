"""The factors of the error estimate are the smallest sufficient ones, and can be fitted anew."""

import json
import math
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from drumlin.fem.error_control import estimate
from drumlin.fem.error_control.estimate import (
    QUANTITIES_WITH_STATED_ERROR,
    SAFETY_FACTORS_OF_ERROR_ESTIMATE,
    SafetyFactorsOfErrorEstimate,
    read_safety_factors,
)
from drumlin.fem.error_control.levels import solve_brake_on_finer_and_finer_mesh_levels
from drumlin.fem.model import solve_prepared_model
from drumlin.studies import import_study_and_find_folder_above_studies
from drumlin_studies.calibration import (
    FRACTION_COVERED_BY_STATED_ERROR,
    OriginOfSafetyFactors,
    TrueErrorsAndEstimateTermsOnLevel,
    draw_random_calibration_brake_and_name_of_kind,
    error_estimate_factors_as_json_text,
    fit_safety_factors,
    true_and_estimated_errors_of_quantity,
    true_errors_and_estimates_on_each_mesh,
)
from drumlin_studies.stated_true import SMALLEST_RELEVANT_TRUE_ERROR
from drumlin_studies.stored_truth import solve_brake_by_finer_hp_meshes
from picking import picked

PROVENANCE = OriginOfSafetyFactors("1 to 3", 3, 9, "abc", "2000-01-01")


def made_up(count, part, beside=1e-9, seed=0):
    """Invented levels whose true errors are random fractions, at most `part`, of their changes.

    Each level also has the change of the force if the elements contributed with random signs.
    """
    rng = np.random.default_rng(seed)
    levels = []
    for share in np.linspace(0, 1, count):
        step = dict.fromkeys(QUANTITIES_WITH_STATED_ERROR, 10 ** rng.uniform(-4, -2))
        true = {
            name: part[name] * share * step[name] + beside for name in QUANTITIES_WITH_STATED_ERROR
        }
        levels.append(
            TrueErrorsAndEstimateTermsOnLevel(
                step,
                dict.fromkeys(QUANTITIES_WITH_STATED_ERROR, 0.0),
                dict.fromkeys(QUANTITIES_WITH_STATED_ERROR, beside),
                true,
                dict.fromkeys(QUANTITIES_WITH_STATED_ERROR, 0.0),
            )
        )
    return levels


def test_the_fit_finds_the_factors_that_cover_all_but_the_share_that_may_be_missed():
    part = {"pressure": 0.5, "torque": 0.3, "peak": 0.9, "reaction": 0.7}
    levels = made_up(2000, part)
    found = fit_safety_factors(levels)
    for value, most in ((found.pressure, 0.5), (found.peak, 0.9), (found.force, 0.7)):
        assert 0.99 * FRACTION_COVERED_BY_STATED_ERROR * most <= value <= 1.05 * most
    for name, factor in (("pressure", found.pressure), ("peak", found.peak)):
        ratios = true_and_estimated_errors_of_quantity(levels, name).stated_over_true_errors(
            factor, 0.0
        )
        assert np.mean(ratios < 1) <= 1 - FRACTION_COVERED_BY_STATED_ERROR


def test_errors_that_steps_miss_by_accident_are_covered_by_what_does_not_cancel():
    """An error far above its accidentally small step is covered by the cancellation floor.

    In one level of ten the contributions of the elements cancel, so that the change is a
    thousandth.
    """
    rng = np.random.default_rng(1)
    levels = []
    for _ in range(2000):
        size = 10 ** rng.uniform(-4, -2)
        step = size * (1e-3 if rng.random() < 0.1 else 1.0)
        true = dict.fromkeys(QUANTITIES_WITH_STATED_ERROR, 0.2 * size)
        levels.append(
            TrueErrorsAndEstimateTermsOnLevel(
                step=dict.fromkeys(QUANTITIES_WITH_STATED_ERROR, step),
                chance=dict.fromkeys(QUANTITIES_WITH_STATED_ERROR, 100 * size),
                beside=dict.fromkeys(QUANTITIES_WITH_STATED_ERROR, 0.0),
                true=true,
                unsure=dict.fromkeys(QUANTITIES_WITH_STATED_ERROR, 0.0),
            )
        )
    found = fit_safety_factors(levels)
    torque = true_and_estimated_errors_of_quantity(levels, "torque")
    assert (
        np.mean(torque.stated_over_true_errors(found.force, found.cancelled / found.force) < 1)
        <= 1 - FRACTION_COVERED_BY_STATED_ERROR
    )
    assert found.cancelled * 100 > 0.15


def test_levels_whose_errors_are_not_known_or_nothing_are_left_out():
    (level,) = made_up(1, dict.fromkeys(QUANTITIES_WITH_STATED_ERROR, 0.5))
    unknown = level._replace(
        true={
            **level.true,
            "peak": math.nan,
            "torque": 0.5 * SMALLEST_RELEVANT_TRUE_ERROR,
            "pressure": 1e-3,
        }
    )
    assert [
        len(true_and_estimated_errors_of_quantity([unknown], name).true)
        for name in ("pressure", "torque", "peak")
    ] == [
        1,
        1,
        0,
    ]
    assert [
        true_and_estimated_errors_of_quantity(
            [unknown], name
        ).mask_of_true_errors_usable_in_fit.tolist()
        for name in ("pressure", "torque")
    ] == [
        [True],
        [False],
    ]


def test_the_file_holds_the_factors_and_what_they_were_fitted_on(tmp_path):
    factors = SafetyFactorsOfErrorEstimate(0.5, 0.6, 0.001, 0.8)
    path = tmp_path / "factors.json"
    path.write_text(error_estimate_factors_as_json_text(factors, PROVENANCE), encoding="utf-8")
    assert SafetyFactorsOfErrorEstimate(**read_safety_factors(path)) == factors
    data = json.loads(path.read_text(encoding="utf-8"))
    assert data["provenance"] == {
        **PROVENANCE._asdict(),
        "quantile": FRACTION_COVERED_BY_STATED_ERROR,
    }
    for name in SafetyFactorsOfErrorEstimate._fields:
        assert len(data[name]["meaning"].split()) > 10


def test_the_file_that_the_code_reads_was_written_by_the_command():
    path = Path(estimate.__file__).with_name("factors.json")
    data = json.loads(path.read_text(encoding="utf-8"))
    written = OriginOfSafetyFactors(
        **{key: data["provenance"][key] for key in OriginOfSafetyFactors._fields}
    )
    assert path.read_text(encoding="utf-8") == error_estimate_factors_as_json_text(
        SAFETY_FACTORS_OF_ERROR_ESTIMATE, written
    )
    assert written.brakes > 200 and written.levels > 1000 and written.commit and written.date


@pytest.fixture(scope="module")
def seen():
    _, brake = draw_random_calibration_brake_and_name_of_kind(300_001)
    return brake, true_errors_and_estimates_on_each_mesh(
        brake,
        solve_brake_by_finer_hp_meshes(brake),
        solve_brake_on_finer_and_finer_mesh_levels(brake, solve_prepared_model),
    )


@pytest.mark.slow
def test_what_is_observed_of_a_level_is_what_a_solve_states(seen):
    brake, levels = seen
    responses = picked(
        solve_brake_on_finer_and_finer_mesh_levels(brake, solve_prepared_model), "response"
    )
    for (before, last), level in zip(pairwise(responses), levels, strict=True):
        stated = estimate.estimate_errors_from_two_mesh_levels(brake, before, last)
        assert stated.brake["pressure"] == pytest.approx(
            SAFETY_FACTORS_OF_ERROR_ESTIMATE.pressure * level.step["pressure"]
            + level.beside["pressure"],
            rel=1e-6,
        )
        assert stated.brake["torque"] == pytest.approx(
            SAFETY_FACTORS_OF_ERROR_ESTIMATE.force * level.step["torque"]
            + SAFETY_FACTORS_OF_ERROR_ESTIMATE.cancelled * level.chance["torque"]
            + level.beside["torque"]
        )
        assert level.true["pressure"] < level.step["pressure"]


@pytest.mark.slow
def test_the_study_writes_the_same_twice(tmp_path):
    module, _ = import_study_and_find_folder_above_studies("calibration")
    for folder in ("one", "other"):
        module.report(module.study(short=True), tmp_path / folder)
    one, other = ((tmp_path / folder / "factors.json").read_bytes() for folder in ("one", "other"))
    assert one == other
    page = (tmp_path / "one" / "index.html").read_text(encoding="utf-8")
    assert "random brakes of every kind" in page and (tmp_path / "one" / "factors.svg").exists()
