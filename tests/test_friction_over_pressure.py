"""Friction that depends on pressure, speed and temperature: closed forms, equilibria, refusals."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad

import drumlin
from conftest import ROOT
from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake import read_drum_or_plane_brake
from drumlin.brake.file import make_drum_brake_from_data, make_validated_brake_part, vary
from drumlin.brake.plane_brake import FlatBrake
from drumlin.brake.writing import brake_file_text
from drumlin.contact import pressure_friction
from drumlin.contact.active_set import solve_contact_problem
from drumlin.contact.pressure_friction import (
    NodalFrictionAndSlope,
    solve_contact_with_pressure_dependent_friction,
)
from drumlin.contact.self_locking import FrictionDependentProblem
from drumlin.explore.answers import SliderSolver
from drumlin.fem.analysis.sensitivity import sensitivity_as_text_lines
from drumlin.fem.solve import solve
from drumlin.peers.peer import mesh_shoes_for_peer_program
from drumlin.response.balance import relative_imbalance_of_shoe
from drumlin.response.resultants import integral_of_piecewise_polynomial
from drumlin.verification.check import PressureCurveOfShoe, compare_curves_with_reference
from drumlin.verification.reference import (
    MESHES_OF_PUBLISHED_REFERENCE_VALUES,
    ReferenceValuesOfBrake,
    ReferenceValuesOfShoe,
    UncertainValue,
    compute_reference_values,
    solve_brake_for_reference_values,
)
from drumlin.verification.triangles import solve_brake_on_sequence_of_triangle_meshes
from drumlin.verification.triangles.levels import TRIANGLE_MESH_LEVELS_FROM_COARSE_TO_FINE
from drumlin_studies.random_brake import draw_random_brake
from drumlin_studies.stated_true import true_errors_of_response
from flat_pads import pad
from friction_tables import EVEN, FALLING, KINKED, over_pressure
from shared_forces import cam_brake, servo
from winkler_lining import FORCE, PIN, RADIUS, WIDTH, K, winkler


def on_mesh(brake):
    return solve(brake, elements=12)


# Closed forms.


def test_a_winkler_lining_under_friction_linear_in_pressure_has_its_closed_form():
    """p = k sin phi, and the moment about the hinge is a quadratic function of k."""
    mu, slope = 0.35, -8e-7
    interface, phi = winkler(lambda phi: 0 * phi, elements=96, mu=1.0)
    whole = interface.problem
    without = winkler(lambda phi: 0 * phi, elements=96, mu=0.0)[0].problem
    problem = FrictionDependentProblem.linear_function_of_friction_from_two_problems(without, whole)
    steps = []

    def friction(p):
        steps.append(p)
        return NodalFrictionAndSlope(mu + slope * p, np.full(len(p), slope))

    start = solve_contact_problem(without)
    found = solve_contact_with_pressure_dependent_friction(problem, friction, start, 0 * phi)

    def moment(power, lever):
        value, _ = quad(lambda x: math.sin(x) ** power * lever(x), 0.3, 2.2)
        return WIDTH * RADIUS * value

    def arm(x):
        return RADIUS - PIN * math.cos(x)

    # The moment about the hinge: FORCE = a k^2 + b k.
    sign = -math.copysign(1.0, float(problem.C_per_friction[0].sum() * without.C[0].sum()))
    a = -sign * slope * moment(2, arm)
    b = moment(2, lambda x: 1.0) * PIN - sign * mu * moment(1, arm)
    k = (-b + math.sqrt(b * b + 4 * a * FORCE)) / (2 * a)
    assert_allclose(found.p, k * np.sin(phi), rtol=1e-5)
    # On the nodes of the lining the pressure is as exact as is stated.
    shape = solve_contact_problem(without).p
    shape = shape / shape.max()
    c, d = whole.C[0] - without.C[0], without.C[0]
    poly = [slope * float(c @ shape**2), float((d + mu * c) @ shape), -float(whole.h[0])]
    top = min(root for root in np.roots(poly).real if root > 0)
    assert_allclose(found.p, top * shape, rtol=1e-11)
    # Newton's method squares the error in each step.
    assert len(steps) <= 6 and K > 0


def short_pad(mu, **changes):
    brake = pad("hinge")
    return vary(
        brake, {"friction": mu, "shoe.lining.start": 0.119, "shoe.lining.end": 0.121} | changes
    )


@pytest.mark.parametrize("sliding", ["+x", "-x"])
def test_a_short_shoe_under_friction_linear_in_pressure_has_its_closed_form(sliding):
    """N (x + s mu(N/A) h) = M is a quadratic equation for N."""
    mu, slope, high = 0.45, -0.15e-6, 60e6
    table = {"pressure": [0.0, high], "mu": [mu, mu + slope * 1e6]}
    table["mu"][1] = mu + slope * 1e6 * 0.9
    brake = short_pad(table, **{"plane.sliding": sliding})
    of_table = (table["mu"][1] - mu) / high
    shoe = brake.shoes[0]
    area = shoe.lining.width * (shoe.lining.end - shoe.lining.start)
    x, h, M = shoe.lining.middle, shoe.pin.y, 500.0 * 0.25
    s = brake.sign_of_motion
    roots = np.roots([s * h * of_table / area, x + s * mu * h, -M]).real
    N = min(root for root in roots if root > 0)
    found = drumlin.solve(brake, "short")
    assert found.shoes[0].normal_force == pytest.approx(N, rel=1e-13)
    assert found.effect == pytest.approx((mu + of_table * N / area) * N, rel=1e-13)
    assert max(found.balance.force, found.balance.moment) < 1e-12


def test_each_shoe_has_the_friction_of_its_own_even_pressure(brake):
    table = over_pressure(brake)
    for model in ("uniform", "short"):
        found = drumlin.solve(table, model)
        for shoe in found.shoes:
            mu = 0.45 - 0.15e-6 * min(shoe.peak_pressure, 1e6)
            i = found.shoes.index(shoe)
            alone = drumlin.solve(vary(brake, {"friction": mu}), model).shoes[i]
            assert alone.torque == pytest.approx(shoe.torque, rel=1e-12)
            assert alone.peak_pressure == pytest.approx(shoe.peak_pressure, rel=1e-12)


@pytest.mark.slow
def test_a_thin_lining_on_a_rigid_shoe_is_that_of_springs():
    """The sine pressure of a hinged rigid shoe, with the moment of mu(p) p integrated by hand."""
    mu, slope = 0.5, -0.2 / 4e5
    stiff_in_shear = {
        "E_along": 1e5,
        "E_through": 1e7,
        "G_along_through": 1e10,
        "nu_along_through": 0.0,
    }
    lining = {
        "start": 0.6,
        "end": 2.3,
        "thickness": 1e-4,
        "width": WIDTH,
        "material": stiff_in_shear,
    }
    force = {"force": 900.0, "direction": 0.0, "point": {"x": 0.0, "y": 0.12}}
    data = {
        "title": "springs",
        "rotation": "clockwise",
        "friction": {"pressure": [0.0, 4e5], "mu": [mu, mu + slope * 4e5]},
        "drum": {"radius": RADIUS},
        "shoe": [
            {
                "name": "shoe",
                "side": "internal",
                "hinge": {"x": PIN, "y": 0.0},
                "lining": lining,
                "actuation": force | {"direction": math.pi / 2, "point": {"x": -0.12, "y": 0.0}},
            }
        ],
    }
    brake = make_drum_brake_from_data(data)
    found = drumlin.solve(brake, model_error=False).shoes[0]

    def integral(power, lever):
        value, _ = quad(lambda x: math.sin(x) ** power * lever(x), 0.6, 2.3)
        return WIDTH * RADIUS * value

    def arm(x):
        return RADIUS - PIN * math.cos(x)

    sense = 1 if found.self_energising else -1
    a = -sense * slope * integral(2, arm)
    b = PIN * integral(2, lambda x: 1.0) - sense * mu * integral(1, arm)
    M = 900.0 * (PIN + 0.12)
    k = (-b + math.sqrt(b * b + 4 * a * M)) / (2 * a)
    torque = RADIUS * (
        mu * k * integral(1, lambda x: 1.0) + slope * k**2 * integral(2, lambda x: 1.0)
    )
    assert found.torque == pytest.approx(torque, rel=2e-3)
    # The edges of the lining have peaks of their own, away from which the pressure is the sine.
    places = np.linspace(0.9, 2.0, 7)
    assert_allclose(found.pressure_at(places), k * np.sin(places), rtol=5e-3)


@pytest.mark.parametrize(
    ("rotation", "model"),
    [
        ("clockwise", "fem"),
        ("clockwise", "solid"),
        pytest.param("counter-clockwise", "fem", marks=pytest.mark.slow),
    ],
)
def test_elements_on_soft_contact_are_the_sine_law_under_friction_linear_in_pressure(
    rotation, model
):
    """On a contact far softer than the bodies p = k sin phi, and the moment is quadratic in k."""
    mu, slope, M = 0.5, -0.2 / 4e5, 900.0 * (PIN + 0.12)
    data = {
        "title": "rigid limit",
        "rotation": rotation,
        "friction": {"pressure": [0.0, 4e5], "mu": [mu, mu + slope * 4e5]},
        "drum": {"radius": RADIUS},
        "shoe": [
            {
                "name": "shoe",
                "side": "internal",
                "hinge": {"x": PIN, "y": 0.0},
                "lining": {"start": 0.6, "end": 2.3, "thickness": 5e-3, "width": WIDTH}
                | {"material": {"E": 5e8, "nu": 0.25}},
                "actuation": {"force": 900.0, "direction": math.pi / 2}
                | {"point": {"x": -0.12, "y": 0.0}},
            }
        ],
    }
    only_plane = {"model_error": False} if model == "fem" else {}
    brake = make_drum_brake_from_data(data)
    found = drumlin.solve(brake, model, penalty=1e-10, **only_plane)
    (shoe,) = found.shoes

    def integral(power, lever):
        value, _ = quad(lambda x: math.sin(x) ** power * lever(x), 0.6, 2.3, epsabs=1e-14)
        return WIDTH * RADIUS * value

    def arm(x):
        return RADIUS - PIN * math.cos(x)

    sense = 1 if shoe.self_energising else -1
    a = -sense * slope * integral(2, arm)
    b = PIN * integral(2, lambda x: 1.0) - sense * mu * integral(1, arm)
    k = 2 * M / (b + math.sqrt(b * b + 4 * a * M))
    even = integral(1, lambda x: 1.0), integral(2, lambda x: 1.0)
    # The section of a solid shoe has larger elements, whose polynomials are less near to the sine.
    of_torque, of_pressure = (1e-9, 2e-9) if model == "fem" else (3e-9, 3e-6)
    torque = RADIUS * (mu * k * even[0] + slope * k**2 * even[1])
    assert found.torque == pytest.approx(torque, rel=of_torque)
    assert_allclose(shoe.pressure, k * np.sin(shoe.theta), rtol=of_pressure)
    assert max(found.balance.force, found.balance.moment) < 1e-9


# Equilibria of finite elements.


BRAKES = {
    "hinged": lambda brake: brake,
    "servo": lambda brake: servo(),
    "cam": lambda brake: cam_brake(),
    "pad on a guide": lambda brake: pad("guide"),
    "pad on a rough abutment": lambda brake: pad("abutment", "-x"),
}


@pytest.mark.parametrize("name", BRAKES)
def test_friction_agrees_with_the_pressure_and_every_shoe_balances(brake, name):
    table = over_pressure(BRAKES[name](brake), KINKED)
    found = on_mesh(table)
    assert max(found.balance.force, found.balance.moment) < 1e-9
    for shoe, given in zip(found.shoes, table.shoes, strict=True):
        curve = table.friction_coefficient_curve_of_shoe(given)
        stress = curve.friction_coefficients_at_pressures(shoe.pressure) * shoe.pressure
        assert_allclose(shoe.friction_stress, stress, atol=2e-10 * stress.max())
        # The torque is that of the friction stress, integrated by hand.
        force = integral_of_piecewise_polynomial(shoe.theta, stress, shoe.order)
        area = given.lining.width * table.length_per_surface_coordinate**2
        i = found.shoes.index(shoe)
        assert found.effects[i] == pytest.approx(area * force, rel=1e-4)


def differences_of_torque(brake, key, value, step=1e-5):
    """The derivative of the torque by the logarithm of a key, by central differences of solves."""
    up, down = (
        on_mesh(vary(brake, {key: value(factor)})).effect for factor in (1 + step, 1 - step)
    )
    return (up - down) / (2 * step)


@pytest.mark.slow
@pytest.mark.parametrize("name", BRAKES)
def test_slopes_of_the_torque_are_those_of_differences(brake, name):
    """The friction of the table changes in proportion, and the pressures change it further."""
    table = over_pressure(BRAKES[name](brake), KINKED, **{"shoe[0].lining.friction": FALLING})
    slopes = drumlin.sensitivity(table, elements=12)
    assert slopes.torque == pytest.approx(on_mesh(table).effect, rel=1e-12)

    def scaled(factor):
        found = table
        for key, of in (("friction", KINKED), ("shoe[0].lining.friction", FALLING)):
            found = vary(found, {key: of | {"mu": [mu * factor for mu in of["mu"]]}})
        return on_mesh(found).effect

    near = (scaled(1 + 1e-5) - scaled(1 - 1e-5)) / 2e-5
    assert slopes.friction * table.friction == pytest.approx(near, rel=1e-7)
    shoe, own = table.shoes[0], slopes.shoes[0]
    E = shoe.lining.material.E
    near = differences_of_torque(table, "shoe[0].lining.material.E", lambda f: E * f, 1e-4)
    assert own.moduli["lining"] == pytest.approx(near, rel=1e-5, abs=1e-7 * slopes.torque)
    if own.force is not None:
        F = shoe.actuation.force
        near = differences_of_torque(table, "shoe[0].actuation.force", lambda f: F * f)
        assert own.force * F == pytest.approx(near, rel=1e-7)
    if shoe.hinge is not None:
        y = shoe.hinge.y
        near = differences_of_torque(table, "shoe[0].hinge.y", lambda f: y * f)
        assert own.held["hinge"][1] * y == pytest.approx(near, rel=1e-6)


def test_the_slope_by_friction_of_a_table_names_the_table(brake):
    """On a table of equal coefficients the slopes are those of the number."""
    plain = drumlin.sensitivity(vary(brake, {"friction": 0.35}), elements=6)
    even = over_pressure(brake, EVEN)
    table = drumlin.sensitivity(even, elements=6)
    assert table.friction == pytest.approx(plain.friction, rel=1e-10)
    assert table.shoes[0].force == pytest.approx(plain.shoes[0].force, rel=1e-10)
    assert table.law is None
    (first, *_) = sensitivity_as_text_lines(table, even)
    assert first.endswith("all frictions in proportion, friction.pressure too")
    falling = drumlin.sensitivity(over_pressure(brake), elements=6)
    assert falling.S < 0.9 * plain.S


def test_the_curve_of_hp_elements_balances_with_friction_over_pressure(brake):
    table = over_pressure(brake, KINKED)
    found = solve(table, tolerance=1e-2)
    for i, shoe in enumerate(found.shoes):
        off = relative_imbalance_of_shoe(table, i, shoe)
        assert max(off.force, off.moment) < 1e-9
        assert "friction_stress" in shoe.as_dict()
    # The energy that friction turns into heat is the work of the drum on the brake's bearings.
    force = [
        table.shoes[i].lining.width
        * table.size**2
        * integral_of_piecewise_polynomial(shoe.theta, shoe.friction_stress, shoe.order)
        for i, shoe in enumerate(found.shoes)
    ]
    assert math.fsum(force) == pytest.approx(found.torque, rel=1e-9)


def test_a_table_of_equal_coefficients_is_a_number(brake):
    plain, table = on_mesh(vary(brake, {"friction": 0.35})), on_mesh(over_pressure(brake, EVEN))
    for one, other in zip(plain.shoes, table.shoes, strict=True):
        assert other.torque == pytest.approx(one.torque, rel=1e-12)
        assert_allclose(other.pressure, one.pressure, rtol=1e-12, atol=1e-12 * one.peak_pressure)


def test_a_solid_shoe_with_a_table_of_equal_coefficients_has_a_number(brake):
    plain = drumlin.solve(vary(brake, {"friction": 0.35}), "solid")
    table = drumlin.solve(over_pressure(brake, EVEN), "solid")
    for one, other in zip(plain.shoes, table.shoes, strict=True):
        assert other.torque == pytest.approx(one.torque, rel=1e-12)
        assert_allclose(other.pressure, one.pressure, rtol=1e-12, atol=1e-12 * one.peak_pressure)


def test_the_friction_of_a_solid_shoe_agrees_with_the_pressure_at_each_node_of_its_face(brake):
    table = over_pressure(brake, KINKED)
    held = drumlin.hold(table, model="solid", steps=1)
    slopes = drumlin.sensitivity(table, model="solid")
    assert held.states[-1].torque == pytest.approx(slopes.torque, rel=1e-9)
    for face, given in zip(held.states[-1].face, table.shoes, strict=True):
        curve = table.friction_coefficient_curve_of_shoe(given)
        stress = curve.friction_coefficients_at_pressures(face.pressure) * face.pressure
        assert_allclose(np.abs(face.traction), stress, atol=1e-9 * stress.max())
        # Across the width the pressure differs, and so does the friction.
        assert np.ptp(face.pressure, axis=1).max() > 0.01 * face.pressure.max()


def test_stated_errors_of_solid_shoes_hold_with_friction_over_pressure(brake):
    table = over_pressure(brake, KINKED)
    usual, fine = (drumlin.solve(table, "solid", tolerance=least) for least in (None, 1e-3))
    stated = usual.as_dict()["error"]
    assert abs(usual.torque / fine.torque - 1) < stated["torque"] < 0.01
    change = drumlin.solve(vary(brake, {"friction": 0.35}), "solid").torque / usual.torque
    assert abs(change - 1) > 0.02


def test_the_mirror_image_has_the_same_answer(brake):
    table = over_pressure(brake, KINKED)
    mirrored = table.model_copy(update={"rotation": "clockwise"})
    found, other = on_mesh(table), on_mesh(mirrored)
    # The two shoes of this brake are mirror images of each other.
    ways = zip(found.shoes, reversed(other.shoes), strict=True)
    for one, two in ways:
        assert two.torque == pytest.approx(one.torque, rel=1e-9)


def test_units_and_the_order_of_rows_change_nothing(brake):
    turned = {"pressure": ["1000 kPa", "0 bar"], "mu": ["30 %", 0.45]}
    one, other = on_mesh(over_pressure(brake)), on_mesh(over_pressure(brake, turned))
    assert other.torque == pytest.approx(one.torque, rel=1e-12)


def test_a_refined_system_has_the_friction_of_each_node(brake):
    """A stiff lining loses digits, and the refinement of the full system finds the same answer."""
    changes = {"shoe.lining.material.E": "3000 GPa"}
    found = on_mesh(over_pressure(brake, EVEN, **changes))
    plain = on_mesh(vary(brake, {"friction": 0.35} | changes))
    assert found.torque == pytest.approx(plain.torque, rel=1e-9)


def test_the_brake_that_rising_friction_locks_has_no_answer(brake):
    rising = {"pressure": ["0 MPa", "0.2 MPa", "2 MPa"], "mu": [0.3, 0.5, 3.0]}
    with pytest.raises(NoAnswer, match=r"right|left"):
        on_mesh(over_pressure(brake, rising, **{"shoe.actuation.force": "40 kN"}))
    with pytest.raises(NoAnswer, match="self-locking"):
        drumlin.solve(over_pressure(brake, rising, **{"shoe.actuation.force": "40 kN"}), "short")


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_stated_errors_hold_for_tables_with_kinks(seed):
    brake = draw_random_brake(seed)
    friction = brake.friction or 0.3
    peak = max(shoe.peak_pressure for shoe in solve(brake, tolerance=1e-2).shoes)
    table = {
        "pressure": [0.0, 0.35 * peak, 0.8 * peak],
        "mu": [friction, 1.1 * friction, 0.6 * friction],
    }
    brake = over_pressure(brake, table)
    found, fine = solve(brake, tolerance=1e-2), solve(brake, tolerance=5e-4)
    off = abs(found.torque / fine.torque - 1)
    assert off <= found.error["torque"] + fine.error["torque"]


UNLIKE = {"friction": KINKED, "shoe[1].lining.friction": FALLING}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("file", "friction"),
    [
        ("double_shoe/brake.toml", {"friction": FALLING}),
        ("double_shoe/brake.toml", UNLIKE),
        ("brakes/uni_servo.toml", {"friction": FALLING}),
    ],
    ids=["hinged", "hinged, unlike linings", "servo"],
)
def test_the_second_solver_has_the_same_friction_over_pressure(file, friction):
    """Triangles iterate mu(p) at fixed coefficients, by no code of the elements."""
    brake = vary(read_drum_or_plane_brake(ROOT / "studies" / file), friction)
    found = drumlin.solve(brake, tolerance=1e-3, model_error=False)
    coarse, fine = solve_brake_on_sequence_of_triangle_meshes(
        brake, TRIANGLE_MESH_LEVELS_FROM_COARSE_TO_FINE[:2]
    )
    own = true_errors_of_response(brake, coarse, fine)
    true = true_errors_of_response(brake, found.shoes, fine)
    for name in ("pressure", "torque", "peak", "reaction"):
        # The fine triangles have at most a quarter of the error of the coarse ones.
        assert true[name] <= found.error[name] + own[name] / 3
    assert own["torque"] < 5e-5
    # At the friction of no pressure the torque is another one.
    plain = vary(brake, {"friction": brake.friction, "shoe.lining.friction": None})
    assert drumlin.solve(plain, model_error=False).torque > 1.05 * found.torque


@pytest.mark.slow
def test_reference_values_with_friction_over_pressure_come_from_both_solvers(brake):
    table, meshes = over_pressure(brake), MESHES_OF_PUBLISHED_REFERENCE_VALUES
    fewer = meshes._replace(triangles=meshes.triangles[:2])
    found = solve_brake_for_reference_values(table, fewer)
    assert found.other is not None and found.other.model == "triangles"
    values = compute_reference_values(table, "", "", found)
    assert values.torque.relative_uncertainty < 1e-5
    assert values.torque.value == pytest.approx(drumlin.solve(table).torque, rel=1e-5)


# Speed and temperature.

GRID = {
    "pressure": ["0 MPa", "1 MPa"] * 2,
    "speed": ["5 m/s"] * 2 + ["15 m/s"] * 2,
    "mu": [0.4, 0.3, 0.36, 0.28],
}


def test_each_shoe_needs_few_steps_of_newtons_method(brake, monkeypatch):
    """With another slope than the tangent's the steps come closer in proportion only: 10 a shoe."""
    tangents = []
    made = pressure_friction.contact_problem_with_friction_tangent

    def counted(*arguments):
        tangents.append(arguments)
        return made(*arguments)

    monkeypatch.setattr(pressure_friction, "contact_problem_with_friction_tangent", counted)
    on_mesh(over_pressure(brake))
    assert len(tangents) <= 5 * len(brake.shoes)


