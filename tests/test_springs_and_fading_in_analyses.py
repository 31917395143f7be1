"""Springs with a rate and friction over the pressure, in all analyses but `solve`."""

import math
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy.integrate import quad

import drumlin
from anchored_shoes import FORCE, duo_servo
from drumlin.base.arrays import slices_from_lengths_of_consecutive_parts
from drumlin.base.errors import BadInput, NoAnswer
from drumlin.brake.file import make_drum_brake_from_data, vary
from drumlin.contact.active_set import solve_contact_problem
from drumlin.contact.equations import ContactProblem
from drumlin.contact.pressure_friction import (
    NodalFrictionAndSlope,
    find_largest_friction_factor_with_equilibrium,
)
from drumlin.contact.self_locking import FrictionDependentProblem
from drumlin.contact.stick_slip import BACKWARD, FORWARD, STICK
from drumlin.fem.analysis.sensitivity import (
    compute_torque_sensitivity,
    sensitivity_as_text_lines,
)
from drumlin.fem.analysis.slope_by_key import exact_torque_slope_by_key
from drumlin.fem.error_control.levels import REFINEMENT_LEVELS_FROM_COARSE_TO_FINE
from drumlin.fem.preparation.prepare import make_prepared_model
from drumlin.fem.solve import solve
from drumlin.laws.rigid import UNUSED_KEYS_LINE_START
from drumlin.lining_wear.archard import (
    WearLaw,
    solve_steady_wear,
    wear_linings_over_sliding_distance,
)
from drumlin.lining_wear.linings import wear_setup_by_finite_elements
from drumlin.lining_wear.worn_in import brake_without_misfit_and_clearance
from flat_pads import pad
from friction_tables import EVEN, FALLING, KINKED, over_pressure
from further_loads import BODY, PULL, brake_with, two_shoes
from shared_forces import cam_brake, servo

SOFT = PULL | {"rate": 1e5}
STIFF = PULL | {"rate": 1e6}
LOPSIDED: dict[str, Any] = {
    "shoe": "right",
    "point": {"x": 0.06, "y": 0.04},
    "end": {"x": -0.02, "y": 0.02},
    "preload": 100.0,
    "rate": 1e6,
}
"""A spring from one shoe of a cam to the frame: its effects on the two tips do not cancel."""
ELEMENTS = 8

SPRUNG = {
    "rigid shoes": lambda: two_shoes(spring=[STIFF]),
    "elastic shoes": lambda: two_shoes(True, spring=[STIFF]),
    "cam": lambda: two_shoes(True, actuation={"force": 2000.0}, spring=[LOPSIDED]),
    "friction over pressure": lambda: over_pressure(two_shoes(True, spring=[STIFF]), FALLING),
}


def on_mesh(brake):
    return solve(brake, elements=ELEMENTS)


# Friction over the pressure in wear.


def test_wear_with_a_table_of_equal_coefficients_is_wear_with_a_number(brake):
    plain = drumlin.wear(vary(brake, {"friction": 0.35}), elements=ELEMENTS).states
    table = drumlin.wear(over_pressure(brake, EVEN), elements=ELEMENTS).states
    for one, other in zip(plain, table, strict=True):
        assert other.s == pytest.approx(one.s, rel=1e-10)
        assert other.torque == pytest.approx(one.torque, rel=1e-10)
        assert other.work == pytest.approx(one.work, rel=1e-10)
        assert_allclose(other.pressure, one.pressure, atol=1e-10 * one.pressure.max())
        assert_allclose(other.depth, one.depth, atol=1e-10 * max(one.depth.max(), 1e-12))


@pytest.mark.parametrize("sliding", ["+x", "-x"])
def test_a_hinged_pad_wears_to_its_closed_form_under_friction_linear_in_pressure(sliding):
    """Worn in, p = c x from the hinge, and the moment about the hinge is quadratic in c."""
    mu, slope = 0.45, -0.15 / 1.5e6
    table = {"pressure": [0.0, 1.5e6], "mu": [mu, mu + slope * 1.5e6]}
    brake = vary(pad("hinge"), {"friction": table, "plane.sliding": sliding})
    run = drumlin.wear(brake, elements=ELEMENTS, tolerance=1e-3)
    lining, h = brake.shoes[0].lining, brake.shoes[0].pin.y
    s, M, w = brake.sign_of_motion, 500.0 * 0.25, lining.width

    def integral(power):
        return w * (lining.end ** (power + 1) - lining.start ** (power + 1)) / (power + 1)

    a, b = s * h * slope * integral(2), integral(2) + s * h * mu * integral(1)
    c = min(root for root in np.roots([a, b, -M]).real if root > 0)
    surface = run.setup.surfaces[0]
    assert 0.2e6 < run.target.pressure.max() < 1.5e6
    assert_allclose(run.target.pressure, c * surface.theta, rtol=1e-9)
    force = mu * c * integral(1) + slope * c**2 * integral(2)
    assert run.target.torque == pytest.approx(force, rel=1e-9)
    assert run.states[-1].torque == pytest.approx(force, rel=1e-3)
    assert run.states[0].torque == pytest.approx(
        solve(brake, elements=ELEMENTS, penalty=math.inf).effect, rel=1e-10
    )


