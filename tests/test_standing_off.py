"""Linings that stand off by far more than their compression: meshes agree on refusals."""

import numpy as np
import pytest

from conftest import partly
from drumlin.base.errors import AnswerLostToRoundOff, NoAnswer
from drumlin.brake.file import make_drum_brake_from_data, vary
from drumlin.contact import active_set
from drumlin.contact.equations import ContactProblem
from drumlin.fem.analysis.self_locking import self_locking_friction_of_shoe_groups
from drumlin.fem.error_control.levels import (
    REFINEMENT_LEVELS_FROM_COARSE_TO_FINE,
    solve_brake_on_finer_and_finer_mesh_levels,
)
from drumlin.fem.preparation.meshes import DEFAULT_ELEMENTS_ALONG_LINING
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.solve import solve
from drumlin.laws import solve_brake_by_its_rigid_shoe_law
from drumlin_studies import consistency_refused
from drumlin_studies.consistency_refused import (
    draw_random_brake_for_refusal_check,
    rows_comparing_default_solve_with_meshes,
    sum_of_normal_forces_of_shoes,
)
from drumlin_studies.random_brake import draw_random_brake
from drumlin_studies.standing_off import draw_random_brake_with_clearances
from picking import picked

ONE_SHOE = {
    "title": "stands off",
    "rotation": "clockwise",
    "friction": 0.2638,
    "drum": {"radius": 0.1464},
    "shoe": [
        {
            "name": "first",
            "side": "internal",
            "abutment": {"point": {"x": -0.05267, "y": -0.10289}, "direction": 3.0527},
            "actuation": {
                "force": 5.8126,
                "direction": 2.71376,
                "point": {"x": -0.01879, "y": 0.12995},
            },
            "lining": {
                "start": 2.17808,
                "end": 3.58924,
                "thickness": 0.004481,
                "width": 0.08468,
                "material": {"E": 1.539e9, "nu": 0.136},
                "clearance": 9.705e-5,
            },
        }
    ],
}
"""A rigid shoe on an abutment, whose contact of 3 deg moves by 17 deg as friction grows from none.
"""


def test_a_contact_that_moves_from_wide_columns_to_narrow_ones_does_not_lock():
    """A contact that moves from wide columns to narrow ones does not lock.

    Its force falls by a tenth over the second half of the friction; the sum of nodal pressures
    grows thirteenfold, as more nodes press.
    """
    brake = make_drum_brake_from_data(ONE_SHOE)
    assert solve(brake).torque == pytest.approx(solve(brake, elements=80).torque, rel=1e-3)


@pytest.mark.parametrize("seed", partly([2, 37, 107, 141, 172, 247, 257, 272, 286, 471], [286]))
def test_a_brake_that_a_fine_mesh_answers_is_answered_by_default(seed):
    """Abutments, rough ones, struts and cams, whose contact moves by more than its length."""
    brake = draw_random_brake_with_clearances(seed)
    assert sum_of_normal_forces_of_shoes(solve(brake)) == pytest.approx(
        sum_of_normal_forces_of_shoes(solve(brake, elements=80)), rel=0.01
    )


def test_a_rigid_plank_on_a_curve_stands_on_the_two_nodes_beside_its_load():
    """A plank with lift and tilt over w = x^2, from any pair that it stood on, and from no pair."""
    x = np.linspace(-1.0, 1.0, 9)
    B = -np.array([np.ones_like(x), x]).T
    for load in (-0.9, -0.2, 0.1, 0.6):
        right = np.searchsorted(x, load)
        problem = ContactProblem(1e-7 * np.eye(9), x**2, B, B.T, np.array([-1.0, -load]))
        share = (load - x[right - 1]) / (x[right] - x[right - 1])
        expected = np.zeros(9)
        expected[[right - 1, right]] = 1 - share, share
        starts = [None, *(np.isin(np.arange(9), [i, i + 1]) for i in range(8))]
        for start in starts:
            np.testing.assert_allclose(
                active_set.solve_contact_problem(problem, start).p, expected, atol=1e-12
            )
        for beside in (-1, 0, 1):
            start = np.isin(np.arange(9), [right - 1 + beside, right + beside])
            np.testing.assert_allclose(
                active_set.solve_contact_by_block_pivoting(problem, start).p, expected, atol=1e-12
            )


