"""Linings with a friction of their own, against closed forms, equilibria and a second solver."""

import math

import numpy as np
import pytest
from scipy.integrate import quad
from typer.testing import CliRunner

import drumlin
from conftest import ROOT
from drumlin.base.errors import BadInput
from drumlin.brake.file import read_brake, vary
from drumlin.cli.commands import app
from drumlin.explore.knobs import sliders_for_brake
from drumlin.fem.analysis.holding import (
    find_drum_rotation_of_full_slip,
    turn_holding_brake_and_return_states_at_rotations,
)
from drumlin.fem.analysis.sensitivity import compute_torque_sensitivity
from drumlin.fem.equilibrium.group import divide_pressed_shoes_into_groups
from drumlin.fem.error_control.refinement import (
    assemble_full_system_of_group,
    solve_full_system_by_iterative_refinement,
)
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.solve import solve
from drumlin.peers.peer import mesh_shoes_for_peer_program
from drumlin.response.resultants import integral_of_piecewise_polynomial
from drumlin.verification.triangles import solve_brake_on_sequence_of_triangle_meshes
from shared_forces import cam_brake, servo

OWN = {"friction": 0.2, "shoe[0].lining.friction": 0.3, "shoe[1].lining.friction": 0.45}


def unlike(brake):
    return vary(brake, OWN)


def posts(root):
    return read_brake(root / "studies" / "post_brake" / "brake.toml")


def torque_by_hand(brake, answer, k, mu):
    """mu b R^2 times the integral of p over theta."""
    lining = brake.shoes[k].lining
    force = integral_of_piecewise_polynomial(answer.theta, answer.pressure, answer.order)
    return mu * lining.width * brake.size**2 * force


@pytest.mark.parametrize(
    "model",
    ["sine", "cosine", "uniform", "short", "fem", pytest.param("solid", marks=pytest.mark.slow)],
)
def test_a_shoe_on_a_rigid_drum_knows_only_its_own_friction(brake, model):
    options = {"elements": 12, "model_error": False} if model == "fem" else {}
    tight = {"rel": 1e-6 if model == "solid" else 1e-12}
    found = drumlin.solve(unlike(brake), model, **options)
    for k, mu in enumerate((0.3, 0.45)):
        alone = drumlin.solve(vary(brake, {"friction": mu}), model, **options)
        assert found.shoes[k].torque == pytest.approx(alone.shoes[k].torque, **tight)
        assert found.shoes[k].hinge_reaction == pytest.approx(alone.shoes[k].hinge_reaction)
        assert found.merits[k].sensitivity_at_fixed_shape == pytest.approx(
            alone.merits[k].sensitivity_at_fixed_shape, rel=1e-9
        )
    assert max(found.balance.force, found.balance.moment) < 1e-9


def test_the_sine_law_with_two_frictions_in_closed_form(brake):
    """The moments of p = p0 sin(phi) and of its friction about the pin, by quadrature."""
    found = drumlin.solve(unlike(brake), "sine")
    R, a = brake.size, 0.125
    for shoe, answer, mu, helps in zip(brake.shoes, found.shoes, (0.3, 0.45), (-1, 1), strict=True):
        ends = shoe.arc
        closing = quad(lambda phi: a * math.sin(phi) ** 2, *ends)[0]
        dragging = quad(lambda phi: math.sin(phi) * (R - a * math.cos(phi)), *ends)[0]
        moment = abs(shoe.actuation.moment_of_force_about_point(shoe.pin))
        amplitude = moment / (closing - helps * mu * dragging)
        torque = mu * amplitude * R * quad(math.sin, *ends)[0]
        assert answer.torque == pytest.approx(torque, rel=1e-9)


def test_the_foundation_model_knows_each_friction(root):
    brake = posts(root)
    found = drumlin.solve(unlike(brake), "foundation")
    for k, mu in enumerate((0.3, 0.45)):
        alone = drumlin.solve(vary(brake, {"friction": mu}), "foundation")
        assert found.shoes[k].torque == pytest.approx(alone.shoes[k].torque, rel=1e-9)
    with pytest.raises(BadInput, match=r"not shoe\[0\]\.lining\.friction"):
        drumlin.solve(unlike(brake), "foundation", lift=["ring-friction"])


@pytest.mark.parametrize("kind", ["ring", "cam", "strut"])
def test_shoes_that_act_on_each_other_balance_with_their_own_friction(root, kind):
    whole = {"ring": lambda: posts(root), "cam": cam_brake, "strut": servo}[kind]()
    brake = unlike(whole)
    found = solve(brake, elements=12)
    assert max(found.balance.force, found.balance.moment) < 1e-9
    for k, mu in enumerate((0.3, 0.45)):
        answer = found.shoes[k]
        # The nodes of the mesh lie on chords of the drum's circle, which takes some 1e-6.
        assert answer.torque == pytest.approx(torque_by_hand(brake, answer, k, mu), rel=2e-5)
    # The slopes are those of the friction scaled for all linings at once.
    scene = make_prepared_model(brake, elements=12)
    slopes = compute_torque_sensitivity(scene, brake)
    step, T = 1e-5, []
    for sign in (1, -1):
        scale = 1 + sign * step
        more = vary(brake, {key: value * scale for key, value in OWN.items()})
        T.append(solve_prepared_model(scene, more).torque)
    S = (T[0] - T[1]) / (2 * step * slopes.torque)
    assert pytest.approx(S, rel=1e-7) == slopes.S
    assert slopes.torque == pytest.approx(found.torque, rel=1e-9)


