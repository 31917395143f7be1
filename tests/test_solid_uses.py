"""Solid shoes held, worn, differentiated, compared and in sweeps: limits, balances, refusals.

Without contraction a shoe of one width is in plane stress, and a narrow shoe tends to it.
"""

import json
import math

import numpy as np
import pytest

import drumlin as package
from command_line import drumlin
from drumlin.base.errors import BadInput
from drumlin.brake.file import vary
from drumlin.contact.stick_slip import BACKWARD, FORWARD, OPEN, STICK
from drumlin.fem.analysis.holding import (
    find_drum_rotation_of_full_slip,
    stick_slip_state_at_each_angle_of_lining,
    turn_holding_brake_and_return_states_at_rotations,
)
from drumlin.fem.analysis.prepared import (
    DEGREE_ACROSS_WIDTH_FOR_ANALYSES,
    prepared_model_for_hold_wear_or_sensitivity,
)
from drumlin.fem.analysis.sensitivity import compute_torque_sensitivity
from drumlin.fem.error_control.levels import REFINEMENT_LEVELS_FROM_COARSE_TO_FINE
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.width.face import ContactFaceWithWidth
from drumlin.fem.width.prepare import prepare_model_with_shoe_widths
from drumlin.lining_wear.archard import WearLaw, wear_linings_in_given_steps
from drumlin.lining_wear.linings import wear_setup_by_finite_elements
from drumlin.lining_wear.run_in import (
    brake_with_worn_linings,
    compute_checks_of_wear_run,
    final_pressure_and_torque_of_wear_on_mesh,
    sliding_distance_of_e_fold_pressure_change,
)
from drumlin.sweeps.cases import results_of_response_by_name
from sections import t_section, widths, without_contraction
from shared_forces import cam_brake

LAW = WearLaw(1e-14)
DEGREES = {"one width": 2, "T-section": 3}


def shoes(flexible, kind):
    """The brake with flexible shoes of one width or of a T-section."""
    return t_section(flexible) if kind == "T-section" else flexible


def wide(brake, degree=2):
    return prepare_model_with_shoe_widths(brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0], degree)


def plane(brake):
    return make_prepared_model(brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0])


def held(scene, brake, rotations):
    return turn_holding_brake_and_return_states_at_rotations(scene, brake, rotations)


def worn(scene, brake, units=(1.0, 3.0, 8.0)):
    """The wear setup of a brake, and its states after distances in units of 1/(k K)."""
    setup = wear_setup_by_finite_elements(scene, brake)
    unit = sliding_distance_of_e_fold_pressure_change(setup, LAW)
    stations = [unit * number for number in units]
    return setup, wear_linings_in_given_steps(setup.interfaces, LAW, stations)


def mean_depths(setup, state):
    """The mean worn depth of each lining over its arc and width."""
    area = np.concatenate([interface.area for interface in setup.interfaces])
    parts = [surface.part for surface in setup.surfaces]
    return np.array([state.depth[part] @ area[part] / area[part].sum() for part in parts])


def apart(brake):
    """How far solid shoes are from plane stress: held moments, worn depths, slopes by friction."""
    flat, solid = plane(brake), wide(brake)
    turns = np.array([0.0, 0.3, 1.2]) * find_drum_rotation_of_full_slip(flat, brake)
    moments = [
        np.array([state.torque for state in held(scene, brake, turns)[1:]])
        for scene in (flat, solid)
    ]
    depths = []
    for scene in (flat, solid):
        setup, states = worn(scene, brake)
        depths.append(np.concatenate([mean_depths(setup, state) for state in states[1:]]))
    slopes = [compute_torque_sensitivity(scene, brake).friction for scene in (flat, solid)]
    return {
        "moment": np.abs(moments[1] / moments[0] - 1).max(),
        "depth": np.abs(depths[1] / depths[0] - 1).max(),
        "friction": abs(slopes[1] / slopes[0] - 1),
    }


@pytest.mark.parametrize("kind", ["block", pytest.param("double shoe", marks=pytest.mark.slow)])
def test_without_contraction_the_uses_are_those_of_plane_stress(flexible, kind):
    brake = flexible if kind == "double shoe" else package.example("short_block")
    assert max(apart(without_contraction(brake)).values()) < 1e-9