def test_a_short_pad_keeps_its_even_pressure_as_it_wears():
    """N (x + s mu(N/A) h) = M is quadratic in N, and the pressure of a short shoe stays even."""
    mu, slope = 0.45, -0.15 / 60e6
    keys = {"shoe.lining.start": 0.119, "shoe.lining.end": 0.121}
    table = {"pressure": [0.0, 60e6], "mu": [mu, mu + slope * 60e6]}
    brake = vary(pad("hinge"), {"friction": table} | keys)
    shoe = brake.shoes[0]
    area = shoe.lining.width * (shoe.lining.end - shoe.lining.start)
    x, h, M = shoe.lining.middle, shoe.pin.y, 500.0 * 0.25
    s = brake.sign_of_motion
    roots = np.roots([s * h * slope / area, x + s * mu * h, -M]).real
    N = min(root for root in roots if root > 0)
    run = drumlin.wear(brake, elements=ELEMENTS)
    # The pressure grows with the distance from the hinge, by 1/60 from the middle to the end.
    assert run.states[-1].torque == pytest.approx((mu + slope * N / area) * N, rel=1e-3)


USES = {
    "servo": servo,
    "cam": cam_brake,
    "rough abutment": lambda: pad("abutment", "-x"),
}


@pytest.mark.parametrize("name", USES)
def test_wear_and_holding_begin_and_end_at_solve_with_friction_over_pressure(name):
    brake = over_pressure(USES[name](), KINKED)
    worn = drumlin.wear(brake, elements=ELEMENTS, distance="0.01")
    solved = solve(brake, elements=ELEMENTS, penalty=math.inf)
    assert worn.states[0].torque == pytest.approx(solved.effect, rel=1e-9)
    held = drumlin.hold(brake, elements=ELEMENTS, steps=4).states[-1]
    assert held.torque == pytest.approx(on_mesh(brake).effect, rel=1e-9)
    assert not held.notes


def test_wear_under_friction_over_pressure_removes_what_its_pressures_do(brake):
    """The worn volume is k times the normal force over the way, and the work that of mu(p) p."""
    run = drumlin.wear(over_pressure(brake, KINKED), elements=ELEMENTS, distance="0.5")
    end = run.states[-1]
    assert end.removed == pytest.approx(run.law.coefficient * end.pressed, rel=1e-12)
    torques = [state.torque for state in run.states]
    assert min(torques) * end.s <= end.work <= max(torques) * end.s
    assert not any("energy" in line for line in run.lines())
    with pytest.raises(BadInput, match=r"friction\.pressure: a torque that is kept"):
        drumlin.wear(over_pressure(brake), torque="300 N m", elements=ELEMENTS)


# Friction over the pressure in holding.


def test_holding_with_a_table_of_equal_coefficients_is_holding_with_a_number(brake):
    plain = drumlin.hold(vary(brake, {"friction": 0.35}), elements=ELEMENTS, steps=5).states
    table = drumlin.hold(over_pressure(brake, EVEN), elements=ELEMENTS, steps=5).states
    for one, other in zip(plain, table, strict=True):
        assert other.torque == pytest.approx(one.torque, rel=1e-12, abs=1e-9)
        for a, b in zip(one.pressure, other.pressure, strict=True):
            assert_allclose(b, a, atol=1e-12 * a.max())


def test_tractions_of_a_holding_brake_keep_within_friction_over_pressure(brake):
    table = over_pressure(brake, KINKED)
    run = drumlin.hold(table, elements=ELEMENTS, steps=6).states
    curve = table.friction_coefficient_curve_of_shoe(table.shoes[0])
    slipping = 0
    for state in run:
        for p, t, node in zip(state.pressure, state.traction, state.state, strict=True):
            bound = curve.friction_coefficients_at_pressures(p) * p
            assert (np.abs(t) <= bound + 1e-9 * bound.max())[node == STICK].all()
            for kind, sign in ((FORWARD, 1.0), (BACKWARD, -1.0)):
                on = node == kind
                slipping += int(np.count_nonzero(on))
                assert_allclose(t[on], sign * bound[on], atol=1e-9 * bound.max())
    assert slipping > 20
    assert run[-1].torque == pytest.approx(on_mesh(table).torque, rel=1e-9)
    assert run[-1].dissipated > run[0].dissipated


