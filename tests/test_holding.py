"""Holding brakes of all kinds: rotation to full slip and back, a second solver, and refusals."""

import math
from collections import Counter

import numpy as np
import pytest

import independent
from conftest import STUDY
from drumlin.base.errors import NoAnswer
from drumlin.brake.file import read_brake, vary
from drumlin.contact import stick_slip
from drumlin.contact.stick_slip import OPEN, STICK
from drumlin.fem.analysis.at_rest import make_stick_slip_problem_and_slip_per_drum_rotation
from drumlin.fem.analysis.holding import (
    find_drum_rotation_of_full_slip,
    turn_holding_brake_and_return_states_at_rotations,
)
from drumlin.fem.analysis.self_locking import self_locking_friction_of_shoe_groups
from drumlin.fem.equilibrium.group import divide_shoes_into_groups
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin_studies.random_brake import draw_random_brake
from drumlin_studies.random_kinds import draw_random_brake_of_support_kind
from drumlin_studies.standing_off import draw_random_brake_with_clearances
from picking import picked

ELEMENTS = 16
OTHER = {"clockwise": "counter-clockwise", "counter-clockwise": "clockwise"}


def any_brake(seed):
    """A random brake below self-locking, for the tests of `hold`.

    One brake in three has an elastic ring, one in three a lining whose radius is not the drum's.

    The prepared model of the brake is returned as well.
    """
    rng = np.random.default_rng(seed)
    brake = draw_random_brake(seed, ("locking", "opposed")[seed % 2])
    R = brake.size
    if seed % 3 == 1:
        ring = {"thickness": 0.1 * R, "width": 0.04, "material": {"E": 1e11, "nu": 0.3}}
        brake = vary(brake, {"drum.ring": ring | {"support": rng.choice(["fixed", "free"])}})
    if seed % 3 == 2:
        brake = vary(
            brake, {"shoe[0].lining.misfit": {"radius": R * (1 + rng.uniform(-2e-3, 2e-3))}}
        )
    scene = make_prepared_model(brake, elements=ELEMENTS)
    locks = min(
        picked(self_locking_friction_of_shoe_groups(scene, brake, 2.0).values(), "friction")
    )
    return vary(brake, {"friction": rng.uniform(0.1, 0.95) * min(locks, 0.9)}), scene


@pytest.mark.parametrize("count", [4, pytest.param(12, marks=pytest.mark.slow)])
def test_random_brakes_go_through_full_slip_and_back(count):
    """At full slip in either direction, random brakes have the moment of the sliding drum."""
    ends = Counter()
    for seed in range(count):
        brake, scene = any_brake(seed)
        # The drum turns forth until all nodes slip.
        end = find_drum_rotation_of_full_slip(scene, brake, increments=6)
        forth = np.linspace(0, end, 6)
        states = turn_holding_brake_and_return_states_at_rotations(scene, brake, forth)
        assert states[-1].sticking == 0
        assert states[-1].torque == pytest.approx(
            solve_prepared_model(scene, brake).torque, rel=1e-6
        )
        assert np.diff(picked(states, "dissipated")).min() >= -1e-9 * states[-1].dissipated
        assert states[-1].dissipated > 0
        ends["forth"] += 1
        back = vary(brake, {"rotation": OTHER[brake.rotation]})
        try:
            torque = solve_prepared_model(scene, back).torque
        except NoAnswer:
            ends["back it locks"] += 1
            continue
        # The way back first releases the brake, then leads to full slip in the other sense.
        far = end + 3 * max(end, find_drum_rotation_of_full_slip(scene, back))
        state = turn_holding_brake_and_return_states_at_rotations(
            scene, brake, np.concatenate([forth, end - np.linspace(0, far, 10)[1:]])
        )[-1]
        assert state.sticking == 0
        assert state.torque == pytest.approx(-torque, rel=1e-6)
        ends["back"] += 1
    # Some brakes lock the other way; most must not, or the way back would go untested.
    assert ends["forth"] == count
    assert ends["back"] >= 2 * count / 3 - 1, ends


