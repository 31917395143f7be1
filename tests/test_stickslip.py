"""Stick and slip: five friction states, directions, energy, tangents, the holding brake."""

import math

import numpy as np
import pytest
import skfem
from hypothesis import given
from hypothesis import strategies as st

from conftest import STUDY
from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.elasticity import ElasticLayer
from drumlin.brake.fields import Material
from drumlin.brake.file import read_brake, vary
from drumlin.contact import active_set, equations, stick_slip
from drumlin.contact.stick_slip import (
    BACKWARD,
    FORWARD,
    OPEN,
    STICK,
    StickSlipProblem,
    TractionsAndSlipsOfLastIncrement,
)
from drumlin.fem.analysis.at_rest import make_stick_slip_problem_and_slip_per_drum_rotation
from drumlin.fem.analysis.holding import (
    find_drum_rotation_of_full_slip,
    holding_states_as_plain_data,
    turn_drum_in_increments,
    turn_holding_brake_and_return_states_at_rotations,
)
from drumlin.fem.equilibrium.group import ShoeGroup
from drumlin.fem.mesh.degree import nodal_basis_of_mesh
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.substructure.body import (
    condense_body_to_contact_and_hinge_face,
    multi_point_constraints_of_body,
    sparse_stiffness_of_body,
)
from drumlin.fem.substructure.interface import (
    ContactLine,
    coupling_matrices_of_contact_line,
    make_contact_line_of_lining,
)
from picking import picked
from shared_parts import drum_ring

BRAKE = read_brake(STUDY / "brake.toml")
SCENE = make_prepared_model(BRAKE, elements=30)


def spring(push, shift, stiffness=100.0, penalty=0.0):
    """One node on a normal and a tangential spring, pushed against a drum moved by `shift`.

    The load is -push.
    """
    one, none = np.ones((1, 1)), np.zeros((1, 1))
    return StickSlipProblem(
        A_wp=one / stiffness,
        A_wt=none,
        A_sp=none,
        A_st=-one / stiffness,
        B_w=np.zeros((1, 0)),
        B_s=np.zeros((1, 0)),
        C_p=np.zeros((0, 1)),
        C_t=np.zeros((0, 1)),
        q_w=np.array([-push / stiffness]),
        q_s=np.array([shift]),
        h=np.zeros(0),
        Q=penalty * one,
    )


REST = TractionsAndSlipsOfLastIncrement(np.zeros(1), np.zeros(1))


@pytest.mark.parametrize(
    ("mu", "shift", "state", "t"),
    [
        # Without friction the node slips at once.
        (0.0, 0.05, FORWARD, 0.0),
        # With infinite friction the node never slips.
        (math.inf, 0.05, STICK, 5.0),
        # This node is just at its limit mu p = 5.
        (0.5, 0.05, STICK, 5.0),
        # This node slips.
        (0.5, 0.20, FORWARD, 5.0),
        # This node sticks.
        (0.5, 0.02, STICK, 2.0),
        # This node slips the other way.
        (0.5, -0.20, BACKWARD, -5.0),
    ],
)
def test_friction_states_of_one_node_are_exact(mu, shift, state, t):
    found = stick_slip.solve_stick_slip_load_increment(
        spring(10.0, shift), mu if mu < math.inf else 1e300, REST, np.array([STICK])
    )
    assert found.p[0] == pytest.approx(10.0, rel=1e-14)
    assert found.t[0] == pytest.approx(t, rel=1e-12, abs=1e-12)
    if mu:
        assert found.state[0] == state


def test_an_open_node_carries_nothing():
    found = stick_slip.solve_stick_slip_load_increment(
        spring(-3.0, 0.2), 0.5, REST, np.array([STICK])
    )
    assert (found.p[0], found.t[0], found.state[0]) == (0, 0, OPEN)