def test_worn_in_linings_with_friction_over_pressure_have_the_pressure_of_steady_wear(brake):
    """The clearances of the worn-in linings give the steady pressure of Archard's law."""
    table = over_pressure(brake, FALLING)
    found = drumlin.solve(table, worn_in=True, elements=ELEMENTS)
    fitting = brake_without_misfit_and_clearance(table, drum=True)
    setup = wear_setup_by_finite_elements(make_prepared_model(table, elements=ELEMENTS), fitting)
    for interface, surface in zip(setup.interfaces, setup.surfaces, strict=True):
        steady = solve_steady_wear(interface, WearLaw(1.0)).contact.p
        p = found.shoes[surface.shoe].pressure
        assert_allclose(np.sort(p), np.sort(steady), rtol=1e-9)
    plain = drumlin.solve(vary(brake, {"friction": 0.45}), worn_in=True, elements=ELEMENTS)
    assert found.torque < 0.99 * plain.torque


# Friction over the pressure in self-locking.


def test_one_node_on_a_lever_locks_at_its_closed_form():
    """(x - f mu(p) a) p = M with mu = mu_0 + b p: two solutions meet at one factor f.

    The quadratic equation f b a p^2 - (x - f mu_0 a) p + M = 0 has a double root there.
    """
    x, a, mu, b, M = 1.0, 0.8, 0.3, 0.05, 0.4
    frictionless = ContactProblem(
        np.eye(1), np.zeros(1), -np.full((1, 1), x), -np.full((1, 1), x), np.full(1, -M)
    )
    problem = FrictionDependentProblem(frictionless, np.zeros((1, 1)), np.full((1, 1), a))

    def friction(p):
        return NodalFrictionAndSlope(mu + b * p, np.full(1, b))

    # (x - f mu a)^2 = 4 f a b M.
    roots = np.roots([(mu * a) ** 2, -(2 * x * mu * a + 4 * a * b * M), x**2]).real
    limit = min(roots)
    p = min(np.roots([b * a, -(x - mu * a), M]).real)
    start = solve_contact_problem(problem.contact_problem_at_friction_coefficient(mu + b * p))
    assert start.p[0] == pytest.approx(p, rel=1e-12)
    end = find_largest_friction_factor_with_equilibrium(problem, friction, start, 50.0, np.ones(1))
    assert end.factor == pytest.approx(limit, rel=1e-6)
    assert end.pressure_stays_finite


@pytest.mark.parametrize(
    "table",
    [FALLING, pytest.param({"pressure": [0.0, 3e6], "mu": [0.3, 0.6]}, marks=pytest.mark.slow)],
)
def test_the_factor_that_locks_the_brake_is_that_of_bisection_on_solve(brake, table):
    """A force of 2 mN keeps the strains small up to the limit; its table has pressures like it."""
    small = {f"shoe[{i}].actuation.force": 2e-3 for i in (0, 1)}
    si = make_drum_brake_from_data(
        over_pressure(brake, table).model_dump(by_alias=True)
    ).friction_as_written

    def scaled(factor):
        raised = {"pressure": [1e-6 * p for p in si.pressure], "mu": [factor * m for m in si.mu]}
        return vary(brake, {"friction": raised} | small)

    whole = scaled(1.0)
    limits = drumlin.self_locking(whole, elements=6, most=3.0)
    found = min(limit.friction for limit in limits) / whole.friction
    assert not any(limit.bounded for limit in limits)

    def has_answer(factor):
        try:
            return solve(scaled(factor), elements=6, penalty=math.inf) is not None
        except NoAnswer:
            return False

    low, high = 1.0, 8.0
    while high - low > 1e-6 * low:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if has_answer(middle) else (low, middle)
    assert found == pytest.approx(low, rel=3e-6)


def test_solve_says_at_which_factor_the_friction_locks_the_brake(brake):
    far = drumlin.solve(over_pressure(brake, EVEN), elements=6, model_error=False)
    assert far.self_locking.elastic.friction == math.inf
    line = far.self_locking.line()
    assert "is above 1.5 times its friction, where the search ends (friction.pressure)" in line
    limits = drumlin.self_locking(vary(brake, {"friction": 0.35}), elements=6, penalty=1e8)
    limit = min(limit.friction for limit in limits)
    near = EVEN | {"mu": [limit / 1.25, limit / 1.25]}
    found = drumlin.solve(over_pressure(brake, near), elements=6, model_error=False)
    assert found.self_locking.elastic.friction == pytest.approx(1.25, rel=1e-6)
    assert found.as_dict()["self_locking"]["factor"] == found.self_locking.elastic.friction
    assert any("locks at 1.25 times its friction" in note for note in found.notes)