@pytest.mark.slow
def test_without_contraction_nothing_varies_across_the_width(flexible):
    brake = without_contraction(flexible)
    flat, solid = plane(brake), wide(brake)
    turns = np.array([0.0, 0.3]) * find_drum_rotation_of_full_slip(flat, brake)
    for one, true in zip(held(solid, brake, turns), held(flat, brake, turns), strict=True):
        assert one.sticking == true.sticking
        assert one.dissipated == pytest.approx(true.dissipated, rel=1e-9)
        for face, state in zip(one.face, true.state, strict=True):
            assert (face.state == state[:, None]).all()
        for mean, other in zip(one.pressure, true.pressure, strict=True):
            assert np.linalg.norm(mean - other) < 1e-7 * np.linalg.norm(other)
    slopes, others = (compute_torque_sensitivity(scene, brake) for scene in (solid, flat))
    for one, true in zip(slopes.shoes, others.shoes, strict=True):
        assert one.clearance == pytest.approx(true.clearance, rel=1e-9)
        assert one.held["hinge"] == pytest.approx(true.held["hinge"], rel=1e-8)
        for part, slope in true.moduli.items():
            assert one.moduli[part] == pytest.approx(slope, abs=one.modulus_error)


@pytest.mark.slow
def test_narrow_shoes_tend_to_plane_stress(flexible):
    # Narrower shoes would need elements as small as their width beside the bonded back.
    found = [apart(widths(flexible, width)) for width in (16e-3, 8e-3, 4e-3)]
    for name in ("moment", "depth", "friction"):
        values = [each[name] for each in found]
        assert values[0] > 1e-3
        assert values[1] < 0.7 * values[0]
        assert values[2] < 0.33 * values[0]


@pytest.mark.parametrize("kind", ["one width", pytest.param("T-section", marks=pytest.mark.slow)])
def test_worn_volume_is_mean_pressure_times_distance_times_coefficient(flexible, kind):
    brake = shoes(flexible, kind)
    setup, states = worn(wide(brake, DEGREES[kind]), brake)
    end = states[-1]
    area = np.concatenate([interface.area for interface in setup.interfaces])
    # The force over the distance is the integral of the mean pressure, by the method's own weights.
    assert area @ end.depth == pytest.approx(LAW.coefficient * end.pressed, rel=1e-12)
    checks = compute_checks_of_wear_run(setup, states, LAW)
    assert checks.volume < 1e-12
    assert checks.energy < 1e-8
    for surface in setup.surfaces:
        face = surface.lining_values_over_arc_and_width(end.pressure)
        assert face @ surface.shares == pytest.approx(
            surface.lining_values_by_growing_angle(end.pressure)
        )
    # Wear ends evenly across the width: the motion of the shoe is the same everywhere.
    final = final_pressure_and_torque_of_wear_on_mesh(setup)
    for surface in setup.surfaces:
        face = surface.lining_values_over_arc_and_width(final.pressure)
        assert np.ptp(face, axis=1).max() < 1e-6 * face.max()
        new = surface.lining_values_over_arc_and_width(states[0].pressure)
        assert np.ptp(new, axis=1).max() > 0.02 * new.max()


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["one width", "T-section"])
def test_full_slip_holds_the_torque_of_sliding(flexible, kind):
    brake = shoes(flexible, kind)
    scene = wide(brake, DEGREES[kind])
    end = find_drum_rotation_of_full_slip(scene, brake)
    states = held(scene, brake, np.linspace(0, end, 4))
    assert states[-1].torque == pytest.approx(solve_prepared_model(scene, brake).torque, rel=1e-7)
    assert states[-1].sticking == 0
    # Part of the width sticks: the lining presses less at its sides.
    faces = [face.state == STICK for state in states for face in state.face]
    assert any((face.any(axis=1) & ~face.all(axis=1)).any() for face in faces)
    for state in states:
        for face, line in zip(state.face, state.state, strict=True):
            assert ((face.state == STICK).any(axis=1) == (line == STICK)).all()
            assert (np.abs(face.traction) <= brake.friction * face.pressure + 1e-3).all()


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["one width", "T-section"])
def test_slopes_of_solid_shoes_are_those_of_differences_of_solves(flexible, kind):
    brake, degree = shoes(flexible, kind), DEGREES[kind]
    slopes = compute_torque_sensitivity(wide(brake, degree), brake)
    own, shoe = slopes.shoes[0], brake.shoes[0]

    def slope(key, up, down):
        torques = []
        for value in (up, down):
            changed = vary(brake, {key: value})
            torques.append(solve_prepared_model(wide(changed, degree), changed).torque)
        return torques[0] - torques[1]

    for part, key in (("lining", "lining"), ("shoe", "body")):
        E, name = getattr(shoe, key).material.E, f"shoe[0].{key}.material.E"
        found = slope(name, E * (1 + 1e-4), E * (1 - 1e-4)) / 2e-4
        assert own.moduli[part] == pytest.approx(found, abs=own.modulus_error + 1e-6 * abs(found))
        assert own.modulus_error < 1e-5 * abs(found)
    x, y = shoe.pin.x, shoe.pin.y
    found = slope("shoe[0].hinge", {"x": x + 1e-6, "y": y}, {"x": x - 1e-6, "y": y}) / 2e-6
    assert own.held["hinge"][0] == pytest.approx(found, rel=1e-5)
    mu = brake.friction
    assert slopes.friction == pytest.approx(
        slope("friction", mu + 1e-5, mu - 1e-5) / 2e-5, rel=1e-6
    )
    # A clearance that is even across the width acts as its density over the arc.
    theta, density = own.theta, own.density
    arc = brake.size * np.trapezoid(density, theta)
    assert arc == pytest.approx(own.clearance, rel=0.05)


