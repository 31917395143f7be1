"""Every promise names a test that exists; the page of promises is in the fault study."""

import pytest

from conftest import ROOT
from drumlin.studies import import_study_and_find_folder_above_studies
from drumlin_studies.fuzzing import trials
from drumlin_studies.fuzzing.endings import describe_fault_of_run
from drumlin_studies.fuzzing.promises import PROMISES_WITH_THEIR_TESTS
from judged_endings import BAD, GIVEN
from picking import picked


def test_each_promise_names_a_test_that_exists():
    for row in PROMISES_WITH_THEIR_TESTS:
        file, _, name = row["test"].partition("::")
        path, said = (
            (ROOT / "tests" / file, f"def {name}(") if file.endswith(".py") else (ROOT / file, name)
        )
        assert said in path.read_text(encoding="utf-8"), row
    assert (
        len(set(picked(PROMISES_WITH_THEIR_TESTS, "promise")))
        == len(PROMISES_WITH_THEIR_TESTS)
        > 20
    )


@pytest.mark.slow
def test_the_short_fault_study_finds_no_fault_and_shows_one(tmp_path):
    module, _ = import_study_and_find_folder_above_studies("faults")
    result = module.study(short=True)
    page = module.report(result, tmp_path).read_text(encoding="utf-8")
    assert "no fault" in page and "test_faults.py::" in page and "143" in page
    assert "commit 17da584" in page and "several lines" in page
    result.within["words"][0] = trials.InputVerdict(0, 1, 0.1, "x: a traceback")
    assert "1 faults" in module.report(result, tmp_path).read_text(encoding="utf-8")
    assert trials.rows_of_verdict_counts_by_generator(result.within)[-1]["faults"] == 1


def test_a_wrong_table_is_a_fault(monkeypatch):
    """Of a damaged journal: the judge knows the right table."""
    wrong = trials.make_numbered_input_of_generator("journals", 0)._replace(
        right={"t.csv": b"case,\n"}
    )
    monkeypatch.setitem(trials.INPUT_GENERATORS_BY_NAME, "journals", (lambda _: wrong, ""))
    assert "not the right t.csv" in trials.run_and_judge_input("journals", 0).fault


def test_every_kind_of_fault_has_a_name():
    """In the table of what an earlier drumlin did of the same inputs."""
    import_study_and_find_folder_above_studies("faults")
    from studies.faults import before

    kinds = {
        case: before.fault_kind(describe_fault_of_run(GIVEN, end), end.status)
        for case, end in BAD.items()
    }
    assert "other" not in kinds.values()
    assert kinds["traceback"] == "traceback" and kinds["nan"] == kinds["CSV"] == "not finite"
    assert before.fault_kind("status -24: ", -24) == "hang"
