"""Sweeps that are certified by a sample: which cases it has, and what the other cases state."""

import numpy as np
import pytest

from conftest import ROOT, STUDY
from drumlin.base.errors import BadInput, NoAnswer
from drumlin.base.journal import JournalOfCaseResults
from drumlin.brake import read_drum_or_plane_brake
from drumlin.brake.file import vary
from drumlin.fem.error_control.estimate import (
    QUANTITIES_WITH_STATED_ERROR,
    relative_differences_of_responses_on_two_levels,
)
from drumlin.fem.error_control.first_level import (
    errors_of_first_refinement_level,
    text_that_identifies_kind_of_contact,
)
from drumlin.fem.solve import solve, solve_brake_on_first_level_without_error_estimate
from drumlin.sweeps import cases as case_solving
from drumlin.sweeps import certificate as certifying
from drumlin.sweeps.cases import (
    ResultOfAttemptAtCase,
    journal_keys_of_cases,
    solve_all_cases_of_sweep,
    solve_case_without_raising,
)
from drumlin.sweeps.certificate import (
    ROW_KEY_OF_FIRST_LEVEL_ERRORS,
    MarkOfSampleCaseSolvedOnAllLevels,
    SampleErrorsForCasesOutsideSample,
)
from drumlin.sweeps.file import sweep_from_file_data
from drumlin.sweeps.sample import solve_sample_cases_and_then_all_others

BRAKE = str(STUDY / "brake.toml")
STUDIES = ROOT / "studies"


def over(first, last, count, **more):
    return {"from": first, "to": last, "count": count} | more


def sweep(vary_, **more):
    return sweep_from_file_data({"brake": BRAKE, "vary": vary_} | more)


FRICTION = {"friction": over(0.1, 0.5, 20)}


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"certify": "every tenth"}, "certify = 'every tenth': allowed"),
        ({"certify": "every ²nd"}, "certify = 'every ²nd': allowed"),
        ({"certify": f"every {'1' * 5000}th"}, "certify = 'every 1111+"),
        ({"certify": "every 1st"}, "certify = 'every 1st': allowed"),
        ({"certify": "every 10th"}, "a sample of 2 of 20 cases"),
        ({"certify": 2}, "certify = 2: is a sample of 2 of 20"),
        ({"certify": 2, "vary": {"friction": [0.2, 0.3]}}, "of 2 cases by .*; allowed: none"),
        ({"certify": 21}, "allowed: 3 to 20"),
        ({"certify": 4, "model": {"sine": {}}}, r"certify = 4: is for \[model.fem\]"),
        (
            {"certify": 4, "model": {"fem": {"elements": 20}}},
            "does not go with model.fem.elements = 20",
        ),
        (
            {"certify": 4, "model": {"fem": {"tolerance": 1e-3}}},
            "does not go with model.fem.tolerance = 0.001",
        ),
        ({"certify": 1.5}, "certify"),
        ({"certify": 10**5000}, r"certify = \(more than 4300 digits\): is a sample of .* 3 to 20"),
        ({"seed": -(10**5000)}, r"seed = \(more than 4300 digits\): must be"),
    ],
)
def test_what_no_sample_can_certify_is_refused_by_its_key(more, words):
    with pytest.raises(BadInput, match=words):
        sweep(FRICTION, **more)


def test_sample_has_every_value_of_an_inner_key_and_the_extremes_of_all():
    keys = {"friction": over(0.1, 0.5, 40), "shoe.lining.thickness": over("6 mm", "10 mm", 10)}
    made = sweep(keys, certify="every 10th", model={"sine": {}, "fem": {}})
    assert all(made.cases[i].model == "fem" for i in made.sample)
    assert 40 <= len(made.sample) <= 44
    taken = [made.cases[i].changes for i in made.sample]
    for key in keys:
        every = {case.changes[key] for case in made.cases}
        found = {changes[key] for changes in taken}
        assert {min(every), max(every)} <= found
        # A fixed step of ten cases would find one thickness only.
        assert len(found) > len(every) / 2
    again = sweep(keys, certify="every 10th", model={"sine": {}, "fem": {}}, seed=1)
    assert again.sample != made.sample
    assert sweep(keys).sample == sweep(keys, certify="every case").sample == ()


