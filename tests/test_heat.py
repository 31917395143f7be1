"""Heat as a load, judged by closed forms and by triangles that assemble their forces otherwise."""

import math

import numpy as np
import pytest
from scipy.integrate import quad

import drumlin
from conftest import ROOT
from drumlin.base.errors import BadInput
from drumlin.brake import read_brake, read_drum_or_plane_brake, vary
from drumlin.brake.components import BeamBody
from drumlin.brake.drum_brake import DrumBrake
from drumlin.brake.file import make_drum_brake_from_data
from drumlin.brake.heat import (
    brake_with_heat_only_in_given_parts,
    check_thermal_expansion_of_shoes_is_known,
    radial_growth_of_heated_drum,
)
from drumlin.brake.writing import brake_file_text
from drumlin.fem.analysis.fields import stress_and_displacement_fields_of_shoe
from drumlin.fem.equilibrium.group import divide_pressed_shoes_into_groups
from drumlin.fem.error_control.levels import REFINEMENT_LEVELS_FROM_COARSE_TO_FINE
from drumlin.fem.error_control.refinement import (
    assemble_full_system_of_group,
    solve_full_system_by_iterative_refinement,
)
from drumlin.fem.hp.shoe import function_from_depth_and_angle_to_point
from drumlin.fem.model import solve_prepared_model
from drumlin.fem.preparation.bodies import functions_of_free_thermal_strain_by_layer
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.solve import solve
from drumlin.verification.triangles.levels import (
    COARSE_MESH_LEVEL_TO_FIND_CONTACT_ENDS,
    solve_brake_on_sequence_of_triangle_meshes,
)
from drumlin_studies.heat_error import rows_of_stated_and_true_errors_of_drawn_brake
from drumlin_studies.load_error import draw_random_brake_with_loads_and_lining_friction
from drumlin_studies.stated_true import stated_over_true_error_of_row
from flat_pads import pad

HOT = read_brake(ROOT / "studies" / "heat" / "brake.toml")
MAIN = read_brake(ROOT / "studies" / "double_shoe" / "brake.toml")
DRUM = {"drum.expansion": 11e-6, "drum.temperature_rise": 100.0}
LINING = {"shoe.lining.material.expansion": 30e-6, "shoe.lining.temperature_rise": 100.0}
BODY = {"shoe.body.material.expansion": 12e-6, "shoe.body.temperature_rise": 40.0}
RING = {"thickness": 0.015, "width": 0.06, "material": {"E": 1.1e11, "nu": 0.26}}
SOFT = 1e-10
"""Contact stiffness relative to the lining's: the elements are then as stiff as a rigid shoe."""
DIVISIONS = pytest.mark.parametrize(
    "level", [REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0], None], ids=["hp elements", "mesh"]
)


def solved(brake, level=REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0], elements=40):
    """The response of a brake on one division."""
    return solve_prepared_model(make_prepared_model(brake, level, elements=elements), brake)


def same(one, other, tolerance=1e-12):
    """Check that two responses have the same torque and the same pressures."""
    assert one.torque == pytest.approx(other.torque, rel=tolerance)
    for a, b in zip(one.shoes, other.shoes, strict=True):
        assert a.pressure == pytest.approx(b.pressure, abs=tolerance * a.pressure.max())


# the drum


def drum_of_brake(changes):
    """The drum of the main brake with some changes."""
    brake = vary(MAIN, changes)
    assert isinstance(brake, DrumBrake)
    return brake.drum


def test_a_rigid_hot_drum_is_one_that_has_grown():
    grown = [{"order": 0, "amplitude": 11e-4 * MAIN.size}]
    same(solved(vary(MAIN, DRUM)), solved(vary(MAIN, {"drum.out_of_round": grown})))


