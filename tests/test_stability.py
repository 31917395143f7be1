"""Knobs at their extremes: refinement of the whole system, and the short stability study."""

import json
import math
from dataclasses import asdict
from itertools import islice

import numpy as np
import pytest

from drumlin.base.errors import NoAnswer
from drumlin.base.journal import JournalOfCaseResults
from drumlin.contact import active_set
from drumlin.contact.equations import ContactProblem, condition_number_on_contact_set
from drumlin.fem import model
from drumlin.fem.equilibrium.group import ShoeGroup
from drumlin.fem.error_control.adapt import TolerancesOfPressureAndTorque, solve_brake_to_tolerance
from drumlin.fem.error_control.levels import solve_brake_on_finer_and_finer_mesh_levels
from drumlin.fem.model import (
    ITERATIVE_REFINEMENT_REMARK,
    LARGEST_ACCEPTED_PRESSURE_ROUND_OFF,
    LARGEST_PRESSURE_ROUND_OFF_LEFT_UNREFINED,
    solve_full_system_of_group_by_refinement,
    solve_prepared_model,
)
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.solve import solve
from drumlin.fem.substructure.body import sparse_stiffness_of_body
from drumlin.fem.substructure.elasticity import elastic_layers_of_shoe
from drumlin.verification import triangles
from drumlin_studies.extreme_cases import ExtremeCase, all_extreme_cases
from drumlin_studies.random_brake import draw_random_brake
from drumlin_studies.random_kinds import (
    FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SUPPORT_KIND,
    draw_random_brake_of_support_kind,
)
from drumlin_studies.stated_true import solve_fine_reference_by_triangles, true_errors_of_response
from drumlin_studies.trial import solve_and_judge_case, worst_numerical_accuracy_of_shoe_groups
from picking import having, picked, saying

STUDY_NAME = "stability"


def solved(case):
    brake = case.brake()
    scene = make_prepared_model(
        brake,
        elements=case.elements,
        kind=case.kind,
        mesher=case.function_that_meshes_shoe_with_aspect_ratio(),
    )
    return scene, brake, solve_prepared_model(scene, brake, penalty=case.penalty)


def answer(case):
    return solved(case)[2]


def refined_anyway(monkeypatch):
    """From now on every answer is out of balance until it is refined."""
    imbalance = model._largest_imbalance_of_shoes

    def worse(answers):
        return (
            imbalance(answers)
            if all(ITERATIVE_REFINEMENT_REMARK in answer.note for answer in answers.values())
            else 1.0
        )

    monkeypatch.setattr(model, "_largest_imbalance_of_shoes", worse)


def everywhere(scene):
    return np.ones(len(scene.bodies[0].line.phi), dtype=bool)


def test_the_designed_set_turns_every_knob_to_its_end():
    every = all_extreme_cases()
    assert len(every) >= 300
    assert len(set(every)) == len(every)
    # A journal keeps the cases as JSON.
    for case in every:
        assert json.loads(json.dumps(asdict(case))) == asdict(case)
    for knob, low, high in (
        ("penalty", 1e-2, math.inf),
        ("friction", 0, 5),
        ("thickness", 1e-5, 1 / 3),
        ("arc", 0.1, 340),
        ("force", 1e-9, 1e12),
        ("elements", 2, 2000),
    ):
        values = picked(every, knob)
        assert min(values) <= low and max(values) >= high * (1 - 1e-12), knob
    for knob in ("shoe", "ring"):
        values = [getattr(case, knob) for case in every if getattr(case, knob) is not None]
        assert min(values) == 1e-8 and max(values) == 1e8
    assert {1e4, 1e-4} <= set(picked(every, "aspect"))
    assert max(picked(every, "nu")) == 0.4999
    assert {"toe", "heel", "split", "point"} <= set(picked(every, "clearance"))


@pytest.mark.parametrize("kind", ("quad2", "quad1", "tri2", "tri1"))
def test_long_double_stiffness_is_that_of_double_and_strains_nothing_in_rigid_motion(kind):
    scene, brake, _ = solved(ExtremeCase(elements=8, kind=kind))
    body, layers = scene.bodies[0], elastic_layers_of_shoe(brake.shoes[0])
    K, L = (
        sparse_stiffness_of_body(body.basis, layers, precise=precise) for precise in (False, True)
    )
    assert L.dtype == np.longdouble
    scale = abs(K).max()
    assert abs((K - L).toarray()).max() < 1e-13 * scale
    x, y = body.basis.doflocs.astype(np.longdouble)
    turn = np.column_stack([-y, x]).ravel()
    assert (
        np.abs(L @ turn).max()
        < 1e3 * np.finfo(np.longdouble).eps * float(scale) * np.abs(turn).max()
    )


