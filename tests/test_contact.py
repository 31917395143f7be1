"""The complementarity solver, from below: small problems with known answers before any brake."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drumlin.base.errors import NoAnswer
from drumlin.contact import active_set
from drumlin.contact.equations import (
    UNKNOWNS_ABOVE_WHICH_BORDERED_SYSTEM_IS_USED,
    BorderedEquations,
    ContactProblem,
    ContactSetEquations,
    condition_number_on_contact_set,
    is_bordered_system_cheaper_than_new_factors,
    scale_contact_problem,
)


def free(A, q):
    """A problem without free motions."""
    n = len(q)
    return ContactProblem(
        np.asarray(A, float), np.asarray(q, float), np.zeros((n, 0)), np.zeros((0, n)), np.zeros(0)
    )


def p_matrix(rng, n, skew):
    """A positive definite matrix with a skew part: every principal minor is positive."""
    G = rng.normal(size=(n, n))
    W = rng.normal(size=(n, n))
    return G @ G.T + 0.05 * np.eye(n) + skew * (W - W.T)


def test_pressure_against_penetration_of_one_spring_is_a_ramp():
    """w = q + p/k: open for q > 0, p = -k q for q < 0."""
    k = 7.0
    for q in (-2.0, -1e-9, 0.0, 1e-9, 3.0):
        found = active_set.solve_contact_problem(free([[1 / k]], [q]))
        assert found.p[0] == pytest.approx(max(-k * q, 0.0), rel=1e-12)
        assert found.w[0] == pytest.approx(max(q, 0.0), rel=1e-12)


@given(st.integers(1, 25), st.integers(0, 10_000), st.floats(0, 1))
def test_random_p_matrices_are_solved_from_any_start_with_one_answer(n, seed, skew):
    rng = np.random.default_rng(seed)
    problem = free(p_matrix(rng, n, skew), rng.normal(size=n))
    scale = np.abs(problem.q).max()
    answers = [
        active_set.solve_contact_problem(problem, start)
        for start in (None, np.zeros(n, bool), np.ones(n, bool), rng.random(n) < 0.5)
    ]
    for found in answers:
        w = problem.q + problem.A @ found.p
        assert (found.p >= 0).all()
        assert not found.w[found.active].any()
        assert w.min() >= -1e-9 * scale
        assert np.abs(found.p * w).max() <= 1e-9 * scale * max(1.0, found.p.max())
        assert found.p == pytest.approx(
            answers[0].p, rel=1e-7, abs=1e-9 * max(1.0, answers[0].p.max())
        )


def test_murtys_cycle_is_resolved():
    """The active set settles on Murty's P-matrix, where a plain iteration cycles (Murty 1974).

    This is the classic 3 x 3 example.
    """
    A = np.array([[1.0, 2.0, 0.0], [0.0, 1.0, 2.0], [2.0, 0.0, 1.0]])
    found = active_set.solve_contact_problem(free(A, -np.ones(3)))
    assert found.p == pytest.approx(np.full(3, 1 / 3), rel=1e-12)
    for start in range(8):
        again = active_set.solve_contact_problem(
            free(A, [-1.0, -1.5, 2.0]), np.array([start & 1, start & 2, start & 4], bool)
        )
        w = np.array([-1.0, -1.5, 2.0]) + A @ again.p
        assert w.min() > -1e-12 and abs(again.p @ w) < 1e-12


def test_a_free_motion_is_found_with_its_equilibrium():
    """A rigid beam on two springs turns about its hinge by the known statics of a lever.

    The beam has the length 2 and a load of 3 at its tip.
    """
    k, x = 10.0, np.array([1.0, 2.0])
    problem = ContactProblem(np.eye(2) / k, np.zeros(2), -x[:, None], -x[None], np.array([-6.0]))
    found = active_set.solve_contact_problem(problem)
    turn = 6.0 / (k * (x @ x))
    assert found.y == pytest.approx([turn], rel=1e-12)
    assert found.p == pytest.approx(k * turn * x, rel=1e-12)
    assert found.stable


def test_a_gap_closes_before_pressure_rises():
    """A spring that stands back too far carries no load; the other spring carries all of it."""
    x = np.array([1.0, 2.0])
    problem = ContactProblem(
        np.eye(2) / 10, np.array([5.0, 0.1]), -x[:, None], -x[None], np.array([-6.0])
    )
    found = active_set.solve_contact_problem(problem)
    assert found.p == pytest.approx([0, 3], rel=1e-12)
    assert found.y == pytest.approx([(0.1 + 0.3) / 2], rel=1e-12)


def test_a_load_that_no_pressure_balances_is_refused():
    x = np.array([1.0, 2.0])
    with pytest.raises(NoAnswer, match="no equilibrium"):
        active_set.solve_contact_problem(
            ContactProblem(np.eye(2), np.zeros(2), -x[:, None], -x[None], np.array([6.0]))
        )


def test_beyond_locking_the_determinant_has_changed_its_sign():
    """The determinant of the contact system changes its sign where a brake locks.

    One spring's pressure turns the lever by x - mu a: regular below mu = x/a, singular there.
    """

    def problem(mu):
        return ContactProblem(
            np.array([[1.0]]),
            np.zeros(1),
            np.array([[-1.0]]),
            np.array([[mu - 1.0]]),
            np.array([mu - 1.0]),
        )

    assert active_set.solve_contact_problem(problem(0.9)).stable
    assert not active_set.solve_contact_problem(problem(1.1)).stable
    with pytest.raises(NoAnswer):
        active_set.solve_contact_problem(problem(1.0))


@given(st.integers(2, 12), st.integers(0, 1000))
def test_the_tangent_agrees_with_differences(n, seed):
    rng = np.random.default_rng(seed)
    A, q, dq = p_matrix(rng, n, 0.3), rng.normal(size=n), rng.normal(size=n)
    found = active_set.solve_contact_problem(free(A, q))
    step = 1e-7
    moved = active_set.solve_contact_problem(free(A, q + step * dq))
    # Otherwise the contact set has changed within the step, and no slope exists.
    if np.array_equal(found.active, moved.active):
        change = (moved.p - found.p) / step
        assert found.pressure_change(dq) == pytest.approx(
            change, abs=1e-4 * max(1.0, np.abs(change).max())
        )


@given(st.integers(20, 60), st.integers(0, 1000))
def test_changing_a_few_nodes_of_a_factorised_set_equals_factorising_the_other_set(n, seed):
    rng = np.random.default_rng(seed)
    problem = ContactProblem(
        p_matrix(rng, n, 0.3),
        rng.normal(size=n),
        rng.normal(size=(n, 1)),
        rng.normal(size=(1, n)),
        rng.normal(size=1),
    )
    active = rng.random(n) < 0.8
    system, other = scale_contact_problem(problem), active.copy()
    other[rng.choice(n, n // 10, replace=False)] ^= True
    base, direct = (
        ContactSetEquations(system.K, system.mask_of_unknowns_of_contact_set(active)),
        ContactSetEquations(system.K, system.mask_of_unknowns_of_contact_set(other)),
    )
    changed = BorderedEquations(base, system.K, system.mask_of_unknowns_of_contact_set(other))
    for r in (system.r, rng.normal(size=(n + 1, 3))):
        a, b = direct.solve(r), changed.solve(r)
        assert b == pytest.approx(a, rel=1e-6, abs=1e-8 * np.abs(a).max())
    assert changed.determinant_sign == direct.determinant_sign


def test_the_sign_of_a_changed_sets_determinant_is_that_of_the_other_set():
    """Of matrices whose principal minors have either sign, by numpy's determinant."""
    rng, seen = np.random.default_rng(1), set()
    for _ in range(30):
        K, active = rng.normal(size=(12, 12)), rng.random(12) < 0.6
        other = active.copy()
        other[rng.choice(12, 4, replace=False)] ^= True
        base, (sign, _) = ContactSetEquations(K, active), np.linalg.slogdet(K[other][:, other])
        assert (
            BorderedEquations(base, K, other).determinant_sign
            == ContactSetEquations(K, other).determinant_sign
            == sign
        )
        seen.add((base.determinant_sign, int(sign)))
    assert len(seen) == 4