@pytest.mark.slow
def test_the_second_solver_agrees_on_a_ring(root):
    brake = unlike(posts(root))
    near, true = (
        drumlin.solve(brake, model_error=False),
        solve_brake_on_sequence_of_triangle_meshes(brake),
    )
    for ours, other in zip(near.shoes, true[-1], strict=True):
        assert ours.torque == pytest.approx(other.torque, rel=3e-3)


def test_limits_of_self_locking_scale_all_frictions(brake):
    """Of the left shoe, which leads: mu_lock of its lining over 0.45/0.2."""
    plain = drumlin.self_locking(brake, elements=12, most=4.0)
    scaled = drumlin.self_locking(unlike(brake), elements=12, most=4.0)
    for k, ratio in enumerate((1.5, 2.25)):
        assert scaled[k].friction == pytest.approx(plain[k].friction / ratio, rel=1e-9)
    by_law = drumlin.solve(brake, "sine").self_locking.law
    found = drumlin.solve(unlike(brake), "sine").self_locking
    assert found.law.friction == pytest.approx(by_law.friction / 2.25, rel=1e-12)
    assert found.line().endswith("all frictions in proportion, shoe[0].lining.friction too")
    assert drumlin.solve(brake, "sine").self_locking.line().endswith("rigid-shoe law")


@pytest.mark.slow
def test_limit_of_a_strut_is_followed_from_zero_friction():
    brake = servo()
    own = vary(brake, {"friction": 0.15, "shoe.lining.friction": 0.3})
    plain, scaled = (drumlin.self_locking(each, elements=12, most=4.0) for each in (brake, own))
    assert scaled[0].friction == pytest.approx(plain[0].friction / 2, rel=1e-6)


def test_a_held_drum_slips_at_the_torque_of_solve(brake):
    own = unlike(brake)
    scene = make_prepared_model(own, elements=8)
    turned = find_drum_rotation_of_full_slip(scene, own)
    (state,) = turn_holding_brake_and_return_states_at_rotations(scene, own, [turned])
    assert state.torque == pytest.approx(solve_prepared_model(scene, own).torque, rel=1e-6)


def test_worn_linings_keep_their_friction(brake):
    own = unlike(brake)
    run = drumlin.wear(own, distance="1 km", elements=8)
    assert run.states[0].torque == pytest.approx(solve(own, elements=8).torque, rel=1e-6)


def test_the_page_scales_all_frictions(brake):
    own = unlike(brake)
    (knob,) = [knob for knob in sliders_for_brake(own) if knob.name == "friction"]
    assert knob.low > 0
    changed = vary(own, knob.changes(0.4))
    assert [shoe.lining.friction for shoe in changed.shoes] == pytest.approx([0.6, 0.9])


def test_refusals_name_the_key(brake):
    with pytest.raises(BadInput, match=r"friction = 0: must be .* own shoe\[1\]\.lining\.friction"):
        vary(brake, {"friction": 0.0, "shoe[1].lining.friction": 0.2})
    with pytest.raises(BadInput, match=r"shoe\[1\]\.lining\.friction = 0: the peers"):
        mesh_shoes_for_peer_program(vary(brake, {"shoe[1].lining.friction": 0.0}))
    with pytest.raises(BadInput, match=r"shoe\[1\]\.lining\.friction"):
        vary(brake, {"shoe[1].lining.friction": -0.1})


def test_a_lining_without_friction_brakes_nothing(brake):
    found = solve(vary(brake, {"shoe.left.lining.friction": 0.0}), elements=12)
    assert found.shoes[1].torque == 0
    assert found.shoes[0].torque > 0


def test_the_heading_names_each_friction(tmp_path):
    text = (ROOT / "studies" / "double_shoe" / "brake.toml").read_text(encoding="utf-8")
    path = tmp_path / "brake.toml"
    path.write_text(text.replace("[shoe.lining]", "[shoe.lining]\nfriction = 0.35", 1))
    out = CliRunner().invoke(app, ["solve", str(path), "--model", "sine"]).output
    assert "mu = 0.3, 0.35 of shoe 'right'" in " ".join(out.split())


def test_the_ring_bends_under_the_friction_of_each_lining(root):
    """The condensed equations against the full ones, which are assembled by other code."""
    brake = unlike(posts(root))
    scene = make_prepared_model(brake, elements=6)
    (group,) = divide_pressed_shoes_into_groups(scene, brake)
    group, contact = group.solve_contact_and_abutment_friction()
    full = solve_full_system_by_iterative_refinement(
        assemble_full_system_of_group(group), contact.active
    )
    pressures = np.concatenate(full.p)
    assert pressures == pytest.approx(contact.p, rel=1e-7, abs=1e-9 * contact.p.max())