def test_a_tangential_penalty_is_an_elastic_slip():
    """Series springs: with compliance Q beside 1/k a shift of 0.02 gives t = 0.02/(1/k + Q)."""
    found = stick_slip.solve_stick_slip_load_increment(
        spring(10.0, 0.02, penalty=0.01), 0.5, REST, np.array([STICK])
    )
    assert found.t[0] == pytest.approx(0.02 / 0.02, rel=1e-12)


def test_a_closed_loop_dissipates_its_area():
    """A closed loop of sliding dissipates its area, 4 mu p (shift - mu p/k).

    The drum moves forth and back beyond the limit of sticking.
    """
    mu, push, k, top = 0.5, 10.0, 100.0, 0.2
    path = np.concatenate(
        [np.linspace(0, top, 41), np.linspace(top, -top, 81), np.linspace(-top, top, 81)]
    )
    history, state = REST, np.array([STICK])
    work = dissipated = 0.0
    previous, states = (0.0, 0.0), set()
    for k_step, shift in enumerate(path):
        found = stick_slip.solve_stick_slip_load_increment(
            spring(push, shift, k), mu, history, state
        )
        # The closed part of the path goes from top to top.
        if k_step > 40:
            work += 0.5 * (found.t[0] + previous[1]) * (shift - previous[0])
            dissipated += found.t[0] * (found.s[0] - history.s[0])
        history, state, previous = (
            found.tractions_and_slips_for_next_increment,
            found.state,
            (shift, found.t[0]),
        )
        states.add(int(found.state[0]))
    assert states == {STICK, FORWARD, BACKWARD}
    assert dissipated == pytest.approx(4 * mu * push * (top - mu * push / k), rel=1e-9)
    # Trapezoids cut the corners of the loop.
    assert work == pytest.approx(dissipated, rel=0.02)


def test_solving_twice_changes_nothing():
    """A second evaluation gives the same answer and leaves the friction's history as it was.

    The history is an input.
    """
    history = TractionsAndSlipsOfLastIncrement(np.array([1.0]), np.array([0.01]))
    a = stick_slip.solve_stick_slip_load_increment(
        spring(10.0, 0.2), 0.5, history, np.array([STICK])
    )
    b = stick_slip.solve_stick_slip_load_increment(
        spring(10.0, 0.2), 0.5, history, np.array([STICK])
    )
    assert (a.t, a.s) == (b.t, b.s)
    assert (history.t[0], history.s[0]) == (1.0, 0.01)


@given(st.integers(0, 500))
def test_the_equations_of_the_found_states_hold_and_their_tangent_agrees_with_differences(seed):
    """The equations of the found friction states hold, and their tangent agrees with differences.

    Open, sticking and slipping nodes together: residuals vanish, and p, t move with the load by
    their linear equations.
    """
    problem, lever = make_stick_slip_problem_and_slip_per_drum_rotation(
        ShoeGroup(SCENE, BRAKE, (seed % 2,), 1e4)
    )
    rng = np.random.default_rng(seed)
    rotation = 10 ** rng.uniform(-5.5, -3.5)
    n = len(lever)
    rest = TractionsAndSlipsOfLastIncrement(np.zeros(n), np.zeros(n))
    mu = 0.3
    found = stick_slip.solve_stick_slip_load_increment(problem, mu, rest, np.full(n, STICK))
    for found_next in turn_drum_in_increments(problem, lever / 2000.0, mu, found, 0.0, rotation):
        before, state, found = found.tractions_and_slips_for_next_increment, found.state, found_next
    moved = problem._replace(q_s=problem.q_s + lever * rotation / 2000.0)
    assert (np.abs(found.t) <= mu * found.p + 1e-8 * found.p.max()).all()
    slip = found.s - before.s - problem.Q @ (found.t - before.t)
    sticks = found.state == STICK
    assert np.abs(slip[sticks]).max(initial=0) < 1e-9 * np.abs(found.s).max()
    # Friction can only dissipate.
    assert (found.t * slip >= -1e-9 * np.abs(found.t).max() * np.abs(found.s).max()).all()
    step = 1e-6 * rotation
    nearby = stick_slip.solve_stick_slip_load_increment(
        moved._replace(q_s=moved.q_s + lever * step / 2000.0), mu, before, state
    )
    # Within one set of states the answer is linear: twice the step, twice the change.
    if np.array_equal(nearby.state, found.state):
        again = stick_slip.solve_stick_slip_load_increment(
            moved._replace(q_s=moved.q_s + 2 * lever * step / 2000.0), mu, before, state
        )
        if np.array_equal(again.state, found.state):
            change = np.abs(found.t).max()
            assert again.t - nearby.t == pytest.approx(nearby.t - found.t, abs=1e-9 * change)


