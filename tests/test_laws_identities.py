"""Identities that every rigid-shoe law must keep, on random brakes."""

import math
import time
from math import pi

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from pytest import approx

from drumlin import Brake, NoAnswer, vary
from drumlin.laws import LAWS_OF_HINGED_SHOES_BY_NAME, ShoeAnglesAndRadii, pivoted
from drumlin.laws.flat import LINEAR_PRESSURE_LAW, SHORT_SHOE_LAW_ON_PLANE, FlatShoeLengths
from drumlin.laws.hinged import angles_and_radii_of_hinged_shoe
from drumlin.laws.shapes import pivot_radius_for_cosine_pressure
from drumlin.laws.simscape import DoubleShoe
from drumlin.models import MODELS
from drumlin.response.balance import relative_imbalance_of_shoe
from drumlin.response.merit import (
    barecki_shoe_factor,
    sign_of_friction_moment_about_hinge,
    torque_sensitivity_to_friction_by_differences,
)
from drumlin.response.response import ShoeResponse
from drumlin_studies.textbook_brakes import brake_with_one_hinged_pad, brake_with_one_hinged_shoe

many = settings(
    max_examples=2 * settings.default.max_examples, suppress_health_check=[HealthCheck.too_slow]
)

LAW_NAMES = st.sampled_from(sorted(LAWS_OF_HINGED_SHOES_BY_NAME))
SPREAD = [name for name, law in LAWS_OF_HINGED_SHOES_BY_NAME.items() if not law.lumped]
FRICTIONS = st.floats(0.0, 0.6)
SIGNS = st.sampled_from([1, -1])
SIDES = st.sampled_from(["internal", "external"])


@st.composite
def arcs(draw: st.DrawFn) -> tuple[float, float]:
    """A random arc of 6 to 150 deg between 0 and 180 deg from the hinge, which every law allows."""
    half = draw(st.floats(0.05, 1.3))
    middle = draw(st.floats(half, pi - half))
    return middle - half, middle + half


@st.composite
def layouts(draw: st.DrawFn) -> ShoeAnglesAndRadii:
    """A random shoe, described by the data that the rigid-shoe laws need."""
    return ShoeAnglesAndRadii(
        *draw(arcs()), R=draw(st.floats(0.05, 2.0)), a=draw(st.floats(0.05, 3.0)), dD=draw(SIGNS)
    )


@st.composite
def brakes(draw: st.DrawFn) -> Brake:
    """A random hinged shoe, leading or trailing, inside or outside the drum.

    Its friction is below or above mu_lock.
    """
    return brake_with_one_hinged_shoe(
        R=draw(st.floats(0.05, 2.0)),
        a=draw(st.floats(0.05, 3.0)),
        arc=draw(arcs()),
        moment=draw(st.floats(1.0, 1e4)),
        mu=draw(FRICTIONS),
        side=draw(SIDES),
        spin=draw(SIGNS),
        hand=draw(SIGNS),
        turned=draw(st.floats(-pi, pi)),
    )


def unlocked(name: str, brake: Brake) -> ShoeResponse:
    try:
        return MODELS[name].solve(brake).shoes[0]
    except NoAnswer:
        assume(False)
        raise


def forces(brake: Brake, shoe: ShoeResponse) -> tuple[np.ndarray, float]:
    """Force (2,) and moment about O of pressure and friction, by the trapezoidal rule."""
    theta = np.linspace(shoe.theta[0], shoe.theta[-1], 40001)
    p = shoe.pressure_at(theta) * brake.shoes[0].lining.width * brake.size
    outward = 1 if brake.shoes[0].side == "internal" else -1
    drag = brake.friction * (1 if brake.direction == "counter-clockwise" else -1)
    x = -outward * p * np.cos(theta) - drag * p * np.sin(theta)
    y = -outward * p * np.sin(theta) + drag * p * np.cos(theta)
    force = np.array([np.trapezoid(x, theta), np.trapezoid(y, theta)])
    return force, float(np.trapezoid(drag * p, theta) * brake.size)