# Springs with a rate in wear.


@pytest.mark.parametrize("sign", [1, -1])
def test_a_spring_stops_the_wear_of_a_hinged_rigid_shoe_as_in_closed_form(sign):
    """On a contact far softer than the bodies p = C sin phi, from the new lining on.

    The turn by the contact's softness and the turn by wear stretch the spring of rate k at the arm
    b. With M = C J the moment falls as exp(-s/L), L = (1 + k b^2 c) a J/(k_w k b^2), where c is the
    turn per moment and a the distance of the hinge.
    """
    start, end, a, R, w, mu = 0.6, 2.3, 0.1, 0.12, 0.03, 0.4
    b, force, arm, preload = 0.15, 900.0, 0.22, 300.0 * sign
    shoe = {
        "name": "shoe",
        "side": "internal",
        "hinge": {"x": a, "y": 0.0},
        "lining": {"start": start, "end": end, "thickness": 5e-3, "width": w}
        | {"material": {"E": 5e8, "nu": 0.25}},
        "actuation": {"force": force, "direction": math.pi / 2, "point": {"x": a - arm, "y": 0.0}},
    }
    data = {
        "title": "rigid limit",
        "rotation": "clockwise",
        "friction": mu,
        "drum": {"radius": R},
        "shoe": [shoe],
    }
    penalty, law = 1e-10, WearLaw(1e-14)
    plain = solve(make_drum_brake_from_data(data), elements=8, penalty=penalty)
    sense = 1.0 if plain.shoes[0].self_energising else -1.0
    normal = quad(lambda x: a * math.sin(x) ** 2, start, end, epsabs=1e-15)[0]
    dragged = quad(lambda x: math.sin(x) * (R - a * math.cos(x)), start, end, epsabs=1e-15)[0]
    J = w * R * (normal - sense * mu * dragged)
    c = 1 / (penalty * 5e8 / 5e-3 * a * J)
    rate = 0.25 / (b**2 * c)
    M = (force * arm - abs(preload) * b) / (1 + rate * b**2 * c)
    L = (1 + rate * b**2 * c) * a * J / (law.coefficient * rate * b**2)
    # A spring that pushes the shoe back does so from the other side.
    spring = {"shoe": "shoe", "point": {"x": a - b, "y": 0.0}, "preload": preload, "rate": rate}
    spring["end"] = {"x": a - b, "y": -0.1 * sign}
    brake = make_drum_brake_from_data(data | {"spring": [spring]})
    scene = make_prepared_model(brake, REFINEMENT_LEVELS_FROM_COARSE_TO_FINE[2])
    setup = wear_setup_by_finite_elements(scene, brake, penalty=penalty)
    states = wear_linings_over_sliding_distance(
        setup.interfaces, law, distance=1.5 * L, tolerance=1e-4
    )
    theta = setup.surfaces[0].theta
    problem = setup.interfaces[0].problem
    for state in states:
        # Pressures and spring balance the actuation.
        assert_allclose(problem.C @ state.pressure, problem.h, rtol=1e-11)
        lining = setup.state_with_spring_pulls_apart(state)
        C = M * math.exp(-state.s / L) / J
        assert_allclose(lining.pressure, C * np.sin(theta), rtol=5e-5)
        (pull,) = lining.pulls
        assert abs(pull) * b + J * C == pytest.approx(force * arm, rel=5e-5)
    assert len(states) > 8
    # Before any wear there are no steps, whose errors would add up.
    assert_allclose(states[0].pressure[:-1], M / J * np.sin(theta), rtol=2e-9)