@pytest.mark.parametrize("ring", [None, (1e-8, "free"), (400.0, "fixed"), (400.0, "free")])
def test_the_whole_system_gives_the_torque_of_the_condensed_bodies(ring):
    extra = {} if ring is None else {"ring": ring[0], "support": ring[1], "shoes": 2}
    scene, brake, response = solved(ExtremeCase(elements=20, **extra))
    group = list(range(len(brake.shoes)))
    p = [response.shoes[i].pressure[:: brake.shoes[i].frame.sense] for i in group]
    refined = solve_full_system_of_group_by_refinement(
        ShoeGroup(scene, brake, tuple(group), 1e6), np.concatenate(p) > 0
    )
    assert refined.torque * 2000 == pytest.approx(response.torque, rel=1e-10)
    assert np.abs(refined.p[0] * 2000 - p[0]).max() < 1e-9 * p[0].max()
    assert refined.correction < 1e-12


def test_the_whole_system_finds_the_contact_set_itself():
    scene, brake, response = solved(ExtremeCase(clearance="split", elements=24))
    wrong = everywhere(scene)
    refined = solve_full_system_of_group_by_refinement(ShoeGroup(scene, brake, (0,), 1e6), wrong)
    assert refined.contact_sets > 1
    assert refined.torque * 2000 == pytest.approx(response.torque, rel=1e-9)


def test_a_torque_near_self_locking_has_a_bad_condition():
    scene, brake, _ = solved(ExtremeCase(friction=0.3, elements=12))
    scene_, brake_, _ = solved(ExtremeCase(friction=1.17, elements=12))
    mild, sharp = (
        solve_full_system_of_group_by_refinement(
            ShoeGroup(s, b, (0,), 1e6), everywhere(s)
        ).condition_number_of_torque
        for s, b in ((scene, brake), (scene_, brake_))
    )
    assert sharp > 10 * mild


@pytest.mark.parametrize("assisted", [True, False])
def test_a_soft_shoe_is_refined_instead_of_refused(assisted):
    """A very soft shoe is refined instead of refused.

    Condensation loses some 1e-16 over the ratio of bending to lining stiffness; refinement recovers
    these digits.
    """
    softer = [
        answer(ExtremeCase(shoe=E, assisted=assisted, elements=20))
        for E in (1e-4, 1e-6, 1e-7, 1e-8)
    ]
    for response in softer[1:]:
        assert ITERATIVE_REFINEMENT_REMARK in response.notes[0]
        assert max(response.balance.force, response.balance.moment) < 1e-8
    assert softer[3].torque == pytest.approx(softer[2].torque, rel=1e-6)
    # A lining that is rigid against its shoe: the torque has a limit, to which it tends as the
    # ratio. The stiffest shoe is not refined, and keeps enough digits of its far larger change.
    first, second = softer[1].torque - softer[0].torque, softer[2].torque - softer[1].torque
    assert second == pytest.approx(first * 0.9e-6 / 99e-6, rel=0.1)


@pytest.mark.parametrize(
    "kind", sorted({*FUNCTIONS_THAT_DRAW_BRAKE_DATA_BY_SUPPORT_KIND} - {"cam", "strut", "chain"})
)
@pytest.mark.slow
def test_a_refined_reaction_is_that_of_the_strains_where_those_have_their_digits(kind, monkeypatch):
    """However a shoe is held; those that share a force are not refined."""
    brake = draw_random_brake_of_support_kind(0, kind)
    strained = solve(brake, elements=12)
    refined_anyway(monkeypatch)
    refined = solve(brake, elements=12)
    assert saying(refined.notes, ITERATIVE_REFINEMENT_REMARK)
    for shoe, other in zip(refined.shoes, strained.shoes, strict=True):
        assert shoe.hinge_reaction == pytest.approx(
            other.hinge_reaction, abs=1e-10 * math.hypot(*other.hinge_reaction)
        )
        assert shoe.reaction_moment == pytest.approx(other.reaction_moment, rel=1e-8)


def test_a_reaction_whose_strains_lose_their_digits_follows_from_the_pressure():
    """A reaction whose strains lose their digits follows from the pressure.

    The shoe bends so far compared with the strains at its pin that long double sees 6e-7 of the
    reaction wrong there, and 2e-10 of p.
    """
    knobs = {
        "friction": 0.407,
        "shoe": 1.87e-6,
        "thickness": 1.16e-4,
        "arc": 325.0,
        "clearance": 4.45e-8,
    }
    case = ExtremeCase(**knobs, penalty=5.8e8, force=72.4, lever=0.0229, nu=0.3634, elements=8)
    scene, brake, response = solved(case)
    assert (
        worst_numerical_accuracy_of_shoe_groups(scene, brake, response, case.penalty)["digits"] > 8
    )
    assert max(response.balance.force, response.balance.moment) < 1e-9