def test_a_grid_is_linear_in_pressure_and_speed(brake):
    # 150 mm at 50 rad/s slide at 7.5 m/s, a quarter of the way from 5 to 15 m/s.
    table = over_pressure(brake, GRID, **{"drum.speed": 50.0})
    curve = table.friction_coefficient_curve_of_shoe(table.shoes[0])
    assert table.sliding_speed == pytest.approx(0.150 * 50)
    assert_allclose(
        curve.friction_coefficients_at_pressures(np.array([0, 5e5, 9e9])),
        [0.39, 0.3425, 0.295],
        rtol=1e-12,
    )
    assert_allclose(
        curve.friction_slopes_at_pressures(np.array([0, 5e5, 9e9])),
        [-9.5e-8, -9.5e-8, 0],
        rtol=1e-9,
    )
    reduced = {"pressure": [0, 1e6], "mu": [0.39, 0.295]}
    expected = on_mesh(over_pressure(brake, reduced)).torque
    assert on_mesh(table).torque == pytest.approx(expected, rel=1e-12)


def test_speed_and_temperature_alone_give_each_lining_a_number(brake):
    table = {
        "temperature_rise": ["0 K", "200 K"] * 2,
        "speed": ["0 m/s"] * 2 + ["15 m/s"] * 2,
        "mu": [0.4, 0.3, 0.36, 0.28],
    }
    hot = {"shoe[0].lining.temperature_rise": 100.0, "shoe.lining.material.expansion": 0.0}
    varied = over_pressure(brake, table, **{"drum.speed": 50.0} | hot)
    assert [
        varied.friction_coefficient_of_shoe_at_zero_pressure(shoe) for shoe in varied.shoes
    ] == pytest.approx([0.335, 0.38])
    plain = {"friction": 0.38, "shoe[0].lining.friction": 0.335}
    for model in ("fem", "sine"):
        options = {"elements": 12, "model_error": False} if model == "fem" else {}
        one = drumlin.solve(vary(brake, plain | hot), model, **options)
        other = drumlin.solve(varied, model, **options)
        assert other.torque == pytest.approx(one.torque, rel=1e-12)
    slopes = [drumlin.sensitivity(each, elements=4) for each in (vary(brake, plain),)]
    assert slopes[0].friction > 0