@many
@given(brakes(), st.sampled_from(SPREAD))
def test_response_balances_by_integrating_its_own_pressure(brake: Brake, name: str) -> None:
    shoe = unlocked(name, brake)
    force, moment = forces(brake, shoe)
    data = brake.shoes[0]
    largest = max(
        np.linalg.norm(force),
        np.linalg.norm(data.actuation.force_vector),
        np.linalg.norm(shoe.hinge_reaction),
    )
    assert (
        np.linalg.norm(force + data.actuation.force_vector + shoe.hinge_reaction) < 1e-7 * largest
    )
    about_hinge = moment - (data.hinge.x * force[1] - data.hinge.y * force[0])
    actuation = data.actuation.moment_of_force_about_point(data.hinge)
    assert abs(about_hinge + actuation) < 1e-6 * max(
        abs(moment), abs(actuation), largest * data.hinge.radius
    )
    assert shoe.torque == approx(abs(moment), rel=1e-7)
    assert shoe.pressure.min() >= 0
    # Nodes straddle the peak and miss a little of it.
    assert shoe.peak_pressure == approx(shoe.pressure.max(), rel=1e-4)


@many
@given(brakes(), st.sampled_from(["short", "block"]))
def test_lumped_response_balances_at_the_middle(brake: Brake, name: str) -> None:
    """A lumped law balances the shoe with N and F = T/R at the middle of the lining.

    Integrals of the law's own p give the sizes of N and F.
    """
    shoe = unlocked(name, brake)
    data = brake.shoes[0]
    theta = np.linspace(shoe.theta[0], shoe.theta[-1], 20001)
    middle = 0.5 * (theta[0] + theta[-1])
    area = data.lining.width * brake.size
    p = shoe.pressure_at(theta) * area
    N = np.trapezoid(p if name == "short" else p * np.cos(theta - middle), theta)
    F = brake.friction * np.trapezoid(p, theta)
    e_r, e_t = (
        np.array([math.cos(middle), math.sin(middle)]),
        np.array([-math.sin(middle), math.cos(middle)]),
    )
    contact = -data.sign_internal_plus_external_minus * N * e_r + brake.sign_of_motion * F * e_t
    largest = max(N, F, np.linalg.norm(shoe.hinge_reaction))
    assert (
        np.linalg.norm(contact + data.actuation.force_vector + shoe.hinge_reaction) < 1e-7 * largest
    )
    arm = brake.size * e_r - data.hinge.xy
    moment = arm[0] * contact[1] - arm[1] * contact[0]
    actuation = data.actuation.moment_of_force_about_point(data.hinge)
    assert abs(moment + actuation) < 1e-7 * max(largest * np.linalg.norm(arm), abs(actuation))
    assert shoe.torque == approx(F * brake.size, rel=1e-7)
    balance = relative_imbalance_of_shoe(brake, 0, shoe)
    assert balance.force < 1e-12
    assert balance.moment < 1e-11


@many
@given(layouts(), LAW_NAMES, st.floats(0.05, 0.6))
def test_sensitivity_is_the_derivative_of_the_mechanical_advantage(
    arc: ShoeAnglesAndRadii, name: str, mu: float
) -> None:
    law, h = LAWS_OF_HINGED_SHOES_BY_NAME[name], 1e-5
    assume(mu < 0.9 * law.self_locking_friction(arc))
    eta = [float(law.torque_over_actuation_moment(mu * (1 + k * h), arc)) for k in (-1, 0, 1)]
    slope = (eta[2] - eta[0]) / (2 * h * eta[1])
    assert law.sensitivity_of_braking_effect_to_friction(mu, arc) == approx(slope, rel=1e-6)


