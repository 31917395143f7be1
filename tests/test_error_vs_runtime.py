"""The study of error against run time in its short form, stopped midway and continued."""

import math
from dataclasses import replace
from itertools import chain

import pytest

import independent
from drumlin.base.errors import BadInput
from drumlin.base.journal import JournalOfCaseResults
from drumlin.fem.solve import solve
from drumlin.studies import import_study_and_find_folder_above_studies
from drumlin.verification.reference import (
    ResponsesBehindReferenceValues,
    solve_brake_for_reference_values,
)
from drumlin_studies import work_precision
from drumlin_studies.recommendation import (
    QUANTITY_NAMES_BY_ERROR_KEY,
    recommended_methods_by_brake_and_target,
    rows_of_fastest_methods_by_target,
)
from drumlin_studies.work_precision import (
    ROW_KEYS_OF_RELATIVE_ERRORS,
    SolutionMethodOfBrake,
    measure_call_time_over_unit_workload,
    measure_drumlin_method_on_brake,
    relative_uncertainties_of_reference_responses,
)
from picking import having, picked, saying
from shared_parts import scaled_pressures

pytestmark = pytest.mark.slow

MAIN = "double_shoe/brake"


class Stopped(Exception):
    """The run is killed here."""


class Stopping(JournalOfCaseResults):
    """A journal whose run is killed after so many cases."""

    def __init__(self, path, cases):
        super().__init__(path)
        self.left = cases

    def add(self, case, row):
        if self.left == 0:
            raise Stopped
        self.left -= 1
        super().add(case, row)


@pytest.fixture(scope="module")
def outcome(tmp_path_factory):
    """The study's module, its result after two interruptions, and its journal at each of them."""
    path = tmp_path_factory.mktemp("study") / "journal.jsonl"
    module, _ = import_study_and_find_folder_above_studies("error_vs_runtime")
    kept, references = [], {}

    def once(brake, refinement):
        """The reference of a brake: the stopped runs and the whole one need the same."""
        key = brake.model_dump_json()
        return (
            references[key]
            if key in references
            else references.setdefault(key, solve_brake_for_reference_values(brake, refinement))
        )

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "solve_brake_for_reference_values", once)
        # No test here asks for the times closely.
        patch.setattr(work_precision, "LEAST_REPEATS_OF_TIMING", 3)
        for cases in (1, 6):
            with Stopping(path, cases) as journal, pytest.raises(Stopped):
                module.study(short=True, journal=journal)
            kept.append(path.read_text())
        with JournalOfCaseResults(path) as journal:
            assert len(journal) == 7
            return module, module.study(short=True, journal=journal), kept, path.read_text()


@pytest.fixture(scope="module")
def rows(outcome):
    return having(outcome[1].rows, brake=MAIN)


def pick(rows, family, **options):
    return next(
        r for r in rows if r["family"] == family and all(r.get(k) == v for k, v in options.items())
    )


def test_a_stopped_run_goes_on_and_keeps_every_row(outcome):
    _, result, (first, second), whole = outcome
    assert second.startswith(first) and whole.startswith(second)
    keys = picked(result.rows, ("brake", "family", "method"))
    assert len(set(keys)) == len(keys) == len(saying(whole.splitlines(), '\\"family\\"'))
    assert set(result.floors) == {MAIN, "laws/shigley_16_2"}


def test_finite_elements_know_more_than_laws_and_laws_are_faster(rows):
    fem, law = pick(rows, "graded mesh", kind="quad2", elements=40), pick(rows, "law", model="sine")
    truth = independent.torque("double_shoe/brake")
    assert law["torque_error"] == pytest.approx(abs(independent.SINE_LAW / truth - 1), abs=5e-5)
    for key in ROW_KEYS_OF_RELATIVE_ERRORS:
        assert fem[key] < 0.1 * law[key]
    assert law["seconds"] < fem["seconds"] / 3
    assert fem["further"] < fem["seconds"] / 3
    # The law has nothing to reuse, so that a further answer takes as long as the first.
    assert law["further"] > law["seconds"] / 3


def test_grading_and_order_pay(rows):
    graded, even = (
        pick(rows, family, kind="quad2", elements=40) for family in ("graded mesh", "even mesh")
    )
    linear = pick(rows, "graded mesh", kind="tri1", elements=40)
    assert graded["pressure_error"] < 0.5 * even["pressure_error"]
    assert graded["torque_error"] < 0.01 * linear["torque_error"]


def test_columns_know_more_for_their_unknowns_and_keep_the_tolerance_that_they_state(rows):
    mesh, columns = (
        pick(rows, "graded mesh", kind="quad2", elements=40),
        pick(rows, "columns", level=0),
    )
    assert columns["unknowns"] < 1.25 * mesh["unknowns"]
    assert columns["pressure_error"] < 0.15 * mesh["pressure_error"]
    assert pick(rows, "columns, error stated")["pressure_error"] < 5e-3
    assert columns["pressure_error"] > 3 * pick(rows, "columns", level=1)["pressure_error"]