@pytest.mark.parametrize("growth", [2e-4, pytest.param(-2e-4, marks=pytest.mark.slow)])
def test_elements_on_soft_contact_are_the_sine_law_of_a_hot_drum(growth):
    """On a contact far softer than the bodies p = K (c sin phi - growth) on a hinged shoe.

    The moment of pressure and friction about the hinge is linear in c, and is that of the force.
    """
    R, pin, b, mu, s, e = 0.12, 0.09, 0.04, 0.3, 0.6, 2.3
    data = {
        "title": "rigid limit",
        "rotation": "counter-clockwise",
        "friction": mu,
        "drum": {"radius": R, "expansion": 1e-5, "temperature_rise": growth / (R * 1e-5)},
        "shoe": [
            {
                "name": "shoe",
                "side": "internal",
                "hinge": {"x": pin, "y": 0.0},
                "lining": {"start": s, "end": e, "thickness": 5e-3, "width": b}
                | {"material": {"E": 2e11, "nu": 0.25}},
                "actuation": {
                    "force": 0.02,
                    "direction": math.pi / 2,
                    "point": {"x": -R, "y": 0.0},
                },
            }
        ],
    }
    found = drumlin.solve(make_drum_brake_from_data(data), penalty=SOFT, model_error=False)
    (shoe,) = found.shoes
    K, sense = SOFT * 2e11 / 5e-3, 1 if shoe.self_energising else -1

    def moment(p):
        """The moment about the hinge of a pressure, and of its friction."""
        by_pressure = quad(lambda x: p(x) * pin * math.sin(x), s, e)[0]
        return (
            b
            * R
            * (by_pressure - sense * mu * quad(lambda x: p(x) * (R - pin * math.cos(x)), s, e)[0])
        )

    c = (0.02 * (pin + R) + K * growth * moment(lambda x: 1.0)) / (K * moment(math.sin))
    pressure = K * (c * np.sin(shoe.theta) - growth)
    assert pressure.min() > 0.1 * pressure.max()
    assert shoe.pressure == pytest.approx(pressure, rel=2e-9)
    torque = mu * b * R**2 * K * quad(lambda x: c * math.sin(x) - growth, s, e)[0]
    assert found.torque == pytest.approx(torque, rel=1e-9)
    assert max(found.balance.force, found.balance.moment) < 1e-9


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("support", ["free", "fixed"])
def test_the_growth_of_a_ring_is_that_of_its_differential_equation(support, sign):
    """Finite differences of (u' + u/r)' = (1 + nu) alpha T' know nothing of the closed form."""
    near, far, alpha, nu, R, t = 180.0, 60.0, 11e-6, 0.26, MAIN.size, 0.015
    drum = drum_of_brake(
        {
            "drum.ring": RING | {"support": support},
            "drum.expansion": alpha,
            "drum.temperature_rise": near,
            "drum.back_temperature_rise": far,
        }
    )
    n = 2000
    r = np.linspace(R, R + sign * t, n + 1)
    h = r[1] - r[0]
    system, right = np.zeros((n + 1, n + 1)), np.zeros(n + 1)
    for i in range(1, n):
        system[i, i - 1 : i + 2] = (
            1 / h**2 - 1 / (2 * h * r[i]),
            -2 / h**2 - 1 / r[i] ** 2,
            1 / h**2 + 1 / (2 * h * r[i]),
        )
        right[i] = (1 + nu) * alpha * (far - near) / (n * h)
    # The radial stress u' + nu u/r - (1 + nu) alpha T is zero at a free edge.
    system[0, :3] = np.array([-1.5, 2, -0.5]) / h
    system[0, 0] += nu / r[0]
    right[0] = (1 + nu) * alpha * near
    if support == "free":
        system[n, n - 2 :] = np.array([0.5, -2, 1.5]) / h
        system[n, n] += nu / r[n]
        right[n] = (1 + nu) * alpha * far
    else:
        system[n, n] = 1.0
    u = np.linalg.solve(system, right)[0]
    assert radial_growth_of_heated_drum(drum, sign) == pytest.approx(u, rel=1e-5)


def test_an_evenly_hot_free_ring_grows_as_a_rigid_drum():
    ring = drum_of_brake(DRUM | {"drum.ring": RING | {"support": "free"}})
    assert radial_growth_of_heated_drum(ring, 1) == pytest.approx(11e-4 * MAIN.size, rel=1e-12)


# the shoes


def thin_lining_on_rigid_shoe():
    """A hot brake with thin linings on rigid shoes."""
    return vary(
        read_drum_or_plane_brake(ROOT / "studies" / "laws" / "double_shoe_external.toml"),
        {
            "shoe.lining.thickness": 1e-4,
            "shoe.body": None,
            "shoe.lining.material.expansion": 1e-7,
            "shoe.lining.temperature_rise": 100.0,
        },
    )