@many
@given(brakes(), LAW_NAMES)
def test_merits_of_a_response_are_those_of_the_formula(brake: Brake, name: str) -> None:
    assume(brake.friction > 1e-3)
    unlocked(name, brake)
    (merit,) = MODELS[name].solve(brake).merits
    law, arc = (
        LAWS_OF_HINGED_SHOES_BY_NAME[name],
        angles_and_radii_of_hinged_shoe(brake, brake.shoes[0]),
    )
    assert merit.mechanical_advantage == approx(
        float(law.torque_over_actuation_moment(brake.friction, arc)), rel=1e-8
    )
    assert merit.sensitivity_at_fixed_shape == approx(
        float(law.sensitivity_of_braking_effect_to_friction(brake.friction, arc)), rel=1e-8
    )
    assert merit.mechanical_advantage == approx(
        1 / (merit.m - merit.double_delta * merit.n), rel=1e-6
    )
    assert torque_sensitivity_to_friction_by_differences(brake, MODELS[name].solve) == approx(
        float(law.sensitivity_of_braking_effect_to_friction(brake.friction, arc)), rel=1e-2
    )


@many
@given(brakes(), st.sampled_from([*SPREAD, "short"]))
def test_shoe_factor_by_barecki_from_the_position_of_the_resultant(brake: Brake, name: str) -> None:
    """Barecki & Scieszka, eq. 26, restates the moment balance: S = T/(P R) for any pressure."""
    assume(brake.friction > 1e-3)
    unlocked(name, brake)
    (merit,) = MODELS[name].solve(brake).merits
    shoe, R = brake.shoes[0], brake.size
    angle = float(shoe.frame.phi_of_surface_coordinates(np.array(merit.resultant_angle)))
    # Friction on the shoe points from the hinge to the loaded end.
    up = brake.sign_of_motion * shoe.frame.sense
    leading = up if shoe.side == "external" else -up
    S = barecki_shoe_factor(
        brake.friction, angle, merit.friction_radius, shoe.hinge.radius / R, 1.0 / R, leading
    )
    assert merit.shoe_factor == approx(S, rel=1e-6)


@many
@given(st.floats(0.3, 2.8), st.floats(0.05, 0.5), st.floats(0.05, 3.0), SIGNS, st.floats(0.05, 0.4))
def test_every_law_becomes_the_short_shoe_as_the_arc_shrinks(
    middle: float, R: float, a: float, dD: int, mu: float
) -> None:
    """The difference in the brake factor eta is proportional to the square of the arc."""
    errors = {}
    for half in (0.02, 0.01):
        arc = ShoeAnglesAndRadii(middle - half, middle + half, R, a, dD)
        short = LAWS_OF_HINGED_SHOES_BY_NAME["short"]
        assume(mu < 0.7 * short.self_locking_friction(arc))
        eta = float(short.torque_over_actuation_moment(mu, arc))
        for name, law in LAWS_OF_HINGED_SHOES_BY_NAME.items():
            errors.setdefault(name, []).append(
                abs(float(law.torque_over_actuation_moment(mu, arc)) / eta - 1)
            )
    del errors["short"]
    assert len(errors) == 4
    for coarse, fine in errors.values():
        assert coarse < 100 * 0.02**2
        assert fine < 0.26 * coarse + 1e-10


@many
@given(brakes(), LAW_NAMES)
def test_external_is_internal_with_all_forces_reversed(brake: Brake, name: str) -> None:
    """An external shoe with reversed rotation and force has the pressure of the internal shoe.

    Its hinge reaction is opposite.
    """
    inside = unlocked(name, brake)
    shoe = brake.shoes[0]
    other = vary(
        brake,
        {
            "rotation": "clockwise" if brake.sign_of_motion > 0 else "counter-clockwise",
            "shoe.side": "external" if shoe.side == "internal" else "internal",
            "shoe.actuation.force": -shoe.actuation.force,
        },
    )
    outside = unlocked(name, other)
    assert outside.torque == approx(inside.torque, rel=1e-9, abs=0)
    assert outside.pressure == approx(inside.pressure, rel=1e-9)
    scale = np.linalg.norm(inside.hinge_reaction) + shoe.actuation.force
    assert np.linalg.norm(outside.hinge_reaction + inside.hinge_reaction) < 1e-9 * scale
    assert outside.self_energising == inside.self_energising
    assert sign_of_friction_moment_about_hinge(
        other, other.shoes[0]
    ) == sign_of_friction_moment_about_hinge(brake, shoe)


