"""Forces, springs, weight and rotation on a shoe, judged by statics and by closed forms."""

import math
from typing import Any

import numpy as np
import pytest

import drumlin
from drumlin import BadInput, NoAnswer, peers, vary
from drumlin.brake.brake import Brake
from drumlin.brake.file import make_drum_brake_from_data
from drumlin.fem.analysis.sensitivity import compute_torque_sensitivity
from drumlin.fem.equilibrium.group import divide_pressed_shoes_into_groups
from drumlin.fem.error_control.levels import REFINEMENT_LEVELS_FROM_COARSE_TO_FINE
from drumlin.fem.model import solve_full_system_of_group_by_refinement
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.solve import solve
from drumlin.laws.rigid import solve_brake_by_rigid_shoe_law
from drumlin.peers.getfem import solve_brake_in_getfem_process
from drumlin.verification.triangles.levels import (
    TRIANGLE_MESH_LEVELS_FROM_COARSE_TO_FINE,
    solve_brake_on_one_triangle_mesh,
)
from further_loads import (
    BODY,
    FORCE,
    PULL,
    SUPPORTS,
    R,
    brake_with,
    moment,
    single_force,
    two_shoes,
)

ACTUATION = {"force": 1000.0, "direction": 0.0, "point": {"x": 0.02, "y": 0.08}}
TO_FRAME = {"shoe": "shoe", "point": {"x": 0.05, "y": 0.03}, "end": {"x": -0.02, "y": 0.03}}
ELEMENTS = 16


def answers(brake: Brake) -> list[Any]:
    """The responses of a brake by finite elements and by the rigid-shoe law."""
    return [solve(brake, elements=ELEMENTS), solve_brake_by_rigid_shoe_law(brake)]


def assert_same(one: Any, other: Any, rel: float = 1e-10) -> None:
    """Two responses agree in torque, reaction and peak pressure of each shoe."""
    for a, b in zip(one.shoes, other.shoes, strict=True):
        assert a.torque == pytest.approx(b.torque, rel=rel)
        assert a.peak_pressure == pytest.approx(b.peak_pressure, rel=rel)
        assert a.hinge_reaction == pytest.approx(b.hinge_reaction, rel=rel, abs=1e-7)


# Plain forces


@pytest.mark.parametrize("kind", ["hinge", "abutment", "rough abutment"])
def test_two_forces_act_as_their_resultant(kind: str) -> None:
    """Statics: two forces on a rigid shoe are one force along the line of their resultant."""
    both = brake_with(kind, force=[FORCE])
    one = brake_with(kind, actuation=single_force(ACTUATION, FORCE))
    for a, b in zip(answers(both), answers(one), strict=True):
        assert_same(a, b)
        assert max(a.balance.force, a.balance.moment) < 1e-9