def test_at_the_rotation_of_full_slip_no_path_sticks():
    """At the rotation of full slip no node sticks, however small the increments are.

    On this pad the last node begins to slip later if the increments are smaller.
    """
    pad = draw_random_brake_of_support_kind(410003, "pad on a pivot")
    scene = make_prepared_model(pad, elements=12)
    end = find_drum_rotation_of_full_slip(scene, pad, increments=1)
    for count in (2, 6, 12):
        last = turn_holding_brake_and_return_states_at_rotations(
            scene, pad, np.linspace(0, end, count)
        )[-1]
        assert last.sticking == 0
        assert last.torque == pytest.approx(solve_prepared_model(scene, pad).torque, rel=1e-6)


@pytest.mark.parametrize("times", [10, 640])
def test_an_increment_that_does_not_settle_is_halved(times):
    """An increment of `hold` that does not settle is halved.

    A shoe with a gap is turned in one increment by 10 or 640 times the rotation to full slip, and
    back. At 10 times it needs all halvings that are allowed.
    """
    brake = draw_random_brake_with_clearances(420078)
    scene = make_prepared_model(brake, elements=12)
    far = times * find_drum_rotation_of_full_slip(scene, brake)
    there, back, again = turn_holding_brake_and_return_states_at_rotations(
        scene, brake, np.array([far, -far, far])
    )
    assert there.sticking == back.sticking == again.sticking == 0
    assert again.torque == pytest.approx(there.torque, rel=1e-6)
    assert there.torque == pytest.approx(solve_prepared_model(scene, brake).torque, rel=1e-6)


def test_every_increment_obeys_contact_and_friction():
    """Every increment of `hold` obeys contact and Coulomb's law at each node.

    Gaps, pressures, tractions and slips are taken from the equations and not from the node's state.
    """
    kinds = set()
    for seed in range(6):
        brake, scene = any_brake(seed)
        problem, lever = make_stick_slip_problem_and_slip_per_drum_rotation(
            divide_shoes_into_groups(scene, brake, [0], 1e6)[0]
        )
        end, mu = find_drum_rotation_of_full_slip(scene, brake), brake.friction
        turn = lever * (brake.sign_of_motion / brake.shoes[0].actuation.force)
        nothing = np.zeros(len(lever))
        at = stick_slip.solve_stick_slip_load_increment(
            problem,
            mu,
            stick_slip.TractionsAndSlipsOfLastIncrement(nothing, nothing),
            np.full(len(lever), STICK),
        )
        before = stick_slip.TractionsAndSlipsOfLastIncrement(nothing, nothing)
        for rotation in end * np.array([0.1, 0.5, 1.0, 0.6, -0.4]):
            q_s = problem.q_s + turn * rotation
            before, at = (
                at.tractions_and_slips_for_next_increment,
                stick_slip.solve_stick_slip_load_increment(
                    problem._replace(q_s=q_s),
                    mu,
                    at.tractions_and_slips_for_next_increment,
                    at.state,
                ),
            )
            kinds |= set(at.state.tolist())
            # Gaps w and slides s follow from the equations of the shoe.
            w = problem.q_w + problem.A_wp @ at.p + problem.A_wt @ at.t + problem.B_w @ at.y
            s = q_s + problem.A_sp @ at.p + problem.A_st @ at.t + problem.B_s @ at.y
            slip = s - before.s - problem.Q @ (at.t - before.t)
            of_p, of_w = at.p.max(), np.abs(w).max() + np.abs(problem.q_w).max()
            of_s = np.abs(slip).max() + np.abs(q_s).max()
            assert at.p.min() >= -1e-9 * of_p
            assert w.min() >= -1e-9 * of_w
            # A node that presses has no gap.
            assert (at.p * np.abs(w)).max() <= 1e-9 * of_p * of_w
            # Friction stays within its bound.
            assert (np.abs(at.t) - mu * at.p).max() <= 1e-9 * of_p
            # The distance to the bound of friction is taken in the direction of the slip.
            short = mu * at.p - np.sign(slip) * at.t
            assert (short * np.abs(slip)).max() <= 1e-8 * of_p * of_s
            assert problem.C_p @ at.p + problem.C_t @ at.t == pytest.approx(problem.h, rel=1e-8)
    # Open, sticking and both senses of slip must all have been met.
    assert kinds == {0, 1, 2, 3}


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize(
    "left",
    [
        ("_find_stick_slip_states_by_newton",),
        ("_find_stick_slip_states_by_newton", "_find_stick_slip_states_from_balanced_load"),
    ],
)
def test_both_paths_lead_to_the_answer_of_newtons_method(seed, monkeypatch, left):
    """Both numerical paths lead to the answer of Newton's method.

    One path begins with the present states of the nodes, the other with wide gaps.
    """
    brake, scene = any_brake(seed)
    rotations = find_drum_rotation_of_full_slip(scene, brake) * np.array([0.0, 0.3, 0.6, 1.0, 0.5])
    expected = turn_holding_brake_and_return_states_at_rotations(scene, brake, rotations)
    with monkeypatch.context() as patch:
        for way in left:
            patch.setattr(stick_slip, way, _refuse)
        found = turn_holding_brake_and_return_states_at_rotations(scene, brake, rotations)
    for one, other in zip(found, expected, strict=True):
        largest = other.pressure[0].max()
        assert one.pressure[0] == pytest.approx(other.pressure[0], rel=1e-7, abs=1e-7 * largest)
        assert one.traction[0] == pytest.approx(other.traction[0], rel=1e-7, abs=1e-7 * largest)
        assert (one.state[0] == OPEN).sum() == (other.state[0] == OPEN).sum()


