"""Wear as such: against closed forms on a Winkler lining, balances, and the checkerboard of explicit steps."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drumlin.contact import active_set
from drumlin.errors import BadInput
from drumlin.fem.interface import ContactLine, couple, radial
from drumlin.wear.archard import WearInterface, WearLaw, at, explicit, ripple, run, run_on

K, RADIUS, WIDTH, PIN, FORCE, MU = 4e10, 0.15, 0.04, 0.125, 250.0, 0.25
LAW = WearLaw(1e-13)
UNIT = 1 / (LAW.coefficient * K)


def winkler(gap, *, elements=24, mu=MU, arc=(0.3, 2.2)):
    """A rigid shoe on a hinge at (PIN, 0) with a lining of springs K per area, actuation moment FORCE; and its phi."""
    phi = np.linspace(*arc, 2 * elements + 1)
    xy = RADIUS * np.array([np.cos(phi), np.sin(phi)])
    pieces = np.arange(0, 2 * elements, 2) + np.arange(3)[:, None]
    coupling = couple(ContactLine(np.arange(len(phi)), xy, phi, pieces), WIDTH, radial(1))
    turned = np.column_stack([-xy[1], xy[0] - PIN]).ravel()
    approach = coupling.N @ turned
    problem = active_set.Problem(
        A=coupling.M / K,
        q=coupling.M @ gap(phi),
        B=-approach[:, None],
        C=(mu * (coupling.T @ turned) - approach)[None],
        h=np.array([FORCE]),  # the shoe presses as it turns clockwise
    )
    interface = WearInterface(
        problem, np.zeros(len(phi)), coupling.M, np.ones(len(phi)), coupling.area, mu * coupling.lever
    )
    return interface, phi


def test_a_rigid_shoe_on_springs_forgets_its_shape_exponentially():
    """In contact all along p = p_law + exp(-k K s) (p_0 - p_law): rigid motions and equilibrium do not change that."""
    interface, phi = winkler(lambda phi: 2e-6 * np.cos(3 * phi))
    states = run([interface], LAW, distance=6 * UNIT, tolerance=1e-3)
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
        np.abs(run_on([interface], LAW, np.linspace(0, UNIT, n + 1)[1:])[-1].pressure - law - math.exp(-1) * off).max()
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
    states = run([interface], law, distance=1e4 * UNIT)
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
    first = run([interface], LAW, distance=1e-4 * UNIT)
    never = (first[0].pressure == 0) & (first[-1].pressure == 0)
    assert 0.2 < never.mean() < 0.9
    assert (first[-1].depth[never] == 0).all()
    assert (first[-1].depth[first[-1].pressure > 0] > 0).all()


def test_without_wear_nothing_changes():
    interface, _ = winkler(lambda phi: 2e-6 * np.cos(3 * phi))
    states = run([interface], WearLaw(0.0), distance=1e6)
    assert states[-1].s == 1e6
    assert (states[-1].depth == 0).all() and states[-1].removed == 0
    np.testing.assert_allclose(states[-1].pressure, states[0].pressure, rtol=1e-12)
    with pytest.raises(BadInput, match="a distance must be given"):
        run([interface], WearLaw(0.0))


def test_a_held_torque_is_held_and_the_force_follows_from_moments():
    interface, phi = winkler(lambda phi: 2e-6 * np.cos(3 * phi))
    interface = interface._replace(loaded=np.zeros(len(phi)))
    free = run([interface], LAW, distance=20 * UNIT)
    held = run([interface], LAW, distance=20 * UNIT, torque=1.3 * free[-1].torque)
    assert held[0].force != pytest.approx(1.3, rel=1e-2)
    for state in held:
        assert state.torque == pytest.approx(1.3 * free[-1].torque, rel=1e-10)
        assert float(interface.problem.C[0] @ state.pressure) == pytest.approx(FORCE * state.force, rel=1e-9)
    assert held[-1].force == pytest.approx(1.3, rel=1e-6)


def test_the_ripple_sees_an_alternation_and_nothing_smooth():
    x = np.linspace(0, 1, 101)
    smooth = 1 + np.sin(3 * x)
    assert ripple(smooth) < 1e-6
    alternating = smooth + 0.01 * (-1.0) ** np.arange(101)
    assert ripple(alternating) == pytest.approx(0.01 / np.sqrt(np.mean(smooth[5:-5] ** 2)), rel=0.02)
    every_second = np.where(np.arange(101) % 2, 2.0, 0.0)
    assert ripple(every_second) > 0.5
    assert math.isnan(ripple(np.zeros(20)))


def test_explicit_steps_on_nodal_pressures_break_into_a_checkerboard_and_implicit_ones_do_not():
    """On springs the limit of the explicit step is 2/(k K)."""
    interface, _ = winkler(lambda phi: 2e-6 * np.cos(3 * phi))
    size = 2.1 * UNIT
    bad = explicit([interface], LAW, size, 60)[-1]
    good = run_on([interface], LAW, size * np.arange(1, 61))[-1]
    assert ripple(good.pressure) < 1e-4
    assert np.abs(bad.pressure - good.pressure).max() > 0.5 * good.pressure.max()


def test_a_state_between_two_is_interpolated():
    interface, _ = winkler(lambda phi: 2e-6 * np.cos(3 * phi))
    states = run([interface], LAW, distance=UNIT)
    middle = 0.5 * (states[1].s + states[2].s)
    between = at(states, middle)
    np.testing.assert_allclose(between.depth, 0.5 * (states[1].depth + states[2].depth))
    assert at(states, states[2].s) is states[2]


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
        run([interface], law, distance=1.0, **options)