def test_scaling_of_pressures_and_gaps_does_not_change_the_answer():
    rng = np.random.default_rng(3)
    A, q = p_matrix(rng, 15, 0.4), rng.normal(size=15)
    plain = active_set.solve_contact_problem(free(A, q))
    scaled = active_set.solve_contact_problem(free(A * 1e-21, q * 1e-12))
    assert scaled.p * 1e-9 == pytest.approx(plain.p, rel=1e-10, abs=1e-12 * plain.p.max())
    assert scaled.steps == plain.steps


@pytest.mark.parametrize("n", [48, 49, 200, 201])
def test_the_guess_from_coarser_problems_is_the_contact_set_within_a_node(n):
    """The contact set guessed from coarser problems is right to one node at either end.

    A smooth obstacle on springs has p = max(-q, 0).
    """
    q = np.cos(np.linspace(0, 7, n))
    guess, true = active_set.guess_contact_set_from_coarse_problem(free(np.eye(n), q)), q < 0
    wider = true.copy()
    for shift in (1, 2):
        wider[shift:] |= true[:-shift]
        wider[:-shift] |= true[shift:]
    assert not (true & ~guess).any()
    assert not (guess & ~wider).any()


def test_a_small_contact_far_away_is_found_in_few_steps():
    """A contact at the far end alone of a hinged lever of springs is found in few steps.

    The gap grows all the way to the pin.
    """
    x = np.linspace(1, 2, 161)
    problem = ContactProblem(
        np.eye(161) * 1e-4, (2 - x) * 10, -x[:, None], -x[None], np.array([-0.5])
    )
    assert np.count_nonzero(active_set.solve_contact_problem(problem).p) < 8
    assert active_set.solve_contact_problem(problem).steps <= 5


