"""Wear: closed forms on a Winkler lining, balances, and the checkerboard of explicit steps."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drumlin.base.errors import BadInput, NoAnswer
from drumlin.lining_wear.archard import (
    WearLaw,
    WearState,
    _mask_of_true_with_true_neighbours,
    distance_after_which_values_stay_small,
    interpolate_wear_state_at_distance,
    join_contact_problems_of_lining_groups,
    relative_amplitude_of_node_to_node_pressure_ripple,
    wear_linings_by_explicit_euler,
    wear_linings_in_given_steps,
    wear_linings_over_sliding_distance,
)
from picking import picked
from winkler_lining import FORCE, LAW, MU, RADIUS, UNIT, winkler


def test_a_rigid_shoe_on_springs_forgets_its_shape_exponentially():
    """A rigid shoe on springs forgets its shape as p = p_law + exp(-k K s) (p_0 - p_law).

    The lining is in contact all along: rigid-body modes and equilibrium do not change this decay.
    """
    interface, phi = winkler(lambda phi: 2e-6 * np.cos(3 * phi))
    states = wear_linings_over_sliding_distance([interface], LAW, distance=6 * UNIT, tolerance=1e-3)
    assert (states[0].pressure > 0).all()
    amplitude = FORCE / float(interface.problem.C[0] @ np.sin(phi))
    law = amplitude * np.sin(phi)
    off = states[0].pressure - law
    assert np.abs(off).max() > 0.2 * amplitude
    for state in states:
        expected = law + math.exp(-state.s / UNIT) * off
        np.testing.assert_allclose(state.pressure, expected, atol=1e-3 * amplitude)
    # of second order: four times the steps, a sixteenth of the error
    errors = [
        np.abs(
            wear_linings_in_given_steps([interface], LAW, np.linspace(0, UNIT, n + 1)[1:])[
                -1
            ].pressure
            - law
            - math.exp(-1) * off
        ).max()
        for n in (4, 16)
    ]
    assert errors[0] / errors[1] == pytest.approx(16, rel=0.25)


@given(
    depth=st.floats(1e-6, 3e-5),
    lobes=st.integers(1, 6),
    phase=st.floats(0, 6),
    exponent=st.sampled_from([0.6, 1.0, 1.7]),
)
def test_any_misfit_wears_to_the_law_in_balance(depth, lobes, phase, exponent):
    """From partial contact too; no depth shrinks, and the volume is the integral of the rate."""
    interface, phi = winkler(lambda phi: depth * (1 + np.cos(lobes * phi + phase)), elements=12)
    law = WearLaw(LAW.coefficient, exponent, 2e5)
    states = wear_linings_over_sliding_distance([interface], law, distance=1e4 * UNIT)
    shape = np.sin(phi) ** (1 / exponent)
    goal = shape * FORCE / float(interface.problem.C[0] @ shape)
    inner = slice(2, -2)
    assert np.linalg.norm((states[-1].pressure - goal)[inner]) < 2e-3 * np.linalg.norm(goal[inner])
    for a, b in pairwise(states):
        assert (b.depth - a.depth).min() >= -1e-12 * b.depth.max()
    assert float(interface.area @ states[-1].depth) == pytest.approx(states[-1].removed, rel=1e-9)
    if exponent == 1:
        assert states[-1].removed == pytest.approx(LAW.coefficient * states[-1].pressed, rel=1e-9)
        assert states[-1].work == pytest.approx(MU * RADIUS * states[-1].pressed, rel=1e-6)


def test_only_what_is_pressed_wears():
    interface, _ = winkler(lambda phi: 4e-5 * (phi - 0.3))
    first = wear_linings_over_sliding_distance([interface], LAW, distance=1e-4 * UNIT)
    never = (first[0].pressure == 0) & (first[-1].pressure == 0)
    assert 0.2 < never.mean() < 0.9
    assert (first[-1].depth[never] == 0).all()
    assert (first[-1].depth[first[-1].pressure > 0] > 0).all()


def test_without_wear_nothing_changes():
    interface, _ = winkler(lambda phi: 2e-6 * np.cos(3 * phi))
    states = wear_linings_over_sliding_distance([interface], WearLaw(0.0), distance=1e6)
    assert states[-1].s == 1e6
    assert (states[-1].depth == 0).all() and states[-1].removed == 0
    np.testing.assert_allclose(states[-1].pressure, states[0].pressure, rtol=1e-12)
    with pytest.raises(BadInput, match="a distance in m must be given"):
        wear_linings_over_sliding_distance([interface], WearLaw(0.0))


def test_a_held_torque_is_held_and_the_force_follows_from_moments():
    interface, phi = winkler(lambda phi: 2e-6 * np.cos(3 * phi))
    interface = interface._replace(loaded=np.zeros(len(phi)))
    free = wear_linings_over_sliding_distance([interface], LAW, distance=20 * UNIT)
    held = wear_linings_over_sliding_distance(
        [interface], LAW, distance=20 * UNIT, torque=1.3 * free[-1].torque
    )
    assert held[0].force != pytest.approx(1.3, rel=1e-2)
    for state in held:
        assert state.torque == pytest.approx(1.3 * free[-1].torque, rel=1e-10)
        assert float(interface.problem.C[0] @ state.pressure) == pytest.approx(
            FORCE * state.force, rel=1e-9
        )
    assert held[-1].force == pytest.approx(1.3, rel=1e-6)


def test_the_ripple_sees_an_alternation_and_nothing_smooth():
    smooth = 1 + np.sin(3 * np.linspace(0, 1, 101))
    assert relative_amplitude_of_node_to_node_pressure_ripple(smooth) < 1e-6
    alternating = smooth + 0.01 * (-1.0) ** np.arange(101)
    assert relative_amplitude_of_node_to_node_pressure_ripple(alternating) == pytest.approx(
        0.01 / np.sqrt(np.mean(smooth[5:-5] ** 2)), rel=0.02
    )
    every_second = np.where(np.arange(101) % 2, 2.0, 0.0)
    assert relative_amplitude_of_node_to_node_pressure_ripple(every_second) > 0.5
    assert math.isnan(relative_amplitude_of_node_to_node_pressure_ripple(np.zeros(20)))


def test_explicit_steps_on_nodal_pressures_break_into_a_checkerboard_and_implicit_ones_do_not():
    """On springs the limit of the explicit step is 2/(k K)."""
    interface, _ = winkler(lambda phi: 2e-6 * np.cos(3 * phi))
    size = 2.1 * UNIT
    bad = wear_linings_by_explicit_euler([interface], LAW, size, 60)[-1]
    good = wear_linings_in_given_steps([interface], LAW, size * np.arange(1, 61))[-1]
    assert relative_amplitude_of_node_to_node_pressure_ripple(good.pressure) < 1e-4
    assert np.abs(bad.pressure - good.pressure).max() > 0.5 * good.pressure.max()


def test_a_state_between_two_is_interpolated():
    interface, _ = winkler(lambda phi: 2e-6 * np.cos(3 * phi))
    states = wear_linings_over_sliding_distance([interface], LAW, distance=UNIT)
    middle = 0.5 * (states[1].s + states[2].s)
    between = interpolate_wear_state_at_distance(states, middle)
    np.testing.assert_allclose(between.depth, 0.5 * (states[1].depth + states[2].depth))
    assert interpolate_wear_state_at_distance(states, states[2].s) is states[2]


@pytest.mark.parametrize(
    ("law", "options", "word"),
    [
        (WearLaw(-1.0), {}, "coefficient"),
        (WearLaw(1.0, 9.0), {}, "exponent"),
        (LAW, {"tolerance": 0.0}, "tolerance"),
        (LAW, {"reverse": 1.0}, "backward"),
    ],
)
def test_bad_input_is_named(law, options, word):
    interface, _ = winkler(np.zeros_like)
    with pytest.raises(BadInput, match=word):
        wear_linings_over_sliding_distance([interface], law, distance=1.0, **options)


@pytest.mark.parametrize("exponent", [0.5, 1.0, 2.0, 3.0])
def test_the_rate_and_its_slope(exponent):
    """The rate of wear k p (p/p_ref)^(m - 1), and its slope.

    For m < 1 the rate is rounded off at small p, so that the slope stays finite.
    """
    law, p = WearLaw(2e-13, exponent, 4e5), np.array([1e5, 4e5, 9e5])
    rate, slope = law.wear_rate_and_its_slope(p, 0.0)
    np.testing.assert_allclose(rate, 2e-13 * p * (p / 4e5) ** (exponent - 1), rtol=1e-14)
    np.testing.assert_allclose(slope, exponent * rate / p, rtol=1e-14)
    for rounded in (0.0, 1e5):
        ends = [
            law.wear_rate_and_its_slope(p - 1.0, rounded)[0],
            law.wear_rate_and_its_slope(p + 1.0, rounded)[0],
        ]
        np.testing.assert_allclose(
            law.wear_rate_and_its_slope(p, rounded)[1], (ends[1] - ends[0]) / 2, rtol=1e-8
        )
    if exponent < 1:
        rate, slope = law.wear_rate_and_its_slope(np.array([0.0, 1e5]), 1e5)
        assert rate[0] == 0 and slope[0] == pytest.approx(2e-13 * (1e5 / 4e5) ** (exponent - 1))
        assert rate[1] == pytest.approx(2e-13 * 1e5 * (math.sqrt(2) * 1e5 / 4e5) ** (exponent - 1))


def test_the_distance_from_which_on_values_stay_small():
    s = [0.0, 1.0, 2.0, 4.0]
    assert distance_after_which_values_stay_small(s, [0.1, -0.2, 0.1, 0.2], 0.2) == 0.0
    assert distance_after_which_values_stay_small(s, [3.0, 0.0, -2.0, 0.0], 0.5) == pytest.approx(
        3.5
    )
    assert distance_after_which_values_stay_small(s, [0.0, -1.0, -0.4, 0.0], 0.7) == pytest.approx(
        1.5
    )
    assert distance_after_which_values_stay_small(s, [1.0, 0.0, 0.0, 3.0], 0.5) == math.inf


def test_every_number_of_a_state_between_two_is_interpolated():
    a = WearState(1.0, np.array([0.0, 2]), np.array([4.0, 8]), 10.0, 1.0, True, 2.0, 3.0, 4.0)
    b = WearState(3.0, np.array([4.0, 6]), np.array([0.0, 4]), 30.0, 3.0, False, 6.0, 7.0, 8.0)
    found = interpolate_wear_state_at_distance([a, b], 1.5)
    assert (found.s, found.torque, found.force, found.forward) == (1.5, 15.0, 1.5, False)
    assert (found.removed, found.pressed, found.work) == (3.0, 4.0, 5.0)
    assert found.depth.tolist() == [1, 3] and found.pressure.tolist() == [3, 7]
    assert (
        interpolate_wear_state_at_distance([a, b], 0.5) is a
        and interpolate_wear_state_at_distance([a, b], 3.0) is b
    )
    # Beyond the last state the straight line goes on.
    assert interpolate_wear_state_at_distance([a, b], 4.0).torque == 40.0


def test_rubs_together_are_block_by_block_and_wear_as_each_alone():
    (one, _), (two, _) = (
        winkler(lambda phi, k=k: 2e-6 * np.cos(k * phi), elements=8) for k in (2, 3)
    )
    both = join_contact_problems_of_lining_groups([one, two])
    n = len(one.area)
    for whole, parts in (
        (both.problem.A, (one.problem.A, two.problem.A)),
        (both.weight, (one.weight, two.weight)),
    ):
        assert (whole[:n, :n] == parts[0]).all() and (whole[n:, n:] == parts[1]).all()
        assert not whole[:n, n:].any() and not whole[n:, :n].any()
    assert (
        both.problem.B.shape == (2 * n, 2)
        and both.problem.C.shape == (2, 2 * n)
        and len(both.problem.h) == 2
    )
    steps = UNIT * np.array([0.2, 0.6])
    alone = [
        wear_linings_in_given_steps([one], LAW, steps)[-1],
        wear_linings_in_given_steps([two], LAW, steps)[-1],
    ]
    for state in (
        wear_linings_in_given_steps([both], LAW, steps)[-1],
        wear_linings_in_given_steps([one, two], LAW, steps)[-1],
    ):
        np.testing.assert_allclose(state.depth, np.concatenate(picked(alone, "depth")), rtol=1e-9)
        assert state.torque == pytest.approx(sum(picked(alone, "torque")), rel=1e-12)
        assert state.removed == pytest.approx(sum(picked(alone, "removed")), rel=1e-12)
        assert state.s == steps[-1]


def test_steps_keep_their_tolerance_and_end_where_they_are_asked_to():
    interface, _ = winkler(lambda phi: 2e-6 * np.cos(3 * phi), elements=8)
    fine = wear_linings_over_sliding_distance([interface], LAW, distance=3 * UNIT, tolerance=1e-5)
    coarse = wear_linings_over_sliding_distance([interface], LAW, distance=3 * UNIT, tolerance=1e-2)
    assert coarse[-1].s == fine[-1].s == 3 * UNIT
    assert 3 < len(coarse) < len(fine) / 5
    for state in coarse:
        exact = interpolate_wear_state_at_distance(fine, state.s).pressure
        assert np.linalg.norm(state.pressure - exact) < 1e-2 * np.linalg.norm(exact)
    assert max(b.s - a.s for a, b in pairwise(coarse)) < 4.001 * (coarse[-1].s - coarse[-4].s)
    stopped = wear_linings_over_sliding_distance(
        [interface], LAW, until=lambda state: state.removed > 0.3 * coarse[-1].removed
    )
    assert stopped[-2].removed <= 0.3 * coarse[-1].removed < stopped[-1].removed
    third = wear_linings_over_sliding_distance([interface], LAW, distance=3 * UNIT, tolerance=1e-2)
    # A run must not keep anything of the one before.
    assert picked(third, "s") == picked(coarse, "s")


def test_a_drum_that_turns_back_and_forth():
    """Wear on a drum that turns back and forth goes each way as far as asked.

    At a turn the depth stays, and the pressure is that of the other rotation.
    """
    (ahead, _), (back, _) = (
        winkler(lambda phi: 2e-6 * np.cos(3 * phi), elements=8, mu=mu) for mu in (MU, -MU)
    )
    states = wear_linings_over_sliding_distance(
        [ahead], LAW, backward=[back], reverse=UNIT, distance=2.5 * UNIT, tolerance=1e-2
    )
    turns = [i for i, (a, b) in enumerate(pairwise(states)) if a.forward != b.forward]
    assert [states[i].s for i in turns] == pytest.approx([UNIT, 2 * UNIT], rel=1e-12)
    assert [states[i].forward for i in (0, turns[0], turns[1], -1)] == [True, True, False, True]
    assert states[-1].s == 2.5 * UNIT
    for i in turns:
        assert states[i + 1].s == states[i].s and (states[i + 1].depth == states[i].depth).all()
        assert states[i + 1].removed == states[i].removed and states[i + 1].work == states[i].work
    (turned,) = wear_linings_in_given_steps([back], LAW, [])
    assert states[turns[0] + 1].torque * turned.torque > 0 > states[turns[0]].torque * turned.torque


def test_explicit_steps_add_up_what_they_wear():
    interface, _ = winkler(lambda phi: 2e-6 * np.cos(3 * phi), elements=8)
    states = wear_linings_by_explicit_euler([interface], LAW, 0.1 * UNIT, 3)
    assert picked(states, "s") == pytest.approx([0, 0.1 * UNIT, 0.2 * UNIT, 0.3 * UNIT])
    for a, b in pairwise(states):
        np.testing.assert_allclose(
            b.depth - a.depth, LAW.coefficient * 0.1 * UNIT * a.pressure, rtol=1e-9, atol=1e-20
        )
        assert b.removed - a.removed == pytest.approx(
            float(interface.area @ (b.depth - a.depth)), rel=1e-9
        )
        assert b.pressed - a.pressed == pytest.approx(
            0.1 * UNIT * float(interface.area @ a.pressure), rel=1e-9
        )
        assert b.work - a.work == pytest.approx(0.1 * UNIT * a.torque, rel=1e-9)


def test_what_never_settles_or_locks_is_given_up(monkeypatch):
    interface, _ = winkler(lambda phi: 2e-6 * np.cos(3 * phi), elements=8)
    monkeypatch.setattr("drumlin.lining_wear.archard.MAX_WEAR_STEPS", 5)
    with pytest.raises(NoAnswer, match="not settled after 5 steps"):
        wear_linings_over_sliding_distance([interface], LAW, tolerance=1e-4)
    C = -interface.problem.C
    with pytest.raises(NoAnswer, match="self-locking"):
        wear_linings_over_sliding_distance(
            [interface._replace(problem=interface.problem._replace(C=C, h=-interface.problem.h))],
            LAW,
            distance=UNIT,
        )


def test_margins_are_taken_off_on_both_sides():
    where = np.array([0, 1, 1, 1, 0, 1, 1, 1, 1, 1], bool)
    assert _mask_of_true_with_true_neighbours(where, 1, beyond=False).astype(int).tolist() == [
        0,
        0,
        1,
        0,
        0,
        0,
        1,
        1,
        1,
        0,
    ]
    assert _mask_of_true_with_true_neighbours(where, 1, beyond=True).astype(int).tolist() == [
        0,
        0,
        1,
        0,
        0,
        0,
        1,
        1,
        1,
        1,
    ]
    p = np.where(np.arange(40) < 20, 0.0, 1.0) * (1 + 0.1 * (-1.0) ** np.arange(40))
    # The rates are 1.1 and 0.9 in turn from node 20 on. The node before might be one of a
    # checkerboard, so that nodes 24 to 34 count.
    assert relative_amplitude_of_node_to_node_pressure_ripple(p) == pytest.approx(
        0.1 / math.sqrt((6 * 1.1**2 + 5 * 0.9**2) / 11), rel=1e-9
    )
    assert math.isnan(
        relative_amplitude_of_node_to_node_pressure_ripple(np.where(np.arange(40) < 8, 1.0, 0.0))
    )