def test_an_angle_sticks_if_one_of_its_nodes_sticks():
    state = np.array([[FORWARD, STICK], [OPEN, BACKWARD], [BACKWARD, FORWARD], [OPEN, OPEN]])
    assert stick_slip_state_at_each_angle_of_lining(state).tolist() == [
        STICK,
        BACKWARD,
        FORWARD,
        OPEN,
    ]


def test_worn_linings_settle_as_linings_with_clearance(flexible):
    gap = 2e-4
    setup = wear_setup_by_finite_elements(wide(flexible), flexible)
    loose = vary(flexible, {"shoe.lining.clearance": gap})
    for new, worn_off in zip(
        setup.interfaces, wear_setup_by_finite_elements(wide(loose), loose).interfaces, strict=True
    ):
        assert new.settle is not None
        assert worn_off.settle is not None
        none = np.zeros(len(new.area))
        _, touching = new.settle(none + gap)
        assert (touching == worn_off.settle(none)[1]).all()
        assert (touching != new.settle(none)[1]).any()


@pytest.mark.parametrize("kind", ["hinged", pytest.param("cam", marks=pytest.mark.slow)])
def test_the_error_of_slopes_by_moduli_is_not_understated(flexible, kind):
    """Degree 0 across the width is plane stress, whose slopes are exact."""
    brake = cam_brake(body=0.01) if kind == "cam" else flexible
    slopes = compute_torque_sensitivity(wide(brake, 0), brake)
    exact = compute_torque_sensitivity(plane(brake), brake)
    for one, true in zip(slopes.shoes, exact.shoes, strict=True):
        for part, slope in true.moduli.items():
            off = abs(one.moduli[part] - slope)
            assert off <= one.modulus_error < 1e-5 * abs(slope)


@pytest.mark.slow
def test_a_beam_moves_with_its_hinge_and_has_no_slope_there(root):
    brake = package.read_brake(root / "studies" / "post_brake" / "brake.toml")
    width = brake.shoes[0].lining.width
    plain = {"drum.ring": None, "shoe.body.width": width, "shoe.body.bending_stiffness": None}
    brake = vary(brake, plain)
    own = compute_torque_sensitivity(wide(brake), brake).shoes[0]
    assert own.not_given == ("hinge",)
    assert own.held == {}
    assert math.isfinite(own.clearance)


@pytest.mark.slow
def test_the_division_of_the_section_is_that_of_plane_stress(flexible):
    flat = prepared_model_for_hold_wear_or_sensitivity(flexible)
    solid = prepared_model_for_hold_wear_or_sensitivity(flexible, "solid")
    for one, true in zip(solid.bodies, flat.bodies, strict=True):
        assert isinstance(one.line, ContactFaceWithWidth)
        assert one.line.line.xy == pytest.approx(true.line.xy)
        assert one.line.functions.degree == DEGREE_ACROSS_WIDTH_FOR_ANALYSES


@pytest.mark.parametrize(
    ("use", "options", "line"),
    [
        ("hold", {"model": "sine"}, "model = 'sine': does not do this; allowed: fem, solid"),
        (
            "wear",
            {"model": "sine"},
            "model = 'sine': does not wear; allowed: fem, solid, foundation",
        ),
        (
            "sensitivity",
            {"model": "solid", "elements": 12},
            "elements and kind belong to model=\"fem\", not to 'solid'",
        ),
        (
            "wear",
            {"model": "solid", "sections": 12},
            'elements and kind belong to model="fem", guided to fem and solid, '
            "sections and lift to foundation",
        ),
    ],
)
def test_what_solid_shoes_do_not_do_is_refused(flexible, use, options, line):
    with pytest.raises(BadInput) as error:
        getattr(package, use)(flexible, **options)
    assert str(error.value) == line