@DIVISIONS
def test_a_thin_lining_on_a_rigid_shoe_swells_through_its_thickness(level):
    """The bond keeps its length: through the thickness it grows by (1 + nu) alpha T t."""
    hot = thin_lining_on_rigid_shoe()
    brake, shoe = brake_with_heat_only_in_given_parts(hot, ()), hot.shoes[0]
    swelling = (1 + shoe.lining.material.nu) * 1e-5 * shoe.lining.thickness
    thicker = vary(brake, {"shoe.lining.clearance": -swelling})
    cold, warm, gap = (solved(each, level, 160) for each in (brake, hot, thicker))
    change = warm.shoes[0].pressure - cold.shoes[0].pressure
    expected = gap.shoes[0].pressure - cold.shoes[0].pressure
    inner = slice(len(change) // 5, -len(change) // 5)
    assert np.abs(expected[inner]).max() > 0
    assert change[inner] == pytest.approx(expected[inner], abs=2e-2 * np.abs(expected[inner]).max())


@pytest.mark.parametrize("gradient", [False, True])
def test_both_divisions_have_the_same_hot_brake(gradient):
    heat = LINING | BODY
    if gradient:
        heat |= {"shoe.lining.back_temperature_rise": 30.0, "shoe.body.back_temperature_rise": 0.0}
    brake = vary(MAIN, heat)
    columns, mesh = (
        solved(brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[1]),
        solved(brake, None, 160),
    )
    cold = solved(MAIN, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[1])
    assert abs(columns.torque / cold.torque - 1) > 0.05
    assert mesh.torque == pytest.approx(columns.torque, rel=3e-5)
    for response in (columns, mesh):
        assert max(response.balance.force, response.balance.moment) < 1e-9


def test_a_lining_that_grows_through_its_thickness_only_is_thicker_by_the_mean_strain():
    """On a plane the free strain alpha T(y) across the plane causes no stress: u = Int alpha T."""
    material = {"E_along": 2e8, "E_through": 3e8, "nu_along_through": 0.2, "G_along_through": 1e8}
    grows = {"expansion_along": 0.0, "expansion_through": 4e-5}
    cold = vary(pad("hinge"), {"shoe.lining.material": material | grows})
    rises = {"shoe.lining.temperature_rise": 150.0, "shoe.lining.back_temperature_rise": 50.0}
    thicker = vary(cold, {"shoe.lining.clearance": -4e-5 * 100.0 * cold.shoes[0].lining.thickness})
    hot, other = (solve(vary(cold, each), elements=12) for each in (rises, {}))
    thick = solve(thicker, elements=12)
    assert abs(hot.effect / other.effect - 1) > 1e-3
    assert hot.effect == pytest.approx(thick.effect, rel=1e-9)
    peak = thick.shoes[0].peak_pressure
    assert hot.shoes[0].pressure == pytest.approx(thick.shoes[0].pressure, abs=1e-9 * peak)
    assert max(hot.balance.force, hot.balance.moment) < 1e-9


HOT_BLOCK = {
    "shoe.backing.material.expansion": 1e-5,
    "shoe.backing.temperature_rise": 40.0,
    "shoe.backing.back_temperature_rise": 300.0,
}


def test_the_temperature_of_a_block_is_linear_over_the_thickness_that_it_has_there():
    """A block between a round lining and a straight beam is thicker at its ends."""
    hot = vary(read_brake(ROOT / "studies" / "post_brake" / "brake.toml"), HOT_BLOCK)
    for shoe in hot.shoes:
        points_at = function_from_depth_and_angle_to_point(shoe, hot.size)
        phi = np.linspace(*shoe.arc, 9)
        strains = functions_of_free_thermal_strain_by_layer(shoe, hot.size)["backing"]
        for share in (0.0, 0.25, 0.5, 1.0):
            along, through = strains(points_at(np.full(9, 1 + share), phi))
            assert along == pytest.approx(1e-5 * (40 + share * 260), rel=1e-12)
            assert through == pytest.approx(along)
        # The block that the file states is thinner than the block between lining and beam.
        depth = shoe.distances_from_friction_surface(points_at(np.full(9, 2.0), phi), hot.size)
        assert np.ptp(depth) > 0.1 * shoe.backing.thickness


def test_a_block_of_a_mesh_before_a_straight_beam_has_one_temperature():
    """Its thickness there is not known, so that a temperature linear over it is refused."""
    hot = vary(read_brake(ROOT / "studies" / "post_brake" / "brake.toml"), HOT_BLOCK)
    shoe = hot.shoes[0].model_copy(update={"mesh": "post.msh"})
    with pytest.raises(ValueError, match=r"back_temperature_rise = 300 K: the block"):
        check_thermal_expansion_of_shoes_is_known([shoe])


@pytest.mark.slow
def test_stated_errors_hold_for_a_post_whose_block_is_hotter_at_its_back():
    """Strains with a kink inside elements fell more slowly from level to level than is stated."""
    assert isinstance(
        draw_random_brake_with_loads_and_lining_friction(540005).shoes[0].body, BeamBody
    )
    for row in rows_of_stated_and_true_errors_of_drawn_brake(
        draw_random_brake_with_loads_and_lining_friction, 540005
    ):
        assert row["outcome"] == "reached"
        for name in ("pressure", "torque", "peak", "reaction"):
            assert stated_over_true_error_of_row(row, name) > 1


def test_heat_and_its_opposite_move_the_contact_force_of_a_free_lining_alike():
    """Small heat acts linearly where the contact does not change."""
    up, down = (
        solved(vary(MAIN, LINING | {"shoe.lining.temperature_rise": T})) for T in (1e-3, -1e-3)
    )
    cold = solved(MAIN)
    assert up.torque - cold.torque == pytest.approx(cold.torque - down.torque, rel=1e-3)
    assert up.torque != cold.torque


def test_the_refinement_in_long_double_has_the_heat_as_well():
    brake = vary(MAIN, LINING | BODY)
    scene = make_prepared_model(brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[0])
    warm, torque = solve_prepared_model(scene, brake), 0.0
    for group in divide_pressed_shoes_into_groups(scene, brake):
        refined = solve_full_system_by_iterative_refinement(
            assemble_full_system_of_group(group),
            group.solve_contact_for_given_abutment_friction().active,
        )
        torque += group.largest_actuation_force * refined.torque
    assert warm.torque == pytest.approx(torque, rel=1e-7)


def test_mirror_image_of_a_hot_brake():
    mirrored = vary(HOT, {"rotation": "clockwise"})
    one, other = solved(HOT), solved(mirrored)
    assert one.torque == pytest.approx(other.torque, rel=1e-9)
    assert one.shoes[0].torque == pytest.approx(other.shoes[1].torque, rel=1e-9)


@DIVISIONS
def test_the_bond_of_a_thin_hot_lining_is_pressed_along(level):
    """The bond keeps the lining's length: sigma_tt = nu sigma_rr - E alpha T."""
    hot = vary(thin_lining_on_rigid_shoe(), {"shoe.lining.material.expansion": 1e-5})
    shoe = hot.shoes[0]
    scene = make_prepared_model(hot, level, elements=160)
    fields = stress_and_displacement_fields_of_shoe(scene, hot, solve_prepared_model(scene, hot), 0)
    x, y = fields.points.T / np.hypot(*fields.points.T)
    xx, yy, xy = fields.stress.T
    radial = x * x * xx + y * y * yy + 2 * x * y * xy
    along = y * y * xx + x * x * yy - 2 * x * y * xy
    middle = np.array([math.cos(shoe.lining.middle), math.sin(shoe.lining.middle)])
    inner = middle @ [x, y] > 0.95
    material = shoe.lining.material
    pressed = material.E * material.expansion * shoe.lining.temperature_rise
    assert inner.sum() > 30
    assert along[inner] == pytest.approx(material.nu * radial[inner] - pressed, abs=2e-2 * pressed)


@pytest.mark.slow
@pytest.mark.parametrize("file", ["studies/heat/brake.toml", "studies/brakes/simplex_abutted.toml"])
def test_the_second_solver_has_the_same_hot_brake(file):
    """Triangles integrate B^T D eps_0 over layers that know only their two faces' strains."""
    brake = read_drum_or_plane_brake(ROOT / file)
    if brake != HOT:
        brake = vary(
            brake,
            LINING
            | BODY
            | DRUM
            | {"shoe.lining.back_temperature_rise": 20.0, "shoe.body.back_temperature_rise": 0.0},
        )
    response = drumlin.solve(brake, tolerance=1e-3, model_error=False)
    shoes = solve_brake_on_sequence_of_triangle_meshes(brake)[-1]
    torque = sum(shoe.torque for shoe in shoes)
    assert abs(response.torque / torque - 1) < response.error["torque"] + 1e-6
    for mine, theirs in zip(response.shoes, shoes, strict=True):
        distance = np.hypot(*(mine.hinge_reaction - theirs.hinge_reaction))
        assert distance < 3e-4 * np.hypot(*theirs.hinge_reaction)


@pytest.mark.slow
def test_triangles_on_a_coarse_mesh_have_the_same_hot_brake():
    brake = vary(MAIN, LINING | BODY | {"shoe.body.back_temperature_rise": 0.0})
    shoes = solve_brake_on_sequence_of_triangle_meshes(
        brake, [COARSE_MESH_LEVEL_TO_FIND_CONTACT_ENDS]
    )[-1]
    assert sum(shoe.torque for shoe in shoes) == pytest.approx(solved(brake).torque, rel=2e-3)


# what the person at the terminal sees


def test_heat_is_read_written_and_said():
    assert read_brake(ROOT / "x.toml", brake_file_text(HOT)) == HOT
    response = drumlin.solve(HOT)
    assert any(
        line.startswith("note: heated: drum; lining of shoes 'right', 'left'; body of shoes")
        and "grows by 0.20955 mm" in line
        for line in response.notes
    )
    assert "takes no heated shoes" in response.plane_stress_error.unknown
    law = drumlin.solve(HOT, "sine")
    assert law.torque == drumlin.solve(brake_with_heat_only_in_given_parts(HOT, ()), "sine").torque
    assert any(line.startswith("warning: left out is the heat of drum;") for line in law.notes)


def test_a_comparison_has_the_hot_brake_beside_the_cold_one():
    found = drumlin.compare(HOT, models=["fem", "sine"]).responses
    assert list(found) == ["fem", "cold", "sine"]
    assert (
        found["cold"].torque == drumlin.solve(brake_with_heat_only_in_given_parts(HOT, ())).torque
    )
    assert found["cold"].torque > 1.2 * found["fem"].torque
    assert list(drumlin.compare(MAIN, models=["fem"]).responses) == ["fem"]


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (
            {"shoe.lining.temperature_rise": 100.0},
            "shoe[0].lining.temperature_rise = 100 K: its material needs",
        ),
        ({"drum.temperature_rise": 100.0}, "drum.temperature_rise = 100 K: needs drum.expansion"),
        (DRUM | {"drum.back_temperature_rise": 5.0}, "a rigid drum has one temperature"),
        (DRUM | {"drum.temperature_rise": 1e9}, "the radius grows by 1.65e+06 mm; must be at most"),
        ({"drum.temperature_rise": "100 bar"}, "drum.temperature_rise = '100 bar'"),
    ],
)
def test_heat_without_its_data_is_refused(changes, words):
    with pytest.raises(BadInput) as error:
        vary(MAIN, changes)
    assert words in str(error.value).replace(" is ", " = ")