@many
@given(brakes(), LAW_NAMES)
def test_mirrored_brake_gives_the_mirrored_answer(brake: Brake, name: str) -> None:
    """A brake mirrored on the x axis, with mirrored rotation, has the mirrored answer."""
    here = unlocked(name, brake)
    shoe = brake.shoes[0]
    there = unlocked(
        name,
        vary(
            brake,
            {
                "rotation": "clockwise" if brake.sign_of_motion > 0 else "counter-clockwise",
                "shoe.hinge.y": -shoe.hinge.y,
                "shoe.lining.start": -shoe.lining.end,
                "shoe.lining.end": -shoe.lining.start,
                "shoe.actuation.direction": -shoe.actuation.direction,
                "shoe.actuation.point.y": -shoe.actuation.point.y,
            },
        ),
    )
    assert there.torque == approx(here.torque, rel=1e-9)
    assert there.pressure[::-1] == approx(here.pressure, rel=1e-9, abs=1e-12 * here.peak_pressure)
    scale = np.linalg.norm(here.hinge_reaction) + shoe.actuation.force
    assert np.linalg.norm(there.hinge_reaction - here.hinge_reaction * [1, -1]) < 1e-9 * scale


@many
@given(brakes(), LAW_NAMES)
def test_without_friction_no_torque_and_its_slope_at_zero_is_that_of_the_frictionless_pressure(
    brake: Brake, name: str
) -> None:
    free = MODELS[name].solve(vary(brake, {"friction": 0.0})).shoes[0]
    assert free.torque == 0.0
    assert free.peak_pressure > 0
    assert not free.self_energising
    mu = 1e-6
    slight = MODELS[name].solve(vary(brake, {"friction": mu})).shoes[0]
    integral = np.trapezoid(free.pressure, free.theta) * brake.shoes[0].lining.width * brake.size**2
    M_N = LAWS_OF_HINGED_SHOES_BY_NAME[name].scaled_normal_and_friction_moments_about_hinge(
        ShoeAnglesAndRadii(*brake.shoes[0].arc, brake.size, brake.shoes[0].hinge.radius, 1)
    )
    assume(abs(M_N[1] / M_N[0]) < 100)
    assert slight.torque / mu == approx(integral, rel=1e-3)


@many
@given(layouts(), LAW_NAMES)
def test_torque_grows_without_bound_towards_locking(arc: ShoeAnglesAndRadii, name: str) -> None:
    """The torque grows as 1/(mu_lock - mu) towards locking; at mu_lock and beyond there is none.

    T (mu_lock - mu)/mu stays constant.
    """
    law = LAWS_OF_HINGED_SHOES_BY_NAME[name]
    mu_lock = float(law.self_locking_friction(arc))
    assume(mu_lock < 1e3)
    near = [mu_lock * (1 - 1e-2), mu_lock * (1 - 1e-4), mu_lock * (1 - 1e-6)]
    constant = [float(law.torque(1.0, mu, arc)) * (mu_lock - mu) / mu for mu in near]
    assert constant == approx([constant[0]] * 3, rel=1e-8)
    assert constant[0] > 0
    assert np.isnan(law.torque(1.0, mu_lock * (1 + 1e-9), arc))
    assert float(law.self_locking_friction(arc._replace(dD=-arc.dD))) == math.inf


@many
@given(brakes(), LAW_NAMES)
def test_self_locking_is_refused_exactly_beyond_mu_lock(brake: Brake, name: str) -> None:
    mu_lock = float(
        LAWS_OF_HINGED_SHOES_BY_NAME[name].self_locking_friction(
            angles_and_radii_of_hinged_shoe(brake, brake.shoes[0])
        )
    )
    assume(mu_lock < 1e3)
    below = MODELS[name].solve(vary(brake, {"friction": mu_lock * (1 - 1e-9)}))
    assert below.shoes[0].self_energising
    with pytest.raises(
        NoAnswer, match=r"^shoe 'shoe': self-locking, friction .* is not below mu_lock = .*"
    ):
        MODELS[name].solve(vary(brake, {"friction": mu_lock * (1 + 1e-9)}))