@pytest.mark.parametrize("name", ["rigid shoes", "elastic shoes", "cam"])
def test_wear_under_springs_begins_at_solve_and_each_shoe_balances(name):
    brake = SPRUNG[name]()
    run = drumlin.wear(brake, elements=ELEMENTS, distance="2")
    unworn = solve(brake, elements=ELEMENTS, penalty=math.inf)
    first, *_, last = run.states
    assert first.pulls == pytest.approx(unworn.spring_pulls, rel=1e-11)
    assert first.torque == pytest.approx(unworn.torque, rel=1e-11)
    assert last.pulls[0] > first.pulls[0] + 0.3
    assert any(line.startswith("spring[0]: pulls by") for line in run.lines())
    assert run.as_dict()["states"][-1]["spring_pulls"] == [last.pulls[0]]
    assert last.removed == pytest.approx(run.law.coefficient * last.pressed, rel=1e-12)
    # Worn linings under constant springs of the last pulls are the same brake.
    constant = {"spring[0].preload": last.pulls[0], "spring[0].rate": 0.0}
    setup = run.setup
    parts = slices_from_lengths_of_consecutive_parts(
        len(interface.area) for interface in setup.interfaces
    )
    for interface, part in zip(setup.interfaces, parts, strict=True):
        problem = interface.problem
        worn = problem._replace(q=problem.q + interface.weight @ last.depth[part])
        p = solve_contact_problem(worn).p
        assert_allclose(p, last.pressure[part], atol=1e-9 * p.max())
    assert vary(brake, constant).springs[0].preload == last.pulls[0]


def test_wear_under_springs_is_mirrored_and_does_not_depend_on_the_order_of_shoes():
    keys: dict[str, Any] = {"elements": ELEMENTS, "distance": "1"}
    a = drumlin.wear(two_shoes(spring=[STIFF]), **keys).states[-1]
    b = drumlin.wear(two_shoes(spin=-1, spring=[STIFF]), **keys).states[-1]
    data = two_shoes(spring=[STIFF]).model_dump(by_alias=True)
    data["shoe"] = data["shoe"][::-1]
    c = drumlin.wear(make_drum_brake_from_data(data), **keys).states[-1]
    text = STIFF | {"rate": "1000 N/mm", "preload": "0.1 kN"}
    d = drumlin.wear(two_shoes(spring=[text]), **keys).states[-1]
    for other in (b, c, d):
        assert other.pulls == pytest.approx(a.pulls, rel=1e-9)
        assert other.torque == pytest.approx(a.torque, rel=1e-9)
        assert_allclose(np.sort(other.pressure), np.sort(a.pressure), atol=1e-8 * a.pressure.max())


def test_wear_under_a_spring_needs_a_distance_and_a_spring_that_acts():
    brake = two_shoes(spring=[SOFT])
    with pytest.raises(BadInput, match=r"spring\[0\]\.rate = 100 N/mm: .*a distance must be given"):
        drumlin.wear(brake, elements=ELEMENTS)
    on = {"preload": -10.0, "rate": 1e6}
    with pytest.raises(NoAnswer, match=r"spring\[0\]: goes slack"):
        drumlin.wear(two_shoes(spring=[PULL | on]), elements=ELEMENTS, distance="100")


# Springs with a rate in holding.


def test_a_spring_without_preload_that_turns_round_is_not_said_to_have_one():
    """At rest this spring would push, but it pulls while the drum slides."""
    brake = two_shoes(True, spring=[STIFF | {"preload": 0.0}])
    assert on_mesh(brake).spring_pulls[0] > 0
    with pytest.raises(NoAnswer, match=r"it pulls in solve, without a preload, and would .* push"):
        drumlin.hold(brake, elements=ELEMENTS, steps=3)


@pytest.mark.parametrize("cam", [False, True])
def test_a_spring_keeps_acting_in_a_holding_brake(cam):
    brake = two_shoes(True, spring=[STIFF])
    if cam:
        brake = two_shoes(True, spring=[LOPSIDED], actuation={"force": 2000.0})
    states = drumlin.hold(brake, elements=ELEMENTS, steps=4).states
    solved = on_mesh(brake)
    assert states[-1].spring_pulls == pytest.approx(solved.spring_pulls, rel=1e-10)
    assert states[-1].torque == pytest.approx(solved.torque, rel=1e-10)
    assert not states[-1].notes
    # At rest the pull differs, and constant springs of these pulls hold the drum alike.
    assert abs(states[0].spring_pulls[0] - solved.spring_pulls[0]) > 0.1
    constant = {"spring[0].preload": states[0].spring_pulls[0], "spring[0].rate": 0.0}
    rest = drumlin.hold(vary(brake, constant), elements=ELEMENTS, steps=4).states[0]
    for a, b in zip(rest.pressure, states[0].pressure, strict=True):
        assert_allclose(b, a, atol=1e-9 * a.max())
    assert [row["spring_pulls"] for row in drumlin_rows(brake)][-1] == pytest.approx(
        list(solved.spring_pulls), rel=1e-10
    )


def drumlin_rows(brake):
    return drumlin.hold(brake, elements=ELEMENTS, steps=1).as_dict()