def test_the_shoes_of_a_clutch_slide_at_the_difference_of_both_speeds():
    clutch = drumlin.example("centrifugal_clutch")
    table = {"speed": ["0 m/s", "100 m/s"], "mu": [0.2, 0.4]}
    still, turning = (
        vary(clutch, {"friction": table, "drum.speed": speed}) for speed in (None, "600 rpm")
    )
    omega = clutch.shoe_speed
    assert still.sliding_speed == pytest.approx(omega * clutch.size)
    slower = abs(omega - 20 * math.pi) * clutch.size
    assert turning.sliding_speed == pytest.approx(slower)
    assert turning.friction == pytest.approx(0.2 + 0.2 * slower / 100)


def test_a_brake_with_a_table_is_written_and_read_again(brake, tmp_path):
    table = over_pressure(
        brake, GRID, **{"drum.speed": "477 rpm", "shoe[0].lining.friction": FALLING}
    )
    path = tmp_path / "brake.toml"
    path.write_text(brake_file_text(table), encoding="utf-8")
    assert read_drum_or_plane_brake(path) == table
    assert vary(table, {"friction": 0.3, "shoe.lining.friction": None, "drum.speed": None}) == vary(
        brake, {"friction": 0.3}
    )


# Refusals.

WRONG = {
    "no column": ({"mu": [0.4, 0.3]}, "mu: give a column beside it: pressure, speed"),
    "length": ({"mu": [0.4], "pressure": [0.0, 1.0]}, "has 2 values; must have 1"),
    "equal": ({"mu": [0.4, 0.3], "pressure": [1.0, 1.0]}, "has the same value in all rows"),
    "grid": (
        {"mu": [0.4, 0.3, 0.2], "pressure": [0.0, 1.0, 2.0], "temperature_rise": [0.0, 0.0, 1.0]},
        "must have 6: each of the pressures at each of the temperatures once",
    ),
    "zero": ({"mu": [0.0, 0.3], "pressure": [0.0, 1.0]}, "mu[0] = 0.0: must be greater"),
    "negative": (
        {"mu": [0.4, 0.3], "pressure": [-1.0, 1.0]},
        "pressure[0] = -1.0: must be greater",
    ),
    "unit": (
        {"mu": [0.4, 0.3], "pressure": ["0 m", "1 m"]},
        "pressure[0] = '0 m': must be a stress",
    ),
    "key": ({"mu": [0.4, 0.3], "pressures": [0.0, 1.0]}, "did you mean 'pressure'?"),
    "speed": ({"mu": [0.4, 0.3], "speed": [0.0, 1.0]}, "needs the sliding speed; give drum.speed"),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_table_is_refused_by_its_key(brake, name):
    table, words = WRONG[name]
    with pytest.raises(BadInput) as refused:
        over_pressure(brake, table)
    assert "friction" in str(refused.value) and words in str(refused.value)


def test_a_speed_without_a_table_over_speed_is_refused(brake):
    with pytest.raises(BadInput, match=r"drum\.speed: has no effect"):
        vary(brake, {"drum.speed": "300 rpm"})
    with pytest.raises(BadInput, match=r"needs the sliding speed; give plane\.speed"):
        vary(pad("guide"), {"friction": {"mu": [0.4, 0.3], "speed": [0.0, 1.0]}})
    moved = vary(
        pad("guide"), {"friction": {"mu": [0.4, 0.3], "speed": [0.0, 1.0]}, "plane.speed": 0.5}
    )
    assert make_validated_brake_part(FlatBrake, moved.model_dump(by_alias=True)).friction == 0.35


REFUSED = {
    "explore": SliderSolver,
    "finite width": lambda brake: drumlin.solve(brake, finite_width=True),
    "sine": lambda brake: drumlin.solve(brake, "sine"),
    "cosine": lambda brake: drumlin.solve(brake, "cosine"),
    "block": lambda brake: drumlin.solve(brake, "block"),
    "peers": mesh_shoes_for_peer_program,
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_takes_no_friction_over_pressure_names_the_key(brake, name):
    with pytest.raises(BadInput, match=r"friction\.pressure: .* takes no friction") as refused:
        REFUSED[name](over_pressure(brake))
    assert "\n" not in str(refused.value)


def test_check_takes_the_friction_at_each_pressure(brake):
    """A pressure curve is judged by the torque of its friction stress mu(p) p."""
    table = over_pressure(brake)
    table = table.model_copy(update={"shoes": table.shoes[:1]})
    (shoe,) = drumlin.solve(table, elements=12).shoes
    lining, unknown = table.shoes[0].lining, UncertainValue(0.0, 0.0)
    theta = np.linspace(lining.start, lining.end, 2001)
    p = shoe.pressure_at(theta)
    known = ReferenceValuesOfShoe(
        name=shoe.name,
        torque=UncertainValue(shoe.torque, 0.0),
        contact_force=unknown,
        hinge_reaction=unknown,
        peak_pressure=UncertainValue(float(p.max()), 0.0),
        contact_arcs=unknown,
        ends=(lining.start, lining.end),
        edge=0.0,
        theta=theta,
        pressure=p,
        uncertainty=0 * p,
        distance=0.0,
    )
    text = brake_file_text(table)
    brake_known = ReferenceValuesOfBrake("", text, "", "", {}, known.torque, (known,))
    (same,) = compare_curves_with_reference(
        table, brake_known, {shoe.name: PressureCurveOfShoe(theta, p)}
    )
    # The solver interpolates the friction stress between the nodes of its coarse elements.
    assert same.torque == pytest.approx(shoe.torque, rel=1e-3)
    assert same.torque_error == 0
    (more,) = compare_curves_with_reference(
        table, brake_known, {shoe.name: PressureCurveOfShoe(theta, 1.2 * p)}
    )
    columns = [0.0, 1e6], FALLING["mu"]
    added = 1.2 * p * np.interp(1.2 * p, *columns) - p * np.interp(p, *columns)
    expected = lining.width * table.size**2 * np.trapezoid(added, theta) / shoe.torque
    # The comparison leaves out the last of the 2001 angles, at the end of the lining.
    assert more.torque_error == pytest.approx(expected, rel=1e-3)
    assert more.torque_error < 0.19


def test_solve_compare_and_size_say_what_they_leave_out(brake):
    table = over_pressure(brake)
    found = drumlin.solve(table, elements=12)
    assert found.plane_stress_error.unknown
    law = drumlin.solve(table, "uniform")
    assert any("friction.pressure: the distance from self-locking" in note for note in law.notes)
    assert law.self_locking is None
    worn = drumlin.solve(table, elements=12, worn_in=True)
    assert any(note.endswith("in plane stress for unworn linings") for note in worn.notes)
    with pytest.raises(BadInput, match=r"friction: must be .* number, not a table over pressure;"):
        drumlin.size(table, "friction", torque=300.0)
    assert [o.model for o in drumlin.compare(table, elements=12).outcomes] == [
        "fem",
        "uniform",
        "short",
    ]
    sized = drumlin.size(table, "shoe.actuation.force", torque=700.0, model="short")
    again = drumlin.solve(vary(table, {"shoe.actuation.force": sized.value}), "short")
    assert again.torque == pytest.approx(700.0, rel=1e-6)


def test_the_table_of_a_function_meets_it(brake):
    def fading(pressure):
        return 0.4 / (1 + 1e-6 * pressure)

    table = vary(brake, {"friction": fading}).friction_as_written
    curve = table.friction_coefficient_curve_at_speed_and_temperature_rise(0.0, 0.0)
    pressure = np.geomspace(1e3, 1e8, 20001)
    met = np.interp(pressure, curve.pressure, curve.mu)
    assert np.abs(met / fading(pressure) - 1).max() < 6e-5
    assert np.abs(met - fading(pressure)).max() < 1e-5