def test_rows_say_who_certifies_them_and_go_on_from_a_journal(tmp_path):
    made = sweep({"friction": over(0.25, 0.35, 6)}, certify=3)
    told = []
    rows = solve_sample_cases_and_then_all_others(
        made.cases, made.sample, done=lambda *at: told.append(at)
    ).rows
    assert told[-1] == (6, 6)
    for i, (row, case) in enumerate(zip(rows, made.cases, strict=True)):
        assert row["certified"] == ("itself" if i in made.sample else "sample")
        assert not any(isinstance(value, dict) for value in row.values())
        own = solve_case_without_raising(case).row
        if i in made.sample:
            assert row == own | {"certified": "itself"}
            continue
        # The row states more than its distance from its own last level, and not absurdly more.
        moved = abs(row["torque"] / own["torque"] - 1)
        assert 0 < moved < row["error_torque"] < 1e-2
        assert own["error_pressure"] < row["error_pressure"] < 0.1
    with JournalOfCaseResults(tmp_path / "kept") as journal:
        solve_sample_cases_and_then_all_others(made.cases[:5], made.sample[:2], journal=journal)
        again = solve_sample_cases_and_then_all_others(made.cases, made.sample, journal=journal)
        assert again.rows == rows
        assert all(key in journal for key in journal_keys_of_cases(again.cases))


LOCKED = ResultOfAttemptAtCase({"status": "failed: locks itself"})
LOST = ResultOfAttemptAtCase({"status": "failed: no memory"}, is_kept_in_journal=False)


@pytest.mark.parametrize(
    ("answer", "failed", "said"),
    [
        (LOCKED, [], ""),
        # Of six cases in the sample one may fail, if it has no extreme value and lasts.
        (LOCKED, [1], ""),
        (LOCKED, [-1], "case 19, which has an extreme value, has no errors of its first level"),
        (LOCKED, [0], "case 0, which has an extreme value"),
        (LOCKED, [1, 2, 3, 4], "only 2 of its cases have errors of their first level"),
        (LOST, [1], "a case of the sample failed for a reason that may pass"),
    ],
)
def test_sample_without_enough_errors_certifies_no_case(monkeypatch, answer, failed, said):
    made = sweep(FRICTION, certify=4, seed=3)
    assert len(made.sample) == 6
    without = {made.cases[made.sample[i]].changes["friction"] for i in failed}
    certificates = []

    def answer_without_solving(case, cache=None):
        """The given answer for the failed cases, and errors of 0.1 % for the rest of the sample."""
        if isinstance(case.certify, SampleErrorsForCasesOutsideSample):
            certificates.append(case.certify)
            return ResultOfAttemptAtCase({"status": "solved"})
        if case.changes["friction"] in without:
            return answer
        errors = {"kind": "a kind"} | dict.fromkeys(QUANTITIES_WITH_STATED_ERROR, 1e-3)
        return ResultOfAttemptAtCase({"status": "solved", ROW_KEY_OF_FIRST_LEVEL_ERRORS: errors})

    monkeypatch.setattr(case_solving, "solve_case_without_raising", answer_without_solving)
    lines = []
    solve_sample_cases_and_then_all_others(made.cases, made.sample, say=lines.append)
    assert (
        len(certificates) == 14
        and len(
            set(
                map(
                    SampleErrorsForCasesOutsideSample.text_that_identifies_cases_in_journal,
                    certificates,
                )
            )
        )
        == 1
    )
    assert certificates[0].kinds == (() if said else ("a kind",))
    assert len(lines) == bool(said) and said in "".join(lines)