@given(st.integers(2, 25), st.integers(0, 10_000), st.floats(0, 0.5), st.booleans())
def test_followed_from_wider_gaps_the_contact_is_that_of_the_answer(n, seed, skew, hinged):
    """A contact followed from wider gaps is the one found from all nodes, in a few n steps.

    Shoes are free or on a hinge, with friction (a skew matrix) or without.
    """
    rng = np.random.default_rng(seed)
    A, x = p_matrix(rng, n, skew), rng.uniform(0.2, 1.0, n)
    motion = (-x[:, None], -x[None], np.array([-1.0])) if hinged else free(A, x)[2:]
    problem = ContactProblem(A, rng.normal(size=n), *motion)
    active, steps = active_set.find_contact_set_and_step_count_by_closing_wide_gaps(problem)
    found = active_set.solve_contact_by_block_pivoting(problem, active)
    assert found.steps == 1
    assert steps <= 10 * n
    w = problem.q + A @ found.p + problem.B @ found.y
    assert w.min() >= -1e-9 * max(np.abs(problem.q).max(), np.abs(w).max())
    assert found.p == pytest.approx(
        active_set.solve_contact_problem(problem).p, rel=1e-7, abs=1e-9 * found.p.max(initial=1.0)
    )


def test_followed_from_wider_gaps_a_contact_without_answer_never_arrives():
    """A spring that softens as it is pressed, w = -1 - p: no pressure closes it."""
    with pytest.raises(NoAnswer, match="never reaches"):
        active_set.find_contact_set_and_step_count_by_closing_wide_gaps(free([[-1.0]], [-1.0]))


@pytest.mark.parametrize(
    ("A", "q", "p"),
    [
        ([[0.4, 0.0, -0.1], [-0.4, 2.4, 0.8], [0.5, 0.7, -0.1]], [0.9, -0.6, -0.2], [11, 0, 53]),
        ([[2.4, -1.8, 0.6], [0.6, -0.4, 1.9], [-0.5, 0.5, 1.4]], [-0.6, -1.0, -0.6], [13, 17, 0]),
        (
            [[2.1, 1.8, -0.2], [-0.2, 0.5, -0.4], [-1.2, 1.8, -0.8]],
            [0.1, 0.8, -0.2],
            [0, 2.25, 4.8125],
        ),
    ],
)
def test_a_path_that_turns_back_is_followed_to_the_only_answer(A, q, p):
    """A path of contact sets that turns back leads to the only answer.

    Gaps grow again on the way, in the last case twice; all eight contact sets were tried.
    """
    active, steps = active_set.find_contact_set_and_step_count_by_closing_wide_gaps(free(A, q))
    assert active.tolist() == (np.array(p) > 0).tolist()
    assert steps <= 5
    assert active_set.solve_contact_by_block_pivoting(free(A, q), active).p == pytest.approx(
        p, rel=1e-9
    )


