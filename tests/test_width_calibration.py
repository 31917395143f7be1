"""The factors of solid shoes are the smallest sufficient ones, and can be fitted anew."""

import json
import math
from pathlib import Path

import pytest

from drumlin.fem.error_control.estimate import read_safety_factors
from drumlin.fem.width import ladder
from drumlin.fem.width.ladder import SAFETY_FACTORS_OF_SOLID_ERRORS, SafetyFactorsOfSolidErrors
from drumlin_studies.width_calibration import (
    FRACTION_COVERED_BY_STATED_WIDTH_ERROR,
    LARGEST_TRUE_OVER_STATED_ERROR_ALLOWED_IN_FIT,
    LEAST_TRUE_ERROR_IN_FIT_BY_QUANTITY,
    LEAST_TRUE_ERROR_IN_FIT_OVER_ITS_UNCERTAINTY,
    SEEDS_FOR_FIT_TO_ERRORS_OF_SECTION_MESH,
    SEEDS_FOR_FIT_TO_ERRORS_OF_STEPS,
    SEEDS_FOR_FIT_TO_ERRORS_OF_WIDTH_DEGREE,
    EstimatedAndTrueErrorOfSolidShoe,
    fit_safety_factors_of_width_errors,
    read_width_error_rows_from_csv,
    smallest_safety_factor_of_width_errors,
    width_error_rows_as_csv_text,
    width_error_rows_of_random_brake,
    width_safety_factors_as_json_text,
)


@pytest.fixture(scope="module")
def kept(root):
    """The rows that the command `make calibrate` has kept."""
    return read_width_error_rows_from_csv(
        root / "reports" / "reference" / "calibration" / "width_rows.csv"
    )


def made_up(ratios, quantity="pressure"):
    """Rows of one brake each, with these ratios of true errors to estimates."""
    return [
        EstimatedAndTrueErrorOfSolidShoe(
            "free", seed, "width", 2, quantity, 0.01, 0.01 * ratio, unsure=0.0
        )
        for seed, ratio in enumerate(ratios)
    ]


def test_the_factors_are_those_of_the_kept_rows(kept):
    assert fit_safety_factors_of_width_errors(kept) == SAFETY_FACTORS_OF_SOLID_ERRORS
    brakes = {(row.part, row.kind, row.seed) for row in kept}
    for part, kinds in (
        ("width", SEEDS_FOR_FIT_TO_ERRORS_OF_WIDTH_DEGREE),
        ("two levels", SEEDS_FOR_FIT_TO_ERRORS_OF_SECTION_MESH),
        ("section", SEEDS_FOR_FIT_TO_ERRORS_OF_SECTION_MESH),
    ):
        for kind, seeds in kinds.items():
            own = {seed for one, two, seed in brakes if (one, two) == (part, kind)}
            assert own <= set(seeds)
            assert len(own) >= 0.9 * len(seeds)
    # Some brakes have one width, or a truth that takes too long.
    steps = [(kind, seed) for part, kind, seed in brakes if part == "pieces"]
    assert all(seed in SEEDS_FOR_FIT_TO_ERRORS_OF_STEPS[kind] for kind, seed in steps)
    assert len(steps) >= 0.5 * sum(map(len, SEEDS_FOR_FIT_TO_ERRORS_OF_STEPS.values()))


def test_the_errors_that_were_observed_are_stated(kept):
    """Nearly all true errors are below the stated ones, and none is more than twice as large."""
    for part, pressure, force in (
        ("width", SAFETY_FACTORS_OF_SOLID_ERRORS.pressure, SAFETY_FACTORS_OF_SOLID_ERRORS.force),
        (
            "pieces",
            SAFETY_FACTORS_OF_SOLID_ERRORS.pieces_pressure,
            SAFETY_FACTORS_OF_SOLID_ERRORS.pieces_force,
        ),
        (
            "two levels",
            SAFETY_FACTORS_OF_SOLID_ERRORS.two_levels_pressure,
            SAFETY_FACTORS_OF_SOLID_ERRORS.two_levels_force,
        ),
        (
            "section",
            SAFETY_FACTORS_OF_SOLID_ERRORS.section_pressure,
            SAFETY_FACTORS_OF_SOLID_ERRORS.section_force,
        ),
    ):
        for names, factor in ((("pressure",), pressure), (("torque", "reaction"), force)):
            ratios = [
                factor * row.estimate / row.true
                for row in kept
                if row.part == part and row.quantity in names and row.is_row_usable_for_fit
            ]
            assert len(ratios) > 9
            assert sum(ratio < 1 for ratio in ratios) <= max(
                2, (1 - FRACTION_COVERED_BY_STATED_WIDTH_ERROR) * len(ratios)
            )
            assert min(ratios) > 0.99 / LARGEST_TRUE_OVER_STATED_ERROR_ALLOWED_IN_FIT