def test_options_that_are_off_go_with_a_sample():
    made = sweep(FRICTION, certify=4, model={"fem": {"finite_width": False}})
    assert made.sample and made.cases[0].options == {}


def test_tables_and_words_make_kinds_but_numbers_do_not(monkeypatch):
    monkeypatch.setattr(
        certifying, "text_that_identifies_kind_of_contact", lambda brake, response: "same"
    )
    changes = [{"a": value, "b": 0.1 * i} for i, value in enumerate(["x", "y", [[1.0]], [[2.0]]])]
    kinds = {
        certifying._text_that_identifies_kind_of_case(None, change, None)
        for change in [*changes, *changes]
    }
    assert len(kinds) == 4
    assert (
        len({certifying._text_that_identifies_kind_of_case(None, {"b": b}, None) for b in (1, 2.0)})
        == 1
    )


def test_case_of_a_kind_that_the_sample_has_not_certifies_itself(brake):
    (case,) = sweep({"shoe.lining.clearance": ["0.1 mm"]}).cases
    own = solve_all_cases_of_sweep([case])[0]
    strange = SampleErrorsForCasesOutsideSample(
        ("another kind",), dict.fromkeys(QUANTITIES_WITH_STATED_ERROR, 1e-3)
    )
    row = solve_case_without_raising(case._replace(certify=strange)).row
    assert row == own | {"certified": "itself"}
    # Its contact has ends that have lifted off, which the contact of the brake itself has not.
    brakes = brake, vary(brake, case.changes)
    kinds = [
        text_that_identifies_kind_of_contact(
            b, solve_brake_on_first_level_without_error_estimate(b)
        )
        for b in brakes
    ]
    assert "corner" in kinds[0] and kinds[0] != kinds[1]


def test_member_of_sample_takes_first_level_from_its_own_solve(monkeypatch):
    (case,) = sweep({"shoe.lining.clearance": ["0.02 mm"]}).cases
    one = vary(case.brake, case.changes)
    found = errors_of_first_refinement_level(
        one, solve_brake_on_first_level_without_error_estimate(one), solve(one)
    )
    # The division of the brake on the first level is not solved once more.
    monkeypatch.setattr(certifying, "solve_brake_on_first_level_without_error_estimate", None)
    row = solve_case_without_raising(case._replace(certify=MarkOfSampleCaseSolvedOnAllLevels())).row
    assert {
        name: row[ROW_KEY_OF_FIRST_LEVEL_ERRORS][name] for name in QUANTITIES_WITH_STATED_ERROR
    } == found
    assert 1e-4 < found["pressure"] < 0.05


def certificate_of_every_kind(monkeypatch):
    monkeypatch.setattr(
        certifying, "_text_that_identifies_kind_of_case", lambda brake, changes, first: "a kind"
    )
    return SampleErrorsForCasesOutsideSample(
        ("a kind",), dict.fromkeys(QUANTITIES_WITH_STATED_ERROR, 1e-3)
    )


def test_sample_on_a_plane_states_the_error_of_the_braking_force():
    brake = read_drum_or_plane_brake(STUDIES / "brakes" / "rail_clamp.toml")
    first, last = solve_brake_on_first_level_without_error_estimate(brake), solve(brake)
    (true,) = np.abs(np.subtract(first.effects, last.effects)) / last.effects
    errors = errors_of_first_refinement_level(brake, first, last)
    assert 0 < true < errors["torque"] < 1e-3


def test_first_level_that_fails_for_want_of_memory_is_tried_again(monkeypatch):
    (case,) = sweep({"friction": [0.3]}).cases

    def refuse_for_want_of_memory(brake, **options):
        raise NoAnswer("no solution") from MemoryError()

    monkeypatch.setattr(
        certifying, "solve_brake_on_first_level_without_error_estimate", refuse_for_want_of_memory
    )
    certified = case._replace(certify=certificate_of_every_kind(monkeypatch))
    answer = solve_case_without_raising(certified)
    assert answer.again and not answer.is_kept_in_journal