def test_wrong_nodes_that_do_not_become_fewer_are_given_up_after_five_steps_more():
    """An iteration whose wrong nodes do not become fewer is given up after five more steps.

    On Murty's cycle each step has one wrong node; then the answer is followed, and all steps are
    counted.
    """
    cycle, start = (
        free([[1, 2, 0], [0, 1, 2], [2, 0, 1]], [-1, -1, -1]),
        np.array([True, False, False]),
    )
    with pytest.raises(
        active_set.ContactSetNotConvergedError, match="still changes after 7 steps"
    ) as end:
        active_set.solve_contact_by_block_pivoting(cycle, start)
    assert end.value.steps == 7
    with pytest.raises(active_set.ContactSetNotConvergedError, match="after 2 steps"):
        active_set.solve_contact_by_block_pivoting(cycle, start, most_steps=2)
    _, followed = active_set.find_contact_set_and_step_count_by_closing_wide_gaps(cycle)
    assert active_set.solve_contact_problem(cycle, start).steps == 7 + followed + 1


def test_round_off_does_not_change_the_contact_set_and_more_does():
    on, off = np.array([True, True]), np.array([False, True])
    for size, steps in ((1e-14, 1), (1e-9, 2)):
        # A node that is pulled open must leave the contact.
        assert (
            active_set.solve_contact_by_block_pivoting(free(np.eye(2), [size, -1]), on).steps
            == steps
        )
        # A node that penetrates the drum must join the contact.
        assert (
            active_set.solve_contact_by_block_pivoting(free(np.eye(2), [-size, -1]), off).steps
            == steps
        )
        scaled = ContactProblem(
            np.eye(2),
            np.array([-size, 1.0]),
            np.array([[0.0], [-1.0]]),
            np.array([[0.0, -1]]),
            np.array([-1.0]),
        )
        assert active_set.solve_contact_by_block_pivoting(scaled, off).steps == steps


def hinged_twice():
    """Two springs on a motion each, the first one also against a third spring that stands back."""
    B = -np.array([[1.0, 0], [0, 2], [1, 0]])
    return ContactProblem(
        np.diag([1.0, 4, 1]), np.array([0.5, 0.2, 2]), B, B.T.copy(), np.array([-1.0, -6])
    )


@pytest.mark.parametrize("start", [None, [False] * 3, [True, False, False], [False, True, False]])
def test_every_free_motion_is_resisted_before_the_equations_are_solved(start):
    found = active_set.solve_contact_by_block_pivoting(
        hinged_twice(), None if start is None else np.array(start)
    )
    assert found.p == pytest.approx([1, 3, 0], rel=1e-14)
    assert found.y == pytest.approx([1.5, 6.1], rel=1e-14)
    assert found.w == pytest.approx([0, 0, 0.5], rel=1e-14)


def test_nodes_that_the_actuation_closes_first():
    A, q, B, C, h = hinged_twice()

    def first(*changed, **more):
        return active_set._mask_of_nodes_that_touch_first(ContactProblem(A, *changed), **more)

    assert first(q, B, C, h).tolist() == [True, True, False]
    # The third node closes at once with the others.
    assert first(np.array([0.5, 0.2, 0.5]), B, C, h).tolist() == [True, True, True]
    assert first(np.array([0.5, 0.2, 0.5]), B, C, h, one_node_per_mode=True).tolist() == [
        True,
        True,
        False,
    ]
    # The third node closes more slowly than the others.
    assert first(np.array([0.5, 0.2, 0.4]), B * [[1], [1], [0.5]], C, h).tolist() == [
        True,
        True,
        False,
    ]
    # The pressure of the third would help the actuation.
    resisting = C * [[1, 1, -1]]
    assert first(np.array([0.5, 0.2, 0.1]), B, resisting, h).tolist() == [True, True, False]
    with pytest.raises(NoAnswer, match="cannot balance the actuation anywhere"):
        first(q, B, C, h * [1, -1])