@many
@given(brakes(), LAW_NAMES, st.floats(-1e4, 0.0))
def test_a_force_that_does_not_press_is_an_answer(brake: Brake, name: str, force: float) -> None:
    response = MODELS[name].solve(vary(brake, {"shoe.actuation.force": force}))
    (shoe,) = response.shoes
    assert (shoe.torque, shoe.normal_force, shoe.contact_arcs) == (0.0, 0.0, ())
    assert shoe.hinge_reaction == approx(
        -vary(brake, {"shoe.actuation.force": force}).shoes[0].actuation.force_vector
    )
    assert response.notes == (
        "shoe 'shoe': no contact, the force does not turn it towards the drum",
    )
    assert response.merits[0].resultant_angle is None


# shoes on a pivot


@st.composite
def levers(draw: st.DrawFn) -> Brake:
    """Levers of a shoe on a pivot where the pressure is almost p_0 cos.

    All of the lining presses at moderate friction.
    """
    middle, half, R = draw(st.floats(0.8, 2.2)), draw(st.floats(0.3, 0.75)), 0.25
    pivot = (
        float(pivot_radius_for_cosine_pressure(R, half)) * draw(st.floats(0.85, 1.15)),
        middle + draw(st.floats(-0.03, 0.03)),
    )
    return brake_with_one_hinged_shoe(
        R=R,
        a=draw(st.floats(0.3, 0.6)),
        arc=(middle - half, middle + half),
        moment=100.0,
        mu=draw(st.floats(0.05, 0.4)),
        side=draw(SIDES),
        spin=draw(SIGNS),
        hand=draw(SIGNS),
        turned=draw(st.floats(-pi, pi)),
        pivot=pivot,
    )


@many
@given(levers())
def test_pivoted_shoe_keeps_both_equilibria(brake: Brake) -> None:
    shoe = unlocked("pivoted", brake)
    data = brake.shoes[0]
    force, moment = forces(brake, shoe)
    size = np.linalg.norm(force)
    pivot = data.pivot.xy
    assert abs(moment - (pivot[0] * force[1] - pivot[1] * force[0])) < 1e-7 * size * brake.size
    assert np.linalg.norm(shoe.pivot_reaction + force) < 1e-7 * size
    assert np.linalg.norm(shoe.hinge_reaction + force + data.actuation.force_vector) < 1e-7 * size
    assert relative_imbalance_of_shoe(brake, 0, shoe).moment < 1e-9
    p = shoe.pressure_at(np.linspace(shoe.theta[0], shoe.theta[-1], 101))
    assert p.min() > -1e-9 * shoe.peak_pressure


@many
@given(levers())
def test_pivoted_formulas_are_the_response_and_its_derivative(brake: Brake) -> None:
    shoe = unlocked("pivoted", brake)
    arc, pivot, mu, h = (
        angles_and_radii_of_hinged_shoe(brake, brake.shoes[0]),
        pivoted.pivot_position_in_shoe_frame(brake.shoes[0]),
        brake.friction,
        1e-5,
    )
    T = [
        float(pivoted.torque_of_pivoted_shoe(100.0, mu * (1 + k * h), arc, *pivot))
        for k in (-1, 0, 1)
    ]
    assume(not np.isnan(T).any())
    assert shoe.torque == approx(T[1], rel=1e-9)
    assert pivoted.torque_sensitivity_of_pivoted_shoe(mu, arc, *pivot) == approx(
        (T[2] - T[0]) / (2 * h * T[1]), rel=1e-5, abs=1e-5
    )