def test_brake_that_is_not_modelled_is_refused_as_without_a_sample(monkeypatch):
    file = str(STUDIES / "brakes" / "s_cam.toml")
    (case,) = sweep({"shoe.lining.clearance": ["0 mm"]}, brake=file).cases
    hot = case._replace(changes={"shoe.lining.temperature_rise": 50.0})
    hot = hot._replace(changes=hot.changes | {"shoe.lining.material.expansion": 1e-5})
    own = solve_case_without_raising(hot).row
    assert "a cam on heated shoes is not modelled" in own["status"]
    certificate = certificate_of_every_kind(monkeypatch)
    assert solve_case_without_raising(hot._replace(certify=certificate)).row == own
    cold = solve_case_without_raising(case._replace(certify=certificate)).row
    assert cold["certified"] == "sample"


def test_refused_case_has_the_words_of_its_own_solve():
    (case,) = sweep({"shoe.lining.clearance": ["50 mm"]}).cases
    own = solve_case_without_raising(case).row
    strange = SampleErrorsForCasesOutsideSample(
        (), dict.fromkeys(QUANTITIES_WITH_STATED_ERROR, 0.0)
    )
    assert own["status"].startswith("failed")
    assert solve_case_without_raising(case._replace(certify=strange)).row == own


SWEEPS = {
    "hinge": (BRAKE, {"shoe.hinge.radius": over("100 mm", "135 mm", 30)}, "every 10th", 0),
    "modulus": (
        BRAKE,
        {"shoe.lining.material.E": over("50 MPa", "5 GPa", 30, scale="log")},
        "every 10th",
        0,
    ),
    "partial contact": (
        BRAKE,
        {"shoe.lining.misfit.radius": over("149.6 mm", "150.4 mm", 40)},
        "every 10th",
        0,
    ),
    # Of sixty seeds the next ones have samples that tell least about the other cases.
    "two keys": (
        BRAKE,
        {"friction": over(0.1, 0.6, 8), "shoe.lining.thickness": over("4 mm", "12 mm", 5)},
        "every 10th",
        33,
    ),
    "flexible shoes": (
        str(STUDIES / "double_shoe" / "flexible.toml"),
        {
            "shoe.body.thickness": over("4 mm", "10 mm", 7),
            "shoe.lining.misfit.radius": over("149.8 mm", "150.2 mm", 6),
        },
        "every 10th",
        24,
    ),
    "T-sections": (
        str(STUDIES / "plane_stress" / "brake.toml"),
        {
            "shoe.lining.material.E": over("100 MPa", "2 GPa", 5, scale="log"),
            "friction": over(0.2, 0.5, 4),
        },
        3,
        48,
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", SWEEPS)
def test_no_case_is_further_from_its_own_last_level_than_its_sample_says(name):
    file, keys, certify, seed = SWEEPS[name]
    made = sweep(keys, brake=file, certify=certify, seed=seed)
    rows = solve_sample_cases_and_then_all_others(made.cases, made.sample).rows
    by_sample = 0
    for row, case in zip(rows, made.cases, strict=True):
        if row["certified"] == "itself":
            continue
        by_sample += 1
        one = vary(case.brake, case.changes)
        first, last = solve_brake_on_first_level_without_error_estimate(one), solve(one)
        assert row["torque"] == first.effect
        steps = relative_differences_of_responses_on_two_levels(one, first, last).differences
        moved = steps[1:].reshape(-1, len(QUANTITIES_WITH_STATED_ERROR)).max(axis=0)
        for quantity, found in zip(QUANTITIES_WITH_STATED_ERROR, moved.tolist(), strict=True):
            distance = steps[0] if quantity == "torque" else found
            assert distance < row[f"error_{quantity}"] < 0.5, (name, case.changes)
    assert by_sample > len(rows) / 2