def test_with_two_motions_the_answer_is_regular_where_neither_has_lost_its_resistance():
    """With two rigid-body modes an answer is regular while neither mode has lost its resistance.

    Two negative eigenvalues of C A^-1 B leave the determinant's sign as it was; a whirl is no loss
    of resistance.
    """

    def regular(resistance):
        A, B, p = 4 * np.eye(2), -3 * np.eye(2), np.array([1.0, 2])
        C = -np.asarray(resistance, float)
        return active_set.solve_contact_by_block_pivoting(
            ContactProblem(A, np.zeros(2), B, C, C @ p), np.array([True, True])
        ).stable

    assert regular([[1, 0], [0, 5]])
    assert not regular([[-1, 0], [0, -5]])
    assert not regular([[-1, 0], [0, 5]])
    assert not regular([[1e-3, 4], [0, -5e3]])
    assert regular([[-1, 5], [-5, -1]])


def test_condition_is_that_of_the_equilibrated_equations():
    problem, on = hinged_twice(), np.array([True, True, False])
    # unit diagonal of A, largest entries of the columns of B and rows of C: those of equal springs,
    # each on its motion
    exact = np.linalg.cond(np.block([[np.eye(2), -np.eye(2)], [-np.eye(2), np.zeros((2, 2))]]), 1)
    assert condition_number_on_contact_set(problem, on) == pytest.approx(exact, rel=1e-12)
    assert condition_number_on_contact_set(free(np.eye(2), [1, 1]), np.zeros(2, bool)) == 1.0
    assert (
        condition_number_on_contact_set(free(np.ones((2, 2)), [1, 1]), np.ones(2, bool)) == np.inf
    )


def test_equilibration_makes_units_of_a_b_and_c_and_is_undone():
    problem = ContactProblem(
        np.array([[4.0, 1], [2, 9]]),
        np.array([1.0, 2]),
        np.array([[6.0], [3]]),
        np.array([[4.0, 2]]),
        np.array([8.0]),
    )
    system = scale_contact_problem(problem)
    scaled = system.scaled_contact_problem
    assert np.diagonal(scaled.A) == pytest.approx([1, 1])
    assert scaled.A[0, 1] == pytest.approx(1 / 6) and scaled.q == pytest.approx([1 / 2, 2 / 3])
    assert np.abs(scaled.B).max() == np.abs(scaled.C).max() == 1 and scaled.B[
        1, 0
    ] == pytest.approx(1 / 3)
    assert scaled.h / scaled.C[0, 0] * system.column_scales[0] == pytest.approx(8 / 4)
    assert system.column_scales[2:] == pytest.approx([1 / 3]) and system.row_scales[
        2:
    ] == pytest.approx([1 / 2])
    whole = np.block([[problem.A, problem.B], [problem.C, np.zeros((1, 1))]])
    np.testing.assert_allclose(
        system.K, system.row_scales[:, None] * whole * system.column_scales, rtol=1e-15
    )