def test_direction_of_friction_on_a_wedge():
    """NAFEMS CGS-4: a wedge pushed up has F/G = (tan a + mu)/(1 - mu tan a) = .412371.

    tan a = .1 and mu = .3.
    """
    slope, mu = math.atan(0.1), 0.3
    x = np.linspace(0, 1, 5)
    line = ContactLine(
        np.arange(5),
        np.array([x * math.cos(slope), x * math.sin(slope)]),
        x,
        np.array([[0, 2], [1, 3], [2, 4]]),
    )
    # The outward normal of the block points into the wedge.
    down = np.array([math.sin(slope), -math.cos(slope)])
    # The block moves up along the slope.
    up = np.array([math.cos(slope), math.sin(slope)])

    def directions(points):
        shape = (2, *([1] * (points.ndim - 1)))
        return down.reshape(shape) * np.ones_like(points), -up.reshape(shape) * np.ones_like(points)

    coupling = coupling_matrices_of_contact_line(line, 1.0, directions)
    p = np.full(5, 7.0)
    on_block = (-coupling.N.T @ p + mu * coupling.T.T @ p).reshape(-1, 2).sum(axis=0)
    # The push balances the horizontal part, the weight the vertical one.
    F, G = (-on_block[0], on_block[1])
    assert pytest.approx(0.412371, abs=5e-7) == F / G


@pytest.mark.parametrize("turned", [0.0, 0.4, 1.1])
def test_flat_patch_whole_and_inclined(turned):
    """A strip pressed on a plane of any inclination has an even pressure and its resultant.

    Both hold to round-off.
    """
    grid = skfem.MeshQuad.init_tensor(np.array([0, 0.3, 1.1, 2.0]), np.array([0, 0.4, 0.5, 1.0]))
    middle = grid.p[:, grid.facets].mean(axis=1)
    mesh = skfem.MeshQuad2.from_mesh(grid)
    x, y = mesh.doflocs
    c, s = math.cos(turned), math.sin(turned)
    mesh = skfem.MeshQuad2(
        np.array([c * x - s * y, s * x + c * y]) + np.array([[3.0], [1.0]]),
        mesh.t,
        _subdomains={"body": np.arange(mesh.nelements)},
        _boundaries={
            "contact": np.flatnonzero(middle[1] < 1e-12),
            "support": np.flatnonzero(middle[1] > 1 - 1e-12),
        },
    )
    basis = nodal_basis_of_mesh(mesh)
    line = make_contact_line_of_lining(basis, mesh.boundaries["contact"], math.atan2(1.0, 3.0))
    normal = np.array([s, -c])
    top = basis.get_dofs(mesh.boundaries["support"]).flatten()
    # nu = 0 and a rigid top: pressing by a distance strains the strip evenly
    K = sparse_stiffness_of_body(
        basis, {"body": ElasticLayer.make_layer_in_plane_stress(Material(E=2e6, nu=0.0), 1.0)}
    )
    condensed = condense_body_to_contact_and_hinge_face(
        K,
        multi_point_constraints_of_body(basis, line.nodes, top, np.zeros(2)),
        {},
        2 * len(line.nodes),
    )

    def directions(points):
        shape = (2, *([1] * (points.ndim - 1)))
        return normal.reshape(shape) * np.ones_like(points), np.array([c, s]).reshape(
            shape
        ) * np.ones_like(points)

    coupling = coupling_matrices_of_contact_line(line, 1.0, directions)
    Y = condensed.half_flexibility_under_nodal_forces(-coupling.N.T)
    # The strip of height 1 has the strain -.05, which gives s = -1e5.
    depth = 0.05
    n = len(line.nodes)
    problem = equations.ContactProblem(
        Y.T @ Y, coupling.M @ np.full(n, -depth), np.zeros((n, 0)), np.zeros((0, n)), np.zeros(0)
    )
    assert active_set.solve_contact_problem(problem).p == pytest.approx(np.full(n, 1e5), rel=1e-10)