def test_the_textbook_contact_is_slower_and_less_exact_on_the_same_mesh_and_its_failures_stay(rows):
    weak, textbook = (
        pick(rows, family, elements=40, penalty=1e3)
        for family in ("weak penalty", "pointwise penalty")
    )
    assert textbook["unknowns"] == weak["unknowns"]
    assert textbook["pressure_error"] > 2 * weak["pressure_error"]
    assert textbook["seconds"] > 1.2 * weak["seconds"]
    assert textbook["further"] > 5 * weak["further"]
    stiff = pick(rows, "pointwise penalty", penalty=1e6)
    assert stiff["status"].startswith("failed: shoe") and "torque_error" not in stiff
    assert pick(rows, "weak penalty", penalty=1e6)["status"] == "converged"


def test_the_floor_lies_below_what_is_claimed(outcome):
    result = outcome[1]
    for name, floors in result.floors.items():
        assert 0 < floors["torque_error"] < 1e-6 and floors["pressure_error"] < 1e-3
        for row in rows_of_fastest_methods_by_target(result.rows, result.floors):
            if row["brake"] == name and "error" in row:
                key = next(
                    k for k, said in QUANTITY_NAMES_BY_ERROR_KEY.items() if said == row["quantity"]
                )
                assert floors[key] < row["target"] and row["error"] <= row["target"]


def test_every_converged_row_is_whole(outcome):
    for row in outcome[1].rows:
        if row["status"] == "converged":
            assert row["lower"] <= row["seconds"] <= row["upper"] and row["repeats"] >= 3
            assert 1e5 < row["memory"] < 1e9
            for key in ROW_KEYS_OF_RELATIVE_ERRORS:
                assert math.isfinite(row[key])


def test_report(outcome, tmp_path):
    module, result, _, _ = outcome
    text = module.report(result, tmp_path).read_text()
    for said in (
        "What to use",
        "Deliberately not covered",
        "laws/pivoted_block",
        "repeats itself",
        "Reference values",
        " for p (",
    ):
        assert said in text
    for matrix in recommended_methods_by_brake_and_target(
        rows_of_fastest_methods_by_target(result.rows, result.floors)
    ):
        cells = list(chain.from_iterable(matrix.lines.values()))
        assert {cell.row["target"] for cell in cells} == set(matrix.targets)
        for cell in cells:
            assert f'<td class="text {cell.sort}">{cell.what}<' in text
    assert (tmp_path / "work_precision_double_shoe_brake.png").stat().st_size > 20_000
    assert (tmp_path / "values" / "double_shoe_brake.json").exists()
    assert len((tmp_path / "results.csv").read_text().splitlines()) == len(result.rows) + 1


def test_methods_that_do_not_apply_are_rows(brake):
    rows = [
        measure_drumlin_method_on_brake(
            brake,
            SolutionMethodOfBrake("foundation", "f", {"model": "foundation"}),
            None,
            lambda: None,
        ),
        measure_drumlin_method_on_brake(
            brake,
            SolutionMethodOfBrake("weak penalty", "w", {"elements": 4, "penalty": -1.0}),
            None,
            lambda: None,
        ),
    ]
    for row in rows:
        assert row["status"].startswith("refused: --")
    with pytest.raises(BadInput):
        import_study_and_find_folder_above_studies("no_such_study")


def test_times_are_medians_of_enough_repeats_beside_the_unit():
    def work(n):
        return lambda: sum(range(n))

    found = measure_call_time_over_unit_workload(work(20_000), work(10_000), 1e-4)
    assert found.lower <= found.seconds <= found.upper
    assert found.repeats >= 5
    assert 1 < found.ratio < 4


def test_the_floor_is_the_distance_of_both_references_whose_shoes_do_not_cancel(brake):
    one = solve(brake, elements=10)
    other = replace(
        one,
        shoes=tuple(
            replace(s, torque=s.torque + d) for s, d in zip(one.shoes, (1, -1), strict=True)
        ),
    )
    assert other.torque == pytest.approx(one.torque, rel=1e-12)
    assert relative_uncertainties_of_reference_responses(
        brake, ResponsesBehindReferenceValues(one, one, other)
    )["torque_error"] == pytest.approx(2 / one.torque, rel=1e-12)
    peaks = replace(one, shoes=scaled_pressures(one.shoes, 1.01))
    found = relative_uncertainties_of_reference_responses(
        brake, ResponsesBehindReferenceValues(one, peaks, None)
    )
    assert [found["pressure_error"], found["peak_error"]] == pytest.approx([0.01, 0.01], rel=1e-9)
    assert set(
        relative_uncertainties_of_reference_responses(
            brake, ResponsesBehindReferenceValues(one, one, one)
        ).values()
    ) == {0.0}