def test_an_elastic_ring_is_refused(root):
    for use in (package.hold, package.wear, package.sensitivity):
        with pytest.raises(BadInput) as error:
            use(root / "studies" / "post_brake" / "brake.toml", "solid")
        assert str(error.value) == (
            "model = 'solid': does not apply to this brake: its drum is an elastic ring, whose "
            "own width is not modelled; allowed: fem"
        )


def test_a_clearance_cannot_say_how_solid_shoes_wear(flexible):
    setup, states = worn(wide(flexible), flexible, (1.0,))
    with pytest.raises(BadInput, match="its worn depth changes across the width"):
        brake_with_worn_linings(setup, states[-1])


@pytest.mark.slow
def test_the_commands_write_what_is_on_the_face(root, tmp_path):
    file, data = root / "studies" / "double_shoe" / "brake.toml", tmp_path / "data.json"
    done = drumlin("hold", file, "--model", "solid", "--steps", "2", "--json", data)
    assert done.returncode == 0
    assert "across the width the face slides freely" in " ".join(done.stdout.split())
    shoe = json.loads(data.read_text())[-1]["shoes"][0]
    face = shoe["face"]
    n, m = len(shoe["theta"]), len(face["z"])
    assert m > 1
    assert np.shape(face["pressure"]) == np.shape(face["traction"]) == (n, m)
    assert set(np.ravel(face["state"])) <= {"open", "stick", "slip", "slip back"}
    done = drumlin("wear", file, "--model", "solid", "--distance", "1", "--json", data)
    assert done.returncode == 0
    run = json.loads(data.read_text())
    assert run["model"] == "solid"
    shape = len(run["shoes"][0]["theta"]), len(run["shoes"][0]["z"])
    assert np.shape(run["states"][-1]["face"]["depth"][0]) == shape
    done = drumlin("sensitivity", file, "--model", "solid", "--json", data)
    assert done.returncode == 0
    assert "E by central differences, with an error of" in done.stdout
    assert json.loads(data.read_text())["shoes"][0]["modulus_error"] > 0


@pytest.mark.slow
def test_a_comparison_has_solid_shoes_with_their_stated_errors(brake, flexible, root):
    found = package.compare(brake, models=["fem", "sine", "solid"])
    assert list(found.responses) == ["fem", "sine", "solid"]
    rows = {(row["model"], row["shoe"]): row for row in found.rows}
    whole = rows["solid", "all"]
    assert 1e-3 < whole["torque_error"] < 1e-2
    assert 0 < whole["stated_torque_error"] < 5e-3
    assert 0 < rows["solid", "left"]["stated_pressure_error"] < 1e-2
    assert rows["sine", "all"]["stated_torque_error"] is None
    assert "solid" not in package.compare(brake, models=["sine"]).responses
    assert list(package.compare(brake, models=None, solid=True).responses)[-1] == "solid"


@pytest.mark.slow
def test_a_comparison_says_why_solid_shoes_do_not_apply(root, tmp_path):
    file = root / "studies" / "post_brake" / "brake.toml"
    done = drumlin("compare", file, "--solid", "--output", tmp_path, "--elements", "12")
    words = " ".join(done.stdout.split())
    assert "solid: does not apply: its drum is an elastic ring" in words


@pytest.mark.slow
def test_a_sweep_has_solid_shoes_beside_plane_stress(root, tmp_path):
    brake = root / "studies" / "double_shoe" / "brake.toml"
    text = f'brake = "{brake}"\n[vary]\nfriction = [0.2]\n'
    models = "[model.fem]\nmodel_error = true\n[model.solid]\ntolerance = 0.02\n"
    (tmp_path / "s.toml").write_text(text + models)
    flat, solid = package.sweep(tmp_path / "s.toml")
    assert (flat["model"], solid["model"]) == ("fem", "solid")
    assert flat["status"] == solid["status"] == "solved"
    assert 0 < solid["error_torque"] < 0.02
    # The stated errors of both cover their difference.
    off = abs(flat["torque [N m]"] / solid["torque [N m]"] - 1)
    stated = flat["plane_stress_error_torque"] + flat["error_torque"] + solid["error_torque"]
    assert 0 < off < stated
    assert "plane_stress_error_torque" not in solid


@pytest.mark.slow
def test_a_sweep_says_why_an_error_of_plane_stress_is_not_known(root):
    brake = package.read_brake(root / "studies" / "post_brake" / "brake.toml")
    row = results_of_response_by_name(brake, package.solve(brake))
    assert row["plane_stress_error_unknown"] == (
        "its drum is an elastic ring, whose own width is not modelled"
    )
    assert "plane_stress_error_torque" not in row