def test_a_holding_brake_saturates_at_its_full_slip_torque():
    states = turn_holding_brake_and_return_states_at_rotations(
        SCENE, BRAKE, np.linspace(0, find_drum_rotation_of_full_slip(SCENE, BRAKE), 13)
    )
    torques = np.array(picked(states, "torque"))
    # At rest both shoes balance each other by symmetry.
    assert abs(torques[0]) < 1e-9 * torques[-1]
    assert (np.diff(torques[:-1]) > 0).all()
    # Full slip is reached before the last state.
    assert torques[-2] == pytest.approx(torques[-1], rel=1e-9)
    assert states[0].sticking > 0.1
    assert 0 < states[6].sticking < states[1].sticking
    assert states[-1].sticking == 0
    full = solve_prepared_model(SCENE, BRAKE)
    assert torques[-1] == pytest.approx(full.torque, rel=1e-9)
    for mine, theirs in zip(states[-1].pressure, full.shoes, strict=True):
        assert mine == pytest.approx(theirs.pressure, rel=1e-6, abs=1e-7 * theirs.pressure.max())
    middle = states[6]
    assert any(middle.stick) and all(middle.slip)
    assert np.diff(picked(states, "dissipated")).min() > 0
    assert {"stick", "slip"} <= set(holding_states_as_plain_data(states)[6]["shoes"][1]["state"])


def test_more_increments_change_little_and_turning_on_changes_nothing_more():
    end = find_drum_rotation_of_full_slip(SCENE, BRAKE)
    coarse = turn_holding_brake_and_return_states_at_rotations(
        SCENE, BRAKE, np.linspace(0, 0.5 * end, 5)
    )[-1].torque
    fine = turn_holding_brake_and_return_states_at_rotations(
        SCENE, BRAKE, np.linspace(0, 0.5 * end, 33)
    )[-1].torque
    assert coarse == pytest.approx(fine, rel=0.02)
    beyond = turn_holding_brake_and_return_states_at_rotations(
        SCENE, BRAKE, np.array([0.0, end, 2 * end])
    )
    assert beyond[2].torque == pytest.approx(beyond[1].torque, rel=1e-9)


def test_the_work_of_the_drum_and_of_the_force_is_dissipated_or_stored():
    """Forth to full slip and back: over a closed cycle of the drum what goes in is dissipated."""
    end = find_drum_rotation_of_full_slip(SCENE, BRAKE)
    there, back = np.linspace(0, 2 * end, 25), np.linspace(2 * end, -2 * end, 97)[1:]
    states = turn_holding_brake_and_return_states_at_rotations(
        SCENE, BRAKE, np.concatenate([there, back, np.linspace(-2 * end, 2 * end, 97)[1:]])
    )
    loop = states[24:]
    rotation, torque = np.array(picked(loop, "rotation")), np.array(picked(loop, "torque"))
    work = float(np.trapezoid(torque, rotation))
    dissipated = loop[-1].dissipated - loop[0].dissipated
    assert torque.min() < 0 < torque.max()
    assert loop[-1].torque == pytest.approx(loop[0].torque, rel=1e-6)
    # Both are integrals by trapezoids.
    assert dissipated == pytest.approx(work, rel=0.03)