def test_springs_and_friction_over_pressure_act_together():
    brake = over_pressure(two_shoes(True, spring=[STIFF]), KINKED)
    solved = on_mesh(brake)
    held = drumlin.hold(brake, elements=ELEMENTS, steps=3).states[-1]
    assert held.torque == pytest.approx(solved.torque, rel=1e-9)
    assert held.spring_pulls == pytest.approx(solved.spring_pulls, rel=1e-9)
    exact = solve(brake, elements=ELEMENTS, penalty=math.inf)
    worn = drumlin.wear(brake, elements=ELEMENTS, distance="0.1").states[0]
    assert worn.torque == pytest.approx(exact.torque, rel=1e-9)
    assert worn.pulls == pytest.approx(exact.spring_pulls, rel=1e-9)


# Springs with a rate on shoes that can leave their supports.

ACROSS = PULL | {"point": {"x": 0.05, "y": 0.07}, "end": {"x": -0.05, "y": 0.07}}
TO_FRAME = {key: value for key, value in ACROSS.items() if key != "to"}
ON_ANCHORS = {
    "elastic": lambda: vary(duo_servo(), {"spring": [ACROSS | {"rate": 1e6}]}),
    "reversed": lambda: vary(duo_servo(-1), {"spring": [ACROSS | {"rate": 1e6}]}),
    "rigid": lambda: vary(duo_servo(body=False), {"spring": [ACROSS | {"rate": 1e6}]}),
    "to the frame": lambda: vary(duo_servo(), {"spring": [TO_FRAME | {"rate": 1e5}]}),
    "fading": lambda: over_pressure(
        vary(duo_servo(), {"spring": [ACROSS | {"rate": 1e5}]}), FALLING
    ),
}


@pytest.mark.parametrize(
    "name",
    ["elastic", "rigid"]
    + [
        pytest.param(name, marks=pytest.mark.slow)
        for name in ("reversed", "to the frame", "fading")
    ],
)
def test_springs_act_on_anchors_in_solve_in_holding_and_in_wear(name):
    """The three find the pull in different ways: by iteration, beside tractions, beside pressures.

    The forces of anchors and strut bend the shoes, which moves the points of the spring.
    """
    brake = ON_ANCHORS[name]()
    solved = on_mesh(brake)
    held = drumlin.hold(brake, elements=ELEMENTS, steps=3).states
    assert held[-1].spring_pulls == pytest.approx(solved.spring_pulls, rel=1e-9)
    assert held[-1].torque == pytest.approx(solved.torque, rel=1e-9)
    assert not held[-1].notes
    # At rest, constant springs of the pulls there hold the drum alike.
    constant = {"spring[0].preload": held[0].spring_pulls[0], "spring[0].rate": 0.0}
    rest = drumlin.hold(vary(brake, constant), elements=ELEMENTS, steps=3).states[0]
    for a, b in zip(rest.pressure, held[0].pressure, strict=True):
        assert_allclose(b, a, atol=1e-9 * a.max())
    exact = solve(brake, elements=ELEMENTS, penalty=math.inf)
    first, *_, last = drumlin.wear(brake, elements=ELEMENTS, distance="1").states
    assert first.pulls == pytest.approx(exact.spring_pulls, rel=1e-9)
    assert first.torque == pytest.approx(exact.torque, rel=1e-9)
    assert abs(last.pulls[0] - first.pulls[0]) > 0.1


def test_a_worn_brake_on_anchors_and_springs_is_the_brake_with_these_clearances():
    """`solve` finds the pull on the worn linings anew, with the worn depth as their clearance."""
    brake = ON_ANCHORS["rigid"]()
    run = drumlin.wear(brake, elements=ELEMENTS, distance="1")
    last, clearances = run.states[-1], {}
    for surface in run.setup.surfaces:
        name = brake.shoes[surface.shoe].name
        theta = surface.contact_angles_in_growing_order
        depth = surface.lining_values_by_growing_angle(last.depth)
        rows = list(zip(theta.tolist(), depth.tolist(), strict=True))
        clearances[f"shoe.{name}.lining.clearance"] = rows
    worn = solve(vary(brake, clearances), elements=ELEMENTS, penalty=math.inf)
    assert worn.spring_pulls == pytest.approx(last.pulls, rel=1e-6)
    assert worn.torque == pytest.approx(last.torque, rel=1e-6)


def test_the_pull_of_a_spring_on_anchors_is_that_of_the_displaced_points():
    """An elastic shoe that is far stiffer than its lining moves as a rigid shoe does."""
    stiff = {"shoe.body.material.E": 2.1e17, "spring": [ACROSS | {"rate": 1e6}]}
    elastic = on_mesh(vary(duo_servo(), stiff))
    rigid = on_mesh(ON_ANCHORS["rigid"]())
    assert elastic.spring_pulls == pytest.approx(rigid.spring_pulls, rel=1e-5)