def test_digits_that_no_arithmetic_keeps_are_refused_with_the_reason():
    with pytest.raises(NoAnswer, match=r"lost digits.*certain only to .*too far apart"):
        answer(ExtremeCase(shoe=3e-13, elements=10))


def test_a_mesh_that_states_no_error_is_refused_where_digits_are_missing():
    """Refined, p is certain to 2e-5: on columns that would be a part of the stated error."""
    with pytest.raises(
        NoAnswer, match=r"even refined its pressure is certain only to [1-9]\.\de-05"
    ):
        answer(ExtremeCase(shoe=1e-11, elements=16))


def test_digits_that_condensation_loses_on_a_fine_division_are_part_of_the_error():
    """Too many unknowns to refine: the answer stands, and what it may be off by."""
    _, found = solve_brake_to_tolerance(
        draw_random_brake(7246),
        TolerancesOfPressureAndTorque(1e-3, 1e-3),
        solve_prepared_model,
        must=False,
    )
    (shoe,) = found.shoes
    assert (
        LARGEST_PRESSURE_ROUND_OFF_LEFT_UNREFINED
        < shoe.lost.pressure
        < LARGEST_ACCEPTED_PRESSURE_ROUND_OFF
    )
    for name, lost in shoe.lost._asdict().items():
        assert found.error[name] > lost > 0


@pytest.mark.slow
@pytest.mark.parametrize("seed", [2342, 2474])
def test_triangles_agree_where_digits_were_lost(seed):
    brake = draw_random_brake(seed)
    found, true = solve(brake, tolerance=1e-3), solve_fine_reference_by_triangles(brake)
    off = true_errors_of_response(brake, found.shoes, true.shoes)
    for name, error in off.items():
        assert error <= found.error[name] + true.unsure[name]


@pytest.mark.slow
def test_what_a_refinement_cannot_settle_is_part_of_the_error(monkeypatch):
    """What refinement cannot settle counts as part of the stated error.

    With a lining forty times as stiff as its shoe p stays uncertain in the corners, the forces
    hardly at all.
    """
    # The balance depends on the number of threads.
    refined_anyway(monkeypatch)
    brake = draw_random_brake(8326)
    along, (true,) = (
        islice(solve_brake_on_finer_and_finer_mesh_levels(brake, solve_prepared_model), 2),
        triangles.solve_brake_on_sequence_of_triangle_meshes(
            brake, triangles.TRIANGLE_MESH_LEVELS_FROM_COARSE_TO_FINE[:1]
        ),
    )
    found = solve_brake_to_tolerance(
        brake,
        TolerancesOfPressureAndTorque(1e-6, 1e-6),
        solve_prepared_model,
        must=False,
        levels=along,
    ).response
    (shoe,) = found.shoes
    assert saying(found.notes, ITERATIVE_REFINEMENT_REMARK)
    assert max(shoe.lost.torque, shoe.lost.reaction) < 1e-4 * shoe.lost.pressure
    assert 1e-6 < shoe.lost.pressure < found.error["pressure"]
    assert shoe.torque == pytest.approx(true[0].torque, rel=found.error["torque"])
    off = math.dist(shoe.hinge_reaction, true[0].hinge_reaction)
    assert off < found.error["reaction"] * math.hypot(*true[0].hinge_reaction)


def test_wide_gaps_on_tiny_compressions_keep_their_digits():
    """Wide gaps on tiny compressions keep their digits.

    A force so small that the shoe touches at one node has a pressure in proportion to the force, to
    round-off.
    """
    torques = [
        answer(ExtremeCase(clearance=1e-4, force=F, elements=16)).torque / F
        for F in (1e-9, 1e-7, 1e-5, 1e-3)
    ]
    assert torques == pytest.approx([torques[0]] * 4, rel=1e-9)


def test_a_contact_set_of_one_node_carries_the_moment_exactly():
    A = np.diag([1e-16, 2e-16, 1e-16])
    problem = ContactProblem(
        A,
        np.array([5e-5, 4.9e-5, 6e-5]),
        -np.array([[1e-6], [1e-6], [1e-6]]),
        np.full((1, 3), 0.7e-6),
        np.array([3e-5]),
    )
    found = active_set.solve_contact_problem(problem)
    assert found.active.tolist() == [False, True, False]
    assert 0.7e-6 * found.p[1] == pytest.approx(3e-5, rel=1e-15)