def test_refusals():
    with pytest.raises(BadInput, match="friction = 0"):
        turn_holding_brake_and_return_states_at_rotations(
            SCENE, vary(BRAKE, {"friction": 0.0}), np.array([0.0])
        )
    with pytest.raises(NoAnswer, match="does not touch"):
        turn_holding_brake_and_return_states_at_rotations(
            SCENE, vary(BRAKE, {"shoe[1].actuation.force": -1.0}), np.array([0.0])
        )


def test_a_ring_takes_part_in_holding():
    spec = vary(BRAKE, drum_ring(0.015, "fixed"))
    scene = make_prepared_model(spec, elements=20)
    # At full slip holding and sliding brakes have the same torque.
    states = turn_holding_brake_and_return_states_at_rotations(
        scene, spec, np.linspace(0, find_drum_rotation_of_full_slip(scene, spec), 4)
    )
    assert states[-1].torque == pytest.approx(solve_prepared_model(scene, spec).torque, rel=1e-9)


@pytest.mark.parametrize(
    "way",
    [
        stick_slip._find_stick_slip_states_from_balanced_load,
        stick_slip._find_stick_slip_states_from_widened_gaps,
    ],
)
def test_a_path_ends_at_an_answer_also_where_it_turns_back(way, monkeypatch):
    """A path of loads ends at an answer also where it turns back.

    Four nodes on random elastic bodies, mu = 1: on a tenth of the paths the load grows again before
    it falls.
    """
    monkeypatch.setattr(stick_slip, "_find_stick_slip_states_by_newton", way)
    monkeypatch.setattr(stick_slip, "_find_stick_slip_states_from_balanced_load", way)
    monkeypatch.setattr(stick_slip, "_find_stick_slip_states_from_widened_gaps", way)
    n, none = 4, np.zeros(0)
    for seed in range(100):
        rng = np.random.default_rng(seed)
        root = rng.normal(size=(2 * n, 2 * n))
        A = root @ root.T + 0.05 * np.eye(2 * n)
        problem = StickSlipProblem(
            A_wp=A[:n, :n],
            A_wt=A[:n, n:],
            A_sp=-A[n:, :n],
            A_st=-A[n:, n:],
            B_w=np.zeros((n, 0)),
            B_s=np.zeros((n, 0)),
            C_p=np.zeros((0, n)),
            C_t=np.zeros((0, n)),
            q_w=rng.normal(size=n),
            q_s=rng.normal(size=n),
            h=none,
            Q=np.zeros((n, n)),
        )
        found = stick_slip.solve_stick_slip_load_increment(
            problem,
            1.0,
            TractionsAndSlipsOfLastIncrement(np.zeros(n), np.zeros(n)),
            np.full(n, STICK),
        )
        p, t = found.p, found.t
        w = problem.q_w + problem.A_wp @ p + problem.A_wt @ t
        s = problem.q_s + problem.A_sp @ p + problem.A_st @ t
        assert np.minimum(p, w) == pytest.approx(np.zeros(n), abs=1e-8)
        # The projection on |t| <= mu p must leave the traction as it is.
        assert t == pytest.approx(np.clip(t + s, -p, p), abs=1e-8)


def test_a_vanishing_gap_changes_nothing():
    """A force that closes the gap in increments ends where one increment ends without a gap."""
    gap = vary(BRAKE, {"shoe.lining.clearance": 1e-13})
    with_gap, without = (
        turn_holding_brake_and_return_states_at_rotations(SCENE, gap, np.zeros(8))[0],
        turn_holding_brake_and_return_states_at_rotations(SCENE, BRAKE, np.zeros(8))[0],
    )
    for mine, theirs in zip(with_gap.traction, without.traction, strict=True):
        assert mine == pytest.approx(theirs, rel=1e-3, abs=1e-4 * np.abs(theirs).max())


def test_zones_end_half_way_to_the_next_node():
    state = np.array([STICK, FORWARD, BACKWARD, OPEN])
    found = stick_slip.sticking_and_slipping_arcs_of_lining(np.array([0.0, 1.0, 3.0, 4.0]), state)
    assert found == {"stick": ((0.0, 0.5),), "slip": ((0.5, 3.5),)}