UNLIKE_ARCS = (0.7, 0.9)
"""Half the arcs of two linings: no small change brings a further node of them into contact."""


@pytest.mark.parametrize(
    ("spin", "sprung"),
    [(1, True)]
    + [pytest.param(*each, marks=pytest.mark.slow) for each in ((-1, True), (1, False))],
)
def test_slopes_on_anchors_are_those_of_differences(spin, sprung):
    brake = vary(duo_servo(spin, half=UNLIKE_ARCS), {"shoe.lining.clearance": 1e-6})
    if sprung:
        brake = vary(brake, {"spring": [ACROSS | {"rate": 1e6}]})
    scene = make_prepared_model(brake, elements=ELEMENTS)
    slopes = compute_torque_sensitivity(scene, brake)

    def by_difference(key, value, step):
        return torque_slope_by_differences(brake, key, value, step)

    assert slopes.friction == pytest.approx(by_difference("friction", 0.35, 1e-5), rel=1e-7)
    for i, own in enumerate(slopes.shoes):
        key = f"shoe[{i}]."
        by_force = by_difference(key + "actuation.force", FORCE, 0.1)
        assert own.force == pytest.approx(by_force, rel=1e-7)
        by_clearance = by_difference(key + "lining.clearance", 1e-6, 1e-9)
        assert own.clearance == pytest.approx(by_clearance, rel=1e-6)
        for part, name, E in (("lining", "lining", 3e8), ("body", "shoe", 2.1e11)):
            by_modulus = E * by_difference(f"{key}{part}.material.E", E, 1e-4 * E)
            assert own.moduli[name] == pytest.approx(by_modulus, rel=3e-4)
        assert not own.held and own.not_given == ("anchor", "abutment")
    lines = sensitivity_as_text_lines(slopes, brake)
    assert "anchor and abutment: not given, for the shoe can leave them" in " ".join(lines)
    if sprung:
        (spring,) = slopes.springs
        by_preload = by_difference("spring[0].preload", 100.0, 0.1)
        assert spring.preload == pytest.approx(by_preload, rel=1e-7)
        assert spring.rate == pytest.approx(by_difference("spring[0].rate", 1e6, 1e2), rel=1e-7)


def test_a_law_names_the_rate_of_a_spring_among_the_keys_that_it_does_not_use():
    """Nothing moves in a law, so that a spring pulls with its preload whatever its rate."""
    constant, sprung = (
        drumlin.solve(two_shoes(True, spring=[PULL | {"rate": rate}]), "sine")
        for rate in (0.0, 1e6)
    )
    assert sprung.torque == constant.torque
    assert sprung.left_out[-1] == f"{UNUSED_KEYS_LINE_START}shoe.body, spring.rate"
    assert constant.left_out[-1] == f"{UNUSED_KEYS_LINE_START}shoe.body"


# Springs with a rate in sensitivity.


def torque_slope_by_differences(brake, key, value, step):
    up, down = (on_mesh(vary(brake, {key: value + h})).torque for h in (step, -step))
    return (up - down) / (2 * step)


@pytest.mark.parametrize(
    "name",
    ["elastic shoes", "cam"]
    + [pytest.param(name, marks=pytest.mark.slow) for name in SPRUNG if name[0] in "rf"],
)
def test_slopes_beside_springs_are_those_of_differences(name):
    brake = SPRUNG[name]()
    slopes = drumlin.sensitivity(brake, elements=ELEMENTS)
    assert slopes.torque == pytest.approx(on_mesh(brake).torque, rel=1e-10)
    shoe = brake.shoes[0]
    keys = {
        "spring[0].preload": (100.0, 1.0),
        "spring[0].rate": (1e6, 1e3),
        "shoe[0].hinge.x": (shoe.hinge.x, 1e-6),
        "shoe[0].lining.clearance": (0.0, 1e-9),
        "shoe[0].lining.material.E": (shoe.lining.material.E, 1e-4 * shoe.lining.material.E),
    }
    if shoe.body is not None:
        keys["shoe[0].body.material.E"] = (210e9, 2.1e7)
    if name != "friction over pressure":
        keys["friction"] = (0.3, 1e-4)
    if name != "cam":
        keys["shoe[0].actuation.force"] = (1000.0, 0.1)
    for key, (value, step) in keys.items():
        near = torque_slope_by_differences(brake, key, value, step)
        assert exact_torque_slope_by_key(brake, key, slopes) == pytest.approx(near, rel=1e-6), key
    (spring,) = slopes.springs
    assert spring.pull == pytest.approx(on_mesh(brake).spring_pulls[0], rel=1e-11)
    assert slopes.as_dict()["springs"] == [spring._asdict()]
    assert any(line.startswith("  spring[0]: pull") for line in sensitivity_lines(slopes, brake))


