"""The friction at which a brake locks itself: one answer below it, and none above it."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import drumlin
from conftest import partly, settled_sizes
from drumlin import NoAnswer, vary
from drumlin.contact import active_set, self_locking
from drumlin.contact.equations import ContactProblem
from drumlin.contact.self_locking import (
    FrictionDependentProblem,
    find_largest_friction_with_equilibrium,
)
from drumlin.fem.analysis.self_locking import (
    self_locking_friction_of_shoe_groups,
    shoe_torques_at_friction_coefficients,
)
from drumlin.fem.equilibrium import group as shoe_group
from drumlin.fem.equilibrium.group import ShoeGroup, divide_pressed_shoes_into_groups
from drumlin.fem.error_control.levels import REFINEMENT_LEVELS_FROM_COARSE_TO_FINE
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.solve import solve
from drumlin.laws import rigid, self_locking_friction_of_hinged_shoe
from drumlin_studies.random_brake import draw_random_brake
from picking import picked
from shared_parts import drum_ring

RING = drum_ring(0.015, "free")


def one_node(a=1.0, lever=0.5):
    """A contact problem of one node with p = h/(1 - lever mu). It locks itself at mu = 1/lever."""
    still = ContactProblem(
        np.array([[a]]), np.array([-1.0]), np.array([[-1.0]]), np.array([[-1.0]]), np.array([-1.0])
    )
    return FrictionDependentProblem(still, np.array([[0.0]]), np.array([[lever]]))


@given(st.floats(0.1, 10))
def test_the_limit_of_one_node_on_a_hinge_is_that_of_its_lever(lever):
    end = self_locking.find_largest_friction_with_equilibrium(one_node(lever=lever))
    assert not end.pressure_stays_finite
    assert end.friction == pytest.approx(1 / lever, rel=1e-12)


def test_a_path_that_stands_on_the_singular_friction_ends_there():
    """A step of the path may meet 1/lever exactly, where the equations have no solution."""
    below = active_set.solve_contact_problem(
        one_node().contact_problem_at_friction_coefficient(1.0)
    )
    end = self_locking.find_largest_friction_with_equilibrium(one_node(), known_answer=(2.0, below))
    assert end.friction == 2.0 and not end.pressure_stays_finite


def test_an_answer_that_turns_back_at_finite_pressure_ends_where_the_set_changes():
    """An answer that turns back at finite pressure ends where its contact set changes.

    w_2 = 0.5 - mu p_1 closes at mu = 0.5, where p_1 = 1 is far from any pole; on both nodes det = 1
    - 8 mu^2 < 0.
    """
    still = ContactProblem(
        np.eye(2), np.array([-1.0, 0.5]), np.zeros((2, 0)), np.zeros((0, 2)), np.zeros(0)
    )
    problems = FrictionDependentProblem(
        still, np.array([[0.0, -8.0], [-1.0, 0.0]]), np.zeros((0, 2))
    )
    end = self_locking.find_largest_friction_with_equilibrium(problems)
    assert end.pressure_stays_finite
    assert end.friction == pytest.approx(0.5, rel=1e-10)
    both = active_set.solve_contact_problem(
        problems.contact_problem_at_friction_coefficient(0.45), np.array([True, True])
    )
    # The other answer, which meets the first one at 0.5.
    assert not both.stable and both.p[1] > 0
    assert (
        self_locking.compare_solutions_from_starting_contact_sets(
            problems.contact_problem_at_friction_coefficient(0.45),
            self_locking.find_largest_friction_with_equilibrium(problems, 0.45).last_contact,
            [both.active],
        ).sets_with_unstable_solution
        == 1
    )
    with pytest.raises(NoAnswer):
        active_set.solve_contact_problem(problems.contact_problem_at_friction_coefficient(0.51))


@pytest.mark.parametrize("changes", ({}, {"rotation": "clockwise"}, RING))
def test_the_eigenvalue_is_exact_where_halving_was_not(changes, brake):
    """Just below the limit the answer is of order 1/distance; just beyond is none: to 1e-9."""
    changed = vary(brake, changes)
    scene = make_prepared_model(changed, elements=20)
    limits = [
        (group.find_friction_limit_by_following_contact(3.0).limit, group)
        for group in divide_pressed_shoes_into_groups(scene, changed)
    ]
    end, group = min(limits, key=lambda found: found[0].friction)
    problems = group.contact_problem_as_function_of_friction
    near = [
        active_set.solve_contact_problem(
            problems.contact_problem_at_friction_coefficient(end.friction * (1 - gap)),
            end.last_contact.active,
        ).p.max()
        * gap
        for gap in (1e-7, 1e-9)
    ]
    assert near[1] == pytest.approx(near[0], rel=1e-4)
    for start in (None, end.last_contact.active, ~end.last_contact.active):
        with pytest.raises(NoAnswer):
            active_set.solve_contact_problem(
                problems.contact_problem_at_friction_coefficient(end.friction * (1 + 1e-9)), start
            )
    with pytest.raises(NoAnswer, match=rf"mu_lock = {end.friction:.4g} .rigid-shoe law: 0.8231"):
        solve_prepared_model(scene, vary(changed, {"friction": end.friction * 1.01}))


def test_both_hands_lock_alike_and_the_other_shoe_never(brake):
    found = []
    for rotation in ("counter-clockwise", "clockwise"):
        turning = vary(brake, {"rotation": rotation})
        found.append(
            picked(
                self_locking_friction_of_shoe_groups(
                    make_prepared_model(turning, elements=20), turning
                ).values(),
                "friction",
            )
        )
    assert found[0][0] == found[1][1] == math.inf
    assert found[0][1] == pytest.approx(found[1][0], rel=1e-12)


def test_the_limit_knows_neither_force_nor_clearance(brake):
    plain, other = (
        self_locking_friction_of_shoe_groups(
            make_prepared_model(changed, elements=20), changed, 3.0
        )[(1,)].friction
        for changed in (
            brake,
            vary(brake, {"shoe.actuation.force": 50.0, "shoe.lining.clearance": 2e-4}),
        )
    )
    assert other == pytest.approx(plain, rel=1e-10)


def test_rigid_shoes_tend_to_the_law_as_their_linings_become_thin(brake):
    law = self_locking_friction_of_hinged_shoe(brake, brake.shoes[1])
    off = []
    for t in (8e-3, 4e-3, 2e-3):
        rigid = vary(brake, {"shoe.body": None, "shoe.lining.thickness": t})
        off.append(
            self_locking_friction_of_shoe_groups(
                make_prepared_model(rigid, elements=60), rigid, 3.0
            )[(1,)].friction
            / law
            - 1
        )
    assert abs(off[2]) < 5e-3
    # The difference is linear in t/R by the lining's own shear.
    assert off[0] / off[1] == pytest.approx(2, rel=0.05)
    assert off[1] / off[2] == pytest.approx(2, rel=0.05)


def test_torque_has_a_simple_pole_at_the_limit(brake):
    scene = make_prepared_model(brake, elements=20)
    end = self_locking_friction_of_shoe_groups(scene, brake, 3.0)[(1,)].friction
    gaps = np.array([1e-4, 1e-6])
    T = shoe_torques_at_friction_coefficients(scene, brake, list(end * (1 - gaps)))[:, 1]
    assert T[1] * gaps[1] == pytest.approx(T[0] * gaps[0], rel=1e-3)


@pytest.mark.parametrize("way", ["locking", "opposed"])
@pytest.mark.parametrize("seed", partly(range(1, 7), range(1, 3)))
def test_below_half_the_limit_all_starts_agree_and_beyond_it_none_is_answered(seed, way):
    brake = draw_random_brake(seed, way)
    scene = make_prepared_model(brake, elements=10)
    problems = ShoeGroup(scene, brake, (0,)).contact_problem_as_function_of_friction
    end, rng = (
        self_locking.find_largest_friction_with_equilibrium(problems, 20.0),
        np.random.default_rng(seed),
    )
    n = len(problems.frictionless.q)
    starts = [np.ones(n, bool), np.zeros(n, bool), *(rng.random(n) < 0.5 for _ in range(5))]
    mu = 0.5 * min(end.friction, 0.6)
    found = self_locking.compare_solutions_from_starting_contact_sets(
        problems.contact_problem_at_friction_coefficient(mu),
        self_locking.find_largest_friction_with_equilibrium(problems, mu).last_contact,
        starts,
    )
    assert (
        found.sets_with_known_solution,
        found.sets_with_other_stable_solution,
        found.sets_with_unstable_solution,
        found.sets_without_convergence,
    ) == (7, 0, 0, 0)
    assert found.largest_pressure_difference < 1e-9
    # Of the brakes whose friction opposes the shoe, one in a hundred locks.
    assert (end.friction < 5) == (way == "locking")
    for beyond in (1.0001, 1.05, 2, 3) if way == "locking" else ():
        with pytest.raises(NoAnswer, match="self-locking"):
            solve_prepared_model(
                scene, vary(brake, {"friction": beyond * end.friction}), penalty=math.inf
            )


def test_where_the_answer_turns_back_those_beyond_stand_apart_and_are_refused():
    """Answers beyond the turning point of friction stand apart and are refused.

    A dent in this lining lets the contact leap: other answers are in equilibrium up to mu = 1.269
    and again on the lining's end alone. No path of friction leads to them, however long its steps.
    """
    brake = draw_random_brake(37, "locking")
    scenes = (
        make_prepared_model(brake, elements=16),
        make_prepared_model(brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[2]),
        make_prepared_model(brake, elements=64),
    )
    ends = []
    for scene in scenes:
        problems = ShoeGroup(scene, brake, (0,)).contact_problem_as_function_of_friction
        end = self_locking.find_largest_friction_with_equilibrium(problems)
        assert end.pressure_stays_finite
        ends.append(end.friction)
    assert max(ends) < 1.01 * min(ends)
    for beyond in (0.84, 1.0, 2.54):
        assert active_set.solve_contact_by_block_pivoting(
            problems.contact_problem_at_friction_coefficient(beyond)
        ).stable
        with pytest.raises(NoAnswer, match=f"up to mu_lock = {end.friction:.4g}"):
            self_locking.solve_contact_reached_from_zero_friction(
                problems.contact_problem_at_friction_coefficient,
                beyond,
                rigid_law_limit=1.18,
                brake_words="",
            )


def test_beyond_the_limit_of_the_rigid_shoe_a_quiet_answer_is_not_taken_unfollowed():
    """A stable answer beyond the rigid shoe's limit is refused unless friction leads to it.

    At twice that limit one stands apart that hardly grows with friction.
    """
    brake = draw_random_brake(100, "locking")
    (group,) = divide_pressed_shoes_into_groups(make_prepared_model(brake, elements=14), brake, 1e6)
    law = rigid.self_locking_friction_of_rigid_shoe(brake, group.shoes[0])
    problems, mu = group.contact_problem_as_function_of_friction, 2 * law
    end = self_locking.find_largest_friction_with_equilibrium(problems).friction
    assert end < mu
    found = active_set.solve_contact_by_block_pivoting(
        problems.contact_problem_at_friction_coefficient(mu)
    )
    half = active_set.solve_contact_by_block_pivoting(
        problems.contact_problem_at_friction_coefficient(0.5 * mu), found.active
    )
    assert found.stable and half.stable and found.p.sum() < 1.5 * half.p.sum()
    with pytest.raises(NoAnswer, match=f"up to mu_lock = {end:.4g}"):
        self_locking.solve_contact_reached_from_zero_friction(
            problems.contact_problem_at_friction_coefficient,
            mu,
            rigid_law_limit=law,
            brake_words="now",
        )


def test_a_large_problem_is_answered_as_if_it_were_followed_on_all_nodes(flexible, monkeypatch):
    """A large problem is answered as if it were followed on all nodes.

    It is followed on every other, fourth and eighth node, assisted and opposed, up to the limit and
    beyond.
    """
    scene = make_prepared_model(flexible, elements=24)
    for group in divide_pressed_shoes_into_groups(scene, flexible, 1e4):
        problems, n = (
            group.contact_problem_as_function_of_friction,
            len(group.contact_problem_of_group.q),
        )
        end = min(self_locking.find_largest_friction_with_equilibrium(problems, 3.0).friction, 3.0)
        for mu in (0.2 * end, 0.6 * end, 0.9 * end, 1.001 * end, 2 * end):
            answers = []
            for large in (n, 10):
                monkeypatch.setattr(
                    self_locking, "NODES_ABOVE_WHICH_FRICTION_PATH_IS_COARSE", large
                )
                try:
                    answers.append(
                        self_locking.solve_contact_reached_from_zero_friction(
                            problems.contact_problem_at_friction_coefficient,
                            mu,
                            rigid_law_limit=1e3,
                            brake_words="",
                        ).p
                    )
                except NoAnswer as error:
                    answers.append(str(error))
            if mu < end:
                np.testing.assert_allclose(
                    answers[1], answers[0], rtol=1e-7, atol=1e-9 * answers[0].max()
                )
            elif math.isfinite(end) and end < 3.0:
                assert answers[1] == answers[0] and "mu_lock" in answers[0]


def test_of_a_large_problem_the_fine_answer_is_solved_once(flexible, monkeypatch):
    (_, group) = divide_pressed_shoes_into_groups(
        make_prepared_model(flexible, elements=24), flexible, 1e4
    )
    monkeypatch.setattr(self_locking, "NODES_ABOVE_WHICH_FRICTION_PATH_IS_COARSE", 30)
    sizes = settled_sizes(monkeypatch)
    self_locking.solve_contact_reached_from_zero_friction(
        group.contact_problem_of_group_at_friction, 0.4, rigid_law_limit=1.0, brake_words=""
    )
    assert sizes.count(len(group.contact_problem_of_group.q)) == 1 and len(sizes) > 2


@pytest.mark.parametrize("changes", [{}, {"friction": 0.1}, {"rotation": "clockwise"}])
def test_the_law_that_is_kept_with_a_scene_is_that_of_the_brake_at_hand(
    brake, changes, monkeypatch
):
    scene, other = make_prepared_model(brake, elements=8), vary(brake, changes)
    # Each shoe becomes a mirror image in the other one's place.
    turned = other.model_copy(update={"shoes": other.shoes[::-1]})
    for at_hand in (other, turned):
        expected = [
            rigid.self_locking_friction_of_rigid_shoe(at_hand, shoe) for shoe in at_hand.shoes
        ]
        assert math.inf in expected and min(expected) < 10
        laws = [
            group.locking_friction_of_brake_shoe_by_rigid_law(group.members[0])
            for group in divide_pressed_shoes_into_groups(scene, at_hand, 1e6)
        ]
        assert laws == pytest.approx(expected, rel=1e-9)
    # A hinged shoe needs no second computation.
    monkeypatch.setattr(rigid, "self_locking_friction_of_rigid_shoe", None)
    laws = [
        group.locking_friction_of_brake_shoe_by_rigid_law(group.members[0])
        for group in divide_pressed_shoes_into_groups(scene, brake, 1e6)
    ]
    assert min(laws) < 10


def test_below_the_first_singular_set_every_load_has_one_answer(brake):
    one = vary(brake, {"shoe": [brake.model_dump(by_alias=True)["shoe"][1]]})
    problems = ShoeGroup(
        make_prepared_model(one, elements=2), one, (0,)
    ).contact_problem_as_function_of_friction
    first, n = (
        self_locking.smallest_friction_that_makes_any_contact_set_singular(problems),
        len(problems.frictionless.q),
    )
    assert 0 < first <= self_locking.find_largest_friction_with_equilibrium(problems).friction
    rng = np.random.default_rng(0)
    below = problems.contact_problem_at_friction_coefficient(0.99 * first)
    scale = np.abs(below.A).max()
    for _ in range(20):
        changed = below._replace(q=scale * rng.normal(size=n) * 10 ** rng.uniform(-3, 3))
        answers = [
            active_set.solve_contact_problem(changed, rng.random(n) < 0.5).p for _ in range(6)
        ]
        assert np.ptp(answers, axis=0).max() <= 1e-9 * np.abs(answers[0]).max()


@pytest.mark.parametrize(("elements", "large"), [(16, 600), (48, 600), (64, 600), (64, 30)])
def test_of_two_stable_answers_the_one_that_friction_leads_to(elements, large, monkeypatch):
    """Of two stable answers solve returns the one that growing friction leads to.

    At mu = 0.822, a hundredth below the jump of its contact, this shoe has another answer of four
    times the torque.
    """
    monkeypatch.setattr(self_locking, "NODES_ABOVE_WHICH_FRICTION_PATH_IS_COARSE", large)
    brake = vary(draw_random_brake(37, "locking"), {"friction": 0.82245})
    group = next(
        iter(
            divide_pressed_shoes_into_groups(
                make_prepared_model(brake, elements=elements), brake, 1e6
            )
        )
    )
    end = find_largest_friction_with_equilibrium(
        group.contact_problem_as_function_of_friction, brake.friction
    )
    followed = (
        brake.friction
        * group.largest_actuation_force
        * float((group.torque_of_each_shoe_per_nodal_pressure.T @ end.last_contact.p)[0])
    )
    assert math.isinf(end.friction) and 480 < followed < 590
    assert solve(brake, elements=elements, penalty=1e6).torque == pytest.approx(followed, rel=1e-6)
    other = active_set.solve_contact_by_block_pivoting(group.contact_problem_of_group)
    assert other.stable and other.p.sum() > 4 * end.last_contact.p.sum()
    found = self_locking.solve_contact_reached_from_zero_friction(
        group.contact_problem_of_group_at_friction,
        brake.friction,
        other.active,
        rigid_law_limit=math.inf,
        brake_words="",
    )
    np.testing.assert_allclose(found.p, end.last_contact.p, rtol=1e-6, atol=1e-9 * found.p.max())


@pytest.mark.parametrize(("share", "quiet"), [(0.6, True), (0.9, False), (1.2, False)])
def test_from_a_quiet_answer_at_half_of_the_friction_the_others_are_followed(
    brake, share, quiet, monkeypatch
):
    """To the very answer, and the very end, that are followed from no friction at all."""
    group = divide_pressed_shoes_into_groups(make_prepared_model(brake, elements=16), brake, 1e6)[1]
    problems, known = group.contact_problem_as_function_of_friction, []
    end = find_largest_friction_with_equilibrium(problems)
    mu, follow = share * end.friction, self_locking.find_largest_friction_with_equilibrium

    def noted(*given):
        known.append(given[2])
        return follow(*given)

    monkeypatch.setattr(self_locking, "find_largest_friction_with_equilibrium", noted)
    try:
        found = self_locking.solve_contact_reached_from_zero_friction(
            problems.contact_problem_at_friction_coefficient,
            mu,
            rigid_law_limit=math.inf,
            brake_words="now",
        )
        np.testing.assert_allclose(
            found.p,
            find_largest_friction_with_equilibrium(problems, mu).last_contact.p,
            rtol=1e-9,
            atol=1e-12 * found.p.max(),
        )
        assert share < 1 and (known[0] and known[0][0]) == (0.5 * mu if quiet else None)
    except NoAnswer as refusal:
        assert share > 1 and f"now there is one up to mu_lock = {end.friction:.4g}" in str(refusal)


@pytest.mark.parametrize("elements", [16, 40])
def test_a_contact_that_shrinks_to_a_point_is_followed_with_few_searches_for_singular_friction(
    elements, monkeypatch
):
    """The floating shoe of a uni-servo brake has no equilibrium above a friction of tan 45 deg.

    Cylinder and adjuster push along x. Along y the pressure and its friction balance only beyond
    the angle -atan(mu), and the lining begins at -45 deg. The contact set changes at nearly all
    steps, and the equations of each set take the time of ten steps.
    """
    brake = vary(drumlin.example("uni_servo"), {"friction": 1.0})
    scene = make_prepared_model(brake, elements=elements)
    (group,) = divide_pressed_shoes_into_groups(scene, brake, 1e6)
    searched = []
    search = self_locking.next_friction_with_singular_contact_equations

    def noted(problem, friction, active):
        searched.append(friction)
        return search(problem, friction, active)

    monkeypatch.setattr(self_locking, "next_friction_with_singular_contact_equations", noted)
    end = find_largest_friction_with_equilibrium(
        group.contact_problem_as_function_of_friction, 1.0, areas=group.contact_node_areas
    )
    assert end.pressure_stays_finite
    assert end.friction == pytest.approx(math.tan(math.radians(45)), rel=1e-6)
    # Without the wait for a second failure there are 5 and 9 searches, of which each takes longer
    # than ten contact solves.
    assert len(searched) <= 1


def test_a_refused_friction_just_above_the_limit_has_the_digits_that_tell():
    def text(friction, limit):
        return self_locking.self_locking_error_text(
            friction, limit, rigid_law_limit=0.7652, brake_words="now"
        )

    assert "at friction 1.0000001; now there is one up to mu_lock = 1 (rigid" in text(1.0000001, 1)
    assert "at friction 0.85; now there is one up to mu_lock = 0.8434 (" in text(0.85, 0.843378)
    assert "at friction 0.8433; now there is one up to mu_lock = 0.843299 (" in text(
        0.8433, 0.8432991
    )


def test_a_refusal_is_not_its_own_cause(brake):
    """A refusal is not its own cause: a chain of causes that leads back to itself ends.

    A sweep asks a refusal for its cause, and the cause for its own.
    """
    locked = vary(brake, {"friction": 1.3})
    with pytest.raises(NoAnswer, match="self-locking") as refused:
        solve(locked, elements=12)
    seen = set[int]()
    error: BaseException | None = refused.value
    while error is not None:
        assert id(error) not in seen
        seen.add(id(error))
        error = error.__cause__ or error.__context__


class FollowedDirections:
    """Directions of friction that hold up to a friction and are found once more up to 0.005."""

    friction_directions_and_bearing_supports = "directions"

    def __init__(self, holds: float) -> None:
        self.holds = holds
        self.solved_group = SimpleNamespace(group=self, contact=None)

    def solution_continued_with_present_supports_or_none(self, friction):
        return self if friction <= self.holds else None

    def solution_at_higher_friction_or_none(self, friction):
        return self if friction <= 0.005 else None

    def copy_of_group_with_other_drum_friction(self, _):
        return self

    def friction_of_pole_with_present_supports(self, _):
        return np.inf

    def _error_text_on_cam_strut_or_support_that_pulls(self):
        return ""


@pytest.mark.parametrize("holds", [0.003, 0.0])
def test_the_search_for_a_limit_ends_where_earlier_directions_come_back(holds):
    before = self_locking.LargestFrictionWithEquilibrium(0.0, False, None, 0.0, 0)
    found = shoe_group._friction_limit_by_bisection(FollowedDirections(holds), before, 0.0, 0.0125)
    assert found.limit.friction == pytest.approx(0.005, rel=1e-7)
