"""Wear, the foundation model and reference values of shoes with several linings."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import drumlin
from drumlin.brake.brake import Brake
from drumlin.brake.file import make_drum_brake_from_data
from drumlin.brake.writing import brake_file_text
from drumlin.explore.answers import SliderSolver
from drumlin.explore.knobs import brake_at_slider_setting, slider_setting_at_brake_file_values
from drumlin.explore.page import http_reply_to_requested_address
from drumlin.explore.picture import drawing_lines_of_brake
from drumlin.fem.error_control.levels import REFINEMENT_LEVELS_FROM_COARSE_TO_FINE
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.foundation.post import (
    _fractions_of_sectors_beyond_stations,
    places_of_beam_stations_and_indices_under_linings,
    trapezoidal_rule_weights,
)
from drumlin.lining_wear.linings import (
    wear_setup_by_finite_elements,
    wear_setup_by_foundation_model,
)
from drumlin.lining_wear.run_in import (
    brake_with_worn_linings,
    compute_checks_of_wear_run,
    final_pressure_and_torque_of_wear_on_mesh,
)
from drumlin.lining_wear.worn_in import post_brake_with_worn_in_clearances
from drumlin.verification import triangles
from drumlin.verification.check import (
    PressureCurveOfShoe,
    _integral_of_stress_over_theta_on_linings,
)
from drumlin.verification.reference import (
    MeshesOfReferenceValues,
    compute_reference_values,
    solve_brake_for_reference_values,
)
from drumlin.verification.reference_file import (
    read_reference_file,
    reference_values_as_json_data,
    write_reference_file,
)
from drumlin.verification.triangles.levels import solve_brake_on_sequence_of_triangle_meshes
from posts import upright
from several_linings import APART, BODY, brake_with, lining

THREE = brake_with([lining(-56, -20), lining(-10, 10), lining(20, 56)], body=BODY)


def sine_over_linings(brake: Brake) -> tuple[float, float]:
    """Torque [N m] and amplitude [Pa] of p = a sin(phi) on the linings of a hinged shoe.

    The integrals of sin^2 and of sin cos are those of the lining's ends, in closed form.
    """
    (shoe,) = brake.shoes
    R, b, mu = brake.size, shoe.lining.width, brake.friction
    arm = math.hypot(*shoe.pin.xy)
    sin2 = sincos = sine = 0.0
    for first, last in shoe.arcs:
        sin2 += (last - first) / 2 - (math.sin(2 * last) - math.sin(2 * first)) / 4
        sincos += (math.sin(last) ** 2 - math.sin(first) ** 2) / 2
        sine += math.cos(first) - math.cos(last)
    normal, friction = arm * sin2, R * sine - arm * sincos
    moment = abs(shoe.actuation.moment_of_force_about_point(shoe.pin))
    # In this sense of rotation friction helps the actuation.
    a = moment / (b * R * (normal - mu * friction))
    return mu * b * R**2 * a * sine, a


@pytest.mark.parametrize("brake", [APART, THREE], ids=["rigid shoe", "elastic shoe"])
def test_worn_in_linings_have_the_sine_laws_pressure(brake: Brake) -> None:
    torque, amplitude = sine_over_linings(brake)
    worn = drumlin.solve(brake, worn_in=True)
    assert worn.torque == pytest.approx(torque, rel=1e-9)
    (shoe,) = brake.shoes
    for start, end in shoe.lining.arcs:
        theta = np.linspace(start + 0.01, end - 0.01, 50)
        phi = theta - shoe.frame.origin
        p = worn.shoes[0].pressure_at(theta)
        assert p == pytest.approx(amplitude * np.abs(np.sin(phi)), rel=1e-4)
    for start, end in shoe.lining.slots:
        assert not worn.shoes[0].pressure_at(np.linspace(start + 1e-6, end - 1e-6, 9)).any()


def test_worn_volume_is_conserved_and_every_lining_wears() -> None:
    run = drumlin.wear(THREE, elements=18, distance="40 km")
    checks = compute_checks_of_wear_run(run.setup, run.states, run.law)
    assert checks.volume < 1e-13 and checks.energy is not None and checks.energy < 1e-5
    surfaces = run.setup.surfaces
    assert [surface.lining for surface in surfaces] == [0, 1, 2]
    # The volume of each lining, from its own depths, is k times the integral of its force.
    volumes = [
        float(run.setup.interfaces[0].area[s.slice_in_interface] @ run.states[-1].depth[s.part])
        for s in surfaces
    ]
    assert min(volumes) > 0
    assert sum(volumes) == pytest.approx(run.states[-1].removed, rel=1e-13)
    data = run.as_dict()
    assert [shoe["lining"] for shoe in data["shoes"]] == [0, 1, 2]
    # The worn brake, solved anew with the depths as clearances, has the torque of the last state.
    worn = brake_with_worn_linings(run.setup, run.states[-1])
    fem = drumlin.solve(worn, elements=18, model_error=False)
    assert fem.torque == pytest.approx(run.states[-1].torque, rel=2e-4)


def test_wear_on_the_mesh_ends_with_the_torque_of_the_law() -> None:
    setup = wear_setup_by_finite_elements(make_prepared_model(THREE, elements=18), THREE)
    torque, _ = sine_over_linings(THREE)
    end = final_pressure_and_torque_of_wear_on_mesh(setup)
    assert end.torque == pytest.approx(torque, rel=1e-6)


def post(*arcs: tuple[float, float], **more: float) -> Brake:
    """The post brake of the foundation model with linings on arcs [deg]."""
    data = upright(**more).model_dump(exclude_none=True)
    (shoe,) = data["shoes"]
    ends = [{"start": math.radians(a), "end": math.radians(e)} for a, e in arcs]
    shoe["lining"] = [shoe["lining"] | each for each in ends]
    return make_drum_brake_from_data(data)


@pytest.mark.parametrize("spin", [1, -1])
def test_the_foundation_models_rigid_limit_is_the_sine_law(spin: int) -> None:
    """Sectors on a rigid beam are compressed as sin(phi), and only where there is lining."""
    brake = post((-40, -5), (5, 38), EI=5e16, spin=spin)
    torque = drumlin.solve(brake, "sine").torque
    errors = []
    for sections in (90, 180):
        found = drumlin.solve(brake, "foundation", lift=["tilt"], sections=sections)
        errors.append(found.torque / torque - 1)
        assert found.balance.force < 1e-12 and found.balance.moment < 1e-12
    # The trapezoidal rule is of second order.
    assert abs(errors[0]) < 2e-4
    assert errors[0] / errors[1] == pytest.approx(4, abs=0.4)
    assert not found.shoes[0].pressure_at(np.radians(np.linspace(-4.9, 4.9, 11))).any()


def test_a_foundation_with_a_narrow_slot_is_that_without() -> None:
    """The change of the peak is in proportion to the slot, and the sectors beside it are halves."""
    whole, *slotted = (
        drumlin.solve(post(*arcs), "foundation")
        for arcs in (
            [(-40, 40)],
            [(-40, 19.7), (20.3, 40)],
            [(-40, 19.97), (20.03, 40)],
        )
    )
    peak = whole.shoes[0].peak_pressure
    wide, narrow = (each.shoes[0].peak_pressure / peak - 1 for each in slotted)
    assert narrow < 0.2 * wide and 1e-3 < wide < 0.05
    assert slotted[1].torque == pytest.approx(whole.torque, rel=1e-4)
    assert len(slotted[1].shoes[0].contact_arcs) == len(whole.shoes[0].contact_arcs) + 1


def test_a_lining_that_stands_far_off_is_none() -> None:
    """Of two linings the one with a clearance of 1 m changes nothing on the foundation."""
    brake = post((-40, -5), (5, 38))
    data = brake.model_dump(exclude_none=True)
    data["shoes"][0]["lining"][0]["clearance"] = 1.0
    far = make_drum_brake_from_data(data)
    alone = post((5, 38))
    a, b = (drumlin.solve(each, "foundation", sections=240) for each in (far, alone))
    assert a.torque == pytest.approx(b.torque, rel=1e-4)


def test_a_station_has_all_of_a_lining_beyond_it_and_none_before_it() -> None:
    """The sectors beyond a station have together the length of lining beyond it, also at ends."""
    linings = [np.array([0.4, 1.3]), np.array([1.7, 2.6])]
    x, stations = places_of_beam_stations_and_indices_under_linings(3.0, linings, 40)
    angles = [x[own] ** 1.5 for own in stations]
    beyond = _fractions_of_sectors_beyond_stations(x, np.concatenate(stations), angles)
    sectors = np.concatenate(list(map(trapezoidal_rule_weights, angles)))
    first, last = angles
    length = np.concatenate([first[-1] - first + np.ptp(last), last[-1] - last])
    at = np.concatenate(stations)
    np.testing.assert_allclose(beyond[at] @ sectors, length, atol=1e-12)
    assert beyond[-1].max() == 0.0 and beyond[0].min() == 1.0


@pytest.mark.parametrize("spin", [1, -1])
def test_the_linings_of_a_worn_post_have_their_numbers(spin: int) -> None:
    brake = post((-40, -5), (5, 38), spin=spin)
    surfaces = wear_setup_by_foundation_model(brake, sections=30).surfaces
    assert sorted(surface.lining for surface in surfaces) == [0, 1]
    for surface in surfaces:
        start, end = brake.shoes[0].lining.arcs[surface.lining]
        np.testing.assert_allclose(sorted(surface.theta[[0, -1]]), [start, end], atol=1e-12)


def test_linings_of_a_post_wear_in() -> None:
    brake = post((-40, -5), (5, 38))
    worn = post_brake_with_worn_in_clearances(brake, lift=["tilt"])
    found = drumlin.solve(worn, "foundation", lift=["tilt"])
    assert found.torque == pytest.approx(drumlin.solve(brake, "sine").torque, rel=1e-6)
    run = drumlin.wear(brake, "foundation", sections=60, distance="50 km")
    checks = compute_checks_of_wear_run(run.setup, run.states, run.law)
    assert checks.volume < 1e-13 and checks.energy is not None and checks.energy < 1e-12


def test_the_integral_of_a_table_leaves_out_the_slot() -> None:
    (shoe,) = APART.shoes
    theta = np.radians(np.arange(-55.5, 56.0))
    # What a table says between the linings means nothing.
    curve = PressureCurveOfShoe(theta, np.where(np.abs(theta) < math.radians(5), 50.0, 2.0))
    assert _integral_of_stress_over_theta_on_linings(shoe, curve) == pytest.approx(
        2 * math.radians(102)
    )


@pytest.mark.slow
def test_reference_values_of_several_linings_agree_with_triangles(tmp_path: Path) -> None:
    """Two finite-element solvers that share only the brake; a further check is a coarse file."""
    trio = solve_brake_for_reference_values(
        APART,
        MeshesOfReferenceValues(
            2,
            REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[1:3],
            triangles.TRIANGLE_MESH_LEVELS_FROM_COARSE_TO_FINE[:1],
        ),
    )
    known = compute_reference_values(APART, brake_file_text(APART), "", trio)
    (shoe,) = known.shoes
    assert shoe.torque.relative_uncertainty < 1e-5 and shoe.distance < 2e-3
    assert shoe.slots == APART.shoes[0].lining.slots
    path = tmp_path / "reference.json"
    write_reference_file(reference_values_as_json_data(known), path)
    again = read_reference_file(path)
    assert again.shoes[0].slots == pytest.approx(np.array(shoe.slots))
    table = tmp_path / "p.csv"
    found = drumlin.solve(APART, elements=40, model_error=False).shoes[0]
    theta = np.radians(np.arange(-55.5, 56.0, 0.5))
    places = zip(np.degrees(theta), found.pressure_at(theta) / 1e6, strict=True)
    rows = [f"right,{t},{p}" for t, p in places]
    table.write_text("\n".join(["shoe,theta [deg],p [MPa]", *rows]))
    result = drumlin.check(APART, table, reference=path)
    (verdict,) = result.verdicts
    assert result.within
    # The table has a point every half degree, and the ends of linings lie between its points.
    assert verdict.torque == pytest.approx(found.torque, rel=1e-2)


def test_the_explorer_turns_the_knobs_of_all_linings() -> None:
    explorer = SliderSolver(brake_with([lining(-56, -5, clearance="0.02 mm"), lining(5, 56)]))
    setting = slider_setting_at_brake_file_values(explorer.brake)
    moved = {"clearance": 0.01, "misfit": 0.05, "wear": 0.3}
    answer = explorer.fem_and_law_answer_at_slider_setting(replace(setting, values=moved))
    assert answer.fem_response is not None
    # The knobs add lengths to the clearance and to the misfit of both linings.
    changed = brake_at_slider_setting(
        explorer.brake, explorer.knobs, replace(setting, values=moved | {"wear": 0.0})
    )
    first, second = changed.shoes[0].lining.linings
    assert first.clearance == pytest.approx(3e-5) and second.clearance == pytest.approx(1e-5)
    radius = changed.size + 5e-5
    assert first.misfit.radius == second.misfit.radius == pytest.approx(radius)
    # The picture has an outline for each lining.
    assert len(drawing_lines_of_brake(explorer.brake)["linings"].xs) == 2
    page = http_reply_to_requested_address(explorer, "/", "brake")
    assert page.status == 200
    # With wear the file that the page saves has a table of clearances for each lining.
    for part in answer.brake.shoes[0].lining.linings:
        assert isinstance(part.clearance, tuple)


@pytest.mark.slow
def test_triangles_agree_on_an_elastic_ring_under_several_linings() -> None:
    """The second solver has its own ring, which bends under three linings of one shoe."""
    data = THREE.model_dump(exclude_none=True)
    data["drum"]["ring"] = {
        "thickness": 0.02,
        "width": 0.2,
        "material": {"E": 1.2e10, "nu": 0.27},
        "support": "fixed",
    }
    brake = make_drum_brake_from_data(data)
    response = drumlin.solve(brake, model_error=False)
    rigid = drumlin.solve(THREE, model_error=False)
    (true,) = solve_brake_on_sequence_of_triangle_meshes(
        brake, triangles.TRIANGLE_MESH_LEVELS_FROM_COARSE_TO_FINE[:2]
    )[-1]
    (shoe,) = response.shoes
    assert response.error is not None
    assert abs(shoe.torque / true.torque - 1) < response.error["torque"] < 2e-5
    off = np.hypot(*(shoe.hinge_reaction - true.hinge_reaction))
    assert off < response.error["reaction"] * np.hypot(*true.hinge_reaction)
    # The zones of 0.2 deg at the ends of the linings do not count.
    arcs = brake.shoes[0].lining.arcs
    theta = np.concatenate([np.linspace(a + 0.0036, b - 0.0036, 2001) for a, b in arcs])
    p, q = shoe.pressure_at(theta), true.pressure_at(theta)
    assert math.sqrt(np.sum((p - q) ** 2) / np.sum(q**2)) < response.error["pressure"] < 2e-3
    # The ring changes the pressure by more than both solvers' errors.
    without = rigid.shoes[0].pressure_at(theta)
    assert math.sqrt(np.sum((without - q) ** 2) / np.sum(q**2)) > response.error["pressure"]