def sensitivity_lines(slopes, brake):
    return sensitivity_as_text_lines(slopes, brake)


def test_slopes_by_the_abutment_of_a_strut_beside_a_spring_are_those_of_differences():
    places = {"point": {"x": 0.06, "y": 0.01}, "end": {"x": -0.06, "y": 0.01}}
    first, second = (shoe.name for shoe in servo().shoes)
    spring = {"shoe": first, "to": second, "preload": 30.0, "rate": 1e6} | places
    brake = vary(servo(body=0.008), {"spring": [spring]})
    slopes = drumlin.sensitivity(brake, elements=ELEMENTS)
    point, held = brake.shoes[0].abutment.point, slopes.shoes[0].held
    for i, axis in enumerate("xy"):
        key = f"shoe[0].abutment.point.{axis}"
        near = torque_slope_by_differences(brake, key, getattr(point, axis), 1e-6)
        assert held["abutment.point"][i] == pytest.approx(near, rel=1e-6)
    direction = brake.shoes[0].abutment.direction
    near = torque_slope_by_differences(brake, "shoe[0].abutment.direction", direction, 1e-5)
    assert held["abutment.direction"][0] == pytest.approx(near, rel=1e-6)


@pytest.mark.parametrize("rate", [0.0, 1e6])
def test_slopes_by_the_pivot_of_an_arc_beside_a_spring_are_those_of_differences(rate):
    """The ends of elements move with the pivot, and with them the nodal forces of the spring."""
    spring = {"shoe": "shoe", "preload": 100.0, "rate": rate}
    spring |= {"point": {"x": 0.095, "y": 0.01}, "end": {"x": 0.05, "y": 0.03}}
    brake = brake_with("pivot", body=BODY, brake={"spring": [spring]})
    (own,) = drumlin.sensitivity(brake, elements=ELEMENTS).shoes
    for axis, found in zip("xy", own.held["pivot"], strict=True):
        at = getattr(brake.shoes[0].pivot, axis)
        near = torque_slope_by_differences(brake, f"shoe[0].pivot.{axis}", at, 1e-5)
        assert found == pytest.approx(near, rel=1e-6)


def test_a_slope_that_no_model_gives_beside_a_spring_is_not_promised():
    brake = drumlin.example("post_brake")
    spring = {"shoe": "right", "preload": 100.0, "rate": 1e3}
    spring |= {"point": {"x": 2.4, "y": 0.5}, "end": {"x": 3.0, "y": 0.5}}
    loaded = vary(brake, {"spring": [spring]})
    slopes = drumlin.sensitivity(loaded, elements=ELEMENTS)
    assert slopes.shoes[0].not_given == ("hinge",)
    lines = [line for line in sensitivity_lines(slopes, loaded) if "not given" in line]
    assert len(lines) == 1
    assert "--model fem" not in lines[0]


def test_slopes_by_constant_springs_stand_beside_unchanged_slopes():
    """A spring without rate between two shoes leaves each shoe a group of its own."""
    brake = two_shoes(True, spring=[PULL])
    slopes = drumlin.sensitivity(brake, elements=ELEMENTS)
    near = torque_slope_by_differences(brake, "spring[0].preload", 100.0, 1.0)
    assert slopes.springs[0].preload == pytest.approx(near, rel=1e-9)
    by_rate = (on_mesh(vary(brake, {"spring[0].rate": 10.0})).torque - slopes.torque) / 10.0
    assert slopes.springs[0].rate == pytest.approx(by_rate, rel=1e-4)
    bare = drumlin.sensitivity(two_shoes(True), elements=ELEMENTS)
    assert bare.springs == () and "springs" not in bare.as_dict()
    assert_array_equal(bare.shoes[0].theta, slopes.shoes[0].theta)


@pytest.mark.slow
def test_round_off_of_a_mesh_file_does_not_keep_friction_and_pressure_apart():
    """On this fine mesh the pressures change by 1e-9 in each step, and never by less than 1e-10."""
    brake = over_pressure(drumlin.example("double_shoe_meshes"))
    end = drumlin.hold(brake, steps=2).states[-1]
    assert end.torque == pytest.approx(drumlin.solve(brake).torque, rel=1e-7)