@pytest.mark.parametrize(
    ("ask", "words"),
    [
        (
            lambda brake: drumlin.solve(brake, "solid"),
            "the model of the width takes no heated shoes",
        ),
        (drumlin.sensitivity, "the analysis of slopes takes no heated shoes"),
    ],
)
def test_what_takes_no_heated_shoes_says_so(ask, words):
    with pytest.raises(BadInput, match=words):
        ask(HOT)


def test_a_cam_on_heated_shoes_is_refused():
    brake = vary(read_drum_or_plane_brake(ROOT / "studies" / "brakes" / "s_cam.toml"), LINING)
    with pytest.raises(BadInput, match="cam on heated shoes"):
        drumlin.solve(brake)


@pytest.mark.parametrize(
    ("text", "kelvin"), [("180 K", 180.0), ("180 degC", 180.0), ("180 °F", 100.0)]
)
def test_a_temperature_rise_is_a_difference_in_every_unit(text, kelvin):
    text_of_brake = brake_file_text(HOT).replace(
        'temperature_rise = "150 K"', f'temperature_rise = "{text}"'
    )
    brake = read_brake(ROOT / "x.toml", text_of_brake)
    assert isinstance(brake, DrumBrake)
    assert brake.drum.temperature_rise == pytest.approx(kelvin)


@DIVISIONS
def test_heat_calls_for_no_reaction_and_loses_no_balance(level):
    """Even heat whose internal forces are 1e5 times the actuation leaves the forces in balance."""
    weak = vary(MAIN, LINING | BODY | {"shoe.actuation.force": 0.1, "shoe.lining.clearance": 1e-4})
    response = solved(weak, level)
    assert max(response.balance.force, response.balance.moment) < 1e-9