def test_coarse_problems_are_those_on_every_other_node():
    for n in (5, 6):
        P = np.array(
            [np.interp(np.arange(n), np.arange(0, n, 2), row) for row in np.eye((n + 1) // 2)]
        ).T
        rows = np.arange(2.0 * n).reshape(n, 2) ** 2
        # The last node of an even number has one neighbour.
        P[-1] = P[-1] if n % 2 else [0, 0, 0.5]
        assert active_set.restrict_array_to_every_other_node(rows) == pytest.approx(P.T @ rows)
        assert active_set.restrict_array_to_every_other_node(rows.T, 1) == pytest.approx(
            (P.T @ rows).T
        )
        assert active_set.interpolate_pressures_to_all_nodes(
            rows[: (n + 1) // 2, 0], n
        ) == pytest.approx(P @ rows[: (n + 1) // 2, 0])
    assert active_set.guess_contact_set_from_coarse_problem(free(np.eye(47), np.ones(47))).all()
    # Where no start is found all nodes are returned.
    assert active_set.guess_contact_set_from_coarse_problem(free(-np.eye(48), -np.ones(48))).all()


def test_a_few_changed_nodes_use_the_factors_that_there_are():
    def start(n):
        return ContactSetEquations(np.eye(n) + 0.1, np.arange(n) < n - 7)

    def changed(base, count):
        return base.free ^ (np.arange(len(base.free)) < count)

    base, few = (
        start(UNKNOWNS_ABOVE_WHICH_BORDERED_SYSTEM_IS_USED + 8),
        is_bordered_system_cheaper_than_new_factors,
    )
    assert few(base, changed(base, UNKNOWNS_ABOVE_WHICH_BORDERED_SYSTEM_IS_USED // 8))
    # More than an eighth of the nodes that are on.
    assert not few(base, changed(base, UNKNOWNS_ABOVE_WHICH_BORDERED_SYSTEM_IS_USED // 8 + 1))
    # A system that is factorised as fast.
    assert not few(
        start(UNKNOWNS_ABOVE_WHICH_BORDERED_SYSTEM_IS_USED + 7),
        changed(start(UNKNOWNS_ABOVE_WHICH_BORDERED_SYSTEM_IS_USED + 7), 1),
    )
    other = base.free ^ np.isin(
        np.arange(len(base.free)), [4, 9, UNKNOWNS_ABOVE_WHICH_BORDERED_SYSTEM_IS_USED + 5]
    )
    x = BorderedEquations(
        base, np.eye(UNKNOWNS_ABOVE_WHICH_BORDERED_SYSTEM_IS_USED + 8) + 0.1, other
    ).solve(-np.arange(1.0, UNKNOWNS_ABOVE_WHICH_BORDERED_SYSTEM_IS_USED + 9))
    assert (
        x[[4, 9, UNKNOWNS_ABOVE_WHICH_BORDERED_SYSTEM_IS_USED + 4]].tolist() == [0, 0, 0]
        and (x != 0).sum() == UNKNOWNS_ABOVE_WHICH_BORDERED_SYSTEM_IS_USED
    )


def test_pairs_of_nodes_that_carry_no_two_motions_are_passed_over_in_silence():
    """A pair of nodes that cannot balance both rigid-body modes is skipped without a warning.

    Two nodes that press along the same line are such a pair.
    """
    B = np.array([[1.0, 0.0], [1.0, 0.5], [2.0, 0.0], [1.0, 1.0]])
    for h in ([1.0, 0.3], [1.0, -0.1]):
        with pytest.raises(NoAnswer, match="cannot balance"):
            active_set._find_touching_nodes_that_balance_shoe_load(
                np.full(4, 0.1), B, -B.T, np.array(h), np.ones(4, dtype=bool)
            )
    first = active_set._find_touching_nodes_that_balance_shoe_load(
        np.full(4, 0.1), B, -B.T, np.array([-1.0, -0.3]), np.ones(4, dtype=bool)
    )
    assert len(set(first)) == 2


def test_with_the_scales_of_another_problem_the_answer_is_the_same():
    rng = np.random.default_rng(5)
    A, x = p_matrix(rng, 6, 0.2), rng.random(6)
    one = ContactProblem(A, -rng.random(6), -x[:, None], -x[None], np.array([-5.0]))
    other = one._replace(A=3 * A + np.eye(6), C=-0.5 * x[None])
    found, like = (
        active_set.solve_contact_by_block_pivoting(other),
        active_set.solve_contact_by_block_pivoting(one).system,
    )
    scaled = active_set.solve_contact_by_block_pivoting(other, scales_of=like)
    assert scale_contact_problem(other, like).row_scales is like.row_scales and not np.array_equal(
        found.system.row_scales, like.row_scales
    )
    np.testing.assert_array_equal(scaled.active, found.active)
    np.testing.assert_allclose(scaled.p, found.p, rtol=1e-12)
    np.testing.assert_allclose(scaled.y, found.y, rtol=1e-12)
    assert scaled.stable == found.stable