def _refuse(system, start):
    raise NoAnswer("not this way")


@pytest.mark.slow
def test_another_discretisation_and_another_method_give_the_same_history():
    """Triangles with friction by bounded minimisation give the same history as `hold`, to 0.3 %.

    The drum turns forth and back; a layer at quadrature points transmits the contact.
    """
    both = read_brake(STUDY / "flexible.toml")
    brake = both.model_copy(update={"shoes": both.shoes[1:]})
    scene = make_prepared_model(brake, elements=24)
    end = find_drum_rotation_of_full_slip(scene, brake)
    rotations = end * np.array([0.0, 0.3, 0.7, 1.0, 0.5, 0.2, -0.5])
    found = np.array(
        picked(turn_holding_brake_and_return_states_at_rotations(scene, brake, rotations), "torque")
    )
    expected = independent.hold(brake, 0, rotations, 28, 1e3)
    assert found == pytest.approx(expected, abs=3e-3 * found.max())
    # States 3 and 6 are at full slip, in one direction and in the other.
    assert found[[3, 6]] == pytest.approx(expected[[3, 6]], rel=2e-4)


@pytest.mark.slow
def test_the_history_converges_with_the_increment():
    """Errors of moment and dissipated energy fall with the increment, also with a gap to close."""
    brake, scene = any_brake(7)
    brake = vary(brake, {"shoe[0].lining.clearance": 1e-4 * brake.size})
    end = find_drum_rotation_of_full_slip(scene, brake)

    def after(n):
        state = turn_holding_brake_and_return_states_at_rotations(
            scene,
            brake,
            end * np.concatenate([np.linspace(0, 0.6, n), np.linspace(0.6, -0.3, n)[1:]]),
        )[-1]
        return np.array(
            [state.torque / solve_prepared_model(scene, brake).torque, state.dissipated]
        )

    fine = after(161)
    errors = np.abs([after(n) / fine - 1 for n in (6, 11, 21, 41)])
    # The slope of the errors over the number of increments is the order of convergence.
    order = -np.polyfit(np.log([5, 10, 20, 40]), np.log(np.maximum(errors, 1e-9)), 1)[0]
    assert errors[-1].max() < 0.01
    assert order[1] > 0.8


@pytest.mark.parametrize("rotation", ["clockwise", "counter-clockwise"])
def test_self_locking_is_refused_with_its_limit(rotation):
    both = read_brake(STUDY / "flexible.toml")
    brake = vary(both.model_copy(update={"shoes": both.shoes[:1]}), {"rotation": rotation})
    scene = make_prepared_model(brake, elements=ELEMENTS)
    locks = self_locking_friction_of_shoe_groups(scene, brake)[0,].friction
    if math.isinf(locks):
        strong = vary(brake, {"friction": 1.5})
        assert find_drum_rotation_of_full_slip(scene, strong) > 0
        return
    for share in (0.97, 1.03):
        strong = vary(brake, {"friction": share * locks})
        if share < 1:
            torque = turn_holding_brake_and_return_states_at_rotations(
                scene, strong, np.linspace(0, find_drum_rotation_of_full_slip(scene, strong), 5)
            )[-1].torque
            assert torque == pytest.approx(solve_prepared_model(scene, strong).torque, rel=1e-6)
        else:
            with pytest.raises(NoAnswer, match=rf"self-locking.*mu_lock = {locks:.4g}"):
                find_drum_rotation_of_full_slip(scene, strong)