@many
@given(
    st.floats(0.9, 2.0),
    st.floats(0.3, 0.8),
    st.floats(0.3, 0.6),
    st.floats(0.0, 0.35),
    SIGNS,
    SIDES,
)
def test_pivot_at_its_place_makes_the_pressure_a_cosine_at_any_friction(
    middle: float, half: float, a: float, mu: float, spin: int, side: str
) -> None:
    brake = brake_with_one_hinged_shoe(
        R=0.25,
        a=a,
        arc=(middle - half, middle + half),
        moment=50.0,
        mu=mu,
        side=side,
        spin=spin,
        pivot=(float(pivot_radius_for_cosine_pressure(0.25, half)), middle),
    )
    shoe = unlocked("pivoted", brake)
    assert shoe.pressure == approx(shoe.peak_pressure * np.cos(shoe.theta - middle), rel=1e-9)
    # and then it is the cosine law of a block fixed to the lever
    fixed = vary(brake, {"shoe.pivot": None})
    assert shoe.torque == approx(MODELS["cosine"].solve(fixed).torque, rel=1e-9, abs=1e-12)


def test_pivoted_lever_locks_and_tips() -> None:
    """A pivoted lever beyond mu_lock, or with its pivot off the lining, is refused by its cause."""
    half, middle = 0.6, 1.2
    place = (float(pivot_radius_for_cosine_pressure(0.25, half)), middle)
    arc = (middle - half, middle + half)
    brake = brake_with_one_hinged_shoe(
        R=0.25, a=0.1, arc=arc, moment=50.0, mu=0.2, side="external", spin=1, pivot=place
    )
    shape, pivot = (
        angles_and_radii_of_hinged_shoe(brake, brake.shoes[0]),
        pivoted.pivot_position_in_shoe_frame(brake.shoes[0]),
    )
    mu_lock = pivoted.self_locking_friction_of_pivoted_shoe(shape, *pivot)
    assert mu_lock == approx(
        float(LAWS_OF_HINGED_SHOES_BY_NAME["cosine"].self_locking_friction(shape)), rel=1e-9
    )
    T = [
        float(pivoted.torque_of_pivoted_shoe(1.0, mu_lock * (1 - gap), shape, *pivot)) * gap
        for gap in (1e-4, 1e-6)
    ]
    assert T[0] == approx(T[1], rel=1e-3)
    with pytest.raises(
        NoAnswer, match=rf"self-locking, friction .* is not below mu_lock = {mu_lock:.6g}"
    ):
        MODELS["pivoted"].solve(vary(brake, {"friction": mu_lock * 1.01}))
    tipping = brake_with_one_hinged_shoe(
        R=0.25, a=0.4, arc=arc, moment=50.0, mu=0.3, side="external", pivot=(0.28, middle + 0.9)
    )
    with pytest.raises(
        NoAnswer, match=r"tips, no pressure of a rigid shoe on its lining balances the actuation"
    ):
        MODELS["pivoted"].solve(tipping)
    lifted = vary(brake, {"shoe.actuation.force": -50.0})
    assert MODELS["pivoted"].solve(lifted).torque == 0.0


# shoes on a plane


@many
@given(
    st.floats(0.02, 0.3),
    st.floats(0.01, 0.5),
    st.just(0.0) | st.floats(1e-20, 0.2),
    FRICTIONS,
    st.sampled_from(["+x", "-x"]),
    SIGNS,
    st.sampled_from(["linear", "short"]),
)
def test_flat_shoes_balance_and_their_sensitivity_is_the_derivative(
    x_min: float, length: float, h: float, mu: float, sliding: str, hand: int, name: str
) -> None:
    brake = brake_with_one_hinged_pad(
        h=h, span=(x_min, x_min + length), moment=70.0, mu=mu, sliding=sliding, hand=hand
    )
    shoe = unlocked(name, brake)
    balance = relative_imbalance_of_shoe(brake, 0, shoe)
    assert balance.force < 1e-12
    assert balance.moment < 1e-11
    law = {"linear": LINEAR_PRESSURE_LAW, "short": SHORT_SHOE_LAW_ON_PLANE}[name]
    s = (1 if sliding == "+x" else -1) * hand
    strip = FlatShoeLengths(x_min, x_min + length, h, s)
    (merit,) = MODELS[name].solve(brake).merits
    assert merit.braking_force == approx(float(law.braking_force(70.0, mu, strip)), rel=1e-9)
    assume(0.05 < mu < 0.9 * law.self_locking_friction(strip))
    assert shoe.self_energising == (h > 0 and s < 0)
    step = 1e-5
    F = [float(law.braking_force(1.0, mu * (1 + k * step), strip)) for k in (-1, 0, 1)]
    slope = (F[2] - F[0]) / (2 * step * F[1])
    assert law.sensitivity_of_braking_effect_to_friction(mu, strip) == approx(slope, rel=1e-6)
    assert merit.sensitivity_at_fixed_shape == approx(slope, rel=1e-6)