def test_condition_of_the_contact_equations_is_that_of_the_equilibrated_matrix():
    scene, brake, _ = solved(ExtremeCase(elements=10))
    problem = ShoeGroup(scene, brake, (0,)).contact_problem_of_group
    A, _, B, C, _ = problem
    d = 1 / np.sqrt(np.diagonal(A))
    column, row = 1 / np.abs(d[:, None] * B).max(), 1 / np.abs(C * d).max()
    matrix = np.block(
        [[d[:, None] * A * d, d[:, None] * B * column], [row * C * d, np.zeros((1, 1))]]
    )
    exact = np.linalg.cond(matrix, 1)
    assert condition_number_on_contact_set(problem, everywhere(scene)) == pytest.approx(
        exact, rel=0.5
    )


def test_a_stiff_penalty_costs_nothing_and_a_soft_one_errs_in_proportion():
    scene, brake, exact = solved(ExtremeCase(penalty=math.inf, elements=20))
    torque = {
        a: solve_prepared_model(scene, brake, penalty=a)
        for a in (1e3, 1e4, 1e5, 1e6, 1e9, 1e12, 1e16)
    }
    for a in (1e6, 1e9, 1e12, 1e16):
        assert torque[a].torque == pytest.approx(exact.torque, rel=1e-5)
        assert torque[a].iterations == exact.iterations
    errors = [abs(torque[a].torque / exact.torque - 1) for a in (1e3, 1e4, 1e5)]
    assert errors[0] / errors[1] == pytest.approx(10, rel=0.01)
    assert errors[1] / errors[2] == pytest.approx(10, rel=0.01)


def test_units_do_not_matter():
    """The same brake in m and N, and counted in mm and MPa as numbers."""
    base, other = (
        answer(ExtremeCase(elements=20, **knobs)) for knobs in ({}, {"size": 1e3, "pressure": 1e-6})
    )
    assert other.torque == pytest.approx(1e3 * base.torque, rel=1e-10)


def test_a_trial_says_what_went_wrong():
    row = solve_and_judge_case(ExtremeCase(friction=1.5, elements=12))
    assert row["outcome"] == "self-locking" and "mu_lock" in row["reason"]
    assert (
        solve_and_judge_case(ExtremeCase(clearance=0.03, elements=12))["outcome"] == "out of reach"
    )
    assert solve_and_judge_case(ExtremeCase(lever=-1e-6, elements=12))["outcome"] == "no contact"
    assert solve_and_judge_case(ExtremeCase(nu=0.5, elements=12))["outcome"] == "bad input"
    assert solve_and_judge_case(ExtremeCase(shoe=1e-13, elements=12))["outcome"] == "arithmetic"


def test_an_empty_journal_is_one():
    """A study keeps its cases in the journal that it is given, from the first case on."""
    assert JournalOfCaseResults() and len(JournalOfCaseResults()) == 0


@pytest.mark.slow
def test_every_case_is_right_or_refused_with_the_physical_reason(module, result):
    assert len(result.rows) >= 60
    assert module.trial_rows_with_fault_as_outcome(result.rows) == []
    answers = having(result.rows, outcome="answer")
    assert len(answers) >= 40
    for row in answers:
        assert max(row["balance"], row["complementarity"]) <= 1e-8, row["case"]
        assert row["digits"] >= min(6, row["allowed"]), row["case"]
    for row in result.rows:
        if row["outcome"] not in ("answer", "no contact"):
            assert row["reason"] and "\n" not in row["reason"]
    assert any(row["pointwise"] in ("cycles", "does not end") for row in result.rows)


@pytest.mark.slow
def test_random_brakes_are_answered_below_their_limit_alone(result):
    beyond = [row for row in result.locked.unique if row["answered"] is not None]
    assert beyond
    assert sum(picked(beyond, "answered")) == 0
    for row in result.locked.unique:
        assert row["same"] > row["starts"] / 2


@pytest.mark.slow
def test_the_page_holds_the_maps_the_worst_and_the_refusals(module, result, tmp_path):
    text = module.report(result, tmp_path).read_text()
    for words in (
        "fewest digits",
        "Refusals",
        "mu_lock",
        "pointwise",
        "penalty costs nothing",
        "0 faults",
    ):
        assert words in text
    assert (tmp_path / "cases.csv").exists()
    assert (tmp_path / "sweeps.svg").exists()