def test_a_shoe_that_another_one_pushes_touches_where_this_push_presses_it():
    """A shoe pushed by another shoe touches where this push presses it.

    One node and one hinge each: the first one's pressure 1 pushes the second one against the
    direction of its own load, which is zero.
    """
    B = -np.eye(4, 2)[[0, 0, 1, 1]] * np.array([[1.0], [2.0], [1.0], [-1.0]])
    C = np.array([[-1.0, -2.0, 0.0, 0.0], [0.5, 1.0, -1.0, 1.0]])
    problem = ContactProblem(
        1e-6 * np.eye(4), np.array([1.0, 3.0, 1.0, 1.0]), B, C, np.array([-1.0, 0.0])
    )
    found = active_set.solve_contact_problem(problem, np.zeros(4, dtype=bool))
    np.testing.assert_allclose(found.p, [1.0, 0.0, 0.5, 0.0], atol=1e-9)
    np.testing.assert_array_equal(
        active_set.find_contact_set_and_step_count_by_closing_wide_gaps(problem)[0], found.active
    )


@pytest.mark.parametrize("seed", partly(range(1, 7), ()))
def test_true_self_locking_is_still_refused_with_its_limit(seed):
    """mu_lock as followed on a mesh of 160 elements: one of 80 is 2 % off on seed 4."""
    brake = draw_random_brake(seed, "locking")
    end = min(
        picked(
            self_locking_friction_of_shoe_groups(
                make_prepared_model(brake, elements=160), brake
            ).values(),
            "friction",
        )
    )
    with pytest.raises(NoAnswer, match="mu_lock = ") as refusal:
        solve(vary(brake, {"friction": 1.1 * end}))
    said = float(str(refusal.value).split("mu_lock = ")[1].split()[0])
    assert said == pytest.approx(end, rel=5e-3)


@pytest.mark.parametrize(
    ("refusal", "evened"),
    [(NoAnswer("self-locking"), True), (AnswerLostToRoundOff("lost digits"), False)],
)
def test_a_refusal_is_asked_for_once_more_where_another_division_may_answer(brake, refusal, evened):
    nodes = []

    def refuse(scene, brake, *, start=None):
        nodes.append(len(scene.bodies[0].line.nodes))
        raise refusal

    with pytest.raises(NoAnswer) as raised:
        list(solve_brake_on_finer_and_finer_mesh_levels(brake, refuse))
    assert raised.value is refusal
    assert len(nodes) == 2
    even = DEFAULT_ELEMENTS_ALONG_LINING * REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0].degree
    assert nodes[0] < even
    assert (nodes[1] > even) == evened


@pytest.mark.slow
def test_a_cam_that_would_have_to_pull_is_not_said_to_lock():
    """A cam that would have to pull is refused as such, not as locked.

    The force of its second shoe falls to zero below the friction: at 0.0307 on a mesh of 80
    elements.
    """
    brake = draw_random_brake_with_clearances(2361)
    assert solve(vary(brake, {"friction": 0.02}), elements=40).shoes[1].force > 0
    with pytest.raises(
        NoAnswer, match=r"^shoe 'second': no equilibrium, what pushes it would have to pull$"
    ):
        solve(brake, elements=80)


@pytest.mark.parametrize("seed", range(15))
def test_random_brakes_that_stand_off_press_by_the_law_and_are_drawn_again_from_their_seed(seed):
    brake = draw_random_brake_with_clearances(seed)
    assert brake == draw_random_brake_with_clearances(seed)
    assert all(picked(solve_brake_by_its_rigid_shoe_law(brake).shoes, "contact_arcs"))
    assert min(picked(brake.shoes, "lining.clearance")) > 0


@pytest.mark.parametrize("seed", partly(range(0, 60), [4]))
def test_what_is_refused_is_refused_on_meshes_too(seed):
    assert [
        row
        for row in rows_comparing_default_solve_with_meshes(seed)
        if row.outcome not in {"agrees", "refused"}
    ] == []


def test_a_refusal_that_three_meshes_do_not_share_differs(monkeypatch):
    response = solve(draw_random_brake_for_refusal_check(4), elements=5)

    def on_levels(brake, *, elements=None):
        if elements is None:
            raise NoAnswer("self-locking")
        return response

    def nowhere(brake, *, elements=None):
        raise NoAnswer("no equilibrium")

    monkeypatch.setattr(consistency_refused, "solve", on_levels)
    (row,) = rows_comparing_default_solve_with_meshes(4)
    assert (
        row.outcome == "differs"
        and "self-locking" in row.quantity
        and row.brake == draw_random_brake_for_refusal_check(4).title
    )
    monkeypatch.setattr(consistency_refused, "solve", nowhere)
    assert picked(rows_comparing_default_solve_with_meshes(4), "outcome") == ["refused"]