def test_the_smallest_factor_covers_all_but_the_share_that_may_be_missed():
    many = made_up([k / 1000 for k in range(1, 1001)])
    assert 0.99 <= smallest_safety_factor_of_width_errors(many) <= 1.0
    # Of few brakes all but one are covered, if it is not missed by more than twice.
    few = made_up([0.5] * 20 + [0.6])
    assert 0.5 <= smallest_safety_factor_of_width_errors(few) < 0.6
    missed = made_up([0.5] * 20 + [3.0])
    assert smallest_safety_factor_of_width_errors(missed) == pytest.approx(
        3.0 / LARGEST_TRUE_OVER_STATED_ERROR_ALLOWED_IN_FIT
    )


def test_errors_that_are_nothing_are_left_out():
    tiny = [
        row._replace(true=0.5 * LEAST_TRUE_ERROR_IN_FIT_BY_QUANTITY["pressure"])
        for row in made_up([1.0])
    ]
    assert math.isnan(smallest_safety_factor_of_width_errors(tiny))
    assert smallest_safety_factor_of_width_errors([*tiny, *made_up([1.0, 1.0])]) == 1.0


def test_errors_that_the_truth_does_not_know_are_left_out():
    known = made_up([1.0, 1.0])
    doubtful = [
        row._replace(unsure=1.1 * row.true / LEAST_TRUE_ERROR_IN_FIT_OVER_ITS_UNCERTAINTY)
        for row in made_up([9.0] * 3)
    ]
    assert smallest_safety_factor_of_width_errors([*known, *doubtful]) == 1.0
    surer = [
        row._replace(unsure=0.9 * row.true / LEAST_TRUE_ERROR_IN_FIT_OVER_ITS_UNCERTAINTY)
        for row in doubtful
    ]
    assert smallest_safety_factor_of_width_errors([*known, *surer]) == pytest.approx(9.0)


def test_where_degrees_are_more_exact_than_the_truth_their_errors_are_not_fitted(kept):
    """Degrees 5 to 7 agree to 1e-5 of the torque, and the truth is 2e-4 away from all of them."""
    own = ("width", "built", 3105, "torque")
    rows = [row for row in kept if (row.part, row.kind, row.seed, row.quantity) == own]
    assert [row.degree for row in rows if row.is_row_usable_for_fit] == [2]


def test_the_file_that_the_code_reads_was_written_by_the_command(kept):
    path = Path(ladder.__file__).with_name("factors.json")
    data = json.loads(path.read_text(encoding="utf-8"))
    written = data["provenance"]
    text = width_safety_factors_as_json_text(
        SAFETY_FACTORS_OF_SOLID_ERRORS, kept, written["commit"], written["date"]
    )
    assert path.read_text(encoding="utf-8") == text
    assert SafetyFactorsOfSolidErrors(**read_safety_factors(path)) == SAFETY_FACTORS_OF_SOLID_ERRORS
    assert written["commit"] and written["date"]


@pytest.mark.parametrize(
    ("observed", "parts", "seed"),
    [("width", ["width"], 1002), ("section", ["two levels", "section"], 1014)],
)
def test_what_is_observed_today_is_what_was_kept(kept, tmp_path, observed, parts, seed):
    kind = "free"
    rows = width_error_rows_of_random_brake(observed, kind, seed)
    (tmp_path / "rows.csv").write_text(width_error_rows_as_csv_text(rows), encoding="utf-8")
    old = [row for row in kept if row.part in parts and (row.kind, row.seed) == (kind, seed)]
    assert len(old) == len(rows) > 0
    for one, two in zip(read_width_error_rows_from_csv(tmp_path / "rows.csv"), old, strict=True):
        assert one[:5] == two[:5]
        assert one.estimate == pytest.approx(two.estimate, rel=1e-2, abs=1e-8)
        assert one.true == pytest.approx(two.true, rel=1e-2, abs=1e-8)
        assert one.unsure == pytest.approx(two.unsure, rel=1e-2, abs=1e-8)