def test_long_flat_shoe_becomes_the_short_one() -> None:
    errors = []
    for length in (0.02, 0.01):
        strip = FlatShoeLengths(0.2 - length / 2, 0.2 + length / 2, 0.06, 1)
        errors.append(
            LINEAR_PRESSURE_LAW.braking_force(1.0, 0.4, strip)
            / SHORT_SHOE_LAW_ON_PLANE.braking_force(1.0, 0.4, strip)
            - 1
        )
    assert errors[0] / errors[1] == approx(4, rel=1e-2)


def test_flat_shoe_locks_towards_its_hinge_only() -> None:
    """N = M/(a - mu h): beyond mu = a/h the body pulls the shoe in; the other way it never does."""
    brake = brake_with_one_hinged_pad(h=0.3, span=(0.05, 0.07), moment=10.0, mu=0.21, sliding="-x")
    with pytest.raises(
        NoAnswer, match=r"shoe 'pad': self-locking, friction 0.21 is not below mu_lock = 0.2 of"
    ):
        MODELS["short"].solve(brake)
    assert MODELS["short"].solve(vary(brake, {"plane.sliding": "+x"})).merits[0].braking_force > 0
    lifted = MODELS["short"].solve(vary(brake, {"shoe.actuation.force": -10.0}))
    assert lifted.notes == ("shoe 'pad': no contact, the force does not turn it towards the plane",)
    assert lifted.merits[0].braking_force == 0.0


# many at once


def test_a_hundred_thousand_torques_of_every_law_in_a_tenth_of_a_second_each() -> None:
    rng = np.random.default_rng(1)
    mu = rng.uniform(0.05, 0.5, 10**5)
    phi_1 = rng.uniform(0.0, 1.0, 10**5)
    phi_2 = phi_1 + rng.uniform(0.5, 2.0, 10**5)
    arc = ShoeAnglesAndRadii(phi_1, phi_2, 0.15, 0.125, 1)
    plane = FlatShoeLengths(0.1 + phi_1, 0.1 + phi_2, 0.06, -1)
    x, y = 0.16 * np.cos(arc.middle), 0.16 * np.sin(arc.middle)
    block = DoubleShoe()
    calls = {
        **{
            name: lambda law=law: law.torque(100.0, mu, arc)
            for name, law in LAWS_OF_HINGED_SHOES_BY_NAME.items()
        },
        "pivoted": lambda: pivoted.torque_of_pivoted_shoe(100.0, mu, arc, x, y),
        "linear": lambda: LINEAR_PRESSURE_LAW.braking_force(100.0, mu, plane),
        "flat short": lambda: SHORT_SHOE_LAW_ON_PLANE.braking_force(100.0, mu, plane),
        "simscape": lambda: block.torque(1e3 * mu, phi_1 - 0.5),
    }
    assert len(calls) == 9
    for name, call in calls.items():
        start = time.process_time()
        torque = call()
        # The bound leaves room for a slow machine.
        assert time.process_time() - start < 0.6, name
        assert torque.shape == (10**5,)
        assert np.nanmax(torque) > 0