def test_rigid_shoe_on_hinge_has_torque_in_proportion_to_moment() -> None:
    """A rigid shoe that fits the drum: pressure and torque are linear in the moment at the pin."""
    without, under = brake_with(), brake_with(force=[FORCE])
    pin = {"x": 0.03, "y": -0.085}
    own = moment(1000.0, 0.0, ACTUATION["point"], pin)
    ratio = (own + moment(FORCE["force"], FORCE["direction"], FORCE["point"], pin)) / own
    for a, b in zip(answers(under), answers(without), strict=True):
        assert a.torque / b.torque == pytest.approx(ratio, rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("spin", [1, -1])
def test_force_beside_a_pivot_acts_on_the_shoe_and_not_on_its_lever(spin: int) -> None:
    """The lever's moment about its pin is that of the actuation and of the shoe alone."""
    for response in answers(brake_with("pivot", spin, force=[FORCE])):
        (shoe,) = response.shoes
        assert shoe.pivot_reaction is not None
        fx, fy = -shoe.pivot_reaction
        by_shoe = (0.12 + 0.03) * fy - (0.004 + 0.12) * fx
        by_force = moment(1000.0, 0.0, ACTUATION["point"], {"x": -0.03, "y": -0.12})
        assert by_shoe == pytest.approx(-by_force, rel=1e-9)
        # The lever's forces vanish together, too.
        assert shoe.hinge_reaction + np.array([fx, fy]) == pytest.approx([-1000.0, 0.0], abs=1e-6)


def test_forces_alone_press_a_shoe_without_actuation() -> None:
    """A shoe without [shoe.actuation] is pressed by its further force as by an actuation."""
    pressed = brake_with(actuation=None, force=[ACTUATION])
    for a, b in zip(answers(pressed), answers(brake_with()), strict=True):
        assert_same(a, b)
    with pytest.raises(BadInput, match=r"shoe\[0\].actuation: is missing"):
        brake_with(actuation=None)


def test_force_that_lifts_the_shoe_off_leaves_no_contact() -> None:
    """A return force with more moment than the actuation: no torque, and a note says so."""
    off = brake_with(force=[FORCE | {"force": 3000.0}])
    for response in answers(off):
        assert response.torque == 0
        assert any("no contact" in note for note in response.notes)


@pytest.mark.slow
@pytest.mark.parametrize("kind", list(SUPPORTS))
def test_slopes_beside_a_further_force_are_those_of_differences(kind: str) -> None:
    """Exact slopes by friction, force, moduli and supports against differences of solves."""
    brake = brake_with(kind, force=[FORCE], body=BODY)
    assert_slopes(brake)


def assert_slopes(brake: Brake) -> None:
    """The slopes of a brake agree with central differences of solves on the same elements."""
    slopes = compute_torque_sensitivity(make_prepared_model(brake, elements=ELEMENTS), brake)
    own = slopes.shoes[0]
    probes = {"friction": (slopes.friction, brake.friction, 1e-5)}
    probes["shoe[0].lining.material.E"] = own.moduli["lining"] / 3e8, 3e8, 3e4
    probes["shoe[0].body.material.E"] = own.moduli["shoe"] / 2.1e11, 2.1e11, 2.1e7
    for key, slope in own.held.items():
        part: Any = brake.shoes[0]
        for name in key.split("."):
            part = getattr(part, name)
        if len(slope) == 2:
            probes[f"shoe[0].{key}.x"] = slope[0], part.x, 1e-6
            probes[f"shoe[0].{key}.y"] = slope[1], part.y, 1e-6
        else:
            probes[f"shoe[0].{key}"] = slope[0], part, 1e-6
    assert len(own.held) > 0
    for key, (exact, value, step) in probes.items():
        up, down = (
            solve(vary(brake, {key: value + sign * step}), elements=ELEMENTS).torque
            for sign in (1, -1)
        )
        near = (up - down) / (2 * step)
        assert exact == pytest.approx(near, rel=1e-5, abs=1e-7 * abs(up) / abs(value or 1)), key


@pytest.mark.slow
def test_hold_at_full_slip_has_the_torque_of_the_sliding_drum() -> None:
    """A holding brake with a return spring ends in the moment of `solve`."""
    brake = two_shoes(spring=[PULL])
    held = drumlin.hold(brake, elements=ELEMENTS)
    assert held.states[-1].torque == pytest.approx(solve(brake, elements=ELEMENTS).torque, rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("loads", ["force", "spring"])
def test_triangles_agree(loads: str) -> None:
    """The second solver, which takes its loads another way, has the same torque and reaction."""
    brake = (
        brake_with(force=[FORCE], body=BODY)
        if loads == "force"
        else two_shoes(body=True, spring=[PULL])
    )
    fine = solve_brake_on_one_triangle_mesh(brake, TRIANGLE_MESH_LEVELS_FROM_COARSE_TO_FINE[0])
    for a, b in zip(solve(brake).shoes, fine, strict=True):
        assert a.torque == pytest.approx(b.torque, rel=1e-3)
        assert a.hinge_reaction == pytest.approx(b.hinge_reaction, rel=2e-3)


@pytest.mark.slow
@pytest.mark.skipif(
    peers.install_hint_if_missing("getfem") is not None,
    reason=peers.install_hint_if_missing("getfem") or "",
)
@pytest.mark.parametrize("loads", ["force", "lever and spring"])
def test_getfem_agrees(loads: str) -> None:
    """GetFEM on the same mesh has the same torques and reactions."""
    brake = (
        brake_with(force=[FORCE], body=BODY)
        if loads == "force"
        else drumlin.example("parking_lever")
    )
    ours = solve(brake, elements=24, kind="quad2")
    found = solve_brake_in_getfem_process(brake, elements=24, kind="quad2").response
    for a, b in zip(ours.shoes, found.shoes, strict=True):
        assert a.torque == pytest.approx(b.torque, rel=3e-6)
        assert a.hinge_reaction == pytest.approx(b.hinge_reaction, rel=2e-5)


@pytest.mark.slow
@pytest.mark.parametrize("kind", list(SUPPORTS))
def test_refined_full_system_takes_the_further_force(kind: str) -> None:
    """The full system in long double has the pressures of the condensed one."""
    brake = brake_with(kind, force=[FORCE], body=BODY)
    (group,) = divide_pressed_shoes_into_groups(
        make_prepared_model(brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[1]), brake, 1e6
    )
    group, found = group.solve_contact_and_abutment_friction()
    refined = solve_full_system_of_group_by_refinement(group, found.active)
    np.testing.assert_allclose(refined.p[0], found.p, atol=1e-8 * found.p.max())
    size = abs(found.y).max()
    np.testing.assert_allclose(refined.coordinates[0], found.y, rtol=1e-6, atol=1e-9 * size)


# Springs


@pytest.mark.slow
def test_spring_of_constant_pull_is_a_pair_of_forces() -> None:
    """A spring between two shoes pulls each towards the other with its preload."""
    sprung = two_shoes(spring=[PULL], body=True)
    forces = [
        {"force": 100.0, "direction": math.pi, "point": PULL["point"]},
        {"force": 100.0, "direction": 0.0, "point": PULL["end"]},
    ]
    data = two_shoes(body=True).model_dump(by_alias=True)
    for shoe, force in zip(data["shoe"], forces, strict=True):
        shoe["force"] = [force]
    for a, b in zip(answers(sprung), answers(make_drum_brake_from_data(data)), strict=True):
        assert_same(a, b)
        assert max(a.balance.force, a.balance.moment) < 1e-9


@pytest.mark.parametrize("rate", [1e3, 1e6, 1e8])
def test_spring_with_rate_has_the_closed_form_of_a_rigid_shoe(rate: float) -> None:
    """A rigid shoe on a hinge and linings that fit: its turn is linear in the moment.

    The turn is c M, the moment M = M_0 - b T, and the pull T = T_0 + k b c M. Here b is the arm of
    the spring about the pin and c the turn per moment, from the solve without a spring.
    """
    pin = {"x": 0.03, "y": -0.085}
    plain = solve(brake_with(), elements=ELEMENTS)
    M = -moment(1000.0, 0.0, ACTUATION["point"], pin)
    arm = moment(1.0, math.pi, TO_FRAME["point"], pin)
    turn = plain.shoes[0].turn
    assert turn is not None
    c = -turn / M
    pull = (100.0 + rate * arm * c * M) / (1 + rate * arm**2 * c)
    brake = brake_with(brake={"spring": [TO_FRAME | {"preload": 100.0, "rate": rate}]})
    response = solve(brake, elements=ELEMENTS)
    assert response.spring_pulls[0] == pytest.approx(pull, rel=1e-9)
    assert response.torque == pytest.approx(plain.torque * (M - arm * pull) / M, rel=1e-9)
    assert max(response.balance.force, response.balance.moment) < 1e-9
    assert any("spring[0]: its pull is" in note for note in response.notes)


@pytest.mark.slow
def test_elastic_shoes_stretch_their_spring_by_their_motion() -> None:
    """The pull exceeds the preload by the rate times the stretch in the displacement field.

    The spring's point moves with the part of the body over which its force is spread: with the mean
    displacement of this part, and with its rotation by least squares. The weights are those of the
    normal distribution along the body, and of the trapezoidal rule over its nodes.
    """
    brake = two_shoes(body=True, spring=[PULL | {"rate": 1e7}])
    fields = drumlin.fields(brake, elements=48)
    stretch = 0.0
    for field, point, along in ((fields[0], PULL["point"], -1.0), (fields[1], PULL["end"], 1.0)):
        x, y = field.points.T
        in_body = np.hypot(x, y) < R - 0.0009999
        xy, u = field.points[in_body].T, field.displacement[in_body].T
        radius = np.hypot(*xy)
        angle = np.arctan2(xy[1], xy[0]) - math.atan2(point["y"], point["x"])
        angle = (angle + math.pi) % (2 * math.pi) - math.pi
        assert np.ptp(radius) == pytest.approx(BODY["thickness"], rel=1e-6)
        weight = radius * np.exp(-0.5 * (angle * radius.mean() / (0.5 * BODY["thickness"])) ** 2)
        for values in (radius, angle):
            lines, at = np.unique(np.round(values, 9), return_inverse=True)
            steps = np.diff(lines, prepend=lines[0], append=lines[-1])
            weight = weight * (steps[1:] + steps[:-1])[at]
        weight /= weight.sum()
        arm = xy - (xy @ weight)[:, None]
        turn = (arm[0] * u[1] - arm[1] * u[0]) @ weight / ((arm**2).sum(axis=0) @ weight)
        stretch -= along * (u[0] @ weight - turn * (point["y"] - xy[1] @ weight))
    (pull,) = solve(brake, elements=48).spring_pulls
    assert abs(pull - 100.0) > 5.0
    assert pull - 100.0 == pytest.approx(1e7 * stretch, rel=0.03)


@pytest.mark.slow
def test_spring_is_mirrored_and_its_ends_change_places() -> None:
    """Reversed rotation, the two ends of a spring, or the order of the shoes: the same brake."""
    spring = PULL | {"rate": 1e6}
    other = spring | {"shoe": "left", "to": "right", "point": PULL["end"], "end": PULL["point"]}
    a = solve(two_shoes(body=True, spring=[spring]), elements=ELEMENTS)
    b = solve(two_shoes(body=True, spring=[other]), elements=ELEMENTS)
    c = solve(two_shoes(body=True, spin=-1, spring=[spring]), elements=ELEMENTS)
    data = two_shoes(body=True, spring=[spring]).model_dump(by_alias=True)
    data["shoe"] = data["shoe"][::-1]
    d = solve(make_drum_brake_from_data(data), elements=ELEMENTS)
    for changed, order in ((b, 1), (c, -1), (d, -1)):
        assert changed.spring_pulls == pytest.approx(a.spring_pulls, rel=1e-11)
        torques = [shoe.torque for shoe in changed.shoes][::order]
        assert torques == pytest.approx([shoe.torque for shoe in a.shoes], rel=1e-10)


def test_spring_that_holds_the_shoe_off_is_refused() -> None:
    """A stiff spring at an open gap: the shoe hovers, and no contact agrees with the pull."""
    brake = brake_with(brake={"spring": [TO_FRAME | {"preload": 100.0, "rate": 1e8}]})
    with pytest.raises(NoAnswer, match=r"spring\[0\]: no pull agrees"):
        solve(vary(brake, {"shoe.lining.clearance": "0.5 mm"}), elements=ELEMENTS)


def test_spring_that_goes_slack_is_refused() -> None:
    """A spring that pulls the shoe on, and lets it go before the lining touches."""
    on = {"shoe": "shoe", "point": {"x": 0.05, "y": 0.03}, "end": {"x": 0.4, "y": 0.03}}
    brake = brake_with(brake={"spring": [on | {"preload": 10.0, "rate": 1e5}]})
    with pytest.raises(NoAnswer, match=r"spring\[0\]: goes slack"):
        solve(vary(brake, {"shoe.lining.clearance": "0.5 mm"}), elements=ELEMENTS)


@pytest.mark.slow
@pytest.mark.parametrize("spin", [1, -1])
@pytest.mark.parametrize("body", [False, True])
def test_cam_shares_its_force_beside_return_springs(spin: int, body: bool) -> None:
    """Under a cam the tips travel alike, the forces add up, and each shoe is in equilibrium."""
    brake = two_shoes(body, spin, actuation={"force": 2000.0}, spring=[PULL])
    response = solve(brake, elements=ELEMENTS)
    forces = [shoe.force for shoe in response.shoes]
    assert sum(map(float, forces)) == pytest.approx(2000.0, rel=1e-12)
    assert max(response.balance.force, response.balance.moment) < 1e-9
    # Each shoe under its part of the force alone has the same answer.
    own = two_shoes(body, spin, spring=[PULL])
    own = vary(own, {f"shoe[{i}].actuation.force": force for i, force in enumerate(forces)})
    assert_same(solve(own, elements=ELEMENTS), response, rel=1e-9)
    # A soft spring at the cam itself is no load on the shoes' equilibrium but on the cam's sum.
    if not body:
        law = [shoe.force for shoe in solve_brake_by_rigid_shoe_law(brake).shoes]
        assert forces == pytest.approx(law, rel=2e-3)


def test_cam_with_return_spring_has_its_closed_form_by_the_rigid_law() -> None:
    """Rigid shoes whose linings fit: equal tip travel needs equal moments over resistances.

    The law's torques without a spring give B_1/B_2 for the sense of rotation. With mirrored shoes
    the travel is c_i (F_i - f), where f is the force at the tip that balances the spring's moment.
    """
    plain = solve_brake_by_rigid_shoe_law(two_shoes(actuation={"force": 2000.0}))
    a, b = (float(shoe.force or 0.0) for shoe in plain.shoes)
    pin = {"x": 0.03, "y": -0.085}
    f = moment(100.0, math.pi, PULL["point"], pin) / moment(1.0, math.pi, {"x": 0, "y": 0.085}, pin)
    sprung = solve_brake_by_rigid_shoe_law(two_shoes(actuation={"force": 2000.0}, spring=[PULL]))
    forces = [shoe.force for shoe in sprung.shoes]
    left = 2000.0 - 2 * f
    assert forces == pytest.approx([f + left * a / 2000.0, f + left * b / 2000.0], rel=1e-10)


BAD = {
    "unknown shoe": ({"spring": [PULL | {"to": "x"}]}, r"spring\[0\].to = 'x': must be the name"),
    "one shoe": ({"spring": [PULL | {"to": "right"}]}, r"to = 'right': must be another shoe"),
    "no length": ({"spring": [PULL | {"end": PULL["point"]}]}, r"must not be the spring's point"),
    "push": ({"spring": [PULL | {"rate": -1.0}]}, r"spring\[0\].rate"),
    "gravity": ({"gravity": {"direction": -1.5}}, r"gravity: acts on masses"),
    "speed": ({"shoe_speed": 100.0}, r"shoe_speed: acts on masses"),
}


@pytest.mark.parametrize("name", list(BAD))
def test_loads_that_cannot_be_meant_are_refused(name: str) -> None:
    """Each wrong key is refused by its name, and gets no number."""
    keys, text = BAD[name]
    with pytest.raises(BadInput, match=text):
        two_shoes(**keys)


@pytest.mark.slow
def test_worn_in_linings_refuse_springs_with_a_rate() -> None:
    """These analyses take springs of constant pull, and name the key otherwise."""
    brake = two_shoes(spring=[PULL | {"rate": 1e4}])
    with pytest.raises(BadInput, match=r"spring\[0\].rate = 10 N/mm"):
        drumlin.solve(brake, worn_in=True)
    with pytest.raises(BadInput, match=r"spring\[0\]: a torque that is kept"):
        drumlin.wear(two_shoes(spring=[PULL]), torque="10 N m")


# Weight and rotation


def test_weight_and_centrifugal_force_are_forces_at_the_centre_of_mass() -> None:
    """Weight m g along gravity and m w^2 r along the radius, as plain forces at the same point."""
    mass = {"mass": 2.0, "point": {"x": 0.06, "y": 0.02}}
    heavy = brake_with(mass=mass, brake={"gravity": {"direction": -1.5}, "shoe_speed": 50.0})
    radius, angle = math.hypot(0.06, 0.02), math.atan2(0.02, 0.06)
    forces = [
        {"force": 2 * 9.80665, "direction": -1.5, "point": mass["point"]},
        {"force": 2 * 50.0**2 * radius, "direction": angle, "point": mass["point"]},
    ]
    for a, b in zip(answers(heavy), answers(brake_with(force=forces)), strict=True):
        assert_same(a, b)
        assert max(a.balance.force, a.balance.moment) < 1e-9


def test_centrifugal_shoe_presses_with_the_square_of_the_speed() -> None:
    """A guided shoe under centrifugal force alone: N is m w^2 r on its radius without friction."""
    brake = brake_with(
        "guide",
        mu=0.0,
        guide={"direction": 0.0},
        actuation={"force": 0.0, "direction": 0.0, "point": {"x": 0.1, "y": 0.0}},
        mass={"mass": 0.5, "point": {"x": 0.08, "y": 0.0}},
        brake={"shoe_speed": 150.0},
    )
    for response in answers(brake):
        assert response.shoes[0].normal_force == pytest.approx(0.5 * 150.0**2 * 0.08, rel=1e-9)


def test_brake_file_with_all_loads_is_read_back(tmp_path: Any) -> None:
    """Units on every key; the written file gives the same brake with the same loads."""
    brake = brake_with(
        force=[FORCE],
        mass={"mass": "1.2 kg", "point": {"x": "60 mm", "y": "0 mm"}},
        brake={
            "gravity": {"direction": "-90 deg"},
            "shoe_speed": "1500 rpm",
            "spring": [TO_FRAME | {"preload": "120 N", "rate": "20 N/mm"}],
        },
    )
    drumlin.write_brake(brake, tmp_path / "b.toml")
    again = drumlin.read_brake(tmp_path / "b.toml")
    assert again == brake
    assert again.shoe_speed == pytest.approx(1500 * 2 * math.pi / 60)
    assert np.array_equal(
        again.shoes[0].resultant_of_loads_besides_actuation,
        brake.shoes[0].resultant_of_loads_besides_actuation,
    )
    assert not np.allclose(again.shoes[0].resultant_of_loads_besides_actuation, 0)
    assert brake.size == R
